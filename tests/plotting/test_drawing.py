"""Numbers and titles of figures."""

import numpy as np
import pytest
import xarray as xr

from bearingwear.plotting.drawing import lines_of_a_title, power_of_ten


@pytest.mark.parametrize(
    ("values", "exponent"), [([2e-17], -18), ([1.0], 0), ([999.0, 3.0], 0), ([], 0), ([0.0], 0)]
)
def test_the_power_of_an_axis_is_a_multiple_of_three_below_its_largest_value(values, exponent):
    """2e-17 becomes 20e-18; a NaN in one of the arrays does not count."""
    assert power_of_ten([xr.DataArray(np.array(values)), xr.DataArray(np.nan)]) == exponent


@pytest.mark.parametrize("width", range(20, 60))
def test_a_title_keeps_a_number_and_its_unit_together(width):
    """No line of a title, however wide, begins with a unit; its words stay in their order."""
    title = "second bearing: life of the balls and races 0.66 to 1.4 h; 90 %: 0.086 to 8.6 h"
    lines = lines_of_a_title(title, width)
    assert " ".join(" ".join(lines).split()) == title
    assert not any(line.startswith(("%", "h;")) for line in lines)
