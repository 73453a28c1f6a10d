"""Loops around fitted models, which are judged up to where the data end."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import polynomial

import symflex
from tests.unit.refusals import refusal

# 1 + K (1 + 0.2 s)(1 - s/9)^2/((1 + 0.02 s + s^2)(1 + s/2)(1 - s/4000)), whose real pole is not measured.
NUM = polynomial.polymul([1, 0.2], polynomial.polymul([1, -1 / 9], [1, -1 / 9]))
DEN = polynomial.polymul([1, 0.02, 1], polynomial.polymul([1, 0.5], [1, -1 / 4000]))
PLANT = "(1 + 0.2*s)*(1 - s/9)^2/((1 + 0.02*s + s^2)*(1 + s/2)*(1 - s/4000))"
END = 20.0  # [rad/s]


def closed(tail=""):
    return symflex.loads(f"""
symflex = 1
[parameters]
K = 0.01
T = "1 ms"
[blocks]
D = {{ type = "delay", T = "T" }}
[signals]
y = "K*{PLANT}*(r - y){tail}"
[inputs]
r = {{}}
[outputs]
Y = "y"
[analysis]
data_end = "{END} rad/s"
""")


def passed(gain):
    """Nyquist's count for a plant that is the same up to the end, and nothing beyond."""
    s = 1j * np.linspace(0, END, 200_001)
    curve = 1 + gain * polynomial.polyval(s, NUM) / polynomial.polyval(s, DEN)
    return round(-np.sum(np.angle(curve[1:] / curve[:-1])) / np.pi + np.angle(curve[-1]) / np.pi)


@pytest.mark.parametrize("limits", [None, (-30, 30)])
def test_unstable_poles_are_those_that_nyquist_counts_below_the_end_of_the_data(limits):
    found = closed().stability("K", limits)
    assert found.certified
    assert found.is_stable
    edges = [float(b.gain) for b in found.boundaries]
    assert edges
    for i, edge in enumerate(edges):
        counts = [interval.poles.right for interval in found.proved.intervals[i : i + 2]]
        assert counts == [passed(edge - 1e-3 * abs(edge)), passed(edge + 1e-3 * abs(edge))]
    data = found.to_json_dict()["data_end"]
    assert data["right_half_plane_poles_beyond_hz"] == [pytest.approx(4000 / (2 * np.pi), rel=1e-2)]
    s = 1j * END
    ratio = abs(polynomial.polyval(s, DEN) / polynomial.polyval(s, NUM))
    assert data["gain_with_loop_gain_one"] == pytest.approx(ratio)
    assert float(found.proved.limits[1]) == pytest.approx(ratio if limits is None else limits[1])
    assert found.counted_up_to_hz == pytest.approx(END / (2 * np.pi))


def test_a_delay_in_the_loop_changes_little_of_that():
    found = closed("*D").stability("K", (0, 1), T="1 us")
    assert (found.certified, found.is_stable) == (True, True)
    assert float(found.boundaries[0].gain) == pytest.approx(
        float(closed().stability("K").boundaries[0].gain), rel=1e-4
    )


def test_a_model_block_carries_the_end_of_its_data(tmp_path):
    inner = closed().to_toml().replace('"K*', '"').replace("(r - y)", "r")
    (tmp_path / "plant.toml").write_text(inner)
    (tmp_path / "loop.toml").write_text("""
symflex = 1
parameters.K = 0.01
blocks.P = { type = "model", spec = "plant.toml", tf = "Y/r" }
signals.y = "K*P*(w - y)"
inputs.w = {}
outputs.Y = "y"
""")
    found = symflex.load(tmp_path / "loop.toml").stability("K")
    assert found.is_stable
    assert found.counted_up_to_hz == pytest.approx(END / (2 * np.pi))


def test_data_end_above_0_hz():
    assert "SF227" in refusal(lambda: symflex.loads(closed().to_toml().replace(f"{END} rad/s", "0 Hz")))
