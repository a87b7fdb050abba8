# `snakemake -j2 design`: which preload, and how sure. Not a part of rule all.

from bearingwear.study.design_plan import AT, CHECKED, DesignPlan

DESIGN_PLAN = "config/design.yaml"

try:
    DESIGN = DesignPlan.from_file(DESIGN_PLAN)
except ValueError as error:
    sys.exit(str(error))

CHECK_SOURCES = [os.path.relpath(path) for path in bearingwear.study.CHECK_SOURCES]
FAMILY_SOURCES = [os.path.relpath(path) for path in bearingwear.study.FAMILY_SOURCES]
FAMILY_SCENES = sorted(
    {
        f"config/scenes/{name}.yaml"
        for name in (DESIGN.family.scene, *DESIGN.family.marks)
    }
)
DESIGN_FIGURES = ("design", "map", "uncertainty")


localrules:
    gather_design,
    recommend,
    check_scene,
    table_design,
    table_check,
    table_family,
    design,
    identify,


wildcard_constraints:
    method="constant_force|fixed_position",
    where="|".join(AT),
    chunk=r"\d+",
    times="|".join(CHECKED),


# Lives over preload and speed, for one method and one friction coefficient.
rule design_map:
    input:
        scene=SCENE,
        sources=SOLVER + DESIGN_SOURCES,
    output:
        "results/{scene}/design/map/{method}-mu{mu}.nc",
    log:
        "logs/{scene}/design/{method}-mu{mu}.log",
    wildcard_constraints:
        mu=r"\d+\.\d{3}",
    params:
        made_from=made_from(SCENE, *SOLVER, *DESIGN_SOURCES),
        axes=design_text,
        plan=DESIGN_PLAN,
    message:
        "{wildcards.scene}: design map, {wildcards.method}, mu {wildcards.mu}"
    shell:
        "bearingwear design-map {input.scene} --plan {params.plan} --method {wildcards.method} --friction {wildcards.mu} -o {output} > {log} 2>&1"


# The whole map, and the best preload of each of its lines.
rule gather_design:
    input:
        parts=design_parts,
        sources=DESIGN_SOURCES,
    output:
        "results/{scene}/design/design.nc",
    log:
        "logs/{scene}/design/design.log",
    params:
        made_from=made_from(*DESIGN_SOURCES),
    message:
        "{wildcards.scene}: gather the design map"
    shell:
        "bearingwear gather-design {input.parts} -o {output} > {log} 2>&1"


# The preload with the longest life within the limits, between those of the map.
rule recommend:
    input:
        scene=SCENE,
        design="results/{scene}/design/design.nc",
        sources=SOLVER + DESIGN_SOURCES,
    output:
        "results/{scene}/design/recommendation.nc",
    log:
        "logs/{scene}/design/recommendation.log",
    params:
        made_from=made_from(SCENE, *SOLVER, *DESIGN_SOURCES),
    message:
        "{wildcards.scene}: recommended preload"
    shell:
        "bearingwear recommend {input.scene} {input.design} -o {output} > {log} 2>&1"


# A part of the lives at sampled values, at the scene's own or the recommended preload.
rule sample_lives:
    input:
        scene=SCENE,
        recommendation=recommended_preload,
        sources=SOLVER + DESIGN_SOURCES,
    output:
        "results/{scene}/design/samples/{method}-{where}-{chunk}.nc",
    log:
        "logs/{scene}/design/{method}-{where}-{chunk}.log",
    params:
        made_from=made_from(SCENE, *SOLVER, *DESIGN_SOURCES),
        sampling=str(DESIGN.sampling),
        plan=DESIGN_PLAN,
        recommendation=recommendation_option,
    message:
        "{wildcards.scene}: uncertainty, {wildcards.method}, {wildcards.where} preload, part {wildcards.chunk}"
    shell:
        "bearingwear sample-lives {input.scene} --plan {params.plan} --method {wildcards.method} {params.recommendation} --chunk {wildcards.chunk} -o {output} > {log} 2>&1"


# Quantiles of life, and which uncertain value decides.
rule spread_lives:
    input:
        scene=SCENE,
        lives=lives_of_sample,
        sources=SOLVER + DESIGN_SOURCES,
    output:
        "results/{scene}/design/uncertainty.nc",
    log:
        "logs/{scene}/design/uncertainty.log",
    params:
        made_from=made_from(SCENE, *SOLVER, *DESIGN_SOURCES),
        plan=DESIGN_PLAN,
    message:
        "{wildcards.scene}: uncertainty of the life"
    shell:
        "bearingwear spread {input.scene} {input.lives} --plan {params.plan} -o {output} > {log} 2>&1"


# Which preload to take, what lies around it, and how sure its life is.
rule figure_design:
    input:
        design="results/{scene}/design/design.nc",
        recommendation="results/{scene}/design/recommendation.nc",
        uncertainty="results/{scene}/design/uncertainty.nc",
        sources=REPORT + DESIGN_SOURCES,
    output:
        svg=report(
            "results/{scene}/design/figures/{figure}.svg",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "design, {figure}"},
        ),
        png="results/{scene}/design/figures/{figure}.png",
    log:
        "logs/{scene}/design/figure-{figure}.log",
    wildcard_constraints:
        figure="|".join(DESIGN_FIGURES),
    params:
        made_from=made_from(*REPORT, *DESIGN_SOURCES),
    message:
        "{wildcards.scene}: figure {wildcards.figure} of the design study"
    shell:
        "bearingwear figure design {wildcards.figure} {input.design} {input.recommendation} {input.uncertainty} -o {output} > {log} 2>&1"


