"""Roots of a function with kernels in the right half plane, wherever they lie.

The closed right half plane is searched up to a radius beyond which one of the function's terms outweighs all
others; a certified count about the half disc says how many roots it holds, and only where there are some they
are searched.

In a sector of that half plane every wavenumber goes like a power of s, times a factor close to its limit. So
do the amplitudes of a sum of exponentials, and the exponents. Where at ``abs(s) = R`` one term is larger than
all others together, and every quotient of another term to it falls with growing ``abs(s)``, there is no root
beyond R in this sector. For dead time in the lower powers of s alone this is Cauchy's bound. Example:
``s^2 + s + 3 exp(-s T)``, where the exponential is at most one: ``R^2 > R + 3`` from R = 2.31 on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import log, pi, sqrt
from typing import TYPE_CHECKING

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Ring, degree_in
from symflex.algebra.exponential_sum import Exponent, arguments_of, exponential_sum
from symflex.budget import spend
from symflex.errors import BudgetError
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed.side import Side
from symflex.roots.functions.exponential_values import ExponentialValues
from symflex.roots.pole_zero_map import count_right, is_right
from symflex.roots.precision import precision
from symflex.roots.region import Rectangle
from symflex.transfer import BoundTransferFunction, coefficients_in_s
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.budget import Budget
    from symflex.roots.root import Root
    from symflex.transfer.enclose_kernels import KernelValues


PASSIVE = "passive, energy is nowhere supplied"
ACCUMULATING = "poles accumulate in the right half plane"
DEGENERATE = "a root where wavenumbers meet may be no pole"
NOT_COUNTED = "the poles right of the imaginary axis could not be counted"
WAVES = 10.0
"""Largest argument of a kernel up to which poles are counted where no end of them is known."""
MARGIN = 1.01
"""How far beyond the radius of a tail the path runs, so that its corners meet no root."""


@dataclass(frozen=True, slots=True)
class RightHalfPlane:
    """The roots of one function in the right half plane."""

    roots: tuple[Root, ...]  # those found, on the imaginary axis too
    unproved: str = ""  # why there may be others; empty where there are none


def search_right(
    bound: BoundTransferFunction,
    part: Factored,
    side: Side,
    known: Sequence[Root],
    reached: float,
    digits: int,
    budget: Budget,
) -> RightHalfPlane:
    """Count the roots of a function with kernels right of the imaginary axis, and find them.

    ``side`` is the same function, perhaps searched elsewhere; ``known`` roots are those found already,
    anywhere, proved. Up to an abs(s) of ``reached`` [rad/s] all roots are known; 0 where that is not so.
    """
    if side.is_finite:
        return RightHalfPlane(tuple(known))
    if any(hole.right < pi / 2 for hole in side.holes):
        return RightHalfPlane(tuple(known), ACCUMULATING)
    radius, unproved = _end(side, reached)
    # Roots mirror each other in the axis, and a path along it would meet them.
    is_mirrored = bool(unproved) and side.function.is_even
    if is_mirrored and radius <= reached:
        return RightHalfPlane(tuple(known), _up_to(unproved, reached))
    count: int | None = None
    try:
        count = None if is_mirrored else side.count_right(log(radius * MARGIN))
    except RootOnPathError:
        pass
    except BudgetError as error:
        # Where no end is known, more was looked at than what was asked for.
        said = _up_to(unproved, reached) if unproved else error.diagnostics[0].message
        return RightHalfPlane(tuple(known), said)
    seen = [root for root in known if root.re.contains(0) or is_right(root)]
    if count is None or count != count_right(seen):
        limit = Fraction(radius)
        region = Rectangle(Fraction(0), limit, -limit, limit)
        again = Side(bound, part, digits, budget)
        try:
            again.search(region)
            # Roots of lossless systems lie on the border, and beyond what was asked for it is not followed.
            proof = None if is_mirrored else again.prove(region)
        except BudgetError as error:
            more = f"{count} are counted, and not all found: " if count else ""
            said = _up_to(unproved, reached) if is_mirrored else more + error.diagnostics[0].message
            return RightHalfPlane(tuple(known), said)
        seen = [root for root in again.roots if root.re.contains(0) or is_right(root)]
        if proof is None:
            return RightHalfPlane(tuple(seen), _up_to(unproved, reached))
        if not proof.is_complete if count is None else count_right(seen) != count:
            said = _up_to(unproved, reached) if unproved else proof.reason or NOT_COUNTED
            return RightHalfPlane(tuple(seen), said)
    return RightHalfPlane(tuple(seen), unproved and _up_to(unproved, radius))


def _end(side: Side, reached: float) -> tuple[float, str]:
    """Return how far roots are to be counted [rad/s], and why there may be others beyond."""
    start, radius = side.function.frequency_of(1.0), 0.0
    for factor, exponent in side.function.part.factors:
        if exponent > 0:
            tail = right_tail(side.function.bound, (factor,), (acb(1),), start)
            if tail.radius is None:
                return max(reached, side.function.frequency_of(WAVES)), tail.reason
            radius = max(radius, tail.radius)
    return radius, ""


def _up_to(reason: str, radius: float) -> str:
    """Say how far poles are known."""
    return f"known up to {radius / (2 * pi):.4g} Hz only: {reason}" if radius > 0 else reason


BITS = 64
"""Of bounds, which need few digits."""
SECTORS = 48
"""Into which the right angle is cut: less than two degrees each."""
LARGEST = 1e36
"""Of a radius, relative to the frequency of about one wave in the longest part."""
NARROW = 1.05
"""How far above one that is none a radius may be: the path about what lies within takes steps."""
ROOTS = {"wave": 2, "bending": 4}
NO_FORMULA = "without a formula for the wavenumbers no end of the poles is known"
TOO_MANY = "of so many exponentials no end of the poles is known"
TWO_WAVENUMBERS = "where a part has two wavenumbers no end of the poles is known"
ADVANCED = "a delayed term has the highest power of s, and poles right of the axis have no end"
NEUTRAL = "delayed terms share the highest power of s, none outweighs the others, and poles have no end"
EVERY_DELAYED = "where every term is delayed no end of the poles is known"
NO_LOSS = "poles of waves without enough loss have no end along the axis"


@dataclass(frozen=True, slots=True)
class Tail:
    """How far from 0 roots may lie in the closed right half plane."""

    radius: float | None  # beyond which it is proved that there is none [rad/s]
    reason: str = ""  # why there is no such radius; empty where there is one

    def __post_init__(self) -> None:
        if (self.radius is None) != bool(self.reason):
            message = "a tail has either a radius or a reason"
            raise ValueError(message)


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
) -> Tail:
    """Return a radius beyond which a sum of polynomials in kernels has no root with ``Re(s) >= 0``.

    Each polynomial of the ring of ``bound`` is multiplied with its scale, a ball and maybe a complex one.
    ``start`` is the smallest radius tried [rad/s]. There is no radius where no one term outweighs the others,
    as in lossless structures, whose poles lie along the axis without end, or where wavenumbers have no
    formula.
    """
    table = bound.kernels
    arguments = arguments_of(table)
    if arguments is None:
        return Tail(None, NO_FORMULA)
    if any(law.kind not in (*ROOTS, "exponential") for law in table.dispersions):
        return Tail(None, TWO_WAVENUMBERS)
    sums = [exponential_sum(bound.ratio.ring, table, arguments, f) for f in polynomials]
    known = [terms for terms in sums if terms is not None]
    if len(known) < len(sums):
        return Tail(None, TOO_MANY)
    with precision(BITS):
        kernels = bound.kernel_values()
        values = ExponentialValues(kernels, arguments, tuple((terms, 1) for terms in known))
        function = _FunctionFarOut(kernels, values, tuple(scales), table.dispersions)
        if function.is_free_beyond(start):
            return Tail(start)
        # Where the largest radius is none, there is none at all.
        low, high = start, start * LARGEST
        if not function.is_free_beyond(high):
            return Tail(None, function.obstacle(high))
        while high > NARROW * low:
            spend()
            middle = sqrt(low) * sqrt(high)
            if function.is_free_beyond(middle):
                high = middle
            else:
                low = middle
        return Tail(high)


@dataclass(frozen=True, slots=True)
class _FunctionFarOut:
    """Polynomials in kernels, and what they are multiplied with, for large s."""

    kernels: KernelValues
    sums: ExponentialValues
    scales: tuple[acb, ...]
    laws: tuple[Dispersion, ...]

    def is_free_beyond(self, radius: float) -> bool:
        """Tell whether it is proved that no root lies beyond a radius in the first quadrant."""
        powers = self._powers(radius)
        if powers is None:
            return False
        terms, arguments = powers
        # Next to the axes a sector is the most likely to fail.
        return all(
            _is_dominated(terms, _turned(arguments, i), arb(radius))
            for i in (SECTORS - 1, 0, *range(1, SECTORS - 1))
        )

    def obstacle(self, radius: float) -> str:
        """Say why no term outweighs the others for large s."""
        powers = self._powers(radius)
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

    def _powers(self, radius: float) -> tuple[dict[Exponent, dict[Fraction, acb]], list[_Power]] | None:
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
        for argument, length in zip(self.sums.arguments, self.sums.lengths, strict=True):
            if argument.wavenumber:
                known = named[argument.wavenumber]
                arguments.append(_Power(known.power, known.unit * length))
                continue
            found = _at_infinity(self.kernels, argument.rate, radius)
            if found is None:
                return None
            power, value = found
            is_delay = power == 1 and bool(value.imag == 0) and bool(value.real * length.real > 0)
            arguments.append(_Power(Fraction(power), -value * length, is_delay))
        terms: dict[Exponent, dict[Fraction, acb]] = {}
        for (each, _), coefficients, scale in zip(
            self.sums.sums, self.sums.coefficients, self.scales, strict=True
        ):
            for powers, amplitude in zip(each.terms, coefficients, strict=True):
                own = terms.setdefault(powers, {})
                for number, factors in amplitude:
                    exponent, unit = Fraction(0), number * scale
                    for name, e in factors:
                        exponent += named[name].power * e
                        unit = unit * named[name].unit ** e
                    own[exponent] = own.get(exponent, acb(0)) + unit
        return terms, arguments


def _turned(arguments: Sequence[_Power], sector: int) -> list[_Power]:
    """Return powers of s as powers of abs(s), in one sector of the first quadrant.

    Amplitudes need not be turned: what has the same power of s turns alike, and only sizes are compared.
    """
    step = arb.pi() / (2 * SECTORS)
    turn = acb(0, (step * sector).union(step * (sector + 1)))
    return [replace(a, unit=a.unit * (turn * ball(a.power)).exp()) for a in arguments]


def _at_infinity(kernels: KernelValues, value: Factored, radius: float) -> tuple[int, acb] | None:
    """Return a power of s, and a ball around what a rational function of s is times it, beyond a radius."""
    small = acb(arb(0, 1 / radius), arb(0, 1 / radius))
    power = 0
    total = acb(ball(value.unit))
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


def _is_dominated(terms: dict[Exponent, dict[Fraction, acb]], arguments: list[_Power], radius: arb) -> bool:
    """Tell whether one term is larger than all others from a radius on."""

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
        return False
    lead = abs(own[highest]).lower()
    for power, coefficient in own.items():
        if power != highest:
            lead -= (abs(coefficient) * radius ** ball(power - highest)).upper()
    total = arb(0)
    base = {i: complex(a, b) for i, a, b in chosen}
    for powers, amplitude in terms.items():
        if powers == chosen:
            continue
        difference = {i: -c for i, c in base.items()}
        for i, a, b in powers:
            difference[i] = difference.get(i, 0) + complex(a, b)
        # The term's exponent less the largest term's, and how it falls: d/d(ln r).
        exponent, slope = arb(0), arb(0)
        for i, c in difference.items():
            if not c:
                continue
            rate = (arguments[i].unit * acb(c.real, c.imag)).real.upper()
            if rate > 0:
                if not (arguments[i].is_delay and c.imag == 0 and c.real > 0):
                    return False
                continue
            degree = ball(arguments[i].power)
            exponent += rate * radius**degree
            slope += rate * degree * radius**degree
        for power, coefficient in amplitude.items():
            over = ball(power - highest)
            if over > 0 and not -slope > over:
                return False
            total += abs(coefficient).upper() * radius**over * exponent.exp()
    return bool(total < lead)
