"""Closed-form transfer functions of flexible electromechanical systems, with their poles and zeros proved.

Examples
--------
>>> import symflex
>>> model = symflex.loads('''
... symflex = 1
... [parameters]
... m = "2 kg"
... k = "8 N/m"
... [elements]
... body = { type = "mass", at = "x", m = "m" }
... wall = { type = "spring", between = ["x", "ground"], k = "k" }
... [inputs]
... F = { force = "x" }
... [outputs]
... X = "x"
... ''')
>>> G = model.transfer_function("X", "F")
>>> str(G.form("polynomial"))
'X/F = 1/(m*s^2 + k)'
>>> [complex(p) for p in G.bind().poles()]
[2j, -2j]
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symflex.api import (
        BoundNestedTransferFunction,
        BoundTransferFunction,
        Fit,
        FittedParameters,
        Form,
        MeasuredResponse,
        Model,
        ModeShape,
        NestedTransferFunction,
        Residue,
        Root,
        Sensitivity,
        Stability,
        StateSpace,
        TransferFunction,
        WrittenReport,
        fit,
        from_control,
        from_matrices,
        load,
        loads,
        read_measurement,
        write_report,
    )
    from symflex.api.transfer_matrix import BoundTransferMatrix, TransferMatrix
    from symflex.budget import Budget
    from symflex.errors import SymflexError

__version__ = "1.0.0"

__all__ = [
    "BoundNestedTransferFunction",
    "BoundTransferFunction",
    "BoundTransferMatrix",
    "Budget",
    "Fit",
    "FittedParameters",
    "Form",
    "MeasuredResponse",
    "ModeShape",
    "Model",
    "NestedTransferFunction",
    "Residue",
    "Root",
    "Sensitivity",
    "Stability",
    "StateSpace",
    "SymflexError",
    "TransferFunction",
    "TransferMatrix",
    "WrittenReport",
    "__version__",
    "fit",
    "from_control",
    "from_matrices",
    "load",
    "loads",
    "read_measurement",
    "write_report",
]

_ELSEWHERE = {
    "Budget": "symflex.budget",
    "BoundTransferMatrix": "symflex.api.transfer_matrix",
    "SymflexError": "symflex.errors",
    "TransferMatrix": "symflex.api.transfer_matrix",
}
"""Modules of the public names that are not in ``symflex.api``."""


def __dir__() -> list[str]:
    """List the public names, imported or not."""
    return list(__all__)


def __getattr__(name: str) -> object:
    """Import a public name when it is first used: the command line starts without numpy and SymPy."""
    if name in __all__:
        return getattr(import_module(_ELSEWHERE.get(name, "symflex.api")), name)
    message = f"module 'symflex' has no attribute '{name}'"
    if name == "derivation_cache":
        message += ": symflex no longer caches derivations on disk; leave it out"
    raise AttributeError(message)


def load_ipython_extension(shell: object) -> None:
    """Make the cell magic ``%%symflex`` known to a notebook, by ``%load_ext symflex``."""
    from symflex.api.magic import register

    register(shell)
