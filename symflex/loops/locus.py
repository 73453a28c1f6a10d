"""The root locus: closed-loop poles as the gain grows, proved at both ends and traced between.

Input: a loop that is a straight line in its gain. Output: poles at the first and the last gain and the zeros
they go to, as certified maps, and curves between them by Newton's method from gain to gain.
"""

from __future__ import annotations

from cmath import isfinite, phase, rect
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

from flint import acb, arb

from symflex.algebra import Factored
from symflex.balls import UndecidedError, precision
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError, UsageError
from symflex.loops.apart import poles_apart
from symflex.loops.axis import ORIGIN_BITS
from symflex.loops.loop import NO_LOOP, Loop
from symflex.loops.loop_function import LoopFunction
from symflex.loops.networks import AnyLoop, LoopInDisc, NetworkLoop
from symflex.model import ExactValue
from symflex.roots import Band, Modes, PoleZeroMap, Position, Region, Root
from symflex.roots.functions.simplified import with_parts
from symflex.roots.locate import DEFAULT_MODES, locate
from symflex.roots.pole_zero_map import Exclusion, is_right
from symflex.transfer import BoundTransferFunction
from symflex.transfer.equations_at import EssentialSingularityError

Traceable = LoopFunction | LoopInDisc  # what poles are followed in
Branch = tuple[complex, ...]  # a curve [rad/s] along which a pole goes
STEPS = 120  # gains in all, close at the beginning: a step is then 10 % longer than the last
FIRST_SHARE = 1e-5  # the first step, of the whole range
NEWTON_STEPS = 25
CONVERGED = 1e-12
FAREST = 0.05  # how far a pole may move in a step, relative to its size or that of the largest at first
BEND = 0.2  # how far a curve may turn from step to step [rad]
SHORTEST = 0.004  # steps shorter than this, relative to the same, may turn as they will
HALVINGS = 9
WIDER = (1.4, 1.15, 1.02)  # than all poles marked, a disc in which those of a network are followed
TURNS = (0.3, 1.9, 3.4, 5.0)
PARTING = (2e-2, 6e-4, 2e-5)  # how far away poles that part are sought, relative to the largest at first
TOUCHING = 1e-7
ENDS_AGREE = 1e-6


@dataclass(frozen=True)
class RootLocus:
    """Closed-loop poles over a range of the gain."""

    gain: str  # its name
    limits: tuple[Fraction, Fraction]  # first and last value
    start: PoleZeroMap  # start and end: poles at these, and the zeros the poles go to, proved
    end: PoleZeroMap
    branches: tuple[Branch, ...]  # curves from poles at first; not proved
    arrived: bool  # every curve ends next to a certified pole at the last gain, and no two at the same
    ends: tuple[complex, ...] = ()  # certified poles at last [rad/s] to which any curve goes
    entering: tuple[Branch, ...] = ()  # from nowhere marked, to last poles
    nominal: tuple[Fraction, PoleZeroMap] | None = None  # the gain and its poles, if within

    def __repr__(self) -> str:
        low, high = (float(gain) for gain in self.limits)
        return f"<RootLocus: {low:g} <= {self.gain} <= {high:g}, {len(self.branches)} branches>"


def loop_gain(loop: Loop, gain: Fraction | None = None) -> BoundTransferFunction:
    """Return the loop's function ``K B/A``, of the nominal K by default; SF806 where K is no gain of one."""
    above, below = _parts(loop)
    return _with(loop, above * (nominal_gain(loop) if gain is None else gain), below, Fraction(0))


def closed_loop(loop: Loop, gain: Fraction | None = None) -> BoundTransferFunction:
    """Return ``B/(A + K B)``, whose poles are those of the closed loop; as :func:`loop_gain` otherwise."""
    above, below = _parts(loop)
    value = nominal_gain(loop) if gain is None else gain
    return _with(loop, above, below + above * value, value)


def nominal_gain(loop: AnyLoop) -> Fraction:
    """Return the nominal gain; SF806 without one."""
    if loop.nominal is None:
        message = f"'{loop.gain.name}' has no value"
        raise UsageError(Diagnostic("SF806", message, loop.gain.span, "give it one in [parameters]"))
    return loop.nominal


