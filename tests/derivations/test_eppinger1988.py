"""What Eppinger & Seering 1988 claim about their models, and what holds of them exactly."""

import functools
import itertools
import math
import tomllib
from pathlib import Path

import numpy as np
import pint
import pytest
import sympy

import symflex
from tests.independent import eppinger1988
from tests.independent.lagrange import s

FOLDER = Path(__file__).parents[2] / "derivations" / "eppinger1988"
MODES = tuple(eppinger1988.radians_per_second(f) for f in eppinger1988.MODES_HZ)

# (model, output, input), and the receptance derived from energies or laws with the power of s in the output.
CLOSED_FORMS = {
    ("rigid_body", "V_tip", "V_cmd"): eppinger1988.printed_rigid_body,
    ("rigid_body", "A_tip", "V_cmd"): lambda: s * eppinger1988.rigid_body(),
    ("two_mass", "X_act", "F"): lambda: eppinger1988.two_mass("x_act"),
    ("two_mass", "V_act", "F"): lambda: s * eppinger1988.two_mass("x_act"),
    ("two_mass", "X_tip", "F"): lambda: eppinger1988.two_mass("x_tip"),
    ("two_mass", "V_tip", "F"): lambda: s * eppinger1988.two_mass("x_tip"),
    ("base_flexure", "V_tip", "F"): lambda: s * eppinger1988.base_flexure("tip"),
    ("base_flexure", "V_motor", "F"): lambda: s * eppinger1988.base_flexure("motor"),
    ("base_flexure", "V_base", "F"): lambda: s * eppinger1988.base_flexure("base"),
    ("lumped_bending_beam", "X_act", "F"): lambda: eppinger1988.lumped_bending_beam("x_act"),
    ("lumped_bending_beam", "X_tip", "F"): lambda: eppinger1988.lumped_bending_beam("x_tip"),
    ("lumped_bending_beam", "theta", "F"): lambda: eppinger1988.lumped_bending_beam("theta"),
}


@functools.cache
def derive(model, output, input_name):
    return symflex.load(FOLDER / f"{model}.toml").transfer_function(output, input_name)


def roots(kind, model, output, input_name="F", **given):
    """Return poles or zeros of a model's transfer function."""
    return getattr(derive(model, output, input_name).bind(**given), kind)()


def by_name(expr):
    """Return ``expr`` with every symbol replaced by the plain one of the same name."""
    return expr.xreplace({symbol: sympy.Symbol(symbol.name) for symbol in expr.free_symbols})


def written_out(G):
    """Return ``G.expr`` in the spec's own names, its where-list substituted."""
    expr = by_name(G.expr)
    for name, value in reversed(tuple(G.where)):
        expr = expr.xreplace({sympy.Symbol(str(name)): by_name(value)})
    return expr


def parameters(model):
    """Return the file's values in SI units, read without symflex."""
    registry = pint.UnitRegistry()
    registry.define("rev = revolution")
    entries = tomllib.loads((FOLDER / f"{model}.toml").read_text("utf-8"))["parameters"]
    values = {name: entry["value"] if isinstance(entry, dict) else entry for name, entry in entries.items()}
    return {name: registry.Quantity(v).to_base_units().magnitude for name, v in values.items()}


def numbered(values, letter):
    """Return the values named ``letter_1``, ``letter_2``, ... in order."""
    names = (f"{letter}_{i}" for i in itertools.count(1))
    return [values[name] for name in itertools.takewhile(values.__contains__, names)]


def count(found):
    return sum(root.multiplicity for root in found)


def numbers(found):
    """Return the roots as complex numbers, each as often as it is multiple."""
    return [complex(float(r.re), float(r.im)) for r in found for _ in range(r.multiplicity)]


def assert_same_roots(found, expected, relative):
    """Every expected root has one found root within ``relative`` of its own size, and none is left."""
    left = list(found)
    for root in expected:
        nearest = min(left, key=lambda z: abs(z - root))
        assert abs(nearest - root) <= relative * max(abs(root), 1e-6)
        left.remove(nearest)
    assert not left


@pytest.fixture(scope="module")
def six_mass_values():
    values = parameters("six_mass")
    return [numbered(values, letter) for letter in "mkb"]


