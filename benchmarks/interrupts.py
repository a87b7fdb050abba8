"""Interrupts each command at random moments, as Ctrl-C in a terminal does; prints how it ended.

    python benchmarks/interrupts.py [COMMAND ...] [--times 20] [--longest 20] [--alone]

Each command first runs undisturbed in a folder of its own, for at most LONGEST seconds, then TIMES
times until a moment that is uniform in that time. Moments before the program's first line, while
Python itself starts and ends in its own way, are counted apart (`start`).

A row: the exit statuses and how often each came, median and largest seconds from the signal to the
end. On standard error, the moments at which anything was wrong: another status than 130, a
traceback, or a file that was half written. With `--alone` the signal is sent to the command and not
to the processes that it has started.
"""

import argparse
import collections
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EARLY = -1
PROGRAM = [sys.executable, "-m", "bearingwear"]
NEW = ["new", "mine.yaml", "7008C", "--speed", "18000"]
LIMITS = ["--stiffness", "20", "--slip", "0.36"]
COMMANDS = {
    "new": ["new", "other.yaml", "7010C"],
    "show": ["show", "mine.yaml"],
    "check": ["check", "mine.yaml"],
    "solve": ["solve", "mine.yaml", "-o", "out.nc"],
    "life": ["life", "mine.yaml", "-o", "out.nc"],
    "recommend": ["recommend", "mine.yaml", *LIMITS],
    "uncertainty": ["uncertainty", "mine.yaml", "-o", "out.nc"],
    "cage": ["cage", "mine.yaml", "--runs", "20", "-o", "out.nc"],
    "margin": ["margin", "mine.yaml", "--drive", "1"],
    "launch": ["launch", "mine.yaml", "--axial", "30", "--set", "arrangement.rotor_mass_kg=2"],
    "export": ["export", "mine.yaml", "--speeds", "1000:18000:8", "-o", "out.csv"],
    "study": ["study", "mine.yaml", *LIMITS],
}


def interrupted(
    arguments: list[str], folder: Path, delay: float, alone: bool = False
) -> tuple[int, float, str]:
    """Exit status, seconds to the end after the signal, and what is wrong, if anything.

    A command that ends before has no seconds: they are NaN. The status is EARLY before the
    program's first line.
    """
    run = subprocess.Popen(
        [*PROGRAM, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        _, said = run.communicate(timeout=delay)
        return run.returncode, float("nan"), ""
    except subprocess.TimeoutExpired:
        sent = time.monotonic()
        (os.kill if alone else os.killpg)(run.pid, signal.SIGINT)
        _, said = run.communicate()
    seconds = time.monotonic() - sent
    if not said or "KeyboardInterrupt" in said and "in run_program" not in said:
        return EARLY, seconds, ""
    wrong = [str(path) for path in folder.rglob(".*.part")]
    if "Traceback" in said or not said.endswith("interrupted\n"):
        wrong.append(said[-300:])
    return run.returncode, seconds, "; ".join(wrong)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commands", nargs="*", default=COMMANDS, metavar="COMMAND")
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--longest", type=float, default=20.0, metavar="SECONDS")
    parser.add_argument("--alone", action="store_true")
    asked = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # `&` in a script has it ignored
    moments = random.Random(1)
    columns = "| command | runs for, s | status: times | median, s | most, s | start |"
    print(f"{columns}\n|---|---|---|---|---|---|", flush=True)
    for name in asked.commands:
        arguments = COMMANDS[name]
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([*PROGRAM, *NEW], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            scene = (Path(folder) / "mine.yaml").read_text(encoding="utf-8")
            began = time.monotonic()
            status, *_ = interrupted(arguments, Path(folder), asked.longest, asked.alone)
            lasts = min(time.monotonic() - began, asked.longest)
        if status not in (0, 3, 130):
            raise SystemExit(f"{name}: got status {status} undisturbed")
        ends: collections.Counter[int] = collections.Counter()
        waits, faults, starts = [], [], 0
        while len(waits) < asked.times:
            delay = moments.uniform(0.0, lasts)
            with tempfile.TemporaryDirectory() as folder:
                (Path(folder) / "mine.yaml").write_text(scene, encoding="utf-8")
                status, seconds, wrong = interrupted(arguments, Path(folder), delay, asked.alone)
            if status == EARLY:
                starts += 1
            elif seconds == seconds:  # it had not ended before
                ends[status] += 1
                waits.append(seconds)
                faults += [f"{delay:.2f} s: {wrong}"] if wrong else []
        counts = ", ".join(f"{status}: {count}" for status, count in ends.items())
        middle = statistics.median(waits)
        ended = f"{middle:.2f} | {max(waits):.2f}"
        print(f"| {name} | {lasts:.1f} | {counts} | {ended} | {starts} |", flush=True)
        for fault in faults:
            print(f"    {fault!r}", file=sys.stderr)


if __name__ == "__main__":
    main()
