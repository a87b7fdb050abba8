"""The sheet of `check`: the model of a scene, the table of effects, and warnings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.document.bearing_line import duty_lines, warning_with_cases
from bearingwear.document.document import Block, Document, Row
from bearingwear.results.warnings import warning_line
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.new.minimum_preload import minimum_preload_lines
from bearingwear.scene.scene import Scene
from bearingwear.solvers.effects.choice import Choice, accuracy_sentence, effort_sentence
from bearingwear.solvers.effects.sizes import effect_sizes
from bearingwear.solvers.effects.table import EFFECTS
from bearingwear.solvers.effects.warnings import warnings_of

_WITH_SENTENCE = frozenset(
    {
        "pair", "film_worn", "contact_angle_too_small", "unit_in_doubt", "motion_unstable",
        "criteria",
    }
)  # fmt: skip
"""Effects whose sentences state values of the scene that no row of the table contains."""

LIMIT = "limit: the size beyond which an effect is modelled, or a warning asks for the key"


def check_document(path: str, scene: Scene, chosen: Choice) -> Document:
    """Returns the sheet of a valid scene: its model, modelled and neglected effects, and warnings.

    path: of the scene file.
    chosen: the model that would solve the scene, with the reason.
    """
    scene_data = scene.to_dict()
    warnings = [
        warning_line(warning_with_cases(warning, scene_data))
        for warning in warnings_of(scene, chosen)
    ]
    heading = (
        f"{path}: valid; {scene.name} would be solved with the {chosen.fidelity} model",
        f"  {chosen.fidelity}: {chosen.why}",
    )
    blocks = (
        Block("effect", ("modelled", "size", "limit"), _effect_rows(chosen), (LIMIT,)),
        Block("", lines=(*_model_lines(scene, scene_data, chosen), *warnings)),
    )
    facts = {
        "kind": "check",
        "scene": scene.name,
        "fidelity": chosen.fidelity,
        "why": chosen.why,
        "warnings": warnings,
    }
    return Document(heading, facts, blocks)


def _effect_rows(chosen: Choice) -> tuple[Row, ...]:
    """Returns a row for each effect: whether it is modelled, its size, and a limit of that."""
    return tuple(
        Row(
            effect.name,
            effect.unit,
            ("on" if effect.is_on else "off", effect.size, effect.limit),
            effect.name.replace(" ", "_").replace(",", ""),
            note=effect.note,
        )
        for effect in effect_sizes(chosen)
    )


def _model_lines(scene: Scene, scene_data: Mapping[str, Any], chosen: Choice) -> list[str]:
    """Returns lines on effects, accuracy and effort, and on cases, duty and minimum preload.

    scene_data: the scene as plain data.
    chosen: the model that would solve it.
    """
    lines = [
        line
        for effect in EFFECTS
        if effect.id in _WITH_SENTENCE
        for line in effect.modelled(chosen)
    ]
    lines += [accuracy_sentence(scene, chosen), effort_sentence(scene, chosen)]
    if scene.cases:
        names = ", ".join(scene.in_cases)
        lines.append(
            f"cases: {names}; these lines are of {NOMINAL}; --case NAME gives those of another"
        )
    if scene.duty is not None:
        lines += duty_lines(scene_data)
    return [*lines, *minimum_preload_lines(scene_data)]
