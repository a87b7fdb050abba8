"""Gathering of cases, wear life by interpolation, verdict, tables and figures."""

import csv
import json
import os
import shutil
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from support import numbers_in, only_line, scene_file, step, step_arguments

from bearingwear.cli import main
from bearingwear.kernels.status import OK
from bearingwear.plotting.plot import figure_of
from bearingwear.results.netcdf import load, write_result
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.read import load_scene, variant
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.solvers.solve import solve
from bearingwear.studies import STUDY_PLOTS
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.grid.figures import draw as draw_steps
from bearingwear.studies.grid.figures import quasistatic
from bearingwear.studies.grid.figures.overlay import scene_labels
from bearingwear.studies.grid.gather import gathered_study
from bearingwear.studies.grid.grid import Case, Grid
from bearingwear.studies.grid.interpolated import Line, interpolated_life
from bearingwear.studies.grid.life import study_life, wear_life
from bearingwear.studies.grid.tables import study_tables
from bearingwear.studies.solve import solved_variants
from bearingwear.studies.unsolved import unsolved_lines

# 2 methods, 2 frictions, 3 losses [um]
GRID = Grid.from_lists(PRELOAD_METHODS, [0.0, 0.08], [0.0, 0.35, 0.7])
UNDETERMINED = 5  # status
# steps
GATHER, LIFE = "studies.grid.gather.gathered_study", "studies.grid.life.study_life"
TABLES, VERDICT = "studies.grid.tables.study_tables", "studies.unsolved.verdict_text"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Returns the folder of a small study; its cases with a friction of zero are not solved.

    It has `cases/`, the gathered `study.nc` and its lives, `wear_life.nc`.
    """
    folder = tmp_path_factory.mktemp("study")
    for case_id, case in GRID.cases().items():
        scene = variant(scene_file("gyro_s1"), case.changes)
        write_result(solve(scene), folder / "cases" / f"{case_id}.nc")
    cases = [folder / "cases" / f"{case_id}.nc" for case_id in GRID.cases()]
    assert step(GATHER, folder / "study.nc", paths=cases) == 0
    inputs = {"scene": scene_file("gyro_s1"), "study": folder / "study.nc"}
    assert step(LIFE, folder / "wear_life.nc", **inputs) == 0
    return folder


@pytest.fixture
def cases(folder, tmp_path):
    """Returns the paths of copies of the cases, which a test may change."""
    shutil.copytree(folder / "cases", tmp_path / "cases")
    return [tmp_path / "cases" / f"{case_id}.nc" for case_id in GRID.cases()]


def test_study_holds_every_case(folder):
    """A case is at its place on the grid, with the numbers and attributes of its file."""
    gathered = load(folder / "study.nc")
    assert list(gathered["total_qv"].dims) == ["preload_method", "friction", "ball_diameter_loss"]
    assert gathered["ball_diameter_loss"].attrs["units"] == "um"
    for case_id, case in GRID.cases().items():
        method, alone = case.preload_method, load(folder / "cases" / f"{case_id}.nc")
        point = gathered.sel(
            preload_method=PRELOAD_METHODS.index(method),
            friction=case.friction,
            ball_diameter_loss=case.ball_diameter_loss_um,
        )
        assert int(point["status"]) == int(alone["status"]), case_id
        for name in ("total_qv", "contact_load", "ball_diameter_loss_rate"):
            if name in alone:  # cases that were not solved lack some
                assert point[name].attrs == alone[name].attrs
                assert np.array_equal(point[name], alone[name], equal_nan=True)


def test_warnings_are_gathered_once_with_the_cases_counted(folder):
    """The warning of worn grooves counts the solved cases that are not new, and the solved lives.

    Its first number is the largest loss of the cases. No warning stands twice.
    """
    cases, lives = (load(folder / name) for name in ("study.nc", "wear_life.nc"))
    warnings = warnings_in(cases.attrs)
    (worn,) = (warning for warning in warnings if warning["id"] == "groove_worn")
    solved = cases["status"] == OK
    assert len({warning["id"] for warning in warnings}) == len(warnings)
    assert worn["cases"] == int((solved & (cases["ball_diameter_loss"] > 0.0)).sum())
    largest = float(cases["ball_diameter_loss"].max())
    assert numbers_in(worn["sentence"])[0] == pytest.approx(largest)
    (worn,) = (warning for warning in warnings_in(lives.attrs) if warning["id"] == "groove_worn")
    assert worn["cases"] == int((lives["status"] == OK).sum())


def test_failed_cases_are_missing_numbers_with_a_status(folder):
    """All variables but the status are NaN."""
    failed = load(folder / "study.nc").sel(friction=0.0)
    assert np.all(failed["status"] == UNDETERMINED)
    for name, variable in failed.data_vars.items():
        assert name == "status" or np.all(np.isnan(variable)), name


def test_flags_stay_whole_numbers_in_the_file(folder):
    """They have one byte, though some cases were not solved; coordinates have no fill value."""
    with xr.open_dataset(folder / "study.nc", mask_and_scale=False) as raw:
        assert raw["status"].dtype == raw["steady_state_branch"].dtype == np.int8
        assert all("_FillValue" not in raw[name].attrs for name in raw.coords)


def test_gathering_twice_gives_the_same_bytes(folder, cases, tmp_path):
    assert step(GATHER, tmp_path / "again.nc", paths=cases) == 0
    assert (tmp_path / "again.nc").read_bytes() == (folder / "study.nc").read_bytes()


def test_sweeps_over_the_grid_are_gathered_to_the_same_bytes(folder, tmp_path):
    """There is a sweep for each preload method; either order of the axes gives the same file."""
    frictions, losses = (
        ("friction.ball_race", "0,0.08"),
        ("wear.ball_diameter_loss_um", "0,0.35,0.7"),
    )
    words = ["--keep", "study", "--jobs", "1", "-o"]
    for axes in ((frictions, losses), (losses, frictions)):
        paths = [tmp_path / f"{method}.nc" for method in PRELOAD_METHODS]
        for method, path in zip(PRELOAD_METHODS, paths, strict=True):
            options = [word for key, values in axes for word in ("--axis", f"{key}={values}")]
            options += ["--set", f"operation.preload_method={method}"]
            assert main(["sweep", str(scene_file("gyro_s1")), *options, *words, str(path)]) == 0
        assert main(["gather", *map(str, paths), "-o", str(tmp_path / "study.nc")]) == 0
        assert (tmp_path / "study.nc").read_bytes() == (folder / "study.nc").read_bytes()


@pytest.mark.parametrize(
    "words",
    [
        ["--axis", "operation.preload_N=5,7"],
        ["--axis", "friction.ball_race=0.08", "--what", "life"],
        ["--rows", "rows.csv"],
    ],
)
def test_sweeps_that_are_no_grid_of_cases_are_refused(words, tmp_path, monkeypatch, capsys):
    """They have an axis that grids lack, lives in place of cases, or rows in place of axes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rows.csv").write_text("friction.ball_race,wear.ball_diameter_loss_um\n0.08,0\n")
    assert main(["sweep", str(scene_file("gyro_s1")), *words, "--jobs", "1", "-o", "x.nc"]) == 0
    capsys.readouterr()
    assert main(["gather", "x.nc", "-o", "study.nc"]) == 2
    assert only_line(capsys).startswith("x.nc: got another sweep, expected one of")


