"""The page of a study: what it says, and that it is one valid file that needs nothing else."""

import base64
import json
import math
import os
import pathlib
import re
import xml.etree.ElementTree as ET
from urllib.parse import unquote_to_bytes, urlsplit

import html5lib
import matplotlib
import numpy as np
import pytest
import xarray as xr
import yaml
from support import ROOT, scene_file, step

from bearingwear.cli import main
from bearingwear.page import page
from bearingwear.page.answer import Life, answer, lives_of
from bearingwear.page.markup import to_html
from bearingwear.results.netcdf import load
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid import figures
from bearingwear.studies.grid.grid import Grid

GRID = Grid.from_lists(PRELOAD_METHODS, [0.02, 0.08], [0.0, 0.7])
HOSTILE = (
    "</p><script>alert(1)</script> <img src=x onerror=alert(2)> {{ 7 * 7 }} | [a](javascript:b) "
    "![c](http://d.example/e.png) <http://f.example> \"'&amp;"
)
DOCS = [str(ROOT / "docs" / name) for name in ("verification.md", "accuracy.md")]
MOST = 5_000_000  # bytes
PAGE = "page.page.page"
HREF = "{http://www.w3.org/1999/xlink}href"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Results of a small study of a scene whose description is not to be trusted."""
    from bearingwear.model.solve import solve
    from bearingwear.results.netcdf import write_result
    from bearingwear.scene.variant import variant

    folder = tmp_path_factory.mktemp("results") / "mine"
    folder.mkdir()
    plain = yaml.safe_load(scene_file("gyro_s1").read_text(encoding="utf-8"))
    scene = folder / "mine.yaml"
    scene.write_text(yaml.safe_dump(plain | {"name": "mine", "description": HOSTILE}))
    for case_id, case in GRID.cases().items():
        write_result(solve(variant(scene, case.changes)), folder / f"{case_id}.nc")
    cases = [folder / f"{case_id}.nc" for case_id in GRID.cases()]
    study, lives = folder / "study.nc", folder / "wear_life.nc"
    both, one = {"friction": [0.02, 0.08]}, {"friction": 0.02}
    tables = [folder / "tables" / name for name in ("a.csv", "summary.md")]
    draw = "studies.grid.draw"
    for status in (
        step("studies.grid.gather.study", study, paths=cases),
        step("studies.grid.life.study_life", lives, scene=scene, study=study),
        step("studies.grid.tables.study_tables", *tables, study=study, lives=lives),
        step(f"{draw}.draw_wear", *drawn(folder, "fig10"), studies=[study], settings=both),
        step(f"{draw}.draw_life", *drawn(folder, "wear_life"), lives=lives, settings=both),
        step(
            f"{draw}.draw_overlay", *drawn(folder.parent, "spread"), studies=[study], settings=one
        ),
    ):
        assert status == 0
    return folder


def drawn(folder, name):
    return [f"{folder}/figures/{name}.{suffix}" for suffix in ("svg", "png")]


@pytest.fixture(scope="module")
def results(folder):
    """Files of the study that the page shows."""
    files = [folder / "study.nc", folder / "wear_life.nc", folder / "tables" / "summary.md"]
    figures = [
        *drawn(folder, "fig10"),
        *drawn(folder, "wear_life"),
        *drawn(folder.parent, "spread"),
    ]
    return [*map(str, files), *figures]


@pytest.fixture
def made(tmp_path):
    """Function (files, docs, answers) -> text of the page."""

    def make(*sections, docs=(), answers=()):
        path = tmp_path / "report" / "index.html"
        assert step(PAGE, path, sections=sections, docs=docs, answers=answers) == 0
        return path.read_text(encoding="utf-8")

    return make


def parsed(text):
    """The page as a tree; any error of HTML5 raises."""
    return html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)


def test_warnings_of_a_scene_stand_once(results, made):
    text = words(parsed(made(*results)))
    (said,) = re.findall(r"Warning, at its worst: 0\.7 um lost is [\d.]+ times.*?\)\.", text)
    assert said.endswith(f"({len(GRID.cases()) // 2} cases, 4 lives).")


def words(node):
    return " ".join("".join(node.itertext()).replace("\N{NO-BREAK SPACE}", " ").split())


def check_self_contained(text):
    """Nothing is fetched, every link on the page leads somewhere, every image has words."""
    tree = parsed(text)
    ids = [node.attrib["id"] for node in tree.iter() if "id" in node.attrib]
    assert len(ids) == len(set(ids))
    for node in tree.iter():
        assert node.tag not in ("script", "link", "iframe", "object", "embed", "base", "form")
        assert not [name for name in node.attrib if name.startswith("on") or name == "srcset"]
        if "src" in node.attrib:
            assert node.tag == "img" and node.attrib["src"].startswith("data:image/")
            assert node.attrib["alt"].strip()
        if "href" in node.attrib:
            target = urlsplit(node.attrib["href"])
            assert node.tag == "a"
            assert target.scheme in ("http", "https") or target.fragment in ids
    assert "url(" not in text.partition("</style>")[0] and "@import" not in text
    assert len(text.encode()) < MOST
    return tree


def test_the_page_is_one_file(results, made):
    tree = check_self_contained(made(*results, docs=DOCS))
    drawn = sum(pathlib.Path(path).read_text(encoding="utf-8").count("\n![") for path in DOCS)
    assert len([node for node in tree.iter("img")]) == 3 + drawn
    said = words(tree)
    assert "4 of 4 lives solved and verified" in said and "8 of 8 cases" in said
    for path in (name for name in results if name.endswith((".svg", ".md"))):
        assert f"snakemake -f {path}" in said
    for title in ("Verification", "Accuracy and what it costs", "Published numbers"):
        assert title in said
    assert {node.attrib["href"] for node in tree.iter("a")} >= {"#scene-1", "#docs-2", "#across"}


def test_the_same_bytes_twice(results, made):
    assert made(*results, docs=DOCS) == made(*results, docs=DOCS)


def test_strangers_words_are_text(results, made):
    text = made(*results)
    tree = check_self_contained(text)
    assert HOSTILE in "".join(tree.itertext())
    assert "onerror=alert(2)>" not in text and "<script" not in text


def test_figures_are_whole(results, made):
    tree = parsed(made(*results))
    for node in tree.iter("img"):
        head, _, data = node.attrib["src"].partition(",")
        assert head == "data:image/svg+xml"
        svg = ET.fromstring(unquote_to_bytes(data))
        there = {one.attrib["id"] for one in svg.iter() if "id" in one.attrib}
        used = {one.attrib[HREF].removeprefix("#") for one in svg.iter() if HREF in one.attrib}
        assert used and used <= there
        width, height = (float(size) * 4 / 3 for size in svg.attrib["viewBox"].split()[2:])
        assert abs(float(node.attrib["width"]) - width) <= 0.5
        assert abs(float(node.attrib["height"]) - height) <= 0.5


def test_a_figure_says_what_it_shows(folder, results, made):
    tree = parsed(made(*results))
    texts = [node.attrib["alt"] for node in tree.iter("img")]
    captions = [words(node) for node in tree.iter("figcaption")]
    svg = ET.parse(folder / "figures" / "wear_life.svg").getroot()
    message = svg.findtext(page.TITLE)
    # that of the first scene's lives stands first, with the answer
    assert texts[0].startswith(f"{message}. ") and captions[0] == " ".join(message.split())
    for what in ("loss of ball diameter (µm)", "running time (h)", "fixed position", "ball alone"):
        assert what in texts[0]


def test_a_heavy_figure_is_a_bitmap(folder, results, made, monkeypatch):
    monkeypatch.setattr(page, "HEAVY", 1000)
    pictures = [node.attrib["src"] for node in parsed(made(*results)).iter("img")]
    for suffix in ("png", "svg"):
        coded = base64.b64encode((folder / "figures" / f"fig10.{suffix}").read_bytes()).decode()
        assert (f"data:image/png;base64,{coded}" in pictures) == (suffix == "png")


def test_the_answer_is_that_of_the_file(folder, results, made):
    lives = lives_of(load(folder / "wear_life.nc"))
    low = {life.method: life.counted for life in lives if life.friction == 0.02}
    ratio = low["constant_force"] / low["fixed_position"]
    said = words(parsed(made(*results)))
    assert f"Constant force outlasts fixed position: {ratio:.2g} times as long at µ = 0.02" in said
    everything = sorted(life.counted for life in lives)
    assert f"{everything[0]:.3g} to {everything[-1]:.3g} h if the wear of balls and races" in said
    assert "gyroscopic share of slip up to 50 % at µ = 0.02" in said
    assert "bearingwear recommend finds one" in said


def test_a_study_alone(folder, made):
    said = words(check_self_contained(made(folder / "study.nc")))
    assert "A study of friction and wear" in said and "8 of 8 cases" in said


def test_what_was_not_solved_comes_first(folder, tmp_path, made):
    lives = load(folder / "wear_life.nc")
    lives["status"][0, 0] = 1
    lives["life"][0, 0] = math.nan
    lives.to_netcdf(tmp_path / "wear_life.nc")
    said = words(check_self_contained(made(tmp_path / "wear_life.nc")))
    assert "Not everything was solved: mine, 1 of the lives." in said
    assert "not solved: not converged at µ = 0.02" in said
    assert "nan" not in said.split()


def test_a_design_study_gives_the_answer(folder, results, tmp_path, made):
    table = tmp_path / "design.md"
    table.write_text(
        "# mine\n\nTake **9.5 N** in fixed position. Its life is long.\n\n"
        "| a | b |\n| --- | --- |\n| 1 | <b>2</b> |\n"
    )
    check = tmp_path / "check.md"
    check.write_text("# check\n\nThe tiers agree.\n")
    text = made(*results, answers=[table, check, *drawn(folder, "fig10")])
    tree = check_self_contained(text)
    assert words(next(tree.iter("h1"))) == "Take 9.5 N in fixed position."
    said = words(tree)
    assert "none is recommended" not in said and "Its life is long." in said
    assert said.count("Take 9.5 N") == 1 and said.index("Its life") < said.index("The tiers agree.")
    assert "<b>2</b>" in said
    assert len(list(tree.iter("img"))) == 4


@pytest.fixture
def sure(folder, tmp_path):
    """The lives with a made-up spread beside them, and that file."""
    from bearingwear.scene.read import load_scene

    scene = load_scene(folder / "mine.yaml")
    middle = np.arange(1.0, 25.0).reshape(2, 2, 3, 2)  # method, at, probability, counts
    names = {"life_quantile": 1.0, "life_quantile_low": 0.9, "life_quantile_high": 1.25}
    dims = ("preload_method", "preload_choice", "uncertain_inputs", "probability", "loss_basis")
    methods = {"flag_values": [0, 1], "flag_meanings": " ".join(PRELOAD_METHODS)}
    dataset = xr.Dataset(
        {name: (dims, (middle * factor)[:, :, None]) for name, factor in names.items()}
        | {"solved_share": (dims[:2], [[1.0, 1.0], [0.99, 1.0]])},
        {"preload_method": ("preload_method", [0, 1], methods), "probability": [0.1, 0.5, 0.9]},
        load(folder / "wear_life.nc").attrs
        | {"kind": "uncertainty", "scene": json.dumps(scene.to_dict())},
    )
    (tmp_path / "design").mkdir()
    path = tmp_path / "design" / "uncertainty.nc"
    dataset.to_netcdf(path)
    lives = tmp_path / "wear_life.nc"
    lives.write_bytes((folder / "wear_life.nc").read_bytes())
    return lives, path


def test_lives_stand_with_their_spread(folder, sure, made, capsys):
    lives, spread = sure
    # at the scene's own preload; methods by rows of 12, quantiles by pairs of counts
    constant = "L10 1 h [0.9, 1.25]; L50 3 h [2.7, 3.75]", "L10 2 h [1.8, 2.5]; L50 4 h [3.6, 5]"
    fixed = "L10 13 h [11.7, 16.2]; L50 15 h [13.5, 18.8] (of the 99 % of lives that were solved)"
    written, table = lives.parent / "a.csv", lives.parent / "summary.md"
    given = {"study": folder / "study.nc", "lives": lives, "uncertainty": [spread]}
    assert step("studies.grid.tables.study_tables", written, table, **given) == 0
    text = table.read_text().replace("\N{NO-BREAK SPACE}", " ")
    rows = [line.split(" | ") for line in text.splitlines()]
    rows = {(row[0][2:], row[1]): (row[3], row[5]) for row in rows if len(row) == 9}
    assert rows["constant force", "0.08"] == constant
    assert rows["fixed position", "0.08"][0] == fixed
    assert rows["constant force", "0.02"] == ("no spread computed",) * 2
    assert "the command bearingwear uncertainty computes it" in table.read_text()

    drawn = figures.life_figure(load(lives), [0.02, 0.08], [load(spread)]).get_suptitle()
    drawn = drawn.replace("\n", " ").replace("\N{NO-BREAK SPACE}", " ")
    assert drawn.endswith("; L10: 2 to 14 h, L50: 4 to 16 h")
    assert figures.life_figure(load(lives), [0.02]).get_suptitle().endswith("no spread computed")

    said = words(check_self_contained(made(lives, answers=[spread])))
    assert "L10 1 to 13 h, L50 3 to 15 h if the wear of the balls alone counts." in said
    assert all(text in said for text in (*constant, fixed))
    assert "No spread computed for the others" in said

    capsys.readouterr()
    assert main(["show", str(lives)]) == 0
    shown = capsys.readouterr().out
    of_force = shown.partition("constant_force, mu 0.08\n  L10")[2].partition("fixed_pos")[0]
    assert re.search(r"L50 +h +3 +4\n", of_force)
    assert re.search("0.9 to 1.25 +1.8 to 2.5", shown)
    assert "no spread computed for the other 2; the command" in shown


def test_errors_in_the_answer_are_those_of_its_bearing(folder, results, made, tmp_path):
    """Another bearing's worst stands under that bearing."""
    other = tmp_path / "other" / "study.nc"
    other.parent.mkdir()
    study = load(folder / "study.nc")
    study["qv_error_estimate"] = study["qv_error_estimate"] * 0.0 + 0.55
    name = json.dumps(json.loads(study.attrs["scene"]) | {"name": "other"})
    study.assign_attrs(scene=name).to_netcdf(other)
    tree = check_self_contained(made(*results, other))
    (box,) = [node for node in tree.iter("dl") if node.attrib.get("class") == "answer"]
    assert "Largest estimated numerical errors of mine: QV" in words(box)
    assert "55 %" not in words(box) and "QV 55 %" in words(tree)