def _parts(loop: Loop) -> tuple[Factored, Factored]:
    """Return B and A, both divided by what divides the characteristic function."""
    one = Factored.number(loop.bound.ratio.ring, 1)
    above = below = one
    if not is_straight(loop):
        name = loop.gain.name
        message = f"the characteristic function is not linear in '{name}'"
        hint = (
            f"use the parameter as the gain of one loop, or follow the poles by value: 'symflex sweep FILE "
            f"--over {name}=FROM:TO:lin:20 -o RUN.npz', then 'symflex plot sweep RUN.npz'"
        )
        raise UsageError(Diagnostic("SF806", message, loop.gain.span, hint))
    for factor in loop.factors:
        if factor.degree:
            above = above * factor.coefficients[1]
            below = below * factor.coefficients[0]
        elif factor.multiplicity < 0:
            divisor = factor.coefficients[0] ** factor.multiplicity
            above, below = above * divisor, below * divisor
    if below.is_zero:
        message = f"'{loop.gain.name}' divides the characteristic function, and moves no pole"
        raise ModelError(Diagnostic("SF801", message, loop.gain.span, NO_LOOP))
    return above, below


def is_straight(loop: Loop) -> bool:
    """Tell whether the characteristic function is a straight line in the gain, which closes one loop."""
    return [(f.degree, f.multiplicity) for f in loop.with_gain] == [(1, 1)]


def _with(loop: Loop, num: Factored, den: Factored, gain: Fraction) -> BoundTransferFunction:
    """Return a function of the given parts, whose poles are those of the model with a gain."""
    bound = loop.bound
    if den.is_zero:
        message = f"the equations have no unique solution for {loop.gain.name} = {float(gain):.6g}"
        hint = f"give '{loop.gain.name}' another value, or leave this one out of --range"
        raise ModelError(Diagnostic("SF231", message, loop.gain.span, hint))
    set_gain = (loop.gain.name, ExactValue(gain))
    values = tuple(set_gain if name == loop.gain.name else (name, value) for name, value in bound.values)
    return with_parts(replace(bound, values=values), num, den)


def closed_loop_roots(loop: AnyLoop, gain: Fraction, region: Region | None = None) -> PoleZeroMap:
    """Return the poles at a gain, the zeros of ``B/(A + K B)`` and whether the whole model is stable."""
    if isinstance(loop, NetworkLoop):
        return loop.located(gain, region or Modes(loop.modes))
    if not is_straight(loop):
        return locate(loop.bound_at(gain), region, 15)
    located = locate(closed_loop(loop, gain), region, 15)
    apart = poles_apart(loop.bound, loop.factors)
    return replace(located, verdict=located.verdict.beside(apart.verdict))


def _traceable(loop: AnyLoop, roots: Sequence[Root]) -> Traceable:
    """Return A and B where poles are followed between gains at which their roots are known."""
    if isinstance(loop, Loop):
        above, below = _parts(loop)
        return LoopFunction.of(loop.bound, below, above)
    largest = max((abs(s) for s in _points(roots)), default=0.0)
    for wider in WIDER if largest else ():
        try:
            return loop.in_disc(wider * largest)
        except (EssentialSingularityError, UndecidedError):
            continue
    message = "poles of the network cannot be followed as far as they are marked"
    if not largest:
        message = "the only poles known at the ends of the range are at s = 0"
    raise UncertifiedError(Diagnostic("SF807", message, None, "trace fewer modes: --modes N"))


