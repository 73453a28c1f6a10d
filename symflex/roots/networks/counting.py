"""How many frequencies an undamped network has below a given one, proved (Wittrick & Williams 1971).

The number is that of the members' own frequencies, held at their ends, and of negative pivots of the
network's dynamic stiffness, less a constant. Bordered by a row that contains what the input drives, the same
counts the zeros of that input's own motion.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from flint import arb, arb_mat

from symflex.algebra import Factored
from symflex.balls import current_bits, precision, settled
from symflex.balls.inertia import Rows, elimination_order, pivots
from symflex.budget import spend
from symflex.roots.networks.members import MemberBalls, Stiffness
from symflex.roots.networks.network import Network, NetworkMember, PolynomialValues


@dataclass(frozen=True, slots=True)
class NetworkSample:
    """A network at one lambda, which is none of its eigenvalues."""

    value: arb  # lambda [rad^2/s^2], exact
    below: int  # eigenvalues below, but for a constant of the network
    determinant: arb  # of the dynamic stiffness, with the poles of the members' own frequencies
    receptances: tuple[arb, ...]  # per border, of the motion it holds, by the force on it


@dataclass(frozen=True, eq=False)
class Counter:
    """Samples a network."""

    network: Network
    borders: tuple[Mapping[int, Factored], ...]  # rows that contain a motion
    _levels: dict[int, Level] = field(default_factory=dict, repr=False)

    @cached_property
    def order(self) -> tuple[int, ...]:
        """The order in which unknowns are eliminated."""
        network = self.network
        pairs = list(network.entries)
        for member in network.members:
            places = [i for i in member.ends if i is not None]
            pairs += [(i, j) for i in places for j in places if i <= j]
        return elimination_order(network.size, pairs)

    def sample(self, value: arb, bits: int) -> NetworkSample:
        """Return the network at an exact real lambda, with at least so many bits; else UndecidedError."""
        return settled(lambda: self.level(current_bits()).sample(value), bits)

    def level(self, bits: int) -> Level:
        """Return the network's numbers at a precision."""
        if bits not in self._levels:
            self._levels[bits] = Level.of(self, bits)
        return self._levels[bits]


@dataclass(frozen=True, eq=False)
class Level:
    """A network's numbers at one precision."""

    bits: int
    counter: Counter
    entries: Sequence[tuple[int, int, arb, arb]]
    borders: Sequence[Sequence[tuple[int, arb]]]
    members: Sequence[tuple[NetworkMember, MemberBalls, arb_mat | None]]  # each with its direction

    @staticmethod
    def of(counter: Counter, bits: int) -> Level:
        """Return the numbers of what is counted."""
        network = counter.network
        with precision(bits):
            number = PolynomialValues(network.numeric)
            entries = [(i, j, *number.even(v)) for (i, j), v in network.entries.items()]
            borders = [[(i, number.constant(v)) for i, v in border.items()] for border in counter.borders]
            balls: dict[str, MemberBalls] = {}
            for member in network.members:
                if member.key not in balls:
                    pairs = [[number.even(x) for x in row] for row in member.system]
                    balls[member.key] = MemberBalls(
                        [[a for a, _ in row] for row in pairs],
                        [[b for _, b in row] for row in pairs],
                        number.constant(member.length),
                    )
            members = [
                (m, balls[m.key], _turn([number.constant(x) for x in m.direction])) for m in network.members
            ]
        return Level(bits, counter, entries, borders, members)

    def sample(self, value: arb) -> NetworkSample:
        """Return the network at an exact real lambda; UndecidedError where a sign is not decided."""
        spend()
        with precision(self.bits):
            size = self.counter.network.size
            rows: list[dict[int, arb]] = [{} for _ in range(size + len(self.borders))]
            for i, j, constant, slope in self.entries:
                rows[i][j] = rows[j][i] = constant + value * slope
            for place, border in enumerate(self.borders):
                for i, x in border:
                    rows[i][size + place] = rows[size + place][i] = x
            held = 0
            known: dict[int, Stiffness] = {}
            for member, balls, turn in self.members:
                if id(balls) not in known:
                    known[id(balls)] = balls.stiffness(value)
                seen = known[id(balls)] if turn is None else known[id(balls)].turned(turn)
                held += seen.held
                add_member(rows, member.ends, seen.blocks)
            elimination = pivots(rows, self.counter.order, range(size, size + len(self.borders)))
            receptances = tuple(arb(0) if x is None else -x for x in elimination.borders)
            determinant = arb(1) if elimination.determinant is None else elimination.determinant
            return NetworkSample(value, held + elimination.negative, determinant, receptances)


def _turn(direction: Sequence[arb]) -> arb_mat | None:
    """Return what takes a motion (x, y, theta) to the axes of a member, None for one without."""
    if not direction:
        return None
    cos, sin = direction
    return arb_mat([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])


def add_member(rows: Rows, ends: Sequence[int | None], blocks: Sequence[Sequence[Sequence[arb]]]) -> None:
    """Add the stiffness of a member, at the start, across and at the end, to what moves its ends."""
    half = len(ends) // 2
    for first, second, block in zip((0, 0, half), (0, half, half), blocks, strict=True):
        for a in range(half):
            i = ends[first + a]
            if i is None:
                continue
            for b in range(a if first == second else 0, half):
                j = ends[second + b]
                if j is None:
                    continue
                # Both ends may be at one node.
                x = 2 * block[a][b] if i == j and first != second else block[a][b]
                known = rows[i].get(j)
                rows[i][j] = rows[j][i] = x if known is None else known + x
