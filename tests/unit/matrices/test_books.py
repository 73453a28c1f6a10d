"""Matrices of books: values against the printed formulas, relative gains against fractions by hand."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

from symflex.expressions import format_expression
from symflex.matrices import derive_matrix, determinant, interaction, locate_matrix
from symflex.roots.root import count_roots
from tests.unit.matrices.models import model_of, numbers, of_functions, state_space

HEAD = """
symflex = 1
[inputs]
u = {}
v = {}
[outputs]
"""

DISTILLATION = f"""{HEAD}
y = "(87.8*u - 86.4*v)/(75*s + 1)"
z = "(108.2*u - 109.6*v)/(75*s + 1)"
"""  # Skogestad and Postlethwaite 2005, example 3.5: LV control, in minutes

SATELLITE = f"""{HEAD}
y = "((s - 100)*u + 10*(s + 1)*v)/(s^2 + 100)"
z = "(-10*(s + 1)*u + (s - 100)*v)/(s^2 + 100)"
"""  # the same, section 3.7.1: a body that spins at 10 rad/s

CRACKER = f"""{HEAD}
y = "0.01*exp(-5*s)/((s + 0.000172)*(4.32*s + 1))*(-34.54*(s + 0.0572)*u + 1.913*v)"
z = "0.01*exp(-5*s)/((s + 0.000172)*(4.32*s + 1))*(-30.22*s*u - 9.188*(s + 0.000695)*v)"
"""  # the same, example 3.11: fluidised catalytic cracking

WOOD_BERRY = f"""{HEAD}
y = "12.8*exp(-s)/(16.7*s + 1)*u - 18.9*exp(-3*s)/(21*s + 1)*v"
z = "6.6*exp(-7*s)/(10.9*s + 1)*u - 19.4*exp(-3*s)/(14.4*s + 1)*v"
"""  # Wood and Berry 1973, Chem. Eng. Sci. 28: methanol and water, in minutes

FOUR_TANKS = """
symflex = 1
[parameters]
g_1 = 0.7
g_2 = 0.6
c_1 = 2.6
c_2 = 2.8
T_1 = 62
T_2 = 90
T_3 = 23
T_4 = 30
[inputs]
u = {}
v = {}
[outputs]
y = "g_1*c_1/(T_1*s + 1)*u + (1 - g_2)*c_1/((T_3*s + 1)*(T_1*s + 1))*v"
z = "(1 - g_1)*c_2/((T_4*s + 1)*(T_2*s + 1))*u + g_2*c_2/(T_2*s + 1)*v"
"""  # Johansson 2000, IEEE Trans. Control Syst. Technol. 8(3): quadruple tank; the values are ours


def distillation(s):
    return np.array([[87.8, -86.4], [108.2, -109.6]]) / (75 * s + 1)


def satellite(s):
    return np.array([[s - 100, 10 * (s + 1)], [-10 * (s + 1), s - 100]]) / (s**2 + 100)


def cracker(s):
    front = 0.01 * np.exp(-5 * s) / ((s + 1.72e-4) * (4.32 * s + 1))
    return front * np.array([[-34.54 * (s + 0.0572), 1.913], [-30.22 * s, -9.188 * (s + 6.95e-4)]])


def wood_berry(s):
    first = [12.8 * np.exp(-s) / (16.7 * s + 1), -18.9 * np.exp(-3 * s) / (21 * s + 1)]
    return np.array([first, [6.6 * np.exp(-7 * s) / (10.9 * s + 1), -19.4 * np.exp(-3 * s) / (14.4 * s + 1)]])


def four_tanks(s):
    one, two, three, four = (1 / (T * s + 1) for T in (62, 90, 23, 30))
    return np.array([[0.7 * 2.6 * one, 0.4 * 2.6 * three * one], [0.3 * 2.8 * four * two, 0.6 * 2.8 * two]])


def relative(a: str, b: str, c: str, d: str) -> float:
    """Return the relative gain of the first of [a, b; c, d]."""
    a, b, c, d = map(Fraction, (a, b, c, d))
    return float(a * d / (a * d - b * c))


BOOKS = {
    "distillation": (DISTILLATION, distillation, relative("87.8", "-86.4", "108.2", "-109.6")),
    "satellite": (SATELLITE, satellite, relative("-100", "10", "-10", "-100")),
    "cracker": (CRACKER, cracker, 1.0),  # the lower left entry vanishes at rest
    "wood and berry": (WOOD_BERRY, wood_berry, relative("12.8", "-18.9", "6.6", "-19.4")),
    "four tanks": (FOUR_TANKS, four_tanks, relative("1.82", "1.04", "0.84", "1.68")),
}


@pytest.mark.parametrize("name", BOOKS)
def test_values_are_those_of_the_printed_matrix_and_relative_gains_those_by_hand(name):
    text, own, first = BOOKS[name]
    matrix = derive_matrix(model_of(text))
    for s in (0.3j, 0.02 + 1.1j):
        assert np.allclose(matrix.bind().at(s), own(s), rtol=1e-13, atol=0)
    found = interaction(matrix)
    assert np.allclose(found.values(found.relative), [[first, 1 - first], [1 - first, first]], rtol=1e-14)


def test_digits_are_those_in_print():
    assert f"{BOOKS['distillation'][2]:.1f}" == "35.1"
    assert f"{BOOKS['wood and berry'][2]:.2f}" == "2.01"


def test_relative_gains_of_four_tanks_are_in_the_positions_of_the_valves_alone():
    found = interaction(derive_matrix(model_of(FOUR_TANKS)))
    (first, _), _ = found.said(found.relative)
    assert format_expression(first) == "g_1*g_2/(g_1 + g_2 - 1)"


def test_the_satellite_has_no_determinant_that_vanishes():
    # (s - 100)^2 + 100 (s + 1)^2 = 101 (s^2 + 100), so det G = 101/(s^2 + 100): no zero is left.
    tf = determinant(derive_matrix(model_of(SATELLITE)))
    ring = tf.ratio.ring
    assert (tf.ratio.numerator().expand(), tf.ratio.denominator().expand()) == (
        101,
        ring.generator("s") ** 2 + 100,
    )


FRONT = "1/((s + 1)*(s + 2)*(s - 1))"
JET = state_space(
    numbers("-.0558 -.9968 .0802 .0415\n.598 -.115 -.0318 0\n-3.05 .388 -.465 0\n0 .0805 1 0"),
    numbers(".0073 0\n-.475 .0077\n.153 .143\n0 0"),
    numbers("0 1 0 0\n0 0 0 1"),
)
BENCHMARK = state_space(
    numbers("1 0 0 0 0 0\n0 1 0 0 0 0\n0 0 3 0 0 0\n0 0 0 -4 0 0\n0 0 0 0 -1 0\n0 0 0 0 0 3"),
    numbers("0 -1\n-1 0\n1 -1\n0 0\n0 1\n-1 -1"),
    numbers("1 0 0 1 0 0\n0 1 0 1 0 1\n0 0 1 0 0 1"),
)
POLES_AND_ZEROS = {  # the model, and zeros and poles as they are printed; nothing where none is
    "Skogestad and Postlethwaite 2005, example 4.10": (
        of_functions(
            [f"{FRONT}*(s - 1)*(s + 2)", "0", f"{FRONT}*(s - 1)^2"],
            [f"-{FRONT}*(s + 1)*(s + 2)", f"{FRONT}*(s - 1)*(s + 1)", f"{FRONT}*(s - 1)*(s + 1)"],
        ),
        ["1"],
        ["-2", "-2", "-1", "1"],
    ),
    "the same, example 4.9: no zero, though each entry has one": (
        of_functions(
            ["(s - 1)/(1.25*(s + 1)*(s + 2))", "s/(1.25*(s + 1)*(s + 2))"],
            ["-6/(1.25*(s + 1)*(s + 2))", "(s - 2)/(1.25*(s + 1)*(s + 2))"],
        ),
        [],
        ["-2", "-1"],
    ),
    "the same, examples 4.11 and 4.13": (
        of_functions(["(s - 1)/(s + 2)", "4/(s + 2)"], ["4.5/(s + 2)", "2*(s - 1)/(s + 2)"]),
        ["4"],
        ["-2"],
    ),
    "the same, chapter 3": (
        of_functions(
            ["1/((0.2*s + 1)*(s + 1))", "1/((0.2*s + 1)*(s + 1))"],
            ["(1 + 2*s)/((0.2*s + 1)*(s + 1))", "2/((0.2*s + 1)*(s + 1))"],
        ),
        ["0.5"],
        None,
    ),
    "Rosenbrock 1970": (
        of_functions(["1/(s + 1)", "2/(s + 3)"], ["1/(s + 1)", "1/(s + 1)"]),
        ["1"],
        ["-3", "-1", "-1"],
    ),
    "MathWorks, Control System Toolbox, tzero": (
        of_functions(["1/(s + 1)", "1/(s + 2)"], ["1/(s + 3)", "2/(s + 4)"]),
        ["-2.5000-1.3229j", "-2.5000+1.3229j"],
        None,
    ),
    "SLICOT, AB08ND: invariant zeros at -1 and 2, of which -1 is a hidden mode": (
        BENCHMARK,
        ["2.0000"],
        None,
    ),
    "MathWorks, yaw damper of a 747 at Mach 0.8, 40,000 ft": (
        JET,
        None,
        ["-5.63e-01", "-3.29e-02-9.47e-01j", "-3.29e-02+9.47e-01j", "-7.28e-03"],
    ),
}


def agrees(root: complex, printed: str) -> bool:
    """Tell whether both parts of a root are those in print, within half a unit of the last digit."""
    parts = re.findall(r"-?[\d.]+(?:e-\d+)?", printed)
    for value, text in zip((root.real, root.imag), [*parts, "0"], strict=False):
        mantissa, _, exponent = text.partition("e")
        unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        if abs(value - float(text)) > 0.5001 * unit:
            return False
    return True


@pytest.mark.parametrize("name", POLES_AND_ZEROS)
def test_poles_and_zeros_are_those_in_print(name):
    model, *printed = POLES_AND_ZEROS[name]
    found = locate_matrix(model, digits=15)
    assert found.located.certificate.certified
    for roots, texts in zip((found.located.zeros, found.located.all_poles), printed, strict=True):
        if texts is None:
            continue
        seen = [complex(r.re.mid(), r.im.mid()) for r in roots for _ in range(r.multiplicity)]
        assert count_roots(roots) == len(texts)
        ordered = sorted(seen, key=lambda z: (round(z.real, 9), z.imag))
        assert all(agrees(root, text) for root, text in zip(ordered, texts, strict=True)), (ordered, texts)


def test_a_zero_has_the_directions_in_print():
    # Skogestad and Postlethwaite 2005, examples 4.11 and 4.13: inputs 0.80, -0.60 and outputs 0.83, -0.55.
    model, *_ = POLES_AND_ZEROS["the same, examples 4.11 and 4.13"]
    (direction,) = locate_matrix(model).directions
    for vector, printed in ((direction.inputs, (0.80, -0.60)), (direction.outputs, (0.83, -0.55))):
        own = np.array([complex(x).real for x in vector])
        own = own / np.linalg.norm(own) * np.sign(own[0])
        assert np.allclose(own, printed, atol=0.0051)


def test_relative_gains_of_books_are_those_in_print():
    # The same, example 3.10: a cracker with three inputs; and the column in the DV configuration.
    cracker = of_functions(["16.8", "30.5", "4.30"], ["-16.7", "31.0", "-1.41"], ["1.27", "54.1", "5.40"])
    found = interaction(derive_matrix(cracker))
    printed = [[1.50, 0.99, -1.48], [-0.41, 0.97, 0.45], [-0.08, -0.95, 2.03]]
    assert np.allclose(found.values(found.relative), printed, atol=0.0051)
    column = interaction(derive_matrix(of_functions(["-87.8", "1.4"], ["-108.2", "-1.4"])))
    assert np.allclose(column.values(column.relative), [[0.448, 0.552], [0.552, 0.448]], atol=0.00051)
