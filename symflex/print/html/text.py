"""Plain text made safe for HTML pages in which mathematics is looked for."""

from __future__ import annotations

import html
from typing import Final

# MathJax and KaTeX look for mathematics within one text node: alone in a node, these begin none.
_ALONE: Final = {"$": "<span>$</span>", "\\": "<span>\\</span>"}


def escape_html(text: str) -> str:
    r"""Return plain text as HTML that shows it as an element's content, whatever it holds.

    White space becomes single spaces and what does not print vanishes, also what would turn the direction of
    writing. Dollar signs and backslashes stand in elements of their own, so that no typesetter of a page
    finds mathematics.

    Examples
    --------
    >>> print(escape_html("<b>5 & 6</b>"), escape_html(r"\(x\)"))
    &lt;b&gt;5 &amp; 6&lt;/b&gt; <span>\</span>(x<span>\</span>)
    """
    plain = "".join(c for c in " ".join(text.split()) if c.isprintable())
    return "".join(_ALONE.get(c, html.escape(c)) for c in plain)
