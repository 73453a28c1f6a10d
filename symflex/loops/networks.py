"""Loops about networks of many members, whose determinant nobody writes out.

The gain stands in one row of the equations, so that their determinant is a straight line in it, and both
parts are determinants themselves, which :mod:`symflex.roots.networks` makes series of in a disc about 0:

    [M, e; r, 0], row i of the model being (M_i + K r) x = 0 and e the i-th unit vector:
    det (M + K e r) = A + K B with A = det M, B = -det [M, e; r, 0]

Poles at one gain are counted and enclosed in a disc, and followed from gain to gain there. A and B being
series in the disc, crossings of the imaginary axis are searched and poles in the right half-plane counted as
of any loop; that none lies beyond the disc is known of passive loops alone.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import nan

from flint import acb, arb

from symflex.algebra import LAPLACE, Factored, by_powers, composed, degree_in
from symflex.algebra.factored import least_common_multiple
from symflex.balls import UndecidedError, ball, precision
from symflex.equations import Equations
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.loops.axis import ORIGIN_BITS, LoopAtOrigin
from symflex.loops.axis_search import AxisSearch
from symflex.loops.loop import NO_LOOP, Loop, no_loop
from symflex.loops.loop_function import LoopValue
from symflex.loops.stability_map import Crossing, PoleCount
from symflex.model import Model, ModelParameter
from symflex.roots import PoleZeroMap, Region
from symflex.roots.counting.local_series import LocalSeries
from symflex.roots.locate import DEFAULT_MODES
from symflex.roots.networks.at_rest import order_at_zero
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.disc_search import DiscSearch, enclosed_roots, images
from symflex.roots.networks.disc_series import DiscSeries, RootNearCircleError
from symflex.roots.networks.parity import mirrored
from symflex.roots.networks.poles_zeros import locate_quotient
from symflex.roots.passivity import EnergyProof, energy_proof
from symflex.transfer.equations_at import EquationsAt, EssentialSingularityError, holds

DIGITS = 15  # of poles that are marked in figures
LOOP_GAIN_BITS = 64  # of values that are drawn
WIDER = 1.05  # radius of the disc of series over the frequency up to which poles are searched
SHARES = (0.999, 0.993, 0.98, 0.965, 0.955)  # of that radius: circles on which poles are counted in turn
BEYOND = "poles of a network are counted in a disc"


@dataclass(frozen=True, eq=False)
class NetworkLoop:
    """The characteristic function of a network as a straight line in one gain."""

    gain: ModelParameter
    nominal: Fraction | None  # its value, where that is a rational number
    cramer: CramerEquations  # whose denominator is A, and whose numerator is -B

    acts: int  # the row of the model that the gain stands in; r is the last row, e the last column

    @property
    def model(self) -> Model:
        """Whose characteristic function it is."""
        return self.cramer.equations.model

    @property
    def modes(self) -> int:
        """How many the model asks for."""
        return self.model.analysis.modes or DEFAULT_MODES

    def located(self, gain: Fraction, region: Region) -> PoleZeroMap:
        """Return poles and zeros of ``B/(A + K B)``, whose poles are those of the closed loop."""
        rows = list(self.cramer.entries)
        closed = dict(rows[self.acts])
        for j, slope in rows[-1].items():
            closed[j] = closed[j] + slope * gain if j in closed else slope * gain
        rows[self.acts] = {j: value for j, value in closed.items() if not value.is_zero}
        quotient = CramerEquations(self.cramer.equations, rows, self.cramer.divisor)
        return locate_quotient(quotient, "closed loop", region, DIGITS)

    def gains(self, gain: Fraction, omega: Sequence[float]) -> list[complex]:
        """Return the loop gain ``K B/A`` at frequencies [rad/s], not proved."""
        loop_gains = []
        for each in omega:
            value = self.cramer.at(acb(0, each), LOOP_GAIN_BITS)
            with precision(LOOP_GAIN_BITS):
                loop_gains.append(complex((-ball(gain) * value.num / value.den).mid()))
        return loop_gains

    @property
    def radius(self) -> float:
        """That of a disc [rad/s] that contains twice the requested modes, or all before roots accumulate."""
        return DiscSearch(self.cramer).radius_of(4 * self.modes) / WIDER

    def in_disc(self, radius: float) -> LoopInDisc:
        """Return A and B in a disc about 0 [rad/s], if they are enclosed there."""
        return LoopInDisc(*DiscSearch(self.cramer).series(radius))


AnyLoop = Loop | NetworkLoop


def network_loop(equations: Equations, gain: ModelParameter, nominal: Fraction | None) -> NetworkLoop | None:
    """Return a network's loop, ``None`` unless the gain is a factor in one row; SF801 if it shapes waves."""
    columns = {v: i for i, v in enumerate(equations.unknowns)}
    size = len(columns)
    ring = equations.ring
    index = ring.index.get(gain.name)
    if index is None:
        return None
    numeric = EquationsAt(equations)
    moving = numeric.moving(gain.name)
    if any(n in numeric.functions or n in numeric.waves_of for n in moving):
        raise no_loop(
            "SF801", f"'{gain.name}' is part of a wavenumber, a length or a delay and cannot be a gain", gain
        )
    read = equations.outputs[0].name
    plain = CramerEquations.of(equations, read, equations.inputs[0].owner).entries[:size]
    rows: list[dict[int, Factored]] = []
    border: dict[int, Factored] = {}
    acts: int | None = None
    for i, plain_row in enumerate(plain):
        kept: dict[int, Factored] = {}
        row = _opened(numeric, {j: value for j, value in plain_row.items() if j < size}, moving - {gain.name})
        for j, value in row.items():
            parts = _straight(value, index)
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
        raise ModelError(Diagnostic("SF801", message, gain.span, NO_LOOP))
    one = Factored.number(ring, 1)
    rows[acts][size] = one
    return NetworkLoop(gain, nominal, CramerEquations(equations, [*rows, border], one), acts)


