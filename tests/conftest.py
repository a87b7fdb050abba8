"""Fixtures shared by all tests: scenes of the study, changed key by key."""

import pytest
import yaml
from support import scene_file


@pytest.fixture(scope="session")
def scene():
    """Function (name, {key: value}) -> Scene, from config/scenes."""
    from bearingwear.io.config import load_scene

    def build(name="gyro_s1", changes=None):
        # YAML's own text of a number: Python's 3e-05 would be text.
        texts = [
            f"{k}={yaml.safe_dump(v, default_flow_style=True).splitlines()[0]}"
            for k, v in (changes or {}).items()
        ]
        return load_scene(scene_file(name), texts)

    return build


@pytest.fixture(scope="session")
def values(scene):
    """Function (method, mu, loss_um, drag, **other) -> values of the solved scene gyro_s1."""
    from bearingwear.model.solve import solve

    def solved(method="constant_force", mu=0.08, loss=0.0, drag=0.0, fidelity=None, **other):
        changes = {
            "operation.preload_method": method,
            "friction.ball_race": mu,
            "wear.ball_diameter_loss_um": loss,
            "lubricant.drag_density_kg_m3": drag,
        }
        changes |= {key.replace("__", "."): value for key, value in other.items()}
        result = solve(scene("gyro_s1", changes), fidelity)
        assert result.status == "ok", result.status
        return result.values

    return solved
