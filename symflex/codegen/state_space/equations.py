"""State equations as expressions and as lines of text.

Input: a :class:`symflex.state_space.StateSpace`. Output: its entries, arranged as a person would write them.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from symflex.algebra import irreducible_factors
from symflex.codegen.program.prose import inert
from symflex.expressions import (
    Expression,
    Name,
    format_expression,
    number,
    product_of,
    quotient,
    sum_of,
)
from symflex.print.forms.arrange import Arranger

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.state_space import State, StateSpace
    from symflex.state_space.popov import FieldElement, Vector

ZERO = "0"


class StateEquations:
    r"""The equations of one realisation, for print.

    Parameters
    ----------
    system : StateSpace
        Exact.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = {m = "2 kg", b = "3 N*s/m", k = "8 N/m"}
    ... elements.body = {type = "mass", at = "x", m = "m"}
    ... elements.loss = {type = "damper", between = ["x", "ground"], b = "b"}
    ... elements.wall = {type = "spring", between = ["x", "ground"], k = "k"}
    ... inputs.F = {force = "x"}
    ... outputs.X = "x"
    ... ''')
    >>> print("\n".join(StateEquations(pipeline.state_space(model)).lines()))
    s*x = x_dot
    s*x_dot = -k/m*x - b/m*x_dot + 1/m*F
    X = x
    """

    def __init__(self, system: StateSpace) -> None:
        self.system = system
        self._arranger = Arranger.plain(system.ring, {c.generator: c.expression for c in system.constants})
        self._known: dict[tuple[str, str], Expression] = {}

    def entry(self, value: FieldElement) -> Expression:
        """Return an entry, numerator and denominator factored."""
        if value.is_zero:
            return number(0)
        key = (str(value.num), str(value.den))
        if key not in self._known:
            above, below = (self._arranger.coefficient(part) for part in (value.num, value.den))
            self._known[key] = quotient(above, below)
        return self._known[key]

    def lines(self) -> list[str]:
        """Return one equation per state and per output."""
        system = self.system
        names = [*(x.name for x in system.states), *(x.name for x in system.inputs)]
        count = len(system.states)

        def right(states: Vector, inputs: Vector) -> str:
            parts = {**states, **{count + j: value for j, value in inputs.items()}}
            terms = [product_of([self.entry(value), Name(names[j])]) for j, value in sorted(parts.items())]
            return format_expression(sum_of(terms))

        derivatives = zip(system.states, system.a, system.b, strict=True)
        results = zip(system.outputs, system.c, system.d, strict=True)
        return [
            *(f"s*{state.name} = {right(a, b)}" for state, a, b in derivatives),
            *(f"{output.name} = {right(c, d)}" for output, c, d in results),
        ]

    def grid(self, rows: tuple[Vector, ...], shape: tuple[int, int]) -> list[str]:
        """Return a matrix as lines of aligned entries."""
        height, width = shape
        texts = [
            [inert(format_expression(self.entry(rows[i][j]))) if j in rows[i] else ZERO for j in range(width)]
            for i in range(height)
        ]
        sizes = [max((len(texts[i][j]) for i in range(height)), default=1) for j in range(width)]
        return [
            "[" + "  ".join(t.rjust(size) for t, size in zip(row, sizes, strict=True)) + "]" for row in texts
        ]

    def meaning(self, state: State) -> Expression:
        """Return what a state is, in quantities of the model."""
        return sum_of([product_of([self.entry(value), quantity]) for quantity, value in state.terms])

    @cached_property
    def divisors(self) -> tuple[Expression, ...]:
        """What entries are divided by: the equations hold where none of it is zero."""
        system = self.system
        found: dict[str, fmpz_mpoly] = {}
        for _, rows, _ in system.matrices:
            for row in rows:
                for value in row.values():
                    if not value.den.is_constant():
                        for factor, _ in irreducible_factors(value.den)[1]:
                            found.setdefault(str(factor), factor)
        return tuple(self._arranger.coefficient(factor) for factor in found.values())
