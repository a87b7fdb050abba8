# Checks the configuration and every scene before anything runs, and looks things up for the rules.

import os
import shlex
import sys

from snakemake.utils import validate

import bearingwear.report
import bearingwear.study
from bearingwear.io.config import for_life, load_scene
from bearingwear.provenance import SOLVER_SOURCES
from bearingwear.study.plan import Plan

validate(config, "../schemas/config.schema.yaml")

# What is wrong beyond the schema stops here, with one line and no traceback.
try:
    PLAN = Plan.from_config(config)
    for path in PLAN.scene_files():
        for_life(load_scene(path), path)
except ValueError as error:
    sys.exit(str(error))

# Inputs of the rules, so that an edit (not a touch) of the code behind a result makes it anew.
SOLVER = [os.path.relpath(path) for path in SOLVER_SOURCES]
STUDY = [os.path.relpath(path) for path in bearingwear.study.SOURCES]
REPORT = [os.path.relpath(path) for path in bearingwear.report.SOURCES]

# The command of this very environment, whether or not it is activated.
shell.prefix(
    f'bearingwear() ( exec {shlex.quote(sys.executable)} -m bearingwear "$@" ); '
)


wildcard_constraints:
    scene=r"[A-Za-z0-9_]+",
    case=r"[a-z_]+-mu\d+\.\d{3}-loss\d+\.\d{2}",


def case_of(wildcards):
    return PLAN.grids[wildcards.scene].cases()[wildcards.case]


def case_settings(wildcards):
    return [f"--set {setting}" for setting in case_of(wildcards).settings]


def case_label(wildcards):
    return f"{wildcards.scene}: {case_of(wildcards).label}"


def scene_cases(wildcards):
    return PLAN.cases(wildcards.scene)


def slip_cases(wildcards):
    return PLAN.slip_cases(wildcards.scene)


def scene_frictions(wildcards):
    return PLAN.frictions(wildcards.scene)


def loss_of_figure(wildcards):
    return PLAN.losses[wildcards.figure]


def spread_studies(wildcards):
    return PLAN.studies(*PLAN.spreads[wildcards.spread].scenes)


def spread_friction(wildcards):
    return PLAN.spreads[wildcards.spread].friction
