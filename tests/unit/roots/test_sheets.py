"""Poles on the principal sheet of functions with roots of s, against equations solved in mpmath."""

import mpmath
import numpy as np
import pytest
from mpmath import cos, cosh, exp, mpf, sinh, sqrt

from symflex import pipeline
from symflex.roots import Modes

LOOP = """symflex = 1
parameters = {{ {parameters} }}
definitions.G = "{plant}"
signals.y = "K*G*(r - y)"
inputs.r = {{}}
outputs.Y = "y"
"""
RATIO = """symflex = 1
parameters = {{ {parameters} }}
definitions.Z = "{plant}"
inputs.V = {{ unit = "V" }}
outputs.I = "V/Z"
"""
MASS = """symflex = 1
parameters = {{ {parameters} }}
[elements]
body = {{ type = "mass", at = "x", m = "m" }}
wall = {{ type = "spring", between = ["x", "ground"], k = "{plant}" }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
"""
ROD = """symflex = 1
parameters = {{ {parameters} }}
signals.u = "K*(r - T(x_s))"
inputs.r = {{}}
outputs.Y = "T(x_s)"
[fields.T]
domain = ["0", "l"]
equation = "a*T'' = s*T"
conditions = ["T(0) = u", "{plant}"]
"""
BEAM = """symflex = 1
parameters = {{ {parameters} }}
inputs.F = {{ unit = "N" }}
outputs.Y = "w(l)"
[fields.w]
domain = ["0", "l"]
equation = "{plant}"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*(1 + sqrt(s*tau))*w'''(l) = -F"]
"""


def rod(s):
    """Return 1 + K T(l/2)/u of a rod into which heat flows, and out of it into a half-infinite one."""
    g = sqrt(s * 10000)
    at = [cosh(g * x) + sinh(g * x) / 3 for x in (mpf("0.1"), mpf("0.05"))]
    return at[0] + 60 * at[1]


def beam(s):
    k = mpf("0.8") * (-mpf("0.405") * s**2 / (84 * (1 + sqrt(s / 1000000)))) ** mpf("0.25")
    return 1 + cosh(k) * cos(k)


MODELS = {
    "a half-infinite bar in a loop": (LOOP, "K = 30", "exp(-sqrt(s))", lambda s: 1 + 30 * exp(-sqrt(s))),
    "the same with units": (
        LOOP, 'K = 20, a = "4 mm^2/s", x = "1 cm"', "exp(-x*(s/a)^0.5)", lambda s: 1 + 20 * exp(-5 * sqrt(s))
    ),
    "a half-infinite bar and a delay": (
        LOOP, 'K = 3, T = "0.5 s", x = 2', "exp(-s*T - x*sqrt(s))",
        lambda s: 1 + 3 * exp(-s / 2 - 2 * sqrt(s)),
    ),
    "a diffusive line with an open end": (
        LOOP, 'K = 40, R = "4 Ohm", C = "50 uF"', "1/cosh(sqrt(s*R*C))", lambda s: cosh(sqrt(s / 5000)) + 40
    ),
    "a fractional integrator": (
        LOOP, "K = 3", "1/(s*(s + 1)*s^0.7)", lambda s: s ** mpf("1.7") * (s + 1) + 3
    ),
    "skin effect": (
        RATIO, 'R = "1 Ohm", L = "1 mH", C = "10 uF", tau = "0.3 ms"', "R*sqrt(1 + s*tau) + L*s + 1/(C*s)",
        lambda s: sqrt(1 + 3 * s / 10000) + s / 1000 + 100000 / s,
    ),
    "a Cole-Cole element": (
        RATIO, 'R = "10 Ohm", L = "2 H", C = "1 mF", tau = "20 ms"', "L*s + R/(1 + (s*tau)^0.8) + 1/(C*s)",
        lambda s: 2 * s + 10 / (1 + (s / 50) ** mpf("0.8")) + 1000 / s,
    ),
    "a viscous boundary layer": (
        MASS, 'm = "1 kg", k = "100 N/m", c = 2', "k + c*s^1.5", lambda s: s**2 + 2 * s**1.5 + 100
    ),
    "a rod with a half-infinite end": (
        ROD, 'a = "1e-4 m^2/s", l = "10 cm", x_s = "l/2", K = 60', "T'(l) = -sqrt(s/a)/3*T(l)", rod
    ),
    "a beam of fractional damping": (
        BEAM, 'EI = "84 N*m^2", m = "0.405 kg/m", l = "0.8 m", tau = "1 us"',
        "EI*(1 + sqrt(s*tau))*w'''' + m*s^2*w = 0", beam,
    ),
}  # fmt: skip


