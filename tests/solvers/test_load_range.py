"""Largest load and pressure of a dynamic case: over balls and instants, instead of their means."""

import re

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from bearingwear.cli import main
from bearingwear.kernels.contact.summary import LOAD, PRESSURE
from bearingwear.kernels.dynamic.record import clear
from bearingwear.kernels.status import OK
from bearingwear.results.netcdf import dataset_of_result, write_result
from bearingwear.solvers.dynamic.run import system_at_start
from bearingwear.solvers.dynamic.windows import LoadRange, TimeRun
from bearingwear.solvers.solve import solve
from bearingwear.solvers.start import start_of
from bearingwear.studies.grid.dynamic_tables import steady_and_dynamic

LOADED = {
    "cage": None,
    "operation.radial_load_N": [0.0, -4.0],
    "model.simulated_turns": 8,
    "model.evaluated_turns": 4,
}
RANGE = ("maximum_pressure", "maximum_contact_load", "minimum_contact_load")


@pytest.fixture(scope="module")
def loaded_case(scene):
    """Returns the result of gyro_s1 under a radial load."""
    result = solve(scene("gyro_s1", LOADED))
    assert result.status == "ok"
    return result


def every_instant(scene, windows):
    """Returns loads [N] and pressures [Pa] (instants, n, 2) of the last window of a run."""
    system, _ = system_at_start(scene, start_of(scene), None)
    run, rows = TimeRun(scene, system, None), []
    for window in range(windows):
        for _ in range(run.grid.window):
            clear(run.recorder.sums)
            assert run.advance(1) == OK
            if window == windows - 1:
                rows.append(run.recorder.sums.contacts.copy())
    return np.array(rows)[..., LOAD], np.array(rows)[..., PRESSURE]


def test_largest_and_smallest_loads_are_those_of_all_instants(scene, loaded_case):
    """The run is repeated in its shortest intervals, whose averages are compared."""
    values = loaded_case.values
    windows = round(values["simulated_turns"] / values["evaluated_turns"])
    loads, pressures = every_instant(scene("gyro_s1", LOADED), windows)
    assert_allclose(values["maximum_contact_load"], loads.max(axis=0), rtol=1e-6)
    assert_allclose(values["minimum_contact_load"], loads.min(axis=0), rtol=1e-6)
    # by the cube root of the load; the contact angle changes the curvatures by a few thousandths
    assert_allclose(values["maximum_pressure"], pressures.max(axis=0), rtol=5e-3)
    assert np.all(values["maximum_pressure"] > 1.05 * pressures.mean(axis=0))  # beyond this error
    assert np.all(values["minimum_contact_load"] < values["contact_load"])
    assert np.all(values["contact_load"] < values["maximum_contact_load"])


def test_load_ranges_are_the_same_without_histories(scene, loaded_case):
    none = {"model.history_points_per_turn": 0, "model.dynamic_solution": "march"}
    bare = solve(scene("gyro_s1", LOADED | none)).values
    assert "history_contact_load" not in bare
    for name in RANGE:
        assert_array_equal(bare[name], loaded_case.values[name])


def test_without_varying_loads_the_range_is_the_mean(scene):
    thrust = scene("gyro_s1", LOADED | {"operation.radial_load_N": [0.0, 0.0]})
    largest, steady = (
        solve(thrust, fidelity).values["maximum_pressure"] for fidelity in ("dynamic", "steady")
    )
    assert_allclose(largest, np.tile(steady, (9, 1)), rtol=1e-4)


def test_pressure_goes_by_the_cube_root_of_the_load():
    """8 and 1 N: roots 2 and 1, whose mean of 1.5 is the mean pressure here; 2 at most."""
    loads = LoadRange(1)
    loads.add(np.array([[[8.0, 0.0]], [[1.0, 0.0]]], dtype="f4"))
    mean_pressure, instants = np.array([[1.5, 0.0]]), 2
    assert_allclose(loads.largest_pressure(mean_pressure, instants), [[2.0, 0.0]])
    assert_array_equal(loads.unloaded, [[0.0, 2.0]])  # instants, of the outer contact all


def test_show_and_tables_take_the_extreme_of_all_balls(loaded_case, tmp_path, capsys):
    """`show` prints largest pressure and load and least load of all balls, and the mean load.

    The table of a study has the largest pressure and the mean load. Sheets have three digits.
    """
    write_result(loaded_case, tmp_path / "case.nc")
    assert main(["show", str(tmp_path / "case.nc")]) == 0
    rows = {line[2:30].strip(): line.split() for line in capsys.readouterr().out.splitlines()}
    values = loaded_case.values
    for label, largest in (
        ("maximum pressure, all balls", 1e-9 * values["maximum_pressure"].max(axis=0)),
        ("maximum load, all balls", values["maximum_contact_load"].max(axis=0)),
        ("minimum load, all balls", values["minimum_contact_load"].min(axis=0)),
        ("contact load", values["contact_load"].mean(axis=0)),
    ):
        shown = [float(text) for text in rows[label] if re.fullmatch(r"[\d.]+", text)]
        assert_allclose(shown[:2], largest, rtol=5e-3)  # three digits
    axes = {"preload_method": 1, "friction": 1, "ball_diameter_loss": 1}
    gathered = dataset_of_result(loaded_case)[[*RANGE, "contact_load"]].expand_dims(axes)
    gathered = gathered.assign_coords({axis: [0.0] for axis in axes})
    both = steady_and_dynamic(gathered.isel(ball=[0]), gathered)
    pressures = both["maximum_pressure.dynamic"].values.ravel()
    assert_allclose(pressures, values["maximum_pressure"].max(axis=0))
    assert_allclose(
        both["contact_load.dynamic"].values.ravel(), values["contact_load"].mean(axis=0)
    )
