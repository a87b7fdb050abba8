"""Figures of the main study from its files, which are checked."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import xarray as xr

from bearingwear.plotting.drawing import Figure, with_data_files
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.quantiles import load_quantiles
from bearingwear.results.words import dataset_of_bearing
from bearingwear.studies.dataset import load_with_axes, load_with_dynamic
from bearingwear.studies.grid.figures import dynamic as dynamic_figures
from bearingwear.studies.grid.figures import quasistatic
from bearingwear.studies.grid.figures.overlay import life_overlay_figure, wear_overlay_figure


def scene_figures(
    study: Path,
    lives: Path,
    cases: Sequence[Path],
    friction: Sequence[float],
    uncertainty: Sequence[Path] = (),
    bearing: str | None = None,
) -> Iterator[Figure]:
    """Step: yields figures of slip across the contacts, of wear rates against wear, and of lives.

    study, lives, cases: files of the cases, of the lives, and of single cases whose slip is drawn.
    friction: coefficients drawn.
    uncertainty: files of the study of uncertainty.
    bearing {"first", "second"}: of a pair of two that differ; None otherwise.
    """
    yield draw_slip(cases, bearing)
    yield draw_wear([study], friction, bearing)
    yield draw_life(lives, friction, uncertainty, bearing)


def friction_figures(
    study: Path, losses_um: Sequence[float], bearing: str | None = None
) -> Iterator[Figure]:
    """Step: yields a figure of QV and contact load against friction for each state of wear.

    losses_um: losses of ball diameter in the study [um].
    bearing {"first", "second"}: of a pair of two that differ; None otherwise.
    """
    for loss_um in losses_um:
        yield draw_friction(study, loss_um, bearing)


def draw_friction(study: Path, loss_um: float, bearing: str | None = None) -> Figure:
    """Returns the figure of QV and contact load against friction at a loss of ball diameter."""
    cases = _loaded(study, bearing, ball_diameter_loss=[loss_um])
    return with_data_files(quasistatic.friction_figure(cases, loss_um), study)


def draw_slip(cases: Sequence[Path], bearing: str | None = None) -> Figure:
    """Returns the figure of slip over the contact ellipses of single cases in files."""
    datasets = [_loaded(path, bearing, strip=()) for path in cases]
    return with_data_files(quasistatic.slip_figure(datasets), *cases)


def draw_wear(
    studies: Sequence[Path], friction: Sequence[float], bearing: str | None = None
) -> Figure:
    """Returns the figure of QV, preload, angles and wear rates against wear.

    studies: files. Several have a column each; a single one has a column for each friction.
    friction: coefficient of each column.
    CaseFileError: a file without these cases, or another number of coefficients than of files.
    """
    paths = list(studies) * len(friction) if len(studies) == 1 else studies
    if len(paths) != len(friction):
        raise CaseFileError(f"friction: got {len(friction)} values, expected {len(paths)}")
    columns = [
        _loaded(path, bearing, friction=[mu], ball_diameter_loss=())
        for path, mu in zip(paths, friction, strict=True)
    ]
    return with_data_files(quasistatic.wear_figure(columns, friction), *studies)


def draw_life(
    lives: Path,
    friction: Sequence[float],
    uncertainty: Sequence[Path] = (),
    bearing: str | None = None,
) -> Figure:
    """Returns the figure of wear and residual preload over the lives in a file.

    friction: coefficients of the lives drawn.
    uncertainty: files of the study of uncertainty.
    """
    dataset = _loaded(lives, bearing, interpolated_step=(), friction=friction)
    uncertainties = [quantiles for path in uncertainty for quantiles in load_quantiles(path)]
    figure = quasistatic.life_figure(dataset, friction, uncertainties)
    return with_data_files(figure, lives, *uncertainty)


def draw_overlay(studies: Sequence[Path], friction: float) -> Figure:
    """Step: returns the figure of QV, preload and loss rates of several scenes against wear.

    friction: coefficient at which the scenes are compared.
    """
    datasets = [_loaded(path, None, friction=[friction], ball_diameter_loss=()) for path in studies]
    return with_data_files(wear_overlay_figure(datasets, friction), *studies)


def draw_life_overlay(lives: Sequence[Path], friction: float) -> Figure:
    """Step: returns the figure of the lives of several scenes in the same panels.

    friction: coefficient at which the scenes are compared.
    """
    datasets = [_loaded(path, None, interpolated_step=(), friction=[friction]) for path in lives]
    return with_data_files(life_overlay_figure(datasets, friction), *lives)


def draw_dynamic(study: Path, dynamic: Path) -> Figure:
    """Returns the figure of dynamic cases together with the steady ones.

    study: file of steady cases, which contains every case of `dynamic`.
    """
    steady_cases, dynamic_cases = load_with_dynamic(study, dynamic)
    figure = dynamic_figures.dynamic_and_steady_figure(dynamic_cases, steady_cases)
    return with_data_files(figure, study, dynamic)


def draw_running_average(case: Path, reference: Path | None = None) -> Figure:
    """Step: returns the figure of the wear rates of a dynamic case as their means settle.

    reference: table with values to draw beside the rates.
    CaseFileError: a file that is no dynamic case.
    """
    dataset = load_with_axes(case)
    is_dynamic = dataset.attrs.get("fidelity") == "dynamic"
    if not is_dynamic or "status" not in dataset or dataset["status"].dims:
        raise CaseFileError(f"{case}: not a case solved dynamically")
    return with_data_files(dynamic_figures.running_average_figure(dataset, reference), case)


def _loaded(path: Path, bearing: str | None, **axes: Sequence[float]) -> xr.Dataset:
    """Returns the dataset of a bearing in a file that must have some axes.

    bearing {"first", "second"}: of a pair of two that differ; None otherwise.
    axes: as of `load_with_axes`.
    CaseFileError: the file lacks an axis or a value on it, or such a bearing.
    """
    return dataset_of_bearing(load_with_axes(path, **axes), path, bearing)
