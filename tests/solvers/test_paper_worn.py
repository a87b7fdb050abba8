"""What becomes of the paper's statements on wear where the groove is followed as it wears.

Beside test_paper.py (its own model) and test_paper_hertz.py (a groove that keeps its shape). The
loss of diameter is the even one that gives the same preload or rotor position.
docs/verification.md says it in words.
"""

from typing import NamedTuple

import numpy as np
import pytest

from bearingwear.kernels import status as code
from bearingwear.lives.grooves import Grooves, follow_grooves

FORCE, POSITION = "constant_force", "fixed_position"
LOSSES = np.linspace(0.0, 0.7, 15)  # um
AT_HALF = 10  # index of 0.5 um
INNER, OUTER = 0, 1


class Histories(NamedTuple):
    """Values along a life, at the n `LOSSES`; the last two of inner and outer contact (2, n)."""

    total_qv: np.ndarray  # [W]
    preload: np.ndarray  # [N]
    contact_qv: np.ndarray  # [W]
    gyroscopic_share: np.ndarray


@pytest.fixture(scope="module")
def worn(scene):
    """Returns a function (method, mu) that returns the Histories of a life of gyro_s1_hertz.

    Its grooves are followed as they wear.
    """
    histories = {}

    def histories_of(method, mu):
        if (method, mu) not in histories:
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

            def at_losses(name, contact=...):
                return np.interp(LOSSES, loss, [np.asarray(s[name])[contact] for s in states])

            histories[method, mu] = Histories(
                at_losses("total_qv"),
                at_losses("residual_preload"),
                np.array([at_losses("qv", k) for k in (INNER, OUTER)]),
                np.array([at_losses("gyroscopic_slip_share", k) for k in (INNER, OUTER)]),
            )
        return histories[method, mu]

    return histories_of


def test_4_is_a_fit_to_the_line(worn):
    """The loss is the even one with this preload, hence it is nearly Hertz' 57.5 % that is lost."""
    preload = worn(POSITION, 0.08).preload
    assert 100.0 * (1.0 - preload[AT_HALF] / 7.0) == pytest.approx(57.0, abs=1.0)


def test_5_constant_force_is_not_flat(worn):
    """The groove that wears makes QV rise by a third; with a held race it still falls."""
    spring, held = worn(FORCE, 0.08).total_qv, worn(POSITION, 0.08).total_qv
    assert np.all(np.diff(spring) > 0.0) and 1.3 < spring[-1] / spring[0] < 1.4
    assert np.all(np.diff(held) < 0.0) and held[-1] < 0.52 * held[0]


def test_6_holds_without_drag(worn):
    """QV is least at about 0.5 um and rises with the gyroscopic slip of the outer contact."""
    qv, share = worn(POSITION, 0.02).total_qv, worn(POSITION, 0.02).gyroscopic_share
    least = int(np.argmin(qv))
    assert 0.4 <= LOSSES[least] <= 0.6
    assert np.all(np.diff(qv[: least + 1]) < 0.0) and np.all(np.diff(qv[least:]) > 0.0)
    assert qv[-1] > 1.04 * qv[least]
    assert share[OUTER, 0] < 0.3 and share[OUTER, -1] > 0.9


def test_7_does_not_hold(worn):
    """At 0.5 um half of the QV of the fixed position is inside, and a quarter of the spring's."""

    def inner_share(method):
        qv = worn(method, 0.08).contact_qv[:, AT_HALF]
        return qv[INNER] / qv.sum()

    assert 0.25 < inner_share(FORCE) < 0.32 and 0.5 < inner_share(POSITION) < 0.62


def test_8_constant_force_rises_and_lies_above_fixed_position(worn):
    """QV under constant force rises by 30 % to 0.7 um, at low friction.

    At 0.5 um, a fixed position has less than 0.65 of it, at low and at high friction.
    """
    spring = worn(FORCE, 0.02).total_qv
    assert np.all(np.diff(spring) > 0.0) and 1.25 < spring[-1] / spring[0] < 1.35
    for mu in (0.02, 0.08):
        held_qv, spring_qv = (worn(m, mu).total_qv[AT_HALF] for m in (POSITION, FORCE))
        assert held_qv < 0.65 * spring_qv
