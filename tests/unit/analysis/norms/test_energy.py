"""H2 norms against formulas, Lyapunov equations and modal sums."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

import symflex
from tests.unit.analysis.norms.models import cantilever, squares_of_frequencies, two_masses


def h2(text, noise=""):
    model = symflex.Model(inputs={"u": {}}, outputs={"y": f"u*({text})"})
    return model.transfer_function("y", "u").bind().h2(noise)


def contains(ball, value, share=1e-13):
    return abs(float(ball.mid()) - value) <= float(ball.rad()) + share * abs(value)


def test_norms_known_by_hand():
    # The energy of the impulse response: exp(-2 t), and exp(-t) - exp(-3 t) of 2/((s + 1)(s + 3)).
    for text, value in (
        ("1/(s + 2)", 1 / 2),
        ("2/((s + 1)*(s + 3))", sqrt(1 / 2 - 2 / 4 + 1 / 6)),
        ("exp(-s)/(s + 2)", 1 / 2),
        ("0*s", 0),
        ("sqrt(2)/(s + pi)", 1 / sqrt(pi)),
    ):
        assert contains(h2(text).value, value), text


def test_noise_is_shaped_by_a_factor():
    assert contains(h2("1/(s + 1)", "2/(s + 3)").value, sqrt(1 / 2 - 2 / 4 + 1 / 6))
    # With s/(s + 1) white noise has no end, shaped noise does: the energy of -exp(-t) + 3/2 (...), by parts.
    assert contains(h2("s/(s + 1)", "1/(s + 3)").value, sqrt((1 / 2 - 2 * 3 / 4 + 9 / 6) / 4))


def test_what_is_infinite_says_why():
    for text, reason in (
        ("1/(s^2 + 4)", "imaginary axis"),
        ("1/s", "s = 0"),
        ("(s + 1)/(s + 2)", "does not fall off"),
        ("1/(s - 1)", "unstable"),
    ):
        norm = h2(text)
        assert not norm.value.is_finite() and reason in str(norm), text


@pytest.mark.slow
def test_a_damped_cantilever_has_the_norm_of_its_modal_sum():
    # q_n'' + eta w_n^2 q_n' + w_n^2 q_n = 2 F/sqrt(m): integrals of products of impulse responses.
    squares, eta, mass = np.array(squares_of_frequencies(12)), 2e-4, 0.162 * 0.8
    a, b = squares[:, None], squares[None, :]
    c, d = eta * a, eta * b
    total = ((c + d) / ((a - b) ** 2 + (c + d) * (c * b + d * a))).sum()
    norm = cantilever().transfer_function("X", "F").bind().h2()
    assert norm.certified and contains(norm.value, 4 / mass * sqrt(total), 1e-6)


def test_a_matrix_has_the_norm_of_a_lyapunov_equation():
    m, k, b = 1, 100, 0.2
    stiffness = np.array([[2, -1], [-1, 2]])
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-k / m * stiffness, -b / m * stiffness]])
    into = np.vstack([np.zeros((2, 2)), np.eye(2) / m])
    gramian = solve_continuous_lyapunov(a, -into @ into.T)
    norm = two_masses().transfer_matrix().bind().h2()
    assert contains(norm.value, sqrt(np.trace(gramian[:2, :2])), 1e-9)
    assert contains(norm.channels[0][1], sqrt(h2_of(a, into[:, 1:], 0)), 1e-9)


def h2_of(a, b, row):
    return solve_continuous_lyapunov(a, -b @ b.T)[row, row]
