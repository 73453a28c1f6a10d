"""Products of sums of exponentials in doubles, for searches: logarithms and slopes, which prove nothing.

A search samples a function at thousands of points before a ball proves what it found. Doubles suffice for
that wherever no digits cancel; everywhere else they say so, and balls sample.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Final

import numpy as np
import numpy.typing as npt
from flint import acb_series

from symflex.algebra import LAPLACE, Dispersion, Factored
from symflex.balls import at_centre
from symflex.roots.functions.entire import Sample
from symflex.roots.functions.exponential_values import ExponentialValues

Complexes = npt.NDArray[np.complex128]
Pair = tuple[complex, complex]  # a value and its derivative in s
SETTLED: Final = 1e-6
"""Least share of the terms' sizes that a sum may be: ten digits of a double are left then."""


class _InBallsError(Exception):
    """Doubles cannot sample a function, or not here."""


@dataclass(frozen=True, slots=True)
class _Rational:
    """A product of powers of polynomials in s alone, with numbers."""

    unit: complex
    factors: tuple[tuple[tuple[complex, ...], int], ...]  # coefficients, that of the highest power first

    @classmethod
    def of(cls, value: Factored, numbers: Mapping[str, complex]) -> _Rational:
        """Return a product in which all but s is known."""
        factors = []
        for polynomial, exponent in value.factors:
            own: dict[int, complex] = {}
            for monomial, integer in polynomial.terms():
                number, degree = complex(int(integer)), 0
                for name, e in zip(value.ring.names, monomial, strict=True):
                    if name == LAPLACE:
                        degree = int(e)
                    elif e and name in numbers:
                        number *= numbers[name] ** int(e)
                    elif e:
                        raise _InBallsError
                own[degree] = own.get(degree, 0j) + number
            factors.append((tuple(own.get(n, 0j) for n in range(max(own), -1, -1)), exponent))
        return cls(complex(value.unit), tuple(factors))

    def at(self, s: complex) -> Pair:
        """Return the value and the derivative."""
        total, rate = self.unit, 0j
        for coefficients, exponent in self.factors:
            value, slope, size = 0j, 0j, 0.0
            for c in coefficients:
                slope = slope * s + value
                value = value * s + c
                size = size * abs(s) + abs(c)
            _settle(value, size)
            total *= value**exponent
            rate += exponent * slope / value
        return total, total * rate


class SampledSums:
    """Samples a product of powers of sums of exponentials, where doubles can."""

    @classmethod
    def of(cls, sums: ExponentialValues) -> SampledSums | None:
        """Return what samples sums whose waves depend on s and numbers alone; None of others."""
        try:
            return cls(sums)
        except (_InBallsError, OverflowError):
            return None

    def __init__(self, sums: ExponentialValues) -> None:
        evaluator = sums.evaluator
        numbers = {}
        for name, value in evaluator.constants.items():
            if isinstance(value, acb_series):
                raise _InBallsError
            numbers[name] = complex(value)
        self._laws = [
            (law, tuple(_Rational.of(c, numbers) for c in law.characteristic))
            for law in evaluator.table.dispersions
            if law.wavenumbers
        ]
        self._names = [LAPLACE, *(name for law, _ in self._laws for name in law.wavenumbers)]
        self._arguments = [
            (
                self._names.index(a.wavenumber) if a.wavenumber else _Rational.of(a.rate, numbers),
                complex(at_centre(length)),
            )
            for a, length in zip(sums.arguments, sums.lengths, strict=True)
        ]
        self._sums = [self._tables(sums, i) for i in range(len(sums.sums))]

    def _tables(self, sums: ExponentialValues, number: int) -> tuple[Complexes, Complexes, Complexes, int]:
        """Return arguments' factors per term, exponents of names per monomial, and numbers of both."""
        terms, exponent = sums.sums[number]
        exponents = np.zeros((len(terms.terms), len(sums.arguments)), complex)
        for row, own in enumerate(terms.terms):
            for i, a, b in own:
                exponents[row, i] = complex(a, b)
        monomials, matrix = sums.matrices[number]
        powers = np.zeros((len(monomials), len(self._names)), complex)
        for row, monomial in enumerate(monomials):
            for name, e in monomial:
                powers[row, self._names.index(name)] = e
        numbers = np.array([[complex(x) for x in row] for row in matrix.tolist()])
        if not np.all(np.isfinite(numbers)):
            raise _InBallsError
        return exponents, powers, numbers, exponent

    def at(self, z: complex) -> Sample | None:
        """Return the sample at ``s = exp(z)``, with the slope in z; None where digits cancel."""
        try:
            with np.errstate(all="ignore"):  # what is not finite is not settled
                return self._sampled(cmath.exp(z))
        except (_InBallsError, OverflowError, ValueError, ZeroDivisionError):
            return None

    def _sampled(self, s: complex) -> Sample:
        pairs = [(s, 1 + 0j)]
        for law, coefficients in self._laws:
            pairs += _wavenumbers(law, [c.at(s) for c in coefficients])
        arguments, rates = [], []
        for source, length in self._arguments:
            value, rate = pairs[source] if isinstance(source, int) else _negated(source.at(s))
            arguments.append(value * length)
            rates.append(rate * length)
        logarithms = np.array([cmath.log(value) for value, _ in pairs])
        relative = np.array([rate / value for value, rate in pairs])
        log, slope = 0j, 0j
        for exponents, powers, numbers, exponent in self._sums:
            grown, growth = exponents @ np.array(arguments), exponents @ np.array(rates)
            largest = complex(grown[np.argmax(grown.real)]) if len(grown) else 0j
            monomials = np.exp(powers @ logarithms)
            scaled = np.exp(grown - largest)
            value = complex(scaled @ (numbers @ monomials))
            _settle(value, float(np.abs(scaled) @ (np.abs(numbers) @ np.abs(monomials))))
            turned = numbers @ (monomials * (powers @ relative)) + growth * (numbers @ monomials)
            log += exponent * (largest + cmath.log(value))
            slope += exponent * complex(scaled @ turned) / value
        return Sample(log, s * slope)


def _settle(value: complex, size: float) -> None:
    """Refuse a value that lost more digits than may be lost, or is none."""
    if not (isfinite(size) and abs(value) > SETTLED * size):
        raise _InBallsError


def _negated(pair: Pair) -> Pair:
    return -pair[0], -pair[1]


def _root(pair: Pair) -> Pair:
    root = cmath.sqrt(pair[0])
    return root, pair[1] / (2 * root)


def _wavenumbers(law: Dispersion, c: Sequence[Pair]) -> list[Pair]:
    """Return a law's wavenumbers in the order of their names; every branch serves, as in balls."""
    if law.kind == "wave":
        return [_root(_negated(c[0]))]
    if law.kind == "bending":
        return [_root(_root((c[0][0] / 4, c[0][1] / 4)))]
    (product, steep), (middle, slope) = c[0], (-c[2][0] / 2, -c[2][1] / 2)
    apart, widening = middle * middle - product, 2 * middle * slope - steep
    _settle(apart, abs(middle) ** 2 + abs(product))
    half, rate = _root((apart, widening))
    squares = [(middle + half, slope + rate), (middle - half, slope - rate)]
    for value, _ in squares:
        _settle(value, abs(middle) + abs(half))
    return [_root(square) for square in squares]
