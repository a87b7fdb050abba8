"""Every block of commands in the docs and the README is run, and prints what stands below it.

Blocks marked `sh` and `python` are run here, page by page and in order; blocks marked `bash` take
minutes and are run by `make test-long`. Blocks marked `console` show lines that other tests run.
Of each block marked `text` the lines must stand in what was printed before it, numbers to a part
in a thousand.
"""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import warnings

import pytest
from support import ROOT

from bearingwear.cli import main

OURS = re.compile(r"bearingwear (?!study)[^|<>&;$*]*( \|\| test \$\? = \d+)?")
"""A line that only calls `bearingwear`, and so needs no shell."""

STATEMENT = re.compile(r"^.*<<'END'\n(?:.*\n)*?END\n|^(?:.*\\\n)*.*\n", re.M)
"""A command with the lines that continue it, or the document that follows it."""

NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]?\d+)?")
PAGES = sorted([*ROOT.glob("docs/**/*.md"), *ROOT.glob("*.md"), ROOT / "config/README.md"])
RUN_ELSEWHERE = {"README.md": "docs/quickstart.md"}
"""Pages that are not run, and those that have the same lines and are run."""

SHOWN = {
    r"pip install -c constraints.txt \.$": "tests/test_installed.py::installed",
    r"pip install .*\[slurm\]|snakemake --workflow-profile \S+$": (
        "tests/workflow/test_slurm.py::test_a_study_on_slurm_has_the_same_bytes"
    ),
    r"python3 -m venv": "tests/test_installed.py::installed",
    r"make venv": "tests/test_set_up.py::test_make_sets_up_the_environment_once",
    r"make study|snakemake -j2( --rerun-incomplete)?$|bearingwear study$": (
        "tests/workflow/test_study.py::test_a_run_makes_everything_and_then_nothing"
    ),
    r"grep .* workflow/rules/": (
        "tests/workflow/test_rules.py::test_every_rule_has_a_name_and_no_rule_is_made_in_a_loop"
    ),
    r"snakemake --list": (
        "tests/workflow/test_rules.py::test_a_rule_says_in_a_sentence_what_it_makes"
    ),
    r"snakemake -n": "tests/workflow/test_study.py::test_every_study_is_planned",
    r"snakemake -j2 \w+": "tests/workflow/test_study.py::test_every_study_is_planned",
    r"snakemake -j2 -f results": "tests/workflow/test_study.py::test_a_forced_case_is_solved_again",
    r"bearingwear study (results/\S+\.nc|-n)$": (
        "tests/workflow/test_study.py::test_a_result_is_made_again_by_the_command_study"
    ),
    r"bearingwear study mine\.yaml( --\w+ [\d.]+)+$": (
        "tests/workflow/test_own.py::test_a_study_of_one_scene_ends_with_its_page"
    ),
    r"(snakemake|bearingwear study) --unlock": (
        "tests/workflow/test_faults.py::test_a_study_goes_on_after_all_its_processes_are_killed"
    ),
    r"(snakemake|bearingwear study all) --report": (
        "tests/workflow/test_study.py::test_the_report_of_snakemake_has_every_figure"
    ),
    r"snakemake --workflow-profile .* --executor cluster-generic": (
        "tests/workflow/test_submit_command.py::test_a_study_by_a_submit_command_has_the_same_bytes"
    ),
    r"make (test|quick|test-\w+|fuzz|docs|gallery)$": "Makefile",
    r"python benchmarks/\w+\.py( \w+| -o \S+)?$": "benchmarks",
}
"""Lines of `console` blocks, and the test or the program that runs them."""


def blocks(path):
    """Returns pairs (language, text) of all fenced blocks of a Markdown file."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", path.read_text(encoding="utf-8"), re.M | re.S)


def commands(path, languages=("sh", "bash")):
    """Returns the lines of a page's blocks in some languages, as `lines_of` does."""
    return lines_of("".join(text for language, text in blocks(path) if language in languages))


def lines_of(text):
    """Returns the lines of a block that are not empty, without comments, continued ones joined."""
    lines = (line.partition(" #")[0].strip() for line in text.replace("\\\n", " ").splitlines())
    return [line for line in lines if line]


