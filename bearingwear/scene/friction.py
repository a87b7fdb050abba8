"""Friction, films and running in, as keys of a scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from bearingwear.scene.accuracy import ACCURACY, STANDARD
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, setting

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

_THICKNESS, _SHARE = "(0, 1000]", "(0, 1]"


@keyed
class Film:
    """A solid film on balls or races."""

    thickness_um: float = setting("Thickness of the film when new", "um", _THICKNESS)
    # fmt: off
    wear_coefficient: float | None = setting(
        "Wear coefficient of the film (if omitted, that of friction.film; for cage.film, that of "
        "the cage)", "1", _SHARE, default=None)
    brinell_hardness_GPa: float | None = setting("Hardness of the film (if omitted, that of "
        "friction.film or of the underlying material; for cage.film, that of the cage)", "GPa",
        "[0.001, 100]", default=None)
    # fmt: on


@keyed
class RunningIn:
    """A wear coefficient that falls, or rises, as the surface wears."""

    # fmt: off
    wear_coefficient: float = setting(
        "Initial wear coefficient, which approaches that of the material as the surface wears",
        "1", _SHARE)
    # fmt: on
    depth_um: float = setting(
        "Wear depth at which the difference from the wear coefficient of the material has "
        "decreased to 1/e of its initial value",
        "um",
        _THICKNESS,
    )


@keyed
class FilmLife:
    """Life of a film in one test, over that in the test whose relative life is 1."""

    # fmt: off
    pressure_MPa: float = setting("Peak pressure of the Hertzian contact", "MPa", "(0, 20000]")
    temperature_C: float = setting("Temperature of the film", "degC", "[-273, 1000]")
    relative_life: float = setting("Life of the film at the same slip, over that in the row whose "
        "relative life is 1, where the wear_coefficient of the film applies", "1", "[1e-9, 1e9]")
    # fmt: on


@keyed
class FilmFriction:
    """Friction of a solid film, S_0/p_m + alpha_S under the mean pressure p_m of a contact."""

    # fmt: off
    shear_strength_MPa: float = setting("Shear strength S_0 of the film at zero pressure", "MPa",
        "[0, 10000]")
    pressure_coefficient: float = setting("Pressure coefficient alpha_S of the shear "
        "strength", "1", "[0, 2]", default=0.0)
    thickness_um: float | None = setting("Thickness of the film on each race when new "
        "(materials.NAME.film specifies that of the balls; if omitted, the film never wears "
        "through)", "um", _THICKNESS,
        default=None)
    wear_coefficient: float | None = setting(
        "Wear coefficient of both surfaces while a film remains (if omitted, those of the "
        "materials)", "1", _SHARE, default=None)
    brinell_hardness_GPa: float | None = setting(
        "Hardness of the film (if omitted, that of the underlying material)", "GPa", "[0.001, 100]",
        default=None)
    bare_ball_race: float | None = setting(
        "Coulomb friction coefficient where the film is worn through (if omitted, that of the "
        "film)", "1", "[0, 2]", default=None)
    wear_table: tuple[FilmLife, ...] | None = setting("Lives of the film by pressure and "
        "temperature, a row for each pair of them; between the rows, the logarithm of the life is "
        "linear in that of the pressure and in temperature (if omitted, the wear_coefficient holds "
        "at every pressure and temperature)", default=None)
    # fmt: on


@keyed
class Friction:
    """Coulomb friction, regularised at small slip, or that of a film."""

    # fmt: off
    ball_race: float | None = setting(
        "Coulomb friction coefficient between the balls and races (required without "
        "friction.film)", "1",
        "[0, 2]",
        default=None)
    film: FilmFriction | None = setting(
        "A solid film between the balls and races (replaces friction.ball_race)", default=None)
    cage: float = setting(
        "Coulomb friction coefficient between the balls and the cage, and between the cage and "
        "its land", "1", "[0, 2]", default=0.05)
    slip_regularisation_m_s: float = setting(
        "Slip speed below which friction is regularised (an accuracy setting; the default is "
        "smaller where the mean slip is below 0.01 m/s, in proportion to the slip)",
        "m/s", "[1e-9, 1]",
        default_by=ACCURACY, default=STANDARD.slip_regularisation_m_s)
    # fmt: on

    @property
    def coefficient(self) -> float:
        """Returns the single Coulomb coefficient; raises `SceneError` if a film replaces it."""
        if self.ball_race is None:
            raise SceneError(
                "friction.film", "got a film, expected a single friction.ball_race here"
            )
        return self.ball_race


def check_films(scene: Scene) -> None:
    """Refuses friction and films that contradict each other, or the rest of a scene."""
    _check_one_friction(scene.friction)
    _check_coated_parts(scene)
    _check_wear_of_films(scene)
    _check_limits_of_films(scene)
    film = scene.friction.film
    if film is not None and film.wear_table is not None:
        _check_wear_table(scene, film.wear_table)


def _check_one_friction(friction: Friction) -> None:
    """Refuses friction by both a coefficient and a film, or by neither of them."""
    if friction.film is None and friction.ball_race is None:
        raise SceneError(
            "friction.ball_race",
            "got nothing, expected a number from 0 to 2, or friction.film",
            ("friction",),
        )
    if friction.film is not None and friction.ball_race is not None:
        raise SceneError(
            "friction.ball_race",
            f"got {friction.ball_race:g} with friction.film, expected only one of them",
            ("friction.film",),
        )


def _check_coated_parts(scene: Scene) -> None:
    """Refuses films and running-in of materials that no part has, and two films on the races."""
    bearing, film = scene.bearing, scene.friction.film
    parts = (bearing.ball_material, bearing.race_material)
    for name, material in scene.materials.items():
        for key, noun in (("film", "a film"), ("running_in", "running-in")):
            if getattr(material, key) is not None and name not in parts:
                raise SceneError(
                    f"materials.{name}.{key}",
                    f"got {noun} on a material used for neither balls nor races, expected it on "
                    + " and ".join(dict.fromkeys(parts)),
                    ("bearing.ball_material", "bearing.race_material"),
                )
    race_film_key = f"materials.{bearing.race_material}.film"
    race_film = scene.materials[bearing.race_material].film
    if film is not None and film.thickness_um is not None and race_film is not None:
        raise SceneError(
            "friction.film.thickness_um",
            f"got {film.thickness_um:g} with {race_film_key}, which also coats "
            "the races, expected only one of them",
            (race_film_key,),
        )


def _check_wear_table(scene: Scene, rows: Sequence[FilmLife]) -> None:
    """Refuses a table that is no grid of pressures and temperatures, or that no film uses.

    It also refuses a table in which not exactly one row has a relative life of 1.
    """
    key = "friction.film.wear_table"
    assert scene.friction.film is not None
    if scene.friction.film.wear_coefficient is None and not _coated_materials(scene):
        raise SceneError(
            "friction.film.wear_coefficient", "got nothing; wear_table requires this key", (key,)
        )
    references = sum(row.relative_life == 1.0 for row in rows)
    if references != 1:
        problem = "expected exactly one, at which the wear_coefficient of the film applies"
        raise SceneError(key, f"got {references} rows with a relative_life of 1, {problem}", (key,))
    row_counts = Counter((row.pressure_MPa, row.temperature_C) for row in rows)
    for pressure in sorted({row.pressure_MPa for row in rows}):
        for temperature in sorted({row.temperature_C for row in rows}):
            if (count := row_counts[pressure, temperature]) != 1:
                where = f"{pressure:g} MPa at {temperature:g} degC"
                raise SceneError(key, f"got {count} rows for {where}, expected one", (key,))


def _check_wear_of_films(scene: Scene) -> None:
    """Refuses films that wear but have no wear coefficient."""
    common_film = scene.friction.film
    common_coefficient = None if common_film is None else common_film.wear_coefficient
    for name, film in _coated_materials(scene).items():
        if film.wear_coefficient is None and common_coefficient is None:
            raise SceneError(
                f"materials.{name}.film.wear_coefficient",
                "got nothing, expected a number > 0 and <= 1, here or under friction.film",
                ("friction.film",),
            )
    if (
        common_film is not None
        and common_film.thickness_um is not None
        and common_coefficient is None
    ):
        raise SceneError(
            "friction.film.wear_coefficient",
            "got nothing; a film with a thickness requires this key",
            ("friction.film.thickness_um",),
        )


def _check_limits_of_films(scene: Scene) -> None:
    """Refuses values that only a film which wears through can reach, where none does."""
    if has_thickness(scene):
        return
    film, end = scene.friction.film, scene.wear.end_of_life
    if film is not None and film.bare_ball_race is not None:
        raise SceneError(
            "friction.film.bare_ball_race",
            f"got {film.bare_ball_race:g} with a film that never wears through; "
            "only allowed with a thickness",
            ("friction.film",),
        )
    if end is not None and end.film_worn_share is not None:
        raise SceneError(
            "wear.end_of_life.film_worn_share",
            f"got {end.film_worn_share:g}; only allowed with a film that has a thickness",
            ("friction.film", "materials"),
        )


def has_thickness(scene: Scene) -> bool:
    """Whether any film on balls or races has a thickness, so that it can wear through."""
    race_film = scene.friction.film
    has_race_thickness = race_film is not None and race_film.thickness_um is not None
    return has_race_thickness or bool(_coated_materials(scene))  # whose films always have one


def friction_changes_with_wear(scene: Scene) -> bool:
    """Whether friction or wear change with the worn depth, because of films or running-in."""
    names = (scene.bearing.ball_material, scene.bearing.race_material)
    runs_in = any(scene.materials[name].running_in is not None for name in names)
    return runs_in or has_thickness(scene)


def _coated_materials(scene: Scene) -> dict[str, Film]:
    """Returns the films of the materials of balls and races, by the names of the materials."""
    films = {}
    for name in (scene.bearing.ball_material, scene.bearing.race_material):
        if (film := scene.materials[name].film) is not None:
            films[name] = film
    return films
