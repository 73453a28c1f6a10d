"""The proof that no root of one side is missing: its domain is counted by its boundary.

Found within 100 rad/s are a double root at 0 and j 3.5, -j 3.5. The argument turns four times on that circle:
they are all. Were it six times, two would be missing, and the domain is searched with every count proved.

Domains are cells of ln(s), less holes where roots accumulate. A search keeps to the upper half-plane, for
functions whose roots mirror each other in the imaginary axis to a quarter of the plane; what is counted is
the ring that mirror images make of it.

How often 0 is a root, as of ``s sinh(s) - s^2``, which vanishes like s^4/6, is read off series over a prime
field where every wavenumber has a formula; else circles about 0 are counted.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, log, pi

from flint import acb, arb

from symflex.algebra import Factored
from symflex.balls import precision
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.axes.lossless import LosslessSearch
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.region import Band, Rectangle, Region
from symflex.roots.root import FLOAT_BITS, TOUCHING, Root, are_apart, count_roots, root_at_zero

UNPROVED = "the number of roots could not be proved"


@dataclass(frozen=True, slots=True)
class Proof:
    """Whether the roots of one side are all there."""

    counted: int  # roots in the domain searched, by a certified count; those found where there is none
    found: int  # roots proved there
    reason: str | None = None  # why the count is not certified

    @property
    def is_complete(self) -> bool:
        """The count is certified, and every root was found."""
        return self.reason is None and self.counted == self.found


@dataclass(frozen=True, slots=True)
class Count:
    """Counts the roots of one function with kernels by boundaries."""

    winding: CertifiedWinding[KernelFunction]  # counts with proof
    order: int  # to which the function vanishes at s = 0
    holes: tuple[Cell, ...]  # what is left out of every domain
    left: float  # pi, or pi/2 where roots mirror each other in the imaginary axis
    lossless: LosslessSearch | None = None  # counts on arcs more quickly

    @property
    def whole(self) -> float:
        """Up to which arg(s) a domain reaches that mirror images make a ring; none does without."""
        return self.left if self.winding.function.is_paired else inf

    def within(self, z: float) -> int:
        """Return how many roots lie within exp(z), those at 0 included; else RootOnPathError."""
        if self.lossless is not None:
            return self.lossless.count(z) + self.order
        return self.winding.count_within(z, self.left)

    def is_empty_within(self, z: float | None) -> bool:
        """Tell whether it is proved that no roots but those at 0 lie within exp(z), a disc not searched."""
        try:
            return z is None or self.winding.count_within(z, self.left) == self.order
        except RootOnPathError:
            return False

    def turns(self, domain: Cell) -> int:
        """Return how often the function winds about 0 on the boundary of a domain without its holes."""
        cells, holes = parts(domain, self.whole, self.holes)
        if not is_whole_ring(domain, self.whole, self.holes):
            return sum(self.winding.count(cell) for cell in cells)
        turns = self.within(domain.high)
        if domain.low > -inf:
            turns -= self.within(domain.low)
        return turns - sum(self.winding.count(hole) for hole in holes)

    def proof(
        self, domain: Cell, located: Sequence[Root], at_zero: Sequence[Root], innermost: float | None
    ) -> Proof:
        """Count the domain that was searched, but ``innermost``, and compare with all roots and images."""
        if not are_apart(located):
            count = count_roots(located)
            return Proof(count, count, TOUCHING)
        cells, holes = parts(domain, self.whole, self.holes)
        count, unsure = 0, False
        deciders, hole_deciders = [decider(cell) for cell in cells], [decider(hole) for hole in holes]
        for root in located:
            positions = [is_inside(root) for is_inside in deciders]
            unsure = unsure or (not any(positions) and None in positions)
            if any(positions) and not any(is_inside(root) for is_inside in hole_deciders):
                count += root.multiplicity
        if unsure:
            return Proof(count, count, "a root lies on the boundary of what was searched")
        is_disc = domain.low == -inf
        try:
            turns = self.turns(domain) - (self.order if is_disc else 0)
        except RootOnPathError:
            return Proof(count, count, UNPROVED)
        counted, rest = divmod(turns, self.winding.function.power)
        if rest or not (is_disc or self.is_empty_within(innermost)):
            return Proof(count, count, UNPROVED)
        return Proof(counted + (count_roots(at_zero) if is_disc else 0), count)

    def right(self, high: float, angle: float = pi / 2) -> int:
        """Return how many roots are in the right half-plane, or a sector, with ln(abs(s)) below ``high``."""
        winding = CertifiedWinding(self.winding.function, tries_series=True)
        low = min(winding.smallest(pi, self.holes), high - 1.0)
        if winding.count_within(low, pi) != self.order:
            raise RootOnPathError
        counted, rest = divmod(winding.count_right(low, high, angle), winding.function.power)
        if rest:
            raise RootOnPathError
        return counted


NEIGHBOURHOOD = 0.05  # size of a neighbourhood where roots accumulate, relative to its distance from 0
WIDER = 1e-3  # how far beyond its limits, in ln, a ring is searched


def holes_about(points: Sequence[complex]) -> tuple[Cell, ...]:
    """Return neighbourhoods of points, those that meet as one.

    >>> (hole,) = holes_about([1 + 0j, 1.01 + 0j])
    >>> round(hole.low, 6), round(hole.high, 6)
    (-0.05, 0.05995)
    """
    holes: list[Cell] = []
    for point in points:
        z, e = complex(log(abs(point)), phase(point)), NEIGHBOURHOOD
        joined = Cell(z.real - e, z.real + e, z.imag - e, z.imag + e)
        while meeting := next((h for h in holes if _meet(h, joined)), None):
            holes.remove(meeting)
            joined = Cell(
                min(meeting.low, joined.low),
                max(meeting.high, joined.high),
                min(meeting.right, joined.right),
                max(meeting.left, joined.left),
            )
        holes.append(joined)
    return tuple(holes)


def _meet(a: Cell, b: Cell) -> bool:
    along = a.low <= b.high and b.low <= a.high
    return along and a.right <= b.left and b.right <= a.left


def is_whole_ring(cell: Cell, left: float, holes: Sequence[Cell]) -> bool:
    """Tell whether a cell and its mirror images, up to ``left``, make a ring whose circles pass by holes."""
    return (
        cell.right <= 0
        and cell.left >= left
        and all(
            hole.high < cell.low or hole.low > cell.high or (cell.low < hole.low and hole.high < cell.high)
            for hole in holes
        )
    )


def parts(domain: Cell, left: float, holes: Sequence[Cell]) -> tuple[tuple[Cell, ...], tuple[Cell, ...]]:
    """Return the cells that were searched, and the holes in them, mirror images included."""
    if is_whole_ring(domain, left, holes):
        cell = Cell(domain.low, domain.high, -pi, pi)
        met = [h for h in holes if h.low < cell.high and h.high > cell.low]
        return (cell,), tuple(image for hole in met for image in _images(hole))
    cells: tuple[Cell, ...] = (domain,)
    for hole in holes:
        cells = tuple(part for whole in cells for part in whole.without(hole))
    return cells, ()


def _images(hole: Cell) -> tuple[Cell, ...]:
    """Return a neighbourhood in the closed upper half-plane and, off the real axis, its mirror image."""
    if hole.right <= 0 <= hole.left or hole.right <= pi <= hole.left:
        return (hole,)
    return (hole, Cell(hole.low, hole.high, -hole.left, -hole.right))


def decider(cell: Cell) -> Callable[[Root], bool | None]:
    """Return what tells whether a root lies in a cell, ``None`` where its enclosure does not decide that."""
    with precision(FLOAT_BITS):
        low, high = arb(cell.low).exp(), arb(cell.high).exp()

    def is_inside(root: Root) -> bool | None:
        if root.is_zero:
            return cell.low == -inf
        size = root.natural_frequency()
        if size < low or size > high:
            return False
        is_ring = cell.right <= -pi and cell.left >= pi
        is_between = True if is_ring else _is_between(cell, root)
        is_above = cell.low == -inf or bool(size > low)
        return is_between and (True if is_above and size < high else None)

    return is_inside


def _is_between(cell: Cell, root: Root) -> bool | None:
    """Tell whether the argument of a root lies between those of a cell's sides."""
    with precision(FLOAT_BITS):
        # Measured from the middle of the cell, the argument does not jump on it.
        middle = acb(0, (cell.right + cell.left) / 2).exp()
        turned = (root.enclosure() / middle).arg()
        half = (cell.left - cell.right) / 2
        if turned > half or turned < -half:
            return False
        return True if turned < half and turned > -half else None


