"""Rods, strings, shafts and beams in oil with an active end: one model has one verdict, whoever is asked."""

from fractions import Fraction
from functools import partial

import mpmath
import numpy as np
import pytest
from numpy import cosh, exp, sqrt, tanh

from symflex import pipeline
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions

MEMBERS = {  # with a tension or stiffness, a mass per length, a viscous foundation [SI]
    "rod": ('E = "200 GPa", A = "1 cm^2", rho = "7800 kg/m^3", l = "1 m", c_f = "50 N*s/m^2"', 2e7, 0.78, 50),
    "string": (
        'N = "1 kN", A = "10 mm^2", rho = "7800 kg/m^3", l = "1 m", c_f = "0.5 N*s/m^2"',
        1e3,
        0.078,
        0.5,
    ),
    "shaft": (
        'G = "80 GPa", J = "1e-8 m^4", rho = "7800 kg/m^3", l = "1 m", c_f = "0.2 N*s"',
        800,
        7.8e-5,
        0.2,
    ),
    "beam": (
        'E = "200 GPa", I = "1000 mm^4", A = "1 cm^2", rho = "7800 kg/m^3", l = "1 m", c_f = "5 N*s/m^2"',
        200,
        0.78,
        5,
    ),
}
TEXT = """
symflex = 1
parameters = {{ K = {gain}, T = "1 ms", D = "5 N*s/m" }}
elements.member = {{ type = "{kind}", between = ["{a}", "{b}"], {values} }}
elements.drive = {{ type = "{source}", at = "{at}", {effort} = "{law}" }}
{more}
inputs.r = {{}}
outputs.Y = "{at}"
"""


def model(kind, law, gain, ends=("u", "w"), at="u", more=""):
    source, effort = ("torque_source", "tau") if kind == "shaft" else ("force_source", "f")
    a, b = ends
    return pipeline.loads(
        TEXT.format(
            kind=kind,
            values=MEMBERS[kind][0],
            law=law,
            gain=gain if gain.startswith("{") else f'"{gain}"',
            a=a,
            b=b,
            at=at,
            source=source,
            effort=effort,
            more=more,
        )
    )


def wave(kind, s):
    """Return the impedance per displacement ``N gamma`` of a member of length 1, and its wavenumber."""
    _, stiffness, mass, loss = MEMBERS[kind]
    gamma = sqrt(s * (mass * s + loss) / stiffness + 0j)
    return stiffness * gamma, gamma


def free(kind, law):
    """A member free at its far end: ``Z tanh(gamma) + K(s)``."""

    def function(s):
        z, gamma = wave(kind, s)
        return z * tanh(gamma) + law(s)

    return function


def held(kind, law):
    """A member held at its far end: ``Z/tanh(gamma) + K(s)``."""

    def function(s):
        z, gamma = wave(kind, s)
        return z / tanh(gamma) + law(s)

    return function


def cantilever(law):
    """The tip of a cantilever: ``EI k^3 (1 + cosh cos) + K(s) (cosh sin - sinh cos)``, as large as 1."""

    def function(s):
        _, stiffness, mass, loss = MEMBERS["beam"]
        k = exp(0.25j * np.pi) * sqrt(s + 0j) * ((mass + loss / s) / stiffness) ** 0.25
        c, h = np.cos(k), cosh(k)
        value = stiffness * k**3 * (1 + h * c) + law(s) * (h * np.sin(k) - np.sinh(k) * c)
        return value / (k**3 * exp((1 - 1j) * k))

    return function


def between(law):
    """A mass of 1 kg moved by ``-K(s) w - 5 s u`` at one end of a string that is free at the other."""

    def function(s):
        z, gamma = wave("string", s)
        return z * tanh(gamma) + s * s + 5 * s + law(s) / cosh(gamma)

    return function


