"""Elementary functions of constants: each is one generator of the ring with a numeric definition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from flint import arb


@dataclass(frozen=True, slots=True)
class ElementaryFunction:
    """A function the expression language knows."""

    name: str  # as written in a specification
    evaluate: Callable[[arb], arb]  # maps a real or complex ball to a ball at the current precision
    latex: str  # the operator name in LaTeX
    derivative: Callable[[arb], arb]  # the derivative, in the same way


FUNCTIONS: dict[str, ElementaryFunction] = {
    f.name: f
    for f in (
        ElementaryFunction("sqrt", lambda x: x.sqrt(), r"\sqrt", lambda x: 1 / (2 * x.sqrt())),
        ElementaryFunction("exp", lambda x: x.exp(), r"\exp", lambda x: x.exp()),
        ElementaryFunction("log", lambda x: x.log(), r"\log", lambda x: 1 / x),
        ElementaryFunction("sin", lambda x: x.sin(), r"\sin", lambda x: x.cos()),
        ElementaryFunction("cos", lambda x: x.cos(), r"\cos", lambda x: -x.sin()),
        ElementaryFunction("tan", lambda x: x.tan(), r"\tan", lambda x: 1 + x.tan() ** 2),
        ElementaryFunction("sinh", lambda x: x.sinh(), r"\sinh", lambda x: x.cosh()),
        ElementaryFunction("cosh", lambda x: x.cosh(), r"\cosh", lambda x: x.sinh()),
        ElementaryFunction("tanh", lambda x: x.tanh(), r"\tanh", lambda x: 1 - x.tanh() ** 2),
    )
}
