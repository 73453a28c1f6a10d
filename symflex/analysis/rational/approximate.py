"""From a bound transfer function to a rational approximation: what it keeps, its form, and its error.

A new form is one function and one line in :data:`FORMS`: a product over poles and zeros, a sum over modes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import takewhile

import mpmath
import numpy as np
from flint import acb, acb_poly, arb

from symflex.analysis.rational.approximation import (
    Approximant,
    RationalApproximation,
    RationalEvaluator,
    scan_error,
)
from symflex.analysis.rational.laurent import about_zero, expand_at_zero, residues_at
from symflex.analysis.rational.toolboxes import DIGITS, check_form
from symflex.analysis.response import check_band, default_band
from symflex.balls import current_bits, precision, to_complex_mpmath, to_mpmath
from symflex.errors import Diagnostic, ModelError, UncertifiedError, refused
from symflex.model.loss_factors import check_causal
from symflex.roots import (
    Band,
    Everything,
    Modes,
    PoleZeroMap,
    Position,
    Root,
    RootProblem,
    find_polynomial_roots,
)
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import DEFAULT_MODES, as_quotient, locate
from symflex.roots.pole_zero_map import is_right
from symflex.roots.root import count_roots, exact_fraction, modes_of
from symflex.transfer import AnyBoundFunction, EnclosedTransferFunction

FURTHER = (1, 4)  # modes beyond those kept that are looked for: a double root is not divided


@dataclass(frozen=True, slots=True)
class KeptRoots:
    """The poles and zeros that are kept."""

    modes: int  # modes among the poles, roots at 0 aside
    poles: tuple[Root, ...]  # poles and zeros: those kept
    zeros: tuple[Root, ...]
    found: PoleZeroMap  # what was known, some of those left out among them
    omitted_hz: float | None  # natural frequency of the first pole left out [Hz]
    is_exact: bool  # nothing is left out of a rational function
    excess: int  # degree of the numerator less that of the denominator if nothing is left out, else 0

    @property
    def highest_hz(self) -> float | None:
        """The highest natural frequency of a pole kept [Hz], of a zero when there is none but 0."""
        for roots in (self.poles, self.zeros):
            frequencies = [root.frequency_hz() for root in roots if not root.is_zero]
            if frequencies:
                return max(frequencies)
        return None


def truncate(bound: AnyBoundFunction, modes: int, digits: int) -> KeptRoots:
    """Return the poles of a number of modes, and the zeros below the first pole left out.

    Poles in the right half-plane stay; zeros go from above until there are no more of them, unless all stay.
    """
    if modes < 0:
        raise refused(f"the number of modes cannot be {modes}")
    for further in FURTHER:
        region = Everything() if bound.is_rational else Modes(modes + further)
        located = locate(bound, region, digits)
        poles, left_out = _lowest(located, modes)
        if left_out or bound.is_rational:
            break
    omitted = min((root.frequency_hz() for root in left_out), default=None)
    zeros, above = _zeros_below(bound, located, omitted, digits)
    is_exact = not left_out and bound.is_rational
    if not is_exact:
        zeros = _no_more_than(zeros, count_roots(poles))
    excess = max(count_roots(zeros) - count_roots(poles), 0) if is_exact else 0
    map_above = replace(located, zeros=above)
    return KeptRoots(len(modes_of(poles)), poles, zeros, map_above, omitted, is_exact, excess)


def _lowest(located: PoleZeroMap, modes: int) -> tuple[tuple[Root, ...], tuple[Root, ...]]:
    """Return the poles of the lowest modes with those at 0 and in the right half-plane, and the others."""
    positions = Modes(modes).classify(located.poles)
    is_kept = [
        p is not Position.OUTSIDE or is_right(r) for r, p in zip(located.poles, positions, strict=True)
    ]
    kept = tuple(r for r, keep in zip(located.poles, is_kept, strict=True) if keep)
    left_out = tuple(r for r, keep in zip(located.poles, is_kept, strict=True) if not keep)
    return (*kept, *located.unstable), left_out


def _zeros_below(
    bound: AnyBoundFunction, located: PoleZeroMap, limit_hz: float | None, digits: int
) -> tuple[tuple[Root, ...], tuple[Root, ...]]:
    """Return the zeros with natural frequencies below a limit, and all that are known."""
    zeros = located.zeros
    if limit_hz is None:
        return zeros, zeros
    if not bound.is_rational and all(root.frequency_hz() < limit_hz for root in zeros):
        # There may be more of them below the limit than were asked for.
        zeros = locate(bound, Band(Fraction(0), Fraction(limit_hz)), digits).zeros
    return tuple(takewhile(lambda root: root.frequency_hz() < limit_hz, zeros)), zeros


def _no_more_than(zeros: Sequence[Root], poles: int) -> tuple[Root, ...]:
    """Leave out zeros from above, mirror images together, until there are no more of them than poles."""
    kept = list(zeros)
    while count_roots(kept) > poles and not kept[-1].is_zero:
        last = kept[-1].frequency_hz()
        kept = [root for root in kept if root.is_zero or root.frequency_hz() < last * (1 - 1e-12)]
    return tuple(kept)


SCANNED_DECADES = 3  # the error is sampled from a thousandth of the lowest natural frequency on


def approximate(
    bound: AnyBoundFunction,
    modes: int | None = None,
    form: str = "product",
    band: tuple[float, float] | None = None,
) -> RationalApproximation:
    """Return a rational function close to a transfer function at low frequencies.

    ``modes`` are kept, besides roots at 0: by default those up to the end of ``band``, else as many as the
    model's ``[analysis]`` gives, else five; if these are all, the function is exact. ``form`` is ``product``
    or ``modal``, see :data:`symflex.analysis.rational.FORMS`. The error is stated in ``band`` [Hz], by
    default from a thousandth of the lowest natural frequency to the highest one kept.

    SF902 for an unknown form or a negative number of modes, SF227 for a band that is empty or not positive,
    SF402 when the function is identically zero, SF405 when residues, or the behaviour near s = 0, cannot be
    determined.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.rod = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> (bound,) = pipeline.derive_bound(model, [("X", "F")])  # tanh(s)/s
    >>> R = approximate(bound, modes=2)
    >>> [round(float(pole.imag / np.pi), 12) for pole in R.poles]
    [0.5, -0.5, 1.5, -1.5]
    >>> print(f"{abs(R(0.5) / bound(0.5)) - 1:.4f}")
    0.0024
    """
    check_causal(bound.source.model, "a rational approximation")
    check_form(form, tuple(FORMS))
    if band is not None:
        check_band(*band)
    if bound.is_reduced or bound.is_rational:
        bound = without_lengths_of_zero(as_quotient(bound))
    if bound.is_zero:
        message = f"{bound.name} is identically zero"
        raise ModelError(Diagnostic("SF402", message, None, "the input does not reach the output"))
    if modes is None and band is not None:
        modes = len(modes_of(locate(bound, Band(Fraction(0), Fraction(band[1])), DIGITS).poles))
    elif modes is None:
        modes = bound.source.model.analysis.modes or DEFAULT_MODES
    kept = truncate(bound, modes, DIGITS)
    made = FORMS[form](bound, kept, DIGITS)
    low, high, stated = _bands(kept, band)
    roots = (*kept.poles, *(kept.zeros if form == "product" else ()))
    return RationalApproximation(
        **vars(made) | {"is_estimate": made.is_estimate or any(not root.certified for root in roots)},
        bound=bound,
        form=form,
        modes=kept.modes,
        is_exact=kept.is_exact,
        omitted_hz=kept.omitted_hz,
        scan=scan_error(bound, made.evaluator.at, kept.found, low, high),
        band=stated,
        stability=kept.found.verdict,
    )


def _bands(kept: KeptRoots, band: tuple[float, float] | None) -> tuple[float, float, tuple[float, float]]:
    """Return where the error is sampled, up to the first pole left out, and its band [Hz]."""
    bottom, top = default_band(kept.found)
    low = bottom * 10 / 10**SCANNED_DECADES
    high = kept.omitted_hz or top
    stated = band or (low, kept.highest_hz or high)
    return min(low, stated[0]), max(high, stated[1]), stated


BITS = 256
BITS_PER_ROOT = 24  # coefficients of a polynomial cancel where its roots span decades


Form = Callable[["AnyBoundFunction", KeptRoots, int], Approximant]


def product_form(bound: AnyBoundFunction, kept: KeptRoots, digits: int) -> Approximant:
    """Return the product over kept poles and zeros, right to the leading order at s = 0; SF405 if unknown."""
    start = expand_at_zero(bound, -(10**6), digits)
    order = count_roots(r for r in kept.zeros if r.is_zero) - count_roots(r for r in kept.poles if r.is_zero)
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
        if kept.is_exact:
            num, den = exact_coefficients(bound)
        else:
            sides = (acb_poly.from_roots(zeros) * gain, acb_poly.from_roots(poles))
            num, den = map(_real_coefficients, sides)
    function = (tuple(map(to_complex_mpmath, poles)), tuple(map(to_complex_mpmath, zeros)), num[0], num, den)
    evaluator = RationalEvaluator(order, complex(start.coefficients[0].mid()), _array(poles), _array(zeros))
    return Approximant(*function, evaluator, is_estimate=start.is_estimate)


def modal_form(bound: AnyBoundFunction, kept: KeptRoots, digits: int) -> Approximant:
    """Return the sum of the principal parts at the poles that are kept, and a static correction.

    With c_1/(s - p) + c_2/(s - p)^2 + ... at every pole and g_0 the coefficient of s^0 in the Laurent series
    of G at s = 0, the correction is g_0 minus what the poles other than 0 contribute at s = 0. SF405 when a
    residue cannot be decided.
    """
    residues = residues_at(bound, kept.poles, digits)
    start = expand_at_zero(bound, kept.excess, digits)
    roots = _repeated(kept.poles)
    terms = [(part, power, c) for part in residues for power, c in enumerate(part.coefficients, 1)]
    with precision(BITS + BITS_PER_ROOT * len(roots)):
        correction = [start.coefficient(i) for i in range(kept.excess + 1)]
        denominator = acb_poly.from_roots(roots)
        num = acb_poly([0])
        for residue, power, coefficient in terms:
            root = residue.root
            if not root.is_zero:
                correction = [
                    c - coefficient * _taylor(residue.pole, power, i) for i, c in enumerate(correction)
                ]
            others = acb_poly.from_roots(_repeated([r for r in kept.poles if r is not root]))
            num = num + others * acb_poly([-root.enclosure(), 1]) ** (root.multiplicity - power) * coefficient
        correction = [acb(about_zero(c.real)) for c in correction]
        num = num + denominator * acb_poly(correction)
        if start.order > 0:
            num = num - acb_poly([num.coeffs()[0].mid()])
        if kept.is_exact:
            above, below = exact_coefficients(bound)
            zeros = _repeated(kept.zeros)
        else:
            above, below = _real_coefficients(num), _real_coefficients(denominator)
            exact = [exact_fraction(about_zero(c.real)) for c in num.coeffs()[: len(above)]]
            zeros = _repeated(find_polynomial_roots(RootProblem.from_rationals(exact), digits))
    evaluator = RationalEvaluator(
        start.order,
        complex(start.coefficients[0].mid()),
        _array(roots),
        np.empty(0, dtype=complex),
        tuple((complex(r.root.enclosure().mid()), power, complex(c.mid())) for r, power, c in terms),
        tuple(float(c.real.mid()) for c in correction),
    )
    is_estimate = start.is_estimate or any(residue.is_estimate for residue in residues)
    constants = tuple(to_mpmath(c.real) for c in correction)
    function = (tuple(map(to_complex_mpmath, roots)), tuple(map(to_complex_mpmath, zeros)), above[0])
    return Approximant(*function, above, below, evaluator, residues, constants, is_estimate)


FORMS: dict[str, Form] = {"product": product_form, "modal": modal_form}


def _repeated(roots: Sequence[Root]) -> list[acb]:
    """Return the midpoints, as often as their multiplicity says."""
    return [root.enclosure().mid() for root in roots for _ in range(root.multiplicity)]


def _array(roots: Sequence[acb]) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    return np.array([complex(root) for root in roots if root != 0], dtype=np.complex128)


def _real_coefficients(polynomial: acb_poly) -> tuple[mpmath.mpf, ...]:
    """Return the real parts in descending powers, without leading ones that may be zero."""
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


def exact_coefficients(bound: AnyBoundFunction) -> tuple[tuple[mpmath.mpf, ...], tuple[mpmath.mpf, ...]]:
    """Return numerator and denominator of a rational transfer function, the latter beginning with 1."""
    function = bound.enclosed(current_bits())
    if not isinstance(function, EnclosedTransferFunction):
        raise TypeError(f"{bound.name} is not rational")
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
