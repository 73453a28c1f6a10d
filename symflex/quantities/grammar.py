"""The grammar of quantities and units, and the exact value of each of its rules.

A quantity is a constant and a unit. The constant is made of decimal numbers, ``pi``, ``+ - * / ^`` (or
``**``) and parentheses; every intermediate value is a rational number times an integer power of pi. The
unit is made of symbols, ``*``, ``/``, integer powers and parentheses; a space or a dot multiplies too,
except after a slash, where its reach would be a guess (``J/kg K``). ``1/s`` is the one place for a
number in a unit, except a power without its sign, ``m2``. The usual products may run together, ``Nm``.
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Final, TypeVar

from symflex.quantities.characters import IMAGINARY_NAMES, IMAGINARY_UNIT, character_hint, code_point
from symflex.quantities.lalr import END, Grammar, Reading, Token, UnexpectedError
from symflex.quantities.units import Unit, run_together, unit_hint, unit_named

MAXIMUM_CHARACTERS: Final = 200
MAXIMUM_DIGITS: Final = 60
MAXIMUM_DECIMAL_EXPONENT: Final = 60
MAXIMUM_NUMBER_POWER: Final = 64
MAXIMUM_UNIT_POWER: Final = 12
MAXIMUM_UNIT_EXPONENT: Final = 144
MAXIMUM_BITS: Final = 2000
MAXIMUM_NESTING: Final = 20

NUMBER: Final = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
PI: Final = r"(?:pi(?![A-Za-z0-9_])|\u03c0)"
_SUPERSCRIPTS: Final = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"
# Letters of any script, so that a wrong one is reported as an unknown unit.
_SYMBOL: Final = rf"(?:\u00b0[A-Za-z]*|%|(?![{_SUPERSCRIPTS}])[^\W\d_](?:(?![{_SUPERSCRIPTS}])\w)*)"
# Plain, no-break, thin and narrow no-break spaces: what a typeset number carries.
SPACES: Final = " \t\u00a0\u2009\u202f"

GRAMMAR: Final = rf"""
    quantity: sum                          -> bare_quantity
            | sum chain                    -> quantity
    unit:     chain                        -> lone_unit
            | NUMBER                       -> number_one

    ?sum:     term
            | sum "+" term                 -> add
            | sum "-" term                 -> subtract
    ?term:    factor
            | term "*" factor              -> multiply
            | term "/" factor              -> divide
    ?factor:  power
            | MINUS factor                 -> negate
            | PLUS factor                  -> confirm
    ?power:   atom
            | atom _POWER factor           -> raise_number
    ?atom:    NUMBER                       -> number
            | PI                           -> pi
            | LPAR sum RPAR                -> parenthesis

    ?chain:   group
            | NUMBER "/" group             -> reciprocal
            | chain "*" group              -> multiply_units
            | chain "/" group              -> divide_units
    group:    factors
    factors:  measure                      -> first_factor
            | factors measure              -> next_factor
            | factors _DOT measure         -> next_factor
    ?measure: symbol
            | symbol _POWER exponent       -> raise_unit
            | symbol SUPERSCRIPT           -> raise_superscript
    ?symbol:  SYMBOL                       -> symbol
            | LPAR chain RPAR              -> parenthesis
    exponent: integer                      -> whole_exponent
            | LPAR integer RPAR            -> enclosed_exponent
            | LPAR integer "/" NUMBER RPAR -> broken_exponent
    integer:  NUMBER
            | MINUS NUMBER
            | PLUS NUMBER

    MINUS: "-"
    PLUS: "+"
    LPAR: "("
    RPAR: ")"
    _POWER: "**" | "^"
    _DOT: /[\u00b7\u22c5]/
    SUPERSCRIPT: /[\u207a\u207b]?[{_SUPERSCRIPTS}]+/
    NUMBER: /{NUMBER}/
    PI: /{PI}/
    SYMBOL: /{_SYMBOL}/
    SPACE: /[{SPACES}]+/
    %ignore SPACE
