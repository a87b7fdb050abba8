"""A ball between worn grooves: no wear is Hertz, and its forces derive from one energy."""

import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support import in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.params import Geometry
from bearingwear.kernels.worn.balance import (
    Arc,
    WornRace,
    spline_pieces,
    worn_force,
)
from bearingwear.kernels.worn.cells import contact_buffers
from bearingwear.kernels.worn.pressure import FULL_WIDTH, contact_cells, worn_pressure
from bearingwear.solvers.worn.films import AS_WITH_FILM

worn_force = in_python(worn_force, worn_pressure)

D, ALPHA = 2e-3, math.radians(20.0)
G = Geometry(
    n_balls=9, D0=D, dm=7.5e-3, alpha0=ALPHA, BD=0.125 * D, R_o=3.59e-3, R_i=3.82e-3,
    r_i=0.54 * D, r_o=0.585 * D, E_star=1.143e11, rho=7800.0,
)  # fmt: skip
APPROACH = 5e-7  # [m]
SIDES = pytest.mark.parametrize("side", [INNER, OUTER])
NOWHERE = Arc(0.0, 1.0, np.zeros((4, 0)))  # an arc without pieces


def arc_of_depths(first, step, depth):
    """Returns the arc of a groove with depths [m] at equal steps from a first place [m]."""
    places = first + step * np.arange(len(depth))
    return Arc(float(first), float(step), np.ascontiguousarray(CubicSpline(places, depth).c))


def worn_race(side, depth, cells=(48, 10)):
    """Returns a race whose groove has a depth, and its Hertz contact.

    depth: function of the places x/a that returns depths [m]. cells: number along and across.
    """
    hertz = race_contact(G, side, D, math.cos(ALPHA), math.nan)
    a = hertz.c_a * (hertz.K * APPROACH**1.5) ** (1.0 / 3.0)
    status, result = contact_cells(hertz.log_kappa, -1.9, 1.9, FULL_WIDTH, *cells)
    assert status == code.OK
    x = np.linspace(-5.0, 5.0, 201)
    n = cells[0]
    return WornRace(
        cells=result, work=contact_buffers(*cells), pressure=result.fresh.copy(), wear=np.zeros(n),
        x=np.zeros(n), rise=np.zeros(n),
        groove=arc_of_depths(x[0] * a, (x[1] - x[0]) * a, depth(x)),
        alpha_ref=ALPHA, bare=np.zeros(n), uncovered=NOWHERE,
        without=AS_WITH_FILM,
    ), hertz  # fmt: skip


def place_of_ball(side, approach=APPROACH, alpha=ALPHA):
    """Returns the axial and radial distance of the centres [m] for an approach and an angle."""
    length = (G.r_i if side == INNER else G.r_o) - 0.5 * D + approach
    return length * math.sin(alpha), length * math.cos(alpha)


def skew_depth(x):
    """Returns the depth of a groove that is deepest beside its middle [m], at places x/a."""
    return 0.4 * APPROACH * np.exp(-(((x - 0.4) / 0.7) ** 2))


def test_a_groove_is_a_spline_with_level_ends():
    """Its pieces are those of SciPy's clamped spline, whose slope vanishes at both ends."""
    x = np.linspace(-3.0, 4.0, 57)
    depth, c = np.exp(-((x - 0.3) ** 2)), np.empty((4, 56))
    spline_pieces(x[1] - x[0], depth, c)
    expected = CubicSpline(x, depth, bc_type="clamped").c
    assert c == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


@SIDES
def test_without_wear_a_contact_is_that_of_hertz(side):
    race, hertz = worn_race(side, np.zeros_like)
    force = worn_force(G, D, race, side, 0.0, *place_of_ball(side))
    assert force.status == code.OK
    assert force.Q == pytest.approx(hertz.K * APPROACH**1.5, rel=1e-9)
    assert abs(force.T) < 1e-9 * force.Q
    p_0 = 1.5 * force.Q / (math.pi * force.a * force.b)
    assert force.peak == pytest.approx(p_0, rel=1e-9)


