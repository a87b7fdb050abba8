# `snakemake -j2 NAME` runs the study NAME, whether or not it is a part of rule all.

for study in STUDIES.values():

    rule:
        name:
            study.name
        input:
            study.targets(),
        localrule: True
        message:
            f"the study {study.name}"

    about(study.name, f"the study {study.name}")
