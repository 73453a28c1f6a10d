"""Guesses of the roots of a polynomial: FLINT's Durand-Kerner for low degrees, Laguerre for high ones.

Input: a real polynomial in balls. Output: one guess per root in the closed upper half plane; proving them is
the business of :mod:`symflex.roots.polynomials.discs`. The Durand-Kerner iteration is good to the working
precision, and its time grows with the third power of the degree.

Laguerre's method, with implicit deflation, is good to about double precision. The polynomial is evaluated in
balls, since a chain of 200 masses needs some 400 bits to evaluate at all, but what an iteration decides fits
doubles: corrections, and the sums over the roots already found (Maehly 1954). Each root starts where the last
one ended, so about five iterations find it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from flint import acb, acb_poly, arb

from symflex.budget import Budget, entered_budget
from symflex.roots.polynomials.discs import real_symmetric_roots
from symflex.roots.precision import precision

ITERATIONS = 80
"""For one root; five are enough as a rule."""
CONVERGED = 1e-13
"""Relative step after which none follows."""
STALLED = 1e-6
"""The same where steps do not become shorter any more: next to other roots."""
NEARLY_REAL = 1e-8
"""Relative imaginary part that is taken for zero."""
RESTART = 1e-3
"""How far beside the last root the next search begins."""
FRESH_ANGLES = (0.7, 2.5, 1.6)
"""Of starting points where the first leads nowhere [rad]."""
LARGEST_LOGARITHM = 600.0
"""Of a modulus in doubles."""
KICK_EVERY = 20
"""Steps after which one is turned aside, to leave a cycle."""
DOUBLE_BITS = 64


def propose_by_laguerre(polynomial: acb_poly) -> tuple[acb, ...] | None:
    """Guess the roots of a real polynomial of positive degree; the budget entered is heeded before each step.

    They are exact points with imaginary part positive or exactly zero; None when it does not settle.

    Examples
    --------
    >>> [f"{float(g.imag):.12f}" for g in propose_by_laguerre(acb_poly([-2, 1, -2, 1]))]
    ['1.000000000000', '0.000000000000']
    """
    guesses = tuple(guess_by_laguerre(polynomial, entered_budget()))
    found = sum(1 if guess.imag == 0 else 2 for guess in guesses)
    return guesses if found == polynomial.degree() else None


def guess_by_laguerre(polynomial: acb_poly, budget: Budget) -> Iterator[acb]:
    """Yield one guess after the other, until there are all or it does not settle; SF506 when time is over."""
    degree = int(polynomial.degree())
    shift = _central_exponent(polynomial, degree)
    scaled = acb_poly([polynomial[i] * arb(2) ** (shift * i) for i in range(degree + 1)])
    first, second = scaled.derivative(), scaled.derivative().derivative()
    moduli = _polygon_moduli(scaled, degree)
    found = np.empty(degree, dtype=np.complex128)
    scale = arb(2) ** shift
    known = 0
    start = 0j
    while known < degree:
        # A start next to a cluster drowns in rounding; the Newton polygon tells where the next root may lie.
        starts = (start, *(cmath.rect(moduli[known], angle) for angle in FRESH_ANGLES))
        attempts = (_find_one((scaled, first, second), found[:known], each, budget) for each in starts)
        root = next((each for each in attempts if each is not None), None)
        if root is None:
            return
        if known == degree - 1:
            root = complex(root.real, 0.0)
        found[known] = root
        known += 1
        if root.imag:
            root = complex(root.real, abs(root.imag))
            found[known - 1 : known + 1] = root, root.conjugate()
            known += 1
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
    derivatives_of: tuple[acb_poly, acb_poly, acb_poly],
    found: npt.NDArray[np.complex128],
    start: complex,
    budget: Budget,
) -> complex | None:
    """Return one more root than those found, snapped to the real axis when it is nearly real."""
    p, first, second = derivatives_of
    remaining = int(p.degree()) - len(found)
    z, last = start, complex(math.inf)
    for iteration in range(ITERATIONS):
        budget.spend()
        derivatives = _log_derivatives(p, first, second, z)
        if derivatives is None:
            break
        with np.errstate(all="ignore"):
            inverse = 1 / (z - found[found != z])
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

    Examples
    --------
    >>> [int(g.imag.unique_fmpz()) for g in propose_by_durand_kerner(acb_poly([4, 0, 1]))]
    [2]
    """
    return real_symmetric_roots(acb_poly([polynomial[i].mid() for i in range(len(polynomial))]))
