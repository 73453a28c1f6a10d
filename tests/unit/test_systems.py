"""Systems of other programs as models, against these programs' own values."""

import re

import control
import numpy as np
import pytest
import scipy.signal
import scipy.sparse
import sympy

import symflex
from symflex import from_control, from_matrices
from symflex.errors import UsageError
from tests.unit.refusals import refusal

S = 0.3 + 2.1j


def values(model, s=S):
    return np.array(
        [[complex(model.transfer_function(o, i).bind()(s)) for i in model.inputs] for o in model.outputs]
    )


def test_state_equations_of_control_with_several_ends():
    rng = np.random.default_rng(5)
    a, b, c, d = (rng.normal(size=shape) for shape in ((4, 4), (4, 3), (2, 4), (2, 3)))
    model = from_control(control.ss(a, b, c, d, inputs=["F 1", "F_1", "s"], outputs=["y[0]", "pi"]))
    assert (model.inputs, model.outputs) == (("F_1", "F_1_2", "s_2"), ("y_0", "pi_2"))
    np.testing.assert_allclose(values(model), c @ np.linalg.solve(S * np.eye(4) - a, b) + d, rtol=1e-12)


def test_a_matrix_of_transfer_functions_of_control():
    nums = [[[1, 2], [3.0]], [[1.0], [2, 0.1]]]
    dens = [[[1, 2, 3], [1, 5]], [[1, 2, 1], [1, 0, 7, 2]]]
    expected = [
        [np.polyval(n, S) / np.polyval(d, S) for n, d in zip(*row, strict=True)]
        for row in zip(nums, dens, strict=True)
    ]
    np.testing.assert_allclose(values(from_control(control.tf(nums, dens))), expected, rtol=1e-13)


@pytest.mark.parametrize("output", ["ba", "zpk", "ss"])
def test_a_filter_of_scipy(output):
    designed = scipy.signal.ellip(5, 1, 40, 100, analog=True, output="zpk")
    system = scipy.signal.ZerosPolesGain(*designed)
    system = {"ba": system.to_tf, "zpk": lambda: system, "ss": system.to_ss}[output]()
    expected = scipy.signal.freqs_zpk(*designed, worN=[33.0])[1]
    found = from_control(system).transfer_function("y", "u").bind()(33j)
    np.testing.assert_allclose(found, expected[0], rtol=1e-9 if output == "ss" else 1e-12)


def test_tuples_are_read_as_scipy_reads_them():
    a, b, c, d = [[0, 1], [-475, -2]], [[0], [1 / 60]], [[1, 0]], [[0]]
    for given, expected in (
        ((a, b, c, d), 1 / 60 / (S**2 + 2 * S + 475)),
        (tuple(map(np.array, (a, b, c, 5))), 1 / 60 / (S**2 + 2 * S + 475) + 5),
        (([1 / 60, 2], [3, 0.4, 4]), (S / 60 + 2) / (3 * S**2 + 0.4 * S + 4)),
        ((5, [1, 2]), 5 / (S + 2)),
        (([-1], [-2, -1 + 2j, -1 - 2j], 3), 3 * (S + 1) / ((S + 2) * ((S + 1) ** 2 + 4))),
        ((np.array([]), -2.0, 1 / 60), 1 / 60 / (S + 2)),
    ):
        assert values(from_control(given))[0, 0] == pytest.approx(expected, rel=1e-14), given
    with pytest.raises(UsageError, match=r"a tuple is \(num, den\)"):
        from_control((1, 2, 3, 4, 5))


def test_a_double_prints_as_its_shortest_decimal():
    for given, expected in (
        (([1 / 60], [1, 2, 475]), "0.016666666666666666/(s^2 + 2*s + 475)"),
        (([0.1], [1 / 3, 2]), "0.1/(0.3333333333333333*s + 2)"),
        (([1.2345678901234567], [1, 0.7654321098765432]), "1.2345678901234567/(s + 0.7654321098765432)"),
    ):
        assert str(from_control(given).transfer_function("y", "u")) == f"y/u = {expected}"


