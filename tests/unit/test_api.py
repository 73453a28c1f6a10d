"""What a Python user touches."""

import copy
import math
import pickle
import runpy
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy

import symflex
from symflex import pipeline
from symflex.api import analyses
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import BudgetError, Diagnostic
from symflex.print.forms.printed import RATIONAL
from symflex.roots import Budget
from symflex.roots.counting import winding
from tests.unit.analysis.rods import CLAMPED_ROD
from tests.unit.refusals import refusal
from tests.unit.roots.distributed_models import DELAY_LOOP, SLIDING_FREE

TABLES = {
    "parameters": {
        "m_1": "60 kg",
        "m_2": "20 kg",
        "k": {"value": "95 kN/m", "doc": "drive"},
        "b": "40 N*s/m",
    },
    "definitions": {"Z": "b*s + k"},
    "elements": {
        "act": {"type": "mass", "at": "x_act", "m": "m_1"},
        "tip": {"type": "mass", "at": "x_tip", "m": "m_2"},
        "drive": {"type": "spring", "between": ["x_act", "x_tip"], "k": "k"},
        "loss": {"type": "damper", "between": ["x_act", "x_tip"], "b": "b"},
    },
    "inputs": {"F": {"force": "x_act"}},
    "outputs": {"X_act": "x_act", "V_tip": "s*x_tip", "None": "0*x_act"},
    "analysis": {"band": ["0.1 Hz", "100 Hz"]},
    "title": "Two masses",
    "source": "for the tests",
}
TEXT = """
symflex = 1
title = "Two masses"
source = "for the tests"
[parameters]
m_1 = "60 kg"
m_2 = "20 kg"
k = { value = "95 kN/m", doc = "drive" }
b = "40 N*s/m"
[definitions]
Z = "b*s + k"
[elements]
act = { type = "mass", at = "x_act", m = "m_1" }
tip = { type = "mass", at = "x_tip", m = "m_2" }
drive = { type = "spring", between = ["x_act", "x_tip"], k = "k" }
loss = { type = "damper", between = ["x_act", "x_tip"], b = "b" }
[inputs]
F = { force = "x_act" }
[outputs]
X_act = "x_act"
V_tip = "s*x_tip"
None = "0*x_act"
[analysis]
band = ["0.1 Hz", "100 Hz"]
"""
ROD = CLAMPED_ROD.replace('l = "1 m" }', 'l = "l" }') + '[parameters]\nl = "1 m"\n'
M_1, M_2, K, B = 60, 20, 95_000, 40


@pytest.fixture(scope="module")
def model():
    return symflex.loads(TEXT)


@pytest.fixture(scope="module")
def colocated(model):
    return model.transfer_function("X_act", "F")


@pytest.fixture(scope="module")
def tip(model):
    return model.transfer_function("V_tip", "F")


@pytest.fixture(scope="module")
def nothing(model):
    return model.transfer_function("None", "F")


@pytest.fixture(scope="module")
def rod():
    return symflex.loads(ROD).transfer_function("X", "F").bind()


@pytest.fixture(scope="module")
def loop():
    return symflex.loads(DELAY_LOOP).transfer_function("out", "r").bind()


def receptance(s):
    """X_act/F of two masses by hand: Newton's law for each, eliminating x_tip."""
    w = B * s + K
    return (M_2 * s**2 + w) / (s**2 * (M_1 * M_2 * s**2 + w * (M_1 + M_2)))


def test_models_built_in_python_and_loaded_from_text_or_a_file_are_equal(model, tmp_path):
    (tmp_path / "two.toml").write_text(TEXT)
    path = tmp_path / "two.toml"
    assert symflex.Model(**TABLES) == symflex.load(path) == symflex.load(str(path)) == model


def test_a_model_says_what_it_holds(model):
    assert model.title == "Two masses"
    assert [p.name for p in model.parameters] == ["m_1", "m_2", "k", "b"]
    assert (model.inputs, model.outputs) == (("F",), ("X_act", "V_tip", "None"))


