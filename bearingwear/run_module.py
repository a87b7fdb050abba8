"""Runs a module of this very copy of the package: `python -P run_module.py MODULE ...`.

`python -m` looks in the present folder first: it would run another copy of the package there, and
take any file of a user that is called `signal.py` or `numpy.py` for the library of that name.
"""

import signal

before = signal.getsignal(signal.SIGINT)
if before is signal.default_int_handler:  # an interrupt before the module runs needs no traceback
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import os  # noqa: E402
import runpy  # noqa: E402
import sys  # noqa: E402

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import bearingwear  # noqa: E402, F401  its modules are found from it from here on

del sys.path[0], sys.argv[0]
as_before = sys.excepthook
# nor does one that nobody handles later, as while Snakemake reads its rules
sys.excepthook = lambda kind, *rest: kind is KeyboardInterrupt or as_before(kind, *rest)
signal.signal(signal.SIGINT, before)
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
