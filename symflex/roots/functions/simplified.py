"""A function made ready for a search: kernels of length zero are numbers, and hidden squares written out.

``cosh^4 - cosh^2`` is ``(cosh*sinh)^2``, and ``1 - cos`` is twice the square of the sine of half the angle.
Over exponentials and half-angle functions polynomials factor in one way only (Yun 1976 for the square-free
part); whatever square appears there is written in kernels of half the length, so that multiplicities of roots
are exact.
"""

from __future__ import annotations

from dataclasses import replace
from math import prod
from typing import TYPE_CHECKING

from flint import acb

from symflex.algebra import LAPLACE, NO_KERNELS, Factored, Ring, degree_in, square_free_factors
from symflex.algebra.exponential_sum import arguments_of, exponential_sum
from symflex.algebra.exponentials import Exponentials
from symflex.algebra.normal_form import NormalForm
from symflex.errors import Diagnostic, ModelError
from symflex.roots.precision import precision
from symflex.roots.root import FLOAT_BITS
from symflex.transfer.balls import at_centre
from symflex.transfer.transfer_function import HiddenFactor

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.algebra.dispersion import Kernel
    from symflex.transfer import BoundTransferFunction


EVEN = ("cosh", "cos", "exp")


def without_lengths_of_zero(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with the values of kernels whose length is zero in their place.

    SF231 when the denominator vanishes: two nodes are one.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.T = { value = "0 s", assume = "nonnegative" }
    ... blocks.D = { type = "delay", T = "T" }
    ... inputs.u = {}
    ... outputs.y = "u/(1 + D)"
    ... ''')
    >>> bound = pipeline.derive_bound(model, model.transfer_functions)[0]
    >>> without_lengths_of_zero(bound).is_distributed
    False
    """
    gone = [kernel for kernel in bound.kernels.kernels if kernel.length.is_zero]
    if not gone:
        return bound
    ring = bound.ratio.ring
    images = [ring.context.gen(i) for i in range(len(ring.names))]
    for kernel in gone:
        images[ring.index[kernel.generator]] = ring.constant(_value(kernel))

    def evaluated(factor: fmpz_mpoly) -> Factored:
        return Factored.polynomial(ring, ring.compose(factor, images))

    num, den = (part.map_factors(ring, evaluated) for part in (bound.num, bound.den))
    if den.is_zero:
        message = f"the denominator of {bound.name} is zero for these values"
        raise ModelError(Diagnostic("SF231", message, None, "a part needs its length"))
    hidden = [
        HiddenFactor(f, e * known.multiplicity)
        for known in bound.hidden
        for f, e in evaluated(known.polynomial).factors
    ]
    kernels = [ring.index[generator] for generator in bound.kernels.generators]
    factors = [f for f, _ in (*num.factors, *den.factors)] + [h.polynomial for h in hidden]
    if any(degree_in(f, i) for f in factors for i in kernels):
        return replace(bound, ratio=num / den, parts=(num, den), hidden=tuple(hidden))
    small = Ring(tuple(name for name in ring.names if name not in bound.kernels.generators))
    places = [ring.index[name] for name in small.names]

    def moved(factor: fmpz_mpoly) -> fmpz_mpoly:
        terms = {tuple(int(m[i]) for i in places): int(c) for m, c in factor.terms()}
        return small.context.from_dict(terms)

    ratio = (num / den).map_factors(small, lambda f: Factored.polynomial(small, moved(f)))
    known = tuple(HiddenFactor(moved(h.polynomial), h.multiplicity) for h in hidden)
    return replace(bound, ratio=ratio, hidden=known, kernels=NO_KERNELS, parts=None)


def _value(kernel: Kernel) -> int:
    if kernel.function == "entry":
        return int(kernel.order % (kernel.dispersion.order + 1) == 0)
    if kernel.function == "fundamental":
        return int(kernel.order == kernel.dispersion.order - 1)
    return int(kernel.function in EVEN)


MOST_TERMS = 3000
"""Terms of a polynomial in exponentials up to which its squares are sought."""


def without_squares(bound: BoundTransferFunction, part: Factored) -> tuple[BoundTransferFunction, Factored]:
    """Return a product of factors without squares, and the function with the kernels these are made of."""
    table = bound.kernels
    if any(kernel.function in ("fundamental", "entry") for kernel in table.kernels):
        return bound, part
    coordinates = Exponentials(part.ring, table)
    circular = [
        coordinates.coordinates.generator(name)
        for angle in coordinates.angles
        if angle.kind == "circular"
        for name in angle.coordinates
    ]
    split: list[tuple[fmpz_mpoly, int]] = []
    has_squares = False
    for factor, exponent in part.factors:
        pieces = _pieces(coordinates, factor)
        if pieces is None:
            return bound, part
        has_squares = has_squares or any(
            e > 1 and (len(piece) > 1 or any(piece == c for c in circular)) for piece, e in pieces
        )
        split += [(piece, e * exponent) for piece, e in pieces]
    if not has_squares:
        return bound, part
    halved = coordinates.halved([k for angle in coordinates.angles for k in (angle.even, angle.odd)])
    normal = NormalForm(part.ring, halved)
    result = Factored.number(part.ring, part.unit)
    left = [0] * sum(angle.kind == "hyperbolic" for angle in coordinates.angles)
    for polynomial, exponent in split:
        restored, powers = coordinates.restore_halved(polynomial)
        left = [n + exponent * power for n, power in zip(left, powers, strict=True)]
        result = result * normal.reduce(restored) ** exponent
    if any(left):
        return bound, part
    return replace(bound, kernels=halved), result


def _pieces(coordinates: Exponentials, factor: fmpz_mpoly) -> list[tuple[fmpz_mpoly, int]] | None:
    """Return a polynomial as powers of polynomials without squares, ``None`` where it is too long."""
    if len(factor) > MOST_TERMS:
        return None
    if len(factor) == 1:
        # A generator; those other than kernels are coordinates themselves.
        name = coordinates.ring.names[factor.degrees().index(1)]
        if name in coordinates.coordinates.index:
            return [(coordinates.coordinates.generator(name), 1)]
    found = []
    for polynomial, times in coordinates.transform(factor).factors:
        if len(polynomial) > MOST_TERMS:
            return None
        if len(polynomial) == 1:
            # A coordinate.
            found.append((polynomial, times))
            continue
        _, pieces = square_free_factors(polynomial)
        found += [(piece, e * times) for piece, e in pieces]
    return found


def without_reflections(bound: BoundTransferFunction, part: Factored) -> Factored:
    """Return a product whose roots are the same, with powers of s for what has one exponential left.

    A wave that meets a damper as large as its own impedance is not reflected: ``E A gamma cosh(gamma l) +
    b s sinh(gamma l)`` is a multiple of ``s exp(gamma l)`` for ``b = A sqrt(E rho)``, and has no root but 0.
    What may be otherwise stays as it is, all of it.
    """
    table, result = bound.kernels, Factored.number(part.ring, part.unit)
    if not table.kernels or any(law.kind != "wave" for law in table.dispersions):
        return part
    for factor, exponent in part.factors:
        value = Factored.polynomial(part.ring, factor)
        kernels = [k for k in table.kernels if value.depends_on(k.generator)]
        names = {name for law in table.dispersions for name in law.wavenumbers if value.depends_on(name)}
        names |= {k.wavenumber for k in kernels}
        image = _of_one_wave(bound, factor, *names) if len(names) == 1 else None if names else value
        if image is None:
            return part
        result = result * image**exponent
    return result


def _of_one_wave(bound: BoundTransferFunction, factor: fmpz_mpoly, wavenumber: str) -> Factored | None:
    """Return what a factor is a multiple of, by an exponential and a number, where one of these is left."""
    ring, table = bound.ratio.ring, bound.kernels
    s = Factored.polynomial(ring, ring.context.gen(0))
    law = next(law for law in table.dispersions if law.wavenumbers == (wavenumber,))
    square = -law.characteristic[0]
    arguments = arguments_of(table)
    terms = None if arguments is None else exponential_sum(ring, table, arguments, factor)
    if terms is None or (square / s**2).depends_on(LAPLACE):
        return None
    left = []
    for amplitude in terms.terms.values():
        even = odd = s * 0
        for monomial, (number, _) in amplitude.items():  # of cosh and sinh all numbers are real
            powers = {ring.names[i]: e for i, e in monomial}
            whole, rest = divmod(powers.pop(wavenumber, 0), 2)
            term = prod((Factored.generator(ring, n) ** e for n, e in powers.items()), start=square**whole)
            even, odd = (even, odd + term * number) if rest else (even + term * number, odd)
        # The wavenumber is s times a number: even + odd gamma is zero, or like s to a power, or not told.
        norm = bound.radicals.reduced(even**2 - odd**2 * square)
        gamma = Factored.generator(ring, wavenumber)
        if norm.is_zero and _differs(bound, even - odd * gamma):
            continue
        left.append(odd * s if even.is_zero else even)
        if (norm / left[-1] ** 2).depends_on(LAPLACE):
            return None
    return left[0] if len(left) == 1 else None


def _differs(bound: BoundTransferFunction, value: Factored) -> bool:
    """Tell whether a value is not zero at s = 1, on the branch on which wavenumbers are positive there."""
    with precision(FLOAT_BITS):
        evaluator = bound.kernel_values()
        values = evaluator.at(acb(1))
        return not at_centre(evaluator.value(value, values)).contains(0)
