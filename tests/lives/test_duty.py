"""A life over a duty: known mixtures, limits in which it is another life, and phases one by one."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.interpolate import CubicSpline
from support import numbers_in, only_line

import bearingwear
from bearingwear.cli import main
from bearingwear.document.document import load_document
from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import at_speed, cycle_of, ramp_points
from bearingwear.lives.duty.lives import (
    DutyLife,
    duty_life,
    hertzian_duty_life,
    worn_duty_life,
)
from bearingwear.lives.duty.warm import _steady_warm_up
from bearingwear.lives.duty.wearing import DutyCriteria, DutyGrooves, DutySurfaces
from bearingwear.lives.grooves import EXACT_GROOVES, Grooves, StiffGrooves, follow_grooves
from bearingwear.lives.life import life
from bearingwear.lives.many import HertzianLives, lives_by_case, lives_by_end, worn_life
from bearingwear.lives.margin import torque_corners
from bearingwear.lives.surfaces import surface_life
from bearingwear.measures import WORST
from bearingwear.results.life_variables import DUTY
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.read import load_scene
from bearingwear.sides import SHARED
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.state import State
from bearingwear.studies.design import map as design_map
from bearingwear.studies.design.document.sheets import preload_document
from bearingwear.studies.design.map import design_point
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.recommend import recommendation
from bearingwear.studies.lives.duty_report import duty_report
from bearingwear.studies.sampling import scene_with_values
from bearingwear.studies.uncertainty.quantiles import uncertain_lives

HOUR = 3600.0
POSITION = {"operation.preload_method": "fixed_position"}
RIGID = POSITION | {"arrangement.kind": "rigid_pair"}
NETWORK = {
    "thermal": {
        "conductance_W_K": {"inner_ring_shaft": 0.1, "outer_ring_housing": 0.1, "ball_race": 0.05},
        "shaft_C": 20.0,
        "housing_C": 20.0,
    }
}
FILM = {
    "friction.ball_race": None,
    "friction.film": {
        "shear_strength_MPa": 0.0,
        "pressure_coefficient": 0.08,
        "thickness_um": 0.02,
        "wear_coefficient": 1.0e-6,
        "bare_ball_race": 0.1,
    },
}
PLAIN = {"uncertainty": None, "cage": None}
HERTZ = PLAIN | {"model.contact": "hertz"}
WORN = PLAIN | {"model.contact": "worn"}
CASES = {
    "idle": {"operation.shaft_speed_rpm": 6000.0},
    "fast": {"operation.shaft_speed_rpm": 36000.0},
    "hot": {"friction.ball_race": 0.05},
}
NOMINAL_ALONE = {"duty": {"phases": {"nominal": {"hours": 3.0}}}}


def duty(phases, **more):
    """Returns the block `duty` of these phases, with other keys of it."""
    return {"duty": {"phases": phases} | more}


MIXED = {"idle": {"hours": 1.0}, "nominal": {"hours": 6.5}, "fast": {"hours": 0.5}}


def even_life(scene):
    """Returns the life over a duty with Hertzian contacts, and its cycle."""
    cycle = cycle_of(scene, 2)  # two speeds for each start
    return hertzian_duty_life(cycle, [solver_of(s) for s in cycle.scenes]), cycle


def hours(life):
    """Returns the hours of a life, which has to be solved."""
    assert life.status == code.OK, code.STATUS_NAMES[life.status]
    return life.last.time / HOUR


# mixtures with published lives


class SteadyRate:
    """A solver whose bearing wears at one rate, whatever it has lost [m/s]."""

    solves = 0

    def __init__(self, rate):
        self.rate = rate

    def __call__(self, conditions):
        values = {"ball_diameter_loss": conditions[0].loss, "ball_diameter_loss_rate": self.rate}
        return (State(code.OK, values),)


def test_constant_rates_add_as_palmgren_and_miner_say(scene):
    """The documentation of the Python package `reliability` has the cycles and shares [%].

    Its example of three stresses has 50 000, 6500 and 1000 cycles to failure.
    """
    hours_alone = {"nominal": 50_000.0, "idle": 6500.0, "fast": 1000.0}
    minutes = {"nominal": 40.0, "idle": 15.0, "fast": 5.0}  # of a cycle of one hour
    phases = {name: {"hours": m / 60.0, "case": name} for name, m in minutes.items()}
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.7}}
    duty_scene = scene("gyro_s1", HERTZ | end | {"cases": CASES} | duty(phases))
    cycle = cycle_of(duty_scene)
    rates = [0.7e-6 / (h * HOUR) for h in hours_alone.values()]
    over_duty = hertzian_duty_life(cycle, [SteadyRate(rate) for rate in rates])
    assert hours(over_duty) == pytest.approx(7400.37951, abs=1e-5)  # the printed digits
    shares = cycle.shares * rates * over_duty.last.time / 0.7e-6
    assert_allclose(100.0 * shares, [9.86717, 28.46300, 61.66983], atol=1e-5)


# one condition


@pytest.mark.parametrize(
    "changes",
    [HERTZ, HERTZ | POSITION, HERTZ | FILM, HERTZ | POSITION | NETWORK, HERTZ | RIGID | FILM]
    + [HERTZ | RIGID | {"arrangement.external_axial_N": 2.0}],
    ids=["spring", "position", "film", "heat", "pair with a film", "pair under a force"],
)
def test_one_phase_lives_as_the_scene_itself(scene, changes):
    alone = scene("gyro_s1", changes)
    over_duty, _ = even_life(alone.with_(NOMINAL_ALONE))
    expected = surface_life(alone, solver_of(alone))
    assert expected.status == code.OK and len(expected.nodes) > 2  # steps were taken
    assert (over_duty.last.time, over_duty.criterion) == (expected.last.time, expected.criterion)


@pytest.mark.parametrize("changes", [{}, POSITION | NETWORK], ids=["spring", "heat"])
def test_one_phase_wears_its_grooves_as_the_scene_itself(scene, changes):
    alone = scene("gyro_s1", WORN | changes)
    expected = follow_grooves(StiffGrooves(alone))
    over_duty = worn_duty_life(cycle_of(alone.with_(NOMINAL_ALONE)))
    assert expected.status == code.OK and len(expected.nodes) > 2  # steps were taken
    assert (over_duty.last.time, over_duty.criterion) == (expected.last.time, expected.criterion)
    assert (over_duty.last.worn[0].grooves == expected.last.worn[0].grooves).all()


@pytest.mark.parametrize("changes", [HERTZ, HERTZ | POSITION], ids=["spring", "position"])
def test_order_cuts_and_length_of_phases_do_not_change_a_life(scene, changes):
    """Phases in reverse order give the same bits; cut in two, or twice as long, to rounding."""
    duty_scene = scene("gyro_s1", changes | {"cases": CASES} | duty(MIXED))
    expected, _ = even_life(duty_scene)
    backwards, _ = even_life(duty_scene.with_(duty(dict(reversed(MIXED.items())))))
    assert backwards.last.time == expected.last.time
    cut_in_two = MIXED | {"nominal": {"hours": 2.5}, "later": {"hours": 4.0, "case": "nominal"}}
    doubled = {name: {"hours": 2.0 * phase["hours"]} for name, phase in MIXED.items()}
    for phases in (cut_in_two, doubled):
        over_duty, _ = even_life(duty_scene.with_(duty(phases)))
        assert over_duty.last.time == pytest.approx(expected.last.time, rel=1e-12)
        assert over_duty.criterion == expected.criterion


@pytest.mark.parametrize("film", [HERTZ | FILM, WORN | FILM], ids=["even", "worn"])
def test_order_of_phases_does_not_change_a_life_whose_film_wears_through(scene, film):
    """Phases in reverse order give the same bits; one cut in two changes the seventh digit.

    Rates are then summed in another order, which changes their last digit.
    """
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.06}}
    cases = CASES | {"hot": {"friction.film.bare_ball_race": 0.3}}
    phases = {"fast": {"hours": 0.1}, "hot": {"hours": 0.7, "starts": 1.0}, "idle": {"hours": 0.3}}
    backwards = dict(reversed(phases.items()))
    apart = phases | {"hot": {"hours": 0.4, "starts": 1.0}, "later": {"hours": 0.3, "case": "hot"}}
    ramps = {"start_s": 20.0, "stop_s": 60.0}
    filmed = scene("gyro_s1", film | POSITION | end | {"cases": cases})
    results = [duty_life(filmed.with_(duty(mix, **ramps))) for mix in (phases, backwards, apart)]
    forwards_life, backwards_life, life_cut_in_two = (result.life for result in results)
    assert forwards_life.last.states[0]["film_left"].min() <= 0.0
    assert forwards_life.last.time == backwards_life.last.time
    assert forwards_life.last.time > 0.0
    assert life_cut_in_two.last.time == pytest.approx(forwards_life.last.time, rel=1e-6)
    assert len({result.ending_case_index for result in results}) == 1


# phases by their own histories


MIXTURES = [
    MIXED,
    {"idle": {"hours": 100.0}, "fast": {"hours": 0.1}},
    {"hot": {"hours": 3.0}, "fast": {"hours": 2.0}, "nominal": {"hours": 1.0}},
]


@pytest.mark.parametrize("phases", MIXTURES)
@pytest.mark.parametrize("method", [{}, POSITION], ids=["spring", "position"])
def test_hours_follow_from_the_histories_of_the_phases(scene, phases, method):
    """t = integral of dL over the sum of (h_k/T) dL/dt_k(L), of splines of each phase's times."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    duty_scene = scene("gyro_s1", HERTZ | method | end | {"cases": CASES} | duty(phases))
    computed, _ = even_life(duty_scene)
    rates = []
    for name in phases:
        alone = duty_scene.in_cases[name]
        result = surface_life(alone, solver_of(alone))
        time_of_loss = CubicSpline([node.x for node in result.nodes], result.times)
        rates.append((phases[name]["hours"], time_of_loss.derivative()))
    T = sum(h for h, _ in rates)
    expected, _ = quad(lambda L: T / sum(h / slope(L) for h, slope in rates), 0.0, 0.15e-6)
    assert computed.last.time == pytest.approx(expected, rel=1e-3)  # the error of the splines


