"""Modes that delays and waves take out exactly, as they fit their frequency a rational number of times.

A ramp of one period takes out a mode: with ``s = j w`` and ``w = 2 pi/T``, ``1 - exp(-s T)`` is 0. If ``w T``
is a rational multiple of pi, every exponential is a root of unity, and a sum of these vanishes if the
cyclotomic polynomial divides it.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt, lcm

from flint import fmpz_poly

from symflex.algebra import LAPLACE, Factored, by_powers
from symflex.algebra.exponential_sum import Argument, arguments_of, exponential_sum
from symflex.balls import precision
from symflex.roots.functions.kernel_function import has_kernels
from symflex.roots.problem import is_complex, polynomial_in_s
from symflex.roots.root import Root
from symflex.transfer import BoundTransferFunction


def is_shared_exactly(bound: BoundTransferFunction, root: Root) -> bool:
    """Tell whether a root of ``s^2 + w^2`` on one side is proved to be one of the other, so many times."""
    for part, other in ((bound.den, bound.num), (bound.num, bound.den)):
        if is_complex(part):
            continue
        for factor, _ in part.factors:
            powers, value = by_powers(part.ring, factor), Factored.polynomial(part.ring, factor)
            if powers.keys() != {0, 2} or has_kernels(value, bound.kernels):
                continue
            with precision(root.working_bits()):
                vanishes = polynomial_in_s(bound, factor).enclosure()(root.enclosure()).contains(0)
            if vanishes:
                rest, lead = (Factored.polynomial(part.ring, powers[n]) for n in (0, 2))
                return _order(bound, other, rest / lead) >= root.multiplicity
    return False


def _order(bound: BoundTransferFunction, part: Factored, square: Factored) -> int:
    """Return how often a product is proved to vanish, at least, at both s with ``s^2 = -square``."""
    arguments = arguments_of(bound.kernels) or ()
    turns = [_half_turns(bound, argument, square) for argument in arguments]
    known = [turn for turn in turns if turn is not None]
    if not known or len(known) < len(turns):
        return 0
    n = lcm(*(turn.denominator for turn in known))
    order = 0
    for factor, exponent in part.factors:
        terms = exponential_sum(part.ring, bound.kernels, arguments, factor)
        if terms is None or any(b for own in terms.terms for _, _, b in own):
            continue
        unities: dict[object, list[int]] = {}  # per monomial, the numbers of powers of exp(j pi/n)
        for own, amplitude in terms.terms.items():
            place = int(sum((known[i] * a for i, a, _ in own), Fraction(0)) * n) % (2 * n)
            for monomial, (number, _) in amplitude.items():  # without bending all numbers are real
                unities.setdefault(monomial, [0] * (2 * n))[place] += number
        cyclotomic = fmpz_poly.cyclotomic(2 * n)
        order += exponent * all((fmpz_poly(x) % cyclotomic).degree() < 0 for x in unities.values())
    return order


def _half_turns(bound: BoundTransferFunction, argument: Argument, square: Factored) -> Fraction | None:
    """Return how many half turns an exponential's argument is at such an s, None if that is not rational."""
    law = next((law for law in bound.kernels.dispersions if argument.wavenumber in law.wavenumbers), None)
    is_wave = law is None or (
        law.kind == "wave" and all(c.is_zero for c in (*law.characteristic[1:], law.shift))
    )
    if not is_wave or "pi" not in square.ring.index:
        return None
    s, pi = (Factored.generator(square.ring, name) for name in (LAPLACE, "pi"))
    speed = (argument.rate / s) ** 2 if law is None else -law.characteristic[0] / s**2
    ratio = bound.radicals.reduced(speed * square * (argument.length / pi) ** 2)
    if not ratio.is_constant or ratio.unit < 0:
        return None
    turn = Fraction(isqrt(ratio.unit.numerator), isqrt(ratio.unit.denominator))
    # A delay turns backwards.
    return (turn if law else -turn) if turn**2 == ratio.unit else None
