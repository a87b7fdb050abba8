# The page of everything, for people. `snakemake --report` makes the one for provenance.


localrules:
    page,


# One self-contained HTML page: the answer, figures, tables, verification, provenance.
rule page:
    input:
        studies=PLAN.studies(),
        lives=PLAN.lives(),
        dynamics=PLAN.dynamics(),
        tables=[table for table in PLAN.tables() if table.endswith(".md")],
        figures=PLAN.figures(),
        docs=PAGE_DOCS,
        spreads=PLAN.spreads_of_lives(),
        design=design_results,
        sources=REPORT + PAGE_SOURCES,
    output:
        report(
            "results/report/index.html",
            caption="../report/page.rst",
            category="the page of everything",
            labels={"result": "page"},
        ),
    log:
        "logs/page.log",
    params:
        made_from=made_from(*REPORT, *PAGE_SOURCES, *PAGE_DOCS),
    message:
        "the page of everything"
    shell:
        "bearingwear report {input.studies} {input.lives} {input.dynamics} {input.tables} {input.figures}"
        " --docs {input.docs} --design {input.spreads} {input.design} -o {output} > {log} 2>&1"
