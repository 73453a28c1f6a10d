"""Transfer functions: derived exactly, reduced, named, and bound to numbers."""

from symflex.transfer.bind import (
    BoundTransferFunction,
    EnclosedTransferFunction,
    Given,
    bind,
    bind_polynomials,
    coefficients_in_s,
)
from symflex.transfer.derive import derive, derive_all
from symflex.transfer.nested import nested_transfer
from symflex.transfer.transfer_function import ClosedForm, HiddenFactor, TransferFunction

__all__ = [
    "BoundTransferFunction",
    "ClosedForm",
    "EnclosedTransferFunction",
    "Given",
    "HiddenFactor",
    "TransferFunction",
    "bind",
    "bind_polynomials",
    "coefficients_in_s",
    "derive",
    "derive_all",
    "nested_transfer",
]
