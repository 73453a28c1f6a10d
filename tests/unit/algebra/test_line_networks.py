"""The functions that solve networks of line elements at frequencies."""

import numpy as np
import pytest

from symflex.algebra.line_networks import doubled_relation, equilibrated, network_value, series_exponential

ROD = ((0, 1), (1, 0))
"""Where the coefficients of a rod stand in A: compliance and inertia per length."""


def rod_network(length):
    """Return entries and table of a rod held at its start and pulled at its end, at s = j omega."""
    entries = [1.0, -1.0, 0.5, np.array([-3.0 + 0j]), length]
    lumped = ((2, 2, 1), (2, 3, 1), (3, 1, 0))
    rods = (ROD, (1, -1), ((0, (2, 3), 4, (-1, 0), (1, 2)),))
    return entries, (3, 3, 3, lumped, (rods,))


def test_a_rod_has_its_tangent_to_the_digits_that_its_length_has_and_decays_without_overflow():
    # u'' = -1.5 u, u(0) = 0, 2 u'(l) = 1 (Graff 1975, section 2.1).
    entries, table = rod_network(0.7)
    wave = np.sqrt(1.5)
    assert network_value(entries, table, 0, 0)[0] == pytest.approx(np.tan(wave * 0.7) / (2 * wave), rel=1e-14)
    entries, table = rod_network(5e3)
    wave = np.sqrt(1.5)
    expected = np.tan(wave * 5e3) / (2 * wave)
    assert network_value(entries, table, 0, 0)[0] == pytest.approx(expected, rel=1e-10)
    entries, table = rod_network(1e5)
    entries[3] = np.array([3.0 + 0j])
    assert network_value(entries, table, 0, 0)[0] == pytest.approx(1 / (2 * np.sqrt(1.5)), rel=1e-14)


def test_an_output_that_nothing_drives_is_zero():
    entries, (*sizes, lumped, groups) = rod_network(0.7)
    table = (*sizes, lumped[:2], groups)
    assert network_value(entries, table, 0, 0)[0] == 0


def test_the_series_is_the_exponential():
    found = series_exponential({(0, 1): np.array([2.0 + 0j]), (1, 0): np.array([2.0 + 0j])}, 2)
    assert found[0, 0][0] == pytest.approx(np.cosh(2.0), rel=1e-15)
    assert found[1, 0][0] == pytest.approx(np.sinh(2.0), rel=1e-15)


def test_two_relations_in_a_row_hold_the_squared_transfer_matrix():
    transfer = np.array([[0.3, 1.1], [-0.7, 0.9]], dtype=complex)
    relation = np.concatenate([transfer, -np.eye(2)], axis=1)[:, :, None]
    found = doubled_relation(relation)[:, :, 0]
    assert found[:, :2] + found[:, 2:] @ transfer @ transfer == pytest.approx(np.zeros((2, 2)), abs=1e-15)


def test_rows_and_unknowns_are_scaled_towards_one_by_powers_of_two():
    rows, columns = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    given = np.array([[1e12], [1.0], [1.0], [1e-12]], dtype=complex)
    found = equilibrated(2, rows, columns, given)
    assert (np.frexp((found / given).real)[0] == 0.5).all()
    assert np.abs(found).max() < 4
