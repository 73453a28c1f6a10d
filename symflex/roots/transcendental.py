"""Roots of functions with kernels in a part of the s plane: counted, separated, polished; not proved.

Cells of z = ln(s) are counted by the argument principle and split until each holds one root; Newton steps in
balls give it the digits asked for. Radii are the sizes of the last Newton steps: estimates, not bounds.
"""

from __future__ import annotations

from cmath import exp, pi
from dataclasses import dataclass, replace
from math import inf, log
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.errors import BudgetError, Diagnostic
from symflex.roots.precision import BITS_PER_DIGIT, precision
from symflex.roots.root import GUARD_BITS, Root
from symflex.roots.winding import Cell, RootOnPathError, Winding

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from symflex.roots.kernel_function import KernelFunction

MARGIN = 0.03
"""How far beyond the axes cells reach [rad], so that no side lies on a row of roots."""
RIGHT_HALF = 1.3
"""Where the first cut across a half plane is made [rad]: to the right of lightly damped roots."""
SHARES = (0.5127, 0.4631, 0.5719, 0.4213, 0.55, 0.38, 0.61)
"""Where a cell may be cut: off its middle, where symmetry puts roots."""
RING = log(2)
NUDGES = (0.0, 0.0123, 0.0371, 0.0743, 0.113, 0.171)
CLOSEST = 1e-11
"""Cells smaller than this are not split further."""
SEARCH_STEPS = 30
CONVERGED = 1e-11
POLISHING_ROUNDS = 60
LARGEST_RING = 120
HIGHEST = 300.0
"""ln of the radius [rad/s] beyond which nothing is sought."""
SAME_ORDER = 0.05
MODES_LIMIT = 2000


@dataclass(frozen=True, slots=True)
class Found:
    """What a search brought to light.

    Parameters
    ----------
    roots : tuple of Root
        In the upper half plane, for even functions in its right quadrant; both with the axes.
    missing : int
        Roots that were counted but not found.
    """

    roots: tuple[Root, ...]
    missing: int


