"""Bearings in tandem: they are alike, and each bears its share of its side's axial force."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from support import numbers_in

from bearingwear.document.bearing_line import operation_lines
from bearingwear.lives.life import life
from bearingwear.scene.arrangement import set_preload_ratio
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.at_rest import Mechanics
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.solve import solve

POSITION = {"operation.preload_method": "fixed_position"}
RIGID = {**POSITION, "arrangement.kind": "rigid_pair"}
SPRING = {"arrangement.kind": "spring_pair"}
REST = {"operation.shaft_speed_rpm": 0.0}
TWO_AND_TWO = {"arrangement.tandem": [2, 2], "operation.preload_N": 14.0}


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize(("single", "pair"), [(POSITION, RIGID), ({}, SPRING)])
def test_two_and_two_are_the_single_bearing_at_half_the_preload(scene, fidelity, single, pair):
    of_single = solve(scene("gyro_s1", single), fidelity).values
    of_four = solve(scene("gyro_s1", pair | TWO_AND_TWO), fidelity).values
    for name in ("residual_preload", "contact_load", "total_qv", "ball_diameter_loss_rate"):
        for value in of_four[name]:  # of one bearing of each side
            assert_allclose(value, of_single[name], rtol=1e-9, err_msg=name)
    bearings = 4.0 if pair is RIGID else 2.0  # of which a spring holds two
    stiffness = bearings * of_single["axial_stiffness"]
    assert_allclose(of_four["system_axial_stiffness"], stiffness, rtol=1e-9)


def test_two_and_two_in_tandem_live_as_the_single_bearing(scene):
    alone = life(scene("gyro_s1", POSITION))
    four = life(scene("gyro_s1", RIGID | TWO_AND_TWO))
    assert alone.status == four.status == "ok"
    assert_allclose(four.values["life"], alone.values["life"], rtol=1e-6)
    assert alone.attrs["ended_by"] == four.attrs["ended_by"] and "40 %" in alone.attrs["ended_by"]


@pytest.mark.parametrize("F_ext", [0.0, 4.0, -3.0])
def test_two_against_one_take_the_place_of_a_plain_balance(scene, F_ext):
    """SciPy's brentq balances them at rest, with twice the balls on the first side."""
    two_against_one = scene("gyro_s1", RIGID | REST | {
        "arrangement.tandem": [2, 1], "arrangement.external_axial_N": F_ext,
    })  # fmt: skip
    values = solve(two_against_one).values
    one_bearing = scene("gyro_s1", REST)
    g = parameters.geometry(one_bearing)
    places = [
        parameters.static_place(one_bearing.with_({"operation.preload_N": F})) for F in (3.5, 7.0)
    ]
    twice, single = Mechanics(g._replace(n_balls=2 * g.n_balls), g.D0), Mechanics(g, g.D0)

    def unbalanced(x):
        return twice.force(places[0] + x) - single.force(places[1] - x) - F_ext

    x = brentq(unbalanced, -1.5e-6, 1.5e-6, xtol=1e-18)
    assert_allclose(values["rotor_axial_shift"], x, rtol=1e-7, atol=1e-16)
    forces = twice.force(places[0] + x), single.force(places[1] - x)
    assert_allclose(values["residual_preload"], [forces[0] / 2.0, forces[1]], rtol=1e-9)
    stiffness = 2.0 * values["axial_stiffness"][0] + values["axial_stiffness"][1]
    assert_allclose(values["system_axial_stiffness"], stiffness, rtol=1e-12)


def test_a_required_preload_fraction_refers_to_the_share_of_each_bearing(scene):
    """Each of three bearings has a third of 7 N, the fourth 7 N; half of either ends the life."""
    changes = {"arrangement.tandem": [3, 1], "wear.end_of_life": {"preload_fraction": 0.5}}
    result = life(scene("gyro_s1", RIGID | changes))
    F = np.asarray(result.values["history_residual_preload"])[:, -1]
    assert_allclose((F / [7.0 / 3.0, 7.0]).min(), 0.5, rtol=1e-6)
    assert "residual preload 50 %" in result.attrs["ended_by"]


@pytest.mark.parametrize(
    ("tandem", "printed"),
    [((1, 1), 1.0), ((2, 1), 1.36), ((3, 1), 1.57), ((2, 2), 2.0), ((3, 2), 2.42)],
)
def test_a_set_of_bearings_matched_as_a_pair_has_the_printed_preload(scene, tandem, printed):
    """Catalogues print its ratio to the preload of the pair with two decimals.

    Exact static displacements, with the same offset at the faces, give it to 0.5 %.
    """
    one_bearing, pair_preload = scene("gyro_s1", REST), 7.0

    def place(F):
        return parameters.static_place(one_bearing.with_({"operation.preload_N": F}))

    def offset(F):
        return sum(place(F / n) for n in tandem) - 2.0 * place(pair_preload)

    force = brentq(offset, 0.5 * pair_preload, 4.0 * pair_preload)
    assert_allclose(set_preload_ratio(tandem), force / pair_preload, rtol=5e-3)
    assert_allclose(set_preload_ratio(tandem), printed, atol=6e-3)


def test_a_set_states_the_preload_of_each_side_of_its_pair_and_of_the_set(scene):
    """100 N on each side, from bearings matched for a pair of 73.6 N, are a set of 136 N."""
    rigid = scene("gyro_s1", RIGID | {"arrangement.tandem": [2, 1], "operation.preload_N": 100.0})
    (line,) = (line for line in choice(rigid).reasons if line.startswith("tandem: "))
    assert {100.0, 73.6, 136.0} <= {*numbers_in(line)}
    sheet = " ".join(operation_lines(rigid.to_dict()))
    assert {100.0, 73.6} <= {*numbers_in(sheet)}
    spring = scene("gyro_s1", SPRING | {"arrangement.tandem": [2, 1]})
    assert "matched" not in " ".join((*choice(spring).reasons, *operation_lines(spring.to_dict())))
