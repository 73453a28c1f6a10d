"""What cancelled, for print."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.forms.arrange import Arranger
from symflex.emit.forms.constants import constant_symbols
from symflex.emit.forms.hyperbolic import kernel_printer
from symflex.emit.forms.notation import Naming, notation_of, used_generators
from symflex.expressions import substitute
from symflex.transfer import NestedTransferFunction

if TYPE_CHECKING:
    from symflex.expressions import Expression
    from symflex.transfer import AnyTransferFunction, TransferFunction


def hidden_expressions(tf: AnyTransferFunction) -> tuple[tuple[Expression, int], ...]:
    """Return the cancelled factors in s, by descending powers of s, with their multiplicities.

    Kernels are written out, ``cosh(l*sqrt(s/(2*sqrt(E*I/(rho*A)))))``: the names of a form mean nothing here.
    """
    if isinstance(tf, NestedTransferFunction):
        return ()  # not looked for
    used = used_generators(tf.ring, (h.polynomial for h in tf.hidden))
    if used & set(tf.kernels.generators):
        return _with_kernels(tf, used)
    arranger = Arranger.plain(tf.ring, constant_symbols(tf))
    return tuple((arranger.collected(h.polynomial), h.multiplicity) for h in tf.hidden)


def _with_kernels(tf: TransferFunction, used: frozenset[str]) -> tuple[tuple[Expression, int], ...]:
    notation = notation_of(tf, used, Naming.of(tf))
    printer = kernel_printer(tf, notation)
    found = []
    for hidden in tf.hidden:
        factor = printer.sum(hidden.polynomial)
        for name, line in notation.lines:
            factor = substitute(factor, {name: line})
        found.append((factor, hidden.multiplicity))
    return tuple(found)
