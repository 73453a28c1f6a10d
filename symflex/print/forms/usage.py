"""What a function has: forms, the refusal of one that it has not, and numbers of zeros and poles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError
from symflex.transfer.transfer_function import degree

if TYPE_CHECKING:
    from symflex.algebra import Factored
    from symflex.transfer import TransferFunction

RATIONAL = ("definitions", "factored", "polynomial", "monic", "constant", "zpk", "frequency")
"""The forms of a rational function."""
DISTRIBUTED = ("hyperbolic", "factored", "krylov", "vaughan", "frequency", "polynomial")
"""The forms of a function with kernels of wavenumbers that have a formula."""
WITHOUT_FORMULA = ("hyperbolic", "krylov", "factored", "polynomial")
"""The forms of a function whose wavenumbers have none."""


def forms_of(tf: TransferFunction) -> tuple[str, ...]:
    """Return the forms a transfer function has."""
    if not tf.is_distributed:
        return RATIONAL
    return WITHOUT_FORMULA if tf.is_nameless else DISTRIBUTED


def refuse(tf: TransferFunction, form: str, reason: str) -> UsageError:
    """Return the error to raise."""
    hint = f"forms of {tf.name}: " + ", ".join(forms_of(tf))
    return UsageError(Diagnostic("SF902", f"{tf.name} has no {form} form: {reason}", None, hint))


def require_kernels(tf: TransferFunction, form: str) -> None:
    """Refuse a rational function.

    Raises UsageError SF902.
    """
    if not tf.is_distributed:
        raise refuse(tf, form, "it is a rational function of s")


def require_rational(tf: TransferFunction, form: str) -> None:
    """Refuse a function with kernels.

    Raises UsageError SF902.
    """
    if tf.is_distributed:
        raise refuse(tf, form, "it is not a rational function of s")


def require_formula(tf: TransferFunction, form: str) -> None:
    """Refuse a function whose wavenumbers have no formula.

    Raises UsageError SF902.
    """
    if tf.is_nameless:
        raise refuse(tf, form, "the exponents of its field equations have no formula")


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
