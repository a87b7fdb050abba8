"""Several threads of a program use the Python interface at the same time."""

import os
import subprocess
import sys

THREADS = """
import threading
import bearingwear

case = bearingwear.solve(bearingwear.example())
bearingwear.save(case, "read.nc")

def work(number):
    for _ in range(3):
        bearingwear.save(case, f"{number}.nc")
        bearingwear.load("read.nc")
        bearingwear.show(case)
        bearingwear.save(case, "same.nc")

threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
for thread in threads:
    thread.start()
lives = bearingwear.sweep(bearingwear.example(), {"operation.preload_N": [5, 6]}, workers=2)
for thread in threads:
    thread.join()
print((lives.status == "ok").all().item())
"""


def test_threads_write_and_read_at_the_same_time(tmp_path):
    """Without a lock, the C library of netCDF would crash. A sweep starts processes meanwhile."""
    completed = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", THREADS],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert completed.returncode == 0 and completed.stdout == "True\n", completed.stderr
    files = sorted(os.listdir(tmp_path))
    assert files == [*(f"{number}.nc" for number in range(4)), "read.nc", "same.nc"]
    assert len({(tmp_path / name).read_bytes() for name in files}) == 1
