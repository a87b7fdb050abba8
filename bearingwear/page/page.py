"""The page of a study: one HTML file that fetches nothing; it only links to files of the study."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import jinja2
import numpy as np
import xarray as xr
from markupsafe import Markup

from bearingwear.document.bearing_line import bearing_line, warning_with_cases
from bearingwear.document.chart import Chart, load_charts
from bearingwear.document.document import Block, Document, load_document
from bearingwear.document.html import block_html, sentences_html
from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK
from bearingwear.page.charts import LARGE_CHART, SMALL_CHART, chart_html
from bearingwear.page.figures import SUFFIXES, Drawing, drawings
from bearingwear.page.sketch import sketch
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.units import Rough, key_in_words, printed_unit, without_unit_breaks
from bearingwear.results.warnings import merged_warnings, warnings_in
from bearingwear.results.words import plain_scene
from bearingwear.scene.arrangement import METHODS
from bearingwear.scene.assumed import assumed_keys
from bearingwear.scene.changes import KIND_KEY, METHOD_KEY
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.checking.records import SCENE_SUFFIXES
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
    "spacer offset": "How much closer the rings of the two bearings come when the preload is "
    "applied, unworn and at rest: the sum over both bearings. The spacers are ground to differ in "
    "length by this amount.",
    "dynamic, quasi-static stiffness": "Force per unit displacement. In the dynamic case, as in "
    "vibration, spin axes and friction do not change; in the quasi-static case, as under a slowly "
    "varying force, they adapt. A required stiffness applies to both.",
    "K_s/H": "Wear coefficient over hardness (m²/N). All lives are inversely proportional to it.",
    "batch": "Bearings of a batch share one wear coefficient and lubrication. Scatter within a "
    "batch is what differs from bearing to bearing; the uncertainty of the batch is what is common "
    "to all and not known in advance.",
    "gyroscopic slip share": "The share of a ball's sliding that is perpendicular to its "
    "rolling direction and driven by the gyroscopic moment.",
    "requirement": "A condition that the bearing or machine must meet from new to the end of life, "
    "such as a minimum stiffness. Requirements restrict the choice of preload. Beside those of the "
    "user, no bearing may lift off, at rest or at speed.",
    "end-of-life criterion": "A value, set in the scene, at which a bearing counts as worn out, "
    "such as a wear depth. The first criterion met determines the end of life.",
    "skid ratio": "The relative lag of a ball's orbit rate behind that in pure rolling.",
    "total wear depth": "The loss of ball diameter plus, if wear of the races is included, the "
    "wear depths of both grooves. Wear reduces the interference between balls and grooves.",
    "wear life": "The running time until the first end-of-life criterion is met (not a "
    "fatigue life).",
}
"""Terms that a reader of the page may not know, and their meanings."""

CHARTS = "charts.json"
"""Name of the file with the charts of an answer (`document.chart`), beside the answer."""

FIGURES_AS_CHARTS = ("design", "map")
"""Names of the figures that charts replace, since they show the same."""

VERSIONS = ("package_version", "source_hash", "numpy_version", "numba_version")


@dataclass
class Section:
    """The results of one scene, from the files in its folder and below it."""

    scene: dict[str, Any]
    figures: list[Drawing] = field(default_factory=list)
    tables: list[Path] = field(default_factory=list)
    counts: list[SolvedCount] = field(default_factory=list)
    errors: list[tuple[str, str]] = field(default_factory=list)  # quantity, largest error
    warnings: list[tuple[str, str]] = field(default_factory=list)  # sentence, cases


class SolvedCount(NamedTuple):
    """The number of cases or lives of a file, and how many of these were solved."""

    noun: str  # `cases`, `dynamic cases` or `lives`
    solved: int
    total: int


@dataclass
class PageAnswer:
    """An answer on the page: its document, and the charts, figures and files that belong to it."""

    document: Document
    question: str  # of the charts; empty without charts
    charts: Sequence[Chart]
    figures: list[Drawing]
    files: list[Path]

    @property
    def sentence_blocks(self) -> list[Block]:
        """Returns the blocks of sentences beside the first chart, more of them without charts."""
        places = ("lead",) if self.question else ("lead", "more")
        return [block for block in self.document.blocks_in(*places) if not block.rows]

    @property
    def leading_tables(self) -> list[Block]:
        """Returns the tables beside the first chart."""
        return [block for block in self.document.blocks_in("lead") if block.rows]

    @property
    def open_tables(self) -> list[Block]:
        """Returns the blocks below the charts that are not folded away."""
        return [block for block in self._blocks_below_charts if block.place == "open"]

    @property
    def folded_tables(self) -> list[Block]:
        """Returns the blocks that are folded away below the charts."""
        return [block for block in self._blocks_below_charts if block.place != "open"]

    @property
    def _blocks_below_charts(self) -> list[Block]:
        """Returns the tables that are not beside the first chart, and blocks without a place."""
        return [
            block
            for block in self.document.blocks
            if (block.rows or not block.place) and block.place != "lead"
        ]


def page(
    sections: Iterable[Path] = (),
    docs: Iterable[Path] = (),
    answers: Iterable[Path] = (),
    scenes: Iterable[Path] = (),
) -> str:
    """Returns the page as HTML. May raise CaseFileError and SceneError.

    sections: files of a study, as the Snakefile makes them: study.nc, wear_life.nc and dynamic.nc
        of scenes; Markdown tables and figures in folders beside them, and figures of several scenes
        elsewhere.
    docs: documents to link.
    answers: answers of studies (`Document.stored`, .json); the one of the lowest rank comes first.
        Markdown and figures in folders beside one belong to it. The scenes of recommendations (.nc)
        are the inputs if there are no sections.
    scenes: files of the scenes, for their descriptions, which may have changed since the results
        were computed, and for the values that they mark as assumed.
    """
    section_files, answer_files = list(sections), list(answers)
    _check_suffixes(section_files, (".nc", ".md", *SUFFIXES))
    _check_suffixes(answer_files, (".json", ".nc", ".md", *SUFFIXES))
    section_datasets = {file: load(file) for file in section_files if file.suffix == ".nc"}
    answer_datasets = [load(file) for file in answer_files if file.suffix == ".nc"]
    datasets = [*section_datasets.values(), *answer_datasets]
    section_of = _sections(section_datasets)
    inputs = [section.scene for section in section_of.values()]
    inputs = inputs or [plain_scene(dataset) for dataset in datasets]
    assumed = _assumed_keys_with_file_contents(inputs, scenes)
    figures = list(drawings([*section_files, *answer_files]))
    page_answers = _page_answers(answer_files, figures)
    shown_in_answers = {figure.path for answer in page_answers for figure in answer.figures}
    remaining = [
        figure for figure in figures if figure.path not in shown_in_answers | set(answer_files)
    ]
    figures_of_several = _add_to_sections(section_of, remaining, section_files)
    style, script = (file.read_text(encoding="utf-8") for file in (_STYLE, _SCRIPT))
    return (
        _environment()
        .from_string(_TEMPLATE.read_text(encoding="utf-8"))
        .render(
            headline=(
                page_answers[0].document.title if page_answers else "A study of friction and wear"
            ),
            answers=page_answers,
            without_scene_name=partial(_without_scene_name, inputs),
            inputs=inputs,
            sketch=_sketch_of_first_answer(inputs, page_answers),
            sections=list(section_of.values()),
            figures_of_several=figures_of_several,
            unsolved=[
                (section.scene["name"], count.noun, count.total - count.solved)
                for section in section_of.values()
                for count in section.counts
                if count.solved < count.total
            ],
            input_blocks=list(key_blocks(key_rows(inputs[:1], assumed))),
            input_differences=[
                (scene["name"], list(differences_by_block(inputs[0], scene)))
                for scene in inputs[1:]
            ],
            assumed=assumed,
            versions=_versions(datasets),
            docs=[(file, _markdown_title(file)) for file in docs],
            glossary=GLOSSARY,
            style=Markup(style),
            script=Markup(script),
            hashes={"style": _csp_hash(style), "script": _csp_hash(script)},
        )
    )


def _assumed_keys_with_file_contents(
    scenes: Sequence[dict[str, Any]], files: Iterable[Path]
) -> set[str]:
    """Copies descriptions and frictions from scene files; returns the keys that all files assume.

    A description may have changed since the results were computed, and a study varies the friction.
    If a scene has no file, no key is returned.

    scenes: changed in place; the file of each is found by its name.
    """
    files_and_contents = {}
    for file in files:
        content = as_data(file)[0]
        files_and_contents[content["name"]] = file, content
    assumed: list[set[str]] = []
    for scene in scenes:
        if scene["name"] in files_and_contents:
            file, content = files_and_contents[scene["name"]]
            if description := " ".join(content.get("description", "").split()):
                scene["description"] = description
            if (mu := content.get("friction", {}).get("ball_race")) is not None:
                scene["friction"].setdefault("ball_race", mu)
            assumed.append(assumed_keys(file))
    if not assumed or len(assumed) < len(scenes):
        return set()
    return set.intersection(*assumed)


def _add_to_sections(
    section_of: Mapping[Path, Section], figures: Iterable[Drawing], files: Iterable[Path]
) -> list[Drawing]:
    """Adds figures and tables to the sections of their scenes; returns figures of several scenes.

    section_of: section by the folder of its scene.
    files: of the study; Markdown files are tables.
    """
    figures_of_several: list[Drawing] = []
    for figure in figures:
        section = section_of.get(figure.path.parent.parent)
        (section.figures if section else figures_of_several).append(figure)
    for file in files:
        if file.suffix == ".md" and (section := section_of.get(file.parent.parent)):
            section.tables.append(file)
    return figures_of_several


def _environment() -> jinja2.Environment:
    """Returns the environment of Jinja, with the functions that the template calls."""
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_without_breaks,
    )
    environment.globals.update(
        block=lambda block, name="": Markup(block_html(block, name)),
        sentences=lambda blocks: Markup(sentences_html(blocks)),
        link=_link,
        file_label=_file_label,
        bearing_line=bearing_line,
        scene_differences=scene_differences,
        chart=lambda chart, name, group, large=False: chart_html(
            chart, name, group, LARGE_CHART if large else SMALL_CHART
        ),
    )
    return environment


def _without_scene_name(scenes: Sequence[Mapping[str, Any]], text: str) -> str:
    """Returns a heading with a capital letter, without the name of a single scene.

    On a page about several scenes, a heading that starts with the name of one is not changed.
    """
    names = [scene["name"] for scene in scenes]
    if len(names) == 1:
        text = text.removeprefix(f"{names[0]}: ").removeprefix(f"{names[0]}, ")
    elif text.startswith(tuple(names)):
        return text
    return text[:1].upper() + text[1:]


def _csp_hash(text: str) -> str:
    """Returns the SHA-256 hash of a text in the form of a content security policy."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _link(path: Path) -> str:
    """Returns the link from the page to a file of the study."""
    return path.as_uri() if path.is_absolute() else UP + quote(path.as_posix())


