"""Designations of common bearings, and the radial clearance of deep groove bearings.

Sizes are the boundary dimensions of ISO 15 (dimension series 10, 02, 03, 19 and, of the smallest,
18), clearances those of ISO 5753-1 for deep groove bearings with a cylindrical bore, before they
are mounted. The balls, the grooves and the preload are the maker's choice: no designation tells
them; of three makers `catalogue` does.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from bearingwear.scene.checking.errors import SceneError, shown
from bearingwear.scene.checking.units import converted
from bearingwear.scene.new.catalogue import (
    CatalogueBearing,
    entry_of,
    has_bearing,
    makers_with,
    nearest_names,
)
from bearingwear.scene.new.letters import (
    CERAMIC_BALLS,
    CERAMIC_PREFIX,
    GMN_SERIES,
    PAIR,
    PAIR_ALONE,
    STEEL_PREFIX,
    Letters,
    gmn_parts,
    letters_of,
)

LONGEST_DESIGNATION = 40  # characters of a designation

# Outside diameter x width [mm] by bore code: 00 to 22, then every second one to 40.
_CODES = (*range(23), *range(24, 41, 2))
_SERIES = {
    "10": "26x8 28x8 32x9 35x10 42x12 47x12 55x13 62x14 68x15 75x16 80x16 90x18 95x18 100x18 "
    "110x20 115x20 125x22 130x22 140x24 145x24 150x24 160x26 170x28 180x28 200x33 210x33 225x35 "
    "240x38 260x42 280x46 290x46 310x51",
    "02": "30x9 32x10 35x11 40x12 47x14 52x15 62x16 72x17 80x18 85x19 90x20 100x21 110x22 120x23 "
    "125x24 130x25 140x26 150x28 160x30 170x32 180x34 190x36 200x38 215x40 230x40 250x42 270x45 "
    "290x48 310x52 320x52 340x55 360x58",
    "03": "35x11 37x12 42x13 47x14 52x15 62x17 72x19 80x21 90x23 100x25 110x27 120x29 130x31 "
    "140x33 150x35 160x37 170x39 180x41 190x43 200x45 215x47 225x49 240x50 260x55 280x58 300x62 "
    "320x65 340x68 360x72 380x75 400x78 420x80",
    "19": "22x6 24x6 28x7 30x7 37x9 42x9 47x9 55x10 62x12 68x12 72x12 80x13 85x13 90x13 100x16 "
    "105x16 110x16 120x18 125x18 130x18 140x20 145x20 150x20 165x22 180x24 190x24 210x28 220x28 "
    "230x28 250x33 260x33 280x38",
}
_SERIES_OF = {
    "70": "10", "72": "02", "73": "03", "719": "19", "79": "19", "60": "10", "62": "02", "63": "03"
}  # fmt: skip

# The smallest: the last digit is the bore [mm]; from the first digit in brackets on.
_SMALL = {
    "60": (4, "12x4 14x5 17x6 19x6 22x7 24x7"),
    "62": (3, "10x4 13x5 16x5 19x6 22x7 24x8 26x8"),
    "68": (2, "5x1.5 7x2 9x2.5 11x3 13x3.5 14x3.5 16x4 17x4"),
    "69": (2, "6x2.3 8x3 11x4 13x4 15x5 17x5 19x6 20x6"),
}

ANGLES = {
    "C": 15.0, "FB": 18.0, "FE": 18.0, "AC": 25.0, "A5": 25.0, "AD": 25.0, "E": 25.0, "A": 30.0,
    "B": 40.0,
}  # fmt: skip
"""Contact angle [degree] by the suffix of an angular contact bearing: FB and FE are SKF's, AD is
NTN's."""

_MAKERS_DIFFER = ("E", "A")
"""Suffixes that are not every maker's: 25 degrees are E, AC, A5 or AD, and 30 degrees A or none."""

CLEARANCES = ("C2", "CN", "C3")
"""Groups of radial clearance of deep groove bearings: small, normal, large."""

