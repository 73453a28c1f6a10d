"""Matrices as text, LaTeX, Typst, Office Math, JSON and SymPy."""

from __future__ import annotations

import sympy

from symflex.errors import Text
from symflex.expressions import parse
from symflex.matrices import notations
from symflex.matrices.printed import print_matrix
from symflex.matrices.transfer_matrix import derive_matrix
from symflex.print.documents import omml_rows, typst_rows
from tests.unit.matrices.models import TWO_MASSES, model_of

MATRIX = derive_matrix(model_of(TWO_MASSES))
FORM = print_matrix(MATRIX)


def test_text_has_the_matrix_beside_its_fraction_and_the_denominator_below() -> None:
    lines = notations.matrix_text(MATRIX, FORM).splitlines()
    assert lines == [
        "(X_1, X_2) / (F_1, F_2)",
        "",
        "          1   [ m_2*s^2 + k_2   k_2                 ]",
        "  G(s) = ---- [                                     ]",
        "         d(s) [ k_2             m_1*s^2 + k_1 + k_2 ]",
        "",
        "  d(s) = (m_1*s^2 + k_1)*(m_2*s^2 + k_2) + m_2*k_2*s^2",
        "",
        "  receptance [m/N]",
        "  colocated: X_1/F_1, X_2/F_2",
    ]


def test_a_sum_in_front_of_a_matrix_stands_in_parentheses():
    text = """
symflex = 1
[inputs]
u = {}
v = {}
[outputs]
x = "(s + 1)*u"
y = "(s + 1)*v"
"""
    matrix = derive_matrix(model_of(text))
    assert "  G(s) = (s + 1) [       ]" in notations.matrix_text(matrix, print_matrix(matrix))


def test_text_lists_entries_that_are_too_wide() -> None:
    text = notations.matrix_text(MATRIX, FORM, width=40)
    assert "G(s) = 1/d(s) * N(s)" in text
    assert "  N_22 = m_1*s^2 + k_1 + k_2\n" in text
    assert max(map(len, text.splitlines())) <= 40


def test_latex_is_a_pmatrix_whose_wide_entries_get_names_in_a_narrow_column() -> None:
    line = notations.matrix_latex(MATRIX, FORM)
    assert line.count(r"\begin{pmatrix}") == line.count(r"\end{pmatrix}") == 3
    assert r"m_{2} s^{2} + k_{2} & k_{2} \\ k_{2} & m_{1} s^{2} + k_{1} + k_{2}" in line
    narrow = notations.matrix_display(MATRIX, FORM, 60)
    assert r"\frac{1}{D(s)} \begin{pmatrix} N_{11}(s) & k_{2} \\ k_{2} & N_{22}(s) \end{pmatrix}" in narrow
    assert r"& N_{22}(s) \\" in narrow
    assert r"&\quad = m_{1} s^{2} + k_{1} + k_{2}" in narrow


def test_typst_and_office_math_have_matrices_of_their_own() -> None:
    rows = notations.matrix_mathml(MATRIX, FORM)
    assert "mat(X_(1) (s); X_(2) (s))" in typst_rows(rows)
    assert omml_rows(rows).count("<m:m>") == 3


def test_json_entries_are_numerators_in_the_grammar_of_specifications() -> None:
    document = notations.matrix_json(MATRIX, FORM)
    assert document["schema"] == "symflex.matrix/1"
    assert document["num"] == [["m_2*s^2 + k_2", "k_2"], ["k_2", "m_1*s^2 + k_1 + k_2"]]
    assert parse(Text.alone("<den>", str(document["den"])))


def test_sympy_inverts_to_the_dynamic_stiffness() -> None:
    matrix = notations.matrix_sympy(MATRIX, FORM)
    assert isinstance(matrix, sympy.ImmutableMatrix)
    names = sympy.symbols("m_1 m_2 k_1 k_2", positive=True)
    m_1, m_2, k_1, k_2 = names
    s = sympy.Symbol("s")
    stiffness = sympy.Matrix([[m_1 * s**2 + k_1 + k_2, -k_2], [-k_2, m_2 * s**2 + k_2]])
    assert (matrix * stiffness).applyfunc(sympy.simplify) == sympy.eye(2)
