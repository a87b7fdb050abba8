"""A warm-up as a dataset: temperatures, preload, pressure and stiffness over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene
from bearingwear.solvers.warmup.transient import (
    COARSER,
    STEP_TOLERANCE,
    Instant,
    NoState,
    SpeedCourse,
    WarmUp,
    warm_up,
)
from bearingwear.studies.dataset import dataset_of_rows

WARM_UP = "warm-up"
ENDINGS = ("steady", "runaway", "no_state", "duration")

_TIME = Variable("time", ("time",), "s", "time since the start")
_PARTS = Variable("part", ("part",), "", "part", "i1", flags=("inner_ring", "balls", "outer_ring"))
_OVER_TIME = table(
    Variable("shaft_speed", (), "rpm", "shaft speed", label="shaft speed"),
    Variable("part_temperature", ("side", "part"), "degC", "temperature of the part"),
    Variable("residual_preload", ("side",), "N", "preload on the bearing", label="preload"),
    Variable("maximum_pressure", ("side",), "Pa", "peak contact pressure", label="pressure"),
    Variable("friction_power", ("side",), "W", "heat of friction and drag", label="heat"),
    Variable("system_axial_stiffness", (), "N m-1", "axial stiffness of the arrangement"),
    Variable(
        "spring_travel",
        (),
        "m",
        "travel of the preload spring from where it was mounted",
        comment="positive where it extends; of a spring pair, or of two bearings like this one",
    ),
)
PEAKS = {
    "residual_preload": ("N", "largest preload"),
    "maximum_pressure": ("Pa", "largest contact pressure"),
    "temperature_difference": ("K", "largest excess of inner over outer ring"),
    "spring_compression": ("m", "largest compression of the spring"),
    "spring_extension": ("m", "largest extension of the spring"),
}
"""Units and words of the quantities whose peaks are given; the spring's only where there is one."""

SPRING = ("spring_compression", "spring_extension")
"""Names of `PEAKS` of the ways of the sliding ring."""
_SUMMARY = table(
    STATUS,
    Variable("ending", (), "", "how the warm-up ended", "i1", flags=ENDINGS),
    Variable("end_time", (), "s", "time of the last instant"),
    Variable("time_to_95_percent", (), "s",
        "time from which on every part has made 95 % of its rise to the last instant"),
    Variable("thermal_margin", (), "1", "conductance over slope of the heat at the last instant",
        comment="above 1, the temperatures are stable"),
    Variable("distance_left", (), "1", "distance to the steady temperatures, over the rise"),
    *(
        variable
        for name, (units, words) in PEAKS.items()
        for variable in (
            Variable(f"peak_{name}", (), units, words),
            Variable(f"peak_{name}_time", (), "s", f"{words}: its time"),
        )
    ),
    *(
        Variable(f"end_{name}", (), units, words.replace("largest", "last"))
        for name, (units, words) in PEAKS.items()
    ),
    Variable("error_estimate", (), "1", "numerical error of the peaks, relative",
        comment="difference from a warm-up with ten times the tolerance of a step"),
)  # fmt: skip


def warm_up_dataset(scene: Scene, course: SpeedCourse, duration: float | None = None) -> xr.Dataset:
    """Returns the warm-up of a scene along `time` [s], with its peaks and how it ended.

    It is solved twice: the error of the peaks is estimated from a second warm-up with coarser
    steps. Values of bearings are over `side`, which has the length 1 for a symmetric pair, too.

    course: of the speed, an attribute of the dataset: its times, then its shares of the full speed.
    duration: [s]; None up to the steady temperatures, or to the longest time that is followed.
    NotAvailable: the bearings have no state as mounted, so that there is no instant.
    """
    try:
        warmup = warm_up(scene, course, duration)
    except NoState as unsolved:
        name = code.STATUS_NAMES[unsolved.status]
        problem = f"no state at the start ({name}: {code.STATUS_SENTENCES[name]})"
        raise NotAvailable(f"{scene.name}: {problem}") from None
    times = [instant.time for instant in warmup.instants]
    rows = [_instant_values(scene, instant) for instant in warmup.instants]
    peaks = _peaks(times, rows)
    # over the same time, unless no step had a state (0 s)
    coarse_warmup = warm_up(scene, course, times[-1] or None, COARSER * STEP_TOLERANCE)
    coarse_peaks = peaks_of(scene, coarse_warmup)
    T = np.array([instant.temperatures.ravel() for instant in warmup.instants])
    summary = peaks | {
        "status": warmup.status,
        "ending": ENDINGS.index(_ending(warmup, duration)),
        "end_time": times[-1],
        "time_to_95_percent": _time_to_share(np.array(times), T, 0.95),
        "thermal_margin": warmup.margin,
        "distance_left": warmup.left,
        "error_estimate": _error_of_peaks(peaks, coarse_peaks),
    }
    over_time = dataset_of_rows(
        {name: variable for name, variable in _OVER_TIME.items() if name in rows[0]},
        {_TIME: times, _PARTS: None, "side": len(warmup.instants[0].states)},
        rows,
        scene=scene,
        kind=WARM_UP,
        title=f"Warm-up: {scene.name}",
        course=[*course.times, *course.shares],
    )
    summary_table = {name: variable for name, variable in _SUMMARY.items() if name in summary}
    return over_time.merge(dataset_of_rows(summary_table, {}, [summary]), combine_attrs="override")


