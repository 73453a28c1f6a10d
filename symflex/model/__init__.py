"""The model a specification describes: names, nodes, units and values resolved, with exact parameters."""

from symflex.model.model import (
    Analysis,
    Definition,
    ExactValue,
    Field,
    Figure,
    Input,
    Model,
    Node,
    NodeReference,
    Output,
    Parameter,
    PlacedBlock,
    PlacedElement,
    Published,
    Signal,
)
from symflex.model.numbers import with_numbers
from symflex.model.ranges import check_value
from symflex.model.resolve import load_model, resolve
from symflex.model.scope import Scope, scope_of

__all__ = [
    "Analysis",
    "Definition",
    "ExactValue",
    "Field",
    "Figure",
    "Input",
    "Model",
    "Node",
    "NodeReference",
    "Output",
    "Parameter",
    "PlacedBlock",
    "PlacedElement",
    "Published",
    "Scope",
    "Signal",
    "check_value",
    "load_model",
    "resolve",
    "scope_of",
    "with_numbers",
]
