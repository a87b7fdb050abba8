"""Films and running in: the law, its limits, films worn through, and their warning."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from support import balance_of, in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.friction import Law, law_coefficients
from bearingwear.kernels.contact.verification import friction_check
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, thrust_equilibrium
from bearingwear.kernels.steady.balance import Seat, motion_equilibrium
from bearingwear.lives.ends import with_end
from bearingwear.lives.life import life
from bearingwear.lives.surfaces import surface_life
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.solvers.bearing.films import Films
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.solve import solve
from bearingwear.solvers.state import State

friction_check, law_coefficients = in_python(friction_check), in_python(law_coefficients)
motion_equilibrium = in_python(motion_equilibrium, thrust_equilibrium)

S_0, ALPHA_S = 24.8e6, 0.001  # MoS2, Singer et al. (1990)
STEEL = "materials.bearing_steel"
HERTZ = {"model.contact": "hertz", "uncertainty": None}
FILM = HERTZ | {
    "friction.ball_race": None,
    "friction.film.shear_strength_MPa": S_0 / 1e6,
    "friction.film.pressure_coefficient": ALPHA_S,
}
COULOMB = FILM | {
    "friction.film.shear_strength_MPa": 0.0,
    "friction.film.pressure_coefficient": 0.08,
}
THIN = FILM | {
    "friction.film.thickness_um": 0.05,
    "friction.film.wear_coefficient": 1e-6,
    "friction.film.bare_ball_race": 0.1,
}
POSITION = {"operation.preload_method": "fixed_position"}
RUNNING_IN = {f"{STEEL}.running_in": {"wear_coefficient": 5e-5, "depth_um": 0.02}}


def wear_through_times(result):
    """Returns the times at which the films of both races are worn through [s]."""
    return result.values["race_film_worn_through"]


# the law


def test_film_friction_goes_by_the_inverse_cube_root_of_the_load():
    """A shear strength S alone gives mu = S over the mean pressure, which goes as Q^(1/3).

    So mu vanishes as the load [N] grows. Without S, mu is the constant of the law at any load.
    """
    c_a, c_b = 6.4e-5, 9.8e-6  # m/N^(1/3)
    Q = np.logspace(-3, 12, 16)
    law = Law(mu=0.0, S=S_0)
    mu = np.array([law_coefficients(law, q, c_a * q ** (1 / 3), c_b * q ** (1 / 3))[0] for q in Q])
    assert_allclose(mu[1:] / mu[:-1], 10.0 ** (-1 / 3), rtol=1e-9)
    assert mu[-1] == pytest.approx(0.0, abs=1e-4)
    assert law_coefficients(Law(mu=0.1, S=0.0), 2.0, 6e-5, 2e-5) == (0.1, 0.0)


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
def test_each_contact_has_the_coefficient_of_its_mean_pressure(scene, fidelity):
    """It is S_0 over the mean pressure plus alpha; inner and outer pressure differ by over 1 %."""
    values = solve(scene("gyro_s1", FILM | POSITION), fidelity).values
    peak = values["maximum_pressure"]
    assert peak[0, 0] != pytest.approx(peak[0, 1], rel=1e-2)
    sheared = S_0 / (2 / 3 * peak)  # the mean pressure of an ellipse is 2/3 of its peak
    assert_allclose(values["friction_coefficient"], sheared + ALPHA_S, rtol=1e-12)
    # heat over QV is more: the film is sheared at the edge too, where slip is large and pressure
    # small; by how much depends on the slip, at most a quarter here
    ratio = values["friction_heat"] / values["qv"]
    assert np.all(ratio > sheared + ALPHA_S) and np.all(ratio < ALPHA_S + 1.25 * sheared)


@pytest.mark.parametrize("contact", ["hertz", "paper"])
@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
def test_one_coefficient_is_the_limit_without_shear_strength(scene, contact, fidelity):
    """A film with a pressure coefficient of 0.08 has the bits of a friction of 0.08."""
    with_film, plain = (
        solve(scene("gyro_s1", changes | {"model.contact": contact}), fidelity).values
        for changes in (COULOMB, HERTZ)
    )
    assert_array_equal(with_film.pop("friction_coefficient"), np.full((1, 2), 0.08))
    assert with_film.keys() == plain.keys()
    for name, value in plain.items():
        assert np.asarray(value).tobytes() == np.asarray(with_film[name]).tobytes(), name


def test_a_life_with_one_coefficient_is_the_limit_without_shear_strength(scene):
    with_film, plain = (life(scene("gyro_s1", changes)).values for changes in (COULOMB, HERTZ))
    assert np.all(with_film.pop("history_friction_coefficient") == 0.08)
    for name, value in plain.items():
        assert np.asarray(value).tobytes() == np.asarray(with_film[name]).tobytes(), name


# how it is solved and checked


@pytest.fixture(scope="module", params=[FILM, HERTZ], ids=["film", "plain"])
def solved_balance(scene, request):
    """Returns a solved balance with drag, its seat, and its unknowns (6,)."""
    changes = request.param | {"lubricant.drag_density_kg_m3": 300.0, "model.quadrature": "gauss"}
    problem = ThrustProblem.of(scene("gyro_s1", changes))
    case = problem.solve(problem.g.D0)
    assert case.status == code.OK
    p = balance_of(problem, problem.g.D0)
    start = Seat(delta_a=case.delta_a, state=cold_start())
    u = np.append(case.u, [case.T_i, case.T_o])
    return p, motion_equilibrium(p.bearing, u, start), u


@pytest.mark.parametrize("race", ["law_i", "law_o"])
@pytest.mark.parametrize("name", ["S", "mu"])
def test_the_check_rejects_another_friction_law(solved_balance, race, name):
    """It has its own formula for mu: with a law 1 % off at one race, the balance is lost."""
    p, seat, u = solved_balance
    op = p.bearing.op
    law = getattr(op, race)
    if not law.S:  # of the plain bearing, whose law has mu alone
        name = "mu"

    def residual(op):
        return friction_check(p.bearing.g, p.bearing.D, op, seat.state, u[:4], p.rule, True)[0]

    assert residual(op) < 1e-9
    changed = law._replace(**{name: getattr(law, name) * (1.0 + 1e-2) + 1e-6})
    assert residual(op._replace(**{race: changed})) > 1e-6


def test_a_march_of_thrust_alone_has_the_friction_of_the_steady_state(scene):
    """Coefficients, QV and heat agree to 1e-6 with many points, as each places its own."""
    many = {"model.strips": 100, "model.points_across": 32}
    march = {"model.dynamic_solution": "march", "model.simulated_turns": 2} | many
    marching = scene(
        "gyro_s1", FILM | march | {"model.normal_balance": "frictionless"}
    ).without_cage
    steady, dynamic = (solve(marching, fidelity).values for fidelity in ("steady", "dynamic"))
    for name in ("friction_coefficient", "qv", "friction_heat"):
        expected = np.broadcast_to(steady[name], dynamic[name].shape)
        assert_allclose(dynamic[name], expected, rtol=1e-6, err_msg=name)


# films that wear through


@pytest.mark.parametrize("changes", [{}, POSITION, {"wear.counts": "ball"}])
def test_a_film_like_what_lies_below_changes_nothing(scene, changes):
    """A film with the K_s and the friction of its substrate leaves the life as it is.

    A life with a film stops where it wears through, so that two integrators are compared.
    """
    alike = COULOMB | {
        "friction.film.thickness_um": 0.1, "friction.film.wear_coefficient": 5e-6,
        "friction.film.bare_ball_race": 0.08,
    }  # fmt: skip
    filmed, plain = (life(scene("gyro_s1", film | changes)).values for film in (alike, HERTZ))
    assert filmed["end_criterion"] == plain["end_criterion"]
    assert_allclose(filmed["life"], plain["life"], rtol=2e-4)  # within their bounds
    assert np.nanmax(filmed["life_error_bound"] / filmed["life"]) < 1e-3


def test_time_to_wear_through_is_thickness_over_rate(scene):
    """Each race keeps its rate until its film is gone, or the other's: wear is even.

    The film of 1e-5 um = 1e-11 m is so thin that nothing else changes meanwhile.
    """
    filmed = scene("gyro_s1", THIN | {"friction.film.thickness_um": 1e-5})
    state = solver_of(filmed).at(0.0)
    rate = state["loss_per_wear"][1] * 1e-6 / 6.6e9  # of the races [m/s]: times K_s/H of the film
    first, later = np.argsort(-rate)
    result = wear_through_times(life(filmed))
    assert result[first] == pytest.approx(1e-11 / rate[first], rel=1e-6)
    # then one track is bare, and the other slips as it did not before
    after = solver_of(filmed).at(1e-11, (first == 0, first == 1))["loss_per_wear"][1] * 1e-6 / 6.6e9
    rest = (1e-11 - result[first] * rate[later]) / after[later]
    assert result[later] == pytest.approx(result[first] + rest, rel=1e-4)


def test_volume_of_a_film_balances(scene):
    """What Archard's law took while there was film is its thickness times the area of the track."""
    result = life(scene("gyro_s1", THIN))
    values = result.values
    time = values["history_time"]
    R_i, R_o = solve(scene("gyro_s1", THIN)).values["contact_track_radius"][0]
    for k, R in enumerate((R_i, R_o)):
        worn_through = wear_through_times(result)[k]
        filmed = time <= worn_through
        # two states have the time of the wear-through: the second is bare
        filmed[np.argmax(time >= worn_through) + 1 :] = False
        t, a = time[filmed], values["history_semi_major_axis"][filmed, k]
        qv = values["history_qv"][filmed, k]
        worn = 9 * 1e-6 / 6.6e9 * np.trapezoid(qv, t)  # nine balls, K_s/H of THIN's film
        # a track is 2 a wide and 2 pi R long, its film 0.05 um thick
        # 0.3 %: trapezoids over the few states, and the mean width of the track
        assert_allclose(worn, 4.0 * math.pi * R * a.mean() * 0.05e-6, rtol=3e-3)
        assert_allclose(
            values["history_race_wear_rate"][filmed, k], 9 * 1e-6 / 6.6e9 * qv, rtol=1e-12
        )
        assert values["history_race_film"][filmed, k][-1] == pytest.approx(0.0, abs=1e-15)


