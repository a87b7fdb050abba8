"""Which preload of a design map to take: the longest life within the limits, and what limits it.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED, Measure
from bearingwear.results.netcdf import CaseFileError, load_kind
from bearingwear.results.units import digits
from bearingwear.results.variable import Variable
from bearingwear.results.words import in_words, scene_of
from bearingwear.studies.dataset import pareto
from bearingwear.studies.design.conditions import DECIDING, condition_words
from bearingwear.studies.design.document.words import NO_LIMIT, limit_text
from bearingwear.studies.design.map import NOT_SOLVED_AT, SLIP_SHARE
from bearingwear.studies.design.plan import DesignLimits

ACTIVE = (
    *LIMITED,
    "none",
    "end_of_range",
    "not_solved",
    "no_preload_within_limits",
    "end_of_life",
    "impractical",
    "cliff",
)
"""What keeps the recommended preload from one with a longer life."""
(
    UNLIMITED,
    END_OF_RANGE,
    NEXT_NOT_SOLVED,
    NO_PRELOAD,
    OTHER_END,
    NOT_PRACTICAL,
    AT_CLIFF,
) = range(len(LIMITED), len(ACTIVE))

ACTIVE_LIMIT = Variable(
    "active_limit", (), "", "requirement that prevents a longer life", dtype="i1", flags=ACTIVE
)


def design_map(parts: Sequence[Path], limits: Mapping[str, float]) -> xr.Dataset:
    """Step: all parts of a map as one dataset, with the best preload of every line of it."""
    found = {path: load_kind(path, "design map") for path in parts}
    first, attributes = next((path, one.attrs) for path, one in found.items())
    for path, one in found.items():
        if one.attrs != attributes:
            raise CaseFileError(f"{path}: differs from {first} in its scene, limits or sources")
    if json.loads(attributes["limits"]).get(SLIP_SHARE) != limits.get(SLIP_SHARE):
        raise CaseFileError(f"{first}: has a different requirement for the gyroscopic slip share")
    try:
        whole = xr.combine_by_coords(
            list(found.values()),
            combine_attrs="drop_conflicts",
            join="exact",
            compat="equals",
            data_vars="all",
        )
    except ValueError as error:
        raise CaseFileError(f"parts of a design map: {' '.join(str(error).split())}") from None
    assert isinstance(whole, xr.Dataset)
    if whole["status"].dtype.kind == "f":  # combining fills holes with NaN
        raise CaseFileError("some parts of the design map are missing")
    asked = dict(limits) | {"at_speed_only": True}  # as its parts are
    return with_choices(whole.assign_attrs(limits=json.dumps(asked)))


def with_choices(design: xr.Dataset) -> xr.Dataset:
    """A map with the best preload of every line of it."""
    index, active = best_within(design, limits_of(design))
    none = index < 0
    best = design.isel(preload=xr.where(none, 0, index))
    preload, life = best["preload"].where(~none), best["life"].where(~none)
    return design.assign(
        recommended_preload=preload.assign_attrs(
            long_name="preload that gives the longest life", units="N"
        ),
        recommended_life=life.assign_attrs(long_name="life at the recommended preload", units="h"),
        active_limit=active,
    )


def limits_of(design: xr.Dataset) -> DesignLimits:
    """The limits a map was made with."""
    return DesignLimits(**json.loads(design.attrs["limits"]))


NO_LIFE_SOLVED = "no life could be computed"


def limit_margins(values: Any, limits: DesignLimits) -> list[Any]:
    """Relative margin of each limit; negative where it is violated.

    In the order of `limits.held`; `values` is a Dataset or a dict of what `life_point` finds.
    """
    return [LIMITED[name].margins(values, limit) for name, limit in limits.held.items()]


def best_within(design: xr.Dataset, limits: DesignLimits) -> tuple[xr.DataArray, xr.DataArray]:
    """Index of the preload with the longest life within the limits, and the limit that holds it.

    Lives that were not solved are never chosen. The active limit is what keeps the choice from the
    neighbouring preload whose life is longer: the limit passed there by most, the end of the range,
    a neighbour that was not solved, or nothing (the life itself is longest there).

    Returns `index, active`: over the dimensions of the map but `preload`; index -1 where no preload
        is within the limits.
    """
    others = [str(dim) for dim in design["status"].dims if dim != "preload"]
    order = (*others, "preload")
    solved = (design["status"] == OK).transpose(*order).values
    lives = design["life"].transpose(*order).values
    each = [margin.transpose(*order).values for margin in limit_margins(design, limits)]
    each.append(np.where(design["impractical"].transpose(*order).values, -1.0, 1.0))
    names = [*limits.held, ACTIVE[NOT_PRACTICAL]]
    index = np.full(solved.shape[:-1], -1)
    active = np.full(solved.shape[:-1], NO_PRELOAD, dtype=np.int8)
    for line in np.ndindex(index.shape):
        margin = np.array([values[line] for values in each])
        allowed = solved[line] & (lives[line] > 0.0) & np.all(margin >= 0.0, axis=0)
        if allowed.any():
            best = int(np.argmax(np.where(allowed, lives[line], -np.inf)))
            index[line] = best
            active[line] = _held_by(best, solved[line], lives[line], margin, names)
    coords = {dim: design[dim] for dim in others}
    return (
        xr.DataArray(index, coords, others),
        xr.DataArray(active, coords, others, attrs=ACTIVE_LIMIT.attributes),
    )


def why_none(
    line: xr.Dataset,
    limits: DesignLimits,
    points: Sequence[Mapping[str, Any]] = (),
    cases: bool = False,
) -> str:
    """Which limits no preload of a line keeps to, how near one comes, and where.

    points: what the line is made of, by its preloads; none where that is not known.
    cases: whether the scene has several, which are then named.
    """
    solved = (line["status"] == OK).values
    alive = solved & (line["life"].values > 0.0)
    if not alive.any():
        at_once = "an end-of-life criterion is met when the bearing is new"
        if not solved.any():
            return f"{NO_LIFE_SOLVED}{_unsolved_words(points, cases)}"
        first = _point(points, int(np.argmax(solved))).get(DECIDING, {}).get("life")
        return f"{at_once} (case {first['case']})" if first and cases else at_once
    usable = np.flatnonzero(alive & (line["impractical"].values == 0))
    if not usable.size:
        return "the design is impractical at every preload"
    if not limits.given:
        return NO_LIMIT
    failed, is_together = least_violations(line, limits)
    before, but = "", "at best "
    if is_together:
        before = "each requirement can be satisfied individually, but not all of them together: "
        but = "but "
    return before + "; ".join(
        f"{_held_text(name, limits)}, {but}"
        f"{digits(float(LIMITED[name].shown(LIMITED[name].worst(line)[k])))} "
        f"at {digits(float(line['preload'][k]))} N{_where_words(_point(points, k), name, cases)}"
        for name, k in failed.items()
    )


def _point(points: Sequence[Mapping[str, Any]], k: int) -> Mapping[str, Any]:
    return points[k] if points else {}


def least_violations(line: xr.Dataset, limits: DesignLimits) -> tuple[dict[str, int], bool]:
    """Limits that no preload of a line keeps to, each with the preload that comes nearest.

    Where each is kept somewhere, those that are violated where all together are violated the least.
    Returns the limits, each with the index of its preload, and whether they are such.
    """
    alive = (line["status"] == OK).values & (line["life"].values > 0.0)
    usable = np.flatnonzero(alive & (line["impractical"].values == 0))
    if not usable.size or not limits.held:
        return {}, False
    margin = np.array([one.values for one in limit_margins(line, limits)])
    nearest = usable[margin[:, usable].argmax(axis=1)]
    failed = {
        name: int(nearest[k]) for k, name in enumerate(limits.held) if margin[k, nearest[k]] < 0.0
    }
    if failed:
        return failed, False
    best = int(usable[margin[:, usable].min(axis=0).argmax()])
    return {name: best for k, name in enumerate(limits.held) if margin[k, best] < 0.0}, True


def _held_text(name: str, limits: DesignLimits) -> str:
    """A limit in words, and what for if nobody asked for it."""
    text = limit_text(name, limits.held[name])
    return text if name in limits.given else f"no bearing lifts off ({text})"


def _where_words(point: Mapping[str, Any], name: str, cases: bool) -> str:
    """Where a limited measure is the worst, after its value."""
    deciding = point.get(DECIDING, {})
    known = [deciding[one] for one in LIMITED[name].extremes if one in deciding]
    if not known or LIMITED[name].resting:
        return ""
    measure = LIMITED[name]
    worst = (min if measure.falls else max)(known, key=lambda one: abs(one["value"]))
    return f" ({condition_words(worst, cases)})"


def _unsolved_words(points: Sequence[Mapping[str, Any]], cases: bool) -> str:
    """Where most of some points were not solved, and why; nothing where no point says so."""
    told = [
        f"{condition_words(one, cases)}: {in_words(one['status'])}"
        for point in points
        if (one := point.get(NOT_SOLVED_AT))
    ]
    return f" ({max(told, key=told.count)})" if told else ""


def _held_by(
    best: int, solved: np.ndarray, lives: np.ndarray, margin: np.ndarray, names: list[str]
) -> int:
    """What keeps a line's best preload from its neighbour with the longer life."""
    neighbours = [k for k in (best - 1, best + 1) if 0 <= k < len(lives)]
    longer = [k for k in neighbours if solved[k] and lives[k] > lives[best]]
    if longer:  # passes a limit, or it would have been chosen
        beyond = max(longer, key=lambda k: lives[k])
        return ACTIVE.index(names[int(np.argmin(margin[:, beyond]))])
    if any(not solved[k] for k in neighbours):
        return NEXT_NOT_SOLVED
    return END_OF_RANGE if len(neighbours) < 2 else UNLIMITED


