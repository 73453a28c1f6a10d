"""Which signs lengths, stiffnesses, delays and points along x have, as far as expressions of parameters say.

A value is read as a polynomial in the parameters (exponents may be negative). Of a difference that is such a
polynomial the sign is known when all its coefficients agree, since parameters are positive, or when all
parameters in it have values.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, reduce
from math import prod
from typing import TYPE_CHECKING, cast

from flint import arb, arb_series

from symflex.algebra import FUNCTIONS, LAPLACE
from symflex.balls import UndecidedError, ball, covered
from symflex.errors import Diagnostic, Span, UsageError
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    fold,
    names,
    substitute,
)
from symflex.library.blocks import ROOT
from symflex.library.elements import LineElement, Sign
from symflex.model.linearity import integer_exponent
from symflex.model.model import PI_NEARLY, Definition, ExactValue, Model, PlacedElement
from symflex.model.reading import Reader, literal_value
from symflex.model.scope import COORDINATE
from symflex.model.units import lower

if TYPE_CHECKING:
    from symflex.model.network import Draft

Monomial = tuple[tuple[str, int], ...]
Polynomial = dict[Monomial, Fraction]

BENDING, SHEAR = {"E", "EI"}, {"G", "kappaGA"}
LOSSES = {**dict.fromkeys(("EA", "GJ", *sorted(BENDING | SHEAR)), "eta"), "k_f": "c_f"}
"""What a part with s of a member's value is: ``E*(1 + tau*s)`` has Kelvin-Voigt damping."""
TERM_LIMIT = 64
DEGREE_LIMIT = 64
BIT_LIMIT = 4_000  # lengths people write stay far below; beyond, the sign is left open


