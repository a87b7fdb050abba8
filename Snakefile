# The whole study: `snakemake -j2`; another one: `snakemake -j2 NAME`. Each rule calls `bearingwear`.

from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/jobs.smk"
include: "workflow/rules/page.smk"
include: "workflow/rules/studies.smk"


rule all:
    default_target: True
    input:
        rules.verdict.input,
        rules.verdict.output,
