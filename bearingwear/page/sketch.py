"""A bearing's section through a ball, to scale from its scene."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from typing import Any, NamedTuple

from markupsafe import Markup

_BALL = (110.0, 70.0)
"""Diameter of the ball of a bearing, and of a pair [px]; the scale follows from it."""
_RING, _SHOULDER, _RELIEVED = 1.75, 0.2, 0.07
"""Assumed, over the ball diameter: width of the rings, heights of their shoulders on the loaded and
on the other side."""
_WALL = 0.35
"""Assumed thickness of a ring below its groove, over the ball diameter, if its size is missing."""
_GAP = 0.7
"""Between the rings of a pair as drawn, over the width of one."""
_MARGIN, _TOP = 96.0, 26.0


class BearingSection(NamedTuple):
    """A bearing's section [mm]: x along the axis, z radially, its ball at x = 0."""

    ball: float
    pitch: float
    angle: float
    grooves: tuple[float, float]  # radii, inner and outer
    rims: tuple[float, float]  # radii of the bore and of the outside
    shoulders: tuple[float, float]  # radii on the loaded sides
    sized: bool  # whether bore and outside are known

    @property
    def normal(self) -> tuple[float, float]:
        """From the ball's centre to the outer contact."""
        return math.sin(self.angle), math.cos(self.angle)

    def centre(self, inner: bool) -> tuple[float, float]:
        """Of the groove's circle."""
        x, z = self.normal
        away = self.grooves[not inner] - 0.5 * self.ball
        sign = 1.0 if inner else -1.0
        return sign * away * x, 0.5 * self.pitch + sign * away * z


def section_of(bearing: Mapping[str, Any]) -> BearingSection:
    """The section of a scene's bearing; what its data leave open is assumed."""
    ball, pitch = bearing["ball_diameter_mm"], bearing["pitch_diameter_mm"]
    angle = math.radians(bearing["contact_angle_deg"])
    # high enough for the contact
    high = 0.5 - max(_SHOULDER, 0.5 * (1.0 - math.cos(angle)) + 0.08)
    bore, outside = bearing.get("bore_mm"), bearing.get("outside_diameter_mm")
    thick = (0.5 + _WALL) * ball

    inner, outer = bearing.get("inner_shoulder_mm"), bearing.get("outer_shoulder_mm")
    return BearingSection(
        ball,
        pitch,
        angle,
        (bearing["inner_groove_factor"] * ball, bearing["outer_groove_factor"] * ball),
        (
            0.5 * bore if bore else 0.5 * pitch - thick,
            0.5 * (outside or pitch) + (0.0 if outside else thick),
        ),
        (
            0.5 * inner if inner else 0.5 * pitch - high * ball,
            0.5 * outer if outer else 0.5 * pitch + high * ball,
        ),
        bool(bore and outside),
    )


def sketch(scene: Mapping[str, Any], method: str = "", preload_N: float | None = None) -> Markup:
    """The section of a bearing, or of both of a pair, with what loads it, as SVG with a caption.

    method: how the preload is applied, if not as the scene says.
    preload_N: if not the scene's.
    """
    arrangement = scene.get("arrangement") or {}
    pair = arrangement.get("kind", "single") != "single"
    bearings = [scene["bearing"]]
    if pair:
        bearings.append(scene["bearing"] | ((arrangement.get("second") or {}).get("bearing") or {}))
    sections = [section_of(one) for one in bearings]
    first = sections[0]
    scale = _BALL[pair] / first.ball
    width = _RING * max(one.ball for one in sections) * scale
    low = min(one.rims[0] for one in sections)
    high = max(one.rims[1] for one in sections)
    step = (1.0 + _GAP) * width if pair else 0.0
    size = (2.0 * _MARGIN + width + step, _TOP + (high - low) * scale + 96.0)
    spring = (method or scene["operation"].get("preload_method")) == "constant_force"
    load = scene["operation"].get("preload_N") if preload_N is None else preload_N
    outward = arrangement.get("orientation", "back_to_back") == "back_to_back"
    places = [_MARGIN + 0.5 * width + k * step for k in range(len(sections))]
    if not outward:
        places.reverse()
    parts = []
    for k, (one, x) in enumerate(zip(sections, places, strict=True)):
        flip = -1.0 if k else 1.0
        parts.append(
            f'<g transform="translate({x:.1f} {_TOP + high * scale:.1f}) '
            f'scale({flip * scale:.4g} {-scale:.4g})">{_rings(one)}</g>'
        )
    parts.append(_loads(sections, places, (width, scale, high), spring=spring, outward=outward))
    parts.append(_words(first, places[0], (scale, high), size))
    way = "spring" if spring else "spacer"
    known = "" if first.sized else ", ring thickness"
    text = (
        f"{'Both bearings' if pair else 'The bearing'} in section, to scale, new and unloaded; "
        f"preload{'' if load is None else f' of {load:.4g} N'} applied by a {way}. "
        f"Assumed: ring width, shoulders{known}."
    )
    return Markup(
        f'<figure class="sketch{" pair" * pair}">'
        f'<svg viewBox="0 0 {size[0]:.0f} {size[1]:.0f}" role="img" '
        f'aria-label="{escape(text)}">{"".join(parts)}</svg>'
        f"<figcaption>{escape(text)}</figcaption></figure>"
    )


