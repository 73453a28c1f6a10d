"""Sums of exponentials of characteristic roots, against fundamental functions from matrix exponentials."""

import mpmath as mp
import pytest
from flint import acb, acb_series, arb

from symflex.algebra import modal_sum as module
from symflex.algebra.modal_sum import ModalSums, modal_amplitudes, mode_values
from symflex.errors import BudgetError
from tests.unit.algebra.test_distributed_kernels import (
    POINT,
    L,
    X,
    embedded,
    generator_values,
    polynomial_value,
    propagation,
    value,
)


@pytest.fixture(autouse=True)
def _precision():
    with mp.workdps(40):
        yield


def sums_of(lengths):
    found = propagation("general", lengths)
    return found, ModalSums(found.kernel_ring, embedded(found))


def summed(sums, polynomial, values):
    """Return a polynomial from the roots that mpmath finds."""
    made = sums.of(polynomial)
    modes = []
    for mode in sums.modes:
        c = [value(k, values) for k in mode.dispersion.characteristic]
        roots = mp.polyroots([1, *reversed(c)], maxsteps=200, extraprec=200)
        modes.append(mode_values(roots, value(mode.length, values)))
    coefficients = [polynomial_value(c, sums.ring.names, values) for c in made.coefficients]
    frames = [(f.slots, f.terms, f.keys) for f in made.frames]
    return mp.fsum(a * mp.exp(e) for a, e in modal_amplitudes(modes, coefficients, frames))


def kernels(found, length):
    return [found.kernel_ring.generator(f"h{k}[0,{length}]") for k in range(4)]


def wronskian(h):
    """Return ``h h'' - h'^2``, as in the determinant of a beam clamped at both ends."""
    return h[0] * h[2] - h[1] * h[1]


def test_a_sum_has_the_value_of_its_polynomial():
    found, sums = sums_of((L, X))
    h, g = kernels(found, 0), kernels(found, 1)
    s, p = (found.kernel_ring.generator(n) for n in ("s", "p"))
    polynomial = s * h[0] * h[3] ** 2 - 3 * p * g[1] * h[2] ** 2 + 7 * g[0] * g[2] * h[1] - p * h[2] + s + 5
    values = generator_values(found)
    expected = polynomial_value(polynomial, found.kernel_ring.names, values)
    assert mp.almosteq(summed(sums, polynomial, values), expected, 1e-25)


def test_in_a_determinant_only_products_of_different_roots_stay():
    found, sums = sums_of((L,))
    (frame,) = sums.of(wronskian(kernels(found, 0))).frames
    assert frame.keys == tuple(((a, b), 1) for a in range(4) for b in range(a + 1, 4))


def test_what_cancels_by_the_characteristic_equation_alone_is_left_out():
    # h''' h' - h''^2 with h'''' replaced is a minor of the transfer matrix as well: h' h'''' - h'' h'''.
    found, sums = sums_of((L,))
    h = kernels(found, 0)
    c = [k.expand() for k in sums.modes[0].dispersion.characteristic]
    fourth = -sum((a * b for a, b in zip(c, h, strict=True)), found.kernel_ring.constant(0))
    (frame,) = sums.of(h[1] * fourth - h[2] * h[3]).frames
    assert {key for key, _ in frame.keys} == {(a, b) for a in range(4) for b in range(a + 1, 4)}


def test_a_square_keeps_what_grows_fastest():
    found, sums = sums_of((L,))
    (frame,) = sums.of(kernels(found, 0)[0] ** 2).frames
    assert len(frame.keys) == 10
    assert dict(frame.keys)[0, 0] == 2


def test_a_minor_of_two_lengths_has_no_root_at_both():
    # h(l) h'(x) - h'(l) h(x): the same exponential at l and at x cancels.
    found, sums = sums_of((L, X))
    h, g = kernels(found, 0), kernels(found, 1)
    (frame,) = sums.of(h[0] * g[1] - h[1] * g[0]).frames
    assert all(a != b for (a, b), _ in frame.keys)
    assert len(frame.keys) == 12


def test_a_wronskian_is_right_where_its_terms_are_far_larger():
    found, sums = sums_of((L,))
    long = POINT | {"l": mp.mpf(300)}
    polynomial = wronskian(kernels(found, 0))
    with mp.workdps(400):
        roots = mp.polyroots(
            [1, *reversed([value(k, long) for k in sums.modes[0].dispersion.characteristic])]
        )
        slopes = [mp.fprod(x - y for y in roots if y is not x) for x in roots]
        h = [
            mp.fsum(x**k * mp.exp(x * 300) / d for x, d in zip(roots, slopes, strict=True)) for k in range(3)
        ]
        expected = h[0] * h[2] - h[1] ** 2
    assert abs(h[1] ** 2 / expected) > 1e60
    assert mp.almosteq(summed(sums, polynomial, long), expected, 1e-25)


def test_a_sum_is_made_once_and_told_from_a_polynomial_without_functions():
    found, sums = sums_of((L,))
    polynomial = wronskian(kernels(found, 0))
    assert sums.of(polynomial) is sums.of(polynomial)
    found, sums = sums_of((L,))
    assert sums.has_functions(kernels(found, 0)[2])
    assert not sums.has_functions(found.kernel_ring.generator("s"))


def test_too_many_products_are_refused(monkeypatch):
    monkeypatch.setattr(module, "KEY_LIMIT", 9)
    found, sums = sums_of((L,))
    with pytest.raises(BudgetError, match="more than 9 products of exponentials"):
        sums.of(kernels(found, 0)[0] ** 2)


def test_roots_that_are_apart_have_values_in_wide_balls():
    wide = acb_series([acb(arb(0, 0.45), arb(0, 0.45)), 1], 2)
    _, ((_, first, *_), *_) = mode_values([wide, acb(1), acb(0, 1), acb(-1)], acb(1))
    assert first[0].contains(acb(0.1) / ((acb(0.1) ** 2 - 1) * (acb(0.1) - acb(0, 1))))
