"""Responses of rational functions contain the true values, which other means compute."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import scipy.signal
from flint import arb, ctx

from symflex import loads
from symflex.analysis.time_response import INTEGRATIONS, SampleTimes, time_response
from symflex.errors import UncertifiedError, UsageError
from tests.unit.analysis.systems import rational, words
from tests.unit.analysis.time_response.references import expanded, of_quotient, written

QUOTIENTS = {
    "critically damped": ([1], expanded([1, 3], [1, 3])),
    "undamped": ([1], [1, 0, 9]),
    "three integrators": ([1, 1], [1, 0, 0, 0]),
    "rigid body and mode": ([1, 0.2, 5], expanded([1, 0], [1, 0], [1, 0.1, 40])),
    "unstable oscillation": ([1, 0], [1, -0.3, 25]),
    "triple pair": ([3], expanded([1, 0.2, 4], [1, 0.2, 4], [1, 0.2, 4])),
    "undamped double pair": ([1, 1], expanded([1, 0, 4], [1, 0, 4])),
    "poles that nearly meet": ([1], expanded([1, 1], [1, 1.0000001])),
    "far apart": ([1], expanded([1, 1000], [1, 0.01])),
}
TIMES = [0.0, 0.1, 1.0, 6.0]


@pytest.mark.parametrize("name", QUOTIENTS)
def test_a_response_holds_what_a_matrix_exponential_gives(name):
    num, den = QUOTIENTS[name]
    bound = rational(f"({written(num)})/({written(den)})")
    for kind in INTEGRATIONS:
        found = time_response(bound, kind, SampleTimes.of(TIMES))
        expected = of_quotient(num, den, INTEGRATIONS[kind], TIMES)
        largest = max(abs(y) for y in expected)
        assert found.certified, kind
        assert not found.impulses, kind
        for value, radius, y in zip(found.values.tolist(), found.radius.tolist(), expected, strict=True):
            assert abs(mpmath.mpf(value) - y) <= mpmath.mpf(radius) + largest * mpmath.mpf(10) ** -35, kind
            assert radius <= 1e-11 * largest, kind


def test_even_times_give_what_single_times_give():
    bound = rational("(s + 3)/((s^2 + s/5 + 30)*(s + 2)^2)")
    even = time_response(bound, "step", SampleTimes.of(np.linspace(0, 9, 200)))
    single = time_response(bound, "step", SampleTimes.of(np.linspace(0, 9, 200)).one_by_one())
    assert np.all(np.abs(even.values - single.values) <= even.radius + single.radius)


def test_a_chain_of_six_masses_agrees_with_scipy():
    lines = ["symflex = 1"]
    for i in range(1, 7):
        ends = f'["{"ground" if i == 1 else f"x{i - 1}"}", "x{i}"]'
        lines.append(f'elements.m{i} = {{ type = "mass", at = "x{i}", m = "{i} kg" }}')
        lines.append(f'elements.k{i} = {{ type = "spring", between = {ends}, k = "{1000 * i} N/m" }}')
        lines.append(f'elements.b{i} = {{ type = "damper", between = {ends}, b = "{i} N*s/m" }}')
    lines += ['inputs.F = { force = "x6" }', 'outputs.X = "x1"']
    H = loads("\n".join(lines)).transfer_function("X", "F").bind()
    times = np.linspace(0, 20, 1000)
    _, expected = scipy.signal.step(H.to_scipy("state-space"), T=times)
    found = H.step_response(times)
    assert np.max(np.abs(found.values - expected.ravel())) < 1e-11 * np.max(np.abs(expected))


def test_derivatives_of_an_impulse_are_said():
    found = time_response(rational("s^2/(s + 1)"), "impulse", SampleTimes.of([1.0]))
    assert [float(i.weight) for i in found.impulses] == [-1.0, 1.0]  # s^2/(s + 1) = s - 1 + 1/(s + 1)


def test_a_step_at_an_accelerance_is_an_impulse_less_than_the_impulse():
    found = time_response(rational("s^2/(s + 1)"), "step", SampleTimes.of([1.0]))
    assert [float(i.weight) for i in found.impulses] == [1.0]  # s/(s + 1) = 1 - 1/(s + 1)
    assert found.values.tolist() == pytest.approx([-np.exp(-1)])


def test_an_undamped_oscillation_is_known_after_1e300_seconds():
    found = time_response(rational("1/(s^2 + 4)"), "impulse", SampleTimes.of([1e300]))
    with mpmath.workdps(340):
        expected = mpmath.sin(2 * mpmath.mpf(1e300)) / 2
        assert abs(mpmath.mpf(found.values[0]) - expected) <= found.radius[0]


def test_growth_beyond_doubles_is_enclosed_and_refused_as_an_array():
    found = time_response(rational("1/(s - 1)"), "impulse", SampleTimes.of([0.0, 1000.0]))
    assert found.enclosures[1].overlaps(arb(1000).exp())
    with pytest.raises(UsageError, match="SF812"):
        _ = found.values


def test_poles_that_only_constants_bring_together_are_refused():
    text = 'symflex = 1\nparameters = { a = "2", b = "3", c = "5", w = "1 1/s" }\ninputs.u = {}\n'
    text += 'outputs.y = "u/((s + w*exp(a)*exp(b))*(s + w*exp(c)))"'
    H = loads(text).transfer_function("y", "u").bind()
    with pytest.raises(UncertifiedError, match="SF810"):
        H.impulse_response([1e6])


def test_times_that_are_none_are_refused_with_a_sentence():
    for times, said in (
        ([-1.0, 0.0], "begins at t = 0"),
        ([0.0, 2.0, 1.0], "1 s follows 2 s"),
        ([0.0, 0.0], "increase"),
        ([np.nan], "finite"),
        ([np.inf], "finite"),
        ([[0.0, 1.0]], "a list"),
    ):
        found = words(SampleTimes.of, times)
        assert found.startswith("UsageError") and "SF811" in found and said in found, times


def test_no_times_are_no_values():
    assert time_response(rational("1/(s + 1)"), "step", SampleTimes.of([])).values.size == 0


def test_more_digits_are_computed_where_they_are_asked_for():
    found = time_response(rational("1/(s + 1)"), "step", SampleTimes.evenly(Fraction(1), 2), 60)
    with mpmath.workdps(70):
        expected = mpmath.nstr(1 - mpmath.exp(-1), 60)
    assert found.to_json_dict()["value"][1] == expected
    assert ctx.prec == 53


def test_an_unknown_input_is_refused():
    with pytest.raises(UsageError, match="did you mean 'step'"):
        time_response(rational("1/(s + 1)"), "stpe", SampleTimes.of([1.0]))