def agree(documented: str, actual: str) -> bool:
    """Returns whether two lines have the same words, and numbers that agree to 1e-3."""
    documented_words, actual_words = documented.split(), actual.split()
    if len(documented_words) != len(actual_words):
        return False
    return all(
        float(a) == pytest.approx(float(b), rel=1e-3)
        if NUMBER.fullmatch(a) and NUMBER.fullmatch(b)
        else a == b
        for a, b in zip(documented_words, actual_words, strict=True)
    )


def printed(function, *arguments) -> str:
    """Returns what a function prints, called in this process: another takes a second to start."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        function(*arguments)
    return output.getvalue()


def run_command(line: str) -> None:
    """Runs a command of ours in this process.

    Its status must be 0, or the one that the line allows by `|| test $? = N`.
    """
    command, _, allowed = line.partition(" || test $? = ")
    status = main(shlex.split(command)[1:])
    assert status in {0, int(allowed or 0)}, line


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Returns a function (language, text) that runs a block and returns what it prints.

    It runs in a folder of its own, its attribute `folder`, with copies of config/ and of the
    gallery. Blocks of Python share their names; lines that only call ours need no shell.
    """
    command = tmp_path / "bin" / "bearingwear"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m bearingwear "$@"\n')
    command.chmod(0o755)
    folder = tmp_path / "empty"
    folder.mkdir()
    shutil.copytree(ROOT / "config", folder / "config")
    shutil.copytree(ROOT / "docs/gallery", folder / "docs/gallery")
    names = {"__name__": "__main__"}  # of one Python, block after block
    environment = os.environ | {
        "PATH": f"{command.parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "MPLBACKEND": "agg",
    }

    def run(language, text):
        if language == "python":
            with warnings.catch_warnings(category=UserWarning, action="ignore"):  # of its scenes
                return printed(exec, compile(text, "block", "exec"), names)
        return "".join(map(by_shell, STATEMENT.findall(text)))

    def by_shell(statement):
        lines = lines_of(statement)
        if all(OURS.fullmatch(line) for line in lines):
            return "".join(printed(run_command, line) for line in lines)
        completed = subprocess.run(
            ["bash", "-eu", "-c", statement],
            cwd=folder, env=environment, capture_output=True, text=True, timeout=3600,
        )  # fmt: skip
        assert completed.returncode == 0, f"{statement}\n{completed.stdout}{completed.stderr}"
        return completed.stdout

    monkeypatch.chdir(folder)
    monkeypatch.setenv("MPLBACKEND", "agg")
    run.folder = folder
    return run


def compared_lines(run, page, languages):
    """Runs the blocks of a page in some languages; returns how many lines of `text` it compared.

    Each of these must stand in what the block before it printed. Text below a block that is not run
    is not compared.

    run: function of the fixture `run`.
    """
    output, compared = "", 0
    if page.name == "python.md":  # which loads a file of the reader's
        shutil.copy(ROOT / "config/scenes/gyro_s1.yaml", run.folder / "mine.yaml")
    ran = False
    for language, text in blocks(page):
        if language == "text" and ran:
            lines = output.splitlines()
            for documented_line in text.splitlines():
                assert any(agree(documented_line, line) for line in lines), (
                    f"{documented_line!r} is not in\n{output}"
                )
                compared += 1
        elif language == "python" and language in languages:
            output = run("python", text)
        elif language in languages:
            output = run("sh", text)
        if language in ("sh", "bash", "python"):
            ran = language in languages
    return compared


def named(page):
    """Returns the path of a page from the root of the project."""
    return page.relative_to(ROOT).as_posix()


GALLERY = ("dental-drill", "mos2-film", "spindle-pair", "sweep")
SLOW = ("docs/cage.md", "docs/calibrate.md", "docs/dynamic.md")
SLOW += tuple(f"docs/gallery/{name}.md" for name in GALLERY)
"""Pages whose blocks of `sh` and `python` take many seconds: `make test-long` runs them."""

SLOW_PYTHON = ("docs/tutorial.md",)
"""Pages of which `make test` leaves out the Python, sixteen lives with grooves as they wear."""


