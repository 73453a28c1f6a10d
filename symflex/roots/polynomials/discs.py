"""Certified discs around the simple roots of a real polynomial.

Input: a polynomial with ball coefficients and guesses of its roots, from any engine. Output: pairwise
disjoint discs that together hold all roots. Guesses only propose; every decision here is ball arithmetic.

The disc of radius n abs(p(z)/p'(z)) about z holds at least one of the n roots, because
p'(z)/p(z) is the sum of the n inverse distances (Laguerre); n such discs that are disjoint hold one each.
The roots of a real polynomial come in conjugate pairs: a disc about a real centre that holds one root
holds a real one. Guesses are therefore listed in the closed upper half plane only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from flint import acb, acb_poly, arb, arb_poly, ctx

from symflex.budget import Budget, entered_budget

Proposer = Callable[[acb_poly], tuple[acb, ...] | None]

NEWTON_STEPS = 60
"""Each doubles the digits of a simple root; more only next to others."""
GROUPING = 2.0**-30
PELLET_DOUBLINGS = 60
"""Of a radius, until a term outweighs all others."""
CENTRE_STEPS = 40
"""That move a disc to the middle of its roots."""


@dataclass(frozen=True, slots=True)
class Disc:
    """A disc in the closed upper half plane, or about a centre on the real axis."""

    centre: acb  # an exact point; imaginary part positive, or exactly zero
    radius: arb  # exact; infinite when nothing could be proved
    count: int = 1  # roots in the disc, once a set of discs is :func:`complete`

    @property
    def is_real(self) -> bool:
        """Whether the centre lies on the real axis."""
        return bool(self.centre.imag == 0)

    def mirrored(self) -> Disc:
        """Return the complex conjugate of the disc."""
        return Disc(self.centre.conjugate(), self.radius, self.count)


@dataclass(frozen=True, slots=True)
class LevelPolynomial:
    """A real polynomial at the current working precision, with its derivative."""

    # value and slope: the polynomial, its coefficients real balls, and its derivative.
    value: acb_poly
    slope: acb_poly
    degree: int  # of the polynomial, known exactly
    budget: Budget = field(default_factory=Budget)  # heeded between evaluations: no limit by default

    @classmethod
    def of(cls, polynomial: acb_poly, budget: Budget | None = None) -> LevelPolynomial:
        """Return the polynomial with its derivative."""
        return cls(polynomial, polynomial.derivative(), int(polynomial.degree()), budget or entered_budget())

    def shifted(self, centre: acb) -> acb_poly:
        """Return p(centre + x) as a polynomial in x."""
        return self.value(acb_poly([centre, 1]))

    def polish(self, guess: acb, goal: Callable[[acb], arb]) -> Disc:
        """Return the smallest Newton disc met on the way from a guess, at most ``goal`` large if possible."""
        best = Disc(guess, arb("+inf"))
        centre = guess
        for _ in range(NEWTON_STEPS):
            self.budget.spend()
            step = self.value(centre) / self.slope(centre)
            if not step.is_finite():
                break
            radius = (self.degree * step).abs_upper()
            if not radius < best.radius / 2:
                break
            best = Disc(centre, radius)
            if radius <= goal(centre):
                break
            centre = (centre - step).mid()
            if guess.imag == 0:
                centre = acb(centre.real)
        return best

    def _centred(self, centre: acb, count: int) -> tuple[acb, acb_poly] | None:
        """Return a nearby zero of the derivative of order ``count - 1``, and p expanded about it."""
        is_real = centre.imag == 0
        shifted = self.shifted(centre)
        last = arb("+inf")
        for _ in range(CENTRE_STEPS):
            self.budget.spend()
            step = shifted[count - 1] / (count * shifted[count])
            if not step.is_finite():
                return None
            moved = (centre - step).mid()
            moved = acb(moved.real) if is_real else moved
            size = step.abs_upper()
            # Where the coefficients' own balls end it, steps stop shrinking long before they are that small.
            is_at_its_end = last <= moved.abs_upper() * GROUPING and not size < last / 2
            if is_at_its_end or size <= moved.abs_upper() * arb(2) ** (16 - ctx.prec):
                break
            centre, shifted, last = moved, self.shifted(moved), size
        return centre, shifted

    def separate(
        self, centre: acb, count: int, goal: Callable[[acb], arb], proposers: Sequence[Proposer]
    ) -> tuple[Disc, ...] | None:
        """Tell apart ``count`` roots close to a centre by the roots of the local Taylor polynomial.

        The centre is exact, and on the real axis when the cluster is its own mirror image; then discs are in
        the closed upper half plane. ``goal`` is that of :meth:`polish`. None when no proposer, which guess
        the roots of a local polynomial with real coefficients, tells the roots apart.
        """
        is_real = centre.imag == 0
        centred = self._centred(centre, count)
        if centred is None:
            return None
        centre, shifted = centred
        size = (shifted[0] / shifted[count]).abs_upper().root(count).mid()
        if not (size.is_finite() and size > 0):
            return None
        local = acb_poly([(shifted[i] * size**i).mid() for i in range(count + 1)])
        answers = (propose(local) for propose in proposers) if is_real else iter([all_roots(local)])
        guesses = next((answer for answer in answers if answer is not None), None)
        if guesses is None:
            return None
        return tuple(self.polish((centre + size * guess).mid(), goal) for guess in guesses)

    def surround(self, centre: acb, count: int) -> Disc | None:
        """Return a disc proved by Pellet's test to hold exactly ``count`` roots about a centre.

        Source: Pellet (1881): abs(a_k) r^k > sum over i != k of abs(a_i) r^i.
        """
        centred = self._centred(centre, count)
        if centred is None:
            return None
        centre, shifted = centred
        pivot = shifted[count].abs_lower()
        sizes = [abs(shifted[i]).upper() for i in range(self.degree + 1)]
        if not pivot > 0:
            return None
        radius = (arb(2) ** -ctx.prec * centre.abs_upper()).upper()
        for i in range(count):
            scale = (sizes[i] / pivot).root(count - i).upper()
            radius = scale if scale > radius else radius
        others = arb_poly([0 if i == count else size for i, size in enumerate(sizes)])
        for _ in range(PELLET_DOUBLINGS):
            if pivot * radius**count > others(radius):
                return Disc(centre, radius, count)
            radius = (2 * radius).upper()
        return None


def all_roots(polynomial: acb_poly) -> tuple[acb, ...] | None:
    """Return the roots' midpoints at the current precision, None when they do not separate."""
    try:
        return tuple(root.mid() for root in polynomial.roots())
    except ValueError:
        return None