def trace_locus(
    loop: AnyLoop,
    limits: tuple[Fraction | None, Fraction | None] | None = None,
    modes: int | None = None,
    *,
    band_hz: tuple[float, float] | None = None,
) -> RootLocus:
    """Return the root locus of a loop that is a straight line in its gain.

    ``limits`` go from 0 to 10 times the nominal gain by default. Of a loop with kernels ``modes`` are traced,
    by default as many as lie in the band [Hz] at the first or at the last gain, or 5. SF804 no range, SF806
    no straight line in the gain.
    """
    low, high = _range(loop, limits)
    is_endless = isinstance(loop, NetworkLoop) or loop.has_waves
    if modes is None and band_hz is not None and is_endless:
        band = Band(Fraction(0), Fraction(band_hz[1]))
        shown = [closed_loop_roots(loop, gain, band).poles for gain in (low, high)]
        modes = max(sum(root.multiplicity for root in poles if not root.im < 0) for poles in shown)
    wanted = modes or loop.model.analysis.modes or DEFAULT_MODES
    region: Region | None = Modes(wanted) if is_endless else None
    wider: Region | None = Modes(wanted + 2) if is_endless else None
    start = closed_loop_roots(loop, low, region)
    end = closed_loop_roots(loop, high, wider)
    spend()  # a search that ends with its time returns what it proved, perhaps nothing
    branches, matched, kept, entering = _followed(loop, (low, high), start, end, wanted if region else None)
    nominal = None
    if loop.nominal is not None and low < loop.nominal < high:
        nominal = loop.nominal, closed_loop_roots(loop, loop.nominal, region)
    return RootLocus(
        loop.gain.name,
        (low, high),
        start,
        end,
        tuple(branches),
        matched is not None,
        tuple(kept),
        tuple(entering),
        nominal,
    )


def _followed(
    loop: AnyLoop, ends: tuple[Fraction, Fraction], start: PoleZeroMap, end: PoleZeroMap, wanted: int | None
) -> tuple[list[Branch], set[int] | None, list[complex], list[Branch]]:
    """Return branches from the first gain, which last poles they reach, these, and branches that enter.

    ``None`` in place of the poles reached if branches and certified poles do not match. ``wanted`` are the
    modes that are shown of a loop with kernels.
    """
    function = _traceable(loop, (*start.all_poles, *end.all_poles))
    poles, final = _points(start.all_poles), _points(end.all_poles)
    bottom, top = map(float, ends)
    goals = _goals(bottom, top)
    resting = (0j,) * (_shared_at_zero(function, poles) if isinstance(function, LoopFunction) else 0)
    early = _trace(function, poles, bottom, goals[:1], resting)
    first = [branch[-1] for branch in early]
    later = _trace(function, first, goals[0], goals[1:], resting)
    forward = [one + other[1:] for one, other in zip(early, later, strict=True)]
    branches, reached = _as_far_as_proved(forward, end, final, is_endless=wanted is not None)
    matched = _matched(reached, final)
    lowest = [True] * len(final) if wanted is None else _lowest(end, wanted)
    kept = [s for i, s in enumerate(final) if lowest[i] or (matched is not None and i in matched)]
    entering: list[Branch] = []
    if matched is not None and len(kept) > len(matched):
        # Both members of a pair are followed, as where they part one of them may come from a marked pole.
        back = _trace(function, kept, top, [*reversed(goals[:-1])], resting)
        ended = {final[i] for i in matched}
        for s, branch in zip(kept, back, strict=True):
            near = _nearest(first, branch[-1])
            if near is None:
                entering.append(tuple(reversed(_before(end.excluded, branch))))
            elif s not in ended:
                branches.append((poles[near], *reversed(branch)))
    return branches, matched, kept, entering


def _as_far_as_proved(
    forward: Sequence[list[complex]], end: PoleZeroMap, final: Sequence[complex], *, is_endless: bool
) -> tuple[list[Branch], list[complex]]:
    """Return branches up to where poles accumulate, and the poles that they reach at the last gain.

    Poles of a loop with kernels are compared as far as they are proved at the last gain, and away from places
    where they accumulate, which no search exhausts.
    """
    reach = max((abs(s) for s in _points(end.poles)), default=0.0) if is_endless else inf
    branches, reached = list[Branch](), list[complex]()
    for branch in forward:
        last = branch[-1]
        is_known = _nearest(final, last) is not None
        is_lost = not is_known and _is_among(end.excluded, last)
        if is_known or (not is_lost and abs(last) < reach):
            reached.append(last)
        branches.append(tuple(_before(end.excluded, branch) if is_lost else branch))
    return branches, reached


