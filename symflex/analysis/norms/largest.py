"""The largest singular value of a matrix on the imaginary axis, enclosed.

Input: a :class:`MatrixOnAxis`, a band or none. Output: a :class:`LargestGain`, two bounds and where it is.

Example: ``diag(1/(s + 1), 2/(s + 1))`` has 2, at 0.

The axis is cut into pieces, and the one with the largest bound is halved until that is above a value met by
no more than asked for (Moore 1966). The largest eigenvalue of a Hermitian matrix is convex, so that on a
chord it is largest at an end; where no eigenvalue is negative, ``tr(A^k)^(1/k)`` is no smaller than the
largest, and a Rayleigh quotient is no larger.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
import numpy.typing as npt
from flint import acb, acb_mat, arb

from symflex.analysis.norms.axis import MOST_PIECES, NARROWEST, RATIO, MatrixOnAxis, TaylorForm, norm
from symflex.analysis.norms.expanded import BITS
from symflex.balls import Branching, Open, Part, branch, halved, precision
from symflex.loops.axis import ball_of, joined, pieces
from symflex.roots.root import short_hertz

WIDTH = 1e-3  # relative distance of the bounds
SQUARINGS = 23  # of a matrix, whose trace is its largest eigenvalue's power then but for 1e-7
NEAR = 1e-6  # relative half width of a piece at a pole's frequency, where a large value is met first
NODES = 6  # on each side of the middle of a piece
FURTHER, STEP = 40, 2.0  # frequencies from which on a bound is tried
NOTHING = arb(0)
MOST_TURNS = 200  # of entries against each other by delays up to such a frequency


@dataclass(frozen=True, slots=True)
class LargestGain:
    """Bounds of the largest singular value, and where it is about."""

    least: arb
    most: arb  # infinite where it may be
    omega: float  # [rad/s] where ``least`` was met; infinite as the frequency grows
    high: float  # [rad/s] up to which it is proved; infinite for all frequencies
    reasons: tuple[str, ...]  # what is not proved
    places: tuple[arb, ...]  # [rad/s], one of which has it, as far as known; none as omega grows

    @property
    def enclosure(self) -> arb:
        """A ball between the bounds."""
        return self.least.union(self.most)


def eigenvalue_bound(matrix: acb_mat) -> arb:
    """Return no less than the largest eigenvalue of a Hermitian matrix, hardly more if none is below 0."""
    if matrix.nrows() == 1:
        return matrix[0, 0].real.upper()
    # The middle and the radius apart (Weyl 1912): powers of balls of matrices grow too fast.
    n = matrix.nrows()
    power = middle = acb_mat(n, n, [x.mid() for x in matrix.entries()])
    for _ in range(SQUARINGS):
        power = power * power
    trace = sum((power[i, i].real for i in range(n)), arb(0))
    if not trace.is_finite():
        return arb("inf")
    top = trace.upper()
    root = top.root(2**SQUARINGS) if top > 0 else arb(0)  # which flint has none of, of 0
    return (root + norm(matrix - middle)).upper()


def matrix_of_doubles(matrix: acb_mat) -> npt.NDArray[np.complex128] | None:
    """Return a matrix over the size of its largest entry in doubles; None where it is zero or not finite."""
    middles = [x.mid() for x in matrix.entries()]
    scale = max((x.abs_upper() for x in middles), default=arb(0))
    if not (scale.is_finite() and scale > 0):
        return None
    values = np.array([complex(x / scale) for x in middles])
    return values.reshape(matrix.nrows(), matrix.ncols())


def eigenvalue_met(matrix: acb_mat) -> arb:
    """Return a Rayleigh quotient of a Hermitian matrix, about the largest eigenvalue and no more."""
    if matrix.nrows() == 1:
        return matrix[0, 0].real.lower()
    middle = matrix_of_doubles(matrix)
    if middle is None:
        return arb(0)
    _, vectors = np.linalg.eigh(middle)
    n = matrix.nrows()
    vector = acb_mat(n, 1, [acb(complex(x)) for x in vectors[:, -1]])
    size = sum((abs(x) ** 2 for x in vector.entries()), arb(0))
    if not size > 0:
        return arb(0)
    return ((vector.conjugate().transpose() * matrix * vector)[0, 0].real / size).lower()


def squared(form: TaylorForm) -> list[acb_mat]:
    """Return the powers of ``E^H E``, or of ``E E^H`` if that is smaller."""
    first = form.powers[0]
    is_wide = first.ncols() > first.nrows()
    adjoint = [m.conjugate().transpose() for m in form.powers]
    count = len(form.powers)
    pairs = (form.powers, adjoint) if is_wide else (adjoint, form.powers)
    total: list[acb_mat] = []
    for n in range(2 * count - 1):
        parts = [pairs[0][i] * pairs[1][n - i] for i in range(max(0, n - count + 1), min(n, count - 1) + 1)]
        total.append(sum(parts[1:], parts[0]))
    return total


def singular_bound(matrix: acb_mat) -> arb:
    """Return no less than the largest singular value of every matrix in a ball."""
    shape = matrix.nrows(), matrix.ncols()
    middle = acb_mat(*shape, [x.mid() for x in matrix.entries()])
    (square,) = squared(TaylorForm((middle,), arb(0)))
    return (eigenvalue_bound(square).max(arb(0)).sqrt() + norm(matrix - middle)).upper()


@dataclass(frozen=True, slots=True)
class _NormPiece:
    ends: Part
    top: float  # bound on the piece
    in_disc: bool


class _NormSearch:
    def __init__(self, matrix: MatrixOnAxis, width: float, floor: arb = NOTHING) -> None:
        self.matrix, self.width, self.floor = matrix, width, floor
        self.best, self.omega = arb(0), 0.0
        self.near: list[_NormPiece] = []  # all that may contain it

    @property
    def level(self) -> arb:
        return (self.best * (1 + arb(self.width))).max(self.floor).upper()

    def meet(self, size: arb, omega: float) -> None:
        """Note a value that is reached."""
        if size > self.best:
            self.best, self.omega = size, omega

    def piece(self, ends: Part, *, in_disc: bool) -> _NormPiece:
        low, high = ends
        middle = low + (high - low) / 2
        with precision(BITS):
            if not in_disc:
                value = self.matrix.value(acb(0, arb(low).union(arb(high))), is_wide=True)
                crude = singular_bound(value)
                if crude.is_finite() and crude < self.level:
                    return _NormPiece(ends, float(crude), in_disc)
            matrix = self.matrix
            form = matrix.in_disc(low, high, self.level) if in_disc else matrix.beyond_disc(low, high)
            if not form.is_finite:
                return _NormPiece(ends, inf, in_disc)
            half = (arb(high - low) / 2).upper()
            if (size := form.size(half) + form.off) < self.level:
                return _NormPiece(ends, float(size.upper()), in_disc)
            square = squared(form)
            met = eigenvalue_met(square[0])
            if met > 0:
                self.meet((met.sqrt() - form.in_middle).lower(), middle)
            return _NormPiece(ends, float((_on(square, half).sqrt() + form.off).upper()), in_disc)

    def decide(self, piece: _NormPiece) -> Open[_NormPiece] | None:
        if not piece.top <= self.level:
            return Open(piece)
        self.near += [piece] if piece.top >= self.best else []
        return None

    def halves(self, piece: _NormPiece) -> list[_NormPiece]:
        low, high = piece.ends
        if high - low < NARROWEST * high:
            return []
        return [self.piece(part, in_disc=piece.in_disc) for part in halved(piece.ends)]


def _on(square: list[acb_mat], half: arb) -> arb:
    """Return the largest eigenvalue at most within ``half`` of the middle.

    Between nodes a matrix differs from its chord by an eighth of its second derivative times their distance
    squared; on the chord the largest eigenvalue is convex.
    """
    curvature = sum((n * (n - 1) * norm(m) * half ** (n - 2) for n, m in enumerate(square[2:], 2)), arb(0))
    sizes = []
    for k in range(-NODES, NODES + 1):
        t = half * k / NODES
        total = square[-1]
        for m in reversed(square[:-1]):
            total = total * t + m
        sizes.append(eigenvalue_bound(total))
    off = curvature * (half / NODES) ** 2 / 8
    return (max(sizes, key=float) + off).upper().max(arb(0))


def largest_gain(
    matrix: MatrixOnAxis,
    band: Part | None = None,
    width: float = WIDTH,
    enough: float = inf,
    floor: arb = NOTHING,
) -> LargestGain:
    """Return bounds of the largest singular value in a band [rad/s], or at all frequencies.

    ``enough`` ends the search as soon as a value above it is met; below ``floor`` none are distinguished.
    """
    low, high = band or (0.0, inf)
    search, reasons = _NormSearch(matrix, width, floor), [*matrix.reasons]
    starts, edge, sizes = matrix.in_discs(low, high)
    for omega in sizes:
        if low < omega < edge:
            search.piece((omega * (1 - NEAR), omega * (1 + NEAR)), in_disc=True)
    waiting = [search.piece(ends, in_disc=True) for ends in starts]
    end, tail = high, arb(0)
    if high == inf:
        end, tail = _tail(search, edge)
    if tail == inf:
        reasons.append(f"above {short_hertz(arb(end))} Hz no bound on the magnitude is known")
        high, tail = end, arb(0)
    in_disc = matrix.used == inf
    waiting += [search.piece(ends, in_disc=in_disc) for ends in pieces(edge, end, RATIO)]
    done: Branching[_NormPiece, None] = branch(
        waiting,
        search.decide,
        search.halves,
        order=lambda piece: piece.top,
        most=MOST_PIECES,
        until=lambda found, _: bool(found.undecided) or bool(search.best > enough),
    )
    tops = [arb(piece.top) for piece in done.undecided]
    most = max([search.level, tail, *tops], key=float)
    near = sorted((p.ends for p in (*search.near, *done.undecided) if p.top >= search.best), key=min)
    places = joined(ball_of(ends) for ends in near)
    if not places and search.omega < inf:
        places = (arb(search.omega),)
    return LargestGain(search.best, most, search.omega, high, tuple(reasons), places)


def _limit(search: _NormSearch, edge: float) -> tuple[arb, arb, float]:
    """Return the largest singular value that is neared as the frequency grows: a bound, a value, and where.

    One delay turns the entries through all phases in a period. With several the bound is that of
    nonnegative entries as large, in phase.
    """
    matrix = search.matrix
    limit = matrix.limit()
    delays = [delay for row in matrix.delays for delay in row if delay != 0]
    if not delays or all(x == 0 for x in limit.entries()):
        flat = squared(TaylorForm((limit,), arb(0)))[0]
        return eigenvalue_bound(flat).sqrt().upper(), eigenvalue_met(flat).max(arb(0)).sqrt().lower(), inf
    if all((delay - delays[0]).contains(0) for delay in delays):
        period = float((2 * arb.pi() / abs(delays[0])).upper())
        turned = largest_gain(matrix.of_constants(limit), (edge, edge + period), search.width)
        return turned.most, turned.least, turned.omega
    sizes = acb_mat(limit.nrows(), limit.ncols(), [acb(abs(x).upper()) for x in limit.entries()])
    return singular_bound(sizes), arb(0), inf


def _tail(search: _NormSearch, edge: float) -> tuple[float, arb]:
    """Return a frequency from which on values are bounded, by the level if possible, and the bound."""
    matrix = search.matrix
    with precision(BITS):
        limit, met, place = _limit(search, edge)
        bounds: list[tuple[float, arb]] = []
        for i in range(FURTHER):
            omega = edge * STEP**i
            if bounds and limit > 0 and matrix.turns(omega) > MOST_TURNS:
                break
            size = matrix.tail(omega)
            if size is None:
                continue
            if not bounds and met > 0 and matrix.vanishes(omega):
                search.meet(met, place if size == 0 else inf)
            bounds.append((omega, (limit + size).upper()))
            if bounds[-1][1] <= search.level:
                return bounds[-1]
        if bounds:
            least = min(float(bound) for _, bound in bounds)
            return next(
                (omega, bound) for omega, bound in bounds if float(bound) <= least * (1 + search.width)
            )
    return edge, arb("inf")
