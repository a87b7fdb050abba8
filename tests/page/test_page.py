"""The page of a study: its contents, and that it is one valid file that fetches nothing."""

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
    FIGURES,
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
from bearingwear.kernels.status import NOT_CONVERGED
from bearingwear.page import figures
from bearingwear.page.charts import LARGE_CHART, MARGINS, SMALL_CHART, ChartAxis
from bearingwear.page.page import differences_by_block, key_rows
from bearingwear.page.sketch import section_of, sketch
from bearingwear.results.netcdf import load
from bearingwear.studies.launch import copy_own_page

MOST_BYTES = 1_500_000  # of a page, so that it loads quickly
MOST_SCRIPT_CHARACTERS = 20_000
HREF = "{http://www.w3.org/1999/xlink}href"


@pytest.fixture
def page_of(small_project, tmp_path, monkeypatch):
    """Returns a function that writes a page of files of the small study, and returns its text.

    Its arguments are those of `make_page` after the path: sections, docs and answers.
    """
    monkeypatch.chdir(small_project)
    return lambda *args, **kwargs: make_page(tmp_path / "index.html", *args, **kwargs)


@pytest.fixture
def page_text(whole_page):
    """Returns the text of the page of the small study."""
    return whole_page.read_text(encoding="utf-8")


@functools.lru_cache(maxsize=2)  # most tests parse the same page
def parsed(text):
    """Returns the tree of a page; raises an error if it is not valid HTML5."""
    return html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)


def words(node):
    """Returns the text of a node with single plain spaces, without joiners of words."""
    text = "".join(node.itertext()).replace("\N{NO-BREAK SPACE}", " ")
    return " ".join(text.replace("\N{WORD JOINER}", "").split())


def check_self_contained(text):
    """Checks that a page fetches nothing, and returns its tree.

    Links lead to files below ../../ or to elements of the page. Images are data and have alt text.
    Each id occurs once. No attribute has a script. The page is small enough.
    """
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
    assert len(text.encode()) < MOST_BYTES
    return tree


def test_the_page_is_one_file_that_fetches_nothing(page_text):
    """`check_self_contained` lists what is checked."""
    check_self_contained(page_text)


def test_the_page_has_all_figures_counts_and_sections_of_a_study(page_text):
    """Links lead to the sections: answers, a slider, the scene, figures, and terms."""
    tree = parsed(page_text)
    assert len(list(tree.iter("img"))) == len(FIGURES)
    assert "8 of 8 cases, 4 of 4 lives" in words(tree)  # 2 methods, 2 frictions, 2 losses
    assert {"#answer-1", "#answer-2", "#slider-1", "#scene-1", "#across", "#words"} <= {
        node.attrib["href"] for node in tree.iter("a")
    }


def test_a_security_policy_allows_only_the_script_and_style_of_the_page(page_text):
    """It names them by their hashes; nothing else may run or be fetched."""
    tree = parsed(page_text)
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
    assert not [node for node in tree.iter() if "style" in node.attrib]


def test_the_script_of_the_page_is_short(page_text):
    """The page has only one script, of less than 20 000 characters."""
    (script,) = parsed(page_text).iter("script")
    assert len(script.text) < MOST_SCRIPT_CHARACTERS


def linked_files(page):
    """Returns the links of a page to files, relative to it."""
    links = [node.attrib["href"] for node in parsed(page.read_text(encoding="utf-8")).iter("a")]
    return [unquote(link) for link in links if not link.startswith("#")]


# ends of some paths to which the page links
LINKED = ("study.nc", "cases.csv", "fig10.svg", "verification.md")


def test_every_link_of_a_page_leads_to_a_file(whole_page):
    """The workflow writes it to results/report/, from where all links begin with ../../."""
    files = linked_files(whole_page)
    for name in LINKED:
        assert any(file.endswith(name) for file in files), name
    for file in files:
        assert (whole_page.parent / file).is_file() and file.startswith("../../"), file


def test_every_link_leads_to_a_file_from_the_folder_of_a_users_study(small_project, tmp_path):
    """`bearingwear study mine.yaml` copies the page to the folder mine/ and adapts its links."""
    shutil.copytree(small_project, tmp_path / "mine")
    page = copy_own_page(tmp_path / "mine")
    assert page == tmp_path / "mine/index.html"
    files = linked_files(page)
    for name in LINKED:
        assert any(file.endswith(name) for file in files), name
    for file in files:
        assert (page.parent / file).is_file() and not file.startswith("../../"), file


