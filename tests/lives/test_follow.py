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


def life_with(fails):
    """Returns a life along a line, whose states fail where a function (place) -> bool says so.

    The line begins at 0 and ends at 2.
    """

    def state(x):
        return (SimpleNamespace(x=x, status=code.BEYOND_GROOVE if fails(x) else code.OK),)

    margins = np.full(NO_CRITERION, np.inf)
    ends = SimpleNamespace(margins=lambda states: np.append(END - states[0].x, margins[1:]))
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
