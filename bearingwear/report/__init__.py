"""Figures and tables of a study."""

from pathlib import Path

# The Snakefile makes these inputs of the rules that run them.
_PAGE = ("answer.py", "markup.py", "page.py", "page.html")
PAGE_SOURCES = [Path(__file__).with_name(name) for name in _PAGE]
SOURCES = sorted(
    [
        *(
            path
            for path in Path(__file__).parent.iterdir()
            if path.suffix in (".py", ".mplstyle") and path.name not in _PAGE
        ),
        Path(__file__).parents[1] / "io" / "spread.py",
    ]
)
