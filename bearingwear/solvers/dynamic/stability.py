"""Whether a scene has a periodic motion, and whether it lasts (theory.md section 22)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene

LIKE = 1e-9  # of the diameter: balls that differ by less are alike

LEAST_GROWTH = 1e-5
"""Growth a turn from which a motion is unstable: less is left open by `tangents`."""

GROWTHS = ("spacing_growth_per_turn", "disturbance_growth_per_turn")
"""Variables of the two fields of `GrowthRates`."""

_NOTHING = 1e-300  # the least of multipliers: all others may underflow


def why_not_periodic(scene: Scene) -> str:
    """Why a scene (with its cage if that is solved) has no periodic motion; empty if it has one."""
    operation = scene.operation
    standing = any(operation.radial_load_N) or operation.tilt_mrad
    if scene.cage is not None:
        return "a cage"
    if 1e-3 * np.ptp(scene.wear.ball_diameter_loss_um) > LIKE * scene.bearing.ball_diameter_mm:
        return "unequal ball diameters"
    if standing and operation.rotating_load_N:
        return "stationary and rotating loads together"
    if not standing and not operation.rotating_load_N:
        return "pure thrust"
    return ""


def is_found_periodic(scene: Scene) -> bool:
    """Whether a periodic motion is looked for: on request, or where no history is asked for."""
    asked = scene.model.dynamic_solution
    if asked == "auto":
        return not (scene.model.history_points_per_turn or why_not_periodic(scene))
    return asked == "periodic"


def check_solution(scene: Scene) -> None:
    if scene.model.dynamic_solution == "periodic" and (why := why_not_periodic(scene)):
        raise NotAvailable(
            f"{scene.name}: model.dynamic_solution: got periodic with {why}, expected auto or march"
        )


@dataclass(frozen=True)
class GrowthRates:
    """Rates at which small disturbances of a periodic motion grow, per shaft turn.

    Were the race held, the phase of each ball would stay as it is: n multipliers of 1, one of which
    says that the motion may begin at any instant. The race couples the balls, which makes those of
    their spacing a little larger or smaller. All others belong to slip and spin.
    """

    spacing: float  # of the balls' even spacing, the fastest
    other: float  # the slowest to die out of all others

    @classmethod
    def of(cls, multipliers: np.ndarray, balls: int, turns: float) -> "GrowthRates":
        """From what a passing of so many turns multiplies disturbances by.

        It moves the phases on by a ball: those of the spacing stay near the roots of 1.
        """
        left, phases = list(multipliers), []
        for root in np.exp(2j * np.pi * np.arange(balls) / balls):
            phases.append(left.pop(int(np.argmin(np.abs(np.array(left) - root)))))
        rates = (
            float(np.log(np.abs(group).max(initial=_NOTHING))) / turns
            for group in (phases[1:], left)
        )
        return cls(*rates)

    @property
    def values(self) -> dict[str, float]:
        return dict(zip(GROWTHS, (self.spacing, self.other), strict=True))

    @property
    def sentence(self) -> str:
        if self.other > LEAST_GROWTH:
            return f"unstable: disturbances grow by a factor of e in {_turns(self.other)}"
        spacing = (
            f"grow by a factor of e in {_turns(self.spacing)}"
            if self.spacing > LEAST_GROWTH
            else "do not grow"
        )
        return (
            f"disturbances decay by a factor of e in {_turns(self.other)}; disturbances to the "
            f"even ball spacing {spacing}"
        )


def _turns(rate: float) -> str:
    return f"{float(f'{1.0 / abs(rate):.2g}'):g} turns"


def instability(scene: Scene, values: Mapping[str, float]) -> dict[str, str] | None:
    """Sentence and advice for an unstable periodic motion."""
    spacing, other = (values.get(name, -np.inf) for name in GROWTHS)
    if other > LEAST_GROWTH:
        said = f"disturbances grow by a factor of e in {_turns(other)}"
        return {"said": said, "advice": "set model.dynamic_solution: march"}
    if spacing > LEAST_GROWTH and scene.cage is None:
        said = (
            "without a cage, disturbances to the even ball spacing grow by a factor of e in "
            f"{_turns(spacing)}"
        )
        return {"said": said, "advice": "add a cage to the scene"}
    return None
