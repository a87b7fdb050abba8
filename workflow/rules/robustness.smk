# Scenes far outside practical ranges, solved right or refused with a reason: `snakemake -j2 robustness`
# (config/robustness.yaml). `make fuzz` solves more of its random scenes.

from workflow.studies.robustness import plan as robustness_plan

ROBUSTNESS = checked("robustness", robustness_plan.check_robustness)
BASE_SCENE = robustness_plan.base_scene(ROBUSTNESS)


rule random_scenes:
    """How the random scenes of a class end: solved, refused with a reason, or wrong."""
    input:
        plan=ancient("config/robustness.yaml"),
        scene=ancient(BASE_SCENE),
        steady=f"logs/compiled/{KERNELS}/worn",
        dynamic=f"logs/compiled/{KERNELS}/dynamic",
    output:
        "results/robustness/scene_classes/{name}.nc",
    log:
        "logs/random_scenes/{name}.log",
    benchmark:
        "logs/random_scenes/{name}.tsv"
    resources:
        runtime=60,
    params:
        code=sources("workflow.studies.robustness.run"),
        scene=scene_values(str(BASE_SCENE), cage=True),
        scene_class=lambda wildcards: ROBUSTNESS["scene_classes"][wildcards.name],
        draw=lambda wildcards: robustness_plan.draw_blocks(ROBUSTNESS, wildcards.name),
    shell:
        "bearingwear step workflow.studies.robustness.run.random_scenes plan={input.plan}"
        " name={wildcards.name} -o {output} &> {log}"


rule state_map:
    """Steady states over two axes, and the limits along one of them."""
    input:
        plan=ancient("config/robustness.yaml"),
        scene=ancient(BASE_SCENE),
        compiled=f"logs/compiled/{KERNELS}/steady",
    output:
        "results/robustness/maps/{name}.nc",
    log:
        "logs/state_map/{name}.log",
    benchmark:
        "logs/state_map/{name}.tsv"
    resources:
        runtime=20,
    params:
        code=sources("workflow.studies.robustness.maps"),
        scene=scene_values(str(BASE_SCENE)),
        state_map=lambda wildcards: ROBUSTNESS["maps"][wildcards.name],
        limits=lambda wildcards: robustness_plan.limit_values(
            ROBUSTNESS, wildcards.name
        ),
    shell:
        "bearingwear step workflow.studies.robustness.maps.state_map plan={input.plan}"
        " name={wildcards.name} -o {output} &> {log}"


rule branch:
    """Steady states followed along an axis in both directions, and found anew at each point."""
    input:
        plan=ancient("config/robustness.yaml"),
        scene=ancient(BASE_SCENE),
        compiled=f"logs/compiled/{KERNELS}/steady",
    output:
        "results/robustness/branches/{name}.nc",
    log:
        "logs/branch/{name}.log",
    benchmark:
        "logs/branch/{name}.tsv"
    resources:
        runtime=10,
    params:
        code=sources("workflow.studies.robustness.branches"),
        scene=scene_values(str(BASE_SCENE)),
        branch=lambda wildcards: ROBUSTNESS["branches"][wildcards.name],
    shell:
        "bearingwear step workflow.studies.robustness.branches.branch_states plan={input.plan}"
        " name={wildcards.name} -o {output} &> {log}"


rule count_ends:
    """How many random scenes and points of maps were solved, refused, unexplained or wrong."""
    input:
        expand(
            "results/robustness/scene_classes/{name}.nc",
            name=ROBUSTNESS["scene_classes"],
        ),
        expand("results/robustness/maps/{name}.nc", name=ROBUSTNESS["maps"]),
    output:
        "results/robustness/robustness.nc",
    log:
        "logs/count_ends.log",
    localrule: True
    params:
        code=sources("workflow.studies.robustness.gather"),
    shell:
        "bearingwear step workflow.studies.robustness.gather.counted_ends paths={input}"
        " -o {output} &> {log}"


rule state_map_figure:
    """A map of steady states with its limits and their closed forms."""
    input:
        "results/robustness/maps/{name}.nc",
    output:
        report(
            "results/robustness/figures/maps-{name}.svg",
            caption="../report/robustness.rst",
            category="robustness",
            labels={"result": "map, {name}"},
        ),
        "results/robustness/figures/maps-{name}.png",
    log:
        "logs/state_map_figure/{name}.log",
    localrule: True
    params:
        code=sources("workflow.studies.robustness.figures"),
    shell:
        "bearingwear step workflow.studies.robustness.figures.map_figure solved={input}"
        " -o {output} &> {log}"


rule branch_figure:
    """Branches of steady states that were followed in both directions."""
    input:
        "results/robustness/branches/{name}.nc",
    output:
        report(
            "results/robustness/figures/branches-{name}.svg",
            caption="../report/robustness.rst",
            category="robustness",
            labels={"result": "branches, {name}"},
        ),
        "results/robustness/figures/branches-{name}.png",
    log:
        "logs/branch_figure/{name}.log",
    localrule: True
    params:
        code=sources("workflow.studies.robustness.figures"),
    shell:
        "bearingwear step workflow.studies.robustness.figures.branches_figure solved={input}"
        " -o {output} &> {log}"


rule ends_table:
    """How the scenes of the study ended, a row for each class and map."""
    input:
        "results/robustness/robustness.nc",
    output:
        report(
            "results/robustness/tables/robustness.md",
            caption="../report/robustness.rst",
            category="robustness",
            labels={"result": "table, to download"},
        ),
    log:
        "logs/ends_table.log",
    localrule: True
    params:
        code=sources("workflow.studies.robustness.tables"),
    shell:
        "bearingwear step workflow.studies.robustness.tables.ends_table counts={input}"
        " -o {output} &> {log}"


ROBUSTNESS_SHOWN = [
    *expand("results/robustness/figures/maps-{name}.svg", name=ROBUSTNESS["maps"]),
    *expand(
        "results/robustness/figures/branches-{name}.svg", name=ROBUSTNESS["branches"]
    ),
    "results/robustness/tables/robustness.md",
]


rule wrong_answers:
    """Fails, after all figures and the table, if a result that was verified is wrong."""
    input:
        counts="results/robustness/robustness.nc",
        shown=ROBUSTNESS_SHOWN,
    output:
        "results/robustness/verdict.txt",
    log:
        "logs/wrong_answers.log",
    localrule: True
    params:
        code=sources("workflow.studies.robustness.tables"),
    shell:
        "bearingwear step workflow.studies.robustness.tables.wrong_answers counts={input.counts}"
        " -o {output} &> {log}"


rule robustness:
    """The study of robustness: random scenes, maps and branches (config/robustness.yaml)."""
    input:
        ROBUSTNESS_SHOWN,
        "results/robustness/verdict.txt",
    localrule: True
