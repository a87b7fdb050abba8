"""The study of a cage: its plan, how motions are named, and what a map says."""

import json

import numpy as np
import pytest
from support import ROOT, numbers_in, scene_file, step

from bearingwear.applications.cage import ensemble
from bearingwear.applications.cage.figures import cage_figure
from bearingwear.applications.cage.motion import (
    FLOATS,
    HANGS,
    IRREGULAR,
    WHIRLS,
    WITH_BALLS,
    cage_path,
    is_drifting,
)
from bearingwear.applications.cage.plan import Ensemble, cage_axes, cage_points, check_cage
from bearingwear.applications.cage.tables import (
    cage_answer,
    cage_choice_sentence,
    cage_document,
    cage_table,
    mapped_cages,
    quiet_region,
)
from bearingwear.console import UsageError
from bearingwear.page.page import page
from bearingwear.plotting.drawing import save
from bearingwear.scene.read import variant
from bearingwear.studies.configuration import validated_config
from bearingwear.studies.dataset import write_dataset

PLAN_FILE = ROOT / "config" / "cage.yaml"
TURNS = np.arange(200) / 20.0


@pytest.fixture(scope="module")
def plan():
    return validated_config(PLAN_FILE, "cage", check_cage)


def test_plan_of_the_project(plan):
    points = cage_points(plan)
    assert len(points) == np.prod([len(axis) for axis in cage_axes(plan).values()])
    changes = list(points.values())[-1].changes
    assert changes["operation.gravity_m_s2"] == [0.0, 0.0, -max(plan["gravity_m_s2"])]
    assert changes["friction.cage"] == max(plan["cage_friction"])


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("guide_clearance_mm", [60.0], "guide_clearance_mm"),
        ("scene", "bearing218", "cage.material"),
        ("cage_friction", [0.1, 0.05], "cage_friction: got 0.1, 0.05, expected increasing"),
        ("gravity_m_s2", [9.81, 0.0], "gravity_m_s2: got 9.81, 0, expected increasing"),
        ("ensemble", {"least_turns": 200}, "most_turns: got 150, expected at least 200"),
    ],
)
def test_a_cage_that_cannot_be_is_named(plan, key, value, told):
    with pytest.raises(ValueError) as error:
        check_cage(plan | {key: value}, PLAN_FILE)
    assert told in str(error.value) and "\n" not in str(error.value)


def test_a_map_without_a_scene_is_refused(tmp_path):
    (tmp_path / "cage.yaml").write_text("gravity_m_s2: [0.0]\n")
    with pytest.raises(UsageError, match=r"cage.yaml: the file: 'scene' is a dependency of"):
        validated_config(tmp_path / "cage.yaml", "cage", check_cage)
    (tmp_path / "cage.yaml").write_text("{}")
    nothing = validated_config(tmp_path / "cage.yaml", "cage", check_cage)
    assert cage_points(nothing) == {} and Ensemble(**nothing["ensemble"]) == Ensemble()


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
def test_paths_of_a_cage_are_classified_by_motion(place, power, motion, whirl, turned):
    """Made-up paths, and the same turned about the axis and in other units."""
    path_of_cage = cage_path(1e-6 * place * np.exp(1j * turned), 0.05, power, 0.375)
    assert path_of_cage.motion == motion
    assert path_of_cage.whirl == pytest.approx(whirl, abs=0.02)
    assert path_of_cage.offset == pytest.approx(1e-6 * np.abs(place).mean())


def test_a_torque_that_rises_or_falls_steadily_drifts():
    assert is_drifting([1.0, 1.02, 1.06], 0.05) and is_drifting([1.06, 1.02, 1.0], 0.05)
    assert not is_drifting([1.0, 1.02, 1.04], 0.05) and not is_drifting([1.0, 1.2, 1.1], 0.05)


# a map


