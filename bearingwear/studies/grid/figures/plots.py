"""Figures of `bearingwear plot` for the kinds of files of this study.

No step calls this, so what it imports makes no figure of the study outdated.
"""

import xarray as xr

from bearingwear.plotting.drawing import Figure, frame, key, new_figure
from bearingwear.results.units import digits, display, span
from bearingwear.results.words import plain_scene
from bearingwear.studies.grid.figures import quasistatic
from bearingwear.studies.grid.gather import axis_coordinates
from bearingwear.studies.grid.grid import Grid

LIFE_AXES = ("preload_method", "friction")


def case_plot(case: xr.Dataset) -> Figure:
    """Returns a figure of a case: slip over its contact ellipses, or histories if it is dynamic."""
    if "history_contact_load" in case:
        return _history_figure(case)
    return quasistatic.slip_figure([case])


def _history_figure(case: xr.Dataset) -> Figure:
    """Returns a figure of loads and slip of every ball, QV and preload over the simulated time.

    QV is the sum over all contacts.

    case: dynamic case.
    """
    load = case["history_contact_load"]
    slip = case["history_slip"]
    total_qv = case["history_contact_qv"].astype(float).sum(["ball", "race"], skipna=False)
    time_unit = display("s", case["time"])
    power = display("W", total_qv)
    ball_look = {"color": "C2", "linewidth": 0.6}
    bearing_look = {"color": "black", "linewidth": 0.9}
    lines_by_label = {
        "contact load,\ninner race (N)": (load.isel(race=0), ball_look),
        "contact load,\nouter race (N)": (load.isel(race=1), ball_look),
        "slip speed,\ninner race (m/s)": (slip.isel(race=0), ball_look),
        "slip speed,\nouter race (m/s)": (slip.isel(race=1), ball_look),
        power.label("QV of the bearing"): (power.of(total_qv), bearing_look),
        "residual preload (N)": (case["history_residual_preload"], bearing_look),
    }
    figure, panels = new_figure(3, 2, 7.2, 6.4, sharex=True)
    for panel, (label, (values, look)) in zip(panels.flat, lines_by_label.items(), strict=True):
        panel.plot(time_unit.of(case["time"]), values, **look)
        panel.set_ylabel(label)
    for panel in panels[-1]:
        panel.set_xlabel(time_unit.label("time"))
    name = plain_scene(case)["name"]
    turns = digits(float(case["simulated_turns"]))
    frame(
        figure,
        f"{name}: contact loads of {span(load.values.ravel())} N over {turns} turns",
        [key("each ball", **ball_look), key("whole bearing", **bearing_look)],
        columns=2,
    )
    return figure


def study_plot(study: xr.Dataset) -> Figure:
    """Returns a figure of the cases of a study against wear, a column for each friction."""
    frictions = study["friction"].values.tolist()
    return quasistatic.wear_figure([study.sel(friction=[mu]) for mu in frictions], frictions)


def lives_plot(lives: xr.Dataset) -> Figure:
    """Returns a figure of wear and residual preload over the lives of a study."""
    return quasistatic.life_figure(lives, lives["friction"].values.tolist())


def life_plot(life: xr.Dataset) -> Figure:
    """Returns a figure of a life.

    It shows the phases of a duty, if any, else the parts that wear (dynamic model), else worn
    grooves. A file without any of these has wear and residual preload over time.
    """
    if "history_phase_worn_share" in life:
        from bearingwear.studies.lives.duty_figure import duty_figure

        return duty_figure(life)
    from bearingwear.studies.lives.figures import groove_figure, history_figure

    if life.attrs["fidelity"] == "dynamic":
        return history_figure(life)
    if "groove_depth" in life:
        return groove_figure(life)
    scene = plain_scene(life)
    method = scene["operation"]["preload_method"]
    friction = scene["friction"].get("ball_race")
    if friction is None:  # a film, whose friction depends on the pressure: its mean when new
        friction = round(float(life["history_friction_coefficient"].isel(step=0).mean()), 3)
    grid = Grid((method,), (friction,), (0.0,))
    axes = {name: axis for name, axis in axis_coordinates(grid).items() if name in LIFE_AXES}
    return quasistatic.life_figure(life.expand_dims([*axes]).assign_coords(axes), [friction])
