"""The search for the best preload: on lives by formulas that could deceive it, and on bearings."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from support import numbers_in

import bearingwear
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.lives.life import life
from bearingwear.measures import ENDS, LIMITED
from bearingwear.results.units import digits
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.design.best import (
    EXACT_LIFE,
    NEW_BEARING,
    QUICK_LIFE,
    SIMILAR,
    PreloadPoint,
    PreloadSearch,
)
from bearingwear.studies.design.changes import _limit_change
from bearingwear.studies.design.choice import ACTIVE, limit_margins
from bearingwear.studies.design.document.sheets import preload_document
from bearingwear.studies.design.infeasible import infeasibility_text
from bearingwear.studies.design.map import IMPRACTICAL_FLAGS, design_point
from bearingwear.studies.design.plan import DesignLimits, round_number
from bearingwear.studies.design.recommend import recommendation

STIFF = DesignLimits(axial_stiffness_N_um=20.0, at_speed_only=True)
"""The requirement of the searches on invented lives: 20 N/um at the full speed."""
NOT_CONVERGED = STATUS_NAMES.index("not_converged")
FIRST, LAST = 100.0, 1600.0
"""Preloads [N] between which the best of an invented life is computed by brute force.

The grid of the search goes from an eighth to 32 times the scene's 283 N, and contains both."""


@pytest.fixture(scope="module")
def scene():
    """Returns a bearing whose own preload sets the grid of the search; it is not solved."""
    return bearingwear.new(designation="7008C", speed=18000.0, preload=283.0)


class InventedLives:
    """A search for the best preload by invented lives, of which quick ones have errors.

    Quick lives are 1 % too short and have 2 % too little stiffness. `count` has the number of
    solves of each kind.

    life, stiffness [N/m], practical (a bool): functions of the preload [N] with a constant force. A
    life of NaN is not solved.
    other: InventedLives with a fixed position; without it, that method is not searched.
    new_over_worn: ratio of the stiffnesses of a new bearing and of a worn one.
    """

    def __init__(
        self,
        scene,
        life,
        stiffness=lambda p: 1e9,
        practical=lambda p: True,
        other=None,
        new_over_worn=1.0,
    ):
        self.life, self.stiffness, self.practical, self.other = life, stiffness, practical, other
        self.new_over_worn = new_over_worn
        self.count = dict.fromkeys((NEW_BEARING, QUICK_LIFE, EXACT_LIFE), 0)
        self.search = PreloadSearch(scene, STIFF, self.answers_at)
        self.line = self.search.lines[0]
        if other is None:
            self.search.lines = [self.line]

    def answers_at(self, _, jobs):
        """Returns the values of each job, as `Workers.answers_at` does.

        jobs: scene, limits, and kind of solve.
        """
        return [self.values(scene.operation, solved) for scene, _, solved in jobs]

    def values(self, operation, solved):
        """Returns the values of a design point, and counts it.

        solved: kind of solve, such as QUICK_LIFE.
        """
        self.count[solved] += 1
        preload = operation.preload_N
        invented = self if operation.preload_method == "constant_force" else self.other
        life = invented.life(preload)
        if math.isnan(life):
            return {"status": NOT_CONVERGED, "end_criterion": len(ENDS)}  # none
        is_quick = solved == QUICK_LIFE
        stiffness = invented.stiffness(preload) * (0.98 if is_quick else 1.0)
        if solved == NEW_BEARING:
            stiffness *= invented.new_over_worn
        values = dict.fromkeys(LIMITED["axial_stiffness_N_um"].extremes, stiffness)
        # one criterion ends all lives but those of `peak` at low preloads
        end_criterion = 1 if invented.life is peak and preload < 333.0 else 0
        values |= {"status": OK, "end_criterion": end_criterion}
        if solved != NEW_BEARING:
            values |= {"life": life * (0.99 if is_quick else 1.0)}
            values |= {"impractical": 0 if invented.practical(preload) else 1}
        return values

    def best_point(self):
        """Runs the search; returns the best point of the first method, or None."""
        self.search.run()
        return self.line.best(STIFF)

    def best_of_all(self):
        """Returns the longest life within the limits, at 2773 preloads that are 0.1 % apart."""
        preloads = np.geomspace(FIRST, LAST, 2773)
        allowed = [p for p in preloads if self.stiffness(p) >= 20e6 and self.practical(p)]
        return np.nanmax([self.life(p) for p in allowed])


