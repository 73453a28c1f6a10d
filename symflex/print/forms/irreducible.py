"""Irreducible factors of polynomials in kernels, trigonometric ones among them.

``cosh^2 + cos^2 - 2`` is ``(sinh - sin)*(sinh + sin)``: such factors are found in exponentials and half-angle
tangents, where polynomials factor in one way only, and those of even degree are written in kernels again.
"""

from __future__ import annotations

from fractions import Fraction

from flint import fmpz_mpoly

from symflex.algebra import Factored, KernelTable, irreducible_factors
from symflex.algebra.exponentials import Exponentials
from symflex.algebra.normal_form import NormalForm


def irreducible_kernels(value: Factored, table: KernelTable) -> Factored:
    """Return a product with every factor split as far as it goes over the rationals."""
    coordinates = Exponentials(value.ring, table)
    normal = NormalForm(value.ring, table)
    kernels = [value.ring.index[k.generator] for a in coordinates.angles for k in (a.even, a.odd)]
    result = Factored.number(value.ring, value.unit)
    for factor, exponent in value.factors:
        if len(factor) == 1:
            result = result * Factored.polynomial(value.ring, factor) ** exponent
        elif any(int(factor.degrees()[i]) for i in kernels):
            result = result * _split(factor, coordinates, normal) ** exponent
        else:
            constant, parts = irreducible_factors(factor)
            product = Factored.number(value.ring, constant)
            for part, times in parts:
                product = product * Factored.polynomial(value.ring, part) ** times
            result = result * product**exponent
    return result


def _split(factor: fmpz_mpoly, coordinates: Exponentials, normal: NormalForm) -> Factored:
    """Return the factors of one polynomial, itself where its factors have no kernels of their own."""
    whole = Factored.polynomial(normal.ring, factor)
    image = coordinates.transform(factor)
    exponentials = [
        coordinates.coordinates.generator(a.coordinates[0])
        for a in coordinates.angles
        if a.kind == "hyperbolic"
    ]
    split = [
        (part, times * exponent)
        for polynomial, exponent in image.factors
        if not any(polynomial == e for e in exponentials)
        for part, times in irreducible_factors(polynomial)[1]
    ]
    if sum(times for _, times in split) == 1:
        return whole
    product = Factored.number(normal.ring, 1)
    rest = coordinates.coordinates.constant(1)
    for part, times in split:
        if any(coordinates.parity(part)):
            rest = rest * part**times
        else:
            product = product * _restored(part, coordinates, normal) ** times
    if any(coordinates.parity(rest)):
        return whole
    product = product * _restored(rest, coordinates, normal)
    ratio = _expanded_ratio(product, factor, normal)
    return whole if ratio is None else product * ratio


def _restored(polynomial: fmpz_mpoly, coordinates: Exponentials, normal: NormalForm) -> Factored:
    restored, _ = coordinates.restore(polynomial)
    return normal.reduce_factored(restored)


def _expanded_ratio(product_found: Factored, factor: fmpz_mpoly, normal: NormalForm) -> Fraction | None:
    """Return the number by which the factors differ from the polynomial, ``None`` when it is not a number."""
    if any(e < 0 for _, e in product_found.factors) or product_found.is_zero:
        return None
    product = normal.reduce((product_found / product_found.unit).expand())
    ratio = normal.reduce(factor) / product_found.unit / Fraction(1)
    difference = ratio / product
    return difference.unit if difference.is_constant else None
