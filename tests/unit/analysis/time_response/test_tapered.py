"""Members that taper, pushed at an end: responses hold what finite elements give."""

from functools import cache

import numpy as np
import pytest
import scipy.linalg

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response

BEAM = """
symflex = 1
parameters = { I_0 = "1 m^4", A_0 = "1 m^2", l = "1 m" }
inputs     = { F = { force = "tip" } }
outputs    = { y = "tip" }
elements.arm.type    = "beam"
elements.arm.between = ["ground", "tip"]
elements.arm.E       = "1 Pa"
elements.arm.rho     = "1 kg/m^3"
elements.arm.l       = "l"
elements.arm.I       = "I_0*(1 - 0.6*x/l)^4"
elements.arm.A       = "A_0*(1 - 0.6*x/l)^2"
"""
PARTS = 60
"""Finite elements; at rest the tip is where it should be to 5e-8 of how far it moves, and to 2e-7 with 40."""


def bound(eta=0.0, b=0.0):
    text = f'{BEAM}elements.arm.eta = "{eta} s"\n' if eta else BEAM
    if b:
        text += f'elements.loss = {{ type = "damper", between = ["tip", "ground"], b = "{b} N*s/m" }}\n'
    return loads(text).transfer_function("y", "F").bind().bound


@cache
def finite_elements():
    """Return mass and stiffness of the same beam, clamped, by cubic elements, displacement before slope."""
    points, weights = np.polynomial.legendre.leggauss(6)
    mass, stiffness = np.zeros((2, 2 * PARTS + 2, 2 * PARTS + 2))
    h = 1 / PARTS
    for k in range(PARTS):
        place = slice(2 * k, 2 * k + 4)
        for point, weight in zip((points + 1) / 2, weights / 2, strict=True):
            thin = 1 - 0.6 * (k + point) * h
            x = point
            shape = np.array(
                [1 - 3 * x**2 + 2 * x**3, h * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, h * (x**3 - x**2)]
            )
            bent = np.array([12 * x - 6, h * (6 * x - 4), 6 - 12 * x, h * (6 * x - 2)]) / h**2
            mass[place, place] += weight * h * thin**2 * np.outer(shape, shape)
            stiffness[place, place] += weight * h * thin**4 * np.outer(bent, bent)
    return mass[2:, 2:], stiffness[2:, 2:]


def stepped(times, eta, b):
    """Return what a unit force at the tip moves, by the matrix exponential of the finite elements."""
    mass, stiffness = finite_elements()
    n = len(mass)
    damping = eta * stiffness
    damping[-2, -2] += b
    force = np.zeros(n)
    force[-2] = 1
    zero, one = np.zeros((n, n)), np.eye(n)
    whole = np.block([[zero, one], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]])
    rest = np.concatenate([np.linalg.solve(stiffness, force), np.zeros(n)])
    return np.array([(rest - scipy.linalg.expm(whole * t) @ rest)[n - 2] for t in times])


TIMES = [0.0, 0.01, 0.1, 0.37, 1.0, 2.9]


@pytest.mark.slow
def test_a_step_of_a_tapered_beam_is_what_finite_elements_give():
    found = time_response(bound(5e-3, 0.2), "step", SampleTimes.of(TIMES), 3)
    expected = stepped(TIMES, 5e-3, 0.2)
    largest = np.max(np.abs(expected))
    assert not found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + 1e-7 * largest)
    assert np.all(found.radius < 3e-4 * largest)
