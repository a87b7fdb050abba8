"""Figures and tables of a study."""

from pathlib import Path

# The Snakefile makes these inputs of the rules that run them.
SOURCES = sorted(
    path for path in Path(__file__).parent.iterdir() if path.suffix in (".py", ".mplstyle")
)
