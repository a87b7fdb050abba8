"""docs/variables.md is made from the table of variables."""

from support import ROOT, benchmark

variables_page = benchmark("variables_page")


def test_the_page_is_up_to_date():
    text = (ROOT / "docs/variables.md").read_text(encoding="utf-8")
    again = "run: python benchmarks/variables_page.py docs/variables.md"
    assert variables_page.page_of_variables() == text, again
