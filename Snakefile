# The whole study: `snakemake -j2`. Each rule calls one `bearingwear` command.

from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/cases.smk"
include: "workflow/rules/study.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/lives.smk"
include: "workflow/rules/tradeoff.smk"
include: "workflow/rules/design.smk"
include: "workflow/rules/extremes.smk"


rule all:
    default_target: True
    input:
        rules.verdict.input,
        rules.verdict.output,
