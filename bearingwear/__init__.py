"""Friction and wear of high-speed angular contact ball bearings.

    scene = bearingwear.new(bore=40, outside=68)  # or load("mine.yaml"), or example()
    case = bearingwear.solve(scene.with_({"operation.preload_N": 200}))
    lives = bearingwear.sweep(scene, {"operation.preload_N": [100, 200, 300]}, what="life")

Results are `xarray.Dataset`s. docs/python.md explains the functions, docs/variables.md lists the
variables.
"""

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"
__all__ = [
    "Scene",
    "SceneError",
    "__version__",
    "cage",
    "calibrate",
    "example",
    "life",
    "load",
    "new",
    "plot",
    "save",
    "show",
    "solve",
    "sweep",
    "to_ross",
    "warmup",
]

if TYPE_CHECKING:
    from bearingwear.api import (
        cage,
        calibrate,
        example,
        life,
        load,
        new,
        plot,
        save,
        show,
        solve,
        sweep,
        to_ross,
        warmup,
    )
    from bearingwear.scene.scene import Scene, SceneError


def __getattr__(name: str) -> Any:
    # numba and xarray take half a second to import: only who solves shall wait for them
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = "scene.scene" if name.startswith("Scene") else "api"
    return getattr(importlib.import_module(f"bearingwear.{home}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
