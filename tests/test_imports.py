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
"""Modules of `kerneljit` that any part may import, since they do not import numba."""

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
"""Largest number of other modules of the package, besides kernels, that a file may import."""

MOST_FILES = 15
"""Largest number of files in a folder of `solvers` or `lives`."""

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


def source_paths():
    """Yields the sources of the package, of kerneljit and of workflow, relative to the root."""
    others = [*ROOT.glob("kerneljit/*.py"), *ROOT.glob("workflow/studies/*/*.py")]
    for path in sorted([*PACKAGE.rglob("*.py"), *others]):
        if "__pycache__" not in path.parts:
            yield path.relative_to(ROOT)


def part_of(module: Path) -> str:
    """Returns the part of the package that a file belongs to, or `kerneljit` or `workflow`."""
    top, *rest = module.with_suffix("").parts
    return rest[0] if top == "bearingwear" else top


def imported_names(module: Path):
    """Yields the dotted names that a module imports, anywhere in it."""
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
    """Returns whether a module may import a name, by the layers of `MAY_IMPORT`."""
    part = part_of(module)
    top, _, rest = name.partition(".")
    if top == "workflow":
        return part == top
    if top == "bearingwear":
        first = rest.split(".")[0]
        imported_part = first if first in MAY_IMPORT else "__init__"
        return imported_part == part or imported_part in MAY_IMPORT[part]
    if top == "numba":
        return part == "kerneljit"
    if top == "kerneljit":
        return part == top or part in MAY_COMPILE or name in NO_NUMBA
    return top in sys.stdlib_module_names or top in LIBRARIES.get(part, {top})


def forbidden_imports(is_allowed, files):
    """Returns a line `FILE imports NAME` for each import of some files that is not allowed.

    is_allowed: returns whether a file may import a name.
    """
    return [
        f"{module} imports {name}"
        for module in files
        for name in imported_names(module)
        if not is_allowed(module, name)
    ]


def test_imports_point_downward():
    assert not forbidden_imports(may_import, source_paths())


def test_files_and_folders_of_solvers_and_lives_are_small():
    """Imports in a file, and files in a folder, are counted."""
    crowded, folders = {}, Counter[Path]()
    for module in [path for path in source_paths() if part_of(path) in MOST_IMPORTS]:
        folders[module.parent] += 1
        names = {name for name in imported_names(module) if name.startswith("bearingwear.")}
        names = {name for name in names if not name.startswith("bearingwear.kernels")}
        if len(names) > MOST_IMPORTS[part_of(module)]:
            crowded[str(module)] = len(names)
    assert not crowded
    assert not {str(folder): count for folder, count in folders.items() if count > MOST_FILES}


def is_independent(module: Path, name: str) -> bool:
    """Returns whether a module of a study may import a name.

    It may not import from the folder of another study, except what BETWEEN_STUDIES lists.
    """
    study_of_module = module.parts[2]
    parts = name.split(".")
    if len(parts) < 3 or parts[1] != "studies" or not ROOT.joinpath(*parts[:3]).is_dir():
        return True
    exceptions = BETWEEN_STUDIES.get(study_of_module, set())
    return parts[2] == study_of_module or ".".join(parts[2:4]) in exceptions


def is_free_of_studies(module: Path, name: str) -> bool:
    """Returns whether a module that studies share may import a name.

    It may not import from the folder of a study, except what SHARED_NEEDS lists.
    """
    folder = PACKAGE.joinpath(*name.split(".")[1:3])
    if not name.startswith("bearingwear.studies.") or not folder.is_dir():
        return True
    return name.removeprefix("bearingwear.studies.") in SHARED_NEEDS.get(module.stem, set())


def test_studies_import_only_shared_modules():
    in_studies = [module for module in source_paths() if module.parts[1] == "studies"]
    of_studies = [module for module in in_studies if len(module.parts) > 3]  # in their folders
    assert any(len(module.parts) > 4 for module in of_studies)
    assert not forbidden_imports(is_independent, of_studies)
    shared = [module for module in in_studies if module not in of_studies]
    assert not forbidden_imports(is_free_of_studies, shared)


APPLICATIONS = sorted(path.parent.name for path in PACKAGE.glob("applications/*/__init__.py"))


def application_of(name: str) -> str:
    """Returns the application that a dotted name belongs to; empty for others."""
    prefix = "bearingwear.applications."
    return name.removeprefix(prefix).split(".")[0] if name.startswith(prefix) else ""


