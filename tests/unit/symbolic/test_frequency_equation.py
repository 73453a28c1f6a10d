"""Frequency equations: solutions of the equations of books, found by mpmath, and refusals."""

from itertools import pairwise
from pathlib import Path

import mpmath
import pytest

from symflex import pipeline
from symflex.symbolic.frequency_equation import symbolic_roots
from symflex.symbolic.roots import SymbolicFactor

CLASSICS = Path(__file__).parents[3] / "derivations" / "classics"
BEAM = 'b = { type = "beam", between = ["%s", "%s"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }'
GUIDE = ', g = { type = "slider", at = "%s" }'
PIN = ', p = { type = "pin", at = "%s" }'
ROD = 'b = { type = "rod", between = ["%s", "%s"], E = "E", rho = "rho", A = "A", l = "l" }'
SHAFT = 'b = { type = "shaft", between = ["%s", "%s"], G = "E", rho = "rho", J = "I", l = "l" }'
STRING = 'b = { type = "string", between = ["%s", "%s"], N = "N", rho = "rho", A = "A", l = "l" }'
MASS, SPRING = (
    ', m = { type = "mass", at = "x", m = "m" }',
    ', k = { type = "spring", between = ["x", "ground"], k = "k" }',
)
PUSH, TURN = ('force = "x"', "x"), ('torque = "x"', "x.theta")


def clamped_clamped(q):  # and free-free
    return mpmath.cos(q) - mpmath.sech(q)


def clamped_free(q):
    return mpmath.cos(q) + mpmath.sech(q)


def clamped_pinned(q):  # and free-pinned
    return mpmath.sin(q) - mpmath.cos(q) * mpmath.tanh(q)


def clamped_sliding(q):  # and free-sliding
    return mpmath.sin(q) + mpmath.cos(q) * mpmath.tanh(q)


MU = mpmath.mpf("0.75") / (8 * mpmath.mpf("0.25") * 3)
KAPPA = mpmath.mpf(5) * 27 / (6 * mpmath.mpf("0.5"))


def with_tip_mass(q):
    """Laura, Pombo and Susemihl 1974."""
    return mpmath.cos(q) + mpmath.sech(q) + MU * q * (mpmath.cos(q) * mpmath.tanh(q) - mpmath.sin(q))


def with_tip_spring(q):
    c, s = mpmath.cos(q), mpmath.sin(q)
    return q**3 * (c + mpmath.sech(q)) + KAPPA * (s - mpmath.tanh(q) * c)


def rod_with_mass(q):
    return mpmath.cos(q) - MU * q * mpmath.sin(q)


def rod_with_spring(q):
    return q * mpmath.cos(q) + mpmath.mpf(5) * 3 / (6 * mpmath.mpf("0.25")) * mpmath.sin(q)


CASES = (
    # elements, input and output, poles or zeros, the book's equation
    (BEAM % ("ground", "x"), PUSH, "poles", clamped_free),
    (BEAM % ("ground", "x") + PIN % "x", TURN, "zeros", clamped_clamped),
    (BEAM % ("ground", "x") + PIN % "x", TURN, "poles", clamped_pinned),
    (BEAM % ("ground", "x") + GUIDE % "x", PUSH, "poles", clamped_sliding),
    (BEAM % ("y", "x"), PUSH, "poles", clamped_clamped),
    (BEAM % ("y", "x") + PIN % "y", PUSH, "poles", clamped_pinned),
    (BEAM % ("y", "x") + GUIDE % "y", PUSH, "poles", clamped_sliding),
    (BEAM % ("y", "x") + PIN % "y" + (PIN % "x").replace("p =", "o ="), TURN, "poles", mpmath.sin),
    (BEAM % ("y", "x") + PIN % "y" + GUIDE % "x", PUSH, "poles", mpmath.cos),
    (BEAM % ("y", "x") + GUIDE % "y" + (GUIDE % "x").replace("g =", "h ="), PUSH, "poles", mpmath.sin),
    (BEAM % ("ground", "x") + MASS, PUSH, "poles", with_tip_mass),
    (BEAM % ("ground", "x") + SPRING, PUSH, "poles", with_tip_spring),
    (ROD % ("ground", "x"), PUSH, "poles", mpmath.cos),
    (ROD % ("y", "x"), PUSH, "poles", mpmath.sin),
    (ROD % ("ground", "x") + MASS, PUSH, "poles", rod_with_mass),
    (ROD % ("ground", "x") + SPRING, PUSH, "poles", rod_with_spring),
    (SHAFT % ("ground", "x"), ('torque = "x"', "x"), "poles", mpmath.cos),
    (SHAFT % ("y", "x"), ('torque = "x"', "x"), "poles", mpmath.sin),
    (STRING % ("ground", "x"), PUSH, "poles", mpmath.cos),
    (STRING % ("ground", "x"), PUSH, "zeros", mpmath.sin),
    (ROD % ("ground", "x"), PUSH, "zeros", mpmath.sin),
)


