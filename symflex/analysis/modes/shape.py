"""A shape: what moves at a pole, or in step with an input, how far, and with what bound.

Amplitudes are divided by the largest displacement.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, log2, pi
from typing import Self, TypeVar

from flint import acb, acb_mat, arb, arb_mat

from symflex.along.law import BoundLaw
from symflex.balls import ball, current_bits, precision
from symflex.errors import nearest, refused
from symflex.library.elements import Variable
from symflex.roots import Root

SQUARINGS = 7  # the 128th root of a 128th power of a matrix is near its spectral radius
SAMPLES_PER_HALF_WAVE = 16  # the largest is within 0.5 % of the crest: cos(pi/32) = 0.995
FEWEST_SAMPLES, MOST_SAMPLES = 32, 4096


@dataclass(frozen=True, slots=True)
class Motion:
    """What one unknown, or the input of a deflection, does."""

    name: str  # as an expression names it: ``x_tip``, ``p.theta``, ``motor.i``; ``w''(0)`` of a field
    variable: Variable  # the unknown
    value: acb  # its complex amplitude, enclosed
    unit: str  # SI unit; empty for signals and fields


@dataclass(frozen=True, slots=True, eq=False)
class VaryingCarrier:
    """What takes the state along a part whose coefficients vary along x."""

    parts: tuple[tuple[tuple[int, ...], BoundLaw], ...]  # states that are coupled, and their law
    s: acb  # where the shape is [rad/s]
    size: int  # how many states there are
    # What was computed, by the exact places and the precision.
    _known: dict[tuple[object, ...], list[list[acb]]] = field(default_factory=dict, repr=False)

    def started(self, initial: tuple[acb, ...]) -> tuple[acb, ...]:
        """Return the whole state at the start, given what is free there: at a tip others follow."""
        state = list(initial)
        for states, law in self.parts:
            if law.law.singular is None:
                continue
            rows = law.law.singular.at_start()
            for i, row in zip(states, rows, strict=False):
                terms = (law.value(x, {}, self.s) * initial[j] for x, j in zip(row, states, strict=False))
                state[i] = sum(terms, acb(0))
        return tuple(state)

    def step(self, first: arb, second: arb) -> list[list[acb]]:
        """Return what takes the state, and the loads, from one distance from the start to another."""
        ends = (tuple(map(int, y.man_exp())) for x in (first, second) for y in (x.mid(), x.rad()))
        key = current_bits(), *ends
        if key in self._known:
            return self._known[key]
        self._known[key] = rows = [[acb(int(i == j)) for j in range(self.size)] for i in range(self.size)]
        for states, law in self.parts if second != first else ():
            start, _ = law.ends()
            within = start if first == 0 else start + first, start + second
            matrix = law.matrix_at(self.s, within)
            for row, i in zip(matrix, states, strict=False):
                for x, j in zip(row, states, strict=False):
                    rows[i][j] = x
                rows[i] += row[len(states) :]
        return rows

    def growth(self, length: arb) -> float:
        """Return about by which power of e waves grow from end to end at most."""
        starts = [(law, law.ends()[0]) for _, law in self.parts]
        # Next to a tip coefficients have poles: a little away from it.
        return max(
            law.growth_about(self.s, (start + length / MOST_SAMPLES, start + length)) for law, start in starts
        )


@dataclass(frozen=True, slots=True)
class DistributedShape:
    """What a distributed element or field does along x."""

    name: str
    kind: str  # the element's type; of a field, ``field``
    # What is known along x. Of an element, displacements first, then what the part beyond x exerts on the
    # part before it: ``y theta f tau`` of a beam, ``x y theta f_x f_y tau`` of a frame, ``u f`` of a rod,
    # ``theta tau`` of a shaft, ``w f`` of a string. Of a field, its unknowns and derivatives: ``w w' w''``.
    states: tuple[str, ...]
    matrix: tuple[tuple[acb, ...], ...]  # ``dz/dx = matrix z + load``; none if it varies, loads then
    load: tuple[acb, ...]
    initial: tuple[acb, ...]
    start: arb  # where x begins [m]
    length: arb  # how far it reaches [m]
    bits: int  # of the precision everything is computed at
    direction: tuple[arb, ...] = ()  # cosine and sine of the angle of a member in the plane
    varying: VaryingCarrier | None = None  # what takes the state along where coefficients vary along x

    @property
    def displacements(self) -> tuple[int, ...]:
        """The places among the states of how far it moves: x and y in the plane, else the first."""
        return (0, 1) if self.direction else (0,)

    def position(self, quantity: str | None = None) -> int:
        """Return the place of a quantity among the states, of the first for None; SF902 without such."""
        if quantity is None:
            return 0
        if quantity not in self.states:
            hint = nearest(quantity, self.states) or "available: " + ", ".join(self.states)
            raise refused(f"there is no '{quantity[:64]}' along '{self.name}'", hint)
        return self.states.index(quantity)

    def at(self, x: Fraction) -> tuple[acb, ...]:
        """Return the state at a place x [m], enclosed."""
        with precision(self.bits):
            distance = ball(x) - self.start
            return self._carried(self._step(arb(0), distance), self.initial)

    def state_at_share(self, share: Fraction) -> tuple[acb, ...]:
        """Return the state at a share of the length from the start, enclosed."""
        return self.state_beyond(self.initial, Fraction(0), share)

    def state_beyond(self, state: tuple[acb, ...], first: Fraction, second: Fraction) -> tuple[acb, ...]:
        """Return the state at a share of the length, enclosed, given that at another share."""
        with precision(self.bits):
            ends = (self.length * share.numerator / share.denominator for share in (first, second))
            return self._carried(self._step(*ends), state)

    def sampled(self, intervals: int) -> Iterator[tuple[Fraction, tuple[acb, ...]]]:
        """Yield the share of the length, from 0 to 1, and the state there, at equal steps."""
        with precision(self.bits):
            part = self.length / intervals
            step = self._step(arb(0), part)
        state = self.initial
        for i in range(intervals):
            yield Fraction(i, intervals), state
            with precision(self.bits):
                if i and self.varying is not None:
                    step = self._step(part * i, part * (i + 1))
                state = self._carried(step, state)
        yield Fraction(1), state

    def intervals(self) -> int:
        """Return in how many steps no wave is missed: some per half wavelength."""
        with precision(self.bits):
            waves = None if self.varying is None else self.varying.growth(self.length)
        if waves is None:
            waves = self._spectral_radius() * float(self.length.mid())
        wanted = ceil(SAMPLES_PER_HALF_WAVE * waves / pi)
        return min(max(FEWEST_SAMPLES, wanted + wanted % 2), MOST_SAMPLES)

    def scaled(self, factor: acb) -> DistributedShape:
        """Return the shape with all amplitudes times a number."""
        load, initial = (tuple(x * factor for x in part) for part in (self.load, self.initial))
        return replace(self, load=load, initial=initial)

    def _step(self, first: arb, second: arb) -> list[list[acb]]:
        """Return what takes the state, and a one for the load or all loads, between distances."""
        if self.varying is not None:
            return self.varying.step(first, second)
        distance = second - first
        rows = [
            [*(x * distance for x in row), b * distance]
            for row, b in zip(self.matrix, self.load, strict=True)
        ]
        rows.append([acb(0)] * len(rows[0]))
        if all(x.imag == 0 for row in rows for x in row):
            real = arb_mat([[x.real for x in row] for row in rows]).exp().tolist()
            return [[acb(x) for x in row] for row in real]
        propagator: list[list[acb]] = acb_mat(rows).exp().tolist()
        return propagator

    def _carried(self, step: Sequence[Sequence[acb]], state: tuple[acb, ...]) -> tuple[acb, ...]:
        extended = (*state, *((acb(1),) if self.varying is None else self.load))[: len(step[0])]
        rows = step[: len(state)]
        return tuple(sum((a * z for a, z in zip(row, extended, strict=True)), acb(0)) for row in rows)

    def _spectral_radius(self) -> float:
        """Return about the largest spatial exponent [1/m], from a high power of the matrix."""
        with precision(self.bits):
            power, exponent = acb_mat([[x.mid() for x in row] for row in self.matrix]), 0
            for _ in range(SQUARINGS):
                power = (power * power).mid()
                size = max(float(_log2(x)) for x in power.entries())
                if size == float("-inf"):
                    return 0.0
                shift = round(size)
                power = power * acb(2) ** -shift
                exponent = 2 * exponent + shift
        return float(2.0 ** (exponent / 2**SQUARINGS))


def _log2(value: acb) -> float:
    size = value.abs_upper()
    if size == 0:
        return float("-inf")
    mantissa, exponent = size.man_exp()
    return log2(int(mantissa)) + int(exponent)


@dataclass(frozen=True, slots=True)
class EnclosedShape:
    """How everything in a model moves at one s, up to a complex factor."""

    motions: tuple[Motion, ...]  # one for every unknown of the equations
    distributed: tuple[DistributedShape, ...]  # of every beam, rod, shaft, string and field
    reference: str  # what is 1: a node, or ``element(x)`` with the place; of a frame ``element.y(x)``

    def scaled(self, factor: acb) -> Self:
        """Return the shape with all amplitudes times a number."""
        motions = tuple(replace(m, value=m.value * factor) for m in self.motions)
        return replace(self, motions=motions, distributed=tuple(p.scaled(factor) for p in self.distributed))

    def motion(self, name: str) -> Motion:
        """Return what a node, element quantity or signal does; SF902 when there is none of that name."""
        motions = {m.name: m for m in reversed(self.motions)}
        if name not in motions and f"{name}.y" in motions:
            name = f"{name}.y"
        if name not in motions:
            hint = nearest(name, motions) or "available: " + ", ".join(list(reversed(motions))[:8])
            raise refused(f"nothing is called '{name[:64]}' in the mode", hint)
        return motions[name]

    def along(self, name: str) -> DistributedShape:
        """Return the shape of a distributed element or field; SF902 when there is none of that name."""
        parts = {part.name: part for part in self.distributed}
        if name not in parts:
            hint = nearest(name, parts) or ("available: " + ", ".join(parts) if parts else None)
            raise refused(f"'{name[:64]}' is not a distributed element or field", hint)
        return parts[name]


@dataclass(frozen=True, slots=True)
class EnclosedModeShape(EnclosedShape):
    """The motion of a model at one pole."""

    pole: Root
    certified: bool  # the pole is certified, and has no other shape: balls contain true amplitudes

    def __repr__(self) -> str:
        return f"<EnclosedModeShape at {self.pole.frequency_hz():.6g} Hz, {self.reference} = 1>"

    @property
    def is_real(self) -> bool:
        """True when all that moves does so in phase: the pole is undamped and no motion is proved complex."""
        moving = [m.value for m in self.motions if m.unit in ("m", "rad")]
        for part in self.distributed:
            moving += [*part.initial, *part.load, *(x for row in part.matrix for x in row)]
        moving = moving or [m.value for m in self.motions]
        return self.pole.on_imaginary_axis and all(value.imag.contains(0) for value in moving)


@dataclass(frozen=True, slots=True)
class Deflection(EnclosedShape):
    """The steady motion of a model under cos(omega t), the last of its motions, which is real."""

    frequency_hz: Fraction
    amplitude: acb  # of the reference, per unit of the input, enclosed


Shape = TypeVar("Shape", bound=EnclosedShape)

TURNING = ("shaft",)
TIE = 1 + 1e-9  # a displacement must be larger by this factor to replace an earlier reference
SECTIONS = 40  # steps of golden section: to 4e-9, finer than doubles resolve a maximum
GOLDEN = 0.6180339887498949  # (sqrt(5) - 1)/2


@dataclass(frozen=True, slots=True)
class _PlacedAmplitude:
    """An amplitude and where it is met."""

    name: str
    value: acb
    part: DistributedShape | None = None
    share: Fraction = Fraction(0)
    width: Fraction = Fraction(0)
    place: int = 0  # among the part's states

    @property
    def size(self) -> float:
        """The midpoint's absolute value."""
        return float(abs(self.value.mid()))


