"""What Python modules made from a model have in common: docstrings, tables of parameters and functions.

Text of the model stands in them only as inert strings, whatever it says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.codegen.module_text import default_value, described, formula_lines, headline, origin_lines
from symflex.codegen.program.identifiers import identifiers
from symflex.codegen.program.prose import inert, wrapped
from symflex.codegen.python.expression import WIDTH

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from symflex.codegen.export import Member
    from symflex.codegen.program.verify import Verification
    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction

LITERAL_WIDTH = 60
"""Characters of a string literal on one line."""


@dataclass(frozen=True, slots=True)
class Signature:
    """What a generated function takes, and what its docstring says about it."""

    variable: str  # identifier of the first argument
    names: Mapping[str, str]  # identifiers of the parameters
    is_real: bool  # true for a response at an angular frequency
    array: str  # what the docstring calls an argument, ``array_like``
    returned: tuple[str, str]  # type of the value, and a sentence about it
    more: tuple[str, ...] = ()  # lines of the docstring about arguments after the parameters


def header(first: str, model: Model, verified: Sequence[Verification], digits: int, remark: str = "") -> str:
    """Return a module's docstring: a first line, origin, the verified error of every function, a remark."""
    lines = [first, "", *origin(model, "")]
    lines.append("Written by symflex. Each function evaluates OUT/IN at the Laplace variable s [rad/s].")
    if verified:
        lines.append("")
    for verification in verified:
        lines += wrapped(inert(f"{verification.name}: {verification.text(digits)}"), WIDTH, "", "    ")
    text = docstring(lines, "")
    return text.rstrip().removesuffix('"""') + f'\n{remark}"""\n' if remark else text


def function_docstring(tf: AnyTransferFunction, signature: Signature, notes: Sequence[str]) -> str:
    """Return the docstring of a transfer function.

    Parameters
    ----------
    tf : TransferFunction
        What the function computes.
    signature : Signature
        Its arguments.
    notes : sequence of str
        Sentences that end it: how far it was verified, and what it costs.
    """
    array, variable = signature.array, signature.variable
    lines = [headline(tf, is_real=signature.is_real), ""]
    lines += [f"    {line}" if line else "" for line in formula_lines(tf, WIDTH - 4)]
    kind = "float" if signature.is_real else "complex"
    lines += ["", "    Parameters", "    ----------", f"    {variable} : {array} of {kind}"]
    what = "Angular frequency" if signature.is_real else "Laplace variable"
    lines.append(f"        {what} [rad/s]; it and all parameters are broadcast together.")
    for parameter in tf.parameters:
        name = signature.names[parameter.name]
        is_needed = parameter.value is None
        lines.append(f"    {name} : {array}{'' if is_needed else ', optional'}")
        lines += wrapped(described(parameter, name), WIDTH, "        ")
    kind, sentence = signature.returned
    lines += [*signature.more, "", "    Returns", "    -------", f"    {kind}"]
    lines.append(f"        {sentence}")
    lines += ["", "    Notes", "    -----"]
    lines += origin(tf.model, "    ")
    for note in notes:
        lines += wrapped(inert(note), WIDTH, "    ")
    return docstring(lines, "    ")


def origin(model: Model, indent: str) -> list[str]:
    """Return lines that tell title and source of a model, and an empty one if there are any."""
    lines = [f"{indent}{line}" for line in origin_lines(model, WIDTH - len(indent))]
    return [*lines, ""] if lines else []


def docstring(lines: Sequence[str], indent: str) -> str:
    """Return lines, which hold no double quote, as a docstring, raw when a backslash is in them."""
    text = "\n".join(line.rstrip() for line in lines)
    return f'{indent}{"r" if chr(92) in text else ""}"""{text.lstrip()}\n{indent}"""\n'


def public_names(
    members: Sequence[Member], reserved: Collection[str]
) -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Return the names of the functions of s, and of the responses, by ``OUT/IN``."""
    of_s = {m.tf.name: m.wanted for m in members if not m.program.is_real}
    functions = identifiers(of_s, reserved)
    on_axis = {m.tf.name: f"{functions[m.tf.name]}_at" for m in members if m.program.is_real}
    return functions, identifiers(on_axis, {*reserved, *functions.values()})


def parameter_table(model: Model, names: Mapping[str, str]) -> str:
    """Return the dictionary of all parameters: value, unit and description."""
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


def function_table(name: str, functions: Mapping[str, str]) -> str:
    """Return a dictionary of functions by the names of what they compute."""
    lines = [f"    {literal(key)}: {function}," for key, function in functions.items()]
    return "\n".join([f"{name} = {{", *lines, "}"] if lines else [f"{name} = {{}}"]) + "\n"


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
