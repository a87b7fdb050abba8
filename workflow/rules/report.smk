# Figures, tables, the report page and the verdict. `snakemake --report` makes the report of the jobs.

import time

FIGURES = config["figures"]
# The state of wear that figures show [um]: the most worn one of the first grid, if none is given.
WORN = FIGURES["worn_loss_um"]
if WORN is None:
    WORN = next((grid.ball_diameter_loss_um[-1] for grid in GRIDS.values()), 0.0)


wildcard_constraints:
    bearing="|-first|-second",  # of two bearings that differ, each has figures


rule figures:
    """Slip, wear and life of a scene, as figures."""
    input:
        study="results/{scene}/study.nc",
        lives="results/{scene}/wear_life.nc",
        spreads=spreads,
        cases=slip_cases,
    output:
        report(
            "results/{scene}/figures/fig09_slip{bearing}.svg",
            caption="../report/slip.rst",
            category="{scene}",
            labels={"result": "slip across the contacts{bearing}"},
        ),
        "results/{scene}/figures/fig09_slip{bearing}.png",
        report(
            "results/{scene}/figures/fig10_wear{bearing}.svg",
            caption="../report/wear.rst",
            category="{scene}",
            labels={"result": "QV, preload and wear rates against wear{bearing}"},
        ),
        "results/{scene}/figures/fig10_wear{bearing}.png",
        report(
            "results/{scene}/figures/wear_life{bearing}.svg",
            caption="../report/life.rst",
            category="{scene}",
            labels={"result": "wear life{bearing}"},
        ),
        "results/{scene}/figures/wear_life{bearing}.png",
    log:
        "logs/figures/{scene}{bearing}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.figures.draw"),
        friction=frictions_drawn,
        bearing=lambda wildcards: wildcards.bearing.lstrip("-"),
    shell:
        "bearingwear step bearingwear.studies.grid.figures.draw.scene_figures study={input.study}"
        " lives={input.lives} cases={input.cases} uncertainty={input.spreads}"
        " friction={params.friction} bearing={params.bearing} -o {output} &> {log}"


rule friction_figures:
    """QV and contact load of a scene against friction, new and worn."""
    input:
        "results/{scene}/study.nc",
    output:
        report(
            "results/{scene}/figures/fig07_fresh{bearing}.svg",
            caption="../report/friction.rst",
            category="{scene}",
            labels={"result": "QV and contact load against friction, new{bearing}"},
        ),
        "results/{scene}/figures/fig07_fresh{bearing}.png",
        report(
            "results/{scene}/figures/fig08_worn{bearing}.svg",
            caption="../report/friction.rst",
            category="{scene}",
            labels={"result": "QV and contact load against friction, worn{bearing}"},
        ),
        "results/{scene}/figures/fig08_worn{bearing}.png",
    log:
        "logs/friction_figures/{scene}{bearing}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.figures.draw"),
        losses=lambda wildcards: [
            GRIDS[wildcards.scene].ball_diameter_loss_um[0],
            worn_loss(wildcards),
        ],
        bearing=lambda wildcards: wildcards.bearing.lstrip("-"),
    shell:
        "bearingwear step bearingwear.studies.grid.figures.draw.friction_figures study={input}"
        " losses_um={params.losses} bearing={params.bearing} -o {output} &> {log}"


rule summary:
    """The numbers of every case of a scene as CSV, and the few that matter as Markdown."""
    input:
        study="results/{scene}/study.nc",
        lives="results/{scene}/wear_life.nc",
        spreads=spreads,
    output:
        "results/{scene}/tables/cases.csv",
        report(
            "results/{scene}/tables/summary.md",
            caption="../report/summary.rst",
            category="{scene}",
            labels={"result": "cases and lives, table, to download"},
        ),
    log:
        "logs/summary/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.tables"),
    shell:
        "bearingwear step bearingwear.studies.grid.tables.study_tables study={input.study}"
        " lives={input.lives} uncertainty={input.spreads} -o {output} &> {log}"


rule dynamic_report:
    """Cases solved dynamically beside the steady ones: figure and tables."""
    input:
        study="results/{scene}/study.nc",
        dynamic="results/{scene}/dynamic.nc",
    output:
        report(
            "results/{scene}/figures/dynamic.svg",
            caption="../report/dynamic.rst",
            category="{scene}",
            labels={"result": "dynamic cases with the cage"},
        ),
        "results/{scene}/figures/dynamic.png",
        "results/{scene}/tables/dynamic.csv",
        report(
            "results/{scene}/tables/dynamic.md",
            caption="../report/dynamic_tables.rst",
            category="{scene}",
            labels={"result": "dynamic cases, table, to download"},
        ),
    log:
        "logs/dynamic_report/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.dynamic_report"),
    shell:
        "bearingwear step bearingwear.studies.grid.dynamic_report.dynamic_report"
        " study={input.study} dynamic={input.dynamic} -o {output} &> {log}"


