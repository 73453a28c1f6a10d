"""What languages of infix text share: expressions, and the private functions of one transfer function.

There is one function per piece, and one that finds which serves. Their names begin with what they are for and
end with the function's: ``_value_of_X_over_F`` calls ``_piece_0_of_X_over_F``. What a language writes in its
own way is a template of its printer, or overridden: complex numbers, a statement, a branch, a function.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import TextWrapper
from typing import ClassVar

from symflex.codegen.module_text import identifiers
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.evaluate import nearest_double

_SUM, _PRODUCT, _SIGN, _POWER, LEAF = range(5)
_GLUE = "\N{NO-BREAK SPACE}"


@dataclass(frozen=True)
class InfixPrinter(ABC):
    """Prints expressions that are evaluated in the order of the tree."""

    # parameters and locals: identifiers of parameters and of intermediate values.
    parameters: Mapping[str, str]
    locals: Mapping[str, str]
    variable: str  # identifier of s, or of what takes its place
    inverse: str = ""  # identifier of 1/s; only far branches have it
    space: str = ""  # what functions are looked up in

    # What languages write differently: signs, and templates of a base and its exponent; of z, which is not a
    # number beyond an end; of the values of a list; of a list and the position of one of them; of a run-time
    # function, named as in :mod:`symflex.codegen.program.evaluate`, and its arguments.
    times: ClassVar[str] = "*"
    over: ClassVar[str] = "/"
    power: ClassVar[str] = "{}**{}"
    cut_off: ClassVar[str]
    listed: ClassVar[str] = "[{}]"
    item: ClassVar[str] = "{}[{}]"
    called: ClassVar[str] = "_{}({})"
    first: ClassVar[int] = 0  # position of the first value of a list
    together: ClassVar[str] = "{}"  # of values that a function returns at once

    def print(self, node: tree.CodeNode) -> str:
        """Return the text of an expression."""
        return self._print(node)[0]

    def all_of(self, values: Sequence[tree.CodeNode]) -> str:
        """Return the text of what a function returns: one value, or all of them at once."""
        texts = [self.print(value) for value in values]
        return texts[0] if len(texts) == 1 else self.together.format(", ".join(texts))

    def quotient(self, numerator: tree.CodeNode, denominator: tree.CodeNode) -> str:
        """Return the text of a quotient."""
        return self.print(tree.Divide(numerator, denominator))

    def within(self, node: tree.CodeNode, tightest: int) -> str:
        """Return the text of an operand, in parentheses when it binds less tightly."""
        text, binding = self._print(node)
        return text if binding >= tightest else f"({text})"

    @property
    def pi(self) -> str:
        """The number pi."""
        return "pi"

    def applied(self, function: str, argument: tree.CodeNode) -> str:
        """Return the text of an elementary function's value."""
        return f"{function.removeprefix('complex_')}({self.print(argument)})"

    def to_complex(self, operand: tree.CodeNode) -> tuple[str, int]:
        """Return the text of a real number as a complex one, and how tightly it binds."""
        return f"{self.complex_number(1.0, 0.0)} {self.times} {self.within(operand, _SIGN)}", _PRODUCT

    def piece_number(self, program: tree.Piecewise) -> str:
        """Return the sum of ``2**i`` over the tests that hold; empty without tests."""
        terms = []
        for i, condition in enumerate(program.conditions):
            quantity, scale = self.print(condition.quantity), self.print(condition.scale)
            test = f"real({self.print(tree.Multiply((condition.scale, condition.quantity)))}) < 0.0"
            if condition.limit:
                below = "" if scale == "1.0" else f" {self.over} abs({scale})"
                test = f"abs({quantity}) < {condition.limit!r}{below}"
            terms.append(f"{2**i} {self.times} ({test})" if i else f"({test})")
        return " + ".join(terms)

    @abstractmethod
    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""

    def call(self, function: str, arguments: Sequence[str]) -> str:
        """Return a call of a run-time function."""
        return self.called.format(function, ", ".join(arguments))

    # -------------------------------------------------------------------------------------------- the tree

    def _print(self, node: tree.CodeNode) -> tuple[str, int]:
        """Return the text and how tightly it binds."""
        match node:
            case tree.RealNumber(value, pi_power):
                is_pi = value == 1 and pi_power == 1
                return self.pi if is_pi else repr(nearest_double(value, pi_power)), LEAF
            case tree.ComplexNumber(real, imaginary):
                return self.complex_number(nearest_double(real), nearest_double(imaginary)), LEAF
            case tree.ToComplex(operand):
                return self.to_complex(operand)
            case tree.LargerRoot() | tree.RootFactor():
                return self._print(node.spelled)
            case tree.Within(point, end):
                z = self.print(point)
                return self.cut_off.format(z=z, end=end, space=self.space), LEAF
            case tree.ParameterValue(name):
                return self.parameters[name], LEAF
            case tree.Assigned(name):
                return self.locals[name], LEAF
            case tree.Laplace():
                return self.variable, LEAF
            case tree.InverseLaplace():
                return self.inverse, LEAF
            case tree.Add() | tree.Multiply() | tree.Divide() | tree.Negate():
                return self.operation(node)
            case tree.IntegerPower(base, exponent):
                return self.power.format(self.within(base, LEAF), exponent), _POWER
            case tree.Apply(function, argument):
                return self.applied(function, argument), LEAF
        return self.with_lists(node), LEAF

    def with_lists(self, node: tree.CodeNode) -> str:
        """Return the text of what takes lists or gives them."""
        match node:
            case tree.Solutions(coefficients, terms):
                return self.call("series_solutions", [self.list_of(coefficients), str(terms)])
            case tree.Item(values, position):
                return self.item.format(self.within(values, LEAF), self.first + position)
        raise TypeError(type(node).__name__)

    def operation(self, node: tree.Add | tree.Multiply | tree.Divide | tree.Negate) -> tuple[str, int]:
        """Return the text of a sum, product, quotient or negative number, and how tightly it binds."""
        match node:
            case tree.Add(terms):
                return self._sum(terms), _SUM
            case tree.Multiply(factors):
                texts = [self.within(factors[0], _PRODUCT), *(self.within(f, _SIGN) for f in factors[1:])]
                return f" {self.times} ".join(texts), _PRODUCT
            case tree.Divide(above, below):
                return f"{self.within(above, _PRODUCT)} {self.over} {self.within(below, _SIGN)}", _PRODUCT
            case tree.Negate(operand):
                return f"-{self.within(operand, _POWER)}", _SIGN

    def list_of(self, nodes: Iterable[tree.CodeNode]) -> str:
        """Return a list of expressions."""
        return self.listed.format(", ".join(map(self.print, nodes)))

    def _sum(self, terms: Sequence[tree.CodeNode]) -> str:
        text = self.within(terms[0], _PRODUCT)
        for term in terms[1:]:
            if isinstance(term, tree.Negate):
                text += f" - {self.within(term.operand, _PRODUCT)}"
            else:
                text += f" + {self.within(term, _PRODUCT)}"
        return text


