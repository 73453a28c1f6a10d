"""Arguments of single transfer functions as long as the model's.

The transfer functions of a model share base lengths: with one output at midspan all of them are in kernels of
``l/2``. One that needs only even multiples of such a half is written in kernels of ``l`` again. A member
that is cut at a node has kernels of ``a`` and ``l - a``. With those of the whole length it prints shorter:
``sinh(q)`` with ``q = gamma*l`` for ``cosh(q_1)*sinh(q_2) + sinh(q_1)*cosh(q_2)``.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, product
from math import prod
from operator import add

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Kernel, KernelTable, Ring, composed
from symflex.algebra.normal_form import NormalForm
from symflex.print.forms.arrange import with_squares
from symflex.print.forms.invariants import IMAGINARY, factor_by_factor, in_exponentials, real_powers
from symflex.print.forms.naming import BETA
from symflex.print.forms.notation import Angle, angles_of
from symflex.transfer import TransferFunction

DOUBLINGS = 8  # halvings that are undone at most
LARGE = 300  # number of terms of a factor from which it is left as it is
MOST = 5  # number of lengths of one wavenumber up to which sums of them are tried
HALVES = 4  # multiple of an argument up to which its kernels read as well: a beam's and its middle's
TWO = 2


def economical(tf: TransferFunction) -> TransferFunction:
    """Return a function in kernels of whole lengths, ``sinh(2*q)/2`` for ``sinh(q)*cosh(q)``, if it can."""
    if any(len(factor) > LARGE for factor, _ in tf.ratio.factors):
        return tf
    tf = _without_wavenumbers(tf)
    for _ in range(DOUBLINGS):
        lengths = dict.fromkeys(a.length for a in angles_of(tf.kernels) if is_half(a.length))
        doubled = next((d for length in lengths if (d := _doubled(tf, length)) is not None), None)
        if doubled is None:
            return tf
        tf = doubled
    return tf


def apart(tf: TransferFunction) -> TransferFunction:
    """Return the same function in kernels of two multiples of a base length where it has fewer terms so.

    A sensor at ``3*l/10`` then has kernels of ``l`` and ``3*l/10``, not of ``l/10``: dependent, for print
    alone.
    """
    if any(len(factor) > LARGE for factor, _ in tf.ratio.factors):
        return tf
    used = tf.ratio.ring.used_in(f for f, _ in tf.ratio.factors)
    for kernels in [angle.kernels for angle in angles_of(tf.kernels, used)]:
        angle = next(a for a in angles_of(tf.kernels) if a.kernels == kernels)
        if angle.dispersion.shift.is_zero and (in_two := _in_two(tf, angle)) is not None:
            tf = min(tf, in_two, key=lambda each: _size(each.ratio))
    return tf


def _in_two(tf: TransferFunction, angle: Angle) -> TransferFunction | None:
    """Return a function in kernels of two multiples of one angle, None if no two serve."""
    source = tf.ratio.ring
    other = {f: f"{g} apart {len(source.names)}" for f, g in angle.kernels.items()}
    ring = Ring((*source.names, *other.values()))
    work = Ring((*ring.names, IMAGINARY))
    sums = [in_exponentials(work, work.taken_over(f), angle) for f, _ in tf.ratio.factors]
    real = [{k: x for k, c in each.items() if not (x := real_powers(work, c)).is_zero()} for each, _ in sums]
    multiples = {abs(n) for coefficients in real for key in coefficients for n in key}
    pairs = [(x, y) for x in range(1, max(multiples, default=0)) for y in range(x + 1, max(multiples) + 1)]
    ways = {pair: way for pair in pairs if (way := _as_sums(multiples, pair)) is not None}
    if not ways or (max(multiples) <= HALVES and not angle.wavenumber.startswith(BETA)):
        return None
    below = {n for c, (_, e) in zip(real, tf.ratio.factors, strict=True) if e < 0 for key in c for n in key}

    def rank(pair: tuple[int, int]) -> tuple[bool, bool, int]:
        """Prefer the denominator's lengths to others, whole lengths, and short sums."""
        is_other = any(n % pair[1] for n in below)
        return (
            is_other,
            (angle.length * pair[1]).unit != 1,
            sum(abs(x) + abs(y) for x, y in ways[pair].values()),
        )

    pair = min(ways, key=rank)
    way, lengths, j = ways[pair], [angle.length * n for n in pair], work.generator(IMAGINARY)
    table = list[Kernel]()
    for kernel in tf.kernels.kernels:
        if kernel.generator not in angle.kernels.values():
            table.append(kernel)
            continue
        for names, length in zip((other, angle.kernels), lengths, strict=True):
            table.append(replace(kernel, generator=names[kernel.function], length=length))
    normal = NormalForm(ring, _over(ring, replace(tf.kernels, kernels=tuple(table))))
    kernels = [{f: work.generator(g) for f, g in names.items()} for names in (other, angle.kernels)]

    ratio = Factored.number(ring, tf.ratio.unit)
    for coefficients, (_, halves), (_, exponent) in zip(real, sums, tf.ratio.factors, strict=True):
        total = work.constant(0)
        for (a, b), part in coefficients.items():
            both = zip(kernels, way[a], way[b], strict=True)
            total = total + prod((_power(k, j, x, y) for k, x, y in both), start=part)
        plain = real_powers(work, total).compose(*ring.context.gens(), ring.constant(0), ctx=ring.context)
        ratio = ratio * (normal.reduce(plain) / Factored.number(ring, 2) ** halves) ** exponent
    return replace(tf, reduced=ratio, kernels=normal.table, parts=None)


