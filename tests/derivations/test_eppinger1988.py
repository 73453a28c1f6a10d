"""What Eppinger & Seering 1988 claim about their models, and what holds of them exactly."""

from __future__ import annotations

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


def derive(model, output, input_name):
    return symflex.load(FOLDER / f"{model}.toml").transfer_function(output, input_name)


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


def count(roots):
    return sum(root.multiplicity for root in roots)


def numbers(roots):
    """Return the roots as complex numbers, each as often as it is multiple."""
    return [complex(float(r.re), float(r.im)) for r in roots for _ in range(r.multiplicity)]


def assert_same_roots(found, expected, relative):
    """Every expected root has one found root within ``relative`` of its own size, and none is left."""
    left = list(found)
    for root in expected:
        nearest = min(left, key=lambda z: abs(z - root))
        assert abs(nearest - root) <= relative * max(abs(root), 1e-6)
        left.remove(nearest)
    assert not left


@pytest.fixture(scope="module")
def six_mass():
    return symflex.load(FOLDER / "six_mass.toml")


@pytest.fixture(scope="module")
def six_mass_tip(six_mass):
    return six_mass.transfer_function("X_tip", "F").bind()


@pytest.fixture(scope="module")
def six_mass_values():
    values = parameters("six_mass")
    return [numbered(values, letter) for letter in "mkb"]


@pytest.fixture(scope="module")
def fitted():
    return symflex.load(FOLDER / "polynomial_resonance.toml").transfer_function("A_tip", "V_cmd").bind()


# ------------------------------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("case", tuple(CLOSED_FORMS), ids="-".join)
def test_the_closed_form_equals_the_independent_derivation(case):
    assert sympy.cancel(sympy.together(written_out(derive(*case)) - CLOSED_FORMS[case]())) == 0


@pytest.mark.parametrize("case", tuple(CLOSED_FORMS), ids="-".join)
def test_num_over_den_equals_the_closed_form(case):
    G = derive(*case)
    assert sympy.cancel(sympy.together(G.num / G.den - G.expr)) == 0


# ------------------------------------------------------------------------------- figure 4: the rigid body


def test_the_rigid_body_velocity_is_of_second_order():
    assert count(derive("rigid_body", "V_tip", "V_cmd").bind().poles()) == 2


def test_the_rigid_body_velocity_has_no_zeros():
    assert count(derive("rigid_body", "V_tip", "V_cmd").bind().zeros()) == 0


def test_the_acceleration_adds_one_zero_at_the_origin():
    assert numbers(derive("rigid_body", "A_tip", "V_cmd").bind().zeros()) == [0]


# ------------------------------------------------------------ figures 6 and 7: the polynomial resonance model


def rigid_body_poles():
    values = parameters("rigid_body")
    _, den = sympy.fraction(sympy.cancel(eppinger1988.printed_rigid_body()))
    return np.roots([float(c.subs(values)) for c in sympy.Poly(den, s).all_coeffs()])


def pair(omega, zeta):
    root = complex(-zeta * omega, omega * math.sqrt(1 - zeta**2))
    return [root, root.conjugate()]


def test_the_polynomial_model_has_the_rigid_body_poles_and_a_pair_per_resonance(fitted):
    expected = [*rigid_body_poles(), *(p for omega in MODES for p in pair(omega, 0.05))]
    assert_same_roots(numbers(fitted.poles()), expected, 1e-9)


def test_the_polynomial_model_has_a_pair_of_zeros_per_resonance_and_one_at_the_origin(fitted):
    expected = [0, *(z for omega in MODES for z in pair(1.1 * omega, 0.05))]
    assert_same_roots(numbers(fitted.zeros()), expected, 1e-9)


@pytest.mark.parametrize("frequency", [1, 11, 40, 60, 150])
def test_the_polynomial_model_is_the_printed_cascade(fitted, frequency):
    at = 1j * eppinger1988.radians_per_second(frequency)
    printed = eppinger1988.printed_rigid_body().subs(parameters("rigid_body"))
    expected = at * complex(printed.subs(s, at))
    for omega in MODES:
        expected *= eppinger1988.simple_resonance(omega, 0.05, 1.1 * omega, 0.05, at)
    assert abs(complex(fitted(at)) - expected) < 1e-11 * abs(expected)


