"""The few numbers of a result file that an engineer wants, as text."""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.io.netcdf import SOURCE, CaseFileError, damaged, foreign, readable
from bearingwear.io.spread import (
    CONFIDENCE,
    GIVEN,
    KIND,
    NO_SPREAD,
    PLACES,
    RECOMMENDED,
    SEE,
    spread_of,
    uncertainty,
)
from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES
from bearingwear.model.scene import COUNTS

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.model.scene import Scene

NOT_SOLVED = "not solved"

# variable, label, unit, factor from the unit of the file
CONTACT = (
    ("contact_load", "contact load", "N", 1.0),
    ("contact_angle", "contact angle", "degree", 1.0),
    ("maximum_pressure", "maximum pressure", "MPa", 1e-6),
    ("semi_major_axis", "semi-major axis", "um", 1e6),
    ("semi_minor_axis", "semi-minor axis", "um", 1e6),
    ("qv", "QV", "mW", 1e3),
    ("friction_heat", "friction heat", "mW", 1e3),
    ("gyroscopic_slip_share", "gyroscopic slip share", "%", 100.0),
    ("spin_to_roll_ratio", "spin/roll", "1", 1.0),
    ("race_wear_rate", "wear rate, whole race", "um3/s", 1e18),
)
BEARING = (
    ("residual_preload", "residual preload", "N", 1.0),
    ("axial_displacement", "axial displacement", "um", 1e6),
    ("axial_stiffness", "axial stiffness", "N/um", 1e-6),
    ("total_qv", "QV", "W", 1.0),
    ("shaft_torque", "shaft torque", "uN m", 1e6),
    ("drag_power", "drag power", "W", 1.0),
    ("orbit_speed", "orbit speed of the balls", "rad/s", 1.0),
    ("skid_ratio", "skid ratio", "%", 100.0),
    ("ball_wear_rate", "wear rate of one ball", "um3/s", 1e18),
    ("qv_error_estimate", "numerical error of QV", "%", 100.0),
    ("residual_preload_error_estimate", "of the residual preload", "%", 100.0),
    ("wear_rate_error_estimate", "of the loss rate", "%", 100.0),
)
COUNTED = (
    ("life", "life", "h", 1.0),
    ("life_error_bound", "bound of the integration", "h", 1.0),
    ("life_error_estimate", "numerical error, all", "%", 100.0),
    ("normalised_life", "life times K_s/H", "s/Pa", 1.0),
)
HISTORY = (
    ("history_residual_preload", "residual preload", "N", 1.0),
    ("history_total_qv", "QV", "W", 1.0),
)
IN_TIME = (
    ("simulated_turns", "turns simulated", "1", 1.0),
    ("evaluated_turns", "turns averaged", "1", 1.0),
    ("qv_drift_per_turn", "drift of QV", "%/turn", 100.0),
    ("wear_rate_drift_per_turn", "drift of the wear rate", "%/turn", 100.0),
    ("slow_time_scale", "slow time scale", "s", 1.0),
    ("energy_account_error", "energy account error", "%", 100.0),
    ("steps_accepted", "steps", "1", 1.0),
    ("steps_rejected", "steps repeated", "1", 1.0),
    ("contact_events", "contact events", "1", 1.0),
)
CAGE = (
    ("cage_wear_rate", "wear rate, pockets", "um3/s", 1e18),
    ("cage_land_wear_rate", "wear rate, land", "um3/s", 1e18),
    ("cage_friction_heat", "friction heat", "mW", 1e3),
    ("cage_speed", "speed", "rad/s", 1.0),
    ("mean_pocket_torque", "mean pocket torque", "uN m", 1e6),
    ("mean_land_torque", "mean land torque", "uN m", 1e6),
)
BESIDE = (
    ("steady_life", "steady life", "h", 1.0),
    ("steady_loss_at_end", "loss at its end", "um", 1e6),
    ("steady_time_to_loss", "its time to the loss above", "h", 1.0),
)
WORN = (
    ("history_ball_worn_volume", "one ball", "um3", 1e18),
    ("history_pocket_worn_volume", "one pocket", "um3", 1e18),
    ("history_worn_diameter", "diameter of one ball", "um", 1e6),
)
WORN_WHOLE = (
    ("history_land_worn_volume", "guiding land", "um3", 1e18),
    ("history_groove_depth", "both grooves, depth", "um", 1e6),
    ("history_pocket_clearance", "pocket clearance then", "mm", 1e3),
    ("history_guide_clearance", "guide clearance then", "mm", 1e3),
)
STUDY = ("total_qv", "residual_preload", "axial_stiffness", "shaft_torque", "life")