def temperatures(inner_ring_C, balls_C, outer_ring_C):
    """Returns the temperatures of the parts by their keys of a scene."""
    return {
        "temperature.inner_ring_C": inner_ring_C,
        "temperature.balls_C": balls_C,
        "temperature.outer_ring_C": outer_ring_C,
    }


@pytest.mark.parametrize(
    ("changes", "phases", "loss_um"),
    [
        (POSITION, {"crawl": {"hours": 95.0}, "sprint": {"hours": 5.0}}, 0.15),
        # until it is worn through, which depends on the way there
        (POSITION | FILM, {"cold": {"hours": 3.0}, "warm": {"hours": 1.0}}, 0.01),
        (
            RIGID,
            {"nominal": {"hours": 0.05, "starts": 1.0}, "crawl": {"hours": 0.2, "starts": 2.0}},
            0.15,
        ),
    ],
    ids=["seldom fast", "cold and warm with a film", "pair that starts"],
)
def test_hours_follow_from_histories_at_all_speeds(scene, changes, phases, loss_um):
    """The life is the integral of dL over the mean rate of the loss L of all phases.

    Each rate is that of a life at the condition of a phase alone. A start, with its stop, has the
    mean of 20 speeds in the middle of equal parts.
    """
    cases = {
        "crawl": {"operation.shaft_speed_rpm": 3000.0},
        "sprint": {"operation.shaft_speed_rpm": 42000.0},
        "cold": {"operation.shaft_speed_rpm": 6000.0} | temperatures(-20.8, -20.4, -20.0),
        "warm": temperatures(71.5, 71.0, 70.0),
    }
    end = {"wear.end_of_life": {"ball_diameter_loss_um": loss_um}}
    fine = {"friction.slip_regularisation_m_s": 1e-4}
    start_and_stop_s, n = 60.0 + 120.0, 20
    mix = {"cases": cases} | duty(phases, start_s=60.0, stop_s=120.0)
    with_duty = scene("gyro_s1", HERTZ | changes | end | fine | mix)
    parts = []  # time in a cycle [s] and scene
    for name, phase in phases.items():
        alone = with_duty.in_cases[name]
        parts.append((HOUR * phase["hours"], alone))
        shares = (np.arange(n) + 0.5) / n if "starts" in phase else ()
        parts += [(phase["starts"] * start_and_stop_s / n, at_speed(alone, s)) for s in shares]
    slopes = []  # time in a cycle [s] and time per loss [s/m]
    for span, alone in parts:
        life_alone = surface_life(alone, solver_of(alone))
        time_of_loss = CubicSpline(
            [node.states[0].loss for node in life_alone.nodes], life_alone.times
        )
        slopes.append((span, time_of_loss.derivative()))
    T = sum(span for span, _ in parts)
    losses = np.linspace(0.0, loss_um * 1e-6, 2001)
    expected = np.trapezoid(T / sum(span / slope(losses) for span, slope in slopes), losses)
    over_duty, _ = even_life(with_duty)
    assert over_duty.last.time == pytest.approx(expected, rel=1e-3)  # splines, speeds of a start


