"""Which parameters a transfer function can tell apart, and which only together.

Input: transfer functions whose unknown parameters are symbols and whose others are numbers.
Output: an :class:`Identifiability`: the rank of what data without noise determine, the parameters that follow
alone, the combinations that stand for the others, and which sets of them you could fix.

Parameters are distinguished locally where no direction in their space leaves the function as it is (Bellman &
Astrom 1970; Rothenberg 1971). A direction is taken in logarithms, ``v . d/d log p``. For a rational function
it leaves the coefficients proportional:

    k/(m s^2 + k)    coefficients k, m, k; with (dk, dm)/(k, m) = (1, 1) they only grow together:
                     rank 1 of 2, k/m is determined

The rank of the coefficients' derivatives is that of integers at random points: exact, and wrong only if the
point happens to lie on a surface of lower rank. Functions with kernels are evaluated in balls of
:data:`BITS` bits, on the axis, at two points in the space of parameters. A direction that is the same
rational vector at every point scales parameters; then products of powers are what stays, and the shortest are
named.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, product

import numpy as np
import numpy.typing as npt
from flint import acb, arb, fmpq, fmpq_mat, fmpz_mpoly

from symflex.algebra import LAPLACE
from symflex.algebra.ring import by_powers
from symflex.balls import precision
from symflex.model import ExactValue
from symflex.transfer import AnyTransferFunction, TransferFunction
from symflex.transfer.nested_form import bind_any

Real = npt.NDArray[np.float64]

BITS = 400  # of values of functions with kernels
STEP = Fraction(1, 10**45)  # relative change of a parameter that derivatives of those are taken over
DEPENDENT = 1e-30  # size of a pivot, over the largest entry, below which a column depends on the others
LARGEST = 10**6  # random integers at which ranks of coefficients are taken go up to this
FRACTIONS = 12  # largest denominator of a direction's components, over its largest one
MOST_POWER, MOST_SCALED = 4, 6  # exponents of combinations that are tried, of so many parameters
POINTS = 2  # points in the space of parameters that have to agree


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Coefficients of numerator and denominator of a rational function, as polynomials in parameters."""

    names: tuple[str, ...]
    powers: tuple[tuple[bool, int], ...]  # of each whether it is of the denominator, and its power of s
    polynomials: tuple[fmpz_mpoly, ...]
    terms: tuple[tuple[Real, npt.NDArray[np.int64]], ...]  # of each numbers, and exponents of the parameters

    @staticmethod
    def of(tf: AnyTransferFunction, names: Sequence[str]) -> Coefficients | None:
        """Return those of a function; None if it is not a quotient of polynomials in s and parameters."""
        if not isinstance(tf, TransferFunction) or not tf.is_rational or tf.is_large or tf.model.root:
            return None
        ring, sides = tf.ratio.ring, (tf.ratio.numerator(), tf.ratio.denominator())
        expanded = [side.expand() for side in sides]
        above, below = sides[0].unit.denominator, sides[1].unit.denominator
        if above != 1 or below != 1 or not ring.used_in(expanded) <= {LAPLACE, "pi", *names}:
            return None
        powers, polynomials, terms = [], [], []
        columns = [ring.index[name] if name in ring.index else -1 for name in names]
        pi = ring.index.get("pi", -1)
        for is_below, side in enumerate(expanded):
            for power, polynomial in by_powers(ring, side).items():
                numbers, exponents = [], []
                for monomial, number in polynomial.to_dict().items():
                    of_pi = np.pi ** int(monomial[pi]) if pi >= 0 else 1.0
                    numbers.append(float(int(number)) * of_pi)
                    exponents.append([int(monomial[i]) if i >= 0 else 0 for i in columns])
                powers.append((bool(is_below), power))
                polynomials.append(polynomial)
                terms.append((np.array(numbers), np.array(exponents, np.int64)))
        return Coefficients(tuple(names), tuple(powers), tuple(polynomials), tuple(terms))

    @cached_property
    def _stacked(self) -> tuple[Real, npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Numbers and exponents of all terms, and where those of each coefficient begin."""
        sizes = [numbers.size for numbers, _ in self.terms]
        numbers = np.concatenate([numbers for numbers, _ in self.terms])
        exponents = np.concatenate([exponents for _, exponents in self.terms])
        return numbers, exponents, np.cumsum([0, *sizes[:-1]])

    def at(self, values: Real) -> tuple[Real, Real]:
        """Return the coefficients at values of the parameters, and their derivatives, shape (m, p)."""
        numbers, exponents, starts = self._stacked
        slopes = []
        for j, unit in enumerate(np.eye(values.size, dtype=np.int64)):
            lower = np.maximum(exponents - unit, 0)
            parts = numbers * exponents[:, j] * np.prod(values**lower, axis=1)
            slopes.append(np.add.reduceat(parts, starts))
        return np.add.reduceat(numbers * np.prod(values**exponents, axis=1), starts), np.stack(slopes, axis=1)

    def directions(self, point: Mapping[str, int]) -> list[list[fmpq]]:
        """Return rows of coefficients' derivatives in log p, then of the coefficients, at integers."""
        context = self.polynomials[0].context()
        names = context.names()
        images = [point.get(name, 1) for name in names]
        places = [names.index(name) if name in names else -1 for name in self.names]

        def value(polynomial: fmpz_mpoly) -> int:
            return int(polynomial(*images))

        return [
            [fmpq(value(p.derivative(i)) * images[i]) if i >= 0 else fmpq(0) for i in places]
            + [fmpq(value(p))]
            for p in self.polynomials
        ]

    def quotients(self) -> Iterator[tuple[str, int, int]]:
        """Yield the quotients of two coefficients that depend on parameters: text and both numbers."""
        for i, above in enumerate(self.polynomials):
            for j, below in enumerate(self.polynomials):
                if i != j and (text := _quotient_text(above, below)) is not None:
                    yield text, i, j


def _quotient_text(above: fmpz_mpoly, below: fmpz_mpoly) -> str | None:
    """Return a quotient of polynomials in lowest terms; None for a number."""
    common = above.gcd(below)
    above, below = above / common, below / common
    if above.is_constant() and below.is_constant():
        return None
    if below.leading_coefficient() < 0:
        above, below = -above, -below
    top, bottom = str(above), str(below)
    if below.is_one():
        return top
    top = f"({top})" if len(above.to_dict()) > 1 else top
    return f"{top}/({bottom})" if "*" in bottom or len(below.to_dict()) > 1 else f"{top}/{bottom}"


@dataclass(frozen=True, slots=True)
class CoefficientQuotient:
    """A quotient of two coefficients of one function."""

    text: str
    function: int
    above: int  # above and below: their numbers
    below: int


@dataclass(frozen=True, eq=False)
class Identifiability:
    """What data without noise determine of some parameters."""

    names: tuple[str, ...]
    rank: int  # how many numbers they determine
    alone: tuple[str, ...]  # the parameters that are determined
    # Products of powers of the others that are, by exponents; empty where no scaling mixes them up.
    combinations: tuple[tuple[int, ...], ...] = ()
    # Quotients of coefficients that are, where no products of powers stand for all.
    expressions: tuple[CoefficientQuotient, ...] = ()
    fixes: tuple[tuple[str, ...], ...] = ()  # sets of the others each of which would determine all, if known
    is_exact: bool = True  # by integer arithmetic; else in balls

    @property
    def mixed(self) -> tuple[str, ...]:
        """The parameters that are not determined."""
        return tuple(name for name in self.names if name not in self.alone)

    @property
    def is_complete(self) -> bool:
        """Whether all parameters are determined."""
        return self.rank == len(self.names)

    def text(self, exponents: Sequence[int]) -> str:
        """Return a product of powers.

        >>> Identifiability(("B", "l", "M"), 1, ()).text((1, 2, -1))
        'B*l^2/M'
        """
        powers = list(zip(self.names, exponents, strict=True))

        def factors(sign: int) -> list[str]:
            return [n if sign * e == 1 else f"{n}^{sign * e}" for n, e in powers if sign * e > 0]

        above, below = factors(1), factors(-1)
        bottom = f"({'*'.join(below)})" if len(below) > 1 else "".join(below)
        return ("*".join(above) or "1") + (f"/{bottom}" if below else "")


def identify(
    functions: Sequence[AnyTransferFunction],
    coefficients: Sequence[Coefficients | None],
    names: Sequence[str],
    values: Mapping[str, ExactValue],
    omega: tuple[float, float],
    known: Sequence[str] = (),
) -> Identifiability:
    """Return what responses of these functions determine of the named parameters.

    ``values`` are those of all parameters, ``omega`` the ends of the band [rad/s]; of ``known`` ones
    something is known besides.
    """
    exact = [c for c in coefficients if c is not None]
    is_exact = len(exact) == len(functions)
    source = random.Random(1)
    bases: list[list[list[Fraction | float]]] = []
    for _ in range(POINTS):
        if is_exact:
            point = {name: source.randrange(2, LARGEST) for name in (*names, "pi")}
            bases.append(_exact_null_space(exact, point, names, known))
        else:
            scale = {name: Fraction(source.randrange(700, 1400), 1000) for name in names}
            moved = {n: ExactValue(values[n].rational * scale[n], values[n].pi_power) for n in names}
            bases.append(_null_space_in_balls(functions, {**values, **moved}, names, omega, known))
    least = min(len(basis) for basis in bases)
    bases = [basis for basis in bases if len(basis) == least]
    size = len(names)
    if not least:
        return Identifiability(tuple(names), size, tuple(names), is_exact=is_exact)
    arrays = [np.array([[float(x) for x in v] for v in basis]) for basis in bases]
    touched = np.max([np.max(np.abs(a), axis=0) for a in arrays], axis=0) > 1e-12  # noqa: PLR2004
    others = [i for i in range(size) if touched[i]]
    fixes = tuple(
        tuple(names[i] for i in chosen)
        for chosen in combinations(others, least)
        if all(np.linalg.matrix_rank(a[:, chosen], tol=1e-9) == least for a in arrays)
    )
    same = all(np.linalg.matrix_rank(np.vstack((arrays[0], a)), tol=1e-9) == least for a in arrays)
    powers = _invariants(arrays[0], others, size - least) if same else ()
    alone = tuple(name for i, name in enumerate(names) if not touched[i])
    said = _independent_quotients(exact, names, alone, size - least) if is_exact and not powers else ()
    return Identifiability(tuple(names), size - least, alone, powers, said, fixes, is_exact)


def _independent_quotients(
    exact: Sequence[Coefficients], names: Sequence[str], alone: Sequence[str], rank: int
) -> tuple[CoefficientQuotient, ...]:
    """Return as many of the shortest quotients of coefficients as stand for the parameters not alone."""
    source = random.Random(2)
    values = np.array([source.uniform(0.5, 2.0) for _ in names])
    every = [
        CoefficientQuotient(*(text, r, i, j)) for r, c in enumerate(exact) for text, i, j in c.quotients()
    ]
    rows = [np.eye(len(names))[list(names).index(name)] for name in alone]
    chosen: list[CoefficientQuotient] = []
    for one in sorted(every, key=lambda q: (len(q.text), q.text)):
        if len(rows) == rank:
            break
        numbers, slopes = exact[one.function].at(values)
        row = values * (slopes[one.above] / numbers[one.above] - slopes[one.below] / numbers[one.below])
        if np.linalg.matrix_rank(np.array([*rows, row]), tol=1e-9) > len(rows):
            rows.append(row)
            chosen.append(one)
    return tuple(chosen)


def _exact_null_space(
    exact: Sequence[Coefficients], point: Mapping[str, int], names: Sequence[str], known: Sequence[str]
) -> list[list[Fraction | float]]:
    """Return directions in log p that leave all functions as they are, at integers."""
    size, rows = len(names), []
    for r, one in enumerate(exact):
        for row in one.directions(point):
            ends = [fmpq(0)] * len(exact)
            ends[r] = row[-1]
            rows.append([*row[:-1], *ends])
    rows += [[fmpq(int(i == j)) for j in range(size + len(exact))] for i, n in enumerate(names) if n in known]
    reduced, rank = fmpq_mat(rows).rref()
    table = [[reduced[i, j] for j in range(size + len(exact))] for i in range(rank)]
    basis = _null_vectors(table)
    return [[Fraction(int(x.p), int(x.q)) for x in vector[:size]] for vector in basis]


def _null_vectors(reduced: list[list[fmpq]]) -> list[list[fmpq]]:
    """Return a basis of the null space of rows in reduced echelon form."""
    columns = len(reduced[0])
    pivots = [next(j for j, x in enumerate(row) if x != 0) for row in reduced]
    basis = []
    for free in (j for j in range(columns) if j not in pivots):
        vector = [fmpq(0)] * columns
        vector[free] = fmpq(1)
        for row, pivot in zip(reduced, pivots, strict=True):
            vector[pivot] = -row[free]
        basis.append(vector)
    return basis


def _null_space_in_balls(
    functions: Sequence[AnyTransferFunction],
    values: Mapping[str, ExactValue],
    names: Sequence[str],
    omega: tuple[float, float],
    known: Sequence[str],
) -> list[list[Fraction | float]]:
    """Return directions in log p that change no function by more than rounding, at some values."""
    frequencies = np.geomspace(*omega, 2 * len(names) + 3).tolist()
    with precision(BITS):
        points = [
            acb(0, Fraction(f).limit_denominator(10**9).numerator)
            / Fraction(f).limit_denominator(10**9).denominator
            for f in frequencies
        ]

    def responses(changed: Mapping[str, ExactValue]) -> list[acb]:
        found = []
        for tf in functions:
            own = {p.name for p in tf.model.parameters}
            given = {n: v for n, v in changed.items() if n in own and n in names}
            enclosed = bind_any(tf, given).enclosed(BITS)
            found += [enclosed(s) for s in points]
        return found

    before = responses(values)
    rows: list[list[arb]] = []
    columns: list[list[arb]] = []
    with precision(BITS):
        for name in names:
            moved = ExactValue(values[name].rational * (1 + STEP), values[name].pi_power)
            after = responses({**values, name: moved})
            pairs = zip(before, after, strict=True)
            slopes = [(b / a - 1) * STEP.denominator for a, b in pairs]
            columns.append([part.mid() for x in slopes for part in (x.real, x.imag)])
        rows = [list(row) for row in zip(*columns, strict=True)]
        rows += [[arb(int(m == n)) for m in names] for n in known]
        return _numeric_null_space(rows)


def _numeric_null_space(rows: list[list[arb]]) -> list[list[Fraction | float]]:
    """Return the null space of rows by elimination with full pivoting, rational where it is."""
    size = len(rows[0])
    order = list(range(size))
    largest = max(float(abs(x)) for row in rows for x in row) or 1.0
    rank = 0
    while rank < min(size, len(rows)):
        candidates = [
            (float(abs(rows[i][j])), i, j) for i in range(rank, len(rows)) for j in range(rank, size)
        ]
        best, i, j = max(candidates)
        if best < DEPENDENT * largest:
            break
        rows[rank], rows[i] = rows[i], rows[rank]
        for row in rows:
            row[rank], row[j] = row[j], row[rank]
        order[rank], order[j] = order[j], order[rank]
        pivot = [x / rows[rank][rank] for x in rows[rank]]
        rows[rank] = pivot
        for k, row in enumerate(rows):
            if k != rank:
                factor = row[rank]
                rows[k] = [(x - factor * y).mid() for x, y in zip(row, pivot, strict=True)]
        rank += 1
    basis: list[list[Fraction | float]] = []
    for free in range(rank, size):
        vector: list[Fraction | float] = [Fraction(0)] * size
        vector[order[free]] = Fraction(1)
        for k in range(rank):
            vector[order[k]] = _rational(-float(rows[k][free]))
        basis.append(vector)
    return basis


def _rational(value: float) -> Fraction | float:
    near = Fraction(value).limit_denominator(FRACTIONS)
    return near if abs(float(near) - value) < 1e-12 else value  # noqa: PLR2004


def _invariants(space: Real, others: Sequence[int], rank: int) -> tuple[tuple[int, ...], ...]:
    """Return the shortest products of powers of the ``others`` that the directions of a space leave."""
    size = space.shape[1]
    wanted = rank - (size - len(others))
    if wanted <= 0 or len(others) > MOST_SCALED:
        return ()
    chosen: list[list[int]] = []
    exponents = np.array(list(product(range(-MOST_POWER, MOST_POWER + 1), repeat=len(others))))
    is_left = np.max(np.abs(space[:, list(others)] @ exponents.T), axis=0) < 1e-9  # noqa: PLR2004

    def length(powers: Sequence[int]) -> tuple[object, ...]:
        return sum(map(abs, powers)), sum(x != 0 for x in powers), [-x for x in powers]

    for powers in sorted(exponents[is_left].tolist(), key=length):
        if next((x for x in powers if x), 0) <= 0:
            continue
        vector = np.zeros(size)
        vector[list(others)] = powers
        if np.linalg.matrix_rank(np.array([*chosen, vector])) > len(chosen):
            chosen.append([int(x) for x in vector])
        if len(chosen) == wanted:
            return tuple(tuple(row) for row in chosen)
    return ()
