"""Which functions a command goes through, as a tree: `python benchmarks/trace.py solve SCENE`.

Only calls from one file of the package into another are printed, each once below its caller.
Compiled
functions are leaves. `--depth` limits the tree.
"""

import argparse
import contextlib
import io
import sys
from collections.abc import Iterator
from pathlib import Path

import bearingwear
from bearingwear.cli import main

PACKAGE = Path(bearingwear.__file__).parent
QUIET = ("<", "_")
"""How the names of functions begin that no caller in another file needs to know."""


class Tree:
    """Calls between files: {function: calls below it}, in the order in which they come."""

    def __init__(self) -> None:
        self.root: dict = {}
        self.stack: list[dict] = [self.root]
        self.files: list[str] = [""]

    def __call__(self, frame, event: str, _) -> None:
        if event == "call":
            code = frame.f_code
            here = self.stack[-1]
            file = code.co_filename
            if file.startswith(str(PACKAGE)) and "build" not in file:
                name = f"{Path(file).relative_to(PACKAGE)}: {code.co_qualname}"
                is_new_file = file != self.files[-1]
                if is_new_file and not code.co_name.startswith(QUIET):
                    here = here.setdefault(name, {})
            else:
                file = self.files[-1]
            self.stack.append(here)
            self.files.append(file)
        elif event == "return" and len(self.stack) > 1:
            self.stack.pop()
            self.files.pop()


def lines(tree: dict, depth: int, indent: str = "") -> Iterator[str]:
    """The tree, a function a line; one that came above is not followed again."""
    for name, below in tree.items():
        yield f"{indent}{name}"
        if depth > 1:
            yield from lines(below, depth - 1, indent + "  ")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--depth", type=int, default=6)
    parser.add_argument("command", nargs="+", help="of bearingwear, with its arguments")
    given = parser.parse_args()
    with contextlib.redirect_stdout(io.StringIO()):
        main(given.command)  # what is compiled or imported once is not traced
        tree = Tree()
        sys.setprofile(tree)
        try:
            main(given.command)
        finally:
            sys.setprofile(None)
    print("\n".join(lines(tree.root, given.depth)))
