"""What models are made of: elements, blocks and field theories, and what these may be given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Collection

Sign = Literal["any", "nonnegative", "positive"]


class Stateless:
    """What its class alone tells: copies of it are equal."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other)

    def __hash__(self) -> int:
        return hash(type(self))


@dataclass(frozen=True, slots=True)
class ParameterPort:
    """A value an element or block takes."""

    name: str  # the key
    unit: str  # its SI unit; empty when it depends on the ports (see :meth:`Element.unit_of`)
    doc: str  # what it is, in the words of an error message: "a mass", "a torque constant"
    default: str | None = None  # the expression used when the key is missing; ``None`` makes the key required
    signal: bool = False  # true when the value may be an expression of signals, inputs and nodes
    # Values of the element's choices with which the key may be given; empty when with all of them.
    only: tuple[str, ...] = ()
    # What the value must be: ``any``, ``nonnegative`` or ``positive``; of distributed elements, told as far
    # as values and assumptions tell. A distributed element's length is always positive.
    sign: Sign = "any"
    # An angle from the x axis, which enters by its cosine and sine: the element is given both as values
    # ``cos`` and ``sin``, and their products ``cos_cos`` and ``cos_sin``.
    is_direction: bool = False
    varies: bool = False  # true when the value may vary along x, from 0 at the first end
    of: tuple[str, ...] = ()  # the parameters whose product it is, and in place of which it may be given

    def applies(self, chosen: Collection[str]) -> bool:
        """Tell whether the key may be given with the chosen values."""
        return not self.only or any(value in self.only for value in chosen)
