"""Polynomials in fundamental functions as sums of exponentials of the characteristic roots.

Input: a polynomial over a ring whose kernels are fundamental functions ``h, h', ...`` of dispersions whose
roots have no names.
Output: a :class:`ModalSum`. With the roots ``x_i`` of a characteristic polynomial chi,
``h^(k)(l) = sum(x_i^k exp(x_i l) / chi'(x_i))``, so a product of m of them is a sum over m roots each. In
determinants, what grows fastest cancels: a product in which a root stands twice. That is found here, in exact
arithmetic, and left out; in rounded numbers nothing of it can be lost then, however large the exponents are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement, product
from math import comb, factorial, prod
from typing import Any

from flint import fmpz_mpoly

from symflex.algebra.dispersion import Dispersion, Kernel, KernelTable
from symflex.algebra.factored import Factored, common_denominator
from symflex.algebra.ring import PolynomialMemo, Ring, by_powers, coefficients_of
from symflex.errors import BudgetError, Diagnostic

KEY_LIMIT = 4000  # products of exponentials a sum may have
Key = tuple[int, ...]  # which root every slot of a frame takes


@dataclass(frozen=True, slots=True, eq=False)
class CharacteristicMode:
    """The solutions ``exp(x_i length)`` of a dispersion at one length; of a decay, ``exp(-shift*length)``."""

    dispersion: Dispersion  # whose roots they are
    length: Factored  # [m]; of a delay, a time [s]
    is_decay: bool  # true for the one exponential that all solutions share, with ``-shift`` for a root

    @property
    def roots(self) -> int:
        """How many there are."""
        return 1 if self.is_decay else self.dispersion.order


@dataclass(frozen=True, slots=True)
class Frame:
    """The terms of a sum with the same number of fundamental functions of every mode."""

    slots: tuple[int, ...]  # the mode of every function, ascending
    terms: tuple[tuple[tuple[int, ...], int], ...]  # orders of derivatives by slots, and coefficients
    keys: tuple[tuple[Key, int], ...]  # products of exponentials that stay, sorted, and their divisors


@dataclass(frozen=True, eq=False)
class ModalSum:
    """A polynomial in fundamental functions; see :func:`modal_amplitudes`."""

    coefficients: tuple[fmpz_mpoly, ...]  # free of fundamental functions and decays
    frames: tuple[Frame, ...]  # what is summed


def mode_values(roots: Any, length: Any) -> tuple[Any, Any]:  # noqa: ANN401
    """Return exponents of all roots at a length, and x^k/chi'(x) per root: numbers, arrays or balls."""
    powers = []
    for i, x in enumerate(roots):
        share: Any = 1.0
        for j, other in enumerate(roots):
            if j != i:  # one by one, as a product of wide balls may contain 0 where none of them does
                share = share / (x - other)
        own = [share]
        for _ in range(len(roots) - 1):
            own.append(own[-1] * x)
        powers.append(own)
    return [x * length for x in roots], powers


def modal_amplitudes(modes: Any, coefficients: Any, frames: Any) -> list[tuple[Any, Any]]:  # noqa: ANN401
    """Return amplitude and exponent of every exponential in a sum, given :func:`mode_values` of modes."""
    amplitudes = []
    for slots, terms, keys in frames:
        # One slot after the other; keys are sorted, so that what they begin with is summed once.
        path = [((), {orders: coefficients[i] for orders, i in terms})]
        for key, divisor in keys:
            while path[-1][0] != key[: len(path) - 1]:
                path.pop()
            for at in range(len(path) - 1, len(key)):
                powers = modes[slots[at]][1][key[at]]
                left: Any = {}
                for orders, value in path[-1][1].items():
                    term = value * powers[orders[0]]
                    left[orders[1:]] = left[orders[1:]] + term if orders[1:] in left else term
                path.append((key[: at + 1], left))
            exponent = sum(modes[slot][0][root] for slot, root in zip(slots, key, strict=True))
            amplitudes.append((path[-1][1][()] / divisor, exponent))
    return amplitudes


