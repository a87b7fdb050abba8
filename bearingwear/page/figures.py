"""Figures of studies for a page: reduced SVG, with their words and the files behind them."""

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
HEAVY = 150_000  # bytes of a reduced SVG beyond which a smaller PNG replaces it
SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
TITLE = f"{{{SVG}}}title"
HREF = f"{{{XLINK}}}href"
DESCRIPTION, _SOURCE = (
    f"{{http://purl.org/dc/elements/1.1/}}{name}" for name in ("description", "source")
)
AS_CSV = {"study.nc": "cases", "wear_life.nc": "cases", "dynamic.nc": "dynamic", "design.nc": "map"}
"""Names of the tables (tables/NAME.csv) beside results that contain the same numbers."""
# Characters that a data URI between quotation marks may contain as they are; `#` would end it.
UNQUOTED = " !$'()*+,-./:;<=>?@[]_|~"
LINE = r'translate\([-\d.]+ ([\d.]+)\)|y="([\d.]+)"'
"""Ordinate of a line of text, which Matplotlib writes as a translation or as an attribute."""
PIXELS_PER_POINT = 4.0 / 3.0  # by CSS
PAPER, INK_PARTS = (20, 23, 27), (228, 231, 235)
"""Red, green and blue of a dark page and its text, as in page.css."""
INK = "#" + "".join(f"{part:02x}" for part in INK_PARTS)
DECIMALS = 1  # of a coordinate [pt]
WITH_COORDINATES = ("d", "points", "x", "y", "transform")


@dataclass(frozen=True)
class Drawing:
    """A figure as the page contains it."""

    path: Path
    message: str  # its title, a sentence
    description: str  # of its panels and legend
    width: int  # [px]
    height: int
    uri: Markup  # the picture itself
    data: Sequence[Path] = ()  # the files that it was drawn from, and tables of their numbers


def drawings(files: Sequence[Path]) -> Iterator[Drawing]:
    """Yields a drawing for every SVG among the files. May raise CaseFileError.

    The PNG of the same name replaces a heavy SVG, if it is among the files and smaller.
    """
    for file in files:
        if file.suffix == ".svg":
            png = file.with_suffix(".png")
            yield _drawing(file, png if png in files else None)


def _data_behind(root: ET.Element) -> list[Path]:
    """Returns the files that an SVG figure names as its source, and tables of their numbers."""
    text = (root.findtext(f".//{_SOURCE}") or "").strip()
    files = [Path(path) for path in text.split(DATA_SEPARATOR) if path]
    tables = [
        file.parent / "tables" / f"{AS_CSV[file.name]}.csv" for file in files if file.name in AS_CSV
    ]
    return [*files, *(table for table in dict.fromkeys(tables) if table.is_file())]


