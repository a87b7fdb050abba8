"""Quadrature of the friction integral and its regularisation: order and envelope."""

import numpy as np
import pytest

GAUSS = {"model__quadrature": "gauss", "model__strips": 400}


def test_equal_strips_converge_at_second_order(values):
    """Smooth integrand (v_r = 3e-2 m/s): equal strips are a midpoint rule, order 2."""
    v_r = {"friction__slip_regularisation_m_s": 3e-2}
    exact = values(**GAUSS, **v_r)["total_qv"]
    n = np.array([25, 50, 100, 200])
    errors = [
        abs(values(model__quadrature="strips", model__strips=int(k), **v_r)["total_qv"] / exact - 1)
        for k in n
    ]
    order = -np.polyfit(np.log(n), np.log(errors), 1)[0]
    assert 1.9 < order < 2.1


@pytest.mark.parametrize("mu", [0.02, 0.08])
def test_equal_strips_at_small_regularisation_stay_below_their_envelope(values, mu):
    """v_r = 1e-3 m/s: kinks at the pure-rolling points; the error falls, but not smoothly.

    Envelope: a strip that holds a kink errs by its own share, some 1/n^2 of the whole, times the
    sharpness of the kink; 20/n^2 bounds what is measured in docs/verification.md.
    """
    exact = values(mu=mu, **GAUSS)["total_qv"]
    for n in (20, 50, 100, 200, 400):
        v = values(mu=mu, model__quadrature="strips", model__strips=n)
        assert abs(v["total_qv"] / exact - 1.0) < 20.0 / n**2


@pytest.mark.parametrize("mu", [0.02, 0.08])
def test_discretisation_error_is_honest(values, mu):
    """The stored estimate is about the change of QV that a fine rule makes."""
    exact = values(mu=mu, **GAUSS)["total_qv"]
    for quadrature, n in (("strips", 20), ("strips", 50), ("gauss", 10)):
        v = values(mu=mu, model__quadrature=quadrature, model__strips=n)
        true = abs(v["total_qv"] / exact - 1.0)
        assert true < 10.0 * v["discretisation_error_qv"] + 1e-6


def test_regularisation_is_approached_linearly_or_better(values):
    """Smaller v_r: heat tends to mu QV, and QV settles."""
    fine = {"model__strips": 400}
    v_rs = (3e-3, 1e-3, 3e-4, 1e-4, 3e-5)
    runs = [values(friction__slip_regularisation_m_s=v_r, **fine) for v_r in v_rs]
    gaps = [1 - v["friction_heat"].sum() / (0.08 * v["qv"].sum()) for v in runs]
    assert all(b < 0.5 * a for a, b in zip(gaps[:-1], gaps[1:], strict=True))
    assert 0.0 < gaps[-1] < 1e-3
    changes = [
        abs(b["total_qv"] / a["total_qv"] - 1) for a, b in zip(runs[:-1], runs[1:], strict=True)
    ]
    assert changes[-1] < changes[0]
    assert changes[-1] < 1e-3
