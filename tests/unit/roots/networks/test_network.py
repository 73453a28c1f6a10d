"""What is a network without losses, where its powers of s stand, and how many zeros its paths leave."""

from fractions import Fraction
from math import pi

import pytest

from symflex import pipeline
from symflex.roots.networks.blocks import most_zeros
from symflex.roots.networks.cramer import CramerEquations
from symflex.roots.networks.network import OtherNetworkError
from symflex.roots.passivity import energy_proof
from symflex.roots.region import Band, Modes
from tests.unit.roots.networks.network_models import (
    BEAM,
    equations_of,
    located,
    network,
    omegas,
    specification,
)

TWO = f"""
one = {{ {BEAM}, between = ["ground", "a"], l = "0.4 m" }}
two = {{ {BEAM}, between = ["a", "b"], l = "0.3 m" }}
"""


def test_what_loses_energy_has_negative_inertia_or_a_loop_is_refused():
    for elements, reason in [
        ('d = { type = "damper", between = ["a.y", "ground"], b = "1 N*s/m" }', "loses"),
        ('m = { type = "mass", at = "b.y", m = "-1 kg" }', "inertia is negative"),
        (f'e = {{ {BEAM}, between = ["b", "c"], l = "1 m", eta = "1 us" }}', r"loses|polynomial"),
        ('f = { type = "force_source", at = "b.y", f = "-k*a.y" }\n[parameters]\nk = "3 N/m"', "loop"),
    ]:
        with pytest.raises(OtherNetworkError, match=reason):
            network(specification(TWO + elements))


def test_springs_levers_and_links_are_taken_and_masses_beside_a_point_are_no_negative_inertia():
    parts = """
    k = { type = "spring", between = ["a.y", "ground"], k = "-10 N/m" }
    m = { type = "mass", at = "b.y", m = "1 kg" }
    body = { type = "rigid_body", at = "b", m = "1 kg", J = "1 kg*m^2", cg = "0.3 m" }
    link = { type = "rigid_link", between = ["b", "c"], length = "0.1 m" }
    lever = { type = "transformer", from = "c.y", to = "d", ratio = "-2" }
    soft = { type = "massless_beam", between = ["c", "ground"], EI = "3 N*m^2", l = "0.2 m" }
    """
    found = network(specification(TWO + parts))
    assert found.is_colocated
    assert not energy_proof(pipeline.loads(specification(TWO + parts))).is_passive
    body = 'body = { type = "rigid_body", at = "b", m = "1 kg", J = "0 kg*m^2", cg = "0.3 m" }'
    assert network(specification(TWO + body)).is_colocated


def test_a_rate_is_read_as_a_power_of_s():
    for output, above in [("a.y", 0), ("s*a.y", 1), ("3*s^2*a.y", 2)]:
        found = network(specification(TWO, outputs=f'X = "{output}"'))
        assert (found.below, found.above) == (0, above), output
        assert found.is_colocated, output


def test_what_is_told_or_read_elsewhere_is_found():
    # A velocity puts a power of s below; a signal that nothing hears is put in its place.
    assert network(specification(TWO, 'v = { velocity = "b" }', 'X = "b.y"'), source="v").below == 1
    assert not network(specification(TWO, outputs='X = "b"')).is_colocated
    text = specification(TWO, 'F = { force = "a" }\n[signals]\nv = "2*a.y"', 'X = "v"')
    assert network(text).is_colocated


# -------------------------------------------------------------------- how many zeros there are at most


SHAFT = 'type = "shaft", G = "80 GPa", J = "1e-8 m^4", rho = "7800 kg/m^3", eta = "1e-7 s"'
FLEXIBLE = [
    f's{i} = {{ {SHAFT}, between = ["{a}", "{b}"], l = "0.{3 + i} m" }}'
    for i, (a, b) in enumerate(("ab", "bc"))
]
SHAFTS = (
    *FLEXIBLE,
    *(f'J_{x} = {{ type = "inertia", at = "{x}", J = "1e-3 kg*m^2" }}' for x in "abc"),
    'bearing = { type = "rotary_damper", between = ["b", "ground"], b = "0.1 N*m*s/rad" }',
)
ABSORBER = (
    'soft = { type = "torsion_spring", between = ["b", "d"], k = "100 N*m/rad" }',
    'loss = { type = "rotary_damper", between = ["b", "d"], b = "0.2 N*m*s/rad" }',
    'load = { type = "inertia", at = "d", J = "1e-2 kg*m^2" }',
)


def driven(*lines, output="c", more=""):
    return specification("\n".join(lines), 'F = { torque = "a" }', f'X = "{output}"') + more


def most(text):
    return most_zeros(CramerEquations.of(equations_of(text), "X", "F"))


def test_zeros_of_trains_are_those_of_what_stands_beside_the_way_and_loops_add_none():
    for lines, output, expected in [
        (SHAFTS, "c", 0),
        (SHAFTS, "s*c", 1),
        ((*SHAFTS, *ABSORBER), "c", 2),
        (SHAFTS, "b", None),  # the shaft behind it
        ((*SHAFTS, f'branch = {{ {SHAFT}, between = ["b", "d"], l = "0.2 m" }}'), "c", None),
        ((*SHAFTS, f'other = {{ {SHAFT}, between = ["a", "b"], l = "0.9 m" }}'), "c", None),
    ]:
        assert most(driven(*lines, output=output)) == expected
    loop = 'loop = { type = "torque_source", at = "a", tau = "-K*D*c" }'
    text = driven(
        *SHAFTS, loop, more='[parameters]\nK = "10 N*m/rad"\n[blocks]\nD = { type = "delay", T = "0.01 s" }\n'
    )
    assert most(text) == 0
    beams = [
        f'b{i} = {{ {BEAM}, between = ["{s}", "{e}"], l = "1 m" }}' for i, (s, e) in enumerate(("za", "ac"))
    ]
    text = specification("\n".join(['clamp = { type = "fixed", at = "z" }', *beams]), outputs='X = "c"')
    assert most(text) is None


@pytest.mark.slow
def test_a_train_with_losses_has_no_zeros_but_those_of_an_absorber():
    found = located(driven(*SHAFTS), Modes(3))
    assert found.certificate.certified
    assert found.zeros == ()
    found = located(driven(*SHAFTS, *ABSORBER), Modes(4))
    assert found.certificate.certified
    # J s^2 + b s + k = 0: s = -10 +- j sqrt(10^4 - 10^2).
    assert [(float(z.re), abs(float(z.im))) for z in found.zeros] == [pytest.approx((-10, 9900**0.5))] * 2


# ------------------------------------------------------------ zeros between places that one path joins


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
    assert found.certificate.engine == "cramer"
    assert (len(omegas(found.poles)), found.zeros) == (5, ())


@pytest.mark.slow
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


def test_a_spring_between_a_beam_and_what_is_read_is_a_path():
    beam = f'beam = {{ {BEAM}, between = ["ground", "a"], l = "1 m" }}'
    text = driven_at_a(beam, spring("a", "d"), mass("d"))
    # The end of the beam rests, and may turn: tan x = tanh x.
    unit = (700 / 0.27) ** 0.5
    found = located(text, Modes(2))
    assert omegas(found.zeros) == pytest.approx([3.926602312**2 * unit, 7.068582746**2 * unit], rel=1e-9)


@pytest.mark.slow
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
