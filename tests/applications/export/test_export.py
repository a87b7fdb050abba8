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
MASS, SPAN = 3.0, 0.06


@pytest.fixture(scope="module")
def pair():
    scene = bearingwear.new(designation="7010C", maker="NSK", preload_class="L", speed=5000.0)
    changes = {"kind": "rigid_pair", "rotor_mass_kg": MASS, "span_mm": 1e3 * SPAN}
    changes = {f"arrangement.{key}": value for key, value in changes.items()}
    return scene.with_(changes | {"operation.preload_method": "fixed_position"})


@pytest.fixture(scope="module")
def over_speed(pair):
    return StiffnessOverSpeed.of(pair, SPEEDS)


@pytest.fixture(scope="module")
def files(pair, tmp_path_factory):
    """A scene, its stiffness as CSV, and as TOML for both versions of ROSS."""
    folder = tmp_path_factory.mktemp("export")
    bearingwear.save(pair, folder / "pair.yaml")
    for name, options in (("front.csv", []), ("two.toml", []), ("three.toml", ["--ross", "3"])):
        words = ["export", str(folder / "pair.yaml"), "--speeds", "1000:9000:5", *options]
        assert main([*words, "-o", str(folder / name)]) == 0
    return folder


def test_csv_holds_what_a_solve_finds(pair, files):
    rows = list(csv.DictReader(io.StringIO((files / "front.csv").read_text())))
    assert [(float(r["shaft_speed_rpm"]), r["bearing"]) for r in rows] == [
        (speed, bearing) for speed in SPEEDS for bearing in "12"
    ]
    alone = solve(pair.with_({"operation.shaft_speed_rpm": 5000.0})).values["stiffness_matrix"][0]
    K = np.array([[float(rows[4][f"k_{p}_{q}"]) for q in DOFS] for p in DOFS])
    assert np.allclose(K, alone, rtol=1e-12, atol=1e-14 * alone.max())


def test_toml_has_the_axes_and_units_of_ross(over_speed, files):
    two, three = (tomllib.loads((files / f"{name}.toml").read_text()) for name in ("two", "three"))
    element, other = two["BearingElement_two"], three["BearingElement_three"]
    assert element["frequency"] == other["speed"] and "speed" not in element
    assert element["frequency"] == pytest.approx([math.pi / 30.0 * speed for speed in SPEEDS])
    K = over_speed.matrices[:, 0]
    for name, (p, q) in {"xx": (1, 1), "xy": (1, 2), "yy": (2, 2), "zz": (0, 0)}.items():
        assert np.allclose(element[f"k{name}"], K[:, p, q], rtol=1e-15, atol=1e-5), name
    assert element["cxx"] == [0.0] * 5


def test_released_tilt_is_what_a_bearing_without_moment_resists(over_speed):
    held, free = over_speed.ross_matrices(), over_speed.ross_matrices(tilt="released")
    for K, here in zip(over_speed.matrices[:, 0], free, strict=True):
        flexible = np.linalg.inv(K)[:3, :3]  # displacements by forces alone
        alone = np.linalg.inv(flexible)[[1, 2, 0]][:, [1, 2, 0]]
        assert np.allclose(alone, here, rtol=1e-9, atol=1e-6 * here.max())
    assert (free[:, 0, 0] < 0.6 * held[:, 0, 0]).all()
    assert free[:, 2, 2] == pytest.approx(held[:, 2, 2])


def test_a_node_at_the_effective_arm_has_no_coupling(over_speed):
    arm = over_speed.effective_arm()
    assert arm == pytest.approx(0.0325 * math.tan(math.radians(16.0)), rel=0.1)
    for K in over_speed.matrices[:, 0]:
        moved = np.eye(5)
        moved[2, 3] = -arm  # the bearing's own place by a shift and a tilt at the node
        moved[1, 4] = arm
        there = moved.T @ K @ moved
        assert abs(there[2, 3]) < 0.03 * abs(K[2, 3])


def test_bearings_in_tandem_are_one_side(over_speed, pair):
    tandem = pair.with_({"arrangement.tandem": [2, 1]})
    two = StiffnessOverSpeed.of(tandem, [5000.0]).matrices[0]
    assert two.shape == (2, 5, 5) and 0.5 < two[0, 0, 0] / (2.0 * two[1, 0, 0]) < 1.0


def test_a_run_in_time_has_no_stiffness_to_export(pair):
    loaded = {"operation.radial_load_N": [0.0, 60.0], "arrangement.kind": "single"}
    with pytest.raises(NotExported, match=r"model\.fidelity .*race_control"):
        StiffnessOverSpeed.of(pair.with_(loaded), [1000.0])


