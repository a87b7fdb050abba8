"""The page in a browser: on a large screen and a phone, light and dark, with and without a script.

Chromium is run by Playwright (the extra `page`). Without them these tests are skipped, except by
`make test-page`, where they fail; it also tests the pages named in BEARINGWEAR_PAGES.
"""

import json
import os
import re
import shutil
from pathlib import Path
from typing import Any, NamedTuple

import pytest

REQUIRED = "BEARINGWEAR_PAGES" in os.environ
PAGES = os.environ.get("BEARINGWEAR_PAGES", "").split()
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
DESK, PHONE = (1280, 900), (390, 844)
AXE = Path(os.environ.get("BEARINGWEAR_AXE", "build/axe/node_modules/axe-core/axe.min.js"))
MOST_PAGES = 8  # on paper
LEAST_CONTRAST = 4.5  # WCAG 2, AA

if not REQUIRED:
    pytest.importorskip("playwright", reason="needs the extra `page`")
    if not CHROMIUM:
        pytest.skip("needs Chromium", allow_module_level=True)

# JavaScript: elements that reach beyond the edge of the screen, are cut, or scroll without a cue.
TOO_WIDE = """() => {
  const faults = [];
  const width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width) faults.push("the page itself");
  for (const node of document.body.querySelectorAll("*")) {
    const box = node.getBoundingClientRect();
    if (!box.width || node.closest("script, style, svg")) continue;
    const scrolled = node.parentElement.closest("nav, .wide, .plot");
    if (!scrolled && box.right > width + 1) faults.push("beyond the edge: " + node.outerHTML);
    const hidden = node.scrollWidth > node.clientWidth + 1 && node.clientWidth > 0;
    const inline = getComputedStyle(node).display.startsWith("inline");
    if (!hidden || inline) continue;
    if (!node.matches("nav, .wide, .plot")) faults.push("cut: " + node.outerHTML);
    const cue = node.matches(".plot")
      ? node.nextElementSibling.getBoundingClientRect().height > 0
      : getComputedStyle(node).backgroundImage.includes("gradient");
    if (!cue) faults.push("no cue: " + node.outerHTML);
  }
  return faults.map((text) => text.slice(0, 200));
}"""

# JavaScript: visible texts over 12 characters in boxes narrower than three times their font size.
TOO_NARROW = """() => [...document.querySelectorAll("p, dd, td, th, li, h1, h2, figcaption")]
  .filter((node) => node.getClientRects().length && node.textContent.trim().length > 12)
  .filter((node) => node.clientWidth < 3 * parseFloat(getComputedStyle(node).fontSize))
  .map((node) => node.outerHTML.slice(0, 200))"""

# JavaScript: contrast by WCAG 2 of each element that has text, and the beginning of its markup.
CONTRASTS = """() => {
  const rgba = (text) => text.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((c) => c / 255)
    .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (node) => {
    for (let box = node; box; box = box.parentElement) {
      const colour = rgba(getComputedStyle(box).backgroundColor);
      if (colour.length < 4 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  return [...document.body.querySelectorAll("*")]
    .filter((node) => [...node.childNodes].some((c) => c.nodeType === 3 && c.data.trim()))
    .filter((node) => node.getClientRects().length)
    .map((node) => {
      const [a, b] = [rgba(getComputedStyle(node).color), behind(node)].map(light);
      return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), node.outerHTML.slice(0, 120)];
    });
}"""


@pytest.fixture(scope="module")
def browser():
    """Yields Chromium."""
    from playwright.sync_api import sync_playwright

    assert CHROMIUM, "needs Chromium"
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield started
        started.close()


@pytest.fixture(params=["small study", *PAGES])
def path(request):
    """Returns the path of the page of a small study, and of each page in BEARINGWEAR_PAGES."""
    if request.param in PAGES:
        return Path(request.param).resolve()
    return request.getfixturevalue("whole_page")


