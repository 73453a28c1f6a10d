"""What to say about a text that is not an expression: the common slips and their cures.

Everything here reads the text around the place where the parser stopped; nothing here decides what is valid.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

from symflex.quantities import IMAGINARY_NAMES, IMAGINARY_UNIT, character_hint, code_point, unit_named
from symflex.quantities.lalr import Token

# With one argument each.
FUNCTIONS = ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan")
RECIPROCALS = {"cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh", "csch": "sinh"}
"""What formulas write for one over a function."""

LONGEST_QUOTE = 24


class Slip(NamedTuple):
    """A diagnostic whose place is still an offset in the text."""

    start: int
    end: int
    code: str
    message: str
    hint: str | None = None


def character_slip(value: str, position: int) -> Slip:
    """Explain a character that begins no word of the language."""
    character = value[position]
    before = value[position - 1] if position else ""
    if character == "_":
        return _underscore_slip(value, position, before)
    message = f"unexpected {_quoted(character)}{code_point(character)}"
    return Slip(position, position + 1, "SF111", message, character_hint(value, position))


def _underscore_slip(value: str, position: int, before: str) -> Slip:
    if before.isdigit() or before == ".":
        return Slip(position, position + 1, "SF111", "unexpected '_'", "a number is written without '_'")
    word = re.compile(r"\w{1,65}", re.ASCII).match(value, position)
    end = word.end() if word else position + 1
    message = f"the name {_quoted(value[position:end])} begins with an underscore"
    return Slip(position, end, "SF112", message, "a name begins with a letter")


def end_slip(value: str, last: Token, expected: Collection[str], *, is_equation: bool) -> Slip:
    """Explain a text that ends too early; ``last`` is its last word."""
    opening = _open_parenthesis(value, len(value))
    if "NUMBER" in expected or "NAME" in expected:
        what = "equation" if is_equation else "expression"
        message = f"the {what} ends after {_quoted(last)}; expected {_wanted(expected, opening, '')}"
        return Slip(last.start, last.end, "SF111", message)
    if opening is not None:
        return _unclosed_slip(opening)
    return Slip(last.start, last.end, "SF111", "this equation has no '='", "write it as 'left = right'")


def token_slip(value: str, recent: Sequence[Token], expected: Collection[str], *, is_equation: bool) -> Slip:
    """Explain a word that cannot stand where it stands; it is the last of ``recent``."""
    token = recent[-1]
    start = token.start
    opening = _open_parenthesis(value, start)
    wants_operand = "NUMBER" in expected or "NAME" in expected
    if token.type == "EQUAL" and opening is not None and not wants_operand and is_equation:
        return _unclosed_slip(opening)
    after = f" after {_quoted(recent[-2])}" if len(recent) > 1 else ""
    equals = " or '='" if is_equation and "=" not in value[:start] else ""
    message = f"unexpected {_quoted(token)}{after}; expected {_wanted(expected, opening, equals)}"
    hint = _token_hint(value, recent, opening, is_equation=is_equation, wants_operand=wants_operand)
    return Slip(start, start + len(token), "SF111", message, hint)


def _token_hint(
    value: str, recent: Sequence[Token], opening: int | None, *, is_equation: bool, wants_operand: bool
) -> str | None:
    token = recent[-1]
    if token.type == "EQUAL":
        if not is_equation:
            return "an expression has no '='; only the equations and conditions of a field do"
        if not value[: token.start].strip():
            return "write an expression to the left of '='"
        return "write a single '='" if value[: token.start].endswith("=") else "an equation has one '='"
    if token.type == "RPAR" and opening is None:
        return "there is no '(' for it to close"
    if token.type == "RPAR" and len(recent) > 1 and recent[-2].type == "LPAR":
        return "write an expression between '(' and ')'"
    if token.type == "SCALE" and wants_operand and len(recent) > 1 and str(recent[-2]) == str(token) == "/":
        return "write '/' to divide"
    if len(recent) > 1 and recent[-2].type == "DOT" and token.type in {"SCALE", "POWER"}:
        return f"write '{token}' in place of '.{token}'"
    if wants_operand or len(recent) == 1:
        return None
    return _neighbour_hint(value, recent)


def _neighbour_hint(value: str, recent: Sequence[Token]) -> str | None:
    """Return the cure for two operands side by side."""
    before, token = recent[-2], recent[-1]
    types = [word.type for word in recent]
    if token.type == "PRIMES":
        hint = "primes follow the name of a field, w''(l), or a bracket, (a*x*w')'"
        return hint if before.type == "RPAR" else None
    if token.type == "DOT":
        return "a number has at most one decimal point" if before.type == "NUMBER" else None
    if before.type == "NAME" and str(before) in FUNCTIONS and token.type != "LPAR":
        return f"write '{before}({_short(token)})'" if _short(token) else f"write '{before}(...)'"
    if types[-4:] == ["NAME", "POWER", "NUMBER", "LPAR"] and str(recent[-4]) in FUNCTIONS:
        return f"write '{recent[-4]}(...)^{_short(before)}'"
    if token.type == "SCALE":
        return "a length with a unit must stand alone or in a sum"
    left, right = _short(_operand(recent[:-1], types)), _short(token)
    cure = f"write {_quoted(f'{left}*{right}')}" if left and right else "write '*' to multiply"
    spaced = before.end < token.start
    if before.type == "NUMBER" and str(token) in IMAGINARY_NAMES and not spaced:
        return f"write '{before}*j': {IMAGINARY_UNIT}"
    if before.type == "NUMBER" and token.type == "NAME" and spaced:
        if unit_named(str(token)):
            quantity = f"{before} {_units(value[token.start :])}"
            return f'a number with a unit belongs in [parameters]: c = "{quantity}"'
        return f"{cure} to multiply; a number with a unit belongs in [parameters]"
    return cure


def _units(text: str) -> str:
    """Return the product of units that a text begins with."""
    end = 0
    for word in re.finditer(r"(?:^|[*/])([A-Za-z]+)(?:\^-?[0-9]+)?", text):
        if word.start() != end or not unit_named(word[1]):
            break
        end = word.end()
    return _short(text[:end]) or "..."


def _operand(words: Sequence[Token], types: Sequence[str]) -> str:
    """Return the last operand as far as its own words are at hand: ``w''``, ``motor.i``, ``)``."""
    if len(words) > 1 and types[len(words) - 1] == "PRIMES":
        return f"{words[-2]}{words[-1]}"
    if len(words) > 2 and types[len(words) - 2] == "DOT":  # noqa: PLR2004
        return f"{words[-3]}.{words[-1]}"
    return str(words[-1])


def _unclosed_slip(opening: int) -> Slip:
    return Slip(opening, opening + 1, "SF111", "this '(' is never closed", "add a ')'")


def _open_parenthesis(value: str, end: int) -> int | None:
    """Return the offset of the innermost parenthesis still open at ``end``."""
    opened: list[int] = []
    for match in re.finditer(r"[()]", value[:end]):
        if match[0] == "(":
            opened.append(match.start())
        elif opened:
            opened.pop()
    return opened[-1] if opened else None


def _wanted(expected: Collection[str], opening: int | None, equals: str) -> str:
    if "NUMBER" in expected:
        return "a number, a name or '('"
    if "NAME" in expected:
        return "the name of a quantity, as in motor.i"
    return "an operator" + (" or ')'" if opening is not None else equals)


def _short(text: str) -> str:
    """Return ``text`` if it is short enough to be repeated in a hint, else nothing."""
    return str(text) if len(text) <= LONGEST_QUOTE else ""


def _quoted(text: str) -> str:
    shown = str(text) if len(text) <= LONGEST_QUOTE else f"{text[:LONGEST_QUOTE]}..."
    return f'"{shown}"' if "'" in shown else f"'{shown}'"