def test_any_phase_may_end_the_life(scene):
    """The preload at fixed position is least at rest: the slow phase ends the life of all."""
    duty_scene = scene("gyro_s1", HERTZ | POSITION | {"cases": CASES} | duty(MIXED))
    result, cycle = even_life(duty_scene)
    assert CRITERIA[result.criterion] == "preload_fraction"
    assert cycle.cases[DutyLife(cycle, result).ending_case_index] == "idle"
    by_case = DutyCriteria(cycle).margins_by_case(result.last.states)
    margins = dict(
        zip(cycle.cases, (of_case[result.criterion] for of_case in by_case), strict=True)
    )
    assert margins["idle"] == pytest.approx(0.0, abs=1e-6)  # to which the end is bracketed
    assert min(margins["nominal"], margins["fast"]) > 0.01  # far from it


# starts and stops


def test_points_of_a_ramp_integrate_the_rates_of_a_bearing():
    """n points are exact for the speed s times polynomials in s^2 of degrees to 2 (n - 1)."""
    for n in (2, 3, 4):
        speeds, weights = ramp_points(n)
        assert speeds[0] == 1.0  # which has been solved for the phase itself
        for k in range(2 * n - 1):
            integral = 1.0 / (2 * k + 2)  # of s^(2 k + 1) from 0 to 1
            assert weights @ speeds ** (2 * k + 1) == pytest.approx(integral, rel=1e-13)


@pytest.mark.parametrize("method", [{}, POSITION], ids=["spring", "position"])
def test_a_start_to_a_low_speed_wears_half_of_its_time_at_that_speed(scene, method):
    """Under starts and stops alone, a bearing therefore lives twice as long as at the speed."""
    slow = {"slow": {"operation.shaft_speed_rpm": 600.0}}
    starts = duty({"slow": {"starts": 3.0}}, start_s=20.0, stop_s=60.0)
    duty_scene = scene("gyro_s1", HERTZ | method | {"cases": slow} | starts)
    result, _ = even_life(duty_scene)
    alone = duty_scene.in_cases["slow"]
    at_speed_alone = hours(surface_life(alone, solver_of(alone)))
    # rates go as the speed, whose mean over a ramp is half of it: 600 r/min is so slow that
    # centrifugal forces, which go as the square of the speed, do not show
    assert 0.5 * hours(result) == pytest.approx(at_speed_alone, rel=1e-3)


@pytest.mark.parametrize("method", [{}, POSITION], ids=["spring", "position"])
def test_two_points_of_a_ramp_have_the_wear_of_forty_speeds(scene, method):
    """A start to full speed has it within 0.2 %; the forty are midpoints of equal parts."""
    fine = {"friction.slip_regularisation_m_s": 1e-4}
    starts = duty({"nominal": {"starts": 1.0}}, start_s=20.0, stop_s=60.0)
    duty_scene = scene("gyro_s1", HERTZ | method | fine | starts)

    def rate(scene):
        states = solver_of(scene)
        return states(states.bearings.start)[0].rate

    speeds = (np.arange(40) + 0.5) / 40.0
    expected = np.mean([rate(at_speed(duty_scene.in_cases["nominal"], s)) for s in speeds])
    cycle = cycle_of(duty_scene)
    mean = cycle.shares @ [rate(s) for s in cycle.scenes]
    assert_allclose(mean, expected, rtol=2e-3)


# starts from the mounting temperature

WARMING = {
    "thermal": {
        "conductance_W_K": {
            "inner_ring_shaft": 0.02,
            "outer_ring_housing": 0.02,
            "ball_race": 0.02,
        },
        "heat_capacity_J_K": {"inner_ring": 1.0, "balls": 0.3, "outer_ring": 1.5},
        "housing_C": 35.0,
        "housing_time_constant_s": 300.0,
    }
}


@pytest.mark.parametrize("hours_on", [1.0, 0.1], ids=["warm at the end", "never warm"])
def test_a_start_wears_at_its_own_temperatures(scene, hours_on):
    """The life is that of the mean rate over a cycle, at the temperatures of each instant.

    Temperatures are those of `warmup`; each instant is solved with them as given. Between the
    instants the rates here are straight lines, which leaves 0.2 %.
    """
    loss = {"wear.end_of_life": {"ball_diameter_loss_um": 0.001}}  # at which rates are as new
    fine = {"friction.slip_regularisation_m_s": 1e-4}
    starts = duty(
        {"nominal": {"hours": hours_on, "starts": 1.0}}, start_s=60.0, stop_s=0.0, warmup=True
    )
    duty_scene = scene("gyro_s1", HERTZ | POSITION | WARMING | loss | fine | starts)
    alone = duty_scene.in_cases["nominal"]
    warmed = bearingwear.warmup(alone, seconds=60.0)
    times, speeds = warmed["time"].values, warmed["shaft_speed"].values
    housing_C = 35.0 - 15.0 * np.exp(-times / 300.0)  # from 20 to 35 degC
    rates = []
    for k, speed in enumerate(speeds):
        (parts,) = warmed["part_temperature"].values[k].tolist()
        T = dict(zip(("inner_ring_C", "balls_C", "outer_ring_C"), parts, strict=True))
        T |= {"shaft_C": 20.0, "housing_C": float(housing_C[k])}
        inputs = {"temperature": T, "thermal": None}
        if speed:
            instant = at_speed(alone.with_(inputs), speed / speeds[-1])
            rates.append(float(bearingwear.solve(instant)["ball_diameter_loss_rate"]))
        else:
            rates.append(0.0)
    cycle_s = 60.0 + hours_on * HOUR
    instants = np.linspace(0.0, cycle_s, 20_001)
    mean = np.trapezoid(np.interp(instants, times, rates), instants) / cycle_s
    with pytest.warns(UserWarning, match="the life has only .* cycles of the duty"):
        result = bearingwear.life(duty_scene)
    assert float(result["life"]) == pytest.approx(1e-9 / mean / HOUR, rel=2e-3)
    assert float(result["ramp_error_estimate"]) < 1e-3
    with pytest.warns(UserWarning, match="the life has only .* cycles of the duty"):
        cold = bearingwear.life(duty_scene.with_({"duty.warmup": False}))
    # five times what the sums differ by: starts at steady temperatures would be another life
    assert abs(float(result["life"]) / float(cold["life"]) - 1.0) > 0.01


