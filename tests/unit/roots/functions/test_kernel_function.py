"""Functions with kernels against closed forms: values, slopes, turns, symmetry, and how fast they turn."""

from functools import cache
from types import SimpleNamespace

import mpmath
import pytest
from flint import acb, arb
from mpmath import mp, mpc

from symflex.algebra import Factored, Ring
from symflex.balls import precision
from symflex.errors import ModelError, UncertifiedError
from symflex.roots.functions.kernel_function import KernelFunction, divisors_in_s
from tests.unit.roots.distributed_models import DELAY_LOOP, FREE, ON_A_FOUNDATION, ROD, SLIDING_FREE, bound

BITS = 160


def bending(s):
    """Return x with x^4 = -s^2, of the branch with a positive real part."""
    return mpmath.sqrt(mpmath.mpmathify(s)) * mpmath.expjpi(mpmath.mpf(1) / 4)


def sliding_free(s):
    x = bending(s)
    return (mpmath.cos(x) * mpmath.sinh(x) + mpmath.sin(x) * mpmath.cosh(x)) / x


def free(s):
    x = bending(s)
    return mpmath.cos(x) * mpmath.cosh(x) - 1


def on_a_foundation(s):
    # g^2 = s^2 + 1: 2 s^2 sinh(g)/g + cosh(g)
    g = mpmath.sqrt(s * s + 1)
    return 2 * s * s * mpmath.sinh(g) / g + mpmath.cosh(g)


TWO_RODS = """
symflex = 1
[parameters]
E = "1 N/m^2"
A = "1 m^2"
rho = "1 kg/m^3"
l = "1 m"
[elements]
a = {{ type = "rod", between = ["ground", "x"], E = "E", A = "A", rho = "rho", l = "l" }}
b = {{ type = "rod", between = ["x", "y"], E = "{modulus}*E", A = "A", rho = "rho", l = "pi*l" }}
[inputs]
F = {{ force = "y" }}
[outputs]
Y = "y"
"""
TWO_DELAYS = """
symflex = 1
blocks.D = { type = "delay", T = 0.5 }
blocks.L = { type = "delay", T = 2 }
inputs.u = {}
outputs.y = "u/(s + 2*D + 3*L)"
"""


def two_rods(speed):
    """Return what vanishes where z coth(l s/c) of one and z tanh(l s/c) of the other add up to 0."""
    return lambda s: (
        mpmath.cosh(s) * mpmath.cosh(mp.pi * s / speed)
        + speed * mpmath.sinh(s) * mpmath.sinh(mp.pi * s / speed)
    )


CLOSED = {
    "two lengths": (TWO_RODS.format(modulus=1), two_rods(1)),
    "two speeds": (TWO_RODS.format(modulus=4), two_rods(2)),
    "two delays": (TWO_DELAYS, lambda s: s + 2 * mpmath.exp(-s / 2) + 3 * mpmath.exp(-2 * s)),
    "rod": (ROD, lambda s: 2 * mpmath.cosh(s) + s * mpmath.sinh(s)),
    "delay": (DELAY_LOOP, lambda s: s + 2 * mpmath.exp(-s / 2)),
    "sliding and free": (SLIDING_FREE, sliding_free),
    "free": (FREE, free),
    "on a foundation": (ON_A_FOUNDATION, on_a_foundation),
}


def function_of(text):
    source = bound(text)
    return KernelFunction(source, source.den)


@cache
def models():
    """Return every function with its name and its closed form."""
    return [(name, function_of(text), closed) for name, (text, closed) in CLOSED.items()]


def test_about_a_ball_values_are_of_its_middle_and_slopes_of_all_of_it():
    centre, ball = acb(2, 3), acb(arb(2, 0.01), arb(3, 0.01))
    for name, function, _ in models():
        with precision(BITS):
            exact, wide = function.enclosed(centre, BITS), function.enclosed_about(ball, centre, BITS)
            corner = function.enclosed(acb(2.009, 3.009), BITS)
            for (value, derivative, e), (found, around, exponent), other in zip(
                exact, wide, corner, strict=True
            ):
                assert (found - value).contains(0), name
                assert found.rel_accuracy_bits() > 100, name
                assert around.contains(derivative.mid()), name
                assert around.contains(other[1].mid()), name
                assert e == exponent, name


def test_how_far_it_turns_between_two_points_is_the_difference_of_logarithms():
    start, end = acb(2, 3), acb(2.05, 3.1)
    for name, function, closed in models():
        with precision(BITS):
            ball = acb(arb(2.025, 0.03), arb(3.05, 0.06))
            off, turn = function.turn_of_exponentials(ball, start, end, BITS)
            assert off < 1.5, name
            first, last = function.value(start, BITS), function.value(end, BITS)
            assert (turn - (last / first).arg()).contains(0), name
            assert turn.rad() < 1e-20, name
        # Of the closed form, whose power of s turns besides.
        with mp.workdps(40):
            s, t = mpc(2, 3), mpc("2.05", "3.1")
            own = float(turn) / function.power - float(mpmath.arg(closed(t) / closed(s)))
            per_power = float(mpmath.arg(t / s))
            assert own / per_power == pytest.approx(round(own / per_power), abs=1e-6), name


def kernels_of(text):
    """Return a function with kernels, what makes a product of a polynomial in these, and their names."""
    source = bound(text)
    ring = source.ratio.ring
    names = {k.function: ring.generator(k.generator) for k in source.kernels.kernels}
    return source, lambda polynomial: Factored.polynomial(ring, polynomial), names


def test_what_is_0_everywhere_or_depends_on_the_branch_of_a_wavenumber_is_no_function():
    source, made, names = kernels_of(ROD)
    with pytest.raises(ModelError) as failed:
        KernelFunction(source, made(names["cosh"] ** 2 - names["sinh"] ** 2 - 1))
    (diagnostic,) = failed.value.diagnostics
    assert diagnostic.code == "SF231"
    assert diagnostic.message == "a part of X/F is 0/0 or 0 at every s for these values"
    assert diagnostic.hint == "write a rigid or massless limit as a model of its own"
    # cosh(x) + sinh(x), where x may be -x.
    for text in (ROD, SLIDING_FREE):
        source, made, names = kernels_of(text)
        with pytest.raises(UncertifiedError) as failed:
            KernelFunction(source, made(names["cosh"] + names["sinh"]))
        (diagnostic,) = failed.value.diagnostics
        assert diagnostic.code == "SF404"
        assert diagnostic.message == f"a part of {source.name} has no value of its own for every s"


def test_what_coefficients_are_divided_by_is_what_depends_on_s_below():
    # c (s + 2)/(s + 1)^2 and 1/c: of these 1/(s + 1)^2 alone.
    ring = Ring(("s", "c"))
    s, c = (Factored.generator(ring, name) for name in ring.names)
    law = SimpleNamespace(matrix=((c * (s + 2) / (s + 1) ** 2, 1 / c), (s, 1 / (s * c))))
    assert [str(f.factors) for f in divisors_in_s(law)] == [str((1 / x).factors) for x in ((s + 1) ** 2, s)]
