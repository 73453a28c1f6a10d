"""Expressions of a program tree as Python text for any library of arrays.

The names of functions are those of the Python array API standard, which numpy's are too.
"""

from __future__ import annotations

from cmath import isfinite
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from symflex.codegen.numpy.expression import Printer
from symflex.codegen.program import Add, Apply, Divide, Multiply, Negate, Node, Reference
from symflex.codegen.program.evaluate import number_of
from symflex.codegen.program.everywhere import ONE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


@dataclass(frozen=True)
class ArrayPrinter(Printer):
    """Prints expressions as Python, evaluated in the order of the tree.

    Parameters
    ----------
    numbers : mapping of str to number
        Values of the assignments that depend on no argument. Functions of these are printed as numbers,
        because array libraries take arrays only.
    has_fixed_sizes : bool
        True to print magnitudes as ``_size``, which has no derivative.
    meanings : mapping of str to Node
        What the assignments say.
    leading : str
        First arguments of support functions that look others up.
    """

    numbers: Mapping[str, Any] = field(default_factory=dict)
    has_fixed_sizes: bool = False
    meanings: Mapping[str, Node] = field(default_factory=dict)
    leading: str = ""

    def print(self, node: Node) -> str:
        """Return the text of an expression."""
        if (pair := self._pair(node)) is not None:
            middle, product = (self.print(x) for x in pair)
            return f"_larger({self.leading}{middle}, {product})"
        return super().print(node)

    def applied(self, function: str, argument: Node) -> str:
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
        leading = [] if function in ("series_solutions", "mode_values") else [self.leading.rstrip(", ")]
        text = super().call(function, arguments)
        return text.replace("(", f"({leading[0]}, ", 1) if any(leading) else text

    def _pair(self, node: Node) -> tuple[Node, Node] | None:
        """Return m and p of ``m*(1 + sqrt(1 - p/(m*m)))``, the larger root of ``x^2 - 2*m*x + p``.

        Where m is small beside the root of p, the derivative of this form loses digits that its value keeps.
        """
        match node:
            case Multiply((middle, factor)):
                match self._meaning(factor):
                    case Add((first, root)) if first == ONE:
                        return self._under_root(middle, self._meaning(root))
        return None

    def _under_root(self, middle: Node, root: Node) -> tuple[Node, Node] | None:
        match root:
            case Apply("sqrt", argument):
                match self._meaning(argument):
                    case Add((first, Negate(last))) if first == ONE:
                        match self._meaning(last):
                            case Divide(product, square) if self._meaning(square) == Multiply(
                                (middle, middle)
                            ):
                                return middle, product
        return None

    def _meaning(self, node: Node) -> Node:
        return self.meanings.get(node.name, node) if isinstance(node, Reference) else node
