"""Forms of transfer functions with kernels: all of them are the same function, and print as papers do."""

import re
from functools import cache
from itertools import product
from pathlib import Path

import mpmath
import pytest

from symflex import pipeline
from symflex.errors import SpecError, UsageError
from symflex.expressions import Call, Name, format_expression, quotient
from symflex.model.analysis import FORM_NAMES
from symflex.print import forms
from symflex.print.forms import FORMS, hidden_expressions, print_form, with_hidden
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.polynomial import factored_draft
from symflex.print.forms.printed import forms_of
from symflex.print.json_format import derive_json
from symflex.print.latex import transfer_function_latex
from symflex.print.sympy import to_sympy
from symflex.print.text import derive_text, form_text
from tests.contract.exact import read
from tests.independent.spec_expressions import evaluate
from tests.unit.codegen.models_with_kernels import MODELS, derived, spec
from tests.unit.print.residues import PRIME, point_for

CLASSICS = Path(__file__).parents[3] / "derivations" / "classics"
NAMED = ("hyperbolic", "factored", "krylov", "vaughan", "frequency", "polynomial")
# A model for every kind of kernel and of what becomes of names; those that are left out take the same ways.
KINDS = (
    "clamped_clamped", "thermoelastic rod", "beam with definitions", "delay and rod", "third order",
    "free_free", "damped beam on a foundation", "propped beam of two fields", "shafts and a gear",
    "diffusion with drift", "string with a bead", "the paper's names taken", "rayleigh beam",
    "sliding_free_beam",
)  # fmt: skip

of_case = cache(derived)


@cache
def printed(name, number, form):
    """Return a form of one of a case's functions, printed once for all tests of it."""
    return print_form(of_case(name)[number], form)


def reread(form):
    """Return what a form prints, read back by the specification's own parser."""
    num, den = (read(format_expression(e)) for e in (form.num, form.den))
    return num, den, [(name, read(format_expression(e))) for name, e in form.where]


def shown(tf, form=None):
    found = print_form(tf, form)
    return format_expression(found.num), format_expression(found.den)


def lines(tf, form):
    return [f"{name} = {format_expression(e)}" for name, e in print_form(tf, form).where]


def case(name, pair):
    return next(tf for tf in of_case(name) if tf.name == pair)


@pytest.mark.parametrize("name", KINDS)
def test_a_form_is_the_function_in_exact_arithmetic(name):
    for number, tf in enumerate(of_case(name)):
        point = point_for(tf)
        for form in (*forms_of(tf), "definitions", None):
            assert point.form(*reread(printed(name, number, form))) == point.truth, (tf.name, form)


def test_definitions_stay_closed_in_every_form_of_a_beam():
    for form in NAMED:
        shown = printed("beam with definitions", 0, form)
        text = " ".join(format_expression(e) for e in (shown.num, shown.den, *(e for _, e in shown.where)))
        assert re.search(r"EI/load|load\*(s|omega)\^2/EI", text), form
        assert text.count("E*I") == text.count("rho*A") == 1, form  # in their own lines


def test_a_form_with_a_wrong_sign_is_told_apart():
    tf = case("sliding_free_beam", "V_act/F")
    num, den, where = reread(print_form(tf, "vaughan"))
    point = point_for(tf)
    wrong = read(format_expression(den).replace("- 4*S*C", "+ 4*S*C"))
    assert point.form(num, den, where) == point.truth
    assert point.form(num, wrong, where) != point.truth
    assert point.truth < PRIME


def value_of(expression, known, where=()):
    """Return the value of a print by principal branches, to mpmath's precision."""
    return evaluate(format_expression(expression), known, [(n, format_expression(e)) for n, e in where])


def test_all_forms_agree_to_45_digits_at_complex_points():
    # By principal branches, which residues know nothing of.
    names = (
        "sliding_free_beam",
        "damped beam on a foundation",
        "rayleigh beam",
        "thermoelastic rod",
        "delay and rod",
    )
    with mpmath.workdps(60):
        points = (mpmath.mpc(1, 2) / 3, mpmath.mpc(-2, 1) / 5)
        for name, s in product(names, points):
            (tf, *_) = of_case(name)
            known = {p.name: mpmath.mpf(3 + i) / (4 + i % 5) for i, p in enumerate(tf.model.parameters)}
            known["s"] = s
            values = []
            for form in (printed(name, 0, form) for form in forms_of(tf)):
                values.append(value_of(quotient(form.num, form.den), known, form.where))
            assert max(abs(v / values[0] - 1) for v in values) < mpmath.mpf(10) ** -45, (name, s)