def normalised(shape: Shape, digits: int) -> Shape | None:
    """Return a shape whose largest displacement is 1, None when its balls do not tell which that is.

    Without displacements it is the largest angle, then voltage; 10^-digits of another motion is at rest.
    """
    groups = [list(places) for places in _groups(shape)]
    largest = max((p.size for group in groups for p in group), default=0.0)
    for group in groups:
        reference = _largest(group)
        if reference is None or reference.size + float(reference.value.rad()) < largest * 10.0**-digits:
            continue
        if reference.value.contains(0):
            return None
        return _scaled(shape, _refined(reference))
    return None


def _groups(shape: EnclosedShape) -> Iterator[Iterator[_PlacedAmplitude]]:
    """Yield what competes for being the largest, the kind that matters most first."""

    def group(unit: str, chosen: Callable[[DistributedShape], bool]) -> Iterator[_PlacedAmplitude]:
        for motion in shape.motions:
            if motion.unit == unit and motion.variable.kind == "node":
                yield _PlacedAmplitude(motion.name, motion.value)
        for part in shape.distributed:
            if chosen(part):
                yield from _along(part)

    yield group("m", lambda part: part.kind not in TURNING)
    yield group("rad", lambda part: part.kind in TURNING)
    yield group("V", lambda part: False)
    others = [m for m in shape.motions if m.variable.kind not in ("node", "input")]
    yield (_PlacedAmplitude(m.name, m.value) for m in others)


