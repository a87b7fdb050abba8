"""A rotor at rest on two bearings by plain SciPy, from the equations alone, against the program.

Nothing is shared with the package but the numbers of the scene: contact points in space, Hertz by
elliptic integrals of SciPy, the rotor's six components of force and moment, found by a root search
in five displacements (and the slide of a spring-loaded ring). Curvatures are those at the free
contact angle; forces act at the undeformed centres of the inner grooves.

    python benchmarks/plain_launch.py [COUNT]
"""

import math
import sys

import numpy as np
from scipy.optimize import brentq, root
from scipy.special import ellipe, ellipk

BALANCED = 1e-7  # force left over the load


def hertz(A: float, B: float, E_star: float) -> tuple[float, float]:
    """K of Q = K d^1.5, and the peak pressure under 1 N, of a gap A x^2 + B y^2, A < B."""

    def ratio(k: float) -> float:  # B/A of an ellipse b/a = k
        m = 1.0 - k * k
        return (ellipe(m) / k**2 - ellipk(m)) / (ellipk(m) - ellipe(m)) - B / A

    k = brentq(ratio, 1e-6, 1.0 - 1e-9, xtol=1e-15)
    m = 1.0 - k * k
    b = (3.0 * k * ellipe(m) / (2.0 * math.pi * E_star * (A + B))) ** (1.0 / 3.0)
    a = b / k
    d = 3.0 * ellipk(m) / (2.0 * math.pi * E_star * a)
    return d**-1.5, 1.5 / (math.pi * a * b)


class Plain:
    """One bearing: `way` is where its inner race is pushed to, `at` its middle on the rotor."""

    def __init__(self, scene: dict, way: float, at: float):
        b, material = scene["bearing"], scene["materials"]["steel"]
        n, D, dm = b["ball_count"], 1e-3 * b["ball_diameter_mm"], 1e-3 * b["pitch_diameter_mm"]
        alpha = math.radians(b["contact_angle_deg"])
        f_i, f_o = b["inner_groove_factor"], b["outer_groove_factor"]
        E = 1e9 * material["youngs_modulus_GPa"] / (1.0 - material["poisson_ratio"] ** 2) / 2.0
        self.free = (f_i + f_o - 1.0) * D
        psi = 2.0 * np.pi * np.arange(n) / n
        radial = np.column_stack([np.zeros(n), np.cos(psi), np.sin(psi)])
        axis = np.array([way, 0.0, 0.0])
        ball = 0.5 * dm * radial
        self.at = np.array([at, 0.0, 0.0])
        line = math.sin(alpha) * axis + math.cos(alpha) * radial  # outer to inner groove centre
        self.inner = ball + (f_i - 0.5) * D * line
        self.outer = ball - (f_o - 0.5) * D * line
        self.way, factors, peaks = way, [], []
        for f, side in ((f_i, -1.0), (f_o, 1.0)):
            gap = 2.0 * math.cos(alpha) / (dm + side * D * math.cos(alpha))
            K, p = hertz(1.0 / D - 0.5 / (f * D), 1.0 / D - side * 0.5 * gap, E)
            factors.append(K)
            peaks.append(p)
        self.K = sum(K ** (-2.0 / 3.0) for K in factors) ** -1.5
        self.peaks = np.array(peaks)
        # as mounted under the preload
        preload = scene["operation"]["preload_N"]

        def left(x: float) -> float:
            return self.on_rotor(np.array([x * way, 0, 0, 0, 0]))[0][0] * -way - preload

        top = 1e-6
        while left(top) < 0.0:
            top *= 2.0
        self.mounted = brentq(left, 0.0, top, xtol=1e-18)

    def on_rotor(self, q: np.ndarray, mounted: float = 0.0, slide: float = 0.0):
        """Force and moment (about the rotor's middle) on the rotor, loads and distances."""
        place = self.at + self.inner
        turned = np.cross(np.array([0.0, q[3], q[4]]), place)
        moved = self.inner + q[:3] + turned + np.array([self.way * mounted, 0.0, 0.0])
        # a second outer ring slides along its own load direction
        line = moved - self.outer + np.array([self.way * slide, 0.0, 0.0])
        # what is across the plane of a groove does not stretch it
        across = np.cross(self.outer, [1.0, 0.0, 0.0])
        across /= np.linalg.norm(across, axis=1)[:, None]
        line = line - (line * across).sum(axis=1)[:, None] * across
        length = np.linalg.norm(line, axis=1)
        Q = self.K * np.maximum(length - self.free, 0.0) ** 1.5
        F = -Q[:, None] * line / length[:, None]
        return F.sum(axis=0), np.cross(place, F).sum(axis=0), Q, length


