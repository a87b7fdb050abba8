# Checks the configurations and every scene before anything runs, and asks the studies for the rules.

import difflib
import functools
import json
import logging
import os
import shlex
import sys
from pathlib import Path

from snakemake.io import report as in_report
from snakemake.logging import logger

from bearingwear import studies
from bearingwear.cli import FULL_DISK
from bearingwear.provenance import (
    contents_hash,
    other_copy,
    result_hash,
    sources_hash,
    text_hash,
)
from bearingwear.document.document import load_document
from bearingwear.kernels.build.folder import is_compiled
from bearingwear.process import set_environment
from bearingwear.scene.assumed import assumed_keys
from bearingwear.scene.checking.errors import leaves
from bearingwear.scene.read import as_data
from bearingwear.studies import fork_server
from bearingwear.studies.command_pipe import end_with_command
from bearingwear.studies.protocol import flat_files
from bearingwear.studies.progress import JobLines
from bearingwear.studies.seconds import beside_log
from bearingwear.studies.repair import off_grid, survey

BAD_INPUT = 2

set_environment()  # for all jobs
# libraries first: the project may hold a user's `signal.py`
sys.path.sort(key=lambda path: path == workflow.basedir)


def refuse(reason):
    """Stop with one line and no traceback."""
    print(reason, file=sys.stderr)
    sys.exit(BAD_INPUT)


# A study and the command `bearingwear` are of the same sources.
if workflow.is_main_process and (other := other_copy()):
    refuse(
        f"{other}: got an installed copy that differs from the sources of this workflow; "
        "expected the same ones: run `make venv` or `pip install -c constraints.txt -e .`"
    )

# What is wrong stops here.
try:
    STUDIES = studies.read(config)
    if workflow.is_main_process:  # not again in each job: it takes a millisecond a case
        for study in STUDIES.values():
            study.check()
except ValueError as error:
    refuse(error)

PAGE, VERDICT = "results/report/index.html", "results/verdict.txt"
DOCS = list(filter(os.path.isfile, ["docs/verification.md", "docs/accuracy.md"]))

# a file that is asked for and is none of the plan: Snakemake would say only that no rule makes it
for target in sys.argv[1:] if workflow.is_main_process else ():
    for study in STUDIES.values():
        if reason := study.refused(target):
            refuse(reason)
    if target.startswith("results/") and target.endswith(
        (".nc", ".svg", ".png", ".md")
    ):
        jobs = [job for study in STUDIES.values() for job in study.jobs]
        made = {path for job in jobs for path in job.made()}
        near = difflib.get_close_matches(target, made, n=1)
        meant = (
            f"did you mean {near[0]}"
            if near
            else "expected one that `snakemake -n` lists"
        )
        if target not in made:
            refuse(f"{target}: got a file that belongs to no study; {meant}")

# While one job compiles the largest kernel, those that need it wait: one core is for the others.
if workflow.resource_settings.nodes is None:
    cores = workflow.resource_settings.cores or 1
    workflow.register_resource("compiler", max(1, cores - 1))

# Jobs on a cluster read this file as well, while results come and go.
if workflow.is_main_process:
    try:
        for line in survey([*studies.files(STUDIES), PAGE, VERDICT, *DOCS]):
            print(line, file=sys.stderr)
        if not workflow.output_settings.dryrun:
            for line in off_grid(STUDIES.values()):
                print(line, file=sys.stderr)
    except OSError as error:
        sys.exit(f"{error.filename}: cannot be set aside or dated ({error.strerror})")

# The command of this very environment, whether or not it is activated.
client = shlex.join([sys.executable, "-I", "-S", fork_server.__file__])
# A prefix takes the place of Snakemake's own, without which a pipe to `tee` hides a failure.
# A job that ends without a word, or that cannot write one, says so all the same: in its log, else on
# the terminal (9).
shell.prefix(f"""set -euo pipefail; exec 9>&2;
    bearingwear() ( {client} "$@" || silent $? );
    silent() (
        if [ $1 = {FULL_DISK} ]; then
            echo "a job cannot write its log: No space left on device" >&9
        elif [ -f /dev/stderr ] && [ ! -s /dev/stderr ]; then
            said="ended with status $1 without a message" # of a signal the shell says which
            echo "$said" >&2 || echo "a job $said" >&9
        fi
        exit $1
    ); """)

# On a full disk, not a traceback for each line of Snakemake's own log.
logging.raiseExceptions = False

if workflow.is_main_process:
    end_with_command()


MADE = set()  # what this run is about to make
VERBOSE = {"--verbose", "-p", "--printshellcmds"}
LINES = None
if workflow.is_main_process and not VERBOSE & {*sys.argv}:
    for terminal in logger.handlers:
        if terminal.name != "DefaultStreamHandler":
            continue
        if not workflow.output_settings.dryrun:
            LINES = JobLines(terminal)
        else:  # which prints its table of jobs twice
            known = set()
            terminal.addFilter(lambda record: record.msg not in known)
            terminal.addFilter(lambda record: known.add(record.msg) or True)


