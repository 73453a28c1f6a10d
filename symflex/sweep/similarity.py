"""When two bound transfer functions are one function of s up to a scale of s.

A uniform beam has the same characteristic function of its wavenumber whatever its dimensions are: all roots
of one such beam are those of another times one factor. Lengths are counted in the first kernel's, frequencies
in what makes the first dispersion relation's leading coefficient one; what is left are ratios without
dimension. Where all of them are equal, exactly, the functions are similar.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.kernels import Factored
    from symflex.transfer import BoundTransferFunction

KERNELS = ("cosh", "sinh", "cos", "sin")
Number = tuple[int, Fraction]
"""Sign and n-th power of the absolute value."""


@dataclass(frozen=True, slots=True)
class Similarity:
    """Which functions a function is similar to, and its scale of s.

    Parameters
    ----------
    key : tuple
        Equal, and of the same ``degree``, for similar functions.
    scale : Fraction
        The n-th power of the scale [rad/s]: roots divided by the scale are those of all similar functions.
    degree : int
        n.
    """

    key: tuple[object, ...]
    scale: Fraction
    degree: int


def similarity_of(bound: BoundTransferFunction) -> Similarity | None:
    """Return the similarity of a function, ``None`` where it has no such scale.

    Lumped systems have none, nor those with delays or waves without a formula; that their frequencies could
    be scaled is not looked for.
    """
    table = bound.kernels
    if not table.kernels or any(kernel.function not in KERNELS for kernel in table.kernels):
        return None
    if bound.parts is None or any(name != "pi" for name, _ in bound.constants) or bound.ratio.is_zero:
        return None
    length = _plain(table.kernels[0].length)
    leading = _leading(table.kernels[0].dispersion.characteristic[0])
    if not length or leading is None:
        return None
    coefficient, degree = leading
    order = table.kernels[0].dispersion.order
    measure = _Measure(bound, length, 1 / (abs(coefficient) * abs(length) ** order), degree)
    key = (
        degree,
        tuple(measure.product(part) for part in bound.parts),
        tuple((measure.polynomial(h.polynomial), h.multiplicity) for h in bound.hidden),
        tuple(
            (law.kind, *(measure.value(c, law.order - i) for i, c in enumerate(law.characteristic)))
            for law in table.dispersions
        ),
        tuple(measure.value(law.shift, 1) for law in table.dispersions),
        tuple(measure.value(kernel.length, -1) for kernel in table.kernels),
    )
    return Similarity(key, measure.scale, degree)


def _plain(value: Factored) -> Fraction | None:
    """Return a value that is a rational number."""
    return None if value.factors else value.unit


def _leading(value: Factored) -> tuple[Fraction, int] | None:
    """Return coefficient and exponent of the lowest power of s; ``None`` without a power of s."""
    coefficient, exponent = value.unit, 0
    for factor, power in value.factors:
        lowest = min(factor.terms(), key=lambda term: int(term[0][0]))
        if any(int(e) for e in lowest[0][1:]):
            return None
        coefficient *= Fraction(int(lowest[1])) ** power
        exponent += int(lowest[0][0]) * power
    return (coefficient, exponent) if coefficient and exponent > 0 else None


@dataclass(frozen=True, slots=True)
class _Measure:
    """Writes coefficients without dimension: their signs, and the n-th powers of their absolute values."""

    bound: BoundTransferFunction
    length: Fraction
    scale: Fraction
    degree: int

    def product(self, value: Factored) -> tuple[object, ...]:
        """Return a product up to a constant factor."""
        return tuple((self.polynomial(factor), power) for factor, power in value.factors)

    def value(self, value: Factored, lengths: int) -> tuple[object, ...]:
        """Return a value that is measured in a power of 1/length, exactly."""
        n = self.degree
        sign = 1 if value.unit > 0 else -1 if value.unit < 0 else 0
        size = abs(value.unit) ** n * abs(self.length) ** (n * lengths)
        for factor, power in value.factors:
            own, first = self._first(factor)
            size *= first**power
            sign *= own**power
        return (sign, size, self.product(value))

    def polynomial(self, factor: fmpz_mpoly) -> tuple[object, ...]:
        """Return a polynomial up to a constant factor."""
        sign, size = self._first(factor)
        found = []
        for monomial, coefficient in factor.terms():
            own, power = self._number(monomial, int(coefficient))
            found.append((tuple(int(e) for e in monomial), own * sign, power / size))
        return tuple(found)

    def _first(self, factor: fmpz_mpoly) -> Number:
        monomial, coefficient = next(iter(factor.terms()))
        return self._number(monomial, int(coefficient))

    def _number(self, monomial: tuple[int, ...], coefficient: int) -> Number:
        index = self.bound.ratio.ring.index
        waves = sum(int(monomial[index[name]]) for name in self.bound.kernels.wavenumbers)
        n = self.degree
        size = Fraction(abs(coefficient)) ** n * self.scale ** int(monomial[0])
        return (1 if coefficient > 0 else -1), size / abs(self.length) ** (n * waves)
