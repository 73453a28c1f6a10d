"""The order of zeros at s = 0 and elsewhere where wavenumbers vanish, are branched, and kernels cancel.

With ``s = e^4`` every wavenumber is a power series in e.
"""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from symflex.algebra.ring import by_powers, degree_in
from symflex.algebra.taylor import BASE, TaylorField, primes, random_values

if TYPE_CHECKING:
    from collections.abc import Callable

    from flint import fmpz_mpoly, nmod_poly

    from symflex.algebra.dispersion import Dispersion, KernelTable
    from symflex.algebra.factored import Factored
    from symflex.algebra.ring import Ring

BRANCHES = 4
TERMS = 80
TRIALS = 4
"""Values of the parameters that are tried in each field."""


class OriginSeries:
    """Orders at s = 0, or where another polynomial in s and parameters vanishes, of functions over one ring.

    General dispersions are not covered. With ``at``, linear in s or in a parameter, that vanishes instead of
    s. Orders above ``terms``, in the fourth root of s, are not found.
    """

    def __init__(
        self, ring: Ring, table: KernelTable, at: fmpz_mpoly | None = None, terms: int = TERMS
    ) -> None:
        self.ring = ring
        self._found = _find_point(ring, table, ring.context.gen(0) if at is None else at, terms)

    def order(self, value: Factored) -> int | None:
        """Return the order of the zero (negative: of the pole), ``None`` when it is not found."""
        if self._found is None:
            return None
        field, values = self._found
        total = 0
        for factor, exponent in value.factors:
            first = field.order(field.polynomial(factor, self.ring.names, values))
            if first is None:
                return None
            total += first * exponent
        return total // BRANCHES if total % BRANCHES == 0 else None


def _find_point(
    ring: Ring, table: KernelTable, at: fmpz_mpoly, terms: int
) -> tuple[TaylorField, dict[str, nmod_poly]] | None:
    """Return series for all generators near where a polynomial vanishes."""
    if any(d.kind == "general" for d in table.dispersions):
        return None
    linear = next((i for i in range(len(ring.names)) if degree_in(at, i) == 1), None)
    if linear is None:
        return None
    parts = by_powers(ring, at, linear)
    name, zero = ring.names[linear], ring.constant(0)

    def prepare(values: dict[str, nmod_poly], field: TaylorField) -> bool:
        rest, slope = (field.polynomial(parts.get(k, zero), ring.names, values) for k in (0, 1))
        below = field.inverse(slope)
        if below is None:
            return False
        # The scale decides in which fields the roots of several wavenumbers exist together.
        scale = int(values[name][0]) or 1
        values[name] = field.times(field.power(BRANCHES) * scale - rest, below)
        return True

    return find_point(ring, table, terms, prepare)


def find_point(
    ring: Ring,
    table: KernelTable,
    terms: int,
    prepare: Callable[[dict[str, nmod_poly], TaylorField], bool],
) -> tuple[TaylorField, dict[str, nmod_poly]] | None:
    """Return values for all generators that satisfy every relation, in a field where the wavenumbers exist.

    Kernels of general dispersions get random values. Series have so many terms, one for numbers; ``prepare``
    sets values that are not random, and returns False to ask for other random ones.
    """
    random = Random(11)
    for prime in primes():
        field = TaylorField(terms, prime)
        for _ in range(TRIALS):
            values = random_values(ring.names, random, field)
            if prepare(values, field) and all(_place(d, ring, values, field) for d in table.dispersions):
                found = _with_kernels(ring, table, values, field)
                return None if found is None else (field, found)
    return None


def _with_kernels(
    ring: Ring, table: KernelTable, values: dict[str, nmod_poly], field: TaylorField
) -> dict[str, nmod_poly] | None:
    starts: dict[tuple[str, Factored], int] = {}
    known: dict[tuple[Dispersion, str, Factored, bool], tuple[nmod_poly, nmod_poly]] = {}
    for kernel in table.kernels:
        if kernel.function == "fundamental":
            continue
        key = (kernel.wavenumber, kernel.length)
        start = starts.setdefault(key, pow(BASE, 1001 + 2 * len(starts), field.prime))
        circular = kernel.function in ("cos", "sin")
        pair = (kernel.dispersion, *key, circular)
        if pair not in known:
            length = field.rational(kernel.length, ring.names, values)
            shift = field.rational(kernel.dispersion.shift, ring.names, values)
            if length is None or shift is None:
                return None
            rate = values[kernel.wavenumber] if kernel.wavenumber else -shift
            known[pair] = field.even_odd(field.times(rate, length), start, circular=circular)
        even, odd = known[pair]
        if kernel.function == "exp":
            values[kernel.generator] = even + odd
        else:
            values[kernel.generator] = even if kernel.function in ("cosh", "cos") else odd
    return values


def _place(law: Dispersion, ring: Ring, values: dict[str, nmod_poly], field: TaylorField) -> bool:
    """Put the wavenumbers' series into the values; False where a root does not exist."""
    found = [field.rational(x, ring.names, values) for x in law.characteristic]
    c = [x for x in found if x is not None]
    if len(c) < len(found):
        return False
    roots: list[nmod_poly | None] = []
    match law.kind:
        case "wave":
            roots = [field.root(-c[0])]
        case "bending":
            square = field.root(c[0] * pow(4, -1, field.prime))
            roots = [None if square is None else field.root(square)]
        case "pair":
            middle = -c[2] * pow(2, -1, field.prime)
            root = field.root(field.times(middle, middle) - c[0])
            if root is not None:
                roots = [field.root(middle + root), field.root(middle - root)]
    if len(roots) < len(law.wavenumbers):
        return False
    for name, series in zip(law.wavenumbers, roots, strict=True):
        if series is None:
            return False
        values[name] = series
    return True
