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
from bearingwear.model.fidelity import NEEDS_SLIP, NotAvailable
from bearingwear.model.films import COVERED, Bare
from bearingwear.model.heat import SteadyHeat, heat_of_case, race_control_heat, warmth_of
from bearingwear.model.outputs import friction_used, loss_per_wear, wear_values
from bearingwear.model.race_control import RaceControlProblem, solve_race_control
from bearingwear.model.state import State, case_state
from bearingwear.model.steady import ThrustProblem, axial_force
from bearingwear.model.thermal import HeatFlow, Warmed, warmed
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import Scene
from bearingwear.sides import OF_ARRANGEMENT


class StateAtLoss(Protocol):
    """Function from a loss of ball diameter [m] to the state, in some contacts without film."""

    def __call__(self, loss: float, bare: Bare = COVERED) -> State: ...


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

    def state(loss: float, bare: Bare = COVERED) -> State:
        like = covered.where_bare(scene, bare) if any(bare) else covered
        if like.undetermined() != code.OK:
            return State.unsolved(like.undetermined(), loss)
        near = min(solved, key=lambda x: (x[1] != bare, abs(x[0] - loss)), default=None)
        u, found = (None, None) if near is None else solved[near]
        problem, warmth = like, dict[str, Any]()
        if scene.thermal is None:
            case = like.solve(like.g.D0 - loss, u)
        else:
            solver = SteadyHeat(loss, like, u)
            found = warmed(scene, solver, found)
            if found.status != code.OK:
                return State.unsolved(found.status, loss)
            problem, case = solver.problem, solver.case
            warmth = warmth_of(scene, found)
        if case.status == code.OK:
            solved[loss, bare] = case.u, found
        made = thrust_state(scene, problem, loss, case)
        return in_half_of_pair(scene, mounted, made, **warmth)

    return state


def thrust_state(scene: Scene, problem: ThrustProblem, loss: float, case: ThrustCase) -> State:
    """Values of a steady state that a life needs, at a loss of ball diameter [m]."""
    if case.status != code.OK:
        return State.unsolved(case.status, loss)
    g, c = problem.g, case.contacts
    D = np.array([g.D0 - loss])
    worn_by = c[None, :, QV], c[None, :, MAJOR], c[None, :, TRACK]
    wear = wear_values(scene, D, *worn_by)
    gyroscopic = ball_inertia(ball_mass(g.rho, D), D) * abs(case.u[3] * case.u[2])
    values = {
        "ball_diameter_loss": loss,
        "ball_diameter_loss_rate": wear["ball_diameter_loss_rate"],
        "residual_preload": axial_force(case, g.n_balls),
        "contact_load": c[:, LOAD],
        "contact_angle": c[:, ANGLE],
        "semi_major_axis": c[:, MAJOR],
        "qv": c[:, QV],
        "total_qv": float(g.n_balls * c[:, QV].sum()),
        "gyroscopic_slip_share": c[:, SHARE],
        "skid_ratio": case.skid,
        "maximum_pressure": float(c[:, PRESSURE].max()),
        "axial_stiffness": float(g.n_balls * case.S_xx),
        "quasistatic_axial_stiffness": float(g.n_balls * case.S_quasistatic),
        "friction_power": heat_of_case(problem, D[0], case).total,
        "ball_wear_rate": float(wear["ball_wear_rate"][0]),
        "race_wear_rate": wear["race_wear_rate"],
        "axial_displacement": case.delta_a,
        "friction_used_by_gyroscopic_moment": float(
            friction_used(c[None, :, FRICTION], D, gyroscopic, c[None, :, LOAD])[0]
        ),
        "friction_coefficient": c[:, FRICTION],
    }
    if changes_as_it_wears(scene):
        values["loss_per_wear"] = loss_per_wear(g.n_balls, D, *worn_by)
    return State(case.status, values)


def in_half_of_pair(scene: Scene, mounted: float, state: State, **more: Any) -> State:
    """A state with its values in a symmetric pair, of which the bearing is one half, and `more`.

    At a fixed position both bearings hold the rotor, and it stays where it is. A spring has
    no stiffness here, and the rotor goes where the bearing lets it from the axial displacement
    `mounted` [m].
    """
    if not state.is_solved:
        return state
    method = scene.operation.preload_method
    holding = bearings_holding(method)
    values = {
        system: holding * state[own]
        for system, own in OF_ARRANGEMENT.items()
        if own in state.values
    }
    place = state["axial_displacement"]
    values["rotor_axial_shift"] = 0.0 if method == "fixed_position" else place - mounted
    return state.with_values(values | more)


def race_control_states(scene: Scene) -> StateAtLoss:
    """Function from loss to state on the race-control model, every ball losing the same."""
    fresh = np.array(scene.wear.ball_diameter_loss_um)
    first = fresh[0] * parameters.UM
    known: dict[tuple[float, Bare], Warmed] = {}
    mounted = parameters.static_place(scene)

    def state(loss: float, bare: Bare = COVERED) -> State:
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
                return State.unsolved(found.status, loss)
            known[loss, bare] = found
            now, warmth = found.scene, warmth_of(scene, found)
        problem = RaceControlProblem.of(now).where_bare(now, bare)
        values, _ = solve_race_control(now, problem)
        made = race_control_state(loss, problem, values)
        return in_half_of_pair(scene, mounted, made, **warmth)

    return state


def race_control_state(
    loss: float, problem: RaceControlProblem, values: Mapping[str, Any]
) -> State:
    """A race-control solution as a life needs it, at a loss of ball diameter [m]."""
    known = {name: value for name, value in values.items() if name not in NEEDS_SLIP}
    state, op = case_state(loss, known), problem.op
    if not state.is_solved:
        return state
    worn_by = (values[name] for name in ("qv", "semi_major_axis", "contact_track_radius"))
    more = {
        "friction_power": float(values["shaft_torque"]) * abs(op.omega_i - op.omega_o),
        "loss_per_wear": loss_per_wear(problem.g.n_balls, problem.D, *worn_by),
    }
    return state.with_values(more)
