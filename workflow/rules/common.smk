# Checks the configuration and every scene before anything runs, and looks things up for the rules.

import os
import shlex
import sys
from glob import glob

from snakemake.utils import validate

import bearingwear.report
import bearingwear.study
from bearingwear.provenance import SOLVER_SOURCES, contents_hash
from bearingwear.study.plan import Plan
from bearingwear.study.survey import survey

validate(config, "../schemas/config.schema.yaml")

# What is wrong beyond the schema stops here, with one line and no traceback.
try:
    PLAN = Plan.from_config(config)
    if workflow.is_main_process:  # not again in each job: it takes a millisecond a case
        PLAN.check_scenes()
except ValueError as error:
    sys.exit(str(error))

# Inputs of the rules, so that an edit (not a touch) of the code behind a result makes it anew.
SCENE = "config/scenes/{scene}.yaml"
SOLVER = [os.path.relpath(path) for path in SOLVER_SOURCES]
STUDY = [os.path.relpath(path) for path in bearingwear.study.SOURCES]
DESIGN_SOURCES = [os.path.relpath(path) for path in bearingwear.study.DESIGN_SOURCES]
REPORT = [os.path.relpath(path) for path in bearingwear.report.SOURCES]
PAGE_SOURCES = [os.path.relpath(path) for path in bearingwear.report.PAGE_SOURCES]
PAGE_DOCS = ["docs/verification.md", "docs/accuracy.md"]

# Jobs on a cluster read this file as well, while results come and go.
if workflow.is_main_process:
    try:
        sources = [*SOLVER, *STUDY, *REPORT, *PAGE_SOURCES, *PAGE_DOCS]
        for line in survey([*PLAN.results(), *PLAN.inputs(), *sources]):
            print(line, file=sys.stderr)
    except OSError as error:
        sys.exit(f"{error.filename}: cannot be set aside or dated ({error.strerror})")

# The command of this very environment, whether or not it is activated.
shell.prefix(
    f'bearingwear() ( exec {shlex.quote(sys.executable)} -m bearingwear "$@" ); '
)


onstart:
    # A group of jobs that a cluster ends early is recorded as if each of them had ended, and an
    # outdated result of one that never began would then pass for new.
    for job in workflow.dag.needrun_jobs():
        if workflow.dag.get_job_group(job) and not workflow.touch:
            for path in filter(os.path.lexists, job.output):
                os.remove(path)


wildcard_constraints:
    scene=r"[A-Za-z0-9_]+",
    case=r"[a-z_]+-mu\d+\.\d{3}-loss\d+\.\d{2}",


def made_from(*inputs):
    """What files hold, as a parameter. Inputs are compared only where they are newer than the
    results; an edited one is not, if it is a copy that kept its date or the clock was set back.
    """

    def contents(wildcards):
        paths = [i(wildcards) if callable(i) else i for i in inputs]
        flat = [path for p in paths for path in ([p] if isinstance(p, str) else p)]
        return contents_hash(*(path.format(**dict(wildcards.items())) for path in flat))

    return contents


def case_of(wildcards):
    return PLAN.grids[wildcards.scene].cases()[wildcards.case]


def case_settings(wildcards):
    return [f"--set {shlex.quote(setting)}" for setting in case_of(wildcards).settings]


def case_label(wildcards):
    return f"{wildcards.scene}: {case_of(wildcards).label}"


def dynamic_settings(wildcards):
    case = PLAN.dynamic[wildcards.scene].cases()[wildcards.case]
    settings = PLAN.dynamic_settings(wildcards.scene, case)
    return [f"--set {shlex.quote(setting)}" for setting in settings]


def dynamic_label(wildcards):
    case = PLAN.dynamic[wildcards.scene].cases()[wildcards.case]
    return f"{wildcards.scene}, in time: {case.label}"


def scene_of_life(wildcards):
    return f"config/scenes/{PLAN.lives_in_time[wildcards.life][0]}.yaml"


def life_settings(wildcards):
    settings = PLAN.lives_in_time[wildcards.life][1]
    return [f"--set {shlex.quote(setting)}" for setting in settings]


def dynamic_scene_cases(wildcards):
    return PLAN.dynamic_cases(wildcards.scene)


def reference_values(wildcards):
    return PLAN.reference(wildcards.scene)


def reference_option(wildcards, input):
    return f"--reference {input.reference}" if input.reference else ""


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


def design_parts(wildcards):
    names = DESIGN.scenes[wildcards.scene].chunks()
    return [f"results/{wildcards.scene}/design/map/{name}.nc" for name in names]


def design_text(wildcards):
    return DESIGN.scenes[wildcards.scene].text()


def lives_of_sample(wildcards):
    return [
        f"results/{wildcards.scene}/design/samples/{method}-{where}-{chunk}.nc"
        for method in DESIGN.scenes[wildcards.scene].preload_method
        for where in AT
        for chunk in range(DESIGN.sampling.chunks)
    ]


def recommended_preload(wildcards):
    if wildcards.where == AT[0]:
        return []
    return f"results/{wildcards.scene}/design/recommendation.nc"


def recommendation_option(wildcards, input):
    return f"--recommendation {input.recommendation}" if input.recommendation else ""


def known_spread(wildcards):
    return PLAN.spreads_of_lives(wildcards.scene)


def scene_methods(wildcards):
    return PLAN.grids[wildcards.scene].preload_method


def spread_option(wildcards, input):
    return f"--uncertainty {input.spread}" if input.spread else ""


def trade_scene(wildcards):
    return f"config/scenes/{TRADE.scenes[wildcards.bench].file}.yaml"


def design_results(wildcards):
    # no part of rule all; but what is there is kept up to date
    folder = "results/*/design"
    return sorted(
        file
        for kind in ("tables/*.md", "figures/*.svg", "figures/*.png")
        for file in glob(f"{folder}/{kind}")
    )
