"""The characteristic function of a sampled loop, in ``b = 1/z`` and the parameters of its controllers.

Input: a model with ``[sampled]``, and names of parameters that stay symbols. Output: a :class:`SampledLoop`.

    m x'' + b x' = F - f, f = K x at samples
    characteristic function    1 - C(z) P(z) = (1 - b)(1 - r b) - K (n_1 b + n_2 b^2), r = exp(-b T/m)

With ``b = exp(-s T)`` this is a function of delays: everything that is proved along the imaginary axis for
delayed loops is proved around the unit circle for this one. Its coefficients are enclosed to any
precision. With ``b = (1 - w)/(1 + w)`` it is a polynomial in w, whose roots in the right half-plane are
those outside the unit circle.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, partial

from flint import acb, acb_series, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, NO_KERNELS, Factored, Ring, degree_in
from symflex.analysis.sampled_loop.distributed import distributed_pulse
from symflex.analysis.sampled_loop.plant import PlantPulse
from symflex.analysis.sampled_loop.pulse import pulse_function
from symflex.analysis.sampled_loop.symbolic import BACK, Ends, Fixed, Timing, pulse_of, pulse_over
from symflex.analysis.time_response.delayed_terms import delayed_quotient
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import (
    Expression,
    Name,
    Negative,
    Product,
    Quotient,
    Sum,
    names_among,
    number,
    substitute,
)
from symflex.library.blocks import BLOCKS
from symflex.loops.apart import NONE, PolesApart, poles_apart
from symflex.loops.boxes import AXIS, BITS, Box, CharacteristicFunction, OpenBox, Path, Piece
from symflex.loops.loop import GainPolynomial
from symflex.loops.over import with_values
from symflex.model import ExactValue, Input, Model, ModelParameter, Output, PlacedBlock, with_numbers
from symflex.model.model import Z
from symflex.model.sampled import OpenedLoop, SampledChannel, opened
from symflex.model.units import exact_expression
from symflex.roots import PoleZeroMap, find_polynomial_roots
from symflex.roots.locate import locate
from symflex.roots.passivity import observed
from symflex.roots.pole_zero_map import EXAMINED, StabilityVerdict
from symflex.roots.problem import problem_of
from symflex.roots.root import Root
from symflex.state_space.sampled import Sampling
from symflex.transfer import BoundTransferFunction, TransferFunction, bind
from symflex.transfer.enclose import enclose, rational_value
from symflex.transfer.enclose_kernels import KernelValues
from symflex.transfer.of_model import derive_all

COUNT_DIGITS = 15
COUNT_DIGITS_OF_BEAMS = 6  # of roots whose coefficients are known to some twelve digits
TOO_CLOSE = "a pole lies too close to the unit circle to decide"
NO_PERIOD = "next to a period of 0 there is no end of frequencies"
EACH = "ask at each value: --set NAME=VALUE"
CLOSED, DRIVEN = "sampled loop", "reference"  # the function whose poles are those of the loop


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """A loop closed by sampled controllers, some of whose parameters are symbols."""

    model: Model  # as it was declared
    opened: OpenedLoop
    period: Fraction  # [s]
    delay: Fraction  # from a sample to the output that follows from it [s]
    tf: TransferFunction  # whose denominator is the characteristic function
    hidden: tuple[BoundTransferFunction, ...] = ()  # of the continuous part, with modes no controller sees
    plant: PlantPulse | None = None  # of a continuous part some of whose parameters are symbols
    least: arb | None = None  # abs(z) from which on poles are known, of a continuous part with beams

    def characteristic(self, names: Sequence[str]) -> SampledCharacteristic:
        """Return the function whose roots are followed around the unit circle."""
        values = tuple((p.name, p.value) for p in self.tf.model.parameters if p.value and p.name not in names)
        known = {p.name: p.value for p in self.model.parameters if p.value and p.name not in names}
        period = substitute(self.opened.period, {n: exact_expression(x) for n, x in known.items()})
        return SampledCharacteristic(self.tf, tuple(names), values, is_modal=False, period=period, loop=self)

    @cached_property
    def apart(self) -> StabilityVerdict:
        """What modes of the continuous part say of the loop that no controller sees or moves."""
        verdict = NONE
        for each in self._hidden_modes:
            verdict = verdict.beside(each.verdict)
        return verdict

    @property
    def unseen(self) -> tuple[Root, ...]:
        """The poles of these modes in s."""
        return tuple(root for each in self._hidden_modes for root in each.hidden)

    @cached_property
    def _hidden_modes(self) -> tuple[PolesApart, ...]:
        found = []
        for bound in self.hidden:
            ring = bound.ratio.ring
            unseen = [
                GainPolynomial((Factored.polynomial(ring, h.polynomial),), h.multiplicity, is_hidden=True)
                for h in bound.hidden
            ]
            found.append(poles_apart(bound, unseen))
        return tuple(found)


def _between(ends: Ends) -> arb:
    return ball(ends[0]).union(ball(ends[1]))


def described(loop: SampledLoop) -> str:
    """Return in words what takes samples, and how often."""
    sampled = loop.model.sampled
    names = ", ".join(sampled.blocks if sampled is not None else ())
    late = f", late by {float(loop.delay):g} s" if loop.delay else ""
    by = f", by {sampled.by}" if sampled is not None and sampled.by else ""
    return f"{names}: sampled every {float(loop.period):g} s{by}, the output held{late}"


@dataclass(frozen=True, eq=False)
class SampledCharacteristic(CharacteristicFunction):
    """A characteristic function in ``exp(-s T)``: half of the unit circle is the axis up to ``pi/T``."""

    period: Expression = field(kw_only=True)  # [s]
    loop: SampledLoop = field(kw_only=True)

    def moved_by(self, tf: TransferFunction, name: str) -> set[int]:
        """Return the places in the ring of what depends on a parameter, also by the continuous part."""
        plant, index = self.loop.plant, tf.ratio.ring.index
        is_there = plant is not None and name in plant.machine.names
        names = plant.names if plant is not None and is_there else ()
        return super().moved_by(tf, name) | {index[n] for n in names if n in index}

    def bound_in(self, tf: TransferFunction, box: Box) -> BoundTransferFunction:
        """Return the function for parameters in a box, with the coefficients of the continuous part there."""
        bound = super().bound_in(tf, box)
        if self.loop.plant is None:
            return bound
        return replace(bound, fixed=(*bound.fixed, *self.loop.plant.fixed(self._of_plant(box))))

    def kernels(self, tf: TransferFunction, box: Box, along: str = "") -> KernelValues:
        """Return the evaluator for a box, to first order in one parameter of either part."""
        kernels = super().kernels(tf, box, along)
        plant = self.loop.plant
        if plant is None or along not in plant.machine.names:
            return kernels
        pairs = plant.named(self._of_plant(box), along)
        series = {n: acb_series([acb(x), acb(y)], 2) for n, (x, y) in pairs.items()}
        return replace(kernels, constants={**kernels.constants, **series})

    def _of_plant(self, box: Box) -> Box:
        """Return the ends of the parameters that the continuous part has."""
        names = () if self.loop.plant is None else self.loop.plant.machine.names
        return tuple(box[self.names.index(name)] for name in names)

    def _end(self, box: Box) -> float | str:
        """Return half of the sampling frequency, the largest in a box [rad/s], and a little more."""
        half = self._half(box)
        if not half.is_finite():
            return NO_PERIOD
        return float(half.upper()) * (1 + 2.0**-50)  # a pole that passes z = -1 does so there

    def narrowed(self, box: OpenBox, bits: int = BITS, path: Path = AXIS) -> OpenBox:
        """Return the box with the open pieces of the axis up to half of the sampling frequency."""
        end = self._end(box.box)
        if isinstance(end, str):
            return super().narrowed(box, bits, path)
        pieces = tuple(tuple(piece for piece in each if piece[0] <= end) for each in box.pieces)
        return super().narrowed(replace(box, pieces=pieces), bits, path)

    def _half(self, box: Box) -> arb:
        """Return half of the sampling frequency [rad/s], for all values in a box."""
        fixed = {n: partial(_between, ends) for n, ends in zip(self.names, box, strict=True)}
        with precision(BITS):
            return arb.pi() / enclose(self.period, fixed)

    def is_mirrored_at(self, box: Box, piece: Piece) -> bool:
        """Tell whether a piece of the axis may hold z = 1 or z = -1."""
        return not (piece[0] and ball(piece[1]) < self._half(box))

    def located(self, point: Sequence[Fraction | ExactValue], modes: int = 1) -> PoleZeroMap:
        """Return the poles in the w plane at one point; beside beams, what they say of stability alone."""
        if self.loop.least is not None:
            roots = roots_in_b(self.tf, dict(zip(self.names, point, strict=True)), COUNT_DIGITS_OF_BEAMS)
            return replace(EXAMINED, verdict=inside(roots))
        if self.loop.plant is not None:
            at = dict(zip(self.names, point, strict=True))
            return located_in_w(sampled_loop(with_values(self.loop.model, at)).tf, {})
        return located_in_w(self.tf, dict(zip(self.names, point, strict=True)))


def located_in_w(
    tf: TransferFunction, values: Mapping[str, ExactValue | Fraction], digits: int = COUNT_DIGITS
) -> PoleZeroMap:
    """Return the poles of a function of ``b = (1 - w)/(1 + w)``, to so many digits."""
    return locate(in_w(bind(tf, values)), None, digits, with_zeros=False)


def in_w(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return one over the characteristic function as a rational function of w, which its s stands for."""
    return _rational(bound, lambda w: (1 - w, 1 + w))


