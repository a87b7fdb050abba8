"""Figures of `bearingwear plot` for the kinds of files of this study.

No step calls this, so what it imports makes no figure of the study outdated.
"""

import xarray as xr

from bearingwear.plotting.drawing import (
    Figure,
    frame,
    key,
    new_figure,
)
from bearingwear.results.units import digits, display, span
from bearingwear.results.words import plain_scene
from bearingwear.studies.grid.figures import quasistatic
from bearingwear.studies.grid.gather import axis_coordinates
from bearingwear.studies.grid.grid import Grid

LIFE_AXES = ("preload_method", "friction")


def case_plot(case: xr.Dataset) -> Figure:
    """Draws slip over the contact ellipse, or the histories of a dynamic case."""
    return _histories(case) if "history_contact_load" in case else quasistatic.slip_figure([case])


def _histories(case: xr.Dataset) -> Figure:
    """Draws loads and slip of every ball, QV and preload over the simulated time."""
    load, slip, qv = (case[f"history_{name}"] for name in ("contact_load", "slip", "contact_qv"))
    total = qv.astype(float).sum(["ball", "race"], skipna=False)
    time, power = display("s", case["time"]), display("W", total)
    ball_look = {"color": "C2", "linewidth": 0.6}
    bearing_look = {"color": "black", "linewidth": 0.9}
    panels_shown = {
        "contact load,\ninner race (N)": (load.isel(race=0), ball_look),
        "contact load,\nouter race (N)": (load.isel(race=1), ball_look),
        "slip speed,\ninner race (m/s)": (slip.isel(race=0), ball_look),
        "slip speed,\nouter race (m/s)": (slip.isel(race=1), ball_look),
        power.label("QV of the bearing"): (power.of(total), bearing_look),
        "residual preload (N)": (case["history_residual_preload"], bearing_look),
    }
    figure, panels = new_figure(3, 2, 7.2, 6.4, sharex=True)
    for panel, (label, (values, look)) in zip(panels.flat, panels_shown.items(), strict=True):
        panel.plot(time.of(case["time"]), values, **look)
        panel.set_ylabel(label)
    for panel in panels[-1]:
        panel.set_xlabel(time.label("time"))
    name, turns = plain_scene(case)["name"], digits(float(case["simulated_turns"]))
    frame(
        figure,
        f"{name}: contact loads of {span(load.values.ravel())} N over {turns} turns",
        [key("each ball", **ball_look), key("whole bearing", **bearing_look)],
        columns=2,
    )
    return figure


def study_plot(study: xr.Dataset) -> Figure:
    """Draws QV, preload, angles and wear rates, a column for each friction coefficient."""
    frictions = study["friction"].values.tolist()
    return quasistatic.wear_figure([study.sel(friction=[mu]) for mu in frictions], frictions)


def lives_plot(lives: xr.Dataset) -> Figure:
    """Draws wear and preload over the life."""
    return quasistatic.life_figure(lives, lives["friction"].values.tolist())


def life_plot(life: xr.Dataset) -> Figure:
    """Draws wear over a life, by phases, parts (dynamic model), worn grooves, or as in a study."""
    if "history_phase_worn_share" in life:
        from bearingwear.studies.lives.duty_figure import duty_figure

        return duty_figure(life)
    from bearingwear.studies.lives.figures import groove_figure, history_figure

    if life.attrs["fidelity"] == "dynamic":
        return history_figure(life)
    if "groove_depth" in life:
        return groove_figure(life)
    scene = plain_scene(life)
    method, friction = scene["operation"]["preload_method"], scene["friction"].get("ball_race")
    if friction is None:  # a film, whose friction depends on the pressure: its mean when new
        friction = round(float(life["history_friction_coefficient"].isel(step=0).mean()), 3)
    grid = Grid((method,), (friction,), (0.0,))
    axes = {name: axis for name, axis in axis_coordinates(grid).items() if name in LIFE_AXES}
    return quasistatic.life_figure(life.expand_dims([*axes]).assign_coords(axes), [friction])
