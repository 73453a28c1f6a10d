"""Positions, diagnostics and the exceptions every other room raises."""

from symflex.errors.diagnostic import Diagnostic
from symflex.errors.exceptions import (
    BudgetError,
    DataError,
    FitError,
    ModelError,
    SpecError,
    SymflexError,
    UncertifiedError,
    UsageError,
)
from symflex.errors.source import Source, Span, Text

__all__ = [
    "BudgetError",
    "DataError",
    "Diagnostic",
    "FitError",
    "ModelError",
    "Source",
    "Span",
    "SpecError",
    "SymflexError",
    "Text",
    "UncertifiedError",
    "UsageError",
]
