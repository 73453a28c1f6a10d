"""Roots of functions with kernels in a part of the s plane: counted, separated, proved one by one.

Cells of z = ln(s) are counted by the argument principle and split until each holds one root. The count may be
numerical, which makes guesses, or proved, which leaves none out; every root found is proved either way.
"""

from __future__ import annotations

from cmath import exp, pi
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from flint import acb

from symflex.balls import Open, branch, precision
from symflex.budget import entered_budget
from symflex.errors import BudgetError, Diagnostic
from symflex.roots.counting.winding import RING, Cell, RootOnPathError, Winding
from symflex.roots.functions.entire import Entire
from symflex.roots.plane.local_roots import prove_simple, prove_together
from symflex.roots.root import Root, count_modes, overlap

MARGIN = 0.03  # how far beyond the axes cells reach [rad], so that no side lies on a row of roots
RIGHT_HALF = 1.3  # angle of the first cut across a half-plane [rad]: to the right of lightly damped roots
SHARES = (0.5127, 0.4631, 0.5719, 0.4213, 0.55, 0.38, 0.61)  # where cells are cut: roots lie in middles
NUDGES = (0.0, 0.0123, 0.0371, 0.0743, 0.113, 0.171)  # shifts of a path that meets a root [in z], in turn
CLOSEST = 1e-11  # cells smaller than this are not split further
SEARCH_STEPS = 30  # steps of Newton's method in doubles
CONVERGED = 1e-11  # step [in z] after which no further one is needed
FEW = 12  # roots of a cell that are sought one by one before it is split
FEW_STEPS = 8  # of Newton's method towards one of them
SPARE = 2  # roots beside a cell that are met instead, before it is split after all
APPROACHED = 1e-5  # step over a cell's size after which a root is near enough for its proof to find it
FIRST_BITS = 128  # precision of points handed to proofs
NEAR = 0.1  # size of cells in which a root without a box is enclosed by a circle
NEIGHBOURS = 1e-4  # relative radius of the disc about a root in which others are sought, not separated
FADED = 100.0  # width in ln of a ring where kernels do not vary faster further out, and roots are few
HIGHEST = 300.0  # ln of the radius [rad/s] beyond which nothing is sought
MODES_LIMIT = 2000  # most modes of one search; ask for further ones by a band


Counted = tuple[Cell, int]  # a cell, and how many roots it holds


@dataclass(frozen=True, slots=True)
class Found:
    """What a search brought to light."""

    roots: tuple[Root, ...]  # in the upper half-plane, of even functions in its right quadrant, closed
    missing: int  # roots that were counted but not found
    cell: Cell | None = None  # what was searched