def test_a_folder_without_results_has_no_page(tmp_path):
    """`copy_own_page` returns None."""
    assert copy_own_page(tmp_path) is None


def test_a_page_made_twice_has_the_same_bytes(page_of):
    """It contains no date."""
    assert page_of() == page_of()


def test_markup_in_a_description_is_shown_as_text(page_text):
    """The scene of the small study has HOSTILE as its description; the page has only its script."""
    tree = check_self_contained(page_text)
    assert HOSTILE in "".join(tree.itertext())
    assert "onerror=alert(2)>" not in page_text and page_text.count("<script") == 1


def figures_on(page_text):
    """Yields the image node and the SVG of each figure of a page."""
    for node in parsed(page_text).iter("img"):
        head, _, data = node.attrib["src"].partition(",")
        assert head == "data:image/svg+xml"
        yield node, ET.fromstring(unquote_to_bytes(data))


def test_reduced_figures_contain_all_that_they_refer_to(page_text):
    """Marks and clips by their ids, and classes by their styles, s0, s1, ..., which come first."""
    for _, svg in figures_on(page_text):
        ids = {element.get("id") for element in svg.iter()}
        uses = {element.get(HREF, "").removeprefix("#") for element in svg.iter()} - {""}
        clips = set(re.findall(r"url\(#(\w+)\)", ET.tostring(svg, encoding="unicode")))
        assert uses and clips and uses | clips <= ids
        classes = {element.get("class") for element in svg.iter()} - {None}
        assert classes == set(re.findall(r"\.(s\d+){", svg[0].text.partition("@media")[0]))


def test_figures_have_their_size_in_pixels_without_the_message(page_text):
    """The view begins below the message, and a point has 4/3 pixels."""
    for node, svg in figures_on(page_text):
        _, top, width, height = (float(size) for size in svg.attrib["viewBox"].split())
        assert top > 0.0  # the height of the message
        # sizes are whole pixels
        assert abs(float(node.attrib["width"]) - width * 4 / 3) <= 0.5
        assert abs(float(node.attrib["height"]) - height * 4 / 3) <= 0.5


def test_a_reduced_figure_has_every_text_and_mark_of_its_file_but_the_message(small_project):
    """Paths, marks and texts are counted. The data URI has less than half of the file's bytes."""
    (drawing,) = figures.drawings([small_project / f"{FOLDER}/figures/fig10.svg"])
    reduced = ET.fromstring(unquote_to_bytes(drawing.uri.partition(",")[2]))
    original = ET.parse(drawing.path).getroot()

    def count(root, tag):
        """Returns the number of SVG elements with a tag."""
        return sum(1 for _ in root.iter(f"{{{figures.SVG}}}{tag}"))

    (message,) = [node for node in original.iter() if node.get("id") == "message"]
    for tag in ("path", "use", "text"):
        assert count(reduced, tag) == count(original, tag) - count(message, tag) > 0, tag
    assert len(drawing.uri) < 0.5 * drawing.path.stat().st_size


def test_a_dark_page_draws_figures_light_on_dark(tmp_path):
    """White, black and the colours of the methods change; an image, such as a map, does not."""
    svg = (
        f'<svg xmlns="{figures.SVG}" viewBox="0 0 9 9"><rect style="fill: #ffffff"/>'
        '<path style="fill: none; stroke: #0072b2"/><text style="fill: #000000">a</text>'
        '<image href="data:image/png;base64,AAAA"/></svg>'
    )
    (tmp_path / "map.svg").write_text(svg)
    (drawing,) = figures.drawings([tmp_path / "map.svg"])
    svg_text = unquote(drawing.uri)
    _, _, dark = svg_text.partition("@media (prefers-color-scheme:dark){")
    dark_styles = dark.partition("</style>")[0]
    assert dark_styles.startswith(f"text{{fill:{figures.INK}}}")
    assert ".s0{fill:#14171b}" in dark_styles  # the colour `PAPER`, in place of white
    assert "stroke:#3db9ff" in dark_styles  # the same hue and saturation, with a lightness of 0.62
    assert "AAAA" in svg_text
    assert "#000000" not in svg_text  # text takes the colour of the page, light or dark


