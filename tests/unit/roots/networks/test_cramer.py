"""Determinants at points and their bounds in discs, against closed forms."""

from fractions import Fraction
from math import log

import numpy as np
import pytest
from flint import acb, arb, ctx

from symflex import pipeline
from symflex.model import ExactValue
from symflex.roots.networks.at_rest import order_at_zero
from symflex.roots.networks.cramer import CramerEquations
from symflex.transfer.equations_at import EssentialSingularityError
from tests.unit.roots.networks.network_models import equations_of, specification

ROD = 'type = "rod", E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m"'
"""Unit stiffness, unit mass per length: waves travel it in a second."""


def rod(more="", extra="", outputs='X = "a"'):
    elements = f'bar = {{ {ROD}, between = ["ground", "a"]{extra} }}\n{more}'
    return CramerEquations.of(equations_of(specification(elements, outputs=outputs)), "X", "F")


def test_their_quotient_is_the_receptance():
    for s in [0.3 + 0.2j, 5j + 1e-3, -2 + 7j]:
        found = rod().at(acb(s.real, s.imag), 100)
        assert complex(found.num / found.den) == pytest.approx(np.tanh(s) / s, rel=1e-12)


def test_each_alone_is_entire_and_vanishes_at_its_roots():
    equations = rod()
    with ctx.workprec(200):
        pole = acb(0, (arb.pi() / 2).mid())
    assert abs(equations.alone(pole, 200, is_num=False)) < 1e-50
    assert abs(equations.alone(pole, 200, is_num=True)) > 1e-3


def test_the_bounds_hold_on_the_circle_grow_with_it_and_are_not_far_from_what_they_bound():
    for radius in [0.5, 10.0]:
        equations = rod('m = { type = "mass", at = "a", m = "3 kg" }')
        den, num = equations.bounds(radius)
        for k in range(12):
            s = acb(0, k).exp() * radius
            found = equations.at(s.mid(), 100)
            assert float(abs(found.den).log()) <= den, radius
            assert float(abs(found.num).log()) <= num, radius
    equations = rod()
    largest = float(abs(equations.at(acb(20), 100).den).log())
    assert equations.bounds(20.0)[0] - largest < 20
    den = [rod().bounds(r)[0] for r in (1.0, 2.0, 4.0)]
    assert den == sorted(den)
    assert den[0] > log(np.cosh(1.0)) - 1e-6


def test_a_disc_with_an_essential_singularity_has_no_bound():
    # Kelvin and Voigt's law: E(1 + eta s) vanishes at -1/eta.
    equations = rod(extra=', eta = "0.1 s"')
    equations.bounds(9.0)
    with pytest.raises(EssentialSingularityError):
        equations.bounds(11.0)


def test_a_filter_in_the_output_is_a_pole():
    equations = rod(outputs='X = "a/(1 + 0.5*s)"')
    plain = rod()
    with ctx.workprec(100):
        s = acb(0.4, 0.3)
        ratio = equations.at(s, 100).den / plain.at(s, 100).den
        other = equations.at(acb(-2), 100).den
    assert complex(ratio) == pytest.approx(2 + 0.4 + 0.3j)  # s + 2, without its denominator
    assert other.contains(0)


def test_bounds_hold_where_a_constant_is_negative():
    # With the constant's size in place of its value the ratio would all but vanish.
    number = "(0.17364817766693 - cos(100*pi/180))*1000000"
    turned = f'g = {{ type = "transformer", from = ["a"], to = ["b"], ratio = "{number}" }}\n'
    equations = rod(turned + 'm = { type = "mass", at = "b", m = "1 kg" }')
    value = equations.at(acb(0.5), 64)
    assert equations.bounds(0.5)[0] >= log(float(abs(value.den).mid()))


def test_parameters_take_values_where_they_have_names():
    # m s^2 + k with m = 2 kg: at s = 3 it is 18 + k, and 0 is twice a root where k = 0.
    elements = """m = { type = "mass", at = "a", m = "2 kg" }
    s = { type = "spring", between = ["a", "ground"], k = "k" }"""
    text = specification(elements, outputs='X = "a"\n[parameters]\nk = { value = "1 N/m", assume = "real" }')
    equations = pipeline.assemble_sparse(pipeline.loads(text))
    for k, order in ((5, 0), (0, 2), (-18, 0)):
        cramer = CramerEquations.of(equations, "X", "F", (("k", ExactValue(Fraction(k))),))
        assert complex(cramer.alone(acb(3), 100, is_num=False)) == 18 + k, k
        assert order_at_zero(cramer, 1, 2) == order, k
