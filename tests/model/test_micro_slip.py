"""Elastic micro-slip of a steady state: what it takes of QV, and what is said of it."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.model.creep import (
    LOSS_OF_QV,
    NEGLIGIBLE,
    kalker_coefficients,
    micro_slip_told,
    saturation_share,
    saturation_slip,
    shear_of_pair,
)
from bearingwear.model.solve import solve


def values_of(scene, name="gyro_s1", mu=0.08, **changes):
    given = {"friction.ball_race": mu, "model.contact": "hertz", "model.micro_slip": True}
    asked = scene(name, given | changes)
    return asked, solve(asked, "steady").values


def test_kalkers_table():
    assert kalker_coefficients(0.3, 0.25) == pytest.approx((3.44, 2.75, 0.715))
    assert kalker_coefficients(1.0, 0.5) == pytest.approx((5.20, 3.98, 1.63))
    for ratio in (0.1, 0.35, 0.8):  # without Poisson's effect both directions are alike
        c11, c22, _ = kalker_coefficients(ratio, 0.0)
        assert c11 == c22
    # the limit of a long ellipse, pi^2/4 over 1 - nu, and pi^2/4
    c11, c22, _ = kalker_coefficients(0.01, 0.25)
    assert_allclose([c11, c22], np.pi**2 / 4 * np.array([1.0 / 0.75, 1.0]), rtol=0.04)


def test_shear_of_like_bodies(scene):
    steel = scene("gyro_s1").materials["bearing_steel"]
    G, nu = shear_of_pair(steel, steel)
    assert_allclose([G, nu], [208e9 / 2.6, 0.3], rtol=1e-12)


def test_takes_of_gyro_s1(scene):
    """2 to 5 % of QV, a tenth of the inner contact's, more with more friction; tends to none."""
    lost = []
    for mu in (0.02, 0.05, 0.08, 0.11):
        _, v = values_of(scene, mu=mu)
        lost.append(1.0 - v["micro_slip_total_qv_ratio"])
    assert lost == sorted(lost)
    assert 0.02 < lost[1] < lost[2] < 0.05
    _, v = values_of(scene)
    assert 0.08 < 1.0 - v["micro_slip_qv_ratio"][0, 0] < 0.12
    _, v = values_of(scene, mu=1e-3)
    assert abs(1.0 - v["micro_slip_total_qv_ratio"]) < 2e-3


def test_changes_nothing_else(scene):
    _, asked = values_of(scene)
    plain = solve(scene("gyro_s1", {"model.contact": "hertz"}), "steady").values
    assert not any(name.startswith("micro_slip") for name in plain)
    for name, value in plain.items():
        assert_allclose(asked[name], value, rtol=0.0, atol=0.0)


def test_estimates(scene):
    """The estimate after the solve, by its loads and slip; the one before is rather too large."""
    compared = 0
    for name in ("gyro_s1", "turbopump", "bearing218"):
        for mu in (0.05, 0.08, 0.11):
            s, v = values_of(scene, name, mu)
            load, major, qv = (v[k][0] for k in ("contact_load", "semi_major_axis", "qv"))
            slips = [
                saturation_slip(s, sigma, *row)
                for sigma, *row in zip((-1.0, 1.0), load, major, strict=True)
            ]
            share = (np.array(slips) * load).sum() / qv.sum()
            lost = 1.0 - v["micro_slip_total_qv_ratio"]
            if share > NEGLIGIBLE:
                compared += 1
                assert 0.4 < lost / (LOSS_OF_QV * share) < 1.3
            assert share < saturation_share(s) < 4.0 * share
            assert lost < LOSS_OF_QV * saturation_share(s)
    assert compared >= 6


def test_is_named_where_it_matters(scene):
    def said(**changes):
        return micro_slip_told(scene("gyro_s1", {"model.contact": "hertz"} | changes))

    assert "model.micro_slip: true" in said()
    assert said(**{"friction.ball_race": 1e-3}) is None
    assert "evaluated" in said(**{"model.micro_slip": True})
    assert micro_slip_told(scene("gyro_s1", {"model.contact": "paper"})) is None
    told = json.loads(solve(scene("gyro_s1", {"model.contact": "hertz"})).attrs["modelled"])
    assert said() in told


def test_nothing_rolls(scene):
    """Races that turn together: no rolling, so no micro-slip either."""
    s, v = values_of(scene, **{"operation.outer_speed_rpm": 30000.0})
    assert np.isnan(saturation_share(s))
    assert v["status"] != 0 or np.isfinite(v.get("micro_slip_total_qv_ratio", 1.0))
