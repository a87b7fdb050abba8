"""The result of a life over a duty."""

import time
from dataclasses import replace

from bearingwear.kernels import status as code
from bearingwear.lives.duty.errors import duty_errors
from bearingwear.lives.duty.lives import DutyLife, duty_life, lives_alone
from bearingwear.lives.duty.values import duty_values, duty_warnings, warnings_over_cases
from bearingwear.lives.groove_life import life_groove_values
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
    """Returns the choice of the model by the names of the cases of a duty.

    Raises NotAvailable where one requires the dynamic model, or where they need different models.

    fidelity: model in place of that of the scene.
    """
    scenes = phase_cases(scene)
    choices = {case: choice_for_life(scenes[case], fidelity) for case in scenes}
    for case, choice in choices.items():
        if choice.fidelity == "dynamic":
            raise NotAvailable(
                f"{scene.name}: duty: got the case {case}, which requires the dynamic model "
                f"({choice.why}), expected cases with a steady state; --case {case} takes it alone"
            )
    if len({choice.fidelity for choice in choices.values()}) > 1:
        models = ", ".join(f"{case} {choice.fidelity}" for case, choice in choices.items())
        raise NotAvailable(
            f"{scene.name}: duty: got cases with different models ({models}), expected one model; "
            "see model.fidelity"
        )
    return choices


def life_over_duty(scene: Scene, fidelity: str | None = None) -> Result:
    """Returns the wear life of a scene over its duty, from its present loss of ball diameter on.

    Histories are those of the case that ends the life. Raises NotAvailable as `choices_of_phases`,
    and where a start of a duty that warms up does not become steady.
    """
    assert scene.duty is not None
    choices = choices_of_phases(scene, fidelity)
    started = time.perf_counter()
    model = next(iter(choices.values())).fidelity
    with Interrupt():
        over_duty = duty_life(scene, model)
        cycle = over_duty.cycle
        ending_case = cycle.cases[over_duty.ending_case_index]
        values_by_case = _values_by_case(scene, over_duty, model)
    elapsed = time.perf_counter() - started
    values = values_by_case[ending_case]
    phase = cycle.phases[cycle.case_of_phase.index(over_duty.ending_case_index)]
    attrs = {
        "phases": " ".join(cycle.phases),
        "ended_in": "all phases" if over_duty.ends_in_all_cases else f"phase {phase}",
        "contact": "worn" if over_duty.is_worn else "hertz",
        "solves": over_duty.life.solves,
        "wear_counts": scene.wear.counts,
    }
    if over_duty.life.status not in (code.OK, code.CRITERION_NOT_REACHED):
        attrs["unsolved_phase"] = phase
    attrs |= end_attribute(scene.in_cases[ending_case], values)
    warnings = warnings_over_cases(
        {
            case: warnings_of(scene.in_cases[case], choices[case], case_values)
            for case, case_values in values_by_case.items()
        }
    )
    if over_duty.life.nodes[0].status == code.OK:
        warnings += duty_warnings(scene.duty, over_duty, values)
    choice = replace(choices[ending_case], grooves=over_duty.grooves)
    return result_of(scene, choice, values, attrs, elapsed, warnings)


def _values_by_case(scene: Scene, over_duty: DutyLife, fidelity: str) -> dict[str, dict]:
    """Returns the result variables of the bearings by the names of the cases.

    Those of the case that ends the life have also the errors and the shares of the phases. If the
    start is not solved, that case alone is there, with the status and the criterion.
    """
    assert scene.duty is not None
    cycle, life = over_duty.cycle, over_duty.life
    ending_case = cycle.cases[over_duty.ending_case_index]
    if life.nodes[0].status != code.OK:
        return {ending_case: {"status": life.status, "end_criterion": life.criterion}}
    by_case = {}
    for case_scene, (case, case_life) in zip(
        cycle.case_scenes, over_duty.by_case.items(), strict=True
    ):
        values = life_values(case_scene, case_life)
        if over_duty.is_worn and case_life.nodes[0].status == code.OK:
            values |= life_groove_values(case_life)
        by_case[case] = values
    ending_values = by_case[ending_case]
    if "life" in ending_values:
        ending_values |= duty_errors(scene, over_duty, fidelity)
        if life.last.time > 0.0:
            alone = lives_alone(over_duty, fidelity)
            ending_values |= duty_values(scene.duty, over_duty, alone)
    if scene.pair is not None and cycle.bearings == 1:
        by_case = {case: joined([values, values]) for case, values in by_case.items()}
    for case, values in by_case.items():
        values |= lasting_growth(scene.in_cases[case])
    return by_case
