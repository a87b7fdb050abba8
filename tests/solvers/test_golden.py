"""Did any number change? Renew with `python tests/solvers/test_golden.py` and say why."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import benchmark

from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve

HERE = Path(__file__).resolve().parent
GOLDEN = HERE / "golden.json"
SCENES = HERE.parents[1] / "config" / "scenes"
CASES = {
    f"{name} {method} mu {mu} loss {loss} {fidelity}": (name, method, mu, loss, fidelity)
    for name in ("gyro_s1", "gyro_s2", "gyro_s1_drag")
    for method in ("constant_force", "fixed_position")
    for mu, loss in ((0.02, 0.5), (0.08, 0.0))
    for fidelity in ("steady", "race_control")
}
NAMES = (
    "contact_load", "contact_angle", "qv", "ball_angular_velocity", "orbit_speed",
    "residual_preload", "shaft_torque", "axial_stiffness", "ball_diameter_loss_rate",
    "gyroscopic_slip_share",
)  # fmt: skip


def numbers(case):
    name, method, mu, loss, fidelity = CASES[case]
    scene = load_scene(
        SCENES / f"{name}.yaml",
        [
            f"operation.preload_method={method}",
            f"friction.ball_race={mu}",
            f"wear.ball_diameter_loss_um={loss}",
        ],
    )
    values = solve(scene, fidelity).values
    found = {n: np.asarray(values[n]).ravel().tolist() for n in NAMES}
    if fidelity == "steady":
        found["life"] = life(scene).values["life"].tolist()
    return found


@pytest.mark.parametrize("case", CASES)
def test_golden(case):
    golden = json.loads(GOLDEN.read_text())[case]
    found = numbers(case)
    assert found.keys() == golden.keys()
    for name, value in found.items():
        scale = np.abs(golden[name]).max()
        assert_allclose(value, golden[name], rtol=1e-9, atol=1e-9 * scale, err_msg=name)


@pytest.mark.parametrize(
    ("name", "one", "other", "said"),
    [
        ("qv", [1.0, 1e-12], [1.0 + 5e-10, 3e-12], ""),  # of the largest value
        ("qv", [1.0, 0.5], [1.0, 0.5 + 2e-9], "2.0e-09 of 1, allowed 1e-09"),
        ("qv", [1.0], [1.0, 1.0], "shape (1,) in A, (2,) in B"),
        ("qv", [1.0, float("nan")], [float("nan"), 1.0], "[1.0, NaN] in A, [NaN, 1.0] in B: not a"),
        ("qv_residual", 1e-11, 3e-11, ""),
        ("qv_residual", 1e-11, 3e-9, "3.0e+02 of 1e-11"),
        ("races", [3, 4], [3, 5], "[3, 4] in A, [3, 5] in B"),
        ("status", ["ok"], ["lifted_off"], '["ok"] in A'),
        ("life", {"force": 1.0}, {"force": 2.0}, "force 1.0e+00 of 1"),
        ("life", {"force": 1.0}, {"position": 1.0}, '{"force": 1.0} in A'),
    ],
)
def test_what_two_files_of_golden_numbers_differ_in(name, one, other, said):
    found = benchmark("golden").difference(name, one, other, 1e-9)
    assert found.startswith(said) and bool(found) == bool(said)


if __name__ == "__main__":
    GOLDEN.write_text(json.dumps({case: numbers(case) for case in CASES}, indent=1) + "\n")
