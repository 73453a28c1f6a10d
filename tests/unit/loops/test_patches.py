"""Polynomials in place of a function, with what they lack."""

from flint import acb, arb

from symflex.balls import precision
from symflex.loops.patches import BITS, patch


def blurred(s, p):
    """Return 3 + s p in a ball that is wide for p with a positive imaginary part alone."""
    return 3 + s * p + acb(arb(0, 1e-3 if p.imag > 0 else 0))


def test_what_values_are_blurred_by_anywhere_counts():
    assert patch(lambda s, p: 3 + s * p, 1j, 0.1, 2.0, 0.1) is not None
    assert patch(blurred, 1j, 0.1, 2.0, 0.1) is None


def test_a_function_vanishes_nowhere_where_its_patch_does_not():
    # s p - 2 j is 0 at s = j, p = 2; for |s - j| and |p - 2.5| up to 0.05 it is 0.5 - 0.05 (2.5 + 1) or more.
    whole = patch(lambda s, p: s * p - acb(0, 2), 1j, 0.2, 2.25, 0.5)
    with precision(BITS):
        assert whole.on(1j, 0.05, 2.0, 0.05)[0].may_vanish
        assert not whole.on(1j, 0.05, 2.5, 0.05)[0].may_vanish
        assert whole.on(1j, 0.1, 2.25, 0.1)[0].may_vanish  # abs(s) p reaches from 1.935 to 2.585
