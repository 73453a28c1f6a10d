"""Zeros of networks that are not multiplied out, against the poles of models with one line more."""

import numpy as np

import symflex

MEMBER = 'type = "frame", E = "70 GPa", I = "8e-10 m^4", A = "1.2 cm^2", rho = "2700 kg/m^3"'
FRAME = f"""
symflex = 1
parameters = {{ K = "900 N/m", T_d = "8 ms", T_t = "1 ms" }}
[elements]
post = {{ {MEMBER}, between = ["ground", "k"], l = "0.4 m", angle = "35 deg", eta = "10 us" }}
arm  = {{ {MEMBER}, between = ["k", "t"], l = "0.3 m", angle = "100 deg", eta = "10 us" }}
tip  = {{ type = "rigid_body", at = "t", m = "0.25 kg" }}
push = {{ type = "force_source", at = "t.x", f = "u + F" }}
[signals]
u = "K*(1 + T_d*s)*exp(-s*T_t)*(r - t.x)"
[inputs]
F = {{ unit = "N" }}
r = {{ unit = "m" }}
M = {{ torque = "k.theta" }}
[outputs]
V = "s*t.x"
"""


def explained(pair):
    bound = symflex.loads(FRAME).nested(*pair).bind()
    return bound.explain_zeros(modes=2), [complex(z) for z in bound.zeros(2) if abs(complex(z)) > 0]


def test_zeros_of_a_driven_node_are_the_poles_of_the_frame_held_there():
    told, zeros = explained(("V", "F"))
    # Holding the node leaves the loop's own signal, which the numerator has as a delay and a zero at most.
    assert (told.kind, told.status, told.order, told.held) == ("colocated", "almost surely", 1, "t.x = 0")
    held = FRAME.replace("[signals]", told.spec + "\n[signals]").replace('"s*t.x"', '"k.x"')
    poles = [complex(p) for p in symflex.loads(held).nested("V", "M").bind().poles(2)]
    for zero in zeros:
        assert min(abs(np.array(poles) / zero - 1)) < 1e-12


def test_a_reference_reaches_the_node_through_its_controller_alone():
    told, zeros = explained(("V", "r"))
    assert (told.kind, told.status, told.is_delayed) == ("partly", "almost surely", True)
    assert [part.has_input for part in told.parts] == [False]
    assert min(abs(np.array(zeros) + 125)) < 1e-9  # 1 + T_d s


def test_what_acts_elsewhere_has_zeros_of_no_held_frame():
    told, _ = explained(("V", "M"))
    assert (told.kind, told.spec) == ("noncolocated", "")