def test_friction_and_wear_of_a_worn_through_film_are_those_of_what_lies_below(scene):
    """K_s/H is 1e-6 over 6.6e9 Pa with the film of THIN and 5e-6 over it without; mu is 0.1."""
    values = life(scene("gyro_s1", THIN)).values
    mu, rate, qv = (
        values[f"history_{name}"] for name in ("friction_coefficient", "race_wear_rate", "qv")
    )
    factor = rate / (9.0 * qv)
    for k in range(2):
        bare = values["history_film_worn_share"][:, k] == 1.0
        assert 0 < bare.sum() < bare.size and not bare[0]
        assert_allclose(factor[bare, k], 5e-6 / 6.6e9, rtol=1e-12)
        assert_allclose(factor[~bare, k], 1e-6 / 6.6e9, rtol=1e-12)
        assert np.all(mu[bare, k] == 0.1) and np.all(mu[~bare, k] < 0.05)
    assert np.all(np.diff(values["history_time"]) >= 0.0)


def test_criterion_ends_the_life_when_a_track_is_bare(scene):
    """The first of the two tracks that wears through ends the life, whatever the limit.

    A track wears evenly here: its worn share is 0 as long as it has a film, and then 1. So any
    limit between them is met at the same time.
    """
    any_share = 0.5
    result = life(scene("gyro_s1", THIN | {"wear.end_of_life.film_worn_share": any_share}))
    values = result.values
    assert CRITERIA[values["end_criterion"]] == "film_worn_share"
    times = wear_through_times(result)
    assert np.isnan(times).sum() == 1  # the other track still has its film
    assert values["life"] == np.nanmin(times)
    assert values["history_time"][-1] == values["life"]
    assert sorted(values["history_film_worn_share"][-1]) == [0.0, 1.0]