@contextlib.contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[Any]:
    """A result file, open for reading; whatever turns out to be wrong with it takes one line.

    Yields
    ------
    netCDF4.Dataset

    Raises
    ------
    CaseFileError
    """
    import netCDF4

    readable(path)
    try:
        with netCDF4.Dataset(path) as file:
            if not str(getattr(file, "source", "")).startswith(SOURCE):
                raise foreign(path)
            yield file
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, CaseFileError):
            raise
        raise damaged(path, error) from None


def kind_of(file: Any) -> str:
    """What an open result file is: case, life, study, wear life, ..."""
    variables = file.variables
    if "end_criterion" in variables and not file["end_criterion"].dimensions:
        return "life"
    if "contact_load" in variables and "status" in variables and not file["status"].dimensions:
        return "case"
    return re.split(" of |:", str(getattr(file, "title", "result")))[0].lower()


def summary(path: str | os.PathLike[str]) -> str:
    """Text for a result file of any kind.

    Raises
    ------
    CaseFileError
    """
    with opened(path) as file:
        lines = {"life": _life, "case": _case}.get(kind_of(file), _several)(file)
        lines += _spreads(file, Path(path))
    return "\n".join(line.rstrip() for line in lines)


def _values(file: Any, name: str, factor: float = 1.0) -> np.ndarray:
    """Values of a variable, NaN where not solved; all NaN if it is not there."""
    if name not in file.variables:
        return np.array(np.nan)
    return np.ma.filled(np.ma.asarray(file[name][...], dtype=float), np.nan) * factor


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else float("nan")


def _number(value: float) -> str:
    return f"{value:.5g}" if np.isfinite(value) else NOT_SOLVED


def _row(label: str, unit: str, *values: str) -> str:
    return f"  {label:<26}{unit:<8}" + "".join(f"{value:>14}" for value in values)


def _heading(file: Any) -> list[str]:
    scene = json.loads(getattr(file, "scene", "{}"))
    lines = _scene(scene) if scene else []
    code = int(_values(file, "status"))
    name = STATUS_NAMES[code]
    fidelity = getattr(file, "fidelity", "?")
    return [*lines, f"model {fidelity}, status {name}: {STATUS_SENTENCES[name]}", ""]


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
    lines = [*_scene(scene.to_dict()), "", _row("bearing", "")]
    lines += [_row(label, unit, _number(value)) for label, unit, value in rows]
    lines += ["", _row("material", "", "E, GPa", "H, GPa", "K_s")]
    for part, name in (("balls", b.ball_material), ("races", b.race_material)):
        numbers = m[name].youngs_modulus_GPa, m[name].brinell_hardness_GPa, m[name].wear_coefficient
        lines.append(_row(f"{part}: {name}", "", *map(_number, numbers)))
    lines += ["", _row("end of life, the first of", "")]
    lines += [_row(name, "", _number(value)) for name, value in limits.items()]
    lines += [] if limits else [_row("none given", "")]
    return "\n".join(line.rstrip() for line in lines)


def _case(file: Any) -> list[str]:
    lines = _heading(file)
    balls = file.dimensions["ball"].size
    mean = f" (mean of {balls} balls)" if balls > 1 else ""
    lines.append(_row(f"contact{mean}", "", "inner", "outer"))
    for name, label, unit, factor in CONTACT:
        values = _values(file, name, factor)
        both = [_mean(values[..., k]) if values.ndim else np.nan for k in range(2)]
        lines.append(_row(label, unit, *map(_number, both)))
    lines += ["", _row(f"bearing{mean}", ""), *_rows(file, BEARING)]
    if getattr(file, "fidelity", None) == "dynamic":
        cage = _rows(file, CAGE)
        if "cage_speed" in file.variables:
            ratio = _mean(_values(file, "cage_speed")) / _mean(_values(file, "orbit_speed"))
            cage.append(_row("speed over orbit speed", "1", _number(ratio)))
        lines += ["", _row("in time", ""), *_rows(file, IN_TIME)]
        lines += [f"  {file.settled}"] if hasattr(file, "settled") else []
        lines += ["", _row("cage", ""), *cage] if cage else []
    return lines


