"""The part of a numerator or denominator that contains kernels, as a function of s.

Input: a bound transfer function and a product of factors over its ring.
Output: a :class:`KernelFunction`, evaluated with its logarithmic derivative at any precision.

How far its argument may turn on a step is read off the ball that holds its values there: a ball of radius 1
about 2 is seen from 0 at 30 degrees on both sides of its middle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, lru_cache
from math import asin, exp, inf, lcm, pi
from typing import Final

from flint import acb, acb_series, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, KernelTable, degree_in
from symflex.algebra.exponential_sum import REAL, Exponent, combination
from symflex.algebra.vanishing import OriginSeries
from symflex.balls import Value, at_centre, expansion, precision, precisions
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError
from symflex.model.model import IMAGINARY
from symflex.roots.functions.entire import FactorBall, Sample
from symflex.roots.functions.exponential_values import ExponentialValues, Place, Summed, exponential_sums
from symflex.roots.functions.reversal import is_reversed
from symflex.roots.problem import is_complex
from symflex.transfer import BoundTransferFunction
from symflex.transfer.enclose_kernels import KernelValues

FIRST_BITS = 64  # first precision of values; more if it does not suffice
LAST_BITS = 4096  # largest precision: a value that is not settled with it is at a root
SETTLED_BITS = 24  # accuracy asked of every factor before its sign, phase or slope is used
ORIGIN = -140.0  # ln(abs(s)) where the order of a root at 0 is read off
SERIES_TERMS = (20, 80)  # lengths of the series about 0 in which the first term is sought
BRANCH_BITS = 256  # precision of one value that is compared on all branches
ANYWHERE = (0.7, 1.3)  # real and imaginary part of a frequency like any other
BRANCHES = (1, 2, 4)  # powers in which a wavenumber's branch may cease to matter; four roots have no other
SINGLE: Final = {"wave": 2, "bending": 4}  # dispersions of one wavenumber, and how many branches it has
TWINS: Final = {"cosh": "cos", "cos": "cosh", "sinh": "sin", "sin": "sinh"}
# What is known of a function whatever the numbers are.
FORM = frozenset(
    ("cancels", "exponentials", "is_central", "is_even", "is_mirrored", "is_real", "is_real_on_axis")
)
MODAL_WORK = 0.15  # what sums over characteristic roots cost, in terms, over the order to the fourth


@dataclass(eq=False)
class KernelFunction:
    """A product of powers of polynomials in s, wavenumbers and kernels; ``part**power`` has one value."""

    bound: BoundTransferFunction  # whose ring and kernels they are
    part: Factored  # factors of s, of wavenumbers and of kernels; entire together
    like: KernelFunction | None = field(
        default=None, repr=False
    )  # with other numbers for the ring's constants
    power: int = field(default=1, init=False)
    work: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self._bits = FIRST_BITS
        laws = self.bound.kernels.dispersions
        terms = sum(len(f) for f, _ in self.part.factors) + 2 * len(self.bound.kernels.kernels)
        self._cost = terms + int(MODAL_WORK * sum(law.order**4 for law in laws if law.kind == "general"))
        self._values = lru_cache(maxsize=None)(self._kernel_values)
        self._sums = lru_cache(maxsize=None)(self._exponential_values)
        if self.like is None:
            self.part, self.power = self._of_one_value()
        else:
            self.part, self.power = self.like.part, self.like.power
            vars(self).update({name: x for name, x in vars(self.like).items() if name in FORM})

    @cached_property
    def is_even(self) -> bool:
        """Proved: F(-s) is F(s) or -F(s), so that roots mirror each other in the imaginary axis too."""
        return self.is_real and self.is_central

    @cached_property
    def is_central(self) -> bool:
        """Proved: F(-s) is F(s) or -F(s), so that -s is a root if s is."""
        used = (k for k in self.bound.kernels.kernels if self.part.depends_on(k.generator))
        is_alike = self._turns_round_with(LAPLACE) and not any(kernel.function == "exp" for kernel in used)
        return is_alike or (self.is_real and self.is_real_on_axis)

    @property
    def is_paired(self) -> bool:
        """Whether the roots of one half-plane follow from those of the other."""
        return self.is_real or self.is_central

    @cached_property
    def is_real_on_axis(self) -> bool:
        """Proved: F is real on the imaginary axis, or j times that, so that roots mirror each other in it.

        That is so where s and j, both with another sign, leave F but for a sign.
        """
        used = (k for k in self.bound.kernels.kernels if self.part.depends_on(k.generator))
        is_alike = self._turns_round_with(LAPLACE, IMAGINARY) and not any(k.function == "exp" for k in used)
        return is_alike or is_reversed(self.part, self.bound.kernels)

    @cached_property
    def is_mirrored(self) -> bool:
        """Proved: F(-s) is F(s) or -F(s) times an exponential, as of ``1 + exp(-2 s)``, so that roots do."""
        return self.is_real and (self.is_central or self._turns_round_with(LAPLACE))

    @cached_property
    def is_real(self) -> bool:
        """F is real on the real axis, so that roots mirror each other in it: no coefficient holds j."""
        laws = [law for law in self.bound.kernels.dispersions if self._uses(law)]
        return not any(map(is_complex, (self.part, *(c for law in laws for c in law.coefficients))))

    def _uses(self, law: Dispersion) -> bool:
        names = (*law.wavenumbers, *(k.generator for k in self.bound.kernels.kernels_of(law)))
        return any(self.part.depends_on(name) for name in names)

    def _turns_round_with(self, *names: str) -> bool:
        """Tell whether F stays as it is, but for a sign, if s, or s and j, have the other sign."""
        turning = [i for name, i in self.part.ring.index.items() if name in names]
        kernels = [k for k in self.bound.kernels.kernels if self.part.depends_on(k.generator)]
        # Another part's dispersion relation may be lopsided.
        laws = [law for law in self.bound.kernels.dispersions if self._uses(law)]
        decays = [k for k in kernels if k.function == "exp"]
        odd = [k.dispersion.shift for k in decays if not (k.wavenumber or k.length.depends_on("s"))]
        even = [value for law in laws for value in law.coefficients if value is not law.shift]
        places = [self.part.ring.index[k.generator] for k in decays]
        signs = [
            ([_parity(f, turning) for f, _ in v.factors], [e for _, e in v.factors]) for v in (*odd, *even)
        ]
        return (
            len(odd) == len(decays)
            and all(_turned(f, turning, places) in (f, -f) for f, _ in self.part.factors)
            and all(None not in parities for parities, _ in signs)
            and [sum((p or 0) * e for p, e in zip(*s, strict=True)) % 2 for s in signs]
            == [1] * len(odd) + [0] * len(even)
        )

    def order(self) -> int | None:
        """Return how often s = 0 is a root of F to the :attr:`power` that makes it one function, or None."""
        table = self.bound.kernels
        for terms in SERIES_TERMS:
            order = OriginSeries(self.part.ring, table, terms=terms).order(self.part**self.power)
            if order is None and any(law.matrix for law in table.dispersions):
                order = self._leading(terms)
            if order is not None:
                return order
        return None

    def _leading(self, terms: int) -> int | None:
        """Return the same, where the first of so many terms about 0 are exactly zero."""
        with precision(2 * FIRST_BITS):
            evaluator = self.bound.kernel_values()
            value = evaluator.value(self.part**self.power, evaluator.at(acb_series([0, 1], terms)))
            coefficients = value.coeffs() if isinstance(value, acb_series) else []
            first = next((c for c in enumerate(coefficients) if c[1] != 0), None)
            return None if first is None or first[1].contains(0) else first[0]

    @property
    def is_negated(self) -> bool:
        """True when a minus sign stands in front of the factors."""
        return self.part.unit < 0

    @cached_property
    def cancels(self) -> bool:
        """Some kernels are sums over nameless roots, or products of entries cancel: by e^(2 L)."""
        ring, kernels = self.part.ring, self.bound.kernels.kernels
        if any(k.function == "fundamental" and self.part.depends_on(k.generator) for k in kernels):
            return True
        along: dict[str, list[int]] = {}
        for k in kernels:
            if k.function == "entry":
                along.setdefault(k.dispersion.name, []).append(ring.index[k.generator])
        monomials = [powers for factor, _ in self.part.factors for powers in factor.monoms()]
        return any(sum(powers[i] for i in places) > 1 for places in along.values() for powers in monomials)

    def at_logarithm(self, z: complex) -> Sample | None:
        """Return the sample at ``s = exp(z)``, with the slope in z; ``None`` on a root."""
        settled = self._settled(lambda: acb(z.real, z.imag).exp())
        return None if settled is None else self._sample(*settled)

    def at_point(self, s: acb) -> Sample | None:
        """Return the sample at an exact ``s``, with the slope in ln(s)."""
        settled = self._settled(lambda: s)
        return None if settled is None else self._sample(*settled)

    def order_at_zero(self) -> float:
        """Return the order of the root at s = 0, close to an integer; NaN when it is not found."""
        sample = self.at_logarithm(complex(ORIGIN, 0.0))
        return float("nan") if sample is None else sample.slope.real

    def enclosed(self, s: acb, bits: int) -> list[FactorBall]:
        """Return balls around value and derivative of every factor on a ball ``s``."""
        with precision(bits):
            return self._factors(s, bits)

    def enclosed_about(self, ball: acb, centre: acb, bits: int) -> list[FactorBall]:
        """Return balls around values at a point, and derivatives on a ball that contains it: one branch."""
        self._spend(bits)
        with precision(bits):
            values = self._evaluator(bits)
            wide = values.at(expansion(ball))
            exact = values.at(centre, wide)
            return [
                (at_centre(values.value(i, exact)), series[1], exponent)
                for i, (_, exponent) in enumerate(self.part.factors)
                if isinstance(series := values.value(i, wide), acb_series)
            ]

    def value(self, s: acb, bits: int) -> acb:
        """Return a ball around F, to the :attr:`power` that makes it one function, on a ball ``s``."""
        self._spend(bits)
        total = acb(1)
        with precision(bits):
            values = self._evaluator(bits)
            place = values.at(s)
            for i, (_, exponent) in enumerate(self.part.factors):
                total *= at_centre(values.value(i, place)) ** (exponent * self.power)
        return total

    def is_analytic_on(self, disc: acb, bits: int) -> bool:
        """Tell whether no law of waves has a pole on a ball, as far as its coefficients show there."""
        with precision(bits):
            evaluator = self._values(bits)
            values: dict[str, Value] = {"s": disc, **{n: acb(c) for n, c in evaluator.constants.items()}}
            laws = [v for law in evaluator.table.dispersions for v in (*law.characteristic, law.shift)]
            laws += [x for law in evaluator.table.dispersions for x in divisors_in_s(law)]
            return all(at_centre(evaluator.value(value, values)).is_finite() for value in laws)

    def turn_of_exponentials(self, ball: acb, start: acb, end: acb, bits: int) -> tuple[float, arb] | None:
        """Return how far arg F turns between any points of a ball, and between two; ``None`` if not a sum."""
        if self.exponentials is None:
            return None
        self._spend(bits)
        sums = self._sums(bits)
        around = sums.at(ball)
        first, last = sums.at(start, around), sums.at(end, around)
        total, widest = arb(0), 0.0
        for i, (terms, exponent) in enumerate(sums.sums):
            largest = sums.largest([i], around) if len(terms.terms) > 1 else next(iter(terms.terms), REAL)
            widest = max(widest, deviation(at_centre(sums.value(i, around, largest))))
            if widest > ROOM:
                return widest, total
            ratio = at_centre(sums.value(i, last, largest)) / at_centre(sums.value(i, first, largest))
            factors = combination(largest)
            own = [place.combined(factors) for place in (first, last)]
            if own[0] is not None and own[1] is not None:
                total += exponent * at_centre(own[1] - own[0]).imag
            total += exponent * ratio.arg()
        return widest, total * self.power

    def _exponential_values(self, bits: int) -> ExponentialValues:
        return ExponentialValues(self._values(bits), *(self.exponentials or ((), ())))

    @cached_property
    def exponentials(self) -> Summed | None:
        """The factors as sums of exponentials, where all wavenumbers have formulas and the sums are short."""
        return exponential_sums(self.part, self.bound.kernels)

    def _anywhere(self) -> tuple[int, dict[str, Value], acb]:
        """Return a precision, the generators' values at a frequency like any other, and the product's."""
        bits = BRANCH_BITS if self.bound.kernels.wavenumbers else 2 * FIRST_BITS
        while bits <= LAST_BITS:
            with precision(bits):
                evaluator = self._values(bits)
                values = evaluator.at(acb(*ANYWHERE))
                value = at_centre(evaluator.value(self.part, values))
            if value.is_finite() and value.rel_accuracy_bits() >= FIRST_BITS:
                return bits, values, value
            bits *= 4
        message = f"a part of {self.bound.name} is 0/0 or 0 at every s for these values"
        hint = "write a rigid or massless limit as a model of its own"
        raise ModelError(Diagnostic("SF231", message, None, hint))

    def _of_one_value(self) -> tuple[Factored, int]:
        """Return the product without what changes with wavenumbers' branches, and a power of one value."""
        part, order = self.part, 1
        bits, values, value = self._anywhere()
        with precision(bits):
            for law in self.bound.kernels.dispersions:
                for other in other_branches(law, self.bound.kernels, values):
                    turned = at_centre(self._values(bits).value(self.part, {**values, **other})) / value
                    if law.kind in SINGLE:
                        step = acb(0, 1) if law.kind == "bending" else acb(-1)
                        powers = range(SINGLE[law.kind])
                        power = next((k for k in powers if (turned - step**k).contains(0)), 0)
                        if power:
                            part = part * Factored.generator(part.ring, law.wavenumbers[0]) ** -power
                            turned = turned / step**power
                    turns = next((n for n in BRANCHES if (turned**n - 1).contains(0)), None)
                    if turns is None or not turned.rel_accuracy_bits() >= SETTLED_BITS:
                        message = f"a part of {self.bound.name} has no value of its own for every s"
                        raise UncertifiedError(Diagnostic("SF404", message))
                    order = lcm(order, turns)
        return part, order

    def reach(self, s: float) -> float:
        """Return the largest kernel argument, in absolute value, at a positive ``s``."""
        with precision(FIRST_BITS):
            evaluator = self._values(FIRST_BITS)
            values = evaluator.at(acb(s))
            sizes = []
            for kernel in self.bound.kernels.kernels:
                law, length = kernel.dispersion, at_centre(evaluator.value(kernel.length, values))
                if kernel.function == "exp":
                    rate = at_centre(evaluator.value(law.shift, values))
                elif kernel.function == "entry" and evaluator.matrices is not None:
                    sizes.append(arb(evaluator.matrices.reach(kernel.dispersion, kernel.length, acb(s))))
                    continue
                else:
                    rate = acb("nan")
                    if kernel.function != "fundamental":
                        rate = at_centre(values[kernel.wavenumber])
                    if not rate.is_finite():  # two wavenumbers are too close together, or there are none
                        given = [at_centre(evaluator.value(c, values)) for c in law.characteristic]
                        rate = _spectral_size(given)
                sizes.append(abs(rate * length).mid())
            return max((float(size) if size.is_finite() else 0.0 for size in sizes), default=0.0)

    def frequency_of(self, waves: float) -> float:
        """Return a frequency at which the largest argument of a kernel has a given size [rad/s]."""
        low, high = -60.0, 60.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if self.reach(exp(middle)) < waves else (low, middle)
        return exp(high)

    def _sample(self, factors: list[tuple[acb, acb, int]], s: acb) -> Sample:
        total, slope = 0j, 0j
        for value, derivative, exponent in factors:
            middle = value.mid()
            total += exponent * complex(float(abs(middle).log()), float(middle.arg()))
            slope += exponent * complex(s * derivative / value)
        return Sample(self.power * total, self.power * slope)

    def _settled(self, point: Callable[[], acb]) -> tuple[list[tuple[acb, acb, int]], acb] | None:
        for bits in precisions(self._bits, LAST_BITS):
            with precision(bits):
                s = point()
                factors = self._factors(s, bits)
                if any(f == 0 for f, _, _ in factors):
                    return None
                if all(f.rel_accuracy_bits() >= SETTLED_BITS and d.is_finite() for f, d, _ in factors):
                    # Where terms cancel at one place they do at others; next to a root alone they do more.
                    self._bits = max(self._bits, min(bits, 2 * FIRST_BITS))
                    return factors, s
        return None

    def _spend(self, bits: int) -> None:
        spend()
        self.work += self._cost * max(1, bits // (2 * FIRST_BITS))

    def _factors(self, s: acb, bits: int) -> list[FactorBall]:
        """Return value, derivative and exponent of every factor, at the current precision."""
        self._spend(bits)
        values = self._evaluator(bits)
        place = values.at(expansion(s))
        return [
            (series[0], series[1], exponent)
            for i, (_, exponent) in enumerate(self.part.factors)
            if isinstance(series := values.value(i, place), acb_series)
        ]

    def _evaluator(self, bits: int) -> ExponentialValues | KernelFactors:
        """Return what evaluates the factors: as sums of exponentials where they are."""
        if self.exponentials is not None:
            return self._sums(bits)
        return KernelFactors(self._values(bits), [factor for factor, _ in self.part.factors])

    def _kernel_values(self, bits: int) -> KernelValues:
        with precision(bits):
            return self.bound.kernel_values()


@dataclass(frozen=True, slots=True)
class KernelFactors:
    """Polynomials in kernels, evaluated as they stand, as :class:`ExponentialValues` does sums."""

    evaluator: KernelValues
    factors: Sequence[fmpz_mpoly]

    def at(self, s: Value, near: Place | None = None) -> Place:
        """Return the values of the generators, of the branch that others have."""
        return Place(self.evaluator.at(s, None if near is None else near.values), ())

    def value(self, number: int, place: Place, less: Exponent = REAL) -> Value:
        """Return the value of one polynomial; no exponential is taken out."""
        del less
        return self.evaluator.polynomial(self.factors[number], place.values)

    def largest(self, numbers: Iterable[int], place: Place) -> Exponent:
        """Return that there is no exponential."""
        del numbers, place
        return REAL


def other_branches(
    law: Dispersion, table: KernelTable, values: Mapping[str, Value]
) -> list[dict[str, Value]]:
    """Return the values of wavenumbers and kernels with another root of the dispersion relation chosen."""
    kernels = table.kernels_of(law)
    named = [k for k in kernels if k.wavenumber]
    known: dict[tuple[str, str, int], Value] = {
        (k.wavenumber, k.function, id(k.length)): values[k.generator] for k in named
    }
    turn = acb(0, 1) if law.kind == "bending" else acb(-1)
    branches: list[dict[str, Value]] = []
    for wavenumber in law.wavenumbers:
        branch: dict[str, Value] = {wavenumber: turn * values[wavenumber]}
        for k in (k for k in kernels if k.wavenumber == wavenumber):
            twin = TWINS[k.function] if law.kind == "bending" else k.function
            source = known.get((wavenumber, twin, id(k.length)), values[k.generator])
            branch[k.generator] = turn * source if k.function in ("sinh", "sin") else source
        branches.append(branch)
    if len(law.wavenumbers) > 1:
        first, second = law.wavenumbers
        branch = {first: values[second], second: values[first]}
        for k in kernels:
            other = second if k.wavenumber == first else first
            branch[k.generator] = known.get((other, k.function, id(k.length)), values[k.generator])
        branches.append(branch)
    return branches


def _parity(polynomial: fmpz_mpoly, turning: Sequence[int]) -> int | None:
    """Return whether all powers of s, or of s and j, are even (0) or odd (1), ``None`` when neither."""
    parities = {sum(int(monomial[i]) for i in turning) % 2 for monomial in polynomial.monoms()}
    return parities.pop() if len(parities) == 1 else None


def _turned(polynomial: fmpz_mpoly, turning: Sequence[int], decays: Sequence[int]) -> fmpz_mpoly:
    """Return a polynomial at -s, times exponentials: decays at some places are one over themselves there."""
    terms = [(list(map(int, monomial)), c) for monomial, c in polynomial.terms()]
    ends = {i: max(m[i] for m, _ in terms) + min(m[i] for m, _ in terms) for i in decays}
    turned = {
        tuple(ends[i] - e if i in ends else e for i, e in enumerate(m)): (-1) ** sum(m[i] for i in turning)
        * c
        for m, c in terms
    }
    return polynomial.context().from_dict(turned)


def divisors_in_s(law: Dispersion) -> list[Factored]:
    """Return one over what coefficients that vary along x are divided by, as far as that depends on s."""
    return [
        Factored(x.ring, Fraction(1), tuple((f, e) for f, e in x.factors if e < 0 and degree_in(f, 0)))
        for row in law.matrix
        for x in row
        if any(e < 0 and degree_in(f, 0) for f, e in x.factors)
    ]


def _spectral_size(coefficients: Sequence[acb]) -> acb:
    """Return about the size of the largest root of a characteristic polynomial."""
    sizes = zip(range(len(coefficients), 0, -1), (abs(c).mid() for c in coefficients), strict=True)
    return acb(max((size.root(n) for n, size in sizes if size > 0), key=float, default=arb(0)))


def split_off_kernels(value: Factored, table: KernelTable) -> tuple[Factored, Factored]:
    """Return the factors with s alone, and the product of those that contain wavenumbers or kernels."""
    ring = value.ring
    varying = [0] + [
        ring.index[name]
        for law in table.dispersions
        if any(c.depends_on(ring.names[0]) for c in law.coefficients)
        for name in (*law.wavenumbers, *(k.generator for k in table.kernels_of(law)))
    ]
    bare = {str(ring.generator(k.generator)) for k in table.kernels if k.function == "exp"}
    plain, mixed = [], []
    for factor, exponent in value.factors:
        if ring.used_in([factor]).isdisjoint(table.generators):
            plain.append((factor, exponent))
        elif str(factor) not in bare and any(degree_in(factor, i) for i in varying):
            mixed.append((factor, exponent))
    return Factored(ring, Fraction(1), tuple(plain)), Factored(ring, Fraction(1), tuple(mixed))


def has_kernels(value: Factored, table: KernelTable) -> bool:
    """Tell whether a product has a factor with a kernel, not only powers of wavenumbers."""
    used = value.ring.used_in(f for f, e in value.factors if e > 0)
    return any(k.generator in used for k in table.kernels)


ROOM = 1.5  # largest deviation of the argument [rad] from the middle to an end of a step; less than pi/2


def deviation(values: acb) -> float:
    """Return how far the argument may turn from the middle of a ball [rad], infinite if not known."""
    if not values.is_finite():
        return inf
    middle = values.mid()
    room = middle.abs_lower()
    return angle((values - middle).abs_upper(), room) if room > 0 else inf


def angle(off: arb, size: arb) -> float:
    """Return half the angle [rad] at which a disc of radius ``off``, so far from 0, is seen from there."""
    share = float((off / size).upper())
    return asin(share) if share < 1 else share * pi / 2
