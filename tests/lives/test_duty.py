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
    return {"duty": {"phases": phases} | more}


MIXED = {"idle": {"hours": 1.0}, "nominal": {"hours": 6.5}, "fast": {"hours": 0.5}}


def even_life(scene, points=2, quick=False):
    """Life over a duty with Hertzian contacts, and its cycle."""
    cycle = cycle_of(scene, points)
    return hertzian_duty_life(cycle, [solver_of(item) for item in cycle.scenes], quick), cycle


def hours(found):
    assert found.status == code.OK, code.STATUS_NAMES[found.status]
    return found.last.time / HOUR


# mixtures that are known


class SteadyRate:
    """A solver whose bearing wears at one rate, whatever it has lost [m/s]."""

    solves = 0

    def __init__(self, rate):
        self.rate = rate

    def __call__(self, conditions):
        values = {"ball_diameter_loss": conditions[0].loss, "ball_diameter_loss_rate": self.rate}
        return (State(code.OK, values),)


def test_constant_rates_add_as_palmgren_and_miner_say(scene):
    """Cycles and shares of the documentation of the Python package `reliability`."""
    loss, lives, minutes = 0.7e-6, (50_000.0, 6500.0, 1000.0), (40.0, 15.0, 5.0)
    phases = {
        name: {"hours": value / 60.0, "case": name}
        for name, value in zip(("nominal", "idle", "fast"), minutes, strict=True)
    }
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.7}}
    duty_scene = scene("gyro_s1", HERTZ | end | {"cases": CASES} | duty(phases))
    cycle = cycle_of(duty_scene)
    rates = [loss / (live * HOUR) for live in lives]
    over_duty = hertzian_duty_life(cycle, [SteadyRate(rate) for rate in rates])
    assert hours(over_duty) == pytest.approx(7400.37951, abs=1e-5)  # a cycle is an hour
    shares = cycle.shares * rates * over_duty.last.time / loss
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
    other, _ = even_life(alone.with_(NOMINAL_ALONE))
    result = surface_life(alone, solver_of(alone))
    assert result.status == code.OK and len(result.nodes) > 2
    assert (other.last.time, other.criterion) == (result.last.time, result.criterion)


@pytest.mark.parametrize("changes", [{}, POSITION | NETWORK], ids=["spring", "heat"])
def test_one_phase_wears_its_grooves_as_the_scene_itself(scene, changes):
    alone = scene("gyro_s1", WORN | changes)
    groove_life = follow_grooves(StiffGrooves(alone))
    other = worn_duty_life(cycle_of(alone.with_(NOMINAL_ALONE)))
    assert groove_life.status == code.OK and len(groove_life.nodes) > 2
    assert (other.last.time, other.criterion) == (groove_life.last.time, groove_life.criterion)
    assert (other.last.worn[0].grooves == groove_life.last.worn[0].grooves).all()


@pytest.mark.parametrize("changes", [HERTZ, HERTZ | POSITION], ids=["spring", "position"])
def test_order_and_parts_of_phases_change_nothing(scene, changes):
    duty_scene = scene("gyro_s1", changes | {"cases": CASES} | duty(MIXED))
    result, _ = even_life(duty_scene)
    backwards = dict(reversed(MIXED.items()))
    apart = MIXED | {"nominal": {"hours": 2.5}, "later": {"hours": 4.0, "case": "nominal"}}
    doubled = {name: {"hours": 2.0 * value["hours"]} for name, value in MIXED.items()}
    other, _ = even_life(duty_scene.with_(duty(backwards)))
    assert other.last.time == result.last.time
    for phases in (apart, doubled):
        other, _ = even_life(duty_scene.with_(duty(phases)))
        assert other.last.time == pytest.approx(result.last.time, rel=1e-12)
        assert other.criterion == result.criterion
    cycles = result.last.time / duty_scene.duty.cycle_s
    halved = other.last.time / duty_scene.with_(duty(doubled)).duty.cycle_s
    assert halved == pytest.approx(0.5 * cycles, rel=1e-12)


