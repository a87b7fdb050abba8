"""Whether the bearings of a rotor gap or dent at launch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearingwear.application import Application

if TYPE_CHECKING:
    import argparse


# fmt: off
def launch_options(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `bearingwear launch`."""
    from bearingwear.options import add_case, add_formats, add_scene, number_in
    from bearingwear.scene.checking.records import Key, Part

    acceleration = number_in(Part("number", Key("", "g", "[0, 1e5]")))
    add_scene(sub)
    for direction, preposition in (("axial", "along"), ("radial", "perpendicular to")):
        sub.add_argument(f"--{direction}", type=acceleration, metavar="G",
            help=f"acceleration {preposition} the bearing axis (sets launch.{direction}_g)")
    add_case(sub)
    add_formats(sub)

# fmt: on


APPLICATION = Application(
    command="launch",
    description="determine whether the bearings of a rotor gap or dent at launch",
    add_options=launch_options,
    handler=f"{__name__}.command:launch_command",
    functions={"launch": f"{__name__}.command:launch"},
    sheets={"launch": "bearingwear.document.document:sheet_in_file"},
)