@dataclass(frozen=True)
class Line:
    """The parameters that places along x are made of.

    >>> from symflex.expressions import Negative, Number, Quotient, Sum
    >>> l, half = Name("l"), Quotient(Name("l"), Number(Fraction(2)))
    >>> line = Line({}, frozenset({"l"}), frozenset(), {})
    >>> line.sign(Sum((l, Negative(half)))), line.sign(Sum((half, Negative(l)))), line.sign(Name("x_s"))
    (1, -1, None)
    """

    definitions: Mapping[str, Expression]  # opened where they occur; each uses only earlier ones
    # positive and nonnegative: parameters by what is assumed of them.
    positive: frozenset[str]
    nonnegative: frozenset[str]
    values: Mapping[str, Fraction]  # of those that have one
    _opened: dict[str, Polynomial | None] = field(default_factory=dict, repr=False)

    @cached_property
    def enclosures(self) -> Mapping[str, arb]:
        """The values of parameters and definitions, of those that have one."""
        enclosed = {"pi": arb.pi(), **{name: ball(value) for name, value in self.values.items()}}
        for name, expression in self.definitions.items():
            if (value := _enclosed(expression, enclosed)) is not None:
                enclosed[name] = value
        return enclosed

    @staticmethod
    def of_numbers(
        definitions: Iterable[Definition],
        values: Iterable[tuple[str, ExactValue | None]],
        positive: frozenset[str] = frozenset(),
    ) -> Line:
        """Return the line of parameters of which nothing is known but values, and that some are positive."""
        numbers = {name: v.nearly for name, v in values if v is not None}
        positive |= {name for name, value in numbers.items() if value > 0}
        return Line({d.name: d.expression for d in definitions}, positive, frozenset(), numbers)

    def __post_init__(self) -> None:
        """Open the definitions in order, so that a long chain is not followed at once."""
        for name, expression in self.definitions.items():
            self._opened[name] = self._read(expression)

    def sign(self, difference: Expression) -> int | None:
        """Return the sign of an expression, ``None`` if it cannot be decided."""
        polynomial = self._read(difference)
        if polynomial is None:
            return self._sign_in_balls(difference)
        sign = self._sign_of(polynomial)
        return self._sign_in_balls(difference) if sign is None else sign

    def signs_by_power(self, expression: Expression, name: str) -> dict[int, int | None]:
        """Return the signs of what powers of a name are multiplied by, nothing of what is no polynomial.

        >>> from symflex.expressions import Product, Sum
        >>> line = Line({}, frozenset({"E", "E_v"}), frozenset(), {})
        >>> line.signs_by_power(Sum((Name("E"), Product((Name("E_v"), Name("s"))))), "s")
        {0: 1, 1: 1}
        """
        by_power: dict[int, Polynomial] = {}
        for monomial, coefficient in (self._read(expression) or {}).items():
            exponent = dict(monomial).get(name, 0)
            rest = tuple((n, e) for n, e in monomial if n != name)
            by_power.setdefault(exponent, {})[rest] = coefficient
        return {exponent: self._sign_of(part) for exponent, part in by_power.items()}

    def _sign_of(self, polynomial: Polynomial) -> int | None:
        if not polynomial:
            return 0
        signs = {1 if c > 0 else -1 for c in polynomial.values()}
        used = {name for monomial in polynomial for name, _ in monomial}
        if len(signs) == 1 and used <= self.positive | self.nonnegative | {"pi"}:
            certain = self.positive | {"pi"}
            if any(all(name in certain for name, _ in monomial) for monomial in polynomial):
                return signs.pop()
        value = self._value(polynomial)
        return None if value is None else (value > 0) - (value < 0)

    def _sign_in_balls(self, expression: Expression) -> int | None:
        """Return the sign of the number an expression is, of any form: ``E/(2*(1 + nu))``."""
        number = value_along(expression, arb("nan"), self)
        return 0 if number is not None and number == 0 else sign_of(number)

    def is_zero(self, value: Expression) -> bool:
        """Tell whether a value is zero whatever the parameters are."""
        return self._read(value) == {}

    def value(self, position: Expression) -> Fraction | None:
        """Return the number a place is with the parameters' values."""
        polynomial = self._read(position)
        return None if polynomial is None else self._value(polynomial)

    def is_polynomial_in(self, expression: Expression, name: str) -> bool:
        """Tell whether no negative power of a name occurs, nor any other function of it."""
        polynomial = self._read(expression)
        return polynomial is not None and all(e >= 0 for m in polynomial for n, e in m if n == name)

    def opened_names(self, expression: Expression) -> set[str]:
        """Return the names of an expression and of the definitions in it; a dot for what else may vary."""
        opened: set[str] = set()
        for each in names(expression):
            if isinstance(each, Name) and each.name in self.definitions:
                opened |= self.opened_names(self.definitions[each.name])
            elif not isinstance(each, Call) or each.name not in FUNCTIONS:
                opened.add(each.name if isinstance(each, Name) else ".")
        return opened

    def nearly(self, expression: Expression) -> float | None:
        """Return the double next to the number an expression of any form is, None without one."""
        exact = self.value(expression)
        if exact is not None:
            return float(exact)
        number = value_along(expression, arb("nan"), self)
        return float(number.mid()) if number is not None and number.is_finite() else None

    def key(self, position: Expression) -> Hashable:
        """Return what is equal of equal places: the number, else the polynomial, else the place as written.

        >>> from symflex.expressions import Number, Product, Quotient
        >>> half = Quotient(Name("l"), Number(Fraction(2)))
        >>> line = Line({}, frozenset({"l"}), frozenset(), {})
        >>> line.key(half) == line.key(Product((Number(Fraction(1, 2)), Name("l"))))
        True
        """
        polynomial = self._read(position)
        if polynomial is None:
            return position
        value = self._value(polynomial)
        return frozenset(polynomial.items()) if value is None else value

    def _value(self, polynomial: Polynomial) -> Fraction | None:
        total = Fraction(0)
        for monomial, coefficient in polynomial.items():
            product = coefficient
            for name, exponent in monomial:
                exact = PI_NEARLY if name == "pi" else self.values.get(name)
                if exact is None or (exact == 0 and exponent < 0):
                    return None
                product *= exact**exponent
            total += product
        return total

    def _read(self, expression: Expression) -> Polynomial | None:
        try:
            return fold(
                lower(expression),  # a quantity is a number here
                number=_constant,
                name=self._name,
                power=lambda base, exponent: _power(base, integer_exponent(exponent)),
                call=_unread,
                negative=lambda inner: {m: -c for m, c in inner.items()},
                total=_sum,
                product=lambda factors: reduce(_product, factors, _constant(Fraction(1))),
                quotient=lambda above, below: _product(above, _power(below, -1)),
            )
        except (_UnreadError, TypeError):  # derivatives and their like have no value by themselves
            return None

    def _name(self, name: str) -> Polynomial:
        opened = self._opened.get(name, {((name, 1),): Fraction(1)})
        return _unread() if opened is None or "." in name else opened


class _UnreadError(Exception):
    """An expression is no polynomial, or too large a one."""


def _unread(*_: object) -> Polynomial:
    raise _UnreadError


