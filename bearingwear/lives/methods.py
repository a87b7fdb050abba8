"""How a life takes its steps: four methods for `bearingwear.lives.follow`."""

import math
from collections.abc import Callable, Sequence
from itertools import takewhile
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.follow import Life, LifeStep, Method, Node, Wearing

SHORTEST_STEP = 1e-6  # over the first step
WELL_WITHIN = 0.02  # share of the allowed error below which the next step is twice as long
ENOUGH = 1e3  # times the shortest step; a step as short as this is taken whatever its error
TINY_TIME = 1e-300  # [s], so that an allowed error is above 0 at the start
QUARTERS = (0.25, 0.5, 0.75)  # places in a step, over its length
SIMPSON = (5, 8, -1, 0, 0), (4, 16, 4, 0, 0), (4, 16, 9, 8, -1), (4, 16, 8, 16, 4), (8, 0, 32, 0, 8)
"""Weights of the five nodes of a step, over 48, in integrals of it.

The first four go up to each node after the start; the last goes to the end by every other node.
"""
_AT_NODES = np.vander((0.0, *QUARTERS, 1.0), increasing=True)  # powers 0 to 4 of their places
MOST_STRETCHED = 2.0  # of a step by Adams, over the one before; a longer one is by Heun
_SHORTENINGS = 6  # of a step that fails, each by half
_MOST_TRIALS = 8  # runs to find an end
_END_OF_RUNS = 1e-3  # error of the end of a life by runs, over the step in which it is met


class Unsolved(ArithmeticError):
    """A node within a step that was not solved."""

    def __init__(self, node: Node):
        super().__init__(node.status)
        self.node = node


class Simpson(Method):
    """Adaptive Simpson integration of the time over the loss, t = integral of d(loss)/rate(loss).

    The time to an end within a step of a quick life is the integral of the quartic through the
    inverse rates at its nodes.

    tolerance: largest relative error of the time up to the end of a step.
    first: length of the first step [m].
    farthest: loss beyond which no step leads, as the life ends there at the latest [m].
    quick: whether an end is found to the tolerance alone, and without a second solve of its step.
    """

    shortening = 0.5
    _last_step: LifeStep | None = None  # of a quick life, unless it was rough

    def __init__(self, tolerance: float, first: float, farthest: float, quick: bool):
        self.tolerance = tolerance
        self.length = first
        self.shortest = SHORTEST_STEP * first
        self.farthest, self.quick = farthest, quick
        if quick:
            self.root_tolerance = tolerance

    def at(self, x: float) -> Node:
        """Returns the node at a loss [m], without its time."""
        return self.node(x, np.array([x]), math.nan)

    def step(self, life: Life, bound: float) -> LifeStep:
        """Returns a step of four nodes, up to the first quarter that is not solved.

        The step is rough where two rules disagree on its time by more than the tolerance, unless it
        is short enough. Where they agree well, the next step is twice as long. Sets `tried_length`
        and the step that a quick life may divide.

        bound: loss that the step does not pass [m].
        """
        start = life.last
        if self._last_step and start.x < bound < self._last_step.end:
            return self._part_of_step(start, self._last_step, bound)
        h = min(self.length, bound - start.x)
        if self.farthest - start.x > self.shortest:
            h = min(h, self.farthest - start.x)
        self.tried_length = h
        end = start.x + h
        places = [start.x + share * h for share in QUARTERS]
        nodes = [self.at(x) for x in (*places, end)]
        failed = [node for node in nodes if node.status != code.OK]
        if failed:
            # the farthest failed node stands for all that follow the solved ones
            solved = takewhile(lambda node: node.status == code.OK, nodes)
            return LifeStep(end=end, nodes=[*solved, failed[-1]])
        slowness = np.array([1.0 / self.wearing.loss_rate(node) for node in (start, *nodes)])
        *times, coarse_time = (h / 48.0 * np.dot(SIMPSON, slowness)).tolist()
        # The finer rule is about 15 times better than this difference of the two.
        error = abs(times[-1] - coarse_time)
        allowed = self.tolerance * max(start.time + times[-1], TINY_TIME)
        if error < WELL_WITHIN * allowed:
            self.length = 2.0 * h
        pairs = zip(nodes, times, strict=True)
        step = LifeStep(
            end=end,
            nodes=[node._replace(time=start.time + time) for node, time in pairs],
            error=error,
            is_rough=error > allowed and h > ENOUGH * self.shortest,
        )
        self._last_step = step if self.quick and not step.is_rough else None
        return step

    def _part_of_step(self, start: Node, step: LifeStep, end: float) -> LifeStep:
        """Returns the part of a solved step up to an end within it, with the node at that end.

        The inverse rate is the quartic through the nodes of the step.

        start: node at which the step starts.
        end: loss [m].
        """
        h = step.end - start.x
        powers = np.arange(1, 6)
        slowness = np.array([1.0 / self.wearing.loss_rate(node) for node in (start, *step.nodes)])
        weights = np.linalg.solve(_AT_NODES.T, ((end - start.x) / h) ** powers / powers)
        last = self.at(end)._replace(time=start.time + h * float(weights @ slowness))
        nodes = [node for node in step.nodes if node.x < end]
        return LifeStep(end=end, nodes=[*nodes, last], error=step.error)

    def error_of_end(self, life: Life) -> float:
        """Returns the error of the time at which the end is met [s].

        It is the tolerance of the end times the whole loss of the life, over the rate at its end.
        """
        loss = life.last.x - life.nodes[0].x
        return self.root_tolerance * loss / self.wearing.loss_rate(life.last)


