"""The models of ``derivations/tapers`` against collocation, closed forms, Bessel functions and tables."""

from math import cos, exp, isclose, sin, sqrt, tan
from pathlib import Path

import numpy as np
import pytest

from symflex import pipeline
from symflex.roots import Modes
from symflex.transfer import bind
from tests.independent.test_tapers import propagated

FOLDER = Path(__file__).parents[2] / "derivations" / "tapers"
POINTS = (30 + 200j, -100 + 3000j, 5j)


def bound(name):
    model = pipeline.load(FOLDER / f"{name}.toml")
    return pipeline.derive_bound(model, model.transfer_functions[:1])[0]


def given(name):
    model = pipeline.load(FOLDER / f"{name}.toml")
    return {p.name: float(p.value.nearly) for p in model.parameters if p.value}


def slender(stiffness, mass, tension=lambda x: 0 * x):
    """Return the coefficients of states y, y', force and moment: f = -M' + N y'."""

    def matrix(x, s):
        m = np.zeros((4, 4), dtype=complex)
        m[0, 1], m[1, 3], m[3, 2], m[3, 1] = 1, 1 / stiffness(x), -1, tension(x)
        m[2, 0] = mass(x) * s**2
        return m

    return matrix


def tip_of_cantilever(matrix, length, s):
    z = propagated(matrix, length, s, (1.0, 1.0, 1e3, 1e3))
    return (z[:2, 2:] @ np.linalg.solve(z[2:, 2:], [1, 0]))[0]


def cantilevers():
    v = given("double_taper")
    i, a = v["h"] ** 4 / 12, v["h"] ** 2
    yield (
        "double_taper",
        v["l"],
        slender(
            lambda x: v["E"] * i * (1 - v["c"] * x / v["l"]) ** 4,
            lambda x: v["rho"] * a * (1 - v["c"] * x / v["l"]) ** 2,
        ),
    )
    w = given("exponential_taper")
    yield (
        "exponential_taper",
        w["l"],
        slender(lambda x: w["EI"] * np.exp(-2 * w["a"] * x), lambda x: w["rhoA"] * np.exp(-2 * w["a"] * x)),
    )
    u = given("turning_blade")
    yield (
        "turning_blade",
        u["l"],
        slender(
            lambda x: u["EI"],
            lambda x: u["rhoA"],
            lambda x: u["rhoA"] * u["Omega"] ** 2 * (u["l"] ** 2 - x**2) / 2,
        ),
    )
    t = given("timoshenko_taper")
    depth = lambda x: t["h"] * (1 - x / (2 * t["l"]))  # noqa: E731
    plain = slender(lambda x: t["E"] * t["b"] * depth(x) ** 3 / 12, lambda x: t["rho"] * t["b"] * depth(x))

    def thick(x, s):
        m = plain(x, s)
        m[0, 2] = 1 / (t["kappa"] * t["G"] * t["b"] * depth(x))
        m[3, 1] = t["rho"] * t["b"] * depth(x) ** 3 / 12 * s**2
        return m

    yield "timoshenko_taper", t["l"], thick


@pytest.mark.slow
@pytest.mark.parametrize(("name", "length", "matrix"), [pytest.param(*c, id=c[0]) for c in cantilevers()])
def test_cantilevers_answer_as_collocation_does(name, length, matrix):
    found = bound(name)
    for s in POINTS if name != "turning_blade" else (0.3 + 2j, -1 + 30j, 5j):
        assert found(s) == pytest.approx(tip_of_cantilever(matrix, length, s), rel=1e-8)


def frequencies(name, count, **changed):
    located = pipeline.roots(bind(bound(name).source, changed), Modes(count))
    assert located.certificate.certified
    return [float(root.im.mid()) for root in located.poles if root.im > 0]


def prints(value, printed):
    """Tell whether a value rounds to what is printed."""
    digits = len(printed.partition(".")[2])
    return f"{value:.{digits}f}" == printed


@pytest.mark.slow
def test_the_printed_frequencies_of_the_double_taper_are_right_but_for_last_digits():
    """Ozdemir Ozgumus & Kaya 2006: 5.00903, 19.0649 and 45.7384, at taper ratios of 0.6.

    A later table (Int. J. Mech. Mater. Eng. 10, 2015, table 1) has 45.7391 for the third.
    """
    v = given("double_taper")
    unit = sqrt(v["E"] * v["h"] ** 2 / 12 / v["rho"]) / v["l"] ** 2
    first, second, third = (omega / unit for omega in frequencies("double_taper", 3))
    assert prints(first, "5.00903")
    assert prints(second, "19.0649")
    assert prints(third, "45.7384")
    assert not prints(third, "45.7391")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rate", "printed"),
    [("0", ("3.5160", "22.0345")), ("1", ("3.6816", "22.1810")), ("6", ("7.3604", "26.8091"))],
)
def test_the_turning_blade_has_the_printed_frequencies(rate, printed):
    """Wright, Smith, Thresher & Wang 1982, table 1, in units of sqrt(EI/(rho A))/l^2."""
    found = frequencies("turning_blade", 2, Omega=rate)
    assert all(prints(value, text) for value, text in zip(found, printed, strict=True))


