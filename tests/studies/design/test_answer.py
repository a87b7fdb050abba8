"""What the design study answers, and what other assumptions change in it."""

import json
import re

import numpy as np
import pytest
from small_study import CHOICE
from support import numbers_in, step

from bearingwear.document.document import Block, Row, load_document
from bearingwear.measures import LIMITED
from bearingwear.results.netcdf import load
from bearingwear.results.quantiles import RECOMMENDED, spread_of
from bearingwear.results.units import Rough, digits
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.read import scene_from_dict
from bearingwear.solvers.solve import solve
from bearingwear.studies.design.best import SIMILAR
from bearingwear.studies.design.choice import limit_margins, limits_of
from bearingwear.studies.design.document.charts import design_charts
from bearingwear.studies.design.document.sentences import recommended_points
from bearingwear.studies.design.document.sheets import NO_TOLERANCE, preload_document
from bearingwear.studies.design.document.words import AS_LITTLE, NO_LIMIT, NONE_BECAUSE
from bearingwear.studies.design.map import design_point

PLACE = "initial_axial_displacement"

POWER, STIFFNESS = "friction_power_W", "system_axial_stiffness_N_um"


@pytest.fixture(scope="module")
def files(small_project):
    """Map and recommendation."""
    names = ("design", "recommendation")
    return {name: small_project / CHOICE / f"{name}.nc" for name in names}


def sentences_of(answer) -> dict[str, str]:
    """Returns the sentences of an answer by the places of their blocks."""
    texts = {b.place: " ".join(b.lines) for b in answer.blocks if not b.rows}
    return {name: text.replace("\N{NO-BREAK SPACE}", " ") for name, text in texts.items()}


def tables_of(answer) -> dict[str, Block]:
    """Returns the tables of an answer by their places."""
    return {b.place: b for b in answer.blocks if b.rows}


def rows_of(table) -> dict[str, Row]:
    """Returns the rows of a table by their names."""
    return {row.name: row for row in table.rows}


def test_the_answer_is_that_of_the_files(files, tmp_path):
    path = tmp_path / "answer.json"
    assert step("studies.design.document.sheets.design_answer", path, **files) == 0
    answer, dataset = load_document(path), load(files["recommendation"])
    spring = float(dataset["life"][0])
    preload = float(dataset["preload"][0])
    assert "(constant force)" in answer.title
    assert numbers_in(answer.title) == [preload, 3.0, 30000.0]
    assert numbers_in(answer.heading[1]) == [30000.0, 0.08]
    sentences = sentences_of(answer)
    assert f"{digits(spring)} h" in sentences["verdict"]
    assert "temperature.inner_ring_C" in sentences["strip"]
    tables = tables_of(answer)
    recommended = rows_of(tables["open"])
    assert recommended["life"].values[0] == spring
    assert recommended["active_limit"].values[0] == LIMITED[STIFFNESS].words_of(
        "system_axial_stiffness", short=True
    )
    now, other_better = rows_of(tables["lead"])[f"limits.{STIFFNESS}"].values
    k = dataset["change"].attrs["flag_meanings"].split().index(f"limits.{STIFFNESS}")
    assert now == "3" and other_better == f"above {digits(float(dataset['other_better_above'][k]))}"
    assert len(tables["charted"].table[1]) == 2 * load(files["design"]).sizes["preload"]
    lines = [line for block in answer.blocks if block.place != "strip" for line in block.lines]
    assert len(lines) <= 3


def test_each_point_of_the_table_names_the_requirements_that_it_violates(files):
    design = load(files["design"])
    answer = preload_document(load(files["recommendation"]), design)
    for row in tables_of(answer)["charted"].table[1]:
        point = design.sel(preload=float(row[0])).isel(friction=0, shaft_speed=0)
        point = point.isel(preload_method=int(row[1] == "fixed position"))
        is_soft = float(point["system_axial_stiffness"]) < 3.0e6
        assert ("stiffness" in row[-1]) == is_soft


