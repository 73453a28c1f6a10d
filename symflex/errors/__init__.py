"""Positions, diagnostics and the exceptions every other room raises."""

from symflex.errors.diagnostic import Diagnostic, Source, Span, Text, nearest
from symflex.errors.exceptions import (
    BudgetError,
    DataError,
    FitError,
    InternalError,
    ModelError,
    SpecError,
    SymflexError,
    UncertifiedError,
    UsageError,
)

__all__ = [
    "BudgetError",
    "DataError",
    "Diagnostic",
    "FitError",
    "InternalError",
    "ModelError",
    "Source",
    "Span",
    "SpecError",
    "SymflexError",
    "Text",
    "UncertifiedError",
    "UsageError",
    "nearest",
]
