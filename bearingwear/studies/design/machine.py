"""What the machine asks of a recommended preload: torque margin and launch, for its document."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

import xarray as xr

from bearingwear.document.document import Block
from bearingwear.document.launch import launch_verdict
from bearingwear.document.margin import margin_block, margin_sentences
from bearingwear.lives.margin import Corner, launched_by_wear, torque_corners
from bearingwear.results.pair_variables import method_words
from bearingwear.results.words import scene_of
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import PRELOAD_METHODS, Scene

MACHINE = "machine"
"""Attribute of a recommendation: for each method, sentences and the corners of the torque."""


def machine_answers(scene: Scene) -> dict[str, Any]:
    """Results of a scene with a drive or a launch; otherwise empty."""
    said: list[str] = []
    corners: list[Corner] = []
    if scene.drive is not None:
        corners = torque_corners(scene)
        said += margin_sentences(scene, corners)
    a = scene.arrangement
    if scene.launch is not None and a is not None and a.rotor_mass_kg and a.span_mm:
        states = launched_by_wear(scene)
        one = next(iter(states.values()))
        g = f"{one.axial_g:.3g} g axial, {one.radial_g:.3g} g radial"
        said += [f"launch, {g}: {text}" for text in launch_verdict(scene, states)]
    return {"said": said, "corners": [asdict(one) for one in corners]} if said else {}


def machine_blocks(found: xr.Dataset) -> list[Block]:
    """Blocks of each recommended preload, as in a recommendation."""
    answers = json.loads(found.attrs.get(MACHINE, "[]"))
    known = [(k, one) for k, one in enumerate(answers) if one]
    data, blocks, said = scene_of(found), [], []
    for k, one in known:
        words = method_words(data, PRELOAD_METHODS[int(found["preload_method"][k])])
        lines = [f"{words}: {line}" if len(known) > 1 else line for line in one["said"]]
        said += [f"{line[:1].upper()}{line[1:]}." for line in lines]
        if one["corners"]:
            corners = [Corner(**corner) for corner in one["corners"]]
            block = margin_block(scene_from_dict(data), corners)
            title = f"torque margin, {words}, {float(found['preload'][k]):.7g} N"
            blocks.append(Block(title, block.columns, block.rows, block.lines, place="open"))
    asked = Block("Requirements of the machine", lines=tuple(said), place="lead")
    return ([asked] if said else []) + blocks
