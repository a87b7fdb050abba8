"""Commands do the same wherever they run: in whichever folder, environment and home."""

import getpass
import os
import pwd
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
import yaml
from support import ROOT, scene_file

from bearingwear import process
from bearingwear.cli import main

BACKENDS = {
    "of a notebook": "module://matplotlib_inline.backend_inline",
    "of a module that is missing": "module://nowhere.to.be.found",
    "of a module that is none of matplotlib's": "module://json",
    "that needs a display": "tkagg",
    "of another system": "macosx",
    "of a server": "webagg",
    "that does not exist": "nonsense",
}
LIBRARIES = (
    "signal", "calendar", "email", "numpy", "matplotlib", "json", "random", "socket", "select",
    "shutil", "typing", "yaml", "psutil", "netCDF4", "xarray", "snakemake", "bearingwear",
    "sitecustomize",
)  # fmt: skip
"""What files of a user may be called, who knows nothing of Python."""

ONE_CASE = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": ["constant_force"],
            "friction": [0.02],
            "ball_diameter_loss_um": [0],
        }
    ],
    "figures": {"worn_loss_um": 0.5, "friction": [0.02]},
}
OF_A_USER = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")
NAMES = ("LOGNAME", "USER", "LNAME", "USERNAME")


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("case") / "a.nc"
    assert main(["solve", str(scene_file("gyro_s1")), "-o", str(path), "--quiet"]) == 0
    return path


@pytest.fixture
def folder_of_a_user(tmp_path):
    """A folder whose files have the names of libraries; who imports one leaves a mark."""
    for name in LIBRARIES:
        mark = tmp_path / f"{name}-was-imported"
        (tmp_path / f"{name}.py").write_text(f"open({str(mark)!r}, 'w')\n")
    return tmp_path


def imported(folder):
    return sorted(path.name for path in folder.glob("*-was-imported"))


def run(folder, *command, **environment):
    """A command as it is typed; a variable that is None is not set."""
    variables = {**os.environ, **environment}
    return subprocess.run(
        [str(part) for part in command],
        cwd=folder,
        env={key: value for key, value in variables.items() if value is not None},
        input="\n",
        capture_output=True,
        text=True,
    )


def bearingwear(folder, *arguments, **environment):
    return run(folder, sys.executable, "-P", "-m", "bearingwear", *arguments, **environment)


# figures


@pytest.mark.parametrize("backend", BACKENDS.values(), ids=BACKENDS)
def test_a_backend_is_for_others(backend, case, tmp_path):
    """What a notebook, or a user's own scripts, need; commands draw into files."""
    done = bearingwear(tmp_path, "plot", case, "-o", "a.svg", MPLBACKEND=backend, DISPLAY=None)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert (tmp_path / "a.svg").stat().st_size > 1000


def test_a_backend_of_a_settings_file(case, tmp_path):
    (tmp_path / "matplotlibrc").write_text("backend: tkagg\n")
    done = bearingwear(tmp_path, "plot", case, "-o", "a.png", MPLBACKEND=None, DISPLAY=None)
    assert done.returncode == 0 and (tmp_path / "a.png").exists(), done.stderr


def test_the_library_leaves_the_backend_alone(case, tmp_path):
    script = "import bearingwear, matplotlib, os; bearingwear.plot({!r}); "
    script += "print(matplotlib.rcParams['backend'], os.environ['MPLBACKEND'])"
    done = run(tmp_path, sys.executable, "-c", script.format(str(case)), MPLBACKEND="svg")
    assert done.stdout.split() == ["svg", "svg"], done.stderr


# files with the names of libraries


def test_no_file_of_the_user_is_imported(folder_of_a_user):
    """By a command, and by a job of a study."""
    scene = scene_file("gyro_s1")
    done = bearingwear(folder_of_a_user, "solve", scene, "-o", "a.nc")
    assert done.returncode == 0, done.stderr
    job = process.python_command("bearingwear", "show", "a.nc")
    done = run(folder_of_a_user, *job)
    assert done.returncode == 0 and "contact load" in done.stdout, done.stderr
    assert imported(folder_of_a_user) == []


def test_the_files_would_be_imported(folder_of_a_user):
    run(folder_of_a_user, sys.executable, "-c", "import calendar", PYTHONSAFEPATH=None)
    assert imported(folder_of_a_user) == ["calendar-was-imported"]


def test_a_module_is_run_of_the_same_sources(tmp_path):
    """Not of another copy that the environment has: a copy of a checkout runs its own jobs."""
    without = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "bearingwear", tmp_path / "bearingwear", ignore=without)
    (tmp_path / "bearingwear" / "where.py").write_text("print(__file__, __name__)\n")
    script = "from bearingwear.process import python_command as c; import json; "
    script += "print(json.dumps(c('bearingwear.where')))"
    done = run(tmp_path, sys.executable, "-c", script, PYTHONSAFEPATH=None)
    command = yaml.safe_load(done.stdout)
    done = run(ROOT, *command)
    assert done.stdout.split() == [str(tmp_path / "bearingwear" / "where.py"), "__main__"]


