"""Equations of motion of textbooks become specifications that give the textbooks' transfer functions."""

from __future__ import annotations

import pytest

from symflex.errors import SpecError, Text
from symflex.papers.motion import motion_specification
from symflex.papers.source import read_text
from symflex.pipeline import loads


def specification(latex: str) -> str:
    return motion_specification(read_text(Text.alone("paper.tex", latex)), "paper.tex")


def equations(text: str) -> list[str]:
    return [line.split('"')[1] for line in text.splitlines() if line.startswith('    "')]


CART = r"""\begin{align}
(M+m)\ddot{x} + b\dot x + ml\ddot\theta &= F(t) \\
ml^2\ddot\theta + ml\ddot x - mgl\theta &= 0 \end{align}"""


def test_equations_in_dots_become_equations_in_primes() -> None:
    text = specification(CART)
    assert equations(text) == [
        "(M + m)*x'' + b*x' + m*l*theta'' = F",
        "m*l^2*theta'' + m*l*x'' - m*g*l*theta = 0",
    ]
    model = loads(text)
    assert [p.name for p in model.parameters] == ["M", "m", "b", "l", "g"]
    assert model.transfer_functions == (("X", "F"), ("Theta", "F"))


def test_an_upright_d_is_a_differential() -> None:
    text = specification(r"\[ m\frac{\mathrm{d}^2x}{\mathrm{d}t^2}+c\frac{\mathrm{d}x}{\mathrm{d}t}+kx=F \]")
    assert equations(text) == ["m*x'' + c*x' + k*x = F"]


def test_equations_in_s_become_equations_in_s() -> None:
    # A motor: Newton's and Kirchhoff's laws in s; the voltage is the input, both others are unknown.
    text = specification(
        r"\begin{align} s(Js + b)\Theta(s) &= KI(s) \\ (Ls + R)I(s) &= V(s) - Ks\Theta(s) \end{align}"
    )
    assert equations(text) == ["s*(J*s + b)*Theta = K*I", "(L*s + R)*I = V - K*s*Theta"]
    assert loads(text).transfer_functions == (("Theta_out", "V"), ("I_out", "V"))


def test_a_transfer_function_of_a_paper_is_used_in_its_loop() -> None:
    text = specification(
        r"\[ Y(s) = G(s) E(s),\quad E(s) = R(s) - Y(s) \] \[ G(s) = \frac{K}{s(\tau s+1)} \]"
    )
    assert equations(text) == ["Y = K/(s*(tau*s + 1))*E", "E = R - Y"]
    assert loads(text).transfer_functions == (("Y_out", "R"), ("E_out", "R"))


def test_each_line_says_what_it_was_read_from() -> None:
    assert r"# line 2: (M+m)\ddot{x} + b\dot x + ml\ddot\theta &= F(t)" in specification(CART)


def test_values_are_marked_as_gaps() -> None:
    assert '# GAP: values and units of parameters, such as value = "2 kg"' in specification(CART)


def test_quotients_of_differentials_and_algebraic_equations_are_read() -> None:
    text = specification(
        r"\[ J\frac{d\omega}{dt} + b\,\omega = T - T_d(t), \quad L\frac{di}{dt} + R i = V(t) - K_e\omega \]"
        r" with $T = K_t i$"
    )
    assert equations(text) == ["J*omega' + b*omega = T - T_d", "L*i' + R*i = V - K_e*omega", "T = K_t*i"]
    assert loads(text).transfer_functions == (
        *(("Omega", "T_d"), ("Omega", "V"), ("I", "T_d"), ("I", "V")),
        *(("T_out", "T_d"), ("T_out", "V")),
    )


def test_matrices_become_an_equation_for_each_row() -> None:
    text = specification(
        r"\[ \begin{bmatrix} m & 0 \\ 0 & M \end{bmatrix}\begin{bmatrix} \ddot x_1 \\ \ddot x_2\end{bmatrix}+"
        r"\begin{bmatrix} k & -k \\ -k & k \end{bmatrix} \begin{bmatrix} x_1 \\ x_2 \end{bmatrix} ="
        r"\begin{bmatrix} F \\ 0 \end{bmatrix} \]"
    )
    assert equations(text) == ["m*x_1'' + k*x_1 - k*x_2 = F", "M*x_2'' - k*x_1 + k*x_2 = 0"]


def test_nonlinear_equations_get_an_operating_point_that_is_marked() -> None:
    text = specification(r"\[ ml^2\ddot\theta + mgl\sin(\theta) = \tau \]")
    assert equations(text) == ["m*l^2*theta'' + m*g*l*sin(theta) = tau"]
    assert "# GAP: the equations are not linear; rest at zero is assumed here" in text
    assert loads(text).operating_point is not None


