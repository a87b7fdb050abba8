# `snakemake -j2 tradeoff`: what accuracy costs in time. Not a part of rule all.

from bearingwear.study.sweeps import TradePlan

TRADE_PLAN = "config/tradeoff.yaml"

try:
    TRADE = TradePlan.from_file(TRADE_PLAN)
except ValueError as error:
    sys.exit(str(error))

TRADE_FIGURES = ("overview", "steady", "life", "in_time", "integration", "models")
TRADE_DRAWN = [
    f"results/tradeoff/figures/{figure}.{suffix}"
    for figure in TRADE_FIGURES
    for suffix in ("svg", "png")
]
TRADE_SOURCES = [os.path.relpath(path) for path in bearingwear.study.TRADE_SOURCES]
TRADED_SOURCES = [os.path.relpath(path) for path in bearingwear.study.TRADED_SOURCES]


localrules:
    gather_tradeoff,
    figure_tradeoff,
    table_tradeoff,
    check_tradeoff,
    tradeoff,


# All points of one sweep on one scene. Takes every core, so that nothing else is timed with it.
rule trade:
    input:
        scene=trade_scene,
        sources=SOLVER + TRADE_SOURCES,
    output:
        "results/tradeoff/points/{bench}-{sweep}.nc",
    log:
        "logs/tradeoff/{bench}-{sweep}.log",
    wildcard_constraints:
        bench=r"[a-z0-9_]+",
        sweep=r"[a-z0-9_]+",
    threads: workflow.resource_settings.cores or 1  # a cluster has no total: one each
    params:
        made_from=made_from(trade_scene, *SOLVER, *TRADE_SOURCES),
        points=lambda wildcards: TRADE.text(wildcards.bench, wildcards.sweep),
        plan=TRADE_PLAN,
    message:
        "accuracy against time: {wildcards.bench}, {wildcards.sweep}"
    shell:
        "bearingwear tradeoff {wildcards.bench} {wildcards.sweep} --plan {params.plan} -o {output} > {log} 2>&1"


# Every point with its errors.
rule gather_tradeoff:
    input:
        points=[
            f"results/tradeoff/points/{bench}-{sweep}.nc"
            for bench, sweep in TRADE.jobs()
        ],
        sources=TRADED_SOURCES,
    output:
        "results/tradeoff/tradeoff.nc",
    log:
        "logs/tradeoff/tradeoff.log",
    params:
        made_from=made_from(*TRADED_SOURCES),
    message:
        "accuracy against time: gather the sweeps"
    shell:
        "bearingwear gather-tradeoff {input.points} -o {output} > {log} 2>&1"


# Wall time against error.
rule figure_tradeoff:
    input:
        trade="results/tradeoff/tradeoff.nc",
        sources=REPORT,
    output:
        svg=report(
            "results/tradeoff/figures/{figure}.svg",
            caption="../report/tradeoff.rst",
            category="accuracy against time",
            labels={"result": "{figure}"},
        ),
        png="results/tradeoff/figures/{figure}.png",
    log:
        "logs/tradeoff/{figure}.log",
    wildcard_constraints:
        figure="|".join(TRADE_FIGURES),
    params:
        made_from=made_from(*REPORT),
    message:
        "accuracy against time: figure {wildcards.figure}"
    shell:
        "bearingwear figure tradeoff {wildcards.figure} {input.trade} -o {output} > {log} 2>&1"


# What each simplification costs and saves.
rule table_tradeoff:
    input:
        trade="results/tradeoff/tradeoff.nc",
        plan=TRADE_PLAN,
        sources=REPORT,
    output:
        all="results/tradeoff/tables/tradeoff.csv",
        summary=report(
            "results/tradeoff/tables/tradeoff.md",
            caption="../report/tradeoff.rst",
            category="accuracy against time",
            labels={"result": "table"},
        ),
    log:
        "logs/tradeoff/tables.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "accuracy against time: tables"
    shell:
        "bearingwear tables-tradeoff {input.trade} --plan {input.plan} -o {output} > {log} 2>&1"


# Comes last and fails if docs/accuracy.md says otherwise, beyond the spread stated there.
rule check_tradeoff:
    input:
        trade="results/tradeoff/tradeoff.nc",
        plan=TRADE_PLAN,
        docs="docs/accuracy.md",
        sources=REPORT,
        others=rules.table_tradeoff.output + TRADE_DRAWN,
    output:
        "results/tradeoff/check.txt",
    log:
        "logs/tradeoff/check.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "accuracy against time: compare with docs/accuracy.md"
    shell:
        "bearingwear docs-tradeoff {input.trade} {input.docs} --plan {input.plan} --check 2>&1 | tee {log} > {output}"


rule tradeoff:
    input:
        rules.check_tradeoff.input,
        rules.check_tradeoff.output,
