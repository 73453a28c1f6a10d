"""A frequency response: values of a transfer function on the imaginary axis, and their phase.

Input: a :class:`BoundTransferFunction` and frequencies. Output: a :class:`SampledResponse`.

The phase is known from poles and zeros. G(j omega) = K (j omega)^n prod(1 - j omega/z) / prod(1 - j omega/p):
along omega each factor runs on a ray from 1 that never meets the negative real axis, so the principal value
of its argument is its continuous phase. The exception, a root j b on the axis, is taken as the limit from the
left half-plane: beyond b a zero gives +pi, a pole -pi.

Of a distributed system there are infinitely many poles and zeros to sum over. So the argument is followed
from a small positive s on a quarter circle to the imaginary axis and along it, in steps that are halved until
values and slopes at both ends agree. A root on the axis is passed on its right, which comes to the same.
Without damping G(-s) = G(s) or -G(s), and values on the axis are real or imaginary: between roots the
argument does not turn. If all roots on the axis are known, it is followed to the lowest frequency only.

Grids of frequencies, and the band shown when none is asked for, come from certified poles and zeros too: they
miss no resonance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import ceil, exp, inf, log, pi
from typing import NoReturn

import numpy as np
import numpy.typing as npt
from flint import acb

from symflex.balls import Open, branch
from symflex.errors import Diagnostic, SymflexError, UncertifiedError, UsageError, refused
from symflex.model.loss_factors import check_causal
from symflex.roots import Band, Certificate, Everything, PoleZeroMap, Root
from symflex.roots.counting.winding import Winding, continuous_step
from symflex.roots.functions.entire import Followed, Sample
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.functions.nested_function import NestedFunction
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import locate
from symflex.roots.root import exact_fraction
from symflex.transfer import AnyBoundFunction, BoundNested


def count_turns(
    omega: npt.NDArray[np.float64], values: npt.NDArray[np.complex128], roots: PoleZeroMap
) -> npt.NDArray[np.int64]:
    """Return how many whole turns to add to ``np.angle(values)`` at ``1j*omega``, given all roots."""
    order = _order_at_rest(roots)
    phase = order * np.pi / 2 * np.sign(omega) + _phase_of(roots.zeros, omega) - _phase_of(roots.poles, omega)
    usable = np.isfinite(values) & (values != 0)
    principal = np.angle(np.where(usable, values, 1))
    # With K > 0 the two agree up to whole turns, with K < 0 they are half a turn apart.
    if np.sum(np.cos(phase - principal)[usable]) < 0:
        phase = phase + (np.pi if order < 0 else -np.pi) * np.where(omega < 0, -1, 1)
    return np.rint((phase - principal) / (2 * np.pi)).astype(np.int64)


def _order_at_rest(roots: PoleZeroMap) -> int:
    """Return the power of s that a function begins with at s = 0."""
    integrators = sum(root.multiplicity for root in roots.poles if root.is_zero)
    return sum(root.multiplicity for root in roots.zeros if root.is_zero) - integrators


def _phase_of(roots: Iterable[Root], omega: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the sum of arg(1 - j omega/root) over the roots other than 0, in the limit convention above."""
    total = np.zeros_like(omega)
    for root in roots:
        if root.is_zero:
            continue
        re = -0.0 if root.on_imaginary_axis else float(root.re.mid())
        exact = exact_fraction(root.im)
        im = float(exact)
        rounding = float(exact - Fraction(im))
        # Close to the root im - omega is exact in double precision, and rest holds the digits im lost.
        total += root.multiplicity * np.arctan2(-omega * re, re * re + im * ((im - omega) + rounding))
    return total


LONGEST_STEP = 0.1
SMALLEST_STEP = 1e-9  # smallest step in ln(s): if a ball along it contains zero, a root lies on the axis
DETOUR = 4.0  # width of the way around a root, in lengths of the step that meets it
STEEPEST = 1e11  # slope of ln G over ln(s) from which on a frequency is as good as a root
SHORTEST_SHARE = 1e-6
ROUNDING = 1e-14  # relative, by which frequencies may leave the band that they were made for

Point = tuple[complex, "Sample"]
Step = tuple[Point, Point]


