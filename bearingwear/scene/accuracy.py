"""The block `model` of a scene, and the presets of accuracy: what `model.accuracy` sets.

Each preset states the relative error of total QV it is meant for. What they really give and take is
measured by the study of accuracy (docs/accuracy.md); a single key in a scene overrides its preset.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, setting

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

ACCURACY = "model.accuracy"
"""The key that sets the defaults of others."""

FIDELITIES = ("auto", "race_control", "steady", "dynamic")
CONTACTS = ("auto", "paper", "hertz", "worn")
SLIP_OVER = ("line", "ellipse")
NORMAL_BALANCES = ("frictionless", "with_traction")


class AccuracyPreset(NamedTuple):
    """Settings of accuracy that belong together, under the names of the scene's keys."""

    error: float  # of total QV, relative: what it is meant for
    quadrature: str
    strips: int
    over_ellipse: tuple[int, int]  # strips and points across where slip is taken over the ellipse
    steady_starts: int
    slip_regularisation_m_s: float
    dynamic_tolerance: float
    simulated_turns: float
    settled_drift: float
    tolerance: float

    def keys(self, slip_over: str, cage_wears: bool = False) -> dict[str, float | int | str]:
        """Returns the settings by their whole keys, such as `model.tolerance`.

        slip_over: `line` or `ellipse`, where slip is evaluated.
        cage_wears: whether the wear of a cage is computed, which limits the step tolerance.
        """
        ellipse_strips, points_across = self.over_ellipse
        is_over_ellipse = slip_over == "ellipse"
        step_tolerance = self.dynamic_tolerance
        if cage_wears:
            step_tolerance = min(step_tolerance, CAGE_TOLERANCE)
        return {
            REGULARISATION: self.slip_regularisation_m_s,
            "model.quadrature": "split" if is_over_ellipse else self.quadrature,
            "model.strips": ellipse_strips if is_over_ellipse else self.strips,
            "model.steady_starts": self.steady_starts,
            "model.dynamic_tolerance": step_tolerance,
            "model.simulated_turns": self.simulated_turns,
            "model.settled_drift": self.settled_drift,
            "model.tolerance": self.tolerance,
            "model.points_across": points_across,
        }


REGULARISATION = "friction.slip_regularisation_m_s"

CAGE_TOLERANCE, CAGE_ERROR = 1e-3, 0.1
"""Step tolerance at which wear of a cage is right to an error, where it has one motion. At 1e-2 its
power on the land is 1.6 times as much, and starts end in other motions (docs/verification.md)."""

# On a line the reference is brute force: its points know nothing of where the slip turns round.
# Over the ellipse that takes 1e5 points. Other steady states are sought from many more starts.
PRESETS = (
    AccuracyPreset(
        error=5e-2,
        quadrature="split",
        strips=24,
        over_ellipse=(20, 4),
        steady_starts=2,
        slip_regularisation_m_s=3e-4,
        dynamic_tolerance=1e-1,
        simulated_turns=6.0,
        settled_drift=1e-2,
        tolerance=1e-4,
    ),
    AccuracyPreset(
        error=2e-2,
        quadrature="split",
        strips=32,
        over_ellipse=(20, 4),
        steady_starts=4,
        slip_regularisation_m_s=2e-4,
        dynamic_tolerance=3e-2,
        simulated_turns=12.0,
        settled_drift=5e-3,
        tolerance=1e-5,
    ),
    AccuracyPreset(
        error=5e-3,
        quadrature="split",
        strips=50,
        over_ellipse=(20, 8),
        steady_starts=4,
        slip_regularisation_m_s=1e-4,
        dynamic_tolerance=1e-2,
        simulated_turns=40.0,
        settled_drift=1e-3,
        tolerance=1e-6,
    ),
    AccuracyPreset(
        error=1e-3,
        quadrature="split",
        strips=80,
        over_ellipse=(24, 8),
        steady_starts=8,
        slip_regularisation_m_s=3e-5,
        dynamic_tolerance=1e-3,
        simulated_turns=100.0,
        settled_drift=1e-3,
        tolerance=1e-7,
    ),
    AccuracyPreset(
        error=1e-4,
        quadrature="gauss",
        strips=1000,
        over_ellipse=(48, 24),
        steady_starts=64,
        slip_regularisation_m_s=1e-5,
        dynamic_tolerance=1e-5,
        simulated_turns=160.0,
        settled_drift=1e-4,
        tolerance=1e-8,
    ),
)
NAMED_PRESETS = {"draft": PRESETS[0], "standard": PRESETS[2], "reference": PRESETS[-1]}
STANDARD = NAMED_PRESETS["standard"]


