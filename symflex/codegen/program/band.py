"""From certified poles and zeros to a program that is exact over a band: the band form.

Input: a transfer function with numbers, and up to which frequency it is wanted.
Output: a :class:`BandForm`, the transfer function as

    H(s) = gain * s^k * product of (1 - s/z) over zeros / product of (1 - s/p) over poles * exp(q(s))

with the zeros z and poles p in the band and around it, and q a Chebyshev polynomial of what is left.

Theorem (Hadamard 1893; Bernstein 1912). What is left has neither poles nor zeros near the band, so its
logarithm is analytic there, and the coefficients of its Chebyshev series fall like ``rho^-n``, where the
ellipse of axes ``rho + 1/rho`` and ``rho - 1/rho``, in halves of the band, touches the next root. With
roots known to one and a half times the band's end rho is 6.9, in s^2, and 20 coefficients are all that
doubles can tell.

Every root is two doubles, its value and what that leaves: then ``(z - s) + rest`` has all its digits also
where s is close to z. The error of one double would be that of ``s - z``, 1e-10 at a distance of 1e-6 of z.

Example: the end of a string of length 1 m and wave speed 1 m/s moves by ``1/cosh(s)`` where the other end
is driven. Up to 3 rad/s, with the poles at ``j pi/2`` and, beyond, at ``3 j pi/2``:

    1 / ((1 + s^2/2.4674) (1 + s^2/22.207)) * exp(q(s)),  q = 0 at s = 0
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from math import inf, log2, prod, sqrt, tau

from flint import acb, arb

from symflex.balls import ball, precision, precisions
from symflex.budget import spend
from symflex.codegen.program.forge import Forge, schedule
from symflex.codegen.program.nodes import Laplace, Piecewise, RootFactor, Within
from symflex.errors import Diagnostic, ModelError
from symflex.roots import Band, Everything, Modes, PoleZeroMap, Root
from symflex.roots.locate import DEFAULT_MODES, locate
from symflex.roots.root import groups, modes_of
from symflex.transfer import AnyBoundFunction, AnyTransferFunction, BoundNested, BoundTransferFunction
from symflex.transfer.bound import Enclosed
from symflex.transfer.nested_form import EnclosedNested

BEYOND, FURTHER, ENOUGH = 5, Fraction(3, 2), Fraction(6, 5)
"""How far beyond the band roots are found: in modes, and in frequencies of a band given in Hz; and how
far beyond it the highest of as many zeros as poles has to lie."""

ROUNDS = 3  # how often roots are sought further away where what they leave is not smooth
DIGITS = 36  # digits of the roots: more than two doubles hold
FIRST_NODES, MOST_NODES = 24, 192  # points on the band's positive half for what is left; doubled at each try
SPARE, NEGLIGIBLE = 4, 2.0**-57
"""Last coefficients that count for nothing where there were points enough: their size changes no double."""
GROUP = 12  # zeros, and poles, that are multiplied before their products are divided: a division costs more
BITS = 160  # precision in which coefficients are summed: two doubles, and as much for what cancels
SLACK = 2.0**-40  # how far beyond the band's end a rounded frequency may be, relatively; beyond it is NaN
LUMPED_END = Fraction(10_000)  # end of the band [Hz] of a lumped function where nothing says another


FIRST_BITS, LAST_BITS, ENOUGH_BITS = 128, 4096, 64
"""Bits of a reference value with which work begins and ends, and how many of them must be certain."""


@dataclass(frozen=True, slots=True)
class EnclosedValue:
    """A transfer function's value and logarithmic derivative at a point, in balls."""

    value: acb
    slope: acb
    bits: int  # they were computed with


class EnclosedValues:
    """Enclosed values of a bound transfer function, as precise as doubles are compared with."""

    def __init__(self, bound: BoundTransferFunction | BoundNested) -> None:
        self.bound = bound
        self._first_bits = FIRST_BITS
        self._function: Callable[[int], Enclosed | EnclosedNested] = cache(bound.enclosed)

    def at(self, s: complex) -> EnclosedValue | None:
        """Return the value at ``s``, or ``None`` at a pole or zero."""
        point = acb(s.real, s.imag)
        for bits in precisions(self._first_bits, LAST_BITS):
            spend()
            value, slope = self._function(bits).value_and_slope(point)
            if not (value.is_finite() or self.bound.is_reduced):
                # Its program divides by zero for these values; without a slope errors count more.
                value, slope = self.bound.solved(point, bits), acb(0)
            if value.is_finite() and slope.is_finite() and value.rel_accuracy_bits() >= ENOUGH_BITS:
                if not self.bound.is_reduced:
                    self._first_bits = bits  # the next point most likely needs as many
                return EnclosedValue(value, slope, bits)
        return None


