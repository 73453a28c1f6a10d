"""The distributed models of Eppinger & Seering 1988: the sliding-free beam and the robot axis with a link."""

import functools
import tomllib
from pathlib import Path

import mpmath
import pytest
from mpmath import cos, cosh, mp, mpc, mpf, pi, sin, sinh, sqrt

import symflex
from tests.independent import classics
from tests.independent.boundary_value import Problem, bending
from tests.independent.spec_expressions import distance_to_root, evaluate

FOLDER = Path(__file__).parents[2] / "derivations" / "eppinger1988"
RELATIVE = mpf(10) ** -28
POINTS = (0.3 + 2j, -4 + 69j, 1 + 700j, 300 - 5j, -80 + 33j, 5000j)


@functools.cache
def derived(name, tf):
    return symflex.load(FOLDER / f"{name}.toml").transfer_function(*tf.split("/"))


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(classics.DIGITS):
        yield


def values(name):
    return classics.values(FOLDER / f"{name}.toml")


def beam_value(tf, s):
    return complex(derived("sliding_free_beam", tf).bind()(s))


# ------------------------------------------------------------------------------------ the sliding-free beam

WHERE = (
    ("S", "exp(-sqrt(T*p))*sin(sqrt(T*p))"),
    ("C", "exp(-sqrt(T*p))*cos(sqrt(T*p))"),
    ("p", "s/a"),
    ("a", "sqrt(E*I/(rho*A))"),
    ("T", "l^2/2"),
)
DENOMINATOR = "((S^2 + C^2)^2 - 4*C*S - 1)*(rho*A*a)"
RIGHT = {
    # Checked to 30 digits against a boundary-value solution.
    "V_act/F": f"-1/2*sqrt(2/p)*((S^2 + C^2)^2 + 2*S^2 + 6*C^2 + 1)/({DENOMINATOR})",
    "V_tip/F": f"-2*sqrt(2/p)*C*(S^2 + C^2 + 1)/({DENOMINATOR})",
}


def published(tf, s):
    """Return what the file quotes, scale included."""
    entries = tomllib.loads((FOLDER / "sliding_free_beam.toml").read_text("utf-8"))["published"][tf]
    where = tuple(entries["where"].items())
    v = values("sliding_free_beam") | {"s": mpc(s)}
    return evaluate(entries["expr"], v, where) * evaluate(entries["scale"], v, where)


def test_the_sliding_free_beam_is_the_formula_in_the_manner_of_vaughan():
    v = values("sliding_free_beam")
    for tf, formula in RIGHT.items():
        for s in POINTS:
            expected = complex(evaluate(formula, v | {"s": mpc(s)}, WHERE))
            assert abs(beam_value(tf, s) - expected) < 1e-12 * abs(expected), (tf, s)


def test_the_printed_tip_formula_is_right_and_the_colocated_one_is_wrong():
    for s in POINTS:
        expected = complex(published("V_tip/F", s))
        assert abs(beam_value("V_tip/F", s) - expected) < 1e-12 * abs(expected), s
        printed = complex(published("V_act/F", s))
        # At low frequency it tends to the same rigid body: S = 0 and C = 1 give 4 either way.
        assert abs(beam_value("V_act/F", s) - printed) > 1e-2 * abs(printed), s


def test_the_printed_colocated_formula_has_a_perfect_square_as_numerator():
    S, C = mpf("0.3"), mpf("-0.7")
    printed = (S**2 + C**2) ** 2 + 2 * S**2 + 2 * C**2 + 1
    assert abs(printed - (S**2 + C**2 + 1) ** 2) < mpf(10) ** -50


def test_the_lowest_mode_is_the_lowest_the_paper_measured():
    v = values("sliding_free_beam")
    assert classics.beam_frequency(classics.sliding_free(1), v) / (2 * pi) == pytest.approx(11, rel=1e-3)


def newton_step(tf, part, s):
    found = derived("sliding_free_beam", tf).to_json_dict()  # what derive --json prints
    return distance_to_root(found[part], values("sliding_free_beam"), found["where"], s)


def laplace(q):
    """Return the s of which q = l sqrt(s/(2 a)), a = sqrt(E I/(rho A))."""
    v = values("sliding_free_beam")
    return 2 * sqrt(v["E"] * v["I"] / (v["rho"] * v["A"])) * (q / v["l"]) ** 2


