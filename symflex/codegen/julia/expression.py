"""Expressions and statements of a program tree in Julia, of scalars."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.codegen.infix import InfixPrinter, in_lines

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from symflex.codegen.program.nodes import Frames

WIDTH = 92
"""Columns, as Julia's own style has it."""


@dataclass(frozen=True)
class JuliaPrinter(InfixPrinter):
    """Prints expressions whose values are numbers."""

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        return f"complex({real!r}, {imaginary!r})"

    def power(self, base: str, exponent: int) -> str:
        """Return a power of text that needs no parentheses."""
        return f"{base}^{exponent}"

    def listed(self, texts: Iterable[str]) -> str:
        """Return a vector."""
        return f"[{', '.join(texts)}]"

    def item(self, values: str, position: int) -> str:
        """Return one value of a vector, counted from 0."""
        return f"{values}[{position + 1}]"

    def call(self, function: str, arguments: Sequence[str]) -> str:
        """Return a call of a run-time function."""
        return f"_{function}({', '.join(arguments)})"

    def frames(self, frames: Frames) -> str:
        """Return a triple per frame: slots, terms, and keys with their divisors."""
        texts = []
        for slots, terms, keys in frames:
            pairs = self.listed(f"({_tuple(orders)}, {i + 1})" for orders, i in terms)
            products = self.listed(f"({_tuple(key)}, {divisor})" for key, divisor in keys)
            texts.append(f"({_tuple(slots)}, {pairs}, {products})")
        return self.listed(texts)


def _tuple(numbers: Sequence[int]) -> str:
    """Return positions, counted from 0, as a tuple of those counted from 1."""
    return repr(tuple(n + 1 for n in numbers))


def statement(target: str, value: str, indent: str = "    ") -> list[str]:
    """Return ``target = value``, or ``return value``, in parentheses where it takes several lines.

    Examples
    --------
    >>> statement("x", "1.0 * y")
    ['    x = 1.0 * y']
    """
    opening = f"{indent}{target} " if target == "return" else f"{indent}{target} = "
    if len(opening) + len(value) <= WIDTH:
        return [opening + value]
    lines = in_lines(value, WIDTH - len(indent) - 4)
    return [f"{opening}(", *(f"{indent}    {line}" for line in lines), f"{indent})"]


def head(name: str, arguments: Sequence[str]) -> list[str]:
    """Return the first lines of a function.

    Examples
    --------
    >>> head("f", ["s", "l"])
    ['function f(s, l)']
    """
    line = f"function {name}({', '.join(arguments)})"
    if len(line) <= WIDTH:
        return [line]
    return [f"function {name}(", *(f"    {a}," for a in arguments[:-1]), f"    {arguments[-1]}", ")"]
