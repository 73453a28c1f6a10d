"""Beyond which frequency no root lies in the right half plane: one term outweighs all others.

In a sector of the closed right half plane every wavenumber goes like a power of s, times a factor close to
its limit. So do the amplitudes of a sum of exponentials, and the exponents. Where at ``abs(s) = R`` one term
is larger than all others together, and every quotient of another term to it falls with growing ``abs(s)``,
there is no root beyond R in this sector. For dead time in the lower powers of s alone this is Cauchy's bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.kernels import LAPLACE, Ring, degree_in
from symflex.roots import precision
from symflex.transfer import coefficients_in_s

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.kernels import Dispersion, Factored
    from symflex.roots.exponential_sum import Amplitude, ExponentialValues
    from symflex.stability.loop_function import LoopFunction, Powers

BITS = 64
SECTORS = 48
ATTEMPTS = 60
GROWTH = 4.0
ROOTS = {"wave": 2, "bending": 4}


@dataclass(frozen=True, slots=True)
class _Power:
    """``abs(s)^power`` times a factor of size and direction ``unit``, in one sector.

    A delay's exponent never grows in the right half plane, which rounding at a right angle would hide.
    """

    power: Fraction
    unit: acb
    is_delay: bool = False


def radius_without_roots(function: LoopFunction, gain: acb, start: float) -> float | None:
    """Return a radius beyond which ``A + K B`` has no root with ``Re(s) >= 0``.

    Parameters
    ----------
    function : LoopFunction
        A and B.
    gain : acb
        A ball of values of K; complex ones too.
    start : float
        The smallest radius tried [rad/s].

    Returns
    -------
    float or None
        ``None`` where no one term outweighs the others, as in lossless structures, whose poles lie along the
        axis without end, or where wavenumbers have no formula.
    """
    if function.sums is None or any(law.kind not in (*ROOTS, "exponential") for law in _laws(function)):
        return None
    radius = start
    with precision(BITS):
        for _ in range(ATTEMPTS):
            if all(_is_free(function, gain, radius, i) for i in (SECTORS - 1, 0, *range(1, SECTORS - 1))):
                return radius
            radius *= GROWTH
    return None


def _laws(function: LoopFunction) -> tuple[Dispersion, ...]:
    return function.bound.kernels.dispersions


def _is_free(function: LoopFunction, gain: acb, radius: float, sector: int) -> bool:
    """Tell whether there is no root beyond a radius in one sector of the first quadrant."""
    _, sums = function.evaluator(BITS)
    if sums is None:
        return False
    step = arb.pi() / (2 * SECTORS)
    angle = (step * sector).union(step * (sector + 1))
    rates = _rates(function, sums, radius, angle)
    if rates is None:
        return False
    named, arguments = rates
    terms: dict[Powers, dict[Fraction, acb]] = {}
    for number, scale in ((0, acb(1)), (1, gain)):
        for term, amplitude in zip(sums.sums[number][0].terms, sums.coefficients[number], strict=True):
            own = terms.setdefault(term.powers, {})
            for power, unit in _amplitude(amplitude, named).items():
                own[power] = own.get(power, acb(0)) + scale * unit
    return _is_dominated(terms, arguments, arb(radius))


def _rates(
    function: LoopFunction, sums: ExponentialValues, radius: float, angle: arb
) -> tuple[dict[str, _Power], list[_Power]] | None:
    """Return s and the wavenumbers, and the arguments of the exponentials, as powers of abs(s)."""
    turn = acb(0, angle)
    named = {LAPLACE: _Power(Fraction(1), turn.exp())}
    for law in _laws(function):
        if not law.wavenumbers:
            continue
        order = ROOTS[law.kind]
        found = _at_infinity(function, law.characteristic[0], radius)
        if found is None:
            return None
        power, value = found
        value = -value if law.kind == "wave" else value / 4
        # Any branch serves, as long as it is the same on the whole sector.
        start = acb(0)
        if not value.real > 0:
            value, start = -value, acb(0, arb.pi() / order)
        if not value.real > 0:
            return None
        exponent = Fraction(power, order)
        unit = (value.log() / order + start + turn * _ratio(exponent)).exp()
        named[law.wavenumbers[0]] = _Power(exponent, unit)
    arguments = []
    for argument, length in zip(sums.arguments, sums.lengths, strict=True):
        if argument.wavenumber:
            known = named[argument.wavenumber]
            arguments.append(_Power(known.power, known.unit * length))
            continue
        found = _at_infinity(function, argument.rate, radius)
        if found is None:
            return None
        power, value = found
        is_delay = power == 1 and bool(value.imag == 0) and bool(value.real * length.real > 0)
        arguments.append(_Power(Fraction(power), -value * length * (turn * power).exp(), is_delay))
    return named, arguments


def _ratio(value: Fraction) -> arb:
    return arb(value.numerator) / value.denominator


def _at_infinity(function: LoopFunction, value: Factored, radius: float) -> tuple[int, acb] | None:
    """Return a power of s, and a ball around what a rational function of s is times it, beyond a radius."""
    kernels, _ = function.evaluator(BITS)
    small = acb(arb(0, 1 / radius), arb(0, 1 / radius))
    power = 0
    total = acb(arb(value.unit.numerator) / value.unit.denominator)
    names = kernels.names
    constants = Ring(tuple(names[1:]))
    for factor, exponent in value.factors:
        if any(degree_in(factor, names.index(n)) for n in kernels.table.generators):
            return None
        found = acb(0)
        for coefficient in coefficients_in_s(factor, constants):
            found = found * small + _constant(coefficient, names[1:], kernels.constants)
        if found.contains(0):
            return None
        power += degree_in(factor, 0) * exponent
        total = total * found**exponent
    return power, total


def _constant(polynomial: fmpz_mpoly, names: Sequence[str], values: Mapping[str, arb]) -> acb:
    total = acb(0)
    for monomial, integer in polynomial.terms():
        term = acb(int(integer))
        for name, exponent in zip(names, monomial, strict=True):
            if exponent:
                term = term * acb(values[name]) ** int(exponent)
        total = total + term
    return total


def _amplitude(amplitude: Amplitude, named: dict[str, _Power]) -> dict[Fraction, acb]:
    """Return an amplitude as powers of abs(s) with the sizes of their coefficients."""
    found: dict[Fraction, acb] = {}
    for number, powers in amplitude:
        power, unit = Fraction(0), number
        for name, exponent in powers:
            power += named[name].power * exponent
            unit = unit * named[name].unit ** exponent
        found[power] = found.get(power, acb(0)) + unit
    return found


def _is_dominated(terms: dict[Powers, dict[Fraction, acb]], arguments: list[_Power], radius: arb) -> bool:
    """Tell whether one term is larger than all others from a radius on."""

    def growth(powers: Powers) -> arb:
        total = arb(0)
        for i, a, b in powers:
            own = arguments[i]
            total += (own.unit * acb(a, b)).real.mid() * radius ** _ratio(own.power)
        return total.mid()

    def size(powers: Powers) -> float:
        weight = sum((abs(c).mid() * radius ** _ratio(p) for p, c in terms[powers].items()), arb(0)).mid()
        return float((growth(powers) + weight.log()).mid()) if weight > 0 else float("-inf")

    chosen = max(terms, key=size)
    own = {p: c for p, c in terms[chosen].items() if abs(c).upper() > 0}
    highest = max(own, default=None)
    if highest is None:
        return False
    lead = abs(own[highest]).lower()
    for power, coefficient in own.items():
        if power != highest:
            lead -= (abs(coefficient) * radius ** _ratio(power - highest)).upper()
    if not lead > 0:
        return False
    total = arb(0)
    base = {i: complex(a, b) for i, a, b in chosen}
    for powers, amplitude in terms.items():
        if powers == chosen:
            continue
        difference = {i: -c for i, c in base.items()}
        for i, a, b in powers:
            difference[i] = difference.get(i, 0) + complex(a, b)
        decay: list[tuple[Fraction, arb]] = []
        for i, c in difference.items():
            if not c:
                continue
            rate = (arguments[i].unit * acb(c.real, c.imag)).real.upper()
            if rate > 0:
                if not (arguments[i].is_delay and c.imag == 0 and c.real > 0):
                    return False
                rate = arb(0)
            decay.append((arguments[i].power, -rate))
        for power, coefficient in amplitude.items():
            over = power - highest
            exponent = sum((rate * radius ** _ratio(e) for e, rate in decay), arb(0))
            slope = sum((rate * _ratio(e) * radius ** _ratio(e) for e, rate in decay), arb(0))
            if over > 0 and not slope > _ratio(over):
                return False
            total += abs(coefficient).upper() * radius ** _ratio(over) * (-exponent).exp()
    return bool(total < lead)
