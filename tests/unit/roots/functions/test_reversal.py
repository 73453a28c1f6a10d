"""Waves that turn round with s: beside values of determinants at s and -s, in doubles by numpy."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import symflex
from symflex.algebra import Factored
from symflex.loops.over import characteristic
from symflex.pipeline import loads
from symflex.roots.functions.reversal import is_reversed

MOVING = """
symflex = 1
parameters = {{ v = 2 }}
inputs = {{ M = {{}} }}
outputs = {{ Y = "w'(1)" }}
[fields.w]
domain = ["0", "1"]
equation = "w'''' + v^2*w'' + {odd}*w' + s^2*w = 0"
conditions = ["w(0) = 0", {start}, {end}, "w''(1) = M"]
"""
PINNED, CLAMPED, FREE = "\"w''(0) = 0\"", '"w\'(0) = 0"', "\"w'''(1) = 0\""
HELD = '"w(1) = 0"'


def determinant(s, v, odd, orders):
    """Return that of the conditions, apart from a factor that is even in s, of exponentials."""
    roots = np.roots([1, 0, v**2, odd, s**2])
    rows = [[x**k * np.exp(x * at) for x in roots] for k, at in orders]
    differences = [a - b for i, a in enumerate(roots) for b in roots[:i]]
    return np.linalg.det(rows) / np.prod(differences)


@pytest.mark.parametrize(
    ("odd", "start", "end", "orders"),
    [
        ("2*v*s", PINNED, HELD, ((0, 0), (2, 0), (0, 1), (2, 1))),
        ("2*v*s", CLAMPED, HELD, ((0, 0), (1, 0), (0, 1), (2, 1))),
        ("2*v*s", CLAMPED, FREE, ((0, 0), (1, 0), (3, 1), (2, 1))),
        ("2*v", PINNED, HELD, ((0, 0), (2, 0), (0, 1), (2, 1))),
    ],
    ids=["pinned", "clamped", "cantilever", "not odd"],
)
def test_what_is_reversed_has_determinants_alike_at_s_and_minus_s(odd, start, end, orders):
    model = loads(MOVING.format(odd=odd, start=start, end=end))
    function = characteristic(model, ("v",), ((Fraction(1), Fraction(3)),))
    tf, factors = function.at_rest
    found = all(is_reversed(Factored.polynomial(tf.ratio.ring, f), tf.kernels) for f in factors)
    s, v = 1.3 + 0.7j, 1.9
    one, other = (determinant(x, v, 2 * v * x if "s" in odd else 2 * v, orders) for x in (s, -s))
    is_alike = min(abs(one - other), abs(one + other)) < 1e-9 * abs(one)
    assert found == (is_alike and "s" in odd)
    assert found == (end == HELD and "s" in odd)  # what leaves a free end takes energy along


@pytest.mark.parametrize(("end", "expected"), [("w(1) = y_0", True), ("w'(1) = y_0", False)])
def test_a_string_that_moves_is_reversed_between_held_ends_only(end, expected):
    # Waves exp(s x/(1 - v)) and exp(-s x/(1 + v)): held, poles are at j n pi (1 - v^2); else the square of
    # exp(s/(1 - v^2)) is -(1 - v)/(1 + v), which is no number on the unit circle.
    model = loads(
        f"""symflex = 1
        parameters = {{ v = 0.5 }}
        inputs = {{ y_0 = {{}} }}
        outputs = {{ Y = "w(1/2)" }}
        [fields.w]
        domain = ["0", "1"]
        equation = "(1 - v^2)*w'' - 2*v*s*w' - s^2*w = 0"
        conditions = ["w(0) = 0", "{end}"]
        """
    )
    function = characteristic(model, ("v",), ((Fraction(1, 4), Fraction(3, 4)),))
    tf, factors = function.at_rest
    assert [is_reversed(Factored.polynomial(tf.ratio.ring, f), tf.kernels) for f in factors] == [expected]


def test_functions_of_two_lengths_or_of_another_kind_are_not_known_to_be_reversed():
    model = loads(MOVING.format(odd="2*v*s", start=PINNED, end=HELD))
    tf, (factor,) = characteristic(model, ("v",), ((Fraction(1), Fraction(3)),)).at_rest
    part, kernels = Factored.polynomial(tf.ratio.ring, factor), tf.kernels.kernels
    assert is_reversed(part, tf.kernels)
    used = next(k for k in kernels if part.depends_on(k.generator))
    for other in (replace(used, length=used.length * 2), replace(used, function="exp")):
        table = replace(tf.kernels, kernels=tuple(other if k is used else k for k in kernels))
        assert not is_reversed(part, table)


TURNING = "-(1 - v^2)*w'' + 2*v*(s + j*W)*w' + (s + j*W)^2*w"


@pytest.mark.parametrize(("equation", "expected"), [(TURNING, True), (TURNING + " + c*s*w", False)])
def test_a_string_that_moves_is_reversed_in_turning_axes_if_j_turns_with_s(equation, expected):
    # Its poles are -j W + j n pi (1 - v^2); damping takes them off the axis.
    model = loads(
        f"""symflex = 1
        parameters = {{ v = 0.5, W = 2, c = 1 }}
        inputs = {{ y_0 = {{}} }}
        outputs = {{ Y = "w(1/2)" }}
        [fields.w]
        domain = ["0", "1"]
        equation = "{equation} = 0"
        conditions = ["w(0) = 0", "w(1) = y_0"]
        """
    )
    ends = ((Fraction(1, 4), Fraction(3, 4)),)
    tf, factors = characteristic(model, ("v",), ends, has_complex_waves=True).at_rest
    assert [is_reversed(Factored.polynomial(tf.ratio.ring, f), tf.kernels) for f in factors] == [expected]


def test_what_is_odd_in_s_is_reversed_but_for_its_sign():
    model = loads(MOVING.format(odd="2*v*s", start=PINNED, end=HELD))
    tf, (factor,) = characteristic(model, ("v",), ((Fraction(1), Fraction(3)),)).at_rest
    s = tf.ratio.ring.context.gen(0)
    assert is_reversed(Factored(tf.ratio.ring, Fraction(1), ((s * factor, 1),)), tf.kernels)
    assert not is_reversed(Factored(tf.ratio.ring, Fraction(1), (((s + 1) * factor, 1),)), tf.kernels)


def test_poles_of_a_belt_that_moves_are_on_the_axis_each_once():
    model = symflex.loads(MOVING.format(odd="2*v*s", start=PINNED, end=HELD))
    poles = model.transfer_function("Y", "M").bind(v=0.5).poles(modes=2, digits=8)
    # Galerkin's method with sines: q'' + G q' + K q = 0.
    k = np.arange(1, 41)
    m, n = np.meshgrid(k, k, indexing="ij")
    parts = np.where((m + n) % 2 == 1, m / np.where(m == n, 1, m**2 - n**2), 0)
    gyroscopic, stiffness = 2 * 0.5 * 4 * n * parts, np.diag((k * np.pi) ** 4 - 0.25 * (k * np.pi) ** 2)
    first_order = np.block([[np.zeros((40, 40)), np.eye(40)], [-stiffness, -gyroscopic]])
    expected = sorted(x for x in np.linalg.eigvals(first_order).imag if x > 0)[:2]
    assert [root.re for root in poles] == [0] * 4
    assert all(root.on_imaginary_axis for root in poles)
    assert sorted(root.im for root in poles if root.im > 0) == pytest.approx(expected, rel=1e-5)
