"""The bearings that fit what a text states, found by the model itself, and how their lives spread.

Theory: docs/theory.md, section 16.
"""

from __future__ import annotations

import contextlib
import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from bearingwear.kernels.status import OK
from bearingwear.kernels.steady.thrust import OUTER_SPIN
from bearingwear.lives.many import HertzianLives
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.scene.checking.check import record
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, most_balls
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.compose import solver_of
from bearingwear.studies.dataset import LOSS_BASIS, filled
from workflow.studies.identify.plan import IdentifyPlan, Statements

CANDIDATES = "candidates"

FIT_RESULTS = (
    "fits",
    "balls_do_not_fit",
    "no_contact_angle_gives_the_loss",
    "not_solved",
    "spins_on_the_inner_race",
    "no_more_gyroscopic_slip_at_low_friction",
    "no_drag_gives_the_course_of_qv",
)
"""Whether a bearing fits, or the first statement that it fails."""
FITS, NO_ROOM, NO_ANGLE, STATE_NOT_SOLVED, SPINS_INSIDE, NO_SLIP, NO_DRAG = range(len(FIT_RESULTS))

CANDIDATE = table(
    Variable("fit_result", (), "", "whether the bearing matches the statements", dtype="i1",
        flags=FIT_RESULTS),
    Variable("pitch_diameter", (), "mm", "pitch diameter"),
    Variable("ball_count", (), "1", "number of balls", dtype="i8"),
    Variable("inner_groove_factor", (), "1", "inner groove radius over ball diameter"),
    Variable("contact_angle", (), "degree",
        "free contact angle that gives the stated loss of preload"),
    Variable("drag_low", (), "kg m-3",
        "minimum drag density at which QV varies with wear as stated"),
    Variable("drag_high", (), "kg m-3",
        "maximum drag density at which QV varies with wear as stated"),
    Variable("skid_ratio", (), "1",
        "maximum skid ratio at low friction, over the matching drag densities"),
    Variable("life", ("preload_method", *LOSS_BASIS.dims), "h", "wear life at high friction",
        scale=HOURS_PER_SECOND),
)  # fmt: skip
"""Results for a candidate; NaN for those after the first failure."""

MARK = "mark_"
MARKED_KEYS = ("pitch_diameter_mm", "contact_angle_deg", "ball_count", "inner_groove_factor")
MARKED = table(
    *(Variable(f"{MARK}{key}", (), "", f"{key} of a marked scene") for key in MARKED_KEYS)
)
"""Values of the marked scenes."""

QV_LOSSES_UM = tuple(round(0.1 * k, 1) for k in range(8))  # as the paper draws its QV


def running(scene: Scene, method: str, mu: float, drag: float = 0.0) -> Scene:
    return replace(
        scene,
        operation=replace(scene.operation, preload_method=method),
        friction=replace(scene.friction, ball_race=mu),
        lubricant=replace(scene.lubricant, drag_density_kg_m3=drag),
    )


def preload_loss(scene: Scene, stated: Statements) -> float:
    """Share of the initial preload that the stated wear takes, fixed position; NaN if unsolved."""
    given = running(scene, "fixed_position", stated.high_friction)
    state = solver_of(given).at(stated.preload_loss_at_um * parameters.UM)
    return (
        1.0 - state["residual_preload"] / scene.operation.preload_N
        if state.status == OK
        else np.nan
    )


class _NotSolved(Exception):
    """No state at an angle between two that have one."""


def angles_of(scene: Scene, plan: IdentifyPlan) -> list[float]:
    """Free contact angles [degree] with the stated loss of preload.

    There may be several: a steep bearing loses little by geometry, a flat one is stiff enough. Two
    closer to each other than the steps of the search are missed.
    """

    def miss(angle: float) -> float:
        turned = replace(scene, bearing=replace(scene.bearing, contact_angle_deg=angle))
        return preload_loss(turned, plan.statements) - plan.statements.preload_loss

    def solved_miss(angle: float) -> float:
        found = miss(angle)
        if np.isnan(found):
            raise _NotSolved
        return found

    angles = plan.contact_angle_deg
    misses = [miss(angle) for angle in angles]
    found = []
    for (low, at_low), (high, at_high) in itertools.pairwise(zip(angles, misses, strict=True)):
        if at_low == 0.0:
            found.append(float(low))
        elif at_low * at_high < 0.0:  # not where one of them is NaN
            with contextlib.suppress(_NotSolved):
                found.append(float(brentq(solved_miss, low, high, xtol=1e-6)))
    return found


