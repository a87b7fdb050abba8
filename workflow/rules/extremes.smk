# `snakemake -j2 extremes`: far beyond the study. Not a part of rule all.

from bearingwear.study.extremes import ExtremesPlan

EXTREMES_PLAN = "config/extremes.yaml"

try:
    EXTREMES = ExtremesPlan.from_file(EXTREMES_PLAN)
except ValueError as error:
    sys.exit(str(error))

EXTREMES_SCENE = f"config/scenes/{EXTREMES.scene}.yaml"
EXTREMES_FILES = {
    kind: [
        f"results/extremes/{kind}/{name}.nc"
        for of, name in EXTREMES.jobs()
        if of == kind
    ]
    for kind in ("families", "maps", "branches")
}
EXTREMES_DRAWN = [
    f"results/extremes/figures/{kind}-{name}.{suffix}"
    for kind, name in EXTREMES.jobs()
    if kind != "families"
    for suffix in ("svg", "png")
]
STRESS_SOURCES = [os.path.relpath(path) for path in bearingwear.study.STRESS_SOURCES]
COUNT_SOURCES = [os.path.relpath(path) for path in bearingwear.study.COUNT_SOURCES]


localrules:
    gather_extremes,
    figure_extremes,
    table_extremes,
    extremes,


# All random scenes of a family, all points of a map, or all of a branch, in one job.
rule stress:
    input:
        scene=EXTREMES_SCENE,
        sources=SOLVER + STRESS_SOURCES,
    output:
        "results/extremes/{kind}/{name}.nc",
    log:
        "logs/extremes/{kind}-{name}.log",
    wildcard_constraints:
        kind="families|maps|branches",
        name=r"[a-z0-9_]+",
    params:
        made_from=made_from(EXTREMES_SCENE, *SOLVER, *STRESS_SOURCES),
        text=lambda wildcards: EXTREMES.text(wildcards.kind, wildcards.name),
        plan=EXTREMES_PLAN,
    message:
        "extremes: {wildcards.kind}, {wildcards.name}"
    shell:
        "bearingwear extremes {wildcards.kind} {wildcards.name} --plan {params.plan} -o {output} > {log} 2>&1"


# How all scenes ended.
rule gather_extremes:
    input:
        files=EXTREMES_FILES["families"] + EXTREMES_FILES["maps"],
        sources=COUNT_SOURCES,
    output:
        "results/extremes/extremes.nc",
    log:
        "logs/extremes/gather.log",
    params:
        made_from=made_from(*COUNT_SOURCES),
    message:
        "extremes: count how the scenes ended"
    shell:
        "bearingwear gather-extremes {input.files} -o {output} > {log} 2>&1"


# A map with its boundaries, or branches.
rule figure_extremes:
    input:
        found="results/extremes/{kind}/{name}.nc",
        sources=REPORT,
    output:
        svg=report(
            "results/extremes/figures/{kind}-{name}.svg",
            caption="../report/extremes.rst",
            category="extremes",
            labels={"result": "{name}"},
        ),
        png="results/extremes/figures/{kind}-{name}.png",
    log:
        "logs/extremes/figure-{kind}-{name}.log",
    wildcard_constraints:
        kind="maps|branches",
        name=r"[a-z0-9_]+",
    params:
        made_from=made_from(*REPORT),
    message:
        "extremes: figure {wildcards.name}"
    shell:
        "bearingwear figure extremes {input.found} -o {output} > {log} 2>&1"


# Fails if a verified answer is wrong.
rule table_extremes:
    input:
        counts="results/extremes/extremes.nc",
        drawn=EXTREMES_DRAWN,
        sources=REPORT,
    output:
        "results/extremes/tables/extremes.md",
    log:
        "logs/extremes/table.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "extremes: table"
    shell:
        "bearingwear tables-extremes {input.counts} -o {output} > {log} 2>&1"


rule extremes:
    input:
        rules.table_extremes.input,
        rules.table_extremes.output,
