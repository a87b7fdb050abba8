"""How the words of a step become the arguments of its function."""

import inspect

from bearingwear.studies.run_step import arguments


def labelled(label: str, number: float) -> None:
    """Stands for the function of a step in a module whose annotations are evaluated."""


def test_a_text_that_looks_like_a_number_stays_a_text():
    """The annotation of `label` is the class `str`, that of `number` is not."""
    values = arguments(inspect.signature(labelled), ["label=1e3", "number=1e3"])
    assert values == {"label": "1e3", "number": 1000.0}
