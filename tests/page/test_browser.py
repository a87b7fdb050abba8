"""The page in a browser: at a desk and on a phone, by day and by night, on paper.

Chromium is asked through Playwright, the extra `page`; without them these tests are skipped, but
for `make test-page`, where they fail. That also looks at the pages named in BEARINGWEAR_PAGES.
"""

import json
import os
import re
import shutil
from pathlib import Path

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

TOO_WIDE = """() => {
  const found = [];
  const shown = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > shown) found.push("the page itself");
  for (const node of document.body.querySelectorAll("*")) {
    const box = node.getBoundingClientRect();
    if (!box.width || node.closest("script, style, svg")) continue;
    const scrolled = node.parentElement.closest("nav, .wide, .plot");
    if (!scrolled && box.right > shown + 1) found.push("beyond the edge: " + node.outerHTML);
    const hidden = node.scrollWidth > node.clientWidth + 1 && node.clientWidth > 0;
    const inline = getComputedStyle(node).display.startsWith("inline");
    if (!hidden || inline) continue;
    if (!node.matches("nav, .wide, .plot")) found.push("cut: " + node.outerHTML);
    const cue = node.matches(".plot")
      ? node.nextElementSibling.getBoundingClientRect().height > 0
      : getComputedStyle(node).backgroundImage.includes("gradient");
    if (!cue) found.push("no cue: " + node.outerHTML);
  }
  return found.map((text) => text.slice(0, 200));
}"""

TOO_NARROW = """() => [...document.querySelectorAll("p, dd, td, th, li, h1, h2, figcaption")]
  .filter((node) => node.getClientRects().length && node.textContent.trim().length > 12)
  .filter((node) => node.clientWidth < 3 * parseFloat(getComputedStyle(node).fontSize))
  .map((node) => node.outerHTML.slice(0, 200))"""

