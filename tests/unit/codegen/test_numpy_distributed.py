"""Exported functions of distributed systems against boundary-value problems solved by mpmath in 60 digits."""

from __future__ import annotations

import itertools
import math
import types
from functools import cache

import mpmath as mp
import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.program.evaluate import evaluate
from symflex.codegen.program.verify import doubles
from symflex.codegen.python.module import NUMPY
from symflex.transfer import bind
from tests.unit.codegen import exportable
from tests.unit.codegen.exportable import program_of

BEAM = f'{exportable.BEAM}, l = "l"'
BEAMS = {
    "sliding_free": (
        exportable.BAR,
        f'arm = {{ between = ["p", "q"], {BEAM} }}\nslide = {{ type = "slider", at = "p" }}',
        'F = { force = "p" }',
        'V_act = "s*p"\nV_tip = "s*q"',
    ),
    "tip_mass": (
        exportable.BAR + 'm = "0.2 kg"\n',
        f'arm = {{ between = ["ground", "q"], {BEAM} }}\nload = {{ type = "mass", at = "q", m = "m" }}',
        'F = { force = "q" }',
        'X = "q"',
    ),
    "rod_tip_mass": (
        exportable.BAR + 'm = "0.2 kg"\n',
        'bar = { type = "rod", between = ["ground", "x"], E = "E", A = "A", rho = "rho", l = "l" }\n'
        'load = { type = "mass", at = "x", m = "m" }',
        'F = { force = "x" }',
        'X = "x"',
    ),
    "timoshenko": (
        exportable.BAR + 'G = "26 GPa"\nkappa = 0.85\n',
        f'arm = {{ between = ["ground", "q"], theory = "timoshenko", kappa = "kappa", G = "G", {BEAM} }}',
        'F = { force = "q" }',
        'X = "q"',
    ),
    "kelvin_voigt": (
        exportable.BAR + 'eta = "20 us"\n',
        f'arm = {{ between = ["ground", "q"], eta = "eta", {BEAM} }}',
        'F = { force = "q" }',
        'X = "q"',
    ),
}
SPECS = (*BEAMS, "two_beams", "tension")
POINTS = [1e-9j, 0.3j, 70j, 5e3j, 1e5j, 1e-3 + 1e-4j, -40 + 90j, 6e4 - 4e4j]


def specification(name):
    if name not in BEAMS:
        return exportable.SPECS[name]
    parameters, elements, inputs, outputs = BEAMS[name]
    return (
        f"symflex = 1\n[parameters]\n{parameters}\n[elements]\n{elements}\n"
        f"[inputs]\n{inputs}\n[outputs]\n{outputs}\n"
    )


SENSOR = f"""
symflex = 1
[parameters]
{exportable.BAR}
x_s = "0.31 m"
[inputs]
F = {{}}
[fields.w]
domain = ["0", "l"]
equation = "E*I*w'''' + rho*A*s^2*w = 0"
conditions = ["w'(0) = 0", "E*I*w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
[outputs]
V_mid = "s*w(l/2)"
V_s = "s*w(x_s)"
"""


@cache
def functions_of(text):
    """Return the transfer functions of a specification."""
    return pipeline.derive_all(pipeline.loads(text))


@cache
def module(text):
    """Return what is exported of a specification."""
    tfs = functions_of(text)
    return types.SimpleNamespace(**exportable.executed(NUMPY.export(tfs[0].model, tfs, samples=10).text))


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(60):
        yield


# ------------------------------------------------------------------------------ independent solutions


def beam(s, i="1e-8", length="1", eta="0", n="0", k_f="0", shear=None):
    """Return the transfer matrix of (w, theta, f, tau): the exponential of the field equations' matrix."""
    e = mp.mpf("70e9") * (1 + mp.mpf(eta) * s)
    ei, rho, a = e * mp.mpf(i), mp.mpf(2700), mp.mpf("1e-4")
    stiffness = 0 if shear is None else 1 / (mp.mpf("0.85") * mp.mpf("26e9") * a)
    rotary = 0 if shear is None else rho * mp.mpf(i) * s**2
    field = mp.matrix(
        [
            [0, 1, stiffness, 0],
            [0, 0, 0, 1 / ei],
            [rho * a * s**2 + mp.mpf(k_f), 0, 0, 0],
            [0, mp.mpf(n) + rotary, -1, 0],
        ]
    )
    return mp.expm(field * mp.mpf(length), method="taylor")