# kinds of damage: each changes files of cases, and returns the paths to gather and the faulty one


def truncated(paths):
    paths[3].write_bytes(paths[3].read_bytes()[:2000])
    return paths, paths[3]


def missing(paths):
    paths[3].unlink()
    return paths, paths[3]


def given_twice(paths):
    return [*paths, paths[3]], paths[3]


def misnamed(paths):
    """The fourth file has the contents of the third, which is left out."""
    shutil.copy(paths[2], paths[3])
    return [*paths[:2], *paths[3:]], paths[3]


def set_attributes(path, **attributes):
    """Writes a file of a case again with other attributes."""
    with xr.open_dataset(path) as opened:
        dataset = opened.load()
    path.unlink()
    dataset.assign_attrs(attributes).to_netcdf(path)


def of_another_scene(paths):
    scene = load(paths[3]).attrs["scene"]
    set_attributes(paths[3], scene=scene.replace('"ball_count": 9', '"ball_count": 8'))
    return paths, paths[3]


def of_another_solver(paths):
    set_attributes(paths[3], source_hash="0" * 16)
    return paths, paths[3]


@pytest.mark.parametrize(
    "damage",
    [
        truncated, missing, given_twice, misnamed, of_another_scene, of_another_solver,
    ],
)  # fmt: skip
def test_damage_is_named_and_refused(cases, damage, tmp_path, capsys):
    """One line names the faulty file, and nothing is written."""
    paths, faulty = damage(cases)
    output = tmp_path / "study.nc"
    assert step(GATHER, output, paths=paths) == 2
    assert str(faulty) in only_line(capsys)
    assert not output.exists()


