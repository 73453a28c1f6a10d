"""The independent counts themselves, against roots known in closed form; and the counts of the program."""

import functools
import math

import pytest
from mpmath import cosh, mp, mpc, mpf

import symflex
from tests.independent.boundary_value import Problem, bending, rod
from tests.independent.distributed.span import clamped, free
from tests.independent.published_roots import WAVENUMBERS
from tests.independent.winding import Frame, Member, OnTheContourError, count_inside, determinant

HELD = {"free": (), "pinned": ("y",), "sliding": ("theta",), "clamped": ("y", "theta")}


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(20):
        yield


# -------------------------------------------------------------------------------------- of known functions


def test_the_winding_of_a_hyperbolic_cosine_is_the_number_of_its_zeros():
    assert count_inside(lambda s: cosh(s) ** 2, -1 - 5j, 1 + 5j) == 8  # +-j pi/2 and +-3j pi/2, twice each


def test_an_empty_rectangle_has_no_winding():
    assert count_inside(cosh, 1 - 30j, 2 + 30j) == 0


def test_a_zero_on_the_contour_is_said():
    with pytest.raises(OnTheContourError):
        count_inside(lambda s: s - 1, 1 - 1j, 2 + 1j)


def test_a_pair_is_counted_however_near_to_each_other():
    near = mpf(10) ** -15
    assert count_inside(lambda s: (s - 2) * (s - 2 - near), 1 - 1j, 3 + 1j) == 2


def test_the_frequencies_of_a_beam_are_counted():
    rigid = {("free", "free"): 2, ("free", "sliding"): 1, ("free", "pinned"): 1, ("sliding", "sliding"): 1}
    for ends, entries in WAVENUMBERS.items():
        held = {(kind, joint) for joint, end in enumerate(ends) for kind in HELD[end]}
        frame = Frame([Member(0, 1, 1.0, 1.0, 1.0)], held=held)
        for k, entry in enumerate(entries, rigid.get(ends, 0)):
            number, _, factor = entry.partition(" ")
            omega = (float(number) * (math.pi / 2 if factor else 1.0)) ** 2
            assert [frame.count(omega * (1 + off)) for off in (-1e-6, 1e-6)] == [k, k + 1], ends


def test_cutting_a_beam_changes_no_count():
    whole = Frame([Member(0, 1, 2.0, 3.0, 1.5)], held={("y", 0)})
    cut = Frame([Member(0, 2, 2.0, 3.0, 0.4), Member(2, 1, 2.0, 3.0, 1.1)], held={("y", 0)})
    assert all(whole.count(w) == cut.count(w) for w in (0.1, 3.3, 17.0, 123.4, 999.0, 12345.0))


@pytest.mark.slow
def test_both_counts_are_the_same():
    values = {name: mpf(1) for name in ("E", "I", "rho", "A")}

    def cantilever(s):
        problem = Problem()
        line = problem.line(bending(values, s))
        problem.require(*clamped(*line.start), *free(*line.at(mpf(1))))
        return determinant(problem)

    frame = Frame([Member(0, 1, 1.0, 1.0, 1.0)], held={("y", 0), ("theta", 0)})
    assert count_inside(cantilever, -5 - 1j, 5 + 200j) == frame.count(200.0) == 5


def test_the_determinant_of_a_rod_is_a_hyperbolic_cosine():
    values = {name: mpf(1) for name in ("E", "rho", "A")}

    def held(s):
        problem = Problem()
        line = problem.line(rod(values, s))
        problem.require(line.start[0], line.at(mpf(1))[1])
        return determinant(problem)

    ratios = [held(s) / cosh(s) for s in (mpc(1, 2), mpc(-0.3, 7), mpc(2, -1))]
    assert all(abs(r.imag) < mpf(10) ** -16 * abs(r) for r in ratios)
    assert len({r.real > 0 for r in ratios}) == 1


# ------------------------------------------------------------------------------------------ of the program

KELVIN_VOIGT = """
symflex = 1
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
bar  = { type = "beam", between = ["ground", "x"], E = "1 Pa", I = "1 m^4", rho = "1 kg/m^3", A = "1 m^2", l = "1 m", eta = "0.001 s" }
tip  = { type = "mass", at = "x", m = "0.3 kg" }
loss = { type = "damper", between = ["x", "ground"], b = "0.7 N*s/m" }
"""  # noqa: E501


def damped_cantilever(s, load=True):
    """Return the determinant of the cantilever, loaded at the tip, or with the tip held."""
    values = {"E": mpf(1), "I": mpf(1), "rho": mpf(1), "A": mpf(1), "eta": mpf("0.001")}
    problem = Problem()
    line = problem.line(bending(values, s))
    w, _, moment, shear = line.at(mpf(1))
    tip = mpf("0.3") * s**2 * w + mpf("0.7") * s * w - shear if load else w
    problem.require(*clamped(*line.start), moment, tip)
    return determinant(problem)


@pytest.mark.slow
def test_the_program_finds_as_many_poles_and_zeros_as_the_argument_turns():
    low, high = -60 + 1j, 1 + 150j
    bound = symflex.loads(KELVIN_VOIGT).transfer_function("X", "F").bind()
    found = bound.pole_zero_map(digits=20, region=(low.real, high.real, low.imag, high.imag))
    poles = count_inside(damped_cantilever, low, high)
    zeros = count_inside(functools.partial(damped_cantilever, load=False), low, high)
    assert poles > 0
    assert sum(root.multiplicity for root in found.poles) == poles
    assert sum(root.multiplicity for root in found.zeros) == zeros