def test_film_of_the_balls_covers_both_contacts(scene):
    """No contact is bare before the balls' film is gone; then both are.

    K_s of the balls is that of the film of `THIN`, 1e-6, in the first state, and that of their
    material, 5e-6, in the last. H is 6.6 GPa.
    """
    on_balls = {
        "bearing.ball_material": "ball", "materials.ball": {
            "youngs_modulus_GPa": 208, "poisson_ratio": 0.3, "density_kg_m3": 7800,
            "brinell_hardness_GPa": 6.6, "wear_coefficient": 5e-6,
            "film": {"thickness_um": 0.01},
        },
        "friction.film.thickness_um": None,
    }  # fmt: skip
    values = life(scene("gyro_s1", THIN | on_balls)).values
    share = values["history_film_worn_share"]
    assert_array_equal(share[:, 0], share[:, 1])
    assert "history_race_film" not in values
    gone = values["history_ball_film"] <= 1e-18
    assert np.all(share[~gone] == 0.0) and share[-1, 0] == 1.0
    rate = values["history_ball_wear_rate"] / values["history_qv"].sum(axis=1)
    assert_allclose(rate[[0, -1]] * 6.6e9, [1e-6, 5e-6], rtol=1e-12)


def test_parts_wear_as_their_own_film_then_their_partners_then_as_themselves(scene):
    """K_s is 3e-7 of the film on the balls, 2e-6 of that on the races, and 5e-6 of bare steel.

    A part without a film of its own takes that of its partner in the contact, if there is one.
    """
    on_balls = {f"{STEEL}.film": {"thickness_um": 0.01, "wear_coefficient": 3e-7}}
    films = Films.of(scene("gyro_s1", FILM | on_balls))
    films = replace(films, race=replace(films.race, film=films.race.film._replace(K_s=2e-6)))
    # films that are left on inner race, outer race and balls; K_s at inner and outer contact
    for cover, balls, races in (
        ((True, True, True), [3e-7, 3e-7], [2e-6, 2e-6]),
        ((False, True, True), [3e-7, 3e-7], [3e-7, 2e-6]),
        ((False, True, False), [5e-6, 2e-6], [5e-6, 2e-6]),
        ((False, False, False), [5e-6, 5e-6], [5e-6, 5e-6]),
    ):
        ball, race = films.contact_factors(np.array(cover))
        for factor, K_s in ((ball, balls), (race, races)):
            assert_allclose(np.broadcast_to(factor * films.ball.substrate.H, 2), K_s, rtol=1e-14)
        inner, outer, on_ball = cover
        bare = not on_ball and not inner, not on_ball and not outer
        assert films.bare(cover) == bare


