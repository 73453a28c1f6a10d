"""The exact ring: integer polynomials in s, parameters, closed definitions and constants, and their factors.

Input: an ordered tuple of generator names.
Output: a :class:`Ring` whose elements are python-flint ``fmpz_mpoly``, or sparse polynomials of the same
interface, as far as assembling needs it, where there are too many names for these. An elementary function of
constants is one generator with a numeric definition.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import compress
from math import comb, prod
from typing import Generic, TypeVar, cast

from flint import Ordering, arb, fmpq_mpoly_ctx, fmpz_mpoly, fmpz_mpoly_ctx

from symflex.algebra.sparse import Monomial, SparseContext, SparsePolynomial
from symflex.errors import BudgetError, Diagnostic

LAPLACE = "s"
TERM_LIMIT = 3_000_000
DEGREE_LIMIT = 20_000
MEMORY_LIMIT = 100_000_000  # bytes an expansion or elimination may take
COEFFICIENT_BYTES = 8
FEW = 16  # how large coefficients may be that do not spoil a count of terms much
MANY = 5_000  # terms that are not counted one by one
SPARSE_BYTES = 1_000  # what a sparse term counts for: less memory, but its products take long


@dataclass(frozen=True)
class Ring:
    """Integer polynomials in named generators, lexicographic order, ``s`` first.

    >>> ring = Ring(("s", "m", "b"))
    >>> ring.generator("m") * ring.generator("s") + ring.generator("b")
    s*m + b
    """

    names: tuple[str, ...]  # generator names in order; the first one is ``s``
    is_sparse: bool = False  # of any number of names, without substitution or common divisors
    context: fmpz_mpoly_ctx = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.is_sparse:
            object.__setattr__(self, "context", cast("fmpz_mpoly_ctx", SparseContext(self.names)))
            return
        internal = [
            name if name.isascii() and name.isidentifier() else f"_{i}" for i, name in enumerate(self.names)
        ]
        object.__setattr__(self, "context", fmpz_mpoly_ctx.get(internal, Ordering.lex))

    @cached_property
    def index(self) -> Mapping[str, int]:
        """Position of each generator."""
        return {name: i for i, name in enumerate(self.names)}

    def generator(self, name: str) -> fmpz_mpoly:
        """Return the generator called ``name``."""
        return self.context.gen(self.index[name])

    def used_in(self, polynomials: Iterable[fmpz_mpoly]) -> frozenset[str]:
        """Return the names of the generators that occur."""
        used: set[str] = set()
        for polynomial in polynomials:
            if (sparse := _sparse(polynomial)) is not None:
                used |= {self.names[i] for m in sparse.parts for i, _ in m}
            elif len(polynomial):
                used |= {n for n, d in zip(self.names, polynomial.degrees(), strict=True) if int(d)}
        return frozenset(used)

    def bytes_of(self, terms: int) -> int:
        """Return about how much memory a polynomial takes: a byte per exponent, and its coefficients."""
        return terms * ((SPARSE_BYTES if self.is_sparse else len(self.names)) + COEFFICIENT_BYTES)

    def constant(self, value: int) -> fmpz_mpoly:
        """Return an integer as a polynomial."""
        return self.context.constant(value)

    def taken_over(self, polynomial: fmpz_mpoly, names: Sequence[str] | None = None) -> fmpz_mpoly:
        """Return a polynomial of another ring, whose names are the first of this, or any; others are zero."""
        if names is not None and self.names[: len(names)] != names:
            images = [self.generator(n) if n in self.index else self.constant(0) for n in names]
            return self.compose(polynomial, images)
        if (sparse := _sparse(polynomial)) is not None:
            context = cast("SparseContext", self.context)
            return cast("fmpz_mpoly", SparsePolynomial(context, sparse.parts))
        own = polynomial.context().nvars()
        return polynomial.compose(*self.context.gens()[:own], ctx=self.context)

    def compose(
        self,
        polynomial: fmpz_mpoly,
        images: Sequence[fmpz_mpoly],
        term_limit: int = TERM_LIMIT,
        memory_limit: int = MEMORY_LIMIT,
    ) -> fmpz_mpoly:
        """Replace every generator of ``polynomial``'s ring by its image; SF501 or SF502 beyond limits."""
        if self.is_sparse:
            message = f"products are not expanded with {len(self.names)} names"
            raise BudgetError(Diagnostic("SF502", message, None, "ask for the nested form"))
        check_expansion(polynomial, images, min(term_limit, memory_limit // self.bytes_of(1)))
        return polynomial.compose(*images, ctx=self.context)

    def replaced(self, polynomial: fmpz_mpoly, images: Mapping[str, fmpz_mpoly]) -> fmpz_mpoly:
        """Return a polynomial of this ring with others in place of some generators."""
        return polynomial.compose(*(images.get(n, self.generator(n)) for n in self.names), ctx=self.context)

    def coefficients(self, polynomial: fmpz_mpoly, generator: int = 0) -> list[fmpz_mpoly]:
        """Return the coefficients of ascending powers of one generator, over the same ring."""
        powers = by_powers(self, polynomial, generator)
        return [powers.get(n, self.constant(0)) for n in range(degree_in(polynomial, generator) + 1)]


def expanded_length(polynomial: fmpz_mpoly, lengths: Sequence[int]) -> int | None:
    """Return a bound on the terms of a polynomial whose generators are sums of some lengths.

    ``None`` when there is no quick one: many coefficients of both signs, or large ones.

    >>> ring = Ring(("s", "x", "y"))
    >>> s, x, y = ring.context.gens()
    >>> expanded_length(s * x + x * y, (1, 2, 3)), expanded_length(x**60, (1, 2, 3))
    (8, 61)
    """
    highest = max((int(d) for n, d in zip(lengths, polynomial.degrees(), strict=True) if n > 1), default=0)
    if highest < 1:
        return len(polynomial)
    values = polynomial.coeffs()
    # Every monomial counts at least once, as its coefficient is at least one.
    is_quick = min(values) >= 1 and max(values) <= FEW
    if len(polynomial) <= MANY and not (is_quick and highest == 1):
        # A power of a sum has as many terms as one can choose from its own, some more than once.
        powers = (zip(lengths, map(int, m), strict=True) for m in polynomial.monoms())
        return sum(prod(comb(n + e - 1, e) for n, e in each if e) for each in powers)
    return int(polynomial(*lengths)) if is_quick else None


def check_expansion(polynomial: fmpz_mpoly, images: Sequence[fmpz_mpoly], most: int) -> None:
    """Refuse a substitution that could have more than so many terms with SF501; see :meth:`Ring.compose`."""
    lengths = [len(image) for image in images]
    degrees = [int(image.total_degree()) if len(image) else 0 for image in images]
    small_degree = polynomial.total_degree() * max(degrees, default=0) <= DEGREE_LIMIT
    if max(lengths, default=0) <= 1 and small_degree:
        return
    bound = expanded_length(polynomial, lengths) if small_degree else None
    if bound is not None and bound <= most:
        return
    terms = 0
    for position in range(len(polynomial)):
        monomial = polynomial.monomial(position)  # one by one: most refusals come early
        product, degree = 1, 0
        for i, exponent in enumerate(monomial):
            if exponent:
                length, image_degree = lengths[i], degrees[i]
                degree += exponent * image_degree
                if length > 1:
                    product *= comb(length + exponent - 1, exponent)
        terms += product
        if terms > most or degree > DEGREE_LIMIT:
            message = (
                f"the expanded form would exceed {most} terms"
                if terms > most
                else f"the expanded form would exceed degree {DEGREE_LIMIT}"
            )
            raise BudgetError(Diagnostic("SF501", message, None, "keep repeated sums in [definitions]"))


def degree_in(polynomial: fmpz_mpoly, generator: int) -> int:
    """Return the degree of ``polynomial`` in the generator at position ``generator``; 0 for zero."""
    if (sparse := _sparse(polynomial)) is not None:
        return max((dict(m).get(generator, 0) for m in sparse.parts), default=0)
    return int(polynomial.degrees()[generator]) if len(polynomial) else 0


def _sparse(polynomial: object) -> SparsePolynomial | None:
    """Return what passes for an ``fmpz_mpoly`` as what it is."""
    return polynomial if isinstance(polynomial, SparsePolynomial) else None


def highest_degree(polynomial: fmpz_mpoly) -> int:
    """Return the largest degree of a nonzero polynomial in any one generator."""
    if (sparse := _sparse(polynomial)) is not None:
        return max((e for m in sparse.parts for _, e in m), default=0)
    return max(map(int, polynomial.degrees()))


def coefficients_of(
    ring: Ring, polynomial: fmpz_mpoly, positions: Sequence[int]
) -> dict[tuple[int, ...], fmpz_mpoly]:
    """Return the coefficient of every product of powers of some generators, over the same ring.

    Keys are exponents, in the order in which they first occur.

    >>> ring = Ring(("s", "m", "b"))
    >>> s, m, b = (ring.generator(n) for n in ring.names)
    >>> coefficients_of(ring, m * s**2 - 3 * b * s + m * b * s, (0, 2))
    {(2, 0): m, (1, 1): m - 3}
    """
    if (sparse := _sparse(polynomial)) is not None:
        split: dict[tuple[int, ...], dict[Monomial, int]] = {}
        for each, number in sparse.parts.items():
            powers = dict(each)
            key = tuple([powers.pop(i, 0) for i in positions])
            split.setdefault(key, {})[tuple(powers.items())] = number
        return {key: cast("fmpz_mpoly", SparsePolynomial(sparse.context, x)) for key, x in split.items()}
    parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
    for monomial, coefficient in polynomial.to_dict().items():
        rest = list(monomial)
        for i in positions:
            rest[i] = 0
        key = tuple([int(monomial[i]) for i in positions])
        parts.setdefault(key, {})[tuple(rest)] = int(coefficient)
    return {key: ring.context.from_dict(terms) for key, terms in parts.items()}


def by_powers(ring: Ring, polynomial: fmpz_mpoly, generator: int = 0) -> dict[int, fmpz_mpoly]:
    """Return the coefficient of every power of one generator that occurs, over the same ring."""
    return {power: part for (power,), part in coefficients_of(ring, polynomial, (generator,)).items()}


def real_parts(ring: Ring, polynomial: fmpz_mpoly, unit: str) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return g and h of ``g + j h``, j being the generator of a name, if there is one.

    >>> ring = Ring(("s", "j"))
    >>> s, j = (ring.generator(n) for n in ring.names)
    >>> real_parts(ring, s**2 + 3 * j + j**2 - 2 * j**3, "j")
    (s^2 - 1, 5)
    """
    zero = ring.constant(0)
    parts = by_powers(ring, polynomial, ring.index[unit]) if unit in ring.index else {0: polynomial}
    g, h = (sum((c * (-1) ** (n // 2) for n, c in parts.items() if n % 2 == odd), zero) for odd in (0, 1))
    return g, h


def terms_of(polynomial: fmpz_mpoly) -> list[tuple[Monomial, int]]:
    """Return the terms in lexicographic order: positions of generators with exponents, and the coefficient.

    >>> ring = Ring(("s", "m", "b"))
    >>> s, m, b = (ring.generator(n) for n in ring.names)
    >>> terms_of(m * s**2 - 3 * b)
    [(((0, 2), (1, 1)), 1), (((2, 1),), -3)]
    """
    if (sparse := _sparse(polynomial)) is not None:
        return sparse.ordered()
    # Of the exponents of a few hundred generators, most are zero.
    return [(tuple((i, int(e)) for i, e in compress(enumerate(m), m)), int(c)) for m, c in polynomial.terms()]


def irreducible_factors(polynomial: fmpz_mpoly) -> tuple[int, list[tuple[fmpz_mpoly, int]]]:
    """Return a nonzero polynomial as a number times powers of polynomials irreducible over the rationals.

    The number bears the sign; factors have content 1 and positive leading coefficients, and are ordered by
    exponents, then by terms.

    >>> from symflex.algebra import Ring
    >>> s, k = Ring(("s", "k")).context.gens()
    >>> irreducible_factors((s + 2**70) * (s + 2**70 + 2) * k**2 * -6)
    (-6, [(s + 1180591620717411303424, 1), (s + 1180591620717411303426, 1), (k, 2)])
    """
    if _is_linear(polynomial):
        return 1, [(polynomial, 1)]
    try:
        number, factors = polynomial.factor()
    except OverflowError:
        # To sort integer polynomials python-flint 0.9 reads their coefficients as C integers. Those with
        # rational coefficients it sorts in the same order, and with coefficients of any size.
        context = polynomial.context()
        rational = fmpq_mpoly_ctx.get(context.names(), context.ordering())
        unit, parts = rational.from_dict(polynomial.to_dict()).factor()
        number = unit.p
        factors = [(context.from_dict({m: c.p for m, c in part.terms()}), times) for part, times in parts]
    return int(number), [(factor, int(times)) for factor, times in factors]


def _is_linear(polynomial: fmpz_mpoly) -> bool:
    """Tell whether a polynomial is found to be irreducible because it is linear in some generator.

    ``a*x + b`` is, by Gauss's lemma, where a and b have no common factor: here content 1, and a positive
    leading coefficient, too. That takes a tenth of the time in which a factorisation says so.
    """
    linear = [i for i, degree in enumerate(polynomial.degrees()) if int(degree) == 1]
    if len(polynomial) <= 1 or not linear or int(polynomial.leading_coefficient()) < 0:
        return False
    slopes = (polynomial.derivative(i) for i in linear)
    slope = next((x for x in slopes if len(x) == 1), None) or min(map(polynomial.derivative, linear), key=len)
    return bool(slope.gcd(polynomial).is_one())


def square_free_factors(polynomial: fmpz_mpoly) -> tuple[int, list[tuple[fmpz_mpoly, int]]]:
    """Return a nonzero polynomial as a number times powers of coprime polynomials without squares.

    See :func:`irreducible_factors`; these are in no order.

    >>> from symflex.algebra import Ring
    >>> s, k = Ring(("s", "k")).context.gens()
    >>> square_free_factors(3 * (s + 1) * (s - k) ** 2)
    (3, [(s + 1, 1), (s - k, 2)])
    """
    number, factors = polynomial.factor_squarefree()
    return int(number), [(factor, int(times)) for factor, times in factors]


Made = TypeVar("Made")


@dataclass(frozen=True, eq=False)
class PolynomialMemo(Generic[Made]):
    """A function of polynomials that remembers its values.

    The engine's polynomials have no hash, so the same object is known again, and not an equal one.

    >>> from symflex.algebra import Ring
    >>> s = Ring(("s",)).generator("s")
    >>> memo = PolynomialMemo(lambda polynomial: [len(polynomial)])
    >>> memo(s), memo(s) is memo(s)
    ([1], True)
    """

    make: Callable[[fmpz_mpoly], Made]  # the function
    _known: dict[int, tuple[fmpz_mpoly, Made]] = field(default_factory=dict)

    def __call__(self, polynomial: fmpz_mpoly) -> Made:
        """Return the value for a polynomial."""
        known = self._known.get(id(polynomial))
        if known is None:
            # The polynomial is kept as well: as long as it lives, its id is its own.
            known = self._known[id(polynomial)] = (polynomial, self.make(polynomial))
        return known[1]


@dataclass(frozen=True, slots=True)
class ElementaryFunction:
    """A function the expression language knows."""

    name: str  # as written in a specification
    evaluate: Callable[[arb], arb]  # maps a real or complex ball to a ball at the current precision
    latex: str  # the operator name in LaTeX
    derivative: Callable[[arb], arb]  # the derivative, in the same way


FUNCTIONS: dict[str, ElementaryFunction] = {
    f.name: f
    for f in (
        ElementaryFunction("sqrt", lambda x: x.sqrt(), r"\sqrt", lambda x: 1 / (2 * x.sqrt())),
        ElementaryFunction("exp", lambda x: x.exp(), r"\exp", lambda x: x.exp()),
        ElementaryFunction("log", lambda x: x.log(), r"\log", lambda x: 1 / x),
        ElementaryFunction("sin", lambda x: x.sin(), r"\sin", lambda x: x.cos()),
        ElementaryFunction("cos", lambda x: x.cos(), r"\cos", lambda x: -x.sin()),
        ElementaryFunction("tan", lambda x: x.tan(), r"\tan", lambda x: 1 + x.tan() ** 2),
        ElementaryFunction("sinh", lambda x: x.sinh(), r"\sinh", lambda x: x.cosh()),
        ElementaryFunction("cosh", lambda x: x.cosh(), r"\cosh", lambda x: x.sinh()),
        ElementaryFunction("tanh", lambda x: x.tanh(), r"\tanh", lambda x: 1 - x.tanh() ** 2),
        ElementaryFunction("atan", lambda x: x.atan(), r"\arctan", lambda x: 1 / (1 + x * x)),
    )
}
