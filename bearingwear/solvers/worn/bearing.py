"""States of a bearing with its grooves as worn (theory.md section 21).

Depths of grooves stand on fixed grids, each along its own arc. Balls wear evenly.
"""

import copy
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.hertz import INNER, OUTER, elliptic_integrals, race_contact
from bearingwear.kernels.contact.points import most_points
from bearingwear.kernels.contact.profile import contact_approach, middle_height, profile
from bearingwear.kernels.contact.summary import ANGLE, LOAD, MAJOR
from bearingwear.kernels.equilibrium.thrust_loaded import groove_distance
from bearingwear.kernels.params import Geometry
from bearingwear.kernels.steady.thrust import ThrustCase
from bearingwear.kernels.worn.balance import Arc, WornRace
from bearingwear.kernels.worn.cells import contact_buffers
from bearingwear.kernels.worn.friction import FrictionWork, friction_work
from bearingwear.kernels.worn.pressure import FULL_WIDTH, contact_cells
from bearingwear.kernels.worn.state import WornSeat, state_work, worn_state
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import PEAK_OVER_MEAN, contact_temperatures
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.worn.check import WornCheck
from bearingwear.solvers.worn.depths import (
    UNWORN_ARC,
    WornDepths,
    WornPoint,
    arc_values,
    depth_spline,
    seat_force,
    seat_of_case,
    spread_by_wander,
)
from bearingwear.solvers.worn.films import AS_WITH_FILM, LEAST_WANDER, WornFilms

SIDES = (INNER, OUTER)
ARC_STEP = 0.05  # of the initial semi-major axis
ARC_END = 5.0  # initial semi-major axes from where the contact was, new, at least
LONGER_THAN_WORN, ARC_SPARE = 1.3, 1.5
"""Grid over the half length of a contact worn as deep as its life allows, and axes beyond that."""
MOST_ARC = 1.0  # rad, to which grids longer than `ARC_END` reach: shoulders are lower
CELLS_END = 1.9  # semi-major axes, cells along them as asked for; more where the contact is longer
SPARE = 3.0  # cells beyond the contact, at least
LAST_CELL = 1.5  # the same, where only a contact that reaches the last cell has grown too far
WIDER = 1.2  # of the cells, where the contact has grown to their ends
ROWS = 2  # more cells across, likewise
LOAD_GONE = 3e-4  # of the load when new, below which a ball carries none: it hardly wears any more
LONGEST_AHEAD = 2.0  # of a step, beyond which none is foretold by the one before
_MOST_WIDENINGS = 6
MOST_ENDS, MOST_ROWS = 3.0 * CELLS_END, 2 * ROWS
"""Cells at other speeds than that of the wear. Those of a contact under hardly any load grow
without end, and their number with them: a state that needs more has none."""
_GRIPS, _LESS_GRIP = 8, 4.0  # times v_r is raised, each by so much, to start with less friction
_FAR = code.NOT_CONVERGED, code.BEYOND_GROOVE, code.CONTACT_LOST
"""How a start that is too far from the state ends, or where there is no state."""
_SLIP_SHARE = 2  # column of the slip of a state
_SLIP_SETS_IN = 0.1  # rise of a slip share in a step of wear that may have led past a fold
_FOLD_STEP, _MOST_FOLD_STEPS = 0.1, 40
"""Moves of a race past a fold, over the approach of a contact, and how many."""
_RACE, _NOT_RACE = 2, [0, 1]  # of the unknowns, the axial place of the race; and the others
_ACROSS = np.linspace(-0.95, 0.95, 20)
_SHAPE = np.sqrt(1.0 - _ACROSS**2) / np.sqrt(1.0 - _ACROSS**2).sum()
"""Places along a contact, over its semi-major axis, and the load of Hertz there, over its sum."""
_FIRST_ON_THE_WAY, _LEAST_ON_THE_WAY, _MOST_ON_THE_WAY = 0.25, 1.0 / 32.0, 16
"""Steps from an even groove to one as it is worn, over what they differ by, and how many."""
_MOVES = 8  # of a race that is held too far from where it was, to where it is held
_ROUNDS = 3  # in which the depth of the grooves at a contact is found
_NO_MOVES = np.empty((0, 3)), np.empty((0, 2, 3))
ROUGH = 1e-5  # balance of a state on the way, which shows how fast its wear goes and nothing else
SMALL, NEARBY = 3e-5, 1e-3  # of the approach: moves that lead to a way, and the way itself


class _Start(NamedTuple):
    """What a solve starts from: places, motion, and cells with their pressures."""

    seat: WornSeat
    u: np.ndarray
    reference: np.ndarray
    races: tuple[WornRace, ...]
    ends: np.ndarray
    rows_added: np.ndarray


