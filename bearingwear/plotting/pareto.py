"""The points that no other point beats."""

import numpy as np


def pareto(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Which points no other beats in both coordinates, the smaller the better (n,).

    Points with a NaN do not count.
    """
    front = np.zeros(len(first), dtype=bool)
    least = np.inf
    usable = np.isfinite(first) & np.isfinite(second)
    for k in np.lexsort((second, first)):
        if usable[k] and second[k] < least:
            least = second[k]
            front[k] = True
    return front
