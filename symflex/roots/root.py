"""One root with its enclosure, and its rigorous decimal print."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction

from flint import acb, arb, fmpz

from symflex.balls import opposite, precision
from symflex.expressions.format import decimal_exponent

GUARD_BITS = 32  # bits kept beyond those of what is computed with
FLOAT_BITS = 128  # precision of frequencies and comparisons: more than twice the bits of a double
PLAIN_FROM = -5  # decimal exponent from which numbers are written without one
NEARLY_ZERO = "~0"  # what people read where a number is not told from zero
ROUNDING = 1e-15  # what doubles of enclosures' ends may be off by, relative to them: a few times 2^-53
NEIGHBOURS = 8  # modes of nearly the same frequency among which images of a root are looked for
FEWEST_ALONE = 3  # digits below which a number that stands alone says how far it may be off
HUNDRED = 100  # two digits are fewer
TOUCHING = "some roots could not be separated"  # why roots that are all enclosed are not all certified


@dataclass(frozen=True, slots=True)
class RootDecimals:
    """A root in decimals: the true root lies within ``radius`` of ``re + j im``."""

    re: str  # re and im: ``"0"`` when exactly zero, ``"0e-15"`` when it may be
    im: str
    radius: str  # distance bound, rounded up, such as ``"3.1e-52"``; ``"0"`` when the print is exact

    @property
    def readable(self) -> RootDecimals:
        """The same for people, for whom ``0e-15`` says no more than that a part may be zero.

        >>> RootDecimals("0e-15", "2.0", "1e-15").readable.re
        '~0'
        """
        re, im = (NEARLY_ZERO if part.startswith("0e") else part for part in (self.re, self.im))
        return RootDecimals(re, im, self.radius)


@dataclass(frozen=True, slots=True)
class Root:
    """A root s [rad/s], proved to lie in the box ``re`` x ``im``.

    Parameters
    ----------
    re, im : arb
        Enclosures [rad/s]; exactly zero where that is proved.
    multiplicity : int
        Exact when ``certified``; otherwise the number of roots the box contains, counted with multiplicity.
    on_imaginary_axis, is_real : bool
        Proved to have real (imaginary) part exactly zero; a root at 0 is both.
    certified : bool
        False when the box is proved to hold ``multiplicity`` roots that could not be separated.
    on_boundary : bool
        On the boundary of the region searched, or too close to it to be decided.

    Examples
    --------
    >>> root = Root(arb(-3), arb(4), 1, on_imaginary_axis=False, is_real=False)
    >>> root.damping_ratio(), root.decimal(5)
    (0.6, RootDecimals(re='-3.0000', im='4.0000', radius='0'))
    """

    re: arb
    im: arb
    multiplicity: int
    on_imaginary_axis: bool
    is_real: bool
    certified: bool = True
    on_boundary: bool = False

    @property
    def is_zero(self) -> bool:
        """Whether the root is exactly 0, a rigid-body motion when it is a pole."""
        return self.on_imaginary_axis and self.is_real

    def working_bits(self) -> int:
        """Return a precision at which arithmetic with the enclosure loses nothing."""
        return max(FLOAT_BITS, self.re.bits(), self.im.bits()) + GUARD_BITS

    def enclosure(self) -> acb:
        """Return the box as one complex ball."""
        return acb(self.re, self.im)

    def __complex__(self) -> complex:
        return complex(self.enclosure().mid())

    def natural_frequency(self) -> arb:
        """Return abs(s) [rad/s], of models with loss factors omega_r."""
        return self.size()

    def size(self) -> arb:
        """Return abs(s) [rad/s]."""
        if self.on_imaginary_axis or self.is_real:
            size = self.im if self.on_imaginary_axis else self.re
            if size > 0:
                return size
            with precision(max(FLOAT_BITS, size.bits())):
                return abs(size)
        with precision(self.working_bits()):
            return abs(self.enclosure())

    def frequency_hz(self) -> float:
        """Return the natural frequency over 2 pi [Hz] in double precision."""
        frequency = self.natural_frequency()
        with precision(FLOAT_BITS):
            return float((frequency / (2 * arb.pi())).mid())

    def damping_ratio(self) -> float | None:
        """Return -re/abs(s): 0.0 on the imaginary axis or not told from it, None where abs(s) may be 0."""
        if self.on_imaginary_axis:
            return None if self.is_real else 0.0
        frequency = self.natural_frequency()
        if not frequency > 0:
            return None
        if self.re.contains(0):
            return 0.0
        with precision(FLOAT_BITS):
            return float((-self.re / frequency).mid())

    def loss_factor(self) -> arb | None:
        """Return eta_r of ``s^2 = -omega_r^2 (1 + j eta_r)``, of models that have loss factors; else None."""
        return None

    def decimal(self, digits: int) -> RootDecimals:
        """Print the root with at most ``digits`` significant digits in each component.

        Fewer digits appear where the enclosure does not certify them all.

        Parameters
        ----------
        digits : int
            Significant digits, at least 1.

        Returns
        -------
        RootDecimals
            ``radius`` bounds the rounding of the print and the enclosure together.
        """
        return decimals(self.re, self.im, digits)


@dataclass(frozen=True, slots=True)
class LossyRoot(Root):
    """A root of a function with loss factors: ``s^2 = -omega_r^2 (1 + j eta_r)``."""

    @staticmethod
    def of(root: Root) -> LossyRoot:
        """Return the same root."""
        return LossyRoot(*(getattr(root, name) for name in Root.__slots__))

    def natural_frequency(self) -> arb:
        """Return omega_r [rad/s], abs(s) where s^2 has no negative real part."""
        with precision(self.working_bits()):
            square = self.im**2 - self.re**2
            return square.sqrt() if square > 0 else abs(self.enclosure())

    def loss_factor(self) -> arb | None:
        """Return eta_r; None where s^2 has no negative real part."""
        with precision(self.working_bits()):
            square = self.im**2 - self.re**2
            return -2 * self.re * self.im / square if square > 0 else None


def decimals(re: arb, im: arb, digits: int) -> RootDecimals:
    """Print a complex number with at most ``digits`` significant digits in each part, all certified.

    >>> decimals(arb(1, 1e-3), arb(2) / 3, 6)
    RootDecimals(re='1.00', im='0.666667', radius='1.1e-3')
    >>> decimals(arb(0), arb(0, 1e-16), 6)
    RootDecimals(re='0', im='0e-15', radius='1.1e-16')
    """
    shown_re, re_error = _round_ball(re, digits)
    shown_im, im_error = _round_ball(im, digits)
    return RootDecimals(shown_re, shown_im, _round_up(re_error, im_error))


def real_json(value: arb | None, digits: int) -> dict[str, str] | None:
    """Return the certified decimals of a real number, and a bound of their error; None if it is infinite."""
    if value is None or not value.is_finite():
        return None
    printed = decimals(value, arb(0), digits)
    return {"value": printed.re, "radius": printed.radius}


def hertz(omega: arb) -> arb:
    """Return a frequency in Hz from one in rad/s."""
    with precision(max(FLOAT_BITS, omega.bits())):
        return omega / (2 * arb.pi())


def short_hertz(omega: arb) -> str:
    """Return a frequency in rad/s as text in Hz."""
    return figure(hertz(omega), 6, trimmed=True)


def degrees(angle: arb) -> arb:
    """Return an angle in degrees from one in rad."""
    with precision(max(FLOAT_BITS, angle.bits())):
        return angle * 180 / arb.pi()


def figure(value: arb, digits: int, *, trimmed: bool = False) -> str:
    """Print a real number that stands alone with at most ``digits`` digits, all of them right.

    Every number in the ball lies within half a unit of the last digit. Where fewer than three digits do so,
    the radius follows. ``trimmed`` takes zeros away from the end, as ``g`` does.

    >>> figure(arb(2) / 3, 6), figure(arb("0.12345", 1e-5), 6), figure(arb(1.75, 0.6), 6)
    ('0.666667', '0.123', '1.75 +- 0.61')
    >>> figure(arb(0, 1e-16), 6), figure(arb(1) / 2, 6), figure(arb(1) / 2, 6, trimmed=True)
    ('0 +- 1.1e-16', '0.500000', '0.5')
    """
    middle, radius = exact_fraction(value), exact_fraction(value.rad())
    if middle == 0 == radius:
        return "0"
    leading = decimal_exponent(abs(middle or radius))
    most = min(digits, leading - decimal_exponent(radius) + 1) if radius else digits
    for count in range(most, min(digits, FEWEST_ALONE) - 1, -1):
        shown, last, error = _rounded(middle, leading - count + 1, count)
        if 2 * (error + radius) <= Fraction(10) ** last:
            return f"{float(_format(shown, last)):.{count}g}" if trimmed else _format(shown, last)
    shown, last, error = _rounded(middle, decimal_exponent(radius) - 1, digits)
    size = str(Decimal(_round_up(error + radius))).lower().replace("e+", "e")
    return f"{_format(shown, last) if shown else 0} +- {size}"


def overlap(a: Root, b: Root) -> bool:
    """Tell whether two roots may be the same.

    >>> one = Root(arb(0), arb(4, 0.1), 1, on_imaginary_axis=True, is_real=False)
    >>> overlap(one, Root(arb(0), arb(4.1, 0.1), 1, on_imaginary_axis=True, is_real=False))
    True
    """
    return bool(a.re.overlaps(b.re)) and bool(a.im.overlaps(b.im))


def are_apart(roots: Sequence[Root]) -> bool:
    """Tell whether no two enclosures overlap."""
    sizes = ((root.natural_frequency(), root) for root in roots)
    spans = [(float(f.lower()) * (1 - ROUNDING), float(f.upper()) * (1 + ROUNDING), r) for f, r in sizes]
    spans.sort(key=lambda span: span[0])
    near: list[tuple[float, Root]] = []
    for low, high, root in spans:
        near = [(end, other) for end, other in near if end >= low]
        if any(overlap(root, other) for _, other in near):
            return False
        near.append((high, root))
    return True


def count_roots(roots: Iterable[Root]) -> int:
    """Return how many roots there are, multiple ones counted as often as they occur."""
    return sum(root.multiplicity for root in roots)


def modes_of(roots: Sequence[Root]) -> list[Root]:
    """Return the roots other than 0 that count: one of each pair, a multiple one as often as it is one."""
    return [root for root in roots if not root.is_zero and not root.im < 0 for _ in range(root.multiplicity)]


def groups(roots: Sequence[Root]) -> list[list[Root]]:
    """Return the roots other than 0, those together that mirror each other in the axes.

    Each is proved by itself, so that images may differ within their enclosures.

    >>> one, other = (Root(arb(re, 1e-9), arb(0), 1, on_imaginary_axis=False, is_real=True) for re in (-2, 2))
    >>> len(groups([one, other])), len(groups([one, replace(other, re=arb(2.1, 1e-9))]))
    (1, 2)
    """
    sizes = ((float(root.size().mid()), i) for i, root in enumerate(roots) if not root.is_zero)
    indices: list[list[int]] = []
    for _, i in sorted(sizes):
        # Images stand next to each other, but for the few that are as large.
        like = next((g for g in reversed(indices[-NEIGHBOURS:]) if _mirrored(roots[g[0]], roots[i])), None)
        if like is None:
            indices.append([i])
        else:
            like.append(i)
    return [[roots[i] for i in sorted(group)] for group in sorted(indices, key=min)]


def count_modes(roots: Sequence[Root]) -> int:
    """Return how many modes there are among roots, those that mirror each other being one."""
    return sum(group[0].multiplicity for group in groups(roots))


def root_at_zero(order: int, reach: arb | float = 0) -> list[Root]:
    """Return a root of an order at 0, or as one all that lie so close to it; none of order 0.

    >>> [root.multiplicity for root in root_at_zero(2)], root_at_zero(0)
    ([2], [])
    """
    is_zero, box = bool(reach == 0), arb(0, reach)
    certified = is_zero or order == 1
    root = Root(box, box, order, on_imaginary_axis=is_zero, is_real=is_zero, certified=certified)
    return [root] if order >= 1 else []


def _mirrored(a: Root, b: Root) -> bool:
    parts = ((a.re, b.re), (a.im, b.im))
    return all(bool(x.overlaps(y)) or bool(x.overlaps(opposite(y))) for x, y in parts)


def mirror_images(roots: Sequence[Root], *, even: bool, real: bool = True) -> list[Root]:
    """Return roots and their images in the real axis, for even functions in the imaginary axis too.

    If the function is not ``real``, none are images in the real axis, and for even functions -s is one of s.

    >>> root = Root(arb(-3), arb(4), 1, on_imaginary_axis=False, is_real=False)
    >>> [(r.decimal(1).re, r.decimal(1).im) for r in mirror_images([root], even=True)]
    [('-3', '4'), ('-3', '-4'), ('3', '4'), ('3', '-4')]
    """
    mirrored = []
    with precision(max((root.working_bits() for root in roots), default=FLOAT_BITS)):
        for root in roots:
            images = [root]
            if real and not root.is_real:
                images.append(replace(root, im=-root.im))
            if even and not root.on_imaginary_axis:
                images += [replace(r, re=-r.re, im=r.im if real else -r.im) for r in images]
            mirrored += images
    return mirrored


def exact_fraction(number: arb) -> Fraction:
    """Return the midpoint of a ball as the rational number it is."""
    mantissa, exponent = number.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _round_ball(ball: arb, digits: int) -> tuple[str, Fraction]:
    """Return the print of a real ball and a bound on its distance from every point of the ball."""
    middle, radius = exact_fraction(ball), exact_fraction(ball.rad())
    if middle == 0 == radius:
        return "0", radius
    last = decimal_exponent(abs(middle or radius)) - digits + 1
    if radius:
        last = max(last, decimal_exponent(radius) + 1)
    count, last, error = _rounded(middle, last, digits)
    return _format(count, last), error + radius


def _rounded(value: Fraction, last: int, digits: int) -> tuple[int, int, Fraction]:
    """Return the multiple of ``10**last`` nearest to a number, that power, and what rounding changes."""
    unit = Fraction(10) ** last
    count = round(value / unit)
    error = abs(value - count * unit)
    if abs(count) == 10**digits:  # 9.996 became 10.00, one digit too many
        count, last = count // 10, last + 1
    return count, last, error


def _format(count: int, last: int) -> str:
    """Write ``count * 10**last``, plainly where that is short, else with an exponent."""
    if count == 0:
        return f"0e{last}"
    sign, text = ("-" if count < 0 else ""), str(fmpz(abs(count)))  # Python refuses more than 4300 digits
    leading = len(text) - 1 + last
    if last > 0 or leading < PLAIN_FROM:
        return f"{sign}{text[0]}{'.' if len(text) > 1 else ''}{text[1:]}e{leading}"
    if last == 0:
        return sign + text
    text = text.rjust(1 - last, "0")
    return f"{sign}{text[:last]}.{text[last:]}"


def _round_up(*errors: Fraction) -> str:
    """Write a two-digit upper bound of the hypotenuse of the errors."""
    square = sum((error**2 for error in errors), Fraction(0))
    if square == 0:
        return "0"
    scale = decimal_exponent(square) // 2 - 1
    unit = Fraction(10) ** scale
    count = math.isqrt(math.ceil(square / unit**2))
    if count**2 * unit**2 < square:
        count += 1
    while count >= HUNDRED:
        count, scale = -(-count // 10), scale + 1
    return f"{count // 10}.{count % 10}e{scale + 1}"
