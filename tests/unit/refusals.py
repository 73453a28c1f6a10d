"""How something is refused, for tests that try many values and name those that were not."""

from symflex.errors import SymflexError


def refusal(call, *given, **named):
    """Return the kind and the code of the error that a call raises, as in "UsageError SF902"; "" for none."""
    try:
        call(*given, **named)
    except SymflexError as error:
        return f"{type(error).__name__} {error.diagnostics[0].code}"
    return ""
