"""Expressions of a program tree as Python text for numpy."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import TextWrapper
from typing import TYPE_CHECKING

from symflex.codegen.infix import InfixPrinter
from symflex.codegen.program.evaluate import NUMPY_FUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from symflex.codegen.program import Node
    from symflex.codegen.program.nodes import Frames

WIDTH = 88


@dataclass(frozen=True)
class Printer(InfixPrinter):
    """Prints expressions as Python.

    Parameters
    ----------
    space : str
        What functions are looked up in.
    """

    space: str = "np"

    def assignment(self, name: str, value: Node, indent: str) -> list[str]:
        """Return the lines of an assignment."""
        return statement(self.locals[name], self.print(value), indent)

    @property
    def pi(self) -> str:
        """The number pi."""
        return f"{self.space}.pi"

    def applied(self, function: str, argument: Node) -> str:
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

    def listed(self, texts: Iterable[str]) -> str:
        """Return a list."""
        return f"[{', '.join(texts)}]"

    def item(self, values: str, position: int) -> str:
        """Return one value of a list."""
        return f"{values}[{position}]"

    def call(self, function: str, arguments: Sequence[str]) -> str:
        """Return a call of a run-time function."""
        if function == "mode_values":
            # What finds the roots also gives the least distance of two.
            roots, length = arguments
            arguments = (f"{roots}[:-1]", length)
        return f"_{function}({', '.join(arguments)})"

    def frames(self, frames: Frames) -> str:
        """Return the frames of a sum of exponentials."""
        return repr(frames)


def statement(target: str, value: str, indent: str) -> list[str]:
    """Return ``target = value``, or ``return value``, on as many lines as it needs."""
    opening = f"{indent}{target} " if target == "return" else f"{indent}{target} = "
    if len(opening) + len(value) <= WIDTH:
        return [opening + value]
    # Only between operators: an identifier longer than a line stays whole.
    wrapper = TextWrapper(width=WIDTH - len(indent) - 4, break_long_words=False, break_on_hyphens=False)
    return [f"{opening}(", *(f"{indent}    {line}" for line in wrapper.wrap(value)), f"{indent})"]
