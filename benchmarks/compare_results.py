"""Compares two trees of results, file by file: `python benchmarks/compare_results.py A B`.

netCDF files as `bearingwear compare` does, without tolerance, and the attributes that say how a
file was made, but for its versions. SVG files without their metadata, every other file by its
bytes. Exits with 1 if anything differs.
"""

import argparse
import filecmp
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from bearingwear.results.compare import file_differences
from bearingwear.results.netcdf import CaseFileError, opened

VERSIONS = {
    "source", "history", "package_version", "source_hash", "numpy_version", "numba_version",
}  # fmt: skip
"""Attributes that say which version made a file."""

SVG_METADATA = re.compile(rb"<metadata>.*?</metadata>", re.DOTALL)


def tree_differences(a: Path, b: Path) -> Iterator[str]:
    """A line for each difference; files are compared one after the other."""
    ours, theirs = _files(a), _files(b)
    for name in sorted(ours ^ theirs):
        yield f"{name}: missing in {'B' if name in ours else 'A'}"
    for name in sorted(ours & theirs):
        compare = netcdf_differences if name.endswith(".nc") else other_differences
        yield from (f"{name}: {difference}" for difference in compare(a / name, b / name))


def _files(folder: Path) -> set[str]:
    return {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}


def netcdf_differences(a: Path, b: Path) -> Iterator[str]:
    """What differs between two result files, or why one cannot be read."""
    try:
        with opened(a) as one, opened(b) as other:
            found = file_differences(one, other)
    except CaseFileError as error:
        yield str(error)
        return
    for what, texts in (("scene", found.scene), ("", found.model), ("", found.making)):
        for name in texts.keys() - VERSIONS:
            yield f"{what} {name}: {' in A, '.join(texts[name])} in B".lstrip()
    for one in found.variables:
        yield f"{one.name}: {one.first} in A, {one.second} in B; {one.place}"


def other_differences(a: Path, b: Path) -> Iterator[str]:
    """Whether the bytes of two files differ."""
    if not filecmp.cmp(a, b, shallow=False):
        drawings = (SVG_METADATA.sub(b"", path.read_bytes()) for path in (a, b))
        alike = a.suffix == ".svg" and len(set(drawings)) == 1
        yield "metadata only" if alike else "bytes"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("a", type=Path, metavar="A")
    parser.add_argument("b", type=Path, metavar="B")
    args = parser.parse_args()
    count = 0
    for difference in tree_differences(args.a, args.b):
        count += 1
        print(difference, flush=True)
    files = len(_files(args.a))
    print(f"{count} differences in {files} files" if count else f"all {files} files are the same")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
