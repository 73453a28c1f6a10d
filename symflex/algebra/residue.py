"""Values at a random point of a prime field, where only what is zero vanishes, almost surely."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from symflex.algebra.ring import terms_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra.factored import Factored

PRIME = 2**61 - 1
"""A Mersenne prime; a nonzero polynomial of degree d vanishes at a random point with odds d/PRIME."""


def random_point(names: Sequence[str]) -> dict[str, int]:
    """Return a value per generator, the same in every run."""
    random = Random(20)
    return {name: random.randrange(1, PRIME) for name in names}


def residue(value: Factored, point: Mapping[str, int]) -> int:
    """Return a factored rational function at a point, modulo ``PRIME``.

    Raises ZeroDivisionError when its denominator is zero there.

    Examples
    --------
    >>> from symflex.algebra import Factored, Ring
    >>> ring = Ring(("s", "k"))
    >>> k = Factored.generator(ring, "k")
    >>> residue((k + 1) / k, {"s": 1, "k": 1}), residue(k - k, {"s": 1, "k": 1})
    (2, 0)
    """
    names = value.ring.names
    number = value.unit.numerator % PRIME * _power(value.unit.denominator, -1) % PRIME
    for factor, exponent in value.factors:
        number = number * _power(_polynomial(factor, names, point), exponent) % PRIME
    return number


def _power(base: int, exponent: int) -> int:
    if exponent < 0 and base % PRIME == 0:
        message = "division by zero"
        raise ZeroDivisionError(message)
    return pow(base, exponent, PRIME)


def _polynomial(polynomial: fmpz_mpoly, names: Sequence[str], point: Mapping[str, int]) -> int:
    total = 0
    for monomial, coefficient in terms_of(polynomial):
        product = coefficient % PRIME
        for i, exponent in monomial:
            product = product * pow(point[names[i]], exponent, PRIME) % PRIME
        total += product
    return total % PRIME
