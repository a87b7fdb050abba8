"""Films, running in and depths of grooves in lives by every model, against each other."""

import math

import numpy as np
import pytest

from bearingwear.kernels import status as code
from bearingwear.lives.life import life
from bearingwear.lives.motion import Motion, Run
from bearingwear.scene.blocks import CRITERIA
from bearingwear.solvers.solve import solve
from bearingwear.solvers.state import State

STEEL = "materials.bearing_steel"
BALLS = 3
# Three balls move as nine do, each under the same load, in a third of the time.
ALONE = {
    "bearing.ball_count": BALLS,
    "operation.preload_N": 7.0 / 9.0 * BALLS,
    "operation.preload_method": "fixed_position",
    "model.simulated_turns": 6,
    "model.evaluated_turns": 3,
    "model.life_steps": 8,
    "cage": None,
    "uncertainty": None,
}
FILM = {
    "friction.ball_race": None,
    "friction.film": {
        "shear_strength_MPa": 24.8,
        "pressure_coefficient": 0.001,
        "thickness_um": 0.05,
        "wear_coefficient": 1e-6,
        "bare_ball_race": 0.1,
    },
}
PRESSED = {
    "friction.film.wear_table": [
        {"pressure_MPa": 600, "temperature_C": 20, "relative_life": 10.0},
        {"pressure_MPa": 1050, "temperature_C": 20, "relative_life": 1.0},
    ]
}
ON_BALLS = {
    f"{STEEL}.film": {"thickness_um": 0.03, "wear_coefficient": 1e-6},
    "friction.film.thickness_um": None,
}
RUNNING_IN = {f"{STEEL}.running_in": {"wear_coefficient": 5e-5, "depth_um": 0.05}}
LOSS = {"wear.end_of_life": {"ball_diameter_loss_um": 0.2}}
DEPTH = {"wear.end_of_life": {"groove_depth_um": 0.1}}
SHARE = {"wear.end_of_life": {"film_worn_share": 0.5}}


@pytest.mark.parametrize(
    "changes",
    [
        FILM | LOSS | PRESSED | {"wear.counts": "ball"},
        FILM | LOSS | ON_BALLS,
        RUNNING_IN | LOSS,
        FILM | DEPTH,
    ],
    ids=["pressed, ball", "on balls", "running in", "depth"],
)
def test_a_dynamic_life_with_equal_balls_agrees_with_the_steady_one(scene, changes):
    s = scene("gyro_s1", ALONE | changes)
    v, steady = life(s, "dynamic").values, life(s, "steady").values
    assert v["status"] == code.OK and v["end_criterion"] == steady["end_criterion"]
    relative = abs(v["life"] / steady["life"] - 1.0)
    assert relative <= 0.01 and relative <= v["life_error_estimate"] <= 0.06
    for name in ("race_film_worn_through", "ball_film_worn_through"):
        if name in steady:
            np.testing.assert_allclose(v[name], steady[name], rtol=5e-3)
    if "groove_depth_um" in changes.get("wear.end_of_life", {}):
        assert v["history_greatest_depth"][-1] == pytest.approx(0.1e-6, rel=1e-3)


def test_a_film_lasts_as_long_as_its_depth_over_archards_rate(scene):
    """Under a constant force hardly anything changes: h/(n K QV/(H 4 pi r a)) of a case alone."""
    s = scene("gyro_s1", ALONE | FILM | SHARE | {"operation.preload_method": "constant_force"})
    case, v = solve(s, "steady").values, life(s, "dynamic").values
    qv, track = case["qv"][0], case["contact_track_radius"][0]
    rate = BALLS * 1e-6 * qv / 6.6e9 / (4.0 * math.pi * track * case["semi_major_axis"][0])
    assert v["life"] == pytest.approx(0.05e-6 / rate.max(), rel=5e-3)
    assert v["history_film_worn_share"][-1].max() == 1.0


