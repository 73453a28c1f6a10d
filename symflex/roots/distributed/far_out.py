"""Functions with kernels far from s = 0: where they have no root, and how large they are.

In a sector of the s plane every wavenumber goes like a power of s, times a factor close to its limit. So do
the amplitudes of a sum of exponentials, and the exponents. Where at ``abs(s) = R`` one term is larger than
all others together, and every quotient of another term to it falls with growing ``abs(s)``, there is no root
beyond R in this sector, and the sum is as large as that term, up to the share of the others. For delay in
the lower powers of s alone this is Cauchy's bound. Example: ``s^2 + s + 3 exp(-s T)``, where the exponential
is at most one: ``R^2 > R + 3`` from R = 2.31 on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import gcd, inf, sqrt

from flint import acb, acb_poly, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Ring, by_powers, degree_in, summed, terms_of
from symflex.algebra.exponential_sum import REAL, Exponent, arguments_of
from symflex.balls import at_centre, ball, precision
from symflex.budget import spend
from symflex.model.model import IMAGINARY
from symflex.roots.functions.exponential_values import ExponentialValues, Valued, sums_of
from symflex.roots.functions.kernel_function import SINGLE, TWINS
from symflex.roots.pole_zero_map import WITHOUT_END
from symflex.transfer import BoundTransferFunction, coefficients_in_s
from symflex.transfer.enclose_kernels import KernelValues, square_root

BITS = 64  # precision of bounds, which need few digits
SECTORS = 48  # into which the right angle is cut: less than two degrees each
TILTED = SECTORS * 4 // 3  # as many from the real axis on make 120 degrees
LARGEST = 1e36  # largest radius, relative to the frequency of about one wave in the longest part
NARROW = 1.05  # how far above one that is none a radius may be: what lies within is followed in steps
LINEAR, QUADRATIC = 1, 2
NO_FORMULA = "no bound on the poles is known without a formula for the wavenumbers"
NOT_OUTWEIGHED = "no bound on the poles is known, as no term outweighs the others at high frequencies"
TOO_MANY = "no bound on the poles is known for so many exponentials"
ADVANCED = "a delayed term has the highest power of s, so poles in the right half-plane have no bound"
NEUTRAL = "delayed terms share the highest power of s and none outweighs the others, so poles have no bound"
DELAY_LEADS = f"a delayed term outweighs all others of the highest power of s, so {WITHOUT_END}"
VANISHES = "the highest power of s may vanish, so poles have no bound"
EVERY_DELAYED = "no bound on the poles is known when every term is delayed"
NO_LOSS = "waves without enough damping have poles all along the axis; material damping (eta) decides it"

PHASES = 128  # parts of a turn in which two sums are shown not to vanish together

Terms = dict[Exponent, dict[Fraction, acb]]  # sums of exponentials, with sums of powers of s as amplitudes
RealTerms = Mapping[Exponent, Mapping[Fraction, arb]]


@dataclass(frozen=True, slots=True)
class _Power:
    """``s^power`` times a number; a delay's exponent never grows on the right, which rounding would hide."""

    power: Fraction
    unit: acb
    is_delay: bool = False