def _along(part: DistributedShape) -> Iterator[_PlacedAmplitude]:
    intervals = part.intervals()
    for share, state in part.sampled(intervals):
        for i in part.displacements:
            name = f"{part.name}.{part.states[i]}" if part.direction else part.name
            yield _PlacedAmplitude(name, state[i], part, share, Fraction(1, intervals), i)


def _largest(places: list[_PlacedAmplitude]) -> _PlacedAmplitude | None:
    largest: _PlacedAmplitude | None = None
    for amplitude in places:
        if largest is None or amplitude.size > largest.size * TIE:
            largest = amplitude
    return largest


def _refined(amplitude: _PlacedAmplitude) -> _PlacedAmplitude:
    """Return the place of the largest amplitude next to a sample, by golden section."""
    part = amplitude.part
    if part is None or amplitude.share in (0, 1):
        return amplitude

    before = amplitude.share - amplitude.width
    start = part.state_at_share(before)

    def value(share: float | Fraction) -> acb:
        return part.state_beyond(start, before, Fraction(share))[amplitude.place]

    def size(share: float) -> float:
        return float(abs(value(share).mid()))

    low, high = float(amplitude.share - amplitude.width), float(amplitude.share + amplitude.width)
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = size(left), size(right)
    for _ in range(SECTIONS):
        if at_left < at_right:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = size(right)
        else:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = size(left)
    share = Fraction((low + high) / 2)
    return replace(amplitude, share=share, value=value(share))