def solved(scene: dict, axial: float, radial: float) -> dict:
    """The rotor under a force along X and along the first ball of each bearing [N]."""
    a = scene["arrangement"]
    outwards = -1.0 if a["orientation"] == "back_to_back" else 1.0
    half = 0.5e-3 * a["span_mm"]
    bearings = [Plain(scene, 1.0, outwards * half), Plain(scene, -1.0, -outwards * half)]
    offset = np.array([1e-3 * a["rotor_offset_mm"], 0.0, 0.0])
    load = np.array([axial, radial, 0.0])
    spring = a["kind"] == "spring_pair"
    F_s, k_s = scene["operation"]["preload_N"], 1e6 * a["spring_stiffness_N_um"]
    stop = 1e-6 * a.get("stop_um", math.inf)
    lengths = np.array([1e-6, 1e-6, 1e-6, 1e-6 / half, 1e-6 / half, 1e-6])

    def left(u: np.ndarray, share: float, stopped: bool) -> np.ndarray:
        q, slide = (u * lengths)[:5], (u * lengths)[5]
        if stopped or not spring:
            slide = -stop if stopped else 0.0
        one = bearings[0].on_rotor(q, bearings[0].mounted)
        two = bearings[1].on_rotor(q, bearings[1].mounted, slide)
        F = one[0] + two[0] + share * load
        M = one[1] + two[1] + np.cross(offset, share * load)
        last = u[5] if stopped or not spring else two[0][0] - (F_s - k_s * slide)
        return np.array([*F, *M[1:] / half, last])

    def found(stopped: bool) -> np.ndarray:
        u = np.zeros(6)
        for share in np.linspace(0.0, 1.0, 17)[1:]:  # the load rises in steps
            u = root(left, u, (share, stopped), method="lm").x
        polished = root(left, u, (1.0, stopped), method="hybr", options={"xtol": 1e-15}).x
        ends = [(abs(left(one, 1.0, stopped)).max(), k) for k, one in enumerate((u, polished))]
        return (u, polished)[min(ends)[1]]

    u = found(False)
    slide = u[5] * lengths[5] if spring else 0.0
    if spring and slide < -stop:
        u, slide = found(True), -stop
    q = (u * lengths)[:5]
    forces = [b.on_rotor(q, b.mounted, k * slide) for k, b in enumerate(bearings)]
    return {
        "residual": abs(left(u, 1.0, slide == -stop)).max() / abs(load).max(),
        "shift": q[0],
        "across": q[1],
        "axial": [abs(F[0]) for F, *_ in forces],
        "radial": [-F[1] for F, *_ in forces],
        "load": [Q for _, _, Q, _ in forces],
        "pressure": [
            float(b.peaks.max() * Q.max() ** (1 / 3))
            for b, (_, _, Q, _) in zip(bearings, forces, strict=True)
        ],
    }


def random_scene(rng: np.random.Generator) -> tuple[dict, float, float]:
    """A scene and a load."""
    D = float(rng.choice([2.0, 3.175, 5.556, 8.731, 12.7]))
    dm = float(D * rng.uniform(5.0, 8.0))
    n = int(0.8 * math.pi * dm / D)
    preload = float(D**2 * rng.uniform(0.5, 8.0))
    kind = str(rng.choice(["rigid_pair", "spring_pair"]))
    arrangement = {
        "kind": kind,
        "orientation": str(rng.choice(["back_to_back", "face_to_face"])),
        "rotor_mass_kg": float(0.01 * D**2 * rng.uniform(0.3, 3.0)),
        "span_mm": float(dm * rng.uniform(1.0, 4.0)),
        "spring_stiffness_N_um": float(rng.choice([0.1, 1.0])) if kind == "spring_pair" else 0.0,
        "rotor_offset_mm": float(rng.uniform(-0.2, 0.2) * dm),
    }
    if kind == "spring_pair":
        arrangement["stop_um"] = float(rng.uniform(2.0, 30.0))
    method = {"rigid_pair": "fixed_position", "spring_pair": "constant_force"}[kind]
    scene = {
        "name": "launch",
        "bearing": {
            "ball_count": n,
            "ball_diameter_mm": D,
            "pitch_diameter_mm": dm,
            "contact_angle_deg": float(rng.uniform(12.0, 35.0)),
            "inner_groove_factor": float(rng.uniform(0.515, 0.56)),
            "outer_groove_factor": float(rng.uniform(0.515, 0.56)),
            "ball_material": "steel",
            "race_material": "steel",
        },
        "materials": {
            "steel": {
                "youngs_modulus_GPa": 208.0,
                "poisson_ratio": 0.3,
                "density_kg_m3": 7800.0,
                "brinell_hardness_GPa": 7.0,
                "wear_coefficient": 1e-6,
            }
        },
        "operation": {"shaft_speed_rpm": 1000.0, "preload_method": method, "preload_N": preload},
        "friction": {"ball_race": 0.1},
        "arrangement": arrangement,
    }
    axial, radial = preload * rng.uniform(-6.0, 6.0), preload * rng.uniform(0.0, 2.0)
    return scene, float(axial), float(radial)


def difference(scene: dict, axial: float, radial: float) -> tuple[float, float]:
    """Largest relative difference of forces, loads and pressures; what the plain one left over."""
    from bearingwear.scene.read import scene_from_dict
    from bearingwear.solvers.bearing.launch import RotorAtRest

    ours = RotorAtRest.of(scene_from_dict(scene)).under(axial, radial)
    plain = solved(scene, axial, radial)
    scale = max(plain["axial"] + [abs(axial), radial])
    if plain["residual"] > BALANCED:
        return math.nan, plain["residual"]
    heaviest = max(Q.max() for Q in plain["load"])
    off = []
    for k, one in enumerate(ours.bearings):
        off += [abs(one.axial - plain["axial"][k]) / scale]
        off += [abs(one.radial - plain["radial"][k]) / scale]
        off += [abs(np.sort(one.load) - np.sort(plain["load"][k])).max() / heaviest]
    peak = max(plain["pressure"])
    off += [abs(ours.pressure - peak) / peak]
    return max(off), plain["residual"]


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    rng = np.random.default_rng(35)
    found = [difference(*random_scene(rng)) for _ in range(count)]
    good = np.array([off for off, left in found if left < BALANCED])
    print(f"{count} random rotors, {len(good)} of which the root search solved to {BALANCED:g}")
    print(f"largest difference, relative: median {np.median(good):.1e}, most {good.max():.1e}")


if __name__ == "__main__":
    main()
