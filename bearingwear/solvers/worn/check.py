"""Checks a state with worn grooves by sums that its solver did not use (sections 17, 21)."""

from collections.abc import Sequence

import numpy as np

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.contact.profile import contact_load
from bearingwear.kernels.contact.verification import plain_law
from bearingwear.kernels.steady.thrust import LARGEST_RESIDUAL
from bearingwear.kernels.worn.balance import WornForce, WornRace
from bearingwear.kernels.worn.state import WornSeat
from bearingwear.kernels.worn.verification import check_influence, contact_check, friction_of_cells
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem

LARGEST_GAP = 1e-7  # between bodies that press, over the approach
LARGEST_POWER_ERROR = 1e-8  # of the shaft power


class WornCheck:
    """Checks states; what it computes of the cells is kept as long as they are the same."""

    def __init__(self) -> None:
        self._influence: list[tuple[np.ndarray, np.ndarray]] = 2 * [(np.zeros(0), np.zeros(0))]

    def passes(
        self,
        p: ThrustProblem,
        races: Sequence[WornRace],
        seat: WornSeat,
        slip: np.ndarray,
        u: np.ndarray,
        D: float,
        bare: Sequence[np.ndarray],
    ) -> bool:
        """Returns whether contacts, friction of films and the power balance are right.

        Each has its limit: `LARGEST_GAP`, `LARGEST_RESIDUAL`, `LARGEST_POWER_ERROR`.

        races, seat: of the state.
        slip: (2, 5), that of `FrictionWork`: QV, heat, share, torque, friction coefficient.
        u: motion (4,) of the ball [rad/s].
        D: worn ball diameter [m].
        bare: shares of the cells of both contacts without film, empty if there are no films.
        """
        for k, (race, force) in enumerate(zip(races, (seat.inner, seat.outer), strict=True)):
            if not self._is_closed(k, race, force):
                return False
            if bare:
                friction = self._film_friction(p, k, race, force, bare[k])
                if not abs(friction / slip[k, 4] - 1.0) <= LARGEST_RESIDUAL:
                    return False
        g, op = p.g, p.op
        r = g.R_o + seat.X2
        heat, torque, mu = slip[:, 1], slip[:, 3], slip[:, 4]
        drag = drag_force(g, D, op.drag, u[3])[0] * r * u[3]
        power = torque[0] * op.omega_i + torque[1] * op.omega_o
        shaft_power = max(abs(torque[0] * op.omega_i), abs(torque[1] * op.omega_o))
        # where nothing turns: the heat of all friction at the slip of the regularisation
        least_power = mu.max() * (seat.inner.Q + seat.outer.Q) * op.v_r
        error = abs(power - heat.sum() - drag) / max(shaft_power, least_power)
        return bool(error <= LARGEST_POWER_ERROR)

    def _is_closed(self, k: int, race: WornRace, force: WornForce) -> bool:
        """Returns whether contact k is right: bodies touch where they press, under the right load.

        They never overlap, and nothing pulls. The influence of its cells on one another is kept for
        the next check.
        """
        places = race.cells.X
        if self._influence[k][0] is not places:
            self._influence[k] = places, check_influence(race.cells)
        check = contact_check(race.cells, self._influence[k][1], race.wear, race.pressure)
        unworn = race.cells.fresh.sum() * race.cells.area
        load = contact_load(force.hertz.K, force.approach) * check.load / unworn
        is_tight = max(check.gap, check.overlap) <= LARGEST_GAP and check.tension == 0.0
        return bool(is_tight and abs(load / force.Q - 1.0) <= LARGEST_RESIDUAL)

    @staticmethod
    def _film_friction(
        p: ThrustProblem, k: int, race: WornRace, force: WornForce, bare: np.ndarray
    ) -> float:
        """Returns the friction coefficient of a contact with films, by plain sums over cells.

        k: 0 for the contact with the inner race, 1 for that with the outer one.
        bare: share of the cells without film, along the major axis (n,).
        """
        op = p.op
        # of the unworn contact at this approach; `force.Q` is the load of the worn one
        unworn_load = contact_load(force.hertz.K, force.approach)
        law = plain_law((op.law_i, op.law_o)[k], unworn_load, force.a, force.b)
        return float(friction_of_cells(race.pressure, race.cells.fresh, law, bare, race.without))
