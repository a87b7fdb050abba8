"""The study's grid and plan: names of cases, and what is refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid.grid import Case, Grid


def test_the_id_of_a_case_has_its_method_friction_and_loss():
    """It has three decimals of the friction and two of the loss [um], or as many as are needed."""
    assert Case("constant_force", 0.0125, 0.005).id == "constant_force-mu0.0125-loss0.005"
    case = Case("fixed_position", 0.08, 0.5)
    assert case.id == "fixed_position-mu0.080-loss0.50"
    assert case.changes == {
        "operation.preload_method": "fixed_position",
        "friction.ball_race": 0.08,
        "wear.ball_diameter_loss_um": 0.5,
    }


@given(
    mus=st.lists(st.integers(0, 2000), min_size=1, max_size=5, unique=True),
    losses=st.lists(st.integers(0, 5000), min_size=1, max_size=5, unique=True),
)
def test_case_ids_are_unique_and_contain_the_values(mus, losses):
    """There are as many ids as combinations of values, and each case has the values of its id.

    Frictions are multiples of 1e-4 up to 0.2, losses of 1e-3 um up to 5 um.
    """
    grid = Grid.from_lists(PRELOAD_METHODS, [k / 1e4 for k in mus], [k / 1e3 for k in losses])
    cases = grid.cases()
    assert len(cases) == 2 * len(mus) * len(losses)
    for case in cases.values():
        method, friction, loss = case.changes.values()
        assert Case(method, float(friction), float(loss)) == case


@pytest.mark.parametrize(
    ("methods", "mus", "losses", "problem"),
    [
        (["constant_force"], [0.1 + 0.2], [0.0], "friction: got 0.30000000000000004"),
        (["constant_force"], [-0.1], [0.0], "friction: got -0.1"),
        (["constant_force"], [float("nan")], [0.0], "friction: got nan"),
        (["constant_force"], [0.1], [1 / 3], "ball_diameter_loss_um: got 0.333"),
        (["constant_force"], [0.1, 0.1], [0.0], "expected each value once"),
        (["constant_force"], [], [0.0], "friction: got no value, expected at least one"),
        (["rigid"], [0.1], [0.0], "preload_method: got rigid"),
    ],
)
def test_grids_that_are_refused(methods, mus, losses, problem):
    """Faults are decimals, values below zero, NaN, given twice or missing, and a wrong method."""
    with pytest.raises(ValueError, match="^[^\n]*$") as error:
        Grid.from_lists(methods, mus, losses)
    assert problem in str(error.value)


def test_chunks_have_whole_lines_and_the_names_of_their_first_and_last_friction():
    """A line has three losses. The argument of `chunks` is the largest number of points in one.

    Chunks of one line or less are not used: the list is empty.
    """
    grid = Grid.from_lists(PRELOAD_METHODS, [0.02, 0.05, 0.08, 0.11], [0.0, 0.1, 0.5])
    assert grid.chunks(None) == grid.chunks(5) == []  # of no size, or of one line
    assert grid.chunks(9)[:2] == [
        "constant_force-mu0.020-to-mu0.080",
        "constant_force-mu0.110-to-mu0.110",
    ]
    assert grid.friction_names_between("0.020", "0.080") == ["0.020", "0.050", "0.080"]
    assert len(grid.chunks(1000)) == 2  # one for each method
