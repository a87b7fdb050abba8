"""Which files a result may replace."""

from __future__ import annotations

from pathlib import Path

from bearingwear.atomic import OutputError


def check_output(path: Path, scene: str) -> None:
    """Refuse, before anything is solved, an output that must not be replaced."""
    try:
        check_folder(path)
        if path.exists():
            if not path.is_file():
                raise OutputError(f"{path}: got a folder or a device, expected a file name")
            if path.samefile(scene):
                raise OutputError(f"{path}: got the scene itself, expected another file name")
            _check_replaced(path)
    except OutputError:
        raise
    except OSError as error:  # a name that is too long
        raise OutputError(f"{path}: cannot be written ({error.strerror})") from None


def check_folder(path: Path) -> None:
    """Refuse more than one new folder: it is likelier a slip of the pen."""
    if not path.parent.parent.exists():
        raise OutputError(f"{path}: got more than one new folder, expected at most one")


def _check_replaced(path: Path) -> None:
    """Refuse to write a result over anything else, above all over a scene."""
    from bearingwear.results.netcdf import SIGNATURE

    with path.open("rb") as file:
        start = file.read(len(SIGNATURE))
    if start and start != SIGNATURE:
        raise OutputError(f"{path}: got a file that is not a result, expected another file name")
