"""What an element or a block may be given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Collection

Sign = Literal["any", "nonnegative", "positive"]


@dataclass(frozen=True, slots=True)
class ParameterPort:
    """A value an element or block takes.

    Parameters
    ----------
    name : str
        The key.
    unit : str
        Its SI unit; empty when it depends on the ports (see :meth:`Element.unit_of`).
    doc : str
        What it is, in the words of an error message: "a mass", "a torque constant".
    default : str, optional
        The expression used when the key is missing; ``None`` makes the key required.
    signal : bool
        True when the value may be an expression of signals, inputs and nodes.
    only : tuple of str
        Values of the element's choices with which the key may be given; empty when with all of them.
    sign : str
        What the value must be: ``any``, ``nonnegative`` or ``positive``; of distributed elements, told as
        far as values and assumptions tell. A distributed element's length is always positive.
    """

    name: str
    unit: str
    doc: str
    default: str | None = None
    signal: bool = False
    only: tuple[str, ...] = ()
    sign: Sign = "any"

    def applies(self, chosen: Collection[str]) -> bool:
        """Tell whether the key may be given with the chosen values."""
        return not self.only or any(value in self.only for value in chosen)
