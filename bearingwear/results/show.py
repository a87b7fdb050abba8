"""The few numbers of a result file that an engineer wants, as text."""

from __future__ import annotations

import json
import math
import os
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.model.result import status_sentence
from bearingwear.results.kinds import (
    CASE_KIND,
    LIFE_KIND,
    STUDY_KIND,
    WEAR_LIFE_KIND,
    Registry,
    function,
    kind_of,
)
from bearingwear.results.netcdf import opened
from bearingwear.results.quantiles import (
    CONFIDENCE,
    GIVEN,
    KIND,
    NO_QUANTILES,
    PRELOAD_CHOICE,
    RECOMMENDED,
    SEE,
    quantiles_of,
    uncertainties_at,
)
from bearingwear.results.variables import CASE, EXTREMES, LIFE, RACES, of_all_balls
from bearingwear.results.warnings import warning_lines
from bearingwear.scene.scene import COUNTS

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

_NOT_SOLVED = "not solved"
VARIABLES = CASE | LIFE
LABEL_WIDTH, UNIT_WIDTH, VALUE_WIDTH = 26, 8, 14
MOST_LISTED = 8
"""Values of a coordinate that are listed; of more, the first and the last are."""

# Variables, in the order of their rows; labels and units are in the table of variables.
LOAD_RANGE = ("maximum_contact_load", "minimum_contact_load")
CONTACT = (
    "contact_load",
    *LOAD_RANGE,
    "contact_angle",
    "maximum_pressure",
    "semi_major_axis",
    "semi_minor_axis",
    "qv",
    "friction_heat",
    "gyroscopic_slip_share",
    "spin_to_roll_ratio",
    "race_wear_rate",
)
BEARING = (
    "residual_preload",
    "axial_displacement",
    "axial_stiffness",
    "total_qv",
    "shaft_torque",
    "drag_power",
    "orbit_speed",
    "skid_ratio",
    "ball_wear_rate",
    "qv_error_estimate",
    "residual_preload_error_estimate",
    "wear_rate_error_estimate",
)
INTEGRATION = (
    "simulated_turns",
    "evaluated_turns",
    "qv_drift_per_turn",
    "wear_rate_drift_per_turn",
    "slow_time_scale",
    "energy_account_error",
    "steps_accepted",
    "steps_rejected",
    "contact_events",
)
CAGE_MEANS = (
    "cage_wear_rate",
    "cage_land_wear_rate",
    "cage_friction_heat",
    "cage_speed",
    "mean_pocket_torque",
    "mean_land_torque",
)
LIVES = ("life", "life_error_bound", "life_error_estimate", "normalised_life")
START_AND_END = ("history_residual_preload", "history_total_qv")
STEADY_LIFE = ("steady_life", "steady_loss_at_end", "steady_time_to_loss")
WORN_OF_EACH = ("history_ball_worn_volume", "history_pocket_worn_volume", "history_worn_diameter")
WORN_RACES = "history_race_worn_volume"
WORN_WHOLE = (
    "history_land_worn_volume",
    "history_groove_depth",
    "history_pocket_clearance",
    "history_guide_clearance",
)
STUDY_RANGES = ("total_qv", "residual_preload", "axial_stiffness", "shaft_torque", "life")


def summary(path: str | os.PathLike[str], more: Registry = MappingProxyType({})) -> str:
    """Text for a result file of any kind.

    Parameters
    ----------
    path : path
    more : Registry
        For kinds of files that a study defines: a function that takes the open file
        (`netCDF4.Dataset`) and returns lines, which it may make with `row`, `number` and `values`.

    Raises
    ------
    CaseFileError
    """
    with opened(path) as file:
        kind = kind_of(file)
        lines_of = function(more[kind]) if kind in more else SUMMARIES.get(kind, _several)
        lines = [*lines_of(file), *_quantile_lines(file, Path(path)), *_warnings(file)]
    return "\n".join(line.rstrip() for line in lines)


def values(file: Any, name: str, factor: float = 1.0) -> np.ndarray:
    """Values of a variable, NaN where not solved; all NaN if it is not there."""
    if name not in file.variables:
        return np.array(np.nan)
    return np.ma.filled(np.ma.asarray(file[name][...], dtype=float), np.nan) * factor


def _mean(of: np.ndarray) -> float:
    return float(of.mean()) if of.size else float("nan")


def number(value: float) -> str:
    """Five digits, or that there is none."""
    return f"{value:.5g}" if np.isfinite(value) else _NOT_SOLVED


def row(label: str, unit: str, *texts: str) -> str:
    """A line of a table."""
    columns = "".join(f"{text:>{VALUE_WIDTH}}" for text in texts)
    return f"  {label:<{LABEL_WIDTH}}{unit:<{UNIT_WIDTH}}{columns}"


