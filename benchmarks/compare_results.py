"""Compares two trees of results, file by file and bit by bit.

    python benchmarks/compare_results.py A B [--renamed MAP.yaml]

netCDF files: dimensions, variables (values, type, dimensions, order) and attributes, without those
that say which version made the file. Every other file: its bytes. Exits with 1 if anything differs.

The map says what has another name in B; every part may be left out:

    paths: {"^extremes/": "robustness/"}    # regular expressions, of paths below A
    dimensions: {of: uncertain_inputs}
    variables: {found: fit_result}
    attributes: {trade_scene: study_scene}
    texts: {"\\bfound\\b": fit_result}      # regular expressions, in text attributes, .csv and .md
    ignored: [wall_time]                    # variables and attributes, by either name
    within: {"^tradeoff/": {attributes: {kind: sweep_kind}}}    # further ones of some files of A
"""

import argparse
import itertools
import re
import sys
from collections import ChainMap
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, BinaryIO, TextIO

import netCDF4
import numpy as np
import yaml

VERSIONS = {
    "source", "history", "package_version", "source_hash", "numpy_version", "numba_version",
}  # fmt: skip
"""Global attributes that say which version made a file."""

AT_ONCE = 1 << 20
"""Values of a variable, or bytes of a file, that are read at a time."""

WIDEST = 80
"""Characters of a value that are shown."""

SVG_METADATA = re.compile(rb"<metadata>.*?</metadata>", re.DOTALL)


@dataclass(frozen=True)
class Renamed:
    """What has another name in the second tree."""

    paths: Mapping[str, str] = field(default_factory=dict)
    dimensions: Mapping[str, str] = field(default_factory=dict)
    variables: Mapping[str, str] = field(default_factory=dict)
    attributes: Mapping[str, str] = field(default_factory=dict)
    texts: Mapping[str, str] = field(default_factory=dict)
    ignored: Sequence[str] = ()
    within: Mapping[str, Any] = field(default_factory=dict)

    def of_file(self, path: str) -> "Renamed":
        """With what is renamed in one file alone."""
        parts = [part for where, part in self.within.items() if re.search(where, path)]
        names = ("dimensions", "variables", "attributes", "texts")
        merged = {k: ChainMap(*(p.get(k, {}) for p in parts), getattr(self, k)) for k in names}
        ignored = [*self.ignored, *(name for part in parts for name in part.get("ignored", ()))]
        return replace(self, ignored=ignored, **merged)

    def path(self, path: str) -> str:
        return _replaced(path, self.paths)

    def text(self, text: str) -> str:
        return _replaced(text, self.texts)

    def variable(self, name: str) -> str:
        """Coordinates have the name of their dimension."""
        return self.variables.get(name, self.dimensions.get(name, name))

    def dims(self, names: Sequence[str]) -> tuple[str, ...]:
        return tuple(self.dimensions.get(name, name) for name in names)


def _replaced(text: str, expressions: Mapping[str, str]) -> str:
    for expression, new in expressions.items():
        text = re.sub(expression, new, text)
    return text


def tree_differences(a: Path, b: Path, renamed: Renamed) -> Iterator[str]:
    """One line for each difference; files are compared one after the other."""
    others: dict[str, str] = {}
    for old in _files(a):
        name = renamed.path(old)
        if name in others:
            yield f"{name}: both {others[name]} and {old} in A"
        others[name] = old
    there = set(_files(b))
    for name, old in sorted(others.items()):
        if name not in there:
            yield f"{old}: missing in B" + (f" (as {name})" if name != old else "")
            continue
        compare = netcdf_differences if name.endswith(".nc") else file_differences
        for difference in compare(a / old, b / name, renamed.of_file(old)):
            yield f"{name}: {difference}"
    for name in sorted(there - set(others)):
        yield f"{name}: missing in A"


def _files(folder: Path) -> Iterator[str]:
    return (p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file())


# netCDF


def netcdf_differences(a: Path, b: Path, renamed: Renamed) -> Iterator[str]:
    try:
        with netCDF4.Dataset(a) as first, netCDF4.Dataset(b) as second:
            for file in (first, second):
                file.set_auto_maskandscale(False)
            yield from _dataset_differences(first, second, renamed)
    except (OSError, RuntimeError) as error:
        yield f"cannot be read: {error}"


def _dataset_differences(a: Any, b: Any, renamed: Renamed) -> Iterator[str]:
    sizes = {name: dim.size for name, dim in a.dimensions.items()}
    renamed_sizes = dict(zip(renamed.dims(list(sizes)), sizes.values(), strict=True))
    theirs = {name: dim.size for name, dim in b.dimensions.items()}
    yield from _mapping_differences("dimension", renamed_sizes, theirs)
    yield from _attribute_differences("", a, b, renamed, VERSIONS)
    names = {renamed.variable(name): name for name in a.variables if name not in renamed.ignored}
    others = dict.fromkeys(name for name in b.variables if name not in renamed.ignored)
    yield from _mapping_differences("variable", dict.fromkeys(names), others)
    for name in (name for name in names if name in others):
        yield from _variable_differences(name, a[names[name]], b[name], renamed)