# wear life


def line_of(losses, rate, preload, share=0.0, skid=0.0, status=None):
    """Returns a line of a study whose rate and criteria are known functions of the loss.

    losses: (n,) [um].
    rate, preload: of the loss [m/s], and residual [N]; scalars or (n,), as `share` and `skid`.
    share, skid: gyroscopic slip share and skid ratio [1].
    status: (n,), zeros if omitted.
    """
    n = len(losses)
    full = np.broadcast_to
    return xr.Dataset(
        {
            "status": ("ball_diameter_loss", np.zeros(n, int) if status is None else status),
            "ball_diameter_loss_rate": ("ball_diameter_loss", full(rate, n)),
            "residual_preload": ("ball_diameter_loss", full(preload, n)),
            "skid_ratio": ("ball_diameter_loss", full(skid, n)),
            "gyroscopic_slip_share": (
                ("ball_diameter_loss", "ball", "race"),
                # one ball; the inner race does not slip
                np.stack([np.zeros(n), full(share, n)], axis=1)[:, None, :],
            ),
        },
        {"ball_diameter_loss": losses},
    )


LOSSES = np.linspace(0.0, 0.7, 8)  # um
HOUR = 3600.0  # s


def ending(life) -> str:
    """Returns the name of the criterion that ends an interpolated life."""
    return CRITERIA[int(life["interpolated_end_criterion"])]


def test_a_life_at_a_constant_rate_is_loss_over_rate():
    """0.7 um at 1e-12 m/s; the preload stays at 7 N."""
    interpolated = interpolated_life(
        [Line(line_of(LOSSES, 1e-12, 7.0), 7.0)],
        {"preload_fraction": 0.4, "ball_diameter_loss_um": 0.7},
    )
    assert ending(interpolated) == "ball_diameter_loss_um"
    assert_allclose(interpolated["interpolated_loss_at_end"], 0.7e-6, rtol=1e-12)
    assert_allclose(interpolated["interpolated_life"], 0.7e-6 / 1e-12 / HOUR)
    assert_allclose(
        interpolated["interpolated_history_time"][-1], interpolated["interpolated_life"]
    )


def test_life_at_a_falling_rate_ends_where_the_preload_does():
    """The rate is proportional to 1/(1 + x), x being the loss in um: time is the integral of 1 + x.

    The life ends at x = 0.6. It is right to 0.1 %, as rates are interpolated over steps of 0.1 um.
    """
    line = line_of(LOSSES, 1e-12 / (1.0 + LOSSES), 7.0 * (1.0 - LOSSES))
    interpolated = interpolated_life([Line(line, 7.0)], {"preload_fraction": 0.4})
    x = 0.6  # where 40 % of 7 N are left
    assert ending(interpolated) == "preload_fraction"
    assert_allclose(interpolated["interpolated_loss_at_end"], x * 1e-6, rtol=1e-9)
    exact = (x + 0.5 * x * x) * 1e-6 / 1e-12 / HOUR
    assert_allclose(interpolated["interpolated_life"], exact, rtol=1e-3)
    left = interpolated["interpolated_history_residual_preload"][-1]
    assert_allclose(left, 0.4 * 7.0, rtol=1e-9)


