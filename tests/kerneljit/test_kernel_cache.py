"""Compiled code never outlives its sources, and results name the sources they came from."""

import os
import pickle
import shutil
import subprocess
import sys

import pytest
from support import PACKAGES, copy_tree

from bearingwear import provenance
from bearingwear.kernels.project import PROJECT
from kerneljit.project import private_code_folder

PROGRAM = """
import math
from bearingwear.kernels.equilibrium.body_forces import body_forces
from bearingwear.kernels.params import BallLoad, Geometry
from bearingwear.provenance import source_hash
g = Geometry(9, 2e-3, 7.5e-3, 0.3, 2.5e-4, 3.5e-3, 3.6e-3, 1.1e-3, 1.2e-3, 1e11, 7800.0)
load = BallLoad(1, 0.0, 3000.0, 0.0, 0.0, 0.0, 0.0, 0.0)
forces = body_forces(g, 2e-3, load, 0.0, 0.3, 0.9, 0.2, 0.95)
print(source_hash(), repr(forces[1]))
"""


def run(folder, **options):
    """What the program prints with the package and the compiled code in a folder."""
    jit = {"NUMBA_CACHE_DIR": str(folder / "jit"), PROJECT.switch: ""}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder)} | jit,
        **options,
    )
    return done.stdout.split()


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """A copy of the package with compiled code, and what its program prints."""
    folder = tmp_path_factory.mktemp("cached")
    copy_tree(folder, *PACKAGES)
    output = run(folder)
    assert len(output) == 2
    return folder, output


@pytest.fixture
def cached(first, tmp_path):
    """The same, to be changed."""
    folder, printed = first
    return shutil.copytree(folder, tmp_path / "copy"), printed


def test_edited_callee_gives_new_numbers(cached):
    """numba itself would not notice: the caller's file is unchanged."""
    folder, first = cached
    callee = folder / "bearingwear" / "kernels" / "equilibrium" / "kinematics.py"
    text = callee.read_text()
    assert "math.cos(alpha_o) + gamma" in text
    callee.write_text(text.replace("math.cos(alpha_o) + gamma", "math.cos(alpha_o) - gamma"))
    second = run(folder)
    assert len(second) == 2
    assert second[0] != first[0]
    assert second[1] != first[1]
    assert len(list((folder / "jit").glob("numba-*"))) == 2


def test_the_folder_of_compiled_code_is_named_by_the_kernels_alone(tmp_path, monkeypatch):
    """Another model need not compile anything anew."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "jit"))
    monkeypatch.setattr(provenance, "PACKAGE", tmp_path)

    def folder(name, text):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
        provenance._file_hash.cache_clear()
        return private_code_folder(PROJECT)

    try:
        first = folder("kernels/a.py", "x = 1\n")
        assert folder("model/b.py", "y = 1\n") == folder("model/b.py", "y = 2\n") == first
        assert folder("kernels/a.py", "x = 2\n") != first
        assert folder("kernels/a.py", "x = 1\n") == first
    finally:
        provenance._file_hash.cache_clear()


@pytest.mark.parametrize(("suffix", "length"), [("nbi", 40), ("nbc", 0)])
def test_a_damaged_cache_is_compiled_again(first, suffix, length):
    """A full disk or a crash of the machine leaves such files."""
    folder, printed = first
    files = list((folder / "jit").rglob(f"*.{suffix}"))
    sizes = [file.stat().st_size for file in files]
    assert files and min(sizes) > length
    for file in files:
        os.truncate(file, length)
    assert run(folder) == printed
    assert [file.stat().st_size for file in files] == sizes


def test_cache_that_cannot_be_written(cached):
    """Compiled code also runs where there is no room to keep it."""
    resource = pytest.importorskip("resource")
    folder, printed = cached
    shutil.rmtree(folder / "jit")

    def no_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1, 1))

    assert run(folder, preexec_fn=no_room) == printed
    assert not [file for file in (folder / "jit").rglob("*.nb?") if file.stat().st_size]


def test_planted_code_is_not_run(cached):
    """An index of numba's cache is a pickle, which runs whatever it says."""
    folder, printed = cached
    planted = folder / "planted"

    class Planted:
        def __reduce__(self):
            return os.mkdir, (str(planted),)

    (jit,) = (folder / "jit").iterdir()
    indices = list(jit.rglob("*body_forces*.nbi"))
    assert indices
    for index in indices:
        index.write_bytes(pickle.dumps(Planted()))
    jit.chmod(0o777)
    assert run(folder) == printed and not planted.exists()
    jit.chmod(0o700)
    run(folder)
    assert planted.exists()  # it would have run