def preload_text(one: xr.Dataset) -> str:
    """The recommended preload of a method [N], in as many digits as it is to be set with."""
    return f"{float(one['preload']):.7g}".replace("nan", "–")


def stiffness_of(design: xr.Dataset) -> Measure:
    """The stiffness that counts: what the rotor feels, unless that of one bearing is limited."""
    given = json.loads(design.attrs.get("limits", "{}"))
    rotor, bearing = LIMITED["system_axial_stiffness_N_um"], LIMITED["axial_stiffness_N_um"]
    return bearing if bearing.key in given and rotor.key not in given else rotor


def front(design: xr.Dataset) -> xr.DataArray:
    """Which points of a map no other beats in both life and stiffness (dimensions of the map)."""
    solved = design["status"] == OK
    lives = design["life"].where(solved)
    stiffness = stiffness_of(design).worst(design).where(solved).transpose(*lives.dims)
    best = pareto(-stiffness.values.ravel(), -lives.values.ravel()).reshape(lives.shape)
    return xr.DataArray(best, lives.coords, lives.dims) & (lives > 0.0)


def design_files(
    design: Path, recommendation: Path, uncertainty: Path | None = None
) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset | None]:
    """Read the files of one scene; CaseFileError for one of another scene, kind or methods."""
    kinds = {design: "design map", recommendation: "recommendation"}
    if uncertainty is not None:
        kinds[uncertainty] = "uncertainty"
    found = {path: load_kind(path, kind) for path, kind in kinds.items()}
    for path in kinds:
        if found[path].attrs["scene"] != found[design].attrs["scene"]:
            raise CaseFileError(f"{path}: got another scene, expected that of {design}")
        if not found[path]["preload_method"].equals(found[design]["preload_method"]):
            raise CaseFileError(
                f"{path}: got different preload methods, expected those of {design}"
            )
    sampled = None if uncertainty is None else found[uncertainty]
    return found[design], found[recommendation], sampled


def at_scene(design: xr.Dataset) -> xr.Dataset:
    """The line of a map at the scene's own friction and speed."""
    scene = scene_of(design)
    return design.sel(
        friction=scene["friction"]["ball_race"], shaft_speed=scene["operation"]["shaft_speed_rpm"]
    )
