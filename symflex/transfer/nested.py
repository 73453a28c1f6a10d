"""The transfer function that a ``model`` block stands for, over the ring of the model that uses it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.equations import assemble
from symflex.errors import Diagnostic, ModelError
from symflex.transfer.derive import derive

if TYPE_CHECKING:
    from symflex.algebra import Ring
    from symflex.model import PlacedBlock


def nested_transfer(block: PlacedBlock, ring: Ring) -> Factored:
    """Return the transfer function of a ``model`` block over the outer model's ring.

    Raises
    ------
    ModelError
        SF910 when the block stands for a distributed system.
    """
    if block.submodel is None or block.tf is None:
        message = f"block '{block.name}' holds no model"
        raise ValueError(message)
    tf = derive(assemble(block.submodel, nested_transfer), *block.tf)
    if tf.is_distributed:
        message = f"block '{block.name}' stands for a distributed system, whose kernels cannot be taken over"
        hint = "bring its elements and fields into this file"
        raise ModelError(Diagnostic("SF910", message, block.span, hint))
    inner = tf.ratio
    images = [ring.generator(name) for name in inner.ring.names]
    return inner.map_factors(ring, lambda factor: Factored.polynomial(ring, ring.compose(factor, images)))
