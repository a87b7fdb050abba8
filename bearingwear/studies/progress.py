"""Progress of a study on the terminal: a line for each finished job, with the time left."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Mapping
from typing import Any

from bearingwear.console import LINE_EVERY, printable
from bearingwear.kernels.build.folder import tell_of_compiling
from bearingwear.studies.protocol import Bundle, Step
from bearingwear.studies.seconds import job_times, kind, seconds_of

PROCESS, FIGURE = 1.0, 0.7
"""What a process takes to start, and a figure or a table to make [s]."""

PACE_ASSUMED = 10.0
"""Seconds of jobs after which their pace counts as much as the one assumed."""

LATE = 0.1
"""Of the time it has run, what a job beyond its estimate still takes."""

UNUSUAL = 8.0
"""Times its estimate, of a second at least, after which a job tells nothing of the pace: it waited
for a kernel that was compiled."""

WAITING = 6
"""Jobs left for each that runs: the last ones wait for each other."""

RUNNING_JOBS = "running: "
"""Beginning of the lines that name the running jobs."""

RELAYED = "BEARINGWEAR_STUDY"
"""Variable of the environment: the folder of a study whose lines a command passes on."""

COMPILING = b"compiling part of the solver"
"""How the line of a job begins that needs the solver while it is compiled."""

_DROPPED = {"RUN_INFO", "JOB_STARTED", "PROGRESS", "RESOURCES_INFO", "JOB_INFO", "GROUP_INFO"}
"""Events of Snakemake that take no line of their own."""

_UNINFORMATIVE = (
    "Select jobs", "Using shell", "Provided", "Rules claiming", "Building DAG",
    "RuleException:\nCalledProcessError", "WorkflowError:\nAt least one job did not complete",
    "Assuming unrestricted", "Shutting down", "Exiting because", "Complete log", "Elapsed time",
)  # fmt: skip
"""Beginnings of messages that state nothing about the study, or only that a job has failed."""


def _expected(job: Step | Bundle) -> float:
    """Seconds of a job: as measured, else by the figures and tables that it makes."""
    if kind(job.rule) in job_times():
        return seconds_of(job.rule, job.work or 1.0)
    return job.seconds or PROCESS + FIGURE * len(job.steps)


def _compiles(log: str) -> bool:
    """Whether a job began to compile the solver, as its log says."""
    try:
        with open(log, "rb") as file:
            return file.readline().startswith(COMPILING)
    except OSError:
        return False


def _last_line(log: str) -> str:
    """What a log ends with: why its job failed. Nothing where it is empty or not there."""
    try:
        with open(log, encoding="utf-8", errors="replace") as file:
            return printable("".join(file.read().strip().splitlines()[-1:]))
    except OSError:
        return ""


class JobLines(logging.Filter):
    """Handler of Snakemake's logger that prints a line for each finished job.

    handler: the one that writes to the terminal. Errors pass through it as they are.
    """

    def __init__(self, handler: logging.Handler) -> None:
        super().__init__()
        self._handler, self._format = handler, handler.format
        self._seconds: dict[int, float] = {}  # estimates of the jobs that are left
        self._rules: dict[int, str] = {}  # of all jobs
        self._alone: set[int] = set()  # jobs that take every core
        self._known: dict[str, list[float]] = {}  # times of finished jobs
        self._labels: dict[int, str] = {}
        self._logs: dict[int, list[str]] = {}
        self._started: dict[int, float] = {}
        self._estimated = self._took = self._worked = 0.0
        self._done = self._count = 0
        self._begin = self._last = time.monotonic()
        handler.addFilter(self)
        handler.format = self._line  # type: ignore[method-assign]

    def begin(self, jobs: Mapping[int, Step | Bundle | None]) -> None:
        """Take the jobs of a run by their numbers; none for those that are no study's."""
        self._seconds = {job: _expected(one) if one else PROCESS for job, one in jobs.items()}
        self._alone = {job for job, one in jobs.items() if one and one.alone}
        self._rules = {job: one.rule if one else "" for job, one in jobs.items()}
        self._count, self._begin = len(jobs), time.monotonic()
        self._last = self._begin
        self._print(f"{self._count} jobs")
        threading.Thread(target=self._name_running, daemon=True).start()

    def filter(self, record: logging.LogRecord) -> bool:
        event = getattr(getattr(record, "event", None), "name", None)
        if event == "JOB_INFO":
            job: int = record.jobid  # type: ignore[attr-defined]
            self._labels[job] = record.rule_msg or record.rule_name  # type: ignore[attr-defined]
            self._logs[job] = vars(record).get("log") or []
            self._started[job] = time.monotonic()
        return event not in _DROPPED and not str(record.msg).lstrip().startswith(_UNINFORMATIVE)

    def _line(self, record: logging.LogRecord) -> str:
        event, values = getattr(getattr(record, "event", None), "name", None), vars(record)
        if event == "JOB_FINISHED":
            return self._finished(values["job_id"])
        if event == "JOB_ERROR":
            logs = ", ".join(values["log"])
            label = self._labels.get(values["jobid"], values["rule_name"])
            reasons = [line for log in values["log"] if (line := _last_line(log))]
            return f"failed: {': '.join([label, *reasons])}; see {logs}"
        return self._format(record)

    def _finished(self, job: int) -> str:
        self._last = time.monotonic()
        took = self._last - self._started.pop(job, self._last)
        estimate = self._seconds.pop(job, PROCESS)
        self._worked += took
        if took < UNUSUAL * max(estimate, PROCESS):
            self._estimated += estimate
            self._took += took
            self._known.setdefault(self._rules.get(job, ""), []).append(took)
        self._done += 1
        width = len(str(self._count))
        text = f"{self._done:{width}} of {self._count}: {self._labels.get(job, job)}, {took:.0f} s"
        return f"{text}; about {self._left():.0f} s left" if self._seconds else text

    def _left(self) -> float:
        """Time left: of each kind at the pace of finished ones, as many at a time as so far [s]."""
        now = time.monotonic()
        pace = (self._took + PACE_ASSUMED) / (self._estimated + PACE_ASSUMED)
        run = {job: now - start for job, start in list(self._started.items())}
        left = {}
        for job, seconds in list(self._seconds.items()):
            known = self._known.get(self._rules[job])
            whole = sum(known) / len(known) if known else pace * seconds
            passed = run.get(job, 0.0)
            left[job] = max(whole - passed, LATE * passed)
        at_a_time = (self._worked + sum(run.values())) / max(now - self._begin, 1e-3)
        at_a_time = min(at_a_time, len(left) / WAITING)
        alone = sum(seconds for job, seconds in left.items() if job in self._alone)
        shared = (sum(left.values()) - alone) / max(at_a_time, 1.0)
        return max(alone + shared, *left.values(), 0.0)

    def _name_running(self) -> None:
        """Name the jobs that run, for the command that passes on the lines; each time these change.

        It also says that one compiles.
        """
        named = ""
        while self._seconds:
            time.sleep(0.2)
            running = list(self._started)
            if time.monotonic() - self._last > LINE_EVERY and any(
                map(_compiles, (log for job in running for log in self._logs[job]))
            ):
                tell_of_compiling()
            names = "; ".join(self._labels[job] for job in running)
            if names != named and RELAYED in os.environ:
                named = names
                self._print(f"{RUNNING_JOBS}{names}")

    def _print(self, text: str) -> None:
        record: dict[str, Any] = {"msg": text, "levelno": logging.INFO}
        self._handler.handle(logging.makeLogRecord(record))