def test_a_figure_has_its_message_as_caption_and_its_axes_and_legend_as_alt_text(
    small_project, page_text
):
    """The message is the title of the SVG; the caption leaves out the scene. Alt text has both."""
    tree = parsed(page_text)
    alt_text = " ".join(next(tree.iter("img")).attrib["alt"].split())
    svg = ET.parse(small_project / f"{FOLDER}/figures/wear_life.svg").getroot()
    message = " ".join(svg.findtext(figures.TITLE).split())
    assert alt_text.startswith(f"{message}. ")
    for label in (
        "total wear depth (µm)",
        "running time (h)",
        "fixed position",
        "end: residual preload",
    ):
        assert label in alt_text, label
    caption = message.removeprefix("mine: ")
    captions = [words(node) for node in tree.iter("figcaption")]
    assert caption[0].upper() + caption[1:] in captions


def test_a_heavy_figure_is_a_bitmap(small_project, page_of, monkeypatch):
    """Its SVG has ten million bytes, more than HEAVY and more than its PNG has."""
    monkeypatch.setattr(figures, "HEAVY", 1000)
    monkeypatch.setattr(figures, "quote", lambda text, safe: 10_000_000 * "x")
    pictures = [node.attrib["src"] for node in parsed(page_of()).iter("img")]
    png = (small_project / f"{FOLDER}/figures/fig10.png").read_bytes()
    assert f"data:image/png;base64,{base64.b64encode(png).decode()}" in pictures


def test_a_figure_that_is_not_heavy_is_no_bitmap(page_of, monkeypatch):
    """With a limit of ten million bytes, all figures are SVG."""
    monkeypatch.setattr(figures, "HEAVY", 10_000_000)
    assert "data:image/png" not in page_of()


@pytest.fixture
def choice_answer(small_project):
    """Returns the document of the recommendation of a preload."""
    return load_document(small_project / f"{CHOICE}/answer.json")


@pytest.fixture
def lives_answer(small_project):
    """Returns the document of the lives."""
    return load_document(small_project / LIVES_ANSWER)


def test_the_recommendation_is_the_headline_and_the_lives_follow(
    choice_answer, lives_answer, page_text
):
    """Headings on a page about one scene leave out its name, `mine: `.

    The bearing stands before the headline.
    """
    tree = parsed(page_text)
    (headline,) = tree.iter("h1")
    assert words(headline).capitalize() == choice_answer.title.removeprefix("mine: ").capitalize()
    assert lives_answer.facts["beside"] in [words(node) for node in tree.iter("h2")]
    body = words(next(tree.iter("body")))
    assert body.index("9 balls of 2 mm") < body.index(words(headline))


def test_the_page_states_the_question_with_its_requirements(small_project, page_text):
    """After the word stiffness are the required and the reached one, and the speed."""
    question = load_charts(small_project / f"{CHOICE}/charts.json").question
    assert question in words(parsed(page_text))
    _, _, stiffness_words = question.partition("stiffness")
    # N/um, N/um, r/min
    assert numbers_in(stiffness_words)[:3] == [3.0, 3.0, 30000.0]


def test_all_cells_and_sentences_of_answers_are_on_the_page(choice_answer, lives_answer, page_text):
    """Only sentences on requirements are not, which the question above the answers states.

    The title of a block in the place `verdict` need not be on the page.
    """
    page_words = words(parsed(page_text))
    for block in (*choice_answer.blocks, *lives_answer.blocks):
        if block.rows:
            _, lines = block.table
            for cell in (cell for line in lines for cell in line):
                assert " ".join(cell.split()) in page_words, (block.title, cell)
        elif not block.title.startswith("Requirements"):
            assert block.title in page_words or block.place == "verdict"
            assert " ".join(block.lines[0].replace(" um ", " µm ").split()) in page_words


@pytest.fixture
def charts(small_project):
    """Returns the charts of the recommendation of a preload; the first is the main one."""
    return load_charts(small_project / f"{CHOICE}/charts.json").charts


