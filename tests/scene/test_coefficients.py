"""The table of measured coefficients, its page, and the scenes that take it."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import ROOT, benchmark, numbers_in, scene_file

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.strict_yaml import data_of
from bearingwear.scene.coefficients import (
    M2_PER_N,
    MEASURED_WEAR,
    MOS2_WEAR,
    NEAREST,
    NITRIDE,
    RUBBING,
    STEEL,
)
from bearingwear.scene.new.scene_file import scene_text
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.bearing.films import Films

coefficients_page = benchmark("coefficients_page")


def test_printed_wear_becomes_square_metres_per_newton():
    """1 mm3/(N m) = (1e-3 m)^3/(N m) = 1e-9 m2/N."""
    assert_allclose(M2_PER_N, (1e-3) ** 3, rtol=1e-15)
    # PTFE, 6e-4 mm3/(N m) by its authors
    assert_allclose(M2_PER_N * MEASURED_WEAR["ptfe"].wear[0], 6e-13)
    in_air = [M2_PER_N * MEASURED_WEAR[name].wear[1] for name in ("akron", "akron_hot")]
    assert_allclose(in_air, [6.2e-16, 1.15e-15])


def test_the_page_is_that_of_the_table():
    text = (ROOT / "docs/coefficients.md").read_text(encoding="utf-8")
    again = "run: python benchmarks/coefficients_page.py docs/coefficients.md"
    assert coefficients_page.page_of_coefficients() == text, again


@pytest.mark.parametrize("name", MEASURED_WEAR)
def test_each_row_has_a_source_and_its_ends_in_order(name):
    row = MEASURED_WEAR[name]
    assert row.url.startswith("https://") and row.source and row.conditions
    # what was opened; nothing is known by recollection alone
    assert row.read in ("abstract", "text", "page", "table", "examples")
    ends = [end for end in (*row.wear, *row.friction) if not math.isnan(end)]
    assert ends and all(end > 0.0 for end in ends)
    assert not row.wear[0] > row.wear[1] and not row.friction[0] > row.friction[1]


@pytest.mark.parametrize(
    "surface, name, material",
    [
        ("races and balls of the study", "gyro_s1", "bearing_steel"),
        ("silicon nitride on steel", "turbopump", "silicon_nitride"),
        ("phenolic cage on steel", "gyro_s1", "phenolic"),
        ("steel cage", "turbine", "cage_steel"),
    ],
)
def test_coefficients_without_a_source_are_listed_as_assumed(surface, name, material):
    """Each stands in the list with what its scenes take, and no row of the table claims it."""
    (assumed,) = (entry for entry in coefficients_page.ASSUMED if entry.surface == surface)
    properties = load_scene(scene_file(name)).materials[material]
    K = properties.wear_coefficient / (1e9 * properties.brinell_hardness_GPa)
    assert_allclose(assumed.wear, K, rtol=0.02)
    assert name in assumed.taken_by and assumed.why
    ends = [M2_PER_N * end for row in MEASURED_WEAR.values() for end in row.wear]
    assert not np.isclose(ends, K, rtol=0.05, atol=0.0).any()


@pytest.mark.parametrize("lubrication, balls", [*RUBBING, ("oil", STEEL), ("grease", NITRIDE)])
def test_a_scene_has_the_coefficients_of_its_lubrication_with_their_spread(lubrication, balls):
    """Values agree within 3 %, as files and lines have two digits."""
    coefficients = RUBBING[NEAREST.get(lubrication, lubrication), balls]
    assert set(coefficients.rows) <= MEASURED_WEAR.keys()
    text, assumptions = scene_text(
        "a", None, None, {"operation.shaft_speed_rpm": 9000.0}, balls, designation="7008C",
        lubrication=lubrication,
    )  # fmt: skip
    (line,) = [line for line in assumptions if line.startswith("lubrication: ")]
    assert lubrication in line and float(f"{coefficients.wear.median:.2g}") in numbers_in(line)
    assert ("at least" in line) == ("nesc_r4" in coefficients.rows[0])
    assert ("no source" in line) == (lubrication in NEAREST)
    assert f"docs/coefficients.md: {', '.join(coefficients.rows)}" in text
    scene = scene_from_dict(data_of(text, "a"), "a")
    films = Films.of(scene)
    for part in (films.race, films.ball)[: 1 if films.race.film else 2]:  # the film is on the races
        assert_allclose((part.film or part.substrate).factor, coefficients.wear.median, rtol=0.03)
    spread = scene.uncertainty["wear_coefficient"]
    assert_allclose(spread.factor, coefficients.wear.factor, rtol=0.02)
    if lubrication != "mos2":
        assert scene.friction.ball_race == coefficients.friction.median
    else:
        assert scene.friction.ball_race is None and scene.friction.film.thickness_um == 0.6
        assert len(scene.friction.film.wear_table) == 6
        assert scene_from_dict(scene.to_dict(), "a") == scene


def test_a_scene_without_a_lubrication_states_its_assumed_wear():
    """7.6e-16 m2/N, in the scene and in a line that names the option which replaces it."""
    text, lines = scene_text("a", None, None, {}, designation="7008C")
    (line,) = [line for line in lines if line.startswith("lubrication: ")]
    assert "assumed" in line and 7.6e-16 in numbers_in(line) and "--lubrication" in line
    steel = scene_from_dict(data_of(text, "a"), "a").materials["bearing_steel"]
    assert_allclose(steel.wear_coefficient / (1e9 * steel.brinell_hardness_GPa), 7.6e-16, rtol=0.01)


def test_the_spread_has_ninety_percent_between_the_measured_ends():
    """The normal distribution has 5 % above 1.6449 standard deviations."""
    mos2 = RUBBING["mos2", STEEL].wear
    ends = [mos2.median * mos2.factor ** (sign * 1.6449) for sign in (-1, 1)]
    assert_allclose(ends, MOS2_WEAR, rtol=1e-6)


def test_a_lubrication_without_measured_coefficients_is_refused():
    speed = {"operation.shaft_speed_rpm": 9000.0}
    with pytest.raises(SceneError, match="--ball-material: got silicon_nitride, expected bearing"):
        scene_text("a", 40, 68, speed, "silicon_nitride", lubrication="dry")


def test_a_friction_beside_that_of_a_film_is_refused():
    given = {"operation.shaft_speed_rpm": 9000.0, "friction.ball_race": 0.1}
    with pytest.raises(SceneError, match="--friction: got 0.1; only allowed"):
        scene_text("a", 40, 68, given, lubrication="mos2")


def test_the_projects_scene_with_a_film_wears_as_its_measured_rows_say():
    """Its film has the geometric mean of two tests in vacuum, its substrate a value of dry steel.

    The film's is compared to 1 %: the file has two digits of it, 7.9, which are right to 0.6 %.
    """
    scene = load_scene(ROOT / "config/scenes/mos2_gyro.yaml")
    race = Films.of(scene).race
    measured = MEASURED_WEAR["bearing_in_vacuum"].wear[1], MEASURED_WEAR["two_discs"].wear[1]
    assert_allclose(race.film.factor, M2_PER_N * np.sqrt(np.prod(measured)), rtol=0.01)
    least, largest = MEASURED_WEAR["archard"].wear
    assert M2_PER_N * least <= race.substrate.factor <= M2_PER_N * largest