def test_every_problem_of_a_wrong_model_is_in_the_exception():
    with pytest.raises(symflex.SymflexError) as caught:
        symflex.Model(
            elements={"a": {"type": "mas", "at": "x"}, "b": {"type": "spring"}},
            inputs={"F": {"force": "x"}},
            outputs={"X": "x"},
        )
    assert {d.code for d in caught.value.diagnostics} >= {"SF216", "SF217"}


def test_all_transfer_functions_are_those_of_outputs_over_inputs(model, colocated, tip):
    assert [G.name for G in model.transfer_functions()] == ["X_act/F", "V_tip/F", "None/F"]
    assert refusal(model.transfer_function, "X_act", "G") == "UsageError SF902"
    assert refusal(model.transfer_function, "X_act") == "UsageError SF902"
    assert model.transfer_function("X_act/F").name == model.transfer_function("X_act", "F").name
    assert (colocated.quantity, colocated.unit) == ("receptance", "m/N")
    assert (tip.quantity, tip.unit) == ("mobility", "m/(N*s)")


def test_num_over_den_is_the_function_derived_by_hand(colocated):
    values = {"m_1": M_1, "m_2": M_2, "k": K, "b": B}
    where = dict(colocated.where)
    s = sympy.Symbol("s")
    value = colocated.expr.subs(where).subs(
        {x: values[x.name] for x in (colocated.expr.subs(where)).free_symbols - {s}}
    )
    assert sympy.cancel(value - receptance(s)) == 0
    assert sympy.cancel(colocated.num / colocated.den - colocated.expr) == 0


def test_parameters_are_positive_symbols(colocated):
    assert next(x for x in colocated.expr.free_symbols if x.name == "m_1").is_positive


def test_every_form_is_the_same_function(colocated):
    for name in [name for name in RATIONAL if name not in ("zpk", "frequency")]:
        form = colocated.form(name)
        assert form.name == name, name
        assert (
            sympy.cancel((form.expr - colocated.expr).subs(dict(form.where)).subs(dict(colocated.where))) == 0
        ), name


def test_the_definitions_form_keeps_definitions_closed(colocated):
    form = colocated.form("definitions")
    s, b, k = sympy.Symbol("s"), *sympy.symbols("b k", positive=True)
    assert [(str(name), meaning) for name, meaning in form.where] == [("Z", b * s + k)]
    assert not {b, k} & form.expr.free_symbols
    assert str(form).endswith("\n  where Z = b*s + k")


def test_the_zpk_form_has_the_asked_digits(colocated):
    # leading coefficients: m_2/(m_1*m_2) = 1/60
    assert sympy.LC(colocated.form("zpk", 4).num, sympy.Symbol("s")) == sympy.Rational("0.01667")


def test_parts_of_short_forms_are_expressions_in_the_names_below_them():
    # By hand: what is less than 1 % of its coefficient goes, also in definitions and within functions.
    values = {"k": "100 N/m", "d": "0.1 N/m", "m": "2 kg", "b": "3 kg/s", "phi": "0.5 rad", "e": "1 mrad"}
    k, m, b, phi = sympy.symbols("k m b phi", positive=True)
    s = sympy.Symbol("s")
    for definitions, output, expected in [
        ({}, "F/(m*s^2 + b*s + k + d)", 1 / (m * s**2 + b * s + k)),
        ({"w": "sqrt((k + d)/m)"}, "w^2/(s^2 + w^2)/k*F", k / m / (s**2 + k / m) / k),
        ({"c": "cos(phi + e)"}, "c*F/(m*s^2 + k*c)", sympy.cos(phi) / (m * s**2 + k * sympy.cos(phi))),
        ({}, "exp(-s*b/k)*F/(m*s^2 + k + d)", sympy.exp(-s * b / k) / (m * s**2 + k)),
    ]:
        given = {"parameters": values, "definitions": definitions, "inputs": {"F": {"unit": "N"}}}
        form = symflex.Model(**given, outputs={"X": output}).transfer_function("X", "F").short()
        assert form.expr == form.num / form.den, output
        assert sympy.simplify(form.expr.subs(dict(form.where)) - expected) == 0, output


