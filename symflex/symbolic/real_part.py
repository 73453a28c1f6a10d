"""For which values of its letters the real part of a lumped function is positive at all frequencies.

Input: a driving-point function Y = N/D in s and letters. Output: :class:`~symflex.symbolic.routh.Conditions`.

On the axis the real part has the sign of ``N(s) D(-s) + N(-s) D(s)``, a polynomial in ``x = omega^2``.
Factors that are squares, pairs f(s) f(-s), or have positive coefficients are positive. What is left is
positive for all x > 0 where its coefficients are: exactly so if only the first or the last may be negative,
and at least so else.

    a mass under a lagged force -K/(tau s + 1) x with friction b    b > K tau
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.algebra import by_powers, degree_in, irreducible_factors
from symflex.errors import Diagnostic, ModelError
from symflex.print.forms import Arranger
from symflex.print.forms.notation import constant_symbols
from symflex.print.forms.shapes import SumSigns
from symflex.symbolic.routh import Conditions, Signs, relation_of

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.transfer import TransferFunction

NEVER = "the real part is never positive at all frequencies"
EXACTLY = "the real part is positive at all frequencies exactly when"
AT_LEAST = "the real part is positive at all frequencies if"
ALWAYS = "the real part is positive at all frequencies"
ZERO = "the real part is zero at all frequencies"


def real_part_conditions(tf: TransferFunction) -> Conditions:
    """Return when the real part of a lumped function is positive at all frequencies but 0.

    Raises ModelError: SF801 with beams, rods or delays.
    """
    if tf.kernels:
        message = "symbolic conditions are for models without beams, rods and delays"
        raise ModelError(Diagnostic("SF801", message, None, "leave out --symbolic"))
    ring, of = tf.ratio.ring, f"real part of {tf.name}"
    context = ring.context
    mirrored = [-context.gen(0), *context.gens()[1:]]
    n, d = (part.expand() for part in (tf.num, tf.den))
    n_mirrored, d_mirrored = (f.compose(*mirrored, ctx=context) for f in (n, d))
    even = n * d_mirrored + n_mirrored * d
    if even.is_zero():
        return Conditions(tf.model, of, ZERO, ())
    signs = Signs.of(tf)
    sign, rest = _factors(signs, even)
    if not rest:
        return Conditions(tf.model, of, ALWAYS if sign > 0 else NEVER, (), is_never=sign < 0)
    if len(rest) > 1:
        whole = rest[0]
        for factor in rest[1:]:
            whole = whole * factor
        rest = [whole]
    coefficients = [c * sign for c in _in_squares(signs, rest[0])]
    needed = [c for c in coefficients if signs.of_polynomial(c) != 1]
    if any(signs.of_polynomial(c) < 0 for c in (coefficients[0], coefficients[-1])):
        return Conditions(tf.model, of, NEVER, (), is_never=True)
    arranger, turns = Arranger.plain(ring, constant_symbols(tf)), SumSigns.of(tf.model)
    relations = tuple(relation_of(arranger, c, kind, turns) for c, kind in signs.reduced(needed))
    are_ends = all(c in (coefficients[0], coefficients[-1]) for c in needed)
    return Conditions(tf.model, of, EXACTLY if are_ends else AT_LEAST, relations)


def _factors(signs: Signs, even: fmpz_mpoly) -> tuple[int, list[fmpz_mpoly]]:
    """Return the sign of what is known of a polynomial on the axis, and the factors of which it is not."""
    unit, factors = irreducible_factors(even)
    sign, rest, halves = 1 if unit > 0 else -1, list["fmpz_mpoly"](), 0
    for factor, times in factors:
        if factor == signs.ring.context.gen(0):
            halves += times  # s^2 is -omega^2
        if not times % 2:
            continue
        if any(monomial[0] % 2 for monomial in factor.monoms()):
            # It comes with its mirror image, both with a positive first coefficient.
            halves += degree_in(factor, 0)
            continue
        known = {signs.of_polynomial(c) for c in _in_squares(signs, factor)}
        if len(known) == 1 and 0 not in known:
            sign *= known.pop()
        else:
            rest.append(factor)
    return sign * (-1) ** (halves // 2), rest


def _in_squares(signs: Signs, factor: fmpz_mpoly) -> list[fmpz_mpoly]:
    """Return the coefficients of omega^0, omega^2, ... of an even polynomial in s."""
    return [c * (-1) ** (int(p) // 2) for p, c in sorted(by_powers(signs.ring, factor).items())]