# lives at a preload p [N], in arbitrary units


def falling(p):
    """Returns a life that is inverse to the preload, but zero up to 100 N."""
    return 1000.0 / p if p > FIRST else 0.0


def cliff(p):
    """Returns a life like `falling`, but thirty times shorter below 427 N."""
    return falling(p) / (30.0 if p < 427.0 else 1.0)


def ended_when_new(p):
    """Returns a life like `falling`, but zero below 427 N: new bearings meet a criterion there."""
    return 0.0 if p < 427.0 else falling(p)


def unsolved(p):
    """Returns a life like `falling`, but NaN below 427 N, where nothing is solved."""
    return math.nan if p < 427.0 else falling(p)


def peak(p):
    """Returns the shorter of two lives by different criteria, which are equal at 333 N."""
    return min(falling(p), 1000.0 / 333.0 * (p / 333.0) ** 1.2)


@pytest.mark.parametrize(
    "life, stiffness, active_limit",
    [
        (falling, lambda p: 20e6 * (p / 381.6) ** 1.4, "axial_stiffness_N_um"),
        (peak, lambda p: 1e9, "end_of_life"),
        (cliff, lambda p: 1e9, "none"),
        (ended_when_new, lambda p: 1e9, "none"),
        (unsolved, lambda p: 1e9, "not_solved"),
    ],
)
def test_no_allowed_preload_is_better_by_one_per_cent(scene, life, stiffness, active_limit):
    """The best of the search, by an exact life, is compared with brute force.

    Preloads of the grid are 19 % apart; 381.6 and 427 N lie between them.

    active_limit: name in `ACTIVE` of what forbids the longer lives beside the best one.
    """
    lives = InventedLives(scene, life, stiffness)
    best = lives.best_point()
    assert best.solved == EXACT_LIFE and best.is_allowed(STIFF)
    assert best.life > 0.99 * lives.best_of_all()
    assert best.life == life(best.preload) > 0.0
    assert best.preload == float(f"{best.preload:.4g}")
    assert ACTIVE[lives.search.active_limit(lives.line, best)] == active_limit
    assert lives.count[EXACT_LIFE] <= 16  # they take seconds; quick lives of a sweep take less


def test_new_bearings_show_preloads_within_a_limit_between_two_beyond_it(scene):
    """The stiffness is enough from 322 to 338 N and again from 700 N on.

    As lives are 1000/p, the narrow range is the better one. Quick lives have 2 % less stiffness:
    by them, no preload of the grid is stiff enough there.
    """

    def stiffness(p):
        return 20e6 * max(1.08 - abs(math.log(p / 330.0)) * 3.33, (p / 700.0) ** 0.5)

    lives = InventedLives(scene, falling, stiffness)
    assert lives.best_of_all() > 3.0  # of 1000/322; from 700 N on at most 1.4
    assert lives.best_point().life > 0.99 * lives.best_of_all()


def test_both_ends_of_an_allowed_range_are_found(scene):
    """250 to 326 N are allowed. Lives are longer at both ends than between, and longest at 250 N.

    The worn bearing is stiff enough from 250 N on, the new one is twice as stiff. Above 326 N
    designs are impractical.
    """

    def valley(p):
        return max((283.0 / p) ** 1.5, p / 283.0)

    def stiffness(p):
        return 20e6 * (p / 250.0) ** 0.5

    lives = InventedLives(scene, valley, stiffness, lambda p: p <= 326.0, new_over_worn=2.0)
    best = lives.best_point()
    assert best.preload < 260.0 and best.life > 0.99 * lives.best_of_all()
    assert lives.count[EXACT_LIFE] <= 20  # somewhat more than with one end


def test_a_preload_may_be_set_where_the_life_is_similar(scene):
    """These preloads begin at the cliff at 427 N, and their lives are `SIMILAR` times the best.

    The greatest is more than 5 % above the best one.
    """
    lives = InventedLives(scene, cliff)
    best = lives.best_point()
    preloads = [point.preload for point in lives.search.settable_points(lives.line)]
    assert preloads[0] >= 427.0 and cliff(preloads[-1]) >= SIMILAR * best.life
    assert preloads[-1] > 1.05 * best.preload


