"""Where the real part of a driving-point function is negative, at all frequencies, and where it is least.

Input: a bound transfer function Y. Output: a :class:`RealPart`: the bands with ``Re Y(j omega) < 0``, their
ends enclosed, and what is not proved.

On the axis ``Re Y = Re(N conj(D))/abs(D)^2``. A rational Y has there the sign of the even polynomial ``P(s) =
N(s) D(-s) + N(-s) D(s)``, whose sign changes are its roots of odd order on the axis, which are exact (a root
of even order touches zero). With waves and delays ``Re(N conj(D))`` is ``Im(s N conj(D))/omega``, whose roots
:func:`symflex.loops.axis.find_on_axis` encloses between a power series about 0 and a frequency beyond which
one term of N and one of D outweigh all others. Example::

    Y = (1 - s)/(1 + s)    P = 2 (1 + s^2)    negative above 1 rad/s

An algorithm for the rational case: Sturm (1829); the criterion: Brune (1931).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, takewhile
from math import sqrt
from typing import TYPE_CHECKING

from flint import acb, acb_series, arb, fmpz_mpoly

from symflex.algebra import Factored
from symflex.balls import UndecidedError, bits_for_digits, precision, series_quotient, settled
from symflex.loops.axis import FIRST_RATIO, ORIGIN_BITS, LoopAtOrigin, find_on_axis, pieces
from symflex.loops.loop_function import LoopFunction, LoopValue
from symflex.roots import find_polynomial_roots
from symflex.roots.distributed.far_out import SECTORS, FunctionFarOut
from symflex.roots.distributed.right_half_plane import WAVES
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.problem import polynomial_in_s, problem_of
from symflex.roots.root import short_hertz

if TYPE_CHECKING:
    from symflex.roots import PolynomialInS
    from symflex.transfer import BoundTransferFunction

BITS = 160  # of values on the axis
SPARE_DIGITS = 20  # of frequencies at which a value is wanted to so many digits
ENOUGH = 4  # times the waves up to which poles are counted, where no sign is known beyond
FURTHER = 60  # steps in which a frequency is sought beyond which the sign is known
BELOW = 1e3  # the last frequency over the first, where the sign next to 0 is not known
MOST_INTERVALS = 6_000  # of a search on the axis, whose rest is undecided
TERMS = 3  # of power series: a value, its slope and its curvature
NEXT_TO_ZERO = 1e-7  # share of the reach of series about 0, within which a real part is that at 0
FINE_RATIO = 1.05  # of the ends of pieces on which these series are evaluated
SHRINKINGS = 40  # halvings of the piece about 0 on which the sign is sought
FEW = 3  # intervals with an open sign, which are named one by one
NARROW = 10  # bits of an interval that is said to be a frequency
ASIDE = 0.4873  # where an interval is looked at, which is no root of a number that people write


@dataclass(frozen=True)
class ActiveBand:
    """An open interval of frequencies with a negative real part [rad/s]."""

    low: arb
    high: arb | None  # None where it has no end, or none is known

    def to_json_dict(self) -> dict[str, object]:
        """Return the band in Hz."""
        return {"from_hz": _hertz(self.low), "to_hz": None if self.high is None else _hertz(self.high)}


@dataclass(frozen=True)
class LeastPart:
    """The least real part; infinite where it falls without end."""

    value: arb
    omega: arb | None  # where it is [rad/s]; None where it is only approached as the frequency grows


@dataclass(frozen=True)
class RealPart:
    """The sign of a real part at all frequencies."""

    active: tuple[ActiveBand, ...]
    is_zero: bool = False  # proved to be zero everywhere: nothing is lost
    reasons: tuple[str, ...] = ()  # what is not proved: that it is nonnegative outside of the bands

    @property
    def is_nonnegative(self) -> bool | None:
        """Whether it is proved nonnegative everywhere; None where that is open."""
        return False if self.active else None if self.reasons else True


def real_part(bound: BoundTransferFunction, digits: int) -> RealPart:
    """Return where the real part of a function is negative, the ends to so many digits."""
    if bound.is_zero:
        return RealPart((), is_zero=True)
    return _of_polynomials(bound, digits) if bound.is_rational else _WavePart(bound, digits).found()


def least_part(bound: BoundTransferFunction, bands: Sequence[ActiveBand], digits: int) -> LeastPart | None:
    """Return the least real part; of functions with waves or delays in the bands, None without one."""
    if bound.is_zero:
        return LeastPart(arb(0), arb(0))
    if bound.is_rational:
        return _least_of_polynomials(bound, digits)
    inside = [band for band in bands if band.high is not None]
    return _LeastSearch(bound, digits).least(inside) if inside and len(inside) == len(bands) else None


def _open_at(omega: arb) -> str:
    """Return that a sign is open at a frequency, or in an interval of them."""
    if omega.rel_accuracy_bits() > NARROW:
        return f"whether the real part touches zero at {short_hertz(omega)} Hz"
    return _open_in(omega.lower(), omega.upper())


def _open_in(low: arb, high: arb) -> str:
    return f"the real part between {short_hertz(low)} and {short_hertz(high)} Hz"


def _hertz(omega: arb) -> float:
    return float((omega / (2 * arb.pi())).mid())


def _even_part(bound: BoundTransferFunction) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return ``N(s) D(-s) + N(-s) D(s)`` and ``2 D(s) D(-s)``."""
    context = bound.ratio.ring.context
    mirrored = [-context.gen(0), *context.gens()[1:]]
    n, d = (part.expand() for part in (bound.num, bound.den))
    n_mirrored, d_mirrored = (f.compose(*mirrored, ctx=context) for f in (n, d))
    return n * d_mirrored + n_mirrored * d, 2 * d * d_mirrored


