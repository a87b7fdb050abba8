"""A document as text, Markdown, HTML, JSON and CSV, and as it is stored for the page."""

import csv
import io
import json
import math
import re

import html5lib
import numpy as np
import pytest
import xarray as xr

from bearingwear.cli import main
from bearingwear.document.data import as_csv, as_json
from bearingwear.document.document import Block, Document, Row, load_document
from bearingwear.document.html import as_html
from bearingwear.document.markdown import as_markdown
from bearingwear.document.table import flag_names
from bearingwear.document.text import as_text
from bearingwear.results.units import Estimated, Interval, Rough

MOST_CHARACTERS = 110  # in a line
LIFE = Row("life", "h", (Rough(3.1415), Interval(1.0, 2.5)), "life", 2.0, "passed")
POWER = Row("power", "mW", (Estimated.of(12.3456, 0.02), math.nan), "power")
PRELOAD = Row("preload", "N", (1.0, 2.0), "preload", given=True)
DOCUMENT = Document(
    ("a_b: take <5> N", "second line"),
    {"kind": "x", "scene": "a_b"},
    (
        Block("what to take", ("spring", "fixed *"), (LIFE, POWER), ("Between 1 and 2 N/um.",)),
        Block("why", lines=("It lasts | longest & best.",), place="lead"),
        Block("map", rows=(PRELOAD, LIFE, POWER), axes=1, place="charted"),
    ),
    ("design",),
)


def test_text_has_a_line_for_each_quantity_and_for_each_point():
    text = as_text(DOCUMENT)
    assert text.startswith("a_b: take <5> N\nsecond line\n\n  what to take")
    assert re.search(r"^  life +h +3\.1 +1 to 2\.5  criterion 2, passed$", text, re.M)
    assert re.search(r"^  power +mW +12\.35 +–$", text, re.M)
    assert re.search(r"^ +preload \(N\) +life \(h\) +power \(mW\)\n +1 +3\.1 +12\.35\n", text, re.M)
    assert "  why\n    It lasts | longest & best.\n" in text


def test_a_table_without_points_has_its_heads_in_every_format():
    block = Block("map", rows=(Row("preload", "N"), Row("life", "h")), axes=1)
    document = Document(("title",), blocks=(block,))
    for text in (as_text(document), as_markdown(document), as_html(document)):
        assert text.index("preload (N)") < text.index("life (h)")


def test_long_sentences_are_wrapped_in_text():
    document = Document(("word " * 40,), {}, (Block("x", lines=("word " * 40,)),))
    assert max(map(len, as_text(document).splitlines())) <= MOST_CHARACTERS


def test_a_row_that_details_the_one_above_it_is_indented():
    rows = (Row("life", "h", (3.0,)), Row("  numerical error", "%", (1.0,)))
    document = Document(blocks=(Block("x", ("spring",), rows),))
    assert re.search(r"^  life +h +3\n    numerical error +% +1$", as_text(document), re.M)
    heads = html5lib.parse(as_html(document), namespaceHTMLElements=False).iterfind(".//tbody//th")
    assert [(head.text, head.get("class")) for head in heads] == [
        ("life (h)", None),
        ("numerical error (%)", "part"),
    ]


def test_columns_that_do_not_fit_beside_each_other_stand_in_parts_below():
    """Nine columns take two parts. The second has no line for `mass`, which has no value there."""
    temperature = Row("temperature", "degC", tuple(range(9)), limit=9.0)
    block = Block(
        "parts", tuple(f"column {k}" for k in range(9)), (temperature, Row("mass", "kg", (1,)))
    )
    lines = as_text(Document(blocks=(block,))).splitlines()
    assert max(map(len, lines)) <= MOST_CHARACTERS
    part_heads = [line.split("column")[1:] for line in lines if line.startswith("  parts")]
    part_values = [line.split()[2:] for line in lines if line.startswith("  temperature")]
    assert [len(heads) for heads in part_heads] == [5, 4]  # 5 x 13 characters fit beside the labels
    assert part_values == [[*"01234"], [*"5678", "criterion", "9"]]
    assert sum("mass" in line for line in lines) == 1


def test_a_few_columns_stay_beside_each_other_however_wide():
    """Two columns, which are there to be compared, may exceed MOST_CHARACTERS."""
    row = Row("limited by", "", ("a" * 40, "b" * 40))
    document = Document(blocks=(Block("x", ("spring", "fixed"), (row,)),))
    assert len(as_text(document).splitlines()) == 2


def test_percentages_below_a_thousandth_are_shown_as_such():
    rows = (Row("error", "%", (Rough(-1.9e-9), Rough(0.0123), 2e-9)),)
    assert Block("x", rows=rows).cells == [["< 0.001", "0.012", "< 0.001"]]


def test_markdown_escapes_markup_in_texts():
    text = as_markdown(DOCUMENT)
    assert text.startswith("# a_b: take &lt;5&gt; N\n\nsecond line\n\n## what to take\n\n")
    assert "|  | spring | fixed \\* |  |\n" in text
    assert "| life (h) | 3.1 | 1 to 2.5 | criterion 2, passed |\n" in text
    assert "It lasts \\| longest &amp; best." in text
    assert "| preload (N) | life (h) | power (mW) |\n| --- | --- | --- |\n| 1 | 3.1 |" in text


