"""How the ratio of two functions behaves as s tends to zero, by exact power series."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from symflex.algebra import LAPLACE, Factored

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpq_mpoly, fmpz_mpoly

    from symflex.audit.field import Arithmetic

FIRST_TERMS = 8
LAST_TERMS = 64
"""Terms of a power series: tried first, and doubled until the last."""
MOST_TERMS = 60
MOST_WAVES = 3
"""Larger factors take too long; the limit is then left open."""


def behaviour_at_zero(field: Arithmetic, value: Factored) -> tuple[Factored, Fraction] | None:
    """Return ``c`` and ``n`` with ``value ~ c s^n`` as s tends to 0, c free of s; ``None`` if not found."""
    coefficient, order = field.number(value.unit), Fraction(0)
    for factor, exponent in value.factors:
        found = _leading(field, field.reduce(factor))
        if found is None:
            return None
        coefficient = coefficient * found[0] ** exponent
        order += found[1] * exponent
    return field.reduced(coefficient), order / field.ground.order


def _leading(field: Arithmetic, factor: fmpz_mpoly) -> tuple[Factored, Fraction] | None:
    """Return the coefficient and power of the root of s that dominates a factor."""
    steps = _steps(field)
    sums = any(n.startswith("sum(") for n in field.ring.used_in((factor,)))
    used = [i for i in range(len(steps)) if _holds(field, factor, i)]
    if sums or len(used) > MOST_WAVES or len(factor) > MOST_TERMS:
        return None
    if any(steps[i] < 0 for i in used):
        return None
    names = tuple(f"x{i}" for i in range(len(field.ring.names)))
    context = fmpq_mpoly_ctx.get(names, Ordering.lex)
    rational = context.from_dict({tuple(int(e) for e in m): int(c) for m, c in factor.terms()})
    terms = FIRST_TERMS
    while terms <= LAST_TERMS:
        images = [context.gen(i) for i in range(len(names))]
        highest = None
        for i in used:
            step = steps[i]
            if step == 0:
                continue
            places = [field.ring.index[f"{f}({i})"] for f in ("exp", "cos", "sin")]
            argument = context.gen(places[0]) * context.gen(0) ** step
            images[places[0]], images[places[1]], images[places[2]] = _series(argument, terms)
            highest = min(highest or step * terms, step * terms)
        found = _lowest(field, rational.compose(*images, ctx=context), used, highest)
        if found is not None:
            return found
        if highest is None:
            return None
        terms *= 2
    return None


def _steps(field: Arithmetic) -> list[int]:
    """Return per base argument the power of the root of s in it, -1 where it is more than a power."""
    found = []
    for wave in field.ground.waves:
        if any(name.startswith("sum(") for name, _ in wave.key):
            found.append(-1)
            continue
        found.append(int(dict(wave.key).get(LAPLACE, Fraction(0)) * field.ground.order))
    return found


def _holds(field: Arithmetic, factor: fmpz_mpoly, wave: int) -> bool:
    degrees = factor.degrees()
    return any(int(degrees[field.ring.index[f"{f}({wave})"]]) for f in ("exp", "cos", "sin"))


def _series(x: fmpq_mpoly, terms: int) -> tuple[fmpq_mpoly, fmpq_mpoly, fmpq_mpoly]:
    """Return exp, cos and sin of x up to the power ``terms``."""
    grown, even, odd, power = x * 0 + 1, x * 0 + 1, x * 0, x * 0 + 1
    factorial = 1
    for n in range(1, terms + 1):
        power, factorial = power * x, factorial * n
        term = power * fmpq(1, factorial)
        grown = grown + term
        sign = -1 if n // 2 % 2 else 1
        if n % 2:
            odd = odd + sign * term
        else:
            even = even + sign * term
    return grown, even, odd


def _lowest(
    field: Arithmetic, expanded: fmpq_mpoly, used: Sequence[int], highest: int | None
) -> tuple[Factored, Fraction] | None:
    """Return the first coefficient, in ascending powers of the root of s, that does not vanish."""
    waves = {field.ring.index[f"exp({i})"]: _monomial(field, i) for i in used}
    by_power: dict[int, list[tuple[tuple[int, ...], Fraction]]] = {}
    for monomial, coefficient in expanded.terms():
        exponents = tuple(int(e) for e in monomial)
        by_power.setdefault(exponents[0], []).append(
            (exponents, Fraction(int(coefficient.p), int(coefficient.q)))
        )
    for power in sorted(by_power):
        if highest is not None and power > highest:
            return None
        total = field.number(0)
        for exponents, rational in by_power[power]:
            term = field.number(rational)
            for i, exponent in enumerate(exponents[1:], start=1):
                if exponent:
                    term = (
                        term
                        * (
                            waves[i]
                            if i in waves
                            else Factored.polynomial(field.ring, field.ring.context.gen(i))
                        )
                        ** exponent
                    )
            total = total + term
        if not field.is_zero(total):
            return field.reduced(total), Fraction(power)
    return None


def _monomial(field: Arithmetic, wave: int) -> Factored:
    """Return a base argument without s."""
    base = field.ground.waves[wave]
    value = field.number(base.unit)
    for name, exponent in base.key:
        if name == LAPLACE:
            continue
        steps = field.ground.order if name in field.ground.rootable or "(" in name else 1
        value = value * Factored.generator(field.ring, name) ** int(exponent * steps)
    return value
