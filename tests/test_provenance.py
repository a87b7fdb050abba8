"""Which sources decide a result: found from the import statements of the package itself."""

import ast

import pytest
from support import ROOT, syntax_nodes

from bearingwear import provenance
from bearingwear.provenance import PACKAGE, SOLVER, result_hash, sources, sources_hash

OURS = "bearingwear.", "kerneljit.", "workflow."


def source_files(*modules) -> set[str]:
    """Returns the sources of modules, relative to the package or to `workflow`."""
    folders = PACKAGE, ROOT / "workflow"
    return {
        path.relative_to(folder).as_posix()
        for path in sources(*modules)
        for folder in folders
        if path.is_relative_to(folder)
    }


def test_the_sources_of_the_solver_are_those_that_determine_its_results():
    solver = source_files(*SOLVER)
    assert {"scene/read.py", "scene/accuracy.py", "lives/life.py", "results/netcdf.py"} <= solver
    assert {path for path in solver if path.startswith("kernels/")}
    assert not [path for path in solver if path.startswith(("studies/", "page/", "plotting/"))]
    assert not {"cli.py", "arguments.py", "commands.py", "document/show.py"} & solver


def test_data_files_are_sources_of_the_module_that_names_them():
    assert "page/page.html" in source_files("bearingwear.page.page")
    assert "plotting/style.mplstyle" in source_files("bearingwear.studies.grid.figures.draw")
    assert "scene/new/new_scene.yaml.j2" in source_files("bearingwear.scene.new.scene_file")
    # warnings compare speed and preload with the limits of the bearing's maker
    assert {path for path in source_files(*SOLVER) if not path.endswith(".py")} == {
        "scene/new/skf_minimum_load.csv",
        "scene/new/catalogue.csv",
    }


@pytest.fixture(autouse=True)
def in_the_project(monkeypatch):
    """Makes the project the present folder, from which studies read their files."""
    monkeypatch.chdir(ROOT)


def test_imports_by_text_are_those_of_the_syntax_tree():
    """The package searches for them in the text, in a tenth of the time of parsing it."""
    for path in sorted([*PACKAGE.rglob("*.py"), *ROOT.glob("workflow/studies/*/*.py")]):
        assert set(provenance._imported_modules(path)) == parsed_imports(path), path


def parsed_imports(path):
    """Returns the modules of this project that a file imports, by its syntax tree.

    Imports for types alone are left out.
    """
    nodes = syntax_nodes(path)
    for_types = {
        inner
        for node in nodes
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    names = set()
    for node in set(nodes) - for_types:
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                module = f"{node.module}.{alias.name}"
                is_file = module.startswith(OURS) and provenance._module_file(module).is_file()
                names.add(module if is_file else node.module)
    return {name for name in names if name.startswith(OURS)}


def test_results_of_solves_depend_on_all_sources_of_the_solver():
    """Results name their sources, and results of different sources are not gathered."""
    for module in ("bearingwear.studies.solve", "bearingwear.studies.grid.life"):
        assert result_hash(module) == sources_hash(module, *SOLVER)
    # a source of results that the imports of the step alone would miss
    assert "results/netcdf.py" not in source_files("bearingwear.studies.solve")


def test_results_of_other_steps_depend_on_their_own_sources_alone():
    for module in ("bearingwear.studies.grid.figures.draw", "bearingwear.studies.grid.gather"):
        assert result_hash(module) == sources_hash(module)


CACHED = (
    provenance.sources,
    provenance.sources_hash,
    provenance._imported_modules,
    provenance._data_files,
    provenance._other_files,
    provenance._module_file,
    provenance._is_module,
    provenance._file_hash,
)


@pytest.fixture
def hash_of_package(tmp_path, monkeypatch):
    """Yields a function that writes a package, and returns the hash of a module's sources.

    Its arguments are the module and the texts of files by their paths.
    """

    def hash_of(module, files):
        for cached in CACHED:
            cached.cache_clear()
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text, encoding="utf-8")
        return provenance.sources_hash(f"bearingwear.{module}")

    monkeypatch.setattr(provenance, "PACKAGE", tmp_path)
    yield hash_of
    for cached in CACHED:
        cached.cache_clear()


FILES = {
    "a.py": "from bearingwear.part import b\nimport numpy\n",
    "part/__init__.py": "",
    "part/b.py": 'LOOK = "look.mplstyle"\n'
    "def f():\n    try:\n        pass\n    except OSError:\n"
    "        from bearingwear.part.c import x\n",
    "part/c.py": "from bearingwear.a import b\nx = 1\n",  # a circle
    "part/d.py": "",
    "part/look.mplstyle": "",
    "part/notes.txt": "",
    "unused.py": "",
    "typed.py": "",
}


@pytest.mark.parametrize("changed", [name for name in FILES if name != "part/__init__.py"])
def test_a_hash_changes_with_what_is_imported_and_with_nothing_else(hash_of_package, changed):
    """Imports for types alone, and files that no imported module names, do not count."""
    types = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import bearingwear.typed\n"
    files = FILES | {"a.py": FILES["a.py"] + types}
    original_hash = hash_of_package("a", files)
    assert hash_of_package("a", files) == original_hash
    changed_hash = hash_of_package("a", files | {changed: files[changed] + "# changed\n"})
    is_source = changed in ("a.py", "part/b.py", "part/c.py", "part/look.mplstyle")
    assert (changed_hash != original_hash) == is_source
