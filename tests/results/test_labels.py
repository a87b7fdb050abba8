"""Names in memory, codes in files."""

import numpy as np
import pytest
import xarray as xr

from bearingwear.results.labels import coded, labelled


@pytest.fixture
def of_files():
    flags = {"flag_values": np.arange(2, dtype="i1"), "flag_meanings": "inner outer"}
    race = xr.Variable("race", np.array([1, 0], dtype="i1"), {"long_name": "race", **flags})
    ball = xr.Variable("ball", np.arange(3, dtype="i4"), {"units": "1"})
    held = xr.Variable("ball", np.array([0, 1, 1], dtype="i1"), flags)
    load = xr.Variable(("ball", "race"), np.arange(6.0).reshape(3, 2), {"units": "N"})
    return xr.Dataset({"load": load, "held": held}, {"race": race, "ball": ball}, {"title": "a"})


def test_coordinates_are_names(of_files):
    labelled_dataset = labelled(of_files)
    assert labelled_dataset["race"].values.tolist() == ["outer", "inner"]
    assert labelled_dataset["load"].sel(race="inner").values.tolist() == [1.0, 3.0, 5.0]
    assert labelled_dataset["held"].values.tolist() == ["inner", "outer", "outer"]
    assert labelled_dataset["race"].attrs == {"long_name": "race", "flag_meanings": "inner outer"}


def test_there_and_back(of_files):
    for data in (of_files, of_files.isel(race=1), of_files.isel(race=[1, 0])):
        back = coded(labelled(data))
        xr.testing.assert_identical(back, data)
        assert back["race"].dtype == back["held"].dtype == np.int8
    xr.testing.assert_identical(labelled(labelled(of_files)), labelled(of_files))


def test_the_code_minus_one_is_called_none(of_files):
    """Of a recommendation without a preload within the limits: there was none to solve."""
    of_files["held"][1] = -1
    labelled_dataset = labelled(of_files)
    assert labelled_dataset["held"].values.tolist() == ["inner", "none", "outer"]
    xr.testing.assert_identical(coded(labelled_dataset), of_files)


def test_attributes_of_memory_alone_are_not_written(of_files):
    labelled_dataset = labelled(of_files).assign_attrs(
        wall_time_s=1.0, message="solved and verified"
    )
    assert coded(labelled_dataset).attrs == {"title": "a"} and "message" in labelled_dataset.attrs
