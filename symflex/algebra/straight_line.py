"""Straight-line programs: values built up step by step, every step from earlier ones, equal steps once.

Input: generators, numbers, and what is done with them.
Output: a :class:`StraightLine`, flat lists of steps whose length is what a long expression with shared parts
really needs.

    (m*s^2 + k)^2 / (m*s^2 + k + b*s)

    2: s   3: m   4: 2^2   5: 3 * 4   6: k   7: 5 + 6   8: 7^2   9: b   10: 9 * 2   11: 7 + 10   12: 8 / 11

After a colon a number is a step, but for exponents. The sum m*s^2 + k stands once, as step 7, though it is
used twice; steps 0 and 1 are the numbers zero and one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction
from functools import reduce
from operator import neg, truediv
from random import Random
from typing import Any

from flint import fmpz_mpoly

from symflex.algebra.factored import PRIME, Factored
from symflex.algebra.ring import PolynomialMemo, terms_of

Key = tuple[int, ...]


Operation = tuple[int, int, Key, Key]  # kind, step, operands, and the steps that nothing needs afterwards


class Step(IntEnum):
    """What a step does with its operands."""

    GENERATOR = 0
    NUMBER = 1
    ADD = 2
    MULTIPLY = 3
    DIVIDE = 4
    NEGATE = 5
    POWER = 6


_GENERATOR, _NUMBER, _ADD, _MULTIPLY, _DIVIDE, _NEGATE, _POWER = map(int, Step)

ZERO, ONE = 0, 1  # the first two steps of every program are these numbers


def _pair_key(kind: int, x: int, y: int) -> int:
    """Return what tells a sum or product of two steps from all others, smaller than a tuple."""
    return (x << 32 | y) << 3 | kind if x < y else (y << 32 | x) << 3 | kind


@dataclass(frozen=True, eq=False)
class StraightLine:
    """Steps in order, each made of earlier ones."""

    names: tuple[str, ...]  # the generators' names
    kinds: Sequence[int]  # per step, a :class:`Step`
    # Per step: position of the generator; numerator and denominator of a non-negative number; the steps that
    # are added or multiplied; dividend and divisor; what is negated; base and exponent.
    operands: Sequence[Key]
    # Steps a reader knows by a name: ``w`` for a sub-impedance that elements in parallel add up to, ``Z`` for
    # the impedance of all that is joined to a node, and the names of the model's definitions with an equals
    # sign before them.
    roles: Mapping[int, str]

    def steps_of(self, *roots: int) -> list[int]:
        """Return the steps that some values are made of, in order; numbers and generators among them."""
        steps = set(roots)
        pending = list(roots)
        while pending:
            for operand in self.inner(pending.pop()):
                if operand not in steps:
                    steps.add(operand)
                    pending.append(operand)
        return sorted(steps)

    def operations(self, steps: Iterable[int]) -> list[Operation]:
        """Return steps as :meth:`values` takes them."""
        return [(self.kinds[i], i, self.operands[i], ()) for i in steps]

    def values(
        self,
        operations: Iterable[Operation],
        *,
        name: Callable[[int], Any],
        number: Callable[[Fraction], Any],
        negative: Callable[[Any], Any] = neg,
        total: Callable[[list[Any]], Any] | None = None,
        product: Callable[[list[Any]], Any] | None = None,
        quotient: Callable[[Any, Any], Any] = truediv,
        power: Callable[[Any, int], Any] = pow,
        known: dict[int, Any] | None = None,
    ) -> dict[int, Any]:
        """Return values of steps in some arithmetic, ``name`` giving generators', ``known`` first ones."""
        values = {} if known is None else known
        for kind, i, args, gone in operations:
            if kind == _MULTIPLY and product is None:
                value = values[args[0]]
                for x in args[1:]:
                    value = value * values[x]
            elif kind == _ADD and total is None:
                value = values[args[0]]
                for x in args[1:]:
                    value = value + values[x]
            elif kind in (_ADD, _MULTIPLY):
                gather = total if kind == _ADD else product
                value = gather([values[x] for x in args]) if gather is not None else None
            elif kind == _DIVIDE:
                value = quotient(values[args[0]], values[args[1]])
            elif kind == _GENERATOR:
                value = name(args[0])
            elif kind == _NEGATE:
                value = negative(values[args[0]])
            elif kind == _POWER:
                value = power(values[args[0]], args[1])
            else:
                value = number(Fraction(*args))
            values[i] = value
            for x in gone:
                del values[x]
        return values

    def inner(self, step: int) -> Key:
        """Return the earlier steps a step is made of."""
        kind = self.kinds[step]
        if kind <= _NUMBER:
            return ()
        operands = self.operands[step]
        return operands[:1] if kind == _POWER else operands

    def fraction(self, step: int) -> Fraction:
        """Return the value of a number."""
        above, below = self.operands[step]
        return Fraction(above, below)

    def size(self, *roots: int) -> int:
        """Return how many operations some values take, each shared one counted once."""
        kinds = self.kinds
        return sum(
            1 if kinds[i] in (_DIVIDE, _NEGATE, _POWER) else len(self.operands[i]) - 1
            for i in self.steps_of(*roots)
            if kinds[i] > _NUMBER
        )


