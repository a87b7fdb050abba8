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
K_H = 5e-6 / 6.6e9
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
def marched(scene):
    """Function (changes) -> the way of gyro_s1 to a loss of 0.3 um, without estimates of errors."""
    known = {}

    def march(changes):
        key = repr(sorted(changes.items()))
        if key not in known:
            known[key] = follow_grooves(Grooves(scene("gyro_s1", SOON | changes)))
        return known[key]

    return march


def ends(found):
    """Times, groove depths and motions along a life."""
    return (
        found.times,
        np.array([p.wear.grooves for p in map(point_of, found.states)]),
        np.array([p.u for p in map(point_of, found.states)]),
    )


def test_a_film_without_shear_strength_changes_nothing(marched):
    plain, filmed = ends(marched(WORN)), ends(marched(COULOMB))
    for bare, other in zip(plain, filmed, strict=True):
        assert_allclose(other, bare, rtol=1e-8, atol=1e-8 * np.abs(bare).max())


def test_a_film_like_what_lies_below_wears_like_it(marched):
    """Only its steps are shorter, which changes the life by less than 5e-4."""
    plain, filmed = marched(WORN), marched(COULOMB | THICK | {"friction.film.bare_ball_race": 0.08})
    assert filmed.times[1] < plain.times[1]
    assert_allclose(filmed.times[-1], plain.times[-1], rtol=5e-4)


def test_a_film_thinner_than_a_step_is_worn_through_in_several(scene):
    """The estimate of the error covers what four times shorter steps change."""
    thin = scene("mos2_gyro", {"friction.film.thickness_um": 0.05})
    groove_life, values = follow_grooves(Grooves(thin)), life(thin).values
    exact = follow_grooves(Grooves(thin, EXACT_GROOVES._replace(step=STEP / 4.0))).times[-1]
    error = abs(groove_life.times[-1] / exact - 1.0)
    assert error < values["life_error_estimate"] < 0.05


def test_unworn_friction_is_that_of_hertz(scene, marched):
    hertz = solve(scene("gyro_s1", FILM | {"model.contact": "hertz"})).values
    first = marched(FILM).states[0]
    assert_allclose(first["friction_coefficient"], hertz["friction_coefficient"][0], rtol=1e-6)


def test_friction_of_a_film_rises_as_the_contact_widens(marched):
    """S_0 A + alpha Q: by the cells in contact, counted here by hand."""
    result = marched(FILM)
    first, last = result.states[0], result.states[-1]
    for k in range(2):
        cells = result.wearing.sides[0].bearing.races[k].cells.fresh
        worn = point_of(result.states[-1]).pressure[k]
        area = np.count_nonzero(worn) / np.count_nonzero(cells)
        load = worn.sum() / cells.sum()
        force = point_of(result.states[-1]).forces[k]
        hertz = 24.8e6 * np.pi * force.a * force.b / (force.Q / load)
        assert last["friction_coefficient"][k] == pytest.approx(
            hertz * area / load + 0.001, rel=0.03
        )
        assert last["friction_coefficient"][k] > 1.05 * first["friction_coefficient"][k]


def test_check_has_its_own_sums(marched):
    result = marched(FILM | THICK | {"friction.film.bare_ball_race": 0.4})
    point, bearing = point_of(result.states[-1]), result.wearing.sides[0].bearing
    for k, force in enumerate(point.forces):
        cells = bearing.races[k].cells.fresh
        law = plain_law(bearing.problem.op.law_i, force.hertz.K * force.approach**1.5,
                        force.a, force.b)  # fmt: skip
        bare = bearing.films.bare(point.wear.grooves[k], 0.5 * point.wear.ball, bearing.spread)
        at = bearing.at_cells(bare, k, point.x[k], force.alpha, point.problem.g)
        plain = friction_of_cells(point.pressure[k], cells, law, at, 0.4)
        assert plain == pytest.approx(point.slip[k, 4], rel=1e-9)
        other = friction_of_cells(point.pressure[k], cells, law, at + 1e-3, 0.4)
        assert abs(other / plain - 1.0) > 1e-4


def test_volume_of_the_film_is_what_archard_takes(marched):
    """While the film covers its track all that wears off a groove is film: K_f QV N/H."""
    result = marched(FILM | THICK)
    state, bearing = result.states[1], result.wearing.sides[0].bearing
    point = point_of(state)
    rate = bearing.rate(point, K_H, K_H, result.wearing.scene)
    for k in range(2):
        off = rate.grooves[k].sum() * bearing.arc_step[k] * 2.0 * np.pi * point.track[k]
        assert off == pytest.approx(9 * K_H * point.slip[k, 0], rel=1e-9)
        assert state["race_wear_rate"][k] == pytest.approx(off, rel=1e-12)
        left = 0.3e-6 - point.wear.grooves[k].max()
        assert state["film_left"][k] == pytest.approx(left, rel=1e-12)


