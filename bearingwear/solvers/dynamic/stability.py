"""Whether a periodic motion lasts: what small disturbances of it grow to (theory.md section 22)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.scene.scene import Scene

LEAST_GROWTH = 1e-5
"""Growth a turn from which a motion is unstable: less is left open by `tangents`."""

GROWTHS = ("spacing_growth_per_turn", "disturbance_growth_per_turn")
"""Variables of the two fields of `GrowthRates`."""

_NOTHING = 1e-300  # the least of multipliers: all others may underflow


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
        """The same as variables of a result."""
        return dict(zip(GROWTHS, (self.spacing, self.other), strict=True))

    @property
    def sentence(self) -> str:
        """The same in words."""
        if self.other > LEAST_GROWTH:
            return f"unstable: disturbances grow e-fold in {_turns(self.other)}"
        spacing = (
            f"grow e-fold in {_turns(self.spacing)}"
            if self.spacing > LEAST_GROWTH
            else "do not grow"
        )
        return (
            f"disturbances die out e-fold in {_turns(self.other)}; those of the balls' "
            f"even spacing {spacing}"
        )


def _turns(rate: float) -> str:
    """Turns of an e-fold change, two digits in words."""
    return f"{float(f'{1.0 / abs(rate):.2g}'):g} turns"


def is_marched_instead(scene: Scene, growth: GrowthRates | None) -> bool:
    """Whether a motion is unstable, and not by the spacing that a cage keeps, and may be left."""
    asked = scene.model.dynamic_solution
    return asked == "auto" and growth is not None and growth.other > LEAST_GROWTH


def instability(scene: Scene, values: Mapping[str, float]) -> tuple[None, Mapping[str, Any]] | None:
    """What is said of a periodic motion that does not last, and the advice."""
    spacing, other = (values.get(name, -np.inf) for name in GROWTHS)
    if other > LEAST_GROWTH:
        said = f"its disturbances grow e-fold in {_turns(other)}"
        return None, {"said": said, "advice": "set model.dynamic_solution: march"}
    if spacing > LEAST_GROWTH and scene.cage is None:
        said = (
            "nothing keeps the balls apart, and disturbances of their even spacing grow e-fold in "
            f"{_turns(spacing)}"
        )
        return None, {"said": said, "advice": "give the scene its cage"}
    return None
