"""Golden numbers: what a fixed list of scenes gives, and how far two versions of it differ.

    python benchmarks/golden.py solve A.json [WORD ...]    # those with these words in their names
    python benchmarks/golden.py compare A.json B.json
    python benchmarks/golden.py lives A.json B.json    # and by how much each life differs

States, lives, maps, a recommendation and a sample, solved as a user does: `PYTHONPATH=ROOT` solves
them with another checkout. All of it takes less than a minute of CPU time, compiled code warm.

Allowed are 1e-9 for states and maps of them, and 1e-6 for lives and motion, of the largest value of
a variable. What is a small number over another one (names in OVER_ANOTHER) may differ by as much as
that itself. Codes, counts and texts must be the same.
"""

import argparse
import contextlib
import io
import json
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import bearingwear
from bearingwear.cli import main as command

SCENES = Path(bearingwear.__file__).resolve().parents[1] / "config" / "scenes"
STATE, LIFE = 1e-9, 1e-6
OVER_ANOTHER = ("_error_estimate", "_residual", "_rounding", "_error", "_bound")

FIXED = {"operation.preload_method": "fixed_position"}
RIGID = FIXED | {"arrangement.kind": "rigid_pair"}
SPRING = {"arrangement.kind": "spring_pair", "arrangement.spring_stiffness_N_um": 0.2}
MIXED = {"arrangement.second": {"wear.ball_diameter_loss_um": 0.1, "friction.ball_race": 0.05}}
LOADED = {"arrangement.external_axial_N": 2.0}
LOSS = {"wear.ball_diameter_loss_um": 0.3}
TEMPERATURE = {"temperature": {"inner_ring_C": 24.0, "outer_ring_C": 20.0, "balls_C": 24.0}}
NETWORK = {
    "thermal": {
        "conductance_W_K": {"inner_ring_shaft": 0.1, "outer_ring_housing": 0.1, "ball_race": 0.05},
        "shaft_C": 20.0,
        "housing_C": 20.0,
    }
}
RADIAL = {"operation.radial_load_N": [1.0, 0.0]}
FOLLOWED = {"model.contact": "worn", "wear.end_of_life": {"ball_diameter_loss_um": 0.05}}
ROTOR = {"arrangement.rotor_mass_kg": 0.03, "arrangement.span_mm": 20.0}
DEEPER = FOLLOWED | {"wear.end_of_life": {"ball_diameter_loss_um": 0.15}}
THIN = {"friction.film.thickness_um": 0.05}
SHORT = {"model.simulated_turns": 3, "model.evaluated_turns": 1}
TURNS = {"model.simulated_turns": 5, "model.evaluated_turns": 2, "model.life_steps": 2}
NO_CAGE = {"cage": None}

STATES = {
    "gyro_s1": ("gyro_s1", {}),
    "gyro_s1, fixed, loss": ("gyro_s1", FIXED | LOSS),
    "gyro_s1, hertz": ("gyro_s1_hertz", {}),
    "gyro_s1, hertz, fixed, loss": ("gyro_s1_hertz", FIXED | LOSS),
    "gyro_s1, worn": ("gyro_s1_worn", FIXED | LOSS),
    "gyro_s3": ("gyro_s3", {}),
    "bearing218": ("bearing218", {}),
    "turbopump": ("turbopump", {}),
    "film": ("mos2_gyro", {}),
    "drag": ("gyro_s1_drag", {}),
    "given temperature": ("gyro_s1_hertz", FIXED | TEMPERATURE),
    "network": ("gyro_s1_hertz", FIXED | NETWORK),
    "network, force": ("gyro_s1", NETWORK),
    "rigid pair": ("gyro_s1", RIGID | LOADED),
    "rigid pair, hertz": ("gyro_s1_hertz", RIGID | LOADED | LOSS),
    "rigid pair, mixed": ("gyro_s1_hertz", RIGID | MIXED | LOADED),
    "rigid pair, network": ("gyro_s1_hertz", RIGID | NETWORK | LOADED),
    "spring pair": ("gyro_s1_hertz", SPRING | LOADED),
    "spring pair, mixed": ("gyro_s1", SPRING | MIXED),
    "spring pair, lifted off": ("gyro_s1", SPRING | {"arrangement.external_axial_N": -7.0}),
    "tandem": ("gyro_s1", RIGID | LOADED | {"arrangement.tandem": [2, 1]}),
    "natural frequencies": ("gyro_s1", RIGID | ROTOR),
    "preload gone": ("gyro_s1", FIXED | {"wear.ball_diameter_loss_um": 2.0}),
    "at rest": ("gyro_s1", {"operation.shaft_speed_rpm": 0.0}),
}
"""Solved by steady and by race control."""

