"""The bearings that fit what a text states, found by the model itself, and how their lives spread.

Theory: docs/theory.md, section 16.
"""

from __future__ import annotations

import itertools
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from bearingwear.io.config import load_scene
from bearingwear.io.netcdf import common_attributes
from bearingwear.io.variables import HOUR
from bearingwear.kernels.status import OK
from bearingwear.kernels.thrust import OUTER_SPIN
from bearingwear.model import parameters
from bearingwear.model.life import course_of, steady_states
from bearingwear.model.scene import COUNTS, Scene, most_balls
from bearingwear.model.steady import ThrustProblem
from bearingwear.study.design import COUNTED, attrs, flags
from bearingwear.study.design_plan import Family, Statements
from bearingwear.study.grid import PRELOAD_METHODS

FOUND = (
    "fits",
    "balls_do_not_fit",
    "no_contact_angle_gives_the_loss",
    "not_solved",
    "spins_on_the_inner_race",
    "no_more_gyroscopic_slip_at_low_friction",
    "no_drag_gives_the_course_of_qv",
)
"""Whether a bearing fits, and else the first statement that it does not."""
FITS, NO_ROOM, NO_ANGLE, NOT_SOLVED, INNER_SPIN, NO_SLIP, NO_DRAG = range(len(FOUND))

QV_LOSSES_UM = tuple(round(0.1 * k, 1) for k in range(8))  # as the paper draws its QV


def running(scene: Scene, method: str, mu: float, drag: float = 0.0) -> Scene:
    """The scene with a method, a friction and a drag."""
    return replace(
        scene,
        operation=replace(scene.operation, preload_method=method),
        friction=replace(scene.friction, ball_race=mu),
        lubricant=replace(scene.lubricant, drag_density_kg_m3=drag),
    )


def preload_loss(scene: Scene, stated: Statements) -> float:
    """Share of the initial preload that the stated wear takes, fixed position; NaN if unsolved."""
    given = running(scene, "fixed_position", stated.high_friction)
    state = steady_states(given)(stated.preload_loss_at_um * parameters.UM)
    return 1.0 - state.preload / scene.operation.preload_N if state.status == OK else np.nan


def angles_of(scene: Scene, family: Family) -> list[float]:
    """Free contact angles [degree] with the stated loss of preload.

    There may be several: a steep bearing loses little by geometry, a flat one is stiff enough. Two
    closer to each other than the steps of the search are missed.
    """

    def miss(angle: float) -> float:
        turned = replace(scene, bearing=replace(scene.bearing, contact_angle_deg=angle))
        return preload_loss(turned, family.statements) - family.statements.preload_loss

    angles = family.contact_angle_deg
    misses = [miss(angle) for angle in angles]
    return [
        float(brentq(miss, angles[k], angles[k + 1], xtol=1e-6))
        for k in range(len(angles) - 1)
        if misses[k] * misses[k + 1] < 0.0 or misses[k] == 0.0  # not where one of them is NaN
    ]


def spins_outside(scene: Scene, stated: Statements) -> int:
    """Whether the new balls spin mainly on the outer race and slip more at low friction."""
    share = []
    for mu in (stated.high_friction, stated.low_friction):
        problem = ThrustProblem.of(running(scene, "fixed_position", mu))
        case = problem.solve(problem.g.D0)
        if case.status != OK:
            return NOT_SOLVED
        if mu == stated.high_friction and case.branch != OUTER_SPIN:
            return INNER_SPIN
        share.append(steady_states(running(scene, "fixed_position", mu))(0.0).share.max())
    return FITS if share[1] > share[0] else NO_SLIP


def qv_fits(scene: Scene, drag: float, stated: Statements) -> tuple[bool, float]:
    """Whether QV at low friction falls and rises with wear as stated; and the largest skid ratio.

    Fixed position. Where a state was not solved, it does not.
    """
    solve = steady_states(running(scene, "fixed_position", stated.low_friction, drag))
    states = [solve(loss * parameters.UM) for loss in QV_LOSSES_UM]
    if any(state.status != OK for state in states):
        return False, np.nan
    qv = np.array([state.total_qv for state in states])
    least = int(np.argmin(qv))
    low, high = stated.qv_least_um
    later = float(np.interp(stated.qv_rise_at_um, QV_LOSSES_UM, qv))
    fits = low <= QV_LOSSES_UM[least] <= high and later >= (1.0 + stated.qv_rise) * qv[least]
    return fits, max(abs(state.skid) for state in states)