def clamped_end_compliance(t, dynamic=0):
    """Return the end's deflection per unit force, of a clamped beam; ``dynamic``: a mass times s^2."""
    # w, theta, f, tau at the end from f, tau at the root; tau = 0 and f = F - dynamic*w.
    block = mp.matrix([[t[2, 2] + dynamic * t[0, 2], t[2, 3] + dynamic * t[0, 3]], [t[3, 2], t[3, 3]]])
    root = mp.lu_solve(block, mp.matrix([1, 0]))
    return t[0, 2] * root[0] + t[0, 3] * root[1]


def sliding_free(s):
    t = beam(s)
    # Unknown w(0), tau(0); theta(0) = 0; at the end f = tau = 0, at the start f(0) = -F.
    block = mp.matrix([[t[2, 0], t[2, 3]], [t[3, 0], t[3, 3]]])
    w, tau = mp.lu_solve(block, mp.matrix([t[2, 2], t[3, 2]]))
    return s * w, s * (t[0, 0] * w - t[0, 2] + t[0, 3] * tau)


def rod_tip_mass(s):
    e, rho, a, m = mp.mpf("70e9"), mp.mpf(2700), mp.mpf("1e-4"), mp.mpf("0.2")
    g = s * mp.sqrt(rho / e)
    return 1 / (e * a * g * mp.coth(g) + m * s**2)


def sensor(s, x):
    t, part = beam(s), beam(s, length=x)
    block = mp.matrix([[t[2, 0], t[2, 3]], [t[3, 0], t[3, 3]]])
    w, tau = mp.lu_solve(block, mp.matrix([t[2, 2], t[3, 2]]))
    return s * (part[0, 0] * w - part[0, 2] + part[0, 3] * tau)


EXPECTED = {
    "sliding_free": sliding_free,
    "tip_mass": lambda s: clamped_end_compliance(beam(s), mp.mpf("0.2") * s**2),
    "rod_tip_mass": rod_tip_mass,
    "timoshenko": lambda s: clamped_end_compliance(beam(s, shear=True)),
    "kelvin_voigt": lambda s: clamped_end_compliance(beam(s, eta="2e-5")),
    "two_beams": lambda s: clamped_end_compliance(beam(s, i="3e-8", length="0.3") * beam(s)),
    "tension": lambda s: clamped_end_compliance(beam(s, n="500", k_f="1000")),
}


def relative_errors(function, expected, points=POINTS):
    """Return errors beyond what a rounding of s causes, from the reference's own slope."""
    found = []
    for s in points:
        exact, step = mp.mpc(complex(s)), mp.mpf(10) ** -20
        value = expected(exact)
        swing = abs((expected(exact * (1 + step)) / value - 1) / step)
        found.append(float(abs(mp.mpc(complex(function(s))) / value - 1) / (1 + swing)))
    return found


@pytest.mark.parametrize("name", [n for n in SPECS if n != "sliding_free"])
@pytest.mark.slow
def test_an_exported_function_agrees_with_the_boundary_value_problem(name):
    made, points = module(specification(name)), POINTS if name in ("two_beams", "tension") else POINTS[::2]
    assert max(relative_errors(made.X_over_F, EXPECTED[name], points)) < 1e-14
    # At rest it is the static compliance.
    static = float(abs(EXPECTED[name](mp.mpf(10) ** -25)))
    assert made.X_over_F(0.0) == pytest.approx(static, rel=1e-14)
    if name in ("tip_mass", "two_beams"):
        assert made.X_over_F_at(np.array([0.0, 1e-6]))[0] == pytest.approx(static, rel=1e-14)


@pytest.mark.slow
def test_the_sliding_free_beam_agrees_with_its_boundary_value_problem():
    made = module(specification("sliding_free"))
    for output, name in enumerate(("V_act", "V_tip")):
        function, response = (getattr(made, f"{name}_over_F{at}") for at in ("", "_at"))
        assert max(relative_errors(function, lambda s, k=output: sliding_free(s)[k], POINTS[::2])) < 1e-14
        points = [1j * w for w in (1e-9, 0.3, 70.0, 6e3, 1e5)]
        errors = relative_errors(
            lambda s, r=response: r(s.imag), lambda s, k=output: sliding_free(s)[k], points
        )
        assert max(errors) < 2e-15


