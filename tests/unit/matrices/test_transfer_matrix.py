"""Matrices of transfer functions over one denominator, compared with solves by hand and by numpy."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from symflex.errors import BudgetError, UsageError
from symflex.matrices.transfer_matrix import derive_matrix
from tests.unit.matrices.models import BEAM, TWO_MASSES, model_of


def two_masses(s: complex) -> npt.NDArray[np.complex128]:
    """Return what K + M s^2 answers with the numbers of TWO_MASSES."""
    return np.linalg.inv(np.array([[2 * s**2 + 50, -20], [-20, s**2 + 20]], complex))


def test_two_masses_have_the_numerators_of_their_adjugate_over_their_determinant() -> None:
    over = derive_matrix(model_of(TWO_MASSES)).over
    ring = over.den.ring
    s, m_1, m_2, k_1, k_2 = (ring.generator(name) for name in ("s", "m_1", "m_2", "k_1", "k_2"))
    assert over.den.expand() == (m_1 * s**2 + k_1 + k_2) * (m_2 * s**2 + k_2) - k_2**2
    expanded = [[n.expand() for n in row] for row in over.numerators]
    assert expanded == [[m_2 * s**2 + k_2, k_2], [k_2, m_1 * s**2 + k_1 + k_2]]


def test_values_are_an_array_of_the_shape_of_the_matrix_and_of_s() -> None:
    s = np.array([[0.3j, 1 + 2j, -0.5], [2j, 7j, 1e3j]])
    values = derive_matrix(model_of(TWO_MASSES)).bind().at(s)
    assert values.shape == (2, 2, 2, 3)
    for place in np.ndindex(s.shape):
        assert np.allclose(values[(..., *place)], two_masses(complex(s[place])), rtol=1e-13)
    assert derive_matrix(model_of(TWO_MASSES), ["X_2"], ["F_1"]).bind().at(0).shape == (1, 1)


def test_names_choose_rows_and_columns_in_their_order() -> None:
    matrix = derive_matrix(model_of(TWO_MASSES), ["X_2", "X_1"], ["F_2"])
    assert [o.name for o in matrix.outputs] == ["X_2", "X_1"]
    assert [i.name for i in matrix.inputs] == ["F_2"]
    assert matrix.shape == (2, 1)
    with pytest.raises(UsageError, match="there is no input 'F_3'"):
        derive_matrix(model_of(TWO_MASSES), [], ["F_3"])


def test_a_factor_that_one_pair_lacks_is_in_the_common_denominator_and_in_its_numerator() -> None:
    # The velocity cancels the s that the position has below; both are over m s (s + b/m) s = 0.
    text = """
symflex = 1
[parameters]
m = "2 kg"
b = "3 N*s/m"
[elements]
cart = { type = "mass", at = "x", m = "m" }
drag = { type = "damper", between = ["x", "ground"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
V = "s*x"
"""
    over = derive_matrix(model_of(text)).over
    ring = over.den.ring
    s, m, b = (ring.generator(name) for name in ("s", "m", "b"))
    assert over.den.expand() == s * (m * s + b)
    assert [row[0].expand() for row in over.numerators] == [1, s]


def test_numerators_of_a_beam_share_kernels_where_single_functions_have_halves() -> None:
    matrix = derive_matrix(model_of(BEAM))
    bound = matrix.bind()
    over = bound.over
    s = 1 + 40j
    values = [complex(f(s)) for f in bound.each]
    # The tip of a clamped-free beam: (sin cosh - cos sinh)/(EI b^3 (1 + cos cosh)) (Blevins 1979, table 8-1).
    beta = (-(s**2) * 3.1 / 800) ** 0.25
    x = beta * 0.9
    tip = (np.sin(x) * np.cosh(x) - np.cos(x) * np.sinh(x)) / (800 * beta**3 * (1 + np.cos(x) * np.cosh(x)))
    assert values[0] == pytest.approx(tip, rel=1e-12)
    lengths = {str(kernel.length) for kernel in over.kernels.kernels}
    assert lengths == {"9/20"}


def test_a_nested_matrix_has_values_and_no_common_denominator() -> None:
    matrix = derive_matrix(model_of(TWO_MASSES), representation="nested")
    assert np.allclose(matrix.bind().at(2j), two_masses(2j), rtol=1e-13)
    with pytest.raises(BudgetError, match="SF502"):
        _ = matrix.over