class SplitRoot(RootFactor):
    """A root, with its conjugate where it is not real, as sums of two doubles a part."""

    __slots__ = ()

    @property
    def count(self) -> int:
        """How many roots these are."""
        return (2 if self.is_pair else 1) * (2 if self.is_mirrored else 1)

    @property
    def scale(self) -> Fraction:
        """A power of two near to the size of the root's factor at s = 0."""
        return Fraction(2) ** round(self.count * log2(sqrt(self.re[0] ** 2 + self.im[0] ** 2)))

    @property
    def every(self) -> tuple[acb, ...]:
        """The roots that these are."""
        re, im = (arb(x[0]) + arb(x[1]) for x in (self.re, self.im))
        upper = (acb(re, im), acb(-re, im)) if self.is_mirrored else (acb(re, im),)
        return (*upper, *(z.conjugate() for z in upper)) if self.is_pair else upper

    def factor(self, s: acb) -> acb:
        """Return the value over the scale."""
        sign = -1 if not self.is_pair and (self.is_mirrored or self.re[0] < 0) else 1
        value = acb(sign) / ball(self.scale)
        for z in self.every:
            value = value * (z - s)
        return value


@dataclass(frozen=True)
class BandForm:
    """A transfer function as a product over its roots in and around a band."""

    name: str  # ``OUT/IN``
    end_hz: Fraction  # of the band
    gain: float
    power: int  # of s
    # zeros and poles: by rising frequency.
    zeros: tuple[SplitRoot, ...]
    poles: tuple[SplitRoot, ...]
    # q(s) = P(v) + (s/end) Q(v) with v = 2 (s/end)^2 + 1: Chebyshev coefficients of P and Q.
    even: tuple[float, ...]
    odd: tuple[float, ...]
    reason: str = ""  # why it is not proved that these are all roots; empty where it is

    @classmethod
    def zero(cls, name: str) -> BandForm:
        """Return that of a function that is zero at every s."""
        return cls(name, LUMPED_END, 0.0, 0, (), (), (), ())

    @property
    def end(self) -> float:
        """The end of the band [rad/s]."""
        return tau * float(self.end_hz)

    @property
    def is_limited(self) -> bool:
        """True where the form holds up to the band's end only: its roots are not all there are."""
        return bool(self.even or self.odd)

    @property
    def centers_hz(self) -> list[float]:
        """The frequencies of poles and zeros [Hz]: by their imaginary parts, and by their sizes."""
        centers = [(r.im[0], sqrt(r.re[0] ** 2 + r.im[0] ** 2)) for r in (*self.zeros, *self.poles)]
        return sorted({x / tau for pair in centers for x in pair if x})

    def sentences(self) -> tuple[str, ...]:
        """Return what a docstring says of it, in paragraphs."""
        words = [
            f"{number} {kind if number == 1 else kind + 's'}"
            for roots, kind in ((self.poles, "pole"), (self.zeros, "zero"))
            for number in (sum(root.count for root in roots),)
        ]
        degree = max(2 * len(self.even) - 2, 2 * len(self.odd) - 1, 0)
        at_zero = f"s^{self.power} * " if self.power else ""
        formula = (
            f"{self.name} = gain * {at_zero}product of (1 - s/z) over {words[1]} / product of (1 - s/p) over "
            f"{words[0]} * exp(q(s)), q a polynomial of degree {degree}."
        )
        proof = (
            f"It was not proved that these are all poles and zeros there: {self.reason}."
            if self.reason
            else "The poles and zeros in the band and around it are proved, and that there are no others."
        )
        end = f"abs(s) up to {self.end:.5g} rad/s, {float(self.end_hz):.5g} Hz"
        near = f"it is valid near the imaginary axis for {end}, and is NaN beyond"
        holds = near if self.is_limited else f"it was measured for {end}"
        return (
            formula,
            f"Band form: {holds}. {proof} Numbers are those of the file: no parameter can be changed here.",
        )

    def beside(self, part: float, error: str) -> str:
        """Return what a docstring says of values beside the axis, where the error was measured."""
        at = f"abs(re(s)) = {part * self.end:.3g} rad/s"
        rises = ", and larger further away" if self.is_limited else ""
        return f"Away from the axis, at {at}, the worst relative error is {error}{rises}."

    def program(self) -> Piecewise:
        """Return the program."""
        forge = Forge()
        s = forge.s
        if self.is_limited:
            s = forge.label(forge.make(Within, s, self.end * (1 + SLACK)), "z")
        factors = [forge.constant(Fraction(self.gain))]
        base = forge.power(s, abs(self.power))
        factors += [base] if self.power > 0 else [forge.divide(forge.constant(1), base)] if self.power else []
        for first in range(0, max(len(self.zeros), len(self.poles)), GROUP):
            zeros, poles = (x[first : first + GROUP] for x in (self.zeros, self.poles))
            sides = ([forge.make(r.with_children, [s]) for r in x] for x in (zeros, poles))
            above, below = map(forge.multiply, sides)
            scale = prod((r.scale for r in poles), start=Fraction(1)) / prod(r.scale for r in zeros)
            factors.append(forge.multiply([forge.constant(scale), forge.divide(above, below)]))
        if self.is_limited:
            factors.append(forge.apply("complex_exp", self._exponent(forge, s)))
        return schedule(forge, (), forge.multiply(factors), None, inf)

    def _exponent(self, forge: Forge, s: int) -> int:
        """Return q(s)."""
        end = Fraction(self.end)
        square = forge.multiply([forge.constant(4 / end**2), s, s])
        twice = forge.label(forge.add([forge.constant(2), square]), "w")
        parts = []
        if self.even:
            parts.append(_clenshaw(forge, self.even, twice))
        if self.odd:
            parts.append(forge.multiply([forge.constant(1 / end), s, _clenshaw(forge, self.odd, twice)]))
        return forge.label(forge.add(parts), "q")


