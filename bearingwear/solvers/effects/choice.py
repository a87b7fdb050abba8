"""Choice of the model for a scene."""

from dataclasses import dataclass, replace

from bearingwear.kernels.project import PROJECT
from bearingwear.scene.accuracy import FIDELITIES
from bearingwear.scene.blocks import EndOfLife
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene
from bearingwear.solvers.dynamic.stability import check_solution, seeks_periodic

ASKED_FOR = "requested by the scene or the command"

NEEDS_SLIP = frozenset({"gyroscopic_slip_share", "skid_ratio"})
"""Criteria that require a balance of friction, which race control lacks."""

# Milliseconds per ball and shaft turn (docs/accuracy.md, gyro_s1 at standard), for a rough estimate
# of the effort before anything runs.
TURN_MS, TURN_WITH_CAGE_MS = 0.3, 0.5
LARGEST_KERNEL = {
    "race_control": "contact_summary",
    "steady": "thrust_case",
    "dynamic": "advance_and_record",
}


@dataclass(frozen=True)
class Choice:
    """Model chosen for a scene, with the reason."""

    scene: Scene
    fidelity: str
    why: str
    cage: bool = False  # whether the scene's cage is included
    of_life: bool = False
    grooves: str = ""  # in a life: whether they wear, and why

    def reduced(self, scene: Scene) -> Scene:
        """Returns the scene without a cage that is not solved; only the dynamic model has one."""
        unsolved = self.fidelity == "dynamic" and scene.cage is not None and not self.cage
        return scene.without_cage if unsolved else scene

    @property
    def reasons(self) -> tuple[str, ...]:
        """Returns sentences on included and neglected effects."""
        from bearingwear.solvers.effects.table import EFFECTS  # imports this module

        return tuple(sentence for effect in EFFECTS for sentence in effect.modelled(self))


def asymmetries(scene: Scene) -> list[str]:
    """Returns the properties of a scene that make its balls differ, in words; empty if none do."""
    if scene.pair is not None:
        return list(dict.fromkeys(text for side in scene.sides for text in asymmetries(side)))
    operation = scene.operation
    properties = {
        "radial load": any(operation.radial_load_N),
        "rotating load": operation.rotating_load_N,
        "tilt": operation.tilt_mrad,
        "unequal ball diameters": len(set(scene.wear.ball_diameter_loss_um)) > 1,
    }
    return [name for name, value in properties.items() if value]


def stands_still(scene: Scene) -> bool:
    """Returns whether neither race turns."""
    return not (scene.operation.shaft_speed_rpm or scene.operation.outer_speed_rpm)


def choice(scene: Scene, fidelity: str | None = None) -> Choice:
    """Returns the choice of the model; `fidelity` overrides `model.fidelity` of the scene.

    Raises NotAvailable if the requested fidelity does not exist or cannot solve this scene. It is
    also raised if the scene requests a periodic motion that it does not have.
    """
    wanted = fidelity or scene.model.fidelity
    _check_fidelity(scene, wanted)
    asymmetry = " and ".join(asymmetries(scene))
    needs_cage = scene.model.cage_results
    if wanted != "auto":
        return _choice_of(scene, wanted, ASKED_FOR)
    if needs_cage:
        return _choice_of(scene, "dynamic", "cage motion and wear are requested")
    if asymmetry and stands_still(scene):
        return _choice_of(
            scene, "race_control", f"{asymmetry} with both races at rest: nothing moves"
        )
    if asymmetry and scene.pair is not None:
        why = f"{asymmetry}, so no steady state exists; the dynamic model does not support a pair"
        return _choice_of(scene, "race_control", why)
    if asymmetry:
        return _choice_of(scene, "dynamic", f"{asymmetry}, so no steady state exists")
    return _choice_of(scene, "steady", "pure thrust load")


def _check_fidelity(scene: Scene, wanted: str) -> None:
    """Raises NotAvailable for a fidelity that does not exist or cannot solve a scene."""

    def refusal(problem: str, others: str) -> NotAvailable:
        """Returns the error that names a problem of the fidelity and others to choose."""
        return NotAvailable(
            f"{scene.name}: model.fidelity: got '{wanted}'; {problem}, expected auto, {others}"
        )

    if wanted not in FIDELITIES:
        raise NotAvailable(
            f"{scene.name}: fidelity: got {wanted!r}, expected {', '.join(FIDELITIES)}"
        )
    asymmetry = " and ".join(asymmetries(scene))
    needs_cage = scene.model.cage_results
    if needs_cage and wanted in ("steady", "race_control"):
        raise refusal("cage motion and wear require the dynamic model", "dynamic")
    if scene.pair is not None and (wanted == "dynamic" or needs_cage):
        got, instead = "model.cage_results: got true", "false"
        if wanted == "dynamic":
            got, instead = "model.fidelity: got 'dynamic'", "steady or race_control"
        raise NotAvailable(
            f"{scene.name}: {got} with a {scene.pair.kind}, expected {instead}; the dynamic "
            "model supports only one bearing: set arrangement.kind to single (one of two identical "
            "bearings)"
        )
    if wanted == "steady" and asymmetry:
        raise refusal(f"a scene with {asymmetry} has no steady state", "dynamic, race_control")
    if stands_still(scene) and (wanted == "dynamic" or needs_cage):
        raise NotAvailable(
            f"{scene.name}: operation.shaft_speed_rpm: got 0 with the outer race at rest, "
            "expected a rotating race for the dynamic model"
        )