VAUGHAN = (
    """\
       -((S^2 + C^2)^2 + 2*S^2 + 6*C^2 + 1)
  ---------------------------------------------
  rho*A*a*sqrt(2*p)*((S^2 + C^2)^2 - 4*S*C - 1)
""",
    """\
               -2*C*(S^2 + C^2 + 1)
  ---------------------------------------------
  rho*A*a*sqrt(p/2)*((S^2 + C^2)^2 - 4*S*C - 1)
""",
)
VAUGHAN_WHERE = """
  where S = exp(-sqrt(T*p))*sin(sqrt(T*p))
        C = exp(-sqrt(T*p))*cos(sqrt(T*p))
        p = s/a
        a = sqrt(E*I/(rho*A))
        T = l^2/2
"""


def test_vaughans_forms_of_the_mobilities_are_the_papers_with_two_misprints_corrected():
    # Eppinger & Seering 1988, "Bending Beam Models": the first has 2C^2 for 6C^2 and -1 for -1/2 there, and
    # both have sqrt(2/p) in front, which is 1/sqrt(p/2) unless p is negative.
    for tf, expected in zip(of_case("sliding_free_beam"), VAUGHAN, strict=True):
        assert expected + VAUGHAN_WHERE in derive_text([(tf, print_form(tf, "vaughan"))])


# A fact: the function of a case in a form, and what is printed above and below where it says so.
SHOWN = {
    # The same denominator in s: beta^4 = rho A omega^2/(E I) = -rho A s^2/(E I).
    "a cantilever has it in s, too, unless another form is asked for": (
        ("clamped_free", "W_tip/F", None),
        "cosh(q)*sin(q) - sinh(q)*cos(q)",
        "E*I*beta^3*(cosh(q)*cos(q) + 1)",
    ),
    # Rao 2007, section 11.5.1: sin sinh of a beam on two supports.
    "a beam pinned at both ends has sinh times sin": (
        ("pinned_pinned", "theta_far/tau", None), None, "2*E*I*beta*sinh(q_1)*sin(q_1)",
    ),
    # Krylov-Duncan theory: free poles at tan + tanh = 0, colocated zeros at cos cosh = -1.
    "the frequency form is real but for one factor": (
        ("sliding_free_beam", "V_act/F", "frequency"),
        "-beta*j*(cosh(beta*l)*cos(beta*l) + 1)",
        "rho*A*omega*(cosh(beta*l)*sin(beta*l) + sinh(beta*l)*cos(beta*l))",
    ),
    # 1 + cos cosh, Rao 2007, table 11.1
    "the receptance of a cantilever has the textbook denominator": (
        ("clamped_free", "W_tip/F", "frequency"),
        "cosh(beta*l)*sin(beta*l) - sinh(beta*l)*cos(beta*l)",
        "E*I*beta^3*(cosh(beta*l)*cos(beta*l) + 1)",
    ),
    "which stays whole where the numerator needs half the length": (
        ("clamped_free", "W_mid/F", "frequency"), None, "2*E*I*beta^3*(cosh(beta*l)*cos(beta*l) + 1)",
    ),
    # Krylov 1931, by hand: K_0 = (cosh + cos)/2, and cosh*sin + sinh*cos = 2*beta*(K_0*K_1 - beta^4*K_2*K_3).
    "Krylov-Duncan functions of the free beam": (
        ("sliding_free_beam", "V_tip/F", "krylov"), "-K_0", "rho*A*s*(beta^4*K_2*K_3 - K_0*K_1)",
    ),
    # Rao, Vibration of Continuous Systems, chapter 9: the stiffness E A gamma beside the inertia m s^2.
    "a rod with a mass has its stiffness in the characteristic equation": (
        ("rod_tip_mass", "X_tip/F", None), "sinh(q)", "m*s^2*sinh(q) + E*A*gamma*cosh(q)",
    ),
    "a twofold delay is one exponential": (
        ("delay and rod", "X_late/u", None), "K*exp(-2*T*s)*tanh(q)", None
    ),
}  # fmt: skip
WAVENUMBER = "beta = sqrt(sqrt(-rho*A*s^2/(E*I)))"
LINES = {
    "arguments are explained by the wavenumber": (
        ("sliding_free_beam", "V_tip/F"),
        ["q = beta*l", WAVENUMBER],
    ),
    "a rod's wavenumber is taken out of its root": (
        ("rod_tip_mass", "X_tip/F"),
        ["q = gamma*l", "gamma = s*sqrt(rho/E)"],
    ),
    "damping stays under the root": (
        ("damped beam on a foundation", "X/F"),
        ["q_1 = beta*l", "beta = sqrt(sqrt(-(rho*A*s^2 + c_f*s + k_f)/(E*I*(eta*s + 1))))"],
    ),
    # The model's other output is at midspan.
    "a function of whole lengths is not printed in halves": (
        ("clamped_free", "W_tip/F"),
        ["q = beta*l", WAVENUMBER],
    ),
    "a function of half a length has that beside the whole": (
        ("clamped_free", "W_mid/F"),
        ["q_1 = beta*l/2", "q_2 = beta*l", WAVENUMBER],
    ),
}


