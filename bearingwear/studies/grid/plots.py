"""What `bearingwear plot` draws of the kinds of files that this study knows.

No step draws so: what is imported here makes no figure of the study outdated.
"""

import xarray as xr

from bearingwear.plotting.drawing import Figure, scene_of
from bearingwear.studies.grid import figures
from bearingwear.studies.grid.gather import axis_coordinates
from bearingwear.studies.grid.grid import Grid

LIFE_AXES = ("preload_method", "friction")


def case_plot(case: xr.Dataset) -> Figure:
    """Slip over the contact ellipse."""
    return figures.slip_figure([case])


def study_plot(study: xr.Dataset) -> Figure:
    """QV, preload, angles and rate of wear, a column for each coefficient of friction."""
    frictions = study["friction"].values.tolist()
    return figures.wear_figure([study.sel(friction=[mu]) for mu in frictions], frictions)


def lives_plot(lives: xr.Dataset) -> Figure:
    """Wear and preload over the life."""
    return figures.life_figure(lives, lives["friction"].values.tolist())


def life_plot(life: xr.Dataset) -> Figure:
    """Wear over one life: as that of a study, or of the parts where the dynamic model solved it."""
    from bearingwear.studies.lives.figures import history_figure

    if life.attrs["fidelity"] == "dynamic":
        return history_figure(life)
    scene = scene_of(life)
    method, mu = scene["operation"]["preload_method"], scene["friction"]["ball_race"]
    grid = Grid((method,), (mu,), (0.0,))
    axes = {name: axis for name, axis in axis_coordinates(grid).items() if name in LIFE_AXES}
    return figures.life_figure(life.expand_dims([*axes]).assign_coords(axes), [mu])
