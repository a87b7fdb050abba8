"""What the first solve on a machine takes: a process that has to compile its kernels.

`python benchmarks/cold.py [ROOT] [--only NAME ...]` solves gyro_s1 of a checkout (this one if left
out) by each model with an empty folder for compiled code, then a 7008C and its life, and prints CPU
and wall seconds; with `BEARINGWEAR_PLAIN_NUMBA=1` as versions of numba compile that are not tested.
The process that compiles beside a command counts for its wall time alone.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TURN = ["--set", "model.simulated_turns=0.1"]
RUNS = (
    ("race control", ["solve", "--fidelity", "race_control"], True),
    ("steady", ["solve", "--fidelity", "steady"], True),
    ("dynamic, after it", ["solve", "--fidelity", "dynamic", *TURN], False),
    ("dynamic alone", ["solve", "--fidelity", "dynamic", *TURN], True),
    ("life", ["life"], True),
)
"""What is run: its name, the command, and whether compiled code of before is removed."""
OWN = (("7008C: solve", ["solve"], True), ("7008C: life after it", ["life"], False))
"""Likewise, of a bearing as a new user writes it."""


def cpu_of_children() -> float:
    """CPU time of all child processes that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).parents[1])
    parser.add_argument(
        "--only", nargs="+", default=[name for name, *_ in RUNS + OWN], metavar="NAME"
    )
    args = parser.parse_args()
    root = args.root.resolve()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        compiled = Path(folder) / "compiled"
        environment = os.environ | {"NUMBA_CACHE_DIR": str(compiled), "PYTHONPATH": str(root)}
        print(f"{'first run of':<20}{'CPU s':>8}{'wall s':>8}")
        program, own = [sys.executable, "-m", "bearingwear"], Path(folder) / "mine.yaml"
        new = [*program, "new", str(own), "7008C", "--speed", "18000"]
        subprocess.run(new, cwd=root, env=environment, check=True, capture_output=True)
        for name, command, anew in RUNS + OWN:
            if name not in args.only:
                continue
            if anew:
                shutil.rmtree(compiled, ignore_errors=True)
            file = own if name.startswith("7008C") else root / "config" / "scenes" / "gyro_s1.yaml"
            word, *options = command
            argv = [*program, word, str(file), "--quiet", *options]
            cpu, started = cpu_of_children(), time.monotonic()
            subprocess.run(argv, cwd=root, env=environment, check=True, capture_output=True)
            wall = time.monotonic() - started
            print(f"{name:<20}{cpu_of_children() - cpu:8.1f}{wall:8.1f}", flush=True)


if __name__ == "__main__":
    main()
