"""What the site has beyond the Markdown files of docs/: MathML, and pages made from the code.

MkDocs calls these functions by their names (`hooks` in mkdocs.yml).
"""

from __future__ import annotations

import argparse
import html
import re
from importlib.resources import files as resources
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

from bearingwear.arguments import command_parser

ROOT = Path(__file__).resolve().parents[2]
COPIED = {
    "config/README.md": "reference/keys.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
"""Files outside docs/ that are pages of the site."""
FONT = "STIXTwoMath-Regular.ttf"
SHIM = "https://unpkg.com/iframe-worker/shim"  # the theme would load it from there
SIDES = {"left": "text-align: left", "right": "text-align: right"}


def on_files(files: Files, config) -> Files:
    """Add the pages that are copied or made from the code."""
    pages = {page: (ROOT / file).read_text(encoding="utf-8") for file, page in COPIED.items()}
    pages["reference/commands.md"] = commands_page()
    for name, text in pages.items():
        files.append(File.generated(config, name, content=text))
    font = resources("ziamath") / "fonts" / FONT
    files.append(File.generated(config, f"site/{FONT}", content=font.read_bytes()))
    return files


def on_post_page(output: str, page, config) -> str:
    """Take the script that searches in files from the site itself."""
    up = "../" * page.file.src_uri.count("/")
    return output.replace(SHIM, f"{up}site/iframe-worker.js")


def on_post_template(output_content: str, template_name: str, config) -> str:
    """Do the same in 404.html."""
    return output_content.replace(SHIM, "site/iframe-worker.js")


def on_page_markdown(markdown: str, page, config, files) -> str:
    """Turn links to files of the repository into links to their pages, or into their names."""
    here = page.file.src_uri
    source = next((file for file, name in COPIED.items() if name == here), f"docs/{here}")
    return re.sub(r"(!?)\[([^\]]*)\]\(([^)#\s]*)(#[\w-]+)?\)", _link(source, here), markdown)


def _link(source: str, here: str):
    up = "../" * here.count("/")

    def replaced(match: re.Match[str]) -> str:
        _, text, target, anchor = match.groups()
        if not target or "://" in target:
            return match[0]
        path = (ROOT / source).parent.joinpath(target).resolve()
        if not path.is_relative_to(ROOT):
            return match[0]
        name = path.relative_to(ROOT).as_posix()
        if name in COPIED:
            return f"[{text}]({up}{COPIED[name]}{anchor or ''})"
        if source in COPIED and name.startswith("docs/"):
            return f"{match[1]}[{text}]({up}{name.removeprefix('docs/')}{anchor or ''})"
        return match[0] if name.startswith("docs/") else f"`{name}`"

    return replaced


def on_page_content(content: str, page, config, files) -> str:
    """Turn the formulas that `pymdownx.arithmatex` has marked into MathML."""
    block = r'<div class="arithmatex">\\\[(.*?)\\\]</div>'
    inline = r'<span class="arithmatex">\\\((.*?)\\\)</span>'
    content = re.sub(block, _equation, content, flags=re.S)
    return re.sub(inline, lambda m: mathml(html.unescape(m[1]), "inline"), content, flags=re.S)


def _equation(match: re.Match[str]) -> str:
    formula = html.unescape(match[1])
    tag = re.search(r"\\tag\{(\w+)\}", formula)
    shown = mathml(re.sub(r"\\tag\{\w+\}", "", formula), "block")
    if tag is None:
        return f'<div class="equation">{shown}</div>'
    return f'<div class="equation" id="eq-{tag[1]}">{shown}<span>({tag[1]})</span></div>'


def mathml(formula: str, display: str) -> str:
    """A TeX formula as MathML that browsers show without scripts."""
    text = convert(formula.strip(), display=display)
    # browsers take the alignment of cells from CSS alone, and names of functions want a space
    text = re.sub(r'columnalign="(left|right)"', lambda m: f'style="{SIDES[m[1]]}"', text)
    return re.sub(r"<mi>((?:arc)?(?:sin|cos|tan|cot|ln|log|exp|max|min|det))</mi>", _FUNCTION, text)


_FUNCTION = r'<mo lspace="0.1em" rspace="0.1em" form="prefix">\1</mo>'


def commands_page() -> str:
    """Every command with its help, as it prints it."""
    parser = command_parser()
    parts = ["# Commands", _help(parser)]
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    shown = [action.dest for action in commands._choices_actions]
    for name in shown:
        parts += [f"## bearingwear {name}", _help(commands.choices[name])]
    return "\n\n".join(parts) + "\n"


def _help(parser: argparse.ArgumentParser) -> str:
    return f"```text\n{parser.format_help().rstrip()}\n```"
