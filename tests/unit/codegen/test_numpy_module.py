"""The generated module: imported from a file, called as a user would, compared with ball arithmetic."""

import ast
import importlib.util
import inspect
import os
import pickle
import subprocess
import sys
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.program.evaluate import evaluate
from symflex.codegen.program.verify import choose_programs
from symflex.codegen.python.module import NUMPY
from symflex.errors import ModelError
from tests.unit.codegen.exportable import free_chain

ROOT = Path(__file__).parents[3]
DERIVATIONS = ROOT / "derivations" / "eppinger1988"

SYMBOLIC = """
symflex = 1
parameters = { m = "2 kg", b = { doc = "friction" }, k = "50 N/m" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.loss = { type = "damper", between = ["x", "ground"], b = "b" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
inputs = { F = { force = "x" }, u = {} }
outputs = { X = "x", gain = "k*u" }
"""


SAMPLES = 10


def exported(model):
    return NUMPY.export(model, pipeline.derive_all(model), samples=SAMPLES)


@cache
def exported_text(spec):
    return exported(pipeline.load(spec)).text


def imported(text, folder, name="generated"):
    path = folder / f"{name}.py"
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("generated")


@pytest.fixture(scope="module")
def two_mass(folder):
    return imported(exported_text(DERIVATIONS / "two_mass.toml"), folder, "two_mass")


@pytest.fixture(scope="module")
def symbolic(folder):
    return imported(exported(pipeline.loads(SYMBOLIC)).text, folder, "symbolic")


# ------------------------------------------------------------------------------------------------ values


@pytest.mark.parametrize("name", ["two_mass", "rigid_body", "sliding_free_beam"])
def test_the_text_computes_exactly_what_was_verified(name, folder):
    """Bit for bit; programs are compared with balls in ``test_program_verify.py``."""
    spec = DERIVATIONS / f"{name}.toml"
    module = imported(exported_text(spec), folder, name)
    s = 2j * np.pi * np.geomspace(1e-3, 1e6, 500)
    for tf in pipeline.derive_all(pipeline.load(spec))[:2]:
        values = {n: p["value"] for n, p in module.PARAMETERS.items()}
        program, _ = choose_programs(tf, SAMPLES)[0]
        assert module.TRANSFER_FUNCTIONS[tf.name](s).tolist() == evaluate(program, s, values).tolist()


def test_every_function_agrees_with_ball_arithmetic_at_complex_points(two_mass):
    random = np.random.default_rng(1)
    size = 10.0 ** random.uniform(-3, 5, 60)
    s = np.array([*(size * np.exp(1j * random.uniform(0, 2 * np.pi, 60))), 3.0, -0.4, 1e-9j, 1e12j, 1e12])
    for tf in pipeline.derive_all(pipeline.load(DERIVATIONS / "two_mass.toml")):
        bound = pipeline.bind(tf)
        expected = np.array([bound(complex(z)) for z in s])
        computed = two_mass.TRANSFER_FUNCTIONS[tf.name](s)
        assert np.max(abs(computed - expected) / np.maximum(abs(expected), 1e-300)) < 1e-12


def test_a_far_branch_in_the_text_computes_exactly_what_was_verified(folder):
    model = pipeline.loads(free_chain(8, b="4 N*s/m", outputs='A = "s^2*x0"\nX = "x7"'))
    module = imported(exported(model).text, folder, "far")
    s = np.concatenate([1j * np.logspace(-9, 13, 200), 10.0 ** np.arange(5, 14)])
    for tf in pipeline.derive_all(model):
        program, _ = choose_programs(tf, SAMPLES)[0]
        assert program.far is not None
        computed = module.TRANSFER_FUNCTIONS[tf.name](s)
        assert computed.tolist() == evaluate(program, s, {"m": 2, "k": 3000, "b": 4}).tolist()
        bound = pipeline.bind(tf)
        expected = np.array([bound(complex(z)) for z in s])
        assert np.max(abs(computed / expected - 1)) < 1e-12


def test_the_static_gain_is_returned_at_zero(folder):
    module = imported(exported_text(DERIVATIONS / "rigid_body.toml"), folder, "rigid_body")
    # Eppinger & Seering's G_rb at s = 0, from the printed formula.
    r, k_tau = 0.025 / (2 * np.pi), 0.11
    gain = 50 * 4 * r * k_tau / (200 * r**2 * (1.1 + 50 * 0.2) + k_tau * (50 * 4 * 0.03 + 0.11))
    assert module.V_tip_over_V_cmd(0) == pytest.approx(gain, rel=1e-15)
    assert module.A_tip_over_V_cmd(0) == 0


def test_a_pole_is_not_finite_and_raises_no_warning(two_mass):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        values = two_mass.X_act_over_F(np.array([0, 1]))
        assert not np.isfinite(two_mass.X_act_over_F(0))
    assert not np.isfinite(values[0])
    assert np.isfinite(values[1])


