"""Imports point downward only, and light commands stay light."""

import ast
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from support import syntax_nodes

import bearingwear

PACKAGE = Path(bearingwear.__file__).parent
ROOT = PACKAGE.parent

# A part may import itself and what is listed; `__init__` is the package itself.
SOLVING = {"lives", "solvers", "scene", "kernels", "provenance", "sides", "measures"}
READING = {"results", "atomic", "interrupt", "__init__"} | SOLVING
MAY_IMPORT = {
    "kernels": {"provenance", "interrupt"},
    "scene": {"kernels", "provenance", "atomic", "measures"},
    "solvers": {"scene", "kernels", "provenance", "sides", "measures", "interrupt"},
    "lives": {"solvers", "scene", "kernels", "sides", "measures", "interrupt"},
    "results": READING,
    "document": READING,
    "plotting": READING,
    "studies": {"document", "plotting", "console", "process"} | READING,
    "page": {"document", "plotting"} | READING,
    "workflow": {"studies", "document", "plotting", "console"} | READING,
    "provenance": set(),
    "sides": set(),
    "measures": set(),
    "atomic": set(),
    "interrupt": set(),
    "console": set(),
    "process": {"kernels"},
    "run_module": {"__init__"},
    "__init__": {"api", "scene"},
    "api": {"studies", "document", "plotting"} | READING,
    "commands": {"arguments", "studies", "page", "document", "plotting", "console"} | READING,
    "arguments": {"studies", "console"} | READING,
    "cli": {"arguments", "commands", "studies", "console"} | READING,
    "__main__": {"cli", "process"},
}
BETWEEN_STUDIES = {
    "accuracy": {"cage.plan", "cage.ensemble"},  # ensembles of short and of long runs
    "grid": {"lives.figures"},  # to plot a life, of which there are two kinds
    # a recommended life is quoted with its spread, if that is sampled
    "design": {"uncertainty.plan"},
    "uncertainty": {"design.recommend"},  # a sample is taken at the preload that design recommends
}
"""What modules of a study's folder may import of another's; `page` imports none."""

SHARED_NEEDS = {
    "unsolved": {"grid.grid"},  # a file of a case has the name of what it holds
    # it checks the configuration of every study
    "configuration": {"grid.grid", "design.plan", "uncertainty.plan"},
    # it writes those of a study of lives, preload and cages
    "own_study": {"cage.plan", "design.plan", "design.map"},
}
"""What modules that studies share may import of one of them."""

MOST_IMPORTS = {"solvers": 12, "lives": 15}
"""Of other modules of the package in a file, kernels aside: more is a meeting room."""

MOST_FILES = 15
"""In a folder of `solvers` and `lives`."""

LIBRARIES = {
    "kernels": {"numpy"},
    "solvers": {"numpy", "scipy"},
    "lives": {"numpy", "scipy"},
    "provenance": set(),
    "sides": set(),
    "measures": {"numpy"},  # not to name options
    "atomic": set(),
    "interrupt": set(),
    "console": set(),
    "process": set(),
    "run_module": set(),
    "commands": set(),
    "__init__": set(),
    "__main__": set(),
    "api": {"xarray", "matplotlib"},
    "arguments": set(),
    "cli": {"argcomplete"},  # only where the shell asks
}


def modules():
    """Files from the root of the repository on: those of the package, and studies beside it."""
    for path in sorted([*PACKAGE.rglob("*.py"), *ROOT.glob("workflow/studies/*/*.py")]):
        if "__pycache__" not in path.parts:
            yield path.relative_to(ROOT)


def part_of(module: Path) -> str:
    """Folder of the package, or module of it, or `workflow`."""
    top, *rest = module.with_suffix("").parts
    return rest[0] if top == "bearingwear" else top


def imported(module: Path):
    """Dotted names a module imports, anywhere in it."""
    for node in syntax_nodes(ROOT / module):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import"
            if node.module == "bearingwear":
                yield from (f"bearingwear.{alias.name}" for alias in node.names)
            else:
                yield str(node.module)


def may_import(module: Path, name: str) -> bool:
    part = part_of(module)
    top, _, rest = name.partition(".")
    if top == "workflow":
        return part == top
    if top == "bearingwear":
        first = rest.split(".")[0]
        where = first if first in MAY_IMPORT else "__init__"
        return where == part or where in MAY_IMPORT[part]
    if top == "numba":
        return module.parent == Path("bearingwear/kernels/build")
    return top in sys.stdlib_module_names or top in LIBRARIES.get(part, {top})


