"""Guesses of the simple roots of a real polynomial, and certified discs around them.

Input: a polynomial with ball coefficients. Output: pairwise disjoint discs that together hold all roots.
Guesses only propose; every decision here is ball arithmetic.

The disc of radius n abs(p(z)/p'(z)) about z holds at least one of the n roots, because p'(z)/p(z) is the sum
of the n inverse distances (Laguerre); n such discs that are disjoint hold one each. The roots of a real
polynomial come in conjugate pairs: a disc about a real centre that holds one root holds a real one. Guesses
are therefore listed in the closed upper half-plane only.

For low degrees FLINT's Durand-Kerner guesses: good to the working precision, in a time that grows with the
third power of the degree. For high ones Laguerre's method with implicit deflation does, good to about double
precision. The polynomial is evaluated in balls, since a chain of 200 masses needs some 400 bits to evaluate
at all, but what an iteration decides fits doubles: corrections, and the sums over the roots already found
(Maehly 1954). Each root starts where the last one ended, so about five iterations find it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, arb_poly

from symflex.balls import current_bits, precision
from symflex.budget import spend

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

Proposer = Callable[[acb_poly], tuple[acb, ...] | None]

NEWTON_STEPS = 60  # each doubles the digits of a simple root; more only next to others
GROUPING = 2.0**-30
PELLET_DOUBLINGS = 60  # doublings of a radius until a term outweighs all others
FEW = 12  # discs whose pairs are all compared in balls
CENTRE_STEPS = 40  # that move a disc to the middle of its roots


@dataclass(frozen=True, slots=True)
class Disc:
    """A disc in the closed upper half-plane, or about a centre on the real axis."""

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

    value: acb_poly  # value and slope: the polynomial, its coefficients real balls, and its derivative
    slope: acb_poly
    degree: int  # of the polynomial, known exactly

    @classmethod
    def of(cls, polynomial: acb_poly) -> LevelPolynomial:
        """Return the polynomial with its derivative."""
        return cls(polynomial, polynomial.derivative(), int(polynomial.degree()))

    def shifted(self, centre: acb) -> acb_poly:
        """Return p(centre + x) as a polynomial in x."""
        return self.value(acb_poly([centre, 1]))

    def polish(self, guess: acb, goal: Callable[[acb], arb]) -> Disc:
        """Return the smallest Newton disc met on the way from a guess, at most ``goal`` large if possible."""
        best = Disc(guess, arb("+inf"))
        centre = guess
        for _ in range(NEWTON_STEPS):
            spend()
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
            spend()
            step = shifted[count - 1] / (count * shifted[count])
            if not step.is_finite():
                return None
            moved = (centre - step).mid()
            moved = acb(moved.real) if is_real else moved
            size = step.abs_upper()
            # Where the coefficients' own balls end it, steps stop shrinking long before they are that small.
            is_at_its_end = last <= moved.abs_upper() * GROUPING and not size < last / 2
            if is_at_its_end or size <= moved.abs_upper() * arb(2) ** (16 - current_bits()):
                break
            centre, shifted, last = moved, self.shifted(moved), size
        return centre, shifted

    def surround(self, centre: acb, count: int) -> Disc | None:
        """Return a disc proved by Pellet's test (1881) to hold exactly ``count`` roots about a centre."""
        centred = self._centred(centre, count)
        if centred is None:
            return None
        centre, shifted = centred
        pivot = shifted[count].abs_lower()
        sizes = [abs(shifted[i]).upper() for i in range(self.degree + 1)]
        if not pivot > 0:
            return None
        radius = (arb(2) ** -current_bits() * centre.abs_upper()).upper()
        radius = max([radius, *((sizes[i] / pivot).root(count - i).upper() for i in range(count))])
        others = arb_poly([0 if i == count else size for i, size in enumerate(sizes)])
        for _ in range(PELLET_DOUBLINGS):
            if pivot * radius**count > others(radius):
                return Disc(centre, radius, count)
            radius = (2 * radius).upper()
        return None


def with_mirrors(discs: Sequence[Disc]) -> list[Disc]:
    """Return the discs, each one off the real axis followed by its conjugate."""
    return [each for d in discs for each in ((d,) if d.is_real else (d, d.mirrored()))]


def overlapping_pairs(discs: Sequence[Disc]) -> list[tuple[int, int]]:
    """Return the pairs of discs that are not proved disjoint."""
    # Arrays pay off with more.
    candidates = combinations(range(len(discs)), 2) if len(discs) <= FEW else _near_pairs(discs)
    return [
        (i, j)
        for i, j in candidates
        if not (discs[i].centre - discs[j].centre).abs_lower() > discs[i].radius + discs[j].radius
    ]


