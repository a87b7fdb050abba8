"""Two bearings on one sheet: a column for each, and one unit for a quantity."""

import json

import pytest
from support import scene_file

from bearingwear.document.data import as_csv, as_json
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import side_by_side
from bearingwear.document.show import sheet_of_result
from bearingwear.document.text import as_text
from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve

FIRST = Block("contact", ("inner", "outer"), (Row("pressure", "GPa", (0.862, 1.05), limit=2.0),))
SECOND = Block("contact", ("inner", "outer"), (Row("pressure", "MPa", (713.0, 987.0), limit=2e3),))


def test_the_larger_unit_is_that_of_both():
    for order, sign in (((FIRST, SECOND), 1), ((SECOND, FIRST), -1)):
        (both,) = side_by_side([[item] for item in order])
        assert both.columns == ("1: inner", "1: outer", "2: inner", "2: outer")
        (row,) = both.rows
        values = [0.862, 1.05, 0.713, 0.987]
        assert row.values == pytest.approx(values if sign > 0 else values[2:] + values[:2])
        assert row.unit == "GPa" and row.limit == pytest.approx(2.0)


def test_limits_that_differ_stand_beside_the_row():
    other = Block("bearing", (), (Row("preload", "N", (100.0,), limit=24.0),))
    first = Block("bearing", (), (Row("preload", "N", (160.0,), limit=48.0),))
    (both,) = side_by_side([[first], [other]])
    assert both.columns == ("bearing 1", "bearing 2")
    assert both.rows == (Row("preload", "N", (160.0, 100.0), limits=(48.0, 24.0)),)
    sheet = Document(blocks=(both,))
    assert as_text(sheet).endswith("160          100  criteria 48, 24")
    (quantity,) = json.loads(as_json(sheet))["quantities"]
    assert quantity["limit"] == {"bearing 1": 48.0, "bearing 2": 24.0}
    assert as_csv(sheet).splitlines()[-2:] == [
        'bearing,preload,preload,"limit, bearing 1",N,48.0',
        'bearing,preload,preload,"limit, bearing 2",N,24.0',
    ]


def test_a_spring_pair_has_each_quantity_once():
    plain = {
        "arrangement.kind": "spring_pair",
        "arrangement.orientation": "back_to_back",
        "arrangement.external_axial_N": 2.0,
    }
    scene = load_scene(scene_file("gyro_s1"), [f"{key}={value}" for key, value in plain.items()])
    blocks = sheet_of_result(solve(scene)).blocks
    names = [row.name for block in blocks for row in block.rows]
    assert "maximum_pressure" in names and len(names) == len(set(names))
    (block,) = (b for b in blocks if "residual_preload" in [row.name for row in b.rows])
    (preload,) = (row for row in block.rows if row.name == "residual_preload")
    assert block.columns == ("bearing 1", "bearing 2") and preload.values == pytest.approx((9, 7))