def test_the_first_criterion_ends_the_life():
    """Four criteria are met at known losses; the skid ratio counts without its sign."""
    criteria = {
        "preload_fraction": 0.4,
        "gyroscopic_slip_share": 0.5,
        "skid_ratio": 0.1,
        "ball_diameter_loss_um": 0.65,
    }
    # skid is met at 0.4, the slip share at 0.5, and the preload at 0.6 um
    line = line_of(LOSSES, 1e-12, 7.0 * (1.0 - LOSSES), share=LOSSES, skid=-LOSSES / 4.0)
    interpolated = interpolated_life([Line(line, 7.0)], criteria)
    assert ending(interpolated) == "skid_ratio"
    assert_allclose(interpolated["interpolated_loss_at_end"], 0.4e-6, rtol=1e-9)


def test_a_criterion_met_at_once_is_a_life_of_nothing():
    """2 N are left of 7 N from the start, less than 40 %: the life is zero."""
    interpolated = interpolated_life(
        [Line(line_of(LOSSES, 1e-12, 2.0), 7.0)], {"preload_fraction": 0.4}
    )
    assert np.all(interpolated["interpolated_life"] == 0.0)


@pytest.mark.parametrize(
    ("line", "criteria"),
    [
        (line_of(LOSSES, 1e-12, 7.0), {"preload_fraction": 0.4}),  # never met
        (line_of(LOSSES + 0.1, 1e-12, 7.0), {"ball_diameter_loss_um": 0.7}),  # no fresh case
        (line_of(LOSSES[:1], 1e-12, 7.0), {"ball_diameter_loss_um": 0.7}),  # one case
        (
            line_of(LOSSES, 1e-12, 7.0, status=(LOSSES > 0.3).astype(int)),
            {"ball_diameter_loss_um": 0.7},
        ),  # not solved up to there
    ],
)
def test_no_life_where_the_study_does_not_reach(line, criteria):
    """The interpolated life is NaN, and no criterion ends it."""
    interpolated = interpolated_life([Line(line, 7.0)], criteria)
    assert np.all(np.isnan(interpolated["interpolated_life"]))
    assert ending(interpolated) == "none"


def test_interpolated_lives_agree_with_followed_ones(folder):
    """Under a constant force they agree to 1e-6, as the rate hardly changes.

    In a fixed position, three losses interpolate the life to 3 %. `life_route_difference` is the
    relative difference of both lives.
    """
    lives = load(folder / "wear_life.nc")
    solved = lives.sel(friction=0.08)
    assert np.all(lives["status"].sel(friction=0.0) == UNDETERMINED)
    assert np.all(solved["status"] == OK)
    assert np.all(np.isfinite(solved["life"])) and np.all(solved["life"] > 0.0)
    assert np.all(abs(solved["life_route_difference"].sel(preload_method=0)) < 1e-6)
    assert np.all(abs(solved["life_route_difference"]) < 0.03)
    assert "history_residual_preload" in lives


def solved_cases(scene, losses, folder):
    """Writes a scene and its cases at friction 0.08 and some losses [um]; returns the paths."""
    mine = folder / "mine.yaml"
    mine.write_text(json.dumps(scene.to_dict()), encoding="utf-8")
    cases = [Case(method, 0.08, loss) for method in PRELOAD_METHODS for loss in losses]
    paths = [folder / f"{case.id}.nc" for case in cases]
    results = solved_variants(mine, [case.changes for case in cases])
    for path, result in zip(paths, results, strict=True):
        write_result(result, path)
    return mine, paths


