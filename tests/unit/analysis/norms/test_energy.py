"""H2 norms against formulas, Lyapunov equations and modal sums."""

from math import pi, sqrt

import numpy as np
import pytest
from flint import acb, acb_mat, arb
from scipy.linalg import solve_continuous_lyapunov

import symflex
from symflex.analysis.norms.axis import MatrixOnAxis, TaylorForm
from symflex.analysis.norms.energy import _Integral, _over, _Share
from tests.unit.analysis.norms.models import cantilever, squares_of_frequencies, two_masses


def h2(text, noise=""):
    model = symflex.Model(inputs={"u": {}}, outputs={"y": f"u*({text})"})
    return model.transfer_function("y", "u").bind().h2(noise)


def contains(ball, value, share=1e-13):
    return abs(float(ball.mid()) - value) <= float(ball.rad()) + share * abs(value)


def test_the_integral_over_a_form_holds_what_it_lacks_in_phase_and_against_it():
    # abs(2 + t)^2 over [-3, 3] is 8*3 + 2*27/3; and what is 1/4 larger or smaller than 2 throughout.
    powers = (acb_mat(1, 2, [2, 0]), acb_mat(1, 2, [1, 0]))
    assert _over(TaylorForm(powers, arb(0)), arb(3)).overlaps(arb(24 + 18))
    assert _over(TaylorForm(powers, arb(0)), arb(3)).rad() < 1e-9
    found = _over(TaylorForm(powers[:1], arb(0.25)), arb(3))
    assert found.contains(6 * 2.25**2 * (1 - 1e-9)) and found.contains(6 * 1.75**2)
    assert found.upper() < 6 * 2.25**2 * (1 + 1e-6)
    turned = (acb_mat(1, 1, [acb(0, 2)]), acb_mat(1, 1, [1]))  # abs(2 j + t)^2 is 4 + t^2
    assert _over(TaylorForm(turned, arb(0)), arb(3)).overlaps(arb(24 + 18))


def test_an_integral_is_not_enough_while_a_piece_is_without_bound():
    integral = _Integral(MatrixOnAxis(((None,),)), None)
    for value, enough in ((arb(1), True), (arb(1, 0.5), False), (arb("inf"), False)):
        share = _Share((0.0, 1.0), value, in_disc=True)
        integral._count(_Share((1.0, 2.0), arb(1), in_disc=True), 1)
        integral._count(share, 1)
        assert integral.is_enough() is enough
        integral._count(share, -1)
        assert integral.is_enough()


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


def test_the_acceleration_of_a_mass_at_a_damped_beam_has_no_norm():
    # Its acceleration tends to 1/m.
    text = """
    symflex = 1
    [elements]
    arm = { type = "beam", between = ["p", "q"], EI = 20, rhoA = 1, l = 1, eta = "1 ms" }
    held = { type = "fixed", at = "p" }
    load = { type = "mass", at = "q.y", m = 3 }
    [inputs]
    F = { force = "q.y" }
    [outputs]
    A = "s^2*q.y"
    """
    assert "does not fall off" in symflex.loads(text).transfer_function("A", "F").bind().h2().because


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


def test_delays_beside_a_slow_end_are_integrated():
    # e^-t - e^-2(t - T) from t = T on: its square has the integral 1/2 + 1/4 - 2 e^-T/3.
    norm = h2("1/(s + 1) - exp(-0.1*s)/(s + 2)")
    assert norm.certified
    assert norm.value.contains((0.75 - 2 * (arb(-1) / 10).exp() / 3).sqrt()) and norm.value.rad() < 0.01


def test_a_sum_of_delays_that_does_not_fall_off_has_no_end():
    for text in ("(1 + exp(-s))", "(1/(s + 1) + exp(-s))"):
        norm = h2(text)
        assert not norm.value.is_finite()
        assert "does not fall off" in norm.because