def _as_sums(multiples: Collection[int], pair: tuple[int, int]) -> dict[int, tuple[int, int]] | None:
    """Return multiples as sums of few of two numbers, None if one of them is no such sum."""
    few = sorted(product(range(-TWO, TWO + 1), repeat=2), key=lambda n: abs(n[0]) + abs(n[1]))
    sums = {x * pair[0] + y * pair[1]: (x, y) for x, y in reversed(few)}
    if not all(n in sums for n in multiples):
        return None
    return {0: (0, 0)} | {
        sign * n: (sign * sums[n][0], sign * sums[n][1]) for n in multiples for sign in (1, -1)
    }


@dataclass(frozen=True, slots=True, eq=False)
class _Sum:
    """A sum of lengths of one wavenumber, or the difference of two."""

    kernels: Mapping[str, str]  # of the sum, generators by function
    parts: tuple[Mapping[str, str], ...]  # of its lengths
    sign: int = 1  # -1 for the first length less the second


def _without_wavenumbers(tf: TransferFunction) -> TransferFunction:
    """Return a function with ``s/c`` for a wavenumber that is no root, except in arguments."""
    images, ring = {}, tf.ratio.ring
    s = Factored.generator(ring, LAPLACE)
    for law in tf.kernels.dispersions:
        if law.kind == "wave":
            square = NormalForm(ring, tf.kernels).power_of(law).map_factors(ring, partial(with_squares, ring))
            order, odd = divmod(square.exponent_of(ring.generator(LAPLACE)), 2)
            rest = square / s ** (2 * order)
            # That of a root is a product with one that is there: s*Z/T for Z = sqrt(T*mu).
            root = None if odd else tf.radicals.root(rest) if tf.radicals else tf.radicals.either_root(rest)
            if root is not None:
                images[law.wavenumbers[0]] = root * s**order
    if not any(tf.ratio.depends_on(wave) for wave in images):
        return tf
    plain = composed(tf.ratio, images).map_factors(ring, partial(with_squares, ring))
    if tf.radicals:
        plain = tf.radicals.in_lowest_terms(plain)[0]
    return replace(tf, reduced=plain, parts=None)


