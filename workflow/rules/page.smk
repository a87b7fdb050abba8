# The report page, for people, and the verdict. `snakemake --report` makes the report of the jobs.


# One HTML page that needs no network: the answer, figures with links to their data, tables, provenance.
rule page:
    """the report page"""
    input:
        sections=[path for study in STUDIES.values() for path in study.page_sections()],
        answers=[path for study in STUDIES.values() for path in study.page_answers()],
        docs=DOCS,
        scenes=[ancient(path) for path in scene_sources()],
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
        made_from=sources_hash("bearingwear.page.page")
        + contents_hash(DOCS)
        + scene_notes(scene_sources()),
        inputs=lambda wildcards, input: arguments(input),
        settings=shlex.quote(
            json.dumps(
                {
                    "data": {
                        figure: data
                        for study in STUDIES.values()
                        for figure, data in study.behind_figures().items()
                    },
                }
            )
        ),
    message:
        "the report page"
    shell:
        "bearingwear step page.page.page {params.inputs} --settings {params.settings} -o {output} > {log} 2>&1"


# Comes last and fails, each time anew, if a case or a life could not be solved; or warns.
rule verdict:
    """check that every case was solved"""
    input:
        judged=[path for study in STUDIES.values() for path in study.judged()],
        rest=[path for study in STUDIES.values() for path in study.default_targets()],
        page=PAGE,
    output:
        VERDICT,
    log:
        "logs/verdict.log",
    localrule: True
    params:
        inputs=lambda wildcards, input: arguments({"paths": input.judged}),
        settings=shlex.quote(
            json.dumps({"unsolved_is": config.get("unsolved", "error")})
        ),
    message:
        "check that every case was solved"
    shell:
        "bearingwear step studies.unsolved.verdict_text {params.inputs} --settings {params.settings} -o {output} 2>&1 | tee {log}"


onsuccess:
    tell_result()


onerror:
    tell_result()
