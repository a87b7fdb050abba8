"""Both stiffnesses in every kind of life: slopes, and lives that end at the lesser of the two."""

from dataclasses import replace

import numpy as np
import pytest
from lives.test_worn_life import scene_of
from lives.test_worn_pair import NETWORK, RIGID
from support import scene_file

from bearingwear.kernels import status as code
from bearingwear.lives.grooves import EXACT_GROOVES, Grooves, StiffGrooves, follow_grooves, point_of
from bearingwear.lives.life import life
from bearingwear.lives.motion import Motion
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve
from bearingwear.solvers.worn.depths import seat_force

DYNAMIC, QUASISTATIC = "axial_stiffness", "quasistatic_axial_stiffness"
SLOPE = 1e-3  # to which a quasi-static stiffness is that of further solves
STEP = 1e-4  # of the approach: longer ones pass kinks, where slip reverses at a cell
LOSS_OF_02_UM = EndOfLife(ball_diameter_loss_um=0.2)
SYSTEM = "history_system_axial_stiffness", "history_system_quasistatic_axial_stiffness"
FEW_CELLS = EXACT_GROOVES._replace(cells=(32, 8))
SPRING = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1")
LOADED = ("arrangement.external_axial_N=1",)


def slope_of_further_solves(side, node):
    """Returns the slope of the axial force over the place [N/m], by two states near a node."""
    bearing, point, forces = side.bearing, point_of(node.states[0]), []
    bearing.reference = bearing.worn_reference
    step = STEP * max(force.approach for force in point.forces)
    for shift in (step, -step):
        held = point.problem.preload._replace(
            constant_force=False, delta_a=point.seat.delta_a + shift
        )
        bearing.seat, bearing.u = point.seat, point.u.copy()
        bearing.state.slope.fill(0.0)  # of other unknowns
        near = bearing.solve(point.wear, replace(point.problem, preload=held))
        assert near.status == code.OK
        forces.append(seat_force(near.problem.g, near.seat))
    return (forces[0] - forces[1]) / (2.0 * step)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
@pytest.mark.parametrize("balance", ["frictionless", "with_traction"])
def test_worn_quasistatic_stiffness_is_the_slope_of_further_solves(method, balance):
    """The state is the last one of a life to a loss of 0.2 um."""
    scene = scene_of(method, balance=balance, end_of_life=LOSS_OF_02_UM)
    course = StiffGrooves(scene, FEW_CELLS)
    groove_life = follow_grooves(course)
    assert groove_life.status == code.OK
    last = course.completed(groove_life.last._replace(states=course.state(groove_life.last.worn)))
    (side,), (state,) = course.sides, last.states
    assert state[QUASISTATIC] == pytest.approx(slope_of_further_solves(side, last), rel=SLOPE)
    if (method, balance) == ("fixed_position", "with_traction"):
        # where the two stiffnesses differ most: the dynamic one would not pass above
        assert state[QUASISTATIC] < (1.0 - 10.0 * SLOPE) * state[DYNAMIC]


def test_a_missing_stiffness_leaves_the_slope_of_the_last_one(monkeypatch):
    """Without a slope, the next balance of a pair could not step to its place."""
    course = Grooves(scene_of("fixed_position"), FEW_CELLS)
    (state,), (side,) = course.state(course.start), course.sides
    slope = side.with_stiffness(state.answer).steepness
    monkeypatch.setattr(side.bearing, "axial_stiffnesses", lambda point: np.full(2, np.nan))
    assert np.isnan(side.with_stiffness(state.answer).steepness)
    assert side(state.answer.condition).slope == slope > 0.0


