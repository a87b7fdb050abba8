"""What a machine asks of its bearings beside running: keys of a scene."""

from __future__ import annotations

from bearingwear.scene.errors import SceneError
from bearingwear.scene.records import keyed, setting

_G, _DENSITY = "[0, 1e5]", "(0, 1e4]"


@keyed
class Launch:
    """Accelerations of the rotor's mass while nothing turns."""

    axial_g: float = setting(
        "Quasi-static acceleration along the axis, either way (standard g)", "1", _G, default=0.0
    )
    radial_g: float = setting("The same across the axis", "1", _G, default=0.0)
    axial_density_g2_Hz: float | None = setting(
        "Density of random acceleration along the axis at the rotor's axial frequency, in place of "
        "axial_g by Miles' equation (three sigma)",
        "1/Hz",
        _DENSITY,
        default=None,
    )
    radial_density_g2_Hz: float | None = setting(
        "The same across the axis, at the radial frequency", "1/Hz", _DENSITY, default=None
    )
    amplification: float = setting(
        "Amplification Q = 1/(2 damping ratio) at these frequencies (10 is assumed)",
        "1",
        "[0.5, 1000]",
        default=10.0,
    )

    def __post_init__(self) -> None:
        for way in ("axial", "radial"):
            given = getattr(self, f"{way}_g")
            if given and getattr(self, f"{way}_density_g2_Hz") is not None:
                key = f"{way}_density_g2_Hz"
                raise SceneError(f"{way}_g", f"got {given:g} with {key}, expected one of the two")
