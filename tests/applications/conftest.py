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
    """The folder of applications of a copy, to be changed."""
    copy_tree(tmp_path, *PACKAGES)
    return tmp_path / "bearingwear" / "applications"


@pytest.fixture
def printed_by(tmp_path) -> Callable[..., str]:
    """Function (program, *arguments): what a program prints that imports the copy."""

    def run(program: str, *arguments: object) -> str:
        environment = os.environ | {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
        # of the same kernels
        environment["NUMBA_CACHE_DIR"] = str(Path(PROJECT.code_folder).parent)
        done = subprocess.run(
            [sys.executable, "-c", program, *map(str, arguments)],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
