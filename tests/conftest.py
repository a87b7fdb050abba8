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
"""Folder whose tests of one file may run in several processes: their fixtures are `made_once`."""

OF_SOURCES = {"test_imports.py", "test_names.py", "test_provenance.py"}
"""Files whose tests go through the sources of the whole package, which one process parses once."""

LONGEST_FIRST = "workflow", "studies", "lives", "solvers", "kernels"
"""Folders whose files take seconds to half a minute. They start first, so that no process waits for
another at the end."""

_NEW_OBJECTS = 20_000  # before Python looks for garbage; 700 by default


def pytest_configure():
    """Gives the programs that tests start the settings that they have when a user starts them.

    Ctrl-C ends them also where pytest runs in the background. They store compiled Python, without
    which each of them would start a quarter of a second later.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Lets one process compile the tests in a new clone, while the others wait for its files."""
    with open(__file__) as file:
        if not any(Path(__file__).parent.glob("__pycache__/test_*")):
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                fcntl.flock(file, fcntl.LOCK_SH)
                fcntl.flock(file, fcntl.LOCK_UN)
        return (yield)


def pytest_collection_finish():
    """Excludes all objects loaded so far from garbage collection, which takes time."""
    gc.freeze()
    gc.set_threshold(_NEW_OBJECTS, *gc.get_threshold()[1:])


def pytest_collection_modifyitems(items):
    """Sorts tests by their folders in the order of `LONGEST_FIRST`; those of others come last."""
    rank = {ROOT / "tests" / name: k for k, name in enumerate(LONGEST_FIRST)}

    def folder_rank(item):
        """Returns the place of a test's folder in `LONGEST_FIRST`, or the number of its entries."""
        ranks = [rank[folder] for folder in item.path.parents if folder in rank]
        return min(ranks, default=len(LONGEST_FIRST))

    items.sort(key=folder_rank)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Keeps the tests of a file, which share fixtures, in one process of pytest-xdist.

    Exceptions are the files `OF_SOURCES`, which share a process, and the tests in `SPREAD_OUT`,
    which may be in any. The option `--dist loadgroup` of pytest-xdist no longer works with pytest
    9.2, which does not let it rename tests.
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
    """Returns a function that makes a folder once for all processes of a run of the tests.

    Its arguments are the name of the folder and a function that fills it; it returns the path.
    """

    def folder_of(name, make) -> Path:
        folder = tmp_path_factory.getbasetemp() / name
        if "PYTEST_XDIST_WORKER" in os.environ:
            folder = folder.parents[1] / name  # beside the folders of the processes
        with open(f"{folder}.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            stamp = folder.with_suffix(".done")
            if not stamp.exists():
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                make(folder)
                stamp.touch()
        return folder

    return folder_of


@pytest.fixture(scope="session")
def small_project(made_once):
    """Returns the folder of a small study with all of its results, which no test may change."""
    from small_study import make_small_study

    return made_once("small_study", make_small_study)


@pytest.fixture(scope="session")
def scene():
    """Returns a function that reads a scene of config/scenes by its name.

    Its second argument holds values to change, by their dotted keys.
    """
    from bearingwear.scene.read import variant

    def build(name="gyro_s1", changes=None):
        return variant(scene_file(name), changes or {})

    return build


@pytest.fixture(scope="session")
def values(scene):
    """Returns a function that solves the scene gyro_s1 and returns the values of its result.

    Its arguments are preload method, friction, loss of ball diameter [um], drag density [kg/m3],
    and fidelity. Other keys of the scene have `__` for the dot.
    """
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
