"""Snakemake, imported once for many runs: each is a fork of this process.

Reads lines of JSON, {"arguments", "folder", "environment", "output"}, and answers each with the
exit status. A run sees what `python -m snakemake` would in that folder: nothing of the package
under test is imported here.
"""

import json
import os
import sys

import netCDF4  # noqa: F401  this and the next two are what each run would import anew
import pandas  # noqa: F401
import smart_open  # noqa: F401
from snakemake.cli import get_argument_parser, main

get_argument_parser()  # which loads its plugins


def run(arguments, folder, environment, output):
    """Runs Snakemake in this process, which ends with its exit status.

    arguments: of Snakemake.
    folder: in which it runs.
    environment: all variables of its environment.
    output: file of both standard streams.
    """
    status = 1
    try:
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        sys.path[0] = folder
        sys.argv = ["snakemake", *arguments]
        descriptor = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(descriptor, 1)
        os.dup2(descriptor, 2)
        main(arguments)
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


for line in sys.stdin:
    request = json.loads(line)
    child = os.fork()
    if child == 0:
        run(**request)
    _, wait_status = os.waitpid(child, 0)
    print(os.waitstatus_to_exitcode(wait_status), flush=True)
