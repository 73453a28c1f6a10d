"""Quotients of polynomials whose roots are known: multiple, close together, mirrored, on axes, hidden."""

from math import gcd

import mpmath
import pytest
from mpmath import expjpi, mpc, mpf, pi, sqrt

from symflex.errors import ModelError
from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound
from tests.unit.roots.known_roots import Case, cases, check, elements, known, late


def of(formula, more=""):
    return f'symflex = 1\ninputs.u = {{}}\n{more}\noutputs.y = "{formula}"\n'


def product_of(*roots):
    return "*".join(f"(s - ({root}))" for root in roots)


CYCLOTOMIC = (
    "s^48 + s^47 + s^46 - s^43 - s^42 - 2*s^41 - s^40 - s^39 + s^36 + s^35 + s^34 + s^33 + s^32 + s^31"
)
CYCLOTOMIC += (
    " - s^28 - s^26 - s^24 - s^22 - s^20 + s^17 + s^16 + s^15 + s^14 + s^13 + s^12 - s^9 - s^8 - 2*s^7"
)
CYCLOTOMIC += " - s^6 - s^5 + s^2 + s + 1"
"""Of order 105, the first with a coefficient of 2."""
CHAIN = "\n".join(
    f'm_{i} = {{ type = "mass", at = "x_{i}", m = 60 }}\n'
    f'k_{i} = {{ type = "spring", between = ["x_{i}", "{f"x_{i - 1}" if i else "ground"}"], k = 95000 }}\n'
    f'b_{i} = {{ type = "damper", between = ["x_{i}", "{f"x_{i - 1}" if i else "ground"}"], b = LOSS }}'
    for i in range(7)
)


def chain(loss):
    """Return s^2 + (b/k) omega^2 s + omega^2 = 0 of a chain fixed at one end (any textbook on lattices)."""
    omega = [2 * sqrt(mpf(95000) / 60) * mpmath.sinpi(mpf(2 * j - 1) / 30) for j in range(1, 8)]
    return [
        mpc(-loss * w**2 / 190000, w * sqrt(1 - (loss * w / 190000) ** 2)) for w in omega
    ]  # fmt: skip


