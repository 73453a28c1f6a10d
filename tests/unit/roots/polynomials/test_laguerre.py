"""Guesses by Laguerre's method, and each of its parts, for polynomials made of their roots."""

import pytest
from flint import acb, acb_poly, arb

from symflex.balls import precision
from symflex.roots.polynomials.discs import _polygon_moduli, propose_by_laguerre


@pytest.fixture(autouse=True)
def working_precision():
    with precision(200):
        yield


def made_of(*roots, leading=1):
    """Return the real polynomial with these roots, and the conjugates of those that are not real."""
    product = acb_poly([leading])
    for root in roots:
        if isinstance(root, complex):
            product *= acb_poly([arb(root.real) ** 2 + arb(root.imag) ** 2, -2 * arb(root.real), 1])
        else:
            product *= acb_poly([-arb(root), 1])
    return product


def numbers(guesses):
    return sorted((complex(g) for g in guesses), key=lambda z: (abs(z), z.real))


def test_every_root_of_the_upper_half_plane_is_guessed_once():
    for leading in [1, -3, 1e-30]:
        for roots in [
            (5.0,),
            (-1 + 2j,),
            # z^4 + 4: from 0 no slope leads on.
            (1 + 1j, -1 + 1j),
            (1.0, -2.0, 3 + 4j),
            (1e-6, 1.0, 1e6, -1e3 + 1e-2j),
            (-0.01 + 1j, -0.02 + 2j, -0.03 + 3j, -0.04 + 4j, -7.0),
            (1j, 2j, 3j),
            (0.0, 0.0, 2j),
        ]:
            found = numbers(propose_by_laguerre(made_of(*roots, leading=leading)))
            wanted = numbers(roots)
            assert len(found) == len(wanted), (leading, roots)
            for one, other in zip(found, wanted, strict=True):
                assert abs(one - other) <= 1e-6 if other == 0 else abs(one - other) <= 1e-11 * abs(other), (
                    leading
                )
            assert [z.imag == 0 for z in found] == [z.imag == 0 for z in wanted], (leading, roots)


def test_roots_far_from_1_are_guessed_as_well():
    for scale in [1e-150, 1e150, 1e250]:
        found = numbers(propose_by_laguerre(made_of(scale * (1 + 2j), 3 * scale)))
        assert [z / scale for z in found] == pytest.approx([1 + 2j, 3], rel=1e-11), scale


def test_of_a_double_root_both_are_guessed():
    found = numbers(propose_by_laguerre(made_of(2.0, 2.0, -5.0)))
    assert sum(1 if z.imag == 0 else 2 for z in found) == 3
    assert [z.real for z in found] == pytest.approx([2.0] * (len(found) - 1) + [-5.0], rel=1e-6)


def test_a_polynomial_lost_in_rounding_altogether_has_still_as_many_guesses_or_none():
    # z^2 + (0 +- 1): whatever it is, it is said as none or as two.
    found = propose_by_laguerre(acb_poly([acb(arb(0, 1)), 0, 1]))
    assert found is None or sum(1 if g.imag == 0 else 2 for g in found) == 2


def test_the_newton_polygon_tells_the_moduli_within_doubles():
    # Sides of the hull of each (Bini 1996): all powers; from 0 to 1 to 2 to 3; with 1 below, and on the hull
    for coefficients, moduli in (
        ([16, 0, 0, 0, 1], [2, 2, 2, 2]),
        ([1e-3, 1, 1, 1e-4], [1e-3, 1, 1e4]),
        ([4, 1e-3, 1], [2, 2]),
        ([4, 2, 1], [2, 2]),
        ([0, 0, -5, 1], [5, 5, 5]),
        ([1, 100, 1, 1, 1e-6], [0.01, 10, 10, 1e6]),
    ):
        found = _polygon_moduli(acb_poly(coefficients), len(coefficients) - 1)
        assert found == pytest.approx(moduli), coefficients
