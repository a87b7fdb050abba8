"""Which preload of a design map to take: the longest life within the limits, and what limits it.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED, Measure
from bearingwear.results.netcdf import CaseFileError, load_kind
from bearingwear.results.variable import Variable
from bearingwear.results.words import plain_scene
from bearingwear.studies.dataset import pareto
from bearingwear.studies.design.map import SLIP_SHARE
from bearingwear.studies.design.plan import NO_FRICTION, DesignLimits

ACTIVE = (
    *LIMITED,
    "none",
    "end_of_range",
    "not_solved",
    "no_preload_within_limits",
    "end_of_life",
    "impractical",
)
"""What keeps the recommended preload from one with a longer life."""
(
    UNLIMITED,
    END_OF_RANGE,
    NEXT_NOT_SOLVED,
    NO_PRELOAD,
    OTHER_END,
    NOT_PRACTICAL,
) = range(len(LIMITED), len(ACTIVE))

ACTIVE_LIMIT = Variable(
    "active_limit", (), "", "requirement that prevents a longer life", dtype="i1", flags=ACTIVE
)


def design_map(parts: Sequence[Path], limits: Mapping[str, float]) -> xr.Dataset:
    """Step: returns all parts of a map as one dataset, with the best preload of every line.

    A line has one preload method, friction and speed. The parts were solved without requirements,
    except that on the gyroscopic slip share.

    limits: requirements by the keys of `DesignLimits`.
    CaseFileError: parts of different maps, a missing part, or another slip limit in the parts.
    """
    maps = {path: load_kind(path, "design map") for path in parts}
    first_path = next(iter(maps))
    attributes = maps[first_path].attrs
    for path, part in maps.items():
        if part.attrs != attributes:
            problem = f"differs from {first_path} in its scene, limits or sources"
            raise CaseFileError(f"{path}: {problem}")
    if json.loads(attributes["limits"]).get(SLIP_SHARE) != limits.get(SLIP_SHARE):
        raise CaseFileError(
            f"{first_path}: has a different requirement for the gyroscopic slip share"
        )
    try:
        design = xr.combine_by_coords(
            list(maps.values()),
            combine_attrs="drop_conflicts",
            join="exact",
            compat="equals",
            data_vars="all",
        )
    except ValueError as error:
        raise CaseFileError(f"parts of a design map: {' '.join(str(error).split())}") from None
    assert isinstance(design, xr.Dataset)
    if design["status"].dtype.kind == "f":  # combining fills holes with NaN
        raise CaseFileError("some parts of the design map are missing")
    stored_limits = dict(limits) | {"at_speed_only": True}  # as its parts are
    return with_choices(design.assign_attrs(limits=json.dumps(stored_limits)))


def with_choices(design: xr.Dataset) -> xr.Dataset:
    """Returns a map with the best preload, life and active limit of every line of it.

    Preload and life are NaN where no preload is within the limits.
    """
    index, active = best_within(design, limits_of(design))
    has_best = index >= 0
    best = design.isel(preload=xr.where(has_best, index, 0))
    preload = best["preload"].where(has_best)
    life = best["life"].where(has_best)
    return design.assign(
        recommended_preload=preload.assign_attrs(
            long_name="preload that gives the longest life", units="N"
        ),
        recommended_life=life.assign_attrs(long_name="life at the recommended preload", units="h"),
        active_limit=active,
    )


def limits_of(design: xr.Dataset) -> DesignLimits:
    """Returns the limits in the attributes of a map or a recommendation."""
    return DesignLimits(**json.loads(design.attrs["limits"]))


def limit_margins(values: Any, limits: DesignLimits) -> list[Any]:
    """Returns the relative margin of each limit, negative where it is violated.

    The margins have the type of the values, and the order of `limits.effective`.

    values: a dataset, or a mapping of the values of a design point, by the names of extremes.
    """
    return [LIMITED[name].margins(values, limit) for name, limit in limits.effective.items()]


class _LineOfMap(NamedTuple):
    """Points of a map along the preload."""

    is_solved: np.ndarray  # (preloads,)
    lives: np.ndarray  # (preloads,) [h]
    # (n + 1, preloads): of n limits, and last 1 for a practical design or -1 for another
    margins: np.ndarray

    @property
    def best_index(self) -> int | None:
        """Returns the index along the preload of the longest life within the limits.

        None if no preload is within them.
        """
        is_allowed = self.is_solved & (self.lives > 0.0) & np.all(self.margins >= 0.0, axis=0)
        lives = np.where(is_allowed, self.lives, -np.inf)
        return int(np.argmax(lives)) if is_allowed.any() else None

    def active_limit(self, best: int, names: Sequence[str]) -> int:
        """Returns the index into `ACTIVE` of what keeps the best preload from a longer life.

        It is the limit that the neighbour with the longest life violates by most, if that life is
        longer than the best. Otherwise it is a neighbour that was not solved, the end of the range,
        or nothing.

        best: index of the best preload.
        names: items of `ACTIVE`, one for each margin.
        """
        neighbours = [k for k in (best - 1, best + 1) if 0 <= k < len(self.lives)]
        longer = [k for k in neighbours if self.is_solved[k] and self.lives[k] > self.lives[best]]
        if longer:  # violates a limit, or it would have been chosen
            longest = max(longer, key=lambda k: self.lives[k])
            return ACTIVE.index(names[int(np.argmin(self.margins[:, longest]))])
        if any(not self.is_solved[k] for k in neighbours):
            return NEXT_NOT_SOLVED
        return END_OF_RANGE if len(neighbours) < 2 else UNLIMITED


def best_within(design: xr.Dataset, limits: DesignLimits) -> tuple[xr.DataArray, xr.DataArray]:
    """Returns the index of the best preload of each line of a map, and what limits it.

    The best preload has the longest life within the limits. Both arrays have the dimensions of the
    map without `preload`. The second has indices into `ACTIVE`, see `_LineOfMap.active_limit`.
    Where no preload is within the limits, the first is -1 and the second `NO_PRELOAD`.
    """
    dims = [str(dim) for dim in design["status"].dims if dim != "preload"]
    order = (*dims, "preload")
    is_solved = (design["status"] == OK).transpose(*order).values
    lives = design["life"].transpose(*order).values
    margins = [margin.transpose(*order).values for margin in limit_margins(design, limits)]
    margins.append(np.where(design["impractical"].transpose(*order).values, -1.0, 1.0))
    names = [*limits.effective, ACTIVE[NOT_PRACTICAL]]
    index = np.full(is_solved.shape[:-1], -1)
    active = np.full(is_solved.shape[:-1], NO_PRELOAD, dtype=np.int8)
    for place in np.ndindex(index.shape):
        line_margins = np.array([margin[place] for margin in margins])
        line = _LineOfMap(is_solved[place], lives[place], line_margins)
        best = line.best_index
        if best is not None:
            index[place] = best
            active[place] = line.active_limit(best, names)
    coords = {dim: design[dim] for dim in dims}
    return (
        xr.DataArray(index, coords, dims),
        xr.DataArray(active, coords, dims, attrs=ACTIVE_LIMIT.attributes),
    )


def preload_text(recommended: xr.Dataset) -> str:
    """Returns the recommended preload of a method [N] as text, in the digits to set it with.

    A dash stands for none.
    """
    return f"{float(recommended['preload']):.7g}".replace("nan", "–")


def stiffness_of(design: xr.Dataset) -> Measure:
    """Returns the measure of axial stiffness that counts: of the arrangement, or of a bearing.

    It is that of a bearing if a requirement limits it and no requirement limits the other.
    """
    limits = json.loads(design.attrs.get("limits", "{}"))
    arrangement = LIMITED["system_axial_stiffness_N_um"]
    bearing = LIMITED["axial_stiffness_N_um"]
    if bearing.key in limits and arrangement.key not in limits:
        return bearing
    return arrangement


def pareto_front(design: xr.Dataset) -> xr.DataArray:
    """Returns a mask over a map, true at its Pareto front of life and stiffness.

    For a point of the front, no other point is at least as good in both and better in one. Points
    that were not solved, and those with a life of zero or infinity, are not on the front.
    """
    solved = design["status"] == OK
    lives = design["life"].where(solved)
    stiffness = stiffness_of(design).worst(design).where(solved).transpose(*lives.dims)
    is_on_front = pareto(-stiffness.values.ravel(), -lives.values.ravel()).reshape(lives.shape)
    return xr.DataArray(is_on_front, lives.coords, lives.dims) & (lives > 0.0)


def design_files(
    design: Path, recommendation: Path, uncertainty: Path | None = None
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset | None]:
    """Returns the map, the recommendation and the uncertainty of one scene, as datasets.

    The last is None without a file of uncertainty.

    CaseFileError: a file of another scene, kind or preload methods.
    """
    kinds = {design: "design map", recommendation: "recommendation"}
    if uncertainty is not None:
        kinds[uncertainty] = "uncertainty"
    datasets = {path: load_kind(path, kind) for path, kind in kinds.items()}
    lives = datasets[design]
    for path, dataset in datasets.items():
        if dataset.attrs["scene"] != lives.attrs["scene"]:
            raise CaseFileError(f"{path}: got another scene, expected that of {design}")
        if not dataset["preload_method"].equals(lives["preload_method"]):
            raise CaseFileError(
                f"{path}: got different preload methods, expected those of {design}"
            )
    sampled = None if uncertainty is None else datasets[uncertainty]
    return lives, datasets[recommendation], sampled


def line_of_scene(design: xr.Dataset) -> xr.Dataset:
    """Returns a map at the scene's own friction and speed, over preload method and preload."""
    scene = plain_scene(design)
    mu = scene["friction"].get("ball_race")
    return design.sel(
        friction=NO_FRICTION if mu is None else mu,
        shaft_speed=scene["operation"]["shaft_speed_rpm"],
    )
