"""The recipes are right: each against what a textbook says of it."""

from math import sqrt

import pytest

import symflex
from tests.house.repository import ROOT, blocks

RECIPES = {block.title: block.text for block in blocks(ROOT / "docs" / "recipes.md") if block.title}


def function(name, output, source):
    return symflex.loads(RECIPES[name]).transfer_function(output, source).bind()


def test_an_inverted_pendulum_falls_with_the_mass_of_the_cart_reduced():
    # Ogata, Modern Control Engineering: M l s^2 = (M + m) g
    rate = sqrt((2 + 0.5) * 9.81 / (2 * 0.4))
    poles = sorted(float(p.re) for p in function("inverted.toml", "Phi", "F").poles())
    assert poles == pytest.approx([-rate, rate])


def test_a_crane_swings_faster_than_its_load_alone():
    crane = function("crane.toml", "X", "F")
    assert crane.poles()[-1].frequency_hz == pytest.approx(sqrt(250 * 9.81 / (200 * 3)) / 6.283185307)
    assert crane.zeros()[-1].frequency_hz == pytest.approx(sqrt(9.81 / 3) / 6.283185307)


def test_slow_motion_of_the_floor_bends_the_column_as_its_inertia_does():
    assert function("table.toml", "bend", "a_floor").dcgain() == pytest.approx(-15 / 300e3)


def test_a_motor_in_its_loops_follows_at_rest():
    assert function("cascade.toml", "Phi", "ref").dcgain() == pytest.approx(1)


def test_a_stack_through_a_lever_moves_the_mirror_against_both_springs():
    assert function("stack.toml", "Y", "U").dcgain() == pytest.approx(5 * 9 / (60e6 + 25 * 0.2e6))


def test_an_elbow_gives_way_as_castigliano_says():
    # Force across the hand: moments along both members, and the stretching of both.
    E, a, length = 70e9, 0.012, 0.3
    bending, stretching = E * a**4 / 12, E * a**2
    cos, sin = sqrt(3) / 2, 0.5  # of the forearm, 30 degrees above the horizontal
    fore = (length * cos) ** 2 * length / 3
    upper = (length * cos) ** 2 * length  # the same moment all along, the force being parallel to it
    expected = (fore + upper) / bending + (sin**2 + 1) * length / stretching
    assert function("elbow.toml", "Y", "F").dcgain() == pytest.approx(expected)
