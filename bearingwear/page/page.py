"""The page of a study: one HTML file that needs no network and, but for its data, no other file."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import numpy as np
import xarray as xr
from markupsafe import Markup

from bearingwear.document.bearing_line import bearing_line, is_answered_by_a_case
from bearingwear.document.chart import Chart, load_charts
from bearingwear.document.document import Block, Document, load_document
from bearingwear.document.html import block_html, sentences_html
from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK
from bearingwear.page.charts import LARGE_CHART, SMALL_CHART, chart_html
from bearingwear.page.figures import SUFFIXES, Drawing, drawings
from bearingwear.page.sketch import sketch
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.units import Rough, in_print, key_in_words, unbroken
from bearingwear.results.warnings import gathered_warnings, warnings_in
from bearingwear.results.words import scene_of
from bearingwear.scene.arrangement import METHODS
from bearingwear.scene.assumed import assumed_keys
from bearingwear.scene.changes import KIND_KEY, METHOD_KEY
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.read import as_data

_TEMPLATE, _STYLE, _SCRIPT = (
    Path(__file__).with_name(name) for name in ("page.html", "page.css", "page.js")
)
UP = "../../"  # from the page, results/report/index.html, to the folder of the study
GLOSSARY = {
    "QV": "Load times slip speed, integrated over a contact (W). Wear is proportional to QV.",
    "constant force (spring pair), fixed position (rigid pair)": "Preload applied by a spring, "
    "whose force remains constant as parts wear, or by a spacer, with which the preload decreases "
    "as parts wear. With a spring, only one bearing of the arrangement supports the rotor axially.",
    "residual preload": "The axial force that remains at speed and after wear.",
    "gyroscopic slip share": "The share of a ball's sliding that is perpendicular to its "
    "rolling direction and driven by the gyroscopic moment.",
    "requirement": "A condition that the bearing or machine must meet from new to the end of life, "
    "such as a minimum stiffness. Requirements restrict the choice of preload.",
    "end-of-life criterion": "A value, set in the scene, at which a bearing counts as worn out, "
    "such as a wear depth. The first criterion met determines the end of life.",
    "skid ratio": "The relative lag of a ball's orbit rate behind that in pure rolling.",
    "total wear depth": "The loss of ball diameter plus, if wear of the races is included, the "
    "wear depths of both grooves. Wear reduces the interference between balls and grooves.",
    "wear life": "The running time until the first end-of-life criterion is met (not a "
    "fatigue life).",
}
"""Words that a reader of the page may not know."""

CHARTS = "charts.json"
"""Beside an answer: its charts (`document.chart`)."""

CHARTED = ("design", "map")
"""Figures in whose place there are charts."""

VERSIONS = ("package_version", "source_hash", "numpy_version", "numba_version")


@dataclass
class Section:
    """What belongs to one scene: the files in its folder and below it."""

    scene: dict[str, Any]
    figures: list[Drawing] = field(default_factory=list)
    tables: list[Path] = field(default_factory=list)
    solved: list[tuple[str, int, int]] = field(default_factory=list)  # what, solved, of
    errors: list[tuple[str, str]] = field(default_factory=list)  # of what, at most
    warnings: list[tuple[str, str]] = field(default_factory=list)  # sentence and advice, where


@dataclass
class Answered:
    """An answer with what belongs to it: its question, charts, figures, other files, a sketch."""

    answer: Document
    question: str
    charts: Sequence[Chart]
    drawn: list[Drawing]
    files: list[Path]

    @property
    def said(self) -> list[Block]:
        """Sentences beside the charts; the question has what else is asked."""
        more = () if self.question else ("more",)
        return [block for block in self.answer.placed("lead", *more) if not block.rows]

    def tables(self, folded: bool) -> list[Block]:
        """Those that stand open below the charts, or are folded."""
        blocks = (block for block in self.answer.blocks if block.rows or not block.place)
        below = [block for block in blocks if block.place != "lead"]
        return [block for block in below if (block.place != "open") is folded]

    @property
    def leading_tables(self) -> list[Block]:
        """Those beside the first chart."""
        return [block for block in self.answer.placed("lead") if block.rows]

    def __getattr__(self, name: str) -> Any:
        return getattr(self.answer, name)


def page(
    sections: Iterable[Path] = (),
    docs: Iterable[Path] = (),
    answers: Iterable[Path] = (),
    scenes: Iterable[Path] = (),
) -> str:
    """The page, as HTML.

    sections: files of a study, as the Snakefile makes them: study.nc, wear_life.nc and dynamic.nc
        of scenes; Markdown tables and figures in folders beside them, and figures of several scenes
        elsewhere.
    docs: documents to link.
    answers: what studies answer (`Document.stored`, .json); the one of the least rank leads.
        Markdown and figures in folders beside one belong to it. The scenes of recommendations (.nc)
        are the inputs where there are no sections.
    scenes: files of the scenes, for their descriptions, which may have changed since the results
        were made, and for the values that they mark as assumed.
    May raise CaseFileError and SceneError.
    """
    results, leading = list(sections), list(answers)
    _check_kinds(results, (".nc", ".md", *SUFFIXES))
    _check_kinds(leading, (".json", ".nc", ".md", *SUFFIXES))
    datasets = {file: load(file) for file in results if file.suffix == ".nc"}
    made = [*datasets.values(), *(load(file) for file in leading if file.suffix == ".nc")]
    studied = _sections(datasets)
    inputs = [section.scene for section in studied.values()] or list(map(scene_of, made))
    assumed = _as_in_files(inputs, scenes)
    figures = list(drawings([*results, *leading]))
    answered = _answered(leading, figures)
    taken = {figure.path for one in answered for figure in one.drawn} | set(leading)
    across = _handed_out(studied, [one for one in figures if one.path not in taken], results)
    style, script = (file.read_text(encoding="utf-8") for file in (_STYLE, _SCRIPT))
    return (
        _environment()
        .from_string(_TEMPLATE.read_text(encoding="utf-8"))
        .render(
            headline=answered[0].title if answered else "A study of friction and wear",
            answers=answered,
            named_once=partial(_without_name, inputs),
            inputs=inputs,
            sketch=_sketch(inputs, answered),
            sections=list(studied.values()),
            across=across,
            unsolved=[
                (section.scene["name"], what, source - solved)
                for section in studied.values()
                for what, solved, source in section.solved
                if solved < source
            ],
            keys=list(key_blocks(inputs, assumed)),
            assumed=assumed,
            versions=_versions(made),
            docs=[(file, _title(file)) for file in docs],
            glossary=GLOSSARY,
            style=Markup(style),
            script=Markup(script),
            hashes={"style": _csp_hash(style), "script": _csp_hash(script)},
        )
    )


def _as_in_files(inputs: Sequence[dict[str, Any]], files: Iterable[Path]) -> set[str]:
    """Give scenes the descriptions of their files; returns the keys that all of these assume."""
    named = {data["name"]: (file, data) for file in files for data in [as_data(file)[0]]}
    assumed: list[set[str]] = []
    for scene in inputs:
        if found := named.get(scene["name"]):
            file, data = found
            if text := " ".join(data.get("description", "").split()):
                scene["description"] = text
            assumed.append(assumed_keys(file))
    return set.intersection(*assumed) if len(assumed) == len(inputs) > 0 else set()


def _handed_out(
    scenes: Mapping[Path, Section], figures: Iterable[Drawing], results: Iterable[Path]
) -> list[Drawing]:
    """Give figures and tables to the section of their scene; returns figures of several scenes."""
    across: list[Drawing] = []
    for figure in figures:
        owner = scenes.get(figure.path.parent.parent)
        (owner.figures if owner else across).append(figure)
    for file in results:
        if file.suffix == ".md" and (owner := scenes.get(file.parent.parent)):
            owner.tables.append(file)
    return across


def _environment() -> jinja2.Environment:
    """What the template is filled with, beside the study's own."""
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_unbroken,
    )
    environment.globals.update(
        block=lambda block, name="": Markup(block_html(block, name)),
        sentences=lambda blocks: Markup(sentences_html(blocks)),
        link=_link,
        named=_named,
        line=bearing_line,
        differences=scene_differences,
        chart=lambda chart, name, group, large=False: chart_html(
            chart, name, group, LARGE_CHART if large else SMALL_CHART
        ),
    )
    return environment


