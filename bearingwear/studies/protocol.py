"""A study: steps, each of which makes files from files by one function.

The rules of the workflow, the page and the cluster's groups ask a study for its steps and know none
by name. A new study is a folder with these steps, a YAML file and a line in `studies.NAMES`.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from bearingwear.studies import module_name

Wildcards = Mapping[str, str]
Files = Mapping[str, str | Sequence[str]]


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a rule of the workflow is made from.

    Attributes
    ----------
    name : str
        What its rule is called, after the name of the study.
    about : str
        What the list of rules says of it, where that is not its label.
    matches : mapping
        Regular expressions for wildcards.
    seconds : float
        About what a job takes; 0 if it is not worth a process on another node.
    priority : int
        Jobs of a higher one start first.
    alone : bool
        Whether it takes every core: nothing is timed beside it, and `workers` of its function, if
        it has them, are that many processes.
    tells : bool
        Whether what it says on its way is seen while it runs, besides in its log.
    after : sequence of str
        Files that must be there first although the function does not read them.
    """

    name: str
    about: str = ""
    matches: Mapping[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    priority: int = 0
    alone: bool = False
    tells: bool = False
    after: Sequence[str] = ()


@dataclass(frozen=True, kw_only=True)
class Step(Task):
    """One kind of job of a study, as `Task` and with:

    Attributes
    ----------
    run : str
        The function that does it, from the package on: `studies.grid.gather.study`. It takes
        `inputs` and `settings` as keyword arguments and returns what is written: a Result, a
        Dataset, a Figure, a text, or several of these, one for each output.
    outputs : tuple of str
        Paths, with wildcards in braces. A figure is written to each of them.
    inputs : mapping, or function of the wildcards
        Files by the names of their arguments: a path, or a list of paths. Wildcards may stand in
        those of a mapping.
    settings : mapping, or function of the wildcards
        All else that decides the result, as plain data.
    label : str, or function of the wildcards
        What a person reads while it runs; may contain wildcards.
    caption, category, result : str
        Where the outputs for a reader (figures as SVG, tables as Markdown) stand in the report of
        the jobs; no caption: they do not.
    """

    run: str
    outputs: tuple[str, ...]
    inputs: Files | Callable[[Wildcards], Files] = field(default_factory=dict)
    settings: Mapping[str, Any] | Callable[[Wildcards], Mapping[str, Any]] = field(
        default_factory=dict
    )
    label: str | Callable[[Wildcards], str]
    caption: str = ""
    category: str = "{scene}"
    result: str = ""

    @property
    def module(self) -> str:
        """Dotted name of the module that holds `run`; its imports decide the result."""
        return module_name(self.run.rpartition(".")[0])

    def files(self, wildcards: Wildcards) -> dict[str, str | list[str]]:
        """The inputs of one job."""
        if callable(self.inputs):
            return {
                name: path if isinstance(path, str) else list(path)
                for name, path in self.inputs(wildcards).items()
            }
        return {
            name: path.format(**wildcards)
            if isinstance(path, str)
            else [one.format(**wildcards) for one in path]
            for name, path in self.inputs.items()
        }

    def given(self, wildcards: Wildcards) -> dict[str, Any]:
        """The settings of one job."""
        return dict(self.settings(wildcards) if callable(self.settings) else self.settings)

    def text(self, wildcards: Wildcards) -> str:
        """The label of one job."""
        return self.label(wildcards) if callable(self.label) else self.label.format(**wildcards)

    def one(self, wildcards: Wildcards) -> Step:
        """The step of one job alone, without wildcards."""
        return replace(
            self,
            outputs=tuple(path.format(**wildcards) for path in self.outputs),
            inputs=self.files(wildcards),
            settings=self.given(wildcards),
            label=self.text(wildcards),
            matches={},
        )

    @property
    def steps(self) -> tuple[Step, ...]:
        """What one process does, as `Bundle` has it."""
        return (self,)


@dataclass(frozen=True, kw_only=True)
class Bundle(Task):
    """Steps without wildcards that one process does: a start of Python takes longer than a figure.

    Attributes
    ----------
    steps : tuple of Step
    label : str
    """

    steps: tuple[Step, ...]
    label: str

    def one(self, wildcards: Wildcards) -> Bundle:
        """Itself, since it has no wildcards."""
        return self

    @property
    def outputs(self) -> tuple[str, ...]:
        """Paths of all of its steps."""
        return tuple(path for step in self.steps for path in step.outputs)


class Study:
    """A study, as `studies.NAME.study.study(config)` makes it from its configuration.

    Attributes
    ----------
    name : str
    jobs : sequence of Step or Bundle
        Each is a rule of the workflow.
    """

    name: str
    jobs: Sequence[Step | Bundle] = ()

    @property
    def steps(self) -> list[Step]:
        """Every step, those of bundles as well."""
        return [step for job in self.jobs for step in job.steps]

    def targets(self) -> list[str]:
        """Every file that running the study makes."""
        raise NotImplementedError

    def default_targets(self) -> list[str]:
        """Those of them that a plain `snakemake` makes."""
        return []

    def inputs(self) -> list[str]:
        """Files that it is made from and nobody makes: scenes, values of others."""
        return []

    def refused(self, path: str) -> str | None:
        """Why the study does not make a file that looks like one of its own, on one line."""
        return None

    def check(self) -> None:
        """Read every scene as the study changes it.

        Raises
        ------
        ValueError
            One line: the first thing that is wrong.
        """

    def judged(self) -> list[str]:
        """Files in which every status must be good, or the run fails at its end."""
        return []

    def page_sections(self) -> list[str]:
        """What the page shows scene by scene: results, tables (.md) and figures (.svg, .png)."""
        return []

    def page_answers(self) -> list[str]:
        """Answers (.json), and what lies beside them; those there are, of a study no default."""
        return []

    def behind_figures(self) -> dict[str, list[str]]:
        """What each figure was drawn from, and the tables (.csv) made from the same files."""
        steps = [step for job in self.jobs if isinstance(job, Bundle) for step in job.steps]
        tables = {
            path: {one for one in flat_files(step.inputs) if one.endswith(".nc")}
            for step in steps
            for path in step.outputs
            if path.endswith(".csv")
        }
        found: dict[str, list[str]] = {}
        for step in steps:
            data = [path for path in flat_files(step.inputs) if path.endswith(".nc")]
            twins = [path for path, rest in tables.items() if rest & set(data)]
            found |= {path: [*data, *twins] for path in step.outputs if path.endswith(".svg")}
        return found


def flat_files(files: Any) -> list[str]:
    """Every path of the inputs of a step."""
    return [
        path for given in files.values() for path in ([given] if isinstance(given, str) else given)
    ]
