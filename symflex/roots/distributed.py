"""Poles and zeros of a distributed system in a region.

Input: a bound transfer function with kernels. Output: a :class:`PoleZeroMap`, located numerically.
"""

from __future__ import annotations

from cmath import phase
from dataclasses import replace
from fractions import Fraction
from math import inf, isfinite, log, pi
from typing import TYPE_CHECKING

from flint import arb

from symflex.errors import Diagnostic, UncertifiedError
from symflex.kernels import Factored, Ring, degree_in
from symflex.kernels.origin import Origin
from symflex.roots.kernel_function import KernelFunction, has_kernels, split_off_kernels
from symflex.roots.pole_zero_map import Certificate, Exclusion, HiddenRoot, PoleZeroMap
from symflex.roots.polynomial import find_polynomial_roots, in_order
from symflex.roots.precision import precision
from symflex.roots.problem import Constant, PolynomialInS, RootProblem
from symflex.roots.region import Band, Everything, Modes, Position, Rectangle
from symflex.roots.root import FLOAT_BITS, Root
from symflex.roots.transcendental import MODES_LIMIT, Found, RootSearch, mirrored
from symflex.roots.winding import Cell
from symflex.transfer import coefficients_in_s

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.roots.region import Region
    from symflex.transfer import BoundTransferFunction

ENGINE = "subdivision"
DEFAULT_MODES = 5
NEIGHBOURHOOD = 0.05
"""Of a point where roots accumulate: relative to its distance from 0."""
MATCHING_ROUNDS = 4
ACCUMULATION_DIGITS = 20
NOT_PROVED = "located numerically; neither the count nor the radii are proved"


def default_region(bound: BoundTransferFunction) -> Region:
    """Return where to search when nothing is said: the model's modes, or its band, or five modes.

    A distributed system has infinitely many poles.
    """
    analysis = bound.source.model.analysis
    if analysis.modes is not None:
        return Modes(analysis.modes)
    return Modes(DEFAULT_MODES) if analysis.band is None else Band(*analysis.band)


def locate_distributed(bound: BoundTransferFunction, region: Region | None, digits: int) -> PoleZeroMap:
    """Find the poles and zeros of a transfer function with kernels, not proved.

    Parameters
    ----------
    bound : BoundTransferFunction
        Of a distributed system.
    region : Region, optional
        :func:`default_region` for everything. For a number of modes, the lowest poles and the lowest zeros;
        roots that mirror each other in the axes count as one mode.
    digits : int
        Digits wanted in each root; each radius is an estimate.

    Returns
    -------
    PoleZeroMap
        Not certified.

    Raises
    ------
    BudgetError
        SF505 when the search takes too long.
    """
    is_default = region is None or isinstance(region, Everything)
    where = default_region(bound) if region is None or isinstance(region, Everything) else region
    poles, zeros = _Side(bound, bound.den, digits), _Side(bound, bound.num, digits)
    sides = () if bound.ratio.is_zero else (poles, zeros)
    shared = _find(sides, where)
    highest = max((root.frequency_hz() for root in _chosen(poles.roots, where)), default=0.0)
    # Modes are of the poles; what cancelled has none of its own.
    within = Band(Fraction(0), Fraction(highest)) if isinstance(where, Modes) and highest else where
    factors = tuple((h.polynomial, h.multiplicity) for h in bound.hidden)
    cancelled = _Side(bound, Factored(bound.ratio.ring, Fraction(1), factors), digits, is_hidden=True)
    _find((cancelled,), within)
    hidden = [HiddenRoot(root) for root in _chosen(cancelled.roots, within)]
    degenerate = _degenerate_points(bound)
    hidden += [
        HiddenRoot(root, "coincident")
        for root in _chosen(shared, within)
        if not any(_overlap(root, other) for other in (*degenerate, *cancelled.roots))
    ]
    chosen = (_chosen(poles.roots, where), _chosen(zeros.roots, where), [h.root for h in hidden])
    found = sum(root.multiplicity for roots in chosen for root in roots)
    missing = sum(side.missing for side in (*sides, cancelled))
    reason = NOT_PROVED if not missing else f"{missing} roots were counted but not found"
    certificate = Certificate(ENGINE, False, found + missing, found, reason, is_estimate=True)
    excluded = {point for side in (*sides, cancelled) for point in side.excluded()}
    return PoleZeroMap(
        bound.name,
        where,
        tuple(chosen[0]),
        tuple(chosen[1]),
        tuple(hidden),
        certificate,
        digits,
        tuple(_exclusion(point) for point in sorted(excluded, key=abs)),
        is_default,
    )