def added(tf: TransferFunction) -> TransferFunction:
    """Return the same function with kernels of sums and differences of its lengths where it is shorter so."""
    if any(len(factor) > LARGE for factor, _ in tf.ratio.factors):
        return tf
    used = tf.ratio.ring.used_in(f for f, _ in tf.ratio.factors)
    own = {(a.wavenumber, a.length): a for a in angles_of(tf.kernels, used) if a.dispersion.shift.is_zero}
    groups: dict[str, list[Factored]] = {}
    for wave, length in own:
        groups.setdefault(wave, []).append(length)
    kernels, sums = list(tf.kernels.kernels), list[_Sum]()
    for wave, lengths in groups.items():
        if len(lengths) > MOST:
            continue
        chosen = [c for n in range(2, len(lengths) + 1) for c in combinations(lengths, n)]
        totals = [(sum(c[1:], c[0]), c, 1) for c in chosen if _is_simpler(sum(c[1:], c[0]), c)]
        if not totals:
            pairs = [pair if _is_ahead(*pair) else pair[::-1] for pair in chosen if len(pair) == TWO]
            totals = [(first - second, (first, second), -1) for first, second in pairs]
        for total, parts, sign in totals:
            angle = own[wave, parts[0]]
            names = {f: f"{f}[{wave},sum {len(sums)}]" for f in angle.kernels}
            own_kernels = (k for k in tf.kernels.kernels if k.generator in angle.kernels.values())
            kernels += [replace(k, generator=names[k.function], length=total) for k in own_kernels]
            sums.append(_Sum(names, tuple(own[wave, part].kernels for part in parts), sign))
    if not sums:
        return tf
    ring = Ring((*tf.ratio.ring.names, *(g for one in sums for g in one.kernels.values())))
    normal = NormalForm(ring, _over(ring, replace(tf.kernels, kernels=tuple(kernels))))

    def image(factor: fmpz_mpoly) -> Factored:
        best = Factored.polynomial(ring, ring.taken_over(factor))
        while True:
            ways = [partial(_put, normal, one, k) for one in sums for k in range(len(one.parts))]
            ways += [partial(_paired, ring, one) for one in sums if len(one.parts) == TWO]
            shorter = min((best.map_factors(ring, way) for way in ways), key=_size)
            if _size(shorter) >= _size(best):
                return best
            best = shorter

    return replace(tf, reduced=tf.ratio.map_factors(ring, image), kernels=normal.table, parts=None)


def _over(ring: Ring, table: KernelTable) -> KernelTable:
    """Return a table over a larger ring."""
    return table.embedded([(value, value.over(ring)) for value in table.values])


def _put(normal: NormalForm, one: _Sum, k: int, factor: fmpz_mpoly) -> Factored:
    """Return a factor without the k-th part of a sum, which follows from the sum and the others."""
    ring, part = normal.ring, one.parts[k]
    images: dict[str, fmpz_mpoly] = {}
    for even, odd, sign in (("cosh", "sinh", 1), ("cos", "sin", -1)):
        if even in part:
            x, y = (ring.generator(one.kernels[f]) for f in (even, odd))
            for other in (p for p in one.parts if p is not part):
                c, s = ring.generator(other[even]), ring.generator(other[odd])
                s = s if one.sign > 0 or k else -s
                x, y = x * c - sign * (y * s), y * c - x * s
            images |= {part[even]: x, part[odd]: y if one.sign > 0 or not k else -y}
    return normal.reduce(ring.replaced(factor, images))


def _paired(ring: Ring, one: _Sum, factor: fmpz_mpoly) -> Factored:
    """Return a factor with ``p*sinh(x + y)`` for ``p*sinh(x)*cosh(y) + p*cosh(x)*sinh(y)``, and the like."""
    terms = {tuple(map(int, powers)): int(x) for powers, x in factor.to_dict().items()}
    first, second = one.parts
    for even, odd, sign in (("cosh", "sinh", 1), ("cos", "sin", -1)):
        if even not in first:
            continue
        c, s, e, o = (ring.generator(p[f]) for p in (first, second) for f in (even, odd))
        for left, right, times, joined in (
            (c * e, s * o, sign * one.sign, even),
            (s * e, c * o, one.sign, odd),
        ):
            monomials = (left, right, ring.generator(one.kernels[joined]))
            removed, other, put = (tuple(map(int, m.degrees())) for m in monomials)
            for powers, x in list(terms.items()):
                rest = tuple(n - m for n, m in zip(powers, removed, strict=True))
                beside, new = (tuple(map(add, rest, p)) for p in (other, put))
                if min(rest) >= 0 and terms.get(powers) == x and terms.get(beside) == times * x:
                    del terms[powers], terms[beside]
                    terms[new] = terms.get(new, 0) + x
    return Factored.polynomial(ring, ring.context.from_dict({p: x for p, x in terms.items() if x}))


