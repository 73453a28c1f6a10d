"""Gain, zeros and poles in numbers, conjugate pairs as real quadratic factors."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb, fmpz

from symflex.algebra import LAPLACE
from symflex.balls import opposite, precision
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.expressions import Expression, Name, number, power, product_of, sum_of
from symflex.model.loss_factors import check_causal
from symflex.print.forms.printed import PrintedForm
from symflex.roots import Root
from symflex.roots.locate import locate
from symflex.transfer import BoundTransferFunction, EnclosedTransferFunction, TransferFunction, bind

GUARD_DIGITS = 10
BITS_PER_DIGIT = 4


def zpk_form(tf: TransferFunction, digits: int) -> PrintedForm:
    """Return gain times real first- and second-order factors, in decimals; SF404 if roots are not known."""
    check_causal(tf.model, "the zpk form")
    bound = bind(tf)
    if bound.ratio.is_zero:
        return PrintedForm("zpk", number(0), number(1))
    located = locate(bound, None, digits + GUARD_DIGITS)
    if located.certificate.is_exceeded:
        message = f"not all roots of {tf.name} were found: {located.certificate.reason}"
        raise BudgetError(Diagnostic("SF506", message, None, "allow more time, or ask for another form"))
    if any(not root.certified for root in (*located.zeros, *located.poles)):
        message = f"some roots of {tf.name} could not be separated, so their factors are not known"
        hint = (
            "'symflex roots' encloses them together; constants may satisfy a relation: write them without it"
        )
        raise UncertifiedError(Diagnostic("SF404", message, None, hint))
    gain = _decimal(_gain(bound, digits), digits)
    return PrintedForm(
        "zpk",
        product_of([gain, *_factors(located.zeros, digits)]),
        product_of(_factors(located.poles, digits)),
        stability=located.verdict,
    )


def _gain(bound: BoundTransferFunction, digits: int) -> arb:
    """Return the ratio of the leading coefficients of numerator and denominator."""
    bits = 64 + BITS_PER_DIGIT * (digits + GUARD_DIGITS)
    enclosed = bound.enclosed(bits)
    assert isinstance(enclosed, EnclosedTransferFunction)
    with precision(bits):
        gain = enclosed.unit.real
        for polynomial, exponent in enclosed.factors:
            gain = gain * polynomial[polynomial.degree()].real ** exponent
        return gain


def _factors(roots: Sequence[Root], digits: int) -> list[Expression]:
    """Return one factor per real root or conjugate pair, in the order of the roots."""
    s = Name(LAPLACE)
    factors: list[Expression] = []
    for root in roots:
        if root.is_zero:
            factors.append(power(s, root.multiplicity))
        elif root.is_real:
            factors.append(power(sum_of([s, _decimal(opposite(root.re), digits)]), root.multiplicity))
        elif root.im > 0:
            with precision(root.working_bits()):
                damping, stiffness = -2 * root.re, root.re**2 + root.im**2
            terms = [power(s, 2), _decimal(stiffness, digits)]
            if not root.on_imaginary_axis:
                terms.insert(1, product_of([_decimal(damping, digits), s]))
            factors.append(power(sum_of(terms), root.multiplicity))
    return factors


def _decimal(value: arb, digits: int) -> Expression:
    """Return the nearest decimal of the given digits as an exact number."""
    mantissa, exponent = value.mid().man_exp()
    exact = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    if not exact:
        return number(0)
    # Python writes no integer of more than 4300 digits.
    scale = digits - len(str(fmpz(int(abs(exact))))) if abs(exact) >= 1 else digits
    while abs(exact) * Fraction(10) ** scale < Fraction(10) ** (digits - 1):
        scale += 1
    return number(Fraction(round(exact * Fraction(10) ** scale)) / Fraction(10) ** scale)
