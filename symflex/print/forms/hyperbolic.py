"""Hyperbolic and circular functions of wavenumber times length."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.print.forms.arrange import Arranger
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.notation import Naming, Notation, constant_symbols, notation_of, wavenumber_laws
from symflex.print.forms.printed import PrintedForm
from symflex.print.forms.products import ProductPrinter, shortest_sides

if TYPE_CHECKING:
    from symflex.algebra import Factored
    from symflex.transfer import TransferFunction


def hyperbolic_form(tf: TransferFunction) -> PrintedForm:
    """Return the function in cosh, sinh, cos and sin of ``q = mu*l``; delays are exponentials."""
    return in_kernels(tf, "hyperbolic", tf.ratio)


def in_kernels(tf: TransferFunction, name: str, value: Factored) -> PrintedForm:
    """Return a form of a value over the transfer function's ring."""
    used = tf.ratio.ring.used_in(f for f, _ in value.factors)
    notation = notation_of(tf, used, Naming.of(tf))
    printer = kernel_printer(tf, notation)
    sides = shortest_sides(printer, value, wavenumber_laws(tf))
    return PrintedForm(name, *sides, notation.lines, notation.laws)


def kernel_printer(tf: TransferFunction, notation: Notation) -> ProductPrinter:
    """Return a printer for values over the transfer function's ring."""
    symbols = {**constant_symbols(tf), **notation.symbols}
    apart = (k.generator for k in tf.kernels.kernels)
    ring = tf.ratio.ring
    return ProductPrinter(Arranger.plain(ring, symbols, apart, KeptDefinitions.of(tf, ring)))


def collected_form(tf: TransferFunction) -> PrintedForm:
    """Return the polynomial form of a function with kernels: both sides by descending powers of s."""
    used = tf.ratio.ring.used_in(f for f, _ in tf.ratio.factors)
    notation = notation_of(tf, used, Naming.of(tf))
    arranger = kernel_printer(tf, notation).arranger
    return PrintedForm(
        "polynomial",
        arranger.collected(tf.ratio.numerator().expand()),
        arranger.collected(tf.ratio.denominator().expand()),
        notation.lines,
        notation.laws,
    )
