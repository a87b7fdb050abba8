"""States of a worn bearing at a loss of ball diameter, as a life asks for them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.summary import ANGLE, FRICTION, LOAD, MAJOR, PRESSURE, QV, SHARE, TRACK
from bearingwear.kernels.thrust import ThrustCase
from bearingwear.model import parameters
from bearingwear.model.fidelity import NotAvailable
from bearingwear.model.films import COVERED, Bare
from bearingwear.model.heat import SteadyHeat, heat_of_case, race_control_heat, warmth_of
from bearingwear.model.life_integrator import (
    WearState,
)
from bearingwear.model.outputs import friction_used, loss_per_wear, wear_values
from bearingwear.model.race_control import RaceControlProblem, solve_race_control
from bearingwear.model.steady import ThrustProblem, axial_force
from bearingwear.model.thermal import HeatFlow, Warmed, warmed
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import Scene


class StateAtLoss(Protocol):
    """Function from a loss of ball diameter [m] to the state, in some contacts without film."""

    def __call__(self, loss: float, bare: Bare = COVERED) -> WearState: ...


def steady_states(scene: Scene, problem: ThrustProblem | None = None) -> StateAtLoss:
    """Function from loss to state on the steady model, each solve started from the nearest one.

    `problem`, if given, takes the place of the scene's own (other settings of accuracy).
    """
    if scene.pair is not None:
        if not scene.pair.is_symmetric:
            raise NotAvailable(
                f"{scene.name}: got two bearings that differ, expected one, or two identical ones"
            )
        scene = scene.sides[0]
    covered = (problem or ThrustProblem.of(scene)).without_finer
    mounted = parameters.static_place(scene)
    solved: dict[tuple[float, Bare], tuple[np.ndarray, Warmed | None]] = {}

    def state(loss: float, bare: Bare = COVERED) -> WearState:
        like = covered.where_bare(scene, bare) if any(bare) else covered
        if like.undetermined() != code.OK:
            return WearState(loss, like.undetermined())
        near = min(solved, key=lambda x: (x[1] != bare, abs(x[0] - loss)), default=None)
        u, found = (None, None) if near is None else solved[near]
        problem, warmth = like, dict[str, Any]()
        if scene.thermal is None:
            case = like.solve(like.g.D0 - loss, u)
        else:
            solver = SteadyHeat(loss, like, u)
            found = warmed(scene, solver, found)
            if found.status != code.OK:
                return WearState(loss, found.status)
            problem, case = solver.problem, solver.case
            warmth = warmth_of(scene, found)
        if case.status == code.OK:
            solved[loss, bare] = case.u, found
        made = steady_wear_state(scene, problem, loss, case)
        return in_half_of_pair(scene, mounted, made, **warmth)

    return state


def steady_wear_state(
    scene: Scene, problem: ThrustProblem, loss: float, case: ThrustCase
) -> WearState:
    """Values of a steady state that a life needs, at a loss of ball diameter [m]."""
    if case.status != code.OK:
        return WearState(loss, case.status)
    g, c = problem.g, case.contacts
    D = np.array([g.D0 - loss])
    worn_by = c[None, :, QV], c[None, :, MAJOR], c[None, :, TRACK]
    films = changes_as_it_wears(scene)
    wear = wear_values(scene, D, *worn_by)
    gyroscopic = ball_inertia(ball_mass(g.rho, D), D) * abs(case.u[3] * case.u[2])
    return WearState(
        loss=loss,
        status=case.status,
        rate=wear["ball_diameter_loss_rate"],
        preload=axial_force(case, g.n_balls),
        load=c[:, LOAD],
        angle=c[:, ANGLE],
        major=c[:, MAJOR],
        qv=c[:, QV],
        total_qv=float(g.n_balls * c[:, QV].sum()),
        share=c[:, SHARE],
        skid=case.skid,
        pressure=float(c[:, PRESSURE].max()),
        stiffness=float(g.n_balls * case.S_xx),
        quasistatic=float(g.n_balls * case.S_quasistatic),
        friction_power=heat_of_case(problem, D[0], case).total,
        ball_rate=float(wear["ball_wear_rate"][0]),
        race_rate=wear["race_wear_rate"],
        place=case.delta_a,
        friction_used=float(
            friction_used(c[None, :, FRICTION], D, gyroscopic, c[None, :, LOAD])[0]
        ),
        friction=c[:, FRICTION],
        **({"per_wear": loss_per_wear(g.n_balls, D, *worn_by)} if films else {}),
    )


def in_half_of_pair(scene: Scene, mounted: float, state: WearState, **more: Any) -> WearState:
    """A state with its values in a symmetric pair, of which the bearing is one half, and `more`.

    At a fixed position both bearings hold the rotor, and it stays where it is. A spring has
    no stiffness here, and the rotor goes where the bearing lets it from the axial displacement
    `mounted` [m].
    """
    method = scene.operation.preload_method
    holding = bearings_holding(method)
    return replace(
        state,
        system_stiffness=holding * state.stiffness,
        system_quasistatic=holding * state.quasistatic,
        shift=0.0 if method == "fixed_position" else state.place - mounted,
        **more,
    )


def race_control_states(scene: Scene) -> StateAtLoss:
    """Function from loss to state on the race-control model, every ball losing the same."""
    fresh = np.array(scene.wear.ball_diameter_loss_um)
    first = fresh[0] * parameters.UM
    known: dict[tuple[float, Bare], Warmed] = {}
    mounted = parameters.static_place(scene)

    def state(loss: float, bare: Bare = COVERED) -> WearState:
        worn = tuple(fresh + (loss - first) / parameters.UM)
        now = replace(scene, wear=replace(scene.wear, ball_diameter_loss_um=worn))
        warmth: dict[str, Any] = {}
        if scene.thermal is not None:
            near = min(known, key=lambda x: (x[1] != bare, abs(x[0] - loss)), default=None)

            def heat(warm: Scene) -> tuple[int, HeatFlow]:
                problem = RaceControlProblem.of(warm).where_bare(warm, bare)
                return race_control_heat(warm, problem)

            found = warmed(now, heat, None if near is None else known[near])
            if found.status != code.OK:
                return WearState(loss, found.status)
            known[loss, bare] = found
            now, warmth = found.scene, warmth_of(scene, found)
        problem = RaceControlProblem.of(now).where_bare(now, bare)
        values, _ = solve_race_control(now, problem)
        made = race_control_wear_state(loss, problem, values)
        return in_half_of_pair(scene, mounted, made, **warmth)

    return state


def race_control_wear_state(
    loss: float, problem: RaceControlProblem, values: Mapping[str, Any]
) -> WearState:
    """Values of a race-control solution that a life needs, at a loss of ball diameter [m]."""
    if values["status"] != code.OK:
        return WearState(loss, values["status"])
    op = problem.op
    return WearState(
        loss=loss,
        status=values["status"],
        rate=values["ball_diameter_loss_rate"],
        preload=float(values["residual_preload"]),
        load=values["contact_load"].mean(axis=0),
        angle=values["contact_angle"].mean(axis=0),
        major=values["semi_major_axis"].mean(axis=0),
        qv=values["qv"].mean(axis=0),
        total_qv=float(values["total_qv"]),
        share=np.full(2, np.nan),  # race control knows neither
        skid=np.nan,
        pressure=float(values["maximum_pressure"].max()),
        stiffness=float(values["axial_stiffness"]),
        quasistatic=float(values["quasistatic_axial_stiffness"]),
        friction_power=float(values["shaft_torque"]) * abs(op.omega_i - op.omega_o),
        ball_rate=float(values["ball_wear_rate"].mean()),
        race_rate=values["race_wear_rate"],
        place=float(values["axial_displacement"]),
        friction_used=float(np.max(values.get("friction_used_by_gyroscopic_moment", np.inf))),
        friction=np.mean(values.get("friction_coefficient", (np.nan, np.nan)), axis=0),
        per_wear=loss_per_wear(
            problem.g.n_balls,
            problem.D,
            *(values[name] for name in ("qv", "semi_major_axis", "contact_track_radius")),
        ),
    )