@pytest.mark.slow
def test_a_sensor_inside_agrees_with_the_boundary_value_problem():
    for name, x in (("V_mid_over_F", "0.5"), ("V_s_over_F", "0.31")):
        function = getattr(module(SENSOR), name)
        assert max(relative_errors(function, lambda s, x=x: sensor(s, x), POINTS[::3])) < 1e-14


def test_a_delay_in_a_loop_agrees_with_its_formula():
    def expected(s):
        return 1 / (2 * s**2 + 5 * s * mp.exp(-s * mp.mpf("0.005")) + 300)

    assert max(relative_errors(module(exportable.DELAY).X_over_F, expected)) < 1e-14


def test_a_delay_neither_over_nor_underflows_far_from_the_axis():
    for s in (-1e7, -1e12, 1e7, 1e12, -1e9 + 1e9j):
        assert np.isfinite(module(exportable.DELAY).X_over_F(s)), s


LOSSLESS = ("sliding_free", "tip_mass", "rod_tip_mass", "two_beams")


def responses(names=LOSSLESS):
    """Return name, response in real arithmetic and function of s of everything without damping."""
    for name in names:
        made = module(specification(name))
        assert made.FREQUENCY_RESPONSES
        for key, response in made.FREQUENCY_RESPONSES.items():
            yield name, response, made.TRANSFER_FUNCTIONS[key]


@pytest.mark.parametrize("name", LOSSLESS)
def test_real_arithmetic_gives_the_response_on_the_axis(name):
    omega = np.concatenate([np.logspace(-9, 12, 85), np.logspace(0, 4, 60)])
    for key, response, function in responses([name]):
        found, other = response(omega), function(1j * omega)
        near = np.abs(omega) < 1e5
        assert np.all(np.isfinite(found)), key
        assert np.median(np.abs(found - other)[near] / np.abs(other)[near]) < 1e-14, key


def test_responses_at_frequencies_of_both_signs_are_conjugate():
    omega = np.concatenate([np.logspace(-3, 5, 40), -np.logspace(-3, 5, 40)])
    for name, response, _ in responses():
        values = response(omega)
        assert np.all(values[40:] == np.conj(values[:40])), name
        assert response(-25.0) == np.conj(response(25.0)), name


def test_an_array_gives_in_real_arithmetic_what_its_numbers_give():
    omega = np.array([-3e4, -70.0, -0.01, 0.02, 5.0, 300.0, 1e5])
    for name, response, _ in responses():
        one_by_one = np.array([response(float(w)) for w in omega])
        assert np.allclose(response(omega), one_by_one, rtol=1e-13, atol=0.0), name


def test_real_arithmetic_raises_nothing_whatever_numpy_is_told_about_errors():
    omega = np.concatenate([np.logspace(-9, 12, 64), -np.logspace(-9, 12, 64), [0.0, -0.0]])
    with np.errstate(all="raise"):
        for name, response, _ in responses():
            assert not np.any(np.isnan(response(omega))), name


def test_a_lossy_system_has_no_response_in_real_arithmetic():
    assert module(specification("kelvin_voigt")).FREQUENCY_RESPONSES == {}


def test_parameters_and_frequencies_are_broadcast_together():
    response = module(specification("sliding_free")).V_act_over_F_at
    omega, lengths = np.logspace(-3, 4, 9), np.array([[0.2], [1.0], [3.0]])
    values = response(omega, l=lengths)
    expected = np.array([[response(float(w), l=float(length)) for w in omega] for length in lengths[:, 0]])
    assert np.allclose(values, expected, rtol=1e-13, atol=0.0)


def test_one_frequency_serves_for_an_array_of_parameters():
    response = module(specification("sliding_free")).V_act_over_F_at
    values = response(-25.0, rho=np.array([1000.0, 2700.0]))
    assert values[1] == pytest.approx(response(-25.0), rel=1e-14)


