"""Files of lives that were solved with the dynamic model, and how these ended."""

from pathlib import Path

import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import key_in_words
from bearingwear.results.words import in_words
from bearingwear.studies.dataset import loaded


def dynamic_life(path: Path) -> xr.Dataset:
    """A life file of fidelity dynamic. Raises CaseFileError."""
    life = loaded(path)
    if life.attrs.get("fidelity") != "dynamic" or "end_criterion" not in life:
        raise CaseFileError(f"{path}: not a dynamic life")
    return life


def ended_by(life: xr.Dataset) -> str:
    """Criterion that ended a life, in words; otherwise the status."""
    status = int(life["status"])
    return criterion(life, "end_criterion") if status == OK else in_words(STATUS_NAMES[status])


def criterion(life: xr.Dataset, name: str) -> str:
    """A criterion of a life in words, without its unit."""
    met = life[name].attrs["flag_meanings"].split()[int(life[name])]
    return key_in_words(met)[0]
