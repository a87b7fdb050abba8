# Wear lives and their spread: of the grids of config/config.yaml, and with the dynamic model (config/lives.yaml).

LIVES = checked("lives", configuration.check_lives)


rule wear_life:
    """Wear life for each preload method and friction coefficient of a scene, by two routes."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        study="results/{scene}/study.nc",
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/wear_life.nc",
    log:
        "logs/wear_life/{scene}.log",
    benchmark:
        "logs/wear_life/{scene}.tsv"
    group:
        "wear_life"
    resources:
        runtime=1,
    params:
        code=sources("bearingwear.studies.grid.life"),
        scene=scene_values(uncertainty=True),
    shell:
        "bearingwear step bearingwear.studies.grid.life.study_life scene={input.scene} study={input.study}"
        " -o {output} &> {log}"


rule spread:
    """Spread in life at each friction coefficient, due to the uncertain values of the scene."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/spread.nc",
    log:
        "logs/spread/{scene}.log",
    benchmark:
        "logs/spread/{scene}.tsv"
    group:
        "spread"
    threads: 2
    resources:
        runtime=5,
    params:
        code=sources("bearingwear.studies.uncertainty.quantiles"),
        scene=scene_values(uncertainty=True),
        frictions=lambda wildcards: GRIDS[wildcards.scene].friction,
        methods=lambda wildcards: GRIDS[wildcards.scene].preload_method,
        samples=config["uncertain_lives"]["samples"],
        seed=config["uncertain_lives"]["seed"],
    shell:
        "bearingwear uncertainty {input.scene} --friction {params.frictions} --method {params.methods}"
        " --samples {params.samples} --seed {params.seed} --jobs {threads} --record-failures --quiet"
        " -o {output} &> {log}"


rule answer:
    """Which preload method gives the longest life, and what ends it, for the report page."""
    input:
        lives=expand("results/{scene}/wear_life.nc", scene=GRIDS),
        spreads=spreads,
    output:
        "results/answer.json",
    log:
        "logs/answer.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.answer"),
    shell:
        "bearingwear step bearingwear.studies.grid.answer.lives_answer lives={input.lives} uncertainty={input.spreads}"
        " -o {output} &> {log}"


rule dynamic_life:
    """A life of config/lives.yaml: wear is followed with the dynamic model, with the cage, to the end of life."""
    input:
        scene=lambda wildcards: ancient(scene_of_life(wildcards)),
        compiled=f"logs/compiled/{KERNELS}/dynamic",
    output:
        "results/lives/{life}.nc",
    log:
        "logs/dynamic_life/{life}.log",
    benchmark:
        "logs/dynamic_life/{life}.tsv"
    resources:
        runtime=40,
    params:
        code=sources("bearingwear.lives.life"),
        scene=scene_values(scene_of_life, cage=True),
        changes=lambda wildcards: settings(LIVES["lives"][wildcards.life]["set"]),
    shell:
        "bearingwear life {input.scene} --fidelity dynamic {params.changes} --record-failures --quiet"
        " -o {output} &> {log}"


rule dynamic_life_figure:
    """Wear volumes and residual preload over a life solved with the dynamic model."""
    input:
        "results/lives/{life}.nc",
    output:
        report(
            "results/lives/figures/{life}.svg",
            caption="../report/lives.rst",
            category="lives",
            labels={"result": "{life}"},
        ),
        "results/lives/figures/{life}.png",
    log:
        "logs/dynamic_life_figure/{life}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.lives.figures"),
    shell:
        "bearingwear step bearingwear.studies.lives.figures.wear_history life={input} -o {output} &> {log}"


rule lives_table:
    """The lives of config/lives.yaml beside those of the steady model."""
    input:
        expand("results/lives/{life}.nc", life=LIVES["lives"]),
    output:
        report(
            "results/lives/tables/lives.md",
            caption="../report/lives.rst",
            category="lives",
            labels={"result": "table, to download"},
        ),
    log:
        "logs/lives_table.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.lives.tables"),
    shell:
        "bearingwear step bearingwear.studies.lives.tables.lives_table lives={input} -o {output} &> {log}"


rule lives:
    """The study of lives with the dynamic model and the cage (config/lives.yaml)."""
    input:
        expand("results/lives/figures/{life}.svg", life=LIVES["lives"]),
        "results/lives/tables/lives.md",
    localrule: True
