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
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.read import scene_from_dict
from bearingwear.solvers.solve import solve
from bearingwear.studies.design.best import SIMILAR
from bearingwear.studies.design.choice import limit_margins, limits_of
from bearingwear.studies.design.document.charts import design_charts
from bearingwear.studies.design.document.sentences import recommended_points
from bearingwear.studies.design.document.sheets import (
    NO_TOLERANCE,
    preload_document,
    violated_words,
)
from bearingwear.studies.design.document.words import AS_LITTLE, NO_LIMIT, NONE_BECAUSE
from bearingwear.studies.design.map import design_point

PLACE = "initial_axial_displacement"
"""Approach of the rings of a bearing under its preload when mounted [m], in values of a solve."""

POWER, STIFFNESS = "friction_power_W", "system_axial_stiffness_N_um"


@pytest.fixture(scope="module")
def files(small_project):
    """Returns the paths of the map (`design`) and of the `recommendation` of the small study.

    tests/small_study.py has its limits: 3 N/um and a gyroscopic slip share of 0.25. Preload methods
    are constant force (0) and fixed position (1).
    """
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


def test_the_answer_has_the_numbers_of_the_files(files, tmp_path):
    """The title, the sentences and three tables have them. Tables are named by their places.

    Table `open` is the recommendation, `lead` what would change the choice of method, `charted` the
    points of the map. The small study recommends a constant force.
    """
    path = tmp_path / "answer.json"
    assert step("studies.design.document.sheets.design_answer", path, **files) == 0
    answer, dataset = load_document(path), load(files["recommendation"])
    life = float(dataset["life"][0])  # under a constant force
    preload = float(dataset["preload"][0])
    assert "(constant force)" in answer.title
    assert numbers_in(answer.title) == [preload, 3.0, 30000.0]  # N, N/um, r/min
    assert numbers_in(answer.heading[1]) == [30000.0, 0.08]  # r/min, friction
    sentences = sentences_of(answer)
    assert f"{digits(life)} h" in sentences["verdict"]
    assert "temperature.inner_ring_C" in sentences["strip"]
    tables = tables_of(answer)
    recommended = rows_of(tables["open"])
    assert recommended["life"].values[0] == life
    assert recommended["active_limit"].values[0] == LIMITED[STIFFNESS].words_of(
        "system_axial_stiffness", short=True
    )
    now, other_better = rows_of(tables["lead"])[f"limits.{STIFFNESS}"].values
    k = dataset["change"].attrs["flag_meanings"].split().index(f"limits.{STIFFNESS}")
    assert now == "3" and other_better == f"above {digits(float(dataset['other_better_above'][k]))}"
    assert len(tables["charted"].table[1]) == 2 * load(files["design"]).sizes["preload"]


def test_the_answer_has_three_sentences_at_most(files):
    """Sentences in the strip of assumptions do not count."""
    answer = preload_document(load(files["recommendation"]), load(files["design"]))
    lines = [line for block in answer.blocks if block.place != "strip" for line in block.lines]
    assert 0 < len(lines) <= 3


def test_each_point_of_the_table_names_the_requirements_that_it_violates(files):
    """The last cell of a row has the word stiffness exactly where 3 N/um are not reached."""
    design = load(files["design"])
    answer = preload_document(load(files["recommendation"]), design)
    for row in tables_of(answer)["charted"].table[1]:
        # a row starts with preload and method
        point = design.sel(preload=float(row[0])).isel(friction=0, shaft_speed=0)
        point = point.isel(preload_method=int(row[1] == "fixed position"))
        is_soft = float(point["system_axial_stiffness"]) < 3.0e6
        assert ("stiffness" in row[-1]) == is_soft


def test_the_table_has_the_units_of_the_requirements_and_says_why_a_life_is_zero(files):
    """All lives of the map are zero here; powers above a kilowatt stay in W, as their key says."""
    design = load(files["design"])
    design["life"][...] = 0.0
    design["friction_power"][...] *= 1e6
    answer = preload_document(load(files["recommendation"]), design)
    names, rows = tables_of(answer)["charted"].table
    (power,) = [k for k, name in enumerate(names) if name.startswith("friction power")]
    assert "(W)" in names[power] and float(rows[0][power]) > 1e3
    assert all("end-of-life criterion met when new" in row[-1] for row in rows)


def plain_title(dataset, design):
    """Returns the headline of a recommendation and its map, with plain spaces."""
    return preload_document(dataset, design).title.replace("\N{NO-BREAK SPACE}", " ")


