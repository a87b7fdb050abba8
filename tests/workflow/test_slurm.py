"""The study on a cluster: a real Slurm of one node, started here and stopped again.

`make test-slurm`; needs root, the Debian packages slurm-wlm and munge (or others that bring the
same programs), and the extra `slurm`. Skipped with a reason where one is missing; with
REQUIRE_SLURM set, that fails instead.
"""

import importlib.util
import os
import shutil
import signal
import subprocess
import time
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.cluster

CONF = Path("/etc/slurm/slurm.conf")  # job steps look nowhere else
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "sinfo", "scancel")

# four lines of two cases
CONFIG = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": ["constant_force", "fixed_position"],
            "friction": [0.05, 0.08],
            "ball_diameter_loss_um": [0, 0.5],
        }
    ],
    "figures": {"worn_loss_um": 0.5, "friction": [0.08]},
}

# options of Snakemake for the cluster
PROFILE = (
    "--workflow-profile", "workflow/profiles/slurm", "--slurm-no-account",
    "--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks", "10",
)  # fmt: skip

# No accounting, or its client would be waited for for ever; jobs stay known to squeue for an hour.
SETTINGS = """\
ClusterName=bearingwear
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation={root}/state
SlurmdSpoolDir={root}/spool
SlurmctldPidFile={root}/slurmctld.pid
SlurmdPidFile={root}/slurmd.pid
SlurmctldLogFile={root}/slurmctld.log
SlurmdLogFile={root}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0
MinJobAge=3600
KillWait=5
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cores} RealMemory={memory_mb} State=UNKNOWN
PartitionName=local Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def why_not_started() -> str:
    """Returns why no Slurm can be started here; the text is empty if one can."""
    lacking = [name for name in PROGRAMS if not shutil.which(name)]
    if lacking:
        return f"not installed: {', '.join(lacking)}"
    if importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
        return "not installed: snakemake-executor-plugin-slurm (extra slurm)"
    if os.geteuid():
        return "starting Slurm needs root"
    return f"{CONF} is there: this machine has a Slurm of its own" if os.path.lexists(CONF) else ""


def stop(pid_file: Path) -> None:
    """Ends the daemon whose process number is in a file, and waits for that, 10 s at most."""
    with suppress(FileNotFoundError, ProcessLookupError):
        pid = int(pid_file.read_text())
        os.kill(pid, signal.SIGTERM)
        for _ in range(100):
            os.kill(pid, 0)  # an error once it is gone
            time.sleep(0.1)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Starts a cluster of one node that takes jobs, and stops it; yields its folder.

    Where it cannot be started, tests are skipped, or fail if REQUIRE_SLURM is set.
    """
    if reason := why_not_started():
        if os.environ.get("REQUIRE_SLURM"):
            pytest.fail(reason)
        pytest.skip(reason)
    root = tmp_path_factory.mktemp("slurm")
    for name in ("state", "spool"):
        (root / name).mkdir()
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") * 9 // 10 // 2**20
    conf = root / "slurm.conf"
    conf.write_text(SETTINGS.format(root=root, cores=os.cpu_count(), memory_mb=memory))
    with ExitStack() as undo:
        CONF.parent.mkdir(exist_ok=True)
        CONF.symlink_to(conf)
        undo.callback(CONF.unlink)
        munge_pid = Path("/run/munge/munged.pid")
        if not munge_pid.exists():
            call("install", "-d", "-o", "munge", "-g", "munge", "-m", "755", "/run/munge")
            undo.callback(stop, munge_pid)
            call("setpriv", "--reuid=munge", "--regid=munge", "--init-groups",
                 shutil.which("munged"))  # fmt: skip
        undo.callback(stop, root / "slurmctld.pid")
        call("slurmctld", "-c")
        undo.callback(stop, root / "slurmd.pid")
        call("slurmd", "-N", "localhost")
        for _ in range(100):
            if "idle" in call("sinfo", "-h", "-o", "%T"):
                break
            time.sleep(0.2)
        else:
            pytest.fail((root / "slurmctld.log").read_text()[-2000:])
        undo.callback(call, "scancel", "--user", "root")
        yield root


