"""Networks of masses, springs and dampers of any size, every m, k and b a symbol of its own.

Models are made directly: what a specification in text may contain ends at some thousand masses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.expressions import Name
from symflex.library.elements import ELEMENTS
from symflex.model import Model
from symflex.model.model import Input, ModelParameter, NetworkNode, NodeReference, Output, PlacedElement

if TYPE_CHECKING:
    from collections.abc import Iterable


def chain(n: int) -> list[tuple[int, int]]:
    """Return the branches of a chain of ``n`` masses, numbered from 1."""
    return [(i, i + 1) for i in range(1, n)]


def ring(n: int) -> list[tuple[int, int]]:
    """Return those of a closed chain."""
    return [*chain(n), (n, 1)]


def tree(n: int) -> list[tuple[int, int]]:
    """Return those of a binary tree."""
    return [(i // 2, i) for i in range(2, n + 1)]


def ladder(n: int) -> list[tuple[int, int]]:
    """Return those of two chains of ``n/2`` masses with rungs between them; mass 2i - 1 is beside 2i."""
    return [(i, i + 2) for i in range(1, n - 1)] + [(i, i + 1) for i in range(1, n, 2)]


def grid(n: int) -> list[tuple[int, int]]:
    """Return those of a square grid of about ``n`` masses."""
    side = round(n**0.5)
    return [(r * side + c + 1, r * side + c + 2) for r in range(side) for c in range(side - 1)] + [
        (r * side + c + 1, (r + 1) * side + c + 1) for r in range(side - 1) for c in range(side)
    ]


NETWORKS = {"chain": chain, "ring": ring, "tree": tree, "ladder": ladder, "grid": grid}


def network(branches: Iterable[tuple[int, int]]) -> Model:
    """Return free masses, joined by springs and dampers; a force acts on the first.

    Examples
    --------
    >>> model = network(chain(3))
    >>> len(model.elements), [p.name for p in model.parameters][-2:]
    (7, ['k_2', 'b_2'])
    """
    links = list(branches)
    masses = sorted({i for link in links for i in link})
    parameters: list[ModelParameter] = []
    elements: list[PlacedElement] = []
    for i in masses:
        parameters.append(ModelParameter(f"m_{i}", None, "kg"))
        elements.append(_placed("mass", f"mass_{i}", "at", (i,), ("m", f"m_{i}")))
    for number, ends in enumerate(links, 1):
        for kind, letter, unit in (("spring", "k", "N/m"), ("damper", "b", "N*s/m")):
            name = f"{letter}_{number}"
            parameters.append(ModelParameter(name, None, unit))
            elements.append(_placed(kind, f"{kind}_{number}", "between", ends, (letter, name)))
    return Model(
        parameters=tuple(parameters),
        nodes=tuple(NetworkNode(f"x_{i}", "translation") for i in masses),
        elements=tuple(elements),
        inputs=(Input("F", "force", (NodeReference("x_1"),), None, "N"),),
        outputs=(
            Output("X_first", Name("x_1"), None, "m"),
            Output("X_last", Name(f"x_{masses[-1]}"), None, "m"),
        ),
    )


def _placed(kind: str, name: str, port: str, ends: tuple[int, ...], value: tuple[str, str]) -> PlacedElement:
    return PlacedElement(
        name,
        ELEMENTS[kind],
        ((port, tuple(NodeReference(f"x_{i}") for i in ends)),),
        ((port, "translation"),),
        ((value[0], Name(value[1])),),
    )
