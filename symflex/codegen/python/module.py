"""Transfer functions as one self-contained Python module: for numpy, any library of arrays, or jax.

The same walk makes all of them, from the docstring to the tables at the end. Text of the model stands in them
only as inert strings, whatever it says.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from symflex.codegen.export import MATRIX, Contents, Export, Language, MatrixMember, Member, Outline
from symflex.codegen.module_text import (
    FOLLOWED,
    WIDTH,
    default_value,
    described,
    identifiers,
    inert,
    origin_lines,
    wrapped,
)
from symflex.codegen.program.verify import Verification, double_of
from symflex.codegen.python.dialects import ARRAY_API_DIALECT, JAX_DIALECT, NUMPY_DIALECT, Dialect
from symflex.codegen.python.pieces import BlockText, PrivateText, TracedText, in_pieces, statement
from symflex.model import Model, ModelParameter

LINTS = {  # rules of ruff that modules do not follow, whose names and texts are the model's
    "numpy in pieces": "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100, "
    "ANN001, ANN201, ANN202, N816, PLR0912, PLR0914, PLR1704, PLR2004",
    "numpy": "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100, ANN001, ANN202",
    "traced": "ANN001, ANN201, ANN202, ANN401, B905, E501, E741, N802, N803, N806, N816, PLR0912, PLR0914, "
    "PLR0915, PLR2004, PLW2901, RUF001, RUF002, RUF005, RUF100",
}
LITERAL_WIDTH = 60  # characters of a string literal on one line

MEASURED = (
    "The error is that of the same operations in numpy; another library's rounding differs in the last digit."
)


def python_module(contents: Contents, dialect: Dialect) -> Export:
    """Return a module with a function ``OUT_over_IN(s, *, parameter=default, ...)`` per transfer function."""
    model, members = contents.model, contents.members
    names = identifiers({p.name: p.name for p in model.parameters}, dialect.reserved)
    functions = identifiers({m.tf.name: m.wanted for m in members if not m.is_response}, dialect.reserved)
    at = {m.tf.name: f"{functions[m.tf.name]}_at" for m in members if m.is_response}
    responses = identifiers(at, {*dialect.reserved, *functions.values()})
    values = {p.name: double_of(p.value) for p in model.parameters if p.value is not None}
    blocks, code, solving = [parameter_table(model, names)], "", None
    for member in members:
        public = (responses if member.is_response else functions)[member.tf.name]
        owner = public if member.program.is_real else functions[member.tf.name]
        private: PrivateText = (
            TracedText(in_pieces(member.program), owner, names, values, dialect)
            if dialect.is_traced
            else BlockText(member.program, owner, names, values, dialect)
        )
        function = _Function(member, public, private)
        # A response in complex arithmetic calls what the function of s calls.
        private_functions = "\n".join(private.functions() if owner == public else [])
        blocks.append("\n\n\n".join(filter(None, (function.head(), private_functions))) + "\n")
        code += "\n".join([*function.body(), private_functions, ""])
        if isinstance(private, BlockText) and private.program.network is not None:
            solving = private.network(private.program.network)
    if solving is not None:
        # Functions of one model solve the same network.
        blocks.append("\n".join([*solving, ""]))
        code += blocks[-1]
    if contents.matrix is not None:
        taken = {*dialect.reserved, *functions.values(), *responses.values()}
        (name,) = identifiers({"": MATRIX}, taken).values()
        printed = _matrix(contents.matrix, name, functions, names, values, dialect)
        blocks += printed
        code += "\n".join(printed)
    blocks += dialect.support(code)
    blocks.append(function_table("TRANSFER_FUNCTIONS", functions))
    is_piecewise = not all(member.program.is_lumped for member in members)
    if is_piecewise:
        blocks.append(function_table("FREQUENCY_RESPONSES", responses))
    text = header(dialect.first, model, contents.verified[: len(functions)], dialect.remark)
    lints = LINTS["traced" if dialect.is_traced else "numpy in pieces" if is_piecewise else "numpy"]
    start = f"{text}# ruff: noqa: {lints}  (names and texts are the model's)\n\n"
    return Export(start + f"from __future__ import annotations\n\n{dialect.imports}\n" + "\n\n".join(blocks))


@dataclass(frozen=True)
class _Function:
    """Prints what a user calls for one transfer function."""

    member: Member
    name: str
    private: PrivateText

    @property
    def variable(self) -> str:
        return self.private.omega if self.member.is_response else "s"

    def head(self) -> str:
        """Return the function."""
        dialect, names = self.private.dialect, self.private.parameters
        parameters = self.member.parameters
        lines = [f"def {self.name}(", f"    {self.variable}: {dialect.argument},"]
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
        given = [self.variable, *(private.parameters[p.name] for p in self.member.parameters)]
        converter = "_real_numbers" if self.member.is_response else "_numbers"
        made = f"{converter}({private.leading}{', '.join(given)})"
        lines = statement(f"{private.leading}arguments", made, "    ")
        if self.member.is_response and not self.member.program.is_real:
            lines.append("    arguments = [1j * arguments[0], *arguments[1:]]")
        return [*lines, *private.call()]

    def _docstring(self) -> str:
        dialect, names = self.private.dialect, self.private.parameters
        array, is_response = dialect.array, self.member.is_response
        lines = OUTLINE.about(self.member)
        kind, what = ("float", "Angular frequency") if is_response else ("complex", "Laplace variable")
        lines += ["    Parameters", "    ----------", f"    {self.variable} : {array} of {kind}"]
        lines.append(f"        {what} [rad/s]; it and all parameters are broadcast together.")
        for parameter in self.member.parameters:
            lines += parameter_entry(parameter, names[parameter.name], array)
        if dialect.is_argument:
            lines.append(f"    {dialect.space} : module, optional")
            lines.append("        Library of arrays; by default that of the arguments.")
        kind, sentence = dialect.returned
        lines += ["", "    Returns", "    -------", f"    {kind}", f"        {sentence}"]
        lines += ["", "    Notes", "    -----", *origin(self.member.tf.model, "    ")]
        notes = [self.member.verification.text(), *([MEASURED] if dialect.is_traced else [])]
        if self.member.program.minors:
            notes.append(FOLLOWED)
        for note in notes:
            lines += wrapped(inert(note), WIDTH, "    ")
        return docstring(lines, "    ")


def _matrix(
    matrix: MatrixMember,
    name: str,
    functions: Mapping[str, str],
    names: Mapping[str, str],
    values: Mapping[str, Any],
    dialect: Dialect,
) -> list[str]:
    """Return the function of all entries, and what it calls: those of single entries, or its own."""
    rows, columns = matrix.shape
    parameters = [names[p.name] for p in matrix.parameters]
    lines = [f"def {name}(", f"    s: {dialect.argument},"]
    lines += ["    *,"] if parameters or dialect.is_argument else []
    for parameter in matrix.parameters:
        value = default_value(parameter)
        lines.append(f"    {names[parameter.name]}: {dialect.argument}{f' = {value}' if value else ''},")
    lines += [f"    {dialect.space}: {dialect.argument} = None,"] if dialect.is_argument else []
    lines.append(f") -> {dialect.result}:")
    said = [matrix.headline, "", "Parameters are those of its functions.", "", "Returns", "-------"]
    said += [dialect.returned[0], f"    Of shape ({rows}, {columns}) followed by that of all arguments."]
    if matrix.verification is not None:
        said += ["", "Notes", "-----", *wrapped(inert(matrix.verification.text()), WIDTH - 4)]
    lines += [docstring([f"    {line}" for line in said], "    ").rstrip("\n")]
    if matrix.program is None:
        for member in matrix.each:
            given = [f"{names[p.name]}={names[p.name]}" for p in member.parameters]
            given += [f"{dialect.space}={dialect.space}"] if dialect.is_argument else []
            call = f"{functions[member.tf.name]}({', '.join(['s', *given])}),"
            lines += ["    values = ["] if member is matrix.each[0] else []
            lines.append(f"        {call}")
        space = f"{dialect.space}, " if dialect.is_argument else ""
        stacked = f"_stacked({space}values, {rows}, {columns})"
        return ["\n".join([*lines, "    ]", *statement("return", stacked, "    "), ""])]
    text = BlockText(matrix.program, name, names, values, dialect)
    given = [names[p] for p in matrix.program.parameters]
    lines += statement("arguments", f"_numbers({', '.join(['s', *given])})", "    ")
    value = f"_matrix_in_blocks(_value_of_{name}, arguments, {rows}, {columns})"
    lines += ['    with np.errstate(all="ignore"):', *statement("return", value, "        "), ""]
    return ["\n".join(lines), "\n".join([*text.matrix(), ""])]


def header(first: str, model: Model, verified: Sequence[Verification], remark: str = "") -> str:
    """Return a module's docstring: a first line, origin, the verified error of every function, a remark."""
    written = "Written by symflex. Each function evaluates OUT/IN at the Laplace variable s [rad/s]."
    lines = [*OUTLINE.heading(first, model, [written]), *([""] if verified else [])]
    for verification in verified:
        lines += wrapped(inert(f"{verification.name}: {verification.text()}"), WIDTH, "", "    ")
    text = docstring(lines, "")
    return text.rstrip().removesuffix('"""') + f'\n{remark}"""\n' if remark else text


