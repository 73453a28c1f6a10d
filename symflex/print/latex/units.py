r"""Unit strings such as ``N*s/m`` as siunitx units."""

from __future__ import annotations

import re
from typing import Final

from symflex.print.latex.text import escape_text

_SYMBOLS: Final = {
    "kg": r"\kilogram", "m": r"\metre", "s": r"\second", "A": r"\ampere", "K": r"\kelvin", "mol": r"\mole",
    "cd": r"\candela", "rad": r"\radian", "sr": r"\steradian", "Hz": r"\hertz", "N": r"\newton",
    "Pa": r"\pascal", "J": r"\joule", "W": r"\watt", "C": r"\coulomb", "V": r"\volt", "F": r"\farad",
    "Ohm": r"\ohm", "ohm": r"\ohm", "S": r"\siemens", "Wb": r"\weber", "T": r"\tesla", "H": r"\henry",
    "g": r"\gram", "lm": r"\lumen", "lx": r"\lux", "bar": r"\bar", "l": r"\litre", "L": r"\litre",
    "min": r"\minute", "h": r"\hour",
    "deg": r"\degree", "t": r"\tonne",
}  # fmt: skip
_PREFIXES: Final = {
    "k": r"\kilo", "M": r"\mega", "G": r"\giga", "T": r"\tera", "d": r"\deci", "c": r"\centi", "m": r"\milli",
    "u": r"\micro", "n": r"\nano", "p": r"\pico", "f": r"\femto",
}  # fmt: skip
_TOKEN: Final = re.compile(r"([A-Za-z]+)|(\*\*|[*/^()])|([+-]?[0-9]+)|\s+")
_POWERS: Final = {"1": "", "2": r"\squared", "3": r"\cubed"}


def siunitx_unit(unit: str) -> str | None:
    r"""Return the argument of ``\unit`` or ``\qty``; empty for a pure number, ``None`` when it has none."""
    factors = _factors(unit)
    if factors is None:
        return None
    ordered = sorted(factors, key=lambda factor: factor[2] < 0)
    return "".join(
        r"\per" * (sign < 0) + symbol + _POWERS.get(power, rf"\tothe{{{power}}}")
        for symbol, power, sign in ordered
    )


def quantity_latex(number: str, unit: str) -> str:
    """Return a number with its unit; a unit that siunitx lacks is set as text."""
    written = siunitx_unit(unit)
    if written is None:
        return rf"\num{{{number}}}~{escape_text(unit)}"
    return rf"\qty{_option(written)}{{{number}}}{{{written}}}" if written else rf"\num{{{number}}}"


def unit_latex(unit: str) -> str:
    """Return a unit alone, 1 for a pure number."""
    written = siunitx_unit(unit)
    if written is None:
        return escape_text(unit)
    return rf"\unit{_option(written)}{{{written}}}" if written else "1"


def _option(known: str) -> str:
    """Return the option that keeps a slash from opening a unit."""
    return "[per-mode=power]" if known.startswith(r"\per") else ""


def _symbol(text: str) -> str | None:
    if text in _SYMBOLS:
        return _SYMBOLS[text]
    prefix, base = _PREFIXES.get(text[:1]), _SYMBOLS.get(text[1:])
    return f"{prefix}{base}" if prefix and base else None


def _factors(unit: str) -> list[tuple[str, str, int]] | None:
    """Return (symbol, power, sign) for each factor; ``None`` for what is not a product of known units."""
    tokens = _tokens(unit)
    if tokens is None:
        return None
    factors: list[tuple[str, str, int]] = []
    # The sign of each open parenthesis, and that of the next factor within the innermost one.
    signs, sign, position = [1], 1, 0
    while position < len(tokens):
        token = tokens[position]
        position += 1
        if token == "(":
            signs.append(signs[-1] * sign)
            sign = 1
        elif token == ")":
            if len(signs) == 1:
                return None
            signs.pop()
            sign = 1
        elif token in ("*", "/"):
            sign = -1 if token == "/" else 1
        elif token != "1":
            symbol = _symbol(token)
            if symbol is None:
                return None
            power, position = _read_power(tokens, position)
            if power is None:
                return None
            magnitude, below = power.removeprefix("-"), power.startswith("-")
            factors.append((symbol, magnitude, signs[-1] * sign * (-1 if below else 1)))
    return factors


def _tokens(unit: str) -> list[str] | None:
    tokens, position = [], 0
    while position < len(unit):
        match = _TOKEN.match(unit, position)
        if match is None:
            return None
        position = match.end()
        if not match[0].isspace():
            tokens.append("^" if match[0] == "**" else match[0])
    return tokens


def _read_power(tokens: list[str], position: int) -> tuple[str | None, int]:
    if tokens[position : position + 1] != ["^"]:
        return "1", position
    rest = tokens[position + 1 :]
    if rest[:1] == ["("] and rest[4:5] == [")"] and rest[2] == "/":
        return f"{rest[1]}/{rest[3]}", position + 6
    if rest[:1] == ["("] and rest[2:3] == [")"]:
        rest, position = rest[1:], position + 2
    if rest and rest[0].lstrip("+-").isdigit():
        return rest[0].lstrip("+"), position + 2
    return None, position
