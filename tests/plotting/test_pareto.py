"""Which settings no other one beats in both time and error."""

import numpy as np

from bearingwear.studies.dataset import pareto


def test_the_pareto_front_has_what_nothing_faster_is_as_accurate_as():
    """The fourth setting is as slow as the third and less accurate. The fifth is as accurate as the
    first and slower. The sixth has no known error. The last is the slowest and most accurate."""
    time = np.array([3.0, 1.0, 2.0, 2.0, 4.0, 0.5, 5.0])
    error = np.array([1e-3, 1e-1, 1e-2, 2e-2, 1e-3, np.nan, 1e-4])
    assert pareto(time, error).tolist() == [True, True, True, False, False, False, True]


def test_the_pareto_front_of_nothing_is_empty():
    assert not pareto(np.array([]), np.array([])).size
