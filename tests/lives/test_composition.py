"""Effects that no kind of life knows of one by one: every combination, and each bearing by itself.

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
CASES = {
    "steady": ("steady", "hertz", 1e-5),
    "grooves": ("steady", "worn", 5e-3),  # to what their steps differ
}


def lived(contact, fidelity, *changes):
    method = "operation.preload_method=constant_force"
    changes_of_scene = [
        f"model.contact={contact}",
        method,
        END,
        "cage=null",
        "uncertainty=null",
        *changes,
    ]
    result = life(load_scene(scene_file("gyro_s1"), changes_of_scene), fidelity)
    assert result.values["status"] == code.OK
    return result.values


def at(values, time, name, bearing=...):
    """A history of a bearing at a time."""
    return np.interp(time, values["history_time"], values[f"history_{name}"][bearing])


THICK = "friction.film.thickness_um=0.3"  # a step along grooves wears more than a thin film


@pytest.mark.parametrize("kind, warm", [*((kind, (NETWORK,)) for kind in CASES), ("steady", ())])
def test_a_film_on_one_of_two_bearings_that_nothing_ties(kind, warm):
    fidelity, contact, rtol = CASES[kind]
    film = (*FILM, THICK) if contact == "worn" else FILM
    pair = lived(contact, fidelity, *film, *SPRING, *warm)
    filmed, plain = (lived(contact, fidelity, *item, *warm) for item in (film, PLAIN))
    # the one that ends the life ends it as it does alone
    ends = min(filmed["life"], plain["life"])
    assert pair["life"] == pytest.approx(ends, rel=rtol)
    # the film is gone when it is gone alone, and the other bearing never had one
    through = filmed["race_film_worn_through"]
    wears_through = through < ends
    assert wears_through.any() != (contact == "worn")
    worn_through, left = pair["race_film_worn_through"], filmed["history_race_film"]
    assert worn_through[0][wears_through] == pytest.approx(through[wears_through], rel=rtol)
    for race in np.flatnonzero(~wears_through):
        alone = np.interp(ends, filmed["history_time"], left[:, race])
        assert pair["history_race_film"][0, -1, race] == pytest.approx(alone, rel=rtol)
    assert np.isnan(worn_through[1]).all() and np.isnan(pair["history_race_film"][1]).all()
    for k, single in enumerate((filmed, plain)):
        for name in ("ball_diameter_loss", "total_qv", "friction_used_by_gyroscopic_moment"):
            alone = at(single, 0.9 * ends, name)
            assert at(pair, 0.9 * ends, name, k) == pytest.approx(alone, rel=2e-2), (k, name)
        start = single["history_part_temperature"][0] if warm else np.zeros(0)
        if warm:
            result = pair["history_part_temperature"][k][0]
            assert result == pytest.approx(start, rel=1e-5)
            assert start.max() > 20.0


def test_a_film_may_end_the_life_of_a_pair_of_which_one_bearing_has_it():
    end = "wear.end_of_life.film_worn_share=0.5"
    pair = lived("hertz", "steady", *FILM, *SPRING, end)
    alone = lived("hertz", "steady", *FILM, end)
    assert pair["life"] == pytest.approx(alone["life"], rel=1e-5)
    assert np.nanmax(pair["history_film_worn_share"][0][-1]) == 1.0


ONE = "operation.preload_method=fixed_position"
RIGID = (ONE, "arrangement.kind=rigid_pair")
ARRANGEMENTS = {
    "single": (ONE,),
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
    """Values of a short and rough life, without its errors where these take several more."""
    contact = "worn" if model == "worn" else "hertz"
    changes_of_scene = [
        *SHORT,
        f"model.contact={contact}",
        "cage=null",
        "uncertainty=null",
        *changes,
    ]
    scene = load_scene(scene_file("gyro_s1"), changes_of_scene)
    if model == "worn":
        return life_values(scene.symmetric_half, worn_life(scene))
    return life(scene, model).values


def at_end(values, name):
    """A history of each bearing at its end."""
    history = np.asarray(values[f"history_{name}"])
    return history[:, -1] if np.ndim(values["history_total_qv"]) == 2 else history[None, -1]


@pytest.mark.parametrize("warm", [(), (NETWORK,)], ids=["cold", "warm"])
@pytest.mark.parametrize("film", [(), (*FILM, THICK)], ids=["bare", "film"])
@pytest.mark.parametrize("model", ["steady", "worn", "dynamic"])
def test_every_combination(model, film, warm):
    """A life has each effect that its scene has; pairs alone have no dynamic one."""
    lives = {}
    for name, arrangement in ARRANGEMENTS.items():
        if name.startswith("mixed") and not film:
            continue  # the second bearing of the pair with a film has none
        changes = *film, *arrangement, *warm
        if model == "dynamic" and name != "single":
            with pytest.raises(
                NotAvailable, match=r"^gyro_s1: .*supports only one bearing: [^\n]*$"
            ):
                short_life(model, *changes)
            continue
        values = short_life(model, *changes)
        assert values["status"] == code.OK, name
        assert ("history_part_temperature" in values) == bool(warm), name
        assert ("history_race_film" in values) == bool(film), name
        if warm:
            assert at_end(values, "part_temperature")[:, :3].min() > 20.0, name
        if film:
            left, mixed = at_end(values, "race_film"), name.startswith("mixed")
            assert (np.isnan(left).any(axis=1) == [False, True][: 1 + mixed]).all(), name
            assert 0.0 < left[0].min() <= left[0].max() < 0.3e-6, name
        if name.startswith("mixed"):
            first, second = at_end(values, "friction_used_by_gyroscopic_moment")
            assert abs(second / first - 1.0) > 0.1, name
        lives[name] = values["life"]
    if len(lives) > 1:
        assert lives["alike"] == lives["single"]
        assert lives["alike, by way of the rotor"] == pytest.approx(lives["single"], rel=1e-5)
