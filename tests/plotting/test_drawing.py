import numpy as np
import pytest
import xarray as xr

from bearingwear.plotting.drawing import lines_of_a_title, power_of_ten


@pytest.mark.parametrize(
    ("values", "exponent"), [([2e-17], -18), ([1.0], 0), ([999.0, 3.0], 0), ([], 0), ([0.0], 0)]
)
def test_power_of_ten(values, exponent):
    assert power_of_ten([xr.DataArray(np.array(values)), xr.DataArray(np.nan)]) == exponent


def test_a_title_keeps_a_number_and_its_unit_together():
    title = "second bearing: life of the balls and races 0.66 to 1.4 h; 90 %: 0.086 to 8.6 h"
    broken = [lines_of_a_title(title, width) for width in range(20, 60)]
    assert all(" ".join(" ".join(lines).split()) == title for lines in broken)
    assert not any(line.startswith(("%", "h;")) for lines in broken for line in lines)
