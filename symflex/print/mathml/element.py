"""Elements of MathML, their content escaped.

The markup is that of MathML Core (W3C 2024): no attribute that browsers dropped, ``mathvariant`` only as
``normal``. Other alphabets are classes (``it``, ``bf``, ``sf``, ``tt``), which a page's style sheet sets.
"""

from __future__ import annotations

import html
from typing import Final

INVISIBLE_TIMES: Final = "<mo>&#x2062;</mo>"
SPACED_TIMES: Final = '<mo lspace="0.17em" rspace="0">&#x2062;</mo>'
APPLY_FUNCTION: Final = "<mo>&#x2061;</mo>"
EQUALS: Final = "<mo>=</mo>"


def identifier(text: str, style: str = "") -> str:
    """Return a name: one letter italic by itself, several upright, unless a class says otherwise.

    Examples
    --------
    >>> identifier("m"), identifier("eff"), identifier("R", "rm"), identifier("EI", "it")
    ('<mi>m</mi>', '<mi>eff</mi>', '<mi mathvariant="normal">R</mi>', '<mi class="it">EI</mi>')
    """
    if style == "rm":
        attribute = ' mathvariant="normal"' if len(text) == 1 else ""
    else:
        attribute = f' class="{style}"' if style else ""
    return f"<mi{attribute}>{html.escape(text)}</mi>"


def numeral(text: str) -> str:
    """Return a number."""
    return f"<mn>{html.escape(text)}</mn>"


def operator(text: str, form: str = "") -> str:
    """Return an operator; a minus sign is one, not a hyphen."""
    attribute = f' form="{form}"' if form else ""
    return f"<mo{attribute}>{html.escape(text.replace('-', chr(0x2212)))}</mo>"


def words(text: str, style: str = "") -> str:
    """Return text inside mathematics."""
    attribute = f' class="{style}"' if style else ""
    return f"<mtext{attribute}>{html.escape(text)}</mtext>"


def row(*parts: str) -> str:
    """Return parts as one; a single element stays as it is.

    Examples
    --------
    >>> row("<mi>a</mi>"), row("<mi>a</mi>", "<mi>b</mi>")
    ('<mi>a</mi>', '<mrow><mi>a</mi><mi>b</mi></mrow>')
    """
    return parts[0] if len(parts) == 1 else f"<mrow>{''.join(parts)}</mrow>"


def fence(content: str, nesting: int, is_tall: bool) -> str:
    """Return content in parentheses, or in brackets or braces around those."""
    opening, closing = fence_signs(nesting, is_tall=is_tall)
    return f"<mrow>{opening}{content}{closing}</mrow>"


def fence_signs(nesting: int, *, is_tall: bool = False) -> tuple[str, str]:
    """Return an opening and a closing sign; they grow only around what is tall."""
    left, right = ("()", "[]", "{}")[nesting % 3]
    stretchy = "" if is_tall else ' stretchy="false"'
    return f'<mo form="prefix"{stretchy}>{left}</mo>', f'<mo form="postfix"{stretchy}>{right}</mo>'


def math_element(content: str, *, is_display: bool = False) -> str:
    """Return mathematics as an element of a page.

    Examples
    --------
    >>> math_element("<mi>s</mi>")
    '<math><mi>s</mi></math>'
    """
    attribute = ' displaystyle="true"' if is_display else ""
    return f"<math{attribute}>{content}</math>"
