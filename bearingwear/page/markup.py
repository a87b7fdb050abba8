"""Markdown to HTML, for a page that trusts no input."""

from markdown_it import MarkdownIt
from markupsafe import Markup

WIDE = '<div class="wide" role="region" aria-label="table" tabindex="0">'
TABLE = '<table class="sortable">'


def to_html(text: str, depth: int) -> Markup:
    """Markdown as HTML; HTML in it is shown, not obeyed, and links and images are left as text.

    Parameters
    ----------
    text : str
        CommonMark with tables.
    depth : int
        Added to the level of each heading.
    """
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    markdown.disable(["link", "image", "autolink"])
    tokens = markdown.parse(text)
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(6, int(token.tag[1:]) + depth)}"
    html = markdown.renderer.render(tokens, markdown.options, {})
    html = html.replace("<table>", f"{WIDE}{TABLE}").replace("</table>", "</table></div>")
    return Markup(html)
