"""Members whose coefficients vary along x against collocation with Chebyshev polynomials, and a benchmark."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import pi

import numpy as np
import pytest

from symflex import pipeline
from symflex.errors import ModelError, SpecError
from symflex.roots.locate import locate
from symflex.roots.passivity import energy_proof
from symflex.roots.region import Modes

E, RHO = 200e9, 7800.0
A_0, I_0 = 16e-4, 21.3e-8
BEAM = """
symflex = 1
[parameters]
E = "200 GPa"
rho = "7800 kg/m^3"
G = "77 GPa"
A_0 = "16 cm^2"
I_0 = "21.3 cm^4"
l = "1 m"
a = "0.7 1/m"
eta = "20 us"
[elements]
arm = {{ type = "beam", between = ["ground", "tip"], E = "E", rho = "rho", l = "l", {} }}
[inputs]
F = {{ force = "tip" }}
[outputs]
y = "tip"
"""
POINTS = (30 + 200j, -100 + 3000j, 5j)


def chebyshev(n):
    """Return points from 1 to -1 and the matrix that differentiates there (Trefethen 2000, chapter 6)."""
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    apart = np.subtract.outer(x, x) + np.eye(n + 1)
    d = np.outer(c, 1 / c) / apart
    return x, d - np.diag(d.sum(axis=1))


def propagated(matrix, length, s, scales, n=32, pieces=4):
    """Return the state at the end per state at the start, of z' = matrix(x, s) z, states in units."""
    size = len(scales)
    x, d = chebyshev(n)
    h, total = length / pieces, np.eye(size, dtype=complex)
    units = np.outer(scales, 1 / np.asarray(scales))
    for piece in range(pieces):
        a = np.kron(d * 2 / h, np.eye(size)).astype(complex)
        for i in range(n + 1):
            own = slice(i * size, (i + 1) * size)
            a[own, own] -= matrix(piece * h + (1 + x[i]) * h / 2, s) / units
        a[n * size :] = 0
        a[n * size :, n * size :] = np.eye(size)
        right = np.zeros(((n + 1) * size, size), dtype=complex)
        right[n * size :] = np.eye(size)
        total = np.linalg.solve(a, right)[:size] @ total
    return total * units


def beam(second_moment, section):
    def matrix(x, s):
        m = np.zeros((4, 4), dtype=complex)
        m[0, 1], m[1, 3], m[3, 2] = 1, 1 / (E * second_moment(x)), -1
        m[2, 0] = RHO * section(x) * s**2
        return m

    return matrix


def linear(x):
    return 1 - x / 2


WEDGE = 'I = "I_0*(1 - x/(2*l))^3", A = "A_0*(1 - x/(2*l))"'


@cache
def bound(values):
    model = pipeline.loads(BEAM.format(values))
    (found,) = pipeline.derive_bound(model, model.transfer_functions)
    return found


def test_a_tapered_cantilever_answers_as_collocation_does():
    # Other tapers, theories and damping: test_tapered_members, by Taylor steps.
    matrix = beam(lambda x: I_0 * linear(x) ** 3, lambda x: A_0 * linear(x))
    for s in POINTS:
        z = propagated(matrix, 1.0, s, (1.0, 1.0, 1e6, 1e6))
        tip = z[:2, 2:] @ np.linalg.solve(z[2:, 2:], [1, 0])
        assert bound(WEDGE)(s) == pytest.approx(tip[0], rel=1e-8)


def test_a_uniform_section_written_with_x_is_the_uniform_beam():
    uniform = bound('I = "I_0", A = "A_0"')
    written = bound('I = "I_0*(1 + x/l - x/l)", A = "A_0*exp(0*x/l)"')
    assert not any(law.matrix for law in uniform.kernels.dispersions)
    for s in POINTS:
        assert written(s) == pytest.approx(uniform(s), rel=1e-14)


FIELD = """
symflex = 1
parameters = { E = "200 GPa", rho = "7800 kg/m^3", h = "40 mm", l = "1 m", c = 0.75 }
definitions = { I_0 = "h^4/12", A_0 = "h^2" }
inputs.F = { unit = "N" }
outputs.y = "w(l)"
[fields.w]
domain = ["0", "l"]
equation = "(E*I_0*(1 - c*x/l)^4*w'')'' + rho*A_0*(1 - c*x/l)^2*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "(E*I_0*(1 - c*x/l)^4*w'')'(l) = -F"]
"""