def _shown(file: Any, name: str) -> np.ndarray:
    """Values of a variable of a case or life in the unit in which it is shown."""
    return values(file, name, VARIABLES[name].factor)


def _variable_row(name: str, numbers: Iterable[float]) -> str:
    """The line of a variable of a case or life, its numbers in the unit in which it is shown."""
    return row(VARIABLES[name].label, VARIABLES[name].display_unit, *map(number, numbers))


def _mean_rows(file: Any, names: Iterable[str]) -> list[str]:
    """A line for each variable that is there, with the mean of its values."""
    return [_variable_row(n, [_mean(_shown(file, n))]) for n in names if n in file.variables]


def _meaning(file: Any, name: str) -> str:
    """The word for a single flag."""
    return str(file[name].flag_meanings.split()[int(file[name][...])])


def _heading(file: Any) -> list[str]:
    scene = json.loads(getattr(file, "scene", "{}"))
    lines = _scene(scene) if scene else []
    code = int(values(file, "status"))
    name = STATUS_NAMES[code]
    fidelity = getattr(file, "fidelity", "?")
    return [*lines, f"model {fidelity}, status {name}: {status_sentence(name, scene)}", ""]


def _scene(scene: Mapping[str, Any]) -> list[str]:
    bearing, operation = scene["bearing"], scene["operation"]
    loss = scene["wear"]["ball_diameter_loss_um"]
    worn = f"{loss:g}" if isinstance(loss, float) else "unequal"
    return [
        f"{scene['name']}: {bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm",
        f"{operation['shaft_speed_rpm']:g} r/min, {operation['preload_method']} preload "
        f"{operation['preload_N']:g} N, friction {scene['friction']['ball_race']:g}, "
        f"ball diameter loss {worn} um",
    ]


def scene_summary(scene: Scene) -> str:
    """Text for a scene: the main numbers, and what follows from them without a solve."""
    b, m = scene.bearing, scene.materials
    angle = math.radians(b.contact_angle_deg)
    mass = m[b.ball_material].density_kg_m3 * math.pi / 6.0 * b.ball_diameter_mm**3 * 1e-9
    groove = (b.inner_groove_factor + b.outer_groove_factor - 1.0) * b.ball_diameter_mm
    end = scene.wear.end_of_life
    limits = end.criteria if end is not None else {}
    rows = (
        ("ball diameter", "mm", b.ball_diameter_mm),
        ("pitch diameter", "mm", b.pitch_diameter_mm),
        ("free contact angle", "degree", b.contact_angle_deg),
        ("groove factor, inner", "1", b.inner_groove_factor),
        ("groove factor, outer", "1", b.outer_groove_factor),
        ("diametral clearance", "um", 2e3 * groove * (1.0 - math.cos(angle))),
        ("mass of a ball", "g", 1e3 * mass),
        ("speed x pitch diameter", "mm/min", scene.operation.shaft_speed_rpm * b.pitch_diameter_mm),
    )
    lines = [*_scene(scene.to_dict()), "", row("bearing", "")]
    lines += [row(label, unit, number(value)) for label, unit, value in rows]
    lines += ["", row("material", "", "E, GPa", "H, GPa", "K_s")]
    for part, name in (("balls", b.ball_material), ("races", b.race_material)):
        numbers = m[name].youngs_modulus_GPa, m[name].brinell_hardness_GPa, m[name].wear_coefficient
        lines.append(row(f"{part}: {name}", "", *map(number, numbers)))
    lines += ["", row("end of life, the first of", "")]
    lines += [row(name, "", number(value)) for name, value in limits.items()]
    lines += [] if limits else [row("none given", "")]
    return "\n".join(line.rstrip() for line in lines)


def _case(file: Any) -> list[str]:
    lines = _heading(file)
    balls = file.dimensions["ball"].size
    mean = f" (mean of {balls} balls)" if balls > 1 else ""
    lines.append(row(f"contact{mean}", "", *RACES))
    names = [n for n in CONTACT if n not in LOAD_RANGE or n in file.variables]
    lines += [_contact_row(file, name, balls) for name in names]
    lines += ["", row(f"bearing{mean}", ""), *_mean_rows(file, BEARING)]
    return lines + (_dynamics(file) if getattr(file, "fidelity", None) == "dynamic" else [])


def _contact_row(file: Any, name: str, balls: int) -> str:
    """Of all balls, the mean; of an extreme, the largest or the smallest."""
    found = _shown(file, name)
    of_both = found.reshape(-1, len(RACES)) if found.ndim else np.full((1, len(RACES)), np.nan)
    label = VARIABLES[name].label + (", of all" if balls > 1 and name in EXTREMES else "")
    return row(label, VARIABLES[name].display_unit, *map(number, of_all_balls(name, of_both, 0)))