def follow_phase(
    bound: AnyBoundFunction, omega: npt.NDArray[np.float64], roots: PoleZeroMap | None = None
) -> npt.NDArray[np.float64]:
    """Return the continuous phase [rad] of a distributed system, NaN at a root; SF505 for too many."""
    walk = _Walk(bound)
    turned = None if roots is None or not walk.function.is_even else _turned_by_roots(roots, omega)
    if turned is not None:
        turned += follow_phase(bound, omega[:1])[0]
        if np.isfinite(turned[0]):
            return turned
    phase = np.full(omega.shape, np.nan)
    start = min(walk.start, log(omega[0]) - LONGEST_STEP) if omega.size else walk.start
    here, total = walk.reach_axis(start)
    for i, value in enumerate(omega.tolist()):
        sample = walk.function.at_point(acb(0, value))
        if sample is None:
            continue
        if abs(sample.slope) > STEEPEST:
            phase[i] = total
            continue
        there = (complex(log(value), pi / 2), sample)
        total += walk.along(here, there)
        here, phase[i] = there, total
    return phase


def _turned_by_roots(roots: PoleZeroMap, omega: npt.NDArray[np.float64]) -> npt.NDArray[np.float64] | None:
    """Return how far an undamped argument turns from the first frequency; ``None`` if roots may lack."""
    region, certificate = roots.region, roots.certificate
    if not (isinstance(region, Band) and certificate.certified and omega.size) or roots.excluded:
        return None
    # A band ends where its frequencies do, but for the rounding of 2 pi.
    low, high = (2 * pi * float(end) for end in (region.low, region.high))
    if not (low <= omega[0] * (1 + ROUNDING) and omega[-1] <= high * (1 + ROUNDING)):
        return None
    turned = np.zeros(omega.shape)
    for group, turn in ((roots.zeros, pi), (roots.poles, -pi)):
        for root in group:
            if root.on_imaginary_axis and root.im > 0:
                at = float(root.im.mid())
                turned += turn * root.multiplicity * ((omega > at) & (omega[0] < at))
    return turned


