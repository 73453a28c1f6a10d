"""Laurent series of a bound transfer function, at a pole and at s = 0, in balls.

    G(s) = (s + 3)/(s^2 (s + 1))
    at s = 0:     order -2, coefficients 3, -2, 2, ...:   3/s^2 - 2/s + 2 - ...
    at s = -1:    order -1, coefficient 2:                2/(s + 1), a residue of 2

Numerator and denominator are expanded as power series; how many of their first coefficients are zero is known
from the pole's multiplicity, at s = 0 from series over a prime field, so a quotient of balls is enough.
About p wavenumbers and kernels are series in e, where ``s = p + e^n``: with n = 4 every wavenumber is such a
series also where it vanishes.

Residues, how much of each mode a transfer function contains, are the first coefficients at simple poles.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import pi

from flint import acb, acb_series, arb

from symflex.algebra import Factored
from symflex.algebra.vanishing import BRANCHES, OriginSeries
from symflex.analysis.rational.networks import NetworkSides, Taylor
from symflex.balls import (
    Value,
    at_centre,
    bits_for_digits,
    current_bits,
    narrowed,
    opposite,
    precision,
    precisions,
    raised,
    series_quotient,
    series_terms,
)
from symflex.budget import spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.model.loss_factors import check_causal
from symflex.roots import Region, Root
from symflex.roots.counting.local_series import (
    BITS_A_POINT,
    REACH,
    SERIES_BITS,
    SERIES_POINTS,
    TERMS,
    LocalSeries,
    local_series,
)
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.roots.root import GUARD_BITS, overlap
from symflex.transfer import AnyBoundFunction, BoundTransferFunction
from symflex.transfer.double_value import DOUBLE_BITS
from symflex.transfer.enclose_kernels import KernelValues

FINER = (1, 2, 4)  # times the requested digits, to which the determinants of a network are known
FIRST_BITS = 192
LAST_BITS = 12288  # precision of the first attempt, and where doubling it ends: six times
DETECTION_BITS = 768  # precision at which a coefficient counts as zero if its ball contains zero
DOUBLE_DIGITS = 17  # digits that tell a double from its neighbours
SLACK = 16  # terms that roots of vanishing coefficients may cost
LONGEST = 160  # terms of the longest series tried
NEWTON_STEPS = 16  # each doubles the digits: eight reach the last precision; as many for a poor start
COINCIDENT = 2  # zeros on top of a pole that are looked for


@dataclass(frozen=True, slots=True)
class LaurentSeries:
    """The first terms of ``G(s) = (s - p)^order * (coefficients[0] + coefficients[1]*(s - p) + ...)``."""

    order: int  # of the zero at p; negative of a pole
    coefficients: tuple[acb, ...]  # enclosures; the first differs from zero
    is_estimate: bool = False  # the order, or the pole, was found numerically: nothing is proved

    def coefficient(self, power: int) -> acb:
        """Return the coefficient of ``(s - p)^power``, zero below the order; IndexError if not computed."""
        return acb(0) if power < self.order else self.coefficients[power - self.order]

    @property
    def principal_part(self) -> tuple[acb, ...]:
        """The coefficients of ``1/(s - p)``, ``1/(s - p)^2``, ... up to the pole's order."""
        return tuple(self.coefficient(-power) for power in range(1, 1 - self.order))


def limit_at_zero(bound: AnyBoundFunction) -> arb:
    """Return the limit for s -> 0 from the right, infinite at a pole; SF405 when it is not decided."""
    value = acb(0) if bound.is_zero else bound.enclosed(FIRST_BITS)(acb(0))
    if not (bound.is_reduced or value.is_finite()):
        value = bound.solved(acb(0), FIRST_BITS)
    if value == 0 or (value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS):
        return value.real
    if bound.is_reduced and bound.root is not None and bound.root.shift != 0:
        raise _undecided(bound)  # s = 0 is not where the root of s vanishes
    series = expand_at_zero(bound, 0, DOUBLE_DIGITS)
    first = series.coefficients[0].real
    if series.order:
        return arb(0) if series.order > 0 else arb("inf" if first > 0 else "-inf")
    return first


def _undecided(bound: AnyBoundFunction) -> UncertifiedError:
    message = f"the behaviour of {bound.name} near s = 0 could not be determined"
    return UncertifiedError(Diagnostic("SF405", message))


