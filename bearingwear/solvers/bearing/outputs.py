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
from bearingwear.solvers.bearing.films import (
    PEAK_OVER_MEAN,
    Factors,
    Films,
    contact_temperatures,
    mean_pressure,
)

TURN = 2.0 * np.pi


def contact_values(scene: Scene, g: Geometry, op: OperatingPoint, D, u, r, rows, axial) -> dict:
    """Returns the result variables of the contacts and their wear.

    D: worn diameters (n,) of the n balls solved [m].
    u: their motions (n, 4), (w_x, w_y, w_z, Omega) [rad/s].
    r: their orbit radii (n,) [m].
    rows: their contacts (n, 2, COLUMNS), from `bearingwear.kernels.contact.summary`.
    axial: axial forces of the inner race on them (n,) [N].
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        spin_to_roll = np.abs(rows[..., summary.SPIN] / rows[..., summary.ROLL])
    v1, v2 = slips_across(scene, g, op, D, u, r, rows)
    inertia = ball_inertia(ball_mass(g.rho, D), D)
    gyroscopic = np.abs(inertia * u[:, 3] * u[:, 2])
    races = np.array([op.omega_i, op.omega_o])
    spin = u[:, :3] - u[:, 3:] * (1.0, 0.0, 0.0)  # relative to the orbiting frame
    full_turns = len(D) * TURN
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
        "cage_frequency": np.abs(u[:, 3]).sum() / full_turns,
        "ball_pass_frequency": g.n_balls
        * np.abs(races[:, None] - u[:, 3]).sum(axis=1)
        / full_turns,
        "ball_spin_frequency": np.sqrt((spin * spin).sum(axis=1)).sum() / full_turns,
        "total_qv": g.n_balls * rows[..., summary.QV].sum() / len(D),
        "residual_preload": g.n_balls * axial.sum() / len(D),
    }
    if has_friction(op):  # else nothing holds the moment
        used_share = friction_used(
            rows[..., summary.FRICTION], D, gyroscopic, rows[..., summary.LOAD]
        )
        values["friction_used_by_gyroscopic_moment"] = used_share
    if scene.friction.film is not None:
        values["friction_coefficient"] = rows[..., summary.FRICTION]
    return values | wear_values(
        scene, D, rows[..., summary.QV], rows[..., summary.MAJOR], rows[..., summary.TRACK]
    )


def slips_across(scene: Scene, g: Geometry, op: OperatingPoint, D, u, r, rows) -> np.ndarray:
    """Returns gyroscopic and rolling slip in the contacts of n balls (2, n, 2, strips) [m/s].

    The arguments are those of `contact_values`.
    """
    v = np.zeros((2, len(D), 2, scene.model.strips))
    v1, v2 = v
    summary.slip_profiles(g, D, op, u, r, rows, strip_centres(scene.model.strips), v1, v2)
    return v


def depth_peak(values: Mapping[str, Any], v1: np.ndarray, v2: np.ndarray) -> np.ndarray:
    """Returns the greatest over the mean depth across the width of both wear tracks (2,) [1].

    Over equal strips, wear is in proportion to the slip and to Hertz' load. NaN where none wears.

    values: with `qv` and `semi_major_axis` (..., 2).
    v1, v2: gyroscopic and rolling slip (n, 2, strips) [m/s].
    """
    t = strip_centres(v1.shape[-1])
    worn = (1.0 - t * t) * np.hypot(v1, v2)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = values["qv"] / values["semi_major_axis"] / worn.mean(axis=-1)
    track = (np.nan_to_num(share)[..., None] * worn).sum(axis=0)
    return track.max(axis=-1) / track.mean(axis=-1)


def friction_used(mu: np.ndarray, D: Any, moment: Any, Q: np.ndarray) -> np.ndarray:
    """Returns the share M_g/((mu_i Q_i + mu_o Q_o) R) of friction that carries the moment M_g [1].

    R is half the diameter. 0 without a moment, infinite where no friction could carry it.

    mu, Q: friction coefficients [1] and loads [N] of the contacts (..., 2).
    D: worn diameters (...) [m].
    moment: gyroscopic moments (...) [N m].
    """
    # indices, as moveaxis takes ten times as long
    most = friction_capacity(mu[..., 0], mu[..., 1], Q[..., 0], Q[..., 1]) * 0.5 * D
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(moment > 0.0, moment / most, 0.0)


def stiffness_of_loads(
    g: Geometry, D: np.ndarray, load: np.ndarray, angle: np.ndarray
) -> np.ndarray:
    """Returns the stiffness (5, 5) of a bearing whose contacts carry no friction [N/m, N, N m].

    Rows and columns: displacements along X, Y and Z, tilts about Y and Z. The first ball stands at
    +Z.

    D: worn diameters (n,) [m] of the n balls solved, one if it represents all.
    load, angle: their contact loads [N] and contact angles [rad] (n, 2).
    """
    N = g.n_balls
    Ds, Qs, alphas, K = np.empty(N), np.empty((N, 2)), np.empty((N, 2)), np.empty((DOF, DOF))
    Ds[:], Qs[:], alphas[:] = D, load, angle
    bearing_stiffness(g, Ds, 2.0 * np.pi * np.arange(N) / N, Qs, alphas, K)
    return K


def wear_values(
    scene: Scene, D: np.ndarray, qv: np.ndarray, a: np.ndarray, track: np.ndarray
) -> dict[str, np.ndarray]:
    """Returns Archard wear rates and the rate of diameter loss of new surfaces.

    These are ball_wear_rate (n,) and race_wear_rate (2,) of inner and outer race [m3/s]; and
    ball_diameter_loss_rate, the mean over the balls of the parts that `wear.counts` names [m/s].

    D: worn diameters (n,) [m].
    qv, a, track: QV [W], semi-major axis and track radius [m] of each contact (n, 2).
    """
    n = scene.bearing.ball_count
    ball_rate, race_rate = wear_rates(scene, qv, a)
    touching = a.min(axis=1) > 0.0  # a ball off a race loosens no fit
    losses = diameter_loss_rate(  # takes the contacts along the first axis: (2, n)
        scene,
        D[touching],
        ball_rate[touching].T,
        race_rate[touching].T,
        a[touching].T,
        track[touching].T,
    )
    return {
        "ball_wear_rate": ball_rate.sum(axis=1),
        "race_wear_rate": n * (race_rate.sum(axis=0) / len(D)),
        "ball_diameter_loss_rate": np.sum(losses) / len(D),
    }


def wear_rates(
    scene: Scene, qv: np.ndarray, a: np.ndarray, parts: Factors | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Returns the wear volumes of ball and race per time in each contact (..., 2) [m3/s].

    qv, a: QV [W] and semi-major axis [m] of each contact (..., 2).
    parts: K_s/H of ball and race, that of new surfaces if none is given.
    """
    ball, race = unworn_factors(scene, Films.of(scene), a) if parts is None else parts
    return ball * qv, race * qv


