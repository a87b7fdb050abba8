"""The result of a life over a duty."""

import time
from dataclasses import replace

from bearingwear.kernels import status as code
from bearingwear.lives.duty.errors import duty_errors
from bearingwear.lives.duty.lives import DutyLife, duty_life, lives_alone
from bearingwear.lives.duty.values import duty_values, duty_warnings, in_phases
from bearingwear.lives.groove_life import groove_values
from bearingwear.lives.history import joined, life_values
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.duty import phase_cases
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.growth import lasting_growth
from bearingwear.solvers.effects.choice import Choice, choice_for_life
from bearingwear.solvers.effects.criterion import end_attribute
from bearingwear.solvers.effects.warnings import warnings_of
from bearingwear.solvers.result import Result
from bearingwear.solvers.solve import result_of
from kerneljit.interrupt import Interrupt


def choices_of_phases(scene: Scene, fidelity: str | None = None) -> dict[str, Choice]:
    """The model of each case of a duty; NotAvailable where one has no steady state."""
    chosen = {case: choice_for_life(one, fidelity) for case, one in phase_cases(scene).items()}
    for case, one in chosen.items():
        if one.fidelity == "dynamic":
            raise NotAvailable(
                f"{scene.name}: duty: got the case {case}, which requires the dynamic model "
                f"({one.why}), expected cases with a steady state; --case {case} takes it alone"
            )
    if len({one.fidelity for one in chosen.values()}) > 1:
        models = ", ".join(f"{case} {one.fidelity}" for case, one in chosen.items())
        raise NotAvailable(
            f"{scene.name}: duty: got cases with different models ({models}), expected one model; "
            "see model.fidelity"
        )
    return chosen


def life_over_duty(scene: Scene, fidelity: str | None = None) -> Result:
    """Wear life of a scene over its duty, from its present loss of ball diameter on.

    Histories are those of the phase that ends the life. NotAvailable as `choices_of_phases`.
    """
    assert scene.duty is not None
    chosen, started = choices_of_phases(scene, fidelity), time.perf_counter()
    model = next(iter(chosen.values())).fidelity
    with Interrupt():
        found = duty_life(scene, model)
        case = found.ending_case
        values, of_cases = _values(scene, found, model)
    elapsed = time.perf_counter() - started
    name = found.cycle.cases[case]
    phase = found.cycle.phases[found.cycle.case_of_phase.index(case)]
    attrs = {
        "phases": " ".join(found.cycle.phases),
        "ended_in": "all phases" if found.ends_in_all_cases else f"phase {phase}",
        "contact": "worn" if found.is_worn else "hertz",
        "solves": found.life.solves,
        "wear_counts": scene.wear.counts,
    }
    if found.life.status not in (code.OK, code.CRITERION_NOT_REACHED):
        attrs["unsolved_phase"] = phase
    attrs |= end_attribute(scene.in_cases[name], values)
    warnings = in_phases(
        {c: warnings_of(scene.in_cases[c], chosen[c], one) for c, one in of_cases.items()}
    )
    if found.life.nodes[0].status == code.OK:
        warnings += duty_warnings(scene.duty, found, values)
    choice = replace(chosen[name], grooves=found.grooves)
    return result_of(scene, choice, values, attrs, elapsed, warnings)


def _values(scene: Scene, found: DutyLife, fidelity: str) -> tuple[dict, dict[str, dict]]:
    """Result variables of the life, and those of its bearings in each case."""
    assert scene.duty is not None
    cycle, of_cases = found.cycle, {}
    if found.life.nodes[0].status != code.OK:
        values: dict = {"status": found.life.status, "end_criterion": found.life.criterion}
        return values, {cycle.cases[found.ending_case]: values}
    for case, life in found.by_case.items():
        k = cycle.cases.index(case)
        values = life_values(cycle.scenes[k], life)
        if found.is_worn and life.nodes[0].status == code.OK:
            each = zip(life.wearing.sides, life.bearings, strict=True)
            values |= joined([groove_values(side, states) for side, states in each])
        of_cases[case] = values
    own = of_cases[cycle.cases[found.ending_case]]
    if "life" in own:
        own |= duty_errors(scene, found, fidelity)
        if found.life.last.time > 0.0:
            own |= duty_values(scene.duty, found, lives_alone(found, fidelity))
    if scene.pair is not None and cycle.bearings == 1:
        of_cases = {case: joined([values, values]) for case, values in of_cases.items()}
    for case, values in of_cases.items():
        values |= lasting_growth(scene.in_cases[case])
    return of_cases[cycle.cases[found.ending_case]], of_cases