def test_a_chart_has_a_dot_for_every_solved_preload(charts, page_text):
    """Dots lie within the field of their chart; data for the script are the same points."""
    nodes = [node for node in parsed(page_text).iter("figure") if node.get("class") == "chart"]
    assert nodes
    for node, chart in zip(nodes, charts, strict=True):
        (svg,) = [child for child in node.iter() if "data-chart" in child.attrib]
        assert svg.attrib["role"] == "img" and chart.title in svg.attrib["aria-label"]
        lines = json.loads(svg.attrib["data-chart"])["lines"]
        assert [line["points"] for line in lines] == [
            [list(point) for point in line.points] for line in chart.lines
        ]
        dots = [child for child in svg.iter() if child.get("class", "").startswith("dot")]
        ordinates = [y for line in chart.lines for _, y in line.points if y is not None]
        assert len(dots) == len(ordinates) > 0
        width, height = LARGE_CHART if chart is charts[0] else SMALL_CHART
        left, right, top, bottom = MARGINS
        for dot in dots:
            x, y = map(float, re.findall(r"[-\d.]+", dot.attrib["transform"]))  # translate(x y)
            assert 0.0 <= x <= width - left - right and 0.0 <= y <= height - top - bottom


def test_the_main_chart_has_the_lives_of_the_map(charts, small_project):
    """It has a line for each preload method, with a point at each preload of the map."""
    design = load(small_project / f"{CHOICE}/design.nc")
    lives = design["life"].isel(friction=0, shaft_speed=0).values
    for line, expected in zip(charts[0].lines, lives, strict=True):
        life_at = dict(line.points)
        line_lives = [life_at[preload] for preload in design["preload"].values]
        assert line_lives == pytest.approx(list(expected)), line.name


def test_preloads_that_violate_a_limit_are_shaded(charts):
    """Points with a note, which violate a limit, lie inside of the shaded ranges, others outside.

    Points within 0.1 % of the end of a range, where rounding decides, may be on either side.
    """
    lines = [line for chart in charts for line in chart.lines]
    assert any(note for line in lines for note in line.notes)
    for line in lines:
        for (x, _), note in zip(line.points, line.notes, strict=True):
            is_shaded = any(low <= x <= high for low, high in line.beyond)
            ends = [end for shaded_range in line.beyond for end in shaded_range]
            at_end = any(abs(x / end - 1.0) < 1e-3 for end in ends)
            assert at_end or is_shaded == bool(note), (line, x)


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("ends", [(0.3, 0.4), (2.0, 12.0), (17.5, 4480.0), (1e-3, 1e6)])
def test_an_axis_has_a_few_ticks_and_a_margin(log, ends):
    """`share` is the place of a value along the axis, from 0 to 1; both ends lie within it."""
    axis = ChartAxis(ends, log)
    assert 0.0 < axis.share(ends[0]) < axis.share(ends[1]) < 1.0
    ticks = axis.ticks
    # at most three for each of up to four decades, and one for each of more decades
    assert 2 <= len(ticks) <= 13 and all(0.0 <= axis.share(tick) <= 1.0 for tick in ticks)


@pytest.mark.parametrize("name", ["gyro_s1", "turbopump"])
@pytest.mark.parametrize(("ring_name", "side"), [("inner", -1.0), ("outer", 1.0)])
def test_in_a_sketch_the_ball_touches_both_grooves_at_the_contact_angle(name, ring_name, side):
    """The contact lies on the ball, from its centre along the normal at the contact angle.

    Places are x along the axis of the bearing and z from it. side: of the ball with the contact, -1
    towards that axis.
    """
    section = section_of(yaml.safe_load(scene_file(name).read_text())["bearing"])
    ring = getattr(section, ring_name)
    ball_radius, groove_radius = 0.5 * section.ball, ring.groove
    x, z = section.normal
    ball_centre = 0.0, 0.5 * section.pitch
    contact = side * ball_radius * x, ball_centre[1] + side * ball_radius * z
    centre = section.centre(ring)
    assert math.dist(contact, centre) == pytest.approx(groove_radius)
    # the contact is the point of the groove that is nearest to the centre of the ball
    assert math.dist(ball_centre, centre) == pytest.approx(groove_radius - ball_radius)
    assert groove_radius > ball_radius


@pytest.mark.parametrize(("kind", "balls"), [("single", 1), ("spring_pair", 2), ("rigid_pair", 2)])
def test_a_sketch_shows_every_bearing_of_an_arrangement(kind, balls):
    """A bearing is shown by one ball."""
    scene = yaml.safe_load(scene_file("gyro_s1").read_text()) | {"arrangement": {"kind": kind}}
    svg = ET.fromstring(str(sketch(scene)).replace("ø", "o"))
    assert len([node for node in svg.iter() if node.get("class") == "ball"]) == balls


