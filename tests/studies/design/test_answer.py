"""What the design study answers, and what other assumptions change in it."""

import json
import re

import numpy as np
import pytest
from small_study import CHOICE
from support import only_line, step

from bearingwear.document.document import load_document
from bearingwear.results.netcdf import load
from bearingwear.results.quantiles import RECOMMENDED, spread_of
from bearingwear.results.units import Rough, digits
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.read import scene_from_dict
from bearingwear.solvers.solve import solve
from bearingwear.studies.design.choice import limit_margins, limits_of
from bearingwear.studies.design.document.sentences import by_life
from bearingwear.studies.design.document.sheets import preload_document
from bearingwear.studies.design.document.words import AS_LITTLE, NO_LIMIT, NONE_BECAUSE
from bearingwear.studies.design.map import followed_point
from bearingwear.studies.design.room import NEITHER_LONGER
from bearingwear.studies.design.search import SIMILAR

PLACE = "initial_axial_displacement"
CASES = {
    "same": {"words": "nothing", "set": {}},
    "warm": {"words": "a warm inner ring", "set": {"temperature.inner_ring_C": 30}},
}


@pytest.fixture(scope="module")
def files(small_project, tmp_path_factory):
    """Map, recommendation and what stands beside it."""
    beside = tmp_path_factory.mktemp("beside") / "beside.nc"
    status = step(
        "studies.design.beside.lives_beside",
        beside,
        settings={"cases": CASES},
        scene=small_project / "mine.yaml",
        recommendation=small_project / CHOICE / "recommendation.nc",
    )
    assert status == 0
    return {
        "design": small_project / CHOICE / "design.nc",
        "recommendation": small_project / CHOICE / "recommendation.nc",
        "beside": beside,
    }


def told(answer):
    texts = {b.title: " ".join(b.lines) for b in answer.blocks if not b.rows}
    return {name: text.replace("\N{NO-BREAK SPACE}", " ") for name, text in texts.items()}


FOLDED = ("Effect of other assumptions", "robustness of the choice")


def tables(answer):
    """Tables by their place; of those that are folded, the last."""
    return {b.place: b for b in answer.blocks if b.rows and not b.title.startswith("new and worn")}


def test_the_answer_is_that_of_the_files(files, tmp_path):
    path = tmp_path / "answer.json"
    assert step("studies.design.document.sheets.design_answer", path, **files) == 0
    answer, found = load_document(path), load(files["recommendation"])
    spring, fixed = (float(life) for life in found["life"])
    preload = float(found["preload"][0])
    assert answer.title.replace("\N{NO-BREAK SPACE}", " ") == (
        f"mine: use a spring preload of {preload:g} N (constant force); 3 N/µm is just met at "
        "30000 r/min, new"
    )
    assert answer.heading[1] == "from rest to 30000 r/min; friction 0.08"
    said = told(answer)
    life = f"The computed life at 30000 r/min is {Rough(spring).text} h"
    assert said["Expected life"].startswith(life)
    assert f"the {Rough(fixed).text} h with fixed position" in said["Expected life"]
    assert "axial stiffness of the arrangement at least 3 N/µm" in said["What limits the preload"]
    assert (
        "Fixed position becomes the better method if the required axial stiffness"
        in said["What would change the choice"]
    )
    assert "order of magnitude" in said["Expected life"]
    assert "Temperature is neglected" in said["Warnings (worst values)"]
    found_in = tables(answer)
    charted = found_in["charted"]
    other, room = (b.table[1] for b in answer.blocks if b.rows and b.title.startswith(FOLDED))
    first = {line[0]: line[1] for line in found_in["lead"].table[1]}
    assert first["life, ball + races (h)"] == digits(spring)
    # with nothing assumed otherwise the lives are those above
    assert [row[2:] for row in other[2:4]] == [row[2:] for row in other[:2]]
    lives = {(row[0], row[1]): row[2] for row in other}
    assert lives["a warm inner ring", "fixed position"] != digits(fixed)
    values = charted.table[1]
    assert len(values) == 2 * load(files["design"]).sizes["preload"]
    assert ["axial stiffness of the arrangement (N/µm)", "–", "3"] in [row[:3] for row in room]


def test_a_limit_that_is_passed_is_named(files):
    charted = tables(preload_document(load(files["recommendation"]), load(files["design"])))[
        "charted"
    ]
    design, limit = load(files["design"]), 3.0e6
    for row in charted.table[1]:
        one = design.sel(preload=float(row[0])).isel(friction=0, shaft_speed=0)
        one = one.isel(preload_method=int(row[1] == "fixed position"))
        soft = float(one["system_axial_stiffness"]) < limit
        assert ("stiffness of the arrangement" in row[-1]) == soft