def test_extremes_of_s_raise_no_warning(two_mass):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for s in (1e-9j, 1e-9, 1e12, 1e12j, 1e100, 1e-100j):
            two_mass.V_tip_over_F(np.array([s]))
            two_mass.V_tip_over_F(s)


# --------------------------------------------------------------------------------------- scalars, arrays


def test_a_scalar_of_any_kind_gives_a_python_complex(two_mass):
    for s in (2, 2.0, 2 + 0j, np.float32(2), np.int8(2), np.complex64(2), np.array(2), True + 1):
        value = two_mass.V_tip_over_F(s)
        assert type(value) is complex, type(s)
        assert value == two_mass.V_tip_over_F(2.0 + 0j), type(s)


def test_integers_in_parameters_count_as_real_numbers(two_mass):
    assert two_mass.V_tip_over_F(3j, m_1=np.int16(30000), m_2=30000) == two_mass.V_tip_over_F(
        3j, m_1=3e4, m_2=3e4
    )


def test_arrays_longer_than_a_block_have_the_values_of_their_elements(two_mass):
    s = np.geomspace(1, 1e3, 50_000).reshape(2, 25_000) * 1j
    masses = np.linspace(1.0, 3.0, s.size).reshape(s.shape)
    function = two_mass.V_tip_over_F
    for given in ({}, {"m_1": masses}, {"m_1": masses[:, :1]}, {"m_1": masses.T.copy().T}):
        found = function(s, **given)
        assert found.shape == s.shape
        for place in ((0, 0), (0, 20_479), (0, 20_480), (1, 24_999)):
            one = {name: np.broadcast_to(a, s.shape)[place] for name, a in given.items()}
            assert found[place] == pytest.approx(function(s[place], **one), rel=1e-15)
    assert function(s[:, ::-1])[0, 0] == function(s)[0, -1]


def test_s_and_every_parameter_are_broadcast_together(two_mass):
    s = 1j * np.arange(1, 5)
    m_1 = np.array([[1.0], [2.0], [3.0]])
    k = np.linspace(1, 2, 2).reshape(2, 1, 1)
    values = two_mass.X_tip_over_F(s, m_1=m_1, k=k, b=[0.1, 0.2, 0.3, 0.4])
    assert values.shape == (2, 3, 4)
    alone = two_mass.X_tip_over_F(4j, m_1=3.0, k=2.0, b=0.4)
    assert values[1, 2, 3] == pytest.approx(alone, rel=1e-15)


def test_an_array_in_one_parameter_and_a_scalar_s_give_an_array(two_mass):
    values = two_mass.V_act_over_F(1j, m_2=[1, 2, 3])
    assert isinstance(values, np.ndarray)
    assert values.shape == (3,)
    assert values.dtype == complex


def test_a_complex_stiffness_is_accepted(two_mass):
    value = two_mass.X_tip_over_F(2j, k=71653 * (1 + 0.02j))
    k, b, m_1, m_2 = 71653 * (1 + 0.02j), 41, 60, 20
    s = 2j
    expected = (b * s + k) / (s**2 * (m_1 * m_2 * s**2 + (m_1 + m_2) * (b * s + k)))
    assert value == pytest.approx(expected, rel=1e-14)


def test_an_empty_array_gives_an_empty_array(two_mass):
    assert two_mass.V_tip_over_F(np.zeros((0, 3))).shape == (0, 3)


def test_the_arguments_are_not_changed(two_mass):
    s, m_1 = np.array([1j, 2j]), np.array([1.0, 2.0])
    result = two_mass.V_tip_over_F(s, m_1=m_1)
    result[:] = 0
    assert s.tolist() == [1j, 2j]
    assert m_1.tolist() == [1.0, 2.0]


def test_parameters_are_keywords_only(two_mass):
    with pytest.raises(TypeError, match="positional"):
        two_mass.V_tip_over_F(1j, 2.0)


def test_what_is_no_number_is_refused(two_mass):
    for value in (None, "1", object(), [None, 1]):
        with pytest.raises(TypeError):
            two_mass.V_tip_over_F(1j, m_1=value)


# ---------------------------------------------------------------------------------------------- the text


def test_parameters_have_value_unit_and_doc(two_mass, symbolic):
    assert two_mass.PARAMETERS["k"] == {
        "value": 71653.0,
        "unit": "N/m",
        "doc": "stiffness of the transmission",
    }
    assert symbolic.PARAMETERS["b"] == {"value": None, "unit": "N*s/m", "doc": "friction"}
    assert list(two_mass.PARAMETERS) == ["m_1", "m_2", "k", "b"]


IN_HERTZ = """
symflex = 1
parameters.f = { value = "11 Hz", doc = "a peak" }
inputs.u = {}
outputs.y = "u/(s + f)"
"""


