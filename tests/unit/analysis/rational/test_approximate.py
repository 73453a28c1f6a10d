"""Rational approximations against infinite products and sums whose terms textbooks give."""

import math
import sys
from itertools import product
from pathlib import Path

import mpmath
import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.rational import FORMS, approximate
from symflex.analysis.rational.approximation import rational_json
from symflex.errors import ModelError
from tests.unit.analysis.rods import CLAMPED_ROD, FREE_ROD, bound, rational
from tests.unit.analysis.systems import words
from tests.unit.roots import distributed_models as distributed

DERIVATIONS = Path(__file__).parents[4] / "derivations"
PI = math.pi


def half(n):
    return (n - 0.5) * PI


def rod_product(s, modes):
    """tanh(s)/s as its product over poles j (n - 1/2) pi and zeros j n pi, cut after some (Euler)."""
    value = 1.0
    for n in range(1, modes + 1):
        value *= (1 + (s / (n * PI)) ** 2) / (1 + (s / half(n)) ** 2)
    return value


def rod_sum(s, modes):
    """tanh(s)/s as its sum over poles, cut, and the static part of the terms cut off."""
    terms = sum(2 / (s**2 + half(n) ** 2) for n in range(1, modes + 1))
    return terms + 1 - sum(2 / half(n) ** 2 for n in range(1, modes + 1))


POINTS = [0.3, 0.5 + 1j, 2j, 7.5j, -3 + 4j]


@pytest.mark.parametrize(("form", "cut"), [("product", rod_product), ("modal", rod_sum)])
def test_a_rod_is_its_infinite_product_or_sum_cut_off(form, cut):
    for modes in (0, 3):
        R = approximate(bound(CLAMPED_ROD, "X/F"), modes, form)
        assert R.modes == modes
        num, den = R.coefficients()
        for s in POINTS:
            assert R(s) == pytest.approx(cut(s, modes), rel=1e-12), (modes, s)
            quotient = np.polyval(num, s) / np.polyval(den, s)
            assert quotient == pytest.approx(cut(s, modes), rel=1e-9), (modes, s)


def test_poles_and_zeros_of_a_product_are_those_of_the_function():
    R = approximate(bound(CLAMPED_ROD, "X/F"), 3)
    assert [float(p.imag) / PI for p in R.poles] == pytest.approx([0.5, -0.5, 1.5, -1.5, 2.5, -2.5])
    assert [float(z.imag) / PI for z in R.zeros] == pytest.approx([1, -1, 2, -2, 3, -3])
    assert float(R.gain) == pytest.approx(math.prod((half(n) / (n * PI)) ** 2 for n in (1, 2, 3)))


def test_a_function_without_zeros_has_none():
    # 1/cosh(s): the force at the wall
    R = approximate(bound(CLAMPED_ROD, "F_wall/F"), 4)
    assert R.zeros == ()
    assert float(R.gain) == pytest.approx(math.prod(half(n) ** 2 for n in range(1, 5)))


def test_the_product_of_a_free_rod_keeps_its_rigid_body():
    # 1/(s sinh s) = 1/s^2 prod 1/(1 + s^2/(n pi)^2)
    R = approximate(bound(FREE_ROD, "Y/F"), 2)
    s = 1.5j
    assert (R.order_at_zero, R.leading_coefficient) == (-2, pytest.approx(1, rel=1e-15))
    assert R(s) == pytest.approx(1 / (s**2 * (1 + (s / PI) ** 2) * (1 + (s / PI / 2) ** 2)), rel=1e-13)


def test_the_sum_of_a_free_rod_is_right_beyond_its_rigid_body():
    # 1/(s sinh s) = 1/s^2 + sum 2 (-1)^n/(s^2 + (n pi)^2); at s = 0 the sum is -1/6
    R = approximate(bound(FREE_ROD, "Y/F"), 2, "modal")
    known = [2 * (-1) ** n / (n * PI) ** 2 for n in (1, 2)]
    assert float(R.correction[0]) == pytest.approx(-1 / 6 - sum(known), rel=1e-13)
    for s in (0.01j, 1.5j):
        terms = sum(2 * (-1) ** n / (s**2 + (n * PI) ** 2) for n in (1, 2))
        assert R(s) == pytest.approx(1 / s**2 + terms - 1 / 6 - sum(known), rel=1e-12)


@pytest.mark.parametrize(("form", "tolerance"), [("product", 0.01), ("modal", 0.05)])
def test_validity_ends_where_the_error_reaches_the_tolerance(form, tolerance):
    cut = {"product": rod_product, "modal": rod_sum}[form]
    modes = 3
    R = approximate(bound(CLAMPED_ROD, "X/F"), modes, form)

    def error(omega):
        exact = math.tan(omega) / omega
        dips = [max(1, 0.1 * n * PI / abs(omega - n * PI)) for n in range(1, modes + 2)]
        return abs(cut(1j * omega, modes) - exact) / (abs(exact) * math.prod(dips))

    found = R.valid_to(tolerance) * 2 * PI
    assert error(found) == pytest.approx(tolerance, rel=1e-6)
    # and not before, on a grid of its own; sharp poles are left out
    below = (x for x in np.linspace(1e-3, found * (1 - 1e-9), 4000) if abs(math.cos(x)) > 1e-6)
    assert max(map(error, below)) <= tolerance * (1 + 1e-9)


