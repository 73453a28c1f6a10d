"""Poles and zeros of functions with loss factors: the natural frequency and loss factor of every mode.

Input: a bound transfer function whose coefficients hold j.
Output: a :class:`~symflex.roots.PoleZeroMap` of the roots with im s >= 0, as j belongs to omega > 0.

    m s^2 + k (1 + j eta):  s^2 = -omega_r^2 (1 + j eta_r),  omega_r = sqrt(k/m),  eta_r = eta

A polynomial f = g + j h with real g and h has the roots of ``g^2 + h^2 = f(s) conj(f)(s)`` at which f
vanishes; g and h being coprime, conj(f) does not. Of a function with kernels Newton steps begin at
the roots without losses, each root is proved by an interval Newton step, and the argument principle on a
circle about s = 0, all of the plane within, shows that there are no others.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from itertools import accumulate
from math import inf, log, pi
from typing import TYPE_CHECKING, Final

from flint import acb, acb_series, arb

from symflex.algebra import Factored, by_powers, degree_in, summed, terms_of
from symflex.balls import expansion, precision, stays_inside
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.model import with_numbers
from symflex.model.loss_factors import has_loss_factors
from symflex.model.model import IMAGINARY, ExactValue
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed.proof import limits
from symflex.roots.engines import POLYNOMIAL
from symflex.roots.functions.kernel_function import KernelFunction, has_kernels, split_off_kernels
from symflex.roots.pole_zero_map import Certificate, HiddenRoot, PoleZeroMap, StabilityVerdict, judge
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.problem import cancelled, problem_of
from symflex.roots.region import Band, Mode, Modes, Position, Rectangle
from symflex.roots.root import FLOAT_BITS, ROUNDING, LossyRoot, Root, count_roots, overlap
from symflex.transfer import bind
from symflex.transfer.of_model import derive_all

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from flint import fmpz_mpoly

    from symflex.roots.region import Region
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction

NO_STABILITY: Final = StabilityVerdict(
    "unknown",
    None,
    certified=False,
    reason="loss factors hold only on s = j*omega and do not decide stability",
)
COMPLEX: Final = "coefficients are complex, and poles need no conjugates"
FOLLOWED: Final = "Newton steps from roots without losses"
NOT_COUNTED: Final = "each root is proved, but not that no other lies between them"
FURTHER: Final = 3
"""Modes without losses beyond those wanted: the circle that is counted lies between two."""
WIDER: Final = Fraction(5, 4)
"""How far beyond a band roots without losses are followed."""
NEWTON: Final = 60
DOUBLINGS: Final = 5
"""How often digits are doubled until a root differs from its mirror image."""
GUARD_BITS: Final = 40


def locate_lossy(
    bound: BoundTransferFunction,
    region: Region,
    digits: int,
    locate: Callable[[BoundTransferFunction, Region, int], PoleZeroMap],
) -> PoleZeroMap:
    """Find poles and zeros of a function that holds j; see the module.

    ``locate`` finds those of functions that do not.

    Raises UncertifiedError: SF402 a root cannot be told from the mirror image of another.
    """
    sides = (bound.ratio.denominator(), bound.ratio.numerator())
    reason: str | None = None
    engine, missing = POLYNOMIAL, 0
    is_lossy = has_loss_factors(bound.source.model)
    if not bound.is_rational:
        check_searched(bound)
        followed, engine = _followed(bound, region, digits, locate), FOLLOWED
        roots_of_sides = [[r for r in side.roots if not r.im < 0] for side in followed]
        missing = sum(side.missing for side in followed)
        reason = "; ".join(dict.fromkeys(side.reason for side in followed if side.reason)) or None
    else:
        every = (*sides, cancelled(bound))
        roots_of_sides = [_of_polynomials(bound, x.factors, digits, is_lossy=is_lossy) for x in every]
    cause = "coincident" if not bound.is_rational and followed[2].is_shared else "cancelled"
    poles, zeros = (_inside(region, roots) for roots in roots_of_sides[:2])
    concealed = _inside(region if bound.is_rational else _among(poles, region), roots_of_sides[2])
    total = count_roots((*poles, *zeros, *concealed))
    verdict = NO_STABILITY
    if not is_lossy:
        verdict = judge(roots_of_sides[0], hidden=roots_of_sides[2])
        verdict = replace(verdict, reason="; ".join(filter(None, (verdict.reason, COMPLEX))))
    return PoleZeroMap(
        bound.name,
        region,
        poles,
        zeros,
        tuple(HiddenRoot(root, cause) for root in concealed),
        Certificate(engine, total + missing, total, reason),
        digits,
        is_infinite=not bound.is_rational,
        verdict=verdict,
    )


def check_searched(bound: AnyBoundFunction) -> None:
    """Raise UncertifiedError, SF404, for waves or delays with complex coefficients that are no losses."""
    if bound.source.model.imaginary and not has_loss_factors(bound.source.model):
        message = f"poles and zeros of {bound.name} are not searched: its coefficients are complex"
        hint = "its frequency response shows them (plot bode)"
        raise UncertifiedError(Diagnostic("SF404", message, None, hint))


def _inside(region: Region, roots: Sequence[Root]) -> tuple[Root, ...]:
    """Return the roots in a region, by natural frequency."""
    ordered = sorted(roots, key=_size)
    places = zip(ordered, region.classify(ordered), strict=True)
    return tuple(root for root, place in places if place is not Position.OUTSIDE)


def _of_polynomials(
    bound: BoundTransferFunction,
    factors: Iterable[tuple[fmpz_mpoly, int]],
    digits: int,
    *,
    is_lossy: bool = True,
) -> list[Root]:
    """Return the roots of polynomials in s and j; with loss factors, those not below the real axis."""
    ring, roots = bound.ratio.ring, list[Root]()
    place = ring.index[IMAGINARY] if IMAGINARY in ring.index else None
    for factor, exponent in factors:
        if not degree_in(factor, 0):
            continue
        parts = by_powers(ring, factor, place) if place is not None else {0: factor}
        g, h = (parts.get(n, ring.constant(0)) for n in (0, 1))
        common = g.gcd(h)
        real = [(common, abs(exponent))] if degree_in(common, 0) else []
        roots += find_polynomial_roots(problem_of(bound, real), digits)
        g, h = g // common, h // common
        if not h.is_zero() and (degree_in(g, 0) or degree_in(h, 0)):
            roots += _apart(bound, g, h, abs(exponent), digits)
    return [LossyRoot.of(r) for r in roots if not r.im < 0] if is_lossy else roots


def _apart(
    bound: BoundTransferFunction, g: fmpz_mpoly, h: fmpz_mpoly, exponent: int, digits: int
) -> list[Root]:
    """Return the roots of g + j h, of which g and h share none."""
    problem = problem_of(bound, [(g * g + h * h, exponent)])
    for doubling in range(DOUBLINGS):
        roots = [r for r in find_polynomial_roots(problem, digits << doubling) if r.im > 0 and not r.is_real]
        sides = [_vanishes(bound, g, h, root) for root in roots]
        if None not in sides:
            return [r if side else replace(r, im=-r.im) for r, side in zip(roots, sides, strict=True)]
    message = f"a root of {bound.name} cannot be told from the mirror image of another"
    raise UncertifiedError(
        Diagnostic("SF404", message, None, "loss factors as small as this may be left out")
    )


def _vanishes(bound: BoundTransferFunction, g: fmpz_mpoly, h: fmpz_mpoly, root: Root) -> bool | None:
    """Tell whether g + j h vanishes at a root of it or of its mirror image, ``None`` if not decided."""
    ring = bound.ratio.ring
    with precision(root.working_bits()):
        values = {name: acb(evaluate()) for name, evaluate in bound.constants} | {"s": root.enclosure()}
        real, imaginary = (summed(terms_of(f), ring.names, values.__getitem__, acb(1)) for f in (g, h))
        ours, theirs = (bool((real + acb(0, sign) * imaginary).contains(0)) for sign in (1, -1))
        return None if ours == theirs else ours


@dataclass(frozen=True, slots=True)
class _Followed:
    """One side of a function with kernels: roots in all of the plane, and why others may be missing."""

    roots: list[Root]
    missing: int = 0  # counted but not found
    reason: str | None = None
    shared: list[Root] = field(default_factory=list)  # further ones, which the other side may have too
    is_shared: bool = False  # hidden modes that agree in all digits


def _followed(
    bound: BoundTransferFunction,
    region: Region,
    digits: int,
    locate: Callable[[BoundTransferFunction, Region, int], PoleZeroMap],
) -> list[_Followed]:
    """Return poles, zeros and hidden modes of a function with kernels, begun at those without losses."""
    model, source = bound.source.model, bound.source
    others = [p.name for p in model.settable]
    without = with_numbers(model, others, {IMAGINARY: ExactValue(Fraction(0))}, in_kernels=True)
    (plain,) = derive_all(without, [(source.output.name, source.input.name)])
    values = {n: v for n, v in bound.values if n != IMAGINARY}
    known = locate(bind(plain, values), _wider(region), digits)
    product = cancelled(bound)
    roots = [h.root for h in known.hidden]
    cancels = has_kernels(product, bound.kernels)
    side = partial(_side, bound, digits=digits, reason=known.certificate.reason)
    # What cancels without losses and not with j, whose square is reduced, numerator and denominator share.
    shared = [] if cancels else [root for root in roots if not root.is_zero]
    poles = side(bound.den, known.poles, shared, region)
    zeros = side(bound.num, known.zeros, shared, region)
    if cancels or not shared:
        return [poles, zeros, side(product, roots, (), _among(poles.roots, region))]
    both = [r for r in poles.shared if any(overlap(r, other) for other in zeros.shared)]
    own = [
        replace(one, roots=[*one.roots, *(r for r in one.shared if not any(overlap(r, b) for b in both))])
        for one in (poles, zeros)
    ]
    rest = _of_polynomials(bound, product.factors, digits)
    return [*own, _Followed([*rest, *both], is_shared=True)]


def _among(poles: Sequence[Root], region: Region) -> Region:
    """Return where hidden modes are shown: of a number of modes those up to the highest pole shown."""
    if not isinstance(region, Modes | Mode):
        return region
    shown = _inside(region, [r for r in poles if not r.im < 0])
    highest = max((_size(r) for r in shown), default=0.0) / (2 * pi) * (1 + 4 * ROUNDING)
    return Band(Fraction(0), Fraction(highest))


def _wider(region: Region) -> Region:
    """Return where to begin, so that the roots that losses move into a region are among those followed."""
    match region:
        case Modes(count) | Mode(count):
            return Modes(count + FURTHER)
        case Band(low, high):
            return Band(low / WIDER, high * WIDER)
        case Rectangle(re_low, re_high, im_low, im_high):
            high = max(map(abs, (re_low, re_high))) + max(map(abs, (im_low, im_high)))
            return Band(Fraction(0), high * WIDER / 6)
    return region


def _side(
    bound: BoundTransferFunction,
    part: Factored,
    roots: Sequence[Root],
    shared: Sequence[Root],
    region: Region,
    *,
    digits: int,
    reason: str | None,
) -> _Followed:
    """Return the roots that those without losses become, counted on circles about s = 0.

    ``shared`` are further ones, which are no modes; ``reason`` is what was not proved of those without
    losses.
    """
    if not has_kernels(part, bound.kernels):
        plain, _ = split_off_kernels(part, bound.kernels)
        return _Followed(_of_polynomials(bound, plain.factors, digits))
    if not _is_lossy(bound, part):
        return _Followed([*map(LossyRoot.of, roots)], 0, reason, [*map(LossyRoot.of, shared)])
    bits = int(digits * 3.33) + GUARD_BITS
    function, moved, factor = _series(bound, part, bits), list[Root](), arb(0)
    extra = list[Root]()
    for root in sorted((*roots, *shared), key=_size):
        if root.is_zero:
            moved.append(LossyRoot.of(root))
            continue
        lossy = _moved(function, root, factor, bits) or _moved(function, root, arb(0), bits)
        if lossy is not None and not any(overlap(lossy, other) for other in (*moved, *extra)):
            (extra if any(root is other for other in shared) else moved).append(lossy)
            factor = lossy.loss_factor() or factor
    moved.sort(key=_size)
    try:
        missing = _missing(KernelFunction(bound, part), (*moved, *extra), _circles(moved, region))
    except (BudgetError, UncertifiedError, RootOnPathError):
        return _Followed(moved, 0, NOT_COUNTED, extra)
    said = f"{missing} roots were counted but not found" if missing else None
    return _Followed(moved, missing, said, extra)


def _is_lossy(bound: BoundTransferFunction, part: Factored) -> bool:
    """Tell whether j stands in a product or in the laws of its waves."""
    kernels = [k for k in bound.kernels.kernels if part.depends_on(k.generator)]
    laws = {id(k.dispersion): k.dispersion for k in kernels}.values()
    return part.depends_on(IMAGINARY) or any(c.depends_on(IMAGINARY) for d in laws for c in d.coefficients)


def _size(root: Root) -> float:
    return 0.0 if root.is_zero else float(root.size().mid())


def _circles(roots: Sequence[Root], region: Region) -> tuple[float, float]:
    """Return ln of two radii [rad/s] about 0 between which a region lies; the first may be -inf.

    Raises RootOnPathError where too few roots are known to tell a circle between the last two.
    """
    match region:
        case Modes(count) | Mode(count):
            upper = [r for r in roots if not r.is_zero and not r.im < 0]
            numbers = accumulate(r.multiplicity for r in upper)
            last = next((i for i, n in enumerate(numbers) if n >= count), len(upper))
            if last + 1 >= len(upper):
                raise RootOnPathError
            return -inf, (log(_size(upper[last])) + log(_size(upper[last + 1]))) / 2
        case Band() | Rectangle():
            low, high, *_ = limits(region, is_even=False)
            return low, high
    raise RootOnPathError


def _missing(function: KernelFunction, roots: Sequence[Root], circles: tuple[float, float]) -> int:
    """Return how many roots between two circles about 0 are not among those given: proved.

    Raises RootOnPathError where that is not proved; SF505 after too much work.
    """
    low, high = circles
    order = function.order()
    with precision(FLOAT_BITS):
        disc = acb(arb(0, arb(high).exp().upper()), arb(0, arb(high).exp().upper()))
        if order is None or not function.is_analytic_on(disc, FLOAT_BITS):
            raise RootOnPathError
    winding = CertifiedWinding(function)

    def within(z: float) -> int:
        with precision(FLOAT_BITS):
            turn = winding.certified_turn(complex(z, -pi), complex(z, 0))
            turn += winding.certified_turn(complex(z, 0), complex(z, pi))
            turns = (turn / (2 * arb.pi())).unique_fmpz()
        if turns is None:
            raise RootOnPathError
        return int(turns)

    counted, rest = divmod(within(high) - (order if low == -inf else within(low)), function.power)
    with precision(FLOAT_BITS):
        inner, outer = (arb(z).exp() if z > -inf else arb(0) for z in circles)
        known = count_roots(r for r in roots if not r.is_zero and inner < r.size() < outer)
    at_zero = count_roots(r for r in roots if r.is_zero)
    if rest or (low == -inf and order != at_zero * function.power):
        raise RootOnPathError
    return counted - known


def _moved(function: Callable[[acb], tuple[acb, acb]], root: Root, factor: arb, bits: int) -> Root | None:
    """Return the root that one without losses becomes, proved; None where no simple one is found near.

    ``factor`` is the loss factor of a mode nearby.
    """
    with precision(bits):
        begun = (root.enclosure().mid() * acb(1, factor).sqrt()).mid()
        at = begun
        for _ in range(NEWTON):
            spend()
            value, slope = function(at)
            change = (value / slope).mid()
            at = (at - change).mid()
            if not abs(change) > abs(at) * arb(2) ** (GUARD_BITS // 2 - bits):
                break
        reach = (abs(at) * arb(2) ** (GUARD_BITS - 8 - bits)).mid()
        box = acb(arb(at.real, reach), arb(at.imag, reach))
        is_near = abs(at - begun) < abs(begun) / 2
        if not (is_near and stays_inside(function(at)[0] / function(box)[1], reach)):
            return None
    return LossyRoot(box.real, box.imag, 1, on_imaginary_axis=False, is_real=False)


def _series(bound: BoundTransferFunction, part: Factored, bits: int) -> Callable[[acb], tuple[acb, acb]]:
    """Return a function that encloses a part's value and derivative."""
    with precision(bits):
        kernels = bound.kernel_values()

    def at(s: acb) -> tuple[acb, acb]:
        values = kernels.at(expansion(s))
        total = acb_series([1, 0], 2)
        for factor, exponent in part.factors:
            total = total * kernels.polynomial(factor, values) ** exponent
        return total[0], total[1]

    return at
