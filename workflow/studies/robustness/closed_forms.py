"""Boundaries of maps in closed form, from rolling at the free angle and loads at rest."""

import math

from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from workflow.studies.robustness.draw import at_rest, elastic_approach


def closed_form(limit: str, value: float | None, scene: Scene) -> float:
    """Returns a number that is positive beyond a limit, by a closed form.

    The balls roll at the free angle, under loads at rest. The number is the gap at the inner race
    [m] for "contact" (negative for an approach), the share less `value`, or the ratio of drag to
    its limit, less 1. For the last two, it is 1 without friction, or where wear has taken the load.

    limit: "contact", where only the outer race holds the ball against the centrifugal force of
        rolling, and the ball no longer reaches the inner race at its position at rest;
        "gyroscopic_slip", where the share s of the friction mu (Q_i + Q_o) R balances the
        gyroscopic moment; "skid", where drag exceeds 2 mu Q_i, the most that the inner race can
        transmit (rolling on the outer race takes half of it).
    value: of the share s; not used for the other limits.
    """
    g = parameters.geometry(scene)
    m = parameters.operating_point(scene)
    D = float(parameters.ball_diameters(scene)[0])
    _, rest = at_rest(scene)
    # at rest, both contacts act along one line, as springs in series with the stiffness K;
    # the elastic approach (slack) of both shrinks as the ball wears
    K = (rest.hertz_i.K ** (-2 / 3) + rest.hertz_o.K ** (-2 / 3)) ** -1.5
    slack = elastic_approach(scene) - (g.D0 - D)
    gamma = g.D0 / g.dm
    Omega = 0.5 * m.omega_i * (1.0 - gamma * math.cos(g.alpha0))
    mass = g.rho * math.pi / 6.0 * D**3
    F_c = mass * 0.5 * g.dm * Omega**2
    Q = K * slack**1.5 if slack > 0.0 else 0.0
    if limit == "contact":
        length = g.r_i + g.r_o - g.D0 + elastic_approach(scene)
        A1, A2 = length * math.sin(rest.alpha_o), length * math.cos(rest.alpha_o)
        X2 = g.r_o - 0.5 * D + (F_c / rest.hertz_o.K) ** (2 / 3)
        # X2: radial place of the ball's centre, which F_c alone presses into the outer race;
        # reach: elastic approach to the inner race, held where it is at rest; below 0, a gap
        reach = math.hypot(A1, A2 - X2) - (g.r_i - 0.5 * D)
        return -min(reach, slack)
    if Q == 0.0 or m.law_o.mu == 0.0:
        return 1.0
    if limit == "gyroscopic_slip" and value is not None:
        w_R = m.omega_i * (1.0 - gamma**2 * math.cos(g.alpha0) ** 2) / (2.0 * gamma)
        # 0.1 m D^2: moment of inertia of a ball
        M_g = 0.1 * mass * D * D * w_R * Omega * math.sin(rest.alpha_o)
        return M_g / (m.law_o.mu * (2.0 * Q + F_c) * 0.5 * D) - value
    drag = math.pi / 8.0 * m.drag * D**2 * (0.5 * g.dm * Omega) ** 2
    return drag / (2.0 * m.law_o.mu * Q) - 1.0
