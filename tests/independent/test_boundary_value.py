"""What symflex derives from distributed systems is what a boundary-value solver of 50 digits finds."""

import functools

import mpmath
import numpy as np
import pytest
from flint import acb
from mpmath import mp, mpc, mpf

import symflex
from benchmarks.generated import imported
from symflex.transfer import bind_nested
from tests.independent.boundary_value import DIGITS, Problem, bending, exponential
from tests.independent.distributed import CASES
from tests.independent.distributed.removable import REMOVABLE
from tests.independent.spec_expressions import evaluate

WORST_RELATIVE_ERROR = 1e-12
POINTS = 20
FEW = (0, 3, 10, 16)
"""Which of the 20 points are taken: two on the imaginary axis, one on either side of it."""
VERY_SLOW = (1e-9 + 2e-9j, -3e-9 + 1e-10j)
"""[rad/s]"""

BY_NAME = {case.name: case for case in CASES}

LONGEST = "motor, screw, carriage, flexible arm, gripper: tip"
EXPORTED = {
    "sliding-free, tip",
    "cantilever in tension",
    "Timoshenko cantilever as a system of two unknowns",
    "shaft element with damping",
    "cantilever with delayed velocity feedback",
    "field whose end is a node with a mass and a damper",
    LONGEST,
}
"""One of each kind of kernel and of each kind of joint, exported to numpy in every run."""
QUICK = EXPORTED | {
    "clamped-free with damping, deflection inside",
    "compressed beam element",
    "beam on an elastic and viscous foundation",
    "Rayleigh beam element with a rigid body",
    "free Timoshenko element, rotation across",
    "string element with a mass and a dashpot at its end",
    "free-free rod with damping, displacement inside",
    "massless flexure and an arm",
    "one-link arm, tip",
    "clamped-sliding under a distributed load, moment at the clamp",
}
"""One of each theory and kind of end, compared in every run."""

UNNAMED = {
    "pipe conveying fluid with a bare tail",
    "coupled bending and torsion",
    "dispersive wave of third order",
}
"""Their exponents have no closed form: prints hold the fundamental solution h itself."""


def quick_first(names, quick):
    return [pytest.param(name, marks=[pytest.mark.slow] * (name not in quick)) for name in names]


@functools.cache
def model_of(name):
    return symflex.loads(BY_NAME[name].text)


@functools.cache
def derived(name):
    return model_of(name).transfer_function("out", "u")


@functools.cache
def reference_at(name, s, digits=DIGITS):
    return complex(BY_NAME[name].reference(s, digits))


def few(name, chosen=FEW):
    points = BY_NAME[name].points(POINTS)
    return [points[k] for k in chosen]


def assert_agrees(name, function, points, digits=DIGITS):
    """Compare values at points with the reference's."""
    expected = np.array([reference_at(name, complex(s), digits) for s in points])
    found = function(np.array(points))
    assert np.max(np.abs(found - expected) / np.abs(expected)) < WORST_RELATIVE_ERROR


# --------------------------------------------------------------------------------------- the comparison


@pytest.mark.parametrize("name", quick_first(BY_NAME, QUICK))
def test_the_exact_evaluation_agrees_with_the_boundary_value_problem(name):
    assert_agrees(name, derived(name).bind(), [*few(name), *VERY_SLOW])


@pytest.mark.parametrize("name", sorted(EXPORTED))
@pytest.mark.slow
def test_the_exported_function_agrees_with_the_boundary_value_problem(name):
    function = imported(model_of(name).export_numpy(), "exported").TRANSFER_FUNCTIONS["out/u"]
    assert_agrees(name, function, [*few(name), *VERY_SLOW])


NETWORKS = (
    "motor, screw, carriage, flexible arm, gripper: tip",
    "Timoshenko root, rigid body, slender tip",
    "clamped-sliding under a distributed load, moment at the clamp",
    "cantilever with delayed velocity feedback",
    "decaying substance in a moving medium",
    "pipe conveying fluid with a bare tail",
    "electrical transmission line",
)
"""One of each kind of member, field and joint that equations are solved with instead of derived."""


@pytest.mark.parametrize("name", NETWORKS)
def test_a_network_solved_in_doubles_agrees_and_one_solved_in_balls_meets_the_elimination(name):
    bound = bind_nested(model_of(name).nested("out", "u").exact)
    assert_agrees(name, bound.at, few(name))
    s = acb(few(name)[1])
    solved, eliminated = bound.solved(s, 512), bound.enclosed(512)(s)
    assert solved.overlaps(eliminated)
    assert min(solved.rel_accuracy_bits(), eliminated.rel_accuracy_bits()) > 60


# -------------------------------------------------------------------------------------- the printed forms

FORMS = ("vaughan", "hyperbolic", "krylov", "factored", "frequency")


def printed_value(name, form, s):
    """Return the value of what ``derive --json`` prints, read by the tests' own reader of the grammar."""
    found = derived(name).to_json_dict(form)
    with mp.workdps(DIGITS):
        values = BY_NAME[name].values() | {"s": mpc(s), "omega": mpc(s) / mpc(0, 1), "j": mpc(0, 1)}
        above, below = (evaluate(found[part], values, found["where"]) for part in ("num", "den"))
        return complex(above / below)


# A print with both theories takes ten seconds to read: each of them has its own.
PRINTED = [
    name for name in BY_NAME if name not in UNNAMED and name != "Timoshenko root, rigid body, slender tip"
]


