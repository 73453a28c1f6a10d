"""Polynomials in kernels as programs compute them: sums of real exponentials times cosines and sines.

    2 cosh(q) sin(q)  =  e^q sin(q) + e^(-q) sin(q)

Input: a polynomial over the ring of kernels.
Output: per product of terms ``exp(sum(a_i q_i)) cos(sum(b_i q_i))``, or the sine, one for every wavenumber, a
polynomial in s, the parameters and the wavenumbers. Powers of kernels are multiplied out as for every
:class:`symflex.algebra.exponential_sum.ExponentialSum`; conjugate exponentials are one term here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, reduce
from itertools import product
from math import prod
from operator import mul
from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.algebra.exponential_sum import expanded, times
from symflex.algebra.ring import coefficients_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Dispersion, KernelTable, Ring

Term = tuple[tuple[tuple[int, int], ...], int]
"""Pairs ``(a_i, b_i)``, one per length, and 0 for the cosine or 1 for the sine; the first b that is not zero
is positive."""

Key = tuple[Term, ...]
"""One term per family."""

KernelSum = dict[Key, "fmpz_mpoly"]
"""Products of terms with their coefficients, which are free of the kernels that have families."""

Powers = tuple[tuple[str, int], ...]
"""Functions of one argument, and exponents."""


@dataclass(frozen=True, slots=True, eq=False)
class Family:
    """A wavenumber with its base lengths, or a delay."""

    dispersion: Dispersion  # whose wavenumber it is
    wavenumber: str  # generator; empty for a delay or a shift
    lengths: tuple[Factored, ...]  # [m]; [s] for a delay
    # Per length, the functions ``cosh``, ``sinh``, ``cos``, ``sin``, ``exp``, with the positions of their
    # generators.
    kernels: tuple[tuple[tuple[str, int], ...], ...]

    @property
    def is_circular(self) -> bool:
        """True when cosine and sine occur besides the hyperbolic functions."""
        return self.dispersion.kind == "bending"


def families_of(ring: Ring, table: KernelTable) -> tuple[Family, ...]:
    """Return the families of a table; fundamental functions have none."""
    found: dict[tuple[str, Dispersion], dict[Factored, list[tuple[str, int]]]] = {}
    for kernel in table.kernels:
        if kernel.function != "fundamental":
            family = found.setdefault((kernel.wavenumber, kernel.dispersion), {})
            family.setdefault(kernel.length, []).append((kernel.function, ring.index[kernel.generator]))
    return tuple(
        Family(dispersion, wavenumber, tuple(own), tuple(map(tuple, own.values())))
        for (wavenumber, dispersion), own in found.items()
    )


def expand(ring: Ring, polynomial: fmpz_mpoly, families: Sequence[Family]) -> tuple[KernelSum, Factored]:
    """Return a polynomial in kernels as a sum whose coefficients share no factor, and that factor."""
    kernels = [(f, i) for family in families for own in family.kernels for f, i in own]
    parts = coefficients_of(ring, polynomial, [i for _, i in kernels])
    halved = [n for n, (f, _) in enumerate(kernels) if f != "exp"]
    degree = max(sum(key[n] for n in halved) for key in parts)
    found: KernelSum = {}
    for exponents, part in parts.items():
        scaled = part * 2 ** (degree - sum(exponents[n] for n in halved))
        of = {i: e for (_, i), e in zip(kernels, exponents, strict=True)}
        for chosen in product(
            *(_terms(tuple(tuple((f, of[i]) for f, i in own) for own in x.kernels)) for x in families)
        ):
            key = tuple(t for t, _ in chosen)
            term = scaled * prod(n for _, n in chosen)
            found[key] = found[key] + term if key in found else term
    found = {key: p for key, p in found.items() if len(p)}
    common = reduce(lambda x, y: x.gcd(y), found.values())
    if int(common.leading_coefficient()) < 0:
        common = -common
    return {k: p / common for k, p in found.items()}, Factored.polynomial(ring, common) / 2**degree


@cache
def _terms(powers: tuple[Powers, ...]) -> tuple[tuple[Term, int], ...]:
    """Return a product of powers of the kernels of one wavenumber, for all lengths together.

    The numbers are over two to the power of the degree.
    """
    found = []
    # The greatest angles first, each before its opposite.
    pieces = (sorted(expanded(dict(own)), key=lambda x: (-x[0], -abs(x[1]), -x[1])) for own in powers)
    for chosen in product(*pieces):
        first = next((b for _, b, _ in chosen if b), 0)
        if first >= 0:
            # z e^jR and its conjugate make 2 Re z cos R - 2 Im z sin R; z is real or imaginary.
            re, im = reduce(times, (weight for _, _, weight in chosen))
            # A delay's kernel falls with its exponent.
            pairs = tuple(
                (-a if own[0][0] == "exp" else a, b) for (a, b, _), own in zip(chosen, powers, strict=True)
            )
            found.append(((pairs, int(im != 0)), (re - im) * (2 if first else 1)))
    return tuple(found)


def in_lengths(terms: KernelSum, changes: Sequence[Sequence[Sequence[int]]]) -> KernelSum:
    """Return a sum in other base lengths: per family and old length, its multiples of the new ones."""
    moved: KernelSum = {}
    for key, polynomial in terms.items():
        sign, images = 1, []
        for (pairs, parity), matrix in zip(key, changes, strict=True):
            a, b = in_other_lengths(pairs, matrix)
            image, own = canonical(tuple(zip(a, b, strict=True)), parity)
            images.append(image)
            sign *= own
        moved[tuple(images)] = polynomial * sign
    return moved


def in_other_lengths(
    pairs: Sequence[tuple[int, int]], matrix: Sequence[Sequence[int]]
) -> tuple[list[int], list[int]]:
    """Return what a term's ``a`` and ``b`` are in other lengths."""
    a, b = zip(*pairs, strict=True)
    columns = list(zip(*matrix, strict=True))
    return [sum(map(mul, a, column)) for column in columns], [sum(map(mul, b, column)) for column in columns]


def canonical(pairs: tuple[tuple[int, int], ...], parity: int) -> tuple[Term, int]:
    """Return a term with a positive first angle, and the sign that this costs; 0 when it vanishes."""
    first = next((b for _, b in pairs if b), 0)
    if first == 0:
        return (pairs, 0), 0 if parity else 1
    if first > 0:
        return (pairs, parity), 1
    return (tuple((a, -b) for a, b in pairs), parity), -1 if parity else 1


def derivative_at_zero(term: Term, position: int, order: int) -> tuple[tuple[Term, int], ...]:
    """Return the derivative of a term with respect to ``q_position`` at zero, as a combination of terms.

    Examples
    --------
    >>> [derivative_at_zero((((1, 1),), 0), 0, k) for k in range(3)]
    [(((((0, 0),), 0), 1),), (((((0, 0),), 0), 1),), ()]
    """
    pairs, parity = term
    a, b = pairs[position]
    real, imaginary = 1, 0
    for _ in range(order):
        real, imaginary = a * real - b * imaginary, a * imaginary + b * real
    rest = (*pairs[:position], (0, 0), *pairs[position + 1 :])
    # Re (z e^jR) = Re z cos R - Im z sin R, and Im (z e^jR) = Im z cos R + Re z sin R.
    parts = ((0, imaginary), (1, real)) if parity else ((0, real), (1, -imaginary))
    found = []
    for kind, number in parts:
        image, sign = canonical(rest, kind)
        if number * sign:
            found.append((image, number * sign))
    return tuple(found)