# The recommended preloads with life, spread and limit as Markdown, the whole map as CSV.
rule table_design:
    input:
        design="results/{scene}/design/design.nc",
        recommendation="results/{scene}/design/recommendation.nc",
        uncertainty="results/{scene}/design/uncertainty.nc",
        sources=REPORT + DESIGN_SOURCES,
    output:
        all="results/{scene}/design/tables/map.csv",
        summary=report(
            "results/{scene}/design/tables/design.md",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "design, table"},
        ),
    log:
        "logs/{scene}/design/tables.log",
    params:
        made_from=made_from(*REPORT, *DESIGN_SOURCES),
    message:
        "{wildcards.scene}: tables of the design study"
    shell:
        "bearingwear tables-design {input.design} {input.recommendation} {input.uncertainty} -o {output} > {log} 2>&1"


# The scene at a multiple of its recommended preload.
rule check_scene:
    input:
        scene=SCENE,
        recommendation="results/{scene}/design/recommendation.nc",
        sources=CHECK_SOURCES,
    output:
        "results/{scene}/design/check/{times}.yaml",
    log:
        "logs/{scene}/design/check-{times}.log",
    params:
        made_from=made_from(SCENE, *CHECK_SOURCES),
    message:
        "{wildcards.scene}: scene at {wildcards.times} times the recommended preload"
    shell:
        "bearingwear check-scene {input.scene} {input.recommendation} --times {wildcards.times} -o {output} > {log} 2>&1"


# It is solved by both tiers.
rule solve_check:
    input:
        scene="results/{scene}/design/check/{times}.yaml",
        sources=SOLVER,
    output:
        "results/{scene}/design/check/{times}-{tier}.nc",
    log:
        "logs/{scene}/design/check-{times}-{tier}.log",
    wildcard_constraints:
        tier="steady|dynamic",
    params:
        made_from=made_from(*SOLVER),
    message:
        "{wildcards.scene}: {wildcards.times} times the recommended preload, {wildcards.tier}"
    shell:
        "bearingwear solve {input.scene} -o {output} --fidelity {wildcards.tier} --record-failures > {log} 2>&1"


# Do the dynamic numbers agree with the steady ones that the map is made of?
rule table_check:
    input:
        recommendation="results/{scene}/design/recommendation.nc",
        cases=expand(
            "results/{{scene}}/design/check/{times}-{tier}.nc",
            times=CHECKED,
            tier=("steady", "dynamic"),
        ),
        sources=REPORT,
    output:
        report(
            "results/{scene}/design/tables/check.md",
            caption="../report/design.rst",
            category="{scene}",
            labels={"result": "design, in time"},
        ),
    log:
        "logs/{scene}/design/check.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "{wildcards.scene}: the recommended preload, solved in time"
    shell:
        "bearingwear tables-check {input.recommendation} {input.cases} -o {output} > {log} 2>&1"


rule design:
    input:
        expand(
            "results/{scene}/design/figures/{figure}.{suffix}",
            scene=DESIGN.scenes,
            figure=DESIGN_FIGURES,
            suffix=("svg", "png"),
        ),
        expand(
            "results/{scene}/design/tables/{table}.md",
            scene=DESIGN.scenes,
            table=("design", "check"),
        ),


# Every bearing of a grid: does it fit what the paper states?
rule find_family:
    input:
        scenes=FAMILY_SCENES,
        sources=SOLVER + FAMILY_SOURCES,
    output:
        "results/family/family.nc",
    log:
        "logs/family/family.log",
    params:
        made_from=made_from(*FAMILY_SCENES, *SOLVER, *FAMILY_SOURCES),
        family=DESIGN.family.text(),
        plan=DESIGN_PLAN,
    message:
        "bearings that fit what the paper states"
    shell:
        "bearingwear identify config/scenes --plan {params.plan} -o {output} > {log} 2>&1"


# The ridge they lie on, and how their lives spread.
rule figure_family:
    input:
        family="results/family/family.nc",
        sources=REPORT + FAMILY_SOURCES,
    output:
        svg=report(
            "results/family/figures/family.svg",
            caption="../report/family.rst",
            category="all scenes",
            labels={"result": "family"},
        ),
        png="results/family/figures/family.png",
    log:
        "logs/family/figure.log",
    params:
        made_from=made_from(*REPORT, *FAMILY_SOURCES),
    message:
        "figure of the bearings that fit"
    shell:
        "bearingwear figure family {input.family} -o {output} > {log} 2>&1"


# Each of them, as Markdown.
rule table_family:
    input:
        family="results/family/family.nc",
        sources=REPORT + FAMILY_SOURCES,
    output:
        "results/family/tables/family.md",
    log:
        "logs/family/table.log",
    params:
        made_from=made_from(*REPORT, *FAMILY_SOURCES),
    message:
        "table of the bearings that fit"
    shell:
        "bearingwear tables-family {input.family} -o {output} > {log} 2>&1"


rule identify:
    input:
        "results/family/figures/family.svg",
        "results/family/figures/family.png",
        "results/family/tables/family.md",
