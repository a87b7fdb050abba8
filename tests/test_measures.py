"""Each row of the table of measures appears wherever a measure has to: in keys, sheets, figures."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from matplotlib.markers import MarkerStyle
from support import scene_file

from bearingwear.arguments import command_parser
from bearingwear.document.life import _criterion_rows
from bearingwear.document.rows import row_of, rows_with_violations, variable_limits
from bearingwear.kernels.status import OK
from bearingwear.lives import many
from bearingwear.lives.ends import Criteria
from bearingwear.lives.follow import Life, Node
from bearingwear.measures import ENDS, LIMITED, MEASURES, Measure, plain
from bearingwear.results.life_variables import LIFE
from bearingwear.results.variables import CASE
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.scene.checking.records import parts
from bearingwear.scene.friction import Film
from bearingwear.scene.read import load_scene
from bearingwear.solvers.effects.criterion import criteria_of_case, end_attribute
from bearingwear.solvers.state import OF_EACH_CONTACT, State
from bearingwear.studies.design.choice import ACTIVE, limit_margins
from bearingwear.studies.design.document.sheets import SHORT_TABLE
from bearingwear.studies.design.document.words import (
    LIMIT_WORDS,
    RECOMMENDED_WORDS,
    limit_text,
)
from bearingwear.studies.design.figures.choice import LETTERS
from bearingwear.studies.design.map import POINT, values_of_states
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.grid.figures.quasistatic import END_MARKS
from bearingwear.studies.grid.interpolated import (
    Line,
    interpolable_criteria,
    interpolated_life,
)

PRELOAD = 7.0  # [N]
LIMIT = 0.5  # of any measure, in the unit of its key
LOSS = "ball_diameter_loss_um"
of_all = pytest.mark.parametrize("measure", MEASURES, ids=lambda measure: measure.key)
of_ends = pytest.mark.parametrize("name", ENDS)
of_limits = pytest.mark.parametrize("name", LIMITED)


def value_at(measure: Measure, ratio: float) -> float:
    """Returns a value [SI] of a measure's variables, `ratio` times as critical as LIMIT."""
    return measure.file_limit(LIMIT, PRELOAD) * (1.0 / ratio if measure.falls else ratio)


OF_RACES = {"gyroscopic_slip_share", "film_worn_share"}
"""Measures whose variables have a value for each race."""


def state_at(measure: Measure, ratio: float) -> State:
    """Returns a state whose values of one measure are `ratio` times as critical as LIMIT.

    Besides, it has only what every state has: a loss, and numbers of each contact.
    """
    limit_values = {name: value_at(measure, ratio) for name in measure.variables}
    limit_values |= {
        name: np.array([0.1, 1.0]) * limit_values[name] for name in OF_RACES & limit_values.keys()
    }
    of_contact = dict.fromkeys(OF_EACH_CONTACT, np.ones(2))
    return State(OK, {"ball_diameter_loss": 0.0, **of_contact, **limit_values})


def scene_with_criterion(name: str):
    """Returns a scene whose life has one criterion, with the value LIMIT."""
    scene = load_scene(scene_file("mos2_gyro" if name == "film_worn_share" else "gyro_s1"))
    scene = replace(scene, operation=replace(scene.operation, preload_N=PRELOAD))
    if name == "cage_film_worn_share":
        scene = replace(scene, cage=replace(scene.cage, film=Film(thickness_um=10.0)))
    return replace(scene, wear=replace(scene.wear, end_of_life=EndOfLife(**{name: LIMIT})))


class EndCriterion:
    """Stands for the variable `end_criterion` of an open result file."""

    flag_meanings = " ".join(CRITERIA)

    def __init__(self, name):
        self._code = CRITERIA.index(name)

    def __getitem__(self, _):
        return self._code


class File:
    """Stands for an open result file, as far as the sheets read it.

    arrays: variables by their names. end: the name of the criterion that ended the life.
    scene: the attribute `scene`, a scene as JSON.
    """

    def __init__(self, arrays, end, scene="{}"):
        self.variables, self.scene = dict(arrays), scene
        self._end = EndCriterion(end)

    def __getitem__(self, name):
        return self._end if name == "end_criterion" else np.asarray(self.variables[name])


WORSE_WHEN_LESS = {
    "preload_kept", "system_axial_stiffness_N_um", "axial_stiffness_N_um", "lowest_frequency_Hz",
    "launch_g", "life_h", "torque_margin", "thermal_margin",
}  # fmt: skip


