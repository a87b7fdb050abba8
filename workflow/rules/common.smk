# Reads and checks the configuration; the lists that rules expand.

import logging
import sys

from snakemake.exceptions import WorkflowError
from snakemake.utils import validate

from bearingwear.process import set_environment
from bearingwear.provenance import kernels_hash
from bearingwear.provenance import result_hash as sources
from bearingwear.studies import configuration
from bearingwear.studies.axis import GRID_KEYS, loss_name, mu_name
from bearingwear.studies.configuration import scene_values, settings

set_environment()  # for all jobs
logging.raiseExceptions = (
    False  # on a full disk the failed jobs are told, not each lost log line
)
configuration.refuse_other_copy()


def checked(name, check, data=None):
    """A configuration with the defaults of its schema; one line says what is wrong with it."""
    path = f"config/{name}.yaml"
    try:
        data = configuration.read_config(path) if data is None else data
        validate(data, f"../schemas/{name}.schema.yaml")
        check(data)
    except (WorkflowError, ValueError) as error:
        raise WorkflowError(configuration.fault_line(path, error)) from None
    return data


checked("config", configuration.check_config, config)
DESIGN = checked("design", configuration.check_design)
UNCERTAINTY = checked("uncertainty", configuration.check_sampled)

# In the name of what `rule compile` makes, so that an edited kernel is compiled anew.
KERNELS = kernels_hash()
# The grid of each scene: its methods, friction coefficients and losses, in order.
GRIDS = configuration.grids(config)
DYNAMIC = configuration.grids(config, "dynamic")
SCENES = [*dict.fromkeys([*GRIDS, *DYNAMIC, *DESIGN["scenes"]])]
# Losses of all grids, as in file names: each line is solved at all of them, which takes milliseconds.
LOSSES = sorted({k for grid in GRIDS.values() for k in grid.loss_names}, key=float)


wildcard_constraints:
    scene=r"[A-Za-z0-9][\w-]*",
    method="constant_force|fixed_position",
    mu=r"\d+\.\d+",
    loss=r"\d+\.\d+",


# Rules call the command of this environment, in a fork of a process that has imported it. An interrupt waits until Python runs.
shell.prefix(
    f'set -euo pipefail; bearingwear() ( trap "" INT; exec "{sys.executable}" -I -S "{configuration.FORK_SERVER}" $PPID "$@" ); '
)