def counted(function, radius):
    """Count the zeros in the right half-plane by the winding about a half disc, with numpy alone."""
    inner = 1e-3
    axis = np.geomspace(inner, radius, 300_000)
    half = np.linspace(-np.pi / 2, np.pi / 2, 20_000)
    path = np.concatenate(
        [radius * exp(1j * half), 1j * axis[::-1], inner * exp(1j * half[::-1]), -1j * axis]
    )
    values = np.concatenate([function(part) for part in np.array_split(path, 20)])
    return round(float(np.sum(np.angle(values[1:] / values[:-1]))) / (2 * np.pi))


REAL = '{{ value = "{} N/m", assume = "real" }}'
CART = 'elements.cart = { type = "mass", at = "u", m = "1 kg" }'
LOOPS = {
    "position": (model("rod", "K*(r - u)", "1000 N/m"), free("rod", lambda s: 1e3), 3e4),
    "pd": (model("rod", "K*(r - u - T*s*u)", "1000 N/m"), free("rod", lambda s: 1e3 + s), 3e4),
    "held": (model("rod", "K*(r - u)", "1000 N/m", ("ground", "u")), held("rod", lambda s: 1e3), 3e4),
    "softened": (
        model("rod", "K*(r - u)", REAL.format("-3e7"), ("ground", "u")),
        held("rod", lambda s: -3e7),
        3e4,
    ),
    "late": (
        model("rod", "K*exp(-s*T)*(r - u)", "1000 N/m", ("ground", "u")),
        held("rod", lambda s: 1e3 * exp(-s * 1e-3)),
        3e4,
    ),
    "filtered": (
        model("rod", "K*(r - u)/(1 + T*s)", "60000 N/m"),
        free("rod", lambda s: 6e4 / (1 + 1e-3 * s)),
        3e4,
    ),
    "string": (model("string", "K*(r - u)", "100 N/m"), free("string", lambda s: 100), 2e3),
    "apart": (
        model("string", "K*(r - w) - D*s*u", "100 N/m", more=CART),
        between(lambda s: 100),
        400,
    ),
    "apart and stiff": (
        model("string", "K*(r - w) - D*s*u", "9000 N/m", more=CART),
        between(lambda s: 9e3),
        400,
    ),
    "shaft": (model("shaft", "K*(r - u)", "10 N*m/rad"), free("shaft", lambda s: 10), 2e4),
    "spinning": (
        model("shaft", "K*(r - s*u)", "0.5 N*m*s/rad", ("ground", "u")),
        held("shaft", lambda s: s / 2),
        2e4,
    ),
    "beam": (model("beam", "K*(r - u)", "1000 N/m", ("ground", "u")), cantilever(lambda s: 1e3), 2e3),
    "damped beam": (
        model("beam", "r - K*s*u", "10 N*s/m", ("ground", "u")),
        cantilever(lambda s: 10 * s),
        2e3,
    ),
    "beam of any gain": (
        model("beam", "K*(r - u)", REAL.format(1000), ("ground", "u")),
        cantilever(lambda s: 1e3),
        2e3,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_roots_and_stable_gains_say_the_same_of_a_member_in_oil_with_an_active_end(name):
    loop, function, radius = LOOPS[name]
    right = counted(function, radius)
    limits = (Fraction(-31 * 10**6), Fraction(-29 * 10**6)) if name == "softened" else None
    found = stability(loop, StabilityOptions("K", limits)).verdict
    (bound,) = pipeline.derive_bound(loop, loop.transfer_functions)
    known = pipeline.roots(bound).verdict
    assert (found.word, known.word) == ("unstable" if right else "stable",) * 2, (found, known)
    assert known.right == right or known.right is None


def test_a_rod_in_oil_is_certified_with_a_spring_at_its_end():
    loop, function, radius = LOOPS["position"]
    found = stability(loop, StabilityOptions("K"))
    assert (found.certified, found.verdict.word, counted(function, radius)) == (True, "stable", 0)


REPETITIVE = """
symflex = 1
parameters = { k = 0.5, T = "0.02 s", tau = "0.2 ms", T_q = "0.3 ms" }
signals.w = "exp(-s*T)/(1 + T_q*s)*(w + k*e)"
signals.u = "e + w"
signals.y = "u/(1 + tau*s)"
signals.e = "r - y"
inputs.r = {}
outputs.E = "e"
"""


@pytest.mark.slow
def test_a_repetitive_controller_has_as_many_unstable_poles_as_its_crossings_say():
    # e (1 + tau s) + u = r (1 + tau s), with u = e + w and w = q (w + k e), q = exp(-s T)/(1 + T_q s).
    def function(s, k):
        return (1 + 3e-4 * s - exp(-0.02 * s)) * (2 + 2e-4 * s) + k * exp(-0.02 * s)

    found = stability(pipeline.loads(REPETITIVE), StabilityOptions("k"))
    assert found.certified
    first, last = found.boundaries[0].gain, found.intervals[-1]
    omega, k = mpmath.findroot(
        lambda w, k: [
            mpmath.re(z := ((1 + 3e-4j * w) * mpmath.exp(0.02j * w) - 1) * (2 + 2e-4j * w) + k),
            z.imag,
        ],
        (150, 4),
    )
    assert abs(float(first) - k) < 1e-9
    assert float(found.boundaries[0].frequencies[0]) == pytest.approx(float(omega), abs=1e-6)
    for interval in (found.intervals[1], found.intervals[20], last):
        gain = (float(interval.low) + float(interval.high)) / 2
        assert interval.poles.right == counted(partial(function, k=gain), 1e6), gain


DRILL = """
symflex = 1
parameters.P = "340 N*m*s/rad"
parameters.b_b = { value = "-30 N*m*s/rad", assume = "real" }
parameters.d_o = "127 mm"
parameters.d_i = "108.6 mm"
parameters.I = "200 N*m/rad"
definitions.J = "pi/32*(d_o^4 - d_i^4)"
elements.top  = { type = "inertia", at = "phi_t", J = "2000 kg*m^2" }
parameters.G = "79.3 GPa"
parameters.rho = "7850 kg/m^3"
elements.pipe = { type = "shaft", between = ["phi_t", "phi_b"], G = "G", J = "J", rho = "rho", l = "3 km" }
elements.bha  = { type = "inertia", at = "phi_b", J = "374 kg*m^2" }
elements.bit  = { type = "rotary_damper", between = ["phi_b", "ground"], b = "b_b" }
elements.drive = { type = "torque_source", at = "phi_t", tau = "(P + I/s)*(omega_ref - s*phi_t)" }
inputs.omega_ref = { unit = "rad/s" }
outputs.omega_b = "s*phi_b"
"""


@pytest.mark.slow
def test_a_drill_string_is_counted_up_to_a_frequency_that_no_pole_passes():
    # High modes of the pipe are damped where P/J_t^2 exceeds 30/J_b^2, so that P > 857.95; the lowest grows
    # again where the drive holds the top.
    def vanishes(omega, P):
        s = 1j * omega
        z = (
            mpmath.sqrt(79.3e9 * 7850)
            * mpmath.pi
            / 32
            * (mpmath.mpf("0.127") ** 4 - mpmath.mpf("0.1086") ** 4)
            * s
        )
        t = mpmath.tanh(s * 3000 * mpmath.sqrt(7850 / mpmath.mpf("79.3e9")))
        a, b = 2000 * s**2 + P * s + 200, 374 * s**2 - 30 * s
        value = (a * b + z**2) * t + z * (a + b)
        return [value.real, value.imag]

    found = stability(pipeline.loads(DRILL), StabilityOptions("P"))
    assert (found.verdict.word, found.certified) == ("unstable", False)
    (stable,) = found.stable
    for gain, start in [(stable.high, (0.82, 5700)), (found.boundaries[0].gain, (0.27, 38))]:
        assert abs(float(gain) - mpmath.findroot(vanishes, start)[1]) < 1e-6 * float(gain)
    assert 850 < float(stable.low) < 30 * (2000 / 374) ** 2 < float(stable.high)
    assert [i.poles.right for i in found.intervals] == [*range(22, -1, -2), 2]