def test_an_impractical_preload_is_not_recommended(scene):
    """Up to 251.3 N lives are longer but designs impractical: the best is at most 1 % above."""
    lives = InventedLives(scene, falling, practical=lambda p: p > 251.3)
    best = lives.best_point()
    assert 251.3 < best.preload < 1.01 * 251.3
    assert ACTIVE[lives.search.active_limit(lives.line, best)] == "impractical"


@pytest.mark.parametrize(
    "life, stiffness, preload, active_limit, has_point_beyond",
    [
        # down to the required stiffness; the range begins at an eighth of the scene's 283 N
        (
            lambda p: 1e3 / p,
            lambda p: 20e6 * (p / 11.0) ** 1.4,
            11.0,
            "axial_stiffness_N_um",
            False,
        ),
        # at the end of the range, as lives below it are hardly longer
        (lambda p: 1e3 / (2e3 + p), lambda p: 1e9, 283.0 / 8.0, "end_of_range", True),
    ],
)
def test_a_search_goes_beyond_the_range_while_that_lengthens_the_life(
    scene, life, stiffness, preload, active_limit, has_point_beyond
):
    """The extension is taken if its lives are more than 10 % longer than that at the end.

    preload: expected best one [N], to 1 %.
    active_limit: name in `ACTIVE` of what forbids longer lives.
    has_point_beyond: whether the search names a better preload beyond the one at the end.
    """
    lives = InventedLives(scene, life, stiffness)
    best = lives.best_point()
    assert best.preload == pytest.approx(preload, rel=0.01)
    assert ACTIVE[lives.search.active_limit(lives.line, best)] == active_limit
    assert (lives.line.best_beyond_end is not None) == has_point_beyond


def why_no_preload(lives):
    """Runs a search, which must find no preload, and returns the text that says why."""
    assert lives.best_point() is None
    return infeasibility_text(lives.line.points(STIFF), STIFF, has_cases=False)


def test_the_best_stiffness_is_named_where_none_is_enough(scene):
    """The stiffness at p N is p^0.3 N/um: 15.4 at the end of the range, 32 times the 283 N."""
    why = why_no_preload(InventedLives(scene, falling, lambda p: 1e6 * p**0.3))
    assert why.startswith("axial stiffness of one bearing")
    assert numbers_in(why)[:3] == [20, 15.4, 9060]  # N/um required, N/um at best, N


def test_a_requirement_that_only_impractical_designs_meet_names_what_is_wrong_with_them(scene):
    """20 N/um are reached at 400 N, but the design is practical only up to 350 N."""
    lives = InventedLives(scene, falling, lambda p: 20e6 * p / 400.0, lambda p: p <= 350.0)
    why = why_no_preload(lives)
    assert why.startswith("axial stiffness of one bearing")
    assert why.endswith(f"impractical design: {IMPRACTICAL_FLAGS[1].replace('_', ' ')}")


def test_a_criterion_met_when_new_is_named_where_no_preload_lives(scene):
    """All lives are zero; the words are those of a criterion that is met by new bearings."""
    why = why_no_preload(InventedLives(scene, lambda p: 0.0))
    assert "criterion" in why and "new" in why


def test_no_computed_life_is_named(scene):
    why = why_no_preload(InventedLives(scene, lambda p: math.nan))
    assert why == "no life could be computed"


def test_requirements_that_cannot_be_met_together_are_named():
    """At k N the stiffness is k N/um and the power 0.1 k W.

    Of 1, 2, 3 and 4 N, only 4 N have 3.5 N/um, and only 3 N and less take no more than 0.33 W.
    """
    limits = DesignLimits(axial_stiffness_N_um=3.5, friction_power_W=0.33, at_speed_only=True)
    stiffness = LIMITED["axial_stiffness_N_um"].extremes

    def point(k):
        values = dict.fromkeys(stiffness, 1e6 * k) | {"friction_power": 0.1 * k, "status": OK}
        return PreloadPoint(float(k), values | {"life": 10.0 - k, "end_criterion": 0}, EXACT_LIFE)

    why = infeasibility_text([point(k) for k in (1, 2, 3, 4)], limits, has_cases=False)
    assert "individually" in why and "axial stiffness of one bearing" in why
    assert numbers_in(why) == [3.5, 3, 3]  # N/um required, but 3 at 3 N