def _shared_at_zero(function: LoopFunction, poles: Sequence[complex]) -> int:
    """Return how often A and B both vanish at 0, as they do where a hidden pole rests there."""
    omega = arb(TOUCHING * max((abs(s) for s in poles), default=1.0))
    _, value = function.on(omega, ORIGIN_BITS)
    with precision(ORIGIN_BITS):
        orders = [
            acb(0, 1) * omega * slope / of
            for of, slope in ((value.a, value.a_slope), (value.b, value.b_slope))
        ]
    return min(round(float(order.real.mid())) if order.is_finite() else 0 for order in orders)


def _range(
    loop: AnyLoop, limits: tuple[Fraction | None, Fraction | None] | None
) -> tuple[Fraction, Fraction]:
    """Return the first and the last gain."""
    name = loop.gain.name
    if limits is None:
        if not loop.nominal:
            value = "no value" if loop.nominal is None else "no value but 0"
            message = f"'{name}' has {value} from which a locus could take its range"
            raise UsageError(Diagnostic("SF804", message, None, "say --range LO HI"))
        return min(Fraction(0), 10 * loop.nominal), max(Fraction(0), 10 * loop.nominal)
    low, high = limits
    if low is None or high is None:
        message = f"a locus ends at a finite value of '{name}'"
        raise UsageError(Diagnostic("SF804", message, None, "say --range LO HI with two numbers"))
    if low >= high:
        how = "is empty" if low == high else "is reversed"
        message = f"the range of '{name}' {how}: {float(low):.6g} to {float(high):.6g}"
        hint = (
            "give two different values" if low == high else f"say --range {float(high):.6g} {float(low):.6g}"
        )
        raise UsageError(Diagnostic("SF804", message, None, hint))
    return low, high


def _points(roots: Sequence[Root]) -> list[complex]:
    return [complex(float(r.re.mid()), float(r.im.mid())) for r in roots for _ in range(r.multiplicity)]


def _lowest(located: PoleZeroMap, wanted: int) -> list[bool]:
    """Tell which poles of a map, with multiplicity, are of the lowest modes, or in the right half-plane."""
    positions = [*Modes(wanted).classify(located.poles), *(Position.INSIDE for _ in located.unstable)]
    return [
        position is not Position.OUTSIDE or is_right(root)
        for root, position in zip(located.all_poles, positions, strict=True)
        for _ in range(root.multiplicity)
    ]


def _goals(low: float, high: float) -> list[float]:
    """Return gains above the first, close at the beginning; the last is the last of the range."""
    growth = (1 / FIRST_SHARE) ** (1 / STEPS)
    gain, shift = low, (high - low) * FIRST_SHARE
    goals = []
    while gain < high:
        spend()
        gain = min(low + shift, high)
        goals.append(gain)
        shift *= growth
    return goals


def _is_among(holes: Sequence[Exclusion], s: complex) -> bool:
    """Tell whether a point is in a part of the plane in which poles accumulate."""
    return any(abs(complex(s.real - hole.re, abs(s.imag) - hole.im)) <= hole.radius for hole in holes)


def _before(holes: Sequence[Exclusion], branch: list[complex]) -> list[complex]:
    """Return a curve up to where it enters such a part; its first point, which is proved, in any case."""
    inside = (i for i, s in enumerate(branch) if i and _is_among(holes, s))
    return branch[: next(inside, len(branch))]


def _nearest(points: Sequence[complex], s: complex) -> int | None:
    """Return the position of the point that a pole agrees with."""
    return next((i for i, p in enumerate(points) if abs(p - s) <= ENDS_AGREE * (1 + abs(s))), None)