_SolvedState = tuple[WornSeat, np.ndarray, tuple[WornRace, ...], FrictionWork]
"""Seat, with the status, motion, races and friction buffers of a solve."""


class WornBearing:
    """A bearing under thrust whose contacts follow its worn grooves.

    problem: of the new bearing; a state may have another geometry and preload.
    case: unworn state of the new bearing.
    loss: of ball diameter at the start [m].
    cells: numbers along the major axis, and on each side of it.
    wander: rms of the wander of the track, over the initial semi-major axes.
    films: where friction or wear go by films or running in.
    most_worn: depth of wear for which the grids of depths have room [m].
    """

    def __init__(
        self,
        problem: ThrustProblem,
        case: ThrustCase,
        loss: float,
        cells: tuple[int, int] = (48, 10),
        wander: float = 0.1,
        films: WornFilms | None = None,
        most_worn: float = 0.0,
    ):
        self.films = films
        self.on_the_way = False  # whether states are balanced roughly, and not checked
        self.wears = True  # else contacts may leave the grids, beyond which nothing is worn
        self.problem, self.case, self.loss, self.cell_numbers = problem, case, loss, cells
        self.wander = wander
        self.D = problem.g.D0 - loss
        self.status, c = case.status, case.contacts  # of the cells, too
        self.major, self.angle = c[:, MAJOR].copy(), c[:, ANGLE].copy()
        self.own_angle = self.angle  # of the cells
        self.least_load = LOAD_GONE * float(c[:, LOAD].max())
        self.arc_step = ARC_STEP * self.major
        steps = round(self._arc_end(most_worn) / ARC_STEP)
        self.arc = self.arc_step[:, None] * np.arange(-steps, steps + 1)  # (2, arcs) [m]
        self.ends = np.full(2, CELLS_END)
        self.rows_added = np.zeros(2, dtype=int)  # to the cells on each side of the major axes
        self.loaded: list[np.ndarray] = []  # first and last loaded cell of each contact, over a
        self.reference = np.zeros(2)
        self.races = tuple(self._unworn_race(k) for k in range(2))
        self.starts: dict[float, _Start] = {}  # at other speeds, by these [rad/s]
        self.even = code.OK  # status of a bearing evenly worn, where a solve had to start from that
        self.seat = seat_of_case(case, problem.g, self.D, 0.0)
        self.u = case.u[:4].copy()
        self.slip_shares = np.ones(2)  # of the state from which a solve starts [1]
        self.state = state_work()
        self._work: tuple[tuple[int, ...], FrictionWork] | None = None
        self.check = WornCheck()

    def _arc_end(self, most_worn: float) -> float:
        """Returns the length of the grids from their middles, over the semi-major axes.

        most_worn: depth of wear for which they have room [m].

        A groove of some depth over the gap A a^2 is as long as the square root of that.
        """
        ends = [ARC_END]
        for k, r_g in enumerate((self.problem.g.r_i, self.problem.g.r_o)):
            hertz = race_contact(
                self.problem.g, SIDES[k], self.D, float(np.cos(self.angle[k])), float("nan")
            )
            gap = edge_gap(hertz.log_kappa, contact_approach(hertz.K, self.case.contacts[k, LOAD]))
            length = LONGER_THAN_WORN * np.sqrt(most_worn / gap) + ARC_SPARE
            ends.append(min(length, MOST_ARC * r_g / self.major[k]))
        return max(ends)

    def _unworn_race(self, k: int) -> WornRace:
        """Returns race k without wear, with cells for the present length of its contact.

        Sets `status` if there are no such cells.
        """
        n, m = self.cell_numbers
        n = 2 * round(0.5 * n * self.ends[k] / CELLS_END)
        rows = m + int(self.rows_added[k])
        hertz = race_contact(
            self.problem.g, SIDES[k], self.D, float(np.cos(self.own_angle[k])), float("nan")
        )
        end = float(self.ends[k])
        status, cells = contact_cells(hertz.log_kappa, -end, end, FULL_WIDTH * rows / m, n, rows)
        if status != code.OK:
            self.status = status
        return WornRace(
            cells=cells,
            work=contact_buffers(n, rows),
            pressure=cells.fresh.copy(),
            wear=np.zeros(n),
            x=np.zeros(n),
            rise=np.zeros(n),
            groove=UNWORN_ARC,
            alpha_ref=float(self.angle[k]),
            bare=np.zeros(n),
            uncovered=UNWORN_ARC,
            without=AS_WITH_FILM,
        )

    def take_grids_of(self, other: "WornBearing") -> None:
        """Puts depths on the grids of `other`: the same bearing in another condition."""
        self.major, self.angle = other.major, other.angle
        self.arc_step, self.arc = other.arc_step, other.arc
        self.races = tuple(
            race._replace(alpha_ref=float(angle))
            for race, angle in zip(self.races, other.angle, strict=True)
        )

    def unworn(self) -> WornDepths:
        """Returns no wear, on the grids of this bearing."""
        return WornDepths(0.0, np.zeros_like(self.arc))

    def solve(self, wear: WornDepths, problem: ThrustProblem | None = None) -> WornPoint:
        """Returns the steady state with some wear, solved from the last state.

        It is rough if `on_the_way`. Where there is no state, the next solve starts from where this
        one did, with fresh pressures.

        problem: with another geometry or preload than those of the new bearing.
        """
        p = problem or self.problem
        D = p.g.D0 - self.loss - wear.ball
        if not self.wears:
            self._start_from_nearest(p, wear)
        kept = _Start(self.seat, self.u, self.reference, self.races, self.ends, self.rows_added)
        seat, u, races, work = self._nearest_state(kept, p, D, wear)
        status = seat.status
        if status in _FAR and self.even not in (code.OK, code.NOT_CONVERGED):
            status = self.even  # nothing holds the balls, however they are worn
        if status != code.OK:
            self._return_to(kept)  # cells added in vain would be slow
            self.reference = kept.reference
            self._reset_pressures()
            return WornPoint(status, wear, p)
        self.seat, self.u, self.worn_races, self.worn_reference = seat, u, races, self.reference
        self.slip_shares = work.slip[:, _SLIP_SHARE].copy()
        self._keep_start(p)
        return self._checked_point(p, D, wear, work)

    def _nearest_state(
        self, start: _Start, p: ThrustProblem, D: float, wear: WornDepths
    ) -> _SolvedState:
        """Returns the state that a solve from `start` finds, or from another start if it fails.

        Where a constant force moves the race past a fold, it is the nearest state beyond.

        D: worn ball diameter [m].
        """
        other_starts: tuple[Callable[[int, ThrustProblem, float, WornDepths], bool], ...] = (
            self._start_from_even_wear,
            self._start_at_present_loads,
            self._start_with_less_friction,
        )
        if not self.wears:
            other_starts = (self._start_through_grooves,)
        solved = self._state_in_cells(p, D, wear)
        for set_start in other_starts:
            status = solved[0].status
            if status not in _FAR:
                break
            self._return_to(start)  # the depths counted from stay as another start has set them
            if set_start(status, p, D, wear):
                solved = self._state_in_cells(p, D, wear)
        seat, _, _, work = solved
        has_jumped = seat.status == code.OK and self._has_jumped(start.seat, seat, work.slip)
        if self.wears and p.preload.constant_force and (seat.status in _FAR or has_jumped):
            farthest = seat.delta_a if has_jumped else None
            return self._state_past_fold(start, farthest, p, D, wear) or solved
        return solved

    def _checked_point(
        self, p: ThrustProblem, D: float, wear: WornDepths, work: FrictionWork
    ) -> WornPoint:
        """Returns the state just solved with some wear, or why it does not count as one.

        A state on the way is not checked.

        D: worn ball diameter [m].
        work: friction of the state.
        """
        seat, u, races = self.seat, self.u, self.worn_races
        slip = work.slip.copy()
        forces = (seat.inner, seat.outer)
        if self.wears and max(seat.inner.Q, seat.outer.Q) < self.least_load:
            return WornPoint(code.PRELOAD_GONE, wear, p)
        if self.wears and not self._is_on_grids(seat):
            return WornPoint(code.BEYOND_GROOVE, wear, p)
        bare = [
            self.at_cells(self.bare(wear, k), k, races[k].x, force.alpha, p.g)
            for k, force in enumerate(forces if self.films else ())
        ]
        if not self.on_the_way and not self.check.passes(p, races, seat, slip, u, D, bare):
            return WornPoint(code.UNVERIFIED, wear, p)
        return WornPoint(
            status=seat.status,
            wear=wear,
            problem=p,
            seat=seat,
            u=u.copy(),
            slip=slip,
            qv_along=tuple(work.rates[k, : race.x.size].copy() for k, race in enumerate(races)),
            x=tuple(race.x.copy() for race in races),
            pressure=tuple(race.pressure.copy() for race in races),
            track=_track_radii(p, seat, D),
            D=D,
        )

    def _start_from_even_wear(
        self, status: int, p: ThrustProblem, D: float, wear: WornDepths
    ) -> bool:
        """Sets the state with evenly worn balls as the start; returns whether there is one.

        status: of the solve that failed; only after NOT_CONVERGED is this start tried.
        """
        if status != code.NOT_CONVERGED:
            return False
        return self._start_evenly(p, D).status == code.OK

    def _start_at_present_loads(
        self, status: int, p: ThrustProblem, D: float, wear: WornDepths
    ) -> bool:
        """Sets the depths from which wear is counted to those of the contacts of the start.

        Each contact then has the approach of its load. The depths were set by another state, maybe
        with more wear, and they scale the cells. Returns whether both contacts carry load.
        """
        forces = self.seat.inner, self.seat.outer
        if not all(force.Q > 0.0 for force in forces):
            return False
        approaches = [contact_approach(force.hertz.K, force.Q) for force in forces]
        self.reference = self._lengths(self.seat, p.g, D) - approaches
        self._reset_pressures()
        return True

    def _start_with_less_friction(
        self, status: int, p: ThrustProblem, D: float, wear: WornDepths
    ) -> bool:
        """Sets as the start the state to which less and less regularised friction leads.

        Friction decides which of several states there are: past a fold the next one lies far off.
        Returns True: the solve may be tried again.
        """
        self._reset_pressures()
        for level in range(_GRIPS, 0, -1):
            less = replace(p, op=p.op._replace(v_r=p.op.v_r * _LESS_GRIP**level))
            seat, u, _, _ = self._state_in_cells(less, D, wear)
            if seat.status in (code.OK, code.NOT_CONVERGED):  # the latter is nearer, too
                self.seat, self.u = seat, u
            if seat.status == code.NOT_CONVERGED:  # the last place tried may lie beyond the cells
                self._widen_cells(seat.status)
        return True

    def _has_jumped(self, start: WornSeat, seat: WornSeat, slip: np.ndarray) -> bool:
        """Returns whether slip of a contact set in as the race moved on in a step of wear.

        It sets in where its share rises by more than `_SLIP_SETS_IN`. Another state may then lie
        nearer.

        slip: (2, 5), that of `FrictionWork` in the state.
        """
        rise = slip[:, _SLIP_SHARE] - self.slip_shares
        return seat.delta_a > start.delta_a and bool(rise.max() > _SLIP_SETS_IN)

    def _state_past_fold(
        self, start: _Start, farthest: float | None, p: ThrustProblem, D: float, wear: WornDepths
    ) -> _SolvedState | None:
        """Returns the next state to which a constant force moves the race, as `_state_in_cells`.

        As slip of a contact sets in, the axial force falls while the race moves on. Once wear has
        brought its peak below the preload, the race moves until the force has risen again. Returns
        None where the force does not fall: there is no fold. Without a state the bearing stays as
        it is.

        farthest: place of the race to which a solve has jumped; only a state that lies nearer is
            returned, whether or not the force falls before it [m].
        D: worn ball diameter [m].
        """
        held = copy.copy(self)
        held._return_to(start)
        held.races = tuple(held._unworn_race(k) for k in range(2))
        held.state, held._work = state_work(), None
        left, step, has_fallen = 0.0, 0.0, False
        for _ in range(_MOST_FOLD_STEPS):
            delta_a = held.seat.delta_a + np.copysign(step, left)
            if farthest is not None and delta_a >= farthest:
                return None
            there = replace(p, preload=p.preload._replace(constant_force=False, delta_a=delta_a))
            held.seat, held.u, _, _ = held._state_in_cells(there, D, wear)
            if held.seat.status != code.OK:
                return None
            before, left = left, p.preload.F_x - seat_force(p.g, held.seat)
            if left * before < 0.0:
                break
            has_fallen = has_fallen or abs(left) > abs(before) > 0.0
            step = _FOLD_STEP * max(held.seat.inner.approach, held.seat.outer.approach)
        else:
            return None
        if farthest is None and not has_fallen:
            return None
        state = held._state_in_cells(p, D, wear)
        if state[0].status != code.OK:
            return None
        vars(self).update(vars(held))
        return state

    def _return_to(self, start: _Start) -> None:
        """Takes places, motion and cells of a start, with the pressures that these have now."""
        self.seat, self.u = start.seat, start.u
        self.races, self.ends, self.rows_added = start.races, start.ends, start.rows_added

    def _reset_pressures(self) -> None:
        """Resets pressures and slopes, which a failed solve has changed."""
        for race in self.races:
            np.copyto(race.pressure, race.cells.fresh)
        self.state.slope.fill(0.0)

    def stop_wear(self) -> None:
        """Keeps the present wear in the next solves, which may be at any speed."""
        if self.wears:
            self.wears = False
            self._keep_start(self.problem)

    def _keep_start(self, p: ThrustProblem) -> None:
        """Keeps the last state as a start at nearby speeds, if nothing wears."""
        if not self.wears:
            self.starts[p.op.omega_i - p.op.omega_o] = self._present_start()

    def _present_start(self) -> "_Start":
        """Returns what the next solve starts from, with its arrays copied."""
        races = tuple(race._replace(pressure=race.pressure.copy()) for race in self.races)
        return _Start(self.seat, self.u.copy(), self.reference, races, self.ends, self.rows_added)

    def _start_from_nearest(self, p: ThrustProblem, wear: WornDepths) -> None:
        """Sets the state at the nearest speed as the start, with its motion scaled by the speeds.

        A race that is held and comes to rest starts where its grooves are even: its contacts lose
        most of their load there, far from any other state.
        """
        self.even = code.OK
        now = p.op.omega_i - p.op.omega_o
        then = min(self.starts, key=lambda speed: abs(speed - now))
        near = self.starts[then]
        self.races = tuple(race._replace(pressure=race.pressure.copy()) for race in near.races)
        self.ends, self.rows_added = near.ends, near.rows_added
        self.seat, self.u, self.reference = near.seat, near.u.copy(), near.reference
        self.state.slope.fill(0.0)
        if then and (now or p.preload.constant_force):
            self.u *= now / then
        elif then or now:  # of a state at rest nothing moves
            self._start_where_worn(p, wear)
            if not then:
                self.seat, self.reference = near.seat, near.reference

    def _start_through_grooves(
        self, status: int, p: ThrustProblem, D: float, wear: WornDepths
    ) -> bool:
        """Sets as the start the state reached through grooves from even to worn ones.

        Returns True: the solve may be tried again.
        """
        self.even = self._start_where_worn(p, wear)
        self._reset_pressures()
        mean, share, step = self.reference[:, None], 0.0, _FIRST_ON_THE_WAY
        for _ in range(_MOST_ON_THE_WAY):
            next_share = min(share + step, 1.0)
            pressures = [race.pressure.copy() for race in self.races]
            grooves = mean + next_share * (wear.grooves - mean)
            seat, u, _, _ = self._state_in_cells(p, D, replace(wear, grooves=grooves))
            if seat.status not in _FAR:
                self.seat, self.u, share, step = seat, u, next_share, 2.0 * step
                if share == 1.0:
                    break
                self._start_at_present_loads(code.OK, p, D, wear)
                continue
            step *= 0.5
            if step < _LEAST_ON_THE_WAY:
                break
            for race, pressure in zip(self.races, pressures, strict=True):
                if race.pressure.shape == pressure.shape:
                    np.copyto(race.pressure, pressure)
        return True

    def _start_evenly(self, p: ThrustProblem, D: float) -> ThrustCase:
        """Solves a bearing with the same wear, but even, and sets its state as the start."""
        even = p.solve(D - self.reference.sum())
        if even.status == code.OK:
            self.seat, self.u = seat_of_case(even, p.g, D, self.reference[1]), even.u[:4].copy()
        return even

    def _start_where_worn(self, p: ThrustProblem, wear: WornDepths) -> int:
        """Sets as the start the state in even grooves; returns the status of its solve.

        The even grooves have the mean depth of the worn ones over the contacts, by the load of
        Hertz. Where such a bearing has no state, they are half as deep.
        """
        D, arcs, depths = p.g.D0 - self.loss - wear.ball, self._arcs(wear), np.zeros(2)
        self.reference, status = depths, code.OK
        for k in range(_ROUNDS):
            even = self._start_evenly(p, D)
            if even.status != code.OK:
                if k == 0:
                    return even.status
                status, self.reference = even.status, 0.5 * (self.reference + depths)
                continue
            if status != code.OK:
                break
            depths = self.reference
            self.reference = np.array([self._mean_depth(p, arcs, even, k) for k in range(2)])
        self._start_evenly(p, D)
        return status

    def _mean_depth(
        self, p: ThrustProblem, arcs: tuple[Arc, Arc], even: ThrustCase, k: int
    ) -> float:
        """Returns the mean depth of groove k over a contact, by the load of Hertz [m]."""
        major, angle = even.contacts[k, [MAJOR, ANGLE]].tolist()
        places = major * _ACROSS + self.shift(k, angle, p.g)
        return float(_SHAPE @ arc_values(arcs[k], places))

    def start_ahead(self, before: WornPoint, now: WornPoint, share: float) -> None:
        """Sets the start of the next solve by extrapolation from two states.

        Beyond `LONGEST_AHEAD` the start stays as it is.

        share: of their difference, beyond the second one.
        """
        if share <= LONGEST_AHEAD:
            old, new = before.seat, now.seat
            self.seat = new._replace(
                X1=new.X1 + share * (new.X1 - old.X1),
                X2=new.X2 + share * (new.X2 - old.X2),
                delta_a=new.delta_a + share * (new.delta_a - old.delta_a),
            )
            self.u = now.u + share * (now.u - before.u)
            self.slip_shares = now.slip[:, _SLIP_SHARE]

    def _state_in_cells(self, p: ThrustProblem, D: float, wear: WornDepths) -> _SolvedState:
        """Returns seat, motion, races and friction buffers, with the cells that the state needs.

        Cells are added until the contacts fit, `_MOST_WIDENINGS` times at most. Sets `loaded`.
        """
        arcs, bare = self._arcs(wear), [UNWORN_ARC, UNWORN_ARC]
        bare_friction = AS_WITH_FILM if self.films is None else self.films.bare_friction
        if bare_friction >= 0.0:
            shares = [self.bare(wear, k) for k in range(2)]
            bare = list(map(depth_spline, self.arc, self.arc_step, shares))
        for _ in range(_MOST_WIDENINGS):
            races = tuple(
                race._replace(groove=arcs[k], uncovered=bare[k], without=bare_friction)
                for k, race in enumerate(self.races)
            )
            work = self._friction_work(p, races)
            seat, u = self._state(p, D, races, work)
            self.loaded = [race.cells.X[loaded_ends(race.pressure)] for race in races]
            is_state = seat.status in (code.OK, code.BEYOND_GROOVE)
            if not (is_state and self._widen_cells(seat.status)):
                break
        return seat, u, races, work

    def _state(
        self, p: ThrustProblem, D: float, races: tuple[WornRace, ...], work: FrictionWork
    ) -> tuple[WornSeat, np.ndarray]:
        """Returns seat and motion, solved from the last ones.

        Where the race is held too far from there, it moves in several steps, in each of which the
        ball moves half as far.
        """
        held = not p.preload.constant_force
        state = self.state._replace(balance=ROUGH) if self.on_the_way else self.state
        way = p.preload.delta_a - self.seat.delta_a if held else 0.0
        kept = [race.pressure.copy() for race in races]
        for moves in (1, _MOVES) if way != 0.0 else (1,):
            seat, u = self.seat, self.u.copy()
            for race, pressure in zip(races, kept, strict=True):
                np.copyto(race.pressure, pressure)
            for left in range(moves - 1, -1, -1):
                delta_a = p.preload.delta_a - way * left / moves if held else seat.delta_a
                X1 = seat.X1 + 0.5 * (delta_a - seat.delta_a)
                there = p.preload._replace(delta_a=delta_a)
                seat = worn_state(
                    p.bearing(D)._replace(preload=there), races, self.reference, p.rule, work,
                    state, seat._replace(delta_a=delta_a, X1=X1), u, *_NO_MOVES,
                )  # fmt: skip
                if seat.status != code.OK:
                    break
            if seat.status not in _FAR:
                break
        return seat, u

    def _is_on_grids(self, seat: WornSeat) -> bool:
        """Returns whether both loaded contacts lie on the grids of depths."""
        for k, (ends, force) in enumerate(zip(self.loaded, (seat.inner, seat.outer), strict=True)):
            reach = force.a * ends
            if np.abs(reach + self.shift(k, force.alpha, self.problem.g)).max() > self.arc[k, -1]:
                return False
        return True

    def _arcs(self, wear: WornDepths) -> tuple[Arc, Arc]:
        """Returns the depths of the inner and the outer groove as splines along their arcs."""
        inner, outer = (
            depth_spline(*arc) for arc in zip(self.arc, self.arc_step, wear.grooves, strict=True)
        )
        return inner, outer

    def _friction_work(self, p: ThrustProblem, races: tuple[WornRace, ...]) -> FrictionWork:
        """Returns buffers of friction for the cells of both races, new ones if these have grown."""
        n, rows = (max(race.pressure.shape[k] for race in races) for k in (1, 0))
        size = n, rows, most_points(p.rule), p.rule.across.size
        if self._work is None or size != self._work[0]:
            self._work = size, friction_work(p.rule, n, rows)
        return self._work[1]

    @property
    def spread(self) -> float:
        """Returns the rms wander of the track over the edge of a film, in steps of the arcs."""
        return max(self.wander, LEAST_WANDER) / ARC_STEP

    def bare(self, wear: WornDepths, k: int) -> np.ndarray:
        """Returns the shares (arcs,) of groove k on which no film is left [1]; only with films."""
        assert self.films is not None
        return self.films.bare(wear.grooves[k], 0.5 * wear.ball, self.spread)

    def at_cells(
        self, values: np.ndarray, k: int, x: np.ndarray, alpha: float, g: Geometry
    ) -> np.ndarray:
        """Returns shares given over the arc of groove k at places x along its contact [1].

        The geometry is that of the state, which may be warmer than the start.
        """
        arc = depth_spline(self.arc[k], self.arc_step[k], values)
        return np.clip(arc_values(arc, x + self.shift(k, alpha, g)), 0.0, 1.0)

    def shift(self, k: int, alpha: float, g: Geometry) -> float:
        """Returns the place on the arc of groove k of a contact's middle [m].

        It is S - x, place on the arc less that in the contact: `arc_shift` in plain Python.
        """
        return SIDES[k] * (g.r_i, g.r_o)[k] * (alpha - float(self.angle[k]))

    def count_from(self, point: WornPoint) -> None:
        """Sets the depths from which wear is counted to those of the contacts in a state.

        Each contact then has the approach of its load, and the cells fit it.
        """
        self.reference = np.array(
            [
                reference + force.approach - contact_approach(force.hertz.K, force.Q)
                for reference, force in zip(self.reference, point.forces, strict=True)
            ]
        )

    def rate(self, point: WornPoint, ball: float, race: float, scene: Scene) -> WornDepths:
        """Returns the wear per second in a state, in the form of depths [m/s] (Eqs. 73-74).

        ball, race: K_s/H [1/Pa], where films and running in do not determine them.
        scene: with the temperatures of the state.
        """
        g, D = point.problem.g, point.D
        grooves, off_ball = np.zeros_like(self.arc), point.slip[:, 0].copy()
        for k, force in enumerate(point.forces):
            x, qv = point.x[k], point.qv_along[k]
            places = x + self.shift(k, force.alpha, g)
            wear = spread_by_wander(self.arc[k], places, qv, self.wander * self.major[k])
            factor: float | np.ndarray = race
            if self.films is not None:
                at_cells, factor = self._film_factors(self.films, point, k, scene)
                total = qv.sum()
                if total > 0.0:  # else nothing turns
                    off_ball[k] *= (qv * (at_cells / ball)).sum() / total
            grooves[k] = g.n_balls * factor * wear / (2.0 * np.pi * point.track[k])
        return WornDepths(float(2.0 * ball * off_ball.sum() / (np.pi * D * D)), grooves)

    def _film_factors(
        self, films: WornFilms, point: WornPoint, k: int, scene: Scene
    ) -> tuple[np.ndarray, np.ndarray]:
        """Returns K_s/H in contact k: of the ball at its cells, and of the race along its arc.

        scene: with the temperatures of the state.
        """
        force = point.forces[k]
        hertz = force.hertz
        # of the unworn contact, as those of the tests are
        pressure = PEAK_OVER_MEAN * force.Q ** (1.0 / 3.0) / (np.pi * hertz.c_a * hertz.c_b)
        of_test = float(pressure), float(contact_temperatures(scene)[k])
        depth, on_ball = point.wear.grooves[k], 0.5 * point.wear.ball
        covered = films.cover_of_race(depth, self.spread)
        _, of_race = films.factors(covered, depth, on_ball, *of_test)
        covered = self.at_cells(covered, k, point.x[k], force.alpha, point.problem.g)
        of_ball, _ = films.factors(covered, covered, on_ball, *of_test)
        return of_ball, of_race

    def lengths(self, point: WornPoint) -> np.ndarray:
        """Returns the approaches (2,) of ball and grooves as they were when new [m]."""
        return self._lengths(point.seat, point.problem.g, point.D)

    @staticmethod
    def _lengths(seat: WornSeat, g: Geometry, D: float) -> np.ndarray:
        """Returns the approaches (2,) of a ball of diameter D [m] and grooves as when new [m]."""
        R = 0.5 * D
        A1, A2 = groove_distance(g, 0.0, seat.delta_a, 0.0, 0.0, 0.0)
        inner = np.hypot(A1 - seat.X1, A2 - seat.X2) - (g.r_i - R)
        return np.array([inner, np.hypot(seat.X1, seat.X2) - (g.r_o - R)])

    def gap_at_edge(self, point: WornPoint) -> np.ndarray:
        """Returns the gaps A a^2 (2,) of the unworn bodies at the edge of each ellipse [m]."""
        pairs = zip(self.races, point.forces, strict=True)
        return np.array([edge_gap(race.cells.log_kappa, force.approach) for race, force in pairs])

    def axial_stiffnesses(self, point: WornPoint) -> np.ndarray:
        """Returns dynamic and quasi-static stiffness of all balls in the last state (2,) [N/m].

        Small moves of the places give the direction in which the balls follow the race; longer
        ones, in which single cells that come into contact do not show, give the stiffness. NaN
        where a place nearby has no state.
        """
        seat = point.seat
        size = max(seat.inner.approach, seat.outer.approach)
        small = SMALL * size
        slopes = np.moveaxis(self._force_changes(point, small * np.eye(3)), 0, 2) / small
        others = slopes[:, _NOT_RACE][:, :, _NOT_RACE]
        ways = np.ones((2, 3))
        ways[:, _NOT_RACE] = -_solutions(others, slopes[:, _NOT_RACE, _RACE])
        along = self._force_changes(point, NEARBY * size * ways) / (NEARBY * size)
        along = along[[0, 1], [0, 1]]  # each by its own way
        left = _solutions(others, along[:, _NOT_RACE])
        axial = along[:, _RACE] - (slopes[:, _RACE, _NOT_RACE] * left).sum(axis=1)
        return point.problem.g.n_balls * axial

    def _force_changes(self, point: WornPoint, moves: np.ndarray) -> np.ndarray:
        """Returns the changes (n, 2, 3) of the forces of a state by moves (n, 3) of its places [m].

        NaN where a place nearby has no state.
        """
        p, changes = point.problem, np.empty((len(moves), 2, 3))
        work = self._friction_work(p, self.worn_races)
        seat = worn_state(
            p.bearing(point.D), self.worn_races, self.worn_reference, p.rule, work, self.state,
            point.seat, point.u, moves, changes,
        )  # fmt: skip
        return changes if seat.status == code.OK else np.full_like(changes, np.nan)

    def _widen_cells(self, status: int) -> bool:
        """Adds cells where a contact has grown to the ends or edges of its own.

        Returns whether cells were added. A race that gets more of them starts with the pressures of
        its unworn contact.

        status: of the last solve with these cells.
        """
        races, self.ends, self.rows_added = [], self.ends.copy(), self.rows_added.copy()
        for k, (race, ends) in enumerate(zip(self.races, self.loaded, strict=True)):
            X = race.cells.X
            spare = LAST_CELL if status == code.NOT_CONVERGED else SPARE
            is_long = ends.size and np.abs(ends).max() > X[-1] - (spare - 1.0) * (X[1] - X[0])
            is_wide = status != code.OK and race.pressure[-2:].any()
            if not self.wears:
                is_long = is_long and WIDER * self.ends[k] <= MOST_ENDS
                is_wide = is_wide and self.rows_added[k] < MOST_ROWS
            if is_long:
                self.ends[k] *= WIDER
            if is_wide:
                self.rows_added[k] += ROWS
            races.append(self._unworn_race(k) if is_long or is_wide else race)
        is_wider = any(new is not old for new, old in zip(races, self.races, strict=True))
        self.races = tuple(races)
        return is_wider


