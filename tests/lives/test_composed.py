"""Lives of pairs with a network, films and worn grooves at once: each effect knows no other."""

import numpy as np
import pytest
from lives.test_worn_pair import FIXED, NETWORK, RIGID, life_of, wears_until_gone

from bearingwear.kernels import status as code

FILM = "{shear_strength_MPa: 24.8, pressure_coefficient: 0.001, thickness_um: 0.15, "
FILM += "wear_coefficient: 5.0e-6, bare_ball_race: 0.4}"
FILMED = (f"friction.film={FILM}", "friction.ball_race=null", "uncertainty=null", NETWORK)
HARDLY = "arrangement.external_axial_N=1e-6"
NAMES = ("history_part_temperature", "history_residual_preload", "history_race_film")


@pytest.mark.long  # by twos and threes: test_composition.py, test_worn_pair.py
def test_worn_and_filmed_grooves_on_a_warm_pair():
    """Two alike are the single bearing; of two that differ, each has heat and a film of its own."""
    single, pair = life_of(FIXED, *FILMED), life_of(*RIGID, *FILMED, HARDLY)
    assert pair["status"] == single["status"] == code.OK
    assert pair["life"] == pytest.approx(single["life"], rel=1e-5)
    for name in NAMES:
        for side in pair[name]:
            assert side[-1] == pytest.approx(single[name][-1], rel=1e-3)
    unlike = life_of(*RIGID, *FILMED, "arrangement.external_axial_N=1.0")
    hertz = life_of(*RIGID, *FILMED, "arrangement.external_axial_N=1.0", contact="hertz")
    assert unlike["status"] == code.OK and np.max(unlike["heat_flow_residual"]) < 1e-6
    loaded, relieved = unlike["history_part_temperature"]
    assert np.all(loaded[:, :3] > relieved[:, :3]) and np.all(relieved[:, :3] > 20.0)
    for name in NAMES:
        assert unlike[name][:, 0] == pytest.approx(hertz[name][:, 0], rel=1e-5)
    assert all(wears_until_gone(film) for film in unlike["history_race_film"])
