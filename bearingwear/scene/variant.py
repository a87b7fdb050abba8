"""The one way to say "this scene with these keys changed"."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from bearingwear.scene.read import as_data, changed_scene
from bearingwear.scene.scene import Scene


def variant(
    source: str | os.PathLike[str] | Mapping[str, Any] | Scene, changes: Mapping[str, Any]
) -> Scene:
    """A scene with some of its values replaced, checked.

    changes: `{"operation.preload_N": 9.0}`; blocks that are not there are made, None leaves out
        what a scene can do without.

    SceneError: one line that names the file, or the change (as `--set`, which makes such
    changes).
    """
    data, name = as_data(source)
    return changed_scene(data, changes, name)
