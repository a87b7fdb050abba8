"""What `bearingwear plot` draws of the kinds of files that this study knows.

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
from bearingwear.results.words import scene_of
from bearingwear.studies.grid.figures import quasistatic
from bearingwear.studies.grid.gather import axis_coordinates
from bearingwear.studies.grid.grid import Grid

LIFE_AXES = ("preload_method", "friction")


def case_plot(case: xr.Dataset) -> Figure:
    """Slip over the contact ellipse; of a dynamic case, its histories."""
    return _histories(case) if "history_contact_load" in case else quasistatic.slip_figure([case])


def _histories(case: xr.Dataset) -> Figure:
    """Loads and slip of every ball, QV and preload over the simulated time."""
    load, slip, qv = (case[f"history_{name}"] for name in ("contact_load", "slip", "contact_qv"))
    total = qv.astype(float).sum(["ball", "race"], skipna=False)
    time, power = display("s", case["time"]), display("W", total)
    balls, whole = {"color": "C2", "linewidth": 0.6}, {"color": "black", "linewidth": 0.9}
    drawn = {
        "contact load,\ninner race (N)": (load.isel(race=0), balls),
        "contact load,\nouter race (N)": (load.isel(race=1), balls),
        "slip speed,\ninner race (m/s)": (slip.isel(race=0), balls),
        "slip speed,\nouter race (m/s)": (slip.isel(race=1), balls),
        power.label("QV of the bearing"): (power.of(total), whole),
        "residual preload (N)": (case["history_residual_preload"], whole),
    }
    figure, panels = new_figure(3, 2, 7.2, 6.4, sharex=True)
    for panel, (label, (values, look)) in zip(panels.flat, drawn.items(), strict=True):
        panel.plot(time.of(case["time"]), values, **look)
        panel.set_ylabel(label)
    for panel in panels[-1]:
        panel.set_xlabel(time.label("time"))
    name, turns = scene_of(case)["name"], digits(float(case["simulated_turns"]))
    frame(
        figure,
        f"{name}: contact loads of {span(load.values.ravel())} N over {turns} turns",
        [key("each ball", **balls), key("whole bearing", **whole)],
        columns=2,
    )
    return figure


def study_plot(study: xr.Dataset) -> Figure:
    """QV, preload, angles and rate of wear, a column for each coefficient of friction."""
    frictions = study["friction"].values.tolist()
    return quasistatic.wear_figure([study.sel(friction=[mu]) for mu in frictions], frictions)


def lives_plot(lives: xr.Dataset) -> Figure:
    """Wear and preload over the life."""
    return quasistatic.life_figure(lives, lives["friction"].values.tolist())


def life_plot(life: xr.Dataset) -> Figure:
    """Wear over one life: as that of a study, the grooves where they were followed, or the parts
    where the dynamic model solved it."""
    if "history_phase_worn_share" in life:
        from bearingwear.studies.lives.duty_figure import duty_figure

        return duty_figure(life)
    from bearingwear.studies.lives.figures import groove_figure, history_figure

    if life.attrs["fidelity"] == "dynamic":
        return history_figure(life)
    if "groove_depth" in life:
        return groove_figure(life)
    scene = scene_of(life)
    method, mu = scene["operation"]["preload_method"], scene["friction"].get("ball_race")
    if mu is None:  # a film, whose friction follows the pressure: its mean when new
        mu = round(float(life["history_friction_coefficient"].isel(step=0).mean()), 3)
    grid = Grid((method,), (mu,), (0.0,))
    axes = {name: axis for name, axis in axis_coordinates(grid).items() if name in LIFE_AXES}
    return quasistatic.life_figure(life.expand_dims([*axes]).assign_coords(axes), [mu])
