"""The loop of all lives: how a life ends where a solve fails between two that do not."""

from types import SimpleNamespace

import numpy as np
import pytest

from bearingwear.kernels import status as code
from bearingwear.lives.ends import NO_CRITERION
from bearingwear.lives.follow import LifeStep, Method, Node, follow

END = 0.9


class StepsAlongALine(Method):
    """Steps of 0.5 along a line, whose first criterion, with the index 0, is met at `END`."""

    def at(self, x):
        return self.node(x, x, x)

    def step(self, life, bound):
        end = min(life.last.x + 0.5, bound)
        return LifeStep(end=end, nodes=self.solved_at(end))


def life_with(fails, jump=np.inf):
    """Returns a life along a line, whose states fail where a function (place) -> bool says so.

    The line begins at 0 and ends at 2. Beyond the place `jump`, the criterion is met at once.
    """

    def state(x):
        return (SimpleNamespace(x=x, status=code.BEYOND_GROOVE if fails(x) else code.OK),)

    def margins(states):
        (state,) = states
        others = np.full(NO_CRITERION - 1, np.inf)
        return np.append(END - state.x if state.x <= jump else -0.1, others)

    ends = SimpleNamespace(margins=margins)
    wearing = SimpleNamespace(
        start=0.0, origin=0.0, range=2.0, state=state,
        wears=lambda node: True, events=lambda node: np.empty(0),
    )  # fmt: skip
    return follow(wearing, ends, StepsAlongALine())


def test_a_life_ends_where_its_criterion_is_met():
    life = life_with(lambda x: False)
    assert (life.status, life.criterion) == (code.OK, 0)
    assert life.last.x == pytest.approx(END, rel=1e-6)


def test_a_solve_that_fails_before_the_criterion_is_no_end_of_life():
    """Both ends of the second step, 0.5 and 1, are solved, and what lies between them is not."""
    life = life_with(lambda x: 0.6 < x < 1.0)
    assert (life.status, life.criterion) == (code.BEYOND_GROOVE, NO_CRITERION)
    assert life.last.x < 0.6 + 1e-6 and isinstance(life.unsolved_node, Node)


def test_a_solve_that_fails_beyond_the_criterion_does_not_matter():
    life = life_with(lambda x: END + 1e-3 < x < 1.0)
    assert (life.status, life.criterion) == (code.OK, 0)
    assert life.last.x == pytest.approx(END, rel=1e-2)  # up to where states are solved


@pytest.mark.parametrize(
    "half_width, status", [(0.004, code.OK), (0.02, code.BEYOND_GROOVE)], ids=["narrow", "wide"]
)
def test_a_narrow_gap_between_states_before_the_criterion_is_passed(half_width, status):
    """At 0.8, in the middle of the gap, the criterion is met at once; the step is 0.5 long.

    half_width: of the gap in which no place is solved.
    """
    life = life_with(lambda x: abs(x - 0.8) < half_width, jump=0.8)
    assert life.status == status
    assert life.last.x == pytest.approx(0.8, abs=half_width + 1e-3)
