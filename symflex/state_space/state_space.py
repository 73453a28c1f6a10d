"""A realisation with exact matrices, and what its states are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.state_space.popov import FieldElement, Vector

if TYPE_CHECKING:
    from symflex.algebra import Ring
    from symflex.equations import ConstantFunction
    from symflex.expressions import Expression
    from symflex.model import Model

Combination = tuple[tuple["Expression", FieldElement], ...]
"""A sum of quantities of the model, each with its coefficient."""


@dataclass(frozen=True, slots=True)
class State:
    """One state."""

    name: str  # letters, digits and underscores; ``x_tip_dot`` for the derivative of ``x_tip``
    # What it is: ``s*x_tip``; or a sum of such quantities, inputs among them. ``name.partial`` is the partial
    # state of a filter: what drives it over its denominator.
    terms: Combination
    unit: str  # SI unit, empty when unknown


@dataclass(frozen=True, slots=True)
class Channel:
    """An input or output."""

    name: str
    unit: str


@dataclass(frozen=True, eq=False)
class StateSpace:
    """``s w = A w + B u``, ``y = C w + D u``, exact in parameters, pi and functions of constants."""

    model: Model  # where it comes from; its parameters may have been replaced by numbers
    ring: Ring  # what numerators and denominators of the entries are polynomials of
    constants: tuple[ConstantFunction, ...]  # what the ring's function generators stand for
    # states, inputs and outputs: the names of w, u, y.
    states: tuple[State, ...]
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    # a, b, c and d: the rows of the matrices, without entries that are zero.
    a: tuple[Vector, ...]
    b: tuple[Vector, ...]
    c: tuple[Vector, ...]
    d: tuple[Vector, ...]
    is_minimal: bool = False  # almost everywhere every state is controllable and observable

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.states)

    @property
    def matrices(self) -> tuple[tuple[str, tuple[Vector, ...], tuple[int, int]], ...]:
        """Per matrix its letter, its rows, and how many rows and columns it has."""
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        return (("A", self.a, (n, n)), ("B", self.b, (n, m)), ("C", self.c, (p, n)), ("D", self.d, (p, m)))
