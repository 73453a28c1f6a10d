"""Sums of blocks as the model writes them, where one fraction of all is much longer.

Input: a transfer function from an input to an output along signals that feed nothing back.
Output: its form with every sum left as it is written:

    k*(1/s^2 + a_1/(s^2 + 2*zeta*w_1*s + w_1^2) + a_2/(s^2 + 2*zeta*w_2*s + w_2^2))

Over one denominator the numerator of such a modal sum grows with the square of the number of modes.
"""

from __future__ import annotations

from symflex.algebra import LAPLACE, Ring
from symflex.expressions import (
    FUNCTIONS,
    Call,
    Expression,
    Name,
    Sum,
    names,
    negative,
    number,
    power,
    product_of,
    substitute,
)
from symflex.model import PlacedBlock
from symflex.model.linearity import factored_of
from symflex.print.forms.arrange import Arranger, ProductPrinter
from symflex.print.forms.printed import PrintedForm
from symflex.print.forms.shapes import of_powers, plain, powers_of
from symflex.transfer import TransferFunction


def written_form(tf: TransferFunction) -> PrintedForm | None:
    """Return a transfer function as sums of its output and signals, None if these say something else."""
    model, name = tf.model, tf.input.name
    if (
        tf.hidden
        or tf.input.kind != "signal"
        or any(b.block is None for b in model.blocks)
        or model.has_equations
        or model.imposed
        or model.root is not None  # forms are read back in the root, which no text of the model has
    ):
        return None
    if any(b.block is not None and b.block.type_name == "ss" for b in model.blocks):
        return None
    signals = {x.name: x.expression for x in model.signals}
    whole = tf.output.expression
    for _ in signals:
        whole = substitute(whole, signals)
    # What is linear in the inputs has the value of its gain where one of them is 1 and the others are 0.
    put: dict[str, Expression] = {x.name: number(x.name == name) for x in model.inputs}
    constants = {LAPLACE, "pi", *FUNCTIONS, *(p.name for p in model.parameters)}
    constants |= {d.name for d in model.definitions}
    for block in model.blocks:
        put[block.name] = plain(_opened(block), put)
    used = [n for e in (whole, *put.values()) for n in names(e)]
    if not all(isinstance(n, Name | Call) and n.name in constants | put.keys() for n in used):
        return None
    front, powers = powers_of(plain(whole, put))
    ordered = sorted(powers, key=lambda base: isinstance(base, Sum))
    above = of_powers(front, {base: powers[base] for base in ordered if powers[base] > 0})
    below = product_of([power(base, -n) for base, n in powers.items() if n < 0])
    return PrintedForm("definitions", above, below)


def _opened(placed: PlacedBlock) -> Expression:
    """Return a block's transfer function in its values, which may contain earlier blocks."""
    values = dict(placed.values)
    assert placed.block is not None
    assert placed.formula is not None
    if placed.block.kernel_time:
        return Call("exp", negative(product_of([values[placed.block.kernel_time], Name(LAPLACE)])))
    ring = Ring((LAPLACE, *values))
    transfer = factored_of(placed.formula, ring)
    return substitute(ProductPrinter(Arranger.plain(ring)).quotient(transfer), values)
