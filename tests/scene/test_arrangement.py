"""The block `arrangement`: what it takes, and one line for what it does not."""

import copy
import pickle

import pytest
from support import scene_file

from bearingwear.scene.arrangement import held_by, one_bearing
from bearingwear.scene.read import SceneError, as_scene, load_scene

FIXED = "operation.preload_method=fixed_position"
RIGID = (FIXED, "arrangement.kind=rigid_pair")
LOSS = "wear.ball_diameter_loss_um"


def read(*settings, name="gyro_s1"):
    return load_scene(scene_file(name), settings)


@pytest.mark.parametrize(
    ("settings", "key", "texts"),
    [
        (("arrangement.kind=double",), "arrangement.kind", ("'double'", "rigid_pair")),
        (("arrangement.kind=rigid_pair",), "arrangement.kind", ("constant_force", "spring_pair")),
        ((FIXED, "arrangement.kind=spring_pair"), "arrangement.kind", ("rigid_pair",)),
        (("arrangement=[1]",), "arrangement", ("block of keys",)),
        (("arrangement.orientation=tandem",), "arrangement.orientation", ("back_to_back",)),
        (("arrangement.external_axial_N=1",), "arrangement.external_axial_N", ("kind single",)),
        ((*RIGID, "arrangement.external_axial_N=.inf"), "arrangement.external_axial_N", ("inf",)),
        ((*RIGID, "arrangement.external_axial_N=1e9"), "arrangement.external_axial_N", ("1000",)),
        ((*RIGID, "arrangement.external_axial_N=much"), "arrangement.external_axial_N", ("much",)),
        ((*RIGID, "arrangement.spring_stiffness_N_um=1"), "arrangement.spring_stiffness_N_um",
         ("rigid_pair", "spring_pair")),
        (("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=-1"),
         "arrangement.spring_stiffness_N_um", ("-1",)),
        ((*RIGID, "arrangement.rotor_mass_kg=0"), "arrangement.rotor_mass_kg", ("> 0",)),
        ((*RIGID, "arrangement.span_mm=-20"), "arrangement.span_mm", ("-20",)),
        ((*RIGID, "arrangement.span_mm=true"), "arrangement.span_mm", ("true",)),
        ((*RIGID, "arrangement.rotor_transverse_inertia_kg_mm2=0"),
         "arrangement.rotor_transverse_inertia_kg_mm2", ("> 0",)),
        ((*RIGID, "arrangement.tandem=2"), "arrangement.tandem", ("2",)),
        ((*RIGID, "arrangement.tandem=[2]"), "arrangement.tandem", ("list of 1",)),
        ((*RIGID, "arrangement.tandem=[2, 1, 1]"), "arrangement.tandem", ("list of 3",)),
        ((*RIGID, "arrangement.tandem=[0, 1]"), "arrangement.tandem[0]", ("got 0",)),
        ((*RIGID, "arrangement.tandem=[1, 9]"), "arrangement.tandem[1]", ("got 9",)),
        ((*RIGID, "arrangement.tandem=[1.5, 1]"), "arrangement.tandem[0]", ("1.5",)),
        ((*RIGID, "arrangement.tandem=[a, 1]"), "arrangement.tandem[0]", ("'a'",)),
        (("arrangement.tandem=[2, 1]",), "arrangement.tandem", ("list of 2", "kind single")),
        ((*RIGID, "arrangement.second=3"), "arrangement.second", ("3", "KEY: VALUE")),
        (("arrangement.second.friction.ball_race=0.1",), "arrangement.second", ("kind single",)),
        ((*RIGID, "arrangement.second={operation.preload_N: 9}"),
         "arrangement.second.operation.preload_N", ("share",)),
        ((*RIGID, "arrangement.second={operation.shaft_speed_rpm: 9}"),
         "arrangement.second.operation.shaft_speed_rpm", ("share",)),
        ((*RIGID, "arrangement.second={wear.end_of_life: {skid_ratio: 0.1}}"),
         "arrangement.second.wear.end_of_life.skid_ratio", ("share",)),
        ((*RIGID, "arrangement.second={model.strips: 9}"), "arrangement.second.model.strips",
         ("share",)),
        ((*RIGID, "arrangement.second={arrangement.kind: single}"),
         "arrangement.second.arrangement.kind", ("share",)),
        ((*RIGID, "arrangement.second={name: other}"), "arrangement.second.name", ("share",)),
        ((*RIGID, "arrangement.second={'': 3}"), "arrangement.second", ("share",)),
        ((*RIGID, "arrangement.second={friction: 3}"), "arrangement.second.friction", ("share",)),
        ((*RIGID, "arrangement.second={friction.ball_rase: 0.1}"),
         "arrangement.second.friction.ball_rase", ("ball_race",)),
        ((*RIGID, "arrangement.second={friction.ball_race: 9}"),
         "arrangement.second.friction.ball_race", ("9",)),
        ((*RIGID, "arrangement.second={bearing.ball_count: 99}"),
         "arrangement.second.bearing.ball_count", ("99",)),
        ((*RIGID, f"arrangement.second={{{LOSS}: -1}}"), f"arrangement.second.{LOSS}", ("-1",)),
        ((*RIGID, "arrangement.third=1"), "arrangement.third", ("unknown key",)),
        (("wear.end_of_life.rotor_shift_um=0",), "wear.end_of_life.rotor_shift_um", ("> 0",)),
        (("wear.end_of_life.system_axial_stiffness_N_um=-3",),
         "wear.end_of_life.system_axial_stiffness_N_um", ("-3",)),
        (("wear.end_of_life.friction_used_by_gyroscopic_moment=x",),
         "wear.end_of_life.friction_used_by_gyroscopic_moment", ("'x'",)),
    ],
)  # fmt: skip
def test_refused(settings, key, texts):
    with pytest.raises(SceneError) as caught:
        read(*settings)
    said = str(caught.value)
    assert "\n" not in said
    assert f"{key}: given" in said or f"{key}: " in said
    for text in texts:
        assert text in said


