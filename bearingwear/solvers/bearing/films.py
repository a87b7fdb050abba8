"""Solid films and running in: friction and wear of a part at the depth worn off it.

Depths are radial, of the surface: half of what a ball loses of its diameter (theory.md section 23).
"""

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bearingwear.scene.blocks import Material
from bearingwear.scene.friction import FilmFriction, changes_as_it_wears
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.fitted_hertz import INNER_RACE, OUTER_RACE, fitted_factors
from bearingwear.solvers.bearing.mounted import GPA, UM, mounted_geometry

MPA = 1e6

Bare = tuple[bool, bool]
"""Of the inner and the outer contact: whether no film is left in it."""

COVERED: Bare = (False, False)


class Archard(NamedTuple):
    """Coefficients of Archard's law of a part: numbers, or one for each position."""

    K_s: float | np.ndarray  # wear coefficient [1]
    H: float | np.ndarray  # Brinell hardness as a pressure [Pa]

    @property
    def factor(self):
        """K_s/H: worn volume over QV (theory.md section 6) [1/Pa]."""
        return self.K_s / self.H

    def rate(self, qv):
        """Worn volume per time of QV [W] [m3/s]."""
        return self.K_s * qv / self.H


@dataclass(frozen=True)
class Surface:
    """A ball, or the groove of a race, as it wears."""

    below: Archard  # below the film, worn in
    film: Archard | None  # of its own film, None without one
    thickness: float  # of that, 0 without one and infinite where it never wears through [m]
    first: float  # wear coefficient of the new surface below [1]
    running_in: float  # depth in which that is forgotten, 0 without running in [m]

    def below_at(self, depth: float | np.ndarray) -> Archard:
        """Of what lies below the film, running in as it wears: K + (K_0 - K) exp(-depth/h_0)."""
        if not self.running_in:
            return self.below
        deep = np.maximum(depth - self.thickness, 0.0) / self.running_in
        K_s = self.below.K_s + (self.first - self.below.K_s) * np.exp(-deep)
        return Archard(K_s, self.below.H)


def worn_as(
    part: Surface, partner: Surface, depth, covered, partner_covered, pressed=1.0
) -> Archard:
    """Wear properties of a part worn so deep [m]: numbers, or one for each place.

    Those of its own film, times the factor of its pressure. Without one, or where it is worn
    through, those of its partner's film, which covers the part (assumed). Where neither is left,
    those of what lies below.
    """
    found = part.below_at(depth)
    for film, stands in ((partner.film, partner_covered), (part.film, covered)):
        if film is not None:
            found = Archard(
                np.where(stands, film.K_s * pressed, found.K_s), np.where(stands, film.H, found.H)
            )
    return found


class Cover(NamedTuple):
    """Film cover of the surfaces."""

    inner: bool
    outer: bool
    ball: bool


