"""What functions of constants print as."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symflex.expressions import Expression
    from symflex.transfer import TransferFunction


def constant_symbols(tf: TransferFunction) -> dict[str, Expression]:
    """Return what the generators of functions of constants print as."""
    return {c.generator: c.expression for c in tf.constants}
