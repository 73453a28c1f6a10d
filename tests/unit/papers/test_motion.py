"""Equations of motion of textbooks become specifications that give the textbooks' transfer functions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from symflex.errors import SpecError, Text
from symflex.papers.motion import motion_specification
from symflex.papers.source import read_text
from symflex.pipeline import loads
from symflex.transfer import bind
from symflex.transfer.of_model import derive_all


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


def value(text: str, at: complex, **values: str) -> complex:
    """Return the first transfer function of a specification at a point, its parameters being given."""
    for name, given in values.items():
        text = text.replace(f"\n{name} = {{}}", f'\n{name} = "{given}"', 1)
    model = loads(text)
    return complex(bind(derive_all(model, model.transfer_functions[:1])[0])(at))


def test_lagranges_equations_have_the_values_of_newtons() -> None:
    # (M + m) x'' + m l theta'' = F and m l x'' + m l^2 theta'' + m g l theta = 0, solved by numpy.
    at, cart, load, rope, g = 0.7 + 1.3j, 3.0, 2.0, 0.5, 9.81
    swing = load * rope**2 * at**2 + load * g * rope
    matrix = [[(cart + load) * at**2, load * rope * at**2], [load * rope * at**2, swing]]
    expected = np.linalg.solve(matrix, [1, 0])[0]
    found = value(specification(CRANE), at, M="3", m="2", l="0.5", g="9.81")
    assert found == pytest.approx(expected, rel=1e-9)


TIMOSHENKO = (
    r"""\begin{align} \rho A w_{tt} - k' (w_x - \phi)_x &= 0 \\
\rho I \phi_{tt} - EI \phi_{xx} - k'(w_x - \phi) &= 0 \end{align}
\[ w(0,t)=\phi(0,t)=0, \quad EI \phi_x(L,t) = 0, \quad k'(w_x(L,t) - \phi(L,t)) = f(t) \]""",
    r"""\begin{align} k_p (w'' - \phi') &= \rho A \ddot w \\
EI\phi'' + k_p(w'-\phi) &= \rho I \ddot\phi \end{align}
\begin{align} w(0,t)&=0 & \phi(0,t)&=0 & \phi'(L,t)&=0 & k_p(w'(L,t)-\phi(L,t)) &= f(t)\end{align}""",
    r"""\begin{align} \rho A \frac{\partial^2 w}{\partial t^2}
- \frac{\partial}{\partial x}\left[ k_p \left(\frac{\partial w}{\partial x} - \phi\right)\right] &= 0 \\
\rho I \frac{\partial^2\phi}{\partial t^2}
- \frac{\partial}{\partial x}\left(EI\frac{\partial\phi}{\partial x}\right)
- k_p\left(\frac{\partial w}{\partial x}-\phi\right) &= 0 \end{align}
\[ w = \phi = 0 \text{ at } x = 0, \qquad \frac{\partial\phi}{\partial x} = 0 \text{ at } x = L, \qquad
k_p\left(\frac{\partial w}{\partial x}-\phi\right) = f(t) \text{ at } x = L \]""",
)


@pytest.mark.parametrize("latex", TIMOSHENKO)
def test_coupled_fields_of_a_timoshenko_beam_are_one_problem(latex: str) -> None:
    # First-order system of w, phi, w' and phi' along x, by the matrix exponential of scipy.
    at, rho, area, inertia, modulus, k, length = 40 + 900j, 2700.0, 1.5e-4, 1.2e-9, 7e10, 3e6, 0.8
    system = np.array(
        [
            [0, 0, 1, 0],
            [0, 0, 0, 1],
            [rho * area * at**2 / k, 0, 0, 1],
            [0, (rho * inertia * at**2 + k) / (modulus * inertia), -k / (modulus * inertia), 0],
        ]
    )
    whole = expm(system * length)
    columns = whole[:, 2:]
    ends = np.array([columns[3], k * (columns[2] - columns[1])])
    expected = columns[0] @ np.linalg.solve(ends, [0, 1])
    values = {"rho": rho, "A": area, "I": inertia, "E": modulus, "k_p": k, "L": length}
    found = value(specification(latex), at, **{name: repr(v) for name, v in values.items()})
    assert found == pytest.approx(expected, rel=1e-7)


BEAM = {"EI w_{xxxx} + m w_{tt} = 0", r"EI w_{,xxxx} + m w_{,tt} = 0", r"EI w'''' + m \ddot w = 0"}
BEAM |= {r"EI w^{(4)} + m \ddot w = 0"}


@pytest.mark.parametrize("latex", sorted(BEAM))
def test_subscripts_primes_and_orders_are_derivatives_of_a_field(latex: str) -> None:
    text = specification(
        rf"\[ {latex} \] \[ w(0,t) = w_x(0,t) = 0, w_{{xx}}(L,t) = 0, EI w_{{xxx}}(L,t) = F(t) \]"
    )
    assert """equation   = "E*I*w'''' + m*s^2*w = 0\"""" in text
    assert equations(text) == ["w(0) = 0", "w'(0) = 0", "w''(L) = 0", "E*I*w'''(L) = F"]


def test_a_prime_of_a_constant_is_no_derivative() -> None:
    text = specification(
        r"\begin{align} v_x + L' i_t + R' i &= 0 \\ i_x + C' v_t &= 0 \end{align}"
        r"\[ v(0,t) = e(t), \quad i(l,t) = 0 \]"
    )
    assert equations(text) == ["v' + L_p*s*i + R_p*i = 0", "i' + C_p*s*v = 0", "v(0) = e", "i(l) = 0"]


@pytest.mark.parametrize(
    ("words", "conditions"),
    [
        ("clamped at $x=0$ and free at $x=L$", ["w(0) = 0", "w'(0) = 0", "w''(L) = 0", "w'''(L) = 0"]),
        ("simply supported at $x=0$ and $x=L$", ["w(0) = 0", "w''(0) = 0", "w(L) = 0", "w''(L) = 0"]),
    ],
)
def test_supports_said_in_words_are_conditions(words: str, conditions: list[str]) -> None:
    text = specification(rf"The beam is {words}, \[ EI w_{{xxxx}} + m w_{{tt}} = q(t). \]")
    assert equations(text) == conditions
    assert f"# line 1: {words.partition(' and free')[0]}" in text


def test_a_load_at_a_point_is_a_gap() -> None:
    with pytest.raises(SpecError, match="a load at a point is not read"):
        specification(r"\[ EI w_{xxxx} + m w_{tt} = f(t)\delta(x - a) \]")


def test_an_output_is_taken_where_a_field_may_move() -> None:
    text = specification(r"\[ y_{tt} = c^2 y_{xx}, \quad y(0,t)=u(t), \quad y(L,t)=0 \]")
    assert 'Y = "y(L/2)"' in text
