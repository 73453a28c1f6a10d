"""The local functions behind one transfer function, in MATLAB."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from symflex.codegen.functions import PrivateFunctions
from symflex.codegen.matlab.expression import MatlabPrinter, continued, statement

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.codegen.program import CodePiece, Piecewise

LONGEST = 63
"""Characters that MATLAB tells identifiers apart by."""


def roles_of(program: Piecewise) -> list[str]:
    """Return what the local functions behind a program are for; their names end so."""
    if program.is_lumped:
        return ["value"]
    roles = ["number"]
    for i, piece in enumerate(program.code):
        roles += [f"{i}_parts", str(i)] if piece.circle else [str(i)]
    return roles


@dataclass(frozen=True)
class LocalFunctions(PrivateFunctions):
    """Prints the local functions that compute with columns."""

    printer: ClassVar = MatlabPrinter
    longest: ClassVar = LONGEST
    step: ClassVar = "  "

    names: Mapping[str, str]  # identifiers of these functions, by their roles

    def statement(self, target: str, value: str, indent: str) -> list[str]:
        """Return ``target = value``."""
        return statement(target, value, indent)

    def call(self) -> list[str]:
        """Return the statement that computes the value of ``s``, or ``omega``, and ``given``."""
        if self.program.is_lumped:
            return statement("value", f"everywhere(@{self.names['value']}, s, given)")
        pieces = ", ".join(f"@{self.names[str(i)]}" for i in self.program.pieces)
        arguments = f"@{self.names['number']}, {{{pieces}}}, {self.variable}, given"
        if not self.program.is_real:
            return statement("value", f"in_pieces({arguments})")
        return statement("value", f"in_real_pieces({arguments}, {'true' if self.program.turn else 'false'})")

    def blocks(self) -> list[str]:
        """Return the functions, each as text that ends with a line end."""
        if self.program.is_lumped:
            return [self._lumped(self.program)]
        blocks = [self._number(self.program)]
        for i, piece in enumerate(self.program.code):
            blocks += self._piece(i, piece)
        return blocks

    # ------------------------------------------------------------------------------------------- functions

    def _function(self, outputs: str, role: str, variable: str, body: Sequence[str]) -> str:
        given = ", ".join(self.arguments(variable))
        head = continued(f"function {outputs} = {self.names[role]}({given})", "")
        return "\n".join([*head, *body, "end", ""])

    def _lumped(self, program: Piecewise) -> str:
        near, far, late = program.near, program.far, program.late
        early = (*near.constants, *near.assignments)
        if far is None:
            printer, (s, value) = self.scope(early, "s", "value")
            lines = [*self.assigned(early, printer), *statement(value, printer.print(near.values[0]))]
            return self._function(value, "value", s, lines)
        words = ("s", "value", "limit", "is_far", "far_value", "inverse")
        printer, (s, value, limit, is_far, far_value, inverse) = self.scope((*early, *late), *words)
        lines = [
            *self.assigned(early, printer),
            *statement(value, printer.print(near.values[0])),
            *statement(limit, repr(program.limit)),
            *statement(is_far, f"abs({s}) > {limit}"),
            f"  if any({is_far})",
            *statement(inverse, f"1.0 ./ {s}", "    "),
            *self.assigned(late, printer, 2),
            *statement(far_value, printer.print(far.values[0]), "    "),
            *statement(f"{value}({is_far})", f"{far_value}({is_far})", "    "),
            "  end",
        ]
        return self._function(value, "value", s, lines)

    def _number(self, program: Piecewise) -> str:
        """Return the function that tells which piece serves."""
        assignments = (*program.tests.constants, *program.tests.assignments)
        printer, (variable, number) = self.scope(assignments, self.variable, "number")
        lines = [
            *self.assigned(assignments, printer),
            *statement(number, printer.piece_number(program) or "0"),
        ]
        return self._function(number, "number", variable, lines)

    def _piece(self, number: int, piece: CodePiece) -> list[str]:
        assignments = (*piece.code.constants, *piece.code.assignments)
        if piece.circle:
            words = (self.variable, "num", "den", "growth", "radius")
            printer, (variable, *results) = self.scope(assignments, *words)
            lines = self.assigned(assignments, printer)
            for name, node in zip(results, piece.code.values, strict=True):
                lines += statement(name, printer.print(node))
            parts = self._function(f"[{', '.join(results)}]", f"{number}_parts", variable, lines)
            return [parts, self._mean(number, piece.circle)]
        wanted = [self.variable, "value", "num", "den", *(["s"] if piece.is_complex else [])]
        printer, (variable, value, num, den, *place) = self.scope(assignments, *wanted)
        lines = []
        for s in place:
            printer = replace(printer, variable=s)
            lines += statement(s, f"1i .* {variable}")
        lines += self.assigned(assignments, printer)
        above, below = piece.code.values
        if not self.program.is_real:
            lines += statement(value, printer.quotient(above, below))
            return [self._function(value, str(number), variable, lines)]
        text = printer.print(above)
        if piece.is_complex and self.program.turn:
            # The factor that the real pieces leave out comes after.
            text = f"(-1.0i) .* ({text})"
        lines += [*statement(num, text), *statement(den, printer.print(below))]
        return [self._function(f"[{num}, {den}]", str(number), variable, lines)]

    def _mean(self, number: int, points: int) -> str:
        _, (variable, value, z) = self.scope((), self.variable, "value", "z")
        given = ", ".join(self.arguments(z))
        whole = f"mean_over_circle(@({z}) {self.names[f'{number}_parts']}({given}), {variable}, {points})"
        return self._function(value, str(number), variable, statement(value, whole))
