"""Mode shapes of members that taper against closed forms and collocation."""

from fractions import Fraction
from math import isclose

import numpy as np
import pytest
from mpmath import besseli, besselj, mp, mpf
from scipy.optimize import brentq
from scipy.special import jv, yv

from symflex import pipeline
from symflex.analysis.modes.find import mode_shape
from symflex.roots.locate import locate
from tests.independent.test_tapers import propagated

HEAD = """
symflex = 1
parameters = { E = "2 Pa", rho = "3 kg/m^3", l = "1.5 m", c = 0.6, g = "9.81 m/s^2" }
"""
ROD = """
inputs.F = { force = "tip" }
outputs.y = "tip"
[elements]
rod = { type = "rod", between = ["ground", "tip"], E = "E", rho = "rho", l = "l", A = "l^2*(1 - c*x/l)^2" }
"""
STRING = """
inputs.u = { unit = "m" }
outputs.tip = "w(0)"
[fields]
w = { domain = ["0", "l"], equation = "(g*x*w')' = s^2*w", conditions = ["w(l) = u"] }
"""
WEDGE = """
elements.arm = { type = "beam", between = ["root", "tip"], E = "E", rho = "rho", l = "l", I = "I", A = "A" }
inputs.u = { displacement = "root" }
outputs.y = "tip"
"""


def shape_of(text, number):
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = mode_shape(bound, number)
    assert found.certified
    (part,) = found.distributed
    return found.pole, part


@pytest.mark.slow
def test_a_conical_rod_moves_like_a_sine_over_its_diameter():
    pole, part = shape_of(HEAD + ROD, 2)
    k = mpf(str(float(pole.im.mid()))) * mp.sqrt(mpf(3) / 2)

    def at(x):
        return mp.sin(k * x) / (1 - mpf("0.4") * x)

    end = part.at(Fraction(3, 2))[0]
    for x in (Fraction(0), Fraction(2, 5), Fraction(11, 10)):
        found = (part.at(x)[0] / end).real
        assert isclose(float(found), float(at(float(x)) / at(1.5)), rel_tol=1e-13, abs_tol=1e-14)


