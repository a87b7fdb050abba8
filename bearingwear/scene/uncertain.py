"""The values of a scene that may be uncertain, and their distributions."""

from __future__ import annotations

import operator
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, setting

if TYPE_CHECKING:
    from bearingwear.scene.friction import Friction
    from bearingwear.scene.scene import Scene

UNCERTAIN = {
    "ball_diameter_mm": "bearing",
    "contact_angle_deg": "bearing",
    "inner_groove_factor": "bearing",
    "outer_groove_factor": "bearing",
    "brinell_hardness_GPa": "materials",
    "wear_coefficient": "materials",
    "preload_N": "operation",
    "ball_race": "friction",
    "shear_strength_MPa": "friction.film",
    "thickness_um": "friction.film",
    "drag_density_kg_m3": "lubricant",
    "wear_scatter": "",
}
"""Keys of a scene that may be uncertain, and the block each stands in. `wear_scatter` is no key:
the wear of a bearing over that of its batch, 1 for the bearing that the scene describes."""

UNCERTAIN_CAGE = {
    "cage": "friction",
    "pocket_clearance_mm": "cage",
    "guide_clearance_mm": "cage",
    "imbalance_um": "cage",
    "gravity_angle_deg": "",
    "wear_coefficient": "",
}
"""Values of a cage that may be uncertain, as `UNCERTAIN`. `gravity_angle_deg` is that between
gravity and the shaft, in a random direction about it; `wear_coefficient` that of the cage, or of
its film. Lives of bearings do not see them."""

SAME_FOR_BATCH = (
    "brinell_hardness_GPa",
    "wear_coefficient",
    "ball_race",
    "shear_strength_MPa",
    "drag_density_kg_m3",
)
"""Keys of `UNCERTAIN` that are one unknown number for all bearings of a batch, unless a scene says
otherwise; the others scatter from bearing to bearing."""

WORN = ("brinell_hardness_GPa", "wear_coefficient", "wear_scatter")
"""Keys of `UNCERTAIN` that scale all wear. Hardness and wear coefficient are those of the races;
those of balls and films change in proportion."""

FRICTION_KEYS = ("ball_race", "shear_strength_MPa")
"""Keys of `UNCERTAIN` that a torque tells of: the coefficient, or the shear strength of a film."""

PARAMETERS = {
    "normal": (("standard_deviation",), ("mean",)),
    "lognormal": (("factor",), ("median",)),
    "uniform": (("low", "high"), ()),
}
"""What each distribution needs, and what it may be given."""


_PARAMETER_NAMES = ("standard_deviation", "mean", "factor", "median", "low", "high")


@keyed
class Distribution:
    """Distribution of a value of the scene, in that value's unit.

    `mean` and `median` are the scene's own value where they are None. `factor` is the geometric
    standard deviation: two thirds of the values lie between median/factor and median*factor.
    """

    # fmt: off
    distribution: str = setting("Kind of distribution (truncated to the permitted values)",
        choices=tuple(PARAMETERS), example="lognormal, factor: 3")
    mean: float | None = setting(
        "Mean of a normal distribution (if omitted, the value in the scene)",
        "as the value", default=None)
    standard_deviation: float | None = setting("Standard deviation of a normal distribution",
        "as the value", within="(0, inf)", default=None)
    median: float | None = setting(
        "Median of a lognormal distribution (if omitted, the value in the scene)", "as the value",
        within="(0, inf)", default=None)
    factor: float | None = setting("Geometric standard deviation of a lognormal distribution: two "
        "thirds of the values lie between median/factor and median*factor", "1", "(1, 100]",
        default=None)
    low: float | None = setting("Lower bound of a uniform distribution", "as the value",
        default=None)
    high: float | None = setting("Upper bound of a uniform distribution", "as the value",
        default=None)
    same_for_batch: bool | None = setting("Whether the value is common to all bearings of a batch "
        "or varies from bearing to bearing (if omitted: common for hardness, wear coefficient, "
        "friction and drag)", default=None)
    friction_correlation: float | None = setting("Correlation of the wear coefficient with the "
        "uncertain friction value (of their logarithms if both are lognormal; none if omitted)",
        "1", "(-1, 1)", default=None)
    # fmt: on


def is_same_for_batch(name: str, spread: Distribution) -> bool:
    """Whether an uncertain value is a single unknown number for all bearings of a batch.

    If its distribution does not say so, the values of `SAME_FOR_BATCH` are.

    name: key of the value in the block `uncertainty`.
    """
    return name in SAME_FOR_BATCH if spread.same_for_batch is None else spread.same_for_batch


