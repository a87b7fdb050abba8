"""The posterior of friction and K_s/H against closed forms, a published example, and batches."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import multivariate_normal, norm

from bearingwear.applications.calibrate.posterior import (
    Normal,
    Observation,
    Prior,
    conformities,
    posterior,
)

KNOWN = Normal(0.0, 0.0)
SHORT, LONG = [2.5e8, 2.4e8, 2.7e8], [3.1e8, 3.4e8, 3.8e8, 5.1e8]


def constant(life):
    """The model of a bearing whose life does not depend on friction."""
    return lambda x: np.full(len(x), math.log(life))


def seen(value, model, scatter, **known):
    return Observation(seen=math.log(value), model=model, scatter=scatter, **known)


def handbook():
    """Scatter, prior mean and deviation of log life in the examples of ESA's NRPM handbook.

    github.com/paulremo/NRPMHandbook, 02_NRPMHandbook/mechanical/handbook/reliability_prediction/
    structural_models_equations.md and examples.md. What is misprinted there is listed in
    docs/theory/24-calibration.md; the variance of the product is the one that it computes.
    """
    volume, K, work, theta = (6e-8, 0.2), (4e-15, 0.6), (0.033, 0.1), (1.2, 0.2)
    mean = K[0] * work[0] * (1.0 + K[1] * work[1])
    variance = (K[0] * work[0]) ** 2 * ((1.0 + K[1] ** 2) * (1.0 + work[1] ** 2) - 1.0)
    logs = [math.log(1.0 + c * c) for c in (volume[1], math.sqrt(variance) / mean, theta[1])]
    k = volume[0] / mean
    middle = math.log(k) - math.log(theta[0]) + 0.5 * (logs[2] - logs[0] + logs[1])
    return math.sqrt(logs[0] + logs[1]), middle, math.sqrt(logs[2])


def test_seven_lives_of_the_handbook():
    scatter, middle, deviation = handbook()
    assert_allclose([scatter, middle, deviation], [0.57121, 19.83775, 0.198042], rtol=2e-6)
    model = constant(math.exp(middle))
    tests = [seen(life, model, scatter) for life in SHORT + LONG]
    estimate = posterior(Prior(KNOWN, Normal(0.0, deviation)), tests).normal("y")
    assert_allclose([middle - estimate.mean, estimate.deviation], [19.71927, 0.145942], rtol=4e-6)
    # its conjugate closed form
    precise = 1.0 / deviation**2 + 7.0 / scatter**2
    logs = np.log(SHORT + LONG).sum()
    closed = (middle / deviation**2 + logs / scatter**2) / precise
    assert_allclose(
        [middle - estimate.mean, estimate.deviation], [closed, precise**-0.5], rtol=1e-6
    )


def test_run_outs_of_the_handbook():
    scatter, middle, deviation = handbook()
    model = constant(math.exp(middle))
    tests = [seen(life, model, scatter) for life in SHORT]
    tests.append(seen(5.1e8, model, scatter, censored=True, count=17))
    estimate = posterior(Prior(KNOWN, Normal(0.0, deviation)), tests).normal("y")
    assert_allclose([middle - estimate.mean, estimate.deviation], [20.23302, 0.125269], rtol=4e-6)


def test_two_lives_by_dense_quadrature():
    """ln K ~ N(0, 1), lives 100/K exp(0.3 e) h, of which 40 and 55 h were seen."""
    model = constant(100.0)
    estimate = posterior(
        Prior(KNOWN, Normal(0.0, 1.0)), [seen(t, model, 0.3) for t in (40.0, 55.0)]
    )
    K = np.exp(estimate.y)[None]
    mean = estimate.expectation(K)
    assert_allclose(mean, 2.10853655, rtol=5e-9)
    assert_allclose(math.sqrt(estimate.expectation((K - mean) ** 2)), 0.44230459, rtol=2e-8)
    assert_allclose(estimate.quantile(model, 0.1, 0.3), 30.3630596, rtol=2e-9)
    L10 = 0.3 * norm.ppf(0.1)
    ends = [estimate.median_quantile(model, p, L10) for p in (0.05, 0.95)]
    assert_allclose(ends, [23.4509492, 46.4126662], rtol=2e-9)


def test_friction_and_wear_together_are_normal():
    """Life goes as mu^2/K, torque as mu: a linear model, whose posterior is known."""
    x, y = Normal(math.log(0.08), 0.2), Normal(0.1, 1.1)
    tests = [
        seen(7.0, lambda x: 2.0 * x + 7.0, 0.3, count=2),
        seen(0.011, lambda x: x - 2.0, 0.1, depends_on_wear=False),
    ]
    estimate = posterior(Prior(x, y), tests)
    design = np.array([[2.0, -1.0], [2.0, -1.0], [1.0, 0.0]])
    weight = np.diag([0.3**-2, 0.3**-2, 0.1**-2])
    prior = np.diag([0.2**-2, 1.1**-2])
    seen_less = np.array([math.log(7.0) - 7.0] * 2 + [math.log(0.011) + 2.0])
    covariance = np.linalg.inv(prior + design.T @ weight @ design)
    mean = covariance @ (prior @ [x.mean, y.mean] + design.T @ weight @ seen_less)
    assert_allclose(estimate.normal("x"), [mean[0], covariance[0, 0] ** 0.5], rtol=1e-6)
    assert_allclose(estimate.normal("y"), [mean[1], covariance[1, 1] ** 0.5], rtol=1e-6)
    rho = covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1])
    assert_allclose(estimate.correlation(), rho, rtol=1e-6)
    # what the first tests leave, with its correlation, is what the last one starts from
    for first, last in ((tests[:1], tests[1:]), (tests[1:], tests[:1])):
        half = posterior(Prior(x, y), first)
        both = posterior(Prior(half.normal("x"), half.normal("y"), half.correlation()), last)
        for axis in "xy":
            assert_allclose(both.normal(axis), estimate.normal(axis), rtol=1e-6)
        assert_allclose(both.correlation(), rho, rtol=1e-6)
    # the life of another bearing is lognormal
    deviation = math.sqrt(np.array([2.0, -1.0]) @ covariance @ [2.0, -1.0] + 0.3**2)
    middle = 2.0 * mean[0] + 7.0 - mean[1]
    ends = [math.exp(middle + z * deviation) for z in norm.ppf([0.05, 0.95])]
    life = tests[0].model
    assert_allclose([estimate.quantile(life, p, 0.3) for p in (0.05, 0.95)], ends, rtol=1e-6)


@pytest.mark.parametrize("censored", [False, True])
def test_intervals_cover_what_they_say(censored):
    """200 batches, drawn as the prior has them, of three bearings; or stopped at some time."""
    random = np.random.default_rng(5)
    prior, scatter, model = Normal(0.0, 1.0), 0.3, constant(100.0)
    inside = {"batch": 0, "bearing": 0}
    for _ in range(200):
        K = math.exp(random.normal())
        lives = 100.0 / K * np.exp(scatter * random.normal(size=4))
        stop = 100.0 * math.exp(0.5 * random.normal()) if censored else np.inf
        tests = [
            seen(min(life, stop), model, scatter, censored=bool(life > stop)) for life in lives[:3]
        ]
        estimate = posterior(Prior(KNOWN, prior), tests)
        low, high = (estimate.median_quantile(model, p) for p in (0.05, 0.95))
        inside["batch"] += low < 100.0 / K < high
        low, high = (estimate.quantile(model, p, scatter) for p in (0.05, 0.95))
        inside["bearing"] += low < lives[3] < high
    # of 180 expected; the binomial deviation is 4.2
    assert all(170 <= count <= 190 for count in inside.values()), inside


def test_tests_that_disagree_are_unlikely():
    prior, model = Normal(0.0, 1.1), constant(100.0)
    agree = [seen(t, model, 0.3) for t in (90.0, 110.0)]
    assert (
        min(conformity.probability for conformity in conformities(Prior(KNOWN, prior), agree)) > 0.1
    )
    # with one another, and with the prior: each alone
    third = conformities(Prior(KNOWN, prior), [*agree, seen(1000.0, model, 0.3)])[2]
    assert third.probability < 1e-6
    (far,) = conformities(Prior(KNOWN, prior), [seen(100.0 * math.exp(4.0), model, 0.3)])
    assert_allclose(far.probability, 2.0 * norm.sf(4.0 / math.hypot(1.1, 0.3)), rtol=1e-6)
    assert_allclose(far.factor, math.exp(4.0), rtol=1e-9)
    (long,) = conformities(Prior(KNOWN, prior), [seen(1e4, model, 0.3, censored=True)])
    assert_allclose(long.probability, norm.sf(math.log(100.0) / math.hypot(1.1, 0.3)), rtol=1e-6)


def test_quantiles_after_a_run_out_are_those_of_a_skew_normal():
    """Closed form: P(y < q | survived) of two normals, of which one is y.

    A lognormal with the same mean and deviation has its upper end 16 % too high.
    """
    prior, scatter, life, run_out = math.log(3.0), math.log(1.3), 1.4, 2.0
    test = seen(run_out, constant(life), scatter, censored=True)
    estimate = posterior(Prior(KNOWN, Normal(0.0, prior)), [test])
    ends = estimate.axis_quantiles("y", (0.05, 0.95))
    # y + scatter e < ln(life/run-out) has happened
    wide = math.hypot(prior, scatter)
    k = math.log(life / run_out)
    both = multivariate_normal(cov=[[prior**2, prior**2], [prior**2, wide**2]])
    below = [both.cdf([q, k]) / norm.cdf(k / wide) for q in ends]
    assert_allclose(below, [0.05, 0.95], rtol=1e-6)
    carried = estimate.normal("y")
    assert carried.mean + norm.ppf(0.95) * carried.deviation > ends[1] + 0.1
    assert estimate.axis_quantiles("x", (0.05, 0.95)) == [0.0, 0.0]


def test_two_lives_shrink_the_interval_as_theory_has_it():
    """From the factor 3 of the scenes: L10 of a batch 37-fold before, 1.8-fold after."""
    scatter, prior = math.log(1.3), Normal(0.0, math.log(3.0))
    model = constant(10.0)
    ends = [-1.6448536, 1.6448536]

    def fold(tests):
        estimate = posterior(Prior(KNOWN, prior), tests)
        low, high = (estimate.median_quantile(model, norm.cdf(z)) for z in ends)
        return high / low

    assert_allclose(fold([]), math.exp((ends[1] - ends[0]) * prior.deviation), rtol=1e-5)
    assert_allclose(fold([]), 37.0, rtol=0.01)
    left = (prior.deviation**-2 + 2.0 / scatter**2) ** -0.5
    two = [seen(t, model, scatter) for t in (8.0, 11.0)]
    assert_allclose(fold(two), math.exp((ends[1] - ends[0]) * left), rtol=1e-5)
    assert_allclose(fold(two), 1.83, rtol=0.01)
