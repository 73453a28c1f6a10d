"""What the tab key completes inside options: transfer functions, parameters, forms, targets.

Input: the option, and the specification that stands on the command line.
Output: words that begin as the one being typed. A specification that cannot be read offers nothing: a shell
that waits for a word is no place for an error. ``symflex roots arm.toml --tf <TAB>`` offers ``X/F``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from click.shell_completion import CompletionItem

from symflex.errors import SymflexError

if TYPE_CHECKING:
    import click

    from symflex.model import Model


def completed(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Return the words that an option may continue with."""
    kind = next((OFFERED[flag] for flag in parameter.opts if flag in OFFERED), None)
    if kind is None:
        return parameter.type.shell_complete(context, parameter, incomplete)
    # An option that still lacks its value ends click's parsing early: the path is then among what is left.
    path = context.params.get("spec") or next(iter(context.args), "")
    return [CompletionItem(word) for word in kind(str(path)) if word.startswith(incomplete)]


def _of_model(names: Callable[[Model], Sequence[str]]) -> Callable[[str], Sequence[str]]:
    """Return what offers names of the model in a file."""

    def offered(path: str) -> Sequence[str]:
        from symflex import pipeline  # the mathematics, which other options do without

        try:
            return names(pipeline.load(path)) if path else ()
        except (SymflexError, OSError):
            return ()

    return offered


def _pairs(model: Model) -> list[str]:
    return [f"{output.name}/{source.name}" for output in model.outputs for source in model.inputs]


def _forms(_: str) -> Sequence[str]:
    from symflex.print.forms import FORMS

    return tuple(FORMS)


def _targets(_: str) -> Sequence[str]:
    from symflex.codegen.exporters import SUMMARIES

    return tuple(SUMMARIES)


_parameters = _of_model(lambda model: [p.name for p in model.parameters])
_assigned = _of_model(lambda model: [f"{p.name}=" for p in model.parameters])

OFFERED: Mapping[str, Callable[[str], Sequence[str]]] = {
    "--tf": _of_model(_pairs),
    "--with": _of_model(_pairs),
    "--gain": _parameters,
    "--sensitivity": _parameters,
    "--set": _assigned,
    "--over": _assigned,
    "--form": _forms,
    "--to": _targets,
}  # what each option offers, of the specification's path; others complete as their types do
