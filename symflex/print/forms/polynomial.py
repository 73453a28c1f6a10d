"""Forms over the ring that a function is derived in: polynomial, monic, constant, factored, hyperbolic."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import partial

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, by_powers, degree_in, irreducible_factors
from symflex.expressions import Expression, Name, number, power, product_of, quotient, sum_of
from symflex.print.forms.arrange import Arranger, ProductPrinter, shortest_sides
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.naming import Naming
from symflex.print.forms.notation import (
    Notation,
    constant_symbols,
    notation_of,
    plain_printer,
    wavenumber_laws,
)
from symflex.print.forms.printed import BegunForm, PrintedForm, terms_of
from symflex.transfer import TransferFunction


def polynomial_form(tf: TransferFunction, arranged: Arranged | None = None) -> PrintedForm:
    """Return numerator and denominator by descending powers of s, coefficients collected and factored."""
    notation = Notation({}, ())
    arranger = plain_printer(tf, tf.ratio.ring, arranged).arranger
    if not tf.is_rational:
        notation = notation_of(tf, tf.ratio.ring.used_in(f for f, _ in tf.ratio.factors), Naming.of(tf))
        arranger = kernel_printer(tf, notation).arranger
    num, den = (arranger.collected(side.expand()) for side in (tf.ratio.numerator(), tf.ratio.denominator()))
    return PrintedForm("polynomial", num, den, notation.lines, notation.laws, notation.closed)


def monic_form(tf: TransferFunction) -> PrintedForm:
    """Return the polynomial form divided by the denominator's leading coefficient."""
    return _normalised(tf, "monic", max)


def constant_form(tf: TransferFunction) -> PrintedForm:
    """Return the polynomial form divided by the coefficient of the denominator's lowest power of s."""
    return _normalised(tf, "constant", min)


def _normalised(tf: TransferFunction, name: str, choose: Callable[[Iterable[int]], int]) -> PrintedForm:
    """Return the polynomial form divided by the coefficient of one of the denominator's powers of s."""
    ring = tf.ratio.ring
    arranger = plain_printer(tf, tf.ratio.ring).arranger
    den = tf.ratio.denominator().expand()
    parts = by_powers(ring, den)
    divisor = parts[choose(parts)]
    return PrintedForm(
        name,
        _divided(arranger, ring, tf.ratio.numerator().expand(), divisor),
        _divided(arranger, ring, den, divisor),
    )


def _divided(arranger: Arranger, ring: Ring, polynomial: fmpz_mpoly, divisor: fmpz_mpoly) -> Expression:
    parts = by_powers(ring, polynomial)
    terms = []
    for exponent in sorted(parts, reverse=True):
        common = parts[exponent].gcd(divisor)
        below = divisor / common
        above = parts[exponent] / common
        if int(below.leading_coefficient()) < 0:
            above, below = -above, -below
        if above.is_constant() and below.is_constant():
            coefficient = number(Fraction(*(int(side.leading_coefficient()) for side in (above, below))))
        else:
            coefficient = quotient(arranger.coefficient(above), arranger.coefficient(below))
        terms.append(product_of([coefficient, power(Name(LAPLACE), exponent)]))
    return sum_of(terms) if terms else number(0)


def factored_form(tf: TransferFunction, arranged: Arranged | None = None) -> PrintedForm:
    """Return numerator and denominator as products of irreducible factors, also of roots and kernels."""
    if not tf.is_rational:
        from symflex.print.forms.irreducible import irreducible_kernels  # only with beams

        return in_kernels(tf, "factored", irreducible_kernels(tf.ratio, tf.kernels))
    arranger = plain_printer(tf, tf.ratio.ring, arranged).arranger
    value = tf.radicals.with_powers(tf.ratio)
    return PrintedForm(
        "factored", _irreducible(arranger, value.numerator()), _irreducible(arranger, value.denominator())
    )


def _irreducible(arranger: Arranger, value: Factored) -> Expression:
    """Return number, parameters, powers of s, then polynomials by degree in s."""
    unit = Fraction(value.unit)
    pieces: list[tuple[tuple[object, ...], Expression]] = []
    for factor, exponent in value.factors:
        constant, parts = irreducible_factors(factor)
        unit *= Fraction(constant) ** exponent
        for part, times in parts:
            positive, sign = (part, 1) if int(part.leading_coefficient()) > 0 else (-part, -1)
            unit *= Fraction(sign) ** (exponent * times)
            degree = degree_in(positive, 0)
            own = arranger.kept.name_of(positive) if arranger.kept and len(positive) > 1 else None
            printed = power(own or arranger.collected(positive), exponent * times)
            key = (len(positive) > 1, degree, tuple(tuple(-int(e) for e in m[1:]) for m in positive.monoms()))
            pieces.append((key, printed))
    return product_of([number(unit), *(p for _, p in sorted(pieces, key=lambda item: item[0]))])


def hyperbolic_draft(tf: TransferFunction, arranged: Arranged) -> BegunForm:
    """Begin the form in cosh, sinh, cos and sin of ``q = mu*l``; delays are exponentials."""
    return BegunForm(terms_of(tf.ratio), partial(in_kernels, tf, "hyperbolic", tf.ratio, arranged))


def factored_draft(tf: TransferFunction, arranged: Arranged) -> BegunForm | None:
    """Return what :func:`factored_form` arranges, ``None`` if kernels do not factor."""
    from symflex.print.forms.irreducible import irreducible_kernels  # only with beams

    value = irreducible_kernels(tf.ratio, tf.kernels)
    if (value / tf.ratio).is_one:
        return None
    return BegunForm(terms_of(value), partial(in_kernels, tf, "factored", value, arranged))


def in_kernels(
    tf: TransferFunction, name: str, value: Factored, arranged: Arranged | None = None
) -> PrintedForm:
    """Return a form of a value over the transfer function's ring."""
    notation = notation_of(tf, tf.ratio.ring.used_in(f for f, _ in value.factors), Naming.of(tf))
    printer = kernel_printer(tf, notation, arranged)
    sides = shortest_sides(printer, value, wavenumber_laws(tf))
    return PrintedForm(name, *sides, notation.lines, notation.laws, notation.closed)


def kernel_printer(
    tf: TransferFunction, notation: Notation, arranged: Arranged | None = None
) -> ProductPrinter:
    """Return a printer for values over the transfer function's ring."""
    symbols = {**constant_symbols(tf), **notation.symbols}
    apart = (k.generator for k in tf.kernels.kernels)
    ring = tf.ratio.ring
    arranger = Arranger.plain(ring, symbols, apart, KeptDefinitions.of(tf, ring))
    return (arranged or Arranged()).printer(arranger)
