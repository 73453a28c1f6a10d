"""What an input may be: an effort delivered into a node, or what the node is made to follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.library.elements import THROUGH_NAME, Variable

if TYPE_CHECKING:
    from symflex.library.elements import Domain


@dataclass(frozen=True, slots=True)
class InputKind:
    """An input that acts on nodes."""

    domain: Domain  # of the nodes
    unit: str  # SI unit of the input
    # Of an input that nodes follow, ``s^order * node = input``; ``None`` of one delivered into them.
    order: int | None = None

    @property
    def quantity(self) -> str:
        """The name of what an imposed input has to deliver: ``f``, ``tau`` or ``i``."""
        return THROUGH_NAME[self.domain]

    @property
    def effort(self) -> str:
        """The kind that delivers into the same nodes."""
        return next(
            k for k, kind in INPUT_KINDS.items() if kind.domain == self.domain and not kind.is_imposed
        )

    @property
    def is_imposed(self) -> bool:
        """Whether nodes follow it."""
        return self.order is not None

    def delivered(self, name: str) -> Variable:
        """Return the unknown that an imposed input of this name delivers.

        An element may bear the input's name: its own quantities are called otherwise.
        """
        return Variable("through", name, "supplied" if self.quantity == "i" else f"supplied_{self.quantity}")


INPUT_KINDS: dict[str, InputKind] = {
    "force": InputKind("translation", "N"),
    "torque": InputKind("rotation", "N*m"),
    "current": InputKind("electrical", "A"),
    "voltage": InputKind("electrical", "V", 0),
    "displacement": InputKind("translation", "m", 0),
    "velocity": InputKind("translation", "m/s", 1),
    "acceleration": InputKind("translation", "m/s^2", 2),
    "angle": InputKind("rotation", "rad", 0),
    "angular_velocity": InputKind("rotation", "rad/s", 1),
    "angular_acceleration": InputKind("rotation", "rad/s^2", 2),
}
"""Every kind but a free signal, which acts on no node."""
