"""Loops about networks of many members, whose determinant nobody writes out.

The gain stands in one row of the equations, so that their determinant is a straight line in it, and both
parts are determinants themselves, which :mod:`symflex.roots.networks` makes series of in a disc about 0:

    [M, e; r, 0], row i of the model being (M_i + K r) x = 0 and e the i-th unit vector:
    det (M + K e r) = A + K B with A = det M, B = -det [M, e; r, 0]

On the imaginary axis and right of it, the series say all that other loops learn from their formula, as far as
the disc reaches.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import nan, pi
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, ctx

from symflex.algebra import Factored, degree_in, terms_of
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.expressions import names_among
from symflex.loops.axis import LoopAtOrigin
from symflex.loops.axis_factors import AxisFactors
from symflex.loops.loop import NOTHING, Loop, LoopValue, no_loop
from symflex.loops.stability_map import PoleCount
from symflex.roots.counting.local_series import LocalSeries
from symflex.roots.networks.cramer import CramerEquations, EssentialSingularityError
from symflex.roots.networks.disc_search import DiscSearch, enclosed_roots, images
from symflex.roots.networks.disc_series import DiscSeries, RootNearCircleError, ball_about_zero
from symflex.roots.networks.members import UndecidedError
from symflex.roots.networks.poles_zeros import locate_quotient
from symflex.roots.precision import bits_for_digits
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.budget import Budget
    from symflex.equations import Equations
    from symflex.model import Model, ModelParameter
    from symflex.roots import PoleZeroMap, Region

DEFAULT_MODES = 5
"""Which the disc holds where no frequency is given."""
DIGITS = 15
"""Of poles that are marked in figures."""
LOOP_GAIN_BITS = 64
"""Of values that are drawn."""
SPARE_BITS = 64
"""Of a series, beyond the digits of gains."""
SHRUNK = (0.99, 0.975, 0.957, 0.94, 0.92)
"""Of the disc, circles on which poles are counted: the first on which none lies at that gain."""
SAMPLES = 64
"""Frequencies at which a series is examined."""
FEW = 20
"""Of so many values one may be less accurate: next to a zero."""
MOST_BITS = 4000
LOWER = "lower --up-to"
BEYOND = "whether poles of a network lie right of the axis beyond the frequency counted up to"
NOT_COUNTED = "the poles of the network cannot be counted"


@dataclass(frozen=True, eq=False)
class NetworkLoop:
    """The characteristic function of a network as a straight line in one gain."""

    gain: ModelParameter
    nominal: Fraction | None  # its value, where that is a rational number
    cramer: CramerEquations  # whose denominator is A, and whose numerator is -B

    # The row of the model that the gain stands in. r is the last of the rows, e the last of the columns.
    acts: int

    @property
    def model(self) -> Model:
        """Whose characteristic function it is."""
        return self.cramer.equations.model

    @property
    def modes(self) -> int:
        """How many the model asks for."""
        return self.model.analysis.modes or DEFAULT_MODES

    def located(self, gain: Fraction, region: Region, budget: Budget) -> PoleZeroMap:
        """Return poles and zeros of ``B/(A + K B)``, whose poles are those of the closed loop."""
        rows = list(self.cramer.entries)
        closed = dict(rows[self.acts])
        for j, slope in rows[-1].items():
            closed[j] = closed[j] + slope * gain if j in closed else slope * gain
        rows[self.acts] = {j: value for j, value in closed.items() if not value.is_zero}
        quotient = CramerEquations(self.cramer.equations, rows, self.cramer.divisor)
        return locate_quotient(quotient, "closed loop", region, DIGITS, budget)

    def gains(self, gain: Fraction, omega: Sequence[float]) -> list[complex]:
        """Return the loop gain ``K B/A`` at frequencies [rad/s], not proved."""
        found = []
        for each in omega:
            value = self.cramer.at(acb(0, each), LOOP_GAIN_BITS)
            with ctx.workprec(LOOP_GAIN_BITS):
                found.append(complex((-ball(gain) * value.num / value.den).mid()))
        return found

    def in_disc(self, radius: float, budget: Budget) -> LoopInDisc:
        """Return A and B in a disc about 0 [rad/s].

        UndecidedError, EssentialSingularityError where they are not enclosed there.
        """
        return LoopInDisc.of(DiscSearch(self.cramer, DIGITS, budget, (False, False)), radius)


AnyLoop = Loop | NetworkLoop


def network_loop(equations: Equations, gain: ModelParameter, nominal: Fraction | None) -> NetworkLoop | None:
    """Return a network's loop from equations with numbers in place of all parameters but the gain.

    ``None`` where the gain does not stand in one row alone, as a factor. SF801 where it shapes waves.
    """
    columns = {v: i for i, v in enumerate(equations.unknowns)}
    size = len(columns)
    ring = equations.ring
    place = ring.index.get(gain.name)
    if place is None:
        return None
    if _shapes_waves(equations, gain.name):
        raise no_loop(
            "SF801", f"'{gain.name}' is part of a wavenumber, a length or a delay, and no gain", gain
        )
    read = equations.outputs[0].name
    plain = CramerEquations.of(equations, read, equations.inputs[0].owner).entries[:size]
    rows: list[dict[int, Factored]] = []
    border: dict[int, Factored] = {}
    acts: int | None = None
    for i, row in enumerate(plain):
        kept: dict[int, Factored] = {}
        for j, value in row.items():
            if j >= size:
                continue
            parts = _straight(value, place)
            if parts is None:
                return None
            constant, slope = parts
            if not constant.is_zero:
                kept[j] = constant
            if not slope.is_zero:
                if acts not in (None, i):
                    return None
                acts, border[j] = i, slope
        rows.append(kept)
    if acts is None:
        message = f"no pole of the model depends on '{gain.name}'"
        hint = "a loop is closed in [signals], as in e = 'r - y', u = 'K*e'"
        raise ModelError(Diagnostic("SF801", message, gain.span, hint))
    one = Factored.number(ring, 1)
    rows[acts][size] = one
    return NetworkLoop(gain, nominal, CramerEquations(equations, [*rows, border], one), acts)


def _shapes_waves(equations: Equations, gain: str) -> bool:
    """Tell whether the gain is part of a wavenumber, a length, a delay, or a function of constants."""
    values = [value for _, value in equations.definitions]
    if equations.propagation is not None:
        values += [x for lengths in equations.propagation.lengths for x in lengths]
        for law in equations.propagation.table.dispersions:
            values += [*law.characteristic, law.shift]
    in_functions = any(names_among(c.expression, {gain}) for c in equations.constants)
    return in_functions or any(value.depends_on(gain) for value in values)


def _straight(value: Factored, place: int) -> tuple[Factored, Factored] | None:
    """Return a and b of ``a + K b``; ``None`` where the value is no straight line in K."""
    ring = value.ring
    with_gain = [(f, e) for f, e in value.factors if degree_in(f, place)]
    if not with_gain:
        return value, Factored.number(ring, 0)
    if len(with_gain) > 1 or with_gain[0][1] != 1 or degree_in(with_gain[0][0], place) > 1:
        return None
    factor = with_gain[0][0]
    rest = Factored(ring, value.unit, tuple((f, e) for f, e in value.factors if f != factor))
    parts = [ring.constant(0), ring.constant(0)]
    for monomial, coefficient in terms_of(factor):
        term = ring.constant(coefficient)
        for i, exponent in monomial:
            term = term * (ring.context.gen(i) ** exponent if i != place else ring.constant(1))
        parts[any(i == place for i, _ in monomial)] += term
    constant, slope = (Factored.polynomial(ring, part) for part in parts)
    return rest * constant, rest * slope


@dataclass(frozen=True, eq=False)
class LoopInDisc:
    """A and B as series in one disc, with what is known of them at 0."""

    a: DiscSeries
    b: DiscSeries
    orders: tuple[int, int] | None  # of their roots at 0; ``None`` where these are not proved

    @classmethod
    def of(cls, search: DiscSearch, radius: float) -> LoopInDisc:
        """Return denominator and numerator of a search, which are A and -B; it raises where they are not."""
        a, b = search.sides(radius)
        orders = (a.at_zero, b.at_zero) if not a.zero_reach and not b.zero_reach else None
        return cls(a.series, replace(b.series, polynomial=-b.series.polynomial), orders)

    @property
    def radius(self) -> arb:
        """Of the disc [rad/s]."""
        return self.a.radius

    def near(self, s: complex) -> tuple[complex, complex, complex, complex]:
        """Return A, A', B and B' at a point, divided alike, without proof; beyond the disc nothing."""
        if not abs(s) < self.radius:
            return (complex(nan),) * 4
        with ctx.workprec(self.a.bits):
            x = acb(s.real, s.imag) / self.radius
            (a, b), (a_slope, b_slope) = (
                [one.polynomial(x) for one in (self.a, self.b)],
                [one.polynomial.derivative()(x) / self.radius for one in (self.a, self.b)],
            )
            size = (abs(a) + abs(b)).mid()
            scaled = [complex((value / size).mid()) for value in (a, a_slope, b, b_slope)]
        return scaled[0], scaled[1], scaled[2], scaled[3]

    def on(self, omega: arb, bits: int, order: int = 1) -> tuple[LoopValue, LoopValue]:
        """Return the values on a ball of frequencies, and those in its middle; derivatives are first ones."""
        del bits, order  # those of the series
        with ctx.workprec(self.a.bits):
            x, middle = acb(0, omega) / self.radius, (acb(0, omega.mid()) / self.radius).mid()
            wide: list[acb] = []
            narrow: list[acb] = []
            for series in (self.a, self.b):
                # Terms about the middle: on a ball those about 0 would take each other out.
                local = series.about(middle)
                slope_off = ball_about_zero(series.slope_off)
                spread = acb_poly(local).derivative()(x - middle) + slope_off
                centre = local[0] + ball_about_zero(series.off)
                wide += [centre + spread * (x - middle), spread / self.radius]
                narrow += [centre, (local[1] + slope_off) / self.radius]
        (a, a_slope, b, b_slope), (a_mid, a_mid_slope, b_mid, b_mid_slope) = wide, narrow
        return (
            LoopValue(a, a_slope, b, b_slope, NOTHING, NOTHING),
            LoopValue(a_mid, a_mid_slope, b_mid, b_mid_slope, NOTHING, NOTHING),
        )

    def accuracy(self) -> int:
        """Return to how many bits values along the axis are known, but for a few next to their zeros."""
        omegas = (self.radius * SHRUNK[-1] * (k + 1) / SAMPLES for k in range(SAMPLES))
        values = [self.on(omega.mid(), 0)[1] for omega in omegas]
        known = sorted(x.rel_accuracy_bits() for v in values for x in (v.a, v.b))
        return known[len(known) // FEW]

    @property
    def is_mirrored(self) -> bool:
        """Both are even or odd, as far as their series tell: roots mirror each other in the axis."""
        return all(
            any(all(c.contains(0) for c in series.polynomial.coeffs()[k::2]) for k in (0, 1))
            for series in (self.a, self.b)
        )

    def at(self, gain: Fraction) -> DiscSeries:
        """Return ``A + K B``."""
        with ctx.workprec(self.a.bits):
            k = ball(gain)
            polynomial = self.a.polynomial + acb(k) * self.b.polynomial
            off, slope = (
                one + abs(k) * other
                for one, other in ((self.a.off, self.b.off), (self.a.slope_off, self.b.slope_off))
            )
        return replace(self.a, polynomial=polynomial, off=off, slope_off=slope)

    def local(self) -> tuple[LocalSeries, LocalSeries]:
        """Return both as series about 0 in s."""
        found = []
        for series in (self.a, self.b):
            with ctx.workprec(series.bits):
                coefficients, power, bound = [], arb(1), series.off
                for c in series.polynomial.coeffs():
                    coefficients.append(c * power)
                    power /= self.radius
                    bound += abs(c)
                found.append(LocalSeries(acb(0), tuple(coefficients), self.radius, arb(bound.upper())))
        return found[0], found[1]


@dataclass
class NetworkFactors(AxisFactors[LoopInDisc]):
    """A network's characteristic function on the imaginary axis and in half a disc right of it."""

    loop: NetworkLoop
    limits: tuple[Fraction, Fraction]  # range of the gain
    up_to: float | None  # a frequency up to which to search [rad/s]
    digits: int  # of gains
    budget: Budget
    reasons: list[str] = field(default_factory=list)
    method: str = "network"
    _wanted: float | None = None  # radius [rad/s] in which poles are counted

    @cached_property
    def function(self) -> LoopInDisc:
        """A and B; SF802 where their roots in the disc are not all proved."""
        self.reasons.append(BEYOND)
        wanted = bits_for_digits(self.digits)
        extra = wanted + SPARE_BITS
        while True:
            function = self._to_bits(extra)
            known = function.accuracy()
            if known >= wanted:
                return function
            extra += wanted - known + SPARE_BITS
            if extra > MOST_BITS:
                raise UncertifiedError(Diagnostic("SF802", NOT_COUNTED, None, LOWER))

    def _to_bits(self, extra: int) -> LoopInDisc:
        search = DiscSearch(self.loop.cramer, self.digits, self.budget, (False, False), extra)
        try:
            if self._wanted is None:
                self._wanted = self.up_to or search.radius_of(2 * self.loop.modes + 1)
            return LoopInDisc.of(search, self._wanted / SHRUNK[-1])
        except (EssentialSingularityError, UndecidedError) as error:
            raise UncertifiedError(Diagnostic("SF802", NOT_COUNTED, None, LOWER)) from error

    @property
    def with_gain(self) -> tuple[LoopInDisc, ...]:
        """Return A and B: the determinant is one factor."""
        return (self.function,)

    @property
    def radius(self) -> tuple[float, bool]:
        """How far poles are searched [rad/s]; beyond that nothing is proved."""
        return float(self.function.radius) * SHRUNK[-1], False

    @property
    def axis_end(self) -> float:
        """Where the largest of the circles meets the axis [rad/s]: what is counted crosses below."""
        return float(self.function.radius) * SHRUNK[0]

    @property
    def scale(self) -> float:
        """A frequency of the order of the lowest mode's [rad/s]."""
        return float(self.function.radius) / self.loop.modes**2

    def is_mirrored(self, function: LoopInDisc) -> bool:
        """Tell whether A and B are even or odd alike."""
        return function.is_mirrored

    def tells_meetings(self, function: LoopInDisc) -> bool:
        """Return False: second derivatives are not enclosed."""
        del function
        return False

    def origin(self, function: LoopInDisc) -> LoopAtOrigin | None:
        """Return A and B near 0, ``None`` where their orders cannot be told."""
        return None if function.orders is None else LoopAtOrigin(function.orders, function.local())

    def last_crossover(self, function: LoopInDisc, gain: arb) -> float:
        """Return how far poles are searched."""
        del function, gain
        return self.axis_end

    def count(self, gain: Fraction) -> PoleCount:
        """Return how many poles lie right of the axis and on it; SF802 where that is not proved."""
        orders = self.function.orders
        series = self.function.at(gain)
        if orders is None:
            at_zero = series.order_at_zero()
            self.reasons.append("poles next to s = 0 are counted as poles at 0")
        else:
            at_zero = min(orders) if gain else orders[0]
        for share in SHRUNK:
            self.budget.spend()
            try:
                total = series.count_about(acb(0), share)
                found = [(box, n) for box, n in enclosed_roots(series, at_zero) if abs(box) < share]
            except RootNearCircleError:
                continue
            if at_zero + sum(n * images(box, is_even=False) for box, n in found) != total:
                continue
            on_axis = [(box, n) for box, n in found if box.real.contains(0)]
            if on_axis and not self.function.is_mirrored:
                break
            right = sum(n * images(box, is_even=False) for box, n in found if box.real > 0)
            axis = sum(n * images(box, is_even=False) for box, n in on_axis)
            if on_axis:
                self.reasons.append("poles next to the axis are counted as poles on it")
            return PoleCount(right, axis + at_zero)
        message = f"poles right of the axis cannot be counted for a gain of {float(gain):.6g}"
        hint = f"ask for another frequency than --up-to {self.radius[0] / (2 * pi):.4g} Hz, or another range"
        raise UncertifiedError(Diagnostic("SF802", message, None, hint))
