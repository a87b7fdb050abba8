# The report page, for people, and the verdict. `snakemake --report` makes the report of the jobs.


# One HTML page that needs no network: the answer, figures with links to their data, tables, provenance.
rule page:
    """the report page"""
    input:
        sections=[path for study in STUDIES.values() for path in study.page_sections()],
        answers=[path for study in STUDIES.values() for path in study.page_answers()],
        docs=DOCS,
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
        made_from=sources_hash("bearingwear.page.page") + contents_hash(DOCS),
        inputs=lambda wildcards, input: arguments(input),
        settings=shlex.quote(
            json.dumps(
                {
                    "data": {
                        figure: data
                        for study in STUDIES.values()
                        for figure, data in study.behind_figures().items()
                    },
                    "descriptions": described(),
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


# The last lines of a run that made the page: the result, and the path of the page.
def tell_result():
    if PAGE in MADE and os.path.exists(PAGE):
        paths = [path for study in STUDIES.values() for path in study.page_answers()]
        paths = [p for p in paths if p.endswith("answer.json") and os.path.exists(p)]
        found = [load_document(Path(path)) for path in paths]
        for one in found:  # a recommendation, if there is one
            if one.rank == min(answer.rank for answer in found):
                print(one.title, file=sys.stderr)
        # the study of a scene ends with the path of its copy of the page
        if os.environ.get("BEARINGWEAR_STUDY", ".") == ".":
            print(f"page: {PAGE}", file=sys.stderr)


onsuccess:
    tell_result()


onerror:
    tell_result()
