"""Functions with kernels far from s = 0: where they have no root, and how large they are.

In a sector of the s plane every wavenumber goes like a power of s, times a factor close to its limit. So do
the amplitudes of a sum of exponentials, and the exponents. Where at ``abs(s) = R`` one term is larger than
all others together, and every quotient of another term to it falls with growing ``abs(s)``, there is no root
beyond R in this sector, and the sum is as large as that term, up to the share of the others. For dead time in
the lower powers of s alone this is Cauchy's bound. Example: ``s^2 + s + 3 exp(-s T)``, where the exponential
is at most one: ``R^2 > R + 3`` from R = 2.31 on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import sqrt
from typing import TYPE_CHECKING

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Ring, degree_in, terms_of
from symflex.algebra.exponential_sum import REAL, Exponent, arguments_of, exponential_sum
from symflex.balls import ball, precision
from symflex.budget import spend
from symflex.roots.functions.exponential_values import ExponentialValues
from symflex.transfer import BoundTransferFunction, coefficients_in_s
from symflex.transfer.enclose import summed

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.transfer.enclose_kernels import KernelValues

BITS = 64
"""Of bounds, which need few digits."""
SECTORS = 48
"""Into which the right angle is cut: less than two degrees each."""
TILTED = SECTORS * 4 // 3
"""As many from the real axis on make 120 degrees."""
LARGEST = 1e36
"""Of a radius, relative to the frequency of about one wave in the longest part."""
NARROW = 1.05
"""How far above one that is none a radius may be: the path about what lies within takes steps."""
ROOTS = {"wave": 2, "bending": 4}
NO_FORMULA = "no bound on the poles is known without a formula for the wavenumbers"
TOO_MANY = "no bound on the poles is known for so many exponentials"
TWO_WAVENUMBERS = "no bound on the poles is known when a part has two wavenumbers"
ADVANCED = "a delayed term has the highest power of s, so poles right of the axis have no bound"
NEUTRAL = "delayed terms share the highest power of s and none outweighs the others, so poles have no bound"
EVERY_DELAYED = "no bound on the poles is known when every term is delayed"
NO_LOSS = "waves without enough loss have poles all along the axis"

Terms = dict[Exponent, dict[Fraction, acb]]
"""Of a sum of exponentials, amplitudes as sums of powers of s."""


@dataclass(frozen=True, slots=True)
class _Power:
    """``s^power`` times a number.

    A delay's exponent never grows in the right half plane, which rounding at a right angle would hide.
    """

    power: Fraction
    unit: acb
    is_delay: bool = False


def right_tail(
    bound: BoundTransferFunction,
    polynomials: Sequence[fmpz_mpoly],
    scales: Sequence[acb],
    start: float,
) -> float | str:
    """Return a radius beyond which a sum of polynomials in kernels has no root with ``Re(s) >= 0``.

    Each polynomial of the ring of ``bound`` is multiplied with its scale, a ball and maybe a complex one.
    ``start`` is the smallest radius tried [rad/s]. There is no radius, but the reason, where no one term
    outweighs the others, as in lossless structures, whose poles lie along the axis without end, or where
    wavenumbers have no formula.
    """
    with precision(BITS):
        function = _sum_far_out(bound, polynomials, scales, SECTORS)
        if isinstance(function, str):
            return function
        radius = _least(start, lambda r: function.dominant_terms(r) is not None)
        return radius if radius is not None else function.obstacle(start * LARGEST)


@dataclass(frozen=True, slots=True)
class SizeFarOut:
    """How large a function is at most, from a radius on: ``abs(H) <= most * abs(s)^power``."""

    most: arb
    power: Fraction
    lead: acb  # what ``H/s^power`` tends to along the real axis


@dataclass(frozen=True, eq=False)
class FunctionFarOut:
    """A transfer function in the first sectors from the real axis on, and in their mirror images."""

    factors: tuple[tuple[_SumFarOut, int], ...]  # with their exponents
    unit: arb  # what the product of all is multiplied by
    sectors: int  # how many they are

    @classmethod
    def of(cls, bound: BoundTransferFunction, sectors: int) -> FunctionFarOut | None:
        """Return what tells how large a function is; None where its wavenumbers have no formula."""
        found = []
        with precision(BITS):
            for factor, exponent in bound.ratio.factors:
                function = _sum_far_out(bound, (factor,), (acb(1),), sectors)
                if isinstance(function, str):
                    return None
                found.append((function, exponent))
            return cls(tuple(found), ball(bound.ratio.unit), sectors)

    def least(self, start: float) -> float | None:
        """Return a radius from which on sizes are known, no smaller than a given one; None without one."""
        with precision(BITS):
            return _least(start, lambda radius: self.size(radius) is not None)

    def size(self, radius: float) -> SizeFarOut | None:
        """Return the size from a radius [rad/s] on, where there is no pole; None where that is not known."""
        with precision(BITS):
            above: Terms = {REAL: {Fraction(0): acb(self.unit)}}
            below = []
            arguments: list[_Power] = []
            for function, exponent in self.factors:
                if exponent < 0:
                    found = function.dominant_terms(radius)
                    if found is None:
                        return None
                    arguments, dominant = found
                    below.append((dominant, -exponent))
                else:
                    powers = function.powers(radius)
                    if powers is None:
                        return None
                    own, arguments = powers
                    for _ in range(exponent):
                        above = _product(above, own)
            sizes = []
            for sector in range(self.sectors):
                size = _quotient(
                    above, [(d[sector], e) for d, e in below], _turned(arguments, sector), radius
                )
                if size is None:
                    return None
                sizes.append(size)
            power = max(size.power for size in sizes)
            most = [size.most * arb(radius) ** ball(size.power - power) for size in sizes]
            lead = sizes[0].lead if sizes[0].power == power else acb(0)
            return SizeFarOut(max(most, key=lambda m: float(m.upper())).upper(), power, lead)


def _product(a: Terms, b: Terms) -> Terms:
    """Return the product of two sums of exponentials."""
    found: Terms = {}
    for one, amplitude in a.items():
        for other, factors in b.items():
            own = found.setdefault(_sum((one, 1), (other, 1)), {})
            for (p, c), (q, d) in product(amplitude.items(), factors.items()):
                own[p + q] = own.get(p + q, acb(0)) + c * d
    return found


def _sum(*parts: tuple[Exponent, int]) -> Exponent:
    """Return a sum of multiples of exponents."""
    found: dict[int, tuple[int, int]] = {}
    for exponent, times in parts:
        for i, a, b in exponent:
            re, im = found.get(i, (0, 0))
            found[i] = (re + times * a, im + times * b)
    return tuple((i, *own) for i, own in sorted(found.items()) if any(own))


def _quotient(
    above: Terms, below: Sequence[tuple[_Dominant, int]], arguments: Sequence[_Power], radius: float
) -> SizeFarOut | None:
    """Return how large a sum over powers of others is from a radius on in one sector."""
    grown = _sum(*((d.exponent, e) for d, e in below))
    lost = sum((d.power * e for d, e in below), Fraction(0))
    least, lead, from_radius = arb(1), acb(1), arb(radius)
    for d, e in below:
        least, lead = least * d.least**e, lead * d.lead**e
    # What the denominator's growth does not outweigh says how the quotient falls; where there is none, all.
    highest = max(above.get(grown, {}), default=None)
    power = max(p for own in above.values() for p in own) if highest is None else highest
    most = arb(0)
    for exponent, amplitude in above.items():
        faded = _faded(_sum((exponent, 1), (grown, -1)), arguments, from_radius)
        if faded is None:
            return None
        size, slope = faded
        for p, c in amplitude.items():
            over = ball(p - power)
            if over > 0 and not -slope > over:
                return None
            most += abs(c).upper() * from_radius**over * size
    limit = acb(0) if highest is None else above[grown][highest] / lead
    return SizeFarOut((most / least).upper(), power - lost, limit)


def _faded(exponent: Exponent, arguments: Sequence[_Power], radius: arb) -> tuple[arb, arb] | None:
    """Return an exponential's size at a radius, and the slope of its logarithm over that of abs(s), at most.

    None where it may grow.
    """
    total, slope = arb(0), arb(0)
    rates: dict[Fraction, arb] = {}
    for i, a, b in exponent:
        own = arguments[i]
        if not (own.is_delay and b == 0 and a > 0):
            rates[own.power] = rates.get(own.power, arb(0)) + (own.unit * acb(a, b)).real
    for power, ball_of_rate in rates.items():
        rate = ball_of_rate.upper()
        if rate > 0:
            return None
        total += rate * radius ** ball(power)
        slope += rate * ball(power) * radius ** ball(power)
    return total.exp(), slope


def _least(start: float, is_known: Callable[[float], bool]) -> float | None:
    """Return a radius from which on something is known, if it is so from the largest one on."""
    if is_known(start):
        return start
    # Where the largest radius is none, there is none at all.
    low, high = start, start * LARGEST
    if not is_known(high):
        return None
    while high > NARROW * low:
        spend()
        middle = sqrt(low) * sqrt(high)
        low, high = (low, middle) if is_known(middle) else (middle, high)
    return high


def _sum_far_out(
    bound: BoundTransferFunction, polynomials: Sequence[fmpz_mpoly], scales: Sequence[acb], sectors: int
) -> _SumFarOut | str:
    """Return the sum of polynomials times their scales; or why it is not known far out."""
    table = bound.kernels
    arguments = arguments_of(table)
    if arguments is None:
        return NO_FORMULA
    if any(law.kind not in (*ROOTS, "exponential") for law in table.dispersions):
        return TWO_WAVENUMBERS
    sums = [exponential_sum(bound.ratio.ring, table, arguments, f) for f in polynomials]
    known = [terms for terms in sums if terms is not None]
    if len(known) < len(sums):
        return TOO_MANY
    kernels = bound.kernel_values()
    values = ExponentialValues(kernels, arguments, tuple((terms, 1) for terms in known))
    return _SumFarOut(kernels, values, tuple(scales), table.dispersions, sectors)


@dataclass(frozen=True, slots=True)
class _SumFarOut:
    """Polynomials in kernels, and what they are multiplied with, for large s."""

    kernels: KernelValues
    sums: ExponentialValues
    scales: tuple[acb, ...]
    laws: tuple[Dispersion, ...]
    sectors: int  # from the real axis on, in which one term has to outweigh the others

    def dominant_terms(self, radius: float) -> _DominantTerms | None:
        """Return the arguments, and the term that outweighs all others from a radius on in every sector.

        None where there is no such term in one of them; where there are, there is no root.
        """
        powers = self.powers(radius)
        if powers is None:
            return None
        terms, arguments = powers
        found = {}
        # Next to the ends a sector is the most likely to fail.
        for i in (self.sectors - 1, 0, *range(1, self.sectors - 1)):
            own = _dominant(terms, _turned(arguments, i), arb(radius))
            if own is None:
                return None
            found[i] = own
        return arguments, [found[i] for i in range(self.sectors)]

    def obstacle(self, radius: float) -> str:
        """Say why no term outweighs the others for large s."""
        powers = self.powers(radius)
        if powers is None or any(not argument.is_delay for argument in powers[1]):
            return NO_LOSS
        highest = {
            own: max((p for p, c in amplitude.items() if abs(c).upper() > 0), default=Fraction(-1))
            for own, amplitude in powers[0].items()
        }
        if () not in highest:
            return EVERY_DELAYED
        delayed = max((p for own, p in highest.items() if own), default=Fraction(-1))
        return ADVANCED if delayed > highest[()] else NEUTRAL

    def powers(self, radius: float) -> tuple[Terms, list[_Power]] | None:
        """Return amplitudes and arguments of the exponentials as powers of s, beyond a radius."""
        named = {LAPLACE: _Power(Fraction(1), acb(1))}
        for law in self.laws:
            if not law.wavenumbers:
                continue
            order = ROOTS[law.kind]
            found = _at_infinity(self.kernels, law.characteristic[0], radius)
            if found is None:
                return None
            power, value = found
            value = -value if law.kind == "wave" else value / 4
            # Any branch serves, as long as it is the same everywhere.
            start = acb(0)
            if not value.real > 0:
                value, start = -value, acb(0, arb.pi() / order)
            if not value.real > 0:
                return None
            unit = (value.log() / order + start).exp()
            named[law.wavenumbers[0]] = _Power(Fraction(power, order), unit)
        arguments = []
        decays: dict[int, acb] = {}  # of delayed terms, such as what a belt loses on the way
        for i, (argument, length) in enumerate(zip(self.sums.arguments, self.sums.lengths, strict=True)):
            if argument.wavenumber:
                known = named[argument.wavenumber]
                arguments.append(_Power(known.power, known.unit * length))
                continue
            found = _at_infinity(self.kernels, argument.rate, radius)
            if found is None:
                return None
            power, value = found
            linear = _linear(self.kernels, argument.rate)
            if linear is not None:
                value, decays[i] = linear[0], -linear[1] * length
            is_delay = power == 1 and bool(value.imag == 0) and bool(value.real * length.real > 0)
            arguments.append(_Power(Fraction(power), -value * length, is_delay))
        terms: Terms = {}
        for (each, _), coefficients, scale in zip(
            self.sums.sums, self.sums.coefficients, self.scales, strict=True
        ):
            for powers, amplitude in zip(each.terms, coefficients, strict=True):
                own = terms.setdefault(powers, {})
                decay = sum((decays[i] * acb(a, b) for i, a, b in powers if i in decays), acb(0)).exp()
                for number, factors in amplitude:
                    exponent, unit = Fraction(0), number * scale * decay
                    for name, e in factors:
                        exponent += named[name].power * e
                        unit = unit * named[name].unit ** e
                    own[exponent] = own.get(exponent, acb(0)) + unit
        return terms, arguments


def _turned(arguments: Sequence[_Power], sector: int) -> list[_Power]:
    """Return powers of s as powers of abs(s), in one sector from the real axis on.

    Amplitudes need not be turned: what has the same power of s turns alike, and only sizes are compared.
    """
    step = arb.pi() / (2 * SECTORS)
    turn = acb(0, (step * sector).union(step * (sector + 1)))
    return [
        replace(a, unit=a.unit * (turn * ball(a.power)).exp(), is_delay=a.is_delay and sector < SECTORS)
        for a in arguments
    ]


def _at_infinity(kernels: KernelValues, value: Factored, radius: float) -> tuple[int, acb] | None:
    """Return a power of s, and a ball around what a rational function of s is times it, beyond a radius."""
    small = acb(arb(0, 1 / radius), arb(0, 1 / radius))
    power = 0
    total = acb(ball(value.unit))
    for factor, exponent in value.factors:
        if any(degree_in(factor, kernels.names.index(n)) for n in kernels.table.generators):
            return None
        found = acb(0)
        for coefficient in _coefficients(kernels, factor):
            found = found * small + coefficient
        if found.contains(0):
            return None
        power += degree_in(factor, 0) * exponent
        total = total * found**exponent
    return power, total


def _linear(kernels: KernelValues, value: Factored) -> tuple[acb, acb] | None:
    """Return a and b of a rate ``a s + b``; None of any other."""
    unit, rate = acb(ball(value.unit)), (acb(0), acb(1))
    for factor, exponent in value.factors:
        match _coefficients(kernels, factor):
            case [constant]:
                unit = unit * constant**exponent
            case [constant, slope] if exponent == 1 and rate[0] == 0:
                rate = (slope, constant)
            case _:
                return None
    return (unit * rate[0], unit * rate[1]) if rate[0] != 0 else None


def _coefficients(kernels: KernelValues, factor: fmpz_mpoly) -> list[acb]:
    """Return balls around the coefficients of a polynomial in s, that of the lowest power first."""
    names = kernels.names[1:]
    return [
        summed(terms_of(c), names, lambda name: acb(kernels.constants[name]), acb(1))
        for c in coefficients_in_s(factor, Ring(tuple(names)))
    ]


@dataclass(frozen=True, slots=True)
class _Dominant:
    """What outweighs all else: over ``exp(exponent) abs(s)^power`` a sum has a least size."""

    exponent: Exponent
    power: Fraction
    lead: acb
    least: arb


_DominantTerms = tuple[list[_Power], list[_Dominant]]
"""The arguments of exponentials, and what outweighs all else sector by sector."""


def _dominant(terms: Terms, arguments: Sequence[_Power], radius: arb) -> _Dominant | None:
    """Return the term that is larger than all others from a radius on; None without one."""

    def growth(powers: Exponent) -> arb:
        total = arb(0)
        for i, a, b in powers:
            own = arguments[i]
            total += (own.unit * acb(a, b)).real.mid() * radius ** ball(own.power)
        return total.mid()

    def size(powers: Exponent) -> float:
        weight = sum((abs(c).mid() * radius ** ball(p) for p, c in terms[powers].items()), arb(0)).mid()
        return float((growth(powers) + weight.log()).mid()) if weight > 0 else float("-inf")

    chosen = max(terms, key=size)
    own = {p: c for p, c in terms[chosen].items() if abs(c).upper() > 0}
    highest = max(own, default=None)
    if highest is None:
        return None
    others = arb(0)
    for power, coefficient in own.items():
        if power != highest:
            others += (abs(coefficient) * radius ** ball(power - highest)).upper()
    for powers, amplitude in terms.items():
        if powers == chosen:
            continue
        faded = _faded(_sum((powers, 1), (chosen, -1)), arguments, radius)
        if faded is None:
            return None
        share, slope = faded
        for power, coefficient in amplitude.items():
            over = ball(power - highest)
            if over > 0 and not -slope > over:
                return None
            others += abs(coefficient).upper() * radius**over * share
    lead = own[highest]
    if not others < abs(lead).lower():
        return None
    return _Dominant(chosen, highest, lead, (abs(lead) - others).lower())