def unworn_factors(scene: Scene, films: Films, a: np.ndarray) -> Factors:
    """Returns K_s/H of new balls and races, in contacts of semi-major axes (..., 2) [m]."""
    if films.table is None:
        return films.unworn
    table_factor = films.table_factor(
        PEAK_OVER_MEAN * mean_pressure(scene, a), contact_temperatures(scene)
    )
    return films.contact_factors(films.thickness > 0.0, table_factor=table_factor)


def groove_depth_rates(n: int, race_rate: Any, a: Any, track: Any):
    """Returns the rates at which grooves deepen, the mean over their width [m/s] (Eq. 24).

    n: number of balls.
    race_rate: wear of the race by one ball [m3/s].
    a, track: semi-major axis of the contact and radius of its track [m].
    """
    return n * race_rate / (2.0 * np.pi * track * 2.0 * a)


def diameter_loss_rate(scene: Scene, D, ball_rate, race_rate, a, track) -> Any:
    """Returns the rate at which the fit loosens, as a loss of ball diameter (Eq. 24) [m/s].

    It counts the parts that `wear.counts` of the scene names. Each value is a number or an array.

    D: worn diameter [m].
    ball_rate, race_rate: wear of ball and race in the inner and the outer contact [m3/s].
    a, track: semi-major axis and radius of the track in both contacts [m].
    """
    balls = 2.0 * (ball_rate[0] + ball_rate[1]) / (np.pi * D * D)
    if not scene.wear.counts_races:
        return balls
    n = scene.bearing.ball_count
    inner, outer = (groove_depth_rates(n, race_rate[k], a[k], track[k]) for k in (0, 1))
    return balls + (inner + outer)


def loss_per_wear(n: int, D: np.ndarray, qv: np.ndarray, a: np.ndarray, track: np.ndarray):
    """Returns rates of loss over K_s/H (2, 2), the mean over the balls [m Pa/s].

    Rows: loss of ball diameter, depth of the groove. Columns: by the inner, by the outer contact.
    A contact without load wears nothing. The arguments are those of `wear_values`.
    """
    loaded = np.where(a > 0.0, a, np.inf)
    depths = groove_depth_rates(n, qv, loaded, track)
    return np.array([(2.0 * qv / (np.pi * D[:, None] ** 2)).mean(axis=0), depths.mean(axis=0)])


@functools.cache
def strip_centres(n: int) -> np.ndarray:
    """Returns the centres x/a of n equal strips; they are shared, so do not write to them."""
    return (2.0 * np.arange(n) + 1.0) / n - 1.0