def _file_label(path: Path) -> str:
    """Returns the path of a file below `results`; for a file elsewhere, its folder and name."""
    parts = path.parts
    return "/".join(parts[1:] if parts[0] == "results" else parts[-2:])


def _without_breaks(value: Any) -> Any:
    """Returns a text without breaks between numbers and units; HTML and other values unchanged."""
    return without_unit_breaks(value) if type(value) is str else value  # `Markup` is a subclass


def _page_answers(files: Sequence[Path], figures: Sequence[Drawing]) -> list[PageAnswer]:
    """Returns the answers by rank, with their charts and figures.

    The files of an answer are the Markdown tables and SVG figures in folders beside it.

    files: all `answers` of `page`: documents and charts (.json), data, tables and figures.
    figures: all figures of the page.
    """
    answers = []
    for file in files:
        if file.name == CHARTS or file.suffix != ".json":
            continue
        document, chart_file = load_document(file), file.with_name(CHARTS)
        charts = load_charts(chart_file) if chart_file in files else None
        below = [path for path in files if path.parent.parent == file.parent]
        replaced_by_charts = FIGURES_AS_CHARTS if charts else ()
        answers.append(
            PageAnswer(
                document=document,
                question=charts.question if charts else "",
                charts=charts.charts if charts else (),
                figures=[
                    figure
                    for figure in figures
                    if figure.path.stem in document.figures
                    and document.facts["scene"] in figure.path.parts
                    and figure.path.stem not in replaced_by_charts
                ],
                files=[path for path in below if path.suffix in (".md", ".svg")],
            )
        )
    return sorted(answers, key=lambda answer: answer.document.rank)


