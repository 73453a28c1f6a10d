"""Propagators: the generators that stand for fundamental functions until an elimination is done.

Elimination multiplies entries of transfer matrices. One generator per fundamental function keeps those
entries monomials; afterwards each is replaced by its polynomial in hyperbolic and circular kernels of base
lengths, the fewest of which all others are integer combinations. Kernels of ``l/2`` and ``l``, or of ``x_s``,
``l`` and ``l - x_s``, are tied by addition theorems; in those of base lengths equal functions are equal
polynomials.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, product
from math import comb, prod
from operator import add

from flint import fmpq, fmpq_mat, fmpz_mat, fmpz_mpoly

from symflex.algebra.dispersion import Dispersion, Kernel, KernelTable
from symflex.algebra.factored import Factored, common_denominator, random_point, residue
from symflex.algebra.ring import Ring

MULTIPLE_LIMIT = 12  # lengths that are longer sums of base lengths keep kernels of their own
SUM_LIMIT = 7  # lengths whose sum is more, as 3:7, have no common base either: formulas would be pages
EXPONENTIAL = -1  # the order under which exp(-shift*length) is listed


@dataclass(frozen=True, slots=True, eq=False)
class Propagator:
    """One generator of the equations.

    For ``wave``, ``bending`` and ``pair`` it is the numerator of ``h^(order)(length)`` over a monomial in the
    wavenumbers and ``lambda_1^2 - lambda_2^2``; for ``general`` it is ``h^(order)(length)`` itself, for
    ``varying`` an entry of the fundamental matrix.
    """

    generator: str  # its name
    dispersion: int  # position of its dispersion
    length: int  # position of its length among those of the dispersion
    order: int  # of the derivative, or ``EXPONENTIAL``
    image: fmpz_mpoly  # what it is over the kernels' ring


@dataclass(frozen=True, eq=False)
class Propagation:
    """The rings before and after propagators are opened, and the way from one to the other."""

    base: Ring  # without wavenumbers, propagators and kernels
    ring: Ring  # ``base``, wavenumbers, propagators
    kernel_ring: Ring  # ``base``, wavenumbers, kernels
    table: KernelTable  # what the wavenumbers and kernels are; its values are over ``base``
    lengths: tuple[tuple[Factored, ...], ...]  # per dispersion, the lengths asked for
    propagators: tuple[Propagator, ...]  # in the order of their generators
    coordinates: tuple[tuple[tuple[int, ...], ...], ...] = ()  # per law and length, multiples of bases

    def embed(self, value: Factored) -> Factored:
        """Return a value of the base ring over ``ring``."""
        return value if value.ring == self.ring else value.over(self.ring)

    @cached_property
    def _places(self) -> tuple[Mapping[int, int], ...]:
        """Per dispersion, the positions of its lengths by their residues."""
        point = self._point
        return tuple({residue(x, point): i for i, x in enumerate(lengths)} for lengths in self.lengths)

    @cached_property
    def _point(self) -> Mapping[str, int]:
        return random_point(self.base.names)

    @cached_property
    def _known(self) -> Mapping[tuple[int, int, int], Factored]:
        return {
            (p.dispersion, p.length, p.order): Factored.generator(self.ring, p.generator)
            for p in self.propagators
        }

    def fundamental(self, dispersion: int, length: Factored, multiplicity: int = 1) -> tuple[Factored, ...]:
        """Return ``h, h', ...`` of a dispersion, or power, at a length; entries by rows if it varies."""
        law = self.table.dispersions[dispersion]
        if law.kind == "varying":
            return self._entries(dispersion, length)
        one = Factored.number(self.ring, 1)
        n = law.order * multiplicity
        if length.is_zero:
            return tuple(one if k == n - 1 else one * 0 for k in range(n))
        position = self._places[dispersion][residue(length, self._point)]
        plain = [one]
        if law.kind != "exponential":
            below = _denominators(law, self.ring)
            plain = [self._known[dispersion, position, k] / below[k] for k in range(law.order)]
        plain = _repeated(plain, _eigenvalue(law, self.ring), self.embed(length), multiplicity)
        if law.shift.is_zero:
            return tuple(plain)
        minus = -self.embed(law.shift)
        decay = self._known[dispersion, position, EXPONENTIAL]
        functions = []
        for k in range(n):
            total = sum((plain[j] * minus ** (k - j) * comb(k, j) for j in range(k + 1)), one * 0)
            functions.append(total * decay)
        return tuple(functions)

    def _entries(self, dispersion: int, length: Factored) -> tuple[Factored, ...]:
        law = self.table.dispersions[dispersion]
        n, one = law.order, Factored.number(self.ring, 1)
        free = range(n) if law.singular is None else law.singular.free
        if length.is_zero:
            if law.singular is not None:
                return tuple(self.embed(x) for row in law.singular.at_start() for x in row)
            return tuple(one * int(i == j) for i in range(n) for j in range(n))
        position = self._places[dispersion][residue(length, self._point)]
        entries = []
        for i, reached in enumerate(reachable(law)):
            for j in range(n):
                step = self._known.get((dispersion, position, i * n + j))
                stays = i == j and i not in reached and j in free
                entries.append(step if step is not None else one * int(stays))
        return tuple(entries)


