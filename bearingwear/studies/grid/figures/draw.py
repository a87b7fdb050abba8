"""Figures of the main study: the files are read, and must be the right ones."""

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
    """Slip across the contacts, QV and wear rates against wear, and wear over the life."""
    yield draw_slip(cases, bearing)
    yield draw_wear([study], friction, bearing)
    yield draw_life(lives, friction, uncertainty, bearing)


def friction_figures(
    study: Path, losses_um: Sequence[float], bearing: str | None = None
) -> Iterator[Figure]:
    """QV and contact load against friction, a figure for each state of wear."""
    for loss_um in losses_um:
        yield draw_friction(study, loss_um, bearing)


def draw_friction(study: Path, loss_um: float, bearing: str | None = None) -> Figure:
    """QV and contact load against friction at one state of wear."""
    found = _loaded(study, bearing, ball_diameter_loss=[loss_um])
    return with_data_files(quasistatic.friction_figure(found, loss_um), study)


def draw_slip(cases: Sequence[Path], bearing: str | None = None) -> Figure:
    """Slip over the contact ellipse."""
    found = [_loaded(path, bearing, strip=()) for path in cases]
    return with_data_files(quasistatic.slip_figure(found), *cases)


def draw_wear(
    studies: Sequence[Path], friction: Sequence[float], bearing: str | None = None
) -> Figure:
    """QV, preload, angles and rate of wear; a column for each file, or several of one file."""
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
    """Wear and preload over the life."""
    found = _loaded(lives, bearing, interpolated_step=(), friction=friction)
    known = [one for path in uncertainty for one in load_quantiles(path)]
    return with_data_files(quasistatic.life_figure(found, friction, known), lives, *uncertainty)


def draw_overlay(studies: Sequence[Path], friction: float) -> Figure:
    """Several scenes overlaid."""
    found = [_loaded(path, None, friction=[friction], ball_diameter_loss=()) for path in studies]
    return with_data_files(spread(found, friction), *studies)


def draw_life_overlay(lives: Sequence[Path], friction: float) -> Figure:
    """Lives of several scenes overlaid."""
    found = [_loaded(path, None, interpolated_step=(), friction=[friction]) for path in lives]
    return with_data_files(lives_side_by_side(found, friction), *lives)


def draw_dynamic(study: Path, dynamic: Path) -> Figure:
    """Cases solved dynamically beside the steady ones."""
    figure = dynamic_figures.beside_steady_figure(*load_with_dynamic(study, dynamic))
    return with_data_files(figure, study, dynamic)


def draw_running_average(case: Path, reference: Path | None = None) -> Figure:
    """Wear rates as they settle, beside values of others if there are any."""
    found = load_with_axes(case)
    if found.attrs.get("fidelity") != "dynamic" or "status" not in found or found["status"].dims:
        raise CaseFileError(f"{case}: not a case solved dynamically")
    return with_data_files(dynamic_figures.running_average_figure(found, reference), case)


def _loaded(path: Path, bearing: str | None, **axes: Sequence[float]) -> xr.Dataset:
    return dataset_of_bearing(load_with_axes(path, **axes), path, bearing)
