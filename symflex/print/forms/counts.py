"""How many zeros and poles a transfer function has, for print."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.transfer.transfer_function import degree

if TYPE_CHECKING:
    from symflex.algebra import Factored
    from symflex.transfer import TransferFunction


def counts_of(tf: TransferFunction) -> tuple[int | None, int | None]:
    """Return the numbers of zeros and poles, ``None`` for infinitely many."""
    return _roots_of(tf.num, tf), _roots_of(tf.den, tf)


def _roots_of(value: Factored, tf: TransferFunction) -> int | None:
    ring = value.ring
    kernels = [
        k for k in tf.kernels.kernels if any(f == ring.generator(k.generator) for f, _ in value.factors)
    ]
    places = [ring.index[k.generator] for k in tf.kernels.kernels]
    in_sums = any(len(f) > 1 and any(int(f.degrees()[i]) for i in places) for f, _ in value.factors)
    # An exponential by itself is nowhere zero.
    if in_sums or any(k.function != "exp" for k in kernels):
        return None
    return degree(value.numerator())
