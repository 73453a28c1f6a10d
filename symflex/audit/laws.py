"""Laws every right formula obeys, and which of them a printed one violates.

The poles of a transfer function are those of the system; a function's behaviour as s tends to zero is the
static gain or the rigid-body motion; an undamped system answers in phase or in quadrature; where input and
output are colocated, zeros and poles alternate on the imaginary axis (Foster 1924) and none is double.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import pi, prod
from typing import Literal

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored
from symflex.audit.factors import LowestTerms, behaviour_at_zero, full_angles, lowest_terms
from symflex.audit.notation import factor_expression, monomial_expression, polynomial_expression
from symflex.audit.numeric import Numbers
from symflex.audit.reading import FormulaReading
from symflex.balls import precision
from symflex.expressions import Expression, format_expression, quotient

How = Literal["proved", "measured"]
AXIS_POINTS = 800  # frequencies at which signs are compared, evenly spaced in their logarithm
AXIS_BITS = 256
HALVINGS = 30  # bisections of a step, until it is a thousand millionth of itself
LONGEST_TEXT = 80  # characters of a factor that is shown
PROBES = 5  # frequencies at which the phase of an undamped system is looked at


@dataclass(frozen=True, slots=True)
class LawCheck:
    """One law, and whether the printed formula keeps it."""

    law: str  # ``poles``, ``double zeros``, ``limit at zero``, ``lossless phase``, ``interlacing``
    kept: bool  # whether the printed formula keeps it
    how: How  # ``proved`` or ``measured``
    detail: str  # in words


def check_laws(reading: FormulaReading | None, numbers: Numbers | None) -> tuple[LawCheck, ...]:
    """Return every law that could be checked, exactly with the reading or with numbers."""
    checks: list[LawCheck | None] = []
    if reading is not None:
        printed, derived = (lowest_terms(reading.field, v) for v in (reading.printed, reading.derived))
        if printed is not None and derived is not None:
            checks += [_poles(reading, printed, derived), _double_zeros(reading, printed, derived)]
        checks.append(_limit(reading))
    if numbers is not None:
        checks += [_phase(numbers), _interlacing(numbers)]
    return tuple(check for check in checks if check is not None)


def _poles(reading: FormulaReading, printed: LowestTerms, derived: LowestTerms) -> LawCheck:
    extra = _without(printed.poles, derived.poles)
    missing = _without(derived.poles, printed.poles)
    wrong = (
        ("it has poles that the system does not have", printed, extra),
        ("poles of the system are missing", derived, missing),
    )
    differing = [(said, _shown(reading, terms, factors)) for said, terms, factors in wrong if factors]
    if not differing:
        return LawCheck("poles", True, "proved", "the denominators vanish at the same s, equally often")
    parts = [f"{said}, where {text} = 0" if text else said for said, text in differing]
    return LawCheck("poles", False, "proved", "; ".join(parts))


def _double_zeros(reading: FormulaReading, printed: LowestTerms, derived: LowestTerms) -> LawCheck:
    double = [(f, e) for f, e in printed.zeros if e > 1 and (f, e) not in derived.zeros]
    shown = [(_shown(reading, printed, [(f, 1)]), e) for f, e in double]
    texts = [f"({text})^{e}" if text else f"one of multiplicity {e}" for text, e in shown]
    detail = "the numerator has no repeated factor the derived one lacks"
    detail = f"the numerator has a repeated factor, {' and '.join(texts)}" if double else detail
    return LawCheck("double zeros", not double, "proved", detail)


def _without(
    left: Sequence[tuple[fmpz_mpoly, int]], right: Sequence[tuple[fmpz_mpoly, int]]
) -> list[tuple[fmpz_mpoly, int]]:
    others = [next((e for f, e in right if f == factor), 0) for factor, _ in left]
    return [(f, times - other) for (f, times), other in zip(left, others, strict=True) if times > other]


def _shown(reading: FormulaReading, terms: LowestTerms, factors: Sequence[tuple[fmpz_mpoly, int]]) -> str:
    """Return a product of factors in the printed symbols, up to one without zeros; nothing if long."""
    product = prod((factor**times for factor, times in factors), start=terms.ring.constant(1))
    value = full_angles(reading.field, terms.ring, product)
    expression = None if value is None else factor_expression(reading, value)
    text = "" if expression is None else format_expression(expression)
    return text if len(text) <= LONGEST_TEXT else ""


def _limit(reading: FormulaReading) -> LawCheck | None:
    leading = behaviour_at_zero(reading.field, reading.printed / reading.derived)
    if leading is None:
        return None
    coefficient, order = leading
    law = "limit at zero"
    if order == 0 and reading.field.equal(coefficient, reading.field.number(1)):
        return LawCheck(law, True, "proved", "printed/derived tends to 1 as s tends to 0")
    power = int(order * reading.field.ground.order)
    varying = coefficient * Factored.generator(reading.field.ring, LAPLACE) ** power
    behaviour = _expression_of(reading, varying)
    shown = "" if behaviour is None else format_expression(behaviour)
    how = f"behaves as {shown}" if 0 < len(shown) <= LONGEST_TEXT else "does not tend to 1"
    return LawCheck(law, False, "proved", f"printed/derived {how} as s tends to 0")


def _expression_of(reading: FormulaReading, value: Factored) -> Expression | None:
    monomial = monomial_expression(reading.field, value)
    if monomial is not None:
        return monomial
    above = polynomial_expression(reading.field, value.numerator())
    below = polynomial_expression(reading.field, value.denominator())
    return None if above is None or below is None else quotient(above, below)


def _phase(numbers: Numbers) -> LawCheck | None:
    """Check that an undamped system's printed answer is in phase or in quadrature."""
    low, high = (2 * pi * float(limit) for limit in numbers.band)
    for i in range(PROBES):
        omega = Fraction(f"{low * (high / low) ** ((i + 0.5) / PROBES):.3g}")
        values = numbers.both_at((Fraction(0), omega))
        if values is None:
            return None
        printed, derived = values
        with precision(AXIS_BITS):
            if not (_is_quadrature(derived) or _is_in_phase(derived)):
                return None
            if not (printed.real.contains(0) or printed.imag.contains(0) or _is_axial(printed)):
                angle = float((printed.log().imag * 180 / arb.pi()).mid())
                detail = (
                    "an undamped system answers in phase or in quadrature; the printed formula has a phase "
                    f"of {angle:.4g} deg at {float(omega):g} rad/s"
                )
                return LawCheck("lossless phase", False, "proved", detail)
    return LawCheck("lossless phase", True, "measured", f"in phase or in quadrature at {PROBES} frequencies")