WARM_STARTS = duty({"nominal": {"hours": 1.0, "starts": 1.0}}, start_s=60.0, warmup=True)


def test_starts_that_warm_up_need_heat_capacities(scene):
    """A network of conductances alone is refused."""
    with pytest.raises(ValueError, match="duty.warmup: got true, expected a thermal network"):
        life(scene("gyro_s1", HERTZ | POSITION | NETWORK | WARM_STARTS))


def test_starts_of_a_bearing_that_seizes_are_refused(scene):
    seizing = WARMING | {"thermal.conductance_W_K.inner_ring_shaft": 1e-4}
    seizing |= {"thermal.conductance_W_K.ball_race": 1e-4, "friction.ball_race": 0.3}
    with pytest.raises(NotAvailable, match="got a start without a steady state"):
        life(scene("gyro_s1", HERTZ | POSITION | seizing | WARM_STARTS))


def test_starts_of_a_bearing_without_a_state_as_mounted_are_refused(scene):
    """With 60 um of wear, the balls no longer reach the inner race in the position set at 7 N."""
    loose = WARMING | {"wear.ball_diameter_loss_um": 60.0}
    with pytest.raises(NotAvailable, match="duty.warmup: got bearings without a state as mounted"):
        _steady_warm_up(scene("gyro_s1", HERTZ | POSITION | loose), 60.0)


# phases one after the other, with the wear carried on

CYCLES = 200
"""Cycles into which a life is cut: run one after the other, they end it within one of them."""

ONE_CYCLE = 1.0 / CYCLES


def life_by_cycles(phases, start, spans, has_ended):
    """Runs phases one after the other until one ends the life, and returns time [s] and wear then.

    Each span is a step of the midpoint rule.

    phases: objects with `after(worn, span, at)`, the wear after a span at the rates of `at`.
    start: wear to begin with. spans: time of each phase in a cycle [s].
    has_ended: function (phase, worn) -> bool.
    """
    worn, time = start, 0.0
    for _ in range(3 * CYCLES):
        for phase, span in zip(phases, spans, strict=True):
            half = phase.after(worn, 0.5 * span, worn)
            worn, time = phase.after(worn, span, half), time + span
            if has_ended(phase, worn):
                return time, worn
    raise AssertionError("no phase has ended the life")


class LossPhase:
    """Phase whose wear is its loss alone, each time solved as a scene that has lost as much."""

    def __init__(self, scene):
        self.scene = scene

    def state(self, worn):
        """Returns the solved state at a loss [m]."""
        scene = self.scene.with_({"wear.ball_diameter_loss_um": worn * 1e6})
        states = solver_of(scene)
        (state,) = states(states.bearings.start)
        assert state.status == code.OK
        return state

    def after(self, worn, span, at):
        """Returns the loss after a span [s] at the rate of the loss `at` [m]."""
        return worn + span * self.state(at).rate


def test_phases_run_one_after_the_other_wear_as_their_mean(scene):
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    duty_scene = scene("gyro_s1", HERTZ | POSITION | end | {"cases": CASES} | duty(MIXED))
    result, _ = even_life(duty_scene)
    spans = np.array([phase["hours"] for phase in MIXED.values()])
    spans *= result.last.time / CYCLES / spans.sum()
    phases = [LossPhase(duty_scene.in_cases[name]) for name in MIXED]
    time, _ = life_by_cycles(phases, 0.0, spans, lambda _, worn: worn >= 0.15e-6)
    assert result.last.time == pytest.approx(time, rel=ONE_CYCLE)


class WearingPhase:
    """Phase that wears films or grooves.

    way: wear model of this phase, with its states and rates.
    plus: function (worn, span, rates) that returns the wear after a span of time.
    """

    def __init__(self, way, plus):
        self.way, self.plus = way, plus

    def states(self, worn):
        states = self.way.state(worn)
        assert all(state.status == code.OK for state in states)
        return states

    def after(self, worn, span, at):
        node = SimpleNamespace(states=self.states(at), worn=at)
        return self.plus(worn, span, self.way.rates(node))


def test_films_wear_through_in_all_phases_at_once(scene):
    """The life by mean rates against the same phases run one after the other, in 200 cycles.

    They end within one cycle of each other. Loss and films are carried from phase to phase, beyond
    the time at which a film is gone.
    """
    largest_loss = 0.15e-6  # of ball diameter, with both grooves [m]
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 1e6 * largest_loss}}
    cases = {name: case for name, case in CASES.items() if name != "hot"}
    duty_scene = scene("gyro_s1", HERTZ | FILM | POSITION | end | {"cases": cases} | duty(MIXED))
    result, cycle = even_life(duty_scene)
    spans = np.array([MIXED[name]["hours"] for name in cycle.cases])
    spans *= result.last.time / CYCLES / spans.sum()
    mixed = DutySurfaces(cycle, [solver_of(s) for s in cycle.scenes])
    phases = [WearingPhase(way, lambda worn, span, rate: worn + span * rate) for way in mixed.ways]
    films_gone = []

    def has_ended(phase, worn):
        """Removes films that are worn through; returns whether the largest loss is reached."""
        node = SimpleNamespace(states=phase.states(worn), worn=worn)
        # event 0 is the largest loss, the others are films: inner race, outer race, balls
        _, *films_left = phase.way.events(node)
        for event, share_left in enumerate(films_left, start=1):
            if share_left <= 0.0:
                films_gone.append(event)
                assert phase.way.pass_event(event, node)  # removes the film
        diameter_loss, inner_depth, outer_depth = worn
        return diameter_loss + inner_depth + outer_depth >= largest_loss

    time, worn = life_by_cycles(phases, mixed.start, spans, has_ended)
    assert films_gone  # or the test says nothing of films
    assert result.last.time == pytest.approx(time, rel=ONE_CYCLE)
    # a cycle where a film goes, and a cycle at the end
    assert_allclose(result.last.worn, worn, rtol=2.0 * ONE_CYCLE)


