"""Radii beyond which no root lies in the right half-plane: Cauchy's bound, and its edge."""

from fractions import Fraction
from itertools import product
from math import log, pi, prod

import mpmath
import pytest
from flint import acb, arb

from symflex import pipeline
from symflex.balls import ball, precision
from symflex.roots.distributed.far_out import (
    ADVANCED,
    DELAY_LEADS,
    EVERY_DELAYED,
    NARROW,
    NEUTRAL,
    NO_FORMULA,
    NO_LOSS,
    SECTORS,
    FunctionFarOut,
    _at_infinity,
    _dominant,
    _pair,
    _Power,
    _turned,
    right_tail,
)


def bound(text):
    model = pipeline.loads(text)
    return pipeline.derive_bound(model, model.transfer_functions)[0]


def delayed(denominator):
    return bound(f"""symflex = 1
blocks.D = {{ type = "delay", T = "0.7 s" }}
blocks.E = {{ type = "delay", T = "0.3 s" }}
inputs.u = {{}}
outputs.y = "u/({denominator})"
""")


def tail(function, start=1e-3):
    return right_tail(function, [prod(f**e for f, e in function.den.factors if e > 0)], [acb(1)], start)


def test_a_root_on_the_axis_is_never_left_outside():
    # s + (pi/2) exp(-s): a root at j pi/2, just where Cauchy's bound ends.
    function = bound("""symflex = 1
blocks.D = { type = "delay", T = "1 s" }
inputs.u = {}
outputs.y = "u/(s + 1*D)"
""")
    ring = function.ratio.ring
    s, decay = ring.context.gen(0), ring.generator(function.kernels.generators[0])
    for start in (0.5, 1.5, pi / 2 * (1 - 1e-9)):
        with precision(64):
            found = right_tail(function, [s, decay], [acb(1), acb(arb.pi() / 2)], start)
        assert pi / 2 <= found <= pi / 2 * NARROW * 1.001
    with precision(64):
        turned = right_tail(function, [s, decay], [acb(0, 1), acb(0, arb.pi() / 2)], pi / 2 * (1 + 1e-6))
    assert turned == pi / 2 * (1 + 1e-6)


ELEMENT = """symflex = 1
elements.part = {{ type = "{kind}", between = ["ground", "x"], {values}, l = 1 }}
inputs.F = {{ force = "x" }}
outputs.X = "x"
"""
BEAM = "E = 1, I = 1, rho = 1, A = 1"
TIMOSHENKO = ', theory = "timoshenko", G = 1, kappa = 0.5'


def test_where_no_term_outweighs_the_others_it_is_said_why():
    for function, reason in [
        (lambda: delayed("1 + s*D"), DELAY_LEADS),
        (lambda: delayed("s + 3*s^2*E + 1"), DELAY_LEADS),
        (lambda: delayed("s + s^2*D + s^2*E + 1"), ADVANCED),
        (lambda: delayed("s + s*D + 1"), NEUTRAL),
        (lambda: delayed("s + 2*s*D + 1"), DELAY_LEADS),
        (lambda: delayed("3*D + E"), EVERY_DELAYED),
        (lambda: bound(ELEMENT.format(kind="rod", values="E = 1, rho = 1, A = 1")), NO_LOSS),
        (lambda: bound(ELEMENT.format(kind="beam", values=BEAM)), NO_LOSS),
        (lambda: bound(ELEMENT.format(kind="beam", values=BEAM + TIMOSHENKO)), NO_LOSS),
    ]:
        found = tail(function())
        assert found == reason, function


def test_losses_in_the_material_end_the_poles():
    for kind, eta in (("rod", 0.5), ("beam", 0.01)):
        values = (BEAM if kind == "beam" else "E = 1, rho = 1, A = 1") + f', eta = "{eta} s"'
        found = tail(bound(ELEMENT.format(kind=kind, values=values)), 1.0)
        # From 1/eta on the loss is more than the stiffness, and waves decay within a wavelength.
        assert isinstance(found, float), kind
        assert 1 / eta < found < 10 / eta, kind


