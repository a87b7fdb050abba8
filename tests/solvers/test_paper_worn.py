"""What becomes of the paper's statements on wear where the groove is followed as it wears.

Beside test_paper.py (its own model) and test_paper_hertz.py (a groove that keeps its shape). The
loss of diameter is the even one that gives the same preload or rotor position.
docs/verification.md says it in words.
"""

import numpy as np
import pytest

from bearingwear.kernels import status as code
from bearingwear.lives.grooves import Grooves, follow_grooves

FORCE, POSITION = "constant_force", "fixed_position"
LOSSES = np.linspace(0.0, 0.7, 15)  # um
AT_HALF = 10
INNER, OUTER = 0, 1


@pytest.fixture(scope="module")
def worn(scene):
    """Function (method, mu) -> total QV [W], preload [N], QV and gyroscopic share of the contacts,
    each at `LOSSES`.
    """
    known = {}

    def lived(method, mu):
        if (method, mu) not in known:
            changes = {
                "model.contact": "worn",
                "operation.preload_method": method,
                "friction.ball_race": mu,
                "wear.end_of_life": {"ball_diameter_loss_um": 0.75},
            }
            groove_life = follow_grooves(Grooves(scene("gyro_s1_hertz", changes)))
            assert groove_life.status == code.OK
            states = groove_life.states
            loss = [1e6 * s.loss for s in states]

            def at(values):
                return np.interp(LOSSES, loss, values)

            known[method, mu] = (
                at([s["total_qv"] for s in states]),
                at([s["residual_preload"] for s in states]),
                np.array([at([s["qv"][k] for s in states]) for k in (INNER, OUTER)]),
                np.array(
                    [at([s["gyroscopic_slip_share"][k] for s in states]) for k in (INNER, OUTER)]
                ),
            )
        return known[method, mu]

    return lived


def test_4_is_a_fit_to_the_line(worn):
    """The even loss says it: the preload that is left is by definition nearly Hertz' at 57.5 %."""
    _, preload, _, _ = worn(POSITION, 0.08)
    assert 100.0 * (1.0 - preload[AT_HALF] / 7.0) == pytest.approx(57.0, abs=1.0)


def test_5_constant_force_is_not_flat(worn):
    """The groove that wears makes QV rise by a third; with a held race it still falls."""
    spring, held = worn(FORCE, 0.08)[0], worn(POSITION, 0.08)[0]
    assert np.all(np.diff(spring) > 0.0) and 1.3 < spring[-1] / spring[0] < 1.4
    assert np.all(np.diff(held) < 0.0) and held[-1] < 0.52 * held[0]


def test_6_holds_without_drag(worn):
    """QV is least at about 0.5 um and rises with the gyroscopic slip of the outer contact."""
    qv, _, _, share = worn(POSITION, 0.02)
    least = int(np.argmin(qv))
    assert 0.4 <= LOSSES[least] <= 0.6
    assert np.all(np.diff(qv[: least + 1]) < 0.0) and np.all(np.diff(qv[least:]) > 0.0)
    assert qv[-1] > 1.04 * qv[least]
    assert share[OUTER, 0] < 0.3 and share[OUTER, -1] > 0.9


def test_7_does_not_hold(worn):
    """At 0.5 um half of the QV of the fixed position is inside, and a quarter of the spring's."""
    inside = [worn(m, 0.08)[2][INNER, AT_HALF] for m in (FORCE, POSITION)]
    whole = [worn(m, 0.08)[2][:, AT_HALF].sum() for m in (FORCE, POSITION)]
    spring, held = np.divide(inside, whole)
    assert 0.25 < spring < 0.32 and 0.5 < held < 0.62


def test_8_constant_force_rises_and_lies_above_fixed_position(worn):
    spring = worn(FORCE, 0.02)[0]
    assert np.all(np.diff(spring) > 0.0) and 1.25 < spring[-1] / spring[0] < 1.35
    for mu in (0.02, 0.08):
        assert worn(POSITION, mu)[0][AT_HALF] < 0.65 * worn(FORCE, mu)[0][AT_HALF]
