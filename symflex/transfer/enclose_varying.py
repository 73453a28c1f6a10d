"""Minors of fundamental matrices, in balls: of laws whose coefficients vary along x.

Input: the matrices of a bound transfer function, and what its constants and functions of x are.
Output: a minor at a complex frequency, on a ball, or as a Taylor series about either.

Where coefficients are polynomials in s a matrix is expanded in powers of s, and evaluated anywhere; where
they are rational, as with a loss factor 1 + eta s below, it is expanded about the middle of every ball of s.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, inf, log2
from typing import TYPE_CHECKING

from flint import acb, acb_series, arb, ctx

from symflex.transfer.balls import Value, at_centre
from symflex.transfer.varying_law import BoundLaw, raised

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from symflex.algebra import Dispersion, Factored
    from symflex.algebra.fundamental_matrix import PowerExpansion
    from symflex.algebra.minors import Minor, MinorSums
    from symflex.expressions import Call

BUCKET = 64
"""Bits are rounded up to a multiple of this, so that few matrices are expanded."""
FEWEST_BITS = 192
"""Of an expansion: roots to 30 digits need so many, and with half as many it takes two thirds of the time."""
LOW = 20.0
"""Power of e by which waves grow below which no expansion is made for a smaller s alone: some seven modes."""
HIGHEST_OCTAVE = 400
"""Nobody asks for a frequency [rad/s] beyond this power of two, or below its inverse."""
PARTS = 4
"""Of an octave, on which about how far waves grow is the same."""
MORE_ORDERS = 6
"""Powers of s less the middle of a wide ball that are kept beyond those asked for."""
LEAST = 2.0**-20
"""Relative radius on which an expansion is used at least, so that slopes are bounded."""
NOWHERE = acb("nan", "nan")
ROOM = 2.0
"""How much wider than a ball of s it may be within the disc on which an expansion is used."""


@dataclass(frozen=True, eq=False)
class VaryingMatrices:
    """The fundamental matrices of a bound transfer function; expansions are kept for all precisions."""

    minors: MinorSums
    constants: Mapping[str, Callable[[], arb]]  # what encloses each at the current precision
    functions: Mapping[str, Call]  # of x, by their generators
    parameters: Mapping[str, Callable[[], arb]]  # what functions of x are made of
    # Per matrix: the octave up to which an expansion serves, and its bits.
    _known: dict[int, list[tuple[int, int, PowerExpansion]]] = field(default_factory=dict, repr=False)
    # Per matrix the last expansion about a middle, and for what it was made.
    _last: dict[int, tuple[tuple[object, ...], PowerExpansion | None]] = field(
        default_factory=dict, repr=False
    )
    _lowest: dict[int, int] = field(default_factory=dict, repr=False)

    def value(self, minor: Minor, s: Value) -> Value:
        """Return a minor at a point, on a ball, or as a series about either."""
        law, terms = self._laws[minor.matrix], s.prec if isinstance(s, acb_series) else 1
        if law.is_polynomial:
            u: Value = raised(s, law.step)
            centre = at_centre(u)
            expansion = self._in_powers(minor.matrix, abs(centre).upper())
        else:
            u, ball = s, at_centre(s)
            centre = ball - ball.mid()
            about = self._about(minor.matrix, ball, terms)
            if about is None:
                return NOWHERE if isinstance(s, acb) else acb_series([NOWHERE] * terms, terms)
            expansion = about
        found = expansion.series(minor.rows, minor.columns, centre, terms)
        if isinstance(u, acb):
            return found[0]
        step = u - at_centre(u)
        total = acb_series([found[-1]], terms)
        for c in reversed(found[:-1]):
            total = total * step + c
        return total

    def reach(self, dispersion: Dispersion, length: Factored, s: acb) -> float:
        """Return about by which power of e solutions grow along a member at ``s``."""
        size = float(abs(s).mid())
        law = self._laws[self.minors.matrices.index((dispersion, length))]
        return law.growth_at(round(PARTS * log2(size)), PARTS) if 0 < size < inf else 0.0

    @cached_property
    def _laws(self) -> tuple[BoundLaw, ...]:
        known = self.constants, self.functions, self.parameters
        return tuple(BoundLaw(law, length, *known) for law, length in self.minors.matrices)

    def _in_powers(self, matrix: int, size: arb) -> PowerExpansion:
        """Return an expansion that serves for abs(u) up to a size at the current precision."""
        law, known = self._laws[matrix], self._known.setdefault(matrix, [])
        if matrix not in self._lowest:
            self._lowest[matrix] = self._lowest_octave(law)
        octave = self._lowest[matrix]
        if size > 0:
            octave = max(octave, ceil(float((size.log() / arb(2).log()).upper()) / law.step))
        # One for larger frequencies, or with more bits, serves as well.
        fitting = [e for reached, bits, e in known if reached >= octave and bits >= ctx.prec]
        if not fitting:
            octave = max(octave, *(reached for reached, _, _ in known), octave)
            bits = max(FEWEST_BITS, ceil(ctx.prec / BUCKET) * BUCKET, *(b for _, b, _ in known), 0)
            fitting = [law.expanded(arb(2) ** (octave * law.step), bits)]
            known.append((octave, bits, fitting[0]))
        return fitting[0]

    @staticmethod
    def _lowest_octave(law: BoundLaw) -> int:
        """Return the logarithm of the least abs(s) that an expansion is made for."""
        at_rest = law.growth(arb(0))
        low, high = -HIGHEST_OCTAVE, HIGHEST_OCTAVE
        while high - low > 1:
            middle = (low + high) // 2
            grows = law.growth(arb(2) ** (law.step * middle)) > at_rest + LOW
            low, high = (low, middle) if grows else (middle, high)
        return low

    def _about(self, matrix: int, ball: acb, terms: int) -> PowerExpansion | None:
        """Return an expansion about the middle of a ball."""
        middle, radius = ball.mid(), ball.rad()
        orders = terms + MORE_ORDERS if radius > 0 else terms
        least = abs(middle).upper() * LEAST if middle != 0 else arb(LEAST)
        reach = (radius * ROOM).upper() if radius * ROOM > least else least
        exact = (tuple(map(int, x.man_exp())) for x in (middle.real, middle.imag, reach.mid()))
        key = ctx.prec, orders, *exact
        if matrix not in self._last or self._last[matrix][0] != key:
            self._last[matrix] = key, self._laws[matrix].expanded_about(middle, reach, orders)
        return self._last[matrix][1]
