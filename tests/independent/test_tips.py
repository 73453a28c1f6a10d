"""Ends where a stiffness vanishes, against Bessel functions of mpmath: their zeros, values off the axis."""

import pytest
from mpmath import besseli, besselj, besseljzero, findroot, mp, mpc, mpf, sqrt

from symflex import pipeline
from symflex.errors import ModelError, SpecError
from symflex.roots.locate import locate
from symflex.roots.region import Modes

HEAD = """
symflex = 1
[parameters]
EI = "1.3 N*m^2"
EA = "1.3 N"
m = "0.7 kg/m"
g = "9.81 m/s^2"
l = "0.8 m"
[inputs]
u = { unit = "m" }
[outputs]
tip = "w(l)"
[fields.w]
domain = ["0", "l"]
"""
FIELDS = {
    "wedge": """equation = "(EI*(1 - x/l)^3*w'')'' + m*(1 - x/l)*s^2*w = 0"
conditions = ["w(0) = u", "w'(0) = 0"]""",
    "cone": """equation = "(EI*(1 - x/l)^4*w'')'' + m*(1 - x/l)^2*s^2*w = 0"
conditions = ["w(0) = u", "w'(0) = 0"]""",
    "string": """equation = "(m*g*(l - x)*w')' = m*s^2*w"
conditions = ["w(0) = u"]""",
    "divided": """equation = "g*(l - x)*w'' - g*w' = s^2*w"
conditions = ["w(0) = u"]""",
    "rod": """equation = "(EA*(1 - x/l)^2*w')' = m*(1 - x/l)^2*s^2*w"
conditions = ["w(0) = u"]""",
}
EI, M, G, L = mpf("1.3"), mpf("0.7"), mpf("9.81"), mpf("0.8")


def bound(text):
    model = pipeline.loads(text)
    (found,) = pipeline.derive_bound(model, model.transfer_functions)
    return found


def field(name):
    return bound(HEAD + FIELDS[name])


def wedge_or_cone(n, s):
    """Return w(tip)/w(clamp) of w = z^-n (a J_n(z) + b I_n(z)), z = 2 sqrt(k xi) from the tip on.

    Kirchhoff 1879: k^2 = -m s^2 l^4/EI; w'(clamp) = 0, and d/dz z^-n J_n = -z^-n J_(n+1).
    """
    z = 2 * sqrt(sqrt(-M * s**2 * L**4 / EI))
    a, b = besseli(n + 1, z), besselj(n + 1, z)
    clamp = (a * besselj(n, z) + b * besseli(n, z)) / z**n
    return (a + b) / (2**n * mp.factorial(n)) / clamp


ANSWERS = {
    "wedge": lambda s: wedge_or_cone(1, s),
    "cone": lambda s: wedge_or_cone(2, s),
    "string": lambda s: 1 / besseli(0, 2 * s * sqrt(L / G)),
    "divided": lambda s: 1 / besseli(0, 2 * s * sqrt(L / G)),
    "rod": lambda s: (s * L * sqrt(M / EI)) / mp.sinh(s * L * sqrt(M / EI)),
}


@pytest.mark.slow
def test_what_a_tip_answers_is_what_bessel_functions_say():
    for name, answer in ANSWERS.items():
        found = field(name)
        for s in (3 + 4j, -2 + 30j, 25 - 1j):
            assert found(s) == pytest.approx(complex(answer(mpc(s))), rel=1e-13), name


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wedge", "cone"])
def test_a_clamped_beam_with_a_sharp_tip_has_its_frequencies_at_zeros_of_bessel_functions(name):
    n = {"wedge": 1, "cone": 2}[name]
    with mp.workdps(30):
        # J_n I_(n+1) + I_n J_(n+1) = 0; the guesses are the zeros that Conway & Dubil 1965 print.
        guesses = {1: (4.611, 7.799, 10.958), 2: (5.906, 9.197, 12.402)}[n]
        zeros = [
            findroot(lambda z: besselj(n, z) * besseli(n + 1, z) + besseli(n, z) * besselj(n + 1, z), guess)
            for guess in guesses
        ]
        located = locate(field(name), Modes(3), digits=25)
        assert located.certificate.certified
        upper = [root for root in located.poles if root.im > 0]
        for root, z in zip(upper, zeros, strict=True):
            expected = (z / 2) ** 2 / mpf("0.64") * sqrt(mpf(13) / 7)
            assert abs(mpf(root.im.mid().str(28, radius=False)) - expected) < mpf(10) ** -24 * expected


@pytest.mark.slow
def test_a_hanging_string_has_its_frequencies_at_half_the_zeros_of_bessel_j0():
    # Daniel Bernoulli 1733: omega = j_(0,k)/2 sqrt(g/l).
    located = locate(field("string"), Modes(4), digits=25)
    assert located.certificate.certified
    with mp.workdps(30):
        expected = [besseljzero(0, k) / 2 * sqrt(mpf("9.81") / mpf("0.8")) for k in range(1, 5)]
        upper = [mpf(root.im.mid().str(28, radius=False)) for root in located.poles if root.im > 0]
        assert all(abs(a - b) < mpf(10) ** -24 * b for a, b in zip(upper, expected, strict=True))


