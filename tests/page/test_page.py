"""The page of a study: what it says, and that it is one valid file that fetches nothing."""

import base64
import copy
import functools
import hashlib
import json
import math
import os
import re
import shutil
import xml.etree.ElementTree as ET
from urllib.parse import unquote, unquote_to_bytes, urlsplit

import html5lib
import pytest
import yaml
from small_study import (
    CHOICE,
    FOLDER,
    GRID,
    HOSTILE,
    LIVES_ANSWER,
    make_page,
    page_command,
)
from support import numbers_in, only_line, scene_file

from bearingwear.cli import main
from bearingwear.document.chart import load_charts
from bearingwear.document.document import load_document
from bearingwear.page import figures
from bearingwear.page.charts import LARGE_CHART, MARGINS, SMALL_CHART, ChartAxis
from bearingwear.page.page import differences_by_block, key_rows
from bearingwear.page.sketch import section_of, sketch
from bearingwear.results.netcdf import load
from bearingwear.studies.launch import own_page

MOST = 1_500_000  # bytes
HREF = "{http://www.w3.org/1999/xlink}href"


@pytest.fixture
def page_of(small_project, tmp_path, monkeypatch):
    """Function (sections, docs=, answers=) -> text of the page."""
    monkeypatch.chdir(small_project)
    return lambda *args, **kwargs: make_page(tmp_path / "index.html", *args, **kwargs)


@pytest.fixture
def whole(whole_page):
    """The page of the small study."""
    return whole_page.read_text(encoding="utf-8")


@functools.lru_cache(maxsize=2)  # most tests ask for the same page
def parsed(text):
    """The page as a tree; any error of HTML5 raises."""
    return html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)


def words(node):
    text = "".join(node.itertext()).replace("\N{NO-BREAK SPACE}", " ")
    return " ".join(text.replace("\N{WORD JOINER}", "").split())


def said_by(text):
    """What a reader sees, without style and script."""
    return words(parsed(re.sub(r"<(style|script)>.*?</\1>", "", text, flags=re.S)))


def check_self_contained(text):
    """Nothing is fetched, every link on the page leads somewhere, every image has words."""
    tree = parsed(text)
    ids = [node.attrib["id"] for node in tree.iter() if "id" in node.attrib]
    assert len(ids) == len(set(ids))
    for node in tree.iter():
        assert node.tag not in ("link", "iframe", "object", "embed", "base", "form")
        assert not [name for name in node.attrib if name.startswith("on") or name == "srcset"]
        if "src" in node.attrib:
            assert node.tag == "img" and node.attrib["src"].startswith("data:image/")
            assert node.attrib["alt"].strip()
        if "href" in node.attrib:
            target = urlsplit(node.attrib["href"])
            assert node.tag == "a" and not target.scheme and not target.netloc
            assert target.path.startswith("../../") or target.fragment in ids
    assert "url(" not in text.partition("</style>")[0] and "@import" not in text
    assert len(text.encode()) < MOST
    return tree


def test_the_page_is_one_file(whole):
    tree = check_self_contained(whole)
    assert len(list(tree.iter("img"))) == 3
    assert "8 of 8 cases, 4 of 4 lives" in words(tree)
    assert {"#answer-1", "#answer-2", "#slider-1", "#scene-1", "#across", "#words"} <= {
        node.attrib["href"] for node in tree.iter("a")
    }


