"""Parts of a network that occur several times, and how often frequencies coincide because of them.

    eight equal arms on a hub that moves along x and y and turns: at a frequency of one arm alone, clamped at
    the hub, each may vibrate by itself. Their forces on the hub have three components, which vanish for
    8 - 3 = 5 independent motions: the hub rests, and the frequency of the whole is at least fivefold

Parts are what falls apart when all unknowns of a junction are held, or of all junctions. They are equal where
members, lengths, lumps and how these are joined are, in exact numbers, whatever the angle they stand at. A
count says that no more frequencies lie about there; together both prove that they are one.
"""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from symflex.algebra import Factored
    from symflex.roots.networks.network import Network, NetworkMember

FEWEST_TIES = 3
"""Of a junction, to members and lumps: two equal ones have no frequency of theirs twice."""
PLANAR = 3
"""Motions of an end of a member at an angle: x, y, theta."""
TURNED_HALF = (-1, -1, 1, 1, 1, -1)
"""What becomes of a planar member's states seen from its other end, by half a turn: x, y, theta, loads."""
SEEN_FROM_BEHIND = (1, -1)
"""What becomes of those of a rod, shaft or string."""


@dataclass(frozen=True, eq=False)
class RepeatedPart:
    """A part that occurs several times, held where it meets the rest."""

    part: Network
    # Of a frequency that the part has once: how often the whole has it at least.
    multiplicity: int


@dataclass(frozen=True, eq=False)
class _HeldPart:
    unknowns: tuple[int, ...]
    members: tuple[NetworkMember, ...]
    touched: frozenset[int]  # unknowns of junctions it acts upon

    @property
    def size(self) -> tuple[int, int]:
        """How many unknowns and members it has: of pieces of unlike size none is described."""
        return len(self.unknowns), len(self.members)


def repeated_parts(network: Network, held: Collection[int] = ()) -> tuple[RepeatedPart, ...]:
    """Return the parts of which there are so many that frequencies coincide.

    ``held`` are unknowns of the network that do not move.
    """
    reading = _HeldApart(network, held)
    junctions = reading.junctions()
    together = frozenset(i for junction in junctions for i in junction)
    found = []
    for junction in dict.fromkeys((*junctions, together)):
        pieces = reading.pieces(junction)
        several = Tally(piece.size for piece in pieces)
        alike: dict[str, list[_HeldPart]] = {}
        for piece in pieces:
            if several[piece.size] > 1:
                alike.setdefault(reading.description(piece), []).append(piece)
        for equal in alike.values():
            multiplicity = len(equal) - reading.reactions(equal)
            if multiplicity > 1:
                found.append(RepeatedPart(reading.part(equal[0]), multiplicity))
    return tuple(found)


