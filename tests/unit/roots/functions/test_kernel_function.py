"""Functions with kernels against closed forms: values, slopes, turns, symmetry, and how fast they turn."""

from __future__ import annotations

from functools import cache
from itertools import product

import mpmath
import pytest
from flint import acb, arb
from mpmath import mp, mpc

from symflex.algebra import Factored
from symflex.balls import precision
from symflex.errors import ModelError, UncertifiedError
from symflex.roots.functions.kernel_function import (
    KernelFactors,
    KernelFunction,
    has_kernels,
    split_off_kernels,
)
from tests.unit.roots.distributed_models import (
    DELAY_LOOP,
    FREE,
    KELVIN_VOIGT,
    ON_A_FOUNDATION,
    ROD,
    SLIDING_FREE,
    bound,
)

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
PLACES = [0.7, 2 + 3j, -1 + 4j, 0.5 - 2j]


def function_of(text):
    source = bound(text)
    return KernelFunction(source, source.den)


@cache
def models():
    """Return every function with its name and its closed form."""
    return [(name, function_of(text), closed) for name, (text, closed) in CLOSED.items()]


def number(value):
    return mpc(value.real.mid().str(40, radius=False), value.imag.mid().str(40, radius=False))


def slope(closed, s):
    """Return the logarithmic derivative in ln(s)."""
    s = mpmath.mpmathify(s)
    return s * mpmath.diff(closed, s, h=mpmath.mpf(10) ** -25) / closed(s)


def test_values_are_those_of_the_closed_form_but_for_a_power_of_s_and_a_number():
    for name, function, closed in models():
        with mp.workdps(50):
            ratios = [number(function.value(acb(s), BITS)) / closed(mpmath.mpmathify(s)) for s in PLACES]
            grown = mpmath.log(abs(ratios[1] / ratios[0])) / mpmath.log(abs(PLACES[1] / PLACES[0]))
            power = round(float(grown))
            numbers = [r / mpmath.mpmathify(s) ** power for r, s in zip(ratios, PLACES, strict=True)]
            assert all(abs(each / numbers[0] - 1) < 1e-25 for each in numbers), name


def test_slopes_are_those_of_the_closed_form_but_for_one_whole_number():
    for (name, function, closed), s in product(models(), PLACES):
        with mp.workdps(60):
            z = complex(mpmath.log(mpmath.mpmathify(s)))
            here = complex(slope(closed, mpmath.exp(z)))
            assert abs(here - complex(slope(closed, s))) < 1e-9, name
            over = function.at_logarithm(z).slope - here
            assert over == pytest.approx(round(over.real), abs=1e-9), (name, s)
            there = function.at_point(acb(PLACES[0])).slope - complex(slope(closed, PLACES[0]))
            assert over == pytest.approx(there, abs=1e-9), (name, s)


def test_factors_multiply_to_the_value():
    s = acb(2, 3)
    for name, function, _ in models():
        with precision(BITS):
            total, change = acb(1), acb(0)
            for value, derivative, exponent in function.enclosed(s, BITS):
                total *= value**exponent
                change += exponent * derivative / value
            assert total.overlaps(function.value(s, BITS)) or function.power > 1, name
            assert complex(function.power * s * change) == pytest.approx(function.at_point(s).slope), name


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


def test_a_ball_that_holds_a_root_turns_anywhere():
    off, _ = function_of(DELAY_LOOP).turn_of_exponentials(acb(arb(0, 9), arb(0, 9)), acb(0), acb(1), BITS)
    assert off > 1.5


def test_without_losses_and_delays_roots_mirror_each_other_in_both_axes():
    for text, is_even in [
        (ROD, True),
        (FREE, True),
        (SLIDING_FREE, True),
        (ON_A_FOUNDATION, True),
        (DELAY_LOOP, False),
        (KELVIN_VOIGT, False),
    ]:
        assert function_of(text).is_even is is_even


def test_polynomials_in_kernels_are_evaluated_as_they_stand_on_the_branch_of_a_place_nearby():
    for s in PLACES:
        function = function_of(ROD)
        with precision(BITS):
            factors = [factor for factor, _ in function.part.factors]
            plain = KernelFactors(function._kernel_values(BITS), factors)
            place = plain.at(acb(s))
            for i, (value, _, _) in enumerate(function.enclosed(acb(s), BITS)):
                assert (abs(plain.value(i, place)) - abs(value)).contains(0), s
                assert plain.value(i, place).rel_accuracy_bits() > 100, s
    # sqrt(s^2) changes its sign on the imaginary axis.
    function = function_of(ROD)
    (name,) = function.bound.kernels.wavenumbers
    with precision(BITS):
        plain = KernelFactors(function._kernel_values(BITS), [])
        around = plain.at(acb(arb(0, 0.1), 3))
        right, left = (plain.at(acb(re, 3), around).values[name] for re in (0.05, -0.05))
        assert abs(abs(right - left) - 0.1) < 1e-15


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


