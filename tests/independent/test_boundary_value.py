"""What symflex derives from distributed systems is what a boundary-value solver of 50 digits finds."""

from __future__ import annotations

import functools
import importlib.util

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpc, mpf

import symflex
from tests.house.repository import one_in, slow_ones
from tests.independent.boundary_value import DIGITS, Problem, bending, exponential
from tests.independent.distributed import CASES
from tests.independent.distributed.removable import REMOVABLE
from tests.independent.spec_expressions import evaluate

WORST_RELATIVE_ERROR = 1e-12
POINTS = 20
FEW = (0, 3, 10, 16)
"""Which of the 20 points every run takes; the slow run takes all of them."""

NAMES = [case.name for case in CASES]

EACH_TIME = {
    "sliding-free, tip",
    "clamped-free with losses, deflection inside",
    "cantilever in tension",
    "compressed beam element",
    "beam on an elastic and viscous foundation",
    "Rayleigh beam element with a rigid body",
    "free Timoshenko element, rotation across",
    "Timoshenko cantilever as a system of two unknowns",
    "string element with a mass and a dashpot at its end",
    "shaft element with losses",
    "free-free rod with losses, displacement inside",
    "massless flexure and an arm",
    "cantilever with delayed velocity feedback",
    "one-link arm, tip",
    "motor, screw, carriage, flexible arm, gripper: tip",
    "field whose end is a node with a mass and a damper",
    "clamped-sliding under a distributed load, moment at the clamp",
}
"""One of each theory and kind of end, compared in every run."""

UNNAMED = {
    "pipe conveying fluid",
    "pipe conveying fluid with a bare tail",
    "coupled bending and torsion",
    "dispersive wave of third order",
}
"""Their exponents have no closed form: prints hold the fundamental solution h itself."""


@functools.cache
def model_of(name):
    return symflex.loads(case_of(name).text)


@functools.cache
def derived(name):
    return model_of(name).transfer_function(*case_of(name).tf.split("/"))


@functools.cache
def bound(name):
    return derived(name).bind()


def case_of(name):
    return CASES[NAMES.index(name)]


@functools.cache
def reference_at(name, s, digits=DIGITS):
    return complex(case_of(name).reference(s, digits))


def expected_of(name, count, chosen=None):
    """Return the points, or those chosen by number, and the reference's value at each, as doubles."""
    points = case_of(name).points(count)
    points = points if chosen is None else [points[k] for k in chosen]
    return np.array(points), np.array([reference_at(name, s) for s in points])


def relative_error(found, expected):
    return np.max(np.abs(found - expected) / np.abs(expected))


@pytest.fixture(scope="session")
def imported(tmp_path_factory):
    """Return a function that imports a generated module under a name, once."""
    folder = tmp_path_factory.mktemp("distributed")
    known = {}

    def load(name, export):
        if name not in known:
            path = folder / f"{name}.py"
            path.write_text(export(), "utf-8")
            found = importlib.util.spec_from_file_location(path.stem, path)
            module = importlib.util.module_from_spec(found)
            found.loader.exec_module(module)
            known[name] = module.TRANSFER_FUNCTIONS
        return known[name]

    return load


@pytest.fixture(scope="session")
def exported(imported):
    """Return a function that exports a case's model to numpy and imports what was written."""

    @functools.cache
    def load(name):
        functions = imported(f"export_{NAMES.index(name)}", model_of(name).export_numpy)
        return functions[case_of(name).tf]

    return load


# --------------------------------------------------------------------------------------- the comparison


@pytest.mark.parametrize("name", sorted(EACH_TIME))
def test_the_exact_evaluation_agrees_with_the_boundary_value_problem(name):
    points, expected = expected_of(name, POINTS, FEW)
    assert relative_error(bound(name)(points), expected) < WORST_RELATIVE_ERROR


@pytest.mark.parametrize("name", sorted(EACH_TIME))
def test_the_exported_function_agrees_with_the_boundary_value_problem(exported, name):
    points, expected = expected_of(name, POINTS, FEW)
    assert relative_error(exported(name)(points), expected) < WORST_RELATIVE_ERROR


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_exact_evaluation_and_the_exported_function_agree_at_twenty_points(exported, name):
    points, expected = expected_of(name, POINTS)
    assert relative_error(bound(name)(points), expected) < WORST_RELATIVE_ERROR
    assert relative_error(exported(name)(points), expected) < WORST_RELATIVE_ERROR


