"""Lowest terms of an element of the field: which factors vanish, how often, and how it goes at 0.

``cos x = u^2 - t^2`` and ``sin x = 2 t u``, with ``t`` and ``u`` the sine and cosine of half the argument,
make every function a homogeneous polynomial in t and u, exponentials and roots: there factors are unique.
How the ratio of two functions behaves as s tends to zero is known from exact power series.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, irreducible_factors
from symflex.audit.field import UNIT, Arithmetic

MOST_TERMS = 20_000


@dataclass(frozen=True, eq=False)
class LowestTerms:
    """A function as a product of irreducible factors that depend on s and have zeros, up to those without."""

    ring: Ring  # with half-angle generators
    # zeros and poles: factors above and below the bar with their multiplicities; s itself is not among them.
    zeros: tuple[tuple[fmpz_mpoly, int], ...]
    poles: tuple[tuple[fmpz_mpoly, int], ...]


def lowest_terms(field: Arithmetic, value: Factored) -> LowestTerms | None:
    """Return a function's factors, ``None`` if roots in them may keep them from being unique."""
    ring = Ring(tuple(n.replace("cos(", "u(").replace("sin(", "t(") for n in field.ring.names))
    counted: list[tuple[fmpz_mpoly, int]] = []
    for factor, exponent in value.factors:
        polynomial = _half_angles(field, ring, field.reduce(factor))
        if len(polynomial) > MOST_TERMS:
            return None
        for part, times in irreducible_factors(polynomial)[1]:
            if len(part) > 1 and _has_roots(field, part):
                return None
            _count(counted, part, int(times) * exponent)
    varying = _varying(field)
    kept = [(f, e) for f, e in counted if e and _vanishes(field, ring, f, varying)]
    zeros = tuple((f, e) for f, e in kept if e > 0)
    return LowestTerms(ring, zeros, tuple((f, -e) for f, e in kept if e < 0))


def _count(counted: list[tuple[fmpz_mpoly, int]], part: fmpz_mpoly, exponent: int) -> None:
    if int(part.leading_coefficient()) < 0:
        part = -part
    for i, (known, times) in enumerate(counted):
        if known == part:
            counted[i] = (known, times + exponent)
            return
    counted.append((part, exponent))


def _half_angles(field: Arithmetic, ring: Ring, polynomial: fmpz_mpoly) -> fmpz_mpoly:
    waves = range(len(field.ground.waves))
    places = [(field.ring.index[f"cos({i})"], field.ring.index[f"sin({i})"]) for i in waves]
    degrees = [max(int(m[c]) + int(m[s]) for m in polynomial.monoms()) for c, s in places]
    images = [ring.context.gen(i) for i in range(len(ring.names))]
    ones = []
    for c, s in places:
        u, t = images[c], images[s]
        images[c], images[s] = u * u - t * t, 2 * t * u
        ones.append(u * u + t * t)
    parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
    for monomial, coefficient in polynomial.terms():
        exponents = tuple(int(e) for e in monomial)
        missing = tuple(d - exponents[c] - exponents[s] for d, (c, s) in zip(degrees, places, strict=True))
        parts.setdefault(missing, {})[exponents] = int(coefficient)
    total = ring.constant(0)
    for missing, terms in parts.items():
        part = ring.compose(field.ring.context.from_dict(terms), images)
        for one, power in zip(ones, missing, strict=True):
            part = part * one**power
        total = total + part
    return total


def _has_roots(field: Arithmetic, part: fmpz_mpoly) -> bool:
    used = (n for n, d in zip(field.ring.names, part.degrees(), strict=True) if int(d))
    return any(name.startswith(("root(", "sum(", UNIT)) for name in used)


def _varying(field: Arithmetic) -> list[int]:
    """Return the positions of the generators that depend on s."""
    indices = [field.ring.index[LAPLACE]]
    for i, wave in enumerate(field.ground.waves):
        if any(name == LAPLACE or name.startswith("sum(") for name, _ in wave.key):
            indices += [field.ring.index[f"{f}({i})"] for f in ("exp", "cos", "sin")]
    return indices


def _vanishes(field: Arithmetic, ring: Ring, factor: fmpz_mpoly, varying: list[int]) -> bool:
    """Tell whether a factor depends on s and may be zero for some s but 0."""
    degrees = factor.degrees()
    if not any(int(degrees[i]) for i in varying):
        return False
    if len(factor) == 1:
        name = ring.names[next(i for i, d in enumerate(degrees) if int(d))]
        return name.startswith(("u(", "t("))
    for i in range(len(field.ground.waves)):
        u, t = ring.generator(f"u({i})"), ring.generator(f"t({i})")
        if factor == u * u + t * t or factor == t * t + u * u:
            return False
    return True


