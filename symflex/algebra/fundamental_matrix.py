"""Fundamental matrices of linear differential equations whose coefficients vary along x, in balls.

Input: ``dz/dx = A(x, u) z`` with ``A = sum_q u^q A_q(x)``, as a :class:`VaryingSystem`.
Output: a :class:`PowerExpansion`: Z(end), where Z(start) is the unit matrix, as polynomials in u with bounds
on what they leave out. Once it is made, a value at another u costs the evaluation of polynomials.

    y'' = u (1 + x) y, z = (y, y')      A_0 = ((0, 1), (0, 0)), A_1 = ((0, 0), (1 + x, 0))
    order 0 in u: ((1, x), (0, 1))      order 1: A_1 times that, integrated: y' first, y after it
    y(1) = 1 + 2/3 u + ..., where y(0) = 1 and y'(0) = 0

On a step every order in u is a power series in x, one quadrature after the other. As Z is analytic in x and u
together, Cauchy's estimate bounds what these leave out: a coefficient of ``x^k u^m`` is at most
``exp(rho K)/(rho^k R^m)``, if the norm of A is at most K for abs(x) <= rho and abs(u) <= R. States are scaled
so that this norm is about a wavenumber.

Where A has a pole at the start, the first step is that of a :class:`SingularBeginning`, whose finite
solutions are power series: ``h v' = B v`` makes ``(k - B_0) v_k = B_1 v_(k-1) + ... + B_k v_0``. The same
with sizes in place of numbers bounds as many terms as one likes. If B is at most M on abs(h) <= rho and
``k (k - B_0)^-1`` at most c, then all terms with k > c M fall at least as those of ``1/(1 - 2 h/rho)`` do.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import ceil, factorial, floor, inf, isfinite, log2
from typing import TYPE_CHECKING, Protocol

from flint import acb, acb_poly, arb, arb_poly, ctx

from symflex.budget import spend

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

Place = tuple[int, int]
"""Row and column."""
Polynomial = arb_poly | acb_poly
Number = arb | acb
Coefficients = dict[Place, Polynomial]
"""Entries of a matrix that are not zero, as polynomials in x less the point of expansion."""
Matrix = list[list[Polynomial]]
"""Entries as polynomials in u."""
Weights = tuple[arb, ...]
"""Powers of two by which states are scaled."""
Lines = tuple[int, ...]
"""Rows or columns of a minor."""

BALANCINGS = 60
"""Rounds of balancing the states: of four in a circle each leaves half of what is out of balance."""
BALANCED = 0.1
"""Bits by which rows and columns may differ."""
SHARE = 3
"""The radius on which coefficients are bounded, over the length of a step."""
SHORTEST = 1e-5
"""Share of the whole below which the radius of a step means that there is a singularity."""
ROUNDING = 2.0**-50
"""Of a place in doubles: that of a singularity at an end is met then, too."""
MOST_STEPS = 1000
"""Ten times those of a thousand modes, and more than coefficients need that anyone means."""
HALVINGS = 40
"""Of an interval in which a singularity lies: it is told to six digits."""
LAST = 1.2
"""A step may be so much longer than others if it is the last."""
RADII = tuple(4.0 * 0.8**k for k in range(80))
"""Radii that are tried about a point, in lengths of the whole; the least is 1e-7 of it."""
GUARD = 32
"""Bits beyond those asked for: products of a few dozen steps round a few hundred times."""
BEYOND = 32
"""Polynomials in u are bounded on a disc so many times larger than what they are used on."""
MORE_LOST = 1.25
"""Over the bits by which solutions grow: minors of two rows lose no more than these, of three rows twice."""
FEWEST_BITS = 30
"""Of orders in u that hardly matter."""
BOUNDED = 4
"""Parts of a step on each of which coefficients are bounded: on the whole they would be a quarter larger."""
SAMPLES = 8
"""Points at which the growth along x is sampled where about what it is suffices."""
MOST_TERMS = 1500
"""Of the power series about a singular start: three times what the tenth mode of a hanging string takes."""
MOST_HALVINGS = 40
"""Of the first step from a singular start."""
BOUND_BITS = 64
"""Of bounds, which are added up and rounded up."""
BITS_OF_E = 1.4426950408889634
ASIDE = 1 / 16
"""Share of abs(u) by which what is cut off a polynomial is bounded beyond it, for its derivatives."""
CUTS = 4
"""Parts of an octave: a quarter more in abs(u) costs some two bits, far fewer than are kept to spare."""
HIGHEST_CUT = 1000
"""Power of two of abs(u) beyond which bounds come near the end of doubles."""
WIDE = 2.0**-30
"""Relative radius of balls about whose middle a polynomial is expanded before it is evaluated."""


class SingularCoefficientError(ValueError):
    """A coefficient is not analytic about a point of the interval, or so steep that none could tell."""

    def __init__(self, place: float, *, is_steep: bool = False) -> None:
        super().__init__(place)
        self.place = place
        self.is_steep = is_steep  # analytic as far as is known


@dataclass(frozen=True, slots=True)
class RationalPart:
    """A part of an entry: a quotient of polynomials in x, times powers of u."""

    place: Place
    numerator: Polynomial  # in x less the point of expansion
    divisors: tuple[Polynomial, ...]  # of the same; a factor of the denominator stands as often as it occurs
    rates: tuple[tuple[int, Number], ...]  # the powers of u, and what each is multiplied by


class VaryingSystem(Protocol):
    """The coefficients of a system, evaluated at the current precision."""

    @property
    def size(self) -> int:
        """The number of states."""
        ...

    @property
    def beginning(self) -> SingularBeginning | None:
        """What stands in place of the coefficients at a start where these have poles."""
        ...

    def ends(self) -> tuple[arb, arb]:
        """Return where x begins and ends."""
        ...

    def series(self, x: arb, terms: int) -> Sequence[Coefficients]:
        """Return, per power of u, the entries' Taylor polynomials about a point."""
        ...

    def parts(self, x: arb) -> Sequence[RationalPart] | None:
        """Return what entries are sums of about a point, ``None`` where some are not rational in x."""
        ...

    def bounds(self, x: acb, largest: arb) -> Mapping[Place, arb]:
        """Return the sizes of entries on a ball of x for abs(u) <= ``largest``; not finite near a pole."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class SingularBeginning:
    """Solutions that are finite at a start where coefficients have poles: ``z_i = h^powers_i v_i``.

    See :class:`symflex.algebra.dispersion.SingularStart`, of which these are the matrices.
    """

    powers: tuple[int, ...]
    matrix: VaryingSystem  # B, with series and bounds about the start; what vanishes there is exactly zero
    values: VaryingSystem  # v at the start


@dataclass(frozen=True, eq=False)
class PowerExpansion:
    """A fundamental matrix as polynomials in u."""

    entries: Matrix
    terms: int  # of each polynomial
    bits: int  # the precision of the polynomials
    reach: arb  # up to which abs(u) the growth holds; values are for abs(u) well below it
    growth: arb  # bounds every entry, over the weight of its row, times that of its column
    # of the states, at the start and at the end
    weights: tuple[Weights, Weights]
    _minors: dict[tuple[Lines, Lines], Polynomial] = field(default_factory=dict, repr=False)
    _cuts: dict[tuple[Lines, Lines, int, int], tuple[Polynomial, arb]] = field(
        default_factory=dict, repr=False
    )
    # The sizes of coefficients, and their logarithms.
    _sizes: dict[tuple[Lines, Lines], tuple[arb_poly, list[float]]] = field(default_factory=dict, repr=False)

    def series(self, rows: Lines, columns: Lines, u: acb, terms: int = 1) -> list[acb]:
        """Return Taylor coefficients about ``u`` of a minor; of an entry, where there is one row."""
        middle, size = u.mid(), abs(u).upper()
        off = u - middle
        found = []
        is_wide = bool(u.rad() > abs(middle) * WIDE)
        # Terms of an alternating series are larger than their sum: more bits, and the middle of the ball.
        with ctx.workprec(self._bits_about(rows, columns, middle) if is_wide else self.bits):
            polynomial, cut = self._cut(rows, columns, size)
            if is_wide:
                polynomial, middle, off = acb_poly(polynomial)(acb_poly([middle, 1])), acb(0), acb(0)
                at = u - u.mid()
            else:
                at = middle
            for k in range(terms):
                polynomial = polynomial.derivative() * (1 / acb(k)) if k else polynomial
                value = acb(polynomial(at))
                if off != 0:
                    value += acb(polynomial.derivative()(u)) * off
                rest = self._rest(rows, columns, size, k)
                if cut > 0:
                    rest = (rest + cut / (size * ASIDE) ** k).abs_upper()
                found.append(value + acb(arb(0, rest), arb(0, rest)))
        return [+x for x in found]

    def _cut(self, rows: Lines, columns: Lines, size: arb) -> tuple[Polynomial, arb]:
        """Return what matters of a polynomial for abs(u) up to a size at the current precision.

        The second bounds the rest for abs(u) up to ``1 + ASIDE`` times the size.
        """
        polynomial, way = self._polynomial(rows, columns), float(size)
        if not 0 < way < 2.0**HIGHEST_CUT:
            return polynomial, arb(0)
        # Sizes up to the same part of an octave are cut alike, once. A millionth more makes up for rounding.
        part = floor(CUTS * log2(way) + 1e-6) + 1
        key = rows, columns, part, ctx.prec
        if key not in self._cuts:
            self._cuts[key] = self._cut_for(rows, columns, 2.0 ** (part / CUTS) * (1 + ASIDE))
        return self._cuts[key]

    def _cut_for(self, rows: Lines, columns: Lines, way: float) -> tuple[Polynomial, arb]:
        polynomial, upto = self._polynomial(rows, columns), arb(way)
        sizes, logarithms = self._sizes_of(rows, columns)
        terms = [x + m * log2(way) for m, x in enumerate(logarithms)]
        least = max(terms, default=0.0) - ctx.prec - GUARD
        count = next((m + 1 for m in reversed(range(len(terms))) if terms[m] > least), 0)
        with ctx.workprec(FEWEST_BITS):
            left = sizes.right_shift(count)(upto) * upto**count
        return polynomial.truncate(count), left.abs_upper()

    def _sizes_of(self, rows: Lines, columns: Lines) -> tuple[arb_poly, list[float]]:
        """Return the sizes of the coefficients of a polynomial, and about their logarithms to base 2."""
        if (rows, columns) not in self._sizes:
            with ctx.workprec(FEWEST_BITS):
                sizes = [abs(c).upper() for c in self._polynomial(rows, columns).coeffs()]
                logarithms = [float(x.log()) * BITS_OF_E if x > 0 else -inf for x in sizes]
                self._sizes[rows, columns] = arb_poly(sizes), logarithms
        return self._sizes[rows, columns]

    def _bits_about(self, rows: Lines, columns: Lines, middle: acb) -> int:
        """Return the bits with which a minor keeps those of the current precision about a point."""
        with ctx.workprec(self.bits):
            value = abs(self._cut(rows, columns, abs(middle).upper())[0](middle))
        with ctx.workprec(FEWEST_BITS):
            lost = self._sizes_of(rows, columns)[0](abs(middle)) / value
        if not 1 <= lost < arb(2) ** self.bits:
            return self.bits
        mantissa, exponent = lost.upper().man_exp()
        return min(self.bits, ctx.prec + GUARD + int(mantissa).bit_length() + int(exponent))

    def _rest(self, rows: Lines, columns: Lines, size: arb, k: int) -> arb:
        """Return a bound on what a polynomial leaves out of the k-th Taylor coefficient, by Cauchy."""
        if size == 0 and k < self.terms:
            return arb(0)
        whole = self.growth ** len(rows) * factorial(len(rows))
        for i, j in zip(rows, columns, strict=True):
            whole = whole * self.weights[1][i] / self.weights[0][j]
        apart = max(size, self.reach / BEYOND) if k else arb(0)
        room = (size + apart) / self.reach
        if not room < 1:
            return arb("inf")
        return (whole * room**self.terms / (1 - room) / apart**k).abs_upper()

    def _polynomial(self, rows: Lines, columns: Lines) -> Polynomial:
        if len(rows) == 1:
            return self.entries[rows[0]][columns[0]]
        if (rows, columns) not in self._minors:
            total: Polynomial = arb_poly([])
            for n, column in enumerate(columns):
                rest = self._polynomial(rows[1:], columns[:n] + columns[n + 1 :])
                total += self.entries[rows[0]][column] * rest * (-1) ** n
            self._minors[rows, columns] = total.truncate(self.terms)
        return self._minors[rows, columns]


@dataclass(frozen=True, slots=True)
class Leg:
    """A part of the interval."""

    start: arb
    end: arb
    radius: arb  # about the start, in which coefficients are bounded
    growth: float  # bits by which solutions grow on the radius at most
    weights: Weights  # with which they do
    # Of a first step from a start where coefficients have poles: bits by which solutions grow up to its end.
    reached: float | None = None

    @property
    def length(self) -> arb:
        """Its length, negative where x falls."""
        return self.end - self.start


def growth_along(system: VaryingSystem, largest: arb) -> float:
    """Return about by which power of e solutions grow from end to end at most, for abs(u) <= ``largest``."""
    start, end = system.ends()
    share, total = (end - start) / SAMPLES, 0.0
    for k in range(SAMPLES):
        x = (start + share * (k + 0.5)).mid()
        norm = _norm(system, acb(x), largest, _weights(system, acb(x), largest))
        total += float((norm * abs(share)).mid())
    return total


def expand(system: VaryingSystem, largest: arb, bits: int, orders: int = 0) -> PowerExpansion:
    """Return the fundamental matrix from the start of x to its end, for abs(u) <= ``largest``.

    It is exact to about so many bits relative to the minors that grow, or has ``orders`` in u where these
    are given. Raises SingularCoefficientError where a coefficient has a singularity on the interval.
    """
    reach = (largest * BEYOND).abs_upper()
    steps = steps_along(system, reach, bits)
    growth, weights = _growth(system, steps, reach)
    doublings = float(growth.upper()) * BITS_OF_E
    terms = orders or max(2, ceil((bits + 2 * doublings) / log2(BEYOND / 2)))
    total: Matrix | None = None
    # A minor falls below the products it is the difference of by about what solutions grow where it is used.
    lost = float(_growth(system, steps, largest)[0].upper()) * BITS_OF_E * MORE_LOST
    with ctx.workprec(bits + GUARD + ceil(min(lost, doublings))):
        start, end = system.ends()
        steps[0] = replace(steps[0], start=start)
        steps[-1] = replace(steps[-1], end=end)
        for step in steps:
            spend()
            beginning = None if step.reached is None else system.beginning
            made = (
                _stepped(system, step, reach, terms)
                if beginning is None
                else _begun(beginning, step, reach, terms)
            )
            total = made if total is None else _product(made, total, terms)
        return PowerExpansion(total or [], terms, ctx.prec, reach, growth.exp().abs_upper(), weights)


def steps_along(system: VaryingSystem, reach: arb, bits: int) -> list[Leg]:
    """Return the parts of the interval on each of which solutions are expanded, for abs(u) <= ``reach``.

    Raises SingularCoefficientError where a coefficient has a singularity on the interval.
    """
    begin, end = system.ends()
    first = [] if system.beginning is None else [_first_step(system.beginning, begin, end, reach, bits)]
    return first + _steps(system, first[0].end if first else begin, end, reach, bits)


def _growth(system: VaryingSystem, steps: Sequence[Leg], reach: arb) -> tuple[arb, tuple[Weights, Weights]]:
    """Return by which power of e solutions grow at most for abs(u) up to a reach, and states at the ends.

    States are scaled anew on every part of a step.
    """
    growth, found = arb(0), list[Weights]()
    for step in steps:
        if step.reached is not None:
            growth += step.reached * arb(2).log()
            found.append(step.weights)
            continue
        part = step.length / BOUNDED
        for k in range(BOUNDED):
            middle = step.start + part * (k + 0.5)
            found.append(_weights(system, acb(middle.mid()), reach))
            hull = acb(middle + arb(0, (part / 2).abs_upper()))
            growth += _norm(system, hull, reach, found[-1]) * abs(part)
    for before, after in pairwise(found):
        growth += max(x / y for x, y in zip(before, after, strict=True)).log()
    return growth, (found[0], found[-1])


def _weights(system: VaryingSystem, middle: acb, reach: arb) -> Weights:
    """Return powers of two that make rows and columns of the coefficients alike (Osborne 1960)."""
    sizes = {
        place: log2(size)
        for place, x in system.bounds(middle, reach).items()
        if place[0] != place[1] and 0 < (size := float(x.upper())) < inf
    }
    found = [0.0] * system.size
    for _ in range(BALANCINGS):
        before = list(found)
        for i in range(system.size):
            row = [x + found[k] for (j, k), x in sizes.items() if j == i]
            column = [x - found[j] for (j, k), x in sizes.items() if k == i]
            if row and column:
                found[i] = (max(row) - max(column)) / 2
        if max(abs(x - y) for x, y in zip(found, before, strict=True)) < BALANCED:
            break
    return tuple(arb(2.0**x) for x in found)


def _norm(system: VaryingSystem, x: acb, reach: arb, weights: Sequence[arb]) -> arb:
    """Return a bound on the norm of the scaled coefficients on a ball of x; not finite near a singularity."""
    rows = [arb(0)] * system.size
    for (i, j), size in system.bounds(x, reach).items():
        rows[i] += size * weights[j] / weights[i]
    return max((row.abs_upper() if row.is_finite() else arb("inf") for row in rows), key=float)


def _steps(system: VaryingSystem, start: arb, end: arb, reach: arb, bits: int) -> list[Leg]:
    """Return steps of which each costs few terms over its length."""
    whole, at, found = end - start, start, list[Leg]()
    while at is not end:
        if len(found) == MOST_STEPS:
            raise SingularCoefficientError(float(at.mid()), is_steep=True)
        best: tuple[float, arb, float] | None = None
        weights = _weights(system, acb(at), reach)
        for share in RADII:
            radius = (abs(whole) * share).upper()
            square = arb(0, radius)
            norm = _norm(system, acb(at + square, square), reach, weights)
            # One more, as this is rounded.
            growth = float((norm * radius).upper()) * BITS_OF_E + 1
            if not isfinite(growth):
                continue
            cost = (bits + growth) / min(float(radius), SHARE * float(abs(end - at).upper()))
            if best is not None and cost > best[0]:
                break
            best = (cost, radius, growth)
        if best is None or best[1] < abs(whole) * SHORTEST:
            raise _no_step(system, at, end, reach, weights)
        _, radius, growth = best
        length, left = (radius / SHARE).mid(), end - at
        following = end if abs(left) <= length * LAST else (at + (length if left > 0 else -length)).mid()
        found.append(Leg(at, following, radius, growth, weights))
        at = following
    return found


def _first_step(beginning: SingularBeginning, start: arb, end: arb, reach: arb, bits: int) -> Leg:
    """Return the longest step from a start where coefficients have poles that costs not too many terms.

    It is a sixth of the radius on which coefficients are bounded, and a third of that on which solutions are.
    """
    whole = abs(end - start)
    for k in range(MOST_HALVINGS):
        radius = (whole * 2 * SHARE / 2**k).upper()
        square = arb(0, radius)
        hull = acb(start + square, square)
        weights = _weights(beginning.matrix, hull, reach)
        norm = _norm(beginning.matrix, hull, reach, weights)
        if not norm < MOST_TERMS:
            continue
        length = (radius / (2 * SHARE)).mid()
        following = end if k == 0 else (start + (length if end > start else -length)).mid()
        growth = _bounded(beginning, start, reach, weights, (norm, radius / 2, abs(following - start)), bits)
        if growth is not None:
            way = abs(following - start)
            scaled = tuple((w * way**d).mid() for w, d in zip(weights, beginning.powers, strict=True))
            return Leg(start, following, radius / 2, growth[0], scaled, growth[1])
    raise SingularCoefficientError(float(start.mid()))


def _bounded(
    beginning: SingularBeginning,
    start: arb,
    reach: arb,
    weights: Weights,
    sizes: tuple[arb, arb, arb],
    bits: int,
) -> tuple[float, float] | None:
    """Return by how many bits solutions grow on a radius at most, and up to the step's end.

    Sizes are the norm of B on twice the radius, the radius, and the step. None where too many terms of v have
    to be bounded before those that follow fall.
    """
    norm, radius, way = sizes
    with ctx.workprec(BOUND_BITS):
        parts = [
            [(i, j, x * weights[j] / weights[i]) for i, j, x in rates]
            for rates in _by_powers(beginning.matrix, start, MOST_TERMS, reach)
        ]
        inside = [(i, j, x) for i, j, x in parts[0] if i != j]
        # Nowhere positive itself, so its size is what k is increased by.
        diagonal = {i: x for i, j, x in parts[0] if i == j}
        sequence = _order({(i, j): acb_poly([1]) for i, j, _ in inside}, len(weights))
        across = sum((x for _, _, x in inside), arb(0))
        first = [arb(0)] * len(weights)
        for i, j, x in _by_powers(beginning.values, start, 1, reach)[0]:
            first[i] += x * weights[j] / weights[i]
        column, largest, total = [first], arb(0), arb(0)
        for k in range(MOST_TERMS):
            size = sum(column[k], arb(0)).abs_upper()
            if not size.is_finite():
                return None
            largest = max(largest, size * radius**k)
            total += size * way**k
            resolvent = sum(((across / (k + 1)) ** j for j in range(len(weights))), arb(0))
            left = largest * (way / radius) ** (k + 1)
            if norm * resolvent < k + 1 and left * arb(2) ** bits < 1:
                most, reached = (float(x.log().upper()) * BITS_OF_E for x in (largest, total + 2 * left))
                return most, reached
            new = [arb(0)] * len(weights)
            for p in range(1, k + 2):
                for i, j, x in parts[p] if p < MOST_TERMS else ():
                    new[i] += x * column[k + 1 - p][j]
            for i in sequence:
                new[i] += sum((x * new[j] for row, j, x in inside if row == i), arb(0))
                new[i] = (new[i] / (k + 1 + diagonal.get(i, 0))).abs_upper()
            column.append(new)
    return None


def _by_powers(system: VaryingSystem, start: arb, count: int, reach: arb) -> list[list[tuple[int, int, arb]]]:
    """Return bounds on the coefficients of every power of the way from a start, for abs(u) up to a reach."""
    found: list[dict[Place, arb]] = [{} for _ in range(count)]
    for order, coefficients in enumerate(system.series(start, count)):
        for place, polynomial in coefficients.items():
            for p, x in enumerate(acb_poly(polynomial).coeffs()):
                if (size := abs(x).upper()) > 0:
                    found[p][place] = found[p].get(place, arb(0)) + size * reach**order
    return [[(*place, x) for place, x in each.items()] for each in found]


def _begun(beginning: SingularBeginning, step: Leg, reach: arb, terms: int) -> Matrix:
    """Return the solutions that are finite at a singular start, at the end of the first step."""
    n, share = beginning.matrix.size, abs(step.length) / step.radius
    count = ceil((ctx.prec + step.growth) / -log2(float(share.upper())))
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
    sequence = _order({(i, j): x for i, j, x in inside}, n)
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
            scale = arb(2) ** step.growth / (1 - share) * step.weights[i] / step.weights[j] * share**count
            values = (sums[i] * step.length ** beginning.powers[i]).coeffs()
            made[i][j] = polynomial_of(
                [
                    v + around((scale / reach**m).abs_upper(), v) if (i, m) in reached else arb(0)
                    for m, v in enumerate([*values[:terms], *[arb(0)] * (terms - len(values))])
                ]
            )
    return made


def _no_step(
    system: VaryingSystem, at: arb, end: arb, reach: arb, weights: Sequence[arb]
) -> SingularCoefficientError:
    """Return about where the first singularity behind a point is, which steps do not come closer to."""
    low, high = at.mid(), end.mid()
    for _ in range(HALVINGS):
        middle = ((low + high) / 2).mid()
        between = acb((low + middle) / 2 + arb(0, abs(middle - low) / 2))
        finite = _norm(system, between, reach, weights).is_finite()
        low, high = (middle, high) if finite else (low, middle)
    # Balls in which a steep function is far from its middle are not finite either, but small ones are.
    closest = abs(end - at).upper() / 2 ** (HALVINGS - 2) + abs(low).upper() * ROUNDING
    around = acb(low + arb(0, closest), arb(0, closest))
    is_steep = _norm(system, around, reach, weights).is_finite()
    return SingularCoefficientError(float(low), is_steep=bool(is_steep))


def _stepped(system: VaryingSystem, step: Leg, reach: arb, terms: int) -> Matrix:
    """Return the fundamental matrix of a step."""
    n, bits = system.size, ctx.prec
    share = abs(step.length) / step.radius
    doublings = -log2(float(share.upper()))
    # An order in u is used times a power of the largest u, and needs so many bits fewer.
    below = [int(m * log2(BEYOND)) for m in range(terms)]
    counts = [ceil((max(FEWEST_BITS, bits - x) + step.growth) / doublings) for x in below]
    parts = system.parts(step.start)
    series = system.series(step.start, counts[0]) if parts is None else []
    if parts is None and not _order(series[0], n):
        # No quadratures: each slope needs what it is a slope of.
        parts = [
            RationalPart(place, coefficient, (), ((q, arb(1)),))
            for q, own in enumerate(series)
            for place, coefficient in own.items()
        ]
    if parts is None:
        needed = [_needed(step, x) for x in below]
        columns = _by_quadrature(series, n, step.length, needed, counts)
    else:
        needed = [_needed(step, int(k * doublings)) for k in range(counts[0])]
        columns = _by_recurrence(parts, n, step.length, counts, needed)
    made: Matrix = [[arb_poly([]) for _ in range(n)] for _ in range(n)]
    for j, values in enumerate(columns):
        for i in range(n):
            scale = arb(2) ** step.growth / (1 - share) * step.weights[i] / step.weights[j]
            made[i][j] = polynomial_of(
                [
                    arb(0) if v is None else v + around((scale * share**count / reach**m).abs_upper(), v)
                    for m, (v, count) in enumerate(zip(values[i], counts, strict=True))
                ]
            )
    return made


def _needed(step: Leg, below: int) -> int:
    """Return the bits of coefficients that lie so many below what solutions grow to on the radius."""
    return max(FEWEST_BITS, ctx.prec + min(0, ceil(step.growth) - below))


Column = list[list[Number | None]]
"""Per state its orders in u; what no coefficient reaches is zero, and stays None."""


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
    kept = len(counts)
    for k in range(counts[0] - 1):
        # Counts fall with the order in u.
        while counts[kept - 1] <= k + 1:
            kept -= 1
        new: list[Polynomial | None] = [None] * n
        with ctx.workprec(needed[k]):
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
    edges = [(*part.place, q) for part in parts for q, _ in part.rates]
    reached = [_reached(edges, [(j, 0)], len(counts)) for j in range(n)]
    columns: list[Column] = [[] for _ in range(n)]
    for i, state in enumerate(states):
        total: list[Number] = [*sum(state[1:], state[0]).coeffs()]
        total += [arb(0)] * (n * len(counts) - len(total))
        for j, column in enumerate(columns):
            column.append([v if (i, m) in reached[j] else None for m, v in enumerate(total[j::n])])
    return columns


def _to_unit_length(part: RationalPart, length: arb) -> tuple[list[Number], list[list[Number]], Number]:
    """Return a quotient on a step of length 1: numerator, divisors less those of their start, and a factor.

    Divisors have the signs with which a recurrence takes them; what they divide comes first.
    """

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
    """Return the states, and their orders in u, that a solution has which starts with some of them.

    Edges are the row and the column of an entry, with a power of u that it holds.
    """
    found, pending = set[tuple[int, int]](), list(starts)
    while pending:
        state, order = pending.pop()
        if order < terms and (state, order) not in found:
            found.add((state, order))
            pending += [(row, order + q) for row, column, q in edges if column == state]
    return found


def _by_quadrature(
    series: Sequence[Coefficients], n: int, length: arb, needed: Sequence[int], counts: Sequence[int]
) -> list[Column]:
    """Return the fundamental matrix of a step from power series of the coefficients, order by order in u.

    At order 0 slopes follow from one another.
    """
    order = _order(series[0], n)
    rows = [
        [[(q, k, a) for (row, k), a in c.items() if row == i] for q, c in enumerate(series)] for i in range(n)
    ]
    columns: list[Column] = []
    for j in range(n):
        orders: list[dict[int, Polynomial]] = []
        values: Column = [[None] * len(counts) for _ in range(n)]
        for m, (precision, count) in enumerate(zip(needed, counts, strict=True)):
            here: dict[int, Polynomial] = {}
            orders.append(here)
            with ctx.workprec(precision):
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


def polynomial_of(coefficients: Sequence[Number]) -> Polynomial:
    """Return a polynomial, a real one where all coefficients are real."""
    real = [c for c in coefficients if isinstance(c, arb)]
    return arb_poly(real) if len(real) == len(coefficients) else acb_poly(list(coefficients))


def around(radius: arb, value: Number) -> Number:
    """Return a ball about 0, a real one for a real value."""
    return arb(0, radius) if isinstance(value, arb) else acb(arb(0, radius), arb(0, radius))


def _product(left: Matrix, right: Matrix, terms: int) -> Matrix:
    n = len(left)
    return [
        [sum((left[i][k] * right[k][j] for k in range(n)), arb_poly([])).truncate(terms) for j in range(n)]
        for i in range(n)
    ]


def _order(coefficients: Coefficients, n: int) -> list[int]:
    """Return the states so that the slope of each follows from those before it; empty if they go in circles.

    Examples
    --------
    >>> _order({(0, 1): acb_poly([1]), (1, 2): acb_poly([1])}, 3)
    [2, 1, 0]
    """
    found: list[int] = []
    while len(found) < n:
        ready = [
            i for i in range(n) if i not in found and all(k in found for (row, k) in coefficients if row == i)
        ]
        if not ready:
            return []
        found += ready
    return found
