"""Work shared by several processes."""

import os
import time

from bearingwear.studies.pool import processes

LONGEST = 5.0  # [s] that a job waits for its file


def process_of_job(file):
    """Which process it is, once a file is there."""
    end = time.monotonic() + LONGEST
    while file is not None and not file.exists() and time.monotonic() < end:
        time.sleep(0.01)
    return os.getpid()


def test_this_process_does_the_first_job_and_those_that_find_all_others_busy(tmp_path):
    own, go = os.getpid(), tmp_path / "go"
    with processes(2, "test", some_here=True) as each:
        first, *others = each(process_of_job, [None, None, None])
        busy = each(process_of_job, [go, go])
        here = list(each(process_of_job, [None, None]))
        go.touch()
        assert first == own and here == [own, own]
        assert own not in [*others, *busy, *each(process_of_job, [None, None])]
