"""The study of uncertainty: its plan, and uncertain values in a scene."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose
from support import scene_file

from bearingwear.cli import main
from bearingwear.scene.distributions import value_quantiles
from bearingwear.scene.read import SceneError, load_scene, scene_from_dict
from bearingwear.solvers.bearing import parameters
from bearingwear.studies.sampling import Sampling, scene_with_values
from bearingwear.studies.uncertainty.plan import uncertain_scene
from bearingwear.studies.uncertainty.quantiles import sobol_rows

# distributions of one value, without and with a correlation to friction
SPREAD = {"distribution": "lognormal", "factor": 1.3}
CORRELATED = SPREAD | {"friction_correlation": 0.6}


@pytest.fixture
def scene():
    """Returns gyro_s1, here in place of the fixture of tests/conftest.py."""
    return load_scene(scene_file("gyro_s1"))


@pytest.mark.parametrize(
    "spread, problem",
    [
        ({"ball_race": {"distribution": "uniform", "low": 0.2, "high": 0.1}}, "ball_race.high"),
        ({"ball_race": {"distribution": "lognormal", "factor": 1.0}}, "ball_race.factor"),
        (
            {"ball_race": {"distribution": "normal", "standard_deviation": 0.1, "factor": 2.0}},
            "ball_race.factor: got 2 with the distribution normal",
        ),
        ({"wear_coefficient": CORRELATED}, "friction_correlation: got 0.6, only allowed with"),
        (
            {"wear_coefficient": CORRELATED | {"friction_correlation": 1.0}},
            "friction_correlation: got 1.0, expected a number > -1",
        ),
        (
            {"wear_coefficient": CORRELATED, "ball_race": SPREAD | {"same_for_batch": False}},
            "got 0.6, expected the same value of same_for_batch for wear_coefficient and ball_race",
        ),
    ],
)
def test_a_wrong_distribution_is_refused_in_one_line(scene, spread, problem):
    """The first three have a wrong bound, factor and key, the others a wrong correlation.

    A correlation with friction is above -1 and below 1. It requires an uncertain friction with the
    same `same_for_batch`.
    """
    with pytest.raises(SceneError) as error:
        scene_from_dict(scene.to_dict() | {"uncertainty": spread})
    assert problem in str(error.value) and "\n" not in str(error.value)


def test_a_lognormal_value_whose_median_is_zero_cannot_be_sampled(tmp_path):
    """The drag density of gyro_s1 is zero. The scene loads, but cannot be sampled."""
    plain = yaml.safe_load(scene_file("gyro_s1").read_text())
    plain["uncertainty"] = {"drag_density_kg_m3": {"distribution": "lognormal", "factor": 2.0}}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(plain))
    assert load_scene(tmp_path / "scene.yaml").uncertainty
    with pytest.raises(ValueError, match="drag_density_kg_m3.median: got 0"):
        uncertain_scene(tmp_path / "scene.yaml")


DEVIATES = np.array([-1.2815516, 0.0, 1.2815516])
"""Standard normal quantiles of 10, 50 and 90 %."""


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        pytest.param("preload_N", 7.0 + 0.35 * DEVIATES, id="normal"),
        pytest.param("wear_coefficient", 5e-6 * 3.0**DEVIATES, id="lognormal"),
        pytest.param("brinell_hardness_GPa", [6.44, 6.6, 6.76], id="uniform from 6.4 to 6.8"),
    ],
)
def test_quantiles_of_the_values_are_those_of_their_distribution(scene, name, expected):
    """Values at 10, 50 and 90 % follow from the distributions that gyro_s1 itself has."""
    assert_allclose(value_quantiles(scene, name, np.array([0.1, 0.5, 0.9])), expected, rtol=1e-7)


@pytest.mark.parametrize("rho", [0.6, -0.95])
def test_wear_and_friction_have_the_given_correlation(scene, rho):
    """Logarithms have the correlation, and each distribution is as it is without a correlation.

    4096 points of a Sobol sequence give the correlation to 0.002, mean and deviation to 0.2 %.
    """
    spread = {"ball_race": SPREAD, "wear_coefficient": {"distribution": "lognormal", "factor": 3}}
    uncorrelated = scene_from_dict(scene.to_dict() | {"uncertainty": spread})
    spread["wear_coefficient"]["friction_correlation"] = rho
    correlated = scene_from_dict(scene.to_dict() | {"uncertainty": spread})
    plan = Sampling(samples=4096)
    # sample A of Saltelli, in the order of `spread`
    mu, wear = np.log(sobol_rows(correlated, plan)[0]).T
    assert_allclose(np.corrcoef(mu, wear)[0, 1], rho, atol=0.002)
    mu_alone, wear_alone = np.log(sobol_rows(uncorrelated, plan)[0]).T
    assert (mu == mu_alone).all()
    assert_allclose([wear.mean(), wear.std()], [wear_alone.mean(), math.log(3.0)], rtol=2e-3)


def test_values_beyond_the_range_of_their_key_are_cut_off(scene):
    """A groove factor lies between 0.5 and 1; quantiles between still rise strictly."""
    wide = {"inner_groove_factor": {"distribution": "normal", "standard_deviation": 0.5}}
    scene = scene_from_dict(scene.to_dict() | {"uncertainty": wide})
    values = value_quantiles(scene, "inner_groove_factor", np.linspace(0.0, 1.0, 11))
    assert values.min() >= 0.5 and values.max() <= 1.0 and np.all(np.diff(values) > 0.0)


def test_other_balls_lie_between_the_same_grooves(scene):
    """Radii of grooves (r) and of the circles of their centres (R) stay as they are.

    So does the radial distance of the groove centres, BD cos(alpha0); hence the free contact angle
    of larger balls is smaller.
    """
    nominal = parameters.geometry(scene)
    larger = parameters.geometry(scene_with_values(scene, {"ball_diameter_mm": 2.0005}))
    assert larger.D0 == pytest.approx(2.0005e-3)
    for name in ("r_i", "r_o", "R_i", "R_o"):
        assert_allclose(getattr(larger, name), getattr(nominal, name), rtol=1e-12, err_msg=name)
    across, across_larger = (g.BD * math.cos(g.alpha0) for g in (nominal, larger))
    assert_allclose(across_larger, across, rtol=1e-12)
    assert larger.alpha0 < nominal.alpha0


def test_balls_too_large_for_the_grooves_make_no_scene(scene):
    """The scene is None for balls of 2.1 mm; the grooves of gyro_s1 hold balls up to 2.015 mm."""
    assert scene_with_values(scene, {"ball_diameter_mm": 2.1}) is None


def test_wear_values_of_both_materials_go_together(scene):
    """A new value is that of the races; that of the balls changes by the same factor of two.

    Steel has 5e-6, the balls here a fifth of it.
    """
    steel = scene.materials["bearing_steel"]
    materials = dict(scene.materials) | {"ceramic": replace(steel, wear_coefficient=1e-6)}
    hybrid = replace(
        scene, materials=materials, bearing=replace(scene.bearing, ball_material="ceramic")
    )
    other = scene_with_values(hybrid, {"wear_coefficient": 1e-5})
    assert other.materials["bearing_steel"].wear_coefficient == 1e-5
    assert other.materials["ceramic"].wear_coefficient == pytest.approx(2e-6)
    assert other.materials["phenolic"] == scene.materials["phenolic"]


@pytest.mark.parametrize(
    ("option", "problem"),
    [
        (["--samples", "100"], "--samples: got 100, expected a power of two, such as 128"),
        (
            ["--samples", "0"],
            "bearingwear uncertainty: argument --samples: got '0', expected 1 or more; see "
            "bearingwear uncertainty --help",
        ),
        (
            ["--samples", "4194304"],
            "--samples: got 4194304, expected a whole number from 1 to 1048576",
        ),
        (["--seed", "-1"], "--seed: got -1, expected a whole number >= 0"),
    ],
)
def test_samplings_that_are_refused(option, problem, tmp_path, capsys):
    """The exit status is 2, with one line and no file."""
    out = tmp_path / "out.nc"
    assert main(["uncertainty", str(scene_file("gyro_s1")), *option, "-o", str(out)]) == 2
    assert capsys.readouterr().err.strip() == problem and not out.exists()


def test_every_value_that_is_sampled_arrives_in_the_scene():
    """Keys of a film and of other blocks are set together: none undoes another."""
    film = load_scene(scene_file("mos2_gyro")).with_({"friction.film.thickness_um": 0.5})
    values = {"shear_strength_MPa": 30.0, "thickness_um": 0.4, "outer_groove_factor": 0.54}
    values |= {"preload_N": 8.0, "contact_angle_deg": 19.0, "inner_groove_factor": 0.53}
    changed = scene_with_values(film, values)
    arrived = {name: changed.nominal(name) for name in values}
    assert arrived == values