@dataclass(frozen=True, eq=False)
class ModalSums:
    """The sums of polynomials over one ring, each made once."""

    ring: Ring  # of the polynomials and of the dispersions' coefficients
    table: KernelTable  # of the ring

    @cached_property
    def _modes(self) -> Mapping[tuple[Dispersion, Factored, bool], CharacteristicMode]:
        return {
            _key(k): CharacteristicMode(k.dispersion, k.length, k.function == "exp")
            for k in self.table.kernels
            if k.function in ("fundamental", "exp")
        }

    @property
    def modes(self) -> tuple[CharacteristicMode, ...]:
        """The modes that slots count."""
        return tuple(self._modes.values())

    @cached_property
    def kernels(self) -> tuple[tuple[int, int, int], ...]:
        """Per fundamental function or decay the position of its generator, its mode, and its order."""
        numbers = {key: i for i, key in enumerate(self._modes)}
        return tuple(
            (self.ring.index[k.generator], numbers[_key(k)], k.order)
            for k in self.table.kernels
            if _key(k) in numbers
        )

    def has_functions(self, polynomial: fmpz_mpoly) -> bool:
        """Tell whether a polynomial has fundamental functions in it."""
        degrees = polynomial.degrees()
        return any(int(degrees[i]) and not self.modes[m].is_decay for i, m, _ in self.kernels)

    @cached_property
    def of(self) -> PolynomialMemo[ModalSum]:
        """The sum of a polynomial; SF503 when it has more than ``KEY_LIMIT`` exponentials."""
        return PolynomialMemo(self._made)

    def _made(self, polynomial: fmpz_mpoly) -> ModalSum:
        by_slots: dict[tuple[int, ...], dict[tuple[int, ...], fmpz_mpoly]] = {}
        positions = [position for position, _, _ in self.kernels]
        for powers, part in coefficients_of(self.ring, polynomial, positions).items():
            functions = sorted(
                (mode, order)
                for (_, mode, order), power in zip(self.kernels, powers, strict=True)
                for _ in range(power)
            )
            slots, orders = (tuple(f[i] for f in functions) for i in (0, 1))
            by_slots.setdefault(slots, {})[orders] = part
        coefficients: list[fmpz_mpoly] = []
        frames = []
        for slots, own in by_slots.items():
            self._check_size(slots)
            terms_of_frame: list[tuple[tuple[int, ...], int]] = []
            for orders, coefficient in own.items():
                images = _arrangements(slots, orders)
                # Over all arrangements of a key, every arrangement of the orders comes as often.
                coefficients.append(coefficient * _repetitions(slots, orders))
                terms_of_frame += [(image, len(coefficients) - 1) for image in images]
            keys = self._keys(slots, [(o, coefficients[i]) for o, i in terms_of_frame])
            if keys:
                frames.append(Frame(slots, tuple(terms_of_frame), keys))
        return ModalSum(tuple(coefficients), tuple(frames))

    def _check_size(self, slots: tuple[int, ...]) -> None:
        """Raise if roots can be given to the slots in too many ways."""
        ways = (comb(self.modes[m].roots + count - 1, count) for m, count in Counter(slots).items())
        if prod(ways) > KEY_LIMIT:
            message = f"the closed form has more than {KEY_LIMIT} products of exponentials"
            raise BudgetError(
                Diagnostic("SF503", message, None, "split the model, or give more parameters numbers")
            )

    def _keys(
        self, slots: tuple[int, ...], terms: Sequence[tuple[tuple[int, ...], fmpz_mpoly]]
    ) -> tuple[tuple[Key, int], ...]:
        choices = [
            list(combinations_with_replacement(range(self.modes[m].roots), count))
            for m, count in Counter(slots).items()
        ]
        algebra = _RootAlgebra(self.ring, self.modes)
        kept: dict[Key, bool] = {}
        keys = []
        for chosen in product(*choices):
            key = tuple(root for part in chosen for root in part)
            pattern = self._pattern(slots, key)
            if pattern not in kept:
                kept[pattern] = not algebra.vanishes(slots, pattern, terms)
            if kept[pattern]:
                keys.append((key, _repetitions(slots, key)))
        return tuple(sorted(keys))

    def _pattern(self, slots: tuple[int, ...], key: Key) -> Key:
        """Return the key with the roots of every dispersion numbered in the order they come in."""
        labels: dict[tuple[Dispersion, bool], dict[int, int]] = {}
        pattern = []
        for slot, root in zip(slots, key, strict=True):
            mode = self.modes[slot]
            own = labels.setdefault((mode.dispersion, mode.is_decay), {})
            pattern.append(own.setdefault(root, len(own)))
        return tuple(pattern)


def _key(kernel: Kernel) -> tuple[Dispersion, Factored, bool]:
    """Return what tells modes apart."""
    return kernel.dispersion, kernel.length, kernel.function == "exp"


