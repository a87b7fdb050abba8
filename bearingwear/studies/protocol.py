"""A study: steps, each of which makes files from files by one function.

The rules of the workflow, the page and the cluster's groups ask a study for its steps and know none
by name. A new study is a folder with these steps, a YAML file and a line in `studies.INSTALLED`.

    Study(
        "toy",
        plan,
        step("solve", "{speed}.nc", "run.at_speed", plan.speeds, scene=SCENE, settings=asdict),
        figure_step("torque", "figures.torque", cases="{speed}.nc"),
    )

Paths of outputs and inputs lie in the study's folder, results/toy, unless they begin with config/,
docs/ or results/. A file name in braces stands for a file of each point of the step that makes it;
as an input of a step without these points, for all of them. A step that names no points has those
of the first input that has them.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from bearingwear.studies import module_name
from bearingwear.studies.seconds import seconds_of

Wildcards = Mapping[str, str]
Names = tuple[str, ...]

OUTSIDE = ("config/", "docs/", "results/")
"""Paths that begin so are not in the folder of the study."""

_MOST_LISTED = 16

SCENE = "config/scenes/{scene}.yaml"


Paths = str | Sequence[str]
Given = Paths | Callable[[Any], Paths | None]
"""Paths, or a function of a point that gives them, or None where that point needs none."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """Data of a rule of the workflow."""

    name: str  # what its rule is called, after the name of the study
    label: str = ""  # what a person reads while it runs; may contain wildcards
    about: str = ""  # what the list of rules says of it, where that is not its label
    # size of a job, in the unit of its seconds in the table of `seconds`: points, runs, or the job
    # itself; 0 if it is not worth a process on another node
    work: float = 0.0
    rule: str = ""  # of the workflow: its name after that of its study
    priority: int = 0  # jobs of a higher one start first
    kernel: str = ""  # of its jobs: one alone starts while this is not compiled, others would wait
    # whether it takes every core: nothing is timed beside it, and `workers` of its function, if it
    # has them, are that many processes
    alone: bool = False
    tells: bool = False  # whether what it says on its way is seen while it runs, besides in its log
    # whether a plain `snakemake` runs it, too; whether it is run only for who asks for its files
    default: bool = False
    on_request: bool = False

    @property
    def seconds(self) -> float:
        """About what a job takes, if it has work."""
        return seconds_of(self.rule, self.work)


@dataclass(frozen=True, kw_only=True)
class Step(Task):
    """One kind of job of a study."""

    # The function that does it, from the package on: `studies.grid.gather.study`. It takes `inputs`
    # and `settings` as keyword arguments and returns what is written: a Result, a Dataset, a
    # Figure, a text, or several of these, one for each output.
    run: str
    outputs: Names  # Paths, with wildcards in braces. A figure is written to each of them.
    # what the plan says of each job, by the values of the wildcards in their order
    points: Mapping[Names, Any] | None = None
    # files by the names of their arguments
    inputs: Mapping[str, Given] = field(default_factory=dict)
    # all else that decides the result, as plain data
    settings: Mapping[str, Any] | Callable[[Any], Mapping[str, Any]] = field(default_factory=dict)
    # of its study: where its files lie, and the steps before it by their outputs
    folder: str = ""
    before: Mapping[str, Step] = field(default_factory=dict)
    # place of figures (SVG) and tables (Markdown) in the report of the jobs; none without a caption
    caption: str = ""
    category: str = ""
    result: str = ""
    shown: bool = False  # whether it has a caption, by default that of its study
    # keys of its scene that the settings replace: what the file has there does not count
    replaced: Names = ()
    last: bool = False  # whether it comes after all figures and tables before it, since it may fail

    @property
    def module(self) -> str:
        """Dotted name of the module that holds `run`; its imports decide the result."""
        return module_name(self.run.rpartition(".")[0])

    @functools.cached_property
    def wildcards(self) -> Names:
        """Names in braces, in the order of the keys of `points`."""
        return wildcards_in(self.outputs[0])

    @property
    def matches(self) -> dict[str, str]:
        """Regular expressions of the wildcards: the values that there are.

        Many of them would take longer to compile than to plan; where nothing but one wildcard
        varies in a part of the path, `point` refuses those that are not there.
        """
        parts = map(wildcards_in, self.outputs[0].split("/"))
        alone = {names[0] for names in parts if len(names) == 1}
        found = {}
        for name, values in zip(
            self.wildcards, zip(*(self.points or ()), strict=True), strict=True
        ):
            known = dict.fromkeys(values)
            listed = name not in alone or len(known) <= _MOST_LISTED
            found[name] = "|".join(map(re.escape, known)) if listed else "[^/]+"
        return found

    def jobs(self) -> Iterator[dict[str, str]]:
        """Wildcards of every job."""
        for values in self.points or ():
            yield dict(zip(self.wildcards, values, strict=True))

    def made(self) -> list[str]:
        """Every file that it makes."""
        return [path.format(**job) for job in self.jobs() for path in self.outputs]

    def point(self, wildcards: Wildcards) -> Any:
        """Point of one job in the plan."""
        try:
            return (self.points or {})[tuple(wildcards[name] for name in self.wildcards)]
        except KeyError:
            path = self.outputs[0].format(**wildcards)
            raise ValueError(f"{path}: got a point that is not in the plan") from None

    def files(self, wildcards: Wildcards) -> dict[str, Paths]:
        """The inputs of one job."""
        found: dict[str, Paths] = {}
        for name, given in self.inputs.items():
            paths = given(self.point(wildcards)) if callable(given) else given
            if paths is not None:
                found[name] = self._paths(paths, wildcards)
        return found

    def _paths(self, paths: Paths, wildcards: Wildcards) -> Paths:
        if not isinstance(paths, str):
            return flat_files({path: self._paths(path, wildcards) for path in paths})
        path = _in(self.folder, paths)
        if set(wildcards_in(path)) <= set(self.wildcards):
            return path.format(**wildcards)
        return [
            path.format(**job)
            for job in self.before[path].jobs()
            if all(job.get(name, value) == value for name, value in wildcards.items())
        ]

    def given(self, wildcards: Wildcards) -> dict[str, Any]:
        """The settings of one job."""
        settings = self.settings
        return dict(settings(self.point(wildcards)) if callable(settings) else settings)

    def one(self, wildcards: Wildcards) -> Step:
        """The step of one job alone, without wildcards."""
        return replace(
            self,
            outputs=tuple(path.format(**wildcards) for path in self.outputs),
            points={(): None},
            inputs=self.files(wildcards),
            settings=self.given(wildcards),
            label=self.label.format(**wildcards),
        )

    @property
    def after(self) -> list[str]:
        """Files that must be there first although the function does not read them."""
        shown = ((path, one) for path, one in self.before.items() if one.caption)
        made = (path.format(**job) for path, one in shown for job in one.jobs())
        return [*made] if self.last else []

    @property
    def steps(self) -> tuple[Step, ...]:
        """Steps of one process, as in `Bundle`."""
        return (self,)

    def placed(self, study: str, folder: str, before: Mapping[str, Step]) -> Step:
        """Itself in the folder of a study, whose steps before it are given by their outputs."""
        outputs = tuple(_in(folder, path) for path in self.outputs)
        own = wildcards_in(outputs[0])
        named = ", ".join(f"{{{name}}}" for name in own)
        placed = replace(
            self,
            run=self.run if self.run.startswith("studies.") else f"studies.{study}.{self.run}",
            rule=f"{study}_{self.name}",
            outputs=outputs,
            folder=folder,
            before=before,
            label=self.label or f"{study}: {self.name.replace('_', ' ')} {named}".rstrip(),
            caption=self.caption or (study if self.shown else ""),
            category=self.category or ("{scene}" if "scene" in own else study),
        )
        return placed if placed.points is not None else replace(placed, points=placed._of_inputs())

    def _of_inputs(self) -> Mapping[Names, Any]:
        """Points of the first step before it that has its wildcards; one where nothing has any."""
        given = {key: paths for key, paths in self.inputs.items() if not callable(paths)}
        for path in flat_files(given):
            maker = self.before.get(_in(self.folder, path))
            if maker is not None and set(self.wildcards) <= set(maker.wildcards):
                points = zip(maker.jobs(), (maker.points or {}).values(), strict=True)
                return {
                    tuple(job[name] for name in self.wildcards): inputs for job, inputs in points
                }
        return {} if self.wildcards else {(): None}


@dataclass(frozen=True, kw_only=True)
class Bundle(Task):
    """Steps without wildcards in one process: Python starts more slowly than a figure is drawn."""

    steps: tuple[Step, ...]
    folder: str  # where their files lie
    category: str  # where they stand in the report of the jobs

    matches: Mapping[str, str] = field(default_factory=dict, init=False)
    after: Sequence[str] = field(default=(), init=False)

    def one(self, wildcards: Wildcards) -> Bundle:
        """Itself, since it has no wildcards."""
        return self

    @property
    def outputs(self) -> Names:
        """Paths of all of its steps."""
        return tuple(path for step in self.steps for path in step.outputs)

    def made(self) -> list[str]:
        """Every file that it makes."""
        return [*self.outputs]

    def placed(self, study: str, folder: str, before: Mapping[str, Step]) -> Bundle:
        """Itself with its steps in its folder."""
        steps = (replace(one, category=self.category) for one in self.steps)
        placed = (one.placed(study, self.folder, before) for one in steps)
        return replace(
            self, rule=f"{study}_{self.name}", steps=tuple(one.one({}) for one in placed)
        )


def step(
    name: str,
    outputs: str | Sequence[str],
    run: str,
    each: Mapping[Any, Any] | Iterable[Any] | None = None,
    *,
    settings: Mapping[str, Any] | Callable[[Any], Mapping[str, Any]] | None = None,
    inputs: Mapping[str, Given] | None = None,
    **rest: Any,
) -> Step:
    """A step of a study.

    run: `MODULE.FUNCTION` of the study's folder, or `studies.…` from the package on.
    each: points by the value of their wildcard, or by a tuple of several; points that are their own
        names.
    **rest: fields of `Step`; every other one is an input.
    """
    known = {key: rest.pop(key) for key in [*rest] if key in Step.__dataclass_fields__}
    points = each if isinstance(each, Mapping) or each is None else {key: key for key in each}
    if points is not None:
        points = {key if isinstance(key, tuple) else (key,): value for key, value in points.items()}
    return Step(
        name=name,
        outputs=(outputs,) if isinstance(outputs, str) else tuple(outputs),
        run=run,
        points=points,
        settings={} if settings is None else settings,
        inputs={**(inputs or {}), **rest},
        **known,
    )


def figure_step(
    path: str, run: str, each: Any = None, *, name: str = "figure", **rest: Any
) -> Step:
    """A step that draws figures/PATH, as SVG and PNG."""
    paths = (f"figures/{path}.svg", f"figures/{path}.png")
    return step(name, paths, run, each, **{"shown": True, "result": path, **rest})


def table_step(paths: str | Sequence[str], run: str, *, name: str = "table", **rest: Any) -> Step:
    """A step that writes tables/PATH, by default as Markdown."""
    each = [paths] if isinstance(paths, str) else paths
    outputs = [f"tables/{path}" if "." in path else f"tables/{path}.md" for path in each]
    return step(name, outputs, run, **{"shown": True, "result": "table", **rest})


def bundle(name: str, folder: str, category: str, label: str, *steps: Step, **rest: Any) -> Bundle:
    """Steps of one scene, or across scenes, that one process does."""
    return Bundle(name=name, folder=folder, category=category, label=label, steps=steps, **rest)


class Study:
    """A study, as `studies.NAME.study.study(config)` makes it from its configuration.

    plan: says what is solved; `check_scenes` reads every scene as the study changes it.
    jobs: each is a rule of the workflow.
    default: whether a plain `snakemake` runs all of them.
    """

    def __init__(
        self, name: str, plan: Any, *jobs: Step | Bundle, folder: str = "", default: bool = False
    ) -> None:
        self.name, self.plan, self.default = name, plan, default
        self.jobs: list[Step | Bundle] = []
        before: dict[str, Step] = {}
        for job in jobs:
            placed = job.placed(name, folder or f"results/{name}", before)
            before |= {path: one for one in placed.steps for path in one.outputs}
            if placed.made():
                self.jobs.append(placed)

    @property
    def steps(self) -> list[Step]:
        """Every step, those of bundles as well."""
        return [step for job in self.jobs for step in job.steps]

    def targets(self) -> list[str]:
        """Every file that running the study makes."""
        return [path for job in self.jobs if not job.on_request for path in job.made()]

    def default_targets(self) -> list[str]:
        """Those of them that a plain `snakemake` makes."""
        wanted = [job for job in self.jobs if job.default or self.default]
        made = [path for job in wanted if not job.on_request for path in job.made()]
        return [*made, *self._read_by(wanted)]

    def _read_by(self, jobs: Sequence[Step | Bundle]) -> list[str]:
        """Files made on request that some jobs read.

        They are looked for as well: Snakemake would not miss one whose figures are there.
        """
        requested = {path for job in self.jobs if job.on_request for path in job.made()}
        if not requested:
            return []
        steps = [step for job in jobs if not job.on_request for step in job.steps]
        read = (flat_files(step.files(job)) for step in steps for job in step.jobs())
        return [*dict.fromkeys(path for paths in read for path in paths if path in requested)]

    def point_folders(self) -> set[str]:
        """Folders of the results that points name."""
        named = [
            one
            for one in self.steps
            if one.outputs[0].endswith(".nc") and wildcards_in(one.outputs[0].rpartition("/")[2])
        ]
        return {path.rpartition("/")[0] for one in named for path in one.made()}

    def inputs(self) -> list[str]:
        """Scenes that it is made from."""
        files = (step.files(job) for step in self.steps for job in step.jobs())
        paths = dict.fromkeys(path for given in files for path in flat_files(given))
        return [path for path in paths if path.startswith("config/scenes/")]

    def refused(self, path: str) -> str | None:
        """Why the study does not make a file that looks like one of its own, on one line."""
        named = (output for step in self.steps for output in step.outputs if "{" in output)
        patterns = (re.sub(r"\\{\w+\\}", "[^/]+", re.escape(output)) for output in named)
        if not any(re.fullmatch(pattern, path) for pattern in patterns):
            return None
        if any(path in job.made() for job in self.jobs):
            return None
        return f"{path}: got a point that is not in the plan"

    def check(self) -> None:
        """Read every scene as the study changes it."""
        self.plan.check_scenes()

    def judged(self) -> list[str]:
        """Files in which every status must be good, or the run fails at its end."""
        return []

    def page_sections(self) -> list[str]:
        """Files of the page by scene: results, tables (.md) and figures (.svg, .png)."""
        return []

    def page_answers(self) -> list[str]:
        """Answers (.json), and what lies beside them; those there are, of a study no default."""
        return []

    def behind_figures(self) -> dict[str, list[str]]:
        """Inputs of each figure, and the tables (.csv) made from the same files."""
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


@functools.cache
def wildcards_in(path: str) -> Names:
    """Names in braces, each once."""
    return tuple(dict.fromkeys(re.findall(r"{(\w+)}", path)))


def _in(folder: str, path: str) -> str:
    """A path of a study's folder, from the project's on."""
    return path if path.startswith(OUTSIDE) else f"{folder}/{path}"
