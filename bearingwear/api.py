"""The package as a Python library."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.kernels.status import STATUS_SENTENCES
from bearingwear.measures import LIMITED
from bearingwear.results.kinds import CASE_KIND, LIFE_KIND, Registry, imported_function, kind_of
from bearingwear.results.labels import coded, labelled
from bearingwear.results.netcdf import CaseFileError, dataset_of_result
from bearingwear.results.netcdf import load as read_file
from bearingwear.results.restart import restart_from
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.checking.errors import did_you_mean
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.checking.strict_yaml import yaml_of
from bearingwear.scene.coefficients import LUBRICATIONS
from bearingwear.scene.new.assumed import CLASSES
from bearingwear.scene.new.catalogue import MAKERS
from bearingwear.scene.new.designations import CLEARANCES
from bearingwear.scene.new.scene_file import BALL_MATERIALS, PAIR_KINDS
from bearingwear.scene.read import Source, as_scene, load_scene, scene_for_life, written_data
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, SceneError
from bearingwear.studies import STUDY_PLOTS, STUDY_SHEETS
from bearingwear.studies.sweep import sweep

__all__ = [
    "example",
    "life",
    "load",
    "new",
    "plot",
    "recommend",
    "save",
    "show",
    "solve",
    "sweep",
    "uncertainty",
    "warmup",
]

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from bearingwear.document.document import Document
    from bearingwear.solvers.result import Result


CHOICES: Mapping[str, Collection[str]] = {
    "ball_material": BALL_MATERIALS,
    "preload_class": CLASSES,
    "maker": tuple(MAKERS),
    "clearance": CLEARANCES,
    "lubrication": LUBRICATIONS,
    "pair": tuple(PAIR_KINDS),
    "preload_method": PRELOAD_METHODS,
}
"""Choices of the options of `new`."""

RADIAL_CLEARANCE = "radial_clearance_um"
"""Option of `new` that gives the clearance as a number, in place of the group in `clearance`."""


def solve(
    scene: Source,
    fidelity: str | None = None,
    restart: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Solve one scene.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene file, a dict with the same structure, or a `Scene`.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    restart : path, optional
        A dynamic case file, from whose final state the run continues. The two scenes may differ
        only in `wear` and `model`.
    progress : callable, optional
        Called with one line of text every few seconds of a dynamic solve.

    Returns
    -------
    xarray.Dataset
        The contents of a case file, with names instead of codes (`sel(race="inner")`), and the
        attributes `message` and `wall_time_s`. If `status` is "ok", the numbers may be used.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: the scene is invalid, or no model can solve it.
    CaseFileError
        Also a ValueError: the run cannot continue from this file.

    Warns
    -----
    UserWarning
        No verified solution was found (`status` and `message` give the reason), or the result has
        warnings (attribute `warnings`).
    """
    checked = as_scene(scene)
    from bearingwear.solvers.solve import solve as solved_result

    state = None if restart is None else restart_from(restart, checked)
    return _dataset_with_warnings(solved_result(checked, fidelity, state, progress), checked.name)