def test_words_are_explained_and_keys_are_words(results, made):
    text = made(*results)
    tree = check_self_contained(text)
    said = words(tree)
    sentence = "QV, by which friction and wear are measured here, is the load"
    assert said.index(sentence) < said.index("Which preload method")
    explained = [words(n) for n in tree.iter("dt")]
    assert {"QV", "skid ratio", "residual preload", "wear life"} <= set(explained)
    assert "bearing: pitch diameter (mm)" in said and "lubricant: drag density (kg/m³)" in said
    visible = said.partition("Run it again")[0].replace("gyro_s1", "")
    for raw in ("pitch_diameter_mm", "drag_density", "preload_fraction", "loss um", "`"):
        assert raw not in visible, raw


def test_no_spread_is_invented(folder, sure, results, made, capsys):
    """Without a study of uncertainty, or with that of another scene, no life has a spread."""
    lives, path = sure
    other = load(path)
    scene = json.loads(other.attrs["scene"])
    scene["operation"]["shaft_speed_rpm"] += 1.0
    other.attrs["scene"] = json.dumps(scene)
    path.unlink()
    other.to_netcdf(path)
    said = words(check_self_contained(made(lives, answers=[path])))
    assert "L10" not in said and "No spread computed, the command bearingwear uncertainty" in said
    assert "L10" not in (folder / "tables" / "summary.md").read_text()
    for place in (lives, folder / "wear_life.nc"):
        capsys.readouterr()
        assert main(["show", str(place)]) == 0
        shown = capsys.readouterr().out
        assert "L10" not in shown and "  no spread computed; the command" in shown
    made_of = {"study": folder / "study.nc", "lives": lives, "uncertainty": [lives]}
    written = [lives.parent / "a.csv", lives.parent / "b.md"]
    assert step("studies.grid.tables.study_tables", *written, **made_of) == 2
    assert not any(file.exists() for file in written)
    assert "not a file of the kind uncertainty" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("wear.svg", "<svg"),
        ("wear.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>"),
        ("study.nc", "not netCDF"),
        ("summary.md", None),
    ],
)
def test_bad_input(folder, tmp_path, capsys, name, content):
    path = folder.parent / "bad" / "tables" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    if content is not None:
        path.write_text(content)
    out = tmp_path / "index.html"
    assert step(PAGE, out, sections=[folder / "study.nc", path], docs=[path]) == 2
    told = capsys.readouterr().err
    assert str(path) in told and told.count("\n") == 1
    assert not out.exists()