def test_wear_by_place(scene):
    """Film where there is film, what lies below where there is none, in between at its edge."""
    films = WornFilms.of(scene("gyro_s1", FILM | THICK | {STEEL + ".wear_coefficient": 1e-4}))
    h = 0.3e-6
    depth = h * np.array([0.0, 1.0 - FILM_EDGE, 1.0 - 0.5 * FILM_EDGE, 1.0, 2.0])
    on_race = film_cover(films.films.race, depth)
    assert_allclose(on_race, [1.0, 1.0, 0.5, 0.0, 0.0], atol=1e-12)
    for factor in films.factors(on_race, depth, 0.0):
        assert_allclose(factor * 6.6e9, [5e-6, 5e-6, 5.25e-5, 1e-4, 1e-4], rtol=1e-12)
    assert_allclose(films.bare(depth, 0.0, 1e-3), 1.0 - on_race, atol=1e-12)
    even = films.cover_of_race(np.full(50, 0.5 * h), 2.0)
    assert_allclose(even, 1.0, rtol=1e-12)


def test_ball_film_and_running_in(scene):
    on_balls = {f"{STEEL}.film": {"thickness_um": 0.2, "wear_coefficient": 3e-7}}
    films = WornFilms.of(scene("gyro_s1", WORN | on_balls))
    film = replace(films.films.race, film=None, thickness=0.0)
    films = WornFilms(Films(films.films.ball, film), films.bare_friction)
    for ball_depth, K in ((0.0, 3e-7), (0.3e-6, 5e-6)):
        for factor in films.factors(np.zeros(3), np.zeros(3), ball_depth):
            assert_allclose(np.broadcast_to(factor, 3) * 6.6e9, K, rtol=1e-12)
    running = {f"{STEEL}.running_in": {"wear_coefficient": 5e-5, "depth_um": 0.1}}
    films = WornFilms.of(scene("gyro_s1", WORN | running))
    depth = np.array([0.0, 0.1e-6, 0.2e-6])
    _, race = films.factors(np.zeros(3), depth, 0.0)
    assert_allclose(race * 6.6e9, 5e-6 + 4.5e-5 * np.exp(-depth / 0.1e-6), rtol=1e-12)


def test_worn_through_place_by_place(scene):
    """The middle of the track goes first; the share grows, and ends the life where asked for."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.7, "film_worn_share": 0.1}}
    filmed = scene("gyro_s1", FILM | THICK | {"friction.film.thickness_um": 0.2} | end)
    groove_life = follow_grooves(Grooves(filmed))
    assert CRITERIA[groove_life.criterion] == "film_worn_share"
    share = np.array([s["film_worn_share"] for s in groove_life.states])
    assert share[-1].max() == pytest.approx(0.1, rel=1e-2)
    assert np.all(share[0] == 0.0)
    left = np.array([s["film_left"] for s in groove_life.states])[:, :2]
    assert np.all(np.diff(left, axis=0) <= 0.0) and left[-1].min() < 0.2 * FILM_EDGE * 1e-6


@pytest.mark.parametrize(
    ("bearing", "bare", "method"),
    [("7008", 0.4, "constant_force"), ("gyro_s1", 0.6, "fixed_position")],
)
def test_a_groove_goes_bare_with_ten_times_the_friction(scene, bearing, bare, method):
    """The next state is far from the last one, and is found."""
    inside = SPINDLE_7008 if bearing == "7008" else {}
    film = FILM if bearing == "7008" else COULOMB | {"friction.film.pressure_coefficient": 0.04}
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.7, "preload_fraction": 0.4}}
    thin = THICK | {"friction.film.thickness_um": 0.1, "friction.film.bare_ball_race": bare}
    held = {"operation.preload_method": method}
    groove_life = follow_grooves(Grooves(scene("gyro_s1", film | thin | inside | end | held)))
    assert groove_life.status == code.OK
    assert groove_life.states[-1]["friction_coefficient"].min() > 0.6 * bare


def test_mos2_scene_follows_its_grooves(scene):
    """A film of 0.5 um is as deep as all the wear that a groove sees."""
    result = life(scene("mos2_gyro"))
    v = result.values
    assert result.status == "ok" and "groove_depth" in v
    assert CRITERIA[v["end_criterion"]] == "ball_diameter_loss_um"
    assert np.all(v["history_race_film"][-1] < 0.2 * 0.5e-6)
    assert np.all(np.isnan(v["race_film_worn_through"]))
    assert np.all(v["history_friction_coefficient"][-1] > v["history_friction_coefficient"][0])
