"""docs/tutorial.md, docs/python.md and the README: what they say to run is run.

Of each block of output the lines must stand in what the block of commands before it printed,
numbers to a part in a thousand.
"""

import os
import re
import subprocess
import sys

import pytest
from support import ROOT

NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]?\d+)?")


def blocks(path):
    """(language, text) of every fenced block of a Markdown file."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", path.read_text(encoding="utf-8"), re.M | re.S)


def agree(said: str, printed: str) -> bool:
    """Whether two lines are the same but for the last digits of their numbers."""
    words, others = said.split(), printed.split()
    if len(words) != len(others):
        return False
    return all(
        float(a) == pytest.approx(float(b), rel=1e-3)
        if NUMBER.fullmatch(a) and NUMBER.fullmatch(b)
        else a == b
        for a, b in zip(words, others, strict=True)
    )


@pytest.fixture
def run(tmp_path):
    """Function (language, text) -> what it prints, in a folder of its own."""
    command = tmp_path / "bin" / "bearingwear"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m bearingwear "$@"\n')
    command.chmod(0o755)
    folder = tmp_path / "empty"
    folder.mkdir()
    environment = os.environ | {
        "PATH": f"{command.parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "MPLBACKEND": "agg",
    }

    def run(language, text):
        argv = {"sh": ["bash", "-eu", "-c"], "python": [sys.executable, "-c"]}[language]
        done = subprocess.run(
            [*argv, text], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}{done.stderr}"
        return done.stdout

    run.folder = folder
    return run


def test_tutorial(run):
    printed, python, compared = "", "", 0
    for language, text in blocks(ROOT / "docs/tutorial.md"):
        if language == "text":
            lines = printed.splitlines()
            for said in text.splitlines():
                assert any(agree(said, line) for line in lines), f"{said!r} is not in\n{printed}"
                compared += 1
        elif language == "python":
            python += text  # a block goes on from the ones before it
            printed = run("python", python)
        else:
            printed = run(language, text)
    assert compared > 40
    drawn = (run.folder / "life_against_preload.svg").read_text(encoding="utf-8")
    assert "</svg>" in drawn


def test_python_page(run):
    (run.folder / "mine.yaml").symlink_to(ROOT / "config/scenes/gyro_s1.yaml")
    found = blocks(ROOT / "docs/python.md")
    printed = run("python", "".join(text for language, text in found if language == "python"))
    said = [line for language, text in found if language == "text" for line in text.splitlines()]
    assert len(said) >= 3 and not set(said) - set(printed.splitlines()), printed
    assert {path.name for path in run.folder.iterdir()} == {
        "mine.yaml", "stiffer.yaml", "case.nc", "case.svg", "life.svg",
    }  # fmt: skip


def test_readme_python(run):
    (run.folder / "config").symlink_to(ROOT / "config")
    python = [text for language, text in blocks(ROOT / "README.md") if language == "python"]
    assert python and "solve" in python[0]
    assert "life" in run("python", python[0])


TAKES_MINUTES = (
    "bearingwear life mine.yaml -o dynamic-life.nc",
    "bearingwear life config/scenes/gyro_s1.yaml -o worn.nc",
    "bearingwear plot worn.nc",  # which the line before makes
    "bearingwear study",
)
"""Lines of the README that are not run here, as those of make, pip, git and Snakemake."""


def test_readme_lines_as_typed(run):
    (run.folder / "config").symlink_to(ROOT / "config")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = re.findall(r"^    (bearingwear .*)$", readme, re.M)
    outputs = re.findall(r" -o (\S+)", "\n".join(lines))
    assert len(outputs) == len(set(outputs)), "a line overwrites what another one made"
    typed = [line for line in lines if not line.startswith(TAKES_MINUTES)]
    assert len(typed) >= 10
    for line in typed:
        differs = " || test $? = 1" if line.startswith("bearingwear compare") else ""
        assert run("sh", line.partition("#")[0] + differs) or " -o " in line
