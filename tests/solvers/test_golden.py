"""No number of these solves and lives changes unnoticed.

`python tests/solvers/test_golden.py` renews the golden file, which needs a reason in the commit.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

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
    """Returns numbers of one of the CASES by name, as flat lists; of a steady one the life, too."""
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
    result = {n: np.asarray(values[n]).ravel().tolist() for n in NAMES}
    if fidelity == "steady":
        result["life"] = [life(scene).values["life"]]
    return result


@pytest.mark.parametrize("case", CASES)
def test_numbers_are_those_of_the_golden_file(case):
    """They agree to 1e-9, by which solves of other machines differ."""
    golden = json.loads(GOLDEN.read_text())[case]
    computed = numbers(case)
    assert computed.keys() == golden.keys()
    for name, value in computed.items():
        scale = np.abs(golden[name]).max()
        assert_allclose(value, golden[name], rtol=1e-9, atol=1e-9 * scale, err_msg=name)


if __name__ == "__main__":
    GOLDEN.write_text(json.dumps({case: numbers(case) for case in CASES}, indent=1) + "\n")
