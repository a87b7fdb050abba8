"""Wear life: follow the loss of ball diameter to the first end-of-life criterion.

Contact state, slip and preload are solved anew at every loss that the integral needs.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.summary import ANGLE, FRICTION, LOAD, MAJOR, PRESSURE, QV, SHARE, TRACK
from bearingwear.kernels.thrust import ThrustCase
from bearingwear.model import parameters
from bearingwear.model.criterion import end_attribute
from bearingwear.model.estimate import DOUBLED, HALVED, ROUNDING, changed
from bearingwear.model.fidelity import NotAvailable, choice_for_life
from bearingwear.model.film_life import film_history
from bearingwear.model.film_values import film_values
from bearingwear.model.films import COVERED, Bare
from bearingwear.model.growth_told import growth_values
from bearingwear.model.heat import SteadyHeat, heat_of_case, race_control_heat, warmth_of
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.life_integrator import (
    FIRST_STEP,
    LifeHistory,
    LifeIntegrator,
    WearState,
)
from bearingwear.model.outputs import friction_used, loss_per_wear, wear_values
from bearingwear.model.race_control import RaceControlProblem, solve_race_control
from bearingwear.model.result import Result
from bearingwear.model.solve import provenance
from bearingwear.model.steady import ThrustProblem, axial_force
from bearingwear.model.thermal import HeatFlow, Warmed, warmed
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import LARGEST_LOSS, EndOfLife, Scene, SceneError


class StateAtLoss(Protocol):
    """Function from a loss of ball diameter [m] to the state, in some contacts without film."""

    def __call__(self, loss: float, bare: Bare = COVERED) -> WearState: ...


def steady_states(scene: Scene, problem: ThrustProblem | None = None) -> StateAtLoss:
    """Function from loss to state on the steady model, each solve started from the nearest one.

    `problem`, if given, takes the place of the scene's own (other settings of accuracy).
    """
    if scene.pair is not None:
        if not scene.pair.is_symmetric:
            raise NotAvailable(
                f"{scene.name}: got two bearings that differ, expected one, or two identical ones"
            )
        scene = scene.sides[0]
    covered = (problem or ThrustProblem.of(scene)).without_finer
    mounted = parameters.static_place(scene)
    solved: dict[tuple[float, Bare], tuple[np.ndarray, Warmed | None]] = {}

    def state(loss: float, bare: Bare = COVERED) -> WearState:
        like = covered.where_bare(scene, bare) if any(bare) else covered
        if like.undetermined() != code.OK:
            return WearState(loss, like.undetermined())
        near = min(solved, key=lambda x: (x[1] != bare, abs(x[0] - loss)), default=None)
        u, found = (None, None) if near is None else solved[near]
        problem, warmth = like, dict[str, Any]()
        if scene.thermal is None:
            case = like.solve(like.g.D0 - loss, u)
        else:
            solver = SteadyHeat(loss, like, u)
            found = warmed(scene, solver, found)
            if found.status != code.OK:
                return WearState(loss, found.status)
            problem, case = solver.problem, solver.case
            warmth = warmth_of(scene, found)
        if case.status == code.OK:
            solved[loss, bare] = case.u, found
        made = steady_wear_state(scene, problem, loss, case)
        return in_half_of_pair(scene, mounted, made, **warmth)

    return state


def steady_wear_state(
    scene: Scene, problem: ThrustProblem, loss: float, case: ThrustCase
) -> WearState:
    """Values of a steady state that a life needs, at a loss of ball diameter [m]."""
    if case.status != code.OK:
        return WearState(loss, case.status)
    g, c = problem.g, case.contacts
    D = np.array([g.D0 - loss])
    worn_by = c[None, :, QV], c[None, :, MAJOR], c[None, :, TRACK]
    films = changes_as_it_wears(scene)
    wear = wear_values(scene, D, *worn_by)
    gyroscopic = ball_inertia(ball_mass(g.rho, D), D) * abs(case.u[3] * case.u[2])
    return WearState(
        loss=loss,
        status=case.status,
        rate=wear["ball_diameter_loss_rate"],
        preload=axial_force(case, g.n_balls),
        load=c[:, LOAD],
        angle=c[:, ANGLE],
        major=c[:, MAJOR],
        qv=c[:, QV],
        total_qv=float(g.n_balls * c[:, QV].sum()),
        share=c[:, SHARE],
        skid=case.skid,
        pressure=float(c[:, PRESSURE].max()),
        stiffness=float(g.n_balls * case.S_xx),
        friction_power=heat_of_case(problem, D[0], case).total,
        ball_rate=float(wear["ball_wear_rate"][0]),
        race_rate=wear["race_wear_rate"],
        place=case.delta_a,
        friction_used=float(
            friction_used(c[None, :, FRICTION], D, gyroscopic, c[None, :, LOAD])[0]
        ),
        friction=c[:, FRICTION],
        **({"per_wear": loss_per_wear(g.n_balls, D, *worn_by)} if films else {}),
    )


def in_half_of_pair(scene: Scene, mounted: float, state: WearState, **more: Any) -> WearState:
    """A state with its values in a symmetric pair, of which the bearing is one half, and `more`.

    At a fixed position both bearings hold the rotor, and it stays where it is. A spring has
    no stiffness here, and the rotor goes where the bearing lets it from the axial displacement
    `mounted` [m].
    """
    if scene.operation.preload_method == "fixed_position":
        return replace(state, system_stiffness=2.0 * state.stiffness, shift=0.0, **more)
    return replace(state, system_stiffness=state.stiffness, shift=state.place - mounted, **more)


def race_control_states(scene: Scene) -> StateAtLoss:
    """Function from loss to state on the race-control model, every ball losing the same."""
    fresh = np.array(scene.wear.ball_diameter_loss_um)
    first = fresh[0] * parameters.UM
    known: dict[tuple[float, Bare], Warmed] = {}
    mounted = parameters.static_place(scene)

    def state(loss: float, bare: Bare = COVERED) -> WearState:
        worn = tuple(fresh + (loss - first) / parameters.UM)
        now = replace(scene, wear=replace(scene.wear, ball_diameter_loss_um=worn))
        warmth: dict[str, Any] = {}
        if scene.thermal is not None:
            near = min(known, key=lambda x: (x[1] != bare, abs(x[0] - loss)), default=None)

            def heat(warm: Scene) -> tuple[int, HeatFlow]:
                problem = RaceControlProblem.of(warm).where_bare(warm, bare)
                return race_control_heat(warm, problem)

            found = warmed(now, heat, None if near is None else known[near])
            if found.status != code.OK:
                return WearState(loss, found.status)
            known[loss, bare] = found
            now, warmth = found.scene, warmth_of(scene, found)
        problem = RaceControlProblem.of(now).where_bare(now, bare)
        values, _ = solve_race_control(now, problem)
        made = race_control_wear_state(loss, problem, values)
        return in_half_of_pair(scene, mounted, made, **warmth)

    return state


def race_control_wear_state(
    loss: float, problem: RaceControlProblem, values: Mapping[str, Any]
) -> WearState:
    """Values of a race-control solution that a life needs, at a loss of ball diameter [m]."""
    if values["status"] != code.OK:
        return WearState(loss, values["status"])
    op = problem.op
    return WearState(
        loss=loss,
        status=values["status"],
        rate=values["ball_diameter_loss_rate"],
        preload=float(values["residual_preload"]),
        load=values["contact_load"].mean(axis=0),
        angle=values["contact_angle"].mean(axis=0),
        major=values["semi_major_axis"].mean(axis=0),
        qv=values["qv"].mean(axis=0),
        total_qv=float(values["total_qv"]),
        share=np.full(2, np.nan),  # race control knows neither
        skid=np.nan,
        pressure=float(values["maximum_pressure"].max()),
        stiffness=float(values["axial_stiffness"]),
        friction_power=float(values["shaft_torque"]) * abs(op.omega_i - op.omega_o),
        ball_rate=float(values["ball_wear_rate"].mean()),
        race_rate=values["race_wear_rate"],
        place=float(values["axial_displacement"]),
        friction_used=float(np.max(values.get("friction_used_by_gyroscopic_moment", np.inf))),
        friction=np.mean(values.get("friction_coefficient", (np.nan, np.nan)), axis=0),
        per_wear=loss_per_wear(
            problem.g.n_balls,
            problem.D,
            *(values[name] for name in ("qv", "semi_major_axis", "contact_track_radius")),
        ),
    )


def margins(state: WearState, end: EndOfLife, preload_N: float) -> np.ndarray:
    """How far each criterion of `CRITERIA` is from being met; those of the cage are not looked at.

    Positive before, zero or below where it is met; infinite where it does not apply.
    """
    MN_M, GPA = 1e6, 1e9
    looked_at: dict[str, Callable[[float], float]] = {
        "preload_fraction": lambda limit: state.preload / preload_N - limit,
        "gyroscopic_slip_share": lambda limit: limit - state.share.max(),
        "skid_ratio": lambda limit: limit - abs(state.skid),
        "ball_diameter_loss_um": lambda limit: 1.0 - state.loss / (limit * parameters.UM),
        "rotor_shift_um": lambda limit: 1.0 - abs(state.shift) / (limit * parameters.UM),
        "system_axial_stiffness_N_um": lambda limit: state.system_stiffness / (limit * MN_M) - 1.0,
        "friction_used_by_gyroscopic_moment": lambda limit: limit - state.friction_used,
        "film_worn_share": lambda limit: limit - state.film_worn.max(),
        "maximum_pressure_GPa": lambda limit: 1.0 - state.pressure / (limit * GPA),
        "groove_depth_um": lambda limit: 1.0 - state.depth / (limit * parameters.UM),
    }
    found = np.full(len(CRITERIA) - 1, np.inf)
    for name, limit in end.criteria.items():
        if name in looked_at:
            found[CRITERIA.index(name)] = looked_at[name](limit)
    return found


def life(
    scene: Scene, fidelity: str | None = None, progress: Callable[[str], None] | None = None
) -> Result:
    """Wear life of a scene from its present loss of ball diameter on.

    Parameters
    ----------
    scene : Scene
        With `wear.end_of_life`.
    fidelity : str, optional
        Overrides `model.fidelity` of the scene.
    progress : callable, optional
        Given one line of text at each step of a dynamic life; others are done by then.

    Returns
    -------
    Result
        Life, its error bound and the history; where no criterion was met, `status` says so and the
        life is a lower bound.

    Raises
    ------
    SceneError
        Where the scene has no end-of-life criterion, or a preload fraction without a preload.
    NotAvailable
        Where the fidelity asked for cannot solve this scene.
    """
    _check_end(scene)
    chosen = choice_for_life(scene, fidelity)
    end = scene.wear.end_of_life or EndOfLife()
    started = time.perf_counter()
    if chosen.fidelity == "dynamic":
        # its kernels take long to load, and the other models need none of them
        from bearingwear.model.dynamic_life import solve_dynamic_life

        _check_depth(scene, end)
        values, attrs = solve_dynamic_life(chosen.reduced(scene), progress)
    else:
        # needs what this module has
        from bearingwear.model.worn_outputs import grooves_followed, solve_worn_life

        followed, why = grooves_followed(scene, chosen.fidelity)
        if why:
            chosen = replace(chosen, reasons=(*chosen.reasons, why))
        if followed is None:
            _check_depth(scene, end)
        with Interrupt():
            if followed is not None:
                values, attrs = solve_worn_life(followed)
                if followed is not scene:  # one of two identical ones
                    from bearingwear.model.pair_life import of_both

                    values = of_both(values, values)
            elif scene.pair is not None:
                from bearingwear.model.pair_life import pair_life

                values, attrs = pair_life(scene, chosen.fidelity)
            else:
                values, attrs = solve_life_over_loss(scene, chosen.fidelity)
    elapsed = time.perf_counter() - started
    if scene.thermal is None and scene.pair is None:  # or each bearing has its own
        values |= growth_values(scene)
    attrs |= end_attribute(scene, values) | provenance(scene, chosen, values)
    return Result(values, attrs, elapsed)


def _check_depth(scene: Scene, end: EndOfLife) -> None:
    """Refuse a limit on the depth of grooves where the life does not follow them."""
    if end.groove_depth_um is not None:
        raise NotAvailable(
            f"{scene.name}: wear.end_of_life.groove_depth_um: got {end.groove_depth_um:g} with "
            "grooves that are not followed, expected model.contact worn"
        )


def _check_end(scene: Scene) -> None:
    """Refuse a scene whose life cannot end."""
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        raise SceneError(
            "wear.end_of_life",
            "got nothing, expected at least one criterion",
            source=scene.name,
        )
    if end.preload_fraction is not None and scene.operation.preload_N == 0.0:
        raise SceneError(
            "wear.end_of_life.preload_fraction",
            "got a fraction of preload_N 0, expected a preload > 0",
            source=scene.name,
        )


def solve_life_over_loss(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    """Values and attributes of a life that depends on the loss alone."""
    if fidelity == "steady":
        history = life_history(scene, steady_states(scene))
        values = life_values(scene, history) | error_estimate(scene, history)
    else:
        history = life_history(scene, race_control_states(scene))
        values = life_values(scene, history)
    return values, {"solves": history.solves}


def life_history(scene: Scene, state: StateAtLoss) -> LifeHistory:
    """Wear states of a scene, given by the function `state`, up to its end of life."""
    end, preload = scene.wear.end_of_life or EndOfLife(), scene.operation.preload_N
    if changes_as_it_wears(scene):
        return film_history(scene, state, lambda s: margins(s, end, preload))
    integrator = LifeIntegrator(state, lambda s: margins(s, end, preload), scene.model.tolerance)
    D0 = scene.bearing.ball_diameter_mm * parameters.MM
    return integrator.integrate(
        scene.wear.ball_diameter_loss_um[0] * parameters.UM, LARGEST_LOSS * D0, FIRST_STEP * D0
    )


def error_estimate(scene: Scene, history: LifeHistory) -> dict:
    """Estimated numerical error of a life: the same with other settings (see `estimate`)."""
    now = history.times[-1]
    if history.status != code.OK or not now.min() > 0.0:
        return {}
    total = ROUNDING + history.error / now
    problems = ThrustProblem.of(scene).perturbed(scene)
    for weight, problem in zip((HALVED, DOUBLED), problems, strict=True):
        other = life_history(scene, steady_states(scene, problem))
        if (other.status, other.criterion) != (history.status, history.criterion):
            return {}
        total = total + weight * changed(now, other.times[-1])
    return {"life_error_estimate": total}


def life_values(scene: Scene, history: LifeHistory) -> dict:
    """Result variables of a life."""
    values: dict = {"status": history.status, "end_criterion": history.criterion}
    states = history.states
    if states[0].status != code.OK or not np.fmin.reduce(states[0].rate) > 0.0:
        return values
    factor, _ = parameters.wear_factors(scene)
    values |= {
        "life": history.times[-1],
        "normalised_life": history.times[-1] * factor,
        "life_error_bound": history.error,
        "loss_at_end": states[-1].loss,
        "history_time": np.array(history.times),
    }
    return values | history_values(states) | film_values(scene, history)


def history_values(states: list[WearState]) -> dict:
    """Result variables of the states along a life."""
    columns = {
        "ball_diameter_loss": "loss",
        "residual_preload": "preload",
        "total_qv": "total_qv",
        "qv": "qv",
        "contact_angle": "angle",
        "contact_load": "load",
        "semi_major_axis": "major",
        "maximum_pressure": "pressure",
        "gyroscopic_slip_share": "share",
        "skid_ratio": "skid",
        "ball_diameter_loss_rate": "rate",
        "ball_wear_rate": "ball_rate",
        "race_wear_rate": "race_rate",
        "axial_displacement": "place",
        "friction_used_by_gyroscopic_moment": "friction_used",
        "system_axial_stiffness": "system_stiffness",
        "rotor_axial_shift": "shift",
    }
    values: dict[str, Any] = {
        f"history_{name}": np.array([getattr(s, attribute) for s in states])
        for name, attribute in columns.items()
    }
    if np.isfinite(states[0].temperature).any():
        values["history_part_temperature"] = np.array([s.temperature for s in states])
        values["heat_flow_residual"] = max(s.heat_flow_residual for s in states)
    return values
