"""The parameter study: its grid, its plan, and what is made of its cases."""

from pathlib import Path

# The Snakefile makes these inputs of the rules that run them.
_FILES = ("gather.py", "grid.py", "life.py", "stack.py")
SOURCES = [Path(__file__).with_name(name) for name in _FILES]
TRADE_SOURCES = [Path(__file__).with_name(name) for name in ("sweeps.py", "trial.py")]
TRADED_SOURCES = [Path(__file__).with_name(name) for name in ("sweeps.py", "tradeoff.py")]
DESIGN_SOURCES = [
    Path(__file__).with_name(name) for name in ("design.py", "design_plan.py", "uncertainty.py")
]
CHECK_SOURCES = [Path(__file__).with_name(name) for name in ("check.py", "design.py")]
FAMILY_SOURCES = [Path(__file__).with_name(name) for name in ("family.py", "design_plan.py")]
STRESS_SOURCES = [Path(__file__).with_name(name) for name in ("extremes.py", "stress.py")]
COUNT_SOURCES = [Path(__file__).with_name("counts.py")]
