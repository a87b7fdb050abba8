"""Runs a module of this very copy of the package: `python -P run_module.py MODULE ...`.

`python -m` searches the present folder first. It would run another copy of the package there, and
import a file `signal.py` or `numpy.py` of a user in place of the library.
"""

import signal

previous_handler = signal.getsignal(signal.SIGINT)
if previous_handler is signal.default_int_handler:
    # an interrupt before the module runs needs no traceback
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import os  # noqa: E402
import runpy  # noqa: E402
import sys  # noqa: E402

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import bearingwear  # noqa: E402, F401  its modules are found from it from here on

del sys.path[0], sys.argv[0]
previous_hook = sys.excepthook


def print_exception(kind, *details):
    """Prints an unhandled exception as the previous hook does; nothing for Ctrl-C.

    Ctrl-C would otherwise print a traceback while Snakemake reads rules.

    kind: class of the exception.
    *details: the exception and its traceback.
    """
    if kind is not KeyboardInterrupt:
        previous_hook(kind, *details)


sys.excepthook = print_exception
signal.signal(signal.SIGINT, previous_handler)
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
