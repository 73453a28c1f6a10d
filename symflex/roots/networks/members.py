"""A uniform undamped member at one frequency: its stiffness, and how many frequencies it has below.

With ``lambda = -s^2 = omega^2`` a member is ``u' = A u + a p``, ``p' = C u - A^T p``: u moves, p is what the
part beyond x exerts on the part before it, a is compliance, and C the stiffness of a foundation less inertia.
Held at both ends it has frequencies of its own, where the dynamic stiffness has poles. Wittrick & Williams
(1971, Quarterly Journal of Mechanics and Applied Mathematics 24) count them: join pieces without any below
lambda, and every negative pivot of the stiffness at a joint is one.

    a beam, beta l = 6: eight pieces of beta l = 0.75 have none; joined in twos and in fours, no pivot is
    negative; joining the halves, one is: the first frequency of a clamped beam, beta l = 4.730, lies below

That a piece of length h has none is proved by its energy. Where u is held at the start, ``u_i^2`` is at most
``h sum_j E_ij^2 a_j`` times P, the integral of ``sum_j a_j p_j^2``, with ``E = exp(|A| h)``. So what inertia
takes, ``-C_ii`` times the integral of ``u_i^2``, is less than P if ``h^2 sum_ij -C_ii E_ij^2 a_j < 1``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import frexp, ldexp, log2

from flint import arb, arb_mat

from symflex.along.growth import balanced
from symflex.balls import UndecidedError
from symflex.balls.inertia import pivots

HALF = 0.5  # what the bound on a piece's energy must stay below; 1 would do, but for rounding in doubles
MOST_HALVINGS = 60
SERIES_TERMS = 40  # terms of exp(abs(A) h), whose norm is at most 1: 1/40! is far below rounding


@dataclass(frozen=True, slots=True)
class Stiffness:
    """``(delivered at the start, at the end) = -K (u at the start, u at the end)``."""

    start: arb_mat  # the four blocks of K; what is missing is the transpose of ``across``
    across: arb_mat
    end: arb_mat
    held: int  # frequencies below, of the member held at both ends

    def turned(self, turn: arb_mat) -> Stiffness:
        """Return the stiffness for motions that ``turn`` takes to the member's axes."""
        back = turn.transpose()
        start, across, end = (back * block * turn for block in (self.start, self.across, self.end))
        return Stiffness(start, across, end, self.held)

    @property
    def blocks(self) -> tuple[list[list[arb]], ...]:
        """The blocks at the start, across and at the end, row by row."""
        return self.start.tolist(), self.across.tolist(), self.end.tolist()


