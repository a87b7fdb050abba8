"""The life of a cage from ensembles with a prescribed work, against closed forms."""

import math

import numpy as np
import pytest
import xarray as xr
from support import ROOT, numbers_in

from bearingwear.applications.cage.life import cage_life_dataset, ensemble_life, with_cage_end
from bearingwear.applications.cage.motion import MOTIONS, WHIRLS, WITH_BALLS
from bearingwear.lives.dynamic_life import steady_life
from bearingwear.lives.worn_parts import cage_surfaces
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.read import variant
from bearingwear.scene.scene import SceneError

S1 = ROOT / "config/scenes/gyro_s1.yaml"
FILM = {"cage.film": {"thickness_um": 10.0, "wear_coefficient": 1e-5, "brinell_hardness_GPa": 0.1}}
FILM_DEPTH = 10e-6  # [m]
LAND_LIMIT = {"wear.end_of_life": {"guide_clearance_mm": 0.3}}
LIMIT_DEPTH = 50e-6  # of wear at which the land's clearance of 0.2 mm has grown to the limit [m]
FILM_K, CAGE_K = 1e-5 / 0.1e9, 1e-4 / 0.3e9  # K_s/H of the film and of the cage [m2/N]
WORK = np.array([2e-4, 5e-5])  # per turn in the pockets and at the land [J]
DEVIATE_95 = 1.6449  # of the normal distribution at 95 %


def ensemble_with_work(work, motion=WITH_BALLS, error=0.1):
    """Returns an ensemble whose runs have all the same motion.

    work: per turn in the pockets and at the land [J].
    error: half-width of the interval of the work, over the work.
    """
    share = np.zeros(len(MOTIONS))
    share[motion] = 1.0
    data = {"share": ("of_motion", share)}
    for name, part_work in zip(("pocket", "land"), work, strict=True):
        data[f"mean_{name}_work"] = ("group", np.full(1, part_work))
        ends = part_work * np.array([[1.0 - error, 1.0 + error]])
        data[f"mean_{name}_work_interval"] = (("group", "end"), ends)
    return xr.Dataset(data)


def cage_life(scene, ensemble_at=None):
    """Returns the dataset of the life of a scene's cage, without that of balls and races.

    ensemble_at: returns the ensemble for its number and the worn depths of pockets and land [m]. By
        default its work is `WORK` at any wear.
    """
    ensemble_at = ensemble_at or constant(WORK)
    return cage_life_dataset(ensemble_life(scene, ensemble_at), with_other_parts=False)


def constant(work):
    """Returns an `ensemble_at` for `cage_life` that gives the same work at any wear.

    work: per turn in the pockets and at the land [J].
    """
    ensemble = ensemble_with_work(work)
    return lambda number, depth: ensemble


def turns_to_wear(volume, wear_over_hardness, work):
    """Returns the turns in which a volume [m3] wears away by Archard's law with constant work."""
    return volume / (wear_over_hardness * work)


def end_criterion(dataset):
    """Returns the name of the criterion that ends the life of a cage."""
    return CRITERIA[int(dataset["cage_end"])]


def test_a_cage_life_agrees_with_the_formula_of_a_handbook():
    """The volume over K_s/H and the work is 4.545e8 turns.

    ESA's NRPM handbook prints 4.29e8 for this example (docs/theory/24-calibration.md).
    """
    volume, wear_over_hardness, work = 6e-8, 4e-15, 0.033  # [m3], [m2/N], [J]
    _, land_area = cage_surfaces(variant(S1, {}))
    film = {
        "thickness_um": 1e6 * volume / land_area,
        "wear_coefficient": 1e9 * wear_over_hardness,
        "brinell_hardness_GPa": 1.0,
    }
    dataset = cage_life(variant(S1, {"cage.film": film}), constant((0.0, work)))
    turns = turns_to_wear(volume, wear_over_hardness, work)
    assert float(dataset["cage_life"]) == pytest.approx(turns, rel=1e-9)


def test_with_constant_work_the_film_worn_through_first_ends_the_life():
    scene = variant(S1, FILM)
    dataset = cage_life(scene)
    wall_area, land_area = cage_surfaces(scene)
    pocket_turns = turns_to_wear(FILM_DEPTH * 9 * wall_area, FILM_K, WORK[0])  # 9 pockets
    land_turns = turns_to_wear(FILM_DEPTH * land_area, FILM_K, WORK[1])
    life = float(dataset["cage_life"])
    assert life == pytest.approx(min(pocket_turns, land_turns), rel=1e-9)
    part, name = (1, "land") if land_turns < pocket_turns else (0, "pocket")
    assert float(dataset["film_gone"][part]) == pytest.approx(life)
    assert end_criterion(dataset) == "cage_film_worn_share"
    assert dataset.attrs["cage_ended_by"].startswith(name)
    assert numbers_in(dataset.attrs["cage_ended_by"]) == [100.0, 100.0]  # % worn, and its limit
    turns_per_hour = 30000 * 60  # at the speed of the scene
    assert float(dataset["cage_hours"]) == pytest.approx(life / turns_per_hour)