def _near_pairs(discs: Sequence[Disc]) -> Iterator[tuple[int, int]]:
    """Yield the pairs of discs that are not disjoint by far, as doubles tell."""
    import numpy as np  # low degrees need none of it

    x = np.array([float(d.centre.real.mid()) for d in discs])
    y = np.array([float(d.centre.imag.mid()) for d in discs])
    r = np.array([float(d.radius.mid()) for d in discs]) * (1 + 1e-10)
    magnitude = np.hypot(x, y)
    for i in range(len(discs) - 1):
        rest = slice(i + 1, None)
        with np.errstate(invalid="ignore", over="ignore"):
            distance = np.hypot(x[rest] - x[i], y[rest] - y[i])
            far = distance > r[rest] + r[i] + 1e-13 * (magnitude[rest] + magnitude[i])
        yield from ((i, int(j)) for j in np.nonzero(~far)[0] + i + 1)


def complete(discs: Sequence[Disc], degree: int) -> bool:
    """Return whether the discs and their conjugates are disjoint and account for all roots."""
    everything = with_mirrors(discs)
    if not all(disc.radius.is_finite() for disc in discs):
        return False
    return sum(d.count for d in everything) == degree and not overlapping_pairs(everything)


def groups(discs: Sequence[Disc]) -> list[tuple[Disc, ...]]:
    """Return discs in groups that touch, by first members; those without a radius by closeness alone."""
    bounded = [
        d if d.radius.is_finite() else Disc(d.centre, (d.centre.abs_upper() * GROUPING).mid()) for d in discs
    ]
    return [tuple(discs[i] for i in indices) for indices in connected(bounded)]


