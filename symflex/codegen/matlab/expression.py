"""Expressions and statements of a program tree in MATLAB, elementwise throughout."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from symflex.codegen.infix import InfixPrinter, in_lines

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from symflex.codegen.program import CodeNode
    from symflex.codegen.program.nodes import Frames

WIDTH = 88
"""Columns of generated MATLAB."""


@dataclass(frozen=True)
class MatlabPrinter(InfixPrinter):
    """Prints expressions whose values are numbers or columns."""

    times: ClassVar[str] = ".*"
    over: ClassVar[str] = "./"

    def to_complex(self, operand: CodeNode) -> tuple[str, int]:
        """Return the number itself: a square root needs no complex operand to be complex."""
        return self._print(operand)

    def complex_number(self, real: float, imaginary: float) -> str:
        """Return a number as text that needs no parentheses."""
        if not imaginary:
            return repr(real) if real >= 0 else f"({real!r})"
        return (
            f"({real!r} {'-' if imaginary < 0 else '+'} {abs(imaginary)!r}i)" if real else f"({imaginary!r}i)"
        )

    def power(self, base: str, exponent: int) -> str:
        """Return a power of text that needs no parentheses."""
        return f"{base}.^{exponent}"

    def listed(self, texts: Iterable[str]) -> str:
        """Return a cell array."""
        return f"{{{', '.join(texts)}}}"

    def item(self, values: str, position: int) -> str:
        """Return one value of a cell array, counted from 0."""
        return f"{values}{{{position + 1}}}"

    def call(self, function: str, arguments: Sequence[str]) -> str:
        """Return a call of a run-time function."""
        return f"{function}({', '.join(arguments)})"

    def frames(self, frames: Frames) -> str:
        """Return a cell per frame: slots, orders and coefficients of terms, roots and divisors of keys."""
        texts = []
        for slots, terms, keys in frames:
            parts = [
                _matrix([slots], 1),
                _matrix([orders for orders, _ in terms], 1),
                _matrix([[i for _, i in terms]], 1),
                _matrix([key for key, _ in keys], 1),
                _matrix([[divisor for _, divisor in keys]], 0),
            ]
            texts.append(self.listed(parts))
        return self.listed(texts)


def _matrix(rows: Sequence[Sequence[int]], shift: int) -> str:
    if not rows or not rows[0]:
        return f"zeros({len(rows)}, 0)"
    return f"[{'; '.join(', '.join(str(x + shift) for x in row) for row in rows)}]"


def statement(target: str, value: str, indent: str = "  ") -> list[str]:
    """Return ``target = value;`` on as many lines as it needs.

    Examples
    --------
    >>> statement("x", "1.0 .* y")
    ['  x = 1.0 .* y;']
    """
    return continued(f"{target} = {value};", indent)


def continued(text: str, indent: str) -> list[str]:
    """Return one statement, without strings that hold blanks, continued over lines where it is long."""
    if len(indent) + len(text) <= WIDTH:
        return [indent + text]
    more = indent + "    "
    lines = in_lines(text, WIDTH - len(more) - 4)
    broken = [f"{line} ..." for line in lines[:-1]]
    return [f"{more if i else indent}{line}" for i, line in enumerate([*broken, lines[-1]])]
