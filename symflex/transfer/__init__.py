"""Transfer functions: derived exactly, reduced, named, and bound to numbers."""

from symflex.transfer.bind import Given, bind, bind_polynomials
from symflex.transfer.bound import BoundTransferFunction, EnclosedTransferFunction, coefficients_in_s
from symflex.transfer.derive import derive, derive_all, nested_transfer
from symflex.transfer.double_value import points_of
from symflex.transfer.nested_form import (
    AnyBoundFunction,
    AnyTransferFunction,
    BoundNested,
    NestedTransferFunction,
    bind_any,
    bind_nested,
    derive_nested,
)
from symflex.transfer.transfer_function import ClosedForm, HiddenFactor, TransferFunction
