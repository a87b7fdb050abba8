"""The study of a cage: its plan, how motions are told, and a small map from end to end."""

import json
import re
from dataclasses import asdict, replace

import numpy as np
import pytest
from support import ROOT, with_value

from bearingwear.plotting.drawing import save
from bearingwear.scene.checking import read_record
from bearingwear.studies.cage.figures import cage_figure, cage_message, whirl_and_wear
from bearingwear.studies.cage.gather import gathered_motions
from bearingwear.studies.cage.motion import (
    FLOATS,
    HANGS,
    IRREGULAR,
    MOTIONS,
    WHIRLS,
    WITH_BALLS,
    begins,
    path_of,
)
from bearingwear.studies.cage.plan import CAGE_STARTS, CagePlan
from bearingwear.studies.cage.run import motions_from_starts
from bearingwear.studies.cage.study import study_of_cages
from bearingwear.studies.cage.tables import cage_table
from bearingwear.studies.dataset import write_dataset

PLAN_FILE = ROOT / "config" / "cage.yaml"
TURNS = np.arange(200) / 20.0


def test_plan_of_the_project(monkeypatch):
    monkeypatch.chdir(ROOT)
    plan = read_record(CagePlan, PLAN_FILE)
    plan.check_scenes()
    assert len(plan.points) == np.prod(list(plan.shape.values()))
    study = study_of_cages(plan)
    settings = study.steps[0].given({"point": list(plan.points)[-1]})
    assert settings["changes"]["operation.gravity_m_s2"] == [0.0, 0.0, -max(plan.gravity_m_s2)]
    assert settings["changes"]["friction.cage"] == max(plan.cage_friction)
    assert "results/cage/tables/cage.md" in study.targets()


@pytest.mark.parametrize(
    ("path", "value", "told"),
    [
        ("cage_friction", [0.1, 0.05], "cage_friction: got 0.1, 0.05, expected rising"),
        ("gravity_m_s2", [9.81, 0.0], "gravity_m_s2: got 9.81, 0, expected rising"),
        ("gravity_m_s2", [-9.81], "gravity_m_s2"),
        ("starts", ["nowhere"], "starts"),
        ("stretch_turns", 7, "stretch_turns: got 7, expected a divisor of 150"),
        ("evaluated_stretches", 16, "evaluated_stretches: got 16, expected at most 15"),
    ],
)
def test_a_bad_plan_takes_one_line(path, value, told, tmp_path):
    file = with_value(PLAN_FILE, path, value, tmp_path)
    with pytest.raises(ValueError) as error:
        read_record(CagePlan, file)
    assert told in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("guide_clearance_mm", (60.0,), "guide_clearance_mm"),
        ("scene", "bearing218", "cage.material"),
    ],
)
def test_a_cage_that_cannot_be_is_named(key, value, told, monkeypatch):
    monkeypatch.chdir(ROOT)
    plan = replace(read_record(CagePlan, PLAN_FILE), **{key: value})
    with pytest.raises(ValueError) as error:
        plan.check_scenes()
    assert told in str(error.value) and "\n" not in str(error.value)


# motions


def circle(rate, centre=0.0, radius=1.0):
    return centre + radius * np.exp(2j * np.pi * rate * TURNS)


@pytest.mark.parametrize(
    ("place", "power", "motion", "whirl"),
    [
        (circle(0.375), 1.0, WITH_BALLS, 0.375),
        (circle(0.54), 1.0, WHIRLS, 0.54),
        (circle(-0.2), 1.0, WHIRLS, -0.2),
        (circle(1.3, centre=0.05), 1.0, WHIRLS, 1.3),
        (circle(0.375, centre=3.0), 1.0, HANGS, 0.0375),
        (circle(0.54) * (1.0 + 0.3 * np.sin(TURNS)), 1.0, IRREGULAR, 0.54),
        (circle(0.54), 0.0, FLOATS, 0.54),
    ],
)
@pytest.mark.parametrize("turned", [0.0, 2.0])
def test_motions(place, power, motion, whirl, turned):
    """Made-up paths, and the same turned about the axis and in other units."""
    found = path_of(1e-6 * place * np.exp(1j * turned), 0.05, power, 0.375)
    assert found.motion == motion
    assert found.whirl == pytest.approx(whirl, abs=0.02)
    assert found.offset == pytest.approx(1e-6 * np.abs(place).mean())