def _on_axis(bound: BoundTransferFunction, polynomial: fmpz_mpoly, digits: int, *, odd: bool) -> list[arb]:
    """Return the positive frequencies of the roots on the axis, of odd order alone where asked for."""
    roots = find_polynomial_roots(problem_of(bound, [(polynomial, 1)]), digits)
    return sorted(
        (r.im for r in roots if r.on_imaginary_axis and r.im > 0 and (r.multiplicity % 2 or not odd)),
        key=lambda omega: float(omega.mid()),
    )


def _of_polynomials(bound: BoundTransferFunction, digits: int) -> RealPart:
    """Return the sign of the real part of a rational function."""
    even, _ = _even_part(bound)
    if even.is_zero():
        return RealPart((), is_zero=True)
    ends = _on_axis(bound, even, digits + SPARE_DIGITS, odd=True)
    polynomial = polynomial_in_s(bound, even)

    def sign(low: arb | None, high: arb | None) -> int:
        first = float(low.upper()) if low is not None else 0.0
        last = float(high.lower()) if high is not None else (2 * first or 1.0)
        place = first + ASIDE * (last - first)

        def decided() -> int:
            value = polynomial.enclosure()(acb(0, place)).real
            if value.contains(0):
                raise UndecidedError
            return 1 if value > 0 else -1

        return settled(decided, BITS)

    limits = [None, *ends, None]
    active = [
        ActiveBand(arb(0) if low is None else low, high)
        for low, high in pairwise(limits)
        if sign(low, high) < 0
    ]
    return RealPart(tuple(active))


