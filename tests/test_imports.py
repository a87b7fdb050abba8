"""Imports point downward only, and light commands stay light."""

import ast
import subprocess
import sys
from collections import Counter
from pathlib import Path

from support import syntax_nodes

import bearingwear
from bearingwear.application import application_functions
from bearingwear.provenance import sources

PACKAGE = Path(bearingwear.__file__).parent
ROOT = PACKAGE.parent

# A part may import itself and what is listed; `__init__` is the package itself.
SOLVING = {"lives", "solvers", "scene", "kernels", "provenance", "sides", "measures"}
READING = {"results", "atomic", "__init__"} | SOLVING
COMMANDS = {"options", "printing", "console", "studies", "document", "plotting"} | READING
MAY_IMPORT = {
    "kernels": {"provenance"},
    "scene": {"kernels", "provenance", "atomic", "measures"},
    "solvers": {"scene", "kernels", "provenance", "sides", "measures"},
    "lives": {"solvers", "scene", "kernels", "sides", "measures"},
    "results": READING,
    "document": READING,
    "plotting": READING,
    "studies": {"document", "plotting", "console", "process", "application"} | READING,
    "page": {"document", "plotting"} | READING,
    "workflow": {"studies", "document", "plotting", "console", "applications"} | READING,
    "application": set(),  # finds the folders of `applications` by their names
    "applications": {"application"} | COMMANDS,
    "provenance": set(),
    "sides": set(),
    "measures": set(),
    "atomic": set(),
    "console": set(),
    "process": set(),
    "run_module": {"__init__"},
    # the types of applications; `test_nothing_imports_an_application` sees that it is no more
    "__init__": {"api", "scene", "application", "applications"},
    "api": {"studies", "document", "plotting"} | READING,
    "options": {"scene", "atomic"},
    "printing": {"studies", "document", "console", "results"},
    "commands": {"arguments", "page"} | COMMANDS,
    "arguments": {"application", "options", "studies", "console"} | READING,
    "cli": {"arguments", "commands", "studies", "console"} | READING,
    "__main__": {"cli", "process"},
}
MAY_COMPILE = {"kernels"}
NO_NUMBA = {"kerneljit.interrupt", "kerneljit.project", "kerneljit.versions"}
"""What everybody may import of `kerneljit`, which imports nothing of the package."""

BETWEEN_STUDIES = {
    "accuracy": {"cage.plan", "cage.ensemble"},  # ensembles of short and of long runs
    "grid": {"lives.figures", "lives.duty_figure"},  # to plot a life of any kind
    # a recommended life is quoted with its spread, if that is sampled
    "design": {"uncertainty.plan"},
    "lives": {"design.recommend", "design.document"},  # a duty is shown at the recommended preload
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

INTERFACE = {
    # commands and files
    "application",
    "atomic",
    "console",
    "options",
    "printing",
    "provenance",
    # scenes
    "scene.blocks",
    "scene.checking.check",
    "scene.checking.errors",
    "scene.checking.records",
    "scene.checking.strict_yaml",
    "scene.coefficients",
    "scene.distributions",
    "scene.new.minimum_preload",
    "scene.read",
    "scene.requirements",
    "scene.scene",
    "scene.uncertain",
    # what solves and asks
    "kernels.status",
    "measures",
    "solvers.solve",
    "studies.answers",
    "studies.axis",
    "studies.dataset",
    "studies.sampling",
    # sheets, figures and datasets
    "document.bearing_line",
    "document.document",
    "document.markdown",
    "document.rows",
    "plotting.drawing",
    "results.labels",
    "results.netcdf",
    "results.quantiles",
    "results.units",
    "results.variable",
    "results.variables",
    "results.words",
}
"""What any application may import, besides the names of `bearingwear` itself."""

MODELS_OF_APPLICATIONS = {
    "cage": {  # it steers runs of the dynamic model, and follows a life of its own
        "lives.dynamic_life",
        "lives.ends",
        "lives.follow",
        "lives.methods",
        "lives.motion",
        "lives.worn_parts",
        "scene.accuracy",
        "solvers.dynamic.errors",
        "solvers.dynamic.outputs",
        "solvers.dynamic.run",
        "solvers.dynamic.system",
        "solvers.dynamic.windows",
        "solvers.start",
        "solvers.state",
        "solvers.warm",
    },
    "calibrate": {"solvers.bearing.films", "studies.uncertainty.sample"},
    "export": {"solvers.effects.choice"},  # dynamic runs have no stiffness matrix
    # what the requirements of `recommend` compute as well
    "launch": {"document.launch", "lives.margin", "solvers.bearing.launch"},
    "margin": {"document.margin", "lives.margin"},
}
"""What single applications import of the models besides."""

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
    "process": set(),
    "run_module": set(),
    "commands": set(),
    "application": set(),
    "options": set(),
    "printing": set(),
    "__init__": set(),
    "__main__": set(),
    "api": {"xarray", "matplotlib"},
    "arguments": set(),
    "cli": {"argcomplete"},  # only where the shell asks
}