def origin(model: Model, indent: str) -> list[str]:
    """Return lines that tell title and source of a model, and an empty one if there are any."""
    return [f"{indent}{line}" for line in origin_lines(model, WIDTH - len(indent))]


def docstring(lines: Sequence[str], indent: str) -> str:
    """Return lines, which contain no double quote, as a docstring, raw when a backslash is in them."""
    text = "\n".join(line.rstrip() for line in lines)
    return f'{indent}{"r" if chr(92) in text else ""}"""{text.lstrip()}\n{indent}"""\n'


def parameter_entry(parameter: ModelParameter, name: str, kind: str) -> list[str]:
    """Return what a docstring says of a parameter."""
    first = f"    {name} : {kind}{'' if parameter.value is None else ', optional'}"
    return [first, *wrapped(described(parameter, name), WIDTH, "        ")]


def row_of_table(opening: str, entries: Sequence[str]) -> list[str]:
    """Return a dictionary within a table, on one line where it fits."""
    one_line = f"    {opening}{{{', '.join(entries)}}},"
    if len(one_line) <= WIDTH and "\n" not in one_line:
        return [one_line]
    return [f"    {opening}{{", *(f"        {entry}," for entry in entries), "    },"]


def parameter_table(model: Model, names: Mapping[str, str]) -> str:
    """Return the dictionary of all parameters: value, unit and description."""
    lines = ["PARAMETERS: dict[str, dict[str, float | str | None]] = {"]
    for parameter in model.settable:
        entries = [
            f'"value": {default_value(parameter) or None}',
            f'"unit": {literal(parameter.unit)}',
            f'"doc": {literal(parameter.doc)}',
        ]
        lines += row_of_table(f'"{names[parameter.name]}": ', entries)
    return "\n".join([*lines, "}"] if model.parameters else [lines[0] + "}"]) + "\n"


def function_table(name: str, functions: Mapping[str, str]) -> str:
    """Return a dictionary of functions by the names of what they compute."""
    rows = OUTLINE.function_rows(functions)
    return "\n".join([f"{name} = {{", *rows, "}"] if rows else [f"{name} = {{}}"]) + "\n"


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


OUTLINE = Outline(WIDTH, literal)

NUMPY = Language(
    ".py",
    "numpy module, one function per transfer function, verified against ball arithmetic",
    partial(python_module, dialect=NUMPY_DIALECT),
    is_open=True,
    is_complex=True,
    has_real=True,
    shares=True,
)
ARRAY_API = Language(
    ".py",
    "the same for the array library of the arguments: numpy, torch, jax.numpy, cupy",
    partial(python_module, dialect=ARRAY_API_DIALECT),
)
JAX = Language(
    ".py", "the same for jax: jit, grad and vmap work through it", partial(python_module, dialect=JAX_DIALECT)
)