@pytest.fixture
def design_and_its_least_preload(files):
    """Returns the map, and a recommendation of its least preload, which the range alone limits.

    Requirements and end of life would allow less.
    """
    design, dataset = load(files["design"]), load(files["recommendation"])
    limits = dataset.active_limit.attrs["flag_meanings"].split()
    dataset["active_limit"][...] = limits.index("end_of_range")
    dataset["preload"][...] = float(design["preload"].min())
    return design, dataset


def test_the_headline_says_that_less_preload_would_live_longer(design_and_its_least_preload):
    design, dataset = design_and_its_least_preload
    assert "less preload" in plain_title(dataset, design)


def test_the_headline_says_how_little_less_preload_would_gain(design_and_its_least_preload):
    """Beyond the range, 0.1 N would have a life that is longer by 4 %."""
    design, dataset = design_and_its_least_preload
    dataset["beyond_preload"][...], dataset["beyond_life"][...] = 0.1, 1.04 * dataset["life"]
    title = plain_title(dataset, design)
    assert "less preload" in title
    assert numbers_in(title)[-2:] == [4.0, 0.1]  # % of the life, at so many N


def test_the_headline_without_a_requirement_is_an_advice(files):
    """As a rule, less preload gives a longer life; `AS_LITTLE` is that sentence.

    Such a recommendation has no limits, no life, and for each method the reason `NO_LIMIT`.
    """
    design, dataset = load(files["design"]), load(files["recommendation"])
    dataset["life"][...] = np.nan
    dataset.attrs |= {"limits": "{}", NONE_BECAUSE: json.dumps({"fixed_position": NO_LIMIT})}
    assert plain_title(dataset, design) == f"mine: {AS_LITTLE}"


def test_a_fixed_position_is_set_by_an_offset(files):
    """The offset [um] is twice the approach of the rings of one bearing under its preload.

    The answer also says that its life ends with 40 % of the preload left. Brackets have the preload
    at speed where it differs.
    """
    design, dataset = load(files["design"]), load(files["recommendation"])
    dataset["life"][1] = 2.0 * float(dataset["life"][0])  # so that a fixed position is better
    answer, preload = preload_document(dataset, design), float(dataset["preload"][1])
    sentences = sentences_of(answer)
    scene = scene_from_dict(json.loads(dataset.attrs["scene"]))
    offset = 2e6 * float(solve(with_method(scene, "fixed_position", preload)).values[PLACE])
    assert f"offset of {offset:.3g} µm" in sentences["lead"]
    assert "residual preload" in sentences["verdict"]  # which ends it
    assert 40.0 in numbers_in(sentences["verdict"])  # %, of the scene
    assert "at speed" not in answer.title
    dataset["residual_preload_at_start"][1] = 3.0 * preload
    assert f"({digits(3.0 * preload)} N at speed)" in preload_document(dataset, design).title


def test_the_preload_of_a_set_is_stated_for_a_side_and_for_a_matched_pair(files):
    """Two bearings against one need bearings that are matched for 1/1.36 of the preload of a side.

    Makers print the factor as 1.35 or 1.36. Bearings under a spring, the first method, are not
    matched.
    """
    dataset = load(files["recommendation"])
    scene = json.loads(dataset.attrs["scene"])
    arrangement = {"kind": "rigid_pair", "orientation": "back_to_back", "tandem": [2, 1]}
    scene["operation"]["preload_method"] = "fixed_position"
    scene = scene_from_dict(scene | {"arrangement": arrangement})
    dataset.attrs["scene"] = json.dumps(scene.to_dict())
    for k, is_matched in ((0, False), (1, True)):
        dataset["life"][k] = 2.0 * float(dataset["life"].max())  # makes this method the better one
        words = sentences_of(preload_document(dataset))["lead"]
        preload = float(dataset["preload"][k])
        assert preload in numbers_in(words) and "on each side" in words
        pair_preload = pytest.approx(preload / 1.36, rel=5e-3)  # three digits are printed
        assert any(number == pair_preload for number in numbers_in(words)) == is_matched


def test_achieved_values_have_no_power_of_ten(files, tmp_path):
    """A power of 1234 W is 1230 W on the page, in three digits, and not 1.23e+03 W."""
    dataset, changed = load(files["recommendation"]), tmp_path / "changed.nc"
    dataset["friction_power"][...] = 1234.0
    dataset.attrs["limits"] = json.dumps(json.loads(dataset.attrs["limits"]) | {POWER: 2000.0})
    dataset.to_netcdf(changed)
    design = load(files["design"])
    design.assign_attrs(limits=dataset.attrs["limits"]).to_netcdf(tmp_path / "design.nc")
    question = json.loads(design_charts(tmp_path / "design.nc", changed))["question"]
    assert "1230 W" in question.replace("\N{NO-BREAK SPACE}", " ")


