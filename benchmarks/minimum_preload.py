"""Which friction balls need at the least preload that makers prescribe, over speed.

`python benchmarks/minimum_preload.py` puts its tables into docs/validation.md and draws
docs/figures/minimum_preload.svg (half a minute).

GMN prints the least spring preload of each bearing at its largest speed, SKF the factor of a least
axial load that goes with the square of the speed. Neither says why that much. At both loads the
program has the friction coefficient that just holds a ball against its gyroscopic moment,
M_g/((Q_i + Q_o) R), and the gyroscopic share of the slip at a friction of 0.05 and 0.08.
"""

import textwrap
import warnings
from typing import NamedTuple

import numpy as np
from comparison import FIGURES, PAGE, table, with_block
from identify import rows_of

import bearingwear
from bearingwear.plotting.drawing import Figure, frame, key, new_figure, save, start_at_zero
from bearingwear.scene.new.catalogue import CatalogueBearing, bearings, entry_of
from bearingwear.scene.new.minimum_preload import skf_factors
from bearingwear.scene.scene import Scene

FRICTIONS = (0.05, 0.08)  # of a starved and of a dry contact
BETWEEN = (0.02, 0.05)  # friction that holds balls at the makers' least preload
SKF_SPEED = 0.3e6  # mm r/min, a third of what a spindle runs at; its rule has no speed of its own
SKF_ANGLES = {"AC": 25.0, "B": 40.0}
SKF_COLORS = {"AC": "0.6", "B": "0.8"}
GROUPS = (("S", 15.0), ("S", 25.0), ("SM", 15.0), ("SM", 17.0), ("SM", 19.0), ("KH", 17.0),
          ("KH", 25.0))  # fmt: skip
DRAWN = {
    "S 6007 C": "C0",
    "S 6007 E": "C1",
    "SM 6007 C": "C2",
    "KH 6007 C": "C4",
    "KH 6007 E": "C5",
}


class Held(NamedTuple):
    """What holds the balls of a bearing at a preload and a speed."""

    friction: float  # that holds the balls against their gyroscopic moment
    share: float  # gyroscopic share of the slip at the friction of the scene


