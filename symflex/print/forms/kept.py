"""The definitions that forms keep closed.

Input: a transfer function and the ring of a form.
Output: the same ring with a generator per definition, and polynomials of fewer terms over it.

    E*I*rho*A*w^4          with EI = E*I            ->  EI*rho*A*w^4
    b*m_1*s + b*m_2*s      with M = m_1 + m_2       ->  b*M*s
    m_1*m_2*s^2            with M = m_1 + m_2       ->  m_1*m_2*s^2, as m_2*(M - m_2) is no shorter
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring
from symflex.expressions import Name
from symflex.transfer import TransferFunction

REWRITE_LIMIT = 5_000  # number of terms up to which a polynomial is rewritten in definitions


@dataclass(frozen=True, eq=False)
class KeptDefinitions:
    """Rewrites polynomials of one ring in definitions."""

    source: Ring  # of the form
    place: int  # of the first generator that is not a parameter
    # Definitions that are polynomials of its generators with whole coefficients, and of earlier ones.
    values: tuple[tuple[str, Factored], ...]

    @staticmethod
    def of(tf: TransferFunction, source: Ring) -> KeptDefinitions | None:
        """Return the definitions of a transfer function that are over a form's ring; None without any."""
        generators = {*source.names}
        kept: list[tuple[str, Factored]] = []
        for name, value in tf.definitions:
            used = {n for n in value.ring.names if value.depends_on(n)}
            if is_divisor(value) and used <= generators:
                kept.append((name, value))
                generators.add(name)
        parameters = {p.name for p in tf.model.parameters}
        place = 1 + max((i for i, n in enumerate(source.names) if n in parameters), default=0)
        return KeptDefinitions(source, place, tuple(kept)) if kept else None

    @property
    def adds(self) -> bool:
        """Tell whether a definition is no generator of the form's own ring yet."""
        return len(self.ring.names) > len(self.source.names)

    @cached_property
    def ring(self) -> Ring:
        """The form's ring and a generator per definition, after the parameters."""
        names_, place = self.source.names, self.place
        more = (name for name, _ in self.values if name not in names_)
        return Ring((*names_[:place], *more, *names_[place:]))

    @cached_property
    def _divisors(self) -> tuple[tuple[fmpz_mpoly, fmpz_mpoly, bool], ...]:
        """Multiples of definitions over :attr:`ring`, what these are there, and whether they bear s."""
        values = ((name, value.over(self.ring), value) for name, value in self.values)
        return tuple((*divisor_of(name, over), value.depends_on(LAPLACE)) for name, over, value in values)

    def rewrite(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return a polynomial of the form's ring in the definitions free of s that shorten it."""
        ring = self.ring
        result = ring.taken_over(polynomial, self.source.names)
        if len(result) > REWRITE_LIMIT:
            return result
        free = [(multiple, d) for multiple, d, has_s in self._divisors if not has_s]
        return in_definitions(result, free, ring)

    def name_of(self, polynomial: fmpz_mpoly) -> Name | None:
        """Return the definition that a polynomial of the form's ring is."""
        wanted = self.ring.taken_over(polynomial, self.source.names)
        own = zip(self.values, self._divisors, strict=True)
        return next((Name(n) for (n, x), (_, d, _) in own if d == wanted and x.unit == 1), None)


def is_divisor(value: Factored) -> bool:
    """Tell whether a definition is a polynomial, or a sum over a whole number: others are divided by it."""
    if value.is_constant or value.denominator().factors:
        return False
    is_sum = any(len(f) > 1 for f, _ in value.factors)
    return value.unit.denominator == 1 or (abs(value.unit.numerator) == 1 and is_sum)


def divisor_of(name: str, value: Factored) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return a multiple of a definition with whole coefficients in its name, and as the polynomial it is."""
    times = value.unit.denominator
    return value.ring.generator(name) * times, (value * times).expand()


def in_definitions(
    polynomial: fmpz_mpoly, divisors: Sequence[tuple[fmpz_mpoly, fmpz_mpoly]], ring: Ring
) -> fmpz_mpoly:
    """Return a polynomial in terms of definitions, each used when it saves terms, or is a product."""
    for multiple, divisor in divisors:
        inner = tuple(int(d) > 0 for d in divisor.degrees())
        # What stands before different powers of all else is decided apart.
        parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
        for monomial, coefficient in polynomial.terms():
            exponents = tuple(map(int, monomial))
            key = tuple(0 if i else e for i, e in zip(inner, exponents, strict=True))
            parts.setdefault(key, {})[exponents] = int(coefficient)
        polynomial = ring.constant(0)
        for terms in parts.values():
            part = ring.context.from_dict(terms)
            rewritten = _in_powers_of(part, divisor, multiple, ring)
            is_shorter = len(rewritten) < len(part) or (len(divisor) == 1 and rewritten != part)
            polynomial += rewritten if is_shorter else part
    return polynomial


def _in_powers_of(polynomial: fmpz_mpoly, divisor: fmpz_mpoly, symbol: fmpz_mpoly, ring: Ring) -> fmpz_mpoly:
    """Return ``sum(r_i * symbol**i)`` where ``polynomial = sum(r_i * divisor**i)``."""
    result = ring.constant(0)
    place = ring.constant(1)
    while not polynomial.is_zero():
        polynomial, remainder = divmod(polynomial, divisor)
        result = result + remainder * place
        place = place * symbol
    return result
