"""docs/variables.md is made from the table of variables."""

from dataclasses import replace

from support import ROOT, benchmark

from bearingwear.results.variables import CASE, COORDINATES, LIFE

variables_page = benchmark("variables_page")


def test_the_page_is_up_to_date():
    text = (ROOT / "docs/variables.md").read_text(encoding="utf-8")
    again = "run: python benchmarks/variables_page.py docs/variables.md"
    assert variables_page.page_of_variables() == text, again


def test_every_variable_stands_on_the_page():
    text = variables_page.page_of_variables()
    assert all(f"- `{name}`" in text for name in (*CASE, *LIFE, *COORDINATES))
    assert "- `contact_angle` (ball, race) [degree]: contact angle\n" in text
    assert "- `race` (race): race: inner, outer\n" in text


def test_a_changed_meaning_changes_the_page(monkeypatch):
    other = {"status": replace(LIFE["status"], long_name="something else")}
    monkeypatch.setattr(variables_page, "LIFE", LIFE | other)
    assert "- `status`: something else: see" in variables_page.page_of_variables()
