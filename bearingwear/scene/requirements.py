"""Keys of a scene for launch loads and the drive of the shaft."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, record_hash, reduced_record, setting

_G, _DENSITY = "[0, 1e5]", "(0, 1e4]"


@keyed
class Launch:
    """Accelerations of the rotor's mass while nothing turns."""

    # fmt: off
    axial_g: float = setting("Quasi-static axial acceleration in both directions, in units of "
        "standard gravity",
        "1", _G, default=0.0)
    radial_g: float = setting("Quasi-static radial acceleration, in units of standard "
        "gravity", "1", _G, default=0.0)
    axial_density_g2_Hz: float | None = setting("Spectral density of the random axial "
        "acceleration at the rotor's axial natural frequency; axial_g is computed from it by "
        "Miles' equation, as the largest acceleration expected in duration_s",
        "1/Hz",
        _DENSITY, default=None)
    radial_density_g2_Hz: float | None = setting(
        "Spectral density of the random radial acceleration at the rotor's radial natural "
        "frequency", "1/Hz",
        _DENSITY, default=None)
    amplification: float = setting(
        "Amplification Q = 1/(2 x damping ratio) at the rotor's natural frequencies (default: 10, "
        "assumed)", "1", "[0.5, 1000]", default=10.0)
    duration_s: float = setting(
        "Duration of the random vibration (default: 120 s per axis, assumed; 0: three sigma)", "s",
        "[0, 1e6]", default=120.0)
    after_wear_um: float | None = setting("Total wear depth up to which the bearings may have worn "
        "before the launch, in tests and running-in; if omitted, that at the end of life", "um",
        "[0, 50000]", default=None)
    # fmt: on

    def __post_init__(self) -> None:
        """Refuses an acceleration beside the density from which it is computed."""
        for direction in ("axial", "radial"):
            acceleration = getattr(self, f"{direction}_g")
            density_key = f"{direction}_density_g2_Hz"
            if acceleration and getattr(self, density_key) is not None:
                problem = f"got {acceleration:g} with {density_key}, expected only one of them"
                raise SceneError(f"{direction}_g", problem)


RULES: dict[tuple[str, str], dict[str, float]] = {
    ("ecss", "analysis"): {
        "inertia": 2.2, "spring": 2.4, "magnetic_loss": 3.0, "friction": 6.0, "hysteresis": 6.0,
        "harness": 6.0, "adhesion": 6.0, "dynamic": 1.25, "output": 1.0,
    },
    ("ecss", "extremes"): {
        "inertia": 2.2, "spring": 2.4, "magnetic_loss": 2.4, "friction": 3.0, "hysteresis": 3.0,
        "harness": 3.0, "adhesion": 6.0, "dynamic": 1.25, "output": 1.0,
    },
    ("nasa", "analysis"): {"fixed": 1.50, "variable": 3.00, "acceleration": 1.25},
    ("nasa", "test"): {"fixed": 1.35, "variable": 2.50, "acceleration": 1.15},
    ("nasa", "extremes"): {"fixed": 1.25, "variable": 2.00, "acceleration": 1.10},
}  # fmt: skip
"""Factors on what resists a drive, by the rule and where the torques come from. Those of ECSS with
its motorization factor of 2 on all but the dynamic and the output torque."""

STANDARDS = {
    "ecss": "ECSS-E-ST-33-01C (6 March 2009), 4.7.5.3; Rev. 1 and 2 were not available",
    "nasa": "NASA-STD-5017B (6 December 2022) eq. 4-1 and table 1, from a secondary source",
    "own": "factors defined in the scene",
}
"""Rules of a torque margin, their editions and what was read of them."""

_BEARINGS = {"ecss": "friction", "nasa": "fixed"}
_TORQUE = "(0, 1e6]"


@keyed
class Drive:
    """Drive of the shaft, and the rule of its torque margin."""

    torque_Nm: float = setting("Minimum torque of the drive", "N m", _TORQUE)
    standard: str = setting(
        "Standard that defines the torque margin", choices=tuple(STANDARDS), default="ecss"
    )
    # fmt: off
    data: str = setting("Source of the torque data: analysis, test, or tests at the extremes of "
        "the environment (ecss: analysis or extremes)", choices=("analysis", "test", "extremes"),
        default="analysis")
    bearings_as: str | None = setting(
        "Resistance class of the bearing torque (if omitted, friction for ecss and fixed for nasa)",
        longest=40, default=None)
    resistances_Nm: Mapping[str, float] = setting(
        "Other resisting torques, each under its name in the standard", each="A torque", unit="N m",
        within="[0, 1e6]", default_factory=dict)
    factors: Mapping[str, float] = setting(
        "Factors of your own standard, under names of your choice", each="A factor", unit="1",
        within="(0, 1000]", default_factory=dict)
    # fmt: on

    def __post_init__(self) -> None:
        """Makes mappings read-only; refuses factors beside a standard, and names not in its rule.

        It also refuses a standard of one's own without factors, and a kind of data without a rule.
        """
        for name in ("resistances_Nm", "factors"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        if (self.standard == "own") != bool(self.factors):
            problem = "expected factors if and only if the standard is own"
            got = "some" if self.factors else "none"
            raise SceneError("factors", f"got {got} with {self.standard}, {problem}", ("standard",))
        if self.standard != "own" and (self.standard, self.data) not in RULES:
            problem = f"got {self.data} with {self.standard}, expected analysis or extremes"
            raise SceneError("data", problem, ("standard",))
        names = ", ".join(self.rule)
        if self.bearings not in self.rule:
            got = self.bearings or "nothing"
            raise SceneError("bearings_as", f"got {got}, expected {names}", ("standard",))
        for name in self.resistances_Nm:
            if name not in self.rule:
                problem = f"got an unknown key, expected {names}"
                raise SceneError(f"resistances_Nm.{name}", problem, ("standard",))

    def __hash__(self) -> int:
        """Returns a hash of all fields, although a mapping proxy has none of its own."""
        return record_hash(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what pickle makes a copy from."""
        return reduced_record(self)

    @property
    def rule(self) -> Mapping[str, float]:
        """Returns the factor of each class of resistance: those of the standard, or one's own."""
        return self.factors if self.standard == "own" else RULES[self.standard, self.data]

    @property
    def bearings(self) -> str:
        """Returns the class of resistance of the bearing torque: that of the scene or its standard.

        It is "" if the scene states none and has a standard of its own.
        """
        return self.bearings_as or _BEARINGS.get(self.standard, "")

    def required_torque(self, bearing_torque: float) -> float:
        """Returns the torque that the drive must have [N m].

        bearing_torque: friction torque of all bearings [N m].
        """
        other_torque = sum(self.rule[name] * torque for name, torque in self.resistances_Nm.items())
        return self.rule[self.bearings] * bearing_torque + other_torque

    def margin(self, bearing_torque: float) -> float:
        """Returns the torque margin: drive torque over required torque, minus 1.

        It is infinite if nothing resists.

        bearing_torque: friction torque of all bearings [N m].
        """
        required = self.required_torque(bearing_torque)
        return self.torque_Nm / required - 1.0 if required > 0.0 else math.inf

    def stalls(self, bearing_torque: float) -> bool:
        """Whether the resisting torques, without any factor, exceed that of the drive.

        bearing_torque: friction torque of all bearings [N m].
        """
        return bearing_torque + sum(self.resistances_Nm.values()) > self.torque_Nm