def lives_between_cases(scene, losses, folder):
    """Returns the dataset of lives of a scene, followed, and interpolated between losses [um]."""
    mine, paths = solved_cases(scene, losses, folder)
    return wear_life(mine, gathered_study(paths))


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param({}, id="single"),
        pytest.param({"arrangement": {"kind": "spring_pair"}}, id="pair", marks=pytest.mark.long),
        pytest.param({"wear.counts": "ball"}, id="balls", marks=pytest.mark.long),
    ],
)
def test_interpolated_lives_agree_with_followed_ones_over_a_duty(kind, tmp_path):
    """Lives agree to 0.2 %, the error of losses 0.1 um apart; criterion and last preload are equal.

    The preload is that of the phase that ends the life, and not of the nominal one. The duty
    changes lives by 10 % or more; a duty of the nominal phase alone changes nothing.
    """
    changes = {
        "uncertainty": None,
        "cage": None,
        "model.contact": "hertz",
        "cases": {
            "idle": {"operation.shaft_speed_rpm": 6000.0},
            "hot": {"friction.ball_race": 0.05, "operation.shaft_speed_rpm": 36000.0},
        },
    }
    phases = {
        "idle": {"hours": 1.0, "starts": 2.0},
        "nominal": {"hours": 6.5},
        "hot": {"hours": 0.5},
    }
    alone = load_scene(scene_file("gyro_s1")).with_(changes | kind)
    over_duty = alone.with_({"duty": {"phases": phases, "start_s": 200.0, "stop_s": 600.0}})
    losses = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    lives = lives_between_cases(over_duty, losses, tmp_path)
    assert np.all(abs(lives["life_route_difference"]) < 2e-3)
    assert np.all(lives["interpolated_end_criterion"] == lives["end_criterion"])
    ends = lives["interpolated_history_residual_preload"].isel(interpolated_step=-1)
    left = lives["history_residual_preload"].isel(preload_method=1)
    assert_allclose(ends.isel(preload_method=1), left.min(), rtol=1e-2)
    without_duty = lives_between_cases(alone, losses, tmp_path)
    ratio = lives["interpolated_life"] / without_duty["interpolated_life"]
    assert np.all(abs(ratio - 1.0) > 0.1)
    one_phase = alone.with_({"duty": {"phases": {"nominal": {"hours": 3.0}}}})
    of_one_phase = lives_between_cases(one_phase, losses, tmp_path)
    assert np.all(of_one_phase["interpolated_life"] == without_duty["interpolated_life"])


def test_a_phase_that_tells_bearings_apart_has_no_interpolated_life(tmp_path):
    """A force on the rotor in one phase wears them unlike; the life is followed all the same."""
    changes = {
        "uncertainty": None,
        "cage": None,
        "model.contact": "hertz",
        "arrangement": {"kind": "spring_pair"},
        "cases": {"pushed": {"arrangement.external_axial_N": 1.0}},
        "duty": {"phases": {"nominal": {"hours": 1.0}, "pushed": {"hours": 1.0}}},
    }
    scene = load_scene(scene_file("gyro_s1")).with_(changes)
    lives = lives_between_cases(scene, [0.0, 0.35, 0.7], tmp_path)
    assert np.all(lives["status"] == OK) and bool(lives["interpolated_life"].isnull().all())


def pair_study(force, folder):
    """Writes a study of a pair under an external force [N] and its lives; returns their paths."""
    pair = {"kind": "spring_pair", "external_axial_N": force}
    changes = {"arrangement": pair, "wear.counts": "ball"}
    scene = load_scene(scene_file("gyro_s1")).with_(changes)
    mine, paths = solved_cases(scene, (0.0, 0.35, 0.7), folder)
    gathered, lives = folder / "study.nc", folder / "wear_life.nc"
    write_dataset(gathered_study(paths), gathered)
    write_dataset(study_life(mine, gathered), lives)
    return gathered, lives


@pytest.fixture(scope="module")
def alike_pair_study(tmp_path_factory):
    """Returns the paths of a study and of lives of a pair that wears alike."""
    return pair_study(0.0, tmp_path_factory.mktemp("alike"))


@pytest.fixture(scope="module")
def unlike_pair_study(tmp_path_factory):
    """Returns the paths of a study and of lives of a pair under 1 N, which wears unlike."""
    return pair_study(1.0, tmp_path_factory.mktemp("unlike"))


def figure_words(path, bearing):
    """Returns the words of the titles of the figure of a file, with single spaces.

    bearing: `first` or `second` of a pair, or None.
    """
    figure = figure_of(load(path), path, STUDY_PLOTS, bearing)
    titles = figure.get_suptitle(), figure.axes[0].get_title(loc="left")
    return " ".join(" ".join(titles).split())


