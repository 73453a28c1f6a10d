"""Structural damping: what loss factors mean, by complex stiffnesses in numpy, and what they exclude."""

import mpmath
import numpy as np
import pytest

import symflex
from symflex.errors import SymflexError
from symflex.report.facts import facts_of
from symflex.report.sections.roots import root_section
from symflex.report.study import Study
from tests.unit.refusals import refusal

OMEGA = np.array([1.0, 9.9, 10.1, 40.0])
TWO_MASSES = """symflex = 1
parameters = { m_1 = "2 kg", m_2 = "1 kg", k_1 = "100 N/m", k_2 = "400 N/m", eta_1 = 0.05, eta_2 = 0.1 }
[elements]
a = { type = "mass", at = "x", m = "m_1" }
b = { type = "mass", at = "y", m = "m_2" }
s = { type = "spring", between = ["x", "ground"], k = "k_1", eta_s = "eta_1" }
t = { type = "spring", between = ["x", "y"], k = "k_2*(1 + j*eta_2)" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
Y = "y"
"""
ONE_MASS = """symflex = 1
[elements]
a = {{ type = "mass", at = "x", m = "1 kg" }}
s = {{ type = "spring", between = ["x", "ground"], k = "100 N/m"{} }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "{}"
"""
CANTILEVER = """symflex = 1
[elements]
wall = { type = "fixed", at = "a" }
arm = { type = "beam", between = ["a", "b"], EI = "56 N*m^2", rhoA = "0.162 kg/m", l = "0.5 m", eta_s = 0.02 }
[inputs]
F = { force = "b.y" }
[outputs]
Y = "b.y"
"""


def stiffness(eta_1=0.05, eta_2=0.1):
    k_1, k_2 = 100 * (1 + 1j * eta_1), 400 * (1 + 1j * eta_2)
    return np.array([[k_1 + k_2, -k_2], [-k_2, k_2]])


def receptance(omega):
    return np.linalg.inv(stiffness() - omega**2 * np.diag([2.0, 1.0]))[:, 0]


@pytest.mark.parametrize(("output", "row"), [("X", 0), ("Y", 1)])
def test_frequency_response_is_that_of_complex_stiffness(output, row):
    bound = symflex.loads(TWO_MASSES).transfer_function(output, "F").bind()
    expected = np.array([receptance(w)[row] for w in OMEGA])
    assert np.allclose(bound.frequency_response(OMEGA).values, expected, rtol=1e-13)
    assert np.allclose(bound(1j * OMEGA), expected, rtol=1e-13)


def test_modes_have_natural_frequencies_and_loss_factors():
    found = symflex.loads(TWO_MASSES).transfer_function("X", "F").bind().pole_zero_map()
    squares = sorted(np.linalg.eigvals(np.diag([0.5, 1.0]) @ stiffness()), key=abs)
    assert found.certificate.certified
    omega = [r.frequency_hz() * 2 * np.pi for r in found.poles]
    assert omega == pytest.approx([x.real**0.5 for x in squares])
    factors = [float(r.loss_factor().mid()) for r in found.poles]
    assert factors == pytest.approx([x.imag / x.real for x in squares])


def test_all_modes_of_a_chain_are_found_if_no_region_is_given():
    text = 'symflex = 1\ninputs.F = { force = "x1" }\noutputs.X = "x1"\n[elements]\n'
    for i, before in enumerate(("ground", "x1", "x2", "x3", "x4", "x5", "x6"), 1):
        text += f'm{i} = {{ type = "mass", at = "x{i}", m = 1 }}\n'
        text += f'k{i} = {{ type = "spring", between = ["x{i}", "{before}"], k = 1, eta_s = 0.02 }}\n'
    poles = symflex.loads(text).transfer_function("X", "F").bind().poles()
    # omega_k = 2 sin((2 k - 1) pi/(4 n + 2)) of a chain held at one end, and s^2 = -omega^2 (1 + j eta).
    expected = [1j * 2 * np.sin((2 * k - 1) * np.pi / 30) * np.sqrt(1 + 0.02j) for k in range(1, 8)]
    assert [complex(p) for p in poles] == pytest.approx(expected, rel=1e-12)


def test_formula_prints_j_and_reduces_its_square():
    tf = symflex.loads(TWO_MASSES).transfer_function("X", "F")
    assert "1 + j*eta_1" in str(tf)
    assert "j^2" not in str(tf.form("polynomial"))


