"""Passivity of a machine with a sampled controller (Colgate and Schenkel 1997)."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.contact.hybrid import find_hybrid
from symflex.contact.over import passive_over
from symflex.errors import ModelError
from symflex.options import PassivityOptions

HANDLE = """symflex = 1
[parameters]
m = "0.3 kg"
b = "0.7 N*s/m"
K = "1 kN/m"
B = {{ value = "0.3 N*s/m", assume = "real" }}
T = "1 ms"
[blocks]
wall = "{wall}"
[sampled]
period = "T"
delay = "{delay}"
[elements]
handle = {{ type = "mass", at = "x", m = "m" }}
rail   = {{ type = "damper", between = ["x", "ground"], b = "b" }}
motor  = {{ type = "force_source", at = "x", f = "{force}" }}
{more}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
"""
PD = "K + B*(z - 1)/(T*z)"


def found(wall=PD, delay="0", force="-wall*x", more=""):
    return find_hybrid(pipeline.loads(HANDLE.format(wall=wall, delay=delay, force=force, more=more)), "x")


def needed(h, period=1e-3):
    """Return the largest damping on a grid of frequencies, from the condition as it is printed."""
    omega_t = np.linspace(1e-3, np.pi, 200_000)
    z = np.exp(1j * omega_t)
    return (period / 2 * ((1 - 1 / z) * h(z)).real / (1 - np.cos(omega_t))).max()


def test_the_condition_of_a_wall_comes_out_in_symbols():
    assert found().condition == "b > K*T/2 + |B|"


def test_the_verdict_changes_at_the_condition():
    assert found().passive is False  # 0.7 < 0.5 + 0.3
    assert found(wall="K/2 + B*(z - 1)/(T*z)").passive is True  # 0.7 > 0.25 + 0.3
    assert found(wall="0.8*K + B*(z - 1)/(T*z)").passive is True  # 0.7 = 0.4 + 0.3: nothing comes out


def test_a_sample_of_delay_needs_more_damping():
    late = found(delay="T")
    expected = needed(lambda z: (1000 + 0.3 * (z - 1) / (1e-3 * z)) / z)
    assert float(late.needed) == pytest.approx(expected, rel=1e-7)
    assert late.condition == ""


def test_a_filtered_controller_agrees_with_a_grid():
    filtered = found(wall="K*(z - 0.3)/(z^2 - 0.5*z + 0.2)")
    expected = needed(lambda z: 1000 * (z - 0.3) / (z**2 - 0.5 * z + 0.2))
    assert float(filtered.needed) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize(("sign", "needed_for_damping"), [("+", 0.3 / 5), ("-", 0.3)])
def test_a_filter_of_the_velocity_leaves_both_ends_of_the_cosine_to_decide(sign, needed_for_damping):
    # Brown and Colgate (1995), appendix A: a backward difference behind a low pass tau of the same mapping,
    # B (z - 1)/((T + tau) z - tau). At z = -1 that needs K T/2 + B T/(T + 2 tau), at z = 1 K T/2 - B.
    filtered = found(wall=f"K {sign} B*(z - 1)/(T*(3*z - 2))")  # tau = 2 T
    assert float(filtered.needed.mid()) == pytest.approx(0.5 + needed_for_damping, rel=1e-12)


@pytest.mark.parametrize("wall", ["-K", "K/(z - 2)", "-K/(z - 1)", "K*(z - 1.2)/(z + 1.5)"])
def test_a_machine_that_is_unstable_alone_is_active(wall):
    unstable = found(wall=wall)
    assert unstable.passive is False
    assert "the machine alone is not stable" in unstable.faults[0]


def test_a_hidden_mode_that_grows_is_named():
    more = """n = { type = "mass", at = "y", m = "1 kg" }
