"""Exact values as JSON data, and back: rings, polynomials, products of powers, tables of kernels.

What is shared is written once and shared again when read, because dispersions are told apart by identity.
Everything read is checked, so that a file holds values of these kinds or is refused.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast, get_args

from symflex.kernels import NO_KERNELS, Factored, KernelTable, Ring
from symflex.kernels.dispersion import Dispersion, DispersionKind, Kernel, KernelFunction
from symflex.kernels.ring import DEGREE_LIMIT

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import fmpz_mpoly

Data = dict[str, list[Any]]
"""What :meth:`Writer.data` returns: JSON data."""

_T = TypeVar("_T")

SMALL: Final = 2**53
"""Integers below stand as numbers, others as hexadecimal text, which takes linear time to read."""
EXPONENT_LIMIT: Final = 2**31
GENERATOR_LIMIT: Final = 10_000


class Writer:
    """Collects exact values; every method returns the position of its argument among those of its kind."""

    def __init__(self) -> None:
        self.data: Data = {k: [] for k in ("rings", "polynomials", "values", "dispersions", "tables")}
        self._known: dict[tuple[str, object], int] = {}
        # Positions are kept under identities, which are unique as long as the objects live.
        self._alive: list[object] = []
        self.terms = 0

    def ring(self, ring: Ring) -> int:
        """Add a ring."""
        return self._add("rings", ring.names, lambda: list(ring.names))

    def polynomial(self, ring: Ring, value: fmpz_mpoly) -> int:
        """Add a polynomial of a ring: its coefficients, and all exponents in one row."""

        def written() -> list[Any]:
            self.terms += len(value)
            exponents = list(map(int, chain.from_iterable(value.monoms())))
            return [self.ring(ring), [_integer(int(c)) for c in value.coeffs()], exponents]

        return self._add("polynomials", id(value), written, value)

    def value(self, value: Factored) -> int:
        """Add a product of powers."""

        def written() -> list[Any]:
            factors = [[self.polynomial(value.ring, f), e] for f, e in value.factors]
            unit = [_integer(value.unit.numerator), _integer(value.unit.denominator)]
            return [self.ring(value.ring), unit, factors]

        return self._add("values", id(value), written, value)

    def dispersion(self, law: Dispersion) -> int:
        """Add a dispersion."""

        def written() -> list[Any]:
            coefficients = [self.value(v) for v in law.characteristic]
            return [law.name, law.kind, coefficients, self.value(law.shift), list(law.wavenumbers)]

        return self._add("dispersions", id(law), written, law)

    def table(self, table: KernelTable) -> int:
        """Add a table of kernels."""

        def written() -> list[Any]:
            laws = [self.dispersion(d) for d in table.dispersions]
            return [laws, [self._kernel(k) for k in table.kernels]]

        return self._add("tables", id(table), written, table)

    def _kernel(self, kernel: Kernel) -> list[Any]:
        law, length = self.dispersion(kernel.dispersion), self.value(kernel.length)
        return [kernel.generator, kernel.function, law, kernel.wavenumber, length, kernel.order]

    def _add(self, kind: str, mark: object, written: Callable[[], list[Any]], alive: object = None) -> int:
        known = self._known.get((kind, mark))
        if known is not None:
            return known
        entry = written()
        position = self._known[kind, mark] = len(self.data[kind])
        self.data[kind].append(entry)
        self._alive.append(alive)
        return position


class Reader:
    """Exact values from the data of a :class:`Writer`, by position.

    Parameters
    ----------
    data : object
        From a file, and so not trusted.

    Raises
    ------
    ValueError
        For anything a writer does not write.
    """

    def __init__(self, data: object) -> None:
        known = mapping(data)
        self.rings = [Ring(_names(row)) for row in sequence(known.get("rings"))]
        self.polynomials = [self._polynomial(row) for row in sequence(known.get("polynomials"))]
        self.values = [self._value(row) for row in sequence(known.get("values"))]
        self.dispersions = [_dispersion(self, row) for row in sequence(known.get("dispersions"))]
        self.tables = [_table(self, row) for row in sequence(known.get("tables"))]

    def polynomial(self, position: object, ring: Ring) -> fmpz_mpoly:
        """Return a polynomial that is one of the given ring."""
        value = pick(self.polynomials, position)
        if value.context() is not ring.context:
            raise ValueError
        return value

    def _polynomial(self, row: object) -> fmpz_mpoly:
        position, coefficients, exponents = sequence(row, 3)
        ring: Ring = pick(self.rings, position)
        numbers = [_read_integer(c) for c in sequence(coefficients)]
        powers = sequence(exponents)
        width = len(ring.names)
        is_plain = all(type(e) is int and 0 <= e <= DEGREE_LIMIT for e in powers)
        if not is_plain or len(powers) != width * len(numbers) or not all(numbers):
            raise ValueError
        terms = dict(zip(zip(*[iter(powers)] * width, strict=True), numbers, strict=True))
        if len(terms) != len(numbers):
            raise ValueError
        return ring.context.from_dict(terms)

    def _value(self, row: object) -> Factored:
        position, unit, factors = sequence(row, 3)
        ring: Ring = pick(self.rings, position)
        above, below = (_read_integer(n) for n in sequence(unit, 2))
        if below <= 0:
            raise ValueError
        pairs = [sequence(pair, 2) for pair in sequence(factors)]
        powers = tuple((self.polynomial(f, ring), nonzero(e)) for f, e in pairs)
        if any(f.is_constant() for f, _ in powers):
            raise ValueError
        return Factored(ring, Fraction(above, below), powers)


def _dispersion(reader: Reader, row: object) -> Dispersion:
    name, kind, coefficients, shift, wavenumbers = sequence(row, 5)
    return Dispersion(
        text(name),
        cast("DispersionKind", one_of(get_args(DispersionKind), kind)),
        tuple(pick(reader.values, v) for v in sequence(coefficients)),
        pick(reader.values, shift),
        tuple(text(w) for w in sequence(wavenumbers)),
    )


def _kernel(reader: Reader, row: object) -> Kernel:
    generator, function, law, wavenumber, length, order = sequence(row, 6)
    return Kernel(
        text(generator),
        cast("KernelFunction", one_of(get_args(KernelFunction), function)),
        pick(reader.dispersions, law),
        text(wavenumber),
        pick(reader.values, length),
        integer(order),
    )


def _table(reader: Reader, row: object) -> KernelTable:
    laws, kernels = sequence(row, 2)
    table = KernelTable(
        tuple(pick(reader.dispersions, d) for d in sequence(laws)),
        tuple(_kernel(reader, k) for k in sequence(kernels)),
    )
    return table or NO_KERNELS


def mapping(data: object) -> dict[str, Any]:
    """Return an object of JSON; ValueError for anything else, as all below."""
    if not isinstance(data, dict):
        raise ValueError
    return data


def sequence(data: object, length: int | None = None) -> list[Any]:
    """Return an array of JSON, of a length when one is given."""
    if not isinstance(data, list) or (length is not None and len(data) != length):
        raise ValueError
    return data


def text(data: object) -> str:
    """Return a string of JSON."""
    if not isinstance(data, str):
        raise ValueError
    return data


def integer(data: object) -> int:
    """Return a number of JSON that is a small integer."""
    if type(data) is not int or abs(data) >= EXPONENT_LIMIT:
        raise ValueError
    return data


def nonzero(data: object) -> int:
    """Return a small integer other than 0."""
    if not integer(data):
        raise ValueError
    return integer(data)


def nonnegative(data: object) -> int:
    """Return a small integer of at least 0."""
    if integer(data) < 0:
        raise ValueError
    return integer(data)


def pick(known: Sequence[_T], position: object) -> _T:
    """Return what stands at a position."""
    if type(position) is not int or not 0 <= position < len(known):
        raise ValueError
    return known[position]


def one_of(known: Sequence[str], data: object) -> str:
    """Return one of the given strings."""
    if text(data) not in known:
        raise ValueError
    return text(data)


def _names(row: object) -> tuple[str, ...]:
    names = tuple(text(name) for name in sequence(row))
    if not 0 < len(names) <= GENERATOR_LIMIT or len(set(names)) != len(names):
        raise ValueError
    return names


def _integer(value: int) -> int | str:
    return value if -SMALL < value < SMALL else hex(value)


def _read_integer(data: object) -> int:
    return int(data, 16) if isinstance(data, str) else _small(data)


def _small(data: object) -> int:
    if type(data) is not int or not -SMALL < data < SMALL:
        raise ValueError
    return data
