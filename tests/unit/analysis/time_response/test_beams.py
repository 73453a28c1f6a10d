"""Responses of beams hold the sums over modes that textbooks give, with all modes."""

from functools import cache

import mpmath
import numpy as np
import pytest
from flint import arb

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.analysis.time_response.lossless_modes import lossless_modes
from symflex.analysis.time_response.modal import BoundedModes
from symflex.balls import precision
from symflex.errors import UncertifiedError

UNIT = 'E = "1 Pa", A = "1 m^2", I = "1 m^4", rho = "1 kg/m^3", l = "1 m"'
TIMES = [0.0, 0.01, 0.1, 0.37, 1.0, 2.9]
MODES = 3000


def beam(rest="", kind=UNIT, output="x"):
    text = f'symflex = 1\nelements.arm = {{ type = "beam", between = ["ground", "x"], {kind} }}\n{rest}\n'
    text += f'inputs.F = {{ force = "x" }}\noutputs.X = "{output}"'
    return loads(text).transfer_function("X", "F").bind().bound


SLIDING = """
symflex = 1
parameters = { E = "1 Pa", I = "1 m^4", rho = "1 kg/m^3", A = "1 m^2", l = "1 m" }
inputs     = { F = {} }
outputs    = { X_act = "w(0)", X_tip = "w(l)", V_tip = "s*w(l)" }
[fields.w]
domain     = ["0", "l"]
equation   = "E*I*w'''' + rho*A*s^2*w = 0"
conditions = ["w'(0) = 0", "E*I*w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
"""


def sliding(output):
    return loads(SLIDING).transfer_function(output, "F").bind().bound


def roots_of(function, guesses):
    """Return roots by Newton's method in doubles; the functions are bounded and their slopes about 1."""
    beta = np.array(guesses)
    for _ in range(60):
        h = 1e-6
        slope = (function(beta + h) - function(beta - h)) / (2 * h)
        beta = beta - function(beta) / slope
    return beta


@cache
def cantilever():
    """Return beta, and the tip's deflection squared over the modal mass, 4 in all modes."""
    n = np.arange(1, MODES + 1)
    beta = roots_of(lambda b: np.cos(b) + 1 / np.cosh(np.minimum(b, 700)), (n - 0.5) * np.pi)
    return beta, np.full(MODES, 4.0)


@cache
def sliding_free():
    """Return beta, and phi(0)^2 and phi(0) phi(1) over the modal mass, with phi = cos/cos + cosh/cosh."""
    n = np.arange(1, MODES + 1)
    beta = roots_of(lambda b: np.sin(b) + np.cos(b) * np.tanh(b), (n - 0.25) * np.pi)
    cosine, growing = np.cos(beta), 1 / np.cosh(np.minimum(beta, 700))
    mass = (0.5 + np.sin(2 * beta) / (4 * beta)) / cosine**2
    mass += np.tanh(beta) / (2 * beta) + growing**2 / 2
    mass += (np.tan(beta) + np.tanh(beta)) / beta
    start, end = 1 / cosine + growing, 2.0
    return beta, start**2 / mass, start * end / mass


def step_of(beta, weights, times):
    """Return the sum of weights (1 - cos omega t)/omega^2, and a bound of what is left out."""
    omega = beta**2
    values = [np.sum((weights * (1 - np.cos(omega * t)) / omega**2)[::-1]) for t in times]
    return np.array(values), 2 * np.max(np.abs(weights)) / (3 * np.pi**4 * (MODES - 1.0) ** 3)


def test_a_step_of_a_cantilever_is_its_modal_sum():
    found = time_response(beam(), "step", SampleTimes.of(TIMES))
    expected, left = step_of(*cantilever(), TIMES)
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + left + 1e-14)
    assert found.radius.max() <= 1e-9 * np.max(np.abs(expected))


@pytest.mark.parametrize(("output", "which"), [("X_act", 1), ("X_tip", 2)])
def test_a_step_of_the_sliding_beam_is_its_modal_sum(output, which):
    found = time_response(sliding(output), "step", SampleTimes.of(TIMES))
    beta, *weights = sliding_free()
    expected, left = step_of(beta, weights[which - 1], TIMES)
    expected = expected + np.array(TIMES) ** 2 / 2  # the rigid body
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + left + 1e-13)
    assert found.radius.max() <= 1e-9 * np.max(np.abs(expected))