def _find(sides: Sequence[_Side], region: Region) -> list[Root]:
    """Find the roots of both sides in a region, and perhaps more; take out and return what they share."""
    if not isinstance(region, Modes):
        for side in sides:
            side.search(region)
        return _match(*sides) if len(sides) > 1 else []
    shared: list[Root] = []
    wanted = region.count
    for _ in range(MATCHING_ROUNDS):
        for side in sides:
            side.extend(wanted)
        reached = max((side.reached for side in sides), default=-inf)
        for side in sides:
            side.extend(0, reached)
        shared = _match(*sides) if len(sides) > 1 else []
        if not shared:
            break
        lacking = max(region.count - side.modes for side in sides)
        if lacking <= 0:
            break
        wanted += lacking
    return shared


class _Side:
    """The numerator, the denominator, or what cancelled between them.

    Parameters
    ----------
    bound : BoundTransferFunction
        The function.
    part : Factored
        The product whose roots are sought.
    digits : int
        Significant digits of every root.
    is_hidden : bool
        Only powers of s count as roots at 0, not what kernels vanish like.

    Attributes
    ----------
    roots : list of Root
        All found so far, mirror images and roots at 0 included.
    missing : int
        Roots counted but not found.
    """

    def __init__(
        self, bound: BoundTransferFunction, part: Factored, digits: int, *, is_hidden: bool = False
    ) -> None:
        self.holes = {_hole(point): point for point in _accumulation_points(bound)}
        plain, mixed = split_off_kernels(part, bound.kernels)
        exact = _polynomial_roots(bound, plain, digits)
        self._exact = [root for root in exact if not any(_within(root, hole) for hole in self.holes)]
        self._search: RootSearch | None = None
        self._origin: list[Root] = []
        if has_kernels(mixed, bound.kernels):
            # Kernels may have poles where polynomials vanish: only together are they entire.
            function = KernelFunction(bound, _without_laplace(plain) * mixed)
            self._search = RootSearch(function, tuple(self.holes), digits)
            self._origin = _roots_at_zero(bound, part, is_hidden=is_hidden)
        self.roots = self._origin if self._search else self._exact
        self.missing = 0

    @property
    def reached(self) -> float:
        """Up to which ln(abs(s)) all roots are known."""
        return -inf if self._search is None else self._search.reached

    @property
    def modes(self) -> int:
        """How many modes are known; as many as anyone wants when there are no others."""
        return MODES_LIMIT if self._search is None else len(_groups(self.roots))

    def extend(self, modes: int, radius: float = -inf) -> None:
        """Find a number of modes, and all roots up to ln of a radius."""
        if self._search is None:
            self.roots = list(self._exact)
            return
        self._search.extend(modes, radius)
        self.missing = self._search.missing
        self._set(self._search.roots)

    def search(self, region: Region) -> None:
        """Find at least the roots in a region."""
        if self._search is None:
            return
        if isinstance(region, Modes):
            self.extend(region.count)
            return
        found = _in_region(self._search, region)
        self.missing = found.missing
        self._set(found.roots)

    def excluded(self) -> tuple[complex, ...]:
        """Return the points about which nothing was searched."""
        met = set() if self._search is None else self._search.excluded
        return tuple(point for hole, point in self.holes.items() if hole in met)

    def _set(self, located: Sequence[Root]) -> None:
        even = self._search is not None and self._search.is_even
        found = [self._proved(root) for root in mirrored(located, even=even)]
        self.roots = [*self._origin, *found]

    def _proved(self, root: Root) -> Root:
        """Return the certified root of a polynomial factor in place of the one located."""
        same = (r for r in self._exact if _overlap(r, root) and r.multiplicity == root.multiplicity)
        return next(same, root)


