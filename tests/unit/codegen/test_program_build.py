"""Programs compute the transfer function, stay small, and neither overflow nor cancel."""

from fractions import Fraction
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.program.build import available_forms, build_program
from symflex.codegen.program.evaluate import evaluate, nearest_double
from symflex.codegen.program.nodes import Assigned, Laplace, RealNumber
from symflex.errors import BudgetError, ModelError

MASSES = [Fraction(11 + i, 2) for i in range(8)]
SPRINGS = [Fraction(100_000 + 7_000 * i) for i in range(7)]
DAMPERS = [Fraction(20 + i) for i in range(7)]

DERIVATIONS = Path(__file__).parents[3] / "derivations" / "eppinger1988"


@cache
def chain(number):
    lines = ["symflex = 1", "[parameters]"]
    lines += [f'm_{i} = "{float(MASSES[i])} kg"' for i in range(number)]
    lines += [f'k_{i} = "{SPRINGS[i]} N/m"' for i in range(number - 1)]
    lines += [f'b_{i} = "{DAMPERS[i]} N*s/m"' for i in range(number - 1)]
    lines += ["[elements]"]
    lines += [f'M{i} = {{ type = "mass", at = "x_{i}", m = "m_{i}" }}' for i in range(number)]
    for i in range(number - 1):
        lines.append(f'K{i} = {{ type = "spring", between = ["x_{i}", "x_{i + 1}"], k = "k_{i}" }}')
        lines.append(f'B{i} = {{ type = "damper", between = ["x_{i}", "x_{i + 1}"], b = "b_{i}" }}')
    lines += ['[inputs]\nF = { force = "x_0" }', f'[outputs]\nX = "x_{number - 1}"\nV = "s*x_0"']
    return pipeline.derive_all(pipeline.loads("\n".join(lines)))


@cache
def solved_chain(number, s):
    """Solve (M s^2 + B s + K) x = e_0 with 60 digits; return the last x and s times the first."""
    with mpmath.workdps(60):
        z = mpmath.mpc(s)
        matrix = mpmath.zeros(number)
        for i in range(number):
            matrix[i, i] += mpmath.mpf(MASSES[i].numerator) / MASSES[i].denominator * z**2
        for i in range(number - 1):
            w = mpmath.mpf(int(SPRINGS[i])) + int(DAMPERS[i]) * z
            for row, column, sign in ((i, i, 1), (i + 1, i + 1, 1), (i, i + 1, -1), (i + 1, i, -1)):
                matrix[row, column] += sign * w
        right = mpmath.zeros(number, 1)
        right[0] = 1
        x = mpmath.lu_solve(matrix, right)
        return complex(x[number - 1]), complex(z * x[0])


def values_of(tf):
    return {p.name: nearest_double(p.value.rational, p.value.pi_power) for p in tf.parameters}


@cache
def program_of(number, which, *form):
    return build_program(chain(number)[which], *form)


FORMS = ("closed", "closed in s", "nested", "factors")


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.slow
def test_eight_masses_agree_with_a_linear_solve_from_1e_minus_9_to_1e12(form):
    number = 6 if form == "factors" else 8
    for which, tf in enumerate(chain(number)):
        program = program_of(number, which, form)
        for s in (1e-9j, -2 + 1e3j, 1e8 + 1e8j, 1e12j):
            expected = solved_chain(number, s)[which]
            assert abs(evaluate(program, s, values_of(tf)) - expected) <= 1e-11 * abs(expected), (which, s)


def test_recurrences_lose_no_digit_between_the_resonances_of_eight_masses():
    s = 2j * np.pi * np.geomspace(0.5, 60, 40)
    computed = evaluate(program_of(8, 1, "closed"), s, values_of(chain(8)[1]))
    expected = np.array([solved_chain(8, complex(z))[1] for z in s])
    assert np.max(abs(computed - expected) / abs(expected)) < 2e-14


def test_elements_of_one_array_choose_their_branch_one_by_one():
    tf, program = chain(8)[1], program_of(8, 1)
    s = np.array([10j, 1e14j, 20j, 1e13])
    together = evaluate(program, s, values_of(tf))
    alone = [complex(evaluate(program, complex(z), values_of(tf))) for z in s]
    assert np.allclose(together, alone, rtol=1e-14, atol=0)


def test_what_depends_on_parameters_only_is_kept_apart_from_what_depends_on_s():
    program = build_program(chain(4)[1], "factors")
    pending = [a.value for a in program.near.constants]
    later = {a.name for a in program.near.assignments}
    while pending:
        node = pending.pop()
        assert not isinstance(node, Laplace)
        assert not (isinstance(node, Assigned) and node.name in later)
        pending += node.children


def test_definitions_and_functions_of_constants_become_intermediates():
    text = """
    symflex = 1
    parameters = { m = "2 kg", k = "3 N/m" }
    definitions = { omega_0 = "sqrt(k/m)", Z = "m*s^2 + k" }
    blocks.H = { type = "tf", num = ["1"], den = ["1", "omega_0"] }
    inputs.u = {}
    outputs.y = "H*Z*u"
    """
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    s = 0.3 + 0.7j
    expected = (2 * s**2 + 3) / (s + 1.5**0.5)
    for form in available_forms(tf):
        program = build_program(tf, form)
        assert abs(complex(evaluate(program, s, values_of(tf))) - expected) < 1e-15 * abs(expected) * 4
    names = {
        a.name
        for a in (*build_program(tf, "closed").near.constants, *build_program(tf, "closed").near.assignments)
    }
    assert "Z" in names


