"""Opening definitions: from the equations' ring to the one without them.

Input: factored rational functions over the ring of the equations.
Output: the same over a ring that has no generator for definitions, nor for propagators.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from math import prod

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, MEMORY_LIMIT, Factored, Radicals, Ring
from symflex.algebra.ring import TERM_LIMIT
from symflex.budget import spend
from symflex.equations import Equations, radicals_of
from symflex.equations.elimination import Closure
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.model.along import COORDINATE, is_tapered

KERNEL_TERMS = 50_000  # that are reduced: four beams have 29,000, 20 s; a frame of 160,000 2 GB


@dataclass(frozen=True, eq=False)
class Expansion:
    """How values over the ring of some equations are opened."""

    source: Ring  # the equations' own
    plain: Ring  # s, parameters, pi and functions of constants
    ring: Ring  # the same and, of a distributed system, its wavenumbers and kernels
    radicals: Radicals  # the relations of roots over ``ring``
    images: dict[str, Factored] = field(default_factory=dict)  # of definitions and propagators
    most: int = TERM_LIMIT  # terms of one factor

    @staticmethod
    def of(equations: Equations, kept: Collection[str] = (), most: int | None = None) -> Expansion:
        """Return the expansion of some equations, each definition opened once, but for those ``kept``."""
        plain = (
            LAPLACE,
            *(p.name for p in equations.model.parameters),
            *kept,
            "pi",
            *([COORDINATE] if is_tapered(equations.model) else []),
            *(c.generator for c in equations.constants),
        )
        propagation = equations.propagation
        ring = Ring(plain) if propagation is None else Ring((*plain, *propagation.table.generators))
        radicals = radicals_of(ring, equations.constants, equations.model.parameters)
        most = most or (TERM_LIMIT if propagation is None else KERNEL_TERMS)
        made = Expansion(equations.ring, Ring(plain), ring, radicals, most=most)
        if propagation is not None:
            # Propagators contain no definitions, but definitions may hold delays.
            inner = [made.generator(n) for n in propagation.kernel_ring.names]
            for p in propagation.propagators:
                made.images[p.generator] = compose_rational(ring, p.image, inner)
        for name, value in equations.definitions:
            if name not in kept:
                made.images[name] = made.expanded(value)
        return made

    def expanded(self, value: Factored) -> Factored:
        """Return a value over the equations' ring, or with some opened already, with definitions opened."""
        names = value.ring.names
        if self.ring.names == names:
            return self.radicals.tidy(value)
        images = [self.images[n] if n in self.images else self.generator(n) for n in names]
        return self.radicals.tidy(value.map_factors(self.ring, lambda factor: self._open(factor, images)))

    def generator(self, name: str) -> Factored | None:
        """Return a generator of the plain ring, None for a name it does not have."""
        return Factored.generator(self.ring, name) if name in self.ring.index else None

    def _open(self, factor: fmpz_mpoly, images: Sequence[Factored | None]) -> Factored:
        degrees = factor.degrees()
        used = [images[i] for i, d in enumerate(degrees) if int(d)]
        known = [image for image in used if image is not None]
        if len(known) != len(used):
            raise ModelError(Diagnostic("SF215", "a definition uses one that is not resolved yet"))
        if len(factor) == 1:
            return known[0]
        return compose_rational(self.ring, factor, images, self.most)


@dataclass(frozen=True, eq=False)
class Opening:
    """How closed polynomials are opened, sums and definitions, each polynomial once."""

    closure: Closure  # where they live
    expansion: Expansion  # what follows
    _known: list[tuple[fmpz_mpoly, Factored]] = field(default_factory=list)

    def __call__(self, closed: fmpz_mpoly) -> Factored:
        """Return a closed polynomial over the plain ring; SF501 when it would be too large."""
        for known, opened in self._known:
            if known == closed:
                return opened
        opened = self.expansion.expanded(self.closure.open(closed))
        self._known.append((closed, opened))
        return opened


SMALL = 100_000  # number of terms up to which the engine composes at once
HELD = 4  # how many times as many terms as are allowed may be held before they are added up


def compose_rational(
    ring: Ring, factor: fmpz_mpoly, images: Sequence[Factored | None], most: int = TERM_LIMIT
) -> Factored:
    """Return ``factor`` over ``ring`` with images for generators; SF502 far beyond ``most`` terms."""
    most = min(most, MEMORY_LIMIT // ring.bytes_of(1))
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
    held = 0
    for monomial, coefficient in factor.terms():
        spend()
        used = [(i, int(monomial[i])) for i in denominators]
        for i, exponent in used:
            if (i, exponent) not in powers:
                raised = wholes[i] ** exponent * denominators[i] ** (degrees[i] - exponent)
                powers[i, exponent] = raised.expand()
        size = prod(len(powers[each]) for each in used)
        held += size
        if held > HELD * most:
            # Refused before it is made: the engine does not survive running out of memory.
            terms = [_sum(terms, ring)]
            held = len(terms[0]) + size
            if held > most:
                message = f"the closed form would have more than {most} terms before it is reduced"
                hint = "let equal parts share their parameters, or split the model"
                raise BudgetError(Diagnostic("SF502", message, None, hint))
        terms.append(prod((powers[each] for each in used), start=ring.constant(int(coefficient))))
    total = _sum(terms, ring)
    scale = prod((below ** degrees[i] for i, below in denominators.items()), start=Factored.number(ring, 1))
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
