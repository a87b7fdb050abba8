# Figures of one scene, numbered as in the paper they correspond to, and figures across scenes.


localrules:
    figure_friction,
    figure_slip,
    figure_wear,
    figure_life,
    figure_dynamic,
    figure_running_average,
    figure_wear_columns,
    figure_spread,


# QV and contact load against friction, fresh or worn.
rule figure_friction:
    input:
        study="results/{scene}/study.nc",
        sources=REPORT,
    output:
        svg=report(
            "results/{scene}/figures/{figure}.svg",
            caption="../report/friction.rst",
            category="{scene}",
            labels={"result": "{figure}"},
        ),
        png="results/{scene}/figures/{figure}.png",
    log:
        "logs/{scene}/{figure}.log",
    wildcard_constraints:
        figure="fig07_fresh|fig08_worn",
    params:
        made_from=made_from(*REPORT),
        loss_um=loss_of_figure,
    message:
        "{wildcards.scene}: QV and load against friction at {params.loss_um} um"
    shell:
        "bearingwear figure friction {input.study} --loss-um {params.loss_um} -o {output} > {log} 2>&1"


# Slip over the contact ellipse.
rule figure_slip:
    input:
        cases=slip_cases,
        sources=REPORT,
    output:
        svg=report(
            "results/{scene}/figures/fig09_slip.svg",
            caption="../report/slip.rst",
            category="{scene}",
            labels={"result": "fig09_slip"},
        ),
        png="results/{scene}/figures/fig09_slip.png",
    log:
        "logs/{scene}/fig09_slip.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "{wildcards.scene}: slip over the contact ellipse"
    shell:
        "bearingwear figure slip {input.cases} -o {output} > {log} 2>&1"


# QV, residual preload, contact angles and wear rate against wear.
rule figure_wear:
    input:
        study="results/{scene}/study.nc",
        sources=REPORT,
    output:
        svg=report(
            "results/{scene}/figures/fig10_wear.svg",
            caption="../report/wear.rst",
            category="{scene}",
            labels={"result": "fig10_wear"},
        ),
        png="results/{scene}/figures/fig10_wear.png",
    log:
        "logs/{scene}/fig10_wear.log",
    params:
        made_from=made_from(*REPORT),
        friction=scene_frictions,
    message:
        "{wildcards.scene}: QV, preload, angles and wear rate against wear"
    shell:
        "bearingwear figure wear {input.study} --friction {params.friction} -o {output} > {log} 2>&1"


# Wear and residual preload in hours, up to the end of life.
rule figure_life:
    input:
        life="results/{scene}/wear_life.nc",
        spread=known_spread,
        sources=REPORT,
    output:
        svg=report(
            "results/{scene}/figures/wear_life.svg",
            caption="../report/life.rst",
            category="{scene}",
            labels={"result": "wear_life"},
        ),
        png="results/{scene}/figures/wear_life.png",
    log:
        "logs/{scene}/wear_life_figure.log",
    params:
        made_from=made_from(*REPORT),
        friction=scene_frictions,
        spread=spread_option,
    message:
        "{wildcards.scene}: wear and preload over the life"
    shell:
        "bearingwear figure life {input.life} --friction {params.friction} {params.spread} -o {output} > {log} 2>&1"


# QV and wear rates of cases solved in time, beside the steady ones.
rule figure_dynamic:
    input:
        study="results/{scene}/study.nc",
        dynamic="results/{scene}/dynamic.nc",
        sources=REPORT,
    output:
        svg=report(
            "results/{scene}/figures/dynamic.svg",
            caption="../report/dynamic.rst",
            category="{scene}",
            labels={"result": "dynamic"},
        ),
        png="results/{scene}/figures/dynamic.png",
    log:
        "logs/{scene}/dynamic_figure.log",
    params:
        made_from=made_from(*REPORT),
    message:
        "{wildcards.scene}: solved in time, beside the steady state"
    shell:
        "bearingwear figure dynamic {input.study} {input.dynamic} -o {output} > {log} 2>&1"


# Wear rates of ball 1 and of the cage as their means settle; of any case solved in time.
rule figure_running_average:
    input:
        case="results/{scene}/dynamic/{case}.nc",
        reference=reference_values,
        sources=REPORT,
    output:
        svg=report(
            "results/{scene}/figures/fig06_running_average-{case}.svg",
            caption="../report/running_average.rst",
            category="{scene}",
            labels={"result": "fig06_running_average, {case}"},
        ),
        png="results/{scene}/figures/fig06_running_average-{case}.png",
    log:
        "logs/{scene}/fig06_running_average-{case}.log",
    params:
        made_from=made_from(reference_values, *REPORT),
        reference=reference_option,
    message:
        "{wildcards.scene}: wear rates of ball 1 and of the cage as they settle"
    shell:
        "bearingwear figure running-average {input.case} {params.reference} -o {output} > {log} 2>&1"


# As figure_wear, with columns from different scenes.
rule figure_wear_columns:
    input:
        studies=PLAN.studies(*PLAN.column_scenes),
        sources=REPORT,
    output:
        svg=report(
            "results/figures/fig10_wear.svg",
            caption="../report/wear.rst",
            category="across scenes",
            labels={"result": "fig10_wear"},
        ),
        png="results/figures/fig10_wear.png",
    log:
        "logs/figures/fig10_wear.log",
    params:
        made_from=made_from(*REPORT),
        friction=PLAN.column_frictions,
    message:
        "QV, preload, angles and wear rate against wear, across scenes"
    shell:
        "bearingwear figure wear {input.studies} --friction {params.friction} -o {output} > {log} 2>&1"


# Several scenes over each other.
rule figure_spread:
    input:
        studies=spread_studies,
        sources=REPORT,
    output:
        svg=report(
            "results/figures/spread_{spread}.svg",
            caption="../report/spread.rst",
            category="across scenes",
            labels={"result": "spread_{spread}"},
        ),
        png="results/figures/spread_{spread}.png",
    log:
        "logs/figures/spread_{spread}.log",
    params:
        made_from=made_from(*REPORT),
        friction=spread_friction,
    message:
        "spread over {wildcards.spread}"
    shell:
        "bearingwear figure spread {input.studies} --friction {params.friction} -o {output} > {log} 2>&1"