def test_an_unknown_form_is_a_usage_error(colocated):
    with pytest.raises(symflex.SymflexError, match="did you mean 'factored'"):
        colocated.form("factord")


def test_what_cancelled_is_a_sympy_expression(tip, colocated):
    assert tip.hidden == ((sympy.Symbol("s"), 1),)
    assert colocated.hidden == ()


def test_latex_has_no_display_of_its_own_and_the_notebook_adds_it(colocated):
    assert colocated.form("monic")._repr_latex_() == f"$\\displaystyle {colocated.latex('monic')}$"
    above, below = colocated._repr_latex_().split(r" \\ ")  # definitions stand below
    assert below == r"\text{where}\quad Z &= b s + k \end{aligned}$"
    assert (
        above
        == rf"$\displaystyle \begin{{aligned}} {colocated.latex().partition(',')[0].replace(' = ', ' &= ')}"
    )
    assert r"\frac{X_{\mathrm{act}}(s)}{F(s)}" in colocated.latex()


def test_the_json_dictionary_is_what_the_command_line_lists(tip):
    assert tip.to_json_dict("polynomial")["den"] == "m_1*m_2*s^3 + b*(m_1 + m_2)*s^2 + k*(m_1 + m_2)*s"


def test_a_function_without_numbers_says_how_it_gets_them(colocated):
    with pytest.raises(TypeError, match=r"call bind\(\) first"):
        colocated(2j)
    with pytest.raises(AttributeError, match=r"G\.bind\(\)\.poles"):
        colocated.poles()
    assert not hasattr(colocated, "pole")


def test_a_name_of_another_program_leads_to_the_method(colocated):
    model = symflex.loads('symflex = 1\n[inputs]\nU = {}\n[outputs]\nY = "U/(s + 1)"\n')
    for item, name, method in [
        (model, "derive", "it is called transfer_function"),
        (model, "step", r"bind\(\)\.step_response"),
        (colocated, "roots", r"G\.bind\(\)\.poles"),
        (colocated.bind(), "impulse", "it is called impulse_response"),
        (colocated.bind(), "margins", r"model\.stability"),
    ]:
        with pytest.raises(AttributeError, match=method):
            getattr(item, name)


def test_a_bound_function_evaluates_at_a_number(colocated):
    for s in (1j, 50j, -3 + 2j, 1.5):
        value = colocated.bind()(s)
        assert isinstance(value, complex), s
        assert value == pytest.approx(receptance(s), rel=1e-13), s


def test_a_bound_function_evaluates_over_an_array_of_any_shape(colocated):
    s = 1j * np.arange(1.0, 7.0).reshape(2, 3)
    np.testing.assert_allclose(colocated.bind()(s), receptance(s), rtol=1e-13)


def test_a_nested_function_evaluates_over_an_array_too(model):
    nested = model.nested("X_act", "F").bind()
    points = np.array([[1j, 50j], [3 + 2j, -40j]])
    assert nested(points).shape == (2, 2)
    np.testing.assert_allclose(nested(points), receptance(points), rtol=1e-13)
    assert isinstance(nested(np.array(2j)), complex)


