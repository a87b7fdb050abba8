"""The study's grid and plan: names of cases, and what is refused."""

import copy

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from support import ROOT, scene_file

from bearingwear.scene.read import variant
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid.grid import Case, Grid
from bearingwear.studies.grid.plan import Plan
from bearingwear.studies.grid.study import GridStudy
from bearingwear.studies.protocol import Bundle

CONFIG = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))


def drawn(plan):
    jobs = GridStudy(plan).jobs
    return [path for job in jobs if isinstance(job, Bundle) for path in job.outputs]


def figures_of(plan):
    return [path for path in drawn(plan) if path.endswith((".svg", ".png"))]


def test_id_of_a_case():
    assert Case("constant_force", 0.0125, 0.005).id == "constant_force-mu0.0125-loss0.005"
    case = Case("fixed_position", 0.08, 0.5)
    assert case.id == "fixed_position-mu0.080-loss0.50"
    assert case.changes == {
        "operation.preload_method": "fixed_position",
        "friction.ball_race": 0.08,
        "wear.ball_diameter_loss_um": 0.5,
    }


@given(
    mus=st.lists(st.integers(0, 2000), min_size=1, max_size=5, unique=True),
    losses=st.lists(st.integers(0, 5000), min_size=1, max_size=5, unique=True),
)
def test_ids_are_unique_and_say_the_case(mus, losses):
    grid = Grid.from_lists(PRELOAD_METHODS, [k / 1e4 for k in mus], [k / 1e3 for k in losses])
    cases = grid.cases()
    assert len(cases) == 2 * len(mus) * len(losses)
    for case in cases.values():
        method, friction, loss = case.changes.values()
        assert Case(method, float(friction), float(loss)) == case


@pytest.mark.parametrize(
    ("methods", "mus", "losses", "said"),
    [
        (["constant_force"], [0.1 + 0.2], [0.0], "friction: got 0.30000000000000004"),
        (["constant_force"], [-0.1], [0.0], "friction: got -0.1"),
        (["constant_force"], [float("nan")], [0.0], "friction: got nan"),
        (["constant_force"], [0.1], [1 / 3], "ball_diameter_loss_um: got 0.333"),
        (["constant_force"], [0.1, 0.1], [0.0], "expected each value once"),
        (["constant_force"], [], [0.0], "friction: got no value, expected at least one"),
        (["rigid"], [0.1], [0.0], "preload_method: got rigid"),
    ],
)
def test_grids_that_are_refused(methods, mus, losses, said):
    with pytest.raises(ValueError, match="^[^\n]*$") as error:
        Grid.from_lists(methods, mus, losses)
    assert said in str(error.value)


def test_a_scene_is_studied_once():
    study = {**CONFIG["studies"][0], "scenes": ["gyro_s1"]}
    with pytest.raises(ValueError, match=r"studies\[1\].scenes: got gyro_s1"):
        Plan.from_config(CONFIG | {"studies": [study, study], "dynamic": []}).cases()


def test_jobs_of_a_grid():
    """A line a job; parts of it; or chunks of whole lines, which name every case once."""
    grid = Plan.from_config(CONFIG).grids["gyro_s1"]
    assert Plan.from_config(CONFIG).losses_of_jobs(grid) == [grid.ball_diameter_loss_um]
    parts = Plan.from_config(CONFIG | {"points_per_job": 3}).losses_of_jobs(grid)
    assert [len(part) for part in parts] == [3, 3, 2]
    chunked = Plan.from_config(CONFIG | {"points_per_job": 31})
    chunks = chunked.chunks("gyro_s1")
    assert [len(lines) for lines in chunks.values()] == [3, 3, 2]
    assert tuple(line for lines in chunks.values() for line in lines) == grid.lines()
    assert chunked.solved("gyro_s1") == list(chunks)


def test_a_chunk_is_named_by_its_points():
    names = set()
    for friction in ([0.02, 0.05, 0.08, 0.11], [0.02, 0.05, 0.08, 0.12]):
        block = {**CONFIG["studies"][0], "scenes": ["gyro_s1"], "friction": friction}
        figures = {"worn_loss_um": 0.5, "friction": [0.02]}
        plan = Plan.from_config({"studies": [block], "figures": figures, "points_per_job": 32})
        names |= set(plan.chunks("gyro_s1"))
        (first, _) = plan.chunks("gyro_s1")
        assert plan.refused(first) is None
    assert len(names) == 4
    assert "not in config.yaml" in str(plan.refused("results/gyro_s1/chunks/99999-01234567.nc"))


