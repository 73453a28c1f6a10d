"""What python-control, scipy and SymPy make of bound transfer functions, with these programs themselves."""

import math
import sys
from fractions import Fraction
from pathlib import Path

import control
import mpmath
import numpy as np
import pytest
import sympy
from sympy.physics.control import TransferFunction as SympyTransferFunction

import symflex
from symflex.errors import ModelError, UsageError
from symflex.state_space.cascade import cascade
from symflex.state_space.numeric import response
from tests.unit.analysis.systems import words
from tests.unit.refusals import refusal

DERIVATIONS = Path(__file__).parents[4] / "derivations"
PAPER = DERIVATIONS / "eppinger1988"
LUMPED = [("two_mass", "X_tip"), ("rigid_body", "A_tip"), ("polynomial_resonance", "A_tip")]


def bound(name, output):
    model = symflex.load(PAPER / f"{name}.toml")
    return model.transfer_function(output, model.inputs[0]).bind()


def rational(expression, more=""):
    model = symflex.loads(f'symflex = 1\n{more}\ninputs.u = {{}}\noutputs.y = "{expression}"')
    return model.transfer_function("y", "u").bind()


@pytest.fixture(scope="module")
def beam():
    model = symflex.load(DERIVATIONS / "classics" / "clamped_free.toml")
    return model.transfer_function("W_tip", "F").bind()


def frequencies(H):
    low, high = H.bound.source.model.analysis.band or (0.1, 1e3)
    return 2 * math.pi * np.geomspace(float(low), float(high), 60)


# --------------------------------------------------------------------------------------- what is equal


CONVERSIONS = {
    "control": (lambda H, w: H.to_control()(1j * w), 3e-13),
    # control solves (j omega - A) x = b with states in m and m/s: cancellation costs more there
    "control state-space": (lambda H, w: H.to_control("state-space", minimal=True)(1j * w), 1e-8),
    "frd": (lambda H, w: H.to_frd(w)(1j * w), 1e-15),
    "scipy": (lambda H, w: H.to_scipy().freqresp(w)[1], 3e-14),
    "scipy transfer function": (lambda H, w: H.to_scipy("transfer-function").freqresp(w)[1], 3e-13),
}


@pytest.mark.filterwarnings("ignore::scipy.signal.BadCoefficients")
@pytest.mark.parametrize(("name", "output"), LUMPED)
def test_what_other_programs_get_is_the_function(name, output):
    H = bound(name, output)
    omega = frequencies(H)
    exact = np.array([H(1j * w) for w in omega])
    off = {n: np.max(np.abs(act(H, omega) / exact - 1)) / limit for n, (act, limit) in CONVERSIONS.items()}
    assert max(off.values()) < 1, off
    # Zeros and poles are the certified ones.
    system, control_poles = H.to_scipy(), H.to_control().poles()
    for found, roots in ((system.poles, H.poles(digits=25)), (system.zeros, H.zeros(digits=25))):
        expected = [r.value for r in roots for _ in range(r.multiplicity)]
        assert [complex(x) for x in found] == [complex(x) for x in expected]
    size = max(map(abs, control_poles))
    assert all(min(abs(control_poles - p)) < 1e-11 * size for p in system.poles)
    # Coefficients are the doubles nearest to the exact ones.
    plain, precise = H.to_control(), H.to_sympy()
    num, den = (sympy.Poly(part, precise.var) for part in (precise.num, precise.den))
    with mpmath.workdps(60):
        for found, part in ((plain.num_array[0, 0], num), (plain.den_array[0, 0], den)):
            expected = [float(mpmath.mpf(sympy.N(c / den.LC(), 50))) for c in part.all_coeffs()]
            assert found.tolist() == expected


def test_sympy_s_function_is_exact():
    H = bound("two_mass", "X_tip")
    system = H.to_sympy()
    assert isinstance(system, SympyTransferFunction)
    m_1, m_2, k, b = 60, 20, 71653, 41
    s = system.var
    den = s**2 * (m_1 * m_2 * s**2 + (m_1 + m_2) * (b * s + k))
    assert sympy.expand(system.num * den - (b * s + k) * system.den) == 0
    assert all(c.is_Integer for c in sympy.Poly(system.den, s).all_coeffs())


def test_pi_and_roots_stay_what_they_are_in_sympy():
    system = rational("f*sqrt(k)*u/(s + f)", 'parameters.f = "2 Hz"\nparameters.k = 2').to_sympy()
    assert system.num / system.den == 4 * sympy.sqrt(2) * sympy.pi / (system.var + 4 * sympy.pi)


def test_symbols_bear_their_assumptions_in_sympy():
    model = symflex.load(PAPER / "two_mass.toml")
    system = model.transfer_function("X_act", "F").to_sympy()
    assert all(x.is_positive for x in system.free_symbols - {system.var})
    values = {p.name: Fraction(p.value.rational) for p in model.parameters}
    given = {x: sympy.Rational(values[x.name]) for x in system.free_symbols - {system.var}}
    H = model.transfer_function("X_act", "F").bind()
    assert complex(system.to_expr().subs(given).subs(system.var, 3)) == pytest.approx(H(3), rel=1e-14)


