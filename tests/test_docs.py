"""The pages of docs/: short lines, links that lead somewhere, equations and sections that exist."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from support import ROOT

from bearingwear import __version__
from bearingwear.page.page import GLOSSARY

DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
MARKDOWN_FILES = [*PAGES, *ROOT.glob("*.md"), ROOT / "config/README.md", ROOT / "results/README.md"]
CITED = re.compile(r"\bEqs?\.\s*\(?(\d+a?)\)?(?:\s*(?:-|to|and)\s*\(?(\d+a?)\)?)?")
SECTION = re.compile(r"theory(?:\.md)?\W{0,3}\s*sections?\s+(\d+)")
LINK = re.compile(r"\]\(([^)#\s]+)?(?:#([\w-]+))?\)")


def citing_files():
    """Yields every file that may cite an equation or a section."""
    folders = ("bearingwear", "tests", "benchmarks", "config", "docs", "workflow")
    for folder in folders:
        for suffix in ("py", "md", "yaml", "smk", "rst"):
            yield from (ROOT / folder).rglob(f"*.{suffix}")


def without_code(text: str) -> str:
    """Returns Markdown without its code and formulas."""
    text = re.sub(r"^(```|\$\$).*?^\1", "", text, flags=re.M | re.S)
    return re.sub(r"`[^`]*`", "", text)


def anchors(page: Path) -> set[str]:
    """Returns the anchors (the text after #) of the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)
    plain = (re.sub(r"[^\w -]", "", heading.lower()).strip() for heading in headings)
    return {heading.replace(" ", "-") for heading in plain}


def test_the_readme_is_short_and_links_to_the_main_pages():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 70
    assert all(f"(docs/{page}.md)" in text for page in ("quickstart", "validation", "architecture"))


def test_the_citation_is_that_of_this_version():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["version"] == __version__
    assert cited["license"] == "BSD-3-Clause" and cited["message"] and cited["authors"]
    (paper,) = cited["references"]
    assert paper["journal"] and paper["year"] == 2018 and len(paper["authors"]) == 4
    assert "(CITATION.cff)" in (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("term", ["requirement", "end-of-life criterion"])
def test_the_report_page_defines_a_term_as_the_glossary_does(term):
    glossary = " ".join((DOCS / "glossary.md").read_text(encoding="utf-8").split())
    _, result, after = glossary.partition(f"**{term.capitalize()}**: ")
    assert result
    assert GLOSSARY[term].lower().startswith(after.partition(".")[0].lower())


def test_every_page_is_in_the_navigation():
    def leaves(entry):
        """Returns the pages of an entry of the navigation and of all entries below it."""
        if isinstance(entry, str):
            return [entry]
        children = entry.values() if isinstance(entry, dict) else entry
        return [leaf for child in children for leaf in leaves(child)]

    site = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    generated = {"reference/keys.md", "reference/commands.md", "contributing.md", "changelog.md"}
    pages = {page.relative_to(DOCS).as_posix() for page in PAGES}
    assert sorted(leaves(site["nav"])) == sorted(pages | generated)


@pytest.mark.long
def test_the_site_builds_without_a_warning_or_a_network(tmp_path):
    pytest.importorskip("mkdocs")
    build = [sys.executable, "-m", "mkdocs", "build", "--strict", "-q", "-d", str(tmp_path)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1", "https_proxy": "http://0.0.0.0:1"}
    completed = subprocess.run(build, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert (completed.returncode, completed.stdout, completed.stderr) == (0, "", "")
    for page in tmp_path.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r'(?:<script[^>]*src|<link[^>]*stylesheet[^>]*href)="https?:', text)


def test_every_block_of_code_is_closed():
    assert not [
        page for page in MARKDOWN_FILES if page.read_text(encoding="utf-8").count("```") % 2
    ]


def test_no_line_is_over_100_columns():
    assert not [
        f"{page}:{k}: {line}"
        for page in MARKDOWN_FILES
        for k, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1)
        if len(line) > 100
    ]


def test_links_lead_to_files_and_headings_that_exist():
    """Links to other sites are not followed."""
    broken_links = []
    for page in MARKDOWN_FILES:
        for target, anchor in LINK.findall(without_code(page.read_text(encoding="utf-8"))):
            if "://" in target:
                continue
            file = (page.parent / target).resolve() if target else page
            is_page = file.exists() and file.suffix == ".md"
            if not file.exists() or (anchor and is_page and anchor not in anchors(file)):
                broken_links.append((page, target, anchor))
    assert not broken_links


def test_cited_equations_and_sections_exist():
    """Every equation and section of the theory that a file cites by its number is in docs/theory.

    Equations have different tags, of which those from 1 to 77 exist but for `unused`. The overview
    theory.md lists all sections.
    """
    tags, numbers = [], []
    for page in (DOCS / "theory").glob("*.md"):
        text = page.read_text(encoding="utf-8")
        tags += re.findall(r"\\tag\{(\d+a?)\}", text)
        numbers += re.findall(r"^# (\d+) ", text, re.M)
    unused = {"57", "68", "69", "70"}  # numbers of equations that are no longer there
    assert len(tags) == len(set(tags)) and {str(k) for k in range(1, 78)} - unused <= set(tags)
    overview = (DOCS / "theory.md").read_text(encoding="utf-8")
    assert sorted(numbers, key=int) == re.findall(r"^\| (\d+) \| \[", overview, re.M)
    cited = []
    for path in citing_files():
        text = path.read_text(encoding="utf-8")
        cited += [(path, number) for ends in CITED.findall(text) for number in ends if number]
        assert set(SECTION.findall(text)) <= set(numbers), path
    assert len(cited) > 25  # so that citations are found at all
    assert not [(path, number) for path, number in cited if number not in tags]


def test_every_formula_becomes_mathml():
    convert = pytest.importorskip("latex2mathml.converter").convert
    formulas = []
    for page in (DOCS / "theory").glob("*.md"):
        formulas += re.findall(r"^\$\$\n(.*?)^\$\$", page.read_text("utf-8"), re.M | re.S)
    assert len(formulas) > 50
    for formula in formulas:
        assert "merror" not in convert(re.sub(r"\\tag\{\w+\}", "", formula), display="block")