# Bore up to [mm], then least and largest clearance [um] of each group.
_CLEARANCE_TABLE: tuple[tuple[Any, ...], ...] = (
    (10, (0, 7), (2, 13), (8, 23)),
    (18, (0, 9), (3, 18), (11, 25)),
    (24, (0, 10), (5, 20), (13, 28)),
    (30, (1, 11), (5, 20), (13, 28)),
    (40, (1, 11), (6, 20), (15, 33)),
    (50, (1, 11), (6, 23), (18, 36)),
    (65, (1, 15), (8, 28), (23, 43)),
    (80, (1, 15), (10, 30), (25, 51)),
    (100, (1, 18), (12, 36), (30, 58)),
    (120, (2, 20), (15, 41), (36, 66)),
    (140, (2, 23), (18, 48), (41, 81)),
    (160, (2, 23), (18, 53), (46, 91)),
    (180, (2, 25), (20, 61), (53, 102)),
    (200, (2, 30), (25, 71), (63, 117)),
)

ALLOWED = (
    "70xx, 72xx, 73xx, 719xx (suffix C, FB, FE, AC, A5, AD, E, A or B), 60xx, 62xx, 63xx "
    "(suffix C2, CN or C3), xx from 00 to 22 or an even number from 24 to 40, 604 to 609, 623 to "
    "629, 682 to 689, 692 to 699; or --bore, --outside and --contact-angle"
)


class Designation(NamedTuple):
    """Size and angle that a designation stands for."""

    # boundary dimensions [mm]; the width is 0 where it is not known
    bore: float
    outside: float
    width: float = 0.0
    name: str = ""  # the designation itself, empty for a bearing without one
    deep_groove: bool = False  # its nominal contact angle is zero
    angle: float | None = None  # of an angular contact bearing [degree], where a suffix says it
    angle_rule: str = ""  # why the angle is assumed, where makers mean different ones by the suffix
    clearance: str = ""  # group of radial clearance, where a suffix says it
    letters: Letters = Letters()  # what other letters say: balls, preload, pair
    entry: CatalogueBearing | None = None  # the bearing of a maker's catalogue


_PREFIX = rf"(?:{CERAMIC_PREFIX}|{STEEL_PREFIX})?"

_NUMBER = r"(?P<series>(?:7[0239]|719|6[023])(?=\d\d(?!\d))|6[0289](?=\d(?!\d)))(?P<code>\d+)"

_GMN_SIZES = {"60": "70", "62": "72", "619": "719"}
"""Series of the same size with numbers of its own, by that of GMN's numbers."""

_GMN_ANGLES = {"C": 15.0, "18": 18.0, "E": 25.0}
_GMN_OPEN_ANGLES = {"SM60": 17.0, "SM619": 19.0, "KH60": 17.0, "KH619": 17.0}
"""Contact angle [degree] of suffix C in series whose grooves are open, of the largest sizes."""


class _Parts(NamedTuple):
    """The parts of a designation that is made of a number and letters around it."""

    prefix: str
    series: str  # 70, 719, 62
    code: str  # of the bore: 08
    rest: str  # letters after the number, with separators

    @property
    def number(self) -> str:
        """Returns series and code of the bore: 7008."""
        return f"{self.series}{self.code}"

    @property
    def is_deep_groove(self) -> bool:
        """Whether the series is one of deep groove bearings."""
        return self.series.startswith("6")


