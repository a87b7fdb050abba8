"""Interrupts each command at random moments, as Ctrl-C in a terminal does; prints how it ended.

    python benchmarks/interrupts.py [COMMAND ...] [--times 20] [--longest 20] [--seed 1] [--alone]

Each command first runs undisturbed in a folder of its own, for at most LONGEST seconds, then TIMES
times until a moment that is uniform in that time, drawn from SEED. Moments before the program's
first line, while Python itself starts and ends in its own way, are counted apart (`start`).

A row: the exit statuses and how often each came, median and largest seconds from the signal to the
end, and the load of the machine: processes that run or wait to run, mean of a minute. On standard
error, the moments at which anything was wrong: another status than 130, a traceback, or a file that
was half written. With `--alone` the signal is sent to the command and not to the processes that it
has started.
"""

import argparse
import collections
import os
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EARLY = -1
PROGRAM = [sys.executable, "-m", "bearingwear"]
CONFIG = Path(__file__).parent.parent / "config"
NEW = ["new", "mine.yaml", "7008C", "--speed", "18000"]
LIMITS = ["--stiffness", "20", "--slip", "0.36"]
HEATED = "thermal.conductance_W_K={inner_ring_shaft: 1.1, outer_ring_housing: 1.1, ball_race: 1.8}"
TESTS = "operation.shaft_speed_rpm,torque_Nmm,run_out_h\n9000,4.5,\n18000,,3\n"
COMMANDS = {
    "new": ["new", "other.yaml", "7010C"],
    "show": ["show", "mine.yaml"],
    "check": ["check", "mine.yaml"],
    "solve": ["solve", "mine.yaml", "-o", "out.nc"],
    "dynamic": ["solve", "mine.yaml", "--fidelity", "dynamic", "-o", "out.nc"],
    "life": ["life", "mine.yaml", "-o", "out.nc"],
    "growth": ["life", "mine.yaml", "-o", "out.nc", "--set", HEATED],
    "recommend": ["recommend", "mine.yaml", *LIMITS],
    "uncertainty": ["uncertainty", "mine.yaml", "-o", "out.nc"],
    "cage": ["cage", "mine.yaml", "--runs", "20", "-o", "out.nc"],
    "margin": ["margin", "mine.yaml", "--drive", "1"],
    "launch": ["launch", "mine.yaml", "--axial", "30", "--set", "arrangement.rotor_mass_kg=2"],
    "export": ["export", "mine.yaml", "--speeds", "1000:18000:8", "-o", "out.csv"],
    "calibrate": ["calibrate", "mine.yaml", "tests.csv", "-o", "calibrated.yaml"],
    "plot": ["plot", "mine.nc", "-o", "out.png", "out.svg"],
    "study": ["study", "mine.yaml", *LIMITS],
    "studies": ["study", "all", "-j2"],
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
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--alone", action="store_true")
    asked = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # `&` in a script has it ignored
    moments = random.Random(asked.seed)
    columns = "| command | runs for, s | status: times | median, s | most, s | start | load |"
    print(f"{columns}\n|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        inputs = Path(folder)
        write_inputs(inputs)
        for name in asked.commands:
            interrupt_often(name, inputs, moments, asked)


def write_inputs(folder: Path) -> None:
    """What the commands read."""
    for arguments in (NEW, ["solve", "mine.yaml", "-o", "mine.nc", "--quiet"]):
        subprocess.run([*PROGRAM, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    (folder / "tests.csv").write_text(TESTS, encoding="utf-8")
    shutil.copytree(CONFIG, folder / "config")


def interrupt_often(
    name: str, inputs: Path, moments: random.Random, asked: argparse.Namespace
) -> None:
    """Print the row of a command."""
    arguments = COMMANDS[name]

    def run_until(delay: float) -> tuple[int, float, str]:
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(inputs, folder, dirs_exist_ok=True)
            return interrupted(arguments, Path(folder), delay, asked.alone)

    began = time.monotonic()
    status, *_ = run_until(asked.longest)
    lasts = min(time.monotonic() - began, asked.longest)
    if status not in (0, 3, 130):
        raise SystemExit(f"{name}: got status {status} undisturbed")
    ends: collections.Counter[int] = collections.Counter()
    waits, faults, starts = [], [], 0
    while len(waits) < asked.times:
        delay = moments.uniform(0.0, lasts)
        status, seconds, wrong = run_until(delay)
        if status == EARLY:
            starts += 1
        elif seconds == seconds:  # it had not ended before
            ends[status] += 1
            waits.append(seconds)
            faults += [f"{delay:.2f} s: {wrong}"] if wrong else []
    counts = ", ".join(f"{status}: {count}" for status, count in ends.items())
    load = os.getloadavg()[0]
    middle = statistics.median(waits)
    ended = f"{middle:.2f} | {max(waits):.2f}"
    print(f"| {name} | {lasts:.1f} | {counts} | {ended} | {starts} | {load:.1f} |", flush=True)
    for fault in faults:
        print(f"    {fault!r}", file=sys.stderr)


if __name__ == "__main__":
    main()
