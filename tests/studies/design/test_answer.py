"""What the design study answers, and what other assumptions change in it."""

import json
import re

import numpy as np
import pytest
from small_study import CHOICE
from support import step

from bearingwear.document.document import load_document
from bearingwear.results.netcdf import load
from bearingwear.results.quantiles import RECOMMENDED, spread_of
from bearingwear.results.units import Rough, digits
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.read import scene_from_dict
from bearingwear.solvers.solve import solve
from bearingwear.studies.design.best import SIMILAR
from bearingwear.studies.design.choice import limit_margins, limits_of
from bearingwear.studies.design.document.sentences import recommended_points
from bearingwear.studies.design.document.sheets import preload_document
from bearingwear.studies.design.document.words import AS_LITTLE, NO_LIMIT, NONE_BECAUSE
from bearingwear.studies.design.map import followed_point

PLACE = "initial_axial_displacement"


@pytest.fixture(scope="module")
def files(small_project):
    """Map and recommendation."""
    names = ("design", "recommendation")
    return {name: small_project / CHOICE / f"{name}.nc" for name in names}


def told(answer):
    texts = {b.title: " ".join(b.lines) for b in answer.blocks if not b.rows}
    return {name: text.replace("\N{NO-BREAK SPACE}", " ") for name, text in texts.items()}


def tables(answer):
    """Tables by their place."""
    return {b.place: b for b in answer.blocks if b.rows}


def test_the_answer_is_that_of_the_files(files, tmp_path):
    path = tmp_path / "answer.json"
    assert step("studies.design.document.sheets.design_answer", path, **files) == 0
    answer, found = load_document(path), load(files["recommendation"])
    spring = float(found["life"][0])
    preload = float(found["preload"][0])
    assert answer.title.replace("\N{NO-BREAK SPACE}", " ") == (
        f"mine: use a spring preload of {preload:g} N (constant force); 3 N/µm is just met at "
        "30000 r/min, new"
    )
    assert answer.heading[1] == "from rest to 30000 r/min; friction 0.08"
    said = told(answer)
    life = f"The computed life at 30000 r/min is {Rough(spring).text} h"
    assert said["Expected life"].startswith(life)
    assert "order of magnitude" in said["Setting the preload"]
    assert "Temperature is neglected" in said["Warnings (worst values)"]
    found_in = tables(answer)
    first = {line[0]: line[1] for line in found_in["open"].table[1]}
    assert first["life, ball + races (h)"] == digits(spring)
    assert first["limited by"] == "dynamic stiffness, arrangement"
    rows = {line[0]: line[1:] for line in found_in["lead"].table[1]}
    now, other = rows["required axial stiffness of the arrangement (N/µm)"]
    k = found["change"].attrs["flag_meanings"].split().index("limits.system_axial_stiffness_N_um")
    assert now == "3" and other == f"above {digits(float(found['other_better_above'][k]))}"
    assert len(found_in["charted"].table[1]) == 2 * load(files["design"]).sizes["preload"]
    sentences = [line for block in answer.blocks if block.place != "strip" for line in block.lines]
    assert len(sentences) <= 3


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


def test_what_keeps_the_preload_stands_in_the_headline(files):
    """Without any limit there is no advice."""

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

    assert headline(files, at_the_end).endswith("; less preload gives an even longer life")
    assert "less preload gains little: 4 % of the life" in headline(files, plateau)
    advice = f"mine: {AS_LITTLE}"
    assert headline(files, without_limits) == advice


def test_a_fixed_position_is_set_by_an_offset(files):
    """Both bearings of the pair approach under the preload; at speed it is another."""
    design, found = load(files["design"]), load(files["recommendation"])
    found["life"][1] = 2.0 * float(found["life"][0])
    answer, preload = preload_document(found, design), float(found["preload"][1])
    said = told(answer)
    scene = scene_from_dict(json.loads(found.attrs["scene"]))
    offset = 2e6 * float(solve(held_by(scene, "fixed_position", preload)).values[PLACE])
    assert f"Specify a spacer offset of {offset:.3g} µm" in said["Setting the preload"]
    assert "it ends when the residual preload falls to 40 %" in said["Expected life"]
    assert "at speed" not in answer.title
    found["residual_preload_at_start"][1] = 3.0 * preload
    assert f"({digits(3.0 * preload)} N at speed)" in preload_document(found, design).title


def test_one_preload_is_specified_with_a_tolerance_that_keeps_the_requirements(files):
    """Title, offset and tolerance have the recommended preload; both ends are solved once more."""
    found = load(files["recommendation"])
    name, best, life = recommended_points(found)[0]
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
    found["life"][1] = 2.0 * float(found["life"][0])
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
        said.append(texts["Expected life"])
        used.append(texts["Setting the preload"])
    life = float(found["life"].max())
    ends = [Rough(life * 1.5**z).text for z in (-1.6449, 1.6449)]
    assert all(f"90 % of bearings, wear only: {ends[0]} to {ends[1]} h" in one for one in said)
    assert ["for comparison only" in one for one in used] == [True, False]
    assert "2 tests (mine.csv)" in used[1]


def test_the_spread_is_that_of_the_recommended_preload(files, small_project, tmp_path):
    """Lives are sampled about the preload to take, not about the scene's own."""
    path, own = tmp_path / "spread.nc", tmp_path / "own.nc"
    scene, settings = small_project / "mine.yaml", {"samples": 16, "seed": 1}
    run = "studies.uncertainty.quantiles"
    given = {"scene": scene, "recommendation": files["recommendation"]}
    assert step(f"{run}.recommended_life_quantiles", path, settings=settings, **given) == 0
    assert step(f"{run}.uncertain_lives", own, settings=settings, scene=scene) == 0
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
    rows = {row[0]: row[1:] for row in tables(load_document(answer))["open"].table[1]}
    mine = json.loads(spread.attrs["scene"])
    known = spread_of([spread], mine, "constant_force", 0.08, RECOMMENDED)
    assert rows["90 % of bearings (h)"][0] == known.bearings.text
    assert {f"{name} (h)": Rough(hours).text for name, hours in known.quantiles.items()} == {
        name: row[0]
        for name, row in rows.items()
        if name in ("L10 of the median batch (h)", "L50 of the median batch (h)")
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