@pytest.mark.parametrize(
    ("limit", "lesser", "apart"),
    [
        # [N/um]; when new, the dynamic stiffness is the lesser by 0.12 %, when worn the other one
        (9.46, "dynamic", 1e-3),
        (7.0, "quasi-static", 0.1),
    ],
    ids=["dynamic", "quasi-static"],
)
def test_a_worn_life_ends_at_the_lesser_stiffness_and_names_it(limit, lesser, apart):
    end = EndOfLife(system_axial_stiffness_N_um=limit)
    ended = life(scene_of("fixed_position", balance="with_traction", end_of_life=end))
    assert ended.values["status"] == code.OK
    dynamic, quasistatic = (ended.values[name][-1] for name in SYSTEM)
    last = {"dynamic": dynamic, "quasi-static": quasistatic}
    assert last[lesser] == pytest.approx(limit * 1e6, rel=SLOPE)
    assert max(last.values()) > (1.0 + apart) * last[lesser]
    assert ended.attrs["ended_by"].startswith(f"{lesser} ")


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param((*RIGID, *LOADED), id="rigid"),
        pytest.param((*SPRING, *LOADED), id="spring"),
        pytest.param((*RIGID, "arrangement.second={friction.ball_race: 0.05}"), id="unlike"),
        pytest.param(("operation.preload_method=fixed_position", NETWORK), id="warm"),
        pytest.param((*RIGID, *LOADED, NETWORK), id="warm pair"),
    ],
)
def test_worn_lives_start_with_both_stiffnesses_of_unworn_grooves(changes):
    """Cells of a groove leave 0.1 %. Every state of a life has both stiffnesses."""
    end = "wear.end_of_life={preload_fraction: 0.9, ball_diameter_loss_um: 0.1}"

    def life_values(contact):
        keys = [f"model.contact={contact}", end, *changes]
        return life(replace(load_scene(scene_file("gyro_s1"), keys), cage=None)).values

    worn, hertz = life_values("worn"), life_values("hertz")
    assert worn["status"] == hertz["status"] == code.OK
    for name in SYSTEM:
        assert worn[name][0] == pytest.approx(hertz[name][0], rel=1e-3)
        assert np.isfinite(worn[name]).all()


def test_a_life_without_a_limit_on_stiffness_may_leave_it_out():
    """`Grooves` leaves it out, `StiffGrooves` has it; they live equally long."""
    scene = scene_of("fixed_position", balance="with_traction", end_of_life=LOSS_OF_02_UM)
    without, with_it = (follow_grooves(kind(scene, FEW_CELLS)) for kind in (Grooves, StiffGrooves))
    assert np.isnan([state[QUASISTATIC] for state in without.states]).all()
    assert np.isfinite([state[QUASISTATIC] for state in with_it.states]).all()
    assert without.times[-1] == pytest.approx(with_it.times[-1], rel=1e-6)


SHORT = ["model.simulated_turns=6", "model.evaluated_turns=3", "model.life_steps=3", "cage=null"]
FIXED = "operation.preload_method=fixed_position"


def dynamic_life(*changes):
    """Returns the result of a short dynamic life of gyro_s1_hertz without its cage."""
    return life(load_scene(scene_file("gyro_s1_hertz"), [*SHORT, *changes]), "dynamic")


def test_a_dynamic_life_has_the_steady_quasistatic_stiffness():
    """It is that of a steady solve with the same wear.

    The stiffness of the system is twice that, because a single bearing stands for a symmetric pair.
    """
    changes = [FIXED, "operation.preload_N=4", "wear.end_of_life={preload_fraction: 0.8}"]
    scene = load_scene(scene_file("gyro_s1_hertz"), [*SHORT, *changes])
    wearing = Motion(scene)
    worn = wearing.start
    worn[wearing.parts.layout.diameter] = 0.2e-6
    (state,) = wearing.state(worn)
    assert state.status == code.OK
    loss = "wear.ball_diameter_loss_um=[0.2]"
    steady = solve(load_scene(scene_file("gyro_s1_hertz"), [*changes, loss]), "steady").values
    assert wearing.parts.loss(worn) == pytest.approx(0.2e-6, rel=1e-12, abs=0.0)
    assert state[QUASISTATIC] == pytest.approx(steady[QUASISTATIC], rel=1e-9)
    system = state["system_quasistatic_axial_stiffness"]
    assert system == pytest.approx(2.0 * state[QUASISTATIC], rel=1e-12)


def test_a_dynamic_life_ends_at_the_lesser_stiffness_and_names_it():
    changes = FIXED, "operation.preload_N=4", "wear.end_of_life={system_axial_stiffness_N_um: 4.0}"
    ended = dynamic_life(*changes)
    values = ended.values
    assert CRITERIA[values["end_criterion"]] == "system_axial_stiffness_N_um"
    dynamic, quasistatic = (values[name][-1] for name in SYSTEM)
    assert quasistatic == pytest.approx(4e6, rel=2e-3)  # the limit, met between three steps
    assert dynamic > 1.05 * quasistatic
    assert ended.attrs["ended_by"].startswith("quasi-static ")


def test_a_dynamic_life_under_radial_load_takes_the_stiffness_of_race_control():
    """At its start it has twice the quasi-static stiffness of a solve: a symmetric pair."""
    changes = "operation.radial_load_N=[0, 1]", "wear.end_of_life={preload_fraction: 0.98}", FIXED
    values = dynamic_life(*changes).values
    start = load_scene(scene_file("gyro_s1_hertz"), [*SHORT, *changes])
    stiffness = solve(start, "race_control").values["quasistatic_axial_stiffness"]
    assert values[SYSTEM[1]][0] == pytest.approx(2.0 * stiffness, rel=1e-9)
