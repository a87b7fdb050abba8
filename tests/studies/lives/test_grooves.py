"""A life with worn grooves from the command line: its sheet and its figure."""

from support import only_line, scene_file

from bearingwear.cli import main
from bearingwear.results.netcdf import load


def test_a_life_with_worn_grooves_has_their_depth_in_sheet_figure_and_file(tmp_path, capsys):
    """The life ends at a loss of 0.1 um, for which few steps are enough."""
    file = tmp_path / "life.nc"
    sets = ["--set=model.contact=worn", "--set=wear.end_of_life.ball_diameter_loss_um=0.1"]
    assert main(["life", str(scene_file("gyro_s1")), "-o", str(file), *sets]) == 0
    output, errors = capsys.readouterr()
    assert "deepest groove" in output and "total approach" in output
    # with contact `paper` a warning says that contacts stay Hertzian while their grooves wear
    assert "Hertzian" not in errors
    assert main(["plot", str(file), "-o", str(tmp_path / "life.svg")]) == 0
    drawn = (tmp_path / "life.svg").read_text()
    assert "inner groove" in drawn
    dataset = load(file)
    assert dataset["groove_depth"].dims == ("groove_state", "race", "arc")
    assert dataset["groove_depth"].sizes["groove_state"] >= 3  # new, worn, and one between


def test_a_life_that_cannot_follow_grooves_is_refused_in_one_line(tmp_path, capsys):
    """Grooves wear only where races count as well as balls."""
    sets = ["--set=model.contact=worn", "--set=wear.counts=ball"]
    out = str(tmp_path / "life.nc")
    assert main(["life", str(scene_file("gyro_s1")), "-o", out, *sets]) == 2
    assert "wear.counts ball" in only_line(capsys)
