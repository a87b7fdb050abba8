"""`bearingwear export`."""

from __future__ import annotations

import argparse
import re
import sys

from bearingwear.console import NOT_SOLVED, SUCCESS, UsageError, one_line
from bearingwear.options import given_scene, output_of
from bearingwear.printing import tell_of_new_folder


def export_command(args: argparse.Namespace) -> int:
    """Writes the stiffness over speed as CSV or as TOML for ROSS, and returns an exit status.

    NOT_SOLVED: the scene has no stiffness at a speed; stderr says why, and nothing is written.
    UsageError: the file has another suffix.
    """
    from bearingwear.applications.export.stiffness import NotExported, StiffnessOverSpeed
    from bearingwear.atomic import write_text

    scene, path = given_scene(args), output_of(args, "-stiffness.csv")
    if path.suffix not in (".csv", ".toml"):
        raise UsageError(f"-o: got {path}, expected a name that ends in .csv or .toml")
    try:
        stiffness = StiffnessOverSpeed.of(scene, args.speeds)
    except NotExported as error:
        sys.stderr.write(one_line(f"{args.scene}: {error}"))
        return NOT_SOLVED
    if path.suffix == ".csv":
        text = stiffness.csv
    else:
        text = stiffness.toml(
            re.sub(r"[^A-Za-z0-9_-]", "_", path.stem),  # what a bare key of TOML may contain
            bearing=args.bearing,
            tilt=args.tilt,
            damping=args.damping,
            node=args.node,
            ross=args.ross,
        )
    tell_of_new_folder(path)
    write_text(path, text)
    print(f"{path}: written; dynamic stiffness at {len(args.speeds)} speeds")
    return SUCCESS
