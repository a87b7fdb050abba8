"""Friction and wear of high-speed angular contact ball bearings.

`solve(scene)` and `life(scene)` take the path of a scene file, a dict of the same shape or a
`bearingwear.scene.scene.Scene`, and return an `xarray.Dataset`.
"""

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"
__all__ = ["__version__", "life", "solve"]

if TYPE_CHECKING:
    from bearingwear.api import life, solve


def __getattr__(name: str) -> Any:
    # numba and xarray take half a second to import: only who solves shall wait for them
    if name in ("life", "solve"):
        from bearingwear import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
