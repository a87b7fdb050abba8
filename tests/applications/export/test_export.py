"""Stiffness over speed as CSV and for ROSS: axes, tilt, units, and a rotor on two such bearings."""

import csv
import io
import math
import tomllib

import numpy as np
import pytest

import bearingwear
from bearingwear.applications.export.stiffness import NotExported, StiffnessOverSpeed
from bearingwear.cli import main
from bearingwear.results.variables import DOFS
from bearingwear.scene.scene import SceneError
from bearingwear.solvers.solve import solve

SPEEDS = [1000.0, 3000.0, 5000.0, 7000.0, 9000.0]
MASS, SPAN = 3.0, 0.06  # of the rotor [kg], between its bearings [m]
FROM_ROSS = [1, 2, 0]  # indices here of the axes x, y and z of ROSS
RAD_S = math.pi / 30.0  # of 1 r/min


@pytest.fixture(scope="module")
def pair():
    """Returns a rigid pair of 7010C bearings with a rotor."""
    scene = bearingwear.new(designation="7010C", maker="NSK", preload_class="L", speed=5000.0)
    changes = {"kind": "rigid_pair", "rotor_mass_kg": MASS, "span_mm": 1e3 * SPAN}
    changes = {f"arrangement.{key}": value for key, value in changes.items()}
    return scene.with_(changes | {"operation.preload_method": "fixed_position"})


@pytest.fixture(scope="module")
def over_speed(pair):
    """Returns the stiffness of the pair at `SPEEDS`."""
    return StiffnessOverSpeed.of(pair, SPEEDS)


@pytest.fixture(scope="module")
def files(pair, tmp_path_factory):
    """Returns a folder with a scene, and its stiffness as CSV and as TOML for ROSS 2 and 3."""
    folder = tmp_path_factory.mktemp("export")
    bearingwear.save(pair, folder / "pair.yaml")
    for name, options in (("front.csv", []), ("ross2.toml", []), ("ross3.toml", ["--ross", "3"])):
        argv = ["export", str(folder / "pair.yaml"), "--speeds", "1000:9000:5", *options]
        assert main([*argv, "-o", str(folder / name)]) == 0
    return folder


def test_csv_has_the_stiffness_matrices_of_solves(pair, files):
    rows = list(csv.DictReader(io.StringIO((files / "front.csv").read_text())))
    assert [(float(row["shaft_speed_rpm"]), row["bearing"]) for row in rows] == [
        (speed, bearing) for speed in SPEEDS for bearing in "12"
    ]
    result = solve(pair.with_({"operation.shaft_speed_rpm": 5000.0}))
    expected = result.values["stiffness_matrix"][0]
    row = rows[4]  # of bearing 1 at SPEEDS[2]
    K = np.array([[float(row[f"k_{p}_{q}"]) for q in DOFS] for p in DOFS])
    assert np.allclose(K, expected, rtol=1e-12, atol=1e-14 * expected.max())  # rounding


def test_toml_has_the_axes_and_units_of_ross(over_speed, files):
    element = tomllib.loads((files / "ross2.toml").read_text())["BearingElement_ross2"]
    assert element["frequency"] == pytest.approx([RAD_S * speed for speed in SPEEDS])
    K = over_speed.matrices[:, 0]
    for name, (p, q) in {"xx": (1, 1), "xy": (1, 2), "yy": (2, 2), "zz": (0, 0)}.items():
        # terms that are only rounding are written as 0
        assert np.allclose(element[f"k{name}"], K[:, p, q], rtol=1e-15, atol=1e-5), name
    assert element["cxx"] == [0.0] * 5


def test_the_key_of_the_speeds_depends_on_the_version_of_ross(files):
    element_2, element_3 = (
        tomllib.loads((files / f"{name}.toml").read_text())[f"BearingElement_{name}"]
        for name in ("ross2", "ross3")
    )
    assert element_2["frequency"] == element_3["speed"]
    assert "speed" not in element_2 and "frequency" not in element_3


def test_stiffness_with_released_tilt_is_that_without_moments(over_speed):
    """The upper left part of the inverse matrix is the flexibility under forces alone."""
    released = over_speed.ross_matrices(tilt="released")
    for K, K_released in zip(over_speed.matrices[:, 0], released, strict=True):
        flexibility = np.linalg.inv(K)[:3, :3]
        expected = np.linalg.inv(flexibility)[FROM_ROSS][:, FROM_ROSS]
        assert np.allclose(K_released, expected, rtol=1e-9, atol=1e-6 * K_released.max())


