"""State equations by named matrices, beside the same equations written out by hand."""

import pytest

from symflex.errors import SpecError
from symflex.pipeline import loads
from tests.unit.papers.test_motion import equations, specification

A, B = r"\begin{bmatrix}0&1\\-k/m&-c/m\end{bmatrix}", r"\begin{bmatrix}0\\1/m\end{bmatrix}"
OSCILLATOR = ["x_1' = x_2", "x_2' = -k/m*x_1 - c/m*x_2 + 1/m*u"]


@pytest.mark.parametrize(
    "latex",
    [
        rf"\[ \dot{{x}}=Ax+Bu \] \[ A={A},\quad B={B} \]",
        rf"\[ \dot{{\mathbf{{x}}}}(t) = \mathbf{{A}}\mathbf{{x}}(t)+\mathbf{{B}}u(t) \] "
        rf"\[ \mathbf{{A}}={A} \] \[ \mathbf{{B}} = \frac{{1}}{{m}}\begin{{bmatrix}}0&1\end{{bmatrix}}^T\]",
        rf"\[ \dot{{x}} = {A}x + {B}u \]",
        rf"\[ \begin{{bmatrix}} \dot x_1 \\ \dot x_2\end{{bmatrix}} = {A}\begin{{bmatrix}} x_1 \\ x_2"
        rf"\end{{bmatrix}} + {B} u \]",
    ],
)
def test_a_state_equation_is_written_out(latex):
    assert equations(specification(latex)) == OSCILLATOR


def test_states_that_have_names_keep_them():
    text = specification(
        r"\[ \dot{x}=Ax+Bu, \quad y = Cx + Du \] with $x = \begin{bmatrix} q & \dot q\end{bmatrix}^T$, "
        rf"$A={A}$, $B={B}$, $C=\begin{{bmatrix}}1&0\end{{bmatrix}}$, $D = 0$"
    )
    assert equations(text) == ["q'' = -k/m*q - c/m*q' + 1/m*u", "y = q"]
    assert loads(text).transfer_functions == (("Q", "u"), ("Y", "u"))


def test_masses_and_stiffnesses_may_be_matrices():
    text = specification(
        r"\[ M\ddot{q} + Kq = F,\ M=\begin{bmatrix}m_1&0\\0&m_2\end{bmatrix},\ "
        r"K=\begin{bmatrix}k&-k\\-k&k\end{bmatrix},\ F=\begin{bmatrix}f\\0\end{bmatrix} \]"
    )
    assert equations(text) == ["m_1*q_1'' + k*q_1 - k*q_2 = f", "m_2*q_2'' - k*q_1 + k*q_2 = 0"]


def test_a_matrix_that_is_not_given_is_said():
    with pytest.raises(SpecError, match=r"the term B\*u stands beside matrices and has no rows"):
        specification(rf"\[ \dot{{x}}=Ax+Bu \] \[ A={A} \]")