def headline(files, change):
    """Title of an answer of which `change` alters the recommendation."""
    design, found = load(files["design"]), load(files["recommendation"])
    change(found, design)
    return preload_document(found, design).title.replace("\N{NO-BREAK SPACE}", " ")


def test_each_verdict_has_its_headline(files):
    """Without any limit there is no advice."""

    def neither(found, _):
        found["verdict"][...] = NEITHER_LONGER

    def at_the_end(found, design):
        ends = found.active_limit.attrs["flag_meanings"].split()
        found["active_limit"][...] = ends.index("end_of_range")
        found["preload"][...] = float(design["preload"].min())

    def plateau(found, design):
        at_the_end(found, design)
        found["beyond_preload"][...], found["beyond_life"][...] = 0.1, 1.04 * found["life"]

    def cliff(found, _):
        found["cliff_preload"][0], found["cliff_life"][0] = 0.99 * found["preload"][0], 0.01

    def without_limits(found, _):
        found["life"][...] = np.nan
        found.attrs |= {"limits": "{}", NONE_BECAUSE: json.dumps({"fixed_position": NO_LIMIT})}

    assert "neither method is preferred; use a spring preload of" in headline(files, neither)
    assert headline(files, at_the_end).endswith(" N (constant force) or less")
    assert headline(files, plateau).endswith("; a lower preload gains little")
    assert headline(files, cliff).endswith("; with 1 % less preload, the life is only 0.01 h")
    advice = f"mine: {AS_LITTLE}"
    assert headline(files, without_limits) == advice


def test_a_fixed_position_is_set_by_an_offset(files):
    """Both bearings of the pair approach under the preload; at speed it is another."""
    design, found = load(files["design"]), load(files["recommendation"])
    beside = load(files["beside"]).assign_attrs(reversed_by_warmth=9.07)
    found["life"][1] = 2.0 * found["life"][0]
    answer, preload = preload_document(found, design, beside=beside), float(found["preload"][1])
    said = told(answer)
    scene = scene_from_dict(json.loads(found.attrs["scene"]))
    offsets = [
        2e6 * float(solve(held_by(scene, "fixed_position", share * preload)).values[PLACE])
        for share in (0.9, 1.0, 1.1)
    ]
    setting = said["Setting the preload"]
    assert f"Specify a spacer offset of {offsets[1]:.3g} µm, which produces" in setting
    tolerance = 0.5 * (offsets[2] - offsets[0])
    assert f"error of {tolerance:.2g} µm changes the preload by 10 %" in setting
    assert (
        "if the inner ring is more than 9.1 K warmer than the rest"
        in (said["What would change the choice"])
    )
    assert "The life ends when the residual preload falls to 40 %" in said["Expected life"]
    assert "at speed" not in answer.title
    found["residual_preload_at_start"][1] = 3.0 * preload
    assert f"({digits(3.0 * preload)} N at speed)" in preload_document(found, design).title


def test_one_preload_is_specified_with_a_tolerance_that_keeps_the_requirements(files):
    """Title, offset and tolerance have the recommended preload; both ends are solved once more."""
    found = load(files["recommendation"])
    name, best, life = by_life(found)[0]
    low, high = float(best["least_preload"]), float(best["most_preload"])
    assert low <= float(best["preload"]) <= high and low < high
    scene, limits = scene_from_dict(json.loads(found.attrs["scene"])), limits_of(found)
    for preload in (low, high):
        point = followed_point(held_by(scene, name, preload), limits)
        assert min(map(float, limit_margins(point, limits))) >= 0.0
        assert point["life"] / 3600.0 >= SIMILAR * life
    text = f"{float(best['preload']):.7g} N"
    answer = preload_document(found)
    said = told(answer)["Setting the preload"]
    assert text in answer.title and f"Specify a preload of {text}, tolerance +" in said
    assert f"from {digits(low)} to {digits(high)} N, all requirements hold" in said
    # a spacer that is off by its tolerance stays within the range
    found["life"][1] = 2.0 * found["life"][0]
    preload = float(found["preload"][1])
    found["least_preload"][1], found["most_preload"][1] = preload, 1.5 * preload
    said = told(preload_document(found))["Setting the preload"]
    offset, plus, minus = re.search(
        r"offset of (\S+) µm .*tolerance \+(\S+)/−(\S+) µm", said
    ).groups()
    most = 2e6 * float(solve(held_by(scene, "fixed_position", 1.5 * preload)).values[PLACE])
    middle = 2e6 * float(solve(held_by(scene, "fixed_position", preload)).values[PLACE])
    assert float(offset) == pytest.approx(middle, rel=5e-3)
    assert minus == "0" and 0.9 * (most - middle) < float(plus) <= most - middle


