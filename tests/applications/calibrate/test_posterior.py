"""The posterior of friction and K_s/H against closed forms, a published example, and batches."""

import math
from typing import NamedTuple

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
FAILED_FIRST = [2.5e8, 2.4e8, 2.7e8]  # lives of the handbook's first three units [revolutions]
FAILED_LATER = [3.1e8, 3.4e8, 3.8e8, 5.1e8]  # lives of four others [revolutions]
PROBABILITY_ENDS = (0.05, 0.95)


def constant(life):
    """Returns the model of a bearing whose life does not depend on friction."""
    return lambda x: np.full(len(x), math.log(life))


def observation(value, model, scatter, **fields):
    """Returns the observation of a life or torque, in the unit of its model."""
    return Observation(seen=math.log(value), model=model, scatter=scatter, **fields)


class Handbook(NamedTuple):
    """Log life in the examples of ESA's NRPM handbook."""

    scatter: float
    log_median: float  # before tests
    deviation: float  # of the median, before tests

    @property
    def prior(self):
        """Returns the distribution before tests: a known friction, and an uncertain median."""
        return Prior(KNOWN, Normal(0.0, self.deviation))

    @property
    def model(self):
        """Returns the model whose life is the median."""
        return constant(math.exp(self.log_median))


def handbook():
    """Returns log life in the examples of ESA's NRPM handbook, from the inputs printed there.

    github.com/paulremo/NRPMHandbook, 02_NRPMHandbook/mechanical/handbook/reliability_prediction/
    structural_models_equations.md and examples.md. Its misprints are listed in
    docs/theory/24-calibration.md; the variance of the product is the one that it computes.
    """
    # each with its coefficient of variation
    volume, K, work, theta = (6e-8, 0.2), (4e-15, 0.6), (0.033, 0.1), (1.2, 0.2)
    mean = K[0] * work[0] * (1.0 + K[1] * work[1])
    variance = (K[0] * work[0]) ** 2 * ((1.0 + K[1] ** 2) * (1.0 + work[1] ** 2) - 1.0)
    log_variances = [
        math.log(1.0 + c * c) for c in (volume[1], math.sqrt(variance) / mean, theta[1])
    ]
    log_median = math.log(volume[0] / mean) - math.log(theta[0])
    log_median += 0.5 * (log_variances[2] - log_variances[0] + log_variances[1])
    return Handbook(
        scatter=math.sqrt(log_variances[0] + log_variances[1]),
        log_median=log_median,
        deviation=math.sqrt(log_variances[2]),
    )


def test_the_posterior_of_seven_lives_is_that_of_the_handbook():
    """The tolerances are those of the digits that it prints."""
    example = handbook()
    assert_allclose(example, [0.57121, 19.83775, 0.198042], rtol=2e-6)
    lives = FAILED_FIRST + FAILED_LATER
    tests = [observation(life, example.model, example.scatter) for life in lives]
    estimate = posterior(example.prior, tests).normal("y")
    log_median = example.log_median - estimate.mean
    assert_allclose([log_median, estimate.deviation], [19.71927, 0.145942], rtol=4e-6)


def test_the_posterior_of_seven_lives_is_that_of_conjugate_normals():
    example = handbook()
    lives = FAILED_FIRST + FAILED_LATER
    tests = [observation(life, example.model, example.scatter) for life in lives]
    estimate = posterior(example.prior, tests).normal("y")
    precision = 1.0 / example.deviation**2 + len(lives) / example.scatter**2
    weighted_sum = example.log_median / example.deviation**2
    weighted_sum += np.log(lives).sum() / example.scatter**2
    assert_allclose(example.log_median - estimate.mean, weighted_sum / precision, rtol=1e-6)
    assert_allclose(estimate.deviation, precision**-0.5, rtol=1e-6)


def test_the_posterior_of_lives_and_run_outs_is_that_of_the_handbook():
    """Three units failed; seventeen had not failed when the test was stopped."""
    example = handbook()
    tests = [observation(life, example.model, example.scatter) for life in FAILED_FIRST]
    tests.append(observation(5.1e8, example.model, example.scatter, censored=True, count=17))
    estimate = posterior(example.prior, tests).normal("y")
    log_median = example.log_median - estimate.mean
    assert_allclose([log_median, estimate.deviation], [20.23302, 0.125269], rtol=4e-6)


