"""Field equations as a first-order system in x."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored

Matrix = tuple[tuple["Factored", ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class FieldSystem:
    """``dz/dx = matrix(s) z + load(s) u``, Laplace-transformed in time.

    Parameters
    ----------
    states : tuple of str
        Names of z. A theory lists its across quantities first and its through quantities after them.
    matrix : tuple of tuple of Factored
        Constant in x, rational in s and the parameters.
    loads : tuple of tuple of Factored
        One column per input that acts all along the field, uniform in x.
    """

    states: tuple[str, ...]
    matrix: Matrix
    loads: Matrix = ()


class FieldTheory(Protocol):
    """A theory: the first-order system of a uniform element.

    A new theory is one function and one line in :data:`symflex.library.fields.FIELDS`.
    """

    def __call__(self, s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
        """Return the field equations for the element's values."""
        ...


def system_of(
    states: tuple[str, ...], entries: Mapping[tuple[str, str], Factored], zero: Factored
) -> FieldSystem:
    """Return a system from its entries that are not zero, named by (derivative, state)."""
    matrix = tuple(tuple(entries.get((row, column), zero) for column in states) for row in states)
    return FieldSystem(states, matrix)
