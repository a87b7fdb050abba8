"""Draws the section of a bearing through a ball, to scale, from its scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, NamedTuple

from markupsafe import Markup

_BALL, _BALL_IN_PAIR = 110.0, 70.0
"""Diameter of the ball of a bearing, and of a pair [px], which determines the scale."""
_RING, _SHOULDER, _RELIEVED = 1.75, 0.2, 0.07
"""Assumed, over the ball diameter: width of the rings, heights of their shoulders on the loaded and
on the other side."""
_BEYOND_CONTACT = 0.08
"""Least assumed height of a loaded shoulder beyond the contact, over the ball diameter."""
_WALL = 0.35
"""Assumed thickness of a ring below its groove, over the ball diameter, if its size is missing."""
_GAP = 0.7
"""Assumed space between the rings of a pair, over the width of a ring."""
_MARGIN, _TOP = 96.0, 26.0


class RingSection(NamedTuple):
    """The section of a ring [mm]."""

    is_inner: bool
    groove: float  # radius of curvature
    rim: float  # radius of the bore, or of the outside
    shoulder: float  # radius on the loaded side


class BearingSection(NamedTuple):
    """The section of a bearing [mm]: x along the axis, z radially, the ball at x = 0."""

    ball: float  # diameter
    pitch: float  # diameter
    angle: float  # contact angle [rad]
    inner: RingSection
    outer: RingSection
    sized: bool  # whether bore and outside are known

    @property
    def normal(self) -> tuple[float, float]:
        """Returns the unit vector (x, z) from the centre of the ball to the outer contact."""
        return math.sin(self.angle), math.cos(self.angle)

    def centre(self, ring: RingSection) -> tuple[float, float]:
        """Returns the centre (x, z) of the circle of the groove of a ring."""
        x, z = self.normal
        distance = ring.groove - 0.5 * self.ball
        sign = 1.0 if ring.is_inner else -1.0
        return sign * distance * x, 0.5 * self.pitch + sign * distance * z


class _Layout(NamedTuple):
    """The positions of the bearings in the drawing."""

    scale: float  # [px/mm]
    ring_width: float  # [px]
    outer_radius: float  # largest radius of an outer ring [mm]
    centres: list[float]  # x of each bearing [px]
    width: float  # of the drawing [px]
    height: float

    def y(self, radius: float) -> float:
        """Returns the ordinate of a radius [mm] above the bearing axis [px]."""
        return _TOP + (self.outer_radius - radius) * self.scale


def section_of(bearing: Mapping[str, Any]) -> BearingSection:
    """Returns the section of a bearing; missing dimensions are assumed.

    bearing: the block of a scene.
    """
    ball, pitch = bearing["ball_diameter_mm"], bearing["pitch_diameter_mm"]
    angle = math.radians(bearing["contact_angle_deg"])
    # the shoulders reach beyond the contact at the contact angle
    shoulder_height = max(_SHOULDER, 0.5 * (1.0 - math.cos(angle)) + _BEYOND_CONTACT)
    rim_distance, shoulder_distance = (0.5 + _WALL) * ball, (0.5 - shoulder_height) * ball
    bore, outside = bearing.get("bore_mm"), bearing.get("outside_diameter_mm")
    inner_shoulder = bearing.get("inner_shoulder_mm")
    outer_shoulder = bearing.get("outer_shoulder_mm")
    return BearingSection(
        ball=ball,
        pitch=pitch,
        angle=angle,
        inner=RingSection(
            is_inner=True,
            groove=bearing["inner_groove_factor"] * ball,
            rim=0.5 * bore if bore else 0.5 * pitch - rim_distance,
            shoulder=0.5 * inner_shoulder if inner_shoulder else 0.5 * pitch - shoulder_distance,
        ),
        outer=RingSection(
            is_inner=False,
            groove=bearing["outer_groove_factor"] * ball,
            rim=0.5 * outside if outside else 0.5 * pitch + rim_distance,
            shoulder=0.5 * outer_shoulder if outer_shoulder else 0.5 * pitch + shoulder_distance,
        ),
        sized=bool(bore and outside),
    )


def sketch(scene: Mapping[str, Any], method: str = "", preload_N: float | None = None) -> Markup:
    """Returns HTML with an SVG of the section of a bearing or of a pair, and with its caption.

    scene: content of a scene file.
    method: of preload, one of `PRELOAD_METHODS`; by default that of the scene.
    preload_N: stated in the caption; by default that of the scene.
    """
    arrangement = scene.get("arrangement") or {}
    is_pair = arrangement.get("kind", "single") != "single"
    is_back_to_back = arrangement.get("orientation", "back_to_back") == "back_to_back"
    has_spring = (method or scene["operation"].get("preload_method")) == "constant_force"
    sections = [section_of(scene["bearing"])]
    if is_pair:
        second = (arrangement.get("second") or {}).get("bearing") or {}
        sections.append(section_of(scene["bearing"] | second))
    layout = _layout(sections, is_back_to_back)
    # the second bearing of a pair is the mirror image of the first; a single one has no second
    parts = [
        f'<g transform="translate({x:.1f} {layout.y(0.0):.1f}) '
        f'scale({direction * layout.scale:.4g} {-layout.scale:.4g})">{_rings_svg(section)}</g>'
        for section, x, direction in zip(sections, layout.centres, (1.0, -1.0), strict=False)
    ]
    parts.append(_preload_svg(sections[0], layout, has_spring, is_back_to_back))
    parts.append(_dimensions_svg(sections[0], layout))
    load_N = scene["operation"].get("preload_N") if preload_N is None else preload_N
    load = "" if load_N is None else f" of {load_N:.4g} N"
    text = (
        f"{'Both bearings' if is_pair else 'The bearing'} in section, to scale, new and unloaded; "
        f"preload{load} applied by a {'spring' if has_spring else 'spacer'}. "
        f"Assumed: ring width, shoulders{'' if sections[0].sized else ', ring thickness'}."
    )
    return Markup(
        f'<figure class="{"sketch pair" if is_pair else "sketch"}">'
        f'<svg viewBox="0 0 {layout.width:.0f} {layout.height:.0f}" role="img" '
        f'aria-label="{escape(text)}">{"".join(parts)}</svg>'
        f"<figcaption>{escape(text)}</figcaption></figure>"
    )


def _layout(sections: Sequence[BearingSection], is_back_to_back: bool) -> _Layout:
    """Returns the layout of a bearing or a pair, whose first bearing determines the scale.

    In a face-to-face pair, the second bearing is on the left.
    """
    is_pair = len(sections) > 1
    scale = (_BALL_IN_PAIR if is_pair else _BALL) / sections[0].ball
    ring_width = _RING * max(section.ball for section in sections) * scale
    distance = (1.0 + _GAP) * ring_width if is_pair else 0.0
    centres = [_MARGIN + 0.5 * ring_width + k * distance for k in range(len(sections))]
    inner_radius = min(section.inner.rim for section in sections)
    outer_radius = max(section.outer.rim for section in sections)
    return _Layout(
        scale=scale,
        ring_width=ring_width,
        outer_radius=outer_radius,
        centres=centres if is_back_to_back else centres[::-1],
        width=2.0 * _MARGIN + ring_width + distance,
        height=_TOP + (outer_radius - inner_radius) * scale + 96.0,  # of the texts below [px]
    )


def _rings_svg(section: BearingSection) -> str:
    """Returns SVG of both rings, the ball and its line of contact, in axes of the section [mm]."""
    x, z = section.normal
    middle = 0.5 * section.pitch
    reach = 0.95 * section.ball
    return (
        f"{_ring_svg(section, section.inner)}{_ring_svg(section, section.outer)}"
        f'<circle class="ball" cx="0" cy="{middle:.4f}" r="{0.5 * section.ball:.4f}"/>'
        f'<path class="contact" d="M{-reach * x:.4f} {middle - reach * z:.4f}'
        f'L{reach * x:.4f} {middle + reach * z:.4f}"/>'
        f'<path class="thin" d="M0 {middle - reach:.4f}V{middle + reach:.4f}"/>'
    )


def _ring_svg(section: BearingSection, ring: RingSection) -> str:
    """Returns the SVG path of a ring with its groove [mm].

    The inner ring is loaded at -x, the outer one at +x.
    """
    sign = 1.0 if ring.is_inner else -1.0
    groove_bottom = 0.5 * section.pitch - sign * 0.5 * section.ball
    relieved_shoulder = groove_bottom + sign * _RELIEVED * section.ball
    left, right = ring.shoulder, relieved_shoulder
    if not ring.is_inner:
        left, right = right, left
    radius, rim = ring.groove, ring.rim
    centre_x, centre_z = section.centre(ring)
    # the ends of the groove are where its circle meets the shoulders
    left_x = centre_x - math.sqrt(max(radius * radius - (left - centre_z) ** 2, 0.0))
    right_x = centre_x + math.sqrt(max(radius * radius - (right - centre_z) ** 2, 0.0))
    half_width = 0.5 * _RING * section.ball
    return (
        f'<path class="ring" d="M{-half_width:.4f} {rim:.4f}V{left:.4f}H{left_x:.4f}'
        f"A{radius:.4f} {radius:.4f} 0 0 {int(ring.is_inner)} {right_x:.4f} {right:.4f}"
        f'H{half_width:.4f}V{rim:.4f}Z"/>'
    )


def _preload_svg(
    section: BearingSection, layout: _Layout, has_spring: bool, is_back_to_back: bool
) -> str:
    """Returns SVG of the spring or spacer that maintains the preload, and of arrows where it acts.

    A single bearing also has a wall behind its outer ring.

    section: of the first bearing.
    """
    half_width = 0.5 * layout.ring_width
    element = _spring_svg if has_spring else _spacer_svg
    if len(layout.centres) == 1:
        y, left = _ring_y(section, layout, section.inner), layout.centres[0] - half_width
        wall_x = layout.centres[0] + half_width + 4
        wall_y = _ring_y(section, layout, section.outer)
        wall = f'<path class="ground" d="M{wall_x:.1f} {wall_y - 24:.1f}v48"/>'
        return wall + element(left - 58, left - 22, y) + _arrow_svg(left - 20, left - 1, y)
    first, second = sorted(layout.centres)
    # the element lies between rings of one kind, and arrows act on the other ones
    element_ring, pressed_ring = section.outer, section.inner
    if not is_back_to_back:
        element_ring, pressed_ring = pressed_ring, element_ring
    element_y = _ring_y(section, layout, element_ring)
    arrow_y = _ring_y(section, layout, pressed_ring)
    left, right = first - half_width, second + half_width
    return (
        element(first + half_width, second - half_width, element_y)
        + _arrow_svg(left - 30, left - 2, arrow_y)
        + _arrow_svg(right + 30, right + 2, arrow_y)
    )


def _ring_y(section: BearingSection, layout: _Layout, ring: RingSection) -> float:
    """Returns the ordinate of the middle of a ring's side [px]."""
    sign = -1.0 if ring.is_inner else 1.0
    groove_bottom = 0.5 * section.pitch + sign * 0.5 * section.ball
    return layout.y(0.5 * (ring.rim + groove_bottom))


