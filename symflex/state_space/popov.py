"""Equations that are polynomial in s, solved for the highest derivatives that stand in them.

Input: rows ``A(s) x + B(s) u = 0``. Output: :class:`SolvedRows`, the same in Popov form: per unknown, the
lowest of its derivatives that is a combination of lower ones and of inputs. What is lower still is a state.

The form is that of Popov (1972, SIAM J. Control 10, 252), with weights on the unknowns as in Beckermann,
Labahn and Villard (2006, J. Symb. Comp. 41, 708): which derivatives count as higher decides what the states
are. It is found as the Groebner basis of the rows' module over the polynomials in s.

Example: a mass on a spring k to a massless plate that follows u, weights as they come.

    before    m s^2 x + k x - k y = 0,   y - u = 0
    after     s^2 x = (k/m) (u - x),     y = u

Of x the lowest derivative that follows from lower ones is the second, so x and s x are states; of y it is y
itself, which has none.

The field in which the rows are solved is that of quotients of polynomials free of s, :class:`FieldElement`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from flint import fmpz_mpoly

from symflex.algebra import Radicals, Ring
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic

Key = tuple[int, int]  # a column and a power of s. Unknowns come first, then inputs.

Position = TypeVar("Position", Key, int)

Row = dict[Key, "FieldElement"]  # a sum of ``coefficient * s^power * column``, without coefficients 0

DERIVATIVE = 4  # what a derivative adds to the weight of an unknown
SIZE_LIMIT = 100_000  # terms that the coefficients of one row may contain together


@dataclass(frozen=True, eq=False)
class SolvedRows:
    """Equations solved for the derivatives that are not states."""

    orders: tuple[int, ...]  # per unknown, how many of its derivatives, itself first, are states
    # Per unknown, what its derivative of that order equals: states, and powers of s times inputs.
    tails: Sequence[Row]
    _known: dict[Key, Row] = field(default_factory=dict, repr=False)

    @property
    def states(self) -> tuple[Key, ...]:
        """The derivatives that are states: all unknowns that are, then all first derivatives, and so on."""
        keys = [(j, i) for j, order in enumerate(self.orders) for i in range(order)]
        return tuple(sorted(keys, key=lambda key: (key[1], key[0])))

    def is_final(self, key: Key) -> bool:
        """Tell whether a key is a state or a derivative of an input."""
        column, power = key
        return column >= len(self.orders) or power < self.orders[column]

    def reduced(self, row: Row) -> Row:
        """Return states and inputs alone, equal to the given row by the equations."""
        result: Row = {}
        for key, value in row.items():
            if self.is_final(key):
                add_term(result, key, value)
            else:
                add(result, self._equal(key), value)
        return result

    def _equal(self, key: Key) -> Row:
        """Return what a derivative that is not a state equals."""
        column, power = key
        self._known.setdefault((column, self.orders[column]), self.tails[column])
        start = power
        while (column, start) not in self._known:
            start -= 1
        for i in range(start, power):
            raised: Row = {}
            for (other, below), value in self._known[column, i].items():
                above = (other, below + 1)
                if self.is_final(above):
                    add_term(raised, above, value)
                else:
                    add(raised, self.tails[other], value)
            self._known[column, i + 1] = raised
        return self._known[key]


def solve(rows: Sequence[Row], weights: Sequence[tuple[int, int]]) -> SolvedRows | None:
    """Return the Popov form of as many rows as unknowns, ``None`` when they do not determine these.

    Each row is a sum that is zero. ``weights`` are per unknown its weight, to which a derivative adds 4, and
    its rank among equal weights; ranks differ. What weighs most in a row is solved for. SF502 when
    coefficients become too large.

    >>> from symflex.algebra import Ring
    >>> from symflex.state_space.popov import FieldElement
    >>> ring = Ring(("s",))
    >>> one, two = (FieldElement.number(ring, n) for n in (1, 2))
    >>> mass = {(0, 2): two, (1, 0): -one, (2, 0): -one}  # 2 s^2 x - y - u = 0
    >>> held = {(0, 0): one, (1, 0): -one}  # x = y
    >>> solve([mass, held], [(0, 0), (0, 1)]).orders
    (2, 0)
    """
    count = len(weights)

    def order(key: Key) -> tuple[int, int]:
        weight, rank = weights[key[0]]
        return DERIVATIVE * key[1] + weight, rank

    def leading(row: Row) -> Key | None:
        return max((key for key in row if key[0] < count), key=order, default=None)

    basis: dict[int, tuple[int, Row]] = {}
    waiting = [dict(row) for row in rows]
    waiting.sort(key=lambda row: ((-1, -1) if (top := leading(row)) is None else order(top), len(row)))
    waiting.reverse()
    while waiting:
        row = waiting.pop()
        while (top := leading(row)) is not None:
            spend()
            column, power = top
            if column not in basis:
                basis[column] = (power, _monic(row, top))
                break
            below, known = basis[column]
            if power < below:
                basis[column] = (power, _monic(row, top))
                waiting.append(known)
                break
            add(row, {(c, i + power - below): v for (c, i), v in known.items()}, -row[top])
            _check(row)
        else:
            return None
    tails: list[Row] = [{} for _ in range(count)]
    solved = SolvedRows(tuple(basis[j][0] for j in range(count)), tails)
    # What stands in a tail is lower in order than what it equals, so its own tails are known by then.
    for column in sorted(range(count), key=lambda j: order((j, basis[j][0]))):
        power, row = basis[column]
        tails[column] = solved.reduced({key: -value for key, value in row.items() if key != (column, power)})
        _check(tails[column])
    return solved


def _monic(row: Row, top: Key) -> Row:
    lead = row[top]
    return row if lead.is_one else {key: value / lead for key, value in row.items()}


def _check(row: Row) -> None:
    if sum(value.size for value in row.values()) > SIZE_LIMIT:
        message = f"state equations whose coefficients would exceed {SIZE_LIMIT} terms"
        raise BudgetError(
            Diagnostic("SF502", message, None, "give the parameters numbers first, with bind()")
        )


def add(target: Row, source: Row, factor: FieldElement) -> None:
    """Add ``factor*source`` to a row in place."""
    for key, value in source.items():
        add_term(target, key, value * factor)


def add_term(target: dict[Position, FieldElement], key: Position, value: FieldElement) -> None:
    """Add one term to a row, or to an entry of a vector, in place."""
    total = target[key] + value if key in target else value
    if total.is_zero:
        target.pop(key, None)
    else:
        target[key] = total


@dataclass(frozen=True, slots=True, eq=False)
class FieldElement:
    """A quotient of integer polynomials in lowest terms.

    >>> from symflex.algebra import Ring
    >>> ring = Ring(("s", "k", "m"))
    >>> k, m = (FieldElement.of(ring.generator(n), ring.constant(1)) for n in "km")
    >>> print(k / m + k / m)
    (2*k)/(m)
    >>> (k / m - k / m).is_zero
    True
    """

    # num and den: Coprime; the denominator's leading coefficient is positive.
    num: fmpz_mpoly
    den: fmpz_mpoly
    # Relations of roots that may stand in both; none stands in the denominator.
    radicals: Radicals | None = None

    @staticmethod
    def of(num: fmpz_mpoly, den: fmpz_mpoly, radicals: Radicals | None = None) -> FieldElement:
        """Return a quotient in lowest terms; ZeroDivisionError when the denominator is zero."""
        if den.is_zero():
            raise ZeroDivisionError("division by zero")
        if radicals:
            num, den = radicals.fraction(num, den)
        common = num.gcd(den)
        if not common.is_one():
            num, den = num / common, den / common
        if int(den.leading_coefficient()) < 0:
            num, den = -num, -den
        return FieldElement(num, den, radicals)

    @staticmethod
    def number(ring: Ring, value: int) -> FieldElement:
        """Return an integer."""
        return FieldElement(ring.constant(value), ring.constant(1))

    @property
    def is_zero(self) -> bool:
        """True for zero."""
        return bool(self.num.is_zero())

    @property
    def is_one(self) -> bool:
        """True for one."""
        return bool(self.num.is_one() and self.den.is_one())

    @property
    def size(self) -> int:
        """Number of terms."""
        return len(self.num) + len(self.den)

    def __add__(self, other: FieldElement) -> FieldElement:
        if self.is_zero:
            return other
        if other.is_zero:
            return self
        if self.den == other.den:
            return FieldElement.of(self.num + other.num, self.den, self.radicals or other.radicals)
        num = self.num * other.den + other.num * self.den
        return FieldElement.of(num, self.den * other.den, self.radicals or other.radicals)

    def __neg__(self) -> FieldElement:
        return FieldElement(-self.num, self.den, self.radicals)

    def __sub__(self, other: FieldElement) -> FieldElement:
        return self + (-other)

    def __mul__(self, other: FieldElement) -> FieldElement:
        if self.is_one or other.is_zero:
            return other
        if other.is_one or self.is_zero:
            return self
        return FieldElement.of(self.num * other.num, self.den * other.den, self.radicals or other.radicals)

    def __truediv__(self, other: FieldElement) -> FieldElement:
        if other.is_one:
            return self
        return FieldElement.of(self.num * other.den, self.den * other.num, self.radicals or other.radicals)

    def __str__(self) -> str:
        return f"({self.num})/({self.den})"


Vector = dict[int, FieldElement]  # entries other than zero, by position


def combined(left: Vector, right: Vector, factor: FieldElement | None = None) -> Vector:
    """Return ``left + factor*right``, or ``left + right``, without entries that are zero."""
    result = dict(left)
    for position, value in right.items():
        add_term(result, position, value if factor is None else value * factor)
    return result


def applied(vector: Vector, rows: Sequence[Vector]) -> Vector:
    """Return ``vector * matrix`` for a matrix given by its rows."""
    result: Vector = {}
    for position, value in vector.items():
        result = combined(result, rows[position], value)
    return result


def transposed(rows: Sequence[Vector], columns: int) -> list[Vector]:
    """Return the columns of a matrix given by its rows."""
    result: list[Vector] = [{} for _ in range(columns)]
    for i, row in enumerate(rows):
        for j, value in row.items():
            result[j][i] = value
    return result
