"""State equations of residues, against the residues."""

import numpy as np
import pytest
from flint import acb, arb

from symflex.analysis.norms.modal_model import modal_model
from symflex.roots import Root


def pole_at(re, im=0.0, times=1):
    return Root(arb(re), arb(im), times, on_imaginary_axis=re == 0, is_real=im == 0)


def value(arrays, s):
    inner = np.linalg.solve(s * np.eye(len(arrays.a)) - arrays.a, arrays.b)
    return arrays.c @ inner + arrays.d


def test_blocks_have_the_residues_of_their_poles():
    pair = np.array([[1 + 2j, 3], [2 - 1j, 1 - 1j]])  # rank two
    chain = {1: np.array([[1.0, 0], [0, 2]]) + 0j, 2: np.array([[0, 1.0], [1, 0]]) + 0j}
    residues = [
        (pole_at(-1, 5), acb(-1, 5), {1: pair}),
        (pole_at(-3, times=2), acb(-3), chain),
        (pole_at(0), acb(0), {1: np.array([[2.0, 4], [1, 2]]) + 0j}),
    ]
    model = modal_model(residues, [[arb(0.5), arb(0)], [arb(0), arb(0)]])
    s = 0.3 + 2j
    expected = pair / (s + 1 - 5j) + pair.conj() / (s + 1 + 5j) + chain[1] / (s + 3) + chain[2] / (s + 3) ** 2
    expected = expected + np.array([[2, 4], [1, 2]]) / s + np.array([[0.5, 0], [0, 0]])
    assert value(model.arrays, s) == pytest.approx(expected)
    assert len(model.arrays.a) == 4 + 4 + 1  # the residue at 0 has rank one
    total = np.zeros((2, 2), dtype=complex)
    for term in model.terms:
        for at, weight in term.weights.items():
            total[at] += complex(weight) / (s - complex(term.pole)) ** term.power
    assert total + model.arrays.d == pytest.approx(expected)