@pytest.mark.parametrize("name", quick_first(PRINTED, EXPORTED - {LONGEST}))
def test_the_printed_forms_agree_with_the_boundary_value_problem(name):
    for form in FORMS:
        # Points 0 and 10 lie on the imaginary axis, where the frequency form holds.
        points = few(name, [0, 10] if form == "frequency" else [3, 16])
        assert_agrees(
            name, lambda at, form=form: np.array([printed_value(name, form, s) for s in at]), points
        )


# ------------------------------------------------------------------------------ the ends of the range

FAST_DIGITS = 1400


def cantilever(v, s):
    """Return the deflection of a cantilever per force on its tip, from Rao 2007, chapter 11, with x = b l."""
    beta = (-v["rho"] * v["A"] * s**2 / (v["E"] * v["I"])) ** mpf("0.25")
    x = beta * v["l"]
    above = mpmath.cosh(x) * mpmath.sin(x) - mpmath.sinh(x) * mpmath.cos(x)
    return above / (v["E"] * v["I"] * beta**3 * (1 + mpmath.cosh(x) * mpmath.cos(x)))


def rod_with_mass(v, s):
    """Return the velocity of a mass on a rod per force on it: the rod's stiffness is E A k coth(k l)."""
    k = s * mpmath.sqrt(v["rho"] / v["E"])
    return s / (v["E"] * v["A"] * k * mpmath.coth(k * v["l"]) + v["m"] * s**2)


@pytest.mark.parametrize(
    ("name", "formula", "faster"),
    [
        ("clamped-free, driving point", cantilever, 10**5.5),
        ("rod element with a tip mass", rod_with_mass, 10**2.9),
    ],
)
def test_values_are_right_where_exponentials_pass_the_range_of_doubles(name, formula, faster):
    far = BY_NAME[name].scale * faster  # beta l is about a thousand
    points = np.array([far * (0.02 + 1j), far * (-0.3 - 0.9j)])
    with mp.workdps(FAST_DIGITS):
        expected = np.array([complex(formula(BY_NAME[name].values(), mpc(s))) for s in points])
    function = imported(model_of(name).export_numpy(), "exported").TRANSFER_FUNCTIONS["out/u"]
    assert derived(name).bind()(points) == pytest.approx(expected, rel=WORST_RELATIVE_ERROR)
    assert function(points) == pytest.approx(expected, rel=WORST_RELATIVE_ERROR)


# ------------------------------------------------------------------- where the formulas have removable poles


def is_near(found, case, s):
    expected = complex(case.reference(s, DIGITS))
    return abs(found - expected) < WORST_RELATIVE_ERROR * abs(expected)


@pytest.mark.slow
def test_the_exact_evaluation_knows_the_limit_at_a_removable_pole():
    found = {
        (case.name, s): is_near(
            complex(symflex.loads(case.text).transfer_function("out", "u").bind()(s)), case, s
        )
        for case, s in REMOVABLE
    }
    assert [at for at, near in found.items() if not near] == []


# One where each kind of wavenumber vanishes, and where two of them meet.
BESIDE = ("rod in a bed", "Rayleigh beam in tension", "Timoshenko beam")


@pytest.mark.parametrize("name", quick_first(BESIDE, BESIDE[:2]))
@pytest.mark.slow
def test_the_exported_function_is_right_at_and_beside_a_removable_pole(name):
    # Several points belong to one model, which is exported once.
    places = [(case, s) for case, s in REMOVABLE if case.name == name]
    function = imported(symflex.loads(places[0][0].text).export_numpy(), "removable").TRANSFER_FUNCTIONS[
        "out/u"
    ]
    for case, s in places:
        for aside in (0, 1e-14, 1e-9, 1e-5, 1e-3):
            assert is_near(complex(function(s + aside)), case, s + aside), (s, aside)


# ----------------------------------------------------------------------------------- the reference itself


@pytest.mark.slow
def test_the_reference_has_fifty_digits_where_exponentials_are_largest():
    # Bending, waves, and an equation of another order, each at its point farthest out.
    for name in ("sliding-free, tip", "electrical transmission line", "coupled bending and torsion"):
        farthest = BY_NAME[name].points(POINTS)[-1]
        with mp.workdps(2 * DIGITS):
            better = BY_NAME[name].reference(farthest, 2 * DIGITS)
            assert abs(BY_NAME[name].reference(farthest, DIGITS) / better - 1) < mpf(10) ** -50, name


def test_the_reference_cantilever_is_the_textbook_formula():
    with mp.workdps(DIGITS):
        v = {"E": mpf(2), "I": mpf(3), "rho": mpf(5), "A": mpf(7), "l": mpf(11) / 10}
        for s in (mpc(1, 30), mpc(-2, 400), mpc(0.01)):
            problem = Problem()
            beam = problem.line(bending(v, s))
            w, _, moment, shear = beam.at(v["l"])
            problem.require(*beam.start[:2], moment, shear + 1)
            assert abs(problem.solve()(w) / cantilever(v, s) - 1) < mpf(10) ** -100, s


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


def test_there_are_forty_combinations_with_different_names_and_more():
    assert len(BY_NAME) == len(CASES) >= 40
    assert set(NETWORKS) | QUICK | UNNAMED <= set(BY_NAME)
