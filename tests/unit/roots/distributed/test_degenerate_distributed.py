"""Distributed systems whose numbers make kernels constant, zero or undefined."""

from __future__ import annotations

import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.response import respond
from symflex.errors import BudgetError, ModelError
from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import BEAM, PARAMETERS, bound

WITHOUT_DELAY = """
symflex = 1
[parameters]
T_s = { value = "0 s", assume = "nonnegative" }
T_c = "2 s"
[blocks]
D = { type = "delay", T = "T_s" }
[inputs]
u = {}
[outputs]
y = "D*u/(1 + T_c*s + D)"
"""

WITHOUT_LENGTH = f"""{PARAMETERS}
x_g = "0.5 m"
[elements]
arm = {{ type = "beam", between = ["p", "q"], {BEAM}, l = "l - x_g" }}
[inputs]
F = {{ force = "q" }}
[outputs]
Y = "q"
"""

# E I w'''' + k w = 0, free: nothing depends on s.
STATIC = """
symflex = 1
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + k*w = 0"
conditions = ["w''(0) = 0", "EI*w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
[parameters]
EI = "100 N*m^2"
k  = "5 kN/m^2"
l  = "2 m"
[inputs]
F = { unit = "N" }
[outputs]
Y = "w(0)"
"""

# exp(-s T)/cosh(s): poles at j pi/2 (2 n - 1); only the numerator is lopsided in s.
DELAYED_ROD = """
symflex = 1
[parameters]
c = "1 m/s"
l = "1 m"
T = "1 ms"
[blocks]
D = { type = "delay", T = "T" }
[fields.u]
domain = ["0", "l"]
equation = "c^2*u'' = s^2*u"
conditions = ["u(0) = D*F", "u'(l) = 0"]
[inputs]
F = {}
[outputs]
X = "u(l)"
"""


def test_a_delay_of_no_time_leaves_a_rational_function():
    # 1/(2 + 2 s)
    found = locate(bound(WITHOUT_DELAY))
    assert [float(root.re.mid()) for root in found.poles] == [-1]


def test_the_response_without_a_delay_is_that_of_the_rational_function():
    assert respond(bound(WITHOUT_DELAY), [3.0]).values[0] == pytest.approx(1 / (2 + 6j))


def test_a_beam_without_length_is_refused():
    (tf,) = pipeline.derive_all(pipeline.loads(WITHOUT_LENGTH))
    with pytest.raises(ModelError, match="SF231"):
        locate(pipeline.bind(tf, {"x_g": 1}))


def test_what_does_not_depend_on_s_has_no_poles():
    assert locate(bound(STATIC)).poles == ()


def test_what_does_not_depend_on_s_has_a_flat_response():
    magnitude = respond(bound(STATIC), [1.0, 1000.0]).magnitude
    assert magnitude[0] == pytest.approx(magnitude[1])


def test_poles_on_the_axis_have_no_damping_beside_a_delayed_input():
    assert [root.damping_ratio() for root in locate(bound(DELAYED_ROD), Modes(2)).poles] == [0.0] * 4


def test_the_phase_passes_poles_beside_a_delayed_input():
    # cosh(j omega) = cos(omega) changes its sign at pi/2 and 3 pi/2; the delay lags by omega T.
    phase = respond(bound(DELAYED_ROD), [1.0, 3.0, 6.0]).phase
    assert phase == pytest.approx([-0.001, -np.pi - 0.003, -2 * np.pi - 0.006])


def test_the_phase_survives_a_frequency_as_near_to_a_pole_as_doubles_allow():
    phase = respond(bound(DELAYED_ROD), [np.pi / 2, 3.0]).phase
    assert phase[1] == pytest.approx(-np.pi - 0.003)


def test_frequencies_beyond_doubles_are_a_typed_error():
    # The first is about sqrt(E I/(rho A)) = 1e168 rad/s; squares of it are beyond doubles.
    text = """
symflex = 1
inputs.F = { force = "q" }
outputs.Y = "q"
[elements]
arm  = { type = "beam", between = ["ground", "q"], E = 9e3, I = 8e62, A = 7e-270, rho = 0.26, l = 1 }
load = { type = "mass", at = "q", m = 165 }
"""
    with pytest.raises(BudgetError) as failed:
        locate(pipeline.derive_bound(pipeline.loads(text), [("Y", "F")])[0], Modes(3))
    assert failed.value.diagnostics[0].code == "SF505"


def test_frequencies_whose_product_is_no_double_are_found():
    # Of a free rod: n pi/l sqrt(E/rho).
    text = """
symflex = 1
elements.bar = { type = "rod", between = ["p", "q"], E = 7e-188, A = 3, rho = 7, l = 1e100 }
inputs.F = { force = "p" }
outputs.Y = "q"
"""
    found = locate(pipeline.derive_bound(pipeline.loads(text), [("Y", "F")])[0], Modes(2))
    expected = [0, *(n * np.pi / 1e100 * 1e-94 for n in (1, 2))]
    upper = sorted(float(p.im.mid()) for p in found.poles if p.im >= 0)
    assert upper[: len(expected)] == pytest.approx(expected, rel=1e-12, abs=0)
