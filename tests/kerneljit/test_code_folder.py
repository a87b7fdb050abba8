"""Compiled code is loaded from a folder that nobody but its user can write to."""

import dataclasses
import os
import stat
from pathlib import Path

import pytest

from bearingwear.kernels.project import PROJECT
from kerneljit import project
from kerneljit.project import is_private, private_code_folder

OTHER_USER = 54321  # a number that no user of this machine has
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")


@pytest.fixture
def choose_folder(tmp_path, monkeypatch):
    """Returns a function that chooses the folder, and returns it and the lines printed about it.

    NUMBA_CACHE_DIR is `tmp_path/given`, the folder for temporary files `tmp_path/tmp`.
    """
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "given"))
    monkeypatch.setattr(project.tempfile, "tempdir", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    (tmp_path / "tmp").chmod(0o1777)
    lines: list[str] = []
    monkeypatch.setattr(project, "tell", lines.append)
    return lambda settings=PROJECT: (Path(private_code_folder(settings)), lines)


def permissions(folder):
    """Returns the permission bits of a folder."""
    return stat.S_IMODE(folder.stat().st_mode)


def test_only_the_user_may_use_a_new_folder(choose_folder, tmp_path):
    """However permissive the umask is."""
    umask = os.umask(0)
    try:
        folder, output = choose_folder()
    finally:
        os.umask(umask)
    assert folder.parent == tmp_path / "given" and not output
    assert permissions(folder) == permissions(folder.parent) == 0o700 and is_private(folder)


def replace_by_link(folder):
    """Replaces a folder by a symbolic link to it."""
    folder.rename(folder.with_name("mine"))
    folder.symlink_to(folder.with_name("mine"))


UNSAFE = {
    "group writes": lambda folder: folder.chmod(0o770),
    "others write": lambda folder: folder.chmod(0o707),
    "sticky": lambda folder: folder.chmod(0o1777),
    "link": replace_by_link,
    "others write above": lambda folder: folder.parent.chmod(0o777),
    "file": lambda folder: (folder.rmdir(), folder.write_text("")),
}
GIVEN_AWAY = {
    "of another user": lambda folder: os.chown(folder, OTHER_USER, OTHER_USER),
    "of another user above": lambda folder: os.chown(folder.parent, OTHER_USER, OTHER_USER),
    "of another user above, sticky": lambda folder: (
        os.chown(folder.parent, OTHER_USER, OTHER_USER), folder.parent.chmod(0o1777)
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    "spoil",
    [
        *(pytest.param(spoil, id=name) for name, spoil in UNSAFE.items()),
        *(pytest.param(spoil, id=name, marks=as_root) for name, spoil in GIVEN_AWAY.items()),
    ],
)
def test_an_unsafe_folder_is_replaced_by_one_among_temporary_files(choose_folder, tmp_path, spoil):
    """A line names both; the next process chooses the same folder."""
    folder, _ = choose_folder()
    spoil(folder)
    assert not is_private(folder)
    replacement, output = choose_folder()
    assert replacement.parent == tmp_path / "tmp" and is_private(replacement)
    assert len(output) == 1 and output[0].startswith(f"NUMBA_CACHE_DIR: {tmp_path / 'given'} ")
    assert f" {replacement}" in output[0]
    assert choose_folder()[0] == replacement  # kept from one process to the next


def test_a_folder_in_a_sticky_one_of_all_users_is_safe(choose_folder):
    """Others may make folders beside it, but cannot rename or remove it."""
    folder, _ = choose_folder()
    folder.parent.chmod(0o1777)
    assert choose_folder()[0] == folder


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(replace_by_link, id="link"),
        pytest.param(UNSAFE["others write"], id="others write"),
        pytest.param(GIVEN_AWAY["of another user"], id="of another user", marks=as_root),
    ],
)
def test_an_unsafe_folder_among_temporary_files_is_not_used(choose_folder, tmp_path, spoil):
    """Anybody can make a folder of the expected name there beforehand."""
    (tmp_path / "given").write_text("no folder")
    folder, _ = choose_folder()
    assert folder.name.startswith(f"bearingwear-{os.geteuid()}-numba-")
    assert folder.parent == tmp_path / "tmp"
    spoil(folder)
    replacement, _ = choose_folder()
    assert replacement not in (folder, folder.resolve()) and is_private(replacement)
    assert permissions(replacement) == 0o700


def test_only_a_checkout_has_its_code_beside_the_sources(choose_folder, tmp_path, monkeypatch):
    """Files beside an installed package would remain when pip removes it."""
    package, caches = tmp_path / "place" / "bearingwear", tmp_path / "caches"
    package.mkdir(parents=True)
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(caches))
    installed = dataclasses.replace(PROJECT, folder=package, in_checkout=False)
    assert choose_folder(installed)[0].parent == caches / "bearingwear"
    assert not any(package.iterdir())
    in_checkout = dataclasses.replace(installed, in_checkout=True)
    assert choose_folder(in_checkout)[0].parent == package / "__pycache__"
