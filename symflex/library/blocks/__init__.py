"""Blocks usable as factors in expressions. A new block is one class and one line in ``BLOCKS``."""

from symflex.library.blocks.library import (
    Block,
    Delay,
    Integrator,
    Lag,
    LeadLag,
    Pid,
    Resonance,
    TransferFunctionBlock,
)

BLOCKS: dict[str, Block] = {
    block.type_name: block
    for block in (
        Resonance(),
        TransferFunctionBlock(),
        Integrator(),
        LeadLag(),
        Lag(),
        Pid(),
        Delay(),
    )
}

MODEL_BLOCK = "model"
"""The block that stands for another specification's transfer function; resolved by the model room."""

__all__ = ["BLOCKS", "MODEL_BLOCK", "Block"]