def test_the_chart_of_life_has_the_required_life(files, tmp_path):
    """It is in hours, as the curves are; the stiffness of another chart is in N/um."""
    required = {"life_h": 1.5, STIFFNESS: 3.0}
    for name, path in files.items():
        changed = load(path).assign_attrs(limits=json.dumps(required))
        changed.to_netcdf(tmp_path / f"{name}.nc")
    charts = json.loads(design_charts(*(tmp_path / f"{name}.nc" for name in files)))["charts"]
    limits = {chart["title"]: (chart["limit"], chart["at_least"]) for chart in charts}
    assert limits["Life versus initial preload"] == (1.5, True)
    assert (3.0, True) in [limits[title] for title in limits if "tiffness" in title]


def test_a_method_without_a_preload_has_no_groove_model(files):
    """Its cell in the row `groove` is empty; that of the other method is not."""
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
        """Returns least and greatest preload of the second method in the table."""
        (table,) = [b for b in preload_document(dataset).blocks if b.title == "recommended"]
        return [rows_of(table)[name].values[1] for name in ("least_preload", "most_preload")]

    assert limits_of_second() == [NO_TOLERANCE] * 2
    dataset["preload"][1] = np.nan
    assert np.isnan(limits_of_second()).all()


@pytest.mark.parametrize("ratio, is_stated", [(0.99, True), (0.5, False)])
def test_another_method_with_about_the_same_life_is_stated(files, ratio, is_stated):
    """Its preload [N] is stated, too.

    ratio: of the life of the second method to that of the first.
    """
    dataset = load(files["recommendation"])
    dataset["life"][1] = ratio * float(dataset["life"][0])
    verdict = sentences_of(preload_document(dataset))["verdict"]
    assert ("gives the same life" in verdict) == is_stated
    assert (float(dataset["preload"][1]) in numbers_in(verdict)) == is_stated


def test_one_preload_is_specified_with_a_tolerance_that_keeps_the_requirements(files):
    """At both ends of the tolerance, solved here, requirements hold and lives are similar.

    Similar is `SIMILAR` times the longest. The title has the preload, the sentence in place `lead`
    preload, plus, minus, least and greatest preload [N], and the share of the life [%].
    """
    dataset = load(files["recommendation"])
    name, best, life = recommended_points(dataset)[0]
    low, high = float(best["least_preload"]), float(best["most_preload"])
    assert low <= float(best["preload"]) <= high and low < high
    scene, limits = scene_from_dict(json.loads(dataset.attrs["scene"])), limits_of(dataset)
    for preload in (low, high):
        point = design_point(with_method(scene, name, preload), limits)
        assert min(map(float, limit_margins(point, limits))) >= 0.0
        assert point["life"] / 3600.0 >= SIMILAR * life
    text = f"{float(best['preload']):.7g} N"
    answer = preload_document(dataset)
    assert text in answer.title
    specified, plus, minus, least, most, share = numbers_in(sentences_of(answer)["lead"])[:6]
    assert specified == float(best["preload"]) and share == 100.0 * SIMILAR
    assert [digits(least), digits(most)] == [digits(low), digits(high)]
    assert [specified + plus, specified - minus] == pytest.approx([most, least])


def test_a_spacer_that_is_off_by_its_tolerance_stays_within_the_range(files):
    """The range goes from the recommended preload of a fixed position to 1.5 times that preload.

    In offsets [um], the tolerance is minus zero, plus 90 to 100 % of the room: it is rounded down.
    """
    dataset = load(files["recommendation"])
    scene = scene_from_dict(json.loads(dataset.attrs["scene"]))
    dataset["life"][1] = 2.0 * float(dataset["life"][0])
    preload = float(dataset["preload"][1])
    dataset["least_preload"][1], dataset["most_preload"][1] = preload, 1.5 * preload
    sentence = sentences_of(preload_document(dataset))["lead"]
    offset, plus, minus = re.search(r"(\S+) µm.*\+(\S+)/−(\S+) µm", sentence).groups()

    def offset_um(preload):
        """Returns the offset [um] of both bearings of a pair, by a solve."""
        return 2e6 * float(solve(with_method(scene, "fixed_position", preload)).values[PLACE])

    assert float(offset) == pytest.approx(offset_um(preload), rel=5e-3)  # three digits
    room = offset_um(1.5 * preload) - offset_um(preload)
    assert minus == "0" and 0.9 * room < float(plus) <= room


