"""The friction-balanced steady state of a thrust-loaded bearing."""

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass, drag_force
from bearingwear.kernels.contact import summary
from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL
from bearingwear.kernels.steady.thrust import LARGEST_RESIDUAL, ThrustCase
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.at_rest import Mechanics
from bearingwear.solvers.bearing.films import Films, follows_depths, limits_depth
from bearingwear.solvers.bearing.outputs import (
    TURN,
    contact_values,
    depth_peak,
    diameter_loss_rate,
    friction_used,
    loss_per_wear,
    slips_across,
    stiffness_of_loads,
    unworn_factors,
)
from bearingwear.solvers.bearing.stiffness import quasistatic_matrix
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem, time_scale_values
from bearingwear.solvers.condition import (
    USABLE,
    Accuracy,
    CaseValues,
    Condition,
    Place,
    SolvedBearing,
)
from bearingwear.solvers.estimates import (
    DOUBLED,
    coulomb_regularisation,
    error_values,
    regularisation_error,
    relative_change,
    torque_loss,
)
from bearingwear.solvers.state import State
from bearingwear.solvers.thermal import HeatFlow

SAME_MOTION = 1e-12  # relative difference of two motions that counts as rounding


class Steady:
    """A bearing under thrust in its friction-balanced steady state."""

    unsteady = code.NO_STEADY_STATE
    heat_error: float = 0.0

    def __init__(self, scene: Scene, accuracy: Accuracy = Accuracy.BRIEF):
        self.scene = scene
        self.problem = ThrustProblem.of(scene)
        self.mounted = self.problem.preload.delta_a
        self.films = Films.of(scene)
        self.limits_depth, self.follows_depths = limits_depth(scene), follows_depths(scene)
        self.start = Condition(scene.wear.ball_diameter_loss_um[0] * parameters.UM)
        if accuracy is Accuracy.BRIEF:
            self.problem = self.problem.without_finer
        elif accuracy is not Accuracy.CHECKED:
            halved, twice = self.problem.perturbed(scene)
            self.problem = halved if accuracy is Accuracy.HALF_SLIP else twice

    def at(self, scene: Scene) -> "Steady":
        """Returns the solver at other temperatures, those of a scene."""
        warm = copy.copy(self)
        warm.scene = scene
        warm.problem = replace(self.problem, g=parameters.geometry(scene))
        return warm

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        """Returns the bearing without friction at a loss [m].

        Omega: orbit rate [rad/s], if not that of outer race control at the free contact angle.
        """
        if Omega is None:
            *_, rolling_rate = self.problem.kinematic_start(OUTER_CONTROL)
            Omega = float(rolling_rate)
        return Mechanics(self.problem.g, self.problem.g.D0 - loss, Omega)

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        """Returns the bearing solved, from the motion of a solution nearby if there is one.

        Without friction or force there is nothing to solve: a status, and NaN for all numbers.
        """
        problem = self.problem_in(condition)
        status = problem.undetermined()
        if status != code.OK:
            return SolvedBearing(status, condition, self.scene, problem=problem)
        start = None if near is None else near.answer.motion
        case = problem.solve(problem.g.D0 - condition.loss, start)
        n = problem.g.n_balls
        return SolvedBearing(
            status=case.status,
            condition=condition,
            scene=self.scene,
            force=axial_force(case, n),
            stiffness=float(n * case.S_xx),
            quasistatic=float(n * case.S_quasistatic),
            place=case.delta_a,
            problem=problem,
            answer=case,
        )

    def problem_in(self, condition: Condition) -> ThrustProblem:
        """Returns the problem in a condition."""
        problem, hold = self.problem, condition.hold
        if isinstance(hold, Place):
            preload = problem.preload._replace(constant_force=False, delta_a=hold.delta_a)
            problem = replace(problem, preload=preload)
        elif hold is not None:
            preload = problem.preload._replace(constant_force=True, F_x=hold.F_x)
            problem = replace(problem, preload=preload)
        return parameters.where_bare(problem, self.scene, condition.bare)

    def heat(self, solution: SolvedBearing) -> HeatFlow:
        """Returns the heat of friction and drag of all balls in a solution."""
        problem, case, loss = solution.problem, solution.answer, solution.condition.loss
        inner, outer = case.contacts[:, summary.HEAT].tolist()
        n = problem.g.n_balls
        drag = float(drag_power(problem, problem.g.D0 - loss, case))
        return HeatFlow(n * inner, n * outer, drag=drag)

    def state(self, solution: SolvedBearing) -> State:
        """Returns the state of a life, with the wear rates of new surfaces.

        A failure or an unverified solution has its status and loss alone.
        """
        loss, problem, case = solution.condition.loss, solution.problem, solution.answer
        if solution.status != code.OK:
            return State.unsolved(solution.status, loss)
        g, contacts = problem.g, case.contacts
        D, qv = float(g.D0 - loss), contacts[:, summary.QV].tolist()
        rates = rates_when_new(solution.scene, self.films, D, contacts)
        gyroscopic = ball_inertia(ball_mass(g.rho, D), D) * abs(float(case.u[3] * case.u[2]))
        used_share = friction_used(
            contacts[:, summary.FRICTION], D, gyroscopic, contacts[:, summary.LOAD]
        )
        values = {
            "ball_diameter_loss": loss,
            "ball_diameter_loss_rate": rates.diameter_loss,
            "residual_preload": solution.force,
            "contact_load": contacts[:, summary.LOAD],
            "contact_angle": contacts[:, summary.ANGLE],
            "semi_major_axis": contacts[:, summary.MAJOR],
            "qv": contacts[:, summary.QV],
            "total_qv": g.n_balls * sum(qv),
            "gyroscopic_slip_share": contacts[:, summary.SHARE],
            "skid_ratio": case.skid,
            "maximum_pressure": max(contacts[:, summary.PRESSURE].tolist()),
            "axial_stiffness": solution.stiffness,
            "quasistatic_axial_stiffness": solution.quasistatic,
            "friction_power": self.heat(solution).total,
            "ball_wear_rate": sum(rates.ball),
            "race_wear_rate": g.n_balls * np.array(rates.race),
            "axial_displacement": solution.place,
            "friction_used_by_gyroscopic_moment": float(used_share),
            "friction_coefficient": contacts[:, summary.FRICTION],
        }
        if self.limits_depth:
            v1, v2 = slips_across(
                self.scene,
                g,
                problem.op,
                np.array([D]),
                case.u[None],
                np.array([case.r]),
                contacts[None],
            )
            values["depth_peak"] = depth_peak(values, v1, v2)
        if self.follows_depths:
            values["loss_per_wear"] = loss_per_wear(
                g.n_balls,
                np.array([D]),
                contacts[None, :, summary.QV],
                contacts[None, :, summary.MAJOR],
                contacts[None, :, summary.TRACK],
            )
        return State(solution.status, values, solution)

    def case(self, solution: SolvedBearing) -> CaseValues:
        """Returns values and attributes of a solution, or of a stable state beside it.

        Other states are searched for by `ThrustProblem.other_states`. If none is stable, the status
        is NO_STEADY_STATE, and the values are those of the solution. One that is not usable has its
        status, loss and initial displacement alone.
        """
        scene, problem, case = self.scene, solution.problem, solution.answer
        D = problem.g.D0 - solution.condition.loss
        values: dict = {
            "status": solution.status,
            "ball_diameter_loss": np.array([problem.g.D0 - D]),
            "initial_axial_displacement": self.mounted,
        }
        if case is None:
            return values, {"residual": "not solved"}
        attrs: dict = {"iterations": case.iterations, "residual": "not solved"}
        if case.status not in USABLE:
            return values, attrs
        decay_rates = problem.decay_rates(D, case)
        states = _stable_first(scene, problem, D, case, decay_rates)
        if states[0].case is not case:
            case = states[0].case
            decay_rates = problem.decay_rates(D, case)
        attrs["residual"] = residual_sentence(case)
        values |= error_estimates(scene, problem, D, case)
        values |= steady_torque_loss(problem, D, case)
        if case.held:
            attrs["quadrature"] = (
                "gauss (fixed points), because no solution was found with the split rule"
            )
        values |= {"status": case.status} | steady_values(scene, problem, D, case)
        values |= time_scale_values(decay_rates) | {
            "stiffness_transition_frequency": np.abs(decay_rates.real).min() / TURN,
        }
        values |= _state_values(problem, states)
        if not states[0].is_stable and case.status == code.OK:
            values["status"] = code.NO_STEADY_STATE
        return values, attrs

    def with_motion_of_case(
        self, solution: SolvedBearing, values: dict[str, Any]
    ) -> SolvedBearing | None:
        """Returns the solution with the motion in result variables of a case, None if it has that.

        values: result variables of the case.
        """
        if "orbit_speed" not in values:
            return None
        u = np.array([*values["ball_angular_velocity"][0], values["orbit_speed"][0]])
        if np.abs(u - solution.answer.u).max() <= SAME_MOTION * np.abs(u).max():
            return None
        return solution._replace(answer=solution.answer._replace(u=u))


