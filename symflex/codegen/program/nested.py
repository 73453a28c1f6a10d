"""From a nested transfer function to the program that computes it, one assignment per shared step.

Input: a :class:`symflex.transfer.NestedTransferFunction`.
Output: a :class:`Piecewise` of one piece: nothing in it is a power of s above the second or so, nor a
product of many impedances, so nothing overflows long before the value does.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.codegen.program.build import PI, constant_of
from symflex.codegen.program.forge import Forge
from symflex.codegen.program.schedule import schedule
from symflex.errors import BudgetError, Diagnostic
from symflex.print.forms import step_names

if TYPE_CHECKING:
    from symflex.codegen.program.nodes import Piecewise
    from symflex.transfer import NestedTransferFunction

OPERATION_LIMIT = 100_000
"""Operations a program may have; beyond that its text would be many megabytes."""


def build_nested(tf: NestedTransferFunction) -> Piecewise:
    """Return the program of a nested transfer function.

    Raises BudgetError: SF503 when it would be too large.

    Examples
    --------
    >>> from symflex import pipeline
    >>> (G,) = pipeline.derive_nested(pipeline.loads('''
    ... symflex = 1
    ... parameters = {m = "2 kg", b = "3 N*s/m"}
    ... elements.body = {type = "mass", at = "x", m = "m"}
    ... elements.loss = {type = "damper", between = ["x", "ground"], b = "b"}
    ... inputs.F = {force = "x"}
    ... outputs.V = "s*x"
    ... '''))
    >>> build_nested(G).size
    4
    """
    size = tf.size
    if size > OPERATION_LIMIT:
        message = f"a program for {tf.name} would have {size} operations, more than {OPERATION_LIMIT}"
        raise BudgetError(Diagnostic("SF503", message, None, "evaluate it with the Python interface"))
    forge = Forge()
    program = tf.program
    parameters = {p.name for p in tf.model.parameters}
    constants = {c.generator: c.expression for c in tf.constants}

    def generator(position: int) -> int:
        name = program.names[position]
        if name == LAPLACE:
            return forge.s
        if name == PI:
            return forge.constant(1, 1)
        return forge.parameter(name) if name in parameters else constant_of(forge, tf.model, constants[name])

    made = program.values(
        program.operations(tf.steps),
        name=generator,
        number=lambda x: forge.divide(forge.constant(x.numerator), forge.constant(x.denominator)),
        negative=forge.negate,
        total=forge.add,
        product=forge.multiply,
        quotient=forge.divide,
        power=forge.power,
    )
    for i, name in step_names(tf).items():
        forge.label(forge.signed(made[i])[1], name)
    whole = forge.divide(made[tf.num], made[tf.den])
    return schedule(forge, tuple(p.name for p in tf.parameters), whole, None, inf)
