"""The torque margin of a drive, cold and hot, new and worn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearingwear.application import Application

if TYPE_CHECKING:
    import argparse


# fmt: off
def margin_options(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `bearingwear margin`."""
    from bearingwear.options import add_formats, add_scene, number_in
    from bearingwear.scene.scene import key_of_scene

    torque_part = key_of_scene("drive.torque_Nm")
    assert torque_part is not None
    add_scene(sub)
    sub.add_argument("--drive", type=number_in(torque_part), metavar="N_M",
        help="drive torque (sets drive.torque_Nm)")
    sub.add_argument("--standard", choices=("ecss", "nasa", "own"),
        help="standard that defines the margin (sets drive.standard; default: ecss)")
    sub.add_argument("--data", choices=("analysis", "test", "extremes"),
        help="source of the torque data (sets drive.data; default: analysis)")
    add_formats(sub)

# fmt: on


APPLICATION = Application(
    command="margin",
    description="compute the torque margin of a drive, cold and hot, new and worn",
    add_options=margin_options,
    handler=f"{__name__}.command:margin_command",
    functions={"margin": f"{__name__}.command:margin"},
    sheets={"torque margin": "bearingwear.document.document:sheet_in_file"},
)
