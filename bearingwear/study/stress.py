"""Solves scenes far beyond the study and says how each one ends."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.io.config import scene_from_dict
from bearingwear.io.netcdf import common_attributes
from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium import cold_start, thrust_equilibrium
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.params import BallLoad
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.model import parameters
from bearingwear.model.scene import Scene, SceneError, most_balls
from bearingwear.model.solve import solved
from bearingwear.model.steady import ThrustProblem, steady_values
from bearingwear.study.extremes import Axis, Branch, ExtremesPlan, Map, changed

CERAMIC = {
    "youngs_modulus_GPa": 310.0,
    "poisson_ratio": 0.26,
    "density_kg_m3": 3200.0,
    "brinell_hardness_GPa": 15.0,
    "wear_coefficient": 5.0e-6,
}

UNNAMED = (code.NOT_CONVERGED, code.UNVERIFIED)
"""Ends that give no physical reason."""


def scene_of(base: Mapping[str, Any], drawn: Mapping[str, Any]) -> Scene:
    """The scene that a draw stands for.

    Besides keys of a scene, a draw may hold: `ball_diameter_mm` and `pitch_ratio` (pitch over ball
    diameter), to which the cage is scaled; `fill` (ball count over the most that fit);
    `stress_GPa` (a preload that presses the outer contact so, at rest and unworn); `speed_m_s` (of
    the inner race at the pitch circle); `outer_ratio` (outer speed over shaft speed);
    `radial_ratio`, `rotating_ratio` (loads over the preload); `loss_ratio` (loss of ball diameter
    over the elastic approach of both races under the preload); `cage` (its guiding race, or none);
    `pocket_clearance_ratio`, `guide_clearance_ratio` (over the room there is).

    Raises
    ------
    SceneError
        Where there is no such bearing.
    """
    data = changed(base, drawn)
    b, operation = data["bearing"], data["operation"]
    data["materials"]["silicon_nitride"] = CERAMIC
    data["wear"]["end_of_life"] = None
    old = b["ball_diameter_mm"], b["pitch_diameter_mm"]
    D = b["ball_diameter_mm"] = drawn.get("ball_diameter_mm", old[0])
    dm = b["pitch_diameter_mm"] = D * drawn.get("pitch_ratio", old[1] / old[0])
    if "fill" in drawn:
        b["ball_count"] = max(3, math.floor(drawn["fill"] * most_balls(1.001 * D, dm)))
    if "speed_m_s" in drawn:
        operation["shaft_speed_rpm"] = drawn["speed_m_s"] / (0.5e-3 * dm) / parameters.RPM
    operation["outer_speed_rpm"] = drawn.get("outer_ratio", 0.0) * operation["shaft_speed_rpm"]
    _fit_cage(data, drawn, D, dm)
    data["wear"]["ball_diameter_loss_um"] = 0.0
    if "stress_GPa" in drawn or "loss_ratio" in drawn:
        scene = scene_from_dict(data)
        if "stress_GPa" in drawn:
            data["operation"]["preload_N"] = preload_of(scene, 1e9 * drawn["stress_GPa"])
            scene = scene_from_dict(data)
        if drawn.get("loss_ratio", 0.0) > 0.0:
            loss = 1e6 * drawn["loss_ratio"] * elastic_approach(scene)
            data["wear"]["ball_diameter_loss_um"] = min(loss, 0.099e3 * D)
    for name, key in (("radial_ratio", "radial_load_N"), ("rotating_ratio", "rotating_load_N")):
        load = drawn.get(name, 0.0) * data["operation"]["preload_N"]
        data["operation"][key] = [0.0, load] if key == "radial_load_N" else load
    return scene_from_dict(data)


def _fit_cage(data: dict[str, Any], drawn: Mapping[str, Any], D: float, dm: float) -> None:
    """A cage of the pitch circle's size, or none."""
    guide = drawn.get("cage", "none")
    if guide == "none":
        data["cage"] = None
        return
    cage = data["cage"]
    cage["guiding_race"] = guide
    cage["inner_diameter_mm"], cage["outer_diameter_mm"] = dm - 0.45 * D, dm + 0.45 * D
    cage["width_mm"] = 1.5 * D
    room = dm * math.sin(math.pi / data["bearing"]["ball_count"]) - D
    cage["pocket_clearance_mm"] = drawn.get("pocket_clearance_ratio", 0.1) * 0.9 * max(room, 0.0)
    cage["guide_clearance_mm"] = drawn.get("guide_clearance_ratio", 0.1) * 0.5 * D


