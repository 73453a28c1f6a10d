"""Arranging polynomials as a person would: common factors first, descending powers of s, sums grouped.

Numerator and denominator are products of such sums, each in the arrangement that prints shortest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property, partial
from itertools import accumulate, chain, islice, product
from math import gcd, isqrt, prod
from operator import add, neg, sub

from flint import fmpz_mpoly

from symflex.algebra import (
    LAPLACE,
    Factored,
    Ring,
    by_powers,
    degree_in,
    irreducible_factors,
    square_free_factors,
)
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    names,
    names_in,
    negative,
    number,
    once,
    power,
    product_of,
    quotient,
    sum_of,
    sums_in,
    text_length,
)
from symflex.model.model import IMAGINARY
from symflex.print.forms.kept import KeptDefinitions

GROUP_LIMIT = 5_000  # number of terms up to which a polynomial is nested for print
DEEPEST_NEST = 60  # degree in all parameters up to which a sum is nested: each level takes out one
FACTOR_LIMIT = 400  # number of terms up to which a coefficient is factored for print


@dataclass(frozen=True)
class Arranger:
    """Arranges polynomials of one ring."""

    ring: Ring  # the generators, s first, in declared order
    # What to print for a generator, where it is not its own name (closed sums).
    names: Mapping[str, Expression]
    degrees: Mapping[str, int]  # degree in s of such generators, so that they stand where their power belongs
    # Functions of s: they stand after what multiplies them, and a sum that begins with one begins with a
    # plus.
    apart: frozenset[str] = frozenset()
    # Polynomials may be of its source; they are arranged over its ring, which is ``ring``.
    kept: KeptDefinitions | None = None

    @staticmethod
    def plain(
        ring: Ring,
        names: Mapping[str, Expression] | None = None,
        apart: Iterable[str] = (),
        kept: KeptDefinitions | None = None,
    ) -> Arranger:
        """Return an arranger for a ring whose generators print as themselves."""
        return Arranger(kept.ring if kept else ring, names or {}, {}, frozenset(apart), kept)

    def closed(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return a polynomial in the definitions that are kept."""
        if self.kept is None or (self.kept.adds and polynomial.context() is self.ring.context):
            return polynomial
        return self.kept.rewrite(polynomial)

    @cached_property
    def _symbols(self) -> tuple[Expression, ...]:
        return tuple(self.names.get(n, Name(n)) for n in self.ring.names)

    @cached_property
    def _nested(self) -> dict[tuple[tuple[tuple[int, ...], int], ...], list[Expression]]:
        """The factors of sums that were arranged."""
        return {}

    @cached_property
    def _s_degree(self) -> tuple[tuple[int, int], ...]:
        """The generators that bear s, by index, and their degrees."""
        degrees = {LAPLACE: 1, **self.degrees}
        return tuple((i, degrees[n]) for i, n in enumerate(self.ring.names) if degrees.get(n))

    @cached_property
    def _is_apart(self) -> tuple[bool, ...]:
        return tuple(n in self.apart for n in self.ring.names)

    @cached_property
    def _is_sum(self) -> tuple[bool, ...]:
        return tuple(n in self.degrees for n in self.ring.names)

    @cached_property
    def _sums(self) -> tuple[int, ...]:
        return tuple(i for i, is_sum in enumerate(self._is_sum) if is_sum)

    def collected(self, polynomial: fmpz_mpoly, *, factored: bool = True, nested: bool = False) -> Expression:
        """Return a polynomial by descending powers of s, each coefficient factored, or nested."""
        is_opened = self.kept is not None and polynomial.context() is self.kept.source.context
        parts = by_powers(self.kept.source if self.kept and is_opened else self.ring, polynomial)
        terms = []
        for exponent, part in sorted(parts.items(), reverse=True):
            coefficient = self.grouped(part) if nested else self.coefficient(part, factored=factored)
            terms.append(product_of([coefficient, power(self._symbols[0], exponent)]))
        return sum_of(terms) if terms else number(0)

    def coefficient(self, polynomial: fmpz_mpoly, *, factored: bool = True) -> Expression:
        """Return a polynomial free of s as a product of factors, or as a sum when it has none."""
        return self._once("factored" if factored else "sum", polynomial, self._coefficient, factored)

    def _once(
        self, how: str, polynomial: fmpz_mpoly, make: Callable[..., Expression], *more: object
    ) -> Expression:
        """Return what is made of a polynomial, the same object every time."""
        if len(polynomial) > SMALL:
            return make(polynomial, *more)
        key = how, polynomial.context(), tuple(polynomial.to_dict().items())
        if key not in self._made:
            self._made[key] = make(polynomial, *more)
        return self._made[key]

    @cached_property
    def _made(self) -> dict[tuple[object, ...], Expression]:
        return {}

    def _coefficient(self, polynomial: fmpz_mpoly, factored: bool) -> Expression:
        polynomial = self.closed(polynomial)
        if len(polynomial) == 1 or not factored or len(polynomial) > FACTOR_LIMIT:
            return self._with_content(polynomial)
        front, *pieces = self._pieces_of(polynomial, self._flat)
        pieces.sort(key=lambda piece: {*names(piece)} != {Name("pi")})  # beside the number
        return product_of([front, *pieces])

    @staticmethod
    def _pieces_of(polynomial: fmpz_mpoly, arrange: Callable[[fmpz_mpoly], Expression]) -> list[Expression]:
        """Return a number, and irreducible factors whose leading coefficients are positive."""
        constant, factors = irreducible_factors(polynomial)
        sign = 1
        pieces: list[Expression] = []
        for factor, exponent in sorted(factors, key=lambda fe: (len(fe[0]) > 1, _order_key(fe[0]))):
            positive = factor
            if int(factor.leading_coefficient()) < 0:
                positive, sign = -factor, sign * (-1) ** exponent
            pieces.append(power(arrange(positive), exponent))
        return [number(constant * sign), *pieces]

    def _with_content(self, polynomial: fmpz_mpoly) -> Expression:
        content = polynomial.term_content()
        if int(polynomial.leading_coefficient()) < 0:
            content = -content if int(content.leading_coefficient()) > 0 else content
        rest = polynomial / content
        parts = [polynomial] if rest.is_constant() else [content, rest]
        return product_of(map(self._flat, parts))

    def _flat(self, polynomial: fmpz_mpoly) -> Expression:
        return self._sum(_terms(polynomial))

    def grouped(self, polynomial: fmpz_mpoly) -> Expression:
        """Return a polynomial nested by its most shared generators."""
        polynomial = self.closed(polynomial)
        if polynomial.is_zero():
            return number(0)
        if len(polynomial) > GROUP_LIMIT:
            return self.collected(polynomial, factored=False)
        return self._group(_terms(polynomial))

    def grouped_by_s(self, polynomial: fmpz_mpoly) -> Expression:
        """Return the shortest of the nested print and those by descending powers of s."""
        return self._once("by s", polynomial, self._shortest)

    def _shortest(self, polynomial: fmpz_mpoly) -> Expression:
        nested = self.grouped(polynomial)
        if len(polynomial) > GROUP_LIMIT or not degree_in(polynomial, 0):
            return nested
        tried = [self.collected(polynomial), nested]
        if len(polynomial) <= SMALL:
            content = polynomial.term_content()
            rest = self.collected(polynomial / content, nested=True)
            tried.insert(1, product_of([self._flat(content), rest]))
        return min([min(tried, key=self._reading), *self._with_gain(polynomial)], key=length)

    def _with_gain(self, polynomial: fmpz_mpoly) -> Iterable[Expression]:
        """Yield ``s*(s + a)*(s + b) + K``: what symbols multiply, after factors that are of s."""
        is_tried = len(polynomial) <= FEW and degree_in(polynomial, 0) > SECOND
        terms = _terms(self.closed(polynomial)) if is_tried else {}
        if not terms:
            return
        alone = [(i,) for i in range(1, len(self.ring.names))]
        together = [e for c in self._gains_together(terms) for e in self._after_factors(terms, c)]
        yield from together or chain.from_iterable(self._after_factors(terms, c) for c in alone)

    def _after_factors(self, terms: dict[tuple[int, ...], int], chosen: Sequence[int]) -> list[Expression]:
        """Return a sum with what some symbols multiply last, if the others multiply two factors of s."""
        last = {m: c for m, c in terms.items() if any(m[i] for i in chosen)}
        first = {m: c for m, c in terms.items() if m not in last}
        if not SHORT <= len(first) < len(terms):
            return []
        _, factors = irreducible_factors(self.ring.context.from_dict(first))
        if sum(e for f, e in factors if len(f) > 1 and degree_in(f, 0)) < SECOND:
            return []
        if len(chosen) == 1:
            return [sum_of([self._group(first), self._group(last)])]
        if max(m[0] for m in last) > max(m[0] for m in first):
            return []
        # Each factor as if it stood alone, as a numerator has some of them.
        pieces = self._pieces_of(self.ring.context.from_dict(last), self.grouped_by_s)
        made = sum_of([self._group(first), product_of(pieces)])
        inner = [total for total in sums_in(made) if total is not made and power_of_s(total)]
        is_plain = all(not power_of_s(n) for total in inner for n in sums_in(total) if n is not total)
        return [made] if is_plain else []

    def _gains_together(self, terms: dict[tuple[int, ...], int]) -> Iterable[tuple[int, ...]]:
        """Yield gains of a controller: no two stand in a term, and all multiply the same factor of s."""
        beside = {
            i: self.ring.context.from_dict({(*m[:i], 0, *m[i + 1 :]): c for m, c in terms.items() if m[i]})
            for i in range(1, len(self.ring.names))
            if max(m[i] for m in terms) == 1
        }
        tried = set[tuple[int, ...]]()
        for i, own in beside.items():
            shared, group = own, [i]
            for j, other in beside.items():
                common = shared.gcd(other)
                is_apart = not any(m[j] and any(m[k] for k in group) for m in terms)
                if j != i and is_apart and len(common) > 1 and degree_in(common, 0):
                    shared, group = common, [*group, j]
            # One of them may be of the machine: the mass before l*s^2 + g.
            for chosen in (group, *([j for j in group if j != left] for left in group)):
                key = tuple(sorted(chosen))
                if len(key) > 1 and key not in tried:
                    tried.add(key)
                    yield key

    def separated(self, polynomial: fmpz_mpoly, *, by_functions: bool) -> Expression:
        """Return a sum of coefficients times functions, collected by functions or by monomials."""
        parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
        for monomial, coefficient in _terms(self.closed(polynomial)).items():
            key = tuple(e if f == by_functions else 0 for f, e in zip(self._is_apart, monomial, strict=True))
            rest = tuple(e - k for e, k in zip(monomial, key, strict=True))
            parts.setdefault(key, {})[rest] = coefficient
        # Monomials whose coefficients differ by a number share them.
        shared: dict[tuple[tuple[tuple[int, ...], int], ...], dict[tuple[int, ...], int]] = {}
        for key, terms in parts.items():
            scale = gcd(*terms.values()) * (1 if terms[self._first(terms)] > 0 else -1)
            primitive = tuple(sorted((m, c // scale) for m, c in terms.items()))
            shared.setdefault(primitive, {})[key] = scale
        groups = []
        for primitive, keys in shared.items():
            coefficient_terms = dict(primitive)
            first = tuple(map(add, self._first(coefficient_terms), self._first(keys)))
            pieces = [self._group(coefficient_terms), self._group(keys)]
            if not by_functions:
                pieces.reverse()
            groups.append((self._monomial_key(first), product_of(pieces)))
        return sum_of([part for _, part in sorted(groups, key=lambda g: g[0])])

    def _first(self, terms: Mapping[tuple[int, ...], int]) -> tuple[int, ...]:
        """Return the monomial that is printed first."""
        return min(terms, key=self._monomial_key)

    def monomial(self, exponents: Sequence[int]) -> Expression:
        """Return a product of powers of the generators, those of ``ring`` or of what is kept closed."""
        monomial = tuple(exponents)
        if self.kept is not None and not (self.kept.adds and len(exponents) == len(self.ring.names)):
            (monomial,) = _terms(self.kept.rewrite(self.kept.source.context.from_dict({monomial: 1})))
        return self._monomial(monomial, 1)

    def _group(self, terms: dict[tuple[int, ...], int]) -> Expression:
        content = tuple(min(column) for column in zip(*terms, strict=True))
        front = self._monomial(content, 1)
        if len(terms) == 1:
            return product_of([number(*terms.values()), front])
        scale = gcd(*terms.values()) * (-1 if max(terms.values()) < 0 else 1)
        rest = {tuple(map(sub, m, content)): c // scale for m, c in terms.items()}
        first = self._first(rest)
        if rest[first] < 0 and any(e and f for e, f in zip(first, self._is_apart, strict=True)):
            scale, rest = -scale, {m: -c for m, c in rest.items()}
        return product_of([number(scale), front, *self._pieces(rest)])

    def _pieces(self, terms: dict[tuple[int, ...], int]) -> list[Expression]:
        """Return the factors of a sum, each nested; those of a sum met again are the same objects."""
        key = tuple(terms.items())
        if key not in self._nested:
            self._nested[key] = self._factored(terms)
        return self._nested[key]

    def _factored(self, terms: dict[tuple[int, ...], int]) -> list[Expression]:
        if _is_trinomial_square(terms) or 3 < len(terms) <= FACTOR_LIMIT:  # noqa: PLR2004
            _, factors = irreducible_factors(self.ring.context.from_dict(terms))
            if len(factors) > 1 or factors[0][1] > 1:
                ordered = sorted(factors, key=lambda fe: _order_key(fe[0]))
                positive = [(_terms(f if int(f.leading_coefficient()) > 0 else -f), e) for f, e in ordered]
                # With every factor's leading coefficient positive, the product's sign is the sum's own.
                sign = number(1 if terms[max(terms)] > 0 else -1)
                return [sign, *(power(self._split(f), e) for f, e in positive)]
        return [self._split(terms)]

    def _split(self, terms: dict[tuple[int, ...], int]) -> Expression:
        if max(sum(m[1:]) for m in terms) > DEEPEST_NEST:
            return self._sum(terms)
        parts = sorted(self._parts(terms), key=lambda p: p[0])
        nested = sum_of(_share_sums([part for _, part in parts]))
        if len(terms) > SHORT:
            return nested
        tried = [nested, self._sum(terms)]
        if max(m[0] for m in terms) == SECOND and not self.apart:
            tried.append(self.collected(self.ring.context.from_dict(terms)))
        return min(tried, key=self._reading)

    def _parts(self, terms: dict[tuple[int, ...], int]) -> list[tuple[tuple[int, ...], Expression]]:
        """Return the groups of a sum with their places in print."""
        shared = self._most_shared(terms)
        if shared is None:
            return [(self._place(alike), self._coefficient_and_power(alike)) for alike in self._by_s(terms)]
        chosen = {m: c for m, c in terms.items() if m[shared]}
        others = {m: c for m, c in terms.items() if not m[shared]}
        return [(self._place(chosen), self._group(chosen)), *(self._parts(others) if others else [])]

    def _coefficient_and_power(self, terms: dict[tuple[int, ...], int]) -> Expression:
        """Return ``(m_1 + m_2)*s^2``, or a single term."""
        if len(terms) == 1:
            return self._sum(terms)
        degree = next(iter(terms))[0]
        return product_of([self._group({(0, *m[1:]): c for m, c in terms.items()}), self._powers(0, degree)])

    def _by_s(self, terms: dict[tuple[int, ...], int]) -> Iterable[dict[tuple[int, ...], int]]:
        """Return terms by powers of s; what contains no s, or a function or a closed sum, stands alone."""
        by_power: dict[object, dict[tuple[int, ...], int]] = {}
        for m, c in terms.items():
            is_plain = m[0] and not any(
                e and (f or g) for e, f, g in zip(m, self._is_apart, self._is_sum, strict=True)
            )
            by_power.setdefault(m[0] if is_plain else m, {})[m] = c
        return by_power.values()

    def _most_shared(self, terms: dict[tuple[int, ...], int]) -> int | None:
        """Return the generator to take out of a sum: closed sums first, then parameters; never s alone."""
        counts = [sum(map(bool, column)) for column in zip(*terms, strict=True)]
        candidates = [i for i, n in enumerate(counts) if n > 1 and i]
        return max(candidates, key=lambda i: (self._is_sum[i], counts[i], -i), default=None)

    def _place(self, terms: Iterable[tuple[int, ...]]) -> tuple[int, ...]:
        return min(map(self._monomial_key, terms))

    def _monomial_key(self, monomial: tuple[int, ...]) -> tuple[int, ...]:
        """Return a sort key: descending degree in s, then closed sums, then declared order."""
        degree = sum([monomial[i] * d for i, d in self._s_degree])
        sums = sum([monomial[i] for i in self._sums])
        return (-degree, -sums, *map(neg, monomial[1:]))

    def _sum(self, terms: dict[tuple[int, ...], int]) -> Expression:
        return sum_of([self._monomial(m, terms[m]) for m in sorted(terms, key=self._monomial_key)])

    def _monomial(self, monomial: tuple[int, ...], coefficient: int) -> Expression:
        """Return number, pi, parameters in declared order, s, closed sums."""
        factors = [self._powers(i, monomial[i]) for i in self._print_order if monomial[i]]
        if coefficient == 1 and len(factors) > 1 and all(type(f) in (Name, Power) for f in factors):
            return Product(tuple(factors))  # most are so, and need not be taken apart
        return product_of([number(coefficient), *factors])

    def _reading(self, expression: Expression) -> float:
        """Return the length of an expression, and more of nested ones; beside functions, of fewer of them."""
        return reading(expression, are_quadratics=not self.apart)

    @cached_property
    def _print_order(self) -> tuple[int, ...]:
        """The generators in the order in which a product shows them."""

        def place(i: int) -> int:
            if i == 0:
                return 2
            if self._is_sum[i] or self._is_apart[i]:
                return 4 if self._is_sum[i] else 3
            if self.ring.names[i] in ("pi", IMAGINARY):
                return -1
            return 0 if self.ring.names[i].startswith("zeta") else 1  # as in 2*zeta*omega_n*s

        return tuple(sorted(range(len(self.ring.names)), key=place))

    @cached_property
    def _powers(self) -> Callable[[int, int], Expression]:
        """Return a power of a generator, the same object every time; of ``exp(x)``, ``exp(n*x)``."""

        @cache
        def raised(i: int, exponent: int) -> Expression:
            symbol = self._symbols[i]
            if isinstance(symbol, Call) and symbol.name == "exp":
                return Call("exp", product_of([number(exponent), symbol.argument]))
            return power(symbol, exponent)

        return raised


def _share_sums(parts: list[Expression]) -> list[Expression]:
    """Return the terms of a sum with a parenthesis that several of them bear taken out once."""
    for shared in [f for part in parts for f in _factors(part) if isinstance(f, Sum)]:
        bearing = [p for p in parts if shared in _factors(p)]
        if len(bearing) > 1:
            inner = _share_factors(_share_sums([_without(p, shared) for p in bearing]))
            # Plain factors stand before parentheses.
            merged = product_of(sorted([shared, *_factors(inner)], key=lambda f: isinstance(f, Sum)))
            first = parts.index(bearing[0])
            rest = [p for p in parts if p not in bearing]
            return _share_sums([*rest[:first], merged, *rest[first:]])
    return parts


def _share_factors(parts: list[Expression]) -> Expression:
    """Return the sum of the parts with every factor that all of them bear in front."""
    common: list[Expression] = []
    for factor in _factors(parts[0]):
        if not isinstance(factor, Sum | Number) and all(factor in _factors(p) for p in parts):
            common.append(factor)
            parts = [_without(p, factor) for p in parts]
    return product_of([*common, sum_of(parts)])


def _factors(part: Expression) -> tuple[Expression, ...]:
    if isinstance(part, Negative):
        return number(-1), *_factors(part.operand)
    return part.factors if isinstance(part, Product) else (part,)


def _without(part: Expression, shared: Expression) -> Expression:
    factors = list(_factors(part))
    factors.remove(shared)
    return product_of(factors)


def _order_key(polynomial: fmpz_mpoly) -> tuple[tuple[int, ...], ...]:
    """Return a key that sorts factors by the declared order of their generators."""
    return tuple(tuple(-int(e) for e in m) for m in polynomial.monoms())


def _terms(polynomial: fmpz_mpoly) -> dict[tuple[int, ...], int]:
    return {tuple(map(int, m)): int(c) for m, c in polynomial.terms()}


def _is_trinomial_square(terms: Mapping[tuple[int, ...], int]) -> bool:
    """Tell whether three terms are those of ``(a + b)^2``, which takes no time to find out."""
    if len(terms) != 3:  # noqa: PLR2004
        return False
    (first, a), (middle, b), (last, c) = sorted(terms.items())
    return b * b == 4 * a * c and all(2 * m == f + n for f, m, n in zip(first, middle, last, strict=True))


SMALL = 400  # number of terms up to which every arrangement of a sum is tried
SHORT = 4  # number of terms up to which a nested sum is compared with the plain one
FEW = 40  # number of terms up to which the open loop is looked for in a closed one
SECOND = 2  # degree in s up to which a polynomial prints by powers of s
NESTED = 1.3  # how many times as long as a nested polynomial one by powers of s may be
READABLE = 4  # depth of parentheses that reads easily
Sides = tuple[Expression, Expression]


class ProductPrinter:
    """Prints products over one ring; a sum met again is not arranged again."""

    def __init__(self, arranger: Arranger, imaginary: str = "") -> None:
        self.arranger = arranger
        self._imaginary = arranger.ring.index[imaginary] if imaginary else None
        self._apart = tuple(arranger.ring.index[name] for name in arranger.apart)
        self._sums: dict[str, Expression] = {}

    def sides(self, value: Factored) -> Sides:
        """Return numerator and denominator, the sign in the numerator."""
        unit = value.unit
        powers = [0] * len(value.ring.names)
        sums: list[tuple[Expression, int]] = []
        for factor, exponent in value.factors:
            if len(factor) == 1:
                powers[next(i for i, d in enumerate(factor.degrees()) if int(d))] += exponent
                continue
            printed = self.sum(factor)
            if isinstance(printed, Negative):
                printed, unit = printed.operand, unit * (-1) ** abs(exponent)
            sums.append((printed, exponent))
        above = self.arranger.monomial([max(e, 0) for e in powers])
        below = self.arranger.monomial([max(-e, 0) for e in powers])
        return (
            product_of([number(unit.numerator), above, *(power(x, e) for x, e in sums if e > 0)]),
            product_of([number(unit.denominator), below, *(power(x, -e) for x, e in sums if e < 0)]),
        )

    def quotient(self, value: Factored) -> Expression:
        """Return the product as one expression."""
        return quotient(*self.sides(value))

    def square_root(self, value: Factored, front: Factored | None = None) -> Expression:
        """Return one square root of a product times ``front``, with squares outside the sign of the root."""
        inside = value**0
        outside = inside if front is None else front
        if not value.ring.is_sparse:  # (h + g)^2 is a factor by itself
            value = value.map_factors(value.ring, partial(with_squares, value.ring))
        for factor, exponent in value.factors:
            half = int(exponent / 2)
            outside = outside * Factored(value.ring, Fraction(1), ((factor, half),) if half else ())
            if exponent % 2:
                inside = inside * Factored(value.ring, Fraction(1), ((factor, exponent - 2 * half),))
        for part, sign in ((abs(value.unit.numerator), 1), (value.unit.denominator, -1)):
            root = isqrt(part)
            exact = root * root == part
            outside = outside * Fraction(root if exact else 1) ** sign
            inside = inside * Fraction(1 if exact else part) ** sign
        inside = -inside if value.unit < 0 else inside
        above, below = self.sides(outside)
        if inside.is_one:
            return quotient(above, below)
        if inside.numerator().is_one:  # b/sqrt(k*m), not b*sqrt(1/(k*m))
            return quotient(above, product_of([below, Call("sqrt", self.quotient(1 / inside))]))
        return quotient(product_of([above, Call("sqrt", self.quotient(inside))]), below)

    def sum(self, polynomial: fmpz_mpoly) -> Expression:
        """Return a sum in its shortest arrangement; a minus sign that all of it bears stands in front."""
        polynomial = self.arranger.closed(polynomial)
        key = str(polynomial)
        if key not in self._sums:
            self._sums[key] = self._arranged(polynomial)
        return self._sums[key]

    def _arranged(self, polynomial: fmpz_mpoly) -> Expression:
        degrees = polynomial.degrees()
        if self._imaginary is not None and int(degrees[self._imaginary]):
            parts = by_powers(self.arranger.ring, polynomial, self._imaginary)
            j = self.arranger.monomial([int(i == self._imaginary) for i in range(len(degrees))])
            return sum_of([self.sum(parts[0]), product_of([j, self.sum(parts[1])])])
        if not any(int(degrees[i]) for i in self._apart):
            return self.arranger.grouped_by_s(polynomial)
        tried = [self.arranger.separated(polynomial, by_functions=True)]
        if len(polynomial) <= SMALL:
            nested = self.arranger.grouped(polynomial)
            tried = [nested, *tried, self.arranger.separated(polynomial, by_functions=False)]
        shortest = min(tried, key=_cost)
        if isinstance(shortest, Sum) and isinstance(shortest.terms[0], Negative):
            return Negative(Sum(tuple(map(negative, shortest.terms))))
        return shortest


def is_long_product(value: Factored) -> bool:
    """Tell whether factors multiply to more terms than are factored for print: they stay factors then."""
    sums = [(len(f), abs(e)) for f, e in value.factors if len(f) > 1]
    return sum(e for _, e in sums) > 1 and prod(n**e for n, e in sums) > FACTOR_LIMIT


def length_sides(printer: ProductPrinter, length: Factored) -> Sides:
    """Return numerator and denominator of a length; ``-(x - l)`` is ``l - x``."""
    above, below = printer.sides(length)
    if isinstance(above, Negative):
        factors = list(above.operand.factors if isinstance(above.operand, Product) else (above.operand,))
        if isinstance(last := factors[-1], Sum) and any(isinstance(t, Negative) for t in last.terms):
            turned = sorted(map(negative, last.terms), key=lambda t: isinstance(t, Negative))
            above = product_of([*factors[:-1], Sum(tuple(turned))])
    return above, below


def _cost(expression: Expression) -> int:
    """Return the length of a text, and more for parentheses too deep to read."""
    text = format_expression(expression)
    deepest = max(accumulate({"(": 1, ")": -1}.get(c, 0) for c in text), default=0)
    return len(text) * (READABLE + max(0, deepest - READABLE)) // READABLE


def length(*expressions: Expression) -> int:
    """Return how many characters expressions take."""
    return sum(map(text_length, expressions))


def with_squares(ring: Ring, polynomial: fmpz_mpoly) -> Factored:
    """Return a polynomial as a product of powers of square-free ones."""
    unit, factors = square_free_factors(polynomial)
    return Factored(ring, Fraction(unit), tuple(factors))


def reading(expression: Expression, *, are_quadratics: bool = True) -> float:
    """Return the length of an expression, and more of what is nested in it as ``s*(a*s + b) + c``."""
    wide = {e for e in sums_in(expression) if _is_nested(e) or (are_quadratics and _is_quadratic(e))}
    return length(expression) + (NESTED - 1) * length(*wide)


@once
def _is_nested(total: Sum) -> bool:
    """Tell whether a term is a product with one sum with s, which bears another of its factors, too."""
    for factors in (t.factors for t in total.terms if isinstance(t, Product)):
        inner = [n for n in (names_in(f) for f in factors if isinstance(f, Sum)) if Name(LAPLACE) in n]
        if len(inner) == 1 and not inner[0].isdisjoint(factors):
            return True
    return False


@once
def _is_quadratic(total: Sum) -> bool:
    """Tell whether a sum has degree 2 in s and is not by its powers, as ``a*(b*s^2 + 1) + c`` is not."""
    if power_of_s(total) != SECOND:
        return False
    factors = [[f for f in _factors(t) if not isinstance(f, Number)] for t in total.terms]
    inner = [[f for f in each if isinstance(f, Sum)] for each in factors if len(each) > 1]
    degrees = [d for t in total.terms if (d := power_of_s(t))]
    return any(len(f) == 1 and power_of_s(f[0]) for f in inner) or len({*degrees}) < len(degrees)


@once
def power_of_s(expression: Expression) -> int:
    """Return the degree in s."""
    return _power(expression, power_of_s, max)


@once
def lowest_power_of_s(expression: Expression) -> int:
    """Return the lowest power of s in a product of sums."""
    return _power(expression, lowest_power_of_s, min)


def _power(
    expression: Expression, power: Callable[[Expression], int], choose: Callable[[Iterable[int]], int]
) -> int:
    """Return the power of s in a product, of a sum's that of the term that is chosen."""
    match expression:
        case Name(name):
            return int(name == LAPLACE)
        case Sum(terms):
            return choose(map(power, terms)) if Name(LAPLACE) in names_in(expression) else 0
        case Product(factors):
            return sum(map(power, factors))
        case Quotient(above, below):
            return power(above) - power(below)
        case Negative(operand):
            return power(operand)
        case Power(base, Number(exponent)):
            return power(base) * int(exponent)
    return 0


MOST_WAYS = 16  # ways to write factors by the law of a wavenumber that are made
ARRANGED = 4  # the shortest of them: their sums are arranged, and what takes fewest characters is printed


def _by_law(value: Factored, name: str, one: Factored) -> list[Factored]:
    """Return a product with what the law of a wavenumber says in place of its powers, within sums, too.

    ``E*A*gamma*cosh(q) + m*s^2*sinh(q)`` is ``rho*A*cosh(q) + m*gamma*sinh(q)`` times ``s^2/gamma`` so.
    """
    from symflex.algebra.normal_form import with_image  # only with waves

    ring, i = value.ring, value.ring.index[name]
    wave, generator = Factored.generator(ring, name), ring.context.gen(i)
    degree = next(e for f, e in one.factors if f == generator)
    sums = [f for f, _ in one.factors if len(f) > 1]  # rho*A*s^2 + k_f

    def put(factor: fmpz_mpoly, more: int) -> Factored:
        above, below = with_image(ring, factor * generator**more, i, wave**degree / one, degree)
        made = Factored.number(ring, 1) / below / wave**more
        for f in sums:
            while not above % f:
                above, made = above / f, made * Factored.polynomial(ring, f)
        return made * Factored.polynomial(ring, above)

    ways = [range(degree) if len(f) > 1 and degree_in(f, i) else range(1) for f, _ in value.factors]
    made = []
    for chosen in islice(product(*ways), MOST_WAYS):
        put_in = Factored.number(ring, value.unit)
        for (factor, exponent), more in zip(value.factors, chosen, strict=True):
            put_in = put_in * put(factor, more) ** exponent
        alone = next((e for f, e in put_in.factors if f == generator), 0)
        put_in = put_in / one ** int(alone / degree)
        made += [put_in, *(v for v in (put_in / one, put_in * one) if _symbols(v) < _symbols(put_in) - 1)]
    return sorted(made, key=_symbols)[:ARRANGED]


def _symbols(value: Factored) -> int:
    """Return how many symbols a product is written with, about."""
    return sum(sum(map(bool, m)) for f, _ in value.factors for m in f.monoms())


def shortest_sides(printer: ProductPrinter, value: Factored, laws: Mapping[str, Factored]) -> Sides:
    """Return the sides of a product, powers of wavenumbers traded by their ``laws`` if that is shorter."""
    tried = [value]
    for name, one in laws.items():
        if value.depends_on(name):
            tried = [v * one**t for v in tried for t in (0, -1, 1)] + _by_law(value, name, one)
    return min((printer.sides(v) for v in tried), key=lambda sides: length(*sides))