@pytest.fixture
def opened(browser, path):
    """Yields a function that opens the page, and returns it and its console messages.

    Requests of other files are among the messages. Its arguments are the size of the screen, the
    colour scheme, and whether scripts run.
    """
    contexts = []

    def show(size=DESK, scheme="light", script=True):
        context = browser.new_context(
            viewport=dict(zip(("width", "height"), size, strict=True)),
            color_scheme=scheme,
            java_script_enabled=script,
        )
        contexts.append(context)
        page = context.new_page()
        messages = []
        page.on("console", lambda message: messages.append(message.text))
        page.on("pageerror", lambda error: messages.append(str(error)))
        page.on("request", lambda request: messages.append(request.url))
        page.goto(path.as_uri())
        page_requests = path.as_uri(), "data:"
        return page, [line for line in messages if not line.startswith(page_requests)]

    yield show
    for context in contexts:
        context.close()


def unfold(page):
    """Opens all folded parts of a page."""
    page.evaluate("for (const part of document.querySelectorAll('details')) part.open = true")


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_no_element_is_cut_off_and_the_console_is_empty(opened, size):
    """That is so with folded and unfolded parts, on a desk and on a phone; nothing is fetched."""
    page, messages = opened(size)
    assert messages == []
    assert page.evaluate(TOO_WIDE) == [] and page.evaluate(TOO_NARROW) == []
    unfold(page)
    assert page.evaluate(TOO_WIDE) == [] and page.evaluate(TOO_NARROW) == []


def test_an_element_beyond_the_edge_is_detected(opened):
    """A heading has 500 pixels on a phone of 390, which TOO_WIDE must find."""
    page, _ = opened(PHONE)
    page.evaluate("document.querySelector('h1').style.width = '500px'")
    assert any("beyond the edge: <h1" in text for text in page.evaluate(TOO_WIDE))


def test_a_table_that_scrolls_without_a_cue_is_detected(opened):
    """On a phone, where a table scrolls, its cue is hidden, which TOO_WIDE must find."""
    page, _ = opened(PHONE)
    page.evaluate("document.querySelector('.cue').style.display = 'none'")
    assert any(text.startswith("no cue") for text in page.evaluate(TOO_WIDE))


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_the_first_screen_has_bearing_question_answer_and_chart(opened, size):
    """On a phone, the upper 60 pixels of the chart suffice."""
    page, _ = opened(size)
    for selector in (".eyebrow", "h1", ".asked", ".chart .keys"):
        box = page.locator(selector).first.bounding_box()
        assert box["y"] + box["height"] <= size[1], selector
    chart = page.locator(".chart .field").first.bounding_box()
    assert chart["y"] + (chart["height"] if size == DESK else 60.0) <= size[1]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_enough_contrast_in_both_schemes(opened, scheme):
    """Contrasts are 4.5 or more, and the background is dark only in the dark scheme."""
    page, _ = opened(scheme=scheme)
    unfold(page)
    contrasts = page.evaluate(CONTRASTS)
    assert len(contrasts) > 100  # texts of the page
    assert [contrast for contrast in contrasts if contrast[0] < LEAST_CONTRAST] == []
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    is_dark = sum(map(int, re.findall(r"\d+", paper)[:3])) < 150  # of 3 x 255
    assert is_dark == (scheme == "dark")


def test_every_link_leads_to_a_file_or_an_element(opened, path):
    """Links are followed as the browser resolves them; the page has each linked element once."""
    page, _ = opened()
    links = page.eval_on_selector_all("a", "links => links.map((link) => link.href)")
    assert links
    for link in links:
        file, _, place = link.removeprefix("file://").partition("#")
        if place:
            assert page.locator(f"#{place}").count() == 1, link
        else:
            assert Path(file).is_file(), link


def test_the_navigation_stays_at_the_top(opened):
    """The page is scrolled by 2000 pixels, or to its end."""
    page, _ = opened()
    page.evaluate("scrollTo(0, 2000)")
    page.wait_for_function("scrollY > 1000")
    assert page.locator("nav").bounding_box()["y"] == 0.0


def test_the_navigation_leads_to_a_folded_part(opened):
    """The inputs are on the screen after a click, and the time of a frame or two."""
    page, _ = opened()
    page.locator("nav a", has_text="Inputs").click()
    page.wait_for_timeout(100)
    place = page.locator("#scenes").bounding_box()["y"]
    assert 0.0 <= place < DESK[1]


