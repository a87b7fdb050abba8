"""Two bearings on one sheet: a column for each, and one unit for a quantity."""

import json

import pytest

from bearingwear.document.data import as_csv, as_json
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import side_by_side
from bearingwear.document.show import sheet_of_result
from bearingwear.document.text import as_text
from bearingwear.solvers.solve import solve

IN_GPA = Block("contact", ("inner", "outer"), (Row("pressure", "GPa", (0.862, 1.05), limit=2.0),))
IN_MPA = Block("contact", ("inner", "outer"), (Row("pressure", "MPa", (713.0, 987.0), limit=2e3),))


@pytest.mark.parametrize(
    ("blocks", "values"),
    [
        ([IN_GPA, IN_MPA], (0.862, 1.05, 0.713, 0.987)),
        ([IN_MPA, IN_GPA], (0.713, 0.987, 0.862, 1.05)),
    ],
)
def test_a_quantity_of_two_bearings_is_in_the_larger_of_their_units(blocks, values):
    (merged,) = side_by_side([[block] for block in blocks])
    assert merged.columns == ("1: inner", "1: outer", "2: inner", "2: outer")
    (row,) = merged.rows
    assert row.values == pytest.approx(values)
    assert row.unit == "GPa" and row.limit == pytest.approx(2.0)


def test_every_format_states_limits_that_differ_between_bearings():
    first = Block("bearing", (), (Row("preload", "N", (160.0,), limit=48.0),))
    second = Block("bearing", (), (Row("preload", "N", (100.0,), limit=24.0),))
    (merged,) = side_by_side([[first], [second]])
    assert merged.columns == ("bearing 1", "bearing 2")
    assert merged.rows == (Row("preload", "N", (160.0, 100.0), limits=(48.0, 24.0)),)
    sheet = Document(blocks=(merged,))
    assert as_text(sheet).endswith("160          100  criteria 48, 24")
    (quantity,) = json.loads(as_json(sheet))["quantities"]
    assert quantity["limit"] == {"bearing 1": 48.0, "bearing 2": 24.0}
    assert as_csv(sheet).splitlines()[-2:] == [
        'bearing,preload,preload,"limit, bearing 1",N,48.0',
        'bearing,preload,preload,"limit, bearing 2",N,24.0',
    ]


def test_the_sheet_of_a_spring_pair_has_each_quantity_once(scene):
    """One bearing carries the spring force of 7 N, and the other one the external 2 N as well."""
    changes = {
        "arrangement.kind": "spring_pair",
        "arrangement.orientation": "back_to_back",
        "arrangement.external_axial_N": 2.0,
    }
    blocks = sheet_of_result(solve(scene("gyro_s1", changes))).blocks
    names = [row.name for block in blocks for row in block.rows]
    assert "maximum_pressure" in names and len(names) == len(set(names))
    ((columns, preload),) = [
        (block.columns, row)
        for block in blocks
        for row in block.rows
        if row.name == "residual_preload"
    ]
    assert columns == ("bearing 1", "bearing 2") and preload.values == pytest.approx((9.0, 7.0))
