"""A numerator against the determinant of a constrained system: exactly, or root by root.

Input: the determinants of a system, and of the same with a constraint.
Output: a :class:`Relation`, ``num = factor * transmission / apart * constrained determinant``, proved in the
ring of the equations; and where that is out of reach, whether certified roots agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, degree_in
from symflex.algebra.propagators import EXPONENTIAL
from symflex.transfer.expansion import compose_rational
from symflex.transfer.lowest_terms import cancel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.equations import Equations
    from symflex.equations.elimination import Determinants
    from symflex.roots import Root


@dataclass(frozen=True, slots=True, eq=False)
class Relation:
    """``num = constant*factor*transmission/apart * det``, with ``det`` that of the constrained system."""

    order: int  # the power of s in ``factor``, from what the output does to the coordinate it shows
    filtered: Factored  # the rest of ``factor`` that depends on s
    transmission: Factored  # what else the numerator has: zeros that are not poles of the constrained system
    apart: Factored  # what only the constrained system has: poles of it that are not zeros
    has_zeros: bool  # whether the numerator depends on s but for ``factor``
    is_delayed: bool  # the constant holds exponentials of s besides, which have neither zeros nor poles

    @property
    def is_equality(self) -> bool:
        """Whether the zeros are the poles of the constrained system, one for one."""
        return self.transmission.is_constant and self.apart.is_constant


def relate(
    whole: Determinants, pair: tuple[str, str], factor: Factored, constrained: Determinants
) -> Relation | None:
    """Return how the numerator of a pair and the determinant of a constrained system are related.

    ``pair`` is output and input; ``factor`` is what the output multiplies its coordinate with, over the
    equations' ring. ``None`` when the numerator is zero, or when the generators of the two rings differ.
    """
    equations = whole.equations
    if _generators(constrained.equations) != _generators(equations):
        return None
    num = opened(equations, whole.opened(whole.num(*pair)))
    if num.is_zero:
        return None
    own = opened(equations, factor)
    det = opened(equations, constrained.opened(constrained.den))
    rest, _ = cancel(num / own, det)
    above, below = (varying(equations, part) for part in (rest.numerator(), rest.denominator()))
    order = own.exponent_of(equations.ring.generator(LAPLACE))
    filtered = varying(equations, own / Factored.generator(equations.ring, LAPLACE) ** order)
    bare, _ = cancel(num, own.numerator())
    has_zeros = not varying(equations, bare.numerator()).is_constant
    decays = exponentials(equations)
    is_delayed = any(f in decays for f, _ in rest.factors)
    return Relation(order, filtered, above, below, has_zeros, is_delayed)


def _generators(equations: Equations) -> tuple[object, ...]:
    """Return what tells whether generators of equal names mean the same in two systems."""
    waves = equations.propagation
    lengths = () if waves is None else tuple(tuple(map(str, lengths)) for lengths in waves.lengths)
    return equations.ring.names, lengths


def opened(equations: Equations, value: Factored) -> Factored:
    """Return a value over the equations' ring with every definition replaced by what it stands for."""
    ring = equations.ring
    images = [Factored.generator(ring, name) for name in ring.names]
    names: list[str] = []
    for name, definition in equations.definitions:
        embedded = definition if equations.propagation is None else equations.propagation.embed(definition)
        images[ring.index[name]] = _composed(images, embedded, names)
        names.append(name)
    return _composed(images, value, names)


def _composed(images: Sequence[Factored], value: Factored, names: Sequence[str]) -> Factored:
    ring = value.ring
    places = [ring.index[name] for name in names]

    def image(factor: fmpz_mpoly) -> Factored:
        if not any(degree_in(factor, i) for i in places):
            return Factored.polynomial(ring, factor)
        return compose_rational(ring, factor, images)

    return value.map_factors(ring, image)


def varying(equations: Equations, value: Factored) -> Factored:
    """Return the factors that depend on s; exponentials are left out, for they have no zeros."""
    ring, waves = equations.ring, equations.propagation
    places = [ring.index[LAPLACE]]
    if waves is not None:
        places += [ring.index[w] for w in waves.table.wavenumbers]
        places += [ring.index[p.generator] for p in waves.propagators]
    decays = exponentials(equations)
    return value.filter(lambda f: f not in decays and any(degree_in(f, i) for i in places))


def exponentials(equations: Equations) -> list[fmpz_mpoly]:
    """Return the generators that are exponentials of s times a constant, such as delays."""
    waves = equations.propagation
    found = () if waves is None else waves.propagators
    return [equations.ring.generator(p.generator) for p in found if p.order == EXPONENTIAL]


def agree(zeros: Sequence[Root], poles: Sequence[Root]) -> bool:
    """Tell whether two lists of enclosed roots agree: every one overlaps one of the other list.

    Roots at 0 are left out: there the two may differ by a power of s. This proves nothing; it would show
    that two sets differ.
    """
    left, right = (
        [root for root in roots if not root.is_zero for _ in range(root.multiplicity)]
        for roots in (zeros, poles)
    )
    for root in left:
        partner = next((other for other in right if other.enclosure().overlaps(root.enclosure())), None)
        if partner is None:
            return False
        right.remove(partner)
    return not right
