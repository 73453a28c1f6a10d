"""What can be computed at the points of a sweep: poles, zeros, responses, margins.

Roots are certified and rounded to doubles. A ball that is small enough lies between two neighbouring
midpoints of doubles: then the double nearest to the true value is known, whatever the ball's own centre is,
and two computations of one root agree to the last bit. A worker runs :func:`solve_chunk` on one chunk of
points.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from fractions import Fraction
from functools import lru_cache
from hashlib import sha256
from math import hypot, inf, nan, nextafter, pi, ulp

import numpy as np
from flint import arb, fmpq, fmpq_poly, fmpz_mpoly, fmpz_poly

from symflex.algebra import LAPLACE, Ring, terms_of
from symflex.balls import precision
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, SymflexError
from symflex.loops import StabilityMap, characteristic_loop, find_stable_gains, pick_gain
from symflex.model import ExactValue
from symflex.roots import (
    Everything,
    Modes,
    PoleZeroMap,
    PolynomialInS,
    Region,
    Root,
    RootProblem,
    find_pole_zero_map,
)
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import NOT_EXAMINED, StabilityVerdict
from symflex.roots.root import degrees, hertz
from symflex.sweep.continuation import Continuation, RootKind
from symflex.sweep.design import Point, Range, Rows, Solver, Task, between, codes_of, derived
from symflex.sweep.similarity import Similarities, Similarity
from symflex.transfer import AnyBoundFunction, AnyTransferFunction, bind_any

LARGEST = 1023  # exponent of two from which a number may not fit a double


@dataclass(frozen=True, slots=True)
class Doubles:
    """A complex number in double precision."""

    # re and im: Centre.
    re: float
    im: float
    radius: float  # the true value lies no further from the centre
    is_nearest: bool  # both parts are the doubles nearest to the true ones


def doubles(re: arb, im: arb) -> Doubles:
    """Round an enclosure.

    >>> from flint import arb
    >>> from symflex.balls import precision
    >>> with precision(128):
    ...     third = doubles(arb(0), arb(1) / 3)
    >>> third.im == 1 / 3, third.radius == 2**-55, third.is_nearest
    (True, True, True)
    """
    x, dx, is_nearest_re = rounded(re)
    y, dy, is_nearest_im = rounded(im)
    radius = max(dx, dy) if not dx or not dy else nextafter(nextafter(hypot(dx, dy), inf), inf)
    return Doubles(x, y, radius, is_nearest_re and is_nearest_im)


def rounded(ball: arb) -> tuple[float, float, bool]:
    """Return the centre, a bound on its distance from the true value, and whether it is the nearest double.

    A value beyond the doubles is NaN with an infinite radius.
    """
    if ball == 0:
        return 0.0, 0.0, True
    if not ball.is_finite():
        return float("nan"), inf, False
    mantissa, exponent = (int(x) for x in ball.mid().man_exp())
    spread, finer = (int(x) for x in ball.rad().man_exp())
    if max(mantissa.bit_length() + exponent, spread.bit_length() + finer) >= LARGEST:
        return float("nan"), inf, False
    least = min(exponent, finer)
    size, around = mantissa << (exponent - least), spread << (finer - least)
    first, last = (_nearest(end, least) for end in (size - around, size + around))
    if first == last and first:
        # Within one rounding interval of the double, which is half a unit in the last place wide at most.
        return first, ulp(first) / 2 or ulp(first), True
    centre = _nearest(size, least)
    unit = Fraction(2) ** least
    ends = ((size - around) * unit, (size + around) * unit)
    farthest = max(abs(Fraction(centre) - end) for end in ends)
    radius = float(farthest)
    return centre, nextafter(radius, inf) if Fraction(radius) < farthest else radius, False


def _nearest(mantissa: int, exponent: int) -> float:
    """Return the double nearest to ``mantissa * 2^exponent``: quotients of integers are rounded correctly."""
    return mantissa / (1 << -exponent) if exponent < 0 else float(mantissa << exponent)


LADDER = (20, 40, 80)  # digits, until the nearest doubles are known
SIMILAR_DIGITS = 40
SCALE_BITS = 192
CHANCES = 3  # times that roots of a chunk may fail to be carried at all before all points are searched
REMEMBERED = 256  # points that stand for all similar ones, of which so many are kept
FAMILY_BYTES = 7


VERDICTS = ("unknown", "unstable", "marginal", "stable")  # words of StabilityVerdict, by number
UNKNOWN, STABLE = 0, 3


class RootStatus(IntEnum):
    """What is proved of one root."""

    ABSENT = 0
    CERTIFIED = 1
    TOGETHER = 2


class PointStatus(IntEnum):
    """What is proved of all roots at one point."""

    CERTIFIED = 0
    EXCEPT_ACCUMULATION = 1
    NOT_CERTIFIED = 2
    FAILED = 3


@dataclass(frozen=True, slots=True)
class FoundRoot:
    """One root in the closed upper half-plane, other than 0."""

    place: Doubles  # centre and radius [rad/s]
    multiplicity: int  # exact where certified; else how many roots the disc contains
    status: RootStatus  # certified, or several that could not be separated


@dataclass(frozen=True, slots=True)
class PointRoots:
    """The roots at one point."""

    roots: tuple[FoundRoot, ...]  # by natural frequency
    at_zero: int  # multiplicity of the root at s = 0
    status: PointStatus  # whether none is missing
    verdict: StabilityVerdict = NOT_EXAMINED
    code: str = ""  # of the error, where the point failed
    # Equal for functions that are similar, whose roots then stand in the same order; 0 where not known.
    family: int = 0


@dataclass(frozen=True, slots=True)
class _Known:
    """A point that stands for all similar ones; ``model`` is ``None`` where it does not serve."""

    similarity: Similarity
    model: PointRoots | None
    roots: tuple[Root, ...]


Prepared = tuple[tuple[fmpq, tuple[tuple[str, int], ...]], ...]  # terms: a number times powers of parameters


@dataclass(frozen=True, slots=True)
class PolynomialQuotient:
    """A transfer function of lumped parts, its polynomials in s prepared for values of some parameters.

    Each is a tuple of coefficients, in ascending powers of s, with its exponent. What was derived, and
    compared with the equations, for any values need not be for each; where values make factors of numerator
    and denominator equal, or a parameter zero, the function is another one, and is bound anew.
    """

    name: str
    sides: tuple[tuple[tuple[tuple[Prepared, ...], int], ...], ...]  # denominator, numerator, what cancelled
    signed: frozenset[str]  # parameters that may be negative

    @classmethod
    def of(
        cls, tf: AnyTransferFunction, names: Sequence[str], fixed: Mapping[str, ExactValue]
    ) -> PolynomialQuotient | None:
        """Return the function with ``fixed`` values; None if it has kernels, roots or irrational numbers."""
        if not tf.is_reduced or tf.is_large or not tf.is_rational or tf.is_zero or tf.with_waves is not None:
            return None
        if tf.model.root is not None or tf.model.imaginary:
            return None
        factors = tf.ratio.factors
        sides = (
            [(f, -e) for f, e in factors if e < 0],
            [(f, e) for f, e in factors if e > 0],
            [(h.polynomial, h.multiplicity) for h in tf.hidden],
        )
        used = tf.ring.used_in([f for side in sides for f, _ in side]) - {LAPLACE, *names}
        numbers = {name: fixed[name] for name in used if name in fixed}
        if len(numbers) < len(used) or any(not x.rational or x.pi_power for x in numbers.values()):
            return None
        exact = {name: fmpq(x.rational.numerator, x.rational.denominator) for name, x in numbers.items()}
        prepared = tuple(tuple((_prepared(tf.ring, f, exact), e) for f, e in side) for side in sides)
        signed = frozenset(p.name for p in tf.model.parameters if p.assume == "real")
        return cls(tf.name, prepared, signed)

    def at(self, values: Mapping[str, ExactValue]) -> QuotientAtPoint | None:
        """Return the function with numbers; None where these make another function of it."""
        numbers = {}
        for name, x in values.items():
            if not x.rational or x.pi_power or (x.rational < 0 and name not in self.signed):
                return None
            numbers[name] = fmpq(x.rational.numerator, x.rational.denominator)
        den, num, hidden = (
            [(_polynomial_at(coefficients, numbers), e) for coefficients, e in side] for side in self.sides
        )
        is_another = any(f.is_zero() for side in (den, num, hidden) for f, _ in side)
        if is_another or any(f.gcd(g).degree() > 0 for f, _ in den for g, _ in num):
            return None
        return QuotientAtPoint(self.name, _problem(den), _problem(num), tuple(_problem([h]) for h in hidden))


@dataclass(frozen=True, slots=True)
class QuotientAtPoint:
    """A quotient of polynomials without common factors, and what cancelled."""

    name: str
    den: RootProblem
    num: RootProblem
    hidden: tuple[RootProblem, ...]

    def located(self, region: Region | None, digits: int, kind: RootKind) -> PoleZeroMap:
        """Return poles and hidden modes, and zeros if these are asked for."""
        zeros = self.num if kind == "zeros" else RootProblem(())
        hidden = [(problem, "cancelled") for problem in self.hidden]
        return find_pole_zero_map(self.name, self.den, zeros, region, digits, hidden)


def _prepared(ring: Ring, factor: fmpz_mpoly, numbers: Mapping[str, fmpq]) -> tuple[Prepared, ...]:
    """Return the coefficients of s of a polynomial with numbers for some generators."""
    powers: dict[int, dict[tuple[tuple[str, int], ...], fmpq]] = {}
    for monomial, coefficient in terms_of(factor):
        named = [(ring.names[i], e) for i, e in monomial]
        number = fmpq(int(coefficient))
        for name, e in named:
            number *= numbers[name] ** e if name in numbers else 1
        key = tuple((name, e) for name, e in named if name != LAPLACE and name not in numbers)
        own = powers.setdefault(dict(named).get(LAPLACE, 0), {})
        own[key] = own.get(key, fmpq(0)) + number
    return tuple(tuple((c, key) for key, c in powers.get(i, {}).items()) for i in range(max(powers) + 1))


def _polynomial_at(coefficients: Sequence[Prepared], numbers: Mapping[str, fmpq]) -> fmpz_poly:
    """Return a polynomial, up to a factor, at values of its parameters."""
    values = []
    for terms in coefficients:
        total = fmpq(0)
        for number, powers in terms:
            for name, e in powers:
                number = number * numbers[name] ** e  # noqa: PLW2901
            total += number
        values.append(total)
    return fmpq_poly(values).numer()


def _problem(factors: Sequence[tuple[fmpz_poly, int]]) -> RootProblem:
    own = (([int(c) for c in f.coeffs()], e) for f, e in factors if f.degree() > 0)
    return RootProblem(tuple((PolynomialInS.from_integers(integers), e) for integers, e in own))


class RootSolver:
    """Finds the roots of one transfer function, ``poles`` or ``zeros``, at many points.

    Where a point's function is similar to one that was solved, its roots are those times one factor; else the
    search with proof is made. Both give the doubles nearest to the true roots, so the way does not show.
    ``tf`` has the swept parameters as symbols, ``names`` say what the values of a point belong to.
    """

    def __init__(
        self, tf: AnyTransferFunction, names: Sequence[str], kind: RootKind, region: Region | None
    ) -> None:
        self._tf, self._names, self._kind, self._region = tf, tuple(names), kind, region
        # A band or a rectangle does not scale with the roots.
        scalable = region is None or isinstance(region, Modes | Everything)
        self._similarities = Similarities(tf) if scalable and tf.is_reduced else None
        hidden = tf.hidden_parameters if tf.is_reduced else ()
        used = {p.name: p.value for p in (*tf.parameters, *hidden)}
        self._declared = {name: value for name, value in used.items() if value is not None}
        if any(value is None and name not in self._names for name, value in used.items()):
            self._similarities = None
        self._models: dict[object, _Known | None] = {}
        self._quotient = PolynomialQuotient.of(tf, names, self._declared)
        self._continuation = Continuation.of(tf, names, kind, region)

    def __call__(self, point: Point) -> PointRoots:
        """Return the roots at a point; what fails there is said, not raised."""
        try:
            return self._solve(self._values(point))
        except SymflexError as error:
            spend()  # that the time is over says nothing of a point
            return PointRoots((), 0, PointStatus.FAILED, code=error.diagnostics[0].code)

    def each(self, points: Sequence[Point]) -> list[PointRoots]:
        """Return the roots at points in a row, carried from one to the next where that is proved."""
        found: list[PointRoots] = []
        chances = 0 if self._continuation is None else CHANCES
        while len(found) < len(points):
            i = len(found)
            found.append(self(points[i]))
            if chances:
                carried = self._carried(points[i], found[i], points[i + 1 :])
                chances -= not carried
                found += carried
        return found

    def _values(self, point: Point) -> dict[str, ExactValue]:
        return dict(zip(self._names, point, strict=True))

    def _carried(self, point: Point, known: PointRoots, points: Sequence[Point]) -> list[PointRoots]:
        """Return the roots at points after one whose roots are known, as far as they can be carried."""
        continuation = self._continuation
        if continuation is None or known.status is not PointStatus.CERTIFIED:
            return []
        if not continuation.serves(known.verdict):
            return []
        families: list[int] = []
        for each in points:
            similarity, family = self._similarity(self._values(each))
            if similarity is not None and similarity.key in self._models:
                break  # one factor more is quicker
            families.append(family)
        is_simple = all(r.multiplicity == 1 and r.status is RootStatus.CERTIFIED for r in known.roots)
        if not families or not is_simple:
            return []
        guesses = [complex(root.place.re, root.place.im) for root in known.roots]
        try:
            start = continuation.begin(point, guesses, known.at_zero)
            way = continuation.carry(start, points[: len(families)], known.verdict) if start else []
        except SymflexError:
            spend()
            return []
        found = []
        for roots, family in zip(map(continuation.chosen, way), families, strict=False):
            rows = tuple(FoundRoot(doubles(r.re, r.im), 1, RootStatus.CERTIFIED) for r in _upper(roots))
            if not all(row.place.is_nearest for row in rows):
                break
            found.append(replace(known, roots=rows, family=family))
        return found

    def _bound(self, values: dict[str, ExactValue]) -> AnyBoundFunction:
        bound = bind_any(self._tf, values)
        return without_lengths_of_zero(bound) if bound.is_reduced else bound

    def _similarity(self, values: dict[str, ExactValue]) -> tuple[Similarity | None, int]:
        """Return to which functions the one of some values is similar, and a number for all of these."""
        similarity = self._similarities.at({**self._declared, **values}) if self._similarities else None
        if similarity is None:
            return None, 0
        text = repr((similarity.degree, similarity.key)).encode()
        return similarity, int.from_bytes(sha256(text).digest()[:FAMILY_BYTES], "big") + 1

    def _solve(self, values: dict[str, ExactValue]) -> PointRoots:
        similarity, family = self._similarity(values)
        if similarity is None:
            quotient = None if self._quotient is None else self._quotient.at(values)
            if quotient is None:
                return self._searched(self._bound(values), 0)
            return self._rounded(lambda digits: quotient.located(self._region, digits, self._kind), 0)
        if similarity.key not in self._models:
            if len(self._models) >= REMEMBERED:
                self._models.clear()
            self._models[similarity.key] = None
            result = self._searched(self._bound(values), family)
            if result.status is PointStatus.CERTIFIED:
                return result
        # Asked for a second time: worth many digits.
        similar = self._models[similarity.key] or self._known(values, similarity, family)
        self._models[similarity.key] = similar
        scaled = _scaled(similar.roots, similar.similarity, similarity)
        if similar.model is None or not all(root.place.is_nearest for root in scaled):
            return self._searched(self._bound(values), family)
        # A positive scale moves no pole over the axis.
        return replace(similar.model, roots=scaled, family=family)

    def _known(self, values: dict[str, ExactValue], similarity: Similarity, family: int) -> _Known:
        """Return the roots at a point to many digits, none where not all is proved."""
        located = locate(self._bound(values), self._region, SIMILAR_DIGITS)
        model, roots = self._chosen(located, family), _upper(self._all(located))
        is_proved = model.status is PointStatus.CERTIFIED and all(root.certified for root in roots)
        return _Known(similarity, model, roots) if is_proved else _Known(similarity, None, ())

    def _searched(self, bound: AnyBoundFunction, family: int) -> PointRoots:
        return self._rounded(lambda digits: locate(bound, self._region, digits), family)

    def _rounded(self, located: Callable[[int], PoleZeroMap], family: int) -> PointRoots:
        """Return the roots to as many digits as their nearest doubles take."""
        for digits in LADDER:
            result = self._chosen(located(digits), family)
            if all(r.place.is_nearest or r.status is RootStatus.TOGETHER for r in result.roots):
                break
        return result

    def _all(self, located: PoleZeroMap) -> tuple[Root, ...]:
        return located.all_poles if self._kind == "poles" else located.zeros

    def _chosen(self, located: PoleZeroMap, family: int) -> PointRoots:
        certificate = located.certificate
        status = PointStatus.EXCEPT_ACCUMULATION if located.excluded else PointStatus.CERTIFIED
        if not certificate.certified:
            status = PointStatus.NOT_CERTIFIED
        every = self._all(located)
        kinds = {True: RootStatus.CERTIFIED, False: RootStatus.TOGETHER}
        rows = tuple(
            FoundRoot(doubles(root.re, root.im), root.multiplicity, kinds[root.certified])
            for root in _upper(every)
        )
        at_zero = sum(root.multiplicity for root in every if root.is_zero)
        return PointRoots(rows, at_zero, status, located.verdict, certificate.code or "", family)


def _upper(roots: Sequence[Root]) -> tuple[Root, ...]:
    """Return one root of each conjugate pair, and real ones; none that is 0."""
    return tuple(root for root in roots if not root.is_zero and not root.im < 0)


def _scaled(roots: Sequence[Root], known: Similarity, wanted: Similarity) -> tuple[FoundRoot, ...]:
    with precision(SCALE_BITS):
        factor = arb(wanted.scale / known.scale).root(wanted.degree)
        places = [doubles(root.re * factor, root.im * factor) for root in roots]
    pairs = zip(places, roots, strict=True)
    return tuple(FoundRoot(place, root.multiplicity, RootStatus.CERTIFIED) for place, root in pairs)


def solve_roots(task: Task) -> Solver:
    """Return what finds the poles, or the zeros, of the task's transfer function."""
    solver = RootSolver(derived(task), task.names, "poles" if task.of == "poles" else "zeros", task.region)
    return lambda points: _rows(solver.each(points))