def _sum(parts: Sequence[Polynomial]) -> Polynomial:
    total: Polynomial = {}
    for part in parts:
        for monomial, coefficient in part.items():
            total[monomial] = total.get(monomial, Fraction(0)) + coefficient
    kept = {m: c for m, c in total.items() if c}
    small = all(max(c.numerator.bit_length(), c.denominator.bit_length()) < BIT_LIMIT for c in kept.values())
    return kept if small and len(kept) <= TERM_LIMIT else _unread()


def _constant(value: Fraction) -> Polynomial:
    return {(): value} if value else {}


def _product(left: Polynomial, right: Polynomial) -> Polynomial:
    if len(left) * len(right) > TERM_LIMIT:
        return _unread()
    parts: list[Polynomial] = []
    for one, a in left.items():
        for other, b in right.items():
            exponents = dict(one)
            for name, e in other:
                exponents[name] = exponents.get(name, 0) + e
            if any(abs(e) > DEGREE_LIMIT for e in exponents.values()):
                return _unread()
            monomial = tuple(sorted((n, e) for n, e in exponents.items() if e))
            parts.append({monomial: a * b})
    return _sum(parts)


def _power(base: Polynomial, exponent: int | None) -> Polynomial:
    """Return a power of a single term; sums are not multiplied out."""
    if exponent == 1:
        return base
    if exponent is None or len(base) != 1 or abs(exponent) > DEGREE_LIMIT:
        return _unread()
    ((monomial, coefficient),) = base.items()
    if any(abs(e * exponent) > DEGREE_LIMIT for _, e in monomial):
        return _unread()
    return _sum([{tuple((n, e * exponent) for n, e in monomial if exponent): coefficient**exponent}])


@dataclass(frozen=True, slots=True)
class RangedValue:
    """A value that has to be positive, or not negative; ``what`` and ``reason`` are for messages."""

    what: str
    expression: Expression
    sign: Sign
    reason: str
    is_extent: bool = False  # a length or a delay, which cannot depend on s
    is_end: bool = False  # what varies along x, at an end, where it may vanish whatever the values
    length: Expression | None = None  # of the member, of what varies along it

    def complaint(self, line: Line) -> str:
        """Return what is wrong with the value's sign, nothing where it may have it."""
        sign = line.sign(self.expression)
        if self.length is not None and sign is None:
            return self._complaint_inside(line, self.length)
        least = 1 if self.sign == "positive" else 0
        if sign is None or sign >= least:
            return ""
        # A zero at an end may be one whatever the values, or of a form that is not read, such as a cube.
        if (
            self.is_end
            and not sign
            and (line.is_zero(self.expression) or line.value(self.expression) is None)
        ):
            return ""
        value = None if literal_value(self.expression) is not None else line.nearly(self.expression)
        shown = f" ({value:.6g})" if value else ""
        return f"{self.what} is {'negative' if sign < 0 else '0'}{shown}; {self.reason}"

    def _complaint_inside(self, line: Line, length: Expression) -> str:
        """Return what is wrong at the first of some points between the ends."""
        extent = line.value(length)
        if extent is None:
            return ""
        for k in range(1, PIECES):
            position = extent * k / PIECES
            value = value_along(self.expression, ball(position), line)
            if value is None or not value.is_finite():
                return ""
            if value < 0 or (self.sign == "positive" and value == 0):
                # Near a simple zero balls of exact numbers are as exact as these.
                shown = f"negative ({float(value.mid()):.6g})" if value < 0 else "0"
                return f"{self.what} at x = {float(position):.6g} m is {shown}; {self.reason}"
        return ""


def ranged_values(draft: Draft | Model) -> Iterator[RangedValue]:
    """Yield the values of distributed elements and delays that cannot have any sign."""
    for use in draft.elements:
        element = use.element
        if not isinstance(element, LineElement):
            continue
        given = dict(use.values)
        for port in element.parameters:
            sign: Sign = "positive" if port.name == element.length else port.sign
            if sign != "any" and port.name in given:
                reason = f"{port.doc} must be positive" if sign == "positive" else f"{port.doc} cannot be"
                what = f"{port.name} of {element.type_name} '{use.name}'"
                is_along = port.varies and COORDINATE in {n.name for n in names(given[port.name])}
                length = given.get(element.length) if is_along else None
                is_length = port.name == element.length
                # What varies along x is told at the ends, where it mostly is least.
                ends = {"0": Number(Fraction(0)), element.length: length}
                for position, end in ends.items() if is_along else ():
                    if end is not None:
                        at = substitute(given[port.name], {COORDINATE: lower(end)})
                        yield RangedValue(f"{what} at x = {position}", at, sign, reason, is_end=True)
                yield RangedValue(what, given[port.name], sign, reason, is_length, length=length)
    for placed in draft.blocks:
        block = placed.block
        if block is not None and block.kernel_time:
            what = f"{block.kernel_time} of {block.type_name} '{placed.name}'"
            time = dict(placed.values)[block.kernel_time]
            reason = "a delay cannot look ahead"
            if placed.span == time.span:  # written as an exponential
                reason += "; the z of a sampled controller is 1/exp(-s*T)"
            yield RangedValue(what, time, "nonnegative", reason, is_extent=True)
        elif block is ROOT:
            values = dict(placed.values)
            reason = "the branch point must not lie in the right half-plane"
            yield RangedValue("a of (a*s + b)", values["a"], "positive", reason, is_extent=True)
            yield RangedValue("b of (a*s + b)", values["b"], "nonnegative", reason, is_extent=True)


