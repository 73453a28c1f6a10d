"""Derivatives of roots, against closed forms, eigenvectors, scaling laws and finite differences."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from flint import acb, ctx

import symflex
from symflex import pipeline
from symflex.analysis.sensitivity.sensitivity import sensitivities
from symflex.balls import to_complex_mpmath as to_complex
from symflex.errors import UsageError
from symflex.quantities import unit_of
from symflex.roots import Modes
from tests.unit.roots.distributed_models import DELAY_LOOP, FREE, KELVIN_VOIGT, ON_A_FOUNDATION

DERIVATIONS = Path(__file__).parents[4] / "derivations"
OSCILLATOR = """
symflex = 1
parameters = { m = "2 kg", b = "3 N*s/m", k = "50 N/m" }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
"""

DEFINED = """
symflex = 1
parameters = { p = "3", u_k = "1 N/m", m = "2 kg" }
inputs.F = { force = "x11" }
outputs.X = "x11"
[definitions]
a = "2*p"
b = "a^2*u_k"
c = "b/2 + b/2"
k = "3*c - 2*c"
[elements]
first = { type = "spring", between = ["x1", "ground"], k = "k" }
""" + "".join(
    f'M{i} = {{ type = "mass", at = "x{i}", m = "m" }}\n'
    + (f'K{i} = {{ type = "spring", between = ["x{i}", "x{i + 1}"], k = "k" }}\n' if i < 11 else "")
    for i in range(1, 12)
)

SIXTH_ORDER = """
symflex = 1
parameters = { c = "2", l = "1.5 m", rho = "3" }
inputs.u = {}
outputs.y = "w'(0)"
[fields.w]
domain = ["0", "l"]
equation = "c*w'''''' - rho*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = u", "w''''(0) = 0", "w(l) = 0", "w''(l) = 0", "w''''(l) = 0"]
"""


def moved(model, modes=None, names=(), digits=15, tf=None):
    pair = tf or model.transfer_functions[0]
    (bound,) = pipeline.derive_bound(model, [pair])
    found = pipeline.roots(bound, modes and Modes(modes), digits)
    return sensitivities(model, bound, found, names, digits)


def by_name(found, kind="pole"):
    """Return per root with a positive imaginary part a dict of its sensitivities."""
    grouped = {}
    for one in found:
        if one.kind == kind and one.root.im > 0:
            grouped.setdefault(one.index, {})[one.parameter.name] = one
    return list(grouped.values())


def close(ball, expected, digits=12):
    error = abs(number(ball) - mpmath.mpmathify(expected))
    return error <= mpmath.mpf(10) ** -digits * max(1, abs(mpmath.mpmathify(expected)))


def number(ball):
    return to_complex(acb(ball))


# ------------------------------------------------------------------------------------------ closed forms


def test_a_mass_on_a_spring_with_a_damper():
    # m s^2 + b s + k = 0 by hand: ds/dm = -s^2/(2 m s + b), ds/db = -s/(2 m s + b), ds/dk = -1/(2 m s + b).
    with mpmath.workdps(30):
        s = (-3 + mpmath.sqrt(9 - 4 * 2 * 50)) / 4
        expected = {"m": -(s**2) / (4 * s + 3), "b": -s / (4 * s + 3), "k": -1 / (4 * s + 3)}
        (pole,) = by_name(moved(pipeline.loads(OSCILLATOR), digits=25))
        for name, value in expected.items():
            assert pole[name].status == "certified"
            assert close(pole[name].derivative, value, 24)
            # omega_n = sqrt(k/m) and zeta = b/(2 sqrt(k m)).
        omega, zeta = mpmath.sqrt(25), 3 / (2 * mpmath.sqrt(100))
        assert close(pole["k"].frequency, omega / 100 / (2 * mpmath.pi), 20)
        assert close(pole["b"].frequency, 0, 20)
        assert close(pole["b"].damping_ratio, zeta / 3, 20)
        assert close(pole["m"].damping_ratio, -zeta / 4, 20)
        assert close(pole["m"].normalised.real, -0.5, 20)


def test_the_enclosure_holds_the_exact_derivative():
    # 4 s^2 + 25 = 0: s = 5j/2 and ds/dk = -1/(8 s) = j/20.
    undamped = '{ value = "0 N*s/m", assume = "nonnegative" }'
    text = OSCILLATOR.replace('"2 kg"', '"4 kg"').replace('"3 N*s/m"', undamped).replace("50 N", "25 N")
    (pole,) = by_name(moved(pipeline.loads(text)))
    with ctx.workprec(200):
        assert pole["k"].derivative.contains(acb(0, 1) / 20)
        assert pole["k"].derivative.rad() < 1e-20
        # The undamped mode is damped first of all: dzeta/db = 1/(2 sqrt(k m)) at b = 0.
        assert pole["b"].damping_ratio.contains(acb(1).real / 20)
    assert pole["b"].normalised == 0


@pytest.mark.parametrize("name", ["clamped_free", "free_free"])
def test_frequencies_of_beams_scale_as_the_textbooks_say(name):
    # omega = x^2 sqrt(E I/(rho A))/l^2 (Blevins 1979, table 8-1).
    poles = by_name(moved(pipeline.load(DERIVATIONS / f"classics/{name}.toml"), 3))
    assert len(poles) == 3
    for pole in poles:
        shown = {n: round(float(s.normalised.real), 10) for n, s in pole.items()}
        assert shown == {"E": 0.5, "I": 0.5, "rho": -0.5, "A": -0.5, "l": -2}
        assert all(abs(float(s.normalised.imag)) < 1e-12 for s in pole.values())


def test_a_kelvin_voigt_beam_between_pins():
    # Mode n: s^2 + eta omega^2 s + omega^2 = 0 with omega^2 = E I (n pi/l)^4/(rho A).
    poles = by_name(moved(pipeline.loads(KELVIN_VOIGT), 2, digits=20))
    at = {"E": mpmath.mpf(1), "eta": mpmath.mpf(4) / 1000, "l": mpmath.mpf(1)}

    def root(n, **changed):
        here = {**at, **changed}
        square = here["E"] * (n * mpmath.pi / here["l"]) ** 4
        return (-here["eta"] * square + mpmath.sqrt((here["eta"] * square) ** 2 - 4 * square)) / 2

    with mpmath.workdps(30):
        for n, pole in enumerate(poles, start=1):
            for name, value in at.items():
                slope = mpmath.diff(lambda x, n=n, name=name: root(n, **{name: x}), value)
                assert close(pole[name].derivative, slope, 12), name


@pytest.mark.slow
def test_waves_without_a_formula():
    # rho w_tt = c w'''''' with w = w'' = w'''' = 0 at both ends: s^2 = -(c/rho) (n pi/l)^6, by inspection.
    model = pipeline.loads(SIXTH_ORDER)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    assert bound.source.is_nameless
    poles = by_name(moved(model, 2))
    assert len(poles) == 2
    for n, pole in enumerate(poles, start=1):
        assert float(pole["c"].place.imag) == pytest.approx((n * np.pi / 1.5) ** 3 * (2 / 3) ** 0.5)
        shown = {name: round(float(s.normalised.real), 9) for name, s in pole.items()}
        assert shown == {"c": 0.5, "l": -3, "rho": -0.5}


def test_a_loop_with_a_delay():
    # s + K exp(-s T) = 0: s = W(-K T)/T with any branch of Lambert's function.
    text = DELAY_LOOP.replace("2*D*y", "K*D*y").replace('T = "0.5 s"', 'T = "T"')
    text = text.replace("[signals]", '[parameters]\nK = "2 1/s"\nT = "0.5 s"\n[signals]')
    poles = by_name(moved(pipeline.loads(text), 3))
    with mpmath.workdps(30):
        for pole in poles:
            s = number(pole["K"].place)
            branch = min(
                range(-6, 7), key=lambda k: abs(mpmath.lambertw(mpmath.mpf(-1), k) / mpmath.mpf("0.5") - s)
            )
            slope = mpmath.diff(lambda K, k=branch: mpmath.lambertw(-K / 2, k) * 2, mpmath.mpf(2))
            assert close(pole["K"].derivative, slope)
            slope = mpmath.diff(lambda T, k=branch: mpmath.lambertw(-2 * T, k) / T, mpmath.mpf("0.5"))
            assert close(pole["T"].derivative, slope)


def test_a_wavenumber_that_may_vanish():
    # A string on a foundation with a mass at its end: with N, k_f, rho and m all multiplied by one number
    # nothing moves.
    text = ON_A_FOUNDATION
    for name, unit in (("m", "2 kg"), ("N", "1 N"), ("rho", "1 kg/m^3"), ("k_f", "1 N/m^2")):
        text = text.replace(f'"{unit}"', f'"{name}"') if name == "m" else text
        text = text.replace(f'{name.ljust(7)} = "{unit}"', f'{name.ljust(7)} = "{name}"')
    values = 'm = "2 kg"\nN = "1 N"\nrho = "1 kg/m^3"\nk_f = "1 N/m^2"\n'
    model = pipeline.loads(text.replace("[elements]", f"[parameters]\n{values}[elements]", 1))
    poles = by_name(moved(model, 2))
    assert [set(pole) for pole in poles] == [{"m", "N", "rho", "k_f"}] * 2
    for pole in poles:
        assert float(sum(s.normalised.real for s in pole.values())) == pytest.approx(0, abs=1e-12)
        # Time: m and rho bear kg, N and k_f bear kg/s^2.
        assert float(pole["N"].normalised.real + pole["k_f"].normalised.real) == pytest.approx(0.5)


def test_functions_of_constants_definitions_and_cycles():
    # s = -sqrt(k/m)^3 - 2 pi f exp(-c)
    text = """
    symflex = 1
    parameters = { k = "9 N/m", m = "4 kg", f = "11 Hz", c = "0.5" }
    definitions.w = "sqrt(k/m)"
    inputs.u = {}
    signals.y_1 = "u/(s + 2*w + f*exp(-c))"
    outputs.y = "y_1"
    """
    found = {s.parameter.name: s for s in moved(pipeline.loads(text))}
    decay = 22 * np.pi * np.exp(-0.5)
    whole = 2 * 1.5 + decay
    expected = {"k": 1.5 / whole, "m": -1.5 / whole, "f": decay / whole, "c": -0.5 * decay / whole}
    assert {n: float(s.normalised.real) for n, s in found.items()} == pytest.approx(expected)


# ------------------------------------------------------------------------------------------- eigenvectors


def test_a_chain_by_its_eigenvectors():
    # d(omega^2)/dk = (phi_i - phi_j)^2/(phi^T M phi), d(omega^2)/dm = -omega^2 phi_i^2/(phi^T M phi)
    # (Fox and Kapoor 1968).
    masses, springs = [2.0, 3.0, 1.5, 4.0], [500.0, 700.0, 300.0, 900.0]
    values = "\n".join(
        [f'm_{i} = "{m} kg"' for i, m in enumerate(masses)]
        + [f'k_{i} = "{k} N/m"' for i, k in enumerate(springs)]
    )
    parts = "\n".join(
        f'B_{i} = {{ type = "mass", at = "x_{i}", m = "m_{i}" }}\n'
        f'S_{i} = {{ type = "spring", between = ["{near}", "x_{i}"], k = "k_{i}" }}'
        for i, near in enumerate(("ground", "x_0", "x_1", "x_2"))
    )
    model = pipeline.loads(
        f"symflex = 1\n[parameters]\n{values}\n[elements]\n{parts}\n"
        '[inputs]\nF = { force = "x_3" }\n[outputs]\nX = "x_3"\n'
    )
    stiffness = np.zeros((4, 4))
    for i, k in enumerate(springs):
        stiffness[i, i] += k
        if i:
            stiffness[i - 1, i - 1] += k
            stiffness[i, i - 1] -= k
            stiffness[i - 1, i] -= k
    root = np.diag(np.sqrt(masses))
    squares, vectors = np.linalg.eigh(np.linalg.inv(root) @ stiffness @ np.linalg.inv(root))
    shapes = np.linalg.inv(root) @ vectors  # phi^T M phi = 1
    poles = by_name(moved(model))
    for square, phi, pole in zip(squares, shapes.T, poles, strict=True):
        for i in range(4):
            stretch = phi[i] - (phi[i - 1] if i else 0)
            omega = square**0.5
            assert float(pole[f"k_{i}"].derivative.imag) == pytest.approx(stretch**2 / (2 * omega))
            assert float(pole[f"m_{i}"].derivative.imag) == pytest.approx(-omega * phi[i] ** 2 / 2)


# ------------------------------------------------------------------------------------ finite differences


MOTOR_VALUES = {
    "L": ("2e-3", "H"),
    "R": ("0.8", "ohm"),
    "k_t": ("0.05", "N*m/A"),
    "k_e": ("0.05", "V*s/rad"),
    "J_1": ("1e-4", "kg*m^2"),
    "J_2": ("3e-4", "kg*m^2"),
    "k": ("20", "N*m/rad"),
    "b": ("0.002", "N*m*s/rad"),
    "d": ("0.001", "N*m*s/rad"),
}
WINDING = 'L = "L", R = "R", k_t = "k_t", k_e = "k_e"'
MOTOR = f"""
symflex = 1
parameters = {{ {", ".join(f'{n} = "{v} {unit}"' for n, (v, unit) in MOTOR_VALUES.items())} }}
inputs.V = {{ voltage = "v" }}
outputs.angle = "c"
[elements]
motor = {{ type = "dc_motor", terminals = ["v", "ground"], shaft = "a", {WINDING} }}
rotor = {{ type = "inertia", at = "a", J = "J_1" }}
load = {{ type = "inertia", at = "c", J = "J_2" }}
shaft = {{ type = "torsion_spring", between = ["a", "c"], k = "k" }}
loss = {{ type = "rotary_damper", between = ["a", "c"], b = "b" }}
bearing = {{ type = "rotary_damper", between = ["c", "ground"], b = "d" }}
"""


def motor_polynomial(L, R, k_t, k_e, J_1, J_2, k, b, d):
    """Return the coefficients of (L s + R) det + k_t k_e s (J_2 s^2 + (b + d) s + k), highest first."""
    link = [b, k]
    first = [J_1, b, k]
    second = [J_2, b + d, k]
    determinant = np.polysub(np.polymul(first, second), np.polymul(link, link))
    return np.polyadd(np.polymul([L, R], determinant), np.polymul([k_t * k_e, 0], second))


@pytest.mark.slow
def test_a_motor_and_a_flexible_load_by_finite_differences():
    found = moved(pipeline.loads(MOTOR), digits=25)
    assert all(s.status == "certified" for s in found)
    with mpmath.workdps(60):
        values = {n: mpmath.mpf(v) for n, (v, _) in MOTOR_VALUES.items()}

        def roots(**changed):
            coefficients = list(motor_polynomial(**{**values, **changed}))
            return mpmath.polyroots(coefficients, maxsteps=500, extraprec=400)

        for name, value in values.items():
            step = value * mpmath.mpf(10) ** -15
            beside = [roots(**{name: value + h}) for h in (step, -step)]
            for s in found:
                if s.kind != "pole" or s.root.is_zero or s.parameter.name != name:
                    continue
                place = number(s.place)
                above, below = (min(each, key=lambda r, p=place: abs(r - p)) for each in beside)
                slope = (above - below) / (2 * step)
                assert abs(number(s.derivative) - slope) < abs(slope) * mpmath.mpf(10) ** -20, name


@pytest.mark.slow
def test_a_lossy_beam_with_a_mass_and_a_dashpot_by_finite_differences():
    # 1 + cos x cosh x + m/(rho A l) x (cos x sinh x - sin x cosh x) = 0 with x^4 = -rho A s^2 l^4/(E* I),
    # where m stands for m + b/s and E* for E (1 + eta s) (Rao 2007, section 11.5).
    model = pipeline.load(DERIVATIONS / "classics/kelvin_voigt_cantilever.toml")
    poles = by_name(moved(model, 3, digits=25))
    at = dict(E="200e9", I="4e-9", rho="7850", A="480e-6", l="1", eta="20e-6", m="1.5", b="4")
    with mpmath.workdps(60):
        values = {n: mpmath.mpf(v) for n, v in at.items()}

        def equation(s, E, I, rho, A, l, eta, m, b):  # noqa: E741
            stiffness = E * (1 + eta * s) * I
            x = mpmath.root(-rho * A * s**2 / stiffness, 4) * l
            mass = (m * s**2 + b * s) / (stiffness * (x / l) ** 3)
            bent = mpmath.cos(x) * mpmath.sinh(x) - mpmath.sin(x) * mpmath.cosh(x)
            return 1 + mpmath.cos(x) * mpmath.cosh(x) - mass * bent

        def root_near(place, **changed):
            at = {**values, **changed}
            start = (place, place * (1 + mpmath.mpf(10) ** -12))
            return mpmath.findroot(lambda z: equation(z, **at), start, solver="secant")

        for pole in poles:
            for name, s in pole.items():
                step, place = values[name] * mpmath.mpf(10) ** -15, number(s.place)
                above, below = (root_near(place, **{name: values[name] + h}) for h in (step, -step))
                slope = (above - below) / (2 * step)
                assert abs(number(s.derivative) - slope) < abs(slope) * mpmath.mpf(10) ** -18, name


# ------------------------------------------------------------------------------------------ scaling laws


SCALED = (
    "eppinger1988/rigid_body",
    "classics/shaft_discs",
    "classics/timoshenko_cantilever",
    "frames/l_frame",
)
"""A motor and gears, a rotation with lumped ends, two wavenumbers, and a frame."""


@pytest.mark.parametrize("name", SCALED)
def test_units_scale_all_parameters_at_once(name):
    # A root is in 1/s. If every parameter is read in another unit of time, length or mass, so is the root:
    # the sum of exponents times (p/s) ds/dp is the exponent in s (Buckingham 1914, differentiated).
    model = pipeline.load(DERIVATIONS / f"{name}.toml")
    units = {p.name: unit_of(p.unit).dimension for p in model.parameters if p.unit}
    sums = {}
    for s in moved(model, 3):
        if s.normalised is None:
            continue
        total = sums.setdefault((s.kind, s.index), {"kg": 0, "m": 0, "s": 0})
        for base in total:
            exponent = getattr(units.get(s.parameter.name), base, 0)
            total[base] += float(exponent) * complex(s.normalised)
    for total in sums.values():
        assert total["kg"] == pytest.approx(0, abs=1e-9)
        assert total["m"] == pytest.approx(0, abs=1e-9)
        assert total["s"] == pytest.approx(-1, abs=1e-9)


# ------------------------------------------------------------------------------------ where there is none


TWINS = """
symflex = 1
parameters = { a = "2 1/s", b = "2 1/s", c = "3 1/s" }
inputs.u = {}
outputs.y = "u/((s + a)*(s + b)*(s + c)^2*s)"
"""


def test_roots_that_part_have_no_derivative():
    shown = {(round(float(s.root.re)), s.parameter.name): s for s in moved(pipeline.loads(TWINS))}
    assert {n: shown[-2, n].status for n in "abc"} == {"a": "multiple", "b": "multiple", "c": "certified"}
    assert shown[-2, "a"].derivative is None
    assert shown[-2, "c"].derivative == 0
    assert shown[-2, "a"].normalised is None
    # Twice the same factor: the root stays double, and moves.
    assert complex(shown[-3, "c"].derivative) == -1
    assert shown[-3, "a"].derivative == 0
    # A root at 0 for all values of the parameters stays there.
    assert shown[0, "a"].derivative == 0
    assert shown[0, "a"].normalised is None


def test_roots_that_nearly_meet_run_apart_fast():
    # b^2 = 4 k m is nearly met: s = (-b +- sqrt(b^2 - 144))/4 and ds/dk = -1/(4 s + b).
    b = "12.00000000000000000001"
    text = OSCILLATOR.replace('"50 N/m"', '"18 N/m"').replace('"3 N*s/m"', f'"{b} N*s/m"')
    found = moved(pipeline.loads(text), names=["k"], digits=6)
    with mpmath.workdps(80):
        root = mpmath.sqrt(mpmath.mpf(b) ** 2 - 144)
        for s, expected in zip(found, (-1 / root, 1 / root), strict=True):
            assert s.status == "certified"
            assert abs(number(s.derivative) / expected - 1) < 1e-6


def test_an_enclosure_that_holds_no_root_gives_no_derivative():
    model = pipeline.loads(OSCILLATOR)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = pipeline.roots(bound, None, 15)
    wrong = tuple(replace(root, im=root.im + 1) for root in found.poles)
    shown = sensitivities(model, bound, replace(found, poles=wrong))
    assert {(s.status, s.derivative) for s in shown} == {("undecided", None)}


def test_rigid_body_motion_of_a_beam_stays_at_zero():
    fixed = [s for s in moved(pipeline.loads(FREE), 1) if s.root.is_zero]
    assert {(s.kind, s.root.multiplicity) for s in fixed} == {("pole", 2)}
    assert all(s.derivative == 0 and s.status != "undecided" for s in fixed)


def test_a_root_at_zero_by_the_values_alone_moves():
    text = OSCILLATOR.replace('"50 N/m"', '{ value = "0 N/m", assume = "nonnegative" }')
    found = {s.parameter.name: s for s in moved(pipeline.loads(text)) if s.root.is_zero}
    # m s^2 + b s + k = 0 at s = 0: ds/dk = -1/b.
    with ctx.workprec(200):
        assert found["k"].derivative.contains(-acb(1) / 3)
    assert found["m"].derivative.contains(0)
    assert found["k"].normalised is None


def test_a_square_root_at_zero_has_no_slope():
    text = """
    symflex = 1
    parameters = { k = { value = "0", assume = "nonnegative" }, c = "2", T = "1 s" }
    inputs.u = {}
    outputs.y = "u/(s*T + c + sqrt(k))"
    """
    found = {s.parameter.name: s.status for s in moved(pipeline.loads(text))}
    assert found == {"k": "undecided", "c": "certified", "T": "certified"}


def test_an_output_that_is_zero_has_no_roots_to_move():
    text = OSCILLATOR.replace('outputs.X = "x"', 'outputs.X = "0*x"')
    assert moved(pipeline.loads(text)) == ()


def test_a_nested_model_s_parameters_count(tmp_path):
    (tmp_path / "inner.toml").write_text(OSCILLATOR)
    outer = tmp_path / "outer.toml"
    outer.write_text(
        'symflex = 1\n[blocks]\nG = { type = "model", spec = "inner.toml", tf = "X/F" }\n'
        '[inputs]\nu = {}\n[outputs]\ny = "G*u"\n'
    )
    (pole,) = by_name(moved(pipeline.load(outer)))
    assert float(pole["k"].normalised.real) == pytest.approx(0.5)
    # With another value: s^2 = -k/m, ds/dk = -1/(2 m s).
    H = symflex.load(outer).transfer_function("y", "u").bind(m=8, b=0)
    assert complex(H.sensitivities(parameters=["k"])[0].derivative) == pytest.approx(1j / (16 * 2.5))


def test_only_parameters_that_there_are_can_be_asked_for():
    with pytest.raises(UsageError, match=r"SF902.*there is no parameter 'kk'"):
        moved(pipeline.loads(OSCILLATOR), names=["kk"])
    asked = moved(pipeline.loads(OSCILLATOR), names=["k", "m"])
    assert {s.parameter.name for s in asked} == {"k", "m"}


# ------------------------------------------------------------------------------------------ Python, formula


def test_the_values_given_to_bind_count():
    H = symflex.loads(OSCILLATOR).transfer_function("X", "F").bind(b=0, m=Fraction(1, 2))
    (upper, _) = H.sensitivities(parameters=["k"])
    # s = sqrt(50/0.5) j = 10 j; ds/dk = -1/(2 m s) = j/10.
    assert complex(upper.derivative) == pytest.approx(0.1j)
    assert (upper.kind, upper.parameter, upper.status) == ("pole", "k", "certified")
    assert complex(upper.root) == pytest.approx(10j)
    assert upper.radius < 1e-15
    assert complex(upper.normalised) == pytest.approx(0.5)
    assert float(upper.frequency) == pytest.approx(0.1 / (2 * np.pi))
    assert float(upper.damping_ratio) == pytest.approx(0)


def test_the_formula_of_the_oscillator():
    import sympy

    m, b, k = (sympy.Symbol(n, positive=True) for n in "mbk")
    s = sympy.Symbol("s")
    above, below = symflex.loads(OSCILLATOR).transfer_function("X", "F").sensitivity_formula("m")
    assert sympy.simplify(above / below + s**2 / (2 * m * s + b)) == 0
    assert not (above / below).has(k)


@pytest.mark.parametrize(
    ("name", "parameter"),
    [pytest.param("kelvin_voigt_cantilever", "E", marks=pytest.mark.slow), ("clamped_free", "l")],
)
def test_the_formula_has_the_values_of_the_enclosures(name, parameter):
    import sympy

    G = symflex.load(DERIVATIONS / f"classics/{name}.toml").transfer_functions()[0]
    moving = next(
        s
        for s in G.bind().sensitivities(2, parameters=[parameter], digits=20)
        if s.moved.root.im > 0 and s.kind == "pole"
    )
    quotient = sympy.Mul(*G.sensitivity_formula(parameter), evaluate=False).args
    symbols = sorted(sympy.Tuple(*quotient).free_symbols, key=str)
    above, below = (sympy.lambdify(symbols, part, "mpmath") for part in G.sensitivity_formula(parameter))
    with mpmath.workdps(50):
        at = {
            p.name: mpmath.mpf(p.value.rational.numerator) / p.value.rational.denominator
            for p in G.exact.model.parameters
        }
        at["s"] = number(moving.moved.place)
        arguments = [at[str(x)] for x in symbols]
        assert abs(above(*arguments) / below(*arguments) / moving.derivative - 1) < 1e-15


def test_the_formula_of_a_zero_and_of_nothing():
    G = symflex.load(DERIVATIONS / "eppinger1988/two_mass.toml").transfer_functions()[0]
    above, below = G.sensitivity_formula("m_2", of="zero")
    assert str(above) == "-s**2"
    assert G.sensitivity_formula("m_1", of="zero") == (0, 1)
    assert {str(x) for x in below.free_symbols} == {"s", "m_2", "b"}
    with pytest.raises(UsageError, match="there is no parameter 'kk'"):
        G.sensitivity_formula("kk")
    with pytest.raises(UsageError, match="there is no root called 'pol'"):
        G.sensitivity_formula("k", of="pol")


def test_waves_without_a_formula_have_no_formula_of_sensitivity():
    G = symflex.loads(SIXTH_ORDER).transfer_function("y", "u")
    with pytest.raises(UsageError, match=r"SF902.*no formula"):
        G.sensitivity_formula("c")


def test_a_long_chain_does_not_say_that_a_zero_parts_which_is_double_for_all_values():
    # Two couplings pass on k + d s: the zero -k/d is double whatever k and d are.
    nodes = ["ground", *(f"x{i}" for i in range(1, 13))]
    lines = [f'm{i} = {{ type = "mass", at = "x{i}", m = "m" }}' for i in range(1, 13)]
    for i in range(12):
        ends = f'between = ["{nodes[i]}", "{nodes[i + 1]}"]'
        lines.append(f'k{i} = {{ type = "spring", {ends}, k = "k" }}')
        lines += [f'd{i} = {{ type = "damper", {ends}, b = "d" }}'] * (i in {3, 7})
    head = 'symflex = 1\nparameters = { m = "1 kg", k = "1 kN/m", d = "2 N*s/m" }\n'
    head += 'inputs = { F = { force = "x12" } }\noutputs = { X = "x1" }\n[elements]\n'
    shown = [s for s in moved(pipeline.loads(head + "\n".join(lines))) if s.kind == "zero"]
    assert {(complex(s.root), s.status) for s in shown} == {(-500, "undecided")}


def test_a_parameter_moves_roots_through_definitions_of_definitions():
    # All springs are 4 p^2: natural frequencies of this chain of 22 elements are as p, and as m^-1/2.
    for each in (m for m in moved(pipeline.loads(DEFINED), 2) if m.parameter.name != "u_k"):
        right = 1 if each.parameter.name == "p" else -0.5
        assert each.status == "certified"
        assert complex(to_complex(each.normalised)) == pytest.approx(right, abs=1e-12)