@pytest.mark.parametrize("name", SPECS)
def test_functions_are_finite_from_1e_minus_9_to_1e12_whatever_numpy_is_told_about_errors(name):
    sizes = np.logspace(-9, 12, 64)
    functions = module(specification(name)).TRANSFER_FUNCTIONS.values()
    for turn, function in itertools.product((1j, 1, -1, 1 + 1j, -1 + 1j), functions):
        with np.errstate(all="raise"):
            assert np.all(np.isfinite(function(sizes * turn / abs(turn)))), turn


def test_parameters_and_s_are_broadcast_together():
    function = module(specification("tip_mass")).X_over_F
    s, m = 1j * np.logspace(-2, 4, 7), np.array([[0.1], [0.2], [5.0]])
    values = function(s, m=m)
    assert values.shape == (3, 7)
    assert values[2, 4] == pytest.approx(function(s[4], m=5.0), rel=1e-15)


def test_a_number_gives_a_number():
    assert type(module(specification("tip_mass")).X_over_F(3j)) is complex


def test_blocks_do_not_show():
    function = module(specification("tip_mass")).X_over_F
    s = 1j * np.logspace(-3, 5, 50_001)
    values = function(s)
    assert np.all(values[::5000] == np.array([function(s[k : k + 1])[0] for k in range(0, 50_001, 5000)]))


def test_complex_stiffness_serves_at_high_frequencies():
    function = module(specification("sliding_free")).V_act_over_F
    assert np.all(np.isfinite(function(1j * np.logspace(-9, 12, 60), E=70e9 * (1 + 0.1j))))


@pytest.mark.slow
def test_arguments_of_a_pair_that_meet_are_no_singularity():
    # lambda_1 = lambda_2 = 50/m where N^2 = 4 EI (rho A s^2 + k_f): on the real axis.
    text = specification("tension").replace('N = "500 N"', 'N = "3.5 MN"')
    meeting = math.sqrt((3.5e6**2 / (4 * 70e9 * 1e-8) - 1000) / (2700 * 1e-4))

    def expected(s):
        return clamped_end_compliance(beam(s, n="3.5e6", k_f="1000"))

    points = [meeting * (1 + d) for d in (0.0, 1e-12, 1e-8, 1e-4, 1e-3)]
    assert max(relative_errors(module(text).X_over_F, expected, points)) < 1e-14


@pytest.mark.parametrize("name", ["sliding_free", "two_beams", "tension"])
def test_the_interpreter_computes_what_the_module_does(name):
    s = 1j * np.logspace(-6, 6, 30)
    for tf in functions_of(specification(name)):
        module_values = module(specification(name)).TRANSFER_FUNCTIONS[tf.name](s)
        own = evaluate(program_of(tf), s, doubles(bind(tf)))
        assert np.max(np.abs(own - module_values) / np.abs(module_values)) < 1e-11


# ------------------------------------------------------------------ exponents without closed form

PIPE = exportable.PIPE.replace('band = ["0.1 Hz", "20 Hz"]', 'band = ["0.1 Hz", "1 Hz"]')


def _column_under_load() -> float:
    # EI w'''' + P w'' = 1, pinned: w = (cos(k(x - l/2))/cos(kl/2) - 1)/(P k^2) + x(x - l)/(2P), P = k^2 EI
    force, stiffness, length = 25.0, 100.0, 2.0
    k = np.sqrt(force / stiffness)
    middle = (1.0 / np.cos(k * length / 2) - 1.0) / (force * k**2)
    return float(middle - length**2 / (8.0 * force))


@pytest.mark.slow
def test_a_pipe_with_flow_deflects_at_rest_as_a_compressed_column() -> None:
    for s in (0.0, 1e-9j, 1e-6j, -1e-9, 1e-6 + 1e-6j):
        assert abs(module(PIPE).Y_over_p(s) / _column_under_load() - 1) < 1e-12, s


@pytest.mark.slow
def test_numbers_and_arrays_give_the_same_where_equations_are_solved() -> None:
    pipe = module(PIPE).Y_over_p
    for s in (0.0, 1e-9j, 1j, 30j, 100j, 1e3j):
        assert pipe(s) == pytest.approx(pipe(np.array([s, 1j, 50j]))[0], rel=1e-12), s