@pytest.mark.parametrize("film", [HERTZ | FILM, WORN | FILM], ids=["even", "worn"])
def test_order_of_phases_changes_nothing_beyond_a_film(scene, film):
    """Beyond the wear-through, the last digit of a rate would change the seventh of the life."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.06}}
    cases = CASES | {"hot": {"friction.film.bare_ball_race": 0.3}}
    phases = {"fast": {"hours": 0.1}, "hot": {"hours": 0.7, "starts": 1.0}, "idle": {"hours": 0.3}}
    backwards = dict(reversed(phases.items()))
    apart = phases | {"hot": {"hours": 0.4, "starts": 1.0}, "later": {"hours": 0.3, "case": "hot"}}
    ramps = {"start_s": 20.0, "stop_s": 60.0}
    filmed = scene("gyro_s1", film | POSITION | end | {"cases": cases})
    results = [duty_life(filmed.with_(duty(mix, **ramps))) for mix in (phases, backwards, apart)]
    one, other, cut_in_two = (result.life for result in results)
    assert one.last.states[0]["film_left"].min() <= 0.0
    assert one.last.time == other.last.time > 0.0
    assert cut_in_two.last.time == pytest.approx(one.last.time, rel=1e-6)
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
    assert computed.last.time == pytest.approx(expected, rel=1e-3)


def temperatures(inner_ring_C, balls_C, outer_ring_C):
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
    """t = integral of dL over the mean rate; each start is the mean over histories at 20 speeds."""
    cases = {
        "crawl": {"operation.shaft_speed_rpm": 3000.0},
        "sprint": {"operation.shaft_speed_rpm": 42000.0},
        "cold": {"operation.shaft_speed_rpm": 6000.0} | temperatures(-20.8, -20.4, -20.0),
        "warm": temperatures(71.5, 71.0, 70.0),
    }
    end = {"wear.end_of_life": {"ball_diameter_loss_um": loss_um}}
    full = {"friction.slip_regularisation_m_s": 1e-4}
    mix = {"cases": cases} | duty(phases, start_s=60.0, stop_s=120.0)
    with_duty = scene("gyro_s1", HERTZ | changes | end | full | mix)
    parts = []
    for name, phase in phases.items():
        alone = with_duty.in_cases[name]
        parts.append((HOUR * phase["hours"], alone))
        speeds = (np.arange(20) + 0.5) / 20.0 if "starts" in phase else ()
        parts += [(phase["starts"] * 180.0 / 20.0, at_speed(alone, s)) for s in speeds]
    slopes = []
    for span, alone in parts:
        life_alone = surface_life(alone, solver_of(alone))
        time_of_loss = CubicSpline(
            [node.states[0].loss for node in life_alone.nodes], life_alone.times
        )
        slopes.append((span, time_of_loss.derivative()))
    T = sum(span for span, _ in parts)
    losses = np.linspace(0.0, loss_um * 1e-6, 2001)
    expected = np.trapezoid(T / sum(span / slope(losses) for span, slope in slopes), losses)
    found, _ = even_life(with_duty)
    assert found.last.time == pytest.approx(expected, rel=1e-3)


def test_any_phase_may_end_the_life(scene):
    """The preload at fixed position is least at rest: the slow phase ends the life of all."""
    duty_scene = scene("gyro_s1", HERTZ | POSITION | {"cases": CASES} | duty(MIXED))
    result, cycle = even_life(duty_scene)
    assert CRITERIA[result.criterion] == "preload_fraction"
    assert cycle.cases[DutyLife(cycle, result).ending_case_index] == "idle"
    margins = DutyCriteria(cycle).margins_by_case(result.last.states)
    left = {name: value[result.criterion] for name, value in zip(cycle.cases, margins, strict=True)}
    assert left["idle"] == pytest.approx(0.0, abs=1e-6)
    assert min(left["nominal"], left["fast"]) > 0.01


# starts and stops


def test_points_of_a_ramp_integrate_the_rates_of_a_bearing():
    """Speed times a polynomial of its square: that of 2 n points to the degree 2 (n - 1)."""
    for n in (2, 3, 4):
        speeds, weights = ramp_points(n)
        assert speeds[0] == 1.0
        for k in range(2 * n - 1):
            assert weights @ speeds ** (2 * k + 1) == pytest.approx(1.0 / (2 * k + 2), rel=1e-13)


@pytest.mark.parametrize("method", [{}, POSITION], ids=["spring", "position"])
def test_a_start_to_a_low_speed_wears_half_of_its_time_at_that_speed(scene, method):
    slow = {"slow": {"operation.shaft_speed_rpm": 600.0}}
    starts = duty({"slow": {"starts": 3.0}}, start_s=20.0, stop_s=60.0)
    duty_scene = scene("gyro_s1", HERTZ | method | {"cases": slow} | starts)
    result, _ = even_life(duty_scene)
    alone = duty_scene.in_cases["slow"]
    at_speed_alone = hours(surface_life(alone, solver_of(alone)))
    assert 0.5 * hours(result) == pytest.approx(at_speed_alone, rel=1e-3)


@pytest.mark.parametrize("method", [{}, POSITION], ids=["spring", "position"])
def test_two_points_of_a_ramp_are_enough(scene, method):
    """The wear of a start to full speed by two points, and by a fine sum over its speeds."""
    full = {"friction.slip_regularisation_m_s": 1e-4}
    starts = duty({"nominal": {"starts": 1.0}}, start_s=20.0, stop_s=60.0)
    duty_scene = scene("gyro_s1", HERTZ | method | full | starts)

    def rate(one):
        states = solver_of(one)
        return states(states.bearings.start)[0].rate

    speeds = (np.arange(40) + 0.5) / 40.0
    expected = np.mean([rate(at_speed(duty_scene.in_cases["nominal"], s)) for s in speeds])
    cycle = cycle_of(duty_scene)
    mean = cycle.shares @ [rate(item) for item in cycle.scenes]
    assert mean == pytest.approx(expected, rel=2e-3)


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
    """Rates at all instants of a warm-up, each solved with its temperatures given, summed."""
    loss = {"wear.end_of_life": {"ball_diameter_loss_um": 0.001}}  # at which rates are as new
    full = {"friction.slip_regularisation_m_s": 1e-4}
    starts = duty(
        {"nominal": {"hours": hours_on, "starts": 1.0}}, start_s=60.0, stop_s=0.0, warmup=True
    )
    duty_scene = scene("gyro_s1", HERTZ | POSITION | WARMING | loss | full | starts)
    alone = duty_scene.in_cases["nominal"]
    warmed = bearingwear.warmup(alone, seconds=60.0)
    times, speeds = warmed["time"].values, warmed["shaft_speed"].values
    housing = 35.0 - 15.0 * np.exp(-times / 300.0)
    rates = []
    for speed, (parts,), beside in zip(
        speeds, warmed["part_temperature"].values, housing, strict=True
    ):
        T = dict(zip(("inner_ring_C", "balls_C", "outer_ring_C"), parts.tolist(), strict=True))
        inputs = {"temperature": T | {"shaft_C": 20.0, "housing_C": float(beside)}, "thermal": None}
        if speed:
            instant = at_speed(alone.with_(inputs), speed / speeds[-1])
            rates.append(float(bearingwear.solve(instant)["ball_diameter_loss_rate"]))
        else:
            rates.append(0.0)
    cycle_s = 60.0 + hours_on * HOUR
    until = np.linspace(0.0, cycle_s, 20_001)
    mean = np.trapezoid(np.interp(until, times, rates), until) / cycle_s
    with pytest.warns(UserWarning, match="the life has only .* cycles of the duty"):
        result = bearingwear.life(duty_scene)
    assert float(result["life"]) == pytest.approx(1e-9 / mean / HOUR, rel=2e-3)
    assert float(result["ramp_error_estimate"]) < 1e-3
    with pytest.warns(UserWarning, match="the life has only .* cycles of the duty"):
        cold = bearingwear.life(duty_scene.with_({"duty.warmup": False}))
    assert abs(float(result["life"]) / float(cold["life"]) - 1.0) > 0.01


def test_starts_that_warm_up_are_checked(scene):
    starts = duty({"nominal": {"hours": 1.0, "starts": 1.0}}, start_s=60.0, warmup=True)
    with pytest.raises(ValueError, match="duty.warmup: got true, expected a thermal network"):
        life(scene("gyro_s1", HERTZ | POSITION | NETWORK | starts))
    lost = WARMING | {"thermal.conductance_W_K.inner_ring_shaft": 1e-4}
    lost |= {"thermal.conductance_W_K.ball_race": 1e-4, "friction.ball_race": 0.3}
    with pytest.raises(NotAvailable, match="got a start without a steady state"):
        life(scene("gyro_s1", HERTZ | POSITION | lost | starts))


# phases one after the other, with the wear carried on

CYCLES = 200


def cycles_run(ways, start, phases, cycle_s, passed):
    """Run phases one after the other; time and wear, up to where `passed` says that it ends.

    ways: to wear in each phase; phases: time of each in a cycle [s].
    """
    worn, time = start, 0.0
    for _ in range(3 * CYCLES):
        for phase, span in zip(ways, phases, strict=True):
            half = phase.after(worn, 0.5 * span, worn)
            worn, time = phase.after(worn, span, half), time + span
            if passed(phase, worn):
                return time, worn
    raise AssertionError("no phase has ended the life")


class Even:
    """Phase whose wear is its loss alone, each time solved as a scene that has lost as much."""

    def __init__(self, scene):
        self.scene = scene

    def state(self, worn):
        scene = self.scene.with_({"wear.ball_diameter_loss_um": worn * 1e6})
        states = solver_of(scene)
        (state,) = states(states.bearings.start)
        assert state.status == code.OK
        return state

    def after(self, worn, span, at):
        return worn + span * self.state(at).rate


def test_phases_run_one_after_the_other_wear_as_their_mean(scene):
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    duty_scene = scene("gyro_s1", HERTZ | POSITION | end | {"cases": CASES} | duty(MIXED))
    result, _ = even_life(duty_scene)
    spans = np.array([phase["hours"] for phase in MIXED.values()])
    spans *= result.last.time / CYCLES / spans.sum()
    ways = [Even(duty_scene.in_cases[name]) for name in MIXED]
    time, _ = cycles_run(ways, 0.0, spans, spans.sum(), lambda _, worn: worn >= 0.15e-6)
    assert result.last.time == pytest.approx(time, rel=5e-3)


class OneWay:
    """A phase by its own solver, whose wear is that of a way to wear."""

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
    """Loss and films carried from phase to phase, beyond the time at which a film is gone."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    cases = {name: case for name, case in CASES.items() if name != "hot"}
    duty_scene = scene("gyro_s1", HERTZ | FILM | POSITION | end | {"cases": cases} | duty(MIXED))
    result, cycle = even_life(duty_scene)
    spans = np.array([MIXED[name]["hours"] for name in cycle.cases])
    spans *= result.last.time / CYCLES / spans.sum()
    mixed = DutySurfaces(cycle, [solver_of(item) for item in cycle.scenes])
    ways = [OneWay(way, lambda worn, span, rate: worn + span * rate) for way in mixed.ways]
    gone = []

    def passed(one, worn):
        node = SimpleNamespace(states=one.states(worn), worn=worn)
        for event in np.flatnonzero(one.way.events(node)[1:] <= 0.0):
            gone.append(event)
            assert one.way.pass_event(1 + int(event), node)
        return worn[0] + worn[1] + worn[2] >= 0.15e-6

    time, worn = cycles_run(ways, mixed.start, spans, spans.sum(), passed)
    assert gone  # or the test says nothing of films
    assert result.last.time == pytest.approx(time, rel=5e-3)
    assert_allclose(result.last.worn, worn, rtol=1e-2)


