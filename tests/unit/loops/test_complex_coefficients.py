"""Stable values of models with complex coefficients: rotors in x + jy and machines in d + jq."""

from math import pi, sqrt

import mpmath
import pytest

import symflex
from symflex.errors import ModelError

# Jeffcott's rotor with damping from outside and from inside is stable up to the speed w (1 + c_e/c_i) with
# w^2 = k/m, where it whirls with w (Kimball 1924); in axes that turn with it, with w less the speed.
ROTOR = {"m": "10 kg", "k": "1 MN/m", "c_e": "400 N*s/m", "c_i": "150 N*s/m"}
NATURAL = sqrt(1e6 / 10)
ONSET = NATURAL * (1 + 400 / 150)
WRITTEN = (
    ("m*s^2*z + c_e*s*z + c_i*(s - j*W)*z + k*z = F", NATURAL),
    ("k*z = F + j*c_i*W*z - s*(c_i + c_e)*z - s^2*m*z", NATURAL),
    ("m*s^2*z + (c_i + c_e)*s*z + c_i*W*z/j + k*z = F", NATURAL),
    ("m*(s + j*W)^2*z + c_e*(s + W*j)*z + c_i*s*z + k*z = F", NATURAL - ONSET),
    ("m*(s^2 - 2*W*s/j - W^2)*z + c_e*s*z + c_e*j*W*z + c_i*s*z + k*z = F", NATURAL - ONSET),
)
# A current loop with a delay in axes that turn with omega.
CURRENT = """symflex = 1
parameters = { L = "2 mH", R = "0.5 Ohm", omega = "2000 rad/s", T = "150 us", K = "4 V/A", T_n = "4 ms" }
inputs = { w = { unit = "A" } }
outputs = { I = "i" }
[signals]
u = "K*(1 + 1/(T_n*s))*exp(-s*T)*(w - i)"
i = "u/(L*s + R + j*omega*L)"
"""


def rotor(equation: str, **speed: object) -> symflex.Model:
    return symflex.Model(
        parameters=ROTOR | {"W": speed or "300 rad/s"},
        equations={"unknowns": ["z"], "equations": [equation]},
        inputs={"F": {"unit": "N"}},
        outputs={"Z": "z"},
    )


def ends(found: symflex.Stability) -> list[tuple[float, list[float], int]]:
    """Return each boundary with the frequencies [rad/s] there, and how many poles enter."""
    return [(float(b.gain), [2 * pi * f for f in b.frequencies_hz], b.entering) for b in found.boundaries]


@pytest.mark.parametrize(("equation", "frequency"), WRITTEN)
def test_a_rotor_with_damping_inside_is_stable_up_to_the_onset(equation, frequency):
    found = rotor(equation).stability(over="W", limits=(0, 2000))
    ((speed, frequencies, entering),) = ends(found)
    assert found.certified
    assert found.is_stable
    assert speed == pytest.approx(ONSET, rel=1e-13)
    assert frequencies == [pytest.approx(frequency, rel=1e-12)]
    assert entering == 1
    assert ends(rotor(equation).stability("W", (0, 2000)))[0][0] == pytest.approx(ONSET, rel=1e-13)


def test_a_rotor_without_damping_has_its_own_poles_on_the_axis_and_no_images():
    # Seen from axes that turn, (s + j W)^2 = -k/m: two poles on the axis at every speed.
    found = rotor("m*(s + j*W)^2*z + k*z = F").stability(over="W", limits=(1, 300))
    assert found.certified
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(0, 2)]


def test_a_rotor_that_turns_the_other_way_whirls_backwards():
    model = rotor(WRITTEN[0][0], value="-300 rad/s", assume="real")
    backwards, forwards = ends(model.stability(over="W", limits=(-2000, 2000)))
    assert (backwards[0], forwards[0]) == pytest.approx((-ONSET, ONSET))
    assert (*backwards[1], *forwards[1]) == pytest.approx((-NATURAL, NATURAL))
    assert (backwards[2], forwards[2]) == (-1, 1)


def current(s, K=4, T=150e-6, omega=2000):
    """Return the characteristic function, with s times it so that it is entire."""
    return s * (2e-3 * s + 0.5 + 1j * omega * 2e-3) + K * (s + 250) * mpmath.exp(-s * T)


@pytest.mark.parametrize(
    ("name", "limits", "guess"),
    [("omega", (0, 20000), (9200, -11100)), ("K", (10, 20), (17, -10500)), ("T", (0, 1e-3), (4e-4, -4000))],
)
def test_a_delayed_loop_in_turning_axes_meets_the_axis_at_negative_frequencies(name, limits, guess):
    found = symflex.loads(CURRENT).stability(over=name, limits=limits)

    def both(value, omega):
        at = current(mpmath.mpc(0, omega), **{name: value})
        return [at.real, at.imag]

    value, omega = map(float, mpmath.findroot(both, guess))
    assert found.certified
    assert ends(found) == [(pytest.approx(value, rel=1e-9), [pytest.approx(omega, rel=1e-9)], 1)]


def test_a_chart_counts_poles_of_the_model_alone():
    model = rotor(WRITTEN[0][0])
    chart = model.stability(over=("W", "c_e"), ranges={"W": (0, 3000), "c_e": (0, 1000)})
    assert chart.at(NATURAL * (1 + 200 / 150) - 50, 200) == "stable"
    assert chart.at(NATURAL * (1 + 200 / 150) + 50, 200) == "unstable by 1"


def test_waves_with_complex_coefficients_are_refused():
    model = symflex.loads(
        """symflex = 1
        parameters = { EI = "1200 N*m^2", rhoA = "3.9 kg/m", l = "0.4 m", tau = "20 us", W = "100 rad/s" }
        inputs = { F = { unit = "N" } }
        outputs = { R = "w(l)" }
        [fields.w]
        domain = ["0", "l"]
        equation = "EI*(1 + tau*(s - j*W))*w'''' + rhoA*s^2*w = 0"
        conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*(1 + tau*(s - j*W))*w'''(l) = -F"]
        """
    )
    with pytest.raises(ModelError, match="waves that have complex coefficients"):
        model.stability(over="W", limits=(50, 150))
