"""Result variables that all models fill in the same way."""

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np

from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.contact import summary
from bearingwear.kernels.contact.friction import friction_capacity, has_friction
from bearingwear.kernels.equilibrium.stiffness import DOF, bearing_stiffness
from bearingwear.kernels.params import Geometry, OperatingPoint
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import Factors, Films, mean_pressure

TURN = 2.0 * np.pi


def contact_values(scene: Scene, g: Geometry, op: OperatingPoint, D, u, r, rows, axial) -> dict:
    """Variables of the contacts and their wear, of the n balls solved.

    D (n,) are worn diameters [m], u (n, 4) the motions (w_x, w_y, w_z, Omega) [rad/s], r (n,) orbit
    radii [m], rows (n, 2, COLUMNS) those of `bearingwear.kernels.contact.summary`, axial (n,) the
    axial forces of the inner race [N].
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        spin_to_roll = np.abs(rows[..., summary.SPIN] / rows[..., summary.ROLL])
    v1, v2 = slips_across(scene, g, op, D, u, r, rows)
    inertia = ball_inertia(ball_mass(g.rho, D), D)
    gyroscopic = np.abs(inertia * u[:, 3] * u[:, 2])
    races = np.array([op.omega_i, op.omega_o])
    spin = u[:, :3] - u[:, 3:] * (1.0, 0.0, 0.0)  # relative to the orbiting frame
    turns = len(D) * TURN
    values = {
        "contact_load": rows[..., summary.LOAD],
        "contact_angle": rows[..., summary.ANGLE],
        "semi_major_axis": rows[..., summary.MAJOR],
        "semi_minor_axis": rows[..., summary.MINOR],
        "maximum_pressure": rows[..., summary.PRESSURE],
        "qv": rows[..., summary.QV],
        "friction_heat": rows[..., summary.HEAT],
        "gyroscopic_slip_share": rows[..., summary.SHARE],
        "spin_to_roll_ratio": np.where(np.isfinite(spin_to_roll), spin_to_roll, 0.0),
        "contact_track_radius": rows[..., summary.TRACK],
        "gyroscopic_slip": v1,
        "rolling_slip": v2,
        "ball_angular_velocity": u[:, :3],
        "orbit_speed": u[:, 3],
        "gyroscopic_moment": gyroscopic,
        "cage_frequency": np.abs(u[:, 3]).sum() / turns,
        "ball_pass_frequency": g.n_balls * np.abs(races[:, None] - u[:, 3]).sum(axis=1) / turns,
        "ball_spin_frequency": np.sqrt((spin * spin).sum(axis=1)).sum() / turns,
        "total_qv": g.n_balls * rows[..., summary.QV].sum() / len(D),
        "residual_preload": g.n_balls * axial.sum() / len(D),
    }
    if has_friction(op):  # else nothing holds the moment
        used = friction_used(rows[..., summary.FRICTION], D, gyroscopic, rows[..., summary.LOAD])
        values["friction_used_by_gyroscopic_moment"] = used
    if scene.friction.film is not None:
        values["friction_coefficient"] = rows[..., summary.FRICTION]
    return values | wear_values(
        scene, D, rows[..., summary.QV], rows[..., summary.MAJOR], rows[..., summary.TRACK]
    )


def slips_across(scene: Scene, g: Geometry, op: OperatingPoint, D, u, r, rows) -> np.ndarray:
    """Gyroscopic and rolling slip (2, n, 2, strips) [m/s], of what `contact_values` takes."""
    v = np.zeros((2, len(D), 2, scene.model.strips))
    summary.slip_profiles(g, D, op, u, r, rows, strip_centres(scene.model.strips), *v)
    return v


def depth_peak(values: Mapping[str, Any], v1: np.ndarray, v2: np.ndarray) -> np.ndarray:
    """Greatest over mean depth that both tracks wear across their width, (2,) [1].

    From QV and semi-major axes (..., 2) and slips (n, 2, strips) [m/s]: over equal strips wear goes
    by the slip and by Hertz' load.
    """
    t = strip_centres(v1.shape[-1])
    worn = (1.0 - t * t) * np.hypot(v1, v2)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = values["qv"] / values["semi_major_axis"] / worn.mean(axis=-1)
    track = (np.nan_to_num(share)[..., None] * worn).sum(axis=0)
    return track.max(axis=-1) / track.mean(axis=-1)


def friction_used(mu: np.ndarray, D: Any, moment: Any, Q: np.ndarray) -> np.ndarray:
    """Share M_g/((mu_i Q_i + mu_o Q_o) R) of friction that gyroscopic moments [N m] take up [1].

    Friction coefficients [1] and loads [N] are those of the contacts (..., 2), D (...) worn
    diameters [m].
    """
    pairs = (mu[..., 0], mu[..., 1], Q[..., 0], Q[..., 1])  # moveaxis takes ten times as long
    most = friction_capacity(*pairs) * 0.5 * D
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(moment > 0.0, moment / most, 0.0)


def stiffness_of_loads(
    g: Geometry, D: np.ndarray, load: np.ndarray, angle: np.ndarray
) -> np.ndarray:
    """Stiffness (5, 5) against axial, Y and Z displacement and tilt about Y and Z [N/m, N, N m].

    From worn diameters (n,) [m], loads and contact angles (n, 2) [N, rad] of the n balls solved,
    one where it stands for all; the first ball stands at +Z.
    """
    N = g.n_balls
    Ds, Qs, alphas, K = np.empty(N), np.empty((N, 2)), np.empty((N, 2)), np.empty((DOF, DOF))
    Ds[:], Qs[:], alphas[:] = D, load, angle
    bearing_stiffness(g, Ds, 2.0 * np.pi * np.arange(N) / N, Qs, alphas, K)
    return K


def wear_values(
    scene: Scene, D: np.ndarray, qv: np.ndarray, a: np.ndarray, track: np.ndarray
) -> dict[str, np.ndarray]:
    """Archard wear rates and the loss of ball diameter, as when new.

    ball_wear_rate (n,), race_wear_rate (2,) [m3/s], ball_diameter_loss_rate [m/s], mean over the
    balls, as counted: from worn diameters (n,) [m], and QV [W], semi-major axis and track radius
    [m] of each contact (n, 2).
    """
    n = scene.bearing.ball_count
    ball_rate, race_rate = wear_rates(scene, qv, a)
    in_contact = a.min(axis=1) > 0.0  # balls off a race loosen no fit
    each = ball_rate, race_rate, a, track
    losses = diameter_loss_rate(scene, D[in_contact], *(one[in_contact].T for one in each))
    return {
        "ball_wear_rate": ball_rate.sum(axis=1),
        "race_wear_rate": n * (race_rate.sum(axis=0) / len(D)),
        "ball_diameter_loss_rate": np.sum(losses) / len(D),
    }


def wear_rates(
    scene: Scene, qv: np.ndarray, a: np.ndarray, parts: Factors | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Volumes worn off ball and race per time [m3/s] by QV [W] and semi-major axis [m].

    Of each contact (..., 2); without `parts` as when new.
    """
    if parts is None:
        parts = unworn_factors(scene, Films.of(scene), a)
    ball, race = parts
    return ball * qv, race * qv