@pytest.mark.parametrize("fact", SHOWN)
def test_functions_print_as_books_and_authors_write_them(fact):
    (name, pair, form), *expected = SHOWN[fact]
    found = shown(case(name, pair), form)
    assert [f for f, e in zip(found, expected, strict=True) if e] == [e for e in expected if e]


@pytest.mark.parametrize("fact", LINES)
def test_names_of_the_hyperbolic_form_are_explained_in_lines(fact):
    (name, pair), expected = LINES[fact]
    assert lines(case(name, pair), "hyperbolic") == expected


def test_multiples_of_an_argument_keep_whole_numbers_beside_typed_decimals():
    # A string pushed at 0.3 l: y there is sinh(3 q) sinh(7 q)/(N gamma sinh(10 q)), with q = gamma l/10;
    # cosh(5 q) = K_0 (16 K_0^4 - 20 K_0^2 + 5) in K_0 = cosh(q), by Chebyshev.
    (tf,) = pipeline.derive_all(
        pipeline.loads("""symflex = 1
parameters = { N = {}, mu = {}, l = {} }
inputs.F = { unit = "N" }
outputs.Y = "v(0.3*l)"
[fields.v]
domain = ["0", "0.3*l"]
equation = "N*v'' = mu*s^2*v"
conditions = ["v(0) = 0"]
[fields.w]
domain = ["0.3*l", "l"]
equation = "N*w'' = mu*s^2*w"
conditions = ["w(l) = 0", "w(0.3*l) = v(0.3*l)", "N*(v'(0.3*l) - w'(0.3*l)) = F"]
""")
    )
    found = print_form(tf, "krylov")
    assert "16*K_0^4 - 20*K_0^2 + 5" in format_expression(found.den)
    assert "4*K_0^2 - 1" in format_expression(found.num)  # sinh(3 q) = K_1 gamma (4 K_0^2 - 1)


def test_the_left_side_of_the_frequency_form_alone_is_a_function_of_the_frequency():
    tf = case("pinned_pinned", "theta_near/tau")
    form = print_form(tf, "frequency")
    assert derive_text([(tf, form)]).startswith("theta_near(j*omega)/tau(j*omega)   ")
    assert form_text(tf, form).startswith("theta_near(j*omega)/tau(j*omega) = ")
    latex = transfer_function_latex(tf, form, width_mm=None)
    assert r"\frac{\theta_{\mathrm{near}}(j \omega)}{\tau(j \omega)}" in latex
    assert r"\frac{\theta_{\mathrm{near}}(s)}{\tau(s)}" in transfer_function_latex(
        tf, print_form(tf), width_mm=None
    )


def hidden_lines(tf, form):
    return [line for line in derive_text([(tf, print_form(tf, form))]).splitlines() if "hidden: " in line]


def test_hidden_factors_bear_the_arguments_of_the_form_or_twice_these():
    # Antisymmetric modes of a beam clamped at both ends, which a uniform load does not drive.
    tf = case("clamped_clamped", "M_end/p")
    # By hand: cosh(x)*sin(x) - sinh(x)*cos(x) of x = beta*l/2, tan(x) = tanh(x) (Rao 2007, table 11.1).
    hidden = "  hidden: cosh(q)*sin(q) - sinh(q)*cos(q) cancelled"
    assert hidden_lines(tf, "hyperbolic") == [hidden]
    assert "q = beta*l/2" in lines(tf, "hyperbolic")


def test_hidden_factors_bring_the_lines_of_names_that_a_form_lacks():
    tf = case("clamped_clamped", "M_end/p")
    form, ((factor, _),) = with_hidden(tf, print_form(tf, "vaughan"))
    assert format_expression(factor) == "cosh(q)*sin(q) - sinh(q)*cos(q)"
    assert "q" in [name for name, _ in form.where]


@pytest.mark.parametrize("pair", ["W_mid/p", "W_quarter/p", "M_end/p"])
def test_hidden_factors_in_a_form_s_names_are_those_spelled_out(pair):
    tf = case("clamped_clamped", pair)
    known = {"E": 3, "I": 2, "rho": mpmath.mpf(5) / 3, "A": 1.75, "l": 1.125, "s": mpmath.mpc(1, 2) / 3}
    spelled_out = [(value_of(e, known), times) for e, times in hidden_expressions(tf)]
    for form in (*forms_of(tf), "definitions"):
        named, factors = with_hidden(tf, print_form(tf, form))
        for (factor, times), (spelled, again) in zip(factors, spelled_out, strict=True):
            assert times == again
            assert mpmath.almosteq(value_of(factor, known, named.where), spelled, 1e-12), form