def reachable(law: Dispersion) -> list[set[int]]:
    """Return the states that each depends on: along x, other entries are 0, or 1 on the diagonal."""
    n = law.order
    reach = [{j for j in range(n) if not law.matrix[i][j].is_zero} for i in range(n)]
    for _ in range(n):
        reach = [set.union(own, *(reach[j] for j in own)) for own in reach]
    return reach


def distinct(lengths: Sequence[Factored]) -> tuple[Factored, ...]:
    """Return the lengths that differ and are not zero, in order."""
    if not lengths:
        return ()
    point = random_point(lengths[0].ring.names)
    by_residue: dict[int, Factored] = {}
    for length in lengths:
        if not length.is_zero:
            by_residue.setdefault(residue(length, point), length)
    return tuple(by_residue.values())


def _denominators(law: Dispersion, ring: Ring) -> tuple[Factored, ...]:
    """Return what the numerators of ``h, h', ...`` are divided by."""
    one = Factored.number(ring, 1)
    w = [Factored.generator(ring, name) for name in law.wavenumbers]
    match law.kind:
        case "wave":
            return (w[0], one)
        case "bending":
            return (w[0] ** 3 * 4, w[0] ** 2 * 2, w[0] * 2, one)
        case "pair":
            split = w[0] ** 2 - w[1] ** 2
            return (w[0] * w[1] * split, split, split, split)
    return (one,) * law.order


def _eigenvalue(law: Dispersion, ring: Ring) -> Factored:
    """Return kappa of a law ``lambda^n = kappa``."""
    w = [Factored.generator(ring, name) for name in law.wavenumbers]
    match law.kind:
        case "wave":
            return w[0] ** 2
        case "bending":
            return w[0] ** 4 * -4
    return Factored.number(ring, 0)


def _repeated(plain: list[Factored], kappa: Factored, x: Factored, multiplicity: int) -> list[Factored]:
    """Return ``h, h', ...`` of ``(lambda^n - kappa)^m`` from those of m = 1.

    With g for one power less, ``h^(n-1) = x g/(n (m - 1))`` and ``h^(n) - kappa h = g``: the inverse Laplace
    transforms of a derivative with respect to lambda, and of the definition.
    """
    n, functions = len(plain), plain
    for m in range(1, multiplicity):
        # The next derivative of g follows from its equation, whose coefficients are binomial.
        lower = [functions[n * i] * (-kappa) ** (m - i) * comb(m, i) for i in range(m) if not kappa.is_zero]
        beyond = [*functions, -sum(lower, x * 0)]
        # ``(x g)^(k) = x g^(k) + k g^(k-1)``
        product = [x * g + (beyond[k - 1] * k if k else x * 0) for k, g in enumerate(beyond)]
        high = [p / (n * m) for p in product]
        low = [(product[k + 1] / (n * m) - beyond[k]) / kappa for k in range(n - 1)]
        functions = [*low, *high]
    return functions


WAVENUMBER_NAMES = {"wave": ("gamma",), "bending": ("mu",), "pair": ("lambda_1", "lambda_2")}


def propagate(base: Ring, demands: Sequence[tuple[Dispersion, Sequence[Factored]]]) -> Propagation:
    """Return generators for the fundamental functions of every dispersion at its lengths, over the base."""
    dispersions: list[Dispersion] = []
    kernels: list[Kernel] = []
    shapes: list[_Shape] = []
    for i, (given, wanted) in enumerate(demands):
        names = WAVENUMBER_NAMES.get(given.kind, ())
        law = replace(given, wavenumbers=tuple(f"{n}[{i}]" for n in names))
        dispersions.append(law)
        shape = _Shape(law, i, distinct(wanted))
        shapes.append(shape)
        kernels += shape.kernels
    table = KernelTable(tuple(dispersions), tuple(kernels))
    kernel_ring = Ring((*base.names, *table.generators), base.is_sparse)
    propagators = tuple(p for shape in shapes for p in shape.propagators(kernel_ring))
    names = (*base.names, *table.wavenumbers, *(p.generator for p in propagators))
    ring = Ring(names, base.is_sparse)
    return Propagation(
        base,
        ring,
        kernel_ring,
        table,
        tuple(s.lengths for s in shapes),
        propagators,
        tuple(s.coordinates for s in shapes),
    )