def roots_in_b(tf: TransferFunction, values: Mapping[str, ExactValue | Fraction], digits: int) -> list[Root]:
    """Return the roots of the characteristic function in ``b = 1/z``, enclosed; errors as of polynomials."""
    bound = _rational(bind(tf, values), lambda b: (b, 1))
    factors = [(f, -e) for f, e in bound.ratio.factors if e < 0]
    return [*find_polynomial_roots(problem_of(bound, factors), digits)]


def inside(roots: Sequence[Root], unseen: StabilityVerdict = NONE) -> StabilityVerdict:
    """Return what roots in b say of stability: those in the unit disc are poles outside of it in z."""
    sides = [(1 if abs(r.enclosure()) > 1 else -1 if abs(r.enclosure()) < 1 else 0, r) for r in roots]
    right = sum(root.multiplicity for side, root in sides if side < 0)
    if any(not side for side, _ in sides):
        found = StabilityVerdict("unknown", None, False, TOO_CLOSE, right)
    else:
        found = StabilityVerdict("unstable" if right else "stable", right, True, "", right)
    return found.beside(unseen)


def _rational(
    bound: BoundTransferFunction, sides: Callable[[fmpz_mpoly], tuple[fmpz_mpoly, fmpz_mpoly | int]]
) -> BoundTransferFunction:
    """Return one over the characteristic function in a variable of which b is a quotient, by its sides."""
    ring = bound.ratio.ring
    (back,) = (ring.index[k.generator] for k in bound.kernels.kernels)
    small = Ring(tuple(n for i, n in enumerate(ring.names) if i != back))
    above, below = sides(small.context.gen(0))
    # What a controller does not see is in what it closes the loop around.
    unseen = [(h.polynomial, h.multiplicity) for h in bound.hidden if h.polynomial.degrees()[back]]
    den = Factored.number(small, 1)
    for factor, exponent in (*bound.den.factors, *unseen):
        if exponent > 0 and factor != ring.context.gen(back):  # b = 0 is z at infinity
            # Of degree n in b it is below^n f(above/below).
            parts = ring.coefficients(factor, back)
            turned = small.constant(0)
            for n, part in enumerate(parts):
                turned += small.taken_over(part, ring.names) * above**n * below ** (len(parts) - 1 - n)
            den = den * Factored.polynomial(small, turned) ** exponent
    return replace(bound, ratio=1 / den, hidden=(), kernels=NO_KERNELS, parts=None, is_of_model=False)


