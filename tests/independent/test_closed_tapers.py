"""Closed forms that are printed for members which taper, by mpmath's Bessel functions, against enclosures.

The enclosures are power series of the differential equation: they know of no Bessel function.
"""

import mpmath
import pytest
from flint import acb, ctx
from mpmath import mp, mpc, mpf

from symflex import pipeline
from symflex.expressions import Bessel, fold, format_expression
from symflex.print.forms import print_form

DIGITS = 45
PLACES = (3 + 40j, -20 + 30j)
FUNCTIONS = {"J": mpmath.besselj, "Y": mpmath.bessely, "I": mpmath.besseli, "K": mpmath.besselk}

PARAMETERS = """
symflex = 1
[parameters]
E = "2.1 MPa"
rho = "1200 kg/m^3"
A = "3 mm^2"
I = "20 cm^4"
l = "0.8 m"
c = 0.4
a = "1.3 1/m"
d = "0.9 1/m"
eta = "2 ms"
m = "20 g"
EI = "13 N*m^2"
EA = "1.3 kN"
rhoA = "0.7 kg/m"
g = "981 m/s^2"
[inputs]
"""
MEMBER = """
F = {{ force = "tip" }}
[outputs]
y = "tip"
[elements]
base = {{ type = "spring", between = ["root", "ground"], k = "1 kN/m" }}
load = {{ type = "mass", at = "tip", m = "m" }}
member = {{ type = "{}", between = ["root", "tip"], l = "l", {} }}
"""
BEAM = """
F = {{ force = "tip" }}
[outputs]
y = "tip"
[elements]
base = {{ type = "pin", at = "root" }}
load = {{ type = "rigid_body", at = "tip", m = "m", J = "m*l^2/50" }}
member = {{ type = "beam", between = ["root", "tip"], l = "l", E = "E", rho = "rho", {} }}
"""
FIELD = """
u = {{ unit = "m" }}
[outputs]
tip = "w(l)"
slope = "w'(l/3)"
[fields.w]
domain = ["0", "l"]
equation = "{}"
conditions = [{}]
"""
ROD = 'E = "E", rho = "rho"'
STIFF = f'{ROD}, A = "A*(1 - c*x/l)'
WIRE = 'E = "E", rho = "rho", A = "A*exp(-2*a*x)"'
CLAMP = '"w(0) = u", "w\'(0) = 0"'
ENDS = '"w(0) = u", "w\'(l) = 0"'
MODELS = {
    "a rod that is a wedge": MEMBER.format("rod", f'{STIFF}"'),
    "a rod that is a cone": MEMBER.format("rod", f'{STIFF}^2"'),
    "a rod of the third power": MEMBER.format("rod", f'{STIFF}^3"'),
    "a rod of the fourth power": MEMBER.format("rod", f'{STIFF}^4"'),
    "a rod of the fourth power with damping": MEMBER.format("rod", f'{STIFF}^4", eta = "eta"'),
    "a rod that widens": MEMBER.format("rod", f'{STIFF}^(-2)"'),
    "an exponential rod": MEMBER.format("rod", WIRE),
    "a string whose tension grows": MEMBER.format("string", 'rho = "rho", A = "A", N = "E*A*(2 - x/l)"'),
    "a string that is thick at one end": MEMBER.format(
        "string", 'rho = "rho", A = "A*(1 - c*x/l)", N = "E*A"'
    ),
    "a string of stiffer ends": MEMBER.format("string", 'rho = "rho", A = "A", N = "E*A*(1 + x/l)^4"'),
    "a string, exponentially thick": MEMBER.format("string", 'rho = "rho", A = "A*exp(a*x)", N = "E*A"'),
    "a beam that is a wedge": BEAM.format('I = "I*(1 - c*x/l)^3", A = "A*(1 - c*x/l)"'),
    "a beam that is a cone": BEAM.format('I = "I*(1 - c*x/l)^4", A = "A*(1 - c*x/l)^2"'),
    "a wedge to its edge": FIELD.format("(EI*(1 - x/l)^3*w'')'' + rhoA*(1 - x/l)*s^2*w = 0", CLAMP),
    "a cone to its tip": FIELD.format("(EI*(1 - x/l)^4*w'')'' + rhoA*(1 - x/l)^2*s^2*w = 0", CLAMP),
    "a hanging string": FIELD.format("(rhoA*g*(l - x)*w')' = rhoA*s^2*w", '"w(0) = u"'),
    "a hanging string, divided": FIELD.format("g*(l - x)*w'' - g*w' = s^2*w", '"w(0) = u"'),
    "a cone's rod to its tip": FIELD.format("(EA*(1 - x/l)^2*w')' = rhoA*(1 - x/l)^2*s^2*w", '"w(0) = u"'),
    "a rod of the fourth power to its tip": FIELD.format(
        "(EA*(1 - x/l)^4*w')' = rhoA*(1 - x/l)^4*s^2*w", '"w(0) = u"'
    ),
    "a cubic rod to its edge": FIELD.format("(EA*(1 - x/l)^3*w')' = rhoA*(1 - x/l)^3*s^2*w", '"w(0) = u"'),
    "a rod to its edge with damping": FIELD.format(
        "(EA*(1 + eta*s)*(1 - x/l)*w')' = rhoA*(1 - x/l)*s^2*w", '"w(0) = u"'
    ),
    "a wedge to its edge with damping": FIELD.format(
        "(EI*(1 + eta*s)*(1 - x/l)^3*w'')'' + rhoA*(1 - x/l)*s^2*w = 0", CLAMP
    ),
    "a horn's equation of sound": FIELD.format("EA*w'' - 2*EA*c/(l - c*x)*w' = rhoA*s^2*w", ENDS),
    "an exponential horn's": FIELD.format("(EA*exp(d*x)*w')' = rhoA*exp(d*x)*s^2*w", ENDS),
}


