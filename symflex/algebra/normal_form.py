"""Normal form of polynomials in wavenumbers and kernels: equal functions become equal polynomials.

The relations ``sinh^2 = cosh^2 - 1``, ``sin^2 = 1 - cos^2`` and the dispersion relations of the wavenumbers
have coprime leading monomials, so replacing these leaves one form of every residue class (Cox, Little &
O'Shea 2015, chapter 2, sections 6 and 9). The same holds of constants: sine and cosine of one angle, and
square roots of whole numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx

from symflex.algebra.dispersion import Dispersion, KernelTable
from symflex.algebra.factored import Factored, common_denominator
from symflex.algebra.ring import Ring, by_powers, degree_in
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic

TWO_STATES = 2
PAIR_TERMS = 60_000  # terms up to which powers of a pair of wavenumbers are replaced: some seconds


@dataclass(frozen=True, eq=False)
class NormalForm:
    """Reduces modulo the relations of one table."""

    ring: Ring  # where the table's generators and the dispersions' coefficients live
    table: KernelTable  # wavenumbers and kernels

    @cached_property
    def _squares(self) -> tuple[tuple[int, fmpz_mpoly], ...]:
        """Positions of sinh and sin, and of constants, with what their squares are."""
        squares = list(self._squares_of_constants())
        for even, odd in self.table.pairs:
            c = self.ring.generator(even.generator)
            square = c * c - 1 if even.function == "cosh" else 1 - c * c
            squares.append((self.ring.index[odd.generator], square))
        return tuple(squares)

    def _squares_of_constants(self) -> Iterator[tuple[int, fmpz_mpoly]]:
        """Yield what squares of functions of constants are, whose names in the ring are what they mean."""
        for name, i in self.ring.index.items():
            function, bracket, rest = name.partition("(")
            if function == "sin" and bracket and f"cos({rest}" in self.ring.index:
                cos = self.ring.generator(f"cos({rest}")
                yield i, 1 - cos * cos
            elif function == "sqrt" and rest[:-1].isdecimal():
                yield i, self.ring.constant(int(rest[:-1]))

    def reduce(self, polynomial: fmpz_mpoly, *, pairs: bool = True) -> Factored:
        """Return a polynomial in normal form, without ``pairs`` but for relations between two wavenumbers."""
        polynomial = self._without_determinants(self.without_odd_squares(polynomial))
        result = Factored.number(self.ring, 1)
        for dispersion in self.table.dispersions:
            if dispersion.kind == "pair" and not pairs:
                continue
            polynomial, below = self._disperse(polynomial, dispersion)
            result = result / below
        return Factored.polynomial(self.ring, polynomial) * result

    def reduce_factored(self, value: Factored, *, pairs: bool = True) -> Factored:
        """Return a product with every factor, and its powers of wavenumbers, in normal form."""
        return self.balance(value.map_factors(self.ring, lambda f: self.reduce(f, pairs=pairs)))

    def balance(self, value: Factored) -> Factored:
        """Return a product with the powers of single wavenumbers between 0 and their relation's degree."""
        for dispersion in self.table.dispersions:
            degree = {"wave": 2, "bending": 4}.get(dispersion.kind)
            if degree is None:
                continue
            (name,) = dispersion.wavenumbers
            times = value.exponent_of(self.ring.generator(name)) // degree
            if times:
                power = Factored.generator(self.ring, name) ** (-degree * times)
                value = value * power * self.power_of(dispersion) ** times
        return value

    def power_of(self, dispersion: Dispersion) -> Factored:
        """Return ``gamma^2`` or ``mu^4`` as a rational function of s."""
        c0 = dispersion.characteristic[0]
        return -c0 if dispersion.kind == "wave" else c0 / 4

    @cached_property
    def _odd_first(self) -> tuple[fmpz_mpoly_ctx, tuple[tuple[int, fmpz_mpoly], ...]]:
        """The ring with sinh and sin before all else, and the relation of each such kernel."""
        names = self.ring.context.names()
        odd = [names[i] for i, _ in self._squares]
        context = fmpz_mpoly_ctx.get([*odd, *(n for n in names if n not in odd)], Ordering.lex)
        relations = [
            (i, context.gen(k) ** 2 - square.project_to_context(context))
            for k, (i, square) in enumerate(self._squares)
        ]
        return context, tuple(relations)

    def without_odd_squares(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return the polynomial without squares of sinh and sin, by division with these leading."""
        degrees = polynomial.degrees()
        context, relations = self._odd_first
        needed = [relation for i, relation in relations if int(degrees[i]) > 1]
        if not needed:
            return polynomial
        moved = polynomial.project_to_context(context)
        for relation in needed:
            spend()
            _, moved = divmod(moved, relation)
        return moved.project_to_context(self.ring.context)

    @cached_property
    def _determinants(self) -> tuple[tuple[fmpz_mpoly_ctx, fmpz_mpoly, tuple[int, int]], ...]:
        """The relation ``T_00 T_11 - T_01 T_10 = 1`` of every matrix of two states whose law has no trace.

        So it is by Liouville's formula, of rods, shafts and strings that change along x. With it goes a ring
        in which its first product leads, and where the two entries of that stand in this one.
        """
        matrices: dict[tuple[Dispersion, Factored], dict[int, str]] = {}
        for k in self.table.kernels:
            law = k.dispersion
            if k.function == "entry" and law.order == TWO_STATES and law.singular is None:
                matrices.setdefault((law, k.length), {})[k.order] = k.generator
        determinants = []
        for (law, _), entries in matrices.items():
            if len(entries) == TWO_STATES**2 and (law.matrix[0][0] + law.matrix[1][1]).is_zero:
                first, second = entries[0], entries[3]
                rest = [n for n in self.ring.context.names() if n not in (first, second)]
                context = fmpz_mpoly_ctx.get([first, second, *rest], Ordering.lex)
                a, b, c, d = (self.ring.generator(entries[i]).project_to_context(context) for i in range(4))
                place = self.ring.index[first], self.ring.index[second]
                determinants.append((context, a * d - b * c - 1, place))
        return tuple(determinants)

    def _without_determinants(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return the polynomial with 1 in place of determinants that are always 1."""
        for context, relation, place in self._determinants:
            degrees = polynomial.degrees()
            if all(int(degrees[i]) for i in place):
                spend()
                _, rest = divmod(polynomial.project_to_context(context), relation)
                polynomial = rest.project_to_context(self.ring.context)
        return polynomial

    def _disperse(self, polynomial: fmpz_mpoly, dispersion: Dispersion) -> tuple[fmpz_mpoly, Factored]:
        """Return a multiple of the polynomial in normal form, and the factor it was multiplied by."""
        one = Factored.number(self.ring, 1)
        match dispersion.kind:
            case "wave" | "bending":
                degree = 2 if dispersion.kind == "wave" else 4
                index = self.ring.index[dispersion.wavenumbers[0]]
                return with_image(self.ring, polynomial, index, self.power_of(dispersion), degree)
            case "pair":
                return self._pair(polynomial, dispersion)
        return polynomial, one

    def _pair(self, polynomial: fmpz_mpoly, dispersion: Dispersion) -> tuple[fmpz_mpoly, Factored]:
        """Use ``lambda_1^2 = -c_2 - lambda_2^2``, then ``lambda_2^4 = -c_2 lambda_2^2 - c_0``."""
        c0, c2 = dispersion.characteristic[0], dispersion.characteristic[2]
        below = common_denominator(self.ring, (c0, c2))
        d = below.expand()
        n0, n2 = (c0 * below).expand(), (c2 * below).expand()
        first, second = (self.ring.index[w] for w in dispersion.wavenumbers)
        y = self.ring.context.gen(second)
        scale = Factored.number(self.ring, 1)
        highest = int(polynomial.degrees()[first]) // 2
        if highest:
            x = self.ring.context.gen(first)
            image = -n2 - d * y * y
            total = self.ring.constant(0)
            for power, part in by_powers(self.ring, polynomial, first).items():
                total = total + part * x ** (power % 2) * image ** (power // 2) * d ** (highest - power // 2)
            polynomial, scale = total, scale * below**highest
        while (degree := int(polynomial.degrees()[second])) >= 4:  # noqa: PLR2004
            spend()
            if len(polynomial) > PAIR_TERMS:
                message = "the closed form is too large: two wavenumbers depend on too many symbols"
                hint = "give some parameters numbers, or leave out damping, loads or lengths"
                raise BudgetError(Diagnostic("SF502", message, None, hint))
            total = self.ring.constant(0)
            for power, part in by_powers(self.ring, polynomial, second).items():
                if power == degree:
                    total = total - part * (n2 * y ** (power - 2) + n0 * y ** (power - 4))
                else:
                    total = total + part * y**power * d
            polynomial, scale = total, scale * below
        return polynomial, scale


def with_image(
    ring: Ring, polynomial: fmpz_mpoly, i: int, image: Factored, degree: int
) -> tuple[fmpz_mpoly, Factored]:
    """Return a polynomial with an image for a power of generator number i, and what it is divided by."""
    most = degree_in(polynomial, i) // degree
    if not most:
        return polynomial, Factored.number(ring, 1)
    above, below, generator = image.numerator().expand(), image.denominator(), ring.context.gen(i)
    total, scale = ring.constant(0), below.expand()
    for power, part in by_powers(ring, polynomial, i).items():
        spend()
        whole, rest = divmod(power, degree)
        total = total + part * generator**rest * above**whole * scale ** (most - whole)
    return total, below**most
