"""Frequencies that coincide because parts of a network are equal; how often follows from counting forces."""

from __future__ import annotations

from math import sqrt

import pytest

from symflex.roots.networks.repeated import repeated_parts
from symflex.roots.region import Modes
from tests.unit.roots.networks.network_models import BEAM, located, network, specification

LAW = 'E = "200 GPa", A = "1e-4 m^2", I = "1e-9 m^4", rho = "7800 kg/m^3"'
UNIT = sqrt(200 / 0.78)
"""sqrt(EI/rho A) [m^2/s]."""
CLAMPED_PINNED = 3.926602312
"""First root of tan x = tanh x (OEIS A069854 less pi)."""


def arm(i, angle, length="0.5", ends=None):
    between = '", "'.join(ends or ("c", f"e{i}"))
    place = f'between = ["{between}"], l = "{length} m", angle = "{angle} deg"'
    return f'arm{i} = {{ type = "frame", {LAW}, {place} }}'


def pin(i):
    return f'pin{i} = {{ type = "pin", at = "e{i}" }}'


def lumps(i, masses):
    return [f'm{i}{x} = {{ type = "mass", at = "e{i}.{x}", m = "{m} kg" }}' for x, m in masses.items()]


def hub(*lines, output="c.x"):
    return specification("\n".join(lines), f'F = {{ force = "{output}" }}', f'X = "{output}"')


def arms(count, step):
    return [line for i in range(count) for line in (arm(i, step * i), pin(i))]


def multiplicities(text, held=()):
    return sorted({p.multiplicity for p in repeated_parts(network(text), held)})


@pytest.mark.slow
def test_of_equal_arms_on_a_hub_all_but_three_move_alone():
    # The hub takes two forces and a torque.
    for count, step, expected in ((8, 45, [5]), (5, 72, [2]), (4, 90, []), (7, 17, [4])):
        assert multiplicities(hub(*arms(count, step))) == expected, count
    # One force less where it does not move along a direction.
    text = hub(*arms(8, 45), 'f = { type = "fixed", at = "c.y" }')
    assert multiplicities(text) == [6]
    assert multiplicities(text, held={0}) == [7]


def test_an_arm_of_another_length_is_another_part_and_may_be_written_from_either_end():
    lines = arms(8, 45)
    lines[0] = arm(0, 0, "0.50000000000000000001")
    assert multiplicities(hub(*lines)) == [4]
    lines = arms(8, 45)
    lines[4] = arm(2, 270, ends=("e2", "c"))
    assert multiplicities(hub(*lines)) == [5]


def test_masses_alike_along_x_and_y_turn_with_the_arm_and_others_do_not():
    alike = [line for i in range(8) for line in lumps(i, {"x": "0.2", "y": "0.2"})]
    assert multiplicities(hub(*(arm(i, 45 * i) for i in range(8)), *alike)) == [5]
    along_x = [line for i in range(8) for line in lumps(i, {"x": "0.2"})]
    assert multiplicities(hub(*(arm(i, 45 * i) for i in range(8)), *along_x)) == []


def test_arms_of_two_members_are_compared_with_the_angle_between_them():
    def bent(i, by):
        far = arm(i + 10, 90 * i + by, "0.2", ends=(f"e{i}", f"t{i}"))
        return arm(i, 90 * i), far

    left = [line for i in range(5) for line in bent(i, 90)]
    assert multiplicities(hub(*left)) == [2]
    mixed = [line for i in range(5) for line in bent(i, 90 if i else -90)]
    assert multiplicities(hub(*mixed)) == []


def test_equal_beams_act_alike_and_equal_absorbers_are_parts_without_members():
    # One force and one moment, always in the same ratio, are cancelled by one of six.
    beams = [f'b{i} = {{ {BEAM}, between = ["ground", "a"], l = "1 m" }}' for i in range(6)]
    assert multiplicities(specification("\n".join(beams))) == [5]
    beam = f'b = {{ {BEAM}, between = ["ground", "a"], l = "1 m" }}'
    absorbers = [
        line
        for i in range(4)
        for line in (
            f's{i} = {{ type = "spring", between = ["a", "n{i}"], k = "100 N/m" }}',
            f'm{i} = {{ type = "mass", at = "n{i}", m = "1 kg" }}',
        )
    ]
    text = specification("\n".join([beam, *absorbers]))
    assert multiplicities(text) == [3]
    tuned = [h.root for h in located(text).hidden if h.root.im > 0]
    assert [(round(float(r.im), 9), r.multiplicity, r.certified) for r in tuned] == [(10.0, 3, True)]


@pytest.mark.slow
def test_a_star_has_twofold_frequencies_of_an_arm_and_lists_the_hidden_partner_of_the_highest_pole():
    found = located(hub(*arms(5, 72)), Modes(2))
    assert found.certificate.certified
    (twofold,) = (h.root for h in found.hidden if h.root.multiplicity == 2 and 0 < h.root.im < 2000)
    assert float(twofold.im) == pytest.approx((CLAMPED_PINNED / 0.5) ** 2 * UNIT, rel=1e-9)
    assert max(float(p.im) for p in found.poles) in [float(h.root.im) for h in found.hidden]


@pytest.mark.slow
def test_roots_that_nothing_makes_equal_are_not_told_apart():
    lines = arms(8, 45)
    lines[0] = arm(0, 0, "0.50000000000000000001")
    found = located(hub(*lines), Modes(2))
    assert not found.certificate.certified
    assert not all(root.certified for root in (*(h.root for h in found.hidden), *found.poles))
