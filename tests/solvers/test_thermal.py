"""Temperatures found from friction heat: balance, least balance, seizure, every model."""

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import scene_file

from bearingwear.cli import main
from bearingwear.kernels import status as code
from bearingwear.lives.life import life
from bearingwear.lives.motion import Motion
from bearingwear.scene.warmth import Conductance, Thermal
from bearingwear.solvers.condition import Condition
from bearingwear.solvers.solve import solve
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.thermal import (
    HeatFlow,
    Warmed,
    at_temperatures,
    find_heat_balance,
    heat_flow_residual,
    network_temperatures,
)
from bearingwear.solvers.warm import Warm

HELD = {"operation.preload_method": "fixed_position"}
CONDUCTANCES = [
    f"thermal.conductance_W_K.{name}"
    for name in ("inner_ring_shaft", "outer_ring_housing", "ball_race")
]


def network(shaft: float, housing: float, ball: float) -> dict[str, float]:
    """Returns the conductances of a thermal network [W/K], by keys of a scene."""
    return dict(zip(CONDUCTANCES, (shaft, housing, ball), strict=True))


MILD, POOR, SEIZES = network(0.01, 0.1, 0.01), network(1e-3, 0.1, 0.01), network(1e-4, 0.1, 3e-3)


def thermal_network(ball=0.05, shaft_C=30.0, housing_C=30.0) -> Thermal:
    """Returns a network with 0.1 W/K to the shaft and 0.2 W/K to the housing.

    ball: conductance from each race to the balls [W/K].
    """
    G = Conductance(inner_ring_shaft=0.1, outer_ring_housing=0.2, ball_race=ball)
    return Thermal(conductance_W_K=G, shaft_C=shaft_C, housing_C=housing_C)


def test_drag_heat_leaves_by_the_housing_and_through_the_balls_by_the_shaft():
    """2 W of drag heat the outer ring, computed by hand as resistances in series and parallel."""
    t = network_temperatures(thermal_network(), HeatFlow(inner=0.0, outer=0.0, drag=2.0))
    through_balls = 1.0 / (2.0 / 0.05 + 1.0 / 0.1)
    assert_allclose(t.outer_ring_C, 30.0 + 2.0 / (0.2 + through_balls), rtol=1e-13)
    to_shaft = 2.0 * through_balls / (0.2 + through_balls)
    assert_allclose(t.inner_ring_C, 30.0 + to_shaft / 0.1, rtol=1e-13)
    assert_allclose(t.balls_C, 0.5 * (t.inner_ring_C + t.outer_ring_C), rtol=1e-13)


NO_HEAT = HeatFlow(0.0, 0.0, 0.0)


def test_without_friction_heat_flows_from_a_warm_shaft_to_a_cold_housing():
    t = network_temperatures(thermal_network(shaft_C=50.0, housing_C=20.0), NO_HEAT)
    flow = 30.0 / (1.0 / 0.1 + 2.0 / 0.05 + 1.0 / 0.2)  # the resistances in series [W]
    expected = [50.0 - flow / 0.1, 20.0 + flow / 0.2]
    assert_allclose([t.inner_ring_C, t.outer_ring_C], expected, rtol=1e-13)


def test_without_heat_all_parts_have_the_temperature_around_them():
    t = network_temperatures(thermal_network(), NO_HEAT)
    assert t.inner_ring_C == t.balls_C == t.outer_ring_C == 30.0


def test_the_heat_flow_check_rejects_other_heats_and_networks():
    thermal, heat = thermal_network(), HeatFlow(inner=1.0, outer=2.0, drag=0.5)
    t = network_temperatures(thermal, heat)
    assert heat_flow_residual(thermal, t, heat) < 1e-14
    for other in (heat._replace(inner=1.001), heat._replace(drag=0.49)):
        assert heat_flow_residual(thermal, t, other) > 1e-4
    assert heat_flow_residual(thermal_network(ball=0.051), t, heat) > 1e-4


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize("changes", [MILD, POOR, {"lubricant.drag_density_kg_m3": 300.0} | POOR])
def test_heat_flows_balance(scene, fidelity, changes):
    """The flows of each part are written out here with the stored temperatures and heats [W]."""
    result = solve(scene("gyro_s1", HELD | changes), fidelity)
    values = result.values
    assert result.status == "ok" and values["heat_flow_residual"] < 1e-6
    inner_C, balls_C, outer_C, shaft_C, housing_C = values["part_temperature"]
    to_shaft, to_housing, to_balls = (changes[key] for key in CONDUCTANCES)
    heat = 9.0 * values["friction_heat"].mean(axis=0)  # of inner and outer contacts
    total = heat.sum() + values["drag_power"]
    from_rings = to_shaft * (inner_C - shaft_C) + to_housing * (outer_C - housing_C)
    assert_allclose(from_rings, total, rtol=1e-6)
    from_balls = to_balls * (2.0 * balls_C - inner_C - outer_C)
    assert_allclose(0.5 * heat.sum(), from_balls, rtol=1e-6)  # half of the heat goes into them
    from_inner = to_shaft * (inner_C - shaft_C) + to_balls * (inner_C - balls_C)
    assert_allclose(0.5 * heat[0], from_inner, atol=1e-6 * total)


