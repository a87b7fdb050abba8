# Error and computing time of the settings of a solve: `snakemake -j2 accuracy` (config/accuracy.yaml).

from os import cpu_count

from workflow.studies.accuracy import plan as accuracy_plan

ACCURACY = checked("accuracy", accuracy_plan.check_accuracy)


rule sweep:
    """Solves and times the points of a sweep, or of a reference, on a scene; nothing runs beside it."""
    input:
        plan=ancient("config/accuracy.yaml"),
        scene=lambda wildcards: ancient(scene_of_trade(wildcards)),
        lives=f"logs/compiled/{KERNELS}/worn",
        dynamic=f"logs/compiled/{KERNELS}/dynamic",
    output:
        "results/accuracy/points/{trade_scene}-{sweep}.nc",
    log:
        "logs/sweep/{trade_scene}-{sweep}.log",
    benchmark:
        "logs/sweep/{trade_scene}-{sweep}.tsv"
    wildcard_constraints:
        trade_scene="|".join(ACCURACY["scenes"]) or "none",
        sweep="|".join([*ACCURACY["references"], *ACCURACY["sweeps"]]) or "none",
    localrule: True
    threads: cpu_count()  # Snakemake lowers it to its own number of cores
    params:
        code=sources("workflow.studies.accuracy.run"),
        scene=scene_values(scene_of_trade, cage=True),
        settings=lambda wildcards: accuracy_plan.decisive_settings(
            ACCURACY, wildcards.trade_scene, wildcards.sweep
        ),
    shell:
        "bearingwear step workflow.studies.accuracy.run.solved_sweep plan={input.plan}"
        " scene={wildcards.trade_scene} sweep={wildcards.sweep} -o {output} &> {log}"


rule gather_sweeps:
    """Errors and times of all points of all sweeps."""
    input:
        [
            f"results/accuracy/points/{scene}-{sweep}.nc"
            for scene, sweep in accuracy_plan.sweep_jobs(ACCURACY)
        ],
    output:
        "results/accuracy/accuracy.nc",
    log:
        "logs/gather_sweeps.log",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.gather"),
    shell:
        "bearingwear step workflow.studies.accuracy.gather.gathered_sweeps paths={input}"
        " -o {output} &> {log}"


rule gather_effects:
    """What single effects and worn grooves change and cost."""
    input:
        [
            f"results/accuracy/points/{scene}-{sweep}.nc"
            for scene, sweep in accuracy_plan.effect_jobs(ACCURACY)
        ],
    output:
        "results/accuracy/effects.nc",
    log:
        "logs/gather_effects.log",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.gather"),
    shell:
        "bearingwear step workflow.studies.accuracy.gather.gathered_sweeps paths={input}"
        " -o {output} &> {log}"