def _without_name(scenes: Sequence[Mapping[str, Any]], text: str) -> str:
    """A heading without the name of the scene, where the page is about no other."""
    if len(scenes) != 1:
        return text
    name = scenes[0]["name"]
    text = text.removeprefix(f"{name}: ").removeprefix(f"{name}, ")
    return text[:1].upper() + text[1:]


def _csp_hash(text: str) -> str:
    """The name of a text in a content security policy."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _link(path: Path) -> str:
    """From the page to a file of the study."""
    return path.as_uri() if path.is_absolute() else UP + quote(path.as_posix())


def _named(path: Path) -> str:
    """A file's path below the results of the study; of a file elsewhere, its name and folder."""
    parts = path.parts
    return "/".join(parts[1:] if parts[0] == "results" else parts[-2:])


def _unbroken(value: Any) -> Any:
    """A text with its numbers in one piece with their units; anything else as it is."""
    return unbroken(value) if type(value) is str else value


def _answered(files: Sequence[Path], figures: Sequence[Drawing]) -> list[Answered]:
    """Answers, the leading one first, each with what lies beside it or is named by it."""
    found = []
    for file in files:
        if file.name == CHARTS or file.suffix != ".json":
            continue
        answer = load_document(file)
        charts = load_charts(one) if (one := file.with_name(CHARTS)) in files else None
        siblings = [path for path in files if path.parent.parent == file.parent]
        # what charts show is not drawn again
        drawn = [
            figure
            for figure in figures
            if figure.path.stem in answer.figures and answer.facts["scene"] in figure.path.parts
            if not (charts and figure.path.stem in CHARTED)
        ]
        found.append(
            Answered(
                answer,
                charts.question if charts else "",
                charts.charts if charts else (),
                drawn,
                [path for path in siblings if path.suffix in (".md", ".svg")],
            )
        )
    return sorted(found, key=lambda one: one.answer.rank)