@pytest.mark.slow
def test_a_hanging_string_moves_like_a_bessel_function():
    # w = J_0(2 omega sqrt(x/g)), x from the free end (Daniel Bernoulli 1733).
    pole, part = shape_of(HEAD + STRING, 2)
    omega = float(pole.im.mid())
    for x in (0.0, 0.3, 0.9, 1.2):
        expected = float(besselj(0, 2 * omega * mp.sqrt(x / mpf("9.81"))))
        assert isclose(float(part.at(Fraction(str(x)))[0].real), expected, rel_tol=1e-13)
    states = [state for _, state in part.sampled(8)]
    assert isclose(float(states[2][0].real), float(part.at(Fraction(3, 8))[0].real), rel_tol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("is_turned", [False, True])
def test_a_wedge_moves_like_bessel_functions_from_its_tip(is_turned):
    # w = z^-1 (a J_1(z) + b I_1(z)), z = 2 sqrt(k (l - x)), k^2 = 12 omega^2 rho/E; hinged: w = 0.
    thin = "(x/l)" if is_turned else "(1 - x/l)"
    text = WEDGE.replace('"I"', f'"l^4*{thin}^3/12"').replace('"A"', f'"l^2*{thin}"')
    text = text.replace('between = ["root", "tip"]', 'between = ["tip", "root"]') if is_turned else text
    pole, part = shape_of(HEAD + text, 2)
    k = float(pole.im.mid()) * mp.sqrt(mpf(3) * 12 / 2)
    root = 2 * mp.sqrt(k * mpf("1.5"))

    def shape(x):
        z = 2 * mp.sqrt(k * (mpf("1.5") - x))
        return (besseli(1, root) * besselj(1, z) - besselj(1, root) * besseli(1, z)) / z

    first = shape(mpf(3) / 4)
    reference = part.at(Fraction(3, 4))[0]
    for x in (Fraction(3, 10), Fraction(6, 5)):
        place = mpf(x.numerator) / x.denominator
        found = (part.at(Fraction(3, 2) - x if is_turned else x)[0] / reference).real
        assert isclose(float(found), float(shape(place) / first), rel_tol=1e-11)


LOSSY = """
symflex = 1
definitions = { E_c = "E*(1 + eta*s)", taper = "1/2" }
inputs.T = { torque = "hub.theta" }
outputs.y = "tip"
[parameters]
E = "200 GPa"
rho = "7800 kg/m^3"
A_0 = "16 cm^2"
I_0 = "21.3 cm^4"
l = "1 m"
eta = "20 us"
[elements]
pin = { type = "pin", at = "hub" }
arm.type = "beam"
arm.between = ["hub", "tip"]
arm.E = "E_c"
arm.rho = "rho"
arm.l = "l"
arm.I = "I_0*(1 - taper*x/l)^3"
arm.A = "A_0*(1 - taper*x/l)"
J = { type = "inertia", at = "hub.theta", J = "0.1 kg*m^2" }
b = { type = "rotary_damper", between = ["hub.theta", "ground"], b = "3 N*m*s/rad" }
"""


@pytest.mark.slow
def test_a_damped_arm_with_a_hub_moves_as_collocation_says():
    pole, part = shape_of(LOSSY, 2)
    s = complex(float(pole.re.mid()), float(pole.im.mid()))

    def law(x, s):
        thin, m = 1 - x / 2, np.zeros((4, 4), dtype=complex)
        m[0, 1], m[1, 2], m[2, 3] = 1, 1 / (200e9 * (1 + 20e-6 * s) * 21.3e-8 * thin**3), 1
        m[3, 0] = -7800 * 16e-4 * thin * s**2
        return m

    # Pinned, y = 0; the hub's torque is the moment: per theta the state starts with (J s + b) s.
    hub = (0.1 * s + 3) * s
    whole = propagated(law, 1.0, s, (1, 1, 1e4, 1e4))
    starts = np.array([[0, 1, hub, 0], [0, 0, 0, 1]]).T
    free = (whole @ starts)[2:]
    assert abs(np.linalg.det(free)) < 1e-7 * np.linalg.norm(free[:, 0]) * np.linalg.norm(free[:, 1])
    start = starts @ [1, -free[1, 0] / free[1, 1]]
    tip = part.at(Fraction(1))[0]
    for x in (0.25, 0.6):
        moved = propagated(law, x, s, (1, 1, 1e4, 1e4)) @ start
        expected = moved[0] / (whole @ start)[0]
        found = part.at(Fraction(str(x)))[0] / tip
        assert complex(found.mid()) == pytest.approx(expected, rel=1e-7)


CABLE = """
symflex = 1
parameters = { mu = "0.35 kg/m", g = "9.81 m/s^2", l = "12 m", m = "15 kg" }
inputs.z = { displacement = "top" }
outputs.mid = "cable.y(l/2)"
[elements]
cable = { type = "string", between = ["top", "load"], N = "(m + mu*(l - x))*g", rhoA = "mu", l = "l" }
load = { type = "mass", at = "load", m = "m" }
"""


@pytest.mark.slow
def test_where_the_middle_of_a_hanging_cable_rests_its_lower_half_swings_alone():
    """``y = a J0(v) + b Y0(v)``, ``v = 2 omega sqrt(N/mu)/g``, and ``N dy/dx = m omega^2 y`` at the load."""
    mu, g, half, m = 0.35, 9.81, 6.0, 15.0

    def residue(omega):
        high, low = (2 * omega * np.sqrt((m + mu * x) / mu / g) for x in (half, 0.0))
        a, b = yv(0, high), -jv(0, high)
        slope = (a * jv(1, low) + b * yv(1, low)) * low / 2
        return mu * g * slope - m * omega**2 * (a * jv(0, low) + b * yv(0, low))

    (bound,) = pipeline.derive_bound(model := pipeline.loads(CABLE), model.transfer_functions)
    zeros = [float(r.im.mid()) for r in locate(bound).zeros if r.im > 0]
    assert len(zeros) == 5
    for omega in zeros:
        assert brentq(residue, omega * 0.99, omega * 1.01) == pytest.approx(omega, rel=1e-9)