def test_a_case_is_no_result_of_a_study(folder, tmp_path, capsys):
    case = folder / f"{next(iter(GRID.cases()))}.nc"
    assert step(PAGE, tmp_path / "index.html", sections=[case]) == 2
    assert capsys.readouterr().err.startswith(f"{case}: not a file for this command")


@pytest.mark.parametrize("among", ["sections", "answers"])
def test_a_file_that_the_page_has_no_place_for(among, folder, tmp_path, capsys):
    table = folder / "tables" / "a.csv"
    given = {"sections": [folder / "study.nc"], "answers": []}
    given[among].append(table)
    assert step(PAGE, tmp_path / "index.html", **given) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"{table}: got the suffix '.csv', expected ")
    assert told.count("\n") == 1 and os.listdir(tmp_path) == []


def test_docs_bring_their_pictures_and_lose_links_to_files(tmp_path):
    figure = matplotlib.figure.Figure()
    figure.savefig(tmp_path / "a.png")
    text = "# T\n\n[here](theory.md) [there](https://a.example/b) ![words](a.png) ![gone](b.png)"
    html = to_html(f"{text}\n\n<i>x</i>", 1, tmp_path)
    tree = parsed(f"<!DOCTYPE html><title>t</title>{html}")
    assert [node.attrib["href"] for node in tree.iter("a")] == ["https://a.example/b"]
    (image,) = tree.iter("img")
    assert image.attrib["alt"] == "words" and image.attrib["src"].startswith("data:image/png;")
    assert words(tree).endswith("here there gone <i>x</i>") and "<h2>T</h2>" in html


