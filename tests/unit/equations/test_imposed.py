"""Equations turned round: what is imposed is given, and what drove follows."""

from dataclasses import replace

from symflex.equations import assemble
from symflex.equations.imposed import impose
from symflex.transfer import derive
from tests.unit.matrices.models import TWO_MASSES, model_of


def test_an_imposed_output_is_an_input_and_the_freed_input_an_unknown():
    model = model_of(TWO_MASSES)
    before = assemble(model)
    after = impose(before, [("X_1", "F_1")])
    assert [v.owner for v in after.inputs] == ["F_2", "X_1"]
    assert [row.name for row in after.outputs] == ["X_2", "F_1"]
    assert len(after.rows) == len(after.unknowns) == len(before.unknowns) + 1


def test_a_model_with_an_imposed_motion_has_the_transmissibility_and_the_force_that_it_takes():
    # m_2 s^2 x_2 = k_2 (x_1 - x_2) with x_1 given; F_1 = (m_1 s^2 + k_1 + k_2) x_1 - k_2 x_2.
    model = replace(model_of(TWO_MASSES), imposed=(("X_1", "F_1"),))
    equations = assemble(model)
    moved, force = (derive(equations, name, "X_1") for name in ("X_2", "F_1"))
    ring = moved.ratio.ring
    s, m_1, m_2, k_1, k_2 = (ring.generator(name) for name in ("s", "m_1", "m_2", "k_1", "k_2"))
    assert (moved.quantity, force.quantity) == ("transmissibility", "dynamic stiffness")
    assert (moved.num.expand(), moved.den.expand()) == (k_2, m_2 * s**2 + k_2)
    assert force.den.expand() == m_2 * s**2 + k_2
    assert force.num.expand() == (m_1 * s**2 + k_1 + k_2) * (m_2 * s**2 + k_2) - k_2**2
