"""Expressions of wavenumbers, exponentials and local solutions on one forge."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Kernel
from symflex.codegen.program.build import Generators
from symflex.codegen.program.forge import Forge
from symflex.codegen.program.nodes import LargerRoot
from symflex.codegen.program.polynomials import evaluate_polynomial
from symflex.codegen.program.series import LocalBasis, series_length
from symflex.transfer import TransferFunction

if TYPE_CHECKING:
    from symflex.codegen.program.exponents import Family, Key, RealAxis, RealKey, RealSum, RealTerm, Term

MINUS_J = (0, -1)
LEAST = Fraction(1, 2**60)  # part of the root of c_0 below which c_2 does not count
Scales = dict[tuple[int, int], int]  # per family and length, the exponent that is divided out of a sum


@dataclass
class Site:
    """Makes the parts of one piece."""

    forge: Forge  # where expressions are made
    tf: TransferFunction  # with kernels
    families: tuple[Family, ...]  # of its kernels
    # Families of delays whose exponential is greater than one; they are written by its inverse.
    grows: Mapping[int, bool] = field(default_factory=dict)
    # Per family and length, the pairs ``(a, b)`` that occur.
    exponents: Mapping[tuple[int, int], Sequence[tuple[int, int]]] = field(default_factory=dict)
    # Given for real arithmetic: the leaf of s is then the angular frequency, wavenumbers are magnitudes.
    axis: RealAxis | None = None
    # What lengths and coefficients of dispersion relations became, which every term asks for.
    _lengths: dict[Factored, int] = field(default_factory=dict)
    _coefficients: dict[tuple[Dispersion, int], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.ring = self.tf.ratio.ring
        self.waves = {w: d for d in self.tf.kernels.dispersions for w in d.wavenumbers}
        self.kernels = {k.generator: k for k in self.tf.kernels.kernels if k.function == "exp"}
        self._generators = _KernelGenerators(self)

    # ------------------------------------------------------------------------------- rational functions

    def polynomial(self, polynomial: fmpz_mpoly) -> int:
        """Return a polynomial in s, parameters and wavenumbers."""
        images = self._generators.images(self.ring, (polynomial,))
        return evaluate_polynomial(self.forge, polynomial, images)

    def value(self, value: Factored) -> int:
        """Return a rational function; what needs parameters only is divided once."""
        forge = self.forge
        fixed: dict[bool, list[int]] = {True: [], False: []}
        moving: dict[bool, list[int]] = {True: [], False: []}
        for factor, exponent in value.factors:
            part = forge.power(self.polynomial(factor), abs(exponent))
            (moving if forge.depends[part] else fixed)[exponent > 0].append(part)
        gain = forge.divide(
            forge.multiply([forge.constant(value.unit.numerator), *fixed[True]]),
            forge.multiply([forge.constant(value.unit.denominator), *fixed[False]]),
        )
        return forge.divide(forge.multiply([gain, *moving[True]]), forge.multiply(moving[False]))

    # -------------------------------------------------------------------------------------- wavenumbers

    def coefficient(self, dispersion: Dispersion, i: int = 0) -> int:
        """Return ``c_i`` of a dispersion relation."""
        if (dispersion, i) not in self._coefficients:
            given = dispersion.characteristic[i] if self.axis is None else self.axis.coefficient(dispersion)
            self._coefficients[dispersion, i] = self.value(given)
        return self._coefficients[dispersion, i]

    def length(self, length: Factored) -> int:
        """Return a length."""
        if length not in self._lengths:
            self._lengths[length] = self.value(length)
        return self._lengths[length]

    def wavenumber(self, name: str) -> int:
        """Return a wavenumber with nonnegative real part; in real arithmetic its magnitude."""
        forge, law = self.forge, self.waves[name]
        if law.kind == "pair":
            first, second = self._pair(law)
            return first if name == law.wavenumbers[0] else second
        c0 = self.coefficient(law)
        negative = self.axis.sign(law) if self.axis is not None else None
        if self.axis is not None and (parts := self.plain_parts(law)) is not None:
            root = forge.multiply(parts)
            return forge.label(root, "gamma") if law.kind == "wave" else forge.label(self._root(root), "mu")
        if law.kind == "wave":
            square = c0 if negative is False else forge.negate(c0)
            return self.forge.label(self._root(square), "gamma")
        quarter = forge.negate(c0) if negative else forge.multiply([forge.constant(Fraction(1, 4)), c0])
        return self.forge.label(self._root(self._root(quarter)), "mu")

    def plain_parts(self, law: Dispersion) -> tuple[int, int] | None:
        """Return the root of ``-c_0`` (waves) or ``c_0/4`` (bending) as a factor and s, if linear in s."""
        if law.kind not in ("wave", "bending"):
            return None
        c0, s = law.characteristic[0], self.ring.context.gen(0)
        power = c0.exponent_of(s)
        constant = c0.filter(lambda f: f != s) * c0.unit
        if power != 2 or constant.depends_on(LAPLACE):  # noqa: PLR2004
            return None
        if self.axis is None:
            square = -constant if law.kind == "wave" else constant / 4
            return self._root(self.value(square)), self.forge.s
        # Here c_0 has the sign opposite to that of rest.
        negative = self.axis.sign(law)
        square = constant if negative else -constant
        if law.kind == "bending" and not negative:
            square = square / 4
        return self._root(self.value(square)), self.forge.s

    def _pair(self, law: Dispersion) -> tuple[int, int]:
        """Return the square roots of the roots of ``x^2 + c_2 x + c_0``, without cancellation."""
        forge = self.forge
        c0 = self.coefficient(law)
        # Less than a rounding of the result, and not zero where c_2 is.
        least = forge.multiply([forge.constant(LEAST), forge.apply("sqrt", forge.apply("abs", c0))])
        half = forge.multiply([forge.constant(Fraction(-1, 2)), self.coefficient(law, 2)])
        middle = forge.add([half, least])
        ratio = forge.divide(c0, forge.multiply([middle, middle]))
        inside = forge.add([forge.constant(1), forge.negate(ratio)])
        formula = forge.multiply([middle, forge.add([forge.constant(1), self._root(inside)])])
        large = forge.make(LargerRoot, formula, middle, c0)
        first, second = self._root(large), self._root(forge.divide(c0, large))
        return self.forge.label(first, "lambda_1"), self.forge.label(second, "lambda_2")

    def _root(self, x: int) -> int:
        """Return the principal square root; in real arithmetic that of a positive number."""
        if self.axis is not None:
            return self.forge.apply("sqrt", x)
        return self.forge.apply("complex_sqrt", x if self.forge.depends[x] else self.forge.to_complex(x))

    def angle(self, i: int, j: int, factor: int | None = None) -> int:
        """Return a wavenumber times a length, or what a delay's exponential decays with, times a factor."""
        forge, family = self.forge, self.families[i]
        factor = forge.constant(1) if factor is None else factor
        if family.wavenumber:
            wavenumber, _ = self._generators.generator(family.wavenumber)
            return forge.multiply([factor, self.length(family.lengths[j]), wavenumber])
        exponent = self.exponent(family, j)
        return forge.multiply([factor, forge.negate(exponent) if self.grows.get(i) else exponent])

    def exponent(self, family: Family, j: int) -> int:
        """Return the exponent of a delay, with a minus sign."""
        return self.forge.multiply([self.length(family.lengths[j]), self.value(family.dispersion.shift)])

    def sizes(self, dispersion: Dispersion, length: Factored) -> tuple[tuple[int, int, int], ...]:
        """Return pairs, one with s, whose products go like powers of wavenumber times length."""
        forge, x = self.forge, self.length(length)
        negative = self.axis.sign(dispersion) if self.axis is not None else False
        if negative is not None and (parts := self.plain_parts(dispersion)) is not None:
            power = 1 if dispersion.kind == "wave" else 2
            # In real arithmetic the root of a negative c_0 lacks the factor 1/2 of bending.
            half = forge.constant(Fraction(1, 2) if negative and dispersion.kind == "bending" else 1)
            return ((forge.s, forge.multiply([half, forge.power(x, power), parts[0]]), power),)
        one = forge.constant(1)
        if dispersion.kind in ("wave", "bending"):
            return ((self._argument(dispersion, length), one, 2 if dispersion.kind == "wave" else 4),)
        c0 = self.coefficient(dispersion)
        c2 = self.coefficient(dispersion, 2)
        # Each root of x^2 + c_2 x + c_0 is less than 1.62 times a bound of abs(c_2) and sqrt(abs(c_0)).
        return (
            (c2, forge.multiply([forge.constant(Fraction(13, 8)), forge.power(x, 2)]), 2),
            (c0, forge.multiply([forge.constant(Fraction(169, 64)), forge.power(x, 4)]), 4),
        )

    def _argument(self, dispersion: Dispersion, length: Factored) -> int:
        """Return the square of a wave's argument, up to the sign, or the fourth power of one of bending."""
        forge, x, c0 = self.forge, self.length(length), self.coefficient(dispersion)
        if dispersion.kind == "wave":
            return forge.multiply([forge.power(x, 2), c0])
        return forge.multiply([forge.constant(Fraction(1, 4)), forge.power(x, 4), c0])

    def distance(self, dispersion: Dispersion, length: Factored) -> int:
        """Return twice the square of the difference of a pair's arguments where these nearly meet."""
        forge = self.forge
        c0, c2 = self.coefficient(dispersion), self.coefficient(dispersion, 2)
        quotient = forge.divide(forge.multiply([forge.constant(4), c0]), c2)
        return forge.multiply([forge.power(self.length(length), 2), forge.add([c2, forge.negate(quotient)])])

    def decay(self, kernel: Kernel) -> int:
        """Return a decay."""
        exponent = [self.length(kernel.length), self.value(kernel.dispersion.shift)]
        return self.forge.apply("complex_exp", self.forge.negate(self.forge.multiply(exponent)))

    # ------------------------------------------------------------------------------------ local solutions

    def local(self, basis: LocalBasis, dispersion: Dispersion, length: Factored, k: int, size: float) -> int:
        """Return solution k of an equation at a length; a wave's is for a pair's smaller wavenumber."""
        forge, x = self.forge, self.length(length)
        if basis.step == 1:
            e, f = forge.negate(self.coefficient(dispersion, 2)), self.coefficient(dispersion)
            coefficients = []
            for i, polynomial in enumerate(basis.coefficients):
                terms = [
                    forge.multiply([forge.constant(number), forge.power(e, p), forge.power(f, q)])
                    for (p, q), number in sorted(polynomial.items())
                ]
                coefficients.append(forge.multiply([forge.power(x, basis.order - i), forge.add(terms)]))
            solution = forge.solutions(coefficients, series_length(size))[k]
            return forge.multiply([forge.power(x, k), solution])
        if dispersion.kind == "pair":
            wavenumber, _ = self._generators.generator(dispersion.wavenumbers[1])
            argument = forge.multiply([forge.power(x, 2), wavenumber, wavenumber])
        else:
            argument = self._argument(dispersion, length)
            argument = forge.negate(argument) if dispersion.kind == "wave" else argument
        forge.label(argument, "z")
        series = basis.series(k, size)
        total = forge.constant(series[-1])
        for number in reversed(series[:-1]):
            total = forge.add([forge.multiply([total, argument]), forge.constant(number)])
        return forge.multiply([forge.power(x, k), total])

    # ---------------------------------------------------------------------------------- sums of exponentials

    def exponential_sum(self, leaves: Mapping[Key, int], scales: Scales) -> int:
        """Return a sum over its largest exponential; coefficients of circular terms are given halved."""
        used = sorted({i for i, _ in scales})
        images = [(lambda t, i=i: self._term(i, t, scales)) for i in used]
        return self._sum({tuple(k[i] for i in used): v for k, v in leaves.items()}, images)

    def _sum(self, terms: Mapping[tuple[Any, ...], int], images: Sequence[Callable[[Any], int]]) -> int:
        """Return the sum over the first family of terms times what follows; equal ones are added first."""
        if not images:
            return next(iter(terms.values()), self.forge.constant(0))
        inner: dict[Any, dict[tuple[Any, ...], int]] = {}
        for key, value in terms.items():
            inner.setdefault(key[0], {})[key[1:]] = value
        groups: dict[int, list[int]] = {}
        for first, inner_terms in inner.items():
            minus, value = self.forge.signed(self._sum(inner_terms, images[1:]))
            image = images[0](first)
            groups.setdefault(value, []).append(self.forge.negate(image) if minus else image)
        return self.forge.add([self.forge.multiply([v, self.forge.add(ts)]) for v, ts in groups.items()])

    def _term(self, i: int, term: Term, scales: Scales) -> int:
        """Return ``exp(sum((a - scale) q)) cos(sum(b q))``, or the sine; twice that for what oscillates."""
        forge, family = self.forge, self.families[i]
        pairs, parity = term
        shared: list[int] = []
        rising: list[int] = []
        falling: list[int] = []
        for j, (a, b) in enumerate(pairs):
            if (i, j) not in scales:
                continue
            excess = scales[i, j] - (-a if self.grows.get(i) else a)
            if not family.is_circular:
                shared.append(forge.power(self._decay(i, j), excess))
                continue
            # exp((-left + j b) q) from exp((-1 + j) q/2) and exp((-1 - j) q/2), or from those of q.
            # No half angles are needed where all exponents that are left are even combinations.
            is_even = all((scales[i, j] - a + b) % 2 == 0 for a, b in self.exponents.get((i, j), ()))
            step = 1 if is_even else 2
            up, down = self._spirals(i, j, step)
            common = (excess - abs(b)) * step // 2
            shared.append(forge.power(forge.multiply([up, down]), common))
            one, other = (up, down) if b >= 0 else (down, up)
            rising.append(forge.power(one, abs(b) * step))
            falling.append(forge.power(other, abs(b) * step))
        product = forge.multiply(shared)
        if not any(b for _, b in pairs):
            return product
        first, second = forge.multiply(rising), forge.multiply(falling)
        if parity == 0:
            return forge.multiply([forge.add([first, second]), product])
        difference = forge.add([first, forge.negate(second)])
        return forge.multiply([forge.complex_number(*MINUS_J), difference, product])

    def _decay(self, i: int, j: int, step: Fraction = Fraction(1)) -> int:
        forge = self.forge
        exponent = self.angle(i, j, forge.constant(-step))
        function = "exp"
        if self.axis is None:
            function = "complex_exp"
            if not forge.depends[exponent]:
                exponent = forge.to_complex(exponent)
        return self.forge.label(forge.apply(function, exponent), "decay")

    def _spirals(self, i: int, j: int, step: int) -> tuple[int, int]:
        """Return ``exp((-1 + j) q/step)`` and ``exp((-1 - j) q/step)``."""
        # The direction comes last: on the imaginary axis an undamped exponent then stays real or imaginary.
        forge, x, part = self.forge, self.angle(i, j), Fraction(1, step)
        up, down = (
            forge.apply("complex_exp", forge.multiply([forge.complex_number(-part, sign * part), x]))
            for sign in (1, -1)
        )
        return self.forge.label(up, "e_1"), self.forge.label(down, "e_2")

    # --------------------------------------------------------------------------------------- real arithmetic

    def real_sums(self, sums: Sequence[RealSum]) -> tuple[int, ...]:
        """Return sums of real terms, all over the same exponentials, without the factors in front."""
        keys: list[RealKey] = [key for s in sums for key in s.terms]
        scales: dict[tuple[int, int], tuple[Fraction, Fraction, int]] = {}
        for i, family in enumerate(self.families):
            for j in range(len(family.lengths)):
                pairs = [key[i][0][j] for key in keys]
                most = max(a for a, _ in pairs)
                step = _common_step({abs(b) for _, b in pairs} | {most - a for a, _ in pairs})
                scales[i, j] = (most, step, int(max(abs(b) for _, b in pairs) / step))
        images = [(lambda t, i=i: self._real_term(i, t, scales)) for i in range(len(self.families))]
        real = []
        for s in sums:
            real.append(self._sum({key: self.polynomial(p) for key, p in s.terms.items()}, images))
        return tuple(real)

    def _real_term(
        self, i: int, term: RealTerm, scales: Mapping[tuple[int, int], tuple[Fraction, Fraction, int]]
    ) -> int:
        """Return ``exp(sum((a - scale) x))`` times cos or sin of ``sum(b x)``, up to what all terms share."""
        forge = self.forge
        pairs, parity = term
        factors: list[int] = []
        wave: tuple[int, int] | None = None
        for j, (a, b) in enumerate(pairs):
            most, step, highest = scales[i, j]
            if a != most:
                factors.append(forge.power(self._decay(i, j, step), int((most - a) / step)))
            if b:
                even, odd = self._oscillation(i, j, step, int(abs(b) / step))
                turned = (even, odd if b > 0 else forge.negate(odd))
                wave = turned if wave is None else self._turned(wave, turned)
            if missing := highest - int(abs(b) / step):
                factors.append(forge.power(self._half_angle(i, j, step)[2], missing))
        if wave is not None:
            factors.append(wave[parity])
        return forge.multiply(factors)

    def _turned(self, left: tuple[int, int], right: tuple[int, int]) -> tuple[int, int]:
        """Return cosine and sine of the sum of two angles."""
        forge = self.forge
        (c, s), (x, y) = left, right
        return (
            forge.add([forge.multiply([c, x]), forge.negate(forge.multiply([s, y]))]),
            forge.add([forge.multiply([s, x]), forge.multiply([c, y])]),
        )

    def _half_angle(self, i: int, j: int, step: Fraction) -> tuple[int, int, int]:
        """Return cosine, sine and one, all times one plus the square of the tangent of half the angle."""
        forge = self.forge
        one, two = forge.constant(1), forge.constant(2)
        t = self.forge.label(forge.apply("tan", self.angle(i, j, forge.constant(step / 2))), "t_half")
        square = forge.multiply([t, t])
        return (forge.add([one, forge.negate(square)]), forge.multiply([two, t]), forge.add([one, square]))

    def _oscillation(self, i: int, j: int, step: Fraction, multiple: int) -> tuple[int, int]:
        """Return cosine and sine of a multiple of an angle, times that power of the same factor."""
        even, odd, _ = self._half_angle(i, j, step)
        pair = first = (even, odd)
        for _ in range(multiple - 1):
            pair = self._turned(pair, first)
        return pair


def _common_step(values: set[Fraction]) -> Fraction:
    """Return the largest number of which all are multiples; 1 when all are zero."""
    present = [v for v in values if v]
    if not present:
        return Fraction(1)
    below = lcm(*(v.denominator for v in present))
    return Fraction(gcd(*(int(v * below) for v in present)), below)


class _KernelGenerators(Generators):
    """Generators with wavenumbers and decays among them."""

    def __init__(self, site: Site) -> None:
        super().__init__(site.forge, site.tf, is_far=False)
        self.site = site

    def _make(self, name: str) -> tuple[int, int]:
        if name in self.site.waves:
            return self.site.wavenumber(name), 1
        if name in self.site.kernels:
            return self.site.decay(self.site.kernels[name]), 1
        return super()._make(name)