def test_a_model_of_python_is_read_back_from_the_file_it_is_written_to(tmp_path):
    built = symflex.Model(
        parameters={"k": {"value": "8 kN/m", "latex": "k_x"}, "a": "30 deg", "f": "10 Hz", "z": {}},
        inputs={"u": {}},
        outputs={"y": "z*k*sin(a)*u/(1/f*s + 1)"},
    )
    read = symflex.loads(built.to_toml(), values={"k": 5, "a": 0.5, "f": "90 rpm", "z": 1 / 3})
    models = [
        built,
        read,
        from_matrices(M=[[2, 0], [0, 1]], K=[[30, -10], [-10, 10]], inputs={"F": 1}, outputs={"X": 0}),
        from_control(control.ss([[0, 1], [-3, -1e-5]], [[0], [1 / 60]], [[1, 0]], [[0]])),
        from_control(([1], [1, 0.4, 4])),
    ]
    for model in models:
        model.to_toml(tmp_path / "model.toml")
        assert symflex.load(tmp_path / "model.toml") == model, model
    assert [float(p.value.nearly) for p in read.parameters] == [5.0, 0.5, 1.5, 1 / 3]
    text = "symflex = 1  # as it stands\ninputs.u = {}\noutputs.y = 'u'"
    assert symflex.loads(text).to_toml() == text


@pytest.mark.slow
def test_a_report_is_written_of_models_of_python(tmp_path):
    made = from_matrices(M=[[2]], K=[[8]], inputs={"F": 0}, outputs={"X": 0}, title="One <mass>")
    written = symflex.write_report([made, made], tmp_path / "report", pdf=False)
    assert written.is_certified
    assert {"One_mass.toml", "One_mass_2.toml"} <= {p.name for p in (tmp_path / "report").rglob("*.toml")}


def test_many_unknowns_with_numbers_are_printed_at_once():
    # A chain of masses of 1.1 kg on springs of 4/3 N/m, damped in proportion to them.
    n, stiffness = 20, 4 / 3
    k = stiffness * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    k[-1, -1] = stiffness
    model = from_matrices(M=1.1 * np.eye(n), D=0.01 * k, K=k, inputs={"F": n - 1}, outputs={"X": 0})
    printed = str(model.transfer_function("X/F"))
    angles = (2 * np.arange(n) + 1) * np.pi / (4 * n + 2)
    found = [float(x) for x in re.findall(r"s \+ ([0-9.]+)\)", printed.rpartition("/")[2])]
    assert found == pytest.approx(4 * stiffness / 1.1 * np.sin(angles) ** 2, rel=1e-5)


def test_what_is_no_continuous_system_is_refused():
    for system in (control.tf([1], [1, 2], 0.1), control.frd([1, 2], [1, 2]), 3):
        assert refusal(from_control, system) == "UsageError SF902"


def test_three_masses_with_matrices_of_sympy():
    m, k = sympy.symbols("m k", positive=True)
    stiffness = k * sympy.Matrix([[2, -1, 0], [-1, 2, -1], [0, -1, 1]])
    model = from_matrices(
        sympy.diag(m, 2 * m, m), None, stiffness, inputs={"F": 0}, outputs={"X": -1, "V": "s*q_1"}
    )
    found = model.transfer_function("X", "F").bind(m=3, k=5)
    numbers = np.array(stiffness.subs(k, 5), dtype=float)
    expected = np.linalg.solve(np.diag([3, 6, 3]) * S**2 + numbers, [1, 0, 0])
    np.testing.assert_allclose(complex(found(S)), expected[2], rtol=1e-13)
    assert [(p.name, p.assume) for p in model.parameters] == [("k", "positive"), ("m", "positive")]


def test_sparse_matrices_of_a_finite_element_program_by_the_nested_form():
    n = 40
    ones = np.ones(n - 1)
    stiffness = scipy.sparse.diags([-ones, 2 * np.ones(n), -ones], [-1, 0, 1]).tocsr() * 1000.0
    row = np.eye(n)[3]
    model = from_matrices(
        scipy.sparse.eye(n), 1e-5 * stiffness, stiffness, inputs={"F": n - 1}, outputs={"X": row}
    )
    bound = model.nested("X", "F").bind()
    dense = stiffness.toarray()
    expected = np.linalg.solve(np.eye(n) * S**2 + 1e-5 * dense * S + dense, np.eye(n)[-1])[3]
    np.testing.assert_allclose(bound(S), expected, rtol=1e-11)
    assert bound.dcgain() == pytest.approx(np.linalg.solve(dense, np.eye(n)[-1])[3], rel=1e-11)