COMPRESSED = """
symflex = 1
[parameters]
EI = "1 N*m^2"
m = "1 kg/m"
P = "400 N"
c = "1e-3 N*s/m"
l = "1 m"
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + P*w'' + c*s*w' + m*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*w'''(l) + P*w'(l) = -F"]
[inputs]
F = { unit = "N" }
[outputs]
Y = "w(l)"
"""


@pytest.mark.slow
def test_roots_that_nearly_meet_cost_no_digits() -> None:
    # x^4 + 400 x^2 + s^2 has double roots at s = 200, which c takes apart a little: exponents of size 14.
    (tf,) = functions_of(COMPRESSED)
    bound = bind(tf)
    s = np.array([200.0, 200.0001, 199.9 + 0.05j, 201.0, 190 - 3j, 260.0])
    found = evaluate(program_of(tf), s, doubles(bound))
    assert np.max(np.abs(found / np.array([bound(complex(x)) for x in s]) - 1)) < 1e-11


def test_a_column_with_a_drag_has_the_values_of_its_function() -> None:
    (tf,) = pipeline.derive_all(pipeline.loads(COMPRESSED.replace("400 N", "4 N")))
    bound = bind(tf)
    s = np.array([0.0, 1e-6j, 0.3j, -0.2 + 2j, 6j])
    found = evaluate(program_of(tf), s, doubles(bound))
    expected = np.array([bound(complex(x)) for x in s])
    assert np.max(np.abs(found / expected - 1)) < 1e-11


def test_roots_that_are_equal_at_every_s_are_no_obstacle() -> None:
    (tf,) = pipeline.derive_all(pipeline.loads(exportable.MASSLESS))
    s = np.array([0.0, 1j, 10j, 40j, 100j, 3 - 2j])
    program = program_of(tf)
    # A beam without mass under tension is a spring: w(l)/F = (l - tanh(k l)/k)/N with k^2 = N/EI.
    k = math.sqrt(1.0 / 4e-3)
    compliance = 1.0 - math.tanh(k) / k
    expected = compliance / (1.0 + 0.1 * compliance * s**2)
    assert np.max(np.abs(evaluate(program, s, doubles(bind(tf))) / expected - 1)) < 1e-9


JOINED = COMPRESSED.replace('c = "1e-3 N*s/m"', 'c = "1e-3 N*s/m"\nl_2 = "0.05 m"').replace(
    '[fields.w]\ndomain = ["0", "l"]', '[fields.w]\ndomain = ["0", "l + l_2"]'
)


@pytest.mark.slow
def test_lengths_given_at_run_time_need_not_be_like_the_declared_ones() -> None:
    text = JOINED.replace("w''(l)", "w''(l + l_2)").replace("w'''(l)", "w'''(l + l_2)")
    text = text.replace("P*w'(l)", "P*w'(l + l_2)").replace('Y = "w(l)"', 'Y = "w(l_2)"')
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    s = np.array([0.5j, 2.1j, 30j, 5 + 9j])
    for length in (0.05, 1.0, 4.0):
        bound = bind(tf, {"l_2": length})
        found = evaluate(program_of(tf), s, doubles(bound))
        expected = np.array([bound(complex(x)) for x in s])
        assert np.max(np.abs(found / expected - 1)) < 1e-10, length


STATIC = """
symflex = 1
[fields.w]
domain = ["0", "1"]
equation = "w'~~~ - 100*w'' + s*w' + s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(1) = 0", "w~~~(1) - 100*w'(1) = -F"]
[inputs]
F = {}
[outputs]
Y = "w(1)"
""".replace("~~~", 3 * "'")


def test_large_static_exponents_do_not_spoil_the_value_at_rest() -> None:
    (tf,) = pipeline.derive_all(pipeline.loads(STATIC))
    found = evaluate(program_of(tf), np.array([0.0, 1e-12j, -1e-11]), {})
    # A beam under tension: w(1)/F = (1 - tanh(10)/10)/100.
    assert np.max(np.abs(found / ((1.0 - math.tanh(10.0) / 10.0) / 100.0) - 1)) < 1e-10
