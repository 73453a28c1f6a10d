"""The boundary of stability over two parameters, as a curve in the frequency at which poles meet the axis.

Input: a model and two parameters in which its characteristic function is linear, or a gain and a delay.
Output: :class:`Conditions`, the relations of the curve and those of the values for which a pole is at s = 0.

Example: ``s + K exp(-s T)`` has poles at ``s = j omega`` where ``K = omega`` and ``omega T = pi/2 + 2 n pi``.

On the axis ``A + K B + T C = 0`` are two linear equations, its real and its imaginary part (D-decomposition;
Neimark 1949). With a delay the magnitude of ``exp(-s T) = -A/(K B)``, which is one, gives K. The curve is
put into the characteristic function, in balls at random values, before it is printed.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import prod
from random import Random
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.algebra import LAPLACE, Factored, irreducible_factors
from symflex.algebra.ring import coefficients_of
from symflex.balls import at_centre, ball, precision
from symflex.errors import REPORT, Diagnostic, InternalError, ModelError, UsageError
from symflex.expressions import Call, Name, format_expression, product_of, quotient
from symflex.letters.routh import BITS, LONGEST, POINTS, Conditions, SymbolicRelation, read, relation_of
from symflex.loops.loop import pick_gain
from symflex.loops.over import seen_pair
from symflex.model import ExactValue
from symflex.model.analysis import lines_in_order
from symflex.model.loss_factors import check_causal
from symflex.print.forms import Arranger
from symflex.print.forms.frequency import FrequencyPage
from symflex.print.forms.invariants import IMAGINARY
from symflex.print.forms.notation import Line, constant_symbols, reachable
from symflex.transfer import BoundTransferFunction
from symflex.transfer.of_model import derive_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.expressions import Expression
    from symflex.model import Model
    from symflex.transfer import TransferFunction


TINY = 2.0**-64
"""Radius of a value of the characteristic function on its boundary, where it vanishes."""


def boundary(model: Model, over: Sequence[str]) -> Conditions:
    """Return the boundary of stability over two parameters in letters.

    Raises UsageError: SF902 for unknown names, or other than two; ModelError: SF801 if real and imaginary
    part cannot be solved for them.
    """
    check_causal(model, "a boundary in letters")
    parameters = [pick_gain(model.parameters, name) for name in dict.fromkeys(over)]
    if len(parameters) != 2 or len(over) != 2:  # noqa: PLR2004
        raise UsageError(Diagnostic("SF902", "a boundary in letters has two parameters: --over K --over T"))
    (tf,) = derive_all(model, [seen_pair(model)])
    ring = tf.ratio.ring
    whole = prod((Factored.polynomial(ring, h.polynomial) for h in tf.hidden), start=tf.den)
    shaped = [n for n in over for v in tf.kernels.values if v.depends_on(n)]
    gain, other = sorted(over, key=shaped.count)  # a delay comes last
    turn = Factored.generator(ring, LAPLACE) * Factored.generator(ring, other)  # of exp(-s*T)
    angles = {k.generator: k.dispersion.shift * k.length for k in tf.kernels.kernels if k.function == "exp"}
    delays = [name for name, angle in angles.items() if (angle / turn).is_one]
    moving = [f for f, e in whole.factors if e > 0 and ring.used_in((f,)) & {gain, other, *delays}]
    laws = [x for d in tf.kernels.dispersions for c in d.characteristic for x in c.factors]
    is_lossless = not any(m[0] % 2 for f, e in laws if len(f) > 1 or e % 2 for m in f.monoms())
    solved = None
    if len(moving) == 1 and tf.has_formula and is_lossless and shaped == [other] * len(delays):
        solved = _solved(tf, whole, moving[0], (gain, other), delays)
    if solved is None:
        message = f"the characteristic function cannot be solved for {gain} and {other} in letters"
        hint = "it has to be linear in both, or contain one exp(-s*T) and one gain; waves must be undamped"
        raise ModelError(Diagnostic("SF801", message, parameters[0].span, hint))
    page, values = solved
    sides, lines, symbols = page.printed(*values)
    right, omega, turns = [quotient(*each) for each in sides], symbols[LAPLACE], ""
    left = [Call(name, omega) for name in (gain, other)]
    if delays:
        # The root of a square may have either sign.
        is_square = all(c > 0 for f, _ in values[0].factors for c in f.coeffs())
        right[0] = page.printer(symbols).square_root(values[0]) if is_square else Call("sqrt", right[0])
        left[1:] = (Call(f, product_of([omega, Name(other)])) for f in ("cos", "sin"))
        turns = f" with {other} = (atan2(sin, cos) + 2*n*pi)/{format_expression(omega)}, n = 0, 1, 2, ..."
    _check(tf, moving[0], (gain, other), right, lines)
    where = [line for line in reachable(right, lines) if Name(line[0]) not in (omega, symbols[IMAGINARY])]
    counts = [sum(len(f) for f, _ in value.factors) for value in values]
    both = zip(counts, zip(left, right, strict=True), strict=True)
    curve = [SymbolicRelation(n, "=", sides if n <= LONGEST else None) for n, sides in both]
    curve += [SymbolicRelation(1, "=", (Name(name), e)) for name, e in where]
    if not any(d.wavenumbers for d in tf.kernels.dispersions):
        at_rest = {k.generator: ring.constant(1) for k in tf.kernels.kernels} | {LAPLACE: ring.constant(0)}
        factors = irreducible_factors(ring.replaced(moving[0], at_rest))[1]
        arranger = Arranger.plain(ring, constant_symbols(tf))
        curve += [relation_of(arranger, f, "=") for f, _ in factors if ring.used_in((f,)) & {*over}]
    said = f"boundary over {gain} and {other}: a pole on the imaginary axis{turns}"
    return Conditions(model, "boundary", said, tuple(curve))


def _solved(
    tf: TransferFunction, whole: Factored, factor: fmpz_mpoly, over: Sequence[str], delays: Sequence[str]
) -> tuple[FrequencyPage, list[Factored]] | None:
    """Return both parameters; or the square of a gain, and cosine and sine of frequency times delay."""
    ring, (gain, other) = tf.ratio.ring, over
    if delays:
        split = coefficients_of(ring, factor, [ring.index[n] for n in (*delays, gain, other)])
        if set(split) not in ({(0, 0, 0), (1, 1, 0)}, {(0, 1, 0), (1, 0, 0)}):
            return None
        still, turned = (Factored.polynomial(ring, split[key]) for key in sorted(split))
        whole = still / turned
    page = FrequencyPage(replace(tf, reduced=whole, closed=None, parts=None, definitions=()))
    value, index = page.value(), [page.ring.index[n] for n in (IMAGINARY, gain, other)]

    def parts(of: fmpz_mpoly, *key: int) -> list[fmpz_mpoly]:
        found = coefficients_of(page.ring, of, index)
        return [found.get((i, *key), page.ring.constant(0)) for i in (0, 1)]

    def lowest(above: fmpz_mpoly, below: fmpz_mpoly) -> Factored:
        above, below = page.reduced(above), page.reduced(below)
        top, bottom = (Factored.polynomial(page.ring, f / above.gcd(below)) for f in (above, below))
        return top / bottom

    if delays:
        sides = (page.reduced(side.expand()) for side in (value.numerator(), value.denominator()))
        (n, n_j), (d, d_j) = (parts(side, 0, 0) for side in sides)
        above, below = n * n + n_j * n_j, d * d + d_j * d_j
        if (0, 1, 0) in split:  # the gain is before what is not delayed
            above, below = below, above
        k = page.ring.generator(gain) * below
        return page, [lowest(above, below), lowest(-n * d - n_j * d_j, k), lowest(n_j * d - n * d_j, k)]
    (moving,) = [page.reduced(f) for f, _ in value.factors if page.ring.used_in((f,)) & {*over}]
    if any(m[index[1]] + m[index[2]] > 1 for m in moving.monoms()):
        return None
    (a, a_j), (b, b_j), (c, c_j) = (parts(moving, *key) for key in ((0, 0), (1, 0), (0, 1)))
    below = b * c_j - b_j * c
    if below.is_zero():
        return None
    return page, [lowest(a_j * c - a * c_j, below), lowest(a * b_j - a_j * b, below)]


def _check(
    tf: TransferFunction,
    f: fmpz_mpoly,
    over: Sequence[str],
    right: Sequence[Expression],
    lines: Sequence[Line],
) -> None:
    """Put a curve into the characteristic function at random values. Raises InternalError: SF992."""
    random = Random(tf.name)
    free = [p.name for p in tf.model.parameters if p.name not in over]
    for _ in range(POINTS):
        omega, *drawn = (Fraction(random.randrange(64, 192), 128) for _ in (LAPLACE, *free))
        numbers = tuple((name, ExactValue(x)) for name, x in zip(free, drawn, strict=True))
        with precision(BITS):
            known = {name: acb(ball(x.rational)) for name, x in numbers}
            known |= {"pi": acb.pi(), LAPLACE: acb(0, ball(omega))}
            meanings = dict(lines)
            for name in lines_in_order(right, meanings)[0]:
                known[name] = read(meanings[name], known.__getitem__)
            gain = known[over[0]] = read(right[0], known.__getitem__)
            more, *sine = (read(e, known.__getitem__).real for e in right[1:])
            time = (arb.atan2(sine[0], more) + 2 * arb.pi()) / ball(omega) if sine else more
            fixed = ((over[0], partial(arb, gain.real)), (over[1], partial(arb, time)))
            kernels = BoundTransferFunction(
                tf, numbers, tf.ratio, (), tf.kernels, fixed=fixed
            ).kernel_values()
            value = at_centre(kernels.polynomial(f, kernels.at(known[LAPLACE])))
        if not value.contains(0) or not value.rad() < TINY:
            message = f"the boundary is not shown, as it is wrong for {dict(numbers)}"
            raise InternalError(Diagnostic("SF992", message, None, REPORT))
