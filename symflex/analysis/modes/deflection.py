"""From an input and a frequency to how the model moves then: its operating deflection shape.

Input: a bound transfer function, whose input is cos(omega t), and a frequency. Output: :class:`Deflection`,
from ``A(s) x = -b`` at s = j omega, in balls. Example: at 1 rad/s 1 N moves 2 kg on a spring of 8 N/m by
1/(8 - 2*1^2) = 1/6 m. Theorem: where A(j omega) is regular, x exp(j omega t) is the only motion in step.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from flint import acb, arb

from symflex.analysis.modes.bound_equations import BoundEquations, solution
from symflex.analysis.modes.find import DIGITS
from symflex.analysis.modes.shape import Deflection, is_accurate, normalised
from symflex.balls import precision, precisions
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError, refused
from symflex.library.elements import Variable
from symflex.model.loss_factors import check_causal
from symflex.model.model import PI_NEARLY
from symflex.transfer import AnyBoundFunction

SHORT = 10**20  # PI_NEARLY has a denominator of 10^29
FIRST_BITS, MOST_BITS = 128, 2048  # the last is asked for at a resonance without damping alone


def deflection(bound: AnyBoundFunction, hertz: Fraction) -> Deflection:
    """Return the steady motion under the input of a function, over the size of its largest displacement.

    Raises SF402 when the input moves nothing, SF406 (UncertifiedError) at a resonance without damping, and
    at 0 Hz where the model is free to move; SF251 at 0 Hz with loss factors, SF902 below 0 Hz.
    """
    equations, ends = BoundEquations(bound, "a deflection"), bound.source
    if hertz < 0:
        raise refused("the frequency of a deflection is not negative")
    if not hertz:
        check_causal(ends.model, "a response at omega <= 0")
    entries = equations.at.entries(ends.output.name, ends.input.name)[:-1]
    best, size, omega = None, len(entries), 2 * PI_NEARLY * hertz
    for bits in precisions(FIRST_BITS, MOST_BITS):
        spend()
        with precision(bits):
            # A short number of rad/s is what was asked for.
            exact, unit = (omega, arb(1)) if omega.denominator < SHORT else (2 * hertz, arb.pi())
            number = equations.at.on(acb(0, unit * exact.numerator / exact.denominator))
            values = [{j: number(x) for j, x in row.items()} for row in entries]
            rows = [[row.get(j, acb(0)) for j in range(size)] for row in values]
            solved = solution(rows, [[-row.get(size, acb(0))] for row in values])
            if solved is None:
                continue
            source = Variable("input", ends.input.name)
            motions, distributed = equations.motion(number, [x for (x,) in solved], source)
            if all(motion.value == 0 for motion in motions[:-1]):
                raise ModelError(Diagnostic("SF402", f"{ends.input.name} moves nothing"))
            shape = normalised(Deflection(motions, distributed, "", hertz, acb(1)), DIGITS)
            if shape is not None:
                amplitude = 1 / shape.motions[-1].value
                best = replace(shape.scaled(amplitude / abs(amplitude)), amplitude=amplitude)
        if shape is not None and is_accurate(shape, DIGITS):
            break
    if best is None:
        why = "at a resonance without damping it is infinite" if hertz else "what is free to move has none"
        message = f"there is no deflection at {float(hertz):g} Hz: {why}"
        hint = "choose another frequency, or add damping"
        raise UncertifiedError(Diagnostic("SF406", message, None, hint))
    return best