CONTRASTS = """() => {
  const rgba = (text) => text.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((c) => c / 255)
    .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (node) => {
    for (let one = node; one; one = one.parentElement) {
      const colour = rgba(getComputedStyle(one).backgroundColor);
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
    from playwright.sync_api import sync_playwright

    assert CHROMIUM, "needs Chromium"
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield started
        started.close()


@pytest.fixture(params=["small study", *PAGES])
def path(request):
    """The page of a small study, and each that is given."""
    if request.param in PAGES:
        return Path(request.param).resolve()
    return request.getfixturevalue("whole_page")


@pytest.fixture
def opened(browser, path):
    """Function (size, dark=, script=) -> the page, and what it told the console."""
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
        page.on("request", lambda one: messages.append(one.url) if "://" in one.url[5:] else None)
        page.goto(path.as_uri())
        return page, [line for line in messages if line != path.as_uri()]

    yield show
    for context in contexts:
        context.close()


def unfold(page):
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_no_element_is_cut_off_and_the_console_is_empty(opened, size):
    """Folded and unfolded, on a desk and on a phone; the console stays empty."""
    page, messages = opened(size)
    assert messages == []
    assert page.evaluate(TOO_WIDE) == [] and page.evaluate(TOO_NARROW) == []
    unfold(page)
    assert page.evaluate(TOO_WIDE) == [] and page.evaluate(TOO_NARROW) == []


def test_a_cut_would_be_seen(opened):
    page, _ = opened(PHONE)
    page.evaluate("document.querySelector('h1').style.width = '500px'")
    assert any("beyond the edge: <h1" in text for text in page.evaluate(TOO_WIDE))
    page, _ = opened(PHONE)
    page.evaluate("document.querySelector('.cue').style.display = 'none'")
    assert any(text.startswith("no cue") for text in page.evaluate(TOO_WIDE))


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_the_first_screen_says_what_to_do(opened, size):
    """Which bearing, what was asked, the answer, and the chart."""
    page, _ = opened(size)
    for selector in (".eyebrow", "h1", ".asked", ".chart .keys"):
        box = page.locator(selector).first.bounding_box()
        assert box["y"] + box["height"] <= size[1], selector
    chart = page.locator(".chart .field").first.bounding_box()
    assert chart["y"] + (chart["height"] if size == DESK else 60.0) <= size[1]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_enough_contrast_in_both_schemes(opened, scheme):
    page, _ = opened(scheme=scheme)
    unfold(page)
    contrasts = page.evaluate(CONTRASTS)
    assert len(contrasts) > 100
    assert [contrast for contrast in contrasts if contrast[0] < LEAST_CONTRAST] == []
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    dark = sum(map(int, re.findall(r"\d+", paper)[:3])) < 150
    assert dark == (scheme == "dark")


def test_links_lead_somewhere(opened, path):
    page, _ = opened()
    links = page.eval_on_selector_all("a", "links => links.map((one) => one.href)")
    assert links
    for link in links:
        file, _, place = link.removeprefix("file://").partition("#")
        assert Path(file).is_file() if not place else page.locator(f"#{place}").count() == 1, link


def test_the_navigation_stays_and_unfolds(opened):
    page, _ = opened()
    page.evaluate("scrollTo(0, 2000)")
    page.wait_for_function("scrollY > 1000")
    assert page.locator("nav").bounding_box()["y"] == 0.0
    page.locator("nav a", has_text="Inputs").click()
    page.wait_for_timeout(100)
    place = page.locator("#scenes").bounding_box()["y"]
    assert 0.0 <= place < DESK[1]


def test_the_slider_moves_the_cursor_of_all_charts(opened):
    """Its stops are the preloads of the map and the recommended ones; charts say their values."""
    page, _ = opened()
    box = page.locator(".slider").first
    slider, shown = box.locator("input"), box.locator("output")
    charts = page.locator(f".chart[data-group='{box.get_attribute('data-group')}']")
    data = [
        json.loads(item)
        for item in charts.locator("svg[data-chart]").evaluate_all(
            "all => all.map((one) => one.dataset.chart)"
        )
    ]
    keys = charts.locator(".keys b")
    before = keys.all_inner_texts()
    stops = sorted({point[0] for line in data[0]["lines"] for point in line["points"]})
    stars = [line["star"][0] for line in data[0]["lines"] if line["star"]]
    assert set(stars) <= set(stops) and len(stops) > 2
    for k in (0, len(stops) - 1, *(stops.index(star) for star in stars)):
        slider.fill(str(k))
        assert shown.inner_text().startswith(f"Values at {stops[k]:.4g} N")
        assert ("recommended" in shown.inner_text()) == (stops[k] in stars)
        texts = iter(keys.all_inner_texts())
        for chart in data:
            for line in chart["lines"]:
                there = {point[0]: point[1] for point in line["points"]}
                text = next(texts)
                if stops[k] in there and there[stops[k]] is not None:
                    assert float(text.split()[0]) == pytest.approx(
                        there[stops[k]],
                        rel=6e-3,  # shown with three digits
                    )
        assert all(
            d.startswith("M")
            for d in charts.locator(".cursor").evaluate_all(
                "all => all.map((one) => one.getAttribute('d'))"
            )
        )
    slider.focus()
    slider.fill(str(len(stops) - 1))
    page.keyboard.press("ArrowLeft")
    assert shown.inner_text().startswith(f"Values at {stops[-2]:.4g} N")
    if stars:
        box.locator("button").click()
        assert keys.all_inner_texts() == before
    else:  # no preload is recommended to go back to
        assert not box.locator("button").is_visible()


def test_a_chart_says_its_values_and_is_zoomed(opened):
    page, _ = opened()
    chart = page.locator(".chart").first
    box = chart.locator(".field").bounding_box()
    ticks = chart.locator(".grid text")
    whole, keys = ticks.all_inner_texts(), chart.locator(".keys b").all_inner_texts()
    middle = box["y"] + 0.5 * box["height"]
    page.mouse.move(box["x"] + 0.97 * box["width"], middle)
    assert chart.locator(".keys b").all_inner_texts() != keys
    page.mouse.move(box["x"] + 0.3 * box["width"], middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], middle)
    page.mouse.up()
    assert ticks.all_inner_texts() != whole
    page.mouse.dblclick(box["x"] + 0.5 * box["width"], middle)
    assert ticks.all_inner_texts() == whole


def test_the_script_draws_what_the_file_holds(opened):
    """Without it the marks stand where it puts them, as shares of the field."""
    places = """() => [...document.querySelectorAll(".chart")].map((chart) => {
      const field = chart.querySelector(".field");
      const [w, h] = ["width", "height"].map((name) => +field.getAttribute(name));
      return [...chart.querySelectorAll(".dot, .star")].map((mark) => {
        const [x, y] = mark.getAttribute("transform").match(/[-\\d.]+/g).map(Number);
        return [x / w, y / h];
      });
    })"""
    drawn, plain = opened()[0].evaluate(places), opened(script=False)[0].evaluate(places)
    assert len(drawn) == len(plain)
    for node, other in zip(drawn, plain, strict=True):
        for a, b in zip(node, other, strict=True):
            assert a == pytest.approx(b, abs=2e-3)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESK, PHONE])
def test_axe_finds_no_violation_of_its_rules(opened, size, scheme):
    """The rules of WCAG 2 and good practice, as axe-core checks them (`make test-page` has it)."""
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


def test_tables_are_sorted(opened):
    page, _ = opened()
    unfold(page)
    table = page.locator("details table", has_text="against preload").first
    column = [text.split("\n")[0] for text in table.locator("thead th").all_inner_texts()]
    k = next(k for k, text in enumerate(column) if text.startswith("life"))

    def lives():
        texts = table.locator(f"tbody tr > :nth-child({k + 1})").all_inner_texts()
        return [float(text) for text in texts if text != "–"]

    before = lives()
    heading = table.locator("thead th").nth(k)
    heading.locator("button").click()
    assert lives() == sorted(before) and heading.get_attribute("aria-sort") == "ascending"
    heading.locator("button").click()
    assert lives() == sorted(before, reverse=True)
    assert heading.get_attribute("aria-sort") == "descending"


def test_everything_is_there_without_the_script(opened):
    page, messages = opened(script=False)
    assert messages == []
    assert not page.locator(".slider").first.is_visible()
    folded = page.locator("details", has_text="against preload").first
    folded.locator("summary").click()
    assert folded.locator("table").is_visible()
    assert page.locator(".chart .dot").count() and page.locator(".sketch svg").is_visible()


def test_the_page_prints_on_a_few_sheets(opened):
    page, _ = opened()
    printed = page.pdf(prefer_css_page_size=True)
    pages = len(re.findall(rb"/Type\s*/Page\b", printed))
    assert 1 <= pages <= MOST_PAGES