@pytest.mark.parametrize(
    "value, digits, text",
    [(99.4, 2, "99"), (99.7, 2, "100"), (100.0, 2, "100"), (1234.0, 2, "1200"), (0.0123, 1, "0.01"),
     (1e9, 3, "1e+09"), (1.2e-27, 2, "1.2e-27")],
)  # fmt: skip
def test_only_very_large_or_small_plain_numbers_have_a_power_of_ten(value, digits, text):
    assert plain(value, digits) == text
    assert plain(value, digits, "+") == f"+{text}"


PERCENTAGES = [measure for measure in MEASURES if measure.unit == "%"]


@pytest.mark.parametrize("measure", PERCENTAGES, ids=lambda measure: measure.key)
def test_a_percentage_near_100_has_no_power_of_ten(measure):
    assert measure.text(0.9996) == measure.limit_text(0.9996) == "100 %"


@of_all
def test_margins_are_negative_beyond_the_limit(measure):
    assert measure.falls == (measure.key in WORSE_WHEN_LESS)
    limit = measure.file_limit(LIMIT, 1.0)
    assert measure.margin(limit, LIMIT) == 0.0
    below, above = measure.margin(0.9 * limit, LIMIT), measure.margin(1.1 * limit, LIMIT)
    if measure.falls:
        assert below < 0.0 < above
    else:
        assert above < 0.0 < below


@pytest.mark.parametrize(
    "measure",
    [measure for measure in MEASURES if not (measure.falls and measure.base)],
    ids=lambda measure: measure.key,
)
def test_the_excess_over_a_limit_is_the_ratio_of_value_and_limit(measure):
    """It is 2 at twice the limit, or at half of it if the measure must not fall.

    A `base` counts in value and limit, so that the ratio of a measure that has one is less.
    """
    limit = measure.file_limit(LIMIT, 1.0)
    twice_as_critical = limit / 2.0 if measure.falls else 2.0 * limit
    expected = (2.0 * LIMIT + measure.base) / (LIMIT + measure.base)
    assert measure.excess(twice_as_critical, LIMIT) == pytest.approx(expected)


@of_all
def test_every_measure_has_words_and_a_limit_or_criterion(measure):
    assert measure.words and measure.advice and measure.short and measure.variables
    assert len(measure.kinds) == len(measure.variables)
    assert measure.end or measure.limit
    assert measure.limit_text(LIMIT).endswith("" if measure.unit == "1" else measure.unit)


# what ends a life


@of_ends
def test_every_criterion_is_a_key_of_a_scene(name):
    part = parts(EndOfLife)[name]
    assert part.key.meaning and part.nullable and part.key.ends[0] == 0.0
    assert EndOfLife(**{name: LIMIT}).criteria == {name: LIMIT}
    assert CRITERIA[[*ENDS].index(name)] == name and CRITERIA[-1] == "none"


@of_ends
def test_every_criterion_has_a_margin_that_is_negative_beyond_it(name):
    """Criteria that a scene does not have, and values that are not known, have infinite margins."""
    scene = scene_with_criterion(name)
    criteria = Criteria(scene)
    for ratio, sign in ((0.9, 1.0), (1.1, -1.0)):
        computed = criteria.margins([state_at(ENDS[name], ratio)])
        k = CRITERIA.index(name)
        assert np.isinf(np.delete(computed, k)).all() and np.sign(computed[k]) == sign
    assert np.isinf(criteria.margins([State(OK, {})])).all()


@of_ends
def test_every_criterion_has_a_history_in_its_unit(name):
    units = "N" if ENDS[name].over_preload else ENDS[name].si_unit
    for variable in ENDS[name].variables:
        assert LIFE[f"history_{variable}"].units == units


@of_ends
def test_every_criterion_has_a_mark_in_figures(name):
    mark, words = END_MARKS[name]
    assert mark and MarkerStyle(mark).get_marker() == mark and ENDS[name].short in words
    assert [value for value, _ in END_MARKS.values()].count(mark) == 1


@of_ends
def test_an_interpolated_life_ends_where_its_criterion_is_met(name):
    """The loss of ball diameter is the axis of the states; the criterion is met at half of it."""
    criteria = {name: END_LOSS_UM if name == LOSS else LIMIT}
    life = interpolated_life([Line(states_over_loss(name), PRELOAD)], criteria)
    assert CRITERIA[int(life["interpolated_end_criterion"])] == name
    end_loss = float(life["interpolated_loss_at_end"])
    assert end_loss == pytest.approx(1e-6 * END_LOSS_UM, rel=1e-6)


