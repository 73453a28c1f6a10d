"""Minors of fundamental matrices, in balls: of laws whose coefficients vary along x.

Input: the matrices of a bound transfer function, and what its constants and functions of x are.
Output: a minor at a complex frequency, on a ball, or as a Taylor series about either.

Where coefficients are polynomials in s a matrix is expanded in powers of s, and evaluated anywhere; where
they are rational, as with a loss factor 1 + eta s below, it is expanded about the middle of every ball of s.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, inf, log2, pi
from typing import TYPE_CHECKING

from flint import acb, acb_series, arb

from symflex.algebra import Dispersion, Factored
from symflex.along.fundamental_matrix import PowerExpansion
from symflex.along.law import LEAST, ROOM, BoundLaw
from symflex.balls import Value, at_centre, current_bits, raised
from symflex.expressions import Call

if TYPE_CHECKING:
    from symflex.along.minors import Minor, MinorSums

BUCKET = 64  # bits are rounded up to a multiple of this, so that few matrices are expanded
FEWEST_BITS = 256  # least precision of an expansion: circles are sampled with up to 230, 30 digits take 192
LOW = 8.0  # power of e of waves below which no expansion is made for a smaller s alone: some three modes
BESIDE_MODES = 1  # half waves that motion of a body as a whole, and masses at ends, may take besides
BEYOND_MODES = 3.0  # how far steps of circles that roots are counted on reach, over the last mode's frequency
FURTHER = 1.5
"""How much further than asked for an expansion reaches [in s], so that not every mode needs another.

