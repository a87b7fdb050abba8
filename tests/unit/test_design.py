"""The design study: its plan, uncertain values, the choice of a preload, and its commands."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from numpy.testing import assert_allclose
from support import ROOT, scene_file

from bearingwear.cli import main
from bearingwear.io.config import SceneError, load_scene, scene_from_dict
from bearingwear.io.netcdf import load
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.model import parameters
from bearingwear.model.sampled import sampled
from bearingwear.study.check import check_scene
from bearingwear.study.design import ACTIVE, chosen, front
from bearingwear.study.design_plan import DesignPlan, Limits, design_scene
from bearingwear.study.uncertainty import value_at

PLAN_FILE = ROOT / "config" / "design.yaml"
NOT_CONVERGED, BEYOND_GROOVE = (STATUS_NAMES.index(n) for n in ("not_converged", "beyond_groove"))
METHODS = ("constant_force", "fixed_position")


@pytest.fixture
def scene():
    return load_scene(scene_file("gyro_s1"))


# the plan


def test_plan_of_the_project():
    plan = DesignPlan.from_file(PLAN_FILE)
    plan.check_scenes(ROOT / "config" / "scenes")
    for name, of in plan.scenes.items():
        scene = load_scene(scene_file(name))
        assert of.lives >= 20_000
        assert scene.operation.preload_N in of.preload_N
        assert scene.friction.ball_race in of.friction
        assert scene.operation.shaft_speed_rpm in of.shaft_speed_rpm
        assert plan.sampling.samples * (len(scene.uncertainty) + 2) >= 10_000


@pytest.mark.parametrize(
    "path, value, told",
    [
        ("scenes.gyro_s1.map.friction.step", 0.07, "given 0.02 to 0.17 by 0.07"),
        ("scenes.gyro_s1.map.preload_N", [2.0, 1.0], "allowed rising numbers > 0"),
        ("scenes.gyro_s1.map.preload_method", ["spring"], "allowed constant_force"),
        ("scenes.gyro_s1.limits.pressure", 1.0, "limits.pressure: unknown key"),
        ("scenes.gyro_s1.limits.friction_power_W", "much", "given much; allowed a number > 0"),
        ("uncertainty.samples", 1000, "allowed a power of two"),
        ("uncertainty.seed", -1, "allowed a whole number >= 0"),
        ("family.statements.preload_loss", 0, "preload_loss: given 0; allowed a number > 0"),
    ],
)
def test_bad_plan_takes_one_line(tmp_path, path, value, told):
    data = yaml.safe_load(PLAN_FILE.read_text())
    *blocks, last = path.split(".")
    block = data
    for name in blocks:
        block = block[name]
    block[last] = value
    (tmp_path / "plan.yaml").write_text(yaml.safe_dump(data))
    with pytest.raises(ValueError) as error:
        DesignPlan.from_file(tmp_path / "plan.yaml")
    assert told in str(error.value) and "\n" not in str(error.value)


# uncertain values in a scene


@pytest.mark.parametrize(
    "spread, told",
    [
        ({"ball_race": {"distribution": "normal"}}, "ball_race.standard_deviation: given nothing"),
        ({"ball_race": {"distribution": "uniform", "low": 0.2, "high": 0.1}}, "ball_race.high"),
        ({"ball_race": {"distribution": "uniform", "low": -0.2, "high": 0.1}}, "ball_race.low"),
        ({"ball_race": {"distribution": "lognormal", "factor": 1.0}}, "ball_race.factor"),
        (
            {"ball_race": {"distribution": "normal", "standard_deviation": 0.1, "factor": 2.0}},
            "ball_race.factor: given 2 with the distribution normal",
        ),
        ({"speed": {"distribution": "uniform", "low": 1.0, "high": 2.0}}, "given the name 'speed'"),
    ],
)
def test_bad_uncertainty_takes_one_line(scene, spread, told):
    with pytest.raises(SceneError) as error:
        scene_from_dict(scene.to_dict() | {"uncertainty": spread})
    assert told in str(error.value) and "\n" not in str(error.value)


def test_lognormal_about_nothing_is_no_design(tmp_path):
    plain = yaml.safe_load(scene_file("gyro_s1").read_text())
    plain["uncertainty"] = {"drag_density_kg_m3": {"distribution": "lognormal", "factor": 2.0}}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(plain))
    assert load_scene(tmp_path / "scene.yaml", ["friction.ball_race=0"]).uncertainty
    with pytest.raises(ValueError, match="drag_density_kg_m3.median: given 0"):
        design_scene(tmp_path / "scene.yaml")


def test_quantiles_of_the_values(scene):
    p = np.array([0.1, 0.5, 0.9])
    assert_allclose(value_at(scene, "preload_N", p), 7.0 + 0.35 * 1.2815516 * np.array([-1, 0, 1]))
    middle = value_at(scene, "wear_coefficient", p)
    assert_allclose(middle[1], 5e-6)
    assert_allclose(middle[2] / middle[1], 3.0**1.2815516)
    assert_allclose(value_at(scene, "brinell_hardness_GPa", p), [6.44, 6.6, 6.76])


def test_impossible_values_are_cut_off(scene):
    wide = {"inner_groove_factor": {"distribution": "normal", "standard_deviation": 0.5}}
    scene = scene_from_dict(scene.to_dict() | {"uncertainty": wide})
    values = value_at(scene, "inner_groove_factor", np.linspace(0.0, 1.0, 11))
    assert values.min() >= 0.5 and values.max() <= 1.0 and np.all(np.diff(values) > 0.0)


def test_other_balls_between_the_same_grooves(scene):
    before = parameters.geometry(scene)
    after = parameters.geometry(sampled(scene, {"ball_diameter_mm": 2.0005}))
    assert after.D0 == pytest.approx(2.0005e-3)
    for name in ("r_i", "r_o", "R_i", "R_o"):
        assert getattr(after, name) == pytest.approx(getattr(before, name), rel=1e-12)
    distance = [g.BD * math.cos(g.alpha0) for g in (before, after)]
    assert distance[0] == pytest.approx(distance[1], rel=1e-12)
    assert after.alpha0 < before.alpha0
    assert sampled(scene, {"ball_diameter_mm": 2.1}) is None


def test_wear_values_of_both_materials_go_together(scene):
    steel = scene.materials["bearing_steel"]
    materials = dict(scene.materials) | {"ceramic": replace(steel, wear_coefficient=1e-6)}
    hybrid = replace(
        scene, materials=materials, bearing=replace(scene.bearing, ball_material="ceramic")
    )
    other = sampled(hybrid, {"wear_coefficient": 1e-5})
    assert other.materials["bearing_steel"].wear_coefficient == 1e-5
    assert other.materials["ceramic"].wear_coefficient == pytest.approx(2e-6)
    assert other.materials["phenolic"] == scene.materials["phenolic"]


# the choice


def made_up(lives, stiffness, status=None):
    """A line of a map of one method."""
    n = len(lives)
    status = np.zeros(n, dtype=np.int8) if status is None else np.array(status, dtype=np.int8)
    lives = np.where(status == 0, lives, np.nan)
    return xr.Dataset(
        {
            "status": ("preload", status),
            "life": (("preload", "counts"), np.stack([10.0 * lives, lives], axis=-1)),
            "axial_stiffness": ("preload", 1e6 * np.asarray(stiffness)),
            "friction_power": ("preload", 0.1 * np.arange(1.0, n + 1)),
        },
        {"preload": np.arange(1.0, n + 1)},
    )


STIFF = Limits(axial_stiffness_N_um=2.5)


@pytest.mark.parametrize(
    "line, limits, index, active",
    [
        (made_up([9, 8, 7, 6], [1, 2, 3, 4]), STIFF, 2, "axial_stiffness_N_um"),
        (made_up([9, 8, 7, 6], [1, 2, 3, 4]), Limits(friction_power_W=1.0), 0, "end_of_range"),
        (made_up([5, 8, 7, 6], [1, 2, 3, 4]), Limits(), 1, "none"),
        (made_up([1, 2, 3, 4], [1, 2, 3, 4]), Limits(friction_power_W=0.25), 1, "friction_power_W"),
        (made_up([9, 8, 7, 6], [1, 2, 2, 2]), STIFF, -1, "no_preload_within_limits"),
        (made_up([9, 8, 7, 6], [3, 3, 3, 4], [0, 1, 0, 0]), Limits(), 0, "not_solved"),
        (made_up([9, 8, 7, 6], [3, 3, 3, 4], [1, 1, 0, 0]), STIFF, 2, "not_solved"),
    ],
)
def test_choice_and_what_holds_it(line, limits, index, active):
    found, held = chosen(line, limits, counts=1)
    assert int(found) == index
    assert ACTIVE[int(held)] == active


def test_front_leaves_out_what_is_beaten_or_unsolved():
    line = made_up([9, 8, 7, 6, 5], [1, 3, 2, 4, 5], [0, 0, 0, NOT_CONVERGED, 0])
    assert front(line, 1).values.tolist() == [True, True, False, False, True]


# the commands, on a map of a few lives


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("design")
    plan = yaml.safe_load(PLAN_FILE.read_text())
    plan["scenes"]["gyro_s1"]["map"] |= {
        "friction": [0.08],
        "shaft_speed_rpm": [30000],
        "preload_N": [3.0, 5.0, 7.0, 9.0, 11.0],
    }
    plan["uncertainty"] = {"samples": 4, "chunks": 2, "seed": 3}
    (folder / "plan.yaml").write_text(yaml.safe_dump(plan))
    run(folder)
    return folder


def run(folder):
    """The whole design study by its commands."""
    scene, plan = str(scene_file("gyro_s1")), ["--plan", str(folder / "plan.yaml")]

    def path(name):
        return str(folder / name)

    parts, samples = [], []
    for method in ("constant_force", "fixed_position"):
        parts.append(path(f"{method}.nc"))
        given = ["--method", method, "--friction", "0.08", "-o", parts[-1]]
        assert main(["design-map", scene, *plan, *given]) == 0
    assert main(["gather-design", *parts, "-o", path("design.nc")]) == 0
    assert main(["recommend", scene, path("design.nc"), "-o", path("recommendation.nc")]) == 0
    for method in ("constant_force", "fixed_position"):
        for option in ([], ["--recommendation", path("recommendation.nc")]):
            for chunk in "01":
                samples.append(path(f"{method}-{len(option)}-{chunk}.nc"))
                given = ["--method", method, "--chunk", chunk, *option, "-o", samples[-1]]
                assert main(["sample-lives", scene, *plan, *given]) == 0
    assert main(["spread", scene, *samples, *plan, "-o", path("uncertainty.nc")]) == 0


def test_recommended_preload_stands_on_its_limit(folder):
    found = load(folder / "recommendation.nc")
    assert found["status"].values.tolist() == [0, 0]
    for k in range(2):
        one = found.isel(preload_method=k)
        assert ACTIVE[int(one["active_limit"])] == "axial_stiffness_N_um"
        assert float(one["axial_stiffness"]) == pytest.approx(3.0e6, rel=2e-5)
        assert float(one["axial_stiffness"]) >= 3.0e6
        assert float(one["gyroscopic_slip_share"]) <= 0.25
        assert 0.0 < float(one["life_error_estimate"][1]) < 0.1
    # no preload of the map within the limits lives longer
    design = load(folder / "design.nc")
    assert np.all(found["life"].values >= design["recommended_life"].values[:, 0, 0])


def test_figures_and_tables_are_drawn(folder):
    files = [str(folder / f"{name}.nc") for name in ("design", "recommendation", "uncertainty")]
    for which in ("design", "map", "uncertainty"):
        out = folder / f"{which}.svg"
        assert main(["figure", "design", which, *files, "-o", str(out)]) == 0
        assert out.stat().st_size > 10_000
    tables = [str(folder / "map.csv"), str(folder / "design.md")]
    assert main(["tables-design", *files, "-o", *tables]) == 0
    text = (folder / "design.md").read_text()
    assert "held by axial stiffness" in text and "| ok | 10 |" in text
    assert len((folder / "map.csv").read_text().splitlines()) == 11
    assert main(["figure", "design", "other", *files, "-o", str(folder / "x.svg")]) == 2
    assert main(["tables-design", *reversed(files), "-o", *tables]) == 2


def changed(path, target, **values):
    """A case file with other numbers."""
    case = load(path)
    for name, value in values.items():
        case[name] = case[name] * 0 + value if name == "status" else case[name] * value
    case.to_netcdf(target)
    return str(target)


def test_recommended_preload_in_time(folder, tmp_path, capsys):
    """Without a cage, motion in time stays in the steady state that the map is made of."""
    recommendation = str(folder / "recommendation.nc")
    found = load(recommendation)
    longest = int(np.argmax(found["life"].values[:, 1]))
    cases = []
    for times in ("0.80", "1.00", "1.25"):
        path = tmp_path / f"{times}.yaml"
        given = [str(scene_file("gyro_s1")), recommendation, "--times", times]
        assert main(["check-scene", *given, "-o", str(path)]) == 0
        plain = yaml.safe_load(path.read_text())
        preload = float(found["preload"][longest])
        assert plain["operation"]["preload_N"] == pytest.approx(float(times) * preload, rel=1e-12)
        assert plain["operation"]["preload_method"] == METHODS[longest]
        assert load_scene(path).cage is not None
        path.write_text(yaml.safe_dump({k: v for k, v in plain.items() if k != "cage"}))
        for tier in ("steady", "dynamic"):
            cases.append(str(tmp_path / f"{times}-{tier}.nc"))
            assert main(["solve", str(path), "--fidelity", tier, "-o", cases[-1]]) == 0
    out = tmp_path / "check.md"

    def table(*paths):
        assert main(["tables-check", recommendation, *paths, "-o", str(out)]) == 0
        return out.read_text()

    text = table(*cases)
    assert "The dynamic tier agrees with the steady values of the map within" in text
    assert text.count("| no |") == 9 and "| yes |" not in text
    for steady, dynamic in zip(map(load, cases[::2]), map(load, cases[1::2]), strict=True):
        assert_allclose(dynamic["total_qv"], steady["total_qv"], rtol=1e-9)
    # and the table sees where it does not
    beyond = 1.0 + 2.0 * float(load(cases[0])["qv_error_estimate"]) + 0.01
    text = table(*cases[:-1], changed(cases[-1], tmp_path / "qv.nc", total_qv=beyond))
    assert "agrees with the steady values of the map in part" in text
    assert "Beyond them: QV of the bearing by +" in text and text.count("| yes |") == 1
    failed = changed(cases[-1], tmp_path / "failed.nc", status=NOT_CONVERGED)
    text = table(*cases[:-1], failed)
    assert "Not solved: dynamic at" in text and "not converged" in text
    capsys.readouterr()
    for wrong in ([*cases[:-1]], [recommendation], [*cases, str(folder / "design.nc")]):
        assert main(["tables-check", recommendation, *wrong, "-o", str(out)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 3


def test_nothing_recommended_is_checked_at_the_scene_s_own_preload(scene, folder):
    none = load(folder / "recommendation.nc")
    none["life"] *= math.nan
    none["preload"] *= math.nan
    checked = check_scene(scene, none, 0.8)
    assert checked.operation.preload_N == pytest.approx(0.8 * scene.operation.preload_N)
    assert checked.operation.preload_method == scene.operation.preload_method


def test_every_status_is_counted(folder, tmp_path):
    """Lives that were not solved keep their status, in the map, the CSV and the table."""
    design = load(folder / "design.nc")
    assert int(design["solves"].min()) >= 5 and int(design["failed_solves"].min()) >= 0
    design["status"].values[0, 0, 0, :2] = NOT_CONVERGED, BEYOND_GROOVE
    design.to_netcdf(tmp_path / "design.nc")
    files = [str(tmp_path / "design.nc")]
    files += [str(folder / f"{name}.nc") for name in ("recommendation", "uncertainty")]
    out = [str(tmp_path / "map.csv"), str(tmp_path / "design.md")]
    assert main(["tables-design", *files, "-o", *out]) == 0
    text = (tmp_path / "design.md").read_text()
    for name, count in (("ok", 8), ("not_converged", 1), ("beyond_groove", 1)):
        assert f"| {name} | {count} |" in text
        assert (tmp_path / "map.csv").read_text().count(f",{name},") == count
    solves = int(design["solves"].sum())
    assert (
        f"10 lives over preload, method, friction and speed (`map.csv`), made of {solves}" in text
    )


def test_answer_stands_first(folder):
    """Preload, method, life with its spread and the active limit, in the first sentence."""
    files = [str(folder / f"{name}.nc") for name in ("design", "recommendation", "uncertainty")]
    out = [str(folder / "map.csv"), str(folder / "design.md")]
    assert main(["tables-design", *files, "-o", *out]) == 0
    first = (folder / "design.md").read_text().split("\n\n")[1].partition(". ")[0]
    found = load(folder / "recommendation.nc").isel(preload_method=0)
    spread = load(folder / "uncertainty.nc").isel(preload_method=0, at=1, of=0, counts=1)
    l10, l50 = (float(q) for q in spread["life_quantile"][:2])
    assert f"constant force at {float(found['preload']):.3g} N" in first
    assert f"{float(found['life'][1]):.3g} h (L10 {l10:.2g} h, L50 {l50:.2g} h)" in first
    assert first.endswith("held by axial stiffness")


def test_parts_of_other_plans_are_refused(folder, tmp_path, capsys):
    scene = str(scene_file("gyro_s1"))
    design, out = str(folder / "design.nc"), str(tmp_path / "out.nc")
    assert main(["gather-design", design, str(folder / "recommendation.nc"), "-o", out]) == 2
    assert main(["recommend", str(scene_file("gyro_s2")), design, "-o", out]) == 2
    part = str(folder / "constant_force-0-0.nc")
    plan = ["--plan", str(folder / "plan.yaml")]
    assert main(["spread", scene, part, *plan, "-o", out]) == 2
    assert main(["spread", scene, part, "--plan", str(PLAN_FILE), "-o", out]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 4 and "parts missing" in lines[2]


@pytest.mark.parametrize(
    ("option", "said"),
    [
        (["--samples", "100"], "--samples: given 100; allowed a power of two"),
        (["--samples", "0"], "--samples: given 0; allowed a whole number >= 1"),
        (["--seed", "-1"], "--seed: given -1; allowed a whole number >= 0"),
    ],
)
def test_samplings_that_are_refused(option, said, tmp_path, capsys):
    out = tmp_path / "out.nc"
    assert main(["life-spread", str(scene_file("gyro_s1")), *option, "-o", str(out)]) == 2
    assert capsys.readouterr().err.strip() == said and not out.exists()