class RungeKutta(Method):
    """SciPy's explicit Runge-Kutta method over s, the sum of the losses of the bearings [m]:

        d(worn)/ds = d(worn)/dt / (ds/dt),    dt/ds = 1 / (ds/dt)

    tolerance: relative error of a step.
    first: length of the first step [m].
    between: places within each step, over its length, whose nodes the life keeps besides its end.
    """

    shortening = 0.25
    solver: Any = None

    def __init__(self, tolerance: float, first: float, between: Sequence[float] = QUARTERS):
        self.tolerance = tolerance
        self.initial = first
        self.shortest = SHORTEST_STEP * first
        self.length, self.between = first, between

    def node_after_event(self, node: Node) -> Node:
        """Returns the last node solved again. Resets the solver, and its step to the first one."""
        self.solver = None
        self.length = self.initial
        return super().node_after_event(node)

    def at(self, x: float) -> Node:
        """Returns the node at a sum of losses within the last step of the solver [m].

        Wear and time are those of the solver's interpolation; the bearings are solved with them.
        """
        y = self.solver.y.copy() if x == self.solver.t else self.solver.dense_output()(x)
        return self.node(x, y[:-1], float(y[-1]))

    def _derivative(self, s: float, y: np.ndarray) -> np.ndarray:
        """Returns the derivative of wear and time by the sum of the losses.

        Raises Unsolved where the bearings are not solved.

        s: sum of the losses [m].
        y: wear of all bearings [m], then the time [s].
        """
        node = self.node(s, y[:-1], float(y[-1]))
        if node.status != code.OK:
            raise Unsolved(node)
        return np.append(self.wearing.rates(node), 1.0) / self.wearing.loss_rate(node)

    def step(self, life: Life, bound: float) -> LifeStep:
        """Returns a step of the solver, with a node in its middle and one at its end.

        A stage that is not solved ends the step: it has this node alone. A new bound needs a new
        solver, which starts from the last node.

        bound: sum of the losses that the step does not pass [m].
        """
        from scipy.integrate import RK45  # loads slowly; most lives take other steps

        start = life.last
        try:
            if self.solver is None or self.solver.t_bound != bound:
                y = np.append(start.worn, start.time)
                atol = np.full(y.size, self.tolerance * self.initial)
                atol[-1] /= self.wearing.loss_rate(start)  # the last is the time, in s
                self.solver = RK45(
                    self._derivative,
                    start.x,
                    y,
                    bound,
                    rtol=self.tolerance,
                    atol=atol,
                    first_step=min(self.length, bound - start.x),
                )
            self.solver.step()
        except Unsolved as failure:
            return LifeStep(end=bound, nodes=[failure.node])
        end = self.solver.t
        return LifeStep(end=end, nodes=self.solved_at(start.x + 0.5 * (end - start.x), end))

    def kept_nodes(self, step: LifeStep) -> Sequence[Node]:
        """Returns the nodes at the places `between` in a step, then that at its end.

        Sets `length`, the first step of the next solver, to that of this one if all are solved.
        """
        start = self.solver.t_old
        nodes = [self.at(start + share * (step.end - start)) for share in self.between]
        if all(node.status == code.OK for node in nodes):
            self.length = self.solver.h_abs
        return [*nodes, step.nodes[-1]]

    def shorten(self) -> bool:
        """Drops the solver and makes the first step of the next one shorter.

        Returns whether it is still long enough.
        """
        if self.solver is not None:
            self.tried_length = self.solver.h_abs
            self.solver = None
        return super().shorten()