def test_the_polynomial_model_leaves_low_frequencies_alone(fitted):
    at = 1j * eppinger1988.radians_per_second(0.01)
    rigid = derive("rigid_body", "A_tip", "V_cmd").bind()
    assert abs(complex(fitted(at)) / complex(rigid(at)) - 1) < 1e-3


# -------------------------------------------------------------------- figures 8a and 8b: masses in series


def test_two_masses_vibrate_at_the_lowest_measured_mode():
    poles = numbers(derive("two_mass", "X_tip", "F").bind().poles())
    assert max(map(abs, poles)) == pytest.approx(MODES[0], rel=1e-4)


@pytest.mark.parametrize("mode", MODES)
def test_the_six_masses_have_poles_at_each_measured_mode(six_mass_tip, mode):
    frequencies = [abs(pole) for pole in numbers(six_mass_tip.poles())]
    assert min(abs(frequency - mode) for frequency in frequencies) < 0.005 * mode


def test_the_poles_of_six_masses_are_the_eigenvalues_of_the_state_matrix(six_mass, six_mass_values):
    found = numbers(six_mass.transfer_function("X_act", "F").bind().poles())
    flexible = [p for p in eppinger1988.chain_poles(*six_mass_values) if abs(p) > 1.0]
    # The eigenvalue solver splits the double pole at the origin; it is exact here.
    assert_same_roots([p for p in found if p != 0], flexible, 1e-8)


def test_the_six_masses_have_one_rigid_body_mode_at_the_origin(six_mass_tip):
    assert numbers(six_mass_tip.poles()).count(0) == 2


def test_every_damping_ratio_of_the_six_masses_is_about_one_and_a_half_percent(six_mass_tip):
    flexible = [p for p in numbers(six_mass_tip.poles()) if p.imag > 0]
    assert [-p.real / abs(p) for p in flexible] == pytest.approx([0.015] * 5, rel=0.02)


@pytest.mark.parametrize(("model", "modes"), [("two_mass", 1), ("six_mass", 5)])
def test_each_mode_between_actuator_and_tip_adds_two_poles(model, modes):
    assert count(derive(model, "X_tip", "F").bind().poles()) == 2 + 2 * modes


@pytest.mark.parametrize(("model", "modes"), [("two_mass", 1), ("six_mass", 5)])
def test_each_mode_between_actuator_and_tip_adds_only_one_zero(model, modes):
    assert count(derive(model, "X_tip", "F").bind().zeros()) == modes


@pytest.mark.parametrize(("model", "modes"), [("two_mass", 1), ("six_mass", 5)])
def test_each_mode_adds_two_zeros_at_the_driving_point(model, modes):
    assert count(derive(model, "X_act", "F").bind().zeros()) == 2 * modes


def test_the_tip_zeros_of_six_masses_are_those_of_the_links(six_mass_tip, six_mass_values):
    _, stiffnesses, dampings = six_mass_values
    expected = [-k / b for k, b in zip(stiffnesses, dampings, strict=True)]
    assert_same_roots(numbers(six_mass_tip.zeros()), expected, 1e-12)


def test_the_tip_zeros_of_six_masses_are_proved_real(six_mass_tip):
    assert all(zero.is_real for zero in six_mass_tip.zeros())


@pytest.mark.parametrize(("output", "position"), [("X_act", 0), ("X_tip", 1)])
@pytest.mark.parametrize("at", [3 + 1j, 20j, 200 + 350j, 480j])
def test_six_masses_respond_as_shooting_says(six_mass, six_mass_values, output, position, at):
    found = complex(six_mass.transfer_function(output, "F").bind()(at))
    expected = eppinger1988.chain(*six_mass_values, at)[position]
    assert abs(found - expected) < 1e-11 * abs(expected)


# ------------------------------------------------------------------------------ figure 8c: base flexure


@pytest.mark.parametrize("output", ["V_tip", "V_motor"])
def test_the_flexible_base_makes_three_poles(output):
    assert count(derive("base_flexure", output, "F").bind().poles()) == 3


@pytest.mark.parametrize("output", ["V_tip", "V_motor"])
def test_the_flexible_base_makes_two_zeros(output):
    assert count(derive("base_flexure", output, "F").bind().zeros()) == 2


