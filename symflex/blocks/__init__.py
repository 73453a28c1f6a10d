"""Blocks usable as factors in expressions. A new block is one class and one line in ``BLOCKS``."""

from symflex.blocks.block import Block, BlockParameter
from symflex.blocks.library import Integrator, LeadLag, Pid, Resonance, TransferFunctionBlock

BLOCKS: dict[str, Block] = {
    block.type_name: block for block in (Resonance(), TransferFunctionBlock(), Integrator(), LeadLag(), Pid())
}

MODEL_BLOCK = "model"
"""The block that stands for another specification's transfer function; resolved by the model room."""

ANNOUNCED = ("delay",)
"""Block types of the specification language that a later version will bring."""

__all__ = ["ANNOUNCED", "BLOCKS", "MODEL_BLOCK", "Block", "BlockParameter"]
