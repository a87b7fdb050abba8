"""Films along worn grooves: the limits without film, friction of the real area, film by place."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.verification import plain_law
from bearingwear.kernels.worn.verification import friction_of_cells
from bearingwear.lives.grooves import EXACT_GROOVES, STEP, Grooves, follow_grooves, point_of
from bearingwear.lives.life import life
from bearingwear.scene.blocks import CRITERIA
from bearingwear.solvers.bearing.films import Films
from bearingwear.solvers.solve import solve
from bearingwear.solvers.worn.films import FILM_EDGE, WornFilms, film_cover

STEEL = "materials.bearing_steel"
WORN = {"model.contact": "worn", "uncertainty": None}
FILM = WORN | {
    "friction.ball_race": None,
    "friction.film.shear_strength_MPa": 24.8,
    "friction.film.pressure_coefficient": 0.001,
}
COULOMB = FILM | {
    "friction.film.shear_strength_MPa": 0.0,
    "friction.film.pressure_coefficient": 0.08,
}
THICK = {"friction.film.thickness_um": 0.3, "friction.film.wear_coefficient": 5e-6}
SOON = {"wear.end_of_life": {"ball_diameter_loss_um": 0.3}}
K_H = 5e-6 / 6.6e9  # K_s/H of the steel of gyro_s1, and of the film THICK [1/Pa]
SPINDLE_7008 = {
    "bearing.ball_count": 17,
    "bearing.ball_diameter_mm": 7.938,
    "bearing.pitch_diameter_mm": 54.0,
    "bearing.contact_angle_deg": 15.0,
    "bearing.inner_groove_factor": 0.54,
    "bearing.outer_groove_factor": 0.52,
    "operation.shaft_speed_rpm": 15000.0,
    "operation.preload_N": 150.0,
    "cage": None,
}


@pytest.fixture(scope="module")
def groove_life(scene):
    """Returns a function (changes) that follows gyro_s1 with worn grooves to a loss of 0.3 um.

    It keeps its lives for further calls. They have no estimates of errors.
    """
    lives = {}

    def life_of(changes):
        key = repr(sorted(changes.items()))
        if key not in lives:
            lives[key] = follow_grooves(Grooves(scene("gyro_s1", SOON | changes)))
        return lives[key]

    return life_of


def histories(life):
    """Returns times, groove depths and motions along a life, by name."""
    points = [point_of(state) for state in life.states]
    return {
        "times": life.times,
        "grooves": np.array([point.wear.grooves for point in points]),
        "motions": np.array([point.u for point in points]),
    }


def test_a_film_without_shear_strength_changes_nothing(groove_life):
    plain, filmed = histories(groove_life(WORN)), histories(groove_life(COULOMB))
    for name, values in plain.items():
        near = 1e-8 * np.abs(values).max()
        assert_allclose(filmed[name], values, rtol=1e-8, atol=near, err_msg=name)


def test_a_film_like_what_lies_below_wears_like_it(groove_life):
    """Only its steps are shorter, which changes the life by less than 5e-4."""
    plain = groove_life(WORN)
    filmed = groove_life(COULOMB | THICK | {"friction.film.bare_ball_race": 0.08})
    assert filmed.times[1] < plain.times[1]
    assert_allclose(filmed.times[-1], plain.times[-1], rtol=5e-4)


def test_the_error_of_a_film_thinner_than_a_step_is_covered_by_its_estimate(scene):
    """The error is what four times shorter steps change."""
    thin = scene("mos2_gyro", {"friction.film.thickness_um": 0.05})
    coarse = follow_grooves(Grooves(thin)).times[-1]
    fine = follow_grooves(Grooves(thin, EXACT_GROOVES._replace(step=STEP / 4.0))).times[-1]
    assert abs(coarse / fine - 1.0) < life(thin).values["life_error_estimate"] < 0.05


def test_unworn_friction_is_that_of_hertz(scene, groove_life):
    hertz = solve(scene("gyro_s1", FILM | {"model.contact": "hertz"})).values
    first = groove_life(FILM).states[0]
    assert_allclose(first["friction_coefficient"], hertz["friction_coefficient"][0], rtol=1e-6)


def test_friction_of_a_film_rises_as_the_contact_widens(groove_life):
    """mu = S_0 A/Q + alpha, with the area A of the cells in contact, counted here.

    They agree to 3 %, as a cell at each end of a contact counts as a whole or not at all.
    """
    result = groove_life(FILM)
    first, last = result.states[0], result.states[-1]
    point, bearing = point_of(last), result.wearing.sides[0].bearing
    for k, force in enumerate(point.forces):
        in_contact = np.count_nonzero(point.pressure[k])
        in_ellipse = np.count_nonzero(bearing.races[k].cells.fresh)
        area = np.pi * force.a * force.b * in_contact / in_ellipse
        mu = last["friction_coefficient"][k]
        assert mu == pytest.approx(24.8e6 * area / force.Q + 0.001, rel=0.03)
        assert mu > 1.05 * first["friction_coefficient"][k]


def test_the_check_of_friction_sums_over_the_cells_by_itself(groove_life):
    """Its friction is that of the solver, and differs if a thousandth more of the track is bare."""
    result = groove_life(FILM | THICK | {"friction.film.bare_ball_race": 0.4})
    point, bearing = point_of(result.states[-1]), result.wearing.sides[0].bearing
    for k, force in enumerate(point.forces):
        cells = bearing.races[k].cells.fresh
        law = plain_law(bearing.problem.op.law_i, force.hertz.K * force.approach**1.5,
                        force.a, force.b)  # fmt: skip
        of_arc = bearing.films.bare(point.wear.grooves[k], 0.5 * point.wear.ball, bearing.spread)
        bare = bearing.at_cells(of_arc, k, point.x[k], force.alpha, point.problem.g)
        friction = friction_of_cells(point.pressure[k], cells, law, bare, 0.4)
        assert friction == pytest.approx(point.slip[k, 4], rel=1e-9)
        with_more_bare = friction_of_cells(point.pressure[k], cells, law, bare + 1e-3, 0.4)
        assert abs(with_more_bare / friction - 1.0) > 1e-4


def test_volume_of_the_film_is_what_archard_takes(groove_life):
    """While the film covers its track all that wears off a groove is film: K_f QV N/H."""
    result = groove_life(FILM | THICK)
    state, bearing = result.states[1], result.wearing.sides[0].bearing
    point = point_of(state)
    rate = bearing.rate(point, K_H, K_H, result.wearing.scene)
    for k in range(2):
        volume_rate = rate.grooves[k].sum() * bearing.arc_step[k] * 2.0 * np.pi * point.track[k]
        assert_allclose(volume_rate, 9 * K_H * point.slip[k, 0], rtol=1e-9)
        assert_allclose(state["race_wear_rate"][k], volume_rate, rtol=1e-12)
        left = 0.3e-6 - point.wear.grooves[k].max()
        assert_allclose(state["film_left"][k], left, rtol=1e-12)


def test_wear_depends_on_the_film_left_at_each_place(scene):
    """K_s is 5e-6 where there is film and 1e-4 of the steel where there is none.

    The film fades over FILM_EDGE of its thickness: half way K_s is the mean of both.
    """
    films = WornFilms.of(scene("gyro_s1", FILM | THICK | {STEEL + ".wear_coefficient": 1e-4}))
    h = 0.3e-6
    depth = h * np.array([0.0, 1.0 - FILM_EDGE, 1.0 - 0.5 * FILM_EDGE, 1.0, 2.0])
    on_race = film_cover(films.films.race, depth)
    assert_allclose(on_race, [1.0, 1.0, 0.5, 0.0, 0.0], atol=1e-12)
    K_s = [5e-6, 5e-6, 0.5 * (5e-6 + 1e-4), 1e-4, 1e-4]
    for factor in films.factors(on_race, depth, 0.0):
        assert_allclose(factor * 6.6e9, K_s, rtol=1e-12)
    assert_allclose(films.bare(depth, 0.0, 1e-3), 1.0 - on_race, atol=1e-12)
    half_worn_evenly = films.cover_of_race(np.full(50, 0.5 * h), 2.0)
    assert_allclose(half_worn_evenly, 1.0, rtol=1e-12)


@pytest.mark.parametrize(("ball_depth", "K_s"), [(0.0, 3e-7), (0.3e-6, 5e-6)])
def test_the_film_of_the_balls_wears_off_both_parts_until_it_is_gone(scene, ball_depth, K_s):
    on_balls = {f"{STEEL}.film": {"thickness_um": 0.2, "wear_coefficient": 3e-7}}
    of_both = WornFilms.of(scene("gyro_s1", WORN | on_balls))
    bare_race = replace(of_both.films.race, film=None, thickness=0.0)
    films = WornFilms(Films(of_both.films.ball, bare_race), of_both.bare_friction)
    for factor in films.factors(np.zeros(3), np.zeros(3), ball_depth):
        assert_allclose(np.broadcast_to(factor, 3) * 6.6e9, K_s, rtol=1e-12)


def test_a_race_runs_in_by_the_depth_of_each_place(scene):
    """K_s at a depth d is K + (K_0 - K) e^(-d/h), with K 5e-6, K_0 5e-5 and h 0.1 um."""
    running = {f"{STEEL}.running_in": {"wear_coefficient": 5e-5, "depth_um": 0.1}}
    films = WornFilms.of(scene("gyro_s1", WORN | running))
    depth = np.array([0.0, 0.1e-6, 0.2e-6])
    _, race = films.factors(np.zeros(3), depth, 0.0)
    assert_allclose(race * 6.6e9, 5e-6 + 4.5e-5 * np.exp(-depth / 0.1e-6), rtol=1e-12)


def test_the_worn_share_of_a_film_grows_place_by_place_and_ends_the_life(scene):
    """The middle of the track is worn through first, and ends the life at a share of a tenth.

    By then the film left there is a fifth of its fading edge at the most.
    """
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.7, "film_worn_share": 0.1}}
    filmed = scene("gyro_s1", FILM | THICK | {"friction.film.thickness_um": 0.2} | end)
    result = follow_grooves(Grooves(filmed))
    assert CRITERIA[result.criterion] == "film_worn_share"
    share = np.array([state["film_worn_share"] for state in result.states])
    assert share[-1].max() == pytest.approx(0.1, rel=1e-2)
    assert np.all(share[0] == 0.0)
    left = np.array([state["film_left"] for state in result.states])[:, :2]
    assert np.all(np.diff(left, axis=0) <= 0.0) and left[-1].min() < 0.2 * FILM_EDGE * 1e-6


@pytest.mark.parametrize(
    ("changes", "bare", "method"),
    [
        (FILM | SPINDLE_7008, 0.4, "constant_force"),
        (COULOMB | {"friction.film.pressure_coefficient": 0.04}, 0.6, "fixed_position"),
    ],
    ids=["7008", "gyro_s1"],
)
def test_a_groove_goes_bare_with_ten_times_the_friction(scene, changes, bare, method):
    """The next state is far from the last one, and is found."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.7, "preload_fraction": 0.4}}
    thin = {"friction.film.thickness_um": 0.1, "friction.film.bare_ball_race": bare}
    held = {"operation.preload_method": method}
    filmed = scene("gyro_s1", changes | THICK | thin | end | held)
    result = follow_grooves(Grooves(filmed))
    assert result.status == code.OK
    assert result.states[-1]["friction_coefficient"].min() > 0.6 * bare  # most is bare


def test_the_film_of_the_mos2_scene_outlasts_its_life(scene):
    """A film of 0.5 um is as deep as all the wear that a groove sees: little is left of it."""
    result = life(scene("mos2_gyro"))
    values = result.values
    assert result.status == "ok" and "groove_depth" in values
    assert CRITERIA[values["end_criterion"]] == "ball_diameter_loss_um"
    assert np.all(values["history_race_film"][-1] < 0.2 * 0.5e-6)
    assert np.all(np.isnan(values["race_film_worn_through"]))
    assert np.all(
        values["history_friction_coefficient"][-1] > values["history_friction_coefficient"][0]
    )