def _rows(points: Sequence[PointRoots]) -> Rows:
    shape = len(points), max((len(point.roots) for point in points), default=0)
    re, im, radius = (np.full(shape, np.nan) for _ in range(3))
    status, multiplicity = np.zeros(shape, np.int8), np.zeros(shape, np.int32)
    for i, point in enumerate(points):
        for j, root in enumerate(point.roots):
            re[i, j], im[i, j], radius[i, j] = root.place.re, root.place.im, root.place.radius
            status[i, j], multiplicity[i, j] = root.status, root.multiplicity
    return {
        "re": re,
        "im": im,
        "radius": radius,
        "status": status,
        "multiplicity": multiplicity,
        "at_zero": np.array([point.at_zero for point in points], np.int32),
        **_said([point.verdict for point in points]),
        "point_status": np.array([point.status for point in points], np.int8),
        "family": np.array([point.family for point in points], np.int64),
        "code": codes_of([point.code for point in points]),
    }


def _said(verdicts: Sequence[StabilityVerdict]) -> Rows:
    """Return what is said of stability at points, and whether hidden motion that stays is."""
    return {
        "verdict": np.array([VERDICTS.index(each.word) for each in verdicts], np.int8),
        "hidden_motion": np.array([bool(each.hidden) for each in verdicts], np.int8),
    }


