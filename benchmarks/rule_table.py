"""The list of rules in docs/studies.md: what each runs, and the Python behind it.

`python benchmarks/rule_table.py docs/studies.md` renews it.
"""

from __future__ import annotations

import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

RULES = Path(__file__).parents[1] / "workflow" / "rules"
BEGIN, END = "<!-- rules: begin -->", "<!-- rules: end -->"
_RULE = re.compile(r"^rule (\w+):\n((?:    .*\n|\n)*)", re.M)


def rules() -> Iterator[tuple[str, str, str]]:
    """Of each rule: its name, its file, and its text below the name."""
    for file in sorted(RULES.glob("*.smk")):
        for name, body in _RULE.findall(file.read_text(encoding="utf-8")):
            yield name, file.stem, body


def shell_line(body: str) -> str:
    """The shell line of a rule, its strings joined; empty where it has none."""
    return "".join(re.findall(r'^ +"(.*)"$', body.partition("    shell:\n")[2], re.M))


def rows() -> Iterator[tuple[str, str, str, str]]:
    """Of each rule that runs something: its name, file, command and Python module or function."""
    for name, file, body in rules():
        command = re.match(r"bearingwear (\w+)(?: ([\w.]+))?", shell_line(body))
        if command is None:
            continue
        sources = re.search(r'sources\(\s*"([\w.]+)"', body)
        python = command[2] if command[1] == "step" else sources[1] if sources else ""
        yield name, file, command[1], python


def table() -> str:
    """The rows in Markdown, a list for each file of rules."""
    lines: list[str] = []
    stage = ""
    for name, file, command, python in rows():
        if file != stage:
            lines += ["", f"`workflow/rules/{file}.smk`:", ""]
            stage = file
        text = f"`{name}`: `{command}`" + (f", `{python}`" if python else "")
        lines.append(
            textwrap.fill(text, 100, initial_indent="- ", subsequent_indent="  ",
                          break_long_words=False, break_on_hyphens=False)
        )  # fmt: skip
    return "\n".join(lines[1:])


def renewed(text: str) -> str:
    """A page with the table between its marks."""
    before, _, rest = text.partition(BEGIN)
    return f"{before}{BEGIN}\n\n{table()}\n\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    page = Path(sys.argv[1])
    page.write_text(renewed(page.read_text(encoding="utf-8")), encoding="utf-8")