def test_hours_of_a_calibrated_scene_are_stated(files):
    """With the interval that the tests leave; of another scene they are no promise."""
    design, found = load(files["design"]), load(files["recommendation"])
    scene = json.loads(found.attrs["scene"])
    scene["uncertainty"] = {"wear_coefficient": {"distribution": "lognormal", "factor": 1.5}}
    said, used = [], []
    for by in ({}, {"calibrated": {"tests": "mine.csv", "sha256": 64 * "0", "rows": 2}}):
        found.attrs["scene"] = json.dumps(scene | by)
        texts = told(preload_document(found, design))
        said.append(texts["Uncertainty"])
        used.append(texts["Expected life"])
    life = float(found["life"].max())
    ends = [Rough(life * 1.5**z).text for z in (-1.6449, 1.6449)]
    assert all(f"90 % of bearings have lives of {ends[0]} to {ends[1]} h" in one for one in said)
    assert ["for comparison only" in one for one in used] == [True, False]
    assert "2 tests (mine.csv)" in said[1]


def test_what_stands_beside_another_scene_is_refused(files, small_project, tmp_path, capsys):
    other = load(files["beside"])
    scene = json.loads(other.attrs["scene"])
    scene["operation"]["preload_N"] += 1.0
    path = tmp_path / "other.nc"
    other.assign_attrs(scene=json.dumps(scene)).to_netcdf(path)
    for given, why in (
        (path, "got lives computed for another scene"),
        (files["design"], "got a file of another kind"),
    ):
        out = tmp_path / "answer.json"
        run = "studies.design.document.sheets.design_answer"
        assert step(run, out, **files | {"beside": given}) == 2
        said = only_line(capsys)
        assert str(given) in said and why in said


def test_the_spread_is_that_of_the_recommended_preload(files, small_project, tmp_path):
    """Lives are sampled about the preload to take, not about the scene's own."""
    path, own = tmp_path / "spread.nc", tmp_path / "own.nc"
    scene, settings = small_project / "mine.yaml", {"samples": 16, "seed": 1}
    run = "studies.uncertainty.quantiles"
    given = {"scene": scene, "recommendation": files["recommendation"]}
    assert step(f"{run}.recommended_life_quantiles", path, settings=settings, **given) == 0
    assert step(f"{run}.life_quantiles", own, settings=settings, scene=scene) == 0
    spread, found = load(path), load(files["recommendation"])
    preloads = spread["preload"].values.ravel().tolist()
    assert preloads == found["preload"].values.tolist()
    nominal = spread["nominal_life"].values.ravel()
    assert nominal == pytest.approx(found["life"].values, rel=0.02)
    median = spread["life_quantile"].isel(uncertain_inputs=0, preload_method=0)
    median = median.squeeze("preload_choice")
    at_own = load(own)["life_quantile"].isel(uncertain_inputs=0)
    # 4.1 N in place of 7 N: half as long again
    assert float(median.sel(probability=0.5)) > 1.3 * float(at_own.sel(probability=0.5).squeeze())
    answer = tmp_path / "answer.json"
    run = "studies.design.document.sheets.design_answer"
    assert step(run, answer, **files, spread=path) == 0
    rows = {row[0]: row[1:] for row in tables(load_document(answer))["lead"].table[1]}
    mine = json.loads(spread.attrs["scene"])
    known = spread_of([spread], mine, "constant_force", 0.08, RECOMMENDED)
    assert rows["90 % of bearings (h)"][0] == known.bearings.text
    assert {f"{name} (h)": Rough(hours).text for name, hours in known.quantiles.items()} == {
        name: row[0] for name, row in rows.items() if name in ("L10 (h)", "L50 (h)")
    }


def test_where_no_preload_is_taken_no_life_is_sampled(files, small_project, tmp_path):
    """A study whose limits nothing keeps to still ends with its answer."""
    none, path, answer = (tmp_path / name for name in ("none.nc", "spread.nc", "answer.json"))
    found = load(files["recommendation"])
    for name in ("life", "preload"):
        found[name][...] = np.nan
    found.to_netcdf(none)
    given = {"scene": small_project / "mine.yaml", "recommendation": none}
    run = "studies.uncertainty.quantiles.recommended_life_quantiles"
    assert step(run, path, settings={"samples": 16, "seed": 1}, **given) == 0
    assert load(path).sizes["preload_method"] == 0
    given = {"design": files["design"], "recommendation": none, "spread": path}
    assert step("studies.design.document.sheets.design_answer", answer, **given) == 0
    assert load_document(answer).title == "mine: no preload satisfies all requirements"