def _rows(file: Any, table: Sequence[tuple[str, str, str, float]]) -> list[str]:
    """A row for each variable of a table that is there."""
    return [
        _row(label, unit, _number(_mean(_values(file, name, factor))))
        for name, label, unit, factor in table
        if name in file.variables
    ]


def _life(file: Any) -> list[str]:
    lines = [*_heading(file), _row("wear counted", "", "ball", "ball + races")]
    for name, label, unit, factor in COUNTED:
        if name in file.variables:
            lines.append(_row(label, unit, *map(_number, _values(file, name, factor))))
    criterion = file["end_criterion"]
    met = criterion.flag_meanings.split()[int(criterion[...])]
    loss = _number(float(_values(file, "loss_at_end", 1e6)))
    counts = json.loads(file.scene)["wear"]["counts"]
    chosen = _values(file, "life")[COUNTS.index(counts)]
    lines.append(_row(f"counts: {counts}", "h", _number(chosen)))
    lines += ["", _row("ended by", "", met), _row("loss of ball diameter", "um", loss)]
    if "step" in file.dimensions and file.dimensions["step"].size:
        lines += ["", _row("along the life", "", "start", "end")]
        for name, label, unit, factor in HISTORY:
            values = np.atleast_1d(_values(file, name, factor))
            lines.append(_row(label, unit, _number(values[0]), _number(values[-1])))
    return lines + _in_time(file)


def _in_time(file: Any) -> list[str]:
    """What a life that was followed in time says beyond a steady one."""
    if "steady_status" not in file.variables:
        return []
    names = file["steady_end_criterion"].flag_meanings.split()
    status = STATUS_NAMES[int(_values(file, "steady_status"))]
    end = names[int(_values(file, "steady_end_criterion"))]
    of = getattr(file, "steady_life_of", "?")
    lines = ["", _row(f"steady, {of}", "")]
    lines += [*_rows(file, BESIDE), _row("ended by", "", end if status == "ok" else status)]
    if "history_ball_worn_volume" not in file.variables:
        return lines
    lines += ["", _row("worn since the start", "", "mean", "least", "most")]
    for name, label, unit, factor in WORN:
        if name in file.variables:
            last = _values(file, name, factor)[-1]
            numbers = map(_number, (_mean(last), float(last.min()), float(last.max())))
            lines.append(_row(label, unit, *numbers))
    races = _values(file, "history_race_worn_volume", 1e18)[-1]
    rows = zip(("inner race", "outer race"), ("um3", "um3"), races, strict=True)
    lines += [_row(label, unit, _number(value)) for label, unit, value in rows]
    lines += [
        _row(label, unit, _number(float(_values(file, name, factor)[-1])))
        for name, label, unit, factor in WORN_WHOLE
        if name in file.variables
    ]
    return lines


def _several(file: Any) -> list[str]:
    """A file with more than one case or life in it."""
    lines = [getattr(file, "title", "study"), ""]
    lines.append(_row("dimension", "", "points"))
    for name, dim in file.dimensions.items():
        lines.append(f"{_row(name, '', str(dim.size))}  {_along(file, name)}")
    if "status" in file.variables:
        codes, counts = np.unique(_values(file, "status"), return_counts=True)
        lines += ["", _row("status", "", "cases")]
        for code, count in zip(codes, counts, strict=True):
            name = STATUS_NAMES[int(code)] if np.isfinite(code) else NOT_SOLVED
            lines.append(_row(name, "", str(count)))
    is_study = kind_of(file) in ("study", "wear life")
    found = [n for n in STUDY if n in file.variables] if is_study else _numbers_in(file)
    if found:
        lines += ["", _row("variable", "", "least", "most")]
    for name in found:
        values = _values(file, name)
        solved = values[np.isfinite(values)]
        ends = (solved.min(), solved.max()) if solved.size else (np.nan, np.nan)
        unit = str(getattr(file[name], "units", ""))
        lines.append(_row(name, unit, *map(_number, ends)))
    return lines + _lives(file)


