"""The accuracy dial: what `model.accuracy` sets, in one place.

Each rung states the relative error of total QV it is meant for. What they really give and take is
measured by `snakemake tradeoff` (docs/accuracy.md); a single key in a scene overrides its rung.
"""

from typing import NamedTuple


class Rung(NamedTuple):
    """Settings of accuracy that belong together, under the names of the scene's keys."""

    error: float  # of total QV, relative: what the rung is meant for
    quadrature: str
    strips: int
    steady_starts: int
    slip_regularisation_m_s: float
    dynamic_tolerance: float
    simulated_turns: float
    settled_drift: float
    tolerance: float

    @property
    def keys(self) -> dict[str, float | int | str]:
        """The settings by their paths in a scene."""
        values = self._asdict()
        del values["error"]
        regularisation = {REGULARISATION: values.pop("slip_regularisation_m_s")}
        return regularisation | {f"model.{name}": value for name, value in values.items()}


REGULARISATION = "friction.slip_regularisation_m_s"

# The reference is brute force: its points know nothing of where the slip turns round, and other
# steady states are sought from many more starts.
LADDER = (
    Rung(5e-2, "split", 24, 2, 3e-4, 1e-1, 6.0, 1e-2, 1e-4),
    Rung(2e-2, "split", 32, 4, 2e-4, 3e-2, 12.0, 5e-3, 1e-5),
    Rung(5e-3, "split", 50, 4, 1e-4, 1e-2, 40.0, 1e-3, 1e-6),
    Rung(1e-3, "split", 80, 8, 3e-5, 1e-3, 100.0, 1e-3, 1e-7),
    Rung(1e-4, "gauss", 1000, 64, 1e-5, 1e-5, 160.0, 1e-4, 1e-8),
)
NAMED = {"draft": LADDER[0], "standard": LADDER[2], "reference": LADDER[-1]}
STANDARD = NAMED["standard"]


def rung(accuracy: str | float) -> Rung:
    """The rung of a name, or the cheapest one that is meant for a target error."""
    if isinstance(accuracy, str):
        return NAMED[accuracy]
    return next((r for r in LADDER if r.error <= accuracy), LADDER[-1])
