"""Points of the study of accuracy by what they are called."""

import numpy as np
import xarray as xr


def points_where(trade: xr.Dataset, **texts: str) -> xr.Dataset:
    """The points whose texts (scene, sweep, against, ...) are the ones given."""
    mask = np.ones(trade.sizes["point"], dtype=bool)
    for name, text in texts.items():
        mask &= trade[name].values == text
    return trade.isel(point=mask)


def names(trade: xr.Dataset, variable: str) -> list[str]:
    """Values of a text variable in the order of the file."""
    return list(dict.fromkeys(trade[variable].values))