def peaks_of(scene: Scene, warmup: WarmUp) -> dict[str, float]:
    """Returns the peaks of a warm-up, their times and the last values [SI].

    A value is the largest over all bearings and contacts; of equal peaks, the first gives the time.
    The names are `peak_NAME`, `peak_NAME_time` and `end_NAME` for the names of `PEAKS`. Those of a
    spring are 0 where it moves only the other way, and missing without a constant force.
    """
    times = [instant.time for instant in warmup.instants]
    return _peaks(times, [_instant_values(scene, instant) for instant in warmup.instants])


def _instant_values(scene: Scene, instant: Instant) -> dict[str, Any]:
    """Returns the values of an instant [SI, r/min, degC] by the names of variables over time.

    Lists and arrays have an item for each bearing. `spring_travel` is missing in a fixed position.
    """
    states = instant.states
    values = {
        "shaft_speed": instant.share * scene.operation.shaft_speed_rpm,
        "part_temperature": instant.temperatures,
        "residual_preload": [float(state["residual_preload"]) for state in states],
        "maximum_pressure": [float(np.max(state["maximum_pressure"])) for state in states],
        "friction_power": [heat.total for heat in instant.heats],
        "system_axial_stiffness": instant.stiffness,
    }
    if scene.operation.preload_method == "constant_force":
        values["spring_travel"] = states[0]["spring_travel"]
    return values


def _peaks(times: Sequence[float], rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Returns the peaks of a warm-up with their times, and its last values; see `peaks_of`.

    rows: values at each time, of `_instant_values`.
    """
    T = np.array([row["part_temperature"] for row in rows])  # (times, bearings, parts)
    courses = {
        "residual_preload": np.max([row["residual_preload"] for row in rows], axis=1),
        "maximum_pressure": np.max([row["maximum_pressure"] for row in rows], axis=1),
        # inner less outer ring, in the order of `_PARTS`
        "temperature_difference": (T[:, :, 0] - T[:, :, 2]).max(axis=1),
    }
    if "spring_travel" in rows[0]:
        travel = np.array([row["spring_travel"] for row in rows])
        courses["spring_compression"] = np.maximum(-travel, 0.0)
        courses["spring_extension"] = np.maximum(travel, 0.0)
    peaks: dict[str, float] = {}
    for name, course in courses.items():
        k = int(np.argmax(course))
        peaks |= {f"peak_{name}": float(course[k]), f"peak_{name}_time": times[k]}
        peaks[f"end_{name}"] = float(course[-1])
    return peaks


def _error_of_peaks(peaks: Mapping[str, float], coarse_peaks: Mapping[str, float]) -> float:
    """Returns the largest relative difference of a peak between two warm-ups, in magnitude.

    The differences of the spring are relative to the larger of its compression and extension. Peaks
    of 0 are left out.

    peaks, coarse_peaks: of `peaks_of`, of a warm-up and of one with coarser steps.
    """
    sizes = {name: abs(peaks[f"peak_{name}"]) for name in PEAKS if f"peak_{name}" in peaks}
    longer_way = max((sizes[name] for name in SPRING if name in sizes), default=0.0)
    sizes |= {name: longer_way for name in SPRING if name in sizes}
    return max(
        abs(coarse_peaks[f"peak_{name}"] - peaks[f"peak_{name}"]) / size
        for name, size in sizes.items()
        if size
    )


def _ending(warmup: WarmUp, duration: float | None) -> str:
    """Returns how a warm-up ended, one of `ENDINGS`.

    "steady" also stands for one that reached the longest time that is followed; `distance_left` of
    the file then says how far it was from the steady temperatures.

    duration: that it was to last [s]; None up to the steady temperatures.
    """
    if warmup.status != code.OK:
        return "runaway" if warmup.runs_away else "no_state"
    return "steady" if duration is None else "duration"


def _time_to_share(times: np.ndarray, T: np.ndarray, share: float) -> float:
    """Returns the time [s] from which on every temperature T has made a share of its rise.

    That is, abs(T - T_last) <= (1 - share) abs(T_first - T_last) from then on. The time is
    interpolated linearly between instants; it is 0 if that holds from the first one.

    times: (n,) [s].
    T: temperatures (n, parts) at these times; the last ones end the rise.
    """
    distance = np.abs(T[-1] - T)
    allowed = (1.0 - share) * np.abs(T[-1] - T[0])
    outside = np.flatnonzero((distance > allowed).any(axis=1))
    if not outside.size:
        return 0.0
    k = int(outside[-1]) + 1
    # linear between the last instant outside and the first inside
    before, after = distance[k - 1], distance[k]
    late = before > allowed
    part = (before - allowed)[late] / (before - after)[late]
    return float(times[k - 1] + part.max() * (times[k] - times[k - 1]))
