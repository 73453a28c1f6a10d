"""Sums of exponentials: in balls and as series at any s.

In most of the s plane one of the exponentials is far larger than all others. Taken out, it leaves a function
that hardly changes, however fast the whole one turns: ``2 sinh(s)`` is ``e^s`` times ``1 - e^(-2s)``, which
at s = 20 + j y is 1 to 17 digits.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from math import inf

from flint import acb, acb_mat, acb_series, arb, fmpz_mpoly

from symflex.algebra import Factored, KernelTable, Ring
from symflex.algebra.exponential_sum import (
    REAL,
    Amplitude,
    Argument,
    Combination,
    Exponent,
    ExponentialSum,
    arguments_of,
    exponential_sum,
    parts,
)
from symflex.balls import Value, at_centre, raised
from symflex.transfer.enclose_kernels import KernelValues

Summed = tuple[tuple[Argument, ...], tuple[tuple[ExponentialSum, int], ...]]
"""Arguments of exponentials, and sums of these with their exponents."""
Valued = tuple[tuple[acb, tuple[tuple[str, int], ...]], ...]  # numbers, and what they are multiplied with


def exponential_sums(value: Factored, table: KernelTable) -> Summed | None:
    """Return arguments of exponentials, and factors as sums of these; None without formula, or if long."""
    arguments = arguments_of(table)
    if arguments is None:
        return None
    sums = []
    for factor, exponent in value.factors:
        terms = exponential_sum(value.ring, table, arguments, factor)
        if terms is None:
            return None
        sums.append((terms, exponent))
    return arguments, tuple(sums)


def sums_of(ring: Ring, polynomials: Sequence[fmpz_mpoly], table: KernelTable) -> Summed | None:
    """Return the same of polynomials, each with the exponent 1."""
    return exponential_sums(Factored(ring, Fraction(1), tuple((f, 1) for f in polynomials)), table)


@dataclass(frozen=True, eq=False)
class ExponentialValues:
    """Evaluates sums of exponentials at one precision."""

    evaluator: KernelValues  # of the ring of kernels
    arguments: tuple[Argument, ...]  # of all sums
    sums: tuple[tuple[ExponentialSum, int], ...]  # factors and their exponents

    @cached_property
    def coefficients(self) -> tuple[tuple[Valued, ...], ...]:
        """Per sum the coefficients of its terms."""
        return tuple(
            tuple(self.valued(amplitude, terms.halvings) for amplitude in terms.terms.values())
            for terms, _ in self.sums
        )

    @cached_property
    def matrices(self) -> tuple[tuple[tuple[tuple[tuple[str, int], ...], ...], acb_mat], ...]:
        """Per sum what its amplitudes are made of, and by what that is multiplied: a row per amplitude."""
        by_monomial = []
        for amplitudes in self.coefficients:
            monomials = sorted({powers for amplitude in amplitudes for _, powers in amplitude}) or [()]
            rows = [{powers: number for number, powers in amplitude} for amplitude in amplitudes]
            entries = [[row.get(powers, acb(0)) for powers in monomials] for row in rows]
            by_monomial.append((tuple(monomials), acb_mat(entries)))
        return tuple(by_monomial)

    def valued(self, amplitude: Amplitude, halvings: int = 0) -> Valued:
        """Return an amplitude over a power of two with the values of all constants in place."""
        evaluator = self.evaluator
        series = [n for n, x in evaluator.constants.items() if isinstance(x, acb_series)]
        varying = {0, *map(evaluator.names.index, (*evaluator.table.wavenumbers, *series))}
        numbers: dict[tuple[tuple[str, int], ...], acb] = {}
        for monomial, (re, im) in parts(amplitude):
            number = (acb(0, 1) if im else acb(1)) * arb(re or im) * arb(2) ** -halvings
            moving = []
            for i, e in monomial:
                if i in varying:
                    moving.append((evaluator.names[i], e))
                else:
                    number = number * acb(evaluator.constants[evaluator.names[i]]) ** e
            key = tuple(moving)
            numbers[key] = numbers.get(key, acb(0)) + number
        return tuple((number, key) for key, number in numbers.items())

    @cached_property
    def lengths(self) -> tuple[Value, ...]:
        """Of the arguments [m], for delays [s]."""
        values = {"s": acb(1), **{n: c + acb(0) for n, c in self.evaluator.constants.items()}}
        return tuple(self.evaluator.value(a.length, values) for a in self.arguments)

    def at(self, s: Value, near: Place | None = None) -> Place:
        """Return what sums are made of at a point or ball, or as series, on the branch of ``near``."""
        values = self.evaluator.generators_at(s, None if near is None else near.values)
        arguments = []
        for argument, length in zip(self.arguments, self.lengths, strict=True):
            rate = (
                values[argument.wavenumber]
                if argument.wavenumber
                else -self.evaluator.value(argument.rate, values)
            )
            arguments.append(rate * length)
        return Place(values, arguments)

    def amplitudes(self, number: int, place: Place) -> list[Value]:
        """Return the coefficients of all terms of one sum."""
        known = place.amplitudes.get(number)
        if known is not None:
            return known
        monomials, matrix = self.matrices[number]
        values = [_product(powers, place) for powers in monomials]
        # One product of matrices adds up all terms at once.
        order = min((v.prec for v in values if isinstance(v, acb_series)), default=0)
        rows = [[at_centre(v)] for v in values]
        if order:
            rows = [[v[i] for i in range(order)] for v in (v + acb_series([], order) for v in values)]
        sums = (matrix * acb_mat(rows)).tolist()
        amplitudes: list[Value] = [acb_series(row, order) if order else row[0] for row in sums]
        place.amplitudes[number] = amplitudes
        return amplitudes

    def exponents(self, number: int, place: Place, less: Exponent = REAL) -> list[Value | None]:
        """Return the exponents of all terms of one sum, less another one; ``None`` for 0."""
        return [place.combined(factors) for factors in self.sums[number][0].exponents(less)]

    def value(self, number: int, place: Place, less: Exponent = REAL) -> Value:
        """Return one sum divided by an exponential."""
        total: Value = acb(0)
        amplitudes, exponents = self.amplitudes(number, place), self.exponents(number, place, less)
        for amplitude, exponent in zip(amplitudes, exponents, strict=True):
            total = total + (amplitude if exponent is None else amplitude * exponent.exp())
        return total

    def largest(self, numbers: Iterable[int], place: Place) -> Exponent:
        """Return the exponent of the term of some sums that is the largest in the middle of a ball."""
        best, chosen = -inf, REAL
        at = [complex(at_centre(argument).mid()) for argument in place.arguments]
        for i in numbers:
            for own, amplitude in zip(self.sums[i][0].terms, self.amplitudes(i, place), strict=True):
                size = abs(at_centre(amplitude).mid())
                growth = sum(a * at[k].real - b * at[k].imag for k, a, b in own)
                total = growth + float(size.log()) if size > 0 else -inf
                if total > best:
                    best, chosen = total, own
        return chosen


@dataclass(frozen=True, slots=True)
class Place:
    """What sums are made of at one place."""

    values: Mapping[str, Value]  # of s, constants and wavenumbers
    arguments: Sequence[Value]  # of the exponentials
    # products and amplitudes: what is known already of products of generators, and of sums.
    products: dict[tuple[tuple[str, int], ...], Value] = field(default_factory=dict)
    amplitudes: dict[int, list[Value]] = field(default_factory=dict)

    def combined(self, factors: Combination) -> Value | None:
        """Return a combination of the arguments; ``None`` for 0."""
        total: Value | None = None
        for i, factor in factors:
            term = self.arguments[i] * factor
            total = term if total is None else total + term
        return total


def _product(powers: tuple[tuple[str, int], ...], place: Place) -> Value:
    """Return a product of powers of generators: the one of all but its last factor, and that."""
    known = place.products.get(powers)
    if known is None:
        *others, (name, e) = powers or (("s", 0),)
        if others:
            known = _product(tuple(others), place) * _product(powers[-1:], place)
        elif e > 1:
            known = _product(((name, e - 1),), place) * place.values[name]
        else:
            known = raised(place.values[name], e)
        place.products[powers] = known
    return known