def test_defaults_are_the_doubles_nearest_to_the_exact_values_in_the_units_they_have_in_code(folder):
    text = exported_text(DERIVATIONS / "rigid_body.toml")
    module = imported(text, folder, "rigid_body")
    # 25 mm per turn in m/rad, 1/(80*pi) = 0.00397887357729738339422...
    assert module.PARAMETERS["r"]["value"] == 0.0039788735772973835
    signature = inspect.signature(module.A_tip_over_V_cmd)
    assert signature.parameters["r"].default == 0.0039788735772973835
    module = imported(exported(pipeline.loads(IN_HERTZ)).text, folder, "in_hertz")
    assert module.PARAMETERS["f"] == {"value": 11.0, "unit": "Hz", "doc": "a peak"}


def test_transfer_functions_are_found_by_name(two_mass):
    assert list(two_mass.TRANSFER_FUNCTIONS) == ["X_act/F", "V_act/F", "X_tip/F", "V_tip/F"]
    assert two_mass.TRANSFER_FUNCTIONS["V_tip/F"] is two_mass.V_tip_over_F


def test_functions_can_be_pickled(two_mass):
    assert pickle.loads(pickle.dumps(two_mass.V_tip_over_F)) is two_mass.V_tip_over_F


def test_the_docstring_has_formula_units_title_source_and_verification(two_mass):
    text = two_mass.V_tip_over_F.__doc__
    assert text.startswith("Mobility V_tip/F [m/(N*s)].")
    assert "V_tip/F = (b*s + k)/(s*(m_1*m_2*s^2 + (b*s + k)*(m_1 + m_2)))" in text
    assert "stiffness of the transmission [N/m]." in text
    assert "Two masses joined by a flexible transmission" in text
    assert "Eppinger & Seering 1988, fig. 8a" in text
    assert "over 0.1 Hz ... 100 Hz against ball arithmetic" in " ".join(text.split())


def test_a_function_without_values_says_that_it_is_not_verified(symbolic):
    assert "not verified: no values for b" in symbolic.X_over_F.__doc__
    assert "X/F: not verified: no values for b" in symbolic.__doc__


@pytest.mark.slow
def test_of_a_long_formula_a_docstring_tells_how_to_print_it(folder):
    module = imported(exported_text(DERIVATIONS / "six_mass.toml"), folder, "six_mass")
    formula = module.X_act_over_F.__doc__.split("Parameters")[0]
    assert "which symflex derive --tf X_act/F prints." in " ".join(formula.split())


KINDS = ("two_mass", "six_mass", "sliding_free_beam", "rigid_body")
"""With short and long formulas, with responses in real arithmetic, with units that are not SI."""


@pytest.mark.parametrize("name", KINDS)
def test_modules_import_numpy_only_and_keep_to_88_columns(name):
    text = exported_text(DERIVATIONS / f"{name}.toml")
    roots = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            roots |= {alias.name.split(".")[0] for alias in node.names}
        if isinstance(node, ast.ImportFrom):
            roots.add(node.module.split(".")[0])
    assert roots == {"__future__", "numpy"}
    # Only the linters' own lines may be longer.
    assert all(len(line) <= 88 for line in text.splitlines() if not line.startswith("# ruff"))


def test_modules_satisfy_ruff(tmp_path):
    ruff = Path(sys.executable).with_name("ruff")
    if not ruff.exists():
        pytest.skip("ruff is not installed")
    paths = [tmp_path / f"{name}.py" for name in KINDS]
    for path in paths:
        path.write_text(exported_text(DERIVATIONS / path.with_suffix(".toml").name), encoding="utf-8")
    command = [ruff, "check", "--isolated", "--no-cache", "--ignore", "PLR0913,PLR0917"]
    command += ["--config", 'lint.pydocstyle.convention="numpy"']
    command += ["--select", "E,F,I,D,N,B,RUF,ANN,UP,PL"]
    run = subprocess.run([*command, *paths], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout


@pytest.mark.slow
def test_the_text_is_the_same_in_every_process():
    code = (
        "from symflex import pipeline\n"
        "from symflex.codegen.python.module import NUMPY\n"
        "import hashlib, sys\n"
        "m = pipeline.load(sys.argv[1])\n"
        "text = NUMPY.export(m, pipeline.derive_all(m), samples=5).text\n"
        "print(hashlib.sha256(text.encode()).hexdigest())\n"
    )
    digests = set()
    for seed in ("0", "4711"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-c", code, str(DERIVATIONS / "lumped_bending_beam.toml")]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        digests.add(done.stdout)
    assert len(digests) == 1


def test_a_function_asked_for_twice_is_written_once():
    model = pipeline.load(DERIVATIONS / "two_mass.toml")
    tfs = pipeline.derive_all(model)
    assert NUMPY.export(model, [*tfs, *tfs], samples=5).text == NUMPY.export(model, tfs, samples=5).text


def test_a_default_beyond_double_precision_is_refused():
    model = pipeline.loads(SYMBOLIC.replace('"2 kg"', "1e400"))
    with pytest.raises(ModelError, match="SF233"):
        exported(model)