def _opened(numeric: EquationsAt, row: dict[int, Factored], names: Collection[str]) -> dict[int, Factored]:
    """Return a row without these definitions, nor denominators in s that come of them."""
    if not any(holds(value, names) for value in row.values()):
        return row
    ring, propagation = numeric.equations.ring, numeric.equations.propagation
    for name in reversed([name for name in numeric.definitions if name in names]):
        meant = numeric.definitions[name]
        image = {name: meant if propagation is None else propagation.embed(meant)}
        row = {j: composed(x, image) if holds(x, (name,)) else x for j, x in row.items()}
    at_s, one = ring.index[LAPLACE], Factored.number(ring, 1)
    below = (x.denominator().filter(lambda f: degree_in(f, at_s) > 0) for x in row.values())
    common = least_common_multiple(one, below)
    return {j: x * common for j, x in row.items()}


def _straight(value: Factored, index: int) -> tuple[Factored, Factored] | None:
    """Return a and b of ``a + K b``; ``None`` where the value is no straight line in K."""
    ring = value.ring
    with_gain = [(f, e) for f, e in value.factors if degree_in(f, index)]
    if not with_gain:
        return value, Factored.number(ring, 0)
    if len(with_gain) > 1 or with_gain[0][1] != 1 or degree_in(with_gain[0][0], index) > 1:
        return None
    factor = with_gain[0][0]
    constant_factors = Factored(ring, value.unit, tuple((f, e) for f, e in value.factors if f != factor))
    parts = by_powers(ring, factor, index)
    constant, slope = (Factored.polynomial(ring, parts.get(n, ring.constant(0))) for n in (0, 1))
    return constant_factors * constant, constant_factors * slope