ASYMMETRIC = {
    "radial": ("gyro_s1", RADIAL),
    "radial, fixed": ("gyro_s1_hertz", FIXED | RADIAL),
    "tilt": ("gyro_s1", {"operation.tilt_mrad": 0.2}),
    "turbine": ("turbine", {}),
}
"""Solved by race control alone."""

LIVES = {
    "gyro_s1": ("gyro_s1", {}),
    "gyro_s1, fixed": ("gyro_s1", FIXED),
    "gyro_s1, hertz": ("gyro_s1_hertz", FIXED),
    "film": ("mos2_gyro", {}),
    "film, fixed": ("mos2_gyro", FIXED),
    "film, wears through": ("mos2_gyro", THIN),
    "given temperature": ("gyro_s1_hertz", FIXED | TEMPERATURE),
    "network": ("gyro_s1_hertz", FIXED | NETWORK),
    "rigid pair": ("gyro_s1_hertz", RIGID),
    "rigid pair, mixed": ("gyro_s1_hertz", RIGID | MIXED),
    "spring pair, mixed": ("gyro_s1", SPRING | MIXED),
    "spring pair, network": ("gyro_s1_hertz", SPRING | NETWORK),
    "tandem": ("gyro_s1", RIGID | {"arrangement.tandem": [2, 1]}),
    "turbopump": ("turbopump", {}),
    "turbopump, worn": ("turbopump", {"model.contact": "worn"}),
    "film, rigid pair": ("mos2_gyro", RIGID),
    "worn": ("gyro_s1_worn", FOLLOWED),
    "worn, fixed": ("gyro_s1_worn", FIXED | FOLLOWED),
    "worn, rigid pair, mixed": ("gyro_s1_worn", RIGID | MIXED | DEEPER),
    "worn, network": ("gyro_s1_worn", FIXED | NETWORK | FOLLOWED),
    "worn, film": ("mos2_gyro", FOLLOWED),
}
MOTIONS = {
    "gyro_s1": ("gyro_s1", SHORT),
    "no cage": ("gyro_s1_hertz", NO_CAGE | SHORT),
    "periodic": ("gyro_s1", NO_CAGE | RADIAL),
    "turbopump": ("turbopump", SHORT),
    "turbine": ("turbine", NO_CAGE),
}
LIVES_IN_TIME = {
    "periodic": ("gyro_s1", NO_CAGE | RADIAL | {"model.life_steps": 2}),
    "cage": ("gyro_s1", TURNS),
}
METHODS = {"operation.preload_method": ["constant_force", "fixed_position"]}
MAPS = {
    "states, friction": (
        "gyro_s1_hertz", {}, "solve",
        METHODS | {"operation.preload_N": [3.0, 7.0], "friction.ball_race": [0.04, 0.08, 0.15]},
    ),
    "states, speed": (
        "gyro_s1", LOSS, "solve",
        {"operation.shaft_speed_rpm": [1e3, 1e4, 6e4], "operation.preload_N": [2.0, 10.0]},
    ),
    "lives": ("gyro_s1", {}, "life", METHODS | {"operation.preload_N": [1.0, 2.0, 4.0, 7.0]}),
    "lives of pairs": (
        "gyro_s1_hertz", RIGID | MIXED, "life",
        {"operation.preload_N": [4.0, 7.0], "arrangement.external_axial_N": [0.0, 2.0]},
    ),
}  # fmt: skip
COMMANDS = {
    "recommend: gyro_s1": "recommend gyro_s1 --slip 0.3 --stiffness 3",
    "recommend: gyro_s1_worn": "recommend gyro_s1_worn --slip 0.3",
    "recommend: turbopump": "recommend turbopump --pressure 2.5",
    "uncertainty: gyro_s1": "uncertainty gyro_s1 --samples 16",
    "uncertainty: both methods": "uncertainty gyro_s1_hertz --samples 8 "
    "--method constant_force fixed_position",
}
Job = Callable[[], dict[str, Any]]