def _sketch_of_first_answer(
    scenes: Sequence[Mapping[str, Any]], answers: Sequence[PageAnswer]
) -> Markup:
    """Returns the sketch of the first answer's bearing, else of the first scene; "" without scenes.

    The preload is the recommended one, if there is one.
    """
    if not scenes:
        return Markup()
    if not answers:
        return sketch(scenes[0])
    document, charts = answers[0].document, answers[0].charts
    scenes_of_answer = [scene for scene in scenes if scene["name"] == document.facts["scene"]]
    scene = scenes_of_answer[0] if scenes_of_answer else scenes[0]
    lines = charts[0].lines if charts else []
    stars = [(line.star, line.method) for line in lines if line.star]
    if not stars:
        return sketch(scene)
    # a star is at the preload [N] and life of the recommendation for a method
    (preload_N, _), method = max(stars, key=lambda star: star[0][1])
    return sketch(scene, method, preload_N)


def _check_suffixes(files: Iterable[Path], suffixes: Sequence[str]) -> None:
    """Raises CaseFileError for a file with none of the suffixes, which the page would leave out."""
    for file in files:
        if file.suffix not in suffixes:
            got = "a folder" if file.is_dir() else f"the suffix {file.suffix!r}"
            advice = ""
            if file.suffix in SCENE_SUFFIXES:
                advice = f"; `bearingwear study {file}` makes its page"
            raise CaseFileError(f"{file}: got {got}, expected {', '.join(suffixes)}{advice}")