@pytest.mark.slow
def test_the_velocity_has_a_wider_bound_that_holds_too():
    found = time_response(sliding("V_tip"), "step", SampleTimes.of(TIMES))
    beta, _, weights = sliding_free()
    omega = beta**2
    expected = [t + np.sum((weights * np.sin(omega * t) / omega)[::-1]) for t in TIMES]
    left = 2 * np.max(np.abs(weights)) / (np.pi**2 * (MODES - 1.0))
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + left)
    assert found.radius.max() < 1e-4 * max(expected)


def test_a_ramp_of_a_cantilever_ends_in_the_static_slope():
    found = time_response(beam(), "ramp", SampleTimes.of([0.0, 50.0]))
    beta, weights = cantilever()
    omega = beta**2
    expected = 50.0 / 3 - np.sum(weights * np.sin(omega * 50.0) / omega**3)
    assert abs(found.values[1] - expected) <= found.radius[1] + 1e-10


def test_the_bound_of_modes_left_out_holds_for_a_thousand_of_them():
    modes, _ = lossless_modes(beam(), 1)
    sums = BoundedModes(modes, 1, SampleTimes.of([1.0]))
    few, many = sums.summed(20), sums.summed(1000)
    with precision(256):
        left = sum((abs(term.coefficients[0]) for term in many.terms[len(few.terms) :]), arb(0))
    assert left < few.rest < 20 * left


def test_paths_between_the_modes_are_told_from_those_through_them():
    modes, _ = lossless_modes(beam(), 1)
    last = BoundedModes(modes, 1, SampleTimes.of([1.0])).summed(40).terms[-2:]
    (factor,) = modes.poles
    with precision(256):
        through = [modes.rate * (term.rate.imag / 2).sqrt() for term in last]
        least = through[0] / modes.rate
        between = (through[0] + through[1]) / 2
        assert not factor.keeps_away_from_zero(through[0], least)
        assert factor.keeps_away_from_zero(between, least)


@pytest.mark.slow
def test_a_mass_and_a_spring_at_the_tip_leave_a_modal_sum():
    rest = 'elements.m = { type = "mass", at = "x", m = "0.3 kg" }\n'
    rest += 'elements.k = { type = "spring", between = ["ground", "x"], k = "5 N/m" }'
    found = time_response(beam(rest), "step", SampleTimes.of(TIMES))

    def stiffness(squared):  # of the tip, at omega^2, with q^4 = omega^2
        q = mpmath.sqrt(mpmath.sqrt(squared))
        above = q**3 * (1 + mpmath.cos(q) * mpmath.cosh(q))
        below = mpmath.cosh(q) * mpmath.sin(q) - mpmath.sinh(q) * mpmath.cos(q)
        return above / below - mpmath.mpf("0.3") * squared + 5

    def entire(q):  # the same without poles
        return q**3 * (mpmath.cos(q) + mpmath.sech(q)) + (5 - mpmath.mpf("0.3") * q**4) * (
            mpmath.sin(q) - mpmath.tanh(q) * mpmath.cos(q)
        )

    expected, static = [mpmath.mpf(0)] * len(TIMES), mpmath.mpf(1) / 8  # 1/(3 + 5)
    grid = [0.5 + 0.25 * i for i in range(800)]
    signs = [mpmath.sign(entire(mpmath.mpf(q))) for q in grid]
    with mpmath.workdps(40):
        for start in (
            a + 0.125 for a, one, other in zip(grid, signs, signs[1:], strict=False) if one != other
        ):
            q = mpmath.findroot(entire, (start - 0.125, start + 0.125), solver="anderson")
            weight = -1 / mpmath.diff(stiffness, q**4)
            static -= weight / q**4
            expected = [
                y + weight / q**4 * (1 - mpmath.cos(q**2 * mpmath.mpf(t)))
                for y, t in zip(expected, TIMES, strict=True)
            ]
        assert 0 < static < 1e-10  # what all other modes add to the static deflection
    errors = [abs(mpmath.mpf(v) - y) for v, y in zip(found.values.tolist(), expected, strict=True)]
    assert all(e <= r + 2 * static for e, r in zip(errors, found.radius.tolist(), strict=True))
    assert found.radius.max() < 1e-9 * found.values.max()