@pytest.mark.parametrize("name", [name for name in ENDS if name not in (LOSS, "preload_fraction")])
def test_an_interpolated_life_is_unknown_without_the_variables_of_its_criterion(name):
    states, criteria = states_over_loss(name), {name: LIMIT}
    assert interpolable_criteria(criteria, states) == criteria
    without_variables = states.drop_vars(ENDS[name].variables)
    assert interpolable_criteria(criteria, without_variables) == {}
    life = interpolated_life([Line(without_variables, PRELOAD)], criteria)
    assert np.isnan(life["interpolated_life"]).all()


END_LOSS_UM = 0.35  # half of the largest loss of `states_over_loss`


def states_over_loss(name):
    """Returns states along the loss of ball diameter; half way, one meets a criterion."""
    measure, losses_um = ENDS[name], np.linspace(0.0, 2.0 * END_LOSS_UM, 8)
    distance = np.linspace(-0.5, 0.5, losses_um.size)  # beyond the limit, as a share of it
    values = value_at(measure, 1.0) * (1.0 + (-distance if measure.falls else distance))
    columns = {
        "status": np.full(losses_um.size, OK),
        "ball_diameter_loss_rate": np.full(losses_um.size, 1e-12),  # [m/s], any
        "residual_preload": np.full(losses_um.size, PRELOAD),
    }
    if name != LOSS:
        columns |= dict.fromkeys(measure.variables, values)
    variables = {variable: ("ball_diameter_loss", column) for variable, column in columns.items()}
    return xr.Dataset(variables, {"ball_diameter_loss": losses_um})


def criterion_row(name, end_ratio, arrangement):
    """Returns the row of the criterion that ended a life, for one bearing.

    end_ratio: how critical its measure is at the end, relative to the limit.
    arrangement: `single`, or `rigid_pair`, of which the other bearing may have ended the life.
    """
    measure = ENDS[name]
    histories = {
        f"history_{variable}": [value_at(measure, 0.5), value_at(measure, end_ratio)]
        for variable in measure.variables
    }
    scene = {
        "wear": {"end_of_life": {name: LIMIT}},
        "operation": {"preload_N": PRELOAD},
        "arrangement": {"kind": arrangement},
    }
    (row,) = _criterion_rows(File(histories, name), scene)
    return row


@of_ends
def test_the_sheet_of_a_life_marks_the_criterion_that_ended_it(name):
    measure, row = ENDS[name], criterion_row(name, 1.0, "single")
    assert (row.label, row.unit, row.note) == (measure.short, measure.unit, "reached first")
    assert row.limit == measure.shown_limit(LIMIT)
    assert row.values[1] == pytest.approx(row.limit)


@of_ends
def test_the_bearing_of_a_pair_that_is_within_its_limit_is_not_marked(name):
    assert criterion_row(name, 0.5, "rigid_pair").note == ""


@of_ends
def test_the_criterion_that_ended_a_life_is_stated(name):
    """`ended_by` has words, value and limit, and the kind of variable if there are several."""
    measure = ENDS[name]
    end_value = measure.file_limit(LIMIT, PRELOAD)
    values = {"history_ball_diameter_loss": np.zeros(1), "end_criterion": CRITERIA.index(name)}
    values |= {f"history_{variable}": np.array([end_value]) for variable in measure.variables}
    attributes = end_attribute(scene_with_criterion(name), values)
    limit = measure.limit_text(LIMIT)
    phrases = [f"{kind} {measure.words} {limit}, criterion {limit}" for kind in measure.kinds]
    assert attributes["ended_by"] in [phrase.strip() for phrase in phrases]


@of_ends
def test_a_case_that_violates_a_criterion_is_marked(name):
    """A row of its sheet is marked if it is 1.1 times as critical as the limit, not 0.9 times.

    The value that is compared with the criterion has a margin of 0 at the limit itself.
    """
    measure = ENDS[name]
    plain = json.dumps(scene_with_criterion(name).to_dict())
    for variable in measure.variables:
        if variable not in CASE:
            continue  # only lives have it
        for ratio, note in ((0.9, ""), (1.1, "violated")):
            file = File({variable: [value_at(measure, ratio)]}, "none", plain)
            row = row_of(variable, [value_at(measure, ratio)], variable_limits(file)[variable])
            assert [violation.note for violation in rows_with_violations([row], file)] == [note]
    end = measure.file_limit(LIMIT, PRELOAD)
    criteria = criteria_of_case(scene_with_criterion(name), dict.fromkeys(measure.variables, end))
    assert measure.margin(criteria[name][0], LIMIT) == pytest.approx(0.0)