class InTime(Method):
    """Steps in time from the last node and the one before; a node within a step is solved once."""

    now: Any = None  # the last node
    previous: Any  # the one before, if rates are smooth from there to the last; else None
    rates: Any = None  # at the last node
    rates_before: Any  # at the one before
    nodes_by_time: dict[float, Node]  # those tried after the last node, by their time [s]
    nearest = 0.0  # `shortest`, over the longest step

    def is_smooth_between(self, before: Node, now: Node) -> bool:
        """Returns whether rates are smooth between two nodes.

        They have a jump between two nodes of the same time, where a film is gone.
        """
        return before.x < now.x

    def node_after(self, x: float) -> Node:
        """Returns the node at a time after the last one [s], solved anew."""
        raise NotImplementedError

    def at(self, x: float) -> Node:
        """Returns the node at a time after the last one [s], solved once."""
        if x not in self.nodes_by_time:
            self.nodes_by_time[x] = self.node_after(x)
        return self.nodes_by_time[x]

    def step(self, life: Life, bound: float) -> LifeStep:
        """Returns a step as long as the way to wear allows.

        It is endless, with no nodes, where no wear leads to an end. At a new node this sets
        `now`, `previous`, the rates and `longest`, and drops the `nodes_by_time`.

        bound: time that the step does not pass [s].
        """
        now = life.last
        if now is not self.now:
            self.rates_before = self.rates
            self.rates = self.wearing.rates(now)
            before = life.nodes[-2] if len(life.nodes) > 1 else None
            is_smooth = before is not None and self.is_smooth_between(before, now)
            self.previous = before if is_smooth else None
            self.now = now
            self.nodes_by_time = {}
            self.longest = self.wearing.longest_step(now, self.rates)
        if math.isinf(self.longest):
            return LifeStep(end=math.inf)
        self.shortest = self.nearest * self.longest
        return self.step_to(min(now.x + self.longest, bound))

    def step_to(self, end: float) -> LifeStep:
        """Returns a step of one node, from the last node to a time [s]."""
        return LifeStep(end=end, nodes=self.solved_at(end))