def expand_at_zero(bound: AnyBoundFunction, last: int, digits: int) -> LaurentSeries:
    """Return the Laurent series at s = 0 up to the power ``last``, and at least its leading term.

    Every coefficient that is not zero has so many significant digits. SF405 when they cannot be decided.
    """
    if not bound.is_reduced:
        return _network_at_zero(NetworkSides(bound, 0.0), last, digits)
    named = any(law.wavenumbers for law in bound.kernels.dispersions)
    branches = BRANCHES if named else 1
    origin = OriginSeries(bound.ratio.ring, bound.kernels)
    # Orders count in quarters, where there are branches.
    orders = [
        origin.order(Factored(bound.ratio.ring, Fraction(1), ((f, branches),)))
        for f, _ in bound.ratio.factors
    ]
    finer = precisions(max(FIRST_BITS, 2 * bits_for_digits(digits)), LAST_BITS)
    bits = next(finer, None)
    terms = max((o for o in orders if o is not None), default=0) + branches * (max(last, 0) + 4) + SLACK
    while bits is not None:
        with precision(bits), series_terms(terms):
            evaluator = bound.kernel_values()
            values = local_values(evaluator, acb(0), terms, branches)
            expansion = None
            if values is not None:
                series = [_coefficients(evaluator.polynomial(f, values)) for f, _ in bound.ratio.factors]
                expansion = _quotient(bound.ratio, series, orders, branches, last, terms)
        if isinstance(expansion, LaurentSeries) and _is_accurate(expansion.coefficients, digits, bits):
            return expansion
        if expansion == "longer" and terms < LONGEST:
            terms *= 2
        else:
            bits = next(finer, None)
            if expansion == "unproved":
                orders = [None] * len(orders)
    raise _undecided(bound)


def _network_at_zero(sides: NetworkSides, last: int, digits: int) -> LaurentSeries:
    for finer in FINER:
        num, den = sides.at_zero(finer * digits)
        order = num.at_zero - den.at_zero
        count = max(last - order, 0) + 1
        above, below = sides.taylor(finer * digits)
        series = [part(acb(0), side.at_zero + count) for part, side in ((above, num), (below, den))]
        with precision(num.series.bits):
            first, second = ((c or [])[side.at_zero :] for c, side in zip(series, (num, den), strict=True))
            coefficients = [acb(c.real) for c in series_quotient(first, second, count)]
        if _is_accurate(coefficients, digits, bits_for_digits(digits)):
            return LaurentSeries(order, tuple(acb(about_zero(c.real)) for c in coefficients))
    raise _undecided(sides.bound)


def _quotient(
    ratio: Factored,
    series: Sequence[list[acb]],
    orders: Sequence[int | None],
    branches: int,
    last: int,
    terms: int,
) -> LaurentSeries | str:
    """Return the product of the factors' powers; or ``longer``, ``unproved``, ``finer``: what it lacks."""
    firsts: list[int] = []
    for coefficients, known in zip(series, orders, strict=True):
        apart = next((i for i, c in enumerate(coefficients) if not c.contains(0)), None)
        if known is None:
            if apart is None:
                return "longer"
            if not all(c == 0 for c in coefficients[:apart]) and current_bits() < DETECTION_BITS:
                return "finer"
            firsts.append(apart)
            continue
        if known >= len(coefficients):
            return "longer"
        if apart is not None and apart < known:
            return "unproved"
        if coefficients[known].contains(0):
            return "finer" if current_bits() < DETECTION_BITS else "unproved"
        firsts.append(known)
    total_order = sum(e * first for (_, e), first in zip(ratio.factors, firsts, strict=True))
    if total_order % branches:
        return "finer"
    order = total_order // branches
    count = max(last - order, 0) + 1
    wanted = branches * (count - 1) + 1
    with series_terms(terms):
        total = acb_series([acb(_fraction(ratio))], terms)
        for coefficients, first, (_, exponent) in zip(series, firsts, ratio.factors, strict=True):
            total = total * raised(acb_series(coefficients[first:], len(coefficients) - first), exponent)
    if total.prec < wanted:
        return "longer"
    quotient = tuple(total[branches * i] for i in range(count))
    # A factor is of the order found where the coefficients before it are nothing but zero.
    is_estimate = any(
        known is None and not all(c == 0 for c in coefficients[:first])
        for coefficients, known, first in zip(series, orders, firsts, strict=True)
    )
    return LaurentSeries(order, tuple(acb(about_zero(c.real)) for c in quotient), is_estimate)