def test_released_tilt_softens_a_bearing_radially_but_not_axially(over_speed):
    """The radial stiffness falls to 0.05 to 0.1, measured."""
    K_held, K_released = over_speed.ross_matrices(), over_speed.ross_matrices(tilt="released")
    assert (K_released[:, 0, 0] < 0.2 * K_held[:, 0, 0]).all()
    assert K_released[:, 2, 2] == pytest.approx(K_held[:, 2, 2])


def test_a_node_at_the_effective_arm_has_no_coupling(over_speed):
    """Less than 3 % of the coupling at the bearing is left: the arm is a mean over all speeds."""
    arm = over_speed.effective_arm()
    pitch_radius, contact_angle = 0.0325, math.radians(16.0)  # of a 7010C, at speed, nearly
    assert arm == pytest.approx(pitch_radius * math.tan(contact_angle), rel=0.1)
    bearing_by_node = np.eye(5)  # displacement of the bearing by that of the node
    bearing_by_node[2, 3] = -arm
    bearing_by_node[1, 4] = arm
    for K in over_speed.matrices[:, 0]:
        K_node = bearing_by_node.T @ K @ bearing_by_node
        assert abs(K_node[2, 3]) < 0.03 * abs(K[2, 3])


def test_bearings_in_tandem_are_one_side(pair):
    """Two in tandem share the load of the third, so that each is less stiff than the third."""
    tandem = pair.with_({"arrangement.tandem": [2, 1]})
    K_tandem, K_single = StiffnessOverSpeed.of(tandem, [5000.0]).matrices[0]
    assert K_tandem.shape == K_single.shape == (5, 5)
    assert 0.5 < K_tandem[0, 0] / (2.0 * K_single[0, 0]) < 1.0


def test_a_scene_for_the_dynamic_model_has_no_stiffness_to_export(pair):
    radial_load = {"operation.radial_load_N": [0.0, 60.0], "arrangement.kind": "single"}
    with pytest.raises(NotExported, match=r"model\.fidelity .*race_control"):
        StiffnessOverSpeed.of(pair.with_(radial_load), [1000.0])


def test_speeds_that_do_not_rise_are_refused(pair):
    with pytest.raises(SceneError, match=r"^speeds: .* 1000.0\], expected increasing numbers"):
        StiffnessOverSpeed.of(pair, [3000.0, 1000.0])


def test_too_few_speeds_for_ross_are_refused(pair):
    with pytest.raises(SceneError, match="speeds: got 2, expected at least 5 for ROSS"):
        StiffnessOverSpeed.of(pair, [1000.0, 2000.0]).coefficients()


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ({"bearing": 3}, "bearing: got 3, expected 1"),
        ({"tilt": "free"}, "tilt: got 'free', expected held or released"),
    ],
)
def test_an_unknown_bearing_or_tilt_is_refused(over_speed, arguments, problem):
    with pytest.raises(SceneError, match=problem):
        over_speed.ross_matrices(**arguments)


def test_a_speed_without_a_solution_is_named(pair):
    """Without friction, the motion of the balls is undetermined."""
    with pytest.raises(NotExported, match="^1000 r/min: undetermined: "):
        StiffnessOverSpeed.of(pair.with_({"friction.ball_race": 0.0}), [1000.0])


@pytest.mark.parametrize(
    ("speeds", "name", "problem"),
    [
        ("1000,2000", "stiffness.json", "expected a name that ends in .csv or .toml"),
        ("9:1:3", "stiffness.csv", "got '9:1:3', expected LOW:HIGH:COUNT"),
    ],
)
def test_wrong_options_of_export_are_refused(files, tmp_path, capsys, speeds, name, problem):
    argv = ["export", files / "pair.yaml", "--speeds", speeds, "-o", tmp_path / name]
    assert main([str(word) for word in argv]) == 2
    assert problem in capsys.readouterr().err


# with ROSS itself: pip install .[ross]


@pytest.fixture(scope="module")
def ross():
    """Returns the module `ross`, if it is installed."""
    try:
        import ross
    except Exception as error:  # its own imports fail in many ways
        pytest.skip(f"ROSS is not installed (pip install .[ross]): {type(error).__name__}")
    return ross