def test_the_table_has_the_units_of_the_requirements_and_says_why_a_life_is_zero(files):
    design = load(files["design"])
    design["life"][...] = 0.0
    design["friction_power"][...] *= 1e6
    answer = preload_document(load(files["recommendation"]), design)
    names, rows = tables_of(answer)["charted"].table
    (power,) = [k for k, name in enumerate(names) if name.startswith("friction power")]
    assert "(W)" in names[power] and float(rows[0][power]) > 1e3
    assert all("end-of-life criterion met when new" in row[-1] for row in rows)


def headline(files, change):
    """Title of an answer of which `change` alters the recommendation."""
    design, dataset = load(files["design"]), load(files["recommendation"])
    change(dataset, design)
    return preload_document(dataset, design).title.replace("\N{NO-BREAK SPACE}", " ")


def test_the_headline_states_what_less_preload_would_gain(files):
    """A longer life, hardly any, or nothing to say where no limit is given."""

    def at_the_end(found, design):
        ends = found.active_limit.attrs["flag_meanings"].split()
        found["active_limit"][...] = ends.index("end_of_range")
        found["preload"][...] = float(design["preload"].min())

    def plateau(found, design):
        at_the_end(found, design)
        found["beyond_preload"][...], found["beyond_life"][...] = 0.1, 1.04 * found["life"]

    def without_limits(found, _):
        found["life"][...] = np.nan
        found.attrs |= {"limits": "{}", NONE_BECAUSE: json.dumps({"fixed_position": NO_LIMIT})}

    at_end, on_plateau = headline(files, at_the_end), headline(files, plateau)
    assert "less preload" in at_end and "less preload" in on_plateau
    assert numbers_in(on_plateau)[-2:] == [4.0, 0.1]  # % of the life, at so many N
    advice = f"mine: {AS_LITTLE}"
    assert headline(files, without_limits) == advice


def test_a_fixed_position_is_set_by_an_offset(files):
    """Both bearings of the pair approach under the preload; at speed it is another."""
    design, dataset = load(files["design"]), load(files["recommendation"])
    dataset["life"][1] = 2.0 * float(dataset["life"][0])
    answer, preload = preload_document(dataset, design), float(dataset["preload"][1])
    sentences = sentences_of(answer)
    scene = scene_from_dict(json.loads(dataset.attrs["scene"]))
    offset = 2e6 * float(solve(held_by(scene, "fixed_position", preload)).values[PLACE])
    assert f"offset of {offset:.3g} µm" in sentences["lead"]
    assert "residual preload" in sentences["verdict"]  # which ends it
    assert 40.0 in numbers_in(sentences["verdict"])
    assert "at speed" not in answer.title
    dataset["residual_preload_at_start"][1] = 3.0 * preload
    assert f"({digits(3.0 * preload)} N at speed)" in preload_document(dataset, design).title


def test_the_preload_of_a_set_is_that_of_a_side_and_of_which_pair(files):
    """Two bearings and one: a pair with 0.736 times the preload of the side."""
    dataset = load(files["recommendation"])
    scene = json.loads(dataset.attrs["scene"])
    arrangement = {"kind": "rigid_pair", "orientation": "back_to_back", "tandem": [2, 1]}
    scene["operation"]["preload_method"] = "fixed_position"
    scene = scene_from_dict(scene | {"arrangement": arrangement})
    dataset.attrs["scene"] = json.dumps(scene.to_dict())
    for k in (0, 1):
        dataset["life"][k] = 2.0 * float(dataset["life"].max())
        words = sentences_of(preload_document(dataset))["lead"]
        preload = float(dataset["preload"][k])
        assert preload in numbers_in(words) and "on each side" in words
        of_pair = [n for n in numbers_in(words) if n == pytest.approx(0.736 * preload, rel=5e-3)]
        assert bool(of_pair) == (k == 1)  # spring bearings are not matched


def test_achieved_values_have_no_power_of_ten(files, tmp_path):
    dataset, changed = load(files["recommendation"]), tmp_path / "changed.nc"
    dataset["friction_power"][...] = 1234.0
    dataset.attrs["limits"] = json.dumps(json.loads(dataset.attrs["limits"]) | {POWER: 2000.0})
    dataset.to_netcdf(changed)
    design = load(files["design"])
    design.assign_attrs(limits=dataset.attrs["limits"]).to_netcdf(tmp_path / "design.nc")
    question = json.loads(design_charts(tmp_path / "design.nc", changed))["question"]
    assert "1230 W" in question.replace("\N{NO-BREAK SPACE}", " ")