def right_tail(
    bound: BoundTransferFunction, polynomials: Sequence[fmpz_mpoly], scales: Sequence[acb], start: float
) -> float | str:
    """Return a radius beyond which a sum of polynomials in kernels has no root with ``Re(s) >= 0``.

    Each polynomial of the ring of ``bound`` is multiplied with its scale, a ball and maybe a complex one.
    ``start`` is the smallest radius tried [rad/s]. There is no radius, but the reason, where no one term
    outweighs the others, as in undamped structures, whose poles lie along the axis without end, or where
    wavenumbers have no formula.
    """
    ring, table = bound.ratio.ring, bound.kernels
    has_j = IMAGINARY in ring.index and (
        any(degree_in(f, ring.index[IMAGINARY]) for f in polynomials)
        or any(value.depends_on(IMAGINARY) for value in table.values)
    )
    with precision(BITS):
        # Sectors of a root of s, if the function is one of that.
        function = _sum_far_out(bound, polynomials, scales, -(-SECTORS // bound.sheets))
        if isinstance(function, str):
            return function
        function = replace(function, is_real=not has_j)
        radius = _least(start, lambda r: function.dominant_terms(r) is not None)
        if radius is None and bound.sheets > 1:
            return NOT_OUTWEIGHED
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
        functions = []
        with precision(BITS):
            for factor, exponent in bound.ratio.factors:
                function = _sum_far_out(bound, (factor,), (acb(1),), sectors)
                if isinstance(function, str):
                    return None
                functions.append((function, exponent))
            return cls(tuple(functions), ball(bound.ratio.unit), sectors)

    def least(self, start: float) -> float | None:
        """Return a radius from which on sizes are known, no smaller than a given one; None without one."""
        with precision(BITS):
            return _least(start, lambda radius: self.size(radius) is not None)

    def delayed_terms(self, radius: float) -> tuple[RealTerms, RealTerms] | None:
        """Return numerator and denominator as sums of delayed terms, if they are that and real, else None."""
        with precision(BITS):
            sides: list[Terms] = [{REAL: {Fraction(0): acb(self.unit)}}, {REAL: {Fraction(0): acb(1)}}]
            for function, exponent in self.factors:
                powers = None if any(law.wavenumbers for law in function.laws) else function.powers(radius)
                if powers is None or not all(argument.is_delay for argument in powers[1]):
                    return None
                for _ in range(abs(exponent)):
                    sides[exponent < 0] = _product(sides[exponent < 0], powers[0])
            if not all(c.imag == 0 for side in sides for own in side.values() for c in own.values()):
                return None
            real = ({e: {p: c.real for p, c in own.items() if c != 0} for e, own in x.items()} for x in sides)
            above, below = ({e: own for e, own in side.items() if own} for side in real)
            return above, below

    def angle_on_axis(self, radius: float) -> tuple[arb, arb] | None:
        """Return the angle of H on the axis from a radius on, and how far it may be off [rad]; else None.

        That is known where one term of each factor outweighs the others, and their exponentials cancel.
        """
        with precision(BITS):
            lead, off, power, grown = acb(self.unit), arb(0), Fraction(0), Exponent()
            for function, exponent in self.factors:
                powers = function.powers(radius)
                if powers is None:
                    return None
                own = _dominant(powers[0], _along_axis(powers[1]), arb(radius))
                if own is None:
                    return None
                lead *= own.lead**exponent
                off += abs(exponent) * (1 - own.least / abs(own.lead).upper()).asin()
                power += own.power * exponent
                grown = _sum((grown, 1), (own.exponent, exponent))
            turn = acb(0, arb.pi() / 2 * ball(power) / function.sheets).exp()
            return ((lead * turn).arg(), off) if not grown and lead.is_finite() else None

    def size(self, radius: float) -> SizeFarOut | None:
        """Return the size from a radius [rad/s] on, where there is no pole; None where that is not known."""
        with precision(BITS):
            above: Terms = {REAL: {Fraction(0): acb(self.unit)}}
            below = []
            arguments: list[_Power] = []
            for function, exponent in self.factors:
                if exponent < 0:
                    terms = function.dominant_terms(radius)
                    if terms is None:
                        return None
                    arguments, dominant = terms
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
    terms: Terms = {}
    for one, amplitude in a.items():
        for other, factors in b.items():
            own = terms.setdefault(_sum((one, 1), (other, 1)), {})
            for (p, c), (q, d) in product(amplitude.items(), factors.items()):
                own[p + q] = own.get(p + q, acb(0)) + c * d
    return terms


def _sum(*parts: tuple[Exponent, int]) -> Exponent:
    """Return a sum of multiples of exponents."""
    sums: dict[int, tuple[int, int]] = {}
    for exponent, times in parts:
        for i, a, b in exponent:
            re, im = sums.get(i, (0, 0))
            sums[i] = (re + times * a, im + times * b)
    return tuple((i, *own) for i, own in sorted(sums.items()) if any(own))


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
    most = _over(above, grown, power, arguments, from_radius)
    if most is None:
        return None
    limit = acb(0) if highest is None else above[grown][highest] / lead
    return SizeFarOut((most / least).upper(), power - lost, limit)


def _over(
    terms: Terms, grown: Exponent, power: Fraction, arguments: Sequence[_Power], radius: arb
) -> arb | None:
    """Return how large a sum over an exponential and a power is from a radius on; None where it may grow."""
    most = arb(0)
    for exponent, amplitude in terms.items():
        faded = _faded(_sum((exponent, 1), (grown, -1)), arguments, radius)
        if faded is None:
            return None
        size, slope = faded
        for p, c in amplitude.items():
            over = ball(p - power)
            if over > 0 and not -slope > over:
                return None
            most += abs(c).upper() * radius**over * size
    return most


def _faded(exponent: Exponent, arguments: Sequence[_Power], radius: arb) -> tuple[arb, arb] | None:
    """Return an exponential's size and the slope of its logarithm over ln(abs(s)); None if it may grow."""
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
    if arguments_of(table) is None:
        return NO_FORMULA
    summed = sums_of(bound.ratio.ring, polynomials, table)
    if summed is None:
        return TOO_MANY
    kernels = bound.kernel_values()
    values = ExponentialValues(kernels, *summed)
    return _SumFarOut(kernels, values, tuple(scales), table.dispersions, sectors, bound.sheets)


@dataclass(frozen=True, slots=True)
class _SumFarOut:
    """Polynomials in kernels, and what they are multiplied with, for large s."""

    kernels: KernelValues
    sums: ExponentialValues
    scales: tuple[acb, ...]
    laws: tuple[Dispersion, ...]
    sectors: int  # from the real axis on, in which one term has to outweigh the others
    sheets: int = 1  # q of a function of ``s^(1/q)``, in whose sectors lower powers than that decay
    is_real: bool = True  # else it has to outweigh them below the real axis, too

    def dominant_terms(self, radius: float) -> tuple[list[_Power], list[_Dominant]] | None:
        """Return, per sector, the term that outweighs all others from a radius on, else None."""
        powers = self.powers(radius)
        if powers is None:
            return None
        terms, arguments = powers
        by_sector = {}
        # Next to the ends a sector is the most likely to fail.
        below = () if self.is_real else range(-self.sectors, 0)
        for i in (self.sectors - 1, 0, *range(1, self.sectors - 1), *below):
            own = _dominant(terms, _turned(arguments, i), arb(radius))
            if own is None:
                return None
            by_sector[i] = own
        return arguments, [by_sector[i] for i in range(self.sectors)]

    def obstacle(self, radius: float) -> str:
        """Say why no term outweighs the others for large s.

        If a delayed one outweighs all others of the highest power of s along the axis, infinitely many roots
        lie in the right half-plane (Bellman and Cooke 1963, chapter 12).
        """
        powers = self.powers(radius)
        if powers is None or any(each.wavenumber for each in self.sums.arguments):
            return NO_LOSS
        highest = {
            own: max((p for p, c in amplitude.items() if abs(c).upper() > 0), default=Fraction(-1))
            for own, amplitude in powers[0].items()
        }
        if () not in highest:
            return EVERY_DELAYED
        delayed = max((p for own, p in highest.items() if own), default=Fraction(-1))
        most = max(highest.values())
        sizes = {own: abs(powers[0][own].get(p, acb(0))) for own, p in highest.items() if p == most}
        total = sum(sizes.values(), arb(0))
        are_delays = all(powers[1][i].is_delay and a > 0 and not b for own in highest for i, a, b in own)
        if are_delays and any(own and 2 * size > total for own, size in sizes.items()):
            return DELAY_LEADS
        return ADVANCED if delayed > highest[()] else NEUTRAL if delayed == highest[()] else VANISHES

    def powers(self, radius: float) -> tuple[Terms, list[_Power]] | None:
        """Return amplitudes and arguments of the exponentials as powers of s, beyond a radius."""
        named = {LAPLACE: _Power(Fraction(1), acb(1))}
        to_and_fro: dict[str, tuple[acb, acb]] = {}
        for law in self.laws:
            if not law.wavenumbers:
                continue
            name = law.wavenumbers[0]
            if law.kind in SINGLE and (wave := _wave(self.kernels, law, radius)) is not None:
                named[name], to_and_fro[name] = wave[0], wave[1:]
                continue
            roots = (_pair if law.kind == "pair" else _single)(self.kernels, law, radius)
            if roots is None:
                return None
            named.update(zip(law.wavenumbers, roots, strict=True))
        arguments = []
        lengths = map(at_centre, self.sums.lengths)
        decays: dict[int, acb] = {}  # of delayed terms, such as what a belt loses on the way
        for i, (argument, length) in enumerate(zip(self.sums.arguments, lengths, strict=True)):
            if argument.wavenumber in to_and_fro and length.real > 0:
                unit, rest = to_and_fro[argument.wavenumber]
                decays[i] = rest * length
                arguments.append(_Power(Fraction(1), unit * length, is_delay=self.sheets == 1))
                continue
            if argument.wavenumber:
                known = named[argument.wavenumber]
                arguments.append(_Power(known.power, known.unit * length))
                continue
            leading = _at_infinity(self.kernels, argument.rate, radius)
            if leading is None:
                return None
            power, value = leading
            linear = _polynomial(self.kernels, argument.rate)
            if linear is not None and len(linear) == LINEAR + 1:
                value, decays[i] = linear[1], -linear[0] * length
            is_late = value.real * length.real > 0 or (value.real > 0 and self._is_late(argument.length))
            is_delay = power == self.sheets and bool(value.imag == 0) and bool(is_late)
            arguments.append(_Power(Fraction(power), -value * length, is_delay))
        terms: Terms = {}
        for (each, _), coefficients, scale in zip(
            self.sums.sums, self.sums.coefficients, self.scales, strict=True
        ):
            for powers, amplitude in zip(each.terms, coefficients, strict=True):
                own = terms.setdefault(powers, {})
                decay = sum((decays[i] * acb(a, b) for i, a, b in powers if i in decays), acb(0)).exp()
                for p, c in _summed(amplitude, named).items():
                    own[p] = own.get(p, acb(0)) + c * scale * decay
        return terms, arguments

    def _is_late(self, length: Factored) -> bool:
        """Tell whether a delay is proved not to be negative, though its ball may be about 0."""
        names, constants = self.kernels.names, self.kernels.constants
        factors = [f for f, _ in length.factors]
        used = {names[i] for f in factors for monomial, _ in terms_of(f) for i, _ in monomial}
        return length.unit > 0 and all(len(f) == 1 for f in factors) and all(constants[n] >= 0 for n in used)


def _turned(arguments: Sequence[_Power], sector: int) -> list[_Power]:
    """Return powers of s as powers of abs(s) in one sector; what has the same power turns alike."""
    step = arb.pi() / (2 * SECTORS)
    turn = acb(0, (step * sector).union(step * (sector + 1)))
    return [
        replace(a, unit=a.unit * (turn * ball(a.power)).exp(), is_delay=a.is_delay and sector < SECTORS)
        for a in arguments
    ]


def _along_axis(arguments: Sequence[_Power]) -> list[_Power]:
    """Return powers of s as powers of abs(s) on the imaginary axis, where delays neither grow nor fade."""
    quarter = arb.pi() / 2

    def turn(power: Fraction) -> acb:
        whole = power.denominator == 1
        return acb(0, 1) ** int(power) if whole else acb(0, quarter * ball(power)).exp()

    return [replace(a, unit=a.unit * turn(a.power), is_delay=False) for a in arguments]


def _at_infinity(kernels: KernelValues, value: Factored, radius: float) -> tuple[int, acb] | None:
    """Return a power of s, and a ball around what a rational function of s is times it, beyond a radius."""
    small = acb(arb(0, 1 / radius), arb(0, 1 / radius))
    power = 0
    total = acb(ball(value.unit))
    for factor, exponent in value.factors:
        if any(degree_in(factor, kernels.names.index(n)) for n in kernels.table.generators):
            return None
        series_sum = acb(0)
        for coefficient in _coefficients(kernels, factor):
            series_sum = series_sum * small + coefficient
        if series_sum.contains(0):
            return None
        power += degree_in(factor, 0) * exponent
        total = total * series_sum**exponent
    return power, total


def _single(kernels: KernelValues, law: Dispersion, radius: float) -> list[_Power] | None:
    """Return a wavenumber beyond a radius; any branch serves, as long as it is the same everywhere."""
    leading = _at_infinity(kernels, law.characteristic[0], radius)
    if leading is None:
        return None
    order, (power, value) = SINGLE[law.kind], leading
    value = -value if law.kind == "wave" else value / 4
    start = acb(0)
    if not value.real > 0:
        value, start = -value, acb(0, arb.pi() / order)
    if not value.real > 0:
        return None
    return [_Power(Fraction(power, order), (value.log() / order + start).exp())]


def _pair(kernels: KernelValues, law: Dispersion, radius: float) -> list[_Power] | None:
    """Return two wavenumbers beyond a radius, whose squares are ``-c_2/2 +- sqrt(c_2^2 - 4 c_0)/2``."""
    known = (_at_infinity(kernels, x, radius) for x in (*law.characteristic[::2], law.discriminant))
    last, middle, under = known
    if last is None or middle is None or under is None:
        return None
    half = square_root(under[1] / 4)
    assert isinstance(half, acb)
    parts = (Fraction(middle[0]), -middle[1] / 2), (Fraction(under[0], 2), half)
    power = max(p for p, _ in parts)
    # What has a lower power of s lies within a disc, relative to the other.
    errors = (arb(0, arb(radius) ** ball(p - power)) for p, _ in parts)
    one, two = (x if p == power else x * acb(e, e) for (p, x), e in zip(parts, errors, strict=True))
    larger = max(one + two, one - two, key=lambda x: x.abs_lower())
    roots = []
    for p, square in ((power, larger), (last[0] - power, acb(last[1] / larger))):
        root = square_root(square)
        if not isinstance(root, acb) or not root.is_finite() or root.contains(0):
            return None
        roots.append(_Power(p / 2, root))
    return roots


def _wave(kernels: KernelValues, law: Dispersion, radius: float) -> tuple[_Power, acb, acb] | None:
    """Return a wavenumber, and minus u and d of ``-u s - d`` which it is beyond a radius.

    None unless ``gamma^2 = u^2 s^2 + b s + c`` with b not negative, of damping. Then d is next to b/(2 u).
    """
    square = _polynomial(kernels, -law.characteristic[0]) if law.kind == "wave" else None
    if square is None or len(square) != QUADRATIC + 1:
        return None
    c, b, u = square[0], square[1], square[2].sqrt()
    if not (square[2].real > 0 and b.real >= 0):
        return None
    small = acb(arb(0, 1 / radius), arb(0, 1 / radius))
    rest = (b + c * small) / u / ((1 + (b + c * small) * small / u**2).sqrt() + 1)
    return _Power(Fraction(1), -u - rest * small), -u, -rest


def _polynomial(kernels: KernelValues, value: Factored) -> list[acb] | None:
    """Return the coefficients of a polynomial in s, that of the lowest power first; None of other values."""
    total = acb_poly([acb(ball(value.unit))])
    for factor, exponent in value.factors:
        own = _coefficients(kernels, factor)
        if exponent < 0 and len(own) > 1:
            return None
        total = total * (acb_poly(own) ** exponent if exponent > 0 else acb_poly([own[0] ** exponent]))
    return total.coeffs()


def _coefficients(kernels: KernelValues, factor: fmpz_mpoly) -> list[acb]:
    """Return balls around the coefficients of a polynomial in s, that of the lowest power first."""
    names = kernels.names[1:]
    return [
        summed(terms_of(c), names, lambda name: acb(kernels.constants[name]), acb(1))
        for c in coefficients_in_s(factor, Ring(tuple(names)))
    ]


def axis_tail(bound: BoundTransferFunction, part: Factored, start: float) -> float:
    """Return a frequency [rad/s] beyond which a product has no root on the imaginary axis; inf without one.

    ``start`` is the smallest tried. Where waves lose nothing their kernels are even in s, and so is ``-s`` a
    root on the axis: even and odd part vanish both. Of each those exponentials are left that grow the
    fastest, which turn by multiples of one phase. Whatever it is, one of the parts is not zero.

        Cantilever with a dashpot:  EI k^3 (1 + cosh cos) + s b (cosh sin - sinh cos), of k l
        k -> inf                    cos(k l) = 0 and sin(k l) - cos(k l) = 0: impossible
    """
    radius = start
    with precision(BITS):
        kernels = bound.kernel_values()
        for factor in (f for f, exponent in part.factors if exponent > 0):
            if radius == inf or not _is_mirrored(bound, factor):
                return inf
            together = sums_of(bound.ratio.ring, _together(bound.ratio.ring, factor), bound.kernels)
            if together is None:
                return inf
            function = _SumsOnAxis(ExponentialValues(kernels, *together))
            radius = _least(radius, function.have_no_root) or inf
    return radius


def _is_mirrored(bound: BoundTransferFunction, factor: fmpz_mpoly) -> bool:
    """Tell whether a polynomial in kernels stays the same, but for a unit, if a wavenumber turns."""
    index, kernels = bound.ratio.ring.index, bound.kernels.kernels
    terms = dict(terms_of(factor))
    for name in bound.kernels.wavenumbers:
        own: dict[tuple[str, Factored], int] = {
            (k.function, k.length): index[k.generator] for k in kernels if k.wavenumber == name
        }
        odd = {index[name], *(i for (function, _), i in own.items() if function.startswith("sin"))}
        images = dict[int, int]()
        if any(function == "cos" for function, _ in own):
            images = {i: own.get((TWINS[function], length), -1) for (function, length), i in own.items()}
        units = set()
        for monomial, c in terms.items():
            image = terms.get(tuple(sorted((images.get(i, i), e) for i, e in monomial)), 0)
            turns = sum(e for i, e in monomial if i in odd) * (3 if images else 2)
            units.add((turns + (0 if c == image else 2)) % 4 if abs(c) == abs(image) else -1)
        if units - {-1} != units or len(units) > 1:
            return False
    return True


def _together(ring: Ring, factor: fmpz_mpoly) -> list[fmpz_mpoly]:
    """Return the even and the odd part in s, and what vanishes with both: a term of each cancels in that.

    A mass with a dashpot, for example, has ``m s^2 X + Y`` and ``b s X``, which leave Y.
    """
    parts = by_powers(ring, factor)
    s, factors = ring.context.gen(0), list[fmpz_mpoly]()
    for odd in (0, 1):
        half = sum((c * s**p for p, c in parts.items() if p % 2 == odd), ring.constant(0))
        factors += [] if half.is_zero() else [half]
    for one, other in ((0, 1), (0, 2), (1, 2)):
        if len(factors) > max(one, other):
            f, g = factors[one], factors[other]
            (a, c), (b, d) = ((ring.context.from_dict({h.monoms()[0]: 1}), h.coeffs()[0]) for h in (f, g))
            common = a.gcd(b)
            rest = f * (b // common) * d - g * (a // common) * c
            factors += [] if rest.is_zero() else [rest]
    return factors


@dataclass(frozen=True, slots=True)
class _SumsOnAxis:
    """Sums of exponentials for large omega, where s = j omega."""

    values: ExponentialValues

    def have_no_root(self, radius: float) -> bool:
        """Tell whether it is proved that not all of them vanish anywhere from a radius on."""
        named = self._generators(radius)
        if named is None:
            return False
        turns, sizes = [], list[_Power]()
        for argument, length in zip(self.values.arguments, map(at_centre, self.values.lengths), strict=True):
            turn, power, unit = named.get(argument.wavenumber, (0, Fraction(0), arb("nan")))
            # With an eighth of a turn mu (a + j b) is mu/sqrt(2) ((a - b) + j (a + b)).
            sizes.append(_Power(power, unit * length / arb(2 if turn == 1 else 1).sqrt()))
            turns.append(turn)
        numbers = {
            name: _Power(power, acb(0, turn * arb.pi() / 4).exp() * unit)
            for name, (turn, power, unit) in named.items()
        }
        sums, base = [], Exponent()
        for (total, _), factors in zip(self.values.sums, self.values.coefficients, strict=True):
            terms = []
            for exponent, amplitude in zip(total.terms, factors, strict=True):
                own = [(i, *((a, b), (a - b, a + b), (-b, a))[turns[i]]) for i, a, b in exponent]
                if any(not sizes[i].unit.is_finite() for i, _, _ in own):
                    return False
                growth = tuple((i, g, 0) for i, g, _ in own if g)
                terms.append((growth, {i: n for i, _, n in own if n}, _summed(amplitude, numbers)))
            fastest = _fastest(terms, sizes, radius)
            if fastest is None:
                return False
            waves: dict[int, acb] = {}
            for phase, size in fastest[0]:
                n = gcd(*phase.values()) * (-1 if min(phase.items(), default=(0, 1))[1] < 0 else 1)
                base = base or tuple((i, x // n, 0) for i, x in phase.items())
                if phase != {i: x * n for i, x, _ in base if n}:
                    return False  # of two phases no limit is known
                waves[n] = waves.get(n, acb(0)) + size
            sums.append((waves, acb(arb(0, fastest[1]), arb(0, fastest[1]))))
        step = 2 * arb.pi() / PHASES
        turned = [acb(0, (step * i).union(step * (i + 1))) for i in range(PHASES)]
        return all(
            any(not sum((c * (x * n).exp() for n, c in waves.items()), e).contains(0) for waves, e in sums)
            for x in turned
        )

    def _generators(self, radius: float) -> dict[str, tuple[int, Fraction, arb]] | None:
        """Return s and wavenumbers far out: eighths of a turn, powers of omega, factors; else None."""
        named = {LAPLACE: (2, Fraction(1), arb(1))}
        kernels = self.values.evaluator
        for law in (law for law in kernels.table.dispersions if law.wavenumbers):
            first = _on_axis(kernels, law.characteristic[0], radius) if law.kind in SINGLE else None
            if first is None:
                return None
            order, power, value = SINGLE[law.kind], first[0], first[1] / (4 if law.kind == "bending" else -1)
            if not (abs(value) > 0 and power > 0):
                return None
            turn = 0 if value > 0 else 4 // order
            named[law.wavenumbers[0]] = (turn, Fraction(power, order), abs(value).root(order))
        return named


def _summed(amplitude: Valued, named: Mapping[str, _Power]) -> dict[Fraction, acb]:
    """Return an amplitude as a sum of powers of s or omega."""
    by_power: dict[Fraction, acb] = {}
    for number, powers in amplitude:
        power, total = Fraction(0), number
        for name, e in powers:
            power, total = power + named[name].power * e, total * named[name].unit ** e
        by_power[power] = by_power.get(power, acb(0)) + total
    return by_power


def _fastest(
    terms: Sequence[tuple[Exponent, dict[int, int], dict[Fraction, acb]]],
    sizes: Sequence[_Power],
    radius: float,
) -> tuple[list[tuple[dict[int, int], acb]], arb] | None:
    """Return sizes of the terms that grow fastest, by phase, and of the others; None without such terms."""

    def rate(growth: Exponent) -> float:
        each = (sizes[i].unit.real * g * arb(radius) ** ball(sizes[i].power) for i, g, _ in growth)
        return float(sum(each, arb(0)).mid())

    fastest = max((growth for growth, _, _ in terms), key=rate)
    highest = max(p for growth, _, factors in terms if growth == fastest for p in factors)

    def bounded(power: Fraction) -> arb:
        value = arb(radius) ** ball(power - highest)
        return arb(0).union(value) if power < highest else value

    dominant, error = [], arb(0)
    for growth, phase, factors in terms:
        faded = _faded(_sum((growth, 1), (fastest, -1)), sizes, arb(radius))
        if faded is None or any(p > highest and not -faded[1] > ball(p - highest) for p in factors):
            return None
        size = sum((c * bounded(p) for p, c in factors.items()), acb(0))
        if growth == fastest:
            dominant.append((phase, size))
        else:
            error += abs(size).upper() * faded[0].upper()
    return dominant, error.upper()


def _on_axis(kernels: KernelValues, value: Factored, radius: float) -> tuple[int, arb] | None:
    """Return a power of omega and what a value is times it from a radius on, None unless it is even in s."""
    leading = _at_infinity(kernels, value, radius)
    parities = [{dict(monomial).get(0, 0) % 2 for monomial, _ in terms_of(f)} for f, _ in value.factors]
    if leading is None or leading[0] % 2 or any(len(own) > 1 for own in parities):
        return None  # each factor is even or odd, and the highest power is even
    return leading[0], leading[1].real * (-1) ** (leading[0] // 2)


@dataclass(frozen=True, slots=True)
class _Dominant:
    """What outweighs all else: over ``exp(exponent) abs(s)^power`` a sum has a least size."""

    exponent: Exponent
    power: Fraction
    lead: acb
    least: arb


def _dominant(terms: Terms, arguments: Sequence[_Power], radius: arb) -> _Dominant | None:
    """Return the term that is larger than all others from a radius on; None without one."""

    def growth(powers: Exponent) -> arb:
        parts = ((arguments[i], acb(a, b)) for i, a, b in powers)
        each = ((own.unit * times).real.mid() * radius ** ball(own.power) for own, times in parts)
        return sum(each, arb(0)).mid()

    def size(powers: Exponent) -> float:
        weight = sum((abs(c).mid() * radius ** ball(p) for p, c in terms[powers].items()), arb(0)).mid()
        return float((growth(powers) + weight.log()).mid()) if weight > 0 else float("-inf")

    chosen = max(terms, key=size)
    own = {p: c for p, c in terms[chosen].items() if abs(c).upper() > 0}
    highest = max(own, default=None)
    if highest is None:
        return None
    lead = own.pop(highest)
    others = _over({**terms, chosen: own}, chosen, highest, arguments, radius)
    if others is None or not others < abs(lead).lower():
        return None
    return _Dominant(chosen, highest, lead, (abs(lead) - others).lower())
