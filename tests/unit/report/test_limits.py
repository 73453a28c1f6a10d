"""Counts in limits, against what a textbook says of chains of masses."""

from __future__ import annotations

from symflex import pipeline
from symflex.report.structure import rigid_counts, undamped_counts


def chain(masses, *, damped):
    """Return masses in series, pushed at the first, as a model."""
    lines = ["symflex = 1", 'inputs.F = { force = "x_1" }', 'outputs.first = "x_1"']
    lines.append(f'outputs.last = "x_{masses}"')
    for i in range(1, masses + 1):
        lines.append(f'elements.body_{i} = {{ type = "mass", at = "x_{i}", m = {i} }}')
    for i in range(1, masses):
        ends = f'between = ["x_{i}", "x_{i + 1}"]'
        lines.append(f'elements.link_{i} = {{ type = "spring", {ends}, k = {7 + i} }}')
        if damped:
            lines.append(f'elements.loss_{i} = {{ type = "damper", {ends}, b = {i} }}')
    return pipeline.loads("\n".join(lines))


def test_a_rigid_chain_is_one_mass_and_without_dampers_the_last_mass_has_no_zeros():
    for masses in (2, 3, 5):
        model = chain(masses, damped=True)
        assert set(rigid_counts(model).values()) == {(0, 2)}, masses
        found = undamped_counts(model)
        assert found["last", "F"] == (0, 2 * masses), masses
        assert found["first", "F"] == (2 * (masses - 1), 2 * masses), masses


def test_what_has_no_damper_has_no_limit():
    assert undamped_counts(chain(3, damped=False)) == {}


def test_a_rigid_resonance_is_a_gain():
    model = pipeline.loads("""
symflex = 1
inputs.u = {}
outputs.y = "R*u/(s + 1)"
blocks.R = { type = "resonance", omega_p = 3, zeta_p = 0.1, omega_z = 4, zeta_z = 0.1 }
""")
    assert rigid_counts(model) == {("y", "u"): (0, 1)}


def test_names_of_the_model_are_left_alone():
    model = pipeline.loads("""
symflex = 1
parameters.scale = "3 kg"
inputs.F = { force = "x" }
outputs.X = "x"
elements.body = { type = "mass", at = "x", m = "scale" }
elements.tail = { type = "mass", at = "y", m = "scale" }
elements.link = { type = "spring", between = ["x", "y"], k = 2 }
""")
    assert rigid_counts(model) == {("X", "F"): (0, 2)}


def test_an_output_that_vanishes_with_the_compliance_keeps_no_zeros_and_no_poles():
    model = pipeline.loads("""
symflex = 1
inputs.F = { force = "x" }
outputs.stretch = "x - y"
elements.body = { type = "mass", at = "x", m = 1 }
elements.tail = { type = "mass", at = "y", m = 2 }
elements.link = { type = "spring", between = ["x", "y"], k = 2 }
""")
    assert rigid_counts(model) == {("stretch", "F"): (None, 0)}
