# Sampled lives at a scene's own preload and at the recommended one: `snakemake -j2 uncertainty` (config/uncertainty.yaml).


rule quantiles:
    """Quantiles of sampled lives at the scene's own preload and at the recommended one, and which value decides."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        recommendation="results/{scene}/design/recommendation.nc",
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/design/uncertainty.nc",
    log:
        "logs/quantiles/{scene}.log",
    benchmark:
        "logs/quantiles/{scene}.tsv"
    threads: 2
    resources:
        runtime=9,
    params:
        code=sources("bearingwear.studies.uncertainty.quantiles"),
        scene=scene_values(uncertainty=True),
        methods=lambda wildcards: UNCERTAINTY["scenes"][wildcards.scene][
            "preload_method"
        ],
        samples=UNCERTAINTY["sampling"]["samples"],
        seed=UNCERTAINTY["sampling"]["seed"],
    shell:
        "bearingwear step bearingwear.studies.uncertainty.quantiles.quantiles_and_indices"
        " scene={input.scene} recommendation={input.recommendation} methods= {params.methods}"
        " samples={params.samples} seed={params.seed} workers={threads} -o {output} &> {log}"


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
