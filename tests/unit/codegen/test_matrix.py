"""Functions of whole matrices: values of single functions, shared work, and a shape of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from symflex.codegen.c.module import C99
from symflex.codegen.javascript import JAVASCRIPT
from symflex.codegen.julia import JULIA
from symflex.codegen.matlab import MATLAB
from symflex.codegen.program.matrix import entry_of, matrix_program
from symflex.codegen.program.verify import choose_programs
from symflex.codegen.python.module import ARRAY_API, NUMPY
from symflex.matrices.transfer_matrix import derive_matrix
from tests.unit.matrices.models import BEAM, TWO_MASSES, model_of

ROWS = (("X_1/F_1", "X_1/F_2"), ("X_2/F_1", "X_2/F_2"))


def exported(language, text, rows):
    model = model_of(text)
    matrix = derive_matrix(model, solves=language.solves)
    return replace(language, rows=rows).export(model, matrix.each, "model", samples=20).text


def module_of(text):
    names: dict = {}
    exec(compile(text, "model.py", "exec"), names)  # noqa: S102 (our own text)
    return names


@pytest.mark.parametrize("language", [NUMPY, ARRAY_API], ids=["numpy", "array-api"])
def test_a_matrix_has_the_values_of_its_functions_in_the_shape_of_all_arguments(language):
    names = module_of(exported(language, TWO_MASSES, ROWS))
    s, k_1 = 1j * np.geomspace(0.1, 1e30, 7), np.array([[10.0], [30.0]])
    values = names["transfer_matrix"](s, k_1=k_1)
    assert values.shape == (2, 2, 2, 7)
    for i, row in enumerate(ROWS):
        for j, name in enumerate(row):
            single = names["TRANSFER_FUNCTIONS"][name](s, k_1=k_1)
            assert np.allclose(values[i, j], single, rtol=1e-14, atol=0), name
    assert names["transfer_matrix"](0.5j).shape == (2, 2)
    stiffness = np.array([[50 - 2 * 0.25, -20], [-20, 20 - 0.25]])
    assert np.allclose(names["transfer_matrix"](0.5j), np.linalg.inv(stiffness), rtol=1e-14)


def test_a_long_array_is_computed_in_blocks():
    names = module_of(exported(NUMPY, TWO_MASSES, ROWS))
    s = 1j * np.geomspace(0.1, 100, 50_001)
    assert np.array_equal(names["transfer_matrix"](s)[:, :, ::10], names["transfer_matrix"](s[::10]))


def test_a_matrix_of_a_beam_calls_its_functions():
    names = module_of(exported(NUMPY, BEAM, (("tip/F",), ("middle/F",))))
    values = names["transfer_matrix"](3j)
    assert values.shape == (2, 1)
    assert values[0, 0] == names["TRANSFER_FUNCTIONS"]["tip/F"](3j)


def test_a_program_shares_its_denominator_and_is_measured_entry_by_entry():
    matrix = derive_matrix(model_of(TWO_MASSES))
    program, verified = matrix_program(matrix.pairs)
    alone = sum(choose_programs(tf, 20)[0][0].size for tf in matrix.each)
    assert program.size < 0.6 * alone
    assert verified.error < 1e-15
    assert len(entry_of(program, 3).near.values) == 1


@pytest.mark.parametrize("language", [C99, MATLAB, JULIA, JAVASCRIPT], ids=["c", "matlab", "julia", "js"])
def test_every_language_has_a_function_of_the_matrix(language):
    text = exported(language, TWO_MASSES, ROWS)
    assert "transfer_matrix" in text
    assert "Transfer matrix of X_1, X_2 (rows) by F_1, F_2 (columns)." in text