def test_long_hidden_factors_are_printed_to_their_end_within_80_columns():
    tf = case("clamped_clamped", "W_quarter/p")
    text = derive_text([(tf, print_form(tf))])
    (start,) = [i for i, line in enumerate(text.splitlines()) if "hidden: " in line]
    shown_ = " ".join(line.strip() for line in text.splitlines()[start:]).strip()
    assert shown_.endswith("cancelled")
    assert "..." not in shown_
    assert max(map(len, text.splitlines())) <= 80


def test_the_imaginary_unit_of_the_frequency_form_is_a_line():
    assert lines(case("sliding_free_beam", "V_act/F"), "frequency")[-2:] == ["omega = s/j", "j = sqrt(-1)"]


def test_a_rational_function_has_a_frequency_form():
    text = MODELS["loop with a delay"].replace("K*late*x - omega*j*x", "K*x - omega*s*x")
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    assert shown(tf, "frequency") == ("-1", "m*omega_1^2 - K - j_1*omega*omega_1")


def test_names_of_the_model_are_left_alone():
    tf = case("the paper's names taken", "W/F")
    names = [name for name, _ in print_form(tf, "vaughan").where]
    assert names == ["S_1", "C_1", "S_2", "C_2", "p_1", "a_1", "T_1", "T_2"]


def test_a_wavenumber_that_stands_nowhere_else_is_written_into_the_argument():
    # Transmission of force through a rod fixed at its end: 1/cosh, Rao 2007, chapter 9.
    text = """inputs.F = { force = "x" }
outputs.wall = "bar.f"
elements.bar = { type = "rod", between = ["x", "ground"], E = "E", A = "A", rho = "rho", l = "l" }
"""
    (tf,) = pipeline.derive_all(pipeline.loads(spec("E A rho l", text)))
    assert shown(tf, "hyperbolic") == ("1", "cosh(q)")
    assert lines(tf, "hyperbolic") == ["q = s*l*sqrt(rho/E)"]


def test_exponents_without_a_formula_leave_solutions_with_their_law():
    (tf,) = of_case("third order")
    assert form_text(tf, print_form(tf)).split("\n") == [
        "Out/u = (h(l)*(h'(l)*(s^2 + k) + b*s*h''(l)) + h''(l)^2)/h''(l)",
        "  where h''' + b*s*h' + (s^2 + k)*h = 0",
        "  where h(0) = h'(0) = 0, h''(0) = 1",
    ]
    assert derive_json(tf, print_form(tf))["laws"] == [["h", "h''' + b*s*h' + (s^2 + k)*h = 0"]]


def test_a_solution_at_a_point_is_a_function_for_sympy():
    assert str(to_sympy(Call("h", Name("l")), {})) == "h(l)"


def test_a_form_that_needs_formulas_is_refused_without_them():
    (tf,) = of_case("third order")
    for form in ("vaughan", "frequency"):
        with pytest.raises(UsageError, match="forms of Out/u: hyperbolic, krylov, factored, polynomial"):
            print_form(tf, form)


PERFECT_SQUARE = """[fields.w]
domain = ["0", "l"]
equation = "w'''' - (a^2 + b^2)*s^2*w'' + a^2*b^2*s^4*w = 0"
conditions = ["w'(0) = 0", "w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
[inputs]
F = {}
[outputs]
Z = "w'(l)"
B = "w''(0)"
"""


def solved(known):
    """Return w'(l) and w''(0) of the exponentials that satisfy the conditions."""
    slow, fast, end, s = (known[name] for name in ("a", "b", "l", "s"))
    roots = [slow * s, -slow * s, fast * s, -fast * s]

    def row(order, x):
        return [r**order * mpmath.exp(r * x) for r in roots]

    rows = mpmath.matrix([row(1, 0), row(3, 0), row(2, end), row(3, end)])
    c = mpmath.lu_solve(rows, mpmath.matrix([0, 1, 0, 0]))
    return [sum(x * y for x, y in zip(row(*at), c, strict=True)) for at in ((1, end), (2, 0))]


def test_derivatives_have_a_krylov_form_where_wavenumbers_are_polynomials():
    # lambda_1*lambda_2 = a*b*s^2: in lowest terms numerators lack a wavenumber.
    known = {"a": mpmath.mpf("0.7"), "b": mpmath.mpf("1.9"), "l": mpmath.mpf("1.3"), "s": mpmath.mpc(1, 2)}
    tfs = pipeline.derive_all(pipeline.loads(spec("a b l", PERFECT_SQUARE)))
    for tf, wanted in zip(tfs, solved(known), strict=True):
        form = print_form(tf, "krylov")
        value = value_of(quotient(form.num, form.den), known, form.where)
        assert abs(value / wanted - 1) < 1e-12, tf.name


def test_a_krylov_form_that_is_not_found_is_refused(monkeypatch):
    monkeypatch.setattr("symflex.print.forms.krylov.in_krylov_functions", lambda *_: None)
    with pytest.raises(UsageError, match=r"has no krylov form.*not be shown to be entire"):
        print_form(case("sliding_free_beam", "V_act/F"), "krylov")