def limits(region: Region, *, is_even: bool) -> tuple[float, float, float, float]:
    """Return the ln(abs(s)) and arg(s) that bound a band or rectangle in the upper half-plane."""
    match region:
        case Band(low, high):
            return _log(2 * pi * low) - WIDER, _log(2 * pi * high) + WIDER, 0.0, pi
        case Rectangle(re_low, re_high, im_low, im_high):
            across = abs(float(re_low)), abs(float(re_high))
            along = abs(float(im_low)), abs(float(im_high))
            bottom = 0.0 if im_low <= 0 <= im_high else min(along)
            corners = [complex(float(re), im) for re in (re_low, re_high) for im in (bottom, max(along))]
            nearest = complex(0.0 if re_low <= 0 <= re_high else min(across), bottom)
            inner, outer = _log(abs(nearest)) - WIDER, _log(max(map(abs, corners))) + WIDER
            if is_even or not nearest:
                return inner, outer, 0.0, pi
            return inner, outer, min(map(phase, corners)), max(map(phase, corners))
    raise TypeError(f"no search for {type(region).__name__}")


def _log(size: float) -> float:
    return log(size) if size > 0 else -inf


SAME = 0.5  # largest distance from a whole number of an order that is read off doubles
DEPTHS = (1.0, 4.0, 16.0, 64.0)  # how far below the lowest root, in ln, circles about 0 are counted


