"""A function made ready for a search: kernels of length zero are numbers, and hidden squares written out.

``cosh^4 - cosh^2`` is ``(cosh*sinh)^2``, and ``1 - cos`` is twice the square of the sine of half the angle.
Over exponentials and half-angle functions polynomials factor in one way only (Yun 1976 for the square-free
part); whatever square appears there is written in kernels of half the length, so that multiplicities of roots
are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import prod

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, NO_KERNELS, Factored, KernelTable, Ring, square_free_factors, terms_of
from symflex.algebra.dispersion import Kernel
from symflex.algebra.exponential_sum import arguments_of, exponential_sum
from symflex.algebra.exponentials import Exponentials
from symflex.algebra.normal_form import NormalForm
from symflex.balls import at_centre
from symflex.errors import Diagnostic, ModelError
from symflex.transfer import BoundTransferFunction, HiddenFactor

EVEN = ("cosh", "cos", "exp")


def without_lengths_of_zero(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with the values of kernels whose length is zero in their place.

    SF231 when the denominator vanishes: two nodes are one.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.T = { value = "0 s", assume = "nonnegative" }
    ... blocks.D = { type = "delay", T = "T" }
    ... inputs.u = {}
    ... outputs.y = "u/(1 + D)"
    ... ''')
    >>> bound = pipeline.derive_bound(model, model.transfer_functions)[0]
    >>> without_lengths_of_zero(bound).is_rational
    True
    """
    gone = [kernel for kernel in bound.kernels.kernels if kernel.length.is_zero]
    if not gone:
        return _without_inertia(bound)
    ring = bound.ratio.ring
    images = {kernel.generator: ring.constant(_value(kernel)) for kernel in gone}

    def evaluated(factor: fmpz_mpoly) -> Factored:
        return Factored.polynomial(ring, ring.replaced(factor, images))

    num, den = (part.map_factors(ring, evaluated) for part in (bound.num, bound.den))
    if den.is_zero:
        message = f"the denominator of {bound.name} is zero for these values"
        raise ModelError(Diagnostic("SF231", message, None, "a part needs its length"))
    hidden = [
        HiddenFactor(f, e * known.multiplicity)
        for known in bound.hidden
        for f, e in evaluated(known.polynomial).factors
    ]
    return with_parts(bound, num, den, hidden)


def with_parts(
    bound: BoundTransferFunction, num: Factored, den: Factored, hidden: Sequence[HiddenFactor] = ()
) -> BoundTransferFunction:
    """Return a function with other parts over the same ring, or over one without kernels if that does."""
    ring = bound.ratio.ring
    factors = [f for f, _ in (*num.factors, *den.factors)] + [h.polynomial for h in hidden]
    if not ring.used_in(factors).isdisjoint(bound.kernels.generators):
        return replace(bound, ratio=num / den, parts=(num, den), hidden=tuple(hidden))
    small = Ring(tuple(name for name in ring.names if name not in bound.kernels.generators))
    known = tuple(HiddenFactor(small.taken_over(h.polynomial, ring.names), h.multiplicity) for h in hidden)
    return replace(bound, ratio=(num / den).over(small), hidden=known, kernels=NO_KERNELS, parts=None)