def damped_step(beta, weights, eta, c, k, times, derivative=0):
    """Return the modal sum of step or, for derivative 1, impulse responses of damped modes."""
    kappa = beta**4
    half, stiff = (c + eta * kappa) / 2, kappa + k
    root = np.sqrt((half**2 - stiff).astype(complex))
    # Of the two poles the slower one without cancellation.
    fast = -half - root
    slow = np.where(half**2 > stiff, stiff / fast, -half + root)
    found = []
    for t in times:
        parts = (
            np.exp(slow * t) * slow ** (derivative - 1) - np.exp(fast * t) * fast ** (derivative - 1)
        ) / (slow - fast)
        found.append(np.sum((weights * (parts.real + (0 if derivative else 1 / stiff)))[::-1]))
    return np.array(found)


LOSSES = {
    "to a viscous fluid": ('c_f = "2 N*s/m^2"', (0, 2, 0)),
    "to both, on a foundation": ('eta = "0.002 s", c_f = "3 N*s/m^2", k_f = "7 N/m^2"', (0.002, 3, 7)),
    "not at all, on a foundation": ('k_f = "7 N/m^2"', (0, 0, 7)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LOSSES)
def test_a_step_of_a_beam_that_loses_energy_along_its_length_is_a_sum_of_damped_modes(name):
    text, loss = LOSSES[name]
    found = time_response(beam(kind=f"{UNIT}, {text}"), "step", SampleTimes.of(TIMES))
    beta, weights = cantilever()
    expected = damped_step(beta, weights, *loss, TIMES)
    left = 2 * 4.0 / (3 * np.pi**4 * (MODES - 1.0) ** 3)
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + left + 1e-13)
    assert found.radius.max() <= 1e-9 * np.max(np.abs(expected))


@pytest.mark.parametrize(
    ("output", "eta"), [pytest.param("x", 0.0003, marks=pytest.mark.slow), ("s*x", 0.004)]
)
def test_an_impulse_of_a_displacement_is_a_step_of_a_velocity_and_known_as_soon_as_high_modes_have_faded(
    output, eta
):
    kind = "impulse" if output == "x" else "step"
    bound = beam(kind=f'{UNIT}, eta = "{eta} s"', output=output)
    found = time_response(bound, kind, SampleTimes.of(TIMES))
    beta, weights = cantilever()
    expected = damped_step(beta, weights, eta, 0, 0, TIMES, derivative=1)
    # The slow poles beyond lie next to -1/eta: each adds w/(eta kappa) e^(-t/eta) at most.
    left = 4.0 / (3 * np.pi**4 * (MODES - 1.0) ** 3 * eta) * np.exp(-np.array(TIMES) / eta)
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius + left + 1e-12)
    faded = np.array(TIMES) >= 25 * eta  # no mode fades faster than with exp(-t/eta)
    assert found.radius[faded].max() <= 1e-9 * np.max(np.abs(expected))
    assert found.radius[0] == 0


@pytest.mark.slow
def test_a_beam_that_loses_much_rings_out_at_the_rate_of_its_slowest_high_modes():
    found = time_response(beam(kind=f'{UNIT}, eta = "0.4 s"', output="s*x"), "step", SampleTimes.of(TIMES))
    beta, weights = cantilever()
    expected = damped_step(beta, weights, 0.4, 0, 0, TIMES, derivative=1)
    left = 4.0 / (np.pi**2 * (MODES - 1.0))
    assert np.all(np.abs(found.values - expected) <= found.radius + left * np.exp(-np.array(TIMES) / 0.4))


@pytest.mark.slow
def test_a_free_beam_in_a_viscous_fluid_drifts_to_a_constant_speed():
    text = SLIDING.replace("rho*A*s^2*w = 0", "(rho*A*s^2 + c*s)*w = 0").replace(
        'l = "1 m" }', 'l = "1 m", c = "2 N*s/m^2" }'
    )
    bound = loads(text).transfer_function("X_act", "F").bind().bound
    found = time_response(bound, "step", SampleTimes.of(TIMES))
    beta, weights, _ = sliding_free()
    t = np.array(TIMES)
    rigid = t / 2 - (1 - np.exp(-2 * t)) / 4  # of 1/(s^2 + 2 s)
    expected = rigid + damped_step(beta, weights, 0, 2, 0, TIMES)
    assert np.all(np.abs(found.values - expected) <= found.radius + 1e-10)