SLOW = ("a beam of fractional damping", "a rod with a half-infinite end")
NAMES = [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in MODELS]


def located(text, region=None):
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    return pipeline.roots(bound, region or Modes(2))


@pytest.mark.parametrize("name", NAMES)
def test_poles_solve_the_equation_on_the_principal_branch(name):
    frame, parameters, plant, equation = MODELS[name]
    found = located(frame.format(parameters=parameters, plant=plant))
    assert found.certificate.certified
    poles = [complex(r) for r in found.poles if r.im > 0]
    assert poles
    for pole in poles:
        assert complex(mpmath.findroot(equation, pole * (1 + 1e-5))) == pytest.approx(pole, rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_poles_that_grow_are_as_many_as_the_argument_principle_counts(name):
    frame, parameters, plant, equation = MODELS[name]
    found = located(frame.format(parameters=parameters, plant=plant))
    size = 3 * max((abs(complex(r)) for r in found.poles), default=1.0)
    # From the arc along the axis, about s = 0 on the right, and on along the axis.
    upper = size * np.geomspace(1, 1e-9, 3000)
    small, large = (r * np.exp(1j * np.linspace(-np.pi / 2, np.pi / 2, 3000)) for r in (upper[-1], size))
    path = [*(1j * upper), *small[::-1], *(-1j * upper[::-1]), *large]
    values = np.array([complex(f / abs(f)) for s in path for f in [equation(mpmath.mpc(s))]])
    turns = np.angle(np.roll(values, -1) / values)
    assert max(abs(turns)) < np.pi / 2
    assert found.verdict.right == round(sum(turns) / (2 * np.pi))


def test_roots_on_other_sheets_are_no_poles():
    # r^2 + r + 1 = 0 of r = sqrt(s) has arg r = 120 degrees, where sqrt(s) is -r.
    assert located(RATIO.format(parameters="k = 1", plant="s + k*sqrt(s) + 1")).poles == ()
    (pole, _) = located(RATIO.format(parameters="k = 1", plant="s - k*sqrt(s) + 1")).poles
    assert complex(pole) == pytest.approx(np.exp(2j * np.pi / 3), abs=1e-14)


@pytest.mark.parametrize(
    ("plant", "poles"),
    [
        ("1/cosh(sqrt(s*k))", [-(((n + 0.5) * np.pi) ** 2) for n in range(3)]),
        ("tanh(sqrt(s*k))/sqrt(s*k)", [-(((n + 0.5) * np.pi) ** 2) for n in range(3)]),
        ("sqrt(s*k)/sinh(sqrt(s*k))", [-((n * np.pi) ** 2) for n in range(1, 4)]),
        # A wall of Biot number 1: beta tan(beta) = 1 (Carslaw and Jaeger 1959, appendix IV).
        ("1/(cosh(sqrt(s*k)) + sqrt(s*k)*sinh(sqrt(s*k)))", [-(b**2) for b in (0.8603, 3.4256, 6.4373)]),
    ],
)
def test_poles_on_the_branch_cut_are_proved_to_be_real_and_simple(plant, poles):
    text = RATIO.format(parameters="k = 1", plant=f"1/({plant})")
    found = located(text, Modes(3))
    assert found.certificate.certified
    assert [r.is_real for r in found.poles] == [True] * 3
    assert [complex(r) for r in found.poles] == pytest.approx(poles, rel=1e-4)


def test_factors_without_roots_keep_exact_places():
    found = located(RATIO.format(parameters="k = 1", plant="(s^2 + 4)*(s + 1)^2*(1 + k*s^0.5)"), Modes(3))
    assert found.verdict.sentence == "marginal, not asymptotically stable: poles on the imaginary axis"
    assert [(complex(r), r.multiplicity, r.on_imaginary_axis) for r in found.poles if not r.im < 0] == [
        (-1, 2, False),
        (2j, 1, True),
    ]


def test_a_branch_point_where_the_function_is_infinite_keeps_it_from_resting():
    for plant, word in (("sqrt(s)", "marginal"), ("1/sqrt(s)", "stable"), ("sqrt(s + 1)", "stable")):
        assert located(RATIO.format(parameters="k = 1", plant=f"k*{plant}")).verdict.word == word, plant


def test_hidden_factors_with_and_without_roots_of_s_are_told_apart():
    # y = exp(-r)/(s + 1) R: what cancels is s + 2, and 1 - exp(-r)/3, which vanishes at r = -ln 3 + 2 pi k j
    found = located("""symflex = 1
parameters = { a = "1 s" }
signals.u = "R/(s + 2)/(1 - exp(-sqrt(s*a))/3)"
signals.y = "exp(-sqrt(s*a))*(1 - exp(-sqrt(s*a))/3)*(s + 2)*u/(s + 1)"
inputs.R = {}
outputs.Y = "y"
""")
    assert [complex(root) for root in found.poles] == [-1]
    assert [complex(mode.root) for mode in found.hidden] == [-2]


WAVES = """symflex = 1
parameters = {{ k = "4 N/m^2", T = "1 s", eta = "0.5 s" }}
signals.u = "{signal}"
inputs.F = {{}}
outputs.Y = "{output}"
[elements]
{elements}
act = {{ type = "force_source", at = "{output}", f = "u" }}
"""
ROD_OF_2_N = 'arm = {{ type = "rod", between = ["a", "x"], EA = "2 N", rhoA = "1 kg/m", l = "1 m", {} }}'
HELD = 'end = { type = "fixed", at = "a" }'
SIGNALS = ("F/(1 + sqrt(s*T))", "F*sqrt(s*T + 3)/(1 + s*T)", "F/(s*T)^(1/3)")


def waves(elements, signal, output="x", region=None):
    return located(WAVES.format(elements="\n".join(elements), signal=signal, output=output), region)


def rod_s_poles(added, damping):
    """Return the roots of s^2 + 2 ((n + 1/2) pi)^2 (1 + damping s) + added: of a rod held at one end."""
    squares = [2 * ((n + 0.5) * np.pi) ** 2 for n in range(8)]
    top, below = added
    return [
        r for a in squares for r in np.roots(np.polyadd(np.polymul(below, [1, damping * a, a]), top))
    ]  # fmt: skip


@pytest.mark.parametrize("signal", SIGNALS)
def test_waves_in_s_beside_a_root_of_s_have_the_poles_they_have_alone(signal):
    # where 1 + eta s = 0, at -2, or 1 + s T = 0, at -1, waves have no frequency, and the model no pole
    laws = {
        "eta = 'eta'": (([0], [1]), 0.5),
        "c_f = 'k*T/(1 + s*T)'": (([4, 0], [1, 1]), 0),
        "k_f = 'k/(2 + s*T)^2'": (([4], [1, 4, 4]), 0),
    }
    for law, coefficients in laws.items():
        found = waves((ROD_OF_2_N.format(law.replace("'", '"')), HELD), signal, region=Modes(2))
        expected = np.array(rod_s_poles(*coefficients))
        assert found.certificate.certified, law
        shown = [complex(r) for r in found.poles if abs(complex(r)) > 1e-9 and abs(complex(r) + 1) > 1e-9]
        assert shown, law
        assert all(min(abs(expected - pole)) < 1e-9 for pole in shown), law
        assert len(set(np.round(shown, 6))) == len(shown), law
        assert (found.verdict.word == "unstable") == bool(max(expected.real) > 1e-9), law


@pytest.mark.parametrize(
    "signal", ["F/(1 + sqrt(s*T))", pytest.param("F - k*L*sqrt(s*T)*x.y", marks=pytest.mark.slow)]
)
def test_where_waves_vanish_beside_a_root_of_s_the_equations_say_which_poles_there_are(signal):
    # A rod on a hinge that stays straight: s^2 + 4 (s - 3) = (s - 2) (s + 6), both poles seen and simple.
    beam = (
        'arm = { type = "beam", between = ["a", "x"], EI = "2 N*m^2", rhoA = "1 kg/m", l = "1 m", '
        'eta = "eta", k_f = "k*(s*T - 3)" }'
    )
    text = WAVES.format(elements=f'{beam}\nend = {{ type = "pin", at = "a" }}', signal=signal, output="x.y")
    found = located(text.replace("eta =", 'L = "0.25 m", eta =', 1), Modes(2))
    assert found.hidden == ()
    assert found.verdict.sentence == "unstable: 1 pole in the right half-plane"
    if "x.y" not in signal:
        assert [(complex(r), r.multiplicity) for r in found.poles[:2]] == [(2, 1), (-6, 1)]
