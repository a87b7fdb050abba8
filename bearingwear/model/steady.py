"""The friction-balanced steady state of a thrust-loaded scene."""

import math
from dataclasses import dataclass, replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass, drag_force
from bearingwear.kernels.ellipse import Rule, most_points
from bearingwear.kernels.kinematics import OUTER_CONTROL, race_control
from bearingwear.kernels.params import Geometry, OperatingPoint
from bearingwear.kernels.search import settled_elsewhere
from bearingwear.kernels.steady_balance import (
    BalanceProblem,
    Preload,
    ThrustBearing,
    balance_problem,
)
from bearingwear.kernels.summary import ANGLE, HEAT, LOAD, MAJOR, QV, TORQUE, TRACK
from bearingwear.kernels.thrust import LARGEST_RESIDUAL, ThrustCase, thrust_case
from bearingwear.model import parameters
from bearingwear.model.estimate import DOUBLED, changed, halved_part, summed
from bearingwear.model.films import Bare, friction_law
from bearingwear.model.outputs import (
    TURN,
    contact_values,
    diameter_loss_rates,
    stiffness_matrix,
    wear_rates,
)
from bearingwear.model.stiffness import quasistatic_matrix
from bearingwear.scene.scene import Scene

FRICTION_TOLERANCE = 1e-14  # of the friction forces; below rounding, where Newton's method ends
VISCOUS_START = 0.02  # first regularisation, as a share of the race's surface speed
STABILITY_POINTS = 512
LIKE_STATE = 1e-2  # share of the speeds by which one state may differ between two rules
UNSETTLED = (code.NOT_CONVERGED, code.NO_STEADY_STATE, code.UNVERIFIED, code.CONTACT_LOST)
SEARCH_SLIP = 3e-3  # least regularisation of the search for others, as a share of the same speed
SAME_STATE = 1e-4  # relative difference below which two steady states are one


