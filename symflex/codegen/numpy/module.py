"""Transfer functions as one self-contained Python module that imports numpy only.

Input: transfer functions and the model they come from.
Output: a :class:`NumpyExport`, the module's text and how well each function agrees with ball arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.codegen.members import members_of, verifications
from symflex.codegen.module_text import COST, default_value
from symflex.codegen.numpy.expression import Printer, statement
from symflex.codegen.numpy.pieces import LINTS, PARTS, PiecesText
from symflex.codegen.program import Piecewise, Program, Verification, identifiers
from symflex.codegen.python_text import (
    RESERVED,
    Signature,
    function_docstring,
    function_table,
    header,
    parameter_table,
    public_names,
)
from symflex.codegen.source_parts import called_parts

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction

FIRST = "Transfer functions of a linear system as functions of numpy arrays."

LINTS_OF_NAMES = "E501, E741, N802, N803, N806, PLR0915, RUF001, RUF002, RUF100"
LINTS_OF_BLOCKS = "ANN001, ANN202"

IMPORTS = """\
# ruff: noqa: {lints}  (names and texts are the model's)

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
"""


@dataclass(frozen=True, slots=True)
class NumpyExport:
    """A generated module.

    Parameters
    ----------
    text : str
        The module's source.
    verified : tuple of Verification
        One per transfer function, in the order of the module, then one per frequency response.
    """

    text: str
    verified: tuple[Verification, ...]


def numpy_module(
    tfs: Sequence[AnyTransferFunction],
    model: Model,
    band_hz: tuple[Fraction, Fraction] | None = None,
    *,
    samples: int = 400,
    digits: int = 2,
) -> NumpyExport:
    """Return a module with one function ``OUT_over_IN(s, *, parameter=default, ...)`` per transfer function.

    Lossless distributed systems get a second one, ``OUT_over_IN_at(omega, *, ...)``: the frequency response
    in real arithmetic.

    Each function is checked against ball arithmetic before it is written, and says in its docstring what
    came of it.

    Parameters
    ----------
    tfs : sequence of TransferFunction
        Of ``model``; a transfer function given twice is written once.
    model : Model
        Title, source and parameters.
    band_hz : tuple of Fraction, optional
        Where the error is measured [Hz]; by default the model's ``[analysis]`` band, else 0.1 Hz to 10 kHz.
    samples : int
        Number of frequencies at which it is measured, besides those around poles and zeros.
    digits : int
        Significant digits of the printed error.

    Returns
    -------
    NumpyExport
        The same text on every run. Names that cannot be Python's are altered; text of the model stands in it
        only as inert strings.

    Raises
    ------
    BudgetError
        SF503 when a function's text would be too long.
    ModelError
        SF233 when a number does not fit in double precision.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = {m = "2 kg", b = "3 N*s/m"}
    ... elements.body = {type = "mass", at = "x", m = "m"}
    ... elements.loss = {type = "damper", between = ["x", "ground"], b = "b"}
    ... inputs.F = {force = "x"}
    ... outputs.V = "s*x"
    ... ''')
    >>> export = numpy_module(pipeline.derive_all(model), model)
    >>> "def V_over_F(" in export.text
    True
    """
    members = members_of(tfs, band_hz, samples)
    names = identifiers({p.name: p.name for p in model.parameters}, RESERVED)
    functions, responses = public_names(members, RESERVED)
    blocks, code = [parameter_table(model, names)], ""
    for member in members:
        public = (responses if member.program.is_real else functions)[member.tf.name]
        sentence = member.verification.text(digits)
        function = _Function(member.tf, member.program, public, names, sentence)
        private = "\n".join(function.private())
        blocks.append(f"{function.text()}\n\n\n{private}\n")
        code += f"{function.call}\n{private}\n"
    pieces = [member.program for member in members if isinstance(member.program, Piecewise)]
    blocks += called_parts(code, PARTS, ("_numbers", "BLOCK"))
    blocks.append(function_table("TRANSFER_FUNCTIONS", functions))
    if pieces:
        blocks.append(function_table("FREQUENCY_RESPONSES", responses))
    lints = f"{LINTS_OF_NAMES}, {LINTS if pieces else LINTS_OF_BLOCKS}"
    verified = verifications(members)
    text = header(FIRST, model, verified[: len(functions)], digits)
    return NumpyExport(f"{text}{IMPORTS.format(lints=lints)}\n" + "\n\n".join(blocks), verified)


@dataclass(frozen=True)
class _Function:
    """Prints one transfer function: what a user calls, and the arithmetic behind it."""

    tf: AnyTransferFunction
    program: Program | Piecewise
    name: str
    names: Mapping[str, str]
    sentence: str

    @property
    def variable(self) -> str:
        """The first argument's name."""
        if not self.program.is_real:
            return "s"
        return "omega_" if "omega" in self.names.values() else "omega"

    def text(self) -> str:
        """Return the function that a user calls."""
        parameters = [(p, self.names[p.name]) for p in self.tf.parameters]
        values = ", ".join([self.variable, *(name for _, name in parameters)])
        signature = [
            f"def {self.name}(",
            f"    {self.variable}: ArrayLike,",
            *(["    *,"] if parameters else []),
        ]
        for parameter, name in parameters:
            value = default_value(parameter)
            signature.append(f"    {name}: ArrayLike{f' = {value}' if value else ''},")
        body = [
            *statement("arguments", f"{'_real' if self.program.is_real else ''}_numbers({values})", "    "),
            '    with np.errstate(all="ignore"):',
            *statement("return", self.call, "        "),
        ]
        return "\n".join(
            [
                *signature,
                ") -> complex | NDArray[np.complex128]:",
                self._docstring().rstrip("\n"),
                *body,
            ]
        )

    def _pieces(self, program: Piecewise) -> PiecesText:
        return PiecesText(program, self.name, self.variable, self.names, RESERVED)

    @property
    def call(self) -> str:
        """What computes the value of ``arguments``."""
        if isinstance(self.program, Piecewise):
            return self._pieces(self.program).call()
        return f"_in_blocks(_value_of_{self.name}, arguments)"

    def private(self) -> list[str]:
        """Return the lines of what computes with arrays of any shape; no text of the model is in them."""
        parameters = [self.names[p.name] for p in self.tf.parameters]
        if isinstance(self.program, Piecewise):
            return self._pieces(self.program).functions()
        lines = [f"def _value_of_{self.name}("]
        lines += [f"    {name}: NDArray[np.complex128]," for name in ("s", *parameters)]
        lines.append(") -> NDArray[np.complex128]:")
        program, far = self.program, self.program.far
        used = {*RESERVED, *parameters}
        own = identifiers({n: n for n in ("value", "limit", "is_far", "inverse")}, used)
        used |= set(own.values())
        assignments = [*program.constants, *program.near.assignments, *(far.assignments if far else ())]
        intermediates = identifiers({a.name: a.name for a in assignments}, used)
        printer = Printer(self.names, intermediates, "s", own["inverse"])
        for assignment in (*program.constants, *program.near.assignments):
            lines += printer.assignment(assignment.name, assignment.value, "    ")
        if far is None:
            value = printer.print(program.near.value)
            return [
                *lines,
                *statement("return", value if program.varies else f"np.asarray({value})", "    "),
            ]
        lines += statement(own["value"], printer.print(program.near.value), "    ")
        lines.append(f"    {own['limit']} = {program.limit!r}")
        lines.append(f"    {own['is_far']} = np.abs(s) > {own['limit']}")
        lines.append(f"    if np.any({own['is_far']}):")
        lines.append(f"        {own['inverse']} = 1.0 / s")
        for assignment in far.assignments:
            lines += printer.assignment(assignment.name, assignment.value, "        ")
        whole = f"np.where({own['is_far']}, {printer.print(far.value)}, {own['value']})"
        return [*lines, *statement(own["value"], whole, "        "), f"    return {own['value']}"]

    def _docstring(self) -> str:
        returned = (
            "complex or ndarray of complex",
            "A number when all arguments are numbers. Not finite at poles.",
        )
        signature = Signature(self.variable, self.names, self.program.is_real, "array_like", returned)
        solves = isinstance(self.program, Piecewise) and self.program.solves
        return function_docstring(self.tf, signature, [self.sentence, *([COST] if solves else [])])