@dataclass(frozen=True)
class Films:
    """Balls and races of a scene, as their surfaces wear."""

    ball: Surface
    race: Surface
    exponent: float = 0.0
    reference: float = 1.0  # [Pa]

    @classmethod
    def of(cls, scene: Scene) -> "Films":
        b = scene.bearing
        ball, race = (scene.materials[name] for name in (b.ball_material, b.race_material))
        return cls._between(ball, race, scene.friction.film)

    @classmethod
    @functools.lru_cache(maxsize=64)  # asked for several times in each solve
    def _between(cls, ball: Material, race: Material, given: FilmFriction | None) -> "Films":
        # a film that never wears through is on the races alone where no material has one
        endless = given is not None and given.thickness_um is None
        on_races = None if endless and ball.film is not None else given
        surfaces = _surface(ball, None, given), _surface(race, on_races, given)
        if given is None or given.pressure_exponent is None:
            return cls(*surfaces)
        return cls(*surfaces, given.pressure_exponent, (given.reference_pressure_GPa or 1.0) * GPA)

    def pressed(self, pressure):
        """Factor on the wear of films under a mean pressure [Pa], (p/p_ref)^n."""
        return (pressure / self.reference) ** self.exponent if self.exponent else 1.0

    @property
    def wear_through(self) -> bool:
        return any(0.0 < part.thickness < math.inf for part in (self.ball, self.race))

    @property
    def changes(self) -> bool:
        """Whether friction or wear depend on the worn depth."""
        return self.wear_through or bool(self.ball.running_in or self.race.running_in)

    @property
    def cover(self) -> Cover:
        """When new."""
        race = self.race.thickness > 0.0
        return Cover(race, race, self.ball.thickness > 0.0)

    def bare(self, cover: Cover) -> Bare:
        """The contacts without any film."""
        if not self.wear_through:
            return COVERED
        return not (cover.inner or cover.ball), not (cover.outer or cover.ball)

    def wearing(
        self, cover: Cover, ball_depth=0.0, race_depths=0.0, pressed=1.0
    ) -> tuple[Archard, Archard]:
        """Wear properties of a ball in both of its contacts, and of both races, worn so deep [m].

        Races and the factors of `worn_as` are those of inner and outer contact (..., 2).
        """
        races = np.array([cover.inner, cover.outer])
        return (
            worn_as(self.ball, self.race, ball_depth, cover.ball, races, pressed),
            worn_as(self.race, self.ball, race_depths, races, cover.ball, pressed),
        )


def limits_depth(scene: Scene) -> bool:
    """Whether the depth of a groove may end the life."""
    end = scene.wear.end_of_life
    return end is not None and end.groove_depth_um is not None


def follows_depths(scene: Scene) -> bool:
    """Whether a life needs the depth worn off each surface: for films, running in, or its end."""
    return changes_as_it_wears(scene) or limits_depth(scene)


def _surface(
    material: Material, on_it: FilmFriction | None, common: FilmFriction | None
) -> Surface:
    """A part of a material; `on_it` is the film that the friction names, if it is on this part."""
    H = material.brinell_hardness_GPa * GPA
    film, thickness = None, 0.0
    if material.film is not None:
        thickness = material.film.thickness_um * UM
        K_s = material.film.wear_coefficient or (common and common.wear_coefficient)
        hardness = material.film.brinell_hardness_GPa or (common and common.brinell_hardness_GPa)
        film = Archard(K_s or 0.0, hardness * GPA if hardness else H)
    elif on_it is not None and on_it.wear_coefficient is not None:
        thickness = math.inf if on_it.thickness_um is None else on_it.thickness_um * UM
        hardness = on_it.brinell_hardness_GPa
        film = Archard(on_it.wear_coefficient, hardness * GPA if hardness else H)
    new = material.running_in
    return Surface(
        below=Archard(material.wear_coefficient, H),
        film=film,
        thickness=thickness,
        first=material.wear_coefficient if new is None else new.wear_coefficient,
        running_in=0.0 if new is None else new.depth_um * UM,
    )


def _semi_axis_factors(scene: Scene) -> np.ndarray:
    """Semi-axes over the cube root of the load (2, 2): of both contacts, major and minor."""
    g = mounted_geometry(scene)
    races = (INNER_RACE, OUTER_RACE)
    return np.array([fitted_factors(g, race, g.D0, math.cos(g.alpha0))[1:] for race in races]).T


def mean_pressure(scene: Scene, major: np.ndarray) -> np.ndarray:
    """Mean Hertz pressure [Pa] by fitted factors, from semi-major axes (..., 2) [m]."""
    c_a, c_b = _semi_axis_factors(scene)
    return major / (math.pi * c_a * c_a * c_b)


def pressure_of_load(scene: Scene, load: np.ndarray) -> np.ndarray:
    """Mean pressure of Hertz's contacts under these loads (..., 2) [N], as `mean_pressure`."""
    c_a, _ = _semi_axis_factors(scene)
    return mean_pressure(scene, c_a * np.cbrt(load))
