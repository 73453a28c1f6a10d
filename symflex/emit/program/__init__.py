"""Numeric programs in no language yet: how to compute a transfer function, and how well that works."""

from symflex.emit.program.build import available_forms, build_program
from symflex.emit.program.evaluate import evaluate, nearest_double
from symflex.emit.program.identifiers import identifiers
from symflex.emit.program.nodes import (
    Add,
    Apply,
    Assignment,
    Branch,
    Constant,
    Divide,
    InverseLaplace,
    Laplace,
    Multiply,
    Negate,
    Node,
    Parameter,
    Power,
    Program,
    Reference,
)
from symflex.emit.program.prose import inert, wrapped
from symflex.emit.program.verify import References, Verification, choose_program

__all__ = [
    "Add",
    "Apply",
    "Assignment",
    "Branch",
    "Constant",
    "Divide",
    "InverseLaplace",
    "Laplace",
    "Multiply",
    "Negate",
    "Node",
    "Parameter",
    "Power",
    "Program",
    "Reference",
    "References",
    "Verification",
    "available_forms",
    "build_program",
    "choose_program",
    "evaluate",
    "identifiers",
    "inert",
    "nearest_double",
    "wrapped",
]