def _least_of_polynomials(bound: BoundTransferFunction, digits: int) -> LeastPart:
    """Return the least real part of a rational function, at 0, at infinity, or where its slope vanishes."""
    context = bound.ratio.ring.context
    above, below = _even_part(bound)
    if above.is_zero():
        return LeastPart(arb(0), arb(0))
    common = above.gcd(below)
    above, below = above // common, below // common
    s = str(context.gen(0))
    slope = above.derivative(s) * below - above * below.derivative(s)
    p, q = (polynomial_in_s(bound, f) for f in (above, below))
    poles = _on_axis(bound, below, digits + SPARE_DIGITS, odd=False)
    flat = [] if slope.is_zero() else _on_axis(bound, slope, digits + SPARE_DIGITS, odd=False)

    def value(omega: arb) -> arb:
        return p.enclosure()(acb(0, omega)).real / q.enclosure()(acb(0, omega)).real

    with precision(max([bits_for_digits(digits), *(2 * x.bits() for x in (*flat, *poles))]) + BITS):
        if _falls_at_poles(p, q, poles):
            return LeastPart(arb("-inf"), next(iter(poles), arb(0)))
        values: list[tuple[arb, arb | None]] = [(value(omega), omega) for omega in flat]
        at_rest = value(arb(0))
        values += [(at_rest, arb(0))] if at_rest.is_finite() else []
        far = p.degree - q.degree
        if far <= 0:
            lead = p.enclosure()[p.degree] / q.enclosure()[q.degree] if far == 0 else arb(0)
            values.append((lead, None))
        finite = [(v, omega) for v, omega in values if v.is_finite()]
        if far > 0 and _sign_far_out(p, q) < 0:
            return LeastPart(arb("-inf"), None)
        least, where = min(finite, key=lambda each: float(each[0].mid()))
        near = [v for v, _ in finite if v.overlaps(least)]
        for v in near:
            least = least.union(v) if v is not least else least
        return LeastPart(least, where)