rule warmup:
    """Temperatures, preload and pressure of a scene with heat capacities, on the way to speed."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/steady",
    output:
        "results/{scene}/warmup.nc",
        "results/{scene}/tables/warmup.md",
        report(
            "results/{scene}/figures/warmup.svg",
            caption="../report/warmup.rst",
            category="{scene}",
            labels={"result": "warm-up"},
        ),
        "results/{scene}/figures/warmup.png",
    log:
        "logs/warmup/{scene}.log",
    resources:
        runtime=1,
    params:
        code=sources("bearingwear.studies.warmup.report"),
        scene=scene_values(),
        seconds=ramp_to_speed,
    shell:
        "bearingwear step bearingwear.studies.warmup.report.warm_up_report scene={input.scene}"
        " seconds={params.seconds} -o {output} &> {log}"


rule duty:
    """The life over a duty, at the recommended preload if there is one: shares of the phases, and what ends it."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        recommendation=recommendation_of_map,
        compiled=f"logs/compiled/{KERNELS}/worn",
    output:
        "results/{scene}/duty.nc",
        "results/{scene}/duty.json",
        report(
            "results/{scene}/figures/duty.svg",
            caption="../report/duty.rst",
            category="{scene}",
            labels={"result": "life over the duty"},
        ),
        "results/{scene}/figures/duty.png",
    log:
        "logs/duty/{scene}.log",
    resources:
        runtime=1,
    params:
        code=sources("bearingwear.studies.lives.duty_report"),
        scene=scene_values(),
    shell:
        "bearingwear step bearingwear.studies.lives.duty_report.duty_report scene={input.scene}"
        " recommendation={input.recommendation} -o {output} &> {log}"


rule running_average:
    """Wear rates of a dynamic case as they settle."""
    input:
        case="results/{scene}/dynamic/{case}.nc",
        reference=reference,
    output:
        report(
            "results/{scene}/figures/fig06_running_average-{case}.svg",
            caption="../report/running_average.rst",
            category="{scene}",
            labels={"result": "running averages of wear rates, {case}"},
        ),
        "results/{scene}/figures/fig06_running_average-{case}.png",
    log:
        "logs/running_average/{scene}/{case}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.figures.draw"),
    shell:
        "bearingwear step bearingwear.studies.grid.figures.draw.draw_running_average"
        " case={input.case} reference={input.reference} -o {output} &> {log}"


rule wear_columns:
    """QV, preload, contact angles and wear rates, a column for each scene of figures.wear_columns."""
    input:
        [f"results/{column['scene']}/study.nc" for column in FIGURES["wear_columns"]],
    output:
        report(
            "results/figures/fig10_wear.svg",
            caption="../report/wear.rst",
            category="across scenes",
            labels={"result": "QV, preload and wear rates against wear"},
        ),
        "results/figures/fig10_wear.png",
    log:
        "logs/wear_columns.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.figures.draw"),
        friction=[column["friction"] for column in FIGURES["wear_columns"]],
    shell:
        "bearingwear step bearingwear.studies.grid.figures.draw.draw_wear studies={input}"
        " friction={params.friction} -o {output} &> {log}"


rule overlay:
    """QV, preload and loss rate of several scenes, an entry of figures.spreads."""
    input:
        lambda wildcards: expand(
            "results/{scene}/study.nc",
            scene=FIGURES["spreads"][wildcards.overlay]["scenes"],
        ),
    output:
        report(
            "results/figures/spread_{overlay}.svg",
            caption="../report/overlay.rst",
            category="across scenes",
            labels={
                "result": "QV, preload and loss rate of several scenes, {overlay}"
            },
        ),
        "results/figures/spread_{overlay}.png",
    log:
        "logs/overlay/{overlay}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.figures.draw"),
        friction=lambda wildcards: FIGURES["spreads"][wildcards.overlay]["friction"],
    shell:
        "bearingwear step bearingwear.studies.grid.figures.draw.draw_overlay studies={input}"
        " friction={params.friction} -o {output} &> {log}"


