"""Quadrature of the friction integral and its regularisation: order and bounds of the errors.

`values` of tests/conftest.py solves gyro_s1 with some keys changed.
"""

import numpy as np
import pytest

GAUSS = {"model__quadrature": "gauss", "model__strips": 400}


def test_equal_strips_converge_at_second_order(values):
    """With v_r = 3e-2 m/s the integrand is smooth, and equal strips are a midpoint rule."""
    v_r = {"friction__slip_regularisation_m_s": 3e-2}
    exact = values(**GAUSS, **v_r)["total_qv"]
    counts, errors = (25, 50, 100, 200), []
    for count in counts:
        qv = values(model__quadrature="strips", model__strips=count, **v_r)["total_qv"]
        errors.append(abs(qv / exact - 1.0))
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 1.9 < order < 2.1


@pytest.mark.parametrize("mu", [0.02, 0.08])
def test_equal_strips_at_small_regularisation_stay_below_their_envelope(values, mu):
    """With v_r = 1e-3 m/s there are kinks at pure-rolling points: errors fall, but not smoothly.

    A strip that contains a kink errs by its own share, some 1/n^2 of the whole, times the sharpness
    of the kink. The envelope 20/n^2 bounds the errors of docs/verification.md.
    """
    exact = values(mu=mu, **GAUSS)["total_qv"]
    for n in (20, 50, 100, 200, 400):
        v = values(mu=mu, model__quadrature="strips", model__strips=n)
        assert abs(v["total_qv"] / exact - 1.0) < 20.0 / n**2


@pytest.mark.parametrize("mu", [0.02, 0.08])
@pytest.mark.parametrize(("quadrature", "points"), [("strips", 20), ("strips", 50), ("gauss", 10)])
def test_the_error_of_qv_is_at_most_ten_times_its_stored_estimate(values, mu, quadrature, points):
    """The error is the change of QV that a fine rule makes."""
    exact = values(mu=mu, **GAUSS)["total_qv"]
    v = values(mu=mu, model__quadrature=quadrature, model__strips=points)
    assert abs(v["total_qv"] / exact - 1.0) < 10.0 * v["discretisation_error_qv"] + 1e-6


def test_heat_tends_to_mu_qv_as_the_regularisation_vanishes(values):
    """The missing heat at least halves where v_r falls to a third, and QV converges."""
    fine = {"model__strips": 400}
    v_rs = (3e-3, 1e-3, 3e-4, 1e-4, 3e-5)
    runs = [values(friction__slip_regularisation_m_s=v_r, **fine) for v_r in v_rs]
    missing = np.array([1.0 - v["friction_heat"].sum() / (0.08 * v["qv"].sum()) for v in runs])
    assert (missing[1:] < 0.5 * missing[:-1]).all()
    assert 0.0 < missing[-1] < 1e-3
    qv = np.array([v["total_qv"] for v in runs])
    changes = np.abs(qv[1:] / qv[:-1] - 1.0)
    assert changes[-1] < changes[0] and changes[-1] < 1e-3
