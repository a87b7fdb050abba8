"""Solid films and running in: friction and wear of a part at the depth worn off it.

Depths are radial, of the surface: half of what a ball loses of its diameter (theory.md section 23).
"""

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from bearingwear.scene.blocks import Material
from bearingwear.scene.friction import FilmFriction, FilmLife, friction_changes_with_wear
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.fitted_hertz import INNER_RACE, OUTER_RACE, fitted_factors
from bearingwear.solvers.bearing.growth import part_temperatures
from bearingwear.solvers.bearing.mounted import GPA, UM, mounted_geometry

MPA = 1e6

Factors = tuple[Any, Any]
"""K_s/H of balls and of races: numbers, or one of each contact (..., 2) [1/Pa]."""

Bare = tuple[bool, bool]
"""Whether no film is left in the inner and in the outer contact."""

COVERED: Bare = (False, False)


class Archard(NamedTuple):
    """Coefficients of Archard's law."""

    K_s: float  # wear coefficient [1]
    H: float  # Brinell hardness as a pressure [Pa]

    @property
    def factor(self) -> float:
        """Returns K_s/H: worn volume over QV (theory.md section 6) [1/Pa]."""
        return self.K_s / self.H


@dataclass(frozen=True)
class Surface:
    """A ball, or the groove of a race, as it wears."""

    substrate: Archard  # of the material below the film, after running in
    film: Archard | None  # of its own film, None without one
    thickness: float  # of the film: 0 without one, infinite if it never wears through [m]
    initial_K_s: float  # wear coefficient of the substrate before running in [1]
    running_in: float  # depth over which it approaches its final value, 0 without running in [m]

    def substrate_factor(self, depth: float | np.ndarray) -> float | np.ndarray:
        """Returns K_s/H of the substrate as it runs in: K + (K_0 - K) exp(-h/h_0) [1/Pa].

        depth: worn off the surface [m]; h is the part of it below the film.
        """
        if not self.running_in:
            return self.substrate.factor
        depths_run_in = np.maximum(depth - self.thickness, 0.0) / self.running_in
        return (
            self.substrate.K_s + (self.initial_K_s - self.substrate.K_s) * np.exp(-depths_run_in)
        ) / self.substrate.H


@dataclass(frozen=True, eq=False)
class WearTable:
    """K_s of films by peak pressure and temperature, from their lives in tests.

    In a test the worn depth grows as K_s p^2 with the pressure p: the load goes as p^3, the width
    of the track as p. So K_s goes as 1/(p^2 x life).
    """

    pressure: np.ndarray  # (P,) of the rows, rising [Pa]
    temperature: np.ndarray  # (T,) of the rows, rising [degC]
    log_factor: np.ndarray  # (P, T) of K_s over that of the row whose relative life is 1
    reference: float  # temperature of that row, for films whose temperature is not known [degC]

    @classmethod
    def of(cls, rows: Sequence[FilmLife]) -> "WearTable":
        """Returns the table of rows from a scene, one of which has the relative life 1.

        The rows fill a grid of pressures and temperatures, as the check of the scene requires.
        """
        (reference,) = (row for row in rows if row.relative_life == 1.0)
        life = {(row.pressure_MPa, row.temperature_C): row.relative_life for row in rows}
        pressures = sorted({row.pressure_MPa for row in rows})
        temperatures = sorted({row.temperature_C for row in rows})
        factors = [
            [
                2.0 * math.log(reference.pressure_MPa / p) - math.log(life[p, T])
                for T in temperatures
            ]
            for p in pressures
        ]
        return cls(
            pressure=MPA * np.array(pressures),
            temperature=np.array(temperatures),
            log_factor=np.array(factors),
            reference=reference.temperature_C,
        )

    def factor(self, pressure: Any, temperature: Any) -> np.ndarray:
        """Returns K_s relative to the reference row at peak pressures [Pa], temperatures [degC].

        Its logarithm is linear in that of the pressure and in temperature. Beyond the rows the
        nearest row applies. NaN as a temperature stands for that of the reference row.
        """
        T = np.where(np.isnan(temperature), self.reference, temperature)
        with np.errstate(divide="ignore"):  # no load, no pressure
            by_pressure = _interpolation_weights(np.log(self.pressure), np.log(pressure))
        by_temperature = _interpolation_weights(self.temperature, T)
        return np.exp(np.einsum("...p,pt,...t->...", by_pressure, self.log_factor, by_temperature))


