"""Which sources decide a result, found from the import statements, and hashes of them.

Every result file carries the hash of the sources that solve a scene, and the folder for compiled
code has that of the kernels in its name.
"""

import functools
import hashlib
import os
import re
import sysconfig
from collections.abc import Iterable
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent

COMPILER = "kerneljit"
"""The package beside `bearingwear` that compiles its kernels."""

IN_CHECKOUT = (PACKAGE.parent / "Snakefile").is_file()
"""Whether the package is imported from a checkout or a copy of one, not from `site-packages`."""

SOLVER = (
    "bearingwear.scene.read",
    "bearingwear.solvers.solve",
    "bearingwear.lives.life",
    "bearingwear.results.netcdf",
    "bearingwear.results.restart",
)
"""Entry points of everything between a scene and its result file."""


@functools.cache
def sources(*modules: str) -> tuple[Path, ...]:
    """Returns the package's files that modules import, directly or in turn, and their data.

    Imports inside functions count, those for the type checker alone do not. A file that is not
    Python (a template, a style) belongs to the module beside it that names it.

    *modules: dotted names of modules of the package, or of `workflow/studies`; they count
        themselves.
    """
    paths: dict[str, Path] = {}
    unread = list(modules)
    while unread:
        name = unread.pop()
        if name not in paths:
            paths[name] = _module_file(name)
            unread += _imported_modules(paths[name])
    data_files = (file for path in paths.values() for file in _data_files(path))
    return tuple(sorted({*paths.values(), *data_files}))


@functools.cache
def _data_files(path: Path) -> tuple[Path, ...]:
    """Returns the files beside a module that are not Python and that it names in double quotes."""
    other_files = _other_files(path.parent)
    text = path.read_text(encoding="utf-8") if other_files else ""
    return tuple(file for file in other_files if f'"{file.name}"' in text)


@functools.cache
def _other_files(folder: Path) -> tuple[Path, ...]:
    """Returns the files in a folder that are not Python."""
    return tuple(file for file in folder.iterdir() if file.suffix != ".py" and file.is_file())


@functools.cache
def _module_file(module: str) -> Path:
    """Returns the file of a module by its dotted name; of a package, its `__init__.py`."""
    top, *names = module.split(".")
    folder = PACKAGE if top == "bearingwear" else PACKAGE.parent / top
    path = folder.joinpath(*names)
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@functools.cache
def _is_module(name: str) -> bool:
    """Whether a dotted name is that of a module, and not of a function or constant in one."""
    return _module_file(name).is_file()


# The text is searched, not parsed, which would take each command a tenth of a second.
_IMPORT = re.compile(
    r"^ *(?:from ((?:bearingwear|kerneljit|workflow\.)[\w.]*) import (?:\(([^)]*)\)|(.*))"
    r"|import ((?:bearingwear|kerneljit|workflow)\.[\w.]+))",
    re.M,
)
_FOR_THE_TYPE_CHECKER = re.compile(r"^if TYPE_CHECKING:.*\n(?:[ ].*\n|\n)*", re.M)


@functools.cache
def _imported_modules(path: Path) -> tuple[str, ...]:
    """Returns the dotted names of the modules of this repository that a file imports."""
    modules: dict[str, None] = {}
    text = _FOR_THE_TYPE_CHECKER.sub("", path.read_text(encoding="utf-8"))
    for module, names_in_brackets, names_in_line, plain_import in _IMPORT.findall(text):
        if plain_import:
            modules[plain_import] = None
        names = re.sub("#.*", "", names_in_brackets or names_in_line)
        # `from package import name`: a module of that package, or a name in it
        for name in re.findall(r"(\w+)(?: as \w+)?", names):
            inner = f"{module}.{name}"
            modules[inner if module and _is_module(inner) else module] = None
    # `bearingwear` without a dot is left out: it imports the Python interface only on request
    ours = ("bearingwear.", "kerneljit.", "workflow.")
    return tuple(module for module in modules if module.startswith(ours))


def contents_hash(paths: Iterable[str | Path]) -> str:
    """Returns the hash of the contents of files, 16 hexadecimal digits.

    A missing file counts as empty.
    """
    digest = hashlib.sha256()
    for path in paths:
        digest.update(_file_hash(os.fspath(path)))
    return digest.hexdigest()[:16]


def text_hash(text: str) -> str:
    """Returns the hash of a text, 16 hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@functools.cache
def _file_hash(path: str) -> bytes:
    """Returns the SHA-256 of the contents of a file; a missing file counts as empty."""
    return hashlib.sha256(Path(path).read_bytes() if os.path.isfile(path) else b"").digest()


@functools.cache
def sources_hash(*modules: str) -> str:
    """Returns the hash of the names and contents of `sources`, 16 hexadecimal digits."""
    paths = sources(*modules)
    # relative names, so that the hash is the same wherever the package lies
    names = "\n".join(
        str(path).removeprefix(f"{PACKAGE}/").removeprefix(f"{PACKAGE.parent}/") for path in paths
    )
    return hashlib.sha256(f"{names}\n{contents_hash(paths)}".encode()).hexdigest()[:16]


def result_hash(module: str) -> str:
    """Returns the hash of the sources that determine the results of a module.

    A module solves scenes if it imports, directly or in turn, a file in a folder `solvers`. Then
    all sources of `SOLVER` count, even those that it does not import: its results contain the hash
    of `SOLVER`, which must be the same in all files of a study.
    """
    solves_scenes = any("solvers" in path.parts for path in sources(module))
    return sources_hash(module, *SOLVER) if solves_scenes else sources_hash(module)


def other_copy() -> Path | None:
    """Returns the folder of another copy of the package that is installed in this environment.

    It is None if there is none, or if its sources are the same.
    """
    installed = Path(sysconfig.get_path("purelib"))
    copy = installed / PACKAGE.name
    if copy == PACKAGE or not (copy / "__init__.py").is_file():
        return None
    return None if _python_sources(installed) == _python_sources(PACKAGE.parent) else copy


def _python_sources(folder: Path) -> dict[Path, bytes]:
    """Returns the contents of the Python files of both packages in a folder, by relative path."""
    return {
        path.relative_to(folder): path.read_bytes()
        for name in (PACKAGE.name, COMPILER)
        for path in (folder / name).rglob("*.py")
    }


def source_hash() -> str:
    """Returns the hash of the sources between a scene and its result file."""
    return sources_hash(*SOLVER)


def kernels_hash() -> str:
    """Returns the hash of the kernels and of `kerneljit` as they are on disk now, 16 digits."""
    _file_hash.cache_clear()  # they may have been edited since
    compiler = (PACKAGE.parent / COMPILER).glob("*.py")
    return contents_hash([*sorted(PACKAGE.glob("kernels/**/*.py")), *sorted(compiler)])