class _SteadyState(NamedTuple):
    """A steady state, and whether a small disturbance of it decays."""

    case: ThrustCase
    is_stable: bool


def _stable_first(
    scene: Scene, problem: ThrustProblem, D: float, case: ThrustCase, decay_rates: np.ndarray
) -> list[_SteadyState]:
    """Returns a steady state and the others beside it, stable ones first.

    Among those that are equally stable, `case` is the first.

    D: ball diameter [m].
    decay_rates: of `case`, see `ThrustProblem.decay_rates`.
    """
    is_stable = problem.stable(D, case, decay_rates)
    others = problem.other_states(D, case, is_stable, scene.model.steady_starts)
    states = [_SteadyState(case, is_stable)]
    states += [_SteadyState(other, problem.stable(D, other)) for other in others]
    return sorted(states, key=lambda state: not state.is_stable)


def _state_values(problem: ThrustProblem, states: Sequence[_SteadyState]) -> dict[str, Any]:
    """Returns result variables of all steady states, the first of which is the case's."""
    n = problem.g.n_balls
    total_qv = [n * state.case.contacts[:, summary.QV].sum() for state in states]
    return {
        "stable": int(states[0].is_stable),
        "steady_state_count": len(states),
        "steady_state_orbit_speed": np.array([state.case.u[3] for state in states]),
        "steady_state_total_qv": np.array(total_qv),
        "steady_state_stable": np.array([int(state.is_stable) for state in states]),
    }