def test_powers_of_wavenumbers_that_change_with_the_branch_are_divided_by():
    cosh, sinh, cos, sin, sqrt = mpmath.cosh, mpmath.sinh, mpmath.cos, mpmath.sin, mpmath.sqrt

    def of_rods(ch, sh):
        return [sh, ch * sh**3, ch * sh**2]

    def of_beams(ch, sh, co, si):
        # of q = sqrt(s/2), which may be turned by 90 degrees
        return [sh * si, ch * si + sh * co, ch * co]

    for text, make, wavenumber, powers in (
        (ROD, of_rods, lambda s: s, (1, 1, 0)),
        (SLIDING_FREE, of_beams, lambda s: sqrt(s / 2), (2, 1, 0)),
    ):
        source, made, names = kernels_of(text)
        values = {"cosh": cosh, "sinh": sinh, "cos": cos, "sin": sin}
        order = [name for name in values if name in names]
        for i, power in enumerate(powers):
            function = KernelFunction(source, made(make(*(names[n] for n in order))[i]))
            assert function.power == 1
            with mp.workdps(50):
                for s in PLACES:
                    q = wavenumber(mpmath.mpmathify(s))
                    expected = make(*(values[n](q) for n in order))[i] / q**power
                    assert abs(number(function.value(acb(s), BITS)) - expected) < 1e-25 * abs(expected), i


def test_laws_of_waves_have_poles_where_a_lossy_beam_no_longer_resists():
    # 1 + s/250 = 0
    function = function_of(KELVIN_VOIGT)
    assert function.is_analytic_on(acb(arb(-240, 9), arb(0, 9)), BITS)
    assert not function.is_analytic_on(acb(arb(-240, 11), arb(0, 11)), BITS)


def test_where_a_lossy_member_no_longer_resists_nothing_is_finite():
    for section in (
        'type = "beam", theory = "timoshenko", I = "0.01 m^4", G = "0.8 Pa", kappa = "5/6", A = "1 m^2"',
        'type = "rod", A = "A_0*(1 - x/(2*l))^4"',
    ):
        text = 'symflex = 1\nparameters = { A_0 = "1 m^2", l = "1 m" }\n'
        text += f'elements.arm = {{ {section}, l = "l", '
        text += 'between = ["ground", "tip"], E = "2 Pa", rho = "1 kg/m^3", eta = "0.02 s" }\n'
        function = function_of(f'{text}inputs.F = {{ force = "tip" }}\noutputs.y = "tip"')
        found = function.enclosed(acb(-50), BITS)
        assert not all(value.is_finite() and slope.is_finite() for value, slope, _ in found), section


def test_a_root_has_no_logarithm():
    # cosh(s) of a rod without a tip, whose roots doubles do not know, and s of a loop without delay at 0.
    source = bound(DELAY_LOOP)
    s = source.ratio.ring.context.gen(0)
    exact = KernelFunction(source, source.den * source.den.polynomial(source.ratio.ring, s - 3))
    assert exact.at_point(acb(3)) is None
    assert exact.at_point(acb(3.5)) is not None


def test_factors_are_those_with_kernels_and_those_with_s_alone():
    source = bound(DELAY_LOOP)
    ring, table = source.ratio.ring, source.kernels
    s, decay = ring.context.gen(0), ring.generator(table.kernels[0].generator)
    value = source.den.polynomial(ring, s + 5) ** 2
    mixed = source.den.polynomial(ring, s - decay)
    alone = source.den.polynomial(ring, decay)
    plain, found = split_off_kernels(value * mixed * alone, table)
    assert [(str(f), e) for f, e in plain.factors] == [(str(f), e) for f, e in value.factors]
    assert [(str(f), e) for f, e in found.factors] == [(str(f), e) for f, e in mixed.factors]
    assert [has_kernels(each, table) for each in (value, mixed, alone)] == [False, True, True]
    # Of a denominator there are no roots.
    assert not has_kernels(mixed**-1, table)


# Pinned, E = I = rho = A = l = G = 1 and kappa = 1/2: 2 w^4 - (1 + 3 k^2) w^2 + k^4 = 0 with k = n pi.
TIMOSHENKO = """
symflex = 1
[elements.arm]
type = "beam"
between = ["p", "q"]
theory = "timoshenko"
E = "1 N/m^2"
I = "1 m^4"
rho = "1 kg/m^3"
A = "1 m^2"
l = "1 m"
G = "1 N/m^2"
kappa = 0.5
[elements]
near = { type = "pin", at = "p" }
far = { type = "pin", at = "q" }
[inputs]
M = { torque = "p.theta" }
[outputs]
angle = "p.theta"
"""


def test_of_two_wavenumbers_either_may_be_the_first():
    for n in [1, 2]:
        for sign in [1, -1]:
            function = function_of(TIMOSHENKO)
            k = n * mp.pi
            with mp.workdps(40):
                b = 1 + 3 * k**2
                w = mpmath.sqrt((b + sign * mpmath.sqrt(b * b - 8 * k**4)) / 4)
                here, beside = (
                    abs(number(function.value(acb(0, arb(mp.nstr(w * scale, 30))), 300)))
                    for scale in (1, 1 + 1e-6)
                )
            assert here < 1e-6 * beside, (n, sign)
