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
    """Returns a rigid pair of 7008C with a thermal network; one bearing stands for both.

    `warm_spindle` has its conductances [W/K] and capacities [J/K], and 12000 r/min, 140 N, 20 degC.
    """
    return warm_spindle()


SMALL_STEPS = {"duration": 40.0, "tolerance": 1e-12}
"""Arguments of a warm-up of 40 s that is exact to 1e-6 at least."""


def set_constant_heat(monkeypatch, heat):
    """Replaces the heat of each bearing by this `HeatFlow`, whatever its temperatures."""
    heats_of = transient.heats_of
    monkeypatch.setattr(
        transient, "heats_of", lambda *inputs: tuple(heat for _ in heats_of(*inputs))
    )


def test_one_node_of_constant_heat_warms_exponentially(spindle, monkeypatch):
    """The outer ring, nearly insulated from the balls, has T = T_0 + P/G (1 - exp(-t G/C)).

    It has 8 W and, by `warm_spindle`, 4 W/K to the housing and 40 J/K; T_0 is 20 degC.
    """
    P, G, C = 8.0, 4.0, 40.0
    set_constant_heat(monkeypatch, HeatFlow(inner=0.0, outer=0.0, drag=P))
    alone = spindle.with_({"thermal.conductance_W_K.ball_race": 1e-6})
    instants = warm_up(alone, ramp(0.0), **SMALL_STEPS).instants[1:]
    # parts: inner ring, balls, outer ring
    rises = [instant.temperatures[0, 2] - 20.0 for instant in instants]
    times = np.array([instant.time for instant in instants])
    assert_allclose(rises, P / G * (1.0 - np.exp(-times * G / C)), rtol=1e-6)


def test_three_nodes_of_constant_heat_warm_by_the_matrix_exponential(spindle, monkeypatch):
    """Rises of inner ring, balls and outer ring are (1 - exp(-t G/C)) times the steady ones.

    G [W/K] and C [J/K] are those of `warm_spindle`. Half of the heat of a contact goes into its
    ring, half into the balls; drag heats the outer ring. SciPy computes the exponential.
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
    """Temperatures are within `SETTLED_TO` of the rise of the steady solve, the preload to 1 %."""
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
    """Where the rotor is held at its first place, the first bearing alone has no heat balance.

    That is not checked here. On the free rotor both bearings have one, and the warm-up ends there.
    The numbers are those of trial 147 of `benchmarks/random_warmups.py`, seed 1.
    """
    # 495 000 mm r/min, at a mean of bore and outside diameter of 54 mm
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
    T = np.array(steady.values["part_temperature"])[:, :3]  # inner ring, balls, outer ring
    distance = np.abs(warming.instants[-1].temperatures - T).max()
    assert distance < transient.SETTLED_TO * np.abs(T - 20.0).max()
    assert steady.values["heat_flow_residual"].max() < 1e-6  # relative: the balance is solved


def test_a_slow_ramp_is_a_sweep_of_steady_states(spindle):
    """The ramp takes 2e5 s, time constants are below a minute; a few instants are compared."""
    course = ramp(2e5)
    warming = warm_up(spindle, course, duration=2e5)
    rise = np.abs(warming.instants[-1].temperatures - 20.0).max()
    every_quarter = max(len(warming.instants) // 4, 1)
    for instant in warming.instants[every_quarter::every_quarter]:
        steady = solve(spindle.with_({"operation.shaft_speed_rpm": instant.share * 12000.0}))
        expected = np.array(steady.values["part_temperature"][:3]) - 20.0
        assert_allclose(instant.temperatures[0] - 20.0, expected, atol=1e-3 * rise)


# the housing warms in 30 s, so that it matters within the 30 s that are compared
WARMED_FAST = SLOW_HOUSING | {"thermal.housing_time_constant_s": 30.0}


@pytest.mark.parametrize(
    ("changes", "seconds"),
    [
        pytest.param(WARMED_FAST, 10.0, id="ramp"),
        pytest.param(WARMED_FAST, 0.0, id="at once"),
        pytest.param(
            {"thermal.shaft_C": 40.0, "thermal.shaft_time_constant_s": 20.0},
            20.0,
            id="warm shaft",
            marks=pytest.mark.long,
        ),
        pytest.param(
            WARMED_FAST | {"operation.preload_method": "constant_force"}, 5.0, id="constant force"
        ),
        pytest.param(
            WARMED_FAST | {"bearing.contact_angle_deg": 25.0, "operation.preload_N": 300.0},
            15.0,
            id="25 degrees",
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_warm_up_agrees_with_a_plain_program(spindle, changes, seconds):
    """Temperature rises, preload and pressure after 30 s agree to 0.1 %.

    The plain program takes Euler's steps, whose error is proportional to their length: it is
    extrapolated from 120 and 240 of them.

    seconds: of the ramp.
    """
    scene = spindle.with_(changes)
    last = warm_up(scene, ramp(seconds), duration=30.0).instants[-1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # those of its solves
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
    """The peak preload is to stay below 220 N. It falls with the length of the ramp.

    Expected is the ramp at which peaks over a grid, by warm-ups with finer steps than those of the
    search, cross the limit. The search stops at 2 % and rounds up to three digits: within 3 %.
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
    # both negated, as `interp` needs rising points
    expected = np.interp(-limit, -np.array(peaks), ramps)
    shortest, broken_by = shortest_ramp(scene, {"preload": limit})
    assert not broken_by
    assert np.all(np.diff(peaks) < 0.1)  # N, for the errors of steps
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
    """The shortest ramp is found to 3 %; of longer ones, half a decade apart, the first are named.

    kept: whether a ramp [s] keeps the limit. seconds: the shortest such ramp.
    broken_by: the first longer ramps tried [s] that break the limit.
    """
    monkeypatch.setattr(shortest_ramps, "limits_hold", lambda _, s, *options: kept(s))
    shortest = shortest_ramp(spindle, {"preload": 1.0})
    assert seconds <= shortest.seconds <= 1.03 * seconds and kept(shortest.seconds)
    assert shortest.broken_by[: len(broken_by)] == broken_by