def test_jobs_of_scenes_have_names_of_their_own(monkeypatch):
    """Whatever scenes are called, no two rules have one name."""
    monkeypatch.setattr(Plan, "bearings", lambda *_: (None,))  # there are no such files
    scenes = ["across", "x", "dynamic_x", "dynamic_drawn_x"]
    block = {**CONFIG["studies"][0], "scenes": scenes}
    in_time = {**CONFIG["dynamic"][0], "scenes": scenes}
    column = {"scene": "x", "friction": 0.02}
    figures = {"worn_loss_um": 0.5, "friction": [0.02], "wear_columns": [column]}
    plan = Plan.from_config({"studies": [block], "dynamic": [in_time], "figures": figures})
    names = [job.name for job in GridStudy(plan).jobs if isinstance(job, Bundle)]
    assert len(set(names)) == len(names) == 9


@pytest.mark.parametrize("name", ["my spindle", "a/b", "-a", "", "a.b", 7008, None])
def test_names_that_no_scene_has(name):
    """One rule, in words, and how a number is written as a name."""
    studies = [{**CONFIG["studies"][0], "scenes": [name]}]
    with pytest.raises(ValueError, match="^[^\n]*$") as error:
        Plan.from_config(CONFIG | {"studies": studies})
    assert "studies[0].scenes[0]: got " in str(error.value)
    assert "expected a-z, A-Z, 0-9, _ and - (at most 64" in str(error.value)
    assert ('write "7008"' in str(error.value)) == (name == 7008)


@pytest.mark.parametrize(
    ("column", "said"),
    [
        ({"scene": "other", "friction": 0.02}, "got scene other, expected gyro_s1"),
        ({"scene": "gyro_s1", "friction": 0.03}, "got gyro_s1, friction 0.03, expected 0.02"),
    ],
)
def test_a_figure_of_what_is_not_studied(column, said):
    config = copy.deepcopy(CONFIG)
    config["figures"]["wear_columns"] = [column]
    with pytest.raises(ValueError, match="^config: figures.wear_columns: [^\n]*$") as error:
        Plan.from_config(config)
    assert said in str(error.value)


def dynamic_config(**changes):
    """The project's configuration with one block under `dynamic`, changed."""
    block = {**CONFIG["dynamic"][0], **changes}
    figures = {key: value for key, value in CONFIG["figures"].items() if key != "running_averages"}
    return {"studies": CONFIG["studies"], "dynamic": [block], "figures": figures}


def test_plan_of_what_is_solved_in_time():
    plan = Plan.from_config(CONFIG)
    assert len(plan.dynamic["gyro_s1"].cases()) == 12
    assert list(plan.dynamic["turbine"].cases()) == ["constant_force-mu0.090-loss0.00"]
    assert plan.compared == ["gyro_s1"]  # the turbine has no steady state to be compared with
    figures = figures_of(plan)
    assert "results/gyro_s1/figures/dynamic.png" in figures
    assert "results/turbine/figures/dynamic.png" not in figures
    name = "fig06_running_average-constant_force-mu0.090-loss0.00"
    assert f"results/turbine/figures/{name}.svg" in figures
    assert "results/gyro_s1/tables/dynamic.md" in drawn(plan)
    assert plan.reference("turbine") == ["config/reference/gupta_no2.csv"]
    assert plan.reference("gyro_s1") == []


def test_settings_of_what_is_solved_in_time():
    plan = Plan.from_config(dynamic_config(model={"simulated_turns": 50, "tolerance": 1e-5}))
    case = plan.dynamic["gyro_s1"].cases()["fixed_position-mu0.020-loss0.00"]
    changes = plan.dynamic_changes("gyro_s1", case)
    assert changes == case.changes | {"model.simulated_turns": 50, "model.tolerance": 1e-5}
    model = variant(scene_file("gyro_s1"), changes).model
    assert (model.simulated_turns, model.tolerance) == (50.0, 1e-5)
    plan = Plan.from_config(dynamic_config(model={}))
    assert plan.dynamic_changes("gyro_s1", case) == case.changes


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"friction": [0.03]}, "dynamic: got gyro_s1, constant_force-mu0.030-loss0.00, expected"),
        ({"friction": [1 / 3]}, "dynamic[0].friction: got 0.333"),
        ({"scenes": ["turbine", "turbine"]}, "dynamic[0].scenes: got turbine twice"),
    ],
)
def test_what_cannot_be_solved_in_time(changes, said):
    with pytest.raises(ValueError, match="^config: [^\n]*$") as error:
        Plan.from_config(dynamic_config(**changes))
    assert said in str(error.value)


def test_the_smallest_configuration():
    axes = {"preload_method": ["fixed_position"], "friction": [0.05], "ball_diameter_loss_um": [0]}
    plan = Plan.from_config({"studies": [{"scenes": ["gyro_s1"], **axes}]})
    assert plan.worn_loss_um == 0.0 and plan.frictions("gyro_s1") == [0.05]
