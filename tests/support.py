"""Where things are, for tests of every kind."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def scene_file(name: str) -> Path:
    """Path of a scene of the study."""
    return ROOT / "config" / "scenes" / f"{name}.yaml"