def _clenshaw(forge: Forge, coefficients: Sequence[float], twice: int) -> int:
    """Return a Chebyshev sum at half of ``twice`` (Clenshaw 1955)."""
    zero = forge.constant(0)
    after, last = zero, zero
    for c in reversed(coefficients[1:]):
        terms = [forge.constant(Fraction(c)), forge.multiply([twice, after]), forge.negate(last)]
        after, last = forge.add(terms), after
    half = forge.multiply([forge.constant(Fraction(1, 2)), twice, after])
    return forge.add([forge.constant(Fraction(coefficients[0])), half, forge.negate(last)])


def is_closed(tf: AnyTransferFunction) -> bool:
    """Tell whether a function is a closed expression, not the solution of equations at every s."""
    if not tf.is_reduced or tf.is_rational:
        return tf.is_rational
    return not tf.is_nameless and not any(law.matrix for law in tf.kernels.dispersions)


def band_form(values: EnclosedValues, up_to: Fraction | None = None) -> BandForm:
    """Return the band form of a function up to a frequency [Hz], by default the end of the model's band.

    Roots that could not be proved serve where the rest proves to be smooth; SF910 where it is not.
    """
    bound = values.bound
    located, end = _located(bound, up_to)
    far = located.region.high if isinstance(located.region, Band) else end
    for _ in range(ROUNDS):
        made = _fitted(values, located, end)
        if made is not None:
            return made
        if isinstance(located.region, Everything):
            break
        far *= FURTHER
        located = locate(bound, Band(Fraction(0), far), DIGITS)
    reason = located.certificate.reason or "what remains after dividing by its poles and zeros is not smooth"
    message = f"{bound.name} has no band form up to {float(end):.4g} Hz: {reason}"
    raise ModelError(Diagnostic("SF910", message, None, "ask for a lower --up-to, or export it to numpy"))


def _located(bound: AnyBoundFunction, up_to: Fraction | None) -> tuple[PoleZeroMap, Fraction]:
    """Return poles and zeros in the band and around it, and the end of the band [Hz]."""
    analysis = bound.source.model.analysis
    if up_to is None and analysis.band is not None:
        up_to = analysis.band[1]
    if bound.is_rational:
        return locate(bound, Everything(), DIGITS), up_to or LUMPED_END
    if up_to is not None:
        return locate(bound, Band(Fraction(0), up_to * FURTHER), DIGITS), up_to
    modes = analysis.modes or DEFAULT_MODES
    located = locate(bound, Modes(modes + BEYOND), DIGITS)
    poles, zeros = ([root.frequency_hz() for root in modes_of(x)] for x in (located.poles, located.zeros))
    # Where no wave is reflected there may be few poles, and zeros without end.
    counted = poles if len(poles) > modes else zeros
    if len(counted) <= modes:
        return located, LUMPED_END
    # Between two modes, where the function is neither large nor small.
    end = Fraction(f"{sqrt(counted[modes - 1] * counted[modes]):.3g}")
    if len(zeros) >= modes + BEYOND and max(zeros) < ENOUGH * end:
        located = locate(bound, Band(Fraction(0), Fraction(max(counted))), DIGITS)
    return located, end


def _split(roots: Sequence[Root]) -> tuple[int, tuple[SplitRoot, ...]]:
    """Return how many roots are zero, or not told from it, and the others, each as often as it occurs."""
    split = []
    at_zero = [root for root in roots if root.is_zero or root.enclosure().contains(0)]
    for group in groups([root for root in roots if root not in at_zero]):
        upper = [root for root in group if not root.im < 0]
        left, right = ([r for r in upper if bool(r.re < 0) == is_left] for is_left in (True, False))
        is_mirrored = len(left) == len(right) == 1 and left[0].multiplicity == right[0].multiplicity
        for root in right if is_mirrored else upper:
            re = (0.0, 0.0) if root.on_imaginary_axis else _two_doubles(root.re)
            im = (0.0, 0.0) if root.is_real else _two_doubles(root.im)
            split += [SplitRoot(Laplace(), re, im, is_mirrored)] * root.multiplicity
    return sum(root.multiplicity for root in at_zero), tuple(split)