def expand_at_pole(
    bound: BoundTransferFunction | NetworkSides, root: Root, digits: int
) -> tuple[acb, LaurentSeries]:
    """Return a pole but 0, refined, and its principal part to so many digits; SF405 if undecided."""
    name = bound.bound.name if isinstance(bound, NetworkSides) else bound.name
    if not root.certified:
        message = f"poles of {name} that cannot be separated have no residues of their own"
        raise UncertifiedError(Diagnostic("SF405", message, None, "more digits may separate them"))
    sides = _network_sides(bound, digits) if isinstance(bound, NetworkSides) else _sides(bound, root, digits)
    for bits, (above, below) in sides:
        with precision(bits):
            # Most roots are known well enough as they are found.
            for is_refined in (False, True):
                expanded = _expanded(above, below, root, is_refined=is_refined)
                if expanded is None:
                    continue
                pole, principal, extra = expanded
                if root.is_real:
                    principal = [acb(c.real) for c in principal]
                is_known = _is_accurate(principal, digits, bits)
                if is_known or (bits >= DETECTION_BITS and _is_unseen(principal, above, below, pole, extra)):
                    principal = [acb(about_zero(c.real), about_zero(c.imag)) for c in principal]
                    return pole, LaurentSeries(-root.multiplicity, tuple(principal), is_estimate=extra > 0)
    re, im = float(root.re.mid()), float(root.im.mid())
    message = f"the residue of {name} at {re:g} {im:+g} j rad/s could not be determined"
    raise UncertifiedError(Diagnostic("SF405", message))


def _sides(
    bound: BoundTransferFunction, root: Root, digits: int
) -> Iterator[tuple[int, tuple[Taylor, Taylor]]]:
    """Yield the Taylor coefficients of numerator and denominator next to a pole, ever more precise."""
    ratio = bound.ratio
    for bits in precisions(max(FIRST_BITS, 2 * bits_for_digits(digits), root.working_bits()), LAST_BITS):
        with precision(bits):
            evaluator = bound.kernel_values()
        above, below = (partial(_part, evaluator, v) for v in (ratio.numerator(), ratio.denominator()))
        yield bits, (above, below)
        with precision(bits):
            smooth = _smooth_sides(bound, root, bits)
        if smooth is not None:
            yield bits, smooth


def _network_sides(sides: NetworkSides, digits: int) -> Iterator[tuple[int, tuple[Taylor, Taylor]]]:
    for finer in FINER:
        yield 2 * bits_for_digits(finer * digits), sides.taylor(finer * digits)


def _expanded(
    above: Taylor, below: Taylor, root: Root, *, is_refined: bool
) -> tuple[acb, list[acb], int] | None:
    """Return a pole, refined or as it is, its principal part, and how many zeros lie on top of it."""
    for extra in range(COINCIDENT + 1):
        order = root.multiplicity + extra
        pole = _refined(below, root, order) if is_refined else _on_axis(root, root.enclosure())
        principal = principal_part(above, below, pole, root.multiplicity, extra)
        if principal is not None:
            return pole, principal, extra
    return None


