r"""Plain text made safe for LaTeX: nothing in a title or description can reach a command.

The result is ASCII, so that it means the same in every engine and input encoding: accented letters are
commands. It is meant for text mode with T1 encoded fonts, or those of Unicode, which have every letter of
Latin-1 and Latin Extended-A that is let through.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Final

from symflex.print.width import DIGIT, ROMAN, WIDEST

# Letters and signs between the control characters are escaped one by one; an empty group after a command
# keeps the space that follows, and one after - ' < > , ! ? ` keeps pairs of them from becoming ligatures.
_ASCII: Final = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%",
    "_": r"\_", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", '"': r"\textquotedbl{}",
    "`": r"\textasciigrave{}", "-": "-{}", "'": "'{}", "<": "<{}", ">": ">{}", ",": ",{}", "!": "!{}",
    "?": "?{}",
}  # fmt: skip

_GREEK_SMALL: Final = dict(
    zip(
        "αβγδεζηθικλμνξπρςστυφχψω",
        (
            "alpha beta gamma delta varepsilon zeta eta theta iota kappa lambda mu nu xi pi rho varsigma "
            "sigma tau upsilon varphi chi psi omega"
        ).split(),
        strict=True,
    )
)
_GREEK_CAPITAL: Final = dict(
    zip("ΓΔΘΛΞΠΣΥΦΨΩ", "Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split(), strict=True)
)
# Capitals that look like Latin ones, and the omicron.
_GREEK_AS_LATIN: Final = dict(zip("ΑΒΕΖΗΙΚΜΝΟΡΤΧο", "ABEZHIKMNOPTXo", strict=True))
_SYMBOLS: Final = {
    "≤": "leq", "≥": "geq", "≠": "neq", "≈": "approx", "≡": "equiv", "∞": "infty", "√": "surd",
    "∂": "partial", "∇": "nabla", "∑": "sum", "∏": "prod", "∫": "int", "∈": "in", "→": "to",
    "←": "leftarrow", "↔": "leftrightarrow", "⇒": "Rightarrow", "−": "-",
    "⋅": "cdot", "·": "cdot", "×": "times", "÷": "div", "±": "pm", "∓": "mp",
    "∼": "sim", "∝": "propto", "∥": "parallel", "⊥": "perp", "°": "^\\circ", "′": "'", "″": "''", "¬": "neg",
    "µ": "mu", "ϑ": "vartheta", "ϕ": "phi", "ϵ": "epsilon", "ϱ": "varrho", "ϖ": "varpi",
    "Ω": "Omega", "ℓ": "ell",
    "²": "^{2}", "³": "^{3}", "¹": "^{1}",
}  # fmt: skip
_MATHEMATICS: Final = _GREEK_SMALL | _GREEK_CAPITAL | _SYMBOLS
_PUNCTUATION: Final = {
    "\u00ad": r"\-", "\u00a0": "~", "\u202f": "~", "‐": "-{}", "‑": "-{}", "‒": "--", "–": "--", "—": "---",
    "―": "---", "‘": "`{}", "’": "'{}", "‚": r"\quotesinglbase{}", "“": "``",
    "”": "''", "„": r"\quotedblbase{}",
    "…": r"\ldots{}", "•": r"\textbullet{}", "†": r"\dag{}", "‡": r"\ddag{}", "€": r"\texteuro{}",
    "™": r"\texttrademark{}",
}  # fmt: skip
# Accents by their combining characters; T1 has all letters of Latin-1 and Latin Extended-A made of them.
_ACCENTS: Final = dict(
    zip(
        map(chr, (0x300, 0x301, 0x302, 0x303, 0x304, 0x306, 0x307, 0x308, 0x30A, 0x30B, 0x30C, 0x327, 0x328)),
        ("`", "'", "^", "~", "=", "u", ".", '"', "r", "H", "v", "c", "k"),
        strict=True,
    )
)
_DOTLESS: Final = {"i": r"\i", "j": r"\j"}
_LETTERS: Final = {
    "ß": "ss", "æ": "ae", "Æ": "AE", "œ": "oe", "Œ": "OE", "ø": "o", "Ø": "O", "ł": "l", "Ł": "L",
    "đ": "dj", "Đ": "DJ", "ð": "dh", "Ð": "DH", "þ": "th", "Þ": "TH", "ŋ": "ng", "Ŋ": "NG", "ı": "i",
    "ĳ": "ij", "Ĳ": "IJ",
    "¡": "textexclamdown", "¿": "textquestiondown", "«": "guillemotleft", "»": "guillemotright",
    "£": "textsterling", "§": "textsection", "¶": "textparagraph", "©": "textcopyright",
    "®": "textregistered", "ª": "textordfeminine", "º": "textordmasculine", "¢": "textcent",
    "¤": "textcurrency", "¥": "textyen", "¦": "textbrokenbar", "¨": "textasciidieresis",
    "¯": "textasciimacron", "´": "textasciiacute", "¸": "c", "¼": "textonequarter", "½": "textonehalf",
    "¾": "textthreequarters",
}  # fmt: skip

_WORD: Final = re.compile(r"[^\s\u00a0\u202f]+")
_LAST_LATIN: Final = 0x17F
_LONG_WORD_EM: Final = 12.0
_CHUNK_EM: Final = 4.0


def escape_text(text: str) -> str:
    """Return plain text as LaTeX text that prints it, whatever it holds.

    White space becomes single spaces; control and formatting characters vanish; letters of other scripts are
    written as their Latin base letter where they have one and as ``[U+4E2D]`` otherwise; a word too long for
    a narrow column may be broken anywhere.
    """
    return " ".join(_WORD.sub(lambda match: _word(match[0]), text).split())


def text_width(text: str) -> float:
    """Return the width of plain text in one line [em], rounded up."""
    return sum(map(_width, text))


def _width(c: str) -> float:
    return ROMAN.get(c) or max(WIDEST, DIGIT * len(_replacement(c)) * 1.2 if ord(c) > _LAST_LATIN else 0.0)


def _word(word: str) -> str:
    # A quote that opens a word opens a quotation.
    if word.startswith("'"):
        return "`{}" + _word(word[1:])
    if text_width(word) <= _LONG_WORD_EM:
        return "".join(map(_character, word))
    pieces: list[str] = []
    room = _CHUNK_EM
    for c in word:
        width = _width(c)
        if width > room:
            pieces.append(r"\allowbreak{}")
            room = _CHUNK_EM
        pieces.append(_character(c))
        room -= width
    return "".join(pieces)


def _character(c: str) -> str:
    if c in _ASCII:
        return _ASCII[c]
    if " " <= c <= "~":
        return c
    if c in _PUNCTUATION:
        return _PUNCTUATION[c]
    if c in _MATHEMATICS:
        command = _MATHEMATICS[c]
        return rf"\ensuremath{{{'' if not command.isalpha() else chr(92)}{command}}}"
    if c in _GREEK_AS_LATIN:
        return _GREEK_AS_LATIN[c]
    if c in _LETTERS:
        return rf"\{_LETTERS[c]}{{}}"
    accented = unicodedata.normalize("NFD", c)
    if c <= chr(_LAST_LATIN) and accented[1:] in _ACCENTS:
        return rf"\{_ACCENTS[accented[1]]}{{{_DOTLESS.get(accented[0], accented[0])}}}"
    return _replacement(c)


def _replacement(c: str) -> str:
    """Return a stand-in for a character that the fonts lack."""
    category = unicodedata.category(c)
    if category in ("Cc", "Cf", "Mn", "Me"):
        return ""
    plain = "".join(d for d in unicodedata.normalize("NFKD", c) if not unicodedata.combining(d))
    if (
        plain != c
        and plain
        and all(" " <= d <= "~" or d in _MATHEMATICS or d in _GREEK_AS_LATIN for d in plain)
    ):
        return "".join(map(_character, plain))
    return f"[U+{ord(c):04X}]"


def prose(text: str) -> str:
    """Return text with the space at its ends, which what runs beside it needs."""
    before = " " if text[:1].isspace() else ""
    after = " " if text[-1:].isspace() and text.strip() else ""
    return f"{before}{escape_text(text)}{after}"