class _Shape:
    """The kernels of one dispersion, and its propagators in terms of them."""

    def __init__(self, law: Dispersion, number: int, lengths: tuple[Factored, ...]) -> None:
        self.law = law
        self.number = number
        self.lengths = lengths
        # Powers of a decaying exponential must not be negative; for the others either base will do.
        decays = law.kind == "exponential" or not law.shift.is_zero
        self.base = lengths
        self.coordinates = tuple(tuple(int(i == j) for j in range(len(lengths))) for i in range(len(lengths)))
        if law.kind not in ("general", "varying") and lengths and not lengths[0].ring.is_sparse:
            shared = length_base(lengths, positive=decays)
            multiples = [sum(map(abs, c)) for c in shared.coordinates]
            is_long = law.kind in ("bending", "pair") and sum(multiples) > SUM_LIMIT
            if max(multiples) <= MULTIPLE_LIMIT and not (is_long and _are_apart(shared.coordinates)):
                self.base, self.coordinates = shared.base, shared.coordinates
        self.kernels = [k for i, length in enumerate(self.base) for k in self._kernels(i, length)]

    @property
    def _entries(self) -> list[int]:
        """The numbers of the entries of a fundamental matrix that are not 0 or 1."""
        n, own = self.law.order, self.law.singular
        free = set(range(n)) if own is None else set(own.free)
        return [i * n + j for i, reached in enumerate(reachable(self.law)) for j in sorted(reached & free)]

    def _kernels(self, i: int, length: Factored) -> list[Kernel]:
        law, kernels = self.law, []
        if law.kind == "varying":
            return [Kernel(f"T{k}[{self.number},{i}]", "entry", law, "", length, k) for k in self._entries]
        if law.kind == "general":
            for k in range(law.order):
                name = f"h{k}[{self.number},{i}]"
                kernels.append(Kernel(name, "fundamental", law, "", length, k))
        functions = ("cosh", "sinh", "cos", "sin") if law.kind == "bending" else ("cosh", "sinh")
        for wavenumber in law.wavenumbers:
            for function in functions:
                name = f"{function}[{wavenumber},{i}]"
                kernels.append(Kernel(name, function, law, wavenumber, length))  # type: ignore[arg-type]
        if law.kind == "exponential" or not law.shift.is_zero:
            kernels.append(Kernel(f"exp[{self.number},{i}]", "exp", law, "", length))
        return kernels

    def propagators(self, ring: Ring) -> list[Propagator]:
        """Return the propagators at every length."""
        propagators = []
        for position, coordinates in enumerate(self.coordinates):
            for order, image in self._images(ring, position, coordinates):
                name = f"H{order}[{self.number},{position}]" if order >= 0 else f"D[{self.number},{position}]"
                propagators.append(Propagator(name, self.number, position, order, image))
        return propagators

    def _images(self, ring: Ring, position: int, multiples: tuple[int, ...]) -> list[tuple[int, fmpz_mpoly]]:
        law = self.law
        images: list[tuple[int, fmpz_mpoly]] = []
        if law.kind == "varying":
            return [(k, ring.generator(f"T{k}[{self.number},{position}]")) for k in self._entries]
        if law.kind == "general":
            images += [(k, ring.generator(f"h{k}[{self.number},{position}]")) for k in range(law.order)]
        elif law.kind == "wave":
            c, s = self._hyperbolic(ring, law.wavenumbers[0], multiples)
            images += [(0, s), (1, c)]
        elif law.kind == "bending":
            ch, sh = self._hyperbolic(ring, law.wavenumbers[0], multiples)
            co, si = self._added(ring, ("cos", "sin"), law.wavenumbers[0], multiples, -1)
            images += [(0, ch * si - sh * co), (1, sh * si), (2, ch * si + sh * co), (3, ch * co)]
        elif law.kind == "pair":
            c1, s1 = self._hyperbolic(ring, law.wavenumbers[0], multiples)
            c2, s2 = self._hyperbolic(ring, law.wavenumbers[1], multiples)
            w1, w2 = (ring.generator(w) for w in law.wavenumbers)
            images += [
                (0, w2 * s1 - w1 * s2),
                (1, c1 - c2),
                (2, w1 * s1 - w2 * s2),
                (3, w1 * w1 * c1 - w2 * w2 * c2),
            ]
        if law.kind == "exponential" or not law.shift.is_zero:
            decays = (ring.generator(f"exp[{self.number},{i}]") ** n for i, n in enumerate(multiples))
            images.append((EXPONENTIAL, prod(decays, start=ring.constant(1))))
        return images

    def _hyperbolic(self, ring: Ring, w: str, multiples: tuple[int, ...]) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return cosh and sinh of a wavenumber times a combination of base lengths."""
        return self._added(ring, ("cosh", "sinh"), w, multiples, 1)

    @staticmethod
    def _added(
        ring: Ring, functions: tuple[str, str], w: str, multiples: tuple[int, ...], sign: int
    ) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        even, odd = ring.constant(1), ring.constant(0)
        for i, n in enumerate(multiples):
            c, s = (ring.generator(f"{f}[{w},{i}]") for f in functions)
            if n < 0:
                s = -s
            for _ in range(abs(n)):
                even, odd = even * c + sign * (odd * s), odd * c + even * s
        return even, odd


def _are_apart(coordinates: Sequence[tuple[int, ...]]) -> bool:
    """Tell whether lengths are those of members alone: none is the sum of two, as with a point between."""
    known, pairs = set(coordinates), product(coordinates, repeat=2)
    return len(known) > 1 and known.isdisjoint(tuple(map(add, x, y)) for x, y in pairs)


SUBSET_LIMIT = 500  # number of subsets of the given lengths that are tried as a base

Monomial = tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LengthBase:
    """Base lengths, and the integer coordinates of every length that was given."""

    base: tuple[Factored, ...]  # rationally independent
    coordinates: tuple[tuple[int, ...], ...]  # per given length, its multiples of the base lengths


def length_base(lengths: Sequence[Factored], *, positive: bool = False) -> LengthBase:
    """Return base lengths for the given ones; these themselves where they suffice.

    None is zero; earlier ones are preferred, and with ``positive`` those of which no coordinate is negative.

    >>> from symflex.algebra import Factored, Ring
    >>> ring = Ring(("s", "l", "x"))
    >>> l, x = Factored.generator(ring, "l"), Factored.generator(ring, "x")
    >>> found = length_base([l, l / 2, l - x])
    >>> [str(b) for b in found.base], found.coordinates
    (['1/2*l', '(l - x)'], ((2, 0), (1, 0), (0, 1)))
    """
    ring = lengths[0].ring
    common = common_denominator(ring, lengths)
    whole, monomials = _vectors([(length * common).expand() for length in lengths])
    lattice = _lattice(whole)
    rank = len(lattice)
    chosen = _subset(whole, lattice, rank, positive=positive)
    rows = lattice if chosen is None else [whole[i] for i in chosen]
    coordinates = tuple(_coordinates(rows, v) for v in whole)
    base = []
    for i, row in enumerate(rows):
        if chosen is not None:
            base.append(lengths[chosen[i]])
            continue
        polynomial = ring.context.from_dict({m: x for m, x in zip(monomials, row, strict=True) if x})
        base.append(Factored.polynomial(ring, polynomial) / common)
    return LengthBase(tuple(base), coordinates)


def _vectors(lengths: Sequence[fmpz_mpoly]) -> tuple[list[list[int]], list[Monomial]]:
    """Return every length as a vector over the monomials that occur."""
    coefficients = [{tuple(int(e) for e in m): int(c) for m, c in length.terms()} for length in lengths]
    order = sorted({m for terms in coefficients for m in terms}, reverse=True)
    return [[terms.get(m, 0) for m in order] for terms in coefficients], order


def _lattice(vectors: list[list[int]]) -> list[list[int]]:
    """Return a basis of all integer combinations, in Hermite normal form."""
    rows = fmpz_mat(len(vectors), len(vectors[0]), [x for v in vectors for x in v]).hnf().tolist()
    return [[int(x) for x in row] for row in rows if any(int(x) for x in row)]


def _subset(
    vectors: list[list[int]], lattice: list[list[int]], rank: int, *, positive: bool
) -> tuple[int, ...] | None:
    """Return the first vectors that generate the lattice by themselves."""
    first = None
    for tried, subset in enumerate(combinations(range(len(vectors)), rank)):
        if tried >= SUBSET_LIMIT:
            break
        rows = [vectors[i] for i in subset]
        if _lattice(rows) != lattice:
            continue
        if not positive or all(x >= 0 for v in vectors for x in _coordinates(rows, v)):
            return subset
        first = first or subset
    return first


def _coordinates(rows: list[list[int]], vector: list[int]) -> tuple[int, ...]:
    """Return the integers x with ``x rows = vector``."""
    matrix = fmpq_mat(fmpz_mat(len(rows), len(vector), [x for r in rows for x in r])).transpose()
    gram = matrix.transpose() * matrix
    right = matrix.transpose() * fmpq_mat(len(vector), 1, [fmpq(x) for x in vector])
    solution = gram.solve(right)
    return tuple(int(solution[i, 0].p) for i in range(len(rows)))
