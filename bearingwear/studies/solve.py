"""Solves a case of a scene, or its life, for steps of several studies."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from bearingwear.scene.cases import scene_in_case
from bearingwear.scene.changes import changes_of
from bearingwear.scene.friction import friction_changes_with_wear
from bearingwear.scene.read import (
    Source,
    as_data,
    changed_scene,
    scene_for_life,
    source_name,
    variant,
)
from bearingwear.scene.scene import Scene, SceneError
from bearingwear.solvers.result import Result

NO_CHANGES: Mapping[str, Any] = MappingProxyType({})


def solved_case(
    scene: str | Path, changes: Mapping[str, Any] = NO_CHANGES, fidelity: str | None = None
) -> Result:
    """Returns the solved case of a scene. A failure is in its status and on standard error.

    changes: new values by dotted key.
    fidelity: overrides `model.fidelity`.
    """
    from bearingwear.solvers.solve import solve

    solved = solve(variant(scene, changes), fidelity, progress=_report)
    return reported(solved, scene)


def solved_variants(
    scene: str | Path,
    variants: Iterable[Mapping[str, Any]],
    fidelity: str | None = None,
    case: str | None = None,
) -> Iterator[Result]:
    """Yields the solved case for each set of changes of a scene, whose file is read once.

    A failure is in the status and on standard error.

    variants: sets of new values by dotted key.
    fidelity: overrides `model.fidelity`.
    case: name of an operating condition under `cases` of the scene.
    """
    from bearingwear.solvers.solve import solve

    data, source = as_data(scene)
    for changes in variants:
        changed = changed_scene(data, changes, source)
        variant_scene = changed if case is None else scene_in_case(changed, case, "--case")
        yield reported(solve(variant_scene, fidelity), scene)


def solved_life(
    scene: str | Path, changes: Mapping[str, Any] = NO_CHANGES, fidelity: str | None = None
) -> Result:
    """Returns the wear life of a scene. A failure is in its status and on standard error.

    changes, fidelity: as of `solved_case`.
    """
    from bearingwear.lives.life import life

    return reported(
        life(scene_for_life(variant(scene, changes), str(scene)), fidelity, _report), scene
    )


def reported(result: Result, scene: str | Path) -> Result:
    """Returns the result unchanged, after a failure has been reported on standard error."""
    if result.status != "ok":
        _report(f"{scene}: {result.status}: {result.reason}")
    return result


def _report(text: str) -> None:
    """Writes a line to standard error at once."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def life_scene(scene: Source, settings: Sequence[str] = (), films: bool = False) -> Scene:
    """Returns a scene whose life the steady model can solve, as studies require.

    settings: changes `KEY=VALUE`.
    films: whether solid films and running-in are allowed.
    SceneError: a scene that is not valid or has no end of life, a film that is not allowed, or a
    life that requires another model.
    NotAvailable: phases of a duty that no single steady model solves.
    """
    from bearingwear.solvers.effects.choice import choice_for_life

    source = source_name(scene)
    scene = scene_for_life(variant(scene, changes_of(settings)), source)
    if not films and (scene.friction.film is not None or friction_changes_with_wear(scene)):
        raise SceneError(
            "friction.film",
            "got a film, or a material with film or running_in, expected a single "
            "friction.ball_race for a study (to compute a single life, use bearingwear life "
            f"{source})",
            source=source,
        )
    if scene.duty is not None:
        from bearingwear.lives.duty.result import choices_of_phases

        choices_of_phases(scene)  # raises NotAvailable
    fidelity = choice_for_life(scene).fidelity
    if fidelity != "steady":
        raise SceneError(
            "",
            f"got a scene whose life requires the {fidelity} model, expected one with a steady "
            f"state (to compute a single life, use bearingwear life {source} --fidelity dynamic)",
            source=source,
        )
    return scene