def life(method, friction, hours, error=0.01, scene="a", end="x"):
    both = {"ball": 10.0 * hours, "ball_and_races": hours}
    return Life(scene, method, friction, both, "ball_and_races", error, end)


CONSTANT, FIXED = PRELOAD_METHODS


@pytest.mark.parametrize(
    ("lives", "headline", "sentence"),
    [
        (
            [life(CONSTANT, 0.1, 2.0), life(FIXED, 0.1, 1.0)],
            "a: constant force lasts longest",
            "Constant force outlasts fixed position: 2 times as long at µ = 0.1.",
        ),
        (
            [life(CONSTANT, 0.1, 1.0), life(FIXED, 0.1, 1.05)],
            "a: fixed position lasts longest",
            "Fixed position outlasts constant force: by 5 % at µ = 0.1.",
        ),
        (
            [life(CONSTANT, 0.1, 1.0), life(FIXED, 0.1, 1.019)],
            "a: both preload methods last equally long",
            "No difference beyond the numerical error at µ = 0.1.",
        ),
        (
            [life(CONSTANT, 0.1, 1.0, math.nan), life(FIXED, 0.1, 1.019, math.nan)],
            "a: fixed position lasts longest",
            "Fixed position outlasts constant force: by 1.9 % at µ = 0.1.",
        ),
        (
            [
                life(m, mu, 2.0 if (mu == 0.1) == (m == CONSTANT) else 1.0)
                for mu in (0.1, 0.2)
                for m in (CONSTANT, FIXED)
            ],
            "a: which preload lasts longest depends on friction",
            "Constant force outlasts fixed position: 2 times as long at µ = 0.1.",
        ),
        ([life(FIXED, 0.1, 1.0)], "a: life with fixed position", "Fixed position: x."),
        (
            [life(CONSTANT, 0.1, math.nan), life(FIXED, 0.1, 1.0)],
            "a: life with constant force and fixed position",
            "1 h if the wear of balls and races counts",
        ),
        ([life(FIXED, 0.1, math.nan)], "a: no end of life was found", "Fixed position: x."),
        (
            [life(CONSTANT, 0.1, 1.0), *(life(m, 0.1, 3.0, scene="b") for m in PRELOAD_METHODS)],
            "a: life with constant force",
            "The methods are equal in 1 of 1 comparisons.",
        ),
    ],
)
def test_the_answer_in_words(lives, headline, sentence):
    found = answer(lives)
    assert found.headline == headline
    said = [text for _, texts in found.facts for text in texts]
    assert any(sentence in text.replace("\N{NO-BREAK SPACE}", " ") for text in said), said
    assert not any("nan" in text.split() for text in said)
    assert not any("nan" in value.split() for row in found.rows for value in row.values())


def test_no_lives_no_answer():
    assert answer([]) is None


def test_lives_of_zero_are_no_contest():
    """Beyond a limit when new: equal if both are, and no ratio if one is."""

    def lives(constant, fixed):
        hours = zip(("constant_force", "fixed_position"), (constant, fixed), strict=True)
        return [
            Life("s", name, 0.04, {"ball": h, "ball_and_races": h}, "ball", 0.0, "")
            for name, h in hours
        ]

    both, one = answer(lives(0.0, 0.0)), answer(lives(0.0, 2.0))
    assert both.headline == "s: both preload methods last equally long"
    assert one.facts[0][1] == [
        "Fixed position outlasts constant force: it alone is within the limits when new at "
        "µ\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}0.04."
    ]