def full_angles(field: Arithmetic, ring: Ring, factor: fmpz_mpoly) -> Factored | None:
    """Return a factor in cosines and sines again, ``None`` if it holds only half of one."""
    total = field.number(0)
    waves = range(len(field.ground.waves))
    places = [(ring.index[f"u({i})"], ring.index[f"t({i})"]) for i in waves]
    for monomial, coefficient in factor.terms():
        exponents = [int(e) for e in monomial]
        term = field.number(int(coefficient))
        for i, (u, t) in enumerate(places):
            a, b = exponents[u], exponents[t]
            if (a + b) % 2:
                return None
            c, s = (Factored.generator(field.ring, f"{f}({i})") for f in ("cos", "sin"))
            term = term * ((1 + c) / 2) ** (a // 2) * ((1 - c) / 2) ** (b // 2)
            if a % 2:
                term = term * s / 2
            exponents[u] = exponents[t] = 0
        for name, exponent in zip(field.ring.names, exponents, strict=True):
            if exponent:
                term = term * Factored.generator(field.ring, name) ** exponent
        total = total + term
    return field.reduced(total)


TERMS = (8, 16, 32, 64)  # numbers of terms of a power series, tried in turn
LARGEST_FACTOR = 60
MOST_WAVES = 3  # larger factors take too long; the limit is then left open


def behaviour_at_zero(field: Arithmetic, value: Factored) -> tuple[Factored, Fraction] | None:
    """Return ``c`` and ``n`` with ``value ~ c s^n`` as s tends to 0, c free of s; ``None`` if not found."""
    coefficient, order = field.number(value.unit), Fraction(0)
    for factor, exponent in value.factors:
        leading = _leading(field, field.reduce(factor))
        if leading is None:
            return None
        coefficient = coefficient * leading[0] ** exponent
        order += leading[1] * exponent
    return field.reduced(coefficient), order / field.ground.order


def _leading(field: Arithmetic, factor: fmpz_mpoly) -> tuple[Factored, Fraction] | None:
    """Return the coefficient and power of the root of s that dominates a factor."""
    steps = _steps(field)
    sums = any(n.startswith("sum(") for n in field.ring.used_in((factor,)))
    used = [i for i in range(len(steps)) if _holds(field, factor, i)]
    if sums or len(used) > MOST_WAVES or len(factor) > LARGEST_FACTOR or any(steps[i] < 0 for i in used):
        return None
    names = tuple(f"x{i}" for i in range(len(field.ring.names)))
    context = fmpq_mpoly_ctx.get(names, Ordering.lex)
    rational = context.from_dict({tuple(int(e) for e in m): int(c) for m, c in factor.terms()})
    for terms in TERMS:
        images = [context.gen(i) for i in range(len(names))]
        highest = None
        for i in (i for i in used if steps[i]):
            step = steps[i]
            places = [field.ring.index[f"{f}({i})"] for f in ("exp", "cos", "sin")]
            argument = context.gen(places[0]) * context.gen(0) ** step
            images[places[0]], images[places[1]], images[places[2]] = _series(argument, terms)
            highest = min(highest or step * terms, step * terms)
        lowest = _lowest(field, rational.compose(*images, ctx=context), used, highest)
        if lowest is not None or highest is None:
            return lowest
    return None


def _steps(field: Arithmetic) -> list[int]:
    """Return per base argument the power of the root of s in it, -1 where it is more than a power."""
    keys, order = [dict(wave.key) for wave in field.ground.waves], field.ground.order
    are_powers = [not any(name.startswith("sum(") for name in key) for key in keys]
    powers = [int(key.get(LAPLACE, Fraction(0)) * order) for key in keys]
    return [power if is_power else -1 for power, is_power in zip(powers, are_powers, strict=True)]


def _holds(field: Arithmetic, factor: fmpz_mpoly, wave: int) -> bool:
    degrees = factor.degrees()
    return any(int(degrees[field.ring.index[f"{f}({wave})"]]) for f in ("exp", "cos", "sin"))


def _series(x: fmpq_mpoly, terms: int) -> tuple[fmpq_mpoly, fmpq_mpoly, fmpq_mpoly]:
    """Return exp, cos and sin of x up to the power ``terms``."""
    row = [x * 0 + 1]
    for n in range(1, terms + 1):
        row.append(row[-1] * x * fmpq(1, n))
    signed = [-term if n // 2 % 2 else term for n, term in enumerate(row)]
    return sum(row, x * 0), sum(signed[::2], x * 0), sum(signed[1::2], x * 0)


def _lowest(
    field: Arithmetic, expanded: fmpq_mpoly, used: Sequence[int], highest: int | None
) -> tuple[Factored, Fraction] | None:
    """Return the first coefficient, in ascending powers of the root of s, that does not vanish."""
    waves = {field.ring.index[f"exp({i})"]: _monomial(field, i) for i in used}
    by_power: dict[int, list[tuple[tuple[int, ...], Fraction]]] = {}
    for monomial, coefficient in expanded.terms():
        exponents, rational = tuple(map(int, monomial)), Fraction(int(coefficient.p), int(coefficient.q))
        by_power.setdefault(exponents[0], []).append((exponents, rational))
    for power in sorted(by_power):
        if highest is not None and power > highest:
            return None
        total = field.number(0)
        for exponents, rational in by_power[power]:
            term = field.number(rational)
            for i, exponent in enumerate(exponents[1:], start=1):
                if exponent:
                    plain = Factored.polynomial(field.ring, field.ring.context.gen(i))
                    term = term * waves.get(i, plain) ** exponent
            total = total + term
        if not field.is_zero(total):
            return field.reduced(total), Fraction(power)
    return None


def _monomial(field: Arithmetic, wave: int) -> Factored:
    """Return a base argument without s."""
    base = field.ground.waves[wave]
    value = field.number(base.unit)
    for name, exponent in base.key:
        if name == LAPLACE:
            continue
        steps = field.ground.order if name in field.ground.rootable or "(" in name else 1
        value = value * Factored.generator(field.ring, name) ** int(exponent * steps)
    return value