def test_a_criterion_that_rules_out_what_the_requirements_allow_is_named():
    """At 5 N the pressure is 2.001 GPa, above its limit of 2 GPa, and 0.4 GPa less for each N less.

    Lives at 2 to 4 N, which have less pressure, are zero by slip of new bearings.
    """
    limits = DesignLimits(maximum_pressure_GPa=2.0, at_speed_only=True)
    slip = [*ENDS].index("gyroscopic_slip_share")

    def point(k):
        values = {name: 0.4001e9 * k for name in LIMITED["maximum_pressure_GPa"].extremes}
        values |= {"status": OK, "life": 0.0 if k < 5 else 1.0, "end_criterion": slip}
        return PreloadPoint(float(k), values, EXACT_LIFE)

    why = infeasibility_text([point(k) for k in (2, 3, 4, 5, 6)], limits, has_cases=False)
    assert "wear.end_of_life.gyroscopic_slip_share" in why and "met when" in why
    assert numbers_in(why) == [2, 2.001, 5, 2, 4]  # GPa, but more at 5 N; from 2 to 4 N
    assert "at least 2.001" in why


def test_wear_is_named_where_it_rules_out_what_new_bearings_allow():
    """A bearing at 3 N, solved when new, has 3 of 3.01 N/um and keeps 90 % of its preload.

    Those at 4 and 5 N are stiff enough, but worn keep 30 and 20 % of the 50 % that are required.
    The text is to name the preload kept, and not the stiffness that is so nearly enough at 3 N.
    """
    limits = DesignLimits(axial_stiffness_N_um=3.01, preload_kept=0.5, at_speed_only=True)
    stiffness = LIMITED["axial_stiffness_N_um"].extremes
    kept = LIMITED["preload_kept"].extremes

    def point(k, kept_share, solved):
        values = dict.fromkeys(stiffness, 1e6 * k) | dict.fromkeys(kept, kept_share)
        values |= {"status": OK, "life": 10.0, "end_criterion": 0}
        return PreloadPoint(float(k), values, solved)

    points = [point(3, 0.9, NEW_BEARING), point(4, 0.3, EXACT_LIFE), point(5, 0.2, EXACT_LIFE)]
    why = infeasibility_text(points, limits, has_cases=False)
    assert "individually" in why and "stiffness" not in why
    assert numbers_in(why)[-2:] == [30, 4]  # % of the preload kept, at 4 N


def test_the_stiffness_at_which_the_other_method_is_better(scene):
    """Lives are 9e6 p^-1.9 and 800 p^-0.4, the stiffness of both p N/um at p N.

    Each method takes the least preload, so that both live equally long if 502 N/um are required.
    This is found to 3 % between values that were tried, from half to twice the present 300 N/um.
    """
    equal = (9e6 / 800.0) ** (1.0 / 1.5)
    limits = DesignLimits(axial_stiffness_N_um=300.0, at_speed_only=True)
    other = InventedLives(scene, lambda p: 800.0 * p**-0.4, lambda p: 1e6 * p)
    lives = InventedLives(scene, lambda p: 9e6 * p**-1.9, lambda p: 1e6 * p, other=other)
    lives.search.limits = limits
    lives.search.run()
    change = _limit_change(lives.search, "axial_stiffness_N_um", 0)
    assert math.isnan(change.other_better_below) and change.tried == (150.0, 600.0)
    assert change.other_better_above == pytest.approx(equal, rel=0.03)


def test_numbers_have_as_few_digits_as_fit_between_two():
    """Numbers keep three digits, or more where the rounded one would not lie between the two."""
    assert round_number(381.62, 280.0, 396.0) == 382.0
    assert round_number(381.62, 381.0, 382.0) == 381.6
    assert round_number(1019.57, 990.0, 1100.0) == 1020.0
    assert round_number(2.8763, 2.0, 3.0) == 2.88


# bearings


def warm_bearing(speed):
    """Returns a bearing at a speed [r/min], with Hertzian contacts and a warmer inner ring."""
    warm = {"inner_ring_C": 30.0, "balls_C": 30.0, "outer_ring_C": 20.0}
    return bearingwear.new(designation="7202AC", speed=speed).with_(
        {"model.contact": "hertz"} | {f"temperature.{key}": C for key, C in warm.items()}
    )


