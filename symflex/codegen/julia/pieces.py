"""The private functions behind one transfer function, in Julia."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from symflex.codegen.julia.expression import JuliaPrinter, head, statement
from symflex.codegen.program import Assignment, CodePiece, Piecewise, identifiers

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence


@dataclass(frozen=True)
class PrivateFunctions:
    """Prints the functions that compute, of positional arguments; all begin with an underscore.

    Parameters
    ----------
    program : Piecewise
        What they compute.
    name : str
        Identifier of the public function.
    parameters : mapping of str to str
        Identifiers of the parameters.
    reserved : collection of str
        Identifiers that intermediate values cannot have.
    """

    program: Piecewise
    name: str
    parameters: Mapping[str, str]
    reserved: Collection[str]

    @property
    def variable(self) -> str:
        """The first argument's name."""
        return "omega" if self.program.is_real else "s"

    def blocks(self) -> list[str]:
        """Return the functions, each as text that ends with a line end."""
        if self.program.is_lumped:
            return [self._lumped(self.program)]
        blocks = [self._choice(self.program)]
        for i, piece in enumerate(self.program.code):
            blocks += self._piece(self.program, i, piece)
        return blocks

    def _arguments(self, variable: str) -> list[str]:
        return [variable, *(self.parameters[p] for p in self.program.parameters)]

    def _function(self, kind: str, variable: str, body: Sequence[str]) -> str:
        lines = [*head(f"_{kind}_of_{self.name}", self._arguments(variable)), *body]
        return "\n".join([*lines, "end", ""])

    def _scope(self, assignments: Sequence[Assignment], *words: str) -> tuple[JuliaPrinter, list[str]]:
        """Return a printer, and identifiers for the code's own words, the first one s or its like."""
        own = {f"{word} of the code": word for word in words}
        taken = {*self.reserved, *self.parameters.values()}
        names = identifiers({**own, **{a.name: a.name for a in assignments}}, taken)
        found = [names[key] for key in own]
        return JuliaPrinter(self.parameters, names, found[0], found[-1]), found

    def _lumped(self, program: Piecewise) -> str:
        near, far, late = program.near, program.far, program.late
        early = (*near.constants, *near.assignments)
        printer, (s, inverse) = self._scope((*early, *late), "s", "inverse")
        lines = _assigned(early, printer)
        if far is not None:
            lines += [
                f"    if abs({s}) > {program.limit!r}",
                *statement(inverse, f"1.0 / {s}", "        "),
                *_assigned(late, printer, "        "),
                *statement("return", printer.print(far.values[0]), "        "),
                "    end",
            ]
        return self._function("value", s, [*lines, *statement("return", printer.print(near.values[0]))])

    def _choice(self, program: Piecewise) -> str:
        """Return the function that finds the piece that serves."""
        assignments = (*program.tests.constants, *program.tests.assignments)
        printer, (variable, number) = self._scope(assignments, self.variable, "number")
        lines: list[str] = []
        if program.is_real:
            negative = ", ".join(self._arguments(f"-{variable}"))
            lines += [
                f"    if signbit({variable})",
                *statement("return", f"conj(_value_of_{self.name}({negative}))", "        "),
                "    end",
            ]
        lines += _assigned(assignments, printer)
        if program.conditions:
            lines += statement(number, printer.piece_number(program))
        given = ", ".join(self._arguments(variable))
        served = {k: [n for n, own in enumerate(program.pieces) if own == k] for k in set(program.pieces)}
        *others, last = sorted(served)
        for k in others:
            conditions = " || ".join(f"{number} == {n}" for n in served[k])
            lines += [
                f"    if {conditions}",
                *statement("return", f"_piece_{k}_of_{self.name}({given})", "        "),
                "    end",
            ]
        return self._function(
            "value", variable, [*lines, *statement("return", f"_piece_{last}_of_{self.name}({given})")]
        )

    def _piece(self, program: Piecewise, number: int, piece: CodePiece) -> list[str]:
        assignments = (*piece.code.constants, *piece.code.assignments)
        if piece.circle:
            printer, (variable,) = self._scope(assignments, self.variable)
            values = ", ".join(printer.print(v) for v in piece.code.values)
            lines = [*_assigned(assignments, printer), *statement("return", f"({values})")]
            return [self._function(f"parts_{number}", variable, lines), self._mean(number, piece.circle)]
        words = (self.variable, *(["s"] if piece.is_complex else []))
        printer, (variable, *place) = self._scope(assignments, *words)
        lines = []
        for s in place:
            printer = replace(printer, variable=s)
            lines += statement(s, f"complex(0.0, {variable})")
        lines += _assigned(assignments, printer)
        whole = printer.quotient(*piece.code.values)
        if program.is_real and not piece.is_complex:
            whole = f"complex(0.0, {whole})" if program.turn else f"complex({whole}, 0.0)"
        return [self._function(f"piece_{number}", variable, [*lines, *statement("return", whole)])]

    def _mean(self, number: int, points: int) -> str:
        _, (variable, z) = self._scope((), self.variable, "z")
        given = ", ".join(self._arguments(z))
        whole = f"_mean_over_circle({z} -> _parts_{number}_of_{self.name}({given}), {variable}, {points})"
        return self._function(f"piece_{number}", variable, statement("return", whole))


def _assigned(assignments: Sequence[Assignment], printer: JuliaPrinter, indent: str = "    ") -> list[str]:
    lines: list[str] = []
    for assignment in assignments:
        lines += statement(printer.locals[assignment.name], printer.print(assignment.value), indent)
    return lines
