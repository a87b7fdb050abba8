# Cases: the bearings of config/config.yaml over preload method, friction and wear, steady and dynamic.


rule compile:
    """Compile the kernels of a model once, before many jobs need them."""
    output:
        f"logs/compiled/{KERNELS}/{{model}}",
    log:
        "logs/compile/{model}.log",
    wildcard_constraints:
        model="steady|worn|dynamic",
    localrule: True
    params:
        kernels=kernels_hash(),
    shell:
        "bearingwear compile {wildcards.model} &> {log} && touch {output}"


rule solve:
    """Cases of one preload method and friction coefficient, in all states of wear."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/steady",
    output:
        expand("results/{{scene}}/cases/{{method}}-mu{{mu}}-loss{loss}.nc", loss=LOSSES),
    log:
        "logs/solve/{scene}/{method}-mu{mu}.log",
    benchmark:
        "logs/solve/{scene}/{method}-mu{mu}.tsv"
    group:
        "solve"
    resources:
        runtime=1,
    params:
        code=sources("bearingwear.solvers.solve"),
        scene=scene_values(replaced=GRID_KEYS.values()),
        losses=",".join(LOSSES),
    shell:
        "bearingwear solve {input.scene} --set operation.preload_method={wildcards.method}"
        " friction.ball_race={wildcards.mu} --each wear.ball_diameter_loss_um={params.losses}"
        " --record-failures --quiet -o {output} &> {log}"


rule solve_chunk:
    """Cases of many lines of a large grid in one file, without profiles across the contacts."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/steady",
    output:
        "results/{scene}/chunks/{method}-mu{first}-to-mu{last}.nc",
    log:
        "logs/solve_chunk/{scene}/{method}-mu{first}-to-mu{last}.log",
    benchmark:
        "logs/solve_chunk/{scene}/{method}-mu{first}-to-mu{last}.tsv"
    resources:
        runtime=60,
    params:
        code=sources("bearingwear.studies.sweep"),
        scene=scene_values(replaced=GRID_KEYS.values()),
        friction=lambda wildcards: ",".join(
            GRIDS[wildcards.scene].friction_names_between(
                wildcards.first, wildcards.last
            )
        ),
        losses=lambda wildcards: ",".join(GRIDS[wildcards.scene].loss_names),
    shell:
        "bearingwear sweep {input.scene} --set operation.preload_method={wildcards.method}"
        " --axis friction.ball_race={params.friction}"
        " --axis wear.ball_diameter_loss_um={params.losses}"
        " --keep study --jobs 1 --record-failures -o {output} &> {log}"


rule gather:
    """The cases of a scene as one file over preload method, friction and wear."""
    input:
        solved_cases,
    output:
        "results/{scene}/study.nc",
    log:
        "logs/gather/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.gather"),
    shell:
        "bearingwear gather {input} -o {output} &> {log}"


rule solve_dynamic:
    """A case solved dynamically: every ball, the races and the cage, integrated over time."""
    input:
        scene=ancient("config/scenes/{scene}.yaml"),
        compiled=f"logs/compiled/{KERNELS}/dynamic",
    output:
        "results/{scene}/dynamic/{method}-mu{mu}-loss{loss}.nc",
    log:
        "logs/solve_dynamic/{scene}/{method}-mu{mu}-loss{loss}.log",
    benchmark:
        "logs/solve_dynamic/{scene}/{method}-mu{mu}-loss{loss}.tsv"
    priority: 1
    group:
        "solve_dynamic"
    resources:
        runtime=1,
    params:
        code=sources("bearingwear.solvers.solve"),
        scene=scene_values(replaced=GRID_KEYS.values(), cage=True),
        model=lambda wildcards: settings(
            configuration.dynamic_model(config, wildcards.scene)
        ),
    shell:
        "bearingwear solve {input.scene} --fidelity dynamic {params.model}"
        " --set operation.preload_method={wildcards.method} friction.ball_race={wildcards.mu}"
        " wear.ball_diameter_loss_um={wildcards.loss} --record-failures --quiet -o {output} &> {log}"


rule gather_dynamic:
    """The cases of a scene that were solved dynamically, as one file."""
    input:
        dynamic_cases,
    output:
        "results/{scene}/dynamic.nc",
    log:
        "logs/gather_dynamic/{scene}.log",
    localrule: True
    params:
        code=sources("bearingwear.studies.grid.gather"),
    shell:
        "bearingwear gather {input} -o {output} &> {log}"