def test_the_chart_of_life_has_the_required_life(files, tmp_path):
    """In hours, as its lines; the stiffness beside it is in N/um."""
    required = {"life_h": 1.5, STIFFNESS: 3.0}
    for name, path in files.items():
        changed = load(path).assign_attrs(limits=json.dumps(required))
        changed.to_netcdf(tmp_path / f"{name}.nc")
    charts = json.loads(design_charts(*(tmp_path / f"{name}.nc" for name in files)))["charts"]
    limits = {chart["title"]: (chart["limit"], chart["at_least"]) for chart in charts}
    assert limits["Life versus initial preload"] == (1.5, True)
    assert (3.0, True) in [limits[title] for title in limits if "tiffness" in title]


def test_a_method_without_a_preload_has_no_groove_model(files):
    dataset = load(files["recommendation"])
    dataset["life"][1] = np.nan
    (table,) = [b for b in preload_document(dataset).blocks if b.title == "recommended"]
    first, second = rows_of(table)["groove"].values
    assert first and not second


def test_a_tolerance_that_was_not_sought_says_so(files):
    """Only the longest life has one; a method without a preload has none to seek."""
    dataset = load(files["recommendation"])
    dataset["least_preload"][1] = dataset["most_preload"][1] = np.nan

    def limits_of_second():
        (table,) = [b for b in preload_document(dataset).blocks if b.title == "recommended"]
        return [rows_of(table)[name].values[1] for name in ("least_preload", "most_preload")]

    assert limits_of_second() == [NO_TOLERANCE] * 2
    dataset["preload"][1] = np.nan
    assert np.isnan(limits_of_second()).all()


@pytest.mark.parametrize("ratio, is_stated", [(0.99, True), (0.5, False)])
def test_another_method_with_about_the_same_life_is_stated(files, ratio, is_stated):
    dataset = load(files["recommendation"])
    dataset["life"][1] = ratio * float(dataset["life"][0])
    verdict = sentences_of(preload_document(dataset))["verdict"]
    assert ("gives the same life" in verdict) == is_stated
    assert (float(dataset["preload"][1]) in numbers_in(verdict)) == is_stated


def test_one_preload_is_specified_with_a_tolerance_that_keeps_the_requirements(files):
    """Title, offset and tolerance have the recommended preload; both ends are solved once more."""
    dataset = load(files["recommendation"])
    name, best, life = recommended_points(dataset)[0]
    low, high = float(best["least_preload"]), float(best["most_preload"])
    assert low <= float(best["preload"]) <= high and low < high
    scene, limits = scene_from_dict(json.loads(dataset.attrs["scene"])), limits_of(dataset)
    for preload in (low, high):
        point = design_point(held_by(scene, name, preload), limits)
        assert min(map(float, limit_margins(point, limits))) >= 0.0
        assert point["life"] / 3600.0 >= SIMILAR * life
    text = f"{float(best['preload']):.7g} N"
    answer = preload_document(dataset)
    assert text in answer.title
    specified, plus, minus, least, most, share = numbers_in(sentences_of(answer)["lead"])[:6]
    assert specified == float(best["preload"]) and share == 100.0 * SIMILAR
    assert [digits(least), digits(most)] == [digits(low), digits(high)]
    assert [specified + plus, specified - minus] == pytest.approx([most, least])
    # a spacer that is off by its tolerance stays within the range
    dataset["life"][1] = 2.0 * float(dataset["life"][0])
    preload = float(dataset["preload"][1])
    dataset["least_preload"][1], dataset["most_preload"][1] = preload, 1.5 * preload
    sentence = sentences_of(preload_document(dataset))["lead"]
    offset, plus, minus = re.search(r"(\S+) µm.*\+(\S+)/−(\S+) µm", sentence).groups()
    most = 2e6 * float(solve(held_by(scene, "fixed_position", 1.5 * preload)).values[PLACE])
    middle = 2e6 * float(solve(held_by(scene, "fixed_position", preload)).values[PLACE])
    assert float(offset) == pytest.approx(middle, rel=5e-3)
    assert minus == "0" and 0.9 * (most - middle) < float(plus) <= most - middle


