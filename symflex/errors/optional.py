"""Libraries that are asked for only where they are needed, and what is said where one is not installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

from symflex.errors.diagnostic import Diagnostic
from symflex.errors.exceptions import UsageError

_LACKING: Final = "needs the library {}, which is not installed"
OPTIONAL: Final = {  # error code, message and how to install, by package
    "control": ("SF902", "{} is not installed", "pip install 'symflex[control]'"),
    "anywidget": ("SF902", "{} is not installed", "pip install 'symflex[notebook]'"),
    "pygls": ("SF902", "{} is not installed", "pip install 'symflex[editor]'"),
    "scipy": ("SF902", "{} is not installed", "pip install scipy"),
    "sympy": ("SF902", "{} is not installed", "pip install sympy"),
    "pyuff": ("SF902", "reading and writing universal files needs {}", "pip install pyuff"),
    "xarray": ("SF914", f"a labelled dataset {_LACKING}", "pip install 'symflex[sweep]'"),
    "pyarrow": ("SF914", f"Parquet {_LACKING}", "pip install 'symflex[sweep]'"),
    "openpyxl": ("SF914", f"a workbook {_LACKING}", "pip install 'symflex[files]'"),
    "h5py": ("SF914", f"an HDF5 file {_LACKING}", "pip install 'symflex[files]'"),
    "nptdms": ("SF914", f"a .tdms file {_LACKING}", "pip install 'symflex[files]'"),
    "distributed": ("SF914", f"a cluster {_LACKING}", "pip install 'symflex[sweep]'"),
}


def installed(module: str) -> Any:  # noqa: ANN401 (these libraries have no types)
    """Return a module of an optional library; SF902 or SF914 where it is not there."""
    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        code, message, hint = OPTIONAL[package]
        raise UsageError(Diagnostic(code, message.format(package), None, hint)) from None
