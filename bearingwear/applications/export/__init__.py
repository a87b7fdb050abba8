"""The stiffness of bearings over speed, for programs of rotor dynamics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearingwear.application import Application

if TYPE_CHECKING:
    import argparse


# fmt: off
def export_options(sub: argparse.ArgumentParser) -> None:
    """Adds the arguments of `bearingwear export`."""
    from bearingwear.options import add_scene, file_name, positive

    add_scene(sub)
    sub.add_argument("--speeds", type=_speeds, required=True, metavar="LOW:HIGH:COUNT",
        help="evenly spaced shaft speeds in r/min, or a list such as 1000,2000,5000; ROSS requires "
        "at least five speeds")
    sub.add_argument("-o", "--output", metavar="FILE", type=file_name,
        help="a .csv file for the 5 x 5 matrices of all bearings, or a .toml file for one bearing "
        "in the format read by ross.BearingElement.load (default: SCENE-stiffness.csv)")
    sub.add_argument("--bearing", type=int, choices=(1, 2), default=1,
        help="which bearing of a pair to export (default: 1)")
    sub.add_argument("--tilt", choices=("held", "released"), default="held",
        help="whether shaft tilt in the bearing, which ROSS does not model, is held or released "
            "(default: held)")
    sub.add_argument("--damping", type=positive, metavar="N_S_M",
        help="damping in x, y and z (default: 0, assumed)")
    sub.add_argument("--node", type=int, default=0, metavar="N",
        help="rotor node (default: 0)")
    sub.add_argument("--ross", type=int, choices=(2, 3), default=2,
        help="major version of ROSS, which determines the name of the speed key (default: 2)")

# fmt: on


def _speeds(text: str) -> list[float]:
    """Returns shaft speeds [r/min], written as LOW:HIGH:COUNT or as numbers with commas.

    Without a COUNT, LOW:HIGH has eight speeds. ArgumentTypeError: the text is neither form, LOW is
    not below HIGH, or COUNT is not from 2 to 1000. Whether a list rises is checked later.
    """
    import argparse
    import math

    low_text, _, remainder = text.partition(":")
    try:
        if not remainder:
            return [float(speed) for speed in text.split(",")]
        high_text, _, count_text = remainder.partition(":")
        low, high, count = float(low_text), float(high_text), int(count_text or 8)
        if not (0.0 <= low < high < math.inf and 2 <= count <= 1000):
            raise ValueError
        return [low + (high - low) * k / (count - 1) for k in range(count)]
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"got {text!r}, expected LOW:HIGH:COUNT or increasing numbers such as 1000,2000,5000"
        ) from None


APPLICATION = Application(
    command="export",
    description="write the stiffness at given speeds as CSV or ROSS TOML",
    add_options=export_options,
    handler=f"{__name__}.command:export_command",
    functions={"to_ross": f"{__name__}.stiffness:to_ross"},
)