def test_matrices_that_do_not_fit_are_refused():
    one = {"inputs": {"F": 0}, "outputs": {"X": 0}}
    for given, words in (
        ({**one}, "no matrix"),
        ({"M": [[1, 2]], **one}, "M is 1 x 2"),
        ({"M": np.eye(2), "K": np.eye(3), **one}, "K is 3 x 3"),
        ({"M": [[1, np.nan], [0, 1]], **one}, "'nan' is not a real number"),
        ({"M": np.eye(2) * 1j, **one}, "not a real number"),
        ({"M": np.eye(2), "inputs": {"F": 2}, "outputs": {"X": 0}}, "input 'F' is at 2"),
        ({"M": np.eye(2), "inputs": {"F": "q_3"}, "outputs": {"X": 0}}, "the unknown 'q_3'"),
        ({"M": np.eye(2), "inputs": {"F": [1, 2, 3]}, "outputs": {"X": 0}}, "has 3 entries"),
        ({"M": np.eye(2), "unknowns": ["x"], **one}, "1 unknowns"),
    ):
        with pytest.raises(UsageError) as caught:
            from_matrices(**given)
        assert words in caught.value.diagnostics[0].message


def test_arrays_of_numpy_are_coefficients_and_matrices_of_blocks():
    b, a = scipy.signal.butter(3, 50.0, analog=True)
    space = scipy.signal.tf2ss(b, a)
    model = symflex.Model(
        blocks={
            "G": {"type": "tf", "num": b, "den": a},
            "H": {"type": "ss", **dict(zip("ABCD", space, strict=True))},
        },
        inputs={"u": {}},
        outputs={"y": "G*u", "z": "H*u"},
    )
    expected = np.polyval(b, S) / np.polyval(a, S)
    np.testing.assert_allclose(values(model), [[expected], [expected]], rtol=1e-12)


@pytest.fixture(scope="module")
def lumped():
    return symflex.Model(
        elements={
            "one": {"type": "mass", "at": "x", "m": "2 kg"},
            "two": {"type": "mass", "at": "y", "m": "1 kg"},
            "link": {"type": "spring", "between": ["x", "y"], "k": "30 N/m"},
            "wall": {"type": "spring", "between": ["x", "ground"], "k": "80 N/m"},
            "loss": {"type": "damper", "between": ["x", "ground"], "b": "3 N*s/m"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"Y": "y"},
    )


def test_nested_functions_hand_themselves_to_other_programs(lumped):
    bound = lumped.nested("Y", "F").bind()
    system = np.array([[2 * S**2 + 3 * S + 110, -30], [-30, S**2 + 30]])
    expected = np.linalg.solve(system, [1, 0])[1]
    space = bound.state_space()
    by_states = space.C @ np.linalg.solve(S * np.eye(4) - space.A, space.B) + space.D
    zpk, sampled = bound.to_scipy(), bound.discretise("10 ms", "tustin")
    exact = bound.to_sympy()
    found = [
        control.evalfr(bound.to_control(), S),
        control.evalfr(bound.to_control("state-space"), S),
        zpk.gain * np.prod(S - zpk.zeros) / np.prod(S - zpk.poles),
        by_states[0, 0],
        complex((exact.num / exact.den).subs(exact.var, S)),
        sampled((1 + 0.005 * S) / (1 - 0.005 * S)),  # the point z that Tustin's rule takes to S
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-11)
    assert bound.dcgain() == pytest.approx(1 / 80)
    np.testing.assert_allclose(bound.to_frd([2.0]).frdata[0, 0, 0], bound(2j))


def test_nested_functions_of_beams_hand_over_what_they_can():
    model = symflex.Model(
        elements={
            "arm": {
                "type": "beam",
                "between": ["ground", "tip"],
                "EI": "2 N*m^2",
                "rhoA": "0.3 kg/m",
                "l": "0.5 m",
            }
        },
        inputs={"F": {"force": "tip"}},
        outputs={"Y": "tip.y"},
    )
    bound = model.nested("Y", "F").bind()
    assert bound.dcgain() == pytest.approx(0.5**3 / (3 * 2))
    np.testing.assert_allclose(bound.to_frd([10.0]).frdata[0, 0, 0], bound(10j))
    for method in (bound.to_control, bound.to_scipy, bound.to_sympy, lambda: bound.discretise("1 ms")):
        assert refusal(method) == "ModelError SF235"
