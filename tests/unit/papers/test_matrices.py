"""Matrices of formulas; determinants and inverses are those of numpy at numbers."""

import numpy as np
import pytest

from symflex.errors import SpecError
from symflex.expressions import fold
from tests.unit.papers.reading import read

VALUES = {"a": 2.0, "b": 3.0, "c": 5.0, "d": 7.0}
PLAIN = np.array([[2.0, 3.0], [5.0, 7.0]])
MATRIX = r"\begin{bmatrix} a & b \\ c & d \end{bmatrix}"


@pytest.mark.parametrize(
    ("latex", "value"),
    [
        (rf"\det({MATRIX})", np.linalg.det(PLAIN)),
        (rf"\begin{{bmatrix}} 1 & 0 \end{{bmatrix}} {MATRIX}^{{-1}} \begin{{bmatrix}} 0 \\ 1 \end{{bmatrix}}",
         np.linalg.inv(PLAIN)[0, 1]),
        (rf"\det({MATRIX} + 2 {MATRIX})", 9 * np.linalg.det(PLAIN)),
    ],
)  # fmt: skip
def test_matrices_are_multiplied_out(latex, value):
    found = fold(read(latex), number=float, name=VALUES.__getitem__, power=pow, call=None)
    assert found == pytest.approx(value)


def test_matrices_of_other_sizes_are_refused():
    with pytest.raises(SpecError, match="sizes cannot be"):
        read(rf"\det({MATRIX} + \begin{{bmatrix}} 1 & 2 \end{{bmatrix}})")
