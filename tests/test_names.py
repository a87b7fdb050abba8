"""Names and sizes: a public name is defined once, no file or function is too long to read."""

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path

from support import syntax_nodes

import bearingwear

PACKAGE = Path(bearingwear.__file__).parent
OURS = PACKAGE, PACKAGE.parent / "workflow" / "studies"

LINES_OF_A_FUNCTION = 60  # beside its docstring

# Files whose names repeat those of others on purpose.
REPEATING = {
    "api.py": "the Python interface: `solve` and `life` are those of the model, in xarray",
    "commands.py": "a handler has the name of its command, which is what is typed",
}

IN_EACH_APPLICATION = "APPLICATION"


def public_names(body: Sequence[ast.stmt]) -> Iterator[str]:
    """Yields the public names that statements of a module define, also inside `if` and `try`."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names = [node.name]
        elif isinstance(node, ast.Assign):
            names = [
                part.id
                for target in node.targets
                for part in ast.walk(target)
                if isinstance(part, ast.Name)
            ]
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [node.target.id]
        else:
            names = []
            for part in ("body", "orelse", "finalbody"):
                if isinstance(node, ast.If | ast.Try):
                    yield from public_names(getattr(node, part, []))
        yield from (name for name in names if not name.startswith("_"))


def defined_twice(*folders: Path) -> dict[str, list[str]]:
    """Returns the names that more than one module below some folders defines, with the files."""
    files: dict[str, list[str]] = {}
    for top, path in sorted((folder, file) for folder in folders for file in folder.rglob("*.py")):
        place = path.relative_to(top)
        if place.as_posix() in REPEATING or "__pycache__" in place.parts:
            continue
        for name in {*public_names(syntax_nodes(path)[0].body)} - {IN_EACH_APPLICATION}:
            files.setdefault(name, []).append(place.as_posix())
    return {name: places for name, places in sorted(files.items()) if len(places) > 1}


def test_no_public_name_has_two_meanings():
    twice = defined_twice(*OURS)
    assert not twice, "\n".join(f"{name}: {', '.join(files)}" for name, files in twice.items())


def lines_of(function: ast.FunctionDef) -> int:
    """Returns the number of lines of a function without its docstring."""
    first = function.body[0]
    has_docstring = ast.get_docstring(function) is not None
    docstring = (first.end_lineno or 0) - first.lineno + 1 if has_docstring else 0
    return (function.end_lineno or 0) - function.lineno + 1 - docstring


def test_functions_are_short():
    long = []
    for path in sorted(path for folder in OURS for path in folder.rglob("*.py")):
        place = path.relative_to(PACKAGE.parent).as_posix()
        long += [
            f"{place}: {node.name}"
            for node in syntax_nodes(path)
            if isinstance(node, ast.FunctionDef) and lines_of(node) > LINES_OF_A_FUNCTION
        ]
    assert long == []


def test_names_defined_in_two_modules_are_detected(tmp_path):
    """X and Y are: by an assignment in a `try`, and as a typed name, a class and a function.

    Names that begin with `_` do not count, nor do local ones, such as X in the function Y.
    """
    (tmp_path / "a.py").write_text("try:\n    X = Y = 1\nexcept OSError:\n    pass\n_Z: int = 2\n")
    (tmp_path / "b.py").write_text("class Y: ...\nX: int = 2\n_Z = 3\n")
    (tmp_path / "c.py").write_text("def Y():\n    X = 1\n")
    assert defined_twice(tmp_path) == {"X": ["a.py", "b.py"], "Y": ["a.py", "b.py", "c.py"]}
