"""Frequencies of a network in double precision, many at once: where to look, and no proof of anything."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from symflex.budget import spend
from symflex.roots.networks.counting import add_member
from symflex.roots.networks.inertia import pivots
from symflex.roots.networks.members import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt
    from flint import arb_mat

    from symflex.roots.networks.counting import Level
    from symflex.roots.networks.members import MemberBalls

    Array = npt.NDArray[np.float64]
    Counts = npt.NDArray[np.int64]

TAYLOR_TERMS = 16
"""Of exp(A h) of a piece so short that it has no frequency of its own, balanced: the norm is about 1."""
POINTS = 48
"""Frequencies looked at together: enough that what numpy spends on an operation is little."""
DECADES = (-3.0, 9.0)
"""Of omega [rad/s], where frequencies of what is built lie; others are found without estimates."""
MOST_ROUNDS = 40
CLOSE = 1e-9
"""Relative width at which brackets are close: counts in double precision tell little more."""
MOST_PARTS = 16


class DoubleArrays:
    """Arrays of doubles, an entry per frequency."""

    def is_usable(self, value: Array) -> bool:
        """Tell whether nowhere is divided by zero."""
        return bool(np.all(value != 0))

    def negative(self, value: Array) -> Counts:
        """Return 1 where numbers are below zero, else 0."""
        return (value < 0).astype(int)

    def negative_of_pair(self, determinant: Array, corner: Array | None) -> Counts:
        """Return how many eigenvalues of two rows and columns are negative."""
        both = 0 if corner is None else 2 * (corner < 0)
        return np.where(determinant < 0, 1, both)


def estimates(
    level: Level, count: int, lowest: float | None, highest: float | None, border: int | None
) -> list[float]:
    """Return estimates of the lowest eigenvalues lambda [rad^2/s^2]: so many, or all between two.

    ``border`` says which motion is held.
    """
    grid = np.logspace(*DECADES, 4 * POINTS) ** 2
    if lowest:
        grid = np.insert(grid[grid > lowest], 0, lowest)
    if highest is not None:
        grid = np.append(grid[grid < highest], highest)
    counts = _counts(level, grid, border, count if highest is None else np.inf)
    counts = counts - counts[0]
    most = int(counts.max(initial=0))
    found = []
    for number in range(1, (min(count, most) if highest is None else most) + 1):
        place = int(np.argmax(counts >= number))
        found.append((grid[place - 1], grid[place]))
    brackets = np.array(found).reshape(-1, 2)
    base = _counts(level, grid[:1], border)[0]
    numbers = np.arange(1, len(brackets) + 1)[:, None]
    rows = np.arange(len(brackets))
    for _ in range(MOST_ROUNDS if len(brackets) else 0):
        width = brackets[:, 1:] - brackets[:, :1]
        if np.all(width <= CLOSE * brackets[:, 1:]):
            break
        parts = max(2, min(MOST_PARTS, POINTS // len(brackets)))
        points = brackets[:, :1] + width * np.arange(1, parts) / parts
        above = _counts(level, points.ravel(), border).reshape(points.shape) - base >= numbers
        first = np.where(above.any(axis=1), above.argmax(axis=1), parts - 1)
        ends = np.concatenate([brackets[:, :1], points, brackets[:, 1:]], axis=1)
        brackets = np.stack([ends[rows, first], ends[rows, first + 1]], axis=1)
    return [float(x) for x in brackets.mean(axis=1)]


def _counts(level: Level, values: Array, border: int | None, enough: float = np.inf) -> Counts:
    """Return the number of eigenvalues below each lambda, but for a constant; none after enough of them."""
    found: list[Counts] = []
    for start in range(0, len(values), POINTS):
        spend()
        found.append(_count(level, values[start : start + POINTS], border))
        if found[-1][-1] - found[0][0] >= enough:
            break
    return np.concatenate(found)


@dataclass(frozen=True, slots=True)
class _Joined:
    """Where one of several equal members is joined to the network, and how it is turned."""

    ends: tuple[int | None, ...]
    turn: Array | None

    def turned(self, block: Array) -> Array:
        """Return a block of the stiffness in the axes of the network, as :meth:`Stiffness.turned` does."""
        return block if self.turn is None else self.turn.T @ block @ self.turn


def _midpoints(matrix: arb_mat) -> Array:
    return np.array([[float(x.mid()) for x in row] for row in matrix.tolist()])


def _count(level: Level, values: Array, border: int | None) -> Counts:
    size = level.counter.network.size
    rows: list[dict[int, Array]] = [{} for _ in range(size + 1)]
    ones = np.ones(len(values))
    for i, j, constant, slope in level.entries:
        rows[i][j] = rows[j][i] = float(constant.mid()) * ones + values * float(slope.mid())
    if border is not None:
        for i, x in level.borders[border]:
            rows[i][size] = rows[size][i] = float(x.mid()) * ones
    total = np.zeros(len(values), dtype=int)
    grouped: dict[tuple[int, int], list[tuple[MemberBalls, list[_Joined]]]] = {}
    alike: dict[int, list[_Joined]] = {}
    for member, balls, turn in level.members:
        if id(balls) not in alike:
            alike[id(balls)] = []
            try:
                halvings, _ = balls.cut(float(values.max()))
            except UndecidedError:
                return total
            grouped.setdefault((len(balls.constant), halvings), []).append((balls, alike[id(balls)]))
        alike[id(balls)].append(_Joined(member.ends, None if turn is None else _midpoints(turn)))
    with np.errstate(all="ignore"):
        for (_, halvings), group in grouped.items():
            blocks, held = _stiffnesses([balls for balls, _ in group], values, halvings)
            for place, (_, joined) in enumerate(group):
                total += held[place] * len(joined)
                for each in joined:
                    seen = [each.turned(b[place]) for b in blocks]
                    add_member(rows, each.ends, [list(np.moveaxis(b, 0, -1)) for b in seen])
        try:
            left = pivots(rows, level.counter.order, DoubleArrays(), [size])
        except UndecidedError:
            return total
        total += left.negative
        if border is not None and left.borders[0] is not None:
            total += left.borders[0] < 0
    return total


def _stiffnesses(
    members: Sequence[MemberBalls], values: Array, halvings: int
) -> tuple[tuple[Array, Array, Array], Counts]:
    """Return the blocks of the stiffness, and the numbers of own frequencies, by member and lambda."""
    n = len(members[0].constant)
    k = n // 2
    weights = np.exp2([m.cut(float(values.max()))[1] for m in members])
    balance = weights[:, None, :] / weights[:, :, None]
    lengths = np.array([float(m.length.mid()) for m in members])[:, None, None] * 0.5**halvings
    constant, linear = (
        np.array([[[float(x.mid()) for x in row] for row in part] for part in parts]) * balance * lengths
        for parts in ([m.constant for m in members], [m.linear for m in members])
    )
    matrix = constant[:, None] + values[None, :, None, None] * linear[:, None]
    term = transfer = np.broadcast_to(np.eye(n), matrix.shape)
    for i in range(1, TAYLOR_TERMS):
        term = term @ matrix / i
        transfer = transfer + term
    transfer = transfer / balance[:, None]
    flexible = _inverse(transfer[..., :k, k:])
    start, end, across = flexible @ transfer[..., :k, :k], transfer[..., k:, k:] @ flexible, -flexible
    held = np.zeros(matrix.shape[:2], dtype=int)
    for _ in range(halvings):
        joint = start + end
        held = 2 * held + _negative(joint)
        inner, back = _inverse(joint), np.swapaxes(across, -1, -2)
        left = across @ inner
        start, end, across = start - left @ back, end - back @ inner @ across, -(left @ across)
    return (start, across, end), held


def _inverse(matrices: Array) -> Array:
    """Return inverses of small matrices, not finite where there is none."""
    if matrices.shape[-1] == 1:
        return np.reciprocal(matrices)
    if matrices.shape[-1] > 2:  # noqa: PLR2004
        return np.asarray(np.linalg.inv(matrices), dtype=float)
    a, b, c, d = (matrices[..., i, j] for i in (0, 1) for j in (0, 1))
    determinant = a * d - b * c
    rows = [np.stack(pair, axis=-1) for pair in ((d, -b), (-c, a))]
    inverse: Array = np.stack(rows, axis=-2) / determinant[..., None, None]
    return inverse


def _negative(matrices: Array) -> Counts:
    """Return how many pivots of small symmetric matrices are negative."""
    if matrices.shape[-1] == 1:
        return (matrices[..., 0, 0] < 0).astype(int)
    a, b, d = matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1]
    if matrices.shape[-1] > 2:  # noqa: PLR2004
        return np.asarray(np.sum(np.linalg.eigvalsh(matrices) < 0, axis=-1))
    return np.asarray((a < 0).astype(int) + (d - b * b / a < 0))
