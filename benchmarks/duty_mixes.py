"""Random mixes of phases by plain sums, to compare lives over a duty with.

Written from the equations of docs/theory/27-duty.md. Even wear: hours by an integral over the loss
of the phases' own life histories, with starts as sums over speeds,

    t = integral of dL / ((sum of h_k r_k(L) + n_k J_k(L)) / T).

Worn grooves, and all with --film: the phases run one after the other, with what is worn carried on,
beyond the wear-through of the films.

    python benchmarks/duty_mixes.py [--seed 52] [--mixes 10] [--only 3] [--film]
"""

from __future__ import annotations

import argparse
import warnings
from types import SimpleNamespace

import numpy as np
from scipy.interpolate import CubicSpline

import bearingwear
from bearingwear.lives.grooves import Grooves
from bearingwear.lives.surfaces import Surfaces
from bearingwear.solvers.compose import solver_of

UM, HOUR = 1e-6, 3600.0
RAMP_SPEEDS = 10  # of a midpoint sum over a ramp
LOSSES = 5  # at which it is taken
CYCLES = 80  # in which worn grooves are carried on to the end
FILM_CYCLES = 240  # where rates jump as a film is gone


def random_scene(rng: np.random.Generator, worn: bool, film: bool = False):
    """The gyro with two to five phases of random conditions and hours, and maybe starts."""
    names = [f"phase_{k}" for k in range(rng.integers(2, 6 if not worn else 4))]
    method = "fixed_position" if rng.random() < 0.6 else "constant_force"
    cases, phases = {}, {}
    for name in names:
        cases[name] = {
            "operation.shaft_speed_rpm": float(rng.uniform(4e3, 36e3)),
            "friction.ball_race": float(rng.uniform(0.05, 0.15)),
        }
        if method == "fixed_position":
            outer = float(rng.uniform(-10.0, 50.0))
            cases[name] |= {
                "temperature.inner_ring_C": outer + float(rng.uniform(-0.5, 1.5)),
                "temperature.balls_C": outer + float(rng.uniform(-0.3, 1.0)),
                "temperature.outer_ring_C": outer,
            }
        phases[name] = {"hours": float(np.exp(rng.uniform(-1.0, 2.0)))}
        if rng.random() < 0.4:
            phases[name]["starts"] = float(rng.integers(1, 4))
    changes = {
        "uncertainty": None,
        "cage": None,
        "model.contact": "worn" if worn else "hertz",
        "operation.preload_method": method,
        "wear.end_of_life": {"ball_diameter_loss_um": 0.15},
        "friction.slip_regularisation_m_s": 1e-4,
        "cases": cases,
        "duty": {"phases": phases, "start_s": 200.0, "stop_s": 100.0},
    }
    if rng.random() < 0.4:
        changes["arrangement.kind"] = "rigid_pair" if method == "fixed_position" else "spring_pair"
    if film:
        changes["friction.ball_race"] = None
        changes["friction.film"] = {
            "shear_strength_MPa": float(rng.uniform(0.0, 10.0)),
            "pressure_coefficient": 0.06,
            "thickness_um": float(rng.uniform(0.01, 0.06)),
            "wear_coefficient": float(rng.uniform(5e-7, 2e-6)),
        }
        for case in cases.values():
            case["friction.film.bare_ball_race"] = case.pop("friction.ball_race")
    return bearingwear.example().with_(changes)


def at_speed(scene, share: float):
    """A scene at a share of its speed, and of its regularisation."""
    speed, v_r = scene.operation.shaft_speed_rpm, scene.friction.slip_regularisation_m_s
    return scene.with_(
        {
            "operation.shaft_speed_rpm": share * speed,
            "friction.slip_regularisation_m_s": share * v_r,
        }
    )


def midpoints(n: int) -> np.ndarray:
    return (np.arange(n) + 0.5) / n


def even_hours(scene) -> float:
    """Life of evenly worn bearings by the histories of the phases alone [h]."""
    duty, losses, mean = scene.duty, None, 0.0
    cycle = sum(HOUR * p.hours + p.starts * duty.ramp_s for p in duty.phases.values())
    for name, phase in duty.phases.items():
        alone = scene.in_cases[name].with_({"duty": None, "cases": None})
        own = bearingwear.life(alone)
        time = HOUR * np.ravel(own["history_time"])
        # two bearings of a pair are alike
        loss = np.ravel(own["history_ball_diameter_loss"])[: time.size]
        if losses is None:
            losses = np.linspace(0.0, 0.15 * UM, 201)
        slope = CubicSpline(loss, time).derivative()(losses)
        mean = mean + HOUR * phase.hours / slope / cycle
        if phase.starts:
            coarse = np.linspace(0.0, 0.15, LOSSES)
            wear = [
                np.mean([_even_rate(at_speed(alone, s), x) for s in midpoints(RAMP_SPEEDS)])
                for x in coarse
            ]
            start = CubicSpline(UM * coarse, wear)(losses)
            mean = mean + phase.starts * duty.ramp_s * start / cycle
    return float(np.trapezoid(1.0 / mean, losses)) / HOUR