def run_by_friction(scene, start, least, most):
    """A made-up run: a whirl that wears ever more from a friction of 0.05 on, else a quiet ride."""
    mu, weight = scene.friction.cage, -scene.operation.gravity_m_s2[2]
    whirls = mu >= 0.05
    power = (20.0 * mu if whirls else 0.1) * (1.0 + 0.01 * start.offset) * (1.0 + 0.1 * weight)
    row = {name: 1.0 for name in ensemble.MEANS}
    return row | {
        "status": 0,
        "motion": WHIRLS if whirls else WITH_BALLS,
        "work": 1e-4 * power,
        "pocket_work": 0.75e-4 * power,
        "land_work": 0.25e-4 * power,
        "centre": [0.0, 0.0],
    }


@pytest.fixture(scope="module")
def small(plan, tmp_path_factory):
    """A map of six cages whose runs are made up, and its file."""
    folder = tmp_path_factory.mktemp("map")
    plan = plan | {
        "gravity_m_s2": [0.0, 9.81],
        "guiding_race": ["outer"],
        "imbalance_um": [0.0],
        "guide_clearance_mm": [0.2],
        "cage_friction": [0.02, 0.05, 0.1],
    }
    scene, paths = scene_file(plan["scene"]), []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ensemble, "cage_run", run_by_friction)
        for name, point in cage_points(plan).items():
            paths.append(folder / f"{name}.nc")
            changed = variant(scene, {**plan["set"], **point.changes})
            write_dataset(ensemble.cage_ensemble(changed, Ensemble(**plan["ensemble"])), paths[-1])
    # as its rule gives the axes
    asked = {"axes": cage_axes(plan), "changes": plan["set"]}
    run, file = "applications.cage.gather.gathered_ensembles", folder / "cage.nc"
    assert step(run, file, settings=asked, scene=scene, paths=paths) == 0
    return file, ensemble.load(file)


def test_the_quiet_cage_of_a_map_is_recommended(small):
    """Of the made-up runs only those of the least friction are quiet, with a tenth of the work."""
    _, motions = small
    works = [cage.work for cage in mapped_cages(motions)]
    assert works == pytest.approx([0.1981e-4, 1.981e-4, 3.962e-4], rel=0.01)
    assert numbers_in(quiet_region(motions)) == [90.0, 0.02]  # % of the runs, friction
    friction, now, *shares, factor, low, high = numbers_in(cage_choice_sentence(motions))
    assert (friction, now, shares) == (0.02, 0.05, [100.0, 100.0])
    assert (factor, low, high) == (10.0, 10.0, 10.0)


def test_a_cage_is_kept_if_no_quieter_one_is_in_the_map(small):
    _, motions = small
    less = motions.sel(cage_friction=[0.05, 0.1])
    assert cage_choice_sentence(less).startswith("Keep ")
    assert numbers_in(quiet_region(less)) == []
    failed = motions.map(lambda values: values * np.nan).assign_attrs(motions.attrs)
    assert mapped_cages(failed) == [] and numbers_in(cage_choice_sentence(failed)) == []


def test_figure_table_and_page_show_a_map(small, tmp_path):
    path, motions = small
    save(cage_figure(path), [tmp_path / "cage.svg", tmp_path / "cage.png"])
    text = cage_table(path)
    assert cage_choice_sentence(motions) in text and quiet_region(motions) in text
    (tmp_path / "answer.json").write_text(cage_answer(path), encoding="utf-8")
    shown = page(answers=[tmp_path / "answer.json"])
    assert shown.count('id="answer-1"') == 1
    rows = {row.label: row.values for row in cage_document(path).blocks[-1].rows}
    assert rows["runs"] == ("20",) * 6 and "nan" not in text
    for friction, motion in zip(rows["friction"], rows["motions"], strict=True):
        assert motion.startswith("whirls" if float(friction) >= 0.05 else "turns with the balls")


def test_a_cage_of_the_map_is_that_of_its_scene(plan, small):
    """A point's file says which scene its runs solved."""
    path, _ = small
    file = next(path.parent.glob("g9.81*-mu0.02.nc"))
    scene = json.loads(ensemble.load(file).attrs["scene"])
    changed = variant(scene_file(plan["scene"]), {"friction.cage": 0.02})
    assert scene["friction"] == changed.to_dict()["friction"]
    assert scene["operation"]["gravity_m_s2"] == [0.0, 0.0, -9.81]