def test_moments_and_quantiles_of_wear_and_life_are_those_of_lognormal_distributions():
    """ln K and e are standard normal, and lives are 100/K exp(0.3 e) h; 40 and 55 h were observed.

    The posterior of ln K is then normal, with a mean and a variance in closed form.
    """
    model, scatter, lives = constant(100.0), 0.3, np.array([40.0, 55.0])
    variance = 1.0 / (1.0 + len(lives) / scatter**2)
    log_mean = variance * np.log(100.0 / lives).sum() / scatter**2
    tests = [observation(life, model, scatter) for life in lives]
    estimate = posterior(Prior(KNOWN, Normal(0.0, 1.0)), tests)
    K = np.exp(estimate.y)[None]
    mean, expected_mean = estimate.expectation(K), math.exp(log_mean + 0.5 * variance)
    assert_allclose(mean, expected_mean, rtol=5e-9)
    deviation = math.sqrt(estimate.expectation((K - mean) ** 2))
    assert_allclose(deviation, expected_mean * math.sqrt(math.expm1(variance)), rtol=2e-8)
    log_median, L10 = math.log(100.0) - log_mean, scatter * norm.ppf(0.1)
    expected = math.exp(log_median + norm.ppf(0.1) * math.hypot(math.sqrt(variance), scatter))
    assert_allclose(estimate.quantile(model, 0.1, scatter), expected, rtol=2e-9)
    ends = [estimate.median_quantile(model, p, L10) for p in PROBABILITY_ENDS]
    expected_ends = np.exp(log_median + L10 + norm.ppf(PROBABILITY_ENDS) * math.sqrt(variance))
    assert_allclose(ends, expected_ends, rtol=2e-9)


class LinearExample:
    """Tests whose log results are linear in x and y, so that the posterior is a known normal one.

    A life of two bearings goes as mu^2/K, and a torque as mu.
    """

    x, y = Normal(math.log(0.08), 0.2), Normal(0.1, 1.1)
    life = observation(7.0, lambda x: 2.0 * x + 7.0, 0.3, count=2)
    torque = observation(0.011, lambda x: x - 2.0, 0.1, depends_on_wear=False)
    slopes = np.array([[2.0, -1.0], [2.0, -1.0], [1.0, 0.0]])
    weights = np.diag([0.3**-2, 0.3**-2, 0.1**-2])
    prior_precision = np.diag([0.2**-2, 1.1**-2])
    shifted_results = np.array([math.log(7.0) - 7.0] * 2 + [math.log(0.011) + 2.0])
    covariance = np.linalg.inv(prior_precision + slopes.T @ weights @ slopes)
    mean = covariance @ (prior_precision @ [x.mean, y.mean] + slopes.T @ weights @ shifted_results)
    deviations = np.sqrt(np.diag(covariance))
    correlation = covariance[0, 1] / deviations.prod()


def check_linear_example(estimate):
    """Checks a posterior against that of `LinearExample`."""
    expected = LinearExample
    assert_allclose(estimate.normal("x"), [expected.mean[0], expected.deviations[0]], rtol=1e-6)
    assert_allclose(estimate.normal("y"), [expected.mean[1], expected.deviations[1]], rtol=1e-6)
    assert_allclose(estimate.correlation(), expected.correlation, rtol=1e-6)


def test_the_posterior_of_a_linear_model_is_that_of_normal_distributions():
    example = LinearExample
    check_linear_example(posterior(Prior(example.x, example.y), [example.life, example.torque]))


@pytest.mark.parametrize("names", [("life", "torque"), ("torque", "life")])
def test_a_posterior_is_the_prior_of_further_tests(names):
    first, second = (getattr(LinearExample, name) for name in names)
    earlier = posterior(Prior(LinearExample.x, LinearExample.y), [first])
    prior = Prior(earlier.normal("x"), earlier.normal("y"), earlier.correlation())
    check_linear_example(posterior(prior, [second]))


def test_quantiles_of_the_life_of_another_bearing_are_lognormal():
    example = LinearExample
    estimate = posterior(Prior(example.x, example.y), [example.life, example.torque])
    slopes = np.array([2.0, -1.0])
    deviation = math.sqrt(slopes @ example.covariance @ slopes + example.life.scatter**2)
    log_median = slopes @ example.mean + 7.0
    expected = np.exp(log_median + norm.ppf(PROBABILITY_ENDS) * deviation)
    model, scatter = example.life.model, example.life.scatter
    quantiles = [estimate.quantile(model, p, scatter) for p in PROBABILITY_ENDS]
    assert_allclose(quantiles, expected, rtol=1e-6)


