"""What equal strips and Gauss points on the contact ellipse cost in accuracy.

    python benchmarks/quadrature.py

The steady state of the 2 mm bearing of the published benchmark and of gyro_s1, each against the
same case with 2 x 400 Gauss points; and the share that the regularisation adds.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"
RULES = [("strips", n) for n in (20, 50, 100, 200, 400)] + [
    ("gauss", n) for n in (10, 20, 30, 50, 100)
]


def values(scene, quadrature, points, v_r=None):
    model = replace(scene.model, quadrature=quadrature, strips=points)
    friction = scene.friction
    if v_r is not None:
        friction = replace(friction, slip_regularisation_m_s=v_r)
    result = solve(replace(scene, model=model, friction=friction))
    assert result.status == "ok"
    return result.values


def scenes():
    base = replace(load_scene(SCENE), cage=None)
    small = replace(
        base.bearing,
        ball_count=10,
        pitch_diameter_mm=9.0,
        contact_angle_deg=25.0,
        inner_groove_factor=0.565,
    )
    for mu in (0.02, 0.08):
        friction = replace(base.friction, ball_race=mu)
        yield f"2 mm bearing, mu {mu}", replace(base, bearing=small, friction=friction)
        yield f"gyro_s1, mu {mu}", replace(base, friction=friction)


def main():
    print(
        f"{'':24s} {'rule':>12s} {'QV inner':>10s} {'QV outer':>10s} {'QV total':>10s} "
        f"{'w_y':>10s} {'loss rate':>10s} {'estimate':>10s}"
    )
    for name, scene in scenes():
        exact = values(scene, "gauss", 800)
        for quadrature, points in RULES:
            v = values(scene, quadrature, points)
            errors = [
                *np.abs(v["qv"][0] / exact["qv"][0] - 1),
                abs(v["total_qv"] / exact["total_qv"] - 1),
                abs(v["ball_angular_velocity"][0, 1] / exact["ball_angular_velocity"][0, 1] - 1),
                abs(v["ball_diameter_loss_rate"] / exact["ball_diameter_loss_rate"] - 1),
                v["discretisation_error_qv"],
            ]
            print(
                f"{name:24s} {quadrature:>7s} {points:4d} " + " ".join(f"{e:10.1e}" for e in errors)
            )
    print("\nregularisation v_r, 2 x 400 Gauss points, against 1e-5 m/s")
    for name, scene in scenes():
        exact = values(scene, "gauss", 800, 1e-5)
        for v_r in (1e-2, 3e-3, 1e-3, 3e-4, 1e-4):
            v = values(scene, "gauss", 800, v_r)
            errors = [
                *np.abs(v["qv"][0] / exact["qv"][0] - 1),
                abs(v["total_qv"] / exact["total_qv"] - 1),
            ]
            print(f"{name:24s} {v_r:12.0e} " + " ".join(f"{e:10.1e}" for e in errors))


if __name__ == "__main__":
    main()