def designation_of(text: str) -> Designation:
    """Reads a designation: 7008C, 71914 E, 6204-C3, 608, 7008CD/P4A, B7008-C-T-P4S.

    Only bearings of GMN may come from a catalogue.

    SceneError: a designation that is not known, with what is allowed.
    """
    upper_text = text.strip().upper()
    if len(upper_text) > LONGEST_DESIGNATION:
        raise _unknown_error(text, ALLOWED)
    for maker_designation in (_gmn_spindle, _nsk_robust):
        if (spindle := maker_designation(upper_text)) is not None:
            return spindle
    match = re.fullmatch(
        rf"(?P<prefix>[A-Z\d]*?)[\s/_-]*{_NUMBER}(?P<rest>[A-Z\d\s/_.-]*)", upper_text
    )
    size = _size(match["series"], match["code"]) if match else None
    if match is None or size is None:
        _check_ntn_series(text)
        raise _unknown_error(text, ALLOWED)
    parts = _Parts(**match.groupdict())
    similar_spindles = _gmn_names(upper_text, parts.prefix)
    _check_letters(text, parts, similar_spindles)
    read_suffix = _clearance_suffix if parts.is_deep_groove else _angle_suffix
    suffix, ignored = read_suffix(parts.rest)
    if ignored is None:
        raise _unknown_error(text, _allowed_suffixes(parts, similar_spindles))
    name = f"{parts.number}{suffix}"
    letters = letters_of(parts.prefix, ignored, PAIR_ALONE if parts.is_deep_groove else PAIR)
    if parts.is_deep_groove:
        return Designation(
            **size._asdict(), name=name, deep_groove=True, clearance=suffix, letters=letters
        )
    rule = ""
    if suffix in _MAKERS_DIFFER:
        rule = f"suffix {suffix}, whose meaning depends on the maker"
    return Designation(
        **size._asdict(),
        name=name,
        angle=ANGLES.get(suffix),
        angle_rule=rule,
        letters=letters,
    )


def _check_letters(text: str, parts: _Parts, similar_spindles: str) -> None:
    """Raises SceneError for letters before a number that no maker uses, or a second number.

    It also refuses S or SS before the number of a deep groove bearing, which may be one of GMN.

    similar_spindles: names of GMN's bearings of that prefix; "" if it is none of its series.
    """
    if similar_spindles and parts.prefix != "S":
        raise _unknown_error(text, f"{similar_spindles} (GMN spindle bearings)")
    if not re.fullmatch(_PREFIX, parts.prefix):
        prefixes = (
            "B, S, HS, HSS, RS, W, SS, HC, HCB, HCS, XC, XCB, XCS, HY, CB, CH, 5S or 3NC before "
            "the number; or --bore, --outside and --contact-angle"
        )
        raise _unknown_error(text, f"no letters or {prefixes}")
    has_suffix = bool(parts.rest.strip(" /_-."))
    if parts.is_deep_groove and parts.prefix in ("S", "SS") and not has_suffix:
        spindle = f"{parts.prefix}{parts.number} C or E (GMN spindle bearing)"
        raise _unknown_error(text, f"{parts.number} (deep groove), or {spindle}")
    if re.search(r"(?<!\d)[67]\d{2,4}(?!\d)", parts.rest):
        raise SceneError("", f"got {shown(text)}, expected one", source="designation")


def _allowed_suffixes(parts: _Parts, similar_spindles: str) -> str:
    """Returns what is allowed after the number of a designation, in words.

    similar_spindles: names of GMN's bearings of that prefix; "" if it is none of its series.
    """
    suffixes = CLEARANCES if parts.is_deep_groove else tuple(ANGLES)
    allowed = f"{parts.number} alone, or with {', '.join(suffixes)}"
    if similar_spindles:
        allowed += f", or {similar_spindles} (GMN spindle bearings)"
    if not parts.is_deep_groove:
        allowed += f"; for another angle, {parts.number} with --contact-angle"
    return allowed


_NTN_HIGH_SPEED = re.compile(r"(?:HSE|BNS|BNT)(?P<series>[029])(?P<code>\d\d)")
_NTN_SIZES = {"0": "70", "2": "72", "9": "719"}
"""Series of the same size, by the first digit in NTN's high-speed series."""


def _check_ntn_series(text: str) -> None:
    """Refuses a high-speed bearing of NTN: its balls differ from those assumed for its size."""
    match = _NTN_HIGH_SPEED.search(text.upper())
    if match and _size(_NTN_SIZES[match["series"]], match["code"]):
        name = f"{_NTN_SIZES[match['series']]}{match['code']}"
        balls = "--balls, --ball-diameter and --contact-angle of NTN's high-speed series"
        raise _unknown_error(text, f"{name} with {balls}")


def _gmn_names(designation: str, prefix: str) -> str:
    """Returns similar designations of GMN, separated by commas; "" if the prefix is not GMN's."""
    if not re.fullmatch(GMN_SERIES, prefix):
        return ""
    return ", ".join(nearest_names("GMN", designation))


