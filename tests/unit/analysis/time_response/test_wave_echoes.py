"""Waves that change their form on the way are known exactly, front by front."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import iv, jv

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.analysis.time_response.delayed_terms import delayed_quotient
from symflex.analysis.time_response.echoes import echoed
from symflex.analysis.time_response.modal import proved_modes
from symflex.analysis.time_response.sampled import is_precise

TIMES = [0.3, 1.0, 2.9, 7.7]
ROD = 'E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m"'
STRING = ROD.replace('E = "1 Pa"', 'N = "1 N"')


def of(text, output="X", source="F"):
    return loads(f"symflex = 1\n{text}").transfer_function(output, source).bind().bound


def clamped(kind, c, k):
    """Return a rod, or a string, with c = 1 m/s and an impedance of 1 N s/m, pulled at its end."""
    material = STRING if kind == "string" else ROD
    around = f'c_f = "{c} N*s/m^2", k_f = "{k} N/m^2"'
    text = f'elements.bar = {{ type = "{kind}", between = ["ground", "x"], {material}, {around} }}\n'
    return of(f'{text}inputs.F = {{ force = "x" }}\noutputs.X = "x"')


def front(t, d, c, k):
    """Return the inverse of ``exp(-d g)/g`` with ``g = sqrt(s^2 + c s + k)`` (Abramowitz & Stegun 29.3)."""
    turned = k - c * c / 4
    argument = np.sqrt(abs(turned) * max(t * t - d * d, 0.0))
    return (np.exp(-c * t / 2) * (iv(0, argument) if turned < 0 else jv(0, argument))) if t > d else 0.0


def images(t, c, k):
    """Return what an impulse does at the end of the rod: tanh(g)/g, by images."""
    return sum((1 if n == 0 else 2 * (-1) ** n) * front(t, 2 * n, c, k) for n in range(int(t / 2) + 1))


def integral(function, t, fronts):
    ends = sorted({0.0, t, *(d for d in fronts if d < t)})
    return sum(quad(function, a, b, epsabs=1e-13)[0] for a, b in pairwise(ends))


def assert_holds(found, expected, off=0.0):
    assert found.certified
    assert np.all(np.abs(found.values - np.array(expected)) <= found.radius + off)
    assert found.radius.max() <= 1e-9 * np.abs(found.values).max()


@pytest.mark.parametrize(("kind", "c", "k"), [("rod", 0.5, 3), ("string", 4, 0), ("string", 0, 2)])
def test_an_impulse_in_a_rod_or_string_with_losses_or_on_a_foundation_comes_back_as_its_images(kind, c, k):
    found = time_response(clamped(kind, c, k), "impulse", SampleTimes.of(TIMES))
    assert_holds(found, [images(t, c, k) for t in TIMES], off=1e-13)


def test_a_step_in_a_rod_with_losses_is_the_integral_of_its_images():
    found = time_response(clamped("rod", 0.5, 3), "step", SampleTimes.of(TIMES))
    fronts = [2.0, 4.0, 6.0]
    assert_holds(found, [integral(lambda u: images(u, 0.5, 3), t, fronts) for t in TIMES], off=1e-12)


def test_every_front_of_an_impulse_is_weaker_by_what_it_has_lost():
    found = time_response(clamped("rod", 0.5, 0), "impulse", SampleTimes.of([0.0, 7.7]))
    # The image at 2 n has twice exp(-c t/2), at t = 2 n.
    expected = [2 * (-1) ** n * np.exp(-0.5 * n) for n in (1, 2, 3)]
    assert [float(jump.height) for jump in found.jumps] == pytest.approx(expected, abs=1e-14)
    assert [float(jump.time) for jump in found.jumps] == [2, 4, 6]


def test_a_loop_with_a_delay_around_a_rod_with_losses_is_its_first_turns():
    text = (
        'parameters = { K = "0.8 N/m", T = "0.7 s" }\nblocks.D = { type = "delay", T = "T" }\n'
        f'elements.bar = {{ type = "rod", between = ["ground", "x"], {ROD}, c_f = "0.5 N*s/m^2" }}\n'
        'elements.f = { type = "force_source", at = "x", f = "K*D*(r - x)" }\n'
        'inputs.r = { unit = "m" }\noutputs.X = "x"'
    )
    times = [0.3, 0.9, 1.3, 1.6, 2.0]
    found = time_response(of(text, source="r"), "step", SampleTimes.of(times))

    def step(t):
        return integral(lambda u: images(u, 0.5, 0), t, [2.0])

    def twice(t):
        return integral(lambda u: step(t - u) * images(u, 0.5, 0), t, [2.0])

    # K D P/(1 + K D P) = K D P - (K D P)^2 + ..., the next of which begins at 2.1 s.
    expected = [0.8 * step(max(t - 0.7, 0)) - 0.64 * twice(max(t - 1.4, 0)) for t in times]
    assert_holds(found, expected, off=1e-12)


@pytest.mark.slow
def test_modes_of_a_shaft_between_discs_say_what_its_echoes_say():
    text = """
symflex = 1
elements.near = { type = "inertia", at = "a", J = "3e-4 kg*m^2" }
elements.shaft = { type = "shaft", between = ["a", "b"], G = "79 GPa", J = "15708 mm^4", \
    rho = "7850 kg/m^3", l = "1.2 m" }
elements.far = { type = "inertia", at = "b", J = "1e-4 kg*m^2" }
inputs.tau = { torque = "a" }
outputs.phi = "b"
"""
    bound = loads(text).transfer_function("phi", "tau").bind().bound
    times = SampleTimes.of([0.003, 0.005, 0.01])
    modes = proved_modes(bound, 1, times, 12).sampled
    echoes = echoed(delayed_quotient(bound), 1, times, 60)
    assert all(y.overlaps(z) for y, z in zip(modes.values, echoes.values, strict=True))
    assert is_precise(modes.values, 8)
    assert is_precise(echoes.values, 12)