def sampled_loop(model: Model, ranges: Mapping[str, Ends] | None = None) -> SampledLoop:
    """Return the loop of a model with ``[sampled]``, parameters with a range left symbols.

    ModelError: SF229 where a parameter has no value; SF235, SF236, SF260, SF801 where the loop is none.
    """
    loop, symbolic = opened(model), dict(ranges or {})
    numbers = {p.name: p.value for p in model.parameters if p.value is not None}
    period, delay = _time(model, loop.period, numbers), _time(model, loop.delay, numbers)
    if not period:
        raise _no_time("the period of [sampled] is 0", loop.period)
    for name in symbolic:
        _check_symbol(model, loop, name)
    if len(loop.channels) > 1:
        message = "a loop with several sampled blocks, or one at several places, is not available yet"
        raise ModelError(Diagnostic("SF260", message, loop.period.span))
    (channel,) = loop.channels
    _check_causal(model, channel, delay / period, symbolic)
    of_plant = [name for name in symbolic if any(names_among(e, {name}) for _, e in loop.model.expressions())]
    of_times = [name for name in symbolic if any(names_among(e, {name}) for e in (loop.period, loop.delay))]
    machine = observed(with_numbers(loop.model, of_plant), channel.seen)
    (tf,) = derive_all(machine, [(channel.seen, channel.held)])
    if tf.ratio.is_zero:
        message = "what the sampled block sees does not move with what it holds, so that it closes no loop"
        raise ModelError(Diagnostic("SF260", message, loop.period.span, "leave out [sampled]"))
    bound = bind(tf.whole, {name: sum(symbolic[name]) / 2 for name in of_plant})
    delays = None if bound.is_rational else delayed_quotient(bound)
    if not bound.is_rational and (delays is None or len(delays.below) > 1):
        _check_followed(model, tf.whole, [*of_plant, *of_times])
        known = distributed_pulse(bound, Sampling(period), delay)
        if isinstance(known, str):
            message = f"a sampled loop about beams, or about a delay in a continuous loop: {known}"
            hint = "give the machine a few modes in place of beams, as 'symflex rational' prints them"
            raise ModelError(Diagnostic("SF235", message, model.outputs[0].span, hint))
        closed = _closed(model, channel, loop.period, pulse_of(known[0]), symbolic)
        return SampledLoop(model, loop, period, delay, closed, (bound,), least=known[1])
    timing = Timing(loop.period, loop.delay, numbers, symbolic)
    if of_plant or (of_times and bound.is_rational):
        _check_followed(model, tf.whole, of_plant)
        function = CharacteristicFunction.of(machine, tf.whole, list(dict.fromkeys((*of_plant, *of_times))))
        is_whole = not delay or (not of_times and not delay % period)
        plant = PlantPulse(function, loop.period, loop.delay, timing.samples(Fraction(0)), is_whole, numbers)
        closed = _closed(model, channel, loop.period, (plant.expression, ()), symbolic, plant.names)
        return SampledLoop(model, loop, period, delay, closed, (bound,), plant)
    if of_times:
        pulse = pulse_over(bound, timing)
    else:
        pulse = pulse_of(pulse_function(bound, Sampling(period), delay))
    tf = _closed(model, channel, loop.period, pulse, symbolic)
    return SampledLoop(model, loop, period, delay, tf, (bound,))