def test_second_bearing():
    """Keys may stand as one, or as blocks; what they leave alone is as in the first."""
    flat = read(*RIGID, f"arrangement.second={{{LOSS}: 0.25, friction.ball_race: 0.1}}")
    nested = read(
        *RIGID, f"arrangement.second.{LOSS}=0.25", "arrangement.second.friction.ball_race=0.1"
    )
    assert flat == nested
    first, second = flat.sides
    assert (first.friction.ball_race, second.friction.ball_race) == (0.08, 0.1)
    assert (first.wear.ball_diameter_loss_um, second.wear.ball_diameter_loss_um) == ((0,), (0.25,))
    assert first.pair is None and second.pair is None
    assert second.bearing == first.bearing
    each = read(*RIGID, f"arrangement.second={{{LOSS}: [{', '.join(map(str, range(1, 10)))}]}}")
    assert each.sides[1].wear.ball_diameter_loss_um == tuple(range(1, 10))


def test_scene_of_a_pair_is_whole():
    made = read(*RIGID, f"arrangement.second={{{LOSS}: 0.25}}", "arrangement.span_mm=20")
    assert as_scene(made.to_dict()) == made == as_scene(made)
    assert pickle.loads(pickle.dumps(made)) == copy.deepcopy(made) == made
    assert hash(made) == hash(as_scene(made.to_dict()))
    assert hash(made) != hash(read(*RIGID))
    assert made.sides[0].arrangement.span_mm == 20.0


def test_single_is_the_default():
    """A scene that says nothing has no block; one that says single is no pair."""
    plain = read()
    assert "arrangement" not in plain.to_dict()
    assert plain.sides == (plain,)
    assert read("arrangement.kind=single").pair is None


def test_held_by_another_method():
    rigid = read(*RIGID, "arrangement.external_axial_N=2")
    spring = held_by(rigid, "constant_force", 9.0)
    assert spring.arrangement.kind == "spring_pair"
    assert spring.arrangement.external_axial_N == 2.0
    assert spring.operation.preload_N == 9.0
    soft = read("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=0.1")
    assert held_by(soft, "fixed_position").arrangement.spring_stiffness_N_um == 0.0
    assert held_by(read(), "fixed_position").arrangement is None


def test_studies_of_states_of_wear_take_one_bearing():
    assert one_bearing(read(), "x").pair is None
    with pytest.raises(SceneError, match="arrangement.kind: got rigid_pair"):
        one_bearing(read(*RIGID), "mine.yaml")