def call(*argv) -> str:
    """Returns what a command prints, which must succeed within a minute."""
    completed = subprocess.run(argv, capture_output=True, text=True, timeout=60)
    assert completed.returncode == 0, f"{argv}: {completed.stderr}"
    return completed.stdout


def queued(form: str) -> list[str]:
    """Returns lines of squeue on all jobs since the cluster started, the newest first.

    form: format of a line, %T state, %l time limit, %C cores, %m memory, %A number.
    """
    return call("squeue", "-h", "-t", "all", "-S", "-i", "-o", form).splitlines()


@pytest.fixture(scope="module")
def study_on_slurm(cluster, new_project):
    """Returns a project whose study was run on the cluster, and that run."""
    project = new_project()
    project.configure(CONFIG)
    return project, project.run(*PROFILE)


def test_a_study_on_slurm_has_the_same_bytes(study_on_slurm, new_project):
    """A study without a cluster has the same results. Afterwards nothing is left to do."""
    project, run = study_on_slurm
    assert run.status == 0, run.text
    assert run.jobs["solve"] == 4 and run.jobs["wear_life"] == 1
    without_cluster = new_project()
    without_cluster.configure(CONFIG)
    assert without_cluster.run().status == 0
    assert project.results() == without_cluster.results()
    assert "Nothing to be done" in project.run("-n").text


def test_the_lines_of_a_study_are_one_job_of_the_cluster_and_its_lives_another(study_on_slurm):
    """The queue has only these two: rules that take about a second run beside Snakemake.

    Four lines of cases run one after the other: their time limit is that of four lines, memory and
    core are those of one. Later tests of this file add jobs to the queue.
    """
    assert [line.split() for line in queued("%T %l %C %m")] == [
        ["COMPLETED", "1:00", "1", "1000M"],  # the lives, the newest first
        ["COMPLETED", "4:00", "1", "1000M"],  # four lines
    ]


def test_a_map_on_slurm_has_the_same_bytes(cluster, new_project):
    """They are those of a map without a cluster. Two parts are one job of twice four minutes."""
    target, contents = "results/gyro_s1/design/design.nc", []
    axes = {"preload_method": ["constant_force", "fixed_position"], "friction": [0.08]}
    axes |= {"shaft_speed_rpm": [30000], "preload_N": [2.0, 4.0, 6.0]}
    for options in (PROFILE, ()):
        project = new_project()
        path = project.root / "config/design.yaml"
        design = yaml.safe_load(path.read_text(encoding="utf-8"))
        design["scenes"] = {"gyro_s1": {"map": axes}}
        path.write_text(yaml.safe_dump(design), encoding="utf-8")
        run = project.run(*options, target)
        assert run.status == 0 and run.jobs["map_part"] == 2, run.text
        contents.append((project.root / target).read_bytes())
    assert contents[0] == contents[1]
    assert queued("%T %l")[0].split() == ["COMPLETED", "8:00"]


def test_the_run_after_a_cancelled_group_of_jobs_solves_all_its_lines_again(study_on_slurm):
    """A run with another preload is cancelled after its first case, and ends with status 1.

    After the next run, no case has its old contents.
    """
    project, _ = study_on_slurm
    project.edit("config/scenes/gyro_s1.yaml", "preload_N: 7", "preload_N: 8")
    before = {path: path.read_bytes() for path in project.cases()}
    run = project.start(*PROFILE)
    try:
        for _ in range(1200):
            with suppress(FileNotFoundError):  # Snakemake removes outdated cases
                contents = {path: path.read_bytes() for path in project.cases()}
                if contents.items() - before.items():
                    break
            time.sleep(0.05)
        else:
            pytest.fail("no new case within a minute")
        call("scancel", queued("%A")[0])
        assert run.wait(120) == 1
    finally:
        run.send_signal(signal.SIGINT)
    next_run = project.run()
    assert next_run.status == 0 and next_run.jobs["solve"] == 4, next_run.text
    after = {path: path.read_bytes() for path in project.cases()}
    assert after.keys() == before.keys() and not after.items() & before.items()