@pytest.mark.parametrize("output", ["V_tip", "V_motor"])
def test_a_flexible_base_keeps_actuator_and_tip_minimum_phase(output):
    assert all(zero.real < 0 for zero in numbers(derive("base_flexure", output, "F").bind().zeros()))


def test_the_base_hides_from_the_tip_when_the_carriage_does_not_rub_on_it():
    text = (FOLDER / "base_flexure.toml").read_text("utf-8")
    rubbing = 'between = ["x_tip", "x_base"]'
    assert text.count(rubbing) == 1
    G = symflex.loads(text.replace(rubbing, 'between = ["x_tip", "ground"]')).transfer_function("V_tip", "F")
    m, b = sympy.symbols("m b")
    assert sympy.cancel(written_out(G) - 1 / (m * s + b)) == 0


def test_the_hidden_mode_of_the_base_is_reported():
    text = (FOLDER / "base_flexure.toml").read_text("utf-8")
    text = text.replace('between = ["x_tip", "x_base"]', 'between = ["x_tip", "ground"]')
    assert symflex.loads(text).transfer_function("V_tip", "F").hidden


# ----------------------------------------------------------------- figures 12 and 13: the lumped bending beam

# B changes sign at h = 21/260 m with the file's other values; one tip on each side of it.
NEAR_TIP, FAR_TIP = 0.075, 0.09


def beam_values(h):
    values = parameters("lumped_bending_beam")
    return {"m_2": values["m_2"], "J": values["J"], "c": values["c"], "h": h, "length": values["l"]}


def test_the_two_tips_stand_on_either_side_of_the_condition():
    assert eppinger1988.bracket(**beam_values(NEAR_TIP)) > 0 > eppinger1988.bracket(**beam_values(FAR_TIP))


def test_the_colocated_zeros_of_the_bending_beam_are_proved_on_the_imaginary_axis():
    assert all(z.on_imaginary_axis for z in derive("lumped_bending_beam", "X_act", "F").bind().zeros())


def test_the_colocated_function_of_the_bending_beam_has_two_zeros_per_mode():
    assert count(derive("lumped_bending_beam", "X_act", "F").bind().zeros()) == 4


def test_the_bending_beam_has_a_rigid_body_mode_and_two_flexible_modes():
    assert count(derive("lumped_bending_beam", "X_act", "F").bind().poles()) == 6


def test_the_noncolocated_zeros_of_the_bending_beam_are_a_pair():
    assert count(derive("lumped_bending_beam", "X_tip", "F").bind().zeros()) == 2


def test_the_noncolocated_zeros_of_the_bending_beam_are_proved_real():
    assert all(zero.is_real for zero in derive("lumped_bending_beam", "X_tip", "F").bind().zeros())


@pytest.mark.slow
def test_the_noncolocated_zeros_of_the_bending_beam_have_equal_magnitude():
    values = parameters("lumped_bending_beam")
    B = eppinger1988.bracket(**beam_values(values["h"]))
    size = math.sqrt(-2 * values["EI"] / (values["l"] * B))
    found = numbers(derive("lumped_bending_beam", "X_tip", "F").bind().zeros())
    assert_same_roots(found, [size, -size], 1e-12)


def test_the_symbolic_zeros_of_the_tip_hold_the_bracket():
    num, _ = sympy.fraction(sympy.cancel(written_out(derive("lumped_bending_beam", "X_tip", "F"))))
    EI, length = sympy.symbols("EI l")
    expected = 2 * EI + length * eppinger1988.tip_bracket() * s**2
    assert not sympy.cancel(num / expected).has(s)


def test_a_tip_beyond_the_condition_is_nonminimum_phase():
    zeros = numbers(derive("lumped_bending_beam", "X_tip", "F").bind(h=FAR_TIP).zeros())
    assert max(zero.real for zero in zeros) > 0


def test_a_tip_short_of_the_condition_has_its_zeros_on_the_imaginary_axis():
    zeros = derive("lumped_bending_beam", "X_tip", "F").bind(h=NEAR_TIP).zeros()
    assert all(zero.on_imaginary_axis for zero in zeros)


def test_a_tip_beyond_the_condition_has_real_zeros():
    zeros = derive("lumped_bending_beam", "X_tip", "F").bind(h=FAR_TIP).zeros()
    assert all(zero.is_real for zero in zeros)