@pytest.mark.slow
def test_the_square_section_benchmark_is_certified():
    # By two independent solves with 30 digits, the clamped cantilever from 40 mm to 10 mm.
    hertz = [54.1887208510847, 171.969815435321, 384.53123265261, 697.428503998152, 1112.47098750314]
    model = pipeline.loads(FIELD)
    (found,) = pipeline.derive_bound(model, model.transfer_functions)
    located = locate(found, Modes(5))
    assert located.certificate.certified
    upper = [root for root in located.poles if root.im > 0]
    assert [float(root.im.mid()) / (2 * pi) for root in upper] == pytest.approx(hertz, rel=1e-14)
    assert all(root.re == 0 for root in upper)


EXPONENTIAL = """
symflex = 1
parameters = { E = "200 GPa", I = "1 cm^4", rho = "7800 kg/m^3", A = "1 cm^2", l = "1 m", a = "0.5 1/m" }
inputs.F = { unit = "N" }
outputs.y = "w(l)"
[fields.w]
domain = ["0", "l"]
equation = "E*I*(w'''' - 4*a*w''' + 4*a^2*w'') + rho*A*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "E*I*w'''(l) = -F"]
"""


@pytest.mark.slow
def test_an_exponential_taper_with_constant_coefficients_is_certified():
    # Divided by exp(-2 a x), its equation has constant coefficients; after a shift its exponents are pairs.
    model = pipeline.loads(EXPONENTIAL)
    (found,) = pipeline.derive_bound(model, model.transfer_functions)
    located = locate(found, Modes(3))
    assert located.certificate.certified
    assert not located.hidden
    matrix = beam(lambda x: 1e-8 * np.exp(-x), lambda x: 1e-4 * np.exp(-x))
    for root in located.poles:
        free = propagated(matrix, 1.0, complex(0, float(root.im.mid())), (1.0, 1.0, 1e4, 1e4))[2:, 2:]
        assert abs(np.linalg.det(free)) < 1e-6 * np.linalg.norm(free) ** 2


@pytest.mark.parametrize(
    ("values", "place"),
    [
        ('I = "I_0*(1 - 3*x/l)^2", A = "A_0"', 1 / 3),
        ('I = "I_0*(1 - a*x/0.7)^3", A = "A_0"', 1.0),
        ('I = "I_0*sqrt(1 - 1.5*x/l)", A = "A_0"', 2 / 3),
        ('I = "I_0", A = "A_0/(1 - 4*x/l)^2"', 0.25),
        ('I = "I_0", A = "A_0*(2 + log(x/l - 0.75))"', 0.0),
    ],
)
def test_what_is_not_analytic_is_refused_with_its_place(values, place):
    with pytest.raises(ModelError) as caught:
        bound(values)(3j)
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF250"
    said = float(problem.message.split("x = ")[1].split(" ")[0])
    assert said == pytest.approx(place, abs=1e-2)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ('I = "I_0*(1 - 2*x/l)^3", A = "A_0"', "I of beam 'arm' at x = l is negative"),
        ('I = "I_0", A = "A_0*(1 - 4*x/l)"', "A of beam 'arm' at x = l is negative"),
    ],
)
def test_sections_that_vanish_or_change_sign_at_an_end_are_refused(values, words):
    with pytest.raises(SpecError) as caught:
        pipeline.loads(BEAM.format(values))
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF209"
    assert problem.message.startswith(words)
    assert problem.span is not None


def test_a_tapered_arm_with_dampers_is_passive_where_its_sections_are_positive():
    for taper in ("1 - x/(2*l)", "exp(-a*x)", "1 - a*x"):
        model = pipeline.loads(BEAM.format(f'I = "I_0*({taper})", A = "A_0*({taper})", eta = "eta"'))
        values = {p.name: p.value for p in model.parameters if p.value}
        assert energy_proof(model, values.items()).is_passive
        steeper = values | {"a": replace(values["a"], rational=Fraction(3, 2))}
        assert energy_proof(model, steeper.items()).is_passive is (taper != "1 - a*x")


@pytest.mark.parametrize("section", ["(1 - a*x)^3", "a*x*(1 - a*x)/(2 - a*x)", "(1 - a*x)*exp(a*x)"])
def test_an_arm_whose_section_vanishes_at_an_end_is_passive_too(section):
    # With a of 1/m it vanishes at 1 m, the end; with 3/2 before, and is negative beyond.
    model = pipeline.loads(BEAM.format(f'I = "I_0*(1 - x/(2*l))", A = "A_0*{section}"'))
    values = {p.name: p.value for p in model.parameters if p.value}
    for a, is_told in ((Fraction(1), True), (Fraction(3, 2), False)):
        varied = values | {"a": replace(values["a"], rational=a)}
        assert energy_proof(model, varied.items()).is_passive is is_told