def test_two_wavenumbers_of_a_damped_timoshenko_beam_are_enclosed_beyond_a_radius():
    function = bound(ELEMENT.format(kind="beam", values=BEAM + TIMOSHENKO + ', eta = "0.01 s"'))
    assert 100 < tail(function, 1.0) < 2000
    (law,) = function.kernels.dispersions
    with precision(64):
        pair = _pair(function.kernel_values(), law, 2000.0)
        for radius, angle in product([2001, 1e4, 1e7], [0, 0.4, 1.5, -1.2, 3]):
            s = mpmath.rect(radius, angle)
            bending, shear = s**2 / (1 + s / 100), 2 * s**2 / (1 + s / 100)  # rho s^2/E, rho s^2/(kappa G)
            middle, product_of_roots = (bending + shear) / 2, bending * (shear + 1)
            root = mpmath.sqrt(middle**2 - product_of_roots)
            for square in (middle + root, middle - root):
                powers = [(acb(s.real, s.imag) ** ball(p.power) * p.unit) ** 2 for p in pair]
                assert any(x.contains(acb(square.real, square.imag)) for x in powers), (radius, angle)


def test_a_sector_holds_its_directions_and_no_others():
    for power, sector in product([Fraction(1), Fraction(1, 2)], [0, 17, SECTORS - 1]):
        with precision(64):
            (found,) = _turned([_Power(power, acb(2))], sector)
            assert found.power == power, sector
            for i in range(-20, 31):
                angle = (sector + i / 10) * pi / (2 * SECTORS) * float(power)
                held = found.unit.overlaps(acb(2) * acb(0, angle).exp())
                if 0 <= i <= 10:
                    assert held, (power, sector)
                elif not -10 < i < 20:
                    assert not held, (power, sector)
            assert float(abs(found.unit).mid()) == pytest.approx(2, rel=0.01), (power, sector)


# ------------------------------------------------------------------------------- waves with known roots


def field(equation, *conditions, length=1):
    listed = ", ".join(f'"{each}"' for each in conditions)
    return bound(f"""symflex = 1
[fields.w]
domain = ["0", "{length}"]
equation = "{equation}"
conditions = [{listed}]
[inputs]
F = {{}}
[outputs]
y = "w({length})"
""")


CLAMPED = ("w(0) = 0", "w'(0) = 0", "w''(1) = 0", "w'''(1) = F")


def test_fields_with_poles_along_the_positive_axis_have_no_end():
    for equation, conditions, reason in [
        # Diffusion backwards: cos(sqrt(s)) has the roots ((n + 1/2) pi)^2; the beam's are the cantilever's
        # wavenumbers to the fourth.
        ("w'' + s*w = 0", ("w(0) = 0", "w'(1) = F"), NO_LOSS),
        ("w'''' - s*w = 0", CLAMPED, NO_LOSS),
        ("w''' - s*w = 0", ("w(0) = 0", "w'(0) = 0", "w'(1) = F"), NO_FORMULA),
    ]:
        found = tail(field(equation, *conditions))
        assert found == reason, (equation, conditions)


def test_transport_that_grows_on_its_way_is_not_taken_for_a_delay():
    # 2 + exp(1 - s): abs(exp(-s)) = 2/e, at s = 1 - log(2) + j (2n + 1) pi.
    function = field("w' + (s - 1)*w = 0", "w(0) = F")
    shifted = function.ratio.ring.generator(function.kernels.kernels[0].generator)
    assert isinstance(right_tail(function, [shifted**0, shifted], [acb(2), acb(1)], 1.0), str)


def test_transport_with_decay_is_a_delay_that_fades():
    # 1 - r exp(-0.2) exp(-s): poles at Re s = log(r) - 0.2.
    for share, is_bounded in ((1.1, True), (1.2, True), (1.23, False), (1.3, False)):
        found = tail(field("w' + (s + 0.2)*w = 0", f"w(0) = F + {share}*w(1)"))
        assert isinstance(found, float) == is_bounded, share