def test_a_value_may_be_any_number_or_a_quantity(colocated):
    for k in (
        120_000, 120_000.0, Fraction(120_000), Decimal(120_000), "120 kN/m", "120000", np.float64(1.2e5),
        np.float32(1.2e5), np.int64(120_000), np.array(1.2e5), sympy.Integer(120_000),
    ):  # fmt: skip
        assert colocated.bind(k=k).bound.values == colocated.bind(k=120_000).bound.values, k
        stiffness = symflex.loads(TEXT, values={"k": k}).parameters[2]
        assert (stiffness.name, stiffness.value.rational) == ("k", 120_000), k
    third = colocated.bind(k=sympy.Rational(1, 3)).bound.values
    assert third == colocated.bind(k=Fraction(1, 3)).bound.values
    for wrong in (mpmath.mpf(3), 1j, None, [3, 4], np.nan, sympy.Symbol("k")):
        assert refusal(colocated.bind, k=wrong) == "UsageError SF902", wrong
        assert refusal(symflex.loads, TEXT, values={"k": wrong}) == "UsageError SF902", wrong


def test_functions_can_be_pickled_and_copied(model):
    s = 3 + 40j
    undamped = (M_2 * s**2 + K) / (s**2 * (M_1 * M_2 * s**2 + K * (M_1 + M_2)))  # m_1 and m_2 on a spring
    unbound = model.transfer_function("X_act", "F")
    for function in (unbound, model.nested("X_act", "F")):
        for again in (pickle.loads(pickle.dumps(function)), copy.deepcopy(function)):
            assert (repr(again), again.num) == (repr(function), function.num)
        bound = function.bind(m_2="20 kg", b=0)
        again = pickle.loads(pickle.dumps(bound))
        assert again(s) == pytest.approx(undamped, rel=1e-13)


def test_results_can_be_pickled_and_enclose_what_they_enclosed(model, tip):
    assert copy.deepcopy(model) == model == pickle.loads(pickle.dumps(model))
    rod = symflex.loads(CLAMPED_ROD)
    wave = rod.transfer_function(rod.outputs[0], rod.inputs[0]).bind()
    for result in (
        tip.bind().pole_zero_map(digits=40),
        tip.bind().residues(),
        tip.bind().step_response([0.1, 0.2]),
        tip.bind().discretise("1 ms"),
        tip.form(),
        model.state_space(),
        wave.rational(modes=2),
        wave.mode_shape(1),
    ):
        assert repr(pickle.loads(pickle.dumps(result))) == repr(result)
    # s^2 + s + 9/2 = 0: two masses of 1 kg on the spring and the damper, relative to each other
    ball = tip.bind(m_1=1, m_2=1, b="0.5 N*s/m", k="2.25 N/m").poles(digits=30)[-1]
    again = pickle.loads(pickle.dumps(ball))
    with mpmath.workdps(60):
        true = mpmath.mpc(-1, -mpmath.sqrt(17)) / 2
        assert abs(again.value - true) <= again.radius < mpmath.mpf(10) ** -29
        assert again.value == ball.value and again.radius >= ball.radius > 0


def test_bound_values_replace_the_declared_ones(tip):
    # undamped: omega^2 = k (1/m_1 + 1/m_2)
    poles = tip.bind(b=0, k="30 N/m", m_1=2, m_2=3).poles()
    assert [complex(p) for p in poles] == [0, 5j, -5j]


