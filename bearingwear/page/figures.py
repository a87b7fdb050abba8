"""Figures of studies as a page holds them: small, with words, and with the files behind them."""

from __future__ import annotations

import base64
import colorsys
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from markupsafe import Markup

from bearingwear.plotting.drawing import DATA_SEPARATOR, MESSAGE
from bearingwear.results.netcdf import CaseFileError

SUFFIXES = (".svg", ".png")
HEAVY = 150_000  # bytes of a small SVG beyond which its PNG is taken, if there is one and lighter
SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
TITLE = f"{{{SVG}}}title"
HREF = f"{{{XLINK}}}href"
DESCRIPTION, _SOURCE = (
    f"{{http://purl.org/dc/elements/1.1/}}{name}" for name in ("description", "source")
)
AS_CSV = {"study.nc": "cases", "wear_life.nc": "cases", "dynamic.nc": "dynamic", "design.nc": "map"}
"""Tables (tables/NAME.csv) beside results, with the same numbers."""
# What may stand in a data URI between quotation marks as it is; `#` would end it.
UNQUOTED = " !$'()*+,-./:;<=>?@[]_|~"
LINE = r'translate\([-\d.]+ ([\d.]+)\)|y="([\d.]+)"'
PAPER, INK = (20, 23, 27), "#e4e7eb"
"""Of a dark page, as in page.css."""
DECIMALS = 1  # of a coordinate [pt]
WITH_COORDINATES = ("d", "points", "x", "y", "transform")


@dataclass(frozen=True)
class Drawing:
    """A figure as the page holds it."""

    path: Path
    message: str  # what it states, and what it shows
    description: str
    width: int  # [px]
    height: int
    uri: Markup  # the picture itself
    data: Sequence[Path] = ()  # what it was drawn from


def drawings(files: Sequence[Path]) -> Iterator[Drawing]:
    """Every SVG among the files; a heavy one as the PNG of the same name, if that is given.

    May raise CaseFileError.
    """
    for file in files:
        if file.suffix == ".svg":
            other = file.with_suffix(".png")
            yield _drawing(file, other if other in files else None)


def _data_behind(root: ET.Element) -> list[Path]:
    """The files that a figure says it was drawn from, and tables of the same numbers."""
    text = next((node.text or "" for node in root.iter(_SOURCE)), "").strip()
    files = [Path(path) for path in text.split(DATA_SEPARATOR) if path]
    known = [(file, AS_CSV[file.name]) for file in files if file.name in AS_CSV]
    tables = [file.parent / "tables" / f"{name}.csv" for file, name in known]
    return [*files, *(table for table in dict.fromkeys(tables) if table.is_file())]