@dataclass
class NetworkFactors(AxisSearch):
    """The characteristic function of a network in a disc, for gains in a range."""

    loop: NetworkLoop
    gain: str  # its name
    limits: tuple[Fraction, Fraction]
    up_to: float | None  # a frequency up to which to search [rad/s]
    reasons: list[str] = field(default_factory=list)
    method: str = "series in a disc"
    is_narrowed: bool = False

    @cached_property
    def radius(self) -> tuple[float, bool]:
        """How far poles are searched [rad/s], and whether the loop is passive: none lies on the right."""
        radius = self.loop.radius if self.up_to is None else self.up_to
        if self.energy.rests:
            self.method = "passive loop"
            return radius, True
        passive = "; the loop is passive: none lies in the right half-plane" if self.energy.is_passive else ""
        self.reasons.append(BEYOND + passive)
        return radius, False

    @property
    def axis_end(self) -> float:
        """How far crossings of the axis are searched [rad/s]: there are none where all rests."""
        return 0.0 if self.radius[1] else self.radius[0]

    @property
    def scale(self) -> float:
        """A frequency of the loop [rad/s]."""
        return self.radius[0]

    @property
    def is_endless(self) -> bool:
        """Poles may lie all along the axis."""
        return True

    @cached_property
    def energy(self) -> EnergyProof:
        """What energy says of the poles for every gain in the range."""
        return EnergyProof() if self.limits[0] < 0 else energy_proof(self.loop.model, (), None, (self.gain,))

    @cached_property
    def function(self) -> LoopInDisc:
        """A and B in the disc, with the orders of their roots at 0."""
        cramer = self.loop.cramer
        try:
            both = self.loop.in_disc(self.radius[0] * WIDER)
            size = len(cramer.entries)
            least = [series.order_at_zero() for series in (both.a, both.minus_b)]
            orders = [n and order_at_zero(cramer, size - 1 + i, n) for i, n in enumerate(least)]
        except (UndecidedError, EssentialSingularityError) as error:
            message = "the loop's determinants are not enclosed in a disc"
            raise UncertifiedError(Diagnostic("SF802", message, None, "lower --up-to")) from error
        if orders != least:
            raise UncertifiedError(Diagnostic("SF802", "how many poles rest at s = 0 is not known"))
        return replace(both, orders=(least[0], least[1]))

    @property
    def with_gain(self) -> tuple[LoopInDisc]:
        """The function, which is one."""
        return (self.function,)

    @property
    def is_mirrored(self) -> bool:
        """Whether A and B are even or odd alike, so that roots mirror each other for every gain."""
        if self.radius[1]:
            return False
        orders = self.function.orders
        return all(mirrored(self.loop.cramer)) and (orders[0] - orders[1]) % 2 == 0

    def last_crossover(self, gain: arb) -> float:
        """Return the frequency [rad/s] up to which a loop gain of one is searched."""
        return self.radius[0]

    def crossings(self, digits: int) -> list[Crossing]:
        """Return where poles cross the axis for gains in the range."""
        return [] if self.radius[1] else self.crossings_of(self.function, digits)

    def count(
        self, gain: Fraction, below: PoleCount | None = None, crossed: Sequence[Crossing] = ()
    ) -> PoleCount:
        """Return how many poles in the disc lie in the right half-plane and on the axis, all enclosed."""
        function = self.function
        at_zero = min(function.orders)
        if self.radius[1]:
            return PoleCount(0, at_zero)
        series = function.a.plus(function.minus_b, -gain)
        message = f"poles in the right half-plane cannot be counted for a gain of {float(gain):.6g}"
        refusal = UncertifiedError(Diagnostic("SF802", message, None, "ask for another --up-to"))
        if series.order_at_zero() != at_zero:
            raise refusal
        boxes = [(box, n * images(box, is_even=False)) for box, n in enclosed_roots(series, at_zero)]
        for share in (1.0, *SHARES):
            # Poles in the left half-plane may lie on the circle: nothing else is asked of them.
            with suppress(RootNearCircleError):
                within = sum(n for box, n in boxes if box.abs_upper() < share)
                if series.count_about(acb(0), share) == within + at_zero:
                    break
        else:
            raise refusal
        inside = [(box, n) for box, n in boxes if box.abs_upper() < share]
        if any(box.real.contains(0) for box, _ in inside):
            raise refusal
        return PoleCount(sum(n for box, n in inside if box.real > 0), at_zero)


@dataclass(frozen=True, eq=False)
class LoopInDisc:
    """A and B as series in one disc."""

    a: DiscSeries
    minus_b: DiscSeries
    orders: tuple[int, int] = (0, 0)  # of the roots at 0, where they are asked for

    def on(self, omega: arb, bits: int) -> tuple[LoopValue, LoopValue]:
        """Return A and B on a ball of frequencies [rad/s] within the disc, and in its middle."""
        with precision(max(bits, self.a.bits)):
            box = acb(0, omega) / self.a.radius
            (a, a_mid), (b, b_mid) = (series.on(box) for series in (self.a, self.minus_b))
            one, two = (
                LoopValue(x[0], x[1] / self.a.radius, -y[0], -y[1] / self.a.radius)
                for x, y in ((a, b), (a_mid, b_mid))
            )
            return one, two

    def at_origin(self, times: float = 1.0) -> LoopAtOrigin | None:
        """Return A and B near 0: they are series about it already, which reach as far as the disc."""
        radius, series = self.a.radius, []
        with precision(ORIGIN_BITS):
            for sign, each in ((1, self.a), (-1, self.minus_b)):
                terms = tuple(sign * c / radius**k for k, c in enumerate(each.polynomial.coeffs()))
                series.append(LocalSeries(acb(0), terms, radius, each.off))
        return LoopAtOrigin(self.orders, tuple(series), None, acb(0, 1))

    def is_blurred(self, omega: arb) -> bool:
        """Return that series about 0 do not reach farther than these."""
        return False

    def near(self, s: complex) -> tuple[complex, complex, complex, complex]:
        """Return A, A', B and B' at a point, divided alike, without proof; beyond the disc nothing."""
        radius = self.a.radius
        if not abs(s) < radius:
            return (complex(nan),) * 4
        with precision(self.a.bits):
            x = acb(s.real, s.imag) / radius
            (a, b), (a_slope, b_slope) = (
                [one.polynomial(x) for one in (self.a, self.minus_b)],
                [one.polynomial.derivative()(x) / radius for one in (self.a, self.minus_b)],
            )
            size = (abs(a) + abs(b)).mid()
            scaled = [complex((value / size).mid()) for value in (a, a_slope, -b, -b_slope)]
        return scaled[0], scaled[1], scaled[2], scaled[3]