def test_the_conical_horn_is_a_uniform_rod_in_u_times_the_diameter():
    # u (1 - c x/l) = a cos(k x) + b sin(k x); at the free end u' = 0.
    v, found = given("conical_horn"), bound("conical_horn")
    for omega in (4000.0, 60000.0, 150000.0):
        k, d = omega * sqrt(v["rho"] / v["E"]), 1 - v["c"]
        c, s = cos(k * v["l"]), sin(k * v["l"])
        b = -(-k * s * d + c * v["c"] / v["l"]) / (k * c * d + s * v["c"] / v["l"])
        assert found(1j * omega) == pytest.approx((c + b * s) / d, rel=1e-11)


def test_the_conical_horn_has_the_poles_of_its_closed_form_and_no_zeros():
    """A base that is driven and a tool that is free: tan(q) = -q (1 - c)/c with q = omega l sqrt(rho/E)."""
    v, located = given("conical_horn"), pipeline.roots(bound("conical_horn"), Modes(3))
    assert located.certificate.certified and not located.zeros
    for pole in located.poles[::2]:
        q = abs(float(pole.im)) * v["l"] * sqrt(v["rho"] / v["E"])
        assert isclose(tan(q), -q * (1 - v["c"]) / v["c"], rel_tol=1e-11)


@pytest.mark.slow
def test_the_exponential_horn_is_a_rod_with_a_cut_off():
    # u = exp(a x) (cos(q x) + b sin(q x)), q^2 = k^2 - a^2 (Webster 1919); at the free end u' = 0.
    v, found = given("exponential_horn"), bound("exponential_horn")
    for omega in (60000.0, 150000.0):
        q = sqrt(omega**2 * v["rho"] / v["E"] - v["a"] ** 2)
        c, s, a = cos(q * v["l"]), sin(q * v["l"]), v["a"]
        b = (q * s - a * c) / (q * c + a * s)
        assert found(1j * omega) == pytest.approx(exp(a * v["l"]) * (c + b * s), rel=1e-11)


@pytest.mark.slow
def test_wedge_cone_and_hanging_string_have_their_printed_frequencies():
    """5.315, 15.207, 30.02 and 8.719, 21.146, 38.45 (Conway & Dubil 1965); half the zeros of J_0."""
    for name, printed in (("wedge", (5.315, 15.207, 30.02)), ("cone", (8.719, 21.146, 38.45))):
        v = given(name)
        unit = sqrt(v["EI"] / v["rhoA"]) / v["l"] ** 2
        for omega, wanted in zip(frequencies(name, 3), printed, strict=True):
            assert isclose(omega / unit, wanted, rel_tol=2e-4)
    v = given("hanging_string")
    for omega, zero in zip(
        frequencies("hanging_string", 3),
        (2.404825557695773, 5.520078110286311, 8.653727912911013),
        strict=True,
    ):
        assert isclose(omega, zero / 2 * sqrt(v["g"] / v["l"]), rel_tol=1e-13)


@pytest.mark.slow
def test_the_arm_between_motor_and_gripper_answers_as_collocation_does():
    v, found = given("tapered_arm"), bound("tapered_arm")
    i, a = v["b"] * v["h"] ** 3 / 12, v["b"] * v["h"]
    thin = lambda x: 1 - 2 * x / (3 * v["l"])  # noqa: E731
    matrix = slender(lambda x: v["E"] * i * thin(x) ** 3, lambda x: v["rho"] * a * thin(x))
    for s in (-2 + 20j, 10 + 300j, 900j):
        z = propagated(matrix, v["l"], s, (1.0, 1.0, 1e3, 1e3))
        # From the hub's theta, force and moment, y being 0, to the gripper: f = -m s^2 y, tau = -J s^2 theta.
        load = np.array([[v["m"] * s**2, 0, 1, 0], [0, v["J"] * s**2, 0, 1]]) @ z[:, 1:]
        force, moment = np.linalg.solve(load[:, 1:], -load[:, 0])
        drive = v["K"] * (1 + v["T"] * s)
        hub = v["n"] ** 2 * (v["J_m"] * s**2 + v["b_m"] * s)
        theta = v["K"] / (hub + drive - moment)
        del force
        assert found(s) == pytest.approx(theta, rel=1e-8)