# in closed form


LOSS_PER_WEAR = np.array([[2.0e6, 3.0e6], [4.0e7, 5.0e7]])
"""Losses of the ball and of the races at inner and outer contact, over K_s/H [m Pa/s]."""


def life_at_constant_slip(scene):
    """Returns a life whose slip stays as it is: its rates go by K_s/H alone."""

    class ConstantSlip:
        solves = 0

        def __call__(self, conditions):
            values = {"ball_diameter_loss": conditions[0].loss, "loss_per_wear": LOSS_PER_WEAR}
            values |= {"qv": np.array([1e-2, 2e-2]), "semi_major_axis": np.array([1e-4, 1e-4])}
            return (State(code.OK, values | {"residual_preload": 7.0}),)

    end = EndOfLife(ball_diameter_loss_um=0.7)
    scene = with_end(replace(scene, model=replace(scene.model, tolerance=1e-8)), end)
    return surface_life(scene, ConstantSlip())


def test_running_in_follows_its_closed_form(scene):
    """dd/dt = c (K + (K_0 - K) e^(-d/h)):  K c t = h ln((K e^(d/h) + K_0 - K)/K_0)."""
    path = life_at_constant_slip(scene("gyro_s1", HERTZ | RUNNING_IN))
    K, K_0, h = 5e-6, 5e-5, 0.02e-6
    t = path.times[-1]
    depth = h * np.log((np.exp(K * LOSS_PER_WEAR[1] / 6.6e9 * t / h) * K_0 - (K_0 - K)) / K)
    per_ball = 0.5 * LOSS_PER_WEAR[0].sum() / 6.6e9
    ball = 2.0 * h * np.log((np.exp(K * per_ball * t / h) * K_0 - (K_0 - K)) / K)
    assert_allclose(depth.sum() + ball, 0.7e-6, rtol=1e-6)
    assert path.status == code.OK
    assert_allclose(path.states[-1].loss, 0.7e-6, rtol=1e-8)


def test_films_wear_through_as_in_closed_form(scene):
    """Rates are constant in three spans: both races filmed, the outer one bare, both bare."""
    per_wear = LOSS_PER_WEAR
    path = life_at_constant_slip(scene("gyro_s1", THIN))
    K_f, K, h = 1e-6 / 6.6e9, 5e-6 / 6.6e9, 0.05e-6
    t_i, t_o = h / (K_f * per_wear[1])
    assert t_o < t_i
    film = np.array([s["film_left"] for s in path.states])
    times = path.times
    assert times[np.argmax(film[:, 1] <= 0.0)] == pytest.approx(t_o, rel=1e-7)
    assert times[np.argmax(film[:, 0] <= 0.0)] == pytest.approx(t_i, rel=1e-7)
    off_ball = K_f * per_wear[0].sum() * t_o + (per_wear[0] @ [K_f, K]) * (t_i - t_o)
    loss = 2.0 * h + K * per_wear[1, 1] * (t_i - t_o) + off_ball
    rest = (0.7e-6 - loss) / (K * per_wear.sum())
    assert times[-1] == pytest.approx(t_i + rest, rel=1e-7)


# the warning


KEPT = THIN | {"friction.film.bare_ball_race": None}
"""A film whose friction stays when it is worn through, because no other is stated."""


@pytest.mark.parametrize(
    ("changes", "is_warned"),
    [
        pytest.param(KEPT, True, id="kept"),
        pytest.param(THIN, False, id="friction of the bare race"),
        pytest.param(KEPT | {"wear.end_of_life.film_worn_share": 0.5}, False, id="ends the life"),
        pytest.param(FILM, False, id="endless film"),
    ],
)
def test_friction_kept_after_its_film_is_warned_of(scene, changes, is_warned):
    ids = {warning["id"] for warning in warnings_in(life(scene("gyro_s1", changes)).attrs)}
    assert ("film_worn" in ids) == is_warned
