"""Linear differential equations whose coefficients vary along x, as fundamental matrices are made of them.

Input: what encloses the coefficients of ``dz/dx = A(x, u) z``, ``A = sum_q u^q A_q(x)``, at a point and on a
ball of x: a :class:`VaryingSystem`.
Output: bounds on those of other equations, that minors of solutions satisfy.

    y'' = u y, z = (y, y')        A = ((0, 1), (u, 0))
    y_1 y_2' - y_2 y_1'           its slope is the trace of A times it: nothing
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Protocol

from flint import acb, acb_poly, arb, arb_poly

Place = tuple[int, int]  # row and column
Polynomial = arb_poly | acb_poly
Number = arb | acb
Coefficients = dict[Place, Polynomial]  # entries that are not zero, in x less the expansion's point
Lines = tuple[int, ...]  # rows or columns of a minor


@dataclass(frozen=True, slots=True)
class RationalPart:
    """A part of an entry: a quotient of polynomials in x, times powers of u."""

    place: Place
    numerator: Polynomial  # in x less the point of expansion
    divisors: tuple[Polynomial, ...]  # of the same; a factor of the denominator stands as often as it occurs
    rates: tuple[tuple[int, Number], ...]  # the powers of u, and what each is multiplied by


class VaryingSystem(Protocol):
    """The coefficients of a system, evaluated at the current precision."""

    @property
    def size(self) -> int:
        """The number of states."""
        ...

    @property
    def beginning(self) -> SingularBeginning | None:
        """What stands in place of the coefficients at a start where these have poles."""
        ...

    def ends(self) -> tuple[arb, arb]:
        """Return where x begins and ends."""
        ...

    def series(self, x: arb, terms: int) -> Sequence[Coefficients]:
        """Return, per power of u, the entries' Taylor polynomials about a point."""
        ...

    def parts(self, x: arb) -> Sequence[RationalPart] | None:
        """Return what entries are sums of about a point, ``None`` if some are not rational in x."""
        ...

    def bounds(self, x: acb, largest: arb) -> Mapping[Place, arb]:
        """Return the sizes of entries on a ball of x for abs(u) <= ``largest``; not finite near a pole."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class SingularBeginning:
    """Matrices of :class:`symflex.algebra.dispersion.SingularStart`: ``z_i = h^powers_i v_i``."""

    powers: tuple[int, ...]
    matrix: VaryingSystem  # B, with series and bounds about the start; what vanishes there is exactly zero
    values: VaryingSystem  # v at the start


@dataclass(frozen=True, eq=False)
class MinorsAlong:
    """The equations that minors of so many rows satisfy, whose columns are the same solutions.

    The slope of a minor is the sum of those in which one row has its slope instead: an entry of A replaces
    a row by another one (Schwarz 1970, additive compounds).
    """

    whole: VaryingSystem
    order: int

    @cached_property
    def lines(self) -> tuple[Lines, ...]:
        """The rows of every minor, in order."""
        return tuple(combinations(range(self.whole.size), self.order))

    def bounds(self, x: acb, largest: arb) -> dict[Place, arb]:
        """Return the sizes of entries on a ball of x for abs(u) <= ``largest``; not finite near a pole."""
        sizes: dict[Place, arb] = {}
        for place, size in self.whole.bounds(x, largest).items():
            for own in self._places.get(place, ()):
                sizes[own] = sizes.get(own, arb(0)) + size
        return sizes

    @cached_property
    def _places(self) -> Mapping[Place, Sequence[Place]]:
        """The places in these equations of every entry of the whole."""
        numbers = {line: k for k, line in enumerate(self.lines)}
        sources: dict[Place, list[Place]] = {}
        for line, row in numbers.items():
            for i in line:
                rest = set(line) - {i}
                for j in set(range(self.whole.size)) - rest:
                    sources.setdefault((i, j), []).append((row, numbers[tuple(sorted(rest | {j}))]))
        return sources


def polynomial_of(coefficients: Sequence[Number]) -> Polynomial:
    """Return a polynomial, a real one where all coefficients are real."""
    real = [c for c in coefficients if isinstance(c, arb)]
    return arb_poly(real) if len(real) == len(coefficients) else acb_poly(list(coefficients))


def sequence_of(coefficients: Coefficients, n: int) -> list[int]:
    """Return the states so that the slope of each follows from those before it; empty if they go in circles.

    >>> sequence_of({(0, 1): acb_poly([1]), (1, 2): acb_poly([1])}, 3)
    [2, 1, 0]
    """
    order: list[int] = []
    while len(order) < n:
        ready = [
            i for i in range(n) if i not in order and all(k in order for (row, k) in coefficients if row == i)
        ]
        if not ready:
            return []
        order += ready
    return order
