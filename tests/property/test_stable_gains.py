"""Random loops: the counts are those of the roots numpy finds, for gains drawn at random."""

import cmath

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symflex
from tests.independent.nyquist import poles_right_of_axis

COEFFICIENTS = st.integers(-6, 6)
CLEAR = 1e-5
"""Poles closer to the axis than this are not told by numpy."""


def polynomial(coefficients):
    """Return a polynomial in s in the grammar, ascending coefficients."""
    return " + ".join(f"({c})*s^{i}" if i else f"({c})" for i, c in enumerate(coefficients))


@pytest.mark.slow
@given(
    a=st.lists(COEFFICIENTS, min_size=2, max_size=6).filter(lambda c: c[-1] != 0),
    b=st.lists(COEFFICIENTS, min_size=1, max_size=4).filter(any),
    gains=st.lists(st.floats(-20, 20), min_size=4, max_size=4),
)
@settings(max_examples=40)
def test_counts_agree_with_the_roots_of_the_polynomial(a, b, gains):
    b = b[: len(a)]
    if not any(b):
        return
    model = symflex.Model(
        parameters={"K": {"value": 1, "assume": "real"}},
        signals={"y": f"K*({polynomial(b)})/({polynomial(a)})*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    found = model.stability("K")
    assert found.certified
    for gain in gains:
        padded = [*b, *([0] * (len(a) - len(b)))]
        closed = [x + gain * y for x, y in zip(a, padded, strict=True)]
        if abs(closed[-1]) < CLEAR:
            continue
        roots = np.roots(closed[::-1])
        # A common factor of both parts cancels where the loop is written as one fraction.
        interval = next(
            (
                i
                for i in found.proved.intervals
                if (i.low is None or i.low < gain) and (i.high is None or i.high > gain)
            ),
            None,
        )
        if interval is None or any(abs(root.real) < CLEAR for root in roots):
            continue
        assert interval.poles.right == sum(root.real > 0 for root in roots)
        assert interval.poles.axis == 0


@pytest.mark.slow
@given(
    a=st.lists(COEFFICIENTS, min_size=2, max_size=4).filter(lambda c: c[-1] != 0),
    b=st.lists(COEFFICIENTS, min_size=1, max_size=2).filter(any),
    T=st.sampled_from([0.5, 1, 2.25]),
    gain=st.floats(-5, 5),
)
@settings(max_examples=15)
def test_counts_beside_a_delay_agree_with_turns(a, b, T, gain):
    b = b[: len(a) - 1]
    if not any(b):
        return
    model = symflex.Model(
        parameters={"K": {"value": 1, "assume": "real"}, "T": {"value": f"{T} s"}},
        blocks={"D": {"type": "delay", "T": "T"}},
        signals={"y": f"K*D*({polynomial(b)})/({polynomial(a)})*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    found = model.stability("K", (-5, 5))

    def chi(s):
        above = sum(c * s**i for i, c in enumerate(b))
        return sum(c * s**i for i, c in enumerate(a)) + gain * cmath.exp(-s * T) * above

    near = [float(boundary.gain) for boundary in found.boundaries]
    interval = next((i for i in found.proved.intervals if i.low < gain < i.high), None)
    if interval is None or interval.poles.axis or any(abs(gain - x) < 1e-3 for x in (*near, 0)):
        return
    assert interval.poles.right == poles_right_of_axis(chi, 1.2 * found.proved.radius)
