# The recommended preload: small maps, a part of the main study, and large ones (config/design.yaml).

from os import cpu_count

SMALL_MAPS = [
    scene
    for scene, one in DESIGN["scenes"].items()
    if "small_map" in one and (scene in GRIDS or not GRIDS)
]
MAPS = [scene for scene, one in DESIGN["scenes"].items() if "map" in one]


rule small_map:
    """Lives over a few preloads, and the preload to take by the requirements of config/design.yaml."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/preload/design.nc",
        "results/{scene}/preload/recommendation.nc",
    log:
        "logs/small_map/{scene}.log",
    benchmark:
        "logs/small_map/{scene}.tsv"
    priority: 1
    localrule: True
    threads: cpu_count()  # Snakemake lowers it to its own number of cores
    params:
        code=sources("bearingwear.studies.design.recommend"),
        scene=scene_values(uncertainty=True),
        axes=lambda wildcards: map_of(wildcards.scene, "small_map"),
        limits=limits_of,
    shell:
        "bearingwear step bearingwear.studies.design.recommend.small_map scene={input.scene}"
        " axes={params.axes:q} limits={params.limits:q} workers={threads} -o {output} &> {log}"


rule spread_at_recommended_preload:
    """Spread in life at the recommended preload of each method."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        recommendation="results/{scene}/preload/recommendation.nc",
    output:
        "results/{scene}/preload/spread.nc",
    log:
        "logs/spread_at_recommended_preload/{scene}.log",
    benchmark:
        "logs/spread_at_recommended_preload/{scene}.tsv"
    group:
        "spread"
    threads: 2
    resources:
        runtime=5,
    params:
        code=sources("bearingwear.studies.uncertainty.quantiles"),
        scene=scene_values(uncertainty=True),
        samples=config["uncertain_lives"]["samples"],
        seed=config["uncertain_lives"]["seed"],
    shell:
        "bearingwear step bearingwear.studies.uncertainty.quantiles.recommended_life_quantiles"
        " scene={input.scene} recommendation={input.recommendation} samples={params.samples}"
        " seed={params.seed} workers={threads} -o {output} &> {log}"


rule preload_report:
    """The recommended preload: figure, tables, and what the report page says of it."""
    input:
        design="results/{scene}/preload/design.nc",
        recommendation="results/{scene}/preload/recommendation.nc",
        spread=spread_at_preload,
    output:
        report(
            "results/{scene}/preload/figures/design.svg",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "life and requirements against preload"},
        ),
        "results/{scene}/preload/figures/design.png",
        "results/{scene}/preload/tables/map.csv",
        report(
            "results/{scene}/preload/tables/design.md",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "recommendation, table, to download"},
        ),
        "results/{scene}/preload/answer.json",
        "results/{scene}/preload/charts.json",
    log:
        "logs/preload_report/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.report"),
    shell:
        "bearingwear step bearingwear.studies.design.report.preload_report design={input.design}"
        " recommendation={input.recommendation} spread={input.spread} -o {output} &> {log}"


rule small_map_figure:
    """Life and requirements against preload and friction, of a map over several friction coefficients."""
    input:
        "results/{scene}/preload/design.nc",
    output:
        report(
            "results/{scene}/preload/figures/map.svg",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "life and requirements against preload and friction"},
        ),
        "results/{scene}/preload/figures/map.png",
    log:
        "logs/small_map_figure/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.figures.draw"),
    shell:
        "bearingwear step bearingwear.studies.design.figures.draw.draw_map design={input}"
        " -o {output} &> {log}"


# Files of every small map: data of the page, figures and tables.
SMALL_FIGURES = [
    *expand("results/{scene}/preload/figures/design.svg", scene=SMALL_MAPS),
    *(
        f"results/{scene}/preload/figures/map.svg"
        for scene in SMALL_MAPS
        if len(map_of(scene, "small_map")["friction"]) > 1
    ),
]
SMALL_ANSWERS = expand(
    "results/{scene}/preload/{file}",
    scene=SMALL_MAPS,
    file=("answer.json", "charts.json", "recommendation.nc"),
)


# A map over preload, friction and speed, one job for each method and friction coefficient: `snakemake -j2 design`.


rule map_part:
    """Lives over preload and speed, for one preload method and friction coefficient of a map."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/design/map/{method}-mu{mu}.nc",
    log:
        "logs/map_part/{scene}/{method}-mu{mu}.log",
    benchmark:
        "logs/map_part/{scene}/{method}-mu{mu}.tsv"
    group:
        "map_part"
    resources:
        runtime=4,
    params:
        code=sources("bearingwear.studies.design.map"),
        scene=scene_values(),
        axes=lambda wildcards: map_of(wildcards.scene),
        slip_limit=lambda wildcards: limits_of(wildcards).get("gyroscopic_slip_share"),
        thermal_margin=lambda wildcards: limits_of(wildcards).get("thermal_margin"),
    shell:
        "bearingwear step bearingwear.studies.design.map.map_part scene={input.scene}"
        " method={wildcards.method} friction={wildcards.mu} shaft_speed_rpm={params.axes[shaft_speed_rpm]}"
        " preload_N={params.axes[preload_N]} slip_limit={params.slip_limit}"
        " thermal_margin={params.thermal_margin} -o {output} &> {log}"


rule design_map:
    """The map of a scene, and the best preload of every line of it."""
    input:
        map_parts,
    output:
        "results/{scene}/design/design.nc",
    log:
        "logs/design_map/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.choice"),
        limits=limits_of,
    shell:
        "bearingwear step bearingwear.studies.design.choice.design_map parts={input}"
        " limits={params.limits:q} -o {output} &> {log}"


rule recommend:
    """The preload to take, from the map of a scene."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        design="results/{scene}/design/design.nc",
    output:
        "results/{scene}/design/recommendation.nc",
    log:
        "logs/recommend/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.recommend"),
        scene=scene_values(uncertainty=True),
    shell:
        "bearingwear step bearingwear.studies.design.recommend.recommendation_of scene={input.scene}"
        " design={input.design} -o {output} &> {log}"


