# Functions of wildcards: what a scene or the configuration decides that a rule requires. No rule stands here.

import os
from pathlib import Path
from types import SimpleNamespace


def solved_cases(wildcards):
    """Files that hold every case of a scene: one for each, or chunks of many lines."""
    scene, grid = wildcards.scene, GRIDS[wildcards.scene]
    if parts := grid.chunks(config["points_per_job"]):
        return expand("results/{scene}/chunks/{part}.nc", scene=scene, part=parts)
    return expand("results/{scene}/cases/{case}.nc", scene=scene, case=grid.cases())


def dynamic_cases(wildcards):
    """Files of all cases of a scene that are solved dynamically."""
    cases = DYNAMIC[wildcards.scene].cases()
    return expand(
        "results/{scene}/dynamic/{case}.nc", scene=wildcards.scene, case=cases
    )


def every_case(wildcards):
    """Files of all cases of the main study, steady and dynamic."""
    steady = [SimpleNamespace(scene=scene) for scene in GRIDS]
    dynamic = [SimpleNamespace(scene=scene) for scene in DYNAMIC]
    return [
        *(path for grid in steady for path in [*solved_cases(grid), *slip_cases(grid)]),
        *(path for grid in dynamic for path in dynamic_cases(grid)),
    ]


def spreads(wildcards):
    """Files of the spread in life, of one scene or of all."""
    return [
        f"results/{scene}/spread.nc"
        for scene in config["uncertain_lives"]["scenes"]
        if scene in GRIDS and scene == getattr(wildcards, "scene", scene)
    ]


def scene_of_life(wildcards):
    """The scene file of a life in config/lives.yaml."""
    return f"config/scenes/{LIVES['lives'][wildcards.life]['scene']}.yaml"


def scene_of_trade(wildcards):
    """The scene file of a scene in config/accuracy.yaml."""
    file = ACCURACY["scenes"][wildcards.trade_scene]["file"]
    return f"config/scenes/{file}.yaml"


def limits_of(wildcards):
    """Requirements on a scene, by which its preload is chosen."""
    return DESIGN["scenes"][wildcards.scene]["limits"]


def ramp_to_speed(wildcards):
    """Time from rest to speed of a warm-up [s], as required of a scene, or as its duty has it."""
    design = DESIGN["scenes"].get(wildcards.scene, {})
    return design.get("limits", {}).get("warmup_s")


def map_of(scene, kind="map"):
    """Axes of a map of a scene, as lists."""
    return configuration.map_axes(DESIGN["scenes"][scene][kind])


def spread_at_preload(wildcards):
    """Spread in life at the recommended preload, of a scene that asks for it."""
    asked = wildcards.scene in config["uncertain_lives"]["scenes"]
    return expand("results/{scene}/preload/spread.nc", **wildcards) if asked else []


def recommendation_of_map(wildcards):
    """The recommended preload of a scene that has a small map."""
    if wildcards.scene not in SMALL_MAPS:
        return []
    return expand("results/{scene}/preload/recommendation.nc", **wildcards)


def map_parts(wildcards):
    """Files that together hold the map of a scene."""
    axes = map_of(wildcards.scene)
    return expand(
        "results/{scene}/design/map/{method}-mu{mu}.nc",
        method=axes["preload_method"],
        mu=map(mu_name, axes["friction"]),
        **wildcards,
    )


def sampled(wildcards):
    """Quantiles of sampled lives, of a scene of config/uncertainty.yaml."""
    asked = wildcards.scene in UNCERTAINTY["scenes"]
    return expand("results/{scene}/design/uncertainty.nc", **wildcards) if asked else []


def worn_loss(wildcards):
    """The state of wear that figures of a scene show [um]; its most worn one, if it has not this."""
    losses = GRIDS[wildcards.scene].ball_diameter_loss_um
    return float(WORN) if WORN in losses else losses[-1]


def frictions_drawn(wildcards):
    """Friction coefficients that the figures of a scene compare."""
    grid = GRIDS[wildcards.scene].friction
    wanted = sorted(map(float, FIGURES["friction"])) or grid
    return [mu for mu in wanted if mu in grid] or [grid[0]]


def slip_cases(wildcards):
    """Cases behind the figure of slip, in the worn state that figures show."""
    return expand(
        "results/{scene}/cases/{method}-mu{mu}-loss{loss}.nc",
        scene=wildcards.scene,
        method=GRIDS[wildcards.scene].preload_method,
        mu=map(mu_name, frictions_drawn(wildcards)),
        loss=loss_name(worn_loss(wildcards)),
    )


def reference(wildcards):
    """The file of published values that running averages of a scene are drawn with, if any."""
    name = (FIGURES["running_averages"][wildcards.scene] or {}).get("reference")
    return f"config/reference/{name}.csv" if name else []


def with_pngs(svgs):
    """Figures as SVG, each with the PNG beside it."""
    return [f"{path[:-4]}.{ending}" for path in svgs for ending in ("svg", "png")]


def tell_result():
    """Print the recommendation, and where the page is, after a run that made the page."""
    if "BEARINGWEAR_STUDY" in os.environ:  # the command prints both, also without a job
        return
    if os.path.isfile(PAGE) and os.path.getmtime(PAGE) >= STARTED:
        for line in configuration.headlines(ANSWERS):
            print(line, file=sys.stderr)
        print(f"page: {PAGE}", file=sys.stderr)