def test_constants_that_are_no_rational_numbers_are_rounded_once():
    H = rational("f*u/(s + sqrt(2)*f)", 'parameters.f = "0.3 Hz"')
    with mpmath.workdps(40):
        f = 2 * mpmath.pi * mpmath.mpf(3) / 10
        expected = [float(f)], [1.0, float(mpmath.sqrt(2) * f)]
    system = H.to_control()
    assert (system.num_array[0, 0].tolist(), system.den_array[0, 0].tolist()) == expected
    assert H.state_space().A.tolist() == [[-expected[1][1]]]


# --------------------------------------------------------------------------------------- names, units


def test_control_knows_names_and_units():
    system = bound("two_mass", "V_tip").to_control()
    assert (system.name, system.input_labels, system.output_labels) == ("V_tip_over_F", ["F"], ["V_tip"])
    expected = {
        "unit": "m/(N*s)",
        "input_unit": "N",
        "output_unit": "m/s",
        "quantity": "mobility",
        "exact": True,
    }
    assert expected.items() <= system.metadata.items()
    assert system.isctime(strict=True)


def test_states_bear_their_names_and_units():
    system = bound("rigid_body", "V_tip").to_control("state-space")
    assert system.state_labels == ["x_tip", "motor_i", "x_tip_dot"]
    assert system.metadata["state_units"] == {"x_tip": "m", "motor_i": "A", "x_tip_dot": "m/s"}
    assert system.isctime(strict=True)
    assert bound("rigid_body", "V_tip").to_scipy("state-space").metadata["name"] == "V_tip_over_V_cmd"


def test_a_function_that_loses_digits_says_how_many():
    lost = {}
    for order in (3, 18):
        poles = "*".join(f"(s^2 + 0.02*s + {n * n})" for n in range(1, order + 1))
        H = rational(f"1/({poles})*u", 'analysis.band = ["0.1 Hz", "4 Hz"]')
        system = H.to_control()
        lost[order] = system.metadata["coefficients_error"]
        omega = frequencies(H)
        exact = np.array([H(1j * w) for w in omega])
        measured = np.max(np.abs(system(1j * omega) / exact - 1))
        assert lost[order] < 10 * measured + 1e-15
        assert "coefficients_error" not in H.to_scipy().metadata
        assert np.max(np.abs(H.to_scipy().freqresp(omega)[1] / exact - 1)) < 1e-12
    assert lost[3] < 1e-14
    assert lost[18] > 1e-9


# ------------------------------------------------------------------------- functions out of the ordinary


@pytest.mark.filterwarnings("ignore::scipy.signal.BadCoefficients")
def test_gains_zeros_and_integrators_are_taken_over():
    for expression in ["3*u", "u - u", "u/(2*s^2)"]:
        H = rational(expression)
        assert H.to_control()(2j) == pytest.approx(H(2j)), expression
        assert H.to_control("state-space")(2j) == pytest.approx(H(2j)), expression
        for form in ("zeros-poles-gain", "transfer-function", "state-space"):
            system = H.to_scipy(form)
            # scipy's own conversions divide by the gain
            if not H.bound.ratio.is_zero or form == "zeros-poles-gain":
                assert system.freqresp([2.0])[1] == pytest.approx(H(2j)), expression
        assert complex(H.to_sympy().to_expr().subs(sympy.Symbol("s"), 2)) == pytest.approx(H(2)), expression


def test_what_grows_with_s_is_a_transfer_function_but_no_state_space():
    H = rational("(s^3 + 2)/(s + 1)*u")
    assert H.to_control()(3j) == pytest.approx(H(3j))
    assert H.to_scipy().freqresp([3.0])[1] == pytest.approx(H(3j))
    for refused in (H.state_space, H.rational(5).state_space):
        with pytest.raises(ModelError, match=r"SF236.*more zeros than poles"):
            refused()
    with pytest.raises(ModelError, match="SF236"):
        H.to_control("state-space")


def test_a_beam_has_to_be_approximated_first(beam):
    for convert in ("to_control", "to_scipy", "to_sympy", "state_space"):
        found = words(getattr(beam, convert))
        assert "ModelError" in found and "SF235" in found, convert
        assert "in Python, H.rational(modes=N)" in found.split("hint: ")[1], convert


def test_a_delay_has_to_be_approximated_first():
    H = rational("D*u/(s + 1)", 'blocks.D = { type = "delay", T = "0.5 s" }')
    with pytest.raises(ModelError, match="SF235"):
        H.to_control()
    assert H.to_frd([1.0, 2.0]).frdata[0, 0] == pytest.approx(
        np.exp([-0.5j, -1j]) / np.array([1 + 1j, 1 + 2j])
    )


