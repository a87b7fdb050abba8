"""The kind of a result file: how it is found, and which functions show and draw the file."""

import re

import netCDF4
import numpy as np
import pytest
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import variable_values
from bearingwear.document.show import sheet
from bearingwear.document.text import as_text
from bearingwear.plotting.drawing import Figure, new_figure
from bearingwear.plotting.plot import figure_of, plot
from bearingwear.results.kinds import kind_of
from bearingwear.results.netcdf import CaseFileError, load


def sheet_of_a_map(file) -> Document:
    """Returns a sheet, as a study might define it for its own kind of file."""
    longest = Row("longest", "h", (float(variable_values(file, "life").max()),))
    return Document(("A map",), {}, (Block("", (), (longest,)),))


def figure_of_a_map(dataset: xr.Dataset) -> Figure:
    """Returns a figure, as a study might define it for its own kind of file."""
    figure, panels = new_figure(1, 1, 3.0, 3.0)
    panels[0, 0].plot(dataset["life"])
    return figure


KIND = "map of a test"


@pytest.fixture
def path(tmp_path):
    """Returns a file of the kind KIND, which no study of the program has."""
    life = ("preload", np.array([1.0, 3.0]), {"units": "h"})
    attrs = {"source": "bearingwear test", "title": "A test", "kind": KIND}
    xr.Dataset({"longest": life, "life": life}, attrs=attrs).to_netcdf(tmp_path / "map.nc")
    return tmp_path / "map.nc"


@pytest.mark.parametrize(
    ("variables", "attrs", "kind"),
    [
        ({"end_criterion": ((), 0)}, {"title": "anything"}, "life"),
        ({"end_criterion": ("x", [0])}, {"title": "Wear life of a"}, "wear life"),
        ({"contact_load": ("x", [1.0]), "status": ((), 0)}, {}, "case"),
        ({"contact_load": ("x", [1.0]), "status": ("x", [0])}, {"title": "Study of a"}, "study"),
        ({"status": ("x", [0])}, {"title": "Extremes: maps", "kind": "maps"}, "maps"),
        ({}, {"title": "Accuracy against time: a, b"}, "accuracy against time"),
        ({}, {}, "result"),
    ],
)  # fmt: skip
def test_a_file_and_its_dataset_have_one_kind(variables, attrs, kind, tmp_path):
    dataset = xr.Dataset(variables, attrs=attrs)
    assert kind_of(dataset) == kind
    dataset.to_netcdf(tmp_path / "a.nc")
    with netCDF4.Dataset(tmp_path / "a.nc") as file:
        assert kind_of(file) == kind


def test_a_study_shows_its_own_kind(path, monkeypatch):
    monkeypatch.setattr("bearingwear.document.show.sheet_of_a_map", sheet_of_a_map, raising=False)
    shown = as_text(sheet(path, {KIND: "bearingwear.document.show:sheet_of_a_map"}))
    assert re.match(r"A map\n\n  longest +h +3\n", shown)


def test_a_kind_that_no_study_shows_is_a_table_of_its_variables(path):
    shown = as_text(sheet(path))
    assert "longest" in shown and "least" in shown


def test_a_study_draws_its_own_kind(path, tmp_path, monkeypatch):
    monkeypatch.setattr("bearingwear.plotting.plot.figure_of_a_map", figure_of_a_map, raising=False)
    plot(path, [tmp_path / "a.svg"], {KIND: "bearingwear.plotting.plot:figure_of_a_map"})
    assert (tmp_path / "a.svg").stat().st_size > 0


def test_a_kind_that_no_study_draws_is_refused(path):
    with pytest.raises(CaseFileError, match=f"{KIND}, expected case, life"):
        figure_of(load(path), path, {"case": "no:such", "life": "no:such"})


def test_the_kind_of_a_study_is_kept_in_memory(path):
    assert load(path).attrs["kind"] == KIND