@pytest.mark.parametrize(
    "film",
    [{}, pytest.param(FILM | {"friction.film.thickness_um": 0.07}, marks=pytest.mark.long)],
    ids=["bare", "film"],
)
def test_grooves_wear_in_all_phases_at_once(scene, film):
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
    cases = {name: case for name, case in CASES.items() if name != "hot"}
    duty_scene = scene("gyro_s1", WORN | POSITION | film | end | {"cases": cases} | duty(MIXED))
    cycle = cycle_of(duty_scene)
    mixed_life = worn_duty_life(cycle)
    left = mixed_life.last.states[0].values.get("film_left", np.zeros(3))
    assert (left.min() < 0.0) == bool(film)
    spans = np.array([MIXED[name]["hours"] for name in cycle.cases])
    spans *= mixed_life.last.time / CYCLES / spans.sum()
    mixed = DutyGrooves(cycle)

    def plus(worn, span, rates):
        return tuple(w.plus(span, rate) for w, rate in zip(worn, rates, strict=True))

    def passed(way, worn):
        margins = DutyCriteria(cycle).criteria[0].margins(way.states(worn))
        return margins.min() <= 0.0

    ways = [OneWay(way, plus) for way in mixed.ways]
    for way in ways:
        way.states(mixed.start)  # equivalent losses count from there
    time, worn = cycles_run(ways, mixed.start, spans, spans.sum(), passed)
    assert mixed_life.last.time == pytest.approx(time, rel=5e-3)
    deepest = worn[0].grooves.max(axis=1)
    assert_allclose(mixed_life.last.worn[0].grooves.max(axis=1), deepest, rtol=1e-2)


