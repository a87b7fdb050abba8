"""The package as a Python library."""

from __future__ import annotations

import inspect
import os
import tempfile
import warnings
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bearingwear.kernels.status import STATUS_SENTENCES
from bearingwear.results.kinds import CASE_KIND, LIFE_KIND, Registry, function, kind_of
from bearingwear.results.labels import coded, labelled
from bearingwear.results.netcdf import CaseFileError, dataset
from bearingwear.results.netcdf import load as read_file
from bearingwear.results.restart import restart_from
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.checking.records import SCENE_SUFFIXES
from bearingwear.scene.checking.strict_yaml import data_of, yaml_of
from bearingwear.scene.coefficients import FILMS, RUBBING
from bearingwear.scene.new.assumed import CLASSES
from bearingwear.scene.new.catalogue import MAKERS
from bearingwear.scene.new.designations import CLEARANCES
from bearingwear.scene.new.scene_file import BALL_MATERIALS
from bearingwear.scene.read import Source, as_scene, for_life, load_scene, scene_from_dict
from bearingwear.scene.scene import Scene, SceneError
from bearingwear.studies import registry
from bearingwear.studies.export import to_ross
from bearingwear.studies.sweep import sweep

__all__ = [
    "cage",
    "calibrate",
    "example",
    "life",
    "load",
    "new",
    "plot",
    "save",
    "show",
    "solve",
    "sweep",
    "to_ross",
]

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from bearingwear.document.document import Document
    from bearingwear.solvers.result import Result
    from bearingwear.studies.uncertainty.calibration import Calibration


CHOICES: Mapping[str, Collection[str]] = {
    "ball_material": BALL_MATERIALS,
    "preload_class": CLASSES,
    "maker": tuple(MAKERS),
    "clearance": CLEARANCES,
    "pair": tuple(pair for pair, _ in RUBBING),
    "film": FILMS,
}
"""Names that `new` takes."""

RADIAL_CLEARANCE = "radial_clearance_um"


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
        A scene file, a dict of the same shape, or a `Scene`.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    restart : path, optional
        A dynamic case file to go on from the end of. Its scene may differ in `wear` and `model`
        only.
    progress : callable, optional
        Given one line of text every few seconds of a dynamic solve.

    Returns
    -------
    xarray.Dataset
        What a case file holds, names in place of codes (`sel(race="inner")`), and the attributes
        `message` and `wall_time_s`. Its `status` is "ok" where the numbers may be used.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: the scene is wrong, or no model solves it.
    CaseFileError
        A ValueError, too: the file cannot be gone on from.

    Warns
    -----
    UserWarning
        The solver has not reached a verified answer; `status` and `message` say why. Or there is
        more to say of the result: the attribute `warnings`.
    """
    checked = as_scene(scene)
    from bearingwear.solvers.solve import solve as solved

    state = None if restart is None else restart_from(restart, checked)
    return _made(solved(checked, fidelity, state, progress), checked)


def life(
    scene: Source,
    fidelity: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Wear life of one scene.

    Parameters
    ----------
    scene : path, dict or Scene
        With at least one criterion under `wear.end_of_life`.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    progress : callable, optional
        Given one line of text at each step of a dynamic life.

    Returns
    -------
    xarray.Dataset
        What a life file holds, names in place of codes, and the attributes `message` and
        `wall_time_s`.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: the scene is wrong, or no model solves it.

    Warns
    -----
    UserWarning
        No life was found; `status` and `message` say why. Or as `solve`.
    """
    checked = for_life(as_scene(scene))
    from bearingwear.lives.life import life as lived

    return _made(lived(checked, fidelity, progress), checked)