def unworn_factors(scene: Scene, films: Films, a: np.ndarray) -> Factors:
    """K_s/H of balls and races as when new, in contacts of semi-major axes (..., 2) [m]."""
    if not films.exponent:
        return films.unworn
    return films.wearing(films.thickness > 0.0, pressed=films.pressed(mean_pressure(scene, a)))


def groove_depth_rates(n: int, race_rate: Any, a: Any, track: Any):
    """Rates at which grooves deepen on the mean of their width [m/s] (theory.md Eq. 24)."""
    return n * race_rate / (2.0 * np.pi * track * 2.0 * a)


def diameter_loss_rate(scene: Scene, D, ball_rate, race_rate, a, track) -> Any:
    """Rate at which the fit loosens, as a loss of ball diameter (theory.md Eq. 24) [m/s].

    It counts what `wear.counts` of the scene says: from the worn diameter [m], and of the inner and
    the outer contact the wear of ball and race [m3/s], semi-major axis and radius of the track [m].
    Each is a number or an array (k,).
    """
    balls = 2.0 * (ball_rate[0] + ball_rate[1]) / (np.pi * D * D)
    if not scene.wear.counts_races:
        return balls
    n = scene.bearing.ball_count
    inner, outer = (groove_depth_rates(n, race_rate[k], a[k], track[k]) for k in (0, 1))
    return balls + (inner + outer)


def loss_per_wear(n: int, D: np.ndarray, qv: np.ndarray, a: np.ndarray, track: np.ndarray):
    """Rates (2, 2) of loss over K_s/H, mean over the balls: what each contact wears off.

    Of ball diameter, and of depth of the groove [m Pa/s], inner and outer; from what `wear_values`
    takes.
    """
    loaded = np.where(a > 0.0, a, np.inf)
    depths = groove_depth_rates(n, qv, loaded, track)
    return np.array([(2.0 * qv / (np.pi * D[:, None] ** 2)).mean(axis=0), depths.mean(axis=0)])


@functools.cache
def strip_centres(n: int) -> np.ndarray:
    """Positions x/a of the middles of n equal strips; shared, so do not write to it."""
    return (2.0 * np.arange(n) + 1.0) / n - 1.0