rule life_overlay:
    """QV of several scenes until the end of life, an entry of figures.lives."""
    input:
        lambda wildcards: expand(
            "results/{scene}/wear_life.nc",
            scene=FIGURES["lives"][wildcards.overlay]["scenes"],
        ),
    output:
        report(
            "results/figures/lives_{overlay}.svg",
            caption="../report/life_overlay.rst",
            category="across scenes",
            labels={"result": "QV until the end of life, several scenes, {overlay}"},
        ),
        "results/figures/lives_{overlay}.png",
    log:
        "logs/life_overlay/{overlay}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.figures.draw"),
        friction=lambda wildcards: FIGURES["lives"][wildcards.overlay]["friction"],
    shell:
        "bearingwear step bearingwear.studies.grid.figures.draw.draw_life_overlay lives={input}"
        " friction={params.friction} -o {output} &> {log}"


# What the page shows, in its order; beside each SVG lies a PNG.
DATA = [
    *expand("results/{scene}/study.nc", scene=GRIDS),
    *expand("results/{scene}/wear_life.nc", scene=GRIDS),
    *expand("results/{scene}/dynamic.nc", scene=DYNAMIC),
]
BOTH = [scene for scene in DYNAMIC if scene in GRIDS]  # solved dynamically, too
ON_DUTY = [scene for scene in GRIDS if configuration.has_duty(scene)]
WARMING = [scene for scene in GRIDS if configuration.has_heat_capacities(scene)]
TABLES = [
    *expand("results/{scene}/tables/summary.md", scene=GRIDS),
    *expand("results/{scene}/tables/warmup.md", scene=WARMING),
    *expand("results/{scene}/tables/dynamic.md", scene=BOTH),
]
DRAWN = [
    *(
        f"results/{scene}/figures/{name}{bearing}.svg"
        for scene, grid in GRIDS.items()
        for bearing in configuration.figure_suffixes(scene)
        for name in (
            *(("fig07_fresh", "fig08_worn") if len(grid.friction) > 1 else ()),
            *("fig09_slip", "fig10_wear", "wear_life"),
        )
    ),
    *expand("results/{scene}/figures/dynamic.svg", scene=BOTH),
    *expand("results/{scene}/figures/warmup.svg", scene=WARMING),
    *expand("results/{scene}/figures/duty.svg", scene=ON_DUTY),
    *(
        f"results/{scene}/figures/fig06_running_average-{case}.svg"
        for scene in FIGURES["running_averages"]
        for case in DYNAMIC[scene].cases()
    ),
    *(["results/figures/fig10_wear.svg"] if FIGURES["wear_columns"] else []),
    *expand("results/figures/spread_{overlay}.svg", overlay=FIGURES["spreads"]),
    *expand("results/figures/lives_{overlay}.svg", overlay=FIGURES["lives"]),
]
# What the page says first: lives, preloads, and cages if these belong to the main study.
ANSWERS = [
    *(["results/answer.json"] if GRIDS else []),
    *expand("results/{scene}/duty.json", scene=ON_DUTY),
    *PRELOADS_SHOWN,
    *(CAGE_ANSWER if CAGE["in_main_study"] else []),
]
PAGE = "results/report/index.html"
DOCS = [
    path
    for path in ("docs/verification.md", "docs/accuracy.md")
    if os.path.isfile(path)
]


rule page:
    """The report page: one HTML file that needs no network."""
    input:
        data=DATA,
        tables=TABLES,
        figures=with_pngs(DRAWN),
        answers=ANSWERS,
        docs=DOCS,
        scenes=[ancient(f"config/scenes/{scene}.yaml") for scene in SCENES],
    output:
        report(
            PAGE,
            caption="../report/page.rst",
            category="the report page",
            labels={"result": "page"},
        ),
    log:
        "logs/page.log",
    localrule: True
    params:
        code=sources("bearingwear.page.page"),
        notes=configuration.page_notes_hash(SCENES),
    shell:
        "bearingwear page {input.data} {input.tables} {input.figures} --answers {input.answers}"
        " --docs {input.docs} --scenes {input.scenes} -o {output} &> {log}"


rule verdict:
    """Fails, each time anew, if a case or a life was not solved; or warns (`unsolved: warning`)."""
    input:
        data=DATA,
        page=PAGE,
    output:
        "results/verdict.txt",
    log:
        "logs/verdict.log",
    localrule: True
    params:
        unsolved=config["unsolved"],
    shell:
        "bearingwear step bearingwear.studies.unsolved.verdict_text paths={input.data}"
        " unsolved_is={params.unsolved} -o {output} 2>&1 | tee {log}"


STARTED = time.time()


onsuccess:
    tell_result()


onerror:
    tell_result()