@pytest.mark.parametrize(("form", "cut"), [("product", rod_product), ("modal", rod_sum)])
def test_what_is_said_outside_antiresonances_holds_of_the_plain_relative_error(form, cut):
    # tan(omega)/omega has its zeros at n pi, n/2 Hz.
    R = approximate(bound(CLAMPED_ROD, "X/F"), 6, form)
    for percent in (1, 5):
        tolerance, limit = percent / 100, R.valid_to(percent / 100)
        grid = np.linspace(1e-3, limit, 20001)[1:-1]
        plain = np.array([abs(cut(2j * PI * f, 6) * 2 * PI * f / math.tan(2 * PI * f) - 1) for f in grid])
        expected = sorted({round(2 * f) / 2 for f in grid[plain > tolerance].tolist()})
        assert R.outside(tolerance) == pytest.approx(expected, rel=1e-9), percent
        kept = np.all([abs(grid - zero) > 0.1 * zero for zero in (*expected, 1e9)], axis=0)
        assert plain[kept].max() <= tolerance * (1 + 1e-9), percent
        said = f"within {percent} % of the exact function up to {limit:.6g} Hz"
        if expected:
            zeros = ", ".join(f"{zero:g}" for zero in expected[:3])
            noun = "the antiresonance" if len(expected) == 1 else "antiresonances"
            said += f", outside 10 % of {noun} at {zeros} Hz"
        assert said in " ".join(str(R).split()), percent
        for told in (rational_json(R), R.facts()):
            assert told["outside_hz"][f"{percent} %"] == list(R.outside(tolerance)), percent
    assert rational_json(R)["error"]["outside_hz"] == list(R.error.filled_hz)


def test_the_worst_error_at_a_pole_compares_residues():
    # At j pi/2 R/G is the product of the factors cut off.
    R = approximate(bound(CLAMPED_ROD, "X/F"), 1)
    with mpmath.workdps(20):
        factors = mpmath.nprod(
            lambda n: (1 - (mpmath.pi / 2 / ((n - 0.5) * mpmath.pi)) ** 2) / (1 - 1 / (4 * n**2)),
            [2, mpmath.inf],
        )
    error = R.scan.at(0.25)
    assert error == pytest.approx(abs(float(factors) - 1), rel=1e-4)
    assert (R.error.high_hz, R.error.worst) == (0.25, pytest.approx(error, rel=1e-6))


def test_no_pole_is_skipped_between_bands():
    R = approximate(bound(CLAMPED_ROD, "X/F"), band=(0.01, 1.3))
    # (n - 1/2)/2 Hz up to 1.3 Hz: 0.25, 0.75, 1.25
    assert R.modes == 3
    assert R.error.samples > 400
    assert (R.error.is_rigorous, R.scan.is_rigorous) == (False, False)  # it is sampled
    assert R.omitted_hz == pytest.approx(1.75)
    assert (R.error.low_hz, R.error.high_hz) == (0.01, 1.3)


def test_zeros_are_left_out_until_the_function_is_proper():
    # V/F = tanh(s): zeros at 0, j pi, ... below the pole left out, one more than poles
    R = approximate(bound(CLAMPED_ROD, "V/F"), 2)
    assert len(R.zeros) <= len(R.poles)
    assert R.order_at_zero == 1
    assert R(1e-4) == pytest.approx(math.tanh(1e-4), rel=1e-6)


@pytest.mark.slow
def test_a_lumped_system_with_all_its_modes_is_itself():
    for name in ("two_mass", "rigid_body"):
        model = pipeline.load(DERIVATIONS / "eppinger1988" / f"{name}.toml")
        for tf, form in product(pipeline.derive_bound(model, model.transfer_functions), FORMS):
            R = approximate(tf, 50, form)
            assert R.is_exact, (name, form)
            assert R.valid_to(0.01) == math.inf, (name, form)
            assert not R.is_estimate, (name, form)
            for s in (3 + 40j, -20j, 800j):
                assert R(s) == pytest.approx(tf(s), rel=1e-12), (name, form)


def test_what_grows_with_s_is_itself_too():
    for form in FORMS:
        R = approximate(rational("(s^3 + 2)/(s + 1)"), form=form)
        assert [float(c) for c in R.num] == [1, 0, 0, 2], form
        assert [float(c) for c in R.den] == [1, 1], form
        assert R(3j) == pytest.approx(((3j) ** 3 + 2) / (3j + 1), rel=1e-14), form