def _time(model: Model, expression: Expression, numbers: Mapping[str, ExactValue]) -> Fraction:
    """Return a time [s] of ``[sampled]``."""
    for parameter in model.settable:
        if parameter.name not in numbers and names_among(expression, {parameter.name}):
            message = f"parameter '{parameter.name}' has no value"
            raise ModelError(
                Diagnostic("SF229", message, parameter.span, "give it a value, here or with --set")
            )
    value = rational_value(expression, numbers)
    if value is None or value < 0:
        raise _no_time("a time of [sampled] is no positive rational number", expression)
    return value


def _check_causal(model: Model, channel: SampledChannel, late: Fraction, symbolic: Collection[str]) -> None:
    """Refuse a controller that is zero, or needs samples later than those that ``late`` periods bring."""
    controller = substitute(channel.controller, {Z: Name(LAPLACE)})  # whose s is z
    alone = Model(
        parameters=tuple(p for p in model.parameters if p.name != Z),
        inputs=(Input(DRIVEN, "signal"),),
        outputs=(Output(CLOSED, Product((controller, Name(DRIVEN)))),),
    )
    (tf,) = derive_all(with_numbers(alone, symbolic), [(CLOSED, DRIVEN)])
    sampled = model.sampled
    spans = [b.span for b in model.blocks if sampled is not None and b.name in sampled.blocks]
    span = spans[0] if spans else channel.controller.span
    if tf.ratio.is_zero:
        raise ModelError(Diagnostic("SF260", "the sampled block is zero, and closes no loop", span))
    ahead = sum(
        exponent * degree_in(factor, tf.ratio.ring.index[LAPLACE]) for factor, exponent in tf.ratio.factors
    )
    if ahead > late:
        message = f"the sampled block needs a sample from the future: it grows as z^{ahead}"
        hint = (
            "divide it by z, or by = 'tustin' or 'backward' for a block in s; or say the 'delay' that it has"
        )
        raise ModelError(Diagnostic("SF260", message, span, hint))


