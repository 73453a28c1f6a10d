"""Functions of distributed systems as Python text: one per piece, and the choice among them.

Input: a :class:`Piecewise` program and identifiers.
Output: lines of a module that imports numpy only.
"""

from __future__ import annotations

import inspect
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import modal_amplitudes, mode_values
from symflex.codegen.numpy.expression import WIDTH, Printer, statement
from symflex.codegen.program import (
    Apply,
    Assignment,
    Laplace,
    Multiply,
    Node,
    Piece,
    Piecewise,
    Straight,
    identifiers,
    runtime,
)
from symflex.codegen.program.real_axis import needed
from symflex.codegen.source_parts import parts_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

LINTS = "ANN001, ANN201, ANN202, N816, PLR0912, PLR0914, PLR1704, PLR2004"
"""Rules that the private functions of the pieces do not follow."""


def private_copy(function: Callable[..., object]) -> str:
    """Return the text of a run-time function as a private one, without annotations.

    Parameters
    ----------
    function : callable
        Of this package.

    Raises
    ------
    ValueError
        When its text has no signature with a result.
    """
    text = inspect.getsource(function)
    signature = re.compile(r"def (\w+)\((.*?)\) -> .*?:(?:  # noqa[^\n]*)?\n", re.DOTALL)
    found = signature.match(text)
    if found is None:
        message = f"{function} has no signature"
        raise ValueError(message)
    names = re.findall(r"(\w+): ", found.group(2))
    body = re.sub(r"(\w): Any = ", r"\1 = ", text[found.end() :])
    body = re.sub(r"\b(complex_exp|modal_amplitudes)\(", r"_\1(", body)
    return f"def _{found.group(1)}({', '.join(names)}):\n{body}"


PARTS: dict[tuple[str, ...], str] = {
    **parts_of("numpy.py"),
    **{
        (f"_{function.__name__}",): private_copy(function)
        for function in (
            runtime.complex_exp,
            runtime.series_solutions,
            runtime.propagated,
            runtime.characteristic_roots,
            mode_values,
            modal_amplitudes,
            runtime.modal_value,
            runtime.mean_over_circle,
        )
    },
}
"""What generated code calls."""