class _Walk:
    """Follows the argument of one function."""

    def __init__(self, bound: AnyBoundFunction) -> None:
        self._name = bound.name
        if not bound.is_reduced:
            self.function: Followed = NestedFunction(bound)
            sides: list[Followed] = [self.function]
        else:
            self.function = KernelFunction(bound, bound.ratio)
            sides = [KernelFunction(bound, part) for part in (bound.num, bound.den)]
        self.start = min(Winding(f).smallest(pi / 2 if f.is_even else pi) for f in sides)
        """ln of a radius below the lowest pole and zero."""
        self._winding = Winding(self.function)

    def reach_axis(self, start: float) -> tuple[Point, float]:
        """Return a point low on the axis, and the phase there."""
        first = self._winding.sample(complex(start, 0.0))
        phase = 0.0
        if (round(first.log.imag / pi) % 2 == 1) != self.function.is_negated:
            phase = pi if round(first.slope.real) < 0 else -pi
        end = complex(start, pi / 2)
        return (end, self._winding.sample(end)), phase + self._winding.turn(complex(start, 0.0), end)

    def along(self, here: Point, there: Point) -> float:
        """Return the change of the argument from one point of the axis to another."""
        highest = max(there[0].real, here[0].real)
        length = min(LONGEST_STEP, 0.5 / max(self._winding.reach(highest), 1.0))
        count = max(1, ceil(abs(there[0] - here[0]) / length))
        between = [here[0] + (there[0] - here[0]) * i / count for i in range(1, count)]
        points = [here, *self._clear(between), there]
        return sum(self._divided(ends, SMALLEST_STEP, self._around) for ends in pairwise(points))

    def _divided(
        self, points: Sequence[Point], shortest: float, past: Callable[[Point, Point], float]
    ) -> float:
        """Return the change along a path, divided until no step is ambiguous; ``past`` takes the shortest."""

        def change(step: Step) -> float | Open[Step]:
            a, b = step
            change = continuous_step(a[1], b[1], b[0] - a[0])
            return Open(step) if change is None else change

        def halves(step: Step) -> list[Step]:
            a, b = step
            middle = self._clear([(a[0] + b[0]) / 2]) if abs(b[0] - a[0]) > shortest else []
            return [(a, middle[0]), (middle[0], b)] if middle else []

        search = branch(pairwise(points), change, halves)
        return sum(search.decided) + sum(past(*step) for step in search.undecided)

    def _clear(self, points: Sequence[complex]) -> list[Point]:
        """Return the points that are not roots, with their samples."""
        sampled = ((z, self._winding.function.at_logarithm(z)) for z in points)
        return [(z, sample) for z, sample in sampled if sample is not None]

    def _around(self, here: Point, there: Point) -> float:
        """Pass a root on its right."""
        aside = -1j * DETOUR * max(abs(there[0] - here[0]), SMALLEST_STEP)

        def refuse(*_: Point) -> NoReturn:
            hertz = exp(here[0].real) / (2 * pi)
            message = f"the phase of {self._name} cannot be followed past {hertz:g} Hz"
            raise UncertifiedError(Diagnostic("SF404", message))

        points = [here, *self._clear([here[0] + aside, there[0] + aside]), there]
        return self._divided(points, SHORTEST_SHARE * abs(aside), refuse)


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """Values of a transfer function at s = j omega.

    Parameters
    ----------
    tf : str
        ``"OUT/IN"``.
    omega : array of float, shape (n,)
        Angular frequencies [rad/s].
    values : array of complex, shape (n,)
        In ``unit``; ``inf + nan*1j`` at a pole.
    quantity, unit : str
        ``receptance``, ``mobility``, ...; SI unit, empty when unknown.
    turns : array of int, shape (n,), optional
        Whole turns between the principal value of the phase and the phase, which
        :func:`respond` knows from the poles and zeros. Without them, as for measured
        values, :attr:`phase` is unwrapped
        from point to point, which is right only on a grid fine enough.

    Notes
    -----
    The arrays are copied and read-only.

    Examples
    --------
    >>> response = SampledResponse("x/F", [1.0, 10.0], [1.0, -0.01], "receptance", "m/N")
    >>> response.magnitude_db.tolist()
    [0.0, -40.0]
    """

    tf: str
    omega: npt.NDArray[np.float64]
    values: npt.NDArray[np.complex128]
    quantity: str
    unit: str
    turns: npt.NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        shapes = set()
        for name, kind in (("omega", np.float64), ("values", np.complex128), ("turns", np.int64)):
            if getattr(self, name) is not None:
                array = np.array(getattr(self, name), dtype=kind)
                array.setflags(write=False)
                object.__setattr__(self, name, array)
                shapes.add(array.shape)
        if self.omega.ndim != 1 or len(shapes) != 1:
            message = f"a frequency response needs one-dimensional arrays of one length, not {sorted(shapes)}"
            raise ValueError(message)

    @property
    def frequency_hz(self) -> npt.NDArray[np.float64]:
        """``omega / (2 pi)`` [Hz]."""
        return self.omega / (2 * np.pi)

    @property
    def magnitude(self) -> npt.NDArray[np.float64]:
        """Absolute values, in ``unit``."""
        return np.abs(self.values)

    @property
    def magnitude_db(self) -> npt.NDArray[np.float64]:
        """``20 log10`` of the magnitude, in dB relative to one ``unit``; ``-inf`` at a zero."""
        with np.errstate(divide="ignore"):
            return 20 * np.log10(self.magnitude)

    @property
    def phase(self) -> npt.NDArray[np.float64]:
        """The phase [rad], continuous in omega; NaN exactly at a pole or zero on the axis.

        A negative gain counts as a lag of pi, or a lead of pi when poles at s = 0 lag already.
        """
        defined = np.isfinite(self.values) & (self.values != 0)
        principal = np.angle(np.where(defined, self.values, 1))
        if self.turns is None:
            phase = np.full(principal.shape, np.nan)
            phase[defined] = np.unwrap(principal[defined])
            return phase
        return np.where(defined, principal + 2 * np.pi * self.turns, np.nan)


