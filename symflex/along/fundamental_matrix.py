"""Minors of fundamental matrices of equations whose coefficients vary along x, in balls.

Input: ``dz/dx = A(x, u) z`` with ``A = sum_q u^q A_q(x)``, as a :class:`VaryingSystem`.
Output: a :class:`PowerExpansion`: minors of Z(end), where Z(start) is the unit matrix, as polynomials in u
with bounds on what they leave out. Once one is made, a value at another u costs that of a polynomial.

    y'' = u (1 + x) y, z = (y, y')      A_0 = ((0, 1), (0, 0)), A_1 = ((0, 0), (1 + x, 0))
    order 0 in u: ((1, x), (0, 1))      order 1: A_1 times that, integrated: y' first, y after it
    y(1) = 1 + 2/3 u + ..., where y(0) = 1 and y'(0) = 0

On a step every order in u is a power series in x, one quadrature after the other. As Z is analytic in x and u
together, Cauchy's estimate bounds what these leave out: a coefficient of ``x^k u^m`` is at most
``exp(rho K)/(rho^k R^m)``, if the norm of A is at most K for abs(x) <= rho and abs(u) <= R. States are scaled
so that this norm is about a wavenumber.

Minors of p rows solve equations of their own, whose coefficients are entries of A (Schwarz 1970). They are
taken from step to step as such: as differences of products of entries they would lose the digits by which the
products are larger.

Where A has a pole at the start, the first step is that of a :class:`SingularBeginning`, whose finite
solutions are power series: ``h v' = B v`` makes ``(k - B_0) v_k = B_1 v_(k-1) + ... + B_k v_0``. The same
with sizes in place of numbers bounds as many terms as one likes. If B is at most M on abs(h) <= rho and
``k (k - B_0)^-1`` at most c, then all terms with k > c M fall at least as those of ``1/(1 - 2 h/rho)`` do.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil, comb, floor, inf, log2
from typing import TypeVar

from flint import acb, arb, arb_poly

from symflex.along.growth import (
    Growth,
    Leg,
    bits_of,
    growth_begun,
    growth_of,
    growth_on,
    least_growth,
    legs_along,
)
from symflex.along.system import (
    Coefficients,
    Lines,
    MinorsAlong,
    Number,
    Polynomial,
    RationalPart,
    SingularBeginning,
    VaryingSystem,
    polynomial_of,
    sequence_of,
)
from symflex.balls import current_bits, precision
from symflex.budget import GB, spend
from symflex.errors import BudgetError, Diagnostic

Derived = TypeVar("Derived", arb_poly, Polynomial)
Matrix = list[list[Polynomial]]  # entries as polynomials in u
GUARD = 32  # bits beyond those asked for: products of a few dozen steps round a few hundred times
BEYOND = 32  # polynomials in u are bounded on a disc so many times larger than what they are used on
FEWEST_BITS = 30  # precision of orders in u that hardly matter
ASIDE = 1 / 16  # share of abs(u) by which a polynomial's error is bounded beyond it, for derivatives
CUTS = 4  # parts of an octave: a quarter more in abs(u) costs two bits, far fewer than there are to spare
HIGHEST_CUT = 1000  # power of two of abs(u) beyond which bounds come near the end of doubles
WIDE = 2.0**-30  # relative radius of balls about whose middle a polynomial is expanded
TINY = 2.0**-200  # share of the largest abs(u) below which sizes are not distinguished
MOST_MEMORY = 4e9  # bytes of all steps: a library that asks for more than there is ends the process
SMALL = 2.0**-10  # share of what a value moves by on a ball, that may be left out of its series


@dataclass(frozen=True, eq=False)
class PowerExpansion:
    """Minors of a fundamental matrix as polynomials in u, each made when it is first asked for."""

    system: VaryingSystem
    legs: Sequence[Leg]
    discs: Sequence[Sequence[Growth]]  # how solutions grow about each leg's start, up to sizes of abs(u)
    largest: arb  # values are for abs(u) up to this, or not much more
    bits: int  # to which they are exact, relative to minors that grow
    orders: int  # in u that are kept; 0 where they follow from the bits
    _growths: dict[int, Growth] = field(default_factory=dict, repr=False)  # by minors' rows
    _made: dict[tuple[Lines, Lines], Polynomial] = field(default_factory=dict, repr=False)
    _cuts: dict[tuple[Lines, Lines, int, int], DiscPolynomial] = field(default_factory=dict, repr=False)
    # Logarithms of bounds on minors, and of the sizes of their coefficients.
    _wholes: dict[tuple[Lines, Lines], float] = field(default_factory=dict, repr=False)
    _logarithms: dict[tuple[Lines, Lines], list[float]] = field(default_factory=dict, repr=False)

    def series(self, rows: Lines, columns: Lines, u: acb, terms: int = 1) -> list[acb]:
        """Return Taylor coefficients about ``u`` of a minor; of an entry, where there is one row."""
        coefficients, size = [], abs(u).upper()
        # Most values are asked for with far fewer bits than the polynomials have.
        with precision(self.precision - max(0, self.bits - current_bits())):
            cut = self._cut(rows, columns, size)
            # On the real axis arithmetic is a third of the work.
            at: Number = u.real if u.imag == 0 else u
            for k, value in enumerate(cut.series(at, terms)):
                rest = self._rest(rows, columns, size, k)
                if cut.left > 0:
                    rest = (rest + cut.left / (size * ASIDE) ** k).abs_upper()
                coefficients.append(acb(value) + acb(arb(0, rest), arb(0, rest)))
        return [+x for x in coefficients]

    def _cut(self, rows: Lines, columns: Lines, size: arb) -> DiscPolynomial:
        """Return what matters of a polynomial for abs(u) up to a size at the current precision."""
        way = float(size)
        if not 0 < way < 2.0**HIGHEST_CUT:
            return DiscPolynomial(self._polynomial(rows, columns), arb(0))
        # Sizes up to the same part of an octave are cut alike, once. A millionth more makes up for rounding.
        part = floor(CUTS * log2(way) + 1e-6) + 1
        key = rows, columns, part, current_bits()
        if key not in self._cuts:
            self._cuts[key] = self._cut_for(rows, columns, 2.0 ** (part / CUTS) * (1 + ASIDE))
        return self._cuts[key]

    def _cut_for(self, rows: Lines, columns: Lines, way: float) -> DiscPolynomial:
        polynomial, upto = self._polynomial(rows, columns), arb(way)
        if (rows, columns) not in self._logarithms:
            with precision(FEWEST_BITS):
                sizes = [abs(c).upper() for c in polynomial.coeffs()]
                self._logarithms[rows, columns] = [bits_of(x) if x > 0 else -inf for x in sizes]
        terms = [x + m * log2(way) for m, x in enumerate(self._logarithms[rows, columns])]
        least = max(terms, default=0.0) - current_bits() - GUARD
        count = next((m + 1 for m in reversed(range(len(terms))) if terms[m] > least), 0)
        with precision(FEWEST_BITS):
            left = _sizes_of(polynomial.right_shift(count))(upto) * upto**count
        return DiscPolynomial(polynomial.truncate(count), left.abs_upper())

    def _rest(self, rows: Lines, columns: Lines, size: arb, k: int) -> arb:
        """Return a bound on what a polynomial leaves out of the k-th Taylor coefficient, by Cauchy."""
        if size == 0 and k < self.terms:
            return arb(0)
        if (rows, columns) not in self._wholes:
            growth, lines = self._growth(len(rows)), MinorsAlong(self.system, len(rows)).lines
            starts, ends = growth.weights
            whole = growth.size * ends[lines.index(rows)] / starts[lines.index(columns)]
            self._wholes[rows, columns] = bits_of(whole)
        exponent, largest, reach = inf, float(self.largest), float(self.reach)
        way = max(float(size), largest * TINY)
        # Of circles about a point a small one is better for the first derivatives.
        for share in (ASIDE, 1) if k else (0,):
            apart = max(way, largest) * share
            room = (way + apart) / reach
            if room < 1:
                left = self.terms * log2(room) - log2(1 - room) - (k * log2(apart) if k else 0)
                exponent = min(exponent, self._wholes[rows, columns] + left)
        # One bit more makes up for rounding.
        return arb(2) ** ceil(exponent + 1) if exponent < inf else arb("inf")

    def _polynomial(self, rows: Lines, columns: Lines) -> Polynomial:
        if (rows, columns) not in self._made:
            lines = MinorsAlong(self.system, len(rows)).lines
            polynomials: dict[Lines, Polynomial] = {line: arb_poly([int(line == columns)]) for line in lines}
            with precision(self.precision):
                for step in self._steps:
                    spend()
                    polynomials = {line: _combined(step, line, polynomials, self.terms) for line in lines}
            self._made.update(((line, columns), x) for line, x in polynomials.items())
        return self._made[rows, columns]

    def _growth(self, order: int) -> Growth:
        if order not in self._growths:
            with precision(self.bits):
                self._growths[order] = growth_of(MinorsAlong(self.system, order), self.legs, self.reach)
        return self._growths[order]

    @cached_property
    def _near(self) -> Growth:
        """How minors of half of the rows grow, which grow most, where they are used."""
        with precision(self.bits):
            return growth_of(MinorsAlong(self.system, self._half), self.legs, self.largest)

    @property
    def _half(self) -> int:
        return max(1, self.system.size // 2)

    @cached_property
    def precision(self) -> int:
        """The bits of polynomials: where they are used, minors are smaller than their terms."""
        with precision(self.bits):
            lost = bits_of(self._near.size) - least_growth(self.system, self._half, self.largest)
        return self.bits + GUARD + ceil(max(0.0, lost))

    @cached_property
    def terms(self) -> int:
        """The number of terms of all polynomials, those of the steps too."""
        if self.orders:
            return self.orders
        beyond = self._growth(self._half).bits_over(self._near)
        return max(2, ceil((self.precision + beyond) / log2(BEYOND / (1 + ASIDE))))

    @cached_property
    def _steps(self) -> Sequence[dict[tuple[Lines, Lines], Polynomial]]:
        """The fundamental matrix of every step, by rows and columns."""
        steps: list[dict[tuple[Lines, Lines], Polynomial]] = []
        last = len(self.legs) - 1
        taken = len(self.legs) * self.system.size**2 * self.terms * self.precision / 8
        if taken > MOST_MEMORY:
            message = f"solutions along a member that varies take about {taken / GB:.0f} GB"
            hint = "ask for lower frequencies, and check units and powers of s"
            raise BudgetError(Diagnostic("SF504", message, None, hint))
        with precision(self.precision):
            start, end = self.system.ends()
            for k, (leg, discs) in enumerate(zip(self.legs, self.discs, strict=True)):
                spend()
                exact = replace(leg, start=start if k == 0 else leg.start, end=end if k == last else leg.end)
                if leg.is_first and self.system.beginning is not None:
                    made = _begun(self.system.beginning, exact, self.reach, self.terms)
                else:
                    made = _stepped(self.system, exact, discs, self.terms)
                rows = enumerate(made)
                steps.append({((i,), (j,)): x for i, row in rows for j, x in enumerate(row)})
        return steps

    @property
    def reach(self) -> arb:
        """The size of u up to which solutions are bounded."""
        return (self.largest * BEYOND).abs_upper()


@dataclass(frozen=True, slots=True)
class DiscPolynomial:
    """What matters of a polynomial on a disc, with what its Taylor polynomials are made of."""

    polynomial: Polynomial
    left: arb  # bounds the rest on the disc, and a little beyond it
    _derived: list[Polynomial] = field(default_factory=list, repr=False)  # over factorials
    _sized: list[arb_poly] = field(default_factory=list, repr=False)

    def series(self, u: Number, terms: int) -> list[Number]:
        """Return Taylor coefficients about a ball."""
        middle = u.mid()
        radius = abs(u - middle).abs_upper()
        if not radius > abs(middle) * WIDE:
            off = u - middle
            slopes: list[Number] = [self._derivative(k + 1)(u) * (k + 1) for k in range(terms)]
            return [self._derivative(k)(middle) + slope * off for k, slope in enumerate(slopes)]
        # Terms of an alternating series are larger than their sum: a ball is judged by its middle.
        far, count, known, moved = (abs(middle) + radius).abs_upper(), 0, list[Number](), arb(0)
        while True:
            known.append(self._derivative(count)(middle))
            moved = max(moved, (abs(known[count]) * radius**count).abs_lower()) if count else moved
            count += 1
            left = self._size(count)(far) * radius**count
            if count >= terms and not left > moved * SMALL:
                break
        about, off = polynomial_of(known), u - middle
        coefficients = []
        for k in range(terms):
            value = about(off)
            coefficients.append(value + around((left * comb(count, k) / radius**k).abs_upper(), value))
            about = about.derivative() * (1 / arb(k + 1))
        return coefficients

    def _derivative(self, k: int) -> Polynomial:
        if not self._derived:
            self._derived.append(self.polynomial)
        return _extended(self._derived, k)

    def _size(self, k: int) -> arb_poly:
        with precision(FEWEST_BITS):
            if not self._sized:
                self._sized.append(_sizes_of(self.polynomial))
            return _extended(self._sized, k)


def expand(system: VaryingSystem, largest: arb, bits: int, orders: int = 0) -> PowerExpansion:
    """Return minors of the fundamental matrix for abs(u) <= ``largest``, to so many bits, or ``orders``."""
    largest = largest.abs_upper()
    reach = (largest * BEYOND).abs_upper()
    legs = legs_along(system, largest, reach, bits + GUARD)
    discs = [
        () if leg.is_first else (growth_on(system, leg, reach), growth_on(system, leg, largest))
        for leg in legs
    ]
    return PowerExpansion(system, legs, discs, largest, bits, orders)


def _extended(derived: list[Derived], k: int) -> Derived:
    """Return a derivative over the factorial of its order, after those of lower orders in a list."""
    while len(derived) <= k:
        derived.append(derived[-1].derivative() * (1 / arb(len(derived))))
    return derived[k]


def _sizes_of(polynomial: Polynomial) -> arb_poly:
    """Return bounds on the sizes of coefficients."""
    return arb_poly([abs(c).upper() for c in polynomial.coeffs()])


def _combined(
    step: dict[tuple[Lines, Lines], Polynomial], rows: Lines, states: Mapping[Lines, Polynomial], terms: int
) -> Polynomial:
    """Return a minor at the end of a step, given those at its start."""
    total: Polynomial = arb_poly([])
    for line, state in states.items():
        if state.degree() >= 0:
            total += _minor(step, rows, line, terms) * state
    return total.truncate(terms)


def _minor(
    step: dict[tuple[Lines, Lines], Polynomial], rows: Lines, columns: Lines, terms: int
) -> Polynomial:
    """Return a minor of a step by its first row, and keep it."""
    if (rows, columns) not in step:
        total: Polynomial = arb_poly([])
        for n, column in enumerate(columns):
            rest = _minor(step, rows[1:], columns[:n] + columns[n + 1 :], terms)
            total += step[rows[:1], (column,)] * rest * (-1) ** n
        step[rows, columns] = total.truncate(terms)
    return step[rows, columns]


def _begun(beginning: SingularBeginning, step: Leg, reach: arb, terms: int) -> Matrix:
    """Return the solutions that are finite at a singular start, at the end of the first step."""
    n, share = beginning.matrix.size, abs(step.length) / step.radius
    growth, _ = growth_begun(beginning, step, reach)
    count = ceil((current_bits() + bits_of(growth.size)) / -log2(float(share.upper())))
    orders = beginning.matrix.series(step.start, count)
    rates: list[list[tuple[int, int, Polynomial]]] = []
    for p in range(count):
        places = {place for c in orders for place in c}
        parts = {place: [c[place][p] if place in c else arb(0) for c in orders] for place in sorted(places)}
        rates.append([(*place, polynomial_of(x)) for place, x in parts.items() if any(c != 0 for c in x)])
    diagonal: list[Number] = [arb(0)] * n
    for i, j, x in rates[0]:
        if i == j:
            diagonal[i] = x[0]
    inside = [(i, j, x) for i, j, x in rates[0] if i != j]
    sequence = sequence_of({(i, j): x for i, j, x in inside}, n)
    given = beginning.values.series(step.start, 1)
    edges = {(*place, q) for q, c in enumerate(orders) for place in c}
    made: Matrix = [[arb_poly([]) for _ in range(n)] for _ in range(n)]
    for j in range(n):
        first = [polynomial_of([c[i, j][0] if (i, j) in c else arb(0) for c in given]) for i in range(n)]
        if all(x.degree() < 0 for x in first):
            continue
        reached = _reached(
            edges, [(i, q) for q, c in enumerate(given) for i in range(n) if (i, j) in c], terms
        )
        column, sums, power = [first], list(first), arb(1)
        for k in range(1, count):
            spend()
            new: list[Polynomial] = [arb_poly([])] * n
            for p in range(1, k + 1):
                for i, m, x in rates[p]:
                    new[i] = new[i] + x * column[k - p][m]
            for i in sequence:
                for row, m, x in inside:
                    if row == i:
                        new[i] = new[i] + x * new[m]
                new[i] = new[i].truncate(terms) * (1 / (k - diagonal[i]))
            column.append(new)
            power = power * step.length
            sums = [total + x * power for total, x in zip(sums, new, strict=True)]
        for i in range(n):
            scale = growth.size / (1 - share) * growth.weights[1][i] / growth.weights[0][j] * share**count
            values = (sums[i] * step.length ** beginning.powers[i]).coeffs()
            made[i][j] = polynomial_of(
                [
                    v + around((scale / reach**m).abs_upper(), v) if (i, m) in reached else arb(0)
                    for m, v in enumerate([*values[:terms], *[arb(0)] * (terms - len(values))])
                ]
            )
    return made


def _stepped(system: VaryingSystem, step: Leg, discs: Sequence[Growth], terms: int) -> Matrix:
    """Return the fundamental matrix of a step, for abs(u) up to the last size, given growth at some sizes."""
    n, bits = system.size, current_bits()
    share = abs(step.length) / step.radius
    doublings = -log2(float(share.upper()))
    # An order in u is used times a power of the last size.
    sizes = [(bits + bits_of(d.size), log2(float((d.reach / discs[-1].reach).mid()))) for d in discs]
    places = [[size - m * apart for size, apart in sizes] for m in range(terms)]
    counts = [max(0, ceil(min(place) / doublings)) for place in places]
    parts = system.parts(step.start)
    series = system.series(step.start, max(1, counts[0])) if parts is None else []
    if parts is None and not sequence_of(series[0], n):
        # No quadratures: each slope needs what it is a slope of.
        parts = [
            RationalPart(place, coefficient, (), ((q, arb(1)),))
            for q, own in enumerate(series)
            for place, coefficient in own.items()
        ]
    if parts is None:
        edges = {(*place, q) for q, own in enumerate(series) for place in own}
        columns = _by_quadrature(series, n, step.length, [_needed(bits, min(x)) for x in places], counts)
    else:
        edges = {(*part.place, q) for part in parts for q, _ in part.rates}
        needed = [_needed(bits, min(places[0]) - k * doublings) for k in range(counts[0])]
        columns = _by_recurrence(parts, n, step.length, counts, needed)
    left = []
    for m, (place, count) in enumerate(zip(places, counts, strict=True)):
        closest = discs[place.index(min(place))]
        left.append((closest, (closest.size * share**count / (1 - share) / closest.reach**m).abs_upper()))
    made: Matrix = [[arb_poly([]) for _ in range(n)] for _ in range(n)]
    for j, values in enumerate(columns):
        reached = _reached(edges, [(j, 0)], terms)
        for i in range(n):
            made[i][j] = polynomial_of(
                [
                    v + around(rest * disc.weights[1][i] / disc.weights[0][j], v)
                    if (i, m) in reached
                    else arb(0)
                    for m, (v, (disc, rest)) in enumerate(zip(values[i], left, strict=True))
                ]
            )
    return made


def _needed(bits: int, left: float) -> int:
    """Return the bits of coefficients that lie so many above what matters."""
    return min(bits, max(FEWEST_BITS, ceil(left)))


Column = list[list[Number]]  # per state its orders in u


def _by_recurrence(
    parts: Sequence[RationalPart], n: int, length: arb, counts: Sequence[int], needed: Sequence[int]
) -> list[Column]:
    """Return the fundamental matrix of a step whose coefficients are rational in x, or power series.

    Coefficients of powers of x, which are polynomials in u, follow from a few before them: if q = r/p, then
    ``p_0 q_k = r_k - p_1 q_(k-1) - ...``. That is done factor by factor, so that balls grow no faster than
    their middles; (1 - x)^4 multiplied out has signs that alternate, and balls would grow like those of
    1/(1 - 4 x - 6 x^2 - ...).
    """
    scaled = [_to_unit_length(part, length) for part in parts]
    # Order m of column j is coefficient n m + j: all columns at once.
    states: list[list[Polynomial]] = [[arb_poly([int(i == j) for j in range(n)])] for i in range(n)]
    divided = [[list[Polynomial]() for _ in divisors] for _, divisors, _ in scaled]
    kept = sum(count > 0 for count in counts)
    for k in range(counts[0] - 1):
        # Counts fall with the order in u.
        while counts[kept - 1] <= k + 1:
            kept -= 1
        new: list[Polynomial | None] = [None] * n
        with precision(needed[k]):
            for part, (taps, divisors, common), histories in zip(parts, scaled, divided, strict=True):
                value = _convolved(taps, states[part.place[1]], k)
                for divisor, history in zip(divisors, histories, strict=True):
                    history.append(value)
                    history[k] = value = _convolved(divisor, history, k)
                for order, rate in part.rates:
                    moved = value.truncate(n * max(0, kept - order)) * (common * rate / (k + 1))
                    moved, before = moved.left_shift(n * order) if order else moved, new[part.place[0]]
                    new[part.place[0]] = moved if before is None else before + moved
        for state, following in zip(states, new, strict=True):
            state.append(arb_poly([]) if following is None else following)
    columns: list[Column] = [[] for _ in range(n)]
    for state in states:
        total: list[Number] = [*sum(state[1:], state[0]).coeffs()]
        total += [arb(0)] * (n * len(counts) - len(total))
        for j, column in enumerate(columns):
            column.append(total[j::n])
    return columns


def _to_unit_length(part: RationalPart, length: arb) -> tuple[list[Number], list[list[Number]], Number]:
    """Return a quotient on a step of length 1: numerator, a recurrence's divisors but their start, factor."""

    def coefficients(polynomial: Polynomial) -> list[Number]:
        own: Sequence[Number] = polynomial.coeffs()
        return [c * length**p for p, c in enumerate(own)]

    common: Number = length
    divisors = []
    for divisor in part.divisors:
        first, *others = coefficients(divisor)
        common = common / first
        divisors.append([arb(1), *(-c / first for c in others)])
    taps = coefficients(part.numerator)
    if len(taps) == 1:
        return [arb(1)], divisors, common * taps[0]
    return taps, divisors, common


