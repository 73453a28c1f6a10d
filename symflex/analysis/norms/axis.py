"""A matrix of transfer functions less a rational one, on pieces of the imaginary axis.

Input: functions in discs (:class:`Expanded`), and the fractions and constants of a rational matrix. Output:
on a piece of the axis a :class:`TaylorForm`, powers of the distance t from its middle and what they lack.

Example: on [1, 3] about 2, ``1/(s + 1)`` is ``1/(1 + 2j) - j t/(1 + 2j)^2 + ...``, the last coefficient with
all its values on the piece (Makino and Berz 2003).

In the discs fractions at the same pole are added before they are evaluated; beyond, functions are enclosed
on balls of s, and their values on circles make the powers.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import inf, pi

from flint import acb, acb_mat, acb_poly, arb

from symflex.analysis.norms.expanded import BITS, Expanded
from symflex.balls import Part, ball, precision
from symflex.budget import spend
from symflex.loops.axis import pieces
from symflex.roots.distributed.far_out import FunctionFarOut
from symflex.roots.root import Root, overlap

RATIO = 1.12  # of the ends of first pieces
MOST_PIECES = 20_000  # of the axis
NARROWEST = 1e-12  # relative width of a piece that is not halved any more
ORDER = 6  # powers of a form in a disc
CIRCLE_POINTS = 14  # values that make the powers of a form beyond, and their number
REACHES = (8, 2)  # radii of the discs about a piece beyond that are tried, over half the piece
AGREEING = 1e-9  # relative distance of a pole and its rounded value, at most
CIRCLE = 0.25  # radius of the circle with the values, over that of the disc


@dataclass(frozen=True, slots=True)
class ModalTerm:
    """A matrix over a power of ``s - p``."""

    pole: acb
    power: int
    weights: dict[tuple[int, int], acb]  # by output and input; others are 0

    def negative(self) -> ModalTerm:
        """Return the same with the other sign."""
        return ModalTerm(self.pole, self.power, {at: -c for at, c in self.weights.items()})


def _agree(one: acb, other: acb) -> bool:
    """Tell whether two poles are the same but for rounding."""
    return bool(abs(one - other) <= AGREEING * abs(one))


def norm(matrix: acb_mat) -> arb:
    """Return the Frobenius norm of a matrix, at most."""
    return sum((x.abs_upper() ** 2 for x in matrix.entries()), arb(0)).sqrt().upper()


@dataclass(frozen=True, slots=True)
class TaylorForm:
    """A matrix of functions of the frequency on a piece of the axis."""

    powers: tuple[acb_mat, ...]  # of the distance from the middle; the last on all of the piece
    off: arb  # Frobenius norm of what they lack at most
    in_middle: arb = field(default_factory=arb)  # the same in the middle

    def times(self, other: TaylorForm, half: arb) -> TaylorForm:
        """Return the product with a form of one entry on the same piece, of this half width."""
        factors = [m[0, 0] for m in other.powers]
        total: list[acb_mat] = []
        for n in range(len(self.powers) + len(factors) - 1):
            first = max(0, n - len(factors) + 1)
            parts = [m * factors[n - i] for i, m in enumerate(self.powers) if first <= i <= n]
            total.append(sum(parts[1:], parts[0]))
        own, others = (f.size(half) for f in (self, other))
        off = own * other.off + others * self.off + self.off * other.off
        return TaylorForm(tuple(total), off.upper(), off.upper())

    def size(self, half: arb) -> arb:
        """Return the most that the Frobenius norm of the powers is within ``half``."""
        return sum((norm(m) * half**k for k, m in enumerate(self.powers)), arb(0)).upper()

    @property
    def is_finite(self) -> bool:
        """Whether anything is known."""
        return self.off.is_finite() and all(x.is_finite() for m in self.powers for x in m.entries())


@dataclass(frozen=True, eq=False)
class MatrixOnAxis:
    """``G - R`` on the imaginary axis: G by functions, R by modal terms and a constant."""

    functions: tuple[tuple[Expanded, ...], ...]  # of G, by output and input
    terms: tuple[ModalTerm, ...] = ()  # of R
    constant: tuple[tuple[arb, ...], ...] = ()  # of R
    delays: tuple[tuple[arb, ...], ...] = ()  # [s] that turn an entry against the others

    @property
    def shape(self) -> tuple[int, int]:
        """How many outputs and inputs."""
        return len(self.functions), len(self.functions[0])

    @property
    def every(self) -> list[Expanded]:
        """All functions."""
        return [function for row in self.functions for function in row]

    def entry(self, i: int, j: int) -> MatrixOnAxis:
        """Return the matrix of one pair alone."""
        terms = [
            ModalTerm(t.pole, t.power, {(0, 0): t.weights[i, j]}) for t in self.terms if (i, j) in t.weights
        ]
        constant = ((self.constant[i][j],),) if self.constant else ()
        return MatrixOnAxis(((self.functions[i][j],),), tuple(terms), constant)

    @property
    def used(self) -> float:
        """Frequency [rad/s] up to which all functions are known by their series."""
        return min(function.used for function in self.every)

    def in_discs(self, low: float, high: float) -> tuple[list[Part], float, list[float]]:
        """Return first pieces [rad/s] on which series are used, where they end, and sizes of poles.

        Pieces begin at ``low``; below the lowest pole's size they are one. Functions without waves and delays
        are known by series everywhere: their pieces end at twice the size of the largest pole.
        """
        sizes = sorted({size for t in self.fractions if (size := float(abs(t.pole).mid())) > 0})
        edge = min(self.used, high)
        if edge == inf:
            edge = 2 * sizes[-1] if sizes else 1.0
        bottom = low or min([edge, *sizes]) / 100
        below: list[Part] = [(0.0, bottom)] if low < bottom else []
        return [*below, *pieces(bottom, edge, RATIO)], edge, sizes

    @property
    def reasons(self) -> tuple[str, ...]:
        """What is not proved of the functions."""
        return tuple(dict.fromkeys(reason for function in self.every for reason in function.reasons))

    @cached_property
    def fractions(self) -> tuple[ModalTerm, ...]:
        """The fractions of ``G - R``, those at one pole together.

        With p and q in a ball P, ``c/(s - p) - d/(s - q)`` is ``(c - d)/(s - p)`` and a part of
        ``d (p - q)/(s - P)^2``, without the cancellation of both. Poles on the axis that R keeps count as
        those of G, from which only rounding makes them differ.
        """
        with precision(BITS):
            found: list[ModalTerm] = []
            others = [*self.terms]
            for term in self._exact_fractions:
                alike = [t for t in others if t.power == term.power and _agree(t.pole, term.pole)]
                if not alike:
                    found.append(term)
                    continue
                others = [t for t in others if not any(t is each for each in alike)]
                kept = ModalTerm(alike[0].pole, term.power, {})
                for each in alike:  # a residue of rank two has two
                    for at, c in each.weights.items():
                        kept.weights[at] = kept.weights.get(at, acb(0)) + c
                if kept.pole.real == 0:
                    continue
                if term.power > 1:
                    found += [term, kept.negative()]
                    continue
                both = term.weights.keys() | kept.weights.keys()
                zero, off = acb(0), term.pole - kept.pole
                less = {k: term.weights.get(k, zero) - kept.weights.get(k, zero) for k in both}
                moved = {k: c * off for k, c in kept.weights.items()}
                found += [ModalTerm(term.pole, 1, less), ModalTerm(term.pole.union(kept.pole), 2, moved)]
            found += [term.negative() for term in others]
        return tuple(found)

    @cached_property
    def _exact_fractions(self) -> list[ModalTerm]:
        """The fractions of G."""
        roots: list[tuple[Root, ModalTerm]] = []
        for i, row in enumerate(self.functions):
            for j, function in enumerate(row):
                for part in function.parts:
                    for k, c in enumerate(part.coefficients, 1):
                        alike = (t for root, t in roots if t.power == k and overlap(root, part.root))
                        term = next(alike, None)
                        if term is None:
                            term = ModalTerm(part.pole, k, {})
                            roots.append((part.root, term))
                        term.weights[i, j] = c
        return [term for _, term in roots]

    @cached_property
    def _regular(self) -> list[list[acb_poly]]:
        """What is left of ``G - R`` in the disc, as power series."""
        grid: list[list[acb_poly]] = []
        for i, row in enumerate(self.functions):
            grid.append([])
            for j, function in enumerate(row):
                constant = acb(self.constant[i][j]) if self.constant else acb(0)
                first, *others = function.regular
                grid[-1].append(acb_poly([first - constant, *others]))
        return grid

    @cached_property
    def _missing(self) -> arb:
        """What the series of all functions lack at most, as a Frobenius norm."""
        with precision(BITS):
            return sum((f.missing**2 for f in self.every), arb(0)).sqrt().upper()

    def in_disc(self, low: float, high: float, enough: arb | None = None) -> TaylorForm:
        """Return the form on a piece within :attr:`used`; a ball alone if that is below ``enough``."""
        spend()
        with precision(BITS):
            rows, columns = self.shape
            middle = (arb(low) + arb(high)) / 2
            half = ((arb(high) - arb(low)) / 2).upper()
            wide = self._grid(acb(0, middle + arb(0, half)))
            if enough is not None:
                around = acb_mat(rows, columns, [own[0] for own in wide])
                if norm(around) + self._missing < enough:
                    return TaylorForm((around,), self._missing, arb("inf"))
            sharp = self._grid(acb(0, middle))
            chosen = [sharp] * (ORDER - 1) + [wide]
            powers = [acb_mat(rows, columns, [own[k] for own in grid]) for k, grid in enumerate(chosen)]
            return TaylorForm(tuple(powers), self._missing, self._missing)

    def _grid(self, s: acb) -> list[list[acb]]:
        """Return the first coefficients in t of every entry at ``s + j t``."""
        rows, columns = self.shape
        total = [[acb(0)] * ORDER for _ in range(rows * columns)]
        j = acb(0, 1)
        for term in self.fractions:
            # (a + j t)^-k, term by term
            inverse = 1 / (s - term.pole)
            ratio, value = -j * inverse, inverse
            for _ in range(term.power - 1):
                value = value * inverse  # balls of two poles, which a power would take for one
            for k in range(ORDER):
                for (row, column), c in term.weights.items():
                    own = total[row * columns + column]
                    own[k] = own[k] + c * value
                value = value * ratio * (term.power + k) / (k + 1)
        for n in range(rows * columns):
            regular = self._regular[n // columns][n % columns]
            factor = acb(1)
            for k in range(ORDER):
                if regular.degree() < 0:
                    break
                total[n][k] = total[n][k] + factor * regular(s)
                regular, factor = regular.derivative(), factor * j / (k + 1)
        for own, delay in zip(total, (x for row in self.delays for x in row), strict=False):
            # exp(-delay (s + j t)), term by term
            turn = [(-delay * s).exp()]
            for k in range(1, ORDER):
                turn.append(turn[-1] * -j * delay / k)
            own[:] = [sum((own[i] * turn[k - i] for i in range(k + 1)), acb(0)) for k in range(ORDER)]
        return total

    def value(self, s: acb, *, is_wide: bool = False) -> acb_mat:
        """Return ``G - R`` at a point or on a ball of s, without series."""
        spend()
        rows, columns = self.shape
        with precision(BITS):
            grid = [[f.around(s) if is_wide else f.at(s) for f in row] for row in self.functions]
            if self.constant:
                rows_of = zip(grid, self.constant, strict=True)
                grid = [[x - c for x, c in zip(*pair, strict=True)] for pair in rows_of]
            middle, off = s.mid(), s - s.mid()
            for term in self.terms:
                # By the mean value theorem: fractions of a pair nearly cancel, balls of them do not.
                power = 1 / (middle - term.pole) ** term.power
                slope = -term.power / (s - term.pole) ** (term.power + 1)
                for (i, j), c in term.weights.items():
                    grid[i][j] = grid[i][j] - c * power - c * slope * off
            if self.delays:
                turned = zip(grid, self.delays, strict=True)
                grid = [[x * (-d * s).exp() for x, d in zip(*pair, strict=True)] for pair in turned]
            return acb_mat(rows, columns, [x for row in grid for x in row])

    def beyond_disc(self, low: float, high: float) -> TaylorForm:
        """Return the form on a piece anywhere; not finite where a pole may be near."""
        rows, columns = self.shape
        with precision(BITS):
            middle = (arb(low) + arb(high)) / 2
            half = ((arb(high) - arb(low)) / 2).upper()
            for reach in REACHES:
                radius = half * reach
                box = acb(arb(0, radius), middle + arb(0, radius))
                most = [abs(x).upper() for x in self.value(box, is_wide=True).entries()]
                if all(x.is_finite() for x in most):
                    break
            else:
                return TaylorForm((), arb("inf"))
            inner = radius * arb(CIRCLE)
            step = acb(0, 2) * arb.pi() / CIRCLE_POINTS
            turns = [(step * k).exp() for k in range(CIRCLE_POINTS)]
            values = [self.value(acb(0, middle) + inner * turn).entries() for turn in turns]
            aliased = arb(CIRCLE) ** CIRCLE_POINTS / (1 - arb(CIRCLE) ** CIRCLE_POINTS)
            powers = []
            for k in range(CIRCLE_POINTS):
                turned = (acb(0, 1) / inner) ** k / CIRCLE_POINTS
                entries = []
                for n in range(rows * columns):
                    total = sum((v[n] * turns[-m * k % CIRCLE_POINTS] for m, v in enumerate(values)), acb(0))
                    error = (most[n] * aliased / radius**k).upper()
                    entries.append(total * turned + acb(arb(0, error), arb(0, error)))
                powers.append(acb_mat(rows, columns, entries))
            size = sum((x**2 for x in most), arb(0)).sqrt()
            share = arb(1) / reach
            return TaylorForm(tuple(powers), (size * share**CIRCLE_POINTS / (1 - share)).upper())

    @property
    def _far(self) -> list[tuple[FunctionFarOut | None, Fraction]]:
        """What is known of the functions with waves or delays less their limits, and these."""
        return [function.far_out for function in self.every]

    def limit(self) -> acb_mat:
        """Return minus the constant of R, and the limit of G where that is rational."""
        rows, columns = self.shape
        with precision(BITS):
            limits = [
                function.regular[0] if function.radius == inf else acb(ball(limit))
                for function, (_, limit) in zip(self.every, self._far, strict=True)
            ]
            constants = [c for row in self.constant for c in row] or [arb(0)] * (rows * columns)
            return acb_mat(rows, columns, [x - c for x, c in zip(limits, constants, strict=True)])

    def of_constants(self, values: acb_mat) -> MatrixOnAxis:
        """Return a matrix of constants, turned by the same delays."""
        width = self.shape[1]
        each = [
            replace(f, parts=(), radius=inf, regular=(x,))
            for f, x in zip(self.every, values.entries(), strict=True)
        ]
        functions = tuple(tuple(each[i : i + width]) for i in range(0, len(each), width))
        return MatrixOnAxis(functions, delays=self.delays)

    def turns(self, omega: float) -> float:
        """Return how often delays turn one entry against another up to a frequency."""
        return max((abs(float(x)) for row in self.delays for x in row), default=0.0) * omega / (2 * pi)

    def vanishes(self, omega: float) -> bool:
        """Tell whether all functions with waves or delays tend to 0."""
        with precision(BITS):
            sizes = [
                None if far is None else far.size(omega)
                for function, (far, _) in zip(self.every, self._far, strict=True)
                if function.radius < inf
            ]
            return all(size is not None and size.power < 0 for size in sizes)

    def tail(self, omega: float) -> arb | None:
        """Return the Frobenius norm that ``G - R`` less :meth:`limit` has at most from a frequency on."""
        rows, columns = self.shape
        with precision(BITS):
            total = [arb(0)] * (rows * columns)
            terms = self.fractions if self.used == inf else self.terms
            for term in terms:
                distance = arb(omega) - abs(term.pole)
                if not distance > 0:
                    return None
                for (i, j), c in term.weights.items():
                    total[i * columns + j] += abs(c) / distance**term.power
            for n, (function, (far, _)) in enumerate(zip(self.every, self._far, strict=True)):
                if function.radius == inf:
                    continue
                size = None if far is None else far.size(omega)
                if size is None or size.power > 0:
                    return None
                total[n] += size.most * arb(omega) ** (arb(size.power.numerator) / size.power.denominator)
            return sum((x**2 for x in total), arb(0)).sqrt().upper()

    def tail_power(self, omega: float) -> tuple[arb, float] | None:
        """Return c and p: the Frobenius norm is at most ``c w^p`` from a frequency on; None if not known."""
        powers = [-1.0] if self.terms or self.used == inf else []
        limit = self.limit()
        if not all(x == 0 for x in limit.entries()):
            powers.append(0.0)
        for function, (far, _) in zip(self.every, self._far, strict=True):
            if function.radius < inf:
                size = None if far is None else far.size(omega)
                if size is None:
                    return None
                powers.append(float(size.power))
        tail = self.tail(omega)
        if tail is None:
            return None
        power = max(powers)
        # Every part falls at least as fast as its own power, hence as the slowest one.
        return ((tail + norm(limit)) * arb(omega) ** -arb(power)).upper(), power