def test_a_definition_with_a_pole_is_divided_out_so_that_the_limit_at_zero_exists():
    text = """
    symflex = 1
    parameters = { k = "3 s^-1" }
    definitions = { C = "k/s" }
    inputs.u = {}
    signals.e = "u - C*e"
    outputs.y = "C*e"
    """
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    assert complex(evaluate(build_program(tf), 0, {"k": 3.0})) == 1


def test_zero_is_the_constant_zero():
    text = """
    symflex = 1
    parameters = { m = "2 kg" }
    elements.body = { type = "mass", at = "x", m = "m" }
    inputs = { F = { force = "x" }, u = {} }
    outputs = { X = "x", y = "3*u" }
    """
    tfs = {tf.name: tf for tf in pipeline.derive_all(pipeline.loads(text))}
    assert build_program(tfs["X/u"]).near.values[0] == RealNumber(Fraction(0))
    assert evaluate(build_program(tfs["X/u"]), np.ones((2, 3)), {}).shape == (2, 3)
    assert evaluate(build_program(tfs["y/u"]), np.ones((2, 3)), {}).tolist() == [[3] * 3] * 2


@pytest.mark.parametrize("name", ["two_mass", "rigid_body", "lumped_bending_beam"])
def test_every_form_agrees_with_ball_arithmetic_off_the_axis(name):
    s = np.array([0.1 - 3j, 5 + 70j, -30 + 400j, 1e4 - 2e3j, 17.0, -0.2])
    for tf in pipeline.derive_all(pipeline.load(DERIVATIONS / f"{name}.toml")):
        bound = pipeline.bind(tf)
        expected = np.array([bound(complex(z)) for z in s])
        for form in available_forms(tf):
            computed = evaluate(build_program(tf, form), s, values_of(tf))
            assert np.max(abs(computed / expected - 1)) < 1e-12


def test_a_number_beyond_double_precision_is_refused():
    for value, pi_power in ((Fraction(10) ** 400, 0), (Fraction(1, 10**400), 0), (Fraction(10) ** 308, 2)):
        with pytest.raises(ModelError, match="SF233"):
            nearest_double(value, pi_power)


def test_a_multiple_of_pi_is_rounded_once():
    with mpmath.workdps(50):
        assert nearest_double(Fraction(22), 1) == float(22 * mpmath.pi)
    assert nearest_double(Fraction(1, 7), -2) == pytest.approx(1 / 7 / np.pi**2, rel=3e-16)


def test_a_program_that_would_fill_megabytes_is_refused(monkeypatch):
    monkeypatch.setattr("symflex.codegen.program.build.TERM_LIMIT", 10)
    with pytest.raises(BudgetError, match="SF503"):
        build_program(chain(8)[0])


def test_a_ratio_of_degree_180_over_180_does_not_overflow():
    text = """
    symflex = 1
    parameters = { T_1 = "1.01 s", T_2 = "1 s" }
    blocks.H = { type = "tf", num = ["T_1", "1"], den = ["T_2", "1"] }
    inputs.u = {}
    outputs.y = "H^60*H^60*H^60*u"
    """
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    for form in FORMS:
        program = build_program(tf, form)
        for s in (0, 0.5, 3j, 1e6j, 1e12j, 1e12):
            with mpmath.workdps(40):
                z = mpmath.mpc(s)
                expected = complex(((mpmath.mpf(101) / 100 * z + 1) / (z + 1)) ** 180)
            computed = complex(evaluate(program, s, values_of(tf)))
            assert abs(computed - expected) <= 1e-13 * abs(expected), (form, s)


def test_recurrences_give_up_on_a_polynomial_nested_too_deeply(monkeypatch):
    monkeypatch.setattr("symflex.codegen.program.polynomials.DEPTH_LIMIT", 3)
    with pytest.raises(BudgetError, match="structure"):
        build_program(chain(8)[0], "closed")


def test_a_parameter_that_cancels_between_definitions_is_no_argument():
    text = """
symflex = 1
parameters = { tau = "1 ms", C_1 = "10 nF", n = 8 }
definitions = { C_2 = "C_1/n", R_1 = "tau/C_1", R_2 = "2*tau/C_2" }
inputs = { U = { voltage = "in" } }
outputs = { Y = "o" }
[elements]
r1 = { type = "resistor", between = ["in", "m"], R = "R_1" }
c1 = { type = "capacitor", between = ["m", "ground"], C = "C_1" }
r2 = { type = "resistor", between = ["m", "o"], R = "R_2" }
c2 = { type = "capacitor", between = ["o", "ground"], C = "C_2" }
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    program = build_program(tf)
    assert set(program.parameters) == {"tau", "n"}
    s, tau, n = 300 + 700j, 2e-3, 5.0
    expected = 1 / (1 + s * tau * (3 + 1 / n) + 2 * (s * tau) ** 2)
    computed = complex(evaluate(program, s, {"tau": tau, "n": n}))
    assert abs(computed - expected) < 1e-15
