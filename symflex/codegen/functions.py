"""The private functions that compute one transfer function: one per piece, and one that finds which serves.

Their names begin with what they are for and end with the function's: ``_value_of_X_over_F`` calls
``_piece_0_of_X_over_F``. A language says how it writes an expression, a statement, a branch and a function.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from symflex.codegen.program.nodes import ONE, Laplace
from symflex.codegen.program.user_text import identifiers

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from symflex.codegen.infix import InfixPrinter
    from symflex.codegen.program.nodes import Assignment, CodePiece, Piecewise


@dataclass(frozen=True)
class PrivateFunctions(ABC):
    """What prints them, in any language with expressions of infix operators or calls."""

    printer: ClassVar[type[InfixPrinter]]
    longest: ClassVar[int | None] = None  # characters of an identifier

    program: Piecewise  # what they compute
    name: str  # identifier of the public function
    parameters: Mapping[str, str]  # identifiers of the parameters
    reserved: Collection[str]  # identifiers that intermediate values cannot have

    @property
    def variable(self) -> str:
        """The first argument's name."""
        return "omega" if self.program.is_real else "s"

    @abstractmethod
    def statement(self, target: str, value: str, depth: int = 1) -> list[str]:
        """Return the lines of an assignment, indented by so many steps."""

    @abstractmethod
    def blocks(self) -> list[str]:
        """Return the functions, each as text that ends with a line end."""

    def arguments(self, variable: str) -> list[str]:
        """Return what the functions take: s or its like, and the parameters."""
        return [variable, *(self.parameters[p] for p in self.program.parameters)]

    def scope(self, assignments: Sequence[Assignment], *words: str) -> tuple[InfixPrinter, list[str]]:
        """Return a printer, and identifiers for the code's own words, the first one s or its like."""
        own = {f"{word} of the code": word for word in words}
        taken = {*self.reserved, *self.parameters.values()}
        names = identifiers({**own, **{a.name: a.name for a in assignments}}, taken, self.longest)
        found = [names[key] for key in own]
        return self.printer(self.parameters, names, found[0], found[-1]), found

    def assigned(self, assignments: Sequence[Assignment], printer: InfixPrinter, depth: int = 1) -> list[str]:
        """Return the lines of assignments."""
        lines: list[str] = []
        for a in assignments:
            lines += self.statement(printer.locals[a.name], printer.print(a.value), depth)
        return lines


class NumberFunctions(PrivateFunctions):
    """Functions of numbers: they branch on values."""

    brackets: ClassVar[tuple[str, str]] = ("(", ")")  # around several values that a function returns
    arrow: ClassVar[str] = "->"  # of a function without name

    @abstractmethod
    def branch(self, test: str, body: Sequence[str]) -> list[str]:
        """Return statements, indented twice, that are executed where a test holds."""

    @abstractmethod
    def function(self, name: str, arguments: Sequence[str], body: Sequence[str]) -> str:
        """Return a function."""

    def returned(self, value: str, depth: int = 1) -> list[str]:
        """Return the statement that ends a function; by default ``return``, written as an assignment is."""
        return self.statement("return", value, depth)

    def blocks(self) -> list[str]:
        """Return the functions, each as text that ends with a line end."""
        if self.program.is_lumped:
            return [self._lumped(self.program)]
        blocks = [self._choice(self.program)]
        for i, piece in enumerate(self.program.code):
            blocks += self._piece(self.program, i, piece)
        return blocks

    def _function(self, kind: str, variable: str, body: Sequence[str]) -> str:
        return self.function(f"_{kind}_of_{self.name}", self.arguments(variable), body)

    def _call(self, kind: str, variable: str) -> str:
        return f"_{kind}_of_{self.name}({', '.join(self.arguments(variable))})"

    def _lumped(self, program: Piecewise) -> str:
        near, far, late = program.near, program.far, program.late
        early = (*near.constants, *near.assignments)
        printer, (s, inverse) = self.scope((*early, *late), "s", "inverse")
        lines = self.assigned(early, printer)
        if far is not None:
            one = printer.quotient(ONE, Laplace())
            body = [
                *self.statement(inverse, one, 2),
                *self.assigned(late, printer, 2),
                *self.returned(printer.print(far.values[0]), 2),
            ]
            lines += self.branch(f"abs({s}) > {program.limit!r}", body)
        return self._function("value", s, [*lines, *self.returned(printer.print(near.values[0]))])

    def _choice(self, program: Piecewise) -> str:
        """Return the function that finds the piece that serves."""
        assignments = (*program.tests.constants, *program.tests.assignments)
        printer, (variable, number) = self.scope(assignments, self.variable, "number")
        lines: list[str] = []
        if program.is_real:
            negative = self._call("value", f"-{variable}")
            lines += self.branch(f"signbit({variable})", self.returned(f"conj({negative})", 2))
        lines += self.assigned(assignments, printer)
        if program.conditions:
            lines += self.statement(number, printer.piece_number(program))
        served = {k: [n for n, own in enumerate(program.pieces) if own == k] for k in set(program.pieces)}
        *others, last = sorted(served)
        for k in others:
            test = " || ".join(f"{number} == {n}" for n in served[k])
            lines += self.branch(test, self.returned(self._call(f"piece_{k}", variable), 2))
        return self._function(
            "value", variable, [*lines, *self.returned(self._call(f"piece_{last}", variable))]
        )

    def _piece(self, program: Piecewise, number: int, piece: CodePiece) -> list[str]:
        assignments = (*piece.code.constants, *piece.code.assignments)
        if piece.circle:
            printer, (variable,) = self.scope(assignments, self.variable)
            values = ", ".join(printer.print(v) for v in piece.code.values).join(self.brackets)
            lines = [*self.assigned(assignments, printer), *self.returned(values)]
            return [self._function(f"parts_{number}", variable, lines), self._mean(number, piece.circle)]
        words = (self.variable, *(["s"] if piece.is_complex else []))
        printer, (variable, *place) = self.scope(assignments, *words)
        lines = []
        for s in place:
            printer = replace(printer, variable=s)
            lines += self.statement(s, f"complex(0.0, {variable})")
        lines += self.assigned(assignments, printer)
        whole = printer.quotient(*piece.code.values)
        if program.is_real and not piece.is_complex:
            whole = f"complex(0.0, {whole})" if program.turn else f"complex({whole}, 0.0)"
        return [self._function(f"piece_{number}", variable, [*lines, *self.returned(whole)])]

    def _mean(self, number: int, points: int) -> str:
        _, (variable, z) = self.scope((), self.variable, "z")
        parts = f"{z} {self.arrow} {self._call(f'parts_{number}', z)}"
        whole = f"_mean_over_circle({parts}, {variable}, {points})"
        return self._function(f"piece_{number}", variable, self.returned(whole))
