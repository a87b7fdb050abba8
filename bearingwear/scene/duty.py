"""The duty of a bearing: phases of use in a cycle that repeats until the life ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.checking.errors import SceneError, shown
from bearingwear.scene.checking.records import NAME, keyed, record_hash, reduced_record, setting

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

_MOST, _RAMP = "[0, 1e6]", "[0, 1e5]"
_HOUR = 3600.0


@keyed
class Phase:
    """One phase of a cycle of use."""

    # fmt: off
    hours: float = setting("Time at the speed of the phase in each cycle", "h", _MOST, default=0.0)
    starts: float = setting("Starts from rest, each with a stop, in each cycle", "1", _MOST,
        default=0.0)
    case: str | None = setting("Case of the scene that applies during the phase (if omitted, the "
        "case with the name of the phase; nominal is the scene itself)", pattern=NAME,
        default=None)
    # fmt: on


@keyed
class Duty:
    """Phases of use that are repeated, in their order, until the life ends."""

    # fmt: off
    phases: Mapping[str, Phase] = setting("Phases of one cycle, each under the name of its case",
        least=1, most=100, each="One phase")
    start_s: float = setting("Time of one start from rest to the speed of the phase (if it and "
        "stop_s are 0, starts cause no wear)", "s", _RAMP, default=0.0)
    stop_s: float = setting("Time of one stop from the speed of the phase to rest", "s", _RAMP,
        default=0.0)
    warmup: bool = setting("Whether each start warms the bearings from the mounting temperature, "
        "which requires thermal.heat_capacity_J_K (if not, each phase is warm from its first "
        "second)", default=False)
    # fmt: on

    def __post_init__(self) -> None:
        """Makes `phases` read-only; refuses phases without hours or starts, and a cycle of 0 s."""
        object.__setattr__(self, "phases", MappingProxyType(dict(self.phases)))
        for name, phase in self.phases.items():
            if not phase.hours > 0.0 and not phase.starts > 0.0:
                problem = "got 0 hours and no starts, expected hours > 0 or starts > 0"
                raise SceneError(f"phases.{name}", problem)
        if not self.cycle_s > 0.0:
            problem = "got a cycle that takes no time, expected hours, or start_s or stop_s > 0"
            raise SceneError("phases", problem, ("start_s", "stop_s"))

    def __hash__(self) -> int:
        """Returns a hash of all fields, although a mapping proxy has none of its own."""
        return record_hash(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what pickle makes a copy from."""
        return reduced_record(self)

    @property
    def cycle_s(self) -> float:
        """Returns the time of one cycle [s].

        `math.fsum` makes it independent of the order of phases to the last digit.
        """
        return math.fsum(self.phase_s(phase) for phase in self.phases.values())

    @property
    def ramp_s(self) -> float:
        """Returns the time of one start and one stop [s]."""
        return self.start_s + self.stop_s

    @property
    def steady_ramp_s(self) -> float:
        """Returns the time of one start and one stop [s], without a start that is a warm-up.

        The states of a warm-up are not steady.
        """
        return self.stop_s if self.warmup else self.ramp_s

    def phase_s(self, phase: Phase) -> float:
        """Returns the time of a phase in one cycle [s], its starts and stops included."""
        return _HOUR * phase.hours + phase.starts * self.ramp_s

    def running_s(self, phase: Phase) -> float:
        """Returns the time at the speed of a phase in one cycle [s], without starts and stops."""
        return _HOUR * phase.hours

    @property
    def starts(self) -> float:
        """Returns the number of starts in one cycle."""
        return sum(phase.starts for phase in self.phases.values())

    def case_of(self, name: str) -> str:
        """Returns the name of the case that applies during a phase."""
        return self.phases[name].case or name


def check_duty(scene: Scene) -> None:
    """Refuses a duty with a phase whose case the scene lacks."""
    duty, cases = scene.duty, scene.cases or {}
    if duty is None:
        return
    for name in duty.phases:
        case = duty.case_of(name)
        if case != NOMINAL and case not in cases:
            key = f"duty.phases.{name}" + (".case" if duty.phases[name].case else "")
            names = ", ".join([NOMINAL, *cases])
            raise SceneError(key, f"got {shown(case)}, expected a case: {names}", ("cases",))


def check_phases(scene: Scene) -> None:
    """Refuses a warm-up without heat capacities, and cases that change what all phases share.

    The phases share the bearing with its cage, the model, the wear and its criteria, thicknesses of
    films and depths of running in, and how the bearings are arranged. Raises SceneError.
    """
    if scene.duty is None:
        return
    if scene.duty.warmup:
        _check_warm_starts(scene, scene.duty)
    nominal = _fixed_over_duty(scene)
    for case, phase_scene in phase_cases(scene).items():
        fixed = _fixed_over_duty(phase_scene)
        for block in fixed:
            if fixed[block] != nominal[block]:
                raise _changed_block_error(scene, case, block)


def _changed_block_error(scene: Scene, case: str, block: str) -> SceneError:
    """Returns the error of a case of a duty that changes a block which all phases share."""
    changes = (scene.cases or {})[case]
    key = next((key for key in changes if f"{key}.".startswith(f"{block}.")), block)
    problem = (
        f"got {shown(changes.get(key))} in a case of the duty, expected a key that "
        "leaves the bearing, its films and its criteria as they are"
    )
    return SceneError(f"cases.{case}.{key}", problem, ("duty",))


def _check_warm_starts(scene: Scene, duty: Duty) -> None:
    """Refuses starts with a warm-up where a bearing has no heat capacities."""
    cases_with_starts = [duty.case_of(name) for name, phase in duty.phases.items() if phase.starts]
    for case in cases_with_starts:
        for side in scene.in_cases[case].sides:
            if side.thermal is None or side.thermal.heat_capacity_J_K is None:
                problem = (
                    "got true, expected a thermal network with heat_capacity_J_K in the case "
                    f"{case}, which starts"
                )
                raise SceneError("duty.warmup", problem, ("thermal",))


def _fixed_over_duty(scene: Scene) -> dict[str, Any]:
    """Returns the values that all phases of a duty must share, by the blocks of a scene.

    They determine the wear and its end, so that a change would be another bearing.
    """
    arrangement, film = scene.arrangement, scene.friction.film
    second = {} if arrangement is None else arrangement.second
    surfaces = {
        name: (
            None if material.film is None else material.film.thickness_um,
            None if material.running_in is None else material.running_in.depth_um,
        )
        for name, material in scene.materials.items()
    }
    return {
        "bearing": scene.bearing,
        "cage": scene.cage,
        "wear": scene.wear,
        "model": scene.model,
        # a film without a thickness is not the same as no film
        "friction.film": (film is None, None if film is None else film.thickness_um),
        "materials": surfaces,
        "arrangement": (
            None if arrangement is None else (arrangement.orientation, arrangement.tandem),
            [(key, second[key]) for key in second if key.startswith(("bearing.", "wear."))],
        ),
    }


def phase_cases(scene: Scene) -> dict[str, Scene]:
    """Returns by name the cases of a scene that phases of its duty use.

    They are in the order of the cases, so that nothing depends on the order of the phases.
    """
    assert scene.duty is not None
    names = {scene.duty.case_of(phase) for phase in scene.duty.phases}
    return {name: case for name, case in scene.in_cases.items() if name in names}


def cases_of_use(scene: Scene) -> dict[str, Scene]:
    """Returns by name the cases of a scene in which requirements hold: those of a duty, or all."""
    return scene.in_cases if scene.duty is None else phase_cases(scene)
