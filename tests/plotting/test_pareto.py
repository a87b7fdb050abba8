import numpy as np

from bearingwear.studies.dataset import pareto


def test_pareto_front():
    time = np.array([3.0, 1.0, 2.0, 2.0, 4.0, 0.5, 5.0])
    error = np.array([1e-3, 1e-1, 1e-2, 2e-2, 1e-3, np.nan, 1e-4])
    assert pareto(time, error).tolist() == [True, True, True, False, False, False, True]
    assert not pareto(np.array([]), np.array([])).size
