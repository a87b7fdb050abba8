"""Films, temperatures and arrangements combined: each bearing of a pair lives as it does alone.

A spring so soft that its force stays the same ties two unlike bearings by nothing but the end of
their life. Each of them then lives as a single bearing under a constant force does.
"""

import numpy as np
import pytest
from support import scene_file

from bearingwear.kernels import status as code
from bearingwear.lives.history import life_values
from bearingwear.lives.life import life
from bearingwear.lives.many import worn_life
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.read import load_scene

END = "wear.end_of_life={ball_diameter_loss_um: 0.2}"
FILM = (
    "friction.ball_race=null",
    "friction.film={shear_strength_MPa: 0, pressure_coefficient: 0.08, thickness_um: 0.02, "
    "wear_coefficient: 1.0e-6, bare_ball_race: 0.1}",
)
NETWORK = (
    "thermal={conductance_W_K: {inner_ring_shaft: 0.1, outer_ring_housing: 0.1, ball_race: 0.05}, "
    "shaft_C: 20, housing_C: 20}"
)
PLAIN = ("friction.ball_race=0.06",)
SECOND = "arrangement.second={friction.film: null, friction.ball_race: 0.06}"
SPRING = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1e-7", SECOND)
# Relative difference of two lives through the same states by other steps: of the residuals of
# solves with even wear, of the error of a step with worn grooves.
AGREEMENT = {"hertz": 1e-5, "worn": 5e-3}


def steady_life(contact, *changes):
    """Returns the values of the steady life of gyro_s1 under a constant force."""
    keys = [f"model.contact={contact}", "operation.preload_method=constant_force", END]
    keys += ["cage=null", "uncertainty=null", *changes]
    result = life(load_scene(scene_file("gyro_s1"), keys), "steady")
    assert result.values["status"] == code.OK
    return result.values


def history_at(values, time, name, bearing=...):
    """Returns a history at a time [s], between its points by straight lines.

    bearing: 0 or 1 of a pair; by default the values are those of a single bearing.
    """
    return np.interp(time, values["history_time"], values[f"history_{name}"][bearing])


THICK = "friction.film.thickness_um=0.3"  # a step along grooves wears more than a thin film


@pytest.mark.parametrize(
    "contact, warm", [("hertz", (NETWORK,)), ("worn", (NETWORK,)), ("hertz", ())]
)
def test_each_of_two_bearings_that_nothing_ties_lives_as_alone(contact, warm):
    """The first bearing has a film, the second has none."""
    film = (*FILM, THICK) if contact == "worn" else FILM
    pair = steady_life(contact, *film, *SPRING, *warm)
    filmed = steady_life(contact, *film, *warm)
    plain = steady_life(contact, *PLAIN, *warm)
    rtol = AGREEMENT[contact]
    # the bearing that ends the life ends it as it does alone
    end = min(filmed["life"], plain["life"])
    assert pair["life"] == pytest.approx(end, rel=rtol)
    # the film is gone when it is gone alone, and the other bearing never had one
    worn_through_alone = filmed["race_film_worn_through"]
    wears_through = worn_through_alone < end
    assert wears_through.any() == (contact == "hertz")  # the thick one outlasts the life
    worn_through, film_left = pair["race_film_worn_through"], pair["history_race_film"]
    expected = worn_through_alone[wears_through]
    assert worn_through[0][wears_through] == pytest.approx(expected, rel=rtol)
    for race in np.flatnonzero(~wears_through):
        alone = np.interp(end, filmed["history_time"], filmed["history_race_film"][:, race])
        assert film_left[0, -1, race] == pytest.approx(alone, rel=rtol)
    assert np.isnan(worn_through[1]).all() and np.isnan(film_left[1]).all()
    for k, single in enumerate((filmed, plain)):
        for name in ("ball_diameter_loss", "total_qv", "friction_used_by_gyroscopic_moment"):
            alone = history_at(single, 0.9 * end, name)
            # 2 %: straight lines between the few points of two histories
            of_pair = history_at(pair, 0.9 * end, name, k)
            assert of_pair == pytest.approx(alone, rel=2e-2), (k, name)
        if warm:
            start = single["history_part_temperature"][0]
            assert pair["history_part_temperature"][k][0] == pytest.approx(start, rel=1e-5)
            assert start.max() > 20.0  # warmer than its surroundings