def test_an_impossible_choice_is_a_usage_error(model, colocated):
    bound = colocated.bind()
    feedback = symflex.Model(
        signals={"y": "K/s*(r - y)"}, parameters={"K": 1}, inputs={"r": {}}, outputs={"Y": "y"}
    )
    for call in [
        lambda: bound.poles(modes=-1), lambda: bound.poles(mode=0), lambda: bound.zeros(band=(2, 1)),
        lambda: bound.zeros(band=(math.nan, 1)), lambda: bound.residues(band=np.array([1.0, math.inf])),
        lambda: bound.pole_zero_map(region=(1, -1, 0, 1)), lambda: bound.poles(digits=0),
        lambda: bound.residues(digits=math.nan), lambda: bound.step_response([1.0], digits=0),
        lambda: bound.mode_shape(1, digits=-3), lambda: bound.to_frd([1j, 2j]),
        lambda: bound.discretise(math.inf), lambda: feedback.stability("K", digits=0),
        lambda: feedback.stability("K", up_to_hz=math.inf), lambda: feedback.stability("K", up_to_hz=-1),
        lambda: bound.step_info(digits=100_000),
    ]:  # fmt: skip
        assert refusal(call) == "UsageError SF902"
    for band in [(50, 1), (0, 50), (1, math.inf)]:  # the search would begin at 0 and never end
        expected = "SF804" if math.isfinite(band[1]) else "SF902"
        assert refusal(model.colocation, "X_act", "X_act", "F", band=band) == f"UsageError {expected}"
    for call in [lambda: bound.step_response([1j]), lambda: bound.forced_response([0, 1], [0, 1j])]:
        assert refusal(call) == "UsageError SF811"


def test_a_band_may_be_an_array_or_have_units(model, colocated):
    bound = colocated.bind()
    bands = ((1, 2000), np.array([1.0, 2000.0]), ("1 Hz", "2 kHz"))
    assert len({bound.rational(band=band).valid_to(0.01) for band in bands}) == 1
    lines = [model.measure("X_act", "F", band=band, spacing=0.5, averages=1).omega for band in bands]
    assert all((line == lines[0]).all() for line in lines)
    figure = bound.bode(band=None, ylim=np.array([-200.0, 0.0]))
    assert figure.axes[0].get_ylim() == (-200, 0)
    assert bound.nyquist(xlim=np.array([-1.0, 2.0])).axes[0].get_xlim() == (-1, 2)


def test_a_value_that_does_not_fit_is_a_usage_error(colocated):
    for values, code in (({"q": 1}, "SF902"), ({"k": "1 kg"}, "SF203"), ({"k": math.nan}, "SF902")):
        assert refusal(colocated.bind, **values) == f"UsageError {code}", values


def test_poles_come_in_both_members_with_exact_zeros(colocated):
    # m_1 m_2 s^2 + (m_1 + m_2)(b s + k): s = -4/3 +- j sqrt(19000/3 - 16/9)
    origin, upper, lower = colocated.bind().poles(digits=30)
    assert (origin.value, origin.multiplicity, origin.is_real, origin.on_imaginary_axis) == (0, 2, True, True)
    with mpmath.workdps(40):
        assert lower.im + upper.im == 0
        exact = mpmath.mpc(-mpmath.mpf(4) / 3, mpmath.sqrt(mpmath.mpf(19000) / 3 - mpmath.mpf(16) / 9))
        assert abs(upper.value - exact) <= upper.radius < mpmath.mpf(10) ** -27
    assert [type(x) for x in (upper.re, upper.value, upper.radius)] == [mpmath.mpf, mpmath.mpc, mpmath.mpf]
    assert isinstance(complex(upper), complex)
    assert upper.certified


def test_a_value_keeps_its_digits_whatever_the_working_precision(colocated):
    value = colocated.bind().poles(digits=40)[1].value
    with mpmath.workdps(50):
        assert abs(value.real + mpmath.mpf(4) / 3) < mpmath.mpf(10) ** -39


def test_a_zero_has_frequency_and_damping(colocated):
    # m_2 s^2 + b s + k
    (upper, _) = colocated.bind().zeros()
    assert upper.frequency_hz == pytest.approx(math.sqrt(K / M_2) / (2 * math.pi))
    assert upper.damping_ratio == pytest.approx(B / (2 * math.sqrt(K * M_2)))
    assert not upper.is_real


def test_poles_may_be_chosen_by_modes_or_by_a_band_in_hertz(colocated):
    bound = colocated.bind()
    # Roots at the origin and the lowest mode, which is at sqrt(95000/15)/(2 pi) = 12.666 Hz.
    assert [p.multiplicity for p in bound.poles(modes=1)] == [2, 1, 1]
    assert [len(bound.poles(band=band)) for band in ((12.6, 12.7), (12.7, 20))] == [2, 0]
    assert refusal(bound.poles, 1, band=(1, 2)) == "UsageError SF902"