class RootSearch:
    """Searches one function.

    Parameters
    ----------
    function : KernelFunction
        With at least one kernel.
    holes : sequence of Cell
        What is left out: neighbourhoods of points where roots accumulate.
    digits : int
        Significant digits of every root.

    Attributes
    ----------
    is_even : bool
        Roots mirror each other in the imaginary axis.
    excluded : set of Cell
        The holes that a search met.
    roots : list of Root
        What :meth:`extend` found: in the upper half plane, for even functions in its right quadrant.
    missing : int
        Roots that were counted on the way but not found.
    reached : float
        ln of the radius up to which it searched.
    """

    def __init__(self, function: KernelFunction, holes: Sequence[Cell], digits: int) -> None:
        self.function = function
        self.holes = tuple(holes)
        self.digits = digits
        self.is_even = function.is_even
        self.excluded: set[Cell] = set()
        self.roots: list[Root] = []
        self.missing = 0
        self.reached = -inf
        self._winding = Winding(function)

    @property
    def left(self) -> float:
        """The largest arg(s) searched [rad], but for the margin; mirror images are known without search."""
        return pi / 2 if self.is_even else pi

    def smallest(self) -> float:
        """Return ln of a radius within which no roots lie but those at s = 0."""
        order = self.function.order_at_zero()
        z = self._scale()
        for hole in self.holes:
            z = min(z, hole.low - RING)
        for _ in range(LARGEST_RING):
            try:
                turns = self._winding.turn(complex(z, 0), complex(z, self.left)) / self.left
            except RootOnPathError:
                turns = inf
            if abs(turns - order) < SAME_ORDER:
                return z
            z -= RING
        raise BudgetError(Diagnostic("SF505", "the lowest root cannot be found"))

    def extend(self, modes: int, radius: float = -inf) -> None:
        """Search outwards until there are enough modes, and at least to ln of a radius.

        The results accumulate in :attr:`roots` and :attr:`missing`; none lacks as far as :attr:`reached`.
        """
        if modes > MODES_LIMIT:
            message = f"at most {MODES_LIMIT} modes of a distributed function are searched, not {modes}"
            raise BudgetError(Diagnostic("SF505", message, None, "ask for a band"))
        if self.reached == -inf:
            self.reached = self.smallest()
        while self.reached < radius or sum(root.multiplicity for root in self.roots) < modes:
            if self.reached > HIGHEST:
                # Kernels that do not depend on s: there are no more roots.
                self.reached = inf
                break
            try:
                high, found = self._ring(self.reached, self.reached + RING)
            except BudgetError as error:
                raise self._with_results(error) from None
            self.roots.extend(found.roots)
            self.missing += found.missing
            self.reached = high

    def _with_results(self, error: BudgetError) -> BudgetError:
        """Return an error that says how far the search came."""
        (diagnostic,) = error.diagnostics
        count, hertz = sum(root.multiplicity for root in self.roots), exp(self.reached).real / (2 * pi)
        message = f"{diagnostic.message}; {count} modes were found up to {hertz:g} Hz"
        return BudgetError(replace(diagnostic, message=message))

    def ring(self, low: float, high: float, right: float = 0.0, left: float = pi) -> Found:
        """Return the roots with ln(abs(s)) and arg(s) in the given limits, and perhaps a few beyond."""
        cell = self._widened(Cell(low, high, right, min(left, self.left)))
        for nudge in NUDGES:
            try:
                return self._search(
                    Cell(cell.low - nudge / 3, cell.high + nudge / 2, cell.right - nudge, cell.left + nudge)
                )
            except RootOnPathError:
                continue
        return Found((), 1)

    def _widened(self, cell: Cell) -> Cell:
        return Cell(cell.low - 1e-3, cell.high + 1.1e-3, cell.right - MARGIN, cell.left + MARGIN)

    def _ring(self, low: float, high: float) -> tuple[float, Found]:
        """Return the roots in a whole ring, whose outer radius may move to pass between roots."""
        for nudge in NUDGES:
            try:
                found = self._search(Cell(low, high + nudge, -MARGIN, self.left + MARGIN))
            except RootOnPathError:
                continue
            return high + nudge, found
        raise BudgetError(Diagnostic("SF505", f"roots do not separate near {exp(high).real:g} rad/s"))

    def _scale(self) -> float:
        """Return ln of a frequency at which the largest argument of a kernel is about one."""
        z, step = 0.0, 2 * RING
        reach = self.function.reach(exp(z).real)
        for _ in range(LARGEST_RING):
            if reach > 1:
                z -= step
                lower = self.function.reach(exp(z).real)
                if lower > 0.9 * reach:
                    break
                reach = lower
            else:
                higher = self.function.reach(exp(z + step).real)
                if higher > 1:
                    break
                z += step
        return z

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
            found, lost = self._separate(part, count)
            roots.extend(found)
            missing += lost
        return Found(tuple(roots), missing)

    def _separate(self, cell: Cell, count: int) -> tuple[list[Root], int]:
        """Return the roots in a cell known to hold ``count`` of them."""
        roots: list[Root] = []
        missing = 0
        pending = [(cell, count)]
        while pending:
            part, number = pending.pop()
            if number == 0:
                continue
            root = self._single(part, number) if number > 0 else None
            if root is not None:
                # Beyond the axes are mirror images of others; where wavenumbers branch there may be no root.
                if root.multiplicity and not root.im < 0 and not (self.is_even and root.re < 0):
                    roots.append(root)
                continue
            parts = self._split(part, number) if part.size > CLOSEST and number > 0 else None
            if parts is None:
                missing += max(1, abs(number) // self.function.power)
            else:
                pending.extend(parts)
        return roots, missing

    def _split(self, cell: Cell, count: int) -> tuple[tuple[Cell, int], tuple[Cell, int]] | None:
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

    def _single(self, cell: Cell, count: int) -> Root | None:
        """Return the root in a cell when there is one, of any multiplicity; ``None`` to look closer."""
        z = cell.centre
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
        else:
            return None
        if not cell.holds(z, CONVERGED):
            return None
        return self._polish(z, count)

    def _polish(self, z: complex, count: int) -> Root | None:
        """Return the root near ``exp(z)`` with all its digits."""
        order = arb(count) / self.function.power
        goal = arb(10) ** -(self.digits + 2)
        wanted = int((self.digits + 4) * BITS_PER_DIGIT) + GUARD_BITS
        limit = 4 * count * wanted + 1024
        bits = 128
        with precision(bits):
            s = acb(z.real, z.imag).exp().mid()
        for _ in range(POLISHING_ROUNDS):
            step = self.function.newton_step(s, bits)
            with precision(bits):
                step = order * step
                size = step.abs_upper() if step.is_finite() else None
                if size is not None and size < goal * s.abs_lower():
                    return self._confirmed((s - step).mid(), size, count)
                if size is None or 4 * (step.real.rad() + step.imag.rad()) > size:
                    bits *= 2
                    if bits > limit:
                        return None
                    continue
                s = (s - step).mid()
                if size < s.abs_lower() * arb(2) ** (-bits // 4):
                    bits = max(bits, min(wanted, 2 * bits))
        return None

    def _confirmed(self, s: acb, radius: arb, count: int) -> Root | None:
        """Return the root unless several lie where a multiple one seemed to be."""
        with precision(s.bits() + GUARD_BITS):
            if count > self.function.power or count % self.function.power:
                about = 10 * radius / s.abs_lower() + arb(10) ** -self.digits
                if self._winding.count_about(s, about.mid()) != count:
                    return None
            re, im = arb(s.real, radius), arb(s.imag, radius)
            is_real = im.contains(0)
            on_axis = re.contains(0)
        return Root(
            arb(0) if on_axis else re,
            arb(0) if is_real else im,
            count // self.function.power,
            on_imaginary_axis=bool(on_axis),
            is_real=bool(is_real),
            is_estimate=True,
        )


def mirrored(roots: Iterable[Root], *, even: bool) -> list[Root]:
    """Return roots and their images in the real axis, for even functions in the imaginary axis too."""
    result: list[Root] = []
    for root in roots:
        signs = [(1, 1)]
        if not root.is_real:
            signs += [(x, -y) for x, y in signs]
        if even and not root.on_imaginary_axis:
            signs += [(-x, y) for x, y in signs]
        with precision(root.working_bits()):
            result += [replace(root, re=x * root.re, im=y * root.im) for x, y in signs]
    return result