def test_a_stepped_rod_has_no_power_of_its_loss_above_and_below():
    # By hand, with K_1 = sinh(q_1)/gamma: F = rho*s^2*(A_1*K_1*L_0 + A_2*K_0*L_1)*Y.
    text = """symflex = 1
parameters = { E = {}, rho = {}, A_1 = {}, A_2 = {}, l_1 = {}, l_2 = {}, eta = {} }
inputs.F = { force = "root" }
outputs.Y = "tip"
[elements]
big = { type = "rod", between = ["root", "step"], E = "E", A = "A_1", rho = "rho", l = "l_1", eta_s = "eta" }
tip = { type = "rod", between = ["step", "tip"], E = "E", A = "A_2", rho = "rho", l = "l_2", eta_s = "eta" }
"""
    form = symflex.loads(text).transfer_function("Y", "F").form("krylov")
    assert str(form).splitlines()[0] == "Y/F = 1/(rho*s^2*(A_1*K_1*L_0 + A_2*K_0*L_1))"


def test_beam_has_the_modes_and_response_of_its_complex_stiffness():
    bound = symflex.loads(CANTILEVER).transfer_function("Y", "F").bind()
    roots = (1.8751040687119611, 4.6940911329741746, 7.8547574382376126)
    frequencies = [q**2 * (56 / 0.162) ** 0.5 / 0.5**2 / (2 * np.pi) for q in roots]
    poles = bound.poles(modes=3)
    assert [p.frequency_hz for p in poles] == pytest.approx(frequencies, rel=1e-12)
    assert [p.loss_factor for p in poles] == pytest.approx([0.02] * 3, rel=1e-12)
    assert bound.pole_zero_map(modes=3).certificate.certified

    def deflection(omega):
        with mpmath.workdps(30):
            rigidity = 56 * (1 + 0.02j)
            q = mpmath.mpc(0.162 * omega**2 / rigidity) ** 0.25 * 0.5
            top = mpmath.cosh(q) * mpmath.sin(q) - mpmath.sinh(q) * mpmath.cos(q)
            below = 1 + mpmath.cosh(q) * mpmath.cos(q)
            return complex(0.5**3 / (rigidity * q**3) * top / below)

    assert np.allclose(bound(1j * OMEGA), [deflection(w) for w in OMEGA], rtol=1e-12)


ROD = """symflex = 1
parameters = { E = "5 MPa", A = "1 cm^2", rho = "1100 kg/m^3", l = "0.2 m", eta = 0.6 }
[fields.u]
domain = ["0", "l"]
equation = "E*(1 + j*eta)*u'' = rho*s^2*u"
conditions = ["u(0) = 0", "E*(1 + j*eta)*A*u'(l) = F"]
[inputs]
F = { unit = "N" }
[outputs]
U = "u(l)"
"""


@pytest.mark.parametrize(
    ("region", "numbers"),
    [({"modes": 5}, range(5)), ({"mode": 3}, [2]), ({"band": (200.0, 700.0)}, [1, 2, 3])],
)
def test_modes_of_a_field_with_much_loss_are_all_there(region, numbers):
    found = symflex.loads(ROD).transfer_function("U", "F").bind().pole_zero_map(**region)
    speed = np.sqrt(5e6 * (1 + 0.6j) / 1100)
    expected = [1j * (n + 0.5) * np.pi / 0.2 * speed for n in numbers]
    assert found.certificate.certified
    assert [complex(p.re.mid(), p.im.mid()) for p in found.poles] == pytest.approx(expected, rel=1e-13)


@pytest.mark.slow
def test_a_damper_beside_the_loss_makes_modes_that_are_counted_too():
    damper = 'd = { type = "damper", between = ["b.y", "ground"], b = "200 N*s/m" }\n[inputs]'
    text = CANTILEVER.replace("[inputs]", damper)
    found = symflex.loads(text).transfer_function("Y", "F").bind().pole_zero_map(modes=3)
    assert found.certificate.certified
    rigidity = 56 * (1 + 0.02j)

    def boundary(s):
        q = (-0.162 * s * s / rigidity) ** mpmath.mpf("0.25") * 0.5
        shear = mpmath.sin(q) * mpmath.cosh(q) - mpmath.cos(q) * mpmath.sinh(q)
        return 1 + mpmath.cos(q) * mpmath.cosh(q) + 200 * s * 0.5**3 / (rigidity * q**3) * shear

    poles = [complex(p.re.mid(), p.im.mid()) for p in found.poles]
    assert [complex(mpmath.findroot(boundary, p)) for p in poles] == pytest.approx(poles, rel=1e-12)


