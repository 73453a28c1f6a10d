"""Transfer functions as one self-contained Python module: for numpy, any library of arrays, or jax.

Input: the contents of a module, and the dialect it is written in.
Output: its text. The same walk makes all of them, from the docstring to the tables at the end. Text of the
model stands in them only as inert strings, whatever it says.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from symflex.codegen.export import Export, Language
from symflex.codegen.module_text import (
    COST,
    ITERATED,
    default_value,
    described,
    formula_lines,
    headline,
    origin_lines,
)
from symflex.codegen.program.evaluate import nearest_double
from symflex.codegen.program.user_text import identifiers, inert, wrapped
from symflex.codegen.python.dialects import ARRAY_API_DIALECT, JAX_DIALECT, NUMPY_DIALECT
from symflex.codegen.python.expression import WIDTH, statement
from symflex.codegen.python.pieces import BlockText, TracedText

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from symflex.codegen.export import Contents, Member
    from symflex.codegen.program.verify import Verification
    from symflex.codegen.python.dialects import Dialect
    from symflex.codegen.python.pieces import PrivateText
    from symflex.model import Model


LINTS = {
    "numpy in pieces": "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100, "
    "ANN001, ANN201, ANN202, N816, PLR0912, PLR0914, PLR1704, PLR2004",
    "numpy": "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100, ANN001, ANN202",
    "traced": "ANN001, ANN201, ANN202, ANN401, B905, E501, E741, N802, N803, N806, N816, PLR0912, PLR0914, "
    "PLR0915, PLR2004, PLW2901, RUF001, RUF002, RUF005, RUF100",
}
"""Rules of ruff that modules do not follow, whose names and texts are the model's."""

LITERAL_WIDTH = 60
"""Characters of a string literal on one line."""

MEASURED = (
    "The error is that of the same operations in numpy; another library's rounding differs in the last digit."
)


def python_module(contents: Contents, dialect: Dialect) -> Export:
    """Return a module with one function ``OUT_over_IN(s, *, parameter=default, ...)`` per transfer function.

    Dialects without branches on values evaluate what is not selected where it is regular, so that derivatives
    are finite.
    """
    model, members = contents.model, contents.members
    names = identifiers({p.name: p.name for p in model.parameters}, dialect.reserved)
    functions, responses = public_names(members, dialect.reserved)
    values = {
        p.name: nearest_double(p.value.rational, p.value.pi_power)
        for p in model.parameters
        if p.value is not None
    }
    blocks, code = [parameter_table(model, names)], ""
    for member in members:
        public = (responses if member.program.is_real else functions)[member.tf.name]
        made = TracedText if dialect.is_traced else BlockText
        private = made(member.program, public, names, values, dialect)
        function = _Function(member, private, member.verification.text(contents.digits))
        own = "\n".join(private.functions())
        blocks.append(f"{function.head()}\n\n\n{own}\n")
        code += "\n".join([*function.body(), own, ""])
    blocks += dialect.support(code)
    blocks.append(function_table("TRANSFER_FUNCTIONS", functions))
    is_piecewise = not all(member.program.is_lumped for member in members)
    if is_piecewise:
        blocks.append(function_table("FREQUENCY_RESPONSES", responses))
    text = header(dialect.first, model, contents.verified[: len(functions)], contents.digits, dialect.remark)
    lints = LINTS["traced" if dialect.is_traced else "numpy in pieces" if is_piecewise else "numpy"]
    start = f"{text}# ruff: noqa: {lints}  (names and texts are the model's)\n\n"
    imports = f"from __future__ import annotations\n\n{dialect.imports}\n"
    return Export(start + imports + "\n\n".join(blocks))


@dataclass(frozen=True)
class _Function:
    """Prints what a user calls for one transfer function."""

    member: Member
    private: PrivateText
    sentence: str

    def head(self) -> str:
        """Return the function."""
        dialect, names = self.private.dialect, self.private.parameters
        parameters = self.member.tf.parameters
        lines = [f"def {self.private.name}(", f"    {self.private.variable}: {dialect.argument},"]
        lines += ["    *,"] if parameters or dialect.is_argument else []
        for parameter in parameters:
            value = default_value(parameter)
            default = f" = {value}" if value else ""
            lines.append(f"    {names[parameter.name]}: {dialect.argument}{default},")
        lines += [f"    {dialect.space}: {dialect.argument} = None,"] if dialect.is_argument else []
        lines += [f") -> {dialect.result}:", self._docstring().rstrip("\n")]
        return "\n".join([*lines, *self.body()])

    def body(self) -> list[str]:
        """Return its statements."""
        private = self.private
        given = [private.variable, *(private.parameters[p.name] for p in self.member.tf.parameters)]
        converter = "_real_numbers" if self.member.program.is_real else "_numbers"
        made = f"{converter}({private.leading}{', '.join(given)})"
        return [*statement(f"{private.leading}arguments", made, "    "), *private.call()]

    def _docstring(self) -> str:
        dialect, program, tf, names = (
            self.private.dialect,
            self.member.program,
            self.member.tf,
            self.private.parameters,
        )
        array, is_real = dialect.array, program.is_real
        lines = [headline(tf, is_real=is_real), ""]
        lines += [f"    {line}" if line else "" for line in formula_lines(tf, WIDTH - 4)]
        kind, what = ("float", "Angular frequency") if is_real else ("complex", "Laplace variable")
        lines += ["", "    Parameters", "    ----------", f"    {self.private.variable} : {array} of {kind}"]
        lines.append(f"        {what} [rad/s]; it and all parameters are broadcast together.")
        for parameter in tf.parameters:
            name = names[parameter.name]
            lines.append(f"    {name} : {array}{'' if parameter.value is None else ', optional'}")
            lines += wrapped(described(parameter, name), WIDTH, "        ")
        if dialect.is_argument:
            lines.append(f"    {dialect.space} : module, optional")
            lines.append("        Library of arrays; by default that of the arguments.")
        kind, sentence = dialect.returned
        lines += ["", "    Returns", "    -------", f"    {kind}", f"        {sentence}"]
        lines += ["", "    Notes", "    -----", *origin(tf.model, "    ")]
        notes = [self.sentence, *([MEASURED] if dialect.is_traced else [])]
        if program.solves:
            notes.append(ITERATED if dialect.is_traced and program.finds_roots else COST)
        for note in notes:
            lines += wrapped(inert(note), WIDTH, "    ")
        return docstring(lines, "    ")


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


NUMPY = Language(
    ".py",
    "numpy module, one function per transfer function, verified against ball arithmetic",
    partial(python_module, dialect=NUMPY_DIALECT),
)
ARRAY_API = Language(
    ".py",
    "the same for numpy, torch, jax.numpy, cupy: whatever library the arguments are of",
    partial(python_module, dialect=ARRAY_API_DIALECT),
)
JAX = Language(
    ".py",
    "the same for jax: jit, grad and vmap work through it",
    partial(python_module, dialect=JAX_DIALECT),
)
