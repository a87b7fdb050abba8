"""A folder that is a study of one scene: `bearingwear study mine.yaml -o mine`.

The command writes its configuration and a copy of the scene. The first line of each file says so
and holds a hash of the rest, so that what somebody edited there is never replaced.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import yaml

from bearingwear.atomic import UNFINISHED, reason, write_text
from bearingwear.console import UsageError
from bearingwear.scene.checking.records import NAME, NAME_RULE
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.own.plan import plan_of
from bearingwear.studies.solve import life_scene


def write_study(
    file: Path, folder: Path, limits: DesignLimits, instead: Path | None = None
) -> None:
    """Write the configuration of a study of a scene, and the scene, into a folder.

    folder: new, empty, or of an earlier call for this scene.
    instead: where to write in its place.
    """
    from bearingwear.scene.checking.strict_yaml import text_of
    from bearingwear.scene.read import scene_files

    name = file.stem
    if not re.match(NAME, name):
        raise UsageError(f"{file}: got the name {name}, expected {NAME_RULE}")
    plans = plan_of(life_scene(file), name, limits, os.fspath(file))
    bodies = {
        path: yaml.safe_dump(plan, sort_keys=False, default_flow_style=None)
        for path, plan in plans.items()
    }
    for path in map(Path, scene_files(file)):
        bodies[f"config/scenes/{path.name}"] = text_of(path)
    head = f"# Written by `bearingwear study {file.name}`"
    _check_folder(folder, head)
    texts = {
        folder / path: f"{head} ({_hash(body)}). Edit {file.name} and run that command again, or "
        f"edit this file and run `bearingwear study` here.\n{body}"
        for path, body in bodies.items()
    }
    for path in texts:
        _check_unedited(path, head, folder)
    for path, text in texts.items():
        path = (instead or folder) / path.relative_to(folder)
        if _text(path) != text:
            write_text(path, text)


@contextlib.contextmanager
def looked_at(folder: Path) -> Iterator[Path]:
    """A folder in place of a study's own, for a dry run, which writes nothing there.

    It has the same configuration, and sees the same results and what Snakemake knows of them.
    """
    with tempfile.TemporaryDirectory() as name:
        other = Path(name)
        UNFINISHED.add(other)
        if (folder / "config").is_dir():
            shutil.copytree(folder / "config", other / "config")
        (other / ".snakemake").mkdir()
        for part in ("results", ".snakemake/metadata"):
            if (folder / part).is_dir():
                (other / part).symlink_to((folder / part).resolve())
        yield other


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _check_folder(folder: Path, head: str) -> None:
    """Refuse a folder that holds anything else."""
    try:
        if folder.exists() and any(path.name != ".snakemake" for path in folder.iterdir()):
            config = folder / "config" / "config.yaml"
            if not (_text(config) or "").startswith(head):
                what = head.removeprefix("# Written by ")
                raise UsageError(
                    f"{folder}: got a folder with other files, expected a new folder, or one "
                    f"written by {what}"
                )
    except OSError as error:
        raise UsageError(f"{folder}: cannot be used ({reason(error)})") from None


def _check_unedited(path: Path, head: str, folder: Path) -> None:
    """Refuse to replace what somebody edited."""
    text = _text(path)
    if text is not None:
        first, _, rest = text.partition("\n")
        if not first.startswith(head) or _hash(rest) not in first:
            raise UsageError(
                f"{path}: got an edited file, expected an unchanged file, or none (to run the "
                f"edited study, use `bearingwear study` in {folder})"
            )


def _text(path: Path) -> str | None:
    """What a file holds, if it is there."""
    return path.read_bytes().decode("utf-8", "replace") if path.is_file() else None