@pytest.mark.parametrize("thickness", [0.02, 0.07])
def test_a_film_that_wears_through_a_groove_takes_no_shorter_steps(scene, thickness):
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
    assert first == pytest.approx(second, rel=1e-6)
    one_way, _ = even_life(duty_scene)
    first, second = one_way.last.worn
    assert first != pytest.approx(second, rel=1e-2)


# results

RAMPED = {"idle": {"hours": 1.0, "starts": 1.0}, "nominal": {"hours": 6.5}}
RAMPS = {"start_s": 20.0, "stop_s": 60.0}
SLOW_WEAR = {
    "materials.bearing_steel.wear_coefficient": 1e-9,
    "friction.slip_regularisation_m_s": 1e-5,
}


@pytest.fixture(scope="module")
def lived(scene):
    """Function (changes, phases) -> result of the life of gyro_s1 over a duty."""

    def life_of(changes, phases=None, **more):
        asked = duty(phases or RAMPED, **(RAMPS | more))
        return life(scene("gyro_s1", SLOW_WEAR | changes | {"cases": CASES} | asked))

    return life_of


@pytest.mark.parametrize("contact", [HERTZ, WORN], ids=["even", "worn"])
@pytest.mark.parametrize("kind", [POSITION, RIGID | {"arrangement.external_axial_N": 1.0}])
def test_shares_of_wear_and_time_are_whole(lived, contact, kind):
    result = lived(contact | kind)
    values = result.values
    assert result.status == "ok" and values["phase_time_share"].sum() == pytest.approx(1.0)
    shares, of_starts = values["phase_wear_share"], values["start_wear_share"]
    assert_allclose(shares.sum(axis=-2), 1.0, rtol=1e-12)
    assert (0.0 <= of_starts).all() and (of_starts < shares).all() and of_starts.any()
    worn = values["history_phase_worn_share"]
    assert_allclose(worn[..., -1, :], shares[..., -1], rtol=1e-12)
    assert (np.diff(worn, axis=-2) >= 0.0).all()
    assert values["life_cycles"] == pytest.approx(values["life"] / (7.5 * HOUR + 80.0))
    assert result.attrs["ended_in"] == "phase idle" and values["ending_phase"] == 0
    worst = values["worst_residual_preload"]
    assert worst[0] < worst[1]
    assert_allclose(values["history_phase_residual_preload"][-1], worst, rtol=1e-9)
    assert values["life_error_estimate"] < 0.02