def _sketch(scenes: Sequence[Mapping[str, Any]], answered: Sequence[Answered]) -> Markup:
    """The bearing that the first answer is about, loaded as is recommended or as its scene says."""
    if not scenes:
        return Markup()
    if not answered:
        return sketch(scenes[0])
    first = answered[0]
    named = [scene for scene in scenes if scene["name"] == first.facts["scene"]]
    lines = first.charts[0].lines if first.charts else ()
    stars = [(line.star, line.method) for line in lines if line.star]
    (preload, _), method = max(stars, key=lambda one: one[0][1], default=((None, None), ""))
    return sketch([*named, *scenes][0], method, preload)


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
                f"{file}: got a file without preload_method or status, expected cases or lives"
            )
        section = sections.setdefault(file.parent, Section(scene_of(dataset)))
        status = dataset["status"].values
        answers = (OK, CRITERION_NOT_REACHED) if _is_life(dataset) else (OK,)
        solved = int(np.isin(status, answers).sum())
        section.solved.append((_what(dataset), solved, status.size))
    for folder, section in sections.items():
        own = [dataset for file, dataset in datasets.items() if file.parent == folder]
        section.errors = list(_largest_errors(own))
        section.warnings = list(_warnings(own, section.scene))
    return sections


def _what(dataset: xr.Dataset) -> str:
    """What a scene's file holds several of."""
    if _is_life(dataset):
        return "lives"
    return "dynamic cases" if dataset.attrs.get("fidelity") == "dynamic" else "cases"


_ONE = {"lives": "life", "cases": "case", "dynamic cases": "dynamic case"}


