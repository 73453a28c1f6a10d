"""The independent derivations agree with each other and with what the paper says."""

from fractions import Fraction

import numpy as np
import pytest
import sympy

from tests.independent import dense, eppinger1988
from tests.independent.lagrange import s


def degrees(expr):
    """Return the degrees in s of numerator and denominator."""
    num, den = sympy.fraction(sympy.cancel(expr))
    return sympy.degree(num, s), sympy.degree(den, s)


def symbols(names):
    return sympy.symbols(names)


def test_the_laws_of_the_rigid_body_give_the_printed_formula():
    assert sympy.cancel(eppinger1988.rigid_body() - eppinger1988.printed_rigid_body()) == 0


def test_the_energies_of_two_masses_agree_with_shooting():
    m_1, m_2, k, b = symbols("m_1 m_2 k b")
    for shot, name in zip(eppinger1988.chain([m_1, m_2], [k], [b], s), ("x_act", "x_tip"), strict=True):
        assert sympy.cancel(shot - eppinger1988.two_mass(name)) == 0


def test_each_mode_of_a_chain_adds_two_poles_to_the_tip_and_one_zero_where_it_is_damped():
    for n in (2, 3):
        m, k, b = (symbols(f"{name}_1:{n + 1}") for name in "mkb")
        _, tip = eppinger1988.chain(m, k[:-1], b[:-1], s)
        assert degrees(tip) == (n - 1, 2 + 2 * (n - 1))
        links = sympy.prod(k_i + b_i * s for k_i, b_i in zip(k[:-1], b[:-1], strict=True))
        assert not sympy.cancel(tip / links).as_numer_denom()[0].has(s)
        _, undamped = eppinger1988.chain(m, k[:-1], [0] * (n - 1), s)
        assert degrees(undamped) == (0, 2 * n)


FIGURE_8C = {  # output, what friction and force act against: zeros and poles
    ("tip", "base", "base"): (2, 3),
    ("motor", "base", "base"): (2, 3),
    ("motor", "nothing", "base"): (2, 3),
    ("tip", "nothing", "base"): (0, 1),
    ("tip", "ground", "base"): (0, 1),
    ("tip", "ground", "ground"): (0, 1),
}


def test_the_reading_of_figure_8c_decides_the_count_of_zeros_and_poles():
    assert {case: degrees(s * eppinger1988.base_flexure(*case)) for case in FIGURE_8C} == FIGURE_8C


def test_the_tip_numerator_of_the_lumped_beam_holds_the_bracket_of_the_balance():
    EI, length = symbols("EI l")
    num, _ = sympy.fraction(eppinger1988.lumped_bending_beam("x_tip"))
    expected = 2 * EI + length * eppinger1988.tip_bracket() * s**2
    assert not sympy.cancel(num / expected).has(s)


def test_the_bracket_in_numbers_is_the_bracket_in_symbols():
    m_2, J, c, h, length = symbols("m_2 J c h l")
    printed = eppinger1988.bracket(m_2, J, c, h, length)
    assert sympy.expand(printed - eppinger1988.tip_bracket()) == 0


def test_a_uniform_bar_with_its_tip_at_the_far_end_always_has_a_negative_bracket():
    m_2, h, length = symbols("m_2 h l")
    uniform = eppinger1988.bracket(m_2, m_2 * h**2 / 12, h / 2, h, length)
    assert sympy.expand(uniform + m_2 * h * (h / 3 + length / 2)) == 0


def test_shooting_keeps_exact_numbers_exact():
    act, _ = eppinger1988.chain([Fraction(2), Fraction(3)], [Fraction(5)], [Fraction(7)], Fraction(1, 2))
    assert isinstance(act, Fraction)


def test_shooting_agrees_with_the_dense_solver():
    masses, stiffnesses, dampings, at = [2.0, 3.0, 1.0], [5.0, 4.0], [0.3, 0.2], 0.4 + 1.3j
    difference = np.diff(np.eye(3), axis=0)
    links = np.diag([k + b * at for k, b in zip(stiffnesses, dampings, strict=True)])
    stiffness = np.diag(masses) * at**2 + difference.T @ links @ difference
    motion = dense.solve(stiffness, np.array([1.0, 0.0, 0.0]))
    shot = eppinger1988.chain(masses, stiffnesses, dampings, at)
    assert np.allclose(np.array(shot), motion[[0, 2]].astype(complex), rtol=1e-13, atol=0)


def test_chain_poles_are_the_poles_of_shooting():
    masses, stiffnesses, dampings = [2.0, 3.0, 1.0], [5.0, 4.0], [0.3, 0.2]
    poles = eppinger1988.chain_poles(masses, stiffnesses, dampings)
    pole = max(poles, key=abs)
    act, _ = eppinger1988.chain(masses, stiffnesses, dampings, complex(pole))
    assert abs(1 / act) < 1e-12 * abs(masses[0] * pole**2)


def test_the_dense_solver_refuses_a_singular_matrix():
    with pytest.raises(np.linalg.LinAlgError):
        dense.solve(np.array([[1.0, 2.0], [2.0, 4.0]]), np.array([1.0, 1.0]))
