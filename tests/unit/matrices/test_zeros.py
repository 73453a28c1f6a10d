"""Which way the roots of a matrix are found, and names that are not there."""

from __future__ import annotations

import pytest

from symflex.errors import UsageError
from symflex.matrices.zeros import locate_matrix
from tests.unit.matrices.models import BEAM, TWO_MASSES, model_of


def test_roots_of_lumped_matrices_are_all_found() -> None:
    located = locate_matrix(model_of(TWO_MASSES)).located
    assert (located.certificate.engine, located.is_infinite) == ("polynomial", False)


def test_roots_of_distributed_matrices_are_found_in_a_region() -> None:
    located = locate_matrix(model_of(BEAM), ["tip"], ["F"]).located
    assert located.is_infinite
    assert located.is_default_region


def test_a_lumped_matrix_with_loss_factors_is_searched() -> None:
    text = TWO_MASSES.replace('k = "k_1"', 'k = "k_1", eta_s = 0.01')
    poles = locate_matrix(model_of(text)).located.poles
    assert len(poles) == 2
    assert poles[0].loss_factor() is not None


def test_gains_alone_have_neither_poles_nor_zeros() -> None:
    text = 'symflex = 1\ninputs = { u = {}, v = {} }\noutputs = { y = "2*u + v", z = "4*u + 2*v", w = "u" }\n'
    found = locate_matrix(model_of(text))
    assert (found.located.all_poles, found.located.zeros, found.normal_rank) == ((), (), 2)
    assert locate_matrix(model_of(text), ["y", "z"]).normal_rank == 1


def test_a_pair_is_a_matrix_of_one_row_and_column() -> None:
    # By hand: X_1/F_1 of two masses has the zeros of the second on its spring, s^2 = -20.
    zeros = locate_matrix(model_of(TWO_MASSES), ["X_1"], ["F_1"]).located.zeros
    assert [complex(zero) for zero in zeros] == pytest.approx([1j * 20**0.5, -1j * 20**0.5])


def test_names_that_are_not_there_are_refused() -> None:
    with pytest.raises(UsageError, match="there is no input 'F_3'"):
        locate_matrix(model_of(TWO_MASSES), [], ["F_3"])