def test_alike_bearings_of_a_pair_have_interpolated_lives_and_one_figure(alike_pair_study):
    """Titles and summary name no bearing, and pairs in place of preload methods.

    Three losses interpolate lives to 3 %. The table of cases has columns of both bearings.
    """
    gathered, lives = alike_pair_study
    dataset = load(lives)
    assert np.all(dataset["status"] == OK) and dataset["loss_at_end"].dims[-1] == "bearing"
    assert np.all(abs(dataset["life_route_difference"]) < 0.03)
    rows, summary = study_tables(gathered, lives)
    assert "contact_load.second" in rows.partition("\n")[0]
    assert "QV, second bearing" not in summary and "| rigid pair |" in summary
    for path in alike_pair_study:
        words = figure_words(path, None)
        assert " bearing" not in words.partition(":")[0] and "fixed position" not in words


def test_unlike_bearings_of_a_pair_have_figures_of_their_own(unlike_pair_study):
    """They have no interpolated lives (NaN), for which a grid of two losses would be needed."""
    gathered, lives = unlike_pair_study
    dataset = load(lives)
    assert np.all(dataset["status"] == OK)
    assert bool(dataset["life_route_difference"].isnull().all())
    _, summary = study_tables(gathered, lives)
    assert "QV, second bearing" in summary and "| rigid pair |" in summary
    for bearing in ("first", "second"):
        for path in unlike_pair_study:
            words = figure_words(path, bearing)
            assert f"gyro_s1, {bearing} bearing" in words and "fixed position" not in words
        assert "rigid pair" in figure_words(gathered, bearing)


# verdict, tables, figures


def test_the_verdict_fails_with_the_cases_and_lives_that_are_not_solved(folder, tmp_path, capsys):
    """Half of 12 cases and of 4 lives, those without friction: status 3, and no file."""
    files = [str(folder / name) for name in ("study.nc", "wear_life.nc")]
    checked, unsolved = unsolved_lines(files)
    assert checked == 12 + 4 and len(unsolved) == 6 + 2
    assert "cases/fixed_position-mu0.000-loss0.35.nc: undetermined" in unsolved[4]
    assert step(VERDICT, tmp_path / "verdict.txt", paths=files) == 3
    assert capsys.readouterr().err.startswith("8 of 16 not solved:\n")
    assert not (tmp_path / "verdict.txt").exists()


def test_the_verdict_warns_where_the_study_says_so(folder, tmp_path, capsys):
    """With `unsolved_is: warning` the step succeeds, and the verdict has the list."""
    files = [str(folder / name) for name in ("study.nc", "wear_life.nc")]
    settings = {"unsolved_is": "warning"}
    assert step(VERDICT, tmp_path / "verdict.txt", paths=files, settings=settings) == 0
    assert capsys.readouterr().err.startswith("warning: 8 of 16 not solved:\n")
    assert (tmp_path / "verdict.txt").read_text().startswith("8 of 16 not solved:\n")


def test_a_case_has_no_verdict(cases, capsys):
    """Its file is refused by name, as is a file without a status: a verdict is of studies."""
    assert step(VERDICT, "verdict.txt", paths=cases[:1]) == 2
    assert capsys.readouterr().err == f"{cases[0]}: not a study\n"
    dataset = load(cases[0]).drop_vars("status")
    cases[0].unlink()
    write_dataset(dataset, cases[0])
    assert step(VERDICT, "verdict.txt", paths=cases[:1]) == 2
    assert capsys.readouterr().err == f"{cases[0]}: not a study\n"


def test_the_tables_have_every_case_and_the_status_of_those_not_solved(folder, tmp_path):
    """Numbers of the last case are those of its file; cells of unsolved cases are empty, not NaN.

    Heads of stiffness have its terms with their units.
    """
    files = {"study": folder / "study.nc", "lives": folder / "wear_life.nc"}
    outputs = [tmp_path / "cases.csv", tmp_path / "summary.md"]
    assert step(TABLES, *outputs, **files) == 0
    with outputs[0].open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    assert {row["status"] for row in rows} == {"ok", "undetermined"}
    solved = load(folder / "cases" / "fixed_position-mu0.080-loss0.70.nc")
    row = rows[-1]
    assert float(row["qv.inner (W)"]) == pytest.approx(float(solved["qv"][0, 0]), rel=1e-8)
    assert rows[0]["total_qv (W)"] == "" and "nan" not in outputs[0].read_text()
    for term in ("y.z (N m-1)", "tilt_y.z (N)", "axial.tilt_z (N)", "tilt_z.tilt_z (N m)"):
        assert f"stiffness_matrix.{term}" in row and f"quasistatic_stiffness_matrix.{term}" in row
    summary = outputs[1].read_text()
    assert summary.count("µm: undetermined") == 6
    # no description follows: edited alone, it makes no result again, and would be outdated here
    assert summary.startswith("# gyro_s1\n\n## ")


