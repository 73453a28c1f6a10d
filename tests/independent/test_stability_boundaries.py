"""Stability boundaries against Nyquist counts on functions written down by hand."""

from __future__ import annotations

import cmath
import math
from pathlib import Path

import numpy as np
import pytest

import symflex
from tests.independent.nyquist import axial_transfer, bending_transfer, poles_right_of_axis

CONTROL = Path(__file__).parents[2] / "derivations" / "eppinger1988" / "loops"
NEAR = 1e-4


def loop(expression: str, K: float = 1, T: str = "0.5 s") -> symflex.Model:
    """Return a unity feedback loop around an expression."""
    return symflex.Model(
        parameters={"K": {"value": K}, "T": {"value": T}},
        blocks={"D": {"type": "delay", "T": "T"}},
        signals={"y": f"{expression}*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )


def two_mass(s, K):
    m_1, m_2, k, b_t, b, k_c = 60, 20, 71653, 41, 400, 20e3
    link = k + b_t * s
    return (m_1 * s**2 + b * s + link) * (m_2 * s**2 + link + k_c) - link**2 + K * k_c * link


def base_flexure(s, K):
    m, m_base, k_base, b_base, b, k_c = 80, 200, 955377, 553, 400, 20e3
    matrix = np.array(
        [
            [m * s**2 + b * s + k_c + K * k_c, -b * s],
            [-b * s - K * k_c, m_base * s**2 + (b + b_base) * s + k_base],
        ]
    )
    return complex(np.linalg.det(matrix))


def lumped_bending_beam(s, K):
    m_1, m_2, J, c, h, EI, length, b, k_c = 10, 2, 0.00375, 0.075, 0.15, 700, 0.5, 60, 2e3
    # y_1, then y and theta at the joint; the beam is without mass and its left end does not turn.
    a = 12 * EI / length**3
    d = 6 * EI / length**2
    e = 4 * EI / length
    stiff = np.array([[a, -a, d], [-a, a, -d], [d, -d, e]], complex)
    mass = np.array([[m_1, 0, 0], [0, m_2, m_2 * c], [0, m_2 * c, J + m_2 * c * c]])
    tip = np.array([0, 1, h])
    matrix = stiff + s**2 * mass + np.diag([b * s, 0, 0]) + k_c * np.outer(tip, tip)
    matrix[0] += K * k_c * tip
    return complex(np.linalg.det(matrix))


def beam(s, K):
    stiffness, mass, length, eta, b, k_c = 200e9 * 4000e-12, 7850 * 480e-6, 1.086, 1e-4, 20, 2e3
    grown = bending_transfer(s, EI=stiffness * (1 + eta * s), mass=mass, length=length)
    scale = 1 / np.abs(grown).max()
    t = grown * scale
    # Unknowns: w(0), M(0), V(0), w(l); w'(0) = 0.
    rows = [
        [t[0, 0], t[0, 2], t[0, 3], -scale],
        [t[2, 0], t[2, 2], t[2, 3], 0],
        [t[3, 0], t[3, 2], t[3, 3], -k_c * scale],
        [b * s, 0, 1, K * k_c],
    ]
    weights = np.array([1, stiffness, stiffness, 1])
    return complex(np.linalg.det(np.array(rows, complex) * weights)) / scale


def rod(s, K):
    # A rod of steel with a mass at its far end; its velocity there is fed back to the force at the near one.
    stiffness, mass, length, tip, eta = 70e9 * 1e-4, 2700 * 1e-4, 2.0, 3.0, 2e-6
    t = axial_transfer(s, EA=stiffness * (1 + eta * s), mass=mass, length=length)
    # N(0) = -F = K s u(l); N(l) = -tip s^2 u(l); divided by the free motion of the near end.
    return complex(
        np.linalg.det(np.array([[t[0, 0], t[0, 1] * K * s - 1], [t[1, 0], t[1, 1] * K * s + tip * s**2]]))
    )


ROD = """
symflex = 1
[parameters]
K = { value = "50 N*s/m" }
E = "70 GPa"
A = "1 cm^2"
rho = "2700 kg/m^3"
l = "2 m"
eta = "2e-6 s"
m = "3 kg"
[signals]
F = "K*(v - s*tip)"
[elements]
drive = { type = "force_source", at = "near", f = "F" }
bar = { type = "rod", between = ["near", "tip"], E = "E", A = "A", rho = "rho", l = "l", eta = "eta" }
load = { type = "mass", at = "tip", m = "m" }
[inputs]
v = {}
[outputs]
V = "s*tip"
"""

LOOPS = [
    pytest.param(
        lambda: loop("K*(s + 2)^2/s^3"), lambda s, K: s**3 + K * (s + 2) ** 2, 50, id="conditionally-stable"
    ),
    pytest.param(lambda: symflex.load(CONTROL / "two_mass_force.toml"), two_mass, 1e3, id="two-mass"),
    pytest.param(
        lambda: symflex.load(CONTROL / "base_flexure_force.toml"), base_flexure, 1e3, id="base-flexure"
    ),
    pytest.param(
        lambda: symflex.load(CONTROL / "lumped_bending_beam_force.toml"),
        lumped_bending_beam,
        1e4,
        id="lumped-bending-beam",
    ),
    pytest.param(
        lambda: loop("K*D/(s - 1)"), lambda s, K: s - 1 + K * cmath.exp(-s / 2), 150, id="delay-unstable"
    ),
    pytest.param(
        lambda: loop("K*D/(s^2 + 0.2*s + 1)", T="2 s"),
        lambda s, K: s**2 + 0.2 * s + 1 + K * cmath.exp(-2 * s),
        60,
        id="delay-resonance",
    ),
    pytest.param(
        lambda: symflex.load(CONTROL / "sliding_free_beam_force.toml"),
        beam,
        2500,
        id="beam-force",
        marks=pytest.mark.slow,
    ),
    pytest.param(lambda: symflex.loads(ROD), rod, 4e4, id="rod-tip-velocity", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("model", "chi", "radius"), LOOPS)
@pytest.mark.slow
def test_counts_on_both_sides_of_every_boundary(model, chi, radius):
    found = model().stability("K")
    assert found.certified
    assert found.boundaries
    intervals = found.proved.intervals
    for i, boundary in enumerate(found.boundaries[:3]):
        K = float(boundary.gain)
        below = poles_right_of_axis(lambda s, K=K: chi(s, K * (1 - NEAR)), radius)
        above = poles_right_of_axis(lambda s, K=K: chi(s, K * (1 + NEAR)), radius)
        assert (below, above) == (intervals[i].poles.right, intervals[i + 1].poles.right)
        assert boundary.entering == above - below
        # The pole that crosses is where the program finds it.
        omega = 2 * math.pi * boundary.frequencies_hz[0]
        scale = max(abs(chi(1j * omega, K * 1.1)), abs(chi(1j * omega, K * 0.9)))
        assert abs(chi(1j * omega, K)) < 1e-7 * scale


def test_textbook_boundaries():
    for expression, K, omega in (
        # Textbook results, by Routh's test or by elementary phase.
        ("K/(s*(s + 1)*(s + 2))", 6, math.sqrt(2)),
        ("K*(s + 2)^2/s^3", 1, 2),
        # Franklin, Powell and Emami-Naeini, Feedback Control of Dynamic Systems, section 3.6: K > 7.5.
        ("K*(s + 1)/(s*(s - 1)*(s + 6))", 7.5, math.sqrt(1.5)),
        # The same, with proportional and integral control of 1/((s + 1)(s + 2)) with K_I = 10: K > 10/3 - 2.
        ("(K + 10/s)/((s + 1)*(s + 2))", 10 / 3 - 2, math.sqrt(10 / 3)),
    ):
        (boundary, *_) = loop(expression).stability("K").boundaries
        assert abs(float(boundary.gain) - K) < 1e-12 * K, expression
        assert abs(2 * math.pi * boundary.frequencies_hz[0] - omega) < 1e-12 * omega, expression


@pytest.mark.slow
def test_margins_of_an_integrator_with_delay():
    # L = K e^(-s T)/s crosses 1 at omega = K; the phase left is 90 degrees less K T.
    found = loop("K*D/s", K=1.2).stability("K")
    ((angle, hertz),) = found.phase_margins
    assert abs(angle - (90 - math.degrees(1.2 * 0.5))) < 1e-10
    assert abs(2 * math.pi * hertz - 1.2) < 1e-12
    (factor,) = found.gain_margins
    assert abs(float(factor) - math.pi / (2 * 0.5 * 1.2)) < 1e-12