def _drawing(file: Path, png: Path | None) -> Drawing:
    """Returns the drawing of an SVG figure, reduced, or of its PNG if the SVG is heavy.

    CaseFileError: a file cannot be read, or is no figure.
    """
    try:
        root = ET.fromstring(file.read_text(encoding="utf-8"))
        _, _, width, height = (float(number) for number in root.attrib["viewBox"].split())
        picture = png.read_bytes() if png else b""
    except (OSError, UnicodeError, ET.ParseError, KeyError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise CaseFileError(f"{file}: cannot be read ({reason}), expected an SVG figure") from None
    message = (root.findtext(TITLE) or file.stem.replace("_", " ")).strip()
    description = (root.findtext(f".//{DESCRIPTION}") or "").strip()
    data = _data_behind(root)
    # the page shows the message beside the figure
    message_height = _remove_message(root)
    height -= message_height
    root.set("viewBox", f"0 {message_height:g} {width:g} {height:g}")
    for name in ("width", "height"):
        root.attrib.pop(name, None)
    uri = Markup(f"data:image/svg+xml,{quote(_reduced_svg(root), safe=UNQUOTED)}")
    if picture and len(uri) > HEAVY:
        encoded = base64.b64encode(picture).decode()
        uri = min(uri, Markup(f"data:image/png;base64,{encoded}"), key=len)
    return Drawing(
        path=file,
        message=message,
        description=description,
        width=round(width * PIXELS_PER_POINT),
        height=round(height * PIXELS_PER_POINT),
        uri=uri,
        data=data,
    )


def _remove_message(root: ET.Element) -> float:
    """Removes the message from a figure, and returns its height [pt]."""
    height = 0.0
    for parent in list(root.iter()):
        for child in [child for child in parent if child.get("id") == MESSAGE]:
            lines = re.findall(LINE, ET.tostring(child, encoding="unicode"))
            height = max((float(offset or y) for offset, y in lines), default=0.0)
            parent.remove(child)
    return height


def _reduced_svg(root: ET.Element) -> str:
    """Returns the text of an SVG, with styles for a dark page and without invisible content.

    It lacks metadata, unused names, groups without attributes, and most decimals of coordinates.
    """
    ET.register_namespace("", SVG)
    ET.register_namespace("xlink", XLINK)
    # colours also start with #, and are harmless among the references
    references = dict.fromkeys(re.findall(r"#([\w-]+)", ET.tostring(root, encoding="unicode")))
    short_ids = {name: f"i{k}" for k, name in enumerate(references)}
    _remove_black_of_texts(root)
    for node in root.iter():
        _shorten_references(node, short_ids)
        if node.get("transform", "").startswith("rotate(-0 "):  # as of all horizontal texts
            del node.attrib["transform"]
        for name in WITH_COORDINATES:
            if name in node.attrib and "scale" not in node.attrib[name]:
                node.set(name, re.sub(r"\d+\.\d{2,}", _rounded, node.attrib[name]).strip())
    classes = _replace_styles_by_classes(root)
    _remove_metadata(root)
    _unwrap_groups(root)
    sheet = ET.Element(f"{{{SVG}}}style")
    sheet.text = "".join(f".{name}{{{style}}}" for style, name in classes.items())
    sheet.text += f"@media (prefers-color-scheme:dark){{text{{fill:{INK}}}{_dark_styles(classes)}}}"
    root.insert(0, sheet)
    text = " ".join(ET.tostring(root, encoding="unicode").split())
    text = text.replace("> <", "><").replace(" />", "/>")
    # a quotation mark takes three characters of a URI, an apostrophe one
    return text if "'" in text else text.replace('"', "'")


def _shorten_references(node: ET.Element, short_ids: Mapping[str, str]) -> None:
    """Shortens the `id` of a node and its references to others; removes an `id` without use.

    short_ids: by each `id` to which some node refers.
    """
    identifier = node.attrib.pop("id", None)
    if identifier is not None and identifier in short_ids:
        node.set("id", short_ids[identifier])
    for name in ("clip-path", HREF):
        if name in node.attrib:
            value = re.sub(r"#([\w-]+)", lambda match: f"#{short_ids[match[1]]}", node.attrib[name])
            node.set(name, value)


def _replace_styles_by_classes(root: ET.Element) -> dict[str, str]:
    """Replaces the styles of all nodes by classes; returns the class of each style."""
    classes: dict[str, str] = {}
    for node in root.iter():
        if style := node.attrib.pop("style", None):
            style = style.replace("; ", ";").replace(": ", ":").replace("'", "")
            node.set("class", classes.setdefault(style, f"s{len(classes)}"))
    return classes


def _remove_black_of_texts(root: ET.Element) -> None:
    """Removes black from texts, whose default colour it is, so that a dark page may change it."""
    for node in root.iter(f"{{{SVG}}}text"):
        node.set("style", node.get("style", "").replace("fill: #000000", "").strip("; "))


def _dark_styles(classes: Mapping[str, str]) -> str:
    """Returns the style rules of a dark page, which inverts greys and lightens other colours.

    classes: the class of each style.
    """
    rules = []
    for style, name in classes.items():
        colours = re.findall(r"(fill|stroke):\s?(#[0-9a-f]{6})", style)
        if colours:
            changes = ";".join(f"{key}:{_dark_page_colour(colour)}" for key, colour in colours)
            rules.append(f".{name}{{{changes}}}")
    return "".join(rules)


def _dark_page_colour(colour: str) -> str:
    """Returns the colour on a dark page for a colour of a figure, both as `#rrggbb`.

    Greys are inverted between `PAPER` and `INK`. Other colours keep their hue and saturation, and
    are at least so light that they can be seen on `PAPER`.
    """
    red, green, blue = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    hue, lightness, saturation = colorsys.rgb_to_hls(red, green, blue)
    if max(red, green, blue) - min(red, green, blue) < 0.05:  # grey
        darkness = 1.0 - lightness
        ends = zip(PAPER, INK_PARTS, strict=True)
        return "#" + "".join(
            f"{round(dark + (light - dark) * darkness):02x}" for dark, light in ends
        )
    rgb = colorsys.hls_to_rgb(hue, max(lightness, 0.62), saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in rgb)


def _remove_metadata(node: ET.Element) -> None:
    """Removes all `metadata` elements below a node."""
    for child in list(node):
        if child.tag == f"{{{SVG}}}metadata":
            node.remove(child)
        else:
            _remove_metadata(child)


def _unwrap_groups(node: ET.Element) -> None:
    """Replaces groups without attributes below a node by their contents."""
    children: list[ET.Element] = []
    for child in node:
        _unwrap_groups(child)
        is_plain_group = child.tag == f"{{{SVG}}}g" and not child.attrib
        children += list(child) if is_plain_group else [child]
    node[:] = children


def _rounded(number: re.Match[str]) -> str:
    """Returns a number as text with at most `DECIMALS` decimals.

    number: match of its text in a coordinate.
    """
    return f"{round(float(number[0]), DECIMALS):g}"