rule design_report:
    """The recommended preload of a map: figures, tables, and what the report page says of it."""
    input:
        design="results/{scene}/design/design.nc",
        recommendation="results/{scene}/design/recommendation.nc",
        uncertainty=sampled,
    output:
        report(
            "results/{scene}/design/figures/design.svg",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "life and requirements against preload, large map"},
        ),
        "results/{scene}/design/figures/design.png",
        "results/{scene}/design/tables/map.csv",
        report(
            "results/{scene}/design/tables/design.md",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "recommendation, large map, table, to download"},
        ),
        "results/{scene}/design/answer.json",
        "results/{scene}/design/charts.json",
    log:
        "logs/design_report/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.report"),
    shell:
        "bearingwear step bearingwear.studies.design.report.preload_report design={input.design}"
        " recommendation={input.recommendation} uncertainty={input.uncertainty} -o {output} &> {log}"


rule design_map_figure:
    """Life and requirements against preload and friction, of a large map."""
    input:
        "results/{scene}/design/design.nc",
    output:
        report(
            "results/{scene}/design/figures/map.svg",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "life and requirements against preload and friction"},
        ),
        "results/{scene}/design/figures/map.png",
    log:
        "logs/design_map_figure/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.figures.draw"),
    shell:
        "bearingwear step bearingwear.studies.design.figures.draw.draw_map design={input}"
        " -o {output} &> {log}"


# The recommended preload and two beside it, solved by both models.
CHECKED = ("0.80", "1.00", "1.25")


rule check_scene:
    """The scene with so many times the recommended preload."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        recommendation="results/{scene}/design/recommendation.nc",
    output:
        "results/{scene}/design/check/{times}.yaml",
    log:
        "logs/check_scene/{scene}/{times}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.dynamic_check"),
        scene=scene_values(cage=True),
    shell:
        "bearingwear step bearingwear.studies.design.dynamic_check.check_scene_text"
        " scene={input.scene} recommendation={input.recommendation} times={wildcards.times}"
        " -o {output} &> {log}"


rule solve_check:
    """A preload at or beside the recommended one, solved by one model."""
    input:
        scene="results/{scene}/design/check/{times}.yaml",
        compiled=f"logs/compiled/{KERNELS}/{{fidelity}}",
    output:
        "results/{scene}/design/check/{times}-{fidelity}.nc",
    log:
        "logs/solve_check/{scene}/{times}-{fidelity}.log",
    benchmark:
        "logs/solve_check/{scene}/{times}-{fidelity}.tsv"
    group:
        "solve_check"
    resources:
        runtime=6,
    params:
        code=sources("bearingwear.solvers.solve"),
    shell:
        "bearingwear solve {input.scene} --fidelity {wildcards.fidelity} --record-failures --quiet"
        " -o {output} &> {log}"


rule check_table:
    """Steady and dynamic numbers at and beside the recommended preload, and whether they agree."""
    input:
        recommendation="results/{scene}/design/recommendation.nc",
        cases=expand(
            "results/{{scene}}/design/check/{times}-{fidelity}.nc",
            times=CHECKED,
            fidelity=("steady", "dynamic"),
        ),
    output:
        report(
            "results/{scene}/design/tables/check.md",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "dynamic check, table, to download"},
        ),
    log:
        "logs/check_table/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.design.document.check_table"),
    shell:
        "bearingwear step bearingwear.studies.design.document.check_table.check_table"
        " recommendation={input.recommendation} cases={input.cases} -o {output} &> {log}"


# Files of every large map, with its dynamic check and, for a scene of config/uncertainty.yaml, the causes of spread.
LARGE_FIGURES = [
    *expand("results/{scene}/design/figures/design.svg", scene=MAPS),
    *expand("results/{scene}/design/figures/map.svg", scene=MAPS),
    *expand(
        "results/{scene}/design/figures/uncertainty.svg",
        scene=[scene for scene in MAPS if scene in UNCERTAINTY["scenes"]],
    ),
]
LARGE_ANSWERS = expand(
    "results/{scene}/design/{file}",
    scene=MAPS,
    file=("answer.json", "charts.json", "recommendation.nc", "tables/check.md"),
)
# What the page shows of preloads: large maps if they belong to the main study, otherwise small ones.
PRELOADS_SHOWN = (
    [*LARGE_ANSWERS, *with_pngs(LARGE_FIGURES)]
    if DESIGN["in_main_study"] and MAPS
    else [*SMALL_ANSWERS, *with_pngs(SMALL_FIGURES)]
)


rule design:
    """The study of preloads: large maps, small maps, recommended preloads, dynamic checks (config/design.yaml)."""
    input:
        SMALL_ANSWERS,
        SMALL_FIGURES,
        LARGE_ANSWERS,
        LARGE_FIGURES,
    localrule: True