rule trade_ensemble:
    """An ensemble of a cage with short or long runs, or with another tolerance."""
    input:
        scene=ancient(f"config/scenes/{ACCURACY['cages']['file']}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/dynamic",
    output:
        "results/accuracy/cages/{ensemble}.nc",
    log:
        "logs/trade_ensemble/{ensemble}.log",
    benchmark:
        "logs/trade_ensemble/{ensemble}.tsv"
    resources:
        runtime=60,
    params:
        code=sources("bearingwear.applications.cage.life"),
        scene=scene_values(
            f"config/scenes/{ACCURACY['cages']['file']}.yaml",
            replaced=ACCURACY["cages"]["set"],
            cage=True,
            uncertainty=True,
        ),
        changes=lambda wildcards: settings(
            ACCURACY["cages"]["set"]
            | ACCURACY["cages"]["ensembles"][wildcards.ensemble]["set"]
        ),
        runs=ACCURACY["cages"]["runs"],
        turns=lambda wildcards: ACCURACY["cages"]["ensembles"][wildcards.ensemble],
    shell:
        # an interval that is never met: all runs are made
        "bearingwear cage {input.scene} {params.changes} --runs {params.runs} --within 1e-9"
        " --least-turns {params.turns[least_turns]} --turns {params.turns[most_turns]}"
        " --jobs {threads} --record-failures --quiet -o {output} &> {log}"


rule gather_ensembles:
    """Turns, work and motions of the ensembles, run by run."""
    input:
        expand(
            "results/accuracy/cages/{ensemble}.nc",
            ensemble=ACCURACY["cages"]["ensembles"],
        ),
    output:
        "results/accuracy/cages.nc",
    log:
        "logs/gather_ensembles.log",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.cages"),
    shell:
        "bearingwear step workflow.studies.accuracy.cages.gathered_cages paths={input}"
        " -o {output} &> {log}"


rule trade_figure:
    """A figure of errors against computing time."""
    input:
        "results/accuracy/accuracy.nc",
    output:
        report(
            "results/accuracy/figures/{figure}.svg",
            caption="../report/accuracy.rst",
            category="accuracy",
            labels={"result": "{figure}"},
        ),
        "results/accuracy/figures/{figure}.png",
    log:
        "logs/trade_figure/{figure}.log",
    wildcard_constraints:
        figure="|".join(accuracy_plan.FIGURE_NAMES),
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.figures"),
    shell:
        "bearingwear step workflow.studies.accuracy.figures.figure trade={input}"
        " which={wildcards.figure} -o {output} &> {log}"


rule accuracy_tables:
    """Every point as CSV, and what each setting costs and saves as Markdown."""
    input:
        plan="config/accuracy.yaml",
        trade="results/accuracy/accuracy.nc",
    output:
        "results/accuracy/tables/accuracy.csv",
        report(
            "results/accuracy/tables/accuracy.md",
            caption="../report/accuracy.rst",
            category="accuracy",
            labels={"result": "table, to download"},
        ),
    log:
        "logs/accuracy_tables.log",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.docs"),
    shell:
        "bearingwear step workflow.studies.accuracy.docs.accuracy_tables trade={input.trade}"
        " plan={input.plan} -o {output} &> {log}"


rule effect_tables:
    """What single effects change and cost (effects), or lives with worn grooves (grooves)."""
    input:
        plan="config/accuracy.yaml",
        trade="results/accuracy/effects.nc",
    output:
        report(
            "results/accuracy/tables/{part}.md",
            caption="../report/accuracy.rst",
            category="accuracy",
            labels={"result": "{part}, table, to download"},
        ),
    log:
        "logs/effect_tables/{part}.log",
    wildcard_constraints:
        part="effects|grooves",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.docs"),
    shell:
        "bearingwear step workflow.studies.accuracy.docs.part_tables trade={input.trade}"
        " plan={input.plan} part={wildcards.part} -o {output} &> {log}"


rule cages_table:
    """What short runs and coarse steps change in an ensemble of cages."""
    input:
        plan="config/accuracy.yaml",
        trade="results/accuracy/cages.nc",
    output:
        report(
            "results/accuracy/tables/cages.md",
            caption="../report/accuracy.rst",
            category="accuracy",
            labels={"result": "cages, table, to download"},
        ),
    log:
        "logs/cages_table.log",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.docs"),
    shell:
        "bearingwear step workflow.studies.accuracy.docs.part_tables trade={input.trade}"
        " plan={input.plan} part=cages -o {output} &> {log}"


ACCURACY_SHOWN = [
    *expand("results/accuracy/figures/{figure}.svg", figure=accuracy_plan.FIGURE_NAMES),
    *expand(
        "results/accuracy/tables/{table}",
        table=("accuracy.csv", "accuracy.md", "effects.md", "grooves.md", "cages.md"),
    ),
]


rule check_docs:
    """Fails, after all figures and tables, if docs/accuracy.md says other numbers than this run."""
    input:
        plan="config/accuracy.yaml",
        docs="docs/accuracy.md",
        trade="results/accuracy/accuracy.nc",
        cages="results/accuracy/cages.nc",
        shown=ACCURACY_SHOWN,
    output:
        "results/accuracy/check.txt",
    log:
        "logs/check_docs.log",
    localrule: True
    params:
        code=sources("workflow.studies.accuracy.docs"),
    shell:
        "bearingwear step workflow.studies.accuracy.docs.check_docs trade={input.trade}"
        " plan={input.plan} docs={input.docs} cages={input.cages} -o {output} &> {log}"


rule accuracy:
    """The study of accuracy: errors and times of settings and models (config/accuracy.yaml)."""
    input:
        ACCURACY_SHOWN,
        "results/accuracy/check.txt",
    localrule: True