def _drawing(file: Path, png: Path | None) -> Drawing:
    try:
        root = ET.fromstring(file.read_text(encoding="utf-8"))
        _, _, width, height = (float(number) for number in root.attrib["viewBox"].split())
        picture = png.read_bytes() if png else b""
    except (OSError, UnicodeError, ET.ParseError, KeyError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise CaseFileError(f"{file}: cannot be read ({reason}), expected an SVG figure") from None
    message = (root.findtext(TITLE) or file.stem.replace("_", " ")).strip()
    description = next((node.text or "" for node in root.iter(DESCRIPTION)), "").strip()
    data = _data_behind(root)
    # the page has the message beside the figure
    top = 0.0
    for parent in list(root.iter()):
        for child in [child for child in parent if child.get("id") == MESSAGE]:
            lines = re.findall(LINE, ET.tostring(child, encoding="unicode"))
            top = max((float(moved or there) for moved, there in lines), default=0.0)
            parent.remove(child)
    root.set("viewBox", f"0 {top:g} {width:g} {height - top:g}")
    height -= top
    for size in ("width", "height"):
        root.attrib.pop(size, None)
    uri = Markup(f"data:image/svg+xml,{quote(_small(root), safe=UNQUOTED)}")
    if picture and len(uri) > HEAVY:
        coded = base64.b64encode(picture).decode()
        uri = min(uri, Markup(f"data:image/png;base64,{coded}"), key=len)
    return Drawing(
        file,
        message,
        description,
        round(width * 4.0 / 3.0),  # from points to pixels
        round(height * 4.0 / 3.0),
        uri,
        data,
    )


def _small(root: ET.Element) -> str:
    """An SVG without what nobody sees: comments, digits, groups of nothing, names nobody uses."""
    ET.register_namespace("", SVG)
    ET.register_namespace("xlink", XLINK)
    used = dict.fromkeys(re.findall(r"#([\w-]+)", ET.tostring(root, encoding="unicode")))
    short = {name: f"i{k}" for k, name in enumerate(used)}  # colours are among them
    styles: dict[str, str] = {}
    _plain_text(root)
    for node in root.iter():
        if name := node.attrib.pop("id", None):
            node.attrib |= {"id": short[name]} if name in short else {}
        if node.get("transform", "").startswith("rotate(-0 "):
            del node.attrib["transform"]
        for name in ("clip-path", HREF):
            if name in node.attrib:
                node.set(name, re.sub(r"#([\w-]+)", lambda m: f"#{short[m[1]]}", node.attrib[name]))
        for name in WITH_COORDINATES:
            if name in node.attrib and "scale" not in node.attrib[name]:
                node.set(name, re.sub(r"\d+\.\d{2,}", _rounded, node.attrib[name]).strip())
        if style := node.attrib.pop("style", None):
            style = style.replace("; ", ";").replace(": ", ":").replace("'", "")
            node.set("class", styles.setdefault(style, f"s{len(styles)}"))
    for name in ("metadata", "g"):
        _unwrapped(root, f"{{{SVG}}}{name}")
    sheet = ET.Element(f"{{{SVG}}}style")
    sheet.text = "".join(f".{name}{{{style}}}" for style, name in styles.items())
    sheet.text += f"@media (prefers-color-scheme:dark){{text{{fill:{INK}}}{_by_night(styles)}}}"
    root.insert(0, sheet)
    text = " ".join(ET.tostring(root, encoding="unicode").split())
    text = text.replace("> <", "><").replace(" />", "/>")
    # a quotation mark takes three characters of a URI, an apostrophe one
    return text if "'" in text else text.replace('"', "'")


def _plain_text(root: ET.Element) -> None:
    """Black, the colour of a text without one, is left out, so that a dark page may change it."""
    for node in root.iter(f"{{{SVG}}}text"):
        node.set("style", node.get("style", "").replace("fill: #000000", "").strip("; "))


def _by_night(styles: Mapping[str, str]) -> str:
    """The styles that a dark page changes: greys the other way round, colours lighter."""
    changed = {
        name: [
            f"{key}:{_lighter(colour)}"
            for key, colour in re.findall(r"(fill|stroke):\s?(#[0-9a-f]{6})", style)
        ]
        for style, name in styles.items()
    }
    return "".join(f".{name}{{{';'.join(each)}}}" for name, each in changed.items() if each)


def _lighter(colour: str) -> str:
    """A colour of a figure on the paper of a dark page."""
    red, green, blue = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    hue, light, strong = colorsys.rgb_to_hls(red, green, blue)
    if max(red, green, blue) - min(red, green, blue) < 0.05:
        share = 1.0 - light
        ends = zip(PAPER, (228, 231, 235), strict=True)
        return "#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in ends)
    rgb = colorsys.hls_to_rgb(hue, max(light, 0.62), strong)
    return "#" + "".join(f"{round(255 * part):02x}" for part in rgb)


def _unwrapped(node: ET.Element, tag: str) -> None:
    """Replace elements of a tag without attributes by their contents; drop metadata."""
    for child in list(node):
        _unwrapped(child, tag)
    kept: list[ET.Element] = []
    for child in node:
        if child.tag == tag and (not child.attrib or tag.endswith("}metadata")):
            kept += [] if tag.endswith("}metadata") else list(child)
        else:
            kept.append(child)
    node[:] = kept


def _rounded(number: re.Match[str]) -> str:
    return f"{round(float(number[0]), DECIMALS):g}"