def offenders(is_allowed, files):
    """Imports that are not allowed."""
    return [f"{m} imports {name}" for m in files for name in imported(m) if not is_allowed(m, name)]


def test_imports_point_downward():
    assert not offenders(may_import, modules())


def test_solvers_and_lives_are_small_rooms():
    crowded, folders = {}, Counter[Path]()
    for module in (m for m in modules() if part_of(m) in MOST_IMPORTS):
        folders[module.parent] += 1
        own = {name for name in imported(module) if name.startswith("bearingwear.")}
        own = {name for name in own if not name.startswith("bearingwear.kernels")}
        if len(own) > MOST_IMPORTS[part_of(module)]:
            crowded[str(module)] = len(own)
    assert not crowded
    assert not {str(folder): n for folder, n in folders.items() if n > MOST_FILES}


def stands_alone(module: Path, name: str) -> bool:
    """A new study, or one less, changes no other."""
    own = module.parts[2]
    _, studies, study, *rest = [*name.split("."), "", "", ""][:5]
    if studies != "studies" or not study or not ROOT.joinpath(*name.split(".")[:3]).is_dir():
        return True
    return study == own or f"{study}.{rest[0]}" in BETWEEN_STUDIES.get(own, set())


def knows_no_study(module: Path, name: str) -> bool:
    folder = PACKAGE.joinpath(*name.split(".")[1:3])
    if not name.startswith("bearingwear.studies.") or not folder.is_dir():
        return True
    return name.removeprefix("bearingwear.studies.") in SHARED_NEEDS.get(module.stem, set())


def test_studies_know_only_what_they_share():
    in_studies = [module for module in modules() if module.parts[1] == "studies"]
    assert not offenders(stands_alone, (m for m in in_studies if len(m.parts) == 4))
    assert not offenders(knows_no_study, (m for m in in_studies if len(m.parts) == 3))


def test_what_the_snakefile_reads_is_light():
    """It is read each time that Snakemake starts, on a cluster once a job."""
    code = "from bearingwear.studies import configuration"
    assert not loaded_by(code) & (SLOW - {"netCDF4", "numpy", "yaml"})


def loaded_by(code: str) -> set[str]:
    """Top-level modules in a fresh interpreter after some code."""
    script = f"import sys\n{code}\nprint(*sorted({{m.partition('.')[0] for m in sys.modules}}))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split("\n")[-2].split())


SLOW = {
    "numba",
    "xarray",
    "matplotlib",
    "scipy",
    "netCDF4",
    "numpy",
    "pandas",
    "jsonschema",
    "yaml",
    "argcomplete",
}


@pytest.mark.parametrize(
    "code",
    [
        "import bearingwear",
        "from bearingwear.cli import main\nassert main(['--help']) == 0",
        "from bearingwear.cli import main\nassert main(['solve', '--help']) == 0",
        "from bearingwear.cli import main\nassert main(['--version']) == 0",
    ],
)
def test_help_is_light(code):
    assert not loaded_by(code) & SLOW


def test_help_of_the_module_is_light():
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "bearingwear", "--help"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0 and done.stdout.startswith("usage: bearingwear")
    loaded = {line.rpartition("|")[2].strip().partition(".")[0] for line in done.stderr.split("\n")}
    assert "argparse" in loaded and not loaded & SLOW


def test_commands_import_only_what_they_need(tmp_path):
    scene = PACKAGE.parent / "config" / "scenes" / "gyro_s1.yaml"
    case = tmp_path / "case.nc"
    run = "from bearingwear.cli import main\nassert main({}) == 0"
    solved = run.format(["solve", str(scene), "-o", str(case)])
    slow = "import sys\nassert not {'scipy.optimize', 'scipy.special'} & sys.modules.keys()"
    assert "xarray" not in loaded_by(f"{solved}\n{slow}")
    assert not {"xarray", "matplotlib", "scipy", "numba"} & loaded_by(
        run.format(["show", str(case)])
    )
    assert not {"xarray", "matplotlib", "scipy", "numba"} & loaded_by(
        run.format(["check", str(scene)])
    )
