"""What cancelled, for print.

Input: a transfer function, and a form of it where names are wanted.
Output: the cancelled factors:

    spelled out                     cosh(l*sqrt(s/(2*sqrt(E*I/(rho*A))))/2)
    where a form has q = mu*l       cosh(q/2)
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from typing import Final

from symflex.algebra import KernelTable
from symflex.errors import InternalError
from symflex.expressions import Expression, Name, format_expression, number, product_of, quotient, substitute
from symflex.print.forms.arrange import Arranger
from symflex.print.forms.naming import Naming
from symflex.print.forms.notation import Line, Notation, angles_of, constant_symbols, notation_of, reachable
from symflex.print.forms.polynomial import kernel_printer
from symflex.print.forms.printed import PrintedForm
from symflex.print.forms.shapes import powers_of
from symflex.print.read_back import read_hidden
from symflex.transfer import AnyTransferFunction, TransferFunction

Hidden = tuple[tuple["Expression", int], ...]
MULTIPLES: Final = tuple(Fraction(x) for x in ("1", "2", "1/2", "4", "1/4", "8", "1/8", "3", "1/3"))
"""Multiples of a length that arguments have: forms halve and double lengths, and print thirds."""


def hidden_expressions(tf: AnyTransferFunction) -> Hidden:
    """Return the cancelled factors in s with their multiplicities, kernels written out."""
    if not tf.is_reduced:
        return ()
    tf = tf.whole
    used = tf.ring.used_in(h.polynomial for h in tf.hidden)
    if used & set(tf.kernels.generators):
        notation = notation_of(tf, used, Naming.of(tf))
        opened = _opened(notation.lines)
        factors = tuple((substitute(e, opened), m) for e, m in _factors(tf, notation))
    else:
        arranger = Arranger.plain(tf.ring, constant_symbols(tf))
        factors = tuple((arranger.collected(h.polynomial), h.multiplicity) for h in tf.hidden)
    read_hidden(tf, PrintedForm("", number(1), number(1)), factors)
    if tf.model.root is None:
        return factors
    from symflex.print.forms.root_of_s import in_roots  # few models have one

    return tuple((in_roots(e, tf.model.root), m) for e, m in factors)


def with_hidden(tf: AnyTransferFunction, form: PrintedForm) -> tuple[PrintedForm, Hidden]:
    """Return a form with lines for the names in cancelled factors besides its own, and these factors."""
    if not tf.is_reduced:
        return form, ()
    tf = tf.whole
    has_kernels = tf.ring.used_in(h.polynomial for h in tf.hidden) & set(tf.kernels.generators)
    if tf.model.root or not has_kernels:
        return form, hidden_expressions(tf)
    source = form.source or tf
    if source is not tf and [h.multiplicity for h in source.hidden] == [h.multiplicity for h in tf.hidden]:
        with suppress(InternalError):  # then they are no factors of the function whose definitions are opened
            named = _named(source, form)
            read_hidden(tf, *named)
            return named
    named = _named(tf, form)
    read_hidden(tf, *named)
    return named


def _named(tf: TransferFunction, form: PrintedForm) -> tuple[PrintedForm, Hidden]:
    """Return a form with lines for the names in cancelled factors, and these."""
    used = tf.ring.used_in(h.polynomial for h in tf.hidden)
    notation = notation_of(tf, used, _naming(tf, form))
    own = ((name, e) for name, e in form.where if name not in form.definitions)
    by_value = {_key(e): Name(name) for name, e in _opened(own).items()}
    names: dict[str, Expression] = {
        name: by_value[_key(e)] for name, e in _opened(notation.lines).items() if _key(e) in by_value
    }
    arguments = [name for name, _ in notation.lines][: len(angles_of(tf.kernels, used))]
    for ratio in MULTIPLES[1:]:
        # The same lines with other lengths: an argument that the form has as a multiple of its own.
        # Kernels of other lengths, those that share one sharing one again
        lengths = {k.length: k.length * ratio for k in tf.kernels.kernels}
        kernels = (replace(k, length=lengths[k.length]) if k.wavenumber else k for k in tf.kernels.kernels)
        scaled = notation_of(tf, used, _naming(tf, form), KernelTable(tf.kernels.dispersions, tuple(kernels)))
        for name, expression in _opened(scaled.lines).items():
            if name in arguments and name not in names and _key(expression) in by_value:
                part = product_of([number(ratio.denominator), by_value[_key(expression)]])
                names[name] = quotient(part, number(ratio.numerator))
    factors = tuple((substitute(e, names), m) for e, m in _factors(tf, notation))
    lines = tuple((name, substitute(e, names)) for name, e in notation.lines if name not in names)
    more = reachable([e for e, _ in factors], lines)
    return replace(form, where=(*form.where, *more)), factors


def _factors(tf: TransferFunction, notation: Notation) -> Hidden:
    printer = kernel_printer(tf, notation)
    return tuple((printer.sum(h.polynomial), h.multiplicity) for h in tf.hidden)


def _naming(tf: TransferFunction, form: PrintedForm) -> Naming:
    """Return a naming that leaves a form its names, and gives the same ones every time."""
    naming = Naming.of(tf)
    naming.keep(name for name, _ in form.where)
    return naming


def _opened(lines: Iterable[Line]) -> dict[str, Expression]:
    """Return what names stand for, with no other name of the lines left in it."""
    opened_lines = dict(lines)
    for _ in opened_lines:
        opened = {name: substitute(e, opened_lines) for name, e in opened_lines.items()}
        if opened == opened_lines:
            break
        opened_lines = opened
    return opened_lines


def _key(expression: Expression) -> tuple[str, ...]:
    """Return what is equal for products that differ in the order of factors: ``mu*l/2`` and ``l*mu/2``."""
    front, powers = powers_of(expression)
    return (str(front), *sorted(f"{format_expression(base)}^{n}" for base, n in powers.items()))