def _track_radii(p: ThrustProblem, seat: WornSeat, D: float) -> np.ndarray:
    """Returns the radii (2,) of the middles of both contacts, from the axis of the bearing [m]."""
    r = p.g.R_o + seat.X2
    races = zip(SIDES, (p.g.r_i, p.g.r_o), (seat.inner, seat.outer), strict=True)
    heights = [
        s * middle_height(profile(r_g, 0.5 * D, force.a)) * np.cos(force.alpha)
        for s, r_g, force in races
    ]
    return r + np.array(heights)


def edge_gap(log_kappa: float, approach: float) -> float:
    """Returns the gap A a^2 of unworn bodies at the edge of the ellipse [m].

    log_kappa: logarithm of the ratio of the semi-axes.
    approach: of the bodies [m].
    """
    return float(elliptic_integrals(float(np.exp(-log_kappa)))[2] * approach)


def loaded_ends(pressure: np.ndarray) -> np.ndarray:
    """Returns the columns of the first and last cell with pressure; empty if there is none."""
    columns = np.flatnonzero(pressure.any(axis=0))
    return columns[[0, -1]] if columns.size else columns


def _solutions(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Returns the solutions (n, k) of n systems of equations, A (n, k, k) and b (n, k)."""
    return np.linalg.solve(A, b[..., None])[..., 0]