def _two_doubles(x: arb) -> tuple[float, float]:
    if x.contains(0):
        return 0.0, 0.0
    with precision(max(BITS, x.bits())):
        high = float(x.mid())
        return high, float((x.mid() - arb(high)).mid())


def _fitted(values: EnclosedValues, located: PoleZeroMap, end: Fraction) -> BandForm | None:
    """Return the band form with given roots; the result is None if what they leave is not smooth."""
    (below, poles), (above, zeros) = _split(located.poles), _split(located.zeros)
    reason = located.certificate.reason or "; ".join(
        f"infinitely many accumulate about {complex(hole.re, hole.im):.4g} rad/s" for hole in located.excluded
    )
    made = BandForm(values.bound.name, end, 1.0, above - below, zeros, poles, (), (), reason)
    count = FIRST_NODES
    while count <= MOST_NODES:
        fit = _fit(values, made, count)
        if fit is None:
            return None
        gain, even, odd = fit
        # Up to the last coefficient that counts.
        last = [max((i for i, c in enumerate(x) if abs(c) > NEGLIGIBLE), default=-1) for x in (even, odd)]
        kept = [tuple(x[: i + 1]) for x, i in zip((even, odd), last, strict=True)]
        if all(len(part) <= count - SPARE for part in kept):
            # All roots of a rational function leave nothing but the gain's rounding.
            if isinstance(located.region, Everything) and not reason:
                kept = [(), ()]
            return replace(made, gain=gain, even=kept[0], odd=kept[1])
        count *= 2
    return None


def _fit(values: EnclosedValues, made: BandForm, count: int) -> tuple[float, list[float], list[float]] | None:
    """Return the gain and the Chebyshev coefficients of the logarithm of what roots leave.

    Its imaginary part is continued from point to point along the derivative.
    """
    nodes = []
    for i in range(count):
        # Doubles, since functions are enclosed at doubles.
        x = float(_node(count, i).mid())
        s = complex(0.0, x * made.end)
        enclosed = values.at(s)
        if enclosed is None:
            return None
        nodes.append((x, *_left(made, acb(s), enclosed.value, enclosed.slope)))
    (lowest, first, slope), *_ = nodes
    with precision(BITS):
        at_zero = first * (acb(0, -lowest * made.end) * slope.real).exp()
        gain = (-1.0 if at_zero.real < 0 else 1.0) * float(abs(first).mid())
        even, odd, angle, before, tilt = [], [], arb(0), 0.0, float(slope.real.mid())
        for i, (x, value, slope) in enumerate(nodes):
            relative = value / arb(gain)
            tilt_here = float(slope.real.mid())
            expected = angle + arb((tilt + tilt_here) / 2 * (x - before) * made.end)
            turned = (relative * (acb(0, -1) * expected).exp()).arg()
            angle, before, tilt = expected + turned, x, tilt_here
            # From the double to the point itself: else the series would end in the double's rounding.
            node = _node(count, i)
            step = slope * acb(0, arb(made.end) * node - arb(x * made.end))
            even.append(abs(relative).log() + step.real)
            odd.append((angle + step.imag) / node)
        return gain, _chebyshev(even), _chebyshev(odd)


def _node(count: int, i: int) -> arb:
    """Return a positive point x, from small to large, with ``1 - 2 x^2`` a Chebyshev point."""
    return (arb.pi() * (2 * i + 1) / (4 * count)).sin()


def _left(made: BandForm, s: acb, value: acb, slope: acb) -> tuple[acb, acb]:
    """Return what is left of a value where roots are taken out, and its logarithmic derivative."""
    with precision(BITS):
        value, slope = value / s**made.power, slope - made.power / s
        for roots, sign in ((made.zeros, 1), (made.poles, -1)):
            for root in roots:
                value = value / root.factor(s) ** sign
                for z in root.every:
                    slope = slope - sign / (s - z)
        return value, slope


def _chebyshev(samples: Sequence[arb]) -> list[float]:
    """Return the coefficients of the polynomial with given values at Chebyshev points, from v = 1 down."""
    count = len(samples)
    coefficients = []
    for k in range(count):
        angles = ((2 * i + 1) * k for i in range(count))
        turns = [(arb.pi() * n / (2 * count)).cos() for n in angles]
        total = sum((y * turn for y, turn in zip(samples, turns, strict=True)), arb(0))
        coefficients.append(float((total * (1 if k == 0 else 2) / count).mid()))
    return coefficients