def test_a_film_may_end_the_life_of_a_pair_of_which_one_bearing_has_it():
    end = "wear.end_of_life.film_worn_share=0.5"
    pair = steady_life("hertz", *FILM, *SPRING, end)
    alone = steady_life("hertz", *FILM, end)
    assert pair["life"] == pytest.approx(alone["life"], rel=AGREEMENT["hertz"])
    assert np.nanmax(pair["history_film_worn_share"][0][-1]) == 1.0


FIXED = "operation.preload_method=fixed_position"
RIGID = (FIXED, "arrangement.kind=rigid_pair")
ARRANGEMENTS = {
    "single": (FIXED,),
    "alike": RIGID,
    "alike, by way of the rotor": (*RIGID, "arrangement.external_axial_N=1e-6"),
    "mixed, rigid": (*RIGID, SECOND),
    "mixed, spring": (
        "operation.preload_method=constant_force",
        "arrangement.kind=spring_pair",
        "arrangement.spring_stiffness_N_um=0.2",
        SECOND,
    ),
}
SHORT = ("wear.end_of_life={ball_diameter_loss_um: 0.02}", "model.life_steps=2")
SHORT += ("model.accuracy=draft", "model.simulated_turns=1", "model.evaluated_turns=1")


def short_life(model, *changes):
    """Returns the values of a short and rough life by a model, "worn" for steady with worn grooves.

    That of worn grooves has no estimate of its errors, which would take several more lives.
    """
    contact = "worn" if model == "worn" else "hertz"
    keys = [*SHORT, f"model.contact={contact}", "cage=null", "uncertainty=null", *changes]
    scene = load_scene(scene_file("gyro_s1"), keys)
    if model == "worn":
        return life_values(scene.symmetric_half, worn_life(scene))
    return life(scene, model).values


def at_end(values, name):
    """Returns the last values of a history, a row for each bearing that is followed."""
    history = np.asarray(values[f"history_{name}"])
    has_two_bearings = np.ndim(values["history_total_qv"]) == 2
    return history[:, -1] if has_two_bearings else history[None, -1]


WARMTHS = pytest.mark.parametrize("warm", [(), (NETWORK,)], ids=["cold", "warm"])
FILMS = pytest.mark.parametrize("film", [(), (*FILM, THICK)], ids=["bare", "film"])


def check_effects(values, film, warm, is_mixed=False):
    """Checks that each bearing of a life has temperatures and a film where its scene has them."""
    assert values["status"] == code.OK
    assert ("history_part_temperature" in values) == bool(warm)
    assert ("history_race_film" in values) == bool(film)
    if warm:
        assert at_end(values, "part_temperature")[:, :3].min() > 20.0  # the rings and the balls
    if film:
        left = at_end(values, "race_film")
        has_no_film = np.isnan(left).any(axis=1)
        assert not has_no_film[0] and (has_no_film[1:] == is_mixed).all()
        assert 0.0 < left[0].min() <= left[0].max() < 0.3e-6  # THICK, partly worn


@WARMTHS
@FILMS
@pytest.mark.parametrize("model", ["steady", "worn"])
def test_a_life_has_each_effect_in_every_arrangement(model, film, warm):
    """Two alike bearings live as the single one, whether or not their rotor is balanced."""
    lives = {}
    for name, arrangement in ARRANGEMENTS.items():
        is_mixed = name.startswith("mixed")
        if is_mixed and not film:
            continue  # what makes these bearings unlike is the film of the first
        values = short_life(model, *film, *arrangement, *warm)
        check_effects(values, film, warm, is_mixed)
        if is_mixed:
            # one has a film and the other none: a tenth is far less than their frictions differ by
            first, second = at_end(values, "friction_used_by_gyroscopic_moment")
            assert abs(second / first - 1.0) > 0.1, name
        lives[name] = values["life"]
    assert lives["alike"] == lives["single"]
    of_rotor = lives["alike, by way of the rotor"]
    assert of_rotor == pytest.approx(lives["single"], rel=AGREEMENT["hertz"])


@WARMTHS
@FILMS
def test_a_dynamic_life_has_each_effect_for_one_bearing_alone(film, warm):
    check_effects(short_life("dynamic", *film, *ARRANGEMENTS["single"], *warm), film, warm)
    pairs = [ARRANGEMENTS[name] for name in ("alike", "mixed, spring")]
    for arrangement in pairs:
        with pytest.raises(NotAvailable, match=r"^gyro_s1: .*supports only one bearing: [^\n]*$"):
            short_life("dynamic", *film, *arrangement, *warm)
