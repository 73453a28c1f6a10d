"""The model a specification describes: names, nodes, units and values resolved, with exact parameters."""

from symflex.model.model import (
    Analysis,
    ContactPort,
    Definition,
    DrawingHints,
    ExactValue,
    FieldProblem,
    Figure,
    Input,
    Model,
    ModelParameter,
    NetworkNode,
    NodeReference,
    Output,
    PlacedBlock,
    PlacedElement,
    PrintedRow,
    PrintedTable,
    Published,
    Signal,
)
from symflex.model.resolve import load_model, load_with, resolve
from symflex.model.scope import ModelScope, scope_of
from symflex.model.settings import Setting, read_settings, spread_box, with_numbers
from symflex.model.signs import check_value