class Workbench:
    """Makes steps; equal ones get the same number, and what is zero is seen to be.

    What is made without a minus sign is not zero as a function. A sum with one is not where its value at a
    random point of a prime field is not zero; where that is zero it is taken for zero (for a function of
    degree d the odds of being wrong are d in 2^61).

    >>> bench = Workbench(("s", "k"))
    >>> s, k = bench.generator(0), bench.generator(1)
    >>> bench.add([bench.multiply(s, k), bench.negate(bench.multiply(k, s))]) == ZERO
    True
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        random = Random(20)
        self.point = [random.getrandbits(60) + 1 for _ in names]
        self.kinds: list[int] = [_NUMBER, _NUMBER]
        self.operands: list[Key] = [(0, 1), (1, 1)]
        self.roles: dict[int, str] = {}
        self.polynomial = PolynomialMemo(self._polynomial)
        self._known: dict[Key | int, int] = {(_NUMBER, 0, 1): 0, (_NUMBER, 1, 1): 1}
        self._residues: dict[int, int] = {}
        # Steps with a minus sign somewhere inside.
        self._mixed: set[int] = set()
        self._defined: dict[int, int] = {}

    def finished(self) -> StraightLine:
        """Return the program."""
        return StraightLine(self.names, self.kinds, self.operands, self.roles)

    def _make(self, kind: int, operands: Key, key: Key | int) -> int:
        step = len(self.kinds)
        self.kinds.append(kind)
        self.operands.append(operands)
        self._known[key] = step
        if self._mixed and not self._mixed.isdisjoint(operands):
            self._mixed.add(step)
        return step

    def residue(self, step: int) -> int:
        """Return the value of a step at the random point; only few are ever asked for."""
        known, program = self._residues, self.finished()
        if step in known:
            return known[step]
        wanted, pending = {step}, [step]
        while pending:
            new = [x for x in program.inner(pending.pop()) if x not in known and x not in wanted]
            wanted.update(new)
            pending += new
        program.values(
            program.operations(sorted(wanted)),
            name=self.point.__getitem__,
            number=lambda x: x.numerator * pow(x.denominator, -1, PRIME) % PRIME,
            negative=lambda x: -x % PRIME,
            total=lambda terms: sum(terms) % PRIME,
            product=lambda factors: reduce(lambda x, y: x * y % PRIME, factors),
            quotient=lambda x, y: x * pow(y, -1, PRIME) % PRIME,
            power=lambda x, n: pow(x, n, PRIME),
            known=known,
        )
        return known[step]

    def generator(self, position: int) -> int:
        """Return a generator, or what the definition of that name stands for."""
        defined = self._defined.get(position)
        if defined is not None:
            return defined
        key = (_GENERATOR, position)
        step = self._known.get(key)
        return self._make(_GENERATOR, (position,), key) if step is None else step

    def define(self, position: int, value: int) -> None:
        """Let a generator stand for a value, under its own name."""
        self._defined[position] = value
        if self.kinds[value] > _NUMBER:
            self.roles.setdefault(value, f"={self.names[position]}")

    def number(self, value: Fraction | int) -> int:
        """Return a rational number."""
        exact = Fraction(value)
        key = (_NUMBER, abs(exact.numerator), exact.denominator)
        step = self._known.get(key)
        if step is None:
            step = self._make(_NUMBER, key[1:], key)
        return self.negate(step) if exact < 0 else step

    def negate(self, x: int) -> int:
        """Return minus ``x``."""
        if x == ZERO:
            return ZERO
        if self.kinds[x] == _NEGATE:
            return self.operands[x][0]
        key = (_NEGATE, x)
        known = self._known.get(key)
        return self._make(_NEGATE, (x,), key) if known is None else known

    def add(self, terms: Sequence[int]) -> int:
        """Return a sum; equal terms are counted, and opposite ones cancel."""
        count = len(terms)
        if count == 1:
            return terms[0]
        if count == 2:  # noqa: PLR2004
            x, y = terms
            if x > 0 < y != x and self.kinds[x] != _NEGATE != self.kinds[y]:
                return self._pair(x, y)
        kept = tuple(t for t in terms if t)
        if len(set(kept)) < len(kept):
            kept = self._counted(kept)
        if len(kept) <= 1:
            return kept[0] if kept else ZERO
        key = _pair_key(_ADD, *kept) if len(kept) == 2 else (_ADD, *sorted(kept))  # noqa: PLR2004
        known = self._known.get(key)
        if known is not None:
            return known
        kinds = self.kinds
        is_signed = any([kinds[t] == _NEGATE for t in kept])
        if (is_signed or not self._mixed.isdisjoint(kept)) and self._vanishes(kept):
            return ZERO
        return self._signed_sum(kept, key) if is_signed else self._make(_ADD, kept, key)

    def _vanishes(self, terms: Key) -> bool:
        return sum([self.residue(t) for t in terms]) % PRIME == 0

    def _pair(self, x: int, y: int) -> int:
        """Return the sum of two different steps without sign: most sums are of this kind."""
        key = _pair_key(_ADD, x, y)
        known = self._known.get(key)
        if known is not None:
            return known
        terms = (x, y)
        if not self._mixed.isdisjoint(terms) and self._vanishes(terms):
            return ZERO
        return self._make(_ADD, terms, key)

    def _counted(self, terms: Key) -> Key:
        counts: dict[int, int] = {}
        for term in terms:
            counts[term] = counts.get(term, 0) + 1
        return tuple(t if n == 1 else self.multiply(self.number(n), t) for t, n in counts.items())

    def _signed_sum(self, terms: Key, key: Key | int) -> int:
        opposite = {self.operands[t][0] for t in terms if self.kinds[t] == _NEGATE}.intersection(terms)
        if opposite:
            gone = opposite | {self.negate(t) for t in opposite}
            return self.add([t for t in terms if t not in gone])
        if all(self.kinds[t] == _NEGATE for t in terms):
            return self.negate(self.add([self.operands[t][0] for t in terms]))
        step = self._make(_ADD, terms, key)
        self._mixed.add(step)
        return step

    def multiply(self, x: int, y: int) -> int:
        """Return a product."""
        if x < 2 or y < 2:  # noqa: PLR2004
            return ZERO if not x or not y else y if x == ONE else x
        kinds = self.kinds
        a, b = kinds[x], kinds[y]
        if _NEGATE in (a, b):
            inner_x = self.operands[x][0] if a == _NEGATE else x
            inner_y = self.operands[y][0] if b == _NEGATE else y
            product = self.multiply(inner_x, inner_y)
            return product if a == b else self.negate(product)
        if a == b == _NUMBER:
            return self.number(self.fraction(x) * self.fraction(y))
        if a == _DIVIDE and self.operands[x][1] == y:
            return self.operands[x][0]
        if b == _DIVIDE and self.operands[y][1] == x:
            return self.operands[y][0]
        key = _pair_key(_MULTIPLY, x, y)
        known = self._known.get(key)
        return self._make(_MULTIPLY, (x, y), key) if known is None else known

    def product(self, factors: Sequence[int]) -> int:
        """Return a product of positive factors as one step."""
        kept = tuple(f for f in factors if f != ONE)
        if len(kept) <= 1:
            return kept[0] if kept else ONE
        key = _pair_key(_MULTIPLY, *kept) if len(kept) == 2 else (_MULTIPLY, *sorted(kept))  # noqa: PLR2004
        known = self._known.get(key)
        return self._make(_MULTIPLY, kept, key) if known is None else known

    def divide(self, x: int, y: int) -> int:
        """Return a quotient; ZeroDivisionError when the divisor is zero."""
        if x == ZERO or y == ONE:
            return x
        if x == y:
            return ONE
        kinds = self.kinds
        a, b = kinds[x], kinds[y]
        if _NEGATE in (a, b):
            inner_x = self.operands[x][0] if a == _NEGATE else x
            inner_y = self.operands[y][0] if b == _NEGATE else y
            quotient = self.divide(inner_x, inner_y)
            return quotient if a == b else self.negate(quotient)
        if b == _NUMBER:
            if y == ZERO:
                raise ZeroDivisionError("division by zero")
            return self.multiply(self.number(1 / self.fraction(y)), x)
        key = (x << 32 | y) << 3 | _DIVIDE
        known = self._known.get(key)
        return self._make(_DIVIDE, (x, y), key) if known is None else known

    def power(self, x: int, exponent: int) -> int:
        """Return a non-negative integer power of a positive step."""
        if exponent == 1 or x < 2:  # noqa: PLR2004
            return x
        if exponent == 0:
            return ONE
        if self.kinds[x] == _NUMBER:
            return self.number(self.fraction(x) ** exponent)
        if self.kinds[x] == _NEGATE:
            raised = self.power(self.operands[x][0], exponent)
            return self.negate(raised) if exponent % 2 else raised
        key = (_POWER, x, exponent)
        known = self._known.get(key)
        return self._make(_POWER, (x, exponent), key) if known is None else known

    def fraction(self, x: int) -> Fraction:
        """Return the value of a number."""
        above, below = self.operands[x]
        return Fraction(above, below)

    def _polynomial(self, polynomial: fmpz_mpoly) -> int:
        """Return a polynomial of the generators."""
        terms: list[int] = []
        for monomial, coefficient in terms_of(polynomial):
            if coefficient == 1 and len(monomial) == 1 and monomial[0][1] == 1:
                terms.append(self.generator(monomial[0][0]))
                continue
            step = self._monomial(monomial)
            if abs(coefficient) != 1:
                step = self.multiply(self.number(abs(coefficient)), step)
            terms.append(self.negate(step) if coefficient < 0 else step)
        value = self.add(terms)
        if len(terms) > 1:
            self.roles.setdefault(value, "w")
        return value

    def _monomial(self, monomial: Iterable[tuple[int, int]]) -> int:
        factors: list[int] = []
        is_plain = True
        for i, exponent in monomial:
            factor = self.power(self.generator(i), exponent)
            is_plain = is_plain and self.kinds[factor] not in (_NUMBER, _NEGATE)
            factors.append(factor)
        if is_plain:
            return self.product(factors)
        result = ONE
        for factor in factors:
            result = self.multiply(result, factor)
        return result

    def factored(self, value: Factored, sign: int = 1) -> int:
        """Return a rational function that is kept as a product; minus it with ``sign`` -1."""
        factors = value.factors
        above, below = ONE, ONE
        if len(factors) == 1 and factors[0][1] == 1:
            above = self.polynomial(factors[0][0])
        else:
            for factor, exponent in factors:
                step = self.polynomial(factor)
                if exponent > 0:
                    above = self.multiply(above, step if exponent == 1 else self.power(step, exponent))
                else:
                    below = self.multiply(below, step if exponent == -1 else self.power(step, -exponent))
        numerator, denominator = sign * value.unit.numerator, value.unit.denominator
        if denominator != 1 or numerator not in (1, -1):
            role = self.roles.get(above)
            above = self.multiply(self.number(Fraction(numerator, denominator)), above)
            if role == "w":
                self.roles.setdefault(above, role)
        elif numerator < 0:
            above = self.negate(above)
        return above if below == ONE else self.divide(above, below)
