"""Functions without losses made of hyperbolic and circular functions of x, the root of s."""

from itertools import product

from flint import arb
from mpmath import mpc

from symflex.algebra.exponential_sum import ExponentialSum
from symflex.roots.axes.axis_function import Enclosures
from symflex.roots.axes.harmonic_sum import LosslessFunction

RATES, DEGREES = (1.25, 0.75, 0.5), (1, 1, 2)
"""Of three arguments, of x twice and of x^2."""
CONSTANT = 3
KERNELS = {
    # a and b of the exponent (a + j b) x, and what twice the function is made of
    "cosh": (((1, 0), (1, 0)), ((-1, 0), (1, 0))),
    "sinh": (((1, 0), (1, 0)), ((-1, 0), (-1, 0))),
    "cos": (((0, 1), (1, 0)), ((0, -1), (1, 0))),
    "sin": (((0, 1), (0, -1)), ((0, -1), (0, 1))),
}


def expanded(sums):
    """Return sums of (number, power of x, power of the constant, kernels by argument), 8 times, as terms."""
    found = {}
    for number, power, of_constant, kernels in sums:
        monomial = (*(((0, power),) if power else ()), *(((1, of_constant),) if of_constant else ()))
        scale = number * 2 ** (3 - len(kernels))
        for pieces in product(*(KERNELS[name] for _, name in kernels)):
            exponents, factor = {}, mpc(scale)
            for (argument, _), ((a, b), weight) in zip(kernels, pieces, strict=True):
                one, other = exponents.get(argument, (0, 0))
                exponents[argument] = (one + a, other + b)
                factor *= mpc(*weight)
            key = tuple(sorted((i, a, b) for i, (a, b) in exponents.items() if a or b))
            terms = found.setdefault(key, {})
            re, im = terms.get(monomial, (0, 0))
            terms[monomial] = (re + int(factor.real), im + int(factor.imag))
    return ExponentialSum(found)


def function_of(*sums):
    enclosures = Enclosures(200, (arb(CONSTANT),), tuple(arb(r) for r in RATES), DEGREES)
    return LosslessFunction(tuple((expanded(each), exponent) for each, exponent in sums), enclosures)