HALVES = """symflex = 1
[elements]
left = { type = "fixed", at = "a" }
right = { type = "fixed", at = "c" }
one = { type = "beam", between = ["a", "b"], EI = "70 N*m^2", rhoA = "0.27 kg/m", l = "0.4 m", eta_s = 0.1 }
two = { type = "beam", between = ["b", "c"], EI = "70 N*m^2", rhoA = "0.27 kg/m", l = "0.4 m", eta_s = 0.1 }
[inputs]
F = { force = "b.y" }
[outputs]
Y = "b.y"
"""


@pytest.mark.slow
def test_modes_that_a_force_in_the_middle_does_not_move_are_hidden_with_losses_too():
    lossy, plain = (
        symflex.loads(text).transfer_function("Y", "F").bind().pole_zero_map(modes=2)
        for text in (HALVES, HALVES.replace(", eta_s = 0.1", ""))
    )
    assert lossy.certificate.certified
    turn = np.sqrt(1 + 0.1j)  # every stiffness times 1 + 0.1 j
    for ours, theirs in ((lossy.poles, plain.poles), (lossy.zeros, plain.zeros)):
        expected = [1j * float(r.im.mid()) * turn for r in theirs if r.im > 0]
        assert [complex(r.re.mid(), r.im.mid()) for r in ours] == pytest.approx(expected, rel=1e-12)
    ours, theirs = ([h.root for h in one.hidden if h.root.im > 0] for one in (lossy, plain))
    expected = [1j * float(r.im.mid()) * turn for r in theirs]
    assert [complex(r.re.mid(), r.im.mid()) for r in ours] == pytest.approx(expected, rel=1e-12)
    assert len(ours) == 1


def test_what_losses_do_not_touch_stays_on_the_axis():
    spring = 'p = { type = "spring", between = ["b.y", "ground"], k = "2 kN/m", eta_s = 0.2 }\n[inputs]'
    text = CANTILEVER.replace(", eta_s = 0.02", "").replace("[inputs]", spring)
    found = symflex.loads(text).transfer_function("Y", "F").bind().pole_zero_map(modes=2)
    assert found.certificate.certified
    assert all(zero.on_imaginary_axis for zero in found.zeros)
    assert all(pole.re < 0 for pole in found.poles)


def test_modes_with_a_damper_beside_a_loss_factor_are_those_of_its_equation():
    damper = 'd = { type = "damper", between = ["b.y", "ground"], b = "3 N*s/m" }\n[inputs]'
    found = symflex.loads(CANTILEVER.replace("[inputs]", damper)).transfer_function("Y", "F").bind()
    located = found.pole_zero_map(modes=4)
    assert located.certificate.certified

    def equation(s):
        rigidity = 56 * (1 + 0.02j)
        q = (-0.162 * np.asarray(s, complex) ** 2 / rigidity) ** 0.25 * 0.5
        tip = np.cosh(q) * np.sin(q) - np.sinh(q) * np.cos(q)
        return rigidity * (1 + np.cosh(q) * np.cos(q)) + 3 * s * tip * (0.5 / q) ** 3

    poles = np.array([complex(p.re.mid(), p.im.mid()) for p in located.poles])
    assert max(abs(equation(poles))) < 1e-9 * min(abs(equation(1.01 * poles)))
    # The equation winds about 0 once per pole, on the upper half of a disc whose edge lies behind the last.
    size = abs(poles[-1]) * 1.2
    path = np.r_[np.linspace(-size, size, 400), size * np.exp(1j * np.linspace(0, np.pi, 2000))]
    values = equation(path)
    turns = np.angle(np.roll(values, -1) / values)
    assert max(abs(turns)) < 1
    assert round(sum(turns) / (2 * np.pi)) == len(poles) == 4


def test_no_mode_of_two_equal_beams_that_a_spring_joins_is_missing():
    other = CANTILEVER[CANTILEVER.index("wall") : CANTILEVER.index("[inputs]")]
    for old, new in (('"b"', '"d"'), ('"a"', '"c"'), ("wall", "wall_2"), ("arm", "arm_2")):
        other = other.replace(old, new)
    joint = 's = { type = "spring", between = ["b.y", "d.y"], k = "500 N/m", eta_s = 0.3 }\n[inputs]'
    located = symflex.loads(CANTILEVER.replace("[inputs]", other + joint)).transfer_function("Y", "F").bind()
    located = located.pole_zero_map(modes=5)
    assert located.certificate.certified
    poles = [complex(p.re.mid(), p.im.mid()) for p in located.poles]
    # Where both move alike, the spring does nothing.
    for root in (1.8751040687119611, 4.6940911329741746, 7.8547574382376126):
        alike = 1j * root**2 * np.sqrt(56 * (1 + 0.02j) / 0.162) / 0.5**2
        assert min(abs(pole - alike) for pole in poles) < 1e-9 * abs(alike)