def at_rest(scene: Scene):
    """One ball of the unworn bearing at rest under its preload alone."""
    g = parameters.geometry(scene)
    load = BallLoad(ORBIT, 0.0, 0.0, 0.0, 0.0, 0.0)
    _, state = thrust_equilibrium(
        g, g.D0, load, float(scene.operation.preload_N), 0.0, True, cold_start()
    )
    return g, state


def elastic_approach(scene: Scene) -> float:
    """Of both races to each other through a ball, at rest and unworn [m]."""
    _, state = at_rest(scene)
    return (state.Q_i / state.hertz_i.K) ** (2 / 3) + (state.Q_o / state.hertz_o.K) ** (2 / 3)


def preload_of(scene: Scene, pressure: float) -> float:
    """Preload that presses the outer contact with about this stress at the free angle [N]."""
    g, state = at_rest(scene)
    hertz = state.hertz_o
    Q = (pressure * math.pi * hertz.c_a * hertz.c_b / 1.5) ** 3
    return min(max(g.n_balls * Q * math.sin(max(g.alpha0, 0.1)), 1e-3), 1e5)


def wrongs(scene: Scene, tier: str, values: Mapping[str, Any]) -> list[str]:
    """What is wrong with a solve: nothing, where it ended as it may."""
    status = int(values["status"])
    if status in UNNAMED:
        return [STATUS_NAMES[status]]
    if status != code.OK:
        return []
    found = [
        f"{name} is not finite"
        for name, value in values.items()
        if not np.all(np.isfinite(np.asarray(value, dtype=float)))
    ]
    checks = {"equilibrium_residual": 1e-6}
    if tier == "race_control":
        checks["equilibrium_residual"] = max(1e-9, min(1e-5, values["equilibrium_rounding"]))
    if tier == "steady":
        checks |= {
            name: max(1e-9, min(1e-5, values[rounding]))
            for name, rounding in (
                ("equilibrium_residual", "equilibrium_rounding"),
                ("friction_residual", "friction_rounding"),
                ("power_balance_error", "power_rounding"),
            )
        }
    if tier == "dynamic":
        checks |= {"energy_account_error": 1e-3}
    found += [
        f"{name} {values[name]:.1e}"
        for name, most in checks.items()
        if not abs(values[name]) <= most
    ]
    heat, qv = values["friction_heat"], values["qv"]
    if tier != "dynamic" and not np.all(heat <= scene.friction.ball_race * qv * (1.0 + 1e-9)):
        found.append("more heat than mu QV")
    if scene.operation.preload_method == "constant_force":
        preload = scene.operation.preload_N
        if not abs(values["residual_preload"] / preload - 1.0) <= 1e-6:
            found.append(f"a spring of {preload:g} N holds {values['residual_preload']:g} N")
    return found


def solved_values(scene: Scene, tier: str) -> dict[str, Any]:
    """Values of a solve, as `bearingwear.solve` finds them."""
    return solved(scene, tier, None, None)[0]


