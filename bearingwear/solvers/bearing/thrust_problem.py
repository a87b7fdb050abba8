"""A thrust-loaded bearing in the form that the steady kernels take."""

import math
from dataclasses import dataclass, replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.contact.friction import has_friction
from bearingwear.kernels.contact.points import Rule, most_points
from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL, race_control
from bearingwear.kernels.params import Geometry, OperatingPoint
from bearingwear.kernels.steady.balance import Preload, ThrustBearing
from bearingwear.kernels.steady.search import settled_elsewhere
from bearingwear.kernels.steady.thrust import ThrustCase, thrust_case
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters

FRICTION_TOLERANCE = 1e-14  # of the friction forces; below rounding, where Newton's method ends
FINER = 4  # points of the rule that the checks compare with, over those of the scene's
VISCOUS_START = 0.02  # first regularisation, as a share of the race's surface speed
STABILITY_POINTS = 512
LIKE_STATE = 1e-2  # share of the speeds by which one state may differ between two rules
UNSETTLED = (code.NOT_CONVERGED, code.NO_STEADY_STATE, code.UNVERIFIED, code.CONTACT_LOST)
SEARCH_SLIP = 3e-3  # least regularisation of the search for others, as a share of the same speed
SAME_STATE = 1e-4  # relative difference below which two steady states are one


