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
from bearingwear.measures import plain
from bearingwear.results.pair_variables import method_words
from bearingwear.results.words import plain_scene
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import PRELOAD_METHODS, Scene

MACHINE = "machine"
"""Attribute of a recommendation: for each method, sentences and the corners of the torque."""


def machine_answers(scene: Scene) -> dict[str, Any]:
    """Returns how a scene meets the requirements of its drive and launch; {} if it has neither.

    `said` has the sentences, and `corners` the fields of each `Corner` of the torque; the latter is
    empty without a drive. A launch counts only if rotor mass and bearing span are known.
    """
    sentences: list[str] = []
    corners: list[Corner] = []
    if scene.drive is not None:
        corners = torque_corners(scene)
        sentences += margin_sentences(scene, corners)
    arrangement = scene.arrangement
    has_rotor = arrangement is not None and arrangement.rotor_mass_kg and arrangement.span_mm
    if scene.launch is not None and has_rotor:
        states = launched_by_wear(scene)
        first = next(iter(states.values()))
        loads = f"{plain(first.axial_g)} g axial, {plain(first.radial_g)} g radial"
        sentences += [f"launch, {loads}: {text}" for text in launch_verdict(scene, states)]
    if not sentences:
        return {}
    return {"said": sentences, "corners": [asdict(corner) for corner in corners]}


def machine_blocks(recommendation: xr.Dataset) -> list[Block]:
    """Returns blocks with what the machine requires at each recommended preload; see `MACHINE`.

    The first has the sentences of all methods; each table of torque margins follows in a block. The
    list is empty without requirements of a machine.
    """
    answers = json.loads(recommendation.attrs.get(MACHINE, "[]"))
    has_several_methods = len([answer for answer in answers if answer]) > 1
    scene_data = plain_scene(recommendation)
    sentences = []
    torque_blocks = []
    for k, answer in enumerate(answers):
        if not answer:
            continue
        words = method_words(scene_data, PRELOAD_METHODS[int(recommendation["preload_method"][k])])
        lines = [f"{words}: {line}" if has_several_methods else line for line in answer["said"]]
        sentences += [f"{line[:1].upper()}{line[1:]}." for line in lines]
        if answer["corners"]:
            corners = [Corner(**corner) for corner in answer["corners"]]
            block = margin_block(scene_from_dict(scene_data), corners)
            title = f"torque margin, {words}, {float(recommendation['preload'][k]):.7g} N"
            torque_blocks.append(Block(title, block.columns, block.rows, block.lines, place="open"))
    if not sentences:
        return torque_blocks
    title = "Requirements of the machine"
    return [Block(title, lines=tuple(sentences), place="lead"), *torque_blocks]