def described(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes of a file, with the versions that a case file has."""
    common = common_attributes()
    kept = ("Conventions", "source", "source_hash", "package_version", "numpy_version")
    shared = {key: common[key] for key in (*kept, "numba_version")}
    return shared | {"title": f"Extremes: {attrs['kind']}, {attrs['name']}"} | dict(attrs)


# Random scenes


def family(plan: ExtremesPlan, name: str, count: int | None = None, seed: int = 1) -> xr.Dataset:
    """How so many random scenes of a family end.

    Returns
    -------
    Dataset
        Over `trial`: status (-1: no such bearing, refused before any solve), the keys drawn,
        `wrong`: what is wrong, empty where nothing is; `states`: steady states found (0 where none
        or not asked for), and `other_qv`: by what share QV differs most among them.
    """
    of, base = plan.families[name], plan.base()
    count = of.scenes if count is None else count
    status = np.full(count, -1, dtype=np.int8)
    wrong = np.full(count, "", dtype=object)
    states, other_qv = np.zeros(count, dtype=np.int8), np.zeros(count)
    drawn = list(of.drawn(seed, count))
    for k, values in enumerate(drawn):
        try:
            scene = scene_of(base, values)
        except SceneError:
            continue
        try:
            found = solved_values(scene, of.tier)
        except Exception as error:  # noqa: BLE001 - a crash is a finding, the others go on
            wrong[k] = f"crashed: {type(error).__name__}: {error}"
            continue
        status[k] = found["status"]
        wrong[k] = "; ".join(wrongs(scene, of.tier, found))
        if found["status"] == code.OK and of.tier == "steady":
            qv = found["steady_state_total_qv"]
            states[k], other_qv[k] = len(qv), np.abs(qv / qv[0] - 1.0).max()
    columns = {"states": ("trial", states), "other_qv": ("trial", other_qv)}
    for key in of.draw:
        column = [values[key] for values in drawn]
        text = isinstance(column[0], str)
        columns[key] = ("trial", np.array(column, dtype=object if text else float))
    return xr.Dataset(
        {"status": ("trial", status), "wrong": ("trial", wrong)} | columns,
        attrs=described({"kind": "families", "name": name, "tier": of.tier, "seed": seed}),
    )


# Maps

SHOWN = ("total_qv", "skid_ratio", "residual_preload")


def share_of(values: Mapping[str, Any]) -> float:
    """Larger gyroscopic share of the slip of both contacts, NaN where nothing was solved."""
    if int(values["status"]) != code.OK:
        return math.nan
    return float(np.max(values["gyroscopic_slip_share"]))


def excess(plan: ExtremesPlan, limit: str) -> Callable[[Mapping[str, Any]], float]:
    """A number that is positive beyond a limit, NaN where that cannot be said."""
    if limit == "contact":
        lost = (code.CONTACT_LOST, code.PRELOAD_GONE)
        return lambda values: 1.0 if values["status"] in lost else -1.0
    if limit == "gyroscopic_slip":
        return lambda values: share_of(values) - plan.limits[limit]
    return lambda values: abs(float(values.get("skid_ratio", math.nan))) - plan.limits[limit]


def steady_map(plan: ExtremesPlan, name: str) -> xr.Dataset:
    """Steady states over two axes, boundaries along y, and closed-form estimates of them."""
    of: Map = plan.maps[name]
    base = changed(plan.base(), of.settings)
    base["cage"], base["wear"]["end_of_life"] = None, None

    def at(x: float, y: float) -> tuple[Scene, dict]:
        scene = scene_from_dict(changed(base, {of.x.key: x, of.y.key: y}))
        return scene, solved_values(scene, "steady")

    def found_beyond(limit: str, x: float, y: float) -> float:
        return excess(plan, limit)(at(x, y)[1])

    def estimated_beyond(limit: str, x: float, y: float) -> float:
        return estimate(plan, limit, changed(base, {of.x.key: x, of.y.key: y}))

    shape = (len(of.y.values), len(of.x.values))
    status, wrong = np.zeros(shape, dtype=np.int8), np.full(shape, "", dtype=object)
    shown = {key: np.full(shape, np.nan) for key in (*SHOWN, "gyroscopic_slip_share")}
    lines = {f"boundary_{limit}": np.full(shape[1], np.nan) for limit in of.limits}
    lines |= {f"estimate_{limit}": np.full(shape[1], np.nan) for limit in of.limits}
    for i, x in enumerate(of.x.values):
        column = []
        for j, y in enumerate(of.y.values):
            scene, values = at(x, y)
            status[j, i] = values["status"]
            wrong[j, i] = "; ".join(wrongs(scene, "steady", values))
            if values["status"] == code.OK:
                for key in SHOWN:
                    shown[key][j, i] = values[key]
                shown["gyroscopic_slip_share"][j, i] = share_of(values)
            column.append(values)
        for limit in of.limits:
            beyond = excess(plan, limit)
            lines[f"boundary_{limit}"][i] = crossing(
                of.y, [beyond(v) for v in column], partial(found_beyond, limit, x)
            )
            estimated = partial(estimated_beyond, limit, x)
            lines[f"estimate_{limit}"][i] = crossing(
                of.y, [estimated(y) for y in of.y.values], estimated
            )
    variables: dict[str, Any] = {"status": (("y", "x"), status), "wrong": (("y", "x"), wrong)}
    variables |= {key: (("y", "x"), values) for key, values in shown.items()}
    variables |= {key: ("x", values) for key, values in lines.items()}
    return xr.Dataset(
        variables,
        {"x": list(of.x.values), "y": list(of.y.values)},
        attrs=described({
            "kind": "maps", "name": name, "shown": of.title, "x_key": of.x.key, "y_key": of.y.key,
            "x_log": int(of.x.log), "y_log": int(of.y.log),
        }),
    )  # fmt: skip


def crossing(axis: Axis, found: list[float], at: Callable[[float], float]) -> float:
    """Where along an axis a number changes sign for the last time, by bisection; NaN if never."""
    for k in range(len(found) - 2, -1, -1):
        if found[k] * found[k + 1] < 0.0:
            break
    else:
        return math.nan
    low, high, sign = axis.values[k], axis.values[k + 1], math.copysign(1.0, found[k])
    for _ in range(20):
        middle = math.sqrt(low * high) if axis.log and low > 0.0 else 0.5 * (low + high)
        value = at(middle)
        if not math.isfinite(value):
            return math.nan
        low, high = (middle, high) if value * sign > 0.0 else (low, middle)
    return 0.5 * (low + high)


def estimate(plan: ExtremesPlan, limit: str, data: Mapping[str, Any]) -> float:
    """A closed form in place of `excess`, from rolling at the free angle and loads at rest.

    contact: the outer race alone holds the ball at the centrifugal force of rolling, and it no
    longer reaches the inner race, which stands where the preload put it at rest. gyroscopic_slip:
    the share s of the friction mu (Q_i + Q_o) R carries the gyroscopic moment. skid: drag exceeds
    2 mu Q_i, all that the inner race can hand on (half of it is lost to rolling on the outer).
    """
    scene = scene_from_dict(data)
    g, m = parameters.geometry(scene), parameters.motion(scene)
    D = float(parameters.ball_diameters(scene)[0])
    _, rest = at_rest(scene)
    # Both races meet at rest along one line; it shortens as the ball wears.
    K = (rest.hertz_i.K ** (-2 / 3) + rest.hertz_o.K ** (-2 / 3)) ** -1.5
    slack = elastic_approach(scene) - (g.D0 - D)
    gamma = g.D0 / g.dm
    Omega = 0.5 * m.omega_i * (1.0 - gamma * math.cos(g.alpha0))
    mass = g.rho * math.pi / 6.0 * D**3
    F_c = mass * 0.5 * g.dm * Omega**2
    Q = K * slack**1.5 if slack > 0.0 else 0.0
    if limit == "contact":
        length = g.r_i + g.r_o - g.D0 + elastic_approach(scene)
        A1, A2 = length * math.sin(rest.alpha_o), length * math.cos(rest.alpha_o)
        X2 = g.r_o - 0.5 * D + (F_c / rest.hertz_o.K) ** (2 / 3)
        reach = math.hypot(A1, A2 - X2) - (g.r_i - 0.5 * D)
        return -min(reach, slack)
    if Q == 0.0 or m.mu == 0.0:
        return 1.0
    if limit == "gyroscopic_slip":
        w_R = m.omega_i * (1.0 - gamma**2 * math.cos(g.alpha0) ** 2) / (2.0 * gamma)
        M_g = 0.1 * mass * D * D * w_R * Omega * math.sin(rest.alpha_o)
        return M_g / (m.mu * (2.0 * Q + F_c) * 0.5 * D) - plan.limits[limit]
    drag = math.pi / 8.0 * m.drag * D**2 * (0.5 * g.dm * Omega) ** 2
    return drag / (2.0 * m.mu * Q) - 1.0


# Branches


def branch(plan: ExtremesPlan, name: str) -> xr.Dataset:
    """Steady states followed up and down an axis, and found anew at each point.

    Returns
    -------
    Dataset
        Over `way` (up, down, anew) and `point`: status, orbit speed, QV, rate of loss, branch,
        stability.
    """
    of: Branch = plan.branches[name]
    base = changed(plan.base(), of.settings)
    base["cage"], base["wear"]["end_of_life"] = None, None
    n = len(of.along.values)
    keys = ("orbit_share", "total_qv", "loss_rate", "branch", "stable", "gyroscopic_slip_share")
    columns = {key: np.full((3, n), np.nan) for key in keys}
    status = np.zeros((3, n), dtype=np.int8)
    for way, order in enumerate((range(n), range(n - 1, -1, -1), range(n))):
        last: np.ndarray | None = None
        for k in order:
            scene = scene_from_dict(changed(base, {of.along.key: of.along.values[k]}))
            problem = ThrustProblem.of(scene)
            D = float(parameters.ball_diameters(scene)[0])
            case = problem.solve(D, None if last is None or way == 2 else last.copy())
            status[way, k] = case.status
            if case.status != code.OK:
                continue
            last = case.u
            values = steady_values(scene, problem, D, case)
            columns["orbit_share"][way, k] = case.u[3] / problem.motion.omega_i
            columns["total_qv"][way, k] = values["total_qv"]
            columns["loss_rate"][way, k] = values["ball_diameter_loss_rate"][1]
            columns["branch"][way, k] = case.branch
            columns["stable"][way, k] = problem.stable(D, case)
            columns["gyroscopic_slip_share"][way, k] = np.max(values["gyroscopic_slip_share"])
    return xr.Dataset(
        {"status": (("way", "point"), status)}
        | {key: (("way", "point"), column) for key, column in columns.items()}
        | {"along": ("point", list(of.along.values))},
        attrs=described({
            "kind": "branches", "name": name, "shown": of.title, "key": of.along.key,
            "log": int(of.along.log), "ways": "up down anew",
        }),
    )  # fmt: skip