def error_estimates(scene: Scene, problem: ThrustProblem, D: float, case: ThrustCase) -> dict:
    """Returns result variables of the numerical errors of a state, by two more solves.

    Empty if one of these fails; see also `error_values`.

    D: ball diameter [m].
    """
    cases = [case]
    for perturbed in problem.perturbed(scene):
        perturbed_case = perturbed.solve(D, start=case.motion)
        if perturbed_case.status != code.OK:
            return {}
        cases.append(perturbed_case)
    as_solved, halved, twice = steady_quantities(scene, problem, D, cases)
    return error_values(
        [regularisation_error(as_solved, halved), DOUBLED * relative_change(as_solved, twice)]
    )


def steady_torque_loss(problem: ThrustProblem, D: float, case: ThrustCase) -> dict:
    """Returns the result variable of the torque that the regularisation takes, by a second solve.

    It is empty where this torque is small, or if the second solve fails.

    D: ball diameter [m].
    """
    contacts = case.contacts
    v_r = coulomb_regularisation(
        problem.op.v_r, float(contacts[:, summary.QV].sum()), float(contacts[:, summary.LOAD].sum())
    )
    if v_r is None:
        return {}
    finer = replace(problem.without_finer, op=problem.op._replace(v_r=v_r)).solve(D)
    if finer.status != code.OK:
        return {}
    torque, coulomb = (solution.contacts[0, summary.TORQUE] for solution in (case, finer))
    return torque_loss(float(torque), float(coulomb))


def steady_quantities(
    scene: Scene, problem: ThrustProblem, D: float, cases: list[ThrustCase]
) -> np.ndarray:
    """Returns quantities of the whole bearing, a row for each case (len(cases), QUANTITY_COUNT).

    They are those whose errors are estimated, in the order of `QUANTITY_COUNT`.

    D: ball diameter [m].
    """
    balls = problem.g.n_balls
    films = Films.of(scene)
    rows = []
    for case in cases:
        columns = case.contacts.T.tolist()
        qv, heat = (balls * sum(columns[k]) for k in (summary.QV, summary.HEAT))
        loss_rate = rates_when_new(scene, films, D, case.contacts).diameter_loss
        shaft_torque = balls * columns[summary.TORQUE][0]  # of the inner contacts
        power = heat + drag_power(problem, D, case)
        rows.append([qv, axial_force(case, balls), loss_rate, shaft_torque, power])
    return np.array(rows)


