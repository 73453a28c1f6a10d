"""For which values of one parameter, or of two, a machine is passive where it is touched.

Input: a model, a port, and one parameter or two. Output: a :class:`PassiveValues`, or a :class:`PassiveChart`
of such at many values of the second.

If the coefficients of a rational function are polynomials in the parameter, the number of sign changes of its
real part can only change where the polynomial of these signs has a double root, a root at 0 or at infinity,
and the number of unstable poles only where one meets the axis. All such values are roots of resultants
(Collins 1975); between two of them one value decides. Else values are tried and halved: where the impedance
or the admittance is a straight line in the parameter, the passive values are an interval, as sums of positive
real functions are positive real; where it is not, what lies between values that were tried is not proved.

    lagged wall    Re Z = b - K tau/(1 + (omega tau)^2)    passive for K < b/tau
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from math import gcd

from flint import arb, fmpz_mpoly

from symflex.algebra import degree_in, irreducible_factors
from symflex.balls import Branching, ball, branch, precision
from symflex.contact.hybrid import changes_of, find_hybrid
from symflex.contact.passivity import find_passivity
from symflex.contact.port import at_port
from symflex.contact.two_ports import find_two_ports
from symflex.errors import BudgetError, Diagnostic, SymflexError, UsageError, refused
from symflex.loops.loop import pick_gain
from symflex.loops.over import limits_of
from symflex.model import ContactPort, ExactValue, Model, ModelParameter, with_numbers
from symflex.model.ports import port_named
from symflex.options import PassivityOptions
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots import RootProblem, find_polynomial_roots
from symflex.roots.problem import PolynomialInS
from symflex.roots.root import figure, real_json
from symflex.transfer import TransferFunction
from symflex.transfer.of_model import derive_all

BITS = 256
TRIED = 9  # values tried at first where no polynomial decides
ASIDE = Fraction(1, 97)  # share of the range by which they are off equal parts
SHARE = Fraction(1, 10_000)  # of the range, to which ends are halved then
SLICES = 21  # values of the second parameter of a chart
COARSEST = 8  # every so many slices are the first: if the time ends, what is known is spread over the range
SPARE = 8  # digits of roots beyond those printed
NOT_EVERY = "some values that were tried are not decided, or none of them is passive"
TRIED_ONLY = "between values that were tried, as of two ports no polynomial says where a verdict changes"
NOT_BETWEEN = "between values that were tried, as neither impedance nor admittance is a straight line in '{}'"


@dataclass(frozen=True)
class PassiveInterval:
    """An open interval of values on which a machine is passive, or is not."""

    low: arb
    high: arb
    passive: bool | None


@dataclass(frozen=True)
class PassiveValues(Printed):
    """For which values of a parameter a machine is passive."""

    port: ContactPort
    parameter: ModelParameter
    limits: tuple[Fraction, Fraction]
    intervals: tuple[PassiveInterval, ...]
    digits: int
    reasons: tuple[str, ...] = ()  # what is not proved

    @property
    def certified(self) -> bool:
        """Whether all of the range is decided, but for the enclosures of the ends."""
        return not self.reasons and all(i.passive is not None for i in self.intervals)

    @property
    def passive(self) -> tuple[PassiveInterval, ...]:
        """The intervals with passive values."""
        return tuple(i for i in self.intervals if i.passive)

    def to_json_dict(self) -> dict[str, object]:
        """Return the values in the schema ``symflex.passivity_over/1``, in SI units."""
        return {
            "schema": "symflex.passivity_over/1",
            "port": self.port.name,
            "parameter": self.parameter.name,
            "unit": self.parameter.unit,
            "range": [float(x) for x in self.limits],
            "intervals": [
                {
                    "low": real_json(i.low, self.digits),
                    "high": real_json(i.high, self.digits),
                    "passive": i.passive,
                }
                for i in self.intervals
            ],
            "certified": self.certified,
            "reasons": list(self.reasons),
        }

    def passages(self) -> list[Passage]:
        """Return the passive values."""
        unit, size = self.parameter.counted_in
        name, status = self.parameter.name, "certified" if self.certified else "NOT CERTIFIED"
        low, high = (float(x / size) for x in self.limits)
        lines = [f"{name}{unit and f' [{unit}]'}   {status}: passive at port {self.port.name}"]
        lines += [f"{INDENT}examined: {low:.6g} < {name} < {high:.6g}"]
        lines += [f"{INDENT}not proved: {reason}" for reason in self.reasons]
        for word, is_passive in (("passive", True), ("not decided", None)):
            chosen = [i for i in self.intervals if i.passive is is_passive]
            lines += [f"{INDENT}{word} for:"] if chosen else []
            for i in chosen:
                with precision(BITS):
                    # An end between values that were tried is known to few digits.
                    spans = (i.low.lower(), i.high.upper()) if is_passive is None else (i.low, i.high)
                    ends = [figure(x / ball(size), self.digits, trimmed=True) for x in spans]
                lines.append(f"{INDENT * 2}{ends[0]} < {name} < {ends[1]}")
        if not self.passive and self.certified:
            lines.append(f"{INDENT}passive for none of them")
        return [Passage(lines)]


@dataclass(frozen=True)
class PassiveChart(Printed):
    """For which values of one parameter a machine is passive, at many values of another."""

    other: ModelParameter
    slices: tuple[tuple[Fraction, PassiveValues], ...]
    missing: tuple[str, ...] = ()  # which slices the budget left out

    @property
    def certified(self) -> bool:
        """Whether every slice is, and none is missing."""
        return not self.missing and all(values.certified for _, values in self.slices)

    def to_json_dict(self) -> dict[str, object]:
        """Return the chart in the schema ``symflex.passivity_chart/1``, in SI units."""
        first = self.slices[0][1]
        return {
            "schema": "symflex.passivity_chart/1",
            "port": first.port.name,
            "parameters": [first.parameter.name, self.other.name],
            "units": [first.parameter.unit, self.other.unit],
            "slices": [{"value": float(value)} | values.to_json_dict() for value, values in self.slices],
            "certified": self.certified,
            "reasons": list(self.missing),
        }

    def passages(self) -> list[Passage]:
        """Return a row per value of the second parameter."""
        first = self.slices[0][1]
        (unit, size), (other_unit, other_size) = first.parameter.counted_in, self.other.counted_in
        name, other = first.parameter.name, self.other.name
        low, high = (float(x / size) for x in first.limits)
        status = "certified" if self.certified else "NOT CERTIFIED"
        lines = [f"{name}, {other}   {status} at each value of {other}: passive at port {first.port.name}"]
        lines += [f"{INDENT}examined: {low:.6g} < {name} < {high:.6g}"]
        reasons = dict.fromkeys((*self.missing, *(r for _, values in self.slices for r in values.reasons)))
        lines += [f"{INDENT}not proved: {reason}" for reason in reasons]
        rows: list[tuple[str, ...]] = [
            (f"{other} [{other_unit}]" if other_unit else other, f"passive {name} [{unit}]" if unit else name)
        ]
        for value, values in self.slices:
            with precision(BITS):
                spans = [
                    " to ".join(figure(x / ball(size), 6, trimmed=True) for x in (i.low, i.high))
                    for i in values.passive
                ]
            rows.append((f"{float(value / other_size):.6g}", ", ".join(spans) or "none"))
        return [Passage(lines, rows)]


def passive_over(model: Model, given: PassivityOptions) -> PassiveValues | PassiveChart:
    """Return for which values of one parameter or two a machine is passive at a port.

    Raises UsageError: SF902 for an unknown parameter or too many, SF804 for a range that is needed or empty.
    """
    names = tuple(given.over)
    if len(names) > 2 or len(set(names)) < len(names):  # noqa: PLR2004 (a chart has two axes)
        raise UsageError(Diagnostic("SF902", "give one or two parameters, each once: --over K --over B"))
    if len(given.ports) > 1 and model.sampled is not None:
        raise refused("two ports of a machine with a sampled controller are not judged", "name one of them")
    ports = tuple(port_named(model, name) for name in given.ports or (None,))
    first, *others = (pick_gain(model.parameters, name) for name in names)
    limits = limits_of(model, first, given.stability)
    if not others:
        return _values_of(model, ports, first, limits, given.digits)
    (other,) = others
    low, high = limits_of(model, other, given.stability)
    steps = (low + (high - low) * i / (SLICES - 1) for i in range(SLICES))
    values = [x for x in steps if x > 0 or (x == 0 and other.assume != "positive") or other.assume == "real"]
    search: Branching[Fraction, tuple[Fraction, PassiveValues]] = branch(
        sorted(values, key=lambda x: -gcd(values.index(x), COARSEST)),
        lambda x: (x, _values_of(_with(model, other, x), ports, first, limits, given.digits)),
        lambda _: (),
        keeps=True,
    )
    if search.over and not search.decided:
        raise BudgetError(search.over)
    missing = f"at {len(search.undecided)} of {len(values)} values of '{other.name}': "
    return PassiveChart(
        other,
        tuple(sorted(search.decided, key=lambda pair: pair[0])),
        (missing + search.over.message,) if search.over else (),
    )


def _with(model: Model, parameter: ModelParameter, value: Fraction) -> Model:
    """Return a model with another value of a parameter, in SI units."""
    exact = ExactValue(value)
    return replace(
        model,
        parameters=tuple(
            replace(p, value=exact) if p.name == parameter.name else p for p in model.parameters
        ),
    )


def _values_of(
    model: Model,
    ports: tuple[ContactPort, ...],
    parameter: ModelParameter,
    limits: tuple[Fraction, Fraction],
    digits: int,
) -> PassiveValues:
    """Return for which values of one parameter a machine is passive at a port, or at two together."""
    port = replace(ports[0], name=" and ".join(each.name for each in ports))

    def verdict(value: Fraction) -> bool | None:
        there = _with(model, parameter, value)
        try:
            if model.sampled is not None:
                return find_hybrid(there, port.name).passive
            if len(ports) > 1:
                return find_two_ports(there, [each.name for each in ports], digits).passive
            return find_passivity(there, port, digits, is_explained=False).passive
        except BudgetError:
            raise
        except SymflexError:  # there the equations have no solution
            return None

    asked = PassiveValues(port, parameter, limits, (), digits)
    if len(ports) > 1:
        intervals, is_decided = _tried(verdict, limits)
        doubts = (TRIED_ONLY,) if is_decided else (TRIED_ONLY, NOT_EVERY)
        return replace(asked, intervals=_joined(intervals), reasons=doubts)
    if model.sampled is not None:
        conditions: list[fmpz_mpoly] | None = changes_of(model, port, parameter.name)
    else:
        driven, pair = at_port(model, port)
        (tf,) = derive_all(with_numbers(driven, (parameter.name,), in_kernels=True), [pair])
        conditions = _changes(tf, parameter.name)
    if conditions is not None:
        ends = _roots(conditions, parameter.name, limits, digits)
        places = [ball(limits[0]), *ends, ball(limits[1])]
        found = [PassiveInterval(a, b, verdict(_between(a, b))) for a, b in pairwise(places)]
        return replace(asked, intervals=_joined(found))
    is_straight = _is_straight(tf, parameter.name)
    intervals, is_decided = _tried(verdict, limits)
    reasons = [] if is_straight else [NOT_BETWEEN.format(parameter.name)]
    reasons += [] if is_decided else [NOT_EVERY]
    return replace(asked, intervals=_joined(intervals), reasons=tuple(reasons))


def _joined(intervals: Iterable[PassiveInterval]) -> tuple[PassiveInterval, ...]:
    """Return intervals, neighbours of one kind as one."""
    joined: list[PassiveInterval] = []
    for each in intervals:
        if joined and joined[-1].passive is each.passive:
            joined[-1] = replace(joined[-1], high=each.high)
        else:
            joined.append(each)
    return tuple(joined)


def _between(low: arb, high: arb) -> Fraction:
    """Return a short rational number between two enclosures."""
    a, b = Fraction(float(low.upper())), Fraction(float(high.lower()))
    middle = (a + b) / 2
    for digits in range(1, 30):
        scale = Fraction(10) ** digits
        if a < (short := Fraction(round(middle * scale)) / scale) < b:
            return short
    return middle


def _changes(tf: TransferFunction, name: str) -> list[fmpz_mpoly] | None:
    """Return what vanishes at values at which a verdict may change; None where no polynomials say it."""
    ring = tf.ratio.ring
    used = ring.used_in(f for f, _ in (*tf.ratio.factors, *((h.polynomial, 1) for h in tf.hidden)))
    if tf.kernels or used - {ring.names[0], name}:
        return None
    context = ring.context
    mirrored = [-context.gen(0), *context.gens()[1:]]
    n, d = (part.expand() for part in (tf.num, tf.den))
    n_mirrored, d_mirrored = (f.compose(*mirrored, ctx=context) for f in (n, d))
    even = n * d_mirrored + n_mirrored * d
    polynomials = [d, *(h.polynomial for h in tf.hidden)]
    # A residue on the axis, or what grows as s, changes its sign where a zero meets a pole, or infinity.
    conditions: list[fmpz_mpoly] = _critical(n, context)[1:]
    if degree_in(n, 0) and degree_in(d, 0):
        conditions.append(n.resultant(d, str(context.gen(0))))
    if not even.is_zero():
        sign = context.constant(1)
        for factor, _ in irreducible_factors(even)[1]:
            sign = sign * factor
        conditions += _critical(sign, context)
    for f in polynomials:
        both = (f + f.compose(*mirrored, ctx=context), f - f.compose(*mirrored, ctx=context))
        conditions += _critical(f, context)[1:]
        if degree_in(f, 0) and not any(x.is_zero() for x in both):
            conditions.append(both[0].resultant(both[1], str(context.gen(0))))
    return conditions


def _roots(
    conditions: Iterable[fmpz_mpoly], name: str, limits: tuple[Fraction, Fraction], digits: int
) -> list[arb]:
    """Return the values inside a range at which a condition vanishes, ascending."""
    roots: list[arb] = []
    for condition in conditions:
        at = condition.context().names().index(name)
        if condition.is_zero() or not degree_in(condition, at):
            continue
        for factor, _ in irreducible_factors(condition)[1]:
            if degree_in(factor, at):
                roots += _real_roots(factor, at, digits + SPARE)
    with precision(BITS):
        low, high = map(ball, limits)
        inside = sorted((x for x in roots if x > low and x < high), key=lambda x: float(x.mid()))
        distinct: list[arb] = []
        for x in inside:
            if not (distinct and distinct[-1].overlaps(x)):
                distinct.append(x)
    return distinct


def _critical(f: fmpz_mpoly, context: object) -> list[fmpz_mpoly]:
    """Return what vanishes where a polynomial in s has a double root, a root at infinity or at 0."""
    degree = degree_in(f, 0)
    parts: dict[int, dict[tuple[int, ...], int]] = {}
    for monomial, coefficient in f.terms():
        powers = tuple(int(e) for e in monomial)
        parts.setdefault(powers[0], {})[(0, *powers[1:])] = int(coefficient)
    lead, last = (f.context().from_dict(parts.get(power, {})) for power in (degree, min(parts)))
    name = str(f.context().gen(0))
    double = f.discriminant(name) if degree > 1 else f.context().constant(1)
    return [double, lead, last]


def _real_roots(factor: fmpz_mpoly, at: int, digits: int) -> list[arb]:
    coefficients = [0] * (degree_in(factor, at) + 1)
    for monomial, coefficient in factor.terms():
        coefficients[int(monomial[at])] += int(coefficient)
    problem = RootProblem(((PolynomialInS.from_integers(coefficients), 1),))
    return [root.re for root in find_polynomial_roots(problem, digits) if root.is_real]


def _is_straight(tf: TransferFunction, name: str) -> bool:
    """Tell whether Y or 1/Y is a straight line in a parameter, which is in no wavenumber or delay."""
    ring = tf.ratio.ring
    if any(value.depends_on(name) for value in tf.kernels.values):
        return False
    above, below = (
        sum(degree_in(f, ring.index[name]) * abs(e) for f, e in tf.ratio.factors if (e > 0) is is_above)
        for is_above in (True, False)
    )
    return sorted((above, below)) in ([0, 0], [0, 1])


def _tried(
    verdict: Callable[[Fraction], bool | None], limits: tuple[Fraction, Fraction]
) -> tuple[list[PassiveInterval], bool]:
    """Return intervals between values that were tried, and whether all were decided, some of them passive."""
    low, high = limits
    narrow = (high - low) * SHARE
    # Off round numbers, at which bounds lie that people write: there no search decides.
    shares = (Fraction(i, TRIED - 1) + ASIDE * (0 < i < TRIED - 1) for i in range(TRIED))
    known = {x: verdict(x) for x in (low + narrow + (high - low - 2 * narrow) * share for share in shares)}
    for a, b in pairwise(sorted(known)):
        while known[a] is not known[b] and b - a > narrow:
            middle = (a + b) / 2
            known[middle] = verdict(middle)
            a, b = (middle, b) if known[middle] is known[a] else (a, middle)  # noqa: PLW2901
    values = sorted(known)
    intervals: list[PassiveInterval] = []
    start = ball(low)
    for a, b in pairwise(values):
        if known[a] is not known[b]:
            with precision(BITS):
                end = ball(a).union(ball(b))
            intervals.append(PassiveInterval(start, end, known[a]))
            start = end
    intervals.append(PassiveInterval(start, ball(high), known[values[-1]]))
    return intervals, None not in known.values() and True in known.values()
