"""The stiffness of bearings over speed, for programs of rotor dynamics: CSV, and ROSS's TOML.

ROSS has z along the axis, where this program has X, and x and y across it, here Y and Z. Both turn
about the axis from the first of these to the second.
"""

from __future__ import annotations

import csv
import inspect
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear import Scene, SceneError
from bearingwear.results.variables import DOFS
from bearingwear.scene.read import Source, as_scene

TILTS = ("held", "released")
"""ROSS's bearings have no tilt: here it is held at zero, or released, so that no moment acts."""

ROSS_NAMES = {2: "frequency", 3: "speed"}
"""The key of the speeds by ROSS's major version."""

FEWEST_SPEEDS = 5
"""The fewest speeds that ROSS interpolates between."""

_NEGLIGIBLE_SHARE = 1e-14
"""Share of the largest stiffness below which one is only rounding, as balls in a circle cancel."""

_FROM_ROSS = (1, 2, 0)  # indices among this program's X, Y, Z of ROSS's x, y and z
_RPM = math.pi / 30.0  # [rad/s]


class NotExported(ValueError):
    """The stiffness at a speed cannot be computed; the text is one line."""


@dataclass(frozen=True)
class StiffnessOverSpeed:
    """Dynamic stiffness of the bearings of a scene over the speed of the shaft.

    matrices: (speeds, bearings, 5, 5), derivatives of forces along X, Y, Z [N] and moments about Y
        and Z [N m] by shifts along X, Y, Z [m] and tilts about Y and Z [rad], in the frame of each
        bearing. Bearings in tandem count as one.
    """

    scene: Scene
    speeds_rpm: tuple[float, ...]
    matrices: np.ndarray

    @classmethod
    def of(cls, source: Source, speeds_rpm: Sequence[float]) -> StiffnessOverSpeed:
        """Returns the stiffness of a scene, solved at each speed of the shaft [r/min].

        A lowest speed of the scene above a speed is lowered to it.

        SceneError: the speeds do not rise. NotExported: the scene has no stiffness at a speed, or
        needs the dynamic model, which has none.
        """
        from bearingwear.solvers.effects.choice import choice
        from bearingwear.solvers.solve import solve

        scene, speeds = as_scene(source), tuple(map(float, speeds_rpm))
        if not speeds or any(b <= a for a, b in zip(speeds, speeds[1:], strict=False)):
            problem = f"got {list(speeds)}, expected increasing numbers"
            raise SceneError("", problem, source="speeds")
        if choice(scene).fidelity == "dynamic":
            problem = "a dynamic run gives no stiffness matrix; set model.fidelity to race_control"
            raise NotExported(problem)
        lowest, matrices = scene.operation.lowest_speed_rpm, []
        for speed in speeds:
            changes = {
                "operation.shaft_speed_rpm": speed,
                "operation.lowest_speed_rpm": min(lowest, speed),
            }
            result = solve(scene.with_(changes))
            if result.status != "ok":
                raise NotExported(f"{speed:g} r/min: {result.status}: {result.reason}")
            matrices.append(result.values["stiffness_matrix"].reshape(-1, 5, 5))
        tandem = scene.pair.tandem if scene.pair is not None else (1,)
        return cls(scene, speeds, np.array(matrices) * np.array(tandem)[:, None, None])

    def ross_matrices(self, bearing: int = 1, tilt: str = "held") -> np.ndarray:
        """Returns the stiffness (speeds, 3, 3) of a bearing along ROSS's x, y and z [N/m].

        Elements that are only rounding are 0.

        bearing: number of the bearing, from 1. tilt: one of `TILTS`.
        SceneError: an argument has none of these values.
        """
        for name, value, allowed in (
            ("tilt", tilt, TILTS),
            ("bearing", bearing, range(1, self.matrices.shape[1] + 1)),
        ):
            if value not in allowed:
                problem = f"got {value!r}, expected {' or '.join(map(str, allowed))}"
                raise SceneError("", problem, source=name)
        K = self.matrices[:, bearing - 1]
        K_shift, K_tilt = K[:, :3, :3], K[:, 3:, 3:]
        if tilt == "released":
            K_shift = K_shift - K[:, :3, 3:] @ np.linalg.solve(K_tilt, K[:, 3:, :3])
        K_shift = K_shift[:, _FROM_ROSS][:, :, _FROM_ROSS]
        return np.where(abs(K_shift) > _NEGLIGIBLE_SHARE * abs(K_shift).max(), K_shift, 0.0)

    def coefficients(
        self, bearing: int = 1, tilt: str = "held", damping: float = 0.0
    ) -> dict[str, list[float]]:
        """Returns the coefficients of a bearing at each speed, by their names in ROSS.

        They are stiffness `kxx`, `kxy`, `kyx`, `kyy`, `kzz` [N/m], and damping `cxx`, `cyy`, `czz`
        [N s/m]. ROSS has none between z and the other axes.

        SceneError: there are too few speeds for ROSS, or as `ross_matrices`.
        """
        if len(self.speeds_rpm) < FEWEST_SPEEDS:
            problem = f"got {len(self.speeds_rpm)}, expected at least {FEWEST_SPEEDS} for ROSS"
            raise SceneError("", problem, source="speeds")
        K = self.ross_matrices(bearing, tilt)
        places = ("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1), ("zz", 2, 2)
        stiffness = {f"k{name}": K[:, i, j].tolist() for name, i, j in places}
        return stiffness | {f"c{name}": [damping] * len(K) for name in ("xx", "yy", "zz")}

    def effective_arm(self, bearing: int = 1) -> float:
        """Returns the axial distance from the bearing at which a radial force causes no tilt [m].

        It is the mean over the speeds, towards the point where the contact lines meet the axis.
        At a rotor node there, displacement and tilt are not coupled.
        """
        K = self.matrices[:, bearing - 1]
        return float(np.mean(np.abs(K[:, 1, 4] - K[:, 2, 3]) / (K[:, 1, 1] + K[:, 2, 2])))

    @property
    def csv(self) -> str:
        """Returns CSV: a header, then for each speed and bearing a line with 25 stiffnesses.

        Their units are those of `matrices`. Bearings count from 1.
        """
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        names = [f"k_{row}_{column}" for row in DOFS for column in DOFS]
        table.writerow(["shaft_speed_rpm", "bearing", *names])
        for speed, bearings in zip(self.speeds_rpm, self.matrices, strict=True):
            for number, K in enumerate(bearings, 1):
                table.writerow([speed, number, *K.ravel().tolist()])
        return text.getvalue()

    def toml(
        self,
        name: str,
        bearing: int = 1,
        tilt: str = "held",
        damping: float | None = None,
        node: int = 0,
        ross: int = 2,
    ) -> str:
        """Returns a bearing as TOML that `ross.BearingElement.load` reads.

        Speeds are in rad/s, as in ROSS. SceneError as `coefficients`.

        name: of the table and tag. damping: in x, y and z [N s/m]; None counts as 0, assumed.
        node: of the rotor. ross: major version of ROSS, a key of `ROSS_NAMES`.
        """
        coefficients = self.coefficients(bearing, tilt, damping or 0.0)
        coefficients[ROSS_NAMES[ross]] = (np.array(self.speeds_rpm) * _RPM).tolist()
        damping_text = "none given, 0 assumed" if damping is None else f"{damping:g} N s/m, given"
        tilt_text = "tilt held" if tilt == "held" else "tilt released: no moment"
        arm = 1e3 * self.effective_arm(bearing)
        lines = [
            f"# {self.scene.name}, bearing {bearing}: dynamic stiffness at {len(self.speeds_rpm)} "
            "speeds, rad/s, N/m; z axial",
            f"# {tilt_text}; displacement and tilt are uncoupled at a node {arm:.4g} mm from the",
            "# bearing, where its contact lines meet the axis",
            f"# damping: {damping_text}; keys named as in ROSS {ross}",
            f"[BearingElement_{name}]",
            f"n = {node}",
            f'tag = "{name}"',
            *(f"{key} = {values}" for key, values in coefficients.items()),
        ]
        return "\n".join(lines) + "\n"


def to_ross(
    scene: Source,
    speeds_rpm: Sequence[float],
    node: int = 0,
    *,
    bearing: int = 1,
    tilt: str = "held",
    damping: float = 0.0,
) -> Any:
    """Returns a bearing of a scene as a bearing element of ROSS, which must be installed.

    Parameters
    ----------
    scene : path, dict or Scene
    speeds_rpm : sequence of float
        At least five increasing speeds [r/min], between which ROSS interpolates.
    node : int
        Node of the rotor in ROSS.
    bearing : int
        Bearing of a pair, 1 or 2.
    tilt : {"held", "released"}
        The element transmits no moment: the tilt is either held or released.
    damping : float
        Damping in x, y and z [N s/m], which bearingwear does not compute.

    Returns
    -------
    ross.BearingElement

    Raises
    ------
    SceneError, NotExported
        Both are ValueErrors with a one-line message.
    ImportError
        ROSS is not installed.
    """
    from ross import BearingElement

    coefficients: dict[str, Any] = dict(
        StiffnessOverSpeed.of(scene, speeds_rpm).coefficients(bearing, tilt, damping)
    )
    parameters = inspect.signature(BearingElement.__init__).parameters
    name = next(name for name in ROSS_NAMES.values() if name in parameters)
    coefficients[name] = _RPM * np.array(speeds_rpm, dtype=float)
    return BearingElement(n=node, **coefficients)
