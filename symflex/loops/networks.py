"""Loops about networks of many members, whose determinant nobody writes out.

The gain stands in one row of the equations, so that their determinant is a straight line in it, and both
parts are determinants themselves, which :mod:`symflex.roots.networks` makes series of in a disc about 0:

    [M, e; r, 0], row i of the model being (M_i + K r) x = 0 and e the i-th unit vector:
    det (M + K e r) = A + K B with A = det M, B = -det [M, e; r, 0]

Poles at one gain are counted and enclosed in a disc, and followed from gain to gain there; for which gains
the loop is stable is not searched.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import nan
from typing import TYPE_CHECKING

from flint import acb

from symflex.algebra import Factored, degree_in, terms_of
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import names_among
from symflex.loops.loop import NO_LOOP, Loop, no_loop
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.disc_search import DiscSearch
from symflex.roots.networks.disc_series import DiscSeries
from symflex.roots.networks.poles_zeros import locate_quotient

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.equations import Equations
    from symflex.model import Model, ModelParameter
    from symflex.roots import PoleZeroMap, Region

DEFAULT_MODES = 5
"""Which the disc holds where no frequency is given."""
DIGITS = 15
"""Of poles that are marked in figures."""
LOOP_GAIN_BITS = 64
"""Of values that are drawn."""


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

    def in_disc(self, radius: float) -> LoopInDisc:
        """Return A and B in a disc about 0 [rad/s].

        UndecidedError, EssentialSingularityError where they are not enclosed there.
        """
        return LoopInDisc(*DiscSearch(self.cramer, DIGITS, (False, False)).series(radius))


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
            "SF801", f"'{gain.name}' is part of a wavenumber, a length or a delay and cannot be a gain", gain
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
        raise ModelError(Diagnostic("SF801", message, gain.span, NO_LOOP))
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
    """A and B as series in one disc."""

    a: DiscSeries
    minus_b: DiscSeries

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