@pytest.mark.parametrize(
    "film",
    [{}, pytest.param(FILM | {"friction.film.thickness_um": 0.07}, marks=pytest.mark.long)],
    ids=["bare", "film"],
)
def test_grooves_wear_in_all_phases_at_once(scene, film):
    """The life by mean rates against the same phases run one after the other, in 200 cycles.

    They end within one cycle of each other, with the same deepest grooves to two. A film, if any,
    is worn through before the end.
    """
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    cases = {name: case for name, case in CASES.items() if name != "hot"}
    duty_scene = scene("gyro_s1", WORN | POSITION | film | end | {"cases": cases} | duty(MIXED))
    cycle = cycle_of(duty_scene)
    mixed_life = worn_duty_life(cycle)
    if film:
        assert mixed_life.last.states[0]["film_left"].min() < 0.0
    spans = np.array([MIXED[name]["hours"] for name in cycle.cases])
    spans *= mixed_life.last.time / CYCLES / spans.sum()
    mixed = DutyGrooves(cycle)

    def plus(worn, span, rates):
        return tuple(w.plus(span, rate) for w, rate in zip(worn, rates, strict=True))

    def has_ended(phase, worn):
        margins = DutyCriteria(cycle).criteria[0].margins(phase.states(worn))
        return margins.min() <= 0.0

    phases = [WearingPhase(way, plus) for way in mixed.ways]
    for phase in phases:
        phase.states(mixed.start)  # the first call sets from where equivalent losses count
    time, worn = life_by_cycles(phases, mixed.start, spans, has_ended)
    assert mixed_life.last.time == pytest.approx(time, rel=ONE_CYCLE)
    deepest = worn[0].grooves.max(axis=1)
    assert_allclose(mixed_life.last.worn[0].grooves.max(axis=1), deepest, rtol=2.0 * ONE_CYCLE)


@pytest.mark.parametrize("thickness", [0.02, 0.07])
def test_a_film_worn_through_has_the_life_of_four_times_shorter_steps(scene, thickness):
    """Steps of 0.24 of the gap of the contact and of 0.06 differ by less than 0.5 %."""
    film = FILM | {"friction.film.thickness_um": thickness}
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    filmed = scene("gyro_s1", WORN | POSITION | film | end)
    coarse, fine = (
        follow_grooves(Grooves(filmed, EXACT_GROOVES._replace(step=step))) for step in (0.24, 0.06)
    )
    assert coarse.last.states[0]["film_left"].min() < 0.0
    assert hours(coarse) == pytest.approx(hours(fine), rel=5e-3)


def test_a_force_in_one_phase_wears_both_bearings_of_a_pair(scene):
    """Pushed one way for half of the time and the other way for the rest, both wear alike."""
    pushed = {
        "forth": {"arrangement.external_axial_N": 2.0},
        "back": {"arrangement.external_axial_N": -2.0},
        "nominal": {},
    }
    cases = {name: value for name, value in pushed.items() if value}
    duty_scene = scene(
        "gyro_s1", HERTZ | RIGID | {"cases": cases} | duty({"forth": {"hours": 1.0}})
    )
    phases = {name: {"hours": 1.0} for name in pushed}
    result, cycle = even_life(duty_scene.with_(duty(phases)))
    assert hours(result) > 0.0
    first, second = result.last.worn
    assert_allclose(first, second, rtol=1e-6)
    pushed_one_way, _ = even_life(duty_scene)
    first, second = pushed_one_way.last.worn
    assert abs(first / second - 1.0) > 1e-2


# results

RAMPED = {"idle": {"hours": 1.0, "starts": 1.0}, "nominal": {"hours": 6.5}}
RAMPS = {"start_s": 20.0, "stop_s": 60.0}
SLOW_WEAR = {
    "materials.bearing_steel.wear_coefficient": 1e-9,
    "friction.slip_regularisation_m_s": 1e-5,
}


@pytest.fixture(scope="module")
def life_over_duty(scene):
    """Returns a function (changes, phases, keys of the duty) that solves a life of gyro_s1.

    By default the duty has the phases RAMPED and the keys RAMPS.
    """

    def life_of(changes, phases=None, **more):
        inputs = duty(phases or RAMPED, **(RAMPS | more))
        return life(scene("gyro_s1", SLOW_WEAR | changes | {"cases": CASES} | inputs))

    return life_of


@pytest.mark.parametrize("contact", [HERTZ, WORN], ids=["even", "worn"])
@pytest.mark.parametrize("kind", [POSITION, RIGID | {"arrangement.external_axial_N": 1.0}])
def test_shares_of_wear_and_time_add_up_to_one(life_over_duty, contact, kind):
    """The share of starts is a part of that of their phase; shares along the life never fall."""
    result = life_over_duty(contact | kind)
    values = result.values
    assert result.status == "ok" and values["phase_time_share"].sum() == pytest.approx(1.0)
    shares, of_starts = values["phase_wear_share"], values["start_wear_share"]
    assert_allclose(shares.sum(axis=-2), 1.0, rtol=1e-12)
    assert (0.0 <= of_starts).all() and (of_starts < shares).all() and of_starts.any()
    worn_share = values["history_phase_worn_share"]
    assert_allclose(worn_share[..., -1, :], shares[..., -1], rtol=1e-12)
    assert (np.diff(worn_share, axis=-2) >= 0.0).all()
    # hours of RAMPED, and one start and stop of RAMPS
    assert values["life_cycles"] == pytest.approx(values["life"] / (7.5 * HOUR + 80.0))
    assert values["life_error_estimate"] < 0.02


