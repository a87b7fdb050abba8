# `snakemake -j2 lives_in_time`: wear lives with a run in time at every step. Not a part of rule all.

LIVES_IN_TIME = [f"results/lives_in_time/{life}.nc" for life in PLAN.lives_in_time]
LIVES_DRAWN = [
    f"results/lives_in_time/figures/{life}.{suffix}"
    for life in PLAN.lives_in_time
    for suffix in ("svg", "png")
]


localrules:
    figure_life_in_time,
    table_lives,
    lives_in_time,


# With the cage. A life whose end is not reached is recorded in its file.
rule life_in_time:
    input:
        scene=scene_of_life,
        sources=SOLVER,
    output:
        "results/lives_in_time/{life}.nc",
    log:
        "logs/lives_in_time/{life}.log",
    benchmark:
        "logs/lives_in_time/{life}.tsv"
    wildcard_constraints:
        life=r"[A-Za-z0-9_]+",
    params:
        made_from=made_from(scene_of_life, *SOLVER),
        settings=life_settings,
    message:
        "life in time: {wildcards.life}"
    shell:
        "bearingwear life {input.scene} -o {output} {params.settings} --fidelity dynamic --record-failures > {log} 2>&1"


# What wears over a life.
rule figure_life_in_time:
    input:
        life="results/lives_in_time/{life}.nc",
        sources=REPORT,
    output:
        svg=report(
            "results/lives_in_time/figures/{life}.svg",
            caption="../report/life_in_time.rst",
            category="lives in time",
            labels={"result": "{life}"},
        ),
        png="results/lives_in_time/figures/{life}.png",
    log:
        "logs/lives_in_time/{life}_figure.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "life in time: figure {wildcards.life}"
    shell:
        "bearingwear figure life-in-time {input.life} -o {output} > {log} 2>&1"


# All lives beside the steady ones.
rule table_lives:
    input:
        lives=LIVES_IN_TIME,
        sources=REPORT,
    output:
        report(
            "results/lives_in_time/tables/lives.md",
            caption="../report/life_in_time.rst",
            category="lives in time",
            labels={"result": "table"},
        ),
    log:
        "logs/lives_in_time/table.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "lives in time: table"
    shell:
        "bearingwear tables-lives {input.lives} -o {output} > {log} 2>&1"


rule lives_in_time:
    input:
        LIVES_DRAWN,
        rules.table_lives.output,
