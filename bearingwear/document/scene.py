"""The sheet of a scene: its main numbers, and those that follow without a solve."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearingwear.document.bearing_line import operation_lines
from bearingwear.document.document import Block, Document, Row

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene


def scene_sheet(scene: Scene) -> Document:
    """The main numbers of a scene."""
    b, m = scene.bearing, scene.materials
    angle = math.radians(b.contact_angle_deg)
    mass = m[b.ball_material].density_kg_m3 * math.pi / 6.0 * b.ball_diameter_mm**3 * 1e-9
    groove = (b.inner_groove_factor + b.outer_groove_factor - 1.0) * b.ball_diameter_mm
    end = scene.wear.end_of_life
    limits = end.criteria if end is not None else {}
    speed = scene.operation.shaft_speed_rpm
    bearing = (
        Row("ball diameter", "mm", (b.ball_diameter_mm,)),
        Row("pitch diameter", "mm", (b.pitch_diameter_mm,)),
        Row("free contact angle", "degree", (b.contact_angle_deg,)),
        Row("groove factor, inner", "", (b.inner_groove_factor,)),
        Row("groove factor, outer", "", (b.outer_groove_factor,)),
        Row("diametral clearance", "um", (2e3 * groove * (1.0 - math.cos(angle)),)),
        Row("mass of a ball", "g", (1e3 * mass,)),
        Row("speed x pitch diameter", "mm/min", (speed * b.pitch_diameter_mm,)),
    )
    materials = tuple(
        Row(
            f"{part}: {name}",
            "",
            (m[name].youngs_modulus_GPa, m[name].brinell_hardness_GPa, m[name].wear_coefficient),
        )
        for part, name in (("balls", b.ball_material), ("races", b.race_material))
    )
    ends = tuple(Row(name, "", (value,)) for name, value in limits.items()) or (Row("none given"),)
    blocks = (
        Block("bearing", (), bearing, given=True),
        Block("material", ("E, GPa", "H, GPa", "K_s"), materials, given=True),
        Block("end of life, the first of", (), ends, given=True),
    )
    return Document(
        operation_lines(scene.to_dict()), {"kind": "scene", "scene": scene.name}, blocks
    )