def _no_time(message: str, expression: Expression) -> ModelError:
    return ModelError(Diagnostic("SF260", message, expression.span, 'write it as a time: "1 ms"'))


def _check_symbol(model: Model, loop: OpenedLoop, name: str) -> None:
    """Refuse a parameter on which no pole depends."""
    parameter = next(p for p in model.parameters if p.name == name)
    times, controllers = (loop.period, loop.delay), [c.controller for c in loop.channels]
    is_of_plant = any(names_among(e, {name}) for _, e in loop.model.expressions())
    if not is_of_plant and not any(names_among(e, {name}) for e in (*times, *controllers)):
        raise ModelError(Diagnostic("SF801", f"no pole of the model depends on '{name}'", parameter.span))


def _check_followed(model: Model, tf: TransferFunction, names: Sequence[str]) -> None:
    """Refuse parameters beside beams and delays, and those that move modes a continuous part hides; SF801."""
    for name in names:
        span = next(p.span for p in model.parameters if p.name == name)
        if tf.kernels:
            message = (
                f"'{name}' is a parameter of a continuous part with beams or delays, or a time beside one"
            )
            raise ModelError(Diagnostic("SF801", message, span, EACH))
        place = tf.ratio.ring.index.get(name)
        if place is not None and any(h.polynomial.degrees()[place] for h in tf.hidden):
            message = f"'{name}' moves modes that the sampled block does not see or move"
            raise ModelError(Diagnostic("SF801", message, span, EACH))


def _closed(
    model: Model,
    channel: SampledChannel,
    period: Expression,
    pulse: tuple[Expression, Fixed],
    symbolic: Collection[str],
    names: Collection[str] = (),
) -> TransferFunction:
    """Return one over ``1 - C P`` as a function of ``exp(-s T)``; ``names`` are of numbers known later."""
    seen, fixed = pulse
    controller = substitute(channel.controller, {Z: Quotient(number(1), Name(BACK))})
    loop_gain = Product((controller, seen))
    shown = Quotient(Name(DRIVEN), Sum((number(1), Negative(loop_gain))))
    kept = tuple(p for p in model.parameters if p.name in symbolic or p.value is not None)
    constants = tuple(ModelParameter(name, None, "", "real") for name in (*dict(fixed), *names))
    closed = Model(
        parameters=(*kept, *constants),
        blocks=(PlacedBlock(BACK, BLOCKS["delay"], (("T", period),)),),
        inputs=(Input(DRIVEN, "signal"),),
        outputs=(Output(CLOSED, shown),),
    )
    (tf,) = derive_all(with_numbers(closed, symbolic, in_kernels=True), [(CLOSED, DRIVEN)])
    return replace(tf.whole, solve=None, fixed=fixed)