def _warnings(file: Any) -> list[str]:
    found = warning_lines({"warnings": getattr(file, "warnings", "[]")})
    wrapped = [text for line in found for text in textwrap.wrap(line, 110, subsequent_indent="  ")]
    return ["", *wrapped] if wrapped else []


def _dynamics(file: Any) -> list[str]:
    """What a dynamic case says beyond a steady one."""
    lines = ["", row("in time", ""), *_mean_rows(file, INTEGRATION)]
    lines += [f"  {file.settled}"] if hasattr(file, "settled") else []
    cage = _mean_rows(file, CAGE_MEANS)
    if "cage_speed" in file.variables:
        ratio = _mean(values(file, "cage_speed")) / _mean(values(file, "orbit_speed"))
        cage.append(row("speed over orbit speed", "1", number(ratio)))
    return lines + (["", row("cage", ""), *cage] if cage else [])


def _life(file: Any) -> list[str]:
    lines = [*_heading(file), row("wear counted", "", "ball", "ball + races")]
    lines += [_variable_row(name, _shown(file, name)) for name in LIVES if name in file.variables]
    counts = json.loads(file.scene)["wear"]["counts"]
    lines.append(row(f"counts: {counts}", "h", number(values(file, "life")[COUNTS.index(counts)])))
    lines += ["", row("ended by", "", _meaning(file, "end_criterion"))]
    lines += [f"  {file.ended_by}"] if hasattr(file, "ended_by") else []
    lines.append(_variable_row("loss_at_end", [float(_shown(file, "loss_at_end"))]))
    if "step" in file.dimensions and file.dimensions["step"].size:
        lines += ["", row("along the life", "", "start", "end")]
        for name in START_AND_END:
            lines.append(_variable_row(name, np.atleast_1d(_shown(file, name))[[0, -1]]))
    return [*lines, *_steady_life(file), *_worn(file)]


def _steady_life(file: Any) -> list[str]:
    """The life by the steady model, which a dynamic life has beside its own."""
    if "steady_status" not in file.variables:
        return []
    status = int(values(file, "steady_status"))
    end = _meaning(file, "steady_end_criterion") if status == OK else STATUS_NAMES[status]
    lines = ["", row(f"steady, {getattr(file, 'steady_life_of', '?')}", "")]
    return [*lines, *_mean_rows(file, STEADY_LIFE), row("ended by", "", end)]


def _worn(file: Any) -> list[str]:
    """What has worn off the parts of a bearing at the end of a dynamic life."""
    if "history_ball_worn_volume" not in file.variables:
        return []
    at_end = {
        name: _shown(file, name)[-1]
        for name in (*WORN_OF_EACH, WORN_RACES, *WORN_WHOLE)
        if name in file.variables
    }
    lines = ["", row("worn since the start", "", "mean", "least", "most")]
    for name in WORN_OF_EACH:
        if name in at_end:
            of_each = at_end[name]
            lines.append(_variable_row(name, [_mean(of_each), of_each.min(), of_each.max()]))
    unit = VARIABLES[WORN_RACES].display_unit
    for race, volume in zip(RACES, at_end[WORN_RACES], strict=True):
        lines.append(row(f"{race} race", unit, number(volume)))
    return lines + [_variable_row(name, [at_end[name]]) for name in WORN_WHOLE if name in at_end]


def _several(file: Any) -> list[str]:
    """A file with more than one case or life in it."""
    lines = [getattr(file, "title", "study"), ""]
    lines.append(row("dimension", "", "points"))
    for name, dim in file.dimensions.items():
        lines.append(f"{row(name, '', str(dim.size))}  {_along(file, name)}")
    if "status" in file.variables:
        codes, counts = np.unique(values(file, "status"), return_counts=True)
        lines += ["", row("status", "", "cases")]
        for code, count in zip(codes, counts, strict=True):
            name = STATUS_NAMES[int(code)] if np.isfinite(code) else _NOT_SOLVED
            lines.append(row(name, "", str(count)))
    is_study = kind_of(file) in (STUDY_KIND, WEAR_LIFE_KIND)
    names = [n for n in STUDY_RANGES if n in file.variables] if is_study else _numbers_in(file)
    if names:
        lines += ["", row("variable", "", "least", "most")]
    for name in names:
        found = values(file, name)
        solved = found[np.isfinite(found)]
        ends = (solved.min(), solved.max()) if solved.size else (np.nan, np.nan)
        unit = str(getattr(file[name], "units", ""))
        lines.append(row(name, unit, *map(number, ends)))
    return lines + _lives(file)