def _spreads(file: Any, path: Path) -> list[str]:
    """How sure the lives of a file are, by itself or by files of uncertainty beside it."""
    lives = list(_points_of(file))
    if not lives:
        return ["", f"  {NO_SPREAD}; {SEE}"] if "life" in file.variables else []
    known, scene = _uncertainty(path), json.loads(file.scene)
    lines = ["", _row("spread of the life", "h", *(c.replace("_and_", " + ") for c in COUNTS))]
    missing = 0
    for label, method, friction, at in lives:
        found = spread_of(known, scene, method, friction, at)
        if not found or not all(found.values()):
            missing += 1
            continue
        lines += [_row(label, "")] if label else []
        for quantiles in zip(*found.values(), strict=True):
            lines.append(_row(quantiles[0].name, "h", *(_number(q.hours) for q in quantiles)))
            ends = (f" {q.low:.3g} to {q.high:.3g}" for q in quantiles)
            lines.append(_row(f"  {100 * CONFIDENCE:g} % confidence", "h", *ends))
    if missing:
        where = "" if missing == len(lives) else f" for the other {missing}"
        lines.append(f"  {NO_SPREAD}{where}; {SEE}")
    return lines


def _points_of(file: Any) -> Iterator[tuple[str, str, float, int]]:
    """Label, preload method, friction and kind of preload of each life that may have a spread."""
    kind = str(getattr(file, "kind", ""))
    if kind_of(file) == "life":
        scene = json.loads(file.scene)
        yield "", scene["operation"]["preload_method"], scene["friction"]["ball_race"], GIVEN
    elif kind in ("recommendation", KIND):
        mu = json.loads(file.scene)["friction"]["ball_race"]
        methods = file["preload_method"].flag_meanings.split()
        for flag in _values(file, "preload_method"):
            for at in _values(file, "at") if kind == KIND else (RECOMMENDED,):
                where = "own" if at == GIVEN else "recommended"
                yield f"{methods[int(flag)]}, {where}", methods[int(flag)], mu, at
    elif _has_lives(file):
        methods = file["preload_method"].flag_meanings.split()
        for flag in _values(file, "preload_method"):
            for mu in _values(file, "friction"):
                yield f"{methods[int(flag)]}, mu {mu:g}", methods[int(flag)], float(mu), GIVEN


def _uncertainty(file: Path) -> list[xr.Dataset]:
    """The file itself and those beside it, as far as they are of uncertainty."""
    found = []
    beside = [path for place in PLACES for path in sorted(file.parent.glob(place))]
    for path in [file, *beside]:
        with contextlib.suppress(CaseFileError):
            found.append(uncertainty(path))
    return found


def _along(file: Any, name: str) -> str:
    """The values of a coordinate, or the first and the last where they are many."""
    if name not in file.variables or file[name].dimensions != (name,):
        return ""
    flags = str(getattr(file[name], "flag_meanings", "")).split()
    values = _values(file, name)
    shown = [flags[int(v)] if flags else f"{v:g}" for v in values]
    unit = str(getattr(file[name], "units", "")).replace("1", "", 1)
    text = ", ".join(shown) if len(shown) <= 8 else f"{shown[0]} to {shown[-1]}"
    return f"{text} {unit}".rstrip()


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
    methods = file["preload_method"].flag_meanings.split()
    ends = file["end_criterion"].flag_meanings.split()
    lives, loss = _values(file, "life"), _values(file, "loss_at_end", 1e6)
    criteria = _values(file, "end_criterion")
    lines = ["", _row("life, wear counted", "h", "ball", "ball + races", "loss, um")]
    for i, method in enumerate(_values(file, "preload_method")):
        for j, mu in enumerate(_values(file, "friction")):
            end = ends[int(criteria[i, j])] if np.isfinite(criteria[i, j]) else ends[-1]
            numbers = map(_number, [*lives[i, j], loss[i, j]])
            lines.append(f"{_row(f'{methods[int(method)]}, mu {mu:g}', 'h', *numbers)}  {end}")
    return lines
