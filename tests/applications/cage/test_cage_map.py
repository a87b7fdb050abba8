"""The study of a cage: its plan, the classes of motions, and what a map of cages states."""

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
TURNS = np.arange(200) / 20.0  # ten turns of the shaft, in twentieths
BALL_RATIO = 0.375  # orbit rate of the balls over the speed of the shaft
QUIET_BELOW = 0.05  # friction from which on the cage of `run_by_friction` whirls


@pytest.fixture(scope="module")
def plan():
    """Returns the content of config/cage.yaml of the project."""
    return validated_config(PLAN_FILE, "cage", check_cage)


def test_the_map_of_the_project_has_every_combination_of_its_axes(plan):
    points = cage_points(plan)
    assert len(points) == np.prod([len(axis) for axis in cage_axes(plan).values()])
    last_changes = list(points.values())[-1].changes
    assert last_changes["operation.gravity_m_s2"] == [0.0, 0.0, -max(plan["gravity_m_s2"])]
    assert last_changes["friction.cage"] == max(plan["cage_friction"])


@pytest.mark.parametrize(
    ("key", "value", "problem"),
    [
        ("guide_clearance_mm", [60.0], "guide_clearance_mm"),
        ("scene", "bearing218", "cage.material"),
        ("cage_friction", [0.1, 0.05], "cage_friction: got 0.1, 0.05, expected increasing"),
        ("gravity_m_s2", [9.81, 0.0], "gravity_m_s2: got 9.81, 0, expected increasing"),
        ("ensemble", {"least_turns": 200}, "most_turns: got 150, expected at least 200"),
    ],
)
def test_an_invalid_plan_of_a_map_is_refused_in_one_line(plan, key, value, problem):
    with pytest.raises(ValueError) as error:
        check_cage(plan | {key: value}, PLAN_FILE)
    assert problem in str(error.value) and "\n" not in str(error.value)


def test_a_map_without_a_scene_is_refused(tmp_path):
    (tmp_path / "cage.yaml").write_text("gravity_m_s2: [0.0]\n")
    with pytest.raises(UsageError, match=r"cage.yaml: the file: 'scene' is a dependency of"):
        validated_config(tmp_path / "cage.yaml", "cage", check_cage)


def test_an_empty_plan_has_no_cages_and_the_default_ensemble(tmp_path):
    (tmp_path / "cage.yaml").write_text("{}")
    empty_plan = validated_config(tmp_path / "cage.yaml", "cage", check_cage)
    assert cage_points(empty_plan) == {} and Ensemble(**empty_plan["ensemble"]) == Ensemble()


# motions


def circle(rate, centre=0.0, radius=1.0):
    """Returns positions Y + i Z on a circle at the times TURNS.

    rate: in turns per turn of the shaft.
    """
    return centre + radius * np.exp(2j * np.pi * rate * TURNS)


@pytest.mark.parametrize(
    ("positions", "power", "motion", "whirl"),
    [
        (circle(BALL_RATIO), 1.0, WITH_BALLS, BALL_RATIO),
        (circle(0.54), 1.0, WHIRLS, 0.54),
        (circle(-0.2), 1.0, WHIRLS, -0.2),
        (circle(1.3, centre=0.05), 1.0, WHIRLS, 1.3),
        # far from its circle, the axis sees a smaller angle: by r^2/(centre^2 + r^2)
        (circle(BALL_RATIO, centre=3.0), 1.0, HANGS, BALL_RATIO / (3.0**2 + 1.0)),
        (circle(0.54) * (1.0 + 0.3 * np.sin(TURNS)), 1.0, IRREGULAR, 0.54),
        (circle(0.54), 0.0, FLOATS, 0.54),
    ],
)
@pytest.mark.parametrize("angle", [0.0, 2.0])
def test_paths_of_a_cage_are_classified_by_motion(positions, power, motion, whirl, angle):
    """The class depends on the shape of a path alone, not on the angle at which it starts."""
    path = cage_path(1e-6 * positions * np.exp(1j * angle), TURNS[1], power, BALL_RATIO)
    assert path.motion == motion
    # the mean over a number of turns that is not whole is only nearly that
    assert path.whirl == pytest.approx(whirl, abs=0.02)
    assert path.offset == pytest.approx(1e-6 * np.abs(positions).mean())


@pytest.mark.parametrize(
    ("values", "drifts"),
    [
        ([1.0, 1.02, 1.06], True),
        ([1.06, 1.02, 1.0], True),
        ([1.0, 1.02, 1.04], False),  # by less than the tolerance
        ([1.0, 1.2, 1.1], False),  # up and down
    ],
)
def test_values_that_rise_or_fall_steadily_drift(values, drifts):
    assert is_drifting(values, tolerance=0.05) == drifts


