"""The boundary of stability over two parameters, as a curve in the frequency at which poles meet the axis.

Input: a model and two parameters in which its characteristic function is linear, or a gain and a delay.
Output: :class:`Conditions`, the relations of the curve and those of the values for which a pole is at s = 0.

Example: ``s + K exp(-s T)`` has poles at ``s = j omega`` where ``K = omega`` and ``omega T = pi/2 + 2 n pi``.

On the axis ``A + K B + T C = 0`` are two linear equations, its real and its imaginary part (D-decomposition;
Neimark 1949). With a delay the magnitude of ``exp(-s T) = -A/(K B)``, which is one, gives K, and its angle
gives T. The curve is put into the characteristic function, in balls at random values, before it is printed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import prod
from random import Random

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Kernel, Ring, irreducible_factors
from symflex.algebra.ring import coefficients_of
from symflex.balls import at_centre, ball, precision
from symflex.errors import REPORT, Diagnostic, InternalError, ModelError, UsageError
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    negative,
    number,
    product_of,
    quotient,
    sum_of,
)
from symflex.loops.loop import pick_gain
from symflex.loops.over import seen_pair
from symflex.model import ExactValue, Model
from symflex.model.analysis import lines_in_order
from symflex.model.loss_factors import check_causal
from symflex.print.forms import Arranger
from symflex.print.forms.arrange import length_sides
from symflex.print.forms.frequency import FrequencyPage
from symflex.print.forms.invariants import IMAGINARY
from symflex.print.forms.naming import Naming
from symflex.print.forms.notation import Line, constant_symbols, plain_printer, reachable, wave_times_length
from symflex.print.forms.shapes import SumSigns
from symflex.roots.passivity import observed
from symflex.symbolic.routh import (
    BITS,
    LONGEST,
    POINTS,
    Conditions,
    Signs,
    SymbolicRelation,
    read,
    relation_of,
)
from symflex.transfer import BoundTransferFunction, TransferFunction
from symflex.transfer.of_model import derive_all

TINY = 2.0**-64  # radius of a value of the characteristic function on its boundary, where it vanishes


def _lines_at_rest(
    tf: TransferFunction, moving: fmpz_mpoly, over: Sequence[str]
) -> Iterator[SymbolicRelation]:
    """Yield where a pole is at 0: delays are 1 there."""
    ring = tf.ratio.ring
    at_rest = {k.generator: ring.constant(1) for k in tf.kernels.kernels} | {LAPLACE: ring.constant(0)}
    arranger, turns = Arranger.plain(ring, constant_symbols(tf)), SumSigns.of(tf.model)
    for factor, _ in irreducible_factors(ring.replaced(moving, at_rest))[1]:
        if ring.used_in((factor,)) & {*over}:
            yield relation_of(arranger, factor, "=", turns)


def boundary(model: Model, over: Sequence[str]) -> Conditions:
    """Return the boundary of stability over two parameters in symbols; SF801 if there is no formula."""
    check_causal(model, "a symbolic boundary")
    parameters = [pick_gain(model.parameters, name) for name in dict.fromkeys(over)]
    if len(parameters) != 2 or len(over) != 2:  # noqa: PLR2004
        raise UsageError(Diagnostic("SF902", "a symbolic boundary has two parameters: --over K --over T"))
    pair = seen_pair(model)
    tf = derive_all(observed(model, pair[0]), [pair])[0].whole
    ring = tf.ratio.ring
    denominator = prod((Factored.polynomial(ring, h.polynomial) for h in tf.hidden), start=tf.den)
    shaped = [n for n in over for v in tf.kernels.values if v.depends_on(n)]
    gain, other = sorted(over, key=shaped.count)  # a delay comes last
    rates = {k.generator: rate for k in tf.kernels.kernels if (rate := _rate(ring, k, other))}
    delays = list(rates)
    moving = [f for f, e in denominator.factors if e > 0 and ring.used_in((f,)) & {gain, other, *delays}]
    laws = [x for d in tf.kernels.dispersions for c in d.characteristic for x in c.factors]
    is_lossless = not any(m[0] % 2 for f, e in laws if len(f) > 1 or e % 2 for m in f.monoms())
    solved = None
    if len(moving) == 1 and tf.has_formula and is_lossless and shaped == [other] * len(delays):
        solved = _solved(tf, denominator, moving[0], (gain, other), delays)
    if solved is None:
        message = f"the characteristic function cannot be solved for {gain} and {other} in symbols"
        hint = "it has to be linear in both, or contain one exp(-s*T) times one gain; waves must be undamped"
        raise ModelError(Diagnostic("SF801", message, parameters[0].span, hint))
    page, values = solved
    if delays:
        *values[1:], quarters, times = _arc(tf, page, gain, *values[1:])
    sides, lines, symbols = page.printed(*values)
    right, omega, turns = [quotient(*each) for each in sides], symbols[LAPLACE], ""
    left = [Call(name, omega) for name in (gain, other)]
    shown, angle = [*right], None
    if delays:
        # The root of a square may have either sign.
        is_square = all(c > 0 for f, _ in values[0].factors for c in f.coeffs())
        right[0] = page.printer(symbols).square_root(values[0]) if is_square else Call("sqrt", right[0])
        n, late = Naming.of(tf).take("n")[0], partial(_late, tf, omega, *rates[delays[0]])
        shown = [right[0], late(_angle(quarters, times, right[1], Name(n)))]
        turns, angle = f", {n} = 0, 1, 2, ...", (quarters, times, late)
    _check(tf, moving[0], (gain, other), right, lines, angle)
    where = [line for line in reachable(right, lines) if Name(line[0]) not in (omega, symbols[IMAGINARY])]
    counts = [sum(len(f) for f, _ in value.factors) for value in values]
    both = zip(counts, zip(left, shown, strict=True), strict=True)
    curve = [SymbolicRelation(n, "=", sides if n <= LONGEST else None) for n, sides in both]
    curve += [SymbolicRelation(1, "=", (Name(name), e)) for name, e in where]
    if not any(d.wavenumbers for d in tf.kernels.dispersions):
        curve += _lines_at_rest(tf, moving[0], over)
    said = f"boundary over {gain} and {other}: a pole on the imaginary axis{turns}"
    return Conditions(model, "boundary", said, tuple(curve))


def _solved(
    tf: TransferFunction,
    denominator: Factored,
    factor: fmpz_mpoly,
    over: Sequence[str],
    delays: Sequence[str],
) -> tuple[FrequencyPage, list[Factored]] | None:
    """Return both parameters; or the square of a gain, and cosine and sine of the angle of a delay."""
    ring, (gain, other) = tf.ratio.ring, over
    if delays:
        split = coefficients_of(ring, factor, [ring.index[n] for n in (*delays, gain, other)])
        if len(delays) > 1 or set(split) not in ({(0, 0, 0), (1, 1, 0)}, {(0, 1, 0), (1, 0, 0)}):
            return None
        still, turned = (Factored.polynomial(ring, split[key]) for key in sorted(split))
        denominator = still / turned
    page = FrequencyPage(replace(tf, reduced=denominator, closed=None, parts=None, definitions=()))
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


def _rate(ring: Ring, kernel: Kernel, delay: str) -> tuple[Factored, Factored] | None:
    """Return c and t of ``exp(-s*(c*T + t))``, c not 0."""
    late = kernel.dispersion.shift * kernel.length / Factored.generator(ring, LAPLACE)
    below, parts = late.denominator(), coefficients_of(ring, late.numerator().expand(), [ring.index[delay]])
    if kernel.function != "exp" or max(parts) != (1,) or below.depends_on(delay) or late.depends_on(LAPLACE):
        return None
    c, t = (Factored.polynomial(ring, parts.get((n,), ring.constant(0))) / below for n in (1, 0))
    return c, t


def _arc(
    tf: TransferFunction, page: FrequencyPage, gain: str, cosine: Factored, sine: Factored
) -> tuple[Factored, int, int]:
    """Return x, q and m of an angle ``q*pi/2 + m*atan(x)``, or with m = 0 of ``(1 - x)*pi/2``."""
    of_function, more = Signs.of(tf), {LAPLACE, gain}
    signs = Signs(page.ring, of_function.positive | more, of_function.nonnegative | more)
    c, s = (
        prod((signs.of_polynomial(f) ** (2 - e % 2) for f, e in x.factors), start=(x.unit > 0) - (x.unit < 0))
        for x in (cosine, sine)
    )
    if c:
        return sine / cosine, 1 - c, 1
    if sine.is_zero:
        return cosine, 1, 0
    return (-cosine / sine, s, 1) if s else (sine / (Factored.number(page.ring, 1) + cosine), 0, 2)


def _angle(quarters: int, times: int, tangent: Expression, n: Expression) -> Expression:
    """Return an angle and n turns."""
    half = quotient(number(quarters), number(2)) if quarters % 2 else number(quarters // 2)
    turns = product_of([sum_of([product_of([number(2), n]), half]), Name("pi")])
    if not times:
        return sum_of([turns, negative(quotient(product_of([tangent, Name("pi")]), number(2)))])
    arc = Call("atan", tangent.operand if isinstance(tangent, Negative) else tangent)
    arcs = product_of([number(0 if tangent == number(0) else times), arc])
    return sum_of([turns, negative(arcs) if isinstance(tangent, Negative) else arcs])


def _late(tf: TransferFunction, omega: Expression, c: Factored, t: Factored, angle: Expression) -> Expression:
    """Return the delay T of ``exp(-s*(c*T + t))`` that turns by an angle."""
    above, below = length_sides(printer := plain_printer(tf), c)
    late = product_of([below, sum_of([angle, negative(wave_times_length(printer, omega, t))])])
    return quotient(late, product_of([omega, above]))


def _check(
    tf: TransferFunction,
    f: fmpz_mpoly,
    over: Sequence[str],
    right: Sequence[Expression],
    lines: Sequence[Line],
    angle: tuple[int, int, Callable[[Expression], Expression]] | None,
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
            time = read(right[1], known.__getitem__).real
            if angle is not None:
                quarters, times, delay = angle
                start, end = (read(delay(number(n)), known.__getitem__).real for n in (0, 1))
                arc = times * time.atan() if times else -time * arb.pi() / 2
                time = start + (end - start) * ((4 + quarters) * arb.pi() / 2 + arc)
            fixed = ((over[0], partial(arb, gain.real)), (over[1], partial(arb, time)))
            kernels = BoundTransferFunction(
                tf, numbers, tf.ratio, (), tf.kernels, fixed=fixed
            ).kernel_values()
            value = at_centre(kernels.polynomial(f, kernels.at(known[LAPLACE])))
        if not value.contains(0) or not value.rad() < TINY:
            message = f"the boundary is not shown, as it is wrong for {dict(numbers)}"
            raise InternalError(Diagnostic("SF992", message, None, REPORT))