def modules():
    """Files from the root of the repository on: of the package, and of what lies beside it."""
    beside = [*ROOT.glob("kerneljit/*.py"), *ROOT.glob("workflow/studies/*/*.py")]
    for path in sorted([*PACKAGE.rglob("*.py"), *beside]):
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
        return part == "kerneljit"
    if top == "kerneljit":
        return part == top or part in MAY_COMPILE or name in NO_NUMBA
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
    of_studies = [module for module in in_studies if len(module.parts) > 3]  # in their folders
    assert any(len(module.parts) > 4 for module in of_studies)
    assert not offenders(stands_alone, of_studies)
    assert not offenders(knows_no_study, (m for m in in_studies if m not in of_studies))


APPLICATIONS = sorted(path.parent.name for path in PACKAGE.glob("applications/*/__init__.py"))


def application_of(name: str) -> str:
    """Application that a dotted name belongs to; empty for others."""
    return name.removeprefix("bearingwear.applications.").split(".")[0] * name.startswith(
        "bearingwear.applications."
    )


def is_public(module: Path, name: str) -> bool:
    """Whether an application may import a name: its own, of the interface, or a library."""
    own = module.parts[2]
    if not name.startswith("bearingwear.") or application_of(name) == own:
        return True
    public_names = set(bearingwear.__all__) - application_functions().keys()
    allowed = INTERFACE | MODELS_OF_APPLICATIONS.get(own, set()) | public_names
    return name.removeprefix("bearingwear.") in allowed


def knows_no_application(module: Path, name: str) -> bool:
    own = module.parts[2] if part_of(module) == "applications" else ""
    return application_of(name) in ("", own)


def test_applications_import_the_interface():
    files = [m for m in modules() if part_of(m) == "applications" and len(m.parts) > 3]
    assert {m.parts[2] for m in files} == set(APPLICATIONS)
    assert not offenders(is_public, files)
    used = {(m.parts[2], name) for m in files for name in imported(m)}
    names = {name.removeprefix("bearingwear.") for _, name in used}
    assert not INTERFACE - names
    for application, modules_of_models in MODELS_OF_APPLICATIONS.items():
        assert {(application, f"bearingwear.{name}") for name in modules_of_models} <= used


def test_nothing_imports_an_application():
    """Nor does one application import another."""
    mine = Path("workflow/studies/accuracy/cages.py")  # on the accuracy of an ensemble
    files = [m for m in modules() if m not in (mine, Path("bearingwear/__init__.py"))]
    assert not offenders(knows_no_application, files)
    # what an editable installation loads before it is no matter of the package
    loaded = loaded_by("import bearingwear") - loaded_by("import sys")
    assert "bearingwear" in loaded and not loaded & {"argparse", "pathlib"}


def circles(reached):
    """Pairs of files in different folders that import each other, directly or in turn."""
    pairs = ((a, b) for a, files in reached.items() for b in files if a.parent < b.parent)
    return [(a, b) for a, b in pairs if a in reached.get(b, ())]


def test_no_circle_goes_through_two_folders():
    named = {".".join(module.with_suffix("").parts): module for module in modules()}
    reached = {ROOT / file: sources(name) for name, file in named.items()}
    assert len(reached) > 300 and sum(map(len, reached.values())) > 1000
    assert not circles(reached)
    a, b, c = Path("x/a.py"), Path("y/b.py"), Path("z/c.py")
    assert circles({a: [b], b: [a], c: [a, b]}) == [(a, b)]


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


def test_help_is_light():
    code = "import bearingwear\nfrom bearingwear.cli import main\n"
    for asked in (["--help"], ["solve", "--help"], ["--version"]):
        code += f"assert main({asked}) == 0\n"
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
    light = run.format(["show", str(case)]) + "\n" + run.format(["check", str(scene)])
    assert not {"xarray", "matplotlib", "scipy", "numba"} & loaded_by(light)