# a map


def run_by_friction(scene, start, least, most):
    """Returns the results of a run in place of `cage_run`, without solving it.

    From a friction of `QUIET_BELOW` on, the cage whirls, with a work that rises with the friction.
    Otherwise it turns with the balls, with a tenth of the least work of a whirl. The work grows by
    a tenth for each m/s2 of gravity, and by up to a hundredth with the random place of the start.
    """
    mu, gravity = scene.friction.cage, -scene.operation.gravity_m_s2[2]
    whirls = mu >= QUIET_BELOW
    work = 1e-4 * (20.0 * mu if whirls else 0.1) * (1.0 + 0.01 * start.offset)
    work *= 1.0 + 0.1 * gravity
    row = {name: 1.0 for name in ensemble.MEANS}
    return row | {
        "status": 0,
        "motion": WHIRLS if whirls else WITH_BALLS,
        "work": work,
        "pocket_work": 0.75 * work,
        "land_work": 0.25 * work,
        "centre": [0.0, 0.0],
    }


@pytest.fixture(scope="module")
def map_file(plan, tmp_path_factory):
    """Returns the file of a map of six cages with the runs of `run_by_friction`."""
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
    # as the rule of the workflow runs the step
    settings = {"axes": cage_axes(plan), "changes": plan["set"]}
    run, file = "applications.cage.gather.gathered_ensembles", folder / "cage.nc"
    assert step(run, file, settings=settings, scene=scene, paths=paths) == 0
    return file


@pytest.fixture
def motions(map_file):
    """Returns the dataset in `map_file`."""
    return ensemble.load(map_file)


def test_a_mapped_cage_has_the_work_at_the_gravity_where_it_wears_most(motions):
    works = [cage.work for cage in mapped_cages(motions)]
    by_gravity = 1.0 + 0.1 * 9.81
    expected = [1e-4 * by_gravity * factor for factor in (0.1, 20.0 * 0.05, 20.0 * 0.1)]
    assert works == pytest.approx(expected, rel=0.01)  # the random start adds up to 1 %


def test_the_quiet_cage_of_a_map_is_recommended(motions):
    """Only cages of the least friction are quiet; they have a tenth of the present cage's work.

    The sentence has the frictions of both cages, and the shares of their quiet and whirling runs
    [%]. Then it has the factor of the work with its interval.
    """
    assert numbers_in(quiet_region(motions)) == [90.0, 0.02]  # % of the runs, friction
    frictions, shares, factors = [0.02, 0.05], [100.0, 100.0], [10.0, 10.0, 10.0]
    assert numbers_in(cage_choice_sentence(motions)) == frictions + shares + factors


def test_a_cage_is_kept_if_no_quieter_one_is_in_the_map(motions):
    without_quiet = motions.sel(cage_friction=[0.05, 0.1])
    assert cage_choice_sentence(without_quiet).startswith("Keep ")
    assert numbers_in(quiet_region(without_quiet)) == []


def test_a_map_without_solved_runs_recommends_no_cage(motions):
    unsolved = motions.map(lambda values: values * np.nan).assign_attrs(motions.attrs)
    assert mapped_cages(unsolved) == []
    assert numbers_in(cage_choice_sentence(unsolved)) == []


def test_table_and_document_of_a_map_state_every_cage(map_file, motions):
    text = cage_table(map_file)
    assert cage_choice_sentence(motions) in text and quiet_region(motions) in text
    assert "nan" not in text
    rows = {row.label: row.values for row in cage_document(map_file).blocks[-1].rows}
    assert rows["runs"] == ("20",) * 6  # the least number of runs of an ensemble
    for friction, motion in zip(rows["friction"], rows["motions"], strict=True):
        expected = "whirls" if float(friction) >= QUIET_BELOW else "turns with the balls"
        assert motion.startswith(expected), friction


def test_a_map_is_drawn_and_shown_on_a_page(map_file, tmp_path):
    save(cage_figure(map_file), [tmp_path / "cage.svg", tmp_path / "cage.png"])
    (tmp_path / "answer.json").write_text(cage_answer(map_file), encoding="utf-8")
    assert page(answers=[tmp_path / "answer.json"]).count('id="answer-1"') == 1


def test_the_file_of_a_mapped_cage_contains_its_scene(plan, map_file):
    file = next(map_file.parent.glob("g9.81*-mu0.02.nc"))
    scene = json.loads(ensemble.load(file).attrs["scene"])
    changed = variant(scene_file(plan["scene"]), {"friction.cage": 0.02})
    assert scene["friction"] == changed.to_dict()["friction"]
    assert scene["operation"]["gravity_m_s2"] == [0.0, 0.0, -9.81]
