"""Imports point downward only, and light commands stay light."""

import ast
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

import bearingwear

PACKAGE = Path(bearingwear.__file__).parent
ROOT = PACKAGE.parent

# A part may import itself and what is listed; `__init__` is the package itself.
SOLVING = {"lives", "solvers", "scene", "kernels", "provenance", "sides", "measures"}
READING = {"results", "atomic", "__init__"} | SOLVING
MAY_IMPORT = {
    "kernels": {"provenance"},
    "scene": {"kernels", "provenance", "atomic", "measures"},
    "solvers": {"scene", "kernels", "provenance", "sides", "measures"},
    "lives": {"solvers", "scene", "kernels", "sides", "measures"},
    "results": READING,
    "plotting": READING,
    "studies": {"plotting", "console"} | READING,
    "page": {"plotting"} | READING,
    "workflow": {"studies", "plotting", "console"} | READING,
    "provenance": set(),
    "sides": set(),
    "measures": set(),
    "atomic": set(),
    "console": set(),
    "__init__": {"api", "scene"},
    "api": {"studies", "plotting"} | READING,
    "commands": {"arguments", "studies", "plotting", "console"} | READING,
    "arguments": {"studies", "console"} | READING,
    "cli": {"arguments", "commands", "studies", "console"} | READING,
    "__main__": {"cli"},
}
BETWEEN_STUDIES = {
    "grid": {"lives.figures"},  # to plot a life, of which there are two kinds
    "design": {
        "uncertainty.plan"
    },  # a recommended life is quoted with its spread, if that is sampled
    "own": {"design.plan", "design.map"},  # it makes the plan of a study of lives and preload
    "uncertainty": {"design.recommend"},  # a sample is taken at the preload that design recommends
}
"""What modules of a study's folder may import of another's; `page` imports none."""

SHARED_NEEDS = {
    "repair": {"grid.grid"},  # a file of a case has the name of what it holds
    "unsolved": {"grid.grid"},
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
    "console": set(),
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
    for node in ast.walk(ast.parse((ROOT / module).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import"
            if node.module == "bearingwear":
                yield from (f"bearingwear.{alias.name}" for alias in node.names)
            else:
                yield str(node.module)


@pytest.mark.parametrize("module", list(modules()), ids=str)
def test_imports_point_downward(module):
    part = part_of(module)
    for name in imported(module):
        top, _, rest = name.partition(".")
        if top == "workflow":
            assert part == top, f"{module} imports {name}"
        elif top == "bearingwear":
            first = rest.split(".")[0]
            where = first if first in MAY_IMPORT else "__init__"
            assert where == part or where in MAY_IMPORT[part], f"{module} imports {name}"
        elif top == "numba":
            assert module.parent == Path("bearingwear/kernels/build"), f"{module} imports {name}"
        elif top not in sys.stdlib_module_names and part in LIBRARIES:
            assert top in LIBRARIES[part], f"{module} imports {name}"


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


@pytest.mark.parametrize(
    "module", [m for m in modules() if m.parts[1] == "studies" and len(m.parts) == 4], ids=str
)
def test_a_study_stands_alone(module):
    """A new one, or one less, changes no other."""
    own = module.parts[2]
    for name in imported(module):
        _, studies, study, *rest = [*name.split("."), "", "", ""][:5]
        if studies == "studies" and ROOT.joinpath(*name.split(".")[:3]).is_dir() and study:
            allowed = BETWEEN_STUDIES.get(own, set())
            assert study == own or f"{study}.{rest[0]}" in allowed, f"{module} imports {name}"


@pytest.mark.parametrize("module", [m for m in modules() if part_of(m) == "studies"], ids=str)
def test_what_studies_share_knows_none_of_them(module):
    if len(module.parts) == 3:
        for name in imported(module):
            folder = PACKAGE.joinpath(*name.split(".")[1:3])
            if name.startswith("bearingwear.studies.") and folder.is_dir():
                allowed = SHARED_NEEDS.get(module.stem, set())
                assert name.removeprefix("bearingwear.studies.") in allowed, name


def test_what_the_snakefile_reads_is_light():
    """Studies are read each time that Snakemake starts, and it starts once a job."""
    code = "import bearingwear.studies\nfrom bearingwear.studies import protocol, repair"
    assert not loaded_by(code) & (SLOW - {"netCDF4", "numpy"})


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
    assert "xarray" not in loaded_by(run.format(["solve", str(scene), "-o", str(case)]))
    assert not {"xarray", "matplotlib", "scipy", "numba"} & loaded_by(
        run.format(["show", str(case)])
    )
    assert not {"xarray", "matplotlib", "scipy", "numba"} & loaded_by(
        run.format(["check", str(scene)])
    )
