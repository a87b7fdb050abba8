"""The rules as text: each says what it makes, and calls a function that is there."""

import importlib
import importlib.util
import inspect
import re
import tomllib

from support import ROOT, benchmark

from bearingwear import commands
from bearingwear.provenance import PACKAGE, sources

FILES = sorted(ROOT.glob("workflow/rules/*.smk"))
TEXT = "\n".join(file.read_text(encoding="utf-8") for file in FILES)
RULE_TABLE = benchmark("rule_table")
# by names of rules: their text, their line of the shell, and such a line if it runs a step of ours
RULES = {name: body for name, _, body in RULE_TABLE.rules()}
SHELL_LINES = {name: RULE_TABLE.shell_line(body) for name, body in RULES.items()}
STEPS = {name: line for name, line in SHELL_LINES.items() if "bearingwear step " in line}


def test_every_rule_has_a_name_and_no_rule_is_made_in_a_loop():
    """There are as many names of rules as lines that begin with the word `rule`: more than 30."""
    assert len(RULES) == len(re.findall(r"^ *rule\b", TEXT, re.M)) > 30


def test_a_rule_says_in_a_sentence_what_it_makes():
    """Its docstring has one line, from a capital letter to a full stop or a bracket."""
    without_sentence = [
        name for name, body in RULES.items() if not re.match(r'    """[A-Z].*\S[.)]"""\n', body)
    ]
    assert not without_sentence


def test_the_table_of_rules_is_up_to_date():
    """It has each rule with a line of the shell, and the Python that the line runs.

    For a step that is a function, for another command a module or nothing; all can be imported.
    """
    text = (ROOT / "docs/studies.md").read_text(encoding="utf-8")
    assert RULE_TABLE.renewed(text) == text, "run: python benchmarks/rule_table.py docs/studies.md"
    rows = [*RULE_TABLE.rows()]
    assert {row[0] for row in rows} == {name for name, line in SHELL_LINES.items() if line}
    for name, _, _, python in rows:
        module, _, function = python.rpartition(".")
        if name in STEPS:
            assert callable(getattr(importlib.import_module(module), function)), name
        elif python:
            assert importlib.util.find_spec(python) is not None, name


def test_the_code_common_to_the_rules_is_short():
    """It has less than 60 lines, as code has its place and its tests in the package."""
    assert len((ROOT / "workflow/rules/common.smk").read_text().splitlines()) < 60


def test_the_workflow_uses_nothing_private_of_snakemake():
    """Rules, Snakefile and package name no internals of Snakemake, and import public modules."""
    text = TEXT + (ROOT / "Snakefile").read_text(encoding="utf-8")
    text += "".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    private = r"workflow\.(dag|get_rule|register|_)|logger\.handlers"
    # the parser of the command line is what Snakemake's own documentation is made from
    private += r"|from snakemake(?!\.(utils|exceptions) |\.cli import get_argument_parser\n)"
    assert not re.findall(private, text)


def test_every_step_has_the_arguments_of_its_function_and_depends_on_its_source():
    """The parameter `code` of a rule is a hash of sources, among them the file of the function."""
    assert STEPS
    for name, text in STEPS.items():
        dotted, arguments = re.search(r"bearingwear step (\S+) (.*?) -o ", text).groups()
        module, _, function = dotted.rpartition(".")
        signature = inspect.signature(getattr(importlib.import_module(module), function))
        names = re.findall(r"(?:^| )([a-z]\w*)=", arguments)
        signature.bind(**dict.fromkeys(names))  # a TypeError where they do not fit
        hashed = re.search(r'code=sources\(\s*"([\w.]+)"', RULES[name])
        if name != "verdict":  # which is called each time
            path = ROOT.joinpath(*module.split(".")).with_suffix(".py")
            assert hashed and path in sources(hashed[1]), dotted


def test_the_files_of_the_workflow_are_installed():
    """They are data of the package, for studies outside a clone."""
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for pattern in ("workflow/rules/*.smk", "workflow/schemas/*.yaml", "workflow/report/*.rst"):
        assert f'"{pattern}"' in project and list(ROOT.glob(pattern))


def test_the_image_is_made_by_commands_and_of_folders_that_are_there():
    """The Dockerfile copies folders that exist, all packages among them, and runs our commands.

    No test builds the image.
    """
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    for line in re.findall(r"^COPY (.+) \S+$", text, re.M):
        assert all((ROOT / name).exists() for name in line.split()), line
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    packages = project["tool"]["setuptools"]["packages"]["find"]["include"]
    assert {name.rstrip("*") for name in packages} <= set(re.findall(r"^COPY (\w+) ", text, re.M))
    command_names = re.findall(r"^RUN (?:.*&& )?bearingwear (\w+)", text, re.M)
    assert command_names and all(hasattr(commands, name) for name in command_names)
