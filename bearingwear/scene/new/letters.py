"""Letters of a designation beside size and angle: balls, class of preload, pair.

A letter that says angle, type or material of the balls is understood here or refused, never
dropped. What is left (cage, seals, tolerance, grease) changes no number of a scene.

Sources: NSK super-precision bearings, p. 49 (SN24, DB, EL to H), and its ROBUST series
(https://paperzz.com/doc/7289087: S, H, X); GMN catalogue 4000 0813 EN, pp. 20 and 50 (HY, S, SM,
KH, C, E, 18, UL, UM, US); SNFA general catalogue, p. 63 (NS, angle digit); SKF rolling bearings,
p. 406 (AC, A, B; CA, CB, CC), and NTN's nomenclature (https://nodeshk.com/ntn, 5S). Classes of
preload of NTN (GN, GM, GH), SKF (A, B, C) and FAG (UL, UM, UH) stand beside each other in the
interchange table of https://eibc.in/prefix-suffix-guide.php. The ceramic letters of FAG (HC, XC),
SKF (HC), IBC (CB), SNR (CH) and Koyo (3NC), FAG's series with smaller balls (HS, HC, XC, RS), and
the angles of BNR, BER and AD, are from memory of the catalogues.
"""

from __future__ import annotations

import re
from typing import NamedTuple

CERAMIC_BALLS = "silicon_nitride"

CERAMIC_PREFIX = r"[HX]C(?:B|S|RS|SS)?|HY|CB|CH|5S|3NC"
"""Not FAG's HCM and XCM, whose letters may say other angles than those of its series B."""

STEEL_PREFIX = r"B|S|HS|HSS|RS|W|SS"
"""Spindle bearings of FAG (B, HS, RS), sealed ones of SKF and FAG (S, HSS), stainless ones."""

_SMALL_BALLS = r"HSS?|[HX]C(?:S|RS|SS)?|RS"
"""Prefixes of FAG's high-speed series of angular contact bearings, whose balls are smaller."""

GMN_SERIES = r"SM|KH|S"
GMN_CAGES = r"TAM|TA|TBH|TB|TXMB|TXM|MA"

_GMN = re.compile(
    rf"(?P<hybrid>HY)?(?P<form>{GMN_SERIES})?"
    r"(?P<number>61[89]\d\d|6[02]\d\d|6[02]\d|619\d)(?P<seal>2RZ)?(?P<angle>C|E|18)"
    rf"(?P<rest>(?:{GMN_CAGES})?.*)"
)

CLASS_OF_LETTER = {
    "L": "light", "M": "medium", "H": "heavy", "S": "heavy", "F": "heavy",
    "GN": "light", "GM": "medium", "GH": "heavy", "A": "light", "B": "medium", "C": "heavy",
}  # fmt: skip
"""Class of preload by its letters; a maker's own classes go by the letter itself."""

OTHER_MAKERS = ("FAG", "SKF", "NTN", "KOYO", "IBC", "SNR", "RHP", "BARDEN", "NACHI")

_ANY = "for any arrangement"
_PAIRS = {
    "DB": "a pair back to back", "DF": "a pair face to face", "DT": "a pair in tandem",
    "DD": "a pair back to back", "FF": "a pair face to face",
    "DU": f"a pair {_ANY}", "DG": f"a pair {_ANY}", "TU": f"three bearings {_ANY}",
    "QU": f"four bearings {_ANY}", "SU": f"one bearing {_ANY}", "U": f"one bearing {_ANY}",
    "G": f"one bearing {_ANY}", "UA": f"one bearing {_ANY}, with axial clearance",
    "UO": f"one bearing {_ANY}, without preload", "CA": f"one bearing {_ANY}, with small clearance",
    "CB": f"one bearing {_ANY}, with axial clearance",
    "CC": f"one bearing {_ANY}, with large clearance",
    **dict.fromkeys(("DBD", "DFD", "DTD"), "three bearings, see tandem"),
    **dict.fromkeys(("DBB", "DFF", "DTT", "DBT", "DFT"), "four bearings, see tandem"),
}  # fmt: skip
OPPOSED = ("DB", "DF", "DD", "FF", "DU", "DG")
"""Letters of a pair whose bearings preload each other."""