# users without a home or a name


def taken(folder):
    (folder / "taken").write_text("")
    return str(folder / "taken")


HOMES = {
    "no home": lambda folder: {"HOME": None},
    "an empty name": lambda folder: {"HOME": "", "XDG_CACHE_HOME": taken(folder)},
    "a folder that is missing": lambda folder: {"HOME": "/proc/nothing"},
    "a relative one": lambda folder: {"HOME": "home"},
    "a file": lambda folder: {"HOME": taken(folder)},
    "no folder for caches": lambda folder: {"HOME": str(folder), "XDG_CACHE_HOME": taken(folder)},
    "a relative one for caches": lambda folder: {"HOME": str(folder), "XDG_CACHE_HOME": "caches"},
}


@pytest.fixture
def nobody(tmp_path, monkeypatch):
    """A user with a number alone; what is set for it is undone."""

    def unknown(number):
        raise KeyError(number)

    for name in (*OF_A_USER, *NAMES, "MPLBACKEND", "PYTHONSAFEPATH"):
        monkeypatch.setenv(name, "")
        monkeypatch.delenv(name)
    monkeypatch.setattr(pwd, "getpwuid", unknown)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("home", HOMES.values(), ids=HOMES)
def test_a_user_gets_a_folder_for_caches(home, nobody, monkeypatch):
    for name, value in home(nobody).items():
        if value is not None:
            monkeypatch.setenv(name, value)
    process.set_environment()
    caches = Path(os.environ["XDG_CACHE_HOME"])
    assert (
        caches == nobody / f"bearingwear-{os.geteuid()}" and caches.stat().st_mode & 0o777 == 0o700
    )
    assert Path.home().is_dir() and getpass.getuser() == str(os.getuid())
    process.set_environment()
    assert Path(os.environ["XDG_CACHE_HOME"]) == caches


def test_a_folder_that_somebody_else_made_is_not_used(nobody):
    (nobody / f"bearingwear-{os.geteuid()}").mkdir(mode=0o777)
    (nobody / f"bearingwear-{os.geteuid()}").chmod(0o777)
    process.set_environment()
    caches = Path(os.environ["XDG_CACHE_HOME"])
    assert caches.parent == nobody and caches.stat().st_mode & 0o777 == 0o700


def test_a_home_that_serves_stays(nobody, monkeypatch):
    monkeypatch.setenv("HOME", str(nobody))
    monkeypatch.setenv("USER", "me")
    process.set_environment()
    assert not {"XDG_CACHE_HOME", "MPLCONFIGDIR", "LOGNAME"} & {*os.environ}
    assert os.environ["HOME"] == str(nobody) and getpass.getuser() == "me"


# all of it at once


def as_nobody():
    """What a command is run by so that its user has no name; nothing where that is not allowed."""
    if os.geteuid() != 0 or shutil.which("unshare") is None:
        return ()
    hide = ("unshare", "-m", "sh", "-c", 'mount --bind /dev/null /etc/passwd && exec "$@"', "sh")
    return hide if subprocess.run([*hide, "true"], capture_output=True).returncode == 0 else ()


@pytest.mark.long  # of single commands and of a job: the tests above
@pytest.mark.parametrize("command", ["bearingwear study", "snakemake"])
def test_a_study_anywhere(command, folder_of_a_user):
    """Figures are drawn, and nothing of the user's is run, in a container without a home."""
    folder = folder_of_a_user
    (folder / "config" / "scenes").mkdir(parents=True)
    (folder / "config" / "config.yaml").write_text(yaml.safe_dump(ONE_CASE))
    shutil.copy(scene_file("gyro_s1"), folder / "config" / "scenes")
    environment = {"MPLBACKEND": BACKENDS["of a notebook"], "DISPLAY": None}
    ours = command != "snakemake"  # which asks for a home before it reads any of ours
    if ours:
        environment |= dict.fromkeys((*OF_A_USER, *NAMES)) | {"HOME": "/proc/nothing"}
        run_by, words = as_nobody(), ["-P", "-m", "bearingwear", "study"]
    else:
        run_by, words = (), ["-P", "-m", "snakemake", "--snakefile", ROOT / "Snakefile"]
    done = run(folder, *run_by, sys.executable, *words, "-j2", **environment)
    output = done.stdout + done.stderr
    assert done.returncode == 0 and "Traceback" not in output, output
    assert list((folder / "results").rglob("*.svg"))
    assert imported(folder) == []
