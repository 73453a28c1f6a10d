"""To what order a polynomial in kernels vanishes where wavenumbers do, or where two of them meet.

Numerators and denominators of transfer functions are entire in s, but as polynomials in kernels they bear
powers of wavenumbers whose zeros kernels cancel: ``sinh(gamma l)/gamma``. The order is read off the Taylor
series at random values of everything else.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING

from symflex.algebra.taylor import BASE, TaylorField, random_values

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly, nmod_poly

    from symflex.algebra.dispersion import Dispersion, KernelTable
    from symflex.algebra.factored import Factored
    from symflex.algebra.ring import Ring

TERMS = (8, 16, 32)
"""Lengths of Taylor series that are tried."""


@dataclass(frozen=True, eq=False)
class Vanishing:
    """Orders of zeros of polynomials over one ring."""

    ring: Ring  # with the table's generators
    table: KernelTable  # wavenumbers and kernels
    # Parameters in terms of the wavenumbers and the others, from the dispersion relations, in the order in
    # which they can be evaluated; one that is finite where the order is asked for is used.
    solutions: Sequence[Sequence[tuple[str, Factored]]]

    def at_zero(self, polynomial: fmpz_mpoly, wavenumber: str) -> int | None:
        """Return the order in a wavenumber at zero, s and the parameters being independent of it."""
        return self._order(polynomial, wavenumber, None)

    def at_confluence(self, polynomial: fmpz_mpoly, dispersion: Dispersion) -> int | None:
        """Return the order in ``lambda_1^2 - lambda_2^2`` where the two wavenumbers meet."""
        first, second = dispersion.wavenumbers
        return self._order(polynomial, second, first)

    def at_zero_of_pair(self, polynomial: fmpz_mpoly, dispersion: Dispersion) -> int | None:
        """Return the order in ``lambda_1`` at zero, the parameters following the dispersion relation."""
        return self._order(polynomial, dispersion.wavenumbers[0], "")

    def _order(self, polynomial: fmpz_mpoly, moving: str, meeting: str | None) -> int | None:
        for solved in self.solutions:
            for terms in TERMS:
                field = TaylorField(terms)
                values = self._values(field, moving, meeting, solved)
                if values is None:
                    break
                order = field.order(field.polynomial(polynomial, self.ring.names, values))
                if order is not None:
                    return order
        return None

    def _values(
        self, field: TaylorField, moving: str, meeting: str | None, solved: Sequence[tuple[str, Factored]]
    ) -> dict[str, nmod_poly] | None:
        names = self.ring.names
        values = random_values(names, Random(20), field)
        values[moving] = field.power(1, int(values[meeting][0]) if meeting else 0)
        if meeting is not None:
            for name, formula in solved:
                found = field.rational(formula, names, values)
                if found is None:
                    return None
                values[name] = found
        lengths: dict[Factored, int] = {}
        for kernel in self.table.kernels:
            if not kernel.wavenumber or kernel.wavenumber not in (moving, meeting):
                continue
            length = field.rational(kernel.length, names, values)
            if length is None:
                return None
            # Where two wavenumbers meet, both start from one exponential per length.
            start = lengths.setdefault(kernel.length, pow(BASE, 1001 + 2 * len(lengths), field.prime))
            argument = field.times(values[kernel.wavenumber], length)
            circular = kernel.function in ("cos", "sin")
            even, odd = field.even_odd(argument, start, circular=circular)
            values[kernel.generator] = even if kernel.function in ("cosh", "cos") else odd
        return values