def respond(
    bound: AnyBoundFunction, omega: npt.ArrayLike, roots: PoleZeroMap | None = None
) -> SampledResponse:
    """Evaluate a transfer function on the imaginary axis to double precision.

    Each value is right to the last bits of its absolute value; ``inf + nan*1j`` at a pole. The phase is
    counted from the poles and zeros, for a distributed system followed from s = 0, so it does not depend on
    how fine the grid is. ``roots`` are all poles and zeros, of a distributed system those in the band, when
    they are known already. SF902 unless ``omega`` [rad/s] is real, one-dimensional and finite.

    >>> from symflex.errors import Source
    >>> from symflex.model import load_model
    >>> from symflex.equations import assemble
    >>> from symflex.transfer import bind, derive
    >>> text = '''
    ... symflex = 1
    ... elements.load = { type = "mass", at = "x", m = "2 kg" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... '''
    >>> inertia = bind(derive(assemble(load_model(Source("mass.toml", text))), "X", "F"))
    >>> response = respond(inertia, [0.5, 1.0])
    >>> response.values.real.tolist(), np.degrees(response.phase).tolist(), response.unit
    ([-2.0, -0.5], [-180.0, -180.0], 'm/N')
    """
    grid = real_numbers(omega, "omega")
    if grid.ndim != 1 or not np.isfinite(grid).all():
        raise refused("omega must be a one-dimensional array of finite numbers")
    settled = without_lengths_of_zero(bound) if bound.is_reduced else bound
    if settled is not bound:
        bound, roots = settled, None
    quantity, unit = bound.source.quantity, bound.source.unit
    if bound.is_zero:
        return SampledResponse(bound.name, grid, np.zeros(grid.shape, np.complex128), quantity, unit)
    if bound.source.model.imaginary:
        if not (grid > 0).all():
            check_causal(bound.source.model, "a response at omega <= 0")
        return SampledResponse(bound.name, grid, evaluate(bound, grid), quantity, unit)
    values = evaluate(bound, grid)
    of_network = None if bound.is_reduced else _network_turns(bound, grid, values)
    if of_network is not None:
        turns = of_network
    elif not bound.is_rational:
        turns = _follow_turns(bound, grid, values, roots)
    else:
        turns = count_turns(grid, values, locate(bound) if roots is None else roots)
    return SampledResponse(bound.name, grid, values, quantity, unit, turns)


BEYOND_BAND = (1.5, 1.1)  # of a network's phase, roots up to so many times its end are taken out
TO_REST = 12  # frequencies below the lowest at which that rest is followed to s = 0, over three decades


def _network_turns(
    bound: BoundNested, omega: npt.NDArray[np.float64], values: npt.NDArray[np.complex128]
) -> npt.NDArray[np.int64] | None:
    """Return whole turns that a network's phase lacks, by its roots in a disc; None without these."""
    highest = float(np.max(np.abs(omega), initial=0.0))
    if highest == 0:
        return None
    sought = (Band(Fraction(0), Fraction(share * highest / (2 * pi))) for share in BEYOND_BAND)
    maps = (roots_if_found(bound, band) for band in sought)
    roots = next((roots for roots in maps if roots.certificate.certified), None)
    if roots is None:
        return None
    steps, first, places = np.unique(np.abs(omega), return_index=True, return_inverse=True)
    lowest = float(steps[steps > 0][0])
    below = np.geomspace(lowest / 1000, lowest, TO_REST, endpoint=False)
    path = np.concatenate((below, steps))
    there = np.where(omega < 0, np.conj(values), values)[first]
    there_and_below = np.concatenate((evaluate(bound, below), there))
    order = _order_at_rest(roots)
    phase = order * np.pi / 2 + _phase_of(roots.zeros, path) - _phase_of(roots.poles, path)
    usable = np.isfinite(there_and_below) & (there_and_below != 0) & (path > 0)
    remainder = np.angle(np.where(usable, there_and_below, 1) * np.exp(-1j * phase))
    remainder[usable] = np.unwrap(remainder[usable])
    start = remainder[usable][0]
    if np.cos(start) < 0:
        remainder += (np.pi if order < 0 else -np.pi) - start
    return _turns_to(np.where(usable, phase + remainder, np.nan)[len(below) :][places], omega, values)


def _follow_turns(
    bound: AnyBoundFunction,
    omega: npt.NDArray[np.float64],
    values: npt.NDArray[np.complex128],
    roots: PoleZeroMap | None,
) -> npt.NDArray[np.int64]:
    """Return the whole turns that the principal values of a distributed system's phase lack."""
    steps, places = np.unique(np.abs(omega), return_inverse=True)
    phase = np.zeros(steps.shape)
    moving = steps > 0
    phase[moving] = follow_phase(bound, steps[moving], roots)
    return _turns_to(phase[places], omega, values)


