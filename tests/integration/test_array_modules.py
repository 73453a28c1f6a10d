"""Modules over libraries of arrays: array-api-strict, numpy and jax compute, compile and differentiate."""

import ast
import types
from functools import cache, partial

import mpmath as mp
import numpy as np
import pytest
from flint import acb

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from tests.unit.codegen.exportable import DERIVATIONS, executed, free_chain
from tests.unit.codegen.test_numpy_distributed import beam, clamped_end_compliance, specification

needs_strict = pytest.mark.needs_module("array_api_strict")
needs_jax = pytest.mark.needs_module("jax")

CHAIN = free_chain(8, b="4 N*s/m", outputs='A = "s^2*x0"\nX = "x7"')

CONSTANT = """
symflex = 1
parameters = { m = "2 kg", k = "50 N/m" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
inputs = { F = { force = "x" }, u = {} }
outputs = { X = "x", gain = "k*u", half = "u/2" }
"""


@cache
def functions_of(name):
    """Return the transfer functions of a derivation, or of a specification given as text."""
    return pipeline.derive_all(
        pipeline.load(DERIVATIONS[name]) if name in DERIVATIONS else pipeline.loads(name)
    )


@cache
def made(name, dialect):
    """Export a derivation, or a specification given as text, and import what comes of it."""
    tfs = functions_of(name)
    text = EXPORTERS[dialect].export(tfs[0].model, tfs, samples=10).text
    return types.SimpleNamespace(**executed(text))


over_numpy = partial(made, dialect="numpy")


@pytest.fixture
def over_any():
    return partial(made, dialect="array-api")


@pytest.fixture
def over_jax(jnp):
    return partial(made, dialect="jax")


@pytest.fixture
def strict():
    import array_api_strict

    return array_api_strict


@pytest.fixture
def jax():
    import jax

    jax.config.update("jax_enable_x64", True)
    yield jax
    jax.clear_caches()  # what every test compiles stayed for good, gigabytes after all of them


@pytest.fixture
def jnp(jax):
    import jax.numpy

    return jax.numpy


# ------------------------------------------------------------------------------------------------ values


@cache
def references(name):
    """Return points over the band and in the plane, and of every function its values and log-derivatives."""
    low, high = (float(f) for f in functions_of(name)[0].model.analysis.band or (0.1, 1e4))
    random = np.random.default_rng(1)
    turned = np.geomspace(low, high, 8) * 2 * np.pi * np.exp(1j * random.uniform(0, 2 * np.pi, 8))
    s = np.concatenate([2j * np.pi * np.geomspace(low, high, 30), turned, [1e-6j, -1e-6 + 1e-6j]])
    found = {}
    for tf in functions_of(name):
        bound = pipeline.bind(tf)
        enclosed = bound.enclosed(512)
        slopes = [complex(enclosed.logarithmic_derivative(acb(z.real, z.imag))) for z in s]
        found[tf.name] = np.array([bound(complex(z)) for z in s]), np.array(slopes)
    return s, found


def error(computed, name, function, where=slice(None)):
    """Return the worst relative error beyond what one rounding of s causes."""
    s, found = references(name)
    value, slope = (x[where] for x in found[function])
    return np.max(np.abs(np.asarray(computed) - value) / np.abs(value) / (1 + np.abs(s[where] * slope)))


ON_AXIS = slice(0, 30)
LONG = pytest.param("timoshenko_cantilever", marks=pytest.mark.slow)


@needs_strict
@pytest.mark.parametrize("name", ["rod_tip_mass", LONG])
def test_array_api_strict_agrees_with_ball_arithmetic(name, over_any, strict):
    module, (s, found) = over_any(name), references(name)
    for key in found:
        computed = module.TRANSFER_FUNCTIONS[key](strict.asarray(s))
        assert type(computed) is type(strict.asarray(s))
        assert error(computed, name, key) < 1e-13
        if key in getattr(module, "FREQUENCY_RESPONSES", {}):
            response = np.asarray(module.FREQUENCY_RESPONSES[key](strict.asarray(s.imag)))
            assert error(response[ON_AXIS], name, key, ON_AXIS) < 1e-13


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize("name", ["two_mass", "sliding_free_beam", "timoshenko_cantilever"])
def test_jax_agrees_with_ball_arithmetic_compiled_or_not(name, over_jax, jax, jnp):
    module, (s, found) = over_jax(name), references(name)
    for key in [*found][:2]:
        eager = module.TRANSFER_FUNCTIONS[key](jnp.asarray(s))
        assert error(eager, name, key) < 1e-13
        if key in getattr(module, "FREQUENCY_RESPONSES", {}):
            # Of the same shape as s: jax compiles every operation once for each shape.
            response = np.asarray(module.FREQUENCY_RESPONSES[key](jnp.asarray(s.imag)))
            assert error(response[ON_AXIS], name, key, ON_AXIS) < 1e-13
    compiled = jax.jit(module.TRANSFER_FUNCTIONS[key])(s)
    assert np.max(np.abs(np.asarray(compiled) / np.asarray(eager) - 1)) < 1e-11


