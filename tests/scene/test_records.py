"""Plain data checked by the fields of typed records."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pytest

from bearingwear.scene.checking.check import read_record, record
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import file_part, keyed, part_at, setting


@keyed
class Sampling:
    samples: int = setting("Number of base samples, a power of two", within="[1, inf)", default=256)
    seed: int = setting("Random seed for the sequence", within="[0, inf)", default=1)

    def __post_init__(self) -> None:
        """Refuses a number of samples that is no power of two."""
        if self.samples & (self.samples - 1):
            raise SceneError("samples", f"got {self.samples}, expected a power of two")


@dataclass(frozen=True)
class Axis:
    values: tuple[float, ...]

    @classmethod
    def from_plain(cls, data: Any) -> "Axis":
        """Returns the axis of a list of rising numbers; refuses others."""
        if not isinstance(data, list) or data != sorted(data):
            raise ValueError(f"got {data}, expected rising numbers")
        return cls(tuple(float(value) for value in data))


@keyed
class Sweep:
    title: str = setting("Heading")
    base: str = setting("Where it starts", choices=("steady", "long"), name="from", default="long")
    settings: Mapping[str, Any] = setting("Changes", name="set", default_factory=dict)
    along: Axis | None = None


@keyed
class Plan:
    sampling: Sampling = setting("How to sample", default_factory=Sampling)
    sweeps: Mapping[str, Sweep] = setting("Sweeps by name", least=1)
    scenes: tuple[str, ...] = setting("Scenes", least=1, choices=("a", "b"))
    factor: float | None = setting("Factor", within="(1, 9]", default=None)
    aim: str | float = setting("Aim", choices=("low", "high"), within="[0, inf)", default="low")


def plan(**changes: Any) -> dict[str, Any]:
    """Returns plain data of a Plan: its required keys, with blocks added or replaced."""
    return {"sweeps": {"one": {"title": "One"}}, "scenes": ["a"]} | changes


def test_plain_data_become_records_with_the_types_of_their_fields():
    sweep = {"title": "One", "from": "steady", "set": {"a.b": 1}, "along": [1, 2]}
    data = plan(sweeps={"one": sweep}, factor=2, aim=3, sampling={"samples": 8.0})
    plan_record = record(Plan, data)
    sampling, (sweep_record,) = plan_record.sampling, plan_record.sweeps.values()
    assert sampling == Sampling(samples=8) and isinstance(sampling.samples, int)
    assert sweep_record.base == "steady" and sweep_record.settings == {"a.b": 1}
    assert sweep_record.along == Axis((1.0, 2.0))
    assert plan_record.scenes == ("a",) and plan_record.aim == 3.0
    assert isinstance(plan_record.factor, float)


def test_null_is_the_same_as_the_default():
    assert record(Plan, plan(sampling=None, factor=None)) == record(Plan, plan())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"secnes": []}, "secnes: got an unknown key; did you mean scenes"),
        ({"": 1}, "got an unknown key; expected one of sampling, factor, aim"),
        ({"sampling": {"samples": 0}}, "sampling.samples: got 0, expected a whole number >= 1"),
        ({"sampling": {"samples": 3}}, "sampling.samples: got 3, expected a power of two"),
        ({"sampling": {"seed": 1.5}}, "sampling.seed: got 1.5, expected a whole number >= 0"),
        ({"sweeps": {}}, "sweeps: got a block of 0 keys, expected one or more blocks named with"),
        ({"sweeps": {"one": {}}}, "sweeps.one.title: got nothing, expected text"),
        ({"sweeps": {"a b": {"title": "x"}}}, "sweeps: got the name 'a b', expected"),
        ({"sweeps": {"one": 3}}, "sweeps.one: got 3, expected a block of keys"),
        (
            {"sweeps": {"one": {"title": "x", "from": "short"}}},
            "sweeps.one.from: got 'short', expected steady or long",
        ),
        (
            {"sweeps": {"one": {"title": "x", "along": [2, 1]}}},
            "sweeps.one.along: got [2, 1], expected rising numbers",
        ),
        ({"scenes": []}, "scenes: got a list of 0, expected"),
        ({"scenes": ["a", "c"]}, "scenes[1]: got 'c', expected a or b"),
        ({"factor": 1}, "factor: got 1, expected a number > 1 and <= 9"),
        ({"factor": "2"}, "factor: got '2', text, not a number (write 2), expected"),
        ({"factor": "1,000.5"}, "factor: got '1,000.5', text, not a number (write 1000.5, without"),
        ({"factor": True}, "factor: got true, expected"),
        ({"factor": float("nan")}, "factor: got .nan, expected a number > 1 and <= 9"),
        ({"aim": -1}, "aim: got -1, expected low, high or a number >= 0"),
    ],
)
def test_the_first_fault_of_a_record_is_refused_in_one_line(changes, message):
    with pytest.raises(SceneError) as caught:
        record(Plan, plan(**changes), "plan.yaml")
    assert str(caught.value).startswith(f"plan.yaml: {message}")


def test_files_of_records_may_have_anchors_and_merge_keys(tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(
        "scenes: [a]\nsweeps:\n  one: {title: x, set: &set {a.b: 1, a.c: 2}}\n"
        "  two: {title: y, set: {<<: *set, a.b: 3}}\n"
    )
    assert read_record(Plan, path).sweeps["two"].settings == {"a.b": 3, "a.c": 2}


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("- a\n", "got a list of 1, expected a block of keys"),
        ("scenes: &a [*a]\n", "got more than 20 nested blocks"),
    ],
)
def test_files_without_a_record_are_refused(text, problem, tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(text)
    with pytest.raises(SceneError, match=problem):
        read_record(Plan, path)


def test_part_at_finds_fields_by_their_path():
    assert part_at(file_part(Plan), "sweeps.one.title").key.meaning == "Heading"
    assert part_at(file_part(Plan), "sampling.seed").unit == "1"
    assert part_at(file_part(Plan), "scenes[0]").allowed == "a or b"
    assert part_at(file_part(Plan), "nothing.here") is None
