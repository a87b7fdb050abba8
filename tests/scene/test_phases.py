"""The duty of a scene: its cycle, the cases of its phases, and duties that are refused."""

import pickle

import pytest
from support import scene_file

import bearingwear
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import SceneError

CASES = {"idle": {"operation.shaft_speed_rpm": 6000.0}, "hot": {"friction.ball_race": 0.05}}
DUTY = {
    "phases": {
        "idle": {"hours": 1.0, "starts": 2.0},
        "nominal": {"hours": 6.0},
        "late": {"hours": 0.5, "case": "hot"},
    },
    "start_s": 20.0,
    "stop_s": 60.0,
}


@pytest.fixture
def scene():
    """Returns the scene gyro_s1 with CASES and DUTY."""
    return load_scene(scene_file("gyro_s1")).with_({"cases": CASES, "duty": DUTY})


def test_a_cycle_takes_the_hours_and_the_starts_of_its_phases(scene):
    """They are 1 + 6 + 0.5 h, and two starts of 20 s with their stops of 60 s."""
    duty = scene.duty
    assert duty.cycle_s == 7.5 * 3600.0 + 2.0 * (20.0 + 60.0)
    assert sum(duty.phase_s(phase) for phase in duty.phases.values()) == duty.cycle_s


def test_a_phase_is_in_the_case_of_its_name_or_the_one_it_names(scene):
    duty = scene.duty
    assert [duty.case_of(name) for name in duty.phases] == ["idle", "nominal", "hot"]


def test_a_scene_with_a_duty_survives_files_and_pickling(scene, tmp_path):
    assert scene_from_dict(scene.to_dict()) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    bearingwear.save(scene, tmp_path / "duty.yaml")
    assert load_scene(tmp_path / "duty.yaml") == scene


def test_the_hash_of_a_scene_depends_on_its_duty(scene):
    assert hash(scene) == hash(scene.with_({}))
    assert hash(scene) != hash(scene.with_({"duty.start_s": 21.0}))


def test_a_case_has_no_duty_of_its_own(scene):
    assert all(case.duty is None for case in scene.in_cases.values())
    assert scene.in_cases["nominal"] == load_scene(scene_file("gyro_s1"))


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"duty.phases.idle": {"hours": 0.0}}, "phases.idle: got 0 hours and no starts, expected"),
        ({"duty.phases.none": {"hours": 1.0}}, "phases.none: got .none., expected a case: nominal"),
        ({"duty.phases.late.case": "cold"}, "phases.late.case: got .cold., expected a case"),
        ({"duty.phases.idle.hours": -1.0}, "phases.idle.hours: got -1.0, expected a number from 0"),
        ({"duty.phases.idle.minutes": 1.0}, "phases.idle.minutes: got an unknown key"),
        ({"duty.stop_s": "soon"}, "duty.stop_s: got .soon., text, not a number"),
        ({"duty": {"phases": {}}}, "duty.phases: got a block of 0 keys, expected one or more"),
        (
            {"duty": {"phases": {"idle": {"starts": 1.0}}}},
            "duty.phases: got a cycle that takes no time, expected hours, or start_s or stop_s",
        ),
        ({"cases.idle.duty": None}, "cases.idle.duty: got nothing for a key that all cases"),
        ({"cases.hot.wear.counts": "ball"}, "cases.hot.wear.counts: got .ball. in a case of the"),
        ({"cases.hot.bearing.ball_count": 8}, "cases.hot.bearing.ball_count: got 8 in a case"),
        (
            {
                "cases.hot.materials.bearing_steel.running_in": {
                    "wear_coefficient": 0.1,
                    "depth_um": 1.0,
                }
            },
            "running_in.[a-z_]+: got [0-9.]+ in a case",
        ),
    ],
)
def test_wrong_duties_are_refused_in_one_line(scene, changes, problem):
    with pytest.raises(SceneError, match=problem) as raised:
        scene.with_(changes)
    assert "\n" not in str(raised.value)


def test_cases_that_no_phase_names_may_change_anything(scene):
    with_case = scene.with_({"cases.fewer": {"bearing.ball_count": 8}})
    assert with_case.in_cases["fewer"].bearing.ball_count == 8
