import numpy as np
import pytest
import xarray as xr

from bearingwear.plotting.drawing import power_of_ten


@pytest.mark.parametrize(
    ("values", "exponent"), [([2e-17], -18), ([1.0], 0), ([999.0, 3.0], 0), ([], 0), ([0.0], 0)]
)
def test_power_of_ten(values, exponent):
    assert power_of_ten([xr.DataArray(np.array(values)), xr.DataArray(np.nan)]) == exponent