@pytest.mark.slow
def test_numpy_s_arrays_get_what_the_numpy_module_gives(over_any):
    s = np.concatenate([1j * np.logspace(-9, 12, 60), 10.0 ** np.arange(-3, 6) * np.exp(2j)])
    for name in ("rod_tip_mass", "shaft_discs", CHAIN):
        for key, function in over_any(name).TRANSFER_FUNCTIONS.items():
            expected = over_numpy(name).TRANSFER_FUNCTIONS[key](s)
            near = np.abs(s) < 1e5
            assert np.all(np.isfinite(function(s)))
            assert np.max(np.abs(function(s) / expected - 1)[near]) < 1e-9


def test_a_chain_of_eight_masses_neither_over_nor_underflows(over_any):
    s = np.concatenate([1j * np.logspace(-9, 13, 50), 10.0 ** np.arange(5, 14)])
    for tf in functions_of(CHAIN):
        bound = pipeline.bind(tf)
        expected = np.array([bound(complex(z)) for z in s])
        assert np.max(np.abs(over_any(CHAIN).TRANSFER_FUNCTIONS[tf.name](s) / expected - 1)) < 1e-12


# --------------------------------------------------------------------------------- libraries of arrays


def test_numbers_alone_give_a_number(over_any):
    value = over_any("rod_tip_mass").X_tip_over_F(3j, m=2)
    assert type(value) is complex
    assert value == over_any("rod_tip_mass").X_tip_over_F(np.array([3j]), m=2)[0]


@needs_strict
def test_the_library_can_be_given(over_any, strict):
    value = over_any("two_mass").X_tip_over_F(3j, xp=strict)
    assert type(value) is type(strict.asarray(1.0))
    assert value.shape == ()


@needs_strict
def test_the_library_is_found_from_a_parameter(over_any, strict):
    value = over_any("two_mass").X_tip_over_F(3j, m_1=strict.asarray([1.0, 2.0, 3.0]))
    assert type(value) is type(strict.asarray(1.0))
    assert value.shape == (3,)


@needs_strict
def test_values_stay_on_the_device_of_the_arguments(over_any, strict):
    device = strict.Device("device1")
    for name in ("two_mass", "rod_tip_mass"):
        for function in over_any(name).TRANSFER_FUNCTIONS.values():
            assert function(strict.asarray([1e-3j, 3j, 1e4j], device=device)).device == device


@needs_strict
@pytest.mark.slow
@needs_jax
def test_arrays_of_two_libraries_are_refused(over_any, strict, jnp):
    with pytest.raises(TypeError, match="together"):
        over_any("two_mass").X_tip_over_F(strict.asarray(1j), k=jnp.asarray(2.0))


@needs_strict
def test_arrays_of_numpy_go_with_any_library(over_any, strict):
    value = over_any("two_mass").X_tip_over_F(strict.asarray(1j), k=np.array([2.0, 3.0]))
    assert type(value) is type(strict.asarray(1.0))


def test_what_is_neither_number_nor_array_is_refused(over_any):
    for value in (None, "1", [1.0], object()):
        with pytest.raises(TypeError, match="numbers or arrays"):
            over_any("two_mass").X_tip_over_F(1j, k=value)


def test_a_complex_frequency_is_refused_by_a_response_in_real_arithmetic(over_any):
    with pytest.raises(TypeError, match="real"):
        over_any("rod_tip_mass").X_tip_over_F_at(1j)


@needs_strict
def test_other_types_of_numbers_become_double_precision(over_any, strict):
    for dtype in ("float32", "complex64", "int32"):
        value = over_any("two_mass").X_tip_over_F(strict.asarray([2], dtype=getattr(strict, dtype)))
        assert value.dtype == strict.complex128, dtype
        assert complex(value[0]) == over_any("two_mass").X_tip_over_F(2.0), dtype


