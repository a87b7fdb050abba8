# One rule for each step of each study, made from what the study says of it.


for study in STUDIES.values():
    for step in study.steps:

        rule:
            name:
                f"{study.name}_{step.name}"
            input:
                unpack(files_of(step)),
                after=step.after,
            output:
                *outputs_of(step),
            log:
                log_of(study, step),
            wildcard_constraints:
                **step.matches,
            priority: step.priority
            localrule: not step.seconds
            threads: (workflow.resource_settings.cores or 1) if step.alone else 1
            params:
                made_from=made_from(step),
                inputs=arguments_of(step),
                settings=settings_of(step),
                step=step.run,
                label=label_of(step),
            message:
                "{params.label}"
            shell:
                "bearingwear step {params.step} {params.inputs} --settings {params.settings:q} -o {output} > {log} 2>&1"
