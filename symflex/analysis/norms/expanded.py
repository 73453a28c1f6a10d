"""A transfer function as principal parts at its poles in a disc about 0, and a power series for what is left.

Input: a bound transfer function and how many modes. Output: an :class:`Expanded`, valid in the disc.

Example: ``tanh(s)/s`` in the disc of radius 3 is ``2/(s^2 + pi^2/4)`` and a power series about 0, which
begins with ``1 - 8/pi^2``: the static correction of the modes beyond.

All poles in the disc are known, so that what is left is analytic there, at s = 0 as well, where wavenumbers
vanish. Its values on a circle make the coefficients (Lyness and Moler 1967), and its bound on the rim those
left out, by Cauchy's estimate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import inf, pi

from flint import acb, arb

from symflex.algebra import LAPLACE, NO_KERNELS, Kernel, Ring, degree_in
from symflex.analysis.rational.laurent import PrincipalPart, expand_at_zero, residues_at
from symflex.balls import UndecidedError, at_centre, ball, covered, precision
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.loops.loop_function import LoopFunction
from symflex.model.model import IMAGINARY
from symflex.roots import Everything, Modes, PoleZeroMap
from symflex.roots.distributed.far_out import SECTORS, FunctionFarOut
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import Certificate, chosen
from symflex.roots.problem import polynomial_in_s
from symflex.transfer import AnyBoundFunction, BoundTransferFunction

BITS = 192  # of values; those at the coarsest points lose the digits that poles near a circle cost
WIDE_BITS = 128  # of balls, where sums of exponentials cancel
BLURRED = 10_000  # radius of a ball on the rim over the largest value there, at most
DIGITS = 30  # of poles and residues
FURTHER = 8  # modes beyond those kept that are looked for, so that the disc reaches beyond these
FAR = 1e15  # frequency [rad/s] at which a limit is guessed
NEAR_LIMIT = 0.01  # share of it that the function differs there, at most
LARGEST_DENOMINATOR = 9  # digits of the denominator of a limit that is guessed
MOST_RADII, SPARE = 6, 3  # that are tried first, and of the smaller ones every so many
BLUR = 1e-3  # share of a value that a series may lack, unless no smaller disc is sharper
# Radii [rad/s] that are tried where there is no pole, and the largest growth from the axis to the circle.
DISCS, TAMEST = tuple(10.0**k for k in range(3, -7, -1)), 16
APART = 1.02  # least ratio of sizes of poles between which a rim passes
ARCS, MOST_ARCS = 32, 2048  # of the upper half of the rim
POINTS, TERMS = 96, 72  # values on the inner circle, and coefficients
INNER = 0.5  # radius of the inner circle over that of the rim
USED = 0.7  # share of the radius in which the series serves


@dataclass(frozen=True, eq=False)
class Expanded:
    """A transfer function in a disc, and what encloses it elsewhere."""

    bound: AnyBoundFunction  # without the delay of all of it
    delay: arb  # of all of it [s]
    located: PoleZeroMap  # its poles
    parts: tuple[PrincipalPart, ...]  # at all poles in the disc
    radius: float  # of the disc [rad/s]; infinite if the function is rational
    regular: tuple[acb, ...]  # the first coefficients of what is left
    rim: arb  # at least as large as that is in the disc
    reasons: tuple[str, ...]  # what is not proved

    @property
    def used(self) -> float:
        """Frequency [rad/s] up to which the series serves."""
        return USED * self.radius

    @cached_property
    def missing(self) -> arb:
        """What the series lacks at most up to :attr:`used`."""
        if self.radius == inf:
            return arb(0)
        return (self.rim * arb(USED) ** len(self.regular) / (1 - arb(USED))).upper()

    @property
    def is_sharp(self) -> bool:
        """Whether the series lacks little: delays beside a direct path grow in the left half-plane."""
        return bool(self.missing < BLUR * abs(self.at(acb(0, self.used))).lower())

    @cached_property
    def far_out(self) -> tuple[FunctionFarOut | None, Fraction]:
        """What bounds the function far out less its limit there, and the limit."""
        return _far_out(self.bound)

    @cached_property
    def _loop(self) -> LoopFunction | None:
        bound = self.bound
        return LoopFunction.of(bound, bound.num, bound.den) if bound.is_reduced and bound.kernels else None

    @cached_property
    def _enclosed(self) -> dict[int, Callable[[acb], acb]]:
        return {}

    def at(self, s: acb) -> acb:
        """Return the value at a point, not finite at poles and 0."""
        return self._value(s, BITS)

    def around(self, s: acb) -> acb:
        """Return a ball around the values on a ball of s, not finite near poles and 0."""
        if self._loop is None:
            return self._value(s, WIDE_BITS)
        both, _ = self._loop.around(s, WIDE_BITS)
        return both.a / both.b

    def _value(self, s: acb, bits: int) -> acb:
        if bits not in self._enclosed:
            self._enclosed[bits] = self.bound.enclosed(bits)
        return self._enclosed[bits](s)


def _far_out(bound: AnyBoundFunction) -> tuple[FunctionFarOut | None, Fraction]:
    """Return what bounds a function with waves or delays far out less its limit there, and the limit.

    A limit is guessed from its enclosure, and taken if less it the function is proved to be small; else 0.
    """
    if not isinstance(bound, BoundTransferFunction) or bound.is_rational:
        return None, Fraction(0)
    far = FunctionFarOut.of(bound, SECTORS)
    size = None if far is None else far.size(FAR)
    if size is None or size.power != 0 or not size.lead.is_finite():
        return far, Fraction(0)
    limit = _simplest(size.lead.real)
    rest = bound.num - bound.den * limit
    if not limit or rest.is_zero:
        return far, Fraction(0)
    less = FunctionFarOut.of(replace(bound, ratio=rest / bound.den, parts=None), SECTORS)
    own = None if less is None else less.size(FAR)
    is_smaller = own is not None and own.power <= 0 and own.most < NEAR_LIMIT * abs(ball(limit))
    return (less, limit) if is_smaller else (far, Fraction(0))


def _simplest(value: arb) -> Fraction:
    """Return a fraction of few digits in a ball."""
    middle = Fraction(float(value.mid()))
    some = (middle.limit_denominator(10**k) for k in range(LARGEST_DENOMINATOR + 1))
    return next((f for f in some if value.contains(ball(f))), middle)


def turning_delays(functions: Sequence[Sequence[Expanded]]) -> tuple[tuple[arb, ...], ...]:
    """Return the delays that were left out, less those of inputs and outputs; nothing where none is left.

    Those change no singular value; others do, as they turn one entry of a matrix against another.
    """
    first = [f.delay for f in functions[0]]
    rows: list[tuple[arb, ...]] = []
    with precision(BITS):
        for row in functions:
            own = (f.delay - row[0].delay - y + first[0] for f, y in zip(row, first, strict=True))
            rows.append(tuple(arb(0) if x.contains(0) else x for x in own))
    return tuple(rows) if any(x != 0 for row in rows for x in row) else ()


def is_delay(kernel: Kernel, ring: Ring) -> bool:
    """Tell whether a kernel is ``exp(-s*T)``, whose size is 1 on the axis."""
    s, shift = ring.context.gen(0), kernel.dispersion.shift.factors
    return kernel.function == "exp" and all(e == 1 if f == s else not degree_in(f, 0) for f, e in shift)


def without_delay(bound: AnyBoundFunction) -> tuple[AnyBoundFunction, arb]:
    """Return a function without the delay of all of it, which changes no magnitude, and the delay [s]."""
    total = arb(0)
    if not bound.is_reduced:
        return bound, total
    ring, delays = bound.ratio.ring, []
    with precision(BITS):
        evaluator = bound.kernel_values() if bound.kernels else None
        for kernel in bound.kernels.kernels:
            generator = ring.generator(kernel.generator)
            exponent = bound.ratio.exponent_of(generator)
            if exponent and evaluator is not None and is_delay(kernel, ring):
                delays.append(generator)
                named = evaluator.generators_at(acb(1))
                rate = at_centre(evaluator.value(kernel.dispersion.shift * kernel.length, named))
                total += exponent * rate.real
    if not delays:
        return bound, total
    value = bound.ratio.filter(lambda f: f not in delays) * bound.ratio.unit
    has_kernels = any(value.depends_on(name) for name in bound.kernels.generators)
    return replace(
        bound, ratio=value, kernels=bound.kernels if has_kernels else NO_KERNELS, parts=None
    ), total


def expanded(
    bound: AnyBoundFunction,
    modes: int,
    digits: int = DIGITS,
    alike: Sequence[Expanded] = (),
    *,
    judged: PoleZeroMap | None = None,
    keeps_delay: bool = False,
) -> Expanded:
    """Return a function in a disc that reaches beyond so many modes; others ``alike`` may share its poles.

    SF802 for functions of a root of s, or with loss factors, SF405 where residues are not known, SF236 for
    one that grows with frequency.
    """
    if bound.is_reduced:
        bound = without_lengths_of_zero(bound)
        if bound.sheets > 1 or IMAGINARY in bound.ratio.ring.index:
            message = f"no principal parts are known of {bound.name}, with a root of s or loss factors"
            raise UncertifiedError(Diagnostic("SF802", message))
    if bound.is_zero:
        return Expanded(bound, arb(0), _without_poles(bound.name), (), inf, (acb(0),), arb(0), ())
    bound, delay = (bound, arb(0)) if keeps_delay else without_delay(bound)
    is_rational = bound.is_rational and bound.is_reduced
    region = Everything() if is_rational else Modes(modes + max(FURTHER, modes // 2 + 4))
    shared = (f.located for f in alike if _has_poles_of(f.bound, bound))
    located = next(shared, None) or locate(bound, region, digits, with_zeros=False, judged=judged).complete()
    certificate = located.certificate
    reasons: tuple[str, ...] = () if certificate.certified else (f"poles: {certificate.reason}",)
    if any(not hidden.is_proved for hidden in located.hidden):
        reasons += ("poles and zeros that agree in all digits cancel",)
    radii = [inf] if is_rational else _radii(located, has_none=_is_entire(bound))
    inside = [pole for pole in located.all_poles if bool(pole.size() < radii[0])]
    parts = residues_at(bound, inside, digits)
    if any(part.is_estimate for part in parts):
        reasons += ("residues",)
    with precision(BITS):
        function = Expanded(bound, delay, located, parts, radii[0], (), arb(0), reasons)
        if is_rational:
            return replace(function, regular=(_feedthrough(bound),))
        blurred: Expanded | None = None
        for radius in radii:
            own = tuple(part for part in parts if bool(part.root.size() < radius))
            found = _with_series(replace(function, parts=own, radius=radius))
            if found is None or not (located.poles or _is_tame(found)):
                continue
            if found.is_sharp:
                return found
            blurred = found if blurred is None or found.missing < blurred.missing else blurred
        if blurred is not None:
            return blurred
    message = f"{bound.name} is not bounded about its first {len(parts)} poles"
    raise UncertifiedError(Diagnostic("SF405", message, None, "ask for fewer modes, or another number"))


def _without_poles(name: str) -> PoleZeroMap:
    return PoleZeroMap(name, Everything(), (), (), (), Certificate("none", 0, 0))


def _is_entire(bound: AnyBoundFunction) -> bool:
    """Tell whether a denominator has neither s nor a kernel, as that of sums of delays."""
    if not bound.is_reduced:
        return False
    varying = {LAPLACE, *(k.generator for k in bound.kernels.kernels)}
    return not varying & bound.ratio.ring.used_in(f for f, _ in bound.den.factors)


def _is_tame(function: Expanded) -> bool:
    """Tell whether a function without poles is hardly larger on a circle about 0 than on the axis there."""
    size = abs(function.at(acb(0, function.radius))).lower()
    return bool(function.rim <= TAMEST * size)


def _has_poles_of(one: AnyBoundFunction, other: AnyBoundFunction) -> bool:
    if not (one.is_reduced and other.is_reduced):
        return False
    return one.kernels == other.kernels and one.den / one.den.unit == other.den / other.den.unit


def _radii(located: PoleZeroMap, *, has_none: bool) -> list[float]:
    """Return some radii that no pole is near, the largest first, within which all poles are known."""
    # Poles in the right half-plane that lie beyond the modes do not say that those between are known.
    sizes = sorted({float(pole.size().mid()) for pole in chosen(located.poles, located.region)})
    edges = [abs(complex(e.re, e.im)) - e.radius for e in located.excluded]
    if not sizes and not edges and has_none:
        return list(DISCS)
    if not sizes and not edges:
        message = f"no pole of {located.tf} was found, about which to expand it"
        raise UncertifiedError(Diagnostic("SF405", message))
    limit = min([sizes[-1]] if sizes else [], default=inf)
    limit = min([limit, *edges])
    below = [size for size in sizes if size < limit]
    pairs = reversed([*pairwise([*below, limit])])
    between = [(low * high) ** 0.5 for low, high in pairs if low and high > APART * low]
    lowest = next((size for size in below if size), limit)
    return [*between[:MOST_RADII], *between[MOST_RADII::SPARE], 0.5 * lowest]


def _feedthrough(bound: AnyBoundFunction) -> acb:
    """Return the limit of a rational function as the frequency grows."""
    if not bound.is_reduced:
        raise UncertifiedError(Diagnostic("SF802", f"{bound.name} is not written out"))
    above, below = (polynomial_in_s(bound, part.expand()) for part in (bound.num, bound.den))
    if above.degree > below.degree:
        message = f"{bound.name} grows with the frequency"
        raise ModelError(Diagnostic("SF236", message, None, "choose an output with fewer derivatives"))
    if above.degree < below.degree:
        return acb(0)
    return acb(above.enclosure()[above.degree] / below.enclosure()[below.degree])


def _with_series(function: Expanded) -> Expanded | None:
    """Return a function with the series of what its principal parts leave; None if that is not bounded."""
    radius = arb(function.radius)
    terms = [(p.pole, k, c) for p in function.parts for k, c in enumerate(p.coefficients, 1)]

    def left(s: acb, of: Callable[[acb], acb]) -> acb:
        # By the mean value theorem: fractions of a pair nearly cancel, balls of them do not.
        middle = s.mid()
        value = sum((c / (middle - p) ** k for p, k, c in terms), acb(0))
        slope = sum((-k * c / (s - p) ** (k + 1) for p, k, c in terms), acb(0))
        return of(s) - value - slope * (s - middle)

    rim = _on_rim(lambda s: left(s, function.around), radius)
    if rim is None:
        return None
    inner = radius * arb(INNER)
    step = acb(0, 1) * arb.pi() / POINTS  # points between the axes: none is a pole on one
    turns = [(step * (2 * k + 1)).exp() for k in range(POINTS)]
    # The function is real on the real axis: the lower half mirrors the upper.
    values = [left(inner * turn, function.at) for turn in turns[: POINTS // 2]]
    spend()
    if not all(v.is_finite() for v in values):
        return None
    aliased = rim * arb(INNER) ** POINTS / (1 - arb(INNER) ** POINTS)
    powers = [acb(1)] * len(values)
    coefficients, size, limit = [], arb(1), arb(1)
    for _ in range(TERMS):
        total = 2 * sum((v * x for v, x in zip(values, powers, strict=True)), acb(0)).real / POINTS
        coefficients.append(acb(total / size + arb(0, (aliased / limit).upper())))
        powers = [x / turn for x, turn in zip(powers, turns, strict=False)]
        size, limit = size * inner, limit * radius
    return replace(function, regular=tuple(coefficients), rim=rim)


def _on_rim(value: Callable[[acb], acb], radius: arb) -> arb | None:
    """Return the most that a real function is on a circle about 0; None where that is not known."""
    with precision(WIDE_BITS):

        def at(angle: arb) -> acb:
            return value(radius * acb(0, angle).exp())

        seen = [abs(at(arb.pi() * (2 * k + 1) / (2 * ARCS))) for k in range(ARCS)]
        scale = max((size.lower() for size in seen if size.is_finite()), key=float, default=arb(0))

        def size_on(low: float, high: float) -> arb | None:
            on_arc = at(arb(low * pi).union(arb(high * pi)))
            # Balls of wide arcs are finite long before they are of any use.
            return abs(on_arc).upper() if on_arc.is_finite() and on_arc.rad() <= scale * BLURRED else None

        try:
            sizes = [size for *_, size in covered(size_on, ARCS, 1 / MOST_ARCS)]
        except UndecidedError:
            return None
        return max(sizes, key=float)


def static_value(function: Expanded) -> acb:
    """Return the coefficient of ``s^0`` of a function about 0."""
    return acb(0) if function.bound.is_zero else expand_at_zero(function.bound, 0, DIGITS).coefficient(0)
