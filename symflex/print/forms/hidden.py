"""What cancelled, for print.

Input: a transfer function, and a form of it where names are wanted.
Output: the cancelled factors:

    spelled out                     sinh(l*sqrt(sqrt(-rho*A*s^2/(E*I)))/2)
    where a form has q = beta*l     sinh(q/2)
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from typing import Final

from flint import fmpz_mpoly

from symflex.algebra import Factored, KernelTable
from symflex.errors import InternalError
from symflex.expressions import Expression, Name, format_expression, number, product_of, quotient, substitute
from symflex.print.forms.arrange import Arranger
from symflex.print.forms.naming import BETA, Naming
from symflex.print.forms.notation import Line, angles_of, constant_symbols, notation_of, reachable
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
        named, found = _named(tf, PrintedForm("", number(1), number(1)))
        opened = _opened(named.where)
        factors = tuple((substitute(e, opened), m) for e, m in found)
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
            return _named(source, form, tf)
    return _named(tf, form)


def _named(
    tf: TransferFunction, form: PrintedForm, checked: TransferFunction | None = None
) -> tuple[PrintedForm, Hidden]:
    """Return a form with lines for the names in cancelled factors, and these, which are compared."""
    factors, scales = list[tuple[Expression, int]](), list[Fraction]()
    for h in tf.hidden:
        own, scale = _of_beams(tf, h.polynomial)
        form, factor = _with_lines(own, form)
        factors.append((factor, h.multiplicity))
        scales.append(scale)
    read_hidden(checked or tf, form, factors, scales)
    return form, tuple(factors)


def _of_beams(tf: TransferFunction, polynomial: fmpz_mpoly) -> tuple[TransferFunction, Fraction]:
    """Return what is as zero as a factor, of beta where that is seen, and what their fourth powers differ by.

    A power of mu makes a function of its fourth power of the factor. It is one of beta beside a number.
    """
    from symflex.print.forms.bending import in_beta  # few factors are of beams

    plain = replace(tf, reduced=Factored.polynomial(tf.ring, polynomial), parts=None)
    used = tf.ring.used_in([polynomial])
    bent = [d for d in tf.kernels.restricted(used).dispersions if d.kind == "bending"]
    kernels = {k.generator for k in tf.kernels.kernels}
    for n in range(4) if len(bent) == 1 else ():
        mu = Factored.generator(tf.ring, bent[0].wavenumbers[0])
        if (made := in_beta(replace(plain, reduced=plain.ratio * mu**n))) is not None:
            beta = next(w for w in made.kernels.wavenumbers if w.startswith(BETA))
            zero = made.ratio / made.ratio.unit / Factored.generator(made.ratio.ring, beta) ** n
            if all(made.ratio.ring.used_in([f]) & kernels for f, _ in zero.factors):
                return replace(made, reduced=zero), made.ratio.unit**4 * Fraction(-4) ** n
    return plain, Fraction(1)


def _with_lines(tf: TransferFunction, form: PrintedForm) -> tuple[PrintedForm, Expression]:
    """Return a form with lines for the names in a function that is one sum, and that sum."""
    used = tf.ring.used_in(f for f, _ in tf.ratio.factors)
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
    factor = substitute(kernel_printer(tf, notation).quotient(tf.ratio), names)
    lines = tuple((name, substitute(e, names)) for name, e in notation.lines if name not in names)
    return replace(form, where=(*form.where, *reachable([factor], lines))), factor


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
