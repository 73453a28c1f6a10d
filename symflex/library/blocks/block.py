"""What a block is: a transfer function that may stand as a factor in expressions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored


@dataclass(frozen=True, slots=True)
class BlockParameter:
    """A value a block takes: its key, SI unit (empty: any), meaning and default expression."""

    name: str
    unit: str
    doc: str
    default: str | None = None


class Block(ABC):
    """Base of every block. Subclasses are final, stateless and registered in ``BLOCKS``.

    A block with ``kernel_time``, the name of one of its parameters, is ``exp(-s*T)`` of that time; it has a
    generator of its own in the equations, which never call its ``transfer``.
    """

    type_name: ClassVar[str]
    summary: ClassVar[str]
    parameters: ClassVar[tuple[BlockParameter, ...]]
    kernel_time: ClassVar[str] = ""

    @abstractmethod
    def transfer(self, s: Factored, values: Mapping[str, Factored]) -> Factored:
        """Return the block's transfer function for the given values."""
