"""Roots and cubics against SciPy's."""

import math

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from bearingwear.solvers.roots import brent_root, monotone_cubic


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


def test_cubics_are_those_of_scipy():
    random = np.random.default_rng(1)
    for n in (2, 3, 4, 7, 7, 7):
        x = np.cumsum(random.uniform(0.01, 2.0, n))
        for y in (random.normal(size=n), -np.cumsum(random.exponential(size=n))):
            expected = PchipInterpolator(x, y)
            for k in range(n - 1):
                places = np.linspace(x[k], x[k + 1], 5)
                found = [monotone_cubic(x, y, k)(place) for place in places]
                np.testing.assert_allclose(found, expected(places), rtol=1e-12, atol=1e-12)
