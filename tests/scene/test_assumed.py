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
    "changes, no_longer_assumed",
    [
        ("", set()),
        ("bearing.ball_count: 14", {"bearing.ball_count"}),
        ("materials.steel: {poisson_ratio: 0.3}", {key for key in MARKED if "steel" in key}),
        ("bearing.ball: 1", set()),
    ],
)
def test_comments_mark_assumed_values(tmp_path, changes, no_longer_assumed):
    """A comment marks the key of its line, the key on the next line, or its whole block.

    A file based on the scene has its marks, but for the keys that it changes itself.
    """
    base, scene = tmp_path / "base.yaml", tmp_path / "mine.yaml"
    base.write_text(SCENE)
    based_on_it = f"name: mine\nbased_on: base\nset:\n  {changes}\n"
    scene.write_text(based_on_it if changes else SCENE)
    assert assumed_keys(scene) == MARKED - no_longer_assumed
