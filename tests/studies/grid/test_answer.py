"""What the answer of the main study says of its lives, and how sure they are."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from small_study import FOLDER, LIVES_ANSWER
from support import numbers_in, step

from bearingwear.cli import main
from bearingwear.document.document import load_document
from bearingwear.results.netcdf import load
from bearingwear.results.units import digits
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid.answer import MethodLife, answer, lives_of

# a scene as plain data, with what the answer names of it
SCENE = {
    "name": "a",
    "bearing": {
        "ball_count": 9,
        "ball_diameter_mm": 2.0,
        "pitch_diameter_mm": 7.5,
        "contact_angle_deg": 20.0,
        "ball_material": "steel",
        "race_material": "steel",
    },
    "operation": {"preload_N": 7.0, "shaft_speed_rpm": 3e4},
    "friction": {},
}


def with_spaces(text):
    """Returns a text with plain spaces in place of those at which no line breaks."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


def life(method, friction, hours, error=0.01, scene="a"):
    """Returns a life that ends by a criterion `x`; its relative error is NaN if it is unknown."""
    return MethodLife(scene, method, friction, hours, error, "x")


C, F = PRELOAD_METHODS  # constant force and fixed position
OTHER_WAY_ROUND = [life(C, 0.1, 2.0), life(F, 0.1, 1.0), life(C, 0.2, 1.0), life(F, 0.2, 2.0)]
OTHER_SCENE = [life(m, 0.1, 3.0, scene="b") for m in PRELOAD_METHODS]
UNKNOWN = math.nan
# Lives; the methods and a word of the headline; numbers of a sentence: ratio or %, and friction.
# Two lives with errors of 1 % count as the same if they differ by less than the sum, 2 %.
HEADLINES = [
    ([life(C, 0.1, 2.0), life(F, 0.1, 1.0)], {C}, "longer", {2.0, 0.1}),
    ([life(C, 0.1, 1.0), life(F, 0.1, 1.05)], {F}, "longer", {5.0, 0.1}),
    ([life(C, 0.1, 1.0), life(F, 0.1, 1.019)], set(), "same", set()),
    ([life(C, 0.1, 0.0), life(F, 0.1, 0.0)], set(), "neither", set()),
    ([life(C, 0.1, 0.0), life(F, 0.1, 2.0)], {F}, "longer", {0.1}),
    ([life(C, 0.1, 1.0, UNKNOWN), life(F, 0.1, 1.019, UNKNOWN)], {F}, "longer", {1.9, 0.1}),
    (OTHER_WAY_ROUND, set(), "depends on friction", {2.0, 0.1}),
    ([life(F, 0.1, 1.0)], {F}, "life with", set()),
    ([life(C, 0.1, UNKNOWN), life(F, 0.1, 1.0)], {C, F}, "life with", set()),
    ([life(F, 0.1, UNKNOWN)], set(), "no end", set()),
    ([life(C, 0.1, 1.0), *OTHER_SCENE], {C}, "life with", {1.0}),
]


@pytest.mark.parametrize(("lives", "methods", "word", "numbers"), HEADLINES)
def test_the_headline_names_the_better_method_and_a_sentence_by_how_much(
    lives, methods, word, numbers
):
    """The title has the scene, the preload and, after the last comma, the headline.

    One sentence of the answer contains all the numbers.
    """
    document = answer(lives, SCENE)
    assert document.title.startswith("a: ") and numbers_in(document.title) == [7.0]  # N
    _, _, headline = document.title.rpartition(", ")
    assert {name for name in PRELOAD_METHODS if name.replace("_", " ") in headline} == methods
    assert word in headline
    sentences = [with_spaces(text) for _, texts in sentence_blocks(document) for text in texts]
    assert any(numbers <= {*numbers_in(sentence)} for sentence in sentences), sentences