@pytest.mark.parametrize("name", ["two_mass", "rod_tip_mass"])
def test_s_and_every_parameter_are_broadcast_together(name, over_any):
    s = 1j * np.logspace(0, 4, 5)
    for key, function in over_any(name).TRANSFER_FUNCTIONS.items():
        (first, one), (second, two) = list(over_any(name).PARAMETERS.items())[:2]
        given = {first: one["value"] * np.array([[1.0], [2.0]]), second: two["value"] * np.ones((3, 1, 1))}
        expected = over_numpy(name).TRANSFER_FUNCTIONS[key](s, **given)
        assert function(s, **given).shape == (3, 2, 5)
        assert np.allclose(function(s, **given), expected, rtol=1e-12, atol=0)


def test_shapes_that_do_not_go_together_are_refused(over_any):
    with pytest.raises(ValueError, match="shape"):
        over_any(CONSTANT).gain_over_u(np.ones(2), k=np.ones(3))


def test_empty_arrays_give_empty_arrays(over_any):
    for name in ("two_mass", "rod_tip_mass"):
        for function in over_any(name).TRANSFER_FUNCTIONS.values():
            assert function(np.zeros((0, 3))).shape == (0, 3)


@needs_strict
def test_constants_have_the_shape_of_all_arguments(over_any, strict):
    module, s = over_any(CONSTANT), strict.asarray([1j, 2j])
    assert np.asarray(module.gain_over_u(s)).tolist() == [50, 50]
    k = strict.asarray([[1.0], [2.0], [3.0]])
    assert np.asarray(module.gain_over_u(s, k=k)).tolist() == [[1, 1], [2, 2], [3, 3]]
    assert np.asarray(module.half_over_u(s)).tolist() == [0.5, 0.5]
    assert np.asarray(module.X_over_u(s)).tolist() == [0, 0]


def test_the_response_at_negative_frequencies_is_conjugate(over_any):
    omega = np.array([-300.0, -1e-3, 1e-3, 300.0])
    value = over_any("rod_tip_mass").X_tip_over_F_at(omega)
    assert np.all(value[:2] == np.conj(value[:1:-1]))


# -------------------------------------------------------------------------------------------------- jax


@pytest.mark.slow
@needs_jax
def test_the_array_api_module_can_be_compiled_by_jax(over_any, jax, jnp):
    function = over_any("rod_tip_mass").X_tip_over_F
    s = jnp.asarray(1j * np.logspace(-6, 5, 20))
    assert np.allclose(jax.jit(function)(s), function(s), rtol=1e-11, atol=0)


@needs_jax
@pytest.mark.slow
def test_the_derivative_by_s_agrees_with_ball_arithmetic(over_jax, jax):
    s, found = references("rod_tip_mass")
    value, slope = found["X_tip/F"]
    derivative = jax.grad(over_jax("rod_tip_mass").TRANSFER_FUNCTIONS["X_tip/F"], holomorphic=True)
    computed = np.asarray(jax.jit(jax.vmap(derivative))(s))
    # Where G' itself is nearly zero what counts is G/s.
    size = np.abs(value) * np.maximum(np.abs(slope), np.abs(1 / s)) * (1 + np.abs(s * slope))
    assert np.max(np.abs(computed - value * slope) / size) < 1e-12


ROD = {"E": "200e9", "A": "0.00048", "rho": "7850", "l": "1", "m": "3"}


@pytest.mark.slow
@needs_jax
@pytest.mark.parametrize("omega", [1e-3, 3e4])
def test_the_derivative_of_a_rod_by_its_parameters_is_that_of_the_formula(omega, over_jax, jax, jnp):
    # Rao 2007, chapter 9: 1/(E A g coth(g l) + m s^2), g = s sqrt(rho/E).
    def exact(**changed):
        p = {n: changed.get(n, mp.mpf(v)) for n, v in ROD.items()}
        s = mp.mpc(0, omega)
        g = s * mp.sqrt(p["rho"] / p["E"])
        return mp.log(abs(1 / (p["E"] * p["A"] * g * mp.coth(g * p["l"]) + p["m"] * s**2)))

    def level(parameters):
        return jnp.log(jnp.abs(over_jax("rod_tip_mass").X_tip_over_F(1j * omega, **parameters)))

    computed = jax.grad(level)({n: float(v) for n, v in ROD.items()})
    with mp.workdps(60):
        for name, text in ROD.items():
            center = mp.mpf(text)
            step = center * mp.mpf(10) ** -20
            slope = (exact(**{name: center + step}) - exact(**{name: center - step})) / (2 * step)
            swing = 1 + omega * np.sqrt(7850 / 200e9)
            # Relative to 1/p: what a relative change of the parameter does to the logarithm.
            assert abs(float(computed[name]) - float(slope)) * float(center) < 1e-11 * swing


