# One job for each point of the grids.


# A case that cannot be solved is recorded in its file; rule verdict makes the run fail at its end.
rule solve:
    input:
        scene=SCENE,
        sources=SOLVER,
    output:
        "results/{scene}/cases/{case}.nc",
    log:
        "logs/{scene}/cases/{case}.log",
    benchmark:
        "logs/{scene}/cases/{case}.tsv"
    params:
        made_from=made_from(SCENE, *SOLVER),
        settings=case_settings,
        label=case_label,
    message:
        "{params.label}"
    shell:
        "bearingwear solve {input.scene} -o {output} {params.settings} --record-failures > {log} 2>&1"


# As solve, in time and with the cage. The longest jobs come first.
rule solve_dynamic:
    input:
        scene=SCENE,
        sources=SOLVER,
    output:
        "results/{scene}/dynamic/{case}.nc",
    log:
        "logs/{scene}/dynamic/{case}.log",
    benchmark:
        "logs/{scene}/dynamic/{case}.tsv"
    priority: 1
    params:
        made_from=made_from(SCENE, *SOLVER),
        settings=dynamic_settings,
        label=dynamic_label,
    message:
        "{params.label}"
    shell:
        "bearingwear solve {input.scene} -o {output} {params.settings} --fidelity dynamic --record-failures > {log} 2>&1"