@pytest.mark.parametrize("lives", [lives for lives, *_ in HEADLINES])
def test_the_table_has_a_row_for_each_life_of_the_scene_and_no_nan(lives):
    """Lives of another scene have no row; no cell and no sentence contains NaN."""
    document = answer(lives, SCENE)
    rows = table_block(document).table[1]
    assert len(rows) == len([life for life in lives if life.scene == "a"])
    sentences = [text for _, texts in sentence_blocks(document) for text in texts]
    cells = [cell for row in rows for cell in row]
    assert not any("nan" in text.split() for text in (*sentences, *cells))


@pytest.fixture
def lives_and_spread(small_project, tmp_path):
    """Returns the paths of lives and of an invented spread beside them.

    Quantiles are 2, 4, ... 40 h, by preload method, preload and probability. With the inputs of a
    batch alone, they are the median times 0.5 to 2. Ends of intervals are 10 % off. One life of the
    second method failed.
    """
    scene = load_scene(small_project / "mine.yaml")
    quantiles = np.arange(2.0, 41.0, 2.0).reshape(2, 2, 5)  # method, preload, probability
    of_batch = quantiles[..., [2]] * np.array([0.5, 0.7, 1.0, 1.5, 2.0])
    by_inputs = quantiles, quantiles, quantiles, of_batch  # all, all but wear, scatter, batch
    counts = np.array([[[100, 0], [100, 0]], [[99, 1], [100, 0]]])
    dims = ("preload_method", "preload_choice", "uncertain_inputs", "probability")
    statuses = {"flag_values": [0, 1], "flag_meanings": "ok not_converged"}
    methods = {"flag_values": [0, 1], "flag_meanings": " ".join(PRELOAD_METHODS)}
    dataset = xr.Dataset(
        {
            **{
                f"life_quantile{end}": (dims, factor * np.stack(by_inputs, axis=2))
                for end, factor in (("_low", 0.9), ("", 1.0), ("_high", 1.1))
            },
            "solved_share": (dims[:2], [[1.0, 1.0], [0.99, 1.0]]),
            "status_count": ((*dims[:2], "life_status"), counts),
        },
        {
            "preload_method": ("preload_method", [0, 1], methods),
            "probability": [0.05, 0.1, 0.5, 0.9, 0.95],
            "life_status": ("life_status", [0, 1], statuses),
        },
        load(small_project / FOLDER / "wear_life.nc").attrs
        | {"kind": "uncertainty", "scene": json.dumps(scene.to_dict())},
    )
    (tmp_path / "design").mkdir()
    path = tmp_path / "design" / "uncertainty.nc"
    dataset.to_netcdf(path)
    lives = tmp_path / "wear_life.nc"
    lives.write_bytes((small_project / FOLDER / "wear_life.nc").read_bytes())
    return lives, path


def row_of(document, method, friction):
    """Returns the cells of a life by the heads of their columns.

    method, friction: texts of the table.
    """
    heads, lines = table_block(document).table
    (row,) = [line for line in lines if line[:2] == [friction, method]]
    return dict(zip(heads, row, strict=True))


def sentence_blocks(document):
    """Returns titles and lines of the blocks without a table."""
    return [(block.title, block.lines) for block in document.blocks if not block.rows]


def table_block(document):
    """Returns the only block with a table."""
    (table,) = (block for block in document.blocks if block.rows)
    return table


def answer_of(lives, spread=()):
    """Writes the answer by its step, and returns it. lives: a path; spread: paths."""
    path = lives.parent / "answer.json"
    inputs = {"lives": [lives], "uncertainty": spread}
    assert step("studies.grid.answer.lives_answer", path, **inputs) == 0
    return load_document(path)