def _spacer_svg(left: float, right: float, y: float) -> str:
    """Returns SVG of a spacer between two abscissae, with its axis at the ordinate y [px]."""
    return (
        f'<rect class="spacer" x="{left:.1f}" y="{y - 9:.1f}" width="{right - left:.1f}" '
        f'height="18"/>'
    )


def _spring_svg(left: float, right: float, y: float) -> str:
    """Returns SVG of a spring between two abscissae, with its axis at the ordinate y [px]."""
    turns = 6
    step = (right - left) / (2 * turns)
    zigzag = "".join(f"l{step:.2f} {-18 if k % 2 else 18}" for k in range(2 * turns - 1))
    ends = f"M{left:.1f} {y - 12:.1f}v24M{right:.1f} {y - 12:.1f}v24"
    return f'<path class="spring" d="{ends}M{left:.1f} {y - 9:.1f}{zigzag}"/>'


def _arrow_svg(start: float, end: float, y: float) -> str:
    """Returns SVG of an arrow from `start` to `end`, two abscissae, at the ordinate y [px]."""
    head = math.copysign(7.0, end - start)
    return (
        f'<path class="load" d="M{start:.1f} {y:.1f}H{end:.1f}'
        f'M{end - head:.1f} {y - 5:.1f}L{end:.1f} {y:.1f}l{-head:.1f} 5"/>'
    )


