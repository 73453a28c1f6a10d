"""Where models give way, and counts in limits, against what a textbook says of chains of masses."""

import pytest

from symflex import pipeline
from symflex.report.structure import compliances, is_colocated, rigid_counts, undamped_counts

JOINTED = """
symflex = 1
inputs  = { F = { force = "a" }, u = {} }
outputs = { A = "a", B = "b", C = "s*c", flow = "link.f", both = "a - c" }
[elements]
m_a   = { type = "mass", at = "a", m = 1 }
m_b   = { type = "mass", at = "b", m = 1 }
m_c   = { type = "mass", at = "c", m = 1 }
lever = { type = "transformer", from = "a", to = "b", ratio = 2 }
link  = { type = "spring", between = ["b", "c"], k = 5 }
base  = { type = "spring", between = ["c", "ground"], k = 5 }
push  = { type = "force_source", at = "c", f = "u" }
"""


@pytest.fixture(scope="module")
def jointed():
    return pipeline.loads(JOINTED)


def colocated(model, output, source):
    outputs = {o.name: o for o in model.outputs}
    inputs = {i.name: i for i in model.inputs}
    return is_colocated(model, outputs[output], inputs[source])


def test_a_spring_to_ground_is_the_base_s(jointed):
    assert {c.name: c.place for c in compliances(jointed)} == {"link": "transmission", "base": "base"}


def test_a_spring_to_ground_whose_force_is_shown_is_a_contact():
    text = """
symflex = 1
parameters = { k_c = "2 kN/m" }
inputs  = { F = { force = "x" } }
outputs = { F_tip = "SHOWN" }
[elements]
body  = { type = "mass", at = "x", m = 1 }
frame = { type = "mass", at = "y", m = 1 }
touch = { type = "spring", between = ["x", "ground"], k = "k_c" }
rest  = { type = "spring", between = ["y", "ground"], k = 7 }
"""
    for shown in ("k_c*x", "touch.f", "2*k_c*(x - y)"):
        found = compliances(pipeline.loads(text.replace("SHOWN", shown)))
        assert {c.name: c.place for c in found} == {"touch": "contact", "rest": "base"}, shown


def test_colocated_means_rigidly_joined(jointed):
    for output, source, expected in (
        ("A", "F", True),
        ("B", "F", True),  # the lever is rigid
        ("C", "F", False),  # the spring is not
        ("both", "F", False),
        ("C", "u", True),  # a signal acts where the source stands
        ("A", "u", False),
        ("flow", "F", None),  # a force has no place
    ):
        assert colocated(jointed, output, source) is expected, (output, source, expected)


def test_a_field_bends_from_fourth_order_on():
    text = """
symflex = 1
parameters = {{ l = "1 m", c = "{unit}" }}
inputs = {{ F = {{}} }}
outputs = {{ X = "w(0)", Y = "w(l)" }}
[fields.w]
domain = ["0", "l"]
equation = "c*{derivative} + s^2*w = 0"
conditions = {conditions}
"""
    bending = pipeline.loads(
        text.format(
            unit="1 m^4/s^2",
            derivative="w''''",
            conditions="[\"w'(0) = 0\", \"w'''(0) = F\", \"w''(l) = 0\", \"w'''(l) = 0\"]",
        )
    )
    axial = pipeline.loads(
        text.format(unit="-1 m^2/s^2", derivative="w''", conditions='["w\'(0) = F", "w\'(l) = 0"]').replace(
            'c = "-1 m^2/s^2"', 'c = { value = "-1 m^2/s^2", assume = "real" }'
        )
    )
    assert [c.place for c in compliances(bending)] == ["link"]
    assert [c.place for c in compliances(axial)] == ["transmission"]
    assert colocated(axial, "X", "F") is True
    assert colocated(bending, "Y", "F") is False


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
    # What has no damper has no limit.
    assert undamped_counts(chain(3, damped=False)) == {}


def test_rigid_counts_of_what_is_stretched_of_a_resonance_and_of_any_names():
    resonance = """
symflex = 1
inputs.u = {}
outputs.y = "R*u/(s + 1)"
blocks.R = { type = "resonance", omega_p = 3, zeta_p = 0.1, omega_z = 4, zeta_z = 0.1 }
"""
    masses = """
symflex = 1
parameters.scale = "3 kg"
inputs.F = { force = "x" }
outputs = { X = "x", stretch = "x - y" }
elements.body = { type = "mass", at = "x", m = "scale" }
elements.tail = { type = "mass", at = "y", m = "scale" }
elements.link = { type = "spring", between = ["x", "y"], k = 2 }
"""
    assert rigid_counts(pipeline.loads(resonance)) == {("y", "u"): (0, 1)}
    # What vanishes with the compliance keeps no zeros and no poles.
    assert rigid_counts(pipeline.loads(masses)) == {("X", "F"): (0, 2), ("stretch", "F"): (None, 0)}
