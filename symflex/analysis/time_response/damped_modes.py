"""Beams that lose energy along their length alone: damped mode by mode, as are those without loss.

Input: a bound transfer function. Output: the same beam without loss, and how each of its modes is damped.

With loss in the material, eta, in what surrounds it, c, and on a foundation, k, bending obeys

    E I (1 + eta s) w'''' + (rho A s^2 + c s + k) w = 0

so that s occurs as ``L = (s^2 + c s + k)/(1 + eta s)`` alone, all over rho A, where it was s^2 without loss,
but for one factor 1/(1 + eta s). If without loss H = sum of w_n/(s^2 + kappa_n), with loss it is

    H = sum of w_n/(s^2 + c s + k + kappa_n (1 + eta s))

What damped modes beyond some number add is bounded by what they would add undamped: a mass on a spring and a
damper never has more energy than it began with, so after a step it is never farther from where it comes to
rest than at first, after an impulse never farther than without the damper.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import acb, arb, arb_poly

from symflex.algebra import Factored, KernelTable, Ring, degree_in
from symflex.analysis.time_response.exponentials import ExponentialTerm
from symflex.roots.problem import polynomial_in_s

if TYPE_CHECKING:
    from collections.abc import Iterable

    from flint import fmpz_mpoly

    from symflex.transfer import BoundTransferFunction

SECOND = 2
"""Order in s of the inertia of a beam."""


@dataclass(frozen=True)
class Damping:
    """How modes are damped: the roots of ``s^2 + c s + k + kappa (1 + eta s)``."""

    undamped: BoundTransferFunction  # the same beam without loss
    inertial: arb_poly  # s^2 + c s + k
    elastic: arb_poly  # 1 + eta s

    @property
    def is_lossy(self) -> bool:
        """Whether energy is lost."""
        return bool(self.inertial[1] != 0 or self.elastic[1] != 0)

    @property
    def is_none(self) -> bool:
        """Whether the beam is the one without loss, and on no foundation."""
        return not self.is_lossy and bool(self.inertial[0] == 0)

    def fading(self, squared: arb, integrations: int, t: arb) -> arb:
        """Return how much of what modes add undamped is left of them at a time, for all kappa from one on.

        With b = c + eta kappa and p the slower pole, ``u = -Re(p) t``, a step leaves at most
        ``(1 + u) exp(-u)``. An impulse leaves ``sqrt(2) exp(-u)`` where b^2 < 2 kappa, as the frequency is
        no less than ``sqrt(kappa/2)``; up to b^2 = 8 kappa no more than ``t exp(-u)`` times sqrt(kappa),
        which is ``sqrt(8) u/t`` at most; and beyond, the poles are 2 sqrt(kappa) apart.
        """
        c, k, eta = self.inertial[1], self.inertial[0], self.elastic[1]
        b = c + eta * squared
        if not (b > 0 and t > 0):
            return arb(0) if t == 0 else arb(1)  # nothing moves at once
        rate = (b / 2).min((squared + k) / b)
        if eta > 0:
            rate = rate.min(1 / eta)
        u = (rate * t).lower()
        if integrations:
            return ((1 + u) * (-u).exp()).min(1).upper()
        return (arb(2).sqrt() * (1 + 2 * u) * (-u).exp()).min(1).upper() if u > 1 else arb(1)

    def terms(self, weight: arb, squared: arb, integrations: int) -> list[ExponentialTerm] | None:
        """Return what ``w/(...)`` over ``s^integrations`` adds for one kappa, without the pole at 0.

        None where its two poles cannot be told apart.
        """
        whole = self.inertial + self.elastic * squared
        half, rest = whole[1] / 2, whole[0]
        spread = half * half - rest
        if spread.contains(0):
            return None
        root = acb(spread).sqrt()
        pairs = [(-half + root, root)] if spread < 0 else [(-half + root, root), (-half - root, -root)]
        share = 2 if spread < 0 else 1
        found = []
        for pole, apart in pairs:
            if rest == 0 and pole.contains(0):
                continue
            found.append(ExponentialTerm(pole, (share * weight / (2 * apart * pole**integrations),)))
        return found


def damping_of(bound: BoundTransferFunction) -> Damping | None:
    """Return a beam without its loss, and the loss; None where s occurs in any other way.

    That is so with masses, springs and dampers at its ends, and with several beams.
    """
    laws = bound.kernels.dispersions
    if len(laws) != 1 or laws[0].kind != "bending" or not laws[0].shift.is_zero:
        return None
    (law,) = laws
    ring, first = bound.ratio.ring, law.characteristic[0]
    kernels = [ring.index[name] for name in bound.kernels.generators]

    def is_plain(factor: fmpz_mpoly) -> bool:
        return not any(degree_in(factor, i) for i in kernels)

    mixed = [f for f, _ in bound.ratio.factors if not is_plain(f)]
    above = _of_s(first.factors, 1)
    below = _of_s(first.factors, -1)
    is_apart = not any(degree_in(f, 0) for f in mixed) and all(c.is_zero for c in law.characteristic[1:])
    if not is_apart or _degree(above) != SECOND or _degree(below) > 1:
        return None
    power = _power(_of_s(((f, e) for f, e in bound.ratio.factors if is_plain(f)), 0), above, below)
    if power is None:
        return None
    # first = stiffness * L, with L = inertial/elastic, both of them normalised.
    lead = _product(ring, ((coefficient_of(bound, f, degree_in(f, 0)), e) for f, e in above))
    low = _product(ring, ((coefficient_of(bound, f, 0), e) for f, e in below))
    if lead.is_zero or low.is_zero:
        return None
    s = Factored.generator(ring, "s")
    scale = (lead / low) ** power / low
    without_loss = _without_s(first) * lead / low * s**2
    calm = replace(law, characteristic=(without_loss, *law.characteristic[1:]))
    table = KernelTable((calm,), tuple(replace(k, dispersion=calm) for k in bound.kernels.kernels))
    num, den = _without_s(bound.num) * scale, _without_s(bound.den)
    num, den = (num * s ** (2 * power), den) if power >= 0 else (num, den * s ** (-2 * power))
    ratio = _without_s(bound.ratio) * scale * s ** (2 * power)
    undamped = replace(bound, ratio=ratio, kernels=table, parts=(num, den), hidden=())
    parts = []
    for factors, normal in ((above, -1), (below, 0)):
        total = arb_poly([1])
        for factor, exponent in factors:
            total = total * polynomial_in_s(bound, factor).enclosure() ** exponent
        parts.append(total * (1 / total[total.degree() if normal else 0]))
    inertial, elastic = parts
    passive = inertial[1] >= 0 and inertial[0] >= 0 and elastic[1] >= 0
    return Damping(undamped, inertial, elastic) if passive else None


Powers = tuple[tuple["fmpz_mpoly", int], ...]
"""Factors that depend on s, and their exponents."""


def _of_s(factors: Iterable[tuple[fmpz_mpoly, int]], sign: int) -> Powers:
    """Return the factors that depend on s with exponents of one sign, made positive; all of them for 0."""
    return tuple((f, e * (sign or 1)) for f, e in factors if degree_in(f, 0) and (not sign or e * sign > 0))


def _degree(factors: Powers) -> int:
    return sum(degree_in(f, 0) * e for f, e in factors)


def _power(plain: Powers, above: Powers, below: Powers) -> int | None:
    """Return m if plain factors are ``L^m/(1 + eta s)``, None if they are not."""
    f, e = above[0]
    power = Fraction(_exponent(plain, f), e)
    if power.denominator != 1:
        return None
    m = int(power)
    for factor, _ in (*plain, *above, *below):
        lost = _exponent(below, factor)
        if _exponent(plain, factor) != m * (_exponent(above, factor) - lost) - lost:
            return None
    return m


def _exponent(factors: Powers, factor: fmpz_mpoly) -> int:
    return next((e for f, e in factors if f == factor), 0)


def _without_s(value: Factored) -> Factored:
    """Return a product without its factors of s alone; those with kernels hold none."""
    return Factored(value.ring, value.unit, tuple((f, e) for f, e in value.factors if not degree_in(f, 0)))


def coefficient_of(bound: BoundTransferFunction, factor: fmpz_mpoly, power: int) -> Factored:
    """Return the coefficient of a power of s."""
    ring = bound.ratio.ring
    terms = {(0, *map(int, m[1:])): int(c) for m, c in factor.terms() if int(m[0]) == power}
    return Factored.polynomial(ring, ring.context.from_dict(terms))


def _product(ring: Ring, factors: Iterable[tuple[Factored, int]]) -> Factored:
    total = Factored.number(ring, 1)
    for value, exponent in factors:
        total = total * value**exponent
    return total
