"""The study by a batch system that has only a command to submit a job: here, one that runs it.

`make test-slurm`; skipped where the plugin cluster-generic (extra slurm) is missing.
"""

import pytest

pytestmark = pytest.mark.cluster

# a batch system that runs each job at once
SUBMIT = """\
#!/bin/sh
# arguments: memory in MB, minutes, script of the job; prints the identifier of the job
echo "$1 $2" >> submitted.txt
nohup sh "$3" > job.txt 2>&1 &
echo $!
"""


@pytest.fixture(scope="module")
def plugin():
    """Skips the tests where the plugin is missing."""
    return pytest.importorskip("snakemake_executor_plugin_cluster_generic")


def test_a_study_by_a_submit_command_has_the_same_bytes(plugin, new_project, first_run):
    """They are those of a study without a cluster. It is one job; then nothing is left to do."""
    project, target = new_project(), "results/gyro_s1/study.nc"
    script = project.root / "submit.sh"
    script.write_text(SUBMIT, encoding="utf-8")
    script.chmod(0o755)
    run = project.run(
        "--workflow-profile", "workflow/profiles/slurm", "--executor", "cluster-generic",
        "--cluster-generic-submit-cmd", "./submit.sh {resources.mem_mb} {resources.runtime}",
        target,
    )  # fmt: skip
    assert run.status == 0, run.text
    assert run.jobs["solve"] == 4
    # a single job, with the memory [MB] of one line and the minutes of four
    assert (project.root / "submitted.txt").read_text(encoding="utf-8") == "1000 4\n"
    assert (project.root / target).read_bytes() == (first_run[0].root / target).read_bytes()
    assert "Nothing to be done" in project.run("-n", target).text
