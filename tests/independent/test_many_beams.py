"""Chains of beams that are all different, against a boundary-value problem in numbers."""

import pytest
from mpmath import mp, mpc, mpf

import symflex
from symflex.errors import BudgetError
from tests.independent.boundary_value import DIGITS, Problem, bending

POINTS = (3 + 40j, 700j, -5 + 90j, 2000 + 100j)


def chain(count):
    """Return a clamped chain of different beams with a force on its tip, and the beams' values."""
    beams = [
        {
            "E": 70 + i,
            "I": mpf(10 + 3 * i) / 10**9,
            "rho": 2700 + 10 * i,
            "A": mpf(10 + i) / 10**5,
            "l": mpf(2 + i) / 10,
        }
        for i in range(count)
    ]
    parameters, elements = "", ""
    for i, v in enumerate(beams):
        parameters += (
            f'E_{i} = "{v["E"]} GPa"\nI_{i} = "{10 + 3 * i}e-9 m^4"\nrho_{i} = "{v["rho"]} kg/m^3"\n'
        )
        parameters += f'A_{i} = "{10 + i}e-5 m^2"\nl_{i} = "{(2 + i) / 10} m"\n'
        ends = f'["{f"p_{i - 1}" if i else "ground"}", "p_{i}"]'
        values = ", ".join(f'{name} = "{name}_{i}"' for name in v)
        elements += f'beam_{i} = {{ type = "beam", between = {ends}, {values} }}\n'
    last = count - 1
    text = (
        f"symflex = 1\n[parameters]\n{parameters}[elements]\n{elements}"
        f'[inputs]\nF = {{ force = "p_{last}" }}\n[outputs]\nX = "p_{last}"\nY = "p_0"\n'
    )
    return text, [v | {"E": v["E"] * 10**9} for v in beams]


def reference(beams, s):
    """Return the deflections of the tip and of the first joint per force on the tip."""
    with mp.workdps(DIGITS):
        problem = Problem()
        lines = [problem.line(bending(v, mpc(s))) for v in beams]
        problem.require(*lines[0].start[:2])
        ends = [line.at(v["l"]) for line, v in zip(lines, beams, strict=True)]
        for (w, slope, moment, shear), line in zip(ends, lines[1:], strict=False):
            w_2, slope_2, moment_2, shear_2 = line.start
            problem.require(w - w_2, slope - slope_2, moment - moment_2, shear - shear_2)
        problem.require(ends[-1][2], ends[-1][3] + 1)
        value = problem.solve()
        return complex(value(ends[-1][0])), complex(value(ends[0][0]))


@pytest.mark.parametrize("count", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_a_chain_of_different_beams_has_the_response_of_its_boundary_value_problem(count):
    text, beams = chain(count)
    model = symflex.loads(text)
    found = [model.transfer_function(output, "F").bind() for output in ("X", "Y")]
    for s in POINTS:
        for function, expected in zip(found, reference(beams, s), strict=True):
            assert abs(complex(function(s)) / expected - 1) < 1e-12


@pytest.mark.slow
def test_a_chain_of_five_different_beams_is_refused_in_seconds():
    text, _ = chain(5)
    with pytest.raises(BudgetError, match=r"SF502.*10000 terms"):
        symflex.loads(text).transfer_function("X", "F")
