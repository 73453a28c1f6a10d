"""Interval Newton steps: the proof that a box contains exactly one root, and how it is narrowed.

Where ``N(X) = m - f(m)/f'(X)`` lies inside a box X about m, f has exactly one root in X, a simple one, and
N(X) holds it (Moore 1966; Krawczyk 1969 multiplies with an approximate inverse instead, which saves nothing
in one dimension). Example: ``f = x^2 - 2`` on X = 1.4 +- 0.1 has f(m) = -0.04 and f'(X) = 2.8 +- 0.2; the
step f(m)/f'(X) lies between -0.016 and -0.013, well inside, and the root between 1.413 and 1.416.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from flint import acb, arb

Ball = TypeVar("Ball", arb, acb)


def stays_inside(step: arb | acb, reach: arb) -> bool:
    """Tell whether a step ``f(m)/f'(X)`` proves the one root of a box that reaches so far from m.

    The step is enclosed for all slopes on the box; ``reach`` is its exact half side.

    >>> box = arb(1.4, 0.1)
    >>> stays_inside((arb(1.4) ** 2 - 2) / (2 * box), arb(0.1))
    True
    """
    parts = (step,) if isinstance(step, arb) else (step.real, step.imag)
    return step.is_finite() and all(bool(abs(part) < reach) for part in parts)


def narrowed(root: Ball, newton: Callable[[Ball], Ball], steps: int, share: float) -> Ball:
    """Return a smaller box about a root, by steps of an operator as long as they are worth it.

    Where a box contains the root, so does Newton's operator of it. The last of at most so many steps is the
    first that leaves more than a share of the box.

    >>> root = narrowed(arb(1.4, 0.1), lambda x: x.mid() - (x.mid() ** 2 - 2) / (2 * x), 9, 0.5)
    >>> root.rad() < 1e-14 and root.overlaps(arb(2).sqrt())
    True
    """
    for _ in range(steps):
        smaller = newton(root)
        if not smaller.is_finite() or smaller.rad() >= root.rad() * share:
            return smaller if smaller.is_finite() and smaller.rad() < root.rad() else root
        root = smaller
    return root