def connected(discs: Sequence[Disc]) -> list[tuple[int, ...]]:
    """Return the indices of the discs in groups that touch each other, directly or through others.

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
    middle = (sum((d.centre for d in group), acb(0)) / len(group)).mid()
    return acb(middle.real) if is_symmetric(group) else middle


def is_symmetric(group: Sequence[Disc]) -> bool:
    """Return whether a group contains a real centre or a conjugate pair."""
    return any(d.is_real for d in group) or any(
        bool(a.centre == b.centre.conjugate()) for i, a in enumerate(group) for b in group[:i]
    )


ITERATIONS = 80  # most iterations for one root; five are enough as a rule
CONVERGED = 1e-13  # relative step after which none follows
STALLED = 1e-6  # the same where steps do not become shorter any more: next to other roots
NEARLY_REAL = 1e-8  # relative imaginary part that is taken for zero
RESTART = 1e-3  # how far beside the last root the next search begins
FRESH_ANGLES = (0.7, 2.5, 1.6)  # angles of further starting points if the first leads nowhere [rad]
LARGEST_LOGARITHM = 600.0  # largest logarithm of a modulus in doubles
KICK_EVERY = 20  # steps after which one is turned aside, to leave a cycle
DOUBLE_BITS = 64


def propose_by_laguerre(polynomial: acb_poly) -> tuple[acb, ...] | None:
    """Guess the roots of a real polynomial of positive degree; the budget entered is heeded before each step.

    They are exact points with imaginary part positive or exactly zero; None when it does not settle.

    >>> [f"{float(g.imag):.12f}" for g in propose_by_laguerre(acb_poly([-2, 1, -2, 1]))]
    ['1.000000000000', '0.000000000000']
    """
    guesses = tuple(guess_by_laguerre(polynomial))
    count = sum(1 if guess.imag == 0 else 2 for guess in guesses)
    return guesses if count == polynomial.degree() else None


def guess_by_laguerre(polynomial: acb_poly) -> Iterator[acb]:
    """Yield one guess after the other, until there are all or it does not settle; SF506 when time is over."""
    import numpy as np

    degree = int(polynomial.degree())
    shift = _central_exponent(polynomial, degree)
    scaled = acb_poly([polynomial[i] * arb(2) ** (shift * i) for i in range(degree + 1)])
    first, second = scaled.derivative(), scaled.derivative().derivative()
    moduli = _polygon_moduli(scaled, degree)
    roots = np.empty(degree, dtype=np.complex128)
    scale = arb(2) ** shift
    known, start = 0, 0j
    while known < degree:
        # A start next to a cluster drowns in rounding; the Newton polygon tells where the next root may lie.
        starts = (start, *(cmath.rect(moduli[known], angle) for angle in FRESH_ANGLES))
        attempts = (_find_one((scaled, first, second), roots[:known], each) for each in starts)
        root = next((each for each in attempts if each is not None), None)
        if root is None:
            return
        root = complex(root.real, 0.0 if known == degree - 1 else abs(root.imag))
        pair = (root, root.conjugate()) if root.imag else (root,)
        roots[known : known + len(pair)] = pair
        known += len(pair)
        yield acb(arb(root.real) * scale, arb(root.imag) * scale)
        start = root * (1 + RESTART) or complex(RESTART)


def _central_exponent(polynomial: acb_poly, degree: int) -> int:
    """Return k such that the roots divided by 2^k have geometric mean about 1, so that doubles hold them."""
    low = next((i for i in range(degree) if polynomial[i].abs_lower() > 0), degree)
    if low == degree:
        return 0
    with precision(DOUBLE_BITS):
        ratio = polynomial[low].abs_upper() / polynomial[degree].abs_upper()
        return round(float(ratio.log().mid()) / math.log(2) / (degree - low))


def _polygon_moduli(polynomial: acb_poly, degree: int) -> list[float]:
    """Return the moduli, ascending, that the Newton polygon of log abs(a_i) gives the roots (Bini 1996)."""
    hull: list[tuple[int, float]] = []
    for i in range(degree + 1):
        size = polynomial[i].abs_lower()
        if not size > 0:
            continue
        with precision(DOUBLE_BITS):
            height = float(size.log().mid())
        while len(hull) > 1 and _turns_up(hull[-2], hull[-1], (i, height)):
            hull.pop()
        hull.append((i, height))
    moduli: list[float] = []
    for (i, low), (j, high) in pairwise(hull):
        slope = (low - high) / (j - i)
        moduli += [math.exp(max(-LARGEST_LOGARITHM, min(LARGEST_LOGARITHM, slope)))] * (j - i)
    return [moduli[0] if moduli else 1.0] * (degree - len(moduli)) + moduli


def _turns_up(a: tuple[int, float], b: tuple[int, float], c: tuple[int, float]) -> bool:
    return (b[1] - a[1]) * (c[0] - a[0]) <= (c[1] - a[1]) * (b[0] - a[0])


def _find_one(
    derivatives_of: tuple[acb_poly, acb_poly, acb_poly], roots: npt.NDArray[np.complex128], start: complex
) -> complex | None:
    """Return one more root than those found, snapped to the real axis when it is nearly real."""
    import numpy as np

    p, first, second = derivatives_of
    remaining = int(p.degree()) - len(roots)
    z, last = start, complex(math.inf)
    for iteration in range(ITERATIONS):
        spend()
        derivatives = _log_derivatives(p, first, second, z)
        if derivatives is None:
            break
        with np.errstate(all="ignore"):
            inverse = 1 / (z - roots[roots != z])
            g = derivatives[0] - complex(inverse.sum())
            h = derivatives[1] - complex((inverse * inverse).sum())
        discriminant = (remaining - 1) * (remaining * h - g * g)
        if not cmath.isfinite(discriminant):
            return None
        spread = cmath.sqrt(discriminant)
        divisor = max(g + spread, g - spread, key=abs)
        if divisor == 0:
            return None
        step = remaining / divisor
        if iteration % KICK_EVERY == KICK_EVERY - 1:
            step *= 0.7 + 0.2j  # leaves a cycle, should there be one
        z -= step
        if not cmath.isfinite(z):
            return None
        settled = CONVERGED if abs(step) < abs(last) else STALLED
        if abs(step) <= settled * abs(z):
            break
        last = step
    else:
        return None
    return complex(z.real, 0.0) if abs(z.imag) <= NEARLY_REAL * abs(z) else z


def _log_derivatives(
    p: acb_poly, first: acb_poly, second: acb_poly, z: complex
) -> tuple[complex, complex] | None:
    """Return p'/p and -(p'/p)', None where p vanishes as far as the precision can tell."""
    point = acb(z.real, z.imag)
    value = p(point)
    slope = first(point) / value
    bend = slope * slope - second(point) / value
    if not bend.is_finite():
        return None
    return (
        complex(float(slope.real.mid()), float(slope.imag.mid())),
        complex(float(bend.real.mid()), float(bend.imag.mid())),
    )


def propose_by_durand_kerner(polynomial: acb_poly) -> tuple[acb, ...] | None:
    """Guess the roots of a real polynomial of positive degree, at the current precision.

    They are exact points with imaginary part positive or exactly zero; None when the roots do not separate.

    >>> [int(g.imag.unique_fmpz()) for g in propose_by_durand_kerner(acb_poly([4, 0, 1]))]
    [2]
    """
    try:
        roots = acb_poly([polynomial[i].mid() for i in range(len(polynomial))]).roots()
    except ValueError:
        return None
    real = [acb(root.real.mid()) for root in roots if root.imag.contains(0)]
    upper = [root.mid() for root in roots if root.imag > 0]
    return (*real, *upper) if len(real) + 2 * len(upper) == polynomial.degree() else None
