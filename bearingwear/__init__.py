"""Friction and wear of high-speed angular contact ball bearings.

    scene = bearingwear.new("7008C")  # or load("mine.yaml"), or example()
    case = bearingwear.solve(scene.with_({"operation.preload_N": 200}))
    lives = bearingwear.sweep(scene, {"operation.preload_N": [100, 200, 300]}, what="life")

Results are `xarray.Dataset`s. docs/python.md explains the functions, docs/variables.md lists the
variables.
"""

import importlib
from typing import TYPE_CHECKING, Any

from bearingwear.application import application_functions

__version__ = "0.1.0"

_FUNCTIONS = {
    "Scene": "scene.scene",
    "SceneError": "scene.scene",
    "example": "api",
    "life": "api",
    "load": "api",
    "new": "api",
    "plot": "api",
    "recommend": "api",
    "save": "api",
    "show": "api",
    "solve": "api",
    "sweep": "api",
    "uncertainty": "api",
    "warmup": "api",
}
"""Modules below `bearingwear` that define the public names; applications add further names."""

__all__ = ["__version__", *_FUNCTIONS, *application_functions()]  # noqa: PLE0604

if TYPE_CHECKING:
    from bearingwear.api import example as example
    from bearingwear.api import life as life
    from bearingwear.api import load as load
    from bearingwear.api import new as new
    from bearingwear.api import plot as plot
    from bearingwear.api import recommend as recommend
    from bearingwear.api import save as save
    from bearingwear.api import show as show
    from bearingwear.api import solve as solve
    from bearingwear.api import sweep as sweep
    from bearingwear.api import uncertainty as uncertainty
    from bearingwear.api import warmup as warmup
    from bearingwear.applications.cage.command import cage as cage
    from bearingwear.applications.calibrate.command import calibrate as calibrate
    from bearingwear.applications.export.stiffness import to_ross as to_ross
    from bearingwear.applications.launch.command import launch as launch
    from bearingwear.applications.margin.command import margin as margin
    from bearingwear.scene.scene import Scene as Scene
    from bearingwear.scene.scene import SceneError as SceneError


def __getattr__(name: str) -> Any:
    """Returns a public name, whose module is imported only now.

    The command line imports the package without numba and xarray, which take half a second.
    """
    if name in _FUNCTIONS:
        module, function = f"bearingwear.{_FUNCTIONS[name]}", name
    elif name in __all__:
        module, _, function = application_functions()[name].partition(":")
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(module), function)


def __dir__() -> list[str]:
    """Returns the public names, also those whose modules are not imported yet."""
    return sorted(__all__)