def _convolved(taps: Sequence[Number], source: Sequence[Polynomial], k: int) -> Polynomial:
    """Return coefficient k of a product of series; a pass over all orders in u is what takes time."""
    total: Polynomial | None = None
    for p, tap in enumerate(taps[: k + 1]):
        if tap != 0:
            moved = source[k - p] if tap == 1 else source[k - p] * tap
            total = moved if total is None else total + moved
    return arb_poly([]) if total is None else total


def _reached(
    edges: Collection[tuple[int, int, int]], starts: Sequence[tuple[int, int]], terms: int
) -> set[tuple[int, int]]:
    """Return states, and orders in u, that a solution with some of them has; edges are entries in u."""
    visited, pending = set[tuple[int, int]](), list(starts)
    while pending:
        state, order = pending.pop()
        if order < terms and (state, order) not in visited:
            visited.add((state, order))
            pending += [(row, order + q) for row, column, q in edges if column == state]
    return visited


def _by_quadrature(
    series: Sequence[Coefficients], n: int, length: arb, needed: Sequence[int], counts: Sequence[int]
) -> list[Column]:
    """Return the fundamental matrix of a step from power series of the coefficients, by orders in u."""
    order = sequence_of(series[0], n)
    rows = [
        [[(q, k, a) for (row, k), a in c.items() if row == i] for q, c in enumerate(series)] for i in range(n)
    ]
    columns: list[Column] = []
    for j in range(n):
        orders: list[dict[int, Polynomial]] = []
        values: Column = [[arb(0)] * len(counts) for _ in range(n)]
        for m, (bits, count) in enumerate(zip(needed, counts, strict=True)):
            here: dict[int, Polynomial] = {}
            orders.append(here)
            if count == 0:
                continue
            with precision(bits):
                for i in order:
                    parts = [
                        (a * orders[m - q][k]).truncate(count - 1)
                        for group in rows[i][: m + 1]
                        for q, k, a in group
                        if k in orders[m - q]
                    ]
                    if parts:
                        here[i] = sum(parts[1:], parts[0]).integral()
                    if m == 0 and i == j:
                        here[i] = here[i] + 1 if i in here else arb_poly([1])
                for i, grown in here.items():
                    values[i][m] = grown(length)
        columns.append(values)
    return columns


def around(radius: arb, value: Number) -> Number:
    """Return a ball about 0, a real one for a real value."""
    return arb(0, radius) if isinstance(value, arb) else acb(arb(0, radius), arb(0, radius))