def life(
    scene: Source,
    fidelity: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Compute the wear life of one scene.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with at least one criterion under `wear.end_of_life`.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    progress : callable, optional
        Called with one line of text at each step of a dynamic life.

    Returns
    -------
    xarray.Dataset
        The contents of a life file, with names instead of codes, and the attributes `message` and
        `wall_time_s`.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: the scene is invalid, or no model can solve it.

    Warns
    -----
    UserWarning
        No life was found (`status` and `message` give the reason), or the result has warnings
        (attribute `warnings`).
    """
    checked = scene_for_life(as_scene(scene))
    from bearingwear.lives.life import life as life_result

    return _dataset_with_warnings(life_result(checked, fidelity, progress), checked.name)


def uncertainty(
    scene: Source,
    friction: Sequence[float] = (),
    method: Sequence[str] = (),
    samples: int = 128,
    seed: int = 1,
    workers: int = 1,
) -> xr.Dataset:
    """Compute the spread in life due to uncertain values, like `bearingwear uncertainty`.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with at least one criterion under `wear.end_of_life`. A scene without `uncertainty`
        uses the one in the table of coefficients.
    friction : sequence of float
        Ball-race friction coefficients; if empty, that of the scene.
    method : sequence of str
        Preload methods; if empty, that of the scene.
    samples : int
        Number of bearings, bearings of a batch, and batches sampled, a power of two.
    seed : int
        Seed of the sample; the same seed gives the same lives.
    workers : int
        Number of processes, which affects only the time.

    Returns
    -------
    xarray.Dataset
        The contents of the file of the command, with names instead of codes: `life_quantile` and
        its interval, by preload method (and `friction`, if given).

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors with a one-line message.
    """
    from bearingwear.studies.uncertainty.quantiles import uncertain_lives

    return labelled(uncertain_lives(scene, friction, method, samples, seed, workers))


def recommend(scene: Source, workers: int = 1, **requirements: float) -> xr.Dataset:
    """Find the preload of the longest life within requirements, like `bearingwear recommend`.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with at least one criterion under `wear.end_of_life`.
    workers : int
        Number of processes, which affects only the time.
    **requirements : float
        Named like the options of the command, in their units: `stiffness=20`, `pressure=2`, ...;
        `at_speed_only=True`, and `warmup` (the time from rest to full speed).

    Returns
    -------
    xarray.Dataset
        By preload method: the recommended `preload`, its life and the extremes of all measures
        from new to the end of life; NaN if no preload satisfies the requirements. Without
        requirements, lives and measures over preload instead.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors with a one-line message.
    TypeError
        A requirement that does not exist.

    Warns
    -----
    UserWarning
        No preload satisfies all requirements.
    """
    from bearingwear.scene.checking.check import record
    from bearingwear.studies.design.plan import DesignLimits
    from bearingwear.studies.design.recommend import best_method, recommendation_and_map
    from bearingwear.studies.solve import life_scene

    keys = {_python_name(measure.option): key for key, measure in LIMITED.items()}
    keys |= {"at_speed_only": "at_speed_only", "warmup": "warmup_s"}
    for name in sorted(requirements):
        if name not in keys:
            raise TypeError(f"recommend: got {name!r}, expected {', '.join(sorted(keys))}")
    values = {keys[name]: value for name, value in requirements.items() if value is not None}
    limits = record(DesignLimits, values, "recommend")
    checked = life_scene(scene, films=True)
    recommendation, lives = recommendation_and_map(checked, limits, checked.name, workers)
    if limits.given and best_method(recommendation) is None:
        text = f"{checked.name}: no preload satisfies all requirements"
        warnings.warn(text, stacklevel=2)
    return labelled(recommendation if lives is None else lives)


def warmup(
    scene: Source,
    seconds: float | None = None,
    course: Sequence[tuple[float, float]] | None = None,
    duration: float | None = None,
) -> xr.Dataset:
    """Compute temperatures, preload and pressure during a warm-up, like `bearingwear warmup`.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with `thermal.heat_capacity_J_K`.
    seconds : float, optional
        Time from rest to full speed, at constant acceleration; if omitted, `duty.start_s`, and
        at once without a duty.
    course : sequence of (float, float), optional
        Times [s], which rise from 0, and shaft speeds [r/min]; `seconds` then has no effect.
    duration : float, optional
        Time at which to end [s]; if omitted, once the temperatures are steady.

    Returns
    -------
    xarray.Dataset
        Over `time`: the temperature of each `part`, the preload and the contact pressure of each
        bearing; the peaks with their times (`peak_*`), `thermal_margin`, and how the warm-up ended
        (`ending`).

    Raises
    ------
    SceneError
        A ValueError with a one-line message.

    Warns
    -----
    UserWarning
        The temperatures run away, or the bearings have no state at some instant.
    """
    checked = as_scene(scene)
    from bearingwear.solvers.warmup.transient import course_of, ramp
    from bearingwear.studies.warmup.result import warm_up_dataset

    ramp_s = checked.start_s if seconds is None else seconds
    shaft_course = ramp(ramp_s) if course is None else course_of(checked, course)
    warm_up = labelled(warm_up_dataset(checked, shaft_course, duration))
    status = str(warm_up["status"].item())
    if status != "ok":
        end = float(warm_up["end_time"])
        text = f"{checked.name}: {warm_up['ending'].item()} after {end:.4g} s ({status})"
        warnings.warn(text, stacklevel=2)
    return warm_up


def _dataset_with_warnings(result: Result, scene_name: str) -> xr.Dataset:
    """Return the dataset of a result, with the attribute `message`, and issue its warnings.

    Only `solve` and `life` may call this function: a warning names the line that called them.

    scene_name: text at the start of each warning.
    """
    result_dataset = dataset_of_result(result, by_name=True)
    result_dataset.attrs["message"] = STATUS_SENTENCES[result.status]
    if result.status != "ok":
        text = f"{scene_name}: {result.status}: {STATUS_SENTENCES[result.status]}"
        warnings.warn(text, stacklevel=3)
    for warning in warnings_in(result_dataset.attrs):
        warnings.warn(f"{scene_name}: {warning['sentence']}; {warning['advice']}", stacklevel=3)
    return result_dataset


def load(path: str | os.PathLike[str] | xr.Dataset) -> xr.Dataset | Any:
    """Read a file of this package.

    Parameters
    ----------
    path : path or Dataset
        A result file of any kind, or a scene (`.yaml`, `.yml`). In a dataset read by xarray, codes
        are replaced by names: `xr.open_mfdataset(..., preprocess=bearingwear.load)`.

    Returns
    -------
    xarray.Dataset or Scene
        The contents of the file, with names instead of codes; a case or life also has `message`.

    Raises
    ------
    SceneError, CaseFileError
        Both are ValueErrors with a one-line message.
    """
    if not isinstance(path, str | os.PathLike):
        return labelled(path)
    if Path(path).suffix in SCENE_SUFFIXES:
        return load_scene(path)
    contents = labelled(read_file(path))
    if kind_of(contents) in (CASE_KIND, LIFE_KIND):
        contents.attrs["message"] = STATUS_SENTENCES[contents["status"].item()]
    return contents


def save(data: xr.Dataset | Scene, path: str | os.PathLike[str]) -> None:
    """Write a scene or a dataset to a file.

    A dataset is written like those of the commands, with codes instead of names. Missing folders
    are created.

    Parameters
    ----------
    data : Dataset or Scene
    path : path
        For a scene, a name with the suffix `.yaml` or `.yml`; for a dataset, any other name.

    Raises
    ------
    OutputError
        An OSError with a one-line message.
    """
    from bearingwear.atomic import OutputError, write_text

    suffixes = " or ".join(SCENE_SUFFIXES)
    has_scene_suffix = Path(path).suffix in SCENE_SUFFIXES
    if isinstance(data, Scene):
        if not has_scene_suffix:
            problem = f"got a scene, expected a file name with the suffix {suffixes}"
            raise OutputError(f"{path}: {problem}")
        write_text(path, yaml_of(written_data(data)))
    else:
        if has_scene_suffix:
            problem = f"got a dataset, expected a file name without the suffix {suffixes}"
            raise OutputError(f"{path}: {problem}")
        from bearingwear.studies.dataset import write_dataset

        write_dataset(coded(data), Path(path))


def show(data: str | os.PathLike[str] | xr.Dataset | Scene, every: bool = False) -> Document:
    """Make the sheet of `bearingwear show`, for `print(show(case))` or display in a notebook.

    Parameters
    ----------
    data : path, Dataset or Scene
        A scene, a result file of any kind, or a dataset of this package.
    every : bool
        Whether to include residuals, error estimates and versions, like `bearingwear show --all`.

    Returns
    -------
    Document
        The sheet, which prints as text and is displayed as HTML.

    Raises
    ------
    SceneError, CaseFileError
        Both are ValueErrors with a one-line message.
    """
    from bearingwear.document.show import scene_sheet, sheet

    if isinstance(data, str | os.PathLike) and Path(data).suffix in SCENE_SUFFIXES:
        data = load_scene(data)
    if isinstance(data, Scene):
        return scene_sheet(data)
    if isinstance(data, str | os.PathLike):
        return sheet(data, STUDY_SHEETS, every)
    with tempfile.TemporaryDirectory() as folder:  # sheets of all kinds are made from open files
        path = Path(folder) / "result.nc"
        save(data, path)
        return sheet(path, STUDY_SHEETS, every)


def new(
    designation: str | None = None,
    *,
    bore: float | None = None,
    outside: float | None = None,
    name: str = "bearing",
    **values: float | str,
) -> Scene:
    """Make a scene from a few catalogue numbers, like `bearingwear new`.

    Parameters
    ----------
    designation : str, optional
        Such as `"7008C"`; with `maker`, any designation in that maker's catalogue.
    bore, outside : float, optional
        Diameters [mm], unless a designation gives them.
    name : str
        Name of the scene.
    **values : float or str
        Further values, named like the options of the command: `maker`, `balls`,
        `ball_diameter` [mm], `pitch_diameter` [mm], `contact_angle` [degree], `clearance` (a group)
        or `radial_clearance_um`, `speed` [r/min], `preload` [N], `preload_class`, `friction`,
        `ball_material`, `preload_method`, `lubrication` and `pair`.

    Returns
    -------
    Scene
        Its `description` lists the values that are assumed or from a catalogue.

    Raises
    ------
    SceneError
        A ValueError with a one-line message: a value is not allowed, or values contradict each
        other.
    TypeError
        A designation that is no text, an option that does not exist, or two clearances.
    """
    from bearingwear.scene.new.scene_file import OPTIONS, checked_scene, scene_text

    if isinstance(bore, str):
        problem = f"got {bore!r}, expected a number, or designation={bore!r}"
        raise SceneError("", problem, source="bore")
    if designation is not None and not isinstance(designation, str):
        raise TypeError(f"new: got {designation!r}, expected a designation such as '7008C'")
    keys = {_python_name(option): key for option, key, *_ in OPTIONS}
    allowed = sorted([*CHOICES, *keys, RADIAL_CLEARANCE])
    for option in sorted(values):
        if option not in allowed:
            raise TypeError(f"new: got {option!r}, expected {', '.join(allowed)}")
    _check_choices(values)
    if RADIAL_CLEARANCE in values:
        if "clearance" in values:
            raise TypeError(f"new: got clearance and {RADIAL_CLEARANCE}, expected only one of them")
        values["clearance"] = values.pop(RADIAL_CLEARANCE)
    numbers: dict[str, Any] = {}
    options: dict[str, Any] = {"bore": bore, "outside": outside, "designation": designation}
    for option, value in values.items():
        if option in keys:
            numbers[keys[option]] = value
        else:
            options[option] = value
    try:
        text, assumed = scene_text(name, given=numbers, **options)
        return checked_scene(text, f"Assumed or catalogue values: {'; '.join(assumed)}.")
    except SceneError as error:
        raise error.in_source(_python_name(error.source)) from None


def _check_choices(options: Mapping[str, float | str]) -> None:
    """Raise SceneError if an option of `new` has a text that is none of its choices.

    Options without a list of choices, and values that are no text, are not checked.
    """
    for option, choices in CHOICES.items():
        text = options.get(option)
        if isinstance(text, str) and text not in choices:
            advice = did_you_mean(text, choices)
            problem = f"got {text!r}, expected {', '.join(choices)}{advice}"
            raise SceneError("", problem, source=option)


def _python_name(option: str) -> str:
    """Return the name in Python of an option: `ball_diameter` of `--ball-diameter`."""
    return option.replace("--", "").replace("-", "_")


def example() -> Scene:
    """Load the scene `gyro_s1`, an instrument bearing with 2 mm balls at 30 000 r/min."""
    from bearingwear.studies.launch import snakefile

    return load_scene(snakefile().parent / "config" / "scenes" / "gyro_s1.yaml")


class Plot:
    """Figures of results: `plot(data)`, or `plot.case(data)`, `plot.life(data)`, ... for one kind.

    The names are the kinds of files that `bearingwear plot` draws. Each function refuses files and
    datasets of another kind. The figure is neither saved nor shown.

    Examples
    --------
    >>> bearingwear.plot(case).savefig("case.svg")
    >>> bearingwear.plot.life("life.nc").savefig("life.pdf")
    """

    def __call__(
        self, data: str | os.PathLike[str] | xr.Dataset, bearing: str | None = None
    ) -> Figure:
        """Draw the figure of a result, like `bearingwear plot`.

        Parameters
        ----------
        data : path or Dataset
            A result file of any kind, or a dataset of this package.
        bearing : {"first", "second"}, optional
            Bearing of a pair, which is required if the two differ.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        CaseFileError
            A ValueError with a one-line message: the file cannot be read, or its kind cannot be
            drawn.
        """
        return self._figure(data, STUDY_PLOTS, bearing)

    def __getattr__(self, name: str) -> Callable[..., Figure]:
        """Return the function that draws results of one kind, such as `plot.case`.

        AttributeError: no kind of result that is drawn has this name.
        """
        kinds = {kind.replace(" ", "_"): kind for kind in STUDY_PLOTS}
        if name not in kinds:
            raise AttributeError(f"plot: got {name!r}, expected {', '.join(kinds)}")
        kind = kinds[name]
        drawing = imported_function(STUDY_PLOTS[kind])

        def figure(data: str | os.PathLike[str] | xr.Dataset, bearing: str | None = None) -> Figure:
            return self._figure(data, {kind: STUDY_PLOTS[kind]}, bearing)

        figure.__name__, figure.__doc__ = name, drawing.__doc__
        return figure

    def __dir__(self) -> list[str]:
        """Return all attributes for completion, with the names of the functions for each kind."""
        return [*super().__dir__(), *(kind.replace(" ", "_") for kind in STUDY_PLOTS)]

    @staticmethod
    def _figure(
        data: str | os.PathLike[str] | xr.Dataset, figures: Registry, bearing: str | None
    ) -> Figure:
        """Draw the figure of a file or a dataset.

        figures: dotted name of the function that draws each kind.
        CaseFileError: `figures` lacks the kind, or `data` is neither a path nor a dataset.
        """
        import matplotlib
        import xarray as xr

        from bearingwear.plotting.plot import figure_of

        with matplotlib.rc_context():  # restores the user's settings, which drawing changes
            if isinstance(data, str | os.PathLike):
                return figure_of(read_file(data), os.fspath(data), figures, bearing)
            if isinstance(data, xr.Dataset):
                return figure_of(coded(data), "plot", figures, bearing)
        kind = type(data).__name__
        raise CaseFileError(f"plot: got a {kind}, expected a result file or a Dataset")


plot = Plot()