def test_hours_of_a_calibrated_scene_are_stated(files):
    """With the interval that the tests leave; hours of another scene only compare designs."""
    design, dataset = load(files["design"]), load(files["recommendation"])
    scene = json.loads(dataset.attrs["scene"])
    scene["uncertainty"] = {"wear_coefficient": {"distribution": "lognormal", "factor": 1.5}}
    life = float(dataset["life"].max())
    ends = [Rough(life * 1.5**z).text for z in (-1.6449, 1.6449)]
    calibration = {"calibrated": {"tests": "mine.csv", "sha256": 64 * "0", "rows": 2}}
    for is_calibrated, block in ((False, {}), (True, calibration)):
        dataset.attrs["scene"] = json.dumps(scene | block)
        sentences = sentences_of(preload_document(dataset, design))
        assert f"{ends[0]} to {ends[1]} h" in sentences["verdict"]
        assert ("comparison" in sentences["lead"]) != is_calibrated
        assert ("2 tests (mine.csv)" in sentences["lead"]) == is_calibrated


def test_the_spread_is_that_of_the_recommended_preload(files, small_project, tmp_path):
    """Lives are sampled about the preload to take, not about the scene's own."""
    path, own = tmp_path / "spread.nc", tmp_path / "own.nc"
    scene, settings = small_project / "mine.yaml", {"samples": 16, "seed": 1}
    run = "studies.uncertainty.quantiles"
    inputs = {"scene": scene, "recommendation": files["recommendation"]}
    assert step(f"{run}.recommended_life_quantiles", path, settings=settings, **inputs) == 0
    assert step(f"{run}.uncertain_lives", own, settings=settings, scene=scene) == 0
    spread, dataset = load(path), load(files["recommendation"])
    preloads = spread["preload"].values.ravel().tolist()
    assert preloads == dataset["preload"].values.tolist()
    nominal = spread["nominal_life"].values.ravel()
    assert nominal == pytest.approx(dataset["life"].values, rel=0.02)
    median = spread["life_quantile"].isel(uncertain_inputs=0, preload_method=0)
    median = median.squeeze("preload_choice")
    at_own = load(own)["life_quantile"].isel(uncertain_inputs=0)
    # 4.1 N in place of 7 N: half as long again
    assert float(median.sel(probability=0.5)) > 1.3 * float(at_own.sel(probability=0.5).squeeze())
    answer = tmp_path / "answer.json"
    run = "studies.design.document.sheets.design_answer"
    assert step(run, answer, **files, spread=path) == 0
    rows = {row[0]: row[1:] for row in tables_of(load_document(answer))["open"].table[1]}
    mine = json.loads(spread.attrs["scene"])
    spread_in_file = spread_of([spread], mine, "constant_force", 0.08, RECOMMENDED)
    assert rows["90 % of bearings (h)"][0] == spread_in_file.bearings.text
    assert {
        f"{name} (h)": Rough(hours).text for name, hours in spread_in_file.quantiles.items()
    } == {
        name: row[0]
        for name, row in rows.items()
        if name in ("L10 of the median batch (h)", "L50 of the median batch (h)")
    }


def test_without_a_recommendation_no_life_is_sampled(files, small_project, tmp_path):
    """A study whose limits nothing keeps to still ends with its answer."""
    none, path, answer = (tmp_path / name for name in ("none.nc", "spread.nc", "answer.json"))
    dataset = load(files["recommendation"])
    for name in ("life", "preload"):
        dataset[name][...] = np.nan
    dataset.to_netcdf(none)
    inputs = {"scene": small_project / "mine.yaml", "recommendation": none}
    run = "studies.uncertainty.quantiles.recommended_life_quantiles"
    assert step(run, path, settings={"samples": 16, "seed": 1}, **inputs) == 0
    assert load(path).sizes["preload_method"] == 0
    inputs = {"design": files["design"], "recommendation": none, "spread": path}
    assert step("studies.design.document.sheets.design_answer", answer, **inputs) == 0
    assert load_document(answer).title.startswith("mine: no preload")
