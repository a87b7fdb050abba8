# One job for each point of the grid.


# A case that cannot be solved is recorded in its file; rule verdict makes the run fail at its end.
rule solve:
    input:
        scene="config/scenes/{scene}.yaml",
        sources=SOLVER,
    output:
        "results/{scene}/cases/{case}.nc",
    log:
        "logs/{scene}/cases/{case}.log",
    benchmark:
        "logs/{scene}/cases/{case}.tsv"
    params:
        settings=case_settings,
        label=case_label,
    message:
        "{params.label}"
    shell:
        "bearingwear solve {input.scene} -o {output} {params.settings} --record-failures > {log} 2>&1"
