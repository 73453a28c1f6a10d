"""The exception family. Each class carries the command line's exit code."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar, Final

from symflex.errors.diagnostic import Diagnostic, nearest


class SymflexError(Exception):
    """Base class of all errors that symflex raises on purpose.

    Parameters
    ----------
    *diagnostics : Diagnostic
        Everything that is wrong, in the order of the text.

    Examples
    --------
    >>> str(SymflexError(Diagnostic("SF901", "no such file")))
    'error[SF901]: no such file'
    """

    exit_code: ClassVar[int] = 3

    def __init__(self, *diagnostics: Diagnostic) -> None:
        super().__init__(*diagnostics)
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        """Return all diagnostics, rendered one after the other."""
        return "\n".join(d.render() for d in self.diagnostics)


class UsageError(SymflexError):
    """A command or call asks for something that does not exist."""

    exit_code = 2


def refused(message: str, hint: str | None = None) -> UsageError:
    """Return SF902, the refusal of an argument or option."""
    return UsageError(Diagnostic("SF902", message, None, hint))


def no_such(what: str, name: str, known: Iterable[str], listed: str = "") -> UsageError:
    """Return SF902 for a name that is not known, with the nearest that is, or all of them."""
    hint = nearest(name, known) or f"{listed or f'{what}s'}: {', '.join(known)}"
    return refused(f"there is no {what} '{name[:64]}'", hint)


class SpecError(SymflexError):
    """A text is not a valid specification."""

    exit_code = 3


class ModelError(SymflexError):
    """A well-formed specification describes no solvable model."""

    exit_code = 3


class DataError(SymflexError):
    """A data file does not hold what it should."""

    exit_code = 3


class FitError(SymflexError):
    """Measured data and a model do not come together: no result is worth returning."""

    exit_code = 4


class UncertifiedError(SymflexError):
    """A result could not be proved."""

    exit_code = 4


class BudgetError(SymflexError):
    """A limit on time, memory or size was exceeded.

    Parameters
    ----------
    *diagnostics : Diagnostic
        What was exceeded.
    found : object, optional
        What was proved until then: of a search for roots a ``PoleZeroMap``.
    """

    exit_code = 5

    def __init__(self, *diagnostics: Diagnostic, found: object = None) -> None:
        super().__init__(*diagnostics)
        self.found = found


REPORT: Final = "this is a bug in symflex, not in your model: please report it with the specification"
"""The hint of every internal error."""


class InternalError(SymflexError):
    """A result does not stand up to a check that symflex makes of itself; it is a fault of symflex."""

    exit_code = 1