def test_equal_scenes_have_no_differences():
    """A scene is compared with its copy."""
    scene = yaml.safe_load(scene_file("gyro_s1").read_text())
    assert list(differences_by_block(scene, copy.deepcopy(scene))) == []


def test_differences_of_scenes_have_units_and_whole_distributions():
    """Each block has the values of the second scene; what that lacks is `none` or `no preload`."""
    scene = yaml.safe_load(scene_file("gyro_s1").read_text())
    changed = copy.deepcopy(scene)
    changed["bearing"] |= {"ball_count": 10, "contact_angle_deg": 15.0}
    changed["operation"]["preload_N"] = 9.0
    del changed["cage"]
    del changed["uncertainty"]["preload_N"]
    changed["uncertainty"]["ball_race"]["factor"] = 1.5
    differences = {
        block: text.replace("\N{NO-BREAK SPACE}", " ")
        for block, text in differences_by_block(scene, changed)
    }
    assert differences == {
        "bearing": "ball count 10; contact angle 15°",
        "operation": "preload 9 N",
        "cage": "none",
        "uncertainty": "no preload; ball race lognormal, factor 1.5",
    }


def test_an_assumed_input_has_an_asterisk():
    """Of the rows of inputs of gyro_s1, only those of the two assumed keys have one."""
    scene = yaml.safe_load(scene_file("gyro_s1").read_text())
    rows = key_rows([scene], {"cage.width_mm", "uncertainty.ball_race.distribution"})
    labels = {(row.block, row.label) for row in rows if row.label.endswith("*")}
    assert labels == {
        ("cage", "width (mm)\N{NO-BREAK SPACE}*"),
        ("uncertainty", "ball race\N{NO-BREAK SPACE}*"),
    }


def test_inputs_contain_the_friction_that_a_study_varies(small_project, tmp_path, monkeypatch):
    """It is that of the scene, 0.08, though the cases also have 0.02."""
    monkeypatch.chdir(small_project)
    path = tmp_path / "index.html"
    assert main(page_command(path, scenes=["mine.yaml"])) == 0
    page = words(parsed(path.read_text(encoding="utf-8")))
    assert "ball race0.08" in page  # a row of the inputs


def test_the_page_of_a_study_without_answers_counts_its_cases(page_of):
    """All eight are solved."""
    tree = parsed(page_of([f"{FOLDER}/study.nc"], (), ()))
    assert "8 of 8 cases" in words(next(tree.iter("main")))


def test_unsolved_cases_come_first_on_the_page(small_project, tmp_path, page_of):
    """The first paragraph names a life whose status is set to `not_converged`."""
    lives = load(small_project / f"{FOLDER}/wear_life.nc")
    lives["status"][0, 0] = NOT_CONVERGED
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
    """A file is no SVG, no netCDF or no answer, or is missing (None). The exit status is 2."""
    monkeypatch.chdir(small_project)
    path = tmp_path / "bad" / "tables" / name
    path.parent.mkdir(parents=True)
    if content is not None:
        path.write_text(content)
    out = tmp_path / "index.html"
    inputs = {"sections": [f"{FOLDER}/study.nc"], "answers": [], "docs": [path]}
    inputs["answers" if name.endswith(".json") else "sections"].append(path)
    assert main(page_command(out, **inputs)) == 2
    assert str(path) in only_line(capsys)
    assert not out.exists()


def test_the_file_of_a_case_is_refused_as_it_is_no_study(small_project, tmp_path, capsys):
    """The line names the command that shows it."""
    case = small_project / FOLDER / f"{next(iter(GRID.cases()))}.nc"
    assert main(page_command(tmp_path / "index.html", [case], (), ())) == 2
    assert capsys.readouterr().err.startswith(
        f"{case}: got a single result, which `bearingwear show`"
    )


@pytest.mark.parametrize("argument", ["sections", "answers"])
def test_a_file_that_the_page_cannot_show_is_refused(argument, small_project, tmp_path, capsys):
    """Its suffix is .csv; it is refused as a section and as an answer, and no page is written."""
    table = small_project / FOLDER / "tables" / "cases.csv"
    inputs = {"sections": [small_project / FOLDER / "study.nc"], "answers": []}
    inputs[argument].append(table)
    assert main(page_command(tmp_path / "index.html", docs=(), **inputs)) == 2
    assert only_line(capsys).startswith(f"{table}: got the suffix '.csv', expected ")
    assert os.listdir(tmp_path) == []