@pytest.mark.parametrize("contact", [HERTZ, WORN], ids=["even", "worn"])
def test_the_phase_with_the_least_preload_ends_the_life(life_over_duty, contact):
    result = life_over_duty(contact | POSITION)
    values = result.values
    assert result.attrs["ended_in"] == "phase idle" and values["ending_phase"] == 0
    least = values["worst_residual_preload"]  # in idle and nominal
    assert least[0] < least[1]
    assert_allclose(values["history_phase_residual_preload"][-1], least, rtol=1e-9)


def test_miners_rule_holds_for_phases_that_do_not_interact(life_over_duty):
    """All phases end at the same loss of 0.02 um, which hardly changes their rates: to 0.1 %."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.02}}
    values = life_over_duty(HERTZ | end, MIXED, start_s=0.0, stop_s=0.0).values
    assert values["palmgren_miner_error"] == pytest.approx(0.0, abs=1e-3)


def test_miners_rule_fails_where_a_phase_ends_by_what_others_wore(life_over_duty):
    """The slow phase ends the life of all by the preload that the others took away.

    The rule's life, 1/sum(time share/life of each phase alone), is then over by more than half.
    """
    values = life_over_duty(HERTZ | POSITION, MIXED, start_s=0.0, stop_s=0.0).values
    share, lives = values["phase_time_share"], values["phase_life"]
    assert values["palmgren_miner_life"] == pytest.approx(1.0 / (share / lives).sum())
    assert values["palmgren_miner_error"] > 0.5


def test_all_phases_end_an_even_loss(life_over_duty):
    result = life_over_duty(HERTZ | {"wear.end_of_life": {"ball_diameter_loss_um": 0.02}})
    assert result.attrs["ended_in"] == "all phases"


@pytest.mark.parametrize("contact", [HERTZ, WORN], ids=["even", "worn"])
def test_a_phase_that_is_not_solved_is_named(scene, contact):
    """Without friction the rotation of the balls is undetermined."""
    phases = {"nominal": {"hours": 1.0}, "still": {"hours": 1.0, "case": "bare"}}
    cases = {"cases": {"bare": {"friction.ball_race": 0.0}}}
    result = life(scene("gyro_s1", contact | cases | duty(phases)))
    assert result.status == "undetermined" and result.attrs["unsolved_phase"] == "still"
    assert "still" in result.reason


def test_a_phase_that_requires_the_dynamic_model_is_refused(scene, tmp_path, capsys):
    """Python raises an error; commands print it in one line, with exit status 2."""
    loaded = {"cases": {"idle": {"operation.radial_load_N": (1.0, 0.0)}}}
    duty_scene = scene("gyro_s1", PLAIN | loaded | duty({"idle": {"hours": 1.0}}))
    problem = "duty: got the case idle, which requires the dynamic"
    with pytest.raises(NotAvailable, match=problem):
        life(duty_scene)
    bearingwear.save(duty_scene, tmp_path / "gyro.yaml")
    for command in (["check"], ["recommend", "--stiffness", "1"]):
        assert main([command[0], str(tmp_path / "gyro.yaml"), *command[1:]]) == 2
        assert problem in only_line(capsys)


@pytest.mark.parametrize(
    ("hours_times", "start_s", "expected"),
    [
        (1.0, 20.0, set()),
        (1.0, 1e-3, {"duty_acceleration"}),  # to 6000 r/min in a millisecond
        (200.0, 20.0, {"duty_cycle"}),  # a cycle of 1500 h: the life has few of them
    ],
)
def test_a_duty_warns_of_hard_starts_and_few_cycles(life_over_duty, hours_times, start_s, expected):
    phases = {
        name: phase | {"hours": hours_times * phase["hours"]} for name, phase in RAMPED.items()
    }
    result = life_over_duty(HERTZ, phases, start_s=start_s)
    ids = {warning["id"] for warning in json.loads(result.attrs["warnings"])}
    assert ids & {"duty_acceleration", "duty_cycle"} == expected


def test_the_friction_that_accelerates_balls_is_that_by_hand(life_over_duty):
    """A ball of 2 mm that rolls as kinematics say, its orbit and its spin, over mu (Q_i + Q_o).

    Within 10 %: loaded contact angles are not the free one, which is taken here.
    """
    values = life_over_duty(HERTZ | {"wear.end_of_life": {"ball_diameter_loss_um": 0.01}}).values
    D, dm, alpha, omega = 2e-3, 7.5e-3, np.radians(20.0), 6000.0 * np.pi / 30.0
    m = 7800.0 * np.pi / 6.0 * D**3
    orbit = 0.5 * omega * (1.0 - D / dm * np.cos(alpha))
    spin = 0.5 * omega * dm / D * (1.0 - (D / dm * np.cos(alpha)) ** 2)
    start_s = RAMPS["start_s"]
    force = (0.1 * m * D**2 * np.hypot(spin, orbit) / (0.5 * D) + m * 0.5 * dm * orbit) / start_s
    friction = 0.08 * 2.0 * 7.0 / (9 * np.sin(alpha))
    share = values["acceleration_friction_share"][0]
    assert share == pytest.approx(force / friction, rel=0.1)


@pytest.mark.parametrize(("contact", "rtol"), [(HERTZ, 1e-3), (WORN, 2e-2)], ids=["even", "worn"])
def test_quick_lives_by_end_and_by_case_follow_the_duty(scene, contact, rtol):
    """Three ways to a quick life have the time of the exact one, within what quick lives err by.

    Cases that are not in the duty have no life; the others share one time and differ in preload.
    """
    duty_scene = scene("gyro_s1", contact | SLOW_WEAR | POSITION | {"cases": CASES} | duty(MIXED))
    exact = life(duty_scene).values["life"]
    quick = worn_life(duty_scene) or HertzianLives(duty_scene, quick=True)(duty_scene)
    assert quick.last.time == pytest.approx(exact, rel=rtol)
    by_case = lives_by_case(duty_scene, quick=True)
    assert {*by_case} == {"idle", "nominal", "fast"}
    assert {case_life.last.time for case_life in by_case.values()} == {by_case["idle"].last.time}
    assert by_case["idle"].last.time == pytest.approx(exact, rel=rtol)
    states = {name: case_life.last.states[0] for name, case_life in by_case.items()}
    left = {name: state["residual_preload"] for name, state in states.items()}
    assert left["idle"] < left["nominal"] < left["fast"]
    end = duty_scene.wear.end_of_life
    looser = replace(end, preload_fraction=0.35)
    assert lives_by_end(duty_scene, looser)(end) == pytest.approx(exact, rel=rtol)


def test_the_sheet_and_the_figure_name_the_phases(scene, tmp_path, capsys):
    path = tmp_path / "gyro.yaml"
    duty_scene = scene("gyro_s1", SLOW_WEAR | HERTZ | {"cases": CASES} | duty(RAMPED, **RAMPS))
    bearingwear.save(duty_scene, path)
    assert main(["check", str(path)]) == 0
    (idle,) = [line for line in capsys.readouterr().out.splitlines() if "idle: " in line]
    # r/min; (1 h + 80 s of a start)/(7.5 h + 80 s) in %; starts a cycle
    assert numbers_in(idle) == [6000.0, 13.6, 1.0]
    assert main(["life", str(path), "-o", str(tmp_path / "life.nc"), "--json"]) == 0
    sheet = json.loads(capsys.readouterr().out)
    assert "phase_wear_share.all" in json.dumps(sheet)
    assert main(["plot", str(tmp_path / "life.nc"), "-o", str(tmp_path / "life.svg")]) == 0
    assert "13.6 % of time" in (tmp_path / "life.svg").read_text()
    assert main(["life", str(path), "--case", "idle", "--json"]) == 0
    assert "phase_wear_share.all" not in capsys.readouterr().out


def test_the_page_has_the_phases_and_their_figure(scene, tmp_path):
    path = tmp_path / "gyro.yaml"
    ramped = scene("gyro_s1", SLOW_WEAR | HERTZ | RIGID | {"cases": CASES} | duty(RAMPED, **RAMPS))
    bearingwear.save(ramped, path)
    dataset, stored, figure = duty_report(path)
    (tmp_path / "duty.json").write_text(stored)
    answer = load_document(tmp_path / "duty.json")
    assert answer.facts["scene"] == ramped.name and "in phase idle" in answer.title
    assert {"phases of the duty", "each phase alone, without starts"} <= {
        block.title for block in answer.blocks_in("open")
    }
    assert "phase idle meets its criterion" in str(answer.blocks_in("lead"))
    rows = {row.name: row for block in answer.blocks_in("open") for row in block.rows}
    percent = 100.0 * float(dataset["palmgren_miner_error"])
    assert numbers_in(rows["palmgren_miner_life"].note) == [float(f"{percent:.2g}")]
    assert "more" in rows["palmgren_miner_life"].note and "palmgren_miner_error" not in rows
    assert float(dataset["life_cycles"]) > 0.0
    assert len(figure.axes) == 2  # the wear of the phases, and what is left of the preload


def test_the_page_names_the_phase_without_a_life(scene, tmp_path):
    path = tmp_path / "gyro.yaml"
    bare = {"cases": {"bare": {"friction.ball_race": 0.0}}}
    phases = duty({"still": {"hours": 1.0, "case": "bare"}})
    bearingwear.save(scene("gyro_s1", HERTZ | bare | phases), path)
    _, stored, _ = duty_report(path)
    assert "no life over the duty: in phase still" in stored


@pytest.mark.long  # two searches for a preload
def test_the_page_has_the_duty_at_the_recommended_preload(scene, tmp_path):
    """Where no life is long enough, it takes the preload of the longest one.

    Where no preload satisfies the other requirements, it takes the input preload.
    """
    path, file = tmp_path / "gyro.yaml", tmp_path / "recommendation.nc"
    changes = SLOW_WEAR | HERTZ | RIGID | {"cases": CASES} | duty(RAMPED, **RAMPS)
    bearingwear.save(scene("gyro_s1", changes), path)

    def duty_answer(limits):
        chosen = recommendation(load_scene(path), limits)
        chosen.to_netcdf(file)
        lived, stored, _ = duty_report(path, file)
        (tmp_path / "duty.json").write_text(stored)
        return chosen, lived, load_document(tmp_path / "duty.json")

    stiff = DesignLimits(system_axial_stiffness_N_um=3.0, at_speed_only=True)
    chosen, lived, answer = duty_answer(stiff)
    best = int(np.argmax(chosen["life"].values))
    longest = float(chosen["life"][best])
    assert float(lived["life"]) == pytest.approx(longest, rel=1e-9)
    assert f"recommended preload, {float(chosen['preload'][best]):g} N" in answer.facts["beside"]
    (table,) = [block for block in preload_document(chosen).blocks if block.title == "recommended"]
    (cycles,) = [row.values[best] for row in table.rows if row.name == "life_cycles"]
    assert cycles == pytest.approx(float(lived["life_cycles"]), rel=1e-9)
    chosen, lived, answer = duty_answer(replace(stiff, life_h=2.0 * longest))
    assert chosen["life"].isnull().all() and "longest life" in answer.facts["beside"]
    assert float(lived["life"]) == pytest.approx(longest, rel=1e-9)
    _, _, answer = duty_answer(replace(stiff, maximum_pressure_GPa=0.01))
    assert "input preload" in answer.facts["beside"]
    assert "No preload is recommended" in str(answer.blocks_in("lead"))


def test_worst_values_of_a_duty_are_shared_by_both_bearings():
    names = {f"worst_{name}" for name in WORST} & {*DUTY}
    assert names and names <= SHARED


@pytest.mark.filterwarnings("error")
def test_phases_have_names_in_python_and_files(scene, tmp_path):
    little_wear = {"wear.end_of_life": {"ball_diameter_loss_um": 0.01}}  # of which nothing warns
    cold = {"temperature": dict.fromkeys(("inner_ring_C", "balls_C", "outer_ring_C"), 20.0)}
    changes = HERTZ | SLOW_WEAR | RIGID | little_wear | cold
    duty_scene = scene("gyro_s1", changes | {"cases": CASES} | duty(RAMPED, **RAMPS))
    result = bearingwear.life(duty_scene)
    bearingwear.save(result, tmp_path / "life.nc")
    for dataset in (result, bearingwear.load(tmp_path / "life.nc")):
        assert dataset["phase"].values.tolist() == ["idle", "nominal"]
        assert float(dataset["phase_life"].sel(phase="idle")) > float(result["life"])
        assert float(dataset["phase_time_share"].sel(phase="nominal")) > 0.8
    fast_first = duty({"fast": {"hours": 1.0}, "nominal": {"hours": 1.0}})
    fast_result = bearingwear.life(duty_scene.with_(fast_first))
    assert fast_result["phase"].values.tolist() == ["fast", "nominal"]
    swept = bearingwear.sweep(duty_scene, {"operation.preload_N": [7.0, 8.0]}, what="life")
    assert swept["phase"].values.tolist() == ["idle", "nominal"]


def test_a_pair_with_a_duty_is_checked_and_solved(scene, tmp_path, capsys):
    path = tmp_path / "pair.yaml"
    bearingwear.save(scene("gyro_s1", HERTZ | RIGID | {"cases": CASES} | duty(RAMPED)), path)
    for command in ("check", "solve"):
        assert main([command, str(path)]) == 0


def test_requirements_hold_in_every_phase_along_one_life(scene):
    """Extremes of a design are the worst of the phases of the duty, not of cases outside it.

    A design follows a life with other steps, hence 0.1 % for its extremes.
    """
    duty_scene = scene(
        "gyro_s1", HERTZ | SLOW_WEAR | POSITION | {"cases": CASES} | duty(RAMPED, **RAMPS)
    )
    limits = DesignLimits(system_axial_stiffness_N_um=1.0, at_speed_only=True)
    point = design_point(duty_scene, limits)
    values = life(duty_scene).values
    assert point["life"] == pytest.approx(values["life"], rel=1e-6)
    worst = values["worst_system_quasistatic_axial_stiffness"].min()
    assert point["system_quasistatic_axial_stiffness"] == pytest.approx(worst, rel=1e-3)
    assert set(point["points"]) == {"idle", "nominal"}
    assert point["deciding"]["life"]["case"] == "idle"  # which ends it
    kept = values["worst_residual_preload"].min() / duty_scene.operation.preload_N
    assert point["preload_kept"] == pytest.approx(kept, rel=1e-3)


def test_a_phase_that_is_not_solved_at_some_speed_leaves_no_preload(scene, monkeypatch):
    ramped = scene(
        "gyro_s1", HERTZ | SLOW_WEAR | POSITION | {"cases": CASES} | duty(RAMPED, **RAMPS)
    )
    unsolved = {"status": code.NOT_CONVERGED, "unsolved": {"case": "nominal"}}
    monkeypatch.setattr(design_map, "_with_all_conditions", lambda *_, **__: dict(unsolved))
    assert design_point(ramped, DesignLimits())["status"] == code.NOT_CONVERGED


def test_a_quick_life_over_one_phase_is_that_of_the_scene(scene):
    """Its time has the same bits, by Hertzian contacts and by worn grooves."""
    alone = scene("gyro_s1", HERTZ | POSITION)
    with_duty = alone.with_(NOMINAL_ALONE)
    lives = [HertzianLives(s, quick=True)(s).last.time for s in (alone, with_duty)]
    assert lives[0] == lives[1]
    worn = {"model.contact": "worn"}
    lives = [worn_life(s.with_(worn)).last.time for s in (alone, with_duty)]
    assert lives[0] == lives[1]


def test_a_spread_over_one_phase_is_that_of_the_scene(scene):
    alone = scene("gyro_s1", POSITION | {"model.contact": "hertz", "cage": None})
    spread = uncertain_lives(alone, samples=16)
    over_duty = uncertain_lives(alone.with_(NOMINAL_ALONE), samples=16)
    assert spread["life_quantile"].notnull().any()
    assert spread["life_quantile"].equals(over_duty["life_quantile"])


def test_values_of_a_case_vary_with_those_of_the_scene(scene):
    """Friction of a case is multiplied by the factor of the scene's own, here 1.5."""
    duty_scene = scene(
        "gyro_s1", HERTZ | POSITION | {"cases": CASES} | duty({"hot": {"hours": 1.0}})
    )
    nominal = duty_scene.friction.ball_race
    varied = scene_with_values(duty_scene, {"ball_race": 1.5 * nominal, "preload_N": 9.0})
    friction = {name: case.friction.ball_race for name, case in varied.in_cases.items()}
    assert friction["hot"] == pytest.approx(1.5 * 0.05)
    assert friction["idle"] == friction["nominal"] == pytest.approx(1.5 * nominal)
    assert {case.operation.preload_N for case in varied.in_cases.values()} == {9.0}
    assert scene_with_values(duty_scene, {"ball_race": nominal}) == duty_scene


