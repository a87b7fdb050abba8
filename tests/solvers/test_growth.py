"""Growth by heat, speed and fits, against another program, closed forms and limits."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import numbers_in

from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, thrust_equilibrium
from bearingwear.kernels.params import BallLoad
from bearingwear.lives.life import life
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.new.scene_file import checked_scene, scene_text
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.growth import (
    Expansion,
    Ring,
    axial_change,
    growth_of,
    thermal_expansion,
)
from bearingwear.solvers.bearing.mounted import mounted_geometry
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.effects.growth import change_at_speed, change_by_warm_ring
from bearingwear.solvers.solve import solve
from bearingwear.solvers.start import start_of

HELD = {"operation.preload_method": "fixed_position"}
HYBRID = {
    "materials.silicon_nitride.thermal_expansion_1_K": 3.2e-6,
    "materials.bearing_steel.thermal_expansion_1_K": 11.5e-6,
}
SEATED = {"bearing.bore_mm": 4.0, "bearing.outside_diameter_mm": 13.0}


def static_preload(scene) -> float:
    """Returns the preload [N] at rest, in a fixed position, of parts as grown at speed."""
    g = parameters.geometry(scene)
    load = BallLoad(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # no orbit, forces or tractions
    place = parameters.static_place(scene)
    _, state = thrust_equilibrium(g, g.D0, load, 0.0, place, False, cold_start())
    return g.n_balls * state.F_ix


@pytest.mark.parametrize(
    ("changes", "preload", "static", "angles", "qv"),
    [
        ({}, "7.3303", "7.0000", ("21.4940", "19.9957"), "1.0000"),  # nothing grows
        ({"temperature.inner_ring_C": 30}, "11.468", "11.273", ("21.0840", "20.1367"), "1.7402"),
        ({"temperature.inner_ring_C": 30, "temperature.balls_C": 30},
         "15.311", "15.161", ("20.9208", "20.2138"), "2.5208"),
        ({"temperature.inner_ring_C": 15}, "5.6055", "5.129", ("21.8360", "19.8610"), "0.7288"),
        ({"bearing.bore_mm": 4.0}, "7.3894", "7.0625", None, "1.0097"),
    ],
)  # fmt: skip
def test_growth_agrees_with_a_program_written_apart(scene, changes, preload, static, angles, qv):
    """Preload [N] at speed and at rest, angles [deg], QV over that without growth.

    They are texts, whose last decimal sets the tolerance.
    """

    def check_digits(value: float, text: str) -> None:
        """Asserts that a value rounds to a text, with 2 % of its last decimal to spare."""
        decimals = len(text.partition(".")[2])
        assert value == pytest.approx(float(text), abs=0.51 * 10.0**-decimals, rel=0.0)

    grown = scene("gyro_s1", HELD | changes)
    values, mounted = solve(grown).values, solve(scene("gyro_s1", HELD)).values
    check_digits(values["residual_preload"], preload)
    check_digits(static_preload(grown), static)
    check_digits(values["total_qv"] / mounted["total_qv"], qv)
    if angles:  # the other program has none for a bearing with rings
        for value, text in zip(np.degrees(values["contact_angle"][0]), angles, strict=True):
            check_digits(value, text)


def ring(inside=2e-3, outside=3e-3) -> Ring:
    """Returns a steel ring with these radii [m] that turns at 1e4 rad/s."""
    return Ring(inside=inside, outside=outside, E=208e9, nu=0.3, rho=7800.0, omega=1e4)


def test_a_rotating_disc_and_annulus_grow_as_in_closed_form():
    """Timoshenko and Goodier: rim and bore of an annulus, rim of a full disc."""
    r = ring()
    a, b, E, nu = r.inside, r.outside, r.E, r.nu
    load = r.rho * r.omega**2 / (4.0 * E)
    rim = load * b * ((3.0 + nu) * a**2 + (1.0 - nu) * b**2)
    bore = load * a * ((3.0 + nu) * b**2 + (1.0 - nu) * a**2)
    assert_allclose([r.growth_at_speed(b), r.growth_at_speed(a)], [rim, bore], rtol=1e-10)
    full = ring(inside=0.0)
    assert_allclose(full.growth_at_speed(b), load * b**3 * (1.0 - nu), rtol=1e-10)


def test_pressed_rings_grow_as_lame_says():
    """A ring under even pressure p shrinks by (1 - nu) p/E; a thin one expands as a hoop."""
    r = ring()
    assert_allclose(r.growth_under(1e6, 1e6, r.inside), -0.7e6 / r.E * r.inside, rtol=1e-10)
    thin = ring(inside=3e-3 * (1.0 - 1e-6))
    hoop = 1e6 * thin.inside**2 / (thin.E * (thin.outside - thin.inside))
    assert_allclose(thin.growth_under(1e6, 0.0, thin.inside), hoop, rtol=1e-5)


def growth_with_fit(scene, **keys):
    """Returns the growth of the rings of gyro_s1 with these keys of `fits`."""
    changes = {f"fits.{name}": value for name, value in keys.items()}
    return growth_of(scene("gyro_s1", SEATED | changes))


def track_radius(scene, side):
    """Returns the radius [m] of the inner (-1) or outer (+1) track of gyro_s1."""
    b = scene("gyro_s1").bearing
    cosine = math.cos(math.radians(b.contact_angle_deg))
    return 0.5e-3 * (b.pitch_diameter_mm + side * b.ball_diameter_mm * cosine)


@pytest.mark.parametrize("hole", [0.0, 1.5, 3.0])
def test_a_ring_on_a_hollow_shaft_of_the_same_material_has_the_pressure_of_lame(scene, hole):
    """p = E I (b^2 - a^2)(a^2 - c^2)/(4 a^3 (b^2 - c^2)) at rest, with the interference I.

    a, b and c are the radii of the bore, the track and the hole of the shaft.
    """
    still = {"operation.shaft_speed_rpm": 0.0, "fits.shaft_bore_mm": hole}
    still |= SEATED | {"fits.shaft_interference_um": 2.0}
    ring = growth_of(scene("gyro_s1", still)).inner
    a, b, c, E, tight = 2e-3, track_radius(scene, -1.0), 0.5e-3 * hole, 208e9, 2e-6
    p = E * tight * (b**2 - a**2) * (a**2 - c**2) / (4.0 * a**3 * (b**2 - c**2))
    assert_allclose(ring.pressure, p, rtol=1e-10)
    assert_allclose(ring.fit, 2.0 * p * a**2 * b / (E * (b**2 - a**2)), rtol=1e-10)


def test_a_tight_ring_on_a_full_shaft_is_a_full_disc(scene):
    """It grows by rotation as the disc, and by I a/(2 b) of the fit: a is the bore, b the track."""
    ring = growth_with_fit(scene, shaft_interference_um=4.0).inner
    a, b, omega = 2e-3, track_radius(scene, -1.0), 1000.0 * math.pi
    disc = 7800.0 * omega**2 * b**3 * 0.7 / (4.0 * 208e9)
    assert_allclose(ring.speed + ring.fit, disc + 4e-6 * a / (2.0 * b), rtol=1e-10)


def test_the_track_of_an_outer_ring_in_a_thick_housing_closes_as_in_closed_form(scene):
    """By I a/(2 b) for one material: I is the interference of 3 um, a the track, b the seat."""
    ring = growth_with_fit(scene, housing_interference_um=3.0).outer
    assert_allclose(ring.fit, -1.5e-6 * track_radius(scene, 1.0) / 6.5e-3, rtol=1e-10)


def test_speed_takes_a_fit_away(scene):
    def inner_ring(rpm):
        seat = {"bearing.bore_mm": 35.0, "fits.shaft_interference_um": 10.0}
        seat |= {"fits.shaft_bore_mm": 20.0, "operation.shaft_speed_rpm": rpm}
        return growth_of(scene("turbopump", seat)).inner

    at_rest, at_speed = inner_ring(0.0), inner_ring(80_000.0)
    assert at_rest.pressure > 0.0 and not at_rest.seat_lost
    assert at_speed.pressure == at_speed.fit == 0.0 and at_speed.seat_lost


def test_a_fit_follows_the_warmth_of_shaft_and_housing(scene):
    """The inner ring has 40 degC: a shaft of 20 degC loosens the fit and one of 50 tightens it.

    Without a temperature of its own the shaft is as warm as the ring, and presses as when cold.
    """
    base = SEATED | {"fits.shaft_interference_um": 2.0, "temperature.inner_ring_C": 40}

    def pressure(**temperatures):
        changes = {f"temperature.{name}": C for name, C in temperatures.items()}
        return growth_of(scene("gyro_s1", base | changes)).inner.pressure

    as_warm_as_the_ring = pressure()  # by default
    assert pressure(shaft_C=20) < as_warm_as_the_ring < pressure(shaft_C=50)
    cold = growth_with_fit(scene, shaft_interference_um=2.0).inner.pressure
    assert_allclose(as_warm_as_the_ring, cold, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("gyro_s1", {}),
        ("turbopump", {}),
        ("turbine", {}),
        ("bearing218", {}),
        ("gyro_s1", {"temperature.reference_C": 35.0}),
        ("gyro_s1", {"fits.shaft_interference_um": 0.0}),
    ],
)
def test_geometry_without_growth_is_bit_for_bit_the_mounted_one(scene, name, changes):
    without_growth = scene(name, changes)
    assert parameters.geometry(without_growth) == mounted_geometry(without_growth)


ALIKE = {f"temperature.{part}_C": 120.0 for part in
         ("inner_ring", "outer_ring", "balls", "shaft", "housing")}  # fmt: skip


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_equal_warming_changes_nothing_but_scale(scene, method):
    """Angles stay to 1e-12; loads go as the square of the lengths."""
    still = {"operation.preload_method": method, "operation.shaft_speed_rpm": 0.0}
    lengths = 1.0 + 11.5e-6 * 100.0
    preload = 7.0 * (lengths**2 if method == "constant_force" else 1.0)
    cold = solve(scene("gyro_s1", still), "race_control").values
    warm = solve(
        scene("gyro_s1", still | ALIKE | {"operation.preload_N": preload}), "race_control"
    ).values
    assert_allclose(warm["contact_angle"], cold["contact_angle"], rtol=0.0, atol=1e-12)
    # the loads hang on a deformation of a thousandth of the lengths that cancel to it
    assert_allclose(warm["contact_load"], lengths**2 * cold["contact_load"], rtol=1e-10)
    assert_allclose(warm["semi_major_axis"], lengths * cold["semi_major_axis"], rtol=1e-10)


def test_mass_of_the_balls_is_kept(scene):
    g, cold = (
        parameters.geometry(scene("gyro_s1", changes))
        for changes in ({"temperature.balls_C": 90.0}, {})
    )
    assert g.D0 > cold.D0
    assert_allclose(g.rho * g.D0**3, cold.rho * cold.D0**3, rtol=1e-14)


@pytest.mark.parametrize("orientation", ["back_to_back", "face_to_face"])
def test_grooves_move_apart_as_shaft_and_housing_expand(orientation):
    """They expand over the distances of their grooves; a single bearing has no span."""
    heat = Expansion(inner_ring=0.0, balls=0.0, outer_ring=0.0, shaft=2e-4, housing=5e-5)
    A1, span = 70e-6, 20e-3
    back = orientation == "back_to_back"
    on_shaft, in_housing = (span - A1, span + A1) if back else (span + A1, span - A1)
    grown_shaft, grown_housing = on_shaft * (1.0 + 2e-4), in_housing * (1.0 + 5e-5)
    distance = 0.5 * (grown_housing - grown_shaft) * (1.0 if back else -1.0)
    assert_allclose(axial_change(heat, A1, span, orientation), distance - A1, rtol=1e-9)
    assert_allclose(axial_change(heat, A1), 0.5 * A1 * (2e-4 + 5e-5), rtol=1e-12)


def test_a_hybrid_bearing_that_is_warmed_evenly_loses_preload(scene):
    """A third to nearly a half of it by 50 K, because its balls grow less."""
    hybrid = HELD | HYBRID
    even = {f"temperature.{part}_C": 70.0 for part in ("inner_ring", "outer_ring", "balls")}
    cold = solve(scene("turbopump", hybrid)).values["residual_preload"]
    warm = solve(scene("turbopump", hybrid | even)).values["residual_preload"]
    assert 0.55 * cold < warm < 0.7 * cold
    assert thermal_expansion(scene("turbopump", hybrid | even)).balls == 3.2e-6 * 50.0


def test_growth_at_speed_more_than_doubles_a_turbopump_preload(scene):
    """That is `turbopump` at fixed position, with the 35 mm bore of its description.

    `change_at_speed` estimates the static preload to 2 %. At speed centrifugal forces take a part.
    """
    held = scene("turbopump", HELD)
    grown = scene("turbopump", HELD | {"bearing.bore_mm": 35.0})
    assert static_preload_ratio(grown) > 2.0
    assert_allclose(1.0 + change_at_speed(grown), static_preload_ratio(grown), rtol=0.02)
    assert solve(grown).values["residual_preload"] > 1.5 * solve(held).values["residual_preload"]


def static_preload_ratio(scene) -> float:
    """Returns the preload of the grown parts at rest over that when mounted."""
    return static_preload(scene) / scene.operation.preload_N


@pytest.mark.parametrize(
    ("name", "changes"), [("gyro_s1", {}), ("turbopump", HYBRID), ("bearing218", {})]
)
def test_the_estimated_effect_of_a_warm_ring_is_right_within_2_percent(scene, name, changes):
    """The inner ring is 5 K warmer than when mounted, at 20 degC."""
    warm = scene(name, HELD | changes | {"temperature.inner_ring_C": 25.0})
    estimate = 1.0 + change_by_warm_ring(warm, 5.0)
    assert_allclose(estimate, static_preload_ratio(warm), rtol=0.02)


WARM = HELD | {"temperature.inner_ring_C": 30.0, "temperature.balls_C": 25.0}


def test_every_model_has_the_preload_of_the_warm_parts(scene):
    """Steady, race control (its own orbit rate: 0.5 %), dynamic and a life agree on it."""
    warm = scene("gyro_s1", WARM)
    steady = solve(warm).values["residual_preload"]
    control = solve(warm, "race_control").values["residual_preload"]
    assert_allclose(control, steady, rtol=5e-3)
    history = life(warm).values["history_residual_preload"]
    assert_allclose(history[0], steady, rtol=1e-9)
    system = DynamicSystem.of(warm.without_cage, start_of(warm).u)
    system.update()
    balls = system.buffers.balls
    lines = balls.A - balls.X
    approach = np.hypot(*lines.T) - (system.bearing.g.r_i - 0.5 * system.bearing.D)
    sines = lines[:, 0] / np.hypot(*lines.T)
    assert_allclose((balls.factors[:, 0, 0] * approach**1.5 * sines).sum(), steady, rtol=1e-6)


@pytest.fixture
def rigid_spindle():
    """Returns a 7910C as `new` writes it, with 60 N at rest and 24 000 r/min."""
    held = {"operation.shaft_speed_rpm": 24_000.0, "operation.preload_N": 60.0}
    text, _ = scene_text("a", None, None, held, None, "fixed_position", designation="7910C")
    return checked_scene(text)


def numbers_of_fit(result) -> list[float]:
    """Returns the numbers of the warning `fit_left_out`.

    They are the preload [N] at rest and at speed, and then four for each of two usual fits: the
    interference [um], both preloads, and the speed from which the ring is loose [r/min].
    """
    sentences = {warning["id"]: warning["sentence"] for warning in warnings_in(result.attrs)}
    return numbers_in(sentences["fit_left_out"])


def test_the_warning_of_a_missing_fit_has_the_preload_of_usual_fits(rigid_spindle):
    """Solves with a fit have it within 2 % at rest and 5 % at speed, and lose the fit as stated."""
    _, _, *numbers = numbers_of_fit(solve(rigid_spindle))
    fits = [numbers[:4], numbers[4:]]
    assert [um for um, *_ in fits] == [5.0, 12.0]
    for um, at_rest, running, loose in fits:
        fitted = rigid_spindle.with_({"fits.shaft_interference_um": um})
        at_speed = solve(fitted).values["residual_preload"]
        still = solve(fitted.with_({"operation.shaft_speed_rpm": 0.0}), "race_control").values
        assert_allclose(at_rest, still["residual_preload"], rtol=0.02)
        assert_allclose(running, at_speed, rtol=0.05)
        for share, is_lost in ((0.97, False), (1.03, True)):
            turned = fitted.with_({"operation.shaft_speed_rpm": share * loose})
            assert growth_of(turned).inner.seat_lost == is_lost
        assert "fit_left_out" not in solve(fitted).attrs["warnings"]


def test_every_fit_has_a_line_before_the_solve(rigid_spindle):
    """Without `fits` the line says that no interference is assumed.

    It states the usual fit of 12 um, also if `fits` is given without interference. With 12 um the
    inner ring is loose from 31 000 r/min. A spring needs no line without a fit.
    """

    def lines(changes):
        """Returns the lines on fits of the choice of a model."""
        reasons = choice(rigid_spindle.with_(changes)).reasons
        return [line for line in reasons if line.startswith("fits: ")]

    (none,), (zero,) = lines({"fits": None}), lines({})
    assert "assumed" in none and "assumed" not in zero
    assert 12.0 in numbers_in(none)
    assert numbers_in(none) == numbers_in(zero)
    (tight,) = lines({"fits.shaft_interference_um": 12.0})
    assert "included" in tight and 31000.0 in numbers_in(tight)
    force = {"operation.preload_method": "constant_force"}
    assert lines(force | {"fits": None}) == [] and "second-order" in lines(force)[0]


def test_no_fit_is_wider_than_a_scene_may_have(scene):
    """A bore of 0.6 mm takes 6 um at most."""
    tiny = scene("gyro_s1", HELD | {"bearing.bore_mm": 0.6, "bearing.outside_diameter_mm": 13.0})
    (line,) = (line for line in choice(tiny).reasons if line.startswith("fits: "))
    assert "5 um" in line and "12 um" not in line


def test_a_worn_bearing_is_warned_of_its_fit_when_new(rigid_spindle):
    """The preload at speed is that of the new one within 15 %: a worn solve does not have it."""
    preload_with_fit = 4  # index of that at speed, with the first of the usual fits
    new = numbers_of_fit(solve(rigid_spindle))[preload_with_fit]
    worn = rigid_spindle.with_({"wear.ball_diameter_loss_um": 1.0})
    for result in (solve(worn), life(rigid_spindle)):
        assert_allclose(numbers_of_fit(result)[preload_with_fit], new, rtol=0.15)