@pytest.mark.slow
def test_what_is_only_estimated_is_not_certified():
    active = 'elements.k = { type = "spring", between = ["ground", "x"], k = "-1 N/m" }\n'
    active += 'elements.d = { type = "damper", between = ["ground", "x"], b = 1 }'
    found = time_response(beam(active), "step", SampleTimes.of([0.0, 0.5, 2.0]))
    assert not found.certified
    assert "estimated" in found.reason
    assert abs(found.values[0]) <= found.radius[0]


@pytest.mark.slow
def test_an_elevators_rope_is_started_at_once():
    """The speed of the upper end steps; high modes add nothing any more once they have faded."""
    rope = 'type = "rod", E = "4 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m", eta = "10 ms"'
    text = f'symflex = 1\nelements.rope = {{ {rope}, between = ["drive", "car"] }}\n'
    text += 'elements.car = { type = "mass", at = "car", m = "1 kg" }\ninputs.v = { velocity = "drive" }\n'
    bound = loads(f'{text}outputs.F = "v.f"').transfer_function("F", "v").bind().bound
    found = time_response(bound, "step", SampleTimes.of([0.1, 0.5, 1.0]), 9)

    def force(s):
        stiffness = 4 * (1 + s / 100)
        wavenumber = s / mpmath.sqrt(stiffness)
        line, body = stiffness * wavenumber, s**2
        tanh = mpmath.tanh(wavenumber)
        return line * (line * tanh + body) / (line + body * tanh) / s**2

    for t, value, radius in zip(found.times, found.values, found.radius, strict=True):
        expected = mpmath.invertlaplace(force, t, method="dehoog", degree=60)
        assert abs(value - expected) <= radius + 1e-9 * abs(expected)
    assert found.certified
    assert np.all(found.radius < 1e-9 * np.abs(found.values))


def test_an_acceleration_of_a_beam_is_refused_as_modes_do_not_fall_off():
    with pytest.raises(UncertifiedError, match="SF810"):
        time_response(beam(output="s^2*x"), "impulse", SampleTimes.of([0.5]))


def with_delay(rest, output="D*x"):
    text = f'blocks.D = {{ type = "delay", T = "1 s" }}\nelements.arm = {{ type = "beam", {UNIT}, '
    text += f'between = ["ground", "x"] }}\ninputs.F = {{}}\n{rest}\noutputs.X = "{output}"'
    return loads(f"symflex = 1\n{text}").transfer_function("X", "F").bind().bound


@pytest.mark.slow
def test_a_beam_that_is_seen_late_does_the_same_later():
    late = with_delay('elements.push = { type = "force_source", at = "x", f = "F" }')
    found = time_response(late, "step", SampleTimes.of([0.5, 1.0, 1.37, 2.0, 3.9]))
    alone = time_response(late, "step", SampleTimes.of([0.5, 1.37]))
    beta, weights = cantilever()
    expected, left = step_of(beta, weights, [0.37, 1.0, 2.9])
    assert found.certified
    assert found.values[0] == 0 == found.radius[0]
    assert found.enclosures[1].contains(0)
    assert alone.enclosures[1].overlaps(found.enclosures[2])
    assert np.all(np.abs(found.values[2:] - expected) <= found.radius[2:] + left + 1e-14)
    assert found.radius.max() <= 1e-9 * np.max(np.abs(expected))


@pytest.mark.slow
def test_a_beam_that_is_seen_at_once_and_late_is_the_sum_of_both():
    push = 'elements.push = { type = "force_source", at = "x", f = "F" }'
    times = SampleTimes.of([0.5, 1.37, 3.9])
    both = time_response(with_delay(push, "x + D*x/2"), "step", times)
    expected, left = step_of(*cantilever(), [0.5, 1.37, 3.9])
    later, _ = step_of(*cantilever(), [0.37, 2.9])
    assert both.certified
    assert np.all(
        np.abs(both.values - expected - np.array([0, *later]) / 2) <= both.radius + 2 * left + 1e-14
    )
