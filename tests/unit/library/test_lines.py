"""Distributed elements against textbook statics and the closed forms of rods, shafts and strings."""

import cmath
import re
from itertools import product

import pytest

from symflex import pipeline
from symflex.errors import SpecError

VALUES = {"E": 2, "I": 3, "rho": 5, "A": 7, "l": 2, "G": 4, "J": 3, "N": 3, "kappa": 0.5}
PARAMETERS = "".join(f"{name} = {value}\n" for name, value in VALUES.items())
BEAM = 'arm = {{ type = "beam", between = ["a", "b"], E = "E", I = "I", rho = "rho", A = "A", l = "l"{} }}\n'
FIXED = 'wall = {{ type = "fixed", at = "{}" }}\n'
SHEAR = ', theory = "timoshenko", kappa = "kappa", G = "G"'
SLOW = 1e-5


def response(elements, source, output, s=SLOW):
    text = f"symflex = 1\n[parameters]\n{PARAMETERS}[elements]\n{elements}"
    text += f'[inputs]\nU = {source}\n[outputs]\nX = "{output}"\n'
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    return complex(pipeline.bind(tf)(s))


STATICS = {
    # Timoshenko & Gere 1972, deflections of a cantilever: P l^3/(3 EI), P l^2/(2 EI), M l/(EI).
    "tip deflection under a force": (FIXED.format("a"), '{ force = "b" }', "b", 8 / 18),
    "tip slope under a force": (FIXED.format("a"), '{ force = "b" }', "b.theta", 4 / 12),
    "tip slope under a moment": (FIXED.format("a"), '{ torque = "b.theta" }', "b.theta", 2 / 6),
    # Held at the far end, the slope at the loaded one is opposite.
    "slope of a beam held at x = l": (FIXED.format("b"), '{ force = "a" }', "a.theta", -4 / 12),
    # What the beam delivers at its tip balances the force there.
    "force at the second end": (FIXED.format("a"), '{ force = "b" }', "arm.f", -1),
    "moment at the second end": (FIXED.format("b"), '{ force = "a" }', "arm.tau", -2),
    "reaction of the wall": (FIXED.format("a"), '{ force = "b" }', "wall.f", -1),
}


def test_a_beam_at_rest_is_a_cantilever_of_the_textbook():
    for case, (rest, source, output, expected) in STATICS.items():
        found = response(BEAM.format("") + rest, source, output)
        assert found == pytest.approx(expected, rel=1e-7), case


def test_a_timoshenko_beam_at_rest_also_shears():
    # P l^3/(3 EI) + P l/(kappa G A), Timoshenko 1921.
    found = response(BEAM.format(SHEAR) + FIXED.format("a"), '{ force = "b" }', "b")
    assert found == pytest.approx(8 / 18 + 2 / (0.5 * 4 * 7), rel=1e-7)


def test_an_axial_force_stiffens_a_beam_in_tension():
    # P (k l - tanh(k l))/(k N) with k^2 = N/(EI), Timoshenko & Gere 1961, Theory of Elastic Stability.
    k = (3 / 6) ** 0.5
    expected = (k * 2 - cmath.tanh(k * 2)) / (k * 3)
    found = response(BEAM.format(', N = "N"') + FIXED.format("a"), '{ force = "b" }', "b")
    assert found == pytest.approx(expected, rel=1e-7)


WAVES = {
    # type: (values, source, stiffness times length, inertia per length)
    "rod": ('E = "E", A = "A"', "force", 14, 35),
    "shaft": ('G = "G", J = "J"', "torque", 12, 15),
    "string": ('N = "N", A = "A"', "force", 3, 35),
}


def test_a_held_wave_guide_answers_with_a_hyperbolic_tangent():
    # u(l)/F = tanh(g l)/(K g), g = s sqrt(m/K): Graff 1975, section 2.
    for (kind, (values, drive, stiffness, inertia)), (ends, s) in product(
        WAVES.items(), [('"ground", "b"', 1.3j), ('"b", "ground"', 0.4 - 0.2j)]
    ):
        part = f'part = {{ type = "{kind}", between = [{ends}], {values}, rho = "rho", l = "l" }}\n'
        g = s * (inertia / stiffness) ** 0.5
        found = response(part, f'{{ {drive} = "b" }}', "b", s)
        assert found == pytest.approx(cmath.tanh(2 * g) / (stiffness * g), rel=1e-12), (kind, ends)


