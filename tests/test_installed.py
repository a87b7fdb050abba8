"""The package as it is installed: what comes with it."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import pytest
from support import PACKAGES, ROOT, copy_tree

SHIPPED = (
    *PACKAGES,
    "workflow",
    "config",
    "profiles",
    "Snakefile",
    "README.md",
    "pyproject.toml",
)


@pytest.fixture(scope="module")
def installed_python(tmp_path_factory):
    """Returns Python of an environment in which the package is installed, without an index."""
    pytest.importorskip("setuptools")
    folder = tmp_path_factory.mktemp("installed")
    source, environment = folder / "source", folder / "venv"
    source.mkdir()
    for name in SHIPPED:
        if (ROOT / name).is_dir():
            copy_tree(source, name)
        else:
            shutil.copy(ROOT / name, source / name)
    venv.create(environment, symlinks=True)
    setup = [sys.executable, "-c", "import setuptools; setuptools.setup()"]
    install = ["install", "--single-version-externally-managed", "--record", str(folder / "files")]
    completed = subprocess.run(
        [*setup, *install, "--prefix", str(environment)],
        cwd=source,
        env=os.environ | {"PYTHONPATH": ""},
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr
    (site,) = environment.glob("lib/python*/site-packages")
    (site / "libraries.pth").write_text(sysconfig.get_paths()["purelib"])
    return environment / "bin" / "python"


def run(command, folder):
    """Runs a command in a folder, without the paths of modules of this process."""
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "MYPYPATH")}
    return subprocess.run(
        [str(part) for part in command], cwd=folder, env=environment, capture_output=True, text=True
    )


def test_an_installed_package_has_its_example_catalogue_and_types(installed_python, tmp_path):
    script = "import bearingwear as b; scene = b.new(designation='7010C', maker='NSK'); "
    script += "print(b.__file__, b.example().name, scene.bearing.ball_count)"
    completed = run([installed_python, "-c", script], tmp_path)
    assert completed.returncode == 0, completed.stderr
    file, example_name, ball_count = completed.stdout.split()
    assert Path(file).is_relative_to(installed_python.parents[1])
    assert (example_name, ball_count) == ("gyro_s1", "19")
    assert Path(file).with_name("py.typed").exists()  # types: tests/user_types.py
