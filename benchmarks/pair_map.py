"""The design map of config/design.yaml, 20 480 lives, of a pair whose two bearings differ.

    python benchmarks/pair_map.py [frictions]

runs it by Snakemake on two cores, with everything that the study pays for, in a folder of its own,
and says how long that took and how the lives ended. `frictions` takes but the first so many
friction coefficients. Run it with nothing else beside it.
"""

import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import xarray as xr
import yaml

from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.scene.read import load_scene
from bearingwear.studies.axis import RisingAxis
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.launch import snakefile
from bearingwear.studies.own_study import write_study

CONFIG = Path(__file__).resolve().parents[1] / "config"
NAME, FORCE_N = "pushed_pair", 1.0


def study_in(folder: Path, frictions: int | None) -> None:
    """A study of gyro_s1 in a pair, with the whole design map."""
    pushed = ["arrangement.kind=spring_pair", f"arrangement.external_axial_N={FORCE_N:g}"]
    scene = load_scene(CONFIG / "scenes/gyro_s1.yaml", pushed).to_dict() | {"name": NAME}
    file = folder / f"{NAME}.yaml"
    file.write_text(yaml.safe_dump(scene))
    write_study(file, folder / NAME, DesignLimits())
    own = yaml.safe_load((CONFIG / "design.yaml").read_text())["scenes"]["gyro_s1"]
    axes = own["map"]
    if frictions is not None:
        axes["friction"] = list(RisingAxis.from_plain(axes["friction"]))[:frictions]
    design = {"scenes": {NAME: {"map": axes, "limits": own["limits"]}}}
    (folder / NAME / "config/design.yaml").write_text(yaml.safe_dump(design))


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        study_in(Path(name), int(sys.argv[1]) if len(sys.argv) > 1 else None)
        folder = Path(name) / NAME
        target = f"results/{NAME}/design/design.nc"
        command = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile()), "-q", "all"]
        started = time.perf_counter()
        subprocess.run([*command, "-j2", target], cwd=folder, check=True)
        minutes = (time.perf_counter() - started) / 60.0
        with xr.open_dataset(folder / target) as found:
            ends = Counter(STATUS_NAMES[int(k)] for k in found["status"].values.ravel())
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = (used.ru_utime + used.ru_stime) / 60.0
    said = ", ".join(f"{count} {status}" for status, count in ends.most_common())
    print(f"{sum(ends.values())} lives: {said}")
    print(f"{minutes:.1f} min on two cores, {cpu:.1f} min of processor time")


if __name__ == "__main__":
    main()