def _is_life(dataset: xr.Dataset) -> bool:
    """Returns whether a dataset contains lives by preload method, not cases."""
    return "end_criterion" in dataset and "preload_method" in dataset.dims


def _sections(datasets: dict[Path, xr.Dataset]) -> dict[Path, Section]:
    """Returns the sections by the folders of their scenes, in the order of the files.

    datasets: contents of the files. CaseFileError: one is no file of a study.
    """
    sections: dict[Path, Section] = {}
    for file, dataset in datasets.items():
        if "preload_method" not in dataset.dims or "status" not in dataset:
            raise CaseFileError(
                f"{file}: got a single result, which `bearingwear show` prints, expected a file of "
                "a study; `bearingwear study SCENE.yaml` makes a page of a scene"
            )
        section = sections.setdefault(file.parent, Section(plain_scene(dataset)))
        status = dataset["status"].values
        solved_codes = (OK, CRITERION_NOT_REACHED) if _is_life(dataset) else (OK,)
        solved = int(np.isin(status, solved_codes).sum())
        section.counts.append(
            SolvedCount(noun=_content_noun(dataset), solved=solved, total=status.size)
        )
    for folder, section in sections.items():
        in_folder = [dataset for file, dataset in datasets.items() if file.parent == folder]
        section.errors = list(_largest_errors(in_folder))
        section.warnings = list(_warnings_with_counts(in_folder, section.scene))
    return sections