@dataclass(frozen=True)
class ThrustProblem:
    """A thrust-loaded scene in the form that the kernels take, for many wear states."""

    g: Geometry
    op: OperatingPoint
    preload: Preload
    rule: Rule
    fine_rule: Rule
    search_rule: Rule
    traction: bool  # whether it counts in the balance of normal forces

    @classmethod
    def of(cls, scene: Scene) -> "ThrustProblem":
        """Returns the problem of a scene."""
        preload = Preload(
            constant_force=scene.operation.preload_method == "constant_force",
            F_x=float(scene.operation.preload_N),
            delta_a=parameters.static_place(scene),
        )
        return cls(
            g=parameters.geometry(scene),
            op=parameters.operating_point(scene),
            preload=preload,
            rule=parameters.quadrature(scene),
            fine_rule=parameters.quadrature(scene, refined=FINER),
            search_rule=parameters.search_rule(scene),
            traction=scene.model.includes_traction,
        )

    def bearing(self, D: float) -> ThrustBearing:
        """Returns the bearing with balls of diameter D [m]."""
        return ThrustBearing(
            g=self.g, D=D, op=self.op, preload=self.preload, traction=self.traction
        )

    def kinematic_start(self, kinematics_model: int) -> np.ndarray:
        """Returns (w_x, w_y, w_z, Omega) of race control at the free contact angle [rad/s].

        kinematics_model: outer or inner control, see `kernels.equilibrium.kinematics`.
        """
        g, op = self.g, self.op
        k = race_control(kinematics_model, op.omega_i, op.omega_o, g.D0 / g.dm, g.alpha0, g.alpha0)
        return np.array(
            [k.Omega - k.w_R * math.cos(k.beta), 0.0, k.w_R * math.sin(k.beta), k.Omega]
        )

    def solve(self, D: float, start: np.ndarray | None = None) -> ThrustCase:
        """Returns the steady state with balls of diameter D [m]; its status says if it is one.

        Where a split rule leads to none, Gauss' fixed points are tried. A state that they find is
        marked by `ThrustCase.held`; otherwise the failure with the split rule is returned.

        start: motion (4,) nearby, or (6,) with its tractions, see `ThrustCase.motion`.
        """
        case = self._solve(D, start, self.rule, self.fine_rule)
        if self.rule.split and case.status in UNSETTLED:
            # With a tiny v_r the sums jump where points gather anew: no state may fit them.
            along = most_points(self.rule)
            across = self.rule.across.size
            # four times as many points check it, over the ellipse in both directions
            finer_along, finer_across = (4, 1) if across == 1 else (2, 2)
            rule = parameters.ellipse_rule("gauss", along, across)
            fine = parameters.ellipse_rule("gauss", finer_along * along, finer_across * across)
            fixed_case = self._solve(D, start, rule, fine)
            if fixed_case.status not in UNSETTLED:
                return fixed_case._replace(held=True)
        return case

    def _solve(self, D: float, start: np.ndarray | None, rule: Rule, fine: Rule) -> ThrustCase:
        """Returns the steady state by a rule, checked by a finer one."""
        op = self.op
        u, v_start = start, op.v_r
        if u is None:
            u = self.kinematic_start(OUTER_CONTROL)
            v_start = VISCOUS_START * 0.5 * self.g.dm * abs(op.omega_i - op.omega_o)
        return thrust_case(self.bearing(D), rule, fine, u, v_start, FRICTION_TOLERANCE)

    @property
    def without_finer(self) -> "ThrustProblem":
        """Returns the problem without the finer rule that the checks compare with."""
        return replace(self, fine_rule=self.rule)

    def perturbed(self, scene: Scene) -> "tuple[ThrustProblem, ThrustProblem]":
        """Returns the problem with half the regularisation, and with twice the points.

        Both are `without_finer`.
        """
        half_slip = self.op._replace(v_r=0.5 * self.op.v_r)
        twice_points = parameters.quadrature(scene, refined=2)
        halved = replace(self, op=half_slip, fine_rule=self.rule)
        return halved, replace(self, rule=twice_points, fine_rule=twice_points)

    def undetermined(self) -> int:
        """Returns OK if the problem can be solved, or the status of one without a solution.

        It is UNDETERMINED without friction, and PRELOAD_GONE under a spring without force.
        """
        if not has_friction(self.op):
            return code.UNDETERMINED
        if self.preload.constant_force and self.preload.F_x == 0.0:
            return code.PRELOAD_GONE
        return code.OK

    def decay_rates(self, D: float, case: ThrustCase) -> np.ndarray:
        """Returns the eigenvalues (4,) of the ball's linearised motion about the state [1/s].

        They may be complex. A disturbance decays where its real part is negative.
        """
        m = ball_mass(self.g.rho, D)
        inertia = np.array([ball_inertia(m, D)] * 3 + [m * case.r**2])
        return np.linalg.eigvals(case.jacobian / inertia[:, None])

    def stable(self, D: float, case: ThrustCase, rates: np.ndarray | None = None) -> bool:
        """Returns whether a small disturbance of the state decays.

        With a tiny v_r the slowest motions are damped in narrow places where the slip reverses,
        which few points may miss. A state that seems unstable is checked again with many.

        rates: its `decay_rates`, if they are known.
        """
        if rates is None:
            rates = self.decay_rates(D, case)
        if rates.real.max() < 0.0:
            return True
        many = parameters.ellipse_rule("split", STABILITY_POINTS, self.rule.across.size)
        rechecked = replace(self, rule=many, fine_rule=many).solve(D, start=case.motion)
        is_same = np.abs(rechecked.u - case.u).max() <= LIKE_STATE * np.abs(case.u).max()
        if rechecked.status != code.OK or not is_same:
            return False
        return bool(self.decay_rates(D, rechecked).real.max() < 0.0)

    def other_states(self, D: float, case: ThrustCase, stable: bool, most: int) -> list[ThrustCase]:
        """Returns steady states other than `case`, from a search over the orbit rate.

        Those nearest to rolling come first.

        stable: whether `case` is stable.
        most: number of motions tried as a start, those nearest to rolling first.
        """
        if most == 0:
            return []
        op = self.op
        states = [case]
        v_r = max(op.v_r, SEARCH_SLIP * 0.5 * self.g.dm * abs(op.omega_i - op.omega_o))
        settled_motions = settled_elsewhere(
            self.bearing(D),
            self.rule,
            self.search_rule,
            v_r,
            case.delta_a,
            case.u,
            not stable,
            most,
        )
        for u in settled_motions:
            # Newton's method may lead from a motion that had not settled to a known state.
            if is_new(u, states):
                solved = self.solve(D, start=u)
                if solved.status == code.OK and is_new(solved.u, states):
                    states.append(solved)
        others = states[1:]
        if len(others) > 1:
            rolling = self.kinematic_start(OUTER_CONTROL)[3]
            others.sort(key=lambda state: abs(state.u[3] - rolling))
        return others


def time_scale_values(rates: np.ndarray) -> dict[str, float]:
    """Returns `fast_time_scale` and `slow_time_scale` of a state [s].

    They are 1/max |rate| and 1/min |real part of rate|.

    rates: eigenvalues (4,) of the ball's linearised motion [1/s].
    """
    return {
        "fast_time_scale": 1.0 / np.abs(rates).max(),
        "slow_time_scale": 1.0 / np.abs(rates.real).min(),
    }


def is_new(u: np.ndarray, states: list[ThrustCase]) -> bool:
    """Returns whether a motion (4,) differs from those of all states, by more than `SAME_STATE`."""
    near = SAME_STATE * np.abs(u).max()
    return all(np.abs(u - case.u).max() > near for case in states)
