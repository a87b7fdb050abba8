"""A warm-up by explicit Euler steps over `bearingwear.solve` alone, to compare `warmup` with.

Written from the equations: each step solves the scene at the speed and the temperatures of its
instant, and takes the heat of its contacts from the result.

    python benchmarks/warmup.py mine.yaml --seconds 30 --steps 4000
"""

from __future__ import annotations

import argparse
import math
import warnings

import bearingwear


def euler(scene, seconds: float, duration: float, steps: int) -> dict[str, list[float]]:
    """Temperatures [degC], preload [N] and pressure [Pa] over time [s] of one bearing.

    scene: with a thermal network and heat capacities; its shaft and housing may follow.
    """
    data = scene.to_dict()
    network, speed = data["thermal"], data["operation"]["shaft_speed_rpm"]
    G, C = network["conductance_W_K"], network["heat_capacity_J_K"]
    start = network.get("reference_C", 20.0)
    inner = balls = outer = start
    course: dict[str, list[float]] = {"time": [], "inner": [], "balls": [], "outer": []}
    course |= {"preload": [], "pressure": []}
    dt = duration / steps

    def beside(part: str, time: float) -> float:
        end, constant = network[f"{part}_C"], network.get(f"{part}_time_constant_s", 0.0)
        return end + (start - end) * math.exp(-time / constant) if constant else end

    for k in range(steps + 1):
        time = k * dt
        share = min(time / seconds, 1.0) if seconds else 1.0
        # below a hundredth of the speed the heat goes in proportion to it
        whole = max(share, 0.01)
        parts = {"inner_ring_C": inner, "balls_C": balls, "outer_ring_C": outer}
        parts |= {f"{part}_C": beside(part, time) for part in ("shaft", "housing")}
        case = bearingwear.solve(
            scene.with_(
                {"operation.shaft_speed_rpm": whole * speed, "thermal": None}
                | {"temperature": parts | {"reference_C": start}}
            )
        )
        if str(case["status"].values) != "ok":
            raise SystemExit(f"no state after {time:g} s")
        # one ball may stand for all
        balls_each = data["bearing"]["ball_count"] / case.sizes.get("ball", 1)
        heat_inner, heat_outer = (
            share / whole * balls_each * float(case["friction_heat"].sel(race=race).sum())
            for race in ("inner", "outer")
        )
        drag = share / whole * float(case.get("drag_power", 0.0))
        for name, value in (("time", time), ("inner", inner), ("balls", balls), ("outer", outer)):
            course[name].append(value)
        course["preload"].append(float(case["residual_preload"]))
        course["pressure"].append(float(case["maximum_pressure"].max()))
        from_shaft = G["inner_ring_shaft"] * (beside("shaft", time) - inner)
        from_housing = G["outer_ring_housing"] * (beside("housing", time) - outer)
        from_balls = [G["ball_race"] * (balls - ring) for ring in (inner, outer)]
        inner += dt / C["inner_ring"] * (0.5 * heat_inner + from_shaft + from_balls[0])
        outer += dt / C["outer_ring"] * (0.5 * heat_outer + drag + from_housing + from_balls[1])
        balls += dt / C["balls"] * (0.5 * (heat_inner + heat_outer) - sum(from_balls))
    return course


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--duration", type=float, default=200.0)
    parser.add_argument("--steps", type=int, default=2000)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    course = euler(bearingwear.load(given.scene), given.seconds, given.duration, given.steps)
    peak = max(range(len(course["time"])), key=lambda k: course["preload"][k])
    print(f"largest preload {course['preload'][peak]:.6g} N at {course['time'][peak]:.4g} s")
    for name in ("inner", "balls", "outer", "preload", "pressure"):
        print(f"{name}: {course[name][-1]:.6g} after {given.duration:g} s")


if __name__ == "__main__":
    main()