def test_computed_temperatures_given_as_input_change_nothing(scene):
    """The scene of the result stays the user's, with its network."""
    result = solve(scene("gyro_s1", HELD | POOR))
    names = ("inner_ring", "balls", "outer_ring", "shaft", "housing")
    parts = zip(names, result.values["part_temperature"], strict=True)
    inputs = {f"temperature.{name}_C": float(t) for name, t in parts}
    again = solve(scene("gyro_s1", HELD | inputs)).values
    assert_allclose(again["residual_preload"], result.values["residual_preload"], rtol=1e-12)
    assert '"thermal"' in result.attrs["scene"] and '"temperature"' not in result.attrs["scene"]
    assert "temperature: computed" in result.attrs["modelled"]


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
@pytest.mark.parametrize("conductances", [MILD, network(0.1, 0.1, 0.05), network(1.0, 1.0, 0.1)])
def test_usual_temperatures_take_six_solves_at_most(scene, method, conductances):
    networked = scene("gyro_s1", conductances | {"operation.preload_method": method})
    assert 2 <= warmed_steady(networked).solves <= 6


def warmed_steady(scene) -> Warmed:
    """Returns the heat balance of a scene by the steady model."""
    return Warm(Steady(scene))(Condition(0.0)).warmed


def least_balance(scene) -> np.ndarray | None:
    """Returns the heats [W] of the least heat balance; None where there is none.

    Each is solved at the temperatures of the last, from no heat upwards. That converges from below.
    """
    heat = np.zeros(3)
    for _ in range(300):
        warm = at_temperatures(scene, HeatFlow(*heat))
        if warm is None:
            return None
        result = Steady(warm)(Condition(0.0))
        if result.status != code.OK:
            return None
        flow = Steady(warm).heat(result)
        if np.abs(np.array(flow) - heat).max() < 1e-9 * flow.total:
            return np.array(flow)
        heat = np.array(flow)
    raise AssertionError("300 substitutions have not converged")


def test_random_networks_have_their_least_balance_or_seize(scene):
    """24 networks with conductances over two or three decades; some seize, and some do not.

    `least_balance` finds the heats by plain substitution, to 1e-5.
    """
    random = np.random.default_rng(3)
    seized = 0
    for _ in range(24):
        G = 10.0 ** random.uniform([-4.5, -3.0, -3.5], [-1.5, -1.0, -1.0])
        changes = HELD | network(*G) | {"friction.ball_race": float(random.choice([0.05, 0.1]))}
        networked = scene("gyro_s1", changes)
        result, expected = warmed_steady(networked), least_balance(networked)
        if expected is None:
            seized += 1
            assert result.status == code.WARM_SEIZURE, changes
        else:
            assert result.status == code.OK, changes
            assert_allclose(result.heat, expected, rtol=1e-5, atol=1e-9)
    assert 0 < seized < 24  # both were tried


def test_warm_seizure_is_named(scene, tmp_path, capsys):
    """The result has temperatures and no loads; the command ends with 3 and one line."""
    result = solve(scene("gyro_s1", HELD | SEIZES))
    assert result.status == "warm_seizure"
    assert "residual_preload" not in result.values
    assert np.all(np.isfinite(result.values["part_temperature"]))
    argv = ["solve", str(scene_file("gyro_s1")), "-o", str(tmp_path / "case.nc")]
    argv += [f"--set={key}={value}" for key, value in (HELD | SEIZES).items()]
    assert main(argv) == 3
    printed = capsys.readouterr()
    assert printed.out.count("cage (phenolic)") == 1
    (line,) = printed.err.splitlines()
    assert "warm_seizure" in line