def test_hours_of_a_calibrated_scene_are_stated(files):
    """Hours of a scene calibrated by tests are stated without the advice only to compare designs.

    Both have the interval of the wear coefficient: 90 % of a lognormal distribution of factor 1.5.
    """
    design, dataset = load(files["design"]), load(files["recommendation"])
    scene = json.loads(dataset.attrs["scene"])
    scene["uncertainty"] = {"wear_coefficient": {"distribution": "lognormal", "factor": 1.5}}
    life = float(dataset["life"].max())
    ends = [Rough(life * 1.5**z).text for z in (-1.6449, 1.6449)]  # 5 and 95 % points
    calibration = {"calibrated": {"tests": "mine.csv", "sha256": 64 * "0", "rows": 2}}
    for is_calibrated, block in ((False, {}), (True, calibration)):
        dataset.attrs["scene"] = json.dumps(scene | block)
        sentences = sentences_of(preload_document(dataset, design))
        assert f"{ends[0]} to {ends[1]} h" in sentences["verdict"]
        assert ("comparison" in sentences["lead"]) != is_calibrated
        assert ("2 tests (mine.csv)" in sentences["lead"]) == is_calibrated


SAMPLING = {"samples": 16, "seed": 1}
QUANTILES = "studies.uncertainty.quantiles"  # module of steps


@pytest.fixture(scope="module")
def spread_file(files, small_project, tmp_path_factory):
    """Returns the path of the spread of lives at the recommended preloads."""
    path = tmp_path_factory.mktemp("spread") / "spread.nc"
    inputs = {"scene": small_project / "mine.yaml", "recommendation": files["recommendation"]}
    run = f"{QUANTILES}.recommended_life_quantiles"
    assert step(run, path, settings=SAMPLING, **inputs) == 0
    return path


def median_life(dataset):
    """Returns the median life [h] of the first method, with all inputs uncertain."""
    quantiles = dataset["life_quantile"].isel(uncertain_inputs=0, preload_method=0)
    return float(quantiles.sel(probability=0.5).squeeze())


def test_the_spread_is_that_of_the_recommended_preload(files, spread_file, small_project, tmp_path):
    """Lives are sampled about the recommended preload, not about the scene's own."""
    about_scene = tmp_path / "about_scene.nc"
    scene = small_project / "mine.yaml"
    assert step(f"{QUANTILES}.uncertain_lives", about_scene, settings=SAMPLING, scene=scene) == 0
    spread, dataset = load(spread_file), load(files["recommendation"])
    preloads = spread["preload"].values.ravel().tolist()
    assert preloads == dataset["preload"].values.tolist()
    nominal = spread["nominal_life"].values.ravel()
    assert nominal == pytest.approx(dataset["life"].values, rel=0.02)  # sampled lives are quick
    # at 4.1 N in place of the scene's 7 N, about half as long again
    assert median_life(spread) > 1.3 * median_life(load(about_scene))


def test_the_answer_has_the_spread_of_its_file(files, spread_file, tmp_path):
    """The table `open` has a row for each quantile of the file, and none for another quantile."""
    answer = tmp_path / "answer.json"
    run = "studies.design.document.sheets.design_answer"
    assert step(run, answer, **files, spread=spread_file) == 0
    rows = {row[0]: row[1:] for row in tables_of(load_document(answer))["open"].table[1]}
    dataset = load(spread_file)
    mine = json.loads(dataset.attrs["scene"])
    spread = spread_of([dataset], mine, "constant_force", 0.08, RECOMMENDED)
    assert rows["90 % of bearings (h)"][0] == spread.bearings.text
    for name in ("L10 of the median batch", "L50 of the median batch"):
        expected = Rough(spread.quantiles[name]).text if name in spread.quantiles else None
        assert rows.get(f"{name} (h)", [None])[0] == expected, name


def test_without_a_recommendation_no_life_is_sampled(files, small_project, tmp_path):
    """A study whose limits no preload satisfies still ends with its answer."""
    none, path, answer = (tmp_path / name for name in ("none.nc", "spread.nc", "answer.json"))
    dataset = load(files["recommendation"])
    for name in ("life", "preload"):
        dataset[name][...] = np.nan
    dataset.to_netcdf(none)
    inputs = {"scene": small_project / "mine.yaml", "recommendation": none}
    run = f"{QUANTILES}.recommended_life_quantiles"
    assert step(run, path, settings=SAMPLING, **inputs) == 0
    assert load(path).sizes["preload_method"] == 0
    inputs = {"design": files["design"], "recommendation": none, "spread": path}
    assert step("studies.design.document.sheets.design_answer", answer, **inputs) == 0
    assert load_document(answer).title.startswith("mine: no preload")


def test_the_implied_requirement_is_named_where_it_rejects_a_preload(files):
    """No bearing may lift off, though no user requires it; one without residual preload does."""
    point = load(files["recommendation"]).isel(preload_method=0)
    assert "lifts off" not in violated_words(point)
    for name in LIMITED["preload_kept"].extremes:
        point[name] = point[name] * 0.0
    assert violated_words(point) == "a bearing lifts off"