class Adams(InTime):
    """Adams-Bashforth-Moulton steps of third order, the first by Heun's method.

    A step is as long as the deepest place may wear in one. An end is found to a thousandth of its
    step; a rest of the way below 1e-4 of the longest step is not followed.
    """

    most_steps, root_tolerance, nearest = 1000, 1e-3, 1e-4

    def first(self, wearing: Wearing) -> Node:
        """Returns the node that a life begins with, with all the values that are kept."""
        node = super().first(wearing)
        return self.wearing.completed(node)

    def is_smooth_between(self, before: Node, now: Node) -> bool:
        """Returns whether rates are smooth between two nodes: no film goes or begins to go."""
        return super().is_smooth_between(before, now) and not self.wearing.bares(before, now)

    def kept_nodes(self, step: LifeStep) -> Sequence[Node]:
        """Returns the nodes of a step with all the values that are kept."""
        return [self.wearing.completed(node) for node in step.nodes]

    def step_to(self, end: float) -> LifeStep:
        """Returns a step to a time [s], halved up to `_SHORTENINGS` times until it is solved."""
        now = self.now
        for k in range(_SHORTENINGS + 1):
            step = super().step_to(now.x + 0.5**k * (end - now.x) if k else end)
            if step.nodes[0].status == code.OK:
                break
        return step

    def node_after(self, x: float) -> Node:
        """Returns the node at a time [s], by a predictor and a corrector.

        Both use the rates of the last node. Where the state after the predictor is not solved, the
        node has that state.
        """
        wearing, now, rates = self.wearing, self.now, self.rates
        h = x - now.x
        # length of the step over that before; 0 is Heun's method, without rates before
        ratio = 0.0
        rates_before = rates
        if self.previous is not None:
            stretch = h / (now.x - self.previous.x)
            wearing.start_ahead(self.previous, now, stretch)
            if stretch <= MOST_STRETCHED:
                ratio, rates_before = stretch, self.rates_before
        predictor = (h * (1.0 + 0.5 * ratio), rates), (-0.5 * h * ratio, rates_before)
        worn = wearing.worn_on(now.worn, predictor)
        predicted = Node(x, worn, wearing.middle_state(worn), x)
        if predicted.status != code.OK:
            return predicted
        share = h / (6.0 * (1.0 + ratio))
        corrector = (
            (share * (3.0 + 2.0 * ratio), wearing.rates(predicted)),
            (h * (3.0 + ratio) / 6.0, rates),
            (-share * ratio * ratio, rates_before),
        )
        worn = wearing.worn_on(now.worn, corrector)
        return Node(x, worn, wearing.state(worn), x)


class Trapezoid(InTime):
    """A predictor and the trapezoidal rule, for rates that scatter (theory.md section 13).

    most_steps: number from one event to the next after which a life is not followed further.
    """

    def __init__(self, most_steps: int):
        self.most_steps = most_steps
        self._errors: dict[float, float] = {}  # of an end, by its time [s]

    def node_after_event(self, node: Node) -> Node:
        """Returns the last node solved again, by a run from the end of that of the node."""
        return node._replace(states=self.wearing.state(node.worn, node.states))

    def node_after(self, x: float) -> Node:
        """Returns the node at a time [s] by the trapezoidal rule, from a run at a predicted wear.

        The states are those of that run, with the values that the corrected wear changes. A node
        whose run fails is returned with the predicted wear.
        """
        wearing, now, rates = self.wearing, self.now, self.rates
        h = x - now.x
        mean_rates = rates
        if self.previous is not None:
            slope = (rates - self.rates_before) / (now.x - self.previous.x)
            mean_rates = np.maximum(rates + 0.5 * h * slope, 0.0)  # nothing grows back
        worn = now.worn + h * mean_rates
        node = Node(x, worn, wearing.state(worn, now.states), x)
        if node.status != code.OK:
            return node
        worn = now.worn + 0.5 * h * (rates + wearing.rates(node))
        return node._replace(worn=worn, states=wearing.with_worn(node.states, worn))

    def root(self, margin: Callable[[float], float], a: Node, b: Node) -> float:
        """Returns a time [s] between two nodes at which a margin is about zero, by false position.

        The search is also over after `_MOST_TRIALS` runs, or at one that fails. It returns the last
        time whose run was solved, or that of node b. Keeps its error for `error_of_end`. A margin
        scatters from run to run, so that a closer search would have no meaning.

        margin: of a time; positive at that of node a, zero or negative at that of node b.
        """
        low, high, best = a.x, b.x, b.x
        low_margin, high_margin = margin(low), margin(high)
        for _ in range(_MOST_TRIALS):
            slope = (low_margin - high_margin) / (high - low)
            x = low + low_margin / slope
            self._errors.setdefault(b.x, b.x - x)
            if self.at(x).status != code.OK:
                break
            best = x
            x_margin = margin(x)
            self._errors[x] = abs(x_margin) / slope
            if self._errors[x] <= _END_OF_RUNS * (b.x - a.x):
                break
            if x_margin <= 0.0:
                high, high_margin = x, x_margin
            else:
                low, low_margin = x, x_margin
        return best

    def error_of_end(self, life: Life) -> float:
        """Returns the error of the time at which the end is met [s]: its margin over its slope."""
        return self._errors[life.last.x]
