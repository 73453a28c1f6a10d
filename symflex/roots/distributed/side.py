"""One side of a transfer function with kernels, numerator or denominator: its roots in a region, counted.

Roots are guessed by numerical subdivision and proved one by one; one certified count of the whole domain
shows that none is missing. Where that fails, the subdivision is repeated with every count proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from math import exp, inf, pi

from flint import acb

from symflex.algebra import Dispersion, Factored
from symflex.balls import precision
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.roots.axes.lossless import LosslessSearch
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.distributed.proof import (
    UNPROVED,
    WIDER,
    Count,
    Proof,
    holes_about,
    is_whole_ring,
    limits,
    roots_at_zero,
)
from symflex.roots.engines import SEARCHES, SUBDIVISION, Sought
from symflex.roots.functions.kernel_function import (
    KernelFunction,
    divisors_in_s,
    has_kernels,
    split_off_kernels,
)
from symflex.roots.functions.simplified import without_reflections, without_squares
from symflex.roots.loss_modes import complex_roots
from symflex.roots.plane.local_roots import prove_simple, prove_together
from symflex.roots.plane.search import HIGHEST, MODES_LIMIT, RootSearch
from symflex.roots.polynomial_roots import find_polynomial_roots, in_order
from symflex.roots.problem import is_complex, problem_of
from symflex.roots.region import Modes, Region
from symflex.roots.root import TOUCHING, Root, are_apart, count_roots, groups, mirror_images, overlap
from symflex.transfer import BoundTransferFunction

ACCUMULATION_DIGITS = 20  # digits of points that are only avoided
WIDER_ANGLE = 1 + 1e-12  # a double next to a part of pi may be less than that
FEW = 40  # roots that are sooner searched all than a part of them
MORE_DIGITS = 30  # digits beyond twice those asked for, in which a pole and a zero that cancel must agree


class Side:
    """The numerator, the denominator, or what cancelled; one of the ``engines`` follows the other."""

    def __init__(
        self,
        bound: BoundTransferFunction,
        part: Factored,
        digits: int,
        *,
        is_hidden: bool = False,
        engines: Iterable[str] = SEARCHES,
    ) -> None:
        self.bound, self.part = bound, part
        self._engines = tuple(engines)
        self._digits = digits
        self.holes = holes_about(accumulation_points(bound))
        part = without_reflections(bound, part, is_hidden=is_hidden)
        plain, mixed = split_off_kernels(part, bound.kernels)
        self._search: RootSearch | LosslessSearch | None = None
        self._origin: list[Root] = []
        self._order = 0
        self._domain: Cell | None = None
        self._innermost: float | None = None
        self._known: Proof | None = None
        self.engine = self._engines[0]
        self._lossless: LosslessSearch | None = None
        if is_kernel := has_kernels(mixed, bound.kernels):
            # Kernels may have poles where polynomials vanish: only together are they entire.
            self.function = KernelFunction(*without_squares(bound, _without_laplace(plain) * mixed))
            require_lowest(bound)
            self.winding = CertifiedWinding(self.function)
            self._origin, self._order = roots_at_zero(
                self.winding, part, self._left, self.holes, is_hidden=is_hidden
            )
            self._sought = Sought(self.function, self.winding, self._order, self.holes, digits)
            self._attempts = ((e, search) for e in self._engines for search in SEARCHES[e](self._sought))
            self._next_search()
            if self.is_finite:
                raise TypeError(f"not for the engine {', '.join(self._engines)}")
        self._exact = polynomial_roots(bound, _without_laplace(plain) if is_kernel else plain, digits)
        self._located = self._origin if is_kernel else self._exact
        self._most: tuple[str, RootSearch | LosslessSearch | None, list[Root]]
        self._most = (self.engine, self._search, self._located)
        self.roots = list(self._located)
        self.missing = 0

    def anew(self) -> Side:
        """Return the same product before it was searched, as one that is not hidden."""
        return Side(self.bound, self.part, self._digits)

    @property
    def is_finite(self) -> bool:
        """There are no kernels, and all roots are known."""
        return self._search is None

    @property
    def all_roots(self) -> Sequence[Root]:
        """All roots that are known, whichever are chosen."""
        return self._located

    @property
    def at_origin(self) -> list[Root]:
        """The root at 0, wherever else roots were sought; empty where there is none."""
        return [root for root in (*self._origin, *self._exact) if root.is_zero]

    @property
    def reached(self) -> float:
        """Up to which ln(abs(s)) all roots are known."""
        return -inf if self._search is None else self._search.reached

    @property
    def modes(self) -> int:
        """How many modes are known; as many as anyone wants when there are no others."""
        return MODES_LIMIT if self._search is None else len(groups(self.roots))

    def extend(self, modes: int, radius: float = -inf) -> None:
        """Find a number of modes, and all roots up to ln of a radius."""
        if self._search is None:
            self.roots = list(self._exact)
            return
        if modes > MODES_LIMIT:
            message = f"at most {MODES_LIMIT} modes of a distributed function are searched, not {modes}"
            raise BudgetError(Diagnostic("SF505", message, None, "ask for a band"))
        self.bound.expect(modes, exp(min(radius, HIGHEST)))
        while (search := self._search) is not None:
            if isinstance(search, RootSearch):
                self._innermost = search.smallest()
            try:
                search.extend(modes, radius)
            finally:
                self._take(search)
            if search is not self._lossless or self.counted().is_complete or not self._next_search():
                return

    def _next_search(self) -> bool:
        """Turn to a search that also finds what the last one did not, if there is one."""
        following = next(self._attempts, None)
        if following is not None:
            self.engine, self._search = following
            if isinstance(self._search, LosslessSearch):
                self._lossless = self._search
        return following is not None

    def _take(self, search: RootSearch | LosslessSearch) -> None:
        self.missing = search.missing
        # What is known of the upper half-plane alone makes no disc.
        low = -inf if self.function.is_paired or self._innermost is None else self._innermost
        self._domain = Cell(low, min(search.reached, HIGHEST), 0.0, pi)
        self._set(search.roots)

    def search(self, region: Region) -> None:
        """Find at least the roots in a region."""
        if self._search is None:
            return
        if isinstance(region, Modes):
            self.extend(region.count)
            return
        low, high, right, left = limits(region, is_even=self._search.is_even)
        smallest = self.winding.smallest(self._left, self.holes)
        # Within the smallest disc none is sought; that there are none is counted.
        self._innermost = smallest if low < smallest else None
        low, high = max(low, smallest), max(self._search.passing(high), smallest + WIDER)
        is_part = low > smallest or right > 0 or left < self._search.left
        if is_part and not self.holes and self._is_sparse(high):
            low, right, left, self._innermost = smallest, 0.0, pi, smallest
        if isinstance(self._search, LosslessSearch):
            if right <= 0 and left >= self._search.left:
                # A little beyond, so that roots at the limits are met.
                bottom, top = low - WIDER, high + 1.1 * WIDER
                self._domain = Cell(-inf if low <= smallest else bottom, top, 0.0, pi)
                self._set(self._search.between(exp(bottom), exp(top)))
                if self.counted().is_complete:
                    return
            self._next_search()
        if not isinstance(self._search, RootSearch):
            return
        ring = self._search.ring(low, high, right, left)
        self.missing, cell = ring.missing, ring.cell
        if cell is not None and not self.function.is_paired:
            cell = replace(cell, right=max(cell.right, 0.0), left=min(cell.left, pi))
        elif cell is not None and low <= smallest and is_whole_ring(cell, self._search.left, self.holes):
            # A whole disc is easier to count than a ring whose inner circle is very small.
            cell = replace(cell, low=-inf)
        self._domain = cell
        self._set(ring.roots)

    def numbered(self, number: int) -> Root | None:
        """Return one mode by its number by frequency, of undamped functions alone; ``None`` if fewer."""
        if self._search is None:
            ordered = [root for root in in_order(self._exact) if not root.is_zero]
        else:
            if isinstance(self._search, LosslessSearch):
                root = None
                with suppress(RootOnPathError):
                    root = self._search.numbered(number)
                if root is not None:
                    self._set((root,))
                    self.roots = [image for image in self.roots if not image.is_zero]
                    return root
            self.extend(number)
            ordered = [root for root in in_order(self.roots) if not root.is_zero]
        before = 0
        for group in groups(ordered):
            before += group[0].multiplicity
            if before >= number:
                self.roots = group
                return group[0]
        self.roots = []
        return None

    def _is_sparse(self, high: float) -> bool:
        """Tell whether a whole disc has so few roots that it is searched rather than a part of it."""
        try:
            return self._count.within(high + WIDER) <= FEW * self.function.power
        except RootOnPathError:
            return False

    def prove(self, region: Region) -> Proof:
        """Count the roots of the domain that was searched; subdivide it with proof if one is missing."""
        if self._search is None:
            count = count_roots(self.roots)
            return Proof(count, count)
        if self.engine != SUBDIVISION:
            proof = self.counted()
            if proof.is_complete or SUBDIVISION not in self._engines:
                return proof
            self._subdivide(region)
        return self._subdivided()

    def _subdivide(self, region: Region) -> None:
        """Search again, every count proved."""
        reached, modes = self.reached, self.modes
        self.engine, self._search = SUBDIVISION, self._sought.search(self.winding)
        if isinstance(region, Modes):
            self.extend(modes, reached)
        else:
            self.search(region)

    def _subdivided(self) -> Proof:
        """Return what was found in cells that were all counted with proof."""
        count = count_roots(self._located)
        if not (isinstance(self._search, RootSearch) and self._count.is_empty_within(self._innermost)):
            return Proof(count, count, UNPROVED)
        if not are_apart(self._located):
            return Proof(count, count, TOUCHING)
        reason = None if not self.missing else f"{self.missing} roots were counted but not found"
        return Proof(count + self.missing, count, reason)

    def restore(self) -> None:
        """Put back what was taken out of :attr:`roots`."""
        self.roots = list(self._located)

    def refined(self, root: Root) -> Root:
        """Return a root to more than twice the digits, itself where that is not proved."""
        if self._search is None or root.is_zero or not root.certified:
            return root
        with precision(root.working_bits()):
            s = acb(root.re.mid(), root.im.mid())
            within = (2 * (root.re.rad() + root.im.rad())).upper()
        digits, even = 2 * self._digits + MORE_DIGITS, self.function.is_even
        closer = prove_simple(self.function, s, digits) or prove_together(
            self.function, s, within, digits, self.function.power, even=even
        )
        return closer if closer is not None and closer.certified and overlap(closer, root) else root

    def excluded(self) -> tuple[Cell, ...]:
        """Return the neighbourhoods in which nothing was searched."""
        met = set() if self._search is None else self._search.excluded
        return tuple(hole for hole in self.holes if hole in met)

    def _set(self, located: Sequence[Root]) -> None:
        function = self.function
        images = mirror_images(located, even=function.is_central, real=function.is_real)
        distinct: list[Root] = []
        for root in self._proved(images):
            # What could not be separated may have been met more than once.
            if root.certified or not any(overlap(root, other) for other in distinct if not other.certified):
                distinct.append(root)
        self._located = [*self._origin, *distinct]
        self._known = None
        self.roots = list(self._located)
        if count_roots(self._located) >= count_roots(self._most[-1]):
            self._most = (self.engine, self._search, self._located)

    def recall(self) -> None:
        """Go back to the search that found the most if a later one was broken off: all are certified."""
        if self._most[1] is not self._search:
            self.engine, self._search, self._located = self._most
            self.restore()

    def _proved(self, roots: Sequence[Root]) -> Sequence[Root]:
        """Return the certified roots of polynomial factors in place of those located."""

        def proved(root: Root) -> Root:
            same = (r for r in self._exact if overlap(r, root) and r.multiplicity == root.multiplicity)
            return next(same, root)

        return [proved(root) for root in roots] if self._exact else roots

    def counted(self) -> Proof:
        """Count the domain that was searched by its boundary."""
        if self._domain is None:
            return Proof(0, 0, "nothing was searched")
        if self._known is None:
            self._known = self._count.proof(self._domain, self._located, self._origin, self._innermost)
        return self._known

    @property
    def _left(self) -> float:
        return pi / 2 if self.function.is_even else pi

    @property
    def _count(self) -> Count:
        return Count(self.winding, self._order, self.holes, self._left, self._lossless)

    def count_right(self, high: float) -> int:
        """Return how many roots lie in the right half-plane, with ln(abs(s)) below ``high``: proved.

        If it is one of a root ``r = s^(1/q)``, count those in the sector of r that is right of it in s.
        """
        if (sheets := self.bound.sheets) == 1:
            return self._count.right(high)
        return self._count.right(high, pi / (2 * sheets) * WIDER_ANGLE)


def _without_laplace(value: Factored) -> Factored:
    s = value.ring.context.gen(0)
    return value.filter(lambda factor: factor != s)


def polynomial_roots(bound: BoundTransferFunction, part: Factored, digits: int) -> list[Root]:
    """Return the roots of the factors with positive exponents, of those with j in the upper half-plane."""
    factors = [(f, e) for f, e in part.factors if e > 0]
    if is_complex(part):
        return [root for root in complex_roots(bound, factors, digits) if not root.im < 0]
    problem = problem_of(bound, factors)
    return list(find_polynomial_roots(problem, digits)) if problem.degree else []


def accumulation_points(bound: BoundTransferFunction) -> tuple[complex, ...]:
    """Return where the laws of waves have poles in s, such as -1/eta; upper half-plane."""
    points: list[complex] = []
    for law in bound.kernels.dispersions:
        laws = (*law.characteristic, law.shift, *divisors_in_s(law))
        for value in (v for v in laws if not v.is_zero):
            for root in polynomial_roots(bound, value**-1, ACCUMULATION_DIGITS):
                point = complex(float(root.re.mid()), float(root.im.mid()))
                if point and point.imag >= 0 and point not in points:
                    points.append(point)
    return tuple(points)


def require_lowest(bound: BoundTransferFunction) -> None:
    """Raise UncertifiedError: SF404 where waves are ever shorter as s goes to 0: no root is lowest."""
    if any(_shortens_at_zero(law) for law in bound.kernels.dispersions):
        message = f"{bound.name} has an essential singularity at s = 0, where its roots may accumulate"
        hint = "a coefficient has a pole at s = 0: multiply it by s, or let it be 1/(s + a)"
        raise UncertifiedError(Diagnostic("SF404", message, None, hint))


def _shortens_at_zero(law: Dispersion) -> bool:
    """Tell whether an exponent of a law has a pole at s = 0, or might have where there is no formula."""
    uniform = (*law.characteristic, law.shift)
    if any(not c.is_zero and _order_at_zero(c) < 0 for c in uniform):
        return True
    # States scaled by powers of s have no pole, unless a cycle of entries has one (Bellman & Ford).
    size = range(len(law.matrix))
    orders = [(i, j, _order_at_zero(x)) for i in size for j in size if not (x := law.matrix[i][j]).is_zero]
    least = [0] * len(law.matrix)
    for _ in size:
        for i, j, order in orders:
            least[j] = min(least[j], least[i] + order)
    return any(least[i] + order < least[j] for i, j, order in orders)


def _order_at_zero(value: Factored) -> int:
    return value.exponent_of(value.ring.context.gen(0))
