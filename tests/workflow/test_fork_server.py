"""The process that runs the jobs of a study as forks of itself."""

import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bearingwear import __version__
from bearingwear.provenance import PACKAGE
from bearingwear.studies import fork_server


@pytest.mark.skipif(sys.platform != "linux", reason="jobs run alone where there is no pidfd")
def test_a_client_that_is_killed_before_it_asks_holds_up_no_job(tmp_path, monkeypatch):
    """A client connects and is closed without a request; the next job is served all the same.

    The process `sleep` has the part of Snakemake: the server ends when it does.
    """
    monkeypatch.chdir(tmp_path)  # the address of a socket must be short
    snakemake = subprocess.Popen(["sleep", "60"])
    folder = Path(f".snakemake/bearingwear-{snakemake.pid}")
    folder.mkdir(parents=True)
    module = ["bearingwear.studies.fork_server", str(folder), str(snakemake.pid)]
    server = subprocess.Popen([sys.executable, "-P", str(PACKAGE / "run_module.py"), *module])
    try:
        address = str(folder / "socket")
        for _ in range(300):  # 30 s at most, until the server listens
            with socket.socket(socket.AF_UNIX) as client:
                if client.connect_ex(address) == 0:
                    break
            time.sleep(0.1)
        job = subprocess.run(
            [sys.executable, "-I", "-S", fork_server.__file__, str(snakemake.pid), "--version"],
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert job.returncode == 0 and __version__ in job.stdout
        snakemake.kill()
        snakemake.wait()
        assert server.wait(timeout=30) == 0
    finally:
        snakemake.kill()
        server.kill()
