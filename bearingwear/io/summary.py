"""The few numbers of a result file that an engineer wants, as text."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from bearingwear.io.netcdf import SOURCE, CaseFileError, damaged, foreign, readable
from bearingwear.io.variables import COUNTS
from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES

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
)
COUNTED = (
    ("life", "life", "h", 1.0),
    ("life_error_bound", "error bound", "h", 1.0),
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
STUDY = ("total_qv", "residual_preload", "axial_stiffness", "shaft_torque", "life")


def summary(path: str | os.PathLike[str]) -> str:
    """Text for a case, life or study file.

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
            if "end_criterion" in file.variables and not file["end_criterion"].dimensions:
                lines = _life(file)
            elif "contact_load" in file.variables and not file["status"].dimensions:
                lines = _case(file)
            else:
                lines = _study(file)
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, CaseFileError):
            raise
        raise damaged(path, error) from None
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
    lines = []
    if scene:
        bearing, operation = scene["bearing"], scene["operation"]
        loss = scene["wear"]["ball_diameter_loss_um"]
        worn = f"{loss:g}" if isinstance(loss, float) else "unequal"
        lines = [
            f"{scene['name']}: {bearing['ball_count']} balls of {bearing['ball_diameter_mm']:g} mm",
            f"{operation['shaft_speed_rpm']:g} r/min, {operation['preload_method']} preload "
            f"{operation['preload_N']:g} N, friction {scene['friction']['ball_race']:g}, "
            f"ball diameter loss {worn} um",
        ]
    code = int(_values(file, "status"))
    name = STATUS_NAMES[code]
    fidelity = getattr(file, "fidelity", "?")
    return [*lines, f"model {fidelity}, status {name}: {STATUS_SENTENCES[name]}", ""]


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
    return lines


def _study(file: Any) -> list[str]:
    lines = [getattr(file, "title", "study"), ""]
    lines.append(_row("dimension", "", "points"))
    lines += [_row(name, "", str(dim.size)) for name, dim in file.dimensions.items()]
    if "status" in file.variables:
        codes, counts = np.unique(_values(file, "status"), return_counts=True)
        lines += ["", _row("status", "", "cases")]
        for code, count in zip(codes, counts, strict=True):
            name = STATUS_NAMES[int(code)] if np.isfinite(code) else NOT_SOLVED
            lines.append(_row(name, "", str(count)))
    found = [name for name in STUDY if name in file.variables]
    if found:
        lines += ["", _row("variable", "", "least", "most")]
    for name in found:
        values = _values(file, name)
        solved = values[np.isfinite(values)]
        ends = (solved.min(), solved.max()) if solved.size else (np.nan, np.nan)
        unit = str(getattr(file[name], "units", ""))
        lines.append(_row(name, unit, *map(_number, ends)))
    return lines
