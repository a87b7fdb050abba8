"""The sheet of a torque margin: the worst corner, and every other one."""

from __future__ import annotations

from collections.abc import Sequence

from bearingwear import Scene
from bearingwear.document.document import Document
from bearingwear.document.margin import corner_words, margin_block, margin_sentences, worst_corner
from bearingwear.lives.margin import Corner
from bearingwear.scene.new.minimum_preload import minimum_preload_lines


def margin_document(scene: Scene, corners: Sequence[Corner]) -> Document:
    """Returns the report on the torque margin of a scene with a drive, in all corners.

    Its heading states the worst corner; a table has all of them.
    """
    worst = worst_corner(corners)
    heading = (
        f"{scene.name}: torque margin at a preload of {scene.operation.preload_N:g} N",
        *minimum_preload_lines(scene.plain),
        *margin_sentences(scene, corners),
    )
    facts = {"kind": "torque margin", "scene": scene.name, "worst": corner_words(worst)}
    return Document(heading, facts, (margin_block(scene, corners),))
