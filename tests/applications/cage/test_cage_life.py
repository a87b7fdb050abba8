"""The life of a cage: closed forms, made-up ensembles, and what ends it."""

import math

import numpy as np
import pytest
import xarray as xr
from support import ROOT, numbers_in

from bearingwear.applications.cage.life import cage_life_dataset, ensemble_life, with_cage_end
from bearingwear.applications.cage.motion import MOTIONS, WHIRLS, WITH_BALLS
from bearingwear.lives.worn_parts import cage_surfaces
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.read import variant
from bearingwear.scene.scene import SceneError

S1 = ROOT / "config/scenes/gyro_s1.yaml"
FILM = {"cage.film": {"thickness_um": 10.0, "wear_coefficient": 1e-5, "brinell_hardness_GPa": 0.1}}
FILM_K, CAGE_K = 1e-5 / 0.1e9, 1e-4 / 0.3e9  # m2/N
WORK = np.array([2e-4, 5e-5])


def made_up(work, motion=WITH_BALLS, error=0.1):
    """An ensemble with that work in pockets and at the land [J]."""
    share = np.zeros(len(MOTIONS))
    share[motion] = 1.0
    data = {"share": ("of_motion", share)}
    for name, part_work in zip(("pocket", "land"), work, strict=True):
        data[f"mean_{name}_work"] = ("group", np.full(1, part_work))
        ends = part_work * np.array([[1.0 - error, 1.0 + error]])
        data[f"mean_{name}_work_interval"] = (("group", "end"), ends)
    return xr.Dataset(data)


def life_of(changes, found=None):
    """By one ensemble, or those of a function of number and depths."""
    scene, ensemble = variant(S1, changes), made_up(WORK) if found is None else found
    by = ensemble if callable(ensemble) else lambda number, depth: ensemble
    return cage_life_dataset(ensemble_life(scene, by), with_other_parts=False), scene


def revolutions(volume, wear_over_hardness, work):
    """The plain ratio: revolutions in which a volume [m3] wears away."""
    return volume / (wear_over_hardness * work)


def end_of(found):
    return CRITERIA[int(found["cage_end"])]


def test_the_example_of_a_handbook():
    """6e-8 m3 by K_s/H 4e-15 m2/N and 0.033 N m a revolution: 4.545e8; ESA's prints 4.29e8."""
    _, surface = cage_surfaces(variant(S1, {}))
    film = {"thickness_um": 6e-8 / surface * 1e6, "wear_coefficient": 4e-15 * 1e9}
    result, _ = life_of({"cage.film": film | {"brinell_hardness_GPa": 1.0}}, made_up((0.0, 0.033)))
    assert float(result["cage_life"]) == pytest.approx(4.545e8, rel=1e-3)


def test_a_film_lasts_by_the_plain_ratio():
    """Constant work: thickness times area over K_s/H and the work, of the part that is first."""
    result, scene = life_of(FILM)
    wall, surface = cage_surfaces(scene)
    pockets, land = (
        revolutions(10e-6 * area, FILM_K, work)
        for area, work in zip((9 * wall, surface), WORK, strict=True)
    )
    assert float(result["cage_life"]) == pytest.approx(min(pockets, land), rel=1e-9)
    first = int(land < pockets)
    assert end_of(result) == "cage_film_worn_share"
    assert result.attrs["cage_ended_by"].startswith(("pocket", "land")[first])
    assert numbers_in(result.attrs["cage_ended_by"]) == [100.0, 100.0]  # %, and its criterion
    assert float(result["film_gone"][first]) == pytest.approx(float(result["cage_life"]))
    assert float(result["cage_hours"]) == pytest.approx(float(result["cage_life"]) / 30000 / 60)
    assert result["cage_life_interval"].values == pytest.approx(
        float(result["cage_life"]) * np.r_[0.9, 1.1]
    )
    wide = result["cage_life_interval_with_wear"].values / float(result["cage_life"])
    assert wide == pytest.approx(np.r_[0.9, 1.1] / 3.0 ** (1.6449 * np.r_[1, -1]), rel=1e-3)


def test_a_limit_lies_below_the_film():
    """The land's limit: the film first, then the cage's own material."""
    limit = {"wear.end_of_life": {"guide_clearance_mm": 0.3}}
    result, scene = life_of(FILM | limit, made_up((1e-9, 5e-5)))
    _, surface = cage_surfaces(scene)
    of_film = revolutions(10e-6 * surface, FILM_K, 5e-5)
    below = revolutions(40e-6 * surface, CAGE_K, 5e-5)
    assert float(result["cage_life"]) == pytest.approx(of_film + below, rel=1e-9)
    assert float(result["film_gone"][1]) == pytest.approx(of_film, rel=1e-9)
    assert end_of(result) == "guide_clearance_mm"


def test_work_that_rises_as_the_clearance_opens(monkeypatch):
    """alpha = alpha_0 exp(d/L): the turns are an integral in closed form."""
    limit = {"wear.end_of_life": {"guide_clearance_mm": 0.3}}
    scale = 50e-6

    def rising(number, depth):
        return made_up((0.0, 5e-5 * math.exp(depth[1] / scale)))

    result, scene = life_of(limit, rising)
    _, surface = cage_surfaces(scene)
    exact = surface * scale * (1.0 - math.exp(-50e-6 / scale)) / (CAGE_K * 5e-5)
    assert float(result["cage_life"]) == pytest.approx(exact, rel=0.01)  # four steps: 0.0096
    monkeypatch.setattr("bearingwear.applications.cage.life.LIFE_STEPS", 8)
    finer, _ = life_of(limit, rising)
    assert float(finer["cage_life"]) == pytest.approx(exact, rel=5e-4)
    film, _ = life_of(FILM, rising)
    assert float(film["film_gone"][1]) == float(film["cage_life"]) < exact


def test_wear_at_which_the_motion_changes_is_reported():
    limit = {"wear.end_of_life": {"guide_clearance_mm": 0.3}}

    def changing(number, depth):
        return made_up(WORK, WHIRLS if depth[1] > 20e-6 else WITH_BALLS)

    result, _ = life_of(limit, changing)
    low, high = result["motion_changes"].values
    depths = np.interp([low, high], result["node_turns"], result["node_depth"][:, 1])
    assert depths[0] < 20e-6 < depths[1]
    same, _ = life_of(limit)
    assert same["motion_changes"].isnull().all()


def test_a_cage_that_does_not_wear_has_no_end():
    result, _ = life_of(FILM, made_up((0.0, 0.0)))
    assert end_of(result) == "none" and result["cage_life"].isnull()


def test_balls_and_races_beside_it():
    scene = variant(S1, FILM | {"model.cage_results": True})
    dataset = cage_life_dataset(ensemble_life(scene, lambda n, d: made_up(WORK)))
    assert float(dataset["other_hours"]) == pytest.approx(1.3265, rel=1e-3)
    low, high = dataset["other_hours_interval"].values  # a factor of 3, and 3 % of hardness
    assert low < 1.3265 < high and high / low == pytest.approx(3.0 ** (2 * 1.6449), rel=0.03)


def test_a_cage_life_requires_a_criterion_that_can_end_it():
    with pytest.raises(SceneError, match="expected one of them to define the end of life"):
        with_cage_end(variant(S1, {}))
    with pytest.raises(SceneError, match="got 0.1, expected a number > 0.2, the initial value"):
        with_cage_end(variant(S1, {"wear.end_of_life": {"guide_clearance_mm": 0.1}}))
