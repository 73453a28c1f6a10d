"""Transfer functions as one self-contained Python module: for numpy, any library of arrays, or jax.

Input: the contents of a module, and the dialect it is written in.
Output: its text. The same walk makes all of them, from the docstring to the tables at the end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from symflex.codegen.export import Export, Language
from symflex.codegen.module_text import COST, ITERATED, default_value
from symflex.codegen.program.evaluate import nearest_double
from symflex.codegen.program.identifiers import identifiers
from symflex.codegen.python.dialects import ARRAY_API_DIALECT, JAX_DIALECT, NUMPY_DIALECT
from symflex.codegen.python.expression import statement
from symflex.codegen.python.pieces import BlockText, TracedText
from symflex.codegen.python.text import (
    Signature,
    function_docstring,
    function_table,
    header,
    parameter_table,
    public_names,
)

if TYPE_CHECKING:
    from symflex.codegen.export import Contents, Member
    from symflex.codegen.python.dialects import Dialect
    from symflex.codegen.python.pieces import PrivateText

LINTS = {
    "numpy in pieces": "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100, "
    "ANN001, ANN201, ANN202, N816, PLR0912, PLR0914, PLR1704, PLR2004",
    "numpy": "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100, ANN001, ANN202",
    "traced": "ANN001, ANN201, ANN202, ANN401, B905, E501, E741, N802, N803, N806, N816, PLR0912, PLR0914, "
    "PLR0915, PLR2004, PLW2901, RUF001, RUF002, RUF005, RUF100",
}
"""Rules of ruff that modules do not follow, whose names and texts are the model's."""

MEASURED = (
    "The error is that of the same operations in numpy; another library's rounding differs in the last digit."
)


def python_module(contents: Contents, dialect: Dialect) -> Export:
    """Return a module with one function ``OUT_over_IN(s, *, parameter=default, ...)`` per transfer function.

    Parameters
    ----------
    contents : Contents
        Programs, verified.
    dialect : Dialect
        Those without branches on values evaluate what is not selected where it is regular, so that
        derivatives are finite.
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
        dialect, program = self.private.dialect, self.member.program
        more = (
            f"    {dialect.space} : module, optional",
            "        Library of arrays; by default that of the arguments.",
        )
        signature = Signature(
            self.private.variable,
            self.private.parameters,
            program.is_real,
            dialect.array,
            dialect.returned,
            more if dialect.is_argument else (),
        )
        notes = [self.sentence, *([MEASURED] if dialect.is_traced else [])]
        if program.solves:
            notes.append(ITERATED if dialect.is_traced and program.finds_roots else COST)
        return function_docstring(self.member.tf, signature, notes)


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