def _interpolation_weights(rows: np.ndarray, values: Any) -> np.ndarray:
    """Returns weights (..., n) of n rising rows, which interpolate linearly at the values."""
    numbers = np.arange(len(rows))
    return np.maximum(1.0 - abs(np.interp(values, rows, numbers)[..., None] - numbers), 0.0)


def surface_factor(part: Surface, partner: Surface, depth, covered, partner_covered, table_factor):
    """Returns K_s/H of a part at a worn depth [m]: a number, or one for each place [1/Pa].

    It is that of the part's own film, times `table_factor` (see `Films.table_factor`). Without a
    film, or where that is worn through, the partner's film covers the part (assumed). Where neither
    is left, the material below wears.

    depth: worn off the part, a number or one for each place [m].
    covered, partner_covered: shares of each place that the films cover, or whether they do.
    """
    factor = part.substrate_factor(depth)
    for film, share in ((partner.film, partner_covered), (part.film, covered)):
        if film is not None:
            factor = share * table_factor * film.K_s / film.H + (1.0 - share) * factor
    return factor


@dataclass(frozen=True)
class Films:
    """Balls and races of a scene, as their surfaces wear."""

    ball: Surface
    race: Surface
    table: WearTable | None = None

    @classmethod
    def of(cls, scene: Scene) -> "Films":
        """Returns the surfaces of a scene's balls and races."""
        b = scene.bearing
        ball, race = (scene.materials[name] for name in (b.ball_material, b.race_material))
        return cls._of_materials(ball, race, scene.friction.film)

    @classmethod
    @functools.lru_cache(maxsize=64)  # used several times in each solve
    def _of_materials(cls, ball: Material, race: Material, film: FilmFriction | None) -> "Films":
        """Returns surfaces of two materials, with the film that the scene's friction names."""
        # a film that never wears through is on the races alone where no material has one
        endless = film is not None and film.thickness_um is None
        on_races = None if endless and ball.film is not None else film
        table = None
        if film is not None and film.wear_table is not None:
            table = WearTable.of(film.wear_table)
        return cls(
            ball=_surface(ball, None, film), race=_surface(race, on_races, film), table=table
        )

    def table_factor(self, pressure: Any, temperature: Any) -> Any:
        """Returns the factor on K_s at peak pressures [Pa] and temperatures; 1 without a table."""
        return 1.0 if self.table is None else self.table.factor(pressure, temperature)

    @functools.cached_property
    def unworn(self) -> Factors:
        """Returns K_s/H of new balls and races in both contacts (2,), without a table [1/Pa]."""
        ball, race = self.contact_factors(self.thickness > 0.0)
        return np.broadcast_to(ball, 2), np.broadcast_to(race, 2)

    @property
    def wear_through(self) -> bool:
        """Returns whether a film can wear through: films of finite thickness can."""
        return any(0.0 < part.thickness < math.inf for part in (self.ball, self.race))

    @property
    def changes(self) -> bool:
        """Returns whether friction or wear depend on the worn depth."""
        return self.wear_through or bool(self.ball.running_in or self.race.running_in)

    @property
    def thickness(self) -> np.ndarray:
        """Returns the thickness of the films of both races and balls (3,), 0 without one [m]."""
        race = self.race.thickness
        return np.array([race, race, self.ball.thickness])

    def bare(self, cover: Sequence[bool] | np.ndarray) -> Bare:
        """Returns which contacts, inner and outer, have no film left on either body.

        Always `COVERED` where no film can wear through, also if there is none from the start.

        cover: whether inner race, outer race and balls still have their film.
        """
        if not self.wear_through:
            return COVERED
        inner, outer, ball = cover
        return not (inner or ball), not (outer or ball)

    def factors(self, on_ball, on_race, ball_depth=0.0, race_depths=0.0, table_factor=1.0):
        """Returns K_s/H of a ball and of a race [1/Pa], numbers or arrays as the arguments are.

        on_ball, on_race: shares that their films cover, or whether they do.
        ball_depth, race_depths: worn off them [m].
        table_factor: on K_s, see `table_factor`.
        """
        return (
            surface_factor(self.ball, self.race, ball_depth, on_ball, on_race, table_factor),
            surface_factor(self.race, self.ball, race_depths, on_race, on_ball, table_factor),
        )

    def contact_factors(
        self, cover: np.ndarray, ball_depth=0.0, race_depths=0.0, table_factor=1.0
    ) -> Factors:
        """Returns K_s/H of balls and of races in both contacts [1/Pa], numbers or (..., 2).

        cover: whether inner race, outer race and balls still have their film (3,).
        ball_depth, race_depths: worn off them [m].
        table_factor: on K_s, see `table_factor`.
        """
        return self.factors(cover[2], cover[:2], ball_depth, race_depths, table_factor)


