"""Sampled lives: errors and coverage of the quantiles over seeds, and what a sample costs.

    python benchmarks/sampled_lives.py seeds   # 40 seeds of gyro_s1 against a sample of 8192
    python benchmarks/sampled_lives.py cost    # samples of 16 to 256 bearings, in one process

Each prints a Markdown table.
"""

import argparse
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bearingwear.results.quantiles import ALL_INPUTS
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.new.scene_file import write_scene
from bearingwear.scene.scene import Scene
from bearingwear.studies.sampling import SAMPLES, Sampling
from bearingwear.studies.uncertainty.intervals import life_quantile
from bearingwear.studies.uncertainty.plan import uncertain_scene
from bearingwear.studies.uncertainty.preloads import with_preload
from bearingwear.studies.uncertainty.quantiles import uncertain_lives
from bearingwear.studies.uncertainty.sample import sample_of, sampled_lives

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
METHODS = ("constant_force", "fixed_position")
SEEDS, LARGE = 40, 2**13
QUANTILES = (0.05, 0.5, 0.95)


def scene_files() -> Iterator[tuple[str, Path]]:
    """Names and files of an instrument bearing with Hertzian lives and a worn spindle bearing."""
    yield "gyro_s1", SCENES / "gyro_s1.yaml"
    with tempfile.TemporaryDirectory() as folder:
        spindle = Path(folder) / "7008C.yaml"
        write_scene(
            spindle,
            bore=None,
            outside=None,
            given={"operation.shaft_speed_rpm": 18000.0},
            designation="7008C",
        )
        yield "7008C", spindle


def quantiles(scene: Scene, plan: Sampling) -> np.ndarray:
    """Quantiles of life (3, 3) and the ends of their intervals [h]."""
    sample = sample_of(scene, ALL_INPUTS, plan)
    hours = sampled_lives(scene, sample.rows).life * HOURS_PER_SECOND
    return np.array([life_quantile(hours, sample.factors, p) for p in QUANTILES])


def seeds() -> None:
    """Print errors and intervals of quantiles over seeds, against those of a large sample."""
    columns = "error 5 % | 50 % | 95 % | half-width 5 % | 50 % | 95 % | covered 5 % | 50 % | 95 %"
    print(f"| sample | {columns} |\n| --- |" + " ---: |" * 9)
    base = uncertain_scene(SCENES / "gyro_s1.yaml")
    for method in METHODS:
        scene = with_preload(base, method, base.operation.preload_N)
        true = quantiles(scene, Sampling(samples=LARGE, seed=SEEDS + 1))[:, 0]
        each = [quantiles(scene, Sampling(samples=SAMPLES, seed=1 + k)) for k in range(SEEDS)]
        value, low, high = np.moveaxis(each, -1, 0)
        error = np.sqrt(np.mean(np.log(value / true) ** 2, axis=0))
        # an end that the sample does not have is no end
        covered = np.sum(~(low > true) & ~(high < true), axis=0)
        widths = np.nanmedian(0.5 * (high - low) / value, axis=0)
        cells = [*(f"{100.0 * v:.2g} %" for v in (*error, *widths)), *map(str, covered)]
        print(f"| gyro_s1, {method} | {' | '.join(cells)} |", flush=True)


def cost() -> None:
    """Print CPU time of ever larger samples, and the 90 % of bearings with their intervals."""
    print("| scene | bearings | lives solved | CPU s | 5 % quantile | 95 % quantile |")
    print("| --- |" + " ---: |" * 5)
    for name, file in scene_files():
        uncertain_lives(file, samples=2)  # loads kernels
        for samples in (16, 32, 64, 128, 256):
            started = time.process_time()
            found = uncertain_lives(file, samples=samples).squeeze()
            spent = time.process_time() - started
            at = found.sel(uncertain_inputs=ALL_INPUTS)
            ends = [
                "{:.2g} h ({:.2g} to {:.2g})".format(
                    *(
                        float(at[f"life_quantile{end}"].sel(probability=p))
                        for end in ("", "_low", "_high")
                    )
                )
                for p in (0.05, 0.95)
            ]
            solved = int(found["evaluations"])
            print(
                f"| {name} | {samples} | {solved} | {spent:.1f} | {' | '.join(ends)} |", flush=True
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("seeds", "cost"))
    {"seeds": seeds, "cost": cost}[parser.parse_args().what]()


if __name__ == "__main__":
    main()
