"""The characteristic function of a model as a polynomial in one gain.

Input: a transfer function derived with the gain as a symbol. Output: a :class:`Loop`: the factors of the
equations' determinant, before anything cancelled from it, each a polynomial in the gain.

Example: ``m s^2 + b s + k`` with a gain K on the position is ``(m s^2 + b s + k) + K``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import fmpq, fmpq_mat, fmpz_mpoly

from symflex.algebra import Factored, degree_in
from symflex.algebra.ring import coefficients_of
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.expressions import Sum, names_among
from symflex.loops.gain_functions import GainFunctions
from symflex.model import Model, ModelParameter
from symflex.model.settings import check_free
from symflex.transfer import BoundTransferFunction, Given, TransferFunction, bind, bind_polynomials
from symflex.transfer.bind import values_for

TRIALS = ("1", "2", "0.37")  # values of a gain without one, to bind other parameters; one is not singular
NO_LOOP = "a loop is closed in [signals], as in e = 'r - y', u = 'K*e'"  # where nothing moves a pole


@dataclass(frozen=True, slots=True)
class GainPolynomial:
    """One factor of the characteristic function: ``sum(coefficients[i] * K^i)``."""

    coefficients: tuple[Factored, ...]  # functions of s over the ring, from K^0 on; some may be zero
    multiplicity: int  # how often the factor occurs
    is_hidden: bool = False  # it cancelled from the transfer function the loop was read from
    exponents: tuple[tuple[int, ...], ...] = ()  # per coefficient, of the gain and of functions of it
    symbolic: fmpz_mpoly | None = None  # the factor over the ring of the transfer function

    @property
    def degree(self) -> int:
        """In the gain; at least 2 where functions of it occur, as it is no straight line in the gain then."""
        return 2 if self.exponents else len(self.coefficients) - 1

    @property
    def terms(self) -> list[tuple[tuple[int, ...], Factored]]:
        """The coefficients that are not zero with their exponents."""
        exponents = self.exponents or tuple((i,) for i in range(len(self.coefficients)))
        return [(e, c) for e, c in zip(exponents, self.coefficients, strict=True) if not c.is_zero]

    def at(self, gain: Fraction) -> Factored:
        """Return the factor for one value of the gain, a function of s."""
        return sum((c * gain**i for i, c in enumerate(self.coefficients[1:], 1)), self.coefficients[0])

    def value_in(self, bound: BoundTransferFunction, gain: Fraction, loop: Loop | None) -> Factored:
        """Return the factor for one gain; where a loop is given, over the ring of what is bound for it."""
        if loop is None or self.symbolic is None:
            return self.at(gain)
        return bind_polynomials(loop.source, bound, [self.symbolic])[0]


@dataclass(frozen=True)
class Loop:
    """The characteristic function of a model: its roots are all closed-loop poles, hidden ones too."""

    bound: BoundTransferFunction  # carries the ring, the constants and the kernels; its gain has any value
    gain: ModelParameter  # k
    nominal: Fraction | None  # the gain's value, where it is a rational number
    factors: tuple[GainPolynomial, ...]  # of the characteristic function, up to what has no roots
    source: TransferFunction  # with the gain as a symbol
    given: Mapping[str, Given] = field(default_factory=dict)  # values in place of declared ones
    functions: GainFunctions | None = None  # of the gain, which the factors hold

    def __repr__(self) -> str:
        return f"<Loop of {self.bound.name} with gain {self.gain.name}>"

    @property
    def model(self) -> Model:
        """Whose characteristic function it is."""
        return self.bound.source.model

    def bound_at(self, gain: Fraction) -> BoundTransferFunction:
        """Return the transfer function for one value of the gain."""
        return bind(self.source, {**self.given, self.gain.name: gain}, varied=(self.gain.name,))

    @property
    def with_gain(self) -> tuple[GainPolynomial, ...]:
        """The factors that depend on the gain."""
        return tuple(factor for factor in self.factors if factor.degree)

    @property
    def has_waves(self) -> bool:
        """Whether a factor that depends on the gain has kernels."""
        used = (f for factor in self.with_gain for value in factor.coefficients for f, _ in value.factors)
        return not self.bound.ratio.ring.used_in(used).isdisjoint(self.bound.kernels.generators)


def characteristic_loop(
    tf: TransferFunction, gain: ModelParameter, values: Mapping[str, Given] | None = None
) -> Loop:
    """Return a function's characteristic function with the gain as a symbol; SF801 where it is no gain."""
    ring, given = tf.ratio.ring, dict(values or {})
    calls = {c.generator: c.expression for c in tf.constants if c.generator in gain_generators(tf, gain.name)}
    positions = [ring.index[name] for name in (gain.name, *calls)] if gain.name in ring.index else []
    root = tf.model.root
    is_in_root = root is not None and names_among(Sum((root.slope, root.shift)), (gain.name,))
    if is_in_root or any(v.depends_on(ring.names[i]) for v in tf.kernels.values for i in positions):
        message = f"'{gain.name}' is part of a wavenumber, a length or a delay and cannot be a gain"
        raise no_loop("SF801", message, gain)
    factors = [(f, e, False) for f, e in tf.den.factors]
    factors += [(h.polynomial, h.multiplicity, True) for h in tf.hidden]
    if not any(degree_in(f, i) for f, _, _ in factors for i in positions):
        message = f"no pole of the model depends on '{gain.name}'"
        raise ModelError(Diagnostic("SF801", message, gain.span, NO_LOOP))
    bound = _bound(tf, gain, given)
    if bound.symbolic is not None:  # derived anew with some of the values: its ring is another
        remaining = {p.name for p in bound.source.model.parameters}
        if gain.name in remaining:
            return characteristic_loop(bound.source, gain, {n: v for n, v in given.items() if n in remaining})
    known = dict(bound.all_values)
    # Bound it may have another value, where nothing is singular.
    declared = gain.value is not None or gain.name in given
    nominal = dict(values_for(tf.model, (gain,), given))[gain.name] if declared else None
    rational = None if nominal is None or nominal.pi_power else nominal.rational
    polynomials: list[GainPolynomial] = []
    for factor, exponent, is_hidden in factors:
        parts = dict(sorted(coefficients_of(ring, factor, positions).items()))
        exponents = tuple(parts)
        if not any(any(key[1:]) for key in parts):
            no_calls, exponents = (0,) * len(calls), ()
            parts = {(i,): parts.get((i, *no_calls), ring.constant(0)) for i in range(max(parts)[0] + 1)}
        pieces = bind_polynomials(tf, bound, tuple(parts.values()))
        polynomials.append(GainPolynomial(pieces, exponent, is_hidden, exponents, factor))
    inside = {name: v for name, v in known.items() if any(names_among(c, {name}) for c in calls.values())}
    is_plain = not any(factor.exponents for factor in polynomials)
    functions = None if is_plain else GainFunctions(gain.name, calls, inside, rational)
    return Loop(bound, gain, rational, tuple(polynomials), tf, given, functions)