def _variable_differences(name: str, a: Any, b: Any, renamed: Renamed) -> Iterator[str]:
    yield from _attribute_differences(f"variable {name}, ", a, b, renamed)
    shapes = [(renamed.dims(a.dimensions), a.shape, a.dtype), (b.dimensions, b.shape, b.dtype)]
    if shapes[0] != shapes[1]:
        yield f"variable {name}: {shapes[0]} in A, {shapes[1]} in B"
        return
    count = sum(_count_of_differences(a[part], b[part]) for part in _slabs(a.shape))
    if count:
        yield f"variable {name}: {count} of {int(np.prod(a.shape))} values"


def _slabs(shape: tuple[int, ...]) -> Iterator[Any]:
    """Indices of parts along the first dimension that are small enough to be held."""
    if not shape:
        yield ...
        return
    rows = max(1, AT_ONCE // max(1, int(np.prod(shape[1:]))))
    yield from (slice(start, start + rows) for start in range(0, shape[0], rows))


def _count_of_differences(a: Any, b: Any) -> int:
    one, other = np.atleast_1d(a).ravel(), np.atleast_1d(b).ravel()
    if one.dtype.kind in "OSU":
        return int(np.sum(one != other))
    bits = (np.ascontiguousarray(x).view(np.uint8).reshape(x.size, -1) for x in (one, other))
    return int(np.any(np.not_equal(*bits), axis=1).sum()) if one.size else 0


def _attribute_differences(
    where: str, a: Any, b: Any, renamed: Renamed, ignored: Collection[str] = ()
) -> Iterator[str]:
    left_out = {*ignored, *renamed.ignored}
    kept = [name for name in a.ncattrs() if name not in left_out]
    one = {renamed.attributes.get(k, k): _plain(a.getncattr(k), renamed) for k in kept}
    other = {k: _plain(b.getncattr(k), Renamed()) for k in b.ncattrs() if k not in left_out}
    yield from _mapping_differences(f"{where}attribute", one, other)


def _plain(value: Any, renamed: Renamed) -> tuple[str, Any]:
    """Type and bits of an attribute."""
    if isinstance(value, str):
        return "text", renamed.text(value)
    array = np.asarray(value)
    return str(array.dtype), array.tolist() if array.dtype.kind == "O" else array.tobytes()


def _mapping_differences(what: str, a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    for name in sorted(a.keys() | b.keys()):
        if name not in a or name not in b:
            yield f"{what} {name}: missing in {'A' if name not in a else 'B'}"
        elif a[name] != b[name]:
            yield f"{what} {name}: {str(a[name])[:WIDEST]} in A, {str(b[name])[:WIDEST]} in B"
    if list(a) != list(b) and set(a) == set(b):
        yield f"order of each {what}"


# other files


def file_differences(a: Path, b: Path, renamed: Renamed) -> Iterator[str]:
    if renamed.texts and a.suffix in (".csv", ".md"):
        with _text(a) as one, _text(b) as two:
            lines = itertools.zip_longest(map(renamed.text, one), two)
            number = next((k for k, (x, y) in enumerate(lines, 1) if x != y), None)
        if number:
            yield f"text, from line {number}"
    elif not _same_bytes(a, b):
        is_drawn_alike = a.suffix == ".svg" and _drawing(a) == _drawing(b)
        yield "metadata only" if is_drawn_alike else "bytes"


def _drawing(svg: Path) -> bytes:
    return re.sub(SVG_METADATA, b"", svg.read_bytes())


def _text(path: Path) -> TextIO:
    return path.open(encoding="utf-8", newline="")


def _same_bytes(a: Path, b: Path) -> bool:
    if a.stat().st_size != b.stat().st_size:
        return False
    with a.open("rb") as one, b.open("rb") as two:
        return all(x == y for x, y in zip(_blocks(one), _blocks(two), strict=True))


def _blocks(file: BinaryIO) -> Iterator[bytes]:
    return iter(lambda: file.read(AT_ONCE), b"")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("a", type=Path, metavar="A")
    parser.add_argument("b", type=Path, metavar="B")
    parser.add_argument("--renamed", type=Path, metavar="MAP.yaml")
    args = parser.parse_args()
    renamed = Renamed(**yaml.safe_load(args.renamed.read_text())) if args.renamed else Renamed()
    count = 0
    for difference in tree_differences(args.a, args.b, renamed):
        count += 1
        print(difference, flush=True)
    files = sum(1 for _ in _files(args.a))
    print(f"{count} differences in {files} files" if count else f"all {files} files are the same")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
