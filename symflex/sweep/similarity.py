"""When a transfer function is, at two points, one function of s up to a scale of s.

A uniform beam has the same characteristic function of its wavenumber whatever its dimensions are: all roots
of one such beam are those of another times one factor. Lengths are counted in the first kernel's, frequencies
in what makes the first dispersion relation's leading coefficient one; what is left are ratios without
dimension. Where all of them are equal, exactly, the functions are similar.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import fmpq, fmpz_mpoly

from symflex.algebra import Factored, degree_in
from symflex.model import ExactValue
from symflex.transfer import TransferFunction

KERNELS = ("cosh", "sinh", "cos", "sin")
PI = "pi"

Key = tuple[object, ...]


@dataclass(frozen=True, slots=True)
class Similarity:
    """Which functions a function is similar to, and its scale of s."""

    key: Key  # equal, and of the same ``degree``, for similar functions
    # The n-th power of the scale [rad/s]: roots divided by the scale are those of all similar functions.
    scale: fmpq
    degree: int  # n


@dataclass(frozen=True, slots=True)
class _Term:
    """One term of a polynomial: exponents of what varies, of the parameters, and its coefficient."""

    varying: tuple[int, ...]
    parameters: tuple[tuple[str, int], ...]
    coefficient: int


@dataclass(frozen=True, slots=True)
class _Product:
    """A rational function: its unit, and the numbers of its polynomials with their exponents."""

    unit: fmpq
    factors: tuple[tuple[int, int], ...]


class Similarities:
    """Finds the similarity of a transfer function, with symbols, at points.

    Lumped systems have none, nor those with delays, waves without a formula, or functions of constants; that
    their frequencies could be scaled is not looked for.
    """

    def __init__(self, tf: TransferFunction) -> None:
        table, ring = tf.kernels, tf.ratio.ring
        constants = [ring.index[c.generator] for c in tf.constants if c.generator in ring.index]
        self._is_possible = (
            bool(table.kernels)
            and all(kernel.function in KERNELS for kernel in table.kernels)
            and not tf.ratio.is_zero
        )
        if not self._is_possible:
            return
        self._varying = (0, ring.index[PI], *(ring.index[name] for name in table.generators))
        self._waves = len(table.wavenumbers)
        self._numbers: dict[str, int] = {}
        self._polynomials: list[tuple[_Term, ...]] = []
        self._names = ring.names
        self._laws = [(law.kind, law.order, len(law.characteristic)) for law in table.dispersions]
        parts = (tf.num, tf.den)
        hidden = [h.polynomial for h in tf.hidden]
        values = [value for law in table.dispersions for value in (*law.characteristic, law.shift)]
        lengths = [kernel.length for kernel in table.kernels]
        polynomials = [f for value in (*parts, *values, *lengths) for f, _ in value.factors] + hidden
        self._is_possible = not any(degree_in(f, i) for f in polynomials for i in constants)
        self._parts = [self._product(part) for part in parts]
        self._hidden = [(self._numbered(h.polynomial), h.multiplicity) for h in tf.hidden]
        self._values = [self._product(value) for value in values]
        self._lengths = [self._product(value) for value in lengths]
        first = table.kernels[0].dispersion
        place = next(i for i, law in enumerate(table.dispersions) if law is first)
        self._leading = sum(count + 1 for _, _, count in self._laws[:place])
        self._order = first.order

    def at(self, values: Mapping[str, ExactValue]) -> Similarity | None:
        """Return the similarity at a point, ``None`` if the function has no such scale."""
        if not self._is_possible:
            return None
        point = _Point(values, self._waves, self._polynomials)
        length = point.number(self._lengths[0])
        leading = point.leading(self._values[self._leading])
        if length is None or length == 0 or leading is None:
            return None
        coefficient, degree = leading
        point.set_units(length, 1 / (abs(coefficient) * abs(length) ** self._order), degree)
        orders = [
            power for _, order, count in self._laws for power in (*(order - i for i in range(count)), 1)
        ]
        try:
            key = (
                degree,
                tuple(point.product(part) for part in self._parts),
                tuple((point.polynomial(number), times) for number, times in self._hidden),
                tuple(point.value(v, order) for v, order in zip(self._values, orders, strict=True)),
                tuple(point.value(v, -1) for v in self._lengths),
            )
        except ZeroDivisionError:
            return None  # something vanishes here, and the function is another
        return Similarity(key, point.scale, degree)

    def _product(self, value: Factored) -> _Product:
        unit = fmpq(value.unit.numerator, value.unit.denominator)
        return _Product(unit, tuple((self._numbered(f), e) for f, e in value.factors))

    def _numbered(self, polynomial: fmpz_mpoly) -> int:
        """Return the number of a polynomial, the same for equal ones."""
        varying, name = set(self._varying), str(polynomial)
        if name not in self._numbers:
            self._numbers[name] = len(self._polynomials)
            terms = (
                _Term(
                    tuple(int(monomial[i]) for i in self._varying),
                    tuple((self._names[i], int(e)) for i, e in enumerate(monomial) if e and i not in varying),
                    int(coefficient),
                )
                for monomial, coefficient in polynomial.terms()
            )
            self._polynomials.append(tuple(terms))
        return self._numbers[name]


class _Point:
    """Writes coefficients without dimension: their signs, and the n-th powers of their absolute values."""

    def __init__(
        self, values: Mapping[str, ExactValue], waves: int, polynomials: Sequence[tuple[_Term, ...]]
    ) -> None:
        self._values = {
            name: (fmpq(value.rational.numerator, value.rational.denominator), value.pi_power)
            for name, value in values.items()
        }
        self._waves, self._polynomials = waves, polynomials
        self._images: dict[int, list[tuple[tuple[int, ...], fmpq]]] = {}
        self.scale, self._length, self._degree = fmpq(1), fmpq(1), 1

    def set_units(self, length: fmpq, scale: fmpq, degree: int) -> None:
        """Say what lengths and frequencies are counted in."""
        self._length, self.scale, self._degree = abs(length), scale, degree

    def number(self, value: _Product) -> fmpq | None:
        """Return a value that is a rational number."""
        result = value.unit
        for place, power in value.factors:
            image = self._image(place)
            if len(image) != 1 or any(image[0][0]):
                return None
            result *= image[0][1] ** power
        return result

    def leading(self, value: _Product) -> tuple[fmpq, int] | None:
        """Return coefficient and exponent of the lowest power of s; ``None`` without a power of s."""
        coefficient, exponent = value.unit, 0
        for place, power in value.factors:
            image = self._image(place)
            if not image:
                return None
            monomial, number = min(image, key=lambda term: term[0][0])
            if any(monomial[1:]):
                return None
            coefficient *= number**power
            exponent += monomial[0] * power
        return (coefficient, exponent) if coefficient != 0 and exponent > 0 else None

    def product(self, value: _Product) -> Key:
        """Return a product up to a constant factor."""
        return tuple((self.polynomial(place), power) for place, power in value.factors)

    def value(self, value: _Product, lengths: int) -> Key:
        """Return a value that is measured in a power of 1/length, exactly."""
        n = self._degree
        if value.unit == 0:
            return (0,)
        sign = 1 if value.unit > 0 else -1
        size = abs(value.unit) ** n * self._length ** (n * lengths)
        for place, power in value.factors:
            image = self._image(place)
            if not image:
                raise ZeroDivisionError
            own, first = self._measured(*image[0])
            size *= first**power
            sign *= own**power
        return (sign, str(size), self.product(value))

    def polynomial(self, place: int) -> Key:
        """Return a polynomial up to a constant factor."""
        image = self._image(place)
        if not image:
            raise ZeroDivisionError
        if len(image) == 1:
            return (image[0][0],)
        sign, size = self._measured(*image[0])
        key: list[object] = [image[0][0]]
        for monomial, number in image[1:]:
            own, power = self._measured(monomial, number)
            key.append((monomial, own * sign, str(power / size)))
        return tuple(key)

    def _measured(self, monomial: tuple[int, ...], number: fmpq) -> tuple[int, fmpq]:
        n, waves = self._degree, sum(monomial[2 : 2 + self._waves])
        size = abs(number) ** n * self.scale ** monomial[0]
        return (1 if number > 0 else -1), size / self._length ** (n * waves) if waves else size

    def _image(self, place: int) -> list[tuple[tuple[int, ...], fmpq]]:
        """Return a polynomial with numbers for its parameters."""
        with_numbers = self._images.get(place)
        if with_numbers is not None:
            return with_numbers
        collected: dict[tuple[int, ...], fmpq] = {}
        for term in self._polynomials[place]:
            number, turns = fmpq(term.coefficient), 0
            for name, exponent in term.parameters:
                value, power = self._values[name]
                number *= value**exponent
                turns += power * exponent
            powers = term.varying
            if turns:
                powers = (powers[0], powers[1] + turns, *powers[2:])
            collected[powers] = collected[powers] + number if powers in collected else number
        image = [(powers, number) for powers, number in sorted(collected.items()) if number != 0]
        self._images[place] = image
        return image