def test_the_answer_is_that_of_the_file(small_project):
    """The ratio of lives, their end and cells of the table are those of tests/small_study.py.

    The first sentence compares the methods at the friction 0.02. The study has no spread.
    """
    lives = lives_of(load(small_project / FOLDER / "wear_life.nc"))
    hours_by_method = {life.method: life.hours for life in lives if life.friction == 0.02}
    ratio = hours_by_method["constant_force"] / hours_by_method["fixed_position"]
    document = load_document(small_project / LIVES_ANSWER)
    blocks = sentence_blocks(document)
    sentences = with_spaces(" ".join(text for _, texts in blocks for text in texts))
    comparison, _, _ = sentences.partition("; ")
    assert {float(f"{ratio:.2g}"), 0.02} <= {*numbers_in(comparison)}
    assert "gyroscopic slip share" in sentences and 50.0 in numbers_in(sentences)
    assert "not computed" in with_spaces(table_block(document).lines[0])  # of the spread
    for life_of_method in lives:
        method, friction = life_of_method.method, life_of_method.friction
        row = row_of(document, method.replace("_", " "), f"{friction:g}")
        hours = life_of_method.hours
        assert row["life (h)"] == digits(hours) and "L10 of the median batch (h)" not in row
    assert "9 balls of 2 mm" in with_spaces(document.facts["bearing"])


def test_the_summary_has_lives_with_their_spread(small_project, lives_and_spread):
    """A column has the lives of 90 % of bearings at the scene's own friction of 0.08.

    Lives at a friction without a spread have a dash, and the text names the command that samples
    them.
    """
    lives, spread = lives_and_spread
    written, table = lives.parent / "a.csv", lives.parent / "summary.md"
    inputs = {"study": small_project / FOLDER / "study.nc", "lives": lives, "uncertainty": [spread]}
    assert step("studies.grid.tables.study_tables", written, table, **inputs) == 0
    text = table.read_text().replace("\N{NO-BREAK SPACE}", " ").partition("## Wear life\n\n")[2]
    heads, _, *rows = (line.split(" | ") for line in text.partition("\n\n")[0].splitlines())
    column = heads.index("90 % of bearings (h)")
    bearings = {(row[1], row[0].removeprefix("| ")): row[column] for row in rows}
    assert bearings["constant force", "0.08"] == "2 to 10"
    assert bearings["fixed position", "0.08"] == "22 to 30"
    assert bearings["constant force", "0.02"] == "–"
    assert "bearingwear uncertainty" in table.read_text()


def test_the_answer_has_lives_with_their_spread(lives_and_spread):
    """Cells are quantiles of `lives_and_spread` [h], and dashes for a life without a spread.

    Of the median batch they are the 10 and 50 % points, else the 5 and 95 % points.
    """
    lives, spread = lives_and_spread
    document = answer_of(lives, [spread])
    row = row_of(document, "constant force", "0.08")
    assert (row["L10 of the median batch (h)"], row["L50 of the median batch (h)"]) == ("4", "6")
    assert row["90 % of bearings (h)"] == "2 to 10" == row["scatter within a batch (h)"]
    assert row["uncertainty of the batch (h)"] == "3 to 12"
    row = row_of(document, "fixed position", "0.08")
    assert (row["L10 of the median batch (h)"], row["L50 of the median batch (h)"]) == ("24", "26")
    assert row_of(document, "fixed position", "0.02")["L10 of the median batch (h)"] == "–"


def test_the_spread_of_another_scene_is_not_used(lives_and_spread):
    """1 r/min more makes another scene; the table names the command for its spread instead."""
    lives, path = lives_and_spread
    dataset = load(path)
    scene = json.loads(dataset.attrs["scene"])
    scene["operation"]["shaft_speed_rpm"] += 1.0
    path.unlink()
    dataset.assign_attrs(scene=json.dumps(scene)).to_netcdf(path)
    document = answer_of(lives, [path])
    assert "90 % of bearings (h)" not in row_of(document, "constant force", "0.08")
    assert "bearingwear uncertainty" in table_block(document).lines[0]


def test_without_a_study_of_uncertainty_no_life_has_a_spread(small_project, capsys):
    """Summary and sheet have no L10; the sheet names the command for it."""
    folder = small_project / FOLDER
    assert "L10" not in (folder / "tables" / "summary.md").read_text()
    assert main(["show", str(folder / "wear_life.nc")]) == 0
    text = capsys.readouterr().out
    assert "L10" not in text and "bearingwear uncertainty" in " ".join(text.split())
