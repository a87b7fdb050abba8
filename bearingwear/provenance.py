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
"""The package beside it that compiles its kernels."""

IN_CHECKOUT = (PACKAGE.parent / "Snakefile").is_file()
"""Whether the package is imported from a checkout, or a copy of one, and not where pip puts it."""

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
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        if name not in paths:
            paths[name] = _file(name)
            waiting += _imported(paths[name])
    data = (file for path in paths.values() for file in _data(path))
    return tuple(sorted({*paths.values(), *data}))


@functools.cache
def _data(path: Path) -> tuple[Path, ...]:
    """Files beside a module that are not Python and whose names stand in it."""
    data_files = _not_python(path.parent)
    text = path.read_text(encoding="utf-8") if data_files else ""
    return tuple(file for file in data_files if f'"{file.name}"' in text)


@functools.cache
def _not_python(folder: Path) -> tuple[Path, ...]:
    return tuple(file for file in folder.iterdir() if file.suffix != ".py" and file.is_file())


@functools.cache
def _file(module: str) -> Path:
    top, *rest = module.split(".")
    path = (PACKAGE if top == "bearingwear" else PACKAGE.parent / top).joinpath(*rest)
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@functools.cache
def _is_module(name: str) -> bool:
    return _file(name).is_file()


# The text is searched, not parsed: a command shall not spend a tenth of a second on naming sources.
_IMPORT = re.compile(
    r"^ *(?:from ((?:bearingwear|kerneljit|workflow\.)[\w.]*) import (?:\(([^)]*)\)|(.*))"
    r"|import ((?:bearingwear|kerneljit|workflow)\.[\w.]+))",
    re.M,
)
_FOR_THE_TYPE_CHECKER = re.compile(r"^if TYPE_CHECKING:.*\n(?:[ ].*\n|\n)*", re.M)


@functools.cache
def _imported(path: Path) -> tuple[str, ...]:
    """Modules of the package that a file imports."""
    names: dict[str, None] = {}
    text = _FOR_THE_TYPE_CHECKER.sub("", path.read_text(encoding="utf-8"))
    for module, listed, rest, plain in _IMPORT.findall(text):
        if plain:
            names[plain] = None
        # `from package import name`: a module of that package, or a name in it
        for name in re.findall(r"(\w+)(?: as \w+)?", re.sub("#.*", "", listed or rest)):
            inner = f"{module}.{name}"
            names[inner if module and _is_module(inner) else module] = None
    # the package itself imports its Python interface only where somebody asks for it
    ours = ("bearingwear.", "kerneljit.", "workflow.")
    return tuple(name for name in names if name.startswith(ours))


def contents_hash(paths: Iterable[str | Path]) -> str:
    """Returns the hash of the contents of files (16 digits); a missing one counts as empty."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(_file_hash(os.fspath(path)))
    return digest.hexdigest()[:16]


def text_hash(text: str) -> str:
    """Returns the hash of a text, 16 hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@functools.cache
def _file_hash(path: str) -> bytes:
    return hashlib.sha256(Path(path).read_bytes() if os.path.isfile(path) else b"").digest()


@functools.cache
def sources_hash(*modules: str) -> str:
    """Returns the hash of the names and contents of `sources`, 16 hexadecimal digits."""
    paths = sources(*modules)
    folders = f"{PACKAGE}/", f"{PACKAGE.parent}/"
    names = "\n".join(str(path).removeprefix(folders[0]).removeprefix(folders[1]) for path in paths)
    return hashlib.sha256(f"{names}\n{contents_hash(paths)}".encode()).hexdigest()[:16]


def result_hash(module: str) -> str:
    """Returns the hash of the sources that decide what a function of a module returns.

    What solves a scene names the sources of the solver in its result. These count as well, or
    results of one study would name different ones when some of them are made again.
    """
    solves = any("solvers" in path.parts for path in sources(module))
    return sources_hash(module, *SOLVER) if solves else sources_hash(module)


def other_copy() -> Path | None:
    """Returns the copy of the package installed in this environment, if its sources differ."""
    site = Path(sysconfig.get_path("purelib"))
    copy = site / PACKAGE.name
    if copy == PACKAGE or not (copy / "__init__.py").is_file():
        return None
    ours, theirs = (
        {
            path.relative_to(folder): path.read_bytes()
            for name in (PACKAGE.name, COMPILER)
            for path in (folder / name).rglob("*.py")
        }
        for folder in (PACKAGE.parent, site)
    )
    return None if ours == theirs else copy


def source_hash() -> str:
    """Returns the hash of the sources between a scene and its result file."""
    return sources_hash(*SOLVER)


def kernels_hash() -> str:
    """Returns the hash of the kernels and of `kerneljit` as they are on disk now (16 digits)."""
    _file_hash.cache_clear()  # they may have been edited since
    compiler = (PACKAGE.parent / COMPILER).glob("*.py")
    return contents_hash([*sorted(PACKAGE.glob("kernels/**/*.py")), *sorted(compiler)])