g = { type = "spring", between = ["y", "ground"], k = "-5 N/m" }"""
    unstable = found(wall="K/2", more=more)
    assert unstable.passive is False
    assert "s = 2.23606798 rad/s" in unstable.faults[1]  # sqrt(5)
    assert [p.side for p in unstable.alone.hidden] == [-1, 1]


def test_a_negative_delay_is_refused():
    with pytest.raises(ModelError, match="SF260"):
        found(delay="-T")


def test_no_damper_is_enough_for_an_integrator():
    integrating = found(wall="K*T*z/(z - 1)")
    assert (integrating.needed, integrating.passive) == (None, False)
    assert "no damper is large enough" in str(integrating)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"delay": "0.4*T"}, "its output is late by a part of a sample"),
        ({"more": 'spring = { type = "spring", between = ["x", "ground"], k = "K" }'}, "it is no mass with"),
        ({"force": "-wall*s*x"}, "the controller does not act and see at the port alone"),
    ],
)
def test_another_machine_is_refused(given, reason):
    with pytest.raises(ModelError) as caught:
        found(**given)
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF262"
    assert reason in problem.message


def test_a_mass_behind_a_damper_is_another_machine():
    # Z = b + b m s/(m s + b): of first order above and below.
    text = HANDLE.replace('at = "x", m', 'at = "y", m')
    link = 'link = { type = "damper", between = ["x", "y"], b = "b" }'
    model = pipeline.loads(text.format(wall=PD, delay="0", force="-wall*x", more=link))
    with pytest.raises(ModelError, match="it is no mass with"):
        find_hybrid(model, "x")


@pytest.mark.parametrize(
    ("name", "limits", "ends"),
    [
        ("K", (-500, 3000), (0, 800)),
        ("B", (-1, 1), (-0.2, 0.2)),
        ("T", (0, 0.01), (0, 8e-4)),
        ("b", (0, 2), (0.8, 2)),
    ],
)
def test_passive_values_are_those_of_the_condition(name, limits, ends):
    # b > K T/2 + |B| at K = 1000, B = 0.3, b = 0.7, T = 1 ms, and K > 0, or the handle drifts away.
    text = HANDLE.format(wall=PD, delay="0", force="-wall*x", more="")
    text = text.replace('K = "1 kN/m"', 'K = { value = "1 kN/m", assume = "real" }')
    values = passive_over(pipeline.loads(text), PassivityOptions(("x",), (name,), limits))
    assert values.certified
    (interval,) = values.passive
    assert [float(interval.low.mid()), float(interval.high.mid())] == pytest.approx(ends, abs=1e-12)


def test_the_stiffest_wall_that_is_passive_with_a_sample_of_delay():
    text = HANDLE.format(wall=PD, delay="T", force="-wall*x", more="")
    values = passive_over(pipeline.loads(text), PassivityOptions(("x",), ("K",), (0, 1000)))
    (interval,) = values.passive
    stiffest = float(interval.high.mid())
    assert needed(lambda z: (stiffest + 0.3 * (z - 1) / (1e-3 * z)) / z) == pytest.approx(0.7, rel=1e-6)


ARM = """symflex = 1
parameters = { K = "20 N*m/rad", T = "2 ms", b = "0.3 N*m*s/rad", EI = "10 N*m^2", rhoA = "1 kg/m", l = 1 }
[blocks]
C = "K*(1 + 5*(z - 1)/z)"
[sampled]
period = "T"
[elements]
hub = { type = "inertia", at = "h.theta", J = "0.05 kg*m^2" }
pin = { type = "pin", at = "h" }
arm = { type = "beam", between = ["h", "tip"], EI = "EI", rhoA = "rhoA", l = "l" }
bearing = { type = "rotary_damper", between = ["h.theta", "ground"], b = "b" }
servo = { type = "torque_source", at = "h.theta", tau = "-C*h.theta" }
[inputs]
F = { force = "tip" }
[outputs]
X = "tip"
"""


def test_a_beam_on_a_hub_with_a_sampled_controller_is_passive_at_its_tip_if_the_hub_is():
    # K T/2 + |5 K T| = 0.02 + 0.2 of the hub alone; the beam supplies no energy.
    arm = find_hybrid(pipeline.loads(ARM), "tip")
    assert (arm.passive, arm.port) == (True, "tip")
    assert float(arm.needed.mid()) == pytest.approx(0.22, rel=1e-12)
    assert "all that acts at h.theta" in arm.passages()[0].lines[1]
    with pytest.raises(ModelError) as refused:
        find_hybrid(pipeline.loads(ARM.replace("0.3 N*m", "0.21 N*m")), "tip")
    assert refused.value.diagnostics[0].code == "SF262"