def _choice_of(scene: Scene, fidelity: str, why: str) -> Choice:
    """Returns the choice of a fidelity, with the cage where it is to be solved.

    Raises NotAvailable if the dynamic solution that the scene requests does not exist for it.

    why: reason of the choice, or `ASKED_FOR`.
    """
    # a dynamic model requested by name includes the cage
    cage = fidelity == "dynamic" and (scene.model.cage_results or why == ASKED_FOR)
    chosen = Choice(scene=scene, fidelity=fidelity, why=why, cage=cage and scene.cage is not None)
    if fidelity == "dynamic":
        check_solution(chosen.reduced(scene))
    return chosen


def choice_for_life(scene: Scene, fidelity: str | None = None) -> Choice:
    """Returns the choice for a wear life: that of a solve, if it evaluates any of the criteria.

    Raises NotAvailable if the requested fidelity cannot solve this scene or evaluates none of its
    criteria. It is also raised for race control if the steady model solves the scene.
    """
    chosen = choice(scene, fidelity)
    if chosen.fidelity == "race_control" and not asymmetries(scene):
        raise NotAvailable(
            f"{scene.name}: model.fidelity: got 'race_control' for a life, expected auto or steady:"
            " the steady model solves this scene, and race control only estimates its slip"
        )
    unevaluated = unevaluated_criteria(scene, chosen)
    end = scene.wear.end_of_life
    if unevaluated and end is not None and unevaluated.keys() == end.criteria.keys():
        alternatives = "another criterion"
        if scene.pair is None:  # no other model solves a pair
            needs_cage = not unevaluated.keys() <= NEEDS_SLIP
            alternatives += ", or fidelity " + ("dynamic" if needs_cage else "auto")
        raise NotAvailable(
            f"{scene.name}: wear.end_of_life: got only {', '.join(unevaluated)}, which fidelity "
            f"{chosen.fidelity} does not evaluate, expected {alternatives}"
        )
    return replace(chosen, of_life=True)


def unevaluated_criteria(scene: Scene, chosen: Choice) -> dict[str, float]:
    """Returns the criteria of a scene that a life does not evaluate, with their limits.

    They are those of the cage, if it is not solved; and with race control, those that need slip.
    """
    end = scene.wear.end_of_life or EndOfLife()
    unevaluated = set() if chosen.cage else end.criteria.keys() - end.without_cage.criteria.keys()
    if chosen.fidelity == "race_control" and not stands_still(scene):
        unevaluated |= NEEDS_SLIP
    return {name: limit for name, limit in end.criteria.items() if name in unevaluated}


def accuracy_sentence(scene: Scene, chosen: Choice) -> str:
    """Returns the accuracy settings of a scene, in words."""
    model = scene.model
    across = f" by {model.points_across} across" if model.slip_region == "ellipse" else ""
    settings = (
        f"accuracy: {model.accuracy}; {model.strips} points or strips ({model.quadrature}){across}"
        ", friction regularised below a slip speed of "
        f"{scene.friction.slip_regularisation_m_s:g} m/s"
    )
    if chosen.fidelity != "dynamic":
        return settings
    return (
        f"{settings}, step tolerance {model.dynamic_tolerance:g}, at most "
        f"{model.simulated_turns:g} turns, settled below a drift of {model.settled_drift:g}"
    )


def effort_sentence(scene: Scene, chosen: Choice) -> str:
    """Returns a rough estimate of the computing time of a solve, in words; compiling included."""
    compiled = PROJECT.is_compiled(LARGEST_KERNEL[chosen.fidelity])
    compile_words = (
        "" if compiled else f"up to {PROJECT.compile_time} to compile the solver (once), then "
    )
    if chosen.fidelity != "dynamic":
        return f"computing time: {compile_words}milliseconds at any accuracy"
    if seeks_periodic(chosen.reduced(scene)):
        return f"computing time: {compile_words}about a tenth of a second"
    turns = scene.model.simulated_turns
    ms = scene.bearing.ball_count * (TURN_WITH_CAGE_MS if chosen.cage else TURN_MS)
    runs = ""
    if scene.wear.end_of_life is not None:
        runs = f"; a life calculation requires at least about {scene.model.life_steps} such runs"
    return (
        f"computing time: {compile_words}about {1e-3 * turns * ms:.1g} s for at most {turns:g} "
        f"shaft turns (estimated from timings of one scene){runs}"
    )