def held(scene: Scene) -> Held:
    """Of a solved scene."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = bearingwear.solve(scene, "steady")
    if found.status != "ok":
        raise RuntimeError(f"{scene.name}: {found.attrs['message']}")
    used = float(np.max(found.friction_used_by_gyroscopic_moment))
    assert scene.friction.ball_race is not None
    return Held(scene.friction.ball_race * used, float(np.max(found.gyroscopic_slip_share)))


def gmn_scene(entry: CatalogueBearing, speed: float, friction: float) -> Scene:
    """A bearing of GMN at its least preload, which goes with the square of the speed."""
    assert entry.min_spring_preload is not None
    return bearingwear.new(
        designation=entry.designation,
        maker="GMN",
        preload=entry.min_spring_preload * (speed / entry.speed_oil) ** 2,
        preload_method="constant_force",
        speed=speed,
        friction=friction,
    )


def skf_scene(designation: str, speed_factor: float, friction: float) -> Scene:
    """A bearing of SKF, balls and grooves assumed by `new`; the speed factor is in mm r/min."""
    b = bearingwear.new(designation=designation, preload=1.0).bearing
    speed = speed_factor / b.pitch_diameter_mm
    load = 1e3 * skf_factors()[designation] * (1e-3 * speed) ** 2
    return bearingwear.new(
        designation=designation,
        preload=load,
        preload_method="constant_force",
        speed=speed,
        friction=friction,
    )


class Member(NamedTuple):
    """A bearing of GMN at its least preload and its largest speed."""

    entry: CatalogueBearing
    states: list[Held]  # at each of `FRICTIONS`
    rigid: Held  # at the last of them, were the rings not to grow


Groups = dict[tuple[str, float], list[Member]]


def gmn_groups() -> Groups:
    """Every bearing whose print is clear, by series and angle."""
    found: Groups = {group: [] for group in GROUPS}
    for entry in bearings():
        if entry.maker == "GMN" and entry.source == "printed":
            scenes = [gmn_scene(entry, entry.speed_oil, mu) for mu in FRICTIONS]
            rigid = held(scenes[-1].with_(RIGID))
            member = Member(entry, [held(scene) for scene in scenes], rigid)
            found[entry.designation.split()[0], entry.angle].append(member)
    return found


OPEN_GROUP = ("SM", 15.0)
"""The group that needs the least friction."""

CLOSED = {"bearing.inner_groove_factor": 0.52, "bearing.outer_groove_factor": 0.52}
RIGID = {"bearing.bore_mm": None}  # without a bore no growth is computed


def open_group_frictions(groups: Groups) -> dict[str, float]:
    """Mean friction of the group of least friction, as it is and were it otherwise."""
    means = {}
    for what, changes, share in (
        ("closed", CLOSED, 1.0),
        ("closed, rigid", CLOSED | RIGID, 1.0),
        ("half the speed", {}, 0.5),
    ):
        entries = [member.entry for member in groups[OPEN_GROUP]]
        scenes = [gmn_scene(e, share * e.speed_oil, FRICTIONS[-1]).with_(changes) for e in entries]
        means[what] = mean(np.array([held(scene).friction for scene in scenes]))
    return means


def open_group_sentence(groups: Groups) -> str:
    """Why the group of least friction needs less than 0.02."""
    own, rigid = (mean(gmn_frictions(groups, rigid=r)[OPEN_GROUP]) for r in (False, True))
    other = open_group_frictions(groups)
    series, angle = OPEN_GROUP
    return textwrap.fill(
        f"- **Least friction.** {series} of {angle:g}° needs {own:.4f}, because its grooves are "
        f"open and its rings grow at the largest speed, which flattens the outer contact: with "
        f"rigid rings it needs {rigid:.4f}, with grooves of 0.52 in both races "
        f"{other['closed']:.4f}, and with both {other['closed, rigid']:.4f}. At half the speed and "
        f"a quarter of the preload it needs {other['half the speed']:.4f}, so the choice of the "
        "speed hardly matters.",
        100,
        subsequent_indent="  ",
        break_on_hyphens=False,
    )


def preloads_over_rating() -> dict[tuple[str, float], np.ndarray]:
    """Least spring preload over the dynamic rating C, by series and angle."""
    found: dict[tuple[str, float], list[float]] = {group: [] for group in GROUPS}
    for row in rows_of("gmn"):
        if row["certain"] == "yes":
            group = row["designation"].split()[0], float(row["angle_deg"])
            found[group].append(float(row["min_spring_preload_N"]) / float(row["C_N"]))
    return {group: np.array(values) for group, values in found.items()}


def gmn_frictions(groups: Groups, rigid: bool = False) -> dict[tuple[str, float], np.ndarray]:
    """Friction that holds the balls of each bearing of a group, at a friction of 0.08.

    rigid: were the rings not to grow at speed.
    """
    return {
        group: np.array([(m.rigid if rigid else m.states[-1]).friction for m in members])
        for group, members in groups.items()
    }


Loads = dict[str, dict[str, list[Held]]]


def skf_groups() -> Loads:
    """Each bearing at its least load, at each of `FRICTIONS`, by the suffix of its angle."""
    return {
        suffix: {
            name: [held(skf_scene(name, SKF_SPEED, mu)) for mu in FRICTIONS]
            for name in skf_factors()
            if name.endswith(suffix)
        }
        for suffix in SKF_ANGLES
    }


def skf_frictions(group: dict[str, list[Held]]) -> np.ndarray:
    """Friction that holds the balls of each bearing of a group, at a friction of 0.08."""
    return np.array([states[-1].friction for states in group.values()])


def balls_of_nsk(scene: Scene) -> Scene | None:
    """A bearing with the balls of NSK's of the same bore and outside diameter, if there is one."""
    own = scene.bearing
    for entry in bearings():
        size = entry.bore, entry.outside
        if entry.maker == "NSK" and size == (own.bore_mm, own.outside_diameter_mm):
            return scene.with_(
                {"bearing.ball_count": entry.balls, "bearing.ball_diameter_mm": entry.ball}
            )
    return None


def skf_sentence(skf: Loads) -> str:
    """How far SKF's bearings of 25 degrees are apart, and what their assumed balls add."""
    pairs = []
    for name, states in skf["AC"].items():
        other = balls_of_nsk(skf_scene(name, SKF_SPEED, FRICTIONS[-1]))
        if other is not None:
            pairs.append((states[-1].friction, held(other).friction))
    off = [100.0 * np.abs(np.array(one) / mean(np.array(one)) - 1.0).max()
           for one in zip(*pairs, strict=True)]  # fmt: skip
    every = skf_frictions(skf["AC"])
    most = 100.0 * np.abs(every / mean(every) - 1.0).max()
    return textwrap.fill(
        f"- **SKF, 25°.** No bearing is further than {most:.0f} % from the mean. The balls are "
        f"assumed from the size alone: with those of NSK's bearings of the same size, the "
        f"{len(pairs)} bearings of series 72 are within {off[1]:.1f} % of their mean, where the "
        f"assumed balls give {off[0]:.1f} %.",
        100,
        subsequent_indent="  ",
        break_on_hyphens=False,
    )


def mean(values: np.ndarray) -> float:
    """Geometric mean."""
    return float(np.exp(np.mean(np.log(values))))