def _without_inertia(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with numbers for waves of massless members; what flows one way keeps its delay."""
    ring, table = bound.ratio.ring, bound.kernels
    still = [
        law for law in table.dispersions if law.characteristic and not any(map(_has_s, law.characteristic))
    ]
    if not still:
        return bound
    delays = [k for k in table.kernels if k.function == "exp" and _has_s(k.dispersion.shift)]
    left = [k for k in table.kernels if k in delays or k.dispersion not in still]
    later = {
        law: replace(law, kind="exponential", characteristic=(), wavenumbers=()) if law in still else law
        for law in table.dispersions
        if any(k.dispersion is law for k in left)
    }
    waves = (*(n for law in later.values() for n in law.wavenumbers), *(k.generator for k in left))
    gone = frozenset(table.generators) - {*waves}
    moving = {0, *(ring.index[name] for name in waves)}

    def by_moving(f: fmpz_mpoly) -> dict[tuple[tuple[int, int], ...], Factored]:
        """Return numbers by what they are multiplied with, in falling powers of s."""
        by_exponents: dict[tuple[tuple[int, int], ...], Factored] = {}
        for monomial, c in terms_of(f):
            key = tuple((i, e) for i, e in monomial if i in moving)
            term = prod((own[i] ** e for i, e in monomial if i not in moving), start=own[0] ** 0 * int(c))
            by_exponents[key] = by_exponents[key] + term if key in by_exponents else term
        return dict(sorted(by_exponents.items(), key=lambda item: -dict(item[0]).get(0, 0)))

    own = [Factored.generator(ring, name) for name in ring.names]
    hidden = [Factored(ring, Fraction(1), ((h.polynomial, h.multiplicity),)) for h in bound.hidden]
    values = (bound.ratio, *hidden)
    most = len(values) + sum(len(by_moving(f)) for v in values for f, _ in v.factors)
    plain = tuple(name for name in ring.names if name not in table.generators)
    small = Ring((*plain, *(f"c[{i}]" for i in range(most)), *waves))
    numbers: list[Factored] = []

    def number(value: Factored) -> Factored:
        numbers.append(value)
        return Factored.generator(small, f"c[{len(numbers) - 1}]")

    def lumped(value: Factored) -> Factored:
        front, image = Factored.number(ring, 1), Factored.number(small, value.unit)
        for f, e in value.factors:
            if ring.used_in([f]).isdisjoint(gone):
                image = image * Factored.polynomial(ring, f).over(small) ** e
                continue
            ((first, lead), *others) = by_moving(f).items()
            total = _monomial(small, ring, first)
            total = sum((number(c / lead) * _monomial(small, ring, key) for key, c in others), total)
            front, image = front * lead**e, image * total**e
        return image if front.is_one else image * number(front)

    def evaluated(value: Factored) -> arb:
        evaluator = bound.kernel_values()
        return at_centre(evaluator.value(value, evaluator.at(acb(1)))).real

    ratio, *known = map(lumped, values)
    delayed = KernelTable(
        tuple(later.values()), tuple(replace(k, dispersion=later[k.dispersion]) for k in left)
    )
    return replace(
        bound,
        ratio=ratio,
        hidden=tuple(
            HiddenFactor(f, e) for v in known for f, e in v.factors if small.used_in([f]) & {LAPLACE, *waves}
        ),
        kernels=delayed.embedded((v, v.over(small)) for v in delayed.values),
        parts=None,
        fixed=tuple((f"c[{i}]", partial(evaluated, value)) for i, value in enumerate(numbers)),
    )


def _has_s(value: Factored) -> bool:
    return value.depends_on(LAPLACE)


def _monomial(small: Ring, ring: Ring, powers: tuple[tuple[int, int], ...]) -> Factored:
    start = Factored.number(small, 1)
    return prod((Factored.generator(small, ring.names[i]) ** e for i, e in powers), start=start)


def _value(kernel: Kernel) -> int:
    if kernel.function == "entry":
        return int(kernel.order % (kernel.dispersion.order + 1) == 0)
    if kernel.function == "fundamental":
        return int(kernel.order == kernel.dispersion.order - 1)
    return int(kernel.function in EVEN)


MOST_TERMS = 3000  # terms of a polynomial in exponentials up to which its squares are sought


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
    factors = []
    for polynomial, times in coordinates.transform(factor).factors:
        if len(polynomial) > MOST_TERMS:
            return None
        is_coordinate = len(polynomial) == 1
        pieces = [(polynomial, 1)] if is_coordinate else square_free_factors(polynomial)[1]
        factors += [(piece, e * times) for piece, e in pieces]
    return factors


def without_reflections(bound: BoundTransferFunction, part: Factored, *, is_hidden: bool = False) -> Factored:
    """Return a product whose roots are the same, with powers of s for what has one exponential left.

    A wave that meets a damper as large as its own impedance is not reflected: ``E A gamma cosh(gamma l) +
    b s sinh(gamma l)`` is a multiple of ``s exp(gamma l)`` for ``b = A sqrt(E rho)``, and has no root but 0,
    where it is hidden none at all: s comes of clearing gamma. What may be otherwise stays as it is; where
    waves have several speeds, or signs of gamma are not told, all of it.
    """
    table, result = bound.kernels, Factored.number(part.ring, part.unit)
    if not table.kernels or any(law.kind != "wave" or not law.shift.is_zero for law in table.dispersions):
        return part
    s, waves = part.ring.generator(LAPLACE), [w for law in table.dispersions for w in law.wavenumbers]
    turning = [*waves, *(k.generator for k in table.kernels if k.function == "sinh")]
    odd = [part.ring.index[name] for name in turning]
    cleared, is_odd = list[tuple[Factored, Factored, int]](), 0
    for factor, exponent in part.factors:
        value = Factored.polynomial(part.ring, factor)
        kernels = [k for k in table.kernels if value.depends_on(k.generator)]
        names = {w for w in waves if value.depends_on(w)} | {k.wavenumber for k in kernels}
        image = _of_one_wave(bound, factor, *names) if len(names) == 1 else None if names else value
        if image is None:
            signs = {sum(int(m[i]) for i in odd) % 2 for m in factor.monoms()}
            if len(waves) > 1 or len(signs) > 1:
                return part
            is_odd = (is_odd + exponent * signs.pop()) % 2
        elif names and not kernels:
            cleared.append((value, image, exponent))
            continue
        elif is_hidden and kernels:
            image = image.filter(lambda f: f != s)
        result = result * (value if image is None else image) ** exponent
    for value, image, exponent in cleared:
        # One power of gamma stays with what changes its sign as gamma does.
        stays = is_odd * (1 if exponent > 0 else -1)
        result = result * value**stays * image ** (exponent - stays)
    return result


def _of_one_wave(bound: BoundTransferFunction, factor: fmpz_mpoly, wavenumber: str) -> Factored | None:
    """Return what a factor is a multiple of, by an exponential and a number, where one of these is left."""
    ring, table = bound.ratio.ring, bound.kernels
    s = Factored.polynomial(ring, ring.context.gen(0))
    law = next(law for law in table.dispersions if law.wavenumbers == (wavenumber,))
    square = -law.characteristic[0]
    arguments, root = arguments_of(table), bound.radicals.either_root(square)
    terms = None if arguments is None else exponential_sum(ring, table, arguments, factor)
    if terms is None or (root is None and (square / s**2).depends_on(LAPLACE)):
        return None
    left: list[Factored] = []
    for amplitude in terms.terms.values():
        even = odd = s * 0
        for monomial, (number, _) in amplitude.items():  # of cosh and sinh all numbers are real
            powers = {ring.names[i]: e for i, e in monomial}
            whole, rest = divmod(powers.pop(wavenumber, 0), 2)
            term = prod((Factored.generator(ring, n) ** e for n, e in powers.items()), start=square**whole)
            even, odd = (even, odd + term * number) if rest else (even + term * number, odd)
        if root is not None:
            total = bound.radicals.reduced(even + odd * root)
            left += [] if total.is_zero else [total]
            continue
        # The wavenumber is s times a number: even + odd gamma is like s to a power, or not told.
        norm = bound.radicals.reduced(even**2 - odd**2 * square)
        left.append(odd * s if even.is_zero else even)
        if norm.is_zero or (norm / left[-1] ** 2).depends_on(LAPLACE):
            return None
    return left[0] if len(left) == 1 else None