def test_a_field_with_conditions_becomes_a_field() -> None:
    text = specification(
        r"\begin{align} EI\frac{\partial^4 w}{\partial x^4} + \rho A\frac{\partial^2 w}{\partial t^2} &= 0\\"
        r"w(0,t) = 0, \quad \left.\frac{\partial w}{\partial x}\right|_{x=0} &= 0 \\"
        r"EI w''(l,t) = 0, \quad EI w'''(l,t) &= F(t) \end{align}"
    )
    assert equations(text) == ["w(0) = 0", "w'(0) = 0", "E*I*w''(l) = 0", "E*I*w'''(l) = F"]
    assert """equation   = "E*I*w'''' + rho*A*s^2*w = 0\"""" in text
    assert loads(text).transfer_functions == (("W", "F"),)


def test_what_is_not_read_is_a_gap() -> None:
    text = specification(r"\[ m\ddot x + kx = F \] \[ y = \int x dt \] \[ J\ddot\phi + mg = u \]")
    assert "# GAP: line 1 is not read: a limit or an integral is not read" in text
    assert "# GAP: the term m*g of line 1 has no unknown in it and is no input" in text


def test_a_function_of_time_is_a_gap_and_no_parameter_becomes_an_input() -> None:
    text = specification(r"\[ m\ddot x + kx = F_0\cos(\omega t) \]")
    assert (
        "# GAP: the term F_0*cos(omega*t) of line 1 is a function of time; give it a name as an input" in text
    )
    assert "# GAP: no input was found: add what acts to an equation and to [inputs]" in text


def test_partial_derivatives_of_lagrange_make_no_field() -> None:
    text = specification(r"\[ \frac{\partial L}{\partial q} = 0 \] \[ m\ddot q + kq = Q \]")
    assert equations(text) == ["m*q'' + k*q = Q"]


def test_a_paper_without_motion_is_refused() -> None:
    with pytest.raises(SpecError, match="there are no equations of motion"):
        specification(r"\[ G = \frac{1}{s} \]")
    with pytest.raises(SpecError, match="there are no equations of motion"):
        specification(r"\[ \frac{X(s)}{F(s)} = \frac{1}{ms^2+k} \]")


def test_a_road_that_stands_beside_an_unknown_is_an_input() -> None:
    text = specification(
        r"\begin{align} m_s\ddot z_s &= -k_s(z_s - z_u) \\"
        r" m_u\ddot z_u &= k_s(z_s - z_u) - k_t(z_u - z_r) \end{align}"
    )
    assert loads(text).transfer_functions == (("Z_s", "z_r"), ("Z_u", "z_r"))


def test_a_chain_of_conditions_gives_each_of_them() -> None:
    text = specification(
        r"\[ EI\frac{\partial^4 w}{\partial x^4} + \mu\frac{\partial^2 w}{\partial t^2} = 0 \]"
        r"\[ w(0,t) = w''(0,t) = 0, \quad w(l,t) = u(t), \quad w''(l,t) = 0 \]"
    )
    assert equations(text) == ["w(0) = 0", "w''(0) = 0", "w(l) = u", "w''(l) = 0"]


def test_vectors_in_bold_are_the_same_below_dots() -> None:
    text = specification(
        r"\[ \mathbf{M}\ddot{\mathbf{q}} + \mathbf{K}\mathbf{q} = \mathbf{f} \]"
        r"\[ \mathbf{M} = \begin{bmatrix} m & 0 \\ 0 & J \end{bmatrix},"
        r" \mathbf{K} = \begin{bmatrix} k & -c \\ -c & d \end{bmatrix},"
        r" \mathbf{q} = \begin{bmatrix} x \\ y \end{bmatrix},"
        r" \mathbf{f} = \begin{bmatrix} F \\ 0 \end{bmatrix} \]"
    )
    assert equations(text) == ["m*x'' + k*x - c*y = F", "J*y'' - c*x + d*y = 0"]


CRANE = r"""\begin{align}
T &= \tfrac12 M\dot x^2 + \tfrac12 m(\dot x^2 + 2l\dot x\dot\theta\cos\theta + l^2\dot\theta^2), \\
V &= -mgl\cos\theta. \end{align} With $L = T - V$,
\[ \frac{d}{dt}\left(\frac{\partial L}{\partial \dot{x}}\right) - \frac{\partial L}{\partial x} = F, \qquad
\frac{d}{dt}\left(\frac{\partial L}{\partial \dot\theta}\right) - \frac{\partial L}{\partial \theta} = 0 \]"""


def test_lagranges_equations_become_energies() -> None:
    # By hand: M l s^2 + (M + m) g below, and l s^2 + g above for the trolley.
    text = specification(CRANE)
    model = loads(text)
    assert model.transfer_functions == (("X", "F"), ("Theta", "F"))
    assert 'coordinates = ["x", "theta"]' in text
    assert [line for line in text.splitlines() if "GAP: line" in line] == []


def test_friction_beside_lagranges_terms_is_a_gap() -> None:
    text = specification(
        r"\[ L = \frac12 ml^2\dot\theta^2 + mgl\cos\theta \]"
        r"\[ \frac{d}{dt}\frac{\partial L}{\partial\dot\theta} - \frac{\partial L}{\partial\theta}"
        r" + b\dot\theta = \tau \]"
    )
    assert "GAP: line 1 has more than the derivatives of L; add it to forces or dissipation" in text
