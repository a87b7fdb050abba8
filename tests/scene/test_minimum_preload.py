"""The least preload that a maker prescribes, and the line about it on sheets."""

import itertools
from pathlib import Path

import pytest
from support import numbers_in

import bearingwear
from bearingwear.cli import main
from bearingwear.document.bearing_line import bearing_line
from bearingwear.scene.new.minimum_preload import (
    minimum_preload,
    minimum_preload_lines,
    skf_factors,
)
from bearingwear.scene.read import load_scene

GMN = {"designation": "S 6007 E", "maker": "GMN", "preload": 140.0}


def least(scene):
    """Returns the least preload of the maker of a scene's bearing; None if it is not known."""
    data = scene.to_dict()
    return minimum_preload(data["bearing"], data["operation"])


def test_gmn_minimum_preload_grows_with_the_square_of_the_relative_speed():
    """It is 715 N at the largest speed, 30 000 r/min (catalogue, p. 32).

    A counter-rotating outer ring adds its speed.
    """
    assert least(bearingwear.new(**GMN, speed=30000.0)).load == pytest.approx(715.0)
    assert least(bearingwear.new(**GMN, speed=15000.0)).load == pytest.approx(715.0 / 4.0)
    counter = bearingwear.new(**GMN, speed=15000.0).with_({"operation.outer_speed_rpm": -15000.0})
    assert least(counter).load == pytest.approx(715.0)


@pytest.mark.parametrize("series", ["72", "73"])
@pytest.mark.parametrize("suffix", ["AC", "B"])
def test_factors_of_skf_grow_with_the_size(series, suffix):
    """Each is larger than that of the next smaller size of its series, but 3.5 times at most.

    A number read from a wrong place of SKF's table would stand out.
    """
    factors = [factor for name, factor in sorted(skf_factors().items())
               if name.startswith(series) and name.endswith(suffix)]  # fmt: skip
    assert factors == sorted(factors) and len(factors) >= 8
    assert all(1.0 < factor / smaller < 3.5 for smaller, factor in itertools.pairwise(factors))


@pytest.fixture(scope="module")
def skf_7210():
    """Returns a scene with a 7210 AC, which SKF lists."""
    return bearingwear.new(designation="7210AC", preload=100.0, speed=5000.0)


def test_skf_minimum_preload_is_its_factor_times_the_square_of_the_speed(skf_7210):
    """A (n/1000)^2 kN, with A = 0.00584 for a 7210 AC in SKF's table."""
    assert least(skf_7210).load == pytest.approx(1e3 * 0.00584 * 5.0**2)


@pytest.mark.parametrize(("speed", "load"), [(5000.0, 146), (14000.0, 1140)])
def test_the_line_of_skf_states_load_speed_factor_and_preload(skf_7210, speed, load):
    scene = skf_7210.with_({"operation.shaft_speed_rpm": speed})
    (line,) = minimum_preload_lines(scene.plain)
    maker, _, numbers = line.partition("7210AC: ")
    assert "SKF" in maker
    assert numbers_in(numbers)[:3] == [load, speed, 0.00584] and numbers_in(numbers)[-1] == 100


@pytest.mark.parametrize("designation", ["7214ACB", "7205 ACCBM", "7310AC", "7217BECBP"])
def test_a_factor_that_is_missing_is_named(designation):
    """SKF's tables have these bearings, but the text does not show which factor is theirs."""
    scene = bearingwear.new(designation=designation, preload=100.0, speed=5000.0)
    (line,) = minimum_preload_lines(scene.plain)
    assert f"{scene.bearing.designation}: factor not known" in line
    assert least(scene) is None


@pytest.mark.parametrize(
    "bearing",
    [{"designation": "7010C", "maker": "NSK"}, {"designation": "608"},
     {"bore": 40.0, "outside": 68.0}],
)  # fmt: skip
def test_no_line_without_a_known_minimum_preload(bearing):
    assert minimum_preload_lines(bearingwear.new(**bearing, preload=50.0).plain) == []


LAUNCH_BLOCKS = """
arrangement: {kind: spring_pair, spring_stiffness_N_um: 1.0, rotor_mass_kg: 2.0, span_mm: 60.0}
launch: {axial_g: 5.0}
"""


@pytest.mark.parametrize(
    "command",
    [
        "check a.yaml",
        "solve a.yaml",
        "show a.yaml",
        "life a.yaml --set model.contact=hertz",
        "launch a.yaml",
        "uncertainty a.yaml --samples 8 -j 1 -o u.nc",
    ],
)
def test_the_minimum_preload_is_on_the_sheet_of_every_command(
    command, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    argv = ["new", "a.yaml", "S 6007 E", "--preload", "140", "--speed", "15000", "--maker", "GMN"]
    assert main(argv) == 0
    if command.startswith("launch"):
        with Path("a.yaml").open("a", encoding="utf-8") as file:
            file.write(LAUNCH_BLOCKS)
    capsys.readouterr()
    assert main(command.split()) == 0
    (line,) = minimum_preload_lines(load_scene(Path("a.yaml")).plain)
    # a quarter of the catalogue's 715 N at half its speed, and the preload of the scene
    assert numbers_in(line.partition("E: ")[2]) == [179, 15000, 715, 30000, 140]
    assert line in " ".join(capsys.readouterr().out.split())


def test_the_minimum_preload_is_on_the_line_of_the_bearing():
    """It is there even if the scene has no preload, as in studies."""
    data = bearingwear.new(**GMN, speed=15000.0).to_dict()
    del data["operation"]["preload_N"]
    assert "GMN minimum preload 179 N at 15000 r/min" in bearing_line(data)


def test_the_minimum_preload_is_that_of_the_fastest_case():
    fast = bearingwear.new(**GMN, speed=15000.0).with_(
        {"cases": {"slow": {"operation.shaft_speed_rpm": 1500.0},
                   "fast": {"operation.shaft_speed_rpm": 30000.0}}}
    )  # fmt: skip
    assert "GMN minimum preload 715 N at 30000 r/min" in bearing_line(fast.to_dict())
