"""What cancelled, for print."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.forms.arrange import Arranger
from symflex.emit.forms.polynomial import constant_symbols

if TYPE_CHECKING:
    from symflex.expressions import Expression
    from symflex.transfer import TransferFunction


def hidden_expressions(tf: TransferFunction) -> tuple[tuple[Expression, int], ...]:
    """Return the cancelled factors in s, by descending powers of s, with their multiplicities."""
    arranger = Arranger.plain(tf.ratio.ring, constant_symbols(tf))
    return tuple((arranger.collected(h.polynomial), h.multiplicity) for h in tf.hidden)
