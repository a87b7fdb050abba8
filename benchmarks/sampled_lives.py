"""Sampled lives: what many of them cost, and interpolated ones against solved ones.

    python benchmarks/sampled_lives.py errors                # 500 Hertzian, 60 worn lives each
    python benchmarks/sampled_lives.py study                 # 500 of each sample of `make study`
    python benchmarks/sampled_lives.py cost --most 1000000   # lives from 100 on, in one process

Each prints a Markdown table. `errors` solves random members of a sample of 65 536 interpolated
lives: the share of them that is off by more than the sample states, against the share stated.
"""

import argparse
import resource
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from bearingwear.scene.checking.strict_yaml import data_of
from bearingwear.scene.new.scene_file import write_scene
from bearingwear.scene.scene import WORN, Scene
from bearingwear.studies.configuration import grids
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.sampling import SAMPLES, Sampling
from bearingwear.studies.uncertainty import grooves
from bearingwear.studies.uncertainty.batches import Batches
from bearingwear.studies.uncertainty.plan import uncertain_scene
from bearingwear.studies.uncertainty.quantiles import own_quantiles
from bearingwear.studies.uncertainty.sample import independent_rows, with_preload
from bearingwear.studies.uncertainty.surrogate import relative_error

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
HERTZIAN, FOLLOWED = 500, 60
METHODS = ("constant_force", "fixed_position")

Rows = Callable[[Scene], np.ndarray]
"""Uncertain values of the lives of a sample (n, values)."""


def scenes() -> Iterator[tuple[str, Scene, int]]:
    """Name, scene, and how many lives are solved."""
    with tempfile.TemporaryDirectory() as folder:
        spindle = Path(folder) / "spindle.yaml"
        write_scene(
            spindle,
            bore=None,
            outside=None,
            given={"operation.shaft_speed_rpm": 18000.0},
            designation="7008C",
        )
        for contact, count in (("hertz", HERTZIAN), ("worn", FOLLOWED)):
            for file in (SCENES / "gyro_s1.yaml", spindle):
                for method in METHODS:
                    base = uncertain_scene(file, [f"model.contact={contact}"])
                    one = with_preload(base, method, base.operation.preload_N)
                    yield f"{file.stem}, {contact}, {method}", one, count


def scenes_of_study() -> Iterator[tuple[str, Scene, int]]:
    """Those whose lives `make study` samples, at every friction of its grid."""
    file = SCENES.parent / "config.yaml"
    config = data_of(file.read_text(), file.name, anchors=True)
    known = grids(config)
    for name in config["uncertain_lives"]["scenes"]:
        for mu in known[name].friction:
            base = uncertain_scene(SCENES / f"{name}.yaml", [f"friction.ball_race={mu!r}"])
            for method in known[name].preload_method:
                one = with_preload(base, method, base.operation.preload_N)
                yield f"{name}, {mu}, {method}", one, HERTZIAN


def rows_of_study(scene: Scene) -> np.ndarray:
    """Values of the lives that `make study` samples: independent ones, and those of batches."""
    plan = Sampling(samples=SAMPLES)
    return np.vstack([independent_rows(scene, plan), Batches(scene, plan).rows])


def errors(cases: Iterator[tuple[str, Scene, int]], beginning: str, rows_of: Rows) -> None:
    columns = "reported error | reported share | actual share | median | 95 % | 99 % | max"
    print(f"| sample | computed | {columns} |\n| --- | --- |" + " ---: |" * 7)
    for name, scene, count in (one for one in cases if one[0].startswith(beginning)):
        of = [*(scene.uncertainty or {})]
        names = [one for one in of if one not in WORN]
        rows = rows_of(scene)
        places = np.unique(rows[:, [of.index(one) for one in names]], axis=0)
        found = grooves.found_lives(scene, names, places)
        if found.solved == len(places) and not found.followed:
            continue  # none is interpolated
        some = np.random.default_rng(7).choice(len(places), count, replace=False)
        solve = grooves.followed_lives if found.followed else grooves.hertzian_lives
        true = np.array([one[0][-1] for one in solve((scene, names, places[some]))])
        with np.errstate(divide="ignore"):
            each = relative_error(np.log(found.life[some, None]), np.log(true)[:, None])
        stated = found.worn if found.followed else found.known
        beyond = np.mean(each > stated.error)
        spread = (*np.quantile(each, [0.5, 0.95, 0.99]), each.max())
        numbers = (*stated, beyond, *spread)
        cells = " | ".join(f"{100.0 * value:.2g} %" for value in numbers)
        print(f"| {name} | {found.followed or found.solved} | {cells} |", flush=True)


