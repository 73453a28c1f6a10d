"""The classes a user meets: thin faces over the pipeline, with SymPy and mpmath at the surface."""

from symflex.api.bound import BoundTransferFunction
from symflex.api.fitted import Fit, fit
from symflex.api.form import Form
from symflex.api.mode_shape import ModeShape
from symflex.api.model import Model, Table, load, loads
from symflex.api.nested import NestedTransferFunction
from symflex.api.report import WrittenReport, write_report
from symflex.api.residue import Residue
from symflex.api.root import Mode, Root
from symflex.api.sensitivity import Sensitivity
from symflex.api.stability import Stability, StabilityBoundary
from symflex.api.state_space import StateSpace
from symflex.api.transfer_function import Number, TransferFunction

__all__ = [
    "BoundTransferFunction",
    "Fit",
    "Form",
    "Mode",
    "ModeShape",
    "Model",
    "NestedTransferFunction",
    "Number",
    "Residue",
    "Root",
    "Sensitivity",
    "Stability",
    "StabilityBoundary",
    "StateSpace",
    "Table",
    "TransferFunction",
    "WrittenReport",
    "fit",
    "load",
    "loads",
    "write_report",
]