@SIDES
def test_an_even_depth_only_shifts_the_approach(side):
    """The load is that of Hertz at an approach without the depth, from either reference."""
    deep = 0.3 * APPROACH
    race, hertz = worn_race(side, lambda x: np.full_like(x, deep))
    y = place_of_ball(side, APPROACH + deep)
    force = worn_force(G, D, race, side, deep, *y)
    assert force.Q == pytest.approx(hertz.K * APPROACH**1.5, rel=1e-8)
    assert np.abs(race.rise).max() < 1e-18  # and its surface stays where the ball is
    # from another reference the cells lie elsewhere, which changes the result by their error
    from_other_reference = worn_force(G, D, race, side, 0.9 * deep, *y)
    assert from_other_reference.Q == pytest.approx(force.Q, rel=1e-3)
    assert from_other_reference.peak == pytest.approx(force.peak, rel=1e-2)


@SIDES
def test_bodies_of_twice_the_size_carry_four_times_the_load(side):
    """All lengths are doubled, also the depth of the groove over its place; the peak is the same.

    A coefficient of the power p of the place [m] goes as 2^(1 - p).
    """
    race, _ = worn_race(side, skew_depth)
    force = worn_force(G, D, race, side, 0.0, *place_of_ball(side))
    lengths = ("D0", "dm", "BD", "R_o", "R_i", "r_i", "r_o")
    large = G._replace(**{name: 2.0 * getattr(G, name) for name in lengths})
    groove = Arc(2.0 * race.groove.first, 2.0 * race.groove.step, race.groove.c.copy())
    for power in range(4):
        groove.c[3 - power] *= 2.0 ** (1 - power)
    y1, y2 = place_of_ball(side)
    twice = worn_force(large, 2.0 * D, race._replace(groove=groove), side, 0.0, 2.0 * y1, 2.0 * y2)
    assert twice.Q == pytest.approx(4.0 * force.Q, rel=1e-7)
    assert twice.T == pytest.approx(4.0 * force.T, rel=1e-6)
    assert twice.peak == pytest.approx(force.peak, rel=1e-7)


@SIDES
def test_the_tangent_is_symmetric_with_a_skew_profile(side):
    """The force is conservative. Without the tangential force T its tangent is not symmetric."""
    race, _ = worn_race(side, skew_depth, (96, 16))
    # off the angle at which the groove was worn
    y = place_of_ball(side, 1.1 * APPROACH, ALPHA + 0.01)
    h = 1e-3 * APPROACH

    def tangent(share_of_T):
        """Returns the slope (2, 2) of the force by the place, with a share of T."""
        columns = []
        for move in np.array([(h, 0.0), (0.0, h)]):
            forces = []
            for sign in (1.0, -1.0):
                force = worn_force(G, D, race, side, 0.0, *(y + sign * move))
                assert force.status == code.OK
                sine, cosine, T = math.sin(force.alpha), math.cos(force.alpha), share_of_T * force.T
                forces.append(
                    (force.Q * sine - side * T * cosine, force.Q * cosine + side * T * sine)
                )
            columns.append(np.subtract(*forces) / (2.0 * h))
        return np.array(columns).T

    k, k_without_T = tangent(1.0), tangent(0.0)
    assert abs(k[0, 1] - k[1, 0]) < 1e-3 * np.abs(k).max()
    assert abs(k_without_T[0, 1] - k_without_T[1, 0]) > 5.0 * abs(k[0, 1] - k[1, 0])


@SIDES
def test_a_groove_pulls_back_a_ball_whose_angle_grows(side):
    """A larger angle moves the ball beside its groove: to +X outside, to -X inside.

    The tangential force T points back, and the load rises.
    """
    race, _ = worn_race(side, lambda x: 0.5 * APPROACH * np.exp(-(x**2)))
    in_groove, beside_groove = (
        worn_force(G, D, race, side, 0.0, *place_of_ball(side, alpha=ALPHA + angle))
        for angle in (0.0, 0.01)
    )
    assert abs(in_groove.T) < 1e-6 * in_groove.Q
    # the groove lies at -sigma r_g 0.01 from the ball
    assert beside_groove.T * side < 0.0
    assert beside_groove.Q > in_groove.Q * (1.0 + 1e-4)


def test_a_ball_off_its_groove_has_lost_its_contact():
    race, _ = worn_race(OUTER, np.zeros_like)
    force = worn_force(G, D, race, OUTER, 0.0, *place_of_ball(OUTER, -1e-8))
    assert (force.status, force.Q) == (code.CONTACT_LOST, 0.0)
