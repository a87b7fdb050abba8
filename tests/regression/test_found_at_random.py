"""Random scenes that once failed, kept as they were drawn."""

from pathlib import Path

import pytest
from support import ROOT

from bearingwear.io.strict_yaml import data_of, text_of
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.study import stress
from bearingwear.study.extremes import ExtremesPlan

SOURCE = Path(__file__).with_name("found_at_random.yaml")
FOUND = data_of(text_of(SOURCE), SOURCE.name)
BASE = ExtremesPlan.from_file(ROOT / "config" / "extremes.yaml").base(ROOT / "config" / "scenes")


@pytest.mark.parametrize("found", FOUND, ids=lambda found: found["why"].replace(" ", "-"))
def test_ends_as_it_should(found):
    scene = stress.scene_of(BASE, found["draw"])
    values = stress.solved_values(scene, found["tier"])
    assert STATUS_NAMES[values["status"]] == found["status"]
    if found["status"] == "ok":
        assert stress.wrongs(scene, found["tier"], values) == []
    if "states" in found:
        assert values["steady_state_count"] == found["states"]
