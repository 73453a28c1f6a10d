"""Sweeps of networks of many members, which have no expanded form."""

from fractions import Fraction

import numpy as np
import pytest

from symflex import pipeline
from symflex.model import ExactValue
from symflex.roots import Modes
from symflex.sweep.design import Task
from symflex.sweep.points import solve_response, solve_roots

BEAM = 'type = "beam", E = "E", rho = "7800 kg/m^3", A = "100 mm^2", I = "1000 mm^4"'


def chain(count):
    elements = "".join(
        f'b{i} = {{ {BEAM}, between = ["{f"n{i}" if i else "ground"}", "n{i + 1}"], l = "0.{2 + i} m" }}\n'
        f'm{i} = {{ type = "mass", at = "n{i + 1}", m = "{i + 1} g" }}\n'
        for i in range(count)
    )
    return pipeline.loads(
        f'symflex = 1\nparameters.E = "200 GPa"\n[elements]\n{elements}'
        f'[inputs]\nF = {{ force = "n{count}" }}\n[outputs]\nY = "n{count}"\n'
    )


def task(of, **more):
    return Task(chain(6), ("Y", "F"), of, ("E",), **more)


POINTS = [(ExactValue(Fraction(200 * 10**9)),), (ExactValue(Fraction(800 * 10**9)),)]


def test_four_times_the_modulus_doubles_every_frequency_of_beams_with_masses():
    rows = solve_roots(task("poles", region=Modes(3)))(POINTS)
    assert rows["point_status"].tolist() == [0, 0]
    np.testing.assert_allclose(rows["im"][1], 2 * rows["im"][0], rtol=1e-15)


def test_four_times_the_modulus_divides_the_response_at_twice_the_frequency_by_four():
    rows = solve_response(task("response", frequencies=(0.0, 3.0, 6.0)))(POINTS)
    assert rows["re"][1][2] == pytest.approx(rows["re"][0][1] / 4, rel=1e-13)
    # At rest a cantilever of length 2.7 m yields l^3/(3 E I).
    assert rows["re"][0][0] == pytest.approx(2.7**3 / (3 * 200), rel=1e-13)