@dataclass(frozen=True)
class ThrustProblem:
    """A thrust-loaded scene as kernels see it; built once and solved for many wear states."""

    g: Geometry
    op: OperatingPoint
    preload: Preload
    rule: Rule
    fine_rule: Rule
    search_rule: Rule
    traction: bool  # in the balance of normal forces

    @classmethod
    def of(cls, scene: Scene) -> "ThrustProblem":
        g = parameters.geometry(scene)
        F_x = float(scene.operation.preload_N)
        rule, fine_rule = parameters.quadrature(scene), parameters.quadrature(scene, refined=4)
        constant_force = scene.operation.preload_method == "constant_force"
        preload = Preload(
            constant_force=constant_force, F_x=F_x, delta_a=parameters.static_place(scene)
        )
        op, search_rule = parameters.operating_point(scene), parameters.search_rule(scene)
        traction = scene.model.traction_bears
        return cls(g, op, preload, rule, fine_rule, search_rule, traction)

    def bearing(self, D: float) -> ThrustBearing:
        """The bearing with balls of diameter D [m]."""
        return ThrustBearing(
            g=self.g, D=D, op=self.op, preload=self.preload, traction=self.traction
        )

    def where_bare(self, scene: Scene, bare: Bare) -> "ThrustProblem":
        """The problem of a scene in some of whose contacts no film is left."""
        return replace(self, op=self.op._replace(**friction_law(scene, bare)))

    def balance(self, D: float) -> BalanceProblem:
        """The equations of motion of a ball of diameter D [m]."""
        return balance_problem(self.bearing(D), self.rule, self.traction)

    def kinematic_start(self, kinematics_model: int) -> np.ndarray:
        """(w_x, w_y, w_z, Omega) of race control at the free contact angle [rad/s]."""
        g, op = self.g, self.op
        k = race_control(kinematics_model, op.omega_i, op.omega_o, g.D0 / g.dm, g.alpha0, g.alpha0)
        return np.array(
            [k.Omega - k.w_R * math.cos(k.beta), 0.0, k.w_R * math.sin(k.beta), k.Omega]
        )

    def solve(self, D: float, start: np.ndarray | None = None) -> ThrustCase:
        """Steady state with balls of diameter D [m], from a state nearby or without one."""
        case = self._solve(D, start, self.rule, self.fine_rule)
        if self.rule.split and case.status in UNSETTLED:
            # With a tiny v_r the sums jump where points gather anew: no state may fit them.
            n = most_points(self.rule)
            m = self.rule.across.size
            sizes = [(n, m), (4 * n, m) if m == 1 else (2 * n, 2 * m)]
            rules = (parameters.ellipse_rule("gauss", *size) for size in sizes)
            held = self._solve(D, start, *rules)
            if held.status not in UNSETTLED:
                return held._replace(held=True)
        return case

    def _solve(self, D: float, start: np.ndarray | None, rule: Rule, fine: Rule) -> ThrustCase:
        op = self.op
        if start is not None:
            u, v_start = start, op.v_r
        else:
            u = self.kinematic_start(OUTER_CONTROL)
            v_start = VISCOUS_START * 0.5 * self.g.dm * abs(op.omega_i - op.omega_o)
        return thrust_case(self.bearing(D), rule, fine, u, v_start, FRICTION_TOLERANCE)

    @property
    def without_finer(self) -> "ThrustProblem":
        """The problem without the finer copies that the checks compare with."""
        return replace(self, fine_rule=self.rule)

    def perturbed(self, scene: Scene) -> "tuple[ThrustProblem, ThrustProblem]":
        """The problem with half the regularisation, and with twice the points, `without_finer`."""
        halved = replace(self, op=self.op._replace(v_r=0.5 * self.op.v_r))
        twice = replace(self, rule=parameters.quadrature(scene, refined=2))
        return halved.without_finer, twice.without_finer

    def undetermined(self) -> int:
        """Status that is known before any solve, or OK."""
        op = self.op
        if not max(op.S_i, op.S_o, op.mu_i, op.mu_o) > 0.0:
            return code.UNDETERMINED
        if self.preload.constant_force and self.preload.F_x == 0.0:
            return code.PRELOAD_GONE
        return code.OK

    def linear_motion(self, D: float, case: ThrustCase) -> np.ndarray:
        """Derivative (4, 4) of the rates of (w_x, w_y, w_z, Omega) by these, at the state [1/s]."""
        m = ball_mass(self.g.rho, D)
        inertia = np.array([ball_inertia(m, D)] * 3 + [m * case.r**2])
        return case.jacobian / inertia[:, None]

    def time_scales(self, D: float, case: ThrustCase) -> np.ndarray:
        """Eigenvalues (4,) of the ball's linearised motion about the state [1/s]."""
        return np.linalg.eigvals(self.linear_motion(D, case))

    def stable(self, D: float, case: ThrustCase, scales: np.ndarray | None = None) -> bool:
        """Whether a small disturbance of the state decays.

        With a tiny v_r the slowest motions are damped in narrow places where the slip reverses,
        which few points may miss. A state that seems unstable is checked again with many.

        Parameters
        ----------
        scales : ndarray (4,), optional
            The state's `time_scales`, if they are known.
        """
        if (self.time_scales(D, case) if scales is None else scales).real.max() < 0.0:
            return True
        many = parameters.ellipse_rule("split", STABILITY_POINTS, self.rule.across.size)
        again = replace(self, rule=many, fine_rule=many).solve(D, start=case.u)
        same = np.abs(again.u - case.u).max() <= LIKE_STATE * np.abs(case.u).max()
        return bool(
            again.status == code.OK and same and self.time_scales(D, again).real.max() < 0.0
        )

    def other_states(self, D: float, case: ThrustCase, stable: bool, most: int) -> list[ThrustCase]:
        """Steady states other than `case` (`stable` or not), searched for over the orbit rate.

        At most so many motions are tried as a start, those nearest to rolling first.
        """
        if most == 0:
            return []
        op, found = self.op, [case]
        v_r = max(op.v_r, SEARCH_SLIP * 0.5 * self.g.dm * abs(op.omega_i - op.omega_o))
        rules = self.rule, self.search_rule
        args = case.delta_a, case.u, not stable, most
        for u in settled_elsewhere(self.bearing(D), *rules, v_r, *args):
            # Newton may go on from a motion that had not settled to a state that is known.
            if is_new(u, found):
                other = self.solve(D, start=u)
                if other.status == code.OK and is_new(other.u, found):
                    found.append(other)
        others = found[1:]
        if len(others) > 1:
            rolling = self.kinematic_start(OUTER_CONTROL)[3]
            others.sort(key=lambda c: abs(c.u[3] - rolling))
        return others


def is_new(u: np.ndarray, found: list[ThrustCase]) -> bool:
    """Whether a motion (4,) is none of the states found."""
    near = SAME_STATE * np.abs(u).max()
    return all(np.abs(u - case.u).max() > near for case in found)


