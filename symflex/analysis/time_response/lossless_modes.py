"""Beams that lose nothing: their modes one by one, and a bound of all that are left out.

Input: a bound transfer function whose waves are those of undamped bending, over one length.
Output: the terms of modes, and how much those beyond may add up to.

Example: a cantilever. On the imaginary axis, s = 2 j t^2, its denominator over what grows fastest is

    d(t) = cos(t r) + 2 e^(-t r) + ...

Far out it is a trigonometric polynomial of theta = t r, whose coefficients are polynomials in u = 1/t, and
exponentials that have died away. All t > T are two small intervals, 0 <= u <= 1/T and 0 <= e^(-t r) <=
e^(-T r), and one turn of theta: a compact set, which is covered with balls. Where d may vanish, its slope
does not; so every turn has as many poles as there are such places, and what a residue is at most there, times
a power of t, bounds the sum over all.

The places are as many as a trigonometric polynomial of that order has zeros, so all poles beyond T lie on the
axis. That the modes are all there is follows from paths about 0 in the s plane that pass between them
(Churchill 1937, The inversion of the Laplace transformation by a direct expansion in series):
t = T_n + j y/r, abs(y) <= r T_n, all with the same theta. There d over e^(abs(y)) is a polynomial in
e^(-abs(y)) as well. Where it keeps away from 0 for all e^(-abs(y)) from 0 to 1, a compact set again, H falls
off on the paths like a power of t, and with it what lies beyond them (Jordan's lemma).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

from flint import acb, arb

from symflex.algebra import Factored, degree_in
from symflex.algebra.exponential_sum import Polynomial
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.function_size import ModesBound, Rest
from symflex.analysis.time_response.partial_fractions import ExponentialTerm
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import Refused
from symflex.balls import precision
from symflex.budget import spend
from symflex.roots import Root
from symflex.roots.axes.axis_function import IMAGINARY, AxisFunction, bits_of
from symflex.roots.axes.harmonic_sum import UNITS, lossless_function
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.transfer import BoundTransferFunction

BITS = 2 * bits_of(EFFORT.pole_digits)  # precision of every value
ANYWHERE = 0.7310585786  # turns of theta, as a rule without a root, where the constant in front is read


@dataclass(frozen=True)
class AxisFactor:
    """One factor of a function on the axis, divided by what grows fastest in it."""

    function: AxisFunction
    exponent: int
    growth: arb  # per t, of what it was divided by

    @cached_property
    def degree(self) -> int:
        """The highest power of t."""
        return max(n for w in self.function.waves for part in (w.even, w.odd) for n in part)

    @cached_property
    def turns(self) -> int:
        """The highest multiple of theta."""
        return max(abs(k) for wave in self.function.waves for k in (*wave.phase, 0))

    @property
    def has_corner(self) -> bool:
        """Whether what grows fastest also turns fastest, with the highest power of t."""
        return any(
            not any(w.growth)
            and max(map(abs, w.phase), default=0) == self.turns
            and max((*w.even, *w.odd), default=-1) == self.degree
            for w in self.function.waves
        )

    def around(self, theta: arb, least: arb) -> tuple[arb, arb]:
        """Return values and derivatives by t, over ``t^degree``, at all t beyond one with this theta."""
        total, slope = arb(0), arb(0)
        enclosures = self.function.enclosures
        for wave in self.function.waves:
            sine, cosine = (arb(sum(wave.phase)) * theta).sin_cos()
            growth, turn = (enclosures.rate(multiples)[0] for multiples in (wave.growth, wave.phase))
            even, even_slope = self._over_power(wave.even, least)
            odd, odd_slope = self._over_power(wave.odd, least)
            decay = (growth * least).exp().union(arb(0)) if any(wave.growth) else arb(1)
            total += decay * (even * cosine + odd * sine)
            slope += decay * (even_slope + growth * even + turn * odd) * cosine
            slope += decay * (odd_slope + growth * odd - turn * even) * sine
        return total, slope

    def keeps_away_from_zero(self, theta: arb, least: arb) -> bool:
        """Tell whether there is no zero at ``t + j y/r``, for all t beyond one with this theta, and all y."""
        for i in range(EFFORT.depths):
            v = (arb(i).union(arb(i + 1))) / EFFORT.depths  # exp(-abs(y))
            if self._across(theta, v, least).contains(0):
                return False
        return True

    def _across(self, theta: arb, v: arb, least: arb) -> acb:
        """Return values over ``t^degree e^(turns y)``, with ``v = exp(-y)`` for a positive y."""
        total = acb(0)
        for wave in self.function.waves:
            multiple = sum(wave.phase)
            k = abs(multiple)
            turned = acb(0, k * theta).exp()
            # exp(j k (theta + j y)) and its inverse, both over exp(turns y).
            fading, grown = turned * v ** (self.turns + k), v ** (self.turns - k) / turned
            sine = (fading - grown) / acb(0, 2 if multiple >= 0 else -2)
            bound = self._disc(wave.even, least) * (fading + grown) / 2 + self._disc(wave.odd, least) * sine
            if any(wave.growth):
                rate, _ = self.function.enclosures.rate(wave.growth)
                size = ((rate * least).exp() * bound.abs_upper()).upper()
                bound = acb(arb(0, size), arb(0, size))
            total += bound
        return total

    def _disc(self, polynomial: Polynomial, least: arb) -> acb:
        """Return a polynomial in t over ``t^degree``, at all complex t beyond a radius."""
        total = acb(0)
        for n, c in self.function.enclosures.coefficients(polynomial).items():
            reach = (least ** (n - self.degree)).upper()
            total += c * (acb(arb(0, reach), arb(0, reach)) if n < self.degree else acb(1))
        return total

    def _over_power(self, polynomial: Polynomial, least: arb) -> tuple[arb, arb]:
        """Return a polynomial in t and its derivative, over ``t^degree``, at all t from ``least`` on."""
        u = (1 / least).union(arb(0))
        value, slope = arb(0), arb(0)
        for n, c in self.function.enclosures.coefficients(polynomial).items():
            value += c * u ** (self.degree - n)
            slope += n * c * u ** (self.degree - n + 1)
        return value, slope


@dataclass(frozen=True)
class LosslessModes(ModesBound):
    """The modes of one function on the imaginary axis, with ``H = constant * exp(growth t) * factors``."""

    name: ClassVar = "lossless modes"
    slow: ClassVar = EFFORT.axis_modes

    function: BoundTransferFunction
    factors: tuple[AxisFactor, ...]
    rate: arb  # r of theta = t r

    @property
    def bound(self) -> BoundTransferFunction:
        """The function."""
        return self.function

    @property
    def poles(self) -> list[AxisFactor]:
        """The factors that have poles."""
        return [f for f in self.factors if f.exponent < 0 and f.turns]

    @cached_property
    def growth(self) -> arb:
        """How fast the function seems to grow with t, of what was divided out of its factors; at most 0."""
        return sum((f.growth * f.exponent for f in self.factors), arb(0))

    @cached_property
    def constant(self) -> acb:
        """What the product of all factors lacks to be the transfer function."""
        with precision(BITS):
            t = 2 * arb.pi() * arb(ANYWHERE) / self.rate
            value = self.bound.enclosed(BITS)(acb(0, 2 * t * t))
            for factor in self.factors:
                value = value / factor.function.values(BITS).value(t) ** factor.exponent
            return value / (self.growth * t).exp()

    def term(self, root: Root, integrations: int) -> ExponentialTerm | None:
        """Return what a pole on the axis and its conjugate add; None if it is not simple, or off the axis."""
        if not root.on_imaginary_axis:
            return None
        with precision(BITS):
            t = (root.im / 2).sqrt()
            residue, steep = self.constant * (self.growth * t).exp(), 0
            for factor in self.factors:
                values = factor.function.values(BITS)
                value = values.value(t)
                if value.contains(0) and factor.exponent < 0:
                    value, steep = values.slope(t), steep - factor.exponent
                residue = residue * value**factor.exponent
            s = acb(0, root.im)
            # ds = 4 j t dt
            residue = 2 * residue * acb(0, 4 * t) / s**integrations
            return ExponentialTerm(s, (residue,)) if steep == 1 and residue.is_finite() else None

    def rest(self, reached: float, integrations: int, times: SampleTimes) -> Rest | None:
        """Return a bound of all modes beyond a radius together."""
        with precision(BITS):
            power = sum(f.degree * f.exponent for f in self.factors) + 1 - 2 * integrations
            if power >= -1 or not all(f.has_corner for f in self.poles):
                return None
            least = (arb(reached).exp() / 2).sqrt()
            size = self._size_beyond(least)
            if size is None:
                return None
            turn = 2 * arb.pi() / self.rate
            # One turn may begin and end in the middle of a place.
            total = least**power + least ** (power + 1) / (turn * (-power - 1))
            tail = (size / arb(2) ** integrations * total).upper()
            return Rest(tail, (tail,) * len(times))

    def _size_beyond(self, least: arb) -> arb | None:
        """Return how large all residues in a turn are together over a power of t, for all t beyond one."""
        if not self._has_paths(least):
            return None
        largest, places, most = arb(0), 0, 0
        for factor in self.poles:
            size = self._largest(factor, least)
            if size is None or factor.exponent != -1:
                return None
            largest, places, most = largest.max(size[0]), places + size[1], most + 2 * factor.turns
        if places != most:
            return None
        return abs(self.constant) * (self.growth * least).exp() * 8 * largest * (places + 1)

    def _has_paths(self, least: arb) -> bool:
        """Tell whether paths pass between the poles on which no denominator comes close to 0."""
        places = (2 * arb.pi() * k / EFFORT.paths for k in range(EFFORT.paths))
        return any(all(f.keeps_away_from_zero(theta, least) for f in self.poles) for theta in places)

    def _largest(self, factor: AxisFactor, least: arb) -> tuple[arb, int] | None:
        """Return how large a residue is over powers of t, and at how many places; None if not bounded."""
        cell = 2 * arb.pi() / EFFORT.cells
        largest, signs = arb(0), []
        for k in range(EFFORT.cells):
            spend()
            theta = cell * arb(k + 0.5, 0.5)
            value, slope = factor.around(theta, least)
            if not value.contains(0):
                signs.append(0)
                continue
            if slope.contains(0):
                return None
            signs.append(1 if slope > 0 else -1)
            size = 1 / abs(slope)
            for other in self.factors:
                if other is not factor:
                    size = size * abs(other.around(theta, least)[0]) ** other.exponent
            if not size.is_finite():
                return None
            largest = largest.max(size.upper())
        return largest, sum(1 for a, b in zip(signs, signs[1:] + signs[:1], strict=True) if a and a != b)


def lossless_modes(bound: BoundTransferFunction, integrations: int) -> tuple[LosslessModes, int] | Refused:
    """Return what bounds the modes of undamped beams of one length, of the function or that over s."""
    modes = _modes_of(bound)
    if isinstance(modes, Refused) and integrations:
        s = Factored.generator(bound.ratio.ring, "s")
        modes = _modes_of(replace(bound, ratio=bound.ratio / s, parts=(bound.num, bound.den * s)))
        integrations -= 1
    return modes if isinstance(modes, Refused) else (modes, integrations)


def _modes_of(bound: BoundTransferFunction) -> LosslessModes | Refused:
    product = _multiplied(bound)
    function = None if product is None else KernelFunction(bound, product)
    if product is None or function is None or function.power != 1 or not (function.part / product).is_one:
        return Refused("poles may be multiple")
    lossless = lossless_function(function, BITS)
    if lossless is None:
        return Refused("something loses energy, or waves have two wavenumbers")
    enclosures = lossless.enclosures
    if len(enclosures.rates) != 1 or enclosures.degrees[0] != 1:
        return Refused("waves are of other kinds than bending, or of several lengths")
    factors = []
    with precision(BITS):
        for i, (terms, exponent) in enumerate(lossless.factors):
            on_axis = lossless.on_axis(i, IMAGINARY)
            waves = terms.turned(UNITS[IMAGINARY], enclosures.degrees).waves(1)
            if on_axis is None or not on_axis.waves or waves is None:
                return Refused("it is not real on the imaginary axis")
            fastest = max(wave.growth[0] for wave in waves)
            factors.append(AxisFactor(on_axis, exponent, enclosures.rates[0] * fastest))
        modes = LosslessModes(bound, tuple(factors), enclosures.rates[0])
        above = sum(f.turns * f.exponent for f in factors)
        if modes.growth > 0 or above > 0 or not modes.constant.is_finite():
            return Refused("it grows faster than its poles allow")
    return modes


def _multiplied(bound: BoundTransferFunction) -> Factored | None:
    """Return the function with one factor for all kernels above and one below, real on the axis, or None."""
    ring = bound.ratio.ring
    above, below = ring.constant(1), ring.constant(1)
    others = []
    for factor, exponent in bound.ratio.factors:
        if not any(degree_in(factor, ring.index[k.generator]) for k in bound.kernels.kernels):
            others.append((factor, exponent))
        elif exponent > 0:
            above = above * factor**exponent
        elif exponent == -1:
            below = below * factor
        else:
            return None
    together = ((above, 1), (below, -1))
    others += [(f, e) for f, e in together if not f.is_constant()]
    return Factored(ring, bound.ratio.unit, tuple(others))