_SETS = {"T": "three bearings, see tandem", "Q": "four bearings, see tandem"}
"""Sets by their first letter: TBT, TFT, TT, QBC, QFC, QBT, QFT, QT."""

_ORDER = r"DB|DF|DT|DG|DU|SU|TU|QU|DD|FF|TBT|TFT|TT|QBC|QFC|QBT|QFT|QT"

_NSK_SETS = r"DBD|DFD|DTD|DBB|DFF|DTT|DBT|DFT"

PAIR = (
    # SKF: after the tolerance, with its own classes; one bearing after the design, BE with a cage
    re.compile(rf"(?<=P4A|A9A|.P7|.P5|.P4)(?P<pair>{_ORDER}|G)(?P<load>[A-D])?(?=\s|$)"),
    re.compile(r"(?:\b[BDE]?|(?<=E))(?P<pair>G)(?P<load>[A-D])(?=[PMFJY]?(?:\s|$))"),
    re.compile(r"^E?(?P<pair>C[ABC])(?P<load>)(?=[PMFJY]?(?:\s|$))"),
    # NTN: G, or the order, then a class of two letters
    re.compile(rf"(?P<pair>{_ORDER}|G)\s*(?P<load>G[LNMH])(?=\s|$|P\d)"),
    # the others: a tolerance, or nothing, follows the class
    re.compile(
        rf"(?P<pair>{_NSK_SETS}|{_ORDER}|(?<![A-Z])U)\s*(?P<load>EL|[LMHSF])?(?=\s|$|P\d|A\d)"
    ),
    re.compile(r"(?P<pair>(?<![A-Z])U[AO])(?P<load>)(?=\s|$)"),
)
"""Letters of a pair of angular contact bearings, and of its class of preload; the first counts."""

PAIR_ALONE = (re.compile(r"\b(?P<pair>DB|DF|DT)(?P<load>)\b"),)
"""Those of deep groove bearings, whose DU and DDU are seals."""


WORDS = {
    "PAIR": "--pair spring or --pair rigid", "PAIRED": "--pair spring or --pair rigid",
    "DUPLEX": "--pair spring or --pair rigid", "SET": "--pair spring or --pair rigid",
    "SPRING": "--pair spring", "RIGID": "--pair rigid", "HYBRID": "--ball-material silicon_nitride",
    "CERAMIC": "--ball-material silicon_nitride", "SI3N4": "--ball-material silicon_nitride",
    "MOS2": "--lubrication mos2", "GREASE": "--lubrication grease", "OIL": "--lubrication oil",
    "DRY": "--lubrication dry", "RPM": "--speed", "DEG": "--contact-angle",
}  # fmt: skip
"""Options that say what words behind a designation mean, which are no maker's letters."""


class Letters(NamedTuple):
    """Meaning of the letters of a designation."""

    ball_material: str | None = None  # that of a scene; None where the letters say nothing
    ball_letters: str = ""  # those that say so
    small_balls: str = ""  # those of a high-speed series, which has smaller balls
    load: str = ""  # letter of the class of preload
    pair: str = ""  # letters of the arrangement
    ignored: str = ""  # what changes no number of a scene

    def explanations(self, is_in_pair: bool = False) -> list[str]:
        """Returns an explanation of each group of letters: `HC: silicon nitride balls`.

        is_in_pair: whether the scene holds both bearings of a pair.
        """
        clauses = []
        if self.ball_material:
            clauses.append(f"{self.ball_letters}: silicon nitride balls")
        if self.small_balls:
            clauses.append(
                f"{self.small_balls}: a high-speed bearing of FAG, with smaller balls than those "
                "assumed without --balls and --ball-diameter"
            )
        if self.pair:
            clauses.append(self._pair_explanation(is_in_pair))
        if self.load:
            clauses.append(f"{self.load}: class of preload")
        if self.ignored:
            clauses.append(
                f"ignored: {self.ignored} (cage, seals, tolerance: they change no number)"
            )
        return clauses

    def _pair_explanation(self, is_in_pair: bool) -> str:
        """Returns the meaning of the letters of an arrangement, and what of it the scene holds."""
        meaning = _PAIRS.get(self.pair) or _SETS[self.pair[0]]
        if is_in_pair or meaning.startswith("one"):
            return f"{self.pair}: {meaning}"
        arrangement = "`arrangement` as a comment"
        if self.pair in OPPOSED:
            arrangement = "both with --pair spring or --pair rigid"
        return f"{self.pair}: {meaning}; the scene holds one bearing of it, and {arrangement}"