def friction_correlation(distributions: Mapping[str, Distribution]) -> tuple[str, float]:
    """Returns the key of the uncertain friction and its correlation with the wear coefficient.

    The key is "" if no friction is uncertain; the correlation is 0 if the scene states none.
    """
    friction_key = next((name for name in FRICTION_KEYS if name in distributions), "")
    wear = distributions.get("wear_coefficient")
    if wear is None or wear.friction_correlation is None:
        return friction_key, 0.0
    return friction_key, wear.friction_correlation


def nominal_value(scene: Scene, name: str) -> float:
    """Returns the scene's value of a key of `UNCERTAIN`, in the unit of the key.

    For the block `materials`, it is that of the races; for `wear_scatter`, 1.
    """
    if name == "wear_scatter":
        return 1.0
    block: Any = operator.attrgetter(UNCERTAIN[name])(scene)
    if UNCERTAIN[name] == "materials":
        block = block[scene.bearing.race_material]
    return getattr(block, name)


def uncertain_key(name: str, material: str) -> str:
    """Returns the whole key of an uncertain value, such as `operation.preload_N`.

    name: a key of `UNCERTAIN`.
    material: name of the material, used for keys of the block `materials`.
    """
    block = f"materials.{material}" if UNCERTAIN[name] == "materials" else UNCERTAIN[name]
    return f"{block}.{name}"


def check_uncertainty(scene: Scene) -> None:
    """Refuses distributions of values that a scene lacks, and those with wrong parameters."""
    for name, spread in (scene.uncertainty or {}).items():
        key = f"uncertainty.{name}"
        _check_applies(scene.friction, name)
        if name == "wear_scatter" and spread.distribution != "lognormal":
            raise SceneError(
                f"{key}.distribution", f"got {spread.distribution}, expected lognormal", (key,)
            )
        _check_parameters(key, spread)
        if spread.friction_correlation is not None:
            _check_correlation(scene, name, spread.friction_correlation)
    for name, spread in (scene.cage_uncertainty or {}).items():
        if scene.cage is None:
            raise SceneError(f"cage_uncertainty.{name}", "got this key without a cage", ("cage",))
        _check_parameters(f"cage_uncertainty.{name}", spread)


def _check_applies(friction: Friction, name: str) -> None:
    """Refuses an uncertain value of a film, a thickness or a coefficient that a scene lacks."""
    key = f"uncertainty.{name}"
    problem = ""
    if name == "ball_race" and friction.ball_race is None:
        problem = "with friction.film; only allowed with friction.ball_race"
    elif UNCERTAIN[name] == "friction.film" and friction.film is None:
        problem = "with friction.ball_race; only allowed with friction.film"
    elif name == "thickness_um" and friction.film and not friction.film.thickness_um:
        problem = "without friction.film.thickness_um; only allowed with a thickness"
    if problem:
        raise SceneError(key, f"got this key {problem}", (key,))


def _check_parameters(key: str, spread: Distribution) -> None:
    """Refuses a distribution that lacks a parameter, has one too many, or has no low < high.

    key: of the distribution, such as `uncertainty.ball_race`, for the SceneError.
    """
    required, optional = PARAMETERS[spread.distribution]
    for parameter in _PARAMETER_NAMES:
        value = getattr(spread, parameter)
        if value is None and parameter in required:
            raise SceneError(
                f"{key}.{parameter}",
                f"got nothing; the distribution {spread.distribution} requires this key",
                (key,),
            )
        if value is not None and parameter not in required + optional:
            raise SceneError(
                f"{key}.{parameter}",
                f"got {value:g} with the distribution {spread.distribution}, "
                f"expected {', '.join(required + optional)}",
                (key,),
            )
    if spread.low is not None and spread.high is not None and spread.low >= spread.high:
        raise SceneError(
            f"{key}.high", f"got {spread.high:g}, expected a number > {spread.low:g}", (key,)
        )


def _check_correlation(scene: Scene, name: str, value: float) -> None:
    """Refuses a correlation unless it is of wear with friction, both common to a batch or neither.

    name: key of `uncertainty` whose `friction_correlation` has the value.
    """
    distributions = scene.uncertainty or {}
    friction, _ = friction_correlation(distributions)
    problem = ""
    if name != "wear_coefficient":
        problem = "only allowed with uncertainty.wear_coefficient"
    elif not friction:
        problem = f"only allowed with uncertainty.{' or uncertainty.'.join(FRICTION_KEYS)}"
    elif is_same_for_batch(name, distributions[name]) != is_same_for_batch(
        friction, distributions[friction]
    ):
        problem = f"expected the same value of same_for_batch for wear_coefficient and {friction}"
    if problem:
        key = f"uncertainty.{name}"
        raise SceneError(f"{key}.friction_correlation", f"got {value:g}, {problem}", (key,))