def _gmn_spindle(designation: str) -> Designation | None:
    """Reads a spindle bearing of GMN, whether in its catalogue or not.

    None for any other designation, and for a bore code without a size.

    SceneError: it is neither in the catalogue nor of a series whose sizes are known.
    """
    parts = gmn_parts(designation)
    if parts is None:
        return None
    letters = letters_of(parts.hybrid, parts.suffix, PAIR)
    if has_bearing("GMN", parts.name):
        entry, _ = entry_of("GMN", parts.name)
        return of_catalogue(entry, letters)
    series = _GMN_SIZES.get(parts.number[:-2])
    if series is None:
        similar = ", ".join(nearest_names("GMN", parts.name))
        raise _unknown_error(designation, f"{similar} (GMN spindle bearings)")
    size = _size(series, parts.number[-2:])
    if size is None:
        return None
    angle, rule = _GMN_ANGLES[parts.angle], f"GMN's suffix {parts.angle}"
    if parts.angle == "C":
        angle = _GMN_OPEN_ANGLES.get(parts.series + parts.number[:-2], angle)
        rule = f"{rule} in series {parts.series}"
    return Designation(
        **size._asdict(), name=parts.name, angle=angle, angle_rule=rule, letters=letters
    )


_NSK_ROBUST = re.compile(
    r"(?P<bore>\d\d\d?)B(?P<angle>[NE])R(?P<series>10|19)(?P<balls>[SHX]?)(?P<suffix>.*)"
)