@pytest.mark.slow
@needs_jax
def test_the_derivative_by_an_axial_force_is_that_of_the_boundary_value_problem(over_jax, jax):
    function, s = over_jax(specification("tension")).X_over_F, 300j
    derivative = jax.jit(jax.jacfwd(lambda n: function(s, N=n)))
    for force in ("0", "1e-6", "500"):
        with mp.workdps(60):
            ends = [
                clamped_end_compliance(beam(mp.mpc(s), n=mp.mpf(force) + step, k_f="1000"))
                for step in (mp.mpf("1e-20"), mp.mpf("-1e-20"))
            ]
            slope = complex((ends[0] - ends[1]) / mp.mpf("2e-20"))
        assert complex(derivative(float(force))) == pytest.approx(slope, rel=1e-12), force


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "function"), [("sliding_free_beam", "V_act_over_F"), ("two_mass", "X_tip_over_F")]
)
def test_derivatives_are_finite_wherever_values_are(name, function, over_jax, jax, jnp):
    module = over_jax(name)
    given = getattr(module, function)
    random = np.random.default_rng(2)
    s = np.concatenate(
        [10.0 ** random.uniform(-9, 9, 40) * np.exp(1j * random.uniform(0, 7, 40)), [1e-9j, 1e12j]]
    )
    parameters = {n: p["value"] * 10 ** random.uniform(-3, 3, len(s)) for n, p in module.PARAMETERS.items()}

    def size(parameters, s):
        return jnp.abs(given(s, **parameters))

    values, slopes = jax.jit(jax.vmap(jax.value_and_grad(size)))(parameters, s)
    has_value = np.isfinite(values) & (np.asarray(values) > 1e-290)
    assert np.count_nonzero(has_value) > 30
    for slope in slopes.values():
        assert np.all(np.isfinite(np.asarray(slope)[has_value]))


@needs_jax
@pytest.mark.slow
def test_the_derivative_at_rest_is_finite(over_jax, jax, jnp):
    module = over_jax("rod_tip_mass")
    value, slope = jax.value_and_grad(lambda x: jnp.real(module.X_tip_over_F(0.0, l=x)))(1.0)
    assert float(value) == pytest.approx(1 / (200e9 * 0.00048), rel=1e-15)
    assert float(slope) == pytest.approx(1 / (200e9 * 0.00048), rel=1e-15)


@pytest.mark.slow
@needs_jax
def test_functions_are_mapped_over_parameters(over_jax, jax):
    given = over_jax("two_mass").X_tip_over_F
    values = np.array([30.0, 60.0, 420.0])
    mapped = jax.vmap(lambda p, s: given(s, m_1=p), in_axes=(0, None))(values, 40j)
    assert np.allclose(mapped, over_numpy("two_mass").X_tip_over_F(40j, m_1=values), rtol=1e-12, atol=0)


@pytest.mark.slow
@needs_jax
def test_a_response_in_real_arithmetic_is_differentiated_by_frequency(over_jax, jax, jnp):
    module, omega = over_jax("sliding_free_beam"), 200.0
    found = jax.jvp(module.V_act_over_F_at, (omega,), (1.0,))[1]
    expected = 1j * jax.grad(module.V_act_over_F, holomorphic=True)(jnp.asarray(1j * omega))
    assert complex(found) == pytest.approx(complex(expected), rel=1e-11)


@pytest.mark.slow
@needs_jax
def test_single_precision_is_told_of(over_jax, jax):
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.warns(UserWarning, match="is not available"):
            over_jax("two_mass").X_tip_over_F(1j)
    finally:
        jax.config.update("jax_enable_x64", True)


# --------------------------------------------------------------------------------------------- the text


@pytest.mark.slow
def test_a_module_imports_what_it_is_for_only():
    wanted = {
        "array-api": {"__future__", "cmath", "importlib", "sys", "typing"},
        "jax": {"__future__", "cmath", "jax", "math"},
    }
    tfs = functions_of("timoshenko_cantilever")[:1]
    for dialect, roots in wanted.items():
        text = EXPORTERS[dialect].export(tfs[0].model, tfs, samples=2).text
        found = set()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Import):
                found |= {alias.name.split(".")[0] for alias in node.names}
            if isinstance(node, ast.ImportFrom):
                found.add(node.module.split(".")[0])
        assert found == roots, dialect
        assert " np." not in text, dialect


def test_the_docstring_says_whose_arithmetic_was_verified():
    tfs = functions_of("two_mass")[:1]
    text = " ".join(EXPORTERS["array-api"].export(tfs[0].model, tfs, samples=5).text.split())
    assert "against ball arithmetic" in text
    assert "The error is that of the same operations in numpy" in text
