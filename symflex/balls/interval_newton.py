"""Interval Newton steps in one and two unknowns: the proof that a box has one root, and narrower boxes.

Where ``N(X) = m - f(m)/f'(X)`` lies inside a box X about m, f has exactly one root in X, a simple one, and
N(X) holds it (Moore 1966; Krawczyk 1969 multiplies with an approximate inverse instead, which saves nothing
in one dimension). Example: ``f = x^2 - 2`` on X = 1.4 +- 0.1 has f(m) = -0.04 and f'(X) = 2.8 +- 0.2; the
step f(m)/f'(X) lies between -0.016 and -0.013, well inside, and the root between 1.413 and 1.416.

A complex equation in two real unknowns, such as a frequency and a parameter, is the same with two steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, TypeVar

from flint import acb, arb

from symflex.balls.precision import precision

Ball = TypeVar("Ball", arb, acb)
Pair = tuple[arb, arb]  # two real unknowns, or steps of both
Status = Literal["one", "none", "undecided"]  # how many roots a box is proved to hold
NEWTON_STEPS = 60  # each nearly doubles the digits, so that few are ever taken
STALLED = 0.99  # share of an enclosure that the last step leaves


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


def two_steps(value: acb, by_first: acb, by_second: acb) -> Pair | None:
    """Return Newton's steps of a complex function of two real unknowns; None if the slopes may be parallel.

    ``by_first`` and ``by_second`` are its derivatives. The root is at the middle less the steps.

    >>> steps = two_steps(acb(3, 4), acb(1, 0), acb(0, 2))  # x + 2j y = 0 near (3, 2)
    >>> [float(x) for x in steps]
    [3.0, 2.0]
    """
    determinant = by_first.real * by_second.imag - by_first.imag * by_second.real
    if not determinant.is_finite() or determinant.contains(0):
        return None
    first = value.real * by_second.imag - value.imag * by_second.real
    second = by_first.real * value.imag - by_first.imag * value.real
    return first / determinant, second / determinant


def status_of(steps: Sequence[arb] | None, reaches: Sequence[arb]) -> Status:
    """Return how many roots lie in a box that reaches so far from its middle, by Newton's steps from there.

    The steps are enclosed for all slopes on the box; None where these may be parallel.

    >>> status_of((arb(0.1), arb(0)), (arb(0.2), arb(0.2))), status_of((arb(3), arb(0)), (arb(2), arb(2)))
    ('one', 'none')
    """
    if steps is None or not all(step.is_finite() for step in steps):
        return "undecided"
    pairs = list(zip(steps, reaches, strict=True))
    if any(abs(step) > reach for step, reach in pairs):
        return "none"
    return "one" if all(bool(abs(step) < reach) for step, reach in pairs) else "undecided"


def newton_box(
    steps_on: Callable[[Pair, int], Pair | None], box: Pair, bits: int, wanted: int
) -> tuple[Status, Pair]:
    """Return how many roots a box of two unknowns holds, and if one, a box about it of ``wanted`` bits.

    ``steps_on`` returns :func:`two_steps` from the middle of a box, for all slopes on it, at a precision.
    """
    with precision(bits):
        steps = steps_on(box, bits)
        status = status_of(steps, [x.rad() for x in box])
        if steps is None or status != "one":
            return status, box
        root = _moved(box, steps)
    for _ in range(NEWTON_STEPS):
        known = min(x.rel_accuracy_bits() for x in root)
        if known > wanted:
            break
        enough = min(max(bits, 2 * known + 64), 2 * wanted + bits)
        with precision(enough):
            steps = steps_on(root, enough)
            narrower = root if steps is None else _moved(root, steps)
        if all(y.rad() > x.rad() * STALLED for x, y in zip(root, narrower, strict=True)):
            break
        root = narrower
    return status, root


def _moved(box: Pair, steps: Pair) -> Pair:
    (x, y), (dx, dy) = box, steps
    return x.intersection(x.mid() - dx), y.intersection(y.mid() - dy)