@pytest.mark.parametrize(("mark", "loss"), [("", 0.1), ("j*", 0.1j)])
def test_a_viscoelastic_stiffness_may_stand_in_a_definition(mark, loss):
    text = ONE_MASS.format("", "x").replace('"100 N/m"', '"k_v"')
    parameters = 'parameters = { k = "100 N/m", w = "10 rad/s" }\n'
    definitions = f'[definitions]\nk_v = "k*(1 + 0.1*{mark}s/(s + w))"\n[elements]'
    text = text.replace("[elements]", parameters + definitions)
    found = symflex.loads(text).transfer_function("X", "F").bind().pole_zero_map()
    expected = [s for s in np.roots([1, 10, 100 * (1 + loss), 1000]) if s.imag > 0]
    got = [complex(p.re.mid(), p.im.mid()) for p in found.poles if p.im > 0]
    assert sorted(got, key=abs) == pytest.approx(sorted(expected, key=abs), rel=1e-12)


@pytest.mark.slow
def test_a_frame_too_large_for_its_formula_has_the_response_of_scaled_frequency():
    text = """symflex = 1
[parameters]
eta = 0.02
[elements]
foot = { type = "fixed", at = "a" }
post = { type = "frame", between = ["a", "b"], angle = "90 deg", EI = "70 N*m^2", EA = "7 MN", rhoA = "0.27 kg/m", l = "0.5 m", eta_s = "eta" }
arm = { type = "frame", between = ["b", "c"], angle = 0, EI = "60 N*m^2", EA = "6 MN", rhoA = "0.25 kg/m", l = "0.3 m", eta_s = "eta" }
[inputs]
F = { force = "c.y" }
[outputs]
Y = "c.y"
"""  # noqa: E501
    lossy = symflex.loads(text).nested("Y", "F").bind()
    plain = symflex.loads(text.replace(', eta_s = "eta"', "")).nested("Y", "F").bind()
    factor = 1 + 0.02j  # every stiffness times this: H(s) = H_0(s/sqrt(factor))/factor
    for omega in (3.0, 150.0, 900.0):
        expected = complex(plain(1j * omega / np.sqrt(factor))) / factor
        assert complex(lossy(1j * omega)) == pytest.approx(expected, rel=1e-12)
    poles = [np.array([complex(p) for p in each.poles(2) if p.im > 0]) for each in (lossy, plain)]
    assert poles[0] == pytest.approx(poles[1] * np.sqrt(factor), rel=1e-13)


def test_members_that_taper_take_no_loss_factor_yet():
    text = CANTILEVER.replace('EI = "56 N*m^2"', 'EI = "B*(1 - x/l/2)"').replace('"0.5 m"', '"l"')
    model = symflex.loads(
        text.replace("[elements]", 'parameters = { B = "56 N*m^2", l = "0.5 m" }\n[elements]')
    )
    assert refusal(model.transfer_function, "Y", "F") == "ModelError SF910"
    assert refusal(model.export_numpy) == "ModelError SF910"


def test_a_response_may_be_swept_over_loss_factors():
    found = symflex.loads(TWO_MASSES).sweep({"eta_1": [0.05, 0.5]}, of="response", frequencies=[2.0])
    expected = [
        np.linalg.inv(stiffness(eta) - (4 * np.pi) ** 2 * np.diag([2.0, 1.0]))[0, 0] for eta in (0.05, 0.5)
    ]
    assert np.ravel(found["re"] + 1j * found["im"]) == pytest.approx(expected, rel=1e-12)


def test_frequency_form_splits_stiffness_into_its_parts_and_has_one_unit():
    text = str(
        symflex.loads(ONE_MASS.format(", eta_s = 0.1", "x")).transfer_function("X", "F").form("frequency")
    )
    assert "j_1" not in text
    assert "sqrt(-1)" not in text
    assert "-s^2" not in text


