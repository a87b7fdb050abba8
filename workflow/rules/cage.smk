# Which motions a cage takes and what they wear, a map of cages: `snakemake -j2 cage` (config/cage.yaml).

from bearingwear.applications.cage import plan as cage_plan

CAGE = checked("cage", cage_plan.check_cage)
CAGE_SCENE = f"config/scenes/{CAGE.get('scene')}.yaml"
CAGES = cage_plan.cage_points(CAGE)
CAGE_KEYS = {key for point in CAGES.values() for key in point.changes}


rule cage_ensemble:
    """Runs of one cage of the map: which motions it takes, how often, and their work."""
    input:
        scene=ancient(CAGE_SCENE),
        compiled=f"logs/compiled/{KERNELS}/dynamic",
    output:
        "results/cage/points/{cage}.nc",
    log:
        "logs/cage_ensemble/{cage}.log",
    benchmark:
        "logs/cage_ensemble/{cage}.tsv"
    resources:
        runtime=30,
    params:
        code=sources("bearingwear.applications.cage.life"),
        scene=scene_values(CAGE_SCENE, replaced=CAGE_KEYS, cage=True, uncertainty=True),
        changes=lambda wildcards: settings(
            {**CAGE["set"], **CAGES[wildcards.cage].changes}
        ),
        runs=CAGE["ensemble"],
    shell:
        "bearingwear cage {input.scene} {params.changes} --runs {params.runs[runs]}"
        " --within {params.runs[within]} --seed {params.runs[seed]}"
        " --least-turns {params.runs[least_turns]} --turns {params.runs[most_turns]}"
        " --jobs {threads} --record-failures --quiet -o {output} &> {log}"


rule gather_cages:
    """The ensembles of all cages, over the axes of the map."""
    input:
        scene=ancient(CAGE_SCENE),
        paths=expand("results/cage/points/{cage}.nc", cage=CAGES),
    output:
        "results/cage/cage.nc",
    log:
        "logs/gather_cages.log",
    localrule: True
    params:
        code=sources("bearingwear.applications.cage.gather"),
        scene=scene_values(CAGE_SCENE, cage=True, uncertainty=True),
        axes=lambda wildcards: cage_plan.cage_axes(CAGE),
        changes=CAGE["set"],
    shell:
        "bearingwear step bearingwear.applications.cage.gather.gathered_ensembles scene={input.scene}"
        " paths={input.paths} axes={params.axes:q} changes={params.changes:q} -o {output} &> {log}"


rule cage_answer:
    """Which cage to take and which cages are quiet, for the report page."""
    input:
        "results/cage/cage.nc",
    output:
        "results/cage/answer.json",
    log:
        "logs/cage_answer.log",
    localrule: True
    params:
        code=sources("bearingwear.applications.cage.tables"),
    shell:
        "bearingwear step bearingwear.applications.cage.tables.cage_answer motions={input}"
        " -o {output} &> {log}"


rule cage_figure:
    """Motions of each cage of the map, and the work of each in a turn of the shaft."""
    input:
        "results/cage/cage.nc",
    output:
        report(
            "results/cage/figures/cage.svg",
            caption="../report/cage.rst",
            category="cage",
            labels={"result": "motions of the cages"},
        ),
        "results/cage/figures/cage.png",
    log:
        "logs/cage_figure.log",
    localrule: True
    params:
        code=sources("bearingwear.applications.cage.figures"),
    shell:
        "bearingwear step bearingwear.applications.cage.figures.cage_figure motions={input}"
        " -o {output} &> {log}"


rule cage_table:
    """Every cage of the map with its motions, its work and its wear."""
    input:
        "results/cage/cage.nc",
    output:
        report(
            "results/cage/tables/cage.md",
            caption="../report/cage.rst",
            category="cage",
            labels={"result": "table, to download"},
        ),
    log:
        "logs/cage_table.log",
    localrule: True
    params:
        code=sources("bearingwear.applications.cage.tables"),
    shell:
        "bearingwear step bearingwear.applications.cage.tables.cage_table motions={input}"
        " -o {output} &> {log}"


# What the page says of cages: the answer, and the figure beside it.
CAGE_ANSWER = [
    "results/cage/answer.json",
    "results/cage/figures/cage.svg",
    "results/cage/figures/cage.png",
]
CAGE_SHOWN = [*CAGE_ANSWER, "results/cage/tables/cage.md"]


rule cage:
    """The study of cages: a map of their motions (config/cage.yaml)."""
    input:
        CAGE_SHOWN,
    localrule: True
