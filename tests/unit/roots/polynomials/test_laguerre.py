"""Guesses by Laguerre's method, and each of its parts, for polynomials made of their roots."""

import pytest
from flint import acb_poly, arb

from symflex.balls import precision
from symflex.roots.polynomials.discs import propose_by_laguerre


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
