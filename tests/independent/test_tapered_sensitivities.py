"""Derivatives of poles of members that taper against scaling laws and closed forms."""

import pytest
from mpmath import diff, findroot, mp, mpf

from symflex import pipeline
from symflex.analysis.sensitivity.sensitivity import sensitivities
from symflex.roots.region import Modes

HEAD = """
symflex = 1
[parameters]
E = "2 Pa"
rho = "3 kg/m^3"
A_0 = "0.4 m^2"
I_0 = "0.1 m^4"
l = "1.5 m"
c = 0.6
a = "0.5 1/m"
eta = "0.1 s"
"""
FORCE = 'F = { force = "tip" }'
MOVED = 'u = { displacement = "base" }'
BEAM = """
[elements]
arm = { type = "beam", between = ["ground", "tip"], E = "E", rho = "rho", l = "l", %s }
"""
ROD = """
[elements]
bar = { type = "rod", between = ["base", "tip"], E = "E", rho = "rho", l = "l", %s }
"""


def derivatives(text, *names, given=None):
    given = given or (MOVED if "base" in text else FORCE)
    model = pipeline.loads(f'{HEAD}{text}[inputs]\n{given}\n[outputs]\ny = "tip"\n')
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = pipeline.roots(bound, Modes(1))
    moved = sensitivities(model, bound, found, names)
    assert all(each.status == "certified" for each in moved if each.root.im != 0)
    return {each.parameter.name: each for each in moved if each.kind == "pole" and each.root.im > 0}


@pytest.mark.slow
def test_frequencies_of_a_tapered_cantilever_scale_as_dimensions_say():
    # omega is sqrt(E I_0/(rho A_0))/l^2 times a number that depends on c alone.
    # Of the wedge below, E and rho too.
    found = derivatives(BEAM % 'I = "I_0*(1 - c*x/l)^3", A = "A_0*(1 - c*x/l)"', "I_0", "A_0", "l")
    for name, power in (("I_0", 0.5), ("A_0", -0.5), ("l", -2)):
        assert abs(found[name].normalised - power) < 1e-14


@pytest.mark.slow
def test_the_pole_of_a_conical_rod_moves_with_its_cone_as_the_closed_form_does():
    # u (1 - c x/l) = sin(q x/l), free at l: q cos(q) (1 - c) + c sin(q) = 0; omega = q sqrt(E/rho)/l.
    found = derivatives(ROD % 'A = "A_0*(1 - c*x/l)^2"', "c")
    with mp.workdps(30):

        def frequency(c):
            q = findroot(lambda q: q * mp.cos(q) * (1 - c) + c * mp.sin(q), 2)
            return q * mp.sqrt(mpf(2) / 3) / mpf("1.5")

        expected = diff(frequency, mpf("0.6"))
        assert abs(found["c"].derivative.imag.mid() - float(expected)) < 1e-13 * abs(float(expected))


@pytest.mark.slow
def test_the_pole_of_a_lossy_exponential_rod_moves_as_the_closed_form_does():
    # u = exp(a x) sin(p x), p^2 = -rho s^2/(E (1 + eta s)) - a^2 (Webster 1919); free: a sin + p cos = 0.
    found = derivatives(ROD % 'A = "A_0*exp(-2*a*x)", eta = "eta"', "a", "eta")
    with mp.workdps(40):
        given = {"a": mpf("0.5"), "length": mpf("1.5"), "eta": mpf("0.1")}

        def pole(**changed):
            a, length, eta = {**given, **changed}.values()
            p = findroot(lambda p: a * mp.sin(p * length) + p * mp.cos(p * length), 1.3)
            # rho s^2 + (p^2 + a^2) E (1 + eta s) = 0.
            b = (p**2 + a**2) * mpf(2) / 3
            return (-b * eta + mp.sqrt((b * eta) ** 2 - 4 * b)) / 2

        for name, value in (("a", given["a"]), ("eta", given["eta"])):
            expected = complex(diff(lambda x, name=name: pole(**{name: x}), value))
            assert abs(complex(found[name].derivative.mid()) - expected) < 1e-12 * abs(expected)


# ------------------------------------------------------------------------------ where a stiffness vanishes


@pytest.mark.slow
def test_frequencies_of_wedges_and_hanging_strings_scale_as_dimensions_say():
    # The tip lies at x = l, and moves with l.
    wedge = 'I = "I_0*(1 - x/l)^3", A = "A_0*(1 - x/l)"'
    base = BEAM.replace('"ground"', '"base"') + 'slider = { type = "slider", at = "base" }\n'
    found = derivatives(base % wedge, "E", "I_0", "rho", "A_0", "l")
    for name, power in (("E", 0.5), ("I_0", 0.5), ("rho", -0.5), ("A_0", -0.5), ("l", -2)):
        assert abs(found[name].normalised - power) < 1e-14


@pytest.mark.slow
def test_the_pole_of_a_full_cone_on_a_mass_moves_as_the_closed_form_does():
    # With h from the tip u = sin(k h)/h: E A_0 u'(l) = m omega^2 u(l), omega = k sqrt(E/rho).
    text = ROD % 'A = "A_0*(1 - x/l)^2"' + 'load = { type = "mass", at = "base", m = "c*rho*A_0/(2*a)" }\n'
    found = derivatives(text.replace("base", "foot"), "l", "A_0", "c", "E", given='F = { force = "foot" }')
    with mp.workdps(30):
        given = {"l": mpf("1.5"), "c": mpf("0.6"), "E": mpf(2)}

        def frequency(**changed):
            length, c, modulus = {**given, **changed}.values()
            k = findroot(lambda k: k * mp.cot(k * length) - 1 / length - c * k**2, 2.3)
            return k * mp.sqrt(modulus / 3)

        assert abs(found["l"].root.im - float(frequency())) < 1e-12
        assert abs(found["A_0"].derivative.imag.mid()) < 1e-12
        for name, value in given.items():
            expected = diff(lambda x, name=name: frequency(**{name: x}), value)
            assert abs(found[name].derivative.imag.mid() - float(expected)) < 1e-12 * abs(float(expected))