def _nsk_robust(designation: str) -> Designation | None:
    """Reads a bearing of NSK's ROBUST series: 40BNR10STYNDBLP4; None for any other."""
    match = _NSK_ROBUST.fullmatch(re.sub(r"[\s/_.-]", "", designation))
    if match is None:
        return None
    bore = int(match["bore"])
    # from 20 mm on, the code of a bore is a fifth of it
    code = next((code for code, small in _SMALL_BORES.items() if small == bore), bore // 5)
    size = _size({"10": "70", "19": "719"}[match["series"]], f"{code:02d}")
    if size is None or size.bore != bore:
        return None
    letters = letters_of("", match["suffix"], PAIR)
    if match["balls"] in ("H", "X"):
        letters = letters._replace(ball_material=CERAMIC_BALLS, ball_letters=match["balls"])
    angle, rule = {"N": (18.0, "NSK's BNR"), "E": (25.0, "NSK's BER")}[match["angle"]]
    name = match[0][: match.end("series")]
    return Designation(**size._asdict(), name=name, angle=angle, angle_rule=rule, letters=letters)


def of_catalogue(entry: CatalogueBearing, letters: Letters) -> Designation:
    """Returns the designation of a catalogue's bearing with the meaning of its other letters."""
    return Designation(
        bore=entry.bore,
        outside=entry.outside,
        width=entry.width,
        name=entry.designation,
        angle=entry.angle,
        letters=letters,
        entry=entry,
    )


class _Suffix(NamedTuple):
    """The suffix for angle or clearance, and the ignored ones; None refuses the designation."""

    name: str
    ignored: str | None


def _words(text: str) -> list[str]:
    """Returns the suffixes of a text that are separated by spaces, /, _, . or -."""
    return [word for word in re.split(r"[\s/_.-]+", text) if word]


def _angle_suffix(rest: str) -> _Suffix:
    """Reads the suffixes of an angular contact bearing.

    An angle is the first suffix, and letters of the cage may follow it (CD, ACD, BECBP). Refused
    are letters next to the number that are no angle, an angle in a later suffix, and clearances.
    """
    words = _words(rest)
    if not words:
        return _Suffix("", "")
    first_word, more_words = words[0], words[1:]
    if re.match(r"U(?=C|AD)", first_word):  # NTN's standard design, before the angle: 7008UCG
        first_word, more_words = first_word[1:], [*more_words, "U"]
    for name in sorted(ANGLES, key=len, reverse=True):
        if first_word.startswith(name):
            remainder = first_word[len(name) :]
            if not remainder or remainder[0].isalpha():
                return _Suffix(name, " ".join(filter(None, [remainder, *more_words])))
    attached = rest[0].isalnum()
    other_kind = re.fullmatch(r"[A-F]\d?|CN", first_word)
    in_later_word = any(word in ANGLES for word in more_words)
    return _Suffix("", None if other_kind or attached or in_later_word else " ".join(words))


_CLEARANCE_GROUP = re.compile(r"C([1-5NM])(?!\d)")
_GROUP_AFTER_TOLERANCE = re.compile(r"(?<=^P[56])([2-5])$")  # P63: tolerance P6, group C3


def _clearance_suffix(rest: str) -> _Suffix:
    """Reads the suffixes of a deep groove bearing.

    A clearance stands anywhere (6204-2RSH/C3, 608ZZC3, P63); an angle is refused.
    """
    words = _words(rest)
    for k, word in enumerate(words):
        ceramic_letters = re.match(r"HC\d?", word)  # ceramic balls, then a clearance: HC5C3
        start = ceramic_letters.end() if ceramic_letters else 0
        match = _CLEARANCE_GROUP.search(word, start) or _GROUP_AFTER_TOLERANCE.search(word)
        if match is None:
            continue
        group = f"C{match[1]}"
        if group not in CLEARANCES:
            return _Suffix("", None)
        remainder = f"{word[: match.start()]} {word[match.end() :]}".split()
        return _Suffix(group, " ".join([*words[:k], *remainder, *words[k + 1 :]]))
    if words and re.fullmatch(r"[A-E]\d?", words[0]):
        return _Suffix("", None)
    return _Suffix("", " ".join(words))


_INCH_ROUNDING_MM = 0.3  # of a size typed in inches to two decimals, with a margin


def metric_size(bore: float, outside: float) -> str:
    """Returns the options in mm for a size that was typed in inches; "" for any other size.

    A size is taken as typed in inches where it is then in the table of sizes.
    """
    bore_mm, outside_mm = (converted(diameter, "in", "mm") or 0.0 for diameter in (bore, outside))
    for series in ("70", "72", "73", "719"):
        for code in _CODES:
            size = _size(series, f"{code:02d}")
            if size is not None and (
                abs(size.bore - bore_mm) < _INCH_ROUNDING_MM
                and abs(size.outside - outside_mm) < _INCH_ROUNDING_MM
            ):
                return f"--bore {size.bore:g} --outside {size.outside:g}"
    return ""


def clearance_range(group: str, bore: float) -> tuple[float, float] | None:
    """Returns least and largest radial clearance [um] of a group; None above the largest bore."""
    for largest_bore, *ranges in _CLEARANCE_TABLE:
        if bore <= largest_bore:
            return ranges[CLEARANCES.index(group)]
    return None


class _Size(NamedTuple):
    """Boundary dimensions of a bearing [mm]."""

    bore: float
    outside: float
    width: float


_SMALL_BORES = {0: 10.0, 1: 12.0, 2: 15.0, 3: 17.0}
"""Bores [mm] by their codes; from code 4 on, the bore is five times the code."""


def _size(series: str, code: str) -> _Size | None:
    """Returns the dimensions of a bearing; None for a code that is not in the table.

    series: such as 70 or 62.
    code: of the bore; one digit for the smallest bearings, whose bore [mm] it is.
    """
    if len(code) == 1:
        smallest_bore, sizes = _SMALL[series]
        codes = tuple(range(smallest_bore, 10))
        bore = float(code)
    else:
        sizes, codes = _SERIES[_SERIES_OF[series]], _CODES
        bore = _SMALL_BORES.get(int(code), 5.0 * int(code))
    if int(code) not in codes:
        return None
    outside, width = sizes.split()[codes.index(int(code))].split("x")
    return _Size(bore, float(outside), float(width))


def _unknown_error(text: str, allowed: str) -> SceneError:
    """Returns the error of an unknown designation.

    It says what is allowed, or names the makers whose catalogue has the designation.
    """
    makers = makers_with(text)
    if makers:
        allowed = f"--maker {' or '.join(makers)} with this designation"
    return SceneError("", f"got {shown(text)}, expected {allowed}", source="designation")