def test_a_report_has_roots_and_says_what_is_left_out(tmp_path):
    (tmp_path / "rack.toml").write_text(TWO_MASSES, encoding="utf-8")
    study = Study.of(tmp_path / "rack.toml", "rack")
    part = root_section(study)
    assert (part.code, part.warnings) == (0, ())
    page = repr(part.blocks)
    assert "loss factor" in page
    assert "What the zeros mean is not examined: loss factors hold on s = j*omega alone." in page
    assert [f.tf for f in facts_of(study).functions] == ["X/F", "Y/F"]


def test_exported_numpy_is_the_response():
    module = {}
    exec(symflex.loads(TWO_MASSES).export_numpy(), module)  # noqa: S102
    values = module["TRANSFER_FUNCTIONS"]["X/F"](1j * OMEGA)
    assert np.allclose(values, [receptance(w)[0] for w in OMEGA], rtol=1e-13)


def test_what_needs_another_s_is_refused():
    model = symflex.loads(TWO_MASSES)
    tf = model.transfer_function("X", "F")
    bound = tf.bind()
    for call in (
        lambda: bound.step_response([0.0, 1.0]), bound.step_response, bound.step_info, bound.input_shaper,
        bound.residues, bound.rational, bound.state_space,
        bound.to_scipy, bound.dcgain, lambda: bound.discretise(0.01),
        lambda: bound.frequency_response([0.0, 1.0]), lambda: bound(1.0 + 1j), lambda: bound(-1j),
        lambda: tf.form("zpk"), tf.state_space, model.state_space, lambda: model.stability("k_1"),
        lambda: model.sweep({"k_1": [1.0, 2.0]}), model.export_c, model.export_matlab,
        model.export_state_space,
    ):  # fmt: skip
        assert refusal(call) == "ModelError SF251"
    assert refusal(lambda: tf.bind(j=2.0)) == "UsageError SF902"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (ONE_MASS.format("", "j*x"), "SF210"),
        (ONE_MASS.format(", eta_s = 0.1", "j*x"), "SF210"),
        (CANTILEVER.replace('"0.5 m"', '"0.5*j"'), "SF210"),
        (ONE_MASS.format(', eta_s = "2 s"', "x"), "SF203"),
        ("parameters.j = 3\n".join(ONE_MASS.format(", eta_s = 0.1", "j*x").split("\n", 1)), "SF211"),
    ],
)
def test_j_elsewhere_is_refused(text, code):
    text = text.replace("symflex = 1parameters", "symflex = 1\nparameters")
    with pytest.raises(SymflexError) as caught:
        symflex.loads(text)
    (problem,) = caught.value.diagnostics
    assert problem.code == code
    if code == "SF210":
        assert "j^2 = -1" in problem.hint


def test_a_parameter_may_still_be_called_j():
    text = ONE_MASS.format("", "j*x").replace("[elements]", "parameters.j = 3\n[elements]")
    assert "j" in str(symflex.loads(text).transfer_function("X", "F"))


@pytest.mark.parametrize(
    "stiffness",
    ["k*(1 + 1i*e)", "k*(1 + i*e)", "k*(1 + 2j*e)", "k*(1 + 0.05j)", "complex(k, e)", "k*(1 + sqrt(-1)*e)"],
)
def test_who_writes_a_complex_number_elsewise_is_told_of_j_and_eta_s(stiffness):
    text = ONE_MASS.format("", "x").replace('"100 N/m"', f'"{stiffness}"')
    text = text.replace("[elements]", 'parameters = { k = "100 N/m", e = 0.1 }\n[elements]')
    with pytest.raises(SymflexError) as caught:
        symflex.loads(text).transfer_function("X", "F").bind()(1j)
    hint = caught.value.diagnostics[0].hint
    assert "the imaginary unit is j" in hint
    assert "eta_s" in hint


@pytest.mark.parametrize(
    "value", ["(100 + 5j) N/m", "100 + 5j N/m", "100*(1 + 0.05*j) N/m", "sqrt(-1)", "1i"]
)
def test_a_complex_parameter_is_told_that_parameters_are_real(value):
    text = ONE_MASS.format("", "x").replace("[elements]", f'parameters.k_2 = "{value}"\n[elements]')
    with pytest.raises(SymflexError) as caught:
        symflex.loads(text)
    assert "a parameter is real; the imaginary unit is j" in caught.value.diagnostics[0].hint


def test_a_loss_factor_by_another_name_is_told_its_key():
    with pytest.raises(SymflexError) as caught:
        symflex.loads(ONE_MASS.format(", tan_delta = 0.1", "x"))
    assert caught.value.diagnostics[0].hint == "a loss factor is 'eta_s'"