def test_the_answer_keeps_its_limit_with_fine_steps(spindle, monkeypatch):
    """Coarse steps keep the limit from 50 s on, fine ones only from 51 s: the answer is above 51 s.

    A call with the tolerance of fine steps is one with `STEP_TOLERANCE`.
    """

    def limits_hold(_, seconds, limits, tolerance=1.0):
        return seconds >= (51.0 if tolerance == transient.STEP_TOLERANCE else 50.0)

    monkeypatch.setattr(shortest_ramps, "limits_hold", limits_hold)
    assert 51.0 <= shortest_ramp(spindle, {"preload": 1.0}).seconds < 53.0


def test_a_limit_that_every_ramp_keeps_needs_none(spindle):
    """The shortest ramp is 0 s, and no longer one breaks the limits, in N and GPa."""
    scene = spindle.with_(SLOW_HOUSING)
    assert shortest_ramp(scene, {"preload": 1e4, "pressure": 5.0}) == (0.0, ())


def test_a_limit_that_no_ramp_keeps_has_no_shortest(spindle):
    """The limit is 100 N, the preload as mounted 140 N: the shortest ramp is None."""
    assert shortest_ramp(spindle.with_(SLOW_HOUSING), {"preload": 100.0}) is None


def test_a_cold_housing_makes_a_rigid_preload_pass_its_steady_value(spindle):
    """The peak is at least 30 % higher, after the ramp of 10 s and within the 300 s of the housing.

    Its estimated error is 2 % at most.
    """
    dataset = warm_up_dataset(spindle.with_(SLOW_HOUSING), ramp(10.0))
    assert dataset["peak_residual_preload"] > 1.3 * dataset["end_residual_preload"]
    assert 10.0 < dataset["peak_residual_preload_time"] < 300.0
    assert dataset["error_estimate"] < 0.02


def test_the_preload_of_a_spring_does_not_move(spindle):
    """A constant force stays at its 140 N."""
    changes = {"operation.preload_method": "constant_force"} | SLOW_HOUSING
    dataset = warm_up_dataset(spindle.with_(changes), ramp(10.0), duration=100.0)
    assert_allclose(dataset["residual_preload"], 140.0, rtol=1e-12)


POOR = {"thermal.conductance_W_K.inner_ring_shaft": 0.2}
"""A tenth of the conductance from the inner ring of the spindle to its shaft."""


def test_a_runaway_is_named(spindle):
    """Both the warm-up and the steady solve say that there is no steady state.

    The steady solve ends with `warm_seizure` if heat and preload grow without limit in its search,
    or with `no_heat_balance` if it stops before. Both are right.
    """
    warming = warm_up(spindle.with_(POOR), ramp(10.0))
    assert warming.status != code.OK and warming.runs_away
    assert solve(spindle.with_(POOR)).status in ("warm_seizure", "no_heat_balance")


def test_the_margin_is_one_where_steady_states_end(spindle):
    """A bisection of the conductance to the shaft finds the last steady state; its margin is 1.

    To 1 %, as margin - 1 is proportional to the square root of the distance in conductance.
    """
    key = "thermal.conductance_W_K.inner_ring_shaft"
    low, high = 0.2, 2.0  # W/K: seizes, and does not
    margins = []  # of solved states, at falling conductances
    for _ in range(24):  # to 1e-7 W/K
        middle = 0.5 * (low + high)
        result = solve(spindle.with_({key: middle}))
        if result.status == "ok":
            high = middle
            margins.append(float(result.values["thermal_margin"]))
        else:
            low = middle
    assert_allclose(margins[-1], 1.0, rtol=1e-2)
    assert margins[0] > 1.5  # at 1.1 W/K, far from the end


def test_bearings_without_a_state_as_mounted_have_no_warm_up(spindle):
    """60 um of wear are far more than the elastic approach of both races, a few um at 140 N."""
    worn = spindle.with_({"wear.ball_diameter_loss_um": 60.0})
    with pytest.raises(NotAvailable, match=r": no state at the start \(contact_lost: "):
        warm_up_dataset(worn, ramp(0.0))
    assert shortest_ramp(worn, {"pressure": 5.0}) is None


def test_times_and_speeds_are_followed(spindle):
    """A course has times [s] and shares of the full speed; its corners and the end are instants."""
    course = SpeedCourse((0.0, 5.0, 20.0), (0.0, 0.5, 1.0))
    warming = warm_up(spindle, course, duration=30.0)
    times = [instant.time for instant in warming.instants]
    assert {5.0, 20.0, 30.0} <= set(times)
    shares = [instant.share for instant in warming.instants]
    assert_allclose(shares, [course.at(time) for time in times])


def test_a_scene_without_capacities_is_refused_in_one_line(spindle):
    with pytest.raises(SceneError, match=r"thermal.heat_capacity_J_K: got nothing, expected"):
        warm_up(spindle.with_({"thermal.heat_capacity_J_K": None}), ramp(1.0))