def _arrangements(slots: tuple[int, ...], orders: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Return all distinct ways to give the orders to slots of the same mode."""
    by_mode: dict[int, list[int]] = {}
    for slot, order in zip(slots, orders, strict=True):
        by_mode.setdefault(slot, []).append(order)
    parts = [list(_permutations(Counter(own))) for own in by_mode.values()]
    return [tuple(o for part in chosen for o in part) for chosen in product(*parts)]


def _permutations(left: Counter[int]) -> Iterator[tuple[int, ...]]:
    """Return the distinct orders of values that occur several times."""
    if not left:
        yield ()
    for value in sorted(left):
        for rest in _permutations(left - Counter([value])):
            yield (value, *rest)


def _repetitions(slots: tuple[int, ...], values: tuple[int, ...]) -> int:
    """Return how many permutations of slots of the same mode leave the values as they are."""
    return prod(factorial(n) for n in Counter(zip(slots, values, strict=True)).values())


@dataclass(frozen=True, eq=False)
class _RootAlgebra:
    """Polynomials in some of the roots of characteristic polynomials, modulo all relations among these.

    The relations of r roots are the divided differences ``chi[x_1]``, ``chi[x_1, x_2]``, ..., each monic in
    its last root (Cauchy modules; Bourbaki, Algebra IV, 6.5).
    """

    ring: Ring
    modes: Sequence[CharacteristicMode]

    def vanishes(
        self, slots: tuple[int, ...], pattern: Key, terms: Sequence[tuple[tuple[int, ...], fmpz_mpoly]]
    ) -> bool:
        """Tell whether a sum of coefficients times powers of roots, ``x_(pattern i)^(order i)``, is zero."""
        laws: dict[Dispersion, int] = {}
        for slot, label in zip(slots, pattern, strict=True):
            mode = self.modes[slot]
            if not mode.is_decay:
                laws[mode.dispersion] = max(laws.get(mode.dispersion, 0), label + 1)
        first: dict[Dispersion, int] = {}
        size = len(self.ring.names)
        for law, count in laws.items():
            first[law] = size
            size += count
        names = (*self.ring.names, *(f"root[{i}]" for i in range(size - len(self.ring.names))))
        larger = Ring(names)
        total = larger.constant(0)
        for orders, coefficient in terms:
            powers = [0] * (size - len(self.ring.names))
            for slot, label, order in zip(slots, pattern, orders, strict=True):
                if order:
                    powers[first[self.modes[slot].dispersion] + label - len(self.ring.names)] += order
            total = total + larger.context.from_dict(_extended(coefficient, tuple(powers)))
        for law, count in laws.items():
            total = self._reduced(larger, total, law, first[law], count)
        return not len(total)

    def _reduced(
        self, larger: Ring, polynomial: fmpz_mpoly, dispersion: Dispersion, first: int, count: int
    ) -> fmpz_mpoly:
        values = (*dispersion.characteristic, Factored.number(self.ring, 1))
        below = common_denominator(self.ring, values)
        padding = (0,) * (len(larger.names) - len(self.ring.names))
        whole = [larger.context.from_dict(_extended((v * below).expand(), padding)) for v in values]
        roots = [larger.context.gen(first + i) for i in range(count)]
        for j in range(count, 0, -1):
            # chi[x_1, ..., x_j] = sum of c_i times the complete symmetric function of degree i - j + 1.
            relation = larger.constant(0)
            for i in range(j - 1, len(whole)):
                products = combinations_with_replacement(roots[:j], i - j + 1)
                one = larger.constant(1)
                relation = relation + whole[i] * sum((prod(p, start=one) for p in products), one * 0)
            polynomial = _remainder(larger, polynomial, relation, first + j - 1)
        return polynomial


def _extended(polynomial: fmpz_mpoly, powers: tuple[int, ...]) -> dict[tuple[int, ...], int]:
    return {(*map(int, m), *powers): int(c) for m, c in polynomial.terms()}


def _remainder(ring: Ring, polynomial: fmpz_mpoly, divisor: fmpz_mpoly, index: int) -> fmpz_mpoly:
    """Return a multiple, free of roots, of the remainder of a division with respect to one generator."""
    below = by_powers(ring, divisor, index)
    degree = max(below)
    leading = below.pop(degree)
    parts: Mapping[int, fmpz_mpoly] = by_powers(ring, polynomial, index)
    left = dict(parts)
    for power in range(max(left, default=0), degree - 1, -1):
        top = left.pop(power, None)
        if top is None or not len(top):
            continue
        left = {k: p * leading for k, p in left.items()}
        for k, c in below.items():
            at = power - degree + k
            left[at] = left.get(at, ring.constant(0)) - top * c
    x = ring.context.gen(index)
    return sum((p * x**k for k, p in left.items()), ring.constant(0))
