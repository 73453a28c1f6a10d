"""Poles and zeros of functions with a root of s, ``r = (a*s + b)^(1/q)``: those on the principal sheet.

Input: a bound transfer function, which is entire above and below in r.
Output: a :class:`~symflex.roots.PoleZeroMap` of the roots with ``abs(arg r) < pi/q``.

    1 + 30 exp(-sqrt(s)):    r = ln 30 + j pi (2 k + 1),    s = r^2 = 1.70 +- 21.4j, -77.3 +- 64.1j, ...

Roots in other sectors belong to other sheets, and no motion has them. On the principal sheet a pole may grow
only where ``abs(arg r) < pi/(2 q)`` (Matignon 1996, for polynomials), and one count about that sector proves
how many there are. Factors without roots of s have their roots in s itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from math import log, pi, prod

from flint import arb, fmpz_mpoly

from symflex.algebra import NO_KERNELS, Factored, terms_of
from symflex.balls import precision
from symflex.errors import SymflexError
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed.right_half_plane import MARGIN, NOT_COUNTED, last_on_the_right
from symflex.roots.distributed.side import Side
from symflex.roots.functions.kernel_function import has_kernels
from symflex.roots.loss_modes import UNJUDGED
from symflex.roots.pole_zero_map import (
    HiddenRoot,
    PoleZeroMap,
    StabilityVerdict,
    chosen,
    judge,
    right_beyond,
)
from symflex.roots.polynomial_roots import in_order
from symflex.roots.problem import cancelled
from symflex.roots.region import Band, Everything, Modes, Rectangle, Region
from symflex.roots.root import Root, count_roots, groups
from symflex.transfer import BoundTransferFunction

EITHER_SHEET = "a root lies so close to the branch cut that its sheet is not decided"
SINGULAR = "at its branch point s = 0 the function is infinite"
SQUARE = 2
WIDER = 1 + 1e-9  # factor by which a radius exceeds that of the last root
MORE = 3  # how many times as many modes are searched on all sheets as are wanted on one


def locate_on_sheet(
    bound: BoundTransferFunction, region: Region, digits: int, locate: Callable[..., PoleZeroMap]
) -> PoleZeroMap:
    """Find the poles and zeros on the principal sheet; ``locate`` finds those of functions without roots."""
    bound = _with_factors(bound)
    plain = replace(bound, is_of_model=False, is_of_s=False)  # nothing is known of its model in r
    whole = _part(plain, lambda f: _is_whole(bound, f), bound.sheets)
    mixed = _part(plain, lambda f: not _is_whole(bound, f), 1)
    count = region.count if isinstance(region, Modes) else getattr(region, "number", 0)
    high = 1.0
    if bound.is_rational:
        located = locate(mixed, Everything(), digits)
    else:
        if count:
            nearest = locate(mixed, Modes(MORE * count), digits, judged=UNJUDGED)
            high = max((r.frequency_hz() for r in (*nearest.poles, *nearest.zeros)), default=high)
        else:
            high = bound.in_root(_outermost(region)) / (2 * pi)
        located = locate(mixed, Band(Fraction(0), Fraction(high * WIDER)), digits, judged=UNJUDGED)
    apart = locate(whole, Everything(), digits)
    reason = located.certificate.reason or apart.certificate.reason
    sides = []
    for name in ("poles", "zeros"):
        roots, is_open = on_sheet(getattr(located, name), bound)
        reason = reason or (EITHER_SHEET if is_open else None)
        sides.append(in_order([*roots, *(_shifted(r, bound) for r in getattr(apart, name))]))
    # an exponential alone has no root
    summed = (part.filter(lambda factor: len(factor) > 1) for part in (bound.den, bound.num))
    has_more = (has_kernels(part, bound.kernels) for part in summed)
    if count and any(more and len(groups(side)) < count for side, more in zip(sides, has_more, strict=True)):
        region = Band(Fraction(0), Fraction(bound.from_root(2 * pi * high) / (2 * pi)))
    poles, zeros = (chosen(side, region) for side in sides)
    hidden = [replace(h, root=r) for h in located.hidden for r in on_sheet([h.root], bound)[0]]
    hidden += [replace(h, root=_shifted(h.root, bound)) for h in apart.hidden]
    verdict, known, unseen = _verdict(bound, apart, digits)
    hidden += map(HiddenRoot, right_beyond(unseen, [h.root for h in hidden]))
    beyond = right_beyond(known, poles)
    found = count_roots((*poles, *zeros, *beyond, *(h.root for h in hidden)))
    missing = located.certificate.counted - located.certificate.found
    certificate = replace(located.certificate, counted=found + missing, found=found, reason=reason)
    own = replace(located, region=region, poles=poles, zeros=zeros, hidden=tuple(hidden), unstable=beyond)
    return replace(own, certificate=certificate, verdict=verdict)


def _with_factors(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with factors without kernels split, so that those without roots of s are apart."""
    ring, order = bound.ratio.ring, bound.sheets

    def parts_of(factor: fmpz_mpoly) -> list[fmpz_mpoly]:
        # What divides the terms of every power of r, up to those of s, is free of it.
        shares: dict[int, dict[tuple[int, ...], int]] = {}
        for monomial, c in factor.terms():
            power, *others = map(int, monomial)
            shares.setdefault(power % order, {})[power - power % order, *others] = int(c)
        polynomials = [ring.context.from_dict(share) for share in shares.values()]
        whole = reduce(lambda f, g: f.gcd(g), polynomials)
        return [whole, factor // whole] if _is_whole(bound, whole) else [factor]

    def split(value: Factored) -> Factored:
        factors = (Factored.polynomial(ring, f) ** e for whole, e in value.factors for f in parts_of(whole))
        return prod(factors, start=Factored.number(ring, value.unit))

    parted = ((h, f) for h in bound.hidden for f in parts_of(h.polynomial))
    hidden = (replace(h, polynomial=f) for h, f in parted if not f.is_constant())
    parts = bound.parts and (split(bound.num), split(bound.den))
    return replace(bound, ratio=split(bound.ratio), parts=parts, hidden=tuple(hidden))


def _is_whole(bound: BoundTransferFunction, factor: fmpz_mpoly) -> bool:
    """Tell whether a factor is a polynomial in s, and not a root of it."""
    ring = bound.ratio.ring
    powers = {dict(monomial).get(0, 0) for monomial, _ in terms_of(factor)}
    is_plain = len(powers) > 1 and ring.used_in([factor]).isdisjoint(bound.kernels.generators)
    return is_plain and not any(power % bound.sheets for power in powers)


def _part(
    bound: BoundTransferFunction, is_in: Callable[[fmpz_mpoly], bool], order: int
) -> BoundTransferFunction:
    """Return the factors that are chosen, with powers of s divided by an order."""
    ring = bound.ratio.ring

    def lowered(f: fmpz_mpoly) -> fmpz_mpoly:
        return ring.context.from_dict({(int(m[0]) // order, *m[1:]): c for m, c in f.terms()})

    def own(value: Factored) -> Factored:
        return Factored(ring, value.unit, tuple((lowered(f), e) for f, e in value.factors if is_in(f)))

    hidden = (replace(h, polynomial=lowered(h.polynomial)) for h in bound.hidden if is_in(h.polynomial))
    return replace(
        bound,
        ratio=own(bound.ratio),
        parts=None if order > 1 or bound.parts is None else (own(bound.num), own(bound.den)),
        kernels=NO_KERNELS if order > 1 else bound.kernels,
        hidden=tuple(hidden),
    )


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


def _verdict(
    bound: BoundTransferFunction, apart: PoleZeroMap, digits: int
) -> tuple[StabilityVerdict, Sequence[Root], Sequence[Root]]:
    """Return whether the model is stable, with poles and hidden modes in the sector of all that may grow."""
    sides, reasons, is_singular = list[list[Root]](), list[str](), False
    parts = [Factored.number(bound.ratio.ring, 1) if bound.is_zero else bound.den, cancelled(bound)]
    for part, others in zip(parts, (apart.all_poles, [h.root for h in apart.hidden]), strict=True):
        own = part.filter(lambda f: not _is_whole(bound, f))
        try:
            side = Side(bound, own, digits)
            roots, reason = _growing(bound, side)
            at_origin = count_roots(side.at_origin)
        except SymflexError as error:
            roots, reason, at_origin = [], error.diagnostics[0].message, 0
        is_singular = is_singular or bool(part is parts[0] and at_origin % bound.sheets)
        sides.append([*roots, *(_shifted(r, bound) for r in others)])
        reasons += [reason] if reason else []
    verdict = judge(sides[0], "; ".join(dict.fromkeys(reasons)), hidden=sides[1])
    if verdict.word == "stable" and is_singular and bound.root is not None and bound.root.shift == 0:
        verdict = replace(verdict, word="marginal", reason=SINGULAR)
    return verdict, sides[0], sides[1]


def _growing(bound: BoundTransferFunction, side: Side) -> tuple[Sequence[Root], str]:
    """Return poles, all those in the right half-plane and on the axis among them, or why not."""
    if side.is_finite:
        known, is_open = on_sheet(side.all_roots, bound)
        return known, EITHER_SHEET if is_open and any(not r.re < 0 for r in known) else ""
    radius, unproved = last_on_the_right(side)
    if unproved:
        return [], unproved
    try:
        count = side.count_right(log(radius * MARGIN))
    except RootOnPathError:
        return [], NOT_COUNTED
    if not count:
        return on_sheet(side.at_origin, bound)[0], ""
    side.search(Band(Fraction(0), Fraction(radius * MARGIN / (2 * pi))))
    steep = (arb.pi() / (2 * bound.sheets)).tan()
    counted = count_roots(r for r in side.roots if abs(r.im) < steep * r.re)
    return on_sheet(side.roots, bound)[0], "" if counted == count else NOT_COUNTED