def test_a_form_of_rational_functions_is_refused_for_a_beam():
    for form in ("monic", "constant", "zpk"):
        with pytest.raises(UsageError, match="not a rational function of s"):
            print_form(case("sliding_free_beam", "V_act/F"), form)


def test_a_form_of_beams_is_refused_for_a_rational_function():
    text = """elements.M = { type = "mass", at = "x", m = "m" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
    (tf,) = pipeline.derive_all(pipeline.loads(spec("m", text)))
    for form in ("hyperbolic", "krylov", "vaughan"):
        with pytest.raises(
            UsageError, match="forms of X/F: definitions, factored, polynomial, monic, constant, zpk"
        ):
            print_form(tf, form)


def test_every_form_is_one_of_some_function():
    found = {form for name in ("third order", "numbers") for form in forms_of(of_case(name)[0])}
    assert set(FORMS) - found == {"definitions", "monic", "constant", "zpk"}


def test_a_hidden_factor_of_kernels_is_written_out():
    tf = case("sliding_sliding", "V_mid/F")
    printed = [format_expression(e) for e, _ in hidden_expressions(tf)]
    # By hand: cosh(x)^2 + cos(x)^2 - 1 of x = mu*l/2 is cosh(q)*cos(q) of q = beta*l/2.
    q = "(sqrt(sqrt(-rho*A*s^2/(E*I)))*l/2)"
    assert f"cosh{q}*cos{q}" in printed


def test_text_keeps_to_80_columns():
    for name in KINDS:
        for number, tf in enumerate(of_case(name)):
            for form in forms_of(tf):
                rows = derive_text([(tf, printed(name, number, form))]).split("\n")
                # Nobody reads a formula of a hundred lines.
                assert max(map(len, rows)) <= 80 or len(rows) > 100, (tf.name, form)


def test_a_form_that_is_given_up_for_its_terms_would_not_have_been_shorter(monkeypatch):
    monkeypatch.setattr(forms, "FEW", 20)
    for name in ("propped beam of two fields", "clamped_clamped", "rayleigh beam"):
        for number, tf in enumerate(of_case(name)):
            candidates = [printed(name, number, f) for f in forms.DISTRIBUTED_CANDIDATES if f in forms_of(tf)]
            assert size(print_form(tf)) == min(map(size, candidates)), tf.name


def size(form):
    return sum(len(format_expression(e)) for e in (form.num, form.den, *(line for _, line in form.where)))


def test_a_function_whose_kernels_do_not_factor_is_not_arranged_twice():
    model = pipeline.load(CLASSICS / "clamped_free.toml")
    tip, *_ = pipeline.derive_all(model)
    assert factored_draft(tip, Arranged()) is None


def test_functions_printed_together_print_as_each_alone_does():
    for name in ("clamped_clamped", "rayleigh beam", "delay and rod"):
        together, _ = forms.print_forms(of_case(name))
        assert together == tuple(printed(name, i, None) for i in range(len(together))), name


BETWEEN_POINTS = """
symflex = 1
parameters = { E = {}, A = {}, rho = {}, x_1 = {}, x_2 = {}, l = {} }
inputs.F = { unit = "N" }
outputs.X = "u_2(l)"
[fields.u_1]
domain = ["x_1", "x_2"]
equation = "E*A*u_1'' - rho*A*s^2*u_1 = 0"
conditions = ["u_1(x_1) = 0", "u_1(x_2) = u_2(x_2)"]
[fields.u_2]
domain = ["x_2", "l"]
equation = "E*A*u_2'' - rho*A*s^2*u_2 = 0"
conditions = ["u_1'(x_2) = u_2'(x_2)", "E*A*u_2'(l) = F"]
"""


def test_lengths_between_points_print_as_differences_that_are_positive_and_share_a_wavenumber():
    (tf,) = pipeline.derive_all(pipeline.loads(BETWEEN_POINTS))
    assert lines(tf, "hyperbolic") == [
        "q_1 = gamma*(l - x_2)",
        "q_2 = gamma*(x_2 - x_1)",
        "gamma = s*sqrt(rho/E)",
    ]


HEAVY_SPRING = """symflex = 1
parameters = { k = "100 N/m", M = "4 kg", l = "1 m", A = "1 m^2" }
elements.coil = { type = "rod", between = ["ground", "x"], E = "k*l/A", A = "A", rho = "M/(A*l)", l = "l" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
PIPE = """symflex = 1
parameters = { rho = "1.2 kg/m^3", c = "340 m/s", L = "1 m" }
fields.p = { domain = ["0", "L"], equation = "p'' = s^2/c^2*p", conditions = ["p(0) = 0", "p'(L) = rho*s*u"] }
inputs.u = { unit = "m/s" }
outputs.P = "p(L)"
"""


ROPE = """symflex = 1
parameters = { T = "100 N", mu = "0.5 kg/m", l = "3 m", D_1 = "2 N*s/m", D_2 = "3 N*s/m" }
inputs.F = { force = "b" }
outputs.V = "s*b"
[elements]
rope = { type = "string", between = ["a", "b"], N = "T", rhoA = "mu", l = "l" }
first = { type = "damper", between = ["a", "ground"], b = "D_1" }
last = { type = "damper", between = ["b", "ground"], b = "D_2" }
"""
COFLOW = """symflex = 1
parameters = { v = "0.5 m/s", h = "0.2 1/s", g = "0.1 1/s", l = "2 m" }
inputs.T_0 = { unit = "K" }
outputs.Y = "T(l)"
[fields.pipes]
unknowns = ["T", "W"]
domain = ["0", "l"]
equations = ["v*T' + s*T + h*(T - W) = 0", "v*W' + s*W + g*(W - T) = 0"]
conditions = ["T(0) = T_0", "W(0) = 0"]
"""


def test_dashpots_of_a_rope_stand_beside_its_impedance():
    (tf,) = pipeline.derive_all(pipeline.loads(ROPE))
    # V (s mu + ...) by hand: with Z = T gamma/s, (Z c + D_1 s_)/(Z (D_1 + D_2) c + (Z^2 + D_1 D_2) s_).
    assert shown(tf) == (
        "D_1*s*sinh(q) + T*gamma*cosh(q)",
        "s*(T*mu + D_1*D_2)*sinh(q) + T*gamma*(D_1 + D_2)*cosh(q)",
    )


@pytest.mark.parametrize(
    ("text", "expected", "lines"),
    [
        (HEAVY_SPRING, ("tanh(q)", "k*q"), ["q = s*sqrt(M/k)"]),
        (PIPE, ("rho*c*tanh(q)", "1"), ["q = s*L/c"]),
        # The sum h W + g T only travels, and T - W decays at the rate h + g: exp(-s*l/v) (g + h D^2)/(h + g).
        (COFLOW, ("(h*D^2 + g)*exp(-l*(2*s + h + g)/(2*v))", "D*(h + g)"), ["D = exp(-l*(h + g)/(2*v))"]),
    ],
    ids=["a heavy spring", "an open pipe", "pipes that flow alike"],
)
def test_a_length_or_wavenumber_that_cancels_is_gone(text, expected, lines):
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    assert shown(tf) == expected
    assert [f"{name} = {format_expression(e)}" for name, e in print_form(tf).where] == lines


TIMOSHENKO = """symflex = 1
parameters = { E = "210 GPa", nu = 0.3, rho = "7850 kg/m^3", d_o = "30 mm", d_i = "7 mm", L = "0.3 m" }
inputs.F = { force = "left" }
outputs.Y = "right"
[definitions]
G = "E/(2*(1 + nu))"
kappa = "6*(1 + nu)/(7 + 6*nu)"
A = "pi/4*(d_o^2 - d_i^2)"
I = "pi/64*(d_o^4 - d_i^4)"
[elements.shaft]
type = "beam"
theory = "timoshenko"
between = ["left", "right"]
E = "E"
I = "I"
rho = "rho"
A = "A"
l = "L"
G = "G"
kappa = "kappa"
"""
DECLARED = 'G = "80 GPa", kappa = 0.9, A = "6e-4 m^2", I = "3e-8 m^4", nu'


@pytest.mark.slow
def test_definitions_of_a_timoshenko_shaft_are_as_good_as_parameters():
    before, _, after = TIMOSHENKO.partition("[definitions]")
    plain = (
        before.replace("nu", DECLARED).replace(", d_o", ", d_o") + after[after.index("[elements.shaft]") :]
    )
    forms = [print_form(pipeline.derive_all(pipeline.loads(text))[0]) for text in (TIMOSHENKO, plain)]
    closed, parameters = (sum(len(format_expression(e)) for e in (f.num, f.den)) for f in forms)
    assert closed <= parameters
    assert {"G", "kappa", "A", "I"} == forms[0].definitions


def test_a_hidden_mode_is_printed_in_the_arguments_of_a_form_with_definitions():
    half = 'type = "beam", E = "E", rho = "rho", A = "A", I = "I", l = "l/2"'
    text = f"""symflex = 1
parameters = {{ E = "210 GPa", rho = "7850 kg/m^3", b = "20 mm", h = "5 mm", l = "0.6 m" }}
definitions = {{ A = "b*h", I = "b*h^3/12" }}
elements = {{ left = {{ between = ["a", "m"], {half} }}, right = {{ between = ["m", "c"], {half} }} }}
inputs.F = {{ force = "m" }}
outputs.Y = "m"
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    form, hidden = with_hidden(tf, print_form(tf))
    assert format_expression(hidden[0][0]) == "cosh(q)*sin(q) - sinh(q)*cos(q)"
    assert [name for name, _ in form.where] == ["q", "beta", "A", "I"]


def test_a_member_cut_at_a_node_prints_with_its_whole_length():
    # Green's function of a string, Morse & Ingard 1968, section 4.2
    model = pipeline.loads("""
        symflex = 1
        parameters = { N = {}, m = {}, l = {}, a = {}, p = {} }
        inputs.F.force = "x"
        outputs.Y = "left.y(p)"
        [elements]
        left = { type = "string", between = ["ground", "x"], N = "N", rhoA = "m", l = "a" }
        right = { type = "string", between = ["x", "ground"], N = "N", rhoA = "m", l = "l - a" }
    """)
    (tf,) = pipeline.derive_all(model)
    assert shown(tf) == ("sinh(q_1)*sinh(q_2)", "N*gamma*sinh(q_3)")
    assert lines(tf, None)[:3] == ["q_1 = gamma*(l - a)", "q_2 = gamma*p", "q_3 = gamma*l"]


CANTILEVER = """
symflex = 1
parameters = {{ EI = {{}}, mu = {{}}, l = {{}}, x_s = {{}} }}
[elements]
arm = {{ type = "beam", between = ["a", "b"], EI = "EI", rhoA = "mu", l = "l" }}
hold = {{ type = "fixed", at = "a" }}
[inputs.F]
force = "b"
[outputs]
Y = "arm.y({place})"
"""


@pytest.mark.parametrize("place", ["l/4", "l/8", "3*l/10"])
def test_a_sensor_at_a_fraction_prints_as_one_at_a_length_with_a_name(place):
    at_a_fraction, at_a_name = (
        print_form(pipeline.derive_all(pipeline.loads(CANTILEVER.format(place=p)))[0]) for p in (place, "x_s")
    )
    top, bottom = place.split("*") if "*" in place else ("1", place)
    own = f"{top}*beta*{bottom}" if top != "1" else f"beta*{bottom}"
    rest = f"{int(bottom[2:]) - int(top)}*beta*{bottom}"

    def spelled_out(form):
        lines = {name: format_expression(e).replace("beta*x_s", own) for name, e in form.where}
        lines = {name: text.replace("beta*(l - x_s)", rest) for name, text in lines.items()}
        sides = format_expression(form.num), format_expression(form.den)
        return [re.sub(r"q_\d", lambda found: lines[found[0]], side) for side in sides]

    assert spelled_out(at_a_fraction) == spelled_out(at_a_name)


def test_sensors_at_fractions_of_two_beams_have_their_own_lengths():
    other = """arm2 = { type = "beam", between = ["c", "d"], EI = "2*EI", rhoA = "mu", l = "l" }
hold2 = { type = "fixed", at = "c" }
link = { type = "spring", between = ["b", "d"], k = 3 }
[inputs.F]"""
    text = CANTILEVER.replace(", x_s = {{}}", "").format(place="l/4) - arm2.y(l/4")
    (tf,) = pipeline.derive_all(pipeline.loads(text.replace("[inputs.F]", other)))
    arguments = {value for name, value in (line.split(" = ") for line in lines(tf, None)) if name[0] == "q"}
    parts = ("beta_{}*l", "beta_{}*l/4", "3*beta_{}*l/4")
    assert arguments == {part.format(i) for i in (1, 2) for part in parts}


def test_beams_in_a_ratio_of_three_to_seven_print_as_those_of_two_lengths():
    # By hand: below the bar a cantilever's cosh(x)*cos(x) + 1 of the whole length x = q_3.
    beam = '{{ type = "beam", between = ["{}"], EI = "EI", rhoA = "mu", l = "{}" }}'
    text = f"""symflex = 1
parameters = {{ EI = {{}}, mu = {{}}, l = {{}} }}
elements.left = {beam.format('a", "b', "0.3*l")}
elements.right = {beam.format('b", "c', "0.7*l")}
elements.hold = {{ type = "fixed", at = "a" }}
inputs.F = {{ force = "b" }}
outputs.Y = "b"
"""
    (tf,), reason = pipeline.derive_as(model := pipeline.loads(text), model.transfer_functions)
    assert reason == ""
    _, den = shown(tf)
    assert den == "2*EI*beta^3*(cosh(q_3)*cos(q_3) + 1)"
    assert lines(tf, None)[:3] == ["q_1 = 3*beta*l/10", "q_2 = 7*beta*l/10", "q_3 = beta*l"]


PLATE = """symflex = 1
parameters = { C_0 = {}, k_t = {}, c = {}, rho = {}, A = {}, t = {} }
definitions = { h = "k_t*sqrt(c*A/(t*C_0))/A" }
inputs.q = { unit = "C" }
outputs.V = "q/C_0 - A*h*(u(t) - u(0))"
[fields]
u = { domain = ["0", "t"], equation = "c*u'' = rho*s^2*u", conditions = ["c*u'(0) = h*q", "c*u'(t) = h*q"] }
"""
STRING = """symflex = 1
parameters = { T = {}, mu = {}, L = {} }
definitions = { Z = "sqrt(T*mu)" }
inputs.F = { force = "x" }
outputs.v = "s*far"
elements.wire = { type = "string", between = ["x", "far"], N = "T", rhoA = "mu", l = "L" }
elements.rest = { type = "damper", between = ["far", "ground"], b = "Z" }
"""
CABLE = """symflex = 1
parameters = { L_1 = {}, C_1 = {}, l = {} }
definitions = { Z_0 = "sqrt(L_1/C_1)" }
inputs.v_s = { unit = "V" }
outputs.v_l = "v(l)"
[fields.line]
domain = ["0", "l"]
unknowns = ["v", "i"]
equations = ["v' = -L_1*s*i", "i' = -C_1*s*v"]
conditions = ["v(0) = v_s - Z_0*i(0)", "v(l) = Z_0*i(l)"]
"""
OPEN = (
    CABLE.replace("- Z_0*i", "- R*i")
    .replace("v(l) = Z_0*i(l)", "i(l) = 0")
    .replace("l = {}", "l = {}, R = {}")
)
BRANCH = """symflex = 1
parameters = { rho = {}, c = {}, S = {}, S_b = {}, l_1 = {}, l_2 = {}, l_b = {} }
definitions = { Z = "rho*c/S" }
inputs.q_in = { unit = "m^3/s" }
outputs.p_out = "p2(l_2)"
elements.j = { type = "flow_source", at = "junction", q = "q1(l_1) - q2(0) - q3(0)" }
[fields]
"""
for n, area, ends in [
    (1, "S", ["q1(0) = q_in", "p1(l_1) = junction"]),
    (2, "S", ["p2(0) = junction", "p2(l_2) = Z*q2(l_2)"]),
    (3, "S_b", ["p3(0) = junction", "q3(l_b) = 0"]),
]:
    rows = [f"p{n}' = -rho*s/{area}*q{n}", f"q{n}' = -{area}*s/(rho*c^2)*p{n}"]
    length = ("l_1", "l_2", "l_b")[n - 1]
    BRANCH += f'f{n} = {{ domain = ["0", "{length}"], unknowns = ["p{n}", "q{n}"], '
    BRANCH += f"equations = {rows}, conditions = {ends} }}\n"


def test_waves_print_as_in_books():
    # A plate (Auld, Acoustic Fields and Waves, 1990): (1 - k_t^2*tanh(X)/X)/C_0. What is ended by its own
    # impedance has no echo. An open line behind a source of R (Pozar, Microwave Engineering, 2012, 2.3), and
    # a closed branch (Munjal, Acoustics of Ducts and Mufflers, 2014), by hand.
    for text, expected in [
        (PLATE, "(q_1 - k_t^2*tanh(q_1))/(C_0*q_1)"),
        (STRING, "exp(-q)/Z"),
        (CABLE, "exp(-q)/2"),
        (OPEN, "Z_0/(R*sinh(q) + Z_0*cosh(q))"),
        (BRANCH, "rho*c*exp(-q_2)/(S*exp(q_1) + S_b*cosh(q_1)*tanh(q_3))"),
    ]:
        (tf,) = pipeline.derive_all(pipeline.loads(text))
        form = print_form(tf)
        assert format_expression(quotient(form.num, form.den)) == expected


def test_the_form_of_the_specification_is_printed_unless_another_is_asked_for():
    text = (CLASSICS / "clamped_free.toml").read_text(encoding="utf-8")
    asked = text.replace("[analysis]", '[analysis]\nform = "vaughan"')
    tip, *_ = pipeline.derive_all(pipeline.loads(asked))
    assert print_form(tip).name == "vaughan"
    assert print_form(tip, "hyperbolic").name == "hyperbolic"
    with pytest.raises(SpecError, match="there is no form 'vaughn'"):
        pipeline.loads(asked.replace("vaughan", "vaughn"))
    assert set(FORM_NAMES) == set(FORMS)


def test_a_fourth_root_is_explained_by_its_fourth_power():
    tip = case("clamped_free", "W_tip/F")
    form = print_form(tip)
    assert "beta^4 = -rho*A*s^2/(E*I)" in derive_text([(tip, form)])
    assert r"\beta^{4} &= -\frac{\rho A s^{2}}{E I}" in transfer_function_latex(tip, form, width_mm=None)


def test_kernels_of_two_lengths_are_joined_to_those_of_their_difference():
    # By hand: the numerator's sinh(beta*x)*cosh(beta*l) - cosh(beta*x)*sinh(beta*l), and the same of sin.
    (tf,) = pipeline.derive_all(pipeline.loads(CANTILEVER.format(place="x_s")))
    assert "sinh(q_3) - sin(q_3)" in shown(tf)[0]
    assert "q_3 = beta*(l - x_s)" in lines(tf, None)