onstart:
    MADE.update(path for job in workflow.dag.needrun_jobs() for path in job.output)
    tasks = {
        f"{name}_{job.name}": job
        for name, study in STUDIES.items()
        for job in study.jobs
    }
    todo = {
        job.jobid: tasks.get(job.rule.name) for job in workflow.dag.needrun_jobs()
    }
    if workflow.local_exec:
        modules = {
            step.module
            for task in filter(None, todo.values())
            for step in task.steps
        }
        fork_server.started(sorted(modules))
    if LINES:
        LINES.begin(todo)
    # A group of jobs that a cluster ends early is recorded as if each of them had ended, and an
    # outdated result of one that never began would then pass for new. A local run has no groups.
    if not (workflow.local_exec or workflow.touch):
        for job in filter(workflow.dag.get_job_group, workflow.dag.needrun_jobs()):
            for path in filter(os.path.lexists, job.output):
                os.remove(path)


ONES = {}


def one(job, wildcards):
    """The job of these wildcards; the parts of its rule ask for it one after the other."""
    key = (id(job), *wildcards)
    if key not in ONES:
        ONES[key] = job.one(dict(wildcards.items()))
    return ONES[key]


def files_of(job):
    return lambda wildcards: [
        path for step in one(job, wildcards).steps for path in flat_files(step.inputs)
    ]


# Where Snakemake knows what a result was made from, only what a scene says counts (`made_from`), not
# its date nor its comments. Results that were brought along without that are judged by the date.
KNOWN = os.path.isdir(".snakemake/metadata")


def inputs_of(job):
    return lambda wildcards: [
        ancient(path) if KNOWN and is_scene(path) else path
        for path in files_of(job)(wildcards)
    ]


def is_scene(path):
    return path.startswith("config/scenes/")


def outputs_of(job):
    """Paths of a job; those a person reads stand in the report of the jobs."""
    return [path for step in job.steps for path in shown(step)]


def shown(step):
    if not step.caption:
        return step.outputs
    about = {".svg": step.result, ".md": f"{step.result}, to download"}
    return [
        (
            in_report(
                path,
                caption=f"../report/{step.caption}.rst",
                category=step.category,
                labels={"result": about[ending]},
            )
            if (ending := os.path.splitext(path)[1]) in about
            else path
        )
        for path in step.outputs
    ]


@functools.cache
def decisive(scene, replaced=()):
    """Values of a scene, with those that it is based on, that decide a result, as text.

    Not those that a step replaces, nor the description; but a warning reads there that the speed
    is assumed.
    """
    values = leaves(as_data(scene)[0])
    assumed = "Speed assumed:" in str(values.pop("description", ""))
    kept = {key: value for key, value in values.items() if key not in replaced}
    return json.dumps([kept, assumed], sort_keys=True)


def scene_sources():
    """Scene files of the studies; the page reads their descriptions, which make no result anew."""
    files = [path for study in STUDIES.values() for path in study.inputs()]
    return [path for path in dict.fromkeys(files) if is_scene(path)]


def scene_notes(paths):
    """Hash of what the page reads in scene files and results do not depend on."""
    notes = [
        [as_data(path)[0].get("description"), sorted(assumed_keys(path))]
        for path in paths
    ]
    return text_hash(json.dumps(notes))


def made_from(job):
    """Hash of what decides a result besides other results: the sources of its functions, and the
    contents of its inputs. Snakemake compares inputs only where they are newer than the result; an
    edited one is not, if it is a copy that kept its date or the clock was set back.
    """

    def contents(wildcards):
        modules = dict.fromkeys(step.module for step in job.steps)
        files = [path for path in files_of(job)(wildcards) if path[:8] != "results/"]
        replaced = set.intersection(*(set(step.replaced) for step in job.steps))
        keys = tuple(sorted(replaced))
        scenes = "".join(decisive(path, keys) for path in files if is_scene(path))
        other = contents_hash(path for path in files if not is_scene(path))
        return text_hash(
            "".join([*map(result_hash, modules), text_hash(scenes), other])
        )

    return contents


def arguments(files):
    """Files by name, as `bearingwear step` takes them: NAME=FILE, NAME+=FILE for each of a list."""
    return [
        shlex.quote(text)
        for name, given in files.items()
        for text in (
            [f"{name}={given}"]
            if isinstance(given, str)
            else [f"{name}+={path}" for path in given]
        )
    ]


def calls_of(job):
    """What `bearingwear step` is told; several steps are parted by `--`."""

    def call(step):
        inputs, settings = arguments(step.inputs), shlex.quote(
            json.dumps(step.settings)
        )
        return " ".join(
            [step.run, *inputs, "--settings", settings, "-o", *step.outputs]
        )

    return lambda wildcards: " -- ".join(map(call, one(job, wildcards).steps))


def about(rule, text):
    """What `snakemake --list` says of a rule."""
    workflow.get_rule(rule).docstring = text


def label_of(job):
    return lambda wildcards: one(job, wildcards).label


def tell_result():
    """The last lines of a run that made the page: the result, and the path of the page."""
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
