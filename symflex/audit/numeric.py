"""Printed formula and derived function with numbers, in ball arithmetic.

A ball that excludes equality proves a difference; balls that agree prove nothing, and are labelled so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from flint import acb, arb

from symflex.algebra import LAPLACE
from symflex.audit.reading import Formula
from symflex.balls import ball, precision, precisions
from symflex.expressions import Expression
from symflex.model import ExactValue, Model
from symflex.print.forms.zpk import BITS_PER_DIGIT
from symflex.transfer import BoundTransferFunction, TransferFunction, bind
from symflex.transfer.enclose import principal_values
from symflex.transfer.probes import probes_of

POINTS = 40
DIGITS = 50  # printed and derived function agree when they do to so many digits, at so many points
FIRST_BITS = 256
LAST_BITS = 8192
DOUBLE_BITS = 53
GRID_POINTS = 300
REFINEMENTS = 14
STEPS = 12
MOST_PEAKS = 12
UNBOUNDED = 180  # decibels no finite deviation reaches; degrees do not exceed it
NEGLIGIBLE = 1e-9
DEFAULT_BAND = (Fraction(1, 10), Fraction(1000))
_DIRECTIONS = ((4, 3, 5), (3, -4, 5), (12, 5, 13), (5, 12, 13), (15, -8, 17), (8, 15, 17), (24, -7, 25))
"""Pythagorean triples: exact points of the right half-plane, where all roots are the principal ones."""


@dataclass(frozen=True)
class Numbers:
    """Both functions with numbers."""

    bound: BoundTransferFunction  # the derived function
    formula: Formula  # the printed one
    values: Mapping[str, ExactValue]  # of all parameters
    # Those that the model gives no value: used to tell functions apart, not to measure them.
    invented: tuple[tuple[str, ExactValue], ...]
    band: tuple[Fraction, Fraction]  # where they are compared [Hz]
    _enclosed: dict[int, Callable[[acb], acb]] = field(default_factory=dict, repr=False, compare=False)

    def derived_at(self, s: acb, bits: int) -> acb:
        """Return the derived function's value on a ball."""
        if bits not in self._enclosed:
            self._enclosed[bits] = self.bound.enclosed(bits)
        with precision(bits):
            return self._enclosed[bits](s)

    def printed_at(self, s: acb, bits: int) -> acb:
        """Return the printed formula's value on a ball."""
        with precision(bits):
            point: dict[str, acb] = {LAPLACE: s, "pi": acb(arb.pi())}
            for name, value in self.values.items():
                point[name] = acb(ball(value.rational) * arb.pi() ** value.pi_power)
            for name, expression in self.formula.lines:
                point[name] = value_of(expression, point)
            return value_of(self.formula.whole, point)

    def ratio_at(self, frequency: float) -> tuple[float, float] | None:
        """Return printed over derived [dB, deg] at a frequency [Hz], ``None`` if it has no value."""
        with precision(FIRST_BITS):
            s = acb(0, arb(frequency) * 2 * arb.pi())
            ratio = self.printed_at(s, FIRST_BITS) / self.derived_at(s, FIRST_BITS)
            if not ratio.is_finite() or ratio.contains(0) or ratio.rel_accuracy_bits() <= DOUBLE_BITS:
                return None
            # In balls, since neither value need be within reach of a double.
            decibels = 20 * abs(ratio).log() / arb(10).log()
            # A ball around a negative number reaches across the cut: its middle does not.
            angle = ratio.mid().arg() * 180 / arb.pi()
            return float(decibels.mid()), float(angle.mid())

    def both_at(self, s: tuple[Fraction, Fraction], digits: int = DIGITS) -> tuple[acb, acb] | None:
        """Return both values to the given digits, ``None`` when they have none there."""
        for bits in precisions(FIRST_BITS, LAST_BITS):
            with precision(bits):
                point = acb(ball(s[0]), ball(s[1]))
            printed, derived = self.printed_at(point, bits), self.derived_at(point, bits)
            if _are_accurate(printed, derived, BITS_PER_DIGIT * digits):
                return printed, derived
        return None


def _are_accurate(printed: acb, derived: acb, bits: int) -> bool:
    """Tell whether both values are known to so many bits of their own or of the derived one."""
    if not (printed.is_finite() and derived.is_finite()) or derived.rel_accuracy_bits() < bits:
        return False
    width = abs(printed - acb(printed.mid())).upper()
    return printed.rel_accuracy_bits() >= bits or bool(width <= abs(derived).lower() * arb(2) ** -bits)


def numbers_of(formula: Formula, tf: TransferFunction, model: Model) -> Numbers:
    """Return both functions with the model's values, and invented ones where it has none."""
    missing = [p for p in model.parameters if p.value is None]
    invented = tuple((p.name, ExactValue(Fraction(7 + 3 * i, 5 + 2 * i))) for i, p in enumerate(missing))
    bound = bind(tf, {name: value.rational for name, value in invented})
    values = {p.name: p.value for p in model.parameters if p.value is not None} | dict(invented)
    return Numbers(bound, formula, values, invented, model.analysis.band or DEFAULT_BAND)


def comparison_points(band: tuple[Fraction, Fraction]) -> tuple[tuple[Fraction, Fraction], ...]:
    """Return the complex frequencies [rad/s] at which functions are compared."""
    low, high = float(band[0]) * 6.3, float(band[1]) * 6.3
    points = []
    for i in range(POINTS):
        radius = Fraction(f"{low * (high / low) ** (i / (POINTS - 1)):.3g}")
        # On the positive real axis no root has two readings, so these come first.
        re, im, over = (1, 0, 1) if i % 4 == 0 else _DIRECTIONS[i % len(_DIRECTIONS)]
        points.append((radius * re / over, radius * im / over))
    return tuple(sorted(points, key=lambda s: s[1] != 0))