def test_an_unknown_form_is_refused_with_a_hint():
    H = rational("u/(s + 1)")
    for convert in (H.to_control, H.to_scipy):
        found = words(convert, "state-spaec")
        assert "SF902" in found and "did you mean 'state-space'" in found, convert


def test_a_program_that_is_not_installed_is_named_with_its_command(monkeypatch):
    H = rational("u/(s + 1)")
    for package, call in (
        ("control", H.to_control),
        ("control", lambda: H.to_control("state-space")),
        ("control", lambda: H.to_frd([1.0])),
        ("scipy.signal", H.to_scipy),
        ("scipy.signal", H.state_space().to_scipy),
    ):
        monkeypatch.setitem(sys.modules, package, None)
        found = words(call)
        assert "is not installed" in found and "hint: pip install" in found, call


def test_frequencies_that_are_none_are_refused():
    H = rational("u/(s + 1)")
    for omega in ([], [2.0, 1.0], [-1.0, 1.0], [1.0, math.inf], [[1.0, 2.0]]):
        assert refusal(H.to_frd, omega) == "UsageError SF902", omega


def test_a_pole_is_no_place_for_frequency_response_data():
    with pytest.raises(UsageError, match="pole at omega = 2 rad/s"):
        rational("u/(s^2 + 4)").to_frd([1.0, 2.0])


def test_coefficients_that_do_not_fit_are_refused_and_zeros_poles_gain_are_not():
    H = rational("1/(" + "*".join(f"(s/10^20 + {n})" for n in range(1, 19)) + ")*u")
    with pytest.raises(ModelError, match="SF233"):
        H.to_control()
    with pytest.raises(ModelError, match="SF233"):
        H.to_scipy()  # the gain is 10^360


def test_what_scipy_would_take_for_zero_is_refused():
    H = rational("u/(10^15*s + 1)")
    with pytest.raises(ModelError, match=r"SF233(.|\n)*zeros-poles-gain"):
        H.to_scipy("transfer-function")
    assert H.to_scipy().freqresp([1e-15])[1] == pytest.approx(H(1e-15j), rel=1e-14)
    assert H.to_control()(1e-15j) == pytest.approx(H(1e-15j), rel=1e-14)


# ------------------------------------------------------------------------------------- approximations


def test_an_approximation_has_the_same_methods(beam):
    R = beam.rational(modes=4)
    omega = np.array([3.0, 40.0, 200.0])
    expected = R(1j * omega)
    assert R.to_control()(1j * omega) == pytest.approx(expected, rel=1e-9)
    assert R.to_control("state-space")(1j * omega) == pytest.approx(expected, rel=1e-12)
    assert R.to_frd(omega)(1j * omega) == pytest.approx(expected, rel=1e-12)
    for form in ("zeros-poles-gain", "transfer-function"):
        assert R.to_scipy(form).freqresp(omega)[1] == pytest.approx(expected, rel=1e-9)


def test_an_approximation_says_up_to_where_it_is_within_one_percent(beam):
    R = beam.rational(modes=4)
    system = R.to_control()
    assert system.name.startswith("W_tip_over_F_product_4_modes_1_percent_to_")
    assert system.metadata["valid_to_hz"] == {"1 %": R.valid_to(0.01), "5 %": R.valid_to(0.05)}
    assert R.to_scipy().metadata["valid_to_hz"] == system.metadata["valid_to_hz"]
    assert R.to_control("state-space").name == system.name


def test_sections_in_series_multiply_to_the_function():
    for zeros, poles in [
        ([], [-1]),
        ([-3], [-1]),
        ([-5, 1 + 2j, 1 - 2j], [-1, -2, -3]),
        ([-7], [0, 0, -1 + 3j, -1 - 3j]),
        ([-2, -8], [3j, -3j, -1]),
        ([0, 0, 0], [-1 + 1j, -1 - 1j, -1 + 1j, -1 - 1j]),
        ([2 + 1j, 2 - 1j, -4, 5], [-1, -2, 300j, -300j, -2, -0.5]),
    ]:
        made = cascade([mpmath.mpc(z) for z in zeros], [mpmath.mpc(p) for p in poles], mpmath.mpf(3), "G")
        assert made.a.shape == (len(poles), len(poles)), (zeros, poles)
        for s in (0.3 + 1j, 2.5j, -4 + 30j):
            expected = 3 * math.prod(s - z for z in zeros) / math.prod(s - p for p in poles)
            assert response(made, [s])[0][0][0] == pytest.approx(expected, rel=1e-14), (zeros, poles)


# --------------------------------------------------------------------------------------- what it is for


def test_a_loop_is_designed_in_three_lines():
    G = bound("two_mass", "V_act").to_control("state-space", minimal=True)
    margin = control.stability_margins(loop := 2000 * G)[1]
    assert margin > 60
    closed = control.feedback(loop)
    assert np.all(closed.poles().real < 0)
    # velocity feedback at the actuator is passive: every pole of G is damped more
    assert max(closed.poles().real) < 0
    assert control.dcgain(closed) == pytest.approx(1)