# ------------------------------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("case", tuple(CLOSED_FORMS), ids="-".join)
def test_the_closed_form_equals_the_independent_derivation(case):
    G = derive(*case)
    assert sympy.cancel(sympy.together(written_out(G) - CLOSED_FORMS[case]())) == 0
    assert sympy.cancel(sympy.together(G.num / G.den - G.expr)) == 0


# (model, output, input): how many poles and zeros there are.
COUNTS = {
    ("rigid_body", "V_tip", "V_cmd"): (2, 0),  # figure 4: of second order, without zeros
    ("rigid_body", "A_tip", "V_cmd"): (2, 1),
    # Figures 8a and 8b: each mode adds two poles, two zeros at the driving point, and one at the tip.
    ("two_mass", "X_tip", "F"): (4, 1),
    ("six_mass", "X_tip", "F"): (12, 5),
    ("two_mass", "X_act", "F"): (4, 2),
    ("six_mass", "X_act", "F"): (12, 10),
    ("base_flexure", "V_tip", "F"): (3, 2),  # figure 8c
    ("base_flexure", "V_motor", "F"): (3, 2),
    ("lumped_bending_beam", "X_act", "F"): (6, 4),  # figures 12 and 13: a rigid body and two modes
    ("lumped_bending_beam", "X_tip", "F"): (6, 2),
}


@pytest.mark.slow
def test_there_are_as_many_poles_and_zeros_as_the_paper_says():
    found = {case: tuple(count(roots(kind, *case)) for kind in ("poles", "zeros")) for case in COUNTS}
    assert found == COUNTS
    assert numbers(roots("zeros", "rigid_body", "A_tip", "V_cmd")) == [0]
    assert numbers(roots("poles", "six_mass", "X_tip")).count(0) == 2  # one rigid body mode


# ------------------------------------------------------------ figures 6 and 7: the polynomial resonance model


def rigid_body_poles():
    values = parameters("rigid_body")
    _, den = sympy.fraction(sympy.cancel(eppinger1988.printed_rigid_body()))
    return np.roots([float(c.subs(values)) for c in sympy.Poly(den, s).all_coeffs()])


def pair(omega, zeta):
    root = complex(-zeta * omega, omega * math.sqrt(1 - zeta**2))
    return [root, root.conjugate()]


@pytest.mark.slow
def test_the_polynomial_model_has_the_rigid_body_poles_and_a_pair_of_poles_and_zeros_per_resonance():
    fitted = ("polynomial_resonance", "A_tip", "V_cmd")
    poles = [*rigid_body_poles(), *(p for omega in MODES for p in pair(omega, 0.05))]
    assert_same_roots(numbers(roots("poles", *fitted)), poles, 1e-9)
    zeros = [0, *(z for omega in MODES for z in pair(1.1 * omega, 0.05))]
    assert_same_roots(numbers(roots("zeros", *fitted)), zeros, 1e-9)


@pytest.mark.slow
def test_the_polynomial_model_is_the_printed_cascade_and_leaves_low_frequencies_alone():
    fitted = derive("polynomial_resonance", "A_tip", "V_cmd").bind()
    printed = eppinger1988.printed_rigid_body().subs(parameters("rigid_body"))
    for frequency in (1, 11, 40, 60, 150):
        at = 1j * eppinger1988.radians_per_second(frequency)
        expected = at * complex(printed.subs(s, at))
        for omega in MODES:
            expected *= eppinger1988.simple_resonance(omega, 0.05, 1.1 * omega, 0.05, at)
        assert abs(complex(fitted(at)) - expected) < 1e-11 * abs(expected), frequency
    at = 1j * eppinger1988.radians_per_second(0.01)
    rigid = derive("rigid_body", "A_tip", "V_cmd").bind()
    assert abs(complex(fitted(at)) / complex(rigid(at)) - 1) < 1e-3


# -------------------------------------------------------------------- figures 8a and 8b: masses in series


def test_two_and_six_masses_vibrate_at_the_measured_modes():
    assert max(map(abs, numbers(roots("poles", "two_mass", "X_tip")))) == pytest.approx(MODES[0], rel=1e-4)
    poles = numbers(roots("poles", "six_mass", "X_tip"))
    for mode in MODES:
        assert min(abs(abs(pole) - mode) for pole in poles) < 0.005 * mode
    flexible = [p for p in poles if p.imag > 0]
    assert [-p.real / abs(p) for p in flexible] == pytest.approx([0.015] * 5, rel=0.02)


