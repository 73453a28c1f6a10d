"""What a specification says that may not be meant: what nothing uses, prints included."""

from __future__ import annotations

from collections.abc import Iterator

from symflex.equations import Equations
from symflex.equations.elimination import is_singular, unreached
from symflex.errors import Diagnostic, SymflexError
from symflex.expressions import Sum
from symflex.model import Model
from symflex.model.unused import unnamed_definitions, unused_name
from symflex.transfer.of_model import NEVER_LARGE, assemble_for_checks, derive_all

FEW_UNKNOWNS = 1_000  # unknowns up to which a dense matrix of numbers takes a quarter of a second
MOST_WARNINGS = 100  # as many as problems, of which a reader stops at as many too


def warnings(model: Model, equations: Equations | None = None) -> tuple[Diagnostic, ...]:
    """Return what a specification says that may not be meant: what nothing uses, what has no effect."""
    try:
        equations = equations or assemble_for_checks(model)
        is_solvable = len(equations.unknowns) <= FEW_UNKNOWNS and not is_singular(equations)
        of_equations = (*unreached(equations), *_unused_definitions(model)) if is_solvable else ()
    except SymflexError:
        of_equations = ()  # what is wrong with the equations is said by what derives
    own = model.outputs[0].span.source if model.outputs[0].span else None

    def place(warning: Diagnostic) -> tuple[bool, str, int]:
        span = warning.span
        return (True, "", 0) if span is None else (span.source is not own, span.source.name, span.start)

    ordered = sorted((*model.warnings, *of_equations), key=place)
    if len(ordered) > MOST_WARNINGS:
        more = f"{len(ordered) - MOST_WARNINGS} more warnings"
        ordered[MOST_WARNINGS:] = [Diagnostic(ordered[MOST_WARNINGS].code, more, severity="warning")]
    return tuple(ordered)


def _unused_definitions(model: Model) -> Iterator[Diagnostic]:
    """Yield the definitions that no expression names, no print shows and no words describe."""
    unnamed = [d for d in unnamed_definitions(model) if not d.doc]
    sums = [d for d in unnamed if isinstance(d.expression, Sum)]
    shown = {d.name for d in sums}
    if sums and not model.is_distributed and len(model.elements) <= NEVER_LARGE:
        from symflex.print.forms import print_forms  # hardly ever needed

        printed, _ = print_forms(derive_all(model), "definitions")
        shown = {name for form in printed for name, _ in form.where}
    yield from (unused_name("definition", d.name, d.span) for d in unnamed if d.name not in shown)
