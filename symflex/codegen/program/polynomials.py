"""Integer polynomials as nested products and sums: few operations, and no term computed twice.

Input: an exact polynomial and an expression for each of its generators.
Output: an expression on the forge.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.codegen.program.forge import Forge

Monomial = tuple[int, ...]
Terms = dict[Monomial, int]
"""Exponents of the generators, and what stands in front: an integer, or an expression on the forge."""


@dataclass(frozen=True)
class RingValues:
    """What stands for the generators of a ring."""

    # An expression for each generator; that of the Laplace variable is s, or 1/s in the far branch.
    values: tuple[int, ...]
    degrees: tuple[int, ...]  # degree in s of each generator: 1 for s, 0 for a parameter
    pi: int  # position of the generator pi
    is_far: bool  # true when ``values`` are the generators over ``s**degree``, in powers of 1/s


def degree_of(polynomial: fmpz_mpoly, degrees: Sequence[int]) -> int:
    """Return the degree in s when every generator has its own degree in s."""
    return max(sum(int(e) * d for e, d in zip(m, degrees, strict=True)) for m in polynomial.monoms())


def evaluate_polynomial(forge: Forge, polynomial: fmpz_mpoly, images: RingValues) -> int:
    """Return the expression of a polynomial; of ``polynomial / s**degree`` in the far branch.

    Powers of s follow Horner's rule, and coefficients depend on parameters only wherever they can.
    """
    groups: dict[Monomial, Terms] = {}
    total = degree_of(polynomial, images.degrees)
    varying = [i for i, d in enumerate(images.degrees) if d]
    for exponents, coefficient in polynomial.terms():
        monomial = tuple(int(e) for e in exponents)
        degree = sum(e * d for e, d in zip(monomial, images.degrees, strict=True))
        key = [monomial[i] for i in varying]
        if images.is_far:
            key[0] = total - degree
        fixed = tuple(0 if d else e for e, d in zip(monomial, images.degrees, strict=True))
        groups.setdefault(tuple(key), {})[fixed] = int(coefficient)
    terms = {key: _coefficient(forge, group, images) for key, group in groups.items()}
    return _collect(forge, terms, [images.values[i] for i in varying])


def _collect(forge: Forge, terms: Mapping[Monomial, int], values: Sequence[int]) -> int:
    """Return a sum by descending powers of the first value, the Laplace variable, by Horner's rule."""
    parts: dict[int, Terms] = {}
    for monomial, coefficient in terms.items():
        parts.setdefault(monomial[0], {})[(0, *monomial[1:])] = coefficient
    exponents = sorted(parts, reverse=True)
    result = _nest(forge, parts[exponents[0]], values)
    for higher, lower in pairwise(exponents):
        raised = forge.power(values[0], higher - lower)
        result = forge.add([forge.multiply([result, raised]), _nest(forge, parts[lower], values)])
    return forge.multiply([result, forge.power(values[0], exponents[-1])])


def _coefficient(forge: Forge, terms: Terms, images: RingValues) -> int:
    """Return a polynomial in parameters."""
    numbers: Terms = {}
    for monomial, integer in terms.items():
        rest = tuple(0 if i == images.pi else e for i, e in enumerate(monomial))
        number = forge.constant(integer, monomial[images.pi])
        numbers[rest] = forge.add([numbers[rest], number]) if rest in numbers else number
    return _nest(forge, numbers, images.values)


def _nest(forge: Forge, terms: Mapping[Monomial, int], values: Sequence[int]) -> int:
    """Return a sum of products, the generator that most terms share taken out first, and so on inside."""
    common = tuple(map(min, zip(*terms, strict=True)))
    rest = {tuple(e - c for e, c in zip(m, common, strict=True)): k for m, k in terms.items()}
    outside = [forge.power(v, e) for v, e in zip(values, common, strict=True) if e]
    if len(rest) == 1:
        return forge.multiply([*rest.values(), *outside])
    coefficients = set(rest.values())
    if len(coefficients) == 1:
        outside = [coefficients.pop(), *outside]
        rest = dict.fromkeys(rest, forge.constant(1))
    summands: list[int] = []
    while rest:
        counts = [sum(1 for m in rest if m[i]) for i in range(len(values))]
        most = max(counts)
        if most < 2:  # noqa: PLR2004
            summands += [_nest(forge, {m: k}, values) for m, k in rest.items()]
            break
        i = counts.index(most)
        inside = {m: k for m, k in rest.items() if m[i]}
        rest = {m: k for m, k in rest.items() if not m[i]}
        summands.append(_nest(forge, inside, values))
    return forge.multiply([*outside, forge.add(summands)])