ARM = """
symflex = 1
parameters = {{ E = "1.3 Pa", rho = "0.7 kg/m^3", l = "0.8 m", I_0 = "1 m^4", A_0 = "1 m^2" }}
[elements]
arm = {{ type = "beam", between = [{}], E = "E", rho = "rho", l = "l", I = "I_0*({})^3", A = "A_0*({})" }}
{}
[inputs]
u = {{ displacement = "base" }}
[outputs]
tip = "tip"
"""


@pytest.mark.parametrize(
    ("nodes", "taper"), [('"base", "tip"', "1 - x/l"), ('"tip", "base"', "x/l")], ids=["second", "first"]
)
@pytest.mark.slow
def test_a_beam_may_end_in_a_tip_at_either_node(nodes, taper):
    found = bound(ARM.format(nodes, taper, taper, ""))
    # Base moved and free to turn: w = z^-1 (a J_1 + b I_1), of which EI w'' goes like xi^-1 (a J_3 + b I_3).
    for s in (3 + 4j, -2 + 30j):
        z = 2 * sqrt(sqrt(-M * mpc(s) ** 2 * L**4 / EI))
        a, b = besseli(3, z), -besselj(3, z)
        expected = (a + b) / 2 / ((a * besselj(1, z) + b * besseli(1, z)) / z)
        assert found(s) == pytest.approx(complex(expected), rel=1e-12)


@pytest.mark.slow
def test_rigid_modes_of_a_free_wedge_are_counted_exactly():
    text = ARM.format('"base", "tip"', "1 - x/l", "1 - x/l", "").replace("displacement", "force")
    located = locate(bound(text), Modes(2))
    assert located.certificate.certified
    assert [root.multiplicity for root in located.poles if root.is_zero] == [2]


@pytest.mark.parametrize(
    ("equation", "words"),
    [
        ("(EI*(1 - x/l)^7*w'')'' + m*(1 - x/l)*s^2*w = 0", "irregular singular point"),
        ("(EI*(1 - x/l)^3*w'')'' + m*s^2*w = 0", "inertia does not vanish"),
        ("(EI*(1 - x/l)^5*w'')'' + m*(1 - x/l)*s^2*w = 0", "do not show how solutions begin there"),
    ],
)
def test_ends_without_power_series_are_refused_where_the_equation_stands(equation, words):
    conditions = """conditions = ["w(0) = u", "w'(0) = 0"]"""
    with pytest.raises(ModelError) as caught:
        bound(f'{HEAD}equation = "{equation}"\n{conditions}')
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF250"
    assert words in problem.message
    assert problem.message.startswith("a stiffness of 'w' vanishes at x = l")
    assert problem.span is not None
    assert problem.span.text == equation


@pytest.mark.parametrize(
    ("more", "code"),
    [("\"w''(l) = 0\"", "SF250"), ('"w(l) = 0"', "SF243"), ("\"(EI*(1-x/l)^3*w'')'(l) = 0\"", "SF244")],
)
def test_conditions_at_a_tip_are_too_many(more, code):
    text = HEAD + FIELDS["wedge"].replace("conditions = [", f"conditions = [{more}, ")
    with pytest.raises((ModelError, SpecError)) as caught:
        bound(text)
    assert code in {problem.code for problem in caught.value.diagnostics}


def test_a_mass_at_a_tip_is_refused():
    ball = 'ball = { type = "mass", at = "tip", m = "1 kg" }'
    text = ARM.format('"base", "tip"', "1 - x/l", "1 - x/l", ball)
    with pytest.raises(ModelError, match="can be neither held nor loaded"):
        bound(text)


THINNING = """
symflex = 1
[parameters]
E = "210 GPa"
rho = "7800 kg/m^3"
A_0 = "10 cm^2"
l = "0.8 m"
[elements.rod]
type = "rod"
between = ["root", "tip"]
E = "E"
rho = "rho"
l = "l"
A = "A_0*(1 - x/l)*exp(-2*x/l)"
[inputs]
F = { force = "root" }
[outputs]
y = "root"
"""


@pytest.mark.slow
def test_a_rod_that_thins_out_faster_than_its_taper_is_a_power_series_about_its_tip():
    s = mpc(-400, 9000)
    # With t from the tip on the section is t exp(2 t/l): t u'' + (1 + 2 t/l) u' = k^2 t u.
    with mp.workdps(40):
        squared, terms = s**2 * 7800 / mpf("210e9"), [mpf(1), mpf(0)]
        for n in range(2, 200):
            terms.append((squared * terms[n - 2] - 2 / L * (n - 1) * terms[n - 1]) / n**2)
        value = sum(c * L**n for n, c in enumerate(terms))
        slope = sum(n * c * L ** (n - 1) for n, c in enumerate(terms) if n)
        expected = value / (mpf("210e9") * mpf("1e-3") * slope)
        found = complex(bound(THINNING)(complex(s)))
        assert abs(found - complex(expected)) < 1e-13 * abs(complex(expected))
