"""The forms a rational approximation can have: a product over poles and zeros, a sum over modes.

A new form is one function and one line in :data:`FORMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mpmath
import numpy as np
from flint import acb, acb_poly, arb, ctx

from symflex.analysis.rational.approximation import PoleZeroGain, RationalEvaluator
from symflex.analysis.rational.laurent import PrincipalPart, about_zero, expand_at_zero, residues_at
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots import Root, precision
from symflex.roots.precision import to_complex_mpmath, to_mpmath
from symflex.transfer.bind import EnclosedTransferFunction

if TYPE_CHECKING:
    from symflex.analysis.rational.approximate import KeptRoots
    from symflex.transfer import BoundTransferFunction

BITS = 256
FINEST = 2.0**-80
"""Accuracy of zeros, relative to the smallest."""
BITS_PER_ROOT = 24
"""Coefficients of a polynomial cancel where its roots span decades."""


@dataclass(frozen=True, eq=False)
class Approximant:
    """What a form makes: see :class:`RationalApproximation` for the fields."""

    function: PoleZeroGain
    evaluator: RationalEvaluator
    residues: tuple[PrincipalPart, ...] = ()
    correction: tuple[mpmath.mpf, ...] = ()
    is_estimate: bool = False


Form = Callable[["BoundTransferFunction", "KeptRoots", int], Approximant]


def product_form(bound: BoundTransferFunction, kept: KeptRoots, digits: int) -> Approximant:
    """Return the product over the poles and zeros that are kept, right to the leading order at s = 0.

    SF405 when the behaviour near s = 0 cannot be told.
    """
    start = expand_at_zero(bound, -(10**6), digits)
    order = _order_at_zero(kept.zeros) - _order_at_zero(kept.poles)
    if order != start.order:
        message = f"the order of {bound.name} at s = 0 is {order} or {start.order}"
        raise UncertifiedError(Diagnostic("SF405", message))
    poles, zeros = _repeated(kept.poles), _repeated(kept.zeros)
    with precision(BITS + BITS_PER_ROOT * (len(poles) + len(zeros))):
        gain = acb(start.coefficients[0])
        for pole in poles:
            gain = gain if pole == 0 else gain * -pole
        for zero in zeros:
            gain = gain if zero == 0 else gain / -zero
        num, den = (
            exact_coefficients(bound)
            if kept.is_exact
            else (_real_coefficients(_from_roots(zeros) * gain), _real_coefficients(_from_roots(poles)))
        )
    function = PoleZeroGain(
        tuple(map(to_complex_mpmath, poles)), tuple(map(to_complex_mpmath, zeros)), num[0], num, den
    )
    evaluator = RationalEvaluator(order, complex(start.coefficients[0].mid()), _array(poles), _array(zeros))
    return Approximant(function, evaluator, is_estimate=start.is_estimate)


def modal_form(bound: BoundTransferFunction, kept: KeptRoots, digits: int) -> Approximant:
    """Return the sum of the principal parts at the poles that are kept, and a static correction.

    With c_1/(s - p) + c_2/(s - p)^2 + ... at every pole and g_0 the coefficient of s^0 in the Laurent series
    of G at s = 0, the correction is g_0 minus what the poles other than 0 contribute at s = 0. SF405 when a
    residue cannot be told.
    """
    highest = kept.excess
    residues = residues_at(bound, kept.poles, digits)
    start = expand_at_zero(bound, highest, digits)
    roots = _repeated(kept.poles)
    with precision(BITS + BITS_PER_ROOT * len(roots)):
        correction = [start.coefficient(i) for i in range(highest + 1)]
        whole = _from_roots(roots)
        num = acb_poly([0])
        for residue in residues:
            for power, coefficient in enumerate(residue.coefficients, 1):
                if not residue.root.is_zero:
                    correction = [
                        c - coefficient * _taylor(residue.pole, power, i) for i, c in enumerate(correction)
                    ]
        for residue in residues:
            others = _from_roots(_repeated([r for r in kept.poles if r is not residue.root]))
            own = acb_poly([-residue.root.enclosure(), 1])
            multiplicity = residue.root.multiplicity
            for power, coefficient in enumerate(residue.coefficients, 1):
                num = num + others * own ** (multiplicity - power) * coefficient
        correction = [acb(about_zero(c.real)) for c in correction]
        num = num + whole * acb_poly(correction)
        if start.order > 0:
            num = num - acb_poly([num.coeffs()[0].mid()])
        above, below = _real_coefficients(num), _real_coefficients(whole)
        if kept.is_exact:
            above, below = exact_coefficients(bound)
            zeros = tuple(map(to_complex_mpmath, _repeated(kept.zeros)))
        else:
            zeros = tuple(map(to_complex_mpmath, _zeros_of(num.coeffs()[: len(above)])))
    function = PoleZeroGain(tuple(map(to_complex_mpmath, roots)), zeros, above[0], above, below)
    terms = tuple(
        (complex(residue.root.enclosure().mid()), power, complex(coefficient.mid()))
        for residue in residues
        for power, coefficient in enumerate(residue.coefficients, 1)
    )
    polynomial = tuple(float(c.real.mid()) for c in correction)
    evaluator = RationalEvaluator(
        start.order,
        complex(start.coefficients[0].mid()),
        _array(roots),
        np.empty(0, dtype=complex),
        terms,
        polynomial,
    )
    is_estimate = start.is_estimate or any(residue.is_estimate for residue in residues)
    constants = tuple(to_mpmath(c.real) for c in correction)
    return Approximant(function, evaluator, residues, constants, is_estimate)


FORMS: dict[str, Form] = {"product": product_form, "modal": modal_form}


def _order_at_zero(roots: Sequence[Root]) -> int:
    return sum(root.multiplicity for root in roots if root.is_zero)


def _repeated(roots: Sequence[Root]) -> list[acb]:
    """Return the midpoints, as often as their multiplicity says."""
    return [root.enclosure().mid() for root in roots for _ in range(root.multiplicity)]


def _array(roots: Sequence[acb]) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    return np.array([complex(root) for root in roots if root != 0], dtype=np.complex128)


def _from_roots(roots: Sequence[acb]) -> acb_poly:
    return acb_poly.from_roots(roots) if roots else acb_poly([1])


def _real_coefficients(polynomial: acb_poly) -> tuple[mpmath.mpf, ...]:
    """Return the real parts in descending powers, without leading ones that cannot be told from zero."""
    coefficients = [c.real for c in polynomial.coeffs()]
    while len(coefficients) > 1 and coefficients[-1].contains(0):
        coefficients.pop()
    return tuple(to_mpmath(arb(0) if c.contains(0) else c) for c in reversed(coefficients))


def _taylor(pole: acb, power: int, i: int) -> acb:
    """Return the coefficient of ``s^i`` in ``1/(s - p)^power``."""
    total = acb(1) / (-pole) ** power
    for k in range(i):
        total = total * (power + k) / (k + 1) / pole
    return total


def exact_coefficients(bound: BoundTransferFunction) -> tuple[tuple[mpmath.mpf, ...], tuple[mpmath.mpf, ...]]:
    """Return numerator and denominator of a rational transfer function, the latter beginning with 1.

    They are those of the function itself, to the working precision.
    """
    function = bound.enclosed(ctx.prec)
    if not isinstance(function, EnclosedTransferFunction):
        message = f"{bound.name} is not rational"
        raise TypeError(message)
    above, below = acb_poly([function.unit]), acb_poly([1])
    for polynomial, exponent in function.factors:
        if exponent > 0:
            above = above * polynomial**exponent
        else:
            below = below * polynomial**-exponent
    lead = below.coeffs()[-1]
    scaled = (acb_poly([c / lead for c in part.coeffs()]) for part in (above, below))
    num, den = (_real_coefficients(part) for part in scaled)
    return num, den


def _zeros_of(coefficients: Sequence[acb]) -> list[acb]:
    """Return the roots of a real polynomial, from ascending coefficients, by size; pairs stand together."""
    middle = [acb(about_zero(c.real).mid()) for c in coefficients]
    at_zero = next((i for i, c in enumerate(middle) if c != 0), 0)
    rest = middle[at_zero:]
    if not any(c != 0 for c in rest[1::2]):
        found = [root for square in _isolated(rest[::2]) for root in _square_roots(square)]
    else:
        found = _isolated(rest)
    upper = sorted((z for z in found if not z.imag < 0), key=lambda z: float(abs(z).mid()))
    pairs = [[z] if z.imag == 0 else [z, z.conjugate()] for z in upper]
    return [acb(0)] * at_zero + [z for pair in pairs for z in pair]


def _square_roots(square: acb) -> list[acb]:
    if square.imag != 0:
        root = square.sqrt()
        return [root, -root]
    size = abs(square).sqrt()
    return [acb(size), acb(-size)] if square.real > 0 else [acb(0, size), acb(0, -size)]


def _isolated(coefficients: Sequence[acb]) -> list[acb]:
    """Return the roots of a polynomial with exact real coefficients; real ones have no imaginary part."""
    if len(coefficients) == 1:
        return []
    polynomial = acb_poly(coefficients)
    try:
        found = polynomial.roots()
        smallest = min(float(abs(z).mid()) for z in found)
        found = polynomial.roots(tol=smallest * FINEST)
    except ValueError:
        # Zeros that coincide are not isolated.
        return [acb(complex(z)) for z in np.roots([complex(c) for c in reversed(coefficients)])]
    # Its conjugate would be another root in the same disc.
    return [acb(z.real) if z.imag.contains(0) else z for z in found]