def slip_region(contact: str, slip_over: str | None) -> str:
    """Returns where slip is evaluated: over the `line` or the `ellipse`.

    contact, slip_over: keys of `model`; if `slip_over` is None, the contact model decides.
    """
    return slip_over or ("line" if contact == "paper" else "ellipse")


def accuracy_preset(accuracy: str | float) -> AccuracyPreset:
    """Returns the preset of a name, or the cheapest one that is meant for a target error.

    For an error below that of all presets, it is the most accurate one.

    accuracy: a key of `NAMED_PRESETS`, or the relative error of total QV.
    """
    if isinstance(accuracy, str):
        return NAMED_PRESETS[accuracy]
    return next((preset for preset in PRESETS if preset.error <= accuracy), PRESETS[-1])


@keyed
class Model:
    """What overrides the program's own choice of model and accuracy.

    `accuracy` decides when a scene is read (`bearingwear.scene.read`); of a Model built in Python
    it changes nothing.
    """

    fidelity: str = setting("Bearing model", choices=FIDELITIES, default="auto")
    # fmt: off
    contact: str = setting("Contact model: paper evaluates slip on the centre line of the ellipse "
        "and neglects traction in the normal force balance; hertz evaluates slip over the whole "
        "ellipse and includes traction; worn also computes the groove profiles in the life "
        "calculation; auto selects hertz or, if the grooves wear deeply, worn", choices=CONTACTS,
        default="auto")
    slip_over: str | None = setting("Region in which slip is evaluated (overrides model.contact)",
        choices=SLIP_OVER, default=None)
    normal_balance: str | None = setting(
        "Whether traction is included in the balance of normal forces (overrides model.contact)",
        choices=NORMAL_BALANCES, default=None)
    cage_results: bool = setting(
        "Whether to compute the motion and wear of the cage (requires the dynamic model)",
        default=False)
    accuracy: str | float = setting(
        'Preset, or target error in the total QV, which sets all keys whose default is "by '
        'model.accuracy". With cage_results or an end-of-life criterion for the cage, '
        f'model.dynamic_tolerance is at most {CAGE_TOLERANCE:g}', within="[0.0001, 0.1]",
        choices=tuple(NAMED_PRESETS), default="standard")
    strips: int = setting("Number of points or strips along each contact ellipse (with split, "
        "the maximum number, at least 20; a quarter of them lie on each side of a pure-rolling "
        "point)",
        "1", "[2, 2000]", default_by=ACCURACY, default=STANDARD.over_ellipse[0])
    points_across: int = setting(
        "Number of points across each strip if slip is evaluated over the ellipse", "1", "[1, 200]",
        default_by=ACCURACY, default=STANDARD.over_ellipse[1])
    quadrature: str = setting("Quadrature over the contact ellipse: Gauss-Legendre on each half "
        "of the major axis, Gauss-Legendre split at the pure-rolling points and refined there, or "
        "equal strips", choices=("gauss", "split", "strips"), default_by=ACCURACY, default="split")
    steady_starts: int = setting("Maximum number of starting points in the search for other steady "
        "states; a search starts only where the force along the orbit permits such a state (0: no "
        "search; steady model only)",
        "1", "[0, 10000]",
        default_by=ACCURACY, default=STANDARD.steady_starts)
    simulated_turns: float = setting("Number of shaft turns simulated (dynamic model only)", "1",
        "(0, 1e6]",
        default_by=ACCURACY, default=STANDARD.simulated_turns)
    evaluated_turns: float | None = setting("Number of shaft turns at the end of the run over "
        "which results are averaged (if omitted, half of the run; at most model.simulated_turns)",
        "1", "(0, 1e6]", default=None)
    history_points_per_turn: int = setting("Number of history points per shaft turn (0: no "
        "histories; at most a million points in total; dynamic model only)", "1",
        "[0, 10000]", default=20)
    integrator: str = setting(
        "Time integration method: linearly implicit (rosenbrock), or explicit, as in the "
        "published model (runge_kutta)",
        choices=("rosenbrock", "runge_kutta"), default="rosenbrock")
    dynamic_solution: str = setting("Solution method of the dynamic model: march integrates in "
        "time until the motion settles; periodic solves directly for the periodic motion "
        "(identical balls, no cage, one stationary or rotating load); auto uses periodic where it "
        "applies and no history is requested",
        choices=("auto", "periodic", "march"), default="auto")
    dynamic_tolerance: float = setting(
        "Allowed error in slip velocities over one time step, relative to the mean slip (dynamic "
        "model only)", "1",
        "[1e-9, 1]", default_by=ACCURACY, default=STANDARD.dynamic_tolerance)
    settled_drift: float = setting("Expected further relative change in QV and wear below which "
        "a run is considered settled and ends (dynamic model only)",
        "1", "(0, 1]", default_by=ACCURACY,
        default=STANDARD.settled_drift)
    land_stiffness_factor: float = setting(
        "Factor applied to the assumed stiffness of the guiding land, to show its influence", "1",
        "(0, 1000]", default=1.0)
    life_steps: int = setting(
        "Approximate number of wear steps in a life calculation with the dynamic model; each step "
        "requires a short run", "1",
        "[2, 10000]", default=12)
    life_run_in_turns: float = setting("Number of shaft turns before the first wear rates are "
        "evaluated in a life calculation with the dynamic model, to let the influence of the "
        "cage's initial position decay (0 without a cage)",
        "1", "[0, 1e6]",
        default=200.0)
    tolerance: float = setting("Relative error tolerance for the computed life", "1",
        "[1e-12, 0.1]", default_by=ACCURACY, default=STANDARD.tolerance)
    # fmt: on

    @property
    def slip_region(self) -> str:
        """Returns where slip is evaluated: over the `line` or the `ellipse` of a contact."""
        return slip_region(self.contact, self.slip_over)

    @property
    def includes_traction(self) -> bool:
        """Whether the balance of normal forces includes traction, if the solver can include it."""
        if self.normal_balance:
            return self.normal_balance == "with_traction"
        return self.contact != "paper"

    @property
    def averaged_turns(self) -> float:
        """Returns the number of turns at the end of a dynamic run that are averaged.

        By default it is half of the run.
        """
        return self.evaluated_turns or 0.5 * self.simulated_turns


MOST_HISTORY_POINTS = 1_000_000
"""Most points of a history: histories are held in memory."""


def check_model(scene: Scene) -> None:
    """Refuses settings of `model` that contradict each other or the scene, and long histories."""
    if scene.model.cage_results and scene.cage is None:
        raise SceneError("model.cage_results", "got true; only allowed with a cage", ("cage",))
    turns, averaged = scene.model.simulated_turns, scene.model.evaluated_turns
    if averaged is not None and averaged > turns:
        raise SceneError(
            "model.evaluated_turns",
            f"got {averaged:g} with {turns:g} simulated turns, expected a number <= {turns:g}",
            ("model.simulated_turns",),
        )
    points = scene.model.history_points_per_turn
    if points * turns > MOST_HISTORY_POINTS:
        raise SceneError(
            "model.history_points_per_turn",
            f"got {points} with {turns:g} simulated turns, expected a whole number <= "
            f"{math.floor(MOST_HISTORY_POINTS / turns)}",
            ("model.simulated_turns",),
        )