def _turns_to(
    phase: npt.NDArray[np.float64], omega: npt.NDArray[np.float64], values: npt.NDArray[np.complex128]
) -> npt.NDArray[np.int64]:
    """Return the whole turns from principal values to the phase at positive frequencies; 0 where none is."""
    usable = np.isfinite(values) & (values != 0)
    principal = np.angle(np.where(usable, values, 1))
    wanted = np.where(omega < 0, -1, 1) * phase
    usable &= np.isfinite(wanted) & (omega != 0)
    turns = np.rint((np.where(usable, wanted, principal) - principal) / (2 * np.pi))
    return turns.astype(np.int64)


def evaluate(bound: AnyBoundFunction, omega: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
    """Return the values at angular frequencies, with more bits where cancellation asks for them."""
    return np.array(bound.each((1j * omega).tolist()), np.complex128)


REFINED_DAMPING = 0.3
AXIS_GAP = 1e-7  # distance kept from poles on the imaginary axis, relative to theirs from 0
PHASE_STEPS = 24
WIDEST_ANGLE = 0.94 * pi / 2
POINTS_PER_DECADE = 6
COARSE_STEPS = 3
DEFAULT_BAND_HZ = (0.1, 10.0)
WITHOUT_ROOTS = ("SF404", "SF505")  # searches that found no roots; all other errors are raised
FOLLOWING_ERROR = 0.02  # of a squared value from its neighbours' product: 0.1 dB, half a degree
FOLLOWING_ROUNDS = 12
MOST_POINTS = 20_000
BEYOND_LAST_POLE = 1.3  # further poles of a distributed system lie just above the last one found


def default_band(*maps: PoleZeroMap) -> tuple[float, float]:
    """Return a band [Hz] that shows all poles and zeros of functions that are to be shown together.

    It goes from a decade below the lowest to a decade above the highest nonzero natural frequency, or less
    where a function would fall by more than 60 dB there, and of a distributed system a little above the
    highest pole found; 0.1 Hz to 10 Hz when there is none. Real roots more than a decade above the highest
    that oscillate do not count.

    >>> from symflex.roots import RootProblem, find_pole_zero_map
    >>> one = RootProblem.from_rationals([1])
    >>> low, high = default_band(find_pole_zero_map("x/F", RootProblem.from_rationals([9, 0, 1]), one))
    >>> print(f"{low * 2 * pi:.3f} {high * 2 * pi:.3f}")
    0.300 30.000
    """
    lows, highs = [], []
    for located in maps:
        moving = [root for root in (*located.poles, *located.zeros) if not root.is_zero]
        far = 10 * max((root.frequency_hz() for root in moving if not root.is_real), default=inf)
        counted = [root for root in moving if root.frequency_hz() <= far]
        if not counted:
            continue
        poles = [root for root in counted if root in located.poles]
        ends = [root.frequency_hz() for root in counted]
        order = _order_at_rest(located)
        lows.append(min(ends) / _room(order))
        if located.is_infinite and poles:
            highs.append(max(root.frequency_hz() for root in poles) * BEYOND_LAST_POLE)
        else:
            slope = order + sum(-r.multiplicity if r in poles else r.multiplicity for r in counted)
            highs.append(max(ends) * _room(slope))
    return (min(lows), max(highs)) if lows else DEFAULT_BAND_HZ


def _room(slope: int) -> float:
    """Return how far to go beyond the last root: a decade, or until a power of s changes by 60 dB."""
    return max(BEYOND_LAST_POLE, 10 ** min(1, 3 / max(1, abs(slope))))


def roots_if_found(
    bound: AnyBoundFunction, band: Band | None = None, judged: PoleZeroMap | None = None
) -> PoleZeroMap:
    """Return the poles and zeros, or as many as can be had: the certificate says why others may lack."""
    region = None if bound.is_rational else band
    try:
        return locate(bound, region, judged=judged)
    except SymflexError as error:
        problem = error.diagnostics[0]
        if problem.code not in WITHOUT_ROOTS:
            raise
        certificate = Certificate("", 0, 0, problem.message, problem.code)
        return PoleZeroMap(bound.name, region or Everything(), (), (), (), certificate, is_infinite=True)


def adaptive_grid(
    bound: AnyBoundFunction,
    low_hz: float,
    high_hz: float,
    points: int = 600,
    roots: PoleZeroMap | None = None,
) -> npt.NDArray[np.float64]:
    """Return angular frequencies [rad/s] on which no peak or trough of a transfer function is missed.

    Around a root -a + j b points advance in equal steps of phase; on the axis they close in up to 1e-7 b.
    Where roots may be missing, points are added until values turn little. SF227, ValueError.
    """
    if roots is None:
        check_band(low_hz, high_hz)
        roots = locate(bound, None if bound.is_rational else Band(Fraction(low_hz), Fraction(high_hz)))
    return grid_about(roots, partial(evaluate, bound), low_hz, high_hz, points)


def grid_about(
    located: PoleZeroMap,
    values: Callable[[npt.NDArray[np.float64]], npt.NDArray[np.complex128]],
    low_hz: float,
    high_hz: float,
    points: int = 600,
) -> npt.NDArray[np.float64]:
    """Return the grid of :func:`adaptive_grid` from roots that are known, and a function of frequencies."""
    check_band(low_hz, high_hz)
    if points < 2:  # noqa: PLR2004 (the two ends)
        raise ValueError(f"a grid has at least 2 points, not {points}")
    low, high = 2 * pi * low_hz, 2 * pi * high_hz
    step = log(high / low) / (points - 1)
    parts = [np.geomspace(low, high, points)]
    on_axis: list[float] = []
    for root in (*located.poles, *located.zeros):
        damping = root.damping_ratio()
        if root.is_real or root.im < 0 or damping is None or abs(damping) > REFINED_DAMPING:
            continue
        width, centre = abs(float(root.re.mid())), float(root.im.mid())
        if root.on_imaginary_axis:
            on_axis.append(centre)
        offsets = _offsets(width, centre, COARSE_STEPS * step * centre)
        parts += [centre - offsets, centre + offsets]
    grid = np.unique(np.concatenate(parts))
    grid = grid[(grid >= low) & (grid <= high)]
    for centre in on_axis:
        # A hair less than the gap, so that the points placed at the gap itself survive rounding.
        grid = grid[np.abs(grid - centre) > 0.99 * AXIS_GAP * centre]
    return _followed(values, grid) if located.certificate.is_exceeded else grid


def real_numbers(given: npt.ArrayLike, name: str, code: str = "SF902") -> npt.NDArray[np.float64]:
    """Return numbers as a new array of doubles; UsageError for others, as complex ones, which numpy cuts."""
    try:
        if not np.iscomplexobj(given):
            return np.atleast_1d(np.array(given, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        pass  # refused like complex numbers
    raise UsageError(Diagnostic(code, f"{name} must be real numbers, found {str(given)[:60]}"))


def check_band(low_hz: float, high_hz: float) -> None:
    """Raise SF227 for a band that is empty or not positive."""
    if not 0 < low_hz < high_hz < inf:
        message = f"a band runs from a positive to a higher frequency, not from {low_hz:g} to {high_hz:g} Hz"
        raise UsageError(Diagnostic("SF227", message))


def _followed(
    values: Callable[[npt.NDArray[np.float64]], npt.NDArray[np.complex128]], grid: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return a grid with points added where a straight line misses the logarithm of the values between."""
    by_frequency = dict(zip(grid.tolist(), values(grid).tolist(), strict=True))
    pending = list(pairwise(grid.tolist()))
    # Whole rounds at once: numpy evaluates arrays, and no proof hangs on these points.
    for _ in range(FOLLOWING_ROUNDS):
        middles = np.array([(a * b) ** 0.5 for a, b in pending])
        between = values(middles).tolist()
        by_frequency.update(zip(middles.tolist(), between, strict=True))
        split = []
        for (a, b), middle, value in zip(pending, middles.tolist(), between, strict=True):
            product = by_frequency[a] * by_frequency[b]
            if not abs(value * value - product) < FOLLOWING_ERROR * abs(product):
                split += [(a, middle), (middle, b)]
        pending = split
        if not pending or len(by_frequency) > MOST_POINTS:
            break
    return np.array(sorted(by_frequency))


def _offsets(width: float, centre: float, reach: float) -> npt.NDArray[np.float64]:
    """Return distances from the centre of a resonance, out to where the coarse grid takes over."""
    if width == 0:
        near, inner = np.empty(0), AXIS_GAP * centre
    else:
        near = width * np.tan(np.linspace(0, WIDEST_ANGLE, PHASE_STEPS))
        inner = float(near[-1])
    if reach <= inner:
        return near
    count = int(POINTS_PER_DECADE * log(reach / inner, 10)) + 2
    return np.concatenate((near, np.geomspace(inner, reach, count)))
