# One rule for each step of each study, and for each bundle of steps, made from what the study says.


for study in STUDIES.values():
    for job in study.jobs:

        rule:
            name:
                f"{study.name}_{job.name}"
            input:
                inputs_of(job),
                after=job.after,
            output:
                *outputs_of(job),
            log:
                beside_log(study.name, job.name, job.outputs[0], ".log"),
            benchmark:
                beside_log(study.name, job.name, job.outputs[0], ".tsv")
            wildcard_constraints:
                **job.matches,
            priority: job.priority
            localrule: not job.work
            threads: (workflow.resource_settings.cores or 1) if job.alone else 1
            resources:
                compiler=int(bool(job.kernel) and not is_compiled(job.kernel)),
            params:
                made_from=made_from(job),
                calls=calls_of(job),
                label=label_of(job),
                to_log="|& tee >&2" if job.tells else "&>",
            message:
                "{params.label}"
            shell:
                "bearingwear step --workers {threads} {params.calls} {params.to_log} {log}"

        about(f"{study.name}_{job.name}", job.about or job.label)