@pytest.mark.slow
def test_printed_poles_and_zeros_of_the_beam_are_those_of_its_equations():
    v = values("sliding_free_beam")
    for k in range(1, 6):
        pole = mpc(0, classics.beam_frequency(classics.sliding_free(k), v))
        assert all(newton_step(tf, "den", pole) < RELATIVE for tf in RIGHT), k
        # Colocated zeros are modes with the actuator held: 2 + cosh 2q + cos 2q = 0 is cos x cosh x = -1 in
        # x = q (1 - j).
        held = classics.clamped_free(k)
        q = held / mpc(1, -1)
        assert abs(2 + cosh(2 * q) + cos(2 * q)) < mpf(10) ** -30
        assert newton_step("V_act/F", "num", mpc(0, classics.beam_frequency(held, v))) < RELATIVE, k
        # Those of the tip are real pairs: cos q = 0 gives s > 0, cosh q = 0 the same with s < 0.
        for sign in (1, -1):
            assert newton_step("V_tip/F", "num", mpc(sign * laplace((k - mpf(1) / 2) * pi))) < RELATIVE, k


def test_poles_and_colocated_zeros_alternate():
    v = values("sliding_free_beam")
    poles = [classics.beam_frequency(classics.sliding_free(k), v) for k in range(1, 6)]
    zeros = [classics.beam_frequency(classics.clamped_free(k), v) for k in range(1, 7)]
    assert all(zeros[i] < poles[i] < zeros[i + 1] for i in range(5))


def test_the_first_five_pole_pairs_are_found():
    found = derived("sliding_free_beam", "V_act/F").bind().poles(modes=5)
    v = values("sliding_free_beam")
    for k in range(1, 6):
        omega = float(classics.beam_frequency(classics.sliding_free(k), v))
        assert min(abs(complex(root) - 1j * omega) for root in found) < 1e-11 * omega


def test_no_zero_of_the_beam_is_a_zero_of_the_print():
    # S^2 + C^2 + 1 = 0 is exp(-2q) = -1: q = j (k - 1/2) pi, that is, real s, and twice.
    q = mpc(0, pi / 2)
    S, C = mpmath.exp(-q) * sin(q), mpmath.exp(-q) * cos(q)
    assert abs(S**2 + C**2 + 1) < mpf(10) ** -50 < abs(sinh(2 * q) + sin(2 * q))


# ----------------------------------------------------------------------------------------- the robot axis


def robot_axis(v, s):
    """Return V_act/V_cmd and V_tip/V_cmd from the laws of the electronics and the link's field equation."""
    problem = Problem()
    current, angle, force, volts = (problem.unknown() for _ in range(4))
    link = problem.line(bending(v, s))
    w, slope, _, shear = link.start
    w_tip, _, moment_tip, shear_tip = link.at(v["l"])
    problem.require(
        volts
        - (1 - angle * (v["k_tach"] * s)) * (v["k_preamp"] * v["k_amp"])
        + current * (v["k_amp"] * v["k_current"]),
        volts - current * (v["R"] + v["L"] * s) - angle * (v["k_bemf"] * s),
        w - angle * v["r"],
        force * v["r"] - current * v["k_tau"],
        # The screw's force moves the carriage, its friction and the link's first end, which takes +V.
        w * (v["m_car"] * s**2 + v["b_eff"] * s) - force + shear,
        slope,
        moment_tip,
        w_tip * (v["m_grip"] * s**2) - shear_tip,
    )
    solution = problem.solve()
    return solution(w) * s, solution(w_tip) * s


@pytest.mark.slow
def test_the_robot_axis_is_what_its_laws_and_its_field_give():
    for s in (*POINTS, 20 + 68j, -3000 + 1000j):
        for tf, expected in zip(
            ("V_act/V_cmd", "V_tip/V_cmd"),
            map(complex, robot_axis(values("robot_axis"), mpc(s))),
            strict=True,
        ):
            found = complex(derived("robot_axis", tf).bind()(s))
            assert abs(found - expected) < 1e-11 * abs(expected), (tf, s)


def test_the_robot_axis_with_a_stiff_link_is_the_rigid_body():
    v = values("robot_axis")
    total = v["m_car"] + v["m_grip"] + v["rho"] * v["A"] * v["l"]
    rigid = derived("rigid_body", "V_tip/V_cmd").bind(m_eff=float(total))
    stiff = derived("robot_axis", "V_tip/V_cmd").bind(E=1e24)
    assert stiff(3 + 40j) == pytest.approx(rigid(3 + 40j), rel=1e-9)


def test_slowly_the_robot_axis_is_the_rigid_body():
    rigid = derived("rigid_body", "V_tip/V_cmd").bind().dcgain()
    for tf in ("V_act/V_cmd", "V_tip/V_cmd"):
        assert derived("robot_axis", tf).bind().dcgain() == pytest.approx(rigid, rel=1e-12), tf


def test_the_link_vibrates_near_the_lowest_measured_mode_when_the_carriage_is_held():
    v = values("robot_axis") | {"m": values("robot_axis")["m_grip"], "b": mpf(0)}
    pole = classics.loaded_cantilever(mpc(-1, 68), v)
    assert abs(pole) / (2 * pi) == pytest.approx(10.8, rel=5e-3)