def lossy_rod(modulus, eta):
    return bound(ELEMENT.format(kind="rod", values=f'E = "{modulus} Pa", rho = 1, A = 1, eta = "{eta} s"'))


def test_beyond_a_radius_a_rational_function_is_a_power_of_s_times_what_is_in_the_ball():
    for eta, radius in product([10.0, 0.5], [5.0, 40.0]):
        function = lossy_rod("2*pi", eta)
        with precision(64):
            kernels = function.kernel_values()
            power, ball = _at_infinity(kernels, function.kernels.dispersions[0].characteristic[0], radius)
            assert power == 1, (eta, radius)
            for size in (1.0001, 1.5, 4, 1000, 1e12):
                for k in range(-12, 13):
                    s = acb(radius * size) * acb(0, arb.pi() * k / 24).exp()
                    assert ball.contains((-s / (2 * arb.pi() * (1 + eta * s))).mid()), radius
            # Of eta + 1/s a half side of 1/R, and no more.
            limit = -1 / (2 * arb.pi() * eta)
            assert ball.contains(acb(limit.mid())), (eta, radius)
            share = 1 / (eta * radius)
            assert abs(ball - limit).upper() < (abs(limit) * 2 * share / (1 - 2 * share)).lower(), eta


# ------------------------------------------------------------------- sums of a few exponentials, by hand

GROWING, LEVEL, DECAYING = ((0, 1, 0),), (), ((0, -1, 0),)
REAL = [_Power(Fraction(1), acb(1))]
TURNING = [_Power(Fraction(1), acb(0, 1))]


def powers(**terms):
    """Return amplitudes, each named by the power of s it stands before: p2 = 3 is 3 s^2."""
    return {Fraction(name[1:]): acb(number) for name, number in terms.items()}


def test_one_term_outweighs_the_others_from_a_radius_on():
    for terms, arguments, edge in [
        # exp(r) > 3
        ({GROWING: powers(p0=1), LEVEL: powers(p0=3)}, REAL, log(3)),
        ({GROWING: powers(p0=2), LEVEL: powers(p0=-3), DECAYING: powers(p0=0)}, REAL, log(1.5)),
        ({GROWING: powers(p0=1), DECAYING: powers(p0=3)}, REAL, log(3) / 2),
        # exp(r) > 3 r^2, beyond the last of three places where both are equal
        (
            {GROWING: powers(p0=1), LEVEL: powers(p2=3)},
            REAL,
            float(mpmath.findroot(lambda r: mpmath.exp(r) - 3 * r**2, 4)),
        ),
        # r > 2 of one exponential alone
        ({GROWING: powers(p1=1, p0=2)}, REAL, 2),
        ({LEVEL: powers(p2=1, p1=-1, p0=-2)}, REAL, 2),
        # r - 2 > 3 exp(-r)
        (
            {GROWING: powers(p1=1, p0=2), LEVEL: powers(p0=3)},
            REAL,
            float(mpmath.findroot(lambda r: r - 2 - 3 * mpmath.exp(-r), 2)),
        ),
        # what only turns is as large as its amplitude
        ({LEVEL: powers(p1=1), GROWING: powers(p0=5)}, TURNING, 5),
        ({LEVEL: powers(p1=2), GROWING: powers(p0=5), DECAYING: powers(p0=3)}, TURNING, 4),
        # an exponent of the root of s falls, if more slowly
        ({GROWING: powers(p0=1), LEVEL: powers(p0=3)}, [_Power(Fraction(1, 2), acb(2))], (log(3) / 2) ** 2),
        # of exp((2 + j) (1 +- j) r) the one with minus is the larger: exp(3 r) > 5 exp(r)
        (
            {((0, 1, 1),): powers(p0=5), ((0, 1, -1),): powers(p0=1)},
            [_Power(Fraction(1), acb(2, 1))],
            log(5) / 2,
        ),
        # two arguments: exp(3 r) > 7 exp(r), 2 exp(2 r) > 5 exp(r)
        (
            {((0, 1, 0), (1, 1, 0)): powers(p0=1), ((1, 1, 0),): powers(p0=7)},
            [_Power(Fraction(1), acb(2)), REAL[0]],
            log(7) / 2,
        ),
        (
            {((0, 1, 0),): powers(p0=2), LEVEL: powers(p0=5)},
            [_Power(Fraction(1), acb(2)), REAL[0]],
            log(2.5) / 2,
        ),
        (
            {((0, 1, 0), (1, 1, 0)): powers(p0=1), LEVEL: powers(p0=7)},
            [_Power(Fraction(1), acb(2)), REAL[0]],
            log(7) / 3,
        ),
        # balls count with all that they may be: exp(r) > 4, r/2 > 2, r > 3
        ({GROWING: powers(p0=1), LEVEL: {Fraction(0): acb(arb(3, 1))}}, REAL, log(4)),
        ({LEVEL: {Fraction(1): acb(arb(1, 0.5)), Fraction(0): acb(2)}}, REAL, 4),
        ({LEVEL: {Fraction(1): acb(1), Fraction(0): acb(arb(2, 1))}}, REAL, 3),
    ]:
        with precision(64):
            assert _dominant(terms, arguments, arb(edge * 1.001))
            assert _dominant(terms, arguments, arb(edge * 30))
            assert not _dominant(terms, arguments, arb(edge * 0.999))