class Slider(NamedTuple):
    """The slider of the preload, and the charts whose cursor it moves."""

    control: Any  # a locator of Playwright, as are the next four; contains input, words, a button
    input: Any
    words: Any
    charts: Any
    values: Any  # of all lines of all charts
    chart_data: list[dict]  # of each chart, for the script
    stops: list[float]  # preloads [N]
    stars: list[float]  # recommended preloads [N]


@pytest.fixture
def slider(opened):
    """Returns the first slider of the page, which has just been opened."""
    page, _ = opened()
    control = page.locator(".slider").first
    charts = page.locator(f".chart[data-group='{control.get_attribute('data-group')}']")
    texts = charts.locator("svg[data-chart]").evaluate_all(
        "charts => charts.map((chart) => chart.dataset.chart)"
    )
    chart_data = [json.loads(text) for text in texts]
    lines = chart_data[0]["lines"]
    return Slider(
        control=control,
        input=control.locator("input"),
        words=control.locator("output"),
        charts=charts,
        values=charts.locator(".keys b"),
        chart_data=chart_data,
        stops=sorted({point[0] for line in lines for point in line["points"]}),
        stars=[line["star"][0] for line in lines if line["star"]],
    )


def test_the_slider_stops_at_the_preloads_of_the_map_and_the_recommended_ones(slider):
    """Its words have the preload of each stop, and say which are recommended."""
    assert set(slider.stars) <= set(slider.stops) and len(slider.stops) > 2
    for k, stop in enumerate(slider.stops):
        slider.input.fill(str(k))
        words = slider.words.inner_text()
        assert words.startswith(f"Values at {stop:.4g} N")
        assert ("recommended" in words) == (stop in slider.stars)


def test_all_charts_state_their_values_at_the_slider_and_draw_a_cursor(slider):
    """Values have three digits. For a line without a point there, any value is right."""
    for k in (0, len(slider.stops) - 1, *(slider.stops.index(star) for star in slider.stars)):
        slider.input.fill(str(k))
        lines = [line for chart in slider.chart_data for line in chart["lines"]]
        for line, text in zip(lines, slider.values.all_inner_texts(), strict=True):
            value = dict(line["points"]).get(slider.stops[k])
            if value is not None:
                # half of the last digit of 1.00 is 5e-3
                assert float(text.split()[0]) == pytest.approx(value, rel=6e-3)
        cursors = slider.charts.locator(".cursor").evaluate_all(
            "cursors => cursors.map((cursor) => cursor.getAttribute('d'))"
        )
        assert all(path.startswith("M") for path in cursors)


def test_an_arrow_key_moves_the_slider_by_one_stop(slider):
    """The left arrow moves it from the last stop to the one before."""
    slider.input.focus()
    slider.input.fill(str(len(slider.stops) - 1))
    slider.input.press("ArrowLeft")
    assert slider.words.inner_text().startswith(f"Values at {slider.stops[-2]:.4g} N")


def test_a_button_shows_the_values_at_the_recommended_preloads_again(slider):
    """The page shows these values at first. Without a recommended preload, the button is hidden."""
    button = slider.control.locator("button")
    if not slider.stars:
        assert not button.is_visible()
        return
    initial_values = slider.values.all_inner_texts()
    slider.input.fill("0")
    button.click()
    assert slider.values.all_inner_texts() == initial_values


def test_a_chart_states_the_values_at_the_mouse(opened):
    """Near the right edge, they differ from the values at the recommended preloads."""
    page, _ = opened()
    chart = page.locator(".chart").first
    field, values = chart.locator(".field").bounding_box(), chart.locator(".keys b")
    initial_values = values.all_inner_texts()
    middle_y = field["y"] + 0.5 * field["height"]
    page.mouse.move(field["x"] + 0.97 * field["width"], middle_y)
    assert values.all_inner_texts() != initial_values