def _rings(one: BearingSection) -> str:
    """Both rings, the ball and its line of contact, in mm."""
    half = 0.5 * _RING * one.ball
    x, z = one.normal
    mid = 0.5 * one.pitch
    ring = ""
    for inner in (True, False):
        rim = one.rims[not inner]
        sign = 1.0 if inner else -1.0  # the loaded shoulder of the inner ring is at -x
        bottom = mid - sign * 0.5 * one.ball
        lands = {
            True: one.shoulders[not inner],
            False: bottom + sign * _RELIEVED * one.ball,
        }
        left, right = (lands[inner], lands[not inner])
        cx, cz = one.centre(inner)
        r = one.grooves[not inner]
        ends = [
            (cx + side * math.sqrt(max(r * r - (land - cz) ** 2, 0.0)), land)
            for side, land in ((-1.0, left), (1.0, right))
        ]
        sweep = 0 if inner else 1
        ring += (
            f'<path class="ring" d="M{-half:.4f} {rim:.4f}V{left:.4f}H{ends[0][0]:.4f}'
            f"A{r:.4f} {r:.4f} 0 0 {1 - sweep} {ends[1][0]:.4f} {right:.4f}"
            f'H{half:.4f}V{rim:.4f}Z"/>'
        )
    reach = 0.95 * one.ball
    return (
        f'{ring}<circle class="ball" cx="0" cy="{mid:.4f}" r="{0.5 * one.ball:.4f}"/>'
        f'<path class="contact" d="M{-reach * x:.4f} {mid - reach * z:.4f}'
        f'L{reach * x:.4f} {mid + reach * z:.4f}"/>'
        f'<path class="thin" d="M0 {mid - reach:.4f}V{mid + reach:.4f}"/>'
    )


def _loads(
    sections: list[BearingSection],
    places: list[float],
    frame: tuple[float, float, float],
    *,
    spring: bool,
    outward: bool,
) -> str:
    """What holds the preload, and where it acts."""
    width, scale, high = frame
    half = 0.5 * width

    def radius(inner: bool) -> float:
        """Height of the middle of a ring's side."""
        one = sections[0]
        edge = 0.5 * one.pitch + (-1.0 if inner else 1.0) * 0.5 * one.ball
        return _TOP + (high - 0.5 * (one.rims[not inner] + edge)) * scale

    if len(places) == 1:
        y, right = radius(True), places[0] + half
        left = places[0] - half
        wall = f'<path class="ground" d="M{right + 4:.1f} {radius(False) - 24:.1f}v48"/>'
        return wall + _held(left - 58, left - 22, y, spring) + _arrow(left - 20, left - 1, y)
    a, b = sorted(places)
    y = radius(not outward)
    ends = radius(outward)
    inward = _arrow(a - half - 30, a - half - 2, ends) + _arrow(b + half + 30, b + half + 2, ends)
    return _held(a + half, b - half, y, spring) + inward


def _held(left: float, right: float, y: float, spring: bool) -> str:
    """A spring or a spacer between two places."""
    if not spring:
        return (
            f'<rect class="spacer" x="{left:.1f}" y="{y - 9:.1f}" width="{right - left:.1f}" '
            f'height="18"/>'
        )
    turns = 6
    step = (right - left) / (2 * turns)
    zigzag = "".join(f"l{step:.2f} {-18 if k % 2 else 18}" for k in range(2 * turns - 1))
    ends = f"M{left:.1f} {y - 12:.1f}v24M{right:.1f} {y - 12:.1f}v24"
    return f'<path class="spring" d="{ends}M{left:.1f} {y - 9:.1f}{zigzag}"/>'


def _arrow(start: float, end: float, y: float) -> str:
    head = math.copysign(7.0, end - start)
    return (
        f'<path class="load" d="M{start:.1f} {y:.1f}H{end:.1f}'
        f'M{end - head:.1f} {y - 5:.1f}L{end:.1f} {y:.1f}l{-head:.1f} 5"/>'
    )


def _words(
    one: BearingSection, x: float, frame: tuple[float, float], size: tuple[float, float]
) -> str:
    """Dimensions of the first bearing, and a bar of a round length."""
    scale, high = frame
    mid = _TOP + (high - 0.5 * one.pitch) * scale
    rounds = [n * p for p in (0.01, 0.1, 1.0, 10.0, 100.0) for n in (1, 2, 5)]
    length = max(one for one in rounds if one * scale < _MARGIN - 14.0)
    foot = size[1] - 36.0
    reach = 0.95 * one.ball * scale
    lines = [
        f"ball ø {one.ball:.4g} mm, pitch circle ø {one.pitch:.4g} mm",
        f"groove factors {one.grooves[0] / one.ball:.4g} (inner), {one.grooves[1] / one.ball:.4g} "
        "(outer)",
    ]
    if one.sized:
        lines[0] += f", {2 * one.rims[0]:.4g} × {2 * one.rims[1]:.4g} mm"
    texts = "".join(
        f'<text x="{0.5 * size[0]:.1f}" y="{foot + 20 * k:.1f}" text-anchor="middle">{text}</text>'
        for k, text in enumerate(lines)
    )
    return (
        f'<text x="{x + reach * math.sin(0.5 * one.angle) + 2:.1f}" y="{mid - reach - 4:.1f}" '
        f'text-anchor="middle">{math.degrees(one.angle):.3g}°</text>{texts}'
        f'<path class="bar" d="M12 {_TOP + 6:.1f}v-6h{length * scale:.1f}v6"/>'
        f'<text x="12" y="{_TOP - 6:.1f}">{length:g} mm</text>'
    )
