"""Difference equations for a computer that takes one step at every sample, and what their rounding costs.

Input: a sampled transfer function.
Output: a :class:`DifferenceEquation` in doubles; :mod:`symflex.codegen.sampled` writes it as code.

    (z + 0.5)/((z - 1) (z - 0.8))    is one section of second order; in every step

    y = w[0]
    w[0] = x + 1.8 * y + w[1]        states are sums of what earlier steps leave for later ones
    w[1] = 0.5 * x - 0.8 * y         (the transposed direct form II)

Sections follow one another, each with a pole or two and the zeros next to them: so these keep their digits,
which coefficients of high degree lose. In direct form there is one section of all poles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context
from itertools import pairwise
from math import inf, isfinite, pi
from sys import float_info

from flint import acb, arb

from symflex.analysis.sampling import SampledTransferFunction, monic
from symflex.balls import precision
from symflex.errors import Diagnostic, ModelError

SAMPLES, FREQUENCIES = 1000, 200
"""Samples of the runs from rest whose rounding is bounded, and frequencies at which responses are compared,
over four decades up to half of the sampling frequency."""
MEASURE_BITS = 600  # precision of runs that count as exact: close poles cost a few hundred bits
UNIT_ROUNDOFF = 2.0**-53  # largest relative error of one operation in doubles
SECOND_ORDER = 1.01  # covers products of rounding errors, which are far smaller than their sum
LARGE = 1e-9  # relative error from which the user is warned: the best converters, of 24 bits, resolve 6e-8
SMALLEST = float_info.min / float_info.epsilon  # share of the largest coefficient that is below its rounding
PAIR = 2  # poles of a section of second order, and zeros


@dataclass(frozen=True, slots=True)
class FilterSection:
    """``y[k] = sum(above[i] x[k-i]) - sum(below[i] y[k-1-i])``; with as many past values on both sides."""

    above: tuple[float, ...]
    below: tuple[float, ...]

    def step(self, x: float, w: list[float], first: int) -> float:
        """Do one step in doubles, with the states from number ``first`` on."""
        count = len(self.below)
        y = self.above[0] * x + (w[first] if count else 0.0)
        for i, (b, a) in enumerate(zip(self.above[1:], self.below, strict=True)):
            more = w[first + i + 1] if i + 1 < count else 0.0
            w[first + i] = b * x - a * y + more
        return y

    def filtered(self, x: Sequence[arb]) -> list[arb]:
        """Return the output of a run from rest, without rounding to doubles."""
        above, below = ([arb(c) for c in side] for side in (self.above, self.below))
        outputs: list[arb] = []
        for k in range(len(x)):
            value = sum((b * x[k - i] for i, b in enumerate(above[: k + 1])), arb(0))
            value -= sum((a * outputs[k - 1 - i] for i, a in enumerate(below[:k])), arb(0))
            outputs.append(value.mid())
        return outputs

    def rounded(self, x: arb, y: arb) -> arb:
        """Return what one step rounds away at most, as at its output, for inputs and outputs so large."""
        parts = [(abs(arb(b)) * x, abs(arb(a)) * y) for b, a in zip(self.above[1:], self.below, strict=True)]
        held = [sum((one + other for one, other in parts[i:]), arb(0)) for i in range(len(parts))]
        # Products by 0 and 1 are exact, and so is a sum of which one term is 0.
        products = [(self.above[0], abs(arb(self.above[0])) * x)]
        products += zip(self.above[1:], (one for one, _ in parts), strict=True)
        products += zip(self.below, (other for _, other in parts), strict=True)
        lost = [size for factor, size in products if abs(factor) not in (0, 1)]
        lost += [y] if held and self.above[0] else []
        lost += [one + other for one, other in parts if one != 0 and other != 0]
        lost += [value for value, more in pairwise(held) if more != 0]
        return sum(lost, arb(0)) * UNIT_ROUNDOFF

    def enclosed(self, z: acb) -> acb:
        """Return the value at z with these coefficients, exactly."""
        above = sum((acb(b) * z**-i for i, b in enumerate(self.above)), acb(0))
        return above / sum((acb(a) * z ** (-i - 1) for i, a in enumerate(self.below)), acb(1))


@dataclass(frozen=True, eq=False)
class DifferenceEquation:
    """Sections that follow one another, after a delay of whole samples."""

    sampled: SampledTransferFunction
    sections: tuple[FilterSection, ...]

    @property
    def order(self) -> int:
        """How many states the sections have."""
        return sum(len(section.below) for section in self.sections)

    def assignments(self, number: Callable[[float], str] = repr) -> list[tuple[str, str]]:
        """Return targets and values of one step, of the input x and states w; x and y are the output then."""

        def total(products: Sequence[tuple[float, str]], names: Sequence[str]) -> str:
            signed = [
                (c < 0, name if abs(c) == 1 else f"{number(abs(c))} * {name}") for c, name in products if c
            ]
            signed += [(False, name) for name in names]
            text = "".join(f" {'-' if minus else '+'} {term}" for minus, term in signed) or " + 0.0"
            return text[3:] if text[1] == "+" else f"-{text[3:]}"

        first, steps = 0, []
        for section in self.sections:
            states = [f"w[{first + i}]" for i in range(len(section.below))]
            steps.append(("y", total([(section.above[0], "x")], states[:1])))
            for i, (b, a) in enumerate(zip(section.above[1:], section.below, strict=True)):
                steps.append((states[i], total([(b, "x"), (-a, "y")], states[i + 1 : i + 2])))
            steps.append(("x", "y"))
            first += len(section.below)
        return steps

    def run(self, u: Sequence[float]) -> list[float]:
        """Return the output in doubles, from rest, as generated code computes it."""
        w, past = [0.0] * self.order, [0.0] * self.sampled.late
        outputs = []
        for k, value in enumerate(u):
            x, first = value, 0
            if past:
                x, past[k % len(past)] = past[k % len(past)], value
            for section in self.sections:
                x = section.step(x, w, first)
                first += len(section.below)
            outputs.append(x)
        return outputs

    def bounds_of_output(self) -> tuple[float, float]:
        """Return how far a run is off at most, and how large it may be, for any input from -1 to 1.

        Both are sums over an impulse response: what is largest comes from the input with its signs. Rounded
        coefficients change that response; what one step of a section rounds away is added to its output
        (Higham 2002, Accuracy and Stability of Numerical Algorithms, section 3.1). Infinite on overflow.
        """
        impulse = [1.0] + [0.0] * (SAMPLES - 1)
        with precision(MEASURE_BITS):
            exact = _exact_run(self.sampled, impulse)
            late = [arb(0)] * self.sampled.late + [arb(value) for value in impulse]
            inputs = [late[:SAMPLES]]
            for section in self.sections:
                inputs.append(section.filtered(inputs[-1]))
            error = sum((abs(x - y) for x, y in zip(exact, inputs[-1], strict=True)), arb(0))
            onwards = [arb(value) for value in impulse]
            for section, *around in reversed(list(zip(self.sections, inputs, inputs[1:], strict=False))):
                taken, given = (sum(map(abs, values), arb(0)) for values in around)
                onwards = FilterSection((1.0,) + (0.0,) * len(section.below), section.below).filtered(onwards)
                error += section.rounded(taken, given) * sum(map(abs, onwards), arb(0))
                onwards = FilterSection(section.above, (0.0,) * len(section.below)).filtered(onwards)
            most = arb(float_info.max)
            bounds = error * SECOND_ORDER, sum(map(abs, exact), arb(0))
            off, largest = (float(x.upper()) if x < most else inf for x in bounds)
            return off, largest

    def error_of_response(self) -> float:
        """Return how far rounding of coefficients takes the frequency response off, over its value."""
        worst = 0.0
        with precision(self.sampled.bits):
            for i in range(FREQUENCIES):
                angle = pi * 0.999 * 10 ** (-4 * i / (FREQUENCIES - 1))
                z = acb(0, angle).exp()
                exact, computed = self.sampled.enclosed(z), z**-self.sampled.late
                for section in self.sections:
                    computed = computed * section.enclosed(z)
                error = float((abs(computed - exact) / abs(exact)).mid()) if exact.is_finite() else 0.0
                worst = max(worst, error) if isfinite(error) else worst
        return worst

    def measured(self) -> tuple[str, str]:
        """Return a sentence on both errors, and a warning, empty unless they are large."""
        (error, largest), response = self.bounds_of_output(), self.error_of_response()
        said = (
            f"For any inputs from -1 to 1, over {SAMPLES} samples from rest, rounding takes the output off "
            f"by at most {_rounded_up(error)}; the output may be as large as {largest:.2g} there. The "
            f"frequency response is off by at most {response:.2g} of its value, measured at {FREQUENCIES} "
            "frequencies below half of the sampling frequency."
        )
        output = error / largest if 0 < largest < inf else error
        name = self.sampled.tf
        if all(c == 0 for c in self.sampled.numerator):
            return said, f"{name} is zero at every sample"
        if max(output, response) <= LARGE:
            return said, ""
        return said, f"{name}: rounding costs {max(output, response):.2g}, more than {LARGE:g}"


def _rounded_up(bound: float) -> str:
    """Return a bound with two digits.

    >>> _rounded_up(4.71e-11), _rounded_up(3.0), _rounded_up(0.0)
    ('4.8e-11', '3', '0')
    """
    return f"{float(Context(prec=2, rounding=ROUND_CEILING).create_decimal_from_float(bound)):.2g}"


def difference_equation(sampled: SampledTransferFunction, *, is_direct: bool = False) -> DifferenceEquation:
    """Return the sections of a sampled transfer function, rounded once; one where ``is_direct``."""
    with precision(sampled.bits):
        order = len(sampled.poles)
        gain = next((c for c in sampled.numerator if c != 0), arb(0))
        roots = (*sampled.poles, *(sampled.zeros or ()))
        are_apart = sampled.zeros is not None and all(z.imag == 0 or not z.imag.contains(0) for z in roots)
        if is_direct or not are_apart or not order or gain == 0:
            above, below = (_doubles(side, sampled.tf) for side in (sampled.numerator, sampled.denominator))
            return DifferenceEquation(sampled, (FilterSection(above, below[1:]),))
        sections = []
        for poles, zeros in _paired(sampled.poles, sampled.zeros or ()):
            _, *back = _doubles(monic(poles), sampled.tf)
            if len(back) == PAIR and any(p == 1 for p in poles):
                # A pole at 1 stays there, as the integrator it is: 1 + a_1 + a_2 = 0 exactly, since the
                # difference of two doubles this close is a double.
                back[1] = -1.0 - back[0]
            scaled = [c * gain for c in monic(zeros)]
            gain = arb(1)
            scaled = [arb(0)] * (len(back) + 1 - len(scaled)) + scaled
            sections.append(FilterSection(_doubles(scaled, sampled.tf), tuple(back)))
        return DifferenceEquation(sampled, tuple(sections))


def _paired(poles: Sequence[acb], zeros: Sequence[acb]) -> list[tuple[list[acb], list[acb]]]:
    """Return poles, those next to the unit circle first, each with the zeros next to them."""
    wide, single = _conjugates(poles)
    pairs, real_zeros = _conjugates(zeros)
    while len(wide) < len(pairs):
        wide.append([single.pop(), single.pop()])
    groups: list[tuple[list[acb], list[acb]]] = [(g, []) for g in (*wide, *([p] for p in single))]
    groups.sort(key=lambda group: abs(1 - float(abs(group[0][0]).mid())))
    for two in pairs:
        free = [group for group in groups if len(group[0]) == PAIR and not group[1]]
        _nearest(free, two[0])[1].extend(two)
    for zero in real_zeros:
        room = [group for group in groups if len(group[1]) < len(group[0])]
        _nearest([g for g in room if not g[1]] or room, zero)[1].append(zero)
    return groups


def _nearest(groups: Sequence[tuple[list[acb], list[acb]]], zero: acb) -> tuple[list[acb], list[acb]]:
    return min(groups, key=lambda group: float(abs(group[0][0] - zero).mid()))


def _conjugates(roots: Sequence[acb]) -> tuple[list[list[acb]], list[acb]]:
    """Return pairs of complex roots, and the real ones."""
    upper = [z for z in roots if z.imag > 0]
    return [[z, z.conjugate()] for z in upper], [z for z in roots if z.imag == 0]


def _exact_run(sampled: SampledTransferFunction, u: Sequence[float]) -> list[arb]:
    """Return what no rounding leaves of the output, by the recursion of the whole polynomials."""
    order = len(sampled.denominator) - 1
    with precision(max(sampled.bits, MEASURE_BITS)):
        above = [c.mid() for c in sampled.numerator]
        below = [c.mid() for c in sampled.denominator[1:]]
        late = [arb(0)] * sampled.late + [arb(v) for v in u[: len(u) - sampled.late]]
        outputs: list[arb] = []
        for k in range(len(u)):
            value = sum((above[i] * late[k - i] for i in range(min(order, k) + 1)), arb(0))
            value -= sum((below[i] * outputs[k - 1 - i] for i in range(min(order, k))), arb(0))
            outputs.append(value.mid())
        return outputs


def _doubles(values: Sequence[arb], name: str) -> tuple[float, ...]:
    """Return the nearest doubles; zero for what is too small for one beside the largest, as exp(-1000) is."""
    doubles = tuple(float(value.mid()) for value in values)
    largest = max(map(abs, doubles))
    if not all(map(isfinite, doubles)) or (any(v != 0 for v in values) and largest < SMALLEST):
        size = "large" if largest > 1 else "small"
        message = f"a coefficient of {name} from sample to sample is too {size} for double precision"
        raise ModelError(Diagnostic("SF233", message, None, "choose other units, or another sampling time"))
    return tuple(0.0 if abs(double) < float_info.min else double for double in doubles)
