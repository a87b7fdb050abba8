"""Programs that import a copy of the packages in which applications come or go."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support import PACKAGES, copy_tree

from bearingwear.kernels.project import PROJECT


@pytest.fixture
def applications_of_a_copy(tmp_path) -> Path:
    """Returns the folder of applications in a copy of the packages, which a test may change."""
    copy_tree(tmp_path, *PACKAGES)
    return tmp_path / "bearingwear" / "applications"


@pytest.fixture
def printed_by(tmp_path) -> Callable[..., str]:
    """Returns a function that runs a Python program on the copy, and returns what it prints.

    Its arguments are the text of the program and the program's arguments.
    """

    def run(program: str, *arguments: object) -> str:
        environment = os.environ | {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
        # the kernels of the copy are the same, so that they need not be compiled again
        environment["NUMBA_CACHE_DIR"] = str(Path(PROJECT.code_folder).parent)
        completed = subprocess.run(
            [sys.executable, "-c", program, *map(str, arguments)],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert completed.returncode == 0, completed.stderr
        return completed.stdout

    return run