@dataclass(frozen=True)
class PiecesText:
    """Prints the private functions behind one transfer function.

    Parameters
    ----------
    program : Piecewise
        What they compute.
    name : str
        Identifier of the public function.
    variable : str
        Its first argument, ``s`` or ``omega``.
    parameters : mapping of str to str
        Identifiers of the parameters.
    reserved : set of str
        Identifiers that intermediates cannot have.
    """

    program: Piecewise
    name: str
    variable: str
    parameters: Mapping[str, str]
    reserved: frozenset[str]

    def call(self) -> str:
        """Return the call that computes the value of ``arguments``."""
        if not self.program.is_real:
            if self.program.solves:
                return f"_in_array(_tests_of_{self.name}, _pieces_of_{self.name}, arguments)"
            return f"_in_pieces(_tests_of_{self.name}, _pieces_of_{self.name}, arguments, 1)"
        parts = ", ".join(f"_{part}_of_{self.name}" for part in ("limits", "sizes", "pieces"))
        return f"_in_real_pieces({parts}, arguments, {'1j' if self.program.turn else '1'})"

    def functions(self) -> list[str]:
        """Return the lines of all functions.

        Names begin with what a private function is, so that ``A_over_F_0`` may be another function.
        """
        tests = self._real_tests() if self.program.is_real else self._tests()
        lines = [*tests, "", ""]
        for i, piece in enumerate(self.program.code):
            lines += [*self._piece(i, piece), "", ""]
        names = [f"_piece_{i}_of_{self.name}" for i in self.program.pieces]
        comma = "," if len(names) == 1 else ""
        return [*lines, *statement(f"_pieces_of_{self.name}", f"({', '.join(names)}{comma})", "")]

    def _head(self, name: str, *, is_free: bool = False) -> list[str]:
        """Return the first lines of a function, without the first argument if it is free of that."""
        given = [self.parameters[p] for p in self.program.parameters]
        if not is_free:
            given = [self.variable, *given]
        line = f"def {name}({', '.join(given)}):"
        if len(line) <= WIDTH:
            return [line]
        return [f"def {name}(", *(f"    {g}," for g in given), "):"]

    def _printer(self, code: Straight, variable: str) -> Printer:
        assignments: list[Assignment] = [*code.constants, *code.assignments]
        taken = {*self.reserved, *self.parameters.values(), self.variable, variable, "z"}
        names = identifiers({a.name: a.name for a in assignments}, taken)
        return Printer(self.parameters, names, variable, "inverse")

    def _body(self, code: Straight, printer: Printer) -> list[str]:
        lines: list[str] = []
        for assignment in (*code.constants, *code.assignments):
            lines += printer.assignment(assignment.name, assignment.value, "    ")
        return lines

    def _tests(self) -> list[str]:
        program = self.program
        lines = self._head(f"_tests_of_{self.name}")
        printer = self._printer(program.tests, self.variable)
        lines += self._body(program.tests, printer)
        tests = []
        for condition in program.conditions:
            text = printer.print(condition.quantity)
            scale = printer.print(condition.scale)
            if not condition.limit:
                tests.append(f"_is_left({text}, {scale})")
                continue
            below = f" / np.abs({scale})" if scale != "1.0" else ""
            tests.append(f"np.abs({text}) < {condition.limit!r}{below}")
        return [*lines, *statement("return", f"[{', '.join(tests)}]", "    ")]

    def _real_tests(self) -> list[str]:
        """Return two functions: of the limits, made once per call, and of the sizes, made per block."""
        program = self.program
        printer = self._printer(program.tests, self.variable)
        limits: list[str] = []
        sizes: list[Node] = []
        for condition in program.conditions:
            if not condition.limit:
                limits.append("0.0")
                sizes.append(Multiply((condition.scale, condition.quantity)))
                continue
            scale = printer.print(condition.scale)
            limits.append(repr(condition.limit) + (f" / np.abs({scale})" if scale != "1.0" else ""))
            is_positive = isinstance(condition.quantity, Laplace)
            sizes.append(condition.quantity if is_positive else Apply("abs", condition.quantity))
        fixed = needed(program.tests, [c.scale for c in program.conditions if c.limit])
        return [
            *self._head(f"_limits_of_{self.name}", is_free=True),
            *self._body(fixed, printer),
            *statement("return", f"[{', '.join(limits)}]", "    "),
            "",
            "",
            *self._head(f"_sizes_of_{self.name}"),
            *self._body(needed(program.tests, sizes), printer),
            *statement("return", f"[{', '.join(printer.print(x) for x in sizes)}]", "    "),
        ]

    def _piece(self, number: int, piece: Piece) -> list[str]:
        name, parts = (f"_{word}_{number}_of_{self.name}" for word in ("piece", "parts"))
        if piece.circle:
            given = ", ".join(["z", *(self.parameters[p] for p in self.program.parameters)])
            printer = self._printer(piece.code, self.variable)
            values = ", ".join(printer.print(v) for v in piece.code.values)
            whole = f"_mean_over_circle(lambda z: {parts}({given}), {self.variable}, {piece.circle})"
            return [
                *self._head(parts),
                *self._body(piece.code, printer),
                *statement("return", values, "    "),
                "",
                "",
                *self._head(name),
                *statement("return", whole, "    "),
            ]
        lines = self._head(name)
        variable = self.variable
        if piece.is_complex:
            variable = identifiers({"s": "s"}, {*self.reserved - {"s"}, *self.parameters.values()})["s"]
            lines.append(f"    {variable} = 1j * {self.variable}")
        printer = self._printer(piece.code, variable)
        lines += self._body(piece.code, printer)
        num, den = piece.code.values
        if not self.program.is_real:
            return [*lines, *statement("return", printer.quotient(num, den), "    ")]
        above, below = printer.print(num), printer.print(den)
        if piece.is_complex:
            # The factor that the real pieces leave out comes after.
            above = f"{'-1j' if self.program.turn else '(1+0j)'} * ({above})"
        whole = f"{above}, {below}"
        return [*lines, *statement("return", whole, "    ")]
