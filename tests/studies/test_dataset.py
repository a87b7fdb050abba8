"""Datasets of studies from a table, axes and rows."""

import json

import numpy as np
import pytest

from bearingwear.results.variable import Variable, table
from bearingwear.studies.dataset import dataset_of_rows, write_dataset

# Variables by name, dimensions, unit, meaning; values are multiplied by `scale` in a dataset.
POINT = Variable("point", ("point",), "um", "place", scale=1e6)
RACE = Variable("race", ("race",), "", "race", "i1", flags=("inner", "outer"))
SHEAR = Variable("shear", ("race",), "h", "time", scale=0.5, comment="a comment")
SIDE = Variable("side", (), "", "a side", "i1", flags=("left", "right"))
SIDES = table(SIDE, SHEAR)
PLACES = [1e-6, 2e-6, 3e-6]


def test_rows_along_axes_are_scaled_and_have_the_attributes_of_their_table():
    """Three rows lie along the axis `point`; `race`, without values, has the codes of its flags."""
    rows = [
        {"side": 0, "shear": [1.0, 2.0]},
        {"side": 1, "shear": [np.nan, 4.0]},
        {"shear": [5.0, 6.0], "side": 1},
    ]
    dataset = dataset_of_rows(SIDES, {POINT: PLACES, RACE: None}, rows, title="sides")
    assert list(dataset.variables) == ["side", "shear", "point", "race"]
    assert dataset["shear"].dims == ("point", "race") and dataset["side"].dims == ("point",)
    # in h and um, by the scales of their variables
    np.testing.assert_array_equal(dataset["shear"], [[0.5, 1.0], [np.nan, 2.0], [2.5, 3.0]])
    np.testing.assert_allclose(dataset["point"], [1.0, 2.0, 3.0])
    assert dataset["side"].dtype == np.int8 and dataset["shear"].dtype == np.float64
    assert dataset["shear"].attrs == {"long_name": "time", "units": "h", "comment": "a comment"}
    assert list(dataset["side"].attrs["flag_values"]) == [0, 1]
    assert dataset["side"].attrs["flag_values"].dtype == np.int8
    assert dataset.attrs["title"] == "sides" and dataset.attrs["source"].startswith("bearingwear")


def test_values_that_a_row_omits_are_nan():
    """Flags then become floats. An axis that is only a length has no coordinate."""
    dataset = dataset_of_rows(SIDES, {"row": 2, "race": 2}, [{"side": 1}, {}])
    assert np.isnan(dataset["shear"].values).all() and dataset["shear"].shape == (2, 2)
    np.testing.assert_array_equal(dataset["side"], [1.0, np.nan])
    assert "row" not in dataset.coords


def test_writing_leaves_the_callers_encoding(tmp_path):
    """The dataset in memory keeps its encoding, though the file may have another one."""
    dataset = dataset_of_rows(SIDES, {"row": 2, "race": 2}, [{"side": 1}, {}])
    dataset["shear"].encoding["dtype"] = np.dtype("f4")
    write_dataset(dataset, tmp_path / "sides.nc")
    assert dataset["shear"].encoding == {"dtype": np.dtype("f4")}


def test_rows_over_two_axes_are_in_c_order():
    """The last axis varies fastest: row 3 k + n stands at (k, n). Shear has the scale 0.5."""
    rows = [{"side": k % 2, "shear": [k, 10.0 * k]} for k in range(6)]
    dataset = dataset_of_rows(SIDES, {"line": 2, POINT: PLACES}, rows)
    assert dataset["shear"].dims == ("line", "point", "race")
    np.testing.assert_array_equal(dataset["shear"][1, :, 0], [1.5, 2.0, 2.5])


def test_names_shapes_and_numbers_of_rows_are_checked():
    """Refused are an unknown name, two shapes of one variable, and one row for an axis of two."""
    with pytest.raises(KeyError, match="top"):
        dataset_of_rows(SIDES, {"race": 2}, [{"top": 1}])
    with pytest.raises(ValueError, match="shear"):
        dataset_of_rows(SIDES, {"row": 2}, [{"shear": [1.0, 2.0]}, {"shear": 1.0}])
    with pytest.raises(ValueError, match="1 rows"):
        dataset_of_rows(SIDES, {"row": 2, "race": 2}, [{}])


def test_a_scene_is_an_attribute_in_json(scene):
    """A dataset without variables may have it, too."""
    s1 = scene("gyro_s1")
    dataset = dataset_of_rows({}, {}, [{}], scene=s1)
    assert json.loads(dataset.attrs["scene"]) == s1.to_dict()
