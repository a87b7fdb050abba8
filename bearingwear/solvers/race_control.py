"""Race control as a solver, with an estimate of its slip."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.contact.points import Rule, point_buffers
from bearingwear.kernels.contact.summary import ANGLE, COLUMNS, HEAT, LOAD, QV, contact_summary
from bearingwear.kernels.contact.verification import polygon_residual
from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL, race_control
from bearingwear.kernels.equilibrium.thrust_loaded import groove_distance
from bearingwear.kernels.steady.thrust import LARGEST_RESIDUAL, MOST_ROUNDING
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.at_rest import Mechanics
from bearingwear.solvers.bearing.films import COVERED, Bare, limits_depth
from bearingwear.solvers.bearing.outputs import (
    contact_values,
    depth_peak,
    loss_per_wear,
    stiffness_of_loads,
    wear_values,
)
from bearingwear.solvers.bearing.race_control_problem import (
    Balance,
    RaceControlProblem,
    controlled_balance,
    geometric_status,
    load_rounding,
)
from bearingwear.solvers.bearing.stiffness import race_control_matrix, radially_free
from bearingwear.solvers.condition import CaseValues, Condition, Place, SolvedBearing
from bearingwear.solvers.effects.choice import NEEDS_SLIP
from bearingwear.solvers.estimates import (
    DOUBLED,
    coulomb_regularisation,
    error_values,
    estimated_quantities,
    regularisation_error,
    relative_change,
    torque_loss,
)
from bearingwear.solvers.state import State, case_state
from bearingwear.solvers.thermal import HeatFlow

LARGEST_PRELOAD_ERROR = 1e-6  # share of a spring's force that may be left unbalanced


class RaceControl:
    """A bearing under race control."""

    unsteady = code.NO_RACE_CONTROL
    heat_error = 0.0

    def __init__(self, scene: Scene):
        self.scene = scene
        self.problem = RaceControlProblem.of(scene)
        self.mounted = self.problem.delta_a
        self.start = Condition(scene.wear.ball_diameter_loss_um[0] * parameters.UM)

    def at(self, scene: Scene) -> "RaceControl":
        """Returns the solver at other temperatures, those of a scene."""
        return RaceControl(scene)

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        """Returns the bearing without friction at a loss [m], with the mean ball.

        Omega: orbit rate [rad/s], if not that of outer race control at the free contact angle.
        """
        g, op = self.problem.g, self.problem.op
        if Omega is None:
            kinematics = race_control(
                OUTER_CONTROL, op.omega_i, op.omega_o, g.D0 / g.dm, g.alpha0, g.alpha0
            )
            Omega = float(kinematics.Omega)
        return Mechanics(g, float(self.problem.D.mean()) - (loss - self.start.loss), Omega)

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        """Returns the bearing solved; its answer is values and attributes. `near` is not used.

        Without a solution it has a status and this answer, and NaN for all numbers.
        """
        problem = self.problem_in(condition)
        values, attrs = solve_race_control(self.scene, problem)
        solution = SolvedBearing(values["status"], condition, self.scene, answer=(values, attrs))
        if "axial_stiffness" not in values:
            return solution
        return solution._replace(
            force=float(values["residual_preload"]),
            stiffness=float(values["axial_stiffness"]),
            quasistatic=float(values["quasistatic_axial_stiffness"]),
            place=float(values["axial_displacement"]),
            problem=problem,
        )

    def problem_in(self, condition: Condition) -> RaceControlProblem:
        """Returns the problem in a condition, in which every ball has the same loss."""
        problem, hold = self.problem, condition.hold
        if isinstance(hold, Place):
            problem = replace(problem, constant_force=False, delta_a=hold.delta_a)
        elif hold is not None:
            F = np.array([hold.F_x, *problem.F[1:]])
            problem = replace(problem, constant_force=True, F=F)
        problem = parameters.where_bare(problem, self.scene, condition.bare)
        return replace(problem, D=problem.D - (condition.loss - self.start.loss))

    def heat(self, solution: SolvedBearing) -> HeatFlow:
        """Returns the estimated heat of friction; race control has no drag."""
        values, _ = solution.answer
        return heat_of_values(self.scene, values)

    def state(self, solution: SolvedBearing) -> State:
        """Returns the state of a life, without `NEEDS_SLIP`: those require a balance of friction.

        A failure has its status and loss alone.
        """
        values, _ = solution.answer
        loss = solution.condition.loss
        without_slip = {name: value for name, value in values.items() if name not in NEEDS_SLIP}
        state = case_state(loss, without_slip)
        if not state.is_solved:
            return state
        problem, op = solution.problem, solution.problem.op
        values_of_life = {
            "friction_power": float(values["shaft_torque"]) * abs(op.omega_i - op.omega_o),
            "loss_per_wear": loss_per_wear(
                problem.g.n_balls,
                problem.D,
                values["qv"],
                values["semi_major_axis"],
                values["contact_track_radius"],
            ),
        }
        if limits_depth(self.scene):
            v1, v2 = values["gyroscopic_slip"], values["rolling_slip"]
            values_of_life["depth_peak"] = depth_peak(values, v1, v2)
        return state.with_values(values_of_life)

    def case(self, solution: SolvedBearing) -> CaseValues:
        """Returns copies of the values and attributes of a solution."""
        values, attrs = solution.answer
        return dict(values), dict(attrs)

    def with_motion_of_case(
        self, solution: SolvedBearing, values: dict[str, Any]
    ) -> SolvedBearing | None:
        """Returns None: race control has a single solution, so a case has its motion."""
        return None


def heat_of_values(scene: Scene, values: Mapping[str, Any]) -> HeatFlow:
    """Returns the heat of a case, from its result variables."""
    n = scene.bearing.ball_count
    inner, outer = (float(n * heat) for heat in np.mean(values["friction_heat"], axis=0))
    return HeatFlow(inner, outer, drag=float(values["drag_power"]))


def race_control_motion(scene: Scene, bare: Bare = COVERED) -> np.ndarray | None:
    """Returns (w_x, w_y, w_z, Omega) of each ball (n, 4) [rad/s]; None without a solution.

    bare: which contacts have no film left.
    """
    problem = parameters.where_bare(RaceControlProblem.of(scene), scene, bare)
    values, _ = solve_race_control(scene, problem)
    if "orbit_speed" not in values:
        return None
    return np.column_stack([values["ball_angular_velocity"], values["orbit_speed"]])


def contact_solution(
    problem: RaceControlProblem, balance: Balance, models: np.ndarray, rule: Rule
) -> tuple[np.ndarray, np.ndarray]:
    """Returns motions (n, 4) of the balls [rad/s] and rows of their contacts.

    The rows (n, 2, COLUMNS) are those of `kernels.contact.summary`.

    models: controlling race of each ball (n,), OUTER_CONTROL or INNER_CONTROL.
    """
    g, op, D = problem.g, problem.op, problem.D
    u, rows = np.empty((len(D), 4)), np.empty((len(D), 2, COLUMNS))
    buffers = point_buffers(rule)
    for j, state in enumerate(balance.states):
        kinematics = race_control(
            int(models[j]), op.omega_i, op.omega_o, D[j] / g.dm, state.alpha_i, state.alpha_o
        )
        u[j] = (
            kinematics.Omega - kinematics.w_R * math.cos(kinematics.beta),
            0.0,
            kinematics.w_R * math.sin(kinematics.beta),
            kinematics.Omega,
        )
        contact_summary(g, D[j], op, state, u[j], 0.5 * g.dm, rule, buffers, rows[j], False)
    return u, rows


def equilibrium_residual(problem: RaceControlProblem, balance: Balance) -> float:
    """Returns the largest unbalanced force on a ball or the race, over the largest load [1].

    The load is that of a contact. The force on the race is taken per ball, see
    `RaceControlProblem.unbalanced_force`.
    """
    g = problem.g
    residual = 0.0
    largest = max(max(state.Q_i, state.Q_o) for state in balance.states)
    for state, D, psi in zip(balance.states, problem.D, problem.psi, strict=True):
        A1, A2 = groove_distance(g, psi, *balance.delta, problem.tilt)
        residual = max(residual, polygon_residual(g, D, state, A1, A2, largest))
    if largest > 0.0:
        residual = max(residual, balance.race_residual / (g.n_balls * largest))
    return residual


def torque_of_heat(problem: RaceControlProblem, rows: np.ndarray) -> float:
    """Returns the torque that makes the estimated heat [N m]: race control has no power balance.

    rows: contacts (n, 2, COLUMNS) of `contact_solution`.
    """
    heat = problem.g.n_balls * rows[..., HEAT].sum() / len(rows)
    slip_speed = abs(problem.op.omega_i - problem.op.omega_o)
    return heat / slip_speed if slip_speed > 0.0 else 0.0


def controlled_error_estimates(
    scene: Scene,
    problem: RaceControlProblem,
    balance: Balance,
    models: np.ndarray,
    values: Mapping[str, Any],
) -> dict[str, Any]:
    """Returns result variables of numerical errors, by the points and by the regularisation.

    Neither moves a ball, so the balance is kept.

    models: controlling race of each ball (n,).
    values: result variables of the case.
    """
    D, n_balls = problem.D, problem.g.n_balls
    halved = replace(problem, op=problem.op._replace(v_r=0.5 * problem.op.v_r))
    settings = (
        (problem, parameters.quadrature(scene, refined=2)),
        (halved, parameters.quadrature(scene)),
    )
    answers = []
    for changed_problem, rule in settings:
        _, rows = contact_solution(changed_problem, balance, models, rule)
        qv = rows[..., QV]
        changed_values = {
            **values,
            **wear_values(scene, D, qv, values["semi_major_axis"], values["contact_track_radius"]),
            "total_qv": n_balls * qv.sum() / len(D),
            "friction_heat": rows[..., HEAT],
            "shaft_torque": torque_of_heat(changed_problem, rows),
        }
        answers.append(estimated_quantities(changed_values, n_balls))
    as_solved = estimated_quantities(values, n_balls)
    with_twice_points, with_half_slip = answers
    return error_values(
        [
            DOUBLED * relative_change(as_solved, with_twice_points),
            regularisation_error(as_solved, with_half_slip),
        ]
    )


def controlled_torque_loss(
    scene: Scene,
    problem: RaceControlProblem,
    balance: Balance,
    models: np.ndarray,
    rows: np.ndarray,
) -> dict[str, Any]:
    """Returns the result variable of the torque that the regularisation takes; empty if small.

    models, rows: controlling race of each ball (n,), and contacts of `contact_solution`.
    """
    v_r = coulomb_regularisation(problem.op.v_r, rows[..., QV].sum(), rows[..., LOAD].sum())
    if v_r is None:
        return {}
    finer = replace(problem, op=problem.op._replace(v_r=v_r))
    _, finer_rows = contact_solution(finer, balance, models, parameters.quadrature(scene))
    return torque_loss(torque_of_heat(problem, rows), torque_of_heat(finer, finer_rows))


def solve_race_control(scene: Scene, problem: RaceControlProblem) -> CaseValues:
    """Returns values and attributes of the solution of a problem.

    The problem may hold the bearing in another way than the scene, as on a rotor. With the statuses
    PRELOAD_GONE, NOT_CONVERGED, BEYOND_GROOVE and OUTSIDE_HERTZ_RANGE, the values are status, loss
    of diameter and initial displacement alone. Other failures keep all values.
    """
    g, D = problem.g, problem.D
    values: dict = {
        "status": code.OK,
        "ball_diameter_loss": g.D0 - D,
        "initial_axial_displacement": parameters.static_place(scene),
    }
    if problem.constant_force and not problem.F.any():
        return values | {"status": code.PRELOAD_GONE}, {"residual": "not solved"}
    balance, models = controlled_balance(problem)
    values["status"] = balance.status
    if balance.status == code.OK:
        values["status"] = geometric_status(balance.states, D)
    if values["status"] in (code.NOT_CONVERGED, code.BEYOND_GROOVE, code.OUTSIDE_HERTZ_RANGE):
        return values, {"residual": "not solved"}

    u, rows = contact_solution(problem, balance, models, parameters.quadrature(scene))
    residual = equilibrium_residual(problem, balance)
    rounding = max(load_rounding(g, state) for state in balance.states)
    allowed = max(LARGEST_RESIDUAL, min(rounding, MOST_ROUNDING))
    if values["status"] == code.OK:
        values["status"] = _verified_status(problem, balance, residual <= allowed)
    values |= _solution_values(scene, problem, balance, models, u, rows)
    values |= {"equilibrium_residual": residual, "equilibrium_rounding": rounding}
    values |= controlled_error_estimates(scene, problem, balance, models, values)
    values |= controlled_torque_loss(scene, problem, balance, models, rows)
    return values, {
        "residual": f"error in the normal force balance: {residual:.1e} of the contact load "
        f"(allowed: {allowed:.0e})"
    }


def _solution_values(
    scene: Scene,
    problem: RaceControlProblem,
    balance: Balance,
    models: np.ndarray,
    u: np.ndarray,
    rows: np.ndarray,
) -> dict[str, Any]:
    """Returns the result variables of a solution, without those that judge its accuracy.

    models: controlling race of each ball (n,).
    u, rows: motions and contacts of the balls, as in `contact_solution`.
    """
    g, D = problem.g, problem.D
    axial = np.array([state.F_ix for state in balance.states])
    orbit_radius = np.full(len(D), 0.5 * g.dm)
    values = contact_values(scene, g, problem.op, D, u, orbit_radius, rows, axial)
    K = race_control_matrix(
        g, D, map(problem.load, models), balance.states, balance.delta, problem.tilt
    )
    return values | {
        "axial_displacement": balance.delta[0],
        "axial_stiffness": balance.stiffness,
        "stiffness_matrix": stiffness_of_loads(g, D, rows[..., LOAD], rows[..., ANGLE]),
        "quasistatic_axial_stiffness": radially_free(K),
        "quasistatic_stiffness_matrix": K,
        "shaft_torque": torque_of_heat(problem, rows),
        "drag_power": 0.0,
        "centrifugal_force": ball_mass(g.rho, D) * 0.5 * g.dm * u[:, 3] ** 2,
        "race_control": models - OUTER_CONTROL,  # 0 for the outer race, 1 for the inner one
    }


def _verified_status(problem: RaceControlProblem, balance: Balance, is_balanced: bool) -> int:
    """Returns the status of a solution: UNVERIFIED, BELOW_ROUNDING or OK.

    is_balanced: whether the residual of the equilibrium is small enough.
    """
    if not is_balanced:
        return code.UNVERIFIED
    if problem.constant_force:
        # the rounding of loads a million times as large hides a spring's force; without a force of
        # the spring, the other loads count
        force = problem.F[0] or float(np.linalg.norm(problem.F))
        if not balance.race_residual <= LARGEST_PRELOAD_ERROR * force:
            return code.BELOW_ROUNDING
    return code.OK