"""

SIGNED_NUMBER: Final = re.compile(rf"[+-]?[{SPACES}]*{NUMBER}")
_INTEGER: Final = re.compile(r"[0-9]{1,60}")
UNIT_START: Final = re.compile(_SYMBOL)
_NO_UNIT: Final = Unit(Fraction(1))
# As written in two words; read as a product, it would be an angle times a charge.
_TEMPERATURE: Final = re.compile(rf"(?<!\w)(?:deg|\u00b0)[{SPACES}\u00b7\u22c5]+([CFK])(?!\w)")


@dataclass(frozen=True, slots=True)
class Constant:
    """A value and the characters it was read from."""

    magnitude: Fraction
    pi_power: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class PlacedUnit:
    """A unit and the characters it was read from; ``factors`` counts what a space or dot joins.

    ``before`` is the part of the unit that a power does not reach, kg of kgm^2.
    """

    unit: Unit
    start: int
    end: int
    factors: int = 1
    before: Unit = _NO_UNIT


class RejectedError(Exception):
    """A reason to refuse the text, with offsets in it; becomes a SpecError where the text is known."""

    def __init__(self, code: str, message: str, start: int, end: int, hint: str | None = None) -> None:
        super().__init__(message)
        self.code, self.message, self.start, self.end, self.hint = code, message, start, end, hint


_Placed = TypeVar("_Placed", Constant, PlacedUnit)
_Result = tuple[Constant, PlacedUnit]

NOT_IN_PARAMETERS = f"a parameter is real; {IMAGINARY_UNIT}"
_ONE_NUMBER: Final = "write the number before the unit; a unit contains no number except 1 in '1/s'"
_NO_GROUPS: Final = "digits are not grouped, as in '12000 m'"
REMEMBERED: Final = 4096  # quantities, most of which an editor asks for again at each keystroke
NEARER: Final = "choose a unit in which the number is closer to 1"
# Stands at no place, so that a unit alone never seems to touch it.
_NO_CONSTANT: Final = Constant(Fraction(1), 0, -1, -1)


@functools.lru_cache(maxsize=REMEMBERED)
def evaluate(value: str, kind: str) -> tuple[Constant, PlacedUnit]:
    """Read a text as a ``"quantity"`` or a ``"unit"``, of which a part that is missing is 1.

    >>> constant, placed = evaluate("1/4 mm", "quantity")
    >>> constant.magnitude, placed.unit.scale, (placed.start, placed.end)
    (Fraction(1, 4), Fraction(1, 1000), (4, 6))
    """
    if len(value) > MAXIMUM_CHARACTERS:
        message = f"a {kind} of {len(value)} characters; at most {MAXIMUM_CHARACTERS} are read"
        raise RejectedError("SF103", message, 0, len(value), "write the number with fewer digits")
    if not value.strip(SPACES):
        hint = "write a number and a unit, as in '35 kN/m'"
        if kind == "unit":
            hint = "a pure number has the unit '1'"
        raise RejectedError("SF202", f"the {kind} is empty", 0, len(value), hint)
    if degrees := _TEMPERATURE.search(value):
        message, meant = f"unknown unit '{degrees[0]}'", unit_hint(f"deg{degrees[1]}")
        raise RejectedError("SF201", message, degrees.start(), degrees.end(), meant)
    _check_nesting(value)
    try:
        reading = Reading(_grammar(), value, kind)
        for _ in reading.words():
            pass
        result: object = reading.end()
    except UnexpectedError as unexpected:
        raise _syntax_rejection(unexpected, value, kind) from None
    assert isinstance(result, tuple)
    constant, placed = result
    plain = SIGNED_NUMBER.fullmatch(value, constant.start, constant.end)
    may_touch = plain and UNIT_START.match(value, placed.start)
    if placed.start == constant.end < placed.end and not may_touch:
        message = f"no space between number and unit in '{value}'"
        hint = "only a plain number may touch its unit, as in '3kg'"
        raise RejectedError("SF202", message, constant.start, placed.end, hint)
    return constant, placed


def _check_nesting(value: str) -> None:
    depth = 0
    for place, character in enumerate(value):
        depth += (character == "(") - (character == ")")
        if depth > MAXIMUM_NESTING:
            message = f"parentheses nested deeper than {MAXIMUM_NESTING}"
            raise RejectedError("SF103", message, place, place + 1, "write the value of what is inside")


def _syntax_rejection(unexpected: UnexpectedError, value: str, kind: str) -> RejectedError:
    start, token = unexpected.start, unexpected.token
    if token is not None and token.type == END:
        hint = "write an exponent after '^', as in mm^2" if value.rstrip(SPACES).endswith("^") else None
        return RejectedError("SF202", f"the {kind} '{value}' ends too early", len(value), len(value), hint)
    wrong = value[start] if token is None else str(token)
    hint = _syntax_hint(value[:start].strip(SPACES), value[start:].strip(SPACES), wrong)
    message = f"unexpected '{wrong}'{code_point(wrong[0])} in the {kind} '{value}'"
    if hint is None and (wrong == "," or not wrong.isascii()):
        hint = character_hint(value, start)
    return RejectedError("SF202", message, start, start + len(wrong), hint)


def _syntax_hint(before: str, after: str, wrong: str) -> str | None:
    if wrong in IMAGINARY_NAMES and re.search("[0-9] *[*]?$", before):
        return NOT_IN_PARAMETERS
    if UNIT_START.match(wrong):
        if not before and after.replace(" ", "").startswith("sqrt(-"):
            return NOT_IN_PARAMETERS
        if not before:
            return "a quantity begins with a number, as in '1 kg'"
        constant = before[:-1].strip(SPACES)
        if SIGNED_NUMBER.fullmatch(constant) and before[-1] in "*/":
            return f"write a space before the unit: '{constant} {'1/' if before[-1] == '/' else ''}{after}'"
    if re.match(NUMBER, wrong):
        return _ONE_NUMBER
    if wrong == '"' or (wrong == "'" and not after[1:2].isdigit()) or after[-1:] == '"':
        return "write feet as 'ft' and inches as 'in'; 6 feet and 2 inches are '74 in'"
    after = after[len(wrong) :]
    if wrong in {".", "-"} and UNIT_START.match(before[-1:]):
        if UNIT_START.match(after):
            product = f"{before}*{re.sub(f'(?<=[a-zA-Z])[{wrong}](?=[a-zA-Z])', '*', after)}"
            force = re.sub(r"\b(oz|lb)(?=[*](in|ft)\b(?!\^))|(?<=in[*]|ft[*])(oz|lb)\b", r"\1\3f", product)
            masses = "" if force == product else "; 'oz' and 'lb' are masses, 'ozf' and 'lbf' forces"
            return f"units are multiplied by '*' or a space: write '{force}'{masses}"
        power = re.match("[0-9]+", after)
        return f"write '^-{power[0]}'" if power and wrong == "-" else None
    if before[-1:].isdigit() and (
        (wrong in {"'", "_"} and after[:1].isdigit()) or re.search("[0-9] [0-9]+$", before)
    ):
        return _NO_GROUPS
    return None


@functools.cache
def _grammar() -> Grammar:
    return Grammar(Path(__file__).with_name("grammar.json"), _Evaluator(), is_contextual=True)


def _checked(constant: Constant) -> Constant:
    value = constant.magnitude
    size = max(value.numerator.bit_length(), value.denominator.bit_length())
    if size > MAXIMUM_BITS or abs(constant.pi_power) > MAXIMUM_NUMBER_POWER:
        message = f"the number is too large to be kept exactly (more than {MAXIMUM_BITS} bits)"
        if size <= MAXIMUM_BITS:
            message = f"the power of pi is beyond {MAXIMUM_NUMBER_POWER}"
        raise RejectedError("SF103", message, constant.start, constant.end, NEARER)
    return constant if value else Constant(value, 0, constant.start, constant.end)


def _checked_unit(placed: PlacedUnit) -> PlacedUnit:
    unit = placed.unit
    size = max(unit.scale.numerator.bit_length(), unit.scale.denominator.bit_length())
    powers = (unit.pi_power, unit.cycles, unit.radians)
    parts = (part for e in unit.dimension.exponents for part in (e.numerator, e.denominator))
    if size > MAXIMUM_BITS or any(abs(power) > MAXIMUM_UNIT_EXPONENT for power in (*powers, *parts)):
        message = "the unit's powers are too large"
        hint = "write it in lower powers of SI units"
        raise RejectedError("SF103", message, placed.start, placed.end, hint)
    return placed


class _Evaluator:
    """The value of each grammar rule, computed while parsing."""

    def bare_quantity(self, constant: Constant) -> _Result:
        return constant, PlacedUnit(_NO_UNIT, constant.end, constant.end)

    def quantity(self, constant: Constant, placed: PlacedUnit) -> _Result:
        magnitude = constant.magnitude * placed.unit.scale
        pi_power = constant.pi_power + placed.unit.pi_power
        _checked(Constant(magnitude, pi_power, constant.start, placed.end))
        return constant, placed

    def lone_unit(self, placed: PlacedUnit) -> _Result:
        return _NO_CONSTANT, placed

    def number_one(self, number: Token) -> _Result:
        _require_one(number)
        return _NO_CONSTANT, PlacedUnit(_NO_UNIT, number.start, number.end)

    def number(self, number: Token) -> Constant:
        mantissa, _, exponent = number.lower().partition("e")
        if sum(character != "." for character in mantissa) > MAXIMUM_DIGITS:
            message = f"a number of more than {MAXIMUM_DIGITS} digits"
            raise RejectedError("SF103", message, number.start, number.end, "leave out the last digits")
        if exponent and abs(int(exponent)) > MAXIMUM_DECIMAL_EXPONENT:
            message = f"a decimal exponent beyond {MAXIMUM_DECIMAL_EXPONENT}"
            raise RejectedError("SF103", message, number.start, number.end, NEARER)
        return Constant(Fraction(str(number)), 0, number.start, number.end)

    def pi(self, token: Token) -> Constant:
        return Constant(Fraction(1), 1, token.start, token.end)

    def parenthesis(self, left: Token, inner: _Placed, right: Token) -> _Placed:
        if isinstance(inner, Constant):
            return Constant(inner.magnitude, inner.pi_power, left.start, right.end)
        return PlacedUnit(inner.unit, left.start, right.end)

    def negate(self, sign: Token, operand: Constant) -> Constant:
        return Constant(-operand.magnitude, operand.pi_power, sign.start, operand.end)

    def confirm(self, sign: Token, operand: Constant) -> Constant:
        return Constant(operand.magnitude, operand.pi_power, sign.start, operand.end)

    def add(self, left: Constant, right: Constant) -> Constant:
        if left.magnitude and right.magnitude and left.pi_power != right.pi_power:
            message = "the sum is not a rational number times a power of pi"
            raise RejectedError("SF202", message, left.start, right.end)
        pi_power = left.pi_power if left.magnitude else right.pi_power
        return _checked(Constant(left.magnitude + right.magnitude, pi_power, left.start, right.end))

    def subtract(self, left: Constant, right: Constant) -> Constant:
        return self.add(left, Constant(-right.magnitude, right.pi_power, right.start, right.end))

    def multiply(self, left: Constant, right: Constant) -> Constant:
        magnitude, pi_power = left.magnitude * right.magnitude, left.pi_power + right.pi_power
        return _checked(Constant(magnitude, pi_power, left.start, right.end))

    def divide(self, left: Constant, right: Constant) -> Constant:
        if not right.magnitude:
            raise RejectedError("SF202", "division by zero", left.start, right.end)
        magnitude, pi_power = left.magnitude / right.magnitude, left.pi_power - right.pi_power
        return _checked(Constant(magnitude, pi_power, left.start, right.end))

    def raise_number(self, base: Constant, exponent: Constant) -> Constant:
        if exponent.pi_power or exponent.magnitude.denominator != 1:
            raise RejectedError("SF202", "the exponent is not an integer", exponent.start, exponent.end)
        power = exponent.magnitude.numerator
        if abs(power) > MAXIMUM_NUMBER_POWER:
            message = f"an exponent beyond {MAXIMUM_NUMBER_POWER}"
            raise RejectedError("SF103", message, exponent.start, exponent.end, "write the power's value")
        if not base.magnitude and power < 0:
            raise RejectedError("SF202", "division by zero", base.start, exponent.end)
        return _checked(Constant(base.magnitude**power, base.pi_power * power, base.start, exponent.end))

    def symbol(self, symbol: Token) -> PlacedUnit:
        unit = unit_named(str(symbol))
        if unit is None and (together := run_together(str(symbol))):
            before, last = together
            return PlacedUnit(before * last, symbol.start, symbol.end, before=before)
        if unit is None:
            message = f"unknown unit '{symbol}'"
            meant = unit_hint(str(symbol))
            if str(symbol) in IMAGINARY_NAMES:
                meant = f"a joule is J; {NOT_IN_PARAMETERS}" if symbol == "j" else NOT_IN_PARAMETERS
            raise RejectedError("SF201", message, symbol.start, symbol.end, meant)
        return PlacedUnit(unit, symbol.start, symbol.end)

    def raise_unit(self, base: PlacedUnit, exponent: Constant) -> PlacedUnit:
        above, degree = exponent.magnitude.numerator, exponent.magnitude.denominator
        if max(abs(above), degree) > MAXIMUM_UNIT_POWER:
            message = f"a unit's power beyond {MAXIMUM_UNIT_POWER}"
            raise RejectedError("SF103", message, exponent.start, exponent.end, "write it in lower powers")
        unit: Unit | None = (base.unit / base.before) ** above
        if degree > 1 and unit:
            unit = unit.root(degree)
        if unit is None:
            message = f"the power {exponent.magnitude} of this unit has no exact factor"
            hint = "divide by one unit under the root: K*sqrt(p/p_1), with p_1 = '1 bar'"
            raise RejectedError("SF202", message, base.start, exponent.end, hint)
        return _checked_unit(PlacedUnit(base.before * unit, base.start, exponent.end))

    def raise_superscript(self, base: PlacedUnit, superscript: Token) -> PlacedUnit:
        digits = superscript.translate(_PLAIN_DIGITS)
        return self.raise_unit(base, Constant(Fraction(digits), 0, superscript.start, superscript.end))

    def integer(self, *tokens: Token) -> Constant:
        number = tokens[-1]
        start, end = tokens[0].start, number.end
        if not _INTEGER.fullmatch(number):
            hint = "a root is written 'm^(1/2)'"
            raise RejectedError("SF202", "a unit's power is an integer", start, end, hint)
        return Constant(Fraction("".join(tokens)), 0, start, end)

    def whole_exponent(self, exponent: Constant) -> Constant:
        return exponent

    def enclosed_exponent(self, left: Token, exponent: Constant, right: Token) -> Constant:
        return Constant(exponent.magnitude, 0, left.start, right.end)

    def broken_exponent(self, left: Token, above: Constant, below: Token, right: Token) -> Constant:
        divisor = self.integer(below).magnitude
        if not divisor:
            raise RejectedError("SF202", "division by zero", above.start, below.end)
        return Constant(above.magnitude / divisor, 0, left.start, right.end)

    def first_factor(self, placed: PlacedUnit) -> PlacedUnit:
        return placed

    def next_factor(self, left: PlacedUnit, right: PlacedUnit) -> PlacedUnit:
        unit = left.unit * right.unit
        return _checked_unit(PlacedUnit(unit, left.start, right.end, left.factors + 1))

    def group(self, placed: PlacedUnit) -> PlacedUnit:
        return placed

    def reciprocal(self, number: Token, right: PlacedUnit) -> PlacedUnit:
        _require_one(number)
        return self.divide_units(PlacedUnit(_NO_UNIT, number.start, number.end), right)

    def multiply_units(self, left: PlacedUnit, right: PlacedUnit) -> PlacedUnit:
        return _checked_unit(PlacedUnit(left.unit * right.unit, left.start, right.end))

    def divide_units(self, left: PlacedUnit, right: PlacedUnit) -> PlacedUnit:
        if right.factors > 1:
            message = "after a slash, a product without '*' can be read two ways"
            hint = "write '/(a*b)' when both divide, '/a*b' when only the first does"
            raise RejectedError("SF202", message, right.start, right.end, hint)
        return _checked_unit(PlacedUnit(left.unit / right.unit, left.start, right.end))


_PLAIN_DIGITS: Final = str.maketrans(f"{_SUPERSCRIPTS}\u207a\u207b", "0123456789+-")


def _require_one(number: Token) -> None:
    if number != "1":
        message = f"the number '{number}' in a unit"
        raise RejectedError("SF202", message, number.start, number.end, _ONE_NUMBER)