def member(scene: Scene, family: Family) -> dict[str, Any]:
    """What is found of one bearing that loses the stated preload."""
    stated = family.statements
    row: dict[str, Any] = {"found": spins_outside(scene, stated)}
    if row["found"] != FITS:
        return row
    fitting = []
    for drag in family.drag_density_kg_m3:
        fits, skid = qv_fits(scene, drag, stated)
        fitting += [(drag, skid)] if fits else []
    if not fitting:
        return row | {"found": NO_DRAG}
    row |= {"drag_low": fitting[0][0], "drag_high": fitting[-1][0]}
    row["skid_ratio"] = max(skid for _, skid in fitting)
    for method in PRELOAD_METHODS:
        given = running(scene, method, stated.high_friction, scene.lubricant.drag_density_kg_m3)
        course = course_of(given, steady_states(given))
        row[method] = course.times[-1] if course.status == OK else np.full(2, np.nan)
    return row


def candidates(base: Scene, family: Family) -> list[dict[str, Any]]:
    """Every bearing of the grid with every contact angle that gives the stated loss."""
    rows = []
    D0 = base.bearing.ball_diameter_mm
    grid = itertools.product(
        family.pitch_diameter_mm, family.ball_count, family.inner_groove_factor
    )
    for dm, count, f_i in grid:
        of = {"pitch_diameter": dm, "ball_count": count, "inner_groove_factor": f_i}
        if count > most_balls(D0, dm):
            rows.append(of | {"found": NO_ROOM})
            continue
        bearing = replace(
            base.bearing, pitch_diameter_mm=dm, ball_count=count, inner_groove_factor=f_i
        )
        # the cage would have to go with the pitch circle; no steady state knows it
        scene = replace(base, bearing=bearing, cage=None)
        angles = angles_of(scene, family)
        if not angles:
            rows.append(of | {"found": NO_ANGLE})
        for angle in angles:
            turned = replace(scene, bearing=replace(bearing, contact_angle_deg=angle))
            rows.append(of | {"contact_angle": angle} | member(turned, family))
    return rows


def identified(family: Family, folder: str | Path) -> xr.Dataset:
    """Every candidate: whether it fits, the drags it fits with, its lives."""
    base = load_scene(Path(folder) / f"{family.scene}.yaml")
    rows = candidates(base, family)
    dims = ("candidate",)
    variables: dict[str, tuple] = {
        "found": (
            dims, np.array([row["found"] for row in rows], dtype=np.int8),
            flags("whether the bearing fits what is stated", FOUND),
        )
    }  # fmt: skip
    for name, (long_name, units) in CANDIDATE.items():
        column = np.array([row.get(name, np.nan) for row in rows])
        variables[name] = (dims, column, attrs(long_name, units))
    lives = [[row.get(m, np.full(2, np.nan)) for m in PRELOAD_METHODS] for row in rows]
    variables["life"] = (
        (*dims, "preload_method", "counts"), HOUR * np.array(lives),
        attrs("wear life at the high friction", "h"),
    )  # fmt: skip
    marks = [load_scene(Path(folder) / f"{name}.yaml").bearing for name in family.marks]
    for name in MARKED:
        values = [float(getattr(mark, name)) for mark in marks]
        variables[f"mark_{name}"] = ("mark", values, {"long_name": f"{name} of a marked scene"})
    coords = {
        "preload_method": (
            "preload_method", np.arange(2, dtype=np.int8),
            flags("how the preload is applied", PRELOAD_METHODS),
        ),
        "counts": ("counts", np.arange(2, dtype=np.int8), flags(COUNTED, COUNTS)),
    }  # fmt: skip
    return xr.Dataset(
        variables,
        coords,
        common_attributes()
        | {
            "title": "Bearings that fit what is stated",
            "kind": "family",
            "scene": json.dumps(base.to_dict()),
            "marks": " ".join(family.marks),
            "statements": json.dumps(asdict(family.statements)),
            "comment": "A fit to a text, no validation.",
        },
    )


MARKED = ("pitch_diameter_mm", "contact_angle_deg", "ball_count", "inner_groove_factor")
"""What is kept of the marked scenes."""

CANDIDATE: dict[str, tuple[str, str]] = {
    "pitch_diameter": ("pitch diameter", "mm"),
    "ball_count": ("number of balls", "1"),
    "inner_groove_factor": ("inner groove radius over ball diameter", "1"),
    "contact_angle": ("free contact angle with the stated loss of preload", "degree"),
    "drag_low": ("least drag density with the stated course of QV", "kg m-3"),
    "drag_high": ("largest drag density with the stated course of QV", "kg m-3"),
    "skid_ratio": ("largest skid ratio at the drags that fit, low friction", "1"),
}
"""What a candidate has besides its lives; NaN where it does not come so far."""