def test_only_its_own_script_and_style_may_run(whole):
    """The policy names them by their hashes, and nothing else may run or be fetched."""
    tree = parsed(whole)
    (policy,) = [
        node.attrib["content"]
        for node in tree.iter("meta")
        if "content" in node.attrib and "default-src" in node.attrib["content"]
    ]
    for tag in ("script", "style"):
        (node,) = tree.iter(tag)
        coded = base64.b64encode(hashlib.sha256(node.text.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{coded}'" in policy
    directives = dict(part.split(maxsplit=1) for part in policy.split("; "))
    assert directives["default-src"] == "'none'" and directives["img-src"] == "data:"
    assert "unsafe" not in policy
    assert len(node.text) < 20_000
    assert not [node for node in tree.iter() if "style" in node.attrib]


@pytest.mark.parametrize("own", [False, True], ids=["study", "own study"])
def test_every_link_to_a_file_leads_there(small_project, whole_page, own, tmp_path):
    """From results/report/ of a study, and from the folder of `bearingwear study mine.yaml`."""
    page = whole_page
    if own:
        shutil.copytree(small_project, tmp_path / "mine")
        page = own_page(tmp_path / "mine")
        assert page == tmp_path / "mine/index.html"
    links = [node.attrib["href"] for node in parsed(page.read_text(encoding="utf-8")).iter("a")]
    files = [unquote(link) for link in links if not link.startswith("#")]
    for name in ("study.nc", "cases.csv", "fig10.svg", "verification.md"):
        assert any(file.endswith(name) for file in files), name
    for file in files:
        assert (page.parent / file).is_file() and file.startswith("../../") == (not own), file
    assert own_page(tmp_path) is None


def test_a_page_made_twice_has_the_same_bytes(page_of):
    assert page_of() == page_of()


def test_strangers_words_are_text(whole):
    tree = check_self_contained(whole)
    assert HOSTILE in "".join(tree.itertext())
    assert "onerror=alert(2)>" not in whole and whole.count("<script") == 1


def test_figures_are_whole(whole):
    for node in parsed(whole).iter("img"):
        head, _, data = node.attrib["src"].partition(",")
        assert head == "data:image/svg+xml"
        svg = ET.fromstring(unquote_to_bytes(data))
        there = {item.attrib["id"] for item in svg.iter() if "id" in item.attrib}
        used = {
            element.attrib[HREF].removeprefix("#")
            for element in svg.iter()
            if HREF in element.attrib
        }
        clips = set(re.findall(r"url\(#(\w+)\)", unquote(data)))
        assert used and clips and used | clips <= there
        classes = {element.attrib["class"] for element in svg.iter() if "class" in element.attrib}
        styled = set(re.findall(r"\.(s\d+){", svg[0].text.partition("@media")[0]))
        assert classes == styled
        _, top, width, height = (float(size) for size in svg.attrib["viewBox"].split())
        assert top > 0.0  # where the message was
        assert abs(float(node.attrib["width"]) - width * 4 / 3) <= 0.5
        assert abs(float(node.attrib["height"]) - height * 4 / 3) <= 0.5


def test_a_small_figure_shows_what_the_file_shows(small_project):
    """Every text and every mark of the file is in the picture, but for the message."""
    (drawing,) = figures.drawings([small_project / f"{FOLDER}/figures/fig10.svg"])
    small = ET.fromstring(unquote_to_bytes(drawing.uri.partition(",")[2]))
    file = ET.parse(drawing.path).getroot()

    def counted(root, tag):
        return sum(1 for _ in root.iter(f"{{{figures.SVG}}}{tag}"))

    (message,) = [node for node in file.iter() if node.get("id") == "message"]
    for tag in ("path", "use", "text"):
        assert counted(small, tag) == counted(file, tag) - counted(message, tag) > 0
    assert len(drawing.uri) < 0.5 * drawing.path.stat().st_size


def test_a_dark_page_draws_figures_light_on_dark(tmp_path):
    """White, black and the methods' colours; the shades of a map stay, and its legend is right."""
    svg = (
        f'<svg xmlns="{figures.SVG}" viewBox="0 0 9 9"><rect style="fill: #ffffff"/>'
        '<path style="fill: none; stroke: #0072b2"/><text style="fill: #000000">a</text>'
        '<image href="data:image/png;base64,AAAA"/></svg>'
    )
    (tmp_path / "map.svg").write_text(svg)
    (drawing,) = figures.drawings([tmp_path / "map.svg"])
    svg_text = unquote(drawing.uri)
    night = svg_text.partition("@media (prefers-color-scheme:dark){")[2].partition("</style>")[0]
    assert night.startswith(f"text{{fill:{figures.INK}}}")
    assert ".s0{fill:#14171b}" in night and "stroke:#3db9ff" in night
    assert "AAAA" in svg_text and "#000000" not in svg_text


def test_a_figure_says_what_it_shows(small_project, whole):
    tree = parsed(whole)
    texts = [" ".join(node.attrib["alt"].split()) for node in tree.iter("img")]
    captions = [words(node) for node in tree.iter("figcaption")]
    svg = ET.parse(small_project / f"{FOLDER}/figures/wear_life.svg").getroot()
    title = svg.findtext(figures.TITLE)
    title = " ".join(title.split())
    assert texts[0].startswith(f"{title}. ")
    title = title.removeprefix("mine: ")
    assert title[0].upper() + title[1:] in captions
    for what in (
        "total wear depth (µm)",
        "running time (h)",
        "fixed position",
        "end: residual preload",
    ):
        assert what in texts[0]


def test_a_heavy_figure_is_a_bitmap(small_project, page_of, monkeypatch):
    monkeypatch.setattr(figures, "HEAVY", 10_000_000)
    assert "data:image/png" not in page_of()
    monkeypatch.setattr(figures, "HEAVY", 1000)
    monkeypatch.setattr(figures, "quote", lambda text, safe: 10_000_000 * "x")
    pictures = [node.attrib["src"] for node in parsed(page_of()).iter("img")]
    coded = base64.b64encode((small_project / f"{FOLDER}/figures/fig10.png").read_bytes()).decode()
    assert f"data:image/png;base64,{coded}" in pictures


def test_the_choice_leads_and_the_lives_follow(small_project, whole):
    tree = parsed(whole)
    choice, lives = (
        load_document(small_project / path) for path in (f"{CHOICE}/answer.json", LIVES_ANSWER)
    )
    (headline,) = tree.iter("h1")
    # of a single bearing no heading has the name
    title = choice.title.removeprefix("mine: ").capitalize()
    assert words(headline).capitalize() == title
    assert lives.facts["beside"] in [words(node) for node in tree.iter("h2")]
    page_words = words(tree)
    question = load_charts(small_project / f"{CHOICE}/charts.json").question
    assert question in page_words
    _, _, of_stiffness = question.partition("stiffness")
    assert numbers_in(of_stiffness)[:3] == [3.0, 3.0, 30000.0]  # N/um asked for and reached, r/min
    for document in (choice, lives):
        for block in document.blocks:
            if block.rows:
                cells = [cell for row in block.table[1] for cell in row]
                assert all(" ".join(cell.split()) in page_words for cell in cells)
            elif not block.title.startswith("Requirements"):  # which stand in the question
                assert block.title in page_words or block.place == "verdict"
                assert " ".join(block.lines[0].replace(" um ", " µm ").split()) in page_words
    # which bearing stands before the headline, in words
    assert page_words.index("9 balls of 2 mm") < page_words.index(words(headline), 200)


def test_charts_carry_the_numbers_of_the_map(small_project, whole):
    """A point of every solved preload, at its place; the script has the same numbers."""
    charts = load_charts(small_project / f"{CHOICE}/charts.json").charts
    figures_of = [n for n in parsed(whole).iter("figure") if n.attrib.get("class") == "chart"]
    assert len(figures_of) == len(charts) == 7
    for node, chart in zip(figures_of, charts, strict=True):
        (svg,) = [n for n in node.iter() if "data-chart" in n.attrib]
        assert svg.attrib["role"] == "img" and chart.title in svg.attrib["aria-label"]
        lines = json.loads(svg.attrib["data-chart"])["lines"]
        assert [line["points"] for line in lines] == [
            [list(point) for point in line.points] for line in chart.lines
        ]
        dots = [n for n in svg.iter() if n.attrib.get("class", "").startswith("dot")]
        points = [p for line in chart.lines for p in line.points if p[1] is not None]
        assert len(dots) == len(points) > 8
        wide, high = LARGE_CHART if chart is charts[0] else SMALL_CHART
        left, right, top, bottom = MARGINS
        for dot in dots:
            x, y = map(float, re.findall(r"[-\d.]+", dot.attrib["transform"]))
            assert 0.0 <= x <= wide - left - right and 0.0 <= y <= high - top - bottom
    design = load(small_project / f"{CHOICE}/design.nc")
    lives = design["life"].isel(friction=0, shaft_speed=0).values
    for line, values in zip(charts[0].lines, lives, strict=True):
        result = dict(line.points)
        assert [result[p] for p in design["preload"].values] == pytest.approx(list(values))


def test_ranges_beyond_a_limit_are_shaded(small_project):
    """Points within all limits lie outside of the shaded ranges, the others inside."""
    for chart in load_charts(small_project / f"{CHOICE}/charts.json").charts:
        for line in chart.lines:
            for (x, _), note in zip(line.points, line.notes, strict=True):
                inside = any(a <= x <= b for a, b in line.beyond)
                at_edge = any(abs(x / end - 1.0) < 1e-3 for edge in line.beyond for end in edge)
                assert at_edge or inside == bool(note), (chart.title, line.name, x)


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("ends", [(0.3, 0.4), (2.0, 12.0), (17.5, 4480.0), (1e-3, 1e6)])
def test_an_axis_has_a_few_round_ticks(log, ends):
    axis = ChartAxis(ends, log)
    assert 0.0 < axis.share(ends[0]) < axis.share(ends[1]) < 1.0
    ticks = axis.ticks
    assert 2 <= len(ticks) <= 13 and all(0.0 <= axis.share(tick) <= 1.0 for tick in ticks)


@pytest.mark.parametrize("kind", ["single", "spring_pair", "rigid_pair"])
@pytest.mark.parametrize("name", ["gyro_s1", "turbopump"])
def test_a_sketch_is_to_scale(name, kind):
    """The ball touches both grooves at the contact angle, and nothing else."""
    scene = yaml.safe_load(scene_file(name).read_text()) | {"arrangement": {"kind": kind}}
    section = section_of(scene["bearing"])
    x, z = section.normal
    for inner, side in ((True, -1.0), (False, 1.0)):
        contact = side * 0.5 * section.ball * x, 0.5 * section.pitch + side * 0.5 * section.ball * z
        centre = section.centre(inner)
        assert math.dist(contact, centre) == pytest.approx(section.grooves[not inner])
        assert section.grooves[not inner] > 0.5 * section.ball
        assert math.dist((0.0, 0.5 * section.pitch), centre) == pytest.approx(
            section.grooves[not inner] - 0.5 * section.ball
        )
    drawn = ET.fromstring(str(sketch(scene)).replace("ø", "o"))
    assert len([n for n in drawn.iter() if n.get("class") == "ball"]) == 1 + ("pair" in kind)


def test_other_bearings_list_what_differs_from_the_first():
    """With units; of an uncertain value the distribution, and nothing that is the same."""
    first = yaml.safe_load(scene_file("gyro_s1").read_text())
    other = copy.deepcopy(first)
    assert list(differences_by_block(first, other)) == []
    other["bearing"] |= {"ball_count": 10, "contact_angle_deg": 15.0}
    other["operation"]["preload_N"] = 9.0
    del other["cage"]
    del other["uncertainty"]["preload_N"]
    other["uncertainty"]["ball_race"]["factor"] = 1.5
    differences = {
        block: text.replace("\N{NO-BREAK SPACE}", " ")
        for block, text in differences_by_block(first, other)
    }
    assert differences == {
        "bearing": "ball count 10; contact angle 15°",
        "operation": "preload 9 N",
        "cage": "none",
        "uncertainty": "no preload; ball race lognormal, factor 1.5",
    }


def test_an_assumed_input_is_marked():
    scene = yaml.safe_load(scene_file("gyro_s1").read_text())
    rows = key_rows([scene], {"cage.width_mm", "uncertainty.ball_race.distribution"})
    marked = {(row.block, row.label) for row in rows if row.is_assumed}
    assert marked == {
        ("cage", "width (mm)\N{NO-BREAK SPACE}*"),
        ("uncertainty", "ball race\N{NO-BREAK SPACE}*"),
    }


def test_inputs_contain_the_friction_that_a_study_varies(small_project, tmp_path, monkeypatch):
    monkeypatch.chdir(small_project)
    path = tmp_path / "index.html"
    assert main(page_command(path, scenes=["mine.yaml"])) == 0
    assert "ball race0.08" in said_by(path.read_text(encoding="utf-8"))  # a row of the inputs


def test_the_page_of_a_study_without_answers_counts_its_cases(page_of):
    assert "8 of 8 cases" in said_by(page_of([f"{FOLDER}/study.nc"], (), ()))


def test_unsolved_cases_come_first_on_the_page(small_project, tmp_path, page_of):
    lives = load(small_project / f"{FOLDER}/wear_life.nc")
    lives["status"][0, 0] = 1
    lives.to_netcdf(tmp_path / "wear_life.nc")
    tree = parsed(page_of([str(tmp_path / "wear_life.nc")], (), ()))
    first_paragraph = words(next(next(tree.iter("main")).iter("p")))
    assert "mine, 1 of the lives" in first_paragraph


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("wear.svg", "<svg"),
        ("wear.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>"),
        ("study.nc", "not netCDF"),
        ("summary.md", None),
        ("answer.json", "{"),
        ("answer.json", '{"blocks": [], "headline": "x"}'),
        ("answer.json", '{"blocks": [1]}'),
        ("answer.json", "[]"),
    ],
)
def test_a_broken_file_is_named_in_one_line_and_no_page_is_written(
    small_project, tmp_path, monkeypatch, capsys, name, content
):
    monkeypatch.chdir(small_project)
    path = tmp_path / "bad" / "tables" / name
    path.parent.mkdir(parents=True)
    if content is not None:
        path.write_text(content)
    out = tmp_path / "index.html"
    inputs = {"answers" if name.endswith(".json") else "sections": [path], "docs": [path]}
    inputs["sections"] = [f"{FOLDER}/study.nc", *inputs.get("sections", [])]
    assert main(page_command(out, **{"answers": (), **inputs})) == 2
    assert str(path) in only_line(capsys)
    assert not out.exists()


def test_a_case_is_no_result_of_a_study(small_project, tmp_path, capsys):
    case = small_project / FOLDER / f"{next(iter(GRID.cases()))}.nc"
    assert main(page_command(tmp_path / "index.html", [case], (), ())) == 2
    assert capsys.readouterr().err.startswith(
        f"{case}: got a single result, which `bearingwear show`"
    )


@pytest.mark.parametrize("among", ["sections", "answers"])
def test_a_file_that_the_page_has_no_place_for(among, small_project, tmp_path, capsys):
    table = small_project / FOLDER / "tables" / "cases.csv"
    inputs = {"sections": [small_project / FOLDER / "study.nc"], "answers": []}
    inputs[among].append(table)
    assert main(page_command(tmp_path / "index.html", docs=(), **inputs)) == 2
    assert only_line(capsys).startswith(f"{table}: got the suffix '.csv', expected ")
    assert os.listdir(tmp_path) == []