def _dimensions_svg(section: BearingSection, layout: _Layout) -> str:
    """Returns SVG of the dimensions of the first bearing as text, and of a bar as a scale.

    The bar is the longest of 1, 2 or 5 times a power of ten [mm] that fits into the margin.
    """
    ball = section.ball
    inner_factor, outer_factor = section.inner.groove / ball, section.outer.groove / ball
    lines = [
        f"ball ø {ball:.4g} mm, pitch circle ø {section.pitch:.4g} mm",
        f"groove factors {inner_factor:.4g} (inner), {outer_factor:.4g} (outer)",
    ]
    if section.sized:
        lines[0] += f", {2 * section.inner.rim:.4g} × {2 * section.outer.rim:.4g} mm"
    text_x, text_y = 0.5 * layout.width, layout.height - 36.0
    texts = "".join(
        f'<text x="{text_x:.1f}" y="{text_y + 20 * k:.1f}" text-anchor="middle">{text}</text>'
        for k, text in enumerate(lines)
    )
    reach = 0.95 * ball * layout.scale
    angle_x = layout.centres[0] + reach * math.sin(0.5 * section.angle) + 2
    angle_y = layout.y(0.5 * section.pitch) - reach - 4
    round_lengths = [n * p for p in (0.01, 0.1, 1.0, 10.0, 100.0) for n in (1, 2, 5)]
    length = max(length for length in round_lengths if length * layout.scale < _MARGIN - 14.0)
    return (
        f'<text x="{angle_x:.1f}" y="{angle_y:.1f}" '
        f'text-anchor="middle">{math.degrees(section.angle):.3g}°</text>{texts}'
        f'<path class="bar" d="M12 {_TOP + 6:.1f}v-6h{length * layout.scale:.1f}v6"/>'
        f'<text x="12" y="{_TOP - 6:.1f}">{length:g} mm</text>'
    )
