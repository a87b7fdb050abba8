"""The page of a study: one HTML file without scripts that needs no network and no other file."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import numpy as np
import xarray as xr
from markupsafe import Markup

from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK
from bearingwear.page.answer import answer, lives_of
from bearingwear.page.markup import to_html
from bearingwear.plotting.drawing import MESSAGE, scene_of
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.quantiles import load_quantiles
from bearingwear.results.units import display, in_print, key_in_words
from bearingwear.results.warnings import gathered_warnings, warnings_in
from bearingwear.scene.keys import leaves

TEMPLATE = Path(__file__).with_name("page.html")
LIFE_FIGURE = "wear_life"  # that of the first scene stands with the answer
FIGURES = (".svg", ".png")
HEAVY = 300_000  # bytes of an SVG beyond which its PNG is taken, if there is one
SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
TITLE = f"{{{SVG}}}title"
DESCRIPTION = "{http://purl.org/dc/elements/1.1/}description"
# What may stand in a data URI as it is; `#` would end it.
UNQUOTED = " !$&'()*+,-./:;=?@_~"
GLOSSARY = {
    "QV": "Load times slip speed, summed over a contact, in watts. Friction heat is QV times the "
    "friction coefficient; by Archard's law the wear rate is QV times the wear coefficient over "
    "the hardness: twice the QV, twice the wear.",
    "constant force, fixed position": "The two ways of preloading: a spring, whose force stays as "
    "parts wear, or a fixed distance between the races, whose force wears away.",
    "residual preload": "The axial force that is left of the preload, worn and at speed.",
    "slip, gyroscopic share": "Balls roll and also slide. The gyroscopic moment turns a ball "
    "across its rolling direction; its share of all slip grows as the"
    " preload falls.",
    "skid ratio": "By how much a ball's orbit lags behind pure rolling.",
    "loss of ball diameter": "How much smaller wear has made a ball. Counting balls and races, "
    "the depth worn into the races is added, because it opens the "
    "bearing as much.",
    "wear life": "Hours until the first limit is met: residual preload, gyroscopic slip, skidding, "
    "or loss of diameter.",
    "in time, steady": "Dynamic: solved as motion in time, with the cage if there is one. "
    "Steady: solved as the motion in which forces and friction balance.",
}
"""Words that a reader of the page may not know."""

VERSIONS = ("package_version", "source_hash", "numpy_version", "numba_version")


@dataclass(frozen=True)
class Drawing:
    """A figure as the page holds it."""

    path: Path
    message: str
    description: str
    width: int
    height: int
    uri: str


@dataclass
class Section:
    """What belongs to one scene: the files in its folder and below it."""

    scene: dict[str, Any]
    figures: list[Drawing] = field(default_factory=list)
    tables: list[Path] = field(default_factory=list)
    solved: list[tuple[str, int, int]] = field(default_factory=list)  # what, solved, of
    errors: list[tuple[str, str]] = field(default_factory=list)  # of what, at most
    warnings: list[tuple[str, str]] = field(default_factory=list)  # sentence and advice, where


def page(
    sections: Iterable[Path] = (), docs: Iterable[Path] = (), answers: Iterable[Path] = ()
) -> str:
    """The page, as HTML.

    Parameters
    ----------
    sections : iterable of path
        Files of a study, as the Snakefile makes them: study.nc, wear_life.nc and dynamic.nc of
        scenes; Markdown tables and figures in folders beside them, and figures of several scenes
        elsewhere. The first scene is what the answer is about.
    docs : iterable of path
        Markdown to append, a section each.
    answers : iterable of path
        Markdown and figures that answer which preload to take, and quantiles of lives (.nc). The
        first sentence of the first Markdown is then the headline.

    Raises
    ------
    CaseFileError
        One line.
    """
    results, leading = list(sections), list(answers)
    _check_kinds(results, (".nc", ".md", *FIGURES))
    _check_kinds(leading, (".nc", ".md", *FIGURES))
    known = [load_quantiles(file) for file in leading if file.suffix == ".nc"]
    datasets = {file: load(file) for file in results if file.suffix == ".nc"}
    scenes = _sections(datasets)
    across: list[Drawing] = []
    for figure in _drawings(results):
        owner = scenes.get(figure.path.parent.parent)
        (owner.figures if owner else across).append(figure)
    for file in results:
        if file.suffix == ".md" and (owner := scenes.get(file.parent.parent)):
            owner.tables.append(file)
    of_lives = filter(_is_life, datasets.values())
    found = answer([life for dataset in of_lives for life in lives_of(dataset, known)])
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    first = next(iter(scenes.values()), None)
    lead = [figure for figure in first.figures if figure.path.stem == LIFE_FIGURE] if first else []
    return template.render(
        answer=found,
        lead=lead,
        leading=_leading(leading),
        sections=list(scenes.values()),
        across=across,
        unsolved=[
            (section.scene["name"], what, of - solved)
            for section in scenes.values()
            for what, solved, of in section.solved
            if solved < of
        ],
        keys=list(_keys([section.scene for section in scenes.values()])),
        versions=_versions(datasets.values()),
        docs=[
            (file, title, to_html(body, 1, file.parent))
            for file in docs
            for title, body in [_titled(file)]
        ],
        glossary=GLOSSARY,
        html=lambda file: to_html(_tables(file), 2),
    )


def _check_kinds(files: Iterable[Path], suffixes: Sequence[str]) -> None:
    """Refuse what would silently be missing on the page."""
    for file in files:
        if file.suffix not in suffixes:
            raise CaseFileError(
                f"{file}: got the suffix {file.suffix!r}, expected {', '.join(suffixes)}"
            )


def _is_life(dataset: xr.Dataset) -> bool:
    return "end_criterion" in dataset and "preload_method" in dataset.dims


def _sections(datasets: dict[Path, xr.Dataset]) -> dict[Path, Section]:
    """Sections by the folders of the scenes, in the order in which their files are given."""
    sections: dict[Path, Section] = {}
    for file, dataset in datasets.items():
        if "preload_method" not in dataset.dims or "status" not in dataset:
            raise CaseFileError(
                f"{file}: not a file for this command; it has no preload_method and status"
            )
        section = sections.setdefault(file.parent, Section(scene_of(dataset)))
        status = dataset["status"].values
        answers = (OK, CRITERION_NOT_REACHED) if _is_life(dataset) else (OK,)
        solved = int(np.isin(status, answers).sum())
        section.solved.append((_what(dataset), solved, status.size))
    for folder, section in sections.items():
        own = [dataset for file, dataset in datasets.items() if file.parent == folder]
        section.errors = list(_largest_errors(own))
        section.warnings = list(_warnings(own))
    return sections


def _what(dataset: xr.Dataset) -> str:
    """What the file of a scene holds many of."""
    if _is_life(dataset):
        return "lives"
    return "cases in time" if dataset.attrs.get("fidelity") == "dynamic" else "cases"


def _warnings(datasets: Iterable[xr.Dataset]) -> Iterator[tuple[str, str]]:
    """Each warning of a scene once, at its worst, and how many cases and lives have it."""
    files = [(_what(dataset), dataset.attrs) for dataset in datasets]
    for one in warnings_in({"warnings": gathered_warnings(attrs for _, attrs in files)}):
        counts = [
            f"{twin['cases']} {what}"
            for what, attrs in files
            for twin in warnings_in(attrs)
            if twin["id"] == one["id"]
        ]
        yield f"{one['sentence']}; {one['advice']}", ", ".join(counts)


def _drawings(files: Sequence[Path]) -> Iterator[Drawing]:
    """Every SVG among the files; a heavy one as the PNG of the same name, if that is given."""
    for file in files:
        if file.suffix == ".svg":
            other = file.with_suffix(".png")
            yield _drawing(file, other if other in files else None)


def _drawing(file: Path, png: Path | None) -> Drawing:
    try:
        text = file.read_text(encoding="utf-8")
        root = ET.fromstring(text)
        _, _, width, height = (float(number) for number in root.attrib["viewBox"].split())
        picture = png.read_bytes() if png and len(text) > HEAVY else None
    except (OSError, UnicodeError, ET.ParseError, KeyError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise CaseFileError(f"{file}: cannot be read ({reason}), expected an SVG figure") from None
    message = (root.findtext(TITLE) or file.stem.replace("_", " ")).strip()
    description = next((node.text or "" for node in root.iter(DESCRIPTION)), "").strip()
    # The page has the message beside the figure. Its glyphs stay: later texts use them, too.
    for parent in list(root.iter()):
        for place, child in enumerate(parent):
            if child.get("id") == MESSAGE:
                parent[place] = ET.Element(child.tag)
                parent[place].extend(child.iter(f"{{{SVG}}}defs"))
    return Drawing(
        file,
        message,
        description,
        round(width * 4.0 / 3.0),  # from points to pixels
        round(height * 4.0 / 3.0),
        f"data:image/png;base64,{base64.b64encode(picture).decode()}"
        if picture
        else f"data:image/svg+xml,{quote(_small(root), safe=UNQUOTED)}",
    )


def _small(root: ET.Element) -> str:
    """An SVG without comments and line ends."""
    ET.register_namespace("", SVG)
    ET.register_namespace("xlink", XLINK)
    return " ".join(ET.tostring(root, encoding="unicode").replace("> <", "><").split())


def _leading(files: Sequence[Path]) -> dict[str, Any] | None:
    """Headline, texts and figures that stand before all others, if there are any.

    The text before the first heading, without the sentence that is the headline, stands apart.
    """
    titled = [_titled(file) for file in files if file.suffix == ".md"]
    figures = list(_drawings(files))
    if not titled and not figures:
        return None
    html = [to_html(text, 2) for _, text in titled]
    text = html[0] if html else ""
    before, _, rest = text.partition("<p>")
    first, _, after = rest.partition("</p>")
    sentence, stop, more = " ".join(first.split()).partition(". ")
    kept = f"{before}<p>{more}</p>{after}" if more else before + after
    intro, heading, rest = kept.partition("<h")
    return {
        "headline": Markup(sentence + stop.strip()).striptags() if first else "",
        "intro": Markup(intro),
        "texts": [("", Markup(heading + rest))]
        + [(title, text) for (title, _), text in zip(titled[1:], html[1:], strict=True)],
        "figures": figures,
    }


def _largest_errors(datasets: Sequence[xr.Dataset]) -> Iterator[tuple[str, str]]:
    """Largest estimate of each numerical error of a scene, of what was solved."""
    for name, words in (
        ("qv_error_estimate", "QV"),
        ("residual_preload_error_estimate", "residual preload"),
        ("wear_rate_error_estimate", "rate of wear"),
        ("life_error_estimate", "life"),
    ):
        known = [float(abs(one[name]).max()) for one in datasets if name in one]
        known = [error for error in known if np.isfinite(error)]
        if known:
            yield words, f"{display('1', shown='%').text(max(known))} %"


def _keys(scenes: Sequence[dict[str, Any]]) -> Iterator[tuple[str, list[str], bool]]:
    """Rows of the table of scenes: key in words, a value for each, whether they differ."""
    flat = [{key: _value(value) for key, value in leaves(scene).items()} for scene in scenes]
    names = list(dict.fromkeys(name for values in flat for name in values))
    blocks = list(dict.fromkeys(name.partition(".")[0] for name in names))
    for name in sorted(names, key=lambda name: blocks.index(name.partition(".")[0])):
        if name not in ("name", "description"):
            row = [values.get(name, "–") for values in flat]
            yield _key_label(name), row, len(set(row)) > 1


def _key_label(key: str) -> str:
    """A key of a scene in words: `bearing: ball diameter (mm)`."""
    blocks = ", ".join(block.replace("_", " ") for block in key.split(".")[:-1])
    words, unit = key_in_words(key)
    return f"{blocks}: {words}" + (f" ({in_print(unit)})" if unit else "")


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(map(_value, value))
    return "–" if value is None else str(value).replace("_", " ")


def _versions(datasets: Iterable[xr.Dataset]) -> list[dict[str, str]]:
    """Versions of what made the files; more than one where they were made by unlike sources."""
    found = [{name: str(d.attrs.get(name, "–")) for name in VERSIONS} for d in datasets]
    return [one for k, one in enumerate(found) if one not in found[:k]]


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise CaseFileError(f"{file}: cannot be read ({' '.join(str(error).split())})") from None


def _titled(file: Path) -> tuple[str, str]:
    """Title of a Markdown file, or the file's name, and the rest of it."""
    text = _text(file)
    first, _, rest = text.partition("\n")
    return (first[2:], rest) if first.startswith("# ") else (file.stem, text)


def _tables(file: Path) -> str:
    """A scene's Markdown from its first heading below the title on; the page has the rest."""
    text = _text(file)
    return text[max(text.find("\n## "), 0) :]
