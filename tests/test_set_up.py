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
    """Files that git would put into a clone, with uncommitted ones; none where git cannot tell."""
    if shutil.which("git") is None:
        return []
    listing = ["git", "ls-files", "-co", "--exclude-standard"]
    done = subprocess.run(listing, cwd=ROOT, capture_output=True, text=True)
    return [name for name in done.stdout.split("\n") if name]


class Clone:
    """A copy of the project with an environment of its own, which lends the libraries of ours."""

    def __init__(self, folder: Path) -> None:
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
        # the lent libraries bring no commands
        self.snakemake = [self.python, "-P", "-m", "snakemake", "-n", "--quiet", "all"]
        self.elsewhere = folder / "elsewhere"
        self.elsewhere.mkdir()
        self.run(sys.executable, "-m", "venv", ".venv")
        (self.site,) = self.root.glob(".venv/lib/python*/site-packages")
        ours = (path for path in sys.path if path.endswith("-packages"))
        (self.site / "libraries.pth").write_text("\n".join(ours))

    def run(self, *command, status: int = 0, folder: Path | None = None) -> str:
        """What a command says with the environment activated."""
        kept = {
            key: value
            for key, value in os.environ.items()
            if key not in ("PYTHONPATH", "NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE", "MAKEFLAGS")
        }
        kept |= {"XDG_CACHE_HOME": str(self.caches), "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
        kept |= {"PATH": f"{self.root / '.venv/bin'}:{os.environ['PATH']}"}
        done = subprocess.run(
            [str(part) for part in command],
            cwd=folder or self.root,
            env=kept,
            capture_output=True,
            text=True,
        )
        output = done.stdout + done.stderr
        assert done.returncode == status, output
        return output

    def install(self) -> None:
        self.run(self.python, "-m", "pip", "install", "-c", "constraints.txt", ".")

    def make_sets_up(self, target: str) -> bool:
        """Whether make would set up the environment before it runs what it is asked for."""
        return "pip install" in self.run("make", "-n", target)

    def imported(self) -> Path:
        """Folder of the package that Python imports, and the command runs, anywhere else."""
        output = self.run(self.python, "-c", WHERE, folder=self.elsewhere)
        file, version = json.loads(output)
        assert version
        script = (self.root / ".venv/bin/bearingwear").read_text()
        assert "from bearingwear.__main__ import" in script
        return Path(file).parent

    def solve(self) -> None:
        scene = self.root / "config/scenes/gyro_s1.yaml"
        output = self.run("bearingwear", "solve", scene, folder=self.elsewhere)
        assert "maximum pressure" in output


@pytest.fixture
def clone(tmp_path):
    if shutil.which("make") is None:
        pytest.skip("needs make")
    return Clone(tmp_path)


def compiled(folder):
    return list(folder.rglob("*.nbc"))


def test_every_order_of_commands_ends_with_the_sources_of_the_clone(clone):
    copy, sources = clone.site / "bearingwear", clone.root / "bearingwear"

    # README's of earlier versions: install, solve, then make
    clone.install()
    assert clone.imported() == copy
    clone.solve()
    assert compiled(clone.caches) and not compiled(clone.site)
    clone.run(*clone.snakemake)  # the installed sources are those here
    assert clone.make_sets_up("test") and clone.make_sets_up("study")
    # what those versions left behind when they were removed
    (copy / "__pycache__" / "numba-0123456789abcdef").mkdir(parents=True)
    (copy / "__pycache__" / "numba-0123456789abcdef" / "kernel.nbc").touch()
    clone.run("make", "venv")
    assert not copy.exists() and clone.imported() == sources
    clone.solve()
    assert not clone.make_sets_up("test") and not clone.make_sets_up("study")

    # an installed copy once more, and an edited source: nothing runs the one for the other
    clone.install()
    assert clone.imported() == copy
    with (sources / "measures.py").open("a") as file:
        file.write("# edited\n")
    output = clone.run(*clone.snakemake, status=2)
    *_, last = output.splitlines()  # Snakemake names the profile before
    assert last.startswith(f"{copy}: got an installed copy that differs") and "Trace" not in output
    assert clone.make_sets_up("test")
    clone.run("make", "venv")
    assert not copy.exists() and clone.imported() == sources
    clone.run(*clone.snakemake)

    # a dead folder alone
    (copy / "__pycache__").mkdir(parents=True)
    assert clone.make_sets_up("study")
    clone.run("make", "venv")
    assert clone.imported() == sources


def test_make_alone_sets_up(clone):
    assert clone.make_sets_up("test")
    clone.run("make", "venv")
    assert clone.imported() == clone.root / "bearingwear"
    assert not clone.make_sets_up("test") and not clone.make_sets_up("study")
