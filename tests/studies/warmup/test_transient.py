"""Warm-ups against formulas, the steady network and a plain program; the thermal margin."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm
from support import SLOW_HOUSING, benchmark, warm_spindle

import bearingwear
from bearingwear.kernels import status as code
from bearingwear.scene.checking.errors import NotAvailable, SceneError
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.solve import solve
from bearingwear.solvers.thermal import HeatFlow
from bearingwear.solvers.warmup import transient
from bearingwear.solvers.warmup.transient import SpeedCourse, ramp, warm_up
from bearingwear.studies.warmup import shortest_ramp as shortest_ramps
from bearingwear.studies.warmup.result import warm_up_dataset
from bearingwear.studies.warmup.shortest_ramp import shortest_ramp


@pytest.fixture(scope="module")
def spindle():
    """A rigid pair of 7008C with a thermal network, as one of two alike bearings."""
    return warm_spindle()


SMALL_STEPS = {"duration": 40.0, "tolerance": 1e-12}


def set_constant_heat(monkeypatch, heat):
    """Let each bearing have this heat whatever its temperatures."""
    heats_of = transient.heats_of
    monkeypatch.setattr(
        transient, "heats_of", lambda *inputs: tuple(heat for _ in heats_of(*inputs))
    )


def test_one_node_of_constant_heat_warms_exponentially(spindle, monkeypatch):
    """The outer ring: T = T_0 + P/G (1 - exp(-t G/C))."""
    P, G, C = 8.0, 4.0, 40.0
    set_constant_heat(monkeypatch, HeatFlow(inner=0.0, outer=0.0, drag=P))
    alone = spindle.with_({"thermal.conductance_W_K.ball_race": 1e-6})
    instants = warm_up(alone, ramp(0.0), **SMALL_STEPS).instants[1:]
    rises = [instant.temperatures[0, 2] - 20.0 for instant in instants]
    times = np.array([instant.time for instant in instants])
    assert_allclose(rises, P / G * (1.0 - np.exp(-times * G / C)), rtol=1e-6)


def test_three_nodes_of_constant_heat_warm_by_the_matrix_exponential(spindle, monkeypatch):
    """From heats and conductances that are written out here.

    Half of the heat of a contact goes into its ring, half into the balls; drag into the outer ring.
    """
    set_constant_heat(monkeypatch, HeatFlow(inner=8.0, outer=4.0, drag=1.0))
    G = np.array([[3.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 5.0]])
    C = np.array([30.0, 12.0, 40.0])
    steady = np.linalg.solve(G, [8.0 / 2.0, (8.0 + 4.0) / 2.0, 4.0 / 2.0 + 1.0])
    for instant in warm_up(spindle, ramp(0.0), **SMALL_STEPS).instants[1:]:
        expected = steady - expm(-G / C[:, None] * instant.time) @ steady
        assert_allclose(instant.temperatures[0] - 20.0, expected, rtol=1e-6)


@pytest.mark.parametrize("changes", [{}, SLOW_HOUSING])
def test_a_warm_up_ends_in_the_steady_network(spindle, changes):
    scene = spindle.with_(changes)
    warming = warm_up(scene, ramp(20.0))
    states = solver_of(scene)
    (steady,) = states(states.bearings.start)
    assert warming.status == code.OK and warming.left < transient.SETTLED_TO
    rise = np.abs(steady["part_temperature"][:3] - 20.0).max()
    last = warming.instants[-1].temperatures[0]
    assert np.abs(last - steady["part_temperature"][:3]).max() < transient.SETTLED_TO * rise
    assert_allclose(warming.instants[-1].states[0]["residual_preload"], steady["residual_preload"],
        rtol=1e-2)  # fmt: skip


def test_a_bearing_that_runs_away_alone_does_not_with_the_other():
    """Held at the first place of the rotor, the first bearing has no balance of its heat.

    Trial 147 of `benchmarks/random_warmups.py`, seed 1.
    """
    scene = bearingwear.new(
        bore=40, outside=68, contact_angle=25, speed=0.495e6 / 54, preload_method="fixed_position"
    )
    pair = {"kind": "rigid_pair", "orientation": "face_to_face", "external_axial_N": 110.0}
    conductances = {"inner_ring_shaft": 0.362, "outer_ring_housing": 1.18, "ball_race": 0.312}
    capacities = {"inner_ring": 35.8, "balls": 15.6, "outer_ring": 35.8}
    network = {"conductance_W_K": conductances, "heat_capacity_J_K": capacities}
    network |= {"shaft_C": 21.744441001968976, "housing_C": 33.04795301727553}
    scene = scene.with_({"operation.preload_N": 250.8, "arrangement": pair, "thermal": network})
    steady = solve(scene)
    warming = warm_up(scene, ramp(0.0))
    assert steady.status == "ok" and warming.status == code.OK
    T = np.array(steady.values["part_temperature"])[:, :3]
    assert np.abs(warming.instants[-1].temperatures - T).max() < 1e-3 * np.abs(T - 20.0).max()
    assert steady.values["heat_flow_residual"].max() < 1e-6


def test_a_slow_ramp_is_a_sweep_of_steady_states(spindle):
    course = ramp(2e5)
    warming = warm_up(spindle, course, duration=2e5)
    rise = np.abs(warming.instants[-1].temperatures - 20.0).max()
    every_quarter = max(len(warming.instants) // 4, 1)
    for instant in warming.instants[every_quarter::every_quarter]:
        steady = solve(spindle.with_({"operation.shaft_speed_rpm": instant.share * 12000.0}))
        expected = np.array(steady.values["part_temperature"][:3]) - 20.0
        assert_allclose(instant.temperatures[0] - 20.0, expected, atol=1e-3 * rise)


WARMED_FAST = SLOW_HOUSING | {"thermal.housing_time_constant_s": 30.0}


@pytest.mark.parametrize(
    ("changes", "seconds"),
    [
        pytest.param(WARMED_FAST, 10.0, id="ramp"),
        pytest.param(WARMED_FAST, 0.0, id="at once"),
        pytest.param(
            {"thermal.shaft_C": 40.0, "thermal.shaft_time_constant_s": 20.0}, 20.0, id="warm shaft"
        ),
        pytest.param(
            WARMED_FAST | {"operation.preload_method": "constant_force"}, 5.0, id="constant force"
        ),
        pytest.param(
            WARMED_FAST | {"bearing.contact_angle_deg": 25.0, "operation.preload_N": 300.0},
            15.0,
            id="25 degrees",
        ),
    ],
)
def test_a_warm_up_agrees_with_a_plain_program(spindle, changes, seconds):
    """Temperatures, preload and pressure after 30 s, to 0.1 %.

    The plain program takes Euler's steps, whose error is proportional to their length: it is
    extrapolated from 120 and 240 of them.
    """
    scene = spindle.with_(changes)
    last = warm_up(scene, ramp(seconds), duration=30.0).instants[-1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        euler = benchmark("warmup").euler
        coarse, fine = (euler(scene, seconds, 30.0, steps) for steps in (120, 240))

    def extrapolated(name):
        return 2.0 * fine[name][-1] - coarse[name][-1]

    rises = last.temperatures[0, :3] - 20.0
    expected = np.array([extrapolated(name) for name in ("inner", "balls", "outer")]) - 20.0
    assert_allclose(rises, expected, rtol=1e-3)
    for name, quantity in (("preload", "residual_preload"), ("pressure", "maximum_pressure")):
        assert_allclose(np.max(last.states[0][quantity]), extrapolated(name), rtol=1e-3)


def test_the_shortest_ramp_is_that_of_a_brute_force(spindle):
    """Preload of all ramps on a grid, by warm-ups with finer steps than those of the search.

    The search stops within 3 % of the shortest.
    """
    scene, limit = spindle.with_(SLOW_HOUSING), 220.0
    ramps = np.geomspace(80.0, 400.0, 17)
    peaks = [
        max(
            instant.states[0]["residual_preload"]
            for instant in warm_up(scene, ramp(seconds)).instants
        )
        for seconds in ramps
    ]
    expected = np.interp(-limit, -np.array(peaks), ramps)
    shortest, broken_by = shortest_ramp(scene, {"preload": limit})
    assert not broken_by
    assert np.all(np.diff(peaks) < 0.1)  # N: they fall
    assert 100.0 < expected < 300.0  # well inside the grid
    assert expected <= shortest < 1.03 * expected


@pytest.mark.parametrize(
    ("kept", "seconds", "broken_by"),
    [
        pytest.param(lambda s: s >= 40.0 and not 700.0 < s < 1500.0, 40.0, (1000.0,), id="again"),
        pytest.param(lambda s: 20.0 < s < 50.0, 20.0, (100.0, 316.0), id="window"),
        pytest.param(lambda s: s < 2.0, 0.0, (3.16, 10.0), id="short ones"),
    ],
)
def test_longer_ramps_that_break_a_limit_again_are_named(
    spindle, monkeypatch, kept, seconds, broken_by
):
    """Ramps whose peaks do not fall with their length, as given by a function."""
    monkeypatch.setattr(shortest_ramps, "limits_hold", lambda _, s, *given: kept(s))
    shortest = shortest_ramp(spindle, {"preload": 1.0})
    assert seconds <= shortest.seconds <= 1.03 * seconds and kept(shortest.seconds)
    assert shortest.broken_by[: len(broken_by)] == broken_by


def test_the_answer_keeps_its_limit_with_fine_steps(spindle, monkeypatch):
    """Coarse steps that keep a limit up to 2 % too early are made up for."""

    def hold(_, seconds, limits, tolerance=1.0):
        return seconds >= (51.0 if tolerance == transient.STEP_TOLERANCE else 50.0)

    monkeypatch.setattr(shortest_ramps, "limits_hold", hold)
    assert 51.0 <= shortest_ramp(spindle, {"preload": 1.0}).seconds < 53.0


def test_a_limit_that_every_ramp_keeps_needs_none(spindle):
    scene = spindle.with_(SLOW_HOUSING)
    assert shortest_ramp(scene, {"preload": 1e4, "pressure": 5.0}) == (0.0, ())


def test_a_limit_that_no_ramp_keeps_has_no_shortest(spindle):
    """The preload of 140 N when cold."""
    assert shortest_ramp(spindle.with_(SLOW_HOUSING), {"preload": 100.0}) is None


def test_a_cold_housing_makes_a_rigid_preload_pass_its_steady_value(spindle):
    """By a third, after the ramp and before the housing has warmed in its 300 s."""
    dataset = warm_up_dataset(spindle.with_(SLOW_HOUSING), ramp(10.0))
    assert dataset["peak_residual_preload"] > 1.3 * dataset["end_residual_preload"]
    assert 10.0 < dataset["peak_residual_preload_time"] < 300.0
    assert dataset["error_estimate"] < 0.02


def test_the_preload_of_a_spring_does_not_move(spindle):
    held = {"operation.preload_method": "constant_force"} | SLOW_HOUSING
    dataset = warm_up_dataset(spindle.with_(held), ramp(10.0), duration=100.0)
    assert_allclose(dataset["residual_preload"], 140.0, rtol=1e-12)


POOR = {"thermal.conductance_W_K.inner_ring_shaft": 0.2}


def test_a_runaway_is_named(spindle):
    warming = warm_up(spindle.with_(POOR), ramp(10.0))
    assert warming.status != code.OK and warming.runs_away
    assert solve(spindle.with_(POOR)).status in ("warm_seizure", "no_heat_balance")


def test_the_margin_is_one_where_steady_states_end(spindle):
    """Bisects the conductance to the shaft down to the last steady state of the family."""
    key = "thermal.conductance_W_K.inner_ring_shaft"

    def solved(G):
        return solve(spindle.with_({key: G}))

    low, high = 0.2, 2.0  # W/K: seizes, and does not
    margins = []
    for _ in range(24):
        middle = 0.5 * (low + high)
        result = solved(middle)
        if result.status == "ok":
            high = middle
            margins.append(float(result.values["thermal_margin"]))
        else:
            low = middle
    assert_allclose(margins[-1], 1.0, rtol=1e-2)
    assert margins[0] > 1.5


def test_bearings_without_a_state_as_mounted_have_no_warm_up(spindle):
    """60 um of wear are far more than the elastic approach of both races, a few um at 140 N."""
    worn = spindle.with_({"wear.ball_diameter_loss_um": 60.0})
    with pytest.raises(NotAvailable, match=r": no state at the start \(contact_lost: "):
        warm_up_dataset(worn, ramp(0.0))
    assert shortest_ramp(worn, {"pressure": 5.0}) is None


def test_times_and_speeds_are_followed(spindle):
    course = SpeedCourse((0.0, 5.0, 20.0), (0.0, 0.5, 1.0))
    warming = warm_up(spindle, course, duration=30.0)
    times = [instant.time for instant in warming.instants]
    assert {5.0, 20.0, 30.0} <= set(times)
    assert_allclose([item.share for item in warming.instants], [course.at(t) for t in times])


def test_a_scene_without_capacities_is_refused_in_one_line(spindle):
    with pytest.raises(SceneError, match=r"thermal.heat_capacity_J_K: got nothing, expected"):
        warm_up(spindle.with_({"thermal.heat_capacity_J_K": None}), ramp(1.0))