def _content_noun(dataset: xr.Dataset) -> str:
    """Returns the plural noun for the content of a file: `lives`, `cases` or `dynamic cases`."""
    if _is_life(dataset):
        return "lives"
    return "dynamic cases" if dataset.attrs.get("fidelity") == "dynamic" else "cases"


_SINGULAR = {"lives": "life", "cases": "case", "dynamic cases": "dynamic case"}


def _warnings_with_counts(
    datasets: Sequence[xr.Dataset], scene: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    """Yields each warning of a scene at its largest excess, and how many results have it."""
    merged = {"warnings": merged_warnings(dataset.attrs for dataset in datasets)}
    for warning in warnings_in(merged):
        counts = [
            _count_text(in_file["cases"], _content_noun(dataset))
            for dataset in datasets
            for in_file in warnings_in(dataset.attrs)
            if in_file["id"] == warning["id"]
        ]
        yield warning_with_cases(warning, scene)["sentence"], ", ".join(counts)


def _count_text(count: int, noun: str) -> str:
    """Returns a number with its noun: `1 case`, `2 cases`."""
    return f"{count} {noun if count != 1 else _SINGULAR[noun]}"


def _largest_errors(datasets: Sequence[xr.Dataset]) -> Iterator[tuple[str, str]]:
    """Yields each quantity with an error estimate, and its largest error in all solved cases."""
    for name, words in (
        ("qv_error_estimate", "QV"),
        ("residual_preload_error_estimate", "residual preload"),
        ("wear_rate_error_estimate", "wear rate"),
        ("life_error_estimate", "life"),
    ):
        errors = [float(abs(dataset[name]).max()) for dataset in datasets if name in dataset]
        errors = [error for error in errors if np.isfinite(error)]
        if errors:
            yield words, f"{Rough(100.0 * max(errors)).in_unit('%')} %"


def _versions(datasets: Iterable[xr.Dataset]) -> list[dict[str, str]]:
    """Returns the distinct sets of versions with which the datasets were computed."""
    versions: list[dict[str, str]] = []
    for dataset in datasets:
        version = {name: str(dataset.attrs.get(name, "–")) for name in VERSIONS}
        if version not in versions:
            versions.append(version)
    return versions


def _text(file: Path) -> str:
    """Returns the text of a file. May raise CaseFileError."""
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise CaseFileError(f"{file}: cannot be read ({' '.join(str(error).split())})") from None


def _markdown_title(file: Path) -> str:
    """Returns the title of a Markdown file, or the file's name if it has none."""
    first_line = _text(file).partition("\n")[0]
    return first_line[2:] if first_line.startswith("# ") else file.stem


class KeyRow(NamedTuple):
    """A row of the table of scenes: a key in words, with a value for each scene."""

    block: str  # name of the block that contains the key, in words
    words: str
    unit: str  # empty without a unit
    is_assumed: bool
    values: list[str]

    @property
    def label(self) -> str:
        """Returns the key with its unit in brackets, and a mark if its value is assumed."""
        unit = f" ({self.unit})" if self.unit else ""
        return f"{self.words}{unit}{ASSUMED if self.is_assumed else ''}"

    @property
    def differ(self) -> bool:
        """Returns whether the scenes have different values."""
        return len(set(self.values)) > 1

    def with_unit(self, value: str) -> str:
        """Returns a value of the row with its unit; without it if missing or a distribution."""
        if not self.unit or value == MISSING or self.block in _DISTRIBUTION_BLOCKS:
            return value
        return (
            f"{value}{self.unit}" if self.unit == "°" else f"{value}\N{NO-BREAK SPACE}{self.unit}"
        )


ASSUMED = "\N{NO-BREAK SPACE}*"
"""Suffix of the label of an assumed quantity."""
MISSING = "–"
"""Text of a value that a scene does not have."""
_NOT_COMPARED = ("name", "description")
_DISTRIBUTIONS = ("uncertainty", "cage_uncertainty")
"""Blocks of a scene that contain distributions."""
_DISTRIBUTION_BLOCKS = tuple(block.replace("_", " ") for block in _DISTRIBUTIONS)
_MOST_DIFFERENCES = 4
"""Number of differences that `scene_differences` states; it only counts further ones."""


def key_rows(scenes: Sequence[Mapping[str, Any]], assumed: Container[str] = ()) -> Iterator[KeyRow]:
    """Yields the rows of the table of scenes, block by block.

    assumed: keys whose values are marked as assumed.
    """
    columns = [
        {key: _value_text(value) for key, value in leaves(_with_distribution_texts(scene)).items()}
        for scene in scenes
    ]
    for scene, column in zip(scenes, columns, strict=True):
        if is_pair(scene) and METHOD_KEY not in column:  # both methods were studied
            column[KIND_KEY] = _value_text(list(METHODS))
    keys = list(dict.fromkeys(key for column in columns for key in column))
    blocks = list(dict.fromkeys(key.partition(".")[0] for key in keys))
    for key in sorted(keys, key=lambda name: blocks.index(name.partition(".")[0])):
        if key not in _NOT_COMPARED:
            *blocks_of_key, _ = key.split(".")
            words, unit = key_in_words(key)
            yield KeyRow(
                block=", ".join(block.replace("_", " ") for block in blocks_of_key),
                words=words,
                unit=printed_unit(unit) if unit else "",
                is_assumed=key in assumed or f"{key}.distribution" in assumed,
                values=[column.get(key, MISSING) for column in columns],
            )


def _with_distribution_texts(scene: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns a scene in which each uncertain value has its distribution as one text."""
    texts = {
        block: {key: _distribution_text(parameters) for key, parameters in scene[block].items()}
        for block in _DISTRIBUTIONS
        if scene.get(block)
    }
    return {**scene, **texts}


def _distribution_text(parameters: Mapping[str, Any]) -> str:
    """Returns a distribution in words: `normal, standard deviation 0.003`."""
    words = [
        f"{name.replace('_', ' ')} {_value_text(value)}"
        for name, value in parameters.items()
        if name != "distribution" and value is not None
    ]
    return ", ".join([parameters["distribution"], *words])


def key_blocks(rows: Iterable[KeyRow]) -> Iterator[tuple[str, list[KeyRow]]]:
    """Yields the name of each block of a scene, with its rows, which follow each other."""
    for block, block_rows in groupby(rows, key=lambda row: row.block):
        yield block, list(block_rows)


def differences_by_block(
    first: Mapping[str, Any], other: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    """Yields each block in which a scene differs from the first, and its differing values."""
    for block, block_rows in key_blocks(key_rows([first, other])):
        rows = [row for row in block_rows if row.differ]
        missing = [row.values[1] == MISSING for row in rows]
        if rows and len(rows) == len(block_rows) and all(missing):
            yield block, "none"
        elif rows:
            phrases = [
                f"no {row.words}" if is_missing else f"{row.words} {row.with_unit(row.values[1])}"
                for row, is_missing in zip(rows, missing, strict=True)
            ]
            yield block, "; ".join(phrases)


def scene_differences(first: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    """States how another scene differs from the first, without `uncertainty`."""
    rows = key_rows([_without_uncertainty(first), _without_uncertainty(other)])
    phrases = [
        f"{row.words} {row.values[1]} instead of {row.with_unit(row.values[0])}"
        for row in rows
        if row.differ
    ]
    remaining = len(phrases) - _MOST_DIFFERENCES
    suffix = f"; {remaining} more" if remaining > 0 else ""
    return "; ".join(phrases[:_MOST_DIFFERENCES]) + suffix


def _without_uncertainty(scene: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a scene without its distributions."""
    return {block: value for block, value in scene.items() if block != "uncertainty"}


def _value_text(value: Any) -> str:
    """Returns a value of a scene as text; a dash for None."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(_value_text(item) for item in value)
    return MISSING if value is None else str(value).replace("_", " ")