def check_ranges(
    reader: Reader, draft: Draft, line: Line, unsound: set[Span | None], *, is_along: bool
) -> None:
    """Note values of distributed parts, along x or others, that are zero or negative where they cannot be."""
    for ranged in ranged_values(draft):
        expression = ranged.expression
        if (ranged.is_end or ranged.length is not None) != is_along:
            continue
        if expression.span not in unsound and (message := ranged.complaint(line)):
            reader.note("SF209", message, expression.span)
            unsound.add(expression.span)


def check_value(model: Model, name: str, value: ExactValue, varied: Collection[str]) -> None:
    """Refuse a value of a parameter with which a distributed part is what none can be: SF209."""
    exact = {p.name: p.value for p in model.parameters if p.value and p.name not in varied} | {name: value}
    line = Line(
        {d.name: d.expression for d in model.definitions},
        frozenset(p.name for p in model.parameters if p.assume == "positive"),
        # The value itself tells the sign of what it stands for alone.
        frozenset(p.name for p in model.parameters if p.assume == "nonnegative" and p.name != name),
        {each: v.nearly for each, v in exact.items()},
    )
    for ranged in ranged_values(model):
        if message := ranged.complaint(line):
            shown = float(value.nearly)
            raise UsageError(Diagnostic("SF209", f"with {name} = {shown:.6g}, {message}"))


PIECES = 64  # number of pieces of a member: a value that varies along x is tried between any two
SHORTEST = 2.0**-10  # piece of an interval beyond which no sign is looked for


def value_along(value: Expression, x: arb, line: Line) -> arb | None:
    """Return what varies along x on a ball of x, None if a parameter has no value."""
    enclosures = {**line.enclosures, COORDINATE: x}
    for name, expression in line.definitions.items():
        if name not in enclosures and (number := _enclosed(expression, enclosures)) is not None:
            enclosures[name] = number
    return _enclosed(value, enclosures)


def _enclosed(expression: Expression, values: Mapping[str, arb]) -> arb | None:
    """Return an enclosure of an expression, None if a name has no value."""
    try:
        enclosure: arb = fold(
            lower(expression),
            number=ball,
            name=values.__getitem__,
            power=lambda base, exponent: base ** (integer_exponent(exponent) or 0),
            call=lambda call, argument: FUNCTIONS[call.name].evaluate(argument),
        )
    except (KeyError, TypeError):
        return None  # a parameter without value, or a quantity that is no number
    return enclosure


def _slope_along(value: Expression, x: arb, line: Line) -> arb | None:
    """Return the slope of what varies along x on a ball of x, None if it is not known."""
    beside = arb_series([x, 1], 2)
    # Series have the arithmetic of balls.
    series = cast("arb_series | arb | None", value_along(value, cast("arb", beside), line))
    return series[1] if isinstance(series, arb_series) else None


def _sign_along(value: Expression, length: Expression, line: Line) -> int | None:
    """Return the sign that a value is proved to have along a member but at its ends; else None."""
    match value:
        case Negative(operand):
            sign = _sign_along(operand, length, line)
            return None if sign is None else -sign
        case Product() | Quotient():
            signs = [_sign_along(each, length, line) for each in value.children]
            return None if None in signs else prod(sign for sign in signs if sign is not None)
        case Power(base, exponent):
            count = integer_exponent(exponent)
            sign = None if count is None else _sign_along(base, length, line)
            return sign if sign is None or (count or 0) % 2 else 1
        case Name(name) if name in line.definitions:
            return _sign_along(line.definitions[name], length, line)
    places = Number(Fraction(0)), lower(length)
    first, last = (line.value(substitute(value, {COORDINATE: position})) == 0 for position in places)
    return sign_between(
        (arb(0), ball(line.value(length) or Fraction(0))),
        lambda x: value_along(value, x, line),
        lambda x: _slope_along(value, x, line),
        (first, last),
    )