@dataclass(frozen=True, eq=False)
class MemberBalls:
    """A member with numbers, at one precision."""

    constant: Sequence[Sequence[arb]]  # dz/dx = (constant + lambda*linear) z, z = (u, p), row by row
    linear: Sequence[Sequence[arb]]
    length: arb
    _pieces: dict[int, tuple[int, tuple[int, ...]]] = field(default_factory=dict, repr=False)

    def stiffness(self, value: arb) -> Stiffness:
        """Return the stiffness at a real ``lambda`` [rad^2/s^2]; UndecidedError next to its frequency."""
        halvings, weights = self.cut(float(abs(value).upper()))
        n = len(self.constant)
        k = n // 2
        piece = ldexp(1.0, -halvings) * self.length
        scaled = arb_mat(
            [
                [
                    (c + value * d) * piece * ldexp(1.0, weights[j] - weights[i])
                    for j, (c, d) in enumerate(zip(*rows, strict=True))
                ]
                for i, rows in enumerate(zip(self.constant, self.linear, strict=True))
            ]
        )
        t = scaled.exp()
        transfer = [[t[i, j] * ldexp(1.0, weights[i] - weights[j]) for j in range(n)] for i in range(n)]
        block = [[arb_mat([row[b : b + k] for row in transfer[a : a + k]]) for b in (0, k)] for a in (0, k)]
        flexible = _inverse(block[0][1])
        start, end = flexible * block[0][0], block[1][1] * flexible
        across = -flexible
        held = 0
        for _ in range(halvings):
            joint = end + start
            # as many pivots are negative as eigenvalues
            rows = [dict(enumerate(row)) for row in joint.tolist()]
            held = 2 * held + pivots(rows, range(len(rows))).negative
            inner = _inverse(joint)
            left, right = across * inner, across.transpose() * inner
            start, end, across = (start - left * across.transpose(), end - right * across, -(left * across))
        return Stiffness(start, across, end, held)

    def cut(self, size: float) -> tuple[int, tuple[int, ...]]:
        """Return how often a member is halved up to an abs(lambda), and powers of two that balance states."""
        # So that few lambdas are looked at: the next power of four.
        exponent = (frexp(size)[1] + 1) // 2 * 2 if size else 0
        if exponent not in self._pieces:
            self._pieces[exponent] = self._halvings(arb(0, ldexp(1.0, exponent)))
        return self._pieces[exponent]

    def _halvings(self, values: arb) -> tuple[int, tuple[int, ...]]:
        """Return the same for all lambdas of a ball."""
        k = len(self.constant) // 2
        entries = [
            [c + values * d for c, d in zip(*rows, strict=True)]
            for rows in zip(self.constant, self.linear, strict=True)
        ]
        turning = [[_above(entries[i][j]) for j in range(k)] for i in range(k)]
        compliance = [_above(entries[i][k + i]) for i in range(k)]
        inertia = [max(0.0, -float(entries[k + i][i].lower())) for i in range(k)]
        length = float(self.length.upper())
        for halvings in range(MOST_HALVINGS):
            h = ldexp(length, -halvings)
            spread = _exponential(turning, h)
            if spread is None:
                continue
            taken = sum(inertia[i] * spread[i][j] ** 2 * compliance[j] for i in range(k) for j in range(k))
            if h * h * taken < HALF:
                return halvings, _weights([[_above(x) * h for x in row] for row in entries])
        raise UndecidedError


def _above(value: arb) -> float:
    return float(abs(value).upper())


def _exponential(matrix: Sequence[Sequence[float]], h: float) -> list[list[float]] | None:
    """Return exp(h*matrix), entries not negative; ``None`` where its norm is above 1."""
    k = len(matrix)
    if any(sum(row) * h > 1 for row in matrix) and not _is_nilpotent(matrix):
        return None
    total = [[float(i == j) for j in range(k)] for i in range(k)]
    term = [row[:] for row in total]
    for n in range(1, SERIES_TERMS):
        term = [
            [sum(term[i][m] * matrix[m][j] for m in range(k)) * h / n for j in range(k)] for i in range(k)
        ]
        if not any(map(any, term)):
            break
        total = [[x + y for x, y in zip(*rows, strict=True)] for rows in zip(total, term, strict=True)]
    return total


def _is_nilpotent(matrix: Sequence[Sequence[float]]) -> bool:
    """Tell whether a power vanishes, by the pattern of its entries."""
    k = len(matrix)
    reached = [[bool(x) for x in row] for row in matrix]
    power = reached
    for _ in range(k):
        power = [[any(power[i][m] and reached[m][j] for m in range(k)) for j in range(k)] for i in range(k)]
    return not any(map(any, power))


def _weights(entries: Sequence[Sequence[float]]) -> tuple[int, ...]:
    """Return w so that rows and columns of ``entries[i][j]*2^(w_j - w_i)`` are alike."""
    sizes = {(i, j): log2(x) for i, row in enumerate(entries) for j, x in enumerate(row) if x and i != j}
    return tuple(map(round, balanced(sizes, len(entries), 8)))  # a few rounds settle four states


def _inverse(matrix: arb_mat) -> arb_mat:
    try:
        return matrix.inv()
    except ZeroDivisionError:
        raise UndecidedError from None
