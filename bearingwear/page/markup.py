"""Markdown to HTML, for a page that needs no other file and trusts no input."""

import base64
from pathlib import Path
from urllib.parse import urlsplit

from markdown_it import MarkdownIt
from markdown_it.token import Token
from markupsafe import Markup

IMAGE_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}
NETWORK = ("http", "https")


def to_html(text: str, depth: int, folder: Path | None = None) -> Markup:
    """Markdown as HTML; HTML in it is shown, not obeyed.

    Parameters
    ----------
    text : str
        CommonMark with tables.
    depth : int
        Added to the level of each heading.
    folder : Path, optional
        Where its images are, which then become part of the page. Without it the text is by
        somebody else, and links and images are left as text.

    Notes
    -----
    Links to places on the network stay; those to files lose their target, since the page may be
    read where there are none.
    """
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    if folder is None:
        markdown.disable(["link", "image", "autolink"])
    tokens = markdown.parse(text)
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(6, int(token.tag[1:]) + depth)}"
        token.children = _inner(token.children, folder) if token.children else token.children
    html = markdown.renderer.render(tokens, markdown.options, {})
    html = html.replace("<table>", f"{WIDE}<table>").replace("</table>", "</table></div>")
    return Markup(html)


WIDE = '<div class="wide" role="region" aria-label="table" tabindex="0">'


def _inner(tokens: list[Token], folder: Path | None) -> list[Token]:
    """Inline tokens without links to files, and with their images in them."""
    kept, dropped = [], []
    for token in tokens:
        if token.type == "link_open":
            dropped.append(urlsplit(str(token.attrGet("href"))).scheme not in NETWORK)
        if token.type.startswith("link_") and dropped[-1]:
            if token.type == "link_close":
                dropped.pop()
            continue
        if token.type == "link_close":
            dropped.pop()
        if token.type == "image":
            image = (folder or Path()) / str(token.attrGet("src"))
            if image.suffix not in IMAGE_TYPES or not image.is_file():
                kept.append(Token("text", "", 0, content=token.content))
                continue
            coded = base64.b64encode(image.read_bytes()).decode()
            token.attrSet("src", f"data:{IMAGE_TYPES[image.suffix]};base64,{coded}")
        kept.append(token)
    return kept