def _is_unseen(coefficients: Sequence[acb], above: Taylor, below: Taylor, pole: acb, extra: int) -> bool:
    """Tell whether a principal part is next to nothing beside what it is where no zero is near."""
    first = len(coefficients) + extra
    num, den = above(pole, first + 1), below(pole, first + 1)
    if num is None or den is None:
        return False
    nothing = abs(num[first] * pole ** len(coefficients) / den[first]).mid() * arb(2) ** (
        -(current_bits() // 3)
    )
    return all(c.abs_upper() < nothing for c in coefficients)


def _refined(below: Taylor, root: Root, order: int) -> acb:
    """Return a smaller ball about a root of order k, simple in coefficient k - 1 (interval Newton)."""

    def newton(ball: acb) -> acb:
        middle = ball.mid()
        value, slope = below(middle, order + 1), below(ball, order + 1)
        if value is None or slope is None or slope[order].contains(0):
            return acb("nan")
        return _on_axis(root, middle - value[order - 1] / (order * slope[order]))

    return narrowed(_on_axis(root, root.enclosure()), newton, NEWTON_STEPS, 1 / 2)


def _on_axis(root: Root, ball: acb) -> acb:
    if root.is_real:
        return acb(ball.real)
    return acb(arb(0), ball.imag) if root.on_imaginary_axis else ball


def principal_part(
    above: Taylor, below: Taylor, pole: acb, multiplicity: int, extra: int = 0
) -> list[acb] | None:
    """Return coefficients from ``(s - p)^-multiplicity`` to ``(s - p)^-1``; ``extra`` zeros, and poles."""
    count = 2 * multiplicity + extra
    num, den = above(pole, count), below(pole, count)
    if num is None or den is None:
        return None
    first = multiplicity + extra
    if den[first].contains(0) or not all(c.contains(0) for c in (*den[:first], *num[:extra])):
        return None
    coefficients = series_quotient(num[extra:], den[first:], multiplicity)
    return coefficients if all(c.is_finite() for c in coefficients) else None


def _part(evaluator: KernelValues, part: Factored, centre: acb, terms: int) -> list[acb] | None:
    """Return the Taylor coefficients of a product of factors at a point where wavenumbers are regular."""
    values = local_values(evaluator, centre, terms)
    if values is None:
        return None
    with series_terms(terms):
        coefficients = _coefficients(evaluator.value(part, values))[:terms]
    return coefficients if len(coefficients) == terms else None  # roots of what vanishes lose some


def _smooth_sides(bound: BoundTransferFunction, root: Root, bits: int) -> tuple[Taylor, Taylor] | None:
    """Return Taylor coefficients next to a pole where wavenumbers vanish or meet, by values on a circle."""
    if bound.is_rational:
        return None
    sides = [KernelFunction(bound, value) for value in (bound.num, bound.den)]
    above, below = (side.part for side in sides)
    if any(side.power != 1 for side in sides) or not (above / below / bound.ratio).is_one:
        return None
    centre = root.enclosure().mid()
    reach = (centre.abs_upper() * REACH).mid()
    points = SERIES_POINTS + bits // BITS_A_POINT
    series = [local_series(side, centre, reach, bits + SERIES_BITS, points) for side in sides]
    if series[0] is None or series[1] is None:
        return None
    # The series are of the factors, without the numbers in front.
    return partial(_of_series, series[0], _fraction(above)), partial(_of_series, series[1], _fraction(below))


def _of_series(series: LocalSeries, unit: arb, centre: acb, terms: int) -> list[acb] | None:
    """Return the Taylor coefficients at a point close to where a series was found."""
    off = (centre - series.centre).abs_upper()
    radius = (2 * off).max(series.reach * arb(2) ** -(current_bits() // TERMS)).upper()
    around = series.around(centre, radius)
    if around is None or terms > len(around[0]):
        return None
    coefficients, missing = around
    # What is missed is analytic, and no larger than that on the circle: Cauchy's estimate.
    errors = [(missing / radius**k).upper() for k in range(terms)]
    return [unit * (c + acb(arb(0, e), arb(0, e))) for c, e in zip(coefficients, errors, strict=False)]


def about_zero(ball: arb) -> arb:
    """Return a ball that contains zero with its centre there, any other as it is.

    >>> about_zero(arb(0.5, 1)).mid(), about_zero(arb(2, 1)).mid()
    (0, 2.00000000000000)
    """
    return arb(0, ball.abs_upper()) if ball.contains(0) else ball


def _coefficients(value: acb | acb_series) -> list[acb]:
    """Return as many coefficients as are known, trailing zeros among them."""
    if isinstance(value, acb_series):
        return [value[i] for i in range(value.prec)]
    return [value, *[acb(0)] * (LONGEST - 1)]


def _fraction(value: Factored) -> arb:
    return arb(value.unit.numerator) / arb(value.unit.denominator)


def _is_accurate(coefficients: Sequence[acb], digits: int, bits: int) -> bool:
    """Tell whether every coefficient has its digits, or is next to nothing beside the largest."""
    wanted = bits_for_digits(digits)
    if not all(c.is_finite() for c in coefficients):
        return False
    largest = arb(0)
    for c in coefficients:
        largest = largest.max(abs(c).mid())
    nothing = largest * arb(2) ** (-(bits // 3))
    return all(c.rel_accuracy_bits() >= wanted or c.rad() < nothing for c in coefficients)


@dataclass(frozen=True, slots=True)
class PrincipalPart:
    """The principal part of a transfer function at one of its poles p."""

    root: Root  # the pole
    pole: acb  # its enclosure, refined [rad/s]
    coefficients: tuple[acb, ...]  # of ``1/(s - p)``, ``1/(s - p)^2``, ... up to the pole's order
    is_estimate: bool  # the pole could not be distinguished from others, or the residue is not proved

    @property
    def value(self) -> acb:
        """The residue, the coefficient of ``1/(s - p)``, in the transfer function's unit times rad/s."""
        return self.coefficients[0]

    def conjugate(self, root: Root) -> PrincipalPart:
        """Return the residue at the conjugate pole."""
        # What arithmetic returns is rounded to the working precision.
        with precision(max(c.bits() for c in (self.pole, *self.coefficients)) + GUARD_BITS):
            conjugates = tuple(c.conjugate() for c in self.coefficients)
            return PrincipalPart(root, self.pole.conjugate(), conjugates, self.is_estimate)


def find_residues(
    bound: AnyBoundFunction, region: Region | None = None, digits: int = 15
) -> tuple[PrincipalPart, ...]:
    """Return principal parts at the poles of a region, both members of a pair; SF405 where undecided."""
    check_causal(bound.source.model, "a residue")
    if bound.is_reduced:
        bound = without_lengths_of_zero(bound)
    return residues_at(bound, locate(bound, region, digits).complete().all_poles, digits)


def residues_at(bound: AnyBoundFunction, poles: Sequence[Root], digits: int) -> tuple[PrincipalPart, ...]:
    """Return the principal parts at known poles; see :func:`find_residues`."""
    parts: list[PrincipalPart] = []
    source: BoundTransferFunction | NetworkSides
    if not bound.is_reduced:
        source = NetworkSides(bound, max((2 * pi * root.frequency_hz() for root in poles), default=0.0))
    else:
        source = bound
    for root in poles:
        spend()
        mirrored = replace(root, im=opposite(root.im))
        upper = next((r for r in parts if not r.root.is_real and overlap(r.root, mirrored)), None)
        if upper is not None:
            parts.append(upper.conjugate(root))
        elif root.is_zero:
            parts.append(_at_zero(bound, root, digits))
        else:
            pole, series = expand_at_pole(source, root, digits)
            parts.append(PrincipalPart(root, pole, series.principal_part, series.is_estimate))
    return tuple(parts)


def _at_zero(bound: AnyBoundFunction, root: Root, digits: int) -> PrincipalPart:
    series = expand_at_zero(bound, -1, digits)
    if series.order != -root.multiplicity:
        message = f"the order of the pole of {bound.name} at s = 0 is {root.multiplicity} or {-series.order}"
        raise UncertifiedError(Diagnostic("SF405", message))
    is_estimate = series.is_estimate or not root.certified
    return PrincipalPart(root, root.enclosure(), series.principal_part, is_estimate)


def local_values(
    evaluator: KernelValues, centre: acb, terms: int, branches: int = 1
) -> dict[str, Value] | None:
    """Return the series of all generators about p, in powers of e^(1/branches); None if there is none."""
    with series_terms(terms):
        moved = [centre, *[acb(0)] * (branches - 1), acb(1)]
        values = evaluator.at(acb_series(moved[:terms], terms), root=square_root)
    waves = (at_centre(values[name]) for name in evaluator.table.wavenumbers)
    return values if all(w.is_finite() for w in waves) else None


def square_root(series: Value) -> Value:
    """Return a square root of a series that begins with an even power; not a number for any other.

    The branch is chosen by the leading coefficient's midpoint: a ball across a branch cut does no harm. A
    ball that contains zero counts as zero before it.

    >>> root = square_root(acb_series([0, 0, -4, -8], 4))
    >>> [complex(c) for c in root.coeffs()]
    [0j, 2j, 2j]
    """
    if isinstance(series, acb):
        return series.sqrt()
    coefficients = series.coeffs()
    first = next((i for i, c in enumerate(coefficients) if c != 0), 1)
    lead = coefficients[first].mid() if first % 2 == 0 else acb(0)
    if lead == 0:
        return acb_series([acb("nan")] * series.prec, series.prec)
    regular = acb_series([c / lead for c in coefficients[first:]], series.prec - first).sqrt() * lead.sqrt()
    half = first // 2
    return acb_series([*[acb(0)] * half, *regular.coeffs()], series.prec - half)