def test_ross_reads_the_exported_stiffness(ross, over_speed, files, pair):
    from_file = ross.BearingElement.load(files / "ross2.toml")
    from_scene = bearingwear.to_ross(pair, SPEEDS, damping=20.0)
    coefficients = over_speed.coefficients()
    spline_error = math.sqrt(5.0)  # of ROSS's smoothing spline in five points [N/m]
    for element in (from_file, from_scene):
        for name in ("kxx", "kzz"):
            np.testing.assert_array_equal(getattr(element, name), coefficients[name])
        for speed, K in zip(SPEEDS, over_speed.ross_matrices(), strict=True):
            assert np.allclose(element.K(RAD_S * speed), K, rtol=0.0, atol=spline_error)
    assert np.allclose(np.diag(from_scene.C(RAD_S * SPEEDS[0])), 20.0)


def jeffcott_rotor(ross, bearings, diameter, density):
    """Returns a rotor with a disc half way between two bearings on a shaft of 0.2 m.

    diameter, density: of the shaft [m], [kg/m3].
    """
    steel = ross.Material("steel", rho=density, E=2.1e11, Poisson=0.3)
    shaft = [
        ross.ShaftElement(L=0.05, idl=0.0, odl=diameter, material=steel, n=k) for k in range(4)
    ]
    disk = ross.DiskElement(n=2, m=MASS, Id=1e-4, Ip=1e-6)
    return ross.Rotor(shaft, [disk], bearings)


def test_a_radial_load_distinguishes_the_axes_of_ross(ross, pair):
    """ROSS's x is Y here: a bearing softer along Y is softer along ROSS's x."""
    radial_load = {"operation.radial_load_N": [0.0, 60.0], "arrangement.kind": "single"}
    scene = pair.with_(radial_load | {"model.fidelity": "race_control"})
    K = StiffnessOverSpeed.of(scene, SPEEDS).matrices[2, 0]
    assert abs(K[1, 1] / K[2, 2] - 1.0) > 1e-3 and abs(K[0, 2]) > 1e3 * abs(K[0, 1])
    K_ross = bearingwear.to_ross(scene, SPEEDS).K(RAD_S * SPEEDS[2])
    assert np.diag(K_ross) == pytest.approx([K[1, 1], K[2, 2], K[0, 0]], rel=1e-6)


def test_critical_speed_of_a_jeffcott_rotor(ross, pair):
    """Two bearings in series with a shaft: w^2 = k/m, 1/k = 1/(2 k_b) + L^3/(48 E I) + shear."""
    k_b = StiffnessOverSpeed.of(pair, [5000.0]).ross_matrices()[0, 0, 0]
    stiffness, damping = [k_b] * 5, [0.0] * 5
    speeds = [100.0, 1000.0, 2000.0, 4000.0, 8000.0]  # [rad/s]
    bearings = [
        ross.BearingElement(
            n=node, kxx=stiffness, cxx=damping, kzz=stiffness, czz=damping, frequency=speeds
        )
        for node in (0, 4)
    ]
    diameter, length, E = 0.02, 0.2, 2.1e11
    bending = 48.0 * E * math.pi * diameter**4 / 64.0 / length**3
    shear = 4.0 * 0.9 * E / 2.6 * math.pi * diameter**2 / 4.0 / length  # 0.9 of a circular section
    k = 1.0 / (0.5 / k_b + 1.0 / bending + 1.0 / shear)
    expected = math.sqrt(k / MASS)
    rotor = jeffcott_rotor(ross, bearings, diameter, density=1.0)  # its shaft is nearly massless
    frequencies = rotor.run_modal(speed=0.0).wn
    lateral = frequencies[np.isclose(frequencies, expected, rtol=0.05)]
    assert lateral.size and lateral == pytest.approx(expected, rel=0.01)


def test_the_radial_natural_frequency_is_that_of_ross_for_a_stiff_shaft(ross, pair):
    """The shaft of ROSS, 0.4 m thick and nearly massless, is rigid.

    The translation of a symmetric rotor depends on neither span nor gyroscopic moments.
    """
    scene = pair.with_({"operation.shaft_speed_rpm": 5000.0})
    radial_frequency = solve(scene).values["natural_frequency"][1]  # axial, radial, conical
    bearings = [bearingwear.to_ross(pair, SPEEDS, node) for node in (0, 4)]
    rotor = jeffcott_rotor(ross, bearings, diameter=0.4, density=1e-3)
    modes = rotor.run_modal(speed=RAD_S * 5000.0).wn
    assert np.min(abs(modes / (2.0 * math.pi * radial_frequency) - 1.0)) < 0.01