@pytest.mark.parametrize(
    ("noise", "heat_error", "status"),
    [
        (3e-7, 0.0, code.OK),  # less than the balance of any solve
        (5e-4, 1e-4, code.OK),  # a few times the error that is stated
        (5e-2, 1e-4, code.NO_HEAT_BALANCE),
    ],
)
def test_a_noisy_heat_is_balanced_within_its_stated_error(scene, noise, heat_error, status):
    """The heat of a solve depends a little on the state from which it starts.

    Noise of a few times the stated error is balanced; with more, there is no heat balance.
    """
    signs = itertools.cycle((-1.0, 1.0))

    def heats(warm):
        rise = warm.temperature.inner_ring_C - 20.0
        return code.OK, HeatFlow(0.5 - 1e-3 * rise + noise * next(signs), 0.2, 0.0)

    warmed = find_heat_balance(scene("gyro_s1", MILD), heats, heat_error=heat_error)
    assert warmed.status == status
    if status == code.OK:
        rise = warmed.scene.temperature.inner_ring_C - 20.0
        assert_allclose(warmed.heat.inner, 0.5 - 1e-3 * rise, rtol=4.0 * noise)
        assert warmed.solves < 15


@pytest.mark.parametrize("fidelity", [None, "race_control", "dynamic"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
@pytest.mark.parametrize(
    "G", [(1e-6, 1e-6, 1e-6), (1e6, 1e6, 1e6), (1e-6, 1e6, 1e6), (1e6, 1e-6, 1e-6)]
)
def test_absurd_networks_have_a_status(scene, fidelity, method, G):
    """No solve raises an error; the model decides which of the four statuses it has."""
    changes = network(*G) | {"model.simulated_turns": 1.0, "operation.preload_method": method}
    result = solve(scene("gyro_s1", changes).without_cage, fidelity)
    assert result.status in ("ok", "unverified", "warm_seizure", "no_heat_balance")


def test_without_friction_nothing_is_warmer_than_its_surroundings(scene):
    """The steady rotation is undetermined, and race control has no heat."""
    frictionless = scene("gyro_s1", MILD | {"friction.ball_race": 0.0})
    assert solve(frictionless).status == "undetermined"
    values = solve(frictionless, "race_control").values
    assert_allclose(values["part_temperature"], 20.0, rtol=1e-15)


def test_temperatures_follow_a_life(scene):
    """The inner ring cools as the preload wears off; half way a solve has the same temperatures."""
    end = {"wear.end_of_life.gyroscopic_slip_share": None, "wear.end_of_life.skid_ratio": None}
    base = HELD | end
    cold = life(scene("gyro_s1", base)).values
    badly_cooled = scene("gyro_s1", base | POOR)
    result = life(badly_cooled)
    values = result.values
    assert result.status == "ok" and values["heat_flow_residual"] < 1e-6
    t = values["history_part_temperature"]
    assert t.shape == (len(values["history_ball_diameter_loss"]), 5)
    assert (np.diff(t[:, 0]) < 0.0).all()  # the preload goes, and with it the heat
    assert values["life"] < cold["life"]
    k = len(t) // 2
    loss = 1e6 * values["history_ball_diameter_loss"][k]
    case = solve(badly_cooled.with_({"wear.ball_diameter_loss_um": float(loss)})).values
    assert_allclose(case["part_temperature"], t[k], atol=1e-5)
    assert_allclose(case["residual_preload"], values["history_residual_preload"][k], rtol=1e-6)


def test_a_life_that_seizes_when_new_has_a_status(scene):
    assert life(scene("gyro_s1", HELD | SEIZES)).status == "warm_seizure"


def test_motion_in_time_takes_the_found_temperatures(scene):
    short = {"model.simulated_turns": 4.0} | HELD
    steady = solve(scene("gyro_s1", short | POOR)).values
    values = solve(scene("gyro_s1", short | POOR).without_cage, "dynamic").values
    assert_allclose(values["part_temperature"], steady["part_temperature"], rtol=1e-9)
    assert_allclose(values["residual_preload"], steady["residual_preload"], rtol=1e-4)
    radial = short | POOR | {"operation.radial_load_N": [0.0, 1.0]}
    loaded = solve(scene("gyro_s1", radial).without_cage).values
    assert_allclose(loaded["part_temperature"], steady["part_temperature"], rtol=1e-9)


def test_a_dynamic_life_is_warmed_at_each_step(scene):
    short = {"model.simulated_turns": 0.5, "wear.ball_diameter_loss_um": 0.1} | HELD
    steady = solve(scene("gyro_s1", short | POOR)).values["part_temperature"]
    wearings = [Motion(scene("gyro_s1", short | G).without_cage) for G in (POOR, SEIZES)]
    (warm,), (seized,) = (wearing.state(wearing.start) for wearing in wearings)
    assert warm.status == code.OK and seized.status == code.WARM_SEIZURE
    assert_allclose(warm["part_temperature"], steady, rtol=1e-6)
    assert seized.answer.residual.startswith("not converged")
