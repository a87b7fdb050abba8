"""Find the bearings that match what the paper states, of which gyro_s1 to gyro_s3 are three.

`python benchmarks/paper_bearings.py` tries a grid of bearings (15 s) and prints those that match,
with their lives. Theory: docs/theory/16-paper-bearings.md. A fit to a text is not a validation.
"""

from __future__ import annotations

import contextlib
import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels.status import OK
from bearingwear.kernels.steady.thrust import OUTER_SPIN
from bearingwear.lives.many import HertzianLives
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, most_balls
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.compose import solver_of

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"

PITCH_DIAMETERS = [6.5 + 0.5 * k for k in range(8)]  # mm
BALL_COUNTS = [7, 8, 9, 10, 11]
INNER_GROOVE_FACTORS = [round(0.52 + 0.01 * k, 2) for k in range(7)]
CONTACT_ANGLES = [*map(float, range(10, 31))]  # degree, between which the angle is sought
DRAG_DENSITIES = [*map(float, range(50, 601, 50))]  # kg/m3

# what the text states, of fixed-position preload
PRELOAD_LOSS, PRELOAD_LOSS_AT_UM = 0.6033, 0.5  # share of the initial preload
HIGH_FRICTION, LOW_FRICTION = 0.08, 0.02
QV_LEAST_UM = 0.3, 0.5  # low friction: QV falls "until about 0.4 um"
QV_RISE, QV_RISE_AT_UM = 0.05, 0.6  # and then "rises clearly"
QV_LOSSES_UM = [round(0.1 * k, 1) for k in range(8)]  # as the paper draws its QV


class Candidate(NamedTuple):
    """A bearing of the grid, and the first statement that it fails; none of one that matches."""

    scene: Scene
    failed: str = ""
    drags: tuple[float, ...] = ()  # densities at which QV varies with wear as stated [kg/m3]
    lives_h: tuple[float, ...] = ()  # at high friction, by `PRELOAD_METHODS`


def with_friction(scene: Scene, method: str, mu: float, drag: float = 0.0) -> Scene:
    return replace(
        scene,
        operation=replace(scene.operation, preload_method=method),
        friction=replace(scene.friction, ball_race=mu),
        lubricant=replace(scene.lubricant, drag_density_kg_m3=drag),
    )


def preload_loss(scene: Scene) -> float:
    """Share of the initial preload that the stated wear takes; NaN if there is no steady state."""
    held = with_friction(scene, "fixed_position", HIGH_FRICTION)
    state = solver_of(held).at(PRELOAD_LOSS_AT_UM * parameters.UM)
    left = state["residual_preload"] if state.status == OK else np.nan
    return 1.0 - left / scene.operation.preload_N


def with_angle(scene: Scene, degrees: float) -> Scene:
    return replace(scene, bearing=replace(scene.bearing, contact_angle_deg=degrees))


def angles_with_loss(scene: Scene, angles: Sequence[float] = CONTACT_ANGLES) -> list[float]:
    """Free contact angles with the stated loss of preload [degree].

    There may be several: a steep bearing loses little by geometry, a flat one is stiff enough. Two
    within the same step of the search are missed, and so is one beside an angle without a state.
    """

    def miss(angle: float) -> float:
        return preload_loss(with_angle(scene, angle)) - PRELOAD_LOSS

    found = []
    tried = [(angle, miss(angle)) for angle in angles]
    for (low, at_low), (high, at_high) in itertools.pairwise(tried):
        if at_low * at_high <= 0.0:  # not where one of them is NaN
            with contextlib.suppress(ValueError):  # which brentq raises where it meets a NaN
                found.append(float(brentq(miss, low, high, xtol=1e-6)))
    return found


def slip_failure(scene: Scene) -> str:
    """Why a new bearing does not spin on the outer race with more slip at low friction, or ""."""
    shares = []
    for mu in (HIGH_FRICTION, LOW_FRICTION):
        held = with_friction(scene, "fixed_position", mu)
        problem = ThrustProblem.of(held)
        case = problem.solve(problem.g.D0)
        if case.status != OK:
            return "no steady state"
        if mu == HIGH_FRICTION and case.branch != OUTER_SPIN:
            return "spins on the inner race"
        shares.append(solver_of(held).at(0.0)["gyroscopic_slip_share"].max())
    return "" if shares[1] > shares[0] else "no more gyroscopic slip at low friction"


def qv_matches(scene: Scene, drag: float) -> bool:
    """Whether QV at low friction falls and rises with wear as stated."""
    solve = solver_of(with_friction(scene, "fixed_position", LOW_FRICTION, drag)).at
    states = [solve(loss * parameters.UM) for loss in QV_LOSSES_UM]
    if any(state.status != OK for state in states):
        return False
    qv = np.array([state["total_qv"] for state in states])
    least = int(np.argmin(qv))
    later = float(np.interp(QV_RISE_AT_UM, QV_LOSSES_UM, qv))
    low, high = QV_LEAST_UM
    return low <= QV_LOSSES_UM[least] <= high and later >= (1.0 + QV_RISE) * qv[least]


def candidate(scene: Scene) -> Candidate:
    """A bearing that loses the stated preload, tried by the other statements."""
    if failed := slip_failure(scene):
        return Candidate(scene, failed)
    drags = tuple(drag for drag in DRAG_DENSITIES if qv_matches(scene, drag))
    if not drags:
        return Candidate(scene, "no drag gives the course of QV")
    lives = []
    for method in PRELOAD_METHODS:
        given = with_friction(scene, method, HIGH_FRICTION, scene.lubricant.drag_density_kg_m3)
        life = HertzianLives(given)(given)
        seconds = life.last.time if life.status == OK else np.nan
        lives.append(float(seconds) / 3600.0)
    return Candidate(scene, "", drags, tuple(lives))


def candidates(base: Scene) -> Iterator[Candidate]:
    """Every bearing of the grid with every contact angle that gives the stated loss."""
    for dm, count, f_i in itertools.product(PITCH_DIAMETERS, BALL_COUNTS, INNER_GROOVE_FACTORS):
        bearing = replace(
            base.bearing, pitch_diameter_mm=dm, ball_count=count, inner_groove_factor=f_i
        )
        if count > most_balls(bearing.ball_diameter_mm, dm):
            continue
        # the cage would have to fit the pitch circle; steady states do not need it
        scene = replace(base, bearing=bearing, cage=None)
        yield from (candidate(with_angle(scene, angle)) for angle in angles_with_loss(scene))


def main() -> None:
    ends: Counter[str] = Counter()
    print("pitch mm  balls  f_i   angle deg  drag kg/m3   life h,", ", ".join(PRELOAD_METHODS))
    for one in candidates(load_scene(SCENE)):
        ends[one.failed or "match all statements"] += 1
        if not one.failed:
            b = one.scene.bearing
            lives = "  ".join(f"{hours:.3g}" for hours in one.lives_h)
            print(
                f"{b.pitch_diameter_mm:8.1f} {b.ball_count:6d}  {b.inner_groove_factor:.2f}"
                f" {b.contact_angle_deg:10.2f}  {one.drags[0]:.0f} to {one.drags[-1]:.0f}   {lives}"
            )
    print("; ".join(f"{count} {failed}" for failed, count in ends.items()))


if __name__ == "__main__":
    main()