def spins_outside(scene: Scene, stated: Statements) -> int:
    """Whether the new balls spin mainly on the outer race and slip more at low friction."""
    share = []
    for mu in (stated.high_friction, stated.low_friction):
        problem = ThrustProblem.of(running(scene, "fixed_position", mu))
        case = problem.solve(problem.g.D0)
        if case.status != OK:
            return STATE_NOT_SOLVED
        if mu == stated.high_friction and case.branch != OUTER_SPIN:
            return SPINS_INSIDE
        share.append(
            solver_of(running(scene, "fixed_position", mu)).at(0.0)["gyroscopic_slip_share"].max()
        )
    return FITS if share[1] > share[0] else NO_SLIP


def qv_fits(scene: Scene, drag: float, stated: Statements) -> tuple[bool, float]:
    """Whether QV at low friction falls and rises with wear as stated; and the largest skid ratio.

    Fixed position. Where a state was not solved, it does not.
    """
    solve = solver_of(running(scene, "fixed_position", stated.low_friction, drag)).at
    states = [solve(loss * parameters.UM) for loss in QV_LOSSES_UM]
    if any(state.status != OK for state in states):
        return False, np.nan
    qv = np.array([state["total_qv"] for state in states])
    least = int(np.argmin(qv))
    low, high = stated.qv_least_um
    later = float(np.interp(stated.qv_rise_at_um, QV_LOSSES_UM, qv))
    fits = low <= QV_LOSSES_UM[least] <= high and later >= (1.0 + stated.qv_rise) * qv[least]
    return fits, max(abs(state["skid_ratio"]) for state in states)


def member(scene: Scene, plan: IdentifyPlan) -> dict[str, Any]:
    """What is found of one bearing that loses the stated preload."""
    stated = plan.statements
    row: dict[str, Any] = {"fit_result": spins_outside(scene, stated)}
    if row["fit_result"] != FITS:
        return row
    fitting = []
    for drag in plan.drag_density_kg_m3:
        fits, skid = qv_fits(scene, drag, stated)
        fitting += [(drag, skid)] if fits else []
    if not fitting:
        return row | {"fit_result": NO_DRAG}
    row |= {"drag_low": fitting[0][0], "drag_high": fitting[-1][0]}
    row["skid_ratio"] = max(skid for _, skid in fitting)
    lives = []
    for method in PRELOAD_METHODS:
        given = running(scene, method, stated.high_friction, scene.lubricant.drag_density_kg_m3)
        life = HertzianLives(given)(given)
        lives.append(life.last.time if life.status == OK else np.full(2, np.nan))
    return row | {"life": lives}


def candidates(base: Scene, plan: IdentifyPlan) -> list[dict[str, Any]]:
    """Every bearing of the grid with every contact angle that gives the stated loss."""
    rows = []
    D0 = base.bearing.ball_diameter_mm
    grid = itertools.product(plan.pitch_diameter_mm, plan.ball_count, plan.inner_groove_factor)
    for dm, count, f_i in grid:
        of = {"pitch_diameter": dm, "ball_count": count, "inner_groove_factor": f_i}
        if count > most_balls(D0, dm):
            rows.append(of | {"fit_result": NO_ROOM})
            continue
        bearing = replace(
            base.bearing, pitch_diameter_mm=dm, ball_count=count, inner_groove_factor=f_i
        )
        # the cage would have to fit the pitch circle; steady states do not need it
        scene = replace(base, bearing=bearing, cage=None)
        angles = angles_of(scene, plan)
        if not angles:
            rows.append(of | {"fit_result": NO_ANGLE})
        for angle in angles:
            turned = replace(scene, bearing=replace(bearing, contact_angle_deg=angle))
            rows.append(of | {"contact_angle": angle} | member(turned, plan))
    return rows


def identified(scene: Path, marks: Sequence[Path], plan: Mapping[str, Any]) -> xr.Dataset:
    """Step: every candidate of an `IdentifyPlan`: whether it fits, its drags, its lives."""
    checked = record(IdentifyPlan, plan, "config/identify.yaml")
    base = load_scene(scene)
    rows = candidates(base, checked)
    bearings = [load_scene(path).bearing for path in marks]
    marked = [
        {f"{MARK}{key}": float(getattr(bearing, key)) for key in MARKED_KEYS}
        for bearing in bearings
    ]
    return filled(
        CANDIDATE,
        {
            "candidate": len(rows),
            STUDY_COORDINATES["preload_method"]: None,
            LOSS_BASIS: None,
        },
        rows,
        title="Bearings that match the statements",
        kind=CANDIDATES,
        scene=base,
        marks=" ".join(checked.marks),
        statements=json.dumps(asdict(checked.statements)),
        comment="A fit to a text is not a validation.",
    ).merge(filled(MARKED, {"mark": len(marked)}, marked), combine_attrs="override")
