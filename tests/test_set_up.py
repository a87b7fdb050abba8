"""A clone set up in whichever order a user types the commands of README and of make."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support import ROOT

pytestmark = pytest.mark.long

NOT_CLONED = (".*", "__pycache__", "results", "logs", "build", "*.egg-info")
WHERE = (
    "import bearingwear, json; print(json.dumps([bearingwear.__file__, bearingwear.__version__]))"
)


def tracked_files() -> list[str]:
    """Returns the files that a clone would have, with uncommitted ones; empty without git."""
    if shutil.which("git") is None:
        return []
    listing = ["git", "ls-files", "-co", "--exclude-standard"]
    completed = subprocess.run(listing, cwd=ROOT, capture_output=True, text=True)
    return [name for name in completed.stdout.split("\n") if name]


class Clone:
    """A copy of the project with an environment of its own, which uses our installed libraries."""

    def __init__(self, folder: Path) -> None:
        """Makes the copy and the environment in a folder."""
        self.root, self.caches = folder / "clone", folder / "caches"
        self.root.mkdir()
        names = tracked_files()
        for name in names:
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.root / name)
        if not names:
            ignore = shutil.ignore_patterns(*NOT_CLONED)
            shutil.copytree(ROOT, self.root, ignore=ignore, dirs_exist_ok=True)
        self.python = self.root / ".venv" / "bin" / "python"
        # our libraries have no commands in this environment
        self.snakemake = [self.python, "-P", "-m", "snakemake", "-n", "--quiet", "all"]
        self.elsewhere = folder / "elsewhere"
        self.elsewhere.mkdir()
        self.run(sys.executable, "-m", "venv", ".venv")
        (self.site,) = self.root.glob(".venv/lib/python*/site-packages")
        library_folders = (path for path in sys.path if path.endswith("-packages"))
        (self.site / "libraries.pth").write_text("\n".join(library_folders))

    def run(self, *command, status: int = 0, folder: Path | None = None) -> str:
        """Runs a command in the environment, and returns its output; fails for another status."""
        variables = {
            key: value
            for key, value in os.environ.items()
            if key not in ("PYTHONPATH", "NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE", "MAKEFLAGS")
        }
        variables |= {"XDG_CACHE_HOME": str(self.caches), "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
        variables |= {"PATH": f"{self.root / '.venv/bin'}:{os.environ['PATH']}"}
        completed = subprocess.run(
            [str(part) for part in command],
            cwd=folder or self.root,
            env=variables,
            capture_output=True,
            text=True,
        )
        output = completed.stdout + completed.stderr
        assert completed.returncode == status, output
        return output

    def install(self) -> None:
        """Installs the package as a copy, not linked to its sources."""
        self.run(self.python, "-m", "pip", "install", "-c", "constraints.txt", ".")

    def make_sets_up(self, target: str) -> bool:
        """Returns whether make would set up the environment before it makes a target."""
        return "pip install" in self.run("make", "-n", target)

    def imported_package(self) -> Path:
        """Returns the folder of the package that Python and the command use in another folder."""
        output = self.run(self.python, "-c", WHERE, folder=self.elsewhere)
        file, version = json.loads(output)
        assert version
        script = (self.root / ".venv/bin/bearingwear").read_text()
        assert "from bearingwear.__main__ import" in script
        return Path(file).parent

    def solve(self) -> None:
        """Solves a scene by the command in another folder."""
        scene = self.root / "config/scenes/gyro_s1.yaml"
        output = self.run("bearingwear", "solve", scene, folder=self.elsewhere)
        assert "maximum pressure" in output


@pytest.fixture
def clone(tmp_path):
    """Returns a new clone."""
    if shutil.which("make") is None:
        pytest.skip("needs make")
    return Clone(tmp_path)


def compiled_files(folder):
    """Returns the files of compiled code in a folder."""
    return list(folder.rglob("*.nbc"))


def test_make_replaces_an_installed_copy_by_the_sources_of_the_clone(clone):
    """A user installs and solves before make, as READMEs of earlier versions told.

    Those versions left a folder of compiled code behind when they were removed.
    """
    copy, sources = clone.site / "bearingwear", clone.root / "bearingwear"
    clone.install()
    assert clone.imported_package() == copy
    clone.solve()
    assert compiled_files(clone.caches) and not compiled_files(clone.site)
    clone.run(*clone.snakemake)  # the installed sources are equal to those of the clone
    assert clone.make_sets_up("test") and clone.make_sets_up("study")
    (copy / "__pycache__" / "numba-0123456789abcdef").mkdir(parents=True)
    (copy / "__pycache__" / "numba-0123456789abcdef" / "kernel.nbc").touch()
    clone.run("make", "venv")
    assert not copy.exists() and clone.imported_package() == sources
    clone.solve()
    assert not clone.make_sets_up("test") and not clone.make_sets_up("study")


def test_a_study_refuses_an_installed_copy_that_differs_from_the_sources(clone):
    """The study runs after make has replaced the copy."""
    copy, sources = clone.site / "bearingwear", clone.root / "bearingwear"
    clone.install()
    with (sources / "measures.py").open("a") as file:
        file.write("# edited\n")
    output = clone.run(*clone.snakemake, status=2)
    *_, last = output.splitlines()  # Snakemake names the profile before
    assert last.startswith(f"{copy}: got an installed copy that differs") and "Trace" not in output
    assert clone.make_sets_up("test")
    clone.run("make", "venv")
    assert not copy.exists() and clone.imported_package() == sources
    clone.run(*clone.snakemake)


def test_make_removes_an_empty_folder_of_a_removed_copy(clone):
    """Python would import it as a package without content."""
    copy = clone.site / "bearingwear"
    clone.run("make", "venv")
    (copy / "__pycache__").mkdir(parents=True)
    assert clone.make_sets_up("study")
    clone.run("make", "venv")
    assert clone.imported_package() == clone.root / "bearingwear"


def test_make_sets_up_the_environment_once(clone):
    assert clone.make_sets_up("test")
    clone.run("make", "venv")
    assert clone.imported_package() == clone.root / "bearingwear"
    assert not clone.make_sets_up("test") and not clone.make_sets_up("study")
