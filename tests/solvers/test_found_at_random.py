"""Random scenes that once failed, kept as they were drawn."""

from pathlib import Path

import pytest
from support import ROOT

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.scene.read import load_scene
from bearingwear.scene.strict_yaml import data_of, text_of
from workflow.studies.robustness.draw import drawn_scene
from workflow.studies.robustness.run import solved_values, violations

SOURCE = Path(__file__).with_name("found_at_random.yaml")
FOUND = data_of(text_of(SOURCE), SOURCE.name)
BASE = load_scene(ROOT / "config" / "scenes" / "gyro_s1.yaml").to_dict()


@pytest.mark.parametrize("found", FOUND, ids=lambda found: found["why"].replace(" ", "-"))
def test_ends_as_it_should(found):
    scene = drawn_scene(BASE, found["draw"])
    values = solved_values(scene, found["fidelity"])
    assert STATUS_NAMES[values["status"]] == found["status"]
    if found["status"] == "ok":
        assert violations(scene, found["fidelity"], values) == []
    if "states" in found:
        assert values["steady_state_count"] == found["states"]
