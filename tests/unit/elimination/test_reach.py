"""Inputs, outputs and elements without effect are told; those with effect are not."""

from __future__ import annotations

from symflex import pipeline

CHAIN = """symflex = 1
[parameters]
m = "1 kg"
k = "2 N/m"
[elements]
a = {{ type = "mass", at = "x", m = "m" }}
b = {{ type = "mass", at = "y", m = "m" }}
wall = {{ type = "spring", between = ["x", "ground"], k = "k" }}
{elements}
[inputs]
{inputs}
[outputs]
{outputs}
"""
LINK = 'link = { type = "spring", between = ["x", "y"], k = "k" }'


def told(elements=LINK, inputs='F = { force = "x" }', outputs='X = "x"'):
    model = pipeline.loads(CHAIN.format(elements=elements, inputs=inputs, outputs=outputs))
    return [(w.code, w.span.text) for w in pipeline.warnings(model)]


def test_in_a_chain_everything_has_an_effect():
    assert told() == []


def test_an_input_on_a_part_that_no_output_sees_reaches_nothing():
    found = told(elements="", inputs='F = { force = "x" }\nG = { force = "y" }')
    assert found == [("SF654", "b"), ("SF652", "G")]


def test_an_output_on_a_part_that_no_input_drives_is_zero():
    assert told(elements="", outputs='X = "x"\nY = "y"') == [("SF654", "b"), ("SF653", "Y")]


def test_the_only_input_and_the_only_output_that_do_not_meet_are_told_once():
    assert told(elements="", outputs='Y = "y"') == [("SF652", "F")]


def test_a_signal_that_cancels_itself_leaves_an_input_without_effect():
    found = told(inputs='F = { force = "x" }\nu = {}', outputs='X = "x + u - u"')
    assert found == [("SF652", "u")]


def test_a_ring_of_springs_that_hangs_free_has_no_effect():
    # Nothing holds p and q: they move with y, and the three springs carry no force.
    ring = "\n".join(
        f'{name} = {{ type = "spring", between = ["{one}", "{two}"], k = "k" }}'
        for name, one, two in (("r_1", "y", "p"), ("r_2", "p", "q"), ("r_3", "q", "y"))
    )
    assert told(elements=f"{LINK}\n{ring}") == [("SF654", "r_1")]


def test_a_mass_on_a_beam_has_an_effect_and_one_beside_it_has_none():
    rod = 'type = "rod", E = "70 GPa", rho = "2700 kg/m^3", A = "1e-4 m^2", l = "1 m"'
    beam = (
        f'arm = {{ {rod}, between = ["x", "y"] }}\n'
        'c = { type = "mass", at = "z", m = "m" }\n'
        'held = { type = "spring", between = ["z", "ground"], k = "k" }'
    )
    assert told(elements=beam) == [("SF654", "c")]