def test_some_modes_of_a_lumped_system_by_hand():
    # 1/((s^2 + 1)(s^2 + 100)) = (1/99) (1/(s^2 + 1) - 1/(s^2 + 100))
    tf = rational("1/((s^2 + 1)*(s^2 + 100))")
    cut, modal = (approximate(tf, 1, form) for form in FORMS)
    assert not cut.is_exact
    assert cut(2j) == pytest.approx(1 / (100 * (1 - 4)), rel=1e-14)
    assert modal(2j) == pytest.approx((1 / (1 - 4) - 1 / 100) / 99, rel=1e-13)
    assert cut.omitted_hz == pytest.approx(10 / (2 * PI))


def test_the_first_order_reaches_as_far_as_algebra_says():
    # 100/(100 + s) left out of 1/((s + 1)(s + 100)): |1 + j w/100 - 1| = 0.01 at w = 1
    R = approximate(rational("1/((s + 1)*(s + 100))"), 1)
    assert R.valid_to(0.01) * 2 * PI == pytest.approx(1, rel=1e-9)


@pytest.mark.slow
def test_a_beam_is_right_at_low_frequencies():
    tf = distributed.bound(distributed.FREE)
    R = approximate(tf, 3, "modal")
    for omega in (0.01, 0.5, 2.0):
        assert R(1j * omega) == pytest.approx(tf(1j * omega), rel=2e-3)


@pytest.mark.slow
def test_the_modal_form_of_a_delay_in_a_loop():
    tf = distributed.bound(distributed.DELAY_LOOP)
    R = approximate(tf, 6, "modal")
    # 1/(s + 2 exp(-s/2)) at small frequencies
    for omega in (0.1, 1.0, 3.0):
        s = 1j * omega
        assert R(s) == pytest.approx(1 / (s + 2 * np.exp(-s / 2)), rel=0.01)


@pytest.mark.slow
def test_zeros_of_a_modal_form_are_roots_of_its_numerator():
    R = approximate(distributed.bound(distributed.KELVIN_VOIGT), 3, "modal")
    num, den = R.coefficients()
    for z in R.zeros:
        terms = [abs(c) * abs(complex(z)) ** (len(num) - 1 - i) for i, c in enumerate(num)]
        assert abs(np.polyval(num, complex(z))) < 1e-12 * max(terms)
    assert len(den) == 7


def test_arrays_broadcast():
    R = approximate(bound(CLAMPED_ROD, "X/F"), 2)
    values = R(np.array([[1j, 2j], [0.5, 0]]))
    assert values.shape == (2, 2)
    assert values[1, 1] == 1


def test_control_takes_it_over():
    R = approximate(bound(CLAMPED_ROD, "X/F"), 2)
    system = R.to_control()
    assert system(0.4j) == pytest.approx(R(0.4j), rel=1e-10)
    assert (system.input_labels, system.output_labels) == (["F"], ["X"])
    assert system.name == R.label()


def test_sympy_takes_it_over():
    R = approximate(bound(CLAMPED_ROD, "X/F"), 2, "modal")
    system = R.to_sympy(30)
    assert complex(system.to_expr().subs(system.var, 2)) == pytest.approx(rod_sum(2, 2), rel=1e-13)


def test_a_program_that_is_not_installed_is_named(monkeypatch):
    R = approximate(rational("1/(s + 1)"))
    for package, call in (("control", R.to_control), ("scipy.signal", R.to_scipy), ("sympy", R.to_sympy)):
        monkeypatch.setitem(sys.modules, package, None)
        assert f"{package.split('.')[0]} is not installed" in words(call), package


def test_the_label_says_where_it_is_valid():
    R = approximate(bound(CLAMPED_ROD, "X/F"), 2)
    label = R.label()
    assert label.startswith("X_over_F_product_2_modes_1_percent_to_")
    assert label.replace("_", "").isalnum()
    assert approximate(rational("1/(s + 1)")).label() == "y_over_u_exact"


def test_coefficients_too_large_for_double_precision_are_refused():
    R = approximate(rational("1/(" + "*".join(f"(s/10^20 + {n})" for n in range(1, 19)) + ")"), 18)
    assert R(1) == pytest.approx(1 / math.factorial(18), rel=1e-14)
    with pytest.raises(ModelError, match="SF233"):
        R.coefficients()


def test_what_cannot_be_is_refused():
    for options, said in (
        ({"form": "modla"}, "did you mean 'modal'"),
        ({"modes": -1}, "SF902"),
        ({"band": (0, 1)}, "SF227"),
        ({"band": (2, 1)}, "SF227"),
    ):
        found = words(approximate, rational("1/(s + 1)"), **options)
        assert found.startswith("UsageError") and said in found, options


def test_what_is_zero_has_no_approximation():
    with pytest.raises(ModelError, match="SF402"):
        approximate(rational("s - s"))
