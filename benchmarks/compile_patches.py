"""What each extension of numba in `kerneljit` saves when the solver is compiled.

`python benchmarks/compile_patches.py [--models steady worn dynamic] [--only NAME ...]` compiles the
kernels of each model into an empty folder, with all extensions, with each of them (or each NAME)
left out in its turn, and by numba's public interface alone. It prints CPU seconds, the least of
`--repeats`, and how much longer it takes without the extension. The model `turn` is a shaft turn of
the dynamic model that is already compiled. Use an idle machine: CPU time of one core depends on
what its neighbour does.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

from cold import cpu_of_children

# numba is imported where an extension is left out, not where the runs are counted.


def _without(*names: str) -> Callable[[], None]:
    """A function that leaves numba's own functions of these names as they are."""

    def leave_out() -> None:
        from kerneljit import code

        in_full = code._replacements
        code._replacements = lambda: tuple(row for row in in_full() if row[1] not in names)

    return leave_out


def _records_by_value() -> None:
    from kerneljit import records

    records._BY_VALUE = sys.maxsize


def _references_counted() -> None:
    from kerneljit import code

    code.Borrow.run_pass = lambda self, state: False


def _garbage_collected() -> None:
    import contextlib

    from kerneljit import code

    code._without_garbage_collection = contextlib.nullcontext


def _one_library_each() -> None:
    from kerneljit import decorators

    decorators.compile_together = lambda kernel, other, types_of: None


def _level_three() -> None:
    from kerneljit import kernel

    in_full = kernel.entries
    kernel.entries = lambda kernels, level: in_full(kernels, 3)


LEFT_OUT: dict[str, Callable[[], None]] = {
    "nothing": lambda: None,
    "records by address": _records_by_value,
    "references not counted": _references_counted,
    "two kernels in one library": _one_library_each,
    "level 1 for the steady model": _level_three,
    "types of calls kept": _without("get_call_type"),
    "no wrappers for C": _without("create_cfunc_wrapper"),
    "records returned whole": _without("as_return", "from_return"),
    "variables found quickly": _without("_rec_list_vars"),
    "no live variables": _without("run"),
    "no garbage collection": _garbage_collected,
}
"""What is left out, by its name in kerneljit/README.md."""

PLAIN = "all (public interface)"
TURN, TURNS = "turn", 3


def compile_without(name: str, model: str) -> None:
    """Compile the kernels of a model here, in this process; print the CPU time of a turn [s]."""
    LEFT_OUT[name]()
    from bearingwear import example
    from bearingwear.solvers.solve import solve
    from bearingwear.studies.compile_model import compile_model

    compile_model("dynamic" if model == TURN else model)
    if model == TURN:
        scene = example().with_({"model.simulated_turns": TURNS})
        before = time.process_time()
        solve(scene, "dynamic")
        print((time.process_time() - before) / TURNS)


def seconds(name: str, model: str) -> float:
    """CPU time of a process that compiles a model, or of a turn [s]."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        environment["BEARINGWEAR_PLAIN_NUMBA"] = "1" if name == PLAIN else ""
        before = cpu_of_children()
        words = [sys.executable, __file__, "--here", "nothing" if name == PLAIN else name, model]
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr)
        return float(done.stdout) if model == TURN else cpu_of_children() - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    models = ["steady", "worn", "dynamic"]
    parser.add_argument("--models", nargs="+", choices=[*models, TURN], default=models)
    parser.add_argument("--repeats", type=int, default=2)
    names = [*LEFT_OUT, PLAIN]
    parser.add_argument("--only", nargs="+", choices=names[1:], default=names[1:], metavar="NAME")
    parser.add_argument("--here", nargs=2, metavar=("NAME", "MODEL"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.here:
        compile_without(*args.here)
        return
    names = ["nothing", *args.only]
    least: dict[tuple[str, str], float] = {}
    for _ in range(args.repeats):  # in turn, so that a slow minute does not hit one of them alone
        for name in names:
            for model in args.models:
                took = seconds(name, model)
                print(f"{name}, {model}: {took:.3g} s", file=sys.stderr, flush=True)
                least[name, model] = min(took, least.get((name, model), took))
    print("| left out | " + " | ".join(f"{model} [s]" for model in args.models) + " |")
    print("| --- |" + " ---: |" * len(args.models))
    for name in names:
        cells = []
        for model in args.models:
            whole, now = least["nothing", model], least[name, model]
            longer = "" if name == "nothing" else f" (+{100 * (now / whole - 1):.0f} %)"
            cells.append(f"{now:.3g}{longer}".replace("+-", "-"))
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
