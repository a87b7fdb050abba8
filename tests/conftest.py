"""Fixtures shared by all tests, and how the tests are dealt out to processes."""

import fcntl
import gc
import os
import shutil
import signal
from pathlib import Path

import pytest
from support import ROOT, scene_file

SPREAD_OUT = ROOT / "tests" / "workflow"
"""Tests of one file here need not run in one process: what they share is made once for all."""

OF_SOURCES = {"test_imports.py", "test_names.py", "test_provenance.py"}
"""Files whose tests go through the sources of the whole package, which one process parses once."""

LONGEST_FIRST = "workflow", "studies", "lives", "solvers", "kernels"
"""Folders whose files take seconds to half a minute: a process has no work beside a late one."""

_NEW_OBJECTS = 20_000  # before Python looks for garbage; 700 by default


def pytest_configure():
    """Let the programs that tests start be as a user's.

    They heed Ctrl-C, also where pytest runs in the background, and keep what Python makes of their
    sources: each would do that anew, for a quarter of a second.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """In a new clone, one process prepares the tests' assertions, and the others read its files."""
    with open(__file__) as file:
        if not any(Path(__file__).parent.glob("__pycache__/test_*")):
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                fcntl.flock(file, fcntl.LOCK_SH)
                fcntl.flock(file, fcntl.LOCK_UN)
        return (yield)


def pytest_collection_finish():
    """What is loaded by now is no garbage, and is not looked through again and again."""
    gc.freeze()
    gc.set_threshold(_NEW_OBJECTS, *gc.get_threshold()[1:])


def pytest_collection_modifyitems(items):
    """Tests of the folders above come first."""
    rank = {ROOT / "tests" / name: k for k, name in enumerate(LONGEST_FIRST)}

    def place(item):
        return min((rank[folder] for folder in item.path.parents if folder in rank), default=9)

    items.sort(key=place)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Keep the tests of a file in one process of pytest-xdist: they share its fixtures.

    Its own `--dist loadgroup` does that no more with pytest 9.2, which fixes the names of tests.
    """
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            file, _, _ = nodeid.partition("::")
            if Path(file).name in OF_SOURCES:
                return "sources"
            return nodeid if SPREAD_OUT in (ROOT / file).parents else file

    return ByFile(config, log)


@pytest.fixture(scope="session")
def made_once(tmp_path_factory):
    """Function (name, make) -> folder that make(folder) filled, once for all processes."""

    def folder_of(name, make) -> Path:
        folder = tmp_path_factory.getbasetemp() / name
        if "PYTEST_XDIST_WORKER" in os.environ:
            folder = folder.parents[1] / name
        with open(f"{folder}.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (done := folder.with_suffix(".done")).exists():
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                make(folder)
                done.touch()
        return folder

    return folder_of


@pytest.fixture(scope="session")
def small_project(made_once):
    """Folder of a small study with all of its results."""
    from small_study import make_small_study

    return made_once("small_study", make_small_study)


@pytest.fixture(scope="session")
def scene():
    """Function (name, {key: value}) -> Scene, from config/scenes."""
    from bearingwear.scene.read import variant

    def build(name="gyro_s1", changes=None):
        return variant(scene_file(name), changes or {})

    return build


@pytest.fixture(scope="session")
def values(scene):
    """Function (method, mu, loss_um, drag, **other) -> values of the solved scene gyro_s1."""
    from bearingwear.solvers.solve import solve

    def solved(method="constant_force", mu=0.08, loss=0.0, drag=0.0, fidelity=None, **other):
        changes = {
            "operation.preload_method": method,
            "friction.ball_race": mu,
            "wear.ball_diameter_loss_um": loss,
            "lubricant.drag_density_kg_m3": drag,
        }
        changes |= {key.replace("__", "."): value for key, value in other.items()}
        result = solve(scene("gyro_s1", changes), fidelity)
        assert result.status == "ok", result.status
        return result.values

    return solved