def test_one_mode_by_its_number(colocated):
    # s^2 (m_1 m_2 s^2 + (b s + k)(m_1 + m_2)): one mode but for the roots at 0
    bound = colocated.bind()
    exact = complex(-4 / 3, math.sqrt(19000 / 3 - 16 / 9))
    assert [complex(p) for p in bound.poles(mode=1)] == pytest.approx([exact, exact.conjugate()])
    assert bound.poles(mode=2) == ()
    assert [z.frequency_hz for z in bound.zeros(mode=1)] == pytest.approx(
        [math.sqrt(K / M_2) / (2 * math.pi)] * 2
    )


def test_a_mode_of_a_distributed_system_has_its_own_residue_and_sensitivities(rod):
    # X/F = tanh(s)/s: poles (n - 1/2) pi j, residues 1/s; abs(s) is proportional to 1/l and sqrt(E).
    omega = 999.5 * math.pi
    assert [complex(p) for p in rod.poles(mode=1000)] == pytest.approx([omega * 1j, -omega * 1j])
    assert [complex(z) for z in rod.zeros(mode=1000)] == pytest.approx([1000j * math.pi, -1000j * math.pi])
    assert [complex(r) for r in rod.residues(mode=1000)] == pytest.approx([1 / (1j * omega), 1j / omega])
    moved = [m for m in rod.sensitivities(mode=1000, parameters=["l"]) if m.kind == "pole"]
    assert [complex(m.normalised) for m in moved] == pytest.approx([-1, -1])
    assert len(rod.pole_zero_map(mode=1000).poles) == 2


def test_an_explanation_of_one_zero(colocated):
    assert colocated.bind().explain_zeros(mode=1).held == "x_act = 0"


def test_an_impossible_mode_is_a_usage_error(colocated):
    for choice in ({"mode": 1, "modes": 2}, {"mode": 1, "band": (1, 2)}, {"mode": 0}):
        assert refusal(colocated.bind().pole_zero_map, **choice) == "UsageError SF902", choice


def test_an_impossible_budget_is_a_usage_error(colocated):
    for seconds in (0, -1, math.nan):
        assert refusal(colocated.bind().poles, budget=seconds) == "UsageError SF902", seconds


def test_a_map_says_that_a_budget_was_exceeded_and_a_sufficient_one_changes_nothing(colocated):
    bound = colocated.bind()
    certificate = bound.pole_zero_map(budget=1e-9).certificate
    assert (certificate.is_exceeded, certificate.certified, certificate.code) == (True, False, "SF506")
    assert bound.pole_zero_map(budget=600).to_json_dict() == bound.pole_zero_map().to_json_dict()


def test_what_cannot_say_that_a_budget_was_exceeded_raises_with_the_map(colocated):
    for method in ("poles", "zeros", "residues", "sensitivities", "explain_zeros"):
        with pytest.raises(BudgetError, match="SF506") as caught:
            getattr(colocated.bind(), method)(budget=1e-9)
        assert caught.value.found.certificate.is_exceeded, method
        assert caught.value.exit_code == 5, method


def test_what_was_proved_within_a_budget_is_not_lost(loop, monkeypatch):
    # out/r = 1/(s + 2 exp(-s/2)): s = 2 W_k(-1)
    times = iter([0.0] * 2_000 + [10.0] * 100_000)
    monkeypatch.setattr(analyses, "Budget", lambda seconds: Budget(seconds, clock=lambda: next(times)))
    with pytest.raises(BudgetError, match="modes were found up to") as caught:
        loop.poles(modes=30, budget=5)
    found = [symflex.Root(root) for root in caught.value.found.poles if root.im > 0]
    expected = sorted((2 * mpmath.lambertw(-1, k) for k in range(31)), key=abs)
    assert 0 < len(found) < 30
    for root, value in zip(found, expected, strict=False):
        assert abs(complex(root) - complex(value)) < 1e-12 * abs(value)