def with_marks(pages):
    """Returns pages, the slow ones marked as long, so that `make test` leaves them out.

    Slow ones with a block of `bash` are omitted: the test of such pages runs them as a whole.
    """
    slow = [page for page in pages if named(page) in SLOW]
    alone = [page for page in slow if page not in holding("bash")]
    quick = [page for page in pages if page not in slow]
    return [*quick, *(pytest.param(page, marks=pytest.mark.long) for page in alone)]


def holding(*languages):
    """Returns the pages that are run and have a block in one of these languages."""
    pages = (page for page in PAGES if named(page) not in RUN_ELSEWHERE)
    return [page for page in pages if any(name in languages for name, _ in blocks(page))]


@pytest.mark.parametrize("page", with_marks(holding("sh", "python")), ids=named)
def test_a_page_prints_what_it_shows(run, page):
    """The tutorial has more than 20 lines to compare, and the page on Python four or more.

    The page on Python writes just the files that it names.
    """
    languages = ("sh",) if named(page) in SLOW_PYTHON else ("sh", "python")
    compared = compared_lines(run, page, languages)
    names = {path.name for path in run.folder.iterdir()}
    if page.name == "tutorial.md":
        assert compared > 20
    if page.name == "python.md":
        assert compared >= 4
        figures = {"case.svg", "life.svg"}
        files = {"mine.yaml", "stiffer.yaml", "case.nc", "softer.nc", *figures}
        files |= {"part1.nc", "part2.nc", "states.nc", "tests.csv"}
        assert names == {"config", "docs", *files}


@pytest.mark.long
@pytest.mark.parametrize("page", holding("bash"), ids=named)
def test_a_page_that_takes_minutes_prints_what_it_shows(run, page):
    """All of its blocks are run. The tutorial has more than 50 lines to compare, and a figure."""
    compared = compared_lines(run, page, ("sh", "bash", "python"))
    if page.name == "tutorial.md":
        assert compared > 50
        drawn = (run.folder / "life_against_preload.svg").read_text(encoding="utf-8")
        assert "</svg>" in drawn


def shown_lines(page):
    """Returns the set of lines that a page shows below its commands."""
    texts = [text for language, text in blocks(page) if language == "text"]
    return {line for text in texts for line in text.split("\n")}


@pytest.mark.parametrize("page, run_page", RUN_ELSEWHERE.items())
def test_the_lines_of_a_page_that_is_not_run_are_those_of_one_that_is(page, run_page):
    """The other page has its commands in the same order, and the lines that they print."""
    here, there = commands(ROOT / page), commands(ROOT / run_page)
    assert here and [line for line in there if line in here] == here
    assert shown_lines(ROOT / page) <= shown_lines(ROOT / run_page)


def test_documented_commands_write_different_files():
    """No page writes a file twice by the option `-o`."""
    for page in PAGES:
        outputs = re.findall(r" -o (\S+)", "\n".join(commands(page)))
        assert len(outputs) == len(set(outputs)), page


def test_every_line_that_is_only_shown_is_run_by_a_test():
    """SHOWN has a pattern for each, and what it names is there: a test, a target or a program."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for page in PAGES:
        for line in commands(page, ("console",)):
            places = {place for pattern, place in SHOWN.items() if re.match(pattern, line)}
            assert len(places) == 1, f"{named(page)}: {line}"
            (place,) = places
            # without a number of jobs Snakemake runs none
            assert not re.match("snakemake", line) or re.search(
                r" (-j\d|-n|--list|--unlock|--report|--workflow-profile)\b", line
            ), line
            if place == "Makefile":
                assert re.search(rf"^{line.split()[1]}:", makefile, re.M), line
            elif place == "benchmarks":
                assert (ROOT / line.split()[1]).exists(), line
            else:
                file, _, name = place.partition("::")
                assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), place


def test_commands_are_in_blocks_with_a_language():
    """None is in an indented block, and each language is one that these tests know."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert not re.search(r"^ {4}(bearingwear|snakemake|make|python3?|pip) ", text, re.M), page
        assert {name for name, _ in blocks(page)} <= {
            "sh", "bash", "python", "console", "text", "yaml",
            "py",  # needs packages that are not installed here
        }, page  # fmt: skip
