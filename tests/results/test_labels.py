"""Flags and labels of axes are names in memory and codes in files."""

import numpy as np
import pytest
import xarray as xr

from bearingwear.results.labels import coded, labelled


@pytest.fixture
def codes():
    """Returns a dataset as a file has it, with the codes of races, 0 for inner and 1 for outer."""
    flags = {"flag_values": np.arange(2, dtype="i1"), "flag_meanings": "inner outer"}
    race = xr.Variable("race", np.array([1, 0], dtype="i1"), {"long_name": "race", **flags})
    ball = xr.Variable("ball", np.arange(3, dtype="i4"), {"units": "1"})
    controlling = xr.Variable("ball", np.array([0, 1, 1], dtype="i1"), flags)
    load = xr.Variable(("ball", "race"), np.arange(6.0).reshape(3, 2), {"units": "N"})
    return xr.Dataset(
        {"load": load, "controlling": controlling}, {"race": race, "ball": ball}, {"title": "a"}
    )


def test_codes_become_names(codes):
    labelled_dataset = labelled(codes)
    assert labelled_dataset["race"].values.tolist() == ["outer", "inner"]
    assert labelled_dataset["load"].sel(race="inner").values.tolist() == [1.0, 3.0, 5.0]
    assert labelled_dataset["controlling"].values.tolist() == ["inner", "outer", "outer"]
    assert labelled_dataset["race"].attrs == {"long_name": "race", "flag_meanings": "inner outer"}


@pytest.mark.parametrize("races", [slice(None), 1, [1, 0]], ids=["all", "one", "reversed"])
def test_names_become_the_same_codes_again(codes, races):
    dataset = codes.isel(race=races)
    again = coded(labelled(dataset))
    xr.testing.assert_identical(again, dataset)
    assert again["race"].dtype == again["controlling"].dtype == np.int8


def test_names_stay_names(codes):
    xr.testing.assert_identical(labelled(labelled(codes)), labelled(codes))


def test_the_code_minus_one_is_called_none(codes):
    """A recommendation has this code where no preload satisfies the limits, or none was solved."""
    codes["controlling"][1] = -1
    labelled_dataset = labelled(codes)
    assert labelled_dataset["controlling"].values.tolist() == ["inner", "none", "outer"]
    xr.testing.assert_identical(coded(labelled_dataset), codes)


def test_attributes_of_memory_alone_are_not_written(codes):
    labelled_dataset = labelled(codes).assign_attrs(wall_time_s=1.0, message="solved and verified")
    assert coded(labelled_dataset).attrs == {"title": "a"} and "message" in labelled_dataset.attrs
