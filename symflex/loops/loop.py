"""The characteristic function of a model as a polynomial in one gain.

Input: a transfer function derived with the gain as a symbol.
Output: a :class:`Loop`: the factors of the equations' determinant, before anything cancelled from it.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.algebra import Factored, degree_in
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.transfer import bind, bind_polynomials

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.model import ExactValue, ModelParameter
    from symflex.transfer import BoundTransferFunction, Given, TransferFunction

TRIALS = ("1", "2", "0.37")
"""Values of a gain without one, for which the other parameters are bound; one is not a singular case."""


@dataclass(frozen=True, slots=True)
class GainPolynomial:
    """One factor of the characteristic function: ``sum(coefficients[i] * K^i)``."""

    # Functions of s over the ring of the bound transfer function, from K^0 on; some may be zero.
    coefficients: tuple[Factored, ...]
    multiplicity: int  # how often the factor occurs
    is_hidden: bool = False  # it cancelled from the transfer function the loop was read from

    @property
    def degree(self) -> int:
        """In the gain."""
        return len(self.coefficients) - 1

    def at(self, gain: Fraction) -> Factored:
        """Return the factor for one value of the gain, a function of s."""
        total = self.coefficients[0]
        for i, coefficient in enumerate(self.coefficients[1:], 1):
            total = total + coefficient * gain**i
        return total


@dataclass(frozen=True)
class Loop:
    """The characteristic function of a model: its roots are all closed-loop poles, hidden ones too."""

    bound: BoundTransferFunction  # carries the ring, the constants and the kernels; its gain has any value
    gain: ModelParameter  # k
    nominal: Fraction | None  # the gain's value, where it is a rational number
    # Whose product the characteristic function is, up to what has no roots.
    factors: tuple[GainPolynomial, ...]

    @property
    def with_gain(self) -> tuple[GainPolynomial, ...]:
        """The factors that depend on the gain."""
        return tuple(factor for factor in self.factors if factor.degree)


def characteristic_loop(
    tf: TransferFunction,
    gain: ModelParameter,
    values: Mapping[str, Given] | None = None,
) -> Loop:
    """Return the characteristic function of the model a transfer function is of.

    Any of the model's will do, with the gain as a symbol. SF801 the closed loop does not depend on the gain,
    or the gain shapes waves or delays.
    """
    position = tf.ratio.ring.index.get(gain.name)
    if position is not None and any(value.depends_on(gain.name) for value in tf.kernels.values):
        message = f"'{gain.name}' is part of a wavenumber, a length or a delay, and no gain"
        hint = f"follow its poles by value: symflex sweep FILE --over {gain.name}=FROM:TO:lin:20"
        raise ModelError(Diagnostic("SF801", message, gain.span, hint))
    if position is None or not _depends(tf, position):
        message = f"no pole of the model depends on '{gain.name}'"
        hint = "a loop is closed in [signals], as in e = 'r - y', u = 'K*e'"
        raise ModelError(Diagnostic("SF801", message, gain.span, hint))
    bound = _bound(tf, gain, dict(values or {}))
    nominal = dict(bound.values)[gain.name] if gain.value is not None or gain.name in (values or {}) else None
    factors = [(f, e, False) for f, e in tf.den.factors]
    factors += [(h.polynomial, h.multiplicity, True) for h in tf.hidden]
    found: list[GainPolynomial] = []
    for factor, exponent, is_hidden in factors:
        pieces = bind_polynomials(tf, bound, coefficients_of(factor, position, tf))
        found.append(GainPolynomial(pieces, exponent, is_hidden))
    return Loop(bound, gain, _rational(nominal), tuple(found))


def _depends(tf: TransferFunction, position: int) -> bool:
    polynomials = [*(f for f, _ in tf.den.factors), *(h.polynomial for h in tf.hidden)]
    return any(degree_in(f, position) for f in polynomials)


def _bound(tf: TransferFunction, gain: ModelParameter, given: dict[str, Given]) -> BoundTransferFunction:
    """Return the function with numbers, the gain with one for which nothing is singular."""
    candidates = [given] if gain.name in given or gain.value is not None else []
    candidates += [{**given, gain.name: trial} for trial in TRIALS]
    for candidate in candidates[:-1]:
        try:
            return bind(tf, candidate)
        except ModelError as error:
            if error.diagnostics[0].code != "SF231":
                raise
    return bind(tf, candidates[-1])


def _rational(value: ExactValue | None) -> Fraction | None:
    return None if value is None or value.pi_power else value.rational


def coefficients_of(polynomial: fmpz_mpoly, position: int, tf: TransferFunction) -> tuple[fmpz_mpoly, ...]:
    """Return the coefficients of the powers of one generator, over the same ring."""
    parts: list[dict[tuple[int, ...], int]] = [{} for _ in range(degree_in(polynomial, position) + 1)]
    for monomial, coefficient in polynomial.terms():
        place = tuple(0 if i == position else int(e) for i, e in enumerate(monomial))
        parts[int(monomial[position])][place] = int(coefficient)
    return tuple(tf.ratio.ring.context.from_dict(part) for part in parts)


def pick_gain(parameters: Sequence[ModelParameter], name: str) -> ModelParameter:
    """Return a model's parameter by its name; SF902 when there is none."""
    from symflex.errors.diagnostic import nearest

    known = {p.name: p for p in parameters}
    if name not in known:
        hint = nearest(name, known) or "parameters: " + ", ".join(list(known)[:8])
        raise UsageError(Diagnostic("SF902", f"there is no parameter '{name[:64]}'", None, hint))
    return known[name]
