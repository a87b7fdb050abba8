"""Numbers of catalogues and of a commercial program; `benchmarks/catalogues.py` finds ours."""

import pytest
from support import benchmark


@pytest.fixture(scope="module")
def rows():
    return benchmark("catalogues").rows()


@pytest.mark.parametrize(
    ("source", "what", "count"),
    [
        ("GMN", "S 6208 C", 3),
        ("ISO 16281", "radial", 1),
        ("ISO 16281", "axial", 1),
        ("ISO 16281", "moment", 2),
        ("SNFA", "lift-off", 3),
        ("SNFA", "axial deflection", 10),
        ("SKF", "218", 3),
        ("kinematics", "", 2),
    ],
)
def test_row(rows, source, what, count):
    found = [row for row in rows if row.source == source and row.what.startswith(what)]
    assert len(found) == count
    for row in found:
        assert abs(row.difference) <= row.tolerance, row


def test_no_row_without_a_test(rows):
    assert len(rows) == 25
