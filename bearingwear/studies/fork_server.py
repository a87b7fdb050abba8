"""Runs the commands of jobs as forks of one process, which has imported what they need.

Importing takes longer than solving a line of the grid. Rules run this file in place of the command
(the shell prefix in workflow/rules/common.smk), and nothing else knows of it: the second job of a
run starts the server, which learns from each job what to import, and ends with Snakemake. A job
remains a process: it can fail, be killed and run again by itself. Where no server is, as on other
systems than Linux, the same command runs alone.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import sys

TYPE_CHECKING = False  # `typing` would take longer than the rest
if TYPE_CHECKING:
    from selectors import DefaultSelector

_FOLDER = ".snakemake/bearingwear-{}"  # id of Snakemake's process; in the folder of the study
_SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "run_module.py")
_MOST_BYTES = 1 << 16


def run_job(snakemake: str, arguments: list[str]) -> int:
    """Runs a command by the server of a run, else as a process, and returns its exit status.

    Where no server listens, the second job of a run starts one for later jobs. A command whose
    server ends without an answer runs again as a process. The end by signal N is status 128 + N.

    snakemake: id of Snakemake's process.
    arguments: of the command `bearingwear`.
    """
    folder = _FOLDER.format(snakemake)
    try:
        with socket.socket(socket.AF_UNIX) as server:
            server.connect(f"{folder}/socket")
            request = json.dumps([os.getcwd(), arguments]).encode() + b"\n"
            sent = socket.send_fds(server, [request], [1, 2])
            server.sendall(request[sent:])
            if answer := server.recv(16):
                return int(answer)
    except OSError:
        _start_server(folder, snakemake)
    command = [sys.executable, "-P", _SCRIPT, "bearingwear", *arguments]
    return _shell_status(os.spawnv(os.P_WAIT, sys.executable, command))


def _shell_status(status: int) -> int:
    """Returns the exit status of a process as a shell does: 128 + N for the end by signal N."""
    return status if status >= 0 else 128 - status


def _start_server(folder: str, snakemake: str) -> None:
    """Starts a server at the second job of a run, if the system allows it.

    The first job only makes the folder, and all jobs after the second find that a server has been
    started. Where the system has no `pidfd_open`, no job starts one.

    folder: of the server, one for each run of Snakemake.
    """
    try:
        os.mkdir(folder)
        return  # the first job of a run may be the only one
    except OSError:
        pass
    try:
        os.mkdir(f"{folder}/server")  # fails in all processes but the first that tries
        os.pidfd_open(int(snakemake))  # as the server does
    except (AttributeError, OSError):
        return
    import subprocess

    nothing = subprocess.DEVNULL
    subprocess.Popen(
        [sys.executable, "-P", _SCRIPT, "bearingwear.studies.fork_server", folder, snakemake],
        stdin=nothing,
        stdout=nothing,
        stderr=nothing,
        start_new_session=True,
    )


def log_silent_failure(status: int) -> None:
    """Writes the exit status of a job in its log, if it failed without a message.

    The log is the file to which standard error goes. Where that is no file, as on a terminal,
    nothing is written.
    """
    try:
        if status and os.path.isfile("/dev/stderr") and not os.fstat(2).st_size:
            cause = f" (by signal {status - 128})" if status > 128 else ""
            if status == os.EX_IOERR:  # of a command that could not even write a line
                cause = " (No space left on device)"
            print(f"ended with status {status}{cause} without a message", file=sys.stderr)
    except OSError:
        pass  # a full disk


_RUNNING: set[int] = set()
"""Process ids of the jobs that the server has started and that have not ended."""


def serve(folder: str, snakemake: int) -> None:
    """Forks for each command until Snakemake ends, and imports modules in between.

    Snakemake's end also ends the jobs that still run, by SIGTERM, and the function then returns.

    folder: of the server's socket; it is deleted in the end.
    snakemake: id of Snakemake's process.
    """
    import gc
    import selectors
    import shutil

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it reaches the jobs, which end
    to_import = {"bearingwear.commands", "bearingwear.arguments", "bearingwear.cli"}
    selector = selectors.DefaultSelector()
    listener = socket.socket(socket.AF_UNIX)
    selector.register(os.pidfd_open(snakemake), selectors.EVENT_READ, _end)
    listener.bind(f"{folder}/socket")
    listener.listen(128)
    selector.register(listener, selectors.EVENT_READ, lambda *_: _accept(selector, listener))
    imported: set[str] = set()
    try:
        while True:
            for event, _ in selector.select(0.0 if to_import else None):
                to_import |= event.data() or set()  # a callback returns modules, or None
            to_import -= imported
            if to_import:
                name = min(to_import)
                imported.add(name)
                try:
                    __import__(name)
                except BaseException:  # the job that needs the module reports the error
                    pass
                if to_import == {name}:
                    gc.freeze()  # pages that no fork has to copy
    except _Ended:
        listener.close()
        for job in _RUNNING:
            os.kill(job, signal.SIGTERM)
        shutil.rmtree(folder, ignore_errors=True)


class _Ended(Exception):
    """Snakemake has ended."""


def _end() -> None:
    """Raises `_Ended` when Snakemake has ended."""
    raise _Ended


def _accept(selector: DefaultSelector, listener: socket.socket) -> None:
    """Forks a job for a client that connects, and registers callbacks for both.

    Nothing is forked for a client that is gone. The callbacks wait for the end of the client, the
    names of the modules that the job imported, and the end of the job.
    """
    from selectors import EVENT_READ

    client = listener.accept()[0]
    request, files, _, _ = socket.recv_fds(client, _MOST_BYTES, 2)
    while not request.endswith(b"\n"):
        received = client.recv(_MOST_BYTES)
        if not received:  # the client was killed before it had sent all
            client.close()
            for file in files:
                os.close(file)
            return
        request += received
    folder, arguments = json.loads(request)
    report_end, pipe_end = os.pipe()
    job = os.fork()
    if job == 0:
        listener.close()
        _run_and_exit(folder, arguments, files, pipe_end)  # does not return
    _RUNNING.add(job)
    for file in (*files, pipe_end):
        os.close(file)
    selector.register(client, EVENT_READ, lambda: _end_abandoned_job(selector, client, job))
    selector.register(report_end, EVENT_READ, lambda: _imported_modules(selector, report_end))
    job_file = os.pidfd_open(job)
    selector.register(job_file, EVENT_READ, lambda: _send_status(selector, client, job, job_file))


def _end_abandoned_job(selector: DefaultSelector, client: socket.socket, job: int) -> None:
    """Ends a job whose client is gone, by SIGTERM; `_send_status` follows when it has ended.

    A client sends nothing after its request, so that its socket is readable only at its end.
    """
    os.kill(job, signal.SIGTERM)
    selector.unregister(client)


def _imported_modules(selector: DefaultSelector, report_end: int) -> set[str]:
    """Returns the names of the modules that a job has imported, and closes its pipe.

    report_end: descriptor from which the server reads.
    """
    selector.unregister(report_end)
    with os.fdopen(report_end, "rb") as file:
        return set(file.read().decode().split())


def _send_status(selector: DefaultSelector, client: socket.socket, job: int, job_file: int) -> None:
    """Sends the exit status of a finished job to its client, if that is not gone; forgets both."""
    status = os.waitstatus_to_exitcode(os.waitpid(job, 0)[1])
    _RUNNING.discard(job)
    selector.unregister(job_file)
    os.close(job_file)
    try:
        selector.unregister(client)
        client.sendall(b"%d" % _shell_status(status))
    except (OSError, KeyError):  # the client is gone
        pass
    client.close()


def _run_and_exit(folder: str, arguments: list[str], files: list[int], pipe_end: int) -> None:
    """Runs a command in this process, and ends the process with the status of the command.

    The status is 1 after an exception or a message in SystemExit. The function never returns.

    files: descriptors of standard output and standard error.
    pipe_end: descriptor that takes the names of the modules that the command imported.
    """
    import runpy
    import traceback

    modules_before = set(sys.modules)
    status = 1  # unless the command says otherwise
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for descriptor, file in enumerate((os.open(os.devnull, os.O_RDONLY), *files)):
            os.dup2(file, descriptor)
            os.close(file)
        os.chdir(folder)
        sys.argv = ["bearingwear", *arguments]
        runpy.run_module("bearingwear", run_name="__main__")
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException:
        traceback.print_exc()
    finally:
        try:
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            new_modules = sorted(
                name for name in sys.modules.keys() - modules_before if not name.startswith("_")
            )
            os.write(pipe_end, " ".join(new_modules).encode()[:_MOST_BYTES])
            os._exit(status)


if __name__ == "__main__":
    if __spec__:  # run as a module
        serve(sys.argv[1], int(sys.argv[2]))
    else:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # ignored so far, lest it leave a traceback
        job_status = run_job(sys.argv[1], sys.argv[2:])
        log_silent_failure(job_status)
        sys.exit(job_status)
