"""Certifying roots of a function with kernels about a guess: a simple one, or several close together.

An interval Newton step proves that a factor has exactly one root in a box, a simple one; see
:mod:`symflex.balls.interval_newton`. Where all other factors differ from 0 on the box, the function has
that root with the factor's exponent for its multiplicity. Example: in ``(s^2 + 4) cosh(s)^2`` a box about 2j
holds a simple root, one about ``j pi/2`` a double root.

Where a wavenumber vanishes or meets another, and where roots are closer to each other than the digits
wanted, no box proves one. The function itself is as smooth there as elsewhere, and its power series says how
many roots a disc contains.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf, log2

from flint import acb, arb

from symflex.balls import bits_for_digits, precision, precisions, stays_inside
from symflex.roots.counting.local_series import BITS_A_POINT, REACH, SERIES_BITS, SERIES_POINTS, local_series
from symflex.roots.functions.entire import Entire
from symflex.roots.root import GUARD_BITS, Root

LEAST_BITS = 96  # least precision of a box, whatever digits are wanted
BOX_SHARE = 0.4  # the box is so many of the bits smaller than the root is large
MOST_TIMES = 16  # the first precision; beyond it a root is left to other means
CLOSE = BOX_SHARE + 0.02  # the last Newton step before a box is drawn is by so many of the bits smaller
FIRST_BITS = 64  # precision of the first Newton steps
STEPS = 80  # Newton steps in all
SMALLER = 4  # a middle this many times closer to an axis than the box is large is put on it
PATIENCE = 10  # Newton steps at one precision, after the first, beyond which a root cannot be simple


class _SlowError(Exception):
    """Newton steps do not double their digits: next to the root the factor is not like a simple one."""


@dataclass(frozen=True, slots=True)
class Box:
    """A box that contains exactly one root of one factor, and what is known of the others there."""

    re: arb  # re and im: enclosures of the root [rad/s], exactly zero where symmetry proves that
    im: arb
    reach: arb  # half the side of the box in which there is no other root of the factor [rad/s]
    exponent: int  # of the factor
    touching: tuple[int, ...]  # other factors that may have a root in the box


def prove_simple(
    function: Entire,
    s: acb,
    digits: int,
    *,
    factor: int | None = None,
    even: bool | None = None,
    first_bits: int = FIRST_BITS,
) -> Root | None:
    """Return the root of a factor next to an exact point with an enclosure, ``None`` where none is proved.

    By default it is the factor with the nearest root. Even functions have roots that mirror each other in the
    imaginary axis. ``first_bits`` is the precision of the first steps: next to other roots, few bits may lead
    astray. The multiplicity is the factor's exponent; where other factors have roots in the same box that
    cannot be separated, it is the sum of all exponents, and the root is not ``certified``.
    """
    is_even = function.is_even if even is None else even
    wanted = bits_for_digits(digits + 2) + GUARD_BITS
    first, used = max(LEAST_BITS, wanted, first_bits), 0
    proved: Box | None = None
    for bits in precisions(first, MOST_TIMES * first):
        try:
            box = _box(function, s, (first_bits, bits), factor, even=is_even)
        except _SlowError:
            break
        if box is not None:
            proved = box
            with precision(bits):
                size = acb(box.re, box.im).abs_lower()
                error = box.re.rad() + box.im.rad()
                if not box.touching and error < size * arb(10) ** -digits:
                    return _root(box, box.exponent, certified=True)
                s = acb(box.re.mid(), box.im.mid())
        used = bits
    if proved is None:
        return None
    total = proved.exponent
    for other in proved.touching:
        try:
            beside = _box(function, s, (first_bits, used), other, even=is_even)
        except _SlowError:
            return None
        if beside is None:
            return None
        total += beside.exponent
    return _root(proved, total, certified=not proved.touching)


def _root(box: Box, multiplicity: int, *, certified: bool) -> Root:
    return Root(
        box.re,
        box.im,
        multiplicity,
        on_imaginary_axis=bool(box.re == 0) and certified,
        is_real=bool(box.im == 0) and certified,
        certified=certified,
    )


def _box(function: Entire, s: acb, levels: tuple[int, int], factor: int | None, *, even: bool) -> Box | None:
    """Return a box about the root next to ``s``, after Newton steps from a first to a last precision."""
    bits = levels[1]
    with precision(bits):
        middle = acb(s.real.mid(), s.imag.mid())
        approached = _approached(function, middle, levels, factor)
        if approached is None:
            return None
        middle, chosen = approached
        reach = middle.abs_upper() * arb(2) ** (-BOX_SHARE * bits)
        on_axis = even and bool(abs(middle.real) < reach / SMALLER)
        is_real = function.is_real and bool(abs(middle.imag) < reach / SMALLER)
        middle = acb(arb(0) if on_axis else middle.real, arb(0) if is_real else middle.imag)
        reach = reach.mid()
        box = acb(arb(middle.real, reach), arb(middle.imag, reach))
        factors = function.enclosed_about(box, middle, bits)
        value, slope, exponent = factors[chosen]
        step = value / slope
        if not stays_inside(step, reach):
            return None
        farthest = (box - middle).abs_upper()
        touching = tuple(
            i
            for i, (other, change, _) in enumerate(factors)
            if i != chosen and not other.abs_lower() > (change * farthest).abs_upper()
        )
        if touching and _is_alone(function, middle, farthest, exponent, bits):
            touching = ()
        root = middle - step
        # The only root of the product in a box that mirrors itself is its own mirror image.
        alone = not touching
        return Box(
            arb(0) if on_axis and alone else root.real,
            arb(0) if is_real and alone else root.imag,
            reach,
            exponent,
            touching,
        )


def _is_alone(function: Entire, middle: acb, radius: arb, exponent: int, bits: int) -> bool:
    """Tell whether a function has so many roots near a point: where wavenumbers vanish, boxes do not say."""
    within = (radius * SMALLER).mid()
    reach = within.max((middle.abs_upper() * REACH).mid())
    series = local_series(function, middle, reach, bits + SERIES_BITS, SERIES_POINTS + bits // BITS_A_POINT)
    return series is not None and series.count(within) == exponent * function.power


def _approached(
    function: Entire, s: acb, levels: tuple[int, int], factor: int | None
) -> tuple[acb, int] | None:
    """Return a point close to a root to a share of the bits, by Newton steps at rising precision."""
    first, bits = min(levels), levels[1]
    level, chosen, patience = first, factor or 0, STEPS
    for _ in range(STEPS):
        factors = function.enclosed(s, level)
        if factor is None and level == first:
            chosen = nearest_factor(factors)
        value, slope, _ = factors[chosen]
        with precision(level):
            step = value / slope
            if not step.is_finite():
                if level >= bits:
                    return None
                level, patience = min(2 * level, bits), PATIENCE
                continue
            s = (s - step).mid()
            size, least = step.abs_upper(), s.abs_lower()
        if level >= bits and size < least * 2.0 ** (-CLOSE * bits):
            return s, chosen
        # Steps of unknown sign ask for more digits.
        if level < bits and (step.contains(0) or size < least * 2.0 ** (-level / 3)):
            level, patience = min(2 * level, bits), PATIENCE
            continue
        if step.contains(0):
            return None
        patience -= 1
        if patience < 0:
            raise _SlowError
    return None


def nearest_factor(factors: list[tuple[acb, acb, int]]) -> int:
    """Return the factor with a positive exponent whose root is nearest by Newton's estimate."""
    sizes = []
    for i, (value, slope, exponent) in enumerate(factors):
        size, steepness = abs(value).mid(), abs(slope).mid()
        if exponent > 0 and steepness > 0:
            sizes.append((float((size / steepness).log()) if size > 0 else -inf, i))
    return min(sizes)[1] if sizes else 0


