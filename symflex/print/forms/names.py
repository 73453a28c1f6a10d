"""Names for what a form abbreviates, free of collision with every name of the model; symbols of constants."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.expressions import FUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from symflex.expressions import Expression
    from symflex.model import Model
    from symflex.transfer import TransferFunction


def names_of(model: Model) -> frozenset[str]:
    """Return every name that an expression of the model could read, and those with a meaning of their own."""
    tables = (
        model.parameters,
        model.definitions,
        model.nodes,
        model.elements,
        model.signals,
        model.blocks,
        model.fields,
        model.inputs,
        model.outputs,
    )
    unknowns = (u for field in model.fields for u in field.unknowns)
    return frozenset((LAPLACE, "pi", *FUNCTIONS, *unknowns, *(x.name for table in tables for x in table)))


def free_names(stem: str, wanted: int, taken: Collection[str]) -> tuple[str, ...]:
    """Return the stem, or numbered ones where several are wanted or it is taken.

    Examples
    --------
    >>> free_names("q", 1, {"E"}), free_names("q", 2, {"q_1"}), free_names("q", 1, {"q"})
    (('q',), ('q_2', 'q_3'), ('q_1',))
    """
    if wanted == 1 and stem not in taken:
        return (stem,)
    numbered = (f"{stem}_{i}" for i in count(1))
    free = (name for name in numbered if name not in taken)
    return tuple(next(free) for _ in range(wanted))


def free_family(stems: Sequence[str], members: int, taken: Collection[str]) -> tuple[str, ...]:
    """Return names numbered from zero, of the first stem that leaves all of them free.

    Examples
    --------
    >>> free_family("KL", 2, {"K_1"})
    ('L_0', 'L_1')
    """
    for length in count(1):
        for stem in stems:
            family = tuple(f"{stem * length}_{i}" for i in range(members))
            if not set(family) & set(taken):
                return family
    raise AssertionError


def constant_symbols(tf: TransferFunction) -> dict[str, Expression]:
    """Return what the generators of functions of constants print as."""
    return {c.generator: c.expression for c in tf.constants}
