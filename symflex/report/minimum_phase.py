"""For which values of its parameters a transfer function is minimum phase.

That is, has no zero in the open right half-plane. What is said here is proved for all positive values of the
parameters, from the signs of the numerator's coefficients, or from what its zeros are the poles of. Where
neither decides, nothing is said.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from symflex.budget import spend
from symflex.errors import BudgetError
from symflex.expressions import Expression, negative, sum_of
from symflex.symbolic.routh import conditions_of, is_passive
from symflex.transfer import TransferFunction

if TYPE_CHECKING:
    from symflex.analysis.explanation import ZeroExplanation

Kind = Literal["always", "never", "if positive", "as given", "unknown"]


@dataclass(frozen=True, slots=True)
class PhaseCondition:
    """When a transfer function is minimum phase."""

    # ``always`` or ``never``, for all values; ``if positive``: exactly when ``expression`` is not negative;
    # ``as given``: for all values what it is for the given ones; ``unknown``.
    kind: Kind
    reason: str  # how that is known, in words
    expression: Expression | None = None  # of the parameters; for ``if positive``


def minimum_phase(tf: TransferFunction, explained: ZeroExplanation) -> PhaseCondition:
    """Return when a transfer function is minimum phase, whose zeros are ``explained`` as poles."""
    if explained.kind == "colocated" and explained.status == "proved" and is_passive(tf.model):
        reason = f"the zeros are the poles of the same passive structure with {explained.held}"
        return PhaseCondition("always", reason)
    if not tf.is_rational:
        if _has_one_scale(tf):
            reason = "the parameters only scale the s plane: all zeros move along rays from the origin"
            return PhaseCondition("as given", reason)
        return PhaseCondition("unknown", "")
    try:
        found = conditions_of(tf, "zeros", tf.num.factors)
    except BudgetError:
        spend()  # the time may be over
        return PhaseCondition("unknown", "")
    if found.is_never:
        return PhaseCondition("never", "a condition of Routh and Hurwitz is met for no values")
    if not found.conditions:
        return PhaseCondition("always", "this follows from the signs of the numerator's coefficients")
    (first, *others), reason = (
        found.conditions,
        "this is the only condition of Routh and Hurwitz that is left",
    )
    if others or first.sides is None or first.sign != ">":
        return PhaseCondition("unknown", "")
    left, right = first.sides
    return PhaseCondition("if positive", reason, sum_of([left, negative(right)]))


def _has_one_scale(tf: TransferFunction) -> bool:
    """Tell whether all kernels are of one wavenumber: its product with the length then decides."""
    table = tf.kernels
    if len(table.wavenumbers) != 1 or tf.is_nameless or any(p.assume == "real" for p in tf.model.parameters):
        return False
    kernels = {k.generator for k in table.kernels}
    ring = tf.ratio.ring
    for factor, exponent in tf.ratio.factors:
        if exponent < 0 or len(factor) == 1:
            continue
        if not ring.used_in((factor,)) <= kernels:
            return False
    lengths = {str(k.length) for k in table.kernels}
    kinds = {law.kind for law in table.dispersions}
    laws = (c for law in table.dispersions for c in law.characteristic)
    is_lossless = all(len(factor) == 1 for c in laws for factor, _ in c.factors)
    return len(lengths) == 1 and kinds <= {"bending", "wave"} and is_lossless