# what limits a design


@of_limits
def test_every_limit_of_a_design_is_a_key_and_an_option(name):
    measure = LIMITED[name]
    assert parts(DesignLimits)[name].key.meaning.startswith(measure.limit[0])
    assert DesignLimits(**{name: LIMIT}).given == {name: LIMIT}
    args = command_parser().parse_args(["recommend", "a.yaml", measure.option, str(LIMIT)])
    assert getattr(args, name) == LIMIT
    assert [other.option for other in MEASURES].count(measure.option) == 1


@of_limits
def test_every_limit_of_a_design_has_words_and_a_letter_in_figures(name):
    measure = LIMITED[name]
    assert name in ACTIVE and LIMIT_WORDS[name] == measure.words
    assert measure.words in limit_text(name, LIMIT)
    assert LETTERS[name] and [*LETTERS.values()].count(LETTERS[name]) == 1
    assert set(measure.extremes) <= RECOMMENDED_WORDS.keys() & POINT.keys()
    assert measure.brief == (measure in SHORT_TABLE)


@pytest.mark.parametrize("name", [name for name in LIMITED if not LIMITED[name].of_life])
def test_a_limit_of_a_design_applies_to_the_worst_value_along_a_life(name, monkeypatch):
    """Three states are 0.9, 1.1 and 0.5 times as critical as the limit: the second violates it.

    Frequencies of a rotor, which would need a solve, are unknown. A limit of the life itself has no
    states.
    """
    unknown_frequency = "bearingwear.studies.design.condition_extremes.lowest_frequency"
    monkeypatch.setattr(unknown_frequency, lambda *_: np.nan)
    measure, scene = LIMITED[name], scene_with_criterion("skid_ratio")
    states = [state_at(measure, ratio) for ratio in (0.9, 1.1, 0.5)]
    extremes = values_of_states(scene, states)
    assert set(extremes) <= POINT.keys()
    worst = value_at(measure, 1.1) / (PRELOAD if measure.over_preload else 1.0)
    for variable in measure.extremes:
        assert extremes[variable] == pytest.approx(worst)
    (margin,) = limit_margins(extremes, DesignLimits(**{name: LIMIT}, at_speed_only=True))
    assert margin == pytest.approx(measure.margin(worst, LIMIT)) and margin < 0.0


@of_all
def test_a_measure_of_a_pair_is_that_of_its_worse_bearing(measure, monkeypatch):
    """One bearing is 1.2 times as critical as the limit and the other 0.3 times, in either order.

    The frequency of a pair, which would need a rotor, is taken to be the lower one of its states.
    """

    def lower_frequency(_rotor, states):
        return min(state["lowest_frequency"] for state in states)

    monkeypatch.setattr(many, "lowest_frequency", lower_frequency)
    rotor = SimpleNamespace(pair=SimpleNamespace(tandem=(1, 1)))
    critical_state, safe_state = state_at(measure, 1.2), state_at(measure, 0.3)
    for both in ((critical_state, safe_state), (safe_state, critical_state)):
        (worse,) = many.worse_states(Life([Node(0.0, None, both, np.zeros(2))], None), rotor)
        assert measure.critical(worse.__getitem__, 1.0) == measure.critical(
            critical_state.__getitem__, 1.0
        )


def test_a_measure_of_several_variables_is_the_worst_of_them_and_names_it():
    """Two stiffnesses have values [N/m] at two states; margins to 2.5 N/um are shares of it."""
    measure = LIMITED["axial_stiffness_N_um"]
    values = {
        "axial_stiffness": np.array([3e6, 5e6]),
        "quasistatic_axial_stiffness": np.array([4e6, 2e6]),
    }
    assert measure.critical(values.__getitem__) == (2e6, "quasistatic_axial_stiffness")
    assert measure.worst(values).tolist() == [3e6, 2e6]
    assert measure.margins(values, 2.5).tolist() == pytest.approx([0.2, -0.2])