def _trace(
    function: Traceable,
    poles: Sequence[complex],
    gain: float,
    goals: Sequence[float],
    resting: tuple[complex, ...],
) -> list[list[complex]]:
    """Return the curves of poles from one gain through others, but of hidden ones that rest at 0."""
    size = max((abs(s) for s in poles), default=1.0) or 1.0
    branches = [[s] for s in poles]
    current, reached = list(poles), gain
    for goal in goals:
        pending = [goal]
        while pending:
            spend()
            aim = pending[-1]
            moved = _moved(function, current, aim, size, resting)
            far = max(
                (abs(a - b) / max(size, abs(b)) for a, b in zip(moved, current, strict=True)), default=0.0
            )
            if (far > FAREST or _bends(branches, moved, size)) and len(pending) < HALVINGS:
                pending.append((reached + aim) / 2)
                continue
            current, reached = moved, aim
            pending.pop()
            for branch, s in zip(branches, current, strict=True):
                branch.append(s)
    return branches


def _bends(branches: Sequence[Sequence[complex]], moved: Sequence[complex], size: float) -> bool:
    """Tell whether a curve would turn visibly in one step."""
    for branch, s in zip(branches, moved, strict=True):
        if len(branch) > 1:
            before, after = branch[-1] - branch[-2], s - branch[-1]
            shortest = SHORTEST * max(size, abs(s))
            if abs(after) > shortest and abs(before) > 0 and abs(phase(after / before)) > BEND:
                return True
    return False


def _moved(
    function: Traceable, poles: Sequence[complex], gain: float, size: float, resting: tuple[complex, ...]
) -> list[complex]:
    """Return the poles at the next gain; those that meet are sent apart."""
    moved: list[complex] = []
    for i, s in enumerate(poles):
        parts = s in resting or sum(abs(p - s) < TOUCHING * size for p in poles) > 1
        new = None if parts else _newton(function, s, gain, resting)
        twins = [k for k in range(i) if new is not None and abs(moved[k] - new) < TOUCHING * size]
        if new is None or twins or abs(new - s) > 2 * FAREST * max(size, abs(s)):
            # Another pole is there already, or two part from the axis: the others are divided out.
            known = (*resting, *moved)
            shares = PARTING if parts else PARTING[:1]
            tries = [s + rect(share * size, angle) for share in shares for angle in TURNS]
            candidates = [c for start in tries if (c := _newton(function, start, gain, known)) is not None]
            apart = [c for c in candidates if all(abs(c - f) > TOUCHING * size for f in moved)]
            if apart:
                new = min(apart, key=lambda c: abs(c - s))
        moved.append(s if new is None else new)
    return moved


def _newton(function: Traceable, start: complex, gain: float, known: Sequence[complex]) -> complex | None:
    """Return a root of A + K B with known ones divided out, ``None`` where it is not found."""
    s = start
    for _ in range(NEWTON_STEPS):
        a, a_slope, b, b_slope = function.near(s)
        value, slope = a + gain * b, a_slope + gain * b_slope
        if value == 0:
            return s
        quotient = slope / value - sum(1 / (s - k) for k in known if s != k)
        if quotient == 0:
            return None
        step = 1 / quotient
        s -= step
        if not isfinite(s):
            return None
        if abs(step) <= CONVERGED * (1 + abs(s)):
            # Rounding leaves real poles real.
            return complex(s.real, 0.0) if abs(s.imag) < CONVERGED * (1 + abs(s)) * 100 else s
    return None


def _matched(ends: Sequence[complex], proved: Sequence[complex]) -> set[int] | None:
    """Return the positions of the poles that ends are close to, ``None`` unless each has one of its own."""
    free = dict(enumerate(proved))
    for end in ends:
        near = min(free, key=lambda i: abs(free[i] - end), default=None)
        if near is None or abs(free[near] - end) > ENDS_AGREE * (1 + abs(end)):
            return None
        del free[near]
    return set(range(len(proved))) - set(free)


def require_arrival(locus: RootLocus) -> None:
    """Raise SF807 when curves of a locus do not end in certified poles."""
    if not locus.arrived:
        message = (
            f"the traced poles do not end at the poles proved at {locus.gain} = {float(locus.limits[1]):.6g}"
        )
        hint = "narrow the range of the gain"
        low, high = locus.limits
        if low < 0 < high:
            hint = f"draw each side of zero alone: --range 0 {float(high):.6g}"
        elif locus.end.is_infinite:
            hint += ", or trace fewer modes: --modes N"
        raise UncertifiedError(Diagnostic("SF807", message, None, hint))