@pytest.mark.slow
def test_the_poles_of_six_masses_are_the_eigenvalues_of_the_state_matrix(six_mass_values):
    found = numbers(roots("poles", "six_mass", "X_act"))
    flexible = [p for p in eppinger1988.chain_poles(*six_mass_values) if abs(p) > 1.0]
    # The eigenvalue solver splits the double pole at the origin; it is exact here.
    assert_same_roots([p for p in found if p != 0], flexible, 1e-8)


def test_the_tip_zeros_of_six_masses_are_those_of_the_links_and_proved_real(six_mass_values):
    _, stiffnesses, dampings = six_mass_values
    zeros = roots("zeros", "six_mass", "X_tip")
    expected = [-k / b for k, b in zip(stiffnesses, dampings, strict=True)]
    assert_same_roots(numbers(zeros), expected, 1e-12)
    assert all(zero.is_real for zero in zeros)


def test_six_masses_respond_as_shooting_says(six_mass_values):
    for position, output in enumerate(("X_act", "X_tip")):
        bound = derive("six_mass", output, "F").bind()
        for at in (3 + 1j, 20j, 200 + 350j, 480j):
            expected = eppinger1988.chain(*six_mass_values, at)[position]
            assert abs(complex(bound(at)) - expected) < 1e-11 * abs(expected), (output, at)


# ------------------------------------------------------------------------------ figure 8c: base flexure


def test_a_flexible_base_keeps_actuator_and_tip_minimum_phase():
    for output in ("V_tip", "V_motor"):
        assert all(zero.real < 0 for zero in numbers(roots("zeros", "base_flexure", output))), output


def test_the_base_hides_from_the_tip_when_the_carriage_does_not_rub_on_it():
    text = (FOLDER / "base_flexure.toml").read_text("utf-8")
    rubbing = 'between = ["x_tip", "x_base"]'
    assert text.count(rubbing) == 1
    G = symflex.loads(text.replace(rubbing, 'between = ["x_tip", "ground"]')).transfer_function("V_tip", "F")
    m, b = sympy.symbols("m b")
    assert sympy.cancel(written_out(G) - 1 / (m * s + b)) == 0
    assert G.hidden


# ----------------------------------------------------------------- figures 12 and 13: the lumped bending beam

# B changes sign at h = 21/260 m with the file's other values; one tip on each side of it.
NEAR_TIP, FAR_TIP = 0.075, 0.09


def beam_values(h):
    values = parameters("lumped_bending_beam")
    return {"m_2": values["m_2"], "J": values["J"], "c": values["c"], "h": h, "length": values["l"]}


@pytest.mark.slow
def test_the_zeros_of_the_bending_beam_are_proved_where_the_bracket_says():
    assert eppinger1988.bracket(**beam_values(NEAR_TIP)) > 0 > eppinger1988.bracket(**beam_values(FAR_TIP))
    assert all(zero.on_imaginary_axis for zero in roots("zeros", "lumped_bending_beam", "X_act"))
    near, far = (roots("zeros", "lumped_bending_beam", "X_tip", h=h) for h in (NEAR_TIP, FAR_TIP))
    assert all(zero.on_imaginary_axis for zero in near)
    assert all(zero.is_real for zero in far)
    assert max(zero.real for zero in numbers(far)) > 0
    # Noncolocated zeros are a real pair of equal magnitude.
    values, found = parameters("lumped_bending_beam"), roots("zeros", "lumped_bending_beam", "X_tip")
    size = math.sqrt(-2 * values["EI"] / (values["l"] * eppinger1988.bracket(**beam_values(values["h"]))))
    assert all(zero.is_real for zero in found)
    assert_same_roots(numbers(found), [size, -size], 1e-12)


def test_the_symbolic_zeros_of_the_tip_hold_the_bracket():
    num, _ = sympy.fraction(sympy.cancel(written_out(derive("lumped_bending_beam", "X_tip", "F"))))
    EI, length = sympy.symbols("EI l")
    expected = 2 * EI + length * eppinger1988.tip_bracket() * s**2
    assert not sympy.cancel(num / expected).has(s)
