"""Expressions of a program tree as Python text for numpy."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import TextWrapper
from typing import TYPE_CHECKING

from symflex.emit.program import (
    Add,
    Apply,
    ComplexNumber,
    Constant,
    Divide,
    InverseLaplace,
    Item,
    Laplace,
    ModalValue,
    ModeValues,
    Multiply,
    Negate,
    Node,
    Power,
    Reference,
    Roots,
    Solutions,
    nearest_double,
)
from symflex.emit.program import Parameter as ParameterNode
from symflex.emit.program.evaluate import NUMPY_FUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

WIDTH = 88

_SUM, _PRODUCT, _SIGN, _POWER, _LEAF = range(5)


@dataclass(frozen=True)
class Printer:
    """Prints expressions as Python, evaluated in the order of the tree.

    Parameters
    ----------
    parameters, locals : mapping of str to str
        Identifiers of parameters and of intermediate values.
    inverse : str
        Identifier of 1/s.
    variable : str
        Identifier of s, or of what takes its place.
    space : str
        What functions are looked up in.
    """

    parameters: Mapping[str, str]
    locals: Mapping[str, str]
    inverse: str
    variable: str = "s"
    space: str = "np"

    def assignment(self, name: str, value: Node, indent: str) -> list[str]:
        """Return the lines of an assignment."""
        return statement(self.locals[name], self.print(value), indent)

    def print(self, node: Node) -> str:
        """Return the text of an expression."""
        return self._print(node)[0]

    def quotient(self, numerator: Node, denominator: Node) -> str:
        """Return the text of a quotient."""
        return f"{self._within(numerator, _PRODUCT)} / {self._within(denominator, _SIGN)}"

    def applied(self, function: str, argument: Node) -> str:
        """Return the text of a function's value."""
        if function == "complex_exp":
            return f"_complex_exp({self.print(argument)})"
        return f"{self.space}.{NUMPY_FUNCTIONS[function]}({self.print(argument)})"

    def _print(self, node: Node) -> tuple[str, int]:  # noqa: PLR0912
        """Return the text and how tightly it binds."""
        match node:
            case Constant(value, pi_power):
                is_pi = value == 1 and pi_power == 1
                return f"{self.space}.pi" if is_pi else repr(nearest_double(value, pi_power)), _LEAF
            case ComplexNumber(real, imaginary):
                return _complex(real, imaginary), _LEAF
            case ParameterNode(name):
                return self.parameters[name], _LEAF
            case Reference(name):
                return self.locals[name], _LEAF
            case Laplace():
                return self.variable, _LEAF
            case InverseLaplace():
                return self.inverse, _LEAF
            case Add(terms):
                return self._sum(terms), _SUM
            case Multiply(factors):
                texts = [self._within(factors[0], _PRODUCT), *(self._within(f, _SIGN) for f in factors[1:])]
                return " * ".join(texts), _PRODUCT
            case Divide(numerator, denominator):
                return self.quotient(numerator, denominator), _PRODUCT
            case Power(base, exponent):
                return f"{self._within(base, _LEAF)}**{exponent}", _POWER
            case Negate(operand):
                return f"-{self._within(operand, _POWER)}", _SIGN
            case Apply(function, argument):
                return self.applied(function, argument), _LEAF
            case Solutions(coefficients, terms):
                given = ", ".join(self.print(c) for c in coefficients)
                if terms:
                    return f"_series_solutions([{given}], {terms})", _LEAF
                return f"_propagated([{given}])", _LEAF
            case Roots(coefficients):
                return f"_characteristic_roots([{', '.join(self.print(c) for c in coefficients)}])", _LEAF
            case ModeValues(roots, length):
                return f"_mode_values({self.print(roots)}[:-1], {self.print(length)})", _LEAF
            case ModalValue(modes, coefficients, frames):
                lists = (f"[{', '.join(self.print(x) for x in xs)}]" for xs in (modes, coefficients))
                return f"_modal_value({', '.join(lists)}, {frames!r})", _LEAF
            case Item(values, position):
                return f"{self._within(values, _LEAF)}[{position}]", _LEAF
        message = f"no text for {type(node).__name__}"
        raise TypeError(message)

    def _sum(self, terms: Sequence[Node]) -> str:
        text = self._within(terms[0], _PRODUCT)
        for term in terms[1:]:
            if isinstance(term, Negate):
                text += f" - {self._within(term.operand, _PRODUCT)}"
            else:
                text += f" + {self._within(term, _PRODUCT)}"
        return text

    def _within(self, node: Node, tightest: int) -> str:
        text, binding = self._print(node)
        return text if binding >= tightest else f"({text})"


def _complex(real: Fraction, imaginary: Fraction) -> str:
    if not real:
        return f"({float(imaginary)!r}j)"
    return f"({float(real)!r}{float(imaginary):+}j)" if imaginary else f"({float(real)!r}+0j)"


def statement(target: str, value: str, indent: str) -> list[str]:
    """Return ``target = value``, or ``return value``, on as many lines as it needs."""
    opening = f"{indent}{target} " if target == "return" else f"{indent}{target} = "
    if len(opening) + len(value) <= WIDTH:
        return [opening + value]
    # Only between operators: an identifier longer than a line stays whole.
    wrapper = TextWrapper(width=WIDTH - len(indent) - 4, break_long_words=False, break_on_hyphens=False)
    return [f"{opening}(", *(f"{indent}    {line}" for line in wrapper.wrap(value)), f"{indent})"]