class _HeldApart:
    """A network that falls apart where unknowns are held."""

    def __init__(self, network: Network, held: Collection[int]) -> None:
        self.network = network
        self.beside: dict[int, dict[int, str]] = {i: {} for i in range(network.size)}
        for (i, j), value in network.entries.items():
            self.beside[i][j] = self.beside[j][i] = str(value)
        self.in_members = {i for member in network.members for i in member.ends if i is not None}
        self.moving = frozenset(range(network.size)) - self._constrained() - frozenset(held)
        self.ends = {id(m): tuple(i if i in self.moving else None for i in m.ends) for m in network.members}

    def _constrained(self) -> frozenset[int]:
        """Return unknowns that a constraint alone holds, with the forces of these constraints."""
        found: set[int] = set()
        for force, row in self.beside.items():
            if force in self.in_members or len(row) != 1 or force in row:
                continue
            ((other, _),) = row.items()
            value = self.network.entries[min(force, other), max(force, other)]
            if not value.depends_on(LAPLACE) and other not in found:
                found |= {force, other}
        return frozenset(found)

    def junctions(self) -> list[frozenset[int]]:
        """Return the moving unknowns of each place where several members end, or springs and the like."""
        met = Tally[tuple[int | None, ...]]((i,) for i in self.moving - self.in_members)
        for member in self.network.members:
            half = len(member.ends) // 2
            met.update((member.ends[:half], member.ends[half:]))
        found = []
        for end, times in met.items():
            place = self.moving.intersection(i for i in end if i is not None)
            near = {j for i in place for j in self.beside[i]} & self.moving - place
            if place and times + len(near) >= FEWEST_TIES:
                found.append(place)
        return found

    def pieces(self, junction: frozenset[int]) -> list[_HeldPart]:
        """Return what falls apart when the unknowns of a junction are held."""
        left = sorted(self.moving - junction)
        root = {i: i for i in left}

        def top(i: int) -> int:
            while root[i] != i:
                root[i] = root[root[i]]
                i = root[i]
            return i

        ties: list[tuple[int, ...]] = [(i, *self.beside[i]) for i in left]
        ties += [tuple(e for e in self.ends[id(m)] if e is not None) for m in self.network.members]
        for tie in ties:
            free = [top(i) for i in tie if i in root]
            for i in free[1:]:
                root[top(i)] = top(free[0])
        unknowns: dict[int, list[int]] = {}
        for i in left:
            unknowns.setdefault(top(i), []).append(i)
        members: dict[int, list[NetworkMember]] = {}
        alone = []
        for member in self.network.members:
            ends = [e for e in self.ends[id(member)] if e is not None]
            free = [e for e in ends if e in root]
            if free:
                members.setdefault(top(free[0]), []).append(member)
            elif ends:
                alone.append(_HeldPart((), (member,), frozenset(ends)))
        found = []
        for number, own in unknowns.items():
            near = {j for i in own for j in self.beside[i]}
            near |= {e for m in members.get(number, ()) for e in self.ends[id(m)] if e is not None}
            found.append(_HeldPart(tuple(own), tuple(members.get(number, ())), junction & near))
        return [*found, *alone]

    def reactions(self, pieces: Sequence[_HeldPart]) -> int:
        """Return how many components, at most, the forces of equal pieces on what holds them have."""
        places: dict[frozenset[int], set[str]] = {}
        for piece in pieces:
            places.setdefault(piece.touched, set()).add(self.description(piece, is_placed=True))
        return sum(min(len(touched), len(ways)) for touched, ways in places.items())

    def part(self, piece: _HeldPart) -> Network:
        """Return a piece that is held as a network of its own."""
        labels = {i: k for k, i in enumerate(piece.unknowns)}
        entries = {
            (labels[i], labels[j]): value
            for (i, j), value in self.network.entries.items()
            if i in labels and j in labels
        }
        members = tuple(
            replace(m, ends=tuple(None if e is None else labels.get(e) for e in m.ends))
            for m in piece.members
        )
        return replace(
            self.network,
            size=len(labels),
            entries=entries,
            members=members,
            driven={},
            read={},
            below=0,
            above=0,
        )

    # ---------------------------------------------------------------------------- equal or not

    def description(self, piece: _HeldPart, *, is_placed: bool = False) -> str:
        """Describe a piece that is held: those of equal description have equal frequencies.

        Unknowns are numbered as they are met on a walk from where the piece is held. That two walks through
        equal pieces may differ is safe: the pieces count as different ones. With ``is_placed``, where and at
        which angle it acts is described, too: pieces of equal description then act with equal forces.
        """
        labels: dict[int, int] = {}
        angles = None if is_placed or not self._turns(piece) else _Angles()
        own = frozenset(piece.unknowns)
        held = "place {}" if is_placed else "held"

        def name(i: int | None) -> str:
            if i in labels:
                return f"{labels[i]:06}"
            return "new" if i in own else held.format(i)

        lines = [f"{len(own)} unknowns"]
        left = list(piece.members)
        while left:
            views = []
            for k, member in enumerate(left):
                for turned in (False, True)[: 1 + _looks_the_same_from_behind(member)]:
                    ends = self.ends[id(member)]
                    half = len(ends) // 2
                    ordered = (*ends[half:], *ends[:half]) if turned else ends
                    names = [name(i) for i in ordered]
                    views.append((names[:half], names[half:], member.key, k, turned, ordered))
            *_, k, turned, ordered = min(views, key=lambda view: view[:4])
            member = left.pop(k)
            for i in ordered:
                if i in own and i not in labels:
                    labels[i] = len(labels)
            direction = [-x for x in member.direction] if turned else list(member.direction)
            seen = direction if angles is None else angles.seen(direction)
            lines.append(f"{[name(i) for i in ordered]} {member.key} {[str(x) for x in seen]}")
        while len(labels) < len(own):
            rows = [(sorted((name(j), x) for j, x in self.beside[i].items()), i) for i in own - labels.keys()]
            labels[min(rows)[1]] = len(labels)
        for i in own:
            near = own | (self.moving if is_placed else frozenset())
            lines += [f"{name(i)} {name(j)} {x}" for j, x in self.beside[i].items() if j in near]
        return "\n".join(sorted(lines))

    def _turns(self, piece: _HeldPart) -> bool:
        """Tell whether a piece may be turned in its plane: its lumps are the same along x and y."""
        own = frozenset(piece.unknowns)
        across: set[int | None] = set()
        for member in piece.members:
            if not member.direction:
                continue
            for start in (0, PLANAR):
                x, y = self.ends[id(member)][start : start + 2]
                if (x in own) != (y in own):
                    return False
                if x is not None and y is not None and x in own:
                    rows = [{j: v for j, v in self.beside[i].items() if j in own} for i in (x, y)]
                    if any(row.keys() - {i} for row, i in zip(rows, (x, y), strict=True)):
                        return False
                    if rows[0].get(x) != rows[1].get(y):
                        return False
                    across |= {x, y}
        return not any(i in across for m in piece.members if not m.direction for i in self.ends[id(m)])


class _Angles:
    """Directions as seen from the first one met."""

    def __init__(self) -> None:
        self.first: Sequence[Factored] = ()

    def seen(self, direction: Sequence[Factored]) -> Sequence[Factored | int]:
        """Return the cosine and sine of the angle to the first direction."""
        if not direction:
            return ()
        if not self.first:
            self.first = direction
        if list(map(str, direction)) == list(map(str, self.first)):
            return (1, 0)
        (c, s), (cos, sin) = self.first, direction
        return (cos * c + sin * s, sin * c - cos * s)


def _looks_the_same_from_behind(member: NetworkMember) -> bool:
    """Tell whether a member is the same with its ends exchanged, and turned by half a turn in its plane."""
    signs = TURNED_HALF if member.direction else SEEN_FROM_BEHIND
    return len(signs) == len(member.system) and all(
        x.is_zero or signs[i] * signs[j] < 0 for i, row in enumerate(member.system) for j, x in enumerate(row)
    )