def lines(groups: Groups, skf: Loads) -> str:
    """A line for each group of either maker."""
    heads = ("group", "bearings", "F/C", "scatter", "n dm", "friction", "range", "rigid",
             *(f"share {mu:g}" for mu in FRICTIONS))  # fmt: skip
    ratios, rows = preloads_over_rating(), []
    for (series, angle), members in groups.items():
        friction = gmn_frictions(groups)[series, angle]
        rigid = gmn_frictions(groups, rigid=True)[series, angle]
        ratio = ratios[series, angle]
        speeds = [m.entry.speed_oil * m.entry.pitch for m in members]
        rows.append(
            (f"GMN {series}, {angle:g}°", str(len(members)),
             f"{mean(ratio):.4f}", f"{100.0 * np.std(np.log(ratio)):.1f} %",
             f"{1e-6 * np.median(speeds):.2f}", f"{mean(friction):.4f}",
             f"{friction.min():.3f} to {friction.max():.3f}", f"{mean(rigid):.4f}",
             *(f"{np.mean([m.states[k].share for m in members]):.2f}" for k in (0, 1)))
        )  # fmt: skip
    for suffix, members in skf.items():
        friction = skf_frictions(members)
        rows.append(
            (f"SKF {suffix}, {SKF_ANGLES[suffix]:g}°", str(len(members)), "-", "-",
             f"{1e-6 * SKF_SPEED:.2f}", f"{mean(friction):.4f}",
             f"{friction.min():.3f} to {friction.max():.3f}", "-",
             *(f"{np.mean([states[k].share for states in members.values()]):.2f}" for k in (0, 1)))
        )  # fmt: skip
    return table(heads, rows, 1)


def sentences(groups: Groups, skf: Loads) -> str:
    """What the two makers have in common."""
    means = [mean(values) for values in gmn_frictions(groups).values()]
    rigid = [mean(values) for values in gmn_frictions(groups, rigid=True).values()]
    of_skf = " and ".join(
        f"{mean(friction):.4f} for {len(friction)} bearings of {SKF_ANGLES[suffix]:g} degrees "
        f"(scatter {100.0 * np.std(np.log(friction)):.1f} %)"
        for suffix, friction in ((suffix, skf_frictions(group)) for suffix, group in skf.items())
    )
    return textwrap.fill(
        f"At GMN's least preload and largest speed, the mean friction that holds the balls lies "
        f"between {min(means):.4f} and {max(means):.4f} in the seven groups; with rigid rings, "
        f"between {min(rigid):.4f} and {max(rigid):.4f}. At SKF's least load it is {of_skf}, "
        "although their balls and grooves are assumed.",
        100,
        break_on_hyphens=False,
    )


def drawn() -> Figure:
    """Friction that holds the balls, and slip shares, over speed at the makers' least preload."""
    figure, ((friction, share),) = new_figure(1, 2, 7.2, 3.2)
    for name, color in DRAWN.items():
        entry = entry_of("GMN", name)[0]
        assert entry.pitch is not None
        speeds = entry.speed_oil * np.linspace(0.1, 1.0, 10)
        x = 1e-6 * entry.pitch * speeds
        states = [[held(gmn_scene(entry, n, mu)) for n in speeds] for mu in FRICTIONS]
        friction.plot(x, [one.friction for one in states[1]], color=color)
        for mu_states, style in zip(states, ("--", "-"), strict=True):
            share.plot(x, [one.share for one in mu_states], color=color, linestyle=style)
    factors = np.linspace(0.05e6, 0.8e6, 6)
    for suffix, color in SKF_COLORS.items():
        names = [name for name in skf_factors() if name.endswith(suffix)]
        for mu in FRICTIONS:
            states = [[held(skf_scene(name, one, mu)) for one in factors] for name in names]
            shares = np.array([[one.share for one in own] for own in states])
            share.fill_between(1e-6 * factors, shares.min(0), shares.max(0), color=color, zorder=1)
        own = np.array([[one.friction for one in own] for own in states])
        friction.fill_between(1e-6 * factors, own.min(0), own.max(0), color=color, zorder=1)
    for axes in (friction, share):
        axes.set_xlabel("speed × pitch diameter (10⁶ mm/min)")
        start_at_zero(axes)
    friction.set_title("friction that holds the balls", loc="left")
    share.set_title("gyroscopic share of the slip", loc="left")
    handles = [
        *(key(f"GMN {name}", color=color) for name, color in DRAWN.items()),
        *(
            key(f"SKF, {SKF_ANGLES[suffix]:g}°", color=color, linewidth=6.0)
            for suffix, color in SKF_COLORS.items()
        ),
        key("friction 0.08", color="0.2"),
        key("friction 0.05", color="0.2", linestyle="--"),
    ]
    frame(
        figure,
        "At two makers' least preloads, a friction of about 0.02 to 0.05 holds the balls",
        handles,
        4,
    )
    return figure


def main() -> None:
    groups, skf = gmn_groups(), skf_groups()
    blocks = {
        "minimum": f"{sentences(groups, skf)}\n\n{lines(groups, skf)}",
        "open": open_group_sentence(groups),
        "skf": skf_sentence(skf),
    }
    page = PAGE.read_text(encoding="utf-8")
    for name, block in blocks.items():
        page = with_block(page, name, block)
    PAGE.write_text(page, encoding="utf-8")
    print(lines(groups, skf))
    save(drawn(), [FIGURES / "minimum_preload.svg"])


if __name__ == "__main__":
    main()
