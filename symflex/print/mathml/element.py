"""Elements of MathML, their content escaped.

The markup is that of MathML Core (W3C 2024): no attribute that browsers dropped, ``mathvariant`` only as
``normal``. Other alphabets are classes (``it``, ``bf``, ``sf``, ``tt``), which a page's style sheet sets.

Labels of names are those that print in LaTeX, a small language of it that :mod:`symflex.print.label` reads
completely before use; here their atoms and scripts become elements.
"""

from __future__ import annotations

import functools
import html
import re
from typing import TYPE_CHECKING, Final

from symflex.model.labels import ACCENTS, FONTS, GREEK, SYMBOLS
from symflex.print.label import symbol

if TYPE_CHECKING:
    from collections.abc import Mapping


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


_TOKEN: Final = re.compile(r"\\([A-Za-z]+) *|\\([,;:! ])|([0-9]+(?:\.[0-9]+)?)|(.)", re.DOTALL)
_LETTERS: Final = {
    **dict(
        zip(
            (
                "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu "
                "xi pi varpi rho varrho sigma varsigma tau upsilon phi varphi chi psi omega"
            ).split(),
            "αβγδϵεζηθϑικλμνξπϖρϱσςτυϕφχψω",
            strict=True,
        )
    ),
    **dict(
        zip("Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split(), "ΓΔΘΛΞΠΣΥΦΨΩ", strict=True)
    ),
}
_SIGNS: Final = {
    "ell": "ℓ", "hbar": "ℏ", "prime": "′", "infty": "∞", "star": "⋆", "ast": "∗", "circ": "∘",
    "parallel": "∥", "perp": "⊥", "dagger": "†", "cdot": "⋅", "times": "×", "pm": "±", "mp": "∓",
    "ldots": "…",
}  # fmt: skip
_NAMES: Final = frozenset(("ell", "hbar", "infty"))
_ACCENT_SIGNS: Final = {
    "dot": "˙", "ddot": "¨", "bar": "¯", "hat": "^", "tilde": "~", "vec": "→", "check": "ˇ", "breve": "˘",
    "acute": "´", "grave": "`", "overline": "¯", "underline": "_",
}  # fmt: skip
_STYLES: Final = {
    "mathrm": "rm", "operatorname": "rm", "mathit": "it", "mathbf": "bf", "boldsymbol": "bf", "mathsf": "sf",
    "mathcal": "cal",
}  # fmt: skip
_UNDER: Final = frozenset(("underline",))


def label_mathml(name: str, labels: Mapping[str, str]) -> str:
    r"""Return the label of a name, declared or made.

    Examples
    --------
    >>> label_mathml("omega_p1", {})
    '<msub><mi>ω</mi><mrow><mi>p</mi><mn>1</mn></mrow></msub>'
    >>> label_mathml("m", {"m": r"m_{\mathrm{eff}}"})
    '<msub><mi>m</mi><mi>eff</mi></msub>'
    """
    latex = symbol(name, labels).latex
    if latex.startswith((r"\mathtt", r"\substack")):
        return words(name, "tt")
    return latex_label(latex)


@functools.lru_cache(maxsize=4096)
def latex_label(latex: str) -> str:
    r"""Return a sound label as MathML.

    Raises ValueError for what is not a label that :func:`symflex.print.label.read_label` lets through.

    Examples
    --------
    >>> latex_label(r"\hat{x}_1'")
    '<msubsup><mover accent="true"><mi>x</mi><mo>^</mo></mover><mn>1</mn><mo>′</mo></msubsup>'
    """
    content, end = _list(latex, 0, "")
    if end != len(latex):
        message = f"{latex!r} is not a label"
        raise ValueError(message)
    return content


def _list(latex: str, start: int, style: str) -> tuple[str, int]:
    """Read atoms up to a closing brace or the end; return their row and where it was."""
    atoms: list[str] = []
    letters = ""  # of a font, waiting for more
    position = start
    while position < len(latex) and latex[position] != "}":
        match = _token(latex, position)
        sign = match[4] or ""
        if style and sign.isalpha():
            letters += sign
            position = match.end()
            continue
        if letters:
            atoms.append(identifier(letters, style))
            letters = ""
        if sign in ("_", "^", "'") and sign:
            scripts, position = _scripts(latex, position, style)
            atoms[-1] = _scripted(atoms[-1], *scripts)
        else:
            atom, position = _atom(latex, position, style)
            if atom:
                atoms.append(atom)
    if letters:
        atoms.append(identifier(letters, style))
    return (row(*atoms) if atoms else words("")), position


def _scripts(latex: str, position: int, style: str) -> tuple[tuple[str, str], int]:
    """Read all scripts that one atom bears: what is below and above."""
    below, above, primes = "", "", 0
    while position < len(latex) and latex[position] in "_^' ":
        sign = latex[position]
        position += 1
        if sign == "'":
            primes += 1
        elif sign != " ":
            script, position = _argument(latex, position, style)
            below, above = (script, above) if sign == "_" else (below, script)
    return (below, operator("′" * primes) if primes else above), position


def _scripted(base: str, below: str, above: str) -> str:
    if below and above:
        return f"<msubsup>{base}{below}{above}</msubsup>"
    return f"<msub>{base}{below}</msub>" if below else f"<msup>{base}{above}</msup>"


def _argument(latex: str, position: int, style: str) -> tuple[str, int]:
    while latex[position : position + 1] == " ":
        position += 1
    return _atom(latex, position, style)


def _atom(latex: str, position: int, style: str) -> tuple[str, int]:
    """Read one atom or group."""
    match = _token(latex, position)
    command, space, number, sign = match.groups()
    position = match.end()
    if command:
        return _command(latex, command, position, style)
    if space:
        return '<mspace width="0.2em"></mspace>', position
    if number:
        return numeral(number), position
    if sign == "{":
        content, end = _list(latex, position, style)
        return content, end + 1
    if sign == " ":
        return "", position
    return (identifier(sign, style) if sign.isalpha() else operator(sign)), position


def _command(latex: str, command: str, position: int, style: str) -> tuple[str, int]:
    if command in _LETTERS:
        letter = _LETTERS[command]
        return identifier(letter, "rm" if letter.isupper() else ""), position
    if command in _SIGNS:
        sign = _SIGNS[command]
        return (identifier(sign) if command in _NAMES else operator(sign)), position
    if command in _ACCENT_SIGNS:
        base, position = _argument(latex, position, style)
        accent = operator(_ACCENT_SIGNS[command])
        if command in _UNDER:
            return f'<munder accentunder="true">{base}{accent}</munder>', position
        return f'<mover accent="true">{base}{accent}</mover>', position
    if command in _STYLES:
        content, end = _list(latex, position + 1, _STYLES[command])
        return content, end + 1
    end = latex.index("}", position)
    return words(latex[position + 1 : end], "it" if command == "textit" else ""), end + 1


def _token(latex: str, position: int) -> re.Match[str]:
    match = _TOKEN.match(latex, position)
    if match is None:
        message = f"{latex!r} is not a label"
        raise ValueError(message)
    return match


# Whatever a declared label may hold has an entry here.
if missing := {*GREEK, *ACCENTS, *SYMBOLS} - {*_LETTERS, *_SIGNS, *_ACCENT_SIGNS}:
    raise TypeError(f"no MathML for {sorted(missing)}")
if missing := {*FONTS} - {*_STYLES, "text", "textrm", "textit"}:
    raise TypeError(f"no MathML for {sorted(missing)}")
