"""The largest magnitude of a transfer function over all real frequencies, and where it is.

Input: a bound transfer function, or a loop ``A + K B``. Output: a :class:`Peak`, an enclosure of the
L-infinity norm. Example: ``1/(s^2 + 2 z s + 1)`` has ``1/(2 z sqrt(1 - z^2))`` at ``omega^2 = 1 - 2 z^2``.

A rational function is largest at 0, at infinity or where its derivative vanishes, all of which is enclosed.
With waves and delays the axis is cut until the mean value theorem proves ``abs(A)^2 < M^2 abs(B)^2`` on each
piece, M just above the largest value met (Moore 1966). The H2 norm: Astrom, Jury and Agniel (1970).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import inf, pi
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, arb_poly, fmpz_mpoly

from symflex.algebra import NO_KERNELS, Factored, degree_in, real_parts
from symflex.balls import Open, UndecidedError, ball, bits_for_digits, branch, precision, settled
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.loops.axis import FIRST_RATIO, find_on_axis, joined, pieces
from symflex.loops.delayed_limit import delayed_bound, delayed_limit
from symflex.loops.loop_function import LoopFunction
from symflex.model.loss_factors import has_loss_factors
from symflex.model.model import IMAGINARY
from symflex.options import band_ends
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots import Band, Everything, Position, figure, find_polynomial_roots
from symflex.roots.distributed.far_out import SECTORS, FunctionFarOut
from symflex.roots.distributed.right_half_plane import WAVES
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.locate import locate
from symflex.roots.problem import is_complex, polynomial_in_s, problem_of
from symflex.roots.root import degrees, exact_fraction, hertz, real_json, short_hertz

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from symflex.loops.loop import Loop
    from symflex.loops.loop_function import LoopValue
    from symflex.options import Ends
    from symflex.roots import Root
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction


BITS, MOST_DIGITS, SPARE_DIGITS = 160, 30, 20  # of pieces, halved some hundred times; of frequencies
SUSPECT, NARROWEST, MOST_PIECES = 1e-9, 1e-30, 20_000
"""Relative widths at which a pole is looked for, and a search given up, as with so many pieces."""
NEGATIVE = "negative frequencies, at which complex coefficients give other magnitudes"
BELOW, SAME, FURTHER = 1e9, 1e-7, 60  # last frequency over the first; of places as one; far-out steps


@dataclass(frozen=True)
class Peak(Printed):
    """The largest magnitude on the imaginary axis, or the least bound of all."""

    tf: str
    unit: str
    digits: int
    band: Band | None  # searched; None for all frequencies
    magnitude: arb  # enclosure; infinite if a pole lies on the axis or the function grows without end
    places: tuple[arb, ...]  # [rad/s], one of which has it, as far as known; none as omega grows
    # Frequency [rad/s] above which it may be, too; infinite if it is only approached as omega grows.
    beyond: arb | None = None
    reasons: tuple[str, ...] = ()  # what is not proved
    h2: arb | None = None  # the H2 norm of a stable rational function
    what: str = "largest magnitude"  # of a matrix, its largest singular value

    @property
    def certified(self) -> bool:
        """Whether the enclosure is proved for all frequencies asked for."""
        return not self.reasons

    @property
    def frequency_hz(self) -> float:
        """Frequency of the peak [Hz]; infinite if it is approached as the frequency grows."""
        return float(hertz(self.places[0]).mid()) if self.places else inf

    @property
    def attained(self) -> bool | None:
        """Whether a frequency has it, and not only comes near; None if infinite, or not known."""
        if not self.magnitude.is_finite() or not self.certified or (self.beyond is None and not self.places):
            return None
        if self.beyond is None:
            return True
        return None if self.places or self.beyond.is_finite() else False

    @property
    def place(self) -> str:
        """Where it is, in words."""
        more = f", or at {len(self.places) - 1} more" if self.places[1:] else ""
        found = f"at {short_hertz(self.places[0])} Hz{more}" if self.places else ""
        if self.beyond is None:
            return found or "as the frequency grows"
        if self.beyond.is_finite():
            return f"{found}, or above {short_hertz(self.beyond)} Hz".removeprefix(", or ")
        rising = "approached as the frequency grows"
        return f"{found}, or {rising}" if found else f"{rising}, attained nowhere"

    def to_json_dict(self) -> dict[str, object]:
        """Return the peak in the schema ``symflex.peak/1``, ready for :func:`json.dumps`."""
        size, above = real_json(self.magnitude, self.digits), self.beyond
        return {
            "schema": "symflex.peak/1",
            "tf": self.tf,
            "unit": self.unit,
            "magnitude": size and size["value"],
            "radius": size and size["radius"],
            "infinite": size is None,
            "frequency_hz": self.frequency_hz if self.places else None,
            "omega": [real_json(omega, self.digits) for omega in self.places],
            "attained": self.attained,
            "or_above_hz": float(hertz(above).mid()) if above is not None and above.is_finite() else None,
            "band_hz": self.band and [float(self.band.low), float(self.band.high)],
            "certified": self.certified,
            "reasons": list(self.reasons),
            "h2": real_json(self.h2, self.digits),
        }

    def passages(self) -> list[Passage]:
        """Return the magnitude, where it is, and what is not proved."""
        where = f" from {float(self.band.low):g} Hz to {float(self.band.high):g} Hz" if self.band else ""
        status = "certified" if self.certified else "NOT CERTIFIED"
        lines = [f"{self.tf}{self.unit and f' [{self.unit}]'}   {status}{where}"]
        lines += [f"  not proved: {reason}" for reason in self.reasons]
        lines.append(f"  {self.what} {self._shown(self.magnitude)}, {self.place}")
        return [Passage(lines if self.h2 is None else [*lines, f"  H2 norm {self._shown(self.h2)}"])]

    def _shown(self, value: arb) -> str:
        decimals = real_json(value, self.digits)
        return "{value}, radius {radius}".format(**decimals) if decimals else "infinite"


@dataclass(frozen=True)
class LoopPeaks:
    """The peaks of ``S = 1/(1 + L)``, ``T = L/(1 + L)`` and ``S - T`` of a stable loop with loop gain L."""

    sensitivity: Peak
    complementary_sensitivity: Peak
    balanced: Peak
    bandwidth: arb | None  # where abs(T) is first 3 dB below its value at 0 [rad/s]; None if not proved

    @property
    def disk(self) -> dict[str, arb]:
        """The disk margin alpha, and the least and largest factor of L and the phase that it allows.

        L may be multiplied by every ``(2 + d)/(2 - d)`` with ``abs(d) < alpha``: balanced, sigma = 0 of
        Seiler, Packard and Gahinet (2020, IEEE Control Systems 40, no. 5, 78).
        """
        with precision(BITS):
            alpha = 2 / self.balanced.magnitude
            below, above, phase = 2 - alpha, 2 + alpha, degrees(2 * (alpha / 2).atan())
            most = above / below if below > 0 else arb("inf")
            return {"alpha": alpha, "least_factor": below / above, "largest_factor": most, "degrees": phase}

    def to_json_dict(self) -> dict[str, object]:
        """Return the peaks as a part of ``symflex.stability/1``."""
        margin = {name: real_json(value, self.balanced.digits) for name, value in self.disk.items()}
        found = {f.name: getattr(self, f.name).to_json_dict() for f in fields(self)[:3]}
        width = (w := self.bandwidth) and {"omega": real_json(w, 12), "frequency_hz": float(hertz(w).mid())}
        return found | {"disk_margin": margin, "bandwidth": width}

    @property
    def rows(self) -> list[tuple[str, str, str]]:
        """The rows of a table."""
        alpha, least, most, phase = (figure(x, 6) if x.is_finite() else "any" for x in self.disk.values())
        peaks = (self.sensitivity, self.complementary_sensitivity)
        rows = [(f"largest |{x.tf}|", figure(x.magnitude, 6), x.place) for x in peaks]
        rows.append(("disk margin", alpha, self.balanced.place))
        rows.append(("  allows", f"x {least} to {most}", f"or {phase} deg"))
        width = () if (w := self.bandwidth) is None else (("-3 dB of |T|", f"{short_hertz(w)} Hz", ""),)
        return [*rows, *width]


def loop_peaks(loop: Loop, gain: Fraction) -> LoopPeaks:
    """Return the peaks of a loop that is closed once, and stable for a gain."""
    (a, b), peaks = loop.with_gain[0].coefficients, list[Peak]()
    b = b * gain
    for name, num in (("S", a), ("T", b), ("S - T", a - b)):
        closed = replace(loop.bound, ratio=num / (a + b), parts=(num, a + b), is_of_model=False)
        peaks.append(replace(find_peak(closed), tf=name, unit=""))
    with precision(BITS):
        width = _bandwidth(loop.bound, LoopFunction.of(loop.bound, a + b, b))
    return LoopPeaks(peaks[0], peaks[1], peaks[2], width)


def _bandwidth(bound: BoundTransferFunction, inverse: LoopFunction) -> arb | None:
    """Return the first frequency [rad/s] at which ``abs(A/B) = 1/abs(T)`` is sqrt(2) times its value at 0."""
    origin = inverse.at_origin()
    if origin is None or origin.orders[0] != origin.orders[1]:
        return None
    above, below = origin.sizes(arb(0))
    level, low = abs(above / below) * arb(2).sqrt(), float((origin.series[0].reach / 4).lower())
    while origin.side(level, arb(low)) >= 0:
        low /= FIRST_RATIO
    waves = KernelFunction(bound, Factored.polynomial(bound.ratio.ring, inverse.b))
    end = min(low * BELOW, waves.frequency_of(WAVES) * FURTHER)
    for ends in pieces(low, end, FIRST_RATIO):
        found = find_on_axis(inverse.on, lambda v: v.excess(level), lambda _: False, ends, 12)
        if found.undecided or found.roots:
            return None if found.undecided else bound.frequency(found.roots[0])
    return None


def find_peak(bound: AnyBoundFunction, digits: int = 12, band: Ends | None = None) -> Peak:
    """Return the largest magnitude over all frequencies, or over a band [Hz], enclosed.

    SF802 for a network that is not written out, ValueError for a band that is none; SF505, SF506.
    """
    if not bound.is_reduced or (bound.root is not None and bound.root.shift != 0):
        message = "no peak is certified for networks that are not written out, or with a branch point but 0"
        raise UncertifiedError(Diagnostic("SF802", message))
    ends, s = None if band is None else Band(*band_ends(band)), bound.ratio.ring.context.gen(0)
    asked = Peak(bound.name, bound.source.unit, digits, ends, arb(0), (arb(0),))
    if bound.is_zero:
        return asked
    delays = []  # of all of it, which change no magnitude
    for kernel in bound.kernels.kernels:
        shift = kernel.dispersion.shift.factors
        if kernel.function == "exp" and all(e == 1 if f == s else not degree_in(f, 0) for f, e in shift):
            delays.append(bound.ratio.ring.generator(kernel.generator))
    value = bound.ratio.filter(lambda f: f not in delays) * bound.ratio.unit
    has_kernels = any(value.depends_on(name) for name in bound.kernels.generators)
    # Complex coefficients give other magnitudes at negative frequencies, unless they stand for losses.
    has_signs = is_complex(value) and ends is None and not has_loss_factors(bound.source.model)
    if has_signs and not has_kernels and bound.sheets == 1:
        return _of_complex_polynomials(replace(bound, ratio=value, kernels=NO_KERNELS, parts=None), asked)
    if has_kernels or bound.sheets > 1 or is_complex(value):
        with precision(BITS):
            found = _Pieces(bound, LoopFunction.of(bound, bound.num, bound.den), asked).peak()
        return replace(found, reasons=(*found.reasons, NEGATIVE)) if has_signs else found
    return _of_polynomials(replace(bound, ratio=value, kernels=NO_KERNELS, parts=None), asked)


def _of_polynomials(bound: BoundTransferFunction, asked: Peak) -> Peak:
    """Return the peak of a rational function, from the roots of the derivative of its squared magnitude."""
    context, band = bound.ratio.ring.context, asked.band
    mirrored, s = [-context.gen(0), *context.gens()[1:]], str(context.gen(0))
    parts = [part.expand() for part in (bound.num, bound.den)]
    n, d = (f * f.compose(*mirrored, ctx=context) for f in parts)
    slope = n.derivative(s) * d - n * d.derivative(s)
    above, below = (polynomial_in_s(bound, f) for f in parts)

    def on_axis(roots: Sequence[Root]) -> list[arb]:
        chosen = zip(roots, (band or Everything()).classify(roots), strict=True)
        inside = [root for root, position in chosen if position is not Position.OUTSIDE]
        return [root.im for root in inside if root.on_imaginary_axis and not root.im < 0]

    poles = find_polynomial_roots(problem_of(bound, bound.den.factors), asked.digits)
    degree = above.degree - below.degree
    if (infinite := on_axis(poles)) or (degree > 0 and band is None):
        return replace(asked, magnitude=arb("inf"), places=tuple(infinite[:1]))
    level = [] if slope.is_zero() else [(slope, 1)]
    flat = on_axis(find_polynomial_roots(problem_of(bound, level), asked.digits + SPARE_DIGITS))
    with precision(max([bits_for_digits(asked.digits), *(2 * omega.bits() for omega in flat)]) + BITS):
        ends = [arb(0)] if band is None else [2 * arb.pi() * ball(end) for end in (band.low, band.high)]
        num, den = (acb_poly(f.enclosure()) for f in (above, below))
        ends += [omega for omega in flat if omega > 0]
        sizes = [(abs(num(acb(0, x)) / den(acb(0, x))), [x]) for x in ends]
        if band is None and not degree:
            sizes.append((abs(num[above.degree] / den[below.degree]), []))
        magnitude, places, rises = _largest(sizes)
    reasons, h2 = () if magnitude.is_finite() else ("a pole may lie on the imaginary axis",), None
    if all(pole.re < 0 for pole in poles):
        h2 = arb("inf")
        if degree < 0:
            h2 = settled(lambda: h2_norm(above.enclosure(), below.enclosure(), asked.digits), BITS)
    beyond = arb("inf") if rises and level else None
    return replace(asked, magnitude=magnitude, places=places, beyond=beyond, reasons=reasons, h2=h2)


def _of_complex_polynomials(bound: BoundTransferFunction, asked: Peak) -> Peak:
    """Return the peak of a rational function with complex coefficients, at frequencies of both signs.

    At s = j x the squares of numerator and denominator are real polynomials A and B; ``A/B`` is flat where
    ``A' B = A B'``.
    """
    ring = bound.ratio.ring
    turned = [ring.generator(IMAGINARY) * ring.context.gen(0), *ring.context.gens()[1:]]

    def square(value: Factored) -> fmpz_mpoly:
        g, h = real_parts(ring, value.expand().compose(*turned, ctx=ring.context), IMAGINARY)
        return g * g + h * h

    def real_roots(polynomial: fmpz_mpoly) -> list[arb]:
        factors = [] if polynomial.is_zero() else [(polynomial, 1)]
        roots = find_polynomial_roots(problem_of(bound, factors), asked.digits + SPARE_DIGITS)
        return [root.re for root in roots if root.is_real]

    n, d = square(bound.num), square(bound.den)
    s = str(ring.context.gen(0))
    above, below = (polynomial_in_s(bound, f) for f in (n, d))
    if (infinite := real_roots(d)) or above.degree > below.degree:
        return replace(asked, magnitude=arb("inf"), places=tuple(infinite[:1]))
    level = n.derivative(s) * d - n * d.derivative(s)
    flat = real_roots(level)
    with precision(max([bits_for_digits(asked.digits), *(2 * omega.bits() for omega in flat)]) + BITS):
        num, den = above.enclosure(), below.enclosure()
        sizes = [((num(x) / den(x)).sqrt(), [x]) for x in (arb(0), *flat)]
        if above.degree == below.degree:
            sizes.append(((num[above.degree] / den[below.degree]).sqrt(), []))
        magnitude, places, rises = _largest(sizes)
    reasons = () if magnitude.is_finite() else ("a pole may lie on the imaginary axis",)
    beyond = arb("inf") if rises and not level.is_zero() else None
    return replace(asked, magnitude=magnitude, places=places, beyond=beyond, reasons=reasons)


def _largest(sizes: Sequence[tuple[arb, list[arb]]]) -> tuple[arb, tuple[arb, ...], bool]:
    """Return the largest magnitude, the frequencies at which it may be, and whether it is a limit alone.

    The limit far out stands without a frequency.
    """
    least = max((size.lower() for size, _ in sizes), key=float)
    top = [each for each in sizes if not each[0] < least]
    magnitude = least.union(max((size.upper() for size, _ in top), key=float))
    limits, others = ([size for size, at in sizes if bool(at) is is_at] for is_at in (False, True))
    rises = any(not (limit < least or any(x >= limit for x in others)) for limit in limits)
    return magnitude, tuple(x for _, roots in top for x in roots), rises


def h2_norm(above: arb_poly, below: arb_poly, digits: int) -> arb:
    """Return the H2 norm of a stable quotient that falls off, at the current precision."""
    a, b = (f.coeffs()[::-1] for f in (below, above))
    b, total = [arb(0)] * (len(a) - 1 - len(b)) + b, arb(0)
    while b:
        alpha, beta = a[0] / a[1], b[0] / a[1]
        total += beta**2 / (2 * alpha)
        odd = [c if i % 2 and i > 1 else arb(0) for i, c in enumerate([*a, arb(0)])]
        b = [c - beta * odd[i + 2] for i, c in enumerate(b[1:])]
        a = [c - alpha * odd[i + 2] for i, c in enumerate(a[1:])]
    if not total.sqrt().rel_accuracy_bits() > bits_for_digits(digits):
        raise UndecidedError
    return total.sqrt()


@dataclass(frozen=True, slots=True)
class AxisPiece:
    """A piece of the axis with the values on it."""

    size: float  # magnitude in the middle
    place: arb  # frequencies [rad/s]
    around: LoopValue
    centre: LoopValue

    @property
    def halves(self) -> tuple[arb, arb]:
        """Both halves of its frequencies."""
        middle = self.place.mid()
        return middle.union(self.place.lower()), middle.union(self.place.upper())

    def is_below(self, level: arb) -> bool:
        """Tell whether magnitudes on it are below a level."""
        value, slope = self.around.excess(level)
        middle = self.centre.excess(level)[0]
        return bool(value < 0) or bool(middle + slope * (self.place - self.place.mid()) < 0)


def _largest_first(pieces: Sequence[AxisPiece]) -> list[AxisPiece]:
    return sorted(pieces, key=lambda piece: piece.size, reverse=True)


class _Pieces:
    """The search for the peak of a quotient A/B with kernels."""

    def __init__(self, bound: BoundTransferFunction, function: LoopFunction, asked: Peak) -> None:
        self.bound, self.function, self.asked = bound, function, asked
        self.count, self.digits = 0, min(asked.digits, MOST_DIGITS)
        self.best, self.most = arb(0), arb(0)  # a magnitude that is come near; what bounds those far out
        self.beyond: arb | None = None  # where those begin, if one may be as large; infinite if it is less
        self.near: list[AxisPiece] = []  # all that may contain the peak

    def peak(self) -> Peak:
        """Return the peak."""
        bound, band, reasons, at_rest = self.bound, self.asked.band, list[str](), arb(0)
        waves = KernelFunction(bound, Factored.polynomial(bound.ratio.ring, self.function.b))
        low, high = 0.0, waves.frequency_of(WAVES)
        if band is not None:
            low, high = (bound.in_root(2 * pi * float(end)) for end in (band.low, band.high))
        # Where the numerator vanishes does not matter: that of a small difference may do so next to 0.
        origin = None if low else self.function.at_origin(beyond=(self.function.a,))
        if origin is not None:
            low = min(float((origin.series[0].reach / 4).lower()), high)
            if origin.orders[0] < origin.orders[1]:
                return replace(self.asked, magnitude=arb("inf"))
            if origin.orders[0] == origin.orders[1]:
                above, below = origin.sizes(arb(0))
                at_rest = abs(above / below)
                self.best = at_rest.lower()
        elif not low:
            low = high / BELOW
            reasons.append("magnitudes next to 0 Hz")
        pole = self._search(low, high)
        if band is None and pole is None:
            pole = self._search(high, self._tail(high, reasons))
        while pole is None and origin is not None and origin.side(self._level(), arb(low)) >= 0:
            low /= 2
            pole = self._search(low, 2 * low)
        if pole is not None:
            return replace(self.asked, magnitude=arb("inf"), places=(pole,))
        near = [piece.place * arb(1, SAME) for piece in self.near if not piece.is_below(self.best)]
        places = list(joined(sorted(near, key=lambda place: float(place.mid()))))
        if origin is not None and origin.side(self.best, arb(low)) >= 0:
            falls = origin.is_real and origin.excess(at_rest, arb(low))[1] < 0
            places.insert(0, arb(0) if falls else arb(0).union(arb(low)))
        found = replace(self.asked, magnitude=self.best.union(self._level()), reasons=tuple(reasons))
        beyond = None if self.most < self.best else self.beyond
        return replace(found, places=tuple(map(bound.frequency, places)), beyond=beyond)

    def _tail(self, end: float, reasons: list[str]) -> float:
        """Return a place beyond which magnitudes are below the level, which is raised if that is nowhere."""
        known = list[tuple[float, arb]]()
        far = FunctionFarOut.of(self.bound, -(-SECTORS // self.bound.sheets))
        terms = None if far is None or self.bound.sheets > 1 else far.delayed_terms(end)
        limit = None if terms is None else delayed_limit(*terms)
        if limit is not None:
            self.best = self.best.max(limit.size.lower())
        if limit is not None and limit.below_from is not None:
            self.most, self.beyond = limit.size.upper(), arb("inf")
            return max(end, limit.below_from)
        for radius in (end * FIRST_RATIO**i for i in range(FURTHER)):
            size = None if far is None else far.size(radius)
            most = None if terms is None else delayed_bound(*terms, radius)
            if size is not None and size.power <= 0:
                bound_here = (size.most * arb(radius) ** ball(size.power)).upper()
                most = bound_here if most is None else bound_here.min(most)
            if most is not None:
                known.append((radius, most))
                if most < self.best:
                    return radius
        if not known:
            shown = short_hertz(self.bound.frequency(arb(end)))
            reasons.append(f"above {shown} Hz no bound on the magnitude is known")
            return end
        start, self.most = known[0]
        self.beyond = self.bound.frequency(arb(start))
        return start

    def _level(self) -> arb:
        """Return a magnitude above the best by as little as the requested digits leave open."""
        return self.most.max((self.best * (1 + arb(10) ** -(self.digits + 1))).upper())

    def _search(self, low: float, high: float) -> arb | None:
        """Halve pieces until none may hold a larger magnitude; return a pole on the axis if one is met."""
        first = pieces(low, high, FIRST_RATIO) if low < high else []
        parts = [self._piece(arb(start).union(arb(end))) for start, end in first]
        search = branch(
            _largest_first(parts),
            self._decide,
            lambda piece: _largest_first([self._piece(half) for half in piece.halves]),
            until=lambda found, _: bool(found.decided),
        )
        return search.decided[0] if search.decided else None

    def _decide(self, piece: AxisPiece) -> arb | Open[AxisPiece] | None:
        """Drop a piece below the level, if it is near the best with a note of it; return a pole met there."""
        self.count += 1
        if piece.is_below(self._level()):
            self.near += [] if piece.is_below(self.best) else [piece]
            return None
        place = piece.place
        width = place.rad() / place.mid()
        if width < SUSPECT and piece.around.b.contains(0) and self.bound.is_of_model:
            ends = (exact_fraction(hertz(self.bound.frequency(x))) for x in (place.lower(), place.upper()))
            for pole in locate(self.bound, Band(*ends), with_zeros=False).poles:
                if pole.on_imaginary_axis and pole.im > 0:
                    return pole.im
        if self.count > MOST_PIECES or width < NARROWEST:
            message = f"the magnitude near {short_hertz(place)} Hz is not decided"
            raise BudgetError(Diagnostic("SF505", message, None, "give a --band without it"))
        return Open(piece)

    def _piece(self, place: arb) -> AxisPiece:
        around, centre = self.function.on(place, BITS)
        size = abs(centre.a) / abs(centre.b)
        self.best = size.lower() if size.is_finite() and size > self.best else self.best
        return AxisPiece(float(size.mid()), place, around, centre)
