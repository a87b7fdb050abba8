# From the cases to the study, the wear life, the tables and the verdict.


localrules:
    gather,
    gather_dynamic,
    tables,
    compare,
    verdict,


# All cases of a scene in one file.
rule gather:
    input:
        cases=scene_cases,
        sources=STUDY,
    output:
        "results/{scene}/study.nc",
    log:
        "logs/{scene}/study.log",
    params:
        made_from=made_from(*STUDY),
    message:
        "{wildcards.scene}: gather the cases"
    shell:
        "bearingwear gather {input.cases} -o {output} > {log} 2>&1"


# All cases of a scene that were solved in time, without their histories.
rule gather_dynamic:
    input:
        cases=dynamic_scene_cases,
        sources=STUDY,
    output:
        "results/{scene}/dynamic.nc",
    log:
        "logs/{scene}/dynamic.log",
    params:
        made_from=made_from(*STUDY),
    message:
        "{wildcards.scene}: gather the cases solved in time"
    shell:
        "bearingwear gather {input.cases} -o {output} > {log} 2>&1"


# Wear life by both routes: the solver in the loop, and interpolation of the study.
rule wear_life:
    input:
        scene=SCENE,
        study="results/{scene}/study.nc",
        sources=SOLVER + STUDY,
    output:
        "results/{scene}/wear_life.nc",
    log:
        "logs/{scene}/wear_life.log",
    benchmark:
        "logs/{scene}/wear_life.tsv"
    params:
        made_from=made_from(SCENE, *SOLVER, *STUDY),
    message:
        "{wildcards.scene}: wear life"
    shell:
        "bearingwear wear-life {input.scene} {input.study} -o {output} > {log} 2>&1"


# How the lives at a friction coefficient spread, with all that the scene calls uncertain.
rule life_spread:
    input:
        scene=SCENE,
        sources=SOLVER + DESIGN_SOURCES,
    output:
        "results/{scene}/spread/mu{mu}.nc",
    log:
        "logs/{scene}/spread-mu{mu}.log",
    wildcard_constraints:
        mu=r"\d+\.\d{3}",
    params:
        made_from=made_from(SCENE, *SOLVER, *DESIGN_SOURCES),
        method=scene_methods,
        sampling=f"--samples {PLAN.sampling.samples} --seed {PLAN.sampling.seed}",
    message:
        "{wildcards.scene}: how its lives spread, mu {wildcards.mu}"
    shell:
        "bearingwear life-spread {input.scene} --friction {wildcards.mu} --method {params.method} {params.sampling} -o {output} > {log} 2>&1"


# The numbers of a scene as CSV, and the few that matter as Markdown.
rule tables:
    input:
        study="results/{scene}/study.nc",
        life="results/{scene}/wear_life.nc",
        spread=known_spread,
        sources=REPORT,
    output:
        cases="results/{scene}/tables/cases.csv",
        summary=report(
            "results/{scene}/tables/summary.md",
            caption="../report/summary.rst",
            category="{scene}",
            labels={"result": "summary"},
        ),
    log:
        "logs/{scene}/tables.log",
    params:
        made_from=made_from(*REPORT),
        spread=spread_option,
    message:
        "{wildcards.scene}: tables"
    shell:
        "bearingwear tables {input.study} {input.life} {params.spread} -o {output.cases} {output.summary} > {log} 2>&1"


# Cases solved in time beside the steady ones, as CSV and Markdown.
rule compare:
    input:
        study="results/{scene}/study.nc",
        dynamic="results/{scene}/dynamic.nc",
        sources=REPORT,
    output:
        all="results/{scene}/tables/dynamic.csv",
        summary=report(
            "results/{scene}/tables/dynamic.md",
            caption="../report/compare.rst",
            category="{scene}",
            labels={"result": "dynamic, table"},
        ),
    log:
        "logs/{scene}/compare.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "{wildcards.scene}: tables of cases solved in time"
    shell:
        "bearingwear tables-dynamic {input.study} {input.dynamic} -o {output.all} {output.summary} > {log} 2>&1"


# Comes last and fails, each time anew, if a case or a life could not be solved.
rule verdict:
    input:
        cases=PLAN.cases(),
        dynamic_cases=PLAN.dynamic_cases(),
        studies=PLAN.studies(),
        dynamics=PLAN.dynamics(),
        lives=PLAN.lives(),
        tables=PLAN.tables(),
        figures=PLAN.figures(),
        page="results/report/index.html",
    output:
        "results/verdict.txt",
    log:
        "logs/verdict.log",
    message:
        "look for cases that could not be solved"
    shell:
        "bearingwear verdict {input.studies} {input.dynamics} {input.lives} -o {output} 2>&1 | tee {log}"
