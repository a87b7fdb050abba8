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

# prints the hash of the sources, and a number of a kernel to all digits
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


def program_output(folder, **options):
    """Returns the words that PROGRAM prints with the package and the compiled code in a folder.

    options: of `subprocess.run`.
    """
    cache = {"NUMBA_CACHE_DIR": str(folder / "jit"), PROJECT.switch: ""}
    completed = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder)} | cache,
        **options,
    )
    return completed.stdout.split()


@pytest.fixture(scope="module")
def compiled_copy(tmp_path_factory):
    """Returns a folder with a copy of the package and compiled code, and the program's output."""
    folder = tmp_path_factory.mktemp("cached")
    copy_tree(folder, *PACKAGES)
    output = program_output(folder)
    assert len(output) == 2
    return folder, output


@pytest.fixture
def changeable_copy(compiled_copy, tmp_path):
    """Returns a copy of the folder of `compiled_copy` that a test may change, and the output."""
    folder, printed = compiled_copy
    return shutil.copytree(folder, tmp_path / "copy"), printed


def test_a_kernel_is_compiled_again_after_an_edit_of_its_callee(changeable_copy):
    """numba itself would not notice it, as the file of the kernel is unchanged.

    Hash and number change, and the new code has a folder of its own beside the old one.
    """
    folder, printed = changeable_copy
    callee = folder / "bearingwear" / "kernels" / "equilibrium" / "kinematics.py"
    text = callee.read_text()
    assert "math.cos(alpha_o) + gamma" in text
    callee.write_text(text.replace("math.cos(alpha_o) + gamma", "math.cos(alpha_o) - gamma"))
    edited_hash, edited_number = program_output(folder)
    assert edited_hash != printed[0]
    assert edited_number != printed[1]
    assert len(list((folder / "jit").glob("numba-*"))) == 2


def test_the_folder_of_compiled_code_depends_on_the_sources_of_kernels_alone(tmp_path, monkeypatch):
    """An edit of another source does not require compiling.

    Two sources stand in for the package; hashes of files are remembered, hence `cache_clear`.
    """
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "jit"))
    monkeypatch.setattr(provenance, "PACKAGE", tmp_path)

    def folder(name, text):
        """Writes a source, and returns the folder of compiled code."""
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
        provenance._file_hash.cache_clear()
        return private_code_folder(PROJECT)

    try:
        original = folder("kernels/a.py", "x = 1\n")
        assert folder("model/b.py", "y = 1\n") == folder("model/b.py", "y = 2\n") == original
        assert folder("kernels/a.py", "x = 2\n") != original
        assert folder("kernels/a.py", "x = 1\n") == original
    finally:
        provenance._file_hash.cache_clear()


@pytest.mark.parametrize(("suffix", "length"), [("nbi", 40), ("nbc", 0)])
def test_damaged_files_of_compiled_code_are_replaced(compiled_copy, suffix, length):
    """The program prints the same, and the files have their sizes again.

    A full disk or a crash of the machine leaves indices (nbi) cut off and code (nbc) empty.
    """
    folder, printed = compiled_copy
    files = list((folder / "jit").rglob(f"*.{suffix}"))
    sizes = [file.stat().st_size for file in files]
    assert files and min(sizes) > length
    for file in files:
        os.truncate(file, length)
    assert program_output(folder) == printed
    assert [file.stat().st_size for file in files] == sizes


def test_a_program_runs_without_space_for_compiled_code(changeable_copy):
    """Files may have 1 byte at most: it prints the same, and leaves only empty files of code."""
    resource = pytest.importorskip("resource")
    folder, printed = changeable_copy
    shutil.rmtree(folder / "jit")

    def no_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1, 1))

    assert program_output(folder, preexec_fn=no_room) == printed
    assert not [file for file in (folder / "jit").rglob("*.nb?") if file.stat().st_size]


def test_compiled_code_in_an_unsafe_folder_is_not_loaded(changeable_copy):
    """An index of numba's cache is a pickle, which runs any code that somebody puts there.

    The index planted here makes a folder. It is loaded only if nobody else may write to the
    compiled code.
    """
    folder, printed = changeable_copy
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
    assert program_output(folder) == printed and not planted.exists()
    jit.chmod(0o700)
    program_output(folder)
    assert planted.exists()  # the planted index does run in a folder that is safe