class UnwornRates(NamedTuple):
    """Wear rates of a bearing whose balls are alike."""

    ball: list[float]  # in both contacts [m3/s]
    race: list[float]  # in both contacts [m3/s]
    diameter_loss: float  # see `diameter_loss_rate` [m/s]


def rates_when_new(scene: Scene, films: Films, D: float, contacts: np.ndarray) -> UnwornRates:
    """Returns the wear rates of a bearing with new surfaces.

    All balls are alike. Numbers are used, since NumPy takes ten times as long.

    D: ball diameter [m].
    contacts: (2, COLUMNS) of `kernels.contact.summary`.
    """
    major = contacts[:, summary.MAJOR]
    track = contacts[:, summary.TRACK].tolist()
    factors = unworn_factors(scene, films, major)
    ball_rate, race_rate = ((factor * contacts[:, summary.QV]).tolist() for factor in factors)
    loss_rate = diameter_loss_rate(scene, D, ball_rate, race_rate, major.tolist(), track)
    return UnwornRates(ball_rate, race_rate, loss_rate)


def drag_power(problem: ThrustProblem, D: float, case: ThrustCase) -> float:
    """Returns the power that the drag of the lubricant takes from all balls [W]; 0 without drag.

    D: ball diameter [m].
    """
    if not problem.op.drag:
        return 0.0  # a call of the kernel takes longer
    F_v, _ = drag_force(problem.g, D, problem.op.drag, case.u[3])
    return problem.g.n_balls * F_v * case.r * case.u[3]


def axial_force(case: ThrustCase, n: int = 1) -> float:
    """Returns the axial force of the inner race on n balls [N], by load and traction."""
    Q, alpha = case.contacts[0, summary.LOAD], case.contacts[0, summary.ANGLE]
    return float(n * Q * math.sin(alpha) + n * case.T_i * math.cos(alpha))


def residual_sentence(case: ThrustCase) -> str:
    """Returns the errors of the balances that check a state, in words."""
    residuals = case.residuals
    return (
        f"errors: {residuals.friction:.1e} of the friction forces in the friction balance, "
        f"{residuals.equilibrium:.1e} of the contact load in the normal force balance, "
        f"{residuals.power:.1e} of the shaft power in the power balance (allowed: "
        f"{LARGEST_RESIDUAL:.0e})"
    )


def steady_values(scene: Scene, problem: ThrustProblem, D: float, case: ThrustCase) -> dict:
    """Returns the result variables of a steady state with balls of diameter D [m].

    `quasistatic_stiffness_matrix` is missing where the balls do not orbit.
    """
    g, op, n = problem.g, problem.op, problem.g.n_balls
    matrix = quasistatic_matrix(g, D, case)
    quasistatic = {} if matrix is None else {"quasistatic_stiffness_matrix": matrix}
    return contact_values(
        scene,
        g,
        op,
        np.array([D]),
        case.u[None],
        np.array([case.r]),
        case.contacts[None],
        np.array([axial_force(case)]),
    ) | {
        "axial_displacement": case.delta_a,
        "shaft_torque": n * case.contacts[0, summary.TORQUE],
        "drag_power": drag_power(problem, D, case),
        "axial_stiffness": n * case.S_xx,
        "quasistatic_axial_stiffness": n * case.S_quasistatic,
        "stiffness_matrix": stiffness_of_loads(
            g, np.array([D]), case.contacts[:, summary.LOAD], case.contacts[:, summary.ANGLE]
        ),
        **quasistatic,
        "centrifugal_force": np.array([case.P_r]),
        "skid_ratio": case.skid,
        "steady_state_branch": case.branch,
        "equilibrium_residual": case.residuals.equilibrium,
        "friction_residual": case.residuals.friction,
        "discretisation_residual": case.residuals.discretisation,
        "discretisation_error_qv": case.residuals.discretisation_qv,
        "power_balance_error": case.residuals.power,
        "equilibrium_rounding": case.residuals.equilibrium_rounding,
        "friction_rounding": case.residuals.friction_rounding,
        "power_rounding": case.residuals.power_rounding,
    }