def in_lines(text: str, width: int) -> list[str]:
    """Return code as lines that end after an operator or a comma.

    Only blanks are broken at, so a name longer than a line stays whole.
    """
    glued = text
    for operator in ("+", "-", "*", "/", ".*", "./", "<"):
        glued = glued.replace(f" {operator} ", f"{_GLUE}{operator} ")
    wrapper = TextWrapper(width=width, break_long_words=False, break_on_hyphens=False)
    return [line.replace(_GLUE, " ") for line in wrapper.wrap(glued)]


@dataclass(frozen=True)
class PrivateFunctions(ABC):
    """What prints them, in any language with expressions of infix operators or calls."""

    printer: ClassVar[type[InfixPrinter]]
    longest: ClassVar[int | None] = None  # characters of an identifier

    program: tree.Piecewise  # what they compute
    name: str  # identifier of the public function
    parameters: Mapping[str, str]  # identifiers of the parameters
    reserved: Collection[str]  # identifiers that intermediate values cannot have

    @abstractmethod
    def statement(self, target: str, value: str, depth: int = 1) -> list[str]:
        """Return the lines of an assignment, indented by so many steps."""

    def blocks(self) -> list[str]:
        """Return the functions, each as text that ends with a line end."""
        if self.program.is_lumped:
            return [self._lumped(self.program)]
        pieces = (block for i, piece in enumerate(self.program.code) for block in self._piece(i, piece))
        return [self._choice(self.program), *pieces]

    def entries(self) -> str:
        """Return the function of all values at once, of the program of a matrix."""
        return self._lumped(self.program)

    @abstractmethod
    def _lumped(self, program: tree.Piecewise) -> str:
        """Return the function of a lumped program."""

    @abstractmethod
    def _choice(self, program: tree.Piecewise) -> str:
        """Return the function that finds the piece that serves."""

    @abstractmethod
    def _piece(self, number: int, piece: tree.CodePiece) -> list[str]:
        """Return the functions of a piece."""

    def arguments(self, variable: str) -> list[str]:
        """Return what the functions take: s or its like, and the parameters."""
        return [variable, *(self.parameters[p] for p in self.program.parameters)]

    def scope(self, assignments: Sequence[tree.Assignment], *words: str) -> tuple[InfixPrinter, list[str]]:
        """Return a printer, and identifiers for the code's own words, the first one s or its like."""
        reserved = {f"{word} of the code": word for word in words}
        taken = {*self.reserved, *self.parameters.values()}
        names = identifiers({**reserved, **{a.name: a.name for a in assignments}}, taken, self.longest)
        arguments = [names[key] for key in reserved]
        return self.printer(self.parameters, names, arguments[0], arguments[-1]), arguments

    def assigned(
        self, assignments: Sequence[tree.Assignment], printer: InfixPrinter, depth: int = 1
    ) -> list[str]:
        """Return the lines of assignments."""
        lines: list[str] = []
        for a in assignments:
            lines += self.statement(printer.locals[a.name], printer.print(a.value), depth)
        return lines
