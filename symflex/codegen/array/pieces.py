"""Functions over any library of arrays as Python text: one per piece, and the choice among them.

Every piece is evaluated for all elements, so that no branch depends on a value: the text can be compiled and
differentiated by what traces it.

Input: a program and identifiers.
Output: lines of a module.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from symflex.codegen.array.expression import ArrayPrinter
from symflex.codegen.numpy.expression import WIDTH, statement
from symflex.codegen.program import (
    Apply,
    InverseLaplace,
    Laplace,
    Multiply,
    Node,
    Piece,
    Piecewise,
    identifiers,
)
from symflex.codegen.program.evaluate import number_of
from symflex.codegen.program.everywhere import ONE, cases_of, places_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.codegen.program import Straight


@dataclass(frozen=True)
class ArrayPieces:
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
    reserved : frozenset of str
        Identifiers that intermediates cannot have.
    values : mapping of str to float
        Values of the parameters that have one.
    space : str
        What functions are looked up in.
    is_argument : bool
        True to pass ``space`` to every function.
    has_fixed_sizes : bool
        True to leave magnitudes out of derivatives.
    """

    program: Piecewise
    name: str
    variable: str
    parameters: Mapping[str, str]
    reserved: frozenset[str]
    values: Mapping[str, float]
    space: str
    is_argument: bool
    has_fixed_sizes: bool

    @property
    def _given(self) -> list[str]:
        return [self.variable, *(self.parameters[p] for p in self.program.parameters)]

    @property
    def _leading(self) -> list[str]:
        return [self.space] if self.is_argument else []

    def call(self) -> str:
        """Return the call that computes the value of ``arguments``."""
        leading = "".join(f"{x}, " for x in self._leading)
        if not self.program.conditions:
            return f"_piece_0_of_{self.name}({leading}*arguments)"
        chooser = "_in_real_pieces" if self.program.is_real else "_in_pieces"
        return f"{chooser}({leading}_tests_of_{self.name}, _pieces_of_{self.name}, arguments)"

    def functions(self) -> list[str]:
        """Return the lines of all functions.

        Names begin with what a private function is, so that ``A_over_F_0`` may be another function.
        """
        if not self.program.conditions:
            return self._piece(0, self.program.code[0])
        lines = [*self._tests(), "", ""]
        for i, piece in enumerate(self.program.code):
            lines += [*self._piece(i, piece), "", ""]
        lines.append(f"_pieces_of_{self.name} = (")
        places = places_of(self.program, self.values)
        for i, (cases, place) in enumerate(zip(cases_of(self.program), places, strict=True)):
            at = repr(place.real if self.program.is_real else place)
            lines += [
                f"    (_piece_{i}_of_{self.name}, {at}, (",
                *(f"        {case!r}," for case in cases),
                "    )),",
            ]
        return [*lines, ")"]

    def _head(self, name: str) -> list[str]:
        given = [*self._leading, *self._given]
        line = f"def {name}({', '.join(given)}):"
        if len(line) <= WIDTH:
            return [line]
        return [f"def {name}(", *(f"    {g}," for g in given), "):"]

    def _body(self, code: Straight, variable: str) -> tuple[list[str], ArrayPrinter]:
        """Return the lines of the assignments, and what prints values in their scope."""
        assignments = (*code.constants, *code.assignments)
        taken = {*self.reserved, *self._given, variable}
        inverse = identifiers({"inverse": "inverse"}, taken)["inverse"]
        names = identifiers({a.name: a.name for a in assignments}, {*taken, inverse})
        numbers: dict[str, Any] = {}
        for assignment in assignments:
            if (number := number_of(assignment.value, numbers)) is not None:
                numbers[assignment.name] = number
        printer = ArrayPrinter(
            self.parameters,
            names,
            variable,
            inverse,
            self.space,
            numbers,
            self.has_fixed_sizes and not self.program.is_real,
            {a.name: a.value for a in assignments},
            "".join(f"{x}, " for x in self._leading),
        )
        lines = [line for a in assignments for line in printer.assignment(a.name, a.value, "    ")]
        if any(inverse in line for line in lines):
            lines = [f"    {inverse} = 1.0 / {variable}", *lines]
        return lines, printer

    def _tests(self) -> list[str]:
        program = self.program
        lines, printer = self._body(program.tests, self.variable)
        tests = []
        for condition in program.conditions:
            is_one = condition.scale == ONE
            if not condition.limit:
                tested = condition.quantity if is_one else Multiply((condition.scale, condition.quantity))
                text = printer.print(tested)
                tests.append(f"{text if program.is_real else f'{self.space}.real({text})'} < 0.0")
                continue
            is_positive = program.is_real and isinstance(condition.quantity, Laplace)
            size = condition.quantity if is_positive else Apply("abs", condition.quantity)
            limit = repr(condition.limit)
            if not is_one:
                limit += f" / {self._size(condition.scale, printer)}"
            tests.append(f"{printer.print(size)} < {limit}")
        return [
            *self._head(f"_tests_of_{self.name}"),
            *lines,
            *statement("return", f"[{', '.join(tests)}]", "    "),
        ]

    def _size(self, scale: Node, printer: ArrayPrinter) -> str:
        if number_of(scale, printer.numbers) is not None:
            return repr(abs(number_of(scale, printer.numbers)))
        return printer.print(Apply("abs", scale))

    def _piece(self, number: int, piece: Piece) -> list[str]:
        name, parts = (f"_{word}_{number}_of_{self.name}" for word in ("piece", "parts"))
        if piece.circle:
            lines, printer = self._body(piece.code, self.variable)
            leading = "".join(f"{x}, " for x in self._leading)
            values = ", ".join(printer.print(v) for v in piece.code.values)
            whole = f"_mean_over_circle({leading}{parts}, [{', '.join(self._given)}], {piece.circle})"
            return [
                *self._head(parts),
                *lines,
                *statement("return", values, "    "),
                "",
                "",
                *self._head(name),
                *statement("return", whole, "    "),
            ]
        start, variable = self._head(name), self.variable
        if piece.is_complex:
            variable = identifiers({"s": "s"}, {*self.reserved - {"s"}, *self._given})["s"]
            start.append(f"    {variable} = 1j * {self.variable}")
        lines, printer = self._body(piece.code, variable)
        num, den = piece.code.values
        value = printer.print(num) if den == ONE else printer.quotient(num, den)
        if (
            den == ONE
            and printer.inverse in value
            and f"    {printer.inverse} = 1.0 / {variable}" not in lines
        ):
            start.append(f"    {printer.inverse} = 1.0 / {variable}")
        if self.program.is_real and not piece.is_complex:
            value = f"{'1j' if self.program.turn else '(1+0j)'} * ({value})"
        elif not any(isinstance(n, (Laplace, InverseLaplace)) for n in piece.code.nodes()):
            value = f"{value} + {self.space}.zeros_like({self.variable})"
        return [*start, *lines, *statement("return", value, "    ")]
