"""Existence and stability of the periodic motion of a scene (theory.md section 22)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene

LIKE = 1e-9  # of the diameter: balls that differ by less are alike

LEAST_GROWTH = 1e-5
"""Growth per turn above which a motion is unstable; `tangents` cannot resolve less."""

GROWTHS = ("spacing_growth_per_turn", "disturbance_growth_per_turn")
"""Variables of the two fields of `GrowthRates`."""

_SMALLEST = 1e-300  # multiplier: others may underflow


def why_not_periodic(scene: Scene) -> str:
    """Returns why a scene has no periodic motion, in words; empty if nothing rules one out.

    scene: with its cage only if that is solved.
    """
    operation = scene.operation
    has_fixed_load = any(operation.radial_load_N) or operation.tilt_mrad
    if scene.cage is not None:
        return "a cage"
    # losses are in um, the diameter in mm
    if 1e-3 * np.ptp(scene.wear.ball_diameter_loss_um) > LIKE * scene.bearing.ball_diameter_mm:
        return "unequal ball diameters"
    if has_fixed_load and operation.rotating_load_N:
        return "stationary and rotating loads together"
    if not has_fixed_load and not operation.rotating_load_N:
        return "pure thrust"
    return ""


def seeks_periodic(scene: Scene) -> bool:
    """Returns whether a periodic motion is sought: on request, or if no history is requested."""
    solution = scene.model.dynamic_solution
    if solution == "auto":
        return not (scene.model.history_points_per_turn or why_not_periodic(scene))
    return solution == "periodic"


def check_solution(scene: Scene) -> None:
    """Raises NotAvailable if a scene requests a periodic motion and has none."""
    why = why_not_periodic(scene)
    if scene.model.dynamic_solution == "periodic" and why:
        raise NotAvailable(
            f"{scene.name}: model.dynamic_solution: got periodic with {why}, expected auto or march"
        )


@dataclass(frozen=True)
class GrowthRates:
    """Rates at which small disturbances of a periodic motion grow, per shaft turn.

    If the race were held, the phase of each ball would not change: there would be n multipliers of
    1, one of which means that the motion may begin at any instant. The race couples the balls,
    which makes those of their spacing a little larger or smaller. All others belong to slip and
    spin.
    """

    spacing: float  # of the balls' even spacing, the fastest
    slip_and_spin: float  # of all others, the slowest to die out

    @classmethod
    def of(cls, multipliers: np.ndarray, balls: int, turns: float) -> "GrowthRates":
        """Returns the rates from the multipliers of disturbances in a passing of a number of turns.

        A passing moves the phases on by a ball: multipliers of the spacing lie near the roots of 1.
        """
        others = list(multipliers)
        phases = []
        for root in np.exp(2j * np.pi * np.arange(balls) / balls):
            nearest = int(np.argmin(np.abs(np.array(others) - root)))
            phases.append(others.pop(nearest))

        def largest_rate(group: list[complex]) -> float:
            """Returns the growth per turn by the largest of some multipliers [1/turn]."""
            return float(np.log(np.abs(group).max(initial=_SMALLEST))) / turns

        # the first root is 1: a shift in time, which neither grows nor decays
        return cls(spacing=largest_rate(phases[1:]), slip_and_spin=largest_rate(others))

    @property
    def values(self) -> dict[str, float]:
        """Returns the rates as result variables."""
        return dict(zip(GROWTHS, (self.spacing, self.slip_and_spin), strict=True))

    @property
    def sentence(self) -> str:
        """Returns the stability in words."""
        if self.slip_and_spin > LEAST_GROWTH:
            return (
                f"unstable: disturbances grow by a factor of e in {_time_words(self.slip_and_spin)}"
            )
        spacing_words = (
            f"grow by a factor of e in {_time_words(self.spacing)}"
            if self.spacing > LEAST_GROWTH
            else "do not grow"
        )
        return (
            f"disturbances decay by a factor of e in {_time_words(self.slip_and_spin)}; "
            f"disturbances to the even ball spacing {spacing_words}"
        )


def _time_words(rate: float) -> str:
    """Returns the time in which a disturbance changes by a factor of e, in words.

    rate: at which it grows or decays [1/turn].
    """
    return f"{float(f'{1.0 / abs(rate):.2g}'):g} turns"


def instability(scene: Scene, values: Mapping[str, float]) -> dict[str, str] | None:
    """Returns `phrase` and `advice` for an unstable periodic motion; None for any other motion.

    Growth of the spacing counts only without a cage, which would keep the balls apart.

    values: result variables, which have those of `GROWTHS` if the motion is periodic.
    """
    spacing, disturbances = (values.get(name, -np.inf) for name in GROWTHS)
    if disturbances > LEAST_GROWTH:
        phrase = f"disturbances grow by a factor of e in {_time_words(disturbances)}"
        return {"phrase": phrase, "advice": "set model.dynamic_solution: march"}
    if spacing > LEAST_GROWTH and scene.cage is None:
        phrase = (
            "without a cage, disturbances to the even ball spacing grow by a factor of e in "
            f"{_time_words(spacing)}"
        )
        return {"phrase": phrase, "advice": "add a cage to the scene"}
    return None
