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
OF_SEARCH = (code.WARM_SEIZURE, code.NO_HEAT_BALANCE)


def network(shaft: float, housing: float, ball: float) -> dict[str, float]:
    names = ("inner_ring_shaft", "outer_ring_housing", "ball_race")
    values = (shaft, housing, ball)
    return {f"thermal.conductance_W_K.{n}": v for n, v in zip(names, values, strict=True)}


MILD, POOR, SEIZES = network(0.01, 0.1, 0.01), network(1e-3, 0.1, 0.01), network(1e-4, 0.1, 3e-3)


def three(shaft=0.1, housing=0.2, ball=0.05, shaft_C=30.0, housing_C=30.0) -> Thermal:
    G = Conductance(inner_ring_shaft=shaft, outer_ring_housing=housing, ball_race=ball)
    return Thermal(conductance_W_K=G, shaft_C=shaft_C, housing_C=housing_C)


def test_network_by_hand():
    """Drag heat alone leaves by the housing and, through the balls, by the shaft."""
    t = network_temperatures(three(), HeatFlow(inner=0.0, outer=0.0, drag=2.0))
    through_balls = 1.0 / (2.0 / 0.05 + 1.0 / 0.1)
    assert_allclose(t.outer_ring_C, 30.0 + 2.0 / (0.2 + through_balls), rtol=1e-13)
    to_shaft = 2.0 * through_balls / (0.2 + through_balls)
    assert_allclose(t.inner_ring_C, 30.0 + to_shaft / 0.1, rtol=1e-13)
    assert_allclose(t.balls_C, 0.5 * (t.inner_ring_C + t.outer_ring_C), rtol=1e-13)


def test_no_heat_flows_from_shaft_to_housing():
    t = network_temperatures(three(shaft_C=50.0, housing_C=20.0), HeatFlow(0.0, 0.0, 0.0))
    flow = 30.0 / (1.0 / 0.1 + 2.0 / 0.05 + 1.0 / 0.2)
    assert_allclose(
        [t.inner_ring_C, t.outer_ring_C], [50.0 - flow / 0.1, 20.0 + flow / 0.2], rtol=1e-13
    )
    alike = network_temperatures(three(), HeatFlow(0.0, 0.0, 0.0))
    assert alike.inner_ring_C == alike.balls_C == alike.outer_ring_C == 30.0


def test_the_heat_flow_check_rejects_other_heats_and_networks():
    thermal, heat = three(), HeatFlow(inner=1.0, outer=2.0, drag=0.5)
    t = network_temperatures(thermal, heat)
    assert heat_flow_residual(thermal, t, heat) < 1e-14
    for other in (heat._replace(inner=1.001), heat._replace(drag=0.49)):
        assert heat_flow_residual(thermal, t, other) > 1e-4
    assert heat_flow_residual(three(ball=0.051), t, heat) > 1e-4


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize("changes", [MILD, POOR, {"lubricant.drag_density_kg_m3": 300.0} | POOR])
def test_heat_flows_balance(scene, fidelity, changes):
    """Part by part, from the file's values alone."""
    result = solve(scene("gyro_s1", HELD | changes), fidelity)
    v = result.values
    assert result.status == "ok" and v["heat_flow_residual"] < 1e-6
    inner_C, balls_C, outer_C, shaft_C, housing_C = v["part_temperature"]
    G = [changes[key] for key in network(0.0, 0.0, 0.0)]
    heat = 9.0 * v["friction_heat"].mean(axis=0)
    total = heat.sum() + v["drag_power"]
    out = G[0] * (inner_C - shaft_C) + G[1] * (outer_C - housing_C)
    assert_allclose(out, total, rtol=1e-6)
    assert_allclose(0.5 * heat.sum(), G[2] * (2.0 * balls_C - inner_C - outer_C), rtol=1e-6)
    assert_allclose(
        0.5 * heat[0], G[0] * (inner_C - shaft_C) + G[2] * (inner_C - balls_C), atol=1e-6 * total
    )


def test_computed_temperatures_given_as_input_change_nothing(scene):
    """The found temperatures, given, make the same bearing; its scene stays the user's."""
    result = solve(scene("gyro_s1", HELD | POOR))
    names = ("inner_ring", "balls", "outer_ring", "shaft", "housing")
    parts = zip(names, result.values["part_temperature"], strict=True)
    inputs = {f"temperature.{name}_C": float(t) for name, t in parts}
    again = solve(scene("gyro_s1", HELD | inputs)).values
    assert_allclose(again["residual_preload"], result.values["residual_preload"], rtol=1e-12)
    assert '"thermal"' in result.attrs["scene"] and '"temperature"' not in result.attrs["scene"]
    assert "temperature: computed" in result.attrs["modelled"]


def test_few_solves_do(scene):
    for name in ("constant_force", "fixed_position"):
        for changes in (MILD, network(0.1, 0.1, 0.05), network(1.0, 1.0, 0.1)):
            networked = scene("gyro_s1", changes | {"operation.preload_method": name})
            assert 2 <= warmed_steady(networked).solves <= 6


def warmed_steady(scene) -> Warmed:
    return Warm(Steady(scene))(Condition(0.0)).warmed