def sign_between(
    ends: tuple[arb, arb],
    value: Callable[[arb], arb | None],
    slope: Callable[[arb], arb | None],
    is_zero: tuple[bool, bool],
) -> int | None:
    """Return the sign of a function along an interval, but at ends where it ``is_zero``; else ``None``.

    >>> sign_between((arb(0), arb(1)), lambda x: x * (1 - x), lambda x: 1 - 2 * x, (True, True))
    1
    >>> sign_between((arb(0), arb(1)), lambda x: x - 1, lambda x: arb(1), (False, True))
    -1
    """
    low, high = ends

    def sign_on(a: float, b: float) -> int | None:
        x = low + (high - low) * arb((a + b) / 2, (b - a) / 2)
        sign = sign_of(value(x))
        starts, stops = is_zero[0] and a == 0, is_zero[1] and b == 1
        if sign is None and starts != stops:
            # Next to an end where it is zero the slope tells the sign.
            rate = sign_of(slope(x))
            sign = None if rate is None else rate if starts else -rate
        return sign

    try:
        signs = {sign for _, _, sign in covered(sign_on, 1, SHORTEST)}
    except UndecidedError:
        return None
    return signs.pop() if len(signs) == 1 else None


def sign_of(number: arb | None) -> int | None:
    """Return the sign of all numbers of a ball, ``None`` if they have none in common.

    >>> sign_of(arb(-3)), sign_of(arb(0, 1)), sign_of(arb("nan"))
    (-1, None, None)
    """
    return None if number is None else 1 if number > 0 else -1 if number < 0 else None


def line_of(model: Model, values: Iterable[tuple[str, ExactValue]]) -> Line:
    """Return the line of a model's numbers: the values given, its own for what cancelled from a function."""
    numbers = {**{p.name: p.value for p in model.parameters}, **dict(values)}
    # What cancels in a function may have no value, but has the sign that is assumed of it.
    free = frozenset(p.name for p in model.parameters if numbers[p.name] is None and p.assume == "positive")
    return Line.of_numbers(model.definitions, numbers.items(), free)


def follows_inputs(use: PlacedElement, line: Line, inputs: Collection[str]) -> bool:
    """Tell whether a source follows inputs alone: it is a support or a free node where these rest."""
    # It may follow derivatives, as inertia does a support's acceleration, but no filter with poles of its
    # own.
    allowed = {"pi", LAPLACE, *inputs, *line.values}
    return all(
        (used := line.opened_names(value)) <= allowed
        and (LAPLACE not in used or line.is_polynomial_in(value, LAPLACE))
        for _, value in use.values
    )


def parameter_signs(use: PlacedElement, line: Line) -> dict[str, int | None]:
    """Return the signs of an element's parameters, all along a member, ``None`` if one is undecided."""
    element, given = use.element, dict(use.values)
    signs = {name: line.sign(value) for name, value in given.items()}
    if isinstance(element, LineElement) and None in signs.values():
        length = given[element.length]
        along = {p.name for p in element.parameters if p.varies}
        for name in (n for n, sign in signs.items() if sign is None and n in along and line.value(length)):
            signs[name] = _sign_along(given[name], length, line)
    if isinstance(element, LineElement):
        signs |= _signs_of_typed_losses(use, signs, line)
    for port in element.parameters:
        for factor in port.of if port.name in signs else ():
            signs.setdefault(factor, signs[port.name])
    return signs


def _signs_of_typed_losses(
    use: PlacedElement, signs: Mapping[str, int | None], line: Line
) -> dict[str, int | None]:
    """Return the signs of values that bear s, as in ``k_f + c_f*s``, and of the losses that they add to."""
    given, found = dict(use.values), dict[str, int | None]()
    for name, loss in LOSSES.items():
        typed = line.signs_by_power(given[name], LAPLACE) if name in given and signs[name] is None else {}
        if typed.keys() | {0} != {0, 1}:
            continue
        elastic, lossy, beside = typed.get(0, 0), typed[1], found.get(loss, signs.get(loss))
        if elastic in (0, 1) and lossy in (0, 1) and beside in (0, 1):
            found |= {name: elastic, loss: max(lossy, beside)}
    if dict(use.choices).get("theory") == "timoshenko" and not all(
        found.keys() & n for n in (BENDING, SHEAR)
    ):
        found.pop("eta", None)  # which stands for losses of bending and of shear
    return found
