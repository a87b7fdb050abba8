"""What `check` says of a scene: its model, the table of effects, and warnings."""

from __future__ import annotations

from bearingwear.document.bearing_line import duty_lines, settled_by_a_case
from bearingwear.document.document import Block, Document, Row
from bearingwear.results.warnings import warning_line
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.new.minimum_preload import minimum_preload_line
from bearingwear.scene.scene import Scene
from bearingwear.solvers.effects.choice import Choice, accuracy_sentence, effort
from bearingwear.solvers.effects.sizes import effect_sizes
from bearingwear.solvers.effects.table import EFFECTS
from bearingwear.solvers.effects.warnings import warnings_of

STATED = frozenset(
    {
        "pair", "film_worn", "contact_angle_too_small", "unit_in_doubt", "motion_unstable",
        "criteria",
    }
)  # fmt: skip
"""Effects whose sentences state values of the scene, which no row of the table has."""

LIMIT = "limit: the size beyond which an effect is modelled, or a warning asks for the key"


def check_document(path: str, scene: Scene, chosen: Choice) -> Document:
    """The model of a valid scene, the effects that it has and leaves out, and what to know."""
    rows = tuple(
        Row(
            effect.name,
            effect.unit,
            ("on" if effect.is_on else "off", effect.size, effect.limit),
            effect.name.replace(" ", "_").replace(",", ""),
            note=effect.note,
        )
        for effect in effect_sizes(chosen)
    )
    data = scene.to_dict()
    stated = [line for one in EFFECTS if one.id in STATED for line in one.modelled(chosen)]
    lines = [*stated, accuracy_sentence(scene, chosen), effort(scene, chosen)]
    if scene.cases:
        names = ", ".join(scene.in_cases)
        lines.append(
            f"cases: {names}; these lines are of {NOMINAL}; --case NAME gives those of another"
        )
    if scene.duty is not None:
        lines += duty_lines(data)
    if line := minimum_preload_line(data["bearing"], data["operation"]):
        lines.append(line)
    warnings = [one for one in warnings_of(scene, chosen) if not settled_by_a_case(one, data)]
    heading = (
        f"{path}: valid; {scene.name} would be solved with the {chosen.fidelity} model",
        f"  {chosen.fidelity}: {chosen.why}",
    )
    blocks = (
        Block("effect", ("modelled", "size", "limit"), rows, (LIMIT,)),
        Block("", lines=(*lines, *map(warning_line, warnings))),
    )
    facts = {
        "kind": "check",
        "scene": scene.name,
        "fidelity": chosen.fidelity,
        "why": chosen.why,
        "warnings": [warning_line(one) for one in warnings],
    }
    return Document(heading, facts, blocks)
