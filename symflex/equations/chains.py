"""Chains of line elements of one law: each state from that at the chain's start, not from the one before.

``z_2 = T(b) (T(a) z_0 + e)`` is ``T(a + b) z_0 + T(b) e``, with e what enters where the elements meet. Where
nothing but inputs does, a chain has the determinant of one element, as if it had not been cut.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.library.elements.line import LineElement

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from symflex.algebra import Factored
    from symflex.library.fields import FieldSystem
    from symflex.model import Model, PlacedElement


@dataclass(frozen=True, eq=False)
class Link:
    """The end of an element in terms of its chain.

    Parameters
    ----------
    name : str
        The element.
    first : str
        The first element of the chain.
    length : Factored
        From the chain's start to the element's end [m].
    entries : tuple of (str, str, Factored)
        Where inputs enter: the elements before and after, and the distance from there.
    """

    name: str
    first: str
    length: Factored
    entries: tuple[tuple[str, str, Factored], ...]


def find_links(model: Model, lines: Mapping[str, tuple[FieldSystem, Factored]]) -> tuple[Link, ...]:
    """Return the links of all chains, those with the longest lengths first.

    Parameters
    ----------
    model : Model
        Resolved.
    lines : mapping of str to (FieldSystem, Factored)
        Every line element's equations and length.
    """
    touched = Counter(r.node for use in model.elements for _, references in use.nodes for r in references)
    driven = {r.node for given in model.inputs for r in given.nodes}
    ends = {use.name: _ends(use) for use in model.elements if isinstance(use.element, LineElement)}
    starting = {a: name for name, (a, _) in ends.items()}
    following = {
        name: starting[b]
        for name, (_, b) in ends.items()
        if b in starting
        and touched[b[0]] == 2  # noqa: PLR2004 (the two elements)
        and b[0] != "ground"
        and starting[b] != name
        and _is_same(lines[name][0], lines[starting[b]][0])
    }
    found = []
    for first in (name for name in ends if name in following and name not in following.values()):
        chain = [first]
        while chain[-1] in following:
            chain.append(following[chain[-1]])
        found += _links(
            chain, [lines[name][1] for name in chain], [ends[name][0][0] in driven for name in chain]
        )
    return tuple(found)


def _ends(use: PlacedElement) -> tuple[tuple[str, str], tuple[str, str]]:
    a, b = dict(use.nodes)["between"]
    return (a.node, a.component), (b.node, b.component)


def _is_same(one: FieldSystem, other: FieldSystem) -> bool:
    """Tell whether two elements have the same equations."""
    pairs = zip(_entries(one), _entries(other), strict=False)
    return one.states == other.states and all((a - b).is_zero for a, b in pairs)


def _entries(system: FieldSystem) -> Iterable[Factored]:
    return (entry for row in system.matrix for entry in row)


def _links(chain: Sequence[str], lengths: Sequence[Factored], is_driven: Sequence[bool]) -> list[Link]:
    """Return the links of one chain, the last first."""
    starts = [lengths[0] * 0]
    for length in lengths:
        starts.append(starts[-1] + length)
    return [
        Link(
            chain[n],
            chain[0],
            starts[n + 1],
            tuple(
                (chain[k - 1], chain[k], starts[n + 1] - starts[k]) for k in range(1, n + 1) if is_driven[k]
            ),
        )
        for n in range(len(chain) - 1, 0, -1)
    ]
