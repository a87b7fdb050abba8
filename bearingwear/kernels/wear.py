"""The ball diameter that wear of balls and races costs (theory.md section 6)."""

import math

from bearingwear.kernels.compile import jit


@jit
def diameter_loss_rate(n_balls, D, ball_rate_i, ball_rate_o, a, track_radius, race_rate):
    """Rate at which the fit loosens, as a loss of ball diameter (theory.md Eq. 24).

    Parameters
    ----------
    ball_rate_i, ball_rate_o : float
        Wear of one ball in its two contacts [m3/s].
    a, track_radius, race_rate : tuple of 2 floats
        Semi-major axis [m], radius of the track [m], wear of the race in one contact [m3/s];
        inner, outer.

    Returns
    -------
    ball, ball_and_races : float
        [m/s]
    """
    ball = 2.0 * (ball_rate_i + ball_rate_o) / (math.pi * D * D)
    races = 0.0
    for k in range(2):
        races += n_balls * race_rate[k] / (2.0 * math.pi * track_radius[k] * 2.0 * a[k])
    return ball, ball + races
