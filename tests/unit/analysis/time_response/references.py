"""Responses computed by other means: matrix exponentials of companion matrices, to 40 digits."""

from fractions import Fraction

import mpmath


def exact(number):
    """Return what a decimal means, not the double next to it."""
    return Fraction(str(number))


def of_quotient(num, den, integrations, times):
    """Return the inverse Laplace transform of num/den/s^integrations at times, coefficients descending.

    The quotient is proper enough to have no impulse: degree of num < degree of den + integrations.
    """
    with mpmath.workdps(40):
        plain = [[mpmath.mpf(f.numerator) / f.denominator for f in map(exact, side)] for side in (num, den)]
        below = plain[1] + [mpmath.mpf(0)] * integrations
        above = [c / below[0] for c in plain[0]]
        below = [c / below[0] for c in below]
        n = len(below) - 1
        A = mpmath.zeros(n)
        for i in range(n - 1):
            A[i, i + 1] = 1
        for j in range(n):
            A[n - 1, j] = -below[n - j]
        B = mpmath.zeros(n, 1)
        B[n - 1] = 1
        C = mpmath.zeros(1, n)
        for k, c in enumerate(reversed(above)):
            C[k] = c
        return [(C * mpmath.expm(A * mpmath.mpf(t)) * B)[0] for t in times]


def expanded(*factors):
    """Return the descending coefficients of a product of polynomials."""
    found = [Fraction(1)]
    for factor in factors:
        product = [0] * (len(found) + len(factor) - 1)
        for i, a in enumerate(found):
            for j, b in enumerate(factor):
                product[i + j] += a * exact(b)
        found = product
    return found


def written(coefficients):
    """Return descending coefficients as an expression of s."""
    n = len(coefficients) - 1
    return " + ".join(f"({exact(c)})*s^{n - k}" for k, c in enumerate(coefficients))
