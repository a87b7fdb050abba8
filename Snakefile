# The whole study: `snakemake -j2`; another one: `snakemake -j2 NAME`. Each rule calls `bearingwear`.

from snakemake.utils import min_version

min_version("9.0")


# a configuration is whole: one that is given takes the place of the project's
if not workflow.overwrite_configfiles:

    configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/jobs.smk"
include: "workflow/rules/page.smk"
include: "workflow/rules/studies.smk"


rule all:
    """the main study: what a plain `snakemake` makes"""
    default_target: True
    input:
        rules.verdict.input,
        rules.verdict.output,
    message:
        "the main study"