@dataclass(frozen=True, slots=True)
class Comparison:
    """What the points say."""

    differs: bool  # proved by a ball that excludes equality
    agreed: int  # points at which they agree to 50 digits
    point: tuple[Fraction, Fraction] | None = None  # where they differ [rad/s]
    # printed and derived: values there.
    printed: complex | None = None
    derived: complex | None = None
    gap: float = 0.0  # their distance there over the size of the derived one
    # All parameters, where formulas agree with the declared values and differ with these.
    values: tuple[tuple[str, ExactValue], ...] = ()


def compare(numbers: Numbers) -> Comparison:
    """Compare both functions at the test points."""
    agreed = 0
    for s in comparison_points(numbers.band):
        values = numbers.both_at(s)
        if values is None:
            continue
        printed, derived = values
        with precision(LAST_BITS):
            gap = printed - derived
            if not gap.contains(0):
                size = float((abs(gap) / abs(derived)).mid()) if derived != 0 else 1.0
                return Comparison(True, agreed, s, complex(printed), complex(derived), size)
            small = abs(gap).upper() <= abs(derived).lower() * arb(10) ** -DIGITS or (
                printed == 0 and derived == 0
            )
        agreed += bool(small)
    return Comparison(False, agreed)


def compare_anywhere(numbers: Numbers, tf: TransferFunction) -> Comparison:
    """Compare both functions, also with other values than the declared ones: 1 kg hides a factor."""
    comparison = compare(numbers)
    for setting in (
        () if comparison.differs else dict.fromkeys(setting for setting, _ in probes_of(tf).points)
    ):
        bound = bind(tf, {name: v.rational for name, v in setting.values.items() if not v.pi_power})
        other = compare(replace(numbers, bound=bound, values=setting.values, _enclosed={}))
        if other.differs:
            return replace(other, values=tuple(setting.values.items()))
    return comparison


def value_of(expression: Expression, known: Mapping[str, acb]) -> acb:
    """Return the principal value of an expression on balls; not finite where it divides by zero."""
    return principal_values(expression, 1, lambda name: [known[name]])[0]


@dataclass(frozen=True, slots=True)
class Deviation:
    """Largest deviations of the printed from the derived frequency response."""

    # magnitude_db and magnitude_hz: printed over derived in dB, and where.
    magnitude_db: float
    magnitude_hz: float
    # The magnitude grows without end there: one of the functions has a zero or pole the other lacks.
    unbounded: bool
    # phase_deg and phase_hz: printed minus derived, between -180 and 180, and where.
    phase_deg: float
    phase_hz: float
    band: tuple[Fraction, Fraction]  # searched [Hz]


def largest_deviation(numbers: Numbers) -> Deviation | None:
    """Return the largest deviations on a grid, each refined around where it is found."""
    low, high = float(numbers.band[0]), float(numbers.band[1])
    grid = [low * (high / low) ** (i / (GRID_POINTS - 1)) for i in range(GRID_POINTS)]
    grid[-1] = high
    values = [numbers.ratio_at(frequency) for frequency in grid]
    magnitude = _largest(numbers, grid, values, 0)
    angle = _largest(numbers, grid, values, 1)
    if magnitude is None and angle is None:
        return None
    magnitude, angle = magnitude or (0.0, grid[0]), angle or (0.0, grid[0])
    unbounded = abs(magnitude[0]) > UNBOUNDED
    return Deviation(magnitude[0], magnitude[1], unbounded, angle[0], angle[1], numbers.band)


def _largest(
    numbers: Numbers, grid: Sequence[float], values: Sequence[tuple[float, float] | None], which: int
) -> tuple[float, float] | None:
    """Return the largest magnitude (0) or angle (1), or the first without bound, and where it is."""
    sizes = [0.0 if z is None else abs(z[which]) for z in values]
    last = len(grid) - 1
    beside = zip([-1.0, *sizes], sizes, [*sizes[1:], -1.0], strict=False)
    peaks = [i for i, (below, size, above) in enumerate(beside) if size > 0 and below < size >= above]
    highest = sorted(sorted(peaks, key=lambda i: -sizes[i])[:MOST_PEAKS])
    best: tuple[float, float] | None = None
    for i in highest:
        refined = _refined(numbers, (grid[max(i - 1, 0)], grid[i], grid[min(i + 1, last)]), which)
        if refined is not None and (best is None or abs(refined[0]) > abs(best[0]) + NEGLIGIBLE):
            best = refined
        if best is not None and abs(best[0]) > UNBOUNDED:
            break
    return best


def _refined(numbers: Numbers, bracket: tuple[float, float, float], which: int) -> tuple[float, float] | None:
    left, middle, right = bracket
    best: tuple[float, float] | None = None
    for _ in range(REFINEMENTS):
        grid = sorted({middle, *(left + (right - left) * k / STEPS for k in range(STEPS + 1))})
        measured = [(z[which], f) for f in grid if (z := numbers.ratio_at(f)) is not None]
        if not measured:
            return best
        best = max(measured, key=lambda m: abs(m[0]))
        i = grid.index(best[1])
        left, middle, right = grid[max(i - 1, 0)], best[1], grid[min(i + 1, len(grid) - 1)]
    return best