def test_a_term_that_is_small_and_still_grows_against_the_largest_outweighs_it_later():
    for power, unit, over, edge in [
        (1, 1, 3, 3), (1, 2, 3, 1.5), (Fraction(1, 2), 2, 1, 1), (Fraction(1, 2), 3, 2, 16 / 9),
    ]:  # fmt: skip
        # exp(c r^p) > r^q/1000 at every r, and r^q exp(-c r^p) falls from (q/(c p))^(1/p) on.
        terms = {GROWING: powers(p0=1), LEVEL: {Fraction(over): acb("0.001")}}
        arguments = [_Power(Fraction(power), acb(unit))]
        with precision(64):
            assert not _dominant(terms, arguments, arb(edge * 0.997)), (power, unit)
            assert _dominant(terms, arguments, arb(edge * 1.003)), (power, unit)


def test_a_term_that_may_be_zero_outweighs_nothing():
    with precision(64):
        assert not _dominant({LEVEL: {Fraction(1): acb(arb(0, 1))}}, REAL, arb(10))
        assert not _dominant({LEVEL: powers(p0=0)}, REAL, arb(10))
        assert not _dominant({LEVEL: {Fraction(1): acb(arb(0, 1)), Fraction(0): acb(100)}}, REAL, arb(10))


@pytest.mark.parametrize(
    ("formula", "angle", "lead"),
    [
        ("s*(2*s + exp(-s))^2/(3*s + exp(-s))^3", 0, 4 / 27),
        ("1/(3*s + exp(-s))", -pi / 2, 1 / 3),
        ("-s/(2 + exp(-s))^2", -pi / 2, None),
        ("(exp(-s) - 2*s)^2/s", pi / 2, 4),
        ("(exp(-s) - 2*s)^3/(s + exp(-s))", 0, -8),
    ],
)
def test_the_angle_far_out_on_the_axis_is_that_of_the_terms_that_outweigh_the_others(formula, angle, lead):
    text = f'symflex = 1\ninputs.u = {{}}\noutputs.y = "({formula})*u"\n'
    (function,) = pipeline.derive_bound(pipeline.loads(text), [("y", "u")])
    far = FunctionFarOut.of(function, SECTORS)
    with precision(128):
        found, off = far.angle_on_axis(1e6)
        turned = found - angle
        assert abs(turned - 2 * arb.pi() * round(float(turned) / (2 * pi))) < 1e-12
    assert off < (2 if lead is None else 1e-5)
    assert lead is None or float(far.size(1e6).lead.real) == pytest.approx(lead)