def _each(points: Sequence[Point], solve: Callable[[int, Point], PointStatus]) -> Rows:
    """Solve points by number; return their status, and the codes of those that fail."""
    status, codes = np.zeros(len(points), np.int8), [""] * len(points)
    for i, point in enumerate(points):
        spend()
        try:
            status[i] = solve(i, point)
        except SymflexError as error:
            spend()  # that the time is over says nothing of a point
            status[i], codes[i] = PointStatus.FAILED, error.diagnostics[0].code
    return {"point_status": status, "code": codes_of(codes)}


def solve_response(task: Task) -> Solver:
    """Return what evaluates the task's transfer function to double precision; ``inf + nan*1j`` at a pole."""
    tf = derived(task)
    omega = [2 * pi * frequency for frequency in task.frequencies]

    def solve(points: Sequence[Point]) -> Rows:
        values = np.full((len(points), len(omega)), complex(nan, nan))

        def one(i: int, point: Point) -> PointStatus:
            bound = bind_any(tf, dict(zip(task.names, point, strict=True)))
            values[i] = [bound(complex(0, w)) for w in omega]
            return PointStatus.CERTIFIED

        outcome = _each(points, one)
        return {"re": values.real.copy(), "im": values.imag.copy(), **outcome}

    return solve


MARGINS = ("gain_margin_up", "gain_margin_down", "phase_margin", "crossover")
Pair = tuple[float, float]  # centre and radius


