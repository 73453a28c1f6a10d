"""The classes a user meets: thin faces over the pipeline, with SymPy and mpmath at the surface."""

from symflex.api.fitted import Fit, FittedParameters, fit
from symflex.api.mode_shape import ModeShape
from symflex.api.model import Model, Table, load, loads
from symflex.api.report import WrittenReport, write_report
from symflex.api.response import MeasuredResponse, read_measurement
from symflex.api.root import Mode, Residue, Root, Sensitivity
from symflex.api.stability import Stability, StabilityBoundary
from symflex.api.state_space import StateSpace
from symflex.api.systems import from_control, from_matrices
from symflex.api.transfer_function import (
    BoundNestedTransferFunction,
    BoundTransferFunction,
    Form,
    NestedTransferFunction,
    Number,
    TransferFunction,
)
