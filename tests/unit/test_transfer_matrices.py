"""Matrices of transfer functions as a Python user holds them."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import sympy

import symflex
import symflex.errors
from tests.unit.matrices.models import TWO_MASSES

G = symflex.loads(TWO_MASSES).transfer_matrix()


def test_entries_are_found_by_number_and_by_name():
    assert G["X_2", "F_1"].name == G[1, 0].name == G[-1, 0].name == "X_2/F_1"
    assert G.bind()["X_2", "F_1"](2j) == G[1, 0].bind()(2j)
    with pytest.raises(symflex.errors.UsageError, match="there is no output 'X_3'"):
        G["X_3", "F_1"]
    for key in ((0, 2), (-3, 0), (slice(0, 2), 0), (..., 0), ([0, 1], 0), (1.5, 0), (True, 0), (None, 0), 0):
        with pytest.raises(symflex.errors.UsageError, match="SF902"):
            G[key]


def test_a_row_is_named_once():
    with pytest.raises(symflex.errors.UsageError, match="output 'X_1' is named twice"):
        symflex.loads(TWO_MASSES).transfer_matrix(["X_1", "X_1"])


def test_what_is_no_number_is_no_frequency():
    bound = G.bind()
    for ask in (bound.at, bound.rga, bound.singular_values, bound.characteristic_loci, bound[0, 0]):
        for s in ("x", None, [1, "x"], [[1, 2], [3]]):
            with pytest.raises(symflex.errors.UsageError, match="SF902"):
                ask(s)


def test_sympy_has_numerators_over_one_denominator():
    assert (G.num / G.den - G.to_sympy()).applyfunc(sympy.simplify) == sympy.zeros(2)
    assert sympy.simplify(G.to_sympy().det() - G.det()) == 0
    assert (G.to_sympy() * G.inverse().to_sympy()).applyfunc(sympy.simplify) == sympy.eye(2)


def test_numbers_have_relative_gains_and_static_gains():
    bound = G.bind(k_1=10, k_2=30)
    assert np.allclose(bound.dcgain(), [[1 / 10, 1 / 10], [1 / 10, 1 / 10 + 1 / 30]], rtol=1e-15)
    assert np.allclose(bound.rga(0), [[4, -3], [-3, 4]], rtol=1e-12)  # 1 + k_2/k_1
    assert np.isnan(bound.rga([0, 1e3j])).sum() == 0
    assert bound.rga([0, 1j, 2j]).shape == (2, 2, 3)


def test_python_control_gets_all_inputs_and_outputs_by_name():
    control = pytest.importorskip("control")
    system = G.bind().to_control()
    assert isinstance(system, control.TransferFunction)
    assert (system.input_labels, system.output_labels) == (["F_1", "F_2"], ["X_1", "X_2"])
    assert np.allclose(system(2j), G.at(2j), rtol=1e-12)


def test_a_matrix_can_be_pickled_as_its_inverse_and_its_numbers_can():
    for matrix in (G, G.inverse()):
        again = pickle.loads(pickle.dumps(matrix))
        assert str(again) == str(matrix)
    bound = pickle.loads(pickle.dumps(G.bind(k_1=10)))
    assert np.array_equal(bound.at(2j), G.bind(k_1=10).at(2j))


def test_code_has_a_function_of_the_matrix():
    assert "def transfer_matrix(" in G.export()
    assert "transfer_matrix_freq(" in G.export("c")
    with pytest.raises(symflex.errors.UsageError, match="there is no target 'latex'"):
        G.export("latex")


def test_a_notebook_shows_the_equation_and_a_terminal_the_text():
    assert G._repr_latex_().startswith(r"$\displaystyle \begin{pmatrix} X_{1}(s)")
    assert str(G).startswith("(X_1, X_2) / (F_1, F_2)\n")
    assert G.to_json_dict()["schema"] == "symflex.matrix/1"
    assert r"\begin{equation}" in G.latex(width="ieee")
    assert G.normal_rank == 2
    assert "RGA(0) = [" in str(G.interaction())


def test_roots_of_the_whole_matrix_follow_the_values_that_were_bound():
    # By hand: X_1/F_1 has the zeros of the second mass on its spring, s^2 = -k_2/m_2; both pairs none.
    one = symflex.loads(TWO_MASSES).transfer_matrix(["X_1"], ["F_1"]).bind(k_2="80 N/m")
    assert [complex(z).imag for z in one.zeros()] == pytest.approx([80**0.5, -(80**0.5)])
    assert (G.bind().zeros(), len(G.bind().poles())) == ((), 4)
    roots = G.bind().roots()
    assert "normal rank 2 of a 2 x 2 matrix" in str(roots)
    assert repr(roots).startswith("<MatrixRoots X_1,X_2/F_1,F_2: 4 poles, 0 zeros, certified")
    with pytest.raises(symflex.errors.UsageError, match="of an inverse"):
        G.inverse().bind().zeros()
