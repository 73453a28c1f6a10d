"""Enclosures of all roots of a characteristic polynomial, at a point, on a ball or as series.

Coefficients may be wide. The roots of the middle polynomial are isolated, and boxes about them are proved to
hold one root of every polynomial in the ball by the interval Newton operator (Moore 1966).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb, acb_poly, acb_series, arb, ctx

from symflex.transfer.square_root import square_root

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.transfer.monomials import Value

FINER = 2**30
"""Parts of the least distance of two roots to which they are isolated at the second try."""
ROOM = 2
"""Box that is tried about a root, over the step to the root of an outermost polynomial."""
WIDENINGS = 6
GROWTH = 1.5
STEPS = 8
LITTLE = 7 / 8
"""Boxes that Newton's operator makes no smaller than this share are left."""


def characteristic_roots(
    coefficients: Sequence[Value], centred: Sequence[acb] | None = None, *, even: bool = False
) -> tuple[Value, ...] | None:
    """Return enclosures of all roots of ``x^n + ... + c_0``, ``None`` where they cannot be told apart.

    Parameters
    ----------
    coefficients : sequence of acb or acb_series
        ``c_0`` first.
    centred : sequence of acb, optional
        On a wide ball of s, ``c_k(m)`` in its middle, and then ``c_k'(S) (S - m)``: together they say how
        the coefficients move with each other.
    even : bool
        Odd coefficients are zero: the roots come in pairs x, -x, one after the other.
    """
    half = len(coefficients)
    middle, drift = (None, None) if centred is None else (centred[:half], centred[half:])
    step = 2 if even else 1
    roots = _roots(
        coefficients[::step],
        None if middle is None else middle[::step],
        None if drift is None else drift[::step],
    )
    if roots is None:
        return None
    if even:
        roots = [x for root in map(square_root, roots) for x in (root, -root)]
    boxes = [_number(x) for x in roots]
    return tuple(roots) if all(x.is_finite() for x in boxes) and _are_apart(boxes) else None


def _roots(
    coefficients: Sequence[Value], middle: Sequence[acb] | None, drift: Sequence[acb] | None
) -> list[Value] | None:
    base = [_number(c) for c in coefficients]
    if not all(c.is_finite() for c in base):
        return None
    moving = None if middle is None or drift is None else (acb_poly([*middle, acb(1)]), acb_poly(list(drift)))
    polynomial = acb_poly([*base, acb(1)])
    slope = polynomial.derivative()
    boxes = _isolated(polynomial, slope, moving)
    if boxes is None:
        return None
    found: list[Value] = []
    for root in boxes:
        terms = [c[1] * root**i for i, c in enumerate(coefficients) if isinstance(c, acb_series)]
        found.append(acb_series([root, -sum(terms, acb(0)) / slope(root)], 2) if terms else root)
    return found


def _isolated(
    polynomial: acb_poly, slope: acb_poly, moving: tuple[acb_poly, acb_poly] | None
) -> list[acb] | None:
    """Return disjoint boxes, each of which holds one root of every polynomial in the ball."""
    middle = acb_poly([c.mid() for c in polynomial.coeffs()])
    own = middle.derivative()
    try:
        discs = middle.roots()
        exact = [_refined(middle, own, disc) for disc in discs]
        gap = min((abs(a.mid() - b.mid()) for i, a in enumerate(discs) for b in discs[:i]), default=arb(1))
        if not all(root is not None and root.rad() < gap / FINER for root in exact):
            # Told apart, but too roughly for Newton's method.
            exact = [_refined(middle, own, disc) for disc in middle.roots(tol=gap.mid() / FINER)]
    except ValueError:
        return None
    boxes = []
    for root in exact:
        box = None if root is None else _boxed(polynomial, slope, root.mid(), moving)
        if box is None:
            return None
        boxes.append(box)
    return boxes if _are_apart(boxes) else None


def _are_apart(boxes: Sequence[acb]) -> bool:
    return not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def _refined(polynomial: acb_poly, slope: acb_poly, disc: acb) -> acb | None:
    """Return an isolated root to the working precision, by interval Newton steps."""
    root = disc
    for _ in range(ctx.prec.bit_length() + 2):
        middle = root.mid()
        step = middle - polynomial(middle) / slope(root)
        if not step.is_finite():
            return None
        if step.rad() >= root.rad() / 2:
            return step if step.rad() < root.rad() else root
        root = step
    return root


def _boxed(
    polynomial: acb_poly, slope: acb_poly, middle: acb, moving: tuple[acb_poly, acb_poly] | None
) -> acb | None:
    """Return a box that holds one root of every polynomial in a ball, next to a root of the middle one."""
    value = polynomial(middle)
    if moving is not None:
        together = moving[0](middle) + moving[1](middle)
        value = together if together.rad() < value.rad() else value
    reach = ((value / slope(middle)).abs_upper() * ROOM).upper()
    for _ in range(WIDENINGS):
        if not reach.is_finite():
            return None
        box = middle + acb(arb(0, reach), arb(0, reach))
        step = value / slope(box)
        if not step.is_finite():
            return None
        if step == 0:
            return middle
        if step.real.abs_upper() < reach and step.imag.abs_upper() < reach:
            return _narrowed(middle - step, middle, value, slope)
        reach = (reach * GROWTH).upper()
    return None


def _narrowed(root: acb, middle: acb, value: acb, slope: acb_poly) -> acb:
    """Return a smaller box about a root that Newton's operator holds already."""
    for _ in range(STEPS):
        smaller = middle - value / slope(root)
        if not smaller.is_finite() or not smaller.rad() < root.rad() * LITTLE:
            return root
        root = smaller
    return root


def _number(value: Value) -> acb:
    return value[0] if isinstance(value, acb_series) else value