def real_symmetric_roots(polynomial: acb_poly) -> tuple[acb, ...] | None:
    """Return the roots of a real polynomial in the closed upper half plane, as midpoints.

    None when the current precision does not separate the roots.
    """
    try:
        roots = polynomial.roots()
    except ValueError:
        return None
    real = [acb(root.real.mid()) for root in roots if root.imag.contains(0)]
    upper = [root.mid() for root in roots if root.imag > 0]
    if len(real) + 2 * len(upper) != polynomial.degree():
        return None
    return (*real, *upper)


def with_mirrors(discs: Sequence[Disc]) -> list[Disc]:
    """Return the discs, each one off the real axis followed by its conjugate."""
    return [each for d in discs for each in ((d,) if d.is_real else (d, d.mirrored()))]


def overlapping_pairs(discs: Sequence[Disc]) -> list[tuple[int, int]]:
    """Return the pairs of discs that are not proved disjoint.

    Double precision clears the pairs that are far apart, with a margin that covers its rounding; balls
    decide the others at the current precision.
    """
    x = np.array([float(d.centre.real.mid()) for d in discs])
    y = np.array([float(d.centre.imag.mid()) for d in discs])
    r = np.array([float(d.radius.mid()) for d in discs]) * (1 + 1e-10)
    magnitude = np.hypot(x, y)
    pairs: list[tuple[int, int]] = []
    for i in range(len(discs) - 1):
        rest = slice(i + 1, None)
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.hypot(x[rest] - x[i], y[rest] - y[i])
            far = distance > r[rest] + r[i] + 1e-13 * (magnitude[rest] + magnitude[i])
        for j in np.nonzero(~far)[0] + i + 1:
            gap = (discs[i].centre - discs[int(j)].centre).abs_lower()
            if not gap > discs[i].radius + discs[int(j)].radius:
                pairs.append((i, int(j)))
    return pairs


def complete(discs: Sequence[Disc], degree: int) -> bool:
    """Return whether the discs and their conjugates are disjoint and account for all roots."""
    everything = with_mirrors(discs)
    if not all(disc.radius.is_finite() for disc in discs):
        return False
    return sum(d.count for d in everything) == degree and not overlapping_pairs(everything)


def groups(discs: Sequence[Disc]) -> list[tuple[Disc, ...]]:
    """Return the discs in groups that touch each other, ordered by their first member.

    A disc without a finite radius, as a multiple root has, is grouped by closeness alone; that is a
    proposal, which :meth:`LevelPolynomial.separate` and :meth:`LevelPolynomial.surround` prove or refuse.
    """
    bounded = [
        d if d.radius.is_finite() else Disc(d.centre, (d.centre.abs_upper() * GROUPING).mid()) for d in discs
    ]
    return [tuple(discs[i] for i in indices) for indices in connected(bounded)]


def connected(discs: Sequence[Disc]) -> list[tuple[int, ...]]:
    """Return the indices of the discs in groups that touch each other, directly or through others.

    Examples
    --------
    >>> connected([Disc(acb(0), arb(1)), Disc(acb(3), arb(1)), Disc(acb(4), arb(0.5))])
    [(0,), (1, 2)]
    """
    parent = list(range(len(discs)))

    def first_of(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for i, j in overlapping_pairs(discs):
        a, b = sorted((first_of(i), first_of(j)))
        parent[b] = a
    members: dict[int, list[int]] = {}
    for i in range(len(discs)):
        members.setdefault(first_of(i), []).append(i)
    return [tuple(group) for group in members.values()]


def middle_of(group: Sequence[Disc]) -> acb:
    """Return the mean of the centres, exactly real for a group that is its own mirror image."""
    total = sum((d.centre for d in group), acb(0))
    middle = (total / len(group)).mid()
    return acb(middle.real) if is_symmetric(group) else middle


def is_symmetric(group: Sequence[Disc]) -> bool:
    """Return whether a group contains a real centre or a conjugate pair."""
    return any(d.is_real for d in group) or any(
        bool(a.centre == b.centre.conjugate()) for i, a in enumerate(group) for b in group[:i]
    )
