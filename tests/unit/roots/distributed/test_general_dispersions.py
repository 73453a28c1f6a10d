"""Roots of fields whose wavenumbers have no formula: coupled bending and torsion, sandwich beams."""

from math import pi

import mpmath
import numpy as np
import pytest

from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import bound

BENDING, TORSION = 140.0, 67.6
"""E I and G J."""
MASS, POLAR, LENGTH = 0.162, 8.91e-5, 0.8
"""rho A, rho I_p and l."""
CLAMPED = "w(0) = 0", "w'(0) = 0", "phi(0) = 0", "w''(l) = 0", "E*I*w'''(l) = -u", "phi'(l) = 0"
PINNED = "w(0) = 0", "w''(0) = M/(E*I)", "phi(0) = 0", "w(l) = 0", "w''(l) = 0", "phi(l) = 0"


def blade(conditions, e="8 mm", c="0 N*s/m^2", output="w'(0)"):
    ends = ", ".join(f'"{condition}"' for condition in conditions)
    name = "M" if any("M" in condition for condition in conditions) else "u"
    return f"""
symflex = 1
[parameters]
E   = "70 GPa"
I   = "2e-9 m^4"
rho = "2700 kg/m^3"
A   = "60 mm^2"
l   = "0.8 m"
G   = "26 GPa"
J   = "2.6e-9 m^4"
I_p = "3.3e-8 m^4"
e   = "{e}"
c   = {{ value = "{c}", assume = "nonnegative" }}
[fields.beam]
unknowns   = ["w", "phi"]
domain     = ["0", "l"]
equations  = [
    "E*I*w'''' + (rho*A*s^2 + c*s)*w + rho*A*e*s^2*phi = 0",
    "G*J*phi'' = (rho*I_p + rho*A*e^2)*s^2*phi + rho*A*e*s^2*w",
]
conditions = [{ends}]
[inputs]
{name} = {{}}
[outputs]
out = "{output}"
"""


def upper(text, region, digits=12):
    found = locate(bound(text), region, digits)
    assert found.certificate.certified
    values = [complex(float(r.re.mid()), float(r.im.mid())) for r in found.poles]
    return sorted((s for s in values if s.imag >= 0), key=abs)


def sine_modes(e, c, most):
    """Return the modes of pinned ends: w and phi go with sin(n pi x/l), a quartic in s for each n."""
    inertia = POLAR + MASS * e**2
    found = []
    for n in range(1, most):
        k = n * pi / LENGTH
        bending = np.array([MASS, c, BENDING * k**4])
        torsion = np.array([inertia, 0.0, TORSION * k**2])
        coupling = np.array([(MASS * e) ** 2, 0, 0, 0, 0])
        found += [s for s in np.roots(np.polysub(np.polymul(bending, torsion), coupling)) if s.imag >= 0]
    return sorted(map(complex, found), key=abs)


@pytest.mark.slow
def test_pinned_coupled_bending_and_torsion_solves_a_quartic_per_mode():
    found = upper(blade(PINNED, c="2 N*s/m^2"), Modes(3))
    assert found == pytest.approx(sine_modes(0.008, 2.0, 12)[:3], rel=1e-9, abs=1e-7)


def moments_and_force(s):
    """Return the determinant of the free end's moment, force and torque over those of the clamped end."""
    mass, e = mpmath.mpf("0.162"), mpmath.mpf("0.008")
    rows = mpmath.zeros(6)
    rows[0, 1] = rows[2, 3] = 1
    rows[1, 2], rows[4, 5] = 1 / mpmath.mpf(140), 1 / mpmath.mpf("67.6")
    rows[3, 0], rows[3, 4] = -mass * s**2, -mass * e * s**2
    rows[5, 0], rows[5, 4] = mass * e * s**2, (mpmath.mpf("8.91e-5") + mass * e**2) * s**2
    grown = mpmath.expm(rows * mpmath.mpf("0.8"))
    return mpmath.det(mpmath.matrix([[grown[i, j] for j in (2, 3, 5)] for i in (2, 3, 5)]))


@pytest.mark.slow
def test_a_clamped_blade_against_shooting():
    found = locate(bound(blade(CLAMPED, output="w(l)")), Modes(3), 12)
    assert found.certificate.certified
    assert all(root.on_imaginary_axis for root in found.poles)
    omega = [float(root.im.mid()) for root in found.poles if root.im > 0]
    with mpmath.workdps(30):
        expected = [complex(mpmath.findroot(moments_and_force, 1j * w)).imag for w in omega]
    assert len(omega) == 3
    assert omega == pytest.approx(expected, rel=1e-9)


SANDWICH = """
symflex = 1
[parameters]
D = "50 N*m^2"
g = "40 1/m^2"
Y = "3"
m = "1.2 kg/m"
l = "1 m"
[fields.w]
domain     = ["0", "l"]
equation   = "D*w'''''' - D*g*(1 + Y)*w'''' + m*s^2*w'' - g*m*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = 0", "w''''(0) = 0", "w(l) = 0", "w''(l) = M", "w''''(l) = 0"]
[inputs]
M = {}
[outputs]
slope = "w'(l)"
"""


@pytest.mark.slow
def test_a_simply_supported_sandwich_beam_has_modes_of_sines():
    # Mead and Markus 1969: D k^6 + D g (1 + Y) k^4 = m omega^2 (k^2 + g), k = n pi.
    k = np.arange(1, 4) * pi
    expected = np.sqrt((50 * k**6 + 50 * 40 * 4 * k**4) / (1.2 * (k**2 + 40)))
    assert [s.imag for s in upper(SANDWICH, Modes(3))] == pytest.approx(list(expected), rel=1e-9)
