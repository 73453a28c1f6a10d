"""Names that collide with none of the model, handed out once each, and the letters that all commands use."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from itertools import count, islice
from typing import Final

from symflex.algebra import LAPLACE
from symflex.expressions import FUNCTIONS
from symflex.model import Model
from symflex.transfer import TransferFunction

ALPHA, BETA, GAMMA, LAMBDA = "alpha", "beta", "gamma", "lambda"
"""Wavenumbers: of a beam, ``4 alpha^4 = c_0`` and ``beta^4 = -c_0``; of a rod, shaft or string; of a pair."""
RATIOS: Final = {  # dimensionless groups, by the unit of what is divided
    "kg": ("mu", "mass ratio"),
    "N/m": ("kappa", "stiffness ratio"),
    "N*m": ("kappa", "stiffness ratio"),
    "kg*m^2": ("nu", "inertia ratio"),
    "m": ("lambda", "length ratio"),
    "s": ("tau", "time ratio"),
}


class Naming:
    """Hands out names, none twice."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)

    @staticmethod
    def of(tf: TransferFunction) -> Naming:
        """Return the naming for a form of a transfer function."""
        return Naming((*names_of(tf.model), *tf.ring.names))

    def take(self, stem: str, wanted: int = 1) -> tuple[str, ...]:
        """Return the stem, or numbered ones where several are wanted or it is taken.

        >>> Naming({"E"}).take("q"), Naming({"q_1"}).take("q", 2), Naming({"q"}).take("q")
        (('q',), ('q_2', 'q_3'), ('q_1',))
        """
        free = (name for i in count(1) if (name := f"{stem}_{i}") not in self._taken)
        taken = (stem,) if wanted == 1 and stem not in self._taken else tuple(islice(free, wanted))
        self._taken.update(taken)
        return taken

    def family(self, stems: Sequence[str], members: int) -> tuple[str, ...]:
        """Return names numbered from zero, of the first stem that leaves all of them free."""
        own = (tuple(f"{stem * n}_{i}" for i in range(members)) for n in count(1) for stem in stems)
        chosen = next(family for family in own if self._taken.isdisjoint(family))
        self._taken.update(chosen)
        return chosen

    def keep(self, names: Iterable[str]) -> None:
        """Let the names be used by nothing else."""
        self._taken.update(names)

    @property
    def taken(self) -> Collection[str]:
        """The names that are not free any more."""
        return self._taken


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