def limits_depth(scene: Scene) -> bool:
    """Returns whether the depth of a groove may end the life."""
    end = scene.wear.end_of_life
    return end is not None and end.groove_depth_um is not None


def follows_depths(scene: Scene) -> bool:
    """Returns whether a life requires wear depths: for films, for running in or for its end."""
    return friction_changes_with_wear(scene) or limits_depth(scene)


def _surface(
    material: Material, friction_film: FilmFriction | None, common: FilmFriction | None
) -> Surface:
    """Returns the surface of a ball or a race of a material, with its film if it has one.

    friction_film: film that the scene's friction names, if it is on this part.
    common: film that the scene's friction names, which completes that of the material.
    """
    H = material.brinell_hardness_GPa * GPA
    film, thickness = None, 0.0
    if material.film is not None:
        thickness = material.film.thickness_um * UM
        K_s, hardness = material.film.wear_coefficient, material.film.brinell_hardness_GPa
        if common is not None:
            K_s, hardness = K_s or common.wear_coefficient, hardness or common.brinell_hardness_GPa
        # the check of the scene requires a coefficient; without a hardness, that of the material
        film = Archard(K_s or 0.0, hardness * GPA if hardness else H)
    elif friction_film is not None and friction_film.wear_coefficient is not None:
        thickness = (
            math.inf if friction_film.thickness_um is None else friction_film.thickness_um * UM
        )
        hardness = friction_film.brinell_hardness_GPa
        film = Archard(friction_film.wear_coefficient, hardness * GPA if hardness else H)
    initial_K_s = material.wear_coefficient
    running_in = 0.0
    if material.running_in is not None:
        initial_K_s = material.running_in.wear_coefficient
        running_in = material.running_in.depth_um * UM
    return Surface(
        substrate=Archard(material.wear_coefficient, H),
        film=film,
        thickness=thickness,
        initial_K_s=initial_K_s,
        running_in=running_in,
    )


def contact_temperatures(scene: Scene, parts: Sequence[float] | None = None) -> np.ndarray:
    """Returns the mean of ring and ball temperature in inner and outer contact (2,) [degC].

    NaN if the scene has neither temperatures nor a thermal network.

    parts: temperatures in the order of `part_temperatures`, in place of those of the scene.
    """
    if scene.temperature is None and scene.thermal is None:
        return np.full(2, math.nan)
    inner, balls, outer = (part_temperatures(scene) if parts is None else parts)[:3]
    return np.array([0.5 * (inner + balls), 0.5 * (outer + balls)])


def _semi_axis_factors(scene: Scene) -> np.ndarray:
    """Returns semi-axes over the cube root of the load (2, 2) [m/N^(1/3)], by fitted factors.

    The first row is c_a (major axis) of the inner and the outer contact, the second c_b (minor).
    They are those of the unworn bearing as mounted, at its free contact angle.
    """
    g = mounted_geometry(scene)
    races = (INNER_RACE, OUTER_RACE)
    return np.array([fitted_factors(g, race, g.D0, math.cos(g.alpha0))[1:] for race in races]).T


def mean_pressure(scene: Scene, major: np.ndarray) -> np.ndarray:
    """Returns the mean Hertz pressure [Pa] for semi-major axes (..., 2) [m], by fitted factors."""
    c_a, c_b = _semi_axis_factors(scene)
    return major / (math.pi * c_a * c_a * c_b)


PEAK_OVER_MEAN = 1.5
"""Peak over mean pressure of a Hertzian contact."""


def pressure_of_load(scene: Scene, load: np.ndarray) -> np.ndarray:
    """Returns the mean Hertz pressure [Pa] under loads (..., 2) [N], by fitted factors."""
    c_a, _ = _semi_axis_factors(scene)
    return mean_pressure(scene, c_a * np.cbrt(load))
