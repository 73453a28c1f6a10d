"""Polynomials in kernels as sums of exponentials, in balls, series and doubles, against mpmath."""

from functools import cache
from itertools import product

import mpmath
from flint import acb, acb_series, arb
from mpmath import mp, mpc

from symflex.algebra.exponential_sum import arguments_of, exponential_sum
from symflex.balls import expansion, precision
from symflex.roots.functions.exponential_values import ExponentialValues
from tests.unit.roots.distributed_models import DELAY_LOOP, ROD, SLIDING_FREE, bound

PLACES = [0.7, 2 + 3j, 1 + 8j, 30j]


class Polynomials:
    """Polynomials in s, wavenumbers and kernels of a model, as sums and as functions of mpmath."""

    def __init__(self, text, make):
        source = bound(text)
        ring, self.table = source.ratio.ring, source.kernels
        names = {k.function: ring.generator(k.generator) for k in self.table.kernels}
        if self.table.wavenumbers:
            names["q"] = ring.generator(self.table.wavenumbers[0])
        names["s"] = ring.context.gen(0)
        arguments = arguments_of(self.table)
        self.made = make
        sums = [exponential_sum(ring, self.table, arguments, p) for p in make(**names)]
        self.sums = sums
        with precision(120):
            self.values = ExponentialValues(
                source.kernel_values(), arguments, tuple((each, 1) for each in sums)
            )

    def exact(self, s, q, length):
        kernels = {
            name: getattr(mpmath, name)(q * length)
            for name in {k.function for k in self.table.kernels}
            if name != "exp"
        }
        if any(k.function == "exp" for k in self.table.kernels):
            kernels["exp"] = mpmath.exp(-s * length)
        if self.table.wavenumbers:
            kernels["q"] = q
        return self.made(s=s, **kernels)


def beam():
    # E I = rho A = l = 1: q^4 = -s^2/4 times -1, so q = sqrt(s/2), and kernels are of q l.
    return Polynomials(
        SLIDING_FREE,
        lambda s, q, cosh, sinh, cos, sin: [
            3 * s**2 * cosh**3 * sin**2 * cos - 5 * q * sinh * sin + 7,
            cosh * sin * 2 - s * sinh**2 * cos,
            (cosh + sinh) * (cos - sin) * q**3,
            sin**3 * sinh**3 + s**0,
        ],
    )


def rod():
    return Polynomials(ROD, lambda s, q, cosh, sinh: [cosh * 2 + s * sinh, sinh**3 - q * cosh, q**2 + s])


def delay():
    return Polynomials(DELAY_LOOP, lambda s, exp: [s + 2 * exp, s**2 * exp**3 - exp + 1, s**0 * 3])


MODELS = {
    "beam": (beam, lambda s: mpmath.sqrt(s / 2), 1),
    "rod": (rod, lambda s: s, 1),
    "delay": (delay, lambda s: s, mpmath.mpf(1) / 2),
}


@cache
def models():
    """Return the polynomials of every model, and what they are by mpmath."""

    def exactly(made, wavenumber, length):
        return lambda s: made.exact(mpmath.mpmathify(s), wavenumber(mpmath.mpmathify(s)), length)

    return [(made := make(), exactly(made, *more)) for make, *more in MODELS.values()]


def close(found, expected, digits=25):
    return abs(
        mpc(found.real.mid().str(40, radius=False), found.imag.mid().str(40, radius=False)) - expected
    ) < (abs(expected) * mpmath.mpf(10) ** -digits)


def test_sums_have_the_values_and_slopes_of_polynomials_in_kernels():
    for (made, exact), s in product(models(), PLACES):
        with mp.workdps(80), precision(120):
            place, series = made.values.at(acb(s)), made.values.at(expansion(acb(s)))
            for i, expected in enumerate(exact(s)):
                assert close(made.values.value(i, place), expected), (i, s)
                slope = mpmath.diff(
                    lambda x, f=exact, i=i: f(x)[i], mpmath.mpmathify(s), h=mpmath.mpf(10) ** -35
                )
                found = made.values.value(i, series)
                found = found[1] if isinstance(found, acb_series) else acb(0)
                assert close(found, slope) if slope else found.contains(0), (i, s)


def test_a_ball_of_places_has_a_ball_of_values():
    for made, exact in models():
        with mp.workdps(50), precision(120):
            place = made.values.at(acb(arb(2, 0.01), arb(3, 0.01)))
            for i, s in product(range(len(made.sums)), (2 + 3j, 2.009 + 3.009j, 1.991 + 3.009j)):
                expected = exact(s)[i]
                exactly = acb(float(expected.real), float(mpmath.im(expected)))
                assert made.values.value(i, place).contains(exactly), (i, s)