def solve_steady(
    scene: Scene, problem: ThrustProblem | None = None, case: ThrustCase | None = None
) -> tuple[dict, dict]:
    """Values and attributes of the friction-balanced steady state.

    Parameters
    ----------
    scene : Scene
    problem : ThrustProblem, optional
        In place of the scene's own, as one bearing of a pair is pressed.
    case : ThrustCase, optional
        Its state, if it is known.
    """
    mounted = parameters.static_place(scene) if problem else None  # its own is found with it
    problem = problem or ThrustProblem.of(scene)
    D = float(parameters.worn_diameters(scene, problem.g)[0])
    values: dict = {
        "status": problem.undetermined(),
        "ball_diameter_loss": np.array([problem.g.D0 - D]),
        "initial_axial_displacement": problem.preload.delta_a if mounted is None else mounted,
    }
    if values["status"] != code.OK:
        return values, {"residual": "not solved"}
    case = case or problem.solve(D)
    values["status"] = case.status
    attrs: dict = {"iterations": case.iterations, "residual": "not solved"}
    if case.status in (code.OK, code.UNVERIFIED):
        scales = problem.time_scales(D, case)
        stable = {id(case): problem.stable(D, case, scales)}
        others = problem.other_states(D, case, stable[id(case)], scene.model.steady_starts)
        stable |= {id(c): problem.stable(D, c) for c in others}
        # the one reached first, if it is stable
        every = sorted([case, *others], key=lambda c: not stable[id(c)])
        if every[0] is not case:
            case = every[0]
            scales = problem.time_scales(D, case)
        attrs["residual"] = residual_sentence(case)
        values |= error_estimates(scene, problem, D, case)
        if case.held:
            attrs["quadrature"] = "gauss, at fixed places: the split rule found no state"
        values |= {"status": case.status} | steady_values(scene, problem, D, case)
        values |= {
            "fast_time_scale": 1.0 / np.abs(scales).max(),
            "slow_time_scale": 1.0 / np.abs(scales.real).min(),
            "stiffness_transition_frequency": np.abs(scales.real).min() / TURN,
            "stable": int(stable[id(case)]),
            "steady_state_count": len(every),
            "steady_state_orbit_speed": np.array([c.u[3] for c in every]),
            "steady_state_total_qv": np.array(
                [problem.g.n_balls * c.contacts[:, QV].sum() for c in every]
            ),
            "steady_state_stable": np.array([int(stable[id(c)]) for c in every]),
        }
        if not values["stable"] and values["status"] == code.OK:
            values["status"] = code.NO_STEADY_STATE
    return values, attrs


def error_estimates(scene: Scene, problem: ThrustProblem, D: float, case: ThrustCase) -> dict:
    """Estimated numerical errors of a solved state; empty where none can be found."""
    cases = [case]
    for other in problem.perturbed(scene):
        near = other.solve(D, start=case.u)
        if near.status != code.OK:
            return {}
        cases.append(near)
    now, halved, twice = steady_answers(scene, problem, D, cases)
    return summed([halved_part(now, halved), DOUBLED * changed(now, twice)])


def steady_answers(
    scene: Scene, problem: ThrustProblem, D: float, cases: list[ThrustCase]
) -> np.ndarray:
    """Quantities (n, MEASURED) of n states whose errors are estimated, as `estimate.measured`."""
    n, c = problem.g.n_balls, np.array([case.contacts for case in cases])
    ball_rate, race_rate = wear_rates(scene, c[..., QV], c[..., MAJOR])
    diameters = np.full(len(cases), D)
    loss = diameter_loss_rates(n, diameters, ball_rate, race_rate, c[..., MAJOR], c[..., TRACK])
    drag = [drag_power(problem, D, case) for case in cases]
    return np.column_stack(
        [
            n * c[..., QV].sum(axis=1),
            [axial_force(case, n) for case in cases],
            loss,
            n * c[:, 0, TORQUE],
            n * c[..., HEAT].sum(axis=1) + drag,
        ]
    )


def drag_power(problem: ThrustProblem, D: float, case: ThrustCase) -> float:
    """Power of the drag on all balls [W]."""
    F_v, _ = drag_force(problem.g, D, problem.op.drag, case.u[3])
    return problem.g.n_balls * F_v * case.r * case.u[3]


def axial_force(case: ThrustCase, n: int = 1) -> float:
    """Axial force of the inner race on n balls [N]."""
    Q, alpha = case.contacts[0, LOAD], case.contacts[0, ANGLE]
    return float(n * Q * math.sin(alpha) + n * case.T_i * math.cos(alpha))


def residual_sentence(case: ThrustCase) -> str:
    """The checks after the solve, in words."""
    found = case.residuals
    return (
        f"friction balance {found.friction:.1e} of the friction forces, "
        f"normal balance {found.equilibrium:.1e} of the contact load, "
        f"power balance {found.power:.1e} of the shaft power, allowed {LARGEST_RESIDUAL:.0e}"
    )


def steady_values(scene: Scene, problem: ThrustProblem, D: float, case: ThrustCase) -> dict:
    """Case variables of a solved steady state."""
    g, op, n = problem.g, problem.op, problem.g.n_balls
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
        "shaft_torque": n * case.contacts[0, TORQUE],
        "drag_power": drag_power(problem, D, case),
        "axial_stiffness": n * case.S_xx,
        "quasistatic_axial_stiffness": n * case.S_quasistatic,
        "stiffness_matrix": stiffness_matrix(g, np.array([D]), case.contacts[None]),
        "quasistatic_stiffness_matrix": quasistatic_matrix(g, D, case),
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