def _is_axial(value: acb) -> bool:
    return _is_in_phase(value) or _is_quadrature(value)


def _is_in_phase(value: acb) -> bool:
    return bool(abs(value.imag).upper() < abs(value.real).lower() * arb(2) ** -100)


def _is_quadrature(value: acb) -> bool:
    return bool(abs(value.real).upper() < abs(value.imag).lower() * arb(2) ** -100)


_Event = tuple[Literal["pole", "zero"], float]  # what lies where [Hz] on the imaginary axis


@dataclass(frozen=True, slots=True)
class _Value:
    """A real or imaginary value: its sign and the logarithm of its size."""

    frequency: float
    is_positive: bool
    size: float


def _interlacing(numbers: Numbers) -> LawCheck | None:
    """Check that poles and zeros alternate on the imaginary axis where those of the derived function do."""
    derived = _events(numbers.derived_at, numbers.band)
    if derived is None or not _alternate(derived) or len(derived) < 3:  # noqa: PLR2004
        return None
    law, printed = "interlacing", _events(numbers.printed_at, numbers.band)
    if printed is not None and _alternate(printed):
        return LawCheck(law, True, "measured", "zeros and poles alternate on the j omega axis over the band")
    zeros = [frequency for kind, frequency in derived if kind == "zero"]
    right = (
        "colocated zeros and poles alternate on the j omega axis; "
        f"{_zeros(derived)} of the derived function in the band, the first at {zeros[0]:.4g} Hz"
    )
    wrong = "the printed one is complex there and does not change sign"
    if printed is not None:
        wrong = f"{_zeros(printed)} of the printed one, which do not alternate with the poles"
    return LawCheck(law, False, "measured", f"{right}; {wrong}")


def _zeros(events: Sequence[_Event]) -> str:
    count = sum(kind == "zero" for kind, _ in events)
    return "1 zero" if count == 1 else f"{count} zeros"


def _alternate(events: Sequence[_Event]) -> bool:
    return all(a != b for (a, _), (b, _) in pairwise(events))


def _events(function: Callable[[acb, int], acb], band: tuple[Fraction, Fraction]) -> list[_Event] | None:
    """Return sign changes of an undamped function on the imaginary axis, ``None`` if it is not undamped."""
    low, high = float(band[0]), float(band[1])
    grid = [low * (high / low) ** (i / (AXIS_POINTS - 1)) for i in range(AXIS_POINTS)]
    component: str | None = None

    def at(frequency: float) -> _Value | None:
        nonlocal component
        with precision(AXIS_BITS):
            value = function(acb(0, arb(frequency) * 2 * arb.pi()), AXIS_BITS)
            if not value.is_finite():
                return None
            if component is None:
                component = "real" if _is_in_phase(value) else "imag" if _is_quadrature(value) else ""
            if not component or not _is_axial(value):
                return None
            part = value.real if component == "real" else value.imag
            if part.contains(0):
                return None
            return _Value(frequency, bool(part > 0), float(abs(part).log().mid()))

    values = [at(frequency) for frequency in grid]
    events = []
    for left, right in pairwise(values):
        if left is None or right is None:
            return None
        if left.is_positive != right.is_positive:
            events.append(_settled(at, left, right))
    return events


def _settled(at: Callable[[float], _Value | None], left: _Value, right: _Value) -> _Event:
    """Return whether a sign change is a zero or a pole, by bisection."""
    start = min(left.size, right.size)
    for _ in range(HALVINGS):
        middle = at((left.frequency + right.frequency) / 2)
        if middle is None:
            break
        left, right = (middle, right) if middle.is_positive == left.is_positive else (left, middle)
    return "zero" if min(left.size, right.size) < start else "pole", left.frequency
