"""Commands that a fork of one process runs: as by themselves, and ended with who waits for them."""

import os
import subprocess
import sys
import time

import psutil
import pytest
from support import ROOT

from bearingwear.cli import main
from bearingwear.studies import fork_server

CLIENT = [sys.executable, "-I", "-S", fork_server.__file__]
CASE = ["step", "studies.grid.solve.solved_line", f"scene={ROOT}/config/scenes/gyro_s1.yaml"]
CASE += ["--settings", '{"method": "constant_force", "friction": 0.08, "losses_um": [0.5]}', "-o"]
LONG = ["life", f"{ROOT}/config/scenes/gyro_s1.yaml", "--fidelity", "dynamic", "-o", "life.nc"]


def wait(condition):
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)


@pytest.fixture(scope="module")
def server():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(fork_server._ADDRESS, "")
        server = fork_server.started(["bearingwear.studies.grid.solve"])
        if server is None:
            pytest.skip("no server on this system")
        wait(lambda: os.path.exists(os.environ[fork_server._ADDRESS]))
        yield server
        server.communicate()
        assert server.returncode == 0
        assert not os.path.exists(os.path.dirname(os.environ[fork_server._ADDRESS]))


def run(*arguments, folder):
    return subprocess.run(
        [*CLIENT, *arguments], cwd=folder, capture_output=True, text=True, timeout=300.0
    )


def test_a_fork_writes_the_bytes_of_a_process_of_its_own(server, tmp_path):
    forked = run(*CASE, "forked.nc", folder=tmp_path)
    assert (forked.returncode, forked.stdout, forked.stderr) == (0, "", "")
    assert main([*CASE, str(tmp_path / "alone.nc")]) == 0
    assert (tmp_path / "forked.nc").read_bytes() == (tmp_path / "alone.nc").read_bytes()


def test_output_and_status_are_those_of_the_command(server, tmp_path):
    bad = run("step", "studies.grid.solve.nothing", "-o", "a.nc", folder=tmp_path)
    assert bad.returncode == 2 and bad.stdout == ""
    assert bad.stderr == "step: got studies.grid.solve.nothing, which does not exist\n"
    assert run("--version", folder=tmp_path).stdout.startswith("bearingwear ")


def test_a_fork_ends_with_its_client(server, tmp_path):
    client = subprocess.Popen([*CLIENT, *LONG], cwd=tmp_path, stderr=subprocess.DEVNULL)
    forks = psutil.Process(server.pid).children
    wait(forks)
    client.kill()
    client.wait()
    wait(lambda: not forks())
    assert run("--version", folder=tmp_path).returncode == 0


def test_a_killed_fork_is_a_failure(server, tmp_path):
    client = subprocess.Popen([*CLIENT, *LONG], cwd=tmp_path, stderr=subprocess.DEVNULL)
    forks = psutil.Process(server.pid).children
    wait(forks)
    forks()[0].kill()
    assert client.wait(60.0) == 128 + 9


def test_a_server_that_is_gone_is_not_needed(tmp_path, monkeypatch):
    monkeypatch.setenv(fork_server._ADDRESS, str(tmp_path / "socket"))
    assert run("--version", folder=tmp_path).stdout.startswith("bearingwear ")