def equations_of(elements: str, ends: tuple[str, str]) -> list[SymbolicFactor]:
    """Return what is said of the transfer function of a member."""
    values = "E = 6, I = 0.5, rho = 8, A = 0.25, l = 3, m = 0.75, k = 5, N = 7, b = 2"
    model = pipeline.loads(
        f"symflex = 1\nparameters = {{ {values} }}\n"
        f'elements = {{ {elements} }}\ninputs = {{ F = {{ {ends[0]} }} }}\noutputs = {{ X = "{ends[1]}" }}\n'
    )
    (tf,) = pipeline.derive_all(model)
    bound = pipeline.bind(tf)
    return [*symbolic_roots(tf, bound, pipeline.roots(bound))]


def solutions(book, count: int) -> list[mpmath.mpf]:
    """Return the lowest positive solutions of an equation: signs on a grid, then bisection."""
    grid = [mpmath.mpf(i) / 5 + mpmath.mpf("0.013") for i in range(100)]
    ends = [(a, b) for a, b in pairwise(grid) if book(a) * book(b) < 0][:count]
    return [mpmath.findroot(book, pair, solver="anderson") for pair in ends]


def test_solutions_of_classical_members_are_those_of_book_equations() -> None:
    """Ten end conditions of beams, tip mass and spring, rods, shafts, a string: twelve digits."""
    wrong = []
    with mpmath.workdps(30):
        for elements, ends, kind, book in CASES:
            found = [each for each in equations_of(elements, ends) if each.kind == kind and each.solutions]
            theirs = solutions(book, len(found[0].solutions)) if len(found) == 1 else []
            pairs = [(q, b) for (q, _), b in zip(found[0].solutions, theirs, strict=True)]
            if len(pairs) < 4 or not all(
                abs(float(q.mid()) - float(b)) < 1e-12 * b > q.rad() for q, b in pairs
            ):
                wrong.append((elements, kind, pairs))
    assert not wrong


def test_a_mass_ratio_is_named_and_printed_as_in_books() -> None:
    (poles,) = [each for each in equations_of(BEAM % ("ground", "x") + MASS, PUSH) if each.kind == "poles"]
    assert [*poles.lines()][:2] == ["mu = m/(rho*A*l) = 0.125", "omega = q^2*sqrt(E*I/(rho*A))/l^2"]
    (rod,) = [each for each in equations_of(ROD % ("ground", "x"), PUSH) if each.kind == "poles"]
    assert rod.note == "all solutions: q = (2*n - 1)*pi/2"


def test_real_zeros_of_the_sliding_free_beam_are_solutions_of_one_cosine() -> None:
    """Eppinger and Seering 1988: zeros of the tip on the real axis; sigma = 2 p^2 sqrt(E I/(rho A))/l^2."""
    found = equations_of(BEAM % ("y", "x") + GUIDE % "y", ('force = "y"', "x"))
    (zeros,) = [each for each in found if each.kind == "zeros"]
    first = float(next(root.re.mid() for q, root in zeros.solutions))
    assert str(zeros.formulas[-1]) == "sigma = 2*q^2*sqrt(E*I/(rho*A))/l^2"
    assert first == pytest.approx(2 * (mpmath.pi / 2) ** 2 * mpmath.sqrt(6 * 0.5 / (8 * 0.25)) / 9, rel=1e-12)


def test_losses_and_two_wavenumbers_are_refused_with_a_reason() -> None:
    damped = equations_of(
        ROD % ("ground", "x") + ', d = { type = "damper", between = ["x", "ground"], b = "b" }', PUSH
    )
    assert any("undamped Euler" in each.note for each in damped)
    tense = (BEAM % ("ground", "x")).replace('E = "E"', 'E = "E", N = "N"')
    (refused,) = equations_of(tense, PUSH)
    assert "Euler beams" in refused.note


def test_ratios_have_one_letter_in_all_factors_and_that_of_their_unit():
    """Hub and tip mass of an arm: nu = J_h/(rho A l^3), mu = m/(rho A l), in poles as in zeros."""
    model = pipeline.load(CLASSICS / "one_link_arm.toml")
    tf = pipeline.derive_all(model, [("theta_hub", "tau")])[0]
    bound = pipeline.bind(tf)
    found = symbolic_roots(tf, bound, pipeline.roots(bound))
    ratios = {str(f) for each in found for f in each.formulas if not f.name.startswith(("omega", "sigma"))}
    assert ratios == {"nu = J_h/(rho*A*l^3)", "mu = m/(rho*A*l)"}
