"""Wear of all parts of a bearing as one vector, and the worn scene."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.lives.surfaces import Coating
from bearingwear.measures import ENDS
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import Factors
from bearingwear.solvers.bearing.outputs import depth_peak, groove_depth_rates, wear_rates


class WornLayout:
    """Positions of the parts in a vector of wear or wear rates, for n balls."""

    def __init__(self, n: int):
        self.diameter = slice(0, n)  # worn off each ball's diameter [m]
        self.ball = slice(n, 2 * n)  # volume worn off each ball [m3]
        self.pocket = slice(2 * n, 3 * n)  # volume worn off the cage in each pocket [m3]
        self.race = slice(3 * n, 3 * n + 2)  # volume worn off the inner and the outer race [m3]
        self.land = 3 * n + 2  # volume worn off the cage at its guiding land [m3]
        self.groove = slice(3 * n + 3, 3 * n + 5)  # mean depth over the width of both tracks [m]
        self.deepest = slice(3 * n + 5, 3 * n + 7)  # depth in their deepest places [m]
        self.size = 3 * n + 7


def cage_surfaces(scene: Scene) -> tuple[float, float]:
    """Returns the area of the wall of one pocket, and of the guiding surface of a cage [m2].

    Both are cylinders. The latter is the outer surface of a cage that the balls guide.
    """
    cage, MM = scene.cage, parameters.MM
    assert cage is not None
    r_i, r_o = 0.5 * cage.inner_diameter_mm * MM, 0.5 * cage.outer_diameter_mm * MM
    pocket = (scene.bearing.ball_diameter_mm + cage.pocket_clearance_mm) * MM
    guiding = r_i if cage.guiding_race == "inner" else r_o
    return math.pi * pocket * (r_o - r_i), 2.0 * math.pi * guiding * cage.width_mm * MM


def film_wear_ratio(scene: Scene) -> float:
    """Returns K_s/H of a cage's film over that of the cage [1]; 1 without a film.

    A film that names no wear coefficient or hardness has that of the cage.
    """
    if scene.cage is None or scene.cage.film is None:
        return 1.0
    film, cage = scene.cage.film, scene.materials[scene.cage.material]
    K_s_ratio = (film.wear_coefficient or cage.wear_coefficient) / cage.wear_coefficient
    film_hardness = film.brinell_hardness_GPa or cage.brinell_hardness_GPa
    return K_s_ratio * cage.brinell_hardness_GPa / film_hardness


CAGE_PARTS = ("pocket", "land")


class WornParts:
    """Wear of the balls, grooves and cage of a scene, which has no cage if none is solved.

    Wear since the start of the life is a vector `worn`, or one of `rates` per second, as in
    `WornLayout`. `coating` is the film of the `CAGE_PARTS`.
    """

    def __init__(self, scene: Scene):
        self.scene = scene
        self.counts_races = scene.wear.counts_races
        n = scene.bearing.ball_count
        self.layout = WornLayout(n)
        loss = np.array(scene.wear.ball_diameter_loss_um) * parameters.UM
        self.start_loss = np.broadcast_to(loss, (n,))
        self.model = replace(scene.model, history_points_per_turn=0)  # runs need no histories
        film = None if scene.cage is None else scene.cage.film
        thickness = 0.0 if film is None else film.thickness_um * parameters.UM
        self.coating = Coating(np.full(len(CAGE_PARTS), thickness))

    def loss(self, worn: np.ndarray) -> np.ndarray:
        """Returns the loss of diameter of each ball that changes the fit (n,) [m].

        It includes the depth of the grooves if the scene counts them.
        """
        layout = self.layout
        return self.start_loss + worn[layout.diameter] + self._counted_depth(worn)

    def _counted_depth(self, worn: np.ndarray) -> float:
        """Returns the depth of both grooves [m]; 0 where the scene does not count it."""
        return float(worn[self.layout.groove].sum()) if self.counts_races else 0.0

    def cage_depths(self, worn: np.ndarray) -> np.ndarray:
        """Returns the wear depths of pocket walls and guiding surface (2,) [m]; NaN without cage.

        The mean wear of the pockets, and that of the land, is spread evenly over `worn_share` of
        the surface.
        """
        cage, layout = self.scene.cage, self.layout
        if cage is None:
            return np.full(len(CAGE_PARTS), math.nan)
        volumes = np.array([worn[layout.pocket].mean(), worn[layout.land]])
        return volumes / (cage.worn_share * np.array(cage_surfaces(self.scene)))

    def clearances(self, worn: np.ndarray) -> tuple[float, float]:
        """Returns the diametral clearances of pocket and most worn ball, and at the land [m].

        Both are NaN without a cage.
        """
        cage = self.scene.cage
        if cage is None:
            return math.nan, math.nan
        MM = parameters.MM
        pocket, land = 2.0 * self.cage_depths(worn)
        ball = self._largest_ball_loss(worn)
        return cage.pocket_clearance_mm * MM + pocket + ball, cage.guide_clearance_mm * MM + land

    def _largest_ball_loss(self, worn: np.ndarray) -> float:
        """Returns the loss of diameter of the most worn ball, without grooves [m]."""
        return (self.start_loss + worn[self.layout.diameter]).max()

    def cage_values(self, worn: np.ndarray) -> dict[str, float]:
        """Returns the result variables of the cage at some wear.

        They are both clearances [m], NaN without a cage, and with a film the wear depths of pockets
        and land over its thickness [1].
        """
        pocket, guide = self.clearances(worn)
        values = {"pocket_clearance": pocket, "guide_clearance": guide}
        if self.coating.new_thickness.all():
            shares = self.cage_depths(worn) / self.coating.new_thickness
            values |= dict(zip(ENDS["cage_film_worn_share"].variables, shares, strict=True))
        return values

    def cage_rate(self, criterion: str, rates: np.ndarray) -> float:
        """Returns the rate of the measure that a criterion of the cage limits.

        It is in m/s for a clearance, and in 1/s for the worn share of a film. If the measure has
        several variables, it is the rate of the fastest.

        criterion: one of `OF_CAGE`.
        rates: wear per second of all parts.
        """
        # the measure is linear in the wear, but for the choice of the most worn ball
        unworn = self.cage_values(np.zeros_like(rates))
        after_second = self.cage_values(rates)
        return max(after_second[name] - unworn[name] for name in ENDS[criterion].variables)

    def cage_rates(self, values: Mapping[str, Any]) -> np.ndarray:
        """Returns the rates of all parts [m3/s], of which only pockets and land are not 0.

        Where the film of a part is left, its K_s/H replaces that of the material of the cage.

        values: result variables with wear rates of the material of the cage. A rate that is not
            there is 0.
        """
        layout = self.layout
        rates = np.zeros(layout.size)
        pocket, land = np.where(self.coating.is_left, film_wear_ratio(self.scene), 1.0)
        rates[layout.pocket] = values.get("pocket_wear_rate", 0.0) * pocket
        rates[layout.land] = values.get("cage_land_wear_rate", 0.0) * land
        return rates

    def worn_scene(self, worn: np.ndarray) -> Scene:
        """Returns the scene at some wear, for runs without histories.

        Raises SceneError where more has worn than a scene may have.
        """
        wear = replace(
            self.scene.wear, ball_diameter_loss_um=tuple((self.loss(worn) / parameters.UM).tolist())
        )
        cage = self.scene.cage
        if cage is not None:
            pocket, guide = self.clearances(worn)
            # the motion itself adds the loss of each ball, with counted grooves, to its pocket
            pocket -= self._largest_ball_loss(worn)
            pocket -= self._counted_depth(worn)
            cage = replace(
                cage,
                pocket_clearance_mm=max(float(pocket), 0.0) / parameters.MM,
                guide_clearance_mm=float(guide) / parameters.MM,
            )
        return replace(self.scene, wear=wear, cage=cage, model=self.model)

    def rates(self, values: dict[str, Any], factors: Factors | None = None) -> np.ndarray:
        """Returns the wear per second in a run, as in `WornLayout`.

        values: result variables of the run, by ball and contact (n, 2).
        factors: K_s/H of balls and races [1/Pa], if not those of new surfaces.
        """
        layout = self.layout
        rates = self.cage_rates(values)
        n = self.scene.bearing.ball_count
        D = self.scene.bearing.ball_diameter_mm * parameters.MM - values["ball_diameter_loss"]
        qv, a = values["qv"], values["semi_major_axis"]
        new_ball, _ = wear_rates(self.scene, qv, a, None)
        ball, race = wear_rates(self.scene, qv, a, factors)
        # the rate of a run includes the wear in the pockets
        rates[layout.ball] = values["ball_wear_rate"] + (ball - new_ball).sum(axis=1)
        rates[layout.diameter] = 2.0 * rates[layout.ball] / (math.pi * D**2)
        rates[layout.race] = n * race.mean(axis=0)
        semi_axis = np.where(a > 0.0, a, np.inf)
        track = values["contact_track_radius"]
        rates[layout.groove] = groove_depth_rates(n, race, semi_axis, track).mean(axis=0)
        peak = depth_peak(values, values["gyroscopic_slip"], values["rolling_slip"])
        rates[layout.deepest] = peak * rates[layout.groove]
        return rates

    def mean_loss_rate(self, rates: np.ndarray) -> float:
        """Returns the mean rate of the loss that counts [m/s].

        It is that of the ball diameters, and of both grooves if the scene counts them.

        rates: of all wearing parts.
        """
        return float(rates[self.layout.diameter].mean()) + self._counted_depth(rates)
