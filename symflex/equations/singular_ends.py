"""Ends where a stiffness vanishes: sharp tips, free ends of hanging strings.

Input: A of ``z' = A z``, and the way h from an end where coefficients have poles.
Output: a :class:`SingularStart`, the solutions that are finite there. In ``z_i = h^powers_i v_i`` the
equations are ``h v' = B v``, B analytic: a regular singular point (Coddington & Levinson 1955, chapter 4).

    a hanging string, N = rho A g h      w' = f/(rho A g h),   f' = rho A s^2 w
    powers (0, 0)                        B = ((0, 1/(rho A g)), (rho A s^2 h, 0))
    at h = 0, 0 = B v                    f = 0; w is free. Where f is not zero, w grows like log(h).

Where B is triangular at h = 0 its diagonal holds the exponents. With none above zero ``k - B`` is regular for
every k > 0, so a solution without logarithms is a power series and follows from its values at h = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, degree_in
from symflex.algebra.dispersion import SingularStart

if TYPE_CHECKING:
    from symflex.library.partial_fractions import Matrix

POWER_LIMIT = 64  # powers of h beyond which a point is irregular: they would grow without end


BRACKETS = "write the equation with brackets, as (E*I*w'')'', so that forces and moments are its states"
CUT = "end the domain before this point"


class UnsolvedEndError(ValueError):
    """Coefficients have poles at an end, and solutions that are finite there are not power series."""

    def __init__(self, message: str, hint: str = CUT) -> None:
        super().__init__(message)
        self.hint = hint


def vanishing_order(value: Factored, h: fmpz_mpoly) -> tuple[int, Factored]:
    """Return how often a linear polynomial is a factor of a value, and the value with it in front.

    >>> from symflex.algebra import Ring
    >>> ring = Ring(("l", "x"))
    >>> l, x = Factored.generator(ring, "l"), Factored.generator(ring, "x")
    >>> order, value = vanishing_order(1 / (l * l - x * x), (l - x).expand())
    >>> order, str(value)
    (-1, '(l - x)^-1*(l + x)^-1')
    """
    order, remainder_factor = 0, Factored.number(value.ring, value.unit)
    for factor, exponent in value.factors:
        cofactor, times = factor, 0
        while len(cofactor) >= len(h) or cofactor == h:
            quotient, remainder = divmod(cofactor, h)
            if not remainder.is_zero():
                break
            cofactor, times = quotient, times + 1
        order += times * exponent
        remainder_factor = remainder_factor * Factored.polynomial(value.ring, cofactor) ** exponent
    return order, Factored.polynomial(value.ring, h) ** order * remainder_factor


def singular_start(
    matrix: Matrix, way: Factored, variable: str, at_start: Callable[[Factored], Factored]
) -> SingularStart | None:
    """Return solutions that are finite at a start of given coefficients, None if all; UnsolvedEndError."""
    size, i = range(len(matrix)), way.ring.index[variable]
    (h,) = (f for f, _ in way.factors if degree_in(f, i))
    places = {(i, j): vanishing_order(x, h) for i, row in enumerate(matrix) for j, x in enumerate(row)}
    orders = {index: order for index, (order, x) in places.items() if not x.is_zero}
    if all(order >= 0 for order in orders.values()):
        return None
    powers = _powers(orders, len(matrix))
    scaled = tuple(
        tuple(
            places[i, j][1] * way ** (1 + powers[j] - powers[i]) - (powers[i] if i == j else 0) for j in size
        )
        for i in size
    )
    leading = [[vanishing_order(x, h) for x in row] for row in scaled]
    first = [[at_start(x) for _, x in row] for row in leading]
    return SingularStart(
        powers,
        tuple(tuple(order for order, _ in row) for row in leading),
        tuple(tuple(x / way**order for order, x in row) for row in leading),
        _values(first, powers),
    )


def _powers(orders: dict[tuple[int, int], int], size: int) -> tuple[int, ...]:
    """Return the least powers with which B has no pole."""
    powers = [0] * size
    while True:
        before = list(powers)
        for (i, j), order in orders.items():
            if i == j and order < -1:
                raise UnsolvedEndError("this is an irregular singular point")
            powers[j] = max(powers[j], powers[i] - 1 - order)
        if max(powers) > POWER_LIMIT:
            raise UnsolvedEndError("this is an irregular singular point")
        if powers == before:
            return tuple(powers)


def _values(first: Sequence[Sequence[Factored]], powers: Sequence[int]) -> Matrix:
    """Return v at h = 0, where ``0 = B v``, per state that is free there."""
    size = range(len(first))
    forms: dict[int, dict[int, Factored]] = {}  # of each state, in those that are free
    held: set[int] = set()
    for i in triangular_order(first):
        exponent = first[i][i]
        if not exponent.is_constant or exponent.unit > 0:
            shown = "depends on parameters or s" if not exponent.is_constant else f"is {exponent.unit}"
            raise UnsolvedEndError(f"an exponent of its solutions there {shown}")
        form: dict[int, Factored] = {}
        for k in (k for k in size if k != i and not first[i][k].is_zero):
            for free, c in forms[k].items():
                form[free] = form.get(free, c * 0) + first[i][k] * c
        form = {free: c for free, c in form.items() if free not in held and not c.is_zero}
        if not exponent.is_zero:
            forms[i] = {free: -c / exponent for free, c in form.items()}
            continue
        forms[i] = {i: exponent + 1}
        if powers[i] or len(form) > 1 or any(c.numerator().depends_on(LAPLACE) for c in form.values()):
            message = "inertia does not vanish with the stiffness, so slopes grow like a logarithm"
            raise UnsolvedEndError(message)
        # What would make a logarithm is zero.
        held.update(form)
    kept = {i: {free: c for free, c in form.items() if free not in held} for i, form in forms.items()}
    zero = first[0][0] * 0
    return tuple(tuple(kept[i].get(j, zero) for j in size) for i in size)


def triangular_order(first: Sequence[Sequence[Factored]]) -> list[int]:
    """Return states so that each row holds only those before it, and the diagonal; UnsolvedEndError."""
    found: list[int] = []
    size = range(len(first))
    while len(found) < len(first):
        ready = [
            i
            for i in size
            if i not in found and all(k == i or k in found or first[i][k].is_zero for k in size)
        ]
        if not ready:
            message = "single coefficients do not show how solutions begin there"
            raise UnsolvedEndError(message, f"{BRACKETS}; or {CUT}")
        found += ready
    return found