def test_nothing_proved_is_nothing_found(loop):
    with pytest.raises(BudgetError, match="SF506") as caught:
        loop.poles(modes=1000, budget=1e-9)
    assert caught.value.found is None


@pytest.mark.slow
def test_work_without_end_is_not_taken_for_a_result(loop, monkeypatch):
    monkeypatch.setattr(winding, "WORK_LIMIT", 12_000)
    with pytest.raises(BudgetError, match="SF505") as caught:
        loop.poles(modes=30)
    assert caught.value.found.poles


def test_the_static_gain_is_the_limit(model, colocated, tip):
    assert colocated.bind().dcgain() == math.inf
    assert tip.bind().dcgain() == math.inf
    spring = symflex.Model(
        parameters={"k": "4 N/m", "m": "1 kg"},
        elements={
            "m": {"type": "mass", "at": "x", "m": "m"},
            "k": {"type": "spring", "between": ["x", "ground"], "k": "k"},
        },
        inputs={"F": {"force": "x"}},
        outputs={"X": "x", "V": "s*x"},
    )
    assert spring.transfer_function("X", "F").bind().dcgain() == 0.25
    assert spring.transfer_function("V", "F").bind().dcgain() == 0


def test_a_frequency_response_is_the_function_on_the_axis(colocated):
    omega = np.geomspace(0.1, 1e3, 40)
    response = colocated.bind().frequency_response(omega)
    np.testing.assert_allclose(response.values, receptance(1j * omega), rtol=1e-12)
    np.testing.assert_array_equal(response.omega, omega)
    assert response.unit == "m/N"


def test_the_pole_zero_map_has_the_hidden_modes_and_a_certificate(tip):
    found = tip.bind().pole_zero_map(digits=20)
    assert [h.root.is_zero for h in found.hidden] == [True]
    assert found.certificate.certified
    # three poles, one zero, one hidden
    assert (found.certificate.counted, found.certificate.found) == (5, 5)


def test_the_zero_transfer_function_has_no_poles_and_hides_all_modes(nothing, colocated):
    bound = nothing.bind()
    assert (nothing.expr, bound.poles(), bound.zeros(), bound.dcgain(), bound(1j)) == (0, (), (), 0, 0)
    np.testing.assert_array_equal(bound.frequency_response([1.0, 2.0]).values, [0, 0])
    hidden = [complex(symflex.Root(h.root)) for h in bound.pole_zero_map().hidden]
    assert sorted(hidden, key=lambda z: (z.real, z.imag)) == sorted(
        (complex(p) for p in colocated.bind().poles()), key=lambda z: (z.real, z.imag)
    )


def test_the_exported_numpy_module_agrees(model, tmp_path):
    (tmp_path / "exported.py").write_text(model.export_numpy())
    space = runpy.run_path(str(tmp_path / "exported.py"))
    s = 1j * np.geomspace(0.1, 1e3, 20)
    np.testing.assert_allclose(space["X_act_over_F"](s), receptance(s), rtol=1e-13)


def test_python_has_a_method_for_every_target(model):
    assert all(hasattr(model, f"export_{target.replace('-', '_')}") for target in EXPORTERS)
    assert model.export_typst().startswith("#set page")


def test_the_exported_latex_is_a_document(model):
    text = model.export_latex()
    assert text.index(r"\documentclass") < text.index(r"\begin{document}") < text.index(r"\end{document}")


def test_every_public_name_can_be_imported_and_documents_itself():
    for name in symflex.__all__:
        assert getattr(symflex, name).__doc__


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'lod'"):
        symflex.lod  # noqa: B018


