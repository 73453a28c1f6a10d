r"""Labels of names as MathML: the same labels that print in LaTeX.

A label is sound LaTeX of a small language (:mod:`symflex.print.label` reads it completely before use);
here its atoms and scripts become elements.
"""

from __future__ import annotations

import functools
import re
from typing import TYPE_CHECKING, Final

from symflex.model.labels import ACCENTS, FONTS, GREEK, SYMBOLS
from symflex.print.label import symbol
from symflex.print.mathml.element import identifier, numeral, operator, row, words

if TYPE_CHECKING:
    from collections.abc import Mapping

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