_CERAMIC_SUFFIXES = (
    r"SN24",
    r"(?<![A-Z])HY(?![A-Z])",
    r"(?<![A-Z])NS(?![A-Z])",
    r"(?<![A-Z])HC\d?(?=\s|$|[A-Z])",
)
"""Patterns of the letters that say silicon nitride balls after the number."""


def letters_of(prefix: str, suffix: str, pairs: tuple[re.Pattern[str], ...]) -> Letters:
    """Returns what the letters before and after the number of a designation mean.

    suffix: without the letters of angle and clearance.
    pairs: patterns of pairs and classes of preload, `PAIR` or `PAIR_ALONE`.
    """
    balls, ignored = "", []
    small_balls = prefix if pairs is PAIR and re.fullmatch(_SMALL_BALLS, prefix) else ""
    if re.fullmatch(CERAMIC_PREFIX, prefix):
        balls = prefix
    elif prefix and not small_balls:
        ignored.append(prefix)
    for pattern in _CERAMIC_SUFFIXES:
        if match := re.search(pattern, suffix):
            balls = balls or match[0]
            suffix = suffix.replace(match[0], " ", 1)
    load = pair = ""
    for pair_pattern in pairs:
        if match := pair_pattern.search(suffix):
            pair, load = match["pair"], match["load"] or ""
            suffix = f"{suffix[: match.start()]} {suffix[match.end() :]}"
            break
    return Letters(
        ball_material=CERAMIC_BALLS if balls else None,
        ball_letters=balls,
        small_balls=small_balls,
        load=load,
        pair=pair,
        ignored=" ".join([*ignored, *suffix.split()]),
    )


class GmnParts(NamedTuple):
    """A designation of a GMN spindle bearing, whose numbers are those of deep groove bearings."""

    series: str  # S, SM or KH
    number: str  # 6005
    angle: str  # C, E or 18
    hybrid: str  # HY, or nothing
    suffix: str  # cage, accuracy, pair

    @property
    def name(self) -> str:
        """Returns series, number and angle without spaces."""
        return f"{self.series}{self.number}{self.angle}"

    @property
    def rest(self) -> list[str]:
        """Returns the letters before and after the name, without empty ones."""
        return [word for word in (self.hybrid, self.suffix) if word]


def gmn_parts(designation: str) -> GmnParts | None:
    """Splits a designation of GMN, with or without spaces: S 6005 C TA P4 DUL, 6008ETXM.

    None for a designation without the marks of GMN: the series S, SM or KH, or a cage after the
    angle.
    """
    match = _GMN.fullmatch(re.sub(r"[\s/_.-]", "", designation.upper()))
    if not match or not (match["form"] or re.match(GMN_CAGES, match["rest"])):
        return None
    return GmnParts(
        series=match["form"] or "S",
        number=match["number"],
        angle=match["angle"],
        hybrid=match["hybrid"] or "",
        # blanks around the accuracy, which the letters of a pair may follow directly
        suffix=re.sub(rf"^({GMN_CAGES})?(HG|UP|P4\+?|P2\+?|A[79])", r"\1 \2 ", match["rest"]),
    )


def maker_of(designation: str, makers: tuple[str, ...]) -> tuple[str, str]:
    """Returns the maker's name, in capitals, that a designation begins with, and the text after it.

    If it begins with none, the name is "", and the text is the whole designation.

    makers: names that count, besides `OTHER_MAKERS`.
    """
    names = "|".join((*makers, *OTHER_MAKERS))
    match = re.match(rf"\s*({names})[\s/_-]*(?=\S)", designation, re.IGNORECASE)
    return (match[1].upper(), designation[match.end() :]) if match else ("", designation)