def test_wrong_arguments_of_an_export_are_refused_in_one_line(pair, files, capsys):
    with pytest.raises(SceneError, match=r"^speeds: .* 1000.0\], expected increasing numbers"):
        StiffnessOverSpeed.of(pair, [3000.0, 1000.0])
    few = StiffnessOverSpeed.of(pair, [1000.0, 2000.0])
    for call, text in (
        (few.coefficients, "speeds: got 2, expected at least 5 for ROSS"),
        (lambda: few.ross_matrices(3), "bearing: got 3, expected 1"),
        (lambda: few.ross_matrices(1, "free"), "tilt: got 'free', expected held or released"),
    ):
        with pytest.raises(SceneError, match=text):
            call()
    with pytest.raises(NotExported, match="^1000 r/min: undetermined: "):
        StiffnessOverSpeed.of(pair.with_({"friction.ball_race": 0.0}), [1000.0])
    scene, out = str(files / "pair.yaml"), str(files / "a.json")
    assert main(["export", scene, "--speeds", "1000,2000", "-o", out]) == 2
    assert "expected a name that ends in .csv or .toml" in capsys.readouterr().err
    assert main(["export", scene, "--speeds", "9:1:3", "-o", out]) == 2
    assert "got '9:1:3', expected LOW:HIGH:COUNT" in capsys.readouterr().err


# with ROSS itself: pip install .[ross]


@pytest.fixture(scope="module")
def ross():
    try:
        import ross
    except Exception as error:  # its own imports fail in many ways
        pytest.skip(f"ROSS is not there (pip install .[ross]): {type(error).__name__}")
    return ross


def test_ross_reads_back_what_was_written(ross, over_speed, files, pair):
    loaded = ross.BearingElement.load(files / "two.toml")
    made_element = bearingwear.to_ross(pair, SPEEDS, damping=20.0)
    coefficients = over_speed.coefficients()
    assert all(
        (np.array(getattr(item, k)) == coefficients[k]).all()
        for item in (loaded, made_element)
        for k in ("kxx", "kzz")
    )
    rounded = math.sqrt(5.0)  # N/m in all five, that ROSS's smoothing spline leaves
    for speed, K in zip(SPEEDS, over_speed.ross_matrices(), strict=True):
        at = math.pi / 30.0 * speed
        assert np.allclose(loaded.K(at), K, rtol=0.0, atol=rounded)
        assert np.allclose(made_element.K(at), K, rtol=0.0, atol=rounded)
        assert np.allclose(np.diag(made_element.C(at)), 20.0)


def jeffcott(ross, bearings, stiff=False):
    """A disc half way between two bearings on a shaft that bends, or hardly does."""
    steel = ross.Material("steel", rho=1e-3 if stiff else 1.0, E=2.1e11, Poisson=0.3)
    odl = 0.4 if stiff else 0.02
    shaft = [ross.ShaftElement(L=0.05, idl=0.0, odl=odl, material=steel, n=k) for k in range(4)]
    disk = ross.DiskElement(n=2, m=MASS, Id=1e-4, Ip=1e-6)
    return ross.Rotor(shaft, [disk], bearings)


def test_a_radial_load_shows_which_axis_of_ross_is_which(ross, pair):
    """ROSS's x is Y here: a bearing softer along Y moves more under a force along ROSS's x."""
    loaded = {"operation.radial_load_N": [0.0, 60.0], "arrangement.kind": "single"}
    unlike = pair.with_(loaded | {"model.fidelity": "race_control"})
    over_speed = StiffnessOverSpeed.of(unlike, SPEEDS)
    element = bearingwear.to_ross(unlike, SPEEDS)
    at = math.pi / 30.0 * SPEEDS[2]
    K = over_speed.matrices[2, 0]
    assert abs(K[1, 1] / K[2, 2] - 1.0) > 1e-3 and abs(K[0, 2]) > 1e3 * abs(K[0, 1])
    assert np.diag(element.K(at)) == pytest.approx([K[1, 1], K[2, 2], K[0, 0]], rel=1e-6)


def test_critical_speed_of_a_jeffcott_rotor(ross, pair):
    """Two bearings in series with a shaft: w^2 = k/m, 1/k = 1/(2 k_b) + L^3/(48 E I)."""
    speed = 5000.0
    k_b = StiffnessOverSpeed.of(pair, [speed]).ross_matrices()[0, 0, 0]
    same = [k_b] * 5
    at = [100.0, 1000.0, 2000.0, 4000.0, 8000.0]
    bearings = [
        ross.BearingElement(n=n, kxx=same, cxx=[0.0] * 5, kzz=same, czz=[0.0] * 5, frequency=at)
        for n in (0, 4)
    ]
    bend = 48.0 * 2.1e11 * math.pi * 0.02**4 / 64.0 / 0.2**3
    shear = 4.0 * 0.9 * 2.1e11 / 2.6 * math.pi * 0.01**2 / 0.2  # circular section
    k = 1.0 / (0.5 / k_b + 1.0 / bend + 1.0 / shear)
    critical = jeffcott(ross, bearings).run_modal(speed=0.0).wn
    lateral = critical[np.isclose(critical, math.sqrt(k / MASS), rtol=0.05)]
    assert lateral.size and lateral == pytest.approx(math.sqrt(k / MASS), rel=0.01)


def test_our_own_frequency_is_that_of_a_stiff_rotor(ross, pair):
    """A shaft that hardly bends: the radial frequency that `solve` prints."""
    frequency = solve(pair.with_({"operation.shaft_speed_rpm": 5000.0})).values["natural_frequency"]
    bearings = [bearingwear.to_ross(pair, SPEEDS, node) for node in (0, 4)]
    modes = jeffcott(ross, bearings, stiff=True).run_modal(speed=math.pi / 30.0 * 5000.0).wn
    assert np.min(abs(modes / (2.0 * math.pi * frequency[1]) - 1.0)) < 0.01