Each one that is made after others goes further by this once more, up to ``FURTHEST`` times: a path that
nobody announced is followed with few of them.
"""
FURTHEST = 3
HIGHEST_OCTAVE = 400  # nobody asks for a frequency [rad/s] beyond this power of two, or its inverse
PARTS = 4  # parts of an octave on which waves grow about equally far
MORE_ORDERS = 6  # powers of s less the middle of a wide ball that are kept beyond those asked for
NOWHERE = acb("nan", "nan")


@dataclass(frozen=True, eq=False)
class VaryingMatrices:
    """The fundamental matrices of a bound transfer function; expansions are kept for all precisions."""

    minors: MinorSums
    constants: Mapping[str, Callable[[], arb]]  # what encloses each at the current precision
    functions: Mapping[str, Call]  # of x, by their generators
    parameters: Mapping[str, Callable[[], arb]]  # what functions of x are made of
    # Per matrix: the size of u up to which an expansion serves, and its bits.
    _known: dict[int, list[tuple[arb, int, PowerExpansion]]] = field(default_factory=dict, repr=False)
    # Per matrix the last expansion about a middle, and for what it was made.
    _last: dict[int, tuple[tuple[object, ...], PowerExpansion | None]] = field(
        default_factory=dict, repr=False
    )
    _lowest: dict[int, int] = field(default_factory=dict, repr=False)
    _expected: dict[int, float] = field(default_factory=dict, repr=False)

    def value(self, minor: Minor, s: Value) -> Value:
        """Return a minor at a point, on a ball, or as a series about either."""
        law, terms = self.laws[minor.matrix], s.prec if isinstance(s, acb_series) else 1
        expansion = None
        if law.weights is not None:
            u: Value = law.rate(s)
            centre = at_centre(u)
            if centre.is_finite():
                expansion = self._in_powers(minor.matrix, abs(centre).upper())
        else:
            u, ball = s, at_centre(s)
            centre = ball - ball.mid()
            expansion = self._about(minor.matrix, ball, terms)
        if expansion is None:
            return NOWHERE if isinstance(s, acb) else acb_series([NOWHERE] * terms, terms)
        terms_of_minor = expansion.series(minor.rows, minor.columns, centre, terms)
        if isinstance(u, acb):
            total: Value = terms_of_minor[0]
        else:
            step = u - at_centre(u)
            total = acb_series([terms_of_minor[-1]], terms)
            for c in reversed(terms_of_minor[:-1]):
                total = total * step + c
        if law.weights is not None and law.divisors:
            scaled = sum(law.weights[i] for i in minor.rows) - sum(law.weights[j] for j in minor.columns)
            total = total * raised(law.divisor(s), scaled)
        return total

    def reach(self, dispersion: Dispersion, length: Factored, s: acb) -> float:
        """Return about by which power of e solutions grow along a member at ``s``."""
        size = float(abs(s).mid())
        law = self.laws[self.minors.matrices.index((dispersion, length))]
        return law.growth_at(round(PARTS * log2(size)), PARTS) if 0 < size < inf else 0.0

    @cached_property
    def laws(self) -> tuple[BoundLaw, ...]:
        """The law of every matrix."""
        return tuple(
            BoundLaw(law, self.functions, length, self.constants, self.parameters)
            for law, length in self.minors.matrices
        )

    def expect(self, modes: int, size: float = 0.0) -> None:
        """Tell that values are wanted for abs(s) up to a size and so many modes, so one expansion serves."""
        waves = pi * (modes + BESIDE_MODES) if modes else 0.0
        low, high = -HIGHEST_OCTAVE * PARTS, HIGHEST_OCTAVE * PARTS
        # What a tension makes grow at rest are no waves.
        waves += sum(self._at_rest) if waves else 0.0
        while waves and high - low > 1:
            middle = (low + high) // 2
            grows = sum(law.growth_at(middle, PARTS) for law in self.laws) > waves
            low, high = (low, middle) if grows else (middle, high)
        self._expected[0] = max(size, 2.0 ** (high / PARTS) if waves else 0.0) * BEYOND_MODES

    def _in_powers(self, matrix: int, size: arb) -> PowerExpansion:
        """Return an expansion that serves for abs(u) up to a size at the current precision."""
        law, known = self.laws[matrix], self._known.setdefault(matrix, [])
        fitting = [e for reached, bits, e in known if size <= reached and bits >= current_bits()]
        # One for larger frequencies, or with more bits, serves as well.
        if not fitting:
            if matrix not in self._lowest:
                self._lowest[matrix] = self._lowest_octave(matrix)
            wanted = abs(at_centre(law.rate(acb(0, self._expected.get(0, 0.0))))).upper()
            if not size <= wanted:
                wanted = (size * FURTHER ** (law.degree * min(max(len(known), 1), FURTHEST))).upper()
            largest = max(wanted, arb(2) ** (law.degree * self._lowest[matrix]), *(r for r, _, _ in known))
            bits = max(FEWEST_BITS, ceil(current_bits() / BUCKET) * BUCKET, *(b for _, b, _ in known))
            fitting = [law.expanded(largest, bits)]
            known.append((largest, bits, fitting[0]))
        return fitting[0]

    @cached_property
    def _at_rest(self) -> tuple[float, ...]:
        """The power of e by which the solutions of each law grow at rest."""
        # Next to rest, as states in a chain have no scales of their own at s = 0.
        return tuple(law.growth_at(-HIGHEST_OCTAVE * PARTS, PARTS) for law in self.laws)

    def _lowest_octave(self, matrix: int) -> int:
        """Return the logarithm of the least abs(s) that an expansion is made for."""
        law, at_rest = self.laws[matrix], self._at_rest[matrix]
        low, high = -HIGHEST_OCTAVE, HIGHEST_OCTAVE
        while high - low > 1:
            middle = (low + high) // 2
            grows = law.growth(arb(2) ** (law.degree * middle)) > at_rest + LOW
            low, high = (low, middle) if grows else (middle, high)
        return low

    def _about(self, matrix: int, ball: acb, terms: int) -> PowerExpansion | None:
        """Return an expansion about the middle of a ball."""
        middle, radius = ball.mid(), ball.rad()
        orders = terms + MORE_ORDERS if radius > 0 else terms
        least = abs(middle).upper() * LEAST if middle != 0 else arb(LEAST)
        reach = (radius * ROOM).upper() if radius * ROOM > least else least
        exact = (tuple(map(int, x.man_exp())) for x in (middle.real, middle.imag, reach.mid()))
        key = current_bits(), orders, *exact
        if matrix not in self._last or self._last[matrix][0] != key:
            self._last[matrix] = key, self.laws[matrix].expanded_about(middle, reach, orders)
        return self._last[matrix][1]