# -------------------------------------------------------------------------------------- the printed forms

FORMS = ("vaughan", "hyperbolic", "krylov", "factored", "frequency")
LONG = {"Timoshenko root, rigid body, slender tip", "Timoshenko element with all losses, clamped and pinned"}


def printed_value(name, form, s):
    """Return the value of what ``derive --json`` prints, read by the tests' own reader of the grammar."""
    found = derived(name).to_json_dict(form)
    with mp.workdps(DIGITS):
        values = case_of(name).values() | {"s": mpc(s), "omega": mpc(s) / mpc(0, 1), "j": mpc(0, 1)}
        above, below = (evaluate(found[part], values, found["where"]) for part in ("num", "den"))
        return complex(above / below)


def assert_printed_form_agrees(name, form):
    # Points 0 and 10 lie on the imaginary axis, where the frequency form holds.
    points, expected = expected_of(name, POINTS, [0, 10] if form == "frequency" else [3, 16])
    found = np.array([printed_value(name, form, s) for s in points])
    assert relative_error(found, expected) < WORST_RELATIVE_ERROR


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", [name for name in NAMES if name not in UNNAMED | LONG])
@pytest.mark.slow
def test_the_printed_form_agrees_with_the_boundary_value_problem(name, form):
    assert_printed_form_agrees(name, form)


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", sorted(LONG))
def test_the_longer_printed_form_agrees_with_the_boundary_value_problem(name, form):
    assert_printed_form_agrees(name, form)


# ------------------------------------------------------------------------------ the ends of the range


COLOCATED = (
    "sliding-free, driving point",
    "clamped-free, driving point",
    "Kelvin-Voigt cantilever with tip mass and dashpot",
    "cantilever in tension",
    "one-link arm, hub",
    "Timoshenko element, driving point",
    "rod element with a tip mass",
)
FAR_EACH_TIME = ("clamped-free, driving point", "cantilever in tension", "rod element with a tip mass")
"""Whose references of so many digits are computed in every run."""
FAST_DIGITS = 1400
VERY_SLOW = (1e-9 + 2e-9j, -3e-9 + 1e-10j)
"""[rad/s]"""


def expected_at(name, points, digits=DIGITS):
    return np.array([reference_at(name, complex(s), digits) for s in points])


@pytest.mark.parametrize("name", slow_ones(NAMES, lambda name: name not in EACH_TIME))
def test_the_exact_evaluation_is_right_at_very_low_frequency(name):
    found = bound(name)(np.array(VERY_SLOW))
    assert relative_error(found, expected_at(name, VERY_SLOW)) < WORST_RELATIVE_ERROR


@pytest.mark.parametrize("name", slow_ones(NAMES, lambda name: name not in EACH_TIME))
def test_the_exported_function_is_right_at_very_low_frequency(exported, name):
    found = exported(name)(np.array(VERY_SLOW))
    assert relative_error(found, expected_at(name, VERY_SLOW)) < WORST_RELATIVE_ERROR


def very_fast(name):
    """Return points where exponentials pass the range of doubles: beta l is about a thousand."""
    case = case_of(name)
    far = case.scale * (10**5.5 if case.scale == CASES[0].scale else 10**2.9)
    return np.array([far * (0.02 + 1j), far * (-0.3 - 0.9j)])


@pytest.mark.parametrize("name", slow_ones(COLOCATED, lambda name: name not in FAR_EACH_TIME))
@pytest.mark.slow
def test_the_exact_evaluation_is_right_beyond_the_range_of_exponentials(name):
    points = very_fast(name)
    found = bound(name)(points)
    assert relative_error(found, expected_at(name, points, FAST_DIGITS)) < WORST_RELATIVE_ERROR


@pytest.mark.slow
@pytest.mark.parametrize("name", slow_ones(COLOCATED, lambda name: name not in FAR_EACH_TIME))
def test_the_exported_function_is_right_beyond_the_range_of_exponentials(exported, name):
    points = very_fast(name)
    found = exported(name)(points)
    assert relative_error(found, expected_at(name, points, FAST_DIGITS)) < WORST_RELATIVE_ERROR