def solve_margins(task: Task) -> Solver:
    """Return what finds gain and phase margins of the loop closed with the task's gain."""
    parameter = pick_gain(task.model.parameters, task.gain)
    tf = derived(task, task.gain)
    if not tf.is_reduced:
        message = "margins need the closed form, which is too large here"
        raise BudgetError(Diagnostic("SF502", message, None, "split the model, or sweep its poles"))

    def solve(points: Sequence[Point]) -> Rows:
        every = (*MARGINS, *(f"{name}_radius" for name in MARGINS))
        values = {name: np.full(len(points), np.nan) for name in every}
        verdicts = [NOT_EXAMINED] * len(points)

        def one(i: int, point: Point) -> PointStatus:
            loop = characteristic_loop(tf, parameter, dict(zip(task.names, point, strict=True)))
            stability = find_stable_gains(loop)
            verdicts[i] = stability.verdict
            for name, (centre, radius) in _margins_of(stability).items():
                values[name][i], values[f"{name}_radius"][i] = centre, radius
            return PointStatus.CERTIFIED if stability.certified else PointStatus.NOT_CERTIFIED

        outcome = _each(points, one)
        said = _said(verdicts)
        word = said["verdict"]
        stable = np.where(word == STABLE, 1, np.where(word == UNKNOWN, -1, 0)).astype(np.int8)
        return {**values, "stable": stable, **said, **outcome}

    return solve


