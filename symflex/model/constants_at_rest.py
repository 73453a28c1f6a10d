"""Values and signs of what is constant at equilibrium: expressions of parameters, and what follows from them.

Input: the expressions of definitions, the numbers of parameters. Output: the value of an expression in balls,
with random numbers for names that have none, whether it is zero whatever the names are, and its sign.

    sqrt(b^2) - b    is zero for positive b; one of sixteen random b finds that it is not for others
    x_0 - 2          has the sign -1 with x_0 = 1; x_0 + 2 has 1 for every positive x_0
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING

from flint import arb, arb_mat

from symflex.balls import ball, precision
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    fold,
    is_number,
    nodes,
    number,
)
from symflex.model.units import exact_expression, lower

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

    from symflex.model.declarations import DeclaredParameter
    from symflex.model.model import ModelParameter

    Signs = tuple[int, int]  # the least and the largest sign that a value may have: (0, 1) is not negative

TRIALS = 200  # random points, of which so many are to be in the domain of all functions
AGREEING = 16  # or a root whose sign depends on one sum in four would pass for one that has a sign
SCALES = (-40, 40), (0, 1e-6)  # doublings of declared values: anywhere, and near them
BITS = 256
ANY: Signs = (-1, 1)
POSITIVE: Signs = (1, 1)


def is_zero(value: arb) -> bool:
    """Tell whether a value may be zero, which a random one is only if all are."""
    return value.contains(0)


def is_positive(value: arb) -> bool:
    """Tell whether a value has a square root."""
    return not value < 0


@dataclass
class Constants:
    """What is constant: ``expressions`` of names, None for parameters, and ``known``, the values of some."""

    expressions: dict[str, Expression | None]
    known: dict[str, arb] = field(default_factory=dict)
    signed: set[str] = field(default_factory=set)  # parameters that may be negative
    declared: dict[str, ModelParameter] = field(default_factory=dict)

    def declare(self, parameters: Iterable[DeclaredParameter], converted: Collection[str]) -> None:
        """Take parameters with their values, in radians those that are converted from cycles."""
        for p in parameters:
            parameter = self.declared[p.name] = p.resolve(is_converted=p.name in converted)
            self.expressions.setdefault(p.name)
            if p.assume != "positive":
                self.signed.add(p.name)
            if parameter.value is not None:
                with precision(BITS):
                    self.known[p.name] = self.value(exact_expression(parameter.value), {}, None)

    def value(self, expression: Expression, known: dict[str, arb], random: Random | None) -> arb:
        """Return an expression's value, where names without one have random ones; else KeyError."""

        def named(name: str) -> arb:
            if name not in known:
                defined = self.expressions.get(name) if random else self.expressions[name]
                if defined is None and random is None:
                    raise KeyError(name)
                sign = 1 if random is None or name not in self.signed else random.choice((-1, 1))
                known[name] = (
                    sign * arb(random.randrange(1, 1 << 20)) / (1 << random.randrange(16, 26))
                    if defined is None and random
                    else self.value(lower(defined or number(0)), known, random)
                )
            return known[name]

        def called(call: Call, inner: arb) -> arb:
            return abs(inner) if call.name == "abs" else getattr(inner, call.name.replace("sign", "sgn"))()

        return fold(
            expression,
            number=ball,
            name=lambda name: arb.pi() if name == "pi" else named(name),
            power=lambda base, exponent: base ** self.value(exponent, known, random),
            call=called,
        )

    def here(self, expression: Expression) -> arb | None:
        """Return the value that an expression has with the values of parameters; None without all of them."""
        with precision(BITS):
            try:
                return self.value(expression, dict(self.known), None)
            except KeyError:
                return None

    def vanishes(self, residual: Expression, fixed: Mapping[str, arb] | None = None) -> bool:
        """Tell whether an expression is zero for all values but those fixed, or with probability 0 is not."""
        if is_number(residual, 0):
            return True
        return self._always(is_zero, residual, lambda _: dict(fixed or {}))

    def deciding(self, holds: Callable[[arb], bool], expression: Expression) -> set[str] | None:
        """Return the parameters whose values decide that something holds of an expression.

        None if it does not near the declared values either: a root of a sum may have one sign only there.
        """
        names = self.behind(expression) & self.known.keys()

        def scaled(kept: Collection[str]) -> Callable[[Random], dict[str, arb]]:
            def draw(random: Random) -> dict[str, arb]:
                return {p: self.known[p] * arb(2) ** random.uniform(*SCALES[p in kept]) for p in names}

            return draw

        if not self._always(holds, expression, scaled(names)):
            return None
        deciding = {p for p in names if not self._always(holds, expression, scaled(names - {p}))}
        return deciding if self._always(holds, expression, scaled(deciding)) else names

    def _always(
        self,
        holds: Callable[[arb], bool],
        expression: Expression,
        values: Callable[[Random], dict[str, arb]],
    ) -> bool:
        """Tell whether something holds wherever an expression has a value."""
        random, agreeing = Random(1), 0
        for _ in range(TRIALS):
            with precision(BITS):
                value = self.value(expression, values(random), random)
                if value.is_finite() and not holds(value):
                    return False
                agreeing += bool(value.is_finite())
            if agreeing == AGREEING:
                return True
        return False

    def are_dependent(self, rows: Sequence[Sequence[Expression]]) -> bool:
        """Tell whether rows are dependent, with the values of parameters or, without them, with any."""
        random, entries = Random(1), [e for row in rows for e in row]
        numbers = [self.here(e) for e in entries]
        points = [[x for x in numbers if x is not None]]
        if len(points[0]) < len(numbers):
            points = []
            for _ in range(AGREEING):
                known = dict[str, arb]()
                with precision(BITS):
                    points.append([self.value(e, known, random) for e in entries])
        with precision(BITS):
            matrices = [arb_mat(len(rows), len(rows[0]), values) for values in points]
            return all((m * m.transpose()).det().contains(0) for m in matrices)

    def sign(self, expression: Expression) -> int | None:
        """Return the sign of an expression if its parts show it, whatever the values of parameters are."""
        low, high = self._signs(expression)
        return low if low == high else None

    def _signs(self, expression: Expression) -> Signs:
        match expression:
            case Number(value):
                return POSITIVE if value else (0, 0)
            case Name(name):
                defined = self.expressions.get(name)
                if defined is not None:
                    return self._signs(lower(defined))
                return ANY if name in self.signed else POSITIVE
            case Negative(operand):
                low, high = self._signs(operand)
                return -high, -low
            case Sum(terms):
                lows, highs = zip(*map(self._signs, terms), strict=True)
                return (max(lows) if min(lows) >= 0 else -1), (min(highs) if max(highs) <= 0 else 1)
            case Product() | Quotient():
                return self._of_product(expression.children)
            case Power(base, Number(n) | Negative(Number(n))) if n.denominator == 1:
                low, high = self._signs(base)
                return (low, high) if n % 2 else (0 if low < 1 and high > -1 else 1, 1)
            case Power(base, _) if self._signs(base) == POSITIVE:
                return POSITIVE
            case Call("exp" | "cosh"):
                return POSITIVE
            case Call("sqrt" | "abs" as function, inner):
                low, high = self._signs(inner)
                return (1 if low > 0 or (function == "abs" and high < 0) else 0), 1
            case Call("sinh" | "tanh" | "atan" | "sgn" | "sign", inner):
                return self._signs(inner)
        return ANY

    def _of_product(self, factors: Iterable[Expression]) -> Signs:
        signs = POSITIVE
        for low, high in map(self._signs, factors):
            ends = [one * other for one in signs for other in (low, high)]
            signs = min(ends), max(ends)
        return signs

    def behind(self, expression: Expression) -> set[str]:
        """Return the names in an expression, and in the expressions of these."""
        found, unread = set[str](), [expression]
        while unread:
            new = {n.name for e in unread for n in nodes(e) if isinstance(n, Name)} - found
            found |= new
            unread = [e for n in new if (e := self.expressions.get(n)) is not None]
        return found