@pytest.fixture(scope="module")
def beam():
    return symflex.loads(SLIDING_FREE)


def test_a_distributed_function_says_so(beam, colocated):
    G = beam.transfer_function("V_tip", "F")
    assert (G.is_distributed, G.bind().is_distributed, colocated.is_distributed) == (True, True, False)
    assert repr(G) == "<TransferFunction V_tip/F: mobility, distributed>"


def test_poles_of_a_distributed_function_are_certified(beam):
    poles = beam.transfer_function("V_act", "F").bind().poles(modes=2, digits=20)
    # tan x + tanh x = 0: x = 2.36502, 5.49780
    x = [round(math.sqrt(complex(p).imag), 5) for p in poles if p.im >= 0]
    assert x == [0, 2.36502, 5.49780]
    assert all(p.certified for p in poles)


def test_a_pole_zero_map_takes_one_region(beam):
    bound = beam.transfer_function("V_act", "F").bind()
    assert len(bound.pole_zero_map(region=(-1, 1, 2, 10)).poles) == 1
    assert refusal(bound.pole_zero_map, modes=2, band=(1, 2)) == "UsageError SF902"


def test_the_gain_of_a_distributed_function_at_rest_is_its_limit(rod):
    # A rod held at one end: E A/l = 1 N/m.
    assert rod.dcgain() == pytest.approx(1)


def test_a_function_without_a_closed_form_is_said_to_have_a_nested_one(model, monkeypatch):
    for code, hint in (
        ("SF501", "model.nested('V_tip', 'F') has its values, poles and zeros; or leave parts out"),
        ("SF502", "model.nested('V_tip', 'F') has its values, poles and zeros; or leave parts out"),
        ("SF506", "leave parts out"),
    ):

        def too_large(*_, code=code):
            raise BudgetError(Diagnostic(code, "too large, for this test", None, "leave parts out"))

        monkeypatch.setattr(pipeline, "derive_all", too_large)
        with pytest.raises(BudgetError, match=code) as caught:
            model.transfer_function("V_tip", "F")
        assert caught.value.diagnostics[0].hint == hint, code


@pytest.mark.slow
def test_a_nested_function_has_the_poles_shapes_and_responses_of_the_expanded_one():
    """A rod of two pieces: sin(w) = 0 where it is free."""
    half = 'type = "rod", E = 1, A = 1, rho = 1, l = 0.5'
    model = symflex.loads(f"""
        symflex = 1
        elements.a = {{ {half}, between = ["x", "y"] }}
        elements.b = {{ {half}, between = ["y", "z"] }}
        inputs.F = {{ force = "x" }}
        outputs.X = "x"
        """)
    nested, expanded = model.nested("X", "F").bind(), model.transfer_function("X", "F").bind()
    found = nested.pole_zero_map(modes=3)
    assert found.certificate.certified
    upper = [float(p.im) for p in found.poles if p.im > 0]
    assert upper == pytest.approx([np.pi, 2 * np.pi, 3 * np.pi][: len(upper)], rel=1e-12)
    assert nested.frequency_response([1.0, 2.0]).values == pytest.approx(
        expanded.frequency_response([1.0, 2.0]).values, rel=1e-12
    )
    assert [complex(r) for r in nested.residues(modes=2)] == pytest.approx(
        [complex(r) for r in expanded.residues(modes=2)], rel=1e-9
    )
    assert nested.mode_shape(1).pole.im == pytest.approx(np.pi)


def test_a_nested_function_without_waves_answers_as_its_polynomials_do():
    model = symflex.loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/((s + 1)*(s + 3))"')
    nested = model.nested("y", "u").bind()
    assert nested.step_response([1.0]).values == pytest.approx([1 / 3 - np.exp(-1) / 2 + np.exp(-3) / 6])
    assert nested.rational(2).poles == pytest.approx([-1, -3])
    assert nested.step_response().certified
