"""How poles and zeros of frames and networks move with parameters, from the equations themselves.

Input: the equations of a model with the parameters as symbols, their values, and the roots that were found.
Output: a :class:`~symflex.analysis.sensitivity.RootDerivative` per root and parameter.

Poles are where A(s) is singular, zeros where ``[A b; c d]`` is, bordered by an input and an output. With
vectors X and Y that both sides of a singular matrix take to zero, ``ds/dp = -(Y dA/dp X) / (Y dA/ds X)``.
For two masses m on springs k in a row to ground, X = Y = (1, 1.618...) at the first pole.

Theorem: with any borders that make the matrix regular on a ball of s, the corner T(s, p) of its inverse
vanishes just where the matrix is singular, and dT = -Y dA X there and everywhere on the ball (Govaerts 2000,
chapter 3). So where dT/ds differs from 0 on the ball, a root in it is simple, an interval Newton step on T
keeps it (Moore 1966), and its derivative is that of the implicit function.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from flint import acb, acb_mat, acb_series

from symflex.algebra import LAPLACE, Factored
from symflex.analysis.modes.bound_equations import BESIDE, SingularPair, singular_pair
from symflex.balls import bits_for_digits, precision, precisions
from symflex.budget import spend
from symflex.roots import Root
from symflex.roots.networks.at_rest import order_at_zero
from symflex.roots.networks.cramer import CramerEquations
from symflex.transfer.equations_at import EquationsAt, holds

MOST_TIMES = 8  # largest factor on the first precision; what is not enclosed then does not lack bits
Entries = dict[tuple[int, int], acb]


@dataclass(frozen=True, eq=False)
class SingularMatrix:
    """``A(s)``, or ``[A b; c d]`` with an input and an output."""

    at: EquationsAt
    entries: Sequence[Mapping[int, Factored]]
    _moving: dict[str, list[tuple[int, int, Factored]]] = field(default_factory=dict)

    def value(self, s: acb) -> acb_mat:
        """Return the matrix on a ball of s."""
        return self.at.on(s).matrix(self.entries)

    def slope(self, s: acb, along: str) -> Entries:
        """Return the derivatives of the entries in s or a parameter on a ball of s; zeros are left out."""
        if along not in self._moving:
            names, rows = self.at.moving(along), enumerate(self.entries)
            self._moving[along] = [(i, j, c) for i, row in rows for j, c in row.items() if holds(c, names)]
        number = self.at.on(s, along)
        values = ((i, j, number(c)) for i, j, c in self._moving[along])
        return {(i, j): x[1] for i, j, x in values if isinstance(x, acb_series) and x[1] != 0}


@dataclass(eq=False)
class MovingRoot:
    """A root of a matrix, enclosed ever closer."""

    matrix: SingularMatrix
    place: acb  # holds one root [rad/s]

    @cached_property
    def _typical(self) -> acb_mat:
        """The matrix beside the root, after which rows and columns are scaled."""
        middle = self.place.mid()
        return self.matrix.value(middle * BESIDE if middle != 0 else acb(1))

    def _pair(self, s: acb) -> SingularPair | None:
        return singular_pair(self.matrix.value(s), self._typical)

    def refine(self) -> tuple[SingularPair, acb] | None:
        """Enclose the root closer; return the vectors on it and dT/ds, None if these are not enclosed."""
        enclosed = self._on_place()
        while enclosed is not None:
            middle = self.place.mid()
            beside = self._pair(middle)
            if beside is None:
                break
            step = middle - beside.corner / enclosed[1]
            if not step.is_finite() or not step.overlaps(self.place):
                break
            closer = acb(step.real.intersection(self.place.real), step.imag.intersection(self.place.imag))
            if not closer.rad() < self.place.rad() / 2:
                break
            self.place = closer
            enclosed = self._on_place()
        return enclosed

    def _on_place(self) -> tuple[SingularPair, acb] | None:
        spend()
        pair = self._pair(self.place)
        if pair is None:
            return None
        slope = pair.change(self.matrix.slope(self.place, LAPLACE))
        return (pair, slope) if slope.is_finite() and not slope.contains(0) else None


def derivatives(
    matrix: SingularMatrix, root: Root, parameters: tuple[str, ...], digits: int
) -> tuple[acb, dict[str, acb | None]]:
    """Return the enclosure of a simple root and its derivatives; None those that are not enclosed."""
    wanted = bits_for_digits(digits)
    first = max(root.working_bits(), 2 * wanted)
    moving = MovingRoot(matrix, root.enclosure())
    slopes: dict[str, acb | None] = dict.fromkeys(parameters)
    missing = list(parameters)
    for bits in precisions(first, MOST_TIMES * first):
        with precision(bits):
            if (enclosed := moving.refine()) is None:
                continue
            pair, slope = enclosed
            for name in missing:
                derivative = -pair.change(matrix.slope(moving.place, name)) / slope
                slopes[name] = derivative if derivative.is_finite() else slopes[name]
        missing = [
            n for n in missing if (x := slopes[n]) is None or not (x == 0 or x.rel_accuracy_bits() >= wanted)
        ]
        if not missing:
            break
    return moving.place, slopes


def is_fixed_at_zero(at: EquationsAt, pair: tuple[str, str], root: Root, *, is_pole: bool) -> bool:
    """Tell whether as many roots are at 0 for all parameters: modulo a prime, odds of 1 in 2^61 are left."""
    orders = []
    for values in ((), at.values):
        cramer = CramerEquations.of(at.equations, *pair, values)
        size = len(cramer.entries) - is_pole
        orders.append(order_at_zero(cramer, size, root.multiplicity))
    return orders[0] is not None and orders[0] == orders[1]