def printed_value(tf, form, values, s):
    """Return the value of a printed form whose functions of x are those of its closed lines."""
    lines = {format_expression(left): e for left, e in form.closed} | dict(form.where)
    known = {"s": mpc(s), "pi": mp.pi, **values}

    def named(name):
        if name not in known:
            known[name] = value(lines[name])
        return known[name]

    def called(call, argument):
        if isinstance(call, Bessel):
            return FUNCTIONS[call.kind](mpf(call.index.numerator) / call.index.denominator, argument)
        if call.name in ("sqrt", "exp", "cosh", "sinh"):
            return getattr(mpmath, call.name)(argument)
        return value(lines[format_expression(call)])

    def value(expression):
        return fold(
            expression,
            number=lambda n: mpf(n.numerator) / n.denominator,
            name=named,
            power=lambda base, exponent: base ** value(exponent),
            call=called,
        )

    return value(form.num) / value(form.den)


SLOW = (
    "a rod of the third power", "a rod of the fourth power with damping", "a string of stiffer ends",
    "a string, exponentially thick", "a hanging string, divided", "a rod of the fourth power to its tip",
    "a cubic rod to its edge", "a wedge to its edge with damping", "a beam that is a wedge",
    "a beam that is a cone", "an exponential horn's", "an exponential rod", "a rod of the fourth power",
)  # fmt: skip


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in MODELS])
def test_the_closed_form_has_the_value_that_is_enclosed(name):
    model = pipeline.loads(PARAMETERS + MODELS[name])
    for tf in pipeline.derive_all(model):
        form, bound = print_form(tf), pipeline.bind(tf)
        assert form.closed
        with mp.workdps(50), ctx.workprec(170):
            values = {n: mpf(v.rational.numerator) / v.rational.denominator for n, v in bound.values}
            enclosed = bound.enclosed(120)
            for s in PLACES:
                found = printed_value(tf, form, values, s)
                ratio = enclosed(acb(s))
                expected = mpc(*(mpf(x.mid().str(DIGITS, radius=False)) for x in (ratio.real, ratio.imag)))
                assert ratio.rad() < 1e-26 * abs(ratio)
                assert abs(found - expected) < mpf(10) ** -25 * abs(expected), (tf.name, s)
