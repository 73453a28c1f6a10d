"""Poles of fields with complex coefficients: beams with gyroscopic discs, whose deflection is x + jy."""

import mpmath
import pytest

import symflex

# Overhung disc on a turning shaft, in one complex deflection; the values of a small rotor.
TURNING = """symflex = 1
inputs = { F = { unit = "N" } }
[parameters]
EI = "1200 N*m^2"
rhoA = "3.9 kg/m"
l = "0.4 m"
m = "3 kg"
J_d = "0.012 kg*m^2"
J_p = "0.024 kg*m^2"
Omega = "6000 rpm"
c = { value = "0 N*s/m", assume = "nonnegative" }
[outputs]
R = "w(l)"
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + rhoA*s^2*w = 0"
conditions = [
  "w(0) = 0",
  "w'(0) = 0",
  "EI*w''(l) = -(J_d*s^2 - j*J_p*Omega*s)*w'(l)",
  "EI*w'''(l) = m*s^2*w(l) + c*s*w(l) - F",
]
"""


def conditions(s, c=0):
    """Return both conditions at the disc, and deflections, of two functions that meet those at the wall."""
    EI, rhoA, l, m, Jd, Jp, speed = 1200, 3.9, 0.4, 3, 0.012, 0.024, 200 * mpmath.pi  # noqa: E741
    k = mpmath.sqrt(mpmath.sqrt(-rhoA * s**2 / EI))
    ch, sh, co, si = mpmath.cosh(k * l), mpmath.sinh(k * l), mpmath.cos(k * l), mpmath.sin(k * l)
    one = (ch - co, k * (sh + si), k**2 * (ch + co), k**3 * (sh - si))
    two = (sh - si, k * (ch - co), k**2 * (sh + si), k**3 * (ch + co))
    turn = [EI * f[2] + (Jd * s**2 - 1j * Jp * speed * s) * f[1] for f in (one, two)]
    push = [EI * f[3] - (m * s**2 + c * s) * f[0] for f in (one, two)]
    return (turn, push), (one[0], two[0])


def determinant(s, c=0):
    """Return the determinant of the conditions, divided by what it vanishes with at s = 0."""
    (turn, push), _ = conditions(s, c)
    return (turn[0] * push[1] - turn[1] * push[0]) / s**2


GUESSES = (-96.27j, 154.2j, -567.9j, 1500.0j, -2686.5j)


@pytest.mark.slow  # 3 to 6 s
@pytest.mark.parametrize("damping", [0, 40])
def test_poles_of_an_overhung_disc_are_those_of_its_conditions_on_both_sides(damping):
    model = symflex.loads(TURNING.replace('"0 N*s/m"', f'"{damping} N*s/m"'))
    poles = model.transfer_function("R", "F").bind().poles(modes=5)
    expected = [complex(mpmath.findroot(lambda s: determinant(s, damping), g - damping / 8)) for g in GUESSES]
    assert [complex(p) for p in poles] == [pytest.approx(s, rel=1e-9, abs=1e-6) for s in expected]


def test_values_off_the_axis_are_those_of_the_conditions():
    bound = symflex.loads(TURNING).transfer_function("R", "F").bind()
    for s in (30 + 40j, -20 - 300j, -50j):
        (turn, push), deflections = conditions(s)
        # Cramer's rule, with the force -F in the second condition.
        moved = turn[1] * deflections[0] - turn[0] * deflections[1]
        expected = moved / (turn[0] * push[1] - turn[1] * push[0])
        assert bound(s) == pytest.approx(complex(expected), rel=1e-12)
