"""Roots against SciPy's."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from bearingwear.solvers.roots import brent_root


def test_roots_and_the_places_tried_are_those_of_scipy():
    random = np.random.default_rng(1)
    for power in (1.0, 3.0, 0.5, 2.2, 0.0):
        for _ in range(40):
            root, xtol = random.uniform(-2.0, 2.0), 10.0 ** random.uniform(-6.0, -2.0)
            ends = random.permutation([root - random.exponential(), root + random.exponential()])
            tried: tuple[list, list] = ([], [])

            def value(x: float, k: int, root=root, tried=tried, power=power) -> float:
                tried[k].append(x)
                return math.copysign(abs(x - root) ** power, x - root)

            expected = brentq(value, *ends, args=(0,), xtol=xtol)
            assert brent_root(lambda x, value=value: value(x, 1), *ends, xtol) == expected
            assert tried[0] == tried[1]


def test_no_root():
    for f in (lambda x: x + 2.0, lambda x: math.nan, lambda x: math.nan if x > 0.0 else -1.0):
        with pytest.raises(ValueError, match="at|between"):
            brent_root(f, -1.0, 1.0)