class RootSearch:
    """Searches one function with at least one kernel, but for holes in which roots accumulate."""

    def __init__(self, winding: Winding[Entire], holes: Sequence[Cell], digits: int) -> None:
        self.function = winding.function
        self.holes = tuple(holes)
        self.digits = digits
        self.is_even = self.function.is_even
        self.excluded: set[Cell] = set()
        self.roots: list[Root] = []
        self.missing = 0
        self.reached = self._innermost = -inf
        self._winding = winding

    @property
    def left(self) -> float:
        """The largest arg(s) searched [rad], but for the margin; mirror images are known without search."""
        return pi / 2 if self.is_even else pi

    def smallest(self) -> float:
        """Return ln of a radius within which no roots lie but those at s = 0, by all appearances."""
        return self._winding.smallest(self.left, self.holes)

    def extend(self, modes: int, radius: float = -inf) -> None:
        """Search outwards for enough modes, at least to ln of a radius; what was found stays."""
        if self.reached == -inf:
            self.reached = self._innermost = self.smallest()
        while self.reached < radius or (known := count_modes(self.roots)) < modes:
            if self.reached > HIGHEST:
                # Kernels that do not depend on s: there are no more roots.
                self.reached = inf
                break
            if self.reached >= radius:
                entered_budget().progress.report(known / modes, f"{known} of {modes} modes located")
            reach = self._winding.reach
            width = RING if reach(self.reached + FADED) > reach(self.reached) else FADED
            high, ring = self._ring(self.reached, self.passing(self.reached + width))
            self.roots.extend(ring.roots)
            self.missing += ring.missing
            self.reached = high

    def passing(self, radius: float) -> float:
        """Return ln of a radius, at least the one given, whose circle passes all holes."""
        for hole in sorted(self.holes, key=lambda hole: hole.low):
            if hole.low - max(NUDGES) <= radius <= hole.high:
                radius = hole.high + MARGIN
        return radius

    def ring(self, low: float, high: float, right: float = 0.0, left: float = pi) -> Found:
        """Return the roots with ln(abs(s)) and arg(s) in the given limits, and perhaps a few beyond."""
        cell = Cell(low - 1e-3, high + 1.1e-3, right - MARGIN, min(left, self.left) + MARGIN)
        for nudge in NUDGES:
            moved = Cell(cell.low - nudge / 3, cell.high + nudge / 2, cell.right - nudge, cell.left + nudge)
            try:
                return self._search(moved)
            except RootOnPathError:
                continue
        return Found((), 1)

    def _ring(self, low: float, high: float) -> tuple[float, Found]:
        """Return the roots in a whole ring, whose outer radius may move to pass between roots.

        So may the innermost radius, inwards: the first root may lie on its circle.
        """
        for nudge in NUDGES:
            inner = low - nudge * (low == self._innermost)
            try:
                searched = self._search(Cell(inner, high + nudge, -MARGIN, self.left + MARGIN))
            except RootOnPathError:
                continue
            return high + nudge, searched
        message = f"roots do not separate near {exp(high).real:g} rad/s"
        raise BudgetError(Diagnostic("SF505", message, None, "ask for a band that ends elsewhere"))

    def _search(self, cell: Cell) -> Found:
        cells = [cell]
        for hole in self.holes:
            parts = [part for whole in cells for part in whole.without(hole)]
            if parts != cells:
                self.excluded.add(hole)
            cells = parts
        counted = [(part, self._winding.count(part)) for part in cells]
        roots: list[Root] = []
        missing = 0
        for part, count in counted:
            separated, lost = self._separate(part, count)
            roots.extend(separated)
            missing += lost
        return Found(tuple(roots), missing, cell)

    def _separate(self, cell: Cell, count: int) -> tuple[list[Root], int]:
        """Return the roots in a cell known to hold ``count`` of them."""
        met: list[tuple[complex, Root]] = []
        search = branch(
            [(cell, count)], lambda counted: self._decide(*counted, met), lambda c: self._split(*c) or ()
        )
        roots, missing = [root for found in search.decided for root in found], 0
        for part, number in search.undecided:
            found = self._as_one(part, number) if number > 0 else None
            if found is None:
                missing += max(1, abs(number) // self.function.power)
            else:
                roots += found
        # Beyond the axes are mirror images of others; where wavenumbers branch there may be no root.
        kept = (r for r in roots if r.multiplicity and not r.im < 0 and not (self.is_even and r.re < 0))
        return list(kept), missing

    def _decide(
        self, cell: Cell, count: int, met: list[tuple[complex, Root]]
    ) -> list[Root] | Open[Counted] | None:
        """Return the roots of a cell if they are one, or few; a cell without any is excluded."""
        if count == 0:
            return None
        apart = self._one_by_one(cell, count, met) if self.function.power < count <= FEW else None
        together = self._together(cell, count) if apart is None and count > 0 else apart
        return Open((cell, count)) if together is None else together

    def _one_by_one(self, cell: Cell, count: int, met: list[tuple[complex, Root]]) -> list[Root] | None:
        """Return the simple roots of a cell, each by Newton's method without those met before (Maehly 1954).

        ``None`` where this does not lead to as many as it holds.
        """
        power = self.function.power
        for _ in range(count // power + SPARE):
            inside = [root for z, root in met if cell.holds(z, CONVERGED)]
            number = sum(root.multiplicity for root in inside) * power
            if number >= count:
                return inside if number == count else None
            places = [place for place, _ in met]
            z = next((z for start in _starts(cell, places) if (z := self._next(cell, start, places))), None)
            if z is None:
                return None
            with precision(FIRST_BITS):
                s = acb(z.real, z.imag).exp().mid()
            root = prove_simple(self.function, s, self.digits, even=self.function.is_mirrored)
            if root is None or not root.certified or any(overlap(root, other) for _, other in met):
                return None
            met.append((_logarithm(root, z), root))
        return None

    def _next(self, cell: Cell, z: complex, met: Sequence[complex]) -> complex | None:
        """Return about where the next root is from a point on; ``None`` beside the cell."""
        for _ in range(FEW_STEPS):
            try:
                slope = self._winding.sample(z).slope / self.function.power - sum(1 / (z - m) for m in met)
            except (RootOnPathError, ZeroDivisionError):
                return None
            if slope == 0:
                return None
            step = 1 / slope
            z -= step
            if not cell.holds(z, CONVERGED):
                return None
            if abs(step) < APPROACHED * cell.size:
                return z
        return None

    def _split(self, cell: Cell, count: int) -> tuple[Counted, Counted] | None:
        """Return two parts with their counts; None for a small cell, or where a root is on every cut."""
        if cell.size <= CLOSEST or count < 0:
            return None
        shares: tuple[float, ...] = SHARES
        if cell.right < 0 and cell.left > pi / 2 and cell.left - cell.right >= cell.high - cell.low:
            shares = ((RIGHT_HALF - cell.right) / (cell.left - cell.right), *SHARES)
        for share in shares:
            one, other = cell.split(share)
            try:
                number = self._winding.count(one)
            except RootOnPathError:
                continue
            return (one, number), (other, count - number)
        return None

    def _together(self, cell: Cell, count: int) -> list[Root] | None:
        """Return the root in a cell when there is one, of any multiplicity; ``None`` to look closer."""
        z, last = cell.centre, inf
        for _ in range(SEARCH_STEPS):
            try:
                slope = self._winding.sample(z).slope
            except RootOnPathError:
                break
            if slope == 0:
                return None
            step = count / slope
            z -= step
            if not cell.holds(z, cell.size):
                return None
            if abs(step) < CONVERGED:
                break
            if count > self.function.power and abs(step) > last / 2:
                return None  # between several roots steps wander; towards one of that multiplicity they fall
            last = abs(step)
        else:
            return None
        if not cell.holds(z, CONVERGED):
            return None
        with precision(FIRST_BITS):
            s = acb(z.real, z.imag).exp().mid()
        root = prove_simple(self.function, s, self.digits, even=self.function.is_mirrored)
        if root is not None and root.multiplicity * self.function.power == count and _is_in(cell, root):
            return [root]
        if count <= self.function.power:
            # No box about it: perhaps a wavenumber vanishes there, which has two branches.
            return None if root is not None or cell.size > NEAR else self._about(s, count)
        return None  # several roots, which cuts part

    def _as_one(self, cell: Cell, count: int) -> list[Root] | None:
        """Return the roots of a cell too small to be cut as one, in a disc proved to hold them."""
        if count % self.function.power:
            return None
        with precision(FIRST_BITS):
            centre = acb(cell.centre.real, cell.centre.imag).exp().mid()
        return self._about(centre, count)

    def _about(self, s: acb, count: int) -> list[Root] | None:
        """Return all roots next to a point as one, in a disc proved to hold so many."""
        with precision(FIRST_BITS):
            size = (s.abs_upper() * NEIGHBOURS).mid()
        root = prove_together(self.function, s, size, self.digits, count, even=self.function.is_mirrored)
        return None if root is None else [root]


def _starts(cell: Cell, met: Sequence[complex]) -> Sequence[complex]:
    """Return where roots of a cell may be: where rows of those met go on, or in its middle."""
    inside = sorted((z for z in met if cell.holds(z, cell.size)), key=lambda z: z.real)
    ends = []
    if len(inside) > 1:
        ends = [2 * inside[-1] - inside[-2], 2 * inside[0] - inside[1]]
    return [*(z for z in ends if cell.holds(z)), cell.centre]


def _is_in(cell: Cell, root: Root) -> bool:
    """Tell whether a root lies in a cell, or at most a hair outside."""
    return cell.holds(_logarithm(root, cell.centre), CONVERGED)


def _logarithm(root: Root, near: complex) -> complex:
    """Return ln of the middle of a root, next to a point."""
    with precision(FIRST_BITS):
        z = complex(acb(root.re.mid(), root.im.mid()).log().mid())
    return z + 2j * pi * round((near.imag - z.imag) / (2 * pi))
