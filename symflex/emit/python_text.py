"""What all generated Python modules share: names that are taken, docstrings, literals, parameters."""

from __future__ import annotations

import keyword
from typing import TYPE_CHECKING

from symflex.emit.module_text import default_value, origin_lines
from symflex.emit.numpy_expression import WIDTH

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.model import Model

LITERAL_WIDTH = 60

RESERVED = frozenset({*keyword.kwlist, "np", "s", "arguments", "complex", "ArrayLike", "NDArray"})
"""Names a parameter cannot take in the generated code."""


def origin(model: Model, indent: str) -> list[str]:
    """Return the lines with title and source."""
    lines = [f"{indent}{line}" for line in origin_lines(model, WIDTH - len(indent))]
    return [*lines, ""] if lines else []


def docstring(lines: Sequence[str], indent: str) -> str:
    """Return lines, which hold no double quote, as a docstring, raw when a backslash is in them."""
    text = "\n".join(line.rstrip() for line in lines)
    return f'{indent}{"r" if chr(92) in text else ""}"""{text.lstrip()}\n{indent}"""\n'


def parameter_table(model: Model, names: Mapping[str, str]) -> str:
    """Return the dictionary of parameters, by the identifiers they have."""
    lines = ["PARAMETERS: dict[str, dict[str, float | str | None]] = {"]
    for parameter in model.parameters:
        entries = [
            f'"value": {default_value(parameter) or None}',
            f'"unit": {literal(parameter.unit)}',
            f'"doc": {literal(parameter.doc)}',
        ]
        one_line = f'    "{names[parameter.name]}": {{{", ".join(entries)}}},'
        if len(one_line) <= WIDTH and "\n" not in one_line:
            lines.append(one_line)
        else:
            inside = [f"        {entry}," for entry in entries]
            lines += [f'    "{names[parameter.name]}": {{', *inside, "    },"]
    return "\n".join([*lines, "}"] if model.parameters else [lines[0] + "}"]) + "\n"


def literal(text: str) -> str:
    """Return a string literal, in pieces on lines of their own when it is long; only printable characters."""
    pieces = [text[i : i + LITERAL_WIDTH] for i in range(0, len(text), LITERAL_WIDTH)] or [""]
    quoted = ['"' + "".join(_character(c) for c in piece) + '"' for piece in pieces]
    if len(quoted) == 1:
        return quoted[0]
    return "(\n" + "".join(f"            {q}\n" for q in quoted) + "        )"


def _character(c: str) -> str:
    if c in '"\\':
        return f"\\{c}"
    return c if c.isprintable() else c.encode("unicode_escape").decode("ascii")