def _warnings(
    datasets: Iterable[xr.Dataset], scene: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    """Each warning of a scene once, at its worst, and how many cases and lives have it."""
    files = [(_what(dataset), dataset.attrs) for dataset in datasets]
    for one in warnings_in({"warnings": gathered_warnings(attrs for _, attrs in files)}):
        counts = [
            f"{twin['cases']} {what if twin['cases'] != 1 else _ONE[what]}"
            for what, attrs in files
            for twin in warnings_in(attrs)
            if twin["id"] == one["id"]
        ]
        if not is_answered_by_a_case(one, scene):
            yield one["sentence"], ", ".join(counts)


def _largest_errors(datasets: Sequence[xr.Dataset]) -> Iterator[tuple[str, str]]:
    """Largest estimate of each numerical error of a scene, of what was solved."""
    for name, words in (
        ("qv_error_estimate", "QV"),
        ("residual_preload_error_estimate", "residual preload"),
        ("wear_rate_error_estimate", "wear rate"),
        ("life_error_estimate", "life"),
    ):
        known = [float(abs(one[name]).max()) for one in datasets if name in one]
        known = [error for error in known if np.isfinite(error)]
        if known:
            yield words, f"{Rough(100.0 * max(known)).in_unit('%')} %"


def _versions(datasets: Iterable[xr.Dataset]) -> list[dict[str, str]]:
    """Versions of what made the files; more than one where they were made by unlike sources."""
    found = [{name: str(d.attrs.get(name, "–")) for name in VERSIONS} for d in datasets]
    return [one for k, one in enumerate(found) if one not in found[:k]]


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise CaseFileError(f"{file}: cannot be read ({' '.join(str(error).split())})") from None


def _title(file: Path) -> str:
    """Title of a Markdown file, or the file's name."""
    first = _text(file).partition("\n")[0]
    return first[2:] if first.startswith("# ") else file.stem


KeyRow = tuple[str, list[str], bool]
ASSUMED = "\N{NO-BREAK SPACE}*"
"""After the name of an assumed quantity."""
_NAMES = ("name", "description")
_MOST = 4  # scene_differences that are named


def key_rows(scenes: Sequence[Mapping[str, Any]], assumed: Container[str] = ()) -> Iterator[KeyRow]:
    """Rows of the table of scenes: key in words, a value for each, whether they differ.

    assumed: keys of values that are marked as assumed.
    """
    flat = [{key: _value(value) for key, value in leaves(scene).items()} for scene in scenes]
    for scene, values in zip(scenes, flat, strict=True):
        if is_pair(scene) and METHOD_KEY not in values:  # both were studied
            values[KIND_KEY] = _value(list(METHODS))
    names = list(dict.fromkeys(name for values in flat for name in values))
    blocks = list(dict.fromkeys(name.partition(".")[0] for name in names))
    for name in sorted(names, key=lambda name: blocks.index(name.partition(".")[0])):
        if name not in _NAMES:
            row = [values.get(name, "–") for values in flat]
            mark = ASSUMED if name in assumed else ""
            yield f"{key_label(name)}{mark}", row, len(set(row)) > 1


def key_blocks(
    scenes: Sequence[Mapping[str, Any]], assumed: Container[str] = ()
) -> Iterator[tuple[str, list[KeyRow]]]:
    """Rows of `key_rows` by the block of the scene that they belong to."""
    rows = groupby(key_rows(scenes, assumed), key=lambda row: row[0].partition(": ")[0])
    for block, members in rows:
        yield (
            block,
            [(name.partition(": ")[2] or name, values, differ) for name, values, differ in members],
        )


def scene_differences(first: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    """Differences of another scene from the first, in words, without `uncertainty`."""
    rows = key_rows([_certain(first), _certain(other)])
    said = [
        f"{label.partition(': ')[2] or label} {values[1]} instead of {values[0]}"
        for label, values, differ in rows
        if differ
    ]
    more = f"; {len(said) - _MOST} more" if len(said) > _MOST else ""
    return "; ".join(said[:_MOST]) + more


def _certain(scene: Mapping[str, Any]) -> dict[str, Any]:
    return {block: value for block, value in scene.items() if block != "uncertainty"}


def key_label(key: str) -> str:
    """A key of a scene in words: `bearing: ball diameter (mm)`."""
    blocks = ", ".join(block.replace("_", " ") for block in key.split(".")[:-1])
    words, unit = key_in_words(key)
    return f"{blocks}: {words}" + (f" ({in_print(unit)})" if unit else "")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(map(_value, value))
    return "–" if value is None else str(value).replace("_", " ")