def is_public(module: Path, name: str) -> bool:
    """Returns whether a module of an application may import a name.

    Allowed are names of the same application, of libraries, and those that the package offers.
    """
    application = module.parts[2]
    if not name.startswith("bearingwear.") or application_of(name) == application:
        return True
    public_names = set(bearingwear.__all__) - application_functions().keys()
    allowed = INTERFACE | MODELS_OF_APPLICATIONS.get(application, set()) | public_names
    return name.removeprefix("bearingwear.") in allowed


def is_free_of_applications(module: Path, name: str) -> bool:
    """Returns whether an import is of no application, or of the module's own."""
    application = module.parts[2] if part_of(module) == "applications" else ""
    return application_of(name) in ("", application)


def test_applications_import_only_the_public_interface():
    """INTERFACE and MODELS_OF_APPLICATIONS list no module that is not imported."""
    files = [m for m in source_paths() if part_of(m) == "applications" and len(m.parts) > 3]
    assert {m.parts[2] for m in files} == set(APPLICATIONS)
    assert not forbidden_imports(is_public, files)
    used = {(file.parts[2], name) for file in files for name in imported_names(file)}
    names = {name.removeprefix("bearingwear.") for _, name in used}
    assert not INTERFACE - names
    for application, modules_of_models in MODELS_OF_APPLICATIONS.items():
        assert {(application, f"bearingwear.{name}") for name in modules_of_models} <= used


def test_nothing_imports_an_application():
    """One application does not import another, either.

    Exceptions are the study of the accuracy of cage ensembles, and the types in `bearingwear`.
    """
    exempt = Path("workflow/studies/accuracy/cages.py"), Path("bearingwear/__init__.py")
    files = [module for module in source_paths() if module not in exempt]
    assert not forbidden_imports(is_free_of_applications, files)


def test_import_bearingwear_loads_neither_argparse_nor_pathlib():
    # what an editable installation loads before it is no matter of the package
    loaded = modules_loaded_by("import bearingwear") - modules_loaded_by("import sys")
    assert "bearingwear" in loaded and not loaded & {"argparse", "pathlib"}


def import_circles(reached):
    """Returns pairs of files in different folders that import each other, directly or in turn.

    reached: files that each file imports, directly or in turn.
    """
    pairs = ((a, b) for a, files in reached.items() for b in files)
    # in the order of the folders, so that each pair comes once
    return [(a, b) for a, b in pairs if a.parent < b.parent and a in reached.get(b, ())]


def test_no_circle_of_imports_goes_through_two_folders():
    reached = {
        ROOT / file: sources(".".join(file.with_suffix("").parts)) for file in source_paths()
    }
    assert len(reached) > 300 and sum(map(len, reached.values())) > 1000
    assert not import_circles(reached)
    a, b, c = Path("x/a.py"), Path("y/b.py"), Path("z/c.py")
    assert import_circles({a: [b], b: [a], c: [a, b]}) == [(a, b)]


def test_the_snakefile_imports_no_slow_library():
    """It is read each time that Snakemake starts, on a cluster once for each job."""
    code = "from bearingwear.studies import configuration"
    assert not modules_loaded_by(code) & (SLOW - {"netCDF4", "numpy", "yaml"})


def modules_loaded_by(code: str) -> set[str]:
    """Returns the top-level modules in a new interpreter after some code."""
    script = f"import sys\n{code}\nprint(*sorted({{m.partition('.')[0] for m in sys.modules}}))"
    completed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr
    return set(completed.stdout.split("\n")[-2].split())


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


def test_help_imports_no_slow_library():
    code = "import bearingwear\nfrom bearingwear.cli import main\n"
    for words in (["--help"], ["solve", "--help"], ["--version"]):
        code += f"assert main({words}) == 0\n"
    assert not modules_loaded_by(code) & SLOW


def test_help_of_python_m_bearingwear_imports_no_slow_library():
    completed = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "bearingwear", "--help"],
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0 and completed.stdout.startswith("usage: bearingwear")
    loaded = {
        line.rpartition("|")[2].strip().partition(".")[0] for line in completed.stderr.split("\n")
    }
    assert "argparse" in loaded and not loaded & SLOW


def test_solve_show_and_check_import_only_the_libraries_they_need(tmp_path):
    scene = PACKAGE.parent / "config" / "scenes" / "gyro_s1.yaml"
    case = tmp_path / "case.nc"
    run = "from bearingwear.cli import main\nassert main({}) == 0"
    solved = run.format(["solve", str(scene), "-o", str(case)])
    slow = "import sys\nassert not {'scipy.optimize', 'scipy.special'} & sys.modules.keys()"
    assert "xarray" not in modules_loaded_by(f"{solved}\n{slow}")
    light = run.format(["show", str(case)]) + "\n" + run.format(["check", str(scene)])
    assert not {"xarray", "matplotlib", "scipy", "numba"} & modules_loaded_by(light)
