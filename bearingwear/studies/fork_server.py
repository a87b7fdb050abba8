"""A process that has the modules of a study imported; each job of a run is a fork of it.

Importing takes longer than solving a line of the grid. A job remains a process: it can fail, be
killed and run again by itself. Where no server is, as on a cluster's node, the same command imports
what it needs.

The rules run this file as a script, `python -I -S fork_server.py COMMAND ...`. It passes the
command to the server, with its standard output and error, and ends with the command's status.
"""

from __future__ import annotations

import json
import os
import socket
import sys

TYPE_CHECKING = False  # `typing` would take longer than the rest
if TYPE_CHECKING:
    import subprocess

_ADDRESS = "BEARINGWEAR_FORK_SERVER"
_MOST_BYTES = 1 << 16

_LIBRARIES = (
    "netCDF4", "numba.np.arrayobj", "numba.np.arraymath", "numba.cpython.charseq",
    "scipy.interpolate", "scipy.optimize",
)  # fmt: skip
"""Those that a job would import only as it writes a file, loads a kernel or seeks a root."""


def started(modules: list[str]) -> subprocess.Popen[bytes] | None:
    """Start a server that imports modules; jobs find it, and it ends with this process.

    On Linux alone: elsewhere a process with libraries is not forked safely.
    """
    import atexit
    import subprocess
    import tempfile

    from bearingwear.process import ONE_THREAD, python_command

    if not hasattr(os, "pidfd_open"):
        return None
    address = os.path.join(tempfile.mkdtemp(prefix="bearingwear-"), "socket")
    os.environ[_ADDRESS] = address
    server = subprocess.Popen(
        python_command("bearingwear.studies.fork_server", address, *modules),
        # as Snakemake gives to jobs of one thread
        env=os.environ | dict.fromkeys(ONE_THREAD, "1"),
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    # closes its input and waits, so that its CPU time counts as that of a child
    atexit.register(server.communicate)
    return server


def _serve(address: str, modules: list[str]) -> None:
    """Fork for each command until standard input ends; import in between."""
    import contextlib
    import gc
    import importlib
    import selectors
    import shutil
    import signal

    os.close(os.pidfd_open(os.getpid()))  # a kernel without it: no server
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # which is for the jobs
    waiting = _imports(modules)
    selector, listener = selectors.DefaultSelector(), socket.socket(socket.AF_UNIX)
    listener.bind(address)
    listener.listen(128)
    selector.register(listener, selectors.EVENT_READ)
    selector.register(sys.stdin, selectors.EVENT_READ)
    while selector.get_map():
        for key, _ in selector.select(0.0 if waiting else None):
            if key.fileobj is sys.stdin:
                for other in [*selector.get_map().values()]:  # jobs of a Snakemake that was killed
                    if isinstance(other.data, int):
                        os.kill(other.data, signal.SIGTERM)
                selector.unregister(sys.stdin)
                selector.unregister(listener)
                listener.close()
                shutil.rmtree(os.path.dirname(address))
                waiting.clear()
            elif key.fileobj is listener:
                client = listener.accept()[0]
                job = _forked(client, listener)
                selector.register(client, selectors.EVENT_READ, job)
                selector.register(os.pidfd_open(job), selectors.EVENT_READ, (job, client))
            elif isinstance(key.data, int):  # nobody waits for it any more
                os.kill(key.data, signal.SIGTERM)
                selector.unregister(key.fileobj)
            else:
                job, client = key.data
                status = os.waitstatus_to_exitcode(os.waitpid(job, 0)[1])
                with contextlib.suppress(OSError, KeyError):
                    selector.unregister(client)
                    client.sendall(b"%d" % (status if status >= 0 else 128 - status))
                client.close()
                selector.unregister(key.fd)
                os.close(key.fd)
        if waiting:
            # what goes wrong is for the log of the job that needs the module: it tries again
            with contextlib.suppress(BaseException):
                importlib.import_module(waiting.pop())
            if not waiting:
                gc.freeze()  # pages that no fork has to copy


def _imports(modules: list[str]) -> list[str]:
    """Names of all modules that some modules import, directly or through each other, or need."""
    from bearingwear.provenance import PACKAGE, sources

    paths = sources("bearingwear.studies.run_step", "bearingwear.results.netcdf", *modules)
    places = [path.relative_to(PACKAGE.parent) for path in paths if path.suffix == ".py"]
    names = [".".join(place.with_suffix("").parts).removesuffix(".__init__") for place in places]
    commands = "bearingwear.commands", "bearingwear.arguments", "bearingwear.cli"
    return [*_LIBRARIES, *names, *commands]


def _forked(client: socket.socket, listener: socket.socket) -> int:
    """Number of the process that runs the command of a client."""
    request, files, _, _ = socket.recv_fds(client, _MOST_BYTES, 2)
    while not request.endswith(b"\n"):
        request += client.recv(_MOST_BYTES)
    folder, arguments = json.loads(request)
    job = os.fork()
    if job == 0:
        listener.close()
        _run(folder, arguments, files)
    for file in files:
        os.close(file)
    return job


def _run(folder: str, arguments: list[str], files: list[int]) -> None:
    """Run a command in this process, which ends with it."""
    import runpy
    import signal
    import traceback

    status = 1
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for place, file in enumerate((os.open(os.devnull, os.O_RDONLY), *files)):
            os.dup2(file, place)
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
            os._exit(status)


def _asked(arguments: list[str]) -> int:
    """Exit status of a command that the server runs."""
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(os.environ[_ADDRESS])
        request = json.dumps([os.getcwd(), arguments]).encode() + b"\n"
        sent = socket.send_fds(server, [request], [1, 2])
        server.sendall(request[sent:])
        if status := server.recv(16):
            return int(status)
        raise ConnectionResetError  # an import has ended the server


if __name__ == "__main__":
    if __spec__:  # run as a module
        _serve(sys.argv[1], sys.argv[2:])
    else:
        try:
            sys.exit(_asked(sys.argv[1:]))
        except (KeyError, OSError):
            script = os.path.join(os.path.dirname(os.path.dirname(__file__)), "run_module.py")
            command = [sys.executable, "-P", script, "bearingwear", *sys.argv[1:]]
            os.execv(sys.executable, command)