def _without_laplace(value: Factored) -> Factored:
    s = value.ring.context.gen(0)
    return value.filter(lambda factor: factor != s)


def _roots_at_zero(bound: BoundTransferFunction, part: Factored, *, is_hidden: bool) -> list[Root]:
    """Return the root at s = 0 with the order to which the function vanishes there."""
    is_exact = True
    if not is_hidden:
        order = Origin(bound.ratio.ring, bound.kernels).order(part)
        if order is None:
            found = KernelFunction(bound, part).order_at_zero()
            if not isfinite(found):
                message = f"the order of the root of {bound.name} at s = 0 cannot be told"
                raise UncertifiedError(Diagnostic("SF404", message))
            is_exact, order = False, round(found)
    else:
        s = part.ring.context.gen(0)
        order = sum(e for f, e in part.factors if f == s)
    zero = arb(0)
    root = Root(zero, zero, max(order, 1), on_imaginary_axis=True, is_real=True, is_estimate=not is_exact)
    return [root] if order >= 1 else []


def _exclusion(point: complex) -> Exclusion:
    reason = "infinitely many roots accumulate there"
    return Exclusion(point.real, point.imag, NEIGHBOURHOOD * abs(point), reason)


def _polynomial_roots(bound: BoundTransferFunction, part: Factored, digits: int) -> list[Root]:
    """Return the roots of the factors with positive exponents."""
    polynomials = [(polynomial_in_s(bound, f), e) for f, e in part.factors if e > 0]
    problem = RootProblem(tuple((p, e) for p, e in polynomials if p.degree > 0))
    return list(find_polynomial_roots(problem, digits)) if problem.degree else []


def _in_region(search: RootSearch, region: Region) -> Found:
    match region:
        case Band(low, high):
            bottom = log(2 * pi * low) if low else search.smallest()
            top = log(2 * pi * high) if high else -inf
            return search.ring(bottom, top) if bottom < top else Found((), 0)
        case Rectangle(re_low, re_high, im_low, im_high):
            sides = (float(re_low), float(re_high), float(im_low), float(im_high))
            return _in_rectangle(search, *sides)
    message = f"no search for {type(region).__name__}"
    raise TypeError(message)


def _in_rectangle(search: RootSearch, re_low: float, re_high: float, im_low: float, im_high: float) -> Found:
    """Search the smallest sector of a ring that holds a rectangle, folded into the upper half plane."""
    across_real, across_imaginary = im_low <= 0 <= im_high, re_low <= 0 <= re_high
    bottom = 0.0 if across_real else min(abs(im_low), abs(im_high))
    top = max(abs(im_low), abs(im_high))
    corners = [complex(re, im) for re in (re_low, re_high) for im in (bottom, top)]
    high = max(abs(corner) for corner in corners)
    if high == 0:
        return Found((), 0)
    nearest = complex(0.0 if across_imaginary else min(abs(re_low), abs(re_high)), bottom)
    low = log(abs(nearest)) if nearest else search.smallest()
    right, left = min(map(phase, corners)), max(map(phase, corners))
    if search.is_even or not nearest:
        right, left = 0.0, pi
    return search.ring(low, log(high), right, left) if low < log(high) else Found((), 0)


def polynomial_in_s(bound: BoundTransferFunction, factor: fmpz_mpoly) -> PolynomialInS:
    """Return a factor without wavenumbers and kernels as a polynomial in s."""
    constants = tuple(Constant(name, evaluate) for name, evaluate in bound.constants)
    ring = bound.ratio.ring
    used = tuple(c for c in constants if degree_in(factor, ring.index[c.name]))
    small = Ring(("s", *(c.name for c in used)))
    places = [ring.index[name] for name in small.names]
    terms = {tuple(int(m[i]) for i in places): int(c) for m, c in factor.terms()}
    coefficients = Ring(small.names[1:])
    polynomial = small.context.from_dict(terms)
    return PolynomialInS(coefficients_in_s(polynomial, coefficients), coefficients.context, used)


