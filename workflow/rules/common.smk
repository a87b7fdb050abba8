# Reads and checks the configuration; the lists that rules expand.

import os
import sys
import time
from glob import glob
from pathlib import Path
from types import SimpleNamespace

from snakemake.exceptions import WorkflowError
from snakemake.utils import validate

from bearingwear.process import set_environment
from bearingwear.provenance import kernels_hash
from bearingwear.provenance import result_hash as sources
from bearingwear.studies import configuration
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.configuration import loss_name, mu_name, scene_values, settings

set_environment()  # for all jobs

CONFIGURATIONS = {"config": config} | {
    name: configuration.read(f"config/{name}.yaml")
    for name in ("design", "uncertainty", "lives")
}
for name, data in CONFIGURATIONS.items():
    try:
        validate(data, f"../schemas/{name}.schema.yaml")
        configuration.CHECKS[name](data)
    except (WorkflowError, ValueError) as error:
        raise WorkflowError(configuration.fault(name, error)) from None
_, DESIGN, UNCERTAINTY, LIVES = CONFIGURATIONS.values()

KERNELS = (
    kernels_hash()
)  # in the name of what `rule compile` makes, so that an edited kernel is compiled anew
# The grid of each scene: its methods, friction coefficients and losses, in order.
GRIDS = configuration.grids(config)
DYNAMIC = configuration.grids(config, "dynamic")
SCENES = [*dict.fromkeys([*GRIDS, *DYNAMIC, *DESIGN["scenes"]])]
# Losses of all grids, as in file names. A solve takes milliseconds, so each line of a grid is solved at all of them.
LOSSES = sorted(
    {loss for grid in GRIDS.values() for loss in grid.loss_names}, key=float
)


wildcard_constraints:
    scene=r"[A-Za-z0-9][\w-]*",
    method="constant_force|fixed_position",
    mu=r"\d+\.\d+",
    loss=r"\d+\.\d+",


# Rules call the command of this very environment and package, in a process forked from one that has imported it. A pipe
# hides no failure.
shell.prefix(
    f'set -euo pipefail; bearingwear() ( exec "{sys.executable}" -I -S "{configuration.FORK_SERVER}" $PPID "$@" ); '
)