def test_a_chart_is_zoomed_by_dragging_and_reset_by_a_double_click(opened):
    """The ticks of its axes change, and are the initial ones again after the double click."""
    page, _ = opened()
    chart = page.locator(".chart").first
    field, ticks = chart.locator(".field").bounding_box(), chart.locator(".grid text")
    initial_ticks = ticks.all_inner_texts()
    middle_y = field["y"] + 0.5 * field["height"]
    page.mouse.move(field["x"] + 0.3 * field["width"], middle_y)
    page.mouse.down()
    page.mouse.move(field["x"] + 0.6 * field["width"], middle_y)
    page.mouse.up()
    assert ticks.all_inner_texts() != initial_ticks
    page.mouse.dblclick(field["x"] + 0.5 * field["width"], middle_y)
    assert ticks.all_inner_texts() == initial_ticks


def test_the_script_draws_marks_where_the_file_has_them(opened):
    """Places are shares of the field, to 2e-3: the file has tenths of a pixel of a few hundred."""
    places = """() => [...document.querySelectorAll(".chart")].map((chart) => {
      const field = chart.querySelector(".field");
      const [w, h] = ["width", "height"].map((name) => +field.getAttribute(name));
      return [...chart.querySelectorAll(".dot, .star")].map((mark) => {
        const [x, y] = mark.getAttribute("transform").match(/[-\\d.]+/g).map(Number);
        return [x / w, y / h];
      });
    })"""
    page, _ = opened()
    page_without_script, _ = opened(script=False)
    by_script, in_file = page.evaluate(places), page_without_script.evaluate(places)
    for script_marks, file_marks in zip(by_script, in_file, strict=True):
        for script_place, file_place in zip(script_marks, file_marks, strict=True):
            assert script_place == pytest.approx(file_place, abs=2e-3)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESK, PHONE])
def test_axe_finds_no_violation_of_its_rules(opened, size, scheme):
    """axe-core, which `make test-page` installs, checks rules of WCAG 2 and of good practice."""
    if not AXE.is_file():
        pytest.skip("needs axe-core")
    page, _ = opened(size, scheme)
    unfold(page)
    page.evaluate(AXE.read_text(encoding="utf-8"))
    report = page.evaluate("axe.run(document)")
    assert len(report["passes"]) > 20
    assert [
        (violation["id"], violation["nodes"][0]["html"][:200]) for violation in report["violations"]
    ] == []


def test_a_click_on_a_head_sorts_a_table_by_its_column(opened):
    """The first click sorts in rising order, the second in falling order."""
    page, _ = opened()
    unfold(page)
    table = page.locator("details table", has_text="against preload").first
    heads = table.locator("thead th").all_inner_texts()
    k = next(k for k, head in enumerate(heads) if head.startswith("life"))

    def lives():
        """Returns the lives in the order of the rows, without missing ones."""
        texts = table.locator(f"tbody tr > :nth-child({k + 1})").all_inner_texts()
        return [float(text) for text in texts if text != "–"]

    initial_lives = lives()
    heading = table.locator("thead th").nth(k)
    heading.locator("button").click()
    assert lives() == sorted(initial_lives) and heading.get_attribute("aria-sort") == "ascending"
    heading.locator("button").click()
    assert lives() == sorted(initial_lives, reverse=True)
    assert heading.get_attribute("aria-sort") == "descending"


def test_tables_charts_and_sketch_are_visible_without_the_script(opened):
    """The slider, which would do nothing, is hidden."""
    page, messages = opened(script=False)
    assert messages == []
    assert not page.locator(".slider").first.is_visible()
    folded = page.locator("details", has_text="against preload").first
    folded.locator("summary").click()
    assert folded.locator("table").is_visible()
    assert page.locator(".chart .dot").count() and page.locator(".sketch svg").is_visible()


def test_the_page_prints_on_a_few_sheets(opened):
    """The PDF that the browser prints has at most eight pages."""
    page, _ = opened()
    printed = page.pdf(prefer_css_page_size=True)
    pages = len(re.findall(rb"/Type\s*/Page\b", printed))
    assert 1 <= pages <= MOST_PAGES