def _accumulation_points(bound: BoundTransferFunction) -> tuple[complex, ...]:
    """Return where the laws of waves have poles in s, such as -1/eta; upper half plane."""
    points: list[complex] = []
    for law in bound.kernels.dispersions:
        for value in (v for v in (*law.characteristic, law.shift) if not v.is_zero):
            for root in _polynomial_roots(bound, value**-1, ACCUMULATION_DIGITS):
                point = complex(float(root.re.mid()), float(root.im.mid()))
                if point and point.imag >= 0 and point not in points:
                    points.append(point)
    return tuple(points)


def _degenerate_points(bound: BoundTransferFunction) -> list[Root]:
    """Return where wavenumbers vanish or meet: what numerator and denominator share there is no mode."""
    roots: list[Root] = []
    for law in bound.kernels.dispersions:
        values = list(law.characteristic[:1])
        if law.kind == "pair":
            values.append(law.characteristic[2] ** 2 - law.characteristic[0] * 4)
        for value in values:
            if not value.is_zero:
                roots += _polynomial_roots(bound, value, ACCUMULATION_DIGITS)
    return roots


def _hole(point: complex) -> Cell:
    z = complex(log(abs(point)), phase(point))
    e = NEIGHBOURHOOD
    return Cell(z.real - e, z.real + e, z.imag - e, z.imag + e)


def _within(root: Root, hole: Cell) -> bool:
    point = complex(float(root.re.mid()), abs(float(root.im.mid())))
    return bool(point) and hole.holds(complex(log(abs(point)), phase(point)))


def _overlap(a: Root, b: Root) -> bool:
    return bool(a.re.overlaps(b.re)) and bool(a.im.overlaps(b.im))


def _match(poles: _Side, zeros: _Side) -> list[Root]:
    """Take out and return what poles and zeros share: modes that cancel without a visible common factor."""
    left: list[Root] = list(zeros.roots)
    kept: list[Root] = []
    shared: list[Root] = []
    for pole in poles.roots:
        i = next((i for i, zero in enumerate(left) if _overlap(pole, zero)), None)
        if i is None:
            kept.append(pole)
            continue
        zero = left.pop(i)
        multiplicity = min(pole.multiplicity, zero.multiplicity)
        shared.append(replace(pole, multiplicity=multiplicity))
        if pole.multiplicity > multiplicity:
            kept.append(replace(pole, multiplicity=pole.multiplicity - multiplicity))
        if zero.multiplicity > multiplicity:
            left.insert(i, replace(zero, multiplicity=zero.multiplicity - multiplicity))
    poles.roots, zeros.roots = kept, left
    return shared


def _chosen(roots: Sequence[Root], region: Region) -> list[Root]:
    """Return the roots in a region in order of natural frequency."""
    ordered = in_order(roots)
    if isinstance(region, Modes):
        return _lowest(ordered, region.count)
    positions = region.classify(ordered)
    return [
        root if position is Position.INSIDE else replace(root, on_boundary=True)
        for root, position in zip(ordered, positions, strict=True)
        if position is not Position.OUTSIDE
    ]


def _lowest(ordered: Sequence[Root], count: int) -> list[Root]:
    """Return the roots at 0 and the lowest modes, mirror images with them."""
    result = [root for root in ordered if root.is_zero]
    modes = 0
    for group in _groups(ordered):
        if modes >= count:
            break
        result.extend(group)
        modes += group[0].multiplicity
    return result


def _groups(roots: Sequence[Root]) -> list[list[Root]]:
    """Return the roots other than 0, those together that mirror each other in the axes."""
    groups: dict[tuple[str, str], list[Root]] = {}
    with precision(FLOAT_BITS):
        for root in roots:
            if not root.is_zero:
                key = (str(abs(root.re).mid()), str(abs(root.im).mid()))
                groups.setdefault(key, []).append(root)
    return list(groups.values())
