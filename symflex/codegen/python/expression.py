"""Expressions of a program tree as Python text, for numpy or any other library of arrays.

The names of functions are those of the Python array API standard, which numpy's are too.
"""

from __future__ import annotations

from cmath import isfinite
from dataclasses import dataclass, field
from textwrap import TextWrapper
from typing import TYPE_CHECKING, Any

from symflex.codegen.infix import InfixPrinter
from symflex.codegen.program.evaluate import NUMPY_FUNCTIONS, number_of
from symflex.codegen.program.nodes import Apply, CodeNode, LargerRoot

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.codegen.program.nodes import Frames

WIDTH = 88
"""Columns of generated Python."""


@dataclass(frozen=True)
class PythonPrinter(InfixPrinter):
    """Prints expressions as Python of numpy."""

    space: str = "np"  # what functions are looked up in

    def assignment(self, name: str, value: CodeNode, indent: str) -> list[str]:
        """Return the lines of an assignment."""
        return statement(self.locals[name], self.print(value), indent)

    @property
    def pi(self) -> str:
        """The number pi."""
        return f"{self.space}.pi"

    def applied(self, function: str, argument: CodeNode) -> str:
        """Return the text of a function's value."""
        if function == "complex_exp":
            return f"_complex_exp({self.print(argument)})"
        return f"{self.space}.{NUMPY_FUNCTIONS[function]}({self.print(argument)})"

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        if not real:
            return f"({imaginary!r}j)"
        return f"({real!r}{imaginary:+}j)" if imaginary else f"({real!r}+0j)"

    def power(self, base: str, exponent: int) -> str:
        """Return a power of text that needs no parentheses."""
        return f"{base}**{exponent}"

    def call(self, function: str, arguments: Sequence[str]) -> str:
        """Return a call of a run-time function."""
        if function == "mode_values":
            # What finds the roots also gives the least distance of two.
            roots, length = arguments
            arguments = (f"{roots}[:-1]", length)
        return super().call(function, arguments)

    def frames(self, frames: Frames) -> str:
        """Return the frames of a sum of exponentials."""
        return repr(frames)


@dataclass(frozen=True)
class ArrayPrinter(PythonPrinter):
    """Prints expressions as Python of any library of arrays."""

    # Values of the assignments that depend on no argument. Functions of these are printed as numbers, because
    # array libraries take arrays only.
    numbers: Mapping[str, Any] = field(default_factory=dict)
    has_fixed_sizes: bool = False  # true to print magnitudes as ``_size``, which has no derivative
    leading: str = ""  # first arguments of functions that look others up

    def print(self, node: CodeNode) -> str:
        """Return the text of an expression."""
        if isinstance(node, LargerRoot):
            return f"_larger({self.leading}{self.print(node.middle)}, {self.print(node.product)})"
        return super().print(node)

    def applied(self, function: str, argument: CodeNode) -> str:
        """Return the text of a function's value."""
        number = number_of(Apply(function, argument), self.numbers)
        if number is not None and isfinite(number):
            return repr(complex(number)) if isinstance(number, complex) else f"({float(number)!r})"
        if function == "abs" and self.has_fixed_sizes:
            return f"_size({self.print(argument)})"
        if function == "complex_exp":
            # numpy's one tangent costs less than a complex exponential, but its derivative loses digits.
            return f"{self.space}.exp({self.print(argument)})"
        return super().applied(function, argument)

    def call(self, function: str, arguments: Sequence[str]) -> str:
        """Return a call of a run-time function."""
        text = super().call(function, arguments)
        takes_space = function not in ("series_solutions", "mode_values")
        return text.replace("(", f"({self.leading}", 1) if takes_space else text


def statement(target: str, value: str, indent: str) -> list[str]:
    """Return ``target = value``, or ``return value``, on as many lines as it needs."""
    opening = f"{indent}{target} " if target == "return" else f"{indent}{target} = "
    if len(opening) + len(value) <= WIDTH:
        return [opening + value]
    # Only between operators: an identifier longer than a line stays whole.
    wrapper = TextWrapper(width=WIDTH - len(indent) - 4, break_long_words=False, break_on_hyphens=False)
    return [f"{opening}(", *(f"{indent}    {line}" for line in wrapper.wrap(value)), f"{indent})"]