# ------------------------------------------------------------------- where the formulas have removable poles


REMOVABLE_IDS = [f"{case.name} at {s}" for case, s in REMOVABLE]


@functools.cache
def removable_model(position):
    return symflex.loads(REMOVABLE[position][0].text)


@pytest.mark.parametrize("position", range(len(REMOVABLE)), ids=REMOVABLE_IDS)
def test_the_exact_evaluation_knows_the_limit_at_a_removable_pole(position):
    case, s = REMOVABLE[position]
    found = complex(removable_model(position).transfer_function("out", "u").bind()(s))
    expected = complex(case.reference(s, DIGITS))
    assert abs(found - expected) < WORST_RELATIVE_ERROR * abs(expected)


@pytest.mark.parametrize("aside", one_in(2, [0, 1e-14, 1e-9, 1e-5, 1e-3]))
@pytest.mark.parametrize("position", range(len(REMOVABLE)), ids=REMOVABLE_IDS)
def test_the_exported_function_is_right_at_and_beside_a_removable_pole(imported, position, aside):
    case, s = REMOVABLE[position]
    # Several points belong to one model, which is exported once.
    first = next(k for k, (other, _) in enumerate(REMOVABLE) if other.text == case.text)
    functions = imported(f"removable_{first}", removable_model(first).export_numpy)
    found = complex(functions["out/u"](s + aside))
    expected = complex(case.reference(s + aside, DIGITS))
    assert abs(found - expected) < WORST_RELATIVE_ERROR * abs(expected)


# ----------------------------------------------------------------------------------- the reference itself


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_reference_has_fifty_digits_where_exponentials_are_largest(name):
    case = case_of(name)
    farthest = case.points(POINTS)[-1]
    with mp.workdps(2 * DIGITS):
        better = case.reference(farthest, 2 * DIGITS)
        assert abs(case.reference(farthest, DIGITS) / better - 1) < mpf(10) ** -50


@pytest.mark.parametrize("s", [mpc(1, 30), mpc(-2, 400), mpc(0.01)])
def test_the_reference_cantilever_is_the_textbook_formula(s):
    # Rao 2007, chapter 11: (cosh x sin x - sinh x cos x)/(E I b^3 (1 + cosh x cos x)) with x = b l.
    with mp.workdps(DIGITS):
        v = {"E": mpf(2), "I": mpf(3), "rho": mpf(5), "A": mpf(7), "l": mpf(11) / 10}
        beta = (-v["rho"] * v["A"] * s**2 / (v["E"] * v["I"])) ** mpf("0.25")
        x = beta * v["l"]
        above = mpmath.cosh(x) * mpmath.sin(x) - mpmath.sinh(x) * mpmath.cos(x)
        below = v["E"] * v["I"] * beta**3 * (1 + mpmath.cosh(x) * mpmath.cos(x))
        problem = Problem()
        beam = problem.line(bending(v, s))
        w, _, moment, shear = beam.at(v["l"])
        problem.require(*beam.start[:2], moment, shear + 1)
        assert abs(problem.solve()(w) * below / above - 1) < mpf(10) ** -100


def test_the_reference_exponential_is_that_of_mpmath():
    with mp.workdps(60):
        rows = [[1, 2, 0], [3, -1, mpc(0, 5)], [mpf(1) / 7, 0, 2]]
        expected = mpmath.expm(mpmath.matrix(rows) * 3)
        found = exponential(rows, mpf(3))
        size = mpmath.mnorm(expected)
        assert all(
            abs(found[i][j] - expected[i, j]) < size * mpf(10) ** -55 for i in range(3) for j in range(3)
        )


def test_the_reference_refuses_too_few_conditions():
    problem = Problem()
    problem.unknown()
    with pytest.raises(ValueError, match="0 conditions for 1 unknowns"):
        problem.solve()


def test_the_cases_have_different_names():
    assert len(set(NAMES)) == len(NAMES)


def test_there_are_forty_combinations_and_more():
    assert len(CASES) >= 40
