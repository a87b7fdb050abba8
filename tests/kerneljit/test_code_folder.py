"""Compiled code is loaded from a folder that nobody but its user can write to."""

import dataclasses
import os
import stat
from pathlib import Path

import pytest

from bearingwear.kernels.project import PROJECT
from kerneljit import project as place
from kerneljit.project import is_private, private_code_folder

ELSE = 54321  # a user's number that is nobody's here
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")


@pytest.fixture
def chosen(tmp_path, monkeypatch):
    """The folder chosen where `NUMBA_CACHE_DIR` is `tmp_path/given`, and what is said of it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "given"))
    monkeypatch.setattr(place.tempfile, "tempdir", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    (tmp_path / "tmp").chmod(0o1777)
    said: list[str] = []
    monkeypatch.setattr(place, "tell", said.append)
    return lambda project=PROJECT: (Path(private_code_folder(project)), said)


def mode_of(folder):
    return stat.S_IMODE(folder.stat().st_mode)


def test_a_new_folder_is_the_users_alone(chosen, tmp_path):
    before = os.umask(0)
    try:
        folder, output = chosen()
    finally:
        os.umask(before)
    assert folder.parent == tmp_path / "given" and not output
    assert mode_of(folder) == mode_of(folder.parent) == 0o700 and is_private(folder)


def linked(folder):
    folder.rename(folder.with_name("mine"))
    folder.symlink_to(folder.with_name("mine"))


UNSAFE = {
    "group writes": lambda folder: folder.chmod(0o770),
    "others write": lambda folder: folder.chmod(0o707),
    "sticky": lambda folder: folder.chmod(0o1777),
    "link": linked,
    "others write above": lambda folder: folder.parent.chmod(0o777),
    "file": lambda folder: (folder.rmdir(), folder.write_text("")),
}
GIVEN_AWAY = {
    "of another user": lambda folder: os.chown(folder, ELSE, ELSE),
    "of another user above": lambda folder: os.chown(folder.parent, ELSE, ELSE),
    "of another user above, sticky": lambda folder: (
        os.chown(folder.parent, ELSE, ELSE), folder.parent.chmod(0o1777)
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    "spoil",
    [
        *(pytest.param(spoil, id=name) for name, spoil in UNSAFE.items()),
        *(pytest.param(spoil, id=name, marks=as_root) for name, spoil in GIVEN_AWAY.items()),
    ],
)
def test_an_unsafe_folder_is_left_for_another_one(chosen, tmp_path, spoil):
    folder, _ = chosen()
    spoil(folder)
    assert not is_private(folder)
    other, output = chosen()
    assert other.parent == tmp_path / "tmp" and is_private(other)
    assert len(output) == 1 and output[0].startswith(f"NUMBA_CACHE_DIR: {tmp_path / 'given'} ")
    assert f" {other}" in output[0]
    assert chosen()[0] == other  # kept from one process to the next


def test_others_may_make_folders_beside_it_in_a_sticky_one(chosen):
    folder, _ = chosen()
    folder.parent.chmod(0o1777)
    assert chosen()[0] == folder


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(linked, id="link"),
        pytest.param(UNSAFE["others write"], id="others write"),
        pytest.param(GIVEN_AWAY["of another user"], id="of another user", marks=as_root),
    ],
)
def test_a_name_taken_in_the_folder_for_temporary_files(chosen, tmp_path, spoil):
    """Anybody can make it there beforehand."""
    (tmp_path / "given").write_text("no folder")
    folder, _ = chosen()
    assert folder.name.startswith(f"bearingwear-{os.geteuid()}-numba-")
    assert folder.parent == tmp_path / "tmp"
    spoil(folder)
    other, _ = chosen()
    assert other not in (folder, folder.resolve()) and is_private(other)
    assert mode_of(other) == 0o700


def test_only_a_checkout_has_its_code_beside_the_sources(chosen, tmp_path, monkeypatch):
    """What lies beside an installed package stays when pip removes it, and Python imports it."""
    package, caches = tmp_path / "place" / "bearingwear", tmp_path / "caches"
    package.mkdir(parents=True)
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(caches))
    installed = dataclasses.replace(PROJECT, folder=package, in_checkout=False)
    assert chosen(installed)[0].parent == caches / "bearingwear" and not any(package.iterdir())
    in_checkout = dataclasses.replace(installed, in_checkout=True)
    assert chosen(in_checkout)[0].parent == package / "__pycache__"