def _quantile_lines(file: Any, path: Path) -> list[str]:
    """How sure the lives of a file are, by itself or by files of uncertainty beside it."""
    lives = list(_lives_with_quantiles(file))
    if not lives:
        return ["", f"  {NO_QUANTILES}; {SEE}"] if "life" in file.variables else []
    known, scene = uncertainties_at(path), json.loads(file.scene)
    lines = ["", row("spread of the life", "h", *(c.replace("_and_", " + ") for c in COUNTS))]
    missing = 0
    for label, method, friction, choice in lives:
        found = quantiles_of(known, scene, method, friction, choice)
        if not found or not all(found.values()):
            missing += 1
            continue
        lines += [row(label, "")] if label else []
        for quantiles in zip(*found.values(), strict=True):
            lines.append(row(quantiles[0].name, "h", *(number(q.hours) for q in quantiles)))
            ends = (f" {q.low:.3g} to {q.high:.3g}" for q in quantiles)
            lines.append(row(f"  {100 * CONFIDENCE:g} % confidence", "h", *ends))
    if missing:
        where = "" if missing == len(lives) else f" for the other {missing}"
        lines.append(f"  {NO_QUANTILES}{where}; {SEE}")
    return lines


def _lives_with_quantiles(file: Any) -> Iterator[tuple[str, str, float, int]]:
    """Label, preload method, friction and choice of preload of each life that may have L10."""
    kind = kind_of(file)
    if kind == LIFE_KIND:
        scene = json.loads(file.scene)
        yield "", scene["operation"]["preload_method"], scene["friction"]["ball_race"], GIVEN
    elif kind == "recommendation" or (kind == KIND and PRELOAD_CHOICE in file.variables):
        mu = json.loads(file.scene)["friction"]["ball_race"]
        for method in _methods(file):
            for choice in values(file, PRELOAD_CHOICE) if kind == KIND else (RECOMMENDED,):
                where = "own" if choice == GIVEN else "recommended"
                yield f"{method}, {where}", method, mu, choice
    elif _has_lives(file):
        for method in _methods(file):
            for mu in values(file, "friction"):
                yield f"{method}, mu {mu:g}", method, float(mu), GIVEN


def _methods(file: Any) -> list[str]:
    """The preload methods along the dimension of that name."""
    names = file["preload_method"].flag_meanings.split()
    return [names[int(flag)] for flag in values(file, "preload_method")]


def _along(file: Any, name: str) -> str:
    """The values of a coordinate, or the first and the last where they are many."""
    if name not in file.variables or file[name].dimensions != (name,):
        return ""
    flags = str(getattr(file[name], "flag_meanings", "")).split()
    texts = [flags[int(v)] if flags else f"{v:g}" for v in values(file, name)]
    unit = str(getattr(file[name], "units", "")).replace("1", "", 1)
    listed = ", ".join(texts) if len(texts) <= MOST_LISTED else f"{texts[0]} to {texts[-1]}"
    return f"{listed} {unit}".rstrip()


def _numbers_in(file: Any) -> list[str]:
    """Variables with numbers that are no coordinates and no flags."""
    return [
        name
        for name, variable in file.variables.items()
        if name not in file.dimensions
        and variable.dtype is not str
        and "flag_values" not in variable.ncattrs()
        and name != "status"
    ]


def _has_lives(file: Any) -> bool:
    axes = ("preload_method", "friction")
    return "end_criterion" in file.variables and file["end_criterion"].dimensions == axes


def _lives(file: Any) -> list[str]:
    """A row for each life in a file that has them over preload method and friction."""
    if not _has_lives(file):
        return []
    ends = file["end_criterion"].flag_meanings.split()
    lives, loss = values(file, "life"), _shown(file, "loss_at_end")
    criteria = values(file, "end_criterion")
    unit = VARIABLES["loss_at_end"].display_unit
    lines = ["", row("life, wear counted", "h", "ball", "ball + races", f"loss, {unit}")]
    for i, method in enumerate(_methods(file)):
        for j, mu in enumerate(values(file, "friction")):
            end = ends[int(criteria[i, j])] if np.isfinite(criteria[i, j]) else ends[-1]
            numbers = map(number, [*lives[i, j], loss[i, j]])
            lines.append(f"{row(f'{method}, mu {mu:g}', 'h', *numbers)}  {end}")
    return lines


SUMMARIES: Mapping[str, Callable[[Any], list[str]]] = {CASE_KIND: _case, LIFE_KIND: _life}
"""Of the kinds that are not shown like any file of a study."""