def test_the_interval_of_a_cage_life_has_the_errors_of_work_and_wear_coefficient():
    """The work is known to 10 %, and K_s has a lognormal distribution with a factor of 3."""
    dataset = cage_life(variant(S1, FILM))
    life = float(dataset["cage_life"])
    by_work = np.array([0.9, 1.1])
    by_wear = 3.0 ** (DEVIATE_95 * np.array([-1.0, 1.0]))
    assert dataset["cage_life_interval"].values == pytest.approx(life * by_work)
    assert dataset["cage_life_interval_with_wear"].values == pytest.approx(
        life * by_work * by_wear, rel=1e-3
    )


def test_below_its_film_a_cage_wears_by_its_own_coefficient():
    """The land's limit lies below the film; the film wears first, then the cage's material."""
    land_work = 5e-5
    scene = variant(S1, FILM | LAND_LIMIT)
    dataset = cage_life(scene, constant((1e-9, land_work)))
    _, land_area = cage_surfaces(scene)
    film_turns = turns_to_wear(FILM_DEPTH * land_area, FILM_K, land_work)
    material_turns = turns_to_wear((LIMIT_DEPTH - FILM_DEPTH) * land_area, CAGE_K, land_work)
    assert float(dataset["cage_life"]) == pytest.approx(film_turns + material_turns, rel=1e-9)
    assert float(dataset["film_gone"][1]) == pytest.approx(film_turns, rel=1e-9)
    assert end_criterion(dataset) == "guide_clearance_mm"


def test_a_life_with_rising_work_converges_to_the_integral(monkeypatch):
    """For a work W exp(d/L) at a depth d, the turns are an integral in closed form."""
    new_work, scale = 5e-5, 50e-6  # W [J], L [m]

    def rising(number, depth):
        return ensemble_with_work((0.0, new_work * math.exp(depth[1] / scale)))

    scene = variant(S1, LAND_LIMIT)
    _, land_area = cage_surfaces(scene)
    exact = land_area * scale * (1.0 - math.exp(-LIMIT_DEPTH / scale)) / (CAGE_K * new_work)
    # the errors of four and of eight steps, measured, are 0.0096 and 0.0004
    assert float(cage_life(scene, rising)["cage_life"]) == pytest.approx(exact, rel=0.01)
    monkeypatch.setattr("bearingwear.applications.cage.life.LIFE_STEPS", 8)
    assert float(cage_life(scene, rising)["cage_life"]) == pytest.approx(exact, rel=5e-4)


def test_wear_at_which_the_motion_changes_is_reported():
    change_depth = 20e-6  # of the land [m]

    def whirling_when_worn(number, depth):
        return ensemble_with_work(WORK, WHIRLS if depth[1] > change_depth else WITH_BALLS)

    scene = variant(S1, LAND_LIMIT)
    dataset = cage_life(scene, whirling_when_worn)
    turns_between = dataset["motion_changes"].values
    depths = np.interp(turns_between, dataset["node_turns"], dataset["node_depth"][:, 1])
    assert depths[0] < change_depth < depths[1]
    assert cage_life(scene)["motion_changes"].isnull().all()


def test_a_cage_that_does_not_wear_has_no_end():
    dataset = cage_life(variant(S1, FILM), constant((0.0, 0.0)))
    assert end_criterion(dataset) == "none" and dataset["cage_life"].isnull()


def test_a_cage_life_also_states_the_life_of_balls_and_races():
    """It is the steady life, with an interval for a factor of 3 in K_s and 3 % of hardness."""
    scene = variant(S1, FILM | {"model.cage_results": True})
    dataset = cage_life_dataset(ensemble_life(scene, constant(WORK)))
    hours = float(dataset["other_hours"])
    steady = steady_life(variant(S1, {}))
    assert hours == pytest.approx(steady.last.time * HOURS_PER_SECOND, rel=1e-6)
    low, high = dataset["other_hours_interval"].values
    # quantiles of a sample of 4096
    assert low < hours < high and high / low == pytest.approx(3.0 ** (2 * DEVIATE_95), rel=0.03)


def test_a_cage_life_without_a_film_or_a_limit_is_refused():
    with pytest.raises(SceneError, match="expected one of them to define the end of life"):
        with_cage_end(variant(S1, {}))


def test_a_limit_that_a_new_cage_exceeds_is_refused():
    with pytest.raises(SceneError, match="got 0.1, expected a number > 0.2, the initial value"):
        with_cage_end(variant(S1, {"wear.end_of_life": {"guide_clearance_mm": 0.1}}))