def cage(
    scene: Source,
    runs: int = 200,
    within: float = 0.1,
    seed: int = 1,
    life: bool = False,
    workers: int = 1,
    path: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """Motions of a scene's cage and what they wear, by an ensemble of runs: `bearingwear cage`.

    Parameters
    ----------
    scene : path, dict or Scene
        With a cage. What is drawn stands under `uncertainty` and `cage_uncertainty`.
    runs : int
        At the most.
    within : float
        Half of the 90 % interval of the mean work in a turn, over it, at which no more are run.
    seed : int
    life : bool
        Whether to follow the cage's wear to its end, by ensembles along the way.
    workers : int
        Processes; they change nothing but the time.
    path : path, optional
        File to write, from which a killed call goes on.

    Returns
    -------
    xarray.Dataset
        Over `run`, what each has; `share` of each motion; `mean_*` over all runs and over those of
        a motion (`group`), with intervals; of a life, `cage_life` (turns), `cage_hours`, `node_*`.

    Raises
    ------
    SceneError
        A ValueError of one line.
    """
    from bearingwear.scene.checking.check import record
    from bearingwear.studies.cage.life import cage_found
    from bearingwear.studies.cage.plan import Ensemble

    plan = record(Ensemble, {"runs": runs, "within": within, "seed": seed}, "cage")
    file = None if path is None else Path(path)
    return labelled(cage_found(as_scene(scene), plan, life, workers, path=file))


def calibrate(scene: Source, tests: str | Path, workers: int = 1) -> Calibration:
    """A scene calibrated by tests of bearings: `bearingwear calibrate`.

    Parameters
    ----------
    scene : path, dict or Scene
        With an `uncertainty.wear_coefficient` and something that scatters, or no `uncertainty`:
        then that of the table of coefficients is taken.
    tests : path
        CSV: a line of column names, then a test each (docs/calibrate.md).
    workers : int
        Processes that share the lives.

    Returns
    -------
    Calibration
        `scene`, with what the tests leave unknown, and `data`: friction, K_s/H and life before and
        after, and the tests.

    Raises
    ------
    SceneError, CaseFileError
        Both are ValueErrors of one line; one that names the row and column at fault.
    """
    from bearingwear.studies.uncertainty.calibration import calibrated

    found = calibrated(for_life(as_scene(scene)), tests, workers)
    found.data = labelled(found.data)
    return found


def _made(result: Result, scene: Scene) -> xr.Dataset:
    """What `solve` and `life` return, and the warnings that go with it."""
    made = dataset(result, by_name=True)
    made.attrs["message"] = STATUS_SENTENCES[result.status]
    if result.status != "ok":
        text = f"{scene.name}: {result.status}: {STATUS_SENTENCES[result.status]}"
        warnings.warn(text, stacklevel=3)
    for one in warnings_in(made.attrs):
        warnings.warn(f"{scene.name}: {one['sentence']}; {one['advice']}", stacklevel=3)
    return made


def load(path: str | os.PathLike[str] | xr.Dataset) -> xr.Dataset | Any:
    """Read a file of this package.

    Parameters
    ----------
    path : path or Dataset
        A result file of any kind, or a scene (`.yaml`, `.yml`). Of a dataset that xarray has read,
        codes become names: `xr.open_mfdataset(..., preprocess=bearingwear.load)`.

    Returns
    -------
    xarray.Dataset or Scene
        The file's contents, names in place of codes; a case or a life with its `message`.

    Raises
    ------
    SceneError, CaseFileError
        Both are ValueErrors of one line.
    """
    if not isinstance(path, str | os.PathLike):
        return labelled(path)
    if Path(path).suffix in SCENE_SUFFIXES:
        return load_scene(path)
    found = labelled(read_file(path))
    if kind_of(found) in (CASE_KIND, LIFE_KIND):
        found.attrs["message"] = STATUS_SENTENCES[found["status"].item()]
    return found


def save(data: xr.Dataset | Scene, path: str | os.PathLike[str]) -> None:
    """Write a dataset of this package as the commands do, with codes for names; or a scene.

    Folders that are missing are made.

    Parameters
    ----------
    data : Dataset or Scene
    path : path
        Of a scene, one that ends with `.yaml` or `.yml`; of a dataset, any other.

    Raises
    ------
    OutputError
        An OSError of one line.
    """
    from bearingwear.atomic import OutputError, write_text

    if isinstance(data, Scene) != (Path(path).suffix in SCENE_SUFFIXES):
        given, allowed = ("a scene", "") if isinstance(data, Scene) else ("a dataset", " no")
        raise OutputError(
            f"{path}: got {given}, expected{allowed} {' or '.join(SCENE_SUFFIXES)} for it"
        )
    if isinstance(data, Scene):
        write_text(path, yaml_of(data.to_dict()))
    else:
        from bearingwear.studies.dataset import write_dataset

        write_dataset(coded(data), Path(path))


def show(data: str | os.PathLike[str] | xr.Dataset | Scene, every: bool = False) -> Document:
    """The sheet that `bearingwear show` prints: `print(show(case))`, a table in a notebook.

    Parameters
    ----------
    data : path, Dataset or Scene
        A scene, a result file of any kind, or what this package has made of it.
    every : bool
        With residuals, error estimates and versions, as `bearingwear show --all`.

    Raises
    ------
    SceneError, CaseFileError
        Both are ValueErrors of one line.
    """
    from bearingwear.document.show import scene_sheet, sheet

    if isinstance(data, str | os.PathLike) and Path(data).suffix in SCENE_SUFFIXES:
        data = load_scene(data)
    if isinstance(data, Scene):
        return scene_sheet(data)
    if isinstance(data, str | os.PathLike):
        return sheet(data, registry("SHEETS"), every)
    with tempfile.TemporaryDirectory() as folder:
        save(data, path := Path(folder) / "result.nc")
        return sheet(path, registry("SHEETS"), every)


def new(
    bore: float | None = None,
    outside: float | None = None,
    *,
    name: str = "bearing",
    **known: float | str,
) -> Scene:
    """A scene from the numbers of a catalogue, as `bearingwear new` makes it.

    Parameters
    ----------
    bore, outside : float, optional
        Diameters [mm], unless a designation says them.
    name : str
        Of the scene.
    **known : float or str
        What else is known, by the names of the command's options: `designation`, `maker`, `balls`,
        `ball_diameter` [mm], `pitch_diameter` [mm], `contact_angle` [degree], `clearance` (a group)
        or `radial_clearance_um`, `speed` [r/min], `preload` [N], `preload_class`, `friction`,
        `ball_material`, `preload_method`, `pair` and `film`.

    Returns
    -------
    Scene
        Its `description` says what was assumed, or is of a catalogue.

    Raises
    ------
    SceneError
        A ValueError of one line.
    """
    from bearingwear.scene.new.scene_file import OPTIONS, scene_text

    keys = {_argument(option): key for option, key, *_ in OPTIONS}
    own = inspect.signature(scene_text).parameters.keys() - {"name", "bore", "outside", "given"}
    allowed = [*own, *keys, RADIAL_CLEARANCE]
    if unknown := sorted(known.keys() - allowed):
        raise TypeError(f"new: got {unknown[0]!r}, expected {', '.join(sorted(allowed))}")
    for option, choices in CHOICES.items():
        text = known.get(option)
        if isinstance(text, str) and text not in choices:
            problem = f"got {text!r}, expected {', '.join(choices)}"
            raise SceneError("", problem, source=option)
    if RADIAL_CLEARANCE in known:
        if "clearance" in known:
            raise TypeError(f"new: got clearance and {RADIAL_CLEARANCE}, expected one of them")
        known["clearance"] = known.pop(RADIAL_CLEARANCE)
    given: dict[str, Any] = {keys[key]: value for key, value in known.items() if key in keys}
    others: dict[str, Any] = {key: known[key] for key in known.keys() - keys}
    others |= {"bore": bore, "outside": outside}
    try:
        written, assumed = scene_text(name, given=given, **others)
    except SceneError as error:
        raise error.in_source(_argument(error.source)) from None
    made = scene_from_dict(data_of(written, name), name)
    more = f"Not given: {'; '.join(assumed)}."
    return made.with_({"description": f"{made.description} {more}"})


def _argument(option: str) -> str:
    """`--ball-diameter` as Python has it."""
    return option.replace("--", "").replace("-", "_")


def example() -> Scene:
    """The scene `gyro_s1`: an instrument bearing with balls of 2 mm at 30 000 r/min."""
    from bearingwear.studies.launch import snakefile

    return load_scene(snakefile().parent / "config" / "scenes" / "gyro_s1.yaml")


class Plot:
    """Figures of results: `plot(data)`, or `plot.case(data)`, `plot.life(data)`, ... for one kind.

    The names are the kinds of files that `bearingwear plot` draws. A dataset or file of another
    kind is then refused. Nothing is saved or shown.

    Examples
    --------
    >>> bearingwear.plot(case).savefig("case.svg")
    >>> bearingwear.plot.life("life.nc").savefig("life.pdf")
    """

    def __call__(
        self, data: str | os.PathLike[str] | xr.Dataset, bearing: str | None = None
    ) -> Figure:
        """The figure of a result, as `bearingwear plot` draws it.

        Parameters
        ----------
        data : path or Dataset
            A result file of any kind, or what this package has made of it.
        bearing : {"first", "second"}, optional
            Which bearing of a pair; needed where they differ.

        Raises
        ------
        CaseFileError
            A ValueError of one line: a file that cannot be read, or a kind that cannot be drawn.
        """
        return self._drawn(data, registry("PLOTS"), bearing)

    def __getattr__(self, name: str) -> Callable[..., Figure]:
        kinds = {kind.replace(" ", "_"): kind for kind in registry("PLOTS")}
        if name not in kinds:
            raise AttributeError(f"plot: got {name!r}, expected {', '.join(kinds)}")
        kind = kinds[name]
        drawing = function(registry("PLOTS")[kind])

        def figure(data: str | os.PathLike[str] | xr.Dataset, bearing: str | None = None) -> Figure:
            return self._drawn(data, {kind: registry("PLOTS")[kind]}, bearing)

        figure.__name__, figure.__doc__ = name, drawing.__doc__
        return figure

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(kind.replace(" ", "_") for kind in registry("PLOTS"))]

    @staticmethod
    def _drawn(
        data: str | os.PathLike[str] | xr.Dataset, figures: Registry, bearing: str | None
    ) -> Figure:
        import matplotlib
        import xarray as xr

        from bearingwear.plotting.plot import figure_of

        with matplotlib.rc_context():  # figures have a style of their own
            if isinstance(data, str | os.PathLike):
                return figure_of(read_file(data), os.fspath(data), figures, bearing)
            if isinstance(data, xr.Dataset):
                return figure_of(coded(data), "plot", figures, bearing)
        kind = type(data).__name__
        raise CaseFileError(f"plot: got a {kind}, expected a result: a file or a Dataset")


plot = Plot()
