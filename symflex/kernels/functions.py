"""Elementary functions of constants: each is one generator of the ring with a numeric definition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from flint import arb


@dataclass(frozen=True, slots=True)
class ElementaryFunction:
    """A function the expression language knows.

    Parameters
    ----------
    name : str
        As written in a specification.
    evaluate : callable
        Maps a real or complex ball to a ball at the current precision.
    latex : str
        The operator name in LaTeX.
    """

    name: str
    evaluate: Callable[[arb], arb]
    latex: str


FUNCTIONS: dict[str, ElementaryFunction] = {
    f.name: f
    for f in (
        ElementaryFunction("sqrt", lambda x: x.sqrt(), r"\sqrt"),
        ElementaryFunction("exp", lambda x: x.exp(), r"\exp"),
        ElementaryFunction("log", lambda x: x.log(), r"\log"),
        ElementaryFunction("sin", lambda x: x.sin(), r"\sin"),
        ElementaryFunction("cos", lambda x: x.cos(), r"\cos"),
        ElementaryFunction("tan", lambda x: x.tan(), r"\tan"),
        ElementaryFunction("sinh", lambda x: x.sinh(), r"\sinh"),
        ElementaryFunction("cosh", lambda x: x.cosh(), r"\cosh"),
        ElementaryFunction("tanh", lambda x: x.tanh(), r"\tanh"),
    )
}
