"""Characters that no text of the language holds, and what to write instead; names in ASCII.

"0,05"   ->   write a decimal point: 0.05
"\u03b6"     ->   zeta
"""

from __future__ import annotations

import re
import unicodedata
from typing import Final

ASCII_FOR: Final = {
    "·": "*", "⋅": "*", "∙": "*", "•": "*", "×": "*", "∗": "*",
    "−": "-", "–": "-", "—": "-", "‐": "-", "‑": "-", "÷": "/", "∕": "/", "⁄": "/",
    "′": "'", "’": "'", "‘": "'", "″": "''", "”": "''", "“": "''", "‴": "'''", "⁗": "''''",
    "[": "(", "{": "(", "]": ")", "}": ")", "（": "(", "）": ")", "＝": "=", "＋": "+",
    '"': "''", "`": "'", "√": "sqrt(...)", "\u00a0": " ", "\u202f": " ", "\u2009": " ",
}  # fmt: skip

_UMLAUTS: Final = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss"})
_GROUP: Final = 3


def code_point(character: str) -> str:
    """Return the number and name of a character that may look like another, to follow it in a message.

    >>> code_point("\u2212"), code_point(",")
    (' (U+2212 MINUS SIGN)', '')
    """
    if character.isascii():
        return ""
    return f" (U+{ord(character):04X} {unicodedata.name(character, 'without a name')})"


IMAGINARY_NAMES = ("i", "j", "im", "I")  # what other programs call the imaginary unit
IMAGINARY_UNIT = "the imaginary unit is j, as in 'k*(1 + j*eta)'; elements take a loss factor as eta_s"


def character_hint(value: str, position: int) -> str | None:
    """Return what to write in place of the character of ``value`` at ``position``.

    >>> character_hint("0,05 m", 1), character_hint("10⁻³", 2), character_hint("5 − 3", 2)
    ("write a decimal point: '0.05'", "write '^-3'", "write '-'")
    """
    character = value[position]
    if character == ",":
        return _comma_hint(value, position)
    if character == "\\":
        word = re.compile(r"[A-Za-z]{1,64}").match(value, position + 1)
        return f"write '{word[0]}' without the backslash" if word else None
    replacement = ASCII_FOR.get(character)
    if replacement is not None:
        quote = '"' if "'" in replacement else "'"
        return "write an ordinary space" if replacement == " " else f"write {quote}{replacement}{quote}"
    power = re.compile(r"[⁺⁻]?[⁰¹²³⁴-⁹]+|⁻").match(value, position)
    if power:
        return f"write '^{unicodedata.normalize('NFKC', power[0]).replace('−', '-')}'"
    digit = unicodedata.digit(character, None)
    if digit is not None:
        subscript = unicodedata.name(character, "").startswith("SUBSCRIPT")
        return f"write '{'_' if subscript else ''}{digit}'"
    name = ascii_name(character)
    if name:
        return f"write '{name}'"
    return "a name has letters A-Z and a-z, digits and '_'" if character.isalpha() else None


def _comma_hint(value: str, position: int) -> str:
    if re.search(r"\bcomplex *\([^(),]*$", value[:position]):
        return f"write 'a + j*b': {IMAGINARY_UNIT}"
    number = re.compile(r"[0-9]+(?:[.,][0-9]+)*").search(value, len(value[:position].rstrip("0123456789.,")))
    if number is None or not number.start() < position < number.end():
        return "a decimal point is written '.', and a function takes one argument"
    digits = number[0]
    if digits.count(",") == 1 and "." not in digits:
        is_group = len(digits) - digits.index(",") - 1 == _GROUP and not digits.startswith("0")
        also = f", or '{digits.replace(',', '')}' for thousands" if is_group else ""
        return f"write a decimal point: '{digits.replace(',', '.')}'{also}"
    last = max(digits.rfind("."), digits.rfind(","))
    whole = re.sub("[.,]", "", digits[:last])
    return f"digits are not grouped: write '{whole}.{digits[last + 1 :]}'"


def ascii_name(text: str) -> str:
    """Return a name of letters in ASCII for one with others, empty where there is none.

    >>> ascii_name("ω_n"), ascii_name("Dämpfer"), ascii_name("Δφ"), ascii_name("質量")
    ('omega_n', 'Daempfer', 'Deltaphi', '')
    """
    written = "".join(_spelled(c) for c in text.translate(_UMLAUTS))
    return written if re.fullmatch(r"[A-Za-z]\w*", written, re.ASCII) else ""


def _spelled(character: str) -> str:
    name = unicodedata.name(character, "").partition(" WITH ")[0]
    greek = re.fullmatch(r"GREEK (SMALL|CAPITAL) LETTER (?:FINAL )?([A-Z]+)", name)
    if greek:
        letter = greek[2].lower().replace("lamda", "lambda")
        return letter if greek[1] == "SMALL" else letter.capitalize()
    if unicodedata.digit(character, None) is not None and not character.isascii():
        return f"_{unicodedata.digit(character)}"
    return "".join(c for c in unicodedata.normalize("NFKD", character) if not unicodedata.combining(c))


def name_hint(text: str) -> str | None:
    r"""Return how a name is written that is not in ASCII, and how its letters are printed all the same.

    >>> print(name_hint("ζ"), name_hint("a-b"), sep="\n")
    names are ASCII: write 'zeta', which latex = '\zeta' prints as before
    None
    """
    written = "" if text.isascii() else ascii_name(text)
    if not written:
        return None
    greek = "".join(f"\\{_spelled(c)} " if unicodedata.name(c, "").startswith("GREEK") else c for c in text)
    shown = re.sub(r" (?=\W|_|$)", "", greek)
    also = f", which latex = '{shown}' prints as before" if shown.isascii() else ""
    return f"names are ASCII: write '{written}'{also}"
