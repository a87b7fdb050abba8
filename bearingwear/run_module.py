"""Runs a module of this very copy of the package: `python -P run_module.py MODULE ...`.

`python -m` looks in the present folder first: it would run another copy of the package there, and
take any file of a user that is called `signal.py` or `numpy.py` for the library of that name.
"""

import os
import runpy
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import bearingwear  # noqa: E402, F401  its modules are found from it from here on

del sys.path[0], sys.argv[0]
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