def roots_at_zero(
    winding: CertifiedWinding[KernelFunction],
    part: Factored,
    left: float,
    holes: Sequence[Cell],
    *,
    is_hidden: bool,
) -> tuple[list[Root], int]:
    """Return the root at s = 0 of ``part``, and the turns of the function without powers of s; SF404."""
    function = winding.function
    power = function.power
    s = part.ring.context.gen(0)
    powers, exact = part.exponent_of(s), function.order()
    coefficients = [c for law in function.bound.kernels.dispersions for c in law.characteristic]
    has_length = any(not c.is_zero and not c.exponent_of(s) for c in coefficients)
    if has_length and not is_hidden and exact is not None and abs(function.order_at_zero() - exact) > SAME:
        exact = None  # waves with a length at s = 0 may fit: a column at its buckling load
    if exact is not None and (is_hidden or exact % power == 0):
        return root_at_zero(powers if is_hidden else powers + exact // power), exact
    z, turns = turns_about_zero(winding, left, holes)
    # So many roots lie this close to 0, and nothing says that they are 0.
    with precision(FLOAT_BITS):
        reach = arb(z).exp().upper() if turns and not is_hidden else 0
    return root_at_zero(powers if is_hidden else powers + turns, reach), turns * power


def turns_about_zero(
    winding: CertifiedWinding[KernelFunction], left: float, holes: Sequence[Cell]
) -> tuple[float, int]:
    """Return ln of a small radius, and how many roots are proved to lie within it."""
    lowest = winding.smallest(left, holes)
    best: tuple[float, int] | None = None
    for depth in DEPTHS:
        try:
            turns, rest = divmod(winding.count_within(lowest - depth, left), winding.function.power)
        except RootOnPathError:
            continue
        if not rest:
            best = (lowest - depth, turns)
        if not turns:
            break
    if best is None:
        message = f"the order of the root of {winding.function.bound.name} at s = 0 could not be determined"
        raise UncertifiedError(Diagnostic("SF404", message))
    return best