def test_the_deepest_groove_of_every_model(scene):
    """While next to nothing has worn: along the middle of the ellipse, and over all of it."""
    shallow = {"wear.end_of_life": {"groove_depth_um": 0.004}, "wear.track_wander": 0.0}
    base = ALONE | shallow | {"operation.preload_method": "constant_force"}
    result = {
        kind: life(scene("gyro_s1_hertz", base | {"model.contact": contact}), fidelity).values
        for kind, fidelity, contact in (
            ("worn", "steady", "worn"),
            ("steady", "steady", "hertz"),
            ("dynamic", "dynamic", "hertz"),
        )
    }
    assert {CRITERIA[v["end_criterion"]] for v in result.values()} == {"groove_depth_um"}
    t = {kind: v["life"] for kind, v in result.items()}
    assert t["dynamic"] == pytest.approx(t["steady"], rel=1e-3)
    assert 1.0 < t["worn"] / t["steady"] < 1.1  # slip across the ellipse fills the valley


def test_the_deepest_groove_by_hand(scene):
    """Strips of equal width wear as their slip times their share of Hertz' load."""
    base = ALONE | {"wear.end_of_life": {"groove_depth_um": 1e-4}, "model.contact": "hertz"}
    s = scene("gyro_s1", base | {"operation.preload_method": "constant_force"})
    case, v = solve(s, "steady").values, life(s, "steady").values
    rates = []
    for k in range(2):
        slip = np.hypot(case["gyroscopic_slip"][0, k], case["rolling_slip"][0, k])
        edges = np.linspace(-1.0, 1.0, slip.size + 1)
        load = np.diff(edges - edges**3 / 3.0)
        share = (slip * load / (slip * load).sum()).max()
        area = 2.0 * math.pi * case["contact_track_radius"][0, k] * np.diff(edges)[0]
        volume = case["race_wear_rate"][k] * share
        rates.append(volume / area / case["semi_major_axis"][0, k])
    assert v["life"] == pytest.approx(1e-10 / max(rates), rel=2e-3)


def test_a_cage_does_not_keep_a_film_from_its_end(scene):
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.12, "pocket_clearance_mm": 0.5}}
    short = {"model.life_run_in_turns": 3, "model.life_steps": 3, "model.simulated_turns": 3}
    s = scene("gyro_s1", {name: value for name, value in ALONE.items() if name != "cage"})
    v = life(s.with_(FILM | end | short), "dynamic").values
    assert v["status"] == code.OK and CRITERIA[v["end_criterion"]] == "ball_diameter_loss_um"
    assert np.isfinite(v["race_film_worn_through"]).any()
    assert min(v["history_start"][1:]) == 1  # the run without film goes on from the one before
    assert v["life"] == pytest.approx(v["steady_life"], rel=0.05)


def test_a_radial_load_wears_a_film_through(scene):
    few = {"model.simulated_turns": 3, "model.evaluated_turns": 1, "model.life_steps": 4}
    s = scene("gyro_s1", ALONE | FILM | LOSS | few | {"operation.radial_load_N": [0.3, 0.0]})
    v, other = (life(s, kind).values for kind in ("dynamic", "race_control"))
    assert v["status"] == other["status"] == code.OK
    through = v["race_film_worn_through"] / other["race_film_worn_through"]
    wears_through = np.isfinite(through)  # race control estimates slip
    assert wears_through.any() and through[wears_through] == pytest.approx(1.0, abs=0.2)


def test_without_a_state_after_its_film_the_life_ends_there(scene, monkeypatch):
    s = scene("gyro_s1", ALONE | FILM | LOSS)
    solved = Motion.state

    def gone(self, worn, near=()):
        if any(self.surfaces.bare):
            return (State(code.NOT_CONVERGED, {}, Run(code.NOT_CONVERGED)),)
        return solved(self, worn, near)

    monkeypatch.setattr(Motion, "state", gone)
    v = life(s, "dynamic").values
    assert v["status"] == code.NOT_CONVERGED and CRITERIA[v["end_criterion"]] == "none"
    assert np.isfinite(v["life"])
