"""Two bearings on a rotor: published numbers, limits, and an independent balance of the rotor."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.scene.arrangement import Arrangement
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.sides import SHARED, values_of_bearing
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.arrangement import (
    natural_frequencies,
    rotor_balance,
    rotor_stiffness,
)
from bearingwear.solvers.bearing.at_rest import AxialRotor, Mechanics
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.condition import Accuracy
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.solve import solve

POSITION = {"operation.preload_method": "fixed_position"}
RIGID = {**POSITION, "arrangement.kind": "rigid_pair"}
SPRING = {"arrangement.kind": "spring_pair"}
REST = {"operation.shaft_speed_rpm": 0.0}
LOSS = "wear.ball_diameter_loss_um"


@pytest.fixture(scope="module")
def solved(scene):
    """Returns a function that solves gyro_s1, checks its status, and returns its values."""

    def values(changes, fidelity=None, status="ok"):
        result = solve(scene("gyro_s1", changes), fidelity)
        assert result.status == status
        return result.values

    return values


# numbers of a program written apart from this one: static, gyro_s1, 7 N


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize(
    ("F", "stiffness", "shift", "other"),
    [
        (0.0, 9.72282, 0.0, 7.0),
        (3.5, 9.6988, 0.3603, 5.330),
        (7.0, 9.6232, 0.7224, 3.824),
        (14.0, 9.2455, 1.4619, 1.354),
    ],
)
def test_a_rigid_pair_under_an_external_force_agrees_with_another_program(
    solved, fidelity, F, stiffness, shift, other
):
    """Force [N], stiffness [N/um], shift [um] and load of the other bearing [N], to its digits.

    Its stiffness is the slope of the force; here the Hertz factors are held: 1e-5.
    """
    values = solved(RIGID | REST | {"arrangement.external_axial_N": F}, fidelity)
    assert_allclose(values["system_axial_stiffness"] * 1e-6, stiffness, atol=6e-5, rtol=2e-5)
    assert_allclose(values["rotor_axial_shift"] * 1e6, shift, atol=6e-5)
    assert_allclose(values["residual_preload"], [other + F, other], atol=6e-4)
    assert_allclose(values["lift_off_force"], 20.5774, atol=6e-5)  # [N], whatever the force
    assert values["rotor_balance_residual"] < 1e-11


@pytest.mark.parametrize(
    ("losses", "shift", "preload"),
    [((0.1, 0.0), 0.14113, 6.3263), ((0.5, 0.0), 0.70812, 3.8803), ((0.25, 0.25), 0.0, 3.8706)],
)
def test_a_pair_of_unequal_wear_agrees_with_another_program(solved, losses, shift, preload):
    """Losses and shift [um], preload [N]; to its digits."""
    values = solved(RIGID | REST | {LOSS: losses[0], "arrangement.second": {LOSS: losses[1]}})
    assert_allclose(values["rotor_axial_shift"] * 1e6, shift, atol=6e-6)
    assert_allclose(values["residual_preload"], preload, atol=6e-5)


def test_slope_of_the_force_and_displacement_agree_with_another_program(scene):
    """4.86141 N/um and 2.21610 um of one bearing under 7 N, to its digits."""
    gyro = scene("gyro_s1")
    g, place, h = parameters.geometry(gyro), parameters.static_place(gyro), 1e-10
    at_rest = Mechanics(g, g.D0)
    slope = (at_rest.force(place + h) - at_rest.force(place - h)) / (2.0 * h)
    assert_allclose([slope * 1e-6, place * 1e6], [4.86141, 2.21610], atol=6e-6)


# what a pair must be the same as


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize(("single", "pair"), [(POSITION, RIGID), ({}, SPRING)])
@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_symmetric_pair_is_the_single_bearing(solved, fidelity, single, pair, loss):
    of_single = solved(single | {LOSS: loss}, fidelity)
    of_pair = solved(pair | {LOSS: loss}, fidelity)
    for k in range(2):
        of_one = values_of_bearing(of_pair, k)
        for name, value in of_single.items():
            assert_allclose(of_one[name], value, rtol=1e-12, err_msg=name)
    assert set(of_pair) - set(of_single) <= SHARED


def test_a_pair_seen_from_the_other_end_has_the_same_state(solved):
    """With the bearings and the force exchanged, the shift changes sign and the rest sides."""
    force = {"arrangement.external_axial_N": 2.0, LOSS: 0.1, "arrangement.second": {LOSS: 0.4}}
    turned = {"arrangement.external_axial_N": -2.0, LOSS: 0.4, "arrangement.second": {LOSS: 0.1}}
    values, turned_values = solved(RIGID | force), solved(RIGID | turned)
    assert_allclose(values["rotor_axial_shift"], -turned_values["rotor_axial_shift"], rtol=1e-9)
    for name in ("total_qv", "residual_preload", "contact_angle"):
        assert_allclose(values[name], turned_values[name][::-1], rtol=1e-9, err_msg=name)
    stiffness = turned_values["system_axial_stiffness"]
    assert_allclose(values["system_axial_stiffness"], stiffness, rtol=1e-9)


# independent checks


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
@pytest.mark.parametrize("changes", [
    {"arrangement.external_axial_N": 5.0},
    {LOSS: 0.1, "arrangement.second": {LOSS: 0.5, "friction.ball_race": 0.03}},
    {"arrangement.external_axial_N": -3.0,
     "arrangement.second": {"bearing.ball_count": 8, "bearing.contact_angle_deg": 25.0}},
])  # fmt: skip
def test_the_rotor_of_a_rigid_pair_is_in_balance(solved, scene, fidelity, changes):
    """Forces are compared with those of single bearings that are held at the places of the pair."""
    values = solved(RIGID | changes, fidelity)
    F_ext = changes.get("arrangement.external_axial_N", 0.0)
    sides = scene("gyro_s1", RIGID | changes).sides
    shifts = values["axial_displacement"] - [parameters.static_place(side) for side in sides]
    assert_allclose(shifts.sum(), 0.0, atol=1e-18)  # rounding of micrometres
    assert_allclose(shifts[0], values["rotor_axial_shift"], atol=1e-18)
    forces = []
    for side, place, speed in zip(
        sides, values["axial_displacement"], values["orbit_speed"][:, 0], strict=True
    ):
        g = parameters.geometry(side)
        load = orbit_load(float(speed), 0.0, 0.0)
        D = float(parameters.ball_diameters(side)[0])
        _, state = thrust_equilibrium(g, D, load, 0.0, float(place), False, cold_start())
        forces.append(g.n_balls * state.F_ix)
    if fidelity == "steady":
        assert_allclose(forces, values["residual_preload"], rtol=1e-9)
    assert_allclose(np.subtract(*values["residual_preload"]), F_ext, atol=1e-9)


@pytest.mark.parametrize("F_ext", [0.0, 3.5, -3.5])
def test_the_force_of_a_spring_follows_both_bearings(solved, scene, F_ext):
    """The second bearing has F_2 = F_s - k_s e, where e is how far both bearings give way [m].

    F_s is the 7 N of the spring, k_s its 0.2 N/um. Solved here by SciPy's brentq.
    """
    k_s = 0.2e6
    changes = SPRING | REST | {
        "arrangement.spring_stiffness_N_um": 0.2,
        "arrangement.external_axial_N": F_ext,
        LOSS: 0.3,
    }  # fmt: skip
    values = solved(changes)
    gyro = scene("gyro_s1")
    g, mounted = parameters.geometry(gyro), parameters.static_place(gyro)
    worn = Mechanics(g, g.D0 - 0.3e-6)

    def unbalanced(F_2):
        offset = worn.place(F_2 + F_ext) + worn.place(F_2) - 2.0 * mounted
        return 7.0 - k_s * offset - F_2

    F_2 = brentq(unbalanced, 3.6, 9.0, xtol=1e-13)  # [N]; far below what is compared
    assert_allclose(values["residual_preload"], [F_2 + F_ext, F_2], rtol=1e-9)
    assert_allclose(values["rotor_axial_shift"], worn.place(F_2 + F_ext) - mounted, rtol=1e-8)
    assert_allclose(values["spring_travel"], (7.0 - F_2) / k_s, rtol=1e-8)
    k = values["axial_stiffness"]
    assert_allclose(values["system_axial_stiffness"], k[0] + k_s * k[1] / (k_s + k[1]), rtol=1e-12)
    h = 1e-3
    ends = [
        solved(changes | {"arrangement.external_axial_N": F_ext + s * h})["rotor_axial_shift"]
        for s in (-1, 1)
    ]
    # the tangent holds the Hertz factors, which follow the angle a little
    assert_allclose(2.0 * h / (ends[1] - ends[0]), values["system_axial_stiffness"], rtol=1e-3)


def test_the_rotor_check_rejects_another_place_or_force(scene):
    """It rejects a force or a place of the first bearing that is off by a millionth."""
    rigid = scene("gyro_s1", RIGID | {"arrangement.external_axial_N": 3.5})
    pair = solver_of(rigid, "steady", Accuracy.CHECKED).bearings
    state = pair.solve(pair.start)
    cases = [side.case(value)[0] for side, value in zip(pair.sides, state.sides, strict=True)]
    mounted = [side.mounted for side in pair.sides]
    assert rotor_balance(rigid, mounted, cases) < 1e-9
    for name in ("residual_preload", "axial_displacement"):
        wrong = [cases[0] | {name: cases[0][name] * (1.0 + 1e-6)}, cases[1]]
        assert rotor_balance(rigid, mounted, wrong) > 1e-7


# lift-off


def test_a_rigid_pair_lifts_off_either_way_beyond_its_force(solved):
    """The lift-off force is 20.5774 N, as in the first test here."""

    def under(F, status="ok"):
        return solved(RIGID | REST | {"arrangement.external_axial_N": F}, status=status)

    assert 0.0 < under(20.57)["residual_preload"][1] < 1e-3
    for F in (20.58, -20.58):
        assert "total_qv" not in under(F, status="lifted_off")


def test_a_pair_under_a_constant_force_lifts_off_at_this_force(solved):
    """The spring has 7 N: against 6 N of external force, 1 N is left on the first bearing."""
    solved(SPRING | {"arrangement.external_axial_N": -7.0}, status="lifted_off")
    values = solved(SPRING | {"arrangement.external_axial_N": -6.0})
    assert values["residual_preload"][0] == pytest.approx(1.0)


def test_a_pair_whose_bearings_have_worn_free_has_a_status(solved):
    """3 um of ball diameter are more than the 2.2 um by which 7 N displace them."""
    worn_free = RIGID | REST | {LOSS: 3.0, "arrangement.second": {LOSS: 3.1}}
    solved(worn_free, status="preload_gone")


def test_a_lightly_loaded_pair_lifts_off_at_the_closed_form(scene):
    """A pair lifts off at 2^(3/2) preloads, two bearings in tandem against one at 2.08 and 4.16.

    (1 + 2^(-2/3))^(3/2) is 2.08 on the side of two, which have twice the balls, and twice as much
    on the other.
    """
    g = parameters.geometry(scene("gyro_s1"))
    tandem = g._replace(n_balls=2 * g.n_balls)
    F = 1e-5

    def rotor(*sides):
        mounted = tuple(side.place(F) for side in sides)
        return AxialRotor(sides, mounted)

    alone = Mechanics(g, g.D0)
    assert_allclose(rotor(alone, alone).opening_force / F, 2.0**1.5, rtol=1e-3)
    set_of_three = rotor(Mechanics(tandem, g.D0), alone)
    assert_allclose(set_of_three.opening_force / F, 2.08, rtol=1e-3)
    assert_allclose(set_of_three.external(1, alone.touch) / F, 4.16, rtol=1e-3)


def test_a_pair_on_a_stiff_spring_lifts_off_beyond_its_force(solved):
    """As the first bearing is unloaded, the spring is compressed: its force grows by some k_s/k."""
    constant_force, soft = (
        solved(SPRING | {"arrangement.spring_stiffness_N_um": k})["lift_off_force"]
        for k in (0.0, 0.1)
    )
    assert constant_force == 7.0
    assert 7.0 < soft < 7.5  # by about 7 N times k_s/k, of 0.1 and 4.5 N/um


# rotor


def test_natural_frequencies_of_a_rod_on_springs():
    """They are sqrt(k/m)/(2 pi) along and across, and of tilting about the middle of the span."""
    sides = np.array([np.diag([5e6, 15e6, 15e6, 0.0, 0.0])] * 2)
    rod = Arrangement(kind="rigid_pair", rotor_mass_kg=0.03, span_mm=20.0)
    inertia = 0.03 * 0.02**2 / 12.0
    expected = np.sqrt([10e6 / 0.03, 30e6 / 0.03, 30e6 * 0.01**2 / inertia]) / (2.0 * math.pi)
    assert_allclose(natural_frequencies(rod, sides, 10e6), expected, rtol=1e-12)
    rotor = Arrangement(
        kind="rigid_pair", rotor_mass_kg=0.03, span_mm=20.0, rotor_transverse_inertia_kg_mm2=4.0
    )
    tilting = natural_frequencies(rotor, sides, 10e6)[2]
    assert_allclose(tilting, expected[2] * math.sqrt(inertia / 4e-6), rtol=1e-12)


def test_a_pair_back_to_back_resists_tilting_more_than_face_to_face(solved):
    """The stiffness against tilting has 4 l K_23 added back to back, and subtracted face to face.

    l is half of the span of 20 mm, K_23 the coupling of radial force and tilt of a bearing.
    """
    K = solved(RIGID)["stiffness_matrix"]
    by = {
        way: rotor_stiffness(Arrangement(kind="rigid_pair", span_mm=20.0, orientation=way), K)
        for way in ("back_to_back", "face_to_face")
    }
    for case in by.values():
        assert_allclose(case, case.T, rtol=0, atol=1e-9 * np.abs(case).max())
        assert_allclose(case[1, 4], 0.0, atol=1e-9 * np.abs(case).max())  # a symmetric pair
        assert_allclose(case[0, 0], 2.0 * K[0, 0, 0], rtol=1e-12)
    lever = 4.0 * 0.01 * abs(K[0, 2, 3])
    assert_allclose(by["back_to_back"][3, 3] - by["face_to_face"][3, 3], 2.0 * lever, rtol=1e-9)


def test_frequencies_need_mass_and_span(solved):
    """The axial frequency is sqrt(k/m)/(2 pi) of the system."""
    assert "natural_frequency" not in solved(RIGID | {"arrangement.rotor_mass_kg": 0.03})
    both = {"arrangement.rotor_mass_kg": 0.03, "arrangement.span_mm": 20.0}
    values = solved(RIGID | both)
    assert_allclose(
        values["natural_frequency"][0],
        math.sqrt(values["system_axial_stiffness"] / 0.03) / (2.0 * math.pi),
        rtol=1e-12,
    )


# models


def test_a_pair_is_solved_steady_and_by_race_control_under_a_radial_load(scene):
    assert choice(scene("gyro_s1", RIGID)).fidelity == "steady"
    radial = scene("gyro_s1", RIGID | {"operation.radial_load_N": [0.0, 1.0]})
    assert choice(radial).fidelity == "race_control"
    assert solve(radial).status == "ok"


@pytest.mark.parametrize(
    ("changes", "fidelity"), [({}, "dynamic"), ({"model.cage_results": True}, None)]
)
def test_the_dynamic_model_of_a_pair_is_refused(scene, changes, fidelity):
    problem = "rigid_pair, expected .*: set arrangement.kind to sin"
    with pytest.raises(NotAvailable, match=problem):
        choice(scene("gyro_s1", RIGID | changes), fidelity)


def test_a_warm_shaft_takes_preload_back_to_back_and_adds_it_face_to_face(solved):
    warm = {"temperature": {"shaft_C": 30.0, "housing_C": 20.0}, "arrangement.span_mm": 20.0}
    preloads = [
        solved(RIGID | warm | {"arrangement.orientation": way})["residual_preload"][0]
        for way in ("back_to_back", "face_to_face")
    ]
    cold = solved(RIGID)["residual_preload"][0]
    assert preloads[0] < cold < preloads[1]


# temperatures from a network

NETWORK = {
    "thermal": {
        "conductance_W_K": {
            "inner_ring_shaft": 0.01, "outer_ring_housing": 0.02, "ball_race": 0.005,
        },
    },
}  # fmt: skip


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
def test_each_bearing_has_its_own_network(solved, fidelity):
    """The more loaded side is warmer; heat flows and the rotor balance."""
    values = solved(RIGID | NETWORK | {"arrangement.external_axial_N": 4.0}, fidelity)
    assert values["part_temperature"][0, 0] > values["part_temperature"][1, 0] + 0.1
    assert_allclose(np.subtract(*values["residual_preload"]), 4.0, atol=1e-7)
    assert (values["heat_flow_residual"] < 1e-5).all()
    inputs = dict(zip(("inner_ring_C", "balls_C", "outer_ring_C", "shaft_C", "housing_C"),
                     values["part_temperature"].T, strict=True))  # fmt: skip
    first = {f"temperature.{name}": float(t[0]) for name, t in inputs.items()}
    second = {f"temperature.{name}": float(t[1]) for name, t in inputs.items()}
    same = solved(RIGID | first | {"arrangement.external_axial_N": 4.0,
                                   "arrangement.second": second}, fidelity)  # fmt: skip
    for name in ("residual_preload", "total_qv", "rotor_axial_shift", "system_axial_stiffness"):
        assert_allclose(same[name], values[name], rtol=1e-6, err_msg=name)