def _is_simpler(total: Factored, parts: Sequence[Factored]) -> bool:
    """Tell whether a sum of lengths is shorter than one of them, or whole where they are parts of it."""
    are_parts = all((part / total).is_constant and part.unit.denominator > 1 for part in parts)
    return _terms(total) < max(map(_terms, parts)) or (are_parts and total.unit == 1)


def _is_ahead(first: Factored, second: Factored) -> bool:
    """Tell whether a difference of lengths is as an author would write it: ``l - a``."""
    return (_terms(first), len(str(second))) >= (_terms(second), len(str(first)))


def _terms(length: Factored) -> int:
    return len(length.numerator().expand())


def _size(value: Factored) -> int:
    return sum(len(factor) for factor, _ in value.factors)


def is_half(length: Factored) -> bool:
    """Tell whether a length is a half of what stands in the model."""
    return not length.is_constant and length.unit.denominator % 2 == 0


def _doubled(tf: TransferFunction, length: Factored) -> TransferFunction | None:
    """Return the function in kernels of twice a length, ``None`` when it is not one or nothing is in them."""
    angles = [a for a in angles_of(tf.kernels) if a.length is length]
    ring = tf.ratio.ring
    kernels = [ring.index[g] for a in angles for g in a.kernels.values()]

    def holds(factor: fmpz_mpoly) -> bool:
        return any(int(factor.degrees()[i]) for i in kernels)

    def one(factor: fmpz_mpoly) -> Factored | None:
        return _in_doubles(tf, factor, angles) if holds(factor) else Factored.polynomial(ring, factor)

    def whole(side: fmpz_mpoly) -> Factored | None:
        return _in_doubles(tf, side, angles) if len(side) <= LARGE else None

    if not any(holds(factor) for factor, _ in tf.ratio.factors):
        return None
    result = factor_by_factor(tf.ratio, ring, one, whole)
    if result is None:
        return None
    twice = length * 2
    table = KernelTable(
        tf.kernels.dispersions,
        tuple(
            replace(k, length=twice) if k.wavenumber and k.length is length else k for k in tf.kernels.kernels
        ),
    )
    return replace(tf, reduced=NormalForm(ring, table).reduce_factored(result), kernels=table, parts=None)


def _in_doubles(tf: TransferFunction, factor: fmpz_mpoly, angles: Sequence[Angle]) -> Factored | None:
    """Return a polynomial in kernels of twice the argument."""
    source = tf.ratio.ring
    ring = Ring((*source.names, IMAGINARY))
    work = factor.compose(*(ring.generator(n) for n in source.names), ctx=ring.context)
    halves = 0
    for angle in angles:
        doubled = angle_doubled(ring, work, angle)
        if doubled is None:
            return None
        work, times = doubled
        halves += times
    back = [source.generator(n) for n in source.names]
    plain = work.compose(*back, source.constant(0), ctx=source.context)
    scale = Factored.number(source, 2) ** halves
    return NormalForm(source, tf.kernels).reduce(plain) / scale


def angle_doubled(ring: Ring, work: fmpz_mpoly, angle: Angle) -> tuple[fmpz_mpoly, int] | None:
    """Return 2^n times a polynomial in kernels of twice one angle, and n."""
    coefficients, highest = in_exponentials(ring, work, angle)
    j = ring.generator(IMAGINARY)
    kernels = {f: ring.generator(g) for f, g in angle.kernels.items()}
    total = ring.constant(0)
    for (a, b), part in coefficients.items():
        if part.is_zero():
            continue
        if a % 2 or b % 2:
            return None
        total = total + part * _power(kernels, j, a // 2, b // 2)
    return real_powers(ring, total), highest


def _power(kernels: Mapping[str, fmpz_mpoly], j: fmpz_mpoly, a: int, b: int) -> fmpz_mpoly:
    """Return ``E^a z^b``."""
    c, s = kernels["cosh"], kernels["sinh"]
    grown = (c + s) ** a if a >= 0 else (c - s) ** -a
    if not b:
        return grown
    turned = kernels["cos"] + (1 if b > 0 else -1) * j * kernels["sin"]
    return grown * turned ** abs(b)