@pytest.mark.parametrize("censored", [False, True])
def test_90_percent_intervals_contain_90_percent_of_batches_and_bearings(censored):
    """In each of 200 random batches, three bearings are tested and a fourth one is predicted.

    If censored, a test is stopped at a random time.
    """
    random = np.random.default_rng(5)
    prior, scatter, model = Normal(0.0, 1.0), 0.3, constant(100.0)
    batch_count = bearing_count = 0
    for _ in range(200):
        median = 100.0 / math.exp(random.normal())
        lives = median * np.exp(scatter * random.normal(size=4))
        stop = 100.0 * math.exp(0.5 * random.normal()) if censored else np.inf
        tests = [
            observation(min(life, stop), model, scatter, censored=bool(life > stop))
            for life in lives[:3]
        ]
        estimate = posterior(Prior(KNOWN, prior), tests)
        low, high = (estimate.median_quantile(model, p) for p in PROBABILITY_ENDS)
        batch_count += low < median < high
        low, high = (estimate.quantile(model, p, scatter) for p in PROBABILITY_ENDS)
        bearing_count += low < lives[3] < high
    # 180 are expected, with a binomial deviation of 4.2
    assert 170 <= batch_count <= 190 and 170 <= bearing_count <= 190


WIDE_PRIOR = Prior(KNOWN, Normal(0.0, 1.1))
WIDE_MODEL = constant(100.0)


def test_tests_that_agree_are_probable_and_one_that_contradicts_them_is_not():
    agreeing = [observation(life, WIDE_MODEL, 0.3) for life in (90.0, 110.0)]
    assert all(test.probability > 0.1 for test in conformities(WIDE_PRIOR, agreeing))
    contradicting = observation(1000.0, WIDE_MODEL, 0.3)
    *_, last = conformities(WIDE_PRIOR, [*agreeing, contradicting])
    assert last.probability < 1e-6


def test_the_probability_of_a_single_life_is_that_of_its_normal_deviate():
    life = observation(100.0 * math.exp(4.0), WIDE_MODEL, 0.3)
    (conformity,) = conformities(WIDE_PRIOR, [life])
    two_sided = 2.0 * norm.sf(4.0 / math.hypot(1.1, 0.3))
    assert_allclose(conformity.probability, two_sided, rtol=1e-6)
    assert_allclose(conformity.factor, math.exp(4.0), rtol=1e-9)


def test_the_probability_of_a_run_out_is_that_of_a_longer_life():
    run_out = observation(1e4, WIDE_MODEL, 0.3, censored=True)
    (conformity,) = conformities(WIDE_PRIOR, [run_out])
    one_sided = norm.sf(math.log(1e4 / 100.0) / math.hypot(1.1, 0.3))
    assert_allclose(conformity.probability, one_sided, rtol=1e-6)


def test_quantiles_after_a_run_out_are_those_of_a_skew_normal():
    """Closed form: P(y < q | survived) of two normals, of which one is y.

    A lognormal with the same mean and deviation has its upper end 16 % too high.
    """
    deviation, scatter, life, run_out = math.log(3.0), math.log(1.3), 1.4, 2.0
    test = observation(run_out, constant(life), scatter, censored=True)
    estimate = posterior(Prior(KNOWN, Normal(0.0, deviation)), [test])
    quantiles = estimate.axis_quantiles("y", PROBABILITY_ENDS)
    # the bearing survived if y + scatter e < ln(life/run-out), e a standard normal deviate
    total_deviation = math.hypot(deviation, scatter)
    limit = math.log(life / run_out)
    joint = multivariate_normal(
        cov=[[deviation**2, deviation**2], [deviation**2, total_deviation**2]]
    )
    survival = norm.cdf(limit / total_deviation)
    probabilities = [joint.cdf([quantile, limit]) / survival for quantile in quantiles]
    assert_allclose(probabilities, PROBABILITY_ENDS, rtol=1e-6)
    normal = estimate.normal("y")
    assert normal.mean + norm.ppf(0.95) * normal.deviation > quantiles[1] + 0.1


def test_a_known_friction_has_equal_quantiles():
    estimate = posterior(Prior(KNOWN, Normal(0.0, 1.0)), [])
    assert estimate.axis_quantiles("x", PROBABILITY_ENDS) == [0.0, 0.0]


@pytest.mark.parametrize(("lives", "span"), [([], 37.0), ([8.0, 11.0], 1.83)])
def test_two_lives_shrink_the_interval_of_l10_by_theory(lives, span):
    """K_s has a factor of 3, and 1.3 within a batch; `span` is the ratio of the 95 % end to 5 %."""
    scatter, deviation = math.log(1.3), math.log(3.0)
    model = constant(10.0)
    tests = [observation(life, model, scatter) for life in lives]
    estimate = posterior(Prior(KNOWN, Normal(0.0, deviation)), tests)
    low, high = (estimate.median_quantile(model, p) for p in PROBABILITY_ENDS)
    remaining_deviation = (deviation**-2 + len(lives) / scatter**2) ** -0.5
    theory = math.exp(2.0 * norm.ppf(0.95) * remaining_deviation)
    assert_allclose(high / low, theory, rtol=1e-5)
    assert_allclose(theory, span, rtol=0.01)
