"""Zeros between places that one path joins are frequencies of what stands beside it."""

from __future__ import annotations

from fractions import Fraction
from math import pi

import pytest

from symflex.roots.networks.single_path import beside_path
from symflex.roots.region import Band, Modes
from tests.unit.roots.networks.network_models import BEAM, located, network, omegas, specification

ROD = 'type = "rod", E = "200 GPa", rho = "8000 kg/m^3", A = "1e-4 m^2"'
SPEED = 5000.0
"""sqrt(E/rho) [m/s]."""


def rod(name, start, end, length="1"):
    return f'{name} = {{ {ROD}, between = ["{start}", "{end}"], l = "{length} m" }}'


def mass(node, value="1"):
    return f'm_{node} = {{ type = "mass", at = "{node}", m = "{value} kg" }}'


def spring(start, end, value="100"):
    return f's_{start}_{end} = {{ type = "spring", between = ["{start}", "{end}"], k = "{value} N/m" }}'


def driven_at_a(*lines, output="d"):
    return specification("\n".join(lines), 'F = { force = "a" }', f'X = "{output}"')


TRAIN = (
    rod("r1", "a", "b"),
    mass("b"),
    rod("r2", "b", "c", "0.7"),
    mass("c", "2"),
    rod("r3", "c", "d", "1.3"),
)


def test_a_train_read_at_its_other_end_has_no_zeros():
    found = located(driven_at_a(*TRAIN), Modes(5))
    assert found.certificate.certified
    assert found.certificate.engine == "wittrick-williams"
    assert (len(omegas(found.poles)), found.zeros) == (5, ())


def test_zeros_are_frequencies_of_a_branch_clamped_at_the_path():
    found = located(driven_at_a(*TRAIN, rod("branch", "c", "e", "0.9")), Modes(4))
    assert found.certificate.certified
    assert omegas(found.zeros) == pytest.approx(
        [(k - 0.5) * pi * SPEED / 0.9 for k in range(1, 5)], rel=1e-11
    )


def test_zeros_are_frequencies_of_what_lies_behind_drive_and_sensor():
    text = driven_at_a(rod("r0", "ground", "a", "0.5"), *TRAIN, rod("r4", "d", "ground", "0.6"))
    found = located(text, Band(Fraction(0), Fraction(60000) / Fraction(2 * pi)))
    expected = sorted(k * pi * SPEED / length for length in (0.5, 0.6) for k in range(1, 9))
    assert found.certificate.certified
    assert omegas(found.zeros) == pytest.approx([x for x in expected if x < 60000], rel=1e-11)


def test_finitely_many_zeros_are_all_of_them():
    found = located(driven_at_a(*TRAIN, spring("b", "e"), mass("e", "4")), Modes(5))
    assert found.certificate.certified
    assert omegas(found.zeros) == pytest.approx([5.0])


def test_what_a_sensor_does_not_see_of_two_equal_branches_is_hidden():
    branches = rod("branch_1", "c", "e", "0.9"), rod("branch_2", "c", "f", "0.9")
    found = located(driven_at_a(*TRAIN, *branches), Modes(3))
    first = 0.5 * pi * SPEED / 0.9
    assert found.certificate.certified
    assert omegas(h.root for h in found.hidden)[:1] == pytest.approx([first], rel=1e-11)
    assert omegas(found.zeros)[:2] == pytest.approx([first, 3 * first], rel=1e-11)
    assert {z.multiplicity for z in found.zeros} == {1}


def test_a_spring_between_a_beam_and_what_is_read_is_a_path():
    beam = f'beam = {{ {BEAM}, between = ["ground", "a"], l = "1 m" }}'
    text = driven_at_a(beam, spring("a", "d"), mass("d"))
    # The end of the beam rests, and may turn: tan x = tanh x.
    unit = (700 / 0.27) ** 0.5
    found = located(text, Modes(2))
    assert omegas(found.zeros) == pytest.approx([3.926602312**2 * unit, 7.068582746**2 * unit], rel=1e-9)


def test_a_rate_has_one_zero_at_rest_wherever_it_is_read():
    for lines in (TRAIN, (rod("r0", "ground", "a"), *TRAIN)):
        found = located(driven_at_a(*lines, output="s*d"), Modes(2))
        at_rest = [r.multiplicity for r in found.zeros if r.is_zero]
        assert at_rest == ([1] if "ground" in lines[0] else [])
    beams = [
        f'b{i} = {{ {BEAM}, between = ["{s}", "{e}"], l = "1 m" }}' for i, (s, e) in enumerate(("za", "ad"))
    ]
    text = driven_at_a('clamp = { type = "fixed", at = "z" }', *beams, output="s*d")
    assert [r.multiplicity for r in located(text, Modes(2)).zeros if r.is_zero] == [1]


@pytest.mark.parametrize(
    "more", [rod("other", "b", "c", "0.8"), rod("round", "a", "d", "3"), spring("b", "c")]
)
def test_where_there_is_more_than_one_way_zeros_are_sought_otherwise(more):
    assert beside_path(network(driven_at_a(*TRAIN))) is not None
    assert beside_path(network(driven_at_a(*TRAIN, more))) is None
