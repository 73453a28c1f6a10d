"""Rational transfer functions as objects of the Control System Toolbox.

Input: a transfer function without kernels, but for one dead time of all of it.
Output: a function of its coefficients, and one that makes ``tf``, ``zpk`` or ``ss`` of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.algebra import LAPLACE, Factored
from symflex.codegen.module_text import FORMULA_TERMS
from symflex.expressions import number, sum_of
from symflex.print.forms.arrange import Arranger
from symflex.print.forms.notation import constant_symbols, plain_printer
from symflex.transfer import TransferFunction

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.expressions import Expression
    from symflex.transfer import AnyTransferFunction

MOST_COEFFICIENTS: Final = 200


@dataclass(frozen=True, slots=True)
class RationalSystem:
    """A quotient of polynomials in s, and a dead time."""

    tf: TransferFunction  # what it is
    # num and den: coefficients by descending powers of s.
    num: tuple[Expression, ...]
    den: tuple[Expression, ...]
    delay: Expression  # [s]; the number 0 without one

    @staticmethod
    def of(tf: AnyTransferFunction) -> RationalSystem | None:
        """Return a transfer function as a rational one, None where it is not one or too long to write out."""
        if not isinstance(tf, TransferFunction) or tf.is_large or tf.length > FORMULA_TERMS or tf.is_zero:
            return None
        exponentials = {k.generator: k for k in tf.kernels.kernels if k.function == "exp"}
        ring = tf.ratio.ring
        others = {*tf.kernels.generators, *(w for d in tf.kernels.dispersions for w in d.wavenumbers)}
        rest = Factored.number(ring, tf.ratio.unit)
        delays: list[Expression] = []
        for factor, exponent in tf.ratio.factors:
            one = Factored.polynomial(ring, factor)
            kernel = next((k for g, k in exponentials.items() if factor == ring.generator(g)), None)
            if kernel is None:
                if any(one.depends_on(name) for name in others if name in ring.index):
                    return None
                rest = rest * one**exponent
                continue
            delay = kernel.dispersion.shift * kernel.length * exponent
            delay = delay / Factored.generator(delay.ring, LAPLACE)
            if exponent < 0 or delay.depends_on(LAPLACE):
                return None
            delays.append(plain_printer(tf).quotient(delay))
        num, den = (_descending(tf, side.expand()) for side in (rest.numerator(), rest.denominator()))
        if max(len(num), len(den)) > MOST_COEFFICIENTS:
            return None
        return RationalSystem(tf, num, den, sum_of(delays) if delays else number(0))


def _descending(tf: TransferFunction, polynomial: fmpz_mpoly) -> tuple[Expression, ...]:
    """Return the coefficients of all powers of s, the highest first."""
    ring = tf.ratio.ring
    arranger = Arranger.plain(ring, constant_symbols(tf))
    found = reversed(ring.coefficients(polynomial))
    return tuple(number(0) if part.is_zero() else arranger.coefficient(part) for part in found)
