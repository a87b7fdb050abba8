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
from support import ROOT, copy_tree, scene_file

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
"""Names that a user who does not know Python may give to files."""

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
HOME_VARIABLES = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")
NAME_VARIABLES = ("LOGNAME", "USER", "LNAME", "USERNAME")


@pytest.fixture(scope="module")
def case_file(tmp_path_factory):
    """Returns the file of a solved case."""
    path = tmp_path_factory.mktemp("case") / "a.nc"
    assert main(["solve", str(scene_file("gyro_s1")), "-o", str(path), "--quiet"]) == 0
    return path


@pytest.fixture
def folder_with_names_of_libraries(tmp_path):
    """Returns a folder whose files have the names of libraries; importing one writes a file."""
    for name in LIBRARIES:
        mark = tmp_path / f"{name}-was-imported"
        (tmp_path / f"{name}.py").write_text(f"open({str(mark)!r}, 'w')\n")
    return tmp_path


def import_marks(folder):
    """Returns the names of the files that imports in a folder have written."""
    return sorted(path.name for path in folder.glob("*-was-imported"))


def run_program(folder, *command, **environment):
    """Runs a program in a folder; a variable of the environment that is None is not set."""
    variables = {**os.environ, **environment}
    return subprocess.run(
        [str(part) for part in command],
        cwd=folder,
        env={key: value for key, value in variables.items() if value is not None},
        input="\n",
        capture_output=True,
        text=True,
    )


def run_bearingwear(folder, *arguments, **environment):
    """Runs a command of bearingwear in a folder. Arguments: `run_program`."""
    return run_program(folder, sys.executable, "-P", "-m", "bearingwear", *arguments, **environment)


# figures


@pytest.mark.parametrize("backend", BACKENDS.values(), ids=BACKENDS)
def test_figures_are_drawn_whatever_backend_of_matplotlib_is_set(backend, case_file, tmp_path):
    """Notebooks and scripts of users set backends that commands cannot use."""
    completed = run_bearingwear(
        tmp_path, "plot", case_file, "-o", "a.svg", MPLBACKEND=backend, DISPLAY=None
    )
    assert completed.returncode == 0 and not completed.stderr, completed.stderr
    assert (tmp_path / "a.svg").stat().st_size > 1000


def test_a_backend_in_matplotlibrc_is_not_used(case_file, tmp_path):
    (tmp_path / "matplotlibrc").write_text("backend: tkagg\n")
    completed = run_bearingwear(
        tmp_path, "plot", case_file, "-o", "a.png", MPLBACKEND=None, DISPLAY=None
    )
    assert completed.returncode == 0 and (tmp_path / "a.png").exists(), completed.stderr


def test_the_library_leaves_the_backend_alone(case_file, tmp_path):
    script = "import bearingwear, matplotlib, os; bearingwear.plot({!r}); "
    script += "print(matplotlib.rcParams['backend'], os.environ['MPLBACKEND'])"
    completed = run_program(
        tmp_path, sys.executable, "-c", script.format(str(case_file)), MPLBACKEND="svg"
    )
    assert completed.stdout.split() == ["svg", "svg"], completed.stderr


# files with the names of libraries


def test_no_file_of_the_user_is_imported(folder_with_names_of_libraries):
    """Neither a command nor a job of a study imports one."""
    scene = scene_file("gyro_s1")
    completed = run_bearingwear(folder_with_names_of_libraries, "solve", scene, "-o", "a.nc")
    assert completed.returncode == 0, completed.stderr
    job = process.python_command("bearingwear", "show", "a.nc")
    completed = run_program(folder_with_names_of_libraries, *job)
    assert completed.returncode == 0 and "contact load" in completed.stdout, completed.stderr
    assert import_marks(folder_with_names_of_libraries) == []


def test_an_import_of_a_users_file_is_detected(folder_with_names_of_libraries):
    run_program(
        folder_with_names_of_libraries, sys.executable, "-c", "import calendar", PYTHONSAFEPATH=None
    )
    assert import_marks(folder_with_names_of_libraries) == ["calendar-was-imported"]


def test_a_copy_of_a_checkout_runs_its_own_modules(tmp_path):
    """It does not run the modules of another copy that is installed."""
    copy_tree(tmp_path, "bearingwear")
    (tmp_path / "bearingwear" / "where.py").write_text("print(__file__, __name__)\n")
    script = "from bearingwear.process import python_command as c; import json; "
    script += "print(json.dumps(c('bearingwear.where')))"
    completed = run_program(tmp_path, sys.executable, "-c", script, PYTHONSAFEPATH=None)
    command = yaml.safe_load(completed.stdout)
    completed = run_program(ROOT, *command)
    assert completed.stdout.split() == [str(tmp_path / "bearingwear" / "where.py"), "__main__"]


