"""A user's program: `mypy` checks that its types are known, and that its two errors are found."""

from typing import assert_type

import xarray as xr

import bearingwear

case = bearingwear.solve(bearingwear.example().with_({"operation.preload_N": 9.0}))
assert_type(case, xr.Dataset)
bearingwear.solve(7)  # type: ignore[arg-type]
bearingwear.sweep("a.yaml", "operation")  # type: ignore[arg-type]
