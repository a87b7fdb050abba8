"""Kernels of lives are compiled in a process beside the first command."""

import pytest

from bearingwear.cli import main
from bearingwear.kernels.steady.thrust import thrust_case
from bearingwear.kernels.worn import pressure, state
from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.solve import solve
from bearingwear.studies import ahead

KERNELS = pressure.contact_cells, state.worn_state


@pytest.fixture
def file(tmp_path):
    path = str(tmp_path / "mine.yaml")
    assert main(["new", path, "7008C", "--speed", "18000"]) == 0
    return path


def test_types_are_those_of_a_life_and_known_before_a_steady_solve(file, monkeypatch):
    class Solved(Exception):
        pass

    def solve(*_):
        raise Solved

    with monkeypatch.context() as patched, pytest.raises(Solved):
        patched.setattr(ThrustProblem, "solve", solve)
        ahead.compile_life(file, ())
    assert all(kernel.overloads for kernel in KERNELS)
    before = [set(kernel.overloads) for kernel in KERNELS]
    life(load_scene(file))
    for kernel, known in zip(KERNELS, before, strict=True):
        assert set(kernel.overloads) == known


def test_search_is_compiled_with_the_solve_for_the_types_it_is_called_with(file):
    solve(load_scene(file))
    ((search, types_of),) = thrust_case.companions
    assert search.overloads
    assert set(search.overloads) <= {types_of(*types) for types in thrust_case.overloads}


def test_one_process_that_ends_with_its_command(file, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(ahead, "code_folder", lambda: str(tmp_path))
    monkeypatch.setattr(ahead, "usable_cores", lambda: 2)
    monkeypatch.setattr(ahead, "is_compiled", lambda kernel: False)
    process = ahead._started(file, ())
    assert ahead._started(file, ()) is None
    process.stdin.close()  # as where the command is killed
    assert process.wait(timeout=30) == 1
    with pytest.raises(KeyboardInterrupt), ahead.compiled_beside(file, ()):
        assert ahead._started(file, ()) is None
        raise KeyboardInterrupt
    monkeypatch.setattr(ahead, "usable_cores", lambda: 1)
    with ahead.compiled_beside(file, ()):
        process = ahead._started(file, ())
    process.kill()
    process.wait()
