"""Compares two trees of results, file by file: `python benchmarks/compare_results.py A B`.

netCDF files by their variables and attributes, without tolerance, but for the versions that made
them. SVG files without their metadata, every other file by its
bytes. Exits with 1 if anything differs.
"""

import argparse
import filecmp
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bearingwear.results.netcdf import CaseFileError, open_result

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
        with open_result(a) as one, open_result(b) as other:
            yield from _differences(one, other)
    except CaseFileError as error:
        yield str(error)


def _differences(a: Any, b: Any) -> Iterator[str]:
    for name in sorted({*a.ncattrs(), *b.ncattrs()} - VERSIONS):
        texts = [str(getattr(file, name, "missing")) for file in (a, b)]
        if texts[0] != texts[1]:
            yield f"{name}: {texts[0]} in A, {texts[1]} in B"
    for name in sorted({*a.variables, *b.variables}):
        if name not in a.variables or name not in b.variables:
            yield f"{name}: missing in {'A' if name in b.variables else 'B'}"
            continue
        one, other = a[name], b[name]
        units = [getattr(variable, "units", "") for variable in (one, other)]
        if units[0] != units[1] or one.dimensions != other.dimensions or one.shape != other.shape:
            yield f"{name}: units, dimensions or sizes"
        elif str in (one.dtype, other.dtype):
            if (one[...] != other[...]).any():
                yield f"{name}: texts"
        else:
            x, y = (np.ma.filled(np.ma.asarray(v[...], dtype=float), np.nan) for v in (one, other))
            if not np.array_equal(x, y, equal_nan=True):
                yield f"{name}: by up to {np.nanmax(np.abs(x - y), initial=0.0):g}"


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