def _falls_at_poles(p: PolynomialInS, q: PolynomialInS, poles: Sequence[arb]) -> bool:
    """Tell whether a real part falls without end next to a pole on the axis."""
    for omega in [*poles, *([arb(0)] if q.coefficients[0].is_zero() else [])]:
        step = 1 + arb(2) ** (-(BITS // 4))
        for place in (omega * step, omega / step) if omega > 0 else (arb(2) ** (-BITS),):
            if p.enclosure()(acb(0, place)).real / q.enclosure()(acb(0, place)).real < 0:
                return True
    return False


def _sign_far_out(p: PolynomialInS, q: PolynomialInS) -> int:
    far = acb(0, arb(2) ** BITS)
    return 1 if p.enclosure()(far).real / q.enclosure()(far).real > 0 else -1


class _WavePart:
    """The sign of the real part of a function with waves or delays."""

    def __init__(self, bound: BoundTransferFunction, digits: int) -> None:
        self.bound, self.digits = bound, digits
        s = Factored.generator(bound.ratio.ring, bound.ratio.ring.names[0])
        self.function = LoopFunction.of(bound, s * bound.num, bound.den)

    def found(self) -> RealPart:
        """Return the sign at all frequencies."""
        reasons: list[str] = []
        waves = KernelFunction(self.bound, Factored.polynomial(self.bound.ratio.ring, self.function.b))
        far = waves.frequency_of(WAVES)
        known = self._next_to_zero(far)
        low = known or far / BELOW
        if known is None:
            reasons.append(f"the real part below {short_hertz(arb(low))} Hz")
        tail = self._tail(waves.frequency_of(1.0))
        high, beyond = tail or (waves.frequency_of(WAVES * ENOUGH), 0)
        if tail is None:
            reasons.append(f"the real part above {short_hertz(arb(high))} Hz")
        high = max(high, 2 * low)
        crossings = find_on_axis(
            self.function.on,
            LoopValue.crossing,
            lambda _: False,
            (low, high),
            self.digits + SPARE_DIGITS // 2,
            MOST_INTERVALS,
        )
        found, limits = (crossings.roots, crossings.undecided), (low, high)
        return self._between(*found, limits, beyond, reasons, is_open_below=known is None)

    def _between(
        self,
        roots: Sequence[arb],
        undecided: Sequence[arb],
        limits: tuple[float, float],
        beyond: int,
        reasons: list[str],
        *,
        is_open_below: bool,
    ) -> RealPart:
        """Return bands from the places at which the sign changes, or may.

        Where it may, no band reaches into the interval.
        """
        places = sorted((*roots, *undecided), key=lambda omega: float(omega.mid()))
        first = limits[0] if is_open_below else limits[0] / 2  # up to limits[0] it is that next to 0
        signs = [self._sign(x, y) for x, y in pairwise([arb(first), *places, arb(limits[1])])]
        lows, highs = [arb(limits[0]) if is_open_below else arb(0)], list[arb | None]()
        for omega, left, right in zip(places, signs, signs[1:], strict=False):
            is_change = left * right < 0 or any(omega is root for root in roots)
            highs.append(omega if is_change else omega.lower())
            lows.append(omega if is_change else omega.upper())
        doubtful = [omega for omega in places if not any(omega is end for end in (*lows, *highs))]
        wide = [omega for omega in doubtful if omega.rel_accuracy_bits() <= NARROW]
        if len(wide) > FEW:
            reasons.append(_open_in(wide[0].lower(), wide[-1].upper()) + ", in places")
            doubtful = [omega for omega in doubtful if not any(omega is other for other in wide)]
        reasons += map(_open_at, doubtful)
        highs.append(None if beyond < 0 else arb(limits[1]))
        bands = [ActiveBand(low, high) for low, high in zip(lows, highs, strict=True)]
        ends = [band.high or arb(limits[1]) for band in bands]
        reasons += [
            _open_in(band.low, end)
            for band, end, sign in zip(bands, ends, signs, strict=True)
            if not sign and band.low < end
        ]
        active = [band for band, sign in zip(bands, signs, strict=True) if sign < 0]
        if beyond < 0 and signs[-1] >= 0:
            active.append(ActiveBand(arb(limits[1]), None))
        return RealPart(tuple(active), reasons=tuple(dict.fromkeys(reasons)))

    def _sign(self, low: arb, high: arb) -> int:
        """Return the sign in an interval of frequencies without a root; 0 where it is not known."""
        first, last = float(low.upper()), float(high.lower())
        for share in (ASIDE, 0.25, 0.75) if first < last else ():
            _, centre = self.function.on(arb(first + share * (last - first)), BITS)
            with precision(BITS):
                value, _ = centre.crossing()
            if value > 0 or value < 0:
                return 1 if value > 0 else -1
        return 0

    def _next_to_zero(self, far: float) -> float | None:
        """Return a frequency up to which the sign does not change; None where none is known."""
        origin = self.function.at_origin()
        if origin is None:
            return None
        radius = origin.series[0].reach / 4
        radius = radius.min(origin.series[1].reach / 4).min(arb(far))
        for _ in range(SHRINKINGS):
            if origin.turns_away(radius.upper()):
                return float(radius.lower())
            radius /= 2
        return None

    def _tail(self, start: float) -> tuple[float, int] | None:
        """Return a frequency beyond which the sign does not change, and the sign there; None without one."""
        far = FunctionFarOut.of(self.bound, SECTORS)
        if far is None:
            return None
        for radius in (start * FIRST_RATIO**i for i in range(FURTHER)):
            known = far.angle_on_axis(radius)
            if known is None:
                continue
            angle, off = known
            with precision(BITS):
                right, left = abs(angle) + off < arb.pi() / 2, abs(angle) - off > arb.pi() / 2
            if right or left:
                return radius, 1 if right else -1
        return None


@dataclass(frozen=True, slots=True)
class _Slope:
    """The real part of a quotient on a ball of frequencies, with two derivatives in omega."""

    value: arb
    slope: arb
    curvature: arb

    @classmethod
    def of(cls, above: acb_series, below: acb_series) -> _Slope:
        """Return them of the quotient of two power series in s about ``j omega``."""
        if below[0].contains(0):
            return cls(arb("nan"), arb("nan"), arb("nan"))
        a, b = ([series[i] for i in range(TERMS)] for series in (above, below))
        y = series_quotient(a, b, TERMS)
        return cls(y[0].real, -y[1].imag, -2 * y[2].real)


class _LeastSearch:
    """The search for the least real part of a function with waves or delays, within bands."""

    def __init__(self, bound: BoundTransferFunction, digits: int) -> None:
        self.bound, self.digits = bound, digits
        self.function = LoopFunction.of(bound, bound.num, bound.den)
        self.best = arb(0)  # the least value met: what is above is dropped

    def least(self, bands: Sequence[ActiveBand]) -> LeastPart | None:
        """Return the least real part, at 0 or where its slope vanishes; None if not all is known."""
        found: list[tuple[arb, arb]] = []
        for band in bands:
            if band.high is None:
                return None
            low, high = float(band.low.lower()), float(band.high.upper())
            if not low:
                origin = _Origin.of(self.bound)
                if origin is None:
                    return None
                known, low = self._about_zero(origin, min(high, origin.reach))
                found += known
            inside = self._inside(low, high) if low < high else []
            if inside is None:
                return None
            found += inside
        if not found:
            return None
        with precision(BITS):
            least, where = min(found, key=lambda each: float(each[0].lower()))
            for value, omega in found:
                if not value > least:
                    least, where = least.union(value), where.union(omega)
            return LeastPart(least, where)

    def _about_zero(self, origin: _Origin, end: float) -> tuple[list[tuple[arb, arb]], float]:
        """Return enclosures about 0 that are sharp enough, and the frequency from which on to search."""
        ends = [(0.0, end * NEXT_TO_ZERO), *pieces(end * NEXT_TO_ZERO, end, FINE_RATIO)]
        places = [arb(low).union(arb(high)) for low, high in ends]
        known = [(origin.real_part(place), place) for place in places]
        with precision(BITS):
            self.best = min([self.best, *(x.upper() for x, _ in known if x.is_finite())], key=float)
            near = [(x, place) for x, place in known if not x > self.best]
            narrow = arb(10) ** -self.digits
            sharp = list(takewhile(lambda each: each[0].rad() < abs(each[0]) * narrow, near))
        rest = near[len(sharp) :]
        return sharp, max(float(rest[0][1].lower()), end * NEXT_TO_ZERO) if rest else end

    def _inside(self, low: float, high: float) -> list[tuple[arb, arb]] | None:
        """Return the real parts where their slope vanishes; None if that is not known everywhere."""
        for start, end in pieces(low, high, FINE_RATIO):
            self._on(arb(sqrt(start * end)), BITS)
        flat = find_on_axis(
            self._on,
            lambda place: (place.slope, place.curvature),
            lambda place: place.value.is_finite() and bool(place.value > self.best),
            (low, high),
            self.digits,
            MOST_INTERVALS,
        )
        bits = bits_for_digits(self.digits) + BITS
        return None if flat.undecided else [(self._on(omega, bits)[0].value, omega) for omega in flat.roots]

    def _on(self, omega: arb, bits: int) -> tuple[_Slope, _Slope]:
        """Return the real part on a ball of frequencies and in its middle."""
        with precision(bits):
            parts = self.function.characteristic(bits)
            places = [parts.at(acb_series([acb(0, x), acb(1)], TERMS)) for x in (omega, omega.mid())]
            less = parts.largest((0, 1), places[1])
            around, centre = (_Slope.of(*parts.series((0, 1), place, less)) for place in places)
            if centre.value.is_finite() and centre.value < self.best:
                self.best = centre.value.upper()
            if not (around.value.is_finite() and around.slope.is_finite()):
                return around, centre
            straight = centre.value + around.slope * (omega - omega.mid())
            return replace(around, value=around.value.intersection(straight)), centre


@dataclass(frozen=True)
class _Origin:
    """A function near 0, by power series."""

    series: LoopAtOrigin  # of s N and D

    @classmethod
    def of(cls, bound: BoundTransferFunction) -> _Origin | None:
        """Return it, None where it is not known or the function has a pole at 0 that is not simple."""
        s = Factored.generator(bound.ratio.ring, bound.ratio.ring.names[0])
        origin = LoopFunction.of(bound, s * bound.num, bound.den).at_origin()
        return None if origin is None or origin.orders[1] > origin.orders[0] else cls(origin)

    @property
    def reach(self) -> float:
        """The frequency up to which it is known [rad/s]."""
        return float(min(float(series.reach.lower()) for series in self.series.series) / 4)

    def real_part(self, omega: arb) -> arb:
        """Return a ball around the real part on a ball of frequencies."""
        with precision(ORIGIN_BITS):
            a, b = self.series.beside(omega)
            # With a = Re + j omega Im, Re(a/(j omega b)) is Im(a conj(b))/(omega abs(b)^2).
            return (a.imag * b.real - a.real * b.imag) / (b.real**2 + (omega * b.imag) ** 2)