def test_a_start_of_the_duty_is_the_ramp_of_a_warm_up(scene):
    """After 30 of its 60 s the shaft has half of its speed."""
    inputs = duty({"nominal": {"hours": 1.0, "starts": 1.0}}, start_s=60.0)
    duty_scene = scene("gyro_s1", HERTZ | POSITION | WARMING | inputs)
    warmed = bearingwear.warmup(duty_scene, duration=30.0)
    half = 0.5 * duty_scene.operation.shaft_speed_rpm
    assert float(warmed["shaft_speed"][-1]) == pytest.approx(half)


def test_torque_margin_is_of_bearings_worn_by_the_duty(scene):
    drive = {"drive": {"torque_Nm": 0.01}}
    duty_scene = scene(
        "gyro_s1", HERTZ | SLOW_WEAR | POSITION | drive | {"cases": CASES} | duty(RAMPED)
    )
    corners = torque_corners(duty_scene)
    assert {corner.case for corner in corners} == {"idle", "nominal"}
    alone = torque_corners(scene("gyro_s1", HERTZ | SLOW_WEAR | POSITION | drive))

    def worn_torque(corners):
        return next(c.torque for c in corners if (c.case, c.wear) == ("nominal", "worn"))

    # the idle phase ends the life before: less is worn, and more preload is left
    assert worn_torque(corners) > 1.05 * worn_torque(alone)
