"""Poles and zeros of functions with a root of s, ``r = (a*s + b)^(1/q)``: those on the principal sheet.

Input: a bound transfer function, which is entire above and below in r.
Output: a :class:`~symflex.roots.PoleZeroMap` of the roots with ``abs(arg r) < pi/q``.

    1 + 30 exp(-sqrt(s)):    r = ln 30 + j pi (2 k + 1),    s = r^2 = 1.70 +- 21.4j, -77.3 +- 64.1j, ...

Roots in other sectors belong to other sheets, and no motion has them. On the principal sheet a pole may grow
only where ``abs(arg r) < pi/(2 q)`` (Matignon 1996, for polynomials), and one count about that sector proves
how many there are. Factors without roots of s have their roots in s itself, waves and delays among them, and
are searched as those of any other model. Where wavenumbers vanish or meet, the equations say what is there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, reduce
from math import log, pi, prod

from flint import arb, fmpz_mpoly

from symflex.algebra import NO_KERNELS, Factored, Ring, by_powers, degree_in, terms_of
from symflex.balls import precision
from symflex.errors import SymflexError
from symflex.model.linearity import factored_of
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.degenerate import DegeneratePoints, degenerate_points
from symflex.roots.distributed.right_half_plane import MARGIN, NOT_COUNTED, last_on_the_right
from symflex.roots.distributed.side import Side
from symflex.roots.functions.kernel_function import has_kernels
from symflex.roots.loss_modes import UNJUDGED
from symflex.roots.pole_zero_map import (
    Exclusion,
    HiddenRoot,
    PoleZeroMap,
    StabilityVerdict,
    chosen,
    judge,
    right_beyond,
)
from symflex.roots.problem import cancelled
from symflex.roots.region import Band, Everything, Modes, Rectangle, Region
from symflex.roots.root import Root, count_roots, groups
from symflex.transfer import BoundTransferFunction
from symflex.transfer.transfer_function import HiddenFactor

EITHER_SHEET = "a root lies so close to the branch cut that its sheet is not decided"
SINGULAR = "at its branch point s = 0 the function is infinite"
SQUARE = 2
WIDER = 1 + 1e-9  # factor by which a radius exceeds that of the last root
NO_POLES = StabilityVerdict("stable", 0, certified=True)
MORE = 3  # how many times as many modes are searched on all sheets as are wanted on one


def locate_on_sheet(
    bound: BoundTransferFunction, region: Region, digits: int, locate: Callable[..., PoleZeroMap]
) -> PoleZeroMap:
    """Find the poles and zeros on the principal sheet; ``locate`` finds those of functions without roots."""
    bound = _with_factors(bound)
    count = region.count if isinstance(region, Modes) else getattr(region, "number", 0)
    high, reasons, verdict = 1.0, list[str | None](), NO_POLES
    poles, zeros = list[Root](), list[Root]()
    hidden, excluded, maps = list[HiddenRoot](), list[Exclusion](), list[PoleZeroMap]()
    for part in _Sorted(bound).parts:
        is_of_s = part.variable == "s"
        if part.is_rational:
            located = locate(part, Everything(), digits)
        elif is_of_s:
            located = locate(part, Modes(count) if count else region, digits)
        else:
            if count:
                nearest = locate(part, Modes(MORE * count), digits, judged=UNJUDGED)
                high = max((r.frequency_hz() for r in (*nearest.poles, *nearest.zeros)), default=high)
            else:
                high = bound.in_root(_outermost(region)) / (2 * pi)
            located = locate(part, Band(Fraction(0), Fraction(high * WIDER)), digits, judged=UNJUDGED)
        maps.append(located)
        reasons.append(located.certificate.reason)
        excluded += [each if is_of_s else _excluded(each, bound) for each in located.excluded]
        if is_of_s:
            poles += located.all_poles
            zeros += located.zeros
            hidden += located.hidden
            verdict = verdict.beside(located.verdict)
            continue
        shown, is_open = on_sheet(located.poles, bound)
        others, is_open_too = on_sheet(located.zeros, bound)
        reasons += [EITHER_SHEET] if is_open or is_open_too else []
        unseen = [replace(h, root=r) for h in located.hidden for r in on_sheet([h.root], bound)[0]]
        own, known, cancels = _verdict(part, bound, shown, [h.root for h in unseen], digits)
        poles += [*shown, *right_beyond(known, shown)]
        zeros += others
        hidden += [*unseen, *map(HiddenRoot, right_beyond(cancels, [h.root for h in unseen]))]
        verdict = verdict.beside(own)
        # an exponential alone has no root
        summed = (value.filter(lambda factor: len(factor) > 1) for value in (part.den, part.num))
        has_more = (has_kernels(value, part.kernels) for value in summed)
        if count and any(
            more and len(groups(side)) < count for side, more in zip((poles, zeros), has_more, strict=True)
        ):
            region = Band(Fraction(0), Fraction(bound.from_root(2 * pi * high) / (2 * pi)))
    return PoleZeroMap.of(
        bound.name,
        region,
        digits,
        ", ".join(dict.fromkeys(m.certificate.engine for m in maps)),
        (chosen(poles, region), chosen(zeros, region), hidden),
        verdict,
        growing=poles,
        missing=sum(m.certificate.counted - m.certificate.found for m in maps),
        reasons=reasons,
        code=next((m.certificate.code for m in maps if m.certificate.code), None),
        excluded=excluded,
        is_infinite=not bound.is_rational,
    )


def _with_factors(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with factors split, so that those without roots of s are apart.

    ``r^3 + 1`` is one of s whose factors ``r + 1`` and ``r^2 - r + 1`` are none: they are multiplied first.
    """
    ring, order = bound.ratio.ring, bound.sheets
    waves = bound.kernels.generators

    def parts_of(factor: fmpz_mpoly) -> list[fmpz_mpoly]:
        # What divides the terms of every power of r, up to those of s, is free of it.
        shares: dict[int, dict[tuple[int, ...], int]] = {}
        for monomial, c in factor.terms():
            power, *others = map(int, monomial)
            shares.setdefault(power % order, {})[power - power % order, *others] = int(c)
        polynomials = [ring.context.from_dict(share) for share in shares.values()]
        whole = reduce(lambda f, g: f.gcd(g), polynomials)
        return [factor] if whole.is_constant() or len(polynomials) == 1 else [whole, factor // whole]

    def is_rooted(factor: fmpz_mpoly) -> bool:
        return len(factor) > 1 and not _is_of_s(factor, order) and ring.used_in([factor]).isdisjoint(waves)

    def split(value: Factored) -> Factored:
        result = value.filter(lambda f: not is_rooted(f)) * value.unit
        result = result.map_factors(ring, lambda f: _product(ring, parts_of(f)))
        for sign in (1, -1):
            rooted = (f ** abs(e) for f, e in value.factors if e * sign > 0 and is_rooted(f))
            joint = prod(rooted, start=ring.constant(1))
            result = result * _product(ring, parts_of(joint)) ** sign
        return result

    hidden = tuple(HiddenFactor(f, e) for f, e in split(cancelled(bound)).factors)
    parts = bound.parts and (split(bound.num), split(bound.den))
    return replace(bound, ratio=split(bound.ratio), parts=parts, hidden=hidden)


def _product(ring: Ring, factors: Sequence[fmpz_mpoly]) -> Factored:
    return prod((Factored.polynomial(ring, f) for f in factors), start=Factored.number(ring, 1))


def _is_of_s(factor: fmpz_mpoly, order: int) -> bool:
    """Tell whether all powers of a root of s are powers of s."""
    return not any(dict(monomial).get(0, 0) % order for monomial, _ in terms_of(factor))


class _Sorted:
    """The factors of a function by what they are searched in.

    Those without roots of s are functions of s itself, with waves and delays if these are. Of all others
    polynomials are apart, so that what else is even or odd in the root stays so. A polynomial that vanishes
    where wavenumbers vanish or meet, or accumulate, stays with them: only together are they entire.
    """

    def __init__(self, bound: BoundTransferFunction) -> None:
        self.bound, self.ring, self.table = bound, bound.ratio.ring, bound.kernels
        self.laplace = self.ring.context.gen(0)
        laws = [
            *self.table.coefficients,
            *(d.discriminant for d in self.table.dispersions if d.kind == "pair"),
        ]
        self.special = [f for value in laws for f, _ in value.factors if degree_in(f, 0)]
        self.entire = (bound.num, bound.den)
        every = [f for v in (*self.entire, cancelled(bound)) for f, _ in v.factors]
        waves = [f for f in every if self._has_waves(f) or self._meets(f)]
        powers = [e for value in laws for f, e in value.factors if f == self.laplace]
        self.in_s = (
            self.variable is not None
            and all(f == self.laplace or _is_of_s(f, bound.sheets) for f in (*waves, *self.special))
            and not any(e % bound.sheets for e in powers)
        )

    @cached_property
    def variable(self) -> Factored | None:
        """What a power of the root is of s, ``a*s + b``; None where that is not in the ring."""
        root, values = self.bound.source.model.root, dict(self.bound.all_values)
        assert root is not None

        def named(name: str) -> Factored:
            if name not in values:
                return Factored.generator(self.ring, name)
            value = values[name]
            return Factored.generator(self.ring, "pi") ** value.pi_power * value.rational

        try:
            slope, shift = (factored_of(e, self.ring, named) for e in (root.slope, root.shift))
        except (KeyError, TypeError):
            return None
        return slope * Factored.polynomial(self.ring, self.laplace) + shift

    @property
    def parts(self) -> list[BoundTransferFunction]:
        """One function for each kind of factors there is; one at least."""
        parts = [self._part(kind) for kind in ("s", "root", "waves")]
        return [p for p in parts if p.hidden or any(v.factors for v in (p.num, p.den))] or parts[:1]

    def _has_waves(self, factor: fmpz_mpoly) -> bool:
        return not self.ring.used_in([factor]).isdisjoint(self.table.generators)

    def _meets(self, factor: fmpz_mpoly) -> bool:
        """Tell whether a polynomial vanishes where wavenumbers vanish or meet, or accumulate."""
        return any(not factor.gcd(f).is_constant() for f in self.special)

    def _kind(self, factor: fmpz_mpoly) -> str:
        waves = "s" if self.in_s else "waves"
        if factor == self.laplace:
            return waves if self.table else "root"
        is_open = any(v.exponent_of(factor) < 0 for v in self.entire)
        if is_open or self._has_waves(factor) or self._meets(factor):
            return waves
        return "s" if _is_of_s(factor, self.bound.sheets) and self.variable is not None else "root"

    def _part(self, kind: str) -> BoundTransferFunction:
        """Return the factors of one kind, those of s with s in place of powers of its root."""
        order, is_lowered = self.bound.sheets, kind == "s"

        def own(value: Factored) -> Factored:
            result = value.filter(lambda f: f != self.laplace and self._kind(f) == kind)
            power, where = value.exponent_of(self.laplace), self._kind(self.laplace)
            # Whole powers of a root below waves in s are powers of s.
            share = {"s": power - power % order, "root": power % order} if where == "s" else {where: power}
            result = result * Factored.polynomial(self.ring, self.laplace) ** share.get(kind, 0)
            return self._lowered(result) if is_lowered else result

        has_waves = bool(self.table) and kind == ("s" if self.in_s else "waves")
        num, den = (own(value) for value in self.entire)
        table = self.table
        if has_waves and is_lowered:
            table = table.embedded([(v, self._lowered(v)) for v in table.values])
        hidden = own(cancelled(self.bound))
        return replace(
            self.bound,
            ratio=self.bound.ratio if self.bound.is_zero else num / den,
            parts=(num, den) if has_waves else None,
            kernels=table if has_waves else NO_KERNELS,
            hidden=tuple(HiddenFactor(f, e) for f, e in hidden.factors),
            variable="s" if is_lowered else "root",
            is_of_model=self.bound.is_of_model and has_waves,
        )

    def _lowered(self, value: Factored) -> Factored:
        """Return a function of s in whose place powers of its root stand."""
        variable, order = self.variable, self.bound.sheets
        assert variable is not None

        def image(factor: fmpz_mpoly) -> Factored:
            parts = by_powers(self.ring, factor)
            terms = (Factored.polynomial(self.ring, p) * variable ** (n // order) for n, p in parts.items())
            return sum(terms, Factored.number(self.ring, 0))

        rest = value.filter(lambda f: f != self.laplace).map_factors(self.ring, image)
        return rest * value.unit * variable ** (value.exponent_of(self.laplace) // order)


def _outermost(region: Region) -> float:
    """Return the largest abs(s) in a region [rad/s]."""
    if isinstance(region, Rectangle):
        sides = ((region.re_low, region.re_high), (region.im_low, region.im_high))
        return abs(complex(*(float(max(map(abs, pair))) for pair in sides)))
    return 2 * pi * float(region.high) if isinstance(region, Band) else 0.0


def on_sheet(roots: Sequence[Root], bound: BoundTransferFunction) -> tuple[Sequence[Root], bool]:
    """Return the roots s of those r on the principal sheet or its cut, and whether others may be."""
    order = bound.sheets
    if order == 1:
        return roots, False
    found, is_open = list[Root](), False
    for root in roots:
        if root.is_zero:
            times = root.multiplicity // order
            found += [_shifted(replace(root, multiplicity=times), bound)] if times else []
            continue
        with precision(root.working_bits()):
            inside = root.re
            if order > SQUARE:
                inside = ((arb.pi() / order).tan() * root.re - abs(root.im)).min(root.re)
            is_cut = order == SQUARE and root.on_imaginary_axis and bool(root.im > 0)
            if inside < 0 or (order == SQUARE and root.on_imaginary_axis and not is_cut):
                continue
            is_open = is_open or not (inside > 0 or is_cut)
            s, is_real = root.enclosure() ** order, root.is_real or is_cut
            re, im = s.real, arb(0) if is_real else s.imag
            own = replace(root, re=re, im=im, on_imaginary_axis=False, is_real=is_real)
            found.append(_shifted(own, bound))
    return found, is_open


def _shifted(root: Root, bound: BoundTransferFunction) -> Root:
    """Return the root s of one of ``a*s + b``."""
    with precision(root.working_bits()):
        branch = bound.root
        assert branch is not None
        re, im = (root.re - branch.shift) / branch.slope, root.im / branch.slope
        return replace(root, re=re, im=im, on_imaginary_axis=root.on_imaginary_axis and branch.shift == 0)


def _excluded(exclusion: Exclusion, bound: BoundTransferFunction) -> Exclusion:
    """Return a disc of s that contains what a disc of its root is there."""
    branch, order = bound.root, bound.sheets
    assert branch is not None
    slope, centre = float(branch.slope), complex(exclusion.re, exclusion.im)
    at = (centre**order - float(branch.shift)) / slope
    reach = ((abs(centre) + exclusion.radius) ** order - abs(centre) ** order) / slope
    return replace(exclusion, re=at.real, im=at.imag, radius=reach)


def _verdict(
    part: BoundTransferFunction,
    bound: BoundTransferFunction,
    poles: Sequence[Root],
    unseen: Sequence[Root],
    digits: int,
) -> tuple[StabilityVerdict, Sequence[Root], Sequence[Root]]:
    """Return whether a part is stable, with poles and hidden modes in the sector of all that may grow.

    Poles known on the sheet are listed again where there may be others.
    """
    sides, reasons, is_singular = list[Sequence[Root]](), list[str](), False
    own, points = replace(part, variable="model"), DegeneratePoints(part, degenerate_points(part))
    products = [Factored.number(bound.ratio.ring, 1) if bound.is_zero else part.den, cancelled(part)]
    for product, known in zip(products, (poles, unseen), strict=True):
        is_hidden = product is products[1]
        try:
            side = Side(own, product, digits, is_hidden=is_hidden)
            roots, reason = growing(side, points, known, is_hidden=is_hidden)
            at_origin = count_roots(side.at_origin)
        except SymflexError as error:
            roots, reason, at_origin = known, error.diagnostics[0].message, 0
        is_singular = is_singular or bool(not is_hidden and at_origin % bound.sheets)
        sides.append(roots)
        reasons += [reason] if reason else []
    sides[1] = [*sides[1], *right_beyond(unseen, sides[1])]
    verdict = judge(sides[0], "; ".join(dict.fromkeys(reasons)), hidden=sides[1])
    if verdict.word == "stable" and is_singular and bound.root is not None and bound.root.shift == 0:
        verdict = replace(verdict, word="marginal", reason=SINGULAR)
    return verdict, sides[0], sides[1]


def growing(
    side: Side, points: DegeneratePoints, known: Sequence[Root], *, is_hidden: bool
) -> tuple[Sequence[Root], str]:
    """Return poles, all those in the right half-plane and on the axis among them, or why not."""
    bound = side.bound
    if side.is_finite:
        roots, is_open = on_sheet(side.all_roots, bound)
        return roots, EITHER_SHEET if is_open and any(not r.re < 0 for r in roots) else ""
    radius, unproved = last_on_the_right(side)
    if unproved:
        return known, unproved
    try:
        count = side.count_right(log(radius * MARGIN))
    except RootOnPathError:
        return known, NOT_COUNTED
    if not count:
        return on_sheet(side.at_origin, bound)[0], ""
    side.search(Band(Fraction(0), Fraction(radius * MARGIN / (2 * pi))))
    steep = (arb.pi() / (2 * bound.sheets)).tan()
    right = [r for r in side.roots if abs(r.im) < steep * r.re]
    # A formula may have a root where wavenumbers meet or vanish that the system does not have.
    roots = [r for r in side.roots if not points.is_spurious(r, is_hidden=is_hidden)]
    reason = points.unproved if any(r not in roots for r in right) else ""
    return on_sheet(roots, bound)[0], reason if count_roots(right) == count else NOT_COUNTED