def _scaled(shape: Shape, reference: _PlacedAmplitude) -> Shape:
    part, name = reference.part, reference.name
    if part is not None:
        with precision(part.bits):
            x = part.start + part.length * reference.share.numerator / reference.share.denominator
        name = f"{name}({float(x.mid()):.6g})"
    with precision(max(64, reference.value.bits()) + 32):
        shape = shape.scaled(1 / reference.value)
        motions = tuple(
            replace(m, value=acb(1)) if m.name == name and m.variable.kind == "node" else m
            for m in shape.motions
        )
    return replace(shape, motions=motions, reference=name)


def is_accurate(shape: EnclosedShape, digits: int) -> bool:
    """Tell whether motions, also at the far ends of distributed parts, have the requested digits."""
    groups: dict[tuple[str, str], list[acb]] = {}
    for motion in shape.motions:
        groups.setdefault((motion.unit, motion.variable.kind), []).append(motion.value)
    for part in shape.distributed:
        middle, end = (part.state_at_share(Fraction(1, n)) for n in (2, 1))
        for name, *values in zip(part.states, part.initial, middle, end, strict=True):
            groups.setdefault((part.name, name), []).extend(values)
    sizes = [
        (max(float(abs(v.mid())) for v in values), max(float(v.rad()) for v in values))
        for values in groups.values()
    ]
    overall = max((largest for largest, radius in sizes if largest > radius), default=0.0)
    # What vanishes altogether has no size of its own to be measured by.
    return all(
        radius <= 10.0**-digits * (largest if largest > radius else overall) for largest, radius in sizes
    )