# inputs and settings of the steps that draw figures, by their names
FIGURES = {
    "friction": ({"study": "study.nc"}, {"loss_um": 0.7}),
    "wear": ({"studies": ["study.nc"]}, {"friction": [0, 0.08]}),
    "life": ({"lives": "wear_life.nc"}, {"friction": [0, 0.08]}),
    "overlay": ({"studies": ["study.nc", "study.nc"]}, {"friction": 0.08}),
    "life_overlay": ({"lives": ["wear_life.nc", "wear_life.nc"]}, {"friction": 0.08}),
    "slip": (
        {
            "cases": [
                f"cases/{method}-mu{mu}-loss0.70.nc"
                for method in PRELOAD_METHODS
                for mu in ("0.000", "0.080")
            ]
        },
        {},
    ),
}


def inside(folder, inputs):
    """Returns the inputs of a step as paths in a folder.

    inputs: names of files, or lists of them, by arguments of the step.
    """
    return {
        name: folder / value if isinstance(value, str) else [folder / file for file in value]
        for name, value in inputs.items()
    }


def draw(name, *outputs, folder) -> int:
    """Draws a figure of FIGURES from files in a folder; returns the status of the step."""
    inputs, settings = FIGURES[name]
    return step(
        f"studies.grid.figures.draw.draw_{name}",
        *outputs,
        settings=settings,
        **inside(folder, inputs),
    )


def test_a_figure_is_the_same_bytes_twice(folder, tmp_path):
    """This applies to SVG and to PNG."""
    for copy in ("a", "b"):
        outputs = [tmp_path / f"{copy}.{suffix}" for suffix in ("svg", "png")]
        assert draw("friction", *outputs, folder=folder) == 0
    for suffix in ("svg", "png"):
        assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


def test_failed_cases_are_marked_by_crosses(folder):
    """Both methods have one at the friction zero, and the legend has an entry for them."""
    drawn = quasistatic.friction_figure(load(folder / "study.nc"), 0.7)
    texts = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert "not solved" in texts
    crosses = [line for line in drawn.axes[0].lines if line.get_marker() == "x"]
    assert [line.get_xdata().tolist() for line in crosses] == [[0.0], [0.0]]


# outputs and inputs of steps that write netCDF, a figure, and two tables
WRITERS = {
    GATHER: (["out.nc"], {"paths": [f"cases/{case_id}.nc" for case_id in GRID.cases()]}),
    "studies.grid.figures.draw.draw_life": (["f.svg"], {"lives": "wear_life.nc"}),
    TABLES: (["cases.csv", "summary.md"], {"study": "study.nc", "lives": "wear_life.nc"}),
}


def test_no_room_leaves_nothing_half_written(folder, tmp_path, monkeypatch, capsys):
    """With files of 4000 bytes at most, each step ends with status 2 and one line.

    Files from before stay as they are, and nothing lies beside them.
    """
    resource = pytest.importorskip("resource")
    monkeypatch.chdir(tmp_path)
    steps, names = [], []
    for run, (outputs, inputs) in WRITERS.items():
        settings = {"friction": [0.08]} if run.endswith("draw_life") else {}
        paths = inside(folder, inputs)
        steps.append(step_arguments(run, *outputs, settings=settings, **paths))
        names += outputs
    for name in names:
        (tmp_path / name).write_text("from before")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, limits[1]))
    try:
        statuses = [main(arguments) for arguments in steps]
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert statuses == [2] * len(steps)
    assert capsys.readouterr().err.splitlines() == [
        f"{outputs[0]}: cannot be written (File too large)" for outputs, _ in WRITERS.values()
    ]
    assert sorted(os.listdir(tmp_path)) == sorted(names)
    assert all((tmp_path / name).read_text() == "from before" for name in names)


# a name that is markup of TeX and of HTML
HOSTILE = '$\\frac{$<script>alert("&")</script>--> x_1^2'


