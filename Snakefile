# The whole study: `snakemake -j2`; another one: `snakemake -j2 NAME`, as `snakemake --list` names them.

from snakemake.utils import min_version

min_version("9.0")


configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/inputs.smk"
include: "workflow/rules/solve.smk"
include: "workflow/rules/lives.smk"
include: "workflow/rules/preload.smk"
include: "workflow/rules/uncertainty.smk"
include: "workflow/rules/cage.smk"
include: "workflow/rules/report.smk"


# Studies of the program itself, which need the repository.
if (Path(workflow.basedir) / "workflow/studies").is_dir():

    include: "workflow/rules/accuracy.smk"
    include: "workflow/rules/robustness.smk"


rule all:
    """The main study: cases, lives, recommended preload, report page; fails if a case was not solved."""
    default_target: True
    input:
        "results/verdict.txt",
        every_case,  # a deleted one is solved again
        CAGE_SHOWN if CAGE["in_main_study"] else [],
    localrule: True