def jobs() -> Iterator[tuple[str, float, Job]]:
    """Name, tolerance, and what solves it."""
    for fidelity in ("steady", "race_control"):
        for name, scene in STATES.items():
            yield f"{fidelity}: {name}", STATE, partial(state, *scene, fidelity)
    for name, scene in ASYMMETRIC.items():
        yield f"race_control: {name}", STATE, partial(state, *scene, "race_control")
    for name, scene in LIVES.items():
        yield f"life: {name}", LIFE, partial(life, *scene)
    for name, scene in MOTIONS.items():
        yield f"dynamic: {name}", LIFE, partial(state, *scene, "dynamic")
    for name, scene in LIVES_IN_TIME.items():
        yield f"dynamic life: {name}", LIFE, partial(life, *scene, "dynamic")
    for name, of_map in MAPS.items():
        yield f"map: {name}", LIFE if of_map[2] == "life" else STATE, partial(map_of, *of_map)
    for name, words in COMMANDS.items():
        yield name, LIFE, partial(of_command, *words.split())


def scene_of(file: str, changes: Mapping[str, Any]) -> Any:
    return bearingwear.load(SCENES / f"{file}.yaml").with_(changes)


def state(file: str, changes: Mapping[str, Any], fidelity: str) -> dict[str, Any]:
    return numbers(bearingwear.solve(scene_of(file, changes), fidelity))


def life(file: str, changes: Mapping[str, Any], fidelity: str | None = None) -> dict[str, Any]:
    return numbers(bearingwear.life(scene_of(file, changes), fidelity))


def map_of(file: str, changes: Mapping[str, Any], what: str, axes: Any) -> dict[str, Any]:
    return numbers(bearingwear.sweep(scene_of(file, changes), axes, what=what, workers=1))


def numbers(dataset: Any) -> dict[str, Any]:
    return {str(name): variable.values.tolist() for name, variable in dataset.variables.items()}


def of_command(verb: str, scene: str, *options: str) -> dict[str, Any]:
    """What a command prints as JSON; an uncertainty, what it writes."""
    said = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(said):
        output = Path(folder) / "out.nc"
        written = ["-o", str(output)] if verb == "uncertainty" else []
        status = command([verb, str(SCENES / f"{scene}.yaml"), *options, "--json", *written])
        if written:
            return {"exit_status": status, **numbers(bearingwear.load(output))}
    sheet = json.loads(said.getvalue())
    return {
        "exit_status": status,
        "sentences": sheet["sentences"],
        **{f"{q['block']}, {q['name']}, {q['label']}": q["values"] for q in sheet["quantities"]},
    }


def solve(path: Path, words: list[str]) -> None:
    found = {}
    for name, tolerance, job in jobs():
        if all(word in name for word in words):
            begun = time.process_time()
            try:
                values = job()
            except Exception as error:  # the others are of use without it
                values = {"failed": f"{type(error).__name__}: {error}"}
            found[name] = {"tolerance": tolerance, "values": values}
            said = values.get("failed", "")
            print(f"{time.process_time() - begun:6.2f} s  {name} {said}", file=sys.stderr)
    path.write_text(json.dumps(found, indent=0, default=str) + "\n", encoding="utf-8")


def differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    """One line for each difference that is not allowed."""
    for job in (*a, *(b.keys() - a.keys())):
        if job not in a or job not in b:
            yield f"{job}: missing in {'A' if job not in a else 'B'}"
            continue
        one, other = a[job]["values"], b[job]["values"]
        if failed := one.get("failed") or other.get("failed"):
            yield f"{job}: failed in {'A' if 'failed' in one else 'B'}: {failed}"
            continue
        for name in (*one, *(other.keys() - one.keys())):
            if name not in one or name not in other:
                yield f"{job}, {name}: missing in {'A' if name not in one else 'B'}"
            elif said := difference(name, one[name], other[name], a[job]["tolerance"]):
                yield f"{job}, {name}: {said}"


def table_of_lives(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    """Each life [h] in both files, their difference, and its estimate."""
    apart = []
    for job in [job for job in a if job in b and isinstance(a[job]["values"].get("life"), float)]:
        one, other = (found[job]["values"]["life"] for found in (a, b))
        estimate = a[job]["values"].get("life_error_estimate", np.nan)
        apart.append(abs(other / one - 1.0))
        yield f"{one:11.6g} {other:11.6g} {other / one - 1.0:+9.1e} {estimate:9.1e}  {job}"
    yield f"median {np.median(apart):.1e}, largest {max(apart):.1e} of {len(apart)} lives"


def difference(name: str, a: Any, b: Any, tolerance: float) -> str:
    """What differs in the values of a variable by more than is allowed; empty if nothing does."""
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        parts = {key: difference(name, a[key], b[key], tolerance) for key in a}
        return "; ".join(f"{key} {said}" for key, said in parts.items() if said)
    one, other = np.asarray(a), np.asarray(b)
    if one.shape != other.shape:
        return f"shape {one.shape} in A, {other.shape} in B"
    if {one.dtype.kind, other.dtype.kind} - set("fi") or (
        one.dtype.kind + other.dtype.kind == "ii"
    ):
        return "" if np.array_equal(one, other) else f"{short(a)} in A, {short(b)} in B"
    one, other = one.astype(float), other.astype(float)
    if not np.array_equal(np.isfinite(one), np.isfinite(other)):
        return f"{short(a)} in A, {short(b)} in B: not a number in one"
    finite = np.isfinite(one)
    apart = np.abs(one - other)[finite].max(initial=0.0)
    scale = np.abs(one)[finite].max(initial=0.0)
    if apart <= tolerance * (1.0 if name.endswith(OVER_ANOTHER) else scale):
        return ""
    return f"{apart / scale if scale else np.inf:.1e} of {scale:.6g}, allowed {tolerance:.0e}"


def short(value: Any) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 60 else f"{text[:57]}..."


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    what = parser.add_subparsers(dest="what", required=True)
    solved = what.add_parser("solve")
    solved.add_argument("output", type=Path, metavar="A.json")
    solved.add_argument("words", nargs="*", metavar="WORD")
    for name in ("compare", "lives"):
        compared = what.add_parser(name)
        compared.add_argument("a", type=Path, metavar="A.json")
        compared.add_argument("b", type=Path, metavar="B.json")
    args = parser.parse_args()
    if args.what == "solve":
        warnings.simplefilter("ignore", UserWarning)
        solve(args.output, args.words)
        return 0
    a, b = (json.loads(path.read_text(encoding="utf-8")) for path in (args.a, args.b))
    if args.what == "lives":
        print(*table_of_lives(a, b), sep="\n")
        return 0
    count = 0
    for line in differences(a, b):
        count += 1
        print(line)
    values = sum(len(job["values"]) for job in a.values())
    print(f"{count} of {values} variables in {len(a)} jobs differ by more than is allowed")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
