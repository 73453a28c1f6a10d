"""The system matrix ``P(s) = [A(s) B; C D]`` of chosen inputs and outputs, and where parts of it lose rank.

Input: equations with numbers, ``A(s) x + B u = 0``, ``y = C x + D u``.
Output: a :class:`SystemMatrix`. In balls at an s: proofs that a part of it has full rank, and null vectors
where it has not. Modulo a prime: polynomials whose roots are where parts of it lose rank.

Example: two carts on springs, F pushes the first, whose displacement is read. With ``[A B]`` of full rank
everywhere F moves both carts in all their motions; where the second cart stands on its own, not joined to the
first, its mode is an input-decoupling zero.

    part          loses rank at                             Rosenbrock 1970
    A             the modes of the model
    [A B]         input-decoupling zeros: no input moves them
    [A; C]        output-decoupling zeros: no output shows them
    [A B; C D]    invariant zeros

The maximal minors of a part are many. Those of ``A + B K`` for all K have the same common roots, as each is a
sum of minors of ``[A B]`` times minors of ``[1; K]``, which are independent (Cauchy and Binet). So one
determinant with K at random that is proved not to vanish at a point proves full rank there; and the greatest
common divisor of a few of these is that of all minors but for odds of about 1 in 2^50 (Schwartz 1980).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import combinations, count, product
from math import lcm
from random import Random
from typing import Generic, TypeVar

from flint import acb, acb_mat, fmpz_mpoly, fmpz_poly, nmod_mat, nmod_poly

from symflex.algebra import LAPLACE, Factored, Ring, residue
from symflex.algebra.polynomial_determinant import determinant, in_one_variable
from symflex.balls import UndecidedError, eliminate
from symflex.budget import spend
from symflex.equations import Equations, radicals_of
from symflex.model.model import IMAGINARY
from symflex.roots.networks.at_rest import place_on_circles
from symflex.roots.networks.cramer import bordered
from symflex.transfer.equations_at import EquationsAt

Row = dict[int, acb]
Value = TypeVar("Value")
Draw = Callable[[int, int], nmod_mat]  # a matrix of random numbers, by rows and columns
Weights = Sequence[Sequence[int]]  # by row, then by column
ZERO, ONE = acb(0), acb(1)
LARGEST_WEIGHT = 997  # of combinations in balls: no model has such numbers by chance
DRAWS = 3  # determinants whose greatest common divisor is taken
MOST_DEGREE = 2_048  # of a determinant modulo a prime, beyond which it is taken for no polynomial
MOST_FREE = 8  # null vectors that are looked for at a point
MOST_AT_ONCE = 32  # unknowns whose determinants are taken at one s; sparse rows of more are derived faster
MOST_DENSE = 64  # rows of a full matrix whose null vector comes from all of it
FULL = 0.5  # share of entries of a matrix that counts as full; others keep zeros that are exact
FIRST_POINTS = 16  # at which a determinant is taken first; twice as many until they say its degree
CHECKS = 2  # points beyond these at which the polynomial has to agree


@dataclass(frozen=True, eq=False)
class SystemMatrix:
    """``[A B; C D]`` with numbers, its columns unknowns and then inputs."""

    numeric: EquationsAt
    upper: Sequence[Mapping[int, Factored]]  # rows of [A B]
    lower: Sequence[Mapping[int, Factored]]  # rows of [C D]
    inputs: int

    @staticmethod
    def of(equations: Equations, outputs: Sequence[str], inputs: Sequence[str]) -> SystemMatrix:
        """Return the matrix; an output that is filtered, ``divisor*y = form``, is an unknown more."""
        upper, lower, divisors = bordered(equations, outputs, inputs)
        moving = [i for i, divisor in enumerate(divisors) if divisor.depends_on(LAPLACE)]
        count = len(upper)

        def apart(row: Mapping[int, Factored]) -> dict[int, Factored]:
            return {j if j < count else j + len(moving): c for j, c in row.items()}

        upper, lower = [apart(row) for row in upper], [apart(row) for row in lower]
        for i, divisor in enumerate(divisors):
            if i not in moving:
                lower[i] = {j: c / divisor for j, c in lower[i].items()}
        for place, i in enumerate(moving, count):
            upper.append({**{j: -c for j, c in lower[i].items()}, place: divisors[i]})
            lower[i] = {place: divisors[i] ** 0}
        return SystemMatrix(EquationsAt(equations), upper, lower, len(inputs))

    @property
    def is_real(self) -> bool:
        """Whether values at conjugate s are conjugate: without loss factors."""
        return IMAGINARY not in self.numeric.equations.ring.index

    def on(self, s: acb) -> SystemValues:
        """Return the values on a ball of s [rad/s], at the current precision."""
        spend()
        number = self.numeric.on(s)
        upper, lower = (
            [{j: acb(number(c)) for j, c in row.items()} for row in part] for part in (self.upper, self.lower)
        )
        return SystemValues(upper, lower, self.inputs)

    def determinants(self, independent: Sequence[tuple[int, int]]) -> list[fmpz_poly] | None:
        """Return the determinants of A and of ``[A B; C D]`` with some outputs and inputs, up to numbers.

        ``None`` where entries are no polynomials in s with rational coefficients, or rows are many.
        """
        if self.numeric.equations.definitions or len(self.upper) > MOST_AT_ONCE:
            return None
        rows: list[dict[int, fmpz_poly]] = []
        for row in (*self.upper, *(self.lower[i] for i, _ in independent)):
            scale = lcm(*(c.unit.denominator for c in row.values()))
            rows.append({})
            for j, c in row.items():
                is_polynomial = all(e > 0 for _, e in c.factors)
                entry = in_one_variable((c * scale).expand(), c.ring) if is_polynomial else None
                if entry is None:
                    return None
                rows[-1][j] = entry
        size = len(self.upper)
        columns = [*range(size), *(size + j for _, j in independent)]
        return [determinant(rows[:size], columns[:size]), determinant(rows, columns)]

    @cached_property
    def modulo(self) -> PrimeSystem | None:
        """The matrix modulo a prime; ``None`` where roots of numbers have no value there."""
        equations = self.numeric.equations
        found = radicals_of(equations.ring, equations.constants, equations.model.parameters).point()
        if found is None:
            return None
        prime, point = found
        place_on_circles(equations.constants, point, prime)
        return PrimeSystem(self, prime, point)


# ------------------------------------------------------------------------------------------------ in balls


@dataclass(frozen=True, eq=False)
class SystemValues:
    """The system matrix on a ball of s."""

    upper: Sequence[Mapping[int, acb]]
    lower: Sequence[Mapping[int, acb]]
    inputs: int

    @property
    def is_controllable(self) -> bool:
        """Whether ``[A B]`` is proved to have full rank all over the ball."""
        size = len(self.upper)
        return is_regular(_columns(self.upper, size, _weights(self.inputs, size, 1), 0))

    @property
    def is_observable(self) -> bool:
        """Whether ``[A; C]`` is proved to have full rank all over the ball."""
        size = len(self.upper)
        rows = _rows(self.upper, self.lower, _weights(size, len(self.lower), 2), 0)
        return is_regular([{j: x for j, x in row.items() if j < size} for row in rows])

    def minor(self, rows: Sequence[int], columns: Sequence[int]) -> list[Row]:
        """Return the matrix of some outputs and inputs."""
        size = len(self.upper)
        places = {size + j: size + k for k, j in enumerate(columns)} | {j: j for j in range(size)}
        kept = (*self.upper, *(self.lower[i] for i in rows))
        return [{places[j]: x for j, x in row.items() if j in places} for row in kept]

    def squared(self, rank: int) -> list[Row]:
        """Return a square matrix that is singular nowhere in the ball if no minor of this order has a root.

        It is the matrix itself where it is square and of full rank.
        """
        size, outputs = len(self.upper), len(self.lower)
        rows: Sequence[Mapping[int, acb]] = [*self.upper, *self.lower]
        if rank < outputs:
            rows = _rows(self.upper, self.lower, _weights(size + rank, outputs, 3), rank)
        if rank < self.inputs:
            return _columns(rows, size, _weights(self.inputs, size + rank, 4), rank)
        return [dict(row) for row in rows]


def _weights(rows: int, columns: int, draw: int) -> Weights:
    """Return numbers of combinations, the same in every run."""
    random = Random(draw)
    return [[random.randint(1, LARGEST_WEIGHT) for _ in range(columns)] for _ in range(rows)]


def _rows(
    upper: Sequence[Mapping[int, acb]], lower: Sequence[Mapping[int, acb]], weights: Weights, rank: int
) -> list[Row]:
    """Return the upper rows, and so many empty ones, each with lower rows added to it."""
    rows: list[Row] = [*(dict(row) for row in upper), *({} for _ in range(rank))]
    for row, by in zip(rows, weights, strict=True):
        for weight, read in zip(by, lower, strict=True):
            for j, x in read.items():
                row[j] = row.get(j, ZERO) + weight * x
    return rows


def _columns(rows: Sequence[Mapping[int, acb]], size: int, weights: Weights, rank: int) -> list[Row]:
    """Return rows of the first columns, and so many empty ones, each with the last columns added to it."""
    found = []
    for row in rows:
        kept = {j: x for j, x in row.items() if j < size}
        for j, x in row.items():
            for k, weight in enumerate(weights[j - size] if j >= size else ()):
                kept[k] = kept.get(k, ZERO) + weight * x
        found.append(kept)
    return found


def independent(
    rows: int, columns: int, is_regular: Callable[[Sequence[int], Sequence[int]], bool]
) -> list[tuple[int, int]]:
    """Return places of a square matrix as large as possible that is regular; nothing if there is none.

    >>> independent(2, 2, lambda rows, columns: len(rows) == 1 and rows[0] != columns[0])
    [(0, 1)]
    """
    places = (
        list(zip(some, others, strict=True))
        for rank in range(min(rows, columns), 0, -1)
        for some in combinations(range(rows), rank)
        for others in combinations(range(columns), rank)
        if is_regular(some, others)
    )
    return next(places, [])


def is_regular(rows: Sequence[Mapping[int, acb]]) -> bool:
    """Tell whether a square matrix is proved to be singular nowhere in its balls."""
    return null_vectors(rows, 0) is not None


def null_vectors(rows: Sequence[Mapping[int, acb]], most: int = MOST_FREE) -> list[list[acb]] | None:
    """Return balls about vectors that a square matrix takes to zero, as many as it may have where singular.

    Bordered by as many rows and columns at random, the matrix is regular; the vectors have given products
    with these rows. ``None`` if more than ``most`` are needed. A single one is a null vector of every
    singular matrix in the balls.

    >>> [vector] = null_vectors([{0: acb(1), 1: acb(2)}, {0: acb(2), 1: acb(4)}])
    >>> bool((vector[0] / vector[1]).overlaps(acb(-2)))
    True
    """
    size = len(rows)
    for number in range(most + 1):
        down, across = _weights(size, number, 5), _weights(number, size, 6)
        border = [
            {**{j: acb(w) for j, w in enumerate(by)}, size + number + k: -ONE} for k, by in enumerate(across)
        ]
        inner = [
            {**row, **{size + k: acb(w) for k, w in enumerate(by)}}
            for row, by in zip(rows, down, strict=True)
        ]
        try:
            solved = eliminate([*inner, *border], size + number)
            if not solved.determinant.contains(0):
                return [solved.unknowns(size + number + k)[:size] for k in range(number)]
        except UndecidedError:
            continue
    return None


def null_vector(rows: Sequence[Mapping[int, acb]]) -> list[acb] | None:
    """Return balls about the vector that every singular matrix in the balls takes to zero; None if not found.

    >>> vector = null_vector([{0: acb(1), 1: acb(2)}, {0: acb(2), 1: acb(4)}])
    >>> bool((vector[0] / vector[1]).overlaps(acb(-2)))
    True
    """
    size = len(rows)
    if size <= MOST_DENSE and sum(map(len, rows)) > FULL * size**2:
        down, (across,) = _weights(size, 1, 5), _weights(1, size, 6)
        entries = [
            [*(row.get(j, ZERO) for j in range(size)), acb(w)] for row, (w,) in zip(rows, down, strict=True)
        ]
        bordered = acb_mat([*entries, [*map(acb, across), ZERO]])
        try:
            return bordered.solve(acb_mat([*[[0]] * size, [1]])).entries()[:size]
        except ZeroDivisionError:
            pass  # more careful pivots may still tell them apart
    vectors = null_vectors(rows, 1)
    return vectors[0] if vectors else None


# ------------------------------------------------------------------------------------------ modulo a prime


@dataclass(frozen=True, slots=True)
class ByPart(Generic[Value]):
    """What is known of each part: a polynomial whose roots are where it loses rank, or an order of a root."""

    modes: Value  # of A
    input_decoupling: Value  # of [A B]
    output_decoupling: Value  # of [A; C]
    hidden: Value  # of all minors that contain A: what no feedback moves
    system: Value  # of those of the largest order: hidden modes and transmission zeros
    invariant: Value  # of all minors of the largest order

    @property
    def each(self) -> tuple[Value, ...]:
        """All of them, in order."""
        return (
            self.modes,
            self.input_decoupling,
            self.output_decoupling,
            self.hidden,
            self.system,
            self.invariant,
        )

    def orders(self: ByPart[nmod_poly], factor: nmod_poly) -> ByPart[int]:
        """Return how often a polynomial divides each."""
        return ByPart(*(_order(divisor, factor) for divisor in self.each))


def _order(value: nmod_poly, factor: nmod_poly) -> int:
    order = 0
    while value.degree() >= factor.degree() and (value % factor).degree() < 0:
        value, order = value // factor, order + 1
    return order


@dataclass(frozen=True, slots=True, eq=False)
class PrimeValues:
    """The system matrix at a number s, with ``G = D - C A^-1 B``."""

    det: int  # of A
    to_unknowns: nmod_mat  # A^-1 B
    from_rows: nmod_mat  # C A^-1
    transfer: nmod_mat
    whole: nmod_mat


@dataclass(frozen=True, eq=False)
class PrimeSystem:
    """The system matrix modulo a prime, constants at a random point."""

    matrix: SystemMatrix
    prime: int
    point: Mapping[str, int]

    @property
    def rank(self) -> int:
        """The normal rank of the transfer matrix."""
        return len(self.independent)

    @cached_property
    def independent(self) -> list[tuple[int, int]]:
        """As many outputs and inputs, by their numbers, as the normal rank, with a matrix of that rank."""
        rows = next(self._values())[1].transfer.tolist()

        def is_independent(some: Sequence[int], others: Sequence[int]) -> bool:
            return bool(int(nmod_mat([[int(rows[i][j]) for j in others] for i in some], self.prime).det()))

        return independent(len(self.matrix.lower), self.matrix.inputs, is_independent)

    def image(self, polynomial: fmpz_mpoly, ring: Ring) -> nmod_poly:
        """Return what a polynomial in s and constants is."""
        parts = (Factored.polynomial(ring, c) for c in ring.coefficients(polynomial))
        return nmod_poly([residue(c, self.point, self.prime) for c in parts], self.prime)

    @cached_property
    def divisors(self) -> ByPart[nmod_poly] | None:
        """The polynomials; ``None`` where determinants are none, as beside waves."""
        n, p, m = len(self.matrix.upper), len(self.matrix.lower), self.matrix.inputs
        r, one = self.rank, self._one
        parts: list[Callable[[PrimeValues, Draw], int]] = [
            lambda at, _: at.det,
            lambda at, w: at.det * int((one(m) + w(m, n) * at.to_unknowns).det()),
            lambda at, w: at.det * int((one(p) + at.from_rows * w(n, p)).det()),
            lambda at, w: at.det * int((w(m, p) * at.transfer - one(m)).det()),
            lambda at, w: at.det * int((w(r, p) * at.transfer * w(m, r)).det()),
            lambda at, w: int((w(n + r, n + p) * at.whole * w(n + m, n + r)).det()),
        ]
        found = [self._divisor(part) for part in parts[: 6 if r < max(m, p) else 5]]
        whole = [divisor for divisor in found if divisor is not None]
        return ByPart(*whole, *whole[len(found) - 1 : 5]) if len(whole) == len(found) else None

    def _divisor(self, part: Callable[[PrimeValues, Draw], int]) -> nmod_poly | None:
        """Return the greatest common divisor of a few determinants; ``None`` if one is no polynomial."""
        divisor = nmod_poly([], self.prime)
        for draw in range(DRAWS):
            polynomial = self._polynomial(partial(self._part_at, part, draw))
            if polynomial is None:
                return None
            divisor = divisor.gcd(polynomial)
        return divisor

    def _part_at(self, part: Callable[[PrimeValues, Draw], int], draw: int, at: PrimeValues) -> int:
        return part(at, self._drawn(draw))

    def _one(self, size: int) -> nmod_mat:
        return nmod_mat(size, size, [int(i == j) for i in range(size) for j in range(size)], self.prime)

    def _drawn(self, draw: int) -> Draw:
        """Return what makes matrices of random numbers, the same in every run and at every s."""
        places = count()

        def matrix(rows: int, columns: int) -> nmod_mat:
            key = (draw, next(places), rows, columns)
            if key not in self._draws:
                random = Random(repr(key))
                numbers = [random.randrange(self.prime) for _ in range(rows * columns)]
                self._draws[key] = nmod_mat(rows, columns, numbers, self.prime)
            return self._draws[key]

        return matrix

    @cached_property
    def _draws(self) -> dict[tuple[int, int, int, int], nmod_mat]:
        return {}

    def _polynomial(self, value: Callable[[PrimeValues], int]) -> nmod_poly | None:
        """Return the polynomial in s that has these values."""
        size = FIRST_POINTS
        while size <= MOST_DEGREE:
            while len(self._known) < size + CHECKS:
                self._known.append(next(self._samples))
            known = [(s, value(at) % self.prime) for s, at in self._known[: size + CHECKS]]
            polynomial = interpolated(known[:size], self.prime)
            if all(int(polynomial(s)) == x for s, x in known[size:]):
                return polynomial
            size *= 2
        return None

    @cached_property
    def _known(self) -> list[tuple[int, PrimeValues]]:
        return []

    @cached_property
    def _samples(self) -> Iterator[tuple[int, PrimeValues]]:
        return self._values()

    def _values(self) -> Iterator[tuple[int, PrimeValues]]:
        """Yield the matrix at one s after the other, but for those at which A is singular."""
        size, prime = len(self.matrix.upper), self.prime
        width = size + self.matrix.inputs
        for s in count(self.point[LAPLACE]):
            spend()
            point = {**self.point, LAPLACE: s}
            try:
                for name, value in self.matrix.numeric.equations.definitions:
                    point[name] = residue(value, point, prime)
                whole = []
                for row in (*self.matrix.upper, *self.matrix.lower):
                    values = {j: residue(c, point, prime) for j, c in row.items()}
                    whole.append([values.get(j, 0) for j in range(width)])
            except ZeroDivisionError:
                continue
            # With shapes, which a list without rows has not: a model may have no unknowns.
            a, b, c, d = (
                nmod_mat(len(part), columns, [x for row in part for x in row[left]], prime)
                for part, (columns, left) in product(
                    (whole[:size], whole[size:]),
                    ((size, slice(size)), (width - size, slice(size, None))),
                )
            )
            det = int(a.det())
            if not det:
                continue
            to_unknowns, from_rows = a.solve(b), a.transpose().solve(c.transpose()).transpose()
            yield s, PrimeValues(det, to_unknowns, from_rows, d - c * to_unknowns, nmod_mat(whole, prime))


def interpolated(values: Sequence[tuple[int, int]], prime: int) -> nmod_poly:
    """Return the polynomial of least degree with these values at these points (Newton).

    >>> [int(c) for c in interpolated([(1, 2), (2, 5), (3, 10)], 101).coeffs()]
    [1, 0, 1]
    """
    points = [s for s, _ in values]
    differences = [x for _, x in values]
    for k in range(1, len(points)):
        for i in range(len(points) - 1, k - 1, -1):
            step = pow(points[i] - points[i - k], -1, prime)
            differences[i] = (differences[i] - differences[i - 1]) * step % prime
    total = nmod_poly([], prime)
    for s, difference in zip(reversed(points), reversed(differences), strict=True):
        total = total * nmod_poly([-s, 1], prime) + nmod_poly([difference], prime)
    return total
