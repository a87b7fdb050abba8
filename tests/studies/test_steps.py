"""Every step that a study needs calls its function with the arguments that it takes."""

import importlib
import inspect
import re

import pytest
import yaml
from support import ROOT

from bearingwear import studies
from bearingwear.studies import module_name, run_step
from bearingwear.studies.design import recommend
from bearingwear.studies.design.study import DesignStudy


def pattern_of(step, output):
    """Regular expression of an output, its wildcards as the workflow has them."""
    matches = step.matches
    parts = re.split(r"\{(\w+)\}", output)
    seen: set[str] = set()
    text = ""
    for name_or_text, is_name in zip(parts, [False, True] * len(parts), strict=False):
        if not is_name:
            text += re.escape(name_or_text)
        elif name_or_text in seen:
            text += f"(?P={name_or_text})"
        else:
            seen.add(name_or_text)
            text += f"(?P<{name_or_text}>{matches[name_or_text]})"
    return re.compile(text)


def jobs_behind(made):
    """Steps and wildcards of every file that a study makes, and of those it is made from."""
    steps = [step for study in made.values() for step in study.steps]
    known = [(step, pattern_of(step, output)) for step in steps for output in step.outputs]
    waiting = [path for study in made.values() for path in study.targets()]
    seen = set()
    while waiting:
        path = waiting.pop()
        if path in seen or not path.startswith("results/"):
            continue
        seen.add(path)
        found = [(step, match) for step, p in known if (match := p.fullmatch(path))]
        assert len(found) == 1, f"{path} is made by {[step.name for step, _ in found]}"
        step, match = found[0]
        wildcards = match.groupdict()
        yield step, wildcards
        for given in step.files(wildcards).values():
            waiting += [given] if isinstance(given, str) else given
        waiting += step.after


@pytest.fixture
def made(monkeypatch):
    monkeypatch.chdir(ROOT)
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
    return studies.read(config)


def test_steps_are_called_as_their_functions_are(made):
    called = set()
    for step, wildcards in jobs_behind(made):
        module, _, name = step.run.rpartition(".")
        function = getattr(importlib.import_module(module_name(module)), name)
        try:
            inspect.signature(function).bind(**step.files(wildcards), **step.given(wildcards))
        except TypeError as error:
            pytest.fail(f"{step.name} calls {step.run}: {error}")
        assert step.label.format(**wildcards)
        called.add(step.run)
    runs = {step.run for study in made.values() for step in study.steps}
    assert called == runs


def test_every_core_goes_to_a_step_that_shares_its_work(monkeypatch, tmp_path):
    """The rule's threads are `workers` of the function, where it has them; no setting says so."""
    monkeypatch.setattr(run_step, "_function", {"shared": shared, "single": single}.get)
    for name, workers in (("shared", 7), ("single", None)):
        run_step.run_step(name, {}, {"text": "a"}, [tmp_path / name], 7)
        assert (tmp_path / name).read_text(encoding="utf-8") == f"a {workers}"


def shared(text, workers=1):
    return f"{text} {workers}"


def single(text):
    return f"{text} None"


def test_the_small_map_of_one_scene_takes_every_core(made):
    def telling(study):
        (found,) = (step for step in study.steps if step.tells)
        return found

    several = telling(made["design"])
    assert several.run == "studies.design.recommend.small_map" and not several.alone
    scene = next(iter(made["design"].plan.small_maps))
    assert telling(DesignStudy(made["design"].plan, studied=[scene])).alone
    assert "workers" in inspect.signature(recommend.small_map).parameters


def test_a_point_that_is_not_in_the_plan_is_refused(made):
    targets = [path for study in made.values() for path in study.targets()]
    assert not [path for path in targets for study in made.values() if study.refused(path)]
    cage = made["cage"].refused("results/cage/points/mu9-pocket1-guide1-g0.nc")
    assert (
        cage == "results/cage/points/mu9-pocket1-guide1-g0.nc: got a point that is not in the plan"
    )
    assert made["cage"].refused("results/cage/other.nc") is None
