"""Positions, diagnostics and the exceptions every other package raises."""

from symflex.errors.diagnostic import Diagnostic, Source, Span, Text, counted, nearest
from symflex.errors.exceptions import (
    REPORT,
    BudgetError,
    DataError,
    FitError,
    InternalError,
    ModelError,
    SpecError,
    SymflexError,
    UncertifiedError,
    UsageError,
    no_such,
    refused,
)
