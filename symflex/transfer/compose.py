"""Polynomials with rational functions in place of their generators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.algebra import Factored, Ring

SMALL = 100_000
"""Number of terms up to which the engine composes at once."""

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly


def compose_rational(ring: Ring, factor: fmpz_mpoly, images: Sequence[Factored | None]) -> Factored:
    """Return ``factor`` over ``ring`` with the images in place of its generators.

    Parameters
    ----------
    ring : Ring
        Where the images live.
    factor : fmpz_mpoly
        Over any ring with as many generators as there are images.
    images : sequence of Factored or None
        ``None`` where a generator does not occur.
    """
    degrees = [int(d) for d in factor.degrees()]
    if _is_small(factor, images):
        zero = ring.constant(0)
        plain = [
            image.expand() if image is not None and d else zero
            for image, d in zip(images, degrees, strict=True)
        ]
        return Factored.polynomial(ring, factor.compose(*plain, ctx=ring.context))
    denominators = {
        i: image.denominator()
        for i, (d, image) in enumerate(zip(degrees, images, strict=True))
        if d and image is not None
    }
    wholes = {
        i: image * denominators[i]
        for i, image in enumerate(images)
        if image is not None and i in denominators
    }
    powers: dict[tuple[int, int], fmpz_mpoly] = {}
    terms: list[fmpz_mpoly] = []
    for monomial, coefficient in factor.terms():
        term = ring.constant(int(coefficient))
        for i, below in denominators.items():
            exponent = int(monomial[i])
            if (i, exponent) not in powers:
                raised = wholes[i] ** exponent * below ** (degrees[i] - exponent)
                powers[i, exponent] = raised.expand()
            term = term * powers[i, exponent]
        terms.append(term)
    total = _sum(terms, ring)
    scale = Factored.number(ring, 1)
    for i, below in denominators.items():
        scale = scale * below ** degrees[i]
    return Factored.polynomial(ring, total) / scale


def _sum(terms: list[fmpz_mpoly], ring: Ring) -> fmpz_mpoly:
    """Return a sum, in pairs: adding one by one would copy what is there every time."""
    while len(terms) > 1:
        pairs = zip(terms[::2], [*terms[1::2], ring.constant(0)], strict=False)
        terms = [a + b for a, b in pairs]
    return terms[0] if terms else ring.constant(0)


def _is_small(factor: fmpz_mpoly, images: Sequence[Factored | None]) -> bool:
    """Tell whether all images are polynomials, and few enough terms can come of them."""
    most = len(factor)
    for image, degree in zip(images, factor.degrees(), strict=True):
        if not int(degree):
            continue
        if image is None or image.unit.denominator != 1 or any(e < 0 for _, e in image.factors):
            return False
        for polynomial, exponent in image.factors:
            if len(polynomial) > 1:
                most *= len(polynomial) ** (exponent * int(degree))
        if most > SMALL:
            return False
    return True
