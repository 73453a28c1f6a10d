"""Lowest terms of an element of the field: which factors vanish somewhere, and how often.

``cos x = u^2 - t^2`` and ``sin x = 2 t u``, with ``t`` and ``u`` the sine and cosine of half the argument,
make every function a homogeneous polynomial in t and u, exponentials and roots: there factors are unique.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, Ring, irreducible_factors
from symflex.audit.field import UNIT

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.audit.field import Arithmetic

MOST_TERMS = 20_000


@dataclass(frozen=True, eq=False)
class LowestTerms:
    """A function as a product of irreducible factors that depend on s and have zeros, up to those without."""

    ring: Ring  # with half-angle generators
    # zeros and poles: factors above and below the bar with their multiplicities; s itself is not among them.
    zeros: tuple[tuple[fmpz_mpoly, int], ...]
    poles: tuple[tuple[fmpz_mpoly, int], ...]


def lowest_terms(field: Arithmetic, value: Factored) -> LowestTerms | None:
    """Return a function's factors, ``None`` where roots in them may keep them from being unique."""
    ring = half_angle_ring(field)
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


def half_angle_ring(field: Arithmetic) -> Ring:
    """Return the ring with half angles in place of cosines and sines."""
    return Ring(tuple(n.replace("cos(", "u(").replace("sin(", "t(") for n in field.ring.names))


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
    degrees = part.degrees()
    return any(
        int(d) and n.startswith(("root(", "sum(", UNIT))
        for n, d in zip(field.ring.names, degrees, strict=True)
    )


def _varying(field: Arithmetic) -> list[int]:
    """Return the positions of the generators that depend on s."""
    found = [field.ring.index[LAPLACE]]
    for i, wave in enumerate(field.ground.waves):
        if any(name == LAPLACE or name.startswith("sum(") for name, _ in wave.key):
            found += [field.ring.index[f"{f}({i})"] for f in ("exp", "cos", "sin")]
    return found


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
    """Return a factor in cosines and sines again, ``None`` where it holds only half of one."""
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