def followed_up(scene) -> tuple[str, np.ndarray]:
    """Heat from none upwards, each found at the temperatures of the last: the plain way."""
    h = np.zeros(3)
    for _ in range(300):
        warm = at_temperatures(scene, HeatFlow(*h))
        if warm is None:
            return "beyond", h
        result = Steady(warm)(Condition(0.0))
        if result.status != code.OK:
            return "beyond", h
        heat_flow = Steady(warm).heat(result)
        if np.abs(np.array(heat_flow) - h).max() < 1e-9 * heat_flow.total:
            return "balance", np.array(heat_flow)
        h = np.array(heat_flow)
    return "slow", h


def test_random_networks_against_the_plain_way(scene):
    """The least balance is found where there is one, and seizure said where there is none."""
    random = np.random.default_rng(3)
    ends = set()
    for _ in range(24):
        G = 10.0 ** random.uniform([-4.5, -3.0, -3.5], [-1.5, -1.0, -1.0])
        changes = HELD | network(*G) | {"friction.ball_race": float(random.choice([0.05, 0.1]))}
        networked = scene("gyro_s1", changes)
        result, (end, heat) = warmed_steady(networked), followed_up(networked)
        assert end != "slow"
        assert (result.status == code.OK) == (end == "balance")
        if end == "balance":
            assert_allclose(result.heat, heat, rtol=1e-5, atol=1e-9)
        else:
            assert result.status == code.WARM_SEIZURE
        ends.add(end)
    assert ends == {"balance", "beyond"}


def test_warm_seizure_is_named(scene, tmp_path, capsys):
    result = solve(scene("gyro_s1", HELD | SEIZES))
    assert result.status == "warm_seizure"
    assert "residual_preload" not in result.values and np.all(
        np.isfinite(result.values["part_temperature"])
    )
    argv = ["solve", str(scene_file("gyro_s1")), "-o", str(tmp_path / "case.nc")]
    argv += [f"--set={key}={value}" for key, value in (HELD | SEIZES).items()]
    assert main(argv) == 3
    printed = capsys.readouterr()
    assert printed.out.count("cage (phenolic)") == 1
    (line,) = printed.err.splitlines()
    assert "warm_seizure" in line


@pytest.mark.parametrize(
    ("noise", "heat_error", "status"),
    [(3e-7, 0.0, code.OK), (5e-4, 1e-4, code.OK), (5e-2, 1e-4, code.NO_HEAT_BALANCE)],
)
def test_a_heat_that_depends_on_where_the_solve_came_from(scene, noise, heat_error, status):
    """A solve that is balanced already stays where it is: its heat is a little that of before."""
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
def test_absurd_networks_have_a_status(scene, fidelity):
    short = {"model.simulated_turns": 1.0}
    for G in ((1e-6, 1e-6, 1e-6), (1e6, 1e6, 1e6), (1e-6, 1e6, 1e6), (1e6, 1e-6, 1e-6)):
        for method in ("constant_force", "fixed_position"):
            changes = network(*G) | short | {"operation.preload_method": method}
            without_cage = scene("gyro_s1", changes).without_cage
            status = solve(without_cage, fidelity).values["status"]
            assert status in (code.OK, code.UNVERIFIED, *OF_SEARCH), (G, method, status)


def test_no_friction_no_heat(scene):
    assert solve(scene("gyro_s1", MILD | {"friction.ball_race": 0.0})).status == "undetermined"
    values = solve(scene("gyro_s1", MILD | {"friction.ball_race": 0.0}), "race_control").values
    assert_allclose(values["part_temperature"], 20.0, rtol=1e-15)


def test_temperatures_follow_a_life(scene):
    fidelity = "steady"  # race control gives no life where the steady model does
    end = {"wear.end_of_life.gyroscopic_slip_share": None, "wear.end_of_life.skid_ratio": None}
    base = HELD | end
    cold = life(scene("gyro_s1", base), fidelity).values
    badly_cooled = scene("gyro_s1", base | POOR)
    result = life(badly_cooled, fidelity)
    v = result.values
    assert result.status == "ok" and v["heat_flow_residual"] < 1e-6
    t = v["history_part_temperature"]
    assert t.shape == (len(v["history_ball_diameter_loss"]), 5)
    assert (np.diff(t[:, 0]) < 0.0).all()  # the preload goes, and with it the heat
    assert v["life"] < cold["life"]
    k = len(t) // 2
    loss = 1e6 * v["history_ball_diameter_loss"][k]
    there = solve(badly_cooled.with_({"wear.ball_diameter_loss_um": float(loss)}), fidelity).values
    assert_allclose(there["part_temperature"], t[k], atol=1e-5)
    assert_allclose(there["residual_preload"], v["history_residual_preload"][k], rtol=1e-6)


def test_a_life_that_seizes_when_new(scene):
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


def test_a_life_in_time_is_warmed_at_each_step(scene):
    short = {"model.simulated_turns": 0.5, "wear.ball_diameter_loss_um": 0.1} | HELD
    steady = solve(scene("gyro_s1", short | POOR)).values["part_temperature"]
    wearings = [Motion(scene("gyro_s1", short | item).without_cage) for item in (POOR, SEIZES)]
    (warm,), (seized,) = (wearing.state(wearing.start) for wearing in wearings)
    assert warm.status == code.OK and seized.status == code.WARM_SEIZURE
    assert_allclose(warm["part_temperature"], steady, rtol=1e-6)
    assert seized.answer.residual.startswith("not converged")