@pytest.fixture(scope="module")
def unsolved_folder(folder, tmp_path_factory):
    """Returns the folder of the cases without friction and their study; none is solved."""
    unsolved = tmp_path_factory.mktemp("unsolved")
    (unsolved / "cases").mkdir()
    for path in sorted((folder / "cases").glob("*-mu0.000-*.nc")):
        shutil.copy(path, unsolved / "cases")
    gathered = gathered_study(sorted((unsolved / "cases").iterdir()))
    write_dataset(gathered, unsolved / "study.nc")
    write_dataset(wear_life(scene_file("gyro_s1"), gathered), unsolved / "wear_life.nc")
    return unsolved


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("name", "where"), [*((name, "unsolved_folder") for name in FIGURES), ("wear", "folder")]
)
def test_figures_show_failed_cases_and_names_as_text(name, where, request, tmp_path, monkeypatch):
    """The name HOSTILE, which only a file from elsewhere can have, makes no script in an SVG.

    Every figure is drawn without a warning from cases of which none is solved. The figure of wear
    is also drawn from a study of which some are.

    where: fixture of the folder.
    """

    def renamed(path, **axes):
        dataset = load(path)
        scene = json.loads(dataset.attrs["scene"]) | {"name": HOSTILE}
        return dataset.assign_attrs(scene=json.dumps(scene))

    monkeypatch.setattr(draw_steps, "load_with_axes", renamed)
    inputs, settings = FIGURES[name]
    if where == "unsolved_folder":  # which has nothing with a friction of 0.08
        if "cases" in inputs:
            inputs = {"cases": [case for case in inputs["cases"] if "mu0.080" not in case]}
        if "friction" in settings:
            settings = {"friction": [0] if isinstance(settings["friction"], list) else 0}
    run, figure = f"studies.grid.figures.draw.draw_{name}", tmp_path / "figure.svg"
    paths = inside(request.getfixturevalue(where), inputs)
    assert step(run, figure, settings=settings, **paths) == 0
    nodes = ElementTree.parse(figure).iter()
    assert not [node for node in nodes if str(node.tag).endswith("}script")]


def test_a_figure_of_what_the_file_has_not_is_refused_in_one_line(folder, tmp_path, capsys):
    """Refused are a friction that is not on the grid, and a study of cases in place of lives."""
    path, output = folder / "study.nc", tmp_path / "figure.svg"
    wear, life = "studies.grid.figures.draw.draw_wear", "studies.grid.figures.draw.draw_life"
    assert step(wear, output, studies=[path], settings={"friction": [0.03]}) == 2
    assert capsys.readouterr().err == f"{path}: friction: got 0.03, expected 0, 0.08\n"
    assert step(life, output, lives=path, settings={"friction": [0.08]}) == 2
    assert "interpolated_step" in capsys.readouterr().err
    assert not output.exists()


@pytest.mark.parametrize("name", ["figure.foo", "figure", "figure.gif"])
def test_a_figure_in_an_unknown_format_is_refused_before_any_is_drawn(
    name, folder, tmp_path, capsys
):
    """name: of the second of two outputs; the first, an SVG, is not written either."""
    case = folder / "cases" / "constant_force-mu0.080-loss0.00.nc"
    outputs = [tmp_path / "figure.svg", tmp_path / name]
    assert step("studies.grid.figures.draw.draw_slip", *outputs, cases=[case]) == 2
    assert only_line(capsys).startswith(f"{outputs[1]}: got the suffix ")
    assert os.listdir(tmp_path) == []


def test_labels_leave_out_what_a_case_does_not_depend_on():
    """Scenes that differ in drag are labelled by it, though one also says how uncertain drag is.

    A distribution does not change a case.
    """
    names = ("gyro_s1", "gyro_s1_drag200", "gyro_s1_drag400")
    scenes = [load_scene(scene_file(name)).to_dict() for name in names]
    for scene in scenes:
        del scene["friction"]["ball_race"]  # varied by the study
    assert scene_labels(scenes) == [
        f"{name}: drag density {drag} kg/m³"
        for name, drag in zip(names, (0, 200, 400), strict=True)
    ]