CASES = {
    "a double pole": Case(of("u*(s + 3)/((s + 1)*(s + 2)^2)"), known(-1, (-2, 2)), known(-3), word="stable"),
    "roots of many multiplicities": Case(
        of("u/((s + 1)^3*(s + 2)^2*(s - 5)*(s^2 + 4)^2)"), known((-1, 3), (-2, 2), (2j, 2), 5),
        word="unstable",
    ),
    "a frequency in Hz": Case(
        of("u*s^2/((s + f)*(s + 2))", 'parameters.f = "1 Hz"'), lambda: [-2, -2 * pi], word="stable"
    ),
    "no roots": Case(of("7*u"), known(), known(), word="stable"),
    "Wilkinson's polynomial": Case(
        of(f"u/({product_of(*range(1, 21))})"), known(*range(1, 21)), region=Modes(20)
    ),
    "roots of unity": Case(
        of(f"u/({CYCLOTOMIC})"),
        lambda: [expjpi(mpf(2 * k) / 105) for k in range(53) if gcd(k, 105) == 1], region=None,
    ),
    "a mirrored quadruple": Case(
        of("u/(s^4 + 1)"), lambda: [expjpi(mpf(k) / 4) for k in (1, 3)], region=None
    ),
    "three roots 1e-20 apart": Case(
        of(f"u/({product_of('1/3', '1/3 + 1e-20', '1/3 + 2e-20')})"),
        lambda: [mpf(1) / 3 + k * mpf(10) ** -20 for k in range(3)], region=None, digits=30,
    ),
    "two damped pairs 1e-20 apart": Case(
        of("u/((s^2 + s + 1)*(s^2 + (1 + 1e-20)*s + 1))"),
        lambda: [mpc(-x, sqrt(1 - x * x)) for x in (mpf("0.5"), (1 + mpf(10) ** -20) / 2)], region=None,
    ),
    "oscillators 5e-15 apart": Case(
        of("u/((s^2 + 1)*(s^2 + 1.00000000000001))"),
        lambda: [1j, mpc(0, sqrt(mpf("1.00000000000001")))], region=None, word="marginal",
    ),
    "a pair very close to the axis": Case(
        of("u/(s^2 + 1e-40*s + 1)"), lambda: [mpc(-mpf(10) ** -40 / 2, 1)], region=None, word="stable"
    ),
    "a pair very close to the other axis": Case(
        of("u/((s - 1)^2 + 1e-40)"), lambda: [mpc(1, mpf(10) ** -20)], region=None, digits=10, word="unstable"
    ),
    "a chain of masses": Case(
        elements(CHAIN.replace("LOSS", "0"), 'F = { force = "x_6" }', "x_6"), lambda: chain(0), region=None,
        word="marginal",
    ),
    "a chain with dampers": Case(
        elements(CHAIN.replace("LOSS", "40"), 'F = { force = "x_6" }', "x_6"), lambda: chain(40), region=None,
        word="stable",
    ),
    # Square roots, whose squares exact steps have to know.
    "a square of a square root": Case(of("u/(s^2 + 2*sqrt(2)*s + 2)"), lambda: [(-sqrt(2), 2)], region=None),
    "a product of square roots": Case(
        of("u/(s^2 + 2*sqrt(6)*s + (sqrt(2)*sqrt(3))^2)"), lambda: [(-sqrt(6), 2)], region=None
    ),
    "a square root that cancels": Case(
        of("u*(s + sqrt(8))/(s^2 - 8)"), lambda: [sqrt(8)], known(), hidden=lambda: [-sqrt(8)], region=None
    ),
    "square roots multiplied out": Case(
        of("u/(s^3 + sqrt(3)*s^2 + 3*s + sqrt(27))"), lambda: [-sqrt(3), mpc(0, sqrt(3))], region=None
    ),
    "a hidden pole at 0 within a block": Case(
        of("y_0", 'blocks.P = { type = "tf", num = "s", den = "s*(s + 2)" }\nsignals.y_0 = "P*u"'),
        known(-2), hidden=lambda: [(0, 1)], word="stable",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", cases(CASES))
def test_poles_zeros_and_hidden_modes_are_those_of_the_formula(case):
    check(case)


def test_without_zeros_a_removable_point_is_no_pole():
    # A mass between two strings on a damped foundation, s^2 + 2 gamma coth(gamma) = 0. Where gamma vanishes,
    # at s = -0.1 +- j sqrt(0.99), this is s^2 + 2 and no pole.
    half = 'type = "string", N = "N", rhoA = "mu", l = "L/2", c_f = "c", k_f = "k"'
    lines = f'a = {{ {half}, between = ["ground", "x"] }}\nb = {{ {half}, between = ["x", "ground"] }}\n'
    more = "parameters = { N = 1, mu = 1, L = 2, c = 0.2, k = 1 }"
    source = bound(elements(lines + 'm = { type = "mass", at = "x", m = 1 }', more=more))
    found = locate(source, Modes(3), with_zeros=False)
    assert found.poles and found.certificate.certified
    for s in map(complex, found.poles):
        gamma = mpmath.sqrt(s * s + s / 5 + 1)
        assert abs(s * s * mpmath.sinh(gamma) + 2 * gamma * mpmath.cosh(gamma)) < 1e-9
        assert abs(gamma) > 0.1


def test_a_denominator_that_vanishes_without_a_delay_is_refused_where_it_is_written():
    no_time = 'parameters.T = { value = "0 s", assume = "nonnegative" }'
    with pytest.raises(ModelError, match="SF224") as failed:
        locate(bound(late("u/(1 - D)", '"T"', no_time)))
    (diagnostic,) = failed.value.diagnostics
    assert diagnostic.message == "division by zero"
    assert diagnostic.span is not None
