"""The table of docs/accuracy.md: gyro_s1 as a machine, spring against rigid pair."""

import re

import pytest
from support import ROOT, benchmark

from bearingwear.studies.design.map import life_point

CELL = r"([\d.]+) N, ([\d.]+) h"
ROW = rf"\| (\d) N/µm \| \+(\d+) K \| {CELL} \| {CELL} \| (\w+) pair, ([\d.]+) times \|"
TABLE = re.findall(ROW, (ROOT / "docs/accuracy.md").read_text(encoding="utf-8"))


def test_the_table_is_whole():
    assert [row[:2] for row in TABLE] == [(s, k) for s in "356" for k in ("0", "10")]


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"{row[0]}-{row[1]}")
def test_lives_at_equal_stiffness(row):
    """Each preload has the lesser stiffness and the life of its row; 3 % less preload has not."""
    pairs = benchmark("pairs")
    stiffness, kelvin = 1e6 * float(row[0]), float(row[1])
    lives = []
    for k, (name, (method, kind)) in enumerate(pairs.KINDS.items()):
        scene = pairs.scene_of(method, kind, kelvin)
        preload, hours = map(float, row[2 + 2 * k : 4 + 2 * k])
        result, less = (
            life_point(scene.with_({"operation.preload_N": share * preload}), None)
            for share in (1.0, 0.97)
        )
        assert pairs.LEAST.worst(result) == pytest.approx(stiffness, rel=5e-3), name
        assert pairs.LEAST.worst(less) < 0.995 * stiffness
        lives.append(result["life"] / 3600.0)
        assert lives[-1] == pytest.approx(hours, rel=1e-2)
    assert row[6] == ("spring" if lives[0] > lives[1] else "rigid")
    assert max(lives) / min(lives) == pytest.approx(float(row[7]), rel=0.02)