def _even_rate(scene, loss_um: float) -> float:
    case = bearingwear.solve(scene.with_({"wear.ball_diameter_loss_um": loss_um}))
    return float(np.ravel(case["ball_diameter_loss_rate"])[0])


class _Grooves:
    """A phase of worn grooves, on the grids that all share."""

    def __init__(self, scene):
        self.way = Grooves(scene)
        self.start = self.way.start

    def share(self, first):
        for own, shared in zip(self.way.sides, first.way.sides, strict=True):
            own.bearing.lie_on(shared.bearing)

    def rates(self, worn):
        states = self.way.state(worn)
        assert all(state.status == 0 for state in states)
        return self.way.rates(SimpleNamespace(states=states, worn=worn)), states[0].loss

    def after(self, worn, span, rates):
        return tuple(w.plus(span, r) for w, r in zip(worn, rates, strict=True))


class _Surfaces(_Grooves):
    """A phase of evenly worn surfaces, whose films all phases share."""

    def __init__(self, scene):
        self.way = Surfaces(scene.symmetric_half, solver_of(scene))
        self.start = self.way.start

    def share(self, first):
        for own, shared in zip(self.way.bearings, first.way.bearings, strict=True):
            own.coating = shared.coating

    def after(self, worn, span, rates):
        worn = worn + span * rates
        for coating, depths in self.way.films_at(worn):
            coating.is_left &= coating.share_left(depths) > 0.0
        return worn


def hours_one_by_one(scene, about: float, kind: type[_Grooves], cycles: int) -> float:
    """Life of phases run one after the other in short cycles, of about so many hours [h]."""
    duty, spans = scene.duty, []
    for name, phase in duty.phases.items():
        one = scene.in_cases[name]
        spans.append((one, phase.hours * HOUR))
        for s in midpoints(RAMP_SPEEDS // 2) if phase.starts else ():
            time = phase.starts * duty.ramp_s / (RAMP_SPEEDS // 2)
            spans.append((at_speed(one, s), time))
    ways = [kind(one) for one, _ in spans]
    for other in ways[1:]:
        other.share(ways[0])
    times = np.array([time for _, time in spans])
    times *= about * HOUR / cycles / times.sum()
    worn, passed, before = ways[0].start, 0.0, {}
    for way in ways:
        way.rates(worn)  # losses count from the unworn grooves
    while True:
        for way, span in zip(ways, times, strict=True):
            rates, loss = way.rates(worn)
            if loss >= 0.15 * UM:  # even in each phase of its own: the first ends the life
                then, lost = before[way]
                share = (0.15 * UM - lost) / (loss - lost)
                return (then + share * (passed - then)) / HOUR
            before[way] = passed, loss
            half_rates, _ = way.rates(way.after(worn, 0.5 * span, rates))
            worn = way.after(worn, span, half_rates)
            passed += span


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=52)
    parser.add_argument("--mixes", type=int, default=10)
    parser.add_argument("--only", type=int, help="one mix alone")
    parser.add_argument("--film", action="store_true", help="films on the races")
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    worst = 0.0
    for k in range(args.mixes) if args.only is None else [args.only]:
        rng, worn = np.random.default_rng([args.seed, k]), k % 5 > 2
        scene = random_scene(rng, worn, args.film)
        found = bearingwear.life(scene)
        hours = float(found["life"])
        if worn or args.film:
            cycles, way = FILM_CYCLES if args.film else CYCLES, _Grooves if worn else _Surfaces
            plain = hours_one_by_one(scene, hours, way, cycles)
        else:
            plain = even_hours(scene)
        worst = max(worst, abs(hours / plain - 1.0))
        kind = "worn" if worn else "even"
        pair = scene.arrangement.kind if scene.arrangement else "single"
        starts = sum(p.starts for p in scene.duty.phases.values())
        print(
            f"{k} {kind} {scene.operation.preload_method} {pair}, {len(scene.duty.phases)} phases, "
            f"{starts:g} starts: {hours:.6g} h, plain {plain:.6g} h, "
            f"{100.0 * (hours / plain - 1.0):+.3f} %",
            flush=True,
        )
    print(f"worst: {100.0 * worst:.3f} %")


if __name__ == "__main__":
    main()
