"""How right the stated time left of a command is.

    python benchmarks/time_left.py bearingwear uncertainty mine.yaml --samples 200

Runs the command, prints each of its lines with a time left, when it came, and the time that was
left indeed, and the worst ratio of the two after the first third. Only lines count before the last
`LEAST` seconds, for which whole seconds say too little.
"""

import re
import subprocess
import sys
import time

STATED = re.compile(r"about (\d+) s left")
LEAST = 4.0


def main() -> None:
    process = subprocess.Popen(sys.argv[1:], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    started, lines = time.monotonic(), []
    for line in process.stderr:
        if found := STATED.search(line):
            lines.append((time.monotonic() - started, float(found[1]), line.strip()))
    status = process.wait()
    total, worst = time.monotonic() - started, 1.0
    for when, stated, line in lines:
        left = total - when
        counts = when > total / 3.0 and left > LEAST
        ratio = max(stated, 1.0) / left
        worst = max(worst, ratio, 1.0 / ratio) if counts else worst
        print(f"{when:6.1f} s  left {left:6.1f} s  ratio {ratio:.2f} {'*' * counts}  {line[:70]}")
    print(f"exit {status} after {total:.1f} s; worst factor after the first third {worst:.2f}")


if __name__ == "__main__":
    main()