def test_where_a_motion_begins():
    assert begins([4, 3, 2, 2]) == 2
    assert begins([2, 2, 2]) == 0
    assert begins([2, 1]) == 1


# a map


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A map of four cages from one start each, and its plan."""
    folder = tmp_path_factory.mktemp("cages")
    plan = replace(
        read_record(CagePlan, PLAN_FILE),
        cage_friction=(0.03, 0.1),
        guide_clearance_mm=(0.2,),
        starts=("below", "whirling"),
        turns=60,
        stretch_turns=10,
        evaluated_stretches=2,
    )
    study, paths = study_of_cages(plan), []
    scene = ROOT / plan.scene_file
    for name in plan.points:
        paths.append(folder / f"{name}.nc")
        found = motions_from_starts(scene, **study.steps[0].given({"point": name}))
        write_dataset(found, paths[-1])
    gathered = gathered_motions(scene, paths, json.loads(json.dumps(asdict(plan))))
    write_dataset(gathered, folder / "cage.nc")
    return folder / "cage.nc", gathered


def test_motions_of_gyro_s1(small):
    """A whirl at 0.698 of the shaft's rate at a friction of 0.1, with and without weight, by both
    integrators; a cage with a weight hangs on its balls, at a tenth of the wear."""
    _, motions = small
    cages = motions.isel(pocket_clearance=0, guide_clearance=0)
    whirling = cages.sel(start=CAGE_STARTS.index("whirling"))
    below = cages.sel(start=CAGE_STARTS.index("below"))
    whirl = whirling.sel(cage_friction=0.1)
    assert (whirl["motion"] == WHIRLS).all()
    assert whirl["whirl_ratio"].values == pytest.approx(0.698, rel=5e-3)
    hung = below.sel(cage_friction=0.03, gravity=9.81)
    # a cage that hangs leaves its place now and then: most of the stretches
    assert int((hung["motions"] == HANGS).sum()) >= 2
    assert float(hung["centre"][1]) < -1e-5
    went_round = whirling.sel(cage_friction=0.03, gravity=9.81)
    assert float(hung["pocket_power"]) < 0.2 * float(went_round["pocket_power"])


def test_figure_and_table_of_a_map(small, tmp_path):
    path, motions = small
    figure = cage_figure(path)
    save(figure, [tmp_path / "cage.svg", tmp_path / "cage.png"])
    text = cage_table(path)
    assert f"{cage_message(motions)}." in text
    assert text.count("| 9.81 |") == text.count("| 0 | 0.15, 0.2 |") == 4
    assert "nan" not in text


def test_the_branching_is_that_of_the_data(small):
    """With every whirl taken away, or put everywhere, the sentence says so."""
    _, motions = small
    said = cage_message(motions)
    for weight in ("weightless", "under 9.81 m/s²"):
        assert re.search(
            rf"{weight}, a whirl of 0\.(69\d|7) times the shaft's rate branches off", said
        )
    still = motions.assign(motion=motions["motion"] * 0 + WITH_BALLS)
    assert cage_message(still).startswith("weightless, no cage whirls faster than the balls;")
    everywhere = motions.assign(
        motion=motions["motion"] * 0 + WHIRLS, whirl_ratio=motions["whirl_ratio"] * 0.0 + 0.9
    )
    told = cage_message(everywhere)
    assert "a whirl of 0.9 times the shaft's rate branches off at 0.03 of friction" in told
    assert "the only motion from 0.03 on" in told and "hang" not in told
    failed = motions.assign(motion=motions["motion"] * np.nan)
    assert "no cage whirls" in cage_message(failed)
    whirl_and_wear(failed.assign(whirl_ratio=motions["whirl_ratio"] * np.nan))


def test_what_was_not_solved_stays_empty(monkeypatch, tmp_path):
    from bearingwear.studies.cage import run

    monkeypatch.setattr(run, "solve_dynamic", lambda *_: ({"status": 5}, {}))
    plan = read_record(CagePlan, PLAN_FILE)
    given = study_of_cages(plan).steps[0].given({"point": next(iter(plan.points))})
    found = motions_from_starts(ROOT / plan.scene_file, **given)
    write_dataset(found, tmp_path / "point.nc")
    assert (found["status"] == 5).all() and found["motion"].isnull().all()
    assert set(found["start"].attrs["flag_meanings"].split()) == set(CAGE_STARTS)
    assert found["motion"].attrs["flag_meanings"].split() == list(MOTIONS)