def test_the_error_of_palmgren_miner_is_that_of_interacting_phases(lived):
    """Phases that end at the loss alone, with rates that hardly change, are as Miner has them; a
    phase that ends the life of all by the preload that others took away is not."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.02}}
    alike = lived(HERTZ | end, MIXED, start_s=0.0, stop_s=0.0).values
    assert alike["palmgren_miner_error"] == pytest.approx(0.0, abs=1e-3)
    other = lived(HERTZ | POSITION, MIXED, start_s=0.0, stop_s=0.0).values
    share, lives = other["phase_time_share"], other["phase_life"]
    assert other["palmgren_miner_life"] == pytest.approx(1.0 / (share / lives).sum())
    assert other["palmgren_miner_error"] > 0.5


def test_all_phases_end_an_even_loss(lived):
    result = lived(HERTZ | {"wear.end_of_life": {"ball_diameter_loss_um": 0.02}})
    assert result.attrs["ended_in"] == "all phases"


@pytest.mark.parametrize("contact", [HERTZ, WORN], ids=["even", "worn"])
def test_a_phase_that_is_not_solved_is_named(scene, contact):
    phases = {"nominal": {"hours": 1.0}, "still": {"hours": 1.0, "case": "bare"}}
    cases = {"cases": {"bare": {"friction.ball_race": 0.0}}}
    result = life(scene("gyro_s1", contact | cases | duty(phases)))
    assert result.status == "undetermined" and result.attrs["unsolved_phase"] == "still"
    assert "still" in result.reason


def test_a_duty_takes_phases_of_one_steady_model(scene, tmp_path, capsys):
    loaded = {"cases": {"idle": {"operation.radial_load_N": (1.0, 0.0)}}}
    duty_scene = scene("gyro_s1", PLAIN | loaded | duty({"idle": {"hours": 1.0}}))
    problem = "duty: got the case idle, which requires the dynamic"
    with pytest.raises(NotAvailable, match=problem):
        life(duty_scene)
    bearingwear.save(duty_scene, tmp_path / "gyro.yaml")
    for command in (["check"], ["recommend", "--stiffness", "1"]):
        assert main([command[0], str(tmp_path / "gyro.yaml"), *command[1:]]) == 2
        assert problem in only_line(capsys)


def test_warnings_of_a_duty(lived):
    def ids(result):
        return {item["id"] for item in json.loads(result.attrs["warnings"])}

    calm = lived(HERTZ)
    assert not ids(calm) & {"duty_acceleration", "duty_cycle"}
    assert calm.values["acceleration_friction_share"].max() < 1e-3
    assert "duty_acceleration" in ids(lived(HERTZ, start_s=1e-3))
    rare = {name: {"hours": 200.0 * phase["hours"]} for name, phase in RAMPED.items()}
    assert "duty_cycle" in ids(lived(HERTZ, rare))


def test_acceleration_of_balls_by_hand(lived):
    """A ball of 2 mm that rolls as kinematics say, its orbit and its spin, over mu (Q_i + Q_o)."""
    values = lived(HERTZ | {"wear.end_of_life": {"ball_diameter_loss_um": 0.01}}).values
    D, dm, alpha, omega = 2e-3, 7.5e-3, np.radians(20.0), 6000.0 * np.pi / 30.0
    m = 7800.0 * np.pi / 6.0 * D**3
    orbit = 0.5 * omega * (1.0 - D / dm * np.cos(alpha))
    spin = 0.5 * omega * dm / D * (1.0 - (D / dm * np.cos(alpha)) ** 2)
    force = (0.1 * m * D**2 * np.hypot(spin, orbit) / (0.5 * D) + m * 0.5 * dm * orbit) / 20.0
    friction = 0.08 * 2.0 * 7.0 / (9 * np.sin(alpha))
    result = values["acceleration_friction_share"][0]
    assert result == pytest.approx(force / friction, rel=0.1)


def test_many_lives_follow_the_duty(scene):
    """Quick lives, lives by their end, and by case, have the time of the exact one."""
    for contact, rtol in ((HERTZ, 1e-3), (WORN, 2e-2)):
        duty_scene = scene(
            "gyro_s1", contact | SLOW_WEAR | POSITION | {"cases": CASES} | duty(MIXED)
        )
        exact = life(duty_scene).values["life"]
        quick = worn_life(duty_scene) or HertzianLives(duty_scene, quick=True)(duty_scene)
        assert quick.last.time == pytest.approx(exact, rel=rtol)
        by_case = lives_by_case(duty_scene, quick=True)
        assert {*by_case} == {"idle", "nominal", "fast"}
        assert {item.last.time for item in by_case.values()} == {by_case["idle"].last.time}
        assert by_case["idle"].last.time == pytest.approx(exact, rel=rtol)
        left = {name: value.last.states[0]["residual_preload"] for name, value in by_case.items()}
        assert left["idle"] < left["nominal"] < left["fast"]
        end = duty_scene.wear.end_of_life
        looser = replace(end, preload_fraction=0.35)
        assert lives_by_end(duty_scene, looser)(end) == pytest.approx(exact, rel=rtol)


def test_the_sheet_and_the_figure_name_the_phases(scene, tmp_path, capsys):
    path = tmp_path / "gyro.yaml"
    duty_scene = scene("gyro_s1", SLOW_WEAR | HERTZ | {"cases": CASES} | duty(RAMPED, **RAMPS))
    bearingwear.save(duty_scene, path)
    assert main(["check", str(path)]) == 0
    phases = [line for line in capsys.readouterr().out.splitlines() if "idle: " in line]
    assert numbers_in(phases[0]) == [6000.0, 13.6, 1.0]  # r/min, % of the time, starts a cycle
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
    lived, stored, figure = duty_report(path)
    (tmp_path / "duty.json").write_text(stored)
    answer = load_document(tmp_path / "duty.json")
    assert answer.facts["scene"] == ramped.name and "in phase idle" in answer.title
    assert {"phases of the duty", "each phase alone, without starts"} <= {
        block.title for block in answer.blocks_in("open")
    }
    assert "phase idle meets its criterion" in str(answer.blocks_in("lead"))
    rows = {row.name: row for block in answer.blocks_in("open") for row in block.rows}
    percent = 100.0 * float(lived["palmgren_miner_error"])
    assert numbers_in(rows["palmgren_miner_life"].note) == [float(f"{percent:.2g}")]
    assert "more" in rows["palmgren_miner_life"].note and "palmgren_miner_error" not in rows
    assert float(lived["life_cycles"]) > 0.0 and len(figure.axes) == 2
    bare = {"cases": {"bare": {"friction.ball_race": 0.0}}}
    phases = duty({"still": {"hours": 1.0, "case": "bare"}})
    bearingwear.save(scene("gyro_s1", HERTZ | bare | phases), path)
    _, stored, _ = duty_report(path)
    assert "no life over the duty: in phase still" in stored


def test_the_page_has_the_duty_at_the_recommended_preload(scene, tmp_path):
    """That of the longest life where no life is long enough; the input preload where none is."""
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
    other = bearingwear.life(
        duty_scene.with_(duty({"fast": {"hours": 1.0}, "nominal": {"hours": 1.0}}))
    )
    assert other["phase"].values.tolist() == ["fast", "nominal"]
    swept = bearingwear.sweep(duty_scene, {"operation.preload_N": [7.0, 8.0]}, what="life")
    assert swept["phase"].values.tolist() == ["idle", "nominal"]


def test_a_pair_with_a_duty_is_checked_and_solved(scene, tmp_path, capsys):
    path = tmp_path / "pair.yaml"
    bearingwear.save(scene("gyro_s1", HERTZ | RIGID | {"cases": CASES} | duty(RAMPED)), path)
    for command in ("check", "solve"):
        assert main([command, str(path)]) == 0


def test_requirements_hold_in_every_phase_along_one_life(scene):
    """Extremes are the worst of the phases, not of cases that the duty does not name."""
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
    """So a spread over one phase has the quantiles of the scene itself."""
    alone = scene("gyro_s1", HERTZ | POSITION)
    with_duty = alone.with_(NOMINAL_ALONE)
    lives = [HertzianLives(item, quick=True)(item).last.time for item in (alone, with_duty)]
    assert lives[0] == lives[1]
    alone, with_duty = (one.with_({"model.contact": "worn"}) for one in (alone, with_duty))
    lives = [worn_life(one).last.time for one in (alone, with_duty)]
    assert lives[0] == lives[1]


def test_a_spread_over_one_phase_is_that_of_the_scene(scene):
    alone = scene("gyro_s1", POSITION | {"model.contact": "hertz", "cage": None})
    spreads = [uncertain_lives(one, samples=16) for one in (alone, alone.with_(NOMINAL_ALONE))]
    assert spreads[0]["life_quantile"].notnull().any()
    assert spreads[0]["life_quantile"].equals(spreads[1]["life_quantile"])


def test_values_of_a_case_vary_with_those_of_the_scene(scene):
    duty_scene = scene(
        "gyro_s1", HERTZ | POSITION | {"cases": CASES} | duty({"hot": {"hours": 1.0}})
    )
    nominal = duty_scene.friction.ball_race
    other = scene_with_values(duty_scene, {"ball_race": 1.5 * nominal, "preload_N": 9.0})
    friction = {name: value.friction.ball_race for name, value in other.in_cases.items()}
    assert friction["hot"] == pytest.approx(1.5 * 0.05)
    assert friction["idle"] == friction["nominal"] == pytest.approx(1.5 * nominal)
    assert {case.operation.preload_N for case in other.in_cases.values()} == {9.0}
    assert scene_with_values(duty_scene, {"ball_race": nominal}) == duty_scene


def test_a_start_of_the_duty_is_the_ramp_of_a_warm_up(scene):
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

    def worn(of_case):
        return next(c.torque for c in of_case if c.case == "nominal" and c.wear == "worn")

    assert worn(corners) > 1.05 * worn(alone)  # the idle phase ends the life before