MOST_POINTS = 400  # enough for some 600 digits of one root
CENTRINGS = 3  # least number of times that a disc is moved to the middle of its roots
GUESSED_DIGITS = 14  # digits of the first centre; every Newton step doubles them
GROWTH = 100  # factor on a disc without other roots next to it, and on one that was too small
SHRINKINGS = 5  # shrinkings of a disc until no other root is next to it
WIDER = 5  # radius of a disc that contains one moved to an axis, in radii of that
DIGITS_A_SHRINKING = 2  # the logarithm of GROWTH


def prove_together(
    function: Entire, s: acb, within: arb, digits: int, count: int, *, even: bool
) -> Root | None:
    """Return roots next to a point as one, in a disc that contains so many; ``None`` where none is proved.

    The point is exact. ``count`` is of the roots of ``function**function.power``, with multiplicity; the disc
    stays below the exact radius ``within`` [rad/s]. ``even`` roots mirror each other in the imaginary axis.
    """
    wanted = bits_for_digits(digits + DIGITS_A_SHRINKING * SHRINKINGS)
    most = min(SERIES_POINTS + count * wanted // BITS_A_POINT, MOST_POINTS)
    bits = max(SERIES_BITS + BITS_A_POINT * most, s.bits() + SERIES_BITS)
    with precision(bits):
        reach = within.max(s.abs_upper() * REACH).mid()
    centre = s
    steps = ceil(log2((digits + DIGITS_A_SHRINKING * SHRINKINGS) / GUESSED_DIGITS))
    centrings = max(CENTRINGS, steps + 1)
    for last in reversed(range(centrings)):
        with precision(bits):
            size = (centre.abs_upper() * arb(10) ** -digits).mid()
            centre = snapped(centre, size, even=even, real=function.is_real)
        # Like Newton's, the first step need not be as accurate as the last.
        points = (SERIES_POINTS + most) // 2 if last == centrings - 1 else most
        series = local_series(function, centre, reach, bits, points)
        if series is None:
            return None
        with precision(bits):
            for _ in range(SHRINKINGS):
                # No other root next to the disc either: what is close to it has a disc of its own.
                if series.count(size) == count == series.count(size * GROWTH):
                    return in_disc(centre, size, count // function.power, even=even, real=function.is_real)
                size = (size / GROWTH).mid()
            while not last and size < within:
                if series.count(size) == count:
                    place = snapped(centre, size, even=even, real=function.is_real)
                    if place != centre and series.count(WIDER * size) == count:
                        # About a point of the axis: it contains the disc, and is held by the wider one.
                        centre, size = place, (2 * size).mid()
                    return in_disc(centre, size, count // function.power, even=even, real=function.is_real)
                size = (size * GROWTH).mid()
            centre = series.middle(count) or centre
    return None


def snapped(s: acb, close: arb, *, even: bool, real: bool = True) -> acb:
    """Return a point, on an axis of symmetry if it is closer to that than a distance."""
    on_axis = even and bool(abs(s.real) < close)
    return acb(arb(0) if on_axis else s.real, arb(0) if real and abs(s.imag) < close else s.imag)


def in_disc(centre: acb, size: arb, multiplicity: int, *, even: bool, real: bool = True) -> Root:
    """Return all roots in a disc that contains so many as one."""
    # One root alone in a disc that mirrors itself is its own mirror image.
    on_axis, is_real = (multiplicity == 1 and bool(part == 0) for part in (centre.real, centre.imag))
    on_axis, is_real = on_axis and even, is_real and real
    return Root(
        arb(0) if on_axis else arb(centre.real, size),
        arb(0) if is_real else arb(centre.imag, size),
        multiplicity,
        on_imaginary_axis=on_axis,
        is_real=is_real,
        certified=multiplicity == 1,
    )
