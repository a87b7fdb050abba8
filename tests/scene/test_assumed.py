"""Assumed values are those that comments of a scene file mark."""

import pytest

from bearingwear.scene.assumed import assumed_keys

SCENE = """
bearing:
  ball_count: 15  # assumed: three quarters
  ball_diameter_mm: 8.4  # given; not assumed
  # assumed, from a rule of thumb
  pitch_diameter_mm: 54
  contact_angle_deg: 15
materials:  # assumed
  steel: {density_kg_m3: 7800, poisson_ratio: 0.3}
operation:
  preload_N: 140  # "assumed" is only a word here
"""
MARKED = {
    "bearing.ball_count",
    "bearing.pitch_diameter_mm",
    "materials.steel.density_kg_m3",
    "materials.steel.poisson_ratio",
}


@pytest.mark.parametrize(
    "text, left_out",
    [
        ("", set()),
        ("bearing.ball_count: 14", {"bearing.ball_count"}),
        ("materials.steel: {poisson_ratio: 0.3}", {key for key in MARKED if "steel" in key}),
        ("bearing.ball: 1", set()),
    ],
)
def test_comments_mark_assumed_values(tmp_path, text, left_out):
    """A comment marks the key of its line, the key on the next line, or its whole block.

    Keys that a file based on the scene sets itself (`left_out`) are not assumed any more.
    """
    base, scene = tmp_path / "base.yaml", tmp_path / "mine.yaml"
    base.write_text(SCENE)
    scene.write_text(f"name: mine\nbased_on: base\nset:\n  {text}\n" if text else SCENE)
    assert assumed_keys(scene) == MARKED - left_out