def test_html_is_valid_and_escapes_texts():
    page = f"<!DOCTYPE html><html><head><title>x</title></head><body>{as_html(DOCUMENT)}</body>"
    tree = html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(f"{page}</html>")
    cells = [text for node in tree.iter("td") if (text := "".join(node.itertext()))]
    assert cells[:2] == ["3.1", "1 to 2.5"]
    text = "".join(tree.itertext())
    assert "take <5> N" in text and "2\N{NO-BREAK SPACE}N/\N{WORD JOINER}µm" in text


def test_json_has_facts_sentences_and_unrounded_numbers():
    """Numbers are by column, or by point; an interval has two, and NaN is null."""
    data = json.loads(as_json(DOCUMENT))
    assert data["scene"] == "a_b"
    assert data["sentences"] == {"why": ["It lasts | longest & best."]}
    quantities = {(row["block"], row["name"]): row for row in data["quantities"]}
    life, power = (quantities["what to take", name] for name in ("life", "power"))
    assert life["values"] == {"spring": 3.1415, "fixed *": [1.0, 2.5]} and life["limit"] == 2.0
    assert power["values"]["fixed *"] is None
    assert quantities["map", "power"]["values"] == {"1": 12.3456, "2": None}


def test_no_two_lines_of_csv_have_the_same_keys():
    rows = list(csv.DictReader(io.StringIO(as_csv(DOCUMENT))))
    keys = [(row["block"], row["name"], row["column"]) for row in rows]
    assert len(keys) == len(set(keys))
    assert ("what to take", "life_low", "fixed *") in keys


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_every_locale_prints_the_same_json_and_csv(encoding, monkeypatch):
    """A sheet as text is in ASCII, with `u` for the prefix of micro."""
    text = "2.78\N{NO-BREAK SPACE}µm – 20\N{NO-BREAK SPACE}°C"
    document = Document((text,), {"bearing": text}, (Block("gap", lines=(text,)),))
    monkeypatch.setattr("bearingwear.document.show.scene_sheet", lambda scene: document)
    monkeypatch.setattr("bearingwear.scene.read.load_scene", lambda path: None)

    def printed(*options: str) -> bytes:
        with monkeypatch.context() as patch:
            raw = io.BytesIO()
            patch.setattr("sys.stdout", io.TextIOWrapper(raw, encoding=encoding))
            assert main(["show", "scene.yaml", *options]) == 0
            return raw.getvalue()

    data = json.loads(printed("--json").decode("utf-8"))
    assert data == {"bearing": text, "sentences": {"gap": [text]}, "quantities": []}
    assert f",bearing,,,,{text}" in printed("--csv").decode("utf-8")
    assert printed().decode(encoding).startswith("2.78 um ")


def test_a_stored_document_is_read_without_loss(tmp_path):
    path = tmp_path / "answer.json"
    path.write_text(DOCUMENT.stored, encoding="utf-8")
    read = load_document(path)
    assert as_text(read) == as_text(DOCUMENT) and as_html(read) == as_html(DOCUMENT)
    assert read.figures == ("design",) and read.blocks_in("charted")[0].title == "map"


def test_an_axis_without_entries_has_no_flag_names():
    """A recommendation without assumptions has such an axis after it is read from a file."""
    assert flag_names(xr.DataArray(np.zeros(0, dtype=int), dims="assumption")) == []


def test_json_has_null_for_a_number_that_does_not_exist():
    """NaN and infinity are no JSON; a stored document has them again when it is read."""
    facts = {"worst": {"value": float("nan")}, "limits": [1.0, float("inf")]}
    rows = (Row("life", "h", (float("nan"), 2.0)),)
    document = Document(("a",), facts=facts, blocks=(Block("lives", (), rows),))
    content = json.loads(as_json(document), parse_constant=pytest.fail)
    assert content["worst"] == {"value": None} and content["limits"] == [1.0, None]
    assert content["quantities"][0]["values"] == [None, 2.0]
    assert json.loads(document.stored, parse_constant=pytest.fail)
    lines = csv.DictReader(io.StringIO(as_csv(document)))
    (worst,) = [line["value"] for line in lines if line["name"] == "worst"]
    assert json.loads(worst) == {"value": None}


def test_a_stored_document_keeps_numbers_that_are_not_finite(tmp_path):
    numbers = Interval(1.0, math.inf), Rough(math.nan), -math.inf
    document = Document(blocks=(Block("lives", (), (Row("life", "h", numbers),)),))
    (tmp_path / "answer.json").write_text(document.stored, encoding="utf-8")
    interval, rough, lowest = load_document(tmp_path / "answer.json").blocks[0].rows[0].values
    assert interval == Interval(1.0, math.inf) and lowest == -math.inf
    assert isinstance(rough, Rough) and math.isnan(rough)