def cost(most: int, beginning: str) -> None:
    """Quantiles of ever more lives, half of them of batches, to a file."""
    print("| lives | scene | CPU s | MB | file MB | solved |\n| --- | --- |" + " ---: |" * 4)
    cases = [case for case in scenes() if case[0].endswith(METHODS[0])]
    names = ("gyro_s1, hertz", "gyro_s1, worn")
    for name in (one for one in names if one.startswith(beginning)):
        scene = next(one for label, one, _ in cases if label.startswith(name))
        for power in (6, 9, 13, 16, 19):
            if 2 * 2**power > most * 1.1:
                break
            started = time.process_time()
            found = own_quantiles(scene, METHODS[:1], Sampling(samples=2**power))
            with tempfile.NamedTemporaryFile(suffix=".nc") as file:
                write_dataset(found, Path(file.name))
                size = Path(file.name).stat().st_size / 1e6
            spent = time.process_time() - started
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            solved = found["followed_lives" if "worn" in name else "solved_lives"].item()
            print(
                f"| {2 * 2**power} | {name} | {spent:.1f} | {memory:.0f} | {size:.2f} | "
                f"{solved:.0f} |",
                flush=True,
            )


def seeds(beginning: str, count: int = 20) -> None:
    """Errors and intervals of quantiles over seeds, against those of a large sample."""
    ends = ("", "_low", "_high")
    columns = "error 5 % | 50 % | 95 % | half-width 5 % | 50 % | 95 % | covered 5 % | 50 % | 95 %"
    print(f"| sample | {columns} |\n| --- |" + " ---: |" * 9)
    for name, scene, _ in (one for one in scenes() if one[0].startswith(beginning)):
        if "hertz" not in name:
            continue  # longer by far
        method, found = [scene.operation.preload_method], []
        for plan in (
            Sampling(samples=2**13, seed=count + 1),
            *(Sampling(samples=SAMPLES, seed=1 + k) for k in range(count)),
        ):
            at = {"probability": [0.05, 0.5, 0.95]}
            one = own_quantiles(scene, method, plan).squeeze().sel(at)
            one = one.isel(uncertain_inputs=0)
            found.append([one[f"life_quantile{end}"].values for end in ends])
        true, (middle, low, high) = found[0][0], np.swapaxes(found[1:], 0, 1)
        error = np.sqrt(np.mean(np.log(middle / true) ** 2, axis=0))
        # an end that the sample does not have is no end
        covered = np.sum(~(low > true) & ~(high < true), axis=0)
        cells = [f"{100.0 * v:.2g} %" for v in (*error, *np.median(0.5 * (high - low) / middle, 0))]
        print(f"| {name} | {' | '.join(cells)} | {' | '.join(map(str, covered))} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("errors", "study", "cost", "seeds"))
    parser.add_argument("--most", type=int, default=1_000_000, help="lives at the most")
    parser.add_argument("--of", default="", help="beginning of the names of scenes")
    given = parser.parse_args()
    if given.what == "errors":
        errors(scenes(), given.of, lambda one: independent_rows(one, Sampling(samples=2**15)))
    elif given.what == "study":
        errors(scenes_of_study(), given.of, rows_of_study)
    elif given.what == "seeds":
        seeds(given.of)
    else:
        cost(given.most, given.of)


if __name__ == "__main__":
    main()