# users without a home or a name


def file_in_the_way(folder):
    """Returns the path of a new file, which stands where a folder is needed."""
    (folder / "taken").write_text("")
    return str(folder / "taken")


HOMES = {
    "no home": lambda folder: {"HOME": None},
    "an empty name": lambda folder: {"HOME": "", "XDG_CACHE_HOME": file_in_the_way(folder)},
    "a folder that is missing": lambda folder: {"HOME": "/proc/nothing"},
    "a relative one": lambda folder: {"HOME": "home"},
    "a file": lambda folder: {"HOME": file_in_the_way(folder)},
    "no folder for caches": lambda folder: {
        "HOME": str(folder),
        "XDG_CACHE_HOME": file_in_the_way(folder),
    },
    "a relative one for caches": lambda folder: {"HOME": str(folder), "XDG_CACHE_HOME": "caches"},
}


@pytest.fixture
def nameless_user(tmp_path, monkeypatch):
    """Hides the name and the home of the user, and returns the folder for temporary files."""

    def unknown(number):
        raise KeyError(number)

    for name in (*HOME_VARIABLES, *NAME_VARIABLES, "MPLBACKEND", "PYTHONSAFEPATH"):
        monkeypatch.setenv(name, "")  # so that it is restored even if it was not set before
        monkeypatch.delenv(name)
    monkeypatch.setattr(pwd, "getpwuid", unknown)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("home", HOMES.values(), ids=HOMES)
def test_a_user_without_a_usable_home_gets_a_folder_for_caches(home, nameless_user, monkeypatch):
    """Only this user can read the folder, and the next call uses the same one."""
    for name, value in home(nameless_user).items():
        if value is not None:
            monkeypatch.setenv(name, value)
    process.set_environment()
    caches = Path(os.environ["XDG_CACHE_HOME"])
    assert caches == nameless_user / f"bearingwear-{os.geteuid()}"
    assert caches.stat().st_mode & 0o777 == 0o700
    assert Path.home().is_dir() and getpass.getuser() == str(os.getuid())
    process.set_environment()
    assert Path(os.environ["XDG_CACHE_HOME"]) == caches


def test_a_folder_for_caches_that_others_can_write_is_not_used(nameless_user):
    """Another folder is made for this user alone."""
    open_folder = nameless_user / f"bearingwear-{os.geteuid()}"
    open_folder.mkdir()
    open_folder.chmod(0o777)
    process.set_environment()
    caches = Path(os.environ["XDG_CACHE_HOME"])
    assert caches.parent == nameless_user and caches.stat().st_mode & 0o777 == 0o700


def test_a_usable_home_is_kept(nameless_user, monkeypatch):
    monkeypatch.setenv("HOME", str(nameless_user))
    monkeypatch.setenv("USER", "me")
    process.set_environment()
    assert not {"XDG_CACHE_HOME", "MPLCONFIGDIR", "LOGNAME"} & {*os.environ}
    assert os.environ["HOME"] == str(nameless_user) and getpass.getuser() == "me"


# all of it at once


def words_that_hide_user_names():
    """Returns words before a command that hide the names of users; empty if not allowed."""
    if os.geteuid() != 0 or shutil.which("unshare") is None:
        return ()
    hide = ("unshare", "-m", "sh", "-c", 'mount --bind /dev/null /etc/passwd && exec "$@"', "sh")
    return hide if subprocess.run([*hide, "true"], capture_output=True).returncode == 0 else ()


@pytest.mark.long  # of single commands and of a job: the tests above
@pytest.mark.parametrize("command", ["bearingwear study", "snakemake"])
def test_a_study_runs_in_a_container_without_a_home(command, folder_with_names_of_libraries):
    """Figures are drawn, and no file of the user is imported."""
    folder = folder_with_names_of_libraries
    (folder / "config" / "scenes").mkdir(parents=True)
    (folder / "config" / "config.yaml").write_text(yaml.safe_dump(ONE_CASE))
    shutil.copy(scene_file("gyro_s1"), folder / "config" / "scenes")
    environment = {"MPLBACKEND": BACKENDS["of a notebook"], "DISPLAY": None}
    if command == "snakemake":  # which itself asks for a home and a name
        prefix, words = (), ["-P", "-m", "snakemake", "--snakefile", ROOT / "Snakefile"]
    else:
        environment |= dict.fromkeys((*HOME_VARIABLES, *NAME_VARIABLES)) | {"HOME": "/proc/nothing"}
        prefix, words = words_that_hide_user_names(), ["-P", "-m", "bearingwear", "study"]
    completed = run_program(folder, *prefix, sys.executable, *words, "-j2", **environment)
    output = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "Traceback" not in output, output
    assert list((folder / "results").rglob("*.svg"))
    assert import_marks(folder) == []