def gain_generators(tf: TransferFunction, gain: str) -> frozenset[str]:
    """Return the generators that depend on a gain: itself, and functions of constants that contain it."""
    names = {gain, *(c.generator for c in tf.constants if names_among(c.expression, {gain}))}
    return frozenset(names & set(tf.ratio.ring.index))


def no_loop(code: str, message: str, gain: ModelParameter) -> ModelError:
    """Return what says that a parameter is no gain, and how its poles are followed all the same."""
    hint = f"follow its poles by value: symflex sweep FILE --over {gain.name}=FROM:TO:lin:20"
    if code == "SF801":
        hint = f"ask for its stable values: symflex stability FILE --over {gain.name}; or {hint}"
    return ModelError(Diagnostic(code, message, gain.span, hint))


def _bound(tf: TransferFunction, gain: ModelParameter, given: dict[str, Given]) -> BoundTransferFunction:
    """Return the function with numbers, the gain with one for which nothing is singular."""
    candidates = [given] if gain.name in given or gain.value is not None else []
    candidates += [{**given, gain.name: trial} for trial in TRIALS]
    for candidate in candidates[:-1]:
        try:
            return bind(tf, candidate, varied=(gain.name,))
        except ModelError as error:
            if error.diagnostics[0].code != "SF231":
                raise
    return bind(tf, candidates[-1], varied=(gain.name,))


GAINS_LISTED = 24


def pick_gain(parameters: Sequence[ModelParameter], name: str) -> ModelParameter:
    """Return a model's parameter by its name; SF902 when there is none."""
    from symflex.errors.diagnostic import nearest

    known = {p.name: p for p in parameters}
    if name not in known:
        hint = nearest(name, known) or (
            "parameters: " + ", ".join(list(known)[:GAINS_LISTED])
            if known
            else "the gain is a parameter of a loop in [signals] or [blocks]; 'symflex new servo' writes one"
        )
        message = f"there is no parameter '{name[:64]}'" if name else "name the gain of the loop: --gain K"
        raise UsageError(Diagnostic("SF902", message, None, hint))
    check_free(known[name])
    return known[name]


def independent(polynomials: Sequence[fmpz_mpoly]) -> tuple[list[int], list[list[fmpq]]]:
    """Return which polynomials are independent, and for each of these its shares in all of them."""
    monomials = sorted({m for f in polynomials for m in f.monoms()})
    terms = [dict(f.terms()) for f in polynomials]
    matrix = fmpq_mat([[int(coefficients.get(m, 0)) for coefficients in terms] for m in monomials])
    reduced, rank = matrix.rref()
    rows = [[reduced[i, j] for j in range(len(polynomials))] for i in range(rank)]
    return [next(j for j, share in enumerate(row) if share != 0) for row in rows], rows