def test_a_kelvin_voigt_rod_on_a_foundation_answers_with_a_hyperbolic_tangent():
    s, stiffness = 0.3 + 1j, 14 * (1 + 0.1 * (0.3 + 1j))
    g = ((35 * s**2 + 0.2 * s + 0.7) / stiffness) ** 0.5
    part = 'part = { type = "rod", between = ["ground", "b"], E = "E", A = "A", rho = "rho", l = "l"'
    found = response(part + ", eta = 0.1, c_f = 0.2, k_f = 0.7 }\n", '{ force = "b" }', "b", s)
    assert found == pytest.approx(cmath.tanh(2 * g) / (stiffness * g), rel=1e-12)


# EI = 6, EA = 14, rhoA = 35, rhoI = 15, kappaGA = 14, GJ = 12, rhoJ = 15 are those of VALUES.
TWICE = {
    "beam": (
        ('E = "E", I = "I", rho = "rho", A = "A"', "EI = 6, rhoA = 35"),
        ('E = "E", I = "I", rho = "rho", A = "A"', 'EI = 6, rho = "rho", A = "A"'),
        (
            'E = "E", I = "I", rho = "rho", A = "A", theory = "rayleigh"',
            'EI = 6, rhoA = 35, rhoI = 15, theory = "rayleigh"',
        ),
        (
            f'E = "E", I = "I", rho = "rho", A = "A"{SHEAR}',
            'EI = 6, rhoA = 35, rhoI = 15, kappaGA = 14, theory = "timoshenko"',
        ),
    ),
    "frame": (('E = "E", I = "I", rho = "rho", A = "A"', "EI = 6, rhoA = 35, EA = 14"),),
    "rod": (('E = "E", A = "A", rho = "rho"', "EA = 14, rhoA = 35"),),
    "shaft": (('G = "G", J = "J", rho = "rho"', "GJ = 12, rhoJ = 15"),),
    "string": (('N = "N", A = "A", rho = "rho"', 'N = "N", rhoA = 35'),),
}


def test_products_stand_in_place_of_their_factors():
    for kind, pairs in TWICE.items():
        end, load = ("a", "torque") if kind == "shaft" else ("a.y" if kind == "frame" else "a", "force")
        support = FIXED.format("b") if kind in ("beam", "frame") else ""
        far = "b" if support else "ground"
        for pair in pairs:
            both = [
                response(
                    f'{support}arm = {{ type = "{kind}", between = ["a", "{far}"], l = "l", {given} }}\n',
                    f'{{ {load} = "{end}" }}',
                    end,
                    0.3 + 2j,
                )
                for given in pair
            ]
            assert abs(both[0] / both[1] - 1) < 1e-12, pair


def test_what_a_product_makes_spare_or_leaves_open_is_refused():
    for given, message in (
        ('EI = 6, E = "E", rhoA = 35', "beam 'arm' has EI in place of E*I and also E"),
        ('EI = 6, rho = "rho"', "beam 'arm' lacks A, a cross-sectional area"),
        ('theory = "timoshenko", EI = 6, rho = "rho", kappaGA = 14', "beam 'arm' lacks I, a second moment"),
        ('theory = "timoshenko", EI = 6, rhoA = 35, kappaGA = 14', "beam 'arm' lacks rhoI, a rotary inertia"),
        ("EI = 6, rhoA = 35, kappaGA = 14", "kappaGA of beam 'arm' does not go with"),
    ):
        with pytest.raises(SpecError, match=re.escape(message)):
            response(
                f'{FIXED.format("b")}arm = {{ type = "beam", between = ["a", "b"], l = "l", {given} }}\n',
                '{ force = "a" }',
                "a",
            )
