# Sampled lives at a scene's own preload and at the recommended one: `snakemake -j2 uncertainty` (config/uncertainty.yaml).


rule sample_lives:
    """A part of the sampled lives of one preload method at one preload."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        recommendation=recommended_preload,
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/design/samples/{method}-{choice}-{chunk}.nc",
    log:
        "logs/sample_lives/{scene}/{method}-{choice}-{chunk}.log",
    benchmark:
        "logs/sample_lives/{scene}/{method}-{choice}-{chunk}.tsv"
    wildcard_constraints:
        choice="own|recommended",
        chunk=r"\d+",
    group:
        "sample_lives"
    resources:
        runtime=9,
    params:
        code=sources("bearingwear.studies.uncertainty.sample"),
        scene=scene_values(uncertainty=True),
        sampling=UNCERTAINTY["sampling"],
    shell:
        "bearingwear step bearingwear.studies.uncertainty.sample.sampled_lives scene={input.scene}"
        " method={wildcards.method} preload_choice={wildcards.choice} chunk={wildcards.chunk}"
        " sampling={params.sampling:q} recommendation={input.recommendation} -o {output} &> {log}"


rule quantiles:
    """Quantiles of the sampled lives, and which uncertain value decides."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        parts=lambda wildcards: expand(
            "results/{scene}/design/samples/{method}-{choice}-{chunk}.nc",
            scene=wildcards.scene,
            method=UNCERTAINTY["scenes"][wildcards.scene]["preload_method"],
            choice=("own", "recommended"),
            chunk=range(UNCERTAINTY["sampling"]["chunks"]),
        ),
    output:
        "results/{scene}/design/uncertainty.nc",
    log:
        "logs/quantiles/{scene}.log",
    benchmark:
        "logs/quantiles/{scene}.tsv"
    resources:
        runtime=3,
    params:
        code=sources("bearingwear.studies.uncertainty.quantiles"),
        scene=scene_values(uncertainty=True),
        sampling=UNCERTAINTY["sampling"],
    shell:
        "bearingwear step bearingwear.studies.uncertainty.quantiles.quantiles_and_indices"
        " scene={input.scene} parts={input.parts} sampling={params.sampling:q} -o {output} &> {log}"


rule uncertainty_figure:
    """Spread in life at the recommended preload, and which uncertain value decides."""
    input:
        design="results/{scene}/design/design.nc",
        recommendation="results/{scene}/design/recommendation.nc",
        uncertainty="results/{scene}/design/uncertainty.nc",
    output:
        report(
            "results/{scene}/design/figures/uncertainty.svg",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "uncertainty in life"},
        ),
        "results/{scene}/design/figures/uncertainty.png",
    log:
        "logs/uncertainty_figure/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.figures.draw"),
    shell:
        "bearingwear step bearingwear.studies.design.figures.draw.draw_uncertainty"
        " design={input.design} recommendation={input.recommendation}"
        " uncertainty={input.uncertainty} -o {output} &> {log}"


rule uncertainty:
    """The study of uncertainty: sampled lives and their quantiles (config/uncertainty.yaml)."""
    input:
        expand("results/{scene}/design/uncertainty.nc", scene=UNCERTAINTY["scenes"]),
    localrule: True
