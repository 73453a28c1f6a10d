"""For which values of its parameters a transfer function is minimum phase.

That is, has no zero in the open right half plane. What is said here is proved for all positive values of the
parameters, from the signs of the numerator's coefficients, or from what its zeros are the poles of. Where
neither decides, nothing is said.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from symflex.algebra import LAPLACE, Ring, by_powers, degree_in, irreducible_factors
from symflex.library.elements import CIRCUITS
from symflex.print.forms import Arranger
from symflex.roots.passivity import energy_proof

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.analysis.explanation import ZeroExplanation
    from symflex.expressions import Expression
    from symflex.model import Model
    from symflex.transfer import TransferFunction

Kind = Literal["always", "never", "if positive", "as given", "unknown"]
Sign = Literal["positive", "negative", "indefinite"]

_QUADRATIC: Final = 2


@dataclass(frozen=True, slots=True)
class PhaseCondition:
    """When a transfer function is minimum phase."""

    # ``always`` or ``never``, for all values; ``if positive``: exactly when ``expression`` is not negative;
    # ``as given``: for all values what it is for the given ones; ``unknown``.
    kind: Kind
    reason: str  # how that is known, in words
    expression: Expression | None = None  # of the parameters; for ``if positive``


def minimum_phase(tf: TransferFunction, explained: ZeroExplanation) -> PhaseCondition:
    """Return the condition under which a transfer function is minimum phase.

    ``explained`` says what its zeros are the poles of.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = { m = {}, k = {}, g = {} }
    ... elements.body = { type = "mass", at = "x", m = "m" }
    ... elements.wall = { type = "spring", between = ["x", "ground"], k = "k" }
    ... inputs.F = { force = "x" }
    ... outputs.y = "k*x - g*s^2*x"
    ... ''')
    >>> (tf,) = pipeline.derive_all(model)
    >>> from symflex.analysis.explanation import ZeroExplanation
    >>> minimum_phase(tf, ZeroExplanation("y/F", "noncolocated", "proved", "y", "F")).kind
    'never'
    """
    if explained.kind == "colocated" and explained.status == "proved" and _is_passive(tf.model):
        reason = f"the zeros are the poles of the same passive structure with {explained.held}"
        return PhaseCondition("always", reason)
    if not tf.is_rational:
        if _has_one_scale(tf):
            reason = "the parameters only scale the s plane: all zeros move along rays from the origin"
            return PhaseCondition("as given", reason)
        return PhaseCondition("unknown", "")
    ring = tf.ratio.ring
    s = ring.index[LAPLACE]
    conditions_of = [_of_factor(f, ring, tf) for f, e in tf.ratio.factors if e > 0 and degree_in(f, s)]
    never = [c for c in conditions_of if c.kind == "never"]
    if never:
        return never[0]
    conditions = [c for c in conditions_of if c.kind == "if positive"]
    if any(c.kind == "unknown" for c in conditions_of) or len(conditions) > 1:
        return PhaseCondition("unknown", "")
    if conditions:
        return conditions[0]
    if not conditions_of:
        return PhaseCondition("always", "it has no zeros")
    return PhaseCondition("always", "every factor of the numerator has coefficients of one sign")


def _of_factor(factor: fmpz_mpoly, ring: Ring, tf: TransferFunction) -> PhaseCondition:
    parts = by_powers(ring, factor)
    signs = {power: _sign(part, ring, tf) for power, part in parts.items()}
    definite = {sign for sign in signs.values() if sign != "indefinite"}
    top = max(parts)
    if "indefinite" not in signs.values():
        if len(definite) == 1:
            kind: Kind = "always" if top <= _QUADRATIC else "unknown"
            return PhaseCondition(kind, "")
        changes = sum(a != b for a, b in itertools.pairwise(signs[power] for power in sorted(signs)))
        if changes % 2:
            reason = "the coefficients of a factor of the numerator change sign: it has a positive real zero"
            return PhaseCondition("never", reason)
        return PhaseCondition("unknown", "")
    if set(parts) == {0, _QUADRATIC} and signs[0] != "indefinite":
        leading = parts[_QUADRATIC] if signs[0] == "positive" else -parts[_QUADRATIC]
        expression = Arranger.plain(ring).coefficient(_without_powers(leading, ring))
        reason = (
            "the sign of the highest coefficient decides between a pair on the imaginary axis and a real pair"
        )
        return PhaseCondition("if positive", reason, expression)
    return PhaseCondition("unknown", "")


def _without_powers(polynomial: fmpz_mpoly, ring: Ring) -> fmpz_mpoly:
    """Return a polynomial of the same sign, without the numbers and powers that are its factors."""
    content, factors = irreducible_factors(polynomial)
    product = ring.constant(1 if content > 0 else -1)
    for factor, exponent in factors:
        if len(factor) > 1 or exponent % 2:
            product = product * (factor if len(factor) > 1 else ring.constant(1))
    return product


def _sign(polynomial: fmpz_mpoly, ring: Ring, tf: TransferFunction) -> Sign:
    loose = {p.name for p in tf.model.parameters if p.assume == "real"}
    for i, name in enumerate(ring.names):
        if name in loose and polynomial.degrees()[i]:
            return "indefinite"
    values = [int(c) for c in polynomial.coeffs()]
    if all(v > 0 for v in values):
        return "positive"
    return "negative" if all(v < 0 for v in values) else "indefinite"


def _is_passive(model: Model) -> bool:
    """Tell whether a model is a mechanism that supplies no energy, whatever positive values it has."""
    elements = [use.element for use in model.elements]
    return (
        all(p.assume != "real" for p in model.parameters)
        and all(e.passive is not None and all(p.domain not in CIRCUITS for p in e.ports) for e in elements)
        and energy_proof(model, free=[p.name for p in model.parameters]).is_passive
    )


def _has_one_scale(tf: TransferFunction) -> bool:
    """Tell whether the numerator, powers of its symbols aside, holds nothing but kernels of one wavenumber.

    Then its zeros are numbers in the product of wavenumber and length, and s is a positive multiple of a
    power of that product.
    """
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
    return len(lengths) == 1 and kinds <= {"bending", "wave"} and _is_lossless(tf)


def _is_lossless(tf: TransferFunction) -> bool:
    """Tell whether the wavenumber is a power of s times parameters."""
    return all(
        len(factor) == 1
        for law in tf.kernels.dispersions
        for c in law.characteristic
        for factor, _ in c.factors
    )