def _margins_of(stability: StabilityMap) -> dict[str, Pair]:
    """Return the margins of a stable loop; an infinite gain margin is inf, or 0 downwards."""
    interval = stability.nominal_interval
    if interval is None or not interval.poles.is_stable:
        return {}
    result: dict[str, Pair] = {"gain_margin_up": (inf, 0.0), "gain_margin_down": (0.0, 0.0)}
    for margin in stability.gain_margins:
        name = "gain_margin_up" if margin.factor > 1 else "gain_margin_down"
        result[name] = rounded(margin.factor)[:2]
    worst = stability.phase_margin
    if worst is not None:
        result["phase_margin"] = rounded(degrees(worst.angle))[:2]
        result["crossover"] = rounded(hertz(worst.frequency))[:2]
    return result


def logarithmic(low: Fraction, high: Fraction, count: int) -> list[float]:
    """Return frequencies between two, equally spaced in their logarithm, the same on every computer.

    >>> from fractions import Fraction
    >>> logarithmic(Fraction(1), Fraction(100), 3)
    [1.0, 10.0, 100.0]
    """
    limits = Range("frequency", ExactValue(low), ExactValue(high), "log")
    return [float(value.rational) for value in between(limits, count)]


QUANTITIES: dict[str, Callable[[Task], Solver]] = {
    "poles": solve_roots,
    "zeros": solve_roots,
    "response": solve_response,
    "margins": solve_margins,
}


def solve_chunk(pickled: bytes, points: Sequence[Point]) -> Rows:
    """Return the results at some points; the pickled task's model is derived once in each process."""
    return _solver(pickled)(points)


@lru_cache(maxsize=4)
def _solver(pickled: bytes) -> Solver:
    task: Task = pickle.loads(pickled)
    return QUANTITIES[task.of](task)
