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
from bearingwear.studies.grid.figures.overlay import lives_side_by_side, spread


def scene_figures(
    study: Path,
    lives: Path,
    cases: Sequence[Path],
    friction: Sequence[float],
    uncertainty: Sequence[Path] = (),
    bearing: str | None = None,
) -> Iterator[Figure]:
    """Draws slip across the contacts, QV and wear rates against wear, and wear over the life."""
    yield draw_slip(cases, bearing)
    yield draw_wear([study], friction, bearing)
    yield draw_life(lives, friction, uncertainty, bearing)


def friction_figures(
    study: Path, losses_um: Sequence[float], bearing: str | None = None
) -> Iterator[Figure]:
    """Draws QV and contact load against friction, a figure for each state of wear."""
    for loss_um in losses_um:
        yield draw_friction(study, loss_um, bearing)


def draw_friction(study: Path, loss_um: float, bearing: str | None = None) -> Figure:
    """Draws QV and contact load against friction at one state of wear."""
    cases = _loaded(study, bearing, ball_diameter_loss=[loss_um])
    return with_data_files(quasistatic.friction_figure(cases, loss_um), study)


def draw_slip(cases: Sequence[Path], bearing: str | None = None) -> Figure:
    """Draws slip over the contact ellipse."""
    datasets = [_loaded(path, bearing, strip=()) for path in cases]
    return with_data_files(quasistatic.slip_figure(datasets), *cases)


def draw_wear(
    studies: Sequence[Path], friction: Sequence[float], bearing: str | None = None
) -> Figure:
    """Draws QV, preload, angles and wear rates; a column for each file, or for each friction."""
    paths = [*studies] * len(friction) if len(studies) == 1 else studies
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
    """Draws wear and preload over the life."""
    dataset = _loaded(lives, bearing, interpolated_step=(), friction=friction)
    uncertainties = [quantiles for path in uncertainty for quantiles in load_quantiles(path)]
    figure = quasistatic.life_figure(dataset, friction, uncertainties)
    return with_data_files(figure, lives, *uncertainty)


def draw_overlay(studies: Sequence[Path], friction: float) -> Figure:
    """Draws QV, preload and loss rates of several scenes in the same panels."""
    datasets = [_loaded(path, None, friction=[friction], ball_diameter_loss=()) for path in studies]
    return with_data_files(spread(datasets, friction), *studies)


def draw_life_overlay(lives: Sequence[Path], friction: float) -> Figure:
    """Draws the lives of several scenes in the same panels."""
    datasets = [_loaded(path, None, interpolated_step=(), friction=[friction]) for path in lives]
    return with_data_files(lives_side_by_side(datasets, friction), *lives)


def draw_dynamic(study: Path, dynamic: Path) -> Figure:
    """Draws dynamic cases together with the steady ones."""
    figure = dynamic_figures.beside_steady_figure(*load_with_dynamic(study, dynamic))
    return with_data_files(figure, study, dynamic)


def draw_running_average(case: Path, reference: Path | None = None) -> Figure:
    """Draws settling wear rates, with values of a reference if there are any."""
    dataset = load_with_axes(case)
    is_dynamic = dataset.attrs.get("fidelity") == "dynamic"
    if not is_dynamic or "status" not in dataset or dataset["status"].dims:
        raise CaseFileError(f"{case}: not a case solved dynamically")
    return with_data_files(dynamic_figures.running_average_figure(dataset, reference), case)


def _loaded(path: Path, bearing: str | None, **axes: Sequence[float]) -> xr.Dataset:
    """Reads a file that must have some axes, and returns one bearing of a pair."""
    return dataset_of_bearing(load_with_axes(path, **axes), path, bearing)