def test_the_recommendation_is_at_the_end_of_a_steep_rise():
    """No preload from 106 to 114 N lasts 1 % longer; somewhat below, slip soon ends lives."""
    scene = warm_bearing(24000.0)
    limits = DesignLimits(axial_stiffness_N_um=2.9)
    point = recommendation(scene, limits).isel(preload_method=0)
    hours = []
    for preload in np.geomspace(106.0, 114.0, 9).tolist():
        beside = design_point(with_method(scene, PRELOAD_METHODS[0], preload), limits)
        assert beside["impractical"] == 0 and min(limit_margins(beside, limits)) > 0.0
        hours.append(beside["life"] / 3600.0)
    assert float(point["life"]) > 0.99 * max(hours)


def test_a_narrow_range_within_the_requirements_is_found_where_slip_ends_lives_above_it():
    """48 to 52 N live 0.73 h: with less, worn bearings are too soft, with more, they slip.

    Above 120 N slip ends no life, but lives are 0.35 h.
    """
    scene = warm_bearing(26400.0)
    limits = DesignLimits(axial_stiffness_N_um=2.0, maximum_pressure_GPa=1.67)
    point = recommendation(scene, limits).isel(preload_method=0)
    in_range = design_point(with_method(scene, PRELOAD_METHODS[0], 48.75), limits)
    assert min(limit_margins(in_range, limits)) > 0.0
    assert float(point["life"]) > 0.99 * in_range["life"] / 3600.0 > 0.7  # h


def test_a_required_life_that_no_preload_has_is_named():
    """10 000 h, where 0.4 h is the best with the required stiffness; both methods say why not."""
    scene = bearingwear.new(designation="7008C", speed=18000.0).with_({"model.contact": "hertz"})
    recommended = recommendation(scene, DesignLimits(system_axial_stiffness_N_um=20.0, life_h=1e4))
    assert recommended["life"].isnull().all()
    reasons = json.loads(recommended.attrs["none_because"])
    longest = recommended["longest_life"].values
    assert recommended["preload"].isnull().all() and 0.0 < longest.max() < 1e4
    for why, life_h, preload in zip(
        reasons.values(), longest, recommended["longest_preload"].values, strict=True
    ):
        # the life [h], its preload [N], the life required, the stiffness that limits it [N/um]
        assert numbers_in(why) == [float(digits(life_h)), preload, 1e4, 20.0]
    title = preload_document(recommended).title
    assert {float(digits(longest.max())), 1e4} <= {*numbers_in(title)}


def test_a_required_life_that_is_met_changes_no_recommendation():
    """0.3 h, where both methods live longer anyway: preload, life and limit are the same."""
    scene = bearingwear.new(designation="7008C", speed=18000.0).with_({"model.contact": "hertz"})
    limits = DesignLimits(system_axial_stiffness_N_um=20.0)
    free = recommendation(scene, limits)
    required = recommendation(scene, replace(limits, life_h=0.3))
    assert free["life"].values.min() > 0.3
    for name in ("preload", "life", "active_limit"):
        assert free[name].values.tolist() == required[name].values.tolist()


@pytest.mark.parametrize("bearings", [1, pytest.param(2, marks=pytest.mark.long)])
def test_the_recommended_life_of_a_film_is_that_of_life(bearings):
    """The film of a race is worn through within that life, of a single bearing and of a pair.

    With 2 % less preload a requirement is violated, so that the preload is the least.
    """
    keys = {"shear_strength_MPa": 30.0, "pressure_coefficient": 0.02, "thickness_um": 0.2}
    keys |= {"wear_coefficient": 1e-7, "bare_ball_race": 0.2}
    kind = {"arrangement.kind": "spring_pair"} if bearings == 2 else {}
    plain = bearingwear.new(designation="7001C", speed=3000.0)
    scene = plain.with_(
        {"friction.ball_race": None, "uncertainty": None, "model.contact": "hertz"}
        | {f"friction.film.{key}": value for key, value in keys.items()}
        | kind
    )
    limits = DesignLimits(system_axial_stiffness_N_um=5.0)
    point = recommendation(scene, limits).isel(preload_method=0)
    taken = with_method(scene, PRELOAD_METHODS[0], float(point["preload"]))
    values = life(taken).values
    assert float(point["life"]) == pytest.approx(float(values["life"]) / 3600.0, rel=1e-9)
    assert np.isfinite(np.asarray(values["race_film_worn_through"])).any()
    less_preloaded = with_method(scene, PRELOAD_METHODS[0], 0.98 * float(point["preload"]))
    assert min(limit_margins(design_point(less_preloaded, limits), limits)) < 0.0
